/* sensor/node/live/pace.h: how a live node keeps its rate: what each frame gives up (deadline.h), and what is said of
 * it: when it begins and ends, and how many frames there were at each step.
 *
 * Times are of a wall clock, s, the caller's. */
#ifndef SENSOR_NODE_LIVE_PACE_H
#define SENSOR_NODE_LIVE_PACE_H

#include "sensor/frame/records.h"
#include "sensor/node/live/deadline.h"
#include "sensor/settings/config.h"

/* Since when it must have given up, or given up nothing, before that is said; and no beginning is said twice within
 * pace_remind_s. */
static const double pace_hold_s[2] = {5, 2}, pace_remind_s = 60;

typedef struct Pace {
    bool     on; /* quality.deadline */
    double   rate_hz;
    Deadline deadline;
    int      step;                   /* of the present frame, or the last; 0: in full */
    bool     chosen;                 /* the present frame has its step */
    double   chosen_s;               /* when that was */
    double   changed_s;              /* since when it gives up, or gives up nothing */
    bool     said;                   /* that it gives up */
    double   said_s;                 /* when that was last said; -INFINITY: never */
    char     host[dis_id_text_size]; /* of the last frame; empty: it was not there */
} Pace;

Pace pace_begin(const Config *config, double rate_hz);
/* The verdict (frame_verdict.h) of a frame of this host that was due gone_s ago. What other hosts' frames cost does not
 * count: the first one of a host is made at the cheapest step. */
unsigned pace_choose(Pace *pace, const char *host, double gone_s, double now_s);
/* The frame is done; shown: false, there was none, as the host was not there. Says when frames begin to give up, and
 * when they no longer do; once per change. */
void pace_done(Pace *pace, bool shown, double now_s);
/* `checkerboard`; NULL: in full. */
const char *pace_step_name(int step);
/* At the end: how many frames at each step, and its error. Nothing where none gave up. */
void pace_summary(const LiveCounters *counters);

#endif
