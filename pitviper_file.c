/* pitviper_file.c: opens files from outside: by what they are, without waiting for what may never come. */
#include "pitviper_file.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { look_ms = 100 }; /* how often a wait looks for a requested stop */

static bool (*stop_asked)(void);

void file_stop_when(bool (*asked)(void)) { stop_asked = asked; }
bool file_stop_asked(void) { return stop_asked && stop_asked(); }

static const char *kind_name(mode_t mode)
{
    switch (mode & S_IFMT) {
    case S_IFDIR: return "a directory";
    case S_IFIFO: return "a FIFO (named pipe)";
    case S_IFSOCK: return "a socket";
    case S_IFCHR: return "a character device";
    case S_IFBLK: return "a block device";
    default: return "of an unknown kind";
    }
}

/* A descriptor of this process by its name, as a shell gives it for `<(...)`. */
static bool is_own_descriptor(const char *path)
{
    return strncmp(path, "/dev/fd/", 8) == 0 || strncmp(path, "/proc/self/fd/", 14) == 0 || strcmp(path, "/dev/stdin") == 0;
}

static bool is_wanted(char why[file_why_size], const struct stat *about, const char *path, FileFrom from)
{
    if (S_ISREG(about->st_mode)) return true;
    if (S_ISFIFO(about->st_mode) && (from == FILE_FROM_PIPE || (from == FILE_FROM_SHELL && is_own_descriptor(path))))
        return true;
    snprintf(why, file_why_size, "it is %s, not a regular file", kind_name(about->st_mode));
    return false;
}

static int failed(char why[file_why_size])
{
    snprintf(why, file_why_size, "%s", strerror(errno));
    return -1;
}

/* Looked at before it is opened, since opening alone does something to some devices, and after, since a name may have
 * become another file's. */
int file_open(char why[file_why_size], uint64_t *octets, const char *path, FileFrom from)
{
    struct stat about;
    if (stat(path, &about) != 0) return failed(why);
    if (!is_wanted(why, &about, path, from)) return -1;
    const int file = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0) return failed(why);
    if (fstat(file, &about) != 0) {
        failed(why);
    } else if (is_wanted(why, &about, path, from)) {
        if (octets) *octets = S_ISREG(about.st_mode) ? (uint64_t)about.st_size : UINT64_MAX;
        return file;
    }
    close(file);
    return -1;
}

FILE *file_open_stream(char why[file_why_size], const char *path)
{
    const int file   = file_open(why, NULL, path, FILE_FROM_DISK);
    FILE     *stream = file >= 0 ? fdopen(file, "rb") : NULL;
    if (file >= 0 && !stream) {
        failed(why);
        close(file);
    }
    return stream;
}

bool file_is_regular(char why[file_why_size], const char *path)
{
    struct stat about;
    if (stat(path, &about) == 0 && (!S_ISREG(about.st_mode) || access(path, R_OK) == 0))
        return is_wanted(why, &about, path, FILE_FROM_DISK);
    failed(why);
    return false;
}

/* Until there is something to read, or the last writer of a pipe has gone. A FIFO without a first writer is waited for.
 * False: a stop was requested. */
static bool wait_for(int file)
{
    struct pollfd at = {.fd = file, .events = POLLIN};
    for (;;) {
        if (file_stop_asked()) {
            errno = ECANCELED;
            return false;
        }
        const int ready = poll(&at, 1, look_ms);
        if (ready > 0) return true;
        if (ready < 0 && errno != EINTR) return false;
    }
}

/* A FIFO whose writer has not come yet reads as if it had ended: what is to be read is waited for first. */
long file_read(int file, void *out, size_t octets)
{
    struct stat about;
    const bool  pipe = fstat(file, &about) == 0 && !S_ISREG(about.st_mode);
    size_t      got  = 0;
    while (got < octets) {
        if (pipe && !wait_for(file)) return -1;
        const ssize_t now = read(file, (char *)out + got, octets - got);
        if (now < 0 && (errno == EINTR || (pipe && errno == EAGAIN))) continue;
        if (now < 0) return -1;
        if (now == 0) break;
        got += (size_t)now;
    }
    return (long)got;
}

long file_read_at(int file, void *out, size_t octets, uint64_t at)
{
    size_t got = 0;
    while (got < octets) {
        const ssize_t now = pread(file, (char *)out + got, octets - got, (off_t)(at + got));
        if (now < 0 && errno == EINTR) continue;
        if (now < 0) return -1;
        if (now == 0) break;
        got += (size_t)now;
    }
    return (long)got;
}

Status file_read_whole(char **out, size_t *octets, const char *module, const char *path, size_t most, FileFrom from)
{
    char      why[file_why_size];
    size_t    size = 0, capacity = 1 << 16;
    const int file = file_open(why, NULL, path, from);
    if (file < 0) {
        log_error("%s: cannot open %s: %s", module, path, why);
        return STATUS_IO;
    }
    Status status = STATUS_OK;
    char  *text   = malloc(capacity);
    if (!text) status = STATUS_NO_MEMORY;
    while (status == STATUS_OK) {
        const long got = file_read(file, text + size, capacity - size - 1);
        if (got < 0) {
            log_error("%s: cannot read %s: %s", module, path, strerror(errno));
            status = STATUS_IO;
            break;
        }
        size += (size_t)got;
        if (size < capacity - 1 || size > most) break;
        char *larger = realloc(text, capacity *= 2);
        if (larger) text = larger;
        else status = STATUS_NO_MEMORY;
    }
    if (status == STATUS_OK && size > most) {
        log_error("%s: %s: larger than %zu octets", module, path, most);
        status = STATUS_BAD_VALUE;
    }
    close(file);
    if (status != STATUS_OK) {
        free(text);
        return status;
    }
    text[size] = 0;
    *out       = text;
    *octets    = size;
    return STATUS_OK;
}
