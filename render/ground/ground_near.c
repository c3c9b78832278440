/* Rays that begin close to what they meet, or that all go one way: sixteen walk side by side, all on one level of the
 * pyramid, which spares them most of what a step costs where each is on its own; the triangles of a cell are four
 * rays' at a time. They wait for each other a little; who is not decided then is handed on with the place to go on
 * from. Which cells a ray is asked about, and what it finds there, is as in ground.c, to the bit. */
#include "render/ground/ground_lanes.h"

/* Quarters of a group: fewer, and one waits for its posts; more, and all wait for the slowest. The rest are from trials
 * on hills of 1 m posts: cells in a row before looking wider; steps that some wait for others; clear steps before the
 * next coarser level; steps until those still going are handed on. Within a tenth of these nothing changes much. */
enum { quarters = 4, cells_tried = 4, wait = 3, run_up = 2, patience = 96 };

/* Rays that rise more steeply than this outrun most ground: they are asked about that, and look wider sooner. For
 * others it is more often in vain: tried with suns 15, 35 and 60 degrees high. */
static const double steep_sine = 0.3;

/* A ray this far over the ground is over it, whatever rounding did: within 1e5 cells and 1e7 posts of the corner its
 * place is good to 1e-10 cells and 1e-8 posts, which the steepest ground makes 1e-5 posts. */
static const double sure_posts = 1e-3, sure_cells = 1e5, sure_height_posts = 1e7;

/* Four rays over one level: LevelRay, and where they are. */
typedef struct Rays4 {
    Four u0, v0, w0, du, dv, dw, per_du, per_dv, per_duv, first_m, last_m, stop_m;
    Four t_m, i, j, on;             /* on: mask of those still going; i, j: cell or node */
    Four gone;                      /* mask: above everything for good, or as far as was asked */
    __m256i u_way, v_way;           /* bits before the rise that is theirs, in an ElevationRise */
    Four above, sure;               /* mask: known to be `sure` posts over the ground where they are */
    Four met, at[3], clear[3], met_i, met_j; /* of those that met the surface: the cell and its three places */
} Rays4;

/* ground_inverse_across, ground_inverse, four times. */
static inline Four inverse_or(Four d, Four otherwise)
{
    const Four size = unless(set(-0.0), d);
    return pick(less(size, set(1e-30)), otherwise, set(1) / d);
}

static inline Four inverse_across(Four d, Four p0, double cells)
{
    return inverse_or(d, pick(less(p0, set(cells)), set(1e30), set(-1e30)));
}

/* level_interval. */
static inline void interval(Four *first_m, Four *last_m, Four u0, Four v0, Four per_du, Four per_dv,
                            const GroundLevel *g)
{
    const Four zero = set(0);
    const Four u_low = (zero - u0) * per_du, u_high = (set(g->cells_x) - u0) * per_du;
    const Four v_low = (zero - v0) * per_dv, v_high = (set(g->cells_y) - v0) * per_dv;
    const Four u_in = pick(per_du, u_high, u_low), u_out = pick(per_du, u_low, u_high);
    const Four v_in = pick(per_dv, v_high, v_low), v_out = pick(per_dv, v_low, v_high);
    *first_m = larger(larger(u_in, v_in), zero);
    *last_m  = smaller(u_out, v_out);
}

static inline void level_rays(Rays4 *r, const GroundLevel *g, const double *const o[3], const double *const d[3], int n)
{
    r->u0 = (_mm256_loadu_pd(o[0] + n) - set(g->x0_m)) * set(g->cells_per_m);
    r->v0 = (_mm256_loadu_pd(o[1] + n) - set(g->y0_m)) * set(g->cells_per_m);
    r->w0 = (_mm256_loadu_pd(o[2] + n) - set(g->z0_m)) * set(g->posts_per_m);
    r->du = _mm256_loadu_pd(d[0] + n) * set(g->cells_per_m);
    r->dv = _mm256_loadu_pd(d[1] + n) * set(g->cells_per_m);
    r->dw = _mm256_loadu_pd(d[2] + n) * set(g->posts_per_m);
    r->per_du = inverse_across(r->du, r->u0, g->cells_x);
    r->per_dv = inverse_across(r->dv, r->v0, g->cells_y);
    const Four across = r->dv - r->du;
    r->per_duv = inverse_or(across, either(set(1e30), both(set(-0.0), across)));
    interval(&r->first_m, &r->last_m, r->u0, r->v0, r->per_du, r->per_dv, g);
}

