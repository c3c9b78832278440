/* render/trace/ground/ground_private.h: the arithmetic that the scalar and the eight-wide ground tracer share.
 *
 * In the units of one level a ray is u0 + t du, v0 + t dv (cells), w0 + t (dw - t bend) (posts), t in metres. It meets
 * the line of posts u = e at t = (e - u0) / du: a value that does not depend on the path of traversal and never
 * decreases in the order of the lines, not even by rounding. So "the cell at t" is found by counting the lines met at
 * or before t, a cell's interval is the same from whichever side it is reached, and the height inside it is no lower
 * than at one of the ends of any interval that contains it. Skipping a node whose highest post is below the ray's lower
 * end is then exact, not only conservative (of a bent ray to far below ground_clear_posts). */
#ifndef RENDER_TRACE_GROUND_GROUND_PRIVATE_H
#define RENDER_TRACE_GROUND_GROUND_PRIVATE_H

#include "render/trace/ground/ground.h"
#include "pitviper_simd.h"

/* Above a post by this much a ray is clear of it, despite the rounding of an interpolated height (2^25 posts times
 * a few roundings is 3e-8 post). */
static const double ground_clear_posts = 1e-6;

/* Farther along a ray than this there is no ground: from 1e9 m out, either the track would be past it, or the ray is
 * so steep that it is over the level's rectangle only far below or above the Earth. */
static const double farthest_m = 1e10;

typedef struct LevelRay {
    double u0, v0, w0, du, dv, dw, bend;
    double per_du, per_dv, per_duv; /* 1 / du, 1 / dv, 1 / (dv - du); never infinite */
    double first_m, last_m;         /* the piece of the ray over this level */
} LevelRay;

/* 1 / d, finite even for 0 and -0: a line that is never met is then met at 1e30 m or so, which needs no special
 * case. */
static inline double ground_inverse(double d) { return fabs(d) < 1e-30 ? copysign(1e30, d) : 1 / d; }

/* The same for the way across p0's lines, 0 .. cells. A ray along the last line runs in the last cell. */
static inline double ground_inverse_across(double d, double p0, double cells)
{
    return fabs(d) < 1e-30 ? p0 < cells ? 1e30 : -1e30 : 1 / d;
}

static inline void ground_level_ray(LevelRay *r, const GroundLevel *g, double bend_per_m, const double o_enu[3],
                                    const double d_enu[3])
{
    r->u0 = (o_enu[0] - g->x0_m) * g->cells_per_m;
    r->v0 = (o_enu[1] - g->y0_m) * g->cells_per_m;
    r->w0 = (o_enu[2] - g->z0_m) * g->posts_per_m;
    r->du = d_enu[0] * g->cells_per_m;
    r->dv = d_enu[1] * g->cells_per_m;
    r->dw = d_enu[2] * g->posts_per_m;
    r->bend = bend_per_m * (d_enu[0] * d_enu[0] + d_enu[1] * d_enu[1]) * g->posts_per_m;
    r->per_du = ground_inverse_across(r->du, r->u0, g->cells_x);
    r->per_dv = ground_inverse_across(r->dv, r->v0, g->cells_y);
    r->per_duv = ground_inverse(r->dv - r->du);
}

/* Height of a ray at t, posts. */
static inline double ground_ray_height(const LevelRay *r, double t) { return r->w0 + t * (r->dw - t * r->bend); }

/* A ray over all the levels: its pieces in the order in which it meets them, inwards and out again. */
enum { ground_max_pieces = 2 * elevation_max_levels - 1 };

typedef struct GroundRay {
    int      piece_count, piece; /* 0 for a ray that misses the ground or is invalid; the present one */
    int      level[ground_max_pieces];
    double   first_m[ground_max_pieces], last_m[ground_max_pieces];
    LevelRay of_level[elevation_max_levels];
} GroundRay;

void ground_ray(GroundRay *out, const Ground *ground, const double o_enu[3], const double d_enu[3], double far_m);

/* ground_walk of a bent ray: it comes down to the highest post from above, or stays above it once it has risen so
 * far. */
static inline void ground_walk_bent(double *start_m, double *stop_m, const GroundLevel *g, const LevelRay *r)
{
    const double over = r->w0 - (g->highest + 1e-3), square = r->dw * r->dw + 4 * r->bend * over;
    const double clear = g->highest + ground_clear_posts;
    if (!(square >= 0)) return;
    const double root = sqrt(square);
    if (over > 0) {
        const double down_m = r->dw > 0 ? (r->dw + root) / (2 * r->bend) : 2 * over / (root - r->dw);
        if (ground_ray_height(r, down_m) > clear && down_m > *start_m) *start_m = down_m;
    } else if (r->dw > 0) {
        const double up_m = -2 * over / (root + r->dw);
        if (up_m < *stop_m && ground_ray_height(r, up_m) > clear && ground_ray_height(r, *stop_m) > clear)
            *stop_m = up_m;
    }
}

