/* terrain/elevation/patch.c: a window of a raster: averaged, its voids filled, and reduced to mip levels. */
#include "terrain/elevation/patch.h"

#include <stdlib.h>

void patch_free(Patch *patch)
{
    for (int k = 0; k < patch_most_mips; k++) free(patch->v[k]);
    free(patch->hole);
    *patch = (Patch){0};
}

/* Mean of what is valid, NaN where nothing is. in: rows of `width` pixels of the raster, factor of them. */
static void average_row(float *out, int nx, const float *in, int width, int rows, int factor)
{
    for (int i = 0; i < nx; i++) {
        double sum = 0;
        int    count = 0;
        for (int r = 0; r < rows; r++)
            for (int c = i * factor; c < (i + 1) * factor && c < width; c++) {
                const float value = in[(size_t)r * (size_t)width + (size_t)c];
                if (isnan(value)) continue;
                sum += value;
                count++;
            }
        out[i] = count ? (float)(sum / count) : NAN;
    }
}

static void halve(float *out, int out_nx, int out_ny, const float *in, int nx, int ny)
{
    for (int j = 0; j < out_ny; j++)
        for (int i = 0; i < out_nx; i++) {
            double sum = 0;
            int    count = 0;
            for (int b = 2 * j; b < 2 * j + 2 && b < ny; b++)
                for (int a = 2 * i; a < 2 * i + 2 && a < nx; a++) {
                    const float value = in[(size_t)b * (size_t)nx + (size_t)a];
                    if (isnan(value)) continue;
                    sum += value;
                    count++;
                }
            out[(size_t)j * (size_t)out_nx + (size_t)i] = count ? (float)(sum / count) : NAN;
        }
}

static double bilinear(const float *v, int nx, int ny, double x, double y)
{
    x = clamp(x - 0.5, 0, nx - 1);
    y = clamp(y - 0.5, 0, ny - 1);
    const int    i = (int)x < nx - 1 ? (int)x : nx > 1 ? nx - 2 : 0, j = (int)y < ny - 1 ? (int)y : ny > 1 ? ny - 2 : 0;
    const double u = x - i, w = y - j;
    const float *a = v + (size_t)j * (size_t)nx + i, *b = ny > 1 ? a + nx : a;
    const int    e = nx > 1;
    const double south = a[0] + u * (a[e] - a[0]), north = b[0] + u * (b[e] - b[0]);
    return south + w * (north - south);
}

/* Voids of one mip: first from the coarser one, then relaxed towards the mean of the neighbours, so that the
 * filling meets the rim without a step and has no extremum of its own (a membrane; Laplace's equation). */
static Status fill(float *v, int nx, int ny, const float *coarse, int coarse_nx, int coarse_ny, uint8_t *hole,
                   long *voids)
{
    enum { sweeps = 24 };
    const size_t posts = (size_t)nx * (size_t)ny;
    size_t       count = 0;
    for (size_t n = 0; n < posts; n++) count += isnan(v[n]);
    if (voids) *voids = (long)count;
    if (count == 0) return STATUS_OK;
    size_t *at = malloc(count * sizeof *at);
    if (!at) return STATUS_NO_MEMORY;
    count = 0;
    for (size_t n = 0; n < posts; n++)
        if (isnan(v[n])) at[count++] = n;
    for (size_t n = 0; n < count; n++) {
        v[at[n]] = (float)bilinear(coarse, coarse_nx, coarse_ny, 0.5 * ((double)(at[n] % (size_t)nx) + 0.5),
                                   0.5 * ((double)(at[n] / (size_t)nx) + 0.5));
        if (hole) hole[at[n]] = 1;
    }
    for (int sweep = 0; sweep < sweeps; sweep++)
        for (size_t n = 0; n < count; n++) {
            const size_t p = sweep & 1 ? at[count - 1 - n] : at[n], i = p % (size_t)nx, j = p / (size_t)nx;
            double       sum = 0;
            int          neighbours = 0;
            if (i > 0) sum += v[p - 1], neighbours++;
            if (i + 1 < (size_t)nx) sum += v[p + 1], neighbours++;
            if (j > 0) sum += v[p - (size_t)nx], neighbours++;
            if (j + 1 < (size_t)ny) sum += v[p + (size_t)nx], neighbours++;
            if (neighbours) v[p] = (float)(sum / neighbours);
        }
    free(at);
    return STATUS_OK;
}

