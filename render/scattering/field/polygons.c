/* render/scattering/field/polygons.c: flat faces in closed form: their triangles, and their field. */
#include "render/scattering/field/currents_private.h"
#include "render/scattering/field/total_field.h"

#include <stdlib.h>

enum {
    chunk_polygons = 2048,
    halvings = 18 /* of a triangle; one that needs more is left to tubes */
};
static const double linear_rad = 4e-3; /* a side's phase out of a straight line */
static const double turn_rad = 0.05;   /* a side, seen from an antenna */

/* ---- closed form --------------------------------------------------------------------------------------- */

static double complex turn(double rad) { return CMPLX(cos(rad), -sin(rad)); }

double complex polygon_mean(const double x[3])
{
    int b = 0; /* between the two farthest apart */
    for (int i = 1; i < 3; i++)
        if (fabs(x[(i + 1) % 3] - x[(i + 2) % 3]) > fabs(x[(b + 1) % 3] - x[(b + 2) % 3])) b = i;
    const double a = x[(b + 1) % 3], c = x[(b + 2) % 3], m = x[b];
    if (fabs(a - c) > 0.25) {
        const double complex ab = turn(0.5 * (a + m)) * scatter_sinc(0.5 * (a - m));
        const double complex bc = turn(0.5 * (m + c)) * scatter_sinc(0.5 * (m - c));
        return 2 * I * (ab - bc) / (a - c);
    }
    /* near the specular direction, where the other form cancels: 2 sum of (-j)^n h_n / (n + 2)!, with h_n the sum of
     * all products of n factors, about the middle */
    const double middle = (x[0] + x[1] + x[2]) / 3, p = x[0] - middle, q = x[1] - middle, r = x[2] - middle;
    const double e2 = p * q + q * r + r * p, e3 = p * q * r;
    double       h[9] = {1, 0, -e2}, re = 1, im = 0, per = 0.5; /* 1 / (n + 1)! */
    for (int n = 2; n < 9; n++) {
        if (n > 2) h[n] = -e2 * h[n - 2] + e3 * h[n - 3];
        per /= n + 1;
        const double term = 2 * per / (n + 2) * h[n];
        if (n % 2) im += n % 4 == 3 ? term : -term;
        else re += n % 4 == 2 ? -term : term;
    }
    return turn(middle) * CMPLX(re, im);
}

/* ---- the list ------------------------------------------------------------------------------------------ */

/* A list while its faces are divided. */
typedef struct PolygonBuilder {
    const RadarTarget *target;
    Polygons          *out;
    RadarSurface       surface; /* of the face's part */
    double             k, frequency_hz;
    uint32_t           triangle;
    bool               fits; /* false: a triangle would be halved too often */
} PolygonBuilder;

static double path_at(const Polygons *out, const double p[3])
{
    double way[3];
    return scatter_path(way, &out->tx, p) + scatter_path(way, &out->rx, p);
}

/* Whether a side's phase is a straight line, and directions along it hardly change. */
static bool is_linear(const PolygonBuilder *builder, const double p[3], const double q[3], double p_m, double q_m)
{
    const ScatterAntenna *antenna[2] = {&builder->out->tx, &builder->out->rx};
    double                middle[3], side[3], way[3];
    if (isinf(antenna[0]->range_m) && isinf(antenna[1]->range_m)) return true;
    for (int c = 0; c < 3; c++) middle[c] = 0.5 * (p[c] + q[c]);
    v3_sub(side, q, p);
    for (int a = 0; a < 2; a++)
        if (!isinf(antenna[a]->range_m) &&
            !(v3_length(side) <= turn_rad * (antenna[a]->range_m + scatter_path(way, antenna[a], middle))))
            return false;
    return builder->k * fabs(path_at(builder->out, middle) - 0.5 * (p_m + q_m)) <= linear_rad;
}

