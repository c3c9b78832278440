/* render/air/atmosphere_private.h: the tables in memory. */
#ifndef RENDER_AIR_ATMOSPHERE_PRIVATE_H
#define RENDER_AIR_ATMOSPHERE_PRIVATE_H

#include "pitviper_table.h"
#include "render/air/atmosphere.h"
#include "render/air/vapour_private.h"
#include "render/materials/planck.h"

/* Bands that have tables of their own; AIR_PAN is the sum of b, g and r. */
enum { air_tabled_count = 6 };
extern const AirBand air_tabled[air_tabled_count];
int                  air_tabled_index(AirBand band);
static inline bool   air_band_is_thermal(AirBand band) { return band == AIR_MWIR || band == AIR_LWIR; }

/* ---- a table over a full grid of up to four axes ------------------------------------------- */

enum { grid_max_axes = 4, grid_max_values = 24, grid_max_nodes = 256, height_max_m = 100000 };

typedef struct GridColumn {
    const char *name;
    double      low, high; /* valid range of a cell */
} GridColumn;

typedef struct Grid {
    int     axes, values;
    int     nodes[grid_max_axes];
    double *axis[grid_max_axes]; /* ascending */
    double *value;               /* [node of axis 0][..][values] */
} Grid;

/* The format of a file of numbers, in room for its columns: those and these. */
TableFormat atmosphere_format(TableColumn *column, const GridColumn *first, int firsts, const GridColumn *then,
                              int thens);
/* Every combination of the axes' values exactly once, in any order. */
Status grid_open(Grid *out, const char *path, const GridColumn *axis, int axes, const GridColumn *value, int values);
void   grid_close(Grid *grid);
/* Multilinear, clamped to the axes; out [values]. */
void grid_at(double *out, const Grid *grid, const double *at);
/* Only count of them, from first on in steps. */
void grid_some(double *out, const Grid *grid, const double *at, int first, int step, int count);

/* Index of the interval that holds x, 0 .. count - 2, and the share of its upper end, 0 .. 1. */
int interval_of(double *share, const double *ascending, int count, double x);
/* Distinct values in rising order; -1: more than capacity. axis_find: which is x. */
int axis_from(double *axis, int capacity, const double *values, int count);

/* ---- paths: an observer's height, a target's height or a direction, and for each pair a list of ranges ---- */

enum { path_max_nodes = 40, path_max_weights = 12, path_max_suns = 24, stencil_max = 16 };

typedef struct PathTable {
    int     nodes[2], rows, values;  /* values: a row */
    double  axis[2][path_max_nodes]; /* observer_m; target_m, or minus the cosine of the zenith angle */
    int    *first;                   /* [pairs + 1]: rows of pair observer * nodes[1] + target */
    double *ln_range, *value;        /* [rows], [rows * values] */
    double  ln_range_low;            /* shortest of all */
    int     shape;                   /* of an atmosphere's tables, those with equal nodes and ranges have the same
                                      * number */
    /* meaning of the values. Of clear air ln of the ratio of each weight's depth (0: the sun; then rising temperatures)
     * to the column's; of a visibility the ratio of the depth that haze adds to its column's, and, of thermal bands,
     * ln of the ratio of what the path would radiate if it were opaque to mean_black; of scattered.csv, which goes by
     * direction, the ratio to scatter_estimate by sun zenith, relative azimuth, band */
    int    weights;
    double weight_temp_k[path_max_weights];
    int    suns, azimuths;
    double sun_x[path_max_suns], azimuth_deg[path_max_suns]; /* sun: slant_x of its zenith angle */
} PathTable;

/* Selects the value columns of a header; logs the reason on failure. */
typedef Status PathColumns(PathTable *out, const TableRows *rows, GridColumn *column, int *count);
/* Rows keyed by the first keys (3 or 5) of observer_m, target_m (5: zenith_deg), range_m, sun_zenith_deg,
 * rel_azimuth_deg; as value columns those given or, with choose, those it finds. Values as they are in the file, by
 * rising keys; axis 1 and sun_x in metres or degrees. */
