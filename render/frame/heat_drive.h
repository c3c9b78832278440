/* render/frame/heat_drive.h: what drives the ground's heat: the weather's course with the sun and sky of the atmosphere. */
#ifndef RENDER_FRAME_HEAT_DRIVE_H
#define RENDER_FRAME_HEAT_DRIVE_H

#include "render/air/daylight.h"
#include "render/heat/heat.h"
#include "terrain/weather/weather.h"

/* Heat keeps a pointer to it, and it to these: they outlive the heat. */
typedef struct HeatDrive {
    const WeatherCourse *course;
    AirSource            source;
    Geodetic             place;
    double               exercise_s; /* Unix time of exercise time 0 */
} HeatDrive;

/* HeatWeather; user: a HeatDrive. Thermometer at 2 m, anemometer at 10 m. Beyond 1900 .. 2100 there is no sun. */
void   heat_drive_weather(GroundWeather *out, double unix_s, const void *drive);
/* Sun and all of its radiation at a place under this weather. STATUS_BAD_VALUE: sun_at's. */
Status heat_drive_daylight(Daylight *out, const AirSource *source, const Geodetic *place, const Weather *weather, double unix_s);

#endif
