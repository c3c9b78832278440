/* sensor/settings/aim_offset.c: the text of sensor.aim_offset. */
#include "sensor/settings/aim_offset.h"

/* Two numbers, separated by a comma, each within +- most. */
static bool two_numbers(double out[2], const char *text, size_t octets, double least, double most)
{
    char  word[64];
    char *comma;
    if (octets >= sizeof word) return false;
    memcpy(word, text, octets);
    word[octets] = 0;
    if (!(comma = strchr(word, ','))) return false;
    *comma++ = 0;
    comma += strspn(comma, " ");
    double value[2];
    if (!text_to_double(&value[0], word) || !text_to_double(&value[1], comma)) return false;
    for (int k = 0; k < 2; k++)
        if (!(value[k] >= least && value[k] <= most)) return false;
    out[0] = value[0], out[1] = value[1];
    return true;
}

bool aim_offset_parse(AimOffset *out, const char *text)
{
    static const char drawn[] = "drawn", degrees[] = " deg";
    const size_t      octets = strlen(text), tail = sizeof degrees - 1;
    AimOffset         a = {0};
    if (strcmp(text, "none") == 0) {
        *out = a;
        return true;
    }
    if (strncmp(text, drawn, sizeof drawn - 1) == 0) {
        const char *rest = text + sizeof drawn - 1;
        a = (AimOffset){.drawn = true, .at = {0.8, 0.8}};
        if (*rest && (*rest != ' ' || !two_numbers(a.at, rest + 1, strlen(rest + 1), 0, 1))) return false;
        a.at[0] *= 0.5, a.at[1] *= 0.5;
        *out = a;
        return true;
    }
    a.degrees = octets > tail && strcmp(text + octets - tail, degrees) == 0;
    const double most = a.degrees ? 60 : 0.5;
    if (!two_numbers(a.at, text, a.degrees ? octets - tail : octets, -most, most)) return false;
    *out = a;
    return true;
}