Status paths_open(PathTable *out, const char *path, int keys, const GridColumn *value, int values, PathColumns *choose);
void   paths_close(PathTable *table);
/* The same heights and ranges; and equal columns as well. */
bool paths_same_shape(const PathTable *a, const PathTable *b);
bool paths_alike(const PathTable *a, const PathTable *b);

/* The weight for the path's own emission: that of the temperature nearest the air's. */
int path_emission_weight(const PathTable *table);

/* Rows and their shares: linear along both axes, cubic in ln range. */
typedef struct Stencil {
    int    count;
    int    row[stencil_max];
    double share[stencil_max];
} Stencil;

void   stencil_at(Stencil *out, const PathTable *table, double observer_m, double second, double range_m);
double stencil_value(const Stencil *stencil, const PathTable *table, int value);

/* ---- a visibility, a model ----------------------------------------------------------------- */

enum { column_max = 256, slices_max = 12, phase_heights_max = 8 };
enum { steps_between = 6, slices_made_max = steps_between * (slices_max + 1) + 1 };

/* Optical properties per metre of air, by height, of clear air or of haze; sums from the ground up so that a mean is
 * a difference. */
typedef struct AirColumn {
    int    nodes;
    double height_m[column_max];
    double per_m[AIR_BAND_COUNT][column_max], sum[AIR_BAND_COUNT][column_max]; /* extinction */
    double scatter_per_m[AIR_BAND_COUNT][column_max];
    double black_per_m[2][column_max], black_sum[2][column_max]; /* extinction times black air; of mwir, lwir */
} AirColumn;

typedef struct Slice {
    double              visibility_m, longwave_down_w_m2;
    bool                has_paths, has_scattered; /* files of its own for path; for scattered and sky_scattered */
    AirColumn           haze;
    PathTable           path[AIR_BAND_COUNT];
    PathTable           scattered;     /* ratio to scatter_estimate */
    Grid                sky_thermal;   /* observer_m, slant_x of the zenith angle; ln ratio to black air, mwir lwir */
    Grid                sky_scattered; /* observer, view, sun, azimuth: ratio to the estimate */
    Grid                sun;           /* observer, sun: ln depth [6], then ln (diffuse / top) [6] */
    const struct Slice *from;          /* under a weather: the model's own; NULL: this is */
} Slice;

struct Atmosphere {
    int          slices;
    Slice       *slice;         /* rising visibility: every table's and some between and beyond, or only one */
    double       low_m, high_m; /* valid visibilities */
    double       sun_top_w_m2[AIR_BAND_COUNT];
    AirColumn    clear;
    PathTable    clear_path[AIR_BAND_COUNT];
    Grid         temperature;
    PlanckTable *planck[2];    /* mwir, lwir */
    Grid         solar;        /* visibility, water, ground, sun: ln depth and ln diffuse: atmosphere_solar.c */
    Grid         phase;        /* height_m, scattering angle in rad: ln of haze's phase function, mean 1 */
    Grid         limb;         /* visibility, observer_m, place: factors of mwir, lwir; none: without the file */
    double       ground_kg_m3; /* vapour of its own air; NaN: its tables do not say */
    /* what follows the weather; NULL: nothing, the air is its own tables' */
    Vapour          *vapour;
    int              vapour_profile, vapour_channel[AIR_BAND_COUNT]; /* the model's own; -1: none of that channel */
    const int       *vapour_row;                                     /* of clear_path's rows, [rows] */
    const VapourMix *mix;                                            /* under a weather; NULL: the model's own air */
};

/* The model under a weather, without what paths need: the sun, longwave light, temperatures. */
typedef struct AirSums {
    Atmosphere air;
    VapourMix  mix;
    double     level_k[vapour_levels_max];
} AirSums;
/* The model itself where it does not follow the weather. */
const Atmosphere *atmosphere_sums_in(AirSums *room, const Atmosphere *model, const AirState *state);
/* vapour.bin, for a model that is one of its profiles; else none. */
Status atmosphere_vapour_open(Atmosphere *atmosphere, const char *model);
void   atmosphere_vapour_close(Atmosphere *atmosphere);

