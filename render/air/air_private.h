/* render/air/air_private.h: daylight in passes, and the tables of paths, shared by daylight*.c and air*.c. */
#ifndef RENDER_AIR_AIR_PRIVATE_H
#define RENDER_AIR_AIR_PRIVATE_H

#include "render/air/atmosphere.h"
#include "render/air/air.h"

/* ---- daylight -------------------------------------------------------------------------------- */

/* Daylight in passes of tasks, so that a pool runs them beside those of an eye: first
 * all evaluations, then all interpolations, then all planes, each in any order and by any thread; then the end. */

/* Temperatures of emitters for which transmittance is stored; between them its depth is linear in the temperature's
 * logarithm, as in the tables, outside the nearest is used. The AirDay has these and, behind them, the air's own. */
enum { air_temps = 5 };
static const double emitter_temp_k[air_temps] = {260, 300, 400, 600, 1000};

typedef struct DaylightJob DaylightJob;

/* The totals of these bands and of pan. diffuse_w_m2: the tables' own. */
void daylight_sums(Daylight *out, const AirSource *source, const Weather *weather, const Sun *sun, unsigned bands,
                   double diffuse_w_m2[AIR_BAND_COUNT]);
/* Light of the sky on level ground by band, over that with the sun where twilight begins; 1 above. To the horizon it is
 * that of the tables, below it falls as measured illuminance does and has the colour that ozone gives it. By night,
 * below -18 degrees, it stays. Illuminance is within a factor of 1.3 of clear skies' (twilight.c says whose); the
 * bands' shares from -6 to -18 degrees within a factor of 1.5. */
static const double twilight_begins_deg = 5;
void twilight(double scale[AIR_BAND_COUNT], const Atmosphere *atmosphere, double visibility_m, double elevation_rad,
              unsigned bands);
/* What daylight is computed from, and which of it is requested. */
typedef struct DaylightInput {
    const AirSource *source;
    const Weather   *weather;
    const Sun       *sun;
    unsigned         bands;   /* 1 << AirBand */
    AirSky          *other;   /* [AIR_BAND_COUNT], filled in with the sky from another height; NULL: not requested */
    AirLimb         *limb;    /* [AIR_BAND_COUNT], with what is below its horizontal; NULL as other is */
    double           other_m; /* that height */
} DaylightInput;

/* Allocates the passes, and evaluates what they share. STATUS_NO_MEMORY, and what air_day_at returns. */
Status daylight_begin(DaylightJob **out, Daylight *light, const DaylightInput *in, Arena *arena);
int    daylight_asks(const DaylightJob *job);
void   daylight_ask(DaylightJob *job, int ask);
int    daylight_draws(const DaylightJob *job);
void   daylight_draw(DaylightJob *job, int draw);
int    daylight_planes(const DaylightJob *job);
void   daylight_plane(DaylightJob *job, int plane);
void   daylight_end(DaylightJob *job);

/* The pool's tasks, or in order where there is none. */
void air_run(Pool *pool, int count, PoolTask *task, void *user);

/* Cubic through four equidistant points, at t of the middle step. */
static inline double cubic_between(double a, double b, double c, double d, double t)
{
    return b + t * (c - b) + t * (t - 1) / 6 * ((2 - t) * (a - 2 * b + c) + (1 + t) * (b - 2 * c + d));
}

/* The arc cosine, within 7e-5 rad: Abramowitz & Stegun 4.4.45. Steps of the tables are 0.26 rad. */
double acos_quick(double c);
/* Position in the sky of an eye, from its horizontal up, of a direction of this rate of climb. */
void air_sky_place(SkyPlace *out, const double sun_d_enu[3], const double d_enu[3], double climb);
/* Cosine of the angle between two directions' azimuths, by their level parts; 1 where one has none. */
double cos_azimuth(const double a_enu[3], const double b_enu[3]);

/* ---- paths: air.c, air_table.c, air_paths.c -------------------------------------------------- */

/* Paths from one eye. Extinction, and the air's own emission, by the far end's height and the range, both in octaves
 * (of 100 m, the tables' nearest, and of the height plus 64 m) cut evenly, so that the table index is taken from the
 * bits of the float: log2(1 / tau), which is linear in range in a grey and homogeneous atmosphere; and the path's
 * radiance over 1 - tau, its mean source. Scattered light, over 1 - tau of the sun, also depends on the direction of
 * a path: by its slope, rise over range, s |s| with s in equal steps over what is looked at; by the root of its
 * share of the complete path, to the ground or to the top of the tables, so that ground is at its end; and by
 * sqrt(1 - cos azimuth from the sun), which needs no arc cosine and is dense about the sun. The values of a node are
 * contiguous. */