/* ground_ray's conditions. */
static inline Four usable(const double *const o[3], const double *const d[3], const double *far_m, int n)
{
    Four good = less(set(0), _mm256_loadu_pd(far_m + n)), square[3];
    for (int c = 0; c < 3; c++) {
        const Four p = _mm256_loadu_pd(o[c] + n), q = _mm256_loadu_pd(d[c] + n);
        good = both(good, at_most(unless(set(-0.0), p), set(1e9)));
        good = both(good, at_most(unless(set(-0.0), q), set(2)));
        square[c] = q * q;
    }
    return both(good, less(set(0.25), square[0] + square[1] + square[2]));
}

/* Where (i, j) is among rows of nx. */
static inline __m128i element(Four i, Four j, int nx)
{
    return _mm_add_epi32(_mm_mullo_epi32(_mm256_cvttpd_epi32(j), _mm_set1_epi32(nx)), _mm256_cvttpd_epi32(i));
}

/* Off are those that have left the level, or everything. */
static inline void leave(Rays4 *r)
{
    r->gone = either(r->gone, both(r->on, at_most(r->stop_m, r->t_m)));
    r->on   = unless(r->gone, both(r->on, less(r->t_m, r->last_m)));
    r->i    = both(r->on, r->i); /* who is off stands in the first cell, where there are posts to look up */
    r->j    = both(r->on, r->j);
}

/* Two posts each, from four places. One at a time is faster than the instruction that gathers. */
static inline __m128i pairs(const uint16_t *post, __m128i at)
{
    int32_t  index[4];
    uint32_t pair[4];
    _mm_storeu_si128((__m128i *)index, at);
    for (int l = 0; l < 4; l++) memcpy(&pair[l], post + index[l], sizeof pair[l]);
    return _mm_set_epi32((int)pair[3], (int)pair[2], (int)pair[1], (int)pair[0]);
}

/* ground_cell_hit for four, up to which of the three places is under the surface; and on to the next cell. */
static inline void cell(Rays4 *r, const GroundLevel *g)
{
    const Four zero = set(0), one = set(1), i = r->i, j = r->j;
    /* the ways in and out, and the posts: two of a row at once */
    const Four    u_low = (i - r->u0) * r->per_du, u_high = (i + one - r->u0) * r->per_du;
    const Four    v_low = (j - r->v0) * r->per_dv, v_high = (j + one - r->v0) * r->per_dv;
    const __m128i at = element(i, j, g->nx);
    const __m128i south = pairs(g->post, at), north = pairs(g->post + g->nx, at);
    const Four    sw = _mm256_cvtepi32_pd(_mm_and_si128(south, _mm_set1_epi32(0xffff)));
    const Four    se = _mm256_cvtepi32_pd(_mm_srli_epi32(south, 16));
    const Four    nw = _mm256_cvtepi32_pd(_mm_and_si128(north, _mm_set1_epi32(0xffff)));
    const Four    ne = _mm256_cvtepi32_pd(_mm_srli_epi32(north, 16));
    const Four    u_out = pick(r->per_du, u_low, u_high), v_out = pick(r->per_dv, v_low, v_high);
    Four          t[3];
    t[0] = larger(larger(smaller(u_low, u_high), smaller(v_low, v_high)), r->first_m);
    t[2] = smaller(smaller(u_out, v_out), r->last_m);
    /* a ray whose lower end is above the highest of the four posts is above the rest */
    const Four highest = larger(larger(sw, se), larger(nw, ne));
    const Four low_end = pick(r->dw, larger(t[0], t[2]), smaller(t[0], t[2]));
    const Four clearance = r->w0 + low_end * r->dw - highest;
    const Four unclear = unless(less(set(ground_clear_posts), clearance), r->on);
    Four       meets = set(0), at_end = clearance; /* posts over the ground at the way out, or fewer */
    if (bits(unclear)) {
        t[1] = ((r->u0 - r->v0) - (i - j)) * r->per_duv;
        t[1] = larger(t[1], t[0]);
        t[1] = pick(less(t[1], t[2]), t[1], t[0]);
        Four       clear[3];
        const Four east_s = se - sw, north_s = ne - se, east_n = ne - nw, north_n = nw - sw;
        for (int p = 0; p < 3; p++) {
            const Four a = smaller(larger(r->u0 + t[p] * r->du - i, zero), one);
            const Four b = smaller(larger(r->v0 + t[p] * r->dv - j, zero), one);
            const Four south_side = at_most(b, a);
            const Four z = sw + a * pick(south_side, east_s, east_n) + b * pick(south_side, north_s, north_n);
            clear[p] = r->w0 + t[p] * r->dw - z;
        }
        const Four above = both(less(zero, smaller(clear[0], clear[1])), less(zero, clear[2]));
        meets  = unless(above, r->on);
        at_end = clear[2];
        for (int p = 0; p < 3; p++) {
            r->at[p]    = pick(meets, t[p], r->at[p]);
            r->clear[p] = pick(meets, clear[p], r->clear[p]);
        }
        r->met   = either(r->met, meets);
        r->met_i = pick(meets, i, r->met_i);
        r->met_j = pick(meets, j, r->met_j);
    }

    /* on */
    const Four sign = set(-0.0), next = t[2];
    r->on    = unless(meets, r->on);
    r->above = pick(r->on, less(r->sure, at_end), r->above);
    r->t_m = pick(r->on, next, r->t_m);
    r->i   = i + both(both(r->on, at_most(u_out, next)), either(one, both(sign, r->per_du)));
    r->j   = j + both(both(r->on, at_most(v_out, next)), either(one, both(sign, r->per_dv)));
    leave(r);
}

