/* terrain/invented/fit.c: which fixes are consistent, and the last centimetres on the posts themselves.
 *
 * Fixes can be inconsistent: terrain of other simulators, a burst on a roof, a vehicle slung under a helicopter.
 * Entities rejected by the consensus are removed before (votes.c). Two of the remaining fixes agree when a slope of 35
 * degrees can join them. Otherwise the higher one is more likely wrong and is dropped, unless the lower has a quarter
 * of its support or less (one report from below the ground). */
#include "terrain/invented/invented_private.h"

#include <stdlib.h>

/* ---- points by place ----------------------------------------------------------------------------- */

/* Bucket of a square cell by a hash; points in a bucket keep their order. */
static uint32_t bucket_of(const NearGrid *grid, int64_t ci, int64_t cj)
{
    return (uint32_t)invented_hash(0, ci, cj) & grid->mask;
}

Status near_grid_create(NearGrid *out, double cell_m, int count, const double *x_m, const double *y_m, size_t stride)
{
    NearGrid grid = {.cell_m = cell_m, .count = count, .mask = 63};
    while (grid.mask < (uint32_t)count) grid.mask = 2 * grid.mask + 1;
    grid.start = calloc((size_t)grid.mask + 2, sizeof *grid.start);
    grid.item = calloc((size_t)count + 1, sizeof *grid.item);
    uint32_t *bucket = calloc((size_t)count + 1, sizeof *bucket);
    if (!grid.start || !grid.item || !bucket) {
        free(bucket);
        near_grid_destroy(&grid);
        return STATUS_NO_MEMORY;
    }

    for (int n = 0; n < count; n++) {
        const double x = *(const double *)((const char *)x_m + (size_t)n * stride);
        const double y = *(const double *)((const char *)y_m + (size_t)n * stride);
        bucket[n] = bucket_of(&grid, near_grid_cell(&grid, x), near_grid_cell(&grid, y));
        grid.start[bucket[n] + 1]++;
    }
    for (uint32_t b = 0; b <= grid.mask; b++) grid.start[b + 1] += grid.start[b];
    for (int n = count - 1; n >= 0; n--) grid.item[--grid.start[bucket[n] + 1]] = n;
    /* counting down has left each bucket's start one place to the right */
    for (uint32_t b = 0; b <= grid.mask; b++) grid.start[b] = grid.start[b + 1];
    grid.start[grid.mask + 1] = count;
    free(bucket);
    *out = grid;
    return STATUS_OK;
}

void near_grid_destroy(NearGrid *grid)
{
    free(grid->start);
    free(grid->item);
    *grid = (NearGrid){0};
}

void near_grid_bucket(const NearGrid *grid, int64_t ci, int64_t cj, int *first, int *end)
{
    *first = *end = 0;
    if (!grid->count) return;
    const uint32_t b = bucket_of(grid, ci, cj);
    *first = grid->start[b];
    *end = grid->start[b + 1];
}

static const double steepest = 0.7;       /* tan 35 degrees */
static const double same_height_m = 0.01; /* fixes of a site closer in height than this share a row */
static const double slack_m = 0.04;       /* fixes at one place may differ by this */
static const double site_m = 0.5;         /* rows are gathered in squares of this size */
static const int    most_rows_a_site = 8, most_weight = 20;
static const double highest_h_m = 9500; /* nothing on the ground is higher */

/* ---- from fixes to rows ------------------------------------------------------------------- */

typedef struct Candidate {
    int64_t site_i, site_j;
    FixRow  row;
} Candidate;

static int by_site_then_height(const void *pa, const void *pb)
{
    const Candidate *a = pa, *b = pb;
    if (a->site_j != b->site_j) return a->site_j < b->site_j ? -1 : 1;
    if (a->site_i != b->site_i) return a->site_i < b->site_i ? -1 : 1;
    if (a->row.h_m != b->row.h_m) return a->row.h_m < b->row.h_m ? -1 : 1;
    return a->row.fix < b->row.fix ? -1 : a->row.fix > b->row.fix;
}

static double distance_m(const FixRow *a, const FixRow *b) { return hypot(a->x_m - b->x_m, a->y_m - b->y_m); }

