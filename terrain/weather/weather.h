/* terrain/weather/weather.h: weather: the parameters that light and heat depend on, at a time. */
#ifndef TERRAIN_WEATHER_WEATHER_H
#define TERRAIN_WEATHER_WEATHER_H

#include "pitviper.h"

/* What takes the light below 2 km of visibility: haze, or drops of a fog that radiation or advection made; auto: of
 * radiation below 3 m/s of wind, else of advection. */
typedef enum WeatherFog { WEATHER_FOG_AUTO, WEATHER_FOG_NONE, WEATHER_FOG_RADIATION, WEATHER_FOG_ADVECTION } WeatherFog;

typedef struct Weather {
    double     visibility_m; /* meteorological range, 2 % contrast, 100 .. 300 000 */
    double     air_temp_k;   /* at the ground, 220 .. 330; NaN: that of the standard atmosphere in use */
    double     pressure_mbar;
    double     wind_mps;
    double     wind_from_rad; /* where it comes from, clockwise from north */
    double     humidity;      /* relative, 0 .. 1 */
    double     cloud;         /* mean share of the sky that clouds cover, 0 .. 1 */
    double     rain_mm_h;     /* below 0 C snow, as water */
    WeatherFog fog;
    /* all wavelengths, at the ground: direct sun on a plane facing it, diffuse on level ground, longwave down on level
     * ground. NaN: of the atmosphere's tables, under those clouds */
    double direct_w_m2, diffuse_w_m2, longwave_w_m2;
} Weather;

static inline Weather weather_default(void)
{
    return (Weather){.visibility_m = 23000,
                     .air_temp_k = 288.15,
                     .pressure_mbar = 1013.25,
                     .wind_mps = 3,
                     .wind_from_rad = 270 * 0.017453292519943295769,
                     .humidity = 0.6,
                     .direct_w_m2 = NAN,
                     .diffuse_w_m2 = NAN,
                     .longwave_w_m2 = NAN};
}

/* Saturation vapour pressure over water, Pa: Tetens, as in Campbell & Norman (1998), eq. 3.8. */
static inline double weather_saturation_pa(double temp_k)
{
    const double c = temp_k - 273.15;
    return 611 * exp(17.502 * c / (240.97 + c));
}

/* Water vapour at the ground, kg/m3: that humidity at that temperature, a number, by the gas law (Rv 461.52 J/(kg K)).
 */
static inline double weather_vapour_kg_m3(const Weather *weather)
{
    return weather->humidity * weather_saturation_pa(weather->air_temp_k) / (461.52 * weather->air_temp_k);
}

/* ---- weather as a function of time: constant, a clear day, or a file of it ----------------------- */

/* Clear day: the air temperature follows Parton & Logan, A model for diurnal variation in soil and air temperature,
 * Agricultural Meteorology 23 (1981) 205, air at 150 cm, in the form of Wann, Yen & Gold (1985): a sine from the
 * minimum, 0.17 h before sunrise, through the maximum, 1.86 h after solar noon, to sunset, then an exponential to the
 * next minimum, displaced so that it ends there. Sunrise is geometric, of the sun's centre. Days shorter than 4 h have
 * the shape of 4 h and a range in proportion, none in polar night; days longer than 20 h, polar day too, have the
 * shape of 20 h. Within 5 degrees of a pole the range falls to none. The mean of a day is that of the base within 0.1
 * K, where days change fast, beyond 60 degrees, within 2 % of the range. The vapour pressure is constant, so that
 * relative humidity falls by day.
 *
 * File: EPW, TMY3 or a table of our own, told apart by content; etc/reference/weather.md has columns, units, ranges
 * and what is assumed. */

typedef struct WeatherCourse WeatherCourse;

typedef struct WeatherCourseConfig {
    Weather base;        /* what a course or file does not say; air_temp_k is a number, the daily mean of a clear day */
    double  air_range_k; /* of a clear day: maximum less minimum, 0 .. 60 */
    double  longitude_rad, latitude_rad; /* WGS 84, within 2 pi and pi / 2 */
} WeatherCourseConfig;

/* day: "constant", "clear" or the path of a file. Failures are logged: with file, line, column, value and accepted
 * range. The course holds the whole file; 8 octets per row and column. */
Status weather_course_open(WeatherCourse **out, const char *day, const WeatherCourseConfig *config);
void   weather_course_close(WeatherCourse *course); /* accepts NULL */

/* At any time, whole or not; the same for the same time. No allocation; about a
 * microsecond. Radiation may be NaN, as in Weather; nothing else is. A time that is not finite: that of 1970-01-01. */
void weather_at(Weather *out, const WeatherCourse *course, double unix_s);

/* One line for the log: what it is, from when to when, what was assumed. Valid until close. */
const char *weather_course_about(const WeatherCourse *course);

#endif
