/* sensor/node/overwrite.h: existing products are only replaced with --overwrite. */
#ifndef SENSOR_NODE_OVERWRITE_H
#define SENSOR_NODE_OVERWRITE_H

#include "sensor/settings/config.h"

/* Called when everything else is known to be right, and before anything is written. All log, prefixed with the name of a
 * command: STATUS_BAD_VALUE, the existing product and the option that replaces it; STATUS_IO, what cannot be written, and why.
 * folder: of a run, which is created and held (output_hold); other files in it are ignored. file: an empty or irregular file
 * may be replaced. */
Status overwrite_folder(const char *command, const char *out, bool allowed);
Status overwrite_file(const char *command, const char *path, bool allowed);
/* The videos of a run (publish.video); host_folder: of one host among several, NULL: the only one. */
Status overwrite_video(const char *command, const Config *config, unsigned bands, const char *host_folder,
                       bool allowed);

#endif
