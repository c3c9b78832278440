/* render/trace/ground/ground.c: the elevation in the form that the ray tracers use, and the scalar tracer. */

#include "render/trace/ground/ground_private.h"
#include "pitviper_simd.h"

/* Of the whole level's edges; of a small level without rises, as far as its posts can be apart. */
static double steepest(const GroundLevel *g)
{
    if (!g->rise[g->top]) return elevation_highest_post - elevation_lowest_post;
    const ElevationRise r = *g->rise[g->top];
    const int           along = r.east > r.west ? r.east : r.west, across = r.north > r.south ? r.north : r.south;
    return g->rise_unit * (along > across ? along : across);
}

void ground_prepare(Ground *out, const Elevation *elevation)
{
    *out = (Ground){.elevation = elevation, .level_count = elevation ? elevation->level_count : 0};
    for (int k = 0; k < out->level_count; k++) {
        const ElevationLevel *e = &elevation->level[k];
        GroundLevel          *g = &out->level[k];
        *g = (GroundLevel){.stored = e->stored,
                           .tile = e->tile,
                           .plain = e->plain,
                           .tiles_x = e->tiles_x,
                           .cells_x = e->nx - 1,
                           .cells_y = e->ny - 1,
                           .top = e->pyramid_count - 1,
                           .pyramid_base = e->pyramid_base,
                           .pyramid_shift = e->pyramid_shift,
                           .rise_unit = 1 << e->rise_shift,
                           .x0_m = e->x0_m,
                           .y0_m = e->y0_m,
                           .z0_m = e->z0_m,
                           .cells_per_m = 1 / e->spacing_m,
                           .posts_per_m = 1 / e->step_m};
        for (int p = 0; p < e->pyramid_count; p++) {
            g->pyramid[p] = e->pyramid[p];
            g->rise[p] = e->rise[p];
            g->pyramid_nx[p] = e->pyramid_nx[p];
        }
        g->highest = ground_highest(g, g->top, 0, 0);
        g->steepest = steepest(g);
    }
}

/* Interval of t over which the ray is above the rectangle of a level; false: none from 0 on. */
static bool level_interval(LevelRay *r, const GroundLevel *g)
{
    const double u_low = (0 - r->u0) * r->per_du, u_high = (g->cells_x - r->u0) * r->per_du;
    const double v_low = (0 - r->v0) * r->per_dv, v_high = (g->cells_y - r->v0) * r->per_dv;
    const double u_in = r->per_du > 0 ? u_low : u_high, u_out = r->per_du > 0 ? u_high : u_low;
    const double v_in = r->per_dv > 0 ? v_low : v_high, v_out = r->per_dv > 0 ? v_high : v_low;
    r->first_m = u_in > v_in ? u_in : v_in;
    r->first_m = r->first_m > 0 ? r->first_m : 0;
    r->last_m = u_out < v_out ? u_out : v_out;
    return r->first_m < r->last_m;
}

static void add_piece(GroundRay *out, int level, double first_m, double last_m)
{
    if (!(first_m < last_m && first_m < farthest_m)) return;
    out->level[out->piece_count] = level;
    out->first_m[out->piece_count] = first_m;
    out->last_m[out->piece_count] = last_m;
    out->piece_count++;
}

void ground_ray(GroundRay *out, const Ground *ground, const double o[3], const double d[3], double far_m)
{
    static const double usable_m = 1e9; /* beyond it a cell number would lose its fraction */
    out->piece_count = out->piece = 0;
    if (!(fabs(o[0]) <= usable_m && fabs(o[1]) <= usable_m && fabs(o[2]) <= usable_m)) return;
    if (!(fabs(d[0]) <= 2 && fabs(d[1]) <= 2 && fabs(d[2]) <= 2 && v3_dot(d, d) > 0.25 && far_m > 0)) return;

    int inner = ground->level_count; /* innermost level that the ray passes */
    for (; inner > 0; inner--) {
        ground_level_ray(&out->of_level[inner - 1], &ground->level[inner - 1], ground->bend_per_m, o, d);
        if (!level_interval(&out->of_level[inner - 1], &ground->level[inner - 1])) break;
    }
    if (inner == ground->level_count) return;

    const LevelRay *r = out->of_level;
    for (int k = ground->level_count - 1; k > inner; k--)
        add_piece(out, k, r[k].first_m, fmin(r[k - 1].first_m, r[k].last_m));
    add_piece(out, inner, r[inner].first_m, r[inner].last_m);
    for (int k = inner + 1; k < ground->level_count; k++)
        add_piece(out, k, fmax(r[k - 1].last_m, r[k].first_m), r[k].last_m);
}

/* Traces one level. Descends the max pyramid where the ray comes lower than a node's highest post, steps along it
 * otherwise, and ascends wherever it leaves a parent. */
