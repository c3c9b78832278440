/* render/scattering/clutter/clutter.h: ground clutter as point scatterers fixed to the ground.
 *
 * The plane of enu is cut into square cells, each with one scatterer: its place within the cell and its scattering
 * are a hash of seed, level and cell, so a cell keeps its phase over pulses, and answers do not depend on order,
 * threads or what else is visited. The path's phase is not in the amplitude: sum S exp(-j k path) over the cells of
 * a resolution cell, in a fixed order (render/scattering/scatter.h). With several scatterers in a resolution cell that
 * sum is complex Gaussian times the root of the texture: speckle, decorrelated by aspect as the cell's extent has
 * it (lambda / (2 extent)).
 *
 * Cells of level l have sides of side_m 2^l and nest. Each level has its own speckle: the mean is the same at every
 * level, phases are not. So a dwell that is to be coherent must keep the level of each cell, by asking with one
 * `from`. Texture is shared by the levels; where cells are larger than it, its variance is less, so that means over
 * many cells vary alike at every level.
 *
 * Order of work: cells; their centres, to drop those that are hidden (the caller's rays); places and the ground's
 * height, normal and class there (the caller's); clutter_draw, once a dwell; clutter_see, once a pulse. Nothing
 * here allocates. */
#ifndef RENDER_SCATTERING_CLUTTER_CLUTTER_H
#define RENDER_SCATTERING_CLUTTER_CLUTTER_H

#include "render/scattering/clutter/clutter_table_private.h"
#include "render/scattering/scatter.h"

enum { clutter_levels = 16, clutter_still_terms = 3, clutter_terms = 7 };

typedef struct ClutterGrid {
    double   side_m; /* of cells of level 0: at most half the finest resolution */
    uint64_t seed;
} ClutterGrid;

typedef struct ClutterCell {
    int32_t x, y;  /* from the origin of enu, in sides, rounded down */
    int32_t level; /* 0 .. clutter_levels - 1 */
} ClutterCell;

static inline double clutter_side(const ClutterGrid *grid, int level) { return grid->side_m * (double)(1 << level); }

/* Cells whose centres are in low <= x, y < high (m), so that neighbouring rectangles share none. Returns how many
 * there are; writes the first `capacity`. Corners within 2^30 sides of the origin.
 *   clutter_cells     of one level, row by row from the south-west
 *   clutter_cells_at  of the level that suits the distance in plan from a point: no side exceeds `share` of the
 *                     distance of its nearest corner or edge, but those of level 0. A cell's level depends on `from`
 *                     and `share` alone. Quarter by quarter in cells of the last level. share 0: all of level 0 */
size_t clutter_cells(ClutterCell *out, size_t capacity, const ClutterGrid *grid, int level, const double low_m[2],
                     const double high_m[2]);
size_t clutter_cells_at(ClutterCell *out, size_t capacity, const ClutterGrid *grid, const double low_m[2],
                        const double high_m[2], const double from_m[2], double share);

/* Centre of a cell; and where its scatterer is: even over the cell. m, in the plane. */
void clutter_centre(double p_m[2], const ClutterGrid *grid, const ClutterCell *cell);
void clutter_place(double p_m[2], const ClutterGrid *grid, const ClutterCell *cell);

/* A scatterer is the sum of a few terms. Each has a complex amplitude (their mean power at VV is 1 in all), an offset
 * of a few millimetres, which decorrelates the scatterer over aspect, and a velocity in units of the wind's spread. */
typedef struct ClutterScatterer {
    float vv[clutter_terms][2], hh[clutter_terms][2], hv[clutter_terms][2];
    float offset_m[clutter_terms][3];
    float velocity[clutter_terms - clutter_still_terms];
} ClutterScatterer;

/* Scatterers of cells of these classes. O(count), some 2 us each. */
void clutter_draw(ClutterScatterer *out, const ClutterGrid *grid, const ClutterTable *table, ClutterBand band,
                  int count, const ClutterCell *cell, const uint8_t *surface);

/* Where the scatterers are, on what ground. Slot i of every array is the same one; arrays are the caller's. */
typedef struct ClutterGround {
    int                count;
    const ClutterCell *cell;
    const uint8_t     *surface;  /* SurfaceClass */
    const double      *p_enu[3]; /* m: the place, on the ground */
    const float       *n_enu[3]; /* unit, up */
} ClutterGround;

typedef struct ClutterLook {
    double antenna_enu[3]; /* m; transmitter and receiver */
    double frequency_hz;   /* of the carrier, in a band of the table */
    double t_s;            /* exercise time */
    double wind_mps;
} ClutterLook;

/* Scattering matrices for one pulse, some 0.15 us each without wind and 0.3 with: <4 pi |S_vv|^2> = sigma0(psi)
 * side^2 / n_z, the cell's area along its slope; psi is between the line of sight and the ground there. 0 where the
 * ground faces away. S_hv = S_vh. Correlation in time: clutter_correlation; over a change of direction du, of one
 * scatterer: exp(-8 (pi |du| extent / lambda)^2). */
void clutter_see(ScatterMatrix *out, const ClutterGrid *grid, const ClutterTable *table,
                 const ClutterScatterer *scatterer, const ClutterGround *ground, const ClutterLook *look);

/* These two draw a scatterer of a crown (foliage.h) by its number, and compute what it returns, as above but without
 * texture or slope: <4 pi |S_vv|^2> = sigma_m2. The caller knows its place. */
void clutter_draw_leaf(ClutterScatterer *out, const ClutterRow *row, uint64_t seed, uint32_t crown, uint32_t number);
void clutter_see_leaf(ScatterMatrix *out, const ClutterScatterer *scatterer, const ClutterMotion *motion,
                      double sigma_m2, const double p_enu[3], const ClutterLook *look);

/* Texture at a place, mean 1: what multiplies the mean power of a cell of this level there. */
double clutter_texture_at(const ClutterGrid *grid, const ClutterRow *row, int level, const double p_m[2]);

/* ---- scatterers kept ---------------------------------------------------------------------------- */

/* The ground's scatterers are kept from frame to frame: drawing one costs some 2 us, finding it again 0.1 us. They are
 * functions of their cells, so what is kept changes no bit. 36 MB for 131072. */
typedef struct ClutterCache ClutterCache;

/* What scatterers are drawn of. */
typedef struct ClutterKind {
    const ClutterGrid  *grid;
    const ClutterTable *table;
    ClutterBand         band;
} ClutterKind;

/* A cache is for one kind. */
Status clutter_cache_create(ClutterCache **out);
void   clutter_cache_destroy(ClutterCache *cache); /* accepts NULL */
/* Does what clutter_draw does, but takes from the cache what was drawn before. cache NULL: draws all. Any number of
 * threads may call it. */
void clutter_cache_draw(ClutterScatterer *out, ClutterCache *cache, const ClutterKind *kind, int count,
                        const ClutterCell *cell, const uint8_t *surface);

#endif
