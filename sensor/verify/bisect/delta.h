/* sensor/verify/bisect/delta.h: which of many differences make something happen: the smallest sets of them, found in
 * few tests.
 *
 * Of `count` items a test includes some; with all of them it happens, with none it does not. The search halves: it
 * finds the shortest beginning of the list with which it happens, whose last item is needed, keeps that, and searches
 * before it for what is needed beside it. One item among n is found in log2(n) + 1 tests, k that only act together in
 * k (log2(n) + 1); nothing is assumed of how they act. What is found is tried again with each of its items left out. */
#ifndef SENSOR_VERIFY_BISECT_DELTA_H
#define SENSOR_VERIFY_BISECT_DELTA_H

#include "pitviper.h"

typedef enum DeltaAnswer {
    DELTA_STILL,   /* it does not happen */
    DELTA_MOVES,   /* it happens */
    DELTA_UNKNOWN, /* it could not be tried: the items do not go together */
    DELTA_STOP,    /* no more tests: the search ends */
} DeltaAnswer;

/* in[count]: which items are included. The same answer for the same items. */
typedef DeltaAnswer DeltaTest(void *user, const bool *in);

typedef struct DeltaSearch {
    int        count;
    DeltaTest *test;
    void      *user;
    int        each; /* of so few items, or fewer, each is tried alone first, for the sake of the report */
} DeltaSearch;

typedef struct DeltaSet {
    bool *in; /* [count], on the heap */
    int   size;
    bool  smallest; /* with any one of its items left out it does not happen, or cannot be tried */
} DeltaSet;

/* The first smallest set of the items in `within` ([count]), with which all it happens. It happens with the set also
 * when it is not the smallest: where parts of it cannot be tried apart, or the tests ended. STATUS_NO_MEMORY. */
Status delta_smallest(DeltaSet *out, const DeltaSearch *search, const bool *within);
/* Up to `most` disjoint sets, each by itself enough, each searched without the items of those before it. *rest: what
 * happens with all items that are in none. On failure there is nothing to free. STATUS_NO_MEMORY. */
Status delta_causes(DeltaSet *out, int *count, int most, DeltaAnswer *rest, const DeltaSearch *search);
void   delta_free(DeltaSet *set, int count);

#endif
