/* render/light/sky_horizon_make.c: makes the horizons of buildings on their grid. */
#include "render/light/sky_horizon_private.h"

#include "pitviper_simd.h"

#include <stdlib.h>

enum { sectors = sky_horizon_sectors, ways = 2 * sectors, most_heights = 16 << 20, most_steps = 64, finer = 8 };
static const double reach_m = 80, finest_m = 2, near_m = 12;
static const float  no_top_m = -1e9f, least_wall_m = 1;

typedef struct Step {
    int   x, y;
    float per_m; /* 1 / distance */
} Step;

typedef struct Making {
    SkyHorizons     *h;
    const Elevation *elevation;
    float           *top_m; /* [ny][nx], `fine` of them a cell each way: the side of a building is known that well */
    int              nx, ny, fine;
    float            highest_m;     /* of top_m */
    int             *tile;          /* [tiles]: where each lies */
    int              steps, margin; /* margin: heights that the farthest step goes along x or y */
    Step             step[ways][most_steps];
    double           to_enu[ways][2]; /* where each way leads */
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
    const double   tile_m = horizon_tile_side * h->cell_m;
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
    for (int k = 0; k < ways; k++) {
        const double azimuth = 2 * pi_rad * (0.5 * k - 0.25) / sectors;
        double       before = 0;
        m->steps = 0;
        m->to_enu[k][0] = sin(azimuth), m->to_enu[k][1] = cos(azimuth);
        for (double way = 1; way * cell_m <= reach_m && m->steps < most_steps;
             way += way < 4 * m->fine ? 1 : 0.125 * way) {
            Step *to = &m->step[k][m->steps++];
            to->x = (int)lround(way * sin(azimuth)), to->y = (int)lround(way * cos(azimuth));
            to->per_m = (float)(1 / (0.5 * (before + way) * cell_m)); /* its side lies between the two */
            before = way;
            m->margin = abs(to->x) > m->margin ? abs(to->x) : m->margin;
            m->margin = abs(to->y) > m->margin ? abs(to->y) : m->margin;
        }
    }
}

static float ground_of(const Making *m, int i, int j)
{
    const double cell_m = m->h->cell_m;
    return (float)elevation_height(m->elevation, m->h->x0_m + i * cell_m, m->h->y0_m + j * cell_m, NULL);
}

/* What there is one way. */
typedef struct Found {
    float tangent; /* of the horizon */
    int   first;   /* step at which something stands; -1: none */
} Found;

static Found look(const Making *m, const int at[2], int way, float ground_m)
{
    Found found = {0, -1};
    for (int n = 0; n < m->steps; n++) {
        const Step *step = &m->step[way][n];
        const float rise_m = top_at(m, at[0] + step->x, at[1] + step->y) - ground_m;
        if (found.first < 0 && rise_m > least_wall_m) found.first = n;
        if (rise_m * step->per_m > found.tangent) found.tangent = rise_m * step->per_m;
        if ((m->highest_m - ground_m) * step->per_m <= found.tangent) break; /* nothing farther is above it */
    }
    return found;
}

/* Outward normal of the side of what stands at a place: away from what is covered about it. */
static bool side_normal(double n[2], const Making *m, int i, int j, float above_m)
{
    const int ring = m->fine > 4 ? 4 : 2;
    double    length;
    n[0] = n[1] = 0;
    for (int y = -ring; y <= ring; y++)
        for (int x = -ring; x <= ring; x++)
            if (x * x + y * y <= ring * ring && !(top_at(m, i + x, j + y) > above_m)) n[0] += x, n[1] += y;
    length = hypot(n[0], n[1]);
    if (!(length > 0)) return false;
    n[0] /= length, n[1] /= length;
    return true;
}

/* How far off the plane of this normal is what was found; less than 0: it does not face this way. */
static double plane_away_m(const Making *m, const double n[2], int way, const Found *found)
{
    const double towards = -(n[0] * m->to_enu[way][0] + n[1] * m->to_enu[way][1]);
    return towards > 0.15 && found->first >= 0 ? towards / (double)m->step[way][found->first].per_m : -1;
}

/* How far a side goes on from a place on it, along a direction, in steps of horizon_wall_step_m. */
static uint8_t side_goes(const Making *m, const double from[2], const double along[2], float above_m)
{
    const double step_m = 0.5, cell_m = m->h->cell_m / m->fine;
    double       goes_m = 0;
    while (goes_m < 255 * horizon_wall_step_m) {
        const double next_m = (goes_m + step_m) / cell_m;
        if (!(top_at(m, (int)lround(from[0] + next_m * along[0]), (int)lround(from[1] + next_m * along[1])) > above_m))
            return (uint8_t)((goes_m + 0.5 * step_m) / horizon_wall_step_m);
        goes_m += step_m;
    }
    return 255;
}

