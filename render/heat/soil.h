/* render/heat/soil.h: conductivity and heat capacity of soils by their water, and what the water at the top does. */
#ifndef RENDER_HEAT_SOIL_H
#define RENDER_HEAT_SOIL_H

#include "pitviper.h"

/* porosity: 0.3 .. 0.9 of the volume; quartz: of the solids, 0 .. 1; saturation: of the pores with water, 0 .. 1.
 * Johansen (1975), as in Peters-Lidard et al., J. Atmos. Sci. 55, 1998: W/(m K), within 25 % of most soils. */
double soil_conductivity_w_mk(double porosity, double quartz, double saturation);
/* Of the volume, J/(m3 K): 2.0e6 of minerals, 4.18e6 of water (de Vries 1963). */
double soil_capacity_j_m3k(double porosity, double saturation);

/* Resistance of the topmost soil to the vapour that leaves it, s/m: exp(8.206 - 4.255 saturation) (Sellers et al., J.
 * Geophys. Res. 97, 1992). */
double soil_resistance_s_m(double saturation);
/* Reflectance of wet soil over that of dry soil: 1 - saturation / 2 (Idso et al., J. Appl. Meteorol. 14, 1975: 0.30 of
 * dry loam, 0.14 of wet). */
double soil_darkening(double saturation);

/* Water at the top after dt_s: rain and evaporation (kg/(m2 s)) change it, water from below restores it within a day
 * (force-restore: Deardorff, J. Geophys. Res. 83, 1978). Saturations, 0 .. 1. */
double soil_water_step(double top, double deep, double porosity, double rain_kg_m2s, double evaporates_kg_m2s, double dt_s);

#endif