static double level_first_hit(GroundHit *hit, const GroundLevel *g, const LevelRay *r, double far_m)
{
    double t, stop;
    ground_walk(&t, &stop, g, r, far_m);
    const bool east = r->per_du > 0, north = r->per_dv > 0;
    int        k = ground_start_level(g, r), i = 0, j = 0;
    if (!(t < stop)) return INFINITY;
    i = ground_cell_at(r->u0, r->du, r->per_du, t, g->cells_x);
    j = ground_cell_at(r->v0, r->dv, r->per_dv, t, g->cells_y);
    for (;;) {
        const int    node_i = i >> k, node_j = j >> k;
        const int    line_u = (node_i + east) << k, line_v = (node_j + north) << k;
        const double at_u = (line_u - r->u0) * r->per_du, at_v = (line_v - r->v0) * r->per_dv;
        double       next = at_u < at_v ? at_u : at_v;
        next = next < r->last_m ? next : r->last_m;
        const double  here = ground_ray_height(r, t), there = ground_ray_height(r, next);
        const double  lowest = here < there ? here : there;
        const int32_t highest = k > 0 ? ground_highest(g, k, node_i, node_j) : ground_cell_highest(g, i, j);
        if (!(lowest > highest + ground_clear_posts)) {
            if (k > 0) {
                k = ground_level_below(k);
                continue;
            }
            bool         north_west;
            const double range_m = ground_cell_hit(g, r, i, j, &north_west);
            if (range_m < INFINITY) {
                if (!(range_m < far_m)) return INFINITY;
                if (hit) *hit = (GroundHit){.i = i, .j = j, .north_west = north_west};
                return range_m;
            }
        }
        t = next;
        if (!(t < stop)) return INFINITY;
        const bool crosses_u = at_u <= t, crosses_v = at_v <= t;
        if (crosses_u) i = east ? line_u : line_u - 1;
        else if (k > 0) i = ground_cell_at(r->u0, r->du, r->per_du, t, g->cells_x);
        if (crosses_v) j = north ? line_v : line_v - 1;
        else if (k > 0) j = ground_cell_at(r->v0, r->dv, r->per_dv, t, g->cells_y);
        const int up = ground_level_above(k), inside = (1 << up) - 1; /* lines of the parent */
        if (k < g->top && ((crosses_u && !(line_u & inside)) || (crosses_v && !(line_v & inside)))) k = up;
    }
}

double ground_first_hit(GroundHit *hit, const Ground *ground, const double o_enu[3], const double d_enu[3],
                        double far_m)
{
    GroundRay ray;
    ground_ray(&ray, ground, o_enu, d_enu, far_m);
    for (int p = 0; p < ray.piece_count; p++) {
        const int level = ray.level[p];
        LevelRay *r = &ray.of_level[level];
        r->first_m = ray.first_m[p];
        r->last_m = ray.last_m[p];
        const double range_m = level_first_hit(hit, &ground->level[level], r, far_m);
        if (range_m < INFINITY) {
            if (hit) hit->level = level;
            return range_m;
        }
    }
    return INFINITY;
}

/* ---- normals of the ground at four hits at a time -------------------------------------------- */

/* ---- rises between posts ---------------------------------------------------------------------- */

enum { west_east, south_north, post_sw = 2, post_ne = 4, post_corner = 6, rises = 8 };

/* What the two normals are made of: the rises along a triangle's two sides, and at its south-western, north-eastern and
 * third post twice the mean rise of a cell to east and north. Posts. */
typedef struct TriangleRises {
    int32_t of[rises];
} TriangleRises;

/* Twice the central difference, one-sided at the level's edges. */
static void post_rises(int32_t rise[2], const ElevationLevel *e, int i, int j)
{
    const int west = i > 0 ? i - 1 : i, east = i < e->nx - 1 ? i + 1 : i;
    const int south = j > 0 ? j - 1 : j, north = j < e->ny - 1 ? j + 1 : j;
    rise[0] = (elevation_post(e, east, j) - elevation_post(e, west, j)) * (2 / (east - west));
    rise[1] = (elevation_post(e, i, north) - elevation_post(e, i, south)) * (2 / (north - south));
}

static void find_rises(TriangleRises *out, const Ground *ground, const GroundHit *hit)
{
    const GroundLevel *g = &ground->level[hit->level];
    const unsigned     i = (unsigned)hit->i, j = (unsigned)hit->j, north_west = hit->north_west; /* not negative */
    const unsigned  in_i = i % elevation_tile_cells, in_j = j % elevation_tile_cells, last = elevation_tile_cells - 1;
    const unsigned  tile = j / elevation_tile_cells * (unsigned)g->tiles_x + i / elevation_tile_cells;
    const ptrdiff_t row = elevation_tile_side;
    const uint16_t *sw = g->stored + (size_t)tile * elevation_tile_posts + in_j * elevation_tile_side + in_i;
    const uint16_t *along = sw + (north_west ? row : 0), *up = sw + !north_west;
    *out = (TriangleRises){.of = {[west_east] = along[1] - along[0], [south_north] = up[row] - up[0]}};
    /* all neighbours of its posts are in its tile and level */
    const bool inside = (in_i > 0) & (in_j > 0) & (in_i < last) & (in_j < last) & (i + 2 <= (unsigned)g->cells_x) &
                        (j + 2 <= (unsigned)g->cells_y);
    if (inside) {
        const uint16_t *post[3] = {sw, sw + row + 1, sw + (north_west ? row : 1)};
        for (int k = 0; k < 3; k++) {
            out->of[post_sw + 2 * k] = post[k][1] - post[k][-1];
            out->of[post_sw + 2 * k + 1] = post[k][row] - post[k][-row];
        }
    }
    if (!g->plain)
        i32x8_store(out->of, _mm256_sll_epi32(i32x8_load(out->of), _mm_cvtsi32_si128(g->tile[tile].shift & 31)));
    if (inside) return;
    const ElevationLevel *e = &ground->elevation->level[hit->level];
    post_rises(out->of + post_sw, e, hit->i, hit->j);
    post_rises(out->of + post_ne, e, hit->i + 1, hit->j + 1);
    post_rises(out->of + post_corner, e, hit->i + !hit->north_west, hit->j + hit->north_west);
}

