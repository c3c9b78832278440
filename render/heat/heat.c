/* render/heat/heat.c: steps the columns of the ground, its trunks and branches through an exercise (heat.h). */
#include "render/heat/heat_private.h"

#include "pitviper_simd.h"

#include <stdlib.h>

HeatConfig heat_default_config(void)
{
    return (HeatConfig){.grid = ground_grid_default, .step_s = 600, .spin_up_s = 2 * 86400, .facets = 7};
}

/* ---- columns ----------------------------------------------------------------------------------- */

void heat_facet_normal(double n_enu[3], int u, int v, int facets)
{
    const double a = 2.0 * u / (facets - 1) - 1, b = 2.0 * v / (facets - 1) - 1;
    const double x = 0.5 * (a + b), y = 0.5 * (a - b);
    const double p[3] = {x, y, fmax(1 - fabs(x) - fabs(y), 0)};
    v3_normalize(n_enu, p);
}

static double up_of(int i) { return (double)i / (heat_ups - 1); }

static GroundExposure exposure_of(const Heat *h, int c, double level_k)
{
    const int      facets = h->config.facets, all = facets * facets;
    GroundExposure e = {.sun = 1, .sky = 1, .around_k = level_k};
    if (c < all) {
        heat_facet_normal(e.n_enu, c % facets, c / facets, facets);
    } else if (c < all + 2 * heat_ups) {
        const double up = up_of((c - all) % heat_ups);
        e.n_enu[0] = sqrt(1 - up * up), e.n_enu[2] = up, e.sun = 0;
    } else {
        e.n_enu[2] = 1, e.sun = 0, e.sky = 0;
    }
    return e;
}

static bool without_sun(const Heat *h, int c)
{
    const int all = h->config.facets * h->config.facets;
    return c >= all + heat_ups && c < all + 2 * heat_ups;
}

static GroundWeather no_sun(const GroundWeather *w)
{
    GroundWeather out = *w;
    out.direct_w_m2 = out.diffuse_w_m2 = 0;
    return out;
}

typedef struct StepJob {
    Heat                *heat;
    double               dt_s;
    const GroundWeather *before, *after;
} StepJob;

static void step_kind(void *user, int worker, int task)
{
    const StepJob      *job = user;
    Heat               *h = job->heat;
    KindState          *s = &h->state[task];
    const int           level = h->config.facets * h->config.facets / 2;
    const double        level_k = s->column[level].state.temp_k[0];
    const GroundWeather dark[2] = {no_sun(job->before), no_sun(job->after)};
    (void)worker;
    if (task == SURFACE_NONE) return;
    for (int c = 0; c < h->columns; c++) {
        const bool           night = without_sun(h, c), hidden = c == h->columns - 1;
        const GroundExposure e = exposure_of(h, c, hidden ? job->before->air.temp_k : level_k);
        s->column[c].factors = h->factors[job->dt_s > h->config.step_s][task];
        ground_column_step(&s->column[c], h->config.grid.tolerance_k, night ? &dark[0] : job->before,
                           night ? &dark[1] : job->after, &e, job->dt_s);
    }
}

/* Steps all branches, in the sun and in the shade; the ground below them is grass. */
static void step_branches(Heat *h, const GroundWeather *after, double dt_s)
{
    const double grass_k = h->state[SURFACE_GRASS].column[h->config.facets * h->config.facets / 2].state.temp_k[0];
    for (int k = 0; k < h->branches; k++)
        for (int r = 0; r < branch_radii; r++)
            for (int shade = 0; shade < 2; shade++)
                heat_branch_step(&h->branch[k][r][shade], after, shade ? 0 : 1, grass_k, dt_s);
}

