/* sensor/verify/saved_frame/saved_again.h: renders a frame from the content of a frame file, and compares
 * the planes. */
#ifndef SENSOR_VERIFY_SAVED_FRAME_SAVED_AGAIN_H
#define SENSOR_VERIFY_SAVED_FRAME_SAVED_AGAIN_H

#include "sensor/verify/saved_frame/saved_frame.h"
#include "sensor/frame/frame.h"
#include "sensor/radar/seeker_radar.h"
#include "sensor/settings/config.h"

/* The results: of one picture, as a frame file lists it. */
typedef struct SavedMade {
    char       sha256[sha256_text_size];
    int        plane_count;
    SavedPlane plane[frame_max_planes];
} SavedMade;

Status saved_made(SavedMade *out, const FrameArray *plane, int count);

typedef struct SavedAgain {
    Picture   picture;
    Sun       sun;
    SavedMade made;
} SavedAgain;

/* A frame file, and what it is rendered again with. */
typedef struct SavedStage {
    const SavedFrame *file;
    const Snapshot   *snapshot; /* the file's, with an effect table */
    const World      *world;
    const Config     *config;
    Pool             *pool;
    Arena            *arena; /* of the results */
} SavedStage;

Status saved_again(SavedAgain *out, const SavedStage *stage, bool no_skip);
/* Counts the planes that differ from those of the file, or that only one of them has. said: each is logged. */
int saved_differences(const SavedFrame *file, const SavedMade *made, bool said);

/* ---- the radar: what it was given, and its map measured again ------------------------------------ */

/* Gathers the radar of a frame that has one. joint: the values of all nodes' joints of its snapshot. */
Status saved_radar_gather(SavedFrame *file, const RadarFrame *radar, double *joint);
/* Measured again, by a radar of the file's settings. picture: rendered again, for what a scan shows on its pixels. */
Status saved_radar_again(const RadarFrame **out, SeekerRadar *radar, const SavedStage *stage, const Picture *picture);
/* Whether its map, and its scan, are the file's to the bit. */
Status saved_radar_same(bool *same, const SavedFrame *file, const RadarFrame *radar);

#endif
