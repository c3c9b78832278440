/* sensor/score/tracks.c: takes a sequence frame by frame: which tracks meet which truths, match them, and coast. */
#include "sensor/score/assignment.h"
#include "sensor/score/tracks_private.h"

#include <assert.h>
#include <stdlib.h>
#include <sys/auxv.h>

/* A frame in an order that does not depend on the caller's: truths by id, answers by track, pairs by both. Its answers
 * are those with a track of their own. */
typedef struct Step {
    const TracksFrame *frame;
    int                truths, answers, edges;
    int               *truth, *answer;             /* which of the frame's lists: [truths], [answers] */
    int               *truth_place, *answer_place; /* the other way; -1: dropped */
    TracksPair        *edge;                       /* places; [edges] */
    TracksTruthState **state;                      /* [truths]; NULL: there was no room */
    bool              *scored;                     /* [answers] */
    int               *match;                      /* of a truth, its answer; -1: none [truths] */
    int               *match_of;                   /* of an answer, its truth; -1: none [answers] */
} Step;

Status tracks_create(Tracks **out, double threshold)
{
    assert(threshold > 0 && threshold <= 1);
    Tracks *t = calloc(1, sizeof *t);
    if (!t) return STATUS_NO_MEMORY;
    t->threshold = threshold;
    t->last_t_s = -INFINITY;
    t->truths.size = sizeof(TracksTruthState);
    t->pairs.size = sizeof(TracksPairCount);
    t->open.size = sizeof(TracksOpen);
    const void *random = (const void *)getauxval(AT_RANDOM);
    if (random) memcpy(&t->salt, random, sizeof t->salt);
    t->arena = arena_create();
    if (!t->arena) {
        tracks_destroy(t);
        return STATUS_NO_MEMORY;
    }
    *out = t;
    return STATUS_OK;
}

void tracks_destroy(Tracks *t)
{
    if (!t) return;
    tracks_list_free(&t->truths);
    tracks_list_free(&t->pairs);
    tracks_list_free(&t->open);
    arena_destroy(t->arena);
    free(t);
}

/* ---- the frame in order -------------------------------------------------------------------------- */

static int by_id(const void *a, const void *b, void *frame)
{
    const TracksTruth *truth = ((const TracksFrame *)frame)->truth;
    const uint64_t     x = truth[*(const int *)a].id, y = truth[*(const int *)b].id;
    return (x > y) - (x < y);
}

/* Of one track, the first of the frame's list. */
static int by_track(const void *a, const void *b, void *frame)
{
    const TracksAnswer *answer = ((const TracksFrame *)frame)->answer;
    const int           i = *(const int *)a, j = *(const int *)b;
    const uint32_t      x = answer[i].track, y = answer[j].track;
    return x != y ? (x > y) - (x < y) : (i > j) - (i < j);
}

static int by_places(const void *a, const void *b)
{
    const TracksPair *x = a, *y = b;
    return x->truth != y->truth ? (x->truth > y->truth) - (x->truth < y->truth)
                                : (x->answer > y->answer) - (x->answer < y->answer);
}

static int least(int a, int b) { return a < b ? a : b; }

static Status order_truths(Step *s, Tracks *t)
{
    const TracksFrame *frame = s->frame;
    s->truths = least(frame->truths, tracks_frame_most);
    s->truth = arena_alloc_raw(t->arena, (size_t)s->truths + 1, sizeof *s->truth);
    s->truth_place = arena_alloc_raw(t->arena, (size_t)frame->truths + 1, sizeof *s->truth_place);
    s->match = arena_alloc_raw(t->arena, (size_t)s->truths + 1, sizeof *s->match);
    s->state = arena_alloc(t->arena, (size_t)s->truths + 1, sizeof(TracksTruthState *));
    if (!s->truth || !s->truth_place || !s->match || !s->state) return STATUS_NO_MEMORY;
    for (int i = 0; i < frame->truths; i++) s->truth_place[i] = -1;
    for (int i = 0; i < s->truths; i++) s->truth[i] = i;
    qsort_r(s->truth, (size_t)s->truths, sizeof *s->truth, by_id, (void *)(uintptr_t)frame);
    for (int i = 0; i < s->truths; i++) {
        s->truth_place[s->truth[i]] = i;
        s->match[i] = -1;
        if (i > 0 && frame->truth[s->truth[i]].id == frame->truth[s->truth[i - 1]].id) {
            log_warn("tracks: the frame at %.6f s is left out: it has a target twice; write each target once",
                     frame->t_s);
            return STATUS_BAD_VALUE;
        }
    }
    return STATUS_OK;
}

