/* sensor/commands/output_files.c: see output_files.h. */
#include "sensor/commands/output_files.h"
#include "pitviper_output.h"

#include "sensor/node/overwrite.h"

#include <errno.h>
#include <strings.h>
#include <sys/stat.h>

/* x.png, x.svg: meant for a file. A folder may have a point in its name: models.old, v1.2. */
static bool is_file_name(const char *path)
{
    static const char *const ends[] = {".png", ".svg", ".csv", ".jpg", ".jpeg", ".pdf", ".html", ".txt", ".json", ".exr",
                                       ".tif", ".tiff", ".gif", ".eps", ".yaml", ".xyz"};
    struct stat about;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        if (strcasecmp(output_ending(path), ends[i]) == 0) return stat(path, &about) != 0 || !S_ISDIR(about.st_mode);
    return false;
}

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
    if (is_file_name(folder)) {
        log_error("%s: '%s': --out names a folder, for %s and the other files; leave out the ending, or end it with / if that is its "
                  "name", command, folder, name[0]);
        return STATUS_BAD_VALUE;
    }
    const bool above = output_check(folder, 0) == 0 || errno == EISDIR || errno == ELOOP; /* there, or the folder that it is in */
    if (!above || output_folder(folder) != 0) {
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
