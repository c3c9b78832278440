/* sensor/commands/next_option.h: getopt_long, whose own messages show what was typed as it is: here they are safe for a
 * terminal (text_print). Used as getopt_long; '?' has been explained. */
#ifndef SENSOR_COMMANDS_NEXT_OPTION_H
#define SENSOR_COMMANDS_NEXT_OPTION_H

#include <getopt.h>

int next_option(int argc, char **argv, const char *letters, const struct option *list);

#endif
