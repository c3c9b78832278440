/* render/trace/ground/ground_near.c: rays that begin close to their hits, or that are parallel: sixteen are traversed
 * together on one level of the pyramid, which saves most of the cost of separate steps; triangles of a cell are
 * tested for four rays at a time. Rays wait for each other for a limited number of steps; a ray that is undecided
 * then is passed on with the distance from which to continue. The cells that are tested for a ray, and the results,
 * are those of ground.c, to the bit. */
#include "render/trace/ground/ground_private.h"

/* Quarters of a group: with fewer, one waits for its posts; with more, all wait for the slowest. The other constants
 * are from trials on hills of 1 m posts: cells in a row before ascending; steps that some wait for others; clear
 * steps before the next coarser level; steps until the remaining rays are passed on. Within a tenth of these values
 * the speed changes little. */
enum { quarters = 4, cells_tried = 4, wait = 3, run_up = 2, patience = 96 };

/* Rays that rise more steeply than this are steeper than most ground: they are tested for that, and ascend sooner.
 * For others the test fails too often: measured with suns 15, 35 and 60 degrees high. */
static const double steep_sine = 0.3;

/* A ray this far above the ground is above it despite rounding: within 1e5 cells and 1e8 posts of the corner its
 * position is accurate to 1e-10 cells and 1e-7 posts, which edges of 65536 posts make 1e-5 posts; steeper ones need
 * more, in proportion. */
static const double sure_posts = 1e-3, sure_steep_posts = 65536, sure_cells = 1e5, sure_height_posts = 1e8;

/* Four rays over one level: LevelRay, and their positions. */
typedef struct Rays4 {
    F64x4   u0, v0, w0, du, dv, dw, bend, per_du, per_dv, per_duv, first_m, last_m, stop_m;
    F64x4   least_dw;                           /* no steeper descent, or flatter rise, over this level */
    F64x4   t_m, i, j, on;                      /* on: mask of the active rays; i, j: cell or node */
    F64x4   gone;                               /* mask: above everything for good, or as far as was requested */
    __m256i u_way, v_way;                       /* shift of their bits in an ElevationRise */
    F64x4   above, sure;                        /* mask: proven to be `sure` posts above the ground at their position */
    F64x4   met, at[3], clear[3], met_i, met_j; /* of those that met the surface: the cell and its three points */
} Rays4;

/* ground_inverse_across, ground_inverse, four times. */
static inline F64x4 inverse_or(F64x4 d, F64x4 otherwise)
{
    const F64x4 size = f64x4_abs(d);
    return f64x4_select(f64x4_less(size, f64x4_set(1e-30)), otherwise, f64x4_set(1) / d);
}

static inline F64x4 inverse_across(F64x4 d, F64x4 p0, double cells)
{
    return inverse_or(d, f64x4_select(f64x4_less(p0, f64x4_set(cells)), f64x4_set(1e30), f64x4_set(-1e30)));
}

/* level_interval. */
static inline void interval(F64x4 *first_m, F64x4 *last_m, F64x4 u0, F64x4 v0, F64x4 per_du, F64x4 per_dv,
                            const GroundLevel *g)
{
    const F64x4 zero = f64x4_set(0);
    const F64x4 u_low = (zero - u0) * per_du, u_high = (f64x4_set(g->cells_x) - u0) * per_du;
    const F64x4 v_low = (zero - v0) * per_dv, v_high = (f64x4_set(g->cells_y) - v0) * per_dv;
    const F64x4 u_in = f64x4_select(per_du, u_high, u_low), u_out = f64x4_select(per_du, u_low, u_high);
    const F64x4 v_in = f64x4_select(per_dv, v_high, v_low), v_out = f64x4_select(per_dv, v_low, v_high);
    *first_m = f64x4_max(f64x4_max(u_in, v_in), zero);
    *last_m = f64x4_min(u_out, v_out);
}

