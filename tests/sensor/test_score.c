/* Scores of answers made by hand: each expected number is counted by hand in a comment. */
#include "tests/sensor/score_fixture.h"

#include "sensor/frame/target_record.h"
#include "sensor/score/answers.h"

static const char lwir[] = "\"lwir\"";
static const int  small_box[4] = {100, 100, 108, 104}, large_box[4] = {300, 200, 340, 220};

static ScoreRecogniser *scored(ScoreReport *report, ScoreFolder *f, const ScoreRules *rules)
{
    score_folder_close(f);
    CHECK(score_folder_run(report, f, rules) == STATUS_OK);
    score_folder_remove(f);
    CHECK(report->recognisers == 1);
    return &report->recogniser[0];
}

static int class_row(const ScoreRecogniser *r, const char *name)
{
    for (int i = 0; i < r->classes; i++)
        if (strcmp(r->of_class[i].name, name) == 0) return i;
    fail_msg("no class %s", name);
    return -1;
}

/* One target of 20 px at (104, 102), one of 600 px at (320, 210), in three frames. */
static void three_frames(ScoreFolder *f)
{
    for (int frame = 0; frame < 3; frame++) {
        score_frame(f, frame, lwir);
        score_target(f, "", 1, "tank", small_box, 20);
        score_target(f, ",", 2, "truck", large_box, 600);
        score_frame_end(f);
    }
}

static void test_rates(void **state)
{
    (void)state;
    ScoreFolder f;
    ScoreReport report;
    score_folder_open(&f);
    three_frames(&f);
    /* frame 0: both, the second as a tank; and one that is nothing */
    fputs("{\"frame\":0,\"class\":\"tank\",\"box_px\":[101,101,109,105],\"score\":0.9,\"range_m\":1210,"
          "\"latency_ms\":12}\n"
          "{\"frame\":0,\"class\":\"tank\",\"box_px\":[300,200,340,220],\"score\":0.8,\"latency_ms\":14}\n"
          "{\"frame\":0,\"class\":\"Truck\",\"box_px\":[500,400,520,410],\"score\":0.7,\"latency_ms\":14}\n"
          /* frame 1: nothing was found; the second answer names the second target again, and is wrong */
          "{\"frame\":1,\"class\":\"truck\",\"box_px\":[300,200,340,220],\"score\":0.6,\"latency_ms\":20}\n"
          "{\"frame\":1,\"class\":\"truck\",\"box_px\":[301,200,341,220],\"score\":0.5,\"latency_ms\":20}\n"
          /* frame 2: not answered. Frame 7 is none of truth, nor is optical */
          "{\"frame\":7,\"class\":\"truck\",\"box_px\":[301,200,341,220],\"score\":0.5}\n",
          f.answers);
    const ScoreRecogniser *r = scored(&report, &f, NULL);
    CHECK(report.frames == 3 && report.sequences == 1 && !report.sweep);
    CHECK(r->answers == 5 && r->elsewhere == 1 && r->ignored == 0 && r->bands == 1u << BAND_LWIR);
    CHECK(r->total.chances == 6 && r->total.found == 3 && r->total.recognised == 2);
    CHECK(r->total.frames == 3 && r->total.frames_answered == 2 && r->total.false_alarms == 2);
    CHECK_NEAR(r->total.detection.value, 0.5, 0);
    CHECK_NEAR(r->total.per_frame.value, 2. / 3, 1e-15);
    CHECK_NEAR(r->total.per_deg2.value, 2. / 36, 1e-15);
    CHECK_NEAR(r->total.per_km2.value, 2 / 0.75, 1e-12);
    CHECK_NEAR(r->total.samples, 1, 1e-15);
    /* Wilson of 1/2 of one sample: 1/2 -+ sqrt(z^2 / 4 + z^4 / 4) / (1 + z^2) */
    CHECK_NEAR(r->total.detection.low, 0.5 - 0.5 * 1.959963984540054 / sqrt(1 + 3.841458820694124), 1e-12);
    const int tank = 0, truck = answers_class("truck") - 1, none = target_class_count();
    CHECK(r->confusion.count[tank][tank] == 1 && r->confusion.count[tank][none + 1] == 2);
    CHECK(r->confusion.count[truck][tank] == 1 && r->confusion.count[truck][truck] == 1);
    CHECK(r->confusion.count[truck][none + 1] == 1 && r->confusion.count[none][truck] == 2);
    /* centres: off by (1, 1), (0, 0), (0, 0) */
    CHECK(r->errors.count == 3 && r->errors.ranges == 1);
    CHECK_NEAR(r->errors.mean_px[0], 1. / 3, 1e-14);
    CHECK_NEAR(r->errors.rms_px, sqrt(2. / 3), 1e-14);
    CHECK_NEAR(r->errors.range_mean_m, 10, 1e-12);
    /* ages of answered frames: 14 and 20 */
    CHECK(r->ages.count == 2);
    CHECK_NEAR(r->ages.median_ms, 14, 0);
    CHECK_NEAR(r->ages.max_ms, 20, 0);
    /* bins: 1200 m; 20 and 600 px; aspect 350: about the nose; snr 4; noon */
    CHECK(r->against[AGAINST_RANGE].count == 1 && r->against[AGAINST_RANGE].bin[0].from == 1000);
    CHECK(r->against[AGAINST_PIXELS].count == 2 && r->against[AGAINST_PIXELS].bin[0].chances == 3);
    CHECK(r->against[AGAINST_PIXELS].bin[0].found == 1 && r->against[AGAINST_PIXELS].bin[0].frames == 0);
    CHECK(r->against[AGAINST_PIXELS].bin[1].frames == 3 && r->against[AGAINST_PIXELS].bin[1].false_alarms == 2);
    CHECK(r->against[AGAINST_ASPECT].bin[0].from == -22.5 && r->against[AGAINST_ASPECT].bin[0].chances == 6);
    CHECK(r->against[AGAINST_SNR].bin[0].from == 3 && r->against[AGAINST_HOUR].bin[0].from == 12);
    score_report_free(&report);
}

