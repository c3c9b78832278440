/* sensor/detector/array_noise.c: three-dimensional noise, generated and estimated; defective pixels, inserted and
 * replaced. */
#include "sensor/detector/array_noise.h"

#include <stdlib.h>

const char *const noise_axis_name[noise_axes] = {"tvh", "tv", "th", "vh", "t", "v", "h"};

static const bool has_t[noise_axes] = {true, true, true, false, true, false, false};
static const bool has_v[noise_axes] = {true, true, false, true, false, true, false};
static const bool has_h[noise_axes] = {true, false, true, true, false, false, true};

double noise3d_unit(NoiseAxis axis, uint64_t seed, uint32_t stream, int frame, int row, int column)
{
    /* these streams are separate from the small numbers used elsewhere */
    const uint32_t own = 0x3d000000u + 8 * stream + (uint32_t)axis;
    return random_normal(seed, own, has_t[axis] ? (uint32_t)frame : 0,
                         (uint64_t)(has_v[axis] ? row : 0) << 32 | (uint32_t)(has_h[axis] ? column : 0));
}

double noise3d_at(const Noise3d *noise, uint64_t seed, uint32_t stream, int frame, int row, int column)
{
    double sum = 0;
    for (int k = 0; k < noise_axes; k++)
        if (noise->sigma[k] > 0) sum += noise->sigma[k] * noise3d_unit((NoiseAxis)k, seed, stream, frame, row, column);
    return sum;
}

/* Adds the components of the axes given: whole(frame) + rows(frame, row) + columns(frame, column) + pixels. */
static void add(float *plane, int width, int height, const Noise3d *noise, const NoiseDraw *draw,
                const NoiseAxis axis[4], double *columns)
{
    const uint64_t seed = draw->seed;
    const uint32_t stream = draw->stream;
    const int      frame = draw->frame;
    const double  *sigma = noise->sigma;
    const double   whole = axis[0] < noise_axes && sigma[axis[0]] > 0
                               ? sigma[axis[0]] * noise3d_unit(axis[0], seed, stream, frame, 0, 0)
                               : 0;
    for (int c = 0; c < width; c++)
        columns[c] =
            sigma[axis[2]] > 0 ? whole + sigma[axis[2]] * noise3d_unit(axis[2], seed, stream, frame, 0, c) : whole;
    for (int r = 0; r < height; r++) {
        const double line = sigma[axis[1]] > 0 ? sigma[axis[1]] * noise3d_unit(axis[1], seed, stream, frame, r, 0) : 0;
        float       *at = plane + (size_t)r * (size_t)width;
        if (sigma[axis[3]] > 0)
            for (int c = 0; c < width; c++)
                at[c] = (float)(at[c] + line + columns[c] +
                                sigma[axis[3]] * noise3d_unit(axis[3], seed, stream, frame, r, c));
        else
            for (int c = 0; c < width; c++) at[c] = (float)(at[c] + line + columns[c]);
    }
}

void noise3d_add_fixed(float *plane, int width, int height, const Noise3d *noise, uint64_t seed, uint32_t stream)
{
    static const NoiseAxis axis[4] = {noise_axes, NOISE_V, NOISE_H, NOISE_VH};
    double                *columns = malloc((size_t)width * sizeof *columns);
    if (!columns) { /* rare, hence without SIMD: the same numbers one by one */
        const Noise3d fixed = {.sigma = {[NOISE_V] = noise->sigma[NOISE_V],
                                         [NOISE_H] = noise->sigma[NOISE_H],
                                         [NOISE_VH] = noise->sigma[NOISE_VH]}};
        for (int r = 0; r < height; r++)
            for (int c = 0; c < width; c++)
                plane[(size_t)r * (size_t)width + (size_t)c] += (float)noise3d_at(&fixed, seed, stream, 0, r, c);
        return;
    }
    const NoiseDraw draw = {seed, stream, 0};
    add(plane, width, height, noise, &draw, axis, columns);
    free(columns);
}

void noise3d_add_moving(float *plane, int width, int height, const Noise3d *noise, const NoiseDraw *draw,
                        double *columns)
{
    static const NoiseAxis axis[4] = {NOISE_T, NOISE_TV, NOISE_TH, NOISE_TVH};
    add(plane, width, height, noise, draw, axis, columns);
}

