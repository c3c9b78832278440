/* render/radar/total_field.c: ray tubes, edges and flat faces of one look together. */
#include "render/radar/total_field.h"

#include <stdlib.h>

enum { chunk_wedges = 512, chunk_pairs = 256 };

typedef struct Sight {
    const PosedEntity    *entity;
    const ScatterAntenna *antenna[2];
} Sight;

static bool sees(void *user, const double p[3], int antenna)
{
    const Sight *sight = user;
    double       way[3];
    scatter_path(way, sight->antenna[antenna], p);
    return !parts_occluded(sight->entity, p, way, false);
}

/* Rays just above a face: from edge to edge, and down to it at three places on the way. */
static bool is_clear(void *user, const double p[3], const double q[3], const double n[3])
{
    static const double above_m = 1e-3, inside_m = 2e-3;
    const Sight *sight = user;
    double       way[3], from[3], down[3];
    PartHit      hit;
    v3_sub(way, q, p);
    const double width_m = v3_length(way);
    if (!(width_m > 2 * inside_m)) return false;
    v3_scale(way, 1 / width_m, way);
    v3_scale(down, -1, n);
    for (int i = 0; i < 3; i++) from[i] = p[i] + above_m * n[i] + inside_m * way[i];
    if (!isinf(parts_first_hit(&hit, sight->entity, from, way, width_m - 2 * inside_m, false))) return false;
    for (int k = 1; k < 4; k++) {
        for (int i = 0; i < 3; i++) from[i] = p[i] + above_m * n[i] + 0.25 * k * width_m * way[i];
        if (isinf(parts_first_hit(&hit, sight->entity, from, down, 2 * above_m, false))) return false;
    }
    return true;
}

typedef struct EdgeWork {
    const RadarTarget *target;
    const EdgePairConfig *config;
    const Sight       *sight;
    int                wedge_chunks;  /* then those of pairs */
    EdgeSegments      *chunk;
    Status            *status;
} EdgeWork;

static void find_chunk(void *user, int worker, int task)
{
    const EdgeWork    *work = user;
    const RadarTarget *target = work->target;
    (void)worker;
    if (task < work->wedge_chunks) {
        const int first = task * chunk_wedges, left = target->wedge_count - first;
        work->status[task] = edge_segments(&work->chunk[task], target->wedge + first,
                                           left < chunk_wedges ? left : chunk_wedges, work->sight->antenna[0],
                                           work->sight->antenna[1], &work->config->edge);
    } else {
        const int first = (task - work->wedge_chunks) * chunk_pairs, left = target->pair_count - first;
        work->status[task] = edge_pair_segments(&work->chunk[task], target->pair + first,
                                                left < chunk_pairs ? left : chunk_pairs, target->wedge,
                                                work->sight->antenna[0], work->sight->antenna[1], work->config);
    }
}

static Status append(EdgeSegments *out, const EdgeSegments *more, int first_wedge)
{
    if (out->count + more->count > out->capacity) {
        const int    capacity = 2 * (out->count + more->count);
        EdgeSegment *larger = realloc(out->segment, (size_t)capacity * sizeof *larger);
        if (!larger) return STATUS_NO_MEMORY;
        out->segment = larger;
        out->capacity = capacity;
    }
    for (int i = 0; i < more->count; i++) {
        out->segment[out->count] = more->segment[i];
        out->segment[out->count++].wedge += first_wedge;
    }
    return STATUS_OK;
}

/* Chunks of wedges, then of pairs of them, over the threads; their segments in order. */
static Status find_edges(EdgeSegments *out, const RadarTarget *target, const EdgePairConfig *config, const Sight *sight,
                         Pool *pool)
{
    const int wedge_chunks = (target->wedge_count + chunk_wedges - 1) / chunk_wedges;
    const int chunks = wedge_chunks + (target->pair_count + chunk_pairs - 1) / chunk_pairs;
    EdgeWork  work = {target, config, sight, wedge_chunks, calloc((size_t)chunks + 1, sizeof *work.chunk),
                      calloc((size_t)chunks + 1, sizeof *work.status)};
    Status    status = work.chunk && work.status ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK && pool) pool_run(pool, chunks, find_chunk, &work);
    else for (int t = 0; t < chunks && status == STATUS_OK; t++) find_chunk(&work, 0, t);
    for (int t = 0; t < chunks && status == STATUS_OK; t++) {
        status = work.status[t];
        if (status == STATUS_OK) status = append(out, &work.chunk[t], t < wedge_chunks ? t * chunk_wedges : 0);
    }
    for (int t = 0; t < chunks && work.chunk; t++) edge_segments_destroy(&work.chunk[t]);
    free(work.chunk);
    free(work.status);
    return status;
}