/* Three false alarms lie on clutter: one on a cow before a lorry, one beside a fire by half a pixel, one on what this
 * program knows no class of; one lies on nothing, and what names the target counts as right, clutter or not. */
static void test_on_clutter(void **state)
{
    (void)state;
    ScoreFolder f;
    ScoreReport report;
    score_folder_open(&f);
    score_frame(&f, 0, lwir);
    score_target(&f, "", 1, "tank", large_box, 600);
    fputs(
        "],\"clutter\":[{\"class\":\"lorry\",\"box_px\":[20,20,60,40]},{\"class\":\"animal\",\"box_px\":[30,25,36,30]},"
        "{\"class\":\"fire\",\"box_px\":[400,100,402,102]},{\"class\":\"yeti\",\"box_px\":[500,100,520,120]},"
        "{\"class\":\"van\",\"box_px\":[300,200,340,220]}]}\n",
        f.truth);
    score_frame(&f, 1, lwir); /* as products without clutter are */
    score_frame_end(&f);
    fputs("{\"frame\":0,\"class\":\"tank\",\"box_px\":[300,200,340,220],\"score\":0.9}\n"
          "{\"frame\":0,\"class\":\"tank\",\"box_px\":[31,26,35,29],\"score\":0.8}\n"
          "{\"frame\":0,\"class\":\"tank\",\"box_px\":[402,100,403,102],\"score\":0.7}\n"
          "{\"frame\":0,\"class\":\"tank\",\"box_px\":[505,105,515,115],\"score\":0.6}\n"
          "{\"frame\":0,\"class\":\"tank\",\"box_px\":[600,400,610,410],\"score\":0.6}\n"
          "{\"frame\":1,\"class\":\"tank\",\"box_px\":[31,26,35,29],\"score\":0.6}\n",
          f.answers);
    const ScoreRecogniser *r = scored(&report, &f, NULL);
    CHECK(r->total.found == 1 && r->total.false_alarms == 5);
    for (int k = CLUTTER_NONE + 1; k < CLUTTER_CLASSES; k++)
        CHECK(r->on_clutter[k] == (k == CLUTTER_ANIMAL || k == CLUTTER_FIRE));
    score_report_free(&report);
}