static inline void level_rays(Rays4 *r, const GroundLevel *g, double bend_per_m, const double *const o[3],
                              const double *const d[3], int n)
{
    const F64x4 dx = f64x4_loadu(d[0] + n), dy = f64x4_loadu(d[1] + n);
    r->u0 = (f64x4_loadu(o[0] + n) - f64x4_set(g->x0_m)) * f64x4_set(g->cells_per_m);
    r->v0 = (f64x4_loadu(o[1] + n) - f64x4_set(g->y0_m)) * f64x4_set(g->cells_per_m);
    r->w0 = (f64x4_loadu(o[2] + n) - f64x4_set(g->z0_m)) * f64x4_set(g->posts_per_m);
    r->du = dx * f64x4_set(g->cells_per_m);
    r->dv = dy * f64x4_set(g->cells_per_m);
    r->dw = f64x4_loadu(d[2] + n) * f64x4_set(g->posts_per_m);
    r->bend = f64x4_set(bend_per_m) * (dx * dx + dy * dy) * f64x4_set(g->posts_per_m);
    r->per_du = inverse_across(r->du, r->u0, g->cells_x);
    r->per_dv = inverse_across(r->dv, r->v0, g->cells_y);
    const F64x4 across = r->dv - r->du;
    r->per_duv = inverse_or(across, f64x4_or(f64x4_set(1e30), f64x4_and(f64x4_set(-0.0), across)));
    interval(&r->first_m, &r->last_m, r->u0, r->v0, r->per_du, r->per_dv, g);
    r->least_dw = r->dw - f64x4_set(2) * r->bend * f64x4_max(r->last_m, f64x4_set(0));
}

/* ground_ray_height, four times. */
static inline F64x4 height_at(const Rays4 *r, F64x4 t) { return r->w0 + t * (r->dw - t * r->bend); }

/* ground_ray's conditions. */
static inline F64x4 usable(const double *const o[3], const double *const d[3], const double *far_m, int n)
{
    F64x4 good = f64x4_less(f64x4_set(0), f64x4_loadu(far_m + n)), square[3];
    for (int c = 0; c < 3; c++) {
        const F64x4 p = f64x4_loadu(o[c] + n), q = f64x4_loadu(d[c] + n);
        good = f64x4_and(good, f64x4_at_most(f64x4_abs(p), f64x4_set(1e9)));
        good = f64x4_and(good, f64x4_at_most(f64x4_abs(q), f64x4_set(2)));
        square[c] = q * q;
    }
    return f64x4_and(good, f64x4_less(f64x4_set(0.25), square[0] + square[1] + square[2]));
}

/* Stored posts to posts, each of its lane's tile. */
static inline __m128i posts_of(const GroundLevel *g, __m128i tile, __m128i stored)
{
    if (g->plain) return stored;
    int32_t       index[4];
    ElevationTile of[4];
    _mm_storeu_si128((__m128i *)index, tile);
    for (int l = 0; l < 4; l++) of[l] = g->tile[index[l]];
    const __m128i base = _mm_set_epi32(of[3].base, of[2].base, of[1].base, of[0].base);
    const __m128i shift = _mm_set_epi32(of[3].shift, of[2].shift, of[1].shift, of[0].shift);
    return _mm_add_epi32(base, _mm_sllv_epi32(stored, shift));
}

/* Index of (i, j) in rows of nx. */
static inline __m128i element(F64x4 i, F64x4 j, int nx)
{
    return _mm_add_epi32(_mm_mullo_epi32(_mm256_cvttpd_epi32(j), _mm_set1_epi32(nx)), _mm256_cvttpd_epi32(i));
}