/* ---- estimation --------------------------------------------------------------------------------- */

/* Sample variance of the residual array d[a][b] (means of rows and columns subtracted), over (a - 1)(b - 1). */
static double pair_variance(const double *d, int a, int b)
{
    double all = 0, sum = 0;
    for (int i = 0; i < a * b; i++) all += d[i];
    all /= (double)a * b;
    double *column = calloc((size_t)b, sizeof *column);
    if (!column) return NAN;
    for (int i = 0; i < a; i++)
        for (int j = 0; j < b; j++) column[j] += d[i * b + j] / a;
    for (int i = 0; i < a; i++) {
        double row = 0;
        for (int j = 0; j < b; j++) row += d[i * b + j] / b;
        for (int j = 0; j < b; j++) {
            const double x = d[i * b + j] - row - column[j] + all;
            sum += x * x;
        }
    }
    free(column);
    return sum / ((double)(a - 1) * (b - 1));
}

static double line_variance(const double *d, int n)
{
    double mean = 0, sum = 0;
    for (int i = 0; i < n; i++) mean += d[i] / n;
    for (int i = 0; i < n; i++) sum += (d[i] - mean) * (d[i] - mean);
    return sum / (n - 1);
}

Status noise3d_estimate(Noise3d *out, const float *cube, int frames, int rows, int columns)
{
    const int T = frames, V = rows, H = columns;
    double   *tv = calloc((size_t)T * (size_t)V, sizeof *tv), *th = calloc((size_t)T * (size_t)H, sizeof *th);
    double   *vh = calloc((size_t)V * (size_t)H, sizeof *vh), *t = calloc((size_t)T, sizeof *t);
    double   *v = calloc((size_t)V, sizeof *v), *h = calloc((size_t)H, sizeof *h);
    Status    status = STATUS_NO_MEMORY;
    if (!tv || !th || !vh || !t || !v || !h) goto done;

    double all = 0;
    for (int k = 0; k < T; k++)
        for (int r = 0; r < V; r++) {
            const float *at = cube + ((size_t)k * (size_t)V + (size_t)r) * (size_t)H;
            for (int c = 0; c < H; c++) {
                tv[k * V + r] += at[c] / (double)H;
                th[k * H + c] += at[c] / (double)V;
                vh[r * H + c] += at[c] / (double)T;
            }
        }
    for (int k = 0; k < T; k++)
        for (int r = 0; r < V; r++) t[k] += tv[k * V + r] / V, v[r] += tv[k * V + r] / T;
    for (int r = 0; r < V; r++)
        for (int c = 0; c < H; c++) h[c] += vh[r * H + c] / V;
    for (int k = 0; k < T; k++) all += t[k] / T;

    /* the part that is in no average */
    double sum = 0;
    for (int k = 0; k < T; k++)
        for (int r = 0; r < V; r++) {
            const float *at = cube + ((size_t)k * (size_t)V + (size_t)r) * (size_t)H;
            for (int c = 0; c < H; c++) {
                const double x = at[c] - tv[k * V + r] - th[k * H + c] - vh[r * H + c] + t[k] + v[r] + h[c] - all;
                sum += x * x;
            }
        }
    const double s_tvh = sum / ((double)(T - 1) * (V - 1) * (H - 1));
    const double S_tv = pair_variance(tv, T, V), S_th = pair_variance(th, T, H), S_vh = pair_variance(vh, V, H);
    if (isnan(S_tv + S_th + S_vh)) goto done;
    const double variance[noise_axes] = {
        [NOISE_TVH] = s_tvh,
        [NOISE_TV] = S_tv - s_tvh / H,
        [NOISE_TH] = S_th - s_tvh / V,
        [NOISE_VH] = S_vh - s_tvh / T,
        /* S_tv holds sigma_tv^2 + sigma_tvh^2 / H already: what is subtracted twice is added once */
        [NOISE_T] = line_variance(t, T) - S_tv / V - S_th / H + s_tvh / ((double)V * H),
        [NOISE_V] = line_variance(v, V) - S_tv / T - S_vh / H + s_tvh / ((double)T * H),
        [NOISE_H] = line_variance(h, H) - S_th / T - S_vh / V + s_tvh / ((double)T * V),
    };
    for (int k = 0; k < noise_axes; k++) out->sigma[k] = variance[k] > 0 ? sqrt(variance[k]) : 0;
    status = STATUS_OK;

done:
    free(tv);
    free(th);
    free(vh);
    free(t);
    free(v);
    free(h);
    return status;
}

