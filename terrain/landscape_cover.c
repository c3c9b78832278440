/* terrain/landscape_cover.c: what grows and lies on the ground. Invented: irregular fields, tracks and hedges between
 * some of them, scrub and rock where it is steep or nobody ploughs. Real: what the cover files say, else the same in
 * the lowlands and woods on the slopes. Pure functions of the place. */
#include "terrain/landscape_private.h"

#include <stdlib.h>

/* ---- noise -------------------------------------------------------------------------------- */

/* Smooth value noise of one wavelength, -1 .. 1, mean 0. */
static double noise_at(uint64_t seed, double x_m, double y_m, double wavelength_m)
{
    const double  fx = x_m / wavelength_m, fy = y_m / wavelength_m, cx = floor(fx), cy = floor(fy);
    const int64_t i = (int64_t)cx, j = (int64_t)cy;
    double        u = fx - cx, v = fy - cy;
    u = u * u * (3 - 2 * u);
    v = v * v * (3 - 2 * v);
    const double a = unit_from_hash(landscape_hash(seed, i, j)), b = unit_from_hash(landscape_hash(seed, i + 1, j));
    const double c = unit_from_hash(landscape_hash(seed, i, j + 1));
    const double d = unit_from_hash(landscape_hash(seed, i + 1, j + 1));
    return 2 * (a + u * (b - a) + v * (c - a) + u * v * (a - b - c + d)) - 1;
}

/* ---- fields ------------------------------------------------------------------------------- */

typedef struct Plot {
    uint64_t id;          /* of the field */
    double   x_m, y_m;    /* a place that belongs to the field as a whole */
    uint64_t border;      /* of the pair of fields at the nearest border */
    double   border_m;    /* distance to it */
} Plot;

static const double plot_m = 160;

/* Fields are the cells of a jittered grid, some joined in twos and fours. */
static uint64_t field_of_site(uint64_t seed, int64_t i, int64_t j)
{
    const double four = unit_from_hash(landscape_hash(seed + 1, i >> 1, j >> 1));
    if (four < 0.25) return landscape_hash(seed + 2, i >> 1, j >> 1);
    if (four < 0.45) return landscape_hash(seed + 3, i >> 1, j);
    if (four < 0.60) return landscape_hash(seed + 4, i, j >> 1);
    return landscape_hash(seed + 5, i, j);
}

static Plot plot_at(uint64_t seed, double x_m, double y_m)
{
    static const double jitter = 0.8;
    double              site_x[9], site_y[9], near[9];
    int64_t             site_i[9], site_j[9];
    const int64_t       ci = (int64_t)floor(x_m / plot_m), cj = (int64_t)floor(y_m / plot_m);
    int                 best = 0;
    for (int n = 0; n < 9; n++) {
        site_i[n] = ci + n % 3 - 1;
        site_j[n] = cj + n / 3 - 1;
        const uint64_t h = landscape_hash(seed, site_i[n], site_j[n]);
        const double   ux = (double)(h & 0xffffffffu) * 0x1p-32 - 0.5, uy = (double)(h >> 32) * 0x1p-32 - 0.5;
        site_x[n] = ((double)site_i[n] + 0.5 + jitter * ux) * plot_m;
        site_y[n] = ((double)site_j[n] + 0.5 + jitter * uy) * plot_m;
        near[n] = (site_x[n] - x_m) * (site_x[n] - x_m) + (site_y[n] - y_m) * (site_y[n] - y_m);
        if (near[n] < near[best]) best = n;
    }

    Plot plot = {.id = field_of_site(seed, site_i[best], site_j[best]),
                 .x_m = (double)(site_i[best] >> 1) * 2 * plot_m,
                 .y_m = (double)(site_j[best] >> 1) * 2 * plot_m,
                 .border_m = INFINITY};
    for (int n = 0; n < 9; n++) {
        if (n == best) continue;
        /* distance to the perpendicular bisector; cheap test first, the hash only for a new best */
        const double apart_m = hypot(site_x[n] - site_x[best], site_y[n] - site_y[best]);
        const double border_m = 0.5 * (near[n] - near[best]) / fmax(apart_m, 1e-3);
        if (border_m >= plot.border_m) continue;
        const uint64_t other = field_of_site(seed, site_i[n], site_j[n]);
        if (other == plot.id) continue;
        plot.border_m = border_m;
        plot.border = landscape_hash(seed + 6, (int64_t)(other ^ plot.id), 0);
    }
    return plot;
}