/* Interval of traversal of a piece: from where the ray has come down to the level's highest post to where it has
 * left it upwards. Never part of a hit's arithmetic. */
static inline void ground_walk(double *start_m, double *stop_m, const GroundLevel *g, const LevelRay *r, double far_m)
{
    *start_m = r->first_m;
    *stop_m = r->last_m < far_m ? r->last_m : far_m;
    if (r->bend > 0) {
        ground_walk_bent(start_m, stop_m, g, r);
        return;
    }
    const double top_m = (g->highest + 1e-3 - r->w0) * ground_inverse(r->dw);
    if (!(r->w0 + top_m * r->dw > g->highest + ground_clear_posts)) return; /* too far away to be exact */
    if (r->dw < 0) *start_m = *start_m > top_m ? *start_m : top_m;
    else *stop_m = *stop_m < top_m ? *stop_m : top_m;
}

/* The level of the pyramid to begin at. A ray that has come down to the highest post nearly always descends from the
 * coarsest nodes; a rising one mostly starts near the ground, where fine nodes must be tested before it is clear.
 * Measured over 6001 x 6001 posts, eight wide: sun rays 1.2 times faster from level 2 than from the top; 6 below the
 * top is worth a tenth on small fields to primary rays. */
static inline int ground_start_level(const GroundLevel *g, const LevelRay *r)
{
    const int k = g->top > 6 + elevation_pyramid_first ? g->top - 6 : elevation_pyramid_first;
    return r->dw > 0 ? elevation_pyramid_first : k;
}

/* The cell at t along one axis: the furthest along the ray whose line of entry is met at or before t. The estimate
 * is off by at most one and is corrected by the lines. */
static inline int ground_cell_at(double p0, double dp, double per_dp, double t, int cells)
{
    const double last = cells - 1;
    double       e = floor(p0 + t * dp);
    e = e > 0 ? e : 0;
    e = e < last ? e : last;
    const double at_low = (e - p0) * per_dp, at_high = (e + 1 - p0) * per_dp;
    if (per_dp > 0) {
        if (at_high <= t) e += 1;
        else if (at_low > t) e -= 1;
    } else {
        if (at_low <= t) e -= 1;
        else if (at_high > t) e += 1;
    }
    e = e > 0 ? e : 0;
    e = e < last ? e : last;
    return (int)e;
}

/* South-west, south-east, north-west and north-east post of a cell. */
static inline void ground_cell_posts(int32_t z[4], const GroundLevel *g, int i, int j)
{
    const unsigned  cell_i = (unsigned)i, cell_j = (unsigned)j; /* not negative */
    const unsigned  tile = cell_j / elevation_tile_cells * (unsigned)g->tiles_x + cell_i / elevation_tile_cells;
    const uint16_t *post = g->stored + (size_t)tile * elevation_tile_posts +
                           cell_j % elevation_tile_cells * elevation_tile_side + cell_i % elevation_tile_cells;
    const uint16_t sw = post[0], se = post[1], nw = post[elevation_tile_side], ne = post[elevation_tile_side + 1];
    if (g->plain) {
        z[0] = sw, z[1] = se, z[2] = nw, z[3] = ne;
        return;
    }
    const ElevationTile of = g->tile[tile];
    z[0] = elevation_of_tile(of, sw), z[1] = elevation_of_tile(of, se);
    z[2] = elevation_of_tile(of, nw), z[3] = elevation_of_tile(of, ne);
}

/* Highest post of node (i, j) of pyramid level k, rounded up; k >= elevation_pyramid_first. */
static inline int32_t ground_highest(const GroundLevel *g, int k, int i, int j)
{
    const uint16_t entry = g->pyramid[k][(size_t)j * (size_t)g->pyramid_nx[k] + (size_t)i];
    return g->pyramid_base + ((int32_t)entry << g->pyramid_shift);
}

/* Highest post of a cell. */
static inline int32_t ground_cell_highest(const GroundLevel *g, int i, int j)
{
    int32_t z[4];
    ground_cell_posts(z, g, i, j);
    const int32_t south = z[0] > z[1] ? z[0] : z[1], north = z[2] > z[3] ? z[2] : z[3];
    return south > north ? south : north;
}

/* The pyramid's level above and below level k, where 0 are the cells. */
static inline int ground_level_above(int k) { return k > 0 ? k + 1 : elevation_pyramid_first; }
static inline int ground_level_below(int k) { return k > elevation_pyramid_first ? k - 1 : 0; }

