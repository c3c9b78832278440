/* render/air/daylight_sums.c: total irradiance of sun and sky at a position, also over all wavelengths for its
 * temperature.
 *
 * Below 5 degrees the sky keeps its shape at 5 degrees, and twilight.c has its light. */
#include "render/air/air_private.h"

static const double sun_radius_rad = 0.2665 * 0.017453292519943295769; /* mean over the year */

/* Share of the sun's disc above the horizon. */
static double disc_above(double elevation_rad)
{
    return clamp((elevation_rad + sun_radius_rad) / (2 * sun_radius_rad), 0, 1);
}

double daylight_sun_disc(const Daylight *light, const double d_enu[3])
{
    /* by the chord, since the cosine of so small an angle has lost half its digits */
    double chord[3];
    v3_sub(chord, d_enu, light->sun_d_enu);
    const double disc = 2 * sin(0.5 * sun_radius_rad), disc2 = disc * disc;
    return v3_dot(chord, chord) < disc2 ? 1 / (pi_rad * disc2) : 0; /* pi chord^2: exact on the sphere */
}

static const double sigma_w_m2_k4 = 5.670374419184429e-8; /* Stefan and Boltzmann's */

/* For temperatures: all wavelengths, under a clear sky of this haze and water vapour at this height; disc and twilight
 * as those of the bands. zenith_rad: of the sun, to the horizon. */
static void heat_of_clear_sky(Daylight *light, const AirSource *source, double zenith_rad, double model_temp_k)
{
    const Atmosphere *atmosphere = source->atmosphere;
    const SolarAir    air = {light->weather.visibility_m, solar_water_mm(weather_vapour_kg_m3(&light->weather)),
                             source->ground_m};
    SunAir            direct, diffuse;
    atmosphere_solar(&direct, atmosphere, &air, zenith_rad);
    atmosphere_solar(&diffuse, atmosphere, &air, light->day_zenith_rad);
    light->solar_direct_w_m2 = direct.direct_normal_w_m2 * light->sun_above;
    light->solar_diffuse_w_m2 = diffuse.diffuse_horizontal_w_m2 * light->scattered_scale[AIR_PAN];
    const double t_k = light->weather.air_temp_k, ratio = t_k / model_temp_k;
    const double down_w_m2 = atmosphere_longwave_down(atmosphere, light->weather.visibility_m) * pow(ratio, 4);
    light->longwave_loss_w_m2 = fmax(sigma_w_m2_k4 * pow(t_k, 4) - down_w_m2, 0);
}

/* Measured over clear; where there is nothing to measure, as it is. */
static double share_of(double measured_w_m2, double clear_w_m2, double otherwise)
{
    return isfinite(measured_w_m2) ? clear_w_m2 > 1 ? fmin(measured_w_m2 / clear_w_m2, 20) : 1 : otherwise;
}

/* What clouds, or the measured radiation, make of the clear sky. */
static void cloud_over(Daylight *light, double diffuse_w_m2[AIR_BAND_COUNT])
{
    const Weather *w = &light->weather;
    const double   cloud = clamp(w->cloud, 0, 1), high = fmax(light->sun_d_enu[2], 0);
    const double   direct = light->solar_direct_w_m2, diffuse = light->solar_diffuse_w_m2,
                 global = direct * high + diffuse;
    const double sun = share_of(w->direct_w_m2, direct, 1 - cloud);
    const double under = global * (1 - 0.75 * pow(cloud, 3.4)) - sun * direct * high;
    const double sky = share_of(w->diffuse_w_m2, diffuse, diffuse > 0 ? fmax(under / diffuse, 0) : 1);
    const double black_w_m2 = sigma_w_m2_k4 * pow(w->air_temp_k, 4), clear_w_m2 = light->longwave_loss_w_m2;
    light->longwave_loss_w_m2 =
        isfinite(w->longwave_w_m2) ? black_w_m2 - w->longwave_w_m2 : (1 - 0.84 * cloud) * clear_w_m2;
    light->cloud_thermal =
        isfinite(w->longwave_w_m2) && clear_w_m2 > 0 ? clamp(1 - light->longwave_loss_w_m2 / clear_w_m2, 0, 1) : cloud;
    light->cloud_sky = sky;
    light->solar_direct_w_m2 *= sun;
    light->solar_diffuse_w_m2 *= sky;
    if (isfinite(w->direct_w_m2)) light->solar_direct_w_m2 = w->direct_w_m2;
    if (isfinite(w->diffuse_w_m2)) light->solar_diffuse_w_m2 = w->diffuse_w_m2;
    light->sun_above *= sun;
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        light->sun_w_m2[b] *= sun;
        light->sky_w_m2[b] *= sky;
        diffuse_w_m2[b] *= sky;
    }
}

/* Drops dim the sun, and what of it is not lost is diffuse. Over all wavelengths they are as in the visible; the
 * longwave sky is seen through them as in 8-12 um. */
