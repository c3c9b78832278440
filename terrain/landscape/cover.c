/* terrain/landscape/cover.c: land cover. Synthetic: irregular fields, tracks and hedges between some of them, scrub and
 * rock on steep or uncultivated ground. Real: the land cover files, else the same in the lowlands and woods on the
 * slopes. Pure functions of the position, eight positions at once. */
#include "terrain/landscape/landscape_eight_private.h"

#include <stdlib.h>
#include <sys/mman.h>

/* ---- slope ---------------------------------------------------------------------------------- */

static const double arm_m = 10;

/* Slope over some 20 m, so that what grows does not follow the edges of single triangles. 0 at the very rim. */
static double slope_about(const Elevation *elevation, double x_m, double y_m)
{
    const double dx =
        elevation_height(elevation, x_m + arm_m, y_m, NULL) - elevation_height(elevation, x_m - arm_m, y_m, NULL);
    const double dy =
        elevation_height(elevation, x_m, y_m + arm_m, NULL) - elevation_height(elevation, x_m, y_m - arm_m, NULL);
    const double slope = sqrt(dx * dx + dy * dy) / (2 * arm_m);
    return isfinite(slope) ? slope : 0;
}

/* Places in a level's own cells; far off and NaN: outside. */
static Lattice level_cells(const double x_m[8], double x0_m, double per_m)
{
    const F64x4 x0 = f64x4_set(x0_m), most = f64x4_set(1 << 20), least = f64x4_set(-(1 << 20));
    double        cells[8];
    for (int k = 0; k < 8; k += 4) {
        const F64x4 g = (f64x4_loadu(x_m + k) - x0) * f64x4_set(per_m);
        f64x4_storeu(cells + k, f64x4_min(f64x4_max(g, least), most));
    }
    return lattice_of(cells, 1);
}

/* Moved by some of a cell. */
static Lattice moved(Lattice at, F32x8 by)
{
    const F32x8 share = at.share + by, whole = f32x8_floor(share);
    return (Lattice){i32x8_add(at.cell, i32x8_truncate(whole)), share - whole};
}

/* Tiles of lanes within the level's cells. */
static I32x8 tiles_of(const ElevationLevel *level, Lattice x, Lattice y)
{
    enum { bits = 6 };
    _Static_assert(elevation_tile_cells == 1 << bits, "cells to tiles by shifts");
    return i32x8_add(i32x8_mul(i32x8_shift_right(y.cell, bits), i32x8_set(level->tiles_x)),
                     i32x8_shift_right(x.cell, bits));
}

/* One of the two values of each lane's tile. */
static I32x8 of_tiles(const int32_t *value, I32x8 tile, I32x8 mask)
{
    return _mm256_mask_i32gather_epi32(i32x8_set(0), value, tile, mask, sizeof(ElevationTile));
}

/* Heights above `about` in the level's own steps, of lanes within its cells. Two posts of a row take one load;
 * differences are formed of whole steps. */
static F32x8 level_heights(const ElevationLevel *level, Lattice x, Lattice y, F32x8 lanes, I32x8 about)
{
    const I32x8 post = i32x8_set(0xffff), none = i32x8_set(0), mask = _mm256_castps_si256(lanes);
    const I32x8 inside = i32x8_set(elevation_tile_cells - 1), tile = tiles_of(level, x, y);
    const I32x8 row = i32x8_mul(i32x8_and(y.cell, inside), i32x8_set(elevation_tile_side));
    const I32x8 at = i32x8_add(i32x8_mul(tile, i32x8_set(elevation_tile_posts)),
                               i32x8_add(row, i32x8_and(x.cell, inside)));
    const uint16_t *north_of = level->stored + elevation_tile_side;
    const I32x8 south = _mm256_mask_i32gather_epi32(none, (const int *)(const void *)level->stored, at, mask, 2);
    const I32x8 north = _mm256_mask_i32gather_epi32(none, (const int *)(const void *)north_of, at, mask, 2);
    I32x8       sw = i32x8_and(south, post), se = i32x8_shift_right(south, 16);
    I32x8       nw = i32x8_and(north, post), ne = i32x8_shift_right(north, 16);
    if (!level->plain) {
        const I32x8 base = i32x8_sub(of_tiles(&level->tile->base, tile, mask), about);
        const I32x8 shift = of_tiles(&level->tile->shift, tile, mask);
        sw = i32x8_add(base, _mm256_sllv_epi32(sw, shift)), se = i32x8_add(base, _mm256_sllv_epi32(se, shift));
        nw = i32x8_add(base, _mm256_sllv_epi32(nw, shift)), ne = i32x8_add(base, _mm256_sllv_epi32(ne, shift));
    }
    const F32x8 east_s = f32x8_of_ints(i32x8_sub(se, sw)), north_s = f32x8_of_ints(i32x8_sub(ne, se));
    const F32x8 east_n = f32x8_of_ints(i32x8_sub(ne, nw)), north_n = f32x8_of_ints(i32x8_sub(nw, sw));
    const F32x8 south_east = f32x8_fma(x.share, east_s, y.share * north_s);
    const F32x8 north_west = f32x8_fma(x.share, east_n, y.share * north_n);
    return f32x8_of_ints(sw) + f32x8_select(f32x8_less(x.share, y.share), north_west, south_east);
}

