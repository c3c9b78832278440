/* render/ground/ground_normals.c: normals of the ground at four hits at a time. */
#include "pitviper_simd.h"
#include "render/ground/ground_private.h"

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
    const unsigned     in_i = i % elevation_tile_cells, in_j = j % elevation_tile_cells, last = elevation_tile_cells - 1;
    const unsigned     tile = j / elevation_tile_cells * (unsigned)g->tiles_x + i / elevation_tile_cells;
    const ptrdiff_t    row = elevation_tile_side;
    const uint16_t    *sw = g->stored + (size_t)tile * elevation_tile_posts + in_j * elevation_tile_side + in_i;
    const uint16_t    *along = sw + (north_west ? row : 0), *up = sw + !north_west;
    *out = (TriangleRises){.of = {[west_east] = along[1] - along[0], [south_north] = up[row] - up[0]}};
    /* all neighbours of its posts are in its tile and level */
    const bool inside = (in_i > 0) & (in_j > 0) & (in_i < last) & (in_j < last) & (i + 2 <= (unsigned)g->cells_x) &
                        (j + 2 <= (unsigned)g->cells_y);
    if (inside) {
        const uint16_t *post[3] = {sw, sw + row + 1, sw + (north_west ? row : 1)};
        for (int k = 0; k < 3; k++) {
            out->of[post_sw + 2 * k]     = post[k][1] - post[k][-1];
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
        out[n]     = f64x4_of_ints(_mm256_castsi256_si128(pair[n]));
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
        if (level && h->i == before->i && h->j == before->j && h->north_west == before->north_west) four.rise[k] = four.rise[k - 1];
        else find_rises(&four.rise[k], ground, h);
        four.scale[k] = level ? four.scale[k - 1] : g->cells_per_m / g->posts_per_m;
        four.a[k] = (x_m[i] - g->x0_m) * g->cells_per_m - h->i;
        four.b[k] = (y_m[i] - g->y0_m) * g->cells_per_m - h->j;
        before = h;
    }
    four_normals(geo, enu, &four);
    for (int c = 0; c < 3; c++) f64x4_storeu(n_geo[c], geo[c]), f64x4_storeu(n_enu[c], enu[c]);
}
