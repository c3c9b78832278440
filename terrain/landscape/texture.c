/* terrain/landscape/texture.c: brightness of the ground relative to the mean of its class, from the
 * photograph. */
#include "terrain/landscape/landscape_private.h"

/* ---- photograph ----------------------------------------------------------------------------- */

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
