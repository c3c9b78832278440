/* render/light/sky_horizon.c: horizons that buildings make, on a grid, and the light that they leave. */
#include "render/light/sky_horizon.h"

#include "pitviper_simd.h"

#include <stdlib.h>

enum {
    sectors = sky_horizon_sectors,
    tile_side = 32,
    tile_cells = tile_side * tile_side,
    most_heights = 16 << 20,
    most_steps = 40,
    finer = 4
};
static const double reach_m = 80, finest_m = 2, height_step_m = 0.25;
static const double before_cells = 1.2;
static const float  no_top_m = -1e9f;

/* sin h of 255, the root of the mean square of the sector's directions, since level ground loses sin^2 of the light
 * that comes from there; 0.25 m. */
typedef struct Cell {
    uint8_t slope[sectors], height[sectors];
    float   ground_m;
} Cell;

struct SkyHorizons {
    double x0_m, y0_m, cell_m;
    int    tiles_x, tiles_y, tiles;
    int   *tile_of; /* [tiles_x tiles_y]: -1: none */
    Cell  *cell;    /* [tiles][tile_cells] */
    double wall_rho[optical_channel_count];
};

/* ---- making -------------------------------------------------------------------------------------- */

typedef struct Step {
    int   x, y;
    float per_m; /* 1 / distance */
} Step;

typedef struct Making {
    SkyHorizons     *h;
    const Elevation *elevation;
    float           *top_m; /* [ny][nx], `fine` of them a cell each way: the side of a building is known that well */
    int              nx, ny, fine;
    int             *tile; /* [tiles]: where each lies */
    int              steps;
    Step             step[2 * sectors][most_steps];
} Making;

static bool is_building(const Scenery *s, int k) { return s->object[k].kind == SCENERY_BUILDINGS; }

/* What buildings cover, with the reach about it; false: there are none. */
static bool bounds_of(double low[2], double high[2], const SceneryTracer *tracer)
{
    const Scenery *s = scenery_tracer_of(tracer);
    bool           any = false;
    for (int c = 0; c < 2; c++) low[c] = INFINITY, high[c] = -INFINITY;
    for (int k = 0; k < s->objects; k++) {
        double box[2][3];
        if (!is_building(s, k) || !scenery_tracer_box(tracer, k, box[0], box[1])) continue;
        any = true;
        for (int c = 0; c < 2; c++)
            low[c] = fmin(low[c], box[0][c] - reach_m), high[c] = fmax(high[c], box[1][c] + reach_m);
    }
    return any;
}

/* Tiles within reach of a building; returns their number. */
static int mark_tiles(SkyHorizons *h, const SceneryTracer *tracer)
{
    const Scenery *s = scenery_tracer_of(tracer);
    const double   tile_m = tile_side * h->cell_m;
    int            count = 0;
    for (int t = 0; t < h->tiles_x * h->tiles_y; t++) h->tile_of[t] = -1;
    for (int k = 0; k < s->objects; k++) {
        double box[2][3];
        if (!is_building(s, k) || !scenery_tracer_box(tracer, k, box[0], box[1])) continue;
        const int left = (int)clamp((box[0][0] - reach_m - h->x0_m) / tile_m, 0, h->tiles_x - 1);
        const int right = (int)clamp((box[1][0] + reach_m - h->x0_m) / tile_m, 0, h->tiles_x - 1);
        const int below = (int)clamp((box[0][1] - reach_m - h->y0_m) / tile_m, 0, h->tiles_y - 1);
        const int above = (int)clamp((box[1][1] + reach_m - h->y0_m) / tile_m, 0, h->tiles_y - 1);
        for (int j = below; j <= above; j++)
            for (int i = left; i <= right; i++)
                if (h->tile_of[j * h->tiles_x + i] < 0) h->tile_of[j * h->tiles_x + i] = count++;
    }
    return count;
}

