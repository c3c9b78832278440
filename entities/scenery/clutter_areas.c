/* entities/scenery/clutter_areas.c: clutter by area: a Poisson process for each row of the table, over cells of a fixed
 * grid, thinned by what the ground is at each place. Groups are one point of the process, and stand about it. */
#include "entities/scenery/scenery_clutter_private.h"

static const double cell_m = 64;
static const double widest = 2.5; /* standard deviations of a group's spread */

/* A standard normal pair, Box and Muller. */
static void normal_pair(double out[2], uint64_t h, uint64_t k)
{
    const double u = 1 - clutter_unit(h, k), turn = 2 * pi_rad * clutter_unit(h, k + 1), r = sqrt(-2 * log(u));
    out[0] = fmin(r, widest) * cos(turn), out[1] = fmin(r, widest) * sin(turn);
}

static bool fits(const ClutterWork *work, const ClutterThing *t)
{
    const ClutterRow *row = &work->table.row[t->row];
    return clutter_in_square(work->config, t->x_m, t->y_m, clutter_margin_m) &&
           clutter_is_area(work->config->landscape, row->where, t->x_m, t->y_m) &&
           clutter_can_stand(work->spots, t->x_m, t->y_m, t->heading_rad, work->variant[t->variant].size_m);
}

static Status place_group(ClutterWork *work, int r, uint64_t h, double x_m, double y_m)
{
    const ClutterRow *row = &work->table.row[r];
    if (clutter_is_full(work)) return STATUS_OK;
    const int low = (int)row->group_low, high = (int)row->group_high;
    const int count = low + (int)(clutter_unit(h, 1) * (high - low + 1));
    /* members of a group are of one kind and size: a flock, a heap of bales */
    const int variant = clutter_variant_of(work, r, h);
    Status    status = STATUS_OK;
    if (row->heat == CLUTTER_DRIVES) return clutter_place_off_ways(work, r, h, x_m, y_m);
    if (count > 1 && !clutter_is_area(work->config->landscape, row->where, x_m, y_m)) return STATUS_OK;
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        const uint64_t of = invented_hash(h, k, 5);
        double         off[2] = {0, 0};
        if (count > 1) normal_pair(off, of, 2);
        ClutterThing t = {.rank = of,
                          .row = r,
                          .variant = variant,
                          .x_m = x_m + row->spread_m * off[0],
                          .y_m = y_m + row->spread_m * off[1],
                          .heading_rad = 2 * pi_rad * clutter_unit(of, 4)};
        if (fits(work, &t)) status = clutter_add(work, t);
    }
    return status;
}

Status clutter_place_areas(ClutterWork *work)
{
    const ClutterConfig *c = work->config;
    Status               status = STATUS_OK;
    for (int r = 0; r < work->table.rows && status == STATUS_OK; r++) {
        const ClutterRow *row = &work->table.row[r];
        if (row->where < CLUTTER_AREAS) continue;
        const double mean =
            c->density * row->density * 1e-6 * cell_m * cell_m / (0.5 * (row->group_low + row->group_high));
        const double reach_m =
            clutter_margin_m + (row->heat == CLUTTER_DRIVES ? clutter_off_ways_m : widest * row->spread_m);
        const int64_t i0 = (int64_t)floor((c->south_west_m[0] - reach_m) / cell_m);
        const int64_t j0 = (int64_t)floor((c->south_west_m[1] - reach_m) / cell_m);
        const int64_t i1 = (int64_t)floor((c->north_east_m[0] + reach_m) / cell_m);
        const int64_t j1 = (int64_t)floor((c->north_east_m[1] + reach_m) / cell_m);
        for (int64_t j = j0; j <= j1 && status == STATUS_OK; j++)
            for (int64_t i = i0; i <= i1 && status == STATUS_OK; i++) {
                const int count = clutter_poisson(mean, invented_unit(clutter_hash(work, r, i, j, 0)));
                for (int k = 0; k < count && status == STATUS_OK; k++) {
                    const uint64_t h = clutter_hash(work, r, i, j, (uint64_t)k + 1);
                    status = place_group(work, r, h, ((double)i + clutter_unit(h, 2)) * cell_m,
                                         ((double)j + clutter_unit(h, 3)) * cell_m);
                }
            }
    }
    return status;
}
