/* sensor/score/judge_tracks.c: the tracks of a frame's answers, and its worst misses and false alarms. */
#include "sensor/score/judge_private.h"

#include "sensor/frame/target_record.h"
#include "sensor/score/json_member.h"

#include <stdlib.h>

static const double track_threshold = 0.5; /* of similarities: what may name a target has as much */

/* ---- tracks ------------------------------------------------------------------------------------------ */

/* How alike an answer and a target are: half where the answer may just name it, 1 where it is the same; 0: it may not.
 * By the rule of score.h: centres of small targets, IoU of large ones. */
static double similarity(const MatchTarget *t, const MatchAnswer *a, const ScoreRules *rules)
{
    double distance2;
    if (!match_may_name(&distance2, t, a, rules)) return 0;
    if (a->answer->line_of_sight || t->truth->pixels < rules->small_px) {
        const double size2 = t->truth->amodal[2] * t->truth->amodal[2] + t->truth->amodal[3] * t->truth->amodal[3];
        return 0.5 + 0.5 / (1 + 4 * distance2 / fmax(1, size2));
    }
    const double iou = fmax(match_iou(a->answer->box, t->box), match_iou(a->answer->box, t->within));
    return rules->iou < 1 ? 0.5 + 0.5 * (fmin(iou, 1) - rules->iou) / (1 - rules->iou) : 1;
}

typedef struct TrackLists {
    TracksTruth  truth[tracks_frame_most];
    TracksAnswer answer[tracks_frame_most];
    TracksPair   pair[tracks_pairs_a_frame];
} TrackLists;

Status judge_tracks(Judge *j, const TruthFrame *frame, Band band, int counting)
{
    const MatchFrame *m = &j->match;
    TrackLists       *lists = j->answers->tracks ? malloc(sizeof *lists) : NULL;
    TracksFrame       of = {.t_s = frame->time_s};
    Status            status = STATUS_OK;
    if (!j->answers->tracks) return status;
    if (!lists) return STATUS_NO_MEMORY;
    if (!j->tracks[band]) status = tracks_create(&j->tracks[band], track_threshold);
    of.truths = m->targets < tracks_frame_most ? m->targets : tracks_frame_most;
    of.answers = counting < tracks_frame_most ? counting : tracks_frame_most;
    for (int i = 0; i < of.truths; i++)
        lists->truth[i] = (TracksTruth){m->target[i].truth->id, m->target[i].verdict != TARGET_TO_FIND};
    for (int k = 0; k < of.answers; k++) {
        lists->answer[k] = (TracksAnswer){m->answer[k].answer->track, m->names[k] == NAMES_BESIDE};
        for (int i = 0; i < of.truths && of.pairs < tracks_pairs_a_frame; i++) {
            const double alike = similarity(&m->target[i], &m->answer[k], &j->rules);
            if (alike > 0) lists->pair[of.pairs++] = (TracksPair){i, k, alike};
        }
    }
    of.truth = lists->truth, of.answer = lists->answer, of.pair = lists->pair;
    if (status == STATUS_OK) status = tracks_frame(j->tracks[band], &of);
    free(lists);
    return status;
}

Status judge_end_tracks(Judge *j)
{
    Status status = STATUS_OK;
    for (int b = 0; b < BAND_COUNT; b++) {
        TracksScore one;
        if (!j->tracks[b]) continue;
        if (status == STATUS_OK) status = tracks_score(&one, j->tracks[b]);
        if (status == STATUS_OK) tracks_add(&j->track_score, &one);
        tracks_destroy(j->tracks[b]);
        j->tracks[b] = NULL;
    }
    return status;
}

/* ---- the worst ----------------------------------------------------------------------------------------- */

static WorstCase case_of(const Judge *j, const TruthFrame *frame, Band band, const char *name)
{
    WorstCase c = {
        .frame = frame->frame, .band = band, .t_s = frame->time_s, .range_m = NAN, .visible_fraction = NAN, .snr = NAN};
    snprintf(c.sequence, sizeof c.sequence, "%s", j->sequence ? j->sequence : "");
    snprintf(c.name, sizeof c.name, "%s", name);
    return c;
}

void judge_worst(Judge *j, const TruthFrame *frame, Band band, int counting)
{
    const MatchFrame *m = &j->match;
    for (int i = 0; i < m->targets; i++) {
        const MatchTarget *t = &m->target[i];
        const bool         found = m->found_by[i] >= 0 && m->found_by[i] < counting;
        if (t->verdict != TARGET_TO_FIND || found) continue;
        WorstCase c = case_of(j, frame, band, target_class_name(t->truth->class_number));
        json_member_entity_text(c.id, t->truth->id);
        memcpy(c.box_px, t->box, sizeof c.box_px);
        c.weight = t->truth->pixels, c.range_m = t->truth->range_m;
        c.visible_fraction = t->truth->visible, c.snr = t->truth->snr[band];
        worst_add(&j->missed, &c);
    }
    for (int k = 0; k < counting; k++) {
        const Answer *a = m->answer[k].answer;
        if (m->names[k] != NAMES_NOTHING) continue;
        WorstCase c = case_of(j, frame, band, a->class_number ? target_class_name(a->class_number) : "unknown");
        for (int n = 0; n < 4; n++) c.box_px[n] = a->line_of_sight ? NAN : a->box[n];
        c.track = a->track, c.weight = a->score;
        worst_add(&j->false_alarms, &c);
    }
}