/* What a triangle radiates, from its middle: as a tube of its area does. */
static void amplitude_of(Polygon *polygon, const PolygonBuilder *builder)
{
    const Polygons *out = builder->out;
    double          middle[3], to_tx[3], s[3], d[3], n[3], e[2][3];
    Field           field[2];
    double complex  te = -1, tm = 1;
    for (int c = 0; c < 3; c++) middle[c] = (polygon->corner[0][c] + polygon->corner[1][c] + polygon->corner[2][c]) / 3;
    double       area_m2 = 0.5 * radar_corners_normal(n, polygon->corner); /* facet_radiates is twice the field */
    const double tx_m = scatter_path(to_tx, &out->tx, middle), rx_m = scatter_path(s, &out->rx, middle);
    if (!isinf(out->tx.range_m)) area_m2 *= out->tx.range_m / (out->tx.range_m + tx_m);
    if (!isinf(out->rx.range_m)) area_m2 *= out->rx.range_m / (out->rx.range_m + rx_m);
    if (v3_dot(n, to_tx) < 0) v3_scale(n, -1, n);
    v3_scale(d, -1, to_tx);
    polarise(e, &out->tx, d);
    for (int p = 0; p < 2; p++) {
        memcpy(field[p].re, e[p], sizeof e[p]);
        memset(field[p].im, 0, sizeof field[p].im);
    }
    if (builder->surface.kind != RADAR_METAL || builder->surface.rough_m > 0)
        fresnel_surface(&te, &tm, &builder->surface, builder->k, fmin(1, -v3_dot(n, d)));
    facet_radiates(polygon->amplitude, field, &builder->surface, te, tm, n, d, s, &out->rx);
    /* where waves are bent the mean path is a little beside the corners' plane: by Simpson's rule, which is exact for
     * a second-order path */
    double beside_m = 0;
    for (int k = 0; k < 3; k++) {
        double between[3];
        for (int c = 0; c < 3; c++) between[c] = 0.5 * (polygon->corner[k][c] + polygon->corner[(k + 1) % 3][c]);
        beside_m += (path_at(out, between) - 0.5 * (polygon->path_m[k] + polygon->path_m[(k + 1) % 3])) / 3;
    }
    for (int k = 0; k < 3; k++) polygon->path_m[k] += beside_m;
    for (int i = 0; i < 8; i++) polygon->amplitude[i] *= area_m2;
}

/* The longest side that is not linear; -1: none. */
static int bent_side(const PolygonBuilder *builder, const double corner[3][3], const double path_m[3])
{
    double longest_m = 0;
    int    longest = -1;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        double    side[3];
        v3_sub(side, corner[b], corner[a]);
        if (v3_length(side) > longest_m && !is_linear(builder, corner[a], corner[b], path_m[a], path_m[b]))
            longest_m = v3_length(side), longest = a;
    }
    return longest;
}

static Status add_polygon(PolygonBuilder *builder, const double corner[3][3], const double path_m[3], int depth);

/* Both halves of a triangle, cut across a side; a neighbour's is cut at the same point. */
static Status add_halves(PolygonBuilder *builder, const double corner[3][3], const double path_m[3], int side,
                         int depth)
{
    const int a = side, b = (a + 1) % 3, tip = (a + 2) % 3;
    double    half[3][3], half_m[3];
    for (int c = 0; c < 3; c++) half[1][c] = 0.5 * (corner[a][c] + corner[b][c]);
    half_m[1] = path_at(builder->out, half[1]);
    memcpy(half[0], corner[a], sizeof half[0]);
    memcpy(half[2], corner[tip], sizeof half[2]);
    half_m[0] = path_m[a], half_m[2] = path_m[tip];
    const Status status = add_polygon(builder, half, half_m, depth + 1);
    if (status != STATUS_OK || !builder->fits) return status;
    memcpy(half[0], half[1], sizeof half[0]);
    memcpy(half[1], corner[b], sizeof half[1]);
    half_m[0] = half_m[1], half_m[1] = path_m[b];
    return add_polygon(builder, half, half_m, depth + 1);
}

