/* sensor/settings/memory_choice.c: checks the settings of shared memory. */
#include "sensor/settings/memory_choice.h"

#include <ctype.h>

bool memory_name_good(const char *name)
{
    if (!isalnum((unsigned char)*name)) return false; /* no hidden file, no folder */
    for (const char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("-_.", *c)) return false;
    return true;
}

Status memory_choice_check(const char *name, const char *planes, bool sensor)
{
    if (!*name) return STATUS_OK;
    if (!memory_name_good(name)) {
        log_error("config: publish.memory: '%s' is not a name of letters, digits, `-`, `_` and `.` that begins with a "
                  "letter or a digit, for example seeker", name);
        return STATUS_BAD_VALUE;
    }
    if (strcmp(planes, "counts") == 0 && !sensor) {
        log_error("config: publish.memory_planes: counts are those of a sensor; choose one with sensor.preset or "
                  "sensor.table, or set publish.memory_planes: float");
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}