/* Tiles of four cells, and the indices of their south-west posts in g->stored. */
static inline __m128i stored_at(__m128i *tile, const GroundLevel *g, F64x4 i, F64x4 j)
{
    enum { bits = 6 };
    _Static_assert(elevation_tile_cells == 1 << bits && elevation_tile_side == (1 << bits) + 1 &&
                       elevation_tile_posts == (1 << 2 * bits) + (2 << bits) + 1,
                   "products below are shifts");
    const __m128i a = _mm256_cvttpd_epi32(i), b = _mm256_cvttpd_epi32(j), inside = _mm_set1_epi32((1 << bits) - 1);
    const __m128i t =
        _mm_add_epi32(_mm_mullo_epi32(_mm_srli_epi32(b, bits), _mm_set1_epi32(g->tiles_x)), _mm_srli_epi32(a, bits));
    const __m128i row = _mm_and_si128(b, inside), column = _mm_and_si128(a, inside);
    const __m128i first = _mm_add_epi32(_mm_add_epi32(_mm_slli_epi32(t, 2 * bits), _mm_slli_epi32(t, bits + 1)), t);
    *tile = t;
    return _mm_add_epi32(first, _mm_add_epi32(_mm_add_epi32(_mm_slli_epi32(row, bits), row), column));
}

/* Deactivates those that have left the level, or everything. */
static inline void leave(Rays4 *r)
{
    r->gone = f64x4_or(r->gone, f64x4_and(r->on, f64x4_at_most(r->stop_m, r->t_m)));
    r->on = f64x4_and_not(f64x4_and(r->on, f64x4_less(r->t_m, r->last_m)), r->gone);
    r->i = f64x4_and(r->on, r->i); /* an inactive ray is in the first cell, where posts can be loaded */
    r->j = f64x4_and(r->on, r->j);
}

/* Two posts each, from four positions. Scalar loads are faster than the gather instruction. */
static inline __m128i pairs(const uint16_t *post, __m128i at)
{
    int32_t  index[4];
    uint32_t pair[4];
    _mm_storeu_si128((__m128i *)index, at);
    for (int l = 0; l < 4; l++) memcpy(&pair[l], post + index[l], sizeof pair[l]);
    return _mm_set_epi32((int)pair[3], (int)pair[2], (int)pair[1], (int)pair[0]);
}

