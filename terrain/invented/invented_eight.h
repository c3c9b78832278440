/* terrain/invented/invented_eight.h: invented cover at eight places at once: smooth noise, the fields of farms about
 * the places, and their classes. The result of a place is independent of the other seven. */
#ifndef TERRAIN_INVENTED_INVENTED_EIGHT_H
#define TERRAIN_INVENTED_INVENTED_EIGHT_H

#include "pitviper_simd.h"
#include "terrain/invented/invented.h"

/* ---- noise -------------------------------------------------------------------------------- */

/* Eight coordinates in a lattice: the whole cell of each, and the position in the cell, 0 .. 1. */
typedef struct Lattice {
    I32x8 cell;
    F32x8 share;
} Lattice;

static inline Lattice lattice_of(const double x_m[8], double cells_per_m)
{
    const F64x4 per_m = f64x4_set(cells_per_m);
    const F64x4 low = f64x4_loadu(x_m) * per_m, high = f64x4_loadu(x_m + 4) * per_m;
    const F64x4 low_cell = f64x4_floor(low), high_cell = f64x4_floor(high);
    return (Lattice){_mm256_set_m128i(_mm256_cvtpd_epi32(high_cell), _mm256_cvtpd_epi32(low_cell)),
                     _mm256_set_m128(_mm256_cvtpd_ps(high - high_cell), _mm256_cvtpd_ps(low - low_cell))};
}

/* A number in -1 .. 1 from a mixed word. The mixing is Wellons' lowbias32 ("Prospecting for Hash Functions", 2018),
 * without the last step, which the upper bits do not depend on. */
static inline F32x8 noise_of_word(I32x8 h)
{
    h = i32x8_mul(i32x8_xor(h, i32x8_shift_right(h, 16)), i32x8_set(0x7feb352d));
    h = i32x8_mul(i32x8_xor(h, i32x8_shift_right(h, 15)), i32x8_set((int)0x846ca68bu));
    return f32x8_of_ints(h) * f32x8_set(0x1p-31);
}

/* A second noise value from the same words, by another mixing. */
static inline F32x8 second_of_word(I32x8 h)
{
    h = i32x8_mul(i32x8_xor(h, i32x8_shift_right(h, 15)), i32x8_set((int)0xd168aaadu));
    h = i32x8_mul(i32x8_xor(h, i32x8_shift_right(h, 16)), i32x8_set((int)0xaf723597u));
    return f32x8_of_ints(h) * f32x8_set(0x1p-31);
}

/* The lattice cells of eight places for one wavelength, and their weights. */
typedef struct NoiseCells {
    I32x8 sw; /* word of the south-western corner; those of the other corners are sums with it */
    F32x8 u, v;
    bool  same; /* all eight places are in one cell, so its four corners are mixed at once */
} NoiseCells;

/* odd multipliers whose lattice of equal words has no vector shorter than 35 000 cells */
static const uint32_t noise_east = 0x9e3779b1u, noise_north = 0x85ebca77u;

static inline NoiseCells noise_cells(uint64_t seed, double wavelength_m, const double x_m[8], const double y_m[8])
{
    const Lattice x = lattice_of(x_m, 1 / wavelength_m), y = lattice_of(y_m, 1 / wavelength_m);
    const I32x8   key = i32x8_set((int)(uint32_t)(invented_hash(seed, 0, 0) >> 32));
    const I32x8   sw = i32x8_add(
          key, i32x8_add(i32x8_mul(x.cell, i32x8_set((int)noise_east)), i32x8_mul(y.cell, i32x8_set((int)noise_north))));
    const F32x8 equal = i32x8_equal(sw, _mm256_permutevar8x32_epi32(sw, i32x8_set(0)));
    return (NoiseCells){.sw = sw,
                        .u = x.share * x.share * (f32x8_set(3) - f32x8_set(2) * x.share),
                        .v = y.share * y.share * (f32x8_set(3) - f32x8_set(2) * y.share),
                        .same = f32x8_bits(equal) == 0xff};
}

/* Words of the corners SW, SE, NW, NE, twice, of places that share a cell. */
static inline I32x8 noise_corner_words(const NoiseCells *c)
{
    return i32x8_add(c->sw, _mm256_setr_epi32(0, (int)noise_east, (int)noise_north, (int)(noise_east + noise_north), 0,
                                              (int)noise_east, (int)noise_north, (int)(noise_east + noise_north)));
}

