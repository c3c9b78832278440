/* sensor/settings/memory_choice.h: the settings of shared memory: publish.memory and those that belong to it. */
#ifndef SENSOR_SETTINGS_MEMORY_CHOICE_H
#define SENSOR_SETTINGS_MEMORY_CHOICE_H

#include "pitviper.h"

/* Whether a name may be that of a ring: it becomes a file's name under /dev/shm. */
bool   memory_name_good(const char *name);
/* publish.memory, publish.memory_planes; sensor: whether a band has one. STATUS_BAD_VALUE, logged with what to do. Part
 * of config_check. */
Status memory_choice_check(const char *name, const char *planes, bool sensor);

#endif