static Status order_answers(Step *s, Tracks *t)
{
    const TracksFrame *frame = s->frame;
    const int          count = least(frame->answers, tracks_frame_most);
    s->answer = arena_alloc_raw(t->arena, (size_t)count + 1, sizeof *s->answer);
    s->answer_place = arena_alloc_raw(t->arena, (size_t)frame->answers + 1, sizeof *s->answer_place);
    s->scored = arena_alloc(t->arena, (size_t)count + 1, sizeof *s->scored);
    s->match_of = arena_alloc_raw(t->arena, (size_t)count + 1, sizeof *s->match_of);
    if (!s->answer || !s->answer_place || !s->scored || !s->match_of) return STATUS_NO_MEMORY;
    for (int i = 0; i < frame->answers; i++) s->answer_place[i] = -1;
    for (int i = 0; i < count; i++) s->answer[i] = i;
    qsort_r(s->answer, (size_t)count, sizeof *s->answer, by_track, (void *)(uintptr_t)frame);
    t->sum.crowded += (uint64_t)(frame->answers - count);
    for (int i = 0; i < count; i++) {
        const uint32_t track = frame->answer[s->answer[i]].track;
        if (track == 0) t->sum.untracked++;
        else if (s->answers > 0 && frame->answer[s->answer[s->answers - 1]].track == track) t->sum.repeated++;
        else s->answer[s->answers++] = s->answer[i];
    }
    for (int i = 0; i < s->answers; i++) {
        s->answer_place[s->answer[i]] = i;
        s->match_of[i] = -1;
    }
    return STATUS_OK;
}

static Status order_pairs(Step *s, Tracks *t)
{
    const TracksFrame *frame = s->frame;
    s->edge = arena_alloc_raw(t->arena, (size_t)frame->pairs + 1, sizeof *s->edge);
    if (!s->edge) return STATUS_NO_MEMORY;
    for (int k = 0; k < frame->pairs; k++) {
        const TracksPair *pair = &frame->pair[k];
        assert(pair->truth >= 0 && pair->truth < frame->truths && pair->answer >= 0 && pair->answer < frame->answers);
        assert(pair->similarity >= 0 && pair->similarity <= 1);
        const TracksPair placed = {s->truth_place[pair->truth], s->answer_place[pair->answer], pair->similarity};
        if (placed.truth >= 0 && placed.answer >= 0) s->edge[s->edges++] = placed;
    }
    qsort(s->edge, (size_t)s->edges, sizeof *s->edge, by_places);
    return STATUS_OK;
}

static bool     hidden(const Step *s, int truth) { return s->frame->truth[s->truth[truth]].hidden; }
static uint32_t track_of(const Step *s, int answer) { return s->frame->answer[s->answer[answer]].track; }

/* ---- identity ------------------------------------------------------------------------------------ */

static Status find_states(Step *s, Tracks *t)
{
    for (int i = 0; i < s->truths; i++) /* all first: the list may move while it grows */
        if (!tracks_list_add(&t->truths, t->salt, s->frame->truth[s->truth[i]].id, tracks_truths_most) &&
            t->truths.count < tracks_truths_most)
            return STATUS_NO_MEMORY;
    for (int i = 0; i < s->truths; i++)
        s->state[i] = tracks_list_find(&t->truths, t->salt, s->frame->truth[s->truth[i]].id);
    return STATUS_OK;
}

