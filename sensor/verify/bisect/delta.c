/* sensor/verify/bisect/delta.c: the smallest sets of differences that make something happen, by halving. */
#include "sensor/verify/bisect/delta.h"

#include <stdlib.h>

typedef struct Halving {
    const DeltaSearch *search;
    int               *item;  /* those within, in order */
    bool              *tried; /* [count]: what a test includes */
    const bool        *kept;  /* [count]: known to be needed */
} Halving;

/* The kept items, and the first `first` of the others. */
static DeltaAnswer try_first(const Halving *h, int first)
{
    memcpy(h->tried, h->kept, (size_t)h->search->count * sizeof *h->tried);
    for (int i = 0; i < first; i++) h->tried[h->item[i]] = true;
    return h->search->test(h->search->user, h->tried);
}

/* A length in low + 1 .. high - 1 that can be tried, the nearest to the middle of a few; its answer. */
static int try_between(DeltaAnswer *answer, const Halving *h, int low, int high)
{
    const int middle = low + (high - low) / 2;
    *answer = try_first(h, middle);
    for (int step = 1; *answer == DELTA_UNKNOWN && step < high - low; step *= 2)
        for (int side = -1; side <= 1 && *answer == DELTA_UNKNOWN; side += 2) {
            const int length = middle + side * step;
            if (length <= low || length >= high) continue;
            *answer = try_first(h, length);
            if (*answer != DELTA_UNKNOWN) return length;
        }
    return middle;
}

/* Shortens *high: the kept items with the first *high others move it, with the first *low others they do not. They end
 * one apart, unless what is between cannot be tried. */
static DeltaAnswer halve(const Halving *h, int *low, int *high)
{
    DeltaAnswer answer = DELTA_MOVES;
    while (*high - *low > 1) {
        const int length = try_between(&answer, h, *low, *high);
        if (answer == DELTA_MOVES) *high = length;
        else if (answer == DELTA_STILL) *low = length;
        else break;
    }
    return answer == DELTA_STOP ? DELTA_STOP : DELTA_MOVES;
}

/* Leaves out each item that is not needed. False: the tests ended before. */
static bool leave_out(DeltaSet *set, const DeltaSearch *search)
{
    for (int i = 0; i < search->count && set->size > 1; i++) {
        if (!set->in[i]) continue;
        set->in[i] = false;
        const DeltaAnswer answer = search->test(search->user, set->in);
        if (answer == DELTA_MOVES) {
            set->size--;
            i = -1; /* those before it may be needless now */
            continue;
        }
        set->in[i] = true;
        if (answer == DELTA_STOP) return false;
    }
    return true;
}

static void search_set(DeltaSet *out, Halving *h, int items)
{
    int  upper = items;
    bool apart = true; /* no two were taken together because halves of them cannot be tried */
    out->smallest = true;
    for (;;) {
        int low = 0, high = upper;
        if (out->size > 0) {
            const DeltaAnswer alone = try_first(h, 0);
            if (alone == DELTA_MOVES) break;
            if (alone == DELTA_STOP || upper == 0) out->smallest = false;
        }
        const DeltaAnswer end = out->smallest ? halve(h, &low, &high) : DELTA_STOP;
        const int         from = end == DELTA_STOP ? 0 : low; /* ended: with all of these it happens */
        for (int i = from; i < high; i++, out->size++) out->in[h->item[i]] = true;
        if (end == DELTA_STOP) {
            out->smallest = false;
            return;
        }
        apart = apart && high - low == 1;
        upper = low;
    }
    out->smallest = leave_out(out, h->search) && (apart || out->size == 1);
}

Status delta_smallest(DeltaSet *out, const DeltaSearch *search, const bool *within)
{
    const size_t count = (size_t)search->count;
    DeltaSet     set = {.in = calloc(count + 1, sizeof *set.in)};
    Halving      h = {search, calloc(count + 1, sizeof *h.item), calloc(count + 1, sizeof *h.tried), .kept = set.in};
    int          items = 0;
    const bool   room = set.in && h.item && h.tried;
    for (int i = 0; i < search->count && room; i++)
        if (within[i]) h.item[items++] = i;
    if (room) search_set(&set, &h, items);
    free(h.item);
    free(h.tried);
    if (!room) {
        free(set.in);
        return STATUS_NO_MEMORY;
    }
    *out = set;
    return STATUS_OK;
}

/* One of few items that moves it alone. */
static bool find_single(DeltaSet *out, const DeltaSearch *search, const bool *within)
{
    bool *in = calloc((size_t)search->count + 1, sizeof *in);
    bool  found = false;
    for (int i = 0; i < search->count && in && !found; i++) {
        if (!within[i]) continue;
        in[i] = true;
        found = search->test(search->user, in) == DELTA_MOVES;
        if (!found) in[i] = false;
    }
    if (found) *out = (DeltaSet){in, 1, true};
    else free(in);
    return found;
}

/* Each alone, so that the report has what it does. */
static void try_each(const DeltaSearch *search)
{
    bool *in = calloc((size_t)search->count + 1, sizeof *in);
    for (int i = 0; i < search->count && in; i++) {
        in[i] = true;
        search->test(search->user, in);
        in[i] = false;
    }
    free(in);
}

Status delta_causes(DeltaSet *out, int *count, int most, DeltaAnswer *rest, const DeltaSearch *search)
{
    bool  *left = malloc((size_t)search->count + 1);
    int    items = search->count, found = 0;
    Status status = left ? STATUS_OK : STATUS_NO_MEMORY;
    *rest = DELTA_MOVES;
    if (left) memset(left, true, (size_t)search->count + 1);
    if (left && search->count > 1 && search->count <= search->each) try_each(search);
    while (status == STATUS_OK && *rest == DELTA_MOVES && found < most && items > 0) {
        DeltaSet  *set = &out[found];
        const bool few = items <= search->each;
        if (!few || !find_single(set, search, left)) status = delta_smallest(set, search, left);
        if (status != STATUS_OK) break;
        found++;
        items -= set->size;
        for (int i = 0; i < search->count; i++) left[i] = left[i] && !set->in[i];
        *rest = items > 0 ? search->test(search->user, left) : DELTA_STILL;
    }
    free(left);
    if (status != STATUS_OK) delta_free(out, found);
    else *count = found;
    return status;
}

void delta_free(DeltaSet *set, int count)
{
    for (int i = 0; i < count; i++) free(set[i].in);
}
