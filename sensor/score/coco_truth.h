/* sensor/score/coco_truth.h: coco.json of a run or a sweep: which frame and band an image is, and what is to be found
 * in it. Read piece by piece; masks are not kept. */
#ifndef SENSOR_SCORE_COCO_TRUTH_H
#define SENSOR_SCORE_COCO_TRUTH_H

#include "render/scene/view.h"
#include "sensor/score/json_stream.h"

typedef struct CocoImage {
    long long id;
    int       frame, variant; /* variant: of CocoImages.name; -1: none */
    uint8_t   band;
} CocoImage;

typedef struct CocoImages {
    size_t     count, room;
    CocoImage *image; /* by id */
    int        names, names_room;
    char (*name)[256]; /* variants of a sweep */
} CocoImages;

typedef struct CocoTarget {
    long long image, id; /* ids */
    double    box[4];    /* x, y, width, height */
    uint64_t  entity;    /* as TruthTarget.id */
    int       frame;
    uint8_t   band, class_number;
    bool      ignored;
} CocoTarget;

typedef struct CocoTruth {
    CocoImages  images;
    size_t      count, room;
    CocoTarget *target; /* by frame, band, id */
} CocoTruth;

/* targets false: images alone. STATUS_IO, STATUS_BAD_VALUE (what the program did not write, too), STATUS_NO_MEMORY,
 * logged. */
Status coco_truth_read(CocoTruth *out, const char *path, bool targets);
Status coco_truth_read_stream(CocoTruth *out, JsonStream *stream, bool targets);
void   coco_truth_free(CocoTruth *coco);

/* NULL: there is none. */
const CocoImage  *coco_image(const CocoImages *images, long long id);
const CocoTarget *coco_targets_of(size_t *count, const CocoTruth *coco, int frame, Band band);

#endif
