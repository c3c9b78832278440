/* sensor/publish/klv/klv.h: MISB metadata of a frame: one ST 0601.19 UAS Datalink local set, with the targets as an ST
 * 0903.6 VMTI local set inside it (tag 74). What each tag holds: etc/reference/klv.md.
 *
 * Pure functions of their arguments: no allocation, no files, no state. An item whose value is unknown, not finite or
 * outside its range is absent; no error indicator is ever written. */
#ifndef SENSOR_PUBLISH_KLV_KLV_H
#define SENSOR_PUBLISH_KLV_KLV_H

#include "sensor/frame/records.h"
#include "terrain/earth/geoid.h"

enum {
    klv_most_octets = 8192, /* of a packet; it is below 600 without targets */
    klv_most_targets = 64,  /* reported in one packet */
    klv_version = 19,
    klv_vmti_version = 6,
};

/* A target, from the truth or from a recogniser. */
typedef struct KlvTarget {
    uint64_t    id;         /* the same target has the same id in all frames */
    int         box[4];     /* left, top, right, bottom, px from 0, the last two beyond it; empty: not known */
    bool        pointed;    /* without a box: it is known by one point, */
    int         point[2];   /* column and row of its pixel, from 0; none where they are not in the image */
    double      confidence; /* 0 .. 1; NaN: none given */
    double      pixels;     /* of the target itself, within its box; NaN: not known */
    bool        located;
    Geodetic    place;      /* if located */
    const char *class_name; /* NULL: not classified */
    const char *algorithm;  /* NULL: not given */
    const char *algorithm_version;
} KlvTarget;

typedef struct KlvTargets {
    bool             truth; /* marked so in system name, algorithm and ontology: no output of a recogniser */
    int              count; /* those beyond klv_most_targets are left out, and all but the first with an id */
    int              total; /* detected in the frame, those that are not in the list too; below count: count */
    const KlvTarget *target;
    bool             elsewhen; /* found in another frame than the packet's: */
    int              frame;
    double           unix_s; /* of that frame */
} KlvTargets;

/* What the record does not know. */
typedef struct KlvSource {
    Band         band;
    const char  *mission; /* NULL: "Exercise" */
    const char  *sensor;  /* NULL: after the band */
    const Geoid *geoid;   /* for heights above mean sea level; NULL: they are absent */
} KlvSource;

/* Writes the packet of one frame. unix_s: its exercise time. targets NULL: there is no tag 74. Returns its octets; 0:
 * refused, since unix_s is not a time from 1970 to 2200. */
size_t klv_frame(uint8_t out[klv_most_octets], const FrameRecord *record, double unix_s, const KlvSource *source,
                 const KlvTargets *targets);

/* The record's targets that are visible, largest first, as truth. out->target: kept, [klv_most_targets]. The id is the
 * entity's: site << 32 | application << 16 | entity. */
void klv_truth_targets(KlvTargets *out, KlvTarget kept[klv_most_targets], const FrameRecord *record);

#endif
