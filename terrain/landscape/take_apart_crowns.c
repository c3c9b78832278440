/* terrain/landscape/take_apart_crowns.c: crowns as the highest points of the canopy within a radius that grows with its
 * height (Popescu and Wynne, Photogrammetric Engineering 70, 2004), and the cells that climb to them. */
#include "terrain/landscape/take_apart_private.h"

#include <stdlib.h>

static const float most_radius_m = 12;

/* Popescu and Wynne's pines and deciduous trees together: width 2.515 + 0.00901 h^2. */
static float window_m(float height_m)
{
    const float r = (2.515F + 0.00901F * height_m * height_m) / 2;
    return r < 5 ? r : 5;
}

/* Canopy height smoothed by 1 2 1 both ways; 0 off the trees. */
static void smooth(float *to, float *row, const float *from, int nx, int ny)
{
    for (int y = 0; y < ny; y++) {
        const float *s = from + (size_t)(y > 0 ? y - 1 : y) * (size_t)nx, *m = from + (size_t)y * (size_t)nx,
            *t = from + (size_t)(y < ny - 1 ? y + 1 : y) * (size_t)nx;
        for (int x = 0; x < nx; x++) row[x] = (s[x] + 2 * m[x] + t[x]) / 4;
        for (int x = 0; x < nx; x++)
            to[(size_t)y * (size_t)nx + (size_t)x] =
                m[x] > 0 ? (row[x > 0 ? x - 1 : x] + 2 * row[x] + row[x < nx - 1 ? x + 1 : x]) / 4 : 0;
    }
}

Status take_apart_crowns(SurfaceParts *out, const SurfaceModel *model, const float *surface_m)
{
    const int    nx = model->nx, ny = model->ny;
    const size_t n = (size_t)nx * (size_t)ny;
    const float  cell = (float)model->cell_m;
    float   *raw = malloc(n * sizeof *raw), *canopy = malloc(n * sizeof *canopy);
    float   *row = malloc((size_t)nx * sizeof *row);
    int32_t *up = malloc(n * sizeof *up);
    Status   status = STATUS_NO_MEMORY;
    if (!raw || !canopy || !up || !row) goto done;
    for (size_t c = 0; c < n; c++) raw[c] = out->kind[c] == CELL_TREE ? fmaxf(surface_m[c] - out->bare_m[c], 0) : 0;
    smooth(canopy, row, raw, nx, ny);
    /* a standard deviation of 1 m: branches are no tops; each pass adds half a cell squared of variance */
    const int passes = (int)fmin(2 / (model->cell_m * model->cell_m) + 0.5, 16);
    for (int pass = 1; pass < passes; pass++) {
        memcpy(raw, canopy, n * sizeof *raw);
        smooth(canopy, row, raw, nx, ny);
    }

    /* up: the highest cell within reach, itself for a top; first of 8 neighbours, then for local tops of the window */
    size_t tops = 0;
    for (int y = 0; y < ny; y++)
        for (int x = 0; x < nx; x++) {
            const size_t c = (size_t)y * (size_t)nx + (size_t)x;
            up[c] = -1;
            if (!(canopy[c] > 0)) continue;
            size_t best = c;
            for (int k = 0; k < 9; k++) {
                const int i = x + k % 3 - 1, j = y + k / 3 - 1;
                if (i < 0 || j < 0 || i >= nx || j >= ny) continue;
                const size_t d = (size_t)j * (size_t)nx + (size_t)i;
                if (canopy[d] > canopy[best]) best = d;
            }
            if (best == c) {
                const float r_m = window_m(canopy[c]);
                const int   r = (int)(r_m / cell);
                for (int dy = -r; dy <= r; dy++)
                    for (int dx = -r; dx <= r; dx++) {
                        const int i = x + dx, j = y + dy;
                        if (i < 0 || j < 0 || i >= nx || j >= ny) continue;
                        if ((float)(dx * dx + dy * dy) * cell * cell > r_m * r_m) continue;
                        const size_t d = (size_t)j * (size_t)nx + (size_t)i;
                        if (canopy[d] > canopy[best] || (canopy[d] == canopy[best] && d < best)) best = d;
                    }
            }
            up[c] = (int32_t)best;
            tops += best == c;
        }
    out->crown = calloc(tops + 1, sizeof *out->crown);
    if (!out->crown) goto done;
    /* index of a top's crown, in the order of cells: south-west first */
    int32_t *of = (int32_t *)raw;
    for (size_t c = 0; c < n; c++) {
        of[c] = -1;
        if (up[c] != (int32_t)c) continue;
        of[c] = out->crown_count;
        out->crown[out->crown_count++] = (Crown){.x_m = ((float)(c % (size_t)nx) + 0.5F) * cell,
            .y_m = ((float)(c / (size_t)nx) + 0.5F) * cell, .height_m = surface_m[c] - out->bare_m[c]};
    }
    for (size_t c = 0; c < n; c++) {
        if (up[c] < 0) continue;
        int32_t top = up[c];
        while (up[top] != top) top = up[top];
        const float dx = (float)((int)(c % (size_t)nx) - top % nx) * cell;
        const float dy = (float)((int)(c / (size_t)nx) - top / nx) * cell;
        if (dx * dx + dy * dy <= most_radius_m * most_radius_m) out->crown[of[top]].radius_m += cell * cell;
    }
    for (int k = 0; k < out->crown_count; k++) out->crown[k].radius_m = sqrtf(out->crown[k].radius_m / 3.14159265F);
    status = STATUS_OK;
done:
    free(raw), free(canopy), free(row), free(up);
    return status;
}
