/* render/heat/heat.h: the heat of the ground in a frame: its columns, trunks and branches, shade of the hours before,
 * marks. */
#ifndef RENDER_HEAT_HEAT_H
#define RENDER_HEAT_HEAT_H

#include "render/heat/ground_column_private.h"
#include "pitviper_cache.h"
#include "terrain/elevation/elevation.h"
#include "entities/table/snapshot.h"
#include "terrain/earth/geodesy.h"

/* ---- trunks and branches --------------------------------------------------------------------- */

/* Heat of trunks and branches: conduction in a round body by its diameter and side.
 *
 * Temperature over the sides of a cylinder in three parts, each of which conducts by itself: the mean, the side towards
 * the sun or sky (cosine), and how much narrower the sunlit side is than that (cosine of twice the angle, of upright
 * trunks). Rings of the radius, backward Euler. Thin branches are taken to point everywhere, those thicker than 30 mm
 * to stand upright. The film is that of a cylinder across the wind (Churchill & Bernstein, J. Heat Transfer 99, 1977).
 *
 * Error: test_branch.c, against finite volumes over rings and sides. */

enum { branch_radii = 5, branch_rings = 8, branch_most_kinds = 24 };
static const double branch_radius_m[branch_radii] = {0.004, 0.012, 0.04, 0.12, 0.3};

/* Wood under its bark. */
typedef struct BranchKind {
    int    material; /* row of the table of materials: how hits name it */
    double conductivity_w_mk, capacity_j_m3k, absorptance, emissivity;
} BranchKind;

/* Temperature of a side: mean + side . n + twice[0] (nx^2 - ny^2) + twice[1] 2 nx ny, K. */
typedef struct BranchSides {
    float mean_k, side_k[3], twice_k[2];
} BranchSides;

typedef struct Branch {
    const BranchKind *kind;
    double            radius_m;
    double            part[6][branch_rings]; /* mean, side, twice; outermost ring first */
    double            face_k[6];             /* of the bark's face */
} Branch;

void heat_branch_start(Branch *out, const BranchKind *kind, double radius_m, double temp_k);
/* sun: share of the direct sun that it gets; ground_k: of what it sees below. */
void heat_branch_step(Branch *branch, const GroundWeather *after, double sun, double ground_k, double dt_s);
void heat_branch_sides(BranchSides *out, const Branch *branch);

static inline double branch_side_k(const BranchSides *s, const double n[3])
{
    return (double)s->mean_k + (double)s->side_k[0] * n[0] + (double)s->side_k[1] * n[1] + (double)s->side_k[2] * n[2] +
           (double)s->twice_k[0] * (n[0] * n[0] - n[1] * n[1]) + (double)s->twice_k[1] * 2 * n[0] * n[1];
}
/* W/(m2 K) */
double heat_branch_film_w_m2k(double radius_m, double wind_mps);

/* ---- the ground over an exercise ------------------------------------------------------------- */

/* Temperatures of the ground over an exercise: what stays of sun, shade and wind of the hours before.
 *
 * Columns. Each kind of ground is conduction in layers (ground_column_private.h) under the weather, for normals over
 * the whole upper hemisphere: in the open, in the shade of the direct sun, without any sun, and beneath something that
 * hides the sky. They advance on a fixed grid of time, step_s, from two days before the exercise, whatever frames are
 * rendered: temperatures at any time are straight lines between two times of the grid. A frame at a time before the
 * last one starts again from the beginning of the exercise.
 *
 * Shade of the hours before. A column's response to a loss of flux at a time in the past is that of a pulse of heat at
 * its surface now, computed backwards (conduction is its own adjoint), about the losses of that day. It gives a weight
 * for each half hour of the day past: the kelvins that the ground here lost if it was in the shade then. Their sum is
 * scaled so that shade all day is exactly the column in the shade, so that only the order of the hours is linear.
 *
 * Errors: rows of `bench precision` (step, elements, facets, hours of the past), tests/render/test_heat.c. */

