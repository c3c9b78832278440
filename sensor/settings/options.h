/* sensor/settings/options.h: the command lines of replay and run, in one table. */
#ifndef SENSOR_SETTINGS_OPTIONS_H
#define SENSOR_SETTINGS_OPTIONS_H

#include "sensor/settings/config.h"

enum {
    options_hosts_max = 64,
    options_only_max = 256,
    options_given_max = 64,
    options_variant_argv = 10 + 2 * options_given_max,
};

typedef enum CommandName { COMMAND_REPLAY, COMMAND_RUN } CommandName;

/* An option that is not a setting, as given. */
typedef struct OptionGiven {
    char        flag[40];      /* --name */
    const char *argument;      /* NULL: it takes none */
    bool        same_products; /* it changes no product */
} OptionGiven;

typedef struct Options {
    CommandName command;
    const char *log, *out, *isa;
    const char *sweep;                       /* a file of sensor/commands/sweep/sweep.h; NULL: one run */
    int         threads, host_count, frames; /* frames: stop after so many; 0: never */
    double      speed, for_s; /* exercise seconds per second, INFINITY: as fast as possible; stop after */
    bool        no_skip, overwrite;
    const char *host[options_hosts_max];            /* several ids; a single one is in the configuration */
    int         only_count, only[options_only_max]; /* frames to be made, ascending, each once; 0: all */
    int         save_count, save[options_only_max]; /* frames that are written as frame files, likewise; 0: none */
    int         given_count;
    OptionGiven given[options_given_max]; /* in order; without settings, which are in config, and the options of the
                                             sweep itself */
    Config config;
} Options;

/* Fills *o with defaults, the configuration file, then the options over it. 0: continue; else exit with this code - 1:
 * help was requested (0), or an error was logged (2). */
int         options_parse(Options *o, CommandName command, int argc, char **argv);
const char *options_command(const Options *o); /* `replay`, `run` */

/* Makes the command line of a variant of a sweep: these options, with a settings file and a folder of its own. argv:
 * points into o and to the two paths, ends with NULL. */
void options_variant(const char *argv[options_variant_argv], const Options *o, const char *settings, const char *out);

/* The table itself, for tests over all options. False: not an option of the command. */
int  options_count(void);
bool options_option(const char **name, bool *argument, CommandName command, int i);

#endif
