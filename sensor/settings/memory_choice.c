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

Status memory_choice_check(const Config *config)
{
    const bool wanted = *config->publish.memory != 0;
    if (wanted && !memory_name_good(config->publish.memory)) {
        log_error("config: publish.memory: '%s' is not a name of letters, digits, `-`, `_` and `.` that begins with a "
                  "letter or a digit, for example seeker", config->publish.memory);
        return STATUS_BAD_VALUE;
    }
    const bool sensor = strcmp(config->sensor.preset, "none") != 0 || *config_sheet(config);
    if (wanted && strcmp(config->publish.memory_planes, "counts") == 0 && !sensor) {
        log_error("config: publish.memory_planes: counts are those of a sensor; choose one with sensor.preset or "
                  "sensor.table, or set publish.memory_planes: float");
        return STATUS_BAD_VALUE;
    }
    static const char *const of_memory[] = {"publish.memory_planes", "publish.memory_record", "publish.memory_slots"};
    for (size_t i = 0; i < sizeof of_memory / sizeof *of_memory; i++)
        if (!wanted && config_given(config, of_memory[i])) {
            log_error("config: %s: has no effect without publish.memory; name the ring, for example --memory seeker",
                      of_memory[i]);
            return STATUS_BAD_VALUE;
        }
    return STATUS_OK;
}