static float top_at(const Making *m, int i, int j)
{
    return i < 0 || j < 0 || i >= m->nx || j >= m->ny ? no_top_m : m->top_m[(size_t)j * (size_t)m->nx + (size_t)i];
}

/* The cell itself, or the nearest that no building covers: the ground there is what is seen. */
static void uncovered(int at[2], const Making *m, int i, int j)
{
    at[0] = i, at[1] = j;
    for (int ring = 0; ring < 8 * m->fine; ring++) {
        int best = 1 << 20;
        for (int y = -ring; y <= ring; y++)
            for (int x = -ring; x <= ring; x++) {
                if (top_at(m, i + x, j + y) > no_top_m || x * x + y * y >= best) continue;
                best = x * x + y * y, at[0] = i + x, at[1] = j + y;
            }
        if (best < 1 << 20) return;
    }
}

/* Two directions a sector, each in growing steps. */
static void list_ways(Making *m)
{
    const double cell_m = m->h->cell_m / m->fine;
    for (int k = 0; k < 2 * sectors; k++) {
        const double azimuth = 2 * pi_rad * (0.5 * k - 0.25) / sectors;
        double       before = 0;
        m->steps = 0;
        for (double way = 1; way * cell_m <= reach_m && m->steps < most_steps;
             way += way < 4 * m->fine ? 1 : 0.25 * way) {
            Step *to = &m->step[k][m->steps++];
            to->x = (int)lround(way * sin(azimuth)), to->y = (int)lround(way * cos(azimuth));
            to->per_m = (float)(1 / (0.5 * (before + way) * cell_m)); /* its side lies between the two */
            before = way;
        }
    }
}

static void fill_cell(Cell *out, const Making *m, int i, int j)
{
    const double cell_m = m->h->cell_m, x_m = m->h->x0_m + i * cell_m, y_m = m->h->y0_m + j * cell_m;
    int          at[2];
    *out = (Cell){.ground_m = (float)elevation_height(m->elevation, x_m, y_m, NULL)};
    uncovered(at, m, i * m->fine, j * m->fine);
    for (int s = 0; s < sectors; s++) {
        float sum = 0, height_m = 0;
        for (int k = 2 * s; k < 2 * s + 2; k++) {
            float tangent = 0;
            for (int n = 0; n < m->steps; n++) {
                const Step *step = &m->step[k][n];
                const float rise_m = top_at(m, at[0] + step->x, at[1] + step->y) - out->ground_m;
                /* a ridge behind its eaves makes the shadow, not the horizon close to the wall */
                if (rise_m * step->per_m > 0.5f * tangent && rise_m > height_m) height_m = rise_m;
                if (rise_m * step->per_m > tangent) tangent = rise_m * step->per_m;
            }
            sum += 0.5f * tangent * tangent / (1 + tangent * tangent);
        }
        out->slope[s] = (uint8_t)(255 * sqrtf(sum) + 0.5f);
        out->height[s] = (uint8_t)clamp((double)height_m / height_step_m + 0.5, 1, 255);
    }
}

static void fill_tile(void *user, int worker, int task)
{
    const Making *m = user;
    const int     i0 = m->tile[task] % m->h->tiles_x * tile_side, j0 = m->tile[task] / m->h->tiles_x * tile_side;
    (void)worker;
    for (int k = 0; k < tile_cells; k++)
        fill_cell(&m->h->cell[(size_t)task * tile_cells + (size_t)k], m, i0 + k % tile_side, j0 + k / tile_side);
}