/* Normals: octahedral, a square of facets x facets nodes of which the middle is level and the edge are walls. ups:
 * equal steps of n_up for what the sun's side does not change. */
enum { heat_most_facets = 17, heat_ups = 4, heat_day_slots = 48, heat_past = 96 };

/* Weather at a time; a pure function, called on several threads at once. */
typedef void HeatWeather(GroundWeather *out, double unix_s, const void *user);

typedef struct HeatConfig {
    GroundGrid   grid;
    double       step_s, spin_up_s; /* whole steps */
    int          facets;            /* odd, 3 .. heat_most_facets */
    double       unix_s;            /* of the exercise's beginning */
    HeatWeather *weather;
    const void  *user;
    Pool        *pool;  /* NULL: one thread */
    Cache       *cache; /* where the warm ground is kept; NULL: nowhere */
} HeatConfig;
HeatConfig heat_default_config(void); /* without weather */

/* What flux over past intervals does to the surface by now, for each kind: kelvins for 1 W/m2; for the direct sun that
 * was, per unit cosine; for the sky that was, its light and its cold. Newest first. */
typedef struct HeatPast {
    int    count;
    double unix_s[heat_past], span_s[heat_past]; /* middle of each interval, and its length */
    double sun_d_enu[heat_past][3];
    float  watt_k[ground_kinds][heat_past], sun_k[ground_kinds][heat_past], sky_k[ground_kinds][heat_past];
    float  effusivity[ground_kinds];  /* of what lies on top, J/(m2 K s^1/2) */
    float  diffusivity[ground_kinds]; /* likewise, m2/s */
} HeatPast;

/* At a time of the grid, or between two. */
typedef struct GroundHeatTable {
    double      unix_s;
    int         facets;
    double      air_k;
    float       sun_k[ground_kinds][heat_most_facets * heat_most_facets]; /* [v * facets + u] */
    float       shade_k[ground_kinds][heat_ups], dark_k[ground_kinds][heat_ups], hidden_k[ground_kinds];
    float       slot_k[ground_kinds][heat_day_slots];       /* of slot_d_enu: per unit cosine */
    BranchSides branch[branch_most_kinds][branch_radii][2]; /* in the sun, in the shade */
} GroundHeatTable;

typedef struct HeatNow {
    GroundHeatTable table;
    int             slots; /* half hours with the sun up; padded to a multiple of 8 with weight 0 */
    float           slot_d_enu[3][heat_day_slots];
    int             kind_of[SURFACE_COUNT]; /* forest floor for forests whose plants stand */
    int             branches, branch_material[branch_most_kinds];
    double          share; /* between the two times of the grid */
    HeatPast        past[2];
} HeatNow;

typedef struct Heat Heat;

/* Spins up. kinds and branch are copied. STATUS_NO_MEMORY, STATUS_BAD_VALUE. branches: 0 .. branch_most_kinds, of the
 * plants that stand; with some, forests are seen as their floor. */
Status heat_create(Heat **out, const GroundKinds *kinds, const HeatConfig *config, const BranchKind *branch,
                   int branches);
void   heat_destroy(Heat *heat); /* accepts NULL */
/* In the arena. Advances the state, and works ahead at the next step, some of it each time; times before the exercise:
 * as at its beginning. */
Status heat_now(HeatNow **out, Heat *heat, double unix_s, Arena *arena);
/* Level ground of a kind in the open, its temperatures with depth and its water, at the time of the last heat_now:
 * share as that has it. It points into heat. */
void heat_level(GroundColumn *out, const Heat *heat, int kind, double share);
/* Directions towards the sun of the slots, as HeatNow has them. Returns their number. */
int    heat_slots(float d_enu[3][heat_day_slots], const Heat *heat);
double heat_spent_s(const Heat *heat, int *steps); /* wall clock in steps since the spin-up, and how many */
size_t heat_bytes(const Heat *heat);