/* ---- white ------------------------------------------------------------------------------------ */

void detector_noise(float *out, const float *in, size_t first, size_t count, double noise_sigma, const NoiseDraw *draw)
{
    if (!(noise_sigma > 0)) {
        if (out != in) memmove(out, in, count * sizeof *out);
        return;
    }
    enum { block = 256 };
    double normal[block];
    for (size_t from = 0; from < count; from += block) {
        const size_t here = count - from < block ? count - from : block;
        random_normals(normal, here, draw->seed, draw->stream, (uint32_t)draw->frame, first + from);
        for (size_t i = 0; i < here; i++) out[from + i] = (float)(in[from + i] + noise_sigma * normal[i]);
    }
}

/* ---- defective pixels: their map, their values, and replacement from neighbours ----------------- */

static const uint32_t streams = 0x3f000000u; /* does not overlap with the streams of other noise */

void bad_pixels_make(uint8_t *map, int width, int height, double share, double clustered, uint64_t seed,
                     uint32_t stream)
{
    const double begin = share / (1 + 4 * clustered); /* a cluster has 1 + 8 / 2 pixels on average */
    memset(map, PIXEL_GOOD, (size_t)width * (size_t)height);
    if (!(share > 0)) return;
    for (int r = 0; r < height; r++)
        for (int c = 0; c < width; c++) {
            const uint64_t at = (uint64_t)r << 32 | (uint32_t)c;
            if (!(random_uniform(seed, streams + 4 * stream, 0, at) < begin)) continue;
            const double  lot = random_uniform(seed, streams + 4 * stream, 1, at);
            const uint8_t kind = lot < 0.5 ? PIXEL_DEAD : lot < 0.75 ? PIXEL_HOT : PIXEL_BLINKING;
            map[(size_t)r * (size_t)width + (size_t)c] = kind;
            if (!(random_uniform(seed, streams + 4 * stream, 2, at) < clustered)) continue;
            uint32_t       sides[4];
            const uint32_t counter[4] = {(uint32_t)c, (uint32_t)r, 3, streams + 4 * stream};
            const uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
            random_u32x4(sides, counter, key);
            for (int k = 0; k < 9; k++) {
                const int y = r + k / 3 - 1, x = c + k % 3 - 1;
                if (k != 4 && sides[0] >> k & 1 && y >= 0 && y < height && x >= 0 && x < width)
                    map[(size_t)y * (size_t)width + (size_t)x] = kind;
            }
        }
}

void bad_pixels_insert(uint16_t *count, const uint8_t *map, int width, int height, uint16_t full, const NoiseDraw *draw)
{
    const size_t pixels = (size_t)width * (size_t)height;
    for (size_t i = 0; i < pixels; i++) {
        if (map[i] == PIXEL_GOOD) continue;
        if (map[i] == PIXEL_DEAD) count[i] = 0;
        else if (map[i] == PIXEL_HOT ||
                 random_uniform(draw->seed, streams + 4 * draw->stream + 1, (uint32_t)draw->frame / 8, i) < 0.5)
            count[i] = full;
    }
}

void bad_pixels_replace(uint16_t *count, const uint8_t *map, int width, int height)
{
    for (int r = 0; r < height; r++)
        for (int c = 0; c < width; c++) {
            if (map[(size_t)r * (size_t)width + (size_t)c] == PIXEL_GOOD) continue;
            for (int ring = 1; ring <= 8; ring++) {
                uint32_t sum = 0, good = 0;
                for (int y = r - ring; y <= r + ring; y++)
                    for (int x = c - ring; x <= c + ring; x++) {
                        if (y < 0 || y >= height || x < 0 || x >= width) continue;
                        if (abs(y - r) != ring && abs(x - c) != ring) continue;
                        const size_t i = (size_t)y * (size_t)width + (size_t)x;
                        if (map[i] != PIXEL_GOOD) continue;
                        sum += count[i];
                        good++;
                    }
                if (good == 0) continue;
                count[(size_t)r * (size_t)width + (size_t)c] = (uint16_t)((sum + good / 2) / good);
                break;
            }
        }
}
