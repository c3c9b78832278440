/* sensor/settings/band_choice.h: the bands of a run, from sensor.bands. */
#ifndef SENSOR_SETTINGS_BAND_CHOICE_H
#define SENSOR_SETTINGS_BAND_CHOICE_H

#include "pitviper.h"

/* Bands, or channels in the place of one: these are chosen for the process, before tables are read (channel_choose).
 * False, logged: the text is no list of them. */
bool bands_choose(unsigned *bands, const char *text);
/* Whether it is one, without choosing. where: `node.yaml:3: ` before the message, or "". */
bool bands_check(const char *text, const char *where);

#endif