/* Which answers are scored, and what they meet. */
static Status count_meetings(Step *s, Tracks *t)
{
    bool *beside = arena_alloc(t->arena, (size_t)s->answers + 1, sizeof *beside);
    if (!beside) return STATUS_NO_MEMORY;
    const TracksTruthState *first = t->truths.item;
    for (int i = 0; i < s->answers; i++) beside[i] = s->frame->answer[s->answer[i]].outside;
    for (int k = 0; k < s->edges; k++) {
        const TracksPair *edge = &s->edge[k];
        if (edge->similarity < t->threshold) continue;
        if (hidden(s, edge->truth)) {
            beside[edge->answer] = true;
            continue;
        }
        s->scored[edge->answer] = true;
        if (!s->state[edge->truth]) {
            t->sum.idtp_dropped++;
            continue;
        }
        const Status status = tracks_count_pair(t, (int)(s->state[edge->truth] - first), track_of(s, edge->answer));
        if (status != STATUS_OK) return status;
    }
    for (int i = 0; i < s->answers; i++) {
        s->scored[i] = s->scored[i] || !beside[i];
        if (!s->scored[i]) {
            t->sum.beside++;
            continue;
        }
        t->sum.answers++;
        const Status status = tracks_count_answer(t, track_of(s, i));
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

/* ---- matching ------------------------------------------------------------------------------------ */

/* A pair of the step before outweighs any sum of similarities. */
static const double keeps = 2 * tracks_frame_most;

static Status match_frame(Step *s, Tracks *t)
{
    int    *first = arena_alloc(t->arena, (size_t)s->truths + 2, sizeof *first);
    int    *column = arena_alloc_raw(t->arena, (size_t)s->edges + 1, sizeof *column);
    double *weight = arena_alloc_raw(t->arena, (size_t)s->edges + 1, sizeof *weight);
    if (!first || !column || !weight) return STATUS_NO_MEMORY;
    int count = 0;
    for (int i = 0, k = 0; i < s->truths; i++) {
        for (; k < s->edges && s->edge[k].truth == i; k++) {
            const TracksTruthState *state = s->state[i];
            if (!state || hidden(s, i) || s->edge[k].similarity < t->threshold) continue;
            const bool before =
                t->step > 0 && state->last_step == t->step && state->track == track_of(s, s->edge[k].answer);
            column[count] = s->edge[k].answer;
            weight[count++] = s->edge[k].similarity + (before ? keeps : 0);
        }
        first[i + 1] = count;
    }
    const Status status = assignment_greatest(
        s->match,
        &(Assignment){.rows = s->truths, .columns = s->answers, .first = first, .column = column, .weight = weight},
        t->arena);
    if (status != STATUS_OK) return status;
    t->step++;
    for (int i = 0, k = 0; i < s->truths; i++) {
        for (; k < s->edges && s->edge[k].truth == i; k++)
            if (s->edge[k].answer == s->match[i]) t->sum.similarity += s->edge[k].similarity;
        if (s->match[i] >= 0) s->match_of[s->match[i]] = i;
    }
    return STATUS_OK;
}

/* ---- what becomes of the truths ------------------------------------------------------------------ */

/* A truth that was hidden is matched. */
static void resume(Tracks *t, TracksTruthState *state, uint32_t track)
{
    if (!state->left) return;
    t->sum.returns++;
    if (state->left == track) t->sum.resumed++;
    state->left = 0;
}

static Status show_matched(Tracks *t, TracksTruthState *state, uint32_t track, double t_s)
{
    t->sum.matched++;
    state->score.matched++;
    if (isnan(state->score.found_t_s)) state->score.found_t_s = t_s;
    if (state->track && state->track != track) state->score.switches++;
    if (state->gap) state->score.fragmentations++;
    resume(t, state, track);
    state->gap = false;
    state->track = state->follows = track;
    state->last_step = t->step;
    return tracks_count_match(t, (int)(state - (TracksTruthState *)t->truths.item), track);
}

/* One frame of a hidden truth, which its last track may still answer. */
static void coast(const Step *s, Tracks *t, TracksTruthState *state, int truth)
{
    if (state->last_frame + 1 != t->frame) state->coasts = 0; /* it was outside the image */
    else if (!state->was_hidden && state->follows) {
        t->sum.hidings++;
        state->coasts = state->left = state->follows;
        state->run = 0;
    }
    if (!state->coasts) return;
    int answer = 0;
    while (answer < s->answers && track_of(s, answer) != state->coasts) answer++;
    if (answer == s->answers || s->match_of[answer] >= 0) { /* it is silent, or at another target */
        state->coasts = 0;
        return;
    }
    double similarity = 0;
    for (int k = 0; k < s->edges; k++)
        if (s->edge[k].truth == truth && s->edge[k].answer == answer) similarity = s->edge[k].similarity;
    if (++state->run == 1) t->sum.coasts++;
    if (state->run > t->sum.coast_most) t->sum.coast_most = state->run;
    t->sum.coast_frames++;
    t->sum.coast_similarity += similarity;
    if (similarity >= t->threshold) t->sum.coast_held++;
}

static Status follow_truth(const Step *s, Tracks *t, int i)
{
    TracksTruthState *state = s->state[i];
    if (state && !state->last_frame) {
        state->score.id = state->key;
        state->score.seen_t_s = state->score.found_t_s = NAN;
    }
    Status status = STATUS_OK;
    if (hidden(s, i)) {
        if (!state) return STATUS_OK;
        state->score.hidden++;
        coast(s, t, state, i);
    } else {
        t->sum.present++;
        if (!state) {
            t->sum.truths_dropped++;
            return STATUS_OK;
        }
        state->score.visible++;
        if (isnan(state->score.seen_t_s)) state->score.seen_t_s = s->frame->t_s;
        state->coasts = state->follows = 0;
        if (s->match[i] >= 0) status = show_matched(t, state, track_of(s, s->match[i]), s->frame->t_s);
        else state->gap = state->track != 0;
    }
    state->was_hidden = hidden(s, i);
    state->last_frame = t->frame;
    return status;
}

Status tracks_frame(Tracks *t, const TracksFrame *frame)
{
    if (!(frame->t_s > t->last_t_s)) {
        log_warn("tracks: the frame at %.6f s is left out: the one before it is at %.6f s; give frames in order of "
                 "time, each once",
                 frame->t_s, t->last_t_s);
        return STATUS_BAD_VALUE;
    }
    arena_reset(t->arena);
    Step   s = {.frame = frame};
    Status status = order_truths(&s, t);
    if (status != STATUS_OK) return status;
    t->last_t_s = frame->t_s;
    t->frame++;
    t->sum.frames++;
    int visible = 0, scored = 0;
    for (int i = 0; i < frame->truths; i++) {
        if (s.truth_place[i] >= 0) visible += !frame->truth[i].hidden;
        else if (!frame->truth[i].hidden) t->sum.present++, t->sum.truths_dropped++;
    }
    if ((status = order_answers(&s, t)) != STATUS_OK || (status = order_pairs(&s, t)) != STATUS_OK ||
        (status = find_states(&s, t)) != STATUS_OK || (status = count_meetings(&s, t)) != STATUS_OK)
        return status;
    for (int i = 0; i < s.answers; i++) scored += s.scored[i];
    if (visible > 0 && scored > 0 && (status = match_frame(&s, t)) != STATUS_OK) return status;
    for (int i = 0; i < s.truths; i++)
        if ((status = follow_truth(&s, t, i)) != STATUS_OK) return status;
    return STATUS_OK;
}
