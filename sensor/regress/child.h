/* sensor/regress/child.h: this program once more, as a process of its own: what breaks or hangs there breaks nothing
 * here. */
#ifndef SENSOR_REGRESS_CHILD_H
#define SENSOR_REGRESS_CHILD_H

#include "pitviper.h"

enum { child_arguments_max = 640 };

typedef struct ChildLine {
    int         count;
    const char *argument[child_arguments_max + 1]; /* argument[0]: `pitviper`; ends with NULL. Borrowed */
} ChildLine;

typedef struct ChildEnd {
    bool   timed_out, stopped;  /* ended by us: after timeout_s; because we were told to stop */
    int    signal, code;        /* signal 0: it ended by itself, with this code */
    double seconds;
} ChildEnd;

/* False when there are too many. */
bool   child_add(ChildLine *line, const char *argument);
/* Runs it to its end, in the environment of this process but in English numbers (LC_ALL=C), with nothing on standard
 * input; its output goes to two files. In a process group of its own, all of which ends with it. STATUS_IO, logged, when
 * it cannot be started. */
Status child_run(ChildEnd *end, const ChildLine *line, const char *out_path, const char *error_path, double timeout_s);
/* As a shell takes it. */
void   child_text(char *out, size_t out_size, const ChildLine *line);
/* The last lines of a file, that many octets at most; "" when it cannot be read. */
void   child_tail(char *out, size_t out_size, const char *path);

#endif
