/* render/heat/surface_flux.c: the heat flux into a surface in the open, and its slope in temperature
 * (surface_flux_private.h).
 */
#include "render/heat/surface_flux_private.h"

#include "terrain/weather/weather.h"

static const double air_j_kgk = 1005, air_gas_j_kgk = 287.05, karman = 0.4, gravity = 9.81, least_wind_mps = 1;
static const double air_viscosity_m2s = 1.5e-5;

double saturation_pa(double temp_k)
{
    static const double least_k = 123.15; /* below, the formula has a pole; there is no vapour either */
    return weather_saturation_pa(fmax(temp_k, least_k));
}

void surface_flux_prepare(SurfaceFlux *l)
{
    const SurfaceAir *a = &l->air;
    const double      z0 = l->roughness_m, u_mps = fmax(a->wind_mps, least_wind_mps);
    const double      log_m = log(a->wind_height_m / z0 + 1), friction_mps = karman * u_mps / log_m;
    const double      log_h = log(a->height_m / z0 + 1) + 0.1 * karman * sqrt(friction_mps * z0 / air_viscosity_m2s);
    const double      neutral = karman * karman / (log_m * log_h);
    l->neutral_mps = neutral * u_mps;
    l->stable_per_k = gravity * a->height_m / (u_mps * u_mps);
    l->unstable = 75 * neutral * sqrt(a->height_m / z0 + 1);
    l->air_kg_m3 = a->pressure_pa / (air_gas_j_kgk * a->temp_k);
}

/* Speed of heat between surface and air, m/s. */
static double transfer_mps(const SurfaceFlux *l, double temp_k)
{
    const double ri = clamp(l->stable_per_k * (l->air.temp_k - temp_k) / (0.5 * (l->air.temp_k + temp_k)), -1e4, 1e4);
    const double share = ri > 0 ? 1 / (1 + 15 * ri * sqrt(1 + 5 * ri)) : 1 - 15 * ri / (1 + l->unstable * sqrt(-ri));
    return l->neutral_mps * share;
}

double surface_film_w_m2k(const SurfaceFlux *l, double temp_k)
{
    return l->air_kg_m3 * air_j_kgk * transfer_mps(l, temp_k);
}

static double latent(const SurfaceFlux *l, double temp_k, double speed_mps)
{
    const double excess_pa = saturation_pa(temp_k) - l->air.vapour_pa;
    if (!(l->resistance_s_m < INFINITY)) return 0;
    const double through_mps = excess_pa > 0 ? 1 / (1 / speed_mps + l->resistance_s_m) : speed_mps;
    return vapour_j_kg * l->air_kg_m3 * 0.622 / l->air.pressure_pa * excess_pa * through_mps;
}

double surface_latent_w_m2(const SurfaceFlux *l, double temp_k) { return latent(l, temp_k, transfer_mps(l, temp_k)); }

double surface_flux_w_m2(double *falls, double temp_k, const void *law)
{
    const SurfaceFlux *l = law;
    const double       t2 = temp_k * temp_k, speed_mps = transfer_mps(l, temp_k);
    const double       film = l->air_kg_m3 * air_j_kgk * speed_mps, evaporates = latent(l, temp_k, speed_mps);
    *falls = 4 * l->emissivity * stefan_w_m2k4 * t2 * temp_k + film + fmax(0.06 * evaporates, 0);
    return l->absorbed_w_m2 - l->emissivity * stefan_w_m2k4 * t2 * t2 - film * (temp_k - l->air.temp_k) - evaporates;
}
