/* terrain/elevation/raster_patch.c: a window of a raster: averaged, its voids filled, and reduced to mip levels. */
#include "terrain/elevation/raster_patch.h"

#include <stdlib.h>

void raster_patch_free(RasterPatch *patch)
{
    for (int k = 0; k < raster_patch_most_mips; k++) free(patch->v[k]);
    free(patch->hole);
    free(patch->share);
    *patch = (RasterPatch){0};
}

/* Averages rows: mean of the valid pixels, NaN where none is valid. in: `rows` rows of `width` pixels, `pitch` floats
 * apart. */
static void average_row(float *restrict out, int nx, const float *restrict in, size_t pitch, int width, int rows,
                        int factor)
{
    if (factor == 1) {
        memcpy(out, in, (size_t)nx * sizeof *out);
        return;
    }
    for (int i = 0; i < nx; i++) {
        double sum = 0;
        int    count = 0;
        for (int r = 0; r < rows; r++)
            for (int c = i * factor; c < (i + 1) * factor && c < width; c++) {
                const float value = in[(size_t)r * pitch + (size_t)c];
                if (isnan(value)) continue;
                sum += (double)value;
                count++;
            }
        out[i] = count ? (float)(sum / count) : NAN;
    }
}

/* ---- mips ------------------------------------------------------------------------------------ */

typedef struct Halving {
    float       *out;
    const float *in;
    int          out_nx, out_ny, nx, ny;
} Halving;

enum { rows_a_task = 64 };

static void halve_rows(void *user, int worker, int task)
{
    const Halving *h = user;
    (void)worker;
    const int end = (task + 1) * rows_a_task < h->out_ny ? (task + 1) * rows_a_task : h->out_ny;
    for (int j = task * rows_a_task; j < end; j++)
        for (int i = 0; i < h->out_nx; i++) {
            double sum = 0;
            int    count = 0;
            for (int b = 2 * j; b < 2 * j + 2 && b < h->ny; b++)
                for (int a = 2 * i; a < 2 * i + 2 && a < h->nx; a++) {
                    const float value = h->in[(size_t)b * (size_t)h->nx + (size_t)a];
                    if (isnan(value)) continue;
                    sum += (double)value;
                    count++;
                }
            h->out[(size_t)j * (size_t)h->out_nx + (size_t)i] = count ? (float)(sum / count) : NAN;
        }
}

