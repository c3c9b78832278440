/* sensor/commands/rcs/rcs_image.c: an inverse synthetic aperture picture of a target, by backprojection of its range
 * profiles. */
#include "sensor/commands/rcs/rcs_private.h"

#include "sensor/publish/images/picture_text.h"
#include "sensor/publish/images/image_file.h"

#include <stdlib.h>

enum { image_pixels = 360, profile_over = 16 }; /* samples of a profile over its resolution */

static const double trace_deg = 0.2; /* a list of hits serves so far: half of it each way, -54 dB */
static const double shown_db = 50;

/* What a pulse is: its antenna and its range profiles. */
typedef struct Pulses {
    int             samples;    /* of a profile */
    double          bin_m;      /* two-way path over samples */
    ScatterAntenna *antenna;    /* [pulses] */
    double complex *profile[2]; /* [pulses][samples], at the lowest frequency's phase */
} Pulses;

static double hamming(int i, int count) { return count < 2 ? 1 : 0.54 - 0.46 * cos(2 * pi_rad * i / (count - 1)); }

static void plan_image(RcsImage *image, const RcsSweep *sweep)
{
    const PosedEntity *entity = &sweep->model.target->entity;
    const double       f_hz = sweep->config.frequency_hz[0], wavelength_m = light_mps / f_hz;
    const double       cosine = cos(sweep->config.elevation_deg * rad_per_deg);
    double             long_m = 0;
    for (int c = 0; c < 2; c++) long_m = fmax(long_m, entity->box_high[c] - entity->box_low[c]);
    for (int c = 0; c < 3; c++) image->centre[c] = 0.5 * (entity->box_low[c] + entity->box_high[c]);
    image->middle_deg = sweep->config.image_deg;
    image->frequency_hz = f_hz;
    image->resolution_m = sweep->config.resolution_m;
    if (!(image->resolution_m > 0)) image->resolution_m = fmax(long_m / 60, wavelength_m * 3);
    image->side_m = 1.3 * long_m + 4 * image->resolution_m;
    /* 1.3: the width that the window adds */
    image->bandwidth_hz = fmin(1.3 * light_mps / (2 * image->resolution_m * cosine), f_hz);
    image->span_deg = fmin(1.3 * wavelength_m / (2 * image->resolution_m * cosine) / rad_per_deg, 60);
    /* at this distance no image of the target lies beside it */
    const double free_m = fmax(2.2 * entity->radius_m, 1.6 * image->side_m);
    image->frequencies = (int)ceil(image->bandwidth_hz * 2 * free_m / light_mps) + 2;
    image->pulses = (int)ceil(image->span_deg * rad_per_deg * 2 * free_m / wavelength_m) + 2;
    image->pixels = image_pixels;
}

/* Makes the profile of a sweep of frequencies: the sum of w S exp(+j (k - k0) path) over the frequencies, at each
 * sample of path. */
static void make_profile(double complex *out, int samples, double bin_m, const double complex *s, int count,
                         double step_k)
{
    for (int i = 0; i < samples; i++) {
        const double path_m = (i - samples / 2) * bin_m, turn_re = cos(step_k * path_m), turn_im = sin(step_k * path_m);
        double       re = 1, im = 0, sum_re = 0, sum_im = 0;
        for (int f = 0; f < count; f++) {
            sum_re += creal(s[f]) * re - cimag(s[f]) * im;
            sum_im += creal(s[f]) * im + cimag(s[f]) * re;
            const double next = re * turn_re - im * turn_im;
            im = re * turn_im + im * turn_re;
            re = next;
        }
        out[i] = CMPLX(sum_re, sum_im);
    }
}

