/* sensor/score/precision.c: average precision by COCO's rules, and by marks that were made elsewhere. */
#include "sensor/score/precision.h"

#include <stdlib.h>

/* As numpy's linspace(0.5, 0.95, 10) has them, to the bit. */
static double least_iou(int i) { return i == precision_ious - 1 ? 0.95 : i * ((0.95 - 0.5) / 9) + 0.5; }

/* ---- one image -------------------------------------------------------------------------------------- */

/* The targets and answers of one class. */
typedef struct Image {
    int                     targets; /* those to be found, then ignore regions */
    const PrecisionTarget **target;
    bool                   *taken;
    int                     answers;
    const Answer           *answer[precision_answers_most];
    PrecisionEntry         *entry[precision_answers_most];
} Image;

static void match_image(Image *image, int level)
{
    const double least = fmin(least_iou(level), 1 - 1e-10);
    if (image->targets > 0) memset(image->taken, 0, (size_t)image->targets * sizeof *image->taken);
    for (int d = 0; d < image->answers; d++) {
        double best = least;
        int    match = -1;
        for (int g = 0; g < image->targets; g++) {
            const bool crowd = image->target[g]->ignored;
            if (image->taken[g] && !crowd) continue;
            if (match >= 0 && !image->target[match]->ignored && crowd) break;
            const double iou = crowd ? match_share(image->answer[d]->box, image->target[g]->box)
                                     : match_iou(image->answer[d]->box, image->target[g]->box);
            if (iou < best) continue;
            best = iou;
            match = g;
        }
        if (match < 0) continue;
        image->taken[match] = true;
        image->entry[d]->matched |= (uint16_t)(1u << level);
        if (image->target[match]->ignored) image->entry[d]->ignored |= (uint16_t)(1u << level);
    }
}

static void match_class(Precision *p, PrecisionEntry *entry, const MatchFrame *m, const PrecisionTarget *target,
                        int targets, int class_number)
{
    Image image = {.target = p->image_target, .taken = p->image_taken};
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < targets; i++)
            if (target[i].class_number == class_number && target[i].ignored == (pass == 1))
                image.target[image.targets++] = &target[i];
    for (int k = 0; k < m->answers; k++) {
        if (entry[k].class_number != class_number) continue;
        const bool counts = image.answers < precision_answers_most && !m->answer[k].answer->line_of_sight;
        if (!counts) {
            entry[k].ignored = (1u << precision_ious) - 1;
            continue;
        }
        image.answer[image.answers] = m->answer[k].answer;
        image.entry[image.answers++] = &entry[k];
    }
    for (int level = 0; level < precision_ious; level++) match_image(&image, level);
}

