/* sensor/frame/target_record.h: one target of a frame, as every format states it. It is made once per frame, from
 * Target, Snapshot and Catalog; truth.jsonl, coco.json, Data PDUs, ST 0903 and shared memory are written from it.
 *
 * box: the pixels that show any part of the target, half open, [x0, x1) x [y0, y1), the first pixel of the image is
 * 0 0; no pixel: all 0. Each format states the same pixels its own way:
 *
 *     format                   form                                     first pixel  last pixel  rounding
 *     truth.jsonl box_px       x0, y0, x1, y1                           0            exclusive   none: integers
 *     Data PDU 600201, 600202  u16 x0, y0, x1, y1 (target_box_u16)      0            exclusive   none up to 65535
 *     shared memory            int32 x0, y0, x1, y1                     0            exclusive   none
 *     ST 0903 tags 2, 3        pixel numbers of the first and the       1            inclusive   none
 *                              last pixel: column + row width + 1,
 *                              row by row (target_box_pixel_numbers)
 *     ST 0903 tag 1            that of the pixel which holds the        1            -           down, to a pixel
 *                              box's centre (target_box_centre_number)
 *     coco.json bbox           x, y, width, height (target_box_coco)    0            exclusive   none; another box
 *
 * COCO requires the box of the mask: the pixels whose value in the truth plane `entity` is the target's. A pixel has
 * one value, but may show several entities: it counts for `box` when any sample in it shows the target, and for the
 * mask when its own ray does, or, of a small target, when the target fills more than half of it. So COCO's box lies
 * within `box` and is smaller by the rows and columns of pixels that the target only fills in part: none or one on a
 * side of a compact target, more where it ends in a thin part (an antenna, a barrel). Of an ignore region - a target
 * that fills no pixel by more than half, or is below a limit - it is `box` itself.
 *
 * amodal_box: of the target's vertices, image coordinates, not clipped and not rounded: the first pixel extends from
 * 0 to 1. Only truth.jsonl, coco.json (bbox_amodal: x, y, width, height) and shared memory have it.
 *
 * Other numbers: truth.jsonl has 15 digits, angles in degrees, and omits NaN; coco.json the same; Data PDUs have f32,
 * angles in radians, and NaN; ST 0903 has the integers of its tags, stated where they are written.
 * Example and check of all of these: tests/sensor/test_target_record.c, tests/system/test_five_records.sh. */
#ifndef SENSOR_FRAME_TARGET_RECORD_H
#define SENSOR_FRAME_TARGET_RECORD_H

#include "entities/catalog/catalog.h"
#include "sensor/truth/truth.h"
#include "dis/pdu/pdu.h"

/* The values are those of PitviperMemoryTarget.flags. */
typedef enum TargetOccluder {
    OCCLUDER_NONE,
    OCCLUDER_GROUND,
    OCCLUDER_ENTITY,
    OCCLUDER_TREES = 4,
    OCCLUDER_SCENERY = 8
} TargetOccluder;

/* NaN: not computed. */
typedef struct TargetRecord {
    int            index; /* of the snapshot */
    DisEntityId    id;
    char           marking[12]; /* terminated, raw bytes */
    DisEntityType  type;
    int            class_number; /* sensor/frame/target_record.h */
    int            plane_value;  /* in the truth planes entity; from 1 */
    const char    *model;        /* the catalog's */
    int            box[4];
    double         amodal_box[4];
    double         pixels;                   /* area, parts of pixels too */
    double         visible_fraction;         /* of its area on the image */
    double         foliage_fraction;         /* share of it that plants hide */
    double         p_ecef[3], v_ecef_mps[3]; /* of the model's origin */
    double         range_m, closing_mps;
    double         aspect_rad; /* 0: nose on, to its right, below 2 pi */
    double         depression_rad;
    double         los_az_rad, los_el_rad;  /* from the sensor, in its own ENU; azimuth from north over east */
    double         los_rate_rps[2];         /* inertial; camera right and up */
    double         boresight_error_rad[2];  /* camera right and up */
    TargetOccluder occluder;                /* what hides most of it */
    DisEntityId    occluder_id;             /* none: the ground, trees, scenery, or not known */
    double         dt_k;                    /* mean of its patches less the ground in the open */
    int            patches;                 /* 0: their temperatures are not known */
    const float   *patch_k;                 /* the snapshot's [patches] */
    double         age_s, position_error_m; /* of the report that it was extrapolated from; estimate */
    double         error_px;                /* rms displacement on the image */
    TargetBand     band[BAND_COUNT];
} TargetRecord;

/* Makes the records, in the order of target. NULL: out of memory. */
TargetRecord *target_records(const Target *target, int count, const Snapshot *snapshot, const Catalog *catalog,
                             Arena *arena);

/* Names what hides most of it: the id of an entity, `ground`, `trees`, `scenery` or `entity`; NULL: nothing. */
const char *target_occluder_text(char text[dis_id_text_size], const TargetRecord *target);

/* ---- a box in other forms ------------------------------------------------------------------------ */

static inline bool target_box_is_empty(const int box[4]) { return box[2] <= box[0] || box[3] <= box[1]; }
/* x, y, width, height */
void target_box_coco(int out[4], const int box[4]);
/* Writes left, top, right, bottom, the last two exclusive. Values beyond 0 .. 65535 become the nearest. */
void target_box_u16(uint16_t out[4], const int box[4]);
/* Of the first and the last pixel, in an image of that width. An empty box has none: both 0. */
void target_box_pixel_numbers(uint64_t out[2], const int box[4], int width);
/* The number of the pixel that holds the box's centre; of a box of even width or height, the one right of or below it.
 * Of an empty box: 0. */
uint64_t target_box_centre_number(const int box[4], int width);

/* ---- classes ------------------------------------------------------------------------------------- */

/* The target class of an entity, for training and scoring recognisers: a small fixed
 * table of names and numbers.
 *
 * The class is a function of the entity type alone, by the categories of SISO-REF-010: neither the log nor
 * etc/catalog.csv, nor the order of appearance changes a number. Numbers begin with 1 and have no gaps; once
 * published a number keeps its name, and new ones are added at the end (tests/sensor/test_target_class.c holds the
 * list a second time). They are the category ids of coco.json; truth.jsonl has the names.
 *
 * Names are those of public target recognition data (tank, apc, truck, helicopter). An apc is any armoured fighting
 * vehicle on wheels or tracks, infantry fighting vehicles too: the category does not tell them apart. */

/* How many; numbers are 1 .. target_class_count(). */
int         target_class_count(void);
const char *target_class_name(int number);
const char *target_class_group(int number); /* COCO's supercategory */
/* Finds the category of a type; `other` if none matches. */
int target_class(DisEntityType type);

#endif