/* Answers of score 0.9 right, 0.8 wrong, 0.7 right, of two targets: precision 1 up to recall 1/2, then 2/3: of 101
 * recalls 51 and 50. The boxes are exact, so that every IoU has this. */
static void test_average_precision(void **state)
{
    (void)state;
    ScoreFolder f;
    ScoreReport report;
    score_folder_open(&f);
    for (int frame = 0; frame < 2; frame++) {
        score_frame(&f, frame, lwir);
        score_target(&f, "", 1, "tank", large_box, 600);
        score_frame_end(&f);
    }
    fputs("{\"frame\":1,\"class\":\"tank\",\"box_px\":[300,200,340,220],\"score\":0.7}\n"
          "{\"frame\":0,\"class\":\"tank\",\"box_px\":[10,10,20,20],\"score\":0.8}\n"
          "{\"frame\":0,\"class\":\"tank\",\"box_px\":[300,200,340,220],\"score\":0.9}\n"
          "{\"frame\":0,\"class\":\"apc\",\"box_px\":[300,200,340,220],\"score\":0.95}\n",
          f.answers);
    const ScoreRecogniser *r = scored(&report, &f, NULL);
    const ScoreClass      *tank = &r->of_class[class_row(r, "tank")], *apc = &r->of_class[class_row(r, "apc")];
    const double           want = (51 + 50 * 2. / 3) / 101;
    CHECK(tank->all.targets == 2 && tank->all.answers == 3);
    CHECK_NEAR(tank->all.ap, want, 1e-12);
    CHECK_NEAR(tank->all.ap50, want, 1e-12);
    CHECK_NEAR(tank->all.ap75, want, 1e-12);
    CHECK_NEAR(tank->all.ap_centre, want, 1e-12);
    CHECK_NEAR(tank->band[BAND_LWIR].ap, want, 1e-12);
    CHECK(apc->all.targets == 0 && apc->all.answers == 1 && isnan(apc->all.ap));
    CHECK_NEAR(r->map, want, 1e-12);
    /* whatever the class: the apc names the tank of frame 0 first; the tank's own answer is wrong then */
    CHECK(r->points == 4 && r->total.found == 2 && r->total.recognised == 1 && r->total.false_alarms == 2);
    CHECK_NEAR(r->curve[0].precision, 1, 0);
    CHECK_NEAR(r->curve[1].precision, 0.5, 0);
    CHECK_NEAR(r->curve[3].recall, 1, 0);
    CHECK_NEAR(r->curve[3].false_per_frame, 1, 0);
    score_report_free(&report);
}

/* The rule at its edges: a small target 8 px wide at 104: grown by a quarter it ends 5 px from the centre; 4 high:
 * grown by an eighth of 4 on each side it would end at 2.5, as half a pixel does. A large one 40 x 20: moved by d px
 * its IoU is (40 - d) / (40 + d), 0.3 at d = 40 * 0.7 / 1.3 = 21.54. */
