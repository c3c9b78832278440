/* sensor/commands/output_files.h: the files of a command that writes some of fixed names into a folder. */
#ifndef SENSOR_COMMANDS_OUTPUT_FILES_H
#define SENSOR_COMMANDS_OUTPUT_FILES_H

#include "pitviper.h"

enum { output_path_size = 4096 };
typedef char OutputPath[output_path_size];

/* path[count]: FOLDER/name[k], in the folder `given`, else in that of the model's name, without its own folders and from the first of
 * these endings on, and _COMMAND. Refuses those that are there, unless overwrite; creates the folder. Failures are logged as the
 * command's. */
Status output_files(OutputPath path[], const char *const name[], int count, const char *command, const char *given,
                    const char *model, const char *endings, bool overwrite);

#endif
