/* render/frame/pixels.c: eye rays through pixels, and means over them. */
#include "render/frame/pixels.h"

void pixels_rays(Rays *rays, const PixelBlock *block, const View *view)
{
    const int     samples = block->n * block->n;
    const double *r = view->r_enu_from_cam, centre_x = 0.5 * view->width, centre_y = 0.5 * view->height;
    const double  focal_px = view->focal_px;
    double        place[256][2], column_px[hits_capacity], row_px[hits_capacity];
    double *const restrict dx = rays->d_enu[0], *const restrict dy = rays->d_enu[1], *const restrict dz = rays->d_enu[2];
    const int     count = block->pixels * samples;
    for (int k = 0; k < samples; k++) sample_place(place[k], block->n, k);
    for (int p = 0, i = 0; p < block->pixels; p++)
        for (int k = 0; k < samples; k++, i++) {
            column_px[i] = block->x[p] + place[k][0];
            row_px[i]    = block->y[p] + place[k][1];
        }
    if (view_has_lens(view)) {
        for (int i = 0; i < count; i++) {
            double at[2];
            lens_back_within(at, &view->lens, (column_px[i] - centre_x) / focal_px, (row_px[i] - centre_y) / focal_px);
            const double n = 1 / sqrt(at[0] * at[0] + at[1] * at[1] + 1), x = n * at[0], y = n * at[1], z = n * 1;
            dx[i] = r[0] * x + r[1] * y + r[2] * z;
            dy[i] = r[3] * x + r[4] * y + r[5] * z;
            dz[i] = r[6] * x + r[7] * y + r[8] * z;
        }
    }
    if (!view_has_lens(view)) view_rays((double *const[3]){dx, dy, dz}, view, count, column_px, row_px);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) rays->o_enu[k][i] = view->p_enu[k];
        rays->far_m[i] = INFINITY;
    }
    rays->count   = count;
    rays->columns = block->columns;
}

static void span(double *from, double *to, const uint16_t *at, int count)
{
    uint16_t low = UINT16_MAX, high = 0;
    for (int p = 0; p < count; p++) low = at[p] < low ? at[p] : low, high = at[p] > high ? at[p] : high;
    *from = count > 0 ? low : INFINITY, *to = count > 0 ? high + 1.0 : -INFINITY;
}

void pixels_box(double box_px[4], const PixelBlock *block)
{
    span(&box_px[0], &box_px[2], block->x, block->pixels);
    span(&box_px[1], &box_px[3], block->y, block->pixels);
}

void pixels_keys(uint64_t *key, const PixelBlock *block, const Hits *hits, int width)
{
    const int samples = block->n * block->n;
    for (int i = 0, within = 0, before = -1; i < hits->count; i++) {
        const int p = hit_pixel(block, hits, i);
        within = hits->several ? (p == before ? within + 1 : 0) : i % samples;
        before = p;
        key[i] = (((uint64_t)block->y[p] * (uint64_t)width + (uint64_t)block->x[p]) * 32 + (uint64_t)block->n) * 256 +
                 (uint64_t)within;
    }
}

int pixels_run(const PixelBlock *block, int p)
{
    int run = 1;
    while (p + run < block->pixels && block->y[p + run] == block->y[p] && block->x[p + run] == block->x[p] + run) run++;
    return run;
}

int pixels_centre_sample(int n)
{
    int    best = 0;
    double least = INFINITY;
    for (int i = 0; i < n * n; i++) {
        double place[2];
        sample_place(place, n, i);
        const double square = (place[0] - 0.5) * (place[0] - 0.5) + (place[1] - 0.5) * (place[1] - 0.5);
        if (square < least) least = square, best = i;
    }
    return best;
}

/* A mean into a pixel. */
static void mix_in(float *pixel, double mean, double share)
{
    *pixel = (float)(share == 1 ? mean : (1 - share) * (double)*pixel + share * mean);
}

void pixels_average(float *plane, int width, const PixelBlock *block, const Hits *hits, const float *value,
                    double share)
{
    const int samples = block->n * block->n;
    if (hits->several) {
        for (int i = 0, p = 0; p < block->pixels; p++) {
            double sum = 0;
            for (; i < hits->count && hit_pixel(block, hits, i) == p; i++) sum += hit_share(block, hits, i) * value[i];
            mix_in(&plane[(size_t)block->y[p] * (size_t)width + block->x[p]], sum, share);
        }
        return;
    }
    if (samples == 1 && share == 1) {
        for (int p = 0, run; p < block->pixels; p += run) {
            run = pixels_run(block, p);
            memcpy(plane + (size_t)block->y[p] * (size_t)width + block->x[p], value + p, (size_t)run * sizeof *plane);
        }
        return;
    }
    for (int p = 0; p < block->pixels; p++) {
        double sum = 0;
        for (int k = 0; k < samples; k++) sum += value[p * samples + k];
        mix_in(&plane[(size_t)block->y[p] * (size_t)width + block->x[p]], sum * (1.0 / samples), share);
    }
}
