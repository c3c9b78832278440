/* sensor/settings/memory_choice.h: checks the settings of shared memory: publish.memory and those that belong to it. */
#ifndef SENSOR_SETTINGS_MEMORY_CHOICE_H
#define SENSOR_SETTINGS_MEMORY_CHOICE_H

#include "pitviper.h"

typedef struct MemoryChoice {
    const char *name;   /* publish.memory; empty: none */
    bool        counts; /* publish.memory_planes */
    bool        sensor; /* a band has a sensor */
    const char *given;  /* a key that only has an effect with a name, and was set; NULL: none */
} MemoryChoice;

/* STATUS_BAD_VALUE, logged with what to do. */
Status memory_choice_check(const MemoryChoice *choice);

#endif
