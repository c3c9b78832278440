/* sensor/publish/coco.h: coco.json, the COCO detection format: a second writer of the record that truth.jsonl is made of.
 *
 *     images       one a frame and band; file_name relative to the folder of coco.json; id 4 frame + band + 1
 *     annotations  one a visible target and image: bbox [x, y, w, h] is box_px, area is pixels (a fraction of small
 *                  ones), iscrowd 0; segmentation: run lengths, uncompressed, of the pixels whose truth it is, which a
 *                  target of less than half a pixel has none of; beside them range_m, aspect_deg, visible_fraction,
 *                  entity and type
 *     categories   one a model of etc/catalog.csv, by its place there, whether seen or not: sweeps can be merged
 *
 * What is hidden has no box and is left to truth.jsonl. Written as the frames come, to coco.json.part, and renamed when
 * whole; memory does not grow with frames. */
#ifndef SENSOR_PUBLISH_COCO_H
#define SENSOR_PUBLISH_COCO_H

#include "sensor/publish/records.h"

typedef struct Coco Coco;

/* ending: of the pictures named, "png" or "exr". */
Status coco_open(Coco **out, const char *folder, const char *ending, const char *config_sha256, long long seed);
/* entity: truth plane of the frame, [height][width], snapshot index + 1. STATUS_IO, logged. */
Status coco_frame(Coco *coco, const FrameRecord *record, const uint32_t *entity);
/* Joins the parts and names the file; after a failure, or when this one fails (STATUS_IO, logged), there is none. NULL
 * is fine. */
Status coco_close(Coco *coco);

#endif
