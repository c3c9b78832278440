/* The one loop over frames, with the clocks of a recording and of a live node, and with one of this test's own that
 * runs at half speed (etc/ADDING.md, "A clock", shows it): frame times and lateness against hand-made lists. */
#include "tests/adding_snippet.h"
#include "tests/sensor/eye_lab.h"

#include "dis/network/udp.h"
#include "sensor/node/clock/live_clock.h"

/* ---- a clock of one's own: this struct and these four functions, in this file alone ------------------------------ */

/* Exercise time goes at half the speed of a wall that is this test's own; no frame is dropped. A frame is said to be
 * late where its work began after it was due. */
typedef struct HalfClock {
    FrameClock clock;
    FrameGrid  grid;
    int        last;           /* number of the last frame */
    int        made, late;     /* frames so far; of them late */
    double     wall_s, from_s; /* the wall's time; exercise time where it was 0 */
} HalfClock;

static double half_wall_s(const FrameClock *clock, double t_s)
{
    return 2 * (t_s - ((const HalfClock *)clock)->from_s);
}

static ClockAnswer half_next(FrameTime *out, FrameClock *clock)
{
    const HalfClock *c = (const HalfClock *)clock;
    *out = (FrameTime){.number = c->made, .t_s = frame_grid_s(&c->grid, c->made)};
    return c->made > c->last ? CLOCK_END : CLOCK_DUE;
}

static ClockAnswer half_wait(FrameTime *frame, FrameClock *clock)
{
    HalfClock   *c = (HalfClock *)clock;
    const double due_s = half_wall_s(clock, frame->t_s);
    frame->late_s = c->wall_s - due_s;
    if (frame->late_s >= 0) return CLOCK_DUE;
    c->wall_s = fmin(due_s, c->wall_s + 0.125);
    return CLOCK_EARLY;
}

static void half_done(FrameClock *clock, const FrameTime *frame)
{
    HalfClock *c = (HalfClock *)clock;
    c->late += frame->late_s > 0;
    c->made++;
}

static HalfClock half_clock(double from_s, double rate_hz, int frames)
{
    return (HalfClock){.clock = {half_next, half_wait, half_done, half_wall_s},
                       .grid = {from_s * rate_hz, rate_hz},
                       .last = frames - 1,
                       .from_s = from_s};
}

/* ---- what the loop did ------------------------------------------------------------------------------------------- */

enum { most = 64 };

typedef struct Made {
    int        count, idles;
    int        number[most];
    double     t_s[most], late_s[most], wall_s[most];
    double     begun_s[most]; /* of the half clock's wall, as wall_s is of the true one */
    uint64_t   dropped[most];
    double     cost_s[most]; /* of frame n, on that wall */
    int        stop_idles;   /* over after so many idles, and frames; 0: never */
    int        stop_frames, fail_frame;
    HalfClock *half;
} Made;

static bool over(void *user)
{
    const Made *m = user;
    return (m->stop_idles && m->idles >= m->stop_idles) || (m->stop_frames && m->count >= m->stop_frames);
}

static Status idle(void *user, const FrameTime *next)
{
    (void)next;
    ((Made *)user)->idles++;
    return STATUS_OK;
}

static Status make(void *user, const FrameTime *frame)
{
    Made     *m = user;
    const int i = m->count++;
    CHECK(i < most);
    m->wall_s[i] = wall_clock_s();
    m->number[i] = frame->number, m->t_s[i] = frame->t_s;
    m->late_s[i] = frame->late_s, m->dropped[i] = frame->dropped;
    if (m->half) m->begun_s[i] = m->half->wall_s;
    if (m->half) m->half->wall_s += m->cost_s[i];
    return m->fail_frame && m->count == m->fail_frame ? STATUS_IO : STATUS_OK;
}

static bool run_loop(Made *m, FrameClock *clock, Status want)
{
    bool ended_over = true;
    assert_int_equal(frame_loop(&ended_over, &(FrameLoop){clock, over, idle, make, m}), want);
    return ended_over;
}

/* Four frames a second of exercise are due each half second of the wall. The third takes 1.25 s: the two after it begin
 * late, by 0.75 and 0.375 s, and the sixth is on time again. */
