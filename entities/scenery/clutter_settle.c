/* entities/scenery/clutter_settle.c: which things stay: conflicts between them, the square that is asked for, limits.
 */
#include "entities/scenery/scenery_clutter_private.h"

#include <stdlib.h>

static const double gap_m = 0.3; /* between discs about things */

static int by_rank(const void *pa, const void *pb)
{
    const ClutterThing *a = pa, *b = pb;
    if (a->rank != b->rank) return a->rank < b->rank ? -1 : 1;
    return (a->row > b->row) - (a->row < b->row);
}

typedef struct Spot {
    int64_t cell;
    int     thing;
} Spot;

static int by_cell(const void *pa, const void *pb)
{
    const Spot *a = pa, *b = pb;
    if (a->cell != b->cell) return a->cell < b->cell ? -1 : 1;
    return (a->thing > b->thing) - (a->thing < b->thing);
}

static const double spot_m = 20; /* at least the sum of the two largest radii and the gap */

static int64_t spot_cell(double x_m, double y_m, int di, int dj)
{
    return ((int64_t)floor(x_m / spot_m) + di) * ((int64_t)1 << 32) + ((int64_t)floor(y_m / spot_m) + dj);
}

static int first_of(const Spot *spot, int count, int64_t cell)
{
    int low = 0, high = count;
    while (low < high) {
        const int mid = (low + high) / 2;
        if (spot[mid].cell < cell) low = mid + 1;
        else high = mid;
    }
    return low;
}

/* What stands in the way of what drives off the ways goes. */
static void clear_ways(bool *goes, const ClutterWork *work, const Spot *spot, int spots)
{
    static const double half_m = 1.6; /* of what drives, and a gap */
    enum { parts = 3 };
    for (int n = 0; n < work->things; n++) {
        const ClutterThing *t = &work->thing[n];
        if (work->table.row[t->row].where < CLUTTER_AREAS) continue;
        for (int part = 0; part < t->path_count * parts; part++) {
            const double *a = work->path[t->path + part / parts],
                         *b = work->path[t->path + (part / parts + 1) % t->path_count];
            const double share = (double)(part % parts) / parts;
            const double x = a[0] + share * (b[0] - a[0]), y = a[1] + share * (b[1] - a[1]);
            for (int k = 0; k < 9; k++) {
                const int64_t cell = spot_cell(x, y, k % 3 - 1, k / 3 - 1);
                for (int s = first_of(spot, spots, cell); s < spots && spot[s].cell == cell; s++) {
                    const ClutterThing *o = &work->thing[spot[s].thing];
                    goes[spot[s].thing] |= hypot(o->x_m - x, o->y_m - y) < (double)o->radius_m + half_m;
                }
            }
        }
    }
}

/* Of two things that touch the one of higher rank goes, whether or not the other stays: so what stays at a place
 * follows from what is near it alone. Things are sorted by rank. */
static Status keep_apart(ClutterWork *work)
{
    Spot *spot = malloc(((size_t)work->things + 1) * sizeof *spot);
    bool *goes = calloc((size_t)work->things + 1, sizeof *goes);
    int   spots = 0, kept = 0;
    if (!spot || !goes) {
        free(spot), free(goes);
        return STATUS_NO_MEMORY;
    }
    for (int n = 0; n < work->things; n++) {
        const ClutterThing *t = &work->thing[n];
        if (!t->path_count) spot[spots++] = (Spot){spot_cell(t->x_m, t->y_m, 0, 0), n};
    }
    qsort(spot, (size_t)spots, sizeof *spot, by_cell);
    for (int n = 0; n < work->things; n++) {
        const ClutterThing *t = &work->thing[n];
        for (int k = 0; k < 9 && !goes[n] && !t->path_count; k++) {
            const int64_t cell = spot_cell(t->x_m, t->y_m, k % 3 - 1, k / 3 - 1);
            for (int s = first_of(spot, spots, cell); s < spots && spot[s].cell == cell && spot[s].thing < n; s++) {
                const ClutterThing *o = &work->thing[spot[s].thing];
                goes[n] |= hypot(o->x_m - t->x_m, o->y_m - t->y_m) < (double)o->radius_m + (double)t->radius_m + gap_m;
            }
        }
    }
    clear_ways(goes, work, spot, spots);
    for (int n = 0; n < work->things; n++) {
        const ClutterThing t = work->thing[n];
        if (!goes[n] && clutter_in_square(work->config, t.x_m, t.y_m, 0)) work->thing[kept++] = t;
    }
    work->things = kept;
    free(spot), free(goes);
    return STATUS_OK;
}

static void apply_limits(ClutterWork *work)
{
    int kept = 0, drive = 0;
    for (int n = 0; n < work->things && kept < work->config->most; n++) {
        const ClutterThing t = work->thing[n];
        if (t.path_count && drive++ >= work->config->most_driving) continue;
        work->thing[kept++] = t;
    }
    if (kept < work->things)
        log_warn("clutter: more than the limits, some left out: placed=%d kept=%d objects=%d driving=%d; next: a lower "
                 "density",
                 work->things, kept, work->config->most, work->config->most_driving);
    work->things = kept;
}

Status clutter_settle(ClutterWork *work)
{
    if (work->things) qsort(work->thing, (size_t)work->things, sizeof *work->thing, by_rank);
    const Status status = keep_apart(work);
    if (status == STATUS_OK) apply_limits(work);
    return status;
}
