/* tests/sensor/score_example.h: a report with some of everything, of one to four recognisers. */
#ifndef TESTS_SENSOR_SCORE_EXAMPLE_H
#define TESTS_SENSOR_SCORE_EXAMPLE_H

#include "sensor/frame/target_record.h"
#include "sensor/score/interval.h"
#include "sensor/score/score.h"

#include <stdlib.h>

static inline ScoreShare example_share(double share, double samples)
{
    const Interval i = interval_of_share(share, samples);
    return (ScoreShare){share, i.low, i.high};
}

static inline ScoreRates example_rates(double from, double to, double share, long long chances, double false_a_frame)
{
    ScoreRates r = {.from = from, .to = to, .chances = chances, .found = llround(share * (double)chances)};
    r.recognised = r.found * 4 / 5;
    r.frames = 2 * chances;
    r.frames_answered = 2 * chances - 3;
    r.false_alarms = llround(false_a_frame * (double)r.frames);
    r.sequences = 24;
    r.samples = fmin(24, (double)chances / 10);
    r.detection = example_share((double)r.found / (double)chances, r.samples);
    r.recognition = example_share((double)r.recognised / (double)chances, r.samples);
    const Interval i = interval_of_count(false_a_frame, r.samples, 1);
    r.per_frame = (ScoreShare){false_a_frame, i.low, i.high};
    r.per_deg2 = r.per_km2 = (ScoreShare){NAN, NAN, NAN};
    return r;
}

