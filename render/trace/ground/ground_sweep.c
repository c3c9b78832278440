/* render/trace/ground/ground_sweep.c: distances at which the traversal of rays from one eye may begin.
 *
 * A strip is a set of rays whose tracks run between two tracks from the eye. Along it, row by row of the max pyramid's
 * nodes, the highest post between the two limits how steeply a ray may descend and still be clear; the flattest ray is
 * clear the farthest. So one sweep along a strip serves all its rays: each begins at the first row that may block it.
 * The hit itself is computed elsewhere (see ground_private.h), so that the start only must not be too late.
 *
 * Distances a are along the axis that the tracks mostly follow. A ray is at c0 + m a across it and at the height w0
 * + q a, less bend (1 + m^2) a^2 of a bent ray. Strips and slopes hold for every level: m is in metres per metre. */

#include "render/trace/ground/ground_private.h"

/* Rays per strip: with fewer, sweeping costs more than it saves. Buckets hold rays of similar slope. */
enum { strip_rays = 128, most_strips = 8, buckets = 128, highest_row = 8 };

/* Margins for rounding: the eye is within 1e6 cells and 1e8 posts of every level's corner, where c is accurate to 1e-9
 * and w to 1e-7; and distances to 1e-9 of themselves and 1e-9 m. These are a hundred times that and more. */
static const double near_cells = 1e6, near_posts = 1e8, room_posts = 1e-3, room_cells = 1e-6, room_m = 1e-6,
                    room_relative = 1e-9;

typedef struct Strip {
    int    count;
    double m_low, m_high, q_low, q_high;
    double bend_per_m;              /* at least that of all of them, by a */
    double per_bucket, buckets_per; /* of q: bucket b holds rays of q_low + b per_bucket and more */
    double start_m[buckets];        /* a */
} Strip;

/* The eye and the axis, on one level: cells and posts. */
typedef struct Axis {
    bool   along_v, forward;
    double a0, c0, w0;
    int    a_cells, c_cells;
    double eye_out; /* distance of the eye from the level's rectangle, < 0 inside; cells */
} Axis;

static Axis axis_on(const GroundLevel *g, const double o_enu[3], bool along_v, bool forward)
{
    const double u0 = (o_enu[0] - g->x0_m) * g->cells_per_m, v0 = (o_enu[1] - g->y0_m) * g->cells_per_m;
    Axis         axis = {.along_v = along_v, .forward = forward, .w0 = (o_enu[2] - g->z0_m) * g->posts_per_m};
    axis.a0 = along_v ? v0 : u0;
    axis.c0 = along_v ? u0 : v0;
    axis.a_cells = along_v ? g->cells_y : g->cells_x;
    axis.c_cells = along_v ? g->cells_x : g->cells_y;
    axis.eye_out = fmax(fmax(-u0, u0 - g->cells_x), fmax(-v0, v0 - g->cells_y));
    return axis;
}

static bool is_near(const Axis *axis)
{
    return fabs(axis->a0) <= near_cells && fabs(axis->c0) <= near_cells && fabs(axis->w0) <= near_posts;
}

/* The a up to which the whole strip is above the level; 0 where the eye is not. Cells. */
static double covered(const Axis *axis, const Strip *s)
{
    if (!(axis->eye_out < -1)) return 0;
    double a = axis->forward ? axis->a_cells - axis->a0 : axis->a0;
    if (s->m_high > 0) a = fmin(a, (axis->c_cells - axis->c0) / s->m_high);
    if (s->m_low < 0) a = fmin(a, axis->c0 / -s->m_low);
    return a * (1 - room_relative) - room_cells;
}

/* Highest post of a row of nodes between two c; nothing_there: no node. */
enum { nothing_there = INT32_MIN };

static int highest_between(const GroundLevel *g, const Axis *axis, int k, int row, double c_low, double c_high)
{
    if (!(c_high >= 0 && c_low <= axis->c_cells)) return nothing_there;
    const double    last = axis->c_cells - 1;
    const int       from = (int)clamp(c_low, 0, last) >> k, to = (int)clamp(c_high, 0, last) >> k;
    const size_t    nx = (size_t)g->pyramid_nx[k], step = axis->along_v ? 1 : nx;
    const size_t    at = axis->along_v ? (size_t)row * nx + (size_t)from : (size_t)from * nx + (size_t)row;
    const uint16_t *z = g->pyramid[k] + at;
    int             highest = 0;
    for (int n = from; n <= to; n++, z += step) highest = *z > highest ? *z : highest;
    return g->pyramid_base + (highest << g->pyramid_shift);
}

