/* terrain/invented/invented_cover.c: the invented land cover: irregular fields, tracks and hedges between some of
 * them, scrub and rock on steep or uncultivated ground, wet grass in hollows; over them roads, streams and villages
 * (ways.c). A pure function of the position, eight positions at once. */
#include "terrain/invented/invented_eight.h"

#include "terrain/invented/ways_private.h"

unsigned invented_grounded(const Elevation *elevation, const double x_m[8], const double y_m[8])
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

/* ---- slope ---------------------------------------------------------------------------------- */

static const double arm_m = invented_arm_m;

/* Slope over some 20 m, so that the cover does not follow the edges of single triangles; 0 at the very rim. */
static double slope_about(const Elevation *elevation, double x_m, double y_m)
{
    const double dx =
        elevation_height(elevation, x_m + arm_m, y_m, NULL) - elevation_height(elevation, x_m - arm_m, y_m, NULL);
    const double dy =
        elevation_height(elevation, x_m, y_m + arm_m, NULL) - elevation_height(elevation, x_m, y_m - arm_m, NULL);
    const double slope = sqrt(dx * dx + dy * dy) / (2 * arm_m);
    return isfinite(slope) ? slope : 0;
}

/* Converts coordinates to cells of a level; places outside of it, and NaN, become cells far off. */
static Lattice level_cells(const double x_m[8], double x0_m, double per_m)
{
    const F64x4 x0 = f64x4_set(x0_m), most = f64x4_set(1 << 20), least = f64x4_set(-(1 << 20));
    double      cells[8];
    for (int k = 0; k < 8; k += 4) {
        const F64x4 g = (f64x4_loadu(x_m + k) - x0) * f64x4_set(per_m);
        f64x4_storeu(cells + k, f64x4_min(f64x4_max(g, least), most));
    }
    return lattice_of(cells, 1);
}

/* Coordinates moved by part of a cell. */
static Lattice moved(Lattice at, F32x8 by)
{
    const F32x8 share = at.share + by, whole = f32x8_floor(share);
    return (Lattice){i32x8_add(at.cell, i32x8_truncate(whole)), share - whole};
}

/* The tile of each lane; its cell is within the level. */
static I32x8 tiles_of(const ElevationLevel *level, Lattice x, Lattice y)
{
    enum { bits = 6 };
    _Static_assert(elevation_tile_cells == 1 << bits, "cells to tiles by shifts");
    return i32x8_add(i32x8_mul(i32x8_shift_right(y.cell, bits), i32x8_set(level->tiles_x)),
                     i32x8_shift_right(x.cell, bits));
}

/* For each lane, one of the two values of its tile. */
static I32x8 of_tiles(const int32_t *value, I32x8 tile, I32x8 mask)
{
    return _mm256_mask_i32gather_epi32(i32x8_set(0), value, tile, mask, sizeof(ElevationTile));
}

/* Heights relative to `about` in the level's own steps, for lanes within its cells. Two posts of a row take one load;
 * differences are formed between whole steps. */
