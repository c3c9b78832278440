/* sensor/publish/memory/memory_ring.c: the ring of frames in /dev/shm: slots, each protected by a sequence lock, in a
 * file that is made whole before it has its name, with all its memory reserved, locked for as long as this process
 * lives, and removed at the end.
 *
 * A name in use by a living process is refused; one that a killed process left behind is replaced. */
#include "sensor/publish/memory/memory_ring_private.h"

#include <sys/types.h>
#include <errno.h>
#include <fcntl.h>
#include <pitviper_memory.h>
#include <limits.h>
#include <linux/futex.h>

/* ---- the segment: a file of shared memory that appears under its name as a whole ----------------- */

enum { segment_name_size = 128 };

typedef struct MemorySegment {
    char           name[segment_name_size]; /* under /dev/shm */
    char           temporary[segment_name_size + 40];
    int            file; /* -1: none */
    unsigned char *at;   /* zeroed; page aligned */
    size_t         size;
    bool           named; /* published under its name */
} MemorySegment;

enum { path_size = 256 };

static void path_of(char out[path_size], const char *name) { snprintf(out, path_size, "/dev/shm/%s", name); }

/* Takes a lock of the open file: it ends with the process, however that ends, and readers ask for it without taking
 * one. */
static bool lock_file(int file)
{
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    return fcntl(file, F_OFD_SETLK, &lock) == 0;
}

static Status not_created(const MemorySegment *s, const char *what, int reason)
{
    if (reason == ENOSPC || reason == EFBIG || reason == ENOMEM)
        log_error("memory: no room for %.1f MB in /dev/shm: %s; make room there, or set fewer publish.memory_slots, "
                  "fewer bands or a smaller image",
                  1e-6 * (double)s->size, strerror(reason));
    else
        log_error("memory: cannot %s /dev/shm/%s: %s; publish.memory needs a writable /dev/shm", what, s->name,
                  strerror(reason));
    return STATUS_IO;
}

/* Whether the name is this segment's still: nothing keeps others from removing or replacing it. */
static bool segment_is_named(const MemorySegment *s)
{
    struct stat own, there;
    char        path[path_size];
    path_of(path, s->name);
    return s->named && fstat(s->file, &own) == 0 && lstat(path, &there) == 0 && own.st_ino == there.st_ino &&
           own.st_dev == there.st_dev;
}

/* Removes the name, if it still is this segment's, and the mapping; readers keep theirs. */
static void segment_close(MemorySegment *s)
{
    char path[path_size];
    path_of(path, s->name);
    if (segment_is_named(s)) unlink(path);
    if (!s->named && s->file >= 0) shm_unlink(s->temporary);
    if (s->at) munmap(s->at, s->size);
    if (s->file >= 0) close(s->file);
    *s = (MemorySegment){.file = -1};
}

/* Zeroed memory that has no name yet. STATUS_IO, logged with what to do: no room, no permission. */
static Status segment_create(MemorySegment *out, const char *name, size_t size)
{
    MemorySegment *s = out;
    *s = (MemorySegment){.file = -1, .size = size};
    snprintf(s->name, sizeof s->name, "%s", name);
    snprintf(s->temporary, sizeof s->temporary, ".pitviper-%s-%d", name, (int)getpid());
    shm_unlink(s->temporary); /* of a killed process with the same number */
    s->file = shm_open(s->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (s->file < 0 && errno == EEXIST) {
        log_error(
            "memory: /dev/shm/%s is there and belongs to another user; have it removed, or choose another name with --memory",
            s->temporary);
        return STATUS_IO;
    }
    if (s->file < 0) return not_created(s, "create", errno);
    /* all of it now: a page that cannot be had later would end the process (SIGBUS); and mapped now, not in a frame */
    const int reserved = posix_fallocate(s->file, 0, (off_t)size);
    Status    status = reserved == 0 ? STATUS_OK : not_created(s, "reserve", reserved);
    if (status == STATUS_OK && !lock_file(s->file)) status = not_created(s, "lock", errno);
    if (status == STATUS_OK) {
        void *at = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, s->file, 0);
        if (at == MAP_FAILED) status = not_created(s, "map", errno);
        else s->at = at;
    }
    if (status != STATUS_OK) segment_close(s);
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
    int         pid = 0;
    Replaced    result = REPLACED_REFUSED;
    const int   old = open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
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
                  "node",
                  s->name, pid);
    else if (stat(path, &there) != 0 || there.st_ino != opened.st_ino || there.st_dev != opened.st_dev)
        result = REPLACED_NOT_THERE;
    else if (rename(temporary, path) == 0) result = REPLACED;
    else log_error("memory: cannot replace %s: %s; choose another name with --memory", path, strerror(errno));
    close(old);
    if (result == REPLACED) log_info("memory: replaced '%s', left behind by process %d, which has ended", s->name, pid);
    return result;
}

