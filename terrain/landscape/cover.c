/* terrain/landscape/cover.c: what grows and lies on the ground. Invented: irregular fields, tracks and hedges between
 * some of them, scrub and rock where it is steep or nobody ploughs. Real: what the cover files say, else the same in
 * the lowlands and woods on the slopes. Pure functions of the place, eight places at once. */
#include "terrain/landscape/landscape_eight_private.h"

#include <stdlib.h>

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
    const __m256d x0 = _mm256_set1_pd(x0_m), most = _mm256_set1_pd(1 << 20), least = _mm256_set1_pd(-(1 << 20));
    double        cells[8];
    for (int k = 0; k < 8; k += 4) {
        const __m256d g = (_mm256_loadu_pd(x_m + k) - x0) * _mm256_set1_pd(per_m);
        _mm256_storeu_pd(cells + k, _mm256_min_pd(_mm256_max_pd(g, least), most));
    }
    return lattice_of(cells, 1);
}

/* Moved by some of a cell. */
static Lattice moved(Lattice at, Eight by)
{
    const Eight share = at.share + by, whole = eight_floor(share);
    return (Lattice){_mm256_add_epi32(at.cell, eight_to_ints(whole)), share - whole};
}

/* Heights in the level's own steps, of lanes that lie in one of its cells. Two posts of a row come with one look. */
static Eight level_heights(const ElevationLevel *level, Lattice x, Lattice y, Eight lanes)
{
    const EightInt post = _mm256_set1_epi32(0xffff), none = eight_int(0), mask = _mm256_castps_si256(lanes);
    const EightInt at = _mm256_add_epi32(_mm256_mullo_epi32(y.cell, eight_int(level->nx)), x.cell);
    const EightInt south = _mm256_mask_i32gather_epi32(none, (const int *)(const void *)level->post, at, mask, 2);
    const EightInt north = _mm256_mask_i32gather_epi32(none, (const int *)(const void *)(level->post + level->nx), at,
                                                       mask, 2);
    const Eight    sw = eight_of_ints(_mm256_and_si256(south, post)), se = eight_of_ints(_mm256_srli_epi32(south, 16));
    const Eight    nw = eight_of_ints(_mm256_and_si256(north, post)), ne = eight_of_ints(_mm256_srli_epi32(north, 16));
    const Eight    south_east = eight_fma(x.share, se - sw, y.share * (ne - se));
    const Eight    north_west = eight_fma(x.share, ne - nw, y.share * (nw - sw));
    return sw + eight_pick(eight_less(x.share, y.share), north_west, south_east);
}

/* Slope about eight places, of those whose arms end on one level together; the others' are asked for one by one. Within
 * 1e-5 of slope_about. */
static Eight slopes_about(const Elevation *elevation, const double x_m[8], const double y_m[8], unsigned lanes)
{
    const EightInt outside = eight_int(-1);
    Eight          slope = eight_all(0);
    unsigned       left = lanes, alone = 0; /* not yet found; on the seam of two levels */
    for (int n = 0; n < elevation->level_count && left; n++) {
        const ElevationLevel *level = &elevation->level[n];
        const double          per_m = 1 / level->spacing_m;
        const Eight           arm = eight_all(arm_m * per_m), back = eight_all(-arm_m * per_m);
        const Lattice         x = level_cells(x_m, level->x0_m, per_m), y = level_cells(y_m, level->y0_m, per_m);
        const Lattice         west = moved(x, back), east = moved(x, arm);
        const Lattice         south = moved(y, back), north = moved(y, arm);
        const EightInt        nx = eight_int(level->nx), ny = eight_int(level->ny), one = eight_int(1);
        /* cells 0 .. n - 2; about them and the outline */
        EightInt in = _mm256_and_si256(_mm256_cmpgt_epi32(west.cell, outside), _mm256_cmpgt_epi32(south.cell, outside));
        in = _mm256_and_si256(in, _mm256_cmpgt_epi32(_mm256_sub_epi32(nx, one), east.cell));
        in = _mm256_and_si256(in, _mm256_cmpgt_epi32(_mm256_sub_epi32(ny, one), north.cell));
        EightInt by = _mm256_and_si256(_mm256_cmpgt_epi32(east.cell, eight_int(-2)),
                                       _mm256_cmpgt_epi32(north.cell, eight_int(-2)));
        by = _mm256_and_si256(by, _mm256_cmpgt_epi32(nx, west.cell));
        by = _mm256_and_si256(by, _mm256_cmpgt_epi32(ny, south.cell));
        const unsigned here = eight_bits(_mm256_castsi256_ps(in)) & left;
        const unsigned near = eight_bits(_mm256_castsi256_ps(by)) & left;
        alone |= near & ~here;
        left &= ~(near | here);
        if (!here) continue;
        const Eight found = eight_mask(here);
        const Eight dx = level_heights(level, east, y, found) - level_heights(level, west, y, found);
        const Eight dy = level_heights(level, x, north, found) - level_heights(level, x, south, found);
        const Eight rise = eight_sqrt(eight_fma(dx, dx, dy * dy)) * eight_all(level->step_m / (2 * arm_m));
        slope = eight_pick(found, rise, slope);
    }
    if (alone) {
        float one[8];
        eight_store(one, slope);
        for (; alone; alone &= alone - 1) {
            const int k = __builtin_ctz(alone);
            one[k] = (float)slope_about(elevation, x_m[k], y_m[k]);
        }
        slope = eight_load(one);
    }
    return slope;
}

