/* sensor/publish/video/video_names.h: paths and addresses of a run's videos, from its configuration. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_NAMES_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_NAMES_H

#include "sensor/publish/video/video_output.h"
#include "render/scene/view.h"

/* FOLDER/[HOST/]BAND.ENDING, or publish.video itself when it names a file. False, logged: too long. */
bool video_path(char out[video_path_size], const Config *config, const char *host_folder, Band band, VideoKind kind);
/* The containers of a folder for this codec; returns how many. */
int  video_folder_kinds(VideoKind kind[2], const Config *config);
/* Of one band among those of the run. False: there is no stream. */
bool video_stream_url(StreamUrl *out, const Config *config, unsigned bands, Band band);

#endif