/* Gives it its name. STATUS_BAD_VALUE, logged: the name is in use. */
static Status segment_publish(MemorySegment *s)
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

/* ---- the ring ------------------------------------------------------------------------------------ */

struct MemoryRing {
    MemorySegment         segment;
    PitviperMemoryHeader  layout; /* as at the start: what is in the segment is read by others */
    PitviperMemoryHeader *header; /* in the segment */
    PitviperMemoryPlane   plane[pitviper_memory_planes_most];
    size_t                plane_octets[pitviper_memory_planes_most];
    uint64_t              sequence; /* of the newest frame */
    PitviperMemoryRecord  record;
    PitviperMemoryTarget *target; /* [target_room] */
};

/* Each word with release semantics: a reader that meets it meets the lock that was stored before it too
 * (pitviper_memory.h). Octets beyond the last whole word are filled up with zeros. */
static void store_words(unsigned char *to, const void *from, size_t octets)
{
    uint64_t            *word = (uint64_t *)(void *)to;
    const unsigned char *in = from;
    const size_t         whole = octets / 8;
    for (size_t i = 0; i < whole; i++) {
        uint64_t value;
        memcpy(&value, in + 8 * i, 8);
        __atomic_store_n(&word[i], value, __ATOMIC_RELEASE);
    }
    if (octets % 8) {
        uint64_t value = 0;
        memcpy(&value, in + 8 * whole, octets % 8);
        __atomic_store_n(&word[whole], value, __ATOMIC_RELEASE);
    }
}

static size_t round_up(size_t octets, size_t to) { return (octets + to - 1) / to * to; }

/* Sizes and offsets; each plane begins on a cache line. */
static void lay_out(PitviperMemoryHeader *h, MemoryRing *r, const MemoryRingOf *of)
{
    enum { line = 64 };
    *h = (PitviperMemoryHeader){.byte_order = PITVIPER_MEMORY_BYTE_ORDER,
                                .version = PITVIPER_MEMORY_VERSION,
                                .revision = PITVIPER_MEMORY_REVISION,
                                .header_size = sizeof *h,
                                .plane_entry_size = sizeof *r->plane,
                                .record_size = sizeof r->record,
                                .target_size = sizeof *r->target,
                                .slot_count = (uint32_t)of->slots,
                                .plane_count = (uint32_t)of->plane_count,
                                .target_room = (uint32_t)of->target_room,
                                .kind = of->truth ? PITVIPER_MEMORY_TRUTH : PITVIPER_MEMORY_SENSOR,
                                .writer_pid = (int32_t)getpid(),
                                .detections_port = (uint32_t)of->detections_port,
                                .detections_version = PITVIPER_DETECTIONS_VERSION,
                                .state = PITVIPER_MEMORY_RUNNING};
    memcpy(h->magic, PITVIPER_MEMORY_MAGIC, sizeof h->magic);
    snprintf(h->host, sizeof h->host, "%s", of->host ? of->host : "");
    snprintf(h->program, sizeof h->program, "%s", PITVIPER_VERSION);
    snprintf(h->config_sha256, sizeof h->config_sha256, "%s", of->config_sha256);
    h->plane_offset = sizeof *h;
    h->slot_offset = round_up(sizeof *h + (size_t)of->plane_count * sizeof *r->plane, line);
    h->target_offset = sizeof r->record;
    size_t at = round_up(sizeof r->record + (size_t)of->target_room * sizeof *r->target, line);
    for (int i = 0; i < of->plane_count; i++) {
        r->plane[i] = of->plane[i];
        r->plane[i].offset = at;
        r->plane_octets[i] = (size_t)r->plane[i].width * r->plane[i].height *
                             (r->plane[i].type == PITVIPER_PLANE_FLOAT32 ? sizeof(float) : sizeof(uint16_t));
        at += round_up(r->plane_octets[i], line);
    }
    h->slot_size = at;
    h->segment_size = h->slot_offset + at * (size_t)of->slots;
}

