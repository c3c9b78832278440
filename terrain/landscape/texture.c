/* terrain/landscape/texture.c: brightness of the ground relative to the mean of its class: rows of fields, and the
 * photograph. */
#include "terrain/landscape/detail_private.h"
#include "terrain/landscape/landscape_eight_private.h"

/* ---- rows of fields ------------------------------------------------------------------------- */

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

void texture_photo_cells(float cell_m[8], const Landscape *landscape, const double x_m[8], const double y_m[8],
                         unsigned lanes)
{
    const Photo *photo = &((const Cover *)landscape->cover)->photo;
    for (int k = 0; k < 8; k++) {
        cell_m[k] = 0;
        if (photo->mips > 0 && lanes >> k & 1 && photo_cover_at(photo, x_m[k], y_m[k]) > 0.5)
            cell_m[k] = (float)photo->cell_m;
    }
}

void texture_rows(float *albedo, const Landscape *landscape, int count, const uint8_t *surface, const double *x_m,
                  const double *y_m, const float *footprint_m)
{
    static const struct {
        SurfaceClass class;
        double       apart_m;
    } rows[] = {{SURFACE_CROP, 0.75}, {SURFACE_PLOUGHED, 1.1}};
    const Cover *cover = landscape->cover;
    PlotCells    cells;
    if (!cover) return;
    for (int k = 0; k < plot_cells_kept; k++) cells.cell[k].known = false;
    for (int first = 0; first < count; first += 8) {
        double    x[8] = {0}, y[8] = {0};
        float     footprint[8] = {0}, factor[8] = {0}, cell_m[8];
        const int some = count - first < 8 ? count - first : 8;
        for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
            unsigned lanes = 0;
            for (int k = 0; k < some; k++) {
                const int i = first + k;
                if (surface[i] != rows[r].class || !(footprint_m[i] < rows[r].apart_m / 2)) continue;
                if (!isfinite(x_m[i]) || !isfinite(y_m[i])) continue;
                x[k] = x_m[i], y[k] = y_m[i], footprint[k] = footprint_m[i], factor[k] = albedo[i];
                lanes |= 1u << k;
            }
            if (!lanes) continue;
            F32x8 share = f32x8_and(fade(rows[r].apart_m, f32x8_load(footprint)), f32x8_mask(lanes));
            texture_photo_cells(cell_m, landscape, x, y, lanes);
            const F32x8 photo_m = f32x8_load(cell_m); /* which has the rows itself from two of its pixels on */
            share = f32x8_and_not(share, f32x8_and(f32x8_greater(photo_m, f32x8_set(0)),
                                                   f32x8_less(photo_m, f32x8_set(rows[r].apart_m / 2))));
            const F32x8 wave = rows_of(&cells, cover->seed, x, y, rows[r].apart_m, lanes);
            f32x8_store(factor, f32x8_load(factor) * f32x8_fma(f32x8_set(0.08) * share, wave, f32x8_set(1)));
            for (int k = 0; k < some; k++)
                if (lanes >> k & 1) albedo[first + k] = factor[k];
        }
    }
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