/* ground_cell_hit for four, up to which of the three points is below the surface; then steps to the next cell. */
static inline void cell(Rays4 *r, const GroundLevel *g)
{
    const F64x4 zero = f64x4_set(0), one = f64x4_set(1), i = r->i, j = r->j;
    /* entry and exit points, and the posts: two of a row at once */
    const F64x4   u_low = (i - r->u0) * r->per_du, u_high = (i + one - r->u0) * r->per_du;
    const F64x4   v_low = (j - r->v0) * r->per_dv, v_high = (j + one - r->v0) * r->per_dv;
    __m128i       tile;
    const __m128i at = stored_at(&tile, g, i, j), low = _mm_set1_epi32(0xffff);
    const __m128i south = pairs(g->stored, at), north = pairs(g->stored + elevation_tile_side, at);
    const F64x4   sw = f64x4_of_ints(posts_of(g, tile, _mm_and_si128(south, low)));
    const F64x4   se = f64x4_of_ints(posts_of(g, tile, _mm_srli_epi32(south, 16)));
    const F64x4   nw = f64x4_of_ints(posts_of(g, tile, _mm_and_si128(north, low)));
    const F64x4   ne = f64x4_of_ints(posts_of(g, tile, _mm_srli_epi32(north, 16)));
    const F64x4   u_out = f64x4_select(r->per_du, u_low, u_high), v_out = f64x4_select(r->per_dv, v_low, v_high);
    F64x4         t[3];
    t[0] = f64x4_max(f64x4_max(f64x4_min(u_low, u_high), f64x4_min(v_low, v_high)), r->first_m);
    t[2] = f64x4_min(f64x4_min(u_out, v_out), r->last_m);
    /* a ray whose lower end is above the highest of the four posts is above the rest */
    const F64x4 highest = f64x4_max(f64x4_max(sw, se), f64x4_max(nw, ne));
    const F64x4 clearance = f64x4_min(height_at(r, t[0]), height_at(r, t[2])) - highest;
    const F64x4 unclear = f64x4_and_not(r->on, f64x4_less(f64x4_set(ground_clear_posts), clearance));
    F64x4       meets = f64x4_set(0), at_end = clearance; /* posts above the ground at the exit, or fewer */
    if (f64x4_bits(unclear)) {
        t[1] = ((r->u0 - r->v0) - (i - j)) * r->per_duv;
        t[1] = f64x4_max(t[1], t[0]);
        t[1] = f64x4_select(f64x4_less(t[1], t[2]), t[1], t[0]);
        F64x4       clear[3];
        const F64x4 east_s = se - sw, north_s = ne - se, east_n = ne - nw, north_n = nw - sw;
        for (int p = 0; p < 3; p++) {
            const F64x4 a = f64x4_min(f64x4_max(r->u0 + t[p] * r->du - i, zero), one);
            const F64x4 b = f64x4_min(f64x4_max(r->v0 + t[p] * r->dv - j, zero), one);
            const F64x4 south_side = f64x4_at_most(b, a);
            const F64x4 z =
                sw + a * f64x4_select(south_side, east_s, east_n) + b * f64x4_select(south_side, north_s, north_n);
            clear[p] = height_at(r, t[p]) - z;
        }
        const F64x4 above = f64x4_and(f64x4_less(zero, f64x4_min(clear[0], clear[1])), f64x4_less(zero, clear[2]));
        meets = f64x4_and_not(r->on, above);
        at_end = clear[2];
        for (int p = 0; p < 3; p++) {
            r->at[p] = f64x4_select(meets, t[p], r->at[p]);
            r->clear[p] = f64x4_select(meets, clear[p], r->clear[p]);
        }
        r->met = f64x4_or(r->met, meets);
        r->met_i = f64x4_select(meets, i, r->met_i);
        r->met_j = f64x4_select(meets, j, r->met_j);
    }

    /* step */
    const F64x4 sign = f64x4_set(-0.0), next = t[2];
    r->on = f64x4_and_not(r->on, meets);
    r->above = f64x4_select(r->on, f64x4_less(r->sure, at_end), r->above);
    r->t_m = f64x4_select(r->on, next, r->t_m);
    r->i = i + f64x4_and(f64x4_and(r->on, f64x4_at_most(u_out, next)), f64x4_or(one, f64x4_and(sign, r->per_du)));
    r->j = j + f64x4_and(f64x4_and(r->on, f64x4_at_most(v_out, next)), f64x4_or(one, f64x4_and(sign, r->per_dv)));
    leave(r);
}

/* Enters the cell or node of level k that contains the ray's place. */
static inline void enter(Rays4 *r, const GroundLevel *g, int k)
{
    const F64x4 per_size = f64x4_set(1.0 / (1 << k)), t = f64x4_select(r->on, r->t_m, f64x4_set(0));
    r->i = f64x4_and(r->on, f64x4_floor(cell_at(r->u0, r->du, r->per_du, t, f64x4_set(g->cells_x - 1)) * per_size));
    r->j = f64x4_and(r->on, f64x4_floor(cell_at(r->v0, r->dv, r->per_dv, t, f64x4_set(g->cells_y - 1)) * per_size));
}

/* Moves the ray from its cell to the node that lies so many levels above. */
static inline void ascend(Rays4 *r, int levels)
{
    const F64x4 per_size = f64x4_set(1.0 / (1 << levels));
    r->i = f64x4_floor(r->i * per_size);
    r->j = f64x4_floor(r->j * per_size);
}

/* Steps those that are clear of their node to the next; returns the mask of the others. A ray is clear if it is
 * above the node's highest post, or (tested for steep rays only) if it was above the ground and rises faster than
 * any edge here: the ground consists of triangles, each of which rises along the ray by its edges' share. */
