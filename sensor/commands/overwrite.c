/* sensor/commands/overwrite.c: refuses to replace existing products unless --overwrite is given, and what cannot be
 * written. */
#include "sensor/commands/overwrite.h"

#include "pitviper_output.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/video/video_names.h"

#include <errno.h>
#include <strings.h>
#include <sys/stat.h>

Status overwrite_folder(const char *command, const char *out, bool allowed)
{
    char   found[frame_path_size];
    Status status = frame_files_folder(out);
    if (status == STATUS_OK) status = output_hold(command, out);
    if (status == STATUS_OK && !allowed && frame_files_earlier(found, out)) {
        log_error("%s: %s exists from an earlier run; choose another folder with --out, or --overwrite, which deletes "
                  "the frames, truth.jsonl and run.json of that run",
                  command, found);
        status = STATUS_BAD_VALUE;
    }
    return status == STATUS_OK ? frame_files_check(out) : status;
}

/* Checks that it can be written at all; else logged, with the option that names another. absent: its folder may be
 * made later. */
static Status check(const char *command, const char *path, unsigned how, const char *option, bool absent)
{
    if (output_check(path, how) == 0 || (absent && errno == ENOENT)) return STATUS_OK;
    log_error("%s: cannot write %s: %s; choose another name%s%s", command, path, output_reason(errno),
              *option ? " with " : "", option);
    return STATUS_IO;
}

Status overwrite_file(const char *command, const char *path, bool allowed)
{
    struct stat about;
    if (!allowed && lstat(path, &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0) {
        log_error("%s: %s exists already (%lld octets); choose another name, or --overwrite, which replaces it",
                  command, path, (long long)about.st_size);
        return STATUS_BAD_VALUE;
    }
    return check(command, path, OUTPUT_STREAM, "", true);
}

Status overwrite_video(const char *command, const Config *config, unsigned bands, const char *host_folder, bool allowed)
{
    char            found[video_path_size];
    const char     *path = config->publish.video;
    const VideoKind kind = video_kind(path);
    if (!allowed && video_earlier(found, config, bands, host_folder)) {
        log_error("%s: %s exists already; choose another name with --video, or --overwrite, which replaces it", command,
                  found);
        return STATUS_BAD_VALUE;
    }
    return kind == VIDEO_NONE ? STATUS_OK
                              : check(command, path, kind == VIDEO_FOLDER ? OUTPUT_FOLDER : 0, "--video", false);
}

/* ---- the files of a command that writes some of fixed names ----------------------------------------- */

/* Whether a name such as x.png or x.svg is meant for a file. A folder may have a point in its name: models.old, v1.2.
 */
static bool is_file_name(const char *path)
{
    static const char *const ends[] = {".png",  ".svg", ".csv", ".jpg",  ".jpeg", ".pdf", ".html", ".txt",
                                       ".json", ".exr", ".tif", ".tiff", ".gif",  ".eps", ".yaml", ".xyz"};
    struct stat              about;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        if (strcasecmp(output_ending(path), ends[i]) == 0) return stat(path, &about) != 0 || !S_ISDIR(about.st_mode);
    return false;
}

Status overwrite_files(OutputPath path[], const OutputFiles *files)
{
    const char *command = files->command, *given = files->given;
    const char *slash = strrchr(files->model, '/'), *last = slash ? slash + 1 : files->model;
    char        folder[output_path_size - 32];
    const int   length =
        given ? snprintf(folder, sizeof folder, "%s", given)
                : snprintf(folder, sizeof folder, "%.*s_%s", (int)strcspn(last, files->endings), last, command);
    if (length >= (int)sizeof folder) {
        log_error("%s: the folder's name is too long; choose a shorter one with --out", command);
        return STATUS_BAD_VALUE;
    }
    if (is_file_name(folder)) {
        log_error(
            "%s: '%s': --out names a folder, for %s and the other files; leave out the ending, or end it with / if that is its "
            "name",
            command, folder, files->name[0]);
        return STATUS_BAD_VALUE;
    }
    const bool above =
        output_check(folder, 0) == 0 || errno == EISDIR || errno == ELOOP; /* there, or the folder that it is in */
    if (!above || output_folder(folder) != 0) {
        log_error("%s: cannot create %s: %s; choose another folder with --out", command, folder, output_reason(errno));
        return STATUS_IO;
    }
    Status status = output_hold(command, folder);
    for (int k = 0; k < files->count && status == STATUS_OK; k++) {
        snprintf(path[k], output_path_size, "%s/%.30s", folder, files->name[k]);
        status = overwrite_file(command, path[k], files->overwrite);
    }
    return status;
}
