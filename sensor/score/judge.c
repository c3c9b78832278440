/* sensor/score/judge.c: judges the answers of a frame: rates, confusion, errors, ages. */
#include "sensor/score/judge_private.h"
#include "sensor/frame/target_record.h"
#include "sensor/score/grown.h"

#include <stdlib.h>

/* ---- lists ----------------------------------------------------------------------------------------- */

static Status make_room(Judge *j, size_t targets, size_t answers)
{
    Status status = STATUS_OK;
    if (targets > INT32_MAX / 4 || answers > INT32_MAX / 4) return STATUS_NO_MEMORY;
    if (targets > (size_t)j->room) {
        j->target = grown(&status, j->target, 2 * targets, sizeof *j->target);
        if (status == STATUS_OK) j->room = (int)(2 * targets);
    }
    if (status != STATUS_OK || answers <= (size_t)j->answer_room) return status;
    j->centre = grown(&status, j->centre, 2 * answers, sizeof *j->centre);
    j->any = grown(&status, j->any, 2 * answers, sizeof *j->any);
    j->young = grown(&status, j->young, 2 * answers, sizeof *j->young);
    if (status == STATUS_OK) j->answer_room = (int)(2 * answers);
    return status;
}

/* ---- ages ------------------------------------------------------------------------------------------- */

/* Drops those that are too old, into j->young; returns how many are left. */
static size_t drop_old(Judge *j, const Answer *answer, size_t count)
{
    size_t young = 0;
    for (size_t i = 0; i < count; i++) {
        const bool old = answer[i].latency_ms > j->rules.max_age_ms;
        j->aged += old && answer[i].found;
        if (!old) j->young[young++] = answer[i];
    }
    return young;
}

/* The age of an answered frame: that of its last answer. */
static Status note_age(Judge *j, const Answer *answer, size_t count)
{
    float oldest = NAN;
    bool  late = false;
    for (size_t i = 0; i < count; i++) {
        oldest = fmaxf(oldest, answer[i].latency_ms);
        late |= answer[i].late;
    }
    if (isnan(oldest)) return STATUS_OK;
    if (j->ages == j->ages_room) {
        const size_t room = j->ages_room ? 2 * j->ages_room : 1024;
        Status       status = STATUS_OK;
        j->age_ms = grown(&status, j->age_ms, room, sizeof *j->age_ms);
        if (status != STATUS_OK) return status;
        j->ages_room = room;
    }
    j->age_ms[j->ages++] = oldest;
    j->late += late;
    return STATUS_OK;
}

/* ---- what is counted of a frame and band ------------------------------------------------------------- */

typedef struct BandFrame {
    const TruthFrame *frame;
    Band              band;
    bool              answered;
    int               counting; /* answers whose score counts: the first of the list */
} BandFrame;

static double value_of(ScoreAgainst which, const TruthTarget *t, const BandFrame *of)
{
    switch (which) {
    case AGAINST_RANGE:
        return t->range_m;
    case AGAINST_PIXELS:
        return t->pixels;
    case AGAINST_ASPECT:
        return t->aspect_deg;
    case AGAINST_VISIBLE:
        return t->visible;
    case AGAINST_FOLIAGE:
        return t->foliage;
    case AGAINST_SNR:
        return fabs(t->snr[of->band]);
    case AGAINST_HOUR:
        return of->frame->hour;
    case AGAINST_COUNT:
        break;
    }
    return NAN;
}

static void count_chance(Judge *j, const MatchTarget *t, const BandFrame *of, const Answer *by)
{
    const bool right = by && by->class_number == t->truth->class_number;
    RateSums  *sums[2 + AGAINST_COUNT] = {&j->total, &j->band[of->band]};
    int        count = 2;
    for (int which = 0; which < AGAINST_COUNT; which++) {
        const int bin = judge_bin((ScoreAgainst)which, value_of((ScoreAgainst)which, t->truth, of));
        if (bin >= 0) sums[count++] = &j->against[which][bin];
    }
    for (int i = 0; i < count; i++) {
        sums[i]->now.chances++;
        sums[i]->now.found += by != NULL;
        sums[i]->now.recognised += right;
    }
    const int classes = target_class_count();
    const int column = !by ? classes + 1 : by->class_number ? by->class_number - 1 : classes;
    j->confusion.count[t->truth->class_number - 1][column]++;
}