Status total_field_trace(TotalField *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                         const TubeConfig *config, bool edges, Pool *pool)
{
    out->edges.count = 0;
    Polygons *flat = &out->polygons;
    flat->count = 0;
    Status status = STATUS_OK;
    if (config->polygon_faces > 0) status = polygons_find(flat, target, tx, rx, config, pool);
    if (status == STATUS_OK)
        status = tubes_trace_rest(&out->hits, target, tx, rx, config, flat->count > 0 ? flat->whole : NULL,
                                  flat->count > 0 && flat->all, pool);
    if (status != STATUS_OK || !edges || target->wedge_count == 0) return status;
    Sight            sight = {&target->entity, {tx, rx}};
    const double         k_per_m = 2 * pi_rad * config->frequency_hz / light_mps;
    const EdgePairConfig edge = {.edge = {.k_per_m = 1.5 * k_per_m,
                                          .sample_m = fmin(0.05, target->entity.radius_m / 64), .clear_m = 1e-4,
                                          .visible = sees, .user = &sight},
                                 .k_per_m = k_per_m, .clear = is_clear,
                                 .least_m = 5e-5 * target->entity.radius_m};
    return find_edges(&out->edges, target, &edge, &sight, pool);
}

/* A segment as moved antennas see it: its path changes, its amplitude hardly. */
static double moved_path_m(const EdgeSegment *s, const TotalField *field, const ScatterAntenna *tx,
                           const ScatterAntenna *rx)
{
    double way[3];
    return s->path_m + (scatter_path(way, tx, s->p) - scatter_path(way, &field->hits.tx, s->p)) +
           (scatter_path(way, rx, s->p) - scatter_path(way, &field->hits.rx, s->p));
}

/* exp(j a) from frequency to frequency, restarted each 64. */
typedef struct Wave {
    double length_m, re, im, turn_re, turn_im;
} Wave;

static Wave wave_of(double length_m, double step_k)
{
    return (Wave){.length_m = length_m, .turn_re = cos(step_k * length_m), .turn_im = sin(step_k * length_m)};
}

static inline void wave_next(Wave *w, int f, double k)
{
    if (f % 64 == 0) {
        w->re = cos(k * w->length_m), w->im = sin(k * w->length_m);
        return;
    }
    const double re = w->re * w->turn_re - w->im * w->turn_im;
    w->im = w->re * w->turn_im + w->im * w->turn_re;
    w->re = re;
}

/* sinc(k slope length / 2) by its sine; slopes below 1e-4 of a radian count as that. */
static void add_segment(ScatterMatrix *s, int count, double first_k, double step_k, const EdgeSegment *e, double path_m)
{
    const double half_m = fmax(fabs(e->slope * e->length_m / 2), 1e-4 / (first_k + count * step_k));
    Wave         way = wave_of(-path_m, step_k), side = wave_of(half_m, step_k);
    for (int f = 0; f < count; f++) {
        const double k = first_k + f * step_k;
        wave_next(&way, f, k);
        wave_next(&side, f, k);
        const double         share = edge_fade(e, k) * side.im / (k * half_m);
        const double complex wave = CMPLX(share * way.re, share * way.im);
        s[f].hh += e->amplitude[0][0] * wave;
        s[f].hv += e->amplitude[0][1] * wave;
        s[f].vh += e->amplitude[1][0] * wave;
        s[f].vv += e->amplitude[1][1] * wave;
    }
}

Status total_field_sweep(ScatterMatrix *s, int count, double first_hz, double step_hz, const TotalField *field,
                         const ScatterAntenna *tx, const ScatterAntenna *rx, Pool *pool)
{
    const double k_per_hz = 2 * pi_rad / light_mps;
    Status status = field_sweep(s, count, first_hz, step_hz, &field->hits, tx, rx, pool);
    if (status == STATUS_OK) status = polygons_sweep(s, count, first_hz, step_hz, &field->polygons, tx, rx, pool);
    for (int i = 0; i < field->edges.count && status == STATUS_OK; i++) {
        const EdgeSegment *e = &field->edges.segment[i];
        const double path_m = tx || rx ? moved_path_m(e, field, tx ? tx : &field->hits.tx, rx ? rx : &field->hits.rx)
                                       : e->path_m;
        add_segment(s, count, first_hz * k_per_hz, step_hz * k_per_hz, e, path_m);
    }
    return status;
}

void total_field_free(TotalField *field)
{
    tubes_free(&field->hits);
    edge_segments_destroy(&field->edges);
    polygons_free(&field->polygons);
}
