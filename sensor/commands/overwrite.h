/* sensor/commands/overwrite.h: existing products are only replaced with --overwrite. */
#ifndef SENSOR_COMMANDS_OVERWRITE_H
#define SENSOR_COMMANDS_OVERWRITE_H

#include "sensor/settings/config.h"

/* Called when everything else is known to be right, and before anything is written. All log, prefixed with the name
 * of a command: STATUS_BAD_VALUE, the existing product and the option that replaces it; STATUS_IO, what cannot be
 * written, and why. folder: of a run, which is created and held (output_hold); other files in it are ignored. file:
 * an empty or irregular file may be replaced. */
Status overwrite_folder(const char *command, const char *out, bool allowed);
Status overwrite_file(const char *command, const char *path, bool allowed);
/* Checks the videos of a run (publish.video). host_folder: the folder of one host among several; NULL: there is only
 * one. */
Status overwrite_video(const char *command, const Config *config, unsigned bands, const char *host_folder,
                       bool allowed);

enum { output_path_size = 4096 };
typedef char OutputPath[output_path_size];

/* The files of a command that writes some of fixed names into a folder. */
typedef struct OutputFiles {
    const char        *command; /* for messages, and of the folder's name where none is given */
    int                count;
    const char *const *name;  /* [count] */
    const char        *given; /* the folder; NULL: that of the model's name, without its own folders, and _COMMAND */
    const char        *model, *endings; /* the model's name ends before the first of these characters */
    bool               overwrite;
} OutputFiles;

/* path[files->count]: FOLDER/NAME. Creates the folder. Refuses files that are there, unless overwrite. Failures are
 * logged as the command's. */
Status overwrite_files(OutputPath path[], const OutputFiles *files);

#endif
