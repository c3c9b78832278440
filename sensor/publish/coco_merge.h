/* sensor/publish/coco_merge.h: one coco.json from those of the variants of a sweep: new ids from 1 on, in the order
 * of the variants; images are named relative to the sweep's folder, and name their variant (`variant`). Categories
 * are the same in all. */
#ifndef SENSOR_PUBLISH_COCO_MERGE_H
#define SENSOR_PUBLISH_COCO_MERGE_H

#include "pitviper.h"

typedef struct CocoMerge CocoMerge;

/* FOLDER/coco.json; nothing is changed before the first is added. */
Status coco_merge_open(CocoMerge **out, const char *folder);
/* FOLDER/NAME/coco.json. One at a time is in memory. STATUS_IO, STATUS_BAD_VALUE: logged. */
Status coco_merge_add(CocoMerge *merge, const char *name);
/* Renames the file into place; an earlier sweep's is removed when there is none now, but not that of a single run.
 * Incomplete, or after a failure: there is none. NULL is valid. */
Status coco_merge_close(CocoMerge *merge, bool whole);

#endif
