/* render/scattering/field/total_field.c: sums a list of hits over many frequencies; and ray tubes, edges and flat
 * faces of one look together. */
#include "render/scattering/field/total_field.h"
#include "pitviper_simd.h"

#include <stdlib.h>

/* ---- a list of hits ----------------------------------------------------------------------------- */

enum { chunk_hits = 8192, lanes = 4, together = 2, few = 4, restart = 256 };

typedef struct Sweep {
    int             count;
    double          first_k, step_k;
    const TubeHits *hits;
    bool            moved;
    ScatterAntenna  tx, rx;
    double         *sum;    /* [chunks][8][padded] */
    int             padded; /* count, up to a multiple of lanes */
} Sweep;

/* Change of a hit's path when the antennas move: that of its first point to the transmitter and of its last to the
 * receiver; what lies between changes by the second order (Fermat). */
static double moved_by(const Sweep *sweep, size_t i)
{
    const TubeHits *h = sweep->hits;
    const double    first[3] = {(double)h->first[0][i], (double)h->first[1][i], (double)h->first[2][i]};
    const double    last[3] = {(double)h->last[0][i], (double)h->last[1][i], (double)h->last[2][i]};
    double          way[3];
    return scatter_path(way, &sweep->tx, first) - scatter_path(way, &h->tx, first) +
           (scatter_path(way, &sweep->rx, last) - scatter_path(way, &h->rx, last));
}

static double path_of(const Sweep *sweep, size_t i)
{
    return sweep->hits->path_m[i] + (sweep->moved ? moved_by(sweep, i) : 0);
}

/* Adds one hit, with each frequency computed by itself. */
static void add_plain(double *sum, const Sweep *sweep, size_t i)
{
    const TubeHits *h = sweep->hits;
    const double    path_m = path_of(sweep, i);
    for (int f = 0; f < sweep->count; f++) {
        const double k = sweep->first_k + f * sweep->step_k;
        const double share = scatter_sinc(k * (double)h->slope_m[0][i]) * scatter_sinc(k * (double)h->slope_m[1][i]);
        const double x = share * cos(k * path_m), y = -share * sin(k * path_m);
        for (int p = 0; p < 8; p += 2) {
            const double re = (double)h->amplitude[p][i], im = (double)h->amplitude[p + 1][i];
            sum[p * sweep->padded + f] += re * x - im * y;
            sum[(p + 1) * sweep->padded + f] += re * y + im * x;
        }
    }
}

/* exp(j a) at four frequencies, and its turn from four to the next four. */
typedef struct Turning {
    F64x4 re, im, turn_re, turn_im;
} Turning;

static void turning_start(Turning *t, double length_m, double k, double step_k)
{
    double re[lanes], im[lanes], turn_re = cos(step_k * length_m), turn_im = sin(step_k * length_m);
    re[0] = cos(k * length_m), im[0] = sin(k * length_m);
    for (int l = 1; l < lanes; l++) {
        re[l] = re[l - 1] * turn_re - im[l - 1] * turn_im;
        im[l] = re[l - 1] * turn_im + im[l - 1] * turn_re;
    }
    for (int twice = 0; twice < 2; twice++) {
        const double square = turn_re * turn_re - turn_im * turn_im;
        turn_im = 2 * turn_re * turn_im;
        turn_re = square;
    }
    *t = (Turning){f64x4_loadu(re), f64x4_loadu(im), f64x4_set(turn_re), f64x4_set(turn_im)};
}

static inline void turning_step(Turning *t)
{
    const F64x4 re = t->re * t->turn_re - t->im * t->turn_im;
    t->im = t->re * t->turn_im + t->im * t->turn_re;
    t->re = re;
}

/* Some hits at once, four frequencies at a time: exp(-j k path) and both sines turn from step to step.
 * scatter_sinc(k s) = sin(k s) / (k s): the s are in the amplitude here, the k in finish. Slopes below 3e-5 of a
 * radian count as that, so that rounding does not grow. */