static inline F32x8 noise_between(const NoiseCells *c, F32x8 sw, F32x8 se, F32x8 nw, F32x8 ne)
{
    return f32x8_lerp(f32x8_lerp(sw, se, c->u), f32x8_lerp(nw, ne, c->u), c->v);
}

/* As noise_between, where the four corners' values are in the lanes of one vector. */
static inline F32x8 noise_between_same(const NoiseCells *c, F32x8 corner)
{
    return noise_between(c, _mm256_permutevar8x32_ps(corner, i32x8_set(0)),
                         _mm256_permutevar8x32_ps(corner, i32x8_set(1)), _mm256_permutevar8x32_ps(corner, i32x8_set(2)),
                         _mm256_permutevar8x32_ps(corner, i32x8_set(3)));
}

/* Smooth value noise of one wavelength, -1 .. 1, mean 0. */
static inline F32x8 noise_eight(uint64_t seed, double wavelength_m, const double x_m[8], const double y_m[8])
{
    const NoiseCells c = noise_cells(seed, wavelength_m, x_m, y_m);
    if (c.same) return noise_between_same(&c, noise_of_word(noise_corner_words(&c)));
    const I32x8 east = i32x8_set((int)noise_east), nw = i32x8_add(c.sw, i32x8_set((int)noise_north));
    return noise_between(&c, noise_of_word(c.sw), noise_of_word(i32x8_add(c.sw, east)), noise_of_word(nw),
                         noise_of_word(i32x8_add(nw, east)));
}

/* Two such noises for little more than one. */
static inline F32x8 noise_pair_eight(F32x8 *second, uint64_t seed, double wavelength_m, const double x_m[8],
                                     const double y_m[8])
{
    const NoiseCells c = noise_cells(seed, wavelength_m, x_m, y_m);
    if (c.same) {
        const I32x8 words = noise_corner_words(&c);
        *second = noise_between_same(&c, second_of_word(words));
        return noise_between_same(&c, noise_of_word(words));
    }
    const I32x8 east = i32x8_set((int)noise_east), nw = i32x8_add(c.sw, i32x8_set((int)noise_north));
    const I32x8 se = i32x8_add(c.sw, east), ne = i32x8_add(nw, east);
    *second = noise_between(&c, second_of_word(c.sw), second_of_word(se), second_of_word(nw), second_of_word(ne));
    return noise_between(&c, noise_of_word(c.sw), noise_of_word(se), noise_of_word(nw), noise_of_word(ne));
}

/* ---- fields ------------------------------------------------------------------------------- */

static const double plot_m = 160;
enum { plot_sites = 9, plot_cells_kept = 128, plot_parts = 8 /* of a cell, along a side */ };

/* The border between two sites; it is computed when it is first needed. */
typedef struct PlotEdge {
    bool   known, first, track, hedge; /* first, track, hedge: as in PlotBorder */
    double apart_m;                    /* distance between the sites */
} PlotEdge;

/* One cell of the grid of fields, and the nine sites that a place in it can belong to. Positions are relative to the
 * cell's south-west corner. */
typedef struct PlotCell {
    int64_t  i, j;
    uint64_t seed;
    bool     known;
    float    x_m[plot_sites], y_m[plot_sites];
    uint64_t id[plot_sites];    /* number of the site's field; several sites may share one */
    int32_t  field[plot_sites]; /* number of the field within this cell: the first of its sites */
    int32_t  crop[plot_sites];  /* SurfaceClass */
    float    across_x[plot_sites], across_y[plot_sites]; /* unit vector across the rows of its field */
    PlotEdge edge[plot_sites][plot_sites];
    /* of each part of the cell, when it is first needed: bits of the sites that can be nearest to a place in it, or
     * beyond a border that is; 0: not known */
    uint16_t sites_about[plot_parts * plot_parts];
} PlotCell;

/* The border between two sites of different fields, at a place in the first of them. */
typedef struct PlotBorder {
    double away_m;       /* distance of the border from the place */
    bool   first;        /* the place's field comes first of the two */
    bool   track, hedge; /* whether a track, and a hedge, runs along the border */
} PlotBorder;

/* Of two sites of different fields. */
const PlotEdge *plot_edge(PlotCell *cell, uint64_t seed, int site, int other);
PlotBorder      plot_border(PlotCell *cell, uint64_t seed, int site, int other, float x_m, float y_m);

/* The nearest border about a place, the unit vector away from it, but for the bend, and a number of its two fields. */
bool plot_border_about(PlotBorder *out, double away_from[2], uint64_t *fields, uint64_t seed, double x_m, double y_m);

