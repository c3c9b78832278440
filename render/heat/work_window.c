/* render/heat/work_window.c: see work_window.h. */
#include "render/heat/work_window.h"

static int place_of(double tick) { return ((int)fmod(tick, window_ticks) + window_ticks) % window_ticks; }

void work_window_open(WorkWindow *w, double t_s)
{
    const double tick = floor(t_s * 100 + 0.5);
    w->metered = w->metered || (w->started && tick != w->tick);
    w->started = true;
    if (tick - w->tick >= window_ticks) memset(w->spent_us, 0, sizeof w->spent_us);
    for (double k = fmax(w->tick + 1, tick - window_ticks + 1); k <= tick; k++) w->spent_us[place_of(k)] = 0;
    w->tick = tick;
}

bool work_window_take(WorkWindow *w, double us, double limit_us)
{
    double spent_us = 0;
    for (int k = 0; k < window_ticks; k++) spent_us += w->spent_us[k];
    if (w->metered && spent_us > 0 && spent_us + us > limit_us) return false;
    w->spent_us[place_of(w->tick)] += us;
    return true;
}

void work_window_spend(WorkWindow *w, double us) { w->spent_us[place_of(w->tick)] += us; }
