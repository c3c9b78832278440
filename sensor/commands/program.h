/* sensor/commands/program.h: what pitviper and pitviper-bench do with their streams, the environment and common
 * options. */
#ifndef SENSOR_COMMANDS_PROGRAM_H
#define SENSOR_COMMANDS_PROGRAM_H

#include "pitviper.h"

/* The options that every command takes, as lines of its help. */
extern const char program_common_help[];

/* If standard input, output or error is closed (`>&-`), the next file opened would get its descriptor and messages
 * would be written into recordings. /dev/null takes their place; read-only, so that printing fails and is reported. */
void program_fill_closed(void);
/* Removes -q and -v before any `--` from the command line. False, logged, when both are given. */
bool program_take_verbosity(int *argc, char **argv);
/* Whether an option is anywhere before `--`. */
bool program_asks_for(const char *name, const char *letter, int argc, char **argv);
/* Whether PITVIPER_ETC, where it is set, is a folder; and, for a command that reads tables, whether they are there.
 * Logged. --default and --keys read none. */
bool program_tables_there(bool reads, int argc, char **argv);
/* Flushes standard output. The exit code, 1 instead of 0 when the output could not be written; a reader that has left
 * before the end is no failure. */
int program_printed(int code);

#endif
