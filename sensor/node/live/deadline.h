/* sensor/node/live/deadline.h: the step of sampling at which a live node renders its next frame, so that it is done
 * before the one after it is due. A function of measured times alone: it reads no clock and looks at no picture.
 *
 * Steps are those of RenderRequest.sampling: 0 is what the settings say, each further one is cheaper. The cost of a
 * frame is the wall time from the choice until the thread that makes frames has done with it: rendering, instruments,
 * truth, what is published on that thread. What precedes the choice is in gone_s. What other threads take from the
 * processors shows as slower frames. */
#ifndef SENSOR_NODE_LIVE_DEADLINE_H
#define SENSOR_NODE_LIVE_DEADLINE_H

#include "pitviper.h"

enum { deadline_steps = 4, deadline_recent = 3 };

/* Shares of the interval between frames: left free behind a frame; that a step above must leave free beyond that before
 * it is taken again. */
static const double deadline_margin = 0.1, deadline_hysteresis = 0.1;
/* Frames in a row that must have room for a step above: at first; from deadline_start frames on; at most, since the
 * number doubles each time that a step above was given up again within deadline_trial frames. */
enum { deadline_patience_start = 1, deadline_start = 6, deadline_patience = 4, deadline_patience_most = 64 };
enum { deadline_trial = 16 };
/* A step above without room, but not by more than this share of the interval, is tried after so many frames at one
 * step: its cost may not be what it was taken for. */
static const double deadline_try = 0.1;
enum { deadline_still = 64 };

typedef struct DeadlineFrame {
    int    step;
    double cost_s;
} DeadlineFrame;

typedef struct Deadline {
    double        interval_s;
    double        table[deadline_steps];   /* cost over that of step 0, of the table */
    double        ratio[deadline_steps];   /* the same, as measured here, once seen */
    DeadlineFrame recent[deadline_recent]; /* the last frames, newest first */
    int           known;                   /* of these */
    int           frames;                  /* since deadline_forget */
    int           step;                    /* of the last frame */
    double        left_s;                  /* from its choice until the next frame was due */
    int           room, room_step;         /* frames in a row with room above; the step that all of them had room for */
    int           patience, since_up;      /* frames */
    int           still;                   /* frames at one step */
    DeadlineFrame before;                  /* its step: what a step above was taken from, its usual cost; 0 s: none */
} Deadline;

/* ratio: cost of each step over that of the first, which is 1; none is above the one before. A step that costs as much
 * as the one before is never chosen. */
Deadline deadline_begin(double rate_hz, const double ratio[deadline_steps]);
/* The host was absent, or is another one: its first frame is made at the cheapest step, and frames at the start go up
 * without patience. */
void deadline_forget(Deadline *deadline);
/* The step of the next frame. gone_s: time since it was due. */
int deadline_choose(Deadline *deadline, double gone_s);
/* The frame of the last choice is done, cost_s after the choice. */
void deadline_done(Deadline *deadline, double cost_s);

#endif
