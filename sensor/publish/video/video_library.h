/* sensor/publish/video/video_library.h: FFmpeg's libraries, loaded when a video or stream is first asked for. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_LIBRARY_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_LIBRARY_H

#include "pitviper_library.h"

extern Library video_library;

#endif