/* The lowest height of rays of a slope between two a, over the eye's: at one of the two. */
static inline double lowest_between(double q, double bend, double a, double next)
{
    const double here = a * (q - a * bend), there = next * (q - next * bend);
    return here < there ? here : there;
}

/* Reduces the strip's start distances to where this level's rows may block it, searching from a on. */
static void sweep_level(Strip *s, const GroundLevel *g, const Axis *axis, double a)
{
    const double sign = axis->forward ? 1 : -1;
    const double at_low = (0 - axis->a0) * sign, at_high = (axis->a_cells - axis->a0) * sign;
    const double end = fmax(at_low, at_high), posts_per_cell = g->posts_per_m / g->cells_per_m;
    const double q_low = (s->q_low - 1e-12 * fabs(s->q_low)) * posts_per_cell, q_step = s->per_bucket * posts_per_cell;
    const double bend = s->bend_per_m * g->posts_per_m / (g->cells_per_m * g->cells_per_m);
    a = fmax(fmax(fmin(at_low, at_high), a), 0);
    int    cell = (int)clamp(floor(axis->a0 + sign * a), 0, axis->a_cells - 1);
    int    b = 0, k = g->top < 6 ? g->top : 6;
    double q = q_low;
    while (a < end) {
        const int    row = cell >> k;
        const double next = axis->forward ? (double)(row + 1) * (1 << k) - axis->a0 : axis->a0 - (double)row * (1 << k);
        const double c_low = axis->c0 + s->m_low * (s->m_low < 0 ? next : a) - room_cells;
        const double c_high = axis->c0 + s->m_high * (s->m_high > 0 ? next : a) + room_cells;
        const int    highest = highest_between(g, axis, k, row, c_low, c_high);
        const double limit = highest + room_posts - axis->w0;
        if (highest != nothing_there && !(lowest_between(q, bend, a, next) > limit)) {
            /* nodes half as wide as the strip are fine enough */
            if (k > elevation_pyramid_first && 2 * (1 << k) > (s->m_high - s->m_low) * next) {
                k--;
                continue;
            }
            const double start_m = a / g->cells_per_m;
            do {
                s->start_m[b] = start_m < s->start_m[b] ? start_m : s->start_m[b];
                if (++b == buckets) return;
                q = q_low + b * q_step;
            } while (!(lowest_between(q, bend, a, next) > limit));
        }
        a = next;
        cell = axis->forward ? (row + 1) << k : (row << k) - 1;
        if (k < g->top && k < highest_row && ((row + axis->forward) & 1) == 0) k++;
    }
}

static void sweep_strip(Strip *s, const Ground *ground, const double o_enu[3], bool along_v, bool forward)
{
    s->buckets_per = s->q_high > s->q_low ? buckets * (1 - room_relative) / (s->q_high - s->q_low) : 0;
    s->per_bucket = s->q_high > s->q_low ? 1 / s->buckets_per : 0;
    for (int b = 0; b < buckets; b++) s->start_m[b] = INFINITY;
    s->bend_per_m = ground->bend_per_m * (1 + fmax(s->m_low * s->m_low, s->m_high * s->m_high)) * (1 + room_relative);
    double from_m = 0; /* up to here an inner level has been processed */
    for (int n = 0; n < ground->level_count && !(s->start_m[buckets - 1] <= from_m); n++) {
        const GroundLevel *g = &ground->level[n];
        const Axis         axis = axis_on(g, o_enu, along_v, forward);
        sweep_level(s, g, &axis, from_m * g->cells_per_m);
        from_m = fmax(from_m, covered(&axis, s) / g->cells_per_m);
    }
}

/* Distances before which rays from one eye meet nothing: from_m[i], INFINITY where that is everywhere. False: not
 * known, from_m is not written. */