/* The sky of a time, and how each level column there gives heat away; of the times since the last one too. */
static void remember(Heat *h, int steps)
{
    const int            at = place_of(h->index), level = h->config.facets * h->config.facets / 2;
    const GroundWeather *w = &h->weather[1];
    const double         air_w_m2 = stefan_w_m2k4 * pow(w->air.temp_k, 4);
    h->sky[at] = (Sky){w->direct_w_m2, w->diffuse_w_m2, air_w_m2 - w->longwave_w_m2};
    for (int k = 1; k < ground_kinds; k++) {
        const GroundColumn  *c = &h->state[k].column[level];
        const GroundExposure e = exposure_of(h, level, 0);
        SurfaceFlux          flux;
        double               a, b;
        ground_flux(&flux, c, w, &e);
        const double warm = surface_flux_w_m2(&a, c->state.temp_k[0] + 0.5, &flux);
        const double cold = surface_flux_w_m2(&b, c->state.temp_k[0] - 0.5, &flux);
        for (int s = 0; s < steps; s++) h->state[k].falls_w_m2k[place_of(h->index - s)] = (float)fmax(cold - warm, 0.1);
    }
    for (int s = 1; s < steps; s++) h->sky[place_of(h->index - s)] = h->sky[at];
}

static void advance(Heat *h, int steps)
{
    const GroundWeather after = *heat_course_at(&h->course, h->index + steps);
    h->weather[0] = h->weather[1];
    heat_run(h->config.pool, ground_kinds, step_kind, &(StepJob){h, steps * h->config.step_s, &h->weather[0], &after});
    step_branches(h, &after, steps * h->config.step_s);
    h->index += steps;
    h->weather[1] = after;
    remember(h, steps);
}

static void fill_past(Heat *h, HeatPast *out)
{
    Interval  interval[heat_past];
    const int count = heat_past_begin(h, out, interval);
    heat_run(h->config.pool, ground_kinds, heat_past_respond, &(PastJob){h, interval, count, out});
}

/* ---- tables ------------------------------------------------------------------------------------ */

static int slot_at(double unix_s) { return (int)((unix_s - floor(unix_s / day_s) * day_s) / slot_s) % heat_day_slots; }

static void fill_table(Heat *h, GroundHeatTable *out, const HeatPast *past)
{
    const int all = h->config.facets * h->config.facets;
    *out = (GroundHeatTable){
        .unix_s = (double)h->index * h->config.step_s, .facets = h->config.facets, .air_k = h->weather[1].air.temp_k};
    for (int k = 1; k < ground_kinds; k++) {
        const GroundColumn *c = h->state[k].column;
        for (int i = 0; i < all; i++) out->sun_k[k][i] = (float)c[i].state.temp_k[0];
        for (int i = 0; i < heat_ups; i++) {
            out->shade_k[k][i] = (float)c[all + i].state.temp_k[0];
            out->dark_k[k][i] = (float)c[all + heat_ups + i].state.temp_k[0];
        }
        out->hidden_k[k] = (float)c[h->columns - 1].state.temp_k[0];
    }
    for (int k = 0; k < h->branches; k++)
        for (int r = 0; r < branch_radii; r++)
            for (int shade = 0; shade < 2; shade++)
                heat_branch_sides(&out->branch[k][r][shade], &h->branch[k][r][shade]);
    for (int i = 0; i < past->count; i++) {
        /* by halves of an hour: what is longer falls on several */
        const int parts = (int)fmax(1, round(past->span_s[i] / slot_s));
        for (int p = 0; p < parts; p++) {
            const double at_s = past->unix_s[i] + past->span_s[i] * ((p + 0.5) / parts - 0.5);
            const int    slot = h->slot_of[slot_at(at_s)];
            if (slot < 0) continue;
            for (int k = 1; k < ground_kinds; k++) out->slot_k[k][slot] += past->sun_k[k][i] / (float)parts;
        }
    }
}

/* The next step is worked at in parts, ahead of its time, some with each frame, so that no frame pays for all of it:
 * first the columns of each kind, then what they share, then the responses of each kind. */
enum { ahead_parts = 2 * ground_kinds + 1, ahead_a_frame = 8 };

