/* sensor/publish/memory/memory_ring.c: a ring of slots in shared memory, each protected by a sequence lock. */
#include "sensor/publish/memory/memory_ring.h"

#include "sensor/publish/memory/memory_segment.h"

#include <limits.h>
#include <linux/futex.h>

struct MemoryRing {
    MemorySegment         segment;
    PitviperMemoryHeader  layout;   /* as at the start: what is in the segment is read by others */
    PitviperMemoryHeader *header;   /* in the segment */
    PitviperMemoryPlane   plane[pitviper_memory_planes_most];
    size_t                plane_octets[pitviper_memory_planes_most];
    uint64_t              sequence; /* of the newest frame */
    PitviperMemoryRecord  record;
    PitviperMemoryTarget *target;   /* [target_room] */
};

/* Each word with release semantics: a reader that meets it meets the lock that was stored before it too
 * (pitviper_memory.h). Octets beyond the last whole word are filled up with zeros. */
static void store_words(unsigned char *to, const void *from, size_t octets)
{
    uint64_t            *word = (uint64_t *)(void *)to;
    const unsigned char *in   = from;
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
    *h = (PitviperMemoryHeader){.byte_order = PITVIPER_MEMORY_BYTE_ORDER, .version = PITVIPER_MEMORY_VERSION,
                                .revision = PITVIPER_MEMORY_REVISION, .header_size = sizeof *h,
                                .plane_entry_size = sizeof *r->plane, .record_size = sizeof r->record,
                                .target_size = sizeof *r->target, .slot_count = (uint32_t)of->slots,
                                .plane_count = (uint32_t)of->plane_count, .target_room = (uint32_t)of->target_room,
                                .kind = of->truth ? PITVIPER_MEMORY_TRUTH : PITVIPER_MEMORY_SENSOR,
                                .writer_pid = (int32_t)getpid(), .detections_port = (uint32_t)of->detections_port,
                                .detections_version = PITVIPER_DETECTIONS_VERSION,
                                .state = PITVIPER_MEMORY_RUNNING};
    memcpy(h->magic, PITVIPER_MEMORY_MAGIC, sizeof h->magic);
    snprintf(h->host, sizeof h->host, "%s", of->host ? of->host : "");
    snprintf(h->program, sizeof h->program, "%s", PITVIPER_VERSION);
    snprintf(h->config_sha256, sizeof h->config_sha256, "%s", of->config_sha256);
    h->plane_offset  = sizeof *h;
    h->slot_offset   = round_up(sizeof *h + (size_t)of->plane_count * sizeof *r->plane, line);
    h->target_offset = sizeof r->record;
    size_t at        = round_up(sizeof r->record + (size_t)of->target_room * sizeof *r->target, line);
    for (int i = 0; i < of->plane_count; i++) {
        r->plane[i]        = of->plane[i];
        r->plane[i].offset = at;
        r->plane_octets[i] = (size_t)r->plane[i].width * r->plane[i].height *
                             (r->plane[i].type == PITVIPER_PLANE_FLOAT32 ? sizeof(float) : sizeof(uint16_t));
        at += round_up(r->plane_octets[i], line);
    }
    h->slot_size    = at;
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
    header.epoch      = (uint64_t)now.tv_sec * 1000000000 + (uint64_t)now.tv_nsec;
    header.changed_ns = pitviper_memory_now_ns();
    r->target         = calloc((size_t)of->target_room + 1, sizeof *r->target);
    r->segment.file   = -1;
    Status status     = r->target ? memory_segment_create(&r->segment, of->name, header.segment_size)
                                  : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        r->layout  = header;
        r->header  = (PitviperMemoryHeader *)(void *)r->segment.at;
        *r->header = header;
        memcpy(r->segment.at + header.plane_offset, r->plane, (size_t)of->plane_count * sizeof *r->plane);
        status = memory_segment_publish(&r->segment);
    }
    if (status == STATUS_OK) *out = r;
    else memory_ring_close(r);
    return status;
}

bool                  memory_ring_is_named(const MemoryRing *r) { return memory_segment_is_named(&r->segment); }
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
    const PitviperMemoryHeader *h    = &r->layout;
    const uint64_t              n    = ++r->sequence;
    unsigned char              *slot = r->segment.at + h->slot_offset + (n - 1) % h->slot_count * h->slot_size;
    uint64_t                   *lock = (uint64_t *)(void *)slot;
    __atomic_store_n(lock, 2 * n - 1, __ATOMIC_RELAXED); /* before all that follows, each of which is a release */
    for (uint32_t i = 0; i < h->plane_count; i++) store_words(slot + r->plane[i].offset, plane[i], r->plane_octets[i]);
    store_words(slot + h->target_offset, r->target, r->record.target_count * sizeof *r->target);
    r->record.sequence   = n;
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
    memory_segment_close(&r->segment);
    free(r->target);
    free(r);
}
