/* sensor/publish/answers/answer_ring.c: an answer as PitviperDetections of etc/include/pitviper_memory.h, versions 1, 2
 * and 3. */
#include "sensor/publish/answers/answer_private.h"

#include <math.h>
#include <pitviper_memory.h>

_Static_assert((int)pitviper_detections_most == (int)answer_detections_most, "as many as an answer has");

/* What the versions have in common, at the same octets; its class begins behind it. */
typedef struct DetectionHead {
    float    left, top, right, bottom, score;
    uint32_t track;
} DetectionHead;

/* Where the parts of a detection are. */
typedef struct VersionLayout {
    size_t octets, class_octets;
} VersionLayout;
static const VersionLayout layouts[] = {{48, 16}, {64, 32}, {sizeof(PitviperDetection), 32}}; /* of version 1 on */
_Static_assert(sizeof layouts / sizeof *layouts == PITVIPER_DETECTIONS_VERSION, "each version has a layout");

/* Printable ASCII up to the first 0, then zeros to the end. */
static bool take_class(AnswerDetection *out, const char *text, size_t size)
{
    const size_t length = strnlen(text, size);
    for (size_t n = length; n < size; n++)
        if (text[n]) return false;
    return length < size && answer_class_set(out, text, length);
}

/* What version 3 has behind the class. */
static AnswerReason take_sight(AnswerDetection *out, const uint8_t *bytes)
{
    PitviperDetection d;
    memcpy(&d, bytes, sizeof d);
    const bool sighted = d.flags & PITVIPER_DETECTION_SIGHT, boxed = !(d.flags & PITVIPER_DETECTION_NO_BOX);
    if (d.flags & ~(uint32_t)(PITVIPER_DETECTION_SIGHT | PITVIPER_DETECTION_NO_BOX) || d.reserved[0] || d.reserved[1])
        return ANSWER_RESERVED;
    if (!sighted && (d.los_az_rad != 0 || d.los_el_rad != 0)) return ANSWER_SIGHT; /* NaN too */
    if (!boxed && (d.left != 0 || d.top != 0 || d.right != 0 || d.bottom != 0)) return ANSWER_BOX;
    if (sighted && !(isfinite(d.los_az_rad) && isfinite(d.los_el_rad))) return ANSWER_SIGHT;
    if (isnan(d.range_m)) return ANSWER_RANGE;
    if (sighted) out->los_rad[0] = d.los_az_rad, out->los_rad[1] = d.los_el_rad;
    if (d.range_m != 0) out->range_m = d.range_m;
    for (int k = 0; k < 4 && !boxed; k++) out->box_px[k] = NAN;
    return ANSWER_GOOD;
}

static AnswerReason take(AnswerDetection *out, const uint8_t *bytes, const VersionLayout *of, const AnswerScope *scope)
{
    static const uint8_t zeros[8] = {0};
    const bool           newest = of == &layouts[PITVIPER_DETECTIONS_VERSION - 1];
    DetectionHead        d;
    *out = answer_detection_empty();
    memcpy(&d, bytes, sizeof d);
    if (!(isfinite(d.left) && isfinite(d.top) && isfinite(d.right) && isfinite(d.bottom))) return ANSWER_BOX;
    if (isnan(d.score)) return ANSWER_SCORE;
    out->box_px[0] = d.left, out->box_px[1] = d.top, out->box_px[2] = d.right, out->box_px[3] = d.bottom;
    out->score = d.score;
    out->track = d.track;
    const bool   text = take_class(out, (const char *)bytes + sizeof d, of->class_octets);
    AnswerReason reason = newest ? take_sight(out, bytes) : ANSWER_GOOD;
    if (reason == ANSWER_GOOD) reason = answer_detection_check(out, scope);
    if (reason != ANSWER_GOOD) return reason;
    if (!text) return ANSWER_TEXT;
    return !newest && memcmp(bytes + of->octets - sizeof zeros, zeros, sizeof zeros) != 0 ? ANSWER_RESERVED
                                                                                          : ANSWER_GOOD;
}

AnswerReason answer_read_ring(Answer *out, const uint8_t *bytes, size_t size, const AnswerScope *scope)
{
    PitviperDetections of = {.version = 0};
    const size_t       head = PITVIPER_DETECTIONS_SIZE(0);
    if (size < head) return ANSWER_SIZE;
    memcpy(&of, bytes, head);
    if (memcmp(of.magic, PITVIPER_DETECTIONS_MAGIC, sizeof of.magic) != 0) return ANSWER_MAGIC;
    if (of.byte_order != PITVIPER_MEMORY_BYTE_ORDER) return ANSWER_ORDER;
    if (of.version < 1 || of.version > PITVIPER_DETECTIONS_VERSION) return ANSWER_VERSION;
    const VersionLayout *layout = &layouts[of.version - 1];
    if (of.detection_size != layout->octets) return ANSWER_VERSION;
    if (of.count > pitviper_detections_most) return ANSWER_COUNT;
    if (size != head + of.count * layout->octets) return ANSWER_SIZE;
    if (of.band >= BAND_COUNT || !(scope->bands >> of.band & 1)) return ANSWER_BAND;
    if (of.reserved) return ANSWER_RESERVED;
    out->numbered = true;
    out->number_bits = UINT32_MAX;
    out->frame = of.frame;
    out->band = (Band)of.band;
    out->count = (int)of.count;
    for (int i = 0; i < out->count; i++) {
        const AnswerReason reason = take(&out->detection[i], bytes + head + (size_t)i * layout->octets, layout, scope);
        if (reason != ANSWER_GOOD) return reason;
    }
    return ANSWER_GOOD;
}
