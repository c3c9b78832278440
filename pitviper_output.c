/* pitviper_output.c: opens files for writing, without following links; makes folders, and locks those of a run. */
#include "pitviper_output.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- locks ------------------------------------------------------------------------------------------ */

enum { lock_tries = 500 }; /* attempts, a millisecond apart */

/* Locks a file; returns false when another process writes it. A program that another thread is starting holds copies of
 * this process's descriptors until it is loaded, and with them the locks of files closed meanwhile, so this tries for a
 * while. */
static bool lock_file(int file)
{
    for (int k = 0; flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
         k++) { /* with other errors the file system has no locks */
        if (k == lock_tries) return false;
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    return true;
}

/* ---- folders that are held ------------------------------------------------------------------------ */

typedef struct Held {
    struct Held *next;
    int          folder;
    int          times;
    size_t       length;
    char         path[]; /* its path, without slashes at the end */
} Held;

static Held *held;

static size_t length_of(const char *folder)
{
    size_t length = strlen(folder);
    while (length > 1 && folder[length - 1] == '/') length--;
    return length;
}

static Held *find_held(const char *folder, size_t length)
{
    for (Held *h = held; h; h = h->next)
        if (h->length == length && memcmp(h->path, folder, length) == 0) return h;
    return NULL;
}

/* The innermost held folder that a path equals or is below. */
static const Held *held_above(const char *path)
{
    const Held *best = NULL;
    for (const Held *h = held; h; h = h->next)
        if (strncmp(path, h->path, h->length) == 0 && (path[h->length] == '/' || path[h->length] == 0) &&
            (!best || h->length > best->length))
            best = h;
    return best;
}

Status output_hold(const char *module, const char *folder)
{
    const size_t length = length_of(folder);
    Held        *h = find_held(folder, length);
    if (h) {
        h->times++;
        return STATUS_OK;
    }
    h = malloc(sizeof *h + length + 1);
    if (!h) return STATUS_NO_MEMORY;
    *h = (Held){.next = held, .times = 1, .length = length};
    memcpy(h->path, folder, length);
    h->path[length] = 0;
    h->folder = open(h->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const int error = h->folder < 0 ? errno : 0;
    if (!error && lock_file(h->folder)) {
        held = h;
        return STATUS_OK;
    }
    if (error) log_error("%s: cannot write in %s: %s", module, folder, strerror(error));
    else
        log_error("%s: another process is writing into %s; wait until it is done, or choose another folder", module,
                  folder);
    if (!error) close(h->folder);
    free(h);
    return STATUS_IO;
}

void output_release(const char *folder)
{
    Held *h = find_held(folder, length_of(folder));
    if (!h || --h->times > 0) return;
    Held **at = &held;
    while (*at != h) at = &(*at)->next;
    *at = h->next;
    close(h->folder);
    free(h);
}

/* ---- where a path leads ------------------------------------------------------------------------------ */

/* A name in an open folder. */
typedef struct Place {
    int         folder;
    bool        opened; /* the folder was opened here, and is to be closed */
    const char *name;   /* it contains a slash only where no held folder is above */
} Place;

static void leave(const Place *at)
{
    const int error = errno;
    if (at->opened) close(at->folder);
    errno = error;
}

static bool is_link(int folder, const char *name)
{
    struct stat about;
    return fstatat(folder, name, &about, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(about.st_mode);
}

/* Enters a folder of that name, which must not be a link. make: creates it where there is none. */
static bool enter(Place *at, const char *name, bool make)
{
    if (make && mkdirat(at->folder, name, 0777) != 0 && errno != EEXIST) return false;
    const int below = openat(at->folder, name, O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (below < 0) {
        if (errno == ENOTDIR && is_link(at->folder, name)) errno = ELOOP;
        return false;
    }
    leave(at);
    *at = (Place){.folder = below, .opened = true};
    return true;
}

/* Finds the folder of a path, and its last part. make: creates the folders between; whole: enters the last part as
 * well, and the name is then ".". */
static bool place_of(Place *at, const char *path, bool make, bool whole)
{
    const Held *above = held_above(path);
    *at = (Place){.folder = AT_FDCWD, .name = path};
    if (!above) return true;
    at->folder = above->folder;
    at->name = ".";
    for (const char *part = path + above->length; *(part += strspn(part, "/"));) {
        char         name[NAME_MAX + 1];
        const size_t length = strcspn(part, "/");
        const bool   last = part[length + strspn(part + length, "/")] == 0;
        if (last && !whole && part[length] == 0) {
            at->name = part;
            return true;
        }
        if (length > NAME_MAX) errno = ENAMETOOLONG;
        if (length <= NAME_MAX) {
            memcpy(name, part, length);
            name[length] = 0;
            if (strcmp(name, "..") == 0) errno = EINVAL;
            else if (enter(at, name, make)) {
                at->name = ".";
                part += length;
                continue;
            }
        }
        leave(at);
        return false;
    }
    return true;
}

/* ---- files -------------------------------------------------------------------------------------------- */

/* The open descriptor that a path is another name of, as /dev/stdout is of 1; -1: none. These names are links. */
static int descriptor_of(const char *path)
{
    static const char *const folder[] = {"/dev/fd/", "/proc/self/fd/"};
    long long                number;
    if (strcmp(path, "/dev/stdout") == 0) return STDOUT_FILENO;
    if (strcmp(path, "/dev/stderr") == 0) return STDERR_FILENO;
    for (int i = 0; i < 2; i++)
        if (strncmp(path, folder[i], strlen(folder[i])) == 0 && text_to_long(&number, path + strlen(folder[i])) &&
            number >= 0 && number <= INT_MAX)
            return (int)number;
    return -1;
}

static int fail(int file, int error)
{
    if (file >= 0) close(file);
    errno = error;
    return -1;
}

static bool same_file(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

static int open_at(const Place *at, unsigned how)
{
    const int flags = (how & OUTPUT_READ ? O_RDWR : O_WRONLY) | O_NOFOLLOW | O_CLOEXEC | O_NOCTTY;
    for (int again = 0; again < 16; again++) {
        struct stat about, there;
        int         file = openat(at->folder, at->name, flags | O_CREAT | O_NONBLOCK, 0666);
        if (file < 0 && errno == ENXIO) { /* a pipe without a reader yet, or a socket */
            if (!(how & OUTPUT_STREAM)) errno = EMEDIUMTYPE;
            else file = openat(at->folder, at->name, flags);
        }
        if (file < 0) return -1;
        if (fstat(file, &about) != 0) return fail(file, errno);
        if (!S_ISREG(about.st_mode)) {
            if (!(how & OUTPUT_STREAM)) return fail(file, EMEDIUMTYPE);
            fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK);
            return file;
        }
        if (!lock_file(file)) return fail(file, EBUSY);
        const bool found = fstatat(at->folder, at->name, &there, AT_SYMLINK_NOFOLLOW) == 0 && same_file(&about, &there);
        if (found) return how & OUTPUT_KEEP || ftruncate(file, 0) == 0 ? file : fail(file, errno);
        close(file); /* the file was renamed or removed before it was locked: opens what has the name now */
    }
    errno = EBUSY;
    return -1;
}

int output_open(const char *path, unsigned how)
{
    Place     at;
    const int standard = how & OUTPUT_STREAM ? descriptor_of(path) : -1;
    if (standard >= 0) return fcntl(standard, F_DUPFD_CLOEXEC, 3);
    if (!place_of(&at, path, false, false)) return -1;
    const int file = open_at(&at, how);
    leave(&at);
    return file;
}

FILE *output_file(const char *path, unsigned how)
{
    const int descriptor = output_open(path, how);
    FILE     *file = descriptor >= 0 ? fdopen(descriptor, how & OUTPUT_READ ? "w+" : "w") : NULL;
    if (!file && descriptor >= 0) fail(descriptor, errno);
    return file;
}

/* What is at a path. 0: nothing; 1: a regular file; 2: a stream; -1: something that cannot be written (errno). */
static int what_is_at(const char *path, unsigned how)
{
    Place       at;
    struct stat about;
    if (how & OUTPUT_STREAM && descriptor_of(path) >= 0) return 2;
    if (!place_of(&at, path, false, false)) return -1;
    int what = fstatat(at.folder, at.name, &about, AT_SYMLINK_NOFOLLOW) == 0 ? 1 : errno == ENOENT ? 0 : -1;
    if (what == 1 && S_ISLNK(about.st_mode)) what = fail(-1, ELOOP);
    else if (what == 1 && S_ISDIR(about.st_mode)) what = fail(-1, EISDIR);
    else if (what == 1 && !S_ISREG(about.st_mode)) what = how & OUTPUT_STREAM ? 2 : fail(-1, EMEDIUMTYPE);
    leave(&at);
    return what;
}

/* Whether a folder is there and files can be made in it. */
static int check_folder(const char *path)
{
    Place       at;
    struct stat about;
    if (!place_of(&at, path, false, true)) return -1;
    int result = fstatat(at.folder, at.name, &about, 0);
    if (result == 0 && !S_ISDIR(about.st_mode)) result = fail(-1, ENOTDIR);
    if (result == 0) result = faccessat(at.folder, at.name, W_OK | X_OK, AT_EACCESS);
    leave(&at);
    return result;
}

/* The folder that a path is in; for a bare name the current one. */
static bool folder_above(char above[PATH_MAX], const char *path)
{
    size_t length = length_of(path);
    while (length > 0 && path[length - 1] != '/') length--;
    while (length > 1 && path[length - 1] == '/') length--;
    if (length >= PATH_MAX) return fail(-1, ENAMETOOLONG) == 0;
    memcpy(above, length ? path : ".", length ? length : 1);
    above[length ? length : 1] = 0;
    return true;
}

int output_check(const char *path, unsigned how)
{
    char above[PATH_MAX];
    if (how & OUTPUT_FOLDER) {
        int result = check_folder(path);
        for (const char *part = path; result != 0 && errno == ENOENT; part = above) {
            char next[PATH_MAX];
            if (!folder_above(next, part)) return -1;
            strcpy(above, next);
            result = check_folder(above);
        }
        return result;
    }
    const int what = what_is_at(path, how);
    if (what != 0 && what != 1) return what < 0 ? -1 : 0;
    if (!folder_above(above, path)) return -1;
    return check_folder(above) == 0 || (what == 1 && faccessat(AT_FDCWD, path, W_OK, AT_EACCESS) == 0) ? 0 : -1;
}

static bool part_of(char part[PATH_MAX], const char *path)
{
    if (snprintf(part, PATH_MAX, "%s.part", path) < PATH_MAX) return true;
    errno = ENAMETOOLONG;
    return false;
}

FILE *output_begin(const char *path, unsigned how)
{
    char      part[PATH_MAX];
    const int what = what_is_at(path, how);
    if (what < 0 || !part_of(part, path)) return NULL;
    return output_file(what == 2 ? path : part, how);
}

/* Whether an open file is the PATH.part of output_begin, and not a stream. */
static bool is_part(FILE *file, const char *part)
{
    Place       at;
    struct stat about, there;
    if (fstat(fileno(file), &about) != 0 || !S_ISREG(about.st_mode) || !place_of(&at, part, false, false)) return false;
    const bool same = fstatat(at.folder, at.name, &there, AT_SYMLINK_NOFOLLOW) == 0 && same_file(&about, &there);
    leave(&at);
    return same;
}

bool output_end(FILE *file, const char *path)
{
    char       part[PATH_MAX];
    const bool named = part_of(part, path) && is_part(file, part);
    const int  locked = dup(fileno(file)); /* keeps the lock until the file is renamed: otherwise another writer would
                                              take what has PATH's name then */
    bool whole = !ferror(file);
    if (fclose(file) != 0) whole = false;
    if (named && whole) whole = output_rename(part, path) == 0;
    const int error = errno;
    if (named && !whole) output_remove(part);
    if (locked >= 0) close(locked);
    errno = error;
    return whole;
}

void output_abandon(FILE *file, const char *path)
{
    char part[PATH_MAX];
    if (part_of(part, path) && is_part(file, part)) output_remove(part);
    fclose(file);
}

const char *output_ending(const char *path)
{
    struct stat about;
    const char *slash = strrchr(path, '/'), *last = slash ? slash + 1 : path, *point = strrchr(last, '.');
    const bool  stream = descriptor_of(path) >= 0 || (lstat(path, &about) == 0 && !S_ISREG(about.st_mode) &&
                                                     !S_ISDIR(about.st_mode) && !S_ISLNK(about.st_mode));
    return point && point > last && !stream ? point : "";
}

/* ---- folders and names -------------------------------------------------------------------------------- */

int output_folder(const char *path)
{
    char        part[PATH_MAX];
    Place       at;
    struct stat about;
    if (held_above(path)) {
        if (!place_of(&at, path, true, true)) return -1;
        const int writable = faccessat(at.folder, ".", W_OK | X_OK, AT_EACCESS);
        leave(&at);
        return writable;
    }
    if (snprintf(part, sizeof part, "%s", path) >= (int)sizeof part) return fail(-1, ENAMETOOLONG);
    for (char *end = part + 1; *part; end++) {
        if (*end != '/' && *end) continue;
        const char kept = *end;
        *end = 0;
        if (mkdir(part, 0777) != 0 && errno != EEXIST && !(kept && stat(part, &about) == 0)) return -1;
        *end = kept;
        if (!kept) break;
    }
    if (stat(path, &about) != 0) return -1;
    if (!S_ISDIR(about.st_mode)) return fail(-1, ENOTDIR);
    return faccessat(AT_FDCWD, path, W_OK | X_OK, AT_EACCESS);
}

int output_rename(const char *from, const char *to)
{
    Place a, b;
    if (!place_of(&a, from, false, false)) return -1;
    int result = -1;
    if (place_of(&b, to, false, false)) {
        result = renameat(a.folder, a.name, b.folder, b.name);
        leave(&b);
    }
    leave(&a);
    return result;
}

int output_remove(const char *path)
{
    Place at;
    if (!place_of(&at, path, false, false)) return -1;
    int result = unlinkat(at.folder, at.name, 0);
    if (result != 0 && (errno == EISDIR || errno == EPERM)) result = unlinkat(at.folder, at.name, AT_REMOVEDIR);
    leave(&at);
    return result;
}

bool output_remove_left(const char *path)
{
    static const time_t no_locks_s = 3600; /* on a file system that has none, no writer takes so long */
    Place               at;
    struct stat         about;
    if (!place_of(&at, path, false, false)) return false;
    bool      gone = fstatat(at.folder, at.name, &about, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(about.st_mode);
    const int file = gone ? openat(at.folder, at.name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC) : -1;
    bool      left = file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0;
    if (file >= 0 && !left && errno != EWOULDBLOCK) left = time(NULL) - about.st_mtime > no_locks_s;
    gone = left && unlinkat(at.folder, at.name, 0) == 0;
    if (file >= 0) close(file);
    leave(&at);
    return gone;
}

DIR *output_list(const char *path)
{
    Place at;
    if (!place_of(&at, path, false, true)) return NULL;
    const int folder = openat(at.folder, at.name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    leave(&at);
    DIR *list = folder >= 0 ? fdopendir(folder) : NULL;
    if (!list && folder >= 0) fail(folder, errno);
    return list;
}

const char *output_reason(int error)
{
    switch (error) {
    case ELOOP:
        return "it is, or lies below, a symbolic link, and none is followed where files are written; name its target, or "
               "remove the link";
    case EBUSY:
        return "another process is writing it";
    case EMEDIUMTYPE:
        return "it is a pipe, a socket or a device, not a file";
    default:
        return strerror(error);
    }
}
