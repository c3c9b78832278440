/* sensor/framefile/frame_radar_file.h: the radar of a frame file: what it was given, and its map measured again. */
#ifndef SENSOR_FRAMEFILE_FRAME_RADAR_FILE_H
#define SENSOR_FRAMEFILE_FRAME_RADAR_FILE_H

#include "sensor/framefile/frame_content.h"
#include "sensor/radar/seeker_radar.h"
#include "sensor/settings/config.h"

/* Of a frame with one; joint: values of all nodes' joints of its snapshot. */
Status frame_radar_gather(FrameFile *file, const RadarFrame *radar, double *joint);
/* Measured again, by a radar of the file's settings. picture: rendered again, for what a scan shows on its pixels. */
Status frame_radar_again(const RadarFrame **out, SeekerRadar *radar, const FrameFile *file, const Snapshot *snapshot,
                         const World *world, const Picture *picture, const Config *config, Pool *pool, Arena *arena);
/* Whether its map, and its scan, are the file's to the bit. */
Status frame_radar_same(bool *same, const FrameFile *file, const RadarFrame *radar);

#endif
