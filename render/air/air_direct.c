/* render/air/air_direct.c: the results of air_paths.c without its tables: each path is computed from the atmosphere
 * separately.
 *
 * The reference for the tables, used for a few rays of a frame (render/frame/error_budget.c). Ends and heights of
 * paths are as in air_paths.c. */
#include "render/air/air_private.h"

static double straight(double low, double high, double share) { return low + share * (high - low); }

/* Optical depth for the emission of a body of this temperature, interpolated between the day's emitters as the
 * atmosphere's own tables do. */
static double depth_of(const double depth[day_temps_max], double temp_k)
{
    int k = 0;
    while (k + 2 < air_temps && temp_k > emitter_temp_k[k + 1]) k++;
    const double share = log(temp_k / emitter_temp_k[k]) / log(emitter_temp_k[k + 1] / emitter_temp_k[k]);
    return straight(depth[k], depth[k + 1], clamp(share, 0, 1));
}

static double azimuth_from_sun_rad(const Air *air, const double d_enu[3])
{
    const double *s = air->light.sun_d_enu, level = hypot(d_enu[0], d_enu[1]) * hypot(s[0], s[1]);
    return level > 1e-12 ? acos(clamp((d_enu[0] * s[0] + d_enu[1] * s[1]) / level, -1, 1)) : 0;
}

static void sky_ray(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const double d_enu[3], int i)
{
    double       seen[1][AIR_BAND_COUNT], thermal[2];
    const double azimuth_rad = azimuth_from_sun_rad(air, d_enu);
    air_day_sky(seen, thermal, air->light.day, air->eye_height_m, acos(clamp(d_enu[2], 0, 1)), &azimuth_rad, 1);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(bands >> b & 1)) continue;
        double added = b == AIR_LWIR ? 0 : seen[0][b] * air->light.scattered_scale;
        if (b >= AIR_MWIR) added += thermal[b - AIR_MWIR] * air->light.thermal_scale[b - AIR_MWIR];
        out[b].transmittance[i] = out[b].sun_transmittance[i] = out[b].air_transmittance[i] = 0;
        out[b].added_w_m2_sr[i] = (float)added;
    }
}

static void solid_ray(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const double o_enu[3],
                      const double d_enu[3], double range_m, double temp_k, int i)
{
    double       seen[1][AIR_BAND_COUNT], sun[AIR_BAND_COUNT];
    const double climb = d_enu[2] + (o_enu[0] * d_enu[0] + o_enu[1] * d_enu[1]) / earth_radius_m;
    const double level2 = d_enu[0] * d_enu[0] + d_enu[1] * d_enu[1], azimuth_rad = azimuth_from_sun_rad(air, d_enu);
    const double far_m = air->eye_height_m + range_m * climb + range_m * range_m * level2 / (2 * earth_radius_m);
    const AirPath path = {.observer_m = air->eye_height_m, .target_m = clamp(far_m, 0, air_top_m), .range_m = range_m};
    DayPath       way;
    air_day_path(&way, air->light.day, &path);
    air_day_scattered(seen, sun, air->light.day, &path, &azimuth_rad, 1);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(bands >> b & 1)) continue;
        const double scattered = b == AIR_LWIR ? 0 : seen[0][b] * air->light.scattered_scale;
        if (b < AIR_MWIR) {
            out[b].transmittance[i] = out[b].sun_transmittance[i] = out[b].air_transmittance[i] = (float)exp(-way.sun[b]);
            out[b].added_w_m2_sr[i] = (float)scattered;
            continue;
        }
        const double *depth = way.emitted[b - AIR_MWIR], own = exp(-depth[air_temps]);
        out[b].air_transmittance[i] = (float)own;
        out[b].sun_transmittance[i] = (float)(b == AIR_MWIR && air->light.scattered_scale > 0 ? exp(-way.sun[b]) : own);
        out[b].transmittance[i] = temp_k > 0 ? (float)exp(-depth_of(depth, temp_k)) : out[b].sun_transmittance[i];
        out[b].added_w_m2_sr[i] = (float)(way.thermal_w_m2_sr[b - AIR_MWIR] * air->light.thermal_scale[b - AIR_MWIR] + scattered);
    }
}

void air_paths_directly(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const Hits *hits, const Rays *rays,
                        const float *temp_k, const AirPaths tables[AIR_BAND_COUNT])
{
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1) out[b] = tables[b];
    if (!air->light.day || !air->table) return;
    for (int i = 0; i < hits->count; i++) {
        const double o_enu[3] = {rays->o_enu[0][i], rays->o_enu[1][i], rays->o_enu[2][i]};
        const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
        double       range_m = INFINITY; /* to the ground beyond the terrain's edge, too */
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (bands >> b & 1) range_m = (double)tables[b].range_m[i];
        if (range_m < INFINITY) solid_ray(out, air, bands, o_enu, d_enu, range_m, temp_k ? (double)temp_k[i] : 0, i);
        else sky_ray(out, air, bands, d_enu, i);
    }
}