/* Of a visibility's table of the sun, at one of its heights: ln depth and ln (diffuse / top) under the weather. */
void sun_node(double out[2], const Atmosphere *atmosphere, const Slice *slice, AirBand band, int height, double slant);
/* Emissivity of the air, 1 - q, of which the weather's replaces the model's: q under haze follows in proportion. */
static inline double emissivity_in(double hazy, double own, double now)
{
    return hazy + clamp((1 - hazy) / fmax(1 - own, 1e-3), 0, 1.2) * (now - own);
}

/* Relative length of a path to space: 1 at the zenith, 40 at the horizon. After Rozenberg (Twilight, 1966). */
static inline double air_mass(double zenith_rad)
{
    const double c = fmax(cos(fmin(zenith_rad, pi_rad / 2)), 0);
    return 1 / (c + 0.025 * exp(-11 * c));
}
/* Its logarithm: the coordinate in which the sky and the sun are nearly straight. */
static inline double slant_x(double zenith_rad) { return log(air_mass(zenith_rad)); }

/* Inputs of a path at one visibility: two slices and their shares. */
typedef struct Blend {
    const Slice *low, *high;          /* of visibility; may be the same */
    double       share;               /* of high, 0 .. 1, linear in 1 / visibility */
    double       haze_low, haze_high; /* shares for haze; of a single table at another visibility its scale, 0 */
} Blend;

/* The air of any visibility, from the tables' slices, of which at least one has paths and at least one scattered
 * light. */
Status slice_between(Slice *out, const Atmosphere *atmosphere, const Slice *tabled, int count, double visibility_m);
void   slice_close(Slice *slice);
/* From the files of a visibility's folder, atmosphere_read.c: the haze, the sun and the sky's own light; paths and
 * scattered light where the slice says that it has them. */
Status slice_open(Slice *slice, const Atmosphere *atmosphere, const char *folder);
/* Data shared by all visibilities: of a model's folder; of etc/atmosphere/bands.csv. */
Status clear_open(Atmosphere *atmosphere, const char *folder);
Status sun_top_open(double sun_top_w_m2[AIR_BAND_COUNT]);
/* Of etc/atmosphere/solar.csv. */
Status solar_open(Grid *solar);
/* FOLDER/NAME; a logged error where that is too long. */
Status atmosphere_file(char path[1024], const char *folder, const char *name);
/* Visibilities close enough for linear interpolation, in rising order: the tables', the ends, some between. */
int visibility_steps(double out[slices_made_max], const Slice *tabled, int count, double low_m, double high_m);

void   blend_at(Blend *out, const Atmosphere *atmosphere, double visibility_m);
double column_mean(const AirColumn *column, AirBand band, double a_m, double b_m);
double column_scatter(const AirColumn *column, AirBand band, double height_m);
void   column_sum_up(const AirColumn *column, const double *value, double *sum);
/* Of clear air: what black air of the atmosphere's temperatures makes of the extinction of mwir and lwir. */
void column_black(AirColumn *clear, const Atmosphere *atmosphere);
/* Of two visibilities' haze. */
double blend_haze_mean(const Blend *blend, AirBand band, double a_m, double b_m);
double blend_haze_scatter(const Blend *blend, AirBand band, double height_m);
/* Black-body radiance of the air between two heights, each metre weighted by its emission. */
double mean_black(const Atmosphere *atmosphere, AirBand band, double a_m, double b_m);
double black_air(const Atmosphere *atmosphere, AirBand band, double height_m);

/* Cosine of a path's zenith angle. */
static inline double path_up(const AirPath *path)
{
    return clamp((path->target_m - path->observer_m) / path->range_m, -1, 1);
}
/* Mean depth by which a straight path is below the one that rises evenly through flat layers: the Earth is round,
 * and refraction bends light by a seventh of that curvature. */
static inline double mean_chord_error_m(double range_m) { return range_m * range_m / (12 * 7433000.0); }

/* A table's value: of its weights at a temperature (NAN: sunlight), linear in 1 / temperature; of scattered light. */
double path_weight_value(const PathTable *table, const Stencil *at, double temp_k);
double scattered_value(const PathTable *table, const Stencil *at, double sun_x, double azimuth_deg, int tabled);
/* Optical depths of a path, for sunlight (temp_k NAN) or for an emitter of this temperature. */
void   clear_depths(double *out, const Atmosphere *atmosphere, AirBand band, const AirPath *path, const double *temp_k,
                    int temps);