static SurfaceClass crop_of_field(uint64_t id, bool arable)
{
    static const struct {
        double       arable, pasture; /* up to this share */
        SurfaceClass surface;
    } share[] = {
        {0.38, 0.10, SURFACE_CROP},      {0.58, 0.15, SURFACE_PLOUGHED},  {0.70, 0.20, SURFACE_BARE_SOIL},
        {0.88, 0.62, SURFACE_GRASS},     {1.00, 0.90, SURFACE_DRY_GRASS}, {1.00, 1.00, SURFACE_SCRUB},
    };
    const double u = unit_from_hash(landscape_hash(id, 7, 0));
    for (size_t n = 0; n < sizeof share / sizeof share[0]; n++)
        if (u < (arable ? share[n].arable : share[n].pasture)) return share[n].surface;
    return SURFACE_GRASS;
}

/* Slope over some 20 m, so that what grows does not follow the edges of single triangles. 0 at the very rim. */
static double slope_about(const Elevation *elevation, double x_m, double y_m)
{
    static const double arm_m = 10;
    const double dx = elevation_height(elevation, x_m + arm_m, y_m, NULL) - elevation_height(elevation, x_m - arm_m, y_m, NULL);
    const double dy = elevation_height(elevation, x_m, y_m + arm_m, NULL) - elevation_height(elevation, x_m, y_m - arm_m, NULL);
    const double slope = sqrt(dx * dx + dy * dy) / (2 * arm_m);
    return isfinite(slope) ? slope : 0;
}

static SurfaceClass invented_surface(const Landscape *landscape, double x_m, double y_m)
{
    static const double track_half_m = 2, hedge_half_m = 1.5;
    const Cover        *cover = landscape->cover;
    const uint64_t seed = cover->seed;
    const double   steep = slope_about(&landscape->elevation, x_m, y_m);

    /* beyond some tens of kilometres the tilt of the plane itself would count as a slope; nobody sees it there */
    const double far_lean = sqrt(x_m * x_m + y_m * y_m) / 6371e3;
    const double slope = fmax(steep - far_lean, 0);

    /* wild patches, wider where it is steep; rock shows through in their hearts */
    const double wild = noise_at(seed + 10, x_m, y_m, 310) + 0.5 * noise_at(seed + 11, x_m, y_m, 83) +
                        0.2 * noise_at(seed + 12, x_m, y_m, 17) + 4 * slope;
    if (wild > 1.24 - 0.12 * clamp(slope / 0.2, 0, 1)) return SURFACE_ROCK;

    const Plot plot = plot_at(seed, x_m, y_m);
    if (plot.border_m < track_half_m && unit_from_hash(plot.border) < 0.24) return SURFACE_TRACK;
    if (wild > 0.88) return SURFACE_SCRUB;
    if (plot.border_m < hedge_half_m && unit_from_hash(plot.border) > 0.66) return SURFACE_SCRUB;
    if (wild > 0.78) return SURFACE_DRY_GRASS;
    return crop_of_field(plot.id, noise_at(seed + 13, plot.x_m, plot.y_m, 1900) > -0.15);
}

/* Elevation files without cover: woods on slopes too steep for the plough and below the tree line, fields in the
 * lowlands, rock where it is steeper than soil stays (40 degrees), the sea where it is flat at its level. */
