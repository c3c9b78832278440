/* entities/exercise/cast_private.h: the entities of a scenario and their poses at any time.
 *
 * Everything is a pure function of scenario, seed, entity and time; nothing is stepped, so times can be evaluated in
 * any order. A pose costs some 0.3 us over synthetic terrain, 2 us over terrain from files. Lengths in ENU at the
 * place. */
#ifndef ENTITIES_EXERCISE_CAST_PRIVATE_H
#define ENTITIES_EXERCISE_CAST_PRIVATE_H

#include "entities/catalog/catalog.h"
#include "entities/exercise/hide_judge.h"
#include "entities/exercise/scenario.h"
#include "entities/flight/missile.h"
#include "entities/motion/articulation.h"
#include "entities/motion/dead_reckoning.h"
#include "terrain/earth/geodesy.h"
#include "terrain/elevation/elevation.h"
#include "terrain/culture/culture.h"
#include "terrain/ground/landscape.h"

/* ---- ground: cast_ground.c ---------------------------------------------------------------- */

/* The ground of a generated exercise: smooth, in the tangent plane of its place.
 *
 * Synthetic: swells over the curved Earth, slopes below 2.4 % at 1.5 m. From files or a terrain store: through a
 * cubic B-spline of `smooth_m`, so that velocity and angular rate of vehicles on it are continuous. */
typedef struct ExerciseGround {
    LocalFrame frame;
    double     half_curvature[2]; /* curvature of the ellipsoid eastward and northward, 1/(2 m) */
    double     swell_m, phase_rad[2];
    bool       real;
    double     smooth_m;
    Elevation  elevation;
    Landscape  stored;  /* landscape of a terrain store, in its own frame; cover NULL: none */
    Culture    culture; /* what is built on it, of ground.buildings; zeroes: nothing */
} ExerciseGround;

/* Reads the files of ground.elevation. Failures are logged. */
Status exercise_ground_create(ExerciseGround *out, const Scenario *scenario);
void   exercise_ground_destroy(ExerciseGround *ground);

/* z of the ENU plane, and its slope by x and y (may be NULL). Synthetic: the swells are added along z, not along the
 * local vertical: 4 mm off at 16 km. */
double exercise_ground_at(double slope[2], const ExerciseGround *ground, double x_m, double y_m);
/* The same of the ellipsoid at the height of the place: the sea. Within 1 cm at 30 km
 * (tests/entities/test_exercise_cast.c). */
double exercise_level_at(double slope[2], const ExerciseGround *ground, double x_m, double y_m);

/* ---- routes: cast_ground.c ------------------------------------------------------------------------ */

/* A smooth path through points: position and its derivatives by the distance along it.
 *
 * A cubic spline through the points (chord length its parameter, natural at the ends or closed), then sampled evenly
 * by arc length and held as a uniform cubic B-spline: twice differentiable, and as quick far along as at the
 * beginning. */

enum { route_max_points = 128 };

typedef struct Route {
    bool   loop;
    double length_m, step_m; /* length of the plane curve; distance between knots */
    int    knots;
    double (*control)[3]; /* [knots + 3] (loop: periodic) */
} Route;

typedef struct RoutePoint {
    double p[3], d[3], dd[3]; /* p and its derivatives by the distance; |d_xy| = 1 within 1e-3 */
} RoutePoint;

/* point: x, y, z; at least 2 (loop: 3), neighbours at least 0.1 m apart in the plane. Distances are those of the
 * plane. The result passes the points within 1e-3 of the distance between them (tests/entities/test_route.c).
 * STATUS_BAD_VALUE for fewer or nearer points, STATUS_NO_MEMORY. */
Status route_create(Route *out, const double (*point)[3], int count, bool loop);
void   route_destroy(Route *route);
/* Before the start and after the end it continues straight; a loop is periodic. */
void route_at(RoutePoint *out, const Route *route, double distance_m);

/* ---- entities --------------------------------------------------------------------------------- */

enum { cast_max_joints = 4 };
static const double cast_ramp_s = 3; /* time from standstill to full speed, and back */

typedef enum Carriage { /* how an entity moves */
                        CARRIAGE_LAND,
                        CARRIAGE_LIFE,
                        CARRIAGE_SEA,
                        CARRIAGE_ROTARY,
                        CARRIAGE_FIXED_WING,
                        CARRIAGE_MUNITION
} Carriage;

typedef struct CastEntity {
    DisEntityType type;
    uint16_t      number; /* entity number of its DIS id */
    uint8_t       force, algorithm;
    Carriage      carriage;
    int           group;             /* group of the scenario; -1: it is a munition */
    int           round;             /* number of the round that a munition belongs to */
    int           joints;            /* its first joint in `joint`; -1: no articulation parameters are sent */
    float         behind_m, aside_m; /* place in its formation: behind the beginning of the route, and to its left */
    double        hit_s, rest_s;     /* when it is hit, and when it has come to rest; INFINITY: never */
    uint8_t       damage;            /* its damage since the hit */
    int           own;               /* place of its own, of Cast.hidden; -1: on its group's route */
} CastEntity;

/* Where an entity hides. */
typedef struct CastHidden {
    double x_m, y_m, heading_rad; /* ENU at the place */
    double planned, judged;       /* shares hidden from the observer of the scenario; judged: or estimated */
    int    entity, fit;           /* its number in Cast.entity; candidates that were of the kind */
} CastHidden;

/* One shot of one munition. */
typedef struct CastRound {
    int           shot, shooter, target, munition; /* numbers of entities; -1: none */
    double        fire_s, impact_s;
    double        launch_enu[3], impact_enu[3];
    DisEntityType type;
    int           result; /* result of its Detonation */
    int           flight; /* of Cast.flight; -1: it goes along its line */
} CastRound;