/* Temperatures of ground of a kind and normal, K, at the height of the weather's thermometer. share: of the direct sun
 * of the past, weighted by what is left of it, that was taken; 0: none, 1: all. open: share of its sky that is open.
 * dark: its absorptance over that of its kind. */
double heat_ground_k(const HeatNow *now, int kind, const double n_enu[3], double taken, double open, double dark);

/* The same of several places side by side: a lane's temperature depends on its place alone. */
enum { heat_lanes = 4 };
typedef struct HeatPlaces {
    int    kind[heat_lanes];
    double n_enu[3][heat_lanes], taken[heat_lanes], open[heat_lanes], dark[heat_lanes];
} HeatPlaces;
void heat_grounds_k(double temp_k[heat_lanes], const HeatNow *now, const HeatPlaces *place);

/* Bark of this material, radius and normal, K, at the height of the weather's thermometer. open: share of sun and sky
 * that reached it. Of other materials: the first; NAN where there is none. */
double heat_branch_k(const HeatNow *now, int material, double radius_m, const double n_enu[3], double open);

/* Kelvins that shade of all the past takes from level ground, and a hidden sky, over the sums of their responses: what
 * linear responses are scaled by. 1 where there is little to scale. */
void heat_scales(double *sun, double *sky, const HeatNow *now, int kind);

/* Share of the past direct sun on a normal that shade took: shadow[slot], 0 .. 255, are the shares of each slot. */
double heat_taken(const HeatNow *now, int kind, const double n_enu[3], const uint8_t *shadow);

/* ---- shade of relief and plants -------------------------------------------------------------- */

/* Where relief and standing plants shade the ground, at every half hour of a day.
 *
 * A grid over the finest level of the terrain. For each direction to the sun the height below which it is shaded is
 * carried from cell to cell away from the sun (one pass over the grid, straight between two cells of the row before);
 * among plants, the direct light that their leaves let through is added up along the ray. Shares of a cell, so that
 * edges are as soft as a cell is wide: narrower shadows, of single trunks and boulders, are not in it. */

typedef struct ShadowMap ShadowMap;

/* Plants of a place: leaf area index between base and top over the ground, 0: none, of leaves at random that hide as
 * much from overhead; and the share of an even sky that reaches the ground. */
typedef struct ShadowStand {
    float leaf_area, base_m, top_m, open;
} ShadowStand;
typedef void ShadowPlants(ShadowStand *out, const void *user, double x_m, double y_m);

/* The cells' centres: cell (i, j) is at x0_m + i cell_m, y0_m + j cell_m. */
typedef struct ShadowGrid {
    int    nx, ny;
    double x0_m, y0_m, cell_m;
} ShadowGrid;
/* Raises heights [ny][nx] to what stands there: a building's cell is shaded as its roof is, and casts a shadow from
 * there. Of a wall the map knows no more than which cells' centres are behind it: within a cell of it the shade of the
 * ground is that of the roof in part. */
typedef void ShadowRaise(float *z_m, const ShadowGrid *grid, const void *user);

enum { shadow_most_slots = 48, shadow_most_cells = 4000000 };

/* cell_m: made larger where the grid would have more than shadow_most_cells. d_enu: towards the sun, d_enu[2] > 0.
 * plants: NULL: none. pool: NULL: one thread; the same bits either way. */
typedef struct ShadowOf {
    const Elevation *elevation;
    double           cell_m;
    int              slots;
    float (*d_enu)[shadow_most_slots]; /* [3] */
    ShadowPlants *plants;
    const void   *user;
    Cache        *cache;   /* where the map is kept; NULL: nowhere */
    const float  *clumped; /* [slots]: factor on the leaf area for light of that slot; NULL: 1 */
    ShadowRaise  *raise;   /* NULL: nothing but plants stands on the ground */
    const void   *raise_user;
} ShadowOf;
Status heat_shadow_create(ShadowMap **out, const ShadowOf *of, Pool *pool);
void   heat_shadow_destroy(ShadowMap *map); /* accepts NULL */
/* Shares in the shade at a place, of 255, shadow[slots, padded to a multiple of 8 with 0]; and the share of its sky
 * that is open past plants. Beyond the grid: open. Returns false where it is lit and open all day. */