enum { air_octaves = 13, air_range_cuts = 8, air_range_shift = 20 /* bits of a number in one of eight cuts */ };
enum { air_ranges = air_octaves * air_range_cuts, air_rows_most = 48 };
enum { air_slopes = 24, air_shares = 40, air_turns = 12, air_lights = 4 };
enum { air_range_row = air_ranges + 1, air_nodes = (air_rows_most + 1) * air_range_row };
enum { air_share_row = air_shares + 1, air_slope_nodes = (air_slopes + 1) * air_share_row };

/* Ten metres of air below the eye do not change the sky above it. */
static const double air_ground_eye_m = 10;
static const double air_top_m = 20e3, air_near_m = 100, air_far_m = 819200, air_low_m = 64;
/* The complete path ends at the ground or the tables' top, and after 100 km, beyond which little light is added, or at
 * the Earth's edge where that is farther.
 * From less than 200 m up it continues along the ground, as if from there: the air below is much the same. */
static const double air_shortest_way_m = 10, air_longest_way_m = 100e3, air_least_fall_m = 200;

/* Four bands that sunlight is scattered in. */
typedef struct AirLight {
    int     bands;
    AirBand band[air_lights];
    float   depth[air_nodes][air_lights];                            /* log2(1 / tau) of sunlight reflected */
    float   log2_source[air_turns + 1][air_slope_nodes][air_lights]; /* W/(m2 sr); it falls off as e does */
} AirLight;

/* The two thermal bands, mwir before lwir: depth of emission at the air's temperature, at emitter_temp_k[t] and the
 * next, and the path's own radiance over 1 - tau of the first, W/(m2 sr). */
typedef enum AirWarm { air_warm_own, air_warm_low, air_warm_high, air_warm_source, air_warm_values } AirWarm;
typedef struct AirHeat {
    float value[air_temps - 1][air_nodes][2 * air_warm_values];
} AirHeat;

struct AirTable {
    int       rows, row_shift; /* steps of height; bits of a number within one: 20 or 21, 8 or 4 to an octave */
    bool      scattered;
    float     slope_low, slope_steps;        /* s at the first step, steps per unit of s */
    float     slope_edge, slope_steps_above; /* the same from the Earth's edge on; INFINITY: it is not seen */
    float     turn_low, turn_steps; /* the same of sqrt(1 - cos azimuth); beyond the first and last the nearest */
    int       turns;                /* steps between them, .. air_turns */
    int       lights;               /* of light[] */
    AirLight *light[2];
    AirHeat  *heat; /* NULL: no thermal band */
};

/* Paths by the tables, without rain, snow and fog; of hits count and range_m alone. */
void air_paths_clear(AirPaths *const out[AIR_BAND_COUNT], const Air *air, const Hits *hits, const Rays *rays,
                     const float *temp_k);
/* Of an eye above the tables' top: fills in above_w_m2_sr and below_w_m2_sr; thermal radiance to add to a path of
 * path_w_m2_sr by its rate of climb, of mwir (thermal 0) and lwir: together not below 0. */
void   air_above_fill(Air *air);
double air_above_there(const Air *air, int thermal, double climb, double path_w_m2_sr);
/* Adds rain, snow and fog to paths by tables or without: droplets_paths.c. */
void droplets_on_paths(AirPaths *const out[AIR_BAND_COUNT], const Air *air, const Hits *hits, const Rays *rays);
/* To a row of the sky over the ground, as air_day_sky gives it; thermal: mwir, lwir. */
void droplets_in_sky(double (*w_m2_sr)[AIR_BAND_COUNT], double thermal_w_m2_sr[2], const Daylight *light,
                     unsigned bands, double zenith_rad, const double *azimuth_rad, int azimuths);

/* The float whose bits are this number of steps of 2^shift above those of low. */
static inline float air_step_up(double low, int steps, int shift)
{
    const float from = (float)low;
    uint32_t    bits;
    memcpy(&bits, &from, sizeof bits);
    bits += (uint32_t)steps << shift;
    float to;
    memcpy(&to, &bits, sizeof to);
    return to;
}

