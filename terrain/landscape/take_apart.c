/* terrain/landscape/take_apart.c: a surface model taken apart into bare ground, buildings and trees, step by step. */
#include "terrain/landscape/take_apart_private.h"

#include <stdlib.h>

static const float most_height_m = 12000, spike_m = 30;

/* The surface without what cannot be: infinities, heights off the Earth, single cells that tower above all others
 * around. NAN: void. */
static void clean(float *out, const float *z, int nx, int ny)
{
    for (int y = 0; y < ny; y++)
        for (int x = 0; x < nx; x++) {
            const size_t c = (size_t)y * (size_t)nx + (size_t)x;
            out[c] = fabsf(z[c]) <= most_height_m ? z[c] : NAN;
            if (isnan(out[c]) || x == 0 || y == 0 || x == nx - 1 || y == ny - 1) continue;
            float greatest = -INFINITY, least = INFINITY;
            for (int k = 0; k < 9; k++) {
                const float v = z[c + (size_t)(k % 3) + (size_t)(k / 3) * (size_t)nx - (size_t)nx - 1];
                if (k == 4 || !(fabsf(v) <= most_height_m)) continue;
                if (v > greatest) greatest = v;
                if (v < least) least = v;
            }
            if (out[c] > greatest + spike_m) out[c] = greatest;
            if (out[c] < least - spike_m) out[c] = least;
        }
}

static Status find_bare(SurfaceParts *out, const SurfaceModel *model, const float *surface_m, float *work)
{
    const size_t n = (size_t)model->nx * (size_t)model->ny;
    uint8_t *is_ground = out->kind;
    if (!model->bare_m) return take_apart_ground(out->bare_m, is_ground, model, surface_m, 0);

    /* the terrain model is ground but for roofs that were left in it, all of them large */
    clean(work, model->bare_m, model->nx, model->ny);
    size_t holes = 0;
    for (size_t c = 0; c < n; c++) holes += isnan(work[c]);
    if (holes)
        for (size_t c = 0; c < n; c++)
            if (isnan(work[c])) work[c] = surface_m[c];
    return take_apart_ground(out->bare_m, is_ground, model, work, holes ? 0 : 8);
}

Status surface_take_apart(SurfaceParts *out, const SurfaceModel *model)
{
    if (!(model->cell_m >= 0.1 && model->cell_m <= 4)) return STATUS_UNSUPPORTED;
    if (model->nx < 1 || model->ny < 1) return STATUS_BAD_VALUE;
    const size_t n = (size_t)model->nx * (size_t)model->ny;
    out->crown_count = 0, out->crown = NULL;
    float *surface_m = malloc(n * sizeof *surface_m);
    if (!surface_m) return STATUS_NO_MEMORY;
    clean(surface_m, model->surface_m, model->nx, model->ny);
    Status status = find_bare(out, model, surface_m, out->roof_m);
    if (status == STATUS_OK) status = take_apart_kinds(out, model, surface_m);
    if (status == STATUS_OK) status = take_apart_roofs(out, model, surface_m);
    if (status == STATUS_OK) status = take_apart_crowns(out, model, surface_m);
    free(surface_m);
    return status;
}