static Status shoot(Pulses *pulses, const RcsImage *image, RcsSweep *sweep)
{
    const int       count = image->frequencies;
    const double    step_hz = image->bandwidth_hz / (count - 1);
    const double    first_hz = image->frequency_hz - image->bandwidth_hz / 2;
    const double    step_k = 2 * pi_rad * step_hz / light_mps;
    ScatterMatrix  *s = calloc((size_t)count, sizeof *s);
    double complex *w = calloc((size_t)count, sizeof *w);
    double          traced_deg = NAN, sum = 0;
    char            line[96];
    TubeConfig      tubes = sweep->tubes;
    Status          status = s && w ? STATUS_OK : STATUS_NO_MEMORY;
    tubes.frequency_hz = image->frequency_hz;
    for (int f = 0; f < count; f++) sum += hamming(f, count);
    for (int p = 0; p < image->pulses && status == STATUS_OK; p++) {
        const double az_deg = image->middle_deg + image->span_deg * ((double)p / (image->pulses - 1) - 0.5);
        const double el_rad = sweep->config.elevation_deg * rad_per_deg;
        const double bin_deg = (floor(az_deg / trace_deg) + 0.5) * trace_deg;
        snprintf(line, sizeof line, "rcs: pulse %d of %d of the picture", p + 1, image->pulses);
        log_status(line);
        radar_look(&pulses->antenna[p], az_deg * rad_per_deg, el_rad, sweep->config.range_m);
        if (bin_deg != traced_deg) {
            ScatterAntenna middle;
            radar_look(&middle, bin_deg * rad_per_deg, el_rad, sweep->config.range_m);
            status = total_field_trace(&sweep->field, sweep->model.target, &middle, &middle, &tubes,
                                       !sweep->config.no_edges, sweep->pool);
            traced_deg = bin_deg;
        }
        if (status == STATUS_OK)
            status = total_field_sweep(s,
                                       &(FrequencySweep){.count = count,
                                                         .first_hz = first_hz,
                                                         .step_hz = step_hz,
                                                         .tx = &pulses->antenna[p],
                                                         .rx = &pulses->antenna[p]},
                                       &sweep->field, sweep->pool);
        for (int q = 0; q < 2 && status == STATUS_OK; q++) {
            for (int f = 0; f < count; f++) w[f] = (q ? s[f].hv : s[f].hh) * (hamming(f, count) / sum);
            make_profile(pulses->profile[q] + (size_t)p * (size_t)pulses->samples, pulses->samples, pulses->bin_m, w,
                         count, step_k);
        }
    }
    log_status(NULL);
    free(s);
    free(w);
    return status;
}

typedef struct Projection {
    RcsImage     *image;
    const Pulses *pulses;
    double        first_k, sum;
} Projection;

/* Computes one row of pixels. */
static void project_row(void *user, int worker, int row)
{
    const Projection *p = user;
    RcsImage         *image = p->image;
    (void)worker;
    for (int column = 0; column < image->pixels; column++) {
        const double   at[3] = {image->centre[0] + image->side_m * (0.5 - (row + 0.5) / image->pixels),
                                image->centre[1] + image->side_m * ((column + 0.5) / image->pixels - 0.5),
                                image->centre[2]};
        double complex sum[2] = {0, 0};
        for (int i = 0; i < image->pulses; i++) {
            double       way[3];
            const double path_m = 2 * scatter_path(way, &p->pulses->antenna[i], at);
            const double place = path_m / p->pulses->bin_m + p->pulses->samples / 2, low = floor(place);
            const double share = place - low;
            if (!(low >= 0 && low < p->pulses->samples - 1)) continue;
            const double re = cos(p->first_k * path_m), im = sin(p->first_k * path_m);
            const double weight = hamming(i, image->pulses) / p->sum;
            for (int q = 0; q < 2; q++) {
                const double complex *profile =
                    p->pulses->profile[q] + (size_t)i * (size_t)p->pulses->samples + (size_t)low;
                const double x = (1 - share) * creal(profile[0]) + share * creal(profile[1]);
                const double y = (1 - share) * cimag(profile[0]) + share * cimag(profile[1]);
                sum[q] += weight * CMPLX(x * re - y * im, x * im + y * re);
            }
        }
        const size_t pixel = (size_t)row * (size_t)image->pixels + (size_t)column;
        image->hh_dbsm[pixel] = (float)rcs_dbsm(sum[0]);
        image->hv_dbsm[pixel] = (float)rcs_dbsm(sum[1]);
    }
}

void rcs_image_free(RcsImage *image)
{
    free(image->hh_dbsm);
    free(image->hv_dbsm);
    *image = (RcsImage){0};
}

