/* sensor/publish/coco.h: coco.json, the COCO detection format (cocodataset.org, pycocotools): a second writer of the
 * record that truth.jsonl is written from.
 *
 *     images       one per frame and band; file_name relative to the folder of coco.json; id 4 frame + number of the
 *                  band among optical, mwir, lwir, radar, from 1 on
 *     annotations  one per image and target with at least one pixel in the truth plane `entity`; id from 1 on.
 *                  segmentation: those pixels, compressed run lengths (sensor/publish/coco_mask.h); bbox [x, y, w, h]:
 *                  their box, the first pixel is 0; area: their number. iscrowd and ignore 1: fewer than
 *                  publish.coco_min_pixels, or a smaller share visible than publish.coco_min_visible: neither found nor
 *                  missed counts. plane_value: value of those pixels in the truth plane, as in truth.jsonl. pixels:
 *                  area with parts of pixels; entity, type, model, range_m, aspect_deg, visible_fraction as there
 *     categories   all of sensor/publish/target_class.h, whatever is visible: sets can be joined
 *
 * A target that is hidden, or fills no pixel by more than half, has no mask and is in truth.jsonl only. Written
 * frame by frame to coco.json.part, and renamed when complete; memory does not grow with the number of frames. */
#ifndef SENSOR_PUBLISH_COCO_H
#define SENSOR_PUBLISH_COCO_H

#include "sensor/publish/records.h"

typedef struct Coco Coco;

/* Below these an annotation is marked to be ignored. */
typedef struct CocoLimits {
    int    min_pixels;  /* 1 or more: of the mask */
    double min_visible; /* 0 .. 1: of the target's area on the image */
} CocoLimits;

/* ending: of the images named, "png" or "exr". */
Status coco_open(Coco **out, const char *folder, const char *ending, CocoLimits limits, const char *config_sha256,
                 long long seed);
/* Opens FOLDER/coco.json, before the first frame. */
Status coco_begin(Coco *coco);
/* entity: truth plane of the frame, [height][width], snapshot index + 1. STATUS_IO, logged. */
Status coco_frame(Coco *coco, const FrameRecord *record, const uint32_t *entity);
/* Joins the parts and renames the file; after a failure, or when this one fails (STATUS_IO, logged), there is none.
 * NULL is valid. */
Status coco_close(Coco *coco);

#endif