static SurfaceClass unmapped_surface(const Landscape *landscape, double x_m, double y_m, double z_m)
{
    const Cover   *cover = landscape->cover;
    const uint64_t seed = cover->seed;
    const double   far_m = sqrt(x_m * x_m + y_m * y_m);
    const double   slope = fmax(slope_about(&landscape->elevation, x_m, y_m) - far_m / 6371e3, 0);
    double         ellipsoid_m, dz_per_h;
    curve_at(&cover->curve, x_m, y_m, &ellipsoid_m, &dz_per_h);
    const double h_msl_m = (z_m - ellipsoid_m) / dz_per_h - cover->geoid_m;
    if (fabs(h_msl_m) < 1 + 5e-5 * far_m && slope < 0.002) return SURFACE_WATER; /* the geoid tilts by so much */

    const double patchy = noise_at(seed + 14, x_m, y_m, 700) + 0.6 * noise_at(seed + 15, x_m, y_m, 190) +
                          0.3 * noise_at(seed + 16, x_m, y_m, 41);
    if (slope + 0.12 * patchy > 0.84) return SURFACE_ROCK;
    const double above_m = h_msl_m - cover->treeline_m + 150 * patchy;
    if (above_m > 700) return SURFACE_ROCK;
    if (above_m > 0) return patchy > 0.4 ? SURFACE_ROCK : SURFACE_DRY_GRASS;
    if (slope + 0.08 * patchy > 0.16) {
        if (patchy < -0.75) return SURFACE_DRY_GRASS;
        if (patchy < -0.5) return SURFACE_SCRUB;
        return above_m > -1200 + 500 * noise_at(seed + 17, x_m, y_m, 2300) ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF;
    }
    return invented_surface(landscape, x_m, y_m);
}

SurfaceClass landscape_surface(const Landscape *landscape, double x_m, double y_m)
{
    const Cover *cover = landscape->cover;
    const double z_m = cover ? elevation_height(&landscape->elevation, x_m, y_m, NULL) : NAN;
    if (!isfinite(z_m)) return SURFACE_NONE;
    if (!cover->real) return invented_surface(landscape, x_m, y_m);
    if (cover->grid[0].surface || cover->grid[1].surface) {
        /* borders of coarse cells wander by half a cell, as nothing in the country runs in stairs of 30 m */
        const double cell_m = cover->grid[0].cell_m, away_m = cell_m >= 5 ? 0.5 * cell_m : 0;
        double       dx = 0, dy = 0;
        for (int octave = 0; away_m > 0 && octave < 3; octave++) {
            const double wave_m = cell_m * exp2(-octave), share = 0.57 * exp2(-octave);
            dx += share * noise_at(cover->seed + 40 + (uint64_t)octave, x_m, y_m, wave_m);
            dy += share * noise_at(cover->seed + 50 + (uint64_t)octave, x_m, y_m, wave_m);
        }
        const SurfaceClass surface = cover_grid_at(cover->grid, x_m + away_m * dx, y_m + away_m * dy);
        if (surface != SURFACE_NONE) return surface;
    }
    return unmapped_surface(landscape, x_m, y_m, z_m);
}

/* ---- texture ------------------------------------------------------------------------------ */

static const double octave_m[] = {0.11, 0.31, 0.9, 2.6, 7.5, 23, 71};
enum { octave_count = sizeof octave_m / sizeof octave_m[0] };

/* Amplitude of each octave by class: grass is mottled, soil clotted, a track worn in stripes and puddles. The
 * rows are invented, to look right. */
static const float amplitude[SURFACE_COUNT][octave_count] = {
    [SURFACE_NONE] = {0},
    [SURFACE_GRASS] = {.07f, .06f, .05f, .05f, .05f, .05f, .05f},
    [SURFACE_DRY_GRASS] = {.08f, .08f, .07f, .06f, .05f, .04f, .05f},
    [SURFACE_CROP] = {.07f, .05f, .03f, .03f, .03f, .04f, .05f},
    [SURFACE_BARE_SOIL] = {.06f, .06f, .05f, .04f, .04f, .05f, .06f},
    [SURFACE_PLOUGHED] = {.09f, .07f, .04f, .03f, .03f, .04f, .05f},
    [SURFACE_TRACK] = {.06f, .07f, .06f, .06f, .04f, .03f, .02f},
    [SURFACE_ROCK] = {.08f, .09f, .09f, .08f, .06f, .04f, .02f},
    [SURFACE_SCRUB] = {.09f, .10f, .11f, .09f, .05f, .03f, .02f},
    [SURFACE_WATER] = {.01f, .01f, .01f, .01f, .01f, .01f, .01f},
    [SURFACE_FOREST_BROADLEAF] = {.06f, .08f, .10f, .12f, .12f, .04f, .03f},
    [SURFACE_FOREST_CONIFER] = {.06f, .08f, .12f, .14f, .10f, .04f, .03f},
    [SURFACE_BUILT] = {.03f, .04f, .06f, .10f, .14f, .10f, .04f},
    [SURFACE_ROAD] = {.03f, .03f, .03f, .03f, .02f, .02f, .02f},
    [SURFACE_SAND] = {.04f, .04f, .03f, .03f, .03f, .04f, .04f},
    [SURFACE_SNOW] = {.01f, .01f, .02f, .02f, .02f, .02f, .02f},
    [SURFACE_WETLAND] = {.08f, .08f, .07f, .07f, .08f, .07f, .05f},
};