static bool ground_sweep(double *from_m, const Ground *ground, int count, const double o_enu[3],
                         const double *const d_enu[3])
{
    const int strips = count / strip_rays < most_strips ? count / strip_rays : most_strips;
    double    sum[2] = {0}, per_a[ground_together], m[ground_together], q[ground_together];
    uint8_t   strip_of[ground_together];
    Strip     strip[most_strips];
    if (strips == 0 || !v3_is_finite(o_enu)) return false;

    for (int c = 0; c < 2; c++)
        for (int i = 0; i < count; i++) sum[c] += d_enu[c][i];
    const bool along_v = fabs(sum[1]) > fabs(sum[0]), forward = sum[along_v] > 0;
    for (int n = 0; n < ground->level_count; n++) {
        const Axis axis = axis_on(&ground->level[n], o_enu, along_v, forward);
        if (!is_near(&axis)) return false;
    }
    double m_low = INFINITY, m_high = -INFINITY;
    bool   fit = true; /* not for tracks that diverge, nor near straight up or down */
    for (int i = 0; i < count; i++) {
        const double a = forward ? d_enu[along_v][i] : -d_enu[along_v][i];
        fit &= (a >= 0.02) & (a <= 2) & (fabs(d_enu[!along_v][i]) <= 2) & (fabs(d_enu[2][i]) <= 2);
        per_a[i] = 1 / a;
        m[i] = d_enu[!along_v][i] * per_a[i];
        q[i] = d_enu[2][i] * per_a[i];
        m_low = m[i] < m_low ? m[i] : m_low;
        m_high = m[i] > m_high ? m[i] : m_high;
    }
    if (!fit || !(m_high - m_low < 0.5)) return false;

    const double per_m = m_high > m_low ? strips * (1 - room_relative) / (m_high - m_low) : 0;
    for (int k = 0; k < strips; k++)
        strip[k] = (Strip){.m_low = INFINITY, .m_high = -INFINITY, .q_low = INFINITY, .q_high = -INFINITY};
    for (int i = 0; i < count; i++) {
        Strip *s = &strip[strip_of[i] = (uint8_t)((m[i] - m_low) * per_m)];
        s->count++;
        s->m_low = m[i] < s->m_low ? m[i] : s->m_low;
        s->m_high = m[i] > s->m_high ? m[i] : s->m_high;
        s->q_low = q[i] < s->q_low ? q[i] : s->q_low;
        s->q_high = q[i] > s->q_high ? q[i] : s->q_high;
    }
    for (int k = 0; k < strips; k++)
        if (strip[k].count > 0) sweep_strip(&strip[k], ground, o_enu, along_v, forward);
    for (int i = 0; i < count; i++) {
        const Strip *s = &strip[strip_of[i]];
        const int    b = (int)((q[i] - s->q_low) * s->buckets_per);
        from_m[i] = s->start_m[b] * per_a[i] * (1 - room_relative) - room_m;
    }
    return true;
}

/* ---- proves that a bundle of rays is clear of the ground ------------------------------------- */

/* Proves that a bundle of rays is clear of the ground: in pieces along it, each twice
 * as long as the last, the lowest point of the piece is compared with the highest posts under it. */

/* Margin above the posts: rounding of coordinates of 1e6 m is 1e-9 of it, on the steepest ground. */
static const double clear_m = 1e-3;
static const double beside_cells = 1e-3;

enum { pieces = 40 };

/* Whether no post of a level within x0 .. x1, y0 .. y1 is as high as low_m. */
static bool level_is_below(const GroundLevel *g, double low_m, const double low[2], const double high[2])
{
    const double most[2] = {g->cells_x - 1, g->cells_y - 1}, corner[2] = {g->x0_m, g->y0_m};
    double       from[2], to[2];
    for (int c = 0; c < 2; c++) {
        from[c] = floor((low[c] - corner[c]) * g->cells_per_m - beside_cells);
        to[c] = floor((high[c] - corner[c]) * g->cells_per_m + beside_cells);
        if (to[c] < 0 || from[c] > most[c] + 1) return true; /* beside it */
        from[c] = clamp(from[c], 0, most[c]);
        to[c] = clamp(to[c], 0, most[c]);
    }
    const double span = fmax(to[0] - from[0], to[1] - from[1]), post = (low_m - clear_m - g->z0_m) * g->posts_per_m;
    int          k = span > 2 ? elevation_pyramid_first : 0;
    while (k > 0 && k < g->top && (2 << k) < span) k++;
    for (int j = (int)from[1] >> k; j <= (int)to[1] >> k; j++)
        for (int i = (int)from[0] >> k; i <= (int)to[0] >> k; i++)
            if (!((k > 0 ? ground_highest(g, k, i, j) : ground_cell_highest(g, i, j)) < post)) return false;
    return true;
}