/* Height from which the eye's paths are: of one above the tables' top that at which they enter the air. */
static inline double air_from_m(const Air *air) { return fmin(air->eye_height_m, air_top_m); }

static inline double air_longest_m(const Air *air)
{
    return fmax(air_longest_way_m, sqrt(2 * earth_radius_m * air_from_m(air)));
}

/* Rise over range of the path from there to the Earth's edge. */
static inline double air_edge_slope(const Air *air)
{
    const double from_m = fmax(air_from_m(air), 1e-3);
    return -from_m / sqrt(from_m * (2 * earth_radius_m + from_m));
}

/* Along a ray from above the tables' top, where it enters the air; INFINITY: it does not. */
static inline double air_entry_m(double eye_m, double climb)
{
    const double r_m = earth_radius_m + eye_m, down_m = -r_m * climb;
    const double above = (eye_m - air_top_m) * (2 * earth_radius_m + eye_m + air_top_m), disc = down_m * down_m - above;
    return eye_m <= air_top_m ? 0 : climb < 0 && disc > 0 ? above / (down_m + sqrt(disc)) : INFINITY;
}

/* Rate of climb of a ray from a position near the eye, whose tangent plane is not quite the origin's. */
static inline double air_climb(const double o_enu[3], const double d_enu[3])
{
    return d_enu[2] + (o_enu[0] * d_enu[0] + o_enu[1] * d_enu[1]) / earth_radius_m;
}

/* ---- below the horizontal: air_limb.c -------------------------------------------------------- */

/* Evaluated rows of a stack, and azimuths, of the sky below an eye's horizontal, without the ring about the sun. */
enum { air_limb_asks = air_limb_steps / 2, air_sky_asked_azimuths = air_sky_azimuths / 2 };
typedef struct AskedLimb {
    double scattered_w_m2_sr[air_limb_asks + 1][air_sky_asked_azimuths + 1], thermal_w_m2_sr[air_limb_asks + 1];
} AskedLimb;

/* A ray in the rows. level: share of the sky's lowest row, for rays above all rows. */
typedef struct LimbPlace {
    int    stack;
    double share, level; /* share: of its steps */
} LimbPlace;

/* Evaluated steps of a stack from this height. */
int air_limb_rows(double eye_m, int stack);
/* Rate of climb of a ray at this share of a stack's steps. */
double    air_limb_climb(double eye_m, int stack, double share);
LimbPlace air_limb_place(double eye_m, double climb);
/* Fills in a stack from its evaluated rows, steps + 1. */
void   air_limb_draw(AirLimb *out, int stack, const AskedLimb *asked, int steps);
double air_limb_there(const Air *air, int band, const LimbPlace *limb, const SkyPlace *place);
/* All azimuths of a row from the evaluated ones. */
void air_sky_azimuth_row(double out[air_sky_azimuths + 1], const double in[air_sky_asked_azimuths + 1]);

/* Square of the sine of the angle by which the Earth's edge is below the horizontal. */
static inline double air_edge2(double eye_m)
{
    return eye_m * (2 * earth_radius_m + eye_m) / ((earth_radius_m + eye_m) * (earth_radius_m + eye_m));
}

/* Extent of air->table: these bands, between two azimuths from the sun and two slopes, up to a height. */
typedef struct TableInput {
    double   azimuth_low_rad, azimuth_high_rad, slope_low, slope_high, height_high_m; /* slopes as rise over range */
    unsigned bands;
} TableInput;

/* The tables of paths and of the sky below the horizontal meet at the Earth's edge, where each has its own error of
 * interpolation: the lowest quarter of the sky's rows takes over that of the paths. STATUS_NO_MEMORY. */
Status air_edge_meet(Air *air, const TableInput *in, Arena *arena);

/* First every evaluation of the atmosphere, in any order and by any thread, then every interpolation. */
typedef struct TableJob TableJob;
Status                  air_table_begin(TableJob **out, Air *air, const TableInput *input, Arena *arena);
int                     air_table_asks(const TableJob *job);
void                    air_table_ask(TableJob *job, int ask);
int                     air_table_draws(const TableJob *job);
void                    air_table_draw(TableJob *job, int draw);

#endif
