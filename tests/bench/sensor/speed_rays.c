/* tests/bench/sensor/speed_rays.c: traces the rays of an image and nothing else. */
#include "tests/bench/sensor/speed_private.h"

#include "tests/bench/bench.h"
#include "render/trace/ground/ground.h"
#include "render/trace/parts/parts.h"

#include <stdlib.h>

enum {
    side_px = 32,
    square_px = 4
}; /* of a frame's tiles at one sample a pixel; of rays that its tracers take together */

/* Rays of a block that pass near one vehicle, in the order in which a frame passes them to its tracer. */
typedef struct Near {
    int entity, first, count; /* of near_ray */
} Near;

/* Of each tile a block of eye rays and, behind it, one of sun rays in squares of 4 x 4; block k has the rays
 * first[k] .. first[k + 1] - 1. */
struct RawRays {
    const Elevation *elevation;
    Pool            *pool;
    Ground           ground;
    int              blocks, count, block_of_tile;
    int             *first;                         /* [blocks + 1] */
    double          *o[3], *d[3], *far_m, *range_m; /* [count] */
    uint8_t         *dark;   /* [count] rays that a vehicle blocks: range_m is not the ground's */
    PosedEntity     *entity; /* in the frame's arena */
    int              entities;
    Near            *near; /* by block */
    int              nears;
    int             *first_near; /* [blocks + 1] */
    int             *near_ray;   /* of the block */
};

static Status pose_all(RawRays *raw, const TrialFrame *f)
{
    const World *world = &f->scene->world;
    raw->entities = f->snapshot.count;
    raw->entity = arena_alloc(f->arena, (size_t)raw->entities + 1, sizeof *raw->entity);
    if (!raw->entity) return STATUS_NO_MEMORY;
    for (int k = 0; k < raw->entities; k++) {
        const SnapshotEntity *e = &f->snapshot.entity[k];
        const Model          *model = catalog_model(world->catalog, e->model);
        NodePose             *pose = arena_alloc(f->arena, (size_t)model->node_count, sizeof *pose);
        double               *joint_value = arena_alloc(f->arena, (size_t)model->node_count, sizeof *joint_value);
        double                p_enu[3], r_enu_from_body[9];
        if (!pose || !joint_value) return STATUS_NO_MEMORY;
        snapshot_pose(pose, joint_value, &f->snapshot, k, model);
        raw->entity[k].node =
            arena_alloc(f->arena, (size_t)parts_node_count(world->tracer, e->model) + 1, sizeof *raw->entity[k].node);
        if (!raw->entity[k].node) return STATUS_NO_MEMORY;
        enu_from_ecef(p_enu, &world->frame, e->p_ecef);
        m3_tmul(r_enu_from_body, world->frame.r_ecef_from_enu, e->r_ecef_from_body);
        parts_pose(&raw->entity[k], world->tracer, e->model, pose, p_enu, r_enu_from_body, snapshot_damage(e));
    }
    return STATUS_OK;
}

static void add_ray(RawRays *raw, const double o[3], const double d[3])
{
    const int i = raw->count++;
    for (int k = 0; k < 3; k++) {
        raw->o[k][i] = o[k];
        raw->d[k][i] = d[k];
    }
    raw->far_m[i] = INFINITY;
}

/* A tile's positions in squares of 4 x 4, as in visibility.c. */
static void in_squares(int order[side_px * side_px], int columns, int rows)
{
    int at = 0;
    for (int y0 = 0; y0 < rows; y0 += square_px)
        for (int x0 = 0; x0 < columns; x0 += square_px)
            for (int y = y0; y < y0 + square_px && y < rows; y++)
                for (int x = x0; x < x0 + square_px && x < columns; x++) order[at++] = y * columns + x;
}