bool ground_is_clear(const Ground *ground, const double from[2][3], const double to[2][3])
{
    if (ground->level_count == 0) return true;
    const GroundLevel *all = &ground->level[ground->level_count - 1];
    const double       cells[2] = {all->cells_x, all->cells_y}, corner[2] = {all->x0_m, all->y0_m};
    double             length_m = 0, size_m = 0;
    for (int c = 0; c < 2; c++) {
        if (!((from[0][c] - corner[c]) * all->cells_per_m > 0 &&
              (from[1][c] - corner[c]) * all->cells_per_m < cells[c]))
            return false; /* it could enter from the side */
        length_m = fmax(length_m, fmax(fabs(to[0][c] - from[0][c]), fabs(to[1][c] - from[1][c])));
        size_m = fmax(size_m, from[1][c] - from[0][c]);
    }
    const double first_m = fmax(0.5 * size_m, 1 / ground->level[0].cells_per_m);
    double       share = 0, step = first_m < length_m ? first_m / length_m : 1;
    for (int n = 0; n < pieces; n++, step *= 2) {
        const double end = share + step < 1 ? share + step : 1;
        double       low[3], high[3];
        for (int c = 0; c < 3; c++) {
            low[c] = from[0][c] + fmin(share * (to[0][c] - from[0][c]), end * (to[0][c] - from[0][c]));
            high[c] = from[1][c] + fmax(share * (to[1][c] - from[1][c]), end * (to[1][c] - from[1][c]));
        }
        for (int k = 0; k < ground->level_count; k++)
            if (!level_is_below(&ground->level[k], low[2], low, high)) return false;
        if (end >= 1) return true;
        share = end;
    }
    return false;
}

bool ground_is_clear_towards(const Ground *ground, const double from[2][3], const double d_enu[3])
{
    double top_m = -INFINITY, to[2][3];
    if (!(d_enu[2] > 1e-3)) return ground->level_count == 0;
    for (int k = 0; k < ground->level_count; k++) {
        const GroundLevel *g = &ground->level[k];
        top_m = fmax(top_m, g->z0_m + g->highest / g->posts_per_m);
    }
    const double far_m = fmax(top_m + 2 * clear_m - from[0][2], 0) / d_enu[2];
    for (int side = 0; side < 2; side++) v3_add_scaled(to[side], from[side], far_m, d_enu);
    return ground_is_clear(ground, from, to);
}

/* ---- coherent rays --------------------------------------------------------------------------- */

/* Coherent rays: start distances (ground_sweep.c), nearby hits (ground_near.c), and
 * the remaining rays (ground8.c). */

/* Whether all are the same. */
static bool one_vector(int count, const double *const p[3])
{
    bool same = true;
    for (int c = 0; c < 3; c++)
        for (int i = 1; i < count; i++) same &= p[c][i] == p[c][0];
    return same;
}

static void tile_hits(double *range_m, GroundHit *hit, const Ground *ground, int count, const double *const o[3],
                      const double *const d[3], const double *far_m)
{
    double from_m[ground_together];
    int    left[ground_together];
    int    start_level = 0;
    if (one_vector(count, o)) {
        const double eye[3] = {o[0][0], o[1][0], o[2][0]};
        if (!ground_sweep(from_m, ground, count, eye, d)) {
            for (int i = 0; i < count; i++) from_m[i] = 0;
            start_level = 6;
        }
    } else if (one_vector(count, d)) {
        for (int i = 0; i < count; i++) from_m[i] = 0;
    } else { /* each is traced separately */
        ground_first_hits(range_m, hit, ground, count, o, d, far_m);
        return;
    }
    count = ground_near_hits(left, range_m, hit, ground, count, o, d, far_m, from_m, start_level);
    ground_first_hits_from(range_m, hit, ground, count, o, d, far_m, from_m, left);
}

void ground_first_hits_together(double *range_m, GroundHit *hit, const Ground *ground, int count,
                                const double *const o_enu[3], const double *const d_enu[3], const double *far_m)
{
    if (ground->level_count == 0) {
        ground_first_hits(range_m, hit, ground, count, o_enu, d_enu, far_m);
        return;
    }
    for (int n = 0; n < count; n += ground_together) {
        const double *const o[3] = {o_enu[0] + n, o_enu[1] + n, o_enu[2] + n};
        const double *const d[3] = {d_enu[0] + n, d_enu[1] + n, d_enu[2] + n};
        const int           some = count - n < ground_together ? count - n : ground_together;
        tile_hits(range_m + n, hit ? hit + n : NULL, ground, some, o, d, far_m + n);
    }
}