static inline F32x8 level_heights(const ElevationLevel *level, Lattice x, Lattice y, F32x8 lanes, I32x8 about)
{
    const I32x8 post = i32x8_set(0xffff), none = i32x8_set(0), mask = _mm256_castps_si256(lanes);
    const I32x8 inside = i32x8_set(elevation_tile_cells - 1), tile = tiles_of(level, x, y);
    const I32x8 row = i32x8_mul(i32x8_and(y.cell, inside), i32x8_set(elevation_tile_side));
    const I32x8 at =
        i32x8_add(i32x8_mul(tile, i32x8_set(elevation_tile_posts)), i32x8_add(row, i32x8_and(x.cell, inside)));
    const uint16_t *north_of = level->stored + elevation_tile_side;
    const I32x8     south = _mm256_mask_i32gather_epi32(none, (const int *)(const void *)level->stored, at, mask, 2);
    const I32x8     north = _mm256_mask_i32gather_epi32(none, (const int *)(const void *)north_of, at, mask, 2);
    I32x8           sw = i32x8_and(south, post), se = i32x8_shift_right(south, 16);
    I32x8           nw = i32x8_and(north, post), ne = i32x8_shift_right(north, 16);
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

/* Slopes about eight places. Those whose arms end on one level are computed together, the others one by one. Within
 * 1e-5 of slope_about. */
static F32x8 slopes_about(const Elevation *elevation, const double x_m[8], const double y_m[8], unsigned lanes)
{
    const I32x8 outside = i32x8_set(-1);
    F32x8       slope = f32x8_set(0);
    unsigned    left = lanes, alone = 0; /* left: lanes not yet found; alone: lanes on the seam of two levels */
    for (int n = 0; n < elevation->level_count && left; n++) {
        const ElevationLevel *level = &elevation->level[n];
        const double          per_m = 1 / level->spacing_m;
        const F32x8           arm = f32x8_set(arm_m * per_m), back = f32x8_set(-arm_m * per_m);
        const Lattice         x = level_cells(x_m, level->x0_m, per_m), y = level_cells(y_m, level->y0_m, per_m);
        const Lattice         west = moved(x, back), east = moved(x, arm);
        const Lattice         south = moved(y, back), north = moved(y, arm);
        const I32x8           nx = i32x8_set(level->nx), ny = i32x8_set(level->ny), one = i32x8_set(1);
        /* a place in cells 0 .. n - 2 has all its arms on the level */
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
        const I32x8 about = level->plain
                                ? i32x8_set(0)
                                : of_tiles(&level->tile->base, tiles_of(level, x, y), _mm256_castps_si256(found));
        const F32x8 dx = level_heights(level, east, y, found, about) - level_heights(level, west, y, found, about);
        const F32x8 dy = level_heights(level, x, north, found, about) - level_heights(level, x, south, found, about);
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

/* Slopes of the terrain about eight places; see the header. Beyond some tens of kilometres the tilt of the ENU plane
 * itself would count as a slope, though it is not visible there, so it is taken off. */
F32x8 invented_slopes(const Elevation *elevation, const double x_m[8], const double y_m[8], unsigned lanes)
{
    const F32x8 x = f32x8_of_doubles(x_m), y = f32x8_of_doubles(y_m);
    const F32x8 lean = f32x8_sqrt(f32x8_fma(x, x, y * y)) * f32x8_set(1 / 6371e3);
    return f32x8_max(slopes_about(elevation, x_m, y_m, lanes) - lean, f32x8_set(0));
}

/* ---- borders that wander ---------------------------------------------------------------------- */

/* Fine noise, -1 .. 1, by which borders wander, of wavelengths from some metres down to 0.1 m. Only places whose class
 * it can change need it. */
static F32x8 wander_eight(uint64_t seed, const double x_m[8], const double y_m[8])
{
    static const double wave_m[] = {2.7, 1.2, 0.53, 0.24, 0.11}, share[] = {0.42, 0.26, 0.16, 0.10, 0.06};
    F32x8               sum = f32x8_set(0);
    for (int n = 0; n < 5; n++)
        sum = f32x8_fma(f32x8_set(share[n]), noise_eight(seed + 30 + (uint64_t)n, wave_m[n], x_m, y_m), sum);
    return sum;
}

/* ---- synthetic cover ------------------------------------------------------------------------ */

void invented_fields(SlowFields *out, const InventedGround *ground, const double x_m[8], const double y_m[8],
                     F32x8 slope)
{
    const uint64_t seed = ground->seed;
    out->middle = noise_eight(seed + 11, 83, x_m, y_m), out->patch = noise_eight(seed + 12, 17, x_m, y_m);
    out->wet = ground->ways ? ways_wet(ground->ways, x_m, y_m) : f32x8_set(0);
    out->large = noise_eight(seed + 10, 310, x_m, y_m);
    out->slope = slope;
    plot_bend_by(&out->bend_x, &out->bend_y, seed, x_m, y_m);
    out->tame = out->untouched = false;
}

static const double wild_wander = 0.02; /* moves the borders of wild patches by some metres */
/* from where on ground is wild, beside 0 */
static const double dry_grass_from = -0.1, bare_soil_from = -0.16, worn_below = -0.2;

/* Where each is above 0 scrub grows, rock shows, and wet grass grows. */
typedef struct Wild {
    F32x8 grown, stony, marsh;
} Wild;

/* Wild patches are wider where it is steep; rock shows in their middles and on worn crests; scrub and wet grass grow in
 * hollows. All three never fall as the fields rise, but that rock is less where it is wet. */
static inline Wild wild_of(const SlowFields *slow)
{
    const F32x8 middle = slow->middle, patch = slow->patch, wet = slow->wet, slope = slow->slope;
    F32x8       wild = f32x8_fma(f32x8_set(0.5), middle, slow->large);
    wild = f32x8_fma(f32x8_set(0.14), patch, wild);
    wild = f32x8_fma(f32x8_set(4), slope, wild);
    const F32x8 stony = f32x8_fma(f32x8_set(-0.3), wet, wild) - f32x8_set(1.24);
    const F32x8 marsh = f32x8_fma(f32x8_set(0.35), middle, wet) - f32x8_set(0.92);
    return (Wild){.grown = f32x8_fma(f32x8_set(0.2), f32x8_max(wet, f32x8_set(0)), wild) - f32x8_set(0.88),
                  .stony = f32x8_fma(f32x8_set(0.12), f32x8_clamp(slope * f32x8_set(5), 0, 1), stony),
                  .marsh = f32x8_fma(f32x8_set(0.22), patch, marsh)};
}

bool invented_wild_alike(const WildEnds *e)
{
    enum { low, high, low_wet, high_dry };
    /* lanes: all low, all high; the same with the other end of `wet`, for what falls with it */
    const int    end[4] = {0, 1, 0, 1}, wet_end[4] = {0, 1, 1, 0};
    float        field[5][8] = {{0}}, grown[8], stony[8], marsh[8];
    const double off = wild_wander + 1e-4;
    for (int k = 0; k < 4; k++) {
        field[0][k] = e->large[end[k]], field[1][k] = e->middle[end[k]], field[2][k] = e->patch[end[k]];
        field[3][k] = e->slope[end[k]], field[4][k] = e->wet[wet_end[k]];
    }
    const Wild wild = wild_of(&(SlowFields){.large = f32x8_load(field[0]),
                                            .middle = f32x8_load(field[1]),
                                            .patch = f32x8_load(field[2]),
                                            .slope = f32x8_load(field[3]),
                                            .wet = f32x8_load(field[4])});
    f32x8_store(grown, wild.grown), f32x8_store(stony, wild.stony), f32x8_store(marsh, wild.marsh);
    const double from[6][3] = {{(double)grown[low], (double)grown[high], 0},
                               {(double)grown[low], (double)grown[high], dry_grass_from},
                               {(double)marsh[low], (double)marsh[high], 0},
                               {(double)stony[low_wet], (double)stony[high_dry], 0},
                               {(double)stony[low_wet], (double)stony[high_dry], bare_soil_from},
                               {(double)e->wet[0], (double)e->wet[1], worn_below}};
    const int    rules = (double)stony[high_dry] + off < bare_soil_from ? 5 : 6; /* nothing there to wear off */
    for (int n = 0; n < rules; n++)
        if (from[n][0] - off <= from[n][2] && from[n][1] + off >= from[n][2]) return false;
    return true;
}

/* Lanes on whose class the finest noise may bear, by which the borders of wild patches wander. */
static unsigned close_to_wild(const Wild *wild)
{
    const F32x8 step = f32x8_set(wild_wander), dry_from = f32x8_set(dry_grass_from),
                soil_from = f32x8_set(bare_soil_from);
    F32x8 close = f32x8_less(f32x8_abs(wild->grown), step);
    close = f32x8_or(close, f32x8_less(f32x8_abs(wild->grown - dry_from), step));
    close = f32x8_or(close, f32x8_less(f32x8_abs(wild->stony), step));
    close = f32x8_or(close, f32x8_less(f32x8_abs(wild->stony - soil_from), step));
    return f32x8_bits(f32x8_or(close, f32x8_less(f32x8_abs(wild->marsh), step)));
}

/* Classes of wild patches over those of fields. */
static I32x8 grow_wild(I32x8 class, const Wild *wild, F32x8 wet)
{
    const F32x8 zero = f32x8_set(0), worn = f32x8_less(wet, f32x8_set(worn_below));
    const F32x8 soil = f32x8_and(worn, f32x8_greater(wild->stony, f32x8_set(bare_soil_from)));
    class = i32x8_select(f32x8_greater(wild->grown, f32x8_set(dry_grass_from)), i32x8_set(SURFACE_DRY_GRASS), class);
    class = i32x8_select(f32x8_greater(wild->marsh, zero), i32x8_set(SURFACE_WETLAND), class);
    class = i32x8_select(f32x8_greater(wild->grown, zero), i32x8_set(SURFACE_SCRUB), class);
    class = i32x8_select(soil, i32x8_set(SURFACE_BARE_SOIL), class);
    return i32x8_select(f32x8_greater(wild->stony, zero), i32x8_set(SURFACE_ROCK), class);
}

void invented_surfaces(int32_t surface[8], const InventedGround *ground, const double x_m[8], const double y_m[8],
                       const SlowFields *slow, unsigned lanes)
{
    const uint64_t seed = ground->seed;
    double         bent_x[8], bent_y[8];
    float          wander_of[8] = {0}, patch_of[8];
    int32_t        found[8], cell_of[8];
    unsigned       touched = 0;
    PlotPlaces     plots;
    Wild           wild;
    plot_bent(bent_x, bent_y, seed, x_m, y_m, slow->bend_x, slow->bend_y);
    plots_find(&plots, seed, bent_x, bent_y, lanes);
    if (!slow->tame) wild = wild_of(slow);
    if (ground->ways && !slow->untouched) {
        const I32x8 touches = ways_cells(ground->ways, x_m, y_m);
        touched = f32x8_bits(i32x8_greater(touches, i32x8_set(-1))) & lanes;
        if (touched) i32x8_store(cell_of, touches);
    }

    /* the finest noise is evaluated only for lanes whose class it can change */
    const unsigned close = slow->tame ? 0 : close_to_wild(&wild);
    const unsigned wanders = (close | (plots.near & ~plots.sure) | touched) & lanes;
    F32x8          wander = f32x8_set(0);
    if (wanders) {
        const F32x8 step = f32x8_set(wild_wander);
        wander = f32x8_and(wander_eight(seed, x_m, y_m), f32x8_mask(wanders));
        if (!slow->tame) {
            wild.grown = f32x8_fma(step, wander, wild.grown);
            wild.stony = f32x8_fma(step, wander, wild.stony);
            wild.marsh = f32x8_fma(step, wander, wild.marsh);
        }
        f32x8_store(wander_of, wander);
    }
    const unsigned rock = slow->tame ? 0 : f32x8_bits(f32x8_greater(wild.stony, f32x8_set(0)));
    const unsigned on_border = plots.near & ~rock;
    const I32x8    border = on_border ? plots_on_borders(&plots, wander, on_border) : i32x8_set(SURFACE_NONE);

    I32x8 class = slow->tame ? plots.crop : grow_wild(plots.crop, &wild, slow->wet);
    class = i32x8_select(i32x8_equal(border, i32x8_set(SURFACE_NONE)), class, border);
    i32x8_store(found, class);
    if (touched) f32x8_store(patch_of, slow->patch);
    for (; touched; touched &= touched - 1) {
        const int k = __builtin_ctz(touched);
        found[k] = (int32_t)ways_surface(ground->ways, cell_of[k], x_m[k], y_m[k], (SurfaceClass)found[k], wander_of[k],
                                         patch_of[k]);
    }
    for (int k = 0; k < 8; k++)
        if (lanes >> k & 1) surface[k] = found[k];
}

static inline float greatest(F32x8 x)
{
    float of[8], most = -INFINITY;
    f32x8_store(of, x);
    for (int k = 0; k < 8; k++) most = of[k] > most ? of[k] : most;
    return most;
}

/* Whether nothing grows wild, and no rock shows, at any place whose fields are between these. */
static bool all_tame(const SlowFields *slow)
{
    const F32x8  wet = f32x8_set((double)greatest(slow->wet)), dry = f32x8_set(-(double)greatest(-slow->wet));
    SlowFields   most = {.large = f32x8_set((double)greatest(slow->large)),
                         .middle = f32x8_set((double)greatest(slow->middle)),
                         .patch = f32x8_set((double)greatest(slow->patch)),
                         .slope = f32x8_set((double)greatest(slow->slope)),
                         .wet = wet};
    const double off = wild_wander + 1e-4;
    const Wild   wild = wild_of(&most);
    most.wet = dry;
    return (double)greatest(wild.grown) + off < dry_grass_from && (double)greatest(wild.marsh) + off < 0 &&
           (double)greatest(wild_of(&most).stony) + off < bare_soil_from;
}

/* ---- a few metres --------------------------------------------------------------------------- */

/* longest and shorter side of the area of the places: within it the linear field of 17 m is within 0.04 of the true one
 * */
static const double slow_long_m = 12, slow_short_m = 4;

static void span_of(double *low, double *high, int count, const double *v_m)
{
    F64x4 least = f64x4_set(INFINITY), most = f64x4_set(-INFINITY);
    int   k = 0;
    for (; k + 4 <= count; k += 4) {
        least = f64x4_min(f64x4_loadu(v_m + k), least); /* NaN: as they are */
        most = f64x4_max(f64x4_loadu(v_m + k), most);
    }
    double end[2][4];
    f64x4_storeu(end[0], least), f64x4_storeu(end[1], most);
    *low = INFINITY, *high = -INFINITY;
    for (int n = 0; n < 4; n++)
        *low = end[0][n] < *low ? end[0][n] : *low, *high = end[1][n] > *high ? end[1][n] : *high;
    for (; k < count; k++) *low = v_m[k] < *low ? v_m[k] : *low, *high = v_m[k] > *high ? v_m[k] : *high;
}

void invented_nodes(SlowNodes *out, const InventedGround *ground, const Elevation *elevation, int count,
                    const double *x_m, const double *y_m)
{
    static const double margin_m = 0.01;
    double              low[2], high[2], x[8], y[8];
    *out = (SlowNodes){.known = false};
    span_of(&low[0], &high[0], count, x_m);
    span_of(&low[1], &high[1], count, y_m);
    const double wide_m = high[0] - low[0] + 2 * margin_m, high_m = high[1] - low[1] + 2 * margin_m;
    out->east = wide_m > high_m;
    if (!(fmax(wide_m, high_m) <= slow_long_m && fmin(wide_m, high_m) <= slow_short_m)) return;
    out->x0_m = low[0] - margin_m, out->y0_m = low[1] - margin_m;
    out->per_x_m = (out->east ? 3 : 1) / wide_m, out->per_y_m = (out->east ? 1 : 3) / high_m;
    for (int k = 0; k < 8; k++) {
        const int along = k & 3, across = k >> 2;
        x[k] = out->x0_m + (out->east ? along : across) / out->per_x_m;
        y[k] = out->y0_m + (out->east ? across : along) / out->per_y_m;
    }
    if (invented_grounded(elevation, x, y) != 0xff) return;
    out->known = true;
    invented_fields(&out->field, ground, x, y, invented_slopes(elevation, x, y, 0xff));
    out->tame = all_tame(&out->field);
    /* corners of the places' area are nodes, and index cells are larger than that */
    const I32x8 touches = ground->ways ? ways_cells(ground->ways, x, y) : i32x8_set(-1);
    out->field.untouched = f32x8_bits(i32x8_greater(touches, i32x8_set(-1))) == 0;
}

static inline F32x8 between_nodes(F32x8 node, I32x8 cell, F32x8 along, F32x8 across)
{
    const I32x8 one = i32x8_set(1), four = i32x8_set(4);
    const F32x8 near =
        f32x8_lerp(_mm256_permutevar8x32_ps(node, cell), _mm256_permutevar8x32_ps(node, i32x8_add(cell, one)), along);
    const F32x8 far = f32x8_lerp(_mm256_permutevar8x32_ps(node, i32x8_add(cell, four)),
                                 _mm256_permutevar8x32_ps(node, i32x8_add(cell, i32x8_add(four, one))), along);
    return f32x8_lerp(near, far, across);
}

void invented_between(SlowFields *out, const SlowNodes *nodes, const double x_m[8], const double y_m[8])
{
    double along[8], across[8];
    for (int k = 0; k < 8; k++) {
        const double x = (x_m[k] - nodes->x0_m) * nodes->per_x_m, y = (y_m[k] - nodes->y0_m) * nodes->per_y_m;
        along[k] = nodes->east ? x : y, across[k] = nodes->east ? y : x;
    }
    const F32x8       at = f32x8_clamp(f32x8_of_doubles(along), 0, 2.999f), whole = f32x8_floor(at);
    const F32x8       u = at - whole, v = f32x8_clamp(f32x8_of_doubles(across), 0, 1);
    const I32x8       cell = i32x8_truncate(whole);
    const SlowFields *f = &nodes->field;
    if (nodes->tame) {
        out->patch = between_nodes(f->patch, cell, u, v);
        out->bend_x = between_nodes(f->bend_x, cell, u, v), out->bend_y = between_nodes(f->bend_y, cell, u, v);
        out->tame = true, out->untouched = f->untouched;
        return;
    }
    *out = (SlowFields){between_nodes(f->large, cell, u, v),
                        between_nodes(f->middle, cell, u, v),
                        between_nodes(f->patch, cell, u, v),
                        between_nodes(f->slope, cell, u, v),
                        between_nodes(f->wet, cell, u, v),
                        between_nodes(f->bend_x, cell, u, v),
                        between_nodes(f->bend_y, cell, u, v),
                        false,
                        f->untouched};
}
