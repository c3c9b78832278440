/* render/radar/polygons.c: flat faces in closed form: which are wholly seen, and their field. */
#include "render/radar/polygons.h"

#include "render/radar/currents.h"

#include <stdlib.h>

enum {
    block_rays = 512,  /* traced together */
    chunk_faces = 16, chunk_polygons = 2048,
    halvings = 18      /* of a triangle; one that needs more is left to tubes */
};
static const double per_radius = 128;    /* rays over the target's radius; on convex bodies 8, for sheets that coincide */
static const double inside_m = 5e-4;     /* rays along a border keep off it */
static const double thin_m = 1e-3;       /* triangles thinner than this are seen where the rest of their face is */
static const double grazing = 1e-3;      /* cosine below which an antenna does not see a face */
static const double linear_rad = 4e-3;   /* a side's phase out of a straight line */
static const double turn_rad = 0.05;     /* a side, seen from an antenna */

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
    /* Nearly specular, where those cancel: 2 sum of (-j)^n h_n / (n + 2)!, h_n the sum of all products of n about the
     * middle. */
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

/* ---- what is seen -------------------------------------------------------------------------------------- */

typedef struct Block {
    double  o[3][block_rays], d[3][block_rays], far_m[block_rays], range_m[block_rays];
    PartHit hit[block_rays];
    uint32_t triangle[block_rays]; /* each should meet */
    int     list[block_rays], count;
} Block;

typedef struct Search {
    const RadarTarget *target;
    ScatterAntenna antenna[2];
    int        antennas;   /* 1: transmitter and receiver are one */
    double     spacing_m;
    Block     *block;      /* one a worker */
    uint8_t   *seen;       /* [faces] */
    long long *rays;       /* [chunks] */
} Search;

static void corners_of(double corner[3][3], const RadarTarget *target, uint32_t triangle)
{
    const Model    *model = target->model;
    const NodePose *at = &target->pose[model->part[model->triangle_part[triangle]].node];
    for (int k = 0; k < 3; k++) {
        m3_mul_v3(corner[k], at->r_body_from_node, model->vertex[model->triangle[triangle][k]]);
        v3_add(corner[k], corner[k], at->p_body);
    }
}

static double normal_of(double n[3], const double corner[3][3])
{
    double ab[3], ac[3];
    v3_sub(ab, corner[1], corner[0]);
    v3_sub(ac, corner[2], corner[0]);
    v3_cross(n, ab, ac);
    const double area2 = v3_length(n);
    v3_normalize(n, n);
    return 0.5 * area2;
}

static bool trace_block(Block *block, const RadarTarget *target)
{
    const double *const o[3] = {block->o[0], block->o[1], block->o[2]};
    const double *const d[3] = {block->d[0], block->d[1], block->d[2]};
    bool met = true;
    for (int i = 0; i < block->count; i++) block->list[i] = i, block->range_m[i] = INFINITY;
    parts_first_hits(block->range_m, block->hit, &target->entity, o, d, block->far_m, block->list, block->count, false);
    for (int i = 0; i < block->count; i++)
        met &= !isinf(block->range_m[i]) && block->hit[i].triangle == block->triangle[i];
    block->count = 0;
    return met;
}

/* A ray from the antenna to a point of a triangle. False: the block was full, and one of its rays met something else. */
static bool ask(Block *block, const Search *s, const ScatterAntenna *antenna, uint32_t triangle, const double p[3],
                long long *rays)
{
    const int i = block->count++;
    double    way[3];
    const double away_m = antenna->range_m + scatter_path(way, antenna, p);
    const double back_m = fmin(2.5 * s->target->entity.radius_m + 1e-3, away_m);
    for (int c = 0; c < 3; c++) {
        block->o[c][i] = p[c] + back_m * way[c];
        block->d[c][i] = -way[c];
    }
    block->far_m[i] = INFINITY;
    block->triangle[i] = triangle;
    ++*rays;
    return block->count < block_rays || trace_block(block, s->target);
}

