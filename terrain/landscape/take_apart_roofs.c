/* terrain/landscape/take_apart_roofs.c: roofs as facets: each cell takes the plane of the best-fitting square that
 * holds it (Haralick's facet model), so that ridges and eaves stay sharp and small furniture goes. */
#include "terrain/landscape/take_apart_private.h"

#include <stdlib.h>

typedef struct Plane {
    float height, east, north; /* at the square's centre, per cell */
    float error;               /* rms; INFINITY: none */
} Plane;

/* Least-squares plane of the roof's cells about (x, y). */
static Plane fit(const float *roof, int nx, int ny, int x, int y, int r, int spacing)
{
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sz = 0, sxz = 0, syz = 0, szz = 0;
    const float base = roof[(size_t)y * (size_t)nx + (size_t)x];
    for (int dy = -r; dy <= r; dy++)
        for (int dx = -r; dx <= r; dx++) {
            const int i = x + dx * spacing, j = y + dy * spacing;
            if (i < 0 || j < 0 || i >= nx || j >= ny) continue;
            const double z = (double)roof[(size_t)j * (size_t)nx + (size_t)i] - base;
            if (isnan(z)) continue;
            n++, sx += dx, sy += dy, sxx += dx * dx, sxy += dx * dy, syy += dy * dy;
            sz += z, sxz += dx * z, syz += dy * z, szz += z * z;
        }
    Plane p = {base, 0, 0, INFINITY};
    if (n < 6) return p;
    const double xx = sxx - sx * sx / n, xy = sxy - sx * sy / n, yy = syy - sy * sy / n, xz = sxz - sx * sz / n,
        yz = syz - sy * sz / n, det = xx * yy - xy * xy;
    if (!(det > 1e-6 * xx * yy)) return p;
    const double a = (xz * yy - yz * xy) / det, b = (yz * xx - xz * xy) / det;
    const double rest = szz - sz * sz / n - a * xz - b * yz;
    p.height = (float)(base + (sz - a * sx - b * sy) / n);
    p.east = (float)(a / spacing), p.north = (float)(b / spacing);
    p.error = (float)sqrt(fmax(rest, 0) / (n - 3));
    return p;
}

Status take_apart_roofs(SurfaceParts *out, const SurfaceModel *model, const float *surface_m)
{
    const int    nx = model->nx, ny = model->ny;
    const size_t n = (size_t)nx * (size_t)ny;
    int32_t *place = malloc(n * sizeof *place);
    if (!place) return STATUS_NO_MEMORY;
    size_t count = 0;
    for (size_t c = 0; c < n; c++) {
        const bool roof = out->kind[c] == CELL_BUILDING;
        place[c] = roof ? (int32_t)count++ : -1;
        out->roof_m[c] = roof && surface_m[c] - out->bare_m[c] > 1.5F ? surface_m[c] : NAN;
    }
    Plane *plane = malloc((count + 1) * sizeof *plane);
    float *next = malloc((count + 1) * sizeof *next);
    if (!plane || !next) {
        free(place), free(plane), free(next);
        return STATUS_NO_MEMORY;
    }
    const int spacing = (int)fmax(1, floor(1 / model->cell_m + 0.5)), r = 2;
    for (int pass = 0; pass < 3; pass++) {
        for (int y = 0; y < ny; y++)
            for (int x = 0; x < nx; x++) {
                const size_t c = (size_t)y * (size_t)nx + (size_t)x;
                if (place[c] >= 0) {
                    plane[place[c]] = (Plane){0, 0, 0, INFINITY};
                    if (!isnan(out->roof_m[c])) plane[place[c]] = fit(out->roof_m, nx, ny, x, y, r, spacing);
                }
            }
        for (int y = 0; y < ny; y++)
            for (int x = 0; x < nx; x++) {
                const size_t c = (size_t)y * (size_t)nx + (size_t)x;
                if (place[c] < 0) continue;
                float best = INFINITY, height = out->roof_m[c];
                for (int dy = -r; dy <= r; dy++)
                    for (int dx = -r; dx <= r; dx++) {
                        const int i = x + dx * spacing, j = y + dy * spacing;
                        if (i < 0 || j < 0 || i >= nx || j >= ny) continue;
                        const int32_t at = place[(size_t)j * (size_t)nx + (size_t)i];
                        if (at < 0 || !(plane[at].error < best)) continue;
                        best = plane[at].error;
                        height = plane[at].height - plane[at].east * (float)(dx * spacing)
                            - plane[at].north * (float)(dy * spacing);
                    }
                next[place[c]] = height;
            }
        for (size_t c = 0; c < n; c++)
            if (place[c] >= 0) out->roof_m[c] = next[place[c]];
    }
    /* a cell without any plane is no roof */
    for (size_t c = 0; c < n; c++)
        if (place[c] >= 0 && isnan(out->roof_m[c])) out->kind[c] = CELL_BARE;
    free(place), free(plane), free(next);
    return STATUS_OK;
}
