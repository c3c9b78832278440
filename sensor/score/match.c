/* sensor/score/match.c: matches the answers of a frame and band with its targets. */
#include "sensor/score/match.h"

#include "sensor/score/grown.h"

#include <stdlib.h>

/* ---- boxes ---------------------------------------------------------------------------------------- */

static double overlap(const double a[4], const double b[4])
{
    const double w = fmin(a[2] + a[0], b[2] + b[0]) - fmax(a[0], b[0]);
    const double h = fmin(a[3] + a[1], b[3] + b[1]) - fmax(a[1], b[1]);
    return w > 0 && h > 0 ? w * h : 0;
}

double match_iou(const double a[4], const double b[4])
{
    const double both = overlap(a, b);
    return both > 0 ? both / (a[2] * a[3] + b[2] * b[3] - both) : 0;
}

double match_share(const double a[4], const double b[4])
{
    const double both = overlap(a, b);
    return both > 0 ? both / (a[2] * a[3]) : 0;
}

static void crop(double out[4], const double box[4], int width, int height)
{
    const double left = fmax(box[0], 0), top = fmax(box[1], 0);
    const double w = fmin(box[0] + box[2], width) - left, h = fmin(box[1] + box[3], height) - top;
    const bool   empty = !(w > 0 && h > 0);
    out[0] = left, out[1] = top, out[2] = empty ? 0 : w, out[3] = empty ? 0 : h;
}

static bool contains(const double box[4], const double point[2], double margin_x, double margin_y)
{
    return point[0] >= box[0] - margin_x && point[0] <= box[0] + box[2] + margin_x && point[1] >= box[1] - margin_y &&
           point[1] <= box[1] + box[3] + margin_y;
}

/* ---- lists ---------------------------------------------------------------------------------------- */

static Status room_for_targets(MatchFrame *m, size_t count)
{
    Status status = STATUS_OK;
    if (count <= (size_t)m->target_room) return status;
    m->target = grown(&status, m->target, 2 * count, sizeof *m->target);
    m->found_by = grown(&status, m->found_by, 2 * count, sizeof *m->found_by);
    if (status == STATUS_OK) m->target_room = (int)(2 * count);
    return status;
}

static Status room_for_answers(MatchFrame *m, size_t count)
{
    Status status = STATUS_OK;
    if (count <= (size_t)m->answer_room) return status;
    m->answer = grown(&status, m->answer, 2 * count, sizeof *m->answer);
    m->names = grown(&status, m->names, 2 * count, sizeof *m->names);
    if (status == STATUS_OK) m->answer_room = (int)(2 * count);
    return status;
}

static TargetVerdict by_limits(const TruthTarget *t, Band band, const ScoreRules *rules)
{
    if (!t->seen) return TARGET_HIDDEN;
    if (t->pixels < rules->min_pixels) return TARGET_IGNORED;
    if (rules->min_visible > 0 && !(t->visible >= rules->min_visible)) return TARGET_IGNORED;
    return fabs(t->snr[band]) < rules->min_snr ? TARGET_IGNORED : TARGET_TO_FIND;
}

Status match_targets(MatchFrame *m, const TruthFrame *frame, Band band, const ScoreRules *rules, const CocoTarget *coco,
                     size_t coco_count, bool has_coco)
{
    const Status status = room_for_targets(m, (size_t)frame->count);
    if (status != STATUS_OK) return status;
    m->targets = frame->count;
    for (int i = 0; i < frame->count; i++) {
        const TruthTarget *t = &frame->target[i];
        MatchTarget       *out = &m->target[i];
        *out = (MatchTarget){.truth = t, .verdict = has_coco ? TARGET_HIDDEN : by_limits(t, band, rules)};
        memcpy(out->box, t->box, sizeof out->box);
        for (size_t k = 0; k < coco_count; k++) {
            if (coco[k].entity != t->id) continue;
            out->verdict = coco[k].ignored ? TARGET_IGNORED : TARGET_TO_FIND;
            memcpy(out->box, coco[k].box, sizeof out->box);
        }
        crop(out->within, t->amodal, frame->width, frame->height);
        for (int k = 0; k < 2; k++) out->centre[k] = t->amodal[k] + 0.5 * t->amodal[2 + k];
    }
    return STATUS_OK;
}