/* Slope about eight places, of those whose arms end on one level together; the others' are evaluated one by one. Within
 * 1e-5 of slope_about. */
static F32x8 slopes_about(const Elevation *elevation, const double x_m[8], const double y_m[8], unsigned lanes)
{
    const I32x8 outside = i32x8_set(-1);
    F32x8          slope = f32x8_set(0);
    unsigned       left = lanes, alone = 0; /* not yet found; on the seam of two levels */
    for (int n = 0; n < elevation->level_count && left; n++) {
        const ElevationLevel *level = &elevation->level[n];
        const double          per_m = 1 / level->spacing_m;
        const F32x8           arm = f32x8_set(arm_m * per_m), back = f32x8_set(-arm_m * per_m);
        const Lattice         x = level_cells(x_m, level->x0_m, per_m), y = level_cells(y_m, level->y0_m, per_m);
        const Lattice         west = moved(x, back), east = moved(x, arm);
        const Lattice         south = moved(y, back), north = moved(y, arm);
        const I32x8        nx = i32x8_set(level->nx), ny = i32x8_set(level->ny), one = i32x8_set(1);
        /* cells 0 .. n - 2; about them and the outline */
        F32x8 in = f32x8_and(i32x8_greater(west.cell, outside), i32x8_greater(south.cell, outside));
        in = f32x8_and(in, i32x8_greater(i32x8_sub(nx, one), east.cell));
        in = f32x8_and(in, i32x8_greater(i32x8_sub(ny, one), north.cell));
        F32x8 by = f32x8_and(i32x8_greater(east.cell, i32x8_set(-2)), i32x8_greater(north.cell, i32x8_set(-2)));
        by = f32x8_and(by, i32x8_greater(nx, west.cell));
        by = f32x8_and(by, i32x8_greater(ny, south.cell));
        const unsigned here = f32x8_bits(in) & left;
        const unsigned near = f32x8_bits(by) & left;
        alone |= near & ~here;
        left &= ~(near | here);
        if (!here) continue;
        const F32x8 found = f32x8_mask(here);
        const I32x8 about = level->plain ? i32x8_set(0) : of_tiles(&level->tile->base, tiles_of(level, x, y),
                                                                   _mm256_castps_si256(found));
        const F32x8 dx =
            level_heights(level, east, y, found, about) - level_heights(level, west, y, found, about);
        const F32x8 dy =
            level_heights(level, x, north, found, about) - level_heights(level, x, south, found, about);
        const F32x8 rise = f32x8_sqrt(f32x8_fma(dx, dx, dy * dy)) * f32x8_set(level->step_m / (2 * arm_m));
        slope = f32x8_select(found, rise, slope);
    }
    if (alone) {
        float one[8];
        f32x8_store(one, slope);
        for (; alone; alone &= alone - 1) {
            const int k = __builtin_ctz(alone);
            one[k] = (float)slope_about(elevation, x_m[k], y_m[k]);
        }
        slope = f32x8_load(one);
    }
    return slope;
}

/* Beyond some tens of kilometres the tilt of the plane itself would count as a slope; it is not visible there. */
static F32x8 slopes_of_terrain(const Elevation *elevation, const double x_m[8], const double y_m[8], unsigned lanes)
{
    const F32x8 x = f32x8_of_doubles(x_m), y = f32x8_of_doubles(y_m);
    const F32x8 lean = f32x8_sqrt(f32x8_fma(x, x, y * y)) * f32x8_set(1 / 6371e3);
    return f32x8_max(slopes_about(elevation, x_m, y_m, lanes) - lean, f32x8_set(0));
}

/* ---- synthetic cover ------------------------------------------------------------------------ */

static const double track_half_m = 2, hedge_half_m = 1.5;

