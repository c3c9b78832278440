/* sensor/score/tracks_score.c: the scores of a sequence from what was counted of it, their sums and ratios. */
#include "sensor/score/assignment.h"
#include "sensor/score/tracks_private.h"

#include <stdlib.h>

static int by_truth_and_track(const void *a, const void *b)
{
    const uint64_t x = ((const TracksPairCount *)a)->key, y = ((const TracksPairCount *)b)->key;
    return (x > y) - (x < y);
}

static int by_track(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Tracks are numbered in their order: column[pairs] of the pairs, and how many there are. */
static int number_tracks(int *column, uint32_t *track, const TracksPairCount *pair, int pairs)
{
    int count = 0;
    for (int k = 0; k < pairs; k++) track[k] = (uint32_t)pair[k].key;
    qsort(track, (size_t)pairs, sizeof *track, by_track);
    for (int k = 0; k < pairs; k++)
        if (k == 0 || track[k] != track[k - 1]) track[count++] = track[k];
    for (int k = 0; k < pairs; k++) {
        const uint32_t  key = (uint32_t)pair[k].key;
        const uint32_t *at = bsearch(&key, track, (size_t)count, sizeof *track, by_track);
        column[k] = (int)(at - track);
    }
    return count;
}

/* The greatest number of frames in which tracks, each given to one truth, meet it. */
static Status identify(uint64_t *idtp, const Tracks *t, Arena *arena)
{
    const int        truths = t->truths.count, pairs = t->pairs.count;
    TracksPairCount *pair = arena_alloc_raw(arena, (size_t)pairs + 1, sizeof *pair);
    uint32_t        *track = arena_alloc_raw(arena, (size_t)pairs + 1, sizeof *track);
    int             *column = arena_alloc_raw(arena, (size_t)pairs + 1, sizeof *column);
    double          *weight = arena_alloc_raw(arena, (size_t)pairs + 1, sizeof *weight);
    int             *first = arena_alloc(arena, (size_t)truths + 2, sizeof *first);
    int             *match = arena_alloc_raw(arena, (size_t)truths + 1, sizeof *match);
    if (!pair || !track || !column || !weight || !first || !match) return STATUS_NO_MEMORY;
    *idtp = 0;
    if (pairs == 0) return STATUS_OK;
    memcpy(pair, t->pairs.item, (size_t)pairs * sizeof *pair);
    qsort(pair, (size_t)pairs, sizeof *pair, by_truth_and_track);
    for (int k = 0; k < pairs; k++) {
        first[(pair[k].key >> 32) + 1]++;
        weight[k] = pair[k].met;
    }
    for (int i = 0; i < truths; i++) first[i + 1] += first[i];
    const Assignment of = {.rows = truths,
                           .columns = number_tracks(column, track, pair, pairs),
                           .first = first,
                           .column = column,
                           .weight = weight};
    const Status     status = assignment_greatest(match, &of, arena);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < truths; i++)
        for (int k = first[i]; k < first[i + 1]; k++)
            if (column[k] == match[i]) *idtp += pair[k].met;
    return STATUS_OK;
}

static void add_truth(TracksScore *score, const TracksTruthScore *truth)
{
    if (!truth->visible) return;
    score->truths++;
    score->switches += truth->switches;
    score->fragmentations += truth->fragmentations;
    /* 0.8 and 0.2 as ratios, since those of two counts are what the judge compares with them */
    const double share = (double)truth->matched / (double)truth->visible;
    score->mostly_tracked += share > 0.8;
    score->mostly_lost += share < 0.2;
    if (!truth->matched) return;
    const double delay_s = truth->found_t_s - truth->seen_t_s;
    score->truths_found++;
    score->delay_s += delay_s;
    score->delay_s_most = fmax(score->delay_s_most, delay_s);
}

