/* tests/bench/render/stability_parts.c: rays against degenerate triangles, and from positions that a float cannot
 * represent. The reference tests every triangle separately, in long double, without boxes or Embree. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"
#include "render/trace/parts/parts.h"

#include <stdlib.h>

typedef struct Body {
    Model       model;
    Tracer     *tracer;
    PosedNode   node[2];
    PosedEntity entity;
} Body;

static void body_pose(Body *b, const double p_enu[3], const double r_enu_from_body[9])
{
    const NodePose rest = {{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    b->entity.node = b->node;
    parts_pose(&b->entity, b->tracer, 0, &rest, p_enu, r_enu_from_body, 0);
}

static const double origin[3] = {0, 0, 0}, upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

/* Takes ownership of the model. */
static bool body_open(Body *b)
{
    const Model *models[1] = {&b->model};
    if (tracer_create_models(&b->tracer, models, 1, NULL) != STATUS_OK) return false;
    body_pose(b, origin, upright);
    return true;
}

static void body_close(Body *b)
{
    tracer_destroy(b->tracer);
    stress_model_free(&b->model);
    *b = (Body){0};
}

/* Opens a plate 4 m wide and 3 m high in the plane x = 0. */
static bool plate_open(Body *b)
{
    static const double corner[4][3] = {{0, -2, -1.5}, {0, 2, -1.5}, {0, 2, 1.5}, {0, -2, 1.5}};
    *b = (Body){0};
    if (stress_model(&b->model, 6, 2) != STATUS_OK) return false;
    stress_triangle(&b->model, corner[0], corner[1], corner[2]);
    stress_triangle(&b->model, corner[0], corner[2], corner[3]);
    return body_open(b);
}

/* ---- a plate, near and far --------------------------------------------------------------------- */

static int rays_of(bool quick, int full) { return quick ? full / 10 : full; }

/* Makes a ray to a point on the plate, at 6 degrees to it or more; its range follows from the plane's equation. */
static double plate_ray(double o[3], double d[3], Dice *dice, double far_m)
{
    const double to[3] = {0, stress_uniform(dice, -1.99, 1.99), stress_uniform(dice, -1.49, 1.49)};
    do stress_direction(d, dice);
    while (fabs(d[0]) < 0.1);
    v3_add_scaled(o, to, -far_m, d);
    return -o[0] / d[0];
}

static double plate_ranges(void *user, bool quick)
{
    Body   b;
    Dice   dice = {.stream = 1};
    double worst = 0;
    (void)user;
    if (!plate_open(&b)) return INFINITY;
    for (int n = rays_of(quick, 200000); n > 0; n--) {
        double       o[3], d[3];
        PartHit      hit;
        const double want = plate_ray(o, d, &dice, stress_log_uniform(&dice, 0.1, 200e3));
        const double error = fabs(parts_first_hit(&hit, &b.entity, o, d, INFINITY, false) / want - 1);
        if (!(error <= worst)) worst = error;
    }
    body_close(&b);
    return worst;
}

/* 1e-6 of the range inside the edge is met, as much outside is not: the position of an edge in a picture. */
static double plate_edges(void *user, bool quick)
{
    Body   b;
    Dice   dice = {.stream = 2};
    double wrong = 0;
    (void)user;
    if (!plate_open(&b)) return INFINITY;
    for (int n = rays_of(quick, 200000); n > 0; n--) {
        const double far_m = stress_log_uniform(&dice, 0.1, 200e3), off_m = fmax(1e-9 * far_m, 1e-7);
        const int    side = n % 4;
        for (int inside = 0; inside < 2; inside++) {
            const double step_m = inside ? -off_m : off_m, along = stress_uniform(&dice, -0.99, 0.99);
            double       to[3] = {0, 2 * along, 1.5 * along}, o[3],
                   d[3] = {1, stress_uniform(&dice, -0.3, 0.3), stress_uniform(&dice, -0.3, 0.3)};
            PartHit hit;
            to[1 + side % 2] = (side < 2 ? -1 : 1) * ((side % 2 ? 1.5 : 2) + step_m);
            v3_normalize(d, d);
            v3_add_scaled(o, to, -far_m, d);
            wrong += isfinite(parts_first_hit(&hit, &b.entity, o, d, INFINITY, false)) != inside;
        }
    }
    body_close(&b);
    return wrong;
}

