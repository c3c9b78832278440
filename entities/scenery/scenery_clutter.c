/* entities/scenery/scenery_clutter.c: adds clutter to a scenery: its numbers drawn by place, and the steps. */
#include "entities/scenery/scenery_clutter_private.h"

#include <stdlib.h>

static const double widest_square_m = 65536;

ClutterConfig clutter_default_config(void)
{
    return (ClutterConfig){
        .density = 1, .most = clutter_most_objects, .most_driving = 256, .most_states = 256, .sag_m = 0.01};
}

/* ---- numbers ------------------------------------------------------------------------------------ */

uint64_t clutter_hash(const ClutterWork *work, int row, int64_t i, int64_t j, uint64_t k)
{
    return invented_hash(invented_hash(work->config->seed ^ 0xc1077e5u, row, (int64_t)k), i, j);
}

int clutter_poisson(double mean, double unit)
{
    /* by inversion; in parts of 16, whose sums have the same distribution, so that exp(-mean) stays large */
    static const double part = 16;
    int                 count = 0;
    if (!(mean > 0)) return 0;
    for (int n = 0; mean > 0 && count < 10000; n++, mean -= part) {
        const double m = fmin(mean, part), u = n ? invented_unit(invented_hash(41, n, (int64_t)(unit * 0x1p53))) : unit;
        double       term = exp(-m), sum = term;
        for (int k = 0; u >= sum && k < 200; count++) k++, term *= m / k, sum += term;
    }
    return count;
}

bool clutter_in_square(const ClutterConfig *c, double x_m, double y_m, double more_m)
{
    return x_m >= c->south_west_m[0] - more_m && y_m >= c->south_west_m[1] - more_m &&
           x_m < c->north_east_m[0] + more_m && y_m < c->north_east_m[1] + more_m;
}

Status clutter_add(ClutterWork *work, ClutterThing t)
{
    const ClutterRow *row = &work->table.row[t.row];
    const float      *size_m = work->variant[t.variant].size_m;
    if (clutter_is_full(work)) return STATUS_OK;
    if (row->reach_m > 0 && hypot(t.x_m, t.y_m) > row->reach_m) return STATUS_OK;
    if (work->things == work->room) {
        const int room = work->room + work->room / 2 + 1024;
        void     *more = realloc(work->thing, (size_t)room * sizeof *work->thing);
        if (!more) return STATUS_NO_MEMORY;
        work->thing = more, work->room = room;
    }
    const double u = clutter_unit(t.rank, 91);
    t.mode = clutter_mode_cold;
    if (row->heat == CLUTTER_LIVES) t.mode = clutter_mode_lives;
    else if (row->heat == CLUTTER_BURNS) t.mode = clutter_mode_burns;
    else if (row->heat == CLUTTER_DRIVES)
        t.mode = clutter_mode_drives + (row->where < CLUTTER_YARDS ? (int)row->where : (int)clutter_off_ways);
    else if (u < row->running) t.mode = row->heat == CLUTTER_WORKS ? clutter_mode_works : clutter_mode_idles;
    else if (u < row->running + row->recent)
        t.mode = clutter_mode_stopped + (int)(clutter_unit(t.rank, 92) * clutter_stops);
    t.radius_m = 0.5f * hypotf(size_m[0], size_m[1]);
    work->thing[work->things++] = t;
    return STATUS_OK;
}

static Status check(const ClutterConfig *c)
{
    bool good = c->landscape && c->density >= 0 && c->density <= 20 && c->most >= 0 &&
                c->most <= clutter_most_objects && c->most_driving >= 0 && c->most_driving <= clutter_most_movers;
    for (int k = 0; k < 2; k++)
        good &= fabs(c->south_west_m[k]) < 1e6 && c->north_east_m[k] >= c->south_west_m[k] &&
                c->north_east_m[k] - c->south_west_m[k] <= widest_square_m;
    if (good) return STATUS_OK;
    log_error(
        "clutter: configuration out of range: density=%g (0 .. 20) most=%d (0 .. %d) driving=%d (0 .. %d) side=%g "
        "x %g m (0 .. %g)",
        c->density, c->most, clutter_most_objects, c->most_driving, clutter_most_movers,
        c->north_east_m[0] - c->south_west_m[0], c->north_east_m[1] - c->south_west_m[1], widest_square_m);
    return STATUS_BAD_VALUE;
}

Status scenery_add_clutter(Scenery *scenery, const ClutterConfig *config)
{
    char   path[4096];
    Status status = check(config);
    if (status != STATUS_OK || !(config->density > 0) || config->most == 0) return status;
    if (!clutter_table_path(path, sizeof path, config->table ? config->table : "countryside")) return STATUS_BAD_VALUE;
    ClutterWork *work = calloc(1, sizeof *work);
    if (!work) return STATUS_NO_MEMORY;
    work->config = config;
    status = clutter_table_read(&work->table, path);
    if (status == STATUS_OK) status = clutter_make_variants(work);
    if (status == STATUS_OK) status = clutter_spots_create(&work->spots, config);
    if (status == STATUS_OK) status = clutter_place_areas(work);
    if (status == STATUS_OK) status = clutter_place_yards(work);
    if (status == STATUS_OK) status = clutter_place_lines(work);
    if (status == STATUS_OK) {
        if (clutter_is_full(work)) log_warn("clutter: more than %d things; next: a lower density", clutter_most_things);
        status = clutter_settle(work);
    }
    if (status == STATUS_OK) status = clutter_into_scenery(scenery, work);
    if (status == STATUS_OK)
        log_detail("clutter: placed: objects=%d models=%d states=%d driving=%d", scenery->objects, scenery->models,
                   scenery->states, scenery->movers);
    else if (status == STATUS_NO_MEMORY) log_error("clutter: no memory; next: a smaller terrain.clutter");
    clutter_spots_destroy(work->spots);
    free(work->variant), free(work->thing), free(work->path), free(work->path_loose), free(work);
    return status;
}