static void work_ahead(Heat *h, int parts)
{
    Ahead       *a = h->ahead;
    const double begun_s = wall_clock_s();
    for (int n = 0; n < parts && a->part < ahead_parts; n++, a->part++) {
        if (a->part == 0) h->config.weather(&a->after, (double)(h->index + 1) * h->config.step_s, h->config.user);
        if (a->part < ground_kinds) {
            step_kind(&(StepJob){h, h->config.step_s, &h->weather[1], &a->after}, 0, a->part);
        } else if (a->part == ground_kinds) {
            step_branches(h, &a->after, h->config.step_s);
            h->index++;
            h->weather[0] = h->weather[1];
            h->weather[1] = a->after;
            remember(h, 1);
            a->intervals = heat_past_begin(h, &a->past, a->interval);
        } else {
            heat_past_respond(&(PastJob){h, a->interval, a->intervals, &a->past}, 0, a->part - ground_kinds - 1);
        }
    }
    h->spent_s += wall_clock_s() - begun_s;
}

static void next_table(Heat *h)
{
    const int level = h->config.facets * h->config.facets / 2;
    work_ahead(h, ahead_parts);
    const double begun_s = wall_clock_s();
    h->table[0] = h->table[1];
    h->past[0] = h->past[1];
    h->past[1] = h->ahead->past;
    fill_table(h, &h->table[1], &h->past[1]);
    for (int k = 0; k < ground_kinds; k++) h->level[0][k] = h->level[1][k], h->level[1][k] = h->state[k].column[level];
    h->ahead->part = 0;
    h->shown = h->index;
    h->spent_s += wall_clock_s() - begun_s;
    h->steps++;
}

/* ---- life -------------------------------------------------------------------------------------- */

static void start_branches(Heat *h, double temp_k)
{
    for (int k = 0; k < h->branches; k++)
        for (int r = 0; r < branch_radii; r++)
            for (int shade = 0; shade < 2; shade++)
                heat_branch_start(&h->branch[k][r][shade], &h->branch_kind[k], branch_radius_m[r], temp_k);
}

/* A day of level ground from the mean of the air: the mean of its surface is what the ground below has. */
static void start_columns(Heat *h)
{
    const int64_t        stride = h->course.wide;
    const int            count = heat_day_strides(&h->config);
    const GroundWeather *w = h->course.at;
    double               air_k = 0;
    for (int i = 0; i < count; i++) air_k += w[i].air.temp_k;
    air_k /= count;
    const GroundExposure level = {{0, 0, 1}, 1, 1, 0};
    for (int k = 1; k < ground_kinds; k++) {
        GroundColumn column;
        double       sum = 0;
        ground_column_start(&column, &h->kinds.kind[k], &h->layers[k], air_k);
        column.factors = h->factors[1][k];
        for (int i = 0; i < count; i++) {
            ground_column_step(&column, h->config.grid.tolerance_k, &w[i], &w[i + 1], &level,
                               (double)stride * h->config.step_s);
            sum += column.state.temp_k[0];
        }
        for (int c = 0; c < h->columns; c++)
            ground_column_start(&h->state[k].column[c], &h->kinds.kind[k], &h->layers[k], sum / count);
    }
    start_branches(h, air_k);
}

static void keep_begun(Heat *h)
{
    for (int k = 0; k < ground_kinds; k++) {
        memcpy(h->begun + (size_t)k * (size_t)h->columns, h->state[k].column, (size_t)h->columns * sizeof *h->begun);
        memcpy(h->begun_falls[k], h->state[k].falls_w_m2k, sizeof h->begun_falls[k]);
    }
    memcpy(h->begun_branch, h->branch, sizeof h->branch);
    memcpy(h->begun_sky, h->sky, sizeof h->sky);
}

static void back_to_begun(Heat *h)
{
    for (int k = 0; k < ground_kinds; k++) {
        memcpy(h->state[k].column, h->begun + (size_t)k * (size_t)h->columns, (size_t)h->columns * sizeof *h->begun);
        memcpy(h->state[k].falls_w_m2k, h->begun_falls[k], sizeof h->begun_falls[k]);
    }
    memcpy(h->sky, h->begun_sky, sizeof h->sky);
    memcpy(h->branch, h->begun_branch, sizeof h->branch);
    h->index = h->begun_index;
    h->ahead->part = 0;
    for (int k = 0; k < ground_kinds; k++) h->level[1][k] = h->state[k].column[h->config.facets * h->config.facets / 2];
    h->config.weather(&h->weather[1], (double)h->index * h->config.step_s, h->config.user);
    fill_past(h, &h->past[1]);
    fill_table(h, &h->table[1], &h->past[1]);
    next_table(h);
}