/* ---- normals ---------------------------------------------------------------------------------- */

/* Hits side by side: their rises, their places in their cells from the south-west post in cells, and what turns posts a
 * cell into metres a metre. */
typedef struct FourHits {
    TriangleRises rise[ground_normals_lanes];
    double        a[ground_normals_lanes], b[ground_normals_lanes], scale[ground_normals_lanes];
} FourHits;

/* The rises of four triangles, each kind in one vector. */
static inline void turn_rises(F64x4 out[rises], const TriangleRises rise[ground_normals_lanes])
{
    I32x8 row[ground_normals_lanes];
    for (int k = 0; k < ground_normals_lanes; k++) row[k] = i32x8_load(rise[k].of);
    const I32x8 low_a = _mm256_unpacklo_epi32(row[0], row[1]), low_b = _mm256_unpacklo_epi32(row[2], row[3]);
    const I32x8 high_a = _mm256_unpackhi_epi32(row[0], row[1]), high_b = _mm256_unpackhi_epi32(row[2], row[3]);
    const I32x8 pair[4] = {_mm256_unpacklo_epi64(low_a, low_b), _mm256_unpackhi_epi64(low_a, low_b),
                           _mm256_unpacklo_epi64(high_a, high_b), _mm256_unpackhi_epi64(high_a, high_b)};
    for (int n = 0; n < 4; n++) {
        out[n] = f64x4_of_ints(_mm256_castsi256_si128(pair[n]));
        out[n + 4] = f64x4_of_ints(_mm256_extracti128_si256(pair[n], 1));
    }
}

static inline void upward(F64x4 n[3], F64x4 slope_x, F64x4 slope_y)
{
    const F64x4 one = f64x4_set(1), s = one / f64x4_sqrt(slope_x * slope_x + slope_y * slope_y + one);
    n[0] = -slope_x * s;
    n[1] = -slope_y * s;
    n[2] = s;
}

static inline void four_normals(F64x4 n_geo[3], F64x4 n_enu[3], const FourHits *four)
{
    const F64x4 none = f64x4_set(0), one = f64x4_set(1), scale = f64x4_loadu(four->scale);
    F64x4       rise[rises], slope[2];
    turn_rises(rise, four->rise);
    upward(n_geo, rise[west_east] * scale, rise[south_north] * scale);
    /* weights of SW, NE and the third post: 1 - max, min, the difference */
    const F64x4 a = f64x4_max(none, f64x4_min(one, f64x4_loadu(four->a)));
    const F64x4 b = f64x4_max(none, f64x4_min(one, f64x4_loadu(four->b)));
    const F64x4 low = f64x4_min(a, b), high = f64x4_max(a, b), half = f64x4_set(0.5);
    for (int c = 0; c < 2; c++)
        slope[c] = (one - high) * (rise[post_sw + c] * scale * half) + low * (rise[post_ne + c] * scale * half) +
                   (high - low) * (rise[post_corner + c] * scale * half);
    upward(n_enu, slope[0], slope[1]);
}

void ground_normals(double n_geo[3][ground_normals_lanes], double n_enu[3][ground_normals_lanes], const Ground *ground,
                    const GroundHit *hit, const int *list, int count, const double *x_m, const double *y_m)
{
    FourHits         four;
    F64x4            geo[3], enu[3];
    const GroundHit *before = NULL; /* neighbours are often of one triangle, and nearly always of one level */
    for (int k = 0; k < ground_normals_lanes; k++) {
        const int          i = list[k < count ? k : 0];
        const GroundHit   *h = &hit[i];
        const GroundLevel *g = &ground->level[h->level];
        const bool         level = before && h->level == before->level;
        if (level && h->i == before->i && h->j == before->j && h->north_west == before->north_west)
            four.rise[k] = four.rise[k - 1];
        else find_rises(&four.rise[k], ground, h);
        four.scale[k] = level ? four.scale[k - 1] : g->cells_per_m / g->posts_per_m;
        four.a[k] = (x_m[i] - g->x0_m) * g->cells_per_m - h->i;
        four.b[k] = (y_m[i] - g->y0_m) * g->cells_per_m - h->j;
        before = h;
    }
    four_normals(geo, enu, &four);
    for (int c = 0; c < 3; c++) f64x4_storeu(n_geo[c], geo[c]), f64x4_storeu(n_enu[c], enu[c]);
}