/* Translates and rotates the whole scene, eye included, and returns the change of the range. */
static double plate_far_origins(void *user, bool quick)
{
    Body   b;
    Dice   dice = {.stream = 3};
    double worst_m = 0;
    (void)user;
    if (!plate_open(&b)) return INFINITY;
    for (int n = rays_of(quick, 100000); n > 0; n--) {
        double       p[3], r[9], o[3], d[3], o_far[3], d_far[3];
        PartHit      hit;
        const double far_m = stress_log_uniform(&dice, 0.1, 2000), want = plate_ray(o, d, &dice, far_m);
        stress_direction(p, &dice);
        v3_scale(p, stress_log_uniform(&dice, 1, 200e3), p);
        stress_any_rotation(r, &dice);
        body_pose(&b, p, r);
        m3_mul_v3(d_far, r, d);
        m3_mul_v3(o_far, r, o);
        v3_add(o_far, o_far, p);
        const double error_m = fabs(parts_first_hit(&hit, &b.entity, o_far, d_far, INFINITY, false) - want);
        if (!(error_m <= worst_m)) worst_m = error_m;
    }
    body_close(&b);
    return worst_m;
}

/* ---- a set of degenerate triangles -------------------------------------------------------------- */

enum { heap_most = 400 };

/* Needles and slivers to 1e6:1 and beyond, triangles of zero area, duplicate and reversed faces, edges shared by
 * five. */
static bool heap_open(Body *b, Dice *dice)
{
    *b = (Body){0};
    if (stress_model(&b->model, 3 * heap_most, heap_most) != STATUS_OK) return false;
    while (b->model.triangle_count < heap_most - 8) {
        double a[3], along[3], across[3], p[3], q[3];
        for (int c = 0; c < 3; c++) a[c] = stress_uniform(dice, -4, 4);
        stress_direction(along, dice);
        stress_direction(across, dice);
        const double long_m = stress_log_uniform(dice, 0.01, 8), wide_m = long_m * stress_log_uniform(dice, 1e-7, 1);
        v3_add_scaled(p, a, long_m, along);
        v3_add_scaled(q, a, stress_uniform(dice, 0, long_m), along);
        v3_add_scaled(q, q, wide_m, across);
        stress_triangle(&b->model, a, p, q);
        switch ((int)stress_uniform(dice, 0, 8)) {
        case 0:
            stress_triangle(&b->model, a, p, q);
            break; /* twice */
        case 1:
            stress_triangle(&b->model, a, q, p);
            break; /* and its back */
        case 2:
            stress_triangle(&b->model, a, a, p);
            break; /* a line */
        case 3:
            stress_triangle(&b->model, a, a, a);
            break; /* a point */
        case 4:    /* a line of three corners */
            for (int c = 0; c < 3; c++) q[c] = 0.5 * (a[c] + p[c]);
            stress_triangle(&b->model, a, p, q);
            break;
        case 5: /* a fan on one edge */
            for (int k = 0; k < 4; k++) {
                double r[3];
                stress_direction(r, dice);
                v3_add(r, r, a);
                stress_triangle(&b->model, a, p, r);
            }
            break;
        default:
            break;
        }
    }
    return body_open(b);
}

/* Computes how a ray passes a triangle: metres inside its nearest edge, below 0 outside; range; twice its area
 * projected along the ray. -INFINITY: it never does. */
static long double passes(long double *range_m, long double *seen_m2, const Model *m, int triangle, const double o[3],
                          const double d[3])
{
    long double corner[3][3], n[3], side[3], e[3][3], to = 0, rate = 0, inside = INFINITY, area2 = 0;
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) corner[k][c] = (long double)m->vertex[m->triangle[triangle][k]][c] - o[c];
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) e[k][c] = corner[(k + 1) % 3][c] - corner[k][c];
    for (int c = 0; c < 3; c++) {
        n[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
        area2 += n[c] * n[c];
    }
    for (int c = 0; c < 3; c++) to += n[c] * corner[0][c], rate += n[c] * d[c];
    if (area2 == 0 || rate == 0) return -INFINITY;
    *range_m = to / rate;
    *seen_m2 = fabsl(rate);
    for (int k = 0; k < 3; k++) { /* distance of the place on the plane from each edge, inwards */
        long double out[3], length2 = 0, dot = 0;
        for (int c = 0; c < 3; c++) {
            out[c] = n[(c + 1) % 3] * e[k][(c + 2) % 3] - n[(c + 2) % 3] * e[k][(c + 1) % 3];
            length2 += out[c] * out[c];
            dot += out[c] * (*range_m * d[c] - corner[k][c]);
        }
        side[k] = dot / sqrtl(length2);
        inside = side[k] < inside ? side[k] : inside;
    }
    return *range_m < 0 ? -INFINITY : inside;
}