void heat_factors_of(ColumnFactors out[heat_halvings], const Column *layers, double dt_s)
{
    for (int k = 0; k < heat_halvings; k++) {
        column_factors(&out[k], layers, ldexp(dt_s, -k));
        out[k].half = k + 1 < heat_halvings ? &out[k + 1] : NULL;
    }
}

/* From the spin-up's first time to the beginning of the exercise. */
static void warm(Heat *h)
{
    h->index = h->first;
    start_columns(h);
    h->weather[1] = *heat_course_at(&h->course, h->index);
    remember(h, 1);
    while (h->index < h->course.fine_from) advance(h, (int)h->course.wide);
    while (h->index < h->begun_index) advance(h, 1);
    keep_begun(h);
    back_to_begun(h);
}

/* The same from the cache: a step beyond the beginning, as back_to_begun leaves it. */
static bool fetch(Heat *h, CacheKey *key)
{
    const int level = h->config.facets * h->config.facets / 2;
    if (!h->config.cache) return false;
    for (int k = 1; k < ground_kinds; k++)
        for (int c = 0; c < h->columns; c++) {
            GroundColumn *column = &h->state[k].column[c];
            ground_column_start(column, &h->kinds.kind[k], &h->layers[k], 0);
            column->factors = h->factors[0][k];
            h->begun[(size_t)k * (size_t)h->columns + (size_t)c] = *column;
        }
    start_branches(h, 0);
    memcpy(h->begun_branch, h->branch, sizeof h->branch);
    if (!kept_fetch(heat_kept_values, h, h->config.cache, key)) return false;
    for (int k = 0; k < 2; k++) {
        h->table[k].facets = h->config.facets;
        h->weather[k] = *heat_course_at(&h->course, h->begun_index + k);
    }
    for (int k = 0; k < ground_kinds; k++) {
        h->level[0][k] = h->begun[(size_t)k * (size_t)h->columns + (size_t)level];
        h->level[1][k] = h->state[k].column[level];
    }
    h->index = h->shown = h->begun_index + 1;
    return true;
}

Status heat_create(Heat **out, const GroundKinds *kinds, const HeatConfig *config, const BranchKind *branch,
                   int branches)
{
    const double steps = config->spin_up_s / config->step_s;
    if (!(config->facets >= 3 && config->facets <= heat_most_facets && config->facets % 2 == 1 &&
          config->step_s >= 60 && config->step_s <= 3600 && steps >= 1 && steps <= 1e5 && fabs(config->unix_s) < 1e11 &&
          branches >= 0 && branches <= branch_most_kinds))
        return STATUS_BAD_VALUE;
    Heat *h = calloc(1, sizeof *h);
    if (!h) return STATUS_NO_MEMORY;
    h->kinds = *kinds;
    h->config = *config;
    h->columns = config->facets * config->facets + 2 * heat_ups + 1;
    h->table = calloc(2, sizeof *h->table);
    h->past = calloc(2, sizeof *h->past);
    h->ahead = calloc(1, sizeof *h->ahead);
    h->begun = calloc((size_t)ground_kinds * (size_t)h->columns, sizeof *h->begun);
    Status status = h->table && h->past && h->begun && h->ahead ? STATUS_OK : STATUS_NO_MEMORY;
    for (int k = 0; k < ground_kinds && status == STATUS_OK; k++) {
        h->state[k].column = calloc((size_t)h->columns, sizeof *h->state[k].column);
        status = h->state[k].column ? ground_layers(&h->layers[k], &h->kinds.kind[k], &config->grid) : STATUS_NO_MEMORY;
    }
    if (status != STATUS_OK) {
        heat_destroy(h);
        return status;
    }
    for (int k = 0; k < ground_kinds; k++) {
        heat_factors_of(h->factors[0][k], &h->layers[k], config->step_s);
        heat_factors_of(h->factors[1][k], &h->layers[k], (double)heat_half_hour(&h->config) * config->step_s);
    }
    for (int s = 0; s < SURFACE_COUNT; s++) h->kind_of[s] = s == SURFACE_NONE ? SURFACE_BARE_SOIL : s;
    if (branches > 0) h->kind_of[SURFACE_FOREST_BROADLEAF] = h->kind_of[SURFACE_FOREST_CONIFER] = ground_forest_floor;
    h->branches = branches;
    for (int k = 0; k < branches; k++) h->branch_kind[k] = branch[k];
    h->slots = heat_day_sun(h->slot_of, h->slot_d_enu, &h->config);
    h->begun_index = (int64_t)floor(config->unix_s / config->step_s);
    h->first = h->begun_index - (int64_t)round(steps);
    status = heat_course_find(&h->course, &h->config, h->first, h->begun_index);
    if (status != STATUS_OK) {
        heat_destroy(h);
        return status;
    }
    CacheKey key = {.digest = NULL};
    if (config->cache) key = heat_kept_key(h);
    if (!fetch(h, &key)) {
        warm(h);
        kept_keep(heat_kept_values, h, config->cache, &key);
    }
    free(h->course.at);
    h->course.at = NULL;
    h->spent_s = 0, h->steps = 0;
    *out = h;
    return STATUS_OK;
}

