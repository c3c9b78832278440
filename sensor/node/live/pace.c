/* sensor/node/live/pace.c: what each frame of a live node gives up to keep its rate, and what is said of that. */
#include "sensor/node/live/pace.h"

#include "sensor/node/session/frame_verdict.h"

/* Cost of each step over that of the first, and errors that it adds, rms of a pixel in visible light, % of the mean.
 *
 * Source: `pitviper bench precision`, "steps of sampling" (bare ground, vehicles in 8-12 um, woods, a flight), and two
 * frames of the demonstration at 360 x 243; etc/reference/speed.md has all. The ratios are the medians. They spread
 * from 0.51 to 0.88, from 0.40 to 0.68 and from 0.30 to 0.63, by how much of a frame is its targets, which are whole at
 * every step, and not by bare ground or woods: there is no row for each. A ratio that is too large is put right with
 * the first step up (deadline.c), one that is too small keeps frames at a step below until one above is tried. */
static const struct {
    const char *name;
    double      ratio;
    const char *error;
} ladder[deadline_steps] = {
    [SAMPLING_ALL] = {NULL, 1, ""},
    [SAMPLING_TARGETS] = {"targets", 0.73, "borders of ground 21 % (in full 7 to 9), horizon 2 to 15 % (1 to 5)"},
    [SAMPLING_CHECKERBOARD] = {"checkerboard", 0.6,
                               "woods 10 to 30 % (in full 8 to 26), borders of ground 20 % (7 to 9)"},
    [SAMPLING_QUARTER] = {"quarter", 0.5,
                          "woods 12 to 34 % (in full 8 to 26), ground 7 % (5), borders of ground 20 to 30 % (7 to 9)"},
};

const char *pace_step_name(int step) { return ladder[step].name; }

Pace pace_begin(const Config *config, double rate_hz)
{
    Pace   p = {.on = config->quality.deadline, .rate_hz = rate_hz, .said_s = -INFINITY};
    double ratio[deadline_steps];
    for (int i = 0; i < deadline_steps; i++) ratio[i] = ladder[i].ratio;
    if (!config_adaptive(config)) ratio[SAMPLING_TARGETS] = 1; /* no border is refined anyway */
    p.deadline = deadline_begin(rate_hz, ratio);
    return p;
}

unsigned pace_choose(Pace *p, const char *host, double gone_s, double now_s)
{
    if (!p->on) return 0;
    const int was = p->step;
    if (strcmp(p->host, host) != 0) deadline_forget(&p->deadline);
    snprintf(p->host, sizeof p->host, "%s", host);
    p->step = deadline_choose(&p->deadline, gone_s);
    p->chosen = true;
    p->chosen_s = now_s;
    if ((was > 0) != (p->step > 0)) p->changed_s = now_s;
    return frame_verdict_of_sampling((Sampling)p->step);
}

static void report(Pace *p, double now_s)
{
    const bool gives = p->step > 0;
    if (!p->on || gives == p->said || now_s - p->changed_s < pace_hold_s[gives]) return;
    if (!gives) {
        log_info("run: %g frames a second are kept in full again", p->rate_hz);
        p->said = false;
    } else if (now_s - p->said_s >= pace_remind_s) {
        log_info(
            "run: frames give up sampling to keep %g a second: %s; what targets touch is sampled in full. A smaller "
            "--size, fewer --bands or a lower --rate keeps all; quality.deadline=off leaves frames out instead",
            p->rate_hz, ladder[p->step].name);
        p->said = true;
        p->said_s = now_s;
    }
}

void pace_done(Pace *p, bool shown, double now_s)
{
    report(p, now_s);
    if (p->chosen) deadline_done(&p->deadline, now_s - p->chosen_s);
    if (!shown) *p->host = 0;
    p->chosen = false;
}

void pace_summary(const LiveCounters *c)
{
    uint64_t reduced = 0;
    for (int i = 1; i < deadline_steps; i++) reduced += c->frames_at[i];
    if (reduced == 0) return;
    log_info("run: %llu of %llu frames gave up sampling to be in time (quality.deadline); rms errors of a pixel:",
             (unsigned long long)reduced, (unsigned long long)(reduced + c->frames_at[0]));
    for (int i = 1; i < deadline_steps; i++)
        if (c->frames_at[i])
            log_info("run:   %llu %s: %s", (unsigned long long)c->frames_at[i], ladder[i].name, ladder[i].error);
}
