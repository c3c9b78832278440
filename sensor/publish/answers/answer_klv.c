/* sensor/publish/answers/answer_klv.c: an answer as MISB ST 0903: a VMTI local set by itself, or in tag 74 of an ST
 * 0601 packet, as sensor/publish/klv writes it. Tags: etc/reference/answers.md. */
#include "sensor/publish/answers/answer_private.h"
#include "sensor/publish/answers/klv_reader_private.h"
#include "sensor/frame/source_sensor.h"

#include <math.h>

enum { key_octets = 16, classes_most = 64 };

/* SMPTE universal keys. */
static const uint8_t vmti_key[key_octets] = {0x06, 0x0E, 0x2B, 0x34, 0x02, 0x0B, 0x01, 0x01,
                                             0x0E, 0x01, 0x03, 0x03, 0x06, 0x00, 0x00, 0x00};
static const uint8_t uas_key[key_octets] = {0x06, 0x0E, 0x2B, 0x34, 0x02, 0x0B, 0x01, 0x01,
                                            0x0E, 0x01, 0x03, 0x01, 0x01, 0x00, 0x00, 0x00};

/* ---- classes -------------------------------------------------------------------------------------- */

/* Of the ontology series. */
typedef struct KlvClass {
    uint64_t id;
    KlvItem  name;
} KlvClass;

typedef struct KlvClasses {
    int      count;
    KlvClass of[classes_most];
} KlvClasses;

/* The last part of a URN or IRI. */
static KlvItem last_part(KlvItem text)
{
    size_t at = text.count;
    while (at > 0 && text.at[at - 1] != ':' && text.at[at - 1] != '/' && text.at[at - 1] != '#') at--;
    return (KlvItem){text.at + at, text.count - at};
}

/* Its name is the label, else the last part of the class's IRI. */
static bool read_classes(KlvClasses *out, KlvItem series)
{
    static const unsigned tags[] = {1, 4, 6};
    KlvReader             r = klv_reader(series);
    while (r.at < r.end) {
        KlvItem       of[3];
        KlvClass      one = {0};
        const KlvItem set = klv_read_value(&r);
        if (r.broken || out->count == classes_most || !klv_read_set(of, tags, 3, set) ||
            !klv_read_number(&one.id, of[0], 3))
            return false;
        one.name = of[2].at ? of[2] : of[1].at ? last_part(of[1]) : one.name;
        out->of[out->count++] = one;
    }
    return true;
}

/* The class of a VObject: by its number in the series, else the last part of what it says itself. */
static bool class_of(KlvItem *name, KlvItem object, const KlvClasses *classes)
{
    static const unsigned tags[] = {2, 3};
    KlvItem               of[2];
    uint64_t              id = 0;
    if (!klv_read_set(of, tags, 2, object) || !klv_read_number(&id, of[1], 3)) return false;
    *name = of[0].at ? last_part(of[0]) : (KlvItem){NULL, 0};
    for (int k = 0; of[1].at && k < classes->count; k++)
        if (classes->of[k].id == id) *name = classes->of[k].name;
    return true;
}

/* ---- a target ------------------------------------------------------------------------------------- */

enum {
    TARGET_CENTROID,
    TARGET_TOP_LEFT,
    TARGET_BOTTOM_RIGHT,
    TARGET_CONFIDENCE,
    TARGET_PLACE,
    TARGET_ROW,
    TARGET_COLUMN,
    TARGET_OBJECT,
    TARGET_OBJECTS,
    TARGET_ITEMS
};
static const unsigned target_tags[TARGET_ITEMS] = {1, 2, 3, 5, 17, 19, 20, 102, 107};

/* Column and row, from 0, of a pixel whose number counts from 1. False: it is not in the image. */
static bool pixel_of(double out[2], uint64_t number, const AnswerScope *scope)
{
    if (number < 1 || number > (uint64_t)scope->width * (uint64_t)scope->height) return false;
    out[0] = (double)((number - 1) % (uint64_t)scope->width);
    out[1] = (double)((number - 1) / (uint64_t)scope->width);
    return true;
}