static void half_speed_by_hand(void **state)
{
    (void)state;
    static const double t_s[6] = {100, 100.25, 100.5, 100.75, 101, 101.25}, begun_s[6] = {0, 0.5, 1, 2.25, 2.375, 2.5},
                        late_s[6] = {0, 0, 0, 0.75, 0.375, 0};
    HalfClock half = half_clock(100, 4, 6);
    Made      m = {.half = &half, .cost_s = {0.125, 0.125, 1.25, 0.125, 0.125, 0.125}};
    CHECK(clock_on_wall(&half.clock) && half.clock.wall_s(&half.clock, 101.25) == 2.5);
    CHECK(!run_loop(&m, &half.clock, STATUS_OK));
    CHECK(m.count == 6 && half.late == 2 && half.made == 6);
    for (int i = 0; i < 6; i++)
        CHECK(m.number[i] == i && m.t_s[i] == t_s[i] && m.begun_s[i] == begun_s[i] && m.late_s[i] == late_s[i]);
    CHECK(m.idles == 3 + 3); /* eighths of a second before the second and third frame; no time before the others */
}

/* Over while it waits for the third frame; and at a frame that fails, which is not done. */
static void the_loop_ends_where_it_should(void **state)
{
    (void)state;
    HalfClock half = half_clock(0, 4, 6);
    Made      m = {.half = &half, .stop_idles = 5};
    CHECK(run_loop(&m, &half.clock, STATUS_OK) && m.count == 2 && m.idles == 5);
    half = half_clock(0, 4, 6);
    m = (Made){.half = &half, .stop_frames = 4};
    CHECK(run_loop(&m, &half.clock, STATUS_OK) && m.count == 4 && half.made == 4);
    half = half_clock(0, 4, 6);
    m = (Made){.half = &half, .stop_frames = 6}; /* there is no further frame to be stopped before */
    CHECK(!run_loop(&m, &half.clock, STATUS_OK) && m.count == 6);
    half = half_clock(0, 4, 6);
    m = (Made){.half = &half, .fail_frame = 3};
    CHECK(!run_loop(&m, &half.clock, STATUS_IO) && m.count == 3 && half.made == 2);
}

/* The same frames of a session, to the bit of their hashes, by the recording's clock and by one at half speed. */
static void a_session_by_half_speed(void **state)
{
    (void)state;
    enum { frames = 5 };
    char   hash[frames][sha256_text_size];
    Config config = config_default();
    lab_forget();
    for (int k = 0; k <= 4; k++) {
        LabReport r = {.t_s = 100 + k, .entity = 1, .type = {1, 1, 225, 1, 1, 1, 0}, .p_enu = {3.0 * k, 0, 1}};
        r.v_enu_mps[0] = 3;
        test_attitude(r.r_enu_from_body, 0.5 * pi_rad, 0, 0);
        lab_say(&r);
    }
    strcpy(config.exercise.host, "observer");
    lab_run(&config, 0.5, 4, frames);
    CHECK(lab.shots == frames && lab.result.listed == frames);
    for (int k = 0; k < frames; k++) memcpy(hash[k], lab.result.hash[k], sizeof hash[k]);
    HalfClock half = half_clock(lab.shot[0].t_s, 4, frames);
    lab.clock = &half.clock;
    lab_run(&config, 0.5, 4, frames);
    lab.clock = NULL;
    CHECK(lab.shots == frames && half.made == frames && half.late == 0);
    CHECK(half.wall_s == 0.5 * (frames - 1));
    for (int k = 0; k < frames; k++) CHECK(*hash[k] && strcmp(hash[k], lab.result.hash[k]) == 0);
}

/* ---- the clock of a recording ------------------------------------------------------------------------------------ */

static void a_recording_has_all_its_frames(void **state)
{
    (void)state;
    static const int only[3] = {4, 7, 9};
    LogClock         clock = log_clock(INFINITY);
    Made             m = {0};
    CHECK(!clock_on_wall(&clock.clock));
    log_clock_begin(&clock, &(LogSpan){{20, 4}, 3, 9, NULL, 0, NAN});
    CHECK(!run_loop(&m, &clock.clock, STATUS_OK) && m.count == 7 && m.idles == 0);
    for (int i = 0; i < 7; i++) CHECK(m.number[i] == 3 + i && m.t_s[i] == 5.75 + 0.25 * i && m.late_s[i] == 0);
    m = (Made){0};
    log_clock_begin(&clock, &(LogSpan){{20, 4}, 3, 9, only, 3, NAN});
    CHECK(!run_loop(&m, &clock.clock, STATUS_OK) && m.count == 3);
    for (int i = 0; i < 3; i++) CHECK(m.number[i] == only[i] && m.t_s[i] == 5 + 0.25 * only[i]);
    m = (Made){0};
    log_clock_begin(&clock, &(LogSpan){{20, 4}, 3, 3, NULL, 0, 5.8125});
    CHECK(!run_loop(&m, &clock.clock, STATUS_OK) && m.count == 1 && m.number[0] == 3 && m.t_s[0] == 5.8125);
}

