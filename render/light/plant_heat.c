/* render/light/plant_heat.c: see plant_heat.h. */
#include "render/light/plant_heat.h"

#include "render/materials/surface_balance.h"
#include "terrain/weather/weather.h"

static const double heat_j_mol_k = 29.3, vapour_j_mol = 44000; /* of air; of water's evaporation */
static const double pressure_pa = 101325;
static const double leaf_m = 0.05, least_wind_mps = 0.3;       /* free convection takes over below */

/* Saturation over water, Pa, and its slope, Pa/K: Tetens, as in Campbell & Norman (1998), eq. 3.8. */
static double vapour_pa(double *slope, double temp_k)
{
    const double c = temp_k - 273.15, e = weather_saturation_pa(temp_k);
    *slope = e * 17.502 * 240.97 / ((240.97 + c) * (240.97 + c));
    return e;
}

double leaf_temp_k(const Daylight *light, const Material *m, double air_temp_k, double open, double lit)
{
    const double wind_mps = fmax(light->weather.wind_mps, least_wind_mps);
    const double layer = 1.4 * 0.135 * sqrt(wind_mps / (0.72 * leaf_m)); /* mol/(m2 s), one side */
    const double sun_w_m2 = lit * 0.5 * light->solar_direct_w_m2 * (light->sun_d_enu[2] > 0) + open * light->solar_diffuse_w_m2;
    const double humidity = light->weather.humidity;
    const double stomata = 0.2 * (0.05 + 0.95 * fmin(sun_w_m2 / 250, 1)); /* full by half of full sunlight */
    const double vapour = 1 / (1 / stomata + 1 / (1.09 * layer));
    double       slope;
    const double e = vapour_pa(&slope, air_temp_k);
    const double emissivity = 1 - (double)m->rho_lwir - (double)m->tau_lwir;
    const double gain = (double)m->solar_absorptance * sun_w_m2 - emissivity * light->longwave_loss_w_m2 * open -
                        vapour_j_mol * vapour * (1 - humidity) * e / pressure_pa;
    const double loss = 2 * heat_j_mol_k * layer + 2 * emission_w_m2_k(emissivity, air_temp_k) +
                        vapour_j_mol * vapour * slope / pressure_pa;
    return air_temp_k + gain / loss;
}
