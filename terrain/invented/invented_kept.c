/* terrain/invented/invented_kept.c: invented ground from the cache, and into it. */
#include "terrain/invented/ways_private.h"

#include <limits.h>
#include <stdlib.h>

/* ---- sea -------------------------------------------------------------------------------------- */

static void pass_count(Kept *kept, int *count, int most)
{
    int32_t value = *count;
    kept_pass(kept, &value, sizeof value);
    kept_check(kept, value >= 0 && value <= most);
    *count = kept->good ? value : 0;
}

/* Room for as many rows as were counted, while they are read: of these octets in the entry, and in memory. */
static bool make_room(Kept *kept, void *rows, int count, size_t octets, size_t row)
{
    if (!kept_is_read(kept) || !kept_has(kept, (size_t)count * octets)) return kept->good;
    void *made = calloc((size_t)count + 1, row);
    kept_check(kept, made);
    memcpy(rows, &made, sizeof made);
    return kept->good;
}

static void pass_coast(Kept *kept, Coast *c)
{
    uint8_t there[coast_grids];
    pass_count(kept, &c->sea_count, INT_MAX);
    pass_count(kept, &c->land_count, INT_MAX);
    kept_doubles(kept, &c->h_m, 1);
    kept_pass(kept, &c->seed, sizeof c->seed);
    if (c->sea_count && make_room(kept, &c->sea, c->sea_count, sizeof *c->sea, sizeof *c->sea))
        kept_doubles(kept, c->sea[0], 2 * (size_t)c->sea_count);
    if (c->land_count && make_room(kept, &c->land, c->land_count, sizeof *c->land, sizeof *c->land))
        kept_doubles(kept, c->land[0], 2 * (size_t)c->land_count);
    for (int g = 0; g < coast_grids; g++) there[g] = c->cell[g] != NULL;
    kept_pass(kept, there, sizeof there);
    for (int g = 0; g < coast_grids && kept->good; g++) {
        const size_t cells = (size_t)coast_cells * coast_cells;
        kept_check(kept, there[g] <= 1);
        if (!there[g] || !make_room(kept, &c->cell[g], (int)cells, 1, 1)) continue;
        kept_pass(kept, c->cell[g], cells);
        for (size_t n = 0; kept_is_read(kept) && n < cells; n++) kept_check(kept, c->cell[g][n] <= COAST_UNSURE);
    }
}

/* ---- ways ------------------------------------------------------------------------------------- */

enum { segment_octets = 8 * sizeof(float) + 3 };

static void pass_segments(Kept *kept, Ways *w)
{
    for (int n = 0; n < w->segments && kept->good; n++) {
        WaySegment *s = &w->segment[n];
        kept_floats(kept, &s->x_m, 8);
        kept_pass(kept, &s->way, sizeof s->way);
        kept_pass(kept, &s->kind, sizeof s->kind);
        kept_check(kept, s->way < w->ways && s->kind < WAY_KINDS);
    }
}

/* The items of each index cell, which name rows that there are. */
static void pass_index(Kept *kept, Ways *w)
{
    const int rows[] = {w->segments, w->ponds, w->plots, 0}, cells = w->nx * w->ny;
    if (!make_room(kept, &w->start, cells + 1, sizeof *w->start, sizeof *w->start)) return;
    kept_pass(kept, w->start, ((size_t)cells + 1) * sizeof *w->start);
    if (!kept->good) return;
    kept_check(kept, w->start[0] == 0);
    for (int n = 0; kept_is_read(kept) && n < cells; n++) kept_check(kept, w->start[n] <= w->start[n + 1]);
    if (!kept->good) return;
    const int items = w->start[cells];
    if (!make_room(kept, &w->item, items, sizeof *w->item, sizeof *w->item)) return;
    kept_pass(kept, w->item, (size_t)items * sizeof *w->item);
    for (int n = 0; kept_is_read(kept) && kept->good && n < items; n++)
        kept_check(kept, w->item[n] >> 28 < WAY_ITEMS && (int)(w->item[n] & 0x0fffffff) < rows[w->item[n] >> 28 & 3]);
}

