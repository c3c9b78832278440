/* sensor/commands/overwrite.h: nothing that is there already is replaced unless --overwrite says so. */
#ifndef SENSOR_COMMANDS_OVERWRITE_H
#define SENSOR_COMMANDS_OVERWRITE_H

#include "pitviper.h"

/* Both log what is there and which option lets it go, in the name of a command. STATUS_BAD_VALUE: it must not be.
 * folder: of a run, which may hold anything else. file: one that is empty or no regular file is no loss. */
Status overwrite_folder(const char *command, const char *out, bool allowed);
Status overwrite_file(const char *command, const char *path, bool allowed);

#endif