Status match_answers(MatchFrame *m, const TruthFrame *frame, const Answer *answer, size_t count)
{
    const Status status = room_for_answers(m, count);
    if (status != STATUS_OK) return status;
    m->answers = 0;
    for (size_t i = 0; i < count; i++) {
        const Answer *a = &answer[i];
        MatchAnswer   out = {.answer = a, .on_image = true};
        if (!a->found) continue;
        if (a->line_of_sight) out.on_image = truth_frame_point(out.centre, frame, a->box[0], a->box[1]);
        else
            for (int k = 0; k < 2; k++) out.centre[k] = a->box[k] + 0.5 * a->box[2 + k];
        m->answer[m->answers++] = out;
    }
    return STATUS_OK;
}

void match_free(MatchFrame *m)
{
    free(m->target);
    free(m->answer);
    free(m->names);
    free(m->found_by);
    *m = (MatchFrame){0};
}

/* ---- the rule -------------------------------------------------------------------------------------- */

bool match_may_name(double *distance2, const MatchTarget *t, const MatchAnswer *a, const ScoreRules *rules)
{
    static const double half_px = 0.5; /* an answer in whole pixels is off by as much */
    const double       *amodal = t->truth->amodal, dx = a->centre[0] - t->centre[0], dy = a->centre[1] - t->centre[1];
    *distance2 = dx * dx + dy * dy;
    if (!a->on_image) return false;
    if (a->answer->line_of_sight || t->truth->pixels < rules->small_px)
        return contains(amodal, a->centre, fmax(half_px, 0.5 * rules->grow * amodal[2]),
                        fmax(half_px, 0.5 * rules->grow * amodal[3]));
    return fmax(match_iou(a->answer->box, t->box), match_iou(a->answer->box, t->within)) >= rules->iou;
}

/* Whether the answer is of something that need not be found. */
static bool is_beside(const MatchTarget *t, const MatchAnswer *a, const ScoreRules *rules)
{
    double        unused;
    const double *region = t->verdict == TARGET_HIDDEN ? t->within : t->box;
    if (match_may_name(&unused, t, a, rules)) return true;
    if (!a->on_image || !(region[2] > 0 && region[3] > 0)) return false;
    return a->answer->line_of_sight ? contains(region, a->centre, 0, 0)
                                    : match_share(a->answer->box, region) >= rules->iou;
}

static int nearest(const MatchFrame *m, const MatchAnswer *a, const ScoreRules *rules, int class_number)
{
    int    best = NAMES_NOTHING;
    double least = INFINITY;
    for (int i = 0; i < m->targets; i++) {
        const MatchTarget *t = &m->target[i];
        double             distance2;
        if (t->verdict != TARGET_TO_FIND || m->found_by[i] >= 0) continue;
        if (class_number && t->truth->class_number != class_number) continue;
        if (!match_may_name(&distance2, t, a, rules)) continue;
        /* where two are equally near, the one of the lower id, wherever it stands in the list */
        if (distance2 > least || (distance2 == least && t->truth->id > m->target[best].truth->id)) continue;
        least = distance2;
        best = i;
    }
    return best;
}

void match_run(MatchFrame *m, const ScoreRules *rules, int class_number)
{
    for (int i = 0; i < m->targets; i++) m->found_by[i] = -1;
    for (int k = 0; k < m->answers; k++) {
        const MatchAnswer *a = &m->answer[k];
        m->names[k] = NAMES_UNASKED;
        if (class_number && a->answer->class_number != class_number) continue;
        m->names[k] = nearest(m, a, rules, class_number);
        if (m->names[k] >= 0) m->found_by[m->names[k]] = k;
        for (int i = 0; i < m->targets && m->names[k] == NAMES_NOTHING; i++) {
            const MatchTarget *t = &m->target[i];
            if (t->verdict == TARGET_TO_FIND || (class_number && t->truth->class_number != class_number)) continue;
            if (is_beside(t, a, rules)) m->names[k] = NAMES_BESIDE;
        }
    }
}
