/* What a live node gives up to keep its rate, and what it says of that: the beginning and the end, each once and not
 * for a moment; nothing with quality.deadline off. */
#include "tests/check.h"

#include "sensor/node/live/pace.h"
#include "sensor/node/session/frame_verdict.h"

static char lines[16][400];
static int  said;

static void listen(void *user, LogLevel level, const char *line)
{
    (void)user, (void)level;
    CHECK(said < 16);
    snprintf(lines[said++], sizeof lines[0], "%s", line);
}

/* Frames of five a second, each in time and at a cost of load intervals in full; the targets step and so on at the
 * table's share of it. From begun_s on; returns the end. */
static double go(Pace *p, const char *host, double load, int frames, double begun_s)
{
    static const double share[deadline_steps] = {1, 0.73, 0.6, 0.5};
    for (int k = 0; k < frames; k++) {
        const double due_s = begun_s + 0.2 * k;
        pace_choose(p, host, 0.005, due_s + 0.005);
        const double done_s = due_s + 0.005 + 0.2 * load * share[p->step];
        pace_done(p, true, done_s);
    }
    return begun_s + 0.2 * frames;
}

static void each_change_is_said_once(void **state)
{
    (void)state;
    const Config config = config_default();
    Pace         p = pace_begin(&config, 5);
    said = 0;
    log_set_sink(listen, NULL);
    double t_s = go(&p, "1:1:1", 0.5, 50, 1000);
    CHECK(said == 0 && p.step == 0); /* the start alone is no news */
    t_s = go(&p, "1:1:1", 1.4, 3, t_s);
    t_s = go(&p, "1:1:1", 0.5, 50, t_s);
    CHECK(said == 0); /* nor is a moment */
    t_s = go(&p, "1:1:1", 1.4, 100, t_s);
    CHECK(said == 1 && strstr(lines[0], "give up sampling to keep 5 a second: checkerboard") && p.step == 2);
    t_s = go(&p, "1:1:1", 0.5, 20, t_s);
    CHECK(said == 1 && p.step == 0);
    t_s = go(&p, "1:1:1", 0.5, 20, t_s);
    CHECK(said == 2 && strstr(lines[1], "5 frames a second are kept in full again"));
    /* again, within a minute of the first time: not said; later it is */
    t_s = go(&p, "1:1:1", 1.4, 50, t_s);
    CHECK(said == 2);
    go(&p, "1:1:1", 1.4, 300, t_s);
    CHECK(said == 3);
    log_set_sink(NULL, NULL);
}

static void another_host_begins_at_the_cheapest(void **state)
{
    (void)state;
    const Config config = config_default();
    Pace         p = pace_begin(&config, 5);
    CHECK(pace_choose(&p, "1:1:1", 0.005, 0) == VERDICT_QUARTER);
    pace_done(&p, true, 0.02);
    go(&p, "1:1:1", 0.5, 10, 1);
    CHECK(pace_choose(&p, "1:1:1", 0.005, 10) == 0);
    pace_done(&p, true, 10.1);
    CHECK(pace_choose(&p, "1:1:2", 0.005, 11) == VERDICT_QUARTER);
    pace_done(&p, true, 11.02);
    go(&p, "1:1:2", 0.5, 10, 12);
    pace_done(&p, false, 20); /* it is away */
    CHECK(pace_choose(&p, "1:1:2", 0.005, 21) == VERDICT_QUARTER);
}

static void off_gives_up_nothing(void **state)
{
    (void)state;
    Config config = config_default();
    CHECK(config.quality.deadline); /* on by default */
    config.quality.deadline = false;
    Pace p = pace_begin(&config, 5);
    CHECK(pace_choose(&p, "1:1:1", 5, 0) == 0);
    pace_done(&p, true, 9);
    CHECK(pace_choose(&p, "1:1:1", 5, 10) == 0);
}

/* Without rays at edges there are none to be spared. */
static void without_antialiasing_targets_are_no_step(void **state)
{
    (void)state;
    Config config = config_default();
    config.sensor.antialias = ANTIALIAS_OFF;
    Pace p = pace_begin(&config, 5);
    for (int k = 0; k < 300; k++) {
        CHECK(pace_choose(&p, "1:1:1", 0.005, k) != VERDICT_TARGETS);
        pace_done(&p, true, k + 0.01 * (k / 10));
    }
}

static void the_end_says_how_many_at_which_step(void **state)
{
    (void)state;
    LiveCounters c = {.frames_at = {20}};
    said = 0;
    log_set_sink(listen, NULL);
    pace_summary(&c);
    CHECK(said == 0);
    c.frames_at[SAMPLING_CHECKERBOARD] = 3;
    c.frames_at[SAMPLING_QUARTER] = 1;
    pace_summary(&c);
    log_set_sink(NULL, NULL);
    CHECK(said == 3 && strstr(lines[0], "4 of 24 frames") && strstr(lines[1], "3 checkerboard: ") &&
          strstr(lines[2], "1 quarter: ") && strstr(lines[1], " %"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_change_is_said_once),
        cmocka_unit_test(another_host_begins_at_the_cheapest),
        cmocka_unit_test(off_gives_up_nothing),
        cmocka_unit_test(without_antialiasing_targets_are_no_step),
        cmocka_unit_test(the_end_says_how_many_at_which_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
