/* sensor/publish/memory/memory_segment.c: a file of shared memory that appears under its name as a whole. */
#include "sensor/publish/memory/memory_segment.h"

#include <errno.h>
#include <fcntl.h>
#include <pitviper_memory.h>

enum { path_size = 256 };

static void path_of(char out[path_size], const char *name) { snprintf(out, path_size, "/dev/shm/%s", name); }

/* A lock of the open file: it ends with the process, however that ends, and readers ask for it without taking one. */
static bool lock_file(int file)
{
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    return fcntl(file, F_OFD_SETLK, &lock) == 0;
}

static Status not_created(const MemorySegment *s, const char *what, int reason)
{
    if (reason == ENOSPC || reason == EFBIG || reason == ENOMEM)
        log_error("memory: no room for %.1f MB in /dev/shm: %s; make room there, or set fewer publish.memory_slots, "
                  "fewer bands or a smaller image", 1e-6 * (double)s->size, strerror(reason));
    else
        log_error("memory: cannot %s /dev/shm/%s: %s; publish.memory needs a writable /dev/shm", what, s->name,
                  strerror(reason));
    return STATUS_IO;
}

Status memory_segment_create(MemorySegment *out, const char *name, size_t size)
{
    MemorySegment *s = out;
    *s = (MemorySegment){.file = -1, .size = size};
    snprintf(s->name, sizeof s->name, "%s", name);
    snprintf(s->temporary, sizeof s->temporary, ".pitviper-%s-%d", name, (int)getpid());
    shm_unlink(s->temporary); /* of a killed process with the same number */
    s->file = shm_open(s->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (s->file < 0 && errno == EEXIST) {
        log_error("memory: /dev/shm/%s is there and belongs to another user; have it removed, or choose another name with --memory",
                  s->temporary);
        return STATUS_IO;
    }
    if (s->file < 0) return not_created(s, "create", errno);
    /* all of it now: a page that cannot be had later would end the process (SIGBUS); and mapped now, not in a frame */
    const int reserved = posix_fallocate(s->file, 0, (off_t)size);
    Status    status   = reserved == 0 ? STATUS_OK : not_created(s, "reserve", reserved);
    if (status == STATUS_OK && !lock_file(s->file)) status = not_created(s, "lock", errno);
    if (status == STATUS_OK) {
        void *at = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, s->file, 0);
        if (at == MAP_FAILED) status = not_created(s, "map", errno);
        else s->at = at;
    }
    if (status != STATUS_OK) memory_segment_close(s);
    return status;
}

/* Whether a file is a ring of frames; its writer's process. */
static bool is_ring(int *pid, int file)
{
    PitviperMemoryHeader header;
    if (pread(file, &header, sizeof header, 0) != (ssize_t)sizeof header) return false;
    *pid = header.writer_pid;
    return memcmp(header.magic, PITVIPER_MEMORY_MAGIC, sizeof header.magic) == 0;
}

typedef enum Replaced { REPLACED, REPLACED_NOT_THERE, REPLACED_REFUSED } Replaced;

/* Puts the new segment in the place of one whose writer has died. The old one's lock is held meanwhile: of several
 * nodes that start at the same time one alone replaces it. */
static Replaced replace(const MemorySegment *s, const char *temporary, const char *path)
{
    struct stat opened, there;
    int         pid    = 0;
    Replaced    result = REPLACED_REFUSED;
    const int   old    = open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (old < 0 && errno == ENOENT) return REPLACED_NOT_THERE;
    if (old < 0) {
        log_error("memory: %s is there and cannot be opened: %s; choose another name with --memory, or remove it", path,
                  errno == ELOOP ? "it is a symbolic link" : strerror(errno));
        return REPLACED_REFUSED;
    }
    if (fstat(old, &opened) != 0 || !S_ISREG(opened.st_mode) || !is_ring(&pid, old))
        log_error("memory: %s is not a ring of frames; choose another name with --memory, or remove it", path);
    else if (!lock_file(old))
        log_error("memory: '%s' is in use by a living node, process %d; choose another name with --memory, or end that "
                  "node", s->name, pid);
    else if (stat(path, &there) != 0 || there.st_ino != opened.st_ino || there.st_dev != opened.st_dev)
        result = REPLACED_NOT_THERE;
    else if (rename(temporary, path) == 0)
        result = REPLACED;
    else
        log_error("memory: cannot replace %s: %s; choose another name with --memory", path, strerror(errno));
    close(old);
    if (result == REPLACED) log_info("memory: replaced '%s', left behind by process %d, which has ended", s->name, pid);
    return result;
}

Status memory_segment_publish(MemorySegment *s)
{
    enum { tries = 100 };
    char temporary[path_size], path[path_size];
    path_of(temporary, s->temporary);
    path_of(path, s->name);
    for (int i = 0; i < tries && !s->named; i++) {
        if (link(temporary, path) == 0) { /* unlike rename it never replaces */
            unlink(temporary);
            s->named = true;
        } else if (errno != EEXIST) {
            return not_created(s, "name", errno);
        } else {
            const Replaced replaced = replace(s, temporary, path);
            if (replaced == REPLACED_REFUSED) return STATUS_BAD_VALUE;
            s->named = replaced == REPLACED;
        }
    }
    if (!s->named) log_error("memory: the name '%s' comes and goes; choose another one with --memory", s->name);
    return s->named ? STATUS_OK : STATUS_BAD_VALUE;
}

bool memory_segment_is_named(const MemorySegment *s)
{
    struct stat own, there;
    char        path[path_size];
    path_of(path, s->name);
    return s->named && fstat(s->file, &own) == 0 && lstat(path, &there) == 0 && own.st_ino == there.st_ino &&
           own.st_dev == there.st_dev;
}

void memory_segment_close(MemorySegment *s)
{
    char path[path_size];
    path_of(path, s->name);
    if (memory_segment_is_named(s)) unlink(path);
    if (!s->named && s->file >= 0) shm_unlink(s->temporary);
    if (s->at) munmap(s->at, s->size);
    if (s->file >= 0) close(s->file);
    *s = (MemorySegment){.file = -1};
}
