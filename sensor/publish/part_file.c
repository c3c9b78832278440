/* sensor/publish/part_file.c: PATH.part, which takes the name PATH when it is whole. */
#include "sensor/publish/part_file.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

static void fail(PartFile *f, int reason)
{
    if (f->status != STATUS_OK) return;
    f->status = STATUS_IO;
    log_error("image: cannot write %s: %s", f->path, reason ? strerror(reason) : "short write");
}

Status part_file_open(PartFile *f, const char *path)
{
    *f = (PartFile){.path = path};
    const size_t size = strlen(path) + sizeof ".part";
    f->part           = malloc(size);
    if (!f->part) return f->status = STATUS_NO_MEMORY;
    snprintf(f->part, size, "%s.part", path);
    errno   = 0;
    f->file = fopen(f->part, "wb");
    if (!f->file && errno == ENOMEM) f->status = STATUS_NO_MEMORY;
    else if (!f->file) fail(f, errno);
    return f->status;
}

void part_file_write(PartFile *f, const void *bytes, size_t count)
{
    if (f->status != STATUS_OK) return;
    errno = 0;
    if (fwrite(bytes, 1, count, f->file) != count) fail(f, errno);
}

void part_file_rewrite(PartFile *f, long at, const void *bytes, size_t count)
{
    if (f->status != STATUS_OK) return;
    errno = 0;
    if (fseek(f->file, at, SEEK_SET) != 0 || fwrite(bytes, 1, count, f->file) != count) fail(f, errno);
}

void part_file_fail(PartFile *f, Status status)
{
    if (f->status == STATUS_OK) f->status = status;
}

Status part_file_close(PartFile *f)
{
    errno = 0;
    if (f->file && fclose(f->file) != 0) fail(f, errno); /* a full disk may show only here */
    errno = 0;
    if (f->status == STATUS_OK && rename(f->part, f->path) != 0) fail(f, errno);
    if (f->file && f->status != STATUS_OK) unlink(f->part);
    free(f->part);
    return f->status;
}