static bool contradict(const FixRow *a, const FixRow *b)
{
    return !(fabs(a->h_m - b->h_m) <= slack_m + steepest * distance_m(a, b));
}

static int gather_candidates(Candidate *out, const LocalFrame *frame, const GroundFix *fix, int fix_count,
                             const uint8_t *outvoted, double horizon_m)
{
    int count = 0;
    for (int n = 0; n < fix_count; n++) {
        const double *p = fix[n].p_enu;
        if (outvoted[n]) continue;
        if (!(fabs(p[0]) < horizon_m && fabs(p[1]) < horizon_m) || !isfinite(p[2])) continue;
        double   p_ecef[3];
        Geodetic place;
        ecef_from_enu(p_ecef, frame, p);
        if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK) continue;
        if (!(place.h_m >= lowest_ground_m && place.h_m <= highest_h_m)) continue;
        out[count++] = (Candidate){(int64_t)floor(p[0] / site_m),
                                   (int64_t)floor(p[1] / site_m),
                                   {.x_m = p[0], .y_m = p[1], .z_m = p[2], .h_m = place.h_m, .fix = n, .weight = 1}};
    }
    qsort(out, (size_t)count, sizeof *out, by_site_then_height);
    return count;
}

/* Rows of one site: its median first, then all that are consistent with the median. counted: the row that each source
 * entity was last counted in. */
static void merge_site(FixSet *set, const Candidate *site, int count, const GroundFix *fix, int *counted)
{
    const int median = (count - 1) / 2, first = set->count;
    for (int n = 0; n < count; n++) {
        /* the median first, then the others upwards and downwards from it */
        const int     k = n == 0 ? median : n <= median ? n - 1 : n;
        const FixRow *row = &site[k].row;
        if (contradict(row, &site[median].row)) continue;

        int shared = -1;
        for (int r = first; r < set->count && shared < 0; r++)
            if (fabs(set->row[r].h_m - row->h_m) <= same_height_m) shared = r;
        if (shared < 0 && set->count - first < most_rows_a_site) {
            shared = set->count++;
            set->row[shared] = *row;
            set->row[shared].weight = 0;
        }
        if (shared < 0) continue;
        const int voter = fix[row->fix].voter;
        if (voter <= 0 || counted[voter] != shared) set->row[shared].weight++;
        if (voter > 0) counted[voter] = shared;
        set->row_of_fix[row->fix] = shared;
    }
}

/* ---- inconsistencies ---------------------------------------------------------------------- */

typedef struct Vote {
    int    row;
    double against, h_m;
} Vote;

static int most_contradicted_first(const void *pa, const void *pb)
{
    const Vote *a = pa, *b = pb;
    if (a->against != b->against) return a->against > b->against ? -1 : 1;
    if (a->h_m != b->h_m) return a->h_m > b->h_m ? -1 : 1;
    return a->row < b->row ? -1 : a->row > b->row;
}

static double weight_of(const FixRow *row) { return row->weight < most_weight ? row->weight : most_weight; }

/* Votes of inconsistent neighbours against a row: four for each lower neighbour, one for each higher one. Dense cells
 * are sampled, so the cost is bounded. */
static double votes_against(const FixRow *row, int self, const NearGrid *near, const FixRow *rows)
{
    enum { most_a_cell = 64 };
    double        against = 0;
    const int64_t ci = near_grid_cell(near, row->x_m), cj = near_grid_cell(near, row->y_m);
    for (int64_t j = cj - 1; j <= cj + 1; j++)
        for (int64_t i = ci - 1; i <= ci + 1; i++) {
            int first, end;
            near_grid_bucket(near, i, j, &first, &end);
            const int step = 1 + (end - first) / most_a_cell;
            for (int n = first; n < end; n += step) {
                const FixRow *other = &rows[near->item[n]];
                if (near->item[n] == self || other->dropped || !contradict(row, other)) continue;
                if (distance_m(row, other) > near->cell_m) continue;
                against += step * weight_of(other) * (other->h_m < row->h_m ? 4 : 1);
            }
        }
    return against;
}