/* Beyond some tens of kilometres the tilt of the plane itself would count as a slope; nobody sees it there. */
static Eight slopes_of_country(const Elevation *elevation, const double x_m[8], const double y_m[8], unsigned lanes)
{
    const Eight x = eight_of_doubles(x_m), y = eight_of_doubles(y_m);
    const Eight lean = eight_sqrt(eight_fma(x, x, y * y)) * eight_all(1 / 6371e3);
    return eight_max(slopes_about(elevation, x_m, y_m, lanes) - lean, eight_all(0));
}

/* ---- invented cover ------------------------------------------------------------------------- */

static const double track_half_m = 2, hedge_half_m = 1.5;

/* What stands on the border of two fields, at a place near one; SURFACE_NONE: nothing. */
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
static unsigned near_border(const PlotCell *cell, Eight x, Eight y, EightInt site, Eight least)
{
    const Eight    own_x = eight_gather(cell->x_m, site), own_y = eight_gather(cell->y_m, site);
    const EightInt own = plot_look(cell->field, site);
    const Eight    reach = eight_all(track_half_m * track_half_m * 1.01); /* squared: no root; room for rounding */
    Eight          near = eight_all(0);
    for (int n = 0; n < plot_sites; n++) {
        const Eight sx = _mm256_set1_ps(cell->x_m[n]), sy = _mm256_set1_ps(cell->y_m[n]);
        const Eight dx = x - sx, dy = y - sy, ax = sx - own_x, ay = sy - own_y;
        const Eight more = eight_fma(dx, dx, dy * dy) - least, apart = eight_fma(ax, ax, ay * ay);
        const Eight same = _mm256_castsi256_ps(_mm256_cmpeq_epi32(own, eight_int(cell->field[n])));
        near = eight_or(near, eight_but(eight_less(more * more, reach * eight_all(4) * apart), same));
    }
    return eight_bits(near);
}

