/* sensor/publish/memory/detections_parse.c: checks a datagram of detections. */
#include "sensor/publish/memory/detections.h"

const char *const detections_reason_name[DETECTIONS_REASONS] = {
    "good", "size", "magic", "byte_order", "version", "count", "band", "box", "score", "text", "reserved_octets",
    "unknown_frame", "late", "repeated"};

/* Printable ASCII up to the first 0, then zeros to the end. */
static bool text_is_good(const char *text, size_t size)
{
    size_t n = 0;
    while (n < size && text[n] >= 0x20 && text[n] <= 0x7e) n++;
    if (n == size) return false;
    for (; n < size; n++)
        if (text[n]) return false;
    return true;
}

static DetectionsReason check_one(const PitviperDetection *d, float width, float height)
{
    if (!(d->left >= 0 && d->right > d->left && d->right <= width && d->top >= 0 && d->bottom > d->top &&
          d->bottom <= height)) return DETECTIONS_BOX; /* NaN too */
    if (!(d->score >= 0 && d->score <= 1)) return DETECTIONS_SCORE;
    if (!text_is_good(d->class_name, sizeof d->class_name)) return DETECTIONS_TEXT;
    return d->reserved[0] || d->reserved[1] ? DETECTIONS_RESERVED : DETECTIONS_GOOD;
}

/* A detection of version 1: its class is shorter. */
typedef struct DetectionOf1 {
    float    left, top, right, bottom, score;
    uint32_t track;
    char     class_name[16];
    uint32_t reserved[2];
} DetectionOf1;
_Static_assert(sizeof(DetectionOf1) == 48, "as version 1 was laid out");

/* The class needs its 0 within its own room, whatever follows it here. */
static bool from_1(PitviperDetection *out, const uint8_t *bytes)
{
    DetectionOf1 d;
    memcpy(&d, bytes, sizeof d);
    *out = (PitviperDetection){.left = d.left, .top = d.top, .right = d.right, .bottom = d.bottom, .score = d.score,
                               .track = d.track, .reserved = {d.reserved[0], d.reserved[1]}};
    memcpy(out->class_name, d.class_name, sizeof d.class_name);
    return d.class_name[sizeof d.class_name - 1] == 0;
}

DetectionsReason detections_parse(PitviperDetections *out, const uint8_t *bytes, size_t size, unsigned bands, int width,
                                  int height)
{
    const size_t head = PITVIPER_DETECTIONS_SIZE(0);
    if (size < head || size > sizeof *out) return DETECTIONS_SIZE;
    memset(out, 0, sizeof *out);
    memcpy(out, bytes, head);
    if (memcmp(out->magic, PITVIPER_DETECTIONS_MAGIC, sizeof out->magic) != 0) return DETECTIONS_MAGIC;
    if (out->byte_order != PITVIPER_MEMORY_BYTE_ORDER) return DETECTIONS_ORDER;
    const size_t each = out->version == 1 ? sizeof(DetectionOf1) : sizeof *out->detection;
    if (out->version < 1 || out->version > PITVIPER_DETECTIONS_VERSION || out->detection_size != each)
        return DETECTIONS_VERSION;
    if (out->count > pitviper_detections_most) return DETECTIONS_COUNT;
    if (size != head + out->count * each) return DETECTIONS_SIZE;
    if (out->band >= BAND_COUNT || !(bands >> out->band & 1)) return DETECTIONS_BAND;
    if (out->reserved) return DETECTIONS_RESERVED;
    for (uint32_t i = 0; i < out->count; i++) {
        const uint8_t *from = bytes + head + i * each;
        bool           terminated = true;
        if (out->version == 1) terminated = from_1(&out->detection[i], from);
        else memcpy(&out->detection[i], from, each);
        const DetectionsReason reason = check_one(&out->detection[i], (float)width, (float)height);
        if (reason != DETECTIONS_GOOD) return reason;
        if (!terminated) return DETECTIONS_TEXT;
    }
    out->version        = PITVIPER_DETECTIONS_VERSION;
    out->detection_size = sizeof *out->detection;
    return DETECTIONS_GOOD;
}
