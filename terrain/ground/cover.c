/* terrain/ground/cover.c: what covers a landscape: its classes, invented (invented_cover.c), or of the land cover
 * files, and where they have none woods on the slopes and the invented ones in the lowlands; and its brightness,
 * relative to the mean of a class, by the photograph. Pure functions of the position, classes of eight positions at
 * once. */

#include "terrain/ground/landscape_private.h"
#include "terrain/invented/invented_eight.h"

#include <assert.h>
#include <stdlib.h>
#include <sys/mman.h>

/* ---- real cover ----------------------------------------------------------------------------- */

/* Class on real ground where no file has one: woods on slopes too steep for the plough and below the tree line, fields
 * in the lowlands, rock where it is steeper than soil stays (40 degrees), the sea where it is flat at its level.
 * SURFACE_NONE: as on synthetic ground. */
static SurfaceClass unmapped_surface(const Cover *cover, double x_m, double y_m, double z_m, double slope,
                                     double patchy, double woods)
{
    const double far_m = sqrt(x_m * x_m + y_m * y_m);
    double       ellipsoid_m, dz_per_h;
    levels_curve_at(&cover->curve, x_m, y_m, &ellipsoid_m, &dz_per_h);
    const double h_msl_m = (z_m - ellipsoid_m) / dz_per_h - cover->geoid_m;
    if (fabs(h_msl_m) < 1 + 5e-5 * far_m && slope < 0.002)
        return SURFACE_WATER; /* the tolerance grows with distance as the geoid may tilt */
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

/* Fills those lanes for which the files have a class, and returns the others. Borders wander by up to half a cell, over
 * wavelengths from a cell down to 0.1 m, since real borders have no steps of a cell. A place whose surroundings within
 * reach are of one class needs no wandering. */
static unsigned mapped_surfaces(int32_t surface[8], const Cover *cover, const double x_m[8], const double y_m[8],
                                unsigned lanes)
{
    enum { most_octaves = 9 };
    if (!cover->grid[0].surface && !cover->grid[1].surface) return lanes;
    const double cell_m = cover->grid[0].surface ? cover->grid[0].cell_m : cover->grid[1].cell_m;
    const double reach_m = 0.5 * cell_m;
    unsigned     none = 0, near = 0;
    for (unsigned left = lanes; left; left &= left - 1) {
        const int    k = __builtin_ctz(left);
        SurfaceClass corner[4];
        for (int c = 0; c < 4; c++)
            corner[c] = cover_grid_at(cover->grid, x_m[k] + (c & 1 ? reach_m : -reach_m),
                                      y_m[k] + (c & 2 ? reach_m : -reach_m));
        surface[k] = (int32_t)corner[0];
        if (corner[0] != corner[1] || corner[0] != corner[2] || corner[0] != corner[3]) near |= 1u << k;
        else if (corner[0] == SURFACE_NONE) none |= 1u << k;
    }
    if (!near) return none;
    F32x8 dx = f32x8_set(0), dy = f32x8_set(0);
    for (int octave = 0; octave < most_octaves; octave++) {
        const double wave_m = cell_m * exp2(-octave);
        if (octave && wave_m < 0.1) break;
        const F32x8 share = f32x8_set(
            reach_m * 0.4 * pow(0.6, octave)); /* 0.4 / (1 - 0.6): the sum of all octaves stays within reach */
        F32x8 wave_y;
        dx = f32x8_fma(share, noise_pair_eight(&wave_y, cover->invented.seed + 40 + (uint64_t)octave, wave_m, x_m, y_m),
                       dx);
        dy = f32x8_fma(share, wave_y, dy);
    }
    float off_x[8], off_y[8];
    f32x8_store(off_x, dx), f32x8_store(off_y, dy);
    for (; near; near &= near - 1) {
        const int k = __builtin_ctz(near);
        surface[k] = (int32_t)cover_grid_at(cover->grid, x_m[k] + (double)off_x[k], y_m[k] + (double)off_y[k]);
        if (surface[k] == SURFACE_NONE) none |= 1u << k;
    }
    return none;
}

static void real_surfaces(int32_t surface[8], const Landscape *landscape, const double x_m[8], const double y_m[8],
                          unsigned lanes)
{
    const Cover   *cover = landscape->cover;
    const uint64_t seed = cover->invented.seed;
    lanes = mapped_surfaces(surface, cover, x_m, y_m, lanes);
    if (!lanes) return;
    const F32x8 slopes = invented_slopes(&landscape->elevation, x_m, y_m, lanes);
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
    if (!invented) return;
    SlowFields slow;
    invented_fields(&slow, &cover->invented, x_m, y_m, slopes);
    invented_surfaces(surface, &cover->invented, x_m, y_m, &slow, invented);
}

/* ---- both ----------------------------------------------------------------------------------- */

/* Fills the lanes of the sea and its beaches; returns the others. */
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

/* What lies on the ground, such as roads, wherever there is ground. */
void cover_lay_over(uint8_t *surface, const Landscape *landscape, int count, const double *x_m, const double *y_m)
{
    const LandscapeOver *over = &landscape->over;
    for (int k = 0; k < count && over->of; k++) {
        const int laid = surface[k] == SURFACE_NONE ? SURFACE_NONE : over->surface_at(over->of, x_m[k], y_m[k]);
        if (laid != SURFACE_NONE) surface[k] = (uint8_t)laid;
    }
}

/* Lanes of places that are not NaN. */
static unsigned numbers(const double x_m[8], const double y_m[8])
{
    unsigned lanes = 0;
    for (int k = 0; k < 8; k += 4) {
        const F64x4 x = f64x4_loadu(x_m + k), y = f64x4_loadu(y_m + k);
        lanes |= f64x4_bits(f64x4_and(f64x4_equal(x, x), f64x4_equal(y, y))) << k;
    }
    return lanes;
}

/* Without what lies on it. nodes: those about the places; may be NULL. */
static void find_surfaces(uint8_t *surface, const Landscape *landscape, const SlowNodes *nodes, int count,
                          const double *x_m, const double *y_m)
{
    const Cover *cover = landscape->cover;
    for (int first = 0; first < count; first += 8) {
        double     x[8], y[8];
        int32_t    found[8] = {0};
        SlowFields slow;
        const int  some = count - first < 8 ? count - first : 8;
        for (int k = 0; k < 8; k++) x[k] = k < some ? x_m[first + k] : NAN, y[k] = k < some ? y_m[first + k] : NAN;
        /* nodes are on the ground, and so are places between them */
        unsigned lanes = nodes && nodes->known ? numbers(x, y)
                         : cover               ? invented_grounded(&landscape->elevation, x, y)
                                               : 0;
        if (lanes && cover->invented.coast.sea_count)
            lanes = coast_surfaces(found, &cover->invented.coast, x, y, lanes);
        if (lanes && cover->real) {
            real_surfaces(found, landscape, x, y, lanes);
        } else if (lanes) {
            if (nodes && nodes->known) invented_between(&slow, nodes, x, y);
            else invented_fields(&slow, &cover->invented, x, y, invented_slopes(&landscape->elevation, x, y, lanes));
            invented_surfaces(found, &cover->invented, x, y, &slow, lanes);
        }
        for (int k = 0; k < some; k++) surface[first + k] = (uint8_t)found[k];
    }
}

void cover_surfaces(uint8_t *surface, const Landscape *landscape, int count, const double *x_m, const double *y_m)
{
    find_surfaces(surface, landscape, NULL, count, x_m, y_m);
}

void landscape_surfaces(uint8_t *surface, const Landscape *landscape, int count, const double *x_m, const double *y_m)
{
    cover_surfaces(surface, landscape, count, x_m, y_m);
    cover_lay_over(surface, landscape, count, x_m, y_m);
}

/* Whether a place of a square is looked up first: a quarter of the places in a regular pattern; half of them in a small
 * square. */
static bool looks_first(int side, int row, int column)
{
    return side < 8 ? (row + column) % 2 == 0 : row % 2 == 0 && (column + row / 2) % 2 == 0;
}

/* The places of a square in the order in which they are looked up. */
typedef struct SquareOrder {
    int     side, first; /* how many are looked up first */
    uint8_t place[landscape_square_most];
} SquareOrder;

/* Valid until the thread's next call. */
static const SquareOrder *order_of(int side)
{
    static _Thread_local SquareOrder order; /* most squares are of one side */
    if (order.side == side) return &order;
    int count = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < side * side; k++)
            if (looks_first(side, k / side, k % side) == (pass == 0)) order.place[count++] = (uint8_t)k;
        if (pass == 0) order.first = count;
    }
    order.side = side;
    return &order;
}

