/* sensor/settings/plane_choice.c: parses a list of names of truth planes. */
#include "sensor/settings/plane_choice.h"

const char *const plane_choice_name[PLANE_CHOICES] = {"range", "entity", "part", "material", "temperature", "normal",
                                                    "instance", "cover", "emissivity"};

bool plane_choice_parse(unsigned *planes, const char *text)
{
    unsigned set = 0;
    *planes      = planes_none;
    if (strcmp(text, "none") == 0) return true;
    if (strcmp(text, "all") == 0) {
        *planes = planes_all;
        return true;
    }
    for (const char *at = text; at;) {
        const size_t length = strcspn(at, ",");
        int          k      = 0;
        while (k < PLANE_CHOICES &&
               (strlen(plane_choice_name[k]) != length || strncmp(plane_choice_name[k], at, length) != 0)) k++;
        if (k == PLANE_CHOICES) return false;
        set |= 1u << k;
        at = at[length] ? at + length + 1 : NULL;
    }
    *planes = set;
    return true;
}
