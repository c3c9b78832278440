/* sensor/settings/projector_choice.h: what projector.* asks for. */
#ifndef SENSOR_SETTINGS_PROJECTOR_CHOICE_H
#define SENSOR_SETTINGS_PROJECTOR_CHOICE_H

#include "sensor/settings/config.h"

/* `full`, or WIDTHxHEIGHT, each 16 .. 16384. */
bool projector_window_good(const char *text);
/* STATUS_BAD_VALUE, logged with what to do; without SDL2 projector.band is refused. Part of config_check. */
Status projector_check(const Config *config);

#endif
