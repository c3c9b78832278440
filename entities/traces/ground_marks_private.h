/* entities/traces/ground_marks_private.h: the rings of ground marks; the last of each is at (n - 1) % capacity. */
#ifndef ENTITIES_TRACES_GROUND_MARKS_PRIVATE_H
#define ENTITIES_TRACES_GROUND_MARKS_PRIVATE_H

#include "entities/traces/ground_marks.h"

struct GroundHistory {
    uint64_t    stands, tracks, burns; /* ever */
    double      latest_s;              /* no mark begins later */
    int64_t     forgotten;
    uint64_t    owner[ground_stand_capacity]; /* of the stands, for the search */
    GroundStand stand[ground_stand_capacity];
    GroundTrack track[ground_track_capacity];
    GroundBurn  burn[ground_burn_capacity];
};

/* How many of a ring are there, and where the oldest is. */
static inline int ring_count(uint64_t ever, int capacity) { return ever < (uint64_t)capacity ? (int)ever : capacity; }
static inline int ring_first(uint64_t ever, int capacity)
{
    return ever < (uint64_t)capacity ? 0 : (int)(ever % (uint64_t)capacity);
}

#endif
