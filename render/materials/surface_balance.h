/* render/materials/surface_balance.h: heat losses of a surface warmer than the air in a steady balance: the air's film
 * (McAdams, Heat Transmission, 1954: 5.7 + 3.8 v W/(m2 K), plates below 5 m/s; used above that too) and longwave
 * emission (4 e sigma T^3, 5 W/(m2 K) at 288 K). */
#ifndef RENDER_MATERIALS_SURFACE_BALANCE_H
#define RENDER_MATERIALS_SURFACE_BALANCE_H

#include "pitviper.h"

/* wind_mps >= 0 */
static inline double film_w_m2_k(double wind_mps) { return 5.7 + 3.8 * wind_mps; }

static inline double emission_w_m2_k(double emissivity, double temp_k)
{
    return 4 * emissivity * 5.670374419184429e-8 * temp_k * temp_k * temp_k;
}

#endif