double path_depth(const Atmosphere *atmosphere, const Blend *blend, AirBand band, const AirPath *path, double temp_k);
/* Direct and diffuse sunlight. */
void blend_sun(SunAir *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m,
               double sun_zenith_rad);

/* Estimate of scattered sunlight: single scattering along the profile plus a uniform diffuse term. It only gives the
 * shape between the tables' points, which hold the ratio of the true value to it. The part that is independent of
 * the sun's azimuth: radiance of clear air and of haze per unit of their phase functions, and of the diffuse term,
 * W/(m2 sr). */
typedef struct ScatterParts {
    double clear, glow;
    double haze[phase_heights_max]; /* by height of the phase function */
} ScatterParts;

/* depth: of sunlight, over the whole path. */
void scatter_parts(ScatterParts *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band,
                   const AirPath *path, double depth);
void scatter_parts_sky(ScatterParts *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band,
                       double observer_m, double zenith_rad, double sun_zenith_rad);
/* up: cosine of the view's zenith angle. */
double scatter_estimate(const ScatterParts *parts, const Atmosphere *atmosphere, AirBand band, double up,
                        double sun_zenith_rad, double rel_azimuth_rad);

/* ---- a straight path over the round Earth in pieces that the tables of paths know: atmosphere_legs.c -------- */

/* Of a path what is in the tables' air. Above top_m there is none: a path that stays there has no leg. One that is more
 * than half a kilometre below its lower end somewhere between is cut at its lowest point, so that each leg only falls
 * or only rises; with less the tables' own allowance for the chord (mean_chord_error_m) errs less than their
 * interpolation over a leg. The first leg begins at the observer; a path within the air that needs no cut stays as it
 * came. */
typedef struct AirLegs {
    int     count;
    AirPath leg[2], whole;
    double  cut; /* of two legs: what they make counts by this share, what whole makes by the rest: 1 from 1.5 km on */
} AirLegs;
AirLegs air_legs(const AirPath *path, double top_m);

/* A leg in pieces of 80 km and less, six at most, the nearest first: over a long one height changes too little like a
 * straight line for one estimate of what its air lets through, sends and scatters. Returns their number; of a short
 * leg, or one that begins below a kilometre, whose first air hides the rest, it is the leg itself. */
enum { air_pieces_max = 6 };
int air_leg_pieces(AirPath piece[air_pieces_max], const AirPath *leg);
/* Share that what the pieces send and scatter has in the leg's radiance, so that it does not step where they begin:
 * 0 .. 1, at twice their length and that height. */
double air_pieces_share(const AirPath *leg);

/* Height of the lowest point of a ray that goes down, by the cosine of its zenith angle at a height, m; not below 0. */
double air_tangent_m(double height_m, double up);
/* The path to it, without a sun; of a ray that does not go down one of no length. */
AirPath air_path_down(double height_m, double up);

static inline double mixed(double whole, double parts, double share) { return whole + share * (parts - whole); }

/* Two legs that meet at a height in one band: optical depth of both from each one's. Where single lines absorb, what
 * the first leg left has little in them: the depth of both is less than the sum, as depth grows with a power of the
 * amount of air, by the height 0.4 to 1. */
double air_legs_depth(AirBand band, double tangent_m, double first, double second);
/* Share of the second leg's radiance that passes the first one, of whose own emission these are the depths. */
double air_legs_passed(AirBand band, double tangent_m, double first, double second);
/* The same of the sky's radiance at the lowest point, seen level: it comes from far up, where lines are narrow. */
double air_legs_sky_passed(AirBand band, double tangent_m, double first);

/* Cosine of the zenith angle at which a path leaves its observer, over the round Earth. */
double air_ray_up(const AirPath *path);

/* ---- what the air of a path down from an eye sends: atmosphere_limb.c ------------------------------------- */

/* limb.csv of a model's folder. */
Status limb_open(Atmosphere *atmosphere, const char *folder);
/* Factors on the thermal radiance that paths and skies of flat layers have in mwir and lwir, by the observer's height,
 * the cosine of the zenith angle there and the range (INFINITY: to space): 1 of a path that does not go down; of one
 * that ends before its lowest point, or the ground, the square of the share that its range has
 * of the way there. */