/* Twice as fast as recorded: frame n of 8 Hz is due n/16 s after the first. None begins before, by this test's own look
 * at the wall, and all are made. */
static void a_paced_recording_waits(void **state)
{
    (void)state;
    LogClock clock = log_clock(2);
    Made     m = {0};
    CHECK(clock_on_wall(&clock.clock));
    const double begun_s = wall_clock_s();
    log_clock_begin(&clock, &(LogSpan){{80, 8}, 0, 9, NULL, 0, NAN});
    CHECK(clock.begun_s >= begun_s);
    CHECK_NEAR(clock.clock.wall_s(&clock.clock, 11) - clock.begun_s, 0.5, 1e-9);
    CHECK(!run_loop(&m, &clock.clock, STATUS_OK) && m.count == 10 && m.idles >= 8);
    for (int i = 0; i < 10; i++) {
        CHECK(m.number[i] == i && m.late_s[i] >= 0 && m.dropped[i] == 0);
        CHECK(m.wall_s[i] >= clock.begun_s + i / 16.0);
    }
}

/* ---- the clock of a live node ------------------------------------------------------------------------------------ */

/* A report came ten seconds ago: of 100 Hz the first frame that is made is the newest due, frame 1000 and a few. The
 * next that it makes after two were passed over says how many. */
static void a_live_node_makes_the_newest(void **state)
{
    (void)state;
    Player     *player;
    LiveClock   live = live_clock();
    FrameTime   frame;
    DisDatagram report;
    lab_forget();
    LabReport r = {.t_s = 100, .entity = 1, .type = {1, 1, 225, 1, 1, 1, 0}, .p_enu = {0, 0, 1}};
    test_attitude(r.r_enu_from_body, 0, 0, 0);
    lab_say(&r);
    report = lab.datagram[0];
    report.capture_s = report.packet_s = dis_unix_s(dis_udp_now_ns()) - 10;
    assert_int_equal(player_create(&player, -1, true), STATUS_OK);
    assert_int_equal(player_add(player, &report, true), STATUS_OK);
    const double t0_s = player_time_s(player, report.capture_s), rate_hz = 100;
    live.grid = (FrameGrid){ceil(t0_s * rate_hz), rate_hz};
    live.to_s = NAN;
    live.player = player;
    const double before_s = player_time_s(player, dis_unix_s(dis_udp_now_ns()));
    CHECK(live.clock.next(&frame, &live.clock) == CLOCK_DUE);
    const double after_s = player_time_s(player, dis_unix_s(dis_udp_now_ns()));
    CHECK(frame.t_s <= after_s && frame.t_s > before_s - 1.001 / rate_hz && frame.number >= 990);
    CHECK(live.clock.wait(&frame, &live.clock) == CLOCK_DUE && frame.late_s > 0 && frame.dropped == 0);
    CHECK(live_clock_behind(&live) == 0); /* of a run without a frame nothing was dropped */
    live.clock.done(&live.clock, &frame);
    live.last -= 3; /* as if two frames had come and gone since */
    CHECK(live_clock_behind(&live) >= 3);
    CHECK(live.clock.wait(&frame, &live.clock) == CLOCK_DUE && frame.dropped == 2);
    live.last += 3;

    /* the next one is waited for, in turns of a tenth of a second */
    live.grid = (FrameGrid){ceil(after_s) + 2, 1};
    live.last = -1, live.first = 0;
    CHECK(live.clock.next(&frame, &live.clock) == CLOCK_DUE && frame.number == 0 && frame.t_s == ceil(after_s) + 2);
    CHECK(live.clock.wait(&frame, &live.clock) == CLOCK_EARLY && frame.late_s < 0);
    live.to_s = ceil(after_s) + 1;
    CHECK(live.clock.next(&frame, &live.clock) == CLOCK_END);
    player_destroy(player);
}

static void adding_shows_the_half_clock(void **state)
{
    (void)state;
    check_adding_snippet("clock", "tests/sensor/test_clocks.c");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_speed_by_hand),          cmocka_unit_test(the_loop_ends_where_it_should),
        cmocka_unit_test(a_session_by_half_speed),     cmocka_unit_test(a_recording_has_all_its_frames),
        cmocka_unit_test(a_paced_recording_waits),     cmocka_unit_test(a_live_node_makes_the_newest),
        cmocka_unit_test(adding_shows_the_half_clock),
    };
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