void heat_destroy(Heat *h)
{
    if (!h) return;
    for (int k = 0; k < ground_kinds; k++) free(h->state[k].column);
    free(h->course.at);
    free(h->begun);
    free(h->past);
    free(h->ahead);
    free(h->table);
    free(h);
}

double heat_spent_s(const Heat *h, int *steps)
{
    *steps = h->steps;
    return h->spent_s;
}

size_t heat_bytes(const Heat *h)
{
    return sizeof *h + sizeof *h->ahead + 2 * (sizeof *h->table + sizeof *h->past) +
           2 * (size_t)ground_kinds * (size_t)h->columns * sizeof *h->begun;
}

void heat_level(GroundColumn *out, const Heat *h, int kind, double share)
{
    const GroundColumn *from = &h->level[0][kind], *to = &h->level[1][kind];
    *out = *from;
    for (int i = 0; i < from->column->nodes; i++)
        out->state.temp_k[i] += share * (to->state.temp_k[i] - from->state.temp_k[i]);
    out->saturation += share * (to->saturation - from->saturation);
}

int heat_slots(float d_enu[3][heat_day_slots], const Heat *h)
{
    memcpy(d_enu, h->slot_d_enu, sizeof h->slot_d_enu);
    return h->slots;
}

/* ---- now --------------------------------------------------------------------------------------- */

static void blend(float *out, const float *a, const float *b, float share, size_t count)
{
    for (size_t i = 0; i < count; i++) out[i] = a[i] + share * (b[i] - a[i]);
}

Status heat_now(HeatNow **out, Heat *h, double unix_s, Arena *arena)
{
    const double step_s = h->config.step_s, at = fmax(unix_s / step_s, (double)h->begun_index);
    if (!(at < 1e12)) return STATUS_BAD_VALUE;
    if (at < (double)(h->shown - 1)) back_to_begun(h);
    while (at > (double)h->shown) next_table(h);
    HeatNow *now = arena_alloc(arena, 1, sizeof *now);
    if (!now) return STATUS_NO_MEMORY;
    const GroundHeatTable *a = &h->table[0], *b = &h->table[1];
    const float            share = (float)(at - (double)(h->shown - 1));
    now->share = (double)share;
    now->table = (GroundHeatTable){
        .unix_s = unix_s, .facets = a->facets, .air_k = a->air_k + (double)share * (b->air_k - a->air_k)};
    const size_t floats = (sizeof(GroundHeatTable) - offsetof(GroundHeatTable, sun_k)) / sizeof(float);
    blend(&now->table.sun_k[0][0], &a->sun_k[0][0], &b->sun_k[0][0], share, floats);
    memcpy(now->slot_d_enu, h->slot_d_enu, sizeof now->slot_d_enu);
    memcpy(now->kind_of, h->kind_of, sizeof now->kind_of);
    memcpy(now->past, h->past, sizeof now->past);
    now->slots = h->slots;
    now->branches = h->branches;
    for (int k = 0; k < h->branches; k++) now->branch_material[k] = h->branch_kind[k].material;
    work_ahead(h, ahead_a_frame);
    *out = now;
    return STATUS_OK;
}
