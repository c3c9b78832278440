/* sensor/score/tracks.h: how well a recogniser's tracks follow the truth of one sequence, such as a band of a run: IDF1
 * with IDP and IDR, identity switches, fragmentations, purity, coasting, time to first detection, length.
 *
 * A sequence is given frame by frame in order of time: the truths, the answers that have a track number, and the pairs
 * whose boxes overlap at all, each with its similarity (intersection over union, or another measure in 0 .. 1). Nothing
 * else of matching is asked of the caller:
 *
 *   identity   As TrackEval's Identity and Ristani et al., Performance Measures and a Data Set for Multi-Target,
 *              Multi-Camera Tracking, 2016. A pair of a visible truth and an answer at or above the threshold counts
 *              for its truth and track. IDTP is the greatest sum of these counts over one-to-one assignments of tracks
 * to truths of the whole sequence (assignment.h); IDFN and IDFP are the remaining truths and answers. matching   As
 * TrackEval's CLEAR and Bernardin and Stiefelhagen, Evaluating Multiple Object Tracking Performance, 2008. Of a frame:
 * one to one, at or above the threshold, keeping as many pairs of the frame before as it can, then of the greatest sum
 * of similarity. A frame without visible truths or without answers leaves the pairs of the frame before as they are.
 * Switches, fragmentations, purity, coasting and delays are of it.
 *
 * A truth is visible, or hidden: within the image and not to be found, as what is behind a wood or too small. An answer
 * that reaches the threshold with hidden truths alone is neither right nor wrong: it is left out of IDF1 and matching,
 * counted as `beside`, and is what coasting is measured by.
 *
 * Memory is bounded (about 30 MB at most), whatever the answers are; what has no room is dropped and counted, and IDTP
 * is then known to within `idtp_dropped`. The result depends on the frames alone, not on the order within one: truths
 * are taken by id, answers by track number. A frame of 64 answers costs some 20 us, and 110 us where each of them is a
 * new track; tracks_score below a second. */
#ifndef SENSOR_SCORE_TRACKS_H
#define SENSOR_SCORE_TRACKS_H

#include "pitviper.h"

enum {
    tracks_frame_most = 1024,   /* truths, and answers, of a frame; the rest of a list is dropped */
    tracks_truths_most = 4096,  /* of a sequence */
    tracks_pairs_most = 262144, /* of a sequence: truth and track that met; beyond: the pairs that met least leave */
    tracks_open_most = 65536,   /* tracks whose answers are still counted; beyond: those longest without any end */
};

typedef struct TracksTruth {
    uint64_t id;
    bool     hidden;
} TracksTruth;

typedef struct TracksAnswer {
    uint32_t track;   /* 0: none; the answer is left out, counted as untracked */
    bool     outside; /* lies in a region that is not scored: `beside`, unless it meets a visible truth */
} TracksAnswer;

typedef struct TracksPair {
    int    truth, answer; /* of the frame's lists */
    double similarity;    /* 0 .. 1 */
} TracksPair;

typedef struct TracksFrame {
    double              t_s; /* greater than of the frame before */
    const TracksTruth  *truth;
    int                 truths;
    const TracksAnswer *answer;
    int                 answers;
    const TracksPair   *pair; /* those not named have similarity 0 */
    int                 pairs;
} TracksFrame;

/* Counts, which add up over sequences (tracks_add). */
typedef struct TracksScore {
    uint64_t sequences, frames;
    uint64_t present, answers; /* visible truths and answers that are scored, summed over frames */
    /* identity */
    uint64_t idtp, idfp, idfn;
    uint64_t idtp_dropped; /* IDTP may be more by this at most; 0: exact */
    /* matching */
    uint64_t matched, switches, fragmentations; /* fragmentation: a truth, matched before and again later, is not */
    double   similarity;                        /* sum over the matched */
    uint64_t truths, truths_found;              /* visible in some frame; matched in some */
    uint64_t mostly_tracked, mostly_lost;       /* truths matched in over 80 % of their visible frames; in under 20 % */
    double   delay_s, delay_s_most; /* from a truth's first visible frame to its first match; sum over found */
    /* tracks */
    uint64_t tracks, tracks_false; /* with any scored answer; never matched */
    double   purity;              /* share of a track's answers matched with its main truth; sum over those not false */
    uint64_t length, length_most; /* answers of a track; sum over those not false */
    /* coasting: a truth matched in its last visible frame is hidden in the next */
    uint64_t hidings;          /* that often */
    uint64_t coasts;           /* of these: the track answers in the first hidden frame */
    uint64_t coast_frames;     /* in which it goes on without a gap, while the truth is hidden */
    uint64_t coast_held;       /* of these: its box reaches the threshold with the hidden truth's */
    uint64_t coast_most;       /* frames of the longest */
    double   coast_similarity; /* sum over coast_frames */
    uint64_t returns, resumed; /* hidings whose truth is matched again later; by the same track */
    /* left out; truths_dropped are among present and idfn */
    uint64_t beside, untracked, repeated; /* answers: above; without a track; of a track that the frame had before */
    uint64_t crowded;                     /* answers of a frame beyond tracks_frame_most */
    uint64_t truths_dropped;              /* visible truths for which there was no room, summed over frames */
    uint64_t pairs_dropped;               /* for want of room */
    uint64_t tracks_ended;                /* likewise; one that answers again is counted as a new one */
} TracksScore;

/* What became of one truth. */
typedef struct TracksTruthScore {
    uint64_t id, visible, hidden, matched; /* frames */
    uint64_t switches, fragmentations;
    double   seen_t_s, found_t_s; /* first visible, first matched; NaN: never */
} TracksTruthScore;

typedef struct Tracks Tracks;

/* threshold: of similarity, above 0 up to 1. STATUS_NO_MEMORY. */
Status tracks_create(Tracks **out, double threshold);
void   tracks_destroy(Tracks *tracks); /* NULL is valid */
/* STATUS_BAD_VALUE, logged: a truth is there twice, or time does not advance; the frame is then left out.
 * STATUS_NO_MEMORY: no further call but tracks_destroy. */
Status tracks_frame(Tracks *tracks, const TracksFrame *frame);
/* The scores so far; frames may follow. STATUS_NO_MEMORY. */
Status tracks_score(TracksScore *out, const Tracks *tracks);
/* The truths so far in ascending order of id, the caller's to free; NULL: out of memory. */
TracksTruthScore *tracks_truths(const Tracks *tracks, int *count);
/* Adds one sequence to others. */
void tracks_add(TracksScore *total, const TracksScore *one);

/* Ratios of a score; NaN: of nothing. */
double tracks_idf1(const TracksScore *score);      /* 2 IDTP / (2 IDTP + IDFP + IDFN) */
double tracks_idf1_most(const TracksScore *score); /* with idtp_dropped */
double tracks_idp(const TracksScore *score);       /* IDTP / answers */
double tracks_idr(const TracksScore *score);       /* IDTP / present */
double tracks_mota(const TracksScore *score);      /* 1 - (misses + false + switches) / present */
double tracks_purity(const TracksScore *score);    /* mean over tracks */
double tracks_delay_s(const TracksScore *score);   /* mean over truths found */
double tracks_length(const TracksScore *score);    /* mean over tracks */

#endif