static void count_frame_in(RateSums *sums, const BandFrame *of, long long wrong)
{
    RateCounts *now = &sums->now;
    now->frames++;
    now->answered += of->answered;
    now->false_alarms += wrong;
    now->deg2 += of->frame->deg2;
    if (isnan(of->frame->km2)) return;
    now->frames_km2++;
    now->false_km2 += wrong;
    now->km2 += of->frame->km2;
}

/* A frame is in the bins of its largest chance. */
static void count_frame(Judge *j, const BandFrame *of, long long wrong)
{
    const MatchTarget *main = NULL;
    for (int i = 0; i < j->match.targets; i++) {
        const MatchTarget *t = &j->match.target[i];
        if (t->verdict != TARGET_TO_FIND) continue;
        if (!main || t->truth->pixels > main->truth->pixels) main = t;
    }
    count_frame_in(&j->total, of, wrong);
    count_frame_in(&j->band[of->band], of, wrong);
    for (int which = 0; which < AGAINST_COUNT; which++) {
        const double value = main                    ? value_of((ScoreAgainst)which, main->truth, of)
                             : which == AGAINST_HOUR ? of->frame->hour
                                                     : NAN;
        const int    bin = judge_bin((ScoreAgainst)which, value);
        if (bin >= 0) count_frame_in(&j->against[which][bin], of, wrong);
    }
}

static void count_errors(ErrorSums *e, const MatchTarget *t, const MatchAnswer *a, const TruthFrame *frame)
{
    double       length2 = 0;
    const double deg_per_px = 1 / (rad_per_deg * frame->focal_px), range = a->answer->range_m - t->truth->range_m;
    for (int k = 0; k < 2; k++) {
        const double d = a->centre[k] - t->centre[k];
        e->px[k] += d;
        length2 += d * d;
    }
    e->count++;
    e->px2 += length2;
    e->deg2 += length2 * deg_per_px * deg_per_px;
    if (isnan(range)) return;
    e->ranges++;
    e->range += range;
    e->range2 += range * range;
}

/* The class of the clutter that an answer lies on: of several that whose box is smallest, which it must be within, or
 * beside by a pixel at most. CLUTTER_NONE: on none that is known. */
static int clutter_below(const TruthFrame *frame, const double centre[2])
{
    static const double beside_px = 1;
    double              least = INFINITY;
    int                 class_number = CLUTTER_NONE;
    for (int i = 0; i < frame->clutter_count; i++) {
        const double *b = frame->clutter[i].box, area = b[2] * b[3];
        if (!(area < least) || !(centre[0] >= b[0] - beside_px && centre[0] <= b[0] + b[2] + beside_px &&
                                 centre[1] >= b[1] - beside_px && centre[1] <= b[1] + b[3] + beside_px))
            continue;
        least = area;
        class_number = frame->clutter[i].class_number;
    }
    return class_number;
}

/* Rates and confusion, of the answers whose score counts. */
static void count_matches(Judge *j, const BandFrame *of)
{
    const MatchFrame *m = &j->match;
    long long         wrong = 0;
    for (int i = 0; i < m->targets; i++) {
        if (m->target[i].verdict != TARGET_TO_FIND) continue;
        const int          k = m->found_by[i] < of->counting ? m->found_by[i] : -1;
        const MatchAnswer *by = k >= 0 ? &m->answer[k] : NULL;
        count_chance(j, &m->target[i], of, by ? by->answer : NULL);
        if (by) count_errors(&j->errors, &m->target[i], by, of->frame);
    }
    for (int k = 0; k < of->counting; k++) {
        const int class_number = m->answer[k].answer->class_number, classes = target_class_count();
        j->ignored += m->names[k] == NAMES_BESIDE;
        if (m->names[k] != NAMES_NOTHING) continue;
        wrong++;
        if (m->answer[k].on_image) j->on_clutter[clutter_below(of->frame, m->answer[k].centre)]++;
        j->confusion.count[classes][class_number ? class_number - 1 : classes]++;
    }
    count_frame(j, of, wrong);
}

/* ---- average precision -------------------------------------------------------------------------------- */

static uint8_t mark_of(int names)
{
    return names >= 0 ? MARK_RIGHT : names == NAMES_NOTHING ? MARK_WRONG : MARK_IGNORED;
}

