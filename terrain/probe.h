/* terrain/probe.h: the entries of `pitviper probe` of this module. */
#ifndef TERRAIN_PROBE_H
#define TERRAIN_PROBE_H

#include "terrain/earth/geodesy.h"
#include "terrain/weather/weather.h"

extern const Probe terrain_probes[];
extern const int   terrain_probe_count;

/* Arguments of probes that take weather, after their name, argv[0]. A clear day where none says otherwise, at the
 * place given. */
#define PROBE_WEATHER_ARGUMENTS "[FILE|clear|constant [LAT_DEG LON_DEG]]"
Status probe_weather(WeatherCourse **out, Geodetic *place, int argc, char **argv);

#endif