/* Points of a triangle in rows along its longest side; then along all sides. */
static bool ask_triangle(Block *block, const Search *s, const ScatterAntenna *antenna, uint32_t triangle,
                         long long *rays)
{
    double       corner[3][3], n[3], p[3], middle[3], side_m[3];
    corners_of(corner, s->target, triangle);
    const double area_m2 = normal_of(n, corner);
    int          base = 0;
    for (int k = 0; k < 3; k++) {
        double side[3];
        v3_sub(side, corner[(k + 1) % 3], corner[k]);
        side_m[k] = v3_length(side);
        if (side_m[k] > side_m[base]) base = k;
        middle[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
    }
    const double *a = corner[base], *b = corner[(base + 1) % 3], *tip = corner[(base + 2) % 3];
    const double  height_m = 2 * area_m2 / side_m[base];
    if (height_m < thin_m) return true;
    if (!ask(block, s, antenna, triangle, middle, rays)) return false;
    for (int k = 0; k < 3; k++) {
        const int    count = (int)ceil(side_m[k] / s->spacing_m);
        const double in = fmin(0.25, 3 * inside_m * side_m[k] / (2 * area_m2)); /* the middle is a third of a height away */
        for (int i = 0; i < count; i++) {
            const double along = (i + 0.5) / count;
            for (int c = 0; c < 3; c++) {
                const double on = corner[k][c] + along * (corner[(k + 1) % 3][c] - corner[k][c]);
                p[c] = on + in * (middle[c] - on);
            }
            if (!ask(block, s, antenna, triangle, p, rays)) return false;
        }
    }
    const int rows = (int)floor(height_m / s->spacing_m);
    for (int j = 0; j < rows; j++) {
        const double up = (j + 0.5) / rows;
        const int    count = (int)ceil((1 - up) * side_m[base] / s->spacing_m);
        for (int i = 0; i < count; i++) {
            const double along = (i + (j % 2 ? 0.25 : 0.75)) / count * (1 - up);
            for (int c = 0; c < 3; c++) p[c] = a[c] + along * (b[c] - a[c]) + up * (tip[c] - a[c]);
            if (!ask(block, s, antenna, triangle, p, rays)) return false;
        }
    }
    return true;
}

/* The side of a face, 1 or -1, that both antennas are on; 0: they are not, or along it. */
static int side_of(const Search *s, const double corner[3][3])
{
    double n[3], way[3];
    int    side = 0;
    normal_of(n, corner);
    for (int a = 0; a < s->antennas; a++) {
        double least = INFINITY, most = -INFINITY;
        for (int k = 0; k < 3; k++) {
            scatter_path(way, &s->antenna[a], corner[k]);
            least = fmin(least, v3_dot(n, way)), most = fmax(most, v3_dot(n, way));
        }
        const int here = least > grazing ? 1 : most < -grazing ? -1 : 0;
        if (here == 0 || (a > 0 && here != side)) return 0;
        side = here;
    }
    return side;
}

static bool face_is_seen(Block *block, const Search *s, int face, long long *rays)
{
    const FlatFaces *faces = &s->target->faces;
    const int        first = faces->first[face], end = faces->first[face + 1];
    block->count = 0;
    for (int i = first; i < end; i++) {
        double corner[3][3];
        corners_of(corner, s->target, faces->triangle[i]);
        if (side_of(s, corner) == 0) return false;
    }
    for (int a = 0; a < s->antennas; a++) { /* first one ray of each, which finds most of what is hidden */
        for (int i = first; i < end && i < first + block_rays; i++) {
            double corner[3][3], middle[3];
            corners_of(corner, s->target, faces->triangle[i]);
            for (int c = 0; c < 3; c++) middle[c] = 0.4 * corner[0][c] + 0.35 * corner[1][c] + 0.25 * corner[2][c];
            if (!ask(block, s, &s->antenna[a], faces->triangle[i], middle, rays)) return false;
        }
        if (!trace_block(block, s->target)) return false;
    }
    for (int a = 0; a < s->antennas; a++)
        for (int i = first; i < end; i++)
            if (!ask_triangle(block, s, &s->antenna[a], faces->triangle[i], rays)) return false;
    return trace_block(block, s->target);
}

static void look_at_faces(void *user, int worker, int task)
{
    const Search *s = user;
    const int     end = (task + 1) * chunk_faces < s->target->faces.count ? (task + 1) * chunk_faces : s->target->faces.count;
    for (int f = task * chunk_faces; f < end; f++) s->seen[f] = face_is_seen(&s->block[worker], s, f, &s->rays[task]);
}

/* ---- the list ------------------------------------------------------------------------------------------ */

typedef struct Making {
    const RadarTarget *target;
    Polygons          *out;
    RadarSurface       surface; /* of the face's part */
    double             k;
    uint32_t           triangle;
    bool               fits;    /* false: a triangle would be halved too often */
} Making;

static double path_at(const Polygons *out, const double p[3])
{
    double way[3];
    return scatter_path(way, &out->tx, p) + scatter_path(way, &out->rx, p);
}

/* Whether a side's phase is a straight line, and directions along it hardly change. */
static bool is_linear(const Making *m, const double p[3], const double q[3], double p_m, double q_m)
{
    const ScatterAntenna *antenna[2] = {&m->out->tx, &m->out->rx};
    double                middle[3], side[3], way[3];
    if (isinf(antenna[0]->range_m) && isinf(antenna[1]->range_m)) return true;
    for (int c = 0; c < 3; c++) middle[c] = 0.5 * (p[c] + q[c]);
    v3_sub(side, q, p);
    for (int a = 0; a < 2; a++)
        if (!isinf(antenna[a]->range_m) &&
            !(v3_length(side) <= turn_rad * (antenna[a]->range_m + scatter_path(way, antenna[a], middle))))
            return false;
    return m->k * fabs(path_at(m->out, middle) - 0.5 * (p_m + q_m)) <= linear_rad;
}

/* What a triangle radiates, from its middle: as a tube of its area does. */
static void amplitude_of(Polygon *polygon, const Making *m)
{
    const Polygons *out = m->out;
    double          middle[3], to_tx[3], s[3], d[3], n[3], e[2][3];
    Field           field[2];
    double complex  te = -1, tm = 1;
    for (int c = 0; c < 3; c++) middle[c] = (polygon->corner[0][c] + polygon->corner[1][c] + polygon->corner[2][c]) / 3;
    double       area_m2 = 0.5 * normal_of(n, polygon->corner); /* facet_radiates is twice the field */
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
    if (m->surface.kind != RADAR_METAL || m->surface.rough_m > 0)
        fresnel_surface(&te, &tm, &m->surface, m->k, fmin(1, -v3_dot(n, d)));
    facet_radiates(polygon->amplitude, field, &m->surface, te, tm, n, d, s, &out->rx);
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
static int bent_side(const Making *m, const double corner[3][3], const double path_m[3])
{
    double longest_m = 0;
    int    longest = -1;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        double    side[3];
        v3_sub(side, corner[b], corner[a]);
        if (v3_length(side) > longest_m && !is_linear(m, corner[a], corner[b], path_m[a], path_m[b]))
            longest_m = v3_length(side), longest = a;
    }
    return longest;
}

static Status add_polygon(Making *m, const double corner[3][3], const double path_m[3], int depth);

/* Both halves of a triangle, cut across a side; a neighbour's is cut at the same point. */
static Status add_halves(Making *m, const double corner[3][3], const double path_m[3], int side, int depth)
{
    const int a = side, b = (a + 1) % 3, tip = (a + 2) % 3;
    double    half[3][3], half_m[3];
    for (int c = 0; c < 3; c++) half[1][c] = 0.5 * (corner[a][c] + corner[b][c]);
    half_m[1] = path_at(m->out, half[1]);
    memcpy(half[0], corner[a], sizeof half[0]);
    memcpy(half[2], corner[tip], sizeof half[2]);
    half_m[0] = path_m[a], half_m[2] = path_m[tip];
    const Status status = add_polygon(m, half, half_m, depth + 1);
    if (status != STATUS_OK || !m->fits) return status;
    memcpy(half[0], half[1], sizeof half[0]);
    memcpy(half[1], corner[b], sizeof half[1]);
    half_m[0] = half_m[1], half_m[1] = path_m[b];
    return add_polygon(m, half, half_m, depth + 1);
}

static Status add_polygon(Making *m, const double corner[3][3], const double path_m[3], int depth)
{
    const int side = bent_side(m, corner, path_m);
    if (side >= 0 && depth < halvings) return add_halves(m, corner, path_m, side, depth);
    m->fits = side < 0;
    if (!m->fits) return STATUS_OK;
    Polygons *out = m->out;
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
    polygon->triangle = m->triangle;
    amplitude_of(polygon, m);
    return STATUS_OK;
}

/* A face that is seen; none of it where it does not fit. */
static Status add_face(Making *m, int face)
{
    const RadarTarget *target = m->target;
    const FlatFaces   *faces = &target->faces;
    const int          before = m->out->count, first = faces->first[face], end = faces->first[face + 1];
    const int          part = target->model->triangle_part[faces->triangle[first]];
    Status             status = STATUS_OK;
    m->surface = (RadarSurface){0};
    if (target->materials)
        radar_surface(&m->surface, &target->materials->material[target->material[part]], m->k * light_mps / (2 * pi_rad));
    m->fits = true;
    for (int i = first; i < end && m->fits && status == STATUS_OK; i++) {
        double corner[3][3], path_m[3];
        m->triangle = faces->triangle[i];
        corners_of(corner, target, m->triangle);
        for (int k = 0; k < 3; k++) path_m[k] = path_at(m->out, corner[k]);
        status = add_polygon(m, corner, path_m, 0);
    }
    if (!m->fits) m->out->count = before;
    for (int i = first; i < end && m->fits; i++) m->out->whole[faces->triangle[i]] = 1;
    return status;
}

/* Whether tubes would find nothing more: of a convex body each face with an antenna in front is here. */
static bool is_all(const Polygons *out, const Search *s)
{
    const FlatFaces *faces = &s->target->faces;
    if (!faces->convex) return false;
    for (int f = 0; f < faces->count; f++) {
        double          corner[3][3], n[3], to[3];
        const uint32_t  t = faces->triangle[faces->first[f]];
        bool            lit = true;
        if (out->whole[t]) continue;
        corners_of(corner, s->target, t);
        normal_of(n, corner);
        for (int a = 0; a < s->antennas; a++) {
            scatter_path(to, &s->antenna[a], corner[0]);
            lit &= v3_dot(n, to) > 0 || faces->count == 1;
        }
        if (lit) return false;
    }
    return true;
}

static bool antenna_is_good(const ScatterAntenna *a)
{
    return v3_is_finite(a->u) && fabs(v3_dot(a->u, a->u) - 1) < 1e-9 && a->range_m > 0;
}

Status polygons_find(Polygons *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                     const TubeConfig *config, Pool *pool)
{
    const FlatFaces *faces = &target->faces;
    const int        threads = pool ? pool_threads(pool) : 1, chunks = (faces->count + chunk_faces - 1) / chunk_faces;
    const int        triangles = target->model->triangle_count;
    const bool       one = memcmp(tx->u, rx->u, sizeof tx->u) == 0 && tx->range_m == rx->range_m;
    const double     spacing_m = target->entity.radius_m / (faces->convex ? 8 : per_radius);
    Search s = {.target = target, .antenna = {*tx, *rx}, .antennas = one ? 1 : 2, .spacing_m = spacing_m};
    Making making = {.target = target, .out = out, .k = 2 * pi_rad * config->frequency_hz / light_mps};
    Status status = STATUS_NO_MEMORY;
    out->count = 0;
    out->rays = 0;
    out->all = false;
    out->tx = *tx, out->rx = *rx;
    if (triangles > out->whole_size) {
        uint8_t *larger = realloc(out->whole, (size_t)triangles);
        if (!larger) return STATUS_NO_MEMORY;
        out->whole = larger;
        out->whole_size = triangles;
    }
    memset(out->whole, 0, (size_t)triangles);
    if (faces->count == 0 || faces->count > config->polygon_faces || target->entity.node_count == 0 || config->warp_m > 0 || config->last_only ||
        config->keep_hidden || !antenna_is_good(tx) || !antenna_is_good(rx) || !(config->frequency_hz > 0) ||
        isinf(config->frequency_hz))
        return STATUS_OK;
    s.block = malloc((size_t)threads * sizeof *s.block);
    s.seen = calloc((size_t)faces->count, sizeof *s.seen);
    s.rays = calloc((size_t)chunks, sizeof *s.rays);
    if (!s.block || !s.seen || !s.rays) goto done;
    if (pool) pool_run(pool, chunks, look_at_faces, &s);
    else for (int t = 0; t < chunks; t++) look_at_faces(&s, 0, t);
    status = STATUS_OK;
    for (int t = 0; t < chunks; t++) out->rays += s.rays[t];
    for (int f = 0; f < faces->count && status == STATUS_OK; f++)
        if (s.seen[f]) status = add_face(&making, f);
    out->all = status == STATUS_OK && is_all(out, &s);

done:
    free(s.block);
    free(s.seen);
    free(s.rays);
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
    const Sweep *sweep = user;
    const int    first = task * chunk_polygons, left = sweep->polygons->count - first;
    const int    count = left < chunk_polygons ? left : chunk_polygons;
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

Status polygons_sweep(ScatterMatrix *s, int count, double first_hz, double step_hz, const Polygons *polygons,
                      const ScatterAntenna *tx, const ScatterAntenna *rx, Pool *pool)
{
    const double k_per_hz = 2 * pi_rad / light_mps;
    const int    chunks = (polygons->count + chunk_polygons - 1) / chunk_polygons;
    Sweep        sweep = {.polygons = polygons, .tx = tx ? *tx : polygons->tx, .rx = rx ? *rx : polygons->rx,
                          .moved = tx || rx, .count = count, .first_k = first_hz * k_per_hz, .step_k = step_hz * k_per_hz};
    if (chunks == 0) return STATUS_OK;
    sweep.sum = calloc(4 * (size_t)count * (size_t)chunks, sizeof *sweep.sum);
    if (!sweep.sum) return STATUS_NO_MEMORY;
    if (pool) pool_run(pool, chunks, sum_chunk, &sweep);
    else for (int t = 0; t < chunks; t++) sum_chunk(&sweep, 0, t);
    for (int f = 0; f < count; f++) {
        const double complex scale = CMPLX(0, -(sweep.first_k + f * sweep.step_k) / (2 * pi_rad));
        for (int t = 0; t < chunks; t++) {
            const double complex *sum = sweep.sum + 4 * ((size_t)count * (size_t)t + (size_t)f);
            s[f].hh += scale * sum[0], s[f].hv += scale * sum[1], s[f].vh += scale * sum[2], s[f].vv += scale * sum[3];
        }
    }
    free(sweep.sum);
    return STATUS_OK;
}

void polygons_free(Polygons *polygons)
{
    free(polygons->polygon);
    free(polygons->whole);
    *polygons = (Polygons){0};
}