/* Cover on the border of two fields, at a position near one; SURFACE_NONE: nothing. */
static SurfaceClass border_surface(const PlotCell *cell, uint64_t seed, int site, float x_m, float y_m, bool scrubby)
{
    double       near[plot_sites], border_m = INFINITY;
    uint64_t     border = 0;
    for (int n = 0; n < plot_sites; n++) {
        const double dx = (double)(x_m - cell->x_m[n]), dy = (double)(y_m - cell->y_m[n]);
        near[n] = dx * dx + dy * dy;
    }
    for (int n = 0; n < plot_sites; n++) {
        if (cell->field[n] == cell->field[site]) continue;
        /* distance to the perpendicular bisector */
        const double dx = (double)(cell->x_m[n] - cell->x_m[site]), dy = (double)(cell->y_m[n] - cell->y_m[site]);
        const double apart_m = sqrt(dx * dx + dy * dy), here_m = 0.5 * (near[n] - near[site]) / fmax(apart_m, 1e-3);
        if (here_m >= border_m) continue;
        border_m = here_m;
        border = landscape_hash(seed + 6, (int64_t)(cell->id[n] ^ cell->id[site]), 0);
    }
    if (border_m < track_half_m && unit_from_hash(border) < 0.24) return SURFACE_TRACK;
    if (scrubby || (border_m < hedge_half_m && unit_from_hash(border) > 0.66)) return SURFACE_SCRUB;
    return SURFACE_NONE;
}

/* Lanes within reach of a border to another field than their own. */
static unsigned near_border(const PlotCell *cell, F32x8 x, F32x8 y, I32x8 site, F32x8 least)
{
    const F32x8    own_x = f32x8_gather(cell->x_m, site), own_y = f32x8_gather(cell->y_m, site);
    const I32x8 own = plot_look(cell->field, site);
    const F32x8    reach = f32x8_set(track_half_m * track_half_m * 1.01); /* squared: no root; margin for rounding */
    F32x8          near = f32x8_set(0);
    for (int n = 0; n < plot_sites; n++) {
        const F32x8 sx = f32x8_set((double)cell->x_m[n]), sy = f32x8_set((double)cell->y_m[n]);
        const F32x8 dx = x - sx, dy = y - sy, ax = sx - own_x, ay = sy - own_y;
        const F32x8 more = f32x8_fma(dx, dx, dy * dy) - least, apart = f32x8_fma(ax, ax, ay * ay);
        const F32x8 same = i32x8_equal(own, i32x8_set(cell->field[n]));
        near = f32x8_or(near, f32x8_and_not(f32x8_less(more * more, reach * f32x8_set(4) * apart), same));
    }
    return f32x8_bits(near);
}

static void invented_surfaces(int32_t surface[8], const Cover *cover, PlotCells *cells, const double x_m[8],
                              const double y_m[8], F32x8 slope, unsigned lanes)
{
    const uint64_t seed = cover->seed;
    /* wild patches, wider where it is steep; rock shows through in their hearts */
    F32x8 wild = noise_eight(seed + 10, 310, x_m, y_m);
    wild = f32x8_fma(f32x8_set(0.5), noise_eight(seed + 11, 83, x_m, y_m), wild);
    wild = f32x8_fma(f32x8_set(0.2), noise_eight(seed + 12, 17, x_m, y_m), wild);
    wild = f32x8_fma(f32x8_set(4), slope, wild);
    const F32x8 rock = f32x8_greater(wild, f32x8_set(1.24) - f32x8_set(0.12) * f32x8_clamp(slope * f32x8_set(5), 0, 1));
    const F32x8    scrub = f32x8_greater(wild, f32x8_set(0.88)), dry = f32x8_greater(wild, f32x8_set(0.78));
    const unsigned is_rock = f32x8_bits(rock), is_scrub = f32x8_bits(scrub);

    double   i[8], j[8];
    float    in_x[8], in_y[8];
    int32_t  site_of[8];
    F32x8    x, y;
    I32x8 class = i32x8_set(SURFACE_NONE);
    plot_cells_of(i, j, &x, &y, x_m, y_m);
    SurfaceClass on_border[8];
    unsigned     bordered = 0;
    for (unsigned left = lanes, same; left; left &= ~same) {
        same = plot_cell_lanes(i, j, left);
        const int       first = __builtin_ctz(left);
        const PlotCell *cell = plot_cell_at(cells, seed, (int64_t)i[first], (int64_t)j[first]);
        I32x8        site;
        const F32x8     least = plot_nearest(&site, cell, x, y);
        class = i32x8_select(f32x8_mask(same), plot_look(cell->crop, site), class);
        unsigned near = near_border(cell, x, y, site, least) & same & ~is_rock;
        if (!near) continue;
        i32x8_store(site_of, site);
        f32x8_store(in_x, x), f32x8_store(in_y, y);
        for (; near; near &= near - 1) {
            const int k = __builtin_ctz(near);
            on_border[k] = border_surface(cell, seed, site_of[k], in_x[k], in_y[k], is_scrub >> k & 1);
            if (on_border[k] != SURFACE_NONE) bordered |= 1u << k;
        }
    }
    class = i32x8_select(dry, i32x8_set(SURFACE_DRY_GRASS), class);
    class = i32x8_select(scrub, i32x8_set(SURFACE_SCRUB), class);
    class = i32x8_select(rock, i32x8_set(SURFACE_ROCK), class);
    int32_t found[8];
    i32x8_store(found, class);
    for (; bordered; bordered &= bordered - 1)
        found[__builtin_ctz(bordered)] = (int32_t)on_border[__builtin_ctz(bordered)];
    for (int k = 0; k < 8; k++)
        if (lanes >> k & 1) surface[k] = found[k];
}