/* Ends of the wall whose plane is away_m off, to the left and right of the foot of the perpendicular on it. */
static void wall_ends(HorizonCell *out, const Making *m, const int at[2], const Step *hit, const double n[2],
                      float above_m)
{
    const double cell_m = m->h->cell_m / m->fine, right[2] = {-n[1], n[0]}, within = 2;
    const double from[2] = {at[0] + hit->x - within * n[0], at[1] + hit->y - within * n[1]};
    const double aside_m = (hit->x * right[0] + hit->y * right[1]) * cell_m;
    const double end[2] = {side_goes(m, from, (const double[2]){-right[0], -right[1]}, above_m),
                           side_goes(m, from, right, above_m)};
    /* the foot may lie beyond an end: then the wall begins at the foot */
    out->wall_left = (uint8_t)(end[0] == 255 ? 255 : clamp(end[0] - aside_m / horizon_wall_step_m, 0, 254));
    out->wall_right = (uint8_t)(end[1] == 255 ? 255 : clamp(end[1] + aside_m / horizon_wall_step_m, 0, 254));
}

/* The nearest wall, and what is left to the sectors without it. */
static void fill_wall(HorizonCell *out, const Making *m, const int at[2])
{
    Found  found[ways];
    double n[2], away_m, sum_m = 0;
    bool   of_wall[ways] = {false};
    int    nearest = -1, count = 0;
    for (int k = 0; k < ways; k++) {
        found[k] = look(m, at, k, out->ground_m);
        if (found[k].first >= 0 && found[k].tangent > 0.3f && (nearest < 0 || found[k].first < found[nearest].first))
            nearest = k;
    }
    if (nearest < 0) return;
    const Step *hit = &m->step[nearest][found[nearest].first];
    const float above_m = out->ground_m + least_wall_m;
    if (!side_normal(n, m, at[0] + hit->x, at[1] + hit->y, above_m)) return;
    away_m = plane_away_m(m, n, nearest, &found[nearest]);
    if (!(away_m >= 0 && away_m < near_m)) return;
    for (int k = 0; k < ways; k++) {
        const double other_m = plane_away_m(m, n, k, &found[k]);
        if (!(other_m >= 0 && fabs(other_m - away_m) < fmax(0.2 * away_m, 2 * m->h->cell_m / m->fine))) continue;
        of_wall[k] = true, sum_m += other_m, count++;
    }
    if (!count) return;
    away_m = sum_m / count;
    for (int s = 0; s < sectors; s++) {
        float sum = 0;
        int   others = 0;
        for (int k = 2 * s; k < 2 * s + 2; k++)
            if (!of_wall[k])
                sum += found[k].tangent * found[k].tangent / (1 + found[k].tangent * found[k].tangent), others++;
        out->slope[s] = (uint8_t)(others ? 255 * sqrtf(sum / (float)others) + 0.5f : 0);
    }
    /* what rises farther behind is taken as if it stood there */
    const double rise_m = (double)(found[nearest].tangent / hit->per_m);
    wall_ends(out, m, at, hit, n, above_m);
    out->wall_rise = (uint8_t)clamp(rise_m / horizon_wall_step_m + 0.5, 1, 255);
    out->wall_away = (uint8_t)clamp(away_m / horizon_away_step_m + 0.5, 1, 255);
    out->wall_facing = (uint8_t)((int)lround(256 + 128 / pi_rad * atan2(n[0], n[1])) & 255);
}

/* Whether a wall may be near. */
static bool is_steep(const HorizonCell *cell)
{
    for (int s = 0; s < sectors; s++)
        if (cell->slope[s] > 50) return true;
    return false;
}

static void fill_cell(HorizonCell *out, const Making *m, int i, int j)
{
    int at[2];
    *out = (HorizonCell){.ground_m = ground_of(m, i, j)};
    uncovered(at, m, i * m->fine, j * m->fine);
    const float highest_m = m->highest_m - out->ground_m;
    const bool  open = at[0] == i * m->fine && at[1] == j * m->fine;
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
                if (highest_m * step->per_m <= 0.5f * tangent) break; /* nothing farther counts */
            }
            sum += 0.5f * tangent * tangent / (1 + tangent * tangent);
        }
        out->slope[s] = (uint8_t)(255 * sqrtf(sum) + 0.5f);
        out->height[s] = (uint8_t)clamp((double)height_m / horizon_height_step_m + 0.5, 1, 255);
    }
    out->covered = !open;
    if (open && is_steep(out)) fill_wall(out, m, at);
}