static Status add_polygon(PolygonBuilder *builder, const double corner[3][3], const double path_m[3], int depth)
{
    const int side = bent_side(builder, corner, path_m);
    if (side >= 0 && depth < halvings) return add_halves(builder, corner, path_m, side, depth);
    builder->fits = side < 0;
    if (!builder->fits) return STATUS_OK;
    Polygons *out = builder->out;
    if (out->count == out->capacity) {
        const int want = out->capacity ? 2 * out->capacity : 256;
        Polygon  *larger = realloc(out->polygon, (size_t)want * sizeof *larger);
        if (!larger) return STATUS_NO_MEMORY;
        out->polygon = larger;
        out->capacity = want;
    }
    Polygon *polygon = &out->polygon[out->count++];
    memcpy(polygon->corner, corner, sizeof polygon->corner);
    memcpy(polygon->path_m, path_m, sizeof polygon->path_m);
    polygon->triangle = builder->triangle;
    amplitude_of(polygon, builder);
    return STATUS_OK;
}

/* Adds a face that is seen. Adds none of it where it does not fit. */
static Status add_face(PolygonBuilder *builder, int face)
{
    const RadarTarget *target = builder->target;
    const FlatFaces   *faces = &target->faces;
    const int          before = builder->out->count, first = faces->first[face], end = faces->first[face + 1];
    const int          part = target->model->triangle_part[faces->triangle[first]];
    Status             status = STATUS_OK;
    builder->surface = (RadarSurface){0};
    if (target->materials)
        radar_surface(&builder->surface, &target->materials->material[target->material[part]], builder->frequency_hz);
    builder->fits = true;
    for (int i = first; i < end && builder->fits && status == STATUS_OK; i++) {
        double corner[3][3], path_m[3];
        builder->triangle = faces->triangle[i];
        radar_target_corners(corner, target, builder->triangle);
        for (int k = 0; k < 3; k++) path_m[k] = path_at(builder->out, corner[k]);
        status = add_polygon(builder, corner, path_m, 0);
    }
    if (!builder->fits) builder->out->count = before;
    for (int i = first; i < end && builder->fits; i++) builder->out->whole[faces->triangle[i]] = 1;
    return status;
}

/* Whether tubes would find nothing more: of a convex body each face with the antennas in front is here. */
static bool is_all(const Polygons *out, const RadarTarget *target)
{
    const FlatFaces *faces = &target->faces;
    if (!faces->convex) return false;
    for (int f = 0; f < faces->count; f++) {
        const uint32_t t = faces->triangle[faces->first[f]];
        double         corner[3][3], n[3], to[2][3];
        if (out->whole[t]) continue;
        if (faces->count == 1) return false;
        radar_target_corners(corner, target, t);
        radar_corners_normal(n, corner);
        scatter_path(to[0], &out->tx, corner[0]);
        scatter_path(to[1], &out->rx, corner[0]);
        if (v3_dot(n, to[0]) > 0 && v3_dot(n, to[1]) > 0) return false;
    }
    return true;
}

static bool is_asked_for(const RadarTarget *target, const TubeConfig *config)
{
    return target->faces.count > 0 && target->faces.count <= config->polygon_faces && target->entity.node_count > 0 &&
           !(config->warp_m > 0) && !config->last_only && !config->keep_hidden && config->frequency_hz > 0 &&
           !isinf(config->frequency_hz);
}

static Status clear(Polygons *out, int triangles)
{
    if (triangles > out->whole_size) {
        uint8_t *larger = realloc(out->whole, (size_t)triangles);
        if (!larger) return STATUS_NO_MEMORY;
        out->whole = larger;
        out->whole_size = triangles;
    }
    if (triangles > 0) memset(out->whole, 0, (size_t)triangles);
    out->count = 0;
    out->rays = 0;
    out->all = false;
    return STATUS_OK;
}

