/* sensor/node/overwrite.c: refuses to replace existing products unless --overwrite is given. */
#include "sensor/node/overwrite.h"

#include "sensor/publish/frame_files.h"
#include "sensor/publish/video/video_names.h"

#include <sys/stat.h>

Status overwrite_folder(const char *command, const char *out, bool allowed)
{
    char found[frame_path_size];
    if (allowed || !frame_files_earlier(found, out)) return STATUS_OK;
    log_error("%s: %s exists from an earlier run; choose another folder with --out, or --overwrite, which deletes the "
              "frames, "
              "truth.jsonl and run.json of that run", command, found);
    return STATUS_BAD_VALUE;
}

Status overwrite_file(const char *command, const char *path, bool allowed)
{
    struct stat about;
    if (allowed || stat(path, &about) != 0 || !S_ISREG(about.st_mode) || about.st_size == 0) return STATUS_OK;
    log_error("%s: %s exists already (%lld octets); choose another name, or --overwrite, which replaces "
              "it", command, path,
              (long long)about.st_size);
    return STATUS_BAD_VALUE;
}

Status overwrite_video(const char *command, const Config *config, unsigned bands, const char *host_folder,
                       bool allowed)
{
    char found[video_path_size];
    if (allowed || !video_earlier(found, config, bands, host_folder)) return STATUS_OK;
    log_error("%s: %s exists already; choose another name with --video, or --overwrite, which replaces it", command,
              found);
    return STATUS_BAD_VALUE;
}
