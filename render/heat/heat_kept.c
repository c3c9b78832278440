/* render/heat/heat_kept.c: the ground as it is at the beginning of an exercise, from the cache and into it. */
#include "render/heat/heat_private.h"

void heat_kept_ground(CacheKey *key, const GroundKind *g)
{
    const int32_t kind[] = {g->layers, (int32_t)g->vapour};
    const double  soil[] = {g->porosity,    g->quartz,         g->saturation,  g->rock_w_mk,  g->rock_j_m3k,
                            g->roughness_m, g->resistance_s_m, g->absorptance, g->emissivity, g->melts_k};
    cache_key_add(key, kind, sizeof kind);
    cache_key_add(key, soil, sizeof soil);
    for (int i = 0; i < g->layers; i++) cache_key_add(key, &g->layer[i], sizeof g->layer[i]);
}

/* What it follows from: the grid, what the ground is made of, and the weather at every time that warms it. Weather
 * after the exercise's beginning is in it up to the next time of the grid. */
CacheKey heat_kept_key(const Heat *h)
{
    const HeatConfig *c = &h->config;
    const double      number[] = {c->grid.first_m, c->grid.growth, c->grid.depth_m, c->grid.tolerance_k,
                                  c->step_s,       c->spin_up_s,   c->unix_s};
    const int64_t     whole[] = {c->facets, h->branches, h->course.wide, h->course.coarse, h->course.fine};
    CacheKey          key = cache_key("warm ground");
    cache_key_add(&key, number, sizeof number);
    cache_key_add(&key, whole, sizeof whole);
    for (int k = 0; k < ground_kinds; k++) heat_kept_ground(&key, &h->kinds.kind[k]);
    for (int k = 0; k < h->branches; k++) {
        const BranchKind *b = &h->branch_kind[k];
        const double      wood[] = {b->conductivity_w_mk, b->capacity_j_m3k, b->absorptance, b->emissivity};
        cache_key_add(&key, wood, sizeof wood);
    }
    _Static_assert(sizeof(ColumnLayer) == 3 * sizeof(double) && sizeof(GroundWeather) == 13 * sizeof(double),
                   "no padding");
    cache_key_add(&key, h->course.at, (size_t)(h->course.coarse + h->course.fine) * sizeof *h->course.at);
    return key;
}

static void pass_column(Kept *kept, GroundColumn *column, const Column *layers)
{
    int32_t halved = column->state.halved;
    kept_doubles(kept, column->state.temp_k, (size_t)layers->nodes);
    kept_doubles(kept, &column->state.heat_j_m2, 1);
    kept_doubles(kept, &column->saturation, 1);
    kept_pass(kept, &halved, sizeof halved);
    column->state.halved = halved;
}

static void pass_branches(Kept *kept, const Heat *h, Branch branch[][branch_radii][2])
{
    for (int k = 0; k < h->branches; k++)
        for (int r = 0; r < branch_radii; r++)
            for (int shade = 0; shade < 2; shade++) {
                kept_doubles(kept, branch[k][r][shade].part[0], (size_t)6 * branch_rings);
                kept_doubles(kept, branch[k][r][shade].face_k, 6);
            }
}

static void pass_past(Kept *kept, HeatPast *past)
{
    int32_t count = past->count;
    kept_pass(kept, &count, sizeof count);
    kept_check(kept, count >= 0 && count <= heat_past);
    past->count = kept->good ? count : 0;
    kept_doubles(kept, past->unix_s, heat_past);
    kept_doubles(kept, past->span_s, heat_past);
    kept_doubles(kept, past->sun_d_enu[0], (size_t)3 * heat_past);
    kept_floats(kept, past->watt_k[0], (size_t)ground_kinds * heat_past);
    kept_floats(kept, past->sun_k[0], (size_t)ground_kinds * heat_past);
    kept_floats(kept, past->sky_k[0], (size_t)ground_kinds * heat_past);
    kept_floats(kept, past->effusivity, ground_kinds);
    kept_floats(kept, past->diffusivity, ground_kinds);
}

static void pass_table(Kept *kept, GroundHeatTable *table)
{
    kept_doubles(kept, &table->unix_s, 1);
    kept_doubles(kept, &table->air_k, 1);
    kept_floats(kept, table->sun_k[0], (sizeof *table - offsetof(GroundHeatTable, sun_k)) / sizeof(float));
}

/* KeptValues of a Heat whose columns are started, with its course: its state at the beginning, and a step on. */
void heat_kept_values(Kept *kept, void *user)
{
    Heat *h = user;
    for (int k = 1; k < ground_kinds; k++)
        for (int c = 0; c < h->columns; c++) {
            pass_column(kept, &h->begun[(size_t)k * (size_t)h->columns + (size_t)c], &h->layers[k]);
            pass_column(kept, &h->state[k].column[c], &h->layers[k]);
        }
    kept_floats(kept, h->begun_falls[1], (size_t)(ground_kinds - 1) * history);
    for (int k = 1; k < ground_kinds; k++) kept_floats(kept, h->state[k].falls_w_m2k, history);
    kept_doubles(kept, &h->begun_sky[0].direct_w_m2, (size_t)3 * history);
    kept_doubles(kept, &h->sky[0].direct_w_m2, (size_t)3 * history);
    pass_branches(kept, h, h->begun_branch);
    pass_branches(kept, h, h->branch);
    for (int i = 0; i < 2; i++) {
        pass_table(kept, &h->table[i]);
        pass_past(kept, &h->past[i]);
    }
}
