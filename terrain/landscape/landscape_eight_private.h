/* terrain/landscape/landscape_eight_private.h: what cover and texture ask of eight places at once: smooth noise, and the fields
 * about them. A place's answer is the same in whatever company it is asked for. */
#ifndef TERRAIN_LANDSCAPE_LANDSCAPE_EIGHT_PRIVATE_H
#define TERRAIN_LANDSCAPE_LANDSCAPE_EIGHT_PRIVATE_H

#include "terrain/eight.h"
#include "terrain/landscape/landscape_private.h"

/* ---- noise -------------------------------------------------------------------------------- */

/* Eight coordinates in cells of a lattice: whole ones, and how far into them, 0 .. 1. */
typedef struct Lattice {
    EightInt cell;
    Eight    share;
} Lattice;

static inline Lattice lattice_of(const double x_m[8], double cells_per_m)
{
    const __m256d per_m = _mm256_set1_pd(cells_per_m);
    const __m256d low = _mm256_loadu_pd(x_m) * per_m, high = _mm256_loadu_pd(x_m + 4) * per_m;
    const __m256d low_cell = _mm256_floor_pd(low), high_cell = _mm256_floor_pd(high);
    return (Lattice){_mm256_set_m128i(_mm256_cvtpd_epi32(high_cell), _mm256_cvtpd_epi32(low_cell)),
                     _mm256_set_m128(_mm256_cvtpd_ps(high - high_cell), _mm256_cvtpd_ps(low - low_cell))};
}

/* -1 .. 1 of a mixed word. The mixing is Wellons' lowbias32 ("Prospecting for Hash Functions", 2018), without the last
 * step, which the upper bits do not feel. */
static inline Eight noise_of_word(EightInt h)
{
    h = _mm256_mullo_epi32(_mm256_xor_si256(h, _mm256_srli_epi32(h, 16)), eight_int(0x7feb352d));
    h = _mm256_mullo_epi32(_mm256_xor_si256(h, _mm256_srli_epi32(h, 15)), eight_int((int)0x846ca68bu));
    return eight_of_ints(h) * eight_all(0x1p-31);
}

/* Smooth value noise of one wavelength, -1 .. 1, mean 0. */
static inline Eight noise_eight(uint64_t seed, double wavelength_m, const double x_m[8], const double y_m[8])
{
    /* odd multipliers whose lattice of equal words has no vector shorter than 35 000 cells */
    const EightInt east = eight_int((int)0x9e3779b1u), north = eight_int((int)0x85ebca77u);
    const Lattice  x = lattice_of(x_m, 1 / wavelength_m), y = lattice_of(y_m, 1 / wavelength_m);
    const EightInt key = eight_int((int)(uint32_t)(landscape_hash(seed, 0, 0) >> 32));
    const EightInt sw = _mm256_add_epi32(
        key, _mm256_add_epi32(_mm256_mullo_epi32(x.cell, east), _mm256_mullo_epi32(y.cell, north)));
    const EightInt nw = _mm256_add_epi32(sw, north);
    const Eight    u = x.share * x.share * (eight_all(3) - eight_all(2) * x.share);
    const Eight    v = y.share * y.share * (eight_all(3) - eight_all(2) * y.share);
    const Eight    south = eight_mix(noise_of_word(sw), noise_of_word(_mm256_add_epi32(sw, east)), u);
    const Eight    north_side = eight_mix(noise_of_word(nw), noise_of_word(_mm256_add_epi32(nw, east)), u);
    return eight_mix(south, north_side, v);
}

/* ---- fields ------------------------------------------------------------------------------- */

static const double plot_m = 160;
enum { plot_sites = 9, plot_cells_kept = 16 };

/* One cell of the grid of fields, and the nine sites a place in it can belong to. From the cell's south-west corner. */
typedef struct PlotCell {
    int64_t  i, j;
    bool     known;
    float    x_m[plot_sites], y_m[plot_sites];
    uint64_t id[plot_sites];                          /* of the field; several sites may share one */
    int32_t  field[plot_sites];                       /* the same within this cell: the first site of the field */
    int32_t  crop[plot_sites];                        /* SurfaceClass */
    float    across_x[plot_sites], across_y[plot_sites]; /* unit vector across its rows */
} PlotCell;

/* Those that one call met last; starts zeroed. */
typedef struct PlotCells {
    PlotCell cell[plot_cells_kept];
} PlotCells;

const PlotCell *plot_cell_at(PlotCells *cells, uint64_t seed, int64_t i, int64_t j);

/* Of the places in `left`, those in the same cell as the first of them. */
static inline unsigned plot_cell_lanes(const double i[8], const double j[8], unsigned left)
{
    const int     first = __builtin_ctz(left);
    const __m256d fi = _mm256_set1_pd(i[first]), fj = _mm256_set1_pd(j[first]);
    unsigned      same = 0;
    for (int half = 0; half < 2; half++) {
        const __m256d eq_i = _mm256_cmp_pd(_mm256_loadu_pd(i + 4 * half), fi, _CMP_EQ_OQ);
        const __m256d eq_j = _mm256_cmp_pd(_mm256_loadu_pd(j + 4 * half), fj, _CMP_EQ_OQ);
        same |= (unsigned)_mm256_movemask_pd(_mm256_and_pd(eq_i, eq_j)) << (4 * half);
    }
    return same & left;
}

/* Whole cells of plots that eight places lie in, and the places from their cells' corners. */
static inline void plot_cells_of(double i[8], double j[8], Eight *x, Eight *y, const double x_m[8], const double y_m[8])
{
    float in_x[8], in_y[8];
    for (int k = 0; k < 8; k++) {
        i[k] = floor(x_m[k] * (1 / plot_m)), j[k] = floor(y_m[k] * (1 / plot_m));
        in_x[k] = (float)(x_m[k] - i[k] * plot_m), in_y[k] = (float)(y_m[k] - j[k] * plot_m);
    }
    *x = eight_load(in_x), *y = eight_load(in_y);
}

/* The nearest site of a cell to each of eight places from its corner; of equals the first. */
static inline Eight plot_nearest(EightInt *site, const PlotCell *cell, Eight x_m, Eight y_m)
{
    Eight    least = eight_all(INFINITY);
    EightInt best = eight_int(0);
    for (int n = 0; n < plot_sites; n++) {
        const Eight dx = x_m - _mm256_set1_ps(cell->x_m[n]), dy = y_m - _mm256_set1_ps(cell->y_m[n]);
        const Eight square = eight_fma(dx, dx, dy * dy), nearer = eight_less(square, least);
        least = eight_pick(nearer, square, least);
        best = _mm256_blendv_epi8(best, eight_int(n), _mm256_castps_si256(nearer));
    }
    *site = best;
    return least;
}

static inline EightInt plot_look(const int32_t value[plot_sites], EightInt site)
{
    return _mm256_i32gather_epi32(value, site, 4);
}

#endif
