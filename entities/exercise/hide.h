/* entities/exercise/hide.h: where entities hide: among the plants of a synthetic ground, which the node that
 * shows them makes alike (terrain/ground/placed.h).
 *
 * Candidates about a place are drawn by the seed. Of those where the ground bears a vehicle, no plant has to be cleared
 * for it, and the surroundings are of the kind asked for, an estimate ranks how near each comes to the planned
 * occlusion: crowns as cylinders of a density, a slice of the height each (hide_sight.c). Of the nearest some are
 * judged by rays against the plants themselves, where the caller has a tracer (HideJudge), and the nearest of these is
 * taken. */
#ifndef ENTITIES_EXERCISE_HIDE_H
#define ENTITIES_EXERCISE_HIDE_H

#include "entities/exercise/hide_built.h"
#include "entities/exercise/hide_judge.h"
#include "entities/exercise/scenario.h"
#include "entities/models/model.h"

/* All of it, which outlives the grounds about places. */
typedef struct HideWorld {
    const Landscape *landscape;
    uint64_t         seed;
    const Culture   *culture; /* what is built, indexed, and laid on the landscape; NULL: nothing */
    const HideJudge *judge;   /* NULL: there is none */
} HideWorld;

/* The plants of a ground near a place, what is built there, and what else of it a hide asks for. */
typedef struct HideGround {
    const Landscape *landscape;
    const Culture   *culture;
    HideSolids       solids;
    Woods            woods;
    const HideJudge *judge; /* begun with these woods; NULL: there is none */
} HideGround;

/* About a place of the landscape's ENU; half_m: how far plants are known. */
Status hide_ground_open(HideGround *out, const HideWorld *world, const double about_m[2], double half_m);
void   hide_ground_close(HideGround *ground); /* accepts zeroes */

/* The triangles of a model at rest. */
typedef struct HideShape {
    const Model *model;
    int          count;
    double       radius_m;
    double (*corner)[3][3]; /* [count], body axes */
} HideShape;
Status hide_shape_open(HideShape *out, const Model *model);
void   hide_shape_close(HideShape *shape); /* accepts zeroes */

/* Something solid that hides what stands behind it. */
typedef struct HideBox {
    double    p_enu[3], nose[2]; /* of its origin; unit, level */
    HideShape shape;
} HideBox;

/* Where an entity stands, of the landscape's ENU. */
typedef struct HidePose {
    double p_enu[3], nose[2];
} HidePose;

/* The observer that is hidden from: the direction to it, and how far it is. */
typedef struct HideSight {
    double d_enu[3], range_m;
} HideSight;
HideSight hide_sight(const Scenario *scenario);

/* Points of a model's surface at rest as seen from one side, body axes, one of each cell of a grid across the line of
 * sight. */
enum { hide_points_most = 400 };
typedef struct HidePoints {
    int    count;
    double p_body[hide_points_most][3];
} HidePoints;
Status hide_points(HidePoints *out, const HideShape *shape, const double d_body[3]);

/* Estimated share of these points that plants, ground, what is built and the box (NULL: none) hide, 0 .. 1. left_out
 * (NULL: not asked): plants and triangles along the line that are not looked at, since there are more than the limits
 * (hide_plants_most, hide_solids_most). */
enum { hide_plants_most = 4096 };
double hide_occlusion(int *left_out, const HideGround *ground, const HidePose *pose, const HidePoints *points,
                      const HideSight *sight, const HideBox *box);
/* The same by the judge of the ground. False: it could not. */
bool hide_judged(double *occlusion, const HideGround *ground, const HidePose *pose, const HidePoints *points,
                 const HideSight *sight, const HideBox *box);

/* What hides of one slice of eight of a plant's height, counted from the foot, of a plant 1 m high: the radius of its
 * cylinder, m, and the density that its leaves and branches have to a ray, 1/m. */
void hide_crown(double *radius_m, double *per_m, PlantKind kind, int slice);

/* What is asked of a place, and what was found. */
typedef struct HideWish {
    enum ScenarioHide kind;
    double            about_m[2], within_m;
    double            occlusion;   /* planned, 0 .. 0.95 */
    double            heading_rad; /* NaN: drawn */
    HideShape         shape;
    const HideBox    *beside; /* of SCENARIO_HIDE_BESIDE */
    const double (*taken)[2]; /* [taken_count] places of others, which keep hide_apart_m away */
    int      taken_count;
    uint64_t seed, number; /* of its random numbers */
} HideWish;
static const double hide_apart_m = 14;

typedef struct HideFound {
    HidePose pose;
    double   heading_rad;
    double   occlusion; /* judged, else estimated */
    int      fit;       /* candidates that were of the kind */
    int      left_out;  /* as hide_occlusion's, the most of any candidate */
} HideFound;
/* False: no candidate is of that kind. */
bool hide_find(HideFound *out, const HideGround *ground, const HideWish *wish, const HideSight *sight);

#endif
