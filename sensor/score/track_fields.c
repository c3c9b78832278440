/* sensor/score/track_fields.c: scores of tracks in score.json. */
#include "sensor/score/track_fields.h"

#include "sensor/frame/json_object.h"
#include "sensor/score/tracks.h"

#define IN(member) FIELD_MEMBER(TracksScore, member)

static json_t *idf1(FieldAt *at) { return field_number(tracks_idf1(at->of)); }
static json_t *idp(FieldAt *at) { return field_number(tracks_idp(at->of)); }
static json_t *idr(FieldAt *at) { return field_number(tracks_idr(at->of)); }
static json_t *mota(FieldAt *at) { return field_number(tracks_mota(at->of)); }
static json_t *purity(FieldAt *at) { return field_number(tracks_purity(at->of)); }
static json_t *delay_s(FieldAt *at) { return field_number(tracks_delay_s(at->of)); }
static json_t *length(FieldAt *at) { return field_number(tracks_length(at->of)); }

static json_t *similarity(FieldAt *at)
{
    const TracksScore *s = at->of;
    return field_number(s->similarity / (double)s->matched);
}

static json_t *coast_similarity(FieldAt *at)
{
    const TracksScore *s = at->of;
    return field_number(s->coast_similarity / (double)s->coast_frames);
}

static json_t *idf1_most(FieldAt *at)
{
    const TracksScore *s = at->of;
    return s->idtp_dropped > 0 ? field_number(tracks_idf1_most(s)) : NULL;
}

static const Field rows[] = {
    {"sequences", "", "", "", "bands of a host's run whose answers have track numbers", IN(sequences)},
    {"frames", "", "", "", "frames of these", IN(frames)},
    {"present", "", "", "", "targets to be found, summed over frames", IN(present)},
    {"answers", "", "", "", "answers with a track number that are scored, summed over frames", IN(answers)},
    {"idf1", "", "0 .. 1", "without targets and answers",
     "2 idtp / (present + answers), with each track given to one target at most and the other way",
     FIELD_GET("number", idf1)},
    {"idf1_most", "", "0 .. 1", "when idf1 is exact", "idf1 is at least `idf1` and at most this",
     FIELD_GET("number", idf1_most)},
    {"idp", "", "0 .. 1", "without answers", "idtp / answers", FIELD_GET("number", idp)},
    {"idr", "", "0 .. 1", "without targets", "idtp / present", FIELD_GET("number", idr)},
    {"idtp", "", "", "", "answers of a track that meet the target which it is given to", IN(idtp)},
    {"idfp", "", "", "", "the other answers", IN(idfp)},
    {"idfn", "", "", "", "the other targets", IN(idfn)},
    {"matched", "", "", "", "pairs of a target and an answer by the matching frame by frame", IN(matched)},
    {"similarity", "", "0 .. 1", "when none is matched", "mean of the matched", FIELD_GET("number", similarity)},
    {"mota", "", "", "without targets", "1 - (targets and answers not matched, and switches) / present",
     FIELD_GET("number", mota)},
    {"switches", "", "", "", "matches of a target with another track than its match before", IN(switches)},
    {"fragmentations", "", "", "", "times that a target was lost, and found again later", IN(fragmentations)},
    {"targets", "", "", "", "different targets to be found", IN(truths)},
    {"targets_found", "", "", "", "those matched in any frame", IN(truths_found)},
    {"mostly_tracked", "", "", "", "those matched in more than 80 % of the frames in which they are to be found",
     IN(mostly_tracked)},
    {"mostly_lost", "", "", "", "those matched in less than 20 %", IN(mostly_lost)},
    {"delay_s", "s", "exercise time", "when no target is found",
     "from the first frame in which a target is to be found to its first match, mean over those found",
     FIELD_GET("number", delay_s)},
    {"delay_most_s", "s", "exercise time", "", "the longest", IN(delay_s_most)},
    {"tracks", "", "", "", "track numbers", IN(tracks)},
    {"tracks_false", "", "", "", "those that are never matched", IN(tracks_false)},
    {"purity", "", "0 .. 1", "when all are false",
     "share of a track's answers that are matched with its main target, mean over tracks not false",
     FIELD_GET("number", purity)},
    {"length", "", "", "when all are false", "answers of a track, mean over tracks not false",
     FIELD_GET("number", length)},
    {"length_most", "", "", "", "the longest", IN(length_most)},
    {"hidings", "", "", "", "times that a target, matched in its last frame, was hidden in the next", IN(hidings)},
    {"coasts", "", "", "", "of these: its track still answers in that frame", IN(coasts)},
    {"coast_frames", "", "", "", "frames in which it goes on, while the target is hidden", IN(coast_frames)},
    {"coast_most", "", "", "", "frames of the longest", IN(coast_most)},
    {"coast_held", "", "", "", "frames of these in which its box still meets the hidden target's", IN(coast_held)},
    {"coast_similarity", "", "0 .. 1", "without such a frame", "mean of the boxes' similarity in them",
     FIELD_GET("number", coast_similarity)},
    {"returns", "", "", "", "hidings after which the target was matched again", IN(returns)},
    {"resumed", "", "", "", "of these: by the same track", IN(resumed)},
    {"beside", "", "", "", "answers on hidden targets or in ignore regions alone: not scored", IN(beside)},
    {"untracked", "", "", "", "answers without a track number: not scored", IN(untracked)},
    {"repeated", "", "", "when 0", "answers of a track that the frame had before: not scored", IN(repeated),
     .unless_0 = true},
    {"crowded", "", "", "when 0", "answers of a frame beyond its first 1024: not scored", IN(crowded),
     .unless_0 = true},
    {"targets_dropped", "", "", "when 0", "targets without room, summed over frames: not found", IN(truths_dropped),
     .unless_0 = true},
    {"pairs_dropped", "", "", "when 0", "pairs of target and track without room", IN(pairs_dropped), .unless_0 = true},
    {"tracks_ended", "", "", "when 0",
     "tracks without room, ended before the sequence; later answers are another track's", IN(tracks_ended),
     .unless_0 = true},
};

const FieldTable score_track_fields = {rows, (int)(sizeof rows / sizeof *rows)};
