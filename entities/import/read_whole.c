/* entities/import/read_whole.c: reads a complete model file, plain or compressed by gzip. */
#include "entities/import/model_import_private.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <zlib.h>

Status import_read_whole(char **out, size_t *octets, const char *path, bool quiet)
{
    struct stat info;
    const char *why = NULL;
    gzFile file = NULL;
    char *text = NULL;
    size_t size = 0, capacity = 1 << 16;
    Status status = STATUS_IO;

    if (stat(path, &info) != 0)
        why = strerror(errno);
    else if (!S_ISREG(info.st_mode))
        why = "not a file";
    else if (!(file = gzopen(path, "rb")))
        why = strerror(errno);
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
