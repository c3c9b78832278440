/* render/heat/work_window.h: an account of work in pieces: no more than a limit in any 0.1 s of exercise time, in
 * units that are the same on every machine.
 *
 * Ticks are of 10 ms. Before the second one nothing is limited. In an empty window there is room for any piece. */
#ifndef RENDER_HEAT_WORK_WINDOW_H
#define RENDER_HEAT_WORK_WINDOW_H

#include "pitviper.h"

enum { window_ticks = 10 };

typedef struct WorkWindow {
    double tick, spent_us[window_ticks]; /* the last; work of those up to it, in turn */
    bool   started, metered;             /* metered: after the first tick */
} WorkWindow;

/* At a time not before the last. */
void work_window_open(WorkWindow *window, double t_s);
/* Whether there is room for a piece in this tick; then it is counted. */
bool work_window_take(WorkWindow *window, double us, double limit_us);
/* Counts what a piece that is done came to beyond that. */
void work_window_spend(WorkWindow *window, double us);

#endif
