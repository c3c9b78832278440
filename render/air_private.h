/* render/air_private.h: between air.c and air_table.c. */
#ifndef RENDER_AIR_PRIVATE_H
#define RENDER_AIR_PRIVATE_H

#include "render/air.h"

/* Paths from one eye: by the far end's height, h = air_top_m (i / air_heights)^2, and by ln(range); scattered light by
 * their slope, since it depends on where they point: rise over range, s |s| with s in equal steps over what is looked
 * at; and by the root of their share of the whole way, to the ground or out of the tables' air, so that ground is at
 * its end. Kept as what varies slowly: extinction -ln(tau) / range, which is constant in a grey and even air, and the
 * path's radiance over 1 - tau, its mean source. */
enum { air_heights = 40, air_ranges = 40, air_temps = 5, air_path_azimuths = 12, air_slopes = 32, air_shares = 24 };
enum { air_nodes = (air_heights + 1) * (air_ranges + 1), air_slope_nodes = (air_slopes + 1) * (air_shares + 1) };

static const double air_top_m = 30e3, air_near_m = 50, air_far_m = 250e3;
static const double earth_radius_m = 6371e3;

struct AirTable {
    bool thermal, scattered;
    float slope_low, slope_steps;                      /* s at the first step, steps per unit of s */
    float azimuth_low_rad, azimuth_planes_per_rad;     /* of scattered light; beyond the first and last the nearest */
    int azimuth_planes;                                /* steps between them, .. air_path_azimuths */
    float extinction_temp_per_m[air_temps][air_nodes]; /* of emission at each temperature; thermal bands only */
    float extinction_air_per_m[air_nodes];             /* of emission at the air's own; thermal bands only */
    float extinction_sun_per_m[air_nodes];
    float thermal_w_m2_sr[air_nodes]; /* over 1 - tau of the air's own */
    float ln_scattered[air_path_azimuths + 1]
                      [air_slope_nodes]; /* W/(m2 sr) over 1 - tau of the sun; it falls off as e does */
};

/* Fills air->table for the bands given, and of scattered light what is needed between two azimuths from the sun and two
 * slopes.
 * thermal_scale: for air of another temperature than the model's; scattered_scale: twilight and the sun's distance. */
typedef struct TableInput {
    const Atmosphere *atmosphere;
    double sun_zenith_rad, thermal_scale[2], scattered_scale;
    double azimuth_low_rad, azimuth_high_rad, slope_low, slope_high; /* slopes as rise over range */
    unsigned bands;
} TableInput;
Status air_tables_fill(Air *air, const TableInput *input, Pool *pool, Arena *arena);

/* Straight-on cubic through four points a step apart, at t of the middle step. */
static inline double cubic_between(double a, double b, double c, double d, double t)
{
    return b + t * (c - b) + t * (t - 1) / 6 * ((2 - t) * (a - 2 * b + c) + (1 + t) * (b - 2 * c + d));
}

/* Sky radiance of a table towards a unit direction. */
double air_sky_table(const AirSky *sky, const double sun_d_enu[3], const double d_enu[3]);

#endif