static inline F64x4 node(Rays4 *r, const GroundLevel *g, int k, bool steep)
{
    const F64x4 one = f64x4_set(1), sign = f64x4_set(-0.0), size = f64x4_set(1 << k);
    const F64x4 east = f64x4_select(r->per_du, f64x4_set(0), one), north = f64x4_select(r->per_dv, f64x4_set(0), one);
    int32_t     index[4];
    _mm_storeu_si128((__m128i *)index, element(r->i, r->j, g->pyramid_nx[k]));
    const uint16_t *z = g->pyramid[k];
    const __m128i   entry = _mm_set_epi32(z[index[3]], z[index[2]], z[index[1]], z[index[0]]);
    const F64x4     highest = f64x4_of_ints(
            _mm_add_epi32(_mm_set1_epi32(g->pyramid_base), _mm_sll_epi32(entry, _mm_cvtsi32_si128(g->pyramid_shift))));
    const F64x4 at_u = ((r->i + east) * size - r->u0) * r->per_du, at_v = ((r->j + north) * size - r->v0) * r->per_dv;
    const F64x4 next = f64x4_min(f64x4_min(at_u, at_v), r->last_m);
    const F64x4 lowest = f64x4_min(height_at(r, r->t_m), height_at(r, next));
    F64x4       clear = f64x4_less(highest + f64x4_set(ground_clear_posts), lowest);
    const F64x4 sure = f64x4_less(highest + r->sure, lowest);
    F64x4       outrun = f64x4_set(0);
    if (steep && g->rise[k]) {
        uint64_t rise[4];
        for (int l = 0; l < 4; l++) memcpy(&rise[l], &g->rise[k][index[l]], sizeof rise[l]);
        const __m256i all = _mm256_loadu_si256((const __m256i *)rise), low = _mm256_set1_epi64x(0xffff);
        const __m256i by_u = _mm256_and_si256(_mm256_srlv_epi64(all, r->u_way), low);
        const __m256i by_v = _mm256_and_si256(_mm256_srlv_epi64(all, r->v_way), low);
        /* integers below 2^52 become doubles by their exponent */
        const F64x4 magic = f64x4_set(0x1p52);
        const F64x4 rise_u = _mm256_castsi256_pd(_mm256_or_si256(by_u, _mm256_castpd_si256(magic))) - magic;
        const F64x4 rise_v = _mm256_castsi256_pd(_mm256_or_si256(by_v, _mm256_castpd_si256(magic))) - magic;
        const F64x4 ground = (rise_u * f64x4_abs(r->du) + rise_v * f64x4_abs(r->dv)) * f64x4_set(g->rise_unit);
        outrun = f64x4_and(r->above, f64x4_less(ground + f64x4_set(1e-9), r->least_dw));
        clear = f64x4_or(clear, outrun);
    }
    clear = f64x4_and(clear, r->on);
    r->above = f64x4_select(clear, f64x4_or(sure, outrun), r->above);
    const F64x4 blocked = f64x4_and_not(r->on, clear);
    r->t_m = f64x4_select(clear, next, r->t_m);
    r->i = r->i + f64x4_and(f64x4_and(clear, f64x4_at_most(at_u, next)), f64x4_or(one, f64x4_and(sign, r->per_du)));
    r->j = r->j + f64x4_and(f64x4_and(clear, f64x4_at_most(at_v, next)), f64x4_or(one, f64x4_and(sign, r->per_dv)));
    leave(r);
    return f64x4_and(blocked, r->on);
}

static inline bool any(const Rays4 r[quarters])
{
    F64x4 on = r[0].on;
    for (int h = 1; h < quarters; h++) on = f64x4_or(on, r[h].on);
    return f64x4_bits(on) != 0;
}

/* Innermost level that contains the position, or the outermost; -1: it is not well inside the levels around it, so
 * that a ray above one need not be above them. */
