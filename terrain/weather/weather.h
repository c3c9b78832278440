/* terrain/weather/weather.h: weather state: the parameters that light and heat depend on. */
#ifndef TERRAIN_WEATHER_WEATHER_H
#define TERRAIN_WEATHER_WEATHER_H

#include "pitviper.h"

typedef struct Weather {
    double visibility_m;      /* meteorological range, 2 % contrast, 100 .. 300 000 */
    double air_temp_k;        /* at the ground, 220 .. 330; NaN: that of the standard atmosphere in use */
    double pressure_mbar;
    double wind_mps;
    double wind_from_rad;     /* where it comes from, clockwise from north */
    double humidity;          /* relative, 0 .. 1 */
    double cloud;             /* mean share of the sky that clouds cover, 0 .. 1 */
    double rain_mm_h;
    /* all wavelengths, at the ground: direct sun on a plane facing it, diffuse on level ground, longwave down on level
     * ground. NaN: of the atmosphere's tables, under those clouds */
    double direct_w_m2, diffuse_w_m2, longwave_w_m2;
} Weather;

static inline Weather weather_default(void)
{
    return (Weather){.visibility_m = 23000, .air_temp_k = 288.15, .pressure_mbar = 1013.25, .wind_mps = 3,
                     .wind_from_rad = 270 * 0.017453292519943295769, .humidity = 0.6, .direct_w_m2 = NAN,
                     .diffuse_w_m2 = NAN, .longwave_w_m2 = NAN};
}

#endif