/* How a round flew: entities/exercise/cast_flight.c. */
typedef struct FlightSample FlightSample;
typedef struct CastFlight {
    int    round, samples, end;       /* end: a FlightEnd of entities/flight/engagement.h */
    bool   hit, held;                 /* held: cast_create_held, and cast_take_flight has not been called */
    double miss_m, flight_s, end_mps; /* closest approach to the aim point, as if it flew on; until its Detonation */
    double most_lateral_mps2, guided_share;
    FlightSample *sample; /* [samples], of 10 ms; of a round that is held the launch alone */
    /* Launch: in ticks of 1 ms of the scenario's time. */
    Missile missile; /* with the shot's hit_m as its fuze's distance */
    int64_t tick;
    double  p_ecef[3], v_ecef_mps[3];
} CastFlight;

/* A joint that its model has and the scenario moves. */
typedef struct CastJoint {
    uint32_t dis_class, metric;
    double   low, high;
} CastJoint;

typedef struct Cast {
    const Scenario *scenario;
    ExerciseGround  ground;
    int             entity_count, round_count, joint_count, hidden_count;
    CastEntity     *entity;
    CastRound      *round;
    CastJoint      *joint;  /* cast_max_joints for each kind of entity that has joints; class 0 ends the list */
    Route          *route;  /* route of each group; without knots: the group is stationary */
    double         *stop_s; /* when each group starts to stop; INFINITY: never */
    CastHidden     *hidden; /* [hidden_count] */
    int             flight_count;
    CastFlight     *flight; /* [flight_count] */
    bool            held;   /* by cast_create_held */
} Cast;

/* The scenario must outlive the cast. Logs what is wrong with names of types, files of ground, shots that do not
 * reach. */
Status cast_create(Cast **out, const Scenario *scenario);
/* The same; what hides is placed by what a tracer sees of plants. judge NULL: by estimates alone. */
Status cast_create_judged(Cast **out, const Scenario *scenario, const HideJudge *judge);
/* The same; rounds that fly are fired and no more: another program flies them, one after the other, and
 * cast_take_flight says how. STATUS_BAD_VALUE, logged: there is none, or one has no seeker. */
Status cast_create_held(Cast **out, const Scenario *scenario, const HideJudge *judge);
void   cast_destroy(Cast *cast);

/* How the held round flew; times are the scenario's. */
typedef struct CastFlown {
    const struct FlightState *state; /* [states], each tick of 10 ms from the launch on */
    int                       states, end;
    bool                      hit; /* it went off at its target; else by the ground (end), or not at all */
    double                    impact_s, impact_ecef[3], miss_m;
} CastFlown;
Status cast_take_flight(Cast *cast, int flight, const CastFlown *flown);
/* Sets when a held round is launched, in whole ms; INFINITY: not so far, and nothing is heard of it. */
Status cast_hold_until(Cast *cast, int flight, double fire_s);

typedef struct CastPose {
    double p_enu[3], r_enu_from_body[9];
} CastPose;

void cast_pose(CastPose *out, const Cast *cast, int entity, double t_s);
/* The pose in ECEF with its velocity, acceleration (world axes) and body rates: central differences over 10 ms, so
 * that they belong to it; velocity within 1 mm/s of wider differences (tests/entities/test_exercise_cast.c).
 * algorithm: 4. */
void cast_kinematics(Kinematics *out, const Cast *cast, int entity, double t_s);
/* Whether an entity is reported at that time; a munition is from its Fire to its Detonation. */
bool     cast_present(const Cast *cast, int entity, double t_s);
uint32_t cast_appearance(const Cast *cast, int entity, double t_s);
/* Computes angles and rates of turret and gun; returns the number of joints. */
int cast_joints(JointReport joint[cast_max_joints], const Cast *cast, int entity, double t_s);
/* cast_still: whether an entity is stationary until the next change. cast_next_change: when it next starts, ends or is
 * hit. */
bool   cast_still(const Cast *cast, int entity, double t_s);
double cast_next_change(const Cast *cast, int entity, double t_s);
/* `NAME NUMBER` as its marking; 11 octets, not terminated. */
void cast_marking(char marking[11], const Cast *cast, int entity);

/* Private to the cast: shots are solved after all entities are placed, in file order.
 * entities/exercise/cast_shots.c */
Status cast_solve_shots(Cast *cast, const int *ids, const int *first);
void   cast_munition_pose(CastPose *out, const Cast *cast, const CastRound *round, double t_s);
/* Flies a round whose launch, shooter and target (-1: at_enu) are known: its end, result, and where it is meanwhile.
 * entities/exercise/cast_flight.c */
Status cast_fly(Cast *cast, CastRound *round, const Missile *row, const double at_enu[3]);
/* Where a round is launched at its fire_s. entities/exercise/cast_shots.c */
void cast_launch_place(CastRound *round, const Cast *cast);
/* What a hit does to the round's target. entities/exercise/cast_shots.c */
void cast_damage(Cast *cast, const CastRound *round);
void cast_flight_pose(CastPose *out, const Cast *cast, const CastRound *round, double t_s);
/* Whether an entity is a munition that flew so. */
static inline bool cast_is_flown(const Cast *cast, int entity)
{
    const CastEntity *e = &cast->entity[entity];
    return e->group < 0 && cast->round[e->round].flight >= 0;
}

/* Private to the cast: finds the place of each entity that hides, in file order, after all others are placed; nets are
 * then where what they cover is. entities/exercise/cast_hide.c */
Status cast_hide(Cast *cast, const int *ids, const int *first, const Catalog *catalog, const HideJudge *judge);

/* Axes of a body as columns: x forward, y right, z down. */
void cast_axes(double r_enu_from_body[9], const double forward[3], const double up[3]);

#endif