static Status make_room(Precision *p, size_t entries, int targets)
{
    if (entries > UINT32_MAX) return STATUS_NO_MEMORY;
    if (entries > p->room) {
        const size_t    room = entries + entries / 2 + 1024;
        PrecisionEntry *grown = realloc(p->entry, room * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        p->entry = grown;
        p->room = room;
    }
    if (targets <= p->image_room) return STATUS_OK;
    const size_t            room = 2 * (size_t)targets;
    const PrecisionTarget **list = realloc(p->image_target, room * sizeof *list);
    if (list) p->image_target = list;
    bool *taken = realloc(p->image_taken, room * sizeof *taken);
    if (taken) p->image_taken = taken;
    if (!list || !taken) return STATUS_NO_MEMORY;
    p->image_room = (int)room;
    return STATUS_OK;
}

Status precision_add(Precision *p, Band band, const PrecisionTarget *target, int targets, const MatchFrame *m,
                     const uint8_t *centre, const uint8_t *any)
{
    const size_t more = p->count + (size_t)m->answers;
    bool         asked[256] = {false};
    const Status status = make_room(p, more, targets);
    if (status != STATUS_OK) return status;
    PrecisionEntry *entry = p->entry ? p->entry + p->count : NULL;
    for (int k = 0; k < m->answers; k++) {
        const Answer *a = m->answer[k].answer;
        entry[k] = (PrecisionEntry){.score = a->score,
                                    .order = (uint32_t)(p->count + (size_t)k),
                                    .class_number = a->class_number,
                                    .band = (uint8_t)band,
                                    .centre = centre[k],
                                    .any = any[k]};
        p->answers[a->class_number][band]++;
        asked[a->class_number] = true;
    }
    for (int i = 0; i < targets; i++)
        if (!target[i].ignored && target[i].class_number <= score_classes_max)
            p->targets[target[i].class_number][band]++;
    for (int i = 0; i < m->targets; i++)
        if (m->target[i].verdict == TARGET_TO_FIND) p->chances[m->target[i].truth->class_number][band]++;
    for (int c = 1; c <= score_classes_max; c++)
        if (asked[c]) match_class(p, entry, m, target, targets, c);
    p->count = more;
    return STATUS_OK;
}

/* ---- all of them ------------------------------------------------------------------------------------- */

static int by_score(const void *a, const void *b)
{
    const PrecisionEntry *x = a, *y = b;
    if (x->score != y->score) return x->score > y->score ? -1 : 1;
    return (x->order > y->order) - (x->order < y->order);
}

void precision_sort(Precision *p)
{
    if (p->count) qsort(p->entry, p->count, sizeof *p->entry, by_score);
}

static PrecisionMark mark_of(const PrecisionEntry *e, int level)
{
    if (level < 0) return (PrecisionMark)e->centre;
    if (e->ignored >> level & 1) return MARK_IGNORED;
    return e->matched >> level & 1 ? MARK_RIGHT : MARK_WRONG;
}

typedef struct PrecisionStep {
    PrecisionEntry entry;
    double         recall, precision; /* NaN: it does not count */
} PrecisionStep;

/* At a level of IoU; -1: by the centres' marks. */
static double average(PrecisionStep *step, size_t count, int level, double targets)
{
    double right = 0, wrong = 0, sum = 0, best = 0;
    for (size_t i = 0; i < count; i++) {
        const PrecisionMark mark = mark_of(&step[i].entry, level);
        right += mark == MARK_RIGHT;
        wrong += mark == MARK_WRONG;
        step[i].recall = right / targets;
        step[i].precision = mark == MARK_IGNORED ? 0 : right / (wrong + right + 0x1p-52);
    }
    int r = precision_recalls - 1;
    for (size_t i = count; i-- > 0;) { /* from the end: the greatest precision at this recall or beyond */
        for (; r >= 0 && 0.01 * r > step[i].recall; r--) sum += best;
        if (step[i].precision > best) best = step[i].precision;
    }
    for (; r >= 0; r--) sum += best;
    return sum / precision_recalls;
}

/* The entries of a class and band, in their order. */
static PrecisionStep *entries_of(const Precision *p, int class_number, int band, long long count)
{
    PrecisionStep *step = malloc((size_t)(count > 0 ? count : 1) * sizeof *step);
    size_t         n = 0;
    for (size_t i = 0; step && i < p->count; i++) {
        const PrecisionEntry *e = &p->entry[i];
        if (e->class_number == class_number && (band == BAND_COUNT || e->band == band)) step[n++].entry = *e;
    }
    return step;
}

Status precision_of(ScorePrecision *out, const Precision *p, int class_number, int band)
{
    long long chances = 0;
    *out = (ScorePrecision){.ap = NAN, .ap50 = NAN, .ap75 = NAN, .ap_centre = NAN};
    for (int b = 0; b < BAND_COUNT; b++) {
        if (band != BAND_COUNT && b != band) continue;
        out->targets += p->targets[class_number][b];
        out->answers += p->answers[class_number][b];
        chances += p->chances[class_number][b];
    }
    PrecisionStep *step = entries_of(p, class_number, band, out->answers);
    const size_t   count = (size_t)out->answers;
    if (!step) return STATUS_NO_MEMORY;
    if (out->targets > 0) {
        double sum = 0;
        for (int level = 0; level < precision_ious; level++) {
            const double one = average(step, count, level, (double)out->targets);
            if (level == 0) out->ap50 = one;
            if (level == 5) out->ap75 = one;
            sum += one;
        }
        out->ap = sum / precision_ious;
    }
    if (chances > 0) out->ap_centre = average(step, count, -1, (double)chances);
    free(step);
    return STATUS_OK;
}

int precision_curve(ScorePoint out[score_curve_max], const Precision *p, long long chances, long long frames)
{
    long long right = 0, wrong = 0;
    int       points = 0;
    size_t    ends = 0, end = 0; /* of runs of equal scores; the present one's number */
    for (size_t i = 0; i < p->count; i++) ends += i + 1 == p->count || p->entry[i + 1].score != p->entry[i].score;
    for (size_t i = 0; i < p->count; i++) {
        right += p->entry[i].any == MARK_RIGHT;
        wrong += p->entry[i].any == MARK_WRONG;
        if (i + 1 < p->count && p->entry[i + 1].score == p->entry[i].score) continue;
        end++;
        /* evenly among them, the last one always */
        const size_t due = ends <= score_curve_max ? end : 1 + (size_t)points * (ends - 1) / (score_curve_max - 1);
        if (end < due || points == score_curve_max) continue;
        out[points++] = (ScorePoint){p->entry[i].score, chances > 0 ? (double)right / (double)chances : NAN,
                                     right + wrong > 0 ? (double)right / (double)(right + wrong) : NAN,
                                     frames > 0 ? (double)wrong / (double)frames : NAN};
    }
    return points;
}

void precision_free(Precision *p)
{
    free(p->entry);
    free(p->image_target);
    free(p->image_taken);
    *p = (Precision){0};
}