static int level_of(const Ground *ground, double x_m, double y_m)
{
    int n = 0;
    for (; n + 1 < ground->level_count; n++) {
        const GroundLevel *g = &ground->level[n];
        const double       u = (x_m - g->x0_m) * g->cells_per_m, v = (y_m - g->y0_m) * g->cells_per_m;
        if (u >= 0 && v >= 0 && u <= g->cells_x && v <= g->cells_y) break;
    }
    const GroundLevel *in = &ground->level[n];
    const double       east_m = in->x0_m + in->cells_x / in->cells_per_m;
    const double       north_m = in->y0_m + in->cells_y / in->cells_per_m;
    for (int k = n + 1; k < ground->level_count; k++) {
        const GroundLevel *g = &ground->level[k];
        const double       margin = 1e-3;
        if (!((in->x0_m - g->x0_m) * g->cells_per_m > margin && (in->y0_m - g->y0_m) * g->cells_per_m > margin &&
              (east_m - g->x0_m) * g->cells_per_m < g->cells_x - margin &&
              (north_m - g->y0_m) * g->cells_per_m < g->cells_y - margin))
            return -1;
    }
    return n;
}

/* Height, in posts of this level, that no level exceeds. */
static double above_all(const Ground *ground, const GroundLevel *g)
{
    double above = 0;
    for (int k = 0; k < ground->level_count; k++) {
        const GroundLevel *other = &ground->level[k];
        above = fmax(above, (other->z0_m + other->highest / other->posts_per_m - g->z0_m) * g->posts_per_m);
    }
    return above + 1e-2;
}

/* From where on bent rays that rise are above everything, if they still are at the farthest edge of the ground;
 * INFINITY: they are not, or not for good. */
static inline F64x4 above_from(const Rays4 *r, const Ground *ground, const double *const o[3], const double *const d[3],
                               double above, int n)
{
    const GroundLevel *all = &ground->level[ground->level_count - 1];
    const double       low[2] = {all->x0_m, all->y0_m}, cells[2] = {all->cells_x, all->cells_y};
    F64x4              square = f64x4_set(0), way = f64x4_set(0);
    for (int c = 0; c < 2; c++) {
        const F64x4 p = f64x4_loadu(o[c] + n), q = f64x4_loadu(d[c] + n);
        const F64x4 side =
            f64x4_max(f64x4_abs(p - f64x4_set(low[c])), f64x4_abs(p - f64x4_set(low[c] + cells[c] / all->cells_per_m)));
        square = square + side * side, way = way + q * q;
    }
    const F64x4 edge_m = f64x4_sqrt(square / way), over = f64x4_set(above) - r->w0;
    const F64x4 root = f64x4_sqrt(r->dw * r->dw - f64x4_set(4) * r->bend * over);
    const F64x4 up_m = f64x4_set(2) * over / (r->dw + root);
    const F64x4 stays = f64x4_and(f64x4_less(f64x4_set(above), height_at(r, edge_m)), f64x4_less(up_m, edge_m));
    return f64x4_select(stays, up_m, f64x4_set(INFINITY));
}

/* 16 where the mask says so, else 0. */
static inline __m256i bits_16(F64x4 mask)
{
    return _mm256_and_si256(_mm256_castpd_si256(mask), _mm256_set1_epi64x(16));
}