static void pass_ways(Kept *kept, Ways *w)
{
    enum { most_side = 1 << 14 };
    double number[] = {w->x0_m, w->y0_m, w->side_m[0], w->side_m[1], w->index_m, w->coarse_m};
    _Static_assert(sizeof(HousePlot) == 10 * sizeof(double) && sizeof(Pond) == (3 + pond_radii) * sizeof(float),
                   "numbers of one kind alone");
    kept_doubles(kept, number, 6);
    kept_check(kept, number[2] > 0 && number[3] > 0 && number[4] > 0 && number[5] > 0);
    w->x0_m = number[0], w->y0_m = number[1], w->side_m[0] = number[2], w->side_m[1] = number[3];
    w->index_m = number[4], w->coarse_m = number[5];
    int *const count[] = {&w->nx, &w->ny, &w->cx, &w->cy, &w->segments, &w->ponds, &w->plots, &w->ways, &w->villages};
    for (int k = 0; k < 9; k++) pass_count(kept, count[k], k < 4 ? most_side : 0x0fffffff);
    kept_check(kept, w->nx >= 1 && w->ny >= 1 && w->cx >= 2 && w->cy >= 2 && w->villages <= ways_most_villages);
    if (!kept->good) return;
    if (make_room(kept, &w->segment, w->segments, segment_octets, sizeof *w->segment)) pass_segments(kept, w);
    if (make_room(kept, &w->pond, w->ponds, sizeof *w->pond, sizeof *w->pond) && w->ponds)
        kept_floats(kept, &w->pond->x_m, (size_t)w->ponds * (sizeof *w->pond / sizeof(float)));
    if (make_room(kept, &w->plot, w->plots, sizeof *w->plot, sizeof *w->plot) && w->plots)
        kept_doubles(kept, &w->plot->x_m, (size_t)w->plots * (sizeof *w->plot / sizeof(double)));
    if (!kept->good) return;
    pass_index(kept, w);
    kept_doubles(kept, w->village[0], 2 * (size_t)w->villages);
    if (make_room(kept, &w->wet, w->cx * w->cy, sizeof *w->wet, sizeof *w->wet))
        kept_pass(kept, w->wet, (size_t)w->cx * (size_t)w->cy * sizeof *w->wet);
}

/* ---- all of it -------------------------------------------------------------------------------- */

void invented_kept_values(Kept *kept, void *user)
{
    InventedTerrain *t = user;
    uint8_t          ways = t->ground.ways != NULL;
    kept_doubles(kept, &t->fit_worst_m, 1);
    pass_count(kept, &t->fixes_dropped, INT_MAX);
    kept_pass(kept, &t->ground.seed, sizeof t->ground.seed);
    kept_pass(kept, &ways, sizeof ways);
    kept_check(kept, ways <= 1);
    elevation_kept_values(kept, &t->elevation);
    if (!kept->good) return;
    pass_coast(kept, &t->ground.coast);
    if (!ways || !kept->good) return;
    if (make_room(kept, &t->ground.ways, 0, 0, sizeof *t->ground.ways)) pass_ways(kept, t->ground.ways);
}

void invented_free(InventedTerrain *terrain)
{
    elevation_destroy(&terrain->elevation);
    invented_ground_free(&terrain->ground);
    *terrain = (InventedTerrain){0};
}

/* Everything that it follows from. */
static CacheKey key_of(const LandscapeConfig *config, const LocalFrame *frame, const LandscapeEvidence *evidence)
{
    const double  number[] = {config->relief_m,      config->spacing_m,     config->half_width_m, config->horizon_m,
                              frame->origin.lat_rad, frame->origin.lon_rad, frame->origin.h_m,    evidence->sea_h_m};
    const int64_t count[] = {evidence->fix_count, evidence->line_count, evidence->place_count};
    CacheKey      key = cache_key("invented ground");
    cache_key_add(&key, &config->seed, sizeof config->seed);
    cache_key_add(&key, number, sizeof number);
    cache_key_add(&key, frame->origin_ecef, sizeof frame->origin_ecef);
    cache_key_add(&key, frame->r_ecef_from_enu, sizeof frame->r_ecef_from_enu);
    cache_key_add(&key, count, sizeof count);
    for (int n = 0; n < evidence->fix_count; n++) {
        const int64_t voter = evidence->fix[n].voter;
        cache_key_add(&key, evidence->fix[n].p_enu, sizeof evidence->fix[n].p_enu);
        cache_key_add(&key, &voter, sizeof voter);
    }
    for (int n = 0; n < evidence->line_count; n++) cache_key_add(&key, &evidence->line[n], sizeof evidence->line[n]);
    for (int n = 0; n < evidence->place_count; n++) {
        const double place[] = {evidence->place[n].x_m, evidence->place[n].y_m, evidence->place[n].sea};
        cache_key_add(&key, place, sizeof place);
    }
    return key;
}

Status invented_create_kept(InventedTerrain *out, const LandscapeConfig *config, const LocalFrame *frame,
                            const LandscapeEvidence *evidence, Cache *cache)
{
    InventedTerrain terrain = {0};
    if (!cache) return invented_create(out, config, frame, evidence);
    CacheKey key = key_of(config, frame, evidence);
    if (kept_fetch(invented_kept_values, &terrain, cache, &key)) {
        *out = terrain;
        return STATUS_OK;
    }
    invented_free(&terrain);
    const Status status = invented_create(out, config, frame, evidence);
    if (status == STATUS_OK) kept_keep(invented_kept_values, out, cache, &key);
    return status;
}
