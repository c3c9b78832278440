/* sensor/commands/rcs_library.h: `pitviper rcs MODEL --library FOLDER`: signatures for a seeker's radar, beforehand. */
#ifndef SENSOR_COMMANDS_RCS_LIBRARY_H
#define SENSOR_COMMANDS_RCS_LIBRARY_H

#include "pitviper.h"

extern const char rcs_library_help[];
/* argv as of `rcs`; exit code. */
int rcs_library_command(int argc, char **argv);

#endif