/* Whether something that lies on the ground reaches into a square of places: it may be narrower than the pattern is
 * wide. */
static bool something_lies(const LandscapeOver *over, int count, const double *x_m, const double *y_m)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    if (!over->of) return false;
    for (int k = 0; k < count; k++) {
        low[0] = fmin(low[0], x_m[k]), high[0] = fmax(high[0], x_m[k]);
        low[1] = fmin(low[1], y_m[k]), high[1] = fmax(high[1], y_m[k]);
    }
    return over->surface_near(over->of, 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]),
                              0.5 * hypot(high[0] - low[0], high[1] - low[1]));
}

void landscape_surfaces_square(uint8_t *surface, const Landscape *landscape, int side, const double *x_m,
                               const double *y_m)
{
    const Cover *cover = landscape->cover;
    double       x[landscape_square_most], y[landscape_square_most];
    uint8_t      found[landscape_square_most];
    int          differ = 0;
    SlowNodes    nodes = {.known = false};
    assert(side * side <= landscape_square_most);
    const SquareOrder *order = order_of(side);
    differ = something_lies(&landscape->over, side * side, x_m, y_m);
    if (landscape_is_synthetic(landscape))
        invented_nodes(&nodes, &cover->invented, &landscape->elevation, side * side, x_m, y_m);
    for (int pass = 0; pass == 0 || (pass == 1 && differ); pass++) {
        const uint8_t *place = order->place + (pass ? order->first : 0);
        const int      count = pass ? side * side - order->first : order->first;
        for (int k = 0; k < count; k++) x[k] = x_m[place[k]], y[k] = y_m[place[k]];
        find_surfaces(found, landscape, &nodes, count, x, y);
        cover_lay_over(found, landscape, count, x, y);
        for (int k = 0; k < count; k++) surface[place[k]] = found[k], differ |= found[k] != found[0];
    }
    for (int k = 0; k < side * side && !differ; k++) surface[k] = found[0];
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
    invented_ground_free(&cover->invented);
    if (cover->store.map) munmap(cover->store.map, cover->store.octets);
    free(cover->store.path);
    free(cover);
}

