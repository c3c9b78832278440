/* terrain/weather/weather_private.h: rows of a weather file, and what its readers and the course share. */
#ifndef TERRAIN_WEATHER_WEATHER_PRIVATE_H
#define TERRAIN_WEATHER_WEATHER_PRIVATE_H

#include "terrain/weather/weather.h"

typedef enum WeatherColumn {
    WEATHER_AIR_K,
    WEATHER_HUMIDITY,
    WEATHER_PRESSURE_MBAR,
    WEATHER_WIND_MPS,
    WEATHER_WIND_FROM_RAD,
    WEATHER_CLOUD,
    WEATHER_VISIBILITY_M,
    WEATHER_RAIN_MM_H,
    WEATHER_DIRECT,
    WEATHER_DIFFUSE,
    WEATHER_LONGWAVE,
    weather_columns
} WeatherColumn;

static const double weather_day_s = 86400, weather_year_s = 365 * 86400.0;

typedef struct WeatherRows {
    const char *format;                      /* "EPW" .. */
    char        place[96];                   /* name of the station; empty: not given */
    double      latitude_rad, longitude_rad; /* of the station; NaN: not given */
    /* A typical year: time_s counts from 1 January 0 h of a year of 365 days in the file's local standard time, and
     * lies in (0, weather_year_s]. Else it is Unix time. */
    bool    each_year;
    double  utc_offset_s;           /* local standard time less UTC; 0 for Unix time */
    double  mean_s;                 /* radiation and rain are means over so long before the row's time; 0: at it */
    int     count, leap_rows;       /* leap_rows: of 29 February, left out of a typical year */
    double *time_s;                 /* ascending                                  [count] */
    double *value[weather_columns]; /* NaN: not given. NULL: in no row            [count] */
} WeatherRows;

/* Failures are logged. At least one row has an air temperature. */
Status weather_file_read(WeatherRows *out, const char *path);
void   weather_rows_close(WeatherRows *rows);

#endif
