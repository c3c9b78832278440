/* entities/import/reader_files.c: the files that a reader of models sees: the model's own and those of its folder. */
#include "entities/import/reader.h"

#include <stdarg.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/stat.h>

void reader_files(ReaderFiles *out, const char *path)
{
    *out = (ReaderFiles){.path = path};
    snprintf(out->shown, sizeof out->shown, "%s", path);
    const size_t length = strlen(out->shown);
    if (length > 3 && strcasecmp(out->shown + length - 3, ".gz") == 0) out->shown[length - 3] = 0;
    const char *slash = strrchr(out->shown, '/');
    out->folder = slash ? (size_t)(slash - out->shown) + 1 : 0;
}

/* The first name; a library asks for a file several times, and by more than one. */
static Status refuse(ReaderFiles *files, const char *name)
{
    if (!*files->refused) snprintf(files->refused, sizeof files->refused, "%s", name);
    return STATUS_IO;
}

Status reader_read(char **out, size_t *octets, ReaderFiles *files, const char *name)
{
    char packed[1100];
    struct stat there;
    const bool is_model = strcmp(name, files->shown) == 0;
    if (!is_model && (strncmp(name, files->shown, files->folder) != 0 || strstr(name + files->folder, "..") ||
                      name[files->folder] == '/'))
        return refuse(files, name);
    Status status = import_read_whole(out, octets, is_model ? files->path : name, true);
    snprintf(packed, sizeof packed, "%s.gz", name);
    if (status != STATUS_OK && status != STATUS_NO_MEMORY && !is_model)
        status = import_read_whole(out, octets, packed, true);
    files->no_memory = files->no_memory || status == STATUS_NO_MEMORY;
    if (status != STATUS_OK && stat(name, &there) == 0 && !S_ISREG(there.st_mode)) return refuse(files, name);
    return status;
}

Status reader_fails(ReaderSaid *said, Status status, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(said->error, sizeof said->error, format, list);
    va_end(list);
    return status;
}

void reader_warns(ReaderSaid *said, const char *format, ...)
{
    if (said->warnings == sizeof said->warning / sizeof *said->warning) return;
    va_list list;
    va_start(list, format);
    vsnprintf(said->warning[said->warnings++], sizeof *said->warning, format, list);
    va_end(list);
}
