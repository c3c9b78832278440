/* sensor/node/options.h: the command lines of replay and run, one table. */
#ifndef SENSOR_NODE_OPTIONS_H
#define SENSOR_NODE_OPTIONS_H

#include "sensor/node/config.h"

enum { options_hosts_max = 64, options_only_max = 256 };

typedef enum CommandName { COMMAND_REPLAY, COMMAND_RUN } CommandName;

typedef struct Options {
    CommandName command;
    const char *log, *out, *isa;
    const char *sweep;          /* a file of sensor/node/sweep_file.h; NULL: one run */
    int         threads, host_count, frames; /* frames: stop after so many; 0: never */
    double      speed, for_s;   /* exercise seconds a second, INFINITY: as fast as it goes; stop after so long */
    bool        no_skip, overwrite;
    const char *host[options_hosts_max]; /* several of them, ids; one is in the configuration */
    int         only_count, only[options_only_max]; /* frames to be made, ascending, each once; 0: all */
    Config      config;
} Options;

/* Fills *o with defaults, the configuration file, then the options over it. 0: go on; else exit with this code - 1:
 * help was asked for (0), or something was wrong and is logged (2). */
int options_parse(Options *o, CommandName command, int argc, char **argv);
const char *options_command(const Options *o); /* `replay`, `run` */

#endif
