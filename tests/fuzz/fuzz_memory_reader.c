/* tests/fuzz/fuzz_memory_reader.c: any octets as a ring of frames in shared memory, through the reader of the public
 * header. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include <pitviper_memory.h>

const int fuzz_rounds = 20000;

/* Two slots, two planes, a target: three frames have been written. index 1: without targets, from frame 2^40 on. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    enum { slots = 2, slot_octets = 512 + 576 + 64 + 64, slot_at = 512 };
    const uint64_t       newest = index % 2 ? 1ull << 40 : 3;
    PitviperMemoryHeader header = {.magic = "PVMEMOR",
                                   .byte_order = PITVIPER_MEMORY_BYTE_ORDER,
                                   .version = 1,
                                   .header_size = 320,
                                   .plane_entry_size = 96,
                                   .record_size = 512,
                                   .target_size = 576,
                                   .segment_size = slot_at + slots * slot_octets,
                                   .plane_offset = 320,
                                   .slot_offset = slot_at,
                                   .slot_size = slot_octets,
                                   .target_offset = 512,
                                   .slot_count = slots,
                                   .plane_count = 2,
                                   .target_room = index % 2 ? 0 : 1,
                                   .kind = 2,
                                   .host = "1:2:3",
                                   .newest = newest,
                                   .wake = 3,
                                   .state = PITVIPER_MEMORY_CLOSED};
    header.magic[7] = 'Y';
    const PitviperMemoryPlane plane[2] = {
        {.band = 2, .type = PITVIPER_PLANE_FLOAT32, .width = 4, .height = 4, .offset = 512 + 576, .band_name = "lwir"},
        {.band = 1, .type = PITVIPER_PLANE_UINT16, .width = 7, .height = 3, .offset = 512 + 576 + 64, .bits = 14}};
    memset(out, 0, header.segment_size);
    memcpy(out, &header, sizeof header);
    memcpy(out + 320, plane, sizeof plane);
    for (uint64_t n = newest - 1; n <= newest; n++) {
        PitviperMemoryRecord record = {.lock = 2 * n, .sequence = n, .target_count = header.target_room};
        memcpy(out + slot_at + (n - 1) % slots * slot_octets, &record, sizeof record);
    }
    return header.segment_size;
}

/* Every octet of what was taken is read: a sanitizer sees one that is not ours. */
static unsigned sum(const PitviperMemory *m)
{
    unsigned             total = (unsigned)strlen(m->record.host) + (unsigned)strlen(m->record.config_sha256);
    PitviperMemoryTarget target;
    for (uint32_t k = 0; k < m->header.plane_count; k++) {
        const PitviperMemoryPlane *p = &m->plane[k];
        const unsigned char       *octets = pitviper_memory_plane(m, k);
        const uint64_t             size = (uint64_t)p->width * p->height * (p->type == PITVIPER_PLANE_FLOAT32 ? 4 : 2);
        for (uint64_t i = 0; i < size; i++) total += octets[i];
    }
    for (uint32_t i = 0; i < m->record.target_count; i++) {
        if (!pitviper_memory_target(&target, m, i)) abort();
        total += (unsigned)strlen(target.class_name) + (unsigned)strlen(target.type) + (unsigned)strlen(target.marking);
    }
    if (pitviper_memory_plane(m, m->header.plane_count) || pitviper_memory_target(&target, m, m->record.target_count))
        abort();
    return total;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static volatile unsigned total;
    char                     path[fuzz_path_size];
    PitviperMemory           m;
    uint64_t                 sequence;
    const int                file = fuzz_file(path, data, size);
    if (file < 0 || pitviper_memory_open_file(&m, file) < 0) return 0;
    if (pitviper_memory_wait(&m, 0) > 1) abort();
    if (pitviper_memory_take_newest(&m) == 1) total = total + sum(&m);
    m.taken = 0;
    for (int i = 0; i < 4 && pitviper_memory_take_next(&m) == 1; i++) {
        if (m.record.sequence != m.taken || m.taken == 0) abort();
        total = total + sum(&m);
    }
    const unsigned char *slot = pitviper_memory_in_place(&m, &sequence);
    if (slot && !pitviper_memory_is_intact(slot, sequence)) abort();
    if (slot) total = total + slot[m.header.slot_size - 1];
    pitviper_memory_close(&m);
    return 0;
}
