/* sensor/publish/video/video_targets.h: a recogniser's detections as targets of a stream's metadata. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_TARGETS_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_TARGETS_H

#include "sensor/publish/klv/klv.h"
#include "sensor/publish/memory/detections.h"

typedef struct VideoTargets {
    DetectionSet set;
    KlvTarget    target[klv_most_targets];
    KlvTargets   targets;
} VideoTargets;

/* The newest detections of a band, if they are of the last half second of the exercise before the frame; NULL: none. A
 * box covers all pixels that the detection's touches. A detection without a track has an id of its place in the list,
 * beyond those of tracks. Borrowed from kept. */
const KlvTargets *video_targets(VideoTargets *kept, Detections *detections, Band band, double unix_s);

#endif