/* Marks by the rule within each class. */
static void mark_centres(Judge *j)
{
    bool        asked[256] = {false};
    MatchFrame *m = &j->match;
    for (int k = 0; k < m->answers; k++) {
        j->any[k] = mark_of(m->names[k]);
        j->centre[k] = MARK_WRONG; /* of no class of truth */
        asked[m->answer[k].answer->class_number] = true;
    }
    for (int c = 1; c < 256; c++) {
        if (!asked[c]) continue;
        match_run(m, &j->rules, c);
        for (int k = 0; k < m->answers; k++)
            if (m->answer[k].answer->class_number == c) j->centre[k] = mark_of(m->names[k]);
    }
}

/* What COCO's rules are given: coco.json's annotations, or what would be in it. */
static int coco_boxes(Judge *j, bool has_coco, const CocoTarget *coco, size_t count)
{
    if (has_coco) {
        for (size_t i = 0; i < count; i++) {
            j->target[i] = (PrecisionTarget){.class_number = coco[i].class_number, .ignored = coco[i].ignored};
            memcpy(j->target[i].box, coco[i].box, sizeof coco[i].box);
        }
        return (int)count;
    }
    int targets = 0;
    for (int i = 0; i < j->match.targets; i++) {
        const MatchTarget *t = &j->match.target[i];
        if (t->verdict == TARGET_HIDDEN) continue;
        j->target[targets] =
            (PrecisionTarget){.class_number = (uint8_t)t->truth->class_number, .ignored = t->verdict == TARGET_IGNORED};
        memcpy(j->target[targets++].box, t->box, sizeof t->box);
    }
    return targets;
}

/* ---- frames ------------------------------------------------------------------------------------------- */

static Status judge_band(Judge *j, const TruthFrame *frame, Band band, int sequence, const CocoTruth *coco)
{
    size_t            count, coco_count = 0;
    const Answer     *answer = answers_of(&count, j->answers, sequence, frame->frame, band);
    const CocoTarget *list = coco ? coco_targets_of(&coco_count, coco, frame->frame, band) : NULL;
    BandFrame         of = {.frame = frame, .band = band};
    Status            status = make_room(j, coco_count + (size_t)frame->count, count);
    if (status != STATUS_OK) return status;
    for (size_t i = 0; i < count; i++) j->detections += answer[i].found;
    const size_t young = drop_old(j, answer, count);
    of.answered = young > 0;
    if (j->rules.answered && !of.answered) return STATUS_OK;
    status = note_age(j, answer, count);
    if (status == STATUS_OK) status = match_targets(&j->match, frame, band, &j->rules, list, coco_count, coco);
    if (status == STATUS_OK) status = match_answers(&j->match, frame, j->young, young);
    if (status != STATUS_OK) return status;
    while (of.counting < j->match.answers && j->match.answer[of.counting].answer->score >= j->rules.least_score)
        of.counting++;
    match_run(&j->match, &j->rules, 0);
    count_matches(j, &of);
    judge_worst(j, frame, band, of.counting);
    status = judge_tracks(j, frame, band, of.counting);
    if (status != STATUS_OK) return status;
    mark_centres(j);
    return precision_add(&j->precision, band, j->target, coco_boxes(j, coco, list, coco_count), &j->match, j->centre,
                         j->any);
}

Status judge_frame(Judge *j, const TruthFrame *frame, int sequence, const CocoTruth *coco)
{
    Status status = STATUS_OK;
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++)
        if ((j->bands & frame->bands) >> b & 1) status = judge_band(j, frame, (Band)b, sequence, coco);
    return status;
}

Status judge_end_sequence(Judge *j)
{
    rates_end_sequence(&j->total);
    for (int b = 0; b < BAND_COUNT; b++) rates_end_sequence(&j->band[b]);
    for (int which = 0; which < AGAINST_COUNT; which++)
        for (int bin = 0; bin < score_bins_max; bin++) rates_end_sequence(&j->against[which][bin]);
    return judge_end_tracks(j);
}

void judge_free(Judge *j)
{
    precision_free(&j->precision);
    for (int b = 0; b < BAND_COUNT; b++) tracks_destroy(j->tracks[b]);
    match_free(&j->match);
    free(j->age_ms);
    free(j->target);
    free(j->centre);
    free(j->any);
    free(j->young);
    *j = (Judge){0};
}
