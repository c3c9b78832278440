/* etc/fmu/variables.h: the variables of the FMU, by their value references in modelDescription.xml, and their values.
 */
#ifndef PITVIPER_FMU_VARIABLES_H
#define PITVIPER_FMU_VARIABLES_H

#include "fmi3.h"

#include <string.h>

enum { is_time, is_number, is_flag, is_count, is_text }; /* the type of a variable */

/* By value reference, as in modelDescription.xml. */
enum {
    time_s = 0,
    program = 1,
    recording,
    options,
    memory,
    target,
    log_file,
    folder,
    start_s = 10,
    start_limit_s,
    step_limit_s,
    rates = 15,
    position = 20,
    attitude = 23,
    velocity = 27,
    turning = 30, /* 3, 4, 3, 3 */
    valid = 40,
    sight = 41,
    sight_rate = 44,
    range_m = 46,
    closing_mps,
    right_rad,
    up_rad,
    visible,
    pixels,
    frame_s, /* 3, 2, 1 ... */
    frame = 60,
    sequence,
    offset,
    octets,
    ring,
    variables,
};
enum { text_size = 4096, texts = folder - program + 1 };

typedef struct Values {
    double number[variables]; /* flags and counts, too: below 2^53 */
    char   text[texts][text_size];
} Values;

/* -1: there is no such variable. */
static inline int kind_of(fmi3Reference v)
{
    if (v == time_s) return is_time;
    if ((v >= program && v <= folder) || v == ring) return is_text;
    if (v == rates || v == valid) return is_flag;
    if (v >= frame && v <= octets) return is_count;
    if ((v >= start_s && v <= step_limit_s) || (v >= position && v < turning + 3) || (v >= sight && v <= frame_s))
        return is_number;
    return -1;
}

static inline void set_start_values(Values *v)
{
    memset(v, 0, sizeof *v);
    strcpy(v->text[0], "pitviper");
    strcpy(v->text[options - program], "--bands lwir --no-files");
    v->number[start_limit_s] = 300;
    v->number[step_limit_s] = 30;
    v->number[attitude] = 1;
    v->number[frame] = -1;
}

#endif
