/* sensor/settings/command_line.h: the one parser of command lines: getopt_long with messages of its own. */
#ifndef SENSOR_SETTINGS_COMMAND_LINE_H
#define SENSOR_SETTINGS_COMMAND_LINE_H

#include <getopt.h>
#include <stdbool.h>

/* Used like getopt_long, with optind = 0 before the first call. -h is --help where the list has it. For '?' the error
 * has been logged, with the option that was perhaps meant. argv[0]: `pitviper COMMAND`. */
int command_line_option(int argc, char **argv, const char *letters, const struct option *list);
/* Logs what is wrong with a command line and where its help is. Returns 2, the exit code for it. command: `replay`. */
int command_line_wrong(const char *command, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The number of --threads, 1 .. 256. False, logged: the text is none. */
bool command_line_threads(int *threads, const char *command, const char *text);

#endif