/* Initialises four rays at their start. Those that do not begin on this level are inactive. */
static inline void begin(Rays4 *r, const Ground *ground, int level, const double *const o[3], const double *const d[3],
                         const double *far_m, const double *from_m, double above, int n)
{
    const GroundLevel *g = &ground->level[level];
    level_rays(r, g, ground->bend_per_m, o, d, n);
    F64x4 good = f64x4_and(usable(o, d, far_m, n),
                           f64x4_and(f64x4_less(r->first_m, r->last_m), f64x4_less(r->first_m, f64x4_set(farthest_m))));
    if (level + 1 < ground->level_count) good = f64x4_and(good, f64x4_at_most(r->first_m, f64x4_set(0)));
    if (level > 0) { /* as far as the level inside */
        Rays4 inner;
        level_rays(&inner, g - 1, 0, o, d, n);
        r->last_m =
            f64x4_select(f64x4_less(inner.first_m, inner.last_m), f64x4_min(inner.first_m, r->last_m), r->last_m);
    }
    r->gone = r->above = f64x4_set(0);
    const F64x4  size = f64x4_max(f64x4_abs(r->u0), f64x4_abs(r->v0));
    const F64x4  tame = f64x4_and(f64x4_at_most(size, f64x4_set(sure_cells)),
                                  f64x4_at_most(f64x4_abs(r->w0), f64x4_set(sure_height_posts)));
    const double sure = sure_posts * fmax(g->steepest / sure_steep_posts, 1);
    r->sure = f64x4_select(tame, f64x4_set(sure), f64x4_set(INFINITY));
    r->u_way = bits_16(f64x4_less(r->du, f64x4_set(0)));
    r->v_way = _mm256_add_epi64(_mm256_set1_epi64x(32), bits_16(f64x4_less(r->dv, f64x4_set(0))));
    /* rising, it is above everything from `above` on, if that is near enough to be exact; far_m limits the search */
    const F64x4 rises =
        f64x4_and(f64x4_less(f64x4_set(1e-12), r->dw), f64x4_at_most(f64x4_abs(r->w0), f64x4_set(sure_height_posts)));
    F64x4 up_m = (f64x4_set(above) - r->w0) / r->dw;
    if (ground->bend_per_m > 0) up_m = above_from(r, ground, o, d, above, n);
    r->stop_m = f64x4_min(f64x4_select(rises, up_m, f64x4_set(INFINITY)), f64x4_loadu(far_m + n));
    const F64x4 from = f64x4_loadu(from_m + n);
    r->t_m = f64x4_select(good, f64x4_max(r->first_m, from), from);
    r->on = f64x4_and(good, f64x4_less(r->t_m, r->last_m));
    r->met = r->met_i = r->met_j = f64x4_set(0);
    for (int p = 0; p < 3; p++) r->at[p] = r->clear[p] = f64x4_set(0);
}

/* The final part of ground_cell_hit. */
static inline void end(double *range_m, GroundHit *hit, const Rays4 *r, int level, const double *far_m, int n)
{
    const F64x4 zero = f64x4_set(0);
    const F64x4 comes_down = f64x4_less(zero, r->clear[0]), late = f64x4_less(zero, r->clear[1]);
    const F64x4 from = f64x4_select(f64x4_and(comes_down, late), r->at[1], r->at[0]);
    const F64x4 to = f64x4_select(comes_down, f64x4_select(late, r->at[2], r->at[1]), r->at[0]);
    const F64x4 c_from = f64x4_select(late, r->clear[1], r->clear[0]),
                c_to = f64x4_select(late, r->clear[2], r->clear[1]);
    const F64x4 range = f64x4_select(comes_down, from + (to - from) * (c_from / (c_from - c_to)), r->at[0]);
    const F64x4 middle = f64x4_set(0.5) * (from + to);
    const F64x4 north_west = f64x4_less(r->u0 + middle * r->du - r->met_i, r->v0 + middle * r->dv - r->met_j);
    const F64x4 near = f64x4_less(range, f64x4_loadu(far_m + n));
    const F64x4 seen = f64x4_and(r->met, near);
    double      out[4];
    int32_t     i[4], j[4];
    f64x4_storeu(out, f64x4_select(seen, range, f64x4_set(INFINITY)));
    _mm_storeu_si128((__m128i *)i, _mm256_cvttpd_epi32(r->met_i));
    _mm_storeu_si128((__m128i *)j, _mm256_cvttpd_epi32(r->met_j));
    const unsigned met = f64x4_bits(r->met), west = f64x4_bits(north_west);
    for (int l = 0; l < 4; l++) {
        if (!(met >> l & 1)) continue;
        range_m[n + l] = out[l];
        if (hit && out[l] < INFINITY)
            hit[n + l] = (GroundHit){.level = level, .i = i[l], .j = j[l], .north_west = west >> l & 1};
    }
}