typedef struct HeapCount {
    bool   done;
    double missed, invented; /* rays */
    double worst_m;          /* range of what was met, 0.1 mm of ties left out */
} HeapCount;

/* The tracer extends a triangle by 1 nm beyond its edges, so that neighbours leave no gap, and of those within 0.1
 * mm of the nearest the lowest, also where the ray passes it by 20 um: within these tolerances either result is
 * correct. So it is for a triangle so nearly edge-on that its projected area is less than this: 0.01 x 0.01 mm, of
 * which roundings of 1e-15 of 8 x 8 m are a per cent. */
static const long double least_seen_m2 = 1e-10L;

static void judge_ray(HeapCount *count, const Body *b, const double o[3], const double d[3])
{
    long double  sure_m = INFINITY, first_m = INFINITY, own_m = INFINITY; /* nearest that must be met; that may be */
    PartHit      hit;
    bool         mine = false, faint = false;
    const double got_m = parts_first_hit(&hit, &b->entity, o, d, INFINITY, false);
    const bool   met = got_m < INFINITY;
    for (int t = 0; t < b->model.triangle_count; t++) {
        long double       range_m = INFINITY, seen_m2 = 0;
        const long double inside = passes(&range_m, &seen_m2, &b->model, t, o, d);
        const bool        plain = inside > -INFINITY && seen_m2 > least_seen_m2;
        if (plain && inside > 1e-12L && range_m < sure_m) sure_m = range_m;
        if (plain && inside > -2e-9L && range_m < first_m) first_m = range_m;
        if (!met || t != (int)hit.triangle) continue;
        faint = !plain;
        mine = inside > -2.1e-5L;
        own_m = range_m;
    }
    if (!(got_m <= sure_m + 2e-4L)) count->missed += sure_m < INFINITY;
    if (!met || faint) return;
    count->invented += !mine || !(got_m >= first_m - 2e-4L) || parts_occluded(&b->entity, o, d, false) != met;
    if (mine) count->worst_m = fmax(count->worst_m, fabs((double)(got_m - own_m)));
}

/* One round of triangle sets for the three figures; user: where they are stored. */
static const HeapCount *heap(void *user, bool quick)
{
    Body       b;
    Dice       dice = {.stream = 4};
    HeapCount *count = user;
    const int  heaps = quick ? 3 : 12, rays = quick ? 1000 : 4000;
    if (count->done) return count;
    *count = (HeapCount){.done = true};
    for (int h = 0; h < heaps; h++) {
        if (!heap_open(&b, &dice)) {
            *count = (HeapCount){true, INFINITY, INFINITY, INFINITY};
            return count;
        }
        for (int n = 0; n < rays; n++) {
            const uint32_t *corner = b.model.triangle[(int)stress_uniform(&dice, 0, b.model.triangle_count)];
            double o[3], d[3], to[3] = {0}, w[3] = {1, stress_uniform(&dice, 0, 1), stress_uniform(&dice, 0, 1)};
            if (w[1] + w[2] > 1) w[1] = 1 - w[1], w[2] = 1 - w[2];
            w[0] = 1 - w[1] - w[2];
            if (n % 5 == 0) w[0] = n % 2, w[1] = !w[0], w[2] = 0; /* at a corner */
            if (n % 5 == 1) w[2] = 0, w[0] = 1 - w[1];            /* at an edge */
            for (int k = 0; k < 3; k++) v3_add_scaled(to, to, w[k], b.model.vertex[corner[k]]);
            stress_direction(d, &dice);
            v3_add_scaled(o, to, -stress_log_uniform(&dice, 0.1, 200), d);
            judge_ray(count, &b, o, d);
        }
        body_close(&b);
    }
    return count;
}

static double heap_missed(void *user, bool quick) { return heap(user, quick)->missed; }
static double heap_invented(void *user, bool quick) { return heap(user, quick)->invented; }
static double heap_range(void *user, bool quick) { return heap(user, quick)->worst_m; }