Status rcs_image_make(RcsImage *out, RcsSweep *sweep)
{
    RcsImage image = {0};
    plan_image(&image, sweep);
    const double reach_m = 2 * (image.side_m + v3_length(image.centre)); /* two-way path of the farthest pixel */
    Pulses       pulses = {.bin_m = light_mps / image.bandwidth_hz / profile_over};
    pulses.samples = 2 * (int)ceil(reach_m / pulses.bin_m) + 4;
    const size_t pixels = (size_t)image.pixels * (size_t)image.pixels;
    const size_t samples = (size_t)image.pulses * (size_t)pulses.samples;
    pulses.antenna = calloc((size_t)image.pulses, sizeof *pulses.antenna);
    for (int q = 0; q < 2; q++) pulses.profile[q] = calloc(samples, sizeof *pulses.profile[q]);
    image.hh_dbsm = calloc(pixels, sizeof *image.hh_dbsm);
    image.hv_dbsm = calloc(pixels, sizeof *image.hv_dbsm);
    const bool memory = pulses.antenna && pulses.profile[0] && pulses.profile[1] && image.hh_dbsm && image.hv_dbsm;
    Status     status = memory ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = shoot(&pulses, &image, sweep);
    if (status == STATUS_OK) {
        Projection p = {&image, &pulses, 2 * pi_rad * (image.frequency_hz - image.bandwidth_hz / 2) / light_mps, 0};
        for (int i = 0; i < image.pulses; i++) p.sum += hamming(i, image.pulses);
        pool_run(sweep->pool, image.pixels, project_row, &p);
        *out = image;
    } else {
        rcs_image_free(&image);
    }
    free(pulses.antenna);
    for (int q = 0; q < 2; q++) free(pulses.profile[q]);
    return status;
}

/* ---- the picture ------------------------------------------------------------------------------------ */

/* Paints the colour of a share from 0 to 1: black, violet, orange, white. */
static void paint(uint8_t *rgb, double share)
{
    static const double stop[5][3] = {{0, 0, 4}, {80, 18, 123}, {182, 54, 121}, {251, 136, 97}, {252, 253, 191}};
    const double        at = clamp(share, 0, 1) * 4;
    const int           low = at >= 4 ? 3 : (int)at;
    for (int c = 0; c < 3; c++) rgb[c] = (uint8_t)lround(stop[low][c] + (at - low) * (stop[low + 1][c] - stop[low][c]));
}

Status rcs_image_write(const RcsImage *image, const RcsSweep *sweep, const char *path)
{
    const int n = image->pixels, head = picture_text_high + 16, foot = 2 * picture_text_high + 24, width = 2 * n + 8;
    const int height = head + n + foot;
    uint8_t  *rgb = calloc(3 * (size_t)width * (size_t)height, 1);
    double    most = -INFINITY;
    char      text[128];
    if (!rgb) return STATUS_NO_MEMORY;
    for (int i = 0; i < n * n; i++) most = fmax(most, (double)image->hh_dbsm[i]);
    for (int q = 0; q < 2; q++)
        for (int row = 0; row < n; row++)
            for (int column = 0; column < n; column++) {
                const float *dbsm = (q ? image->hv_dbsm : image->hh_dbsm) + (size_t)row * (size_t)n + (size_t)column;
                uint8_t     *at = rgb + 3 * ((size_t)(head + row) * (size_t)width + (size_t)(q * (n + 8) + column));
                paint(at, 1 + ((double)*dbsm - most) / shown_db);
            }
    for (int q = 0; q < 2; q++) {
        snprintf(text, sizeof text, "%s %.1f m", q ? "HV" : "HH", image->side_m);
        picture_text_write(rgb, width, height, q * (n + 8) + 10, 8, text);
    }
    snprintf(text, sizeof text, "%.4g GHz azimuth %.4g elevation %.4g deg", image->frequency_hz * 1e-9,
             image->middle_deg, sweep->config.elevation_deg);
    picture_text_write(rgb, width, height, 10, head + n + 6, text);
    snprintf(text, sizeof text, "nose up  %.1f to %.1f dBsm  cell %.2f m", most - shown_db, most, image->resolution_m);
    picture_text_write(rgb, width, height, 10, head + n + 12 + picture_text_high, text);
    const Status status = image_write_png(path, rgb, width, height, 3, 8);
    free(rgb);
    return status;
}
