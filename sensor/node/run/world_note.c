/* sensor/node/run/world_note.c: the note of a live node's world: written, and read again. */
#include "sensor/node/run/world_note.h"

#include <stdio.h>
#include <stdlib.h>

static const char begin[] = "pitviper: world until ";
enum { numbers = 7 };

void world_note_text(char out[world_note_size], const WorldNote *n)
{
    snprintf(out, world_note_size, "%s%a at %a %a %a square %a %a %a%s", begin, n->until_s, n->origin.lat_rad,
             n->origin.lon_rad, n->origin.h_m, n->square.centre_m[0], n->square.centre_m[1], n->square.half_width_m,
             n->square.own ? " own" : "");
}

/* The next number, behind some words. */
static bool take(double *out, const char **at, const char *words)
{
    char *end;
    if (strncmp(*at, words, strlen(words)) != 0) return false;
    *at += strlen(words);
    if (**at == ' ') return false; /* strtod would pass over it */
    *out = strtod(*at, &end);
    const bool any = end != *at;
    *at = end;
    return any;
}

static bool in_range(const WorldNote *n)
{
    static const double latest_s = 1e11, far_m = 1e6, least_m = 50, most_m = 50000, high_m = 1e5;
    return fabs(n->until_s) < latest_s && fabs(n->origin.lat_rad) <= 0.5 * pi_rad &&
           fabs(n->origin.lon_rad) <= pi_rad && fabs(n->origin.h_m) < high_m && fabs(n->square.centre_m[0]) < far_m &&
           fabs(n->square.centre_m[1]) < far_m && n->square.half_width_m >= least_m && n->square.half_width_m <= most_m;
}

/* A line that is, to the octet, what world_note_text writes. */
static bool read_line(WorldNote *out, const char *line)
{
    static const char *const words[numbers] = {begin, " at ", " ", " ", " square ", " ", " "};
    char                     text[world_note_size], again[world_note_size];
    const size_t             length = strcspn(line, "\n");
    double                   v[numbers];
    if (length >= sizeof text) return false;
    memcpy(text, line, length);
    text[length] = 0;
    const char *at = text;
    for (int k = 0; k < numbers; k++)
        if (!take(&v[k], &at, words[k])) return false;
    *out = (WorldNote){v[0], {v[1], v[2], v[3]}, {{v[4], v[5]}, v[6], strcmp(at, " own") == 0}};
    world_note_text(again, out);
    return in_range(out) && strcmp(text, again) == 0;
}

bool world_note_read(WorldNote *out, const char *notes)
{
    for (const char *at = notes; at && *at; at += strcspn(at, "\n"), at += *at == '\n')
        if (read_line(out, at)) return true;
    return false;
}
