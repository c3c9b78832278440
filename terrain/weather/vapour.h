/* terrain/weather/vapour.h: water vapour in air. */
#ifndef TERRAIN_WEATHER_VAPOUR_H
#define TERRAIN_WEATHER_VAPOUR_H

#include "pitviper.h"

/* Saturation vapour pressure over water, Pa: Tetens, as in Campbell & Norman (1998), eq. 3.8. */
static inline double weather_saturation_pa(double temp_k)
{
    const double c = temp_k - 273.15;
    return 611 * exp(17.502 * c / (240.97 + c));
}

#endif