/* Cosine and sine of the angle by which a seed turns its fields from north. */
static inline void plot_turn(double *cosine, double *sine, uint64_t seed)
{
    static const double of[8][2] = {{3 / 5.0, 4 / 5.0},     {5 / 13.0, 12 / 13.0},  {8 / 17.0, 15 / 17.0},
                                    {20 / 29.0, 21 / 29.0}, {12 / 37.0, 35 / 37.0}, {9 / 41.0, 40 / 41.0},
                                    {28 / 53.0, 45 / 53.0}, {33 / 65.0, 56 / 65.0}};
    const uint64_t      h = invented_hash(seed + 25, 0, 0), swap = h >> 60 & 1;
    *cosine = of[h >> 61][swap], *sine = of[h >> 61][1 - swap];
}

static const double plot_bend_wave_m[] = {2300, 330}, plot_bend_away_m[] = {260, 28};

/* How far eight places are moved by the bend of the plane on which fields are laid out: it is turned, and bent over
 * hundreds of metres. */
static inline void plot_bend_by(F32x8 *by_x, F32x8 *by_y, uint64_t seed, const double x_m[8], const double y_m[8])
{
    F32x8 dx = f32x8_set(0), dy = f32x8_set(0);
    for (int n = 0; n < 2; n++) {
        F32x8 wave_y;
        dx = f32x8_fma(f32x8_set(plot_bend_away_m[n]),
                       noise_pair_eight(&wave_y, seed + 26 + (uint64_t)n, plot_bend_wave_m[n], x_m, y_m), dx);
        dy = f32x8_fma(f32x8_set(plot_bend_away_m[n]), wave_y, dy);
    }
    *by_x = dx, *by_y = dy;
}

/* Where eight places are on that plane. */
static inline void plot_bent(double bent_x[8], double bent_y[8], uint64_t seed, const double x_m[8],
                             const double y_m[8], F32x8 dx, F32x8 dy)
{
    float by_x[8], by_y[8];
    f32x8_store(by_x, dx), f32x8_store(by_y, dy);
    double c, t;
    plot_turn(&c, &t, seed);
    for (int k = 0; k < 8; k++) {
        bent_x[k] = c * x_m[k] - t * y_m[k] + (double)by_x[k];
        bent_y[k] = t * x_m[k] + c * y_m[k] + (double)by_y[k];
    }
}

static inline void plot_bend(double bent_x[8], double bent_y[8], uint64_t seed, const double x_m[8],
                             const double y_m[8])
{
    F32x8 dx, dy;
    plot_bend_by(&dx, &dy, seed, x_m, y_m);
    plot_bent(bent_x, bent_y, seed, x_m, y_m, dx, dy);
}

/* Valid until the thread's next call. */
PlotCell *plot_cell_at(uint64_t seed, int64_t i, int64_t j);

/* Those of the lanes in `left` whose place is in the same cell as that of the first of them. */
static inline unsigned plot_cell_lanes(const double i[8], const double j[8], unsigned left)
{
    const int   first = __builtin_ctz(left);
    const F64x4 fi = f64x4_set(i[first]), fj = f64x4_set(j[first]);
    unsigned    same = 0;
    for (int half = 0; half < 2; half++) {
        const F64x4 eq_i = f64x4_equal(f64x4_loadu(i + 4 * half), fi);
        const F64x4 eq_j = f64x4_equal(f64x4_loadu(j + 4 * half), fj);
        same |= f64x4_bits(f64x4_and(eq_i, eq_j)) << (4 * half);
    }
    return same & left;
}

/* The whole cells of fields that eight places lie in, and the positions relative to the cells' corners. */
static inline void plot_cells_of(double i[8], double j[8], F32x8 *x, F32x8 *y, const double x_m[8], const double y_m[8])
{
    float in_x[8], in_y[8];
    for (int k = 0; k < 8; k++) {
        i[k] = floor(x_m[k] * (1 / plot_m)), j[k] = floor(y_m[k] * (1 / plot_m));
        in_x[k] = (float)(x_m[k] - i[k] * plot_m), in_y[k] = (float)(y_m[k] - j[k] * plot_m);
    }
    *x = f32x8_load(in_x), *y = f32x8_load(in_y);
}

/* The site of a cell nearest to each of eight places, which are relative to the cell's corner; of sites at equal
 * distance the first. */