/* From the place to the cell or node of level k there. */
static inline void enter(Rays4 *r, const GroundLevel *g, int k)
{
    const Four per_size = set(1.0 / (1 << k)), t = pick(r->on, r->t_m, set(0));
    r->i = both(r->on, _mm256_floor_pd(cell_at(r->u0, r->du, r->per_du, t, set(g->cells_x - 1)) * per_size));
    r->j = both(r->on, _mm256_floor_pd(cell_at(r->v0, r->dv, r->per_dv, t, set(g->cells_y - 1)) * per_size));
}

/* From where it is to the node above it by so many levels. */
static inline void ascend(Rays4 *r, int levels)
{
    const Four per_size = set(1.0 / (1 << levels));
    r->i = _mm256_floor_pd(r->i * per_size);
    r->j = _mm256_floor_pd(r->j * per_size);
}

/* Those that are clear of their node go on to the next; mask of the others. Clear is who is above its highest post, and
 * (asked of the steep only) who was over the ground and rises faster than any edge here: the ground is of triangles,
 * each of which rises along the ray by its edges' share. */
static inline Four node(Rays4 *r, const GroundLevel *g, int k, bool steep)
{
    const Four one = set(1), sign = set(-0.0), size = set(1 << k);
    const Four east = pick(r->per_du, set(0), one), north = pick(r->per_dv, set(0), one);
    int32_t    index[4];
    _mm_storeu_si128((__m128i *)index, element(r->i, r->j, g->pyramid_nx[k]));
    const uint16_t *z = g->pyramid[k];
    const Four highest = _mm256_cvtepi32_pd(_mm_set_epi32(z[index[3]], z[index[2]], z[index[1]], z[index[0]]));
    const Four at_u = ((r->i + east) * size - r->u0) * r->per_du, at_v = ((r->j + north) * size - r->v0) * r->per_dv;
    const Four next = smaller(smaller(at_u, at_v), r->last_m);
    const Four lowest = r->w0 + pick(r->dw, next, r->t_m) * r->dw;
    Four       clear = less(highest + set(ground_clear_posts), lowest);
    const Four sure = less(highest + r->sure, lowest);
    Four       outrun = set(0);
    if (steep && g->rise[k]) {
        uint64_t rise[4];
        for (int l = 0; l < 4; l++) memcpy(&rise[l], &g->rise[k][index[l]], sizeof rise[l]);
        const __m256i all = _mm256_loadu_si256((const __m256i *)rise), low = _mm256_set1_epi64x(0xffff);
        const __m256i by_u = _mm256_and_si256(_mm256_srlv_epi64(all, r->u_way), low);
        const __m256i by_v = _mm256_and_si256(_mm256_srlv_epi64(all, r->v_way), low);
        /* whole numbers below 2^52 become doubles by their exponent */
        const Four    magic = set(0x1p52);
        const Four    rise_u = _mm256_castsi256_pd(_mm256_or_si256(by_u, _mm256_castpd_si256(magic))) - magic;
        const Four    rise_v = _mm256_castsi256_pd(_mm256_or_si256(by_v, _mm256_castpd_si256(magic))) - magic;
        const Four    ground = rise_u * unless(set(-0.0), r->du) + rise_v * unless(set(-0.0), r->dv);
        outrun = both(r->above, less(ground + set(1e-9), r->dw));
        clear  = either(clear, outrun);
    }
    clear = both(clear, r->on);
    r->above = pick(clear, either(sure, outrun), r->above);
    const Four blocked = unless(clear, r->on);
    r->t_m = pick(clear, next, r->t_m);
    r->i   = r->i + both(both(clear, at_most(at_u, next)), either(one, both(sign, r->per_du)));
    r->j   = r->j + both(both(clear, at_most(at_v, next)), either(one, both(sign, r->per_dv)));
    leave(r);
    return both(blocked, r->on);
}

