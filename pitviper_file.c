/* pitviper_file.c: files for reading: those from outside, opened by what they are and without waiting for what may
 * never come; temporary ones; and where the program's tables are. */

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
    case S_IFDIR:
        return "a directory";
    case S_IFIFO:
        return "a FIFO (named pipe)";
    case S_IFSOCK:
        return "a socket";
    case S_IFCHR:
        return "a character device";
    case S_IFBLK:
        return "a block device";
    default:
        return "of an unknown kind";
    }
}

/* Whether a name is that of a descriptor of this process, as a shell gives for `<(...)`. */
static bool is_own_descriptor(const char *path)
{
    return strncmp(path, "/dev/fd/", 8) == 0 || strncmp(path, "/proc/self/fd/", 14) == 0 ||
           strcmp(path, "/dev/stdin") == 0;
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

/* A name is looked at before it is opened, since opening alone does something to some devices; and again after, since
 * it may have become another file's name. */
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
    const int file = file_open(why, NULL, path, FILE_FROM_DISK);
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

/* Waits until there is something to read, or the last writer of a pipe has gone. A FIFO without a first writer is
 * waited for. False: a stop was requested. */
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

/* A FIFO whose writer has not come yet reads as if it had ended, so this waits until there is something to read. */
long file_read(int file, void *out, size_t octets)
{
    struct stat about;
    const bool  pipe = fstat(file, &about) == 0 && !S_ISREG(about.st_mode);
    size_t      got = 0;
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
    char  *text = malloc(capacity);
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
    *out = text;
    *octets = size;
    return STATUS_OK;
}

/* ---- temporary files and folders, in $TMPDIR or /tmp ---------------------------------------- */

static bool name_it(char out[temp_path_size], const char *ending)
{
    const char *folder = getenv("TMPDIR");
    if (!folder || !*folder) folder = "/tmp";
    if (snprintf(out, temp_path_size, "%s/pitviper-XXXXXX%s", folder, ending) < temp_path_size) return true;
    log_error("temporary: TMPDIR is longer than %d octets; set a shorter one", temp_path_size - 32);
    *out = 0;
    return false;
}

static bool made(char path[temp_path_size], bool ok)
{
    if (ok) return true;
    log_error("temporary: cannot make %s: %s; set TMPDIR to a folder that can be written", path, strerror(errno));
    *path = 0;
    return false;
}

bool temp_folder(char out[temp_path_size]) { return name_it(out, "") && made(out, mkdtemp(out) != NULL); }

bool temp_file(char out[temp_path_size], const char *ending)
{
    if (!name_it(out, ending)) return false;
    const int handle = mkstemps(out, (int)strlen(ending));
    if (handle >= 0) close(handle);
    return made(out, handle >= 0);
}

/* ---- the program's tables: the user's own first, then those of the program ------------------ */

/* The tables' folder of an installation that was moved, or made with another --prefix: BIN/../share/pitviper. Empty: it
 * is not known. */
static void share_beside_program(char *out, size_t out_size)
{
    const ssize_t length = readlink("/proc/self/exe", out, out_size - 1);
    out[length > 0 ? length : 0] = 0;
    for (int i = 0; i < 2; i++) { /* cuts off the program's name, then bin */
        char *slash = strrchr(out, '/');
        if (slash) *slash = 0;
    }
    const size_t n = strlen(out);
    if (snprintf(out + n, out_size - n, "/share/pitviper") >= (int)(out_size - n)) *out = 0;
}

static bool join(char *out, size_t out_size, const char *folder, const char *name)
{
    const size_t n = strlen(folder), m = strlen(name);
    if (n + 1 + m >= out_size) return false;
    memcpy(out, folder, n);
    out[n] = '/';
    memcpy(out + n + 1, name, m + 1);
    return true;
}

bool etc_path(char *out, size_t out_size, const char *name)
{
    char        beside[4096];
    const char *from_environment = getenv("PITVIPER_ETC");
    if (from_environment) return join(out, out_size, from_environment, name);
    share_beside_program(beside, sizeof beside);
    const char *const folders[] = {beside, PITVIPER_ETC_DIR, PITVIPER_ETC_INSTALLED};
    bool              fits = false;
    for (int i = 0; i < 3; i++) {
        fits = join(out, out_size, folders[i], name);
        if (fits && access(out, R_OK) == 0) break;
    }
    return fits;
}

bool etc_is_complete(void)
{
    static const char *const needed[] = {
        "catalog.csv", "materials.csv", "surfaces.csv", "ground_heat.csv", "ground_detail.csv",
        "heat.csv",    "effects.csv",   "sensors.csv",  "channels.csv",    "atmosphere/bands.csv"};
    char   path[4096], beside[4096], missing[256] = "";
    size_t n = 0;
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++)
        if (!etc_path(path, sizeof path, needed[i]) || access(path, R_OK) != 0)
            n += (size_t)snprintf(missing + n, sizeof missing - n, "%s%s", n ? ", " : "", needed[i]);
    if (n == 0) return true;
    const char *from_environment = getenv("PITVIPER_ETC");
    if (from_environment) {
        log_error("tables are missing in %s (PITVIPER_ETC): %s; name a folder that has them all, or unset PITVIPER_ETC",
                  from_environment, missing);
        return false;
    }
    share_beside_program(beside, sizeof beside);
    log_error("the program's tables are missing: %s; looked in %s, %s and %s", missing, beside, PITVIPER_ETC_DIR,
              PITVIPER_ETC_INSTALLED);
    log_error("next: install the whole (`cmake --install BUILD --prefix DIR`) and run DIR/bin/pitviper, or copy "
              "share/pitviper beside the program's folder, or set PITVIPER_ETC to the folder etc of the sources");
    return false;
}

/* The user's own tables. */

static struct Own {
    const char *name;
    char        path[4096];
} own[] = {{"catalog.csv", ""}, {"materials.csv", ""}, {"sensors.csv", ""}};

bool etc_own_set(const char *name, const char *path)
{
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (strcmp(own[i].name, name) == 0)
            return snprintf(own[i].path, sizeof own[i].path, "%s", path ? path : "") < (int)sizeof own[i].path;
    return false;
}

const char *etc_own(const char *name)
{
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (strcmp(own[i].name, name) == 0 && *own[i].path) return own[i].path;
    return NULL;
}