/* Many at a time and one by one, with search limits: counts results that differ in a bit. */
static double company(void *user, bool quick)
{
    enum { block = 1000 };
    static double  o[3][block], d[3][block], far_m[block], range_m[block];
    static PartHit hit[block];
    static int     list[block];
    Body           b;
    Dice           dice = {.stream = 5};
    double         wrong = 0;
    (void)user;
    for (int h = 0; h < (quick ? 2 : 40); h++) {
        if (!heap_open(&b, &dice)) return INFINITY;
        for (int n = 0; n < block; n++) {
            double        to[3], way[3];
            const double *at = b.model.vertex[(int)stress_uniform(&dice, 0, b.model.vertex_count)];
            stress_direction(way, &dice);
            for (int c = 0; c < 3; c++) to[c] = at[c] + (n % 3 ? stress_uniform(&dice, -0.5, 0.5) : 0);
            const double away_m = stress_log_uniform(&dice, 0.1, 1e5);
            for (int c = 0; c < 3; c++) o[c][n] = to[c] - away_m * way[c], d[c][n] = way[c];
            far_m[n] = n % 4 ? INFINITY : away_m;
            range_m[n] = INFINITY;
            list[n] = n;
        }
        const double *const from[3] = {o[0], o[1], o[2]}, *const towards[3] = {d[0], d[1], d[2]};
        parts_first_hits(range_m, hit, &b.entity, from, towards, far_m, list, block, h % 2);
        for (int n = 0; n < block; n++) {
            const double p[3] = {o[0][n], o[1][n], o[2][n]}, way[3] = {d[0][n], d[1][n], d[2][n]};
            PartHit      alone;
            const double alone_m = parts_first_hit(&alone, &b.entity, p, way, far_m[n], false);
            wrong += memcmp(&alone_m, &range_m[n], sizeof alone_m) != 0 ||
                     (alone_m < INFINITY && alone.triangle != hit[n].triangle);
        }
        body_close(&b);
    }
    return wrong;
}

/* Twelve coincident faces, more than are stored as ties: the lowest is met, whatever the order of the tree. */
static double coincident(void *user, bool quick)
{
    static const double corner[3][3] = {{0, -3, -3}, {0, 3, -3}, {0, 0, 3}};
    Body                b = {0};
    Dice                dice = {.stream = 6};
    double              wrong = 0;
    (void)user;
    if (stress_model(&b.model, 36, 12) != STATUS_OK) return INFINITY;
    for (int k = 0; k < 12; k++)
        stress_triangle(&b.model, corner[k % 3], corner[(k + 1 + k % 2) % 3], corner[(k + 2 - k % 2) % 3]);
    if (!body_open(&b)) return INFINITY;
    for (int n = rays_of(quick, 50000); n > 0; n--) {
        double  o[3], d[3], to[3] = {0, stress_uniform(&dice, -1, 1), stress_uniform(&dice, -2.5, 0)};
        PartHit hit = {.triangle = 99};
        stress_direction(d, &dice);
        if (fabs(d[0]) < 0.01) continue;
        v3_add_scaled(o, to, -stress_log_uniform(&dice, 0.1, 20e3), d);
        wrong += !(parts_first_hit(&hit, &b.entity, o, d, INFINITY, false) < INFINITY) || hit.triangle != 0;
    }
    body_close(&b);
    return wrong;
}

/* ---- closed bodies ------------------------------------------------------------------------------ */

/* From inside a convex body every ray meets it; and one that goes through its middle, from anywhere. All are aimed
 * exactly at vertices and edges. */
static double leaks_of(Body *b, Dice *dice, int rays)
{
    double leaks = 0;
    for (int n = 0; n < rays; n++) {
        double p[3], r[9], o[3], d[3], turned[3], to[3] = {0};
        if (n % 500 == 0) {
            stress_direction(p, dice);
            v3_scale(p, n == 0 ? 0 : stress_log_uniform(dice, 1, 200e3), p);
            stress_any_rotation(r, dice);
            body_pose(b, p, r);
        }
        const uint32_t *corner = b->model.triangle[(int)stress_uniform(dice, 0, b->model.triangle_count)];
        const int       k = (int)stress_uniform(dice, 0, 3);
        const double    share = n % 2 ? stress_uniform(dice, 0, 1) : 0;
        v3_add_scaled(to, to, 1 - share, b->model.vertex[corner[k]]);
        v3_add_scaled(to, to, share, b->model.vertex[corner[(k + 1) % 3]]);
        for (int c = 0; c < 3; c++)
            o[c] = n % 4 < 2 ? stress_uniform(dice, -0.3, 0.3) : to[c] * stress_log_uniform(dice, 2, 1000);
        v3_sub(d, to, o);
        if (!v3_normalize(d, d)) continue;
        PartHit hit;
        double  o_enu[3], d_enu[3];
        m3_mul_v3(turned, r, o);
        v3_add(o_enu, turned, p);
        m3_mul_v3(d_enu, r, d);
        leaks += !(parts_first_hit(&hit, &b->entity, o_enu, d_enu, INFINITY, false) < INFINITY);
        leaks += !parts_occluded(&b->entity, o_enu, d_enu, false);
    }
    return leaks;
}

