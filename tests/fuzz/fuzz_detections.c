/* tests/fuzz/fuzz_detections.c: any octets as a datagram of detections. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/publish/memory/detections.h"

#include <stdlib.h>

const int fuzz_rounds = 200000;

enum { width = 64, height = 48, bands = 1 << BAND_LWIR | 1 << BAND_OPTICAL };

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const uint32_t counts[4] = {1, 0, 3, pitviper_detections_most};
    PitviperDetections    d = {.byte_order = PITVIPER_MEMORY_BYTE_ORDER,
                               .version = PITVIPER_DETECTIONS_VERSION,
                               .detection_size = sizeof(PitviperDetection),
                               .frame = (int32_t)index,
                               .band = index % 8 < 4 ? BAND_LWIR : BAND_OPTICAL,
                               .count = counts[index % 4]};
    memcpy(d.magic, PITVIPER_DETECTIONS_MAGIC, sizeof d.magic);
    for (uint32_t i = 0; i < d.count; i++)
        d.detection[i] = (PitviperDetection){.left = (float)i / 2,
                                             .top = 1,
                                             .right = width,
                                             .bottom = 2.5f,
                                             .score = 1,
                                             .track = i,
                                             .class_name = "tank"};
    if (index % 3 == 0) { /* of version 1: detections of 48 octets */
        d.version = 1, d.detection_size = 48;
        memcpy(out, &d, PITVIPER_DETECTIONS_SIZE(0));
        for (uint32_t i = 0; i < d.count; i++) memcpy(out + PITVIPER_DETECTIONS_SIZE(0) + 48 * i, &d.detection[i], 48);
        return PITVIPER_DETECTIONS_SIZE(0) + 48 * d.count;
    }
    memcpy(out, &d, PITVIPER_DETECTIONS_SIZE(d.count));
    return PITVIPER_DETECTIONS_SIZE(d.count);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    PitviperDetections     d;
    const DetectionsReason reason = detections_parse(&d, data, size, bands, width, height);
    if (!(reason >= DETECTIONS_GOOD && reason < DETECTIONS_FRAME) || !detections_reason_name[reason]) abort();
    if (reason != DETECTIONS_GOOD) return 0;
    /* what the metadata of a video builds on */
    if (size > PITVIPER_DETECTIONS_SIZE(d.count) || d.count > pitviper_detections_most) abort();
    if (d.version != PITVIPER_DETECTIONS_VERSION || d.detection_size != sizeof d.detection[0]) abort();
    if (!(bands >> d.band & 1)) abort();
    for (uint32_t i = 0; i < d.count; i++) {
        const PitviperDetection *one = &d.detection[i];
        if (!(one->left >= 0 && one->left < one->right && one->right <= width)) abort();
        if (!(one->top >= 0 && one->top < one->bottom && one->bottom <= height)) abort();
        if (!(one->score >= 0 && one->score <= 1) ||
            strnlen(one->class_name, sizeof one->class_name) == sizeof one->class_name)
            abort();
        for (const char *c = one->class_name; *c; c++)
            if (*c < 0x20 || *c > 0x7e) abort();
    }
    return 0;
}
