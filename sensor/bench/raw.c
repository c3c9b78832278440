#include "sensor/bench/raw.h"

#include "render/ground.h"
#include "render/parts.h"

#include <stdlib.h>

enum { side_px = 32 }; /* of a frame's tiles at one sample a pixel */

/* Of each tile a block of eye rays and, behind it, one of sun rays; block k has the rays first[k] .. first[k + 1] - 1. */
struct RawRays {
    const Elevation *elevation;
    Pool            *pool;
    Ground           ground;
    int              blocks, count;
    int             *first;      /* [blocks + 1] */
    double          *o[3], *d[3], *far_m, *range_m; /* [count] */
    PosedEntity     *entity;     /* in the frame's arena */
    int              entities;
    int             *pair_ray, *pair_entity; /* rays that come near a vehicle, by block */
    int             *first_pair; /* [blocks + 1] */
    int              pairs;
};

static Status pose_all(RawRays *raw, const BenchFrame *f)
{
    const World *world = &f->scene->world;
    raw->entities      = f->snapshot.count;
    raw->entity        = arena_alloc(f->arena, (size_t)raw->entities + 1, sizeof *raw->entity);
    if (!raw->entity) return STATUS_NO_MEMORY;
    for (int k = 0; k < raw->entities; k++) {
        const SnapshotEntity *e = &f->snapshot.entity[k];
        double                p_enu[3], r_enu_from_body[9];
        raw->entity[k].node = arena_alloc(f->arena, (size_t)parts_node_count(world->tracer, e->model) + 1,
                                          sizeof *raw->entity[k].node);
        if (!raw->entity[k].node) return STATUS_NO_MEMORY;
        enu_from_ecef(p_enu, &world->frame, e->p_ecef);
        m3_tmul(r_enu_from_body, world->frame.r_ecef_from_enu, e->r_ecef_from_body);
        parts_pose(&raw->entity[k], world->tracer, e->model, &f->snapshot.node[e->first_node], p_enu, r_enu_from_body,
                   snapshot_damage(e));
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

static void add_tile(RawRays *raw, Rays *rays, Hits *hits, const BenchFrame *f, const Visibility *v, int x0, int y0,
                     int *list)
{
    static const double offset_m = 1e-3;
    const View *view = &f->request.view;
    const int   x1 = x0 + side_px < view->width ? x0 + side_px : view->width;
    const int   y1 = y0 + side_px < view->height ? y0 + side_px : view->height;
    VisibilityCounters counters = {0};
    rays->count = 0;
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
    if (!(f->request.bands & (1u << BAND_OPTICAL | 1u << BAND_MWIR))) return;
    const int listed = visibility_block_entities(list, v, view, x0, y0, x1, y1, -1);
    visibility_first_hit(hits, v, rays, list, listed, -1, &counters);
    for (int i = 0; i < hits->count; i++) {
        const double n[3] = {hits->n_geo[0][i], hits->n_geo[1][i], hits->n_geo[2][i]};
        double       start[3];
        if (!(hits->range_m[i] < INFINITY) || !(v3_dot(n, f->air.sun_d_enu) > 0)) continue;
        for (int k = 0; k < 3; k++) start[k] = hits->p_enu[k][i] + offset_m * n[k];
        add_ray(raw, start, f->air.sun_d_enu);
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
    ok = (raw->first_pair = calloc((size_t)blocks + 1, sizeof *raw->first_pair)) && ok;
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

static bool comes_near(const RawRays *raw, int i, const PosedEntity *e)
{
    double from[3], across[3];
    const double o[3] = {raw->o[0][i], raw->o[1][i], raw->o[2][i]}, d[3] = {raw->d[0][i], raw->d[1][i], raw->d[2][i]};
    v3_sub(from, e->centre_enu, o);
    const double along = v3_dot(from, d);
    v3_add_scaled(across, from, -along, d);
    return e->model >= 0 && along > -e->radius_m && v3_dot(across, across) < e->radius_m * e->radius_m;
}

static Status pair_up(RawRays *raw)
{
    for (int pass = 0; pass < 2; pass++) {
        raw->pairs = 0;
        for (int b = 0; b < raw->blocks; b++) {
            for (int i = raw->first[b]; i < raw->first[b + 1]; i++)
                for (int k = 0; k < raw->entities; k++) {
                    if (!comes_near(raw, i, &raw->entity[k])) continue;
                    if (pass) {
                        raw->pair_ray[raw->pairs]    = i;
                        raw->pair_entity[raw->pairs] = k;
                    }
                    raw->pairs++;
                }
            raw->first_pair[b + 1] = raw->pairs;
        }
        if (pass) break;
        raw->pair_ray    = malloc(((size_t)raw->pairs + 1) * sizeof *raw->pair_ray);
        raw->pair_entity = malloc(((size_t)raw->pairs + 1) * sizeof *raw->pair_entity);
        if (!raw->pair_ray || !raw->pair_entity) return STATUS_NO_MEMORY;
    }
    return STATUS_OK;
}

Status raw_rays_create(RawRays **out, const BenchFrame *f)
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
        status = visibility_create(&v, f->scene->world.tracer, f->scene->landscape, &f->scene->world.frame, &f->snapshot,
                                   false, f->arena);
    if (status == STATUS_OK) status = pose_all(raw, f);
    if (status != STATUS_OK) goto done;

    raw->elevation = &f->scene->landscape->elevation;
    raw->pool      = f->pool;
    ground_prepare(&raw->ground, raw->elevation);
    for (int y = 0; y < view->height; y += side_px)
        for (int x = 0; x < view->width; x += side_px) add_tile(raw, rays, hits, f, v, x, y, list);
    status = pair_up(raw);

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
    free(raw->first_pair);
    free(raw->pair_ray);
    free(raw->pair_entity);
    free(raw);
}

int  raw_rays_count(const RawRays *raw) { return raw->count; }
void raw_use_pool(RawRays *raw, Pool *pool) { raw->pool = pool; }

static void trace_block(void *user, int worker, int b)
{
    RawRays            *raw = user;
    const int           first = raw->first[b], count = raw->first[b + 1] - first;
    const double *const o[3] = {raw->o[0] + first, raw->o[1] + first, raw->o[2] + first};
    const double *const d[3] = {raw->d[0] + first, raw->d[1] + first, raw->d[2] + first};
    (void)worker;
    ground_first_hits(raw->range_m + first, NULL, &raw->ground, count, o, d, raw->far_m + first);
    for (int p = raw->first_pair[b]; p < raw->first_pair[b + 1]; p++) {
        const int    i = raw->pair_ray[p];
        const double o_enu[3] = {raw->o[0][i], raw->o[1][i], raw->o[2][i]};
        const double d_enu[3] = {raw->d[0][i], raw->d[1][i], raw->d[2][i]};
        PartHit      hit;
        const double range_m = parts_first_hit(&hit, &raw->entity[raw->pair_entity[p]], o_enu, d_enu, raw->range_m[i], false);
        bench_keep(&range_m);
    }
}

void raw_trace(void *user)
{
    RawRays *raw = user;
    pool_run(raw->pool, raw->blocks, trace_block, raw);
    bench_keep(raw->range_m);
}

/* ---- the plain tracer ------------------------------------------------------------------------- */

/* Next place where a + t b is a whole number, after t. */
static double next_line(double a, double b, double t)
{
    if (b == 0) return INFINITY;
    const double line = b > 0 ? floor(a + t * b + 1e-9) + 1 : ceil(a + t * b - 1e-9) - 1;
    return (line - a) / b;
}

/* The ground is flat between lines of posts and the diagonals of cells: height over it is linear between two crossings. */
static double walk(const Elevation *e, const double o[3], const double d[3])
{
    const ElevationLevel *level = &e->level[0];
    const double u0 = (o[0] - level->x0_m) / level->spacing_m, du = d[0] / level->spacing_m;
    const double v0 = (o[1] - level->y0_m) / level->spacing_m, dv = d[1] / level->spacing_m;
    const double top_m = level->z0_m + level->step_m * level->pyramid[level->pyramid_count - 1][0];
    double       t = o[2] > top_m && d[2] < 0 ? (top_m - o[2]) / d[2] : 0;
    double       above = INFINITY;
    for (;;) {
        const double z_m = o[2] + t * d[2], ground_m = elevation_height(e, o[0] + t * d[0], o[1] + t * d[1], NULL);
        const double now = z_m - ground_m;
        if (isnan(now) || (d[2] >= 0 && z_m > top_m)) return INFINITY;
        const double u = next_line(u0, du, t), v = next_line(v0, dv, t), w = next_line(u0 - v0, du - dv, t);
        const double next = fmin(u, fmin(v, w));
        if (now <= 0) return t;
        above = next < INFINITY ? o[2] + next * d[2] - elevation_height(e, o[0] + next * d[0], o[1] + next * d[1], NULL) : -1;
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
        const double o[3] = {raw->o[0][i], raw->o[1][i], raw->o[2][i]}, d[3] = {raw->d[0][i], raw->d[1][i], raw->d[2][i]};
        const double plain = walk(raw->elevation, o, d);
        if (isinf(plain) != isinf(raw->range_m[i])) return INFINITY;
        if (!isinf(plain) && !(fabs(plain - raw->range_m[i]) <= worst)) worst = fabs(plain - raw->range_m[i]); /* NaN shows */
    }
    return worst;
}
