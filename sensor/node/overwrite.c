/* sensor/node/overwrite.c: refuses to replace existing products unless --overwrite is given, and what cannot be written. */
#include "sensor/node/overwrite.h"

#include "pitviper_output.h"
#include "sensor/publish/frame_files.h"
#include "sensor/publish/video/video_names.h"

#include <errno.h>
#include <sys/stat.h>

Status overwrite_folder(const char *command, const char *out, bool allowed)
{
    char   found[frame_path_size];
    Status status = frame_files_folder(out);
    if (status == STATUS_OK) status = output_hold(command, out);
    if (status == STATUS_OK && !allowed && frame_files_earlier(found, out)) {
        log_error("%s: %s exists from an earlier run; choose another folder with --out, or --overwrite, which deletes "
                  "the frames, truth.jsonl and run.json of that run", command, found);
        status = STATUS_BAD_VALUE;
    }
    return status == STATUS_OK ? frame_files_check(out) : status;
}

/* Whether it can be written at all: logged, with the option that names another. absent: its folder may be made later. */
static Status check(const char *command, const char *path, unsigned how, const char *option, bool absent)
{
    if (output_check(path, how) == 0 || (absent && errno == ENOENT)) return STATUS_OK;
    log_error("%s: cannot write %s: %s; choose another name%s%s", command, path, output_reason(errno), *option ? " with " : "",
              option);
    return STATUS_IO;
}

Status overwrite_file(const char *command, const char *path, bool allowed)
{
    struct stat about;
    if (!allowed && lstat(path, &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0) {
        log_error("%s: %s exists already (%lld octets); choose another name, or --overwrite, which replaces it", command,
                  path, (long long)about.st_size);
        return STATUS_BAD_VALUE;
    }
    return check(command, path, OUTPUT_STREAM, "", true);
}

Status overwrite_video(const char *command, const Config *config, unsigned bands, const char *host_folder,
                       bool allowed)
{
    char            found[video_path_size];
    const char     *path = config->publish.video;
    const VideoKind kind = video_kind(path);
    if (!allowed && video_earlier(found, config, bands, host_folder)) {
        log_error("%s: %s exists already; choose another name with --video, or --overwrite, which replaces it", command,
                  found);
        return STATUS_BAD_VALUE;
    }
    return kind == VIDEO_NONE ? STATUS_OK : check(command, path, kind == VIDEO_FOLDER ? OUTPUT_FOLDER : 0, "--video", false);
}