/* Drops rows, the most inconsistent first, until all within reach_m agree (as far as was sampled). */
static Status drop_contradicted(FixRow *rows, int count, double reach_m)
{
    NearGrid near;
    Status   status = near_grid_create(&near, reach_m, count, &rows->x_m, &rows->y_m, sizeof *rows);
    if (status != STATUS_OK) return status;
    Vote *vote = calloc((size_t)count + 1, sizeof *vote);
    if (!vote) {
        near_grid_destroy(&near);
        return STATUS_NO_MEMORY;
    }

    int votes = 0;
    for (int n = 0; n < count; n++) {
        if (rows[n].dropped) continue;
        const double against = votes_against(&rows[n], n, &near, rows) / weight_of(&rows[n]);
        if (against > 0) vote[votes++] = (Vote){n, against, rows[n].h_m};
    }
    qsort(vote, (size_t)votes, sizeof *vote, most_contradicted_first);
    for (int n = 0; n < votes; n++)
        if (votes_against(&rows[vote[n].row], vote[n].row, &near, rows) > 0) rows[vote[n].row].dropped = true;

    free(vote);
    near_grid_destroy(&near);
    return STATUS_OK;
}

/* Drops inconsistent squares of 64 m, each represented by its median row, so that a column of reports far off the
 * ground is detected from half a kilometre. */
static Status drop_contradicted_squares(FixSet *set)
{
    static const double square_m = 64, reach_m = 512;
    FixRow             *speaker = calloc((size_t)set->count + 1, sizeof *speaker);
    int                *square_of = calloc((size_t)set->count + 1, sizeof *square_of);
    Candidate          *order = calloc((size_t)set->count + 1, sizeof *order);
    Status              status = speaker && square_of && order ? STATUS_OK : STATUS_NO_MEMORY;

    int live = 0, squares = 0;
    for (int n = 0; status == STATUS_OK && n < set->count; n++)
        if (!set->row[n].dropped) {
            order[live] = (Candidate){(int64_t)floor(set->row[n].x_m / square_m),
                                      (int64_t)floor(set->row[n].y_m / square_m), set->row[n]};
            order[live++].row.fix = n; /* from here on the number of the row itself */
        }
    if (status == STATUS_OK) qsort(order, (size_t)live, sizeof *order, by_site_then_height);
    for (int n = 0, end; n < live; n = end) {
        for (end = n + 1; end < live; end++)
            if (order[end].site_i != order[n].site_i || order[end].site_j != order[n].site_j) break;
        speaker[squares] = order[(n + end - 1) / 2].row;
        speaker[squares].weight = end - n;
        for (int k = n; k < end; k++) square_of[order[k].row.fix] = squares;
        squares++;
    }
    if (status == STATUS_OK && squares) status = drop_contradicted(speaker, squares, reach_m);
    for (int n = 0; status == STATUS_OK && n < set->count; n++)
        if (!set->row[n].dropped && speaker[square_of[n]].dropped) set->row[n].dropped = true;

    free(order);
    free(square_of);
    free(speaker);
    return status;
}

Status fix_set_create(FixSet *out, const LocalFrame *frame, const GroundFix *fix, int fix_count, double horizon_m)
{
    FixSet     set = {0};
    Status     status = STATUS_NO_MEMORY;
    Candidate *candidate = calloc((size_t)fix_count + 1, sizeof *candidate);
    uint8_t   *outvoted = calloc((size_t)fix_count + 1, 1);
    int        voters = 0;
    for (int n = 0; n < fix_count; n++) voters = fix[n].voter > voters ? fix[n].voter : voters;
    int *counted = calloc((size_t)voters + 1, sizeof *counted);
    set.row = calloc((size_t)fix_count + 1, sizeof *set.row);
    set.row_of_fix = calloc((size_t)fix_count + 1, sizeof *set.row_of_fix);
    if (!candidate || !outvoted || !counted || !set.row || !set.row_of_fix) goto done;

    for (int n = 0; n < fix_count; n++) set.row_of_fix[n] = -1;
    for (int n = 0; n <= voters; n++) counted[n] = -1;
    status = invented_inconsistent(outvoted, fix, fix_count);
    if (status != STATUS_OK) goto done;
    const int count = gather_candidates(candidate, frame, fix, fix_count, outvoted, horizon_m);
    for (int n = 0, end; n < count; n = end) {
        for (end = n + 1; end < count; end++)
            if (candidate[end].site_i != candidate[n].site_i || candidate[end].site_j != candidate[n].site_j) break;
        merge_site(&set, candidate + n, end - n, fix, counted);
    }

    status = drop_contradicted(set.row, set.count, 32);
    if (status != STATUS_OK) goto done;
    status = drop_contradicted_squares(&set);
    if (status != STATUS_OK) goto done;
    status = near_grid_create(&set.near, 32, set.count, &set.row->x_m, &set.row->y_m, sizeof *set.row);
    if (status != STATUS_OK) goto done;
    *out = set;
    set = (FixSet){0};

done:
    free(candidate);
    free(outvoted);
    free(counted);
    fix_set_destroy(&set);
    return status;
}

