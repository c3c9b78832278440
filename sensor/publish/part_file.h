/* sensor/publish/part_file.h: a file that appears whole or not at all: written as PATH.part, renamed at the end.
 * Private to the folder.
 *
 * The first failure is one log line with path and reason; later writes then do nothing. */
#ifndef SENSOR_PUBLISH_PART_FILE_H
#define SENSOR_PUBLISH_PART_FILE_H

#include "pitviper.h"

#include <stdio.h>

typedef struct PartFile {
    const char *path;   /* the caller's */
    char       *part;
    FILE       *file;
    Status      status; /* of everything so far */
} PartFile;

/* Must be ended with part_file_close whatever it returns. */
Status part_file_open(PartFile *out, const char *path);
void   part_file_write(PartFile *file, const void *bytes, size_t count);
/* Over bytes already written, from `at` on. */
void   part_file_rewrite(PartFile *file, long at, const void *bytes, size_t count);
/* Gives up: nothing of it is left. Not logged. */
void   part_file_fail(PartFile *file, Status status);
/* Names the file. The status of the whole. */
Status part_file_close(PartFile *file);

#endif