static void add_turning(double *sum, const Sweep *sweep, size_t i)
{
    const TubeHits *h = sweep->hits;
    const double    least_m = 3e-5 / (sweep->first_k + sweep->count * sweep->step_k);
    double          path_m[together], slope_m[2][together];
    F64x4           a[together][8];
    for (int n = 0; n < together; n++) {
        path_m[n] = -path_of(sweep, i + (size_t)n);
        for (int c = 0; c < 2; c++) slope_m[c][n] = fmax(fabs((double)h->slope_m[c][i + (size_t)n]), least_m);
        const double per = 1 / (slope_m[0][n] * slope_m[1][n]);
        for (int p = 0; p < 8; p++) a[n][p] = f64x4_set((double)h->amplitude[p][i + (size_t)n] * per);
    }
    for (int start = 0; start < sweep->padded; start += restart) {
        const double k = sweep->first_k + start * sweep->step_k;
        const int    end = start + restart < sweep->padded ? start + restart : sweep->padded;
        Turning      way[together], side[2][together];
        for (int n = 0; n < together; n++) {
            turning_start(&way[n], path_m[n], k, sweep->step_k);
            for (int c = 0; c < 2; c++) turning_start(&side[c][n], slope_m[c][n], k, sweep->step_k);
        }
        for (int f = start; f < end; f += lanes) {
            F64x4 whole[8];
            for (int p = 0; p < 8; p++) whole[p] = f64x4_load(sum + p * sweep->padded + f);
            for (int n = 0; n < together; n++) {
                const F64x4 share = side[0][n].im * side[1][n].im, x = share * way[n].re, y = share * way[n].im;
                for (int p = 0; p < 8; p += 2) {
                    whole[p] += a[n][p] * x - a[n][p + 1] * y;
                    whole[p + 1] += a[n][p] * y + a[n][p + 1] * x;
                }
                turning_step(&way[n]);
                turning_step(&side[0][n]);
                turning_step(&side[1][n]);
            }
            for (int p = 0; p < 8; p++) f64x4_store(sum + p * sweep->padded + f, whole[p]);
        }
    }
}

static bool is_turning(const Sweep *sweep) { return sweep->count >= few; }

static void sum_chunk(void *user, int worker, int task)
{
    const Sweep *sweep = user;
    const size_t first = (size_t)task * chunk_hits;
    const size_t end = first + chunk_hits < sweep->hits->count ? first + chunk_hits : sweep->hits->count;
    double      *sum = sweep->sum + 8 * (size_t)sweep->padded * (size_t)task;
    (void)worker;
    if (is_turning(sweep))
        for (size_t i = first; i < end; i += together) add_turning(sum, sweep, i);
    else
        for (size_t i = first; i < end; i++) add_plain(sum, sweep, i);
}

/* Sums the chunks' fields at one frequency, in the order of the chunks. */
static void finish(ScatterMatrix *s, const Sweep *sweep, int chunks, int f)
{
    double       whole[8] = {0};
    const double k = sweep->first_k + f * sweep->step_k, per = is_turning(sweep) ? k * k : 1;
    const double scale = -k / (2 * pi_rad) / per; /* times j */
    for (int t = 0; t < chunks; t++)
        for (int c = 0; c < 8; c++) whole[c] += sweep->sum[(size_t)(8 * t + c) * (size_t)sweep->padded + (size_t)f];
    double complex *const to[4] = {&s->hh, &s->hv, &s->vh, &s->vv};
    for (int p = 0; p < 4; p++) *to[p] = CMPLX(-scale * whole[2 * p + 1], scale * whole[2 * p]);
}

Status field_sweep(ScatterMatrix *s, const FrequencySweep *sweep, const TubeHits *hits, Pool *pool)
{
    const double k_per_hz = 2 * pi_rad / light_mps;
    const int    chunks = (int)((hits->count + chunk_hits - 1) / chunk_hits);
    Sweep        sum = {.count = sweep->count,
                        .first_k = sweep->first_hz * k_per_hz,
                        .step_k = sweep->step_hz * k_per_hz,
                        .hits = hits,
                        .moved = sweep->tx || sweep->rx,
                        .tx = sweep->tx ? *sweep->tx : hits->tx,
                        .rx = sweep->rx ? *sweep->rx : hits->rx,
                        .padded = (sweep->count + lanes - 1) / lanes * lanes};
    const size_t sums = 8 * (size_t)sum.padded * (size_t)(chunks + 1);
    sum.sum = aligned_alloc(64, sums * sizeof *sum.sum);
    if (!sum.sum) return STATUS_NO_MEMORY;
    memset(sum.sum, 0, sums * sizeof *sum.sum);
    if (pool) pool_run(pool, chunks, sum_chunk, &sum);
    else
        for (int t = 0; t < chunks; t++) sum_chunk(&sum, 0, t);
    for (int f = 0; f < sweep->count; f++) finish(&s[f], &sum, chunks, f);
    free(sum.sum);
    return STATUS_OK;
}

Status field_at(ScatterMatrix *s, double frequency_hz, const TubeHits *hits, Pool *pool)
{
    return field_sweep(s, &(FrequencySweep){.count = 1, .first_hz = frequency_hz}, hits, pool);
}

double rcs_dbsm(double complex s)
{
    const double sigma_m2 = 4 * pi_rad * (creal(s) * creal(s) + cimag(s) * cimag(s));
    return 10 * log10(sigma_m2);
}

/* ---- tubes, edges and flat faces together ------------------------------------------------------- */

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

/* Tests whether a face is clear between two edges, by rays just above it: from edge to edge, and down to it at three
 * places on the way. */