/* ---- real cover ----------------------------------------------------------------------------- */

/* Elevation files without cover: woods on slopes too steep for the plough and below the tree line, fields in the
 * lowlands, rock where it is steeper than soil stays (40 degrees), the sea where it is flat at its level. SURFACE_NONE:
 * as synthetic. */
static SurfaceClass unmapped_surface(const Cover *cover, double x_m, double y_m, double z_m, double slope,
                                     double patchy, double woods)
{
    const double far_m = sqrt(x_m * x_m + y_m * y_m);
    double       ellipsoid_m, dz_per_h;
    curve_at(&cover->curve, x_m, y_m, &ellipsoid_m, &dz_per_h);
    const double h_msl_m = (z_m - ellipsoid_m) / dz_per_h - cover->geoid_m;
    if (fabs(h_msl_m) < 1 + 5e-5 * far_m && slope < 0.002) return SURFACE_WATER; /* the geoid tilts by so much */
    if (slope + 0.12 * patchy > 0.84) return SURFACE_ROCK;
    const double above_m = h_msl_m - cover->treeline_m + 150 * patchy;
    if (above_m > 700) return SURFACE_ROCK;
    if (above_m > 0) return patchy > 0.4 ? SURFACE_ROCK : SURFACE_DRY_GRASS;
    if (slope + 0.08 * patchy > 0.16) {
        if (patchy < -0.75) return SURFACE_DRY_GRASS;
        if (patchy < -0.5) return SURFACE_SCRUB;
        return above_m > -1200 + 500 * woods ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF;
    }
    return SURFACE_NONE;
}

/* Land cover from the files; fills those lanes and returns the others. */
static unsigned mapped_surfaces(int32_t surface[8], const Cover *cover, const double x_m[8], const double y_m[8],
                                unsigned lanes)
{
    if (!cover->grid[0].surface && !cover->grid[1].surface) return lanes;
    /* borders of coarse cells wander by half a cell, as real borders have no steps of 30 m */
    const double cell_m = cover->grid[0].cell_m, away_m = cell_m >= 5 ? 0.5 * cell_m : 0;
    F32x8        dx = f32x8_set(0), dy = f32x8_set(0);
    for (int octave = 0; away_m > 0 && octave < 3; octave++) {
        const double wave_m = cell_m * exp2(-octave);
        const F32x8  share = f32x8_set(away_m * 0.57 * exp2(-octave));
        dx = f32x8_fma(share, noise_eight(cover->seed + 40 + (uint64_t)octave, wave_m, x_m, y_m), dx);
        dy = f32x8_fma(share, noise_eight(cover->seed + 50 + (uint64_t)octave, wave_m, x_m, y_m), dy);
    }
    float    off_x[8], off_y[8];
    unsigned none = 0;
    f32x8_store(off_x, dx), f32x8_store(off_y, dy);
    for (int k = 0; k < 8; k++) {
        if (!(lanes >> k & 1)) continue;
        surface[k] = (int32_t)cover_grid_at(cover->grid, x_m[k] + (double)off_x[k], y_m[k] + (double)off_y[k]);
        if (surface[k] == SURFACE_NONE) none |= 1u << k;
    }
    return none;
}

