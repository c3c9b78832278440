/* What frames of a live node give up: chosen before they are rendered, noted in the recording, obeyed by a replay to
 * the bit; and notes: written into a recording, read back by number and time; what is no such note, or is spoilt, is
 * passed over. */
#include "tests/sensor/eye_lab.h"

#include "dis/capture/log.h"
#include "dis/capture/recorder.h"
#include "sensor/node/session/frame_verdict.h"

enum { notes_size = 4096 };

/* ---- notes ------------------------------------------------------------------------------------------------------- */

static void notes_come_back(void **state)
{
    (void)state;
    static const int      number[5] = {7, 3, 2000000000, 0, 3};
    static const double   t_s[5] = {1.75, 1368.333333, 0.1, -0.5, 1368.333333};
    static const unsigned given_up[5] = {VERDICT_COARSE_RADAR, VERDICT_NO_RADAR, VERDICT_NO_TARGET_GRIDS,
                                         VERDICT_NO_RADAR, VERDICT_NO_TARGET_GRIDS};
    static const uint8_t  pdu[12] = {7, 1, 1, 1, [9] = 12};
    char                  path[80], text[frame_verdict_text_size];
    DisRecorder          *r;
    DisLog                log;
    FrameVerdicts        *v;
    snprintf(path, sizeof path, "/tmp/pitviper-verdict-%d.pcapng", (int)getpid());
    CHECK(dis_recorder_open(&r, path, "a test") == STATUS_OK);
    for (int i = 0; i < 5; i++) {
        CHECK(dis_recorder_add(r, 1000000000 * (int64_t)(i + 1), NULL, 3000, pdu, sizeof pdu) == STATUS_OK);
        frame_verdict_text(text, given_up[i], number[i], t_s[i]);
        CHECK(dis_recorder_note(r, 1000000000 * (int64_t)(i + 1) + 1, text) == STATUS_OK);
        CHECK(dis_recorder_note(r, 1000000000 * (int64_t)(i + 1) + 2, "another note") == STATUS_OK);
    }
    CHECK(dis_recorder_close(r) == STATUS_OK);
    CHECK(dis_log_open(&log, path, dis_port_default) == STATUS_OK && log.count == 5 && !log.truncated);
    CHECK(frame_verdicts_read(&v, log.notes) == STATUS_OK && v);
    for (int i = 0; i < 5; i++) {
        const unsigned want = number[i] == 3 ? VERDICT_NO_RADAR | VERDICT_NO_TARGET_GRIDS : given_up[i];
        CHECK(frame_verdicts_of(v, number[i], t_s[i]) == want &&
              frame_verdicts_of(v, number[i], t_s[i] + 1e-6) == want);
        CHECK(frame_verdicts_of(v, number[i], t_s[i] + 0.25) == 0 && frame_verdicts_of(v, number[i] - 1, t_s[i]) == 0);
    }
    frame_verdicts_free(v);
    dis_log_close(&log);
    unlink(path);

    /* pcap has no place for them */
    snprintf(path, sizeof path, "/tmp/pitviper-verdict-%d.pcap", (int)getpid());
    CHECK(dis_recorder_open(&r, path, NULL) == STATUS_OK);
    CHECK(dis_recorder_note(r, 5, text) == STATUS_UNSUPPORTED);
    CHECK(dis_recorder_close(r) == STATUS_OK);
    unlink(path);
}

/* Recordings of earlier versions have this text. */
static void the_note_of_the_radar_is_as_it_was(void **state)
{
    (void)state;
    char           text[frame_verdict_text_size];
    FrameVerdicts *v;
    frame_verdict_text(text, VERDICT_NO_RADAR, 5, 1);
    assert_string_equal(text, "pitviper: no radar in frame 5 at 1.000000 s");
    CHECK(frame_verdicts_read(&v, "x\npitviper: no radar in frame 5 at 1.000000 s") == STATUS_OK &&
          frame_verdicts_of(v, 5, 1) == VERDICT_NO_RADAR);
    frame_verdicts_free(v);
    CHECK(frame_verdicts_read(&v, NULL) == STATUS_OK && !v && frame_verdicts_of(v, 5, 1) == 0);
}