static double leaks(void *user, bool quick)
{
    static const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
    Body                b = {0};
    Dice                dice = {.stream = 7};
    double              leaked = 0;
    (void)user;
    if (stress_model(&b.model, 8, 12) != STATUS_OK) return INFINITY;
    stress_box(&b.model, low, high);
    if (!body_open(&b)) return INFINITY;
    leaked += leaks_of(&b, &dice, quick ? 50000 : 500000);
    body_close(&b);
    if (stress_model(&b.model, 2 + 23 * 48, 4 * 24 * 23) != STATUS_OK) return INFINITY;
    stress_sphere(&b.model, 1.5, 24);
    if (!body_open(&b)) return INFINITY;
    leaked += leaks_of(&b, &dice, quick ? 50000 : 500000);
    body_close(&b);
    return leaked;
}

/* ---- invalid rays ------------------------------------------------------------------------------- */

/* Along the plate's own plane, of no direction, not finite, from 1e300 m: no result is NaN, nothing is met by an
 * invalid ray, and normals of hits have unit length. */
static double odd_rays(void *user, bool quick)
{
    static const double odd[] = {0, -0.0, 1, -1, 1e-310, 1e-30, 1e30, 1e300, INFINITY, -INFINITY, NAN};
    enum { odds = sizeof odd / sizeof *odd };
    Body   b;
    Dice   dice = {.stream = 8};
    double wrong = 0;
    (void)user;
    if (!plate_open(&b)) return INFINITY;
    for (int n = rays_of(quick, 200000); n > 0; n--) {
        double o[3], d[3], n_geo[3], n_enu[3];
        for (int c = 0; c < 3; c++) {
            o[c] = stress_uniform(&dice, 0, 1) < 0.5 ? odd[(int)stress_uniform(&dice, 0, odds)]
                                                     : stress_uniform(&dice, -3, 3);
            d[c] = stress_uniform(&dice, 0, 1) < 0.5 ? odd[(int)stress_uniform(&dice, 0, odds)]
                                                     : stress_uniform(&dice, -1, 1);
        }
        /* the direction is too long or too short to be normalised */
        if (!v3_normalize(d, d) && v3_is_finite(d) && v3_dot(d, d) > 0) continue;
        PartHit      hit;
        const double range_m = parts_first_hit(&hit, &b.entity, o, d, INFINITY, n % 3 == 0);
        const bool   real = v3_is_finite(o) && v3_is_finite(d);
        wrong += isnan(range_m) || range_m < 0 || (!real && range_m < INFINITY);
        if (!(range_m < INFINITY)) continue;
        parts_normals(n_geo, n_enu, &b.model, &b.entity, &hit, o, d, range_m);
        wrong += !(fabs(v3_length(n_geo) - 1) < 1e-12) || !(fabs(v3_length(n_enu) - 1) < 1e-6);
    }
    body_close(&b);
    return wrong;
}

Status bench_stability_parts(Bench *bench)
{
    static const StressCase cases[] = {
        {"parts: a plate at 0.1 m .. 200 km: range", plate_ranges, 1e-12, "relative", "the plane's equation"},
        {"parts: its edges, 1 nm a metre within and without", plate_edges, 0, "rays", "which side of the edge"},
        {"parts: scene and eye carried off to 200 km", plate_far_origins, 2e-9, "m", "the plane's equation at 0"},
        {"parts: needles, slivers, no area, twice, fans: missed", heap_missed, 0, "rays",
         "every triangle in long double"},
        {"parts: the same: invented", heap_invented, 0, "rays", "every triangle in long double"},
        {"parts: the same: range", heap_range, 1e-4, "m", "the triangle's plane in long double"},
        {"parts: the same: 16 at a time, culled or not", company, 0, "rays", "one by one, to the bit"},
        {"parts: twelve faces in one place", coincident, 0, "rays", "the lowest"},
        {"parts: closed bodies, at vertices and edges: leaks", leaks, 0, "rays", "a closed body"},
        {"parts: rays edge-on, without length, not finite", odd_rays, 0, "answers", "no number where there is none"},
    };
    HeapCount heap_count = {0};
    stress_cases(bench, cases, sizeof cases / sizeof *cases, &heap_count);
    return STATUS_OK;
}