Status tracks_score(TracksScore *out, const Tracks *t)
{
    TracksScore score = t->sum;
    Arena      *arena = arena_create();
    if (!arena) return STATUS_NO_MEMORY;
    const Status status = identify(&score.idtp, t, arena);
    arena_destroy(arena);
    if (status != STATUS_OK) return status;
    score.sequences = 1;
    score.idfp = score.answers - score.idtp;
    score.idfn = score.present - score.idtp;
    for (int i = 0; i < t->truths.count; i++) add_truth(&score, &((const TracksTruthState *)t->truths.item)[i].score);
    for (int i = 0; i < t->open.count; i++) tracks_close(&score, &((const TracksOpen *)t->open.item)[i]);
    *out = score;
    return STATUS_OK;
}

static int by_id(const void *a, const void *b)
{
    const uint64_t x = ((const TracksTruthScore *)a)->id, y = ((const TracksTruthScore *)b)->id;
    return (x > y) - (x < y);
}

TracksTruthScore *tracks_truths(const Tracks *t, int *count)
{
    TracksTruthScore *truth = malloc(((size_t)t->truths.count + 1) * sizeof *truth);
    if (!truth) return NULL;
    *count = t->truths.count;
    for (int i = 0; i < *count; i++) truth[i] = ((const TracksTruthState *)t->truths.item)[i].score;
    qsort(truth, (size_t)*count, sizeof *truth, by_id);
    return truth;
}

/* ---- sums and ratios ----------------------------------------------------------------------------- */

void tracks_add(TracksScore *total, const TracksScore *one)
{
    const TracksScore before = *total;
    uint64_t *const   to[] = {
#define EACH(member) &total->member
        EACH(sequences),      EACH(frames),       EACH(present),      EACH(answers),        EACH(idtp),
        EACH(idfp),           EACH(idfn),         EACH(idtp_dropped), EACH(matched),        EACH(switches),
        EACH(fragmentations), EACH(truths),       EACH(truths_found), EACH(mostly_tracked), EACH(mostly_lost),
        EACH(tracks),         EACH(tracks_false), EACH(length),       EACH(hidings),        EACH(coasts),
        EACH(coast_frames),   EACH(coast_held),   EACH(returns),      EACH(resumed),        EACH(beside),
        EACH(untracked),      EACH(repeated),     EACH(crowded),      EACH(truths_dropped), EACH(pairs_dropped),
        EACH(tracks_ended)};
#undef EACH
    for (size_t k = 0; k < sizeof to / sizeof *to; k++)
        *to[k] += *(const uint64_t *)((const char *)one + ((const char *)to[k] - (const char *)total));
    total->similarity += one->similarity;
    total->delay_s += one->delay_s;
    total->purity += one->purity;
    total->coast_similarity += one->coast_similarity;
    total->delay_s_most = fmax(before.delay_s_most, one->delay_s_most);
    if (one->length_most > before.length_most) total->length_most = one->length_most;
    if (one->coast_most > before.coast_most) total->coast_most = one->coast_most;
}

static double ratio(double of, double to) { return to > 0 ? of / to : (double)NAN; }

double tracks_idf1(const TracksScore *s) { return ratio(2 * (double)s->idtp, (double)s->present + (double)s->answers); }

double tracks_idf1_most(const TracksScore *s)
{
    const double idtp = fmin((double)s->idtp + (double)s->idtp_dropped, fmin((double)s->present, (double)s->answers));
    return ratio(2 * idtp, (double)s->present + (double)s->answers);
}

double tracks_idp(const TracksScore *s) { return ratio((double)s->idtp, (double)s->answers); }
double tracks_idr(const TracksScore *s) { return ratio((double)s->idtp, (double)s->present); }

double tracks_mota(const TracksScore *s)
{
    const double misses = (double)s->present - (double)s->matched, wrong = (double)s->answers - (double)s->matched;
    return ratio((double)s->present - misses - wrong - (double)s->switches, (double)s->present);
}

double tracks_purity(const TracksScore *s) { return ratio(s->purity, (double)s->tracks - (double)s->tracks_false); }
double tracks_delay_s(const TracksScore *s) { return ratio(s->delay_s, (double)s->truths_found); }
double tracks_length(const TracksScore *s)
{
    return ratio((double)s->length, (double)s->tracks - (double)s->tracks_false);
}
