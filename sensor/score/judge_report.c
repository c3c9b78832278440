/* sensor/score/judge_report.c: what was summed up of a recogniser becomes its part of the report. */
#include "sensor/score/judge.h"
#include "sensor/frame/target_record.h"

#include <stdlib.h>

static void report_rates(ScoreRecogniser *out, const Judge *j)
{
    out->total = rates_of(&j->total, NAN, NAN);
    for (int b = 0; b < BAND_COUNT; b++) out->band[b] = rates_of(&j->band[b], NAN, NAN);
    for (int which = 0; which < AGAINST_COUNT; which++)
        for (int bin = 0; bin < score_bins_max; bin++) {
            const RateSums *sums = &j->against[which][bin];
            double          from, to;
            if (sums->all.chances == 0 && sums->all.frames == 0) continue;
            judge_bin_ends(&from, &to, (ScoreAgainst)which, bin);
            ScoreBins *bins = &out->against[which];
            bins->bin[bins->count++] = rates_of(sums, from, to);
        }
}

static double root(double sum2, long long count) { return count > 0 ? sqrt(sum2 / (double)count) : NAN; }
static double mean(double sum, long long count) { return count > 0 ? sum / (double)count : NAN; }

static void report_errors(ScoreErrors *out, const ErrorSums *e)
{
    *out = (ScoreErrors){.count = e->count,
                         .ranges = e->ranges,
                         .mean_px = {mean(e->px[0], e->count), mean(e->px[1], e->count)},
                         .rms_px = root(e->px2, e->count),
                         .rms_deg = root(e->deg2, e->count),
                         .range_mean_m = mean(e->range, e->ranges),
                         .range_rms_m = root(e->range2, e->ranges)};
}

static int by_age(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The least age that this share of all does not exceed. */
static double age_of_share(const Judge *j, double share)
{
    const size_t rank = (size_t)ceil(share * (double)j->ages);
    return (double)j->age_ms[rank > 0 ? rank - 1 : 0];
}

static void report_ages(ScoreAges *out, Judge *j)
{
    *out = (ScoreAges){.count = (long long)j->ages, .late = j->late, .median_ms = NAN, .p95_ms = NAN, .max_ms = NAN};
    if (j->ages == 0) return;
    qsort(j->age_ms, j->ages, sizeof *j->age_ms, by_age);
    out->median_ms = age_of_share(j, 0.5);
    out->p95_ms = age_of_share(j, 0.95);
    out->max_ms = age_of_share(j, 1);
}

static int by_frequency(const void *a, const void *b)
{
    const ScoreWord *x = a, *y = b;
    if (x->count != y->count) return x->count > y->count ? -1 : 1;
    return strcmp(x->word, y->word);
}

static Status report_words(ScoreRecogniser *out, const Answers *answers)
{
    if (answers->words == 0) return STATUS_OK;
    ScoreWord *sorted = malloc((size_t)answers->words * sizeof *sorted);
    if (!sorted) return STATUS_NO_MEMORY;
    memcpy(sorted, answers->word, (size_t)answers->words * sizeof *sorted);
    qsort(sorted, (size_t)answers->words, sizeof *sorted, by_frequency);
    out->words = answers->words < score_words_max ? answers->words : score_words_max;
    memcpy(out->word, sorted, (size_t)out->words * sizeof *sorted);
    free(sorted);
    return STATUS_OK;
}

/* Means over the classes that have a target; NaN: none has. */
static void report_means(ScoreRecogniser *out)
{
    double sum[3] = {0};
    int    count[2] = {0};
    for (int i = 0; i < out->classes; i++) {
        const ScorePrecision *p = &out->of_class[i].all;
        if (isfinite(p->ap)) sum[0] += p->ap, sum[1] += p->ap50, count[0]++;
        if (isfinite(p->ap_centre)) sum[2] += p->ap_centre, count[1]++;
    }
    out->map = count[0] ? sum[0] / count[0] : NAN;
    out->map50 = count[0] ? sum[1] / count[0] : NAN;
    out->ap_centre = count[1] ? sum[2] / count[1] : NAN;
}

static Status report_class(ScoreClass *out, const Judge *j, int class_number)
{
    ScorePrecision *all[1 + BAND_COUNT] = {&out->all};
    Status          status = precision_of(&out->all, &j->precision, class_number, BAND_COUNT);
    out->name = target_class_name(class_number);
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++) {
        all[1 + b] = &out->band[b];
        status = precision_of(&out->band[b], &j->precision, class_number, b);
    }
    for (int i = 0; i <= BAND_COUNT && j->answers->lines_of_sight && status == STATUS_OK; i++)
        all[i]->ap = all[i]->ap50 = all[i]->ap75 = NAN; /* without boxes there is no IoU */
    return status;
}

Status judge_report(ScoreRecogniser *out, Judge *j)
{
    Precision *p = &j->precision;
    out->answers = j->detections;
    out->aged = j->aged;
    out->ignored = j->ignored;
    out->bands = j->bands;
    out->lines_of_sight = j->answers->lines_of_sight;
    for (size_t i = 0; i < j->answers->count; i++) out->elsewhere += j->answers->one[i].found;
    out->elsewhere -= j->detections;
    report_rates(out, j);
    report_errors(&out->errors, &j->errors);
    report_ages(&out->ages, j);
    out->confusion = j->confusion;
    memcpy(out->on_clutter, j->on_clutter, sizeof out->on_clutter);
    out->tracks = j->track_score;
    out->missed = j->missed;
    out->false_alarms = j->false_alarms;
    precision_sort(p);
    out->points = precision_curve(out->curve, p, out->total.chances, out->total.frames);
    Status status = report_words(out, j->answers);
    for (int c = 1; c <= target_class_count() && status == STATUS_OK; c++) {
        long long any = 0;
        for (int b = 0; b < BAND_COUNT; b++) any += p->targets[c][b] + p->chances[c][b] + p->answers[c][b];
        if (any > 0) status = report_class(&out->of_class[out->classes++], j, c);
    }
    report_means(out);
    return status;
}
