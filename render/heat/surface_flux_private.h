/* render/heat/surface_flux_private.h: heat into a surface in the open: what it absorbs, less what it radiates, gives to
 * the air and evaporates.
 *
 * Air: bulk transfer between roughness and the height of measurement, with stability after Louis, Tiedtke & Geleyn
 * (ECMWF workshop on planetary boundary layer parameterization, 1982); roughness for heat after Zilitinkevich (1995)
 * with 0.1 (Chen et al., Boundary-Layer Meteorol. 85, 1997). Vapour goes the same way and through the surface's own
 * resistance; dew through none. Saturation: Tetens (Campbell & Norman 1998). */
#ifndef RENDER_HEAT_SURFACE_FLUX_PRIVATE_H
#define RENDER_HEAT_SURFACE_FLUX_PRIVATE_H

#include "pitviper.h"

static const double stefan_w_m2k4 = 5.670374419184429e-8;

typedef struct SurfaceAir {
    double temp_k, vapour_pa, pressure_pa;
    double wind_mps;
    double height_m, wind_height_m; /* of the thermometer, of the anemometer, over the ground */
} SurfaceAir;

typedef struct SurfaceFlux {
    SurfaceAir air;
    double     absorbed_w_m2; /* of sun and longwave */
    double     emissivity;
    double     roughness_m;
    double     resistance_s_m; /* to vapour; INFINITY: nothing evaporates */
    /* of surface_flux_prepare: speed of heat in neutral air; Richardson number of 1 K; the unstable form's factor */
    double neutral_mps, stable_per_k, unstable, air_kg_m3;
} SurfaceFlux;

/* After the members above: what does not depend on the surface's temperature. */
void surface_flux_prepare(SurfaceFlux *law);

/* Saturation over water, Pa. */
double saturation_pa(double temp_k);
/* Of the heat that the air takes per kelvin, W/(m2 K). */
double surface_film_w_m2k(const SurfaceFlux *law, double temp_k);
/* Of a plate of some metre in air of 288 K at sea level: turbulent flow (Incropera & DeWitt: Nu = 0.037 Re^0.8
 * Pr^(1/3)) over free convection; 10 % of McAdams's 5.7 + 3.8 v up to 10 m/s. */
static inline double plate_film_w_m2k(double speed_mps) { return 4 + 6.1 * pow(speed_mps, 0.8); }
/* Latent heat that leaves, W/m2; negative: dew. */
double surface_latent_w_m2(const SurfaceFlux *law, double temp_k);
/* ColumnFlux of a SurfaceFlux. */
double surface_flux_w_m2(double *falls_w_m2k, double temp_k, const void *law);

static const double vapour_j_kg = 2.45e6; /* latent heat of evaporation */

#endif