void fix_set_destroy(FixSet *set)
{
    free(set->row);
    free(set->row_of_fix);
    near_grid_destroy(&set->near);
    *set = (FixSet){0};
}

/* ---- the posts ---------------------------------------------------------------------------- */

static bool on_outline(const Field *z, int at)
{
    const int i = at % z->nx, j = at / z->nx;
    return i == 0 || j == 0 || i == z->nx - 1 || j == z->ny - 1;
}

/* One projection: the row is fitted by the least change of its three posts, or a share of it. Returns how far
 * off it was. */
static double meet_row(WorkLevel *level, const FixRow *row, double share)
{
    Field       *z = &level->z;
    int          corner[3];
    double       weight[3], square = 0;
    bool         free_post[3];
    const double off_m = row->z_m - levels_height(z, row->x_m, row->y_m, corner, weight);
    if (!isfinite(off_m) || !(share > 0)) return off_m;
    for (int k = 0; k < 3; k++) {
        const bool capped = (level->cap && off_m > 0 && !(z->v[corner[k]] < level->cap[corner[k]])) ||
                            (level->water && level->water[corner[k]]);
        free_post[k] = !capped && (level->outermost || !on_outline(z, corner[k]));
        if (free_post[k]) square += weight[k] * weight[k];
    }
    if (!(square > 1e-6)) return off_m;
    for (int k = 0; k < 3; k++) {
        if (!free_post[k]) continue;
        float *post = &z->v[corner[k]];
        *post += (float)(share * off_m * weight[k] / square);
        if (level->cap && *post > level->cap[corner[k]]) *post = level->cap[corner[k]];
    }
    return off_m;
}

/* Fits rows one after another by Kaczmarz's projections. The smooth field is already within centimetres, so little
 * moves. Rows that cannot all be fitted share the error, since the last sweeps take ever smaller steps. Returns the
 * largest error that is left. */
static double sweep_rows(WorkLevel *level, int index, const FixSet *fixes)
{
    enum { sweeps = 160, full_sweeps = 110 };
    static const double good_enough_m = 0.001;

    for (int sweep = 0;; sweep++) {
        const double share = sweep < full_sweeps ? 1 : (sweeps - sweep) / (double)(sweeps - full_sweeps + 1);
        double       worst_m = 0;
        for (int n = 0; n < fixes->count; n++) {
            const FixRow *row = &fixes->row[n];
            if (row->dropped || row->level != index) continue;
            const double off_m = fabs(meet_row(level, row, share));
            worst_m = off_m > worst_m ? off_m : worst_m;
        }
        if (worst_m <= good_enough_m || sweep == sweeps) return worst_m;
    }
}

/* Fits the posts. Where they cannot fit all fixes, as at a kerb or at two roads of different height, the worst fixes
 * are dropped, a few at a time, until the rest is fitted. */
void fit_posts(WorkLevel *level, int index, FixSet *fixes)
{
    enum { rounds = 15, gentle_rounds = 12 };
    static const double close_m = 0.035, reference_spacing_m = 4;

    const double allowed_m = close_m * fmax(1, level->z.spacing_m / reference_spacing_m);
    for (int round = 0; round < rounds; round++) {
        const double worst_m = sweep_rows(level, index, fixes);
        if (worst_m <= allowed_m) break;
        for (int n = 0; n < fixes->count; n++) {
            FixRow *row = &fixes->row[n];
            if (row->dropped || row->level != index) continue;
            const double off_m = fabs(meet_row(level, row, 0));
            if (off_m > allowed_m && (round >= gentle_rounds || off_m >= 0.7 * worst_m)) row->dropped = true;
        }
    }
}