/* Each step of sampling has a note and a bit of its own; of what a frame gives up beside it truth.jsonl names all. */
static void steps_of_sampling(void **state)
{
    (void)state;
    static const char *const note[] = {NULL, "targets alone refined", "ground sampled as a checkerboard",
                                       "ground sampled by quarters"};
    static const char *const name[] = {"", "targets", "checkerboard", "quarter"};
    char     text[frame_verdict_text_size], want[frame_verdict_text_size], names[frame_verdict_names_size];
    unsigned all = VERDICT_NO_RADAR | VERDICT_NO_TARGET_GRIDS;
    for (int step = SAMPLING_ALL; step <= SAMPLING_QUARTER; step++) {
        const unsigned verdict = frame_verdict_of_sampling((Sampling)step);
        RenderRequest  request = {.target_samples = 48};
        frame_verdict_names(names, verdict);
        assert_string_equal(names, name[step]);
        frame_verdict_apply(&request, verdict);
        CHECK((int)request.sampling == step && request.target_samples == 48);
        CHECK((all & verdict) == 0);
        all |= verdict;
        if (step == SAMPLING_ALL) {
            CHECK(verdict == 0);
            continue;
        }
        frame_verdict_text(text, verdict, 12, 34.5);
        snprintf(want, sizeof want, "pitviper: %s in frame 12 at 34.500000 s", note[step]);
        assert_string_equal(text, want);
        FrameVerdicts *v;
        CHECK(frame_verdicts_read(&v, text) == STATUS_OK && frame_verdicts_of(v, 12, 34.5) == verdict);
        frame_verdicts_free(v);
        frame_verdict_names(names, verdict | VERDICT_NO_RADAR | VERDICT_NO_TARGET_GRIDS);
        snprintf(want, sizeof want, "target_grids,%s", name[step]);
        assert_string_equal(names, want);
    }
    CHECK(all == 31); /* 32 is the radar's */
    frame_verdict_names(names, all);
    CHECK(strlen(names) + 1 < frame_verdict_names_size);
}

static const char *const spoilt[] = {"",
                                     "\n\n",
                                     "pitviper: no radar in frame",
                                     "pitviper: no radar in frame 5 at nan s\n",
                                     "pitviper: no radar in frame -5 at 1.000000 s\n",
                                     "pitviper: no radar in frame 5 at 1e300 s\n",
                                     "pitviper: no radar in frame 5 at 1.000000 s and more\n",
                                     "pitviper: no radar in frame 99999999999 at 1.000000 s\n",
                                     " pitviper: no radar in frame 5 at 1.000000 s\n",
                                     "pitviper: no radar  in frame 5 at 1.000000 s\n",
                                     "pitviper: no light in frame 5 at 1.000000 s\n",
                                     "pitviper: targets alone in frame 5 at 1.000000 s\n",
                                     "pitviper: ground sampled by quarters in frame 5 at 1 s\n",
                                     "pitviper: ground sampled as a checkerboard in frame 5\n",
                                     "pitviper:  in frame 5 at 1.000000 s\n",
                                     "pitviper: no grids of small targets in frame 5.5 at 1.000000 s\n",
                                     "pitviper: no grids of small targets in frame 5 at 1.0000000 s\n",
                                     "pitviper: no grids of small targets in frame 5 in frame 5 at 1.000000 s\n",
                                     "pitviper: no radarno grids of small targets in frame 5 at 1.000000 s\n",
                                     "pitviper: no radar in frame 0x5 at 1.000000 s\r\n"};

static void spoilt_notes_are_passed_over(void **state)
{
    (void)state;
    FrameVerdicts *v = NULL;
    for (size_t i = 0; i < sizeof spoilt / sizeof *spoilt; i++)
        CHECK(frame_verdicts_read(&v, spoilt[i]) == STATUS_OK && !v);

    /* a note with one octet changed, taken out or put in: its words are whole, or it is none */
    char note[frame_verdict_text_size], text[2 * frame_verdict_text_size];
    frame_verdict_text(note, VERDICT_NO_TARGET_GRIDS, 25, 101.25);
    const size_t length = strlen(note);
    int          read = 0;
    for (uint32_t k = 0; k < 20000; k++) {
        const size_t at = (size_t)(random_uniform(7, 1, k, 0) * (double)length);
        const char   octet = (char)(1 + random_uniform(7, 1, k, 1) * 254);
        const int    how = (int)(random_uniform(7, 1, k, 2) * 3);
        snprintf(text, sizeof text, "%.*s%s%s\n", (int)at, note, how == 2 ? "" : (char[2]){octet, 0},
                 note + at + (how != 1));
        CHECK(frame_verdicts_read(&v, text) == STATUS_OK);
        read += v != NULL;
        CHECK(!v || (strstr(text, "pitviper: no grids of small targets in frame ") && strstr(text, " s\n")));
        frame_verdicts_free(v);
    }
    CHECK(read > 0 && read < 4000);
}