/* Reflectance of walls, by their area. */
static void mean_wall(SkyHorizons *h, const Scenery *s, const Materials *materials)
{
    double area = 0;
    for (int m = 0; m < s->models; m++) {
        const Model *model = &s->model[m];
        for (int p = 0; p < model->part_count; p++) {
            const ModelPart *part = &model->part[p];
            const int        row = materials_find(materials, part->material);
            double           upright = 0;
            for (int t = part->first_triangle; t < part->first_triangle + part->triangle_count; t++) {
                const uint32_t *v = model->triangle[t];
                double          ab[3], ac[3], n[3];
                v3_sub(ab, model->vertex[v[1]], model->vertex[v[0]]);
                v3_sub(ac, model->vertex[v[2]], model->vertex[v[0]]);
                v3_cross(n, ab, ac);
                upright += fabs(n[2]) < 0.5 * v3_length(n) ? v3_length(n) : 0;
            }
            area += row < 0 ? 0 : upright;
            for (int c = 0; c < optical_channel_count && row >= 0; c++)
                h->wall_rho[c] += upright * (double)materials->material[row].rho[c];
        }
    }
    for (int c = 0; c < optical_channel_count && area > 0; c++) h->wall_rho[c] /= area;
}

static Status fill(SkyHorizons *h, const SceneryTracer *tracer, const Elevation *elevation, Pool *pool)
{
    Making m = {.h = h, .elevation = elevation, .nx = h->tiles_x * tile_side, .ny = h->tiles_y * tile_side};
    m.fine = (int64_t)m.nx * m.ny * finer * finer <= most_heights ? finer : 1;
    m.nx *= m.fine, m.ny *= m.fine;
    const size_t heights = (size_t)m.nx * (size_t)m.ny;
    Status       status = STATUS_OK;
    m.top_m = malloc(heights * sizeof *m.top_m);
    m.tile = malloc(((size_t)h->tiles + 1) * sizeof *m.tile);
    h->cell = malloc(((size_t)h->tiles * tile_cells + 1) * sizeof *h->cell);
    if (!m.top_m || !m.tile || !h->cell) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        list_ways(&m);
        for (size_t k = 0; k < heights; k++) m.top_m[k] = no_top_m;
        scenery_tracer_tops(m.top_m, tracer, m.nx, m.ny, h->x0_m, h->y0_m, h->cell_m / m.fine);
        for (int t = 0; t < h->tiles_x * h->tiles_y; t++)
            if (h->tile_of[t] >= 0) m.tile[h->tile_of[t]] = t;
        if (pool) pool_run(pool, h->tiles, fill_tile, &m);
        else
            for (int t = 0; t < h->tiles; t++) fill_tile(&m, 0, t);
    }
    free(m.top_m);
    free(m.tile);
    return status;
}

Status sky_horizons_create(SkyHorizons **out, const SceneryTracer *tracer, const Elevation *elevation,
                           const Materials *materials, Pool *pool)
{
    double low[2], high[2];
    Status status = STATUS_OK;
    *out = NULL;
    if (!bounds_of(low, high, tracer)) return STATUS_OK;
    SkyHorizons *h = calloc(1, sizeof *h);
    if (!h) return STATUS_NO_MEMORY;
    h->x0_m = low[0], h->y0_m = low[1];
    for (h->cell_m = finest_m;; h->cell_m *= 2) { /* no more heights, and no more cells, than there may be */
        const double tile_m = tile_side * h->cell_m, wide = (high[0] - low[0]) / tile_m,
                     deep = (high[1] - low[1]) / tile_m;
        if (!((wide + 1) * (deep + 1) * tile_cells <= most_heights)) continue;
        h->tiles_x = (int)wide + 1, h->tiles_y = (int)deep + 1;
        free(h->tile_of);
        h->tile_of = malloc((size_t)h->tiles_x * (size_t)h->tiles_y * sizeof *h->tile_of);
        if (!h->tile_of) break;
        h->tiles = mark_tiles(h, tracer);
        if ((int64_t)h->tiles * tile_cells <= sky_horizon_most_cells) break;
    }
    status = h->tile_of ? fill(h, tracer, elevation, pool) : STATUS_NO_MEMORY;
    if (status != STATUS_OK) {
        sky_horizons_destroy(h);
        return status;
    }
    mean_wall(h, scenery_tracer_of(tracer), materials);
    *out = h;
    return STATUS_OK;
}

