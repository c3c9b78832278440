/* sensor/settings/next_option.h: getopt_long with its messages escaped for the terminal (text_print). Used like
 * getopt_long; for '?' the error has been printed. */
#ifndef SENSOR_SETTINGS_NEXT_OPTION_H
#define SENSOR_SETTINGS_NEXT_OPTION_H

#include <getopt.h>

int next_option(int argc, char **argv, const char *letters, const struct option *list);

#endif
