/* render/atmosphere_private.h: the tables as they lie in memory. */
#ifndef RENDER_ATMOSPHERE_PRIVATE_H
#define RENDER_ATMOSPHERE_PRIVATE_H

#include "render/atmosphere.h"

/* Bands that have tables of their own; AIR_PAN is the sum of b, g and r. */
enum { air_tabled_count = 6, air_scattered_count = 5 };
extern const AirBand air_tabled[air_tabled_count]; /* b g r nir mwir lwir; the first five scatter sunlight */
int air_tabled_index(AirBand band);
static inline bool air_band_is_thermal(AirBand band) { return band == AIR_MWIR || band == AIR_LWIR; }

/* ---- a table over a full grid of up to four axes ------------------------------------------- */

enum { grid_max_axes = 4, grid_max_values = 24, grid_max_nodes = 256 };

typedef struct GridColumn {
    const char *name;
    double      low, high; /* what a cell may hold */
} GridColumn;

typedef struct Grid {
    int     axes, values;
    int     nodes[grid_max_axes];
    double *axis[grid_max_axes]; /* ascending */
    double *value;               /* [node of axis 0][..][values] */
} Grid;

/* Every combination of the axes' values exactly once, in any order. */
Status grid_open(Grid *out, const char *path, const GridColumn *axis, int axes, const GridColumn *value, int values);
void   grid_close(Grid *grid);
/* Multilinear, clamped to the axes; out [values]. */
void   grid_at(double *out, const Grid *grid, const double *at);

/* Index of the interval that holds x, 0 .. count - 2, and the share of its upper end, 0 .. 1. */
int interval_of(double *share, const double *ascending, int count, double x);
/* Distinct values in rising order (values is sorted on the way); -1: more than capacity. axis_find: which is x. */
int axis_from(double *axis, int capacity, double *values, int count);
int axis_find(const double *axis, int count, double x);

/* ---- paths: two heights, and for each pair of them a list of ranges ------------------------- */

enum { path_max_heights = 40, path_max_weights = 12, path_max_suns = 24, stencil_max = 16 };

typedef struct PathTable {
    int     heights, rows, values; /* values: a row */
    double  height_m[path_max_heights];
    int    *first;                 /* [heights * heights + 1]: rows of pair observer * heights + target */
    double *ln_range, *value;      /* [rows], [rows * values] */
    double  ln_range_low;          /* shortest of all */
    /* what the values are: of paths_*.csv ln q of each weight (0: the sun; then rising temperatures) and, of thermal
     * bands, ln of the radiance over 1 - transmittance; of scattered.csv q by sun zenith, relative azimuth, band */
    int     weights;
    double  weight_temp_k[path_max_weights];
    int     suns, azimuths;
    double  sun_x[path_max_suns], azimuth_deg[path_max_suns]; /* sun: slant_x of its zenith angle */
} PathTable;

/* Weight by which the path's own emission is counted: of the temperature nearest the air's. */
int path_emission_weight(const PathTable *table);

/* Rows and their shares: linear in both heights, cubic in ln range. */
typedef struct Stencil {
    int    count;
    int    row[stencil_max];
    double share[stencil_max];
} Stencil;

void   stencil_at(Stencil *out, const PathTable *table, double observer_m, double target_m, double range_m);
double stencil_value(const Stencil *stencil, const PathTable *table, int value);

/* ---- a visibility, a model ----------------------------------------------------------------- */

enum { profile_max = 256 };

/* Extinction by height, of clear air and of haze; sums from the ground up so that a mean is a difference. */
typedef struct Profile {
    int    nodes;
    double height_m[profile_max];
    double clear_per_m[AIR_BAND_COUNT][profile_max], haze_per_m[AIR_BAND_COUNT][profile_max];
    double clear_sum[AIR_BAND_COUNT][profile_max], haze_sum[AIR_BAND_COUNT][profile_max];
    double clear_scatter[AIR_BAND_COUNT][profile_max], haze_scatter[AIR_BAND_COUNT][profile_max]; /* 1/m */
} Profile;

typedef struct Slice {
    double    visibility_m, longwave_down_w_m2;
    Profile   profile;
    PathTable path[AIR_BAND_COUNT];
    PathTable scattered;                 /* ratio to scatter_estimate; rows 0 while it is being made */
    Grid      sky_thermal;               /* observer_m, slant_x of the zenith angle; ln of mwir, lwir */
    Grid      sky_scattered;             /* observer, view, sun, azimuth: ratio to the estimate, by air_tabled_index */
    Grid      sun;                       /* observer, sun: ln depth [6], then ln (diffuse / top) [6] */
} Slice;

enum { slices_max = 8 };

struct Atmosphere {
    int    slices;
    Slice *slice;                        /* rising visibility */
    double sun_top_w_m2[AIR_BAND_COUNT];
    Grid   temperature;
    Grid   phase;                        /* scattering angle, rad: haze's phase function of each band, mean 1 */
};

/* Relative length of a path to space: 1 at the zenith, 40 at the horizon. After Rozenberg (Twilight, 1966). */
static inline double air_mass(double zenith_rad)
{
    const double c = fmax(cos(fmin(zenith_rad, pi_rad / 2)), 0);
    return 1 / (c + 0.025 * exp(-11 * c));
}
/* Its logarithm: the coordinate in which the sky and the sun are nearly straight. */
static inline double slant_x(double zenith_rad) { return log(air_mass(zenith_rad)); }

/* Everything of one visibility that a path needs: two slices and their shares. */
typedef struct Blend {
    const Slice *low, *high;  /* of visibility; may be the same */
    double       share;       /* of high, 0 .. 1, straight in 1 / visibility */
    double       haze_low, haze_high; /* shares for haze, which goes on beyond the tables' visibilities */
} Blend;

void   blend_at(Blend *out, const Atmosphere *atmosphere, double visibility_m);
/* Mean extinction, 1/m, between two heights, and extinction of a path by it alone. */
double blend_mean_extinction(const Blend *blend, AirBand band, double a_m, double b_m);

/* ln of the ratio of a path's depth to the profile's. */
double blend_ln_ratio(const Blend *blend, AirBand band, const AirPath *path, int weight);
/* Direct and diffuse sunlight. */
void   blend_sun(SunAir *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m,
                 double sun_zenith_rad);

/* Scattered sunlight by a single scattering off the profile plus an even glow: no more than the shape between the
 * tables' points, which hold its ratio to the truth. */
double scatter_estimate(const Atmosphere *atmosphere, const Blend *blend, AirBand band, const AirPath *path);
double scatter_estimate_sky(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m,
                            double zenith_rad, double sun_zenith_rad, double rel_azimuth_rad);

/* Reading; each logs file, line and reason. */
Status slice_open(Slice *out, const Atmosphere *atmosphere, const char *folder);
void   slice_close(Slice *slice);

#endif