Status polygons_find(Polygons *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                     const TubeConfig *config, Pool *pool)
{
    const ScatterAntenna antenna[2] = {*tx, *rx};
    const bool           one = memcmp(tx->u, rx->u, sizeof tx->u) == 0 && tx->range_m == rx->range_m;
    PolygonBuilder       builder = {.target = target,
                                    .out = out,
                                    .k = 2 * pi_rad * config->frequency_hz / light_mps,
                                    .frequency_hz = config->frequency_hz};
    Status               status = clear(out, target->model->triangle_count);
    out->tx = *tx, out->rx = *rx;
    if (status != STATUS_OK || !is_asked_for(target, config) || !scatter_antenna_is_good(tx) ||
        !scatter_antenna_is_good(rx))
        return status;
    uint8_t *seen = calloc((size_t)target->faces.count, sizeof *seen);
    if (!seen) return STATUS_NO_MEMORY;
    out->rays = radar_flat_faces_seen(seen, target, antenna, one ? 1 : 2, pool);
    if (out->rays < 0) status = STATUS_NO_MEMORY;
    for (int f = 0; f < target->faces.count && status == STATUS_OK; f++)
        if (seen[f]) status = add_face(&builder, f);
    out->all = status == STATUS_OK && is_all(out, target);
    free(seen);
    return status;
}

/* ---- their field --------------------------------------------------------------------------------------- */

typedef struct Sweep {
    const Polygons *polygons;
    ScatterAntenna  tx, rx;
    bool            moved;
    int             count;
    double          first_k, step_k;
    double complex *sum; /* [chunks][count][4] */
} Sweep;

static void sum_chunk(void *user, int worker, int task)
{
    const Sweep    *sweep = user;
    const int       first = task * chunk_polygons, left = sweep->polygons->count - first;
    const int       count = left < chunk_polygons ? left : chunk_polygons;
    double complex *sum = sweep->sum + 4 * (size_t)sweep->count * (size_t)task;
    (void)worker;
    for (int i = first; i < first + count; i++) {
        const Polygon *p = &sweep->polygons->polygon[i];
        double         path_m[3];
        for (int c = 0; c < 3; c++) {
            double way[3];
            path_m[c] = p->path_m[c];
            if (sweep->moved)
                path_m[c] += scatter_path(way, &sweep->tx, p->corner[c]) + scatter_path(way, &sweep->rx, p->corner[c]) -
                             path_at(sweep->polygons, p->corner[c]);
        }
        for (int f = 0; f < sweep->count; f++) {
            const double         k = sweep->first_k + f * sweep->step_k;
            const double         x[3] = {k * path_m[0], k * path_m[1], k * path_m[2]};
            const double complex mean = polygon_mean(x);
            for (int q = 0; q < 4; q++) sum[4 * f + q] += CMPLX(p->amplitude[2 * q], p->amplitude[2 * q + 1]) * mean;
        }
    }
}

Status polygons_sweep(ScatterMatrix *s, const FrequencySweep *sweep, const Polygons *polygons, Pool *pool)
{
    const double k_per_hz = 2 * pi_rad / light_mps;
    const int    chunks = (polygons->count + chunk_polygons - 1) / chunk_polygons;
    Sweep        sum = {.polygons = polygons,
                        .tx = sweep->tx ? *sweep->tx : polygons->tx,
                        .rx = sweep->rx ? *sweep->rx : polygons->rx,
                        .moved = sweep->tx || sweep->rx,
                        .count = sweep->count,
                        .first_k = sweep->first_hz * k_per_hz,
                        .step_k = sweep->step_hz * k_per_hz};
    if (chunks == 0) return STATUS_OK;
    sum.sum = calloc(4 * (size_t)sweep->count * (size_t)chunks, sizeof *sum.sum);
    if (!sum.sum) return STATUS_NO_MEMORY;
    if (pool) pool_run(pool, chunks, sum_chunk, &sum);
    else
        for (int t = 0; t < chunks; t++) sum_chunk(&sum, 0, t);
    for (int f = 0; f < sweep->count; f++) {
        const double complex scale = CMPLX(0, -(sum.first_k + f * sum.step_k) / (2 * pi_rad));
        for (int t = 0; t < chunks; t++) {
            const double complex *part = sum.sum + 4 * ((size_t)sweep->count * (size_t)t + (size_t)f);
            s[f].hh += scale * part[0], s[f].hv += scale * part[1], s[f].vh += scale * part[2],
                s[f].vv += scale * part[3];
        }
    }
    free(sum.sum);
    return STATUS_OK;
}

void polygons_free(Polygons *polygons)
{
    free(polygons->polygon);
    free(polygons->whole);
    *polygons = (Polygons){0};
}
