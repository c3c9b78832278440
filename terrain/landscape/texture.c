/* terrain/landscape/texture.c: brightness of the ground relative to the mean of its class: a synthetic pattern of
 * several wavelengths, and the photograph. */
#include "terrain/landscape/landscape_eight_private.h"

/* ---- pattern -------------------------------------------------------------------------------- */

static const double octave_m[] = {0.11, 0.31, 0.9, 2.6, 7.5, 23, 71};
enum { octave_count = sizeof octave_m / sizeof octave_m[0] };

/* Amplitude of each octave by class: grass is mottled, soil clotted, a track worn in stripes and puddles. The rows are
 * estimates, chosen by appearance. */
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

/* 1 for wavelengths of four texture footprints, 0 for two: below that a pixel averages to the mean, which is 1. */
static F32x8 fade(double wavelength_m, F32x8 footprint_m)
{
    const F32x8 t = f32x8_clamp((footprint_m * f32x8_set(1 / wavelength_m) - f32x8_set(0.25)) * f32x8_set(4), 0, 1);
    return f32x8_set(1) - t * t * (f32x8_set(3) - f32x8_set(2) * t);
}

/* Rows of the fields that eight places lie in, along directions of their own; a smooth wave of mean 0. */
static F32x8 rows_of(PlotCells *cells, uint64_t seed, const double x_m[8], const double y_m[8], double apart_m,
                     unsigned lanes)
{
    double i[8], j[8];
    float  across_x[8] = {0}, across_y[8] = {0}, wave[8];
    F32x8  x, y;
    double bent_x[8], bent_y[8];
    plot_bend(bent_x, bent_y, seed, x_m, y_m);
    plot_cells_of(i, j, &x, &y, bent_x, bent_y);
    for (unsigned left = lanes, same; left; left &= ~same) {
        same = plot_cell_lanes(i, j, left);
        const int       first = __builtin_ctz(left);
        const PlotCell *cell = plot_cell_at(cells, seed, (int64_t)i[first], (int64_t)j[first]);
        I32x8        site;
        (void)plot_nearest(&site, cell, x, y);
        const F32x8 mask = f32x8_mask(same);
        f32x8_store(across_x, f32x8_select(mask, f32x8_gather(cell->across_x, site), f32x8_load(across_x)));
        f32x8_store(across_y, f32x8_select(mask, f32x8_gather(cell->across_y, site), f32x8_load(across_y)));
    }
    for (int k = 0; k < 8; k++) { /* in double: rows of a metre, tens of kilometres out */
        const double f = (x_m[k] * (double)across_x[k] + y_m[k] * (double)across_y[k]) * (1 / apart_m);
        const float  t = fabsf(2 * (float)(f - floor(f)) - 1); /* 1 .. 0 .. 1 */
        wave[k] = 2 * t * t * (3 - 2 * t) - 1;
    }
    return f32x8_load(wave);
}

/* Largest wavelength of synthetic detail under a photograph: wavelengths from two of its pixels on are in it. */
static F32x8 photo_fineness(const Photo *photo, const double x_m[8], const double y_m[8], unsigned lanes)
{
    float seen_m[8];
    for (int k = 0; k < 8; k++) {
        double linear[photo_channels];
        seen_m[k] = INFINITY;
        if (photo->mips > 0 && lanes >> k & 1 && photo_at(linear, photo, x_m[k], y_m[k], photo->cell_m) > 0.5)
            seen_m[k] = (float)(2 * photo->cell_m);
    }
    return f32x8_load(seen_m);
}

