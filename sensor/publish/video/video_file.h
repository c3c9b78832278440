/* sensor/publish/video/video_file.h: a video's file, which survives a disk that is full for a while.
 *
 * What is written between two marks is there as a whole or not at all: after a failure the file ends at the last
 * mark. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_FILE_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_FILE_H

#include "pitviper.h"

typedef struct VideoFile VideoFile;

/* Replaces what is there. Logged. */
Status video_file_open(VideoFile **out, const char *path);
/* False: it failed; what is written until the next mark is dropped. */
bool   video_file_write(VideoFile *file, const uint8_t *bytes, size_t count);
bool   video_file_seek(VideoFile *file, int64_t position);
/* Returns whether everything since the last mark is in the file. */
bool   video_file_mark(VideoFile *file);
/* Logged. NULL is valid. */
Status video_file_close(VideoFile *file);
/* The reason of the last failure. */
const char *video_file_error(const VideoFile *file);
const char *video_file_path(const VideoFile *file);

#endif