static void invented_surfaces(int32_t surface[8], const Cover *cover, PlotCells *cells, const double x_m[8],
                              const double y_m[8], Eight slope, unsigned lanes)
{
    const uint64_t seed = cover->seed;
    /* wild patches, wider where it is steep; rock shows through in their hearts */
    Eight wild = noise_eight(seed + 10, 310, x_m, y_m);
    wild = eight_fma(eight_all(0.5), noise_eight(seed + 11, 83, x_m, y_m), wild);
    wild = eight_fma(eight_all(0.2), noise_eight(seed + 12, 17, x_m, y_m), wild);
    wild = eight_fma(eight_all(4), slope, wild);
    const Eight    rock = eight_more(wild, eight_all(1.24) - eight_all(0.12) * eight_clamp(slope * eight_all(5), 0, 1));
    const Eight    scrub = eight_more(wild, eight_all(0.88)), dry = eight_more(wild, eight_all(0.78));
    const unsigned is_rock = eight_bits(rock), is_scrub = eight_bits(scrub);

    double   i[8], j[8];
    float    in_x[8], in_y[8];
    int32_t  site_of[8];
    Eight    x, y;
    EightInt class = eight_int(SURFACE_NONE);
    plot_cells_of(i, j, &x, &y, x_m, y_m);
    SurfaceClass on_border[8];
    unsigned     bordered = 0;
    for (unsigned left = lanes, same; left; left &= ~same) {
        same = plot_cell_lanes(i, j, left);
        const int       first = __builtin_ctz(left);
        const PlotCell *cell = plot_cell_at(cells, seed, (int64_t)i[first], (int64_t)j[first]);
        EightInt        site;
        const Eight     least = plot_nearest(&site, cell, x, y);
        class = _mm256_blendv_epi8(class, plot_look(cell->crop, site), _mm256_castps_si256(eight_mask(same)));
        unsigned near = near_border(cell, x, y, site, least) & same & ~is_rock;
        if (!near) continue;
        _mm256_storeu_si256((EightInt *)site_of, site);
        eight_store(in_x, x), eight_store(in_y, y);
        for (; near; near &= near - 1) {
            const int k = __builtin_ctz(near);
            on_border[k] = border_surface(cell, seed, site_of[k], in_x[k], in_y[k], is_scrub >> k & 1);
            if (on_border[k] != SURFACE_NONE) bordered |= 1u << k;
        }
    }
    class = _mm256_blendv_epi8(class, eight_int(SURFACE_DRY_GRASS), _mm256_castps_si256(dry));
    class = _mm256_blendv_epi8(class, eight_int(SURFACE_SCRUB), _mm256_castps_si256(scrub));
    class = _mm256_blendv_epi8(class, eight_int(SURFACE_ROCK), _mm256_castps_si256(rock));
    int32_t found[8];
    _mm256_storeu_si256((EightInt *)found, class);
    for (; bordered; bordered &= bordered - 1)
        found[__builtin_ctz(bordered)] = (int32_t)on_border[__builtin_ctz(bordered)];
    for (int k = 0; k < 8; k++)
        if (lanes >> k & 1) surface[k] = found[k];
}

/* ---- real cover ----------------------------------------------------------------------------- */

/* Elevation files without cover: woods on slopes too steep for the plough and below the tree line, fields in the
 * lowlands, rock where it is steeper than soil stays (40 degrees), the sea where it is flat at its level. SURFACE_NONE:
 * as invented. */
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

/* What the cover files say; fills those lanes and returns the others. */
static unsigned mapped_surfaces(int32_t surface[8], const Cover *cover, const double x_m[8], const double y_m[8],
                                unsigned lanes)
{
    if (!cover->grid[0].surface && !cover->grid[1].surface) return lanes;
    /* borders of coarse cells wander by half a cell, as nothing in the country runs in stairs of 30 m */
    const double cell_m = cover->grid[0].cell_m, away_m = cell_m >= 5 ? 0.5 * cell_m : 0;
    Eight        dx = eight_all(0), dy = eight_all(0);
    for (int octave = 0; away_m > 0 && octave < 3; octave++) {
        const double wave_m = cell_m * exp2(-octave);
        const Eight  share = eight_all(away_m * 0.57 * exp2(-octave));
        dx = eight_fma(share, noise_eight(cover->seed + 40 + (uint64_t)octave, wave_m, x_m, y_m), dx);
        dy = eight_fma(share, noise_eight(cover->seed + 50 + (uint64_t)octave, wave_m, x_m, y_m), dy);
    }
    float    off_x[8], off_y[8];
    unsigned none = 0;
    eight_store(off_x, dx), eight_store(off_y, dy);
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
    const Eight slopes = slopes_of_country(&landscape->elevation, x_m, y_m, lanes);
    Eight       patches = noise_eight(seed + 14, 700, x_m, y_m);
    patches = eight_fma(eight_all(0.6), noise_eight(seed + 15, 190, x_m, y_m), patches);
    patches = eight_fma(eight_all(0.3), noise_eight(seed + 16, 41, x_m, y_m), patches);
    float    slope[8], patchy[8], woods[8];
    unsigned invented = 0;
    eight_store(slope, slopes), eight_store(patchy, patches);
    eight_store(woods, noise_eight(seed + 17, 2300, x_m, y_m));
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
            invented_surfaces(found, cover, &cells, x, y, slopes_of_country(&landscape->elevation, x, y, lanes), lanes);
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
    free(cover);
}
