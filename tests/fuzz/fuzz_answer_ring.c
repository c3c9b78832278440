/* tests/fuzz/fuzz_answer_ring.c: any octets as an answer, from datagrams of PitviperDetections. Without a fuzzer
 * run_corpus.c drives it. */
#include "tests/fuzz/fuzz_answer.h"

#include <pitviper_memory.h>

const int fuzz_rounds = 200000;

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const uint32_t counts[4] = {1, 0, 3, pitviper_detections_most};
    static const size_t   octets[3] = {48, 64, sizeof(PitviperDetection)}, class_octets[3] = {16, 32, 32};
    const int             version = (int)(index % 3);
    const size_t          each = octets[version], head = PITVIPER_DETECTIONS_SIZE(0);
    PitviperDetections    d = {.byte_order = PITVIPER_MEMORY_BYTE_ORDER,
                               .version = (uint16_t)(version + 1),
                               .detection_size = (uint16_t)each,
                               .frame = (int32_t)index,
                               .band = index % 8 < 4 ? BAND_LWIR : BAND_OPTICAL,
                               .count = counts[index % 4]};
    memcpy(d.magic, PITVIPER_DETECTIONS_MAGIC, sizeof d.magic);
    memcpy(out, &d, head);
    for (uint32_t i = 0; i < d.count; i++) {
        PitviperDetection one = {
            .left = (float)i / 2, .top = 1, .right = 64, .bottom = 2.5f, .score = 1, .track = i, .class_name = "tank"};
        if (index % 2)
            one.los_az_rad = 3, one.los_el_rad = -0.1f, one.flags = PITVIPER_DETECTION_SIGHT, one.range_m = 99;
        uint8_t *at = out + head + i * each;
        memset(at, 0, each);
        memcpy(at, &one, version == 2 ? sizeof one : 24 + class_octets[version]);
    }
    return head + d.count * each;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_answer(data, size);
    return 0;
}
