/* terrain/bare_earth/take_apart.c: a surface model taken apart into bare ground, buildings and trees, step by step; its
 * roofs and its crowns. */
#include "terrain/bare_earth/take_apart_private.h"

#include <stdlib.h>

/* ---- roofs --------------------------------------------------------------------------------------- */

/* Roofs are facets: each cell takes the plane of the best-fitting square that holds it (Haralick's facet model), so
 * that ridges and eaves stay sharp and small furniture goes. */
typedef struct Plane {
    float height, east, north; /* at the square's centre, per cell */
    float error;               /* rms error of the fit; INFINITY: no plane */
} Plane;

/* Least-squares plane of the roof's cells about (x, y). */
static Plane fit(const float *roof, int nx, int ny, int x, int y, int r, int spacing)
{
    double      n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sz = 0, sxz = 0, syz = 0, szz = 0;
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

/* Computes the roofs of cells that are CELL_BUILDING. */
static Status take_apart_roofs(SurfaceParts *out, const SurfaceModel *model, const float *surface_m)
{
    const int    nx = model->nx, ny = model->ny;
    const size_t n = (size_t)nx * (size_t)ny;
    int32_t     *place = malloc(n * sizeof *place);
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
                        height = plane[at].height - plane[at].east * (float)(dx * spacing) -
                                 plane[at].north * (float)(dy * spacing);
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

/* ---- crowns -------------------------------------------------------------------------------------- */

static const float most_radius_m = 12;

/* Window of a crown by its height: Popescu and Wynne's pines and deciduous trees together, width 2.515 + 0.00901 h^2.
 * */
static float window_m(float height_m)
{
    const float r = (2.515F + 0.00901F * height_m * height_m) / 2;
    return r < 5 ? r : 5;
}

/* Smooths the canopy's height by 1 2 1 both ways; it is 0 off the trees. */
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

/* Crowns of the cells that are CELL_TREE: the highest points of the canopy within a radius that grows with its height
 * (Popescu and Wynne, Photogrammetric Engineering 70, 2004), and the cells that climb to them. */
static Status take_apart_crowns(SurfaceParts *out, const SurfaceModel *model, const float *surface_m)
{
    const int    nx = model->nx, ny = model->ny;
    const size_t n = (size_t)nx * (size_t)ny;
    const float  cell = (float)model->cell_m;
    float       *raw = malloc(n * sizeof *raw), *canopy = malloc(n * sizeof *canopy);
    float       *row = malloc((size_t)nx * sizeof *row);
    int32_t     *up = malloc(n * sizeof *up);
    Status       status = STATUS_NO_MEMORY;
    if (!raw || !canopy || !up || !row) goto done;
    for (size_t c = 0; c < n; c++) raw[c] = out->kind[c] == CELL_TREE ? fmaxf(surface_m[c] - out->bare_m[c], 0) : 0;
    smooth(canopy, row, raw, nx, ny);
    /* smooths with a standard deviation of 1 m, since branches are not tops; each pass adds half a cell squared of
     * variance */
    const int passes = (int)fmin(2 / (model->cell_m * model->cell_m) + 0.5, 16);
    for (int pass = 1; pass < passes; pass++) {
        memcpy(raw, canopy, n * sizeof *raw);
        smooth(canopy, row, raw, nx, ny);
    }

    /* up: the highest cell within reach, which is itself for a top; first among 8 neighbours, then among local tops in
     * the window */
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
                                                 .y_m = ((float)(c / (size_t)nx) + 0.5F) * cell,
                                                 .height_m = surface_m[c] - out->bare_m[c]};
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

/* ---- the steps ----------------------------------------------------------------------------------- */

static const float most_height_m = 12000, spike_m = 30;

/* Copies the surface without impossible values: infinities, heights off the Earth, single cells that tower above all
 * others around. NAN: void. */
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
    uint8_t     *is_ground = out->kind;
    if (!model->bare_m) return take_apart_ground(out->bare_m, is_ground, model, surface_m, 0);

    /* the terrain model is ground, except for roofs left in it, all of which are large */
    clean(work, model->bare_m, model->nx, model->ny);
    size_t holes = 0;
    for (size_t c = 0; c < n; c++) holes += isnan(work[c]);
    if (holes)
        for (size_t c = 0; c < n; c++)
            if (isnan(work[c])) work[c] = surface_m[c];
    return take_apart_ground(out->bare_m, is_ground, model, work, holes ? 0 : 8);
}

Status take_apart_surface(SurfaceParts *out, const SurfaceModel *model)
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