static void add_tile(RawRays *raw, Rays *rays, Hits *hits, const TrialFrame *f, const Visibility *v, int x0, int y0,
                     int *list)
{
    static const double offset_m = 1e-3;
    const View         *view = &f->request.view;
    const int           x1 = x0 + side_px < view->width ? x0 + side_px : view->width;
    const int           y1 = y0 + side_px < view->height ? y0 + side_px : view->height;
    int                 order[side_px * side_px];
    VisibilityCounters  counters = {0};
    rays->count = 0;
    rays->columns = x1 - x0;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            double d_enu[3];
            view_ray(d_enu, view, x + 0.5, y + 0.5);
            for (int k = 0; k < 3; k++) {
                rays->o_enu[k][rays->count] = view->p_enu[k];
                rays->d_enu[k][rays->count] = d_enu[k];
            }
            rays->far_m[rays->count++] = INFINITY;
            add_ray(raw, view->p_enu, d_enu);
        }
    raw->first[++raw->blocks] = raw->count;
    if (raw->block_of_tile < 2) return;
    const int listed =
        visibility_block_entities(list, v, view, (const double[4]){x0, y0, x1, y1}, -1, &(VisibilityCounters){0});
    visibility_first_hit(hits, v, rays, visibility_listed(list, listed, -1), &counters);
    in_squares(order, x1 - x0, y1 - y0);
    for (int k = 0; k < hits->count; k++) {
        const int    i = order[k];
        const double n[3] = {hits->n_geo[0][i], hits->n_geo[1][i], hits->n_geo[2][i]};
        double       start[3];
        if (!(hits->range_m[i] < INFINITY) || !(v3_dot(n, f->air.light.sun_d_enu) > 0)) continue;
        for (int c = 0; c < 3; c++) start[c] = hits->p_enu[c][i] + offset_m * n[c];
        add_ray(raw, start, f->air.light.sun_d_enu);
    }
    raw->first[++raw->blocks] = raw->count;
}