void sky_horizons_destroy(SkyHorizons *h)
{
    if (!h) return;
    free(h->tile_of);
    free(h->cell);
    free(h);
}

size_t sky_horizons_bytes(const SkyHorizons *h)
{
    return (size_t)h->tiles * tile_cells * sizeof *h->cell + (size_t)h->tiles_x * (size_t)h->tiles_y * sizeof(int);
}

/* ---- a hit --------------------------------------------------------------------------------------- */

static const Cell *cell_at(const SkyHorizons *h, int i, int j)
{
    if (i < 0 || j < 0 || i >= h->tiles_x * tile_side || j >= h->tiles_y * tile_side) return NULL;
    const int tile = h->tile_of[j / tile_side * h->tiles_x + i / tile_side];
    return tile < 0 ? NULL : &h->cell[(size_t)tile * tile_cells + (size_t)(j % tile_side * tile_side + i % tile_side)];
}

static float sum8(F32x8 x)
{
    float each[8], sum = 0;
    f32x8_store(each, x);
    for (int k = 0; k < 8; k++) sum += each[k];
    return sum;
}

/* Light of a sky that is as bright everywhere, on a plane, of the part of a sector above a horizon of this tangent: the
 * integrals over elevation h .. pi/2 of cos^2 and of sin cos. */
static F32x8 above(F32x8 tangent, F32x8 aside, F32x8 up)
{
    const F32x8 one = f32x8_set(1), low = f32x8_less(tangent, one), per = one / f32x8_max(tangent, f32x8_set(1e-6));
    const F32x8 t = f32x8_select(low, tangent, per);
    const F32x8 arc = t * (f32x8_set(0.7853982) + f32x8_set(0.273) * (one - t)); /* arc tangent, within 0.004 */
    const F32x8 left = f32x8_select(low, f32x8_set(0.5 * pi_rad) - arc, arc),
                cosine2 = one / f32x8_fma(tangent, tangent, one);
    return f32x8_max(aside * (left - tangent * cosine2) + up * cosine2, f32x8_set(0));
}

static float ground_under(const SkyHorizons *h, double x_m, double y_m, float z_m)
{
    const Cell *cell = cell_at(h, (int)((x_m - h->x0_m) / h->cell_m), (int)((y_m - h->y0_m) / h->cell_m));
    return cell ? cell->ground_m : z_m;
}

/* What a place sees, of a sky that is as bright everywhere. */
typedef struct Seen {
    float share;      /* that arrives */
    float lit;        /* of what buildings fill: mean cosine of the sun on their walls */
    float shaded;     /* of what buildings fill: share whose walls face ground in their shadow, for that ground's sun */
    float own_high_m; /* of what is behind the place */
} Seen;

static const float sine[8] = {0, 0.70710678f, 1, 0.70710678f, 0, -0.70710678f, -1, -0.70710678f};
static const float cosine[8] = {1, 0.70710678f, 0, -0.70710678f, -1, -0.70710678f, 0, 0.70710678f};

typedef struct Facet {
    F32x8 aside, behind, up, all; /* of sectors: normal along them and against; open light */
    F32x8 sunny, shaded; /* of the walls there that face us: cosine of the sun, share of their ground that is shaded */
    float open;
} Facet;

/* Adds one cell, of this weight, for a place at this height. before_m: the cell is that far before the place, along the
 * normal: what makes its horizon is as much farther from the place. */
