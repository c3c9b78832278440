/* sensor/settings/memory_choice.c: checks the settings of shared memory. */
#include "sensor/settings/memory_choice.h"

#include <ctype.h>

/* It becomes a file's name under /dev/shm: no hidden file, no folder. */
static bool name_is_good(const char *name)
{
    if (!isalnum((unsigned char)*name)) return false;
    for (const char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("-_.", *c)) return false;
    return true;
}

Status memory_choice_check(const MemoryChoice *choice)
{
    if (*choice->name && !name_is_good(choice->name)) {
        log_error("config: publish.memory: '%s' is not a name of letters, digits, `-`, `_` and `.` that begins with a "
                  "letter or a digit, for example seeker", choice->name);
        return STATUS_BAD_VALUE;
    }
    if (*choice->name && choice->counts && !choice->sensor) {
        log_error("config: publish.memory_planes: counts are those of a sensor; choose one with sensor.preset or "
                  "sensor.table, or set publish.memory_planes: float");
        return STATUS_BAD_VALUE;
    }
    if (!*choice->name && choice->given) {
        log_error("config: %s: has no effect without publish.memory; name the ring, for example --memory seeker",
                  choice->given);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}