/* ---- a session --------------------------------------------------------------------------------------------------- */

enum { frames = 8 };

/* A clock by which frames 2 and 5 are half a second late. */
typedef struct LateClock {
    FrameClock clock;
    int        made;
    double     origin;
} LateClock;

static ClockAnswer late_next(FrameTime *out, FrameClock *clock)
{
    const LateClock *c = (const LateClock *)clock;
    *out = (FrameTime){.number = c->made, .t_s = (c->origin + c->made) / 4};
    return c->made < frames ? CLOCK_DUE : CLOCK_END;
}

static ClockAnswer late_wait(FrameTime *frame, FrameClock *clock)
{
    (void)clock;
    frame->late_s = frame->number == 2 || frame->number == 5 ? 0.5 : 0;
    return CLOCK_DUE;
}

static void late_done(FrameClock *clock, const FrameTime *frame)
{
    (void)frame;
    ((LateClock *)clock)->made++;
}

static char recorded[notes_size];
static int  asked;

static void record(void *user, const char *text)
{
    (void)user;
    const size_t n = strlen(recorded);
    snprintf(recorded + n, sizeof recorded - n, "%s\n", text);
}

/* Asked once for each frame, before it is rendered. */
static unsigned choose(void *user, const FrameTime *frame)
{
    (void)user;
    CHECK(frame->number == asked && lab.shots == asked &&
          (lab.shots == 0 || frame->t_s == lab.shot[asked - 1].t_s + 0.25));
    asked++;
    return frame->late_s > 0.25 ? VERDICT_NO_TARGET_GRIDS : 0;
}

static void run(char hash[frames][sha256_text_size], const Config *config)
{
    lab_run(config, 0.5, 4, frames);
    CHECK(lab.shots == frames && lab.result.listed == frames);
    for (int k = 0; k < frames; k++) memcpy(hash[k], lab.result.hash[k], sha256_text_size);
}

static void a_late_frame_gives_up_and_its_replay_too(void **state)
{
    (void)state;
    char   full[frames][sha256_text_size], live[frames][sha256_text_size], again[frames][sha256_text_size];
    char   notes[2 * notes_size] = "";
    Config config = config_default();
    strcpy(config.exercise.host, "observer");
    lab_forget();
    for (int k = 0; k <= 4; k++) {
        LabReport r = {.t_s = 100 + k, .entity = 1, .type = {1, 1, 225, 1, 1, 1, 0}, .p_enu = {3.0 * k, 0, 1}};
        r.v_enu_mps[0] = 3;
        test_attitude(r.r_enu_from_body, 0.5 * pi_rad, 0, 0);
        lab_say(&r);
    }
    lab.adaptive = true;
    run(full, &config);
    CHECK(lab.result.frames_reduced == 0);

    LateClock late = {.clock = {late_next, late_wait, late_done, NULL}, .origin = 4 * lab.shot[0].t_s};
    lab.clock = &late.clock, lab.live = true, lab.note = record, lab.choose = choose;
    run(live, &config);
    CHECK(asked == frames && lab.result.frames_reduced == 2);
    for (int k = 0; k < frames; k++) {
        const bool reduced = k == 2 || k == 5;
        CHECK(*full[k] && (strcmp(full[k], live[k]) != 0) == reduced);
        CHECK((lab.shot[k].target_samples == 0) == reduced);
        assert_string_equal(lab.shot[k].given_up, reduced ? "target_grids" : "");
    }
    char want[notes_size];
    snprintf(want, sizeof want,
             "pitviper: no grids of small targets in frame 2 at %.6f s\n"
             "pitviper: no grids of small targets in frame 5 at %.6f s\n",
             lab.shot[2].t_s, lab.shot[5].t_s);
    assert_string_equal(recorded, want);

    /* played, among spoilt notes: nobody is asked, and the frames are the live ones */
    lab.clock = NULL, lab.live = false, lab.note = NULL;
    for (size_t i = 0; i < sizeof spoilt / sizeof *spoilt; i++) strcat(strcat(notes, spoilt[i]), "\n");
    lab.notes = strcat(notes, recorded);
    run(again, &config);
    CHECK(asked == frames && lab.result.frames_reduced == 2);
    for (int k = 0; k < frames; k++) CHECK(strcmp(again[k], live[k]) == 0);
    lab.notes = NULL, lab.choose = NULL, lab.adaptive = false;
}