static Status read_posts(Patch *p, const Raster *raster, int band, int width, int height, double low, double high,
                         const char *key)
{
    int rows = p->factor; /* a strip of about a megapixel, complete rows of the patch */
    while ((int64_t)rows * width < 1 << 20 && rows < height) rows += p->factor;
    float *strip = malloc((size_t)rows * (size_t)width * sizeof *strip);
    if (!strip) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    for (int y = 0; status == STATUS_OK && y < height; y += rows) {
        const int here = height - y < rows ? height - y : rows;
        status = raster_read(strip, raster, band, p->x0, p->y0 + y, width, here, key);
        if (status != STATUS_OK) break;
        const size_t count = (size_t)here * (size_t)width;
        for (size_t n = 0; n < count; n++)
            if (!(strip[n] >= low && strip[n] <= high)) strip[n] = NAN;
        for (int r = 0; r < here; r += p->factor)
            average_row(p->v[0] + (size_t)((y + r) / p->factor) * (size_t)p->nx[0], p->nx[0],
                        strip + (size_t)r * (size_t)width, width, here - r < p->factor ? here - r : p->factor,
                        p->factor);
    }
    free(strip);
    return status;
}

Status patch_read(Patch *out, const Raster *raster, int band, int x0, int y0, int x1, int y1, int factor, double low,
                  double high, const char *key)
{
    x0 = x0 > 0 ? x0 / factor * factor : 0;
    y0 = y0 > 0 ? y0 / factor * factor : 0;
    x1 = x1 < raster->width ? x1 : raster->width;
    y1 = y1 < raster->height ? y1 : raster->height;
    if (x1 <= x0 || y1 <= y0) return STATUS_BAD_VALUE;
    Patch p = {.factor = factor, .x0 = x0, .y0 = y0};
    int   nx = (x1 - x0 + factor - 1) / factor, ny = (y1 - y0 + factor - 1) / factor, k = 0;
    Status status = STATUS_OK;
    for (;; k++) {
        p.nx[k] = nx;
        p.ny[k] = ny;
        p.v[k]  = malloc((size_t)nx * (size_t)ny * sizeof **p.v);
        if (!p.v[k]) status = STATUS_NO_MEMORY;
        if (status != STATUS_OK || (nx == 1 && ny == 1) || k == patch_most_mips - 1) break;
        nx = (nx + 1) / 2;
        ny = (ny + 1) / 2;
    }
    p.mips = k + 1;
    p.hole = calloc((size_t)p.nx[0] * (size_t)p.ny[0], 1);
    if (!p.hole) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = read_posts(&p, raster, band, x1 - x0, y1 - y0, low, high, key);
    if (status != STATUS_OK) goto fail;

    for (k = 1; k < p.mips; k++) halve(p.v[k], p.nx[k], p.ny[k], p.v[k - 1], p.nx[k - 1], p.ny[k - 1]);
    if (isnan(p.v[p.mips - 1][0])) {
        patch_free(&p);
        *out = p;
        return STATUS_OK;
    }
    for (k = p.mips - 2; status == STATUS_OK && k >= 0; k--)
        status = fill(p.v[k], p.nx[k], p.ny[k], p.v[k + 1], p.nx[k + 1], p.ny[k + 1], k ? NULL : p.hole,
                      k ? NULL : &p.voids);
    if (status != STATUS_OK) goto fail;
    *out = p;
    return STATUS_OK;

fail:
    patch_free(&p);
    return status;
}

double patch_at(const Patch *patch, double x_px, double y_px, double mip)
{
    const double x = (x_px - patch->x0) / patch->factor, y = (y_px - patch->y0) / patch->factor;
    if (!(mip > 0)) return bilinear(patch->v[0], patch->nx[0], patch->ny[0], x, y);
    mip = fmin(mip, patch->mips - 1);
    const int    k = (int)mip;
    const double s = exp2(-k), fine = bilinear(patch->v[k], patch->nx[k], patch->ny[k], x * s, y * s);
    if (!(mip > k) || k + 1 >= patch->mips) return fine;
    const double coarse = bilinear(patch->v[k + 1], patch->nx[k + 1], patch->ny[k + 1], 0.5 * x * s, 0.5 * y * s);
    return fine + (mip - k) * (coarse - fine);
}
