/* sensor/publish/video/video_file.c: a video's file, cut back to its last whole frame when a write fails. */
#include "sensor/publish/video/video_file.h"
#include "pitviper_output.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

enum { path_size = 4096 };

struct VideoFile {
    int     fd;
    int     error;     /* errno of the last failure */
    bool    dropping;  /* until the next mark */
    int64_t position, end, marked; /* of writes; of the file; at the last mark */
    char    path[path_size];
};

Status video_file_open(VideoFile **out, const char *path)
{
    VideoFile *f = calloc(1, sizeof *f);
    if (!f) return STATUS_NO_MEMORY;
    f->fd = snprintf(f->path, sizeof f->path, "%s", path) < (int)sizeof f->path
                ? output_open(path, 0) : (errno = ENAMETOOLONG, -1);
    if (f->fd < 0) {
        log_error("video: cannot write %s: %s; choose another name with --video", path, output_reason(errno));
        free(f);
        return STATUS_IO;
    }
    *out = f;
    return STATUS_OK;
}

static bool write_all(VideoFile *f, const uint8_t *bytes, size_t count)
{
    while (count > 0) {
        const ssize_t n = pwrite(f->fd, bytes, count, f->position);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
            f->error = n < 0 ? errno : ENOSPC;
            return false;
        }
        bytes += n;
        count -= (size_t)n;
        f->position += n;
        if (f->position > f->end) f->end = f->position;
    }
    return true;
}

bool video_file_write(VideoFile *f, const uint8_t *bytes, size_t count)
{
    if (f->dropping) return false;
    if (write_all(f, bytes, count)) return true;
    f->dropping = true;
    if (ftruncate(f->fd, f->marked) != 0) f->error = errno;
    f->position = f->end = f->marked;
    return false;
}

bool video_file_seek(VideoFile *f, int64_t position)
{
    if (position < 0 || position > f->end) return false;
    f->position = position;
    return true;
}

bool video_file_mark(VideoFile *f)
{
    const bool whole = !f->dropping;
    f->dropping      = false;
    f->marked        = f->end;
    return whole;
}

const char *video_file_error(const VideoFile *f) { return strerror(f->error); }
const char *video_file_path(const VideoFile *f) { return f->path; }

Status video_file_close(VideoFile *f)
{
    if (!f) return STATUS_OK;
    const bool good = close(f->fd) == 0;
    if (!good) log_error("video: cannot write %s: %s", f->path, strerror(errno));
    free(f);
    return good ? STATUS_OK : STATUS_IO;
}