bool landscape_seed(uint64_t *out, const Landscape *landscape)
{
    const Cover *cover = landscape->cover;
    *out = cover ? cover->invented.seed : 0;
    return cover != NULL;
}

bool landscape_is_synthetic(const Landscape *landscape)
{
    const Cover *cover = landscape->cover;
    return cover && !cover->real;
}

/* ---- photograph ----------------------------------------------------------------------------- */

void landscape_photo_cells(float cell_m[8], const Landscape *landscape, const double x_m[8], const double y_m[8],
                           unsigned lanes)
{
    const Photo *photo = &((const Cover *)landscape->cover)->photo;
    for (int k = 0; k < 8; k++) {
        cell_m[k] = 0;
        if (photo->mips > 0 && lanes >> k & 1 && photo_cover_at(photo, x_m[k], y_m[k]) > 0.5)
            cell_m[k] = (float)photo->cell_m;
    }
}

void cover_measure_photo(Landscape *landscape)
{
    /* the mean of a class with few pixels leans on the mean of all: otherwise a class of one dark pixel would amplify
     * the others */
    static const double enough = 200, most = 400e3;
    Cover              *cover = landscape->cover;
    Photo              *p = &cover->photo;
    if (p->mips == 0) return;
    int k = 0;
    while (k < p->mips - 1 && (double)p->nx[k] * p->ny[k] > most) k++;
    const double cell_m = p->cell_m * exp2(k);
    double sum[SURFACE_COUNT][photo_channels] = {{0}}, count[SURFACE_COUNT] = {0}, all[photo_channels] = {0}, total = 0;
    for (int j = 0; j < p->ny[k]; j++)
        for (int i = 0; i < p->nx[k]; i++) {
            const double x_m = p->x0_m + (i + 0.5) * cell_m, y_m = p->y0_m + (j + 0.5) * cell_m;
            double       linear[photo_channels];
            const double share = photo_at(linear, p, x_m, y_m, cell_m);
            if (!(share > 0)) continue;
            const SurfaceClass surface = landscape_surface(landscape, x_m, y_m);
            for (int c = 0; c < photo_channels; c++) {
                sum[surface][c] += share * linear[c];
                all[c] += share * linear[c];
            }
            count[surface] += share;
            total += share;
        }
    for (int s = 0; s < SURFACE_COUNT; s++)
        for (int c = 0; c < photo_channels; c++) {
            const double mean_all = total > 0 ? all[c] / total : 1;
            p->mean[s][c] = (float)fmax((sum[s][c] + enough * mean_all) / (count[s] + enough), 1e-4);
        }
}

bool landscape_has_photo(const Landscape *landscape)
{
    const Cover *cover = landscape->cover;
    return cover && cover->photo.mips > 0;
}

void landscape_albedo(float factor[albedo_channels], const Landscape *landscape, SurfaceClass surface, double x_m,
                      double y_m, double footprint_m)
{
    static const double brightest = 6; /* as a factor of the class's mean, such as a white roof in a dark wood */
    const Cover        *cover = landscape->cover;
    double              linear[photo_channels], share = 0, all = 0;
    for (int c = 0; c < albedo_channels; c++) factor[c] = 1;
    if (!cover || cover->photo.mips == 0 || !(surface > SURFACE_NONE && surface < SURFACE_COUNT)) return;
    share = photo_at(linear, &cover->photo, x_m, y_m, footprint_m);
    if (!(share > 0)) return;
    for (int c = 0; c < photo_channels; c++) {
        const double ratio = fmin(linear[c] / (double)cover->photo.mean[surface][c], brightest);
        factor[c] = (float)(1 + share * (ratio - 1));
        all += factor[c] / photo_channels;
    }
    factor[albedo_all] = (float)all;
}