static inline void example_recogniser(ScoreRecogniser *r, int k)
{
    static const double edges[AGAINST_COUNT][9] = {
        {0, 250, 500, 1000, 2000, 4000, 8000, 16000, NAN},
        {0, 3, 10, 30, 100, 300, 1000, 3000, 10000},
        {-22.5, 22.5, 67.5, 112.5, 157.5, 202.5, 247.5, 292.5, 337.5},
        {0, 0.1, 0.25, 0.5, 0.75, 0.9, 1},
        {0, 0.05, 0.1, 0.25, 0.5, 0.75, 1},
        {0, 0.5, 1, 2, 3, 5, 10, 20, 50},
        {0, 3, 6, 9, 12, 15, 18, 21, 24},
    };
    static const char *const name[] = {"yolo-small", "baseline_2025", "track_net", "threshold"};
    const double             skill = 1 - 0.13 * k;
    *r = (ScoreRecogniser){.answers = 18204 - 911 * k,
                           .elsewhere = 3,
                           .aged = 12 * k,
                           .ignored = 402,
                           .bands = 1u << BAND_LWIR | 1u << BAND_MWIR};
    snprintf(r->name, sizeof r->name, "%s", name[k]);
    snprintf(r->file, sizeof r->file, "runs/answers/%s.jsonl", name[k]);
    r->total = example_rates(NAN, NAN, 0.78 * skill, 9120, 0.31 + 0.4 * k);
    r->band[BAND_LWIR] = example_rates(NAN, NAN, 0.83 * skill, 4560, 0.2 + 0.3 * k);
    r->band[BAND_MWIR] = example_rates(NAN, NAN, 0.73 * skill, 4560, 0.42 + 0.5 * k);
    for (int w = 0; w < AGAINST_COUNT; w++) {
        const int bins = w == AGAINST_VISIBLE || w == AGAINST_FOLIAGE ? 6 : 8;
        for (int i = 0; i < bins; i++) {
            if (w == AGAINST_RANGE && (i == 0 || i == 3)) continue; /* a gap */
            const double at = (i + 0.5) / bins;
            const double share = w == AGAINST_RANGE || w == AGAINST_FOLIAGE ? 1 / (1 + exp(7 * (at - 0.6 * skill)))
                                 : w == AGAINST_ASPECT                      ? skill * (0.7 + 0.2 * cos(4 * pi_rad * at))
                                 : w == AGAINST_HOUR ? skill * (0.75 - 0.2 * cos(4 * pi_rad * at))
                                                     : 1 / (1 + exp(-8 * (at - 0.4 / skill)));
            r->against[w].bin[r->against[w].count++] =
                example_rates(edges[w][i], edges[w][i + 1], share, 60 + 300 * (i + 1) / (1 + abs(i - 3)), 0.3);
        }
    }
    r->map = 0.52 * skill, r->map50 = 0.71 * skill, r->ap_centre = 0.74 * skill;
    static const int classes[] = {1, 2, 3, 5, 8};
    for (int i = 0; i < 5; i++) {
        ScoreClass *c = &r->of_class[r->classes++];
        c->name = target_class_name(classes[i]);
        c->all = (ScorePrecision){1200 - 200 * i,
                                  1100 - 150 * i,
                                  skill * (0.6 - 0.05 * i),
                                  skill * (0.8 - 0.05 * i),
                                  skill * (0.55 - 0.07 * i),
                                  skill * (0.82 - 0.04 * i)};
        for (int j = 0; j < 5; j++)
            r->confusion.count[classes[i] - 1][classes[j] - 1] = i == j ? 900 - 150 * i : (7 * i + 13 * j + 5 * k) % 40;
        r->confusion.count[classes[i] - 1][target_class_count() + 1] = 120 + 60 * i;
        r->confusion.count[target_class_count()][classes[i] - 1] = 40 + 10 * i;
    }
    r->confusion.count[classes[1] - 1][target_class_count()] = 17;
    r->errors = (ScoreErrors){7113,
                              k ? 0 : 7000,
                              {0.31 - 0.2 * k, -0.12 + 0.1 * k},
                              1.4 + 0.3 * k,
                              0.021,
                              k ? (double)NAN : 12,
                              k ? (double)NAN : 88};
    if (k != 2) r->ages = (ScoreAges){18000, 3, 41.5 + 8 * k, 77.1, 210};
    for (int i = 0; i < 60; i++) {
        const double recall = 0.97 * skill * (i + 1) / 60;
        r->curve[r->points++] =
            (ScorePoint){1 - i / 60.0, recall, 1 - 0.5 * pow(recall / skill, 6), i < 2 ? 0 : 0.002 * exp(0.12 * i)};
    }
    if (k == 3) return; /* without tracks and cases */
    r->tracks = (TracksScore){.sequences = 24,
                              .frames = 7200,
                              .present = 9120,
                              .answers = 8800,
                              .idtp = (uint64_t)(6900 * skill),
                              .matched = 7113,
                              .switches = 31 + 20 * (uint64_t)k,
                              .fragmentations = 77,
                              .truths = 96,
                              .truths_found = 90,
                              .mostly_tracked = 61,
                              .mostly_lost = 9,
                              .delay_s = 120,
                              .delay_s_most = 9.4,
                              .tracks = 140,
                              .tracks_false = 21,
                              .purity = 109,
                              .length = 8200,
                              .length_most = 300,
                              .hidings = 44,
                              .coasts = 30,
                              .coast_frames = 201,
                              .coast_held = 122,
                              .coast_most = 21,
                              .coast_similarity = 98,
                              .returns = 33,
                              .resumed = 25};
    for (int i = 0; i < 7; i++) {
        WorstCase c = {.frame = i,
                       .band = i % 2 ? BAND_LWIR : BAND_MWIR,
                       .t_s = 0.1 * i,
                       .box_px = {300 + 20 * i, 200 + 8 * i, 40 + i, 22},
                       .weight = 900 - 31 * i,
                       .range_m = 1200 + 300 * i,
                       .visible_fraction = 0.9 - 0.1 * i,
                       .snr = 4.1 - 0.6 * i};
        snprintf(c.sequence, sizeof c.sequence, "%s", "");
        snprintf(c.name, sizeof c.name, "%s", target_class_name(1 + i % 3));
        snprintf(c.id, sizeof c.id, "1:3001:%d", 41 + i);
        worst_add(&r->missed, &c);
        c.weight = 0.97 - 0.05 * i;
        c.id[0] = 0;
        c.track = (uint32_t)(i % 3 * 17);
        c.frame += 26 * i;
        worst_add(&r->false_alarms, &c);
    }
}

/* The caller frees report->recogniser. */
static inline ScoreReport example_report(int recognisers)
{
    ScoreReport report = {
        .rules = score_default_rules(), .sweep = true, .sequences = 24, .frames = 7200, .recognisers = recognisers};
    snprintf(report.out, sizeof report.out, "%s", "out-sweep");
    report.class_count = target_class_count();
    report.recogniser = calloc((size_t)recognisers, sizeof *report.recogniser);
    for (int k = 0; report.recogniser && k < recognisers; k++) example_recogniser(&report.recogniser[k], k);
    return report;
}

#endif
