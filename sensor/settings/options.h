/* sensor/settings/options.h: the command lines of replay and run, one table. */
#ifndef SENSOR_SETTINGS_OPTIONS_H
#define SENSOR_SETTINGS_OPTIONS_H

#include "sensor/settings/config.h"

enum {
    options_hosts_max = 64, options_only_max = 256, options_given_max = 64,
    options_variant_argv = 10 + 2 * options_given_max,
};

typedef enum CommandName { COMMAND_REPLAY, COMMAND_RUN } CommandName;

/* An option that is no setting, as it stood on the line. */
typedef struct OptionGiven {
    char        flag[40];      /* --name */
    const char *argument;      /* NULL: it takes none */
    bool        same_products; /* it changes no product */
} OptionGiven;

typedef struct Options {
    CommandName command;
    const char *log, *out, *isa;
    const char *sweep;          /* a file of sensor/commands/sweep_file.h; NULL: one run */
    int         threads, host_count, frames; /* frames: stop after so many; 0: never */
    double      speed, for_s;   /* exercise seconds a second, INFINITY: as fast as it goes; stop after so long */
    bool        no_skip, overwrite;
    const char *host[options_hosts_max]; /* several of them, ids; one is in the configuration */
    int         only_count, only[options_only_max]; /* frames to be made, ascending, each once; 0: all */
    int         save_count, save[options_only_max]; /* frames that are written as frame files, likewise; 0: none */
    int         given_count;
    OptionGiven given[options_given_max]; /* in order; those that are settings are in config, the sweep's own left out */
    Config      config;
} Options;

/* Fills *o with defaults, the configuration file, then the options over it. 0: go on; else exit with this code - 1:
 * help was asked for (0), or something was wrong and is logged (2). */
int options_parse(Options *o, CommandName command, int argc, char **argv);
const char *options_command(const Options *o); /* `replay`, `run` */

/* The command line of a variant of a sweep: a run with these options but for the settings, which it reads from a file,
 * and its folder. argv: points into o and to the two paths, NULL behind the last. */
void options_variant(const char *argv[options_variant_argv], const Options *o, const char *settings, const char *out);

/* The table itself, for what must treat every option. False: not one of the command's. */
int  options_count(void);
bool options_option(const char **name, bool *argument, CommandName command, int i);

#endif
