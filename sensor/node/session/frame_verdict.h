/* sensor/node/session/frame_verdict.h: what one frame of a live node gives up. It is noted in the recording, and a
 * replay gives up the same: the wall's time chooses nothing there.
 *
 * A note holds for the frame of that number and time alone: a replay at another rate has everything in every frame. */
#ifndef SENSOR_NODE_SESSION_FRAME_VERDICT_H
#define SENSOR_NODE_SESSION_FRAME_VERDICT_H

#include "render/frame/picture.h"

/* A verdict is a set of these; 0: nothing is given up. */
enum {
    VERDICT_NO_RADAR = 1,        /* signatures of targets are still to be made */
    VERDICT_NO_TARGET_GRIDS = 2, /* targets that are small on the image have the samples of all others */
    VERDICT_TARGETS = 4,         /* a step of sampling (Sampling), of these three at most one */
    VERDICT_CHECKERBOARD = 8,
    VERDICT_QUARTER = 16,
    VERDICT_COARSE_RADAR = 32, /* the radar has coarse signatures: finer ones are still to be made */
};
enum { verdict_count = 6 }; /* bits */

/* SAMPLING_ALL: 0. */
unsigned frame_verdict_of_sampling(Sampling sampling);

/* Takes what is given up out of the request of a frame. */
void frame_verdict_apply(RenderRequest *request, unsigned verdict);
/* Its names in truth.jsonl, separated by commas; empty: that has nothing of its own to say. */
enum { frame_verdict_names_size = 64 };
void frame_verdict_names(char out[frame_verdict_names_size], unsigned verdict);

/* The note of one of them. */
enum { frame_verdict_text_size = 96 };
void frame_verdict_text(char out[frame_verdict_text_size], unsigned one, int number, double t_s);

typedef struct FrameVerdicts FrameVerdicts;
/* Reads DisLog.notes; other notes are passed over. *out NULL: there are none. */
Status   frame_verdicts_read(FrameVerdicts **out, const char *notes);
void     frame_verdicts_free(FrameVerdicts *verdicts);                             /* accepts NULL */
unsigned frame_verdicts_of(const FrameVerdicts *verdicts, int number, double t_s); /* of NULL: 0 */

#endif
