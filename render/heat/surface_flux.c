/* render/heat/surface_flux.c: see surface_flux.h. */
#include "render/heat/surface_flux.h"

static const double air_j_kgk = 1005, air_gas_j_kgk = 287.05, karman = 0.4, gravity = 9.81, least_wind_mps = 1;
static const double air_viscosity_m2s = 1.5e-5;

double saturation_pa(double temp_k)
{
    const double c = fmax(temp_k - 273.15, -150);
    return 611 * exp(17.502 * c / (240.97 + c));
}

/* Speed of heat between surface and air, m/s. */
static double transfer_mps(const SurfaceFlux *l, double temp_k)
{
    const SurfaceAir *a = &l->air;
    const double z0 = l->roughness_m, u_mps = fmax(a->wind_mps, least_wind_mps);
    const double log_m = log(a->wind_height_m / z0 + 1), friction_mps = karman * u_mps / log_m;
    const double log_h = log(a->height_m / z0 + 1) + 0.1 * karman * sqrt(friction_mps * z0 / air_viscosity_m2s);
    const double neutral = karman * karman / (log_m * log_h);
    const double ri = clamp(gravity * a->height_m * (a->temp_k - temp_k) / (0.5 * (a->temp_k + temp_k) * u_mps * u_mps), -1e4, 1e4);
    const double share = ri > 0 ? 1 / (1 + 15 * ri * sqrt(1 + 5 * ri))
                                : 1 - 15 * ri / (1 + 75 * neutral * sqrt(-ri * (a->height_m / z0 + 1)));
    return neutral * u_mps * share;
}

static double air_kg_m3(const SurfaceFlux *l) { return l->air.pressure_pa / (air_gas_j_kgk * l->air.temp_k); }

double surface_film_w_m2k(const SurfaceFlux *l, double temp_k)
{
    return air_kg_m3(l) * air_j_kgk * transfer_mps(l, temp_k);
}

static double latent(const SurfaceFlux *l, double temp_k, double speed_mps)
{
    const double excess_pa = saturation_pa(temp_k) - l->air.vapour_pa;
    if (!(l->resistance_s_m < INFINITY)) return 0;
    const double through_mps = excess_pa > 0 ? 1 / (1 / speed_mps + l->resistance_s_m) : speed_mps;
    return vapour_j_kg * air_kg_m3(l) * 0.622 / l->air.pressure_pa * excess_pa * through_mps;
}

double surface_latent_w_m2(const SurfaceFlux *l, double temp_k) { return latent(l, temp_k, transfer_mps(l, temp_k)); }

double surface_flux_w_m2(double *falls, double temp_k, const void *law)
{
    const SurfaceFlux *l = law;
    const double t2 = temp_k * temp_k, speed_mps = transfer_mps(l, temp_k);
    const double film = air_kg_m3(l) * air_j_kgk * speed_mps, evaporates = latent(l, temp_k, speed_mps);
    *falls = 4 * l->emissivity * stefan_w_m2k4 * t2 * temp_k + film + fmax(0.06 * evaporates, 0);
    return l->absorbed_w_m2 - l->emissivity * stefan_w_m2k4 * t2 * t2 - film * (temp_k - l->air.temp_k) - evaporates;
}