/* Heights of eight cells side by side, the first of which is here. */
static F32x8 tops_of(const Making *m, const float *here)
{
    static const int32_t lane_number[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    const I32x8          lane = i32x8_mul(i32x8_load(lane_number), i32x8_set(m->fine));
    return f32x8_gather(here, lane);
}

/* Whether eight cells from here on are uncovered, and all that they look at is on the grid. */
static bool are_open(const Making *m, int i, int j)
{
    const int x = i * m->fine, y = j * m->fine;
    if (x < m->margin || y < m->margin || x + 8 * m->fine + m->margin > m->nx || y + m->margin >= m->ny) return false;
    const F32x8 top = tops_of(m, m->top_m + (size_t)y * (size_t)m->nx + (size_t)x);
    return f32x8_bits(f32x8_greater(top, f32x8_set((double)no_top_m))) == 0;
}

/* Eight cells side by side that are open: fill_cell, to the same bits. */
static void fill_eight(HorizonCell *out, const Making *m, int i, int j)
{
    const float *here = m->top_m + (size_t)(j * m->fine) * (size_t)m->nx + (size_t)(i * m->fine);
    const F32x8  one = f32x8_set(1), half = f32x8_set(0.5), none = f32x8_set(0);
    const F32x8  highest = f32x8_set((double)m->highest_m);
    float        ground_m[8], slope[8], height_m[8];
    for (int c = 0; c < 8; c++) ground_m[c] = ground_of(m, i + c, j);
    const F32x8 ground = f32x8_load(ground_m);
    for (int c = 0; c < 8; c++) out[c] = (HorizonCell){.ground_m = ground_m[c]};
    for (int s = 0; s < sectors; s++) {
        F32x8 sum = none, high = none;
        for (int k = 2 * s; k < 2 * s + 2; k++) {
            F32x8 tangent = none;
            for (int n = 0; n < m->steps; n++) {
                const Step *step = &m->step[k][n];
                const F32x8 rise = tops_of(m, here + step->y * m->nx + step->x) - ground;
                const F32x8 slopes = rise * _mm256_set1_ps(step->per_m), near = f32x8_greater(slopes, half * tangent);
                high = f32x8_select(f32x8_and(near, f32x8_greater(rise, high)), rise, high);
                tangent = f32x8_select(f32x8_greater(slopes, tangent), slopes, tangent);
                const F32x8 more = (highest - ground) * _mm256_set1_ps(step->per_m);
                if (f32x8_bits(f32x8_greater(more, half * tangent)) == 0) break; /* nothing farther counts */
            }
            sum = sum + half * tangent * tangent / (one + tangent * tangent);
        }
        f32x8_store(slope, f32x8_sqrt(sum));
        f32x8_store(height_m, high);
        for (int c = 0; c < 8; c++) {
            out[c].slope[s] = (uint8_t)(255 * slope[c] + 0.5f);
            out[c].height[s] = (uint8_t)clamp((double)height_m[c] / horizon_height_step_m + 0.5, 1, 255);
        }
    }
    for (int c = 0; c < 8; c++)
        if (is_steep(&out[c])) fill_wall(&out[c], m, (const int[2]){(i + c) * m->fine, j * m->fine});
}

static void fill_tile(void *user, int worker, int task)
{
    const Making *m = user;
    const int     i0 = m->tile[task] % m->h->tiles_x * horizon_tile_side,
              j0 = m->tile[task] / m->h->tiles_x * horizon_tile_side;
    (void)worker;
    for (int k = 0; k < horizon_tile_cells; k += 8) {
        HorizonCell *out = &m->h->cell[(size_t)task * horizon_tile_cells + (size_t)k];
        const int    i = i0 + k % horizon_tile_side, j = j0 + k / horizon_tile_side;
        if (are_open(m, i, j)) fill_eight(out, m, i, j);
        else
            for (int c = 0; c < 8; c++) fill_cell(out + c, m, i + c, j);
    }
}

/* Adds a model's upright sides, as often as it stands there: their area, and reflectance times area. */
static void add_walls(double rho[optical_channel_count], double *area, const Model *model, const Materials *materials,
                      int times)
{
    for (int p = 0; p < model->part_count; p++) {
        const ModelPart *part = &model->part[p];
        const int        row = materials_find(materials, part->material);
        double           upright = 0;
        for (int t = part->first_triangle; t < part->first_triangle + part->triangle_count && row >= 0; t++) {
            const uint32_t *v = model->triangle[t];
            double          ab[3], ac[3], n[3];
            v3_sub(ab, model->vertex[v[1]], model->vertex[v[0]]);
            v3_sub(ac, model->vertex[v[2]], model->vertex[v[0]]);
            v3_cross(n, ab, ac);
            upright += fabs(n[2]) < 0.5 * v3_length(n) ? v3_length(n) : 0;
        }
        *area += times * upright;
        for (int c = 0; c < optical_channel_count && row >= 0; c++)
            rho[c] += times * upright * (double)materials->material[row].rho[c];
    }
}

/* Reflectance of buildings' walls, by their area. */
static Status mean_wall(SkyHorizons *h, const Scenery *s, const Materials *materials)
{
    double area = 0;
    int   *times = calloc((size_t)s->models + 1, sizeof *times);
    if (!times) return STATUS_NO_MEMORY;
    for (int k = 0; k < s->objects; k++)
        if (is_building(s, k) && s->object[k].model >= 0 && s->object[k].model < s->models) times[s->object[k].model]++;
    for (int m = 0; m < s->models; m++)
        if (times[m]) add_walls(h->wall_rho, &area, &s->model[m], materials, times[m]);
    for (int c = 0; c < optical_channel_count && area > 0; c++) h->wall_rho[c] /= area;
    free(times);
    return STATUS_OK;
}

static Status fill(SkyHorizons *h, const SceneryTracer *tracer, const Elevation *elevation, Pool *pool)
{
    Making m = {
        .h = h, .elevation = elevation, .nx = h->tiles_x * horizon_tile_side, .ny = h->tiles_y * horizon_tile_side};
    m.fine = finer;
    while (m.fine > 1 && (int64_t)m.nx * m.ny * m.fine * m.fine > most_heights) m.fine /= 2;
    m.nx *= m.fine, m.ny *= m.fine;
    const size_t heights = (size_t)m.nx * (size_t)m.ny;
    Status       status = STATUS_OK;
    m.top_m = malloc(heights * sizeof *m.top_m);
    m.tile = malloc(((size_t)h->tiles + 1) * sizeof *m.tile);
    h->cell = malloc(((size_t)h->tiles * horizon_tile_cells + 1) * sizeof *h->cell);
    if (!m.top_m || !m.tile || !h->cell) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        list_ways(&m);
        for (size_t k = 0; k < heights; k++) m.top_m[k] = no_top_m;
        scenery_tracer_tops(m.top_m, tracer, m.nx, m.ny, h->x0_m, h->y0_m, h->cell_m / m.fine);
        m.highest_m = no_top_m;
        for (size_t k = 0; k < heights; k++) m.highest_m = fmaxf(m.highest_m, m.top_m[k]);
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
        const double tile_m = horizon_tile_side * h->cell_m, wide = (high[0] - low[0]) / tile_m,
                     deep = (high[1] - low[1]) / tile_m;
        if (!((wide + 1) * (deep + 1) * horizon_tile_cells <= most_heights)) continue;
        h->tiles_x = (int)wide + 1, h->tiles_y = (int)deep + 1;
        free(h->tile_of);
        h->tile_of = malloc((size_t)h->tiles_x * (size_t)h->tiles_y * sizeof *h->tile_of);
        if (!h->tile_of) break;
        h->tiles = mark_tiles(h, tracer);
        if ((int64_t)h->tiles * horizon_tile_cells <= sky_horizon_most_cells) break;
    }
    status = h->tile_of ? fill(h, tracer, elevation, pool) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = mean_wall(h, scenery_tracer_of(tracer), materials);
    if (status != STATUS_OK) {
        sky_horizons_destroy(h);
        return status;
    }
    for (int k = 0; k < 256; k++)
        h->facing_enu[k][0] = (float)sin(k * pi_rad / 128), h->facing_enu[k][1] = (float)cos(k * pi_rad / 128);
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
    return (size_t)h->tiles * horizon_tile_cells * sizeof *h->cell +
           (size_t)h->tiles_x * (size_t)h->tiles_y * sizeof(int);
}