/* The box, else the centroid: by its number, else by row and column, which count from 1. */
static AnswerReason read_pixels(AnswerDetection *out, const KlvItem of[TARGET_ITEMS], const AnswerScope *scope)
{
    uint64_t first = 0, last = 0, centroid = 0, row = 0, column = 0;
    double   top_left[2], bottom_right[2], at[2];
    if (!klv_read_number(&first, of[TARGET_TOP_LEFT], 6) || !klv_read_number(&last, of[TARGET_BOTTOM_RIGHT], 6) ||
        !klv_read_number(&centroid, of[TARGET_CENTROID], 6) || !klv_read_number(&row, of[TARGET_ROW], 4) ||
        !klv_read_number(&column, of[TARGET_COLUMN], 4))
        return ANSWER_LOCAL_SET;
    if ((of[TARGET_TOP_LEFT].at != NULL) != (of[TARGET_BOTTOM_RIGHT].at != NULL)) return ANSWER_BOX;
    if (of[TARGET_TOP_LEFT].at) {
        if (!pixel_of(top_left, first, scope) || !pixel_of(bottom_right, last, scope)) return ANSWER_BOX;
        for (int k = 0; k < 2; k++) out->box_px[k] = top_left[k], out->box_px[2 + k] = bottom_right[k] + 1;
        return ANSWER_GOOD;
    }
    if (of[TARGET_CENTROID].at) {
        if (!pixel_of(at, centroid, scope)) return ANSWER_BOX;
    } else if (of[TARGET_ROW].at && of[TARGET_COLUMN].at) {
        if (row < 1 || row > (uint64_t)scope->height || column < 1 || column > (uint64_t)scope->width)
            return ANSWER_BOX;
        at[0] = (double)column - 1, at[1] = (double)row - 1;
    } else {
        return ANSWER_GOOD;
    }
    for (int k = 0; k < 2; k++) out->point_px[k] = at[k] + 0.5;
    return ANSWER_GOOD;
}

/* Latitude, longitude, height above the ellipsoid; what may follow, their uncertainties, is passed over. */
static bool read_place(AnswerDetection *out, KlvItem pack)
{
    enum { pack_octets = 10 };
    if (!pack.at) return true;
    if (pack.count < pack_octets) return false;
    out->place = (Geodetic){klv_read_imapb(pack.at, 4, -90, 90) * rad_per_deg,
                            klv_read_imapb(pack.at + 4, 4, -180, 180) * rad_per_deg,
                            klv_read_imapb(pack.at + 8, 2, -900, 19000)};
    out->located = isfinite(out->place.lat_rad) && isfinite(out->place.lon_rad) && isfinite(out->place.h_m);
    return out->located;
}

static AnswerReason read_class(AnswerDetection *out, const KlvItem of[TARGET_ITEMS], const KlvClasses *classes)
{
    KlvItem   name = {NULL, 0}, object = of[TARGET_OBJECT];
    KlvReader series = klv_reader(of[TARGET_OBJECTS]);
    if (series.at < series.end) object = klv_read_value(&series); /* of several the first */
    if (series.broken || (object.at && !class_of(&name, object, classes))) return ANSWER_LOCAL_SET;
    return !name.at || answer_class_set(out, (const char *)name.at, name.count) ? ANSWER_GOOD : ANSWER_TEXT;
}

/* A VTarget pack. Its id is the track, if it is one of 32 bits. */
static AnswerReason read_target(AnswerDetection *out, uint64_t *id, KlvItem pack, const KlvClasses *classes,
                                const AnswerScope *scope)
{
    KlvItem   of[TARGET_ITEMS];
    KlvReader r = klv_reader(pack);
    uint64_t  percent = 0;
    *out = answer_detection_empty();
    *id = klv_read_oid(&r);
    if (r.broken || !klv_read_set(of, target_tags, TARGET_ITEMS, (KlvItem){r.at, (size_t)(r.end - r.at)}) ||
        !read_place(out, of[TARGET_PLACE]))
        return ANSWER_LOCAL_SET;
    out->track = *id <= UINT32_MAX ? (uint32_t)*id : 0;
    if (!klv_read_number(&percent, of[TARGET_CONFIDENCE], 1)) return ANSWER_LOCAL_SET;
    if (of[TARGET_CONFIDENCE].at) out->score = 0.01 * (double)percent;
    AnswerReason reason = read_pixels(out, of, scope);
    if (reason == ANSWER_GOOD) reason = read_class(out, of, classes);
    return reason == ANSWER_GOOD ? answer_detection_check(out, scope) : reason;
}

/* Each id occurs once. */
static AnswerReason read_targets(Answer *out, KlvItem series, const KlvClasses *classes, const AnswerScope *scope)
{
    uint64_t  id[answer_detections_most];
    KlvReader r = klv_reader(series);
    while (r.at < r.end) {
        const KlvItem pack = klv_read_value(&r);
        const int     n = out->count;
        if (r.broken) return ANSWER_LOCAL_SET;
        if (n == answer_detections_most) return ANSWER_COUNT;
        const AnswerReason reason = read_target(&out->detection[n], &id[n], pack, classes, scope);
        if (reason != ANSWER_GOOD) return reason;
        for (int k = 0; k < n; k++)
            if (id[k] == id[n]) return ANSWER_LOCAL_SET;
        out->count++;
    }
    return ANSWER_GOOD;
}

/* ---- the local set -------------------------------------------------------------------------------- */