static void real_surfaces(int32_t surface[8], const Landscape *landscape, PlotCells *cells, const double x_m[8],
                          const double y_m[8], unsigned lanes)
{
    const Cover   *cover = landscape->cover;
    const uint64_t seed = cover->seed;
    lanes = mapped_surfaces(surface, cover, x_m, y_m, lanes);
    if (!lanes) return;
    const F32x8 slopes = slopes_of_terrain(&landscape->elevation, x_m, y_m, lanes);
    F32x8       patches = noise_eight(seed + 14, 700, x_m, y_m);
    patches = f32x8_fma(f32x8_set(0.6), noise_eight(seed + 15, 190, x_m, y_m), patches);
    patches = f32x8_fma(f32x8_set(0.3), noise_eight(seed + 16, 41, x_m, y_m), patches);
    float    slope[8], patchy[8], woods[8];
    unsigned invented = 0;
    f32x8_store(slope, slopes), f32x8_store(patchy, patches);
    f32x8_store(woods, noise_eight(seed + 17, 2300, x_m, y_m));
    for (int k = 0; k < 8; k++) {
        if (!(lanes >> k & 1)) continue;
        const double z_m = elevation_height(&landscape->elevation, x_m[k], y_m[k], NULL);
        surface[k] = (int32_t)unmapped_surface(cover, x_m[k], y_m[k], z_m, (double)slope[k], (double)patchy[k],
                                               (double)woods[k]);
        if (surface[k] == SURFACE_NONE) invented |= 1u << k;
    }
    if (invented) invented_surfaces(surface, cover, cells, x_m, y_m, slopes, invented);
}

/* ---- both ----------------------------------------------------------------------------------- */

/* Fills lanes of the sea and its beaches; returns the others. */
static unsigned coast_surfaces(int32_t surface[8], const Coast *coast, const double x_m[8], const double y_m[8],
                               unsigned lanes)
{
    for (unsigned left = lanes; left; left &= left - 1) {
        const int       k = __builtin_ctz(left);
        const CoastKind kind = coast_at(coast, x_m[k], y_m[k]);
        if (kind == COAST_LAND) continue;
        surface[k] = kind == COAST_SEA ? SURFACE_WATER : SURFACE_SAND;
        lanes &= ~(1u << k);
    }
    return lanes;
}

/* Lanes where there is ground: the outermost level encloses the others. NaN: none. */
static unsigned grounded(const Elevation *elevation, const double x_m[8], const double y_m[8])
{
    if (elevation->level_count == 0) return 0;
    const ElevationLevel *level = &elevation->level[elevation->level_count - 1];
    const double          per_m = 1 / level->spacing_m, nx = level->nx - 1, ny = level->ny - 1;
    unsigned              lanes = 0;
    for (int k = 0; k < 8; k++) {
        const double fx = (x_m[k] - level->x0_m) * per_m, fy = (y_m[k] - level->y0_m) * per_m;
        lanes |= (unsigned)((fx >= 0) & (fy >= 0) & (fx <= nx) & (fy <= ny)) << k;
    }
    return lanes;
}

void landscape_surfaces(uint8_t *surface, const Landscape *landscape, int count, const double *x_m, const double *y_m)
{
    const Cover *cover = landscape->cover;
    PlotCells    cells;
    for (int k = 0; k < plot_cells_kept; k++) cells.cell[k].known = false;
    for (int first = 0; first < count; first += 8) {
        double    x[8], y[8];
        int32_t   found[8] = {0};
        const int some = count - first < 8 ? count - first : 8;
        for (int k = 0; k < 8; k++) x[k] = k < some ? x_m[first + k] : NAN, y[k] = k < some ? y_m[first + k] : NAN;
        unsigned lanes = cover ? grounded(&landscape->elevation, x, y) : 0;
        if (lanes && cover->coast.sea_count) lanes = coast_surfaces(found, &cover->coast, x, y, lanes);
        if (lanes && cover->real)
            real_surfaces(found, landscape, &cells, x, y, lanes);
        else if (lanes)
            invented_surfaces(found, cover, &cells, x, y, slopes_of_terrain(&landscape->elevation, x, y, lanes), lanes);
        for (int k = 0; k < some; k++) surface[first + k] = (uint8_t)found[k];
    }
}

SurfaceClass landscape_surface(const Landscape *landscape, double x_m, double y_m)
{
    uint8_t surface;
    landscape_surfaces(&surface, landscape, 1, &x_m, &y_m);
    return (SurfaceClass)surface;
}

void cover_free(Cover *cover)
{
    if (!cover) return;
    cover_grid_free(cover->grid);
    photo_free(&cover->photo);
    coast_destroy(&cover->coast);
    if (cover->store.map) munmap(cover->store.map, cover->store.octets);
    free(cover->store.path);
    free(cover);
}