void air_limb_factors(double out[2], const Atmosphere *atmosphere, const Blend *blend, double observer_m, double up,
                      double range_m);
/* Thermal radiance of the sky, from the horizontal up. */
double air_sky_thermal(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m,
                       double zenith_rad);
/* Thermal radiance of the air between an observer above the top of the tables of paths and where the ray enters them,
 * or its lowest point: what the sky has more from there, looking up the same line. 0 from below. */
double air_above_top(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m, double up,
                     double top_m);

/* ---- the air of a day: atmosphere_day.c, opened by atmosphere_day_open.c ---------------------------- */

enum { day_buckets = 512 };

/* Extinction and scattering by height on the nodes of all columns: clear air, and haze of the two tabled
 * visibilities: between them the minimum is evaluated at a point, not at nodes. */
typedef struct DayColumn {
    int      nodes;
    double   top_m, per_bucket_m;
    double  *height_m;
    double  *clear[AIR_BAND_COUNT], *clear_sum[AIR_BAND_COUNT], *haze[2][AIR_BAND_COUNT], *haze_sum[2][AIR_BAND_COUNT];
    double  *clear_scatter[AIR_BAND_COUNT], *haze_scatter[2][AIR_BAND_COUNT];
    uint16_t start[day_buckets]; /* interval of each bucket's lower end */
} DayColumn;

/* ln depth and ln (diffuse / top) of this sun, by the observer's height; of one visibility. */
typedef struct DaySun {
    int           nodes;
    const double *height_m;
    double        ln_depth[AIR_BAND_COUNT][grid_max_nodes], ln_diffuse[AIR_BAND_COUNT][grid_max_nodes];
} DaySun;

typedef struct DayTemp {
    int    low;   /* weight */
    double share; /* of the next */
} DayTemp;

struct AirDay {
    const Atmosphere *atmosphere;
    Blend             blend;
    bool              hazes;        /* two different slices */
    bool              suns_alike;   /* both have the same heights */
    unsigned          bands, parts; /* requested; the tabled bands that these are made of */
    double            sun_zenith_rad, sun_cos, sun_sin, top_m;
    DayColumn         column;
    DaySun            sun[2];   /* low, high */
    double           *ratio[2]; /* scattered: [rows][azimuths][air_tabled_count] */
    double           *sky[2];   /* sky_scattered: [observer][view][azimuth][air_tabled_count] */
    int               temps;
    DayTemp           temp[2][3][day_temps_max]; /* of mwir, lwir; clear, low, high */
};

/* What air_day_path, air_day_scattered and air_day_sky are made of: one leg (atmosphere_legs.c), and the sky from the
 * horizontal up. Pan is left out. */
void day_leg_path(DayPath *out, const AirDay *day, unsigned bands, const AirPath *leg);
void day_leg_scattered(double (*w_m2_sr)[AIR_BAND_COUNT], double sun[AIR_BAND_COUNT], const AirDay *day,
                       const AirPath *leg, const double *azimuth_rad, int azimuths);
void day_sky_above(double (*w_m2_sr)[AIR_BAND_COUNT], double thermal_w_m2_sr[2], const AirDay *day, double observer_m,
                   double zenith_rad, const double *azimuth_rad, int azimuths);

static inline bool         wants(unsigned bands, int band) { return bands >> band & 1; }
static inline const Slice *slice_of(const AirDay *day, int which) { return which ? day->blend.high : day->blend.low; }

/* As weight_value of atmosphere.c has it. */
static inline DayTemp temp_in(const PathTable *table, double temp_k)
{
    double t;
    if (table->weights < 2) return (DayTemp){0, 0};
    if (table->weights == 2) return (DayTemp){1, 0};
    const int    i = 1 + interval_of(&t, table->weight_temp_k + 1, table->weights - 1, temp_k);
    const double a = 1 / table->weight_temp_k[i], b = 1 / table->weight_temp_k[i + 1];
    return (DayTemp){i, clamp((1 / temp_k - a) / (b - a), 0, 1)};
}

static inline const PathTable *table_of(const AirDay *day, AirBand band, int which)
{
    return which == 0 ? &day->atmosphere->clear_path[band] : &slice_of(day, which - 1)->path[band];
}

#endif