/* The group's traversal: all on one level of the pyramid. */
static inline void walk(Rays4 r[quarters], const GroundLevel *g, int k, bool steep)
{
    int tried = 0, waited = 0, run = 0;
    for (int h = 0; h < quarters; h++) {
        leave(&r[h]);
        enter(&r[h], g, k);
    }
    for (int step = 0; step < patience && any(r); step++) {
        const int before = k;
        if (k == 0) {
            for (int h = 0; h < quarters; h++)
                if (f64x4_bits(r[h].on)) cell(&r[h], g);
            if (++tried < (steep ? 1 : cells_tried)) continue;
            k = steep && g->top >= elevation_rise_level ? elevation_rise_level : elevation_pyramid_first;
        } else {
            unsigned blocked = 0;
            for (int h = 0; h < quarters; h++)
                if (f64x4_bits(r[h].on)) blocked |= f64x4_bits(node(&r[h], g, k, steep)) << 4 * h;
            unsigned on = 0;
            for (int h = 0; h < quarters; h++) on |= f64x4_bits(r[h].on) << 4 * h;
            if (blocked == 0) {
                if (++run < (steep ? 1 : run_up) || k == g->top) continue;
                k = k + 1 + steep < g->top ? k + 1 + steep : g->top;
            } else {
                run = 0;
                if (blocked != on && ++waited < wait) continue;
                k = ground_level_below(k);
            }
        }
        tried = waited = run = 0;
        for (int h = 0; h < quarters; h++) {
            if (!f64x4_bits(r[h].on)) continue;
            if (k > before) ascend(&r[h], k - before);
            else enter(&r[h], g, k);
        }
    }
}

/* Whether all of a group are proven to be above the ground up to their limits: then they meet nothing. */
static inline bool none_asked(double *range_m, const double *far_m, const double *from_m)
{
    F64x4 none = f64x4_set(0);
    none = f64x4_at_most(none, none);
    for (int l = 0; l < 4 * quarters; l += 4)
        none = f64x4_and(none, f64x4_at_most(f64x4_loadu(far_m + l), f64x4_loadu(from_m + l)));
    if (f64x4_bits(none) != 0xf) return false;
    for (int l = 0; l < 4 * quarters; l++) range_m[l] = INFINITY;
    return true;
}

int ground_near_hits(int *left, double *range_m, GroundHit *hit, const Ground *ground, int count,
                     const double *const o[3], const double *const d[3], const double *far_m, double *from_m,
                     int start_level)
{
    enum { group = 4 * quarters };
    const int level = level_of(ground, o[0][0], o[1][0]);
    int       left_count = 0;
    if (level < 0 || count < group) {
        for (int n = 0; n < count; n++) left[n] = n;
        return count;
    }
    const GroundLevel *g = &ground->level[level];
    const double       above = above_all(ground, g);
    if (start_level > g->top) start_level = g->top;
    for (int done = 0; done < count; done += group) {
        const int n = done + group <= count ? done : count - group; /* the last group repeats some */
        Rays4     r[quarters];
        if (none_asked(range_m + n, far_m + n, from_m + n)) continue;
        for (int h = 0; h < quarters; h++) begin(&r[h], ground, level, o, d, far_m, from_m, above, n + 4 * h);
        walk(r, g, start_level, d[2][n] > steep_sine);
        for (int h = 0; h < quarters; h++) {
            const int m = n + 4 * h;
            double    t_m[4];
            end(range_m, hit, &r[h], level, far_m, m);
            f64x4_storeu(t_m, r[h].t_m);
            const unsigned met = f64x4_bits(r[h].met), gone = f64x4_bits(r[h].gone);
            for (int l = 0; l < 4; l++) {
                if (met >> l & 1 || m + l < done) continue;
                if (gone >> l & 1 || !(from_m[m + l] < INFINITY)) {
                    range_m[m + l] = INFINITY;
                    continue;
                }
                from_m[m + l] = t_m[l];
                left[left_count++] = m + l;
            }
        }
    }
    return left_count;
}