Status memory_ring_create(MemoryRing **out, const MemoryRingOf *of)
{
    PitviperMemoryHeader header;
    struct timespec      now;
    MemoryRing          *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    lay_out(&header, r, of);
    clock_gettime(CLOCK_REALTIME, &now);
    header.epoch = (uint64_t)now.tv_sec * 1000000000 + (uint64_t)now.tv_nsec;
    header.changed_ns = pitviper_memory_now_ns();
    r->target = calloc((size_t)of->target_room + 1, sizeof *r->target);
    r->segment.file = -1;
    Status status = r->target ? segment_create(&r->segment, of->name, header.segment_size) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        r->layout = header;
        r->header = (PitviperMemoryHeader *)(void *)r->segment.at;
        *r->header = header;
        memcpy(r->segment.at + header.plane_offset, r->plane, (size_t)of->plane_count * sizeof *r->plane);
        status = segment_publish(&r->segment);
    }
    if (status == STATUS_OK) *out = r;
    else memory_ring_close(r);
    return status;
}

bool                  memory_ring_is_named(const MemoryRing *r) { return segment_is_named(&r->segment); }
size_t                memory_ring_size(const MemoryRing *r) { return r->segment.size; }
PitviperMemoryRecord *memory_ring_record(MemoryRing *r) { return &r->record; }
PitviperMemoryTarget *memory_ring_targets(MemoryRing *r) { return r->target; }

/* Readers cannot say that they wait: they may not write. With none the call costs less than a microsecond. */
static void wake_readers(PitviperMemoryHeader *h)
{
    __atomic_store_n(&h->changed_ns, pitviper_memory_now_ns(), __ATOMIC_RELAXED);
    __atomic_add_fetch(&h->wake, 1, __ATOMIC_RELEASE);
    syscall(SYS_futex, &h->wake, FUTEX_WAKE, INT_MAX, NULL, NULL, 0);
}

void memory_ring_put(MemoryRing *r, const void *const *plane)
{
    const PitviperMemoryHeader *h = &r->layout;
    const uint64_t              n = ++r->sequence;
    unsigned char              *slot = r->segment.at + h->slot_offset + (n - 1) % h->slot_count * h->slot_size;
    uint64_t                   *lock = (uint64_t *)(void *)slot;
    __atomic_store_n(lock, 2 * n - 1, __ATOMIC_RELAXED); /* before all that follows, each of which is a release */
    for (uint32_t i = 0; i < h->plane_count; i++) store_words(slot + r->plane[i].offset, plane[i], r->plane_octets[i]);
    store_words(slot + h->target_offset, r->target, r->record.target_count * sizeof *r->target);
    r->record.sequence = n;
    r->record.written_ns = pitviper_memory_now_ns();
    store_words(slot + sizeof *lock, (const unsigned char *)&r->record + sizeof *lock, sizeof r->record - sizeof *lock);
    __atomic_store_n(lock, 2 * n, __ATOMIC_RELEASE);
    __atomic_store_n(&r->header->newest, n, __ATOMIC_RELEASE);
    wake_readers(r->header);
}

void memory_ring_close(MemoryRing *r)
{
    if (!r) return;
    if (r->header) {
        __atomic_store_n(&r->header->state, PITVIPER_MEMORY_CLOSED, __ATOMIC_RELEASE);
        wake_readers(r->header);
    }
    segment_close(&r->segment);
    free(r->target);
    free(r);
}