/* Whole for features four footprints long, gone for two: below that a pixel sees their mean, which is 1. */
static double fade(double wavelength_m, double footprint_m)
{
    return 1 - smooth_step(0.25, 0.5, footprint_m / wavelength_m);
}

/* Rows of a field, along a direction of its own; a smooth wave of mean 0. */
static double rows_at(uint64_t seed, double x_m, double y_m, double apart_m)
{
    const uint64_t h = landscape_hash(plot_at(seed, x_m, y_m).id, 8, 0);
    double         dx = unit_from_hash(h) - 0.5, dy = unit_from_hash(landscape_hash(h, 9, 0)) - 0.5;
    const double   length = fmax(sqrt(dx * dx + dy * dy), 1e-3);
    dx /= length;
    dy /= length;
    const double f = (x_m * dx + y_m * dy) / apart_m, t = fabs(2 * (f - floor(f)) - 1); /* 1 .. 0 .. 1 */
    return 2 * t * t * (3 - 2 * t) - 1;
}

static bool photo_covers(const Photo *photo, double x_m, double y_m)
{
    double linear[photo_channels];
    return photo->mips > 0 && photo_at(linear, photo, x_m, y_m, photo->cell_m) > 0.5;
}

double landscape_texture(const Landscape *landscape, SurfaceClass surface, double x_m, double y_m, double footprint_m)
{
    static const double crop_rows_m = 0.75, furrows_m = 1.1;
    const Cover        *cover = landscape->cover;
    if (!cover || !isfinite(x_m) || !isfinite(y_m) || !(surface > SURFACE_NONE && surface < SURFACE_COUNT)) return 1;

    const uint64_t seed = cover->seed + 20;
    footprint_m = footprint_m > 0 ? footprint_m : 0;
    /* what the photograph shows already is not invented once more */
    const double seen_m = photo_covers(&cover->photo, x_m, y_m) ? 2 * cover->photo.cell_m : INFINITY;
    double       sum = 1;
    for (int n = octave_count - 1; n >= 0; n--) {
        const double share = fade(octave_m[n], footprint_m);
        if (octave_m[n] >= seen_m) continue;
        if (!(share > 0)) break; /* the shorter ones are gone too */
        sum += share * amplitude[surface][n] * noise_at(seed + (uint64_t)n, x_m, y_m, octave_m[n]);
    }
    const double row_m = surface == SURFACE_CROP ? crop_rows_m : surface == SURFACE_PLOUGHED ? furrows_m : 0;
    if (row_m > 0 && row_m < seen_m) {
        const double share = fade(row_m, footprint_m);
        if (share > 0) sum += 0.08 * share * rows_at(cover->seed, x_m, y_m, row_m);
    }
    return clamp(sum, 0.6, 1.4);
}

/* ---- photograph ----------------------------------------------------------------------------- */

void cover_measure_photo(Landscape *landscape)
{
    /* classes of few pixels lean on the mean of all: a class of a single dark pixel would blow up the others */
    static const double enough = 200, most = 400e3;
    Cover *cover = landscape->cover;
    Photo *p = &cover->photo;
    if (p->mips == 0) return;
    int k = 0;
    while (k < p->mips - 1 && (double)p->nx[k] * p->ny[k] > most) k++;
    const double cell_m = p->cell_m * exp2(k);
    double       sum[SURFACE_COUNT][photo_channels] = {{0}}, count[SURFACE_COUNT] = {0}, all[photo_channels] = {0}, total = 0;
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

void landscape_albedo(float factor[albedo_channels], const Landscape *landscape, SurfaceClass surface, double x_m, double y_m,
                      double footprint_m)
{
    static const double brightest = 6; /* of a class's mean: a white roof in a dark wood */
    const Cover *cover = landscape->cover;
    double       linear[photo_channels], share = 0, all = 0;
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

void cover_free(Cover *cover)
{
    if (!cover) return;
    cover_grid_free(cover->grid);
    photo_free(&cover->photo);
    free(cover);
}
