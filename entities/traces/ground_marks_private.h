/* entities/traces/ground_marks_private.h: the rings of ground marks; the last of each is at (n - 1) % capacity. */
#ifndef ENTITIES_TRACES_GROUND_MARKS_PRIVATE_H
#define ENTITIES_TRACES_GROUND_MARKS_PRIVATE_H

#include "entities/traces/ground_marks.h"

struct GroundHistory {
    uint64_t    stands, tracks, burns; /* ever */
    double      latest_s;              /* no mark begins after this time */
    int64_t     forgotten;
    uint64_t    owner[ground_stand_capacity]; /* owners of the stands, for the search */
    GroundStand stand[ground_stand_capacity];
    GroundTrack track[ground_track_capacity];
    GroundBurn  burn[ground_burn_capacity];
};

/* The number of entries in a ring, and where the oldest one is. */
static inline int ring_count(uint64_t ever, int capacity) { return ever < (uint64_t)capacity ? (int)ever : capacity; }
static inline int ring_first(uint64_t ever, int capacity)
{
    return ever < (uint64_t)capacity ? 0 : (int)(ever % (uint64_t)capacity);
}

#endif
