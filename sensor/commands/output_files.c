/* sensor/commands/output_files.c: see output_files.h. */
#include "sensor/commands/output_files.h"
#include "pitviper_output.h"

#include "sensor/node/overwrite.h"

#include <errno.h>

Status output_files(OutputPath path[], const char *const name[], int count, const char *command, const char *given,
                    const char *model, const char *endings, bool overwrite)
{
    const char *slash = strrchr(model, '/'), *last = slash ? slash + 1 : model;
    char        folder[output_path_size - 32];
    const int   length = given ? snprintf(folder, sizeof folder, "%s", given)
                               : snprintf(folder, sizeof folder, "%.*s_%s", (int)strcspn(last, endings), last, command);
    if (length >= (int)sizeof folder) {
        log_error("%s: the folder's name is too long; choose a shorter one with --out", command);
        return STATUS_BAD_VALUE;
    }
    if (output_folder(folder) != 0) {
        log_error("%s: cannot create %s: %s; choose another folder with --out", command, folder, output_reason(errno));
        return STATUS_IO;
    }
    Status status = output_hold(command, folder);
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        snprintf(path[k], output_path_size, "%s/%.30s", folder, name[k]);
        status = overwrite_file(command, path[k], overwrite);
    }
    return status;
}