static inline bool any(const Rays4 r[quarters])
{
    Four on = r[0].on;
    for (int h = 1; h < quarters; h++) on = either(on, r[h].on);
    return bits(on) != 0;
}

/* Innermost level over which the place is, or the outermost; -1: it does not lie well inside those outside it, so that
 * who is over it need not be over them. */
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

/* Post of a level above which no level has anything. */
static double above_all(const Ground *ground, const GroundLevel *g)
{
    double above = 0;
    for (int k = 0; k < ground->level_count; k++) {
        const GroundLevel *other = &ground->level[k];
        above = fmax(above, (other->z0_m + other->highest / other->posts_per_m - g->z0_m) * g->posts_per_m);
    }
    return above + 1e-2;
}

/* 16 where the mask says so, else 0. */
static inline __m256i bits_16(Four mask)
{
    return _mm256_and_si256(_mm256_castpd_si256(mask), _mm256_set1_epi64x(16));
}

/* Sets four rays to where they begin. Off are those that do not begin on this level. */
static inline void begin(Rays4 *r, const Ground *ground, int level, const double *const o[3], const double *const d[3],
                         const double *far_m, const double *from_m, double above, int n)
{
    const GroundLevel *g = &ground->level[level];
    level_rays(r, g, o, d, n);
    Four good = both(usable(o, d, far_m, n), both(less(r->first_m, r->last_m), less(r->first_m, set(farthest_m))));
    if (level + 1 < ground->level_count) good = both(good, at_most(r->first_m, set(0)));
    if (level > 0) { /* as far as the level inside */
        Rays4 inner;
        level_rays(&inner, g - 1, o, d, n);
        r->last_m = pick(less(inner.first_m, inner.last_m), smaller(inner.first_m, r->last_m), r->last_m);
    }
    r->gone = r->above = set(0);
    const Four size = larger(unless(set(-0.0), r->u0), unless(set(-0.0), r->v0));
    const Four tame = both(at_most(size, set(sure_cells)), at_most(unless(set(-0.0), r->w0), set(sure_height_posts)));
    r->sure = pick(tame, set(sure_posts), set(INFINITY));
    r->u_way = bits_16(less(r->du, set(0)));
    r->v_way = _mm256_add_epi64(_mm256_set1_epi64x(32), bits_16(less(r->dv, set(0))));
    /* rising, it leaves everything behind at `above`, if it is near enough to tell; and nobody asks beyond far_m */
    const Four rises = both(less(set(1e-12), r->dw), at_most(unless(set(-0.0), r->w0), set(1e7)));
    r->stop_m = smaller(pick(rises, (set(above) - r->w0) / r->dw, set(INFINITY)), _mm256_loadu_pd(far_m + n));
    const Four from = _mm256_loadu_pd(from_m + n);
    r->t_m = pick(good, larger(r->first_m, from), from);
    r->on  = both(good, less(r->t_m, r->last_m));
    r->met = r->met_i = r->met_j = set(0);
    for (int p = 0; p < 3; p++) r->at[p] = r->clear[p] = set(0);
}

