/* sensor/score/tracks_private.h: what is kept of a sequence between its frames: truths, tracks, and how often they met.
 */
#ifndef SENSOR_SCORE_TRACKS_PRIVATE_H
#define SENSOR_SCORE_TRACKS_PRIVATE_H

#include "sensor/score/tracks.h"

/* Keys and the rows that they are found at, by open addressing: entry[i] is a row + 1, 0 is none. */
typedef struct TracksIndex {
    uint32_t *entry; /* [mask + 1], a power of two, at least twice the rows */
    uint32_t  mask;
} TracksIndex;

typedef struct TracksPairCount {
    uint64_t key;          /* number of the truth, track */
    uint32_t met, matched; /* frames: at or above the threshold; of the matching */
} TracksPairCount;

typedef struct TracksOpen {
    uint64_t key; /* track */
    uint64_t last_frame;
    uint32_t answers, matched, best; /* scored answers; matched; matched with the truth that it was matched with most */
} TracksOpen;

typedef struct TracksTruthState {
    uint64_t         key; /* id */
    TracksTruthScore score;
    uint64_t         last_frame, last_step; /* was last in the frame's list; was last matched, of the steps */
    uint32_t         track;                 /* matched last; 0: none */
    uint32_t         follows;               /* matched in its last visible frame; 0: none */
    uint32_t         coasts;                /* track that still answers; 0: none */
    uint32_t         left;                  /* track that it had when it was hidden and that may resume; 0: none */
    uint64_t         run;                   /* frames of its coasting */
    bool             was_hidden, gap;       /* in last_frame; visible and not matched since it was matched */
} TracksTruthState;

/* A list that grows to its limit; the key is the first member of an item. */
typedef struct TracksList {
    void       *item; /* [count] */
    size_t      size; /* of an item */
    int         count, capacity;
    TracksIndex index;
} TracksList;

struct Tracks {
    double      threshold;
    double      last_t_s;
    uint64_t    frame, step; /* frames so far; those with visible truths and scored answers */
    TracksScore sum;         /* all but what follows from the lists */
    TracksList  truths, pairs, open;
    uint64_t    salt; /* of the indices: what a file's author cannot know. Results do not depend on it */
    Arena      *arena;
};

/* The item of a key, zeroed where it is new; NULL: it is not there and the list has `most`, or out of memory. */
void *tracks_list_find(const TracksList *list, uint64_t salt, uint64_t key);
void *tracks_list_add(TracksList *list, uint64_t salt, uint64_t key, int most);
void  tracks_list_free(TracksList *list);
/* Keeps the items that `keep` accepts, in their order. */
void tracks_list_keep(TracksList *list, uint64_t salt, bool (*keep)(const void *item, const void *user),
                      const void *user);

/* A truth and a track met in a frame, and may be matched in it. STATUS_NO_MEMORY. */
Status tracks_count_pair(Tracks *t, int truth, uint32_t track);
Status tracks_count_match(Tracks *t, int truth, uint32_t track);
/* A scored answer of a track. */
Status tracks_count_answer(Tracks *t, uint32_t track);
/* Adds what is known of a track to a score. */
void tracks_close(TracksScore *score, const TracksOpen *track);

#endif
