/* sensor/publish/coco_merge.h: one coco.json of several, of the variants of a sweep: ids anew from 1 on, in the order
 * of the variants; images are named from the sweep's folder, and say whose they are (`variant`). Categories are the
 * same in all. */
#ifndef SENSOR_PUBLISH_COCO_MERGE_H
#define SENSOR_PUBLISH_COCO_MERGE_H

#include "pitviper.h"

typedef struct CocoMerge CocoMerge;

/* FOLDER/coco.json; nothing is touched before the first is added. */
Status coco_merge_open(CocoMerge **out, const char *folder);
/* FOLDER/NAME/coco.json. One at a time is in memory. STATUS_IO, STATUS_BAD_VALUE: logged. */
Status coco_merge_add(CocoMerge *merge, const char *name);
/* Names the file; an earlier sweep's goes when there is none now, but not a plain run's. Not whole, or after a failure:
 * there is none. NULL is fine. */
Status coco_merge_close(CocoMerge *merge, bool whole);

#endif