enum {
    VMTI_TIME,
    VMTI_REPORTED,
    VMTI_FRAME,
    VMTI_WIDTH,
    VMTI_HEIGHT,
    VMTI_SENSOR,
    VMTI_TARGETS,
    VMTI_CLASSES,
    VMTI_ITEMS
};
static const unsigned vmti_tags[VMTI_ITEMS] = {2, 6, 7, 8, 9, 10, 101, 103};

/* By the name of its sensor or its own; without one that of a run of one band. */
static bool read_band(Band *out, KlvItem name, const AnswerScope *scope)
{
    for (int b = 0; b < BAND_COUNT; b++) {
        const char *const known[2] = {source_sensor_name[b], band_name((Band)b)};
        bool              same = !name.at && scope->bands == 1u << b;
        for (int k = 0; k < 2 && name.at; k++)
            same |= strlen(known[k]) == name.count && memcmp(known[k], name.at, name.count) == 0;
        if (!same || !(scope->bands >> b & 1)) continue;
        *out = (Band)b;
        return true;
    }
    return false;
}

/* time, sensor: of the packet around it, for what it does not say itself. */
static AnswerReason read_vmti(Answer *out, KlvItem set, KlvItem time, KlvItem sensor, const AnswerScope *scope)
{
    KlvItem    of[VMTI_ITEMS];
    KlvClasses classes = {0};
    uint64_t   time_us = 0, number = 0, width = (uint64_t)scope->width, height = (uint64_t)scope->height, reported = 0;
    if (!klv_read_set(of, vmti_tags, VMTI_ITEMS, set)) return ANSWER_LOCAL_SET;
    if (!of[VMTI_TIME].at) of[VMTI_TIME] = time;
    if (!of[VMTI_SENSOR].at) of[VMTI_SENSOR] = sensor;
    if (!klv_read_number(&time_us, of[VMTI_TIME], 8) || !klv_read_number(&number, of[VMTI_FRAME], 3) ||
        !klv_read_number(&width, of[VMTI_WIDTH], 3) || !klv_read_number(&height, of[VMTI_HEIGHT], 3) ||
        !klv_read_number(&reported, of[VMTI_REPORTED], 3) || time_us > INT64_MAX ||
        !read_classes(&classes, of[VMTI_CLASSES]))
        return ANSWER_LOCAL_SET;
    if (!of[VMTI_TIME].at && !of[VMTI_FRAME].at) return ANSWER_FRAME;
    if (!read_band(&out->band, of[VMTI_SENSOR], scope)) return ANSWER_BAND;
    if (width != (uint64_t)scope->width || height != (uint64_t)scope->height) return ANSWER_IMAGE;
    out->timed = of[VMTI_TIME].at != NULL;
    out->time_us = (int64_t)time_us;
    out->numbered = of[VMTI_FRAME].at != NULL;
    out->number_bits = 0xFFFFFF;
    out->frame = (int)number;
    const AnswerReason reason = read_targets(out, of[VMTI_TARGETS], &classes, scope);
    if (reason != ANSWER_GOOD) return reason;
    return of[VMTI_REPORTED].at && reported != (uint64_t)out->count ? ANSWER_COUNT : ANSWER_GOOD;
}

/* The sum of all octets before it, alternately shifted by 8 bits. */
static uint16_t sum_of(const uint8_t *bytes, size_t count)
{
    uint16_t sum = 0;
    for (size_t i = 0; i < count; i++) sum = (uint16_t)(sum + (i % 2 ? bytes[i] : bytes[i] << 8));
    return sum;
}

AnswerReason answer_read_klv(Answer *out, const uint8_t *bytes, size_t size, const AnswerScope *scope)
{
    static const unsigned packet_tags[] = {1, 2, 11, 74};
    KlvItem               of[4];
    KlvReader             r = {bytes + (size < key_octets ? size : key_octets), bytes + size, size < key_octets};
    const KlvItem         set = klv_read_value(&r);
    if (r.broken || r.at != r.end || !klv_read_set(of, packet_tags, 4, set)) return ANSWER_LOCAL_SET;
    const bool alone = memcmp(bytes, vmti_key, key_octets) == 0;
    if (!alone && memcmp(bytes, uas_key, key_octets) != 0) return ANSWER_LOCAL_SET;
    /* the checksum is the last item */
    if (!of[0].at || of[0].count != 2 || of[0].at + 2 != r.end ||
        sum_of(bytes, size - 2) != (of[0].at[0] << 8 | of[0].at[1]))
        return ANSWER_CHECKSUM;
    if (alone) return read_vmti(out, set, (KlvItem){NULL, 0}, (KlvItem){NULL, 0}, scope);
    return of[3].at ? read_vmti(out, of[3], of[1], of[2], scope) : ANSWER_LOCAL_SET;
}