/* The end of ground_cell_hit. */
static inline void end(double *range_m, GroundHit *hit, const Rays4 *r, int level, const double *far_m, int n)
{
    const Four zero = set(0);
    const Four comes_down = less(zero, r->clear[0]), late = less(zero, r->clear[1]);
    const Four from = pick(both(comes_down, late), r->at[1], r->at[0]);
    const Four to = pick(comes_down, pick(late, r->at[2], r->at[1]), r->at[0]);
    const Four c_from = pick(late, r->clear[1], r->clear[0]), c_to = pick(late, r->clear[2], r->clear[1]);
    const Four range = pick(comes_down, from + (to - from) * (c_from / (c_from - c_to)), r->at[0]);
    const Four middle = set(0.5) * (from + to);
    const Four north_west = less(r->u0 + middle * r->du - r->met_i, r->v0 + middle * r->dv - r->met_j);
    const Four near = less(range, _mm256_loadu_pd(far_m + n));
    const Four seen = both(r->met, near);
    double     out[4];
    int32_t    i[4], j[4];
    _mm256_storeu_pd(out, pick(seen, range, set(INFINITY)));
    _mm_storeu_si128((__m128i *)i, _mm256_cvttpd_epi32(r->met_i));
    _mm_storeu_si128((__m128i *)j, _mm256_cvttpd_epi32(r->met_j));
    const unsigned met = bits(r->met), west = bits(north_west);
    for (int l = 0; l < 4; l++) {
        if (!(met >> l & 1)) continue;
        range_m[n + l] = out[l];
        if (hit && out[l] < INFINITY)
            hit[n + l] = (GroundHit){.level = level, .i = i[l], .j = j[l], .north_west = west >> l & 1};
    }
}

/* The group's walk: all on one level of the pyramid. */
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
                if (bits(r[h].on)) cell(&r[h], g);
            if (++tried < (steep ? 1 : cells_tried)) continue;
            k = steep && g->top >= elevation_rise_level ? elevation_rise_level : 1;
        } else {
            unsigned blocked = 0;
            for (int h = 0; h < quarters; h++)
                if (bits(r[h].on)) blocked |= bits(node(&r[h], g, k, steep)) << 4 * h;
            unsigned on = 0;
            for (int h = 0; h < quarters; h++) on |= bits(r[h].on) << 4 * h;
            if (blocked == 0) {
                if (++run < (steep ? 1 : run_up) || k == g->top) continue;
                k = k + 1 + steep < g->top ? k + 1 + steep : g->top;
            } else {
                run = 0;
                if (blocked != on && ++waited < wait) continue;
                k--;
            }
        }
        tried = waited = run = 0;
        for (int h = 0; h < quarters; h++) {
            if (!bits(r[h].on)) continue;
            if (k > before) ascend(&r[h], k - before);
            else enter(&r[h], g, k);
        }
    }
}

/* Whether all of a group are known to be over the ground as far as they are asked about it: then they meet nothing. */
static inline bool none_asked(double *range_m, const double *far_m, const double *from_m)
{
    Four none = set(0);
    none = at_most(none, none);
    for (int l = 0; l < 4 * quarters; l += 4)
        none = both(none, at_most(_mm256_loadu_pd(far_m + l), _mm256_loadu_pd(from_m + l)));
    if (bits(none) != 0xf) return false;
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
    const GroundLevel *g     = &ground->level[level];
    const double       above = above_all(ground, g);
    if (start_level > g->top) start_level = g->top;
    for (int done = 0; done < count; done += group) {
        const int n = done + group <= count ? done : count - group; /* the last group has some once more */
        Rays4     r[quarters];
        if (none_asked(range_m + n, far_m + n, from_m + n)) continue;
        for (int h = 0; h < quarters; h++) begin(&r[h], ground, level, o, d, far_m, from_m, above, n + 4 * h);
        walk(r, g, start_level, d[2][n] > steep_sine);
        for (int h = 0; h < quarters; h++) {
            const int m = n + 4 * h;
            double    t_m[4];
            end(range_m, hit, &r[h], level, far_m, m);
            _mm256_storeu_pd(t_m, r[h].t_m);
            const unsigned met = bits(r[h].met), gone = bits(r[h].gone);
            for (int l = 0; l < 4; l++) {
                if (met >> l & 1 || m + l < done) continue;
                if (gone >> l & 1 || !(from_m[m + l] < INFINITY)) {
                    range_m[m + l] = INFINITY;
                    continue;
                }
                from_m[m + l]      = t_m[l];
                left[left_count++] = m + l;
            }
        }
    }
    return left_count;
}