static void add_cell(Seen *to, const Cell *cell, float weight, float z_m, const Facet *f, double before_m)
{
    if (!cell || !(f->open > 1e-4f)) {
        to->share += weight;
        return;
    }
    const F32x8 code = f32x8_of_ints(i32x8_of_bytes(cell->slope)) * f32x8_set(1.0 / 255);
    const F32x8 high = f32x8_of_ints(i32x8_of_bytes(cell->height)) * f32x8_set(height_step_m);
    const F32x8 over = _mm256_set1_ps(z_m - cell->ground_m > 0 ? z_m - cell->ground_m : 0);
    const F32x8 near = code / f32x8_sqrt(f32x8_max(f32x8_set(1) - code * code, f32x8_set(1e-6)));
    const F32x8 more = f32x8_fma(near * f32x8_set(before_m), f32x8_max(f->aside, f32x8_set(0)) / high, f32x8_set(1));
    const F32x8 tangent = near / more * f32x8_clamp(f32x8_set(1) - over / high, 0, 1);
    const F32x8 left = f32x8_min(above(tangent, f->aside, f->up), f->all), hidden = f->all - left;
    to->share += weight * sum8(left) / f->open;
    to->lit += weight * sum8(hidden * f->sunny) / f->open;
    to->shaded += weight * sum8(hidden * f->shaded) / f->open;
    to->own_high_m += weight * sum8(f32x8_and(high * f->behind, f32x8_greater(code, f32x8_set(0.24))));
}

/* A place somewhat before its surface, so that its cell is not that of what it is on. light: NULL: the sun is not asked
 * for. */
static Seen seen_at(const SkyHorizons *h, double x_m, double y_m, float z_m, const float n[3],
                    const SkyHorizonLight *light)
{
    const double x = (x_m - h->x0_m) / h->cell_m + before_cells * (double)n[0];
    const double y = (y_m - h->y0_m) / h->cell_m + before_cells * (double)n[1];
    const Seen   all = {.share = 1};
    Seen         seen = {0};
    Facet        f;
    if (!(x >= 0 && y >= 0 && x < h->tiles_x * tile_side && y < h->tiles_y * tile_side)) return all;
    const int   i = (int)x, j = (int)y;
    const Cell *cell[4] = {cell_at(h, i, j), cell_at(h, i + 1, j), cell_at(h, i, j + 1), cell_at(h, i + 1, j + 1)};
    if (!cell[0] && !cell[1] && !cell[2] && !cell[3]) return all;
    const F32x8 east = f32x8_load(sine), north = f32x8_load(cosine), none = f32x8_set(0);
    f.aside = f32x8_fma(_mm256_set1_ps(n[0]), east, _mm256_set1_ps(n[1]) * north);
    f.up = _mm256_set1_ps(n[2]);
    f.behind = f32x8_max(none - f.aside, none);
    const float behind = sum8(f.behind);
    f.behind = f.behind * _mm256_set1_ps(behind > 0.1f ? 1 / behind : 0);
    f.sunny = f.shaded = none;
    if (light) {
        const F32x8 sun_east = _mm256_set1_ps(light->sun_enu[0]), sun_north = _mm256_set1_ps(light->sun_enu[1]);
        f.sunny = f32x8_max(none - f32x8_fma(sun_east, east, sun_north * north), none);
        f.shaded = f32x8_load(light->shaded);
    }
    f.all = above(none, f.aside, f.up);
    f.open = sum8(f.all);
    const float u = (float)(x - i), v = (float)(y - j),
                weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    for (int k = 0; k < 4; k++) add_cell(&seen, cell[k], weight[k], z_m, &f, before_cells * h->cell_m);
    return seen;
}

double sky_horizon_share(const SkyHorizons *h, const double p_enu[3], const double n_enu[3])
{
    const float n[3] = {(float)n_enu[0], (float)n_enu[1], (float)n_enu[2]};
    return (double)seen_at(h, p_enu[0], p_enu[1], (float)p_enu[2], n, NULL).share;
}

