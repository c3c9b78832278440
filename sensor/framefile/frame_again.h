/* sensor/framefile/frame_again.h: renders a frame from the content of a frame file, and compares the planes. */
#ifndef SENSOR_FRAMEFILE_FRAME_AGAIN_H
#define SENSOR_FRAMEFILE_FRAME_AGAIN_H

#include "sensor/framefile/frame_file.h"
#include "sensor/publish/frame.h"

/* The results: of one picture, as a frame file lists it. */
typedef struct FrameMade {
    char       sha256[sha256_text_size];
    int        plane_count;
    FramePlane plane[frame_max_planes];
} FrameMade;

Status frame_made(FrameMade *out, const FrameArray *plane, int count);

typedef struct FrameAgain {
    Picture   picture;
    Sun       sun;
    FrameMade made;
} FrameAgain;

/* snapshot: the file's, with an effect table. Picture: in the arena. */
Status frame_again(FrameAgain *out, const FrameFile *file, const Snapshot *snapshot, const World *world,
                   const Config *config, bool no_skip, Pool *pool, Arena *arena);
/* How many planes differ from those of the file, including planes that only one of them has. said: each is logged. */
int    frame_differences(const FrameFile *file, const FrameMade *made, bool said);

#endif
