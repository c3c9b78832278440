/* render/air_private.h: between air.c and air_table.c. */
#ifndef RENDER_AIR_PRIVATE_H
#define RENDER_AIR_PRIVATE_H

#include "render/air.h"

/* Paths from one eye: by the far end's height, h = air_top_m (i / air_heights)^2, and by ln(range).
 * Kept as what varies slowly: extinction -ln(tau) / range, which is constant in a grey and even air, and the path's
 * radiance over 1 - tau, its mean source. */
enum { air_heights = 20, air_ranges = 64, air_temps = 5, air_path_azimuths = 12 };
enum { air_nodes = (air_heights + 1) * (air_ranges + 1) };

static const double air_top_m = 30e3, air_near_m = 1, air_far_m = 400e3;
static const double earth_radius_m = 6371e3;

struct AirTable {
    bool  thermal, scattered;
    float extinction_temp_per_m[air_temps][air_nodes]; /* of emission at each temperature; thermal bands only */
    float extinction_air_per_m[air_nodes];             /* of emission at the air's own; thermal bands only */
    float extinction_sun_per_m[air_nodes];
    float thermal_w_m2_sr[air_nodes];                  /* over 1 - tau of the air's own */
    float scattered_w_m2_sr[air_path_azimuths + 1][air_nodes]; /* over 1 - tau of the sun */
};

/* Fills air->table for the bands given. thermal_scale: for air of another temperature than the model's; scattered_scale:
 * twilight and the sun's distance. */
Status air_tables_fill(Air *air, const Atmosphere *atmosphere, double sun_zenith_rad, const double thermal_scale[2],
                       double scattered_scale, unsigned bands, Pool *pool, Arena *arena);

/* Sky radiance of a table towards a unit direction. */
double air_sky_table(const AirSky *sky, const double sun_d_enu[3], const double d_enu[3]);

#endif