static Status make_room(RawRays *raw, int rays, int blocks)
{
    bool ok = (raw->first = calloc((size_t)blocks + 1, sizeof *raw->first)) != NULL;
    for (int k = 0; k < 3; k++) {
        ok = (raw->o[k] = malloc((size_t)rays * sizeof(double))) && ok;
        ok = (raw->d[k] = malloc((size_t)rays * sizeof(double))) && ok;
    }
    ok = (raw->far_m = malloc((size_t)rays * sizeof(double))) && ok;
    ok = (raw->range_m = malloc((size_t)rays * sizeof(double))) && ok;
    ok = (raw->dark = calloc((size_t)rays, sizeof *raw->dark)) && ok;
    ok = (raw->first_near = calloc((size_t)blocks + 1, sizeof *raw->first_near)) && ok;
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

static bool comes_near(const RawRays *raw, int i, const PosedEntity *e)
{
    double       from[3], across[3];
    const double o[3] = {raw->o[0][i], raw->o[1][i], raw->o[2][i]}, d[3] = {raw->d[0][i], raw->d[1][i], raw->d[2][i]};
    v3_sub(from, e->centre_enu, o);
    const double along = v3_dot(from, d);
    v3_add_scaled(across, from, -along, d);
    return e->model >= 0 && along > -e->radius_m && v3_dot(across, across) < e->radius_m * e->radius_m;
}

/* Counts in a first pass, stores in a second. */
static Status pair_up(RawRays *raw, const View *view)
{
    int order[side_px * side_px], listed = 0;
    for (int pass = 0; pass < 2; pass++) {
        raw->nears = listed = 0;
        for (int b = 0; b < raw->blocks; b++) {
            const int  count = raw->first[b + 1] - raw->first[b], tile = b / raw->block_of_tile;
            const int  across = (view->width + side_px - 1) / side_px, left_px = view->width - tile % across * side_px;
            const int  columns = left_px < side_px ? left_px : side_px;
            const bool eye = b % raw->block_of_tile == 0;
            if (eye) in_squares(order, columns, count / columns);
            for (int e = 0; e < raw->entities; e++) {
                const int before = listed;
                for (int k = 0; k < count; k++) {
                    const int i = eye ? order[k] : k;
                    if (!comes_near(raw, raw->first[b] + i, &raw->entity[e])) continue;
                    if (pass) raw->near_ray[listed] = i;
                    listed++;
                }
                if (listed == before) continue;
                if (pass) raw->near[raw->nears] = (Near){e, before, listed - before};
                raw->nears++;
            }
            raw->first_near[b + 1] = raw->nears;
        }
        if (pass) break;
        raw->near = malloc(((size_t)raw->nears + 1) * sizeof *raw->near);
        raw->near_ray = malloc(((size_t)listed + 1) * sizeof *raw->near_ray);
        if (!raw->near || !raw->near_ray) return STATUS_NO_MEMORY;
    }
    return STATUS_OK;
}

Status raw_rays_create(RawRays **out, const TrialFrame *f)
{
    const View *view = &f->request.view;
    const int   columns = (view->width + side_px - 1) / side_px, rows = (view->height + side_px - 1) / side_px;
    const int   pixels = view->width * view->height;
    RawRays    *raw = calloc(1, sizeof *raw);
    Rays       *rays = malloc(sizeof *rays);
    Hits       *hits = malloc(sizeof *hits);
    int        *list = malloc(((size_t)f->snapshot.count + 1) * sizeof *list);
    Visibility *v = NULL;
    Status      status = raw && rays && hits && list ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = make_room(raw, 2 * pixels, 2 * columns * rows);
    if (status == STATUS_OK)
        status = visibility_create(&v, f->scene->world.tracer, f->scene->landscape, &f->scene->world.frame,
                                   &f->snapshot, false, f->arena);
    if (status == STATUS_OK) status = pose_all(raw, f);
    if (status != STATUS_OK) goto done;

    raw->block_of_tile = f->request.bands & (1u << BAND_OPTICAL | 1u << BAND_MWIR) ? 2 : 1;
    raw->elevation = &f->scene->landscape->elevation;
    raw->pool = f->pool;
    ground_prepare(&raw->ground, raw->elevation);
    for (int y = 0; y < view->height; y += side_px)
        for (int x = 0; x < view->width; x += side_px) add_tile(raw, rays, hits, f, v, x, y, list);
    status = pair_up(raw, view);

done:
    free(rays);
    free(hits);
    free(list);
    if (status == STATUS_OK) *out = raw;
    else raw_rays_destroy(raw);
    return status;
}

void raw_rays_destroy(RawRays *raw)
{
    if (!raw) return;
    for (int k = 0; k < 3; k++) free(raw->o[k]), free(raw->d[k]);
    free(raw->first);
    free(raw->far_m);
    free(raw->range_m);
    free(raw->dark);
    free(raw->first_near);
    free(raw->near);
    free(raw->near_ray);
    free(raw);
}

int  raw_rays_count(const RawRays *raw) { return raw->count; }
void raw_use_pool(RawRays *raw, Pool *pool) { raw->pool = pool; }

/* Position of block b in the arrays. */
typedef struct Part {
    const double *o[3], *d[3], *far_m;
    double       *range_m;
    int           first, count;
} Part;

static Part part_of(const RawRays *raw, int b)
{
    const int first = raw->first[b];
    return (Part){.o = {raw->o[0] + first, raw->o[1] + first, raw->o[2] + first},
                  .d = {raw->d[0] + first, raw->d[1] + first, raw->d[2] + first},
                  .far_m = raw->far_m + first,
                  .range_m = raw->range_m + first,
                  .first = first,
                  .count = raw->first[b + 1] - first};
}

/* Traces the vehicles, then the ground in front of them. */
static void trace_eyes(RawRays *raw, int b)
{
    const Part p = part_of(raw, b);
    uint8_t   *dark = raw->dark + p.first;
    double     limit_m[hits_capacity];
    GroundHit  ground_hit[hits_capacity];
    PartHit    hit[hits_capacity];
    memcpy(limit_m, p.far_m, (size_t)p.count * sizeof *limit_m);
    for (int k = raw->first_near[b]; k < raw->first_near[b + 1]; k++) {
        const Near *near = &raw->near[k];
        parts_first_hits(limit_m, hit, &raw->entity[near->entity], p.o, p.d, limit_m, raw->near_ray + near->first,
                         near->count, false);
    }
    ground_first_hits_together(p.range_m, ground_hit, &raw->ground, p.count, p.o, p.d, limit_m);
    for (int i = 0; i < p.count; i++) dark[i] = limit_m[i] < INFINITY;
    bench_keep(limit_m);
}

/* The vehicles, then the ground for the rays that they do not block. */
static void trace_sun(RawRays *raw, int b)
{
    const Part          p = part_of(raw, b);
    uint8_t            *dark = raw->dark + p.first;
    double              start[3][hits_capacity], range_m[hits_capacity];
    int                 ray[hits_capacity], left = 0;
    const double *const o[3] = {start[0], start[1], start[2]};
    memset(dark, 0, (size_t)p.count);
    for (int k = raw->first_near[b]; k < raw->first_near[b + 1]; k++) {
        const Near *near = &raw->near[k];
        parts_any_hits(dark, &raw->entity[near->entity], p.o, p.d, p.far_m, raw->near_ray + near->first, near->count,
                       false);
    }
    for (int i = 0; i < p.count; i++) {
        p.range_m[i] = NAN;
        if (dark[i]) continue;
        for (int c = 0; c < 3; c++) start[c][left] = p.o[c][i];
        ray[left++] = i;
    }
    ground_first_hits_together(range_m, NULL, &raw->ground, left, o, p.d, p.far_m);
    for (int i = 0; i < left; i++) p.range_m[ray[i]] = range_m[i];
}

static void trace_tile(void *user, int worker, int tile)
{
    RawRays  *raw = user;
    const int b = tile * raw->block_of_tile;
    (void)worker;
    trace_eyes(raw, b);
    if (raw->block_of_tile == 2) trace_sun(raw, b + 1);
}

void raw_trace(void *user)
{
    RawRays *raw = user;
    pool_run(raw->pool, raw->blocks / raw->block_of_tile, trace_tile, raw);
    bench_keep(raw->range_m);
}

/* ---- the reference tracer ------------------------------------------------------------------------- */

/* Next crossing where a + t b is a whole number, after t. */
static double next_line(double a, double b, double t)
{
    if (b == 0) return INFINITY;
    const double line = b > 0 ? floor(a + t * b + 1e-9) + 1 : ceil(a + t * b - 1e-9) - 1;
    return (line - a) / b;
}

/* The ground is flat between lines of posts and the diagonals of cells: height over it is linear between two
 * crossings. */
static double walk(const Elevation *e, const double o[3], const double d[3])
{
    const ElevationLevel *level = &e->level[0];
    const double          u0 = (o[0] - level->x0_m) / level->spacing_m, du = d[0] / level->spacing_m;
    const double          v0 = (o[1] - level->y0_m) / level->spacing_m, dv = d[1] / level->spacing_m;
    const double top_m = level->z0_m + level->step_m * elevation_highest(level, level->pyramid_count - 1, 0, 0);
    double       t = o[2] > top_m && d[2] < 0 ? (top_m - o[2]) / d[2] : 0;
    double       above = INFINITY;
    for (;;) {
        const double z_m = o[2] + t * d[2], ground_m = elevation_height(e, o[0] + t * d[0], o[1] + t * d[1], NULL);
        const double now = z_m - ground_m;
        if (isnan(now) || (d[2] >= 0 && z_m > top_m)) return INFINITY;
        const double u = next_line(u0, du, t), v = next_line(v0, dv, t), w = next_line(u0 - v0, du - dv, t);
        const double next = fmin(u, fmin(v, w));
        if (now <= 0) return t;
        above = next < INFINITY ? o[2] + next * d[2] - elevation_height(e, o[0] + next * d[0], o[1] + next * d[1], NULL)
                                : -1;
        if (isnan(above)) return INFINITY;
        if (above <= 0 && next < INFINITY) return t + (next - t) * now / (now - above);
        if (!(next < INFINITY)) return now / -d[2];
        t = next;
    }
}

double raw_worst_m(const RawRays *raw, int every)
{
    double worst = 0;
    for (int i = 0; i < raw->count; i += every) {
        const double o[3] = {raw->o[0][i], raw->o[1][i], raw->o[2][i]},
                     d[3] = {raw->d[0][i], raw->d[1][i], raw->d[2][i]};
        if (raw->dark[i]) continue;
        const double plain = walk(raw->elevation, o, d);
        if (isinf(plain) != isinf(raw->range_m[i])) return INFINITY;
        if (!isinf(plain) && !(fabs(plain - raw->range_m[i]) <= worst)) worst = fabs(plain - raw->range_m[i]); /* NaN */
    }
    return worst;
}