static void halve(RasterPatch *p, int k, Pool *pool)
{
    Halving h = {p->v[k], p->v[k - 1], p->nx[k], p->ny[k], p->nx[k - 1], p->ny[k - 1]};
    (void)pool_run_unless_stopped(pool, (h.out_ny + rows_a_task - 1) / rows_a_task, halve_rows, &h);
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

/* Value between the posts of one mip at a place in pixels of the raster; from the wider patch where the patch's own
 * mips end. */
static double mip_at(const RasterPatch *p, int k, double x_px, double y_px)
{
    if (k >= p->mips) {
        k -= p->mips;
        p = p->wider;
        if (k > p->mips - 1) k = p->mips - 1;
    }
    const double s = exp2(-k);
    return bilinear(p->v[k], p->nx[k], p->ny[k], (x_px - p->x0) / p->factor * s, (y_px - p->y0) / p->factor * s);
}

/* Fills the voids of one mip: first from the coarser mip, then by relaxing them towards the mean of their neighbours,
 * so that the filling joins the rim smoothly and has no extremum of its own (a membrane; Laplace's equation). */
static Status fill(RasterPatch *p, int k)
{
    enum { sweeps = 24 };
    float       *v = p->v[k];
    const int    nx = p->nx[k], ny = p->ny[k];
    const double post_px = p->factor * exp2(k);
    const size_t posts = (size_t)nx * (size_t)ny;
    size_t       count = 0;
    for (size_t n = 0; n < posts; n++) count += isnan(v[n]);
    if (k == 0) p->voids = (long)count;
    if (count == 0) return STATUS_OK;
    size_t *at = malloc(count * sizeof *at);
    if (!at) return STATUS_NO_MEMORY;
    count = 0;
    for (size_t n = 0; n < posts; n++)
        if (isnan(v[n])) at[count++] = n;
    for (size_t n = 0; n < count; n++) {
        v[at[n]] = (float)mip_at(p, k + 1, p->x0 + post_px * ((double)(at[n] % (size_t)nx) + 0.5),
                                 p->y0 + post_px * ((double)(at[n] / (size_t)nx) + 0.5));
        if (k == 0) p->hole[at[n]] = 1;
    }
    for (int sweep = 0; sweep < sweeps && !work_stop_asked(); sweep++)
        for (size_t n = 0; n < count; n++) {
            const size_t q = sweep & 1 ? at[count - 1 - n] : at[n], i = q % (size_t)nx, j = q / (size_t)nx;
            double       sum = 0;
            int          neighbours = 0;
            if (i > 0) sum += (double)v[q - 1], neighbours++;
            if (i + 1 < (size_t)nx) sum += (double)v[q + 1], neighbours++;
            if (j > 0) sum += (double)v[q - (size_t)nx], neighbours++;
            if (j + 1 < (size_t)ny) sum += (double)v[q + (size_t)nx], neighbours++;
            if (neighbours) v[q] = (float)(sum / neighbours);
        }
    free(at);
    return STATUS_OK;
}

enum { square = 8 };

/* Number of the square of a pixel. Squares are those of the whole raster, whatever window the patch has. */
static int first_square(int px, const RasterPatch *p) { return px / p->factor / square; }
static int squares(int px, int count, const RasterPatch *p)
{
    return (px / p->factor + count - 1) / square - first_square(px, p) + 1;
}

static Status measure_holes(RasterPatch *p)
{
    const int i0 = p->x0 / p->factor, j0 = p->y0 / p->factor, a0 = first_square(p->x0, p), b0 = first_square(p->y0, p);
    const int nx = squares(p->x0, p->nx[0], p), ny = squares(p->y0, p->ny[0], p);
    if (p->voids == 0) return STATUS_OK;
    p->share = calloc((size_t)nx * (size_t)ny, sizeof *p->share);
    if (!p->share) return STATUS_NO_MEMORY;
    for (int j = 0; j < p->ny[0]; j++)
        for (int i = 0; i < p->nx[0]; i++)
            p->share[(size_t)((j + j0) / square - b0) * (size_t)nx + (size_t)((i + i0) / square - a0)] +=
                (float)p->hole[(size_t)j * (size_t)p->nx[0] + (size_t)i] / (square * square);
    return STATUS_OK;
}

double raster_patch_hole(const RasterPatch *p, double x_px, double y_px)
{
    if (!p->share) return 0;
    const double   x = (x_px - p->x0) / p->factor, y = (y_px - p->y0) / p->factor;
    const double   px = clamp(x - 0.5, 0, p->nx[0] - 1), py = clamp(y - 0.5, 0, p->ny[0] - 1);
    const int      i = (int)px, j = (int)py, e = i + 1 < p->nx[0], n = j + 1 < p->ny[0] ? p->nx[0] : 0;
    const uint8_t *at = &p->hole[(size_t)j * (size_t)p->nx[0] + (size_t)i];
    const double   south = at[0] + (px - i) * (at[e] - at[0]), north = at[n] + (px - i) * (at[n + e] - at[n]);
    const double   here = south + (py - j) * (north - south);
    if (!(here > 0)) return 0;
    const int    nx = squares(p->x0, p->nx[0], p), ny = squares(p->y0, p->ny[0], p);
    const double a = x_px / p->factor / square - first_square(p->x0, p),
                 b = y_px / p->factor / square - first_square(p->y0, p);
    double sum = 0;
    for (int k = 0; k < 9; k++) sum += bilinear(p->share, nx, ny, a + k % 3 - 1, b + k / 3 - 1);
    const double t = clamp((sum / 9 - 0.5) / 0.45, 0, 1);
    return here * t * t * (3 - 2 * t);
}

static Status fill_all(RasterPatch *p, Pool *pool)
{
    Status status = STATUS_OK;
    for (int k = 1; k < p->mips; k++) halve(p, k, pool);
    const bool none = p->wider ? p->wider->mips == 0 : isnan(p->v[p->mips - 1][0]);
    if (none) {
        raster_patch_free(p);
        return STATUS_OK;
    }
    for (int k = p->wider ? p->mips - 1 : p->mips - 2; status == STATUS_OK && k >= 0; k--) status = fill(p, k);
    if (status == STATUS_OK && work_stop_asked()) status = STATUS_IO;
    if (status == STATUS_OK) status = measure_holes(p);
    return status;
}

/* ---- reading --------------------------------------------------------------------------------- */

typedef struct Reading {
    const RasterPatchSource *source;
    const RasterPatchWindow *window;
    RasterPatch             *patch;
    int                      count;
    int     x0, x1, y0, y1, rows; /* pixels that all windows need; rows: those of a strip, which one task reads */
    Status *status;               /* [strips] */
} Reading;

/* Averages part of a strip, rows y0 .. y1 - 1 of columns x0 .. x1 - 1, into every patch that needs some of it. strip:
 * its pixels; NULL: all are `value`. */
static void average_columns(const Reading *r, const float *strip, float value, int x0, int x1, int y0, int y1)
{
    for (int w = 0; w < r->count; w++) {
        const RasterPatchWindow *of = &r->window[w];
        RasterPatch             *p = &r->patch[w];
        const int                from = y0 > p->y0 ? y0 : p->y0, to = y1 < of->y1 ? y1 : of->y1;
        const int                west = x0 > p->x0 ? x0 : p->x0, east = x1 < of->x1 ? x1 : of->x1;
        if (west >= east) continue;
        const int i0 = (west - p->x0) / p->factor, nx = (east - p->x0 + p->factor - 1) / p->factor - i0;
        for (int y = from; y < to; y += p->factor) {
            float *out = p->v[0] + (size_t)((y - p->y0) / p->factor) * (size_t)p->nx[0] + (size_t)i0;
            if (strip)
                average_row(out, nx, strip + (size_t)(y - y0) * (size_t)(x1 - x0) + (size_t)(west - x0),
                            (size_t)(x1 - x0), east - west, to - y < p->factor ? to - y : p->factor, p->factor);
            else
                for (int i = 0; i < nx; i++) out[i] = value;
        }
    }
}

/* Reads one strip in pieces of columns. These begin at multiples of raster_piece, and so of every factor: no average is
 * split between two. */
static void read_strip(void *user, int worker, int task)
{
    const Reading *r = user;
    const Raster  *raster = r->source->raster;
    (void)worker;
    const int y0 = (r->y0 / r->rows + task) * r->rows > r->y0 ? (r->y0 / r->rows + task) * r->rows : r->y0;
    const int end = (r->y0 / r->rows + task + 1) * r->rows, y1 = end < r->y1 ? end : r->y1;
    const int piece = raster_piece(raster);
    float    *strip = NULL;
    for (int x0 = r->x0, x1; x0 < r->x1 && r->status[task] == STATUS_OK; x0 = x1) {
        const int   next = (x0 / piece + 1) * piece;
        const float low = (float)r->source->low, high = (float)r->source->high;
        float       value;
        x1 = next < r->x1 ? next : r->x1;
        if (work_stop_asked()) {
            r->status[task] = STATUS_IO;
        } else if (raster_uniform(&value, raster, r->source->band, (RasterWindow){x0, y0, x1 - x0, y1 - y0},
                                  r->source->key)) {
            average_columns(r, NULL, value >= low && value <= high ? value : NAN, x0, x1, y0, y1);
        } else {
            const int    width = x1 - x0;
            const size_t count = (size_t)(y1 - y0) * (size_t)width;
            free(strip);
            strip = malloc(count * sizeof *strip);
            if (!strip) {
                r->status[task] = STATUS_NO_MEMORY;
                break;
            }
            r->status[task] =
                raster_read(strip, raster, r->source->band, (RasterWindow){x0, y0, width, y1 - y0}, r->source->key);
            if (r->status[task] != STATUS_OK) break;
            for (size_t n = 0; n < count; n++) strip[n] = strip[n] >= low && strip[n] <= high ? strip[n] : NAN;
            average_columns(r, strip, 0, x0, x1, y0, y1);
        }
    }
    free(strip);
}

static Status allocate(RasterPatch *p, const RasterPatchWindow *w)
{
    int nx = (w->x1 - w->x0 + w->factor - 1) / w->factor, ny = (w->y1 - w->y0 + w->factor - 1) / w->factor;
    int most = raster_patch_most_mips;
    *p = (RasterPatch){.factor = w->factor, .x0 = w->x0, .y0 = w->y0, .wider = w->wider};
    if (w->wider && w->wider->mips > 0)
        for (most = 0; w->factor << most < w->wider->factor;) most++;
    for (int k = 0; k < most; k++) {
        p->nx[k] = nx;
        p->ny[k] = ny;
        p->v[k] = malloc((size_t)nx * (size_t)ny * sizeof **p->v);
        if (!p->v[k]) return STATUS_NO_MEMORY;
        p->mips = k + 1;
        if (nx == 1 && ny == 1 && !w->wider) break;
        nx = (nx + 1) / 2;
        ny = (ny + 1) / 2;
    }
    p->hole = calloc((size_t)p->nx[0] * (size_t)p->ny[0], 1);
    return p->hole ? STATUS_OK : STATUS_NO_MEMORY;
}

Status raster_patches_read(RasterPatch *out, const RasterPatchWindow *window, int count,
                           const RasterPatchSource *source)
{
    const Raster      *raster = source->raster;
    RasterPatchWindow *w = calloc((size_t)count, sizeof *w);
    RasterPatch       *p = calloc((size_t)count, sizeof *p);
    Reading            r = {.source = source,
                            .window = w,
                            .patch = p,
                            .count = count,
                            .x0 = raster->width,
                            .y0 = raster->height,
                            .rows = raster->row_block > 0 ? raster->row_block : 64};
    Status             status = w && p ? STATUS_OK : STATUS_NO_MEMORY;
    for (int k = 0; status == STATUS_OK && k < count; k++) {
        w[k] = window[k];
        /* aligned to the wider patch's posts, so that the mips go on there */
        const int align = w[k].wider && w[k].wider->mips > 0 ? w[k].wider->factor : w[k].factor;
        w[k].x0 = w[k].x0 > 0 ? w[k].x0 / align * align : 0;
        w[k].y0 = w[k].y0 > 0 ? w[k].y0 / align * align : 0;
        w[k].x1 = w[k].x1 < raster->width ? w[k].x1 : raster->width;
        w[k].y1 = w[k].y1 < raster->height ? w[k].y1 : raster->height;
        if (w[k].x1 <= w[k].x0 || w[k].y1 <= w[k].y0) status = STATUS_BAD_VALUE;
        else status = allocate(&p[k], &w[k]);
        r.x0 = w[k].x0 < r.x0 ? w[k].x0 : r.x0;
        r.y0 = w[k].y0 < r.y0 ? w[k].y0 : r.y0;
        r.x1 = w[k].x1 > r.x1 ? w[k].x1 : r.x1;
        r.y1 = w[k].y1 > r.y1 ? w[k].y1 : r.y1;
        while (r.rows < w[k].factor) r.rows *= 2;
    }
    const int strips = (r.y1 - 1) / r.rows - r.y0 / r.rows + 1;
    if (status == STATUS_OK) r.status = calloc((size_t)strips, sizeof *r.status);
    if (status == STATUS_OK && !r.status) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK && !pool_run_unless_stopped(source->pool, strips, read_strip, &r)) status = STATUS_IO;
    for (int k = 0; status == STATUS_OK && k < strips; k++) status = r.status[k];
    for (int k = 0; status == STATUS_OK && k < count; k++) status = fill_all(&p[k], source->pool);
    for (int k = 0; p && k < count; k++) {
        if (status == STATUS_OK) out[k] = p[k];
        else raster_patch_free(&p[k]);
    }
    free(r.status);
    free(w);
    free(p);
    return status;
}

double raster_patch_at(const RasterPatch *patch, double x_px, double y_px, double mip)
{
    if (!(mip > 0)) return mip_at(patch, 0, x_px, y_px);
    const int most = patch->mips - 1 + (patch->wider ? patch->wider->mips : 0);
    mip = fmin(mip, most);
    const int    k = (int)mip;
    const double fine = mip_at(patch, k, x_px, y_px);
    if (!(mip > k) || k + 1 > most) return fine;
    return fine + (mip - k) * (mip_at(patch, k + 1, x_px, y_px) - fine);
}
