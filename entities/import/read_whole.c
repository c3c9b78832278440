/* entities/import/read_whole.c: reads a complete model file, plain or compressed by gzip. */
#include "entities/import/model_import_private.h"

#include "pitviper_file.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>
#include <zlib.h>

Status import_read_whole(char **out, size_t *octets, const char *path, bool quiet)
{
    char refused[file_why_size];
    const char *why = NULL;
    const int file_at = file_open(refused, NULL, path, FILE_FROM_DISK);
    gzFile file = NULL;
    char *text = NULL;
    size_t size = 0, capacity = 1 << 16;
    Status status = STATUS_IO;

    if (file_at < 0)
        why = refused;
    else if (!(file = gzdopen(file_at, "rb"))) {
        why = strerror(errno);
        close(file_at);
    }
    while (!why) {
        char *larger = realloc(text, capacity + 1);
        if (!larger) {
            status = STATUS_NO_MEMORY;
            why = "no memory";
            break;
        }
        text = larger;
        const int got = gzread(file, text + size, (unsigned)(capacity - size));
        int code;
        if (got > 0) size += (size_t)got;
        gzerror(file, &code);
        if (got < 0 || (code != Z_OK && code != Z_STREAM_END)) {
            status = STATUS_BAD_VALUE;
            why = "the packed data are broken or cut short";
        } else if (size < capacity) {
            break;
        } else if (capacity >= import_max_octets) {
            status = STATUS_BAD_VALUE;
            why = "larger than 256 MiB";
        } else {
            capacity *= 2;
        }
    }
    if (file) gzclose(file);
    if (why) {
        if (!quiet) log_error("model: cannot read: file=%s: %s", path, why);
        free(text);
        return status;
    }
    text[size] = 0;
    *out = text;
    *octets = size;
    return STATUS_OK;
}