enum { many_frames = 120 };

/* Each third frame gives up something else: steps up and down, alone and with the grids of small targets. */
static unsigned by_turns(int number)
{
    static const unsigned turn[] = {VERDICT_QUARTER,
                                    0,
                                    VERDICT_TARGETS,
                                    VERDICT_NO_TARGET_GRIDS,
                                    VERDICT_CHECKERBOARD,
                                    VERDICT_QUARTER | VERDICT_NO_TARGET_GRIDS,
                                    VERDICT_CHECKERBOARD | VERDICT_NO_TARGET_GRIDS};
    return turn[number / 3 % (int)(sizeof turn / sizeof *turn)];
}

static unsigned choose_by_turns(void *user, const FrameTime *frame)
{
    (void)user;
    return by_turns(frame->number);
}

static char many_notes[120 * many_frames * 2];

static void record_many(void *user, const char *text)
{
    (void)user;
    const size_t n = strlen(many_notes);
    snprintf(many_notes + n, sizeof many_notes - n, "%s\n", text);
}

static RenderRequest asked_for[many_frames];
static int           looked;

static void look(void *user, const Frame *frame)
{
    (void)user;
    CHECK(looked < many_frames);
    asked_for[looked++] = frame->request;
}

static void run_many(char hash[many_frames][sha256_text_size], const Config *config)
{
    looked = 0;
    lab_run(config, 0.5, 30, many_frames);
    CHECK(looked == many_frames && lab.result.listed == many_frames);
    for (int k = 0; k < many_frames; k++) memcpy(hash[k], lab.result.hash[k], sha256_text_size);
}

/* A hundred and twenty frames whose steps change each third: the notes bring back each request and each plane. */
static void steps_that_change_all_the_time_come_back(void **state)
{
    (void)state;
    static char full[many_frames][sha256_text_size], live[many_frames][sha256_text_size],
        again[many_frames][sha256_text_size];
    Config config = config_default();
    strcpy(config.exercise.host, "observer");
    lab.adaptive = true, lab.look = look;
    run_many(full, &config);
    lab.live = true, lab.note = record_many, lab.choose = choose_by_turns;
    run_many(live, &config);
    static RenderRequest as_live[many_frames];
    memcpy(as_live, asked_for, sizeof as_live);
    const int reduced = lab.result.frames_reduced;
    lab.live = false, lab.note = NULL, lab.choose = NULL, lab.notes = many_notes;
    run_many(again, &config);
    CHECK(lab.result.frames_reduced == reduced);
    int want = 0, other = 0;
    for (int k = 0; k < many_frames; k++) {
        const unsigned verdict = by_turns(k);
        want += verdict != 0;
        other += strcmp(full[k], live[k]) != 0;
        CHECK(strcmp(live[k], again[k]) == 0);
        CHECK(as_live[k].sampling == asked_for[k].sampling && as_live[k].target_samples == asked_for[k].target_samples);
        CHECK(frame_verdict_of_sampling(asked_for[k].sampling) ==
              (verdict & (VERDICT_TARGETS | VERDICT_CHECKERBOARD | VERDICT_QUARTER)));
        if (verdict == 0) CHECK(strcmp(full[k], live[k]) == 0); /* nothing of what was given up before is left */
        if (verdict & VERDICT_NO_TARGET_GRIDS) CHECK(strcmp(full[k], live[k]) != 0);
    }
    CHECK(reduced == want && other >= want / 3);
    /* the twin: without notes those frames are others */
    lab.notes = NULL;
    run_many(again, &config);
    int differ = 0;
    for (int k = 0; k < many_frames; k++) differ += strcmp(live[k], again[k]) != 0;
    CHECK(differ == other && differ > 0);
    lab.adaptive = false, lab.look = NULL;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(notes_come_back),
        cmocka_unit_test(the_note_of_the_radar_is_as_it_was),
        cmocka_unit_test(steps_of_sampling),
        cmocka_unit_test(spoilt_notes_are_passed_over),
        cmocka_unit_test(a_late_frame_gives_up_and_its_replay_too),
        cmocka_unit_test(steps_that_change_all_the_time_come_back),
    };
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