static void test_edges(void **state)
{
    (void)state;
    static const struct {
        double dx, dy;
        bool   small, found;
    } cases[] = {{4.99, 0, true, true},   {5.01, 0, true, false}, {0, -2.49, true, true},
                 {0, 2.51, true, false},  {21.5, 0, false, true}, {21.6, 0, false, false},
                 {-21.5, 0, false, true}, {0, 10.7, false, true}, {0, 10.8, false, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ScoreFolder f;
        ScoreReport report;
        const int  *box = cases[i].small ? small_box : large_box;
        score_folder_open(&f);
        score_frame(&f, 3, lwir);
        score_target(&f, "", 1, "tank", box, cases[i].small ? 20 : 600);
        score_frame_end(&f);
        fprintf(f.answers, "{\"frame\":3,\"class\":\"tank\",\"box_px\":[%.3f,%.3f,%.3f,%.3f]}\n", box[0] + cases[i].dx,
                box[1] + cases[i].dy, box[2] + cases[i].dx, box[3] + cases[i].dy);
        const ScoreRecogniser *r = scored(&report, &f, NULL);
        if (r->total.found != cases[i].found || r->total.false_alarms == cases[i].found)
            fail_msg("moved by %g, %g: found %lld", cases[i].dx, cases[i].dy, r->total.found);
        score_report_free(&report);
    }
}

/* Of two targets that are equally near, the answer names that of the lower id, which stands second here: the truck. */
static void test_equally_near(void **state)
{
    (void)state;
    static const int left[4] = {100, 100, 110, 106}, right[4] = {104, 100, 114, 106};
    ScoreFolder      f;
    ScoreReport      report;
    score_folder_open(&f);
    score_frame(&f, 0, lwir);
    score_target(&f, "", 9, "tank", left, 40);
    score_target(&f, ",", 3, "truck", right, 40);
    score_frame_end(&f);
    fputs("{\"frame\":0,\"class\":\"truck\",\"box_px\":[102,100,112,106]}\n", f.answers);
    const ScoreRecogniser *r = scored(&report, &f, NULL);
    CHECK(r->total.chances == 2 && r->total.found == 1 && r->total.recognised == 1);
    score_report_free(&report);
}

/* Ages 1 to 21 ms in some order: the least that half, and 95 %, do not exceed are the 11th and the 20th. */
static void test_ages(void **state)
{
    (void)state;
    ScoreFolder f;
    ScoreReport report;
    score_folder_open(&f);
    for (int frame = 0; frame < 21; frame++) {
        score_frame(&f, frame, lwir);
        score_frame_end(&f);
        fprintf(f.answers, "{\"frame\":%d,\"latency_ms\":%d,\"late\":%s}\n", frame, 1 + frame * 5 % 21,
                frame % 10 == 3 ? "true" : "false");
    }
    const ScoreRecogniser *r = scored(&report, &f, NULL);
    CHECK(r->answers == 0 && r->total.frames_answered == 21 && r->ages.count == 21 && r->ages.late == 2);
    CHECK_NEAR(r->ages.median_ms, 11, 0);
    CHECK_NEAR(r->ages.p95_ms, 20, 0);
    CHECK_NEAR(r->ages.max_ms, 21, 0);
    score_report_free(&report);
}

/* Neither right nor wrong: on a target of 4 px (below 5), on a hidden one, within a small one's region. */
static void test_ignored(void **state)
{
    (void)state;
    ScoreFolder f;
    ScoreReport report;
    score_folder_open(&f);
    score_frame(&f, 0, lwir);
    score_target(&f, "", 1, "tank", small_box, 4);
    score_target(&f, ",", 2, "truck", large_box, 0);
    score_frame_end(&f);
    fputs("{\"frame\":0,\"class\":\"tank\",\"box_px\":[100,100,108,104]}\n"
          "{\"frame\":0,\"class\":\"truck\",\"box_px\":[300,200,340,220]}\n"
          "{\"frame\":0,\"class\":\"truck\",\"box_px\":[300,200,304,204]}\n"
          "{\"frame\":0,\"class\":\"truck\",\"box_px\":[10,200,14,204]}\n",
          f.answers);
    const ScoreRecogniser *r = scored(&report, &f, NULL);
    CHECK(r->total.chances == 0 && r->ignored == 3 && r->total.false_alarms == 1);
    CHECK(isnan(r->total.detection.value) && isnan(r->map));
    score_report_free(&report);
}

static void test_rules(void **state)
{
    (void)state;
    const char *const lines =
        "{\"frame\":0,\"class\":\"tank\",\"box_px\":[101,101,109,105],\"score\":0.9,\"latency_ms\":12}\n"
        "{\"frame\":0,\"class\":\"truck\",\"box_px\":[300,200,340,220],\"score\":0.3,\"latency_ms\":12}\n"
        "{\"frame\":1,\"class\":\"truck\",\"box_px\":[300,200,340,220],\"score\":0.8,\"latency_ms\":90}\n";
    ScoreRules rules[4];
    for (int i = 0; i < 4; i++) rules[i] = score_default_rules();
    rules[0].least_score = 0.5; /* one less */
    rules[1].max_age_ms = 50;   /* frame 1 is not answered */
    rules[2].answered = true;   /* frame 2 does not count */
    rules[3].small_px = 1000;   /* the larger one by its centre */
    static const struct {
        long long chances, found, frames, answered, aged;
    } want[4] = {{6, 2, 3, 2, 0}, {6, 2, 3, 1, 1}, {4, 3, 2, 2, 0}, {6, 3, 3, 2, 0}};
    for (int i = 0; i < 4; i++) {
        ScoreFolder f;
        ScoreReport report;
        score_folder_open(&f);
        three_frames(&f);
        fputs(lines, f.answers);
        const ScoreRecogniser *r = scored(&report, &f, &rules[i]);
        if (r->total.chances != want[i].chances || r->total.found != want[i].found ||
            r->total.frames != want[i].frames || r->total.frames_answered != want[i].answered ||
            r->aged != want[i].aged)
            fail_msg("rules %d: chances %lld, found %lld, frames %lld, answered %lld, aged %lld", i, r->total.chances,
                     r->total.found, r->total.frames, r->total.frames_answered, r->aged);
        CHECK(r->curve[0].score == 0.9 && r->total.false_alarms == 0);
        score_report_free(&report);
    }
}

/* Of many scores 101 points are kept, evenly, the highest and the lowest among them. */
static void test_curve(void **state)
{
    (void)state;
    ScoreFolder f;
    ScoreReport report;
    score_folder_open(&f);
    for (int frame = 0; frame < 1000; frame++) {
        score_frame(&f, frame, lwir);
        score_target(&f, "", 1, "tank", large_box, 600);
        score_frame_end(&f);
        /* right where even; the score falls with the frame's number */
        fprintf(f.answers, "{\"frame\":%d,\"class\":\"tank\",\"box_px\":[%d,200,%d,220],\"score\":%.3f}\n", frame,
                frame % 2 ? 10 : 300, frame % 2 ? 50 : 340, (1000 - frame) / 1000.);
    }
    const ScoreRecogniser *r = scored(&report, &f, NULL);
    CHECK(r->points == score_curve_max && r->curve[0].score == 1 && r->curve[100].score == 0.001);
    for (int i = 0; i < r->points; i++) {
        const double answers = round(1000 * (1 - r->curve[i].score)) + 1, right = ceil(answers / 2);
        CHECK_NEAR(r->curve[i].recall, right / 1000, 1e-12);
        CHECK_NEAR(r->curve[i].precision, right / answers, 1e-12);
        CHECK_NEAR(r->curve[i].false_per_frame, (answers - right) / 1000, 1e-12);
        if (i > 0) CHECK_NEAR(r->curve[i - 1].score - r->curve[i].score, 0.01, 0.00101);
    }
    score_report_free(&report);
}

/* A line of sight: the camera looks north along ecef z from 0 N 0 E, x to the east, so that azimuth turns right and
 * elevation up; focal length 320 / tan 2 degrees. */
static void test_lines_of_sight(void **state)
{
    (void)state;
    const double focal = 320 / tan(2 * rad_per_deg);
    ScoreFolder  f;
    ScoreReport  report;
    score_folder_open(&f);
    three_frames(&f);
    const double azimuth = atan((320.5 - 320) / focal) / rad_per_deg;
    const double up = atan((240 - 209) / hypot(focal, 0.5)) / rad_per_deg;
    fprintf(f.answers, "{\"frame\":0,\"class\":\"truck\",\"los_deg\":[%.12f,%.12f]}\n", azimuth, up);
    fprintf(f.answers, "{\"frame\":1,\"class\":\"truck\",\"los_deg\":[%.12f,%.12f]}\n", azimuth + 180, up); /* behind */
    const ScoreRecogniser *r = scored(&report, &f, NULL);
    CHECK(r->lines_of_sight && r->total.found == 1 && r->total.false_alarms == 1);
    CHECK_NEAR(r->errors.mean_px[0], 0.5, 1e-6);
    CHECK_NEAR(r->errors.mean_px[1], -1, 1e-6);
    const ScorePrecision *truck = &r->of_class[class_row(r, "truck")].all;
    CHECK(isnan(truck->ap) && isfinite(truck->ap_centre) && isnan(r->map));
    score_report_free(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rates),
        cmocka_unit_test(test_on_clutter),
        cmocka_unit_test(test_average_precision),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_ignored),
        cmocka_unit_test(test_equally_near),
        cmocka_unit_test(test_ages),
        cmocka_unit_test(test_rules),
        cmocka_unit_test(test_curve),
        cmocka_unit_test(test_lines_of_sight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
