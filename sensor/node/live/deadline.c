/* sensor/node/live/deadline.c: the step of sampling of a live frame, from the times of those before it. */
#include "sensor/node/live/deadline.h"

/* Share by which ratios return to the table's with each frame: a wrong one is tried again after some 500 frames. */
static const double relax = 0.002;
/* A measured ratio changes by no more than this factor at once. */
static const double most_change = 2;

Deadline deadline_begin(double rate_hz, const double ratio[deadline_steps])
{
    Deadline d = {.interval_s = 1 / rate_hz};
    memcpy(d.table, ratio, sizeof d.table);
    memcpy(d.ratio, ratio, sizeof d.ratio);
    deadline_forget(&d);
    return d;
}

void deadline_forget(Deadline *d)
{
    d->known = d->frames = d->room = d->room_step = d->since_up = d->still = 0;
    d->step = deadline_steps - 1;
    d->patience = deadline_patience_start;
    d->before = (DeadlineFrame){0};
}

static double at_full(const Deadline *d, int i) { return d->recent[i].cost_s / d->ratio[d->recent[i].step]; }

/* Usual cost of a frame at step 0, s: the median of the last ones, so that one slow frame does not count. */
static double usual_s(const Deadline *d)
{
    const double a = at_full(d, 0), b = d->known > 1 ? at_full(d, 1) : a, c = d->known > 2 ? at_full(d, 2) : fmax(a, b);
    return fmax(fmin(a, b), fmin(fmax(a, b), c));
}

/* The same for the next frame: that of the last one alone where it was not done in time and cost more. A load that
 * rises is met with the next frame. */
static double next_s(const Deadline *d)
{
    return d->recent[0].cost_s > d->left_s ? fmax(usual_s(d), at_full(d, 0)) : usual_s(d);
}

/* The first step that costs no more. */
static int first_within(const Deadline *d, double full_s, double most_s)
{
    int step = 0;
    while (step < deadline_steps - 1 && full_s * d->ratio[step] > most_s) step++;
    return step;
}

/* Learns what the step before costs over the present one, which was taken while the load was steady. Those below it
 * keep their share of it. */
static void learn(Deadline *d, double cost_s)
{
    const int    j = d->before.step, k = d->step;
    const double change = d->before.cost_s / cost_s * d->ratio[k] / d->ratio[j];
    const double by = fmin(fmax(change, 1 / most_change), most_change);
    for (int i = j; i < deadline_steps; i++) d->ratio[i] *= by;
    for (int i = 1; i < deadline_steps; i++) d->ratio[i] = fmin(d->ratio[i], d->ratio[i - 1]);
    for (int i = j - 1; i > k; i--) d->ratio[i] = fmax(d->ratio[i], d->ratio[j]);
}

static void go_down(Deadline *d, int step)
{
    /* one slow frame is no reason to doubt the step above */
    const bool doubt = first_within(d, usual_s(d), (1 - deadline_margin) * d->interval_s) > d->step;
    if (d->before.cost_s > 0 && d->since_up == 1) learn(d, d->recent[0].cost_s);
    if (doubt && d->frames >= deadline_start && d->since_up < deadline_trial)
        d->patience = d->patience < deadline_patience_most / 2 ? 2 * d->patience : deadline_patience_most;
    d->step = step;
    d->room = d->still = 0;
    d->before = (DeadlineFrame){0};
}

static void go_up(Deadline *d, int step)
{
    const bool settled = d->known == deadline_recent && d->recent[2].step == d->step && d->recent[1].step == d->step;
    d->before = (DeadlineFrame){d->step, settled ? usual_s(d) * d->ratio[d->step] : 0};
    d->step = step;
    d->room = d->still = d->since_up = 0;
}

/* A step above has to have room in some frames on end. */
static void stay_or_go_up(Deadline *d, int step, double full_s, double gone_s)
{
    d->still++;
    if (step < d->step) {
        d->room_step = d->room && d->room_step > step ? d->room_step : step;
        if (++d->room >= d->patience) go_up(d, d->room_step);
        return;
    }
    d->room = 0;
    const double most_s = (1 + deadline_try) * d->interval_s - gone_s;
    int          above = d->step - 1;
    while (above > 0 && d->ratio[above - 1] <= d->ratio[above]) above--; /* what costs the same gives up less */
    if (d->still >= deadline_still && first_within(d, full_s, most_s) < d->step) go_up(d, above);
}

int deadline_choose(Deadline *d, double gone_s)
{
    const double budget_s = (1 - deadline_margin) * d->interval_s - gone_s;
    if (d->known > 0) {
        const double full_s = next_s(d);
        const int    fits = first_within(d, full_s, budget_s);
        if (fits > d->step) go_down(d, fits);
        else stay_or_go_up(d, first_within(d, full_s, budget_s - deadline_hysteresis * d->interval_s), full_s, gone_s);
    }
    d->left_s = d->interval_s - gone_s;
    return d->step;
}

void deadline_done(Deadline *d, double cost_s)
{
    if (!(cost_s > 0)) cost_s = 1e-9;
    memmove(d->recent + 1, d->recent, (deadline_recent - 1) * sizeof *d->recent);
    d->recent[0] = (DeadlineFrame){d->step, cost_s};
    if (d->known < deadline_recent) d->known++;
    for (int i = 1; i < deadline_steps; i++) d->ratio[i] += relax * (d->table[i] - d->ratio[i]);
    /* the second frame after a step up: the smaller of both, since one may be slow by chance */
    if (d->before.cost_s > 0 && d->since_up == 1) {
        if (d->recent[1].step == d->step) learn(d, fmin(d->recent[1].cost_s, cost_s));
        d->before = (DeadlineFrame){0};
    }
    if (d->frames < deadline_start && ++d->frames == deadline_start) d->patience = deadline_patience;
    if (++d->since_up % (4 * deadline_trial) == 0 && d->patience > deadline_patience) d->patience /= 2;
}