/* One eight of places; lanes: those of a known class. */
static F32x8 textures(const Cover *cover, PlotCells *cells, I32x8 class, const double x_m[8], const double y_m[8],
                      F32x8 footprint_m, unsigned lanes)
{
    static const double crop_rows_m = 0.75, furrows_m = 1.1;
    const uint64_t      seed = cover->seed + 20;
    const F32x8         seen_m = photo_fineness(&cover->photo, x_m, y_m, lanes), known = f32x8_mask(lanes);
    const I32x8      row = i32x8_mul(class, i32x8_set(octave_count));
    F32x8               sum = f32x8_set(1);
    for (int n = octave_count - 1; n >= 0; n--) {
        F32x8 share = fade(octave_m[n], footprint_m);
        share = f32x8_and(f32x8_and(share, known), f32x8_less(f32x8_set(octave_m[n]), seen_m));
        if (!f32x8_bits(f32x8_greater(share, f32x8_set(0)))) continue;
        const F32x8 strength = _mm256_mask_i32gather_ps(f32x8_set(0), &amplitude[0][n], row, known, 4);
        sum = f32x8_fma(share * strength, noise_eight(seed + (uint64_t)n, octave_m[n], x_m, y_m), sum);
    }
    const struct {
        SurfaceClass class;
        double       apart_m;
    } rows[] = {{SURFACE_CROP, crop_rows_m}, {SURFACE_PLOUGHED, furrows_m}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const F32x8 ours = i32x8_equal(class, i32x8_set(rows[k].class));
        F32x8       share = fade(rows[k].apart_m, footprint_m);
        share = f32x8_and(f32x8_and(share, f32x8_and(ours, known)), f32x8_less(f32x8_set(rows[k].apart_m), seen_m));
        const unsigned some = f32x8_bits(f32x8_greater(share, f32x8_set(0)));
        if (!some) continue;
        const F32x8 wave = rows_of(cells, cover->seed, x_m, y_m, rows[k].apart_m, some);
        sum = f32x8_fma(f32x8_set(0.08) * share, wave, sum);
    }
    return f32x8_select(known, f32x8_clamp(sum, 0.6, 1.4), f32x8_set(1));
}

void landscape_textures(float *texture, const Landscape *landscape, int count, const uint8_t *surface,
                        const double *x_m, const double *y_m, const float *footprint_m)
{
    const Cover *cover = landscape->cover;
    PlotCells    cells;
    for (int k = 0; k < plot_cells_kept; k++) cells.cell[k].known = false;
    for (int first = 0; first < count; first += 8) {
        double    x[8], y[8];
        float     footprint[8] = {0}, out[8];
        int32_t   class[8] = {0};
        unsigned  lanes = 0;
        const int some = count - first < 8 ? count - first : 8;
        for (int k = 0; k < 8; k++) {
            x[k] = k < some ? x_m[first + k] : 0, y[k] = k < some ? y_m[first + k] : 0;
            if (k < some) footprint[k] = footprint_m[first + k], class[k] = surface[first + k];
            const bool known = class[k] > SURFACE_NONE && class[k] < SURFACE_COUNT && isfinite(x[k]) && isfinite(y[k]);
            lanes |= (unsigned)(cover && known) << k;
        }
        if (!lanes) {
            for (int k = 0; k < some; k++) texture[first + k] = 1;
            continue;
        }
        const F32x8 wide = f32x8_max(f32x8_load(footprint), f32x8_set(0)); /* NaN: 0 */
        f32x8_store(out, textures(cover, &cells, i32x8_load(class), x, y, wide, lanes));
        memcpy(texture + first, out, (size_t)some * sizeof *out);
    }
}

double landscape_texture(const Landscape *landscape, SurfaceClass surface, double x_m, double y_m, double footprint_m)
{
    const float   wide = (float)footprint_m;
    const uint8_t class = surface > SURFACE_NONE && surface < SURFACE_COUNT ? (uint8_t)surface : SURFACE_NONE;
    float         texture;
    landscape_textures(&texture, landscape, 1, &class, &x_m, &y_m, &wide);
    return (double)texture;
}

/* ---- photograph ----------------------------------------------------------------------------- */

void cover_measure_photo(Landscape *landscape)
{
    /* classes of few pixels lean on the mean of all: a class of a single dark pixel would amplify the others */
    static const double enough = 200, most = 400e3;
    Cover *cover = landscape->cover;
    Photo *p = &cover->photo;
    if (p->mips == 0) return;
    int k = 0;
    while (k < p->mips - 1 && (double)p->nx[k] * p->ny[k] > most) k++;
    const double cell_m = p->cell_m * exp2(k);
    double       sum[SURFACE_COUNT][photo_channels] = {{0}}, count[SURFACE_COUNT] = {0}, all[photo_channels] = {0},
        total = 0;
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