static void dim_by_drops(Daylight *light, const Atmosphere *atmosphere, const Weather *weather, double zenith_rad,
                         double diffuse_w_m2[AIR_BAND_COUNT])
{
    Weather known = *weather;
    known.air_temp_k = light->weather.air_temp_k;
    droplets_of(&light->droplets, atmosphere, &known, zenith_rad);
    if (light->droplets.layers == 0) return;
    DropletSun all =
        droplets_sun(&light->droplets, AIR_PAN, (DropletSun){light->solar_direct_w_m2, light->solar_diffuse_w_m2});
    light->solar_direct_w_m2 = all.direct_w_m2, light->solar_diffuse_w_m2 = all.diffuse_w_m2;
    light->longwave_loss_w_m2 *= droplets_thermal(&light->droplets, AIR_LWIR, 0, 0);
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        const DropletSun sun = droplets_sun(&light->droplets, b, (DropletSun){light->sun_w_m2[b], light->sky_w_m2[b]});
        light->sun_w_m2[b] = sun.direct_w_m2, light->sky_w_m2[b] = diffuse_w_m2[b] = sun.diffuse_w_m2;
    }
}

/* The thermal light in them, below the mean of the sky under its clouds and above the ground. */
static void thermal_of_drops(Daylight *light, const Atmosphere *atmosphere, double air_k)
{
    static const double mean_zenith_rad = 53 * 0.017453292519943295769; /* of diffuse light */
    for (AirBand b = AIR_MWIR; b <= AIR_LWIR && light->droplets.layers > 0; b++) {
        const double black = planck_table_radiance(b == AIR_MWIR ? light->planck_mwir : light->planck_lwir, air_k);
        SkyAir       sky;
        atmosphere_sky(&sky, atmosphere, light->weather.visibility_m, b, 0, mean_zenith_rad, pi_rad, 0);
        const double clear = sky.thermal_w_m2_sr * light->thermal_scale[b - AIR_MWIR];
        droplets_thermal(&light->droplets, b, (1 - light->cloud_thermal) * (clear - black),
                         light->ground_w_m2_sr[b] - black);
    }
}

void daylight_sums(Daylight *out, const AirSource *source, const Weather *weather, const Sun *sun, unsigned bands,
                   double diffuse_w_m2[AIR_BAND_COUNT])
{
    const Atmosphere *atmosphere = source->atmosphere;
    const double      model_temp_k = atmosphere_temp_k(atmosphere, 0);
    out->weather = *weather;
    out->weather.visibility_m = droplets_haze_m(weather->visibility_m, weather->fog);
    out->planck_mwir = source->planck_mwir, out->planck_lwir = source->planck_lwir;
    memcpy(out->sun_d_enu, sun->d_enu, sizeof out->sun_d_enu);
    if (isnan(out->weather.air_temp_k)) out->weather.air_temp_k = model_temp_k;
    for (int i = 0; i < air_warmer_nodes; i++)
        out->warmer_k[i] = (float)(atmosphere_temp_k(atmosphere, i * air_warmer_step_m) - model_temp_k);
    const PlanckTable *planck[2] = {source->planck_mwir, source->planck_lwir};
    for (int k = 0; k < 2; k++)
        out->thermal_scale[k] =
            planck_table_radiance(planck[k], out->weather.air_temp_k) / planck_table_radiance(planck[k], model_temp_k);
    const double zenith_rad = 0.5 * pi_rad - sun->elevation_rad, per_au2 = 1 / (sun->distance_au * sun->distance_au);
    out->day_zenith_rad = fmin(zenith_rad, (90 - twilight_begins_deg) * rad_per_deg);
    twilight(out->scattered_scale, atmosphere, out->weather.visibility_m, sun->elevation_rad, bands);
    for (int b = 0; b < AIR_BAND_COUNT; b++) out->scattered_scale[b] *= per_au2;
    out->sun_above = per_au2 * disc_above(sun->elevation_rad);

    const double low_rad = fmin(zenith_rad, 0.5 * pi_rad);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        diffuse_w_m2[b] = 0;
        if (!((bands | 1 << AIR_PAN) >> b & 1)) continue;
        SunAir direct, diffuse;
        atmosphere_sun(&direct, atmosphere, out->weather.visibility_m, (AirBand)b, 0, low_rad);
        atmosphere_sun(&diffuse, atmosphere, out->weather.visibility_m, (AirBand)b, 0, out->day_zenith_rad);
        out->sun_w_m2[b] = direct.direct_normal_w_m2 * out->sun_above;
        out->sky_w_m2[b] = diffuse_w_m2[b] = diffuse.diffuse_horizontal_w_m2 * out->scattered_scale[b];
    }
    heat_of_clear_sky(out, source, low_rad, model_temp_k);
    const double above = out->sun_above;
    dim_by_drops(out, atmosphere, weather, zenith_rad, diffuse_w_m2);
    cloud_over(out, diffuse_w_m2);
    if (out->droplets.layers > 0)
        droplets_under_clouds(&out->droplets, above > 0 ? out->sun_above / above : 1, out->cloud_sky);
    const double ground_k = source->ground_k > 0 ? source->ground_k : out->weather.air_temp_k;
    out->ground_k = ground_k;
    out->ground_w_m2_sr[AIR_MWIR] = planck_table_radiance(out->planck_mwir, ground_k);
    out->ground_w_m2_sr[AIR_LWIR] = planck_table_radiance(out->planck_lwir, ground_k);
    thermal_of_drops(out, atmosphere, out->weather.air_temp_k);
}