static bool is_clear(void *user, const double p[3], const double q[3], const double n[3])
{
    static const double above_m = 1e-3, inside_m = 2e-3;
    const Sight        *sight = user;
    double              way[3], from[3], down[3];
    PartHit             hit;
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
    const RadarTarget    *target;
    const EdgePairConfig *config;
    const Sight          *sight;
    int                   wedge_chunks; /* chunks of wedges; chunks of pairs follow */
    EdgeSegments         *chunk;
    Status               *status;
} EdgeWork;

static void find_chunk(void *user, int worker, int task)
{
    const EdgeWork    *work = user;
    const RadarTarget *target = work->target;
    (void)worker;
    if (task < work->wedge_chunks) {
        const int first = task * chunk_wedges, left = target->wedge_count - first;
        work->status[task] =
            edge_segments(&work->chunk[task], target->wedge + first, left < chunk_wedges ? left : chunk_wedges,
                          work->sight->antenna[0], work->sight->antenna[1], &work->config->edge);
    } else {
        const int first = (task - work->wedge_chunks) * chunk_pairs, left = target->pair_count - first;
        work->status[task] =
            edge_pair_segments(&work->chunk[task], target->pair + first, left < chunk_pairs ? left : chunk_pairs,
                               target->wedge, work->sight->antenna[0], work->sight->antenna[1], work->config);
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

/* Finds the segments of chunks of wedges, then of pairs of wedges, on all threads; they are kept in order. */
static Status find_edges(EdgeSegments *out, const RadarTarget *target, const EdgePairConfig *config, const Sight *sight,
                         Pool *pool)
{
    const int wedge_chunks = (target->wedge_count + chunk_wedges - 1) / chunk_wedges;
    const int chunks = wedge_chunks + (target->pair_count + chunk_pairs - 1) / chunk_pairs;
    EdgeWork  work = {target,
                      config,
                      sight,
                      wedge_chunks,
                      calloc((size_t)chunks + 1, sizeof *work.chunk),
                      calloc((size_t)chunks + 1, sizeof *work.status)};
    Status    status = work.chunk && work.status ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK && pool) pool_run(pool, chunks, find_chunk, &work);
    else
        for (int t = 0; t < chunks && status == STATUS_OK; t++) find_chunk(&work, 0, t);
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
    const TubeRest rest = {.whole = flat->count > 0 ? flat->whole : NULL, .none = flat->count > 0 && flat->all};
    if (status == STATUS_OK) status = tubes_trace_rest(&out->hits, target, tx, rx, config, &rest, pool);
    if (status != STATUS_OK || !edges || target->wedge_count == 0) return status;
    Sight                sight = {&target->entity, {tx, rx}};
    const double         k_per_m = 2 * pi_rad * config->frequency_hz / light_mps;
    const EdgePairConfig edge = {.edge = {.k_per_m = 1.5 * k_per_m,
                                          .sample_m = fmin(0.05, target->entity.radius_m / 64),
                                          .clear_m = 1e-4,
                                          .visible = sees,
                                          .user = &sight},
                                 .k_per_m = k_per_m,
                                 .clear = is_clear,
                                 .least_m = 5e-5 * target->entity.radius_m};
    return find_edges(&out->edges, target, &edge, &sight, pool);
}

/* Path of a segment for antennas that have moved a little; its amplitude hardly changes. */
static double moved_path_m(const EdgeSegment *s, const TotalField *field, const ScatterAntenna *tx,
                           const ScatterAntenna *rx)
{
    double way[3];
    return s->path_m + (scatter_path(way, tx, s->p) - scatter_path(way, &field->hits.tx, s->p)) +
           (scatter_path(way, rx, s->p) - scatter_path(way, &field->hits.rx, s->p));
}

/* exp(j a), carried from one frequency to the next by a product, and computed anew every 64. */
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

Status total_field_sweep(ScatterMatrix *s, const FrequencySweep *sweep, const TotalField *field, Pool *pool)
{
    const ScatterAntenna *tx = sweep->tx, *rx = sweep->rx;
    const double          k_per_hz = 2 * pi_rad / light_mps;
    Status                status = field_sweep(s, sweep, &field->hits, pool);
    if (status == STATUS_OK) status = polygons_sweep(s, sweep, &field->polygons, pool);
    for (int i = 0; i < field->edges.count && status == STATUS_OK; i++) {
        const EdgeSegment *e = &field->edges.segment[i];
        const double       path_m =
            tx || rx ? moved_path_m(e, field, tx ? tx : &field->hits.tx, rx ? rx : &field->hits.rx) : e->path_m;
        add_segment(s, sweep->count, sweep->first_hz * k_per_hz, sweep->step_hz * k_per_hz, e, path_m);
    }
    return status;
}

void total_field_free(TotalField *field)
{
    tubes_free(&field->hits);
    edge_segments_destroy(&field->edges);
    polygons_free(&field->polygons);
}
