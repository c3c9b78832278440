/* render/heat/heat.h: temperatures of the ground over an exercise: what stays of sun, shade and wind of the hours before.
 *
 * Columns. Each kind of ground is conduction in layers (ground_column.h) under the weather, for normals over the whole
 * upper hemisphere: in the open, in the shade of the direct sun, without any sun, and beneath something that hides the sky.
 * They advance on a fixed grid of time, step_s, from two days before the exercise, whatever frames are rendered:
 * temperatures at any time are straight lines between two times of the grid. A frame at a time before the last one starts
 * again from the beginning of the exercise.
 *
 * Shade of the hours before. A column's response to a loss of flux at a time in the past is that of a pulse of heat at
 * its surface now, computed backwards (conduction is its own adjoint), about the losses of that day. It gives a weight for
 * each half hour of the day past: the kelvins that the ground here lost if it was in the shade then. Their sum is scaled so
 * that shade all day is exactly the column in the shade, so that only the order of the hours is linear.
 *
 * Errors: rows of `bench precision` (step, elements, facets, hours of the past), tests/render/test_heat.c. */
#ifndef RENDER_HEAT_HEAT_H
#define RENDER_HEAT_HEAT_H

#include "render/heat/branch.h"
#include "render/heat/ground_kinds.h"

/* Normals: octahedral, a square of facets x facets nodes of which the middle is level and the edge are walls. ups:
 * equal steps of n_up for what the sun's side does not change. */
enum { heat_most_facets = 17, heat_ups = 4, heat_day_slots = 48, heat_past = 96 };

/* Weather at a time; a pure function. */
typedef void HeatWeather(GroundWeather *out, double unix_s, const void *user);

typedef struct HeatConfig {
    GroundGrid   grid;
    double       step_s, spin_up_s; /* whole steps */
    int          facets;            /* odd, 3 .. heat_most_facets */
    double       unix_s;            /* of the exercise's beginning */
    HeatWeather *weather;
    const void  *user;
    Pool        *pool;              /* NULL: one thread */
} HeatConfig;
HeatConfig heat_default_config(void); /* without weather */

/* What flux over past intervals does to the surface by now, for each kind: kelvins for 1 W/m2; for the direct sun that was, per
 * unit cosine; for the sky that was, its light and its cold. Newest first. */
typedef struct HeatPast {
    int    count;
    double unix_s[heat_past], span_s[heat_past]; /* middle of each interval, and its length */
    double sun_d_enu[heat_past][3];
    float  watt_k[ground_kinds][heat_past], sun_k[ground_kinds][heat_past], sky_k[ground_kinds][heat_past];
    float  effusivity[ground_kinds];        /* of what lies on top, J/(m2 K s^1/2) */
} HeatPast;

/* At a time of the grid, or between two. */
typedef struct GroundHeatTable {
    double unix_s;
    int    facets;
    double air_k;
    float  sun_k[ground_kinds][heat_most_facets * heat_most_facets]; /* [v * facets + u] */
    float  shade_k[ground_kinds][heat_ups], dark_k[ground_kinds][heat_ups], hidden_k[ground_kinds];
    float  slot_k[ground_kinds][heat_day_slots];                     /* of slot_d_enu: per unit cosine */
    BranchSides branch[branch_most_kinds][branch_radii][2];          /* in the sun, in the shade */
} GroundHeatTable;

typedef struct HeatNow {
    GroundHeatTable table;
    int       slots;                       /* half hours with the sun up; padded to a multiple of 8 with weight 0 */
    float     slot_d_enu[3][heat_day_slots];
    int       kind_of[SURFACE_COUNT];      /* forest floor for forests whose plants stand */
    int       branches, branch_material[branch_most_kinds];
    double    share;                       /* between the two times of the grid */
    HeatPast  past[2];
} HeatNow;

typedef struct Heat Heat;

/* Spins up. kinds and branch are copied. STATUS_NO_MEMORY, STATUS_BAD_VALUE. branches: 0 .. branch_most_kinds, of the plants
 * that stand; with some, forests are seen as their floor. */
Status heat_create(Heat **out, const GroundKinds *kinds, const HeatConfig *config, const BranchKind *branch, int branches);
void   heat_destroy(Heat *heat); /* accepts NULL */
/* In the arena. Advances the state, and works ahead at the next step, some of it each time; times before the exercise: as at
 * its beginning. */
Status heat_now(HeatNow **out, Heat *heat, double unix_s, Arena *arena);
/* Level ground of a kind in the open, its temperatures with depth and its water, at the time of the last heat_now: share as
 * that has it. It points into heat. */
void   heat_level(GroundColumn *out, const Heat *heat, int kind, double share);
/* Directions towards the sun of the slots, as HeatNow has them. Returns their number. */
int    heat_slots(float d_enu[3][heat_day_slots], const Heat *heat);
double heat_spent_s(const Heat *heat, int *steps); /* wall clock in steps since the spin-up, and how many */
size_t heat_bytes(const Heat *heat);

/* Temperatures of ground of a kind and normal, K, at the height of the weather's thermometer. share: of the direct sun of
 * the past, weighted by what is left of it, that was taken; 0: none, 1: all. open: share of its sky that is open. dark: its
 * absorptance over that of its kind. */
double heat_ground_k(const HeatNow *now, int kind, const double n_enu[3], double taken, double open, double dark);

/* The same of several places side by side: a lane's temperature depends on its place alone. */
enum { heat_lanes = 4 };
typedef struct HeatPlaces {
    int    kind[heat_lanes];
    double n_enu[3][heat_lanes], taken[heat_lanes], open[heat_lanes], dark[heat_lanes];
} HeatPlaces;
void heat_grounds_k(double temp_k[heat_lanes], const HeatNow *now, const HeatPlaces *place);

/* Bark of this material, radius and normal, K, at the height of the weather's thermometer. open: share of sun and sky that
 * reached it. Of other materials: the first; NAN where there is none. */
double heat_branch_k(const HeatNow *now, int material, double radius_m, const double n_enu[3], double open);

/* Kelvins that shade of all the past takes from level ground, and a hidden sky, over the sums of their responses: what linear
 * responses are scaled by. 1 where there is little to scale. */
void   heat_scales(double *sun, double *sky, const HeatNow *now, int kind);

/* Share of the past direct sun on a normal that shade took: shadow[slot], 0 .. 255, are the shares of each slot. */
double heat_taken(const HeatNow *now, int kind, const double n_enu[3], const uint8_t *shadow);

#endif