static inline F32x8 plot_nearest(I32x8 *site, const PlotCell *cell, F32x8 x_m, F32x8 y_m)
{
    F32x8 least = f32x8_set(INFINITY);
    I32x8 best = i32x8_set(0);
    for (int n = 0; n < plot_sites; n++) {
        const F32x8 dx = x_m - f32x8_set((double)cell->x_m[n]), dy = y_m - f32x8_set((double)cell->y_m[n]);
        const F32x8 square = f32x8_fma(dx, dx, dy * dy), nearer = f32x8_less(square, least);
        least = f32x8_select(nearer, square, least);
        best = i32x8_select(nearer, i32x8_set(n), best);
    }
    *site = best;
    return least;
}

static inline I32x8 plot_look(const int32_t value[plot_sites], I32x8 site) { return i32x8_gather(value, site); }

/* Eight places among the fields. */
typedef struct PlotPlaces {
    I32x8    crop; /* of the field: SurfaceClass */
    unsigned near; /* lanes within reach of a border between their field and another; the rest is of these lanes */
    unsigned sure; /* whose class on the border does not depend on how it wanders */
    unsigned first, track, hedge; /* as in PlotBorder */
    I32x8    beyond;              /* crop of the field beyond the border */
    double   away_m[8];           /* distance of the border */
} PlotPlaces;

/* Of places on the plane of fields, those of these lanes. */
void plots_find(PlotPlaces *out, uint64_t seed, const double bent_x[8], const double bent_y[8], unsigned lanes);
/* Classes on borders that wander, -1 .. 1, of these lanes, which are near some; SURFACE_NONE: that of the field. Crops
 * become those of the fields that the places are in then. */
I32x8 plots_on_borders(PlotPlaces *places, F32x8 wander, unsigned lanes);
/* Whether all places this near one on the plane of fields are of one field, and no border changes their class. */
bool plots_alike(uint64_t seed, const double bent_m[2], double radius_m);

/* ---- classes ------------------------------------------------------------------------------ */

/* The slowly varying fields that the synthetic cover follows, of wavelengths from 17 m on, at eight places. */
typedef struct SlowFields {
    F32x8 large, middle, patch; /* noise of 310, 83 and 17 m */
    F32x8 slope, wet;
    F32x8 bend_x, bend_y; /* plot_bend_by */
    bool  tame;           /* no place is wild: large, middle, slope and wet are not set */
    bool  untouched;      /* no way touches the index cell of any place */
} SlowFields;

/* Two by four nodes about places a few metres apart: between the nodes the slow fields are linear. */
typedef struct SlowNodes {
    bool       known;
    bool       east;             /* the four nodes lie from west to east; otherwise from south to north */
    double     x0_m, y0_m;       /* place of the south-west node */
    double     per_x_m, per_y_m; /* nodes a metre */
    bool       tame;             /* no place between them is wild: but for `patch` and bends, fields are not needed */
    SlowFields field;            /* lanes: nodes along the longer side, then across */
} SlowNodes;

/* Lanes of places where there is ground, that is, inside the outermost level, which encloses the others. NaN: no
 * ground. */
unsigned            invented_grounded(const Elevation *elevation, const double x_m[8], const double y_m[8]);
static const double invented_arm_m = 10;
/* Slope of the terrain about the places, over twice this length, without the tilt of the plane far from its origin. */
F32x8 invented_slopes(const Elevation *elevation, const double x_m[8], const double y_m[8], unsigned lanes);

/* Lowest and highest of slow fields over an area. */
typedef struct WildEnds {
    float large[2], middle[2], patch[2], slope[2], wet[2];
} WildEnds;

/* Whether no such field makes one place of the area wild and another not, or otherwise. */
bool invented_wild_alike(const WildEnds *ends);

void invented_fields(SlowFields *out, const InventedGround *ground, const double x_m[8], const double y_m[8],
                     F32x8 slope);
/* Computes nodes about these places; they are marked unknown where the places lie too far apart. */
void invented_nodes(SlowNodes *out, const InventedGround *ground, const Elevation *elevation, int count,
                    const double *x_m, const double *y_m);
/* The slow fields at places between known nodes. */
void invented_between(SlowFields *out, const SlowNodes *nodes, const double x_m[8], const double y_m[8]);
/* Surface classes at the places of these lanes. */
void invented_surfaces(int32_t surface[8], const InventedGround *ground, const double x_m[8], const double y_m[8],
                       const SlowFields *slow, unsigned lanes);

#endif
