/* terrain/weather.h: weather state: the parameters that light and heat depend on. */
#ifndef TERRAIN_WEATHER_H
#define TERRAIN_WEATHER_H

#include "pitviper.h"

typedef struct Weather {
    double visibility_m;      /* meteorological range, 2 % contrast, 100 .. 300 000 */
    double air_temp_k;        /* at the ground, 220 .. 330; NaN: that of the standard atmosphere in use */
    double pressure_mbar;
    double wind_mps;
    double wind_from_rad;     /* where it comes from, clockwise from north */
} Weather;

static inline Weather weather_default(void)
{
    return (Weather){.visibility_m = 23000, .air_temp_k = 288.15, .pressure_mbar = 1013.25, .wind_mps = 3,
                     .wind_from_rad = 270 * 0.017453292519943295769};
}

#endif
