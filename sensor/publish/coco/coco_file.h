/* sensor/publish/coco/coco_file.h: coco.json while it is written: images go straight into the file, annotations into
 * another, which is read back at the end; memory does not grow with them. */
#ifndef SENSOR_PUBLISH_COCO_COCO_FILE_H
#define SENSOR_PUBLISH_COCO_COCO_FILE_H

#include "pitviper.h"

#include <jansson.h>
#include <stdio.h>

enum { coco_path_size = 4200 };

typedef struct CocoFile {
    char      path[coco_path_size], waiting_path[coco_path_size];
    FILE     *file, *waiting;
    long long images, annotations; /* objects written; the next ids, which begin with 1, are one more */
    bool      failed, clutter;     /* clutter: some annotation is of it */
} CocoFile;

/* In FOLDER/coco.json.part. After a failure, logged, nothing is left and nothing need be closed. */
Status coco_file_open(CocoFile *out, const char *folder);
/* Take ownership of the object, NULL when memory is out, and free it. STATUS_IO, logged once. */
Status coco_file_image(CocoFile *file, json_t *image);
Status coco_file_annotation(CocoFile *file, json_t *annotation);
/* Joins the parts, adds the categories of sensor/frame/target_record.h and info, which it takes over, and renames
 * the file; after a failure, or when incomplete, there is none. */
Status coco_file_close(CocoFile *file, json_t *info, bool whole);

/* ---- a sweep ------------------------------------------------------------------------------------- */

/* Merges the coco.json of the variants of a sweep into one. Ids are new, from 1 on, in the order of the variants;
 * images are named relative to the sweep's folder, and name their variant (`variant`). All variants have the same
 * categories. */

typedef struct CocoMerge CocoMerge;

/* FOLDER/coco.json; nothing is changed before the first is added. */
Status coco_merge_open(CocoMerge **out, const char *folder);
/* FOLDER/NAME/coco.json. One at a time is in memory. STATUS_IO, STATUS_BAD_VALUE: logged. */
Status coco_merge_add(CocoMerge *merge, const char *name);
/* Renames the file into place; an earlier sweep's is removed when there is none now, but not that of a single run.
 * Incomplete, or after a failure: there is none. NULL is valid. */
Status coco_merge_close(CocoMerge *merge, bool whole);

#endif