void sky_horizon_light(SkyHorizonLight *out, const SkyHorizons *h, const Air *air,
                       const double level_w_m2[AIR_BAND_COUNT])
{
    const Daylight *light = &air->light;
    const double    up = fmax(light->sun_d_enu[2], 0);
    *out = (SkyHorizonLight){.sky = {0}};
    for (int c = 0; c < 3 && up > 0; c++) out->sun_enu[c] = (float)light->sun_d_enu[c];
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        const double sky = light->sky_w_m2[b], sun = b >= AIR_MWIR ? 0 : light->sun_w_m2[b];
        out->sky[b] = (float)sky, out->level[b] = (float)level_w_m2[b];
        /* in the thermal bands about as warm as the ground */
        out->wall[b] = (float)(b >= AIR_MWIR ? level_w_m2[b] : 0.5 * h->wall_rho[b] * (sky + level_w_m2[b]));
        out->sunlit_wall[b] = (float)(b >= AIR_MWIR ? 0 : h->wall_rho[b] * sun);
        out->level_sun[b] = (float)(sun * up > 0 ? sun * up / (sun * up + sky) : 0);
        out->wall_by_sun[b] = b >= AIR_MWIR ? 0 : (float)(0.5 * h->wall_rho[b] * level_w_m2[b]) * out->level_sun[b];
    }
    /* A wall without ends that is turned away from the sun: its shadow is away / up times its height deep, and fills
     * of the ground that a place on it sees 1 - z / sqrt(z^2 + deep^2), on the mean over the wall this. */
    for (int s = 0; s < sectors && up > 0.02; s++) {
        const float deep = fmaxf(out->sun_enu[0] * sine[s] + out->sun_enu[1] * cosine[s], 0) / out->sun_enu[2];
        out->shaded[s] = 1 + deep - sqrtf(1 + deep * deep);
    }
}

/* Of the ground that a wall sees, the share in the shadow of its own building: a strip without ends before it. */
static float own_shade(const SkyHorizonLight *light, const Seen *seen, const float n[3], float above_m)
{
    const float away = -(n[0] * light->sun_enu[0] + n[1] * light->sun_enu[1]);
    if (!(away > 0 && light->sun_enu[2] > 0.02f && seen->own_high_m > 0)) return 0;
    const float deep_m = seen->own_high_m * away / light->sun_enu[2], z_m = above_m > 0.1f ? above_m : 0.1f;
    return 1 - z_m / sqrtf(z_m * z_m + deep_m * deep_m);
}

void sky_horizon_open(float (*factor)[hits_capacity], const SkyHorizons *h, const SkyHorizonLight *light,
                      unsigned air_bands, const Hits *hits)
{
    const F32x8 sky = f32x8_load(light->sky), level = f32x8_load(light->level), wall = f32x8_load(light->wall);
    const F32x8 sunlit = f32x8_load(light->sunlit_wall), level_sun = f32x8_load(light->level_sun);
    const F32x8 by_sun = f32x8_load(light->wall_by_sun);
    for (int i = 0; i < hits->count; i++) {
        if (hits->kind[i] != hit_ground && hits->kind[i] != hit_scenery) continue;
        const float n[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
        const float z_m = (float)hits->p_enu[2][i];
        const Seen  seen = seen_at(h, hits->p_enu[0][i], hits->p_enu[1][i], z_m, n, light);
        float       of[8], shade = 0;
        if (hits->kind[i] == hit_scenery && seen.own_high_m > 0)
            shade = own_shade(light, &seen, n, z_m - ground_under(h, hits->p_enu[0][i], hits->p_enu[1][i], z_m));
        if (seen.share == 1 && shade == 0) continue;
        const F32x8 up = _mm256_set1_ps(0.5f * (1 + n[2])), down = _mm256_set1_ps(0.5f * (1 - n[2])) * level;
        const F32x8 open = f32x8_max(sky * up + down, f32x8_set(1e-20));
        const F32x8 walls = _mm256_set1_ps(1 - seen.share) * wall + _mm256_set1_ps(seen.lit) * sunlit -
                            _mm256_set1_ps(seen.shaded) * by_sun;
        const F32x8 below = down * (f32x8_set(1) - _mm256_set1_ps(shade) * level_sun);
        f32x8_store(of, (up * f32x8_fma(_mm256_set1_ps(seen.share), sky, walls) + below) / open);
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (air_bands >> b & 1) factor[b][i] *= of[b];
    }
}