/* First point in cell (i, j) where the ray is not above the ground; INFINITY for none. Its height above the surface
 * is computed at the entry, the diagonal (again the entry where it is not crossed) and the exit, all four numbers of
 * one vector and without a branch: how a ray passes through a cell cannot be predicted. */
static inline double ground_cell_hit(const GroundLevel *g, const LevelRay *r, int ci, int cj, bool *north_west)
{
    int32_t z[4];
    ground_cell_posts(z, g, ci, cj);
    const double sw = z[0], se = z[1], nw = z[2], ne = z[3];
    const double i = ci, j = cj;
    const double u_low = (i - r->u0) * r->per_du, u_high = (i + 1 - r->u0) * r->per_du;
    const double v_low = (j - r->v0) * r->per_dv, v_high = (j + 1 - r->v0) * r->per_dv;
    const double u_in = u_low < u_high ? u_low : u_high, u_out = u_low < u_high ? u_high : u_low;
    const double v_in = v_low < v_high ? v_low : v_high, v_out = v_low < v_high ? v_high : v_low;
    double       in = u_in > v_in ? u_in : v_in;
    double       out = u_out < v_out ? u_out : v_out;
    in = in > r->first_m ? in : r->first_m;
    out = out < r->last_m ? out : r->last_m;
    double diagonal = ((r->u0 - r->v0) - (i - j)) * r->per_duv;
    diagonal = diagonal > in ? diagonal : in;
    diagonal = diagonal < out ? diagonal : in;

    const double t[4] = {in, diagonal, out, out};
    double       clear[4];
    for (int p = 0; p < 4; p++) {
        double a = r->u0 + t[p] * r->du - i, b = r->v0 + t[p] * r->dv - j;
        a = a > 0 ? a : 0;
        b = b > 0 ? b : 0;
        a = a < 1 ? a : 1;
        b = b < 1 ? b : 1;
        const double south_east = sw + a * (se - sw) + b * (ne - se), north_side = sw + a * (ne - nw) + b * (nw - sw);
        clear[p] = ground_ray_height(r, t[p]) - (a >= b ? south_east : north_side);
    }
    const double lowest = clear[0] < clear[1] ? clear[0] : clear[1];
    if (lowest > 0 && clear[2] > 0) return INFINITY;

    double from = in, to = in, hit = in;
    if (clear[0] > 0) {
        const int p = clear[1] > 0; /* reaches the surface before the diagonal, or after it */
        from = t[p];
        to = t[p + 1];
        hit = from + (to - from) * (clear[p] / (clear[p] - clear[p + 1]));
    }
    const double middle = 0.5 * (from + to); /* well inside the triangle, where the hit itself may be on its edge */
    *north_west = r->u0 + middle * r->du - i < r->v0 + middle * r->dv - j;
    return hit;
}

/* ---- coherent rays ---------------------------------------------------------------------------- */

enum { ground_together = 1024 }; /* rays at most, of the two below */

/* Decides rays that can be decided quickly, from from_m on; left[] receives the indices of the others and from_m the
 * distances from which to continue. start_level: of the pyramid. Returns the number of those left. */
int ground_near_hits(int *left, double *range_m, GroundHit *hit, const Ground *ground, int count,
                     const double *const o_enu[3], const double *const d_enu[3], const double *far_m, double *from_m,
                     int start_level);

/* ground_first_hits for the count rays whose indices are in list (NULL: 0 .. count - 1), of which nothing meets
 * anything before from_m (NULL: 0). */
void ground_first_hits_from(double *range_m, GroundHit *hit, const Ground *ground, int count,
                            const double *const o_enu[3], const double *const d_enu[3], const double *far_m,
                            const double *from_m, const int *list);

/* Ground_cell_at for four rays, for the SIMD ground tracers, in intrinsics: the
 * compiler turns these selections into control flow and does not vectorise them (half the speed). */

/* ground_cell_at, four times. */
static inline F64x4 cell_at(F64x4 p0, F64x4 dp, F64x4 per_dp, F64x4 t, F64x4 last)
{
    const F64x4 zero = f64x4_set(0), one = f64x4_set(1);
    F64x4       e = f64x4_floor(p0 + t * dp);
    e = f64x4_min(f64x4_max(e, zero), last);
    const F64x4 at_low = (e - p0) * per_dp, at_high = (e + one - p0) * per_dp;
    const F64x4 out = f64x4_at_most(f64x4_select(per_dp, at_low, at_high), t),
                early = f64x4_less(t, f64x4_select(per_dp, at_high, at_low));
    const F64x4 sign = f64x4_or(one, f64x4_and(f64x4_set(-0.0), per_dp)); /* of the way along this axis */
    e = e + f64x4_and(out, sign) - f64x4_and(f64x4_and_not(early, out), sign);
    return f64x4_min(f64x4_max(e, zero), last);
}

#endif
