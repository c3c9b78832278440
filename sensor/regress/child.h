/* sensor/regress/child.h: this program as a child process, so that a crash or a hang affects only one case. */
#ifndef SENSOR_REGRESS_CHILD_H
#define SENSOR_REGRESS_CHILD_H

#include "pitviper.h"

enum { child_arguments_max = 640 };

typedef struct ChildLine {
    int         count;
    const char *argument[child_arguments_max + 1]; /* argument[0]: `pitviper`; ends with NULL. Borrowed */
} ChildLine;

typedef struct ChildEnd {
    bool   timed_out, stopped;  /* ended by this process: after timeout_s; on a signal to stop */
    int    signal, code;        /* signal 0: it exited with this code */
    double seconds;
} ChildEnd;

/* False when there are too many. */
bool   child_add(ChildLine *line, const char *argument);
/* Runs it to its end, in the environment of this process but with LC_ALL=C and TZ=UTC, standard input empty, its
 * output in two files. In a process group of its own, which is ended as a whole. STATUS_IO, logged, when it cannot be
 * started. */
Status child_run(ChildEnd *end, const ChildLine *line, const char *out_path, const char *error_path, double timeout_s);
/* The command line, quoted for a shell. */
void   child_text(char *out, size_t out_size, const ChildLine *line);
/* The last lines of a file, that many octets at most; "" when it cannot be read. */
void   child_tail(char *out, size_t out_size, const char *path);

#endif
