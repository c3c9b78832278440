/* sensor/publish/coco_file.h: coco.json while it is written: images go straight into the file, annotations into
 * another, which is read back at the end; memory does not grow with them. Private to the folder. */
#ifndef SENSOR_PUBLISH_COCO_FILE_H
#define SENSOR_PUBLISH_COCO_FILE_H

#include "pitviper.h"

#include <jansson.h>
#include <stdio.h>

enum { coco_path_size = 4200 };

typedef struct CocoFile {
    char      path[coco_path_size], waiting_path[coco_path_size];
    FILE     *file, *waiting;
    long long images, annotations; /* objects written; the next ids, which begin with 1, are one more */
    bool      failed;
} CocoFile;

/* In FOLDER/coco.json.part. After a failure, logged, nothing is left and nothing need be closed. */
Status coco_file_open(CocoFile *out, const char *folder);
/* Take ownership of the object, NULL when memory is out, and free it. STATUS_IO, logged once. */
Status coco_file_image(CocoFile *file, json_t *image);
Status coco_file_annotation(CocoFile *file, json_t *annotation);
/* Joins the parts, adds the categories of sensor/publish/target_class.h and info, which it takes over, and renames
 * the file; after a failure, or when incomplete, there is none. */
Status coco_file_close(CocoFile *file, json_t *info, bool whole);

#endif
