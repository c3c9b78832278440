/* render/heat/soil.c: see soil.h. */
#include "render/heat/soil.h"

double soil_conductivity_w_mk(double porosity, double quartz, double saturation)
{
    const double density = (1 - porosity) * 2700;
    const double dry = (0.135 * density + 64.7) / (2700 - 0.947 * density);
    const double solids = pow(7.7, quartz) * pow(quartz < 0.2 ? 3 : 2, 1 - quartz);
    const double wet = pow(solids, 1 - porosity) * pow(0.57, porosity);
    const double kersten = saturation > 0.1 ? fmax(log10(saturation) + 1, 0) : 0;
    return dry + kersten * (wet - dry);
}

double soil_capacity_j_m3k(double porosity, double saturation)
{
    return (1 - porosity) * 2.0e6 + porosity * saturation * 4.18e6;
}

double soil_resistance_s_m(double saturation) { return exp(8.206 - 4.255 * saturation); }

double soil_darkening(double saturation) { return 1 - 0.5 * saturation; }

double soil_water_step(double top, double deep, double porosity, double rain_kg_m2s, double evaporates_kg_m2s, double dt_s)
{
    static const double depth_m = 0.1, day_s = 86400, restores = 0.9;
    const double c1 = top >= 0.75 ? 0.5 : top <= 0.15 ? 14 : 14 - 22.5 * (top - 0.15);
    const double gain = c1 * (rain_kg_m2s - evaporates_kg_m2s) / (1000 * depth_m * porosity);
    const double back = exp(-restores * dt_s / day_s), held = deep + gain * day_s / restores;
    return clamp(held + (top - held) * back, 0.01, 1);
}