bool   heat_shadow_at(uint8_t shadow[shadow_most_slots], double *open, const ShadowMap *map, double x_m, double y_m);
size_t heat_shadow_bytes(const ShadowMap *map);
double heat_shadow_cell_m(const ShadowMap *map);

/* ---- marks ----------------------------------------------------------------------------------- */

/* What entities left in the ground's heat: shadows of those that stood there, trails, burnt ground.
 *
 * A stand hid the sun along its box's shadow, and sky, while it stood (stand_heat_private.h): each past interval of
 * HeatPast that it overlaps gives kelvins by the kind's response, scaled as the shade of heat.h is: sun hidden all day,
 * or all of the sky hidden, are the columns that see none. Shadows lie where the sun put them, by the age of each up to
 * the frame's time, and are soft by the sun's path and by conduction sideways. A track was rubbed warm once, by a pulse
 * of heat that the same response lets fade, and lies loosened: some of the way to ploughed ground, for good. A burst
 * burnt its ground but for the crater, which is loose soil, and left heat. The exhaust of what stands warms the ground
 * that it reaches (vehicle_load_private.h, in still air: what reaches the ground does so within metres of the outlet,
 * before a wind bends it): a flux by the film of its speed (vehicle_heat.h) that falls as the ground warms, through the
 * kind's response; ground that the sun has made warmer than the gas is not cooled, and the gas' radiation is left out.
 * Estimates: the loosened share (0.6 of tracks, 0.3 of wheels), the burnt edge. */

typedef struct MarkHeat MarkHeat;

/* Of the snapshot's marks, in the arena. exercise_s: Unix time of exercise time 0. *out NULL: there are none. */
Status heat_marks_create(MarkHeat **out, const GroundMarks *marks, const LocalFrame *frame, double exercise_s,
                         double unix_s, const HeatNow *now, Arena *arena);

/* At a place of the ground: its kind may be mixed with another, and its temperature changed. */
typedef struct MarkedGround {
    double add_k; /* to the temperature of the kind */
    double loose; /* share of ploughed ground */
    double burnt; /* share of burnt ground */
} MarkedGround;

/* lit: share of the past sun that relief and plants left. False: no marks near; out is zero then. */
bool heat_marks_at(MarkedGround *out, const MarkHeat *marks, int kind, const double p_enu[3], const double n_enu[3],
                   double lit);

/* ---- the ground in one frame ----------------------------------------------------------------- */

typedef struct SceneryTemps SceneryTemps; /* render/heat/scenery_heat.h */

typedef struct HeatScene {
    const HeatNow      *now;
    const ShadowMap    *shadow;  /* NULL: nothing shaded it */
    const MarkHeat     *marks;   /* NULL: none */
    const SceneryTemps *scenery; /* NULL: scenery is as warm as the air */
} HeatScene;

/* Places of the ground side by side: class, place, normal, and absorptance over that of the kind. */
typedef struct GroundPlaces {
    int    surface[heat_lanes];
    double p_enu[3][heat_lanes], n_enu[3][heat_lanes], dark[heat_lanes];
} GroundPlaces;

/* Temperatures of the ground, K, at the height of the weather's thermometer, and how far the sun of the past lifted
 * them. A lane's depends on its place alone. */
void heat_scene_grounds_k(double temp_k[heat_lanes], double lifted_k[heat_lanes], const HeatScene *scene,
                          const GroundPlaces *at);

/* The same of one place. */
double heat_scene_ground_k(double *lifted_k, const HeatScene *scene, int surface, const double p_enu[3],
                           const double n_enu[3], double dark);

#endif
