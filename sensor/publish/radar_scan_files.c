/* sensor/publish/radar_scan_files.c: see radar_scan_files.h. */
#include "sensor/publish/radar_scan_files.h"

#include "sensor/publish/frame_files.h"
#include "sensor/publish/image_file.h"

#include <stdlib.h>

enum { picture_columns = 384 };

/* Of a column, so that a picture of few is wide enough to look at. */
static int repeats(int columns) { return columns < picture_columns ? picture_columns / columns : 1; }

/* [azimuths][ranges], the nearest first, as an image: a row a range, the farthest on top, a column an azimuth. */
static float *as_image(const double *from, int azimuths, int ranges)
{
    float *to = malloc((size_t)azimuths * (size_t)ranges * sizeof *to);
    for (int y = 0; to && y < ranges; y++)
        for (int x = 0; x < azimuths; x++) {
            const size_t at = (size_t)x * (size_t)ranges + (size_t)(ranges - 1 - y);
            to[(size_t)y * (size_t)azimuths + (size_t)x] = (float)from[at];
        }
    return to;
}

/* In decibels from 5 dB below the noise to the greatest, at least 45 dB; NaN: black. Each column again and again. */
static Status write_grey(const char *stem, const char *ending, const float *value, int width, int height, int again,
                         double noise_w)
{
    const size_t count = (size_t)width * (size_t)height;
    const double low_db = 10 * log10(noise_w) - 5;
    char         path[frame_path_size];
    uint8_t     *grey = calloc(count, (size_t)again);
    double       most = 0;
    if (!grey) return STATUS_NO_MEMORY;
    for (size_t i = 0; i < count; i++) most = fmax(most, value[i]);
    const double high_db = fmax(10 * log10(fmax(most, 1e-300)), low_db + 45);
    for (size_t i = 0; i < count; i++)
        if (value[i] > 0) {
            const double share = clamp((10 * log10(value[i]) - low_db) / (high_db - low_db), 0, 1);
            memset(grey + i * (size_t)again, (int)lround(255 * share), (size_t)again);
        }
    Status status = STATUS_BAD_VALUE;
    if (snprintf(path, sizeof path, "%s%s.png", stem, ending) < (int)sizeof path)
        status = image_write_png(path, grey, again * width, height, 1, 8);
    free(grey);
    return status;
}

static Status write_exr(const char *stem, const char *ending, const Frame *f, const Plane *plane, int planes,
                        double first_rad, double step_rad)
{
    const RadarFrame *r = f->radar;
    const RadarScan  *s = r->scan;
    char              path[frame_path_size], date[32];
    const bool        polar = step_rad > 0;
    /* those of range and azimuth last: pixels have neither */
    const ImageAttribute attribute[] = {
        image_string("radar", r->preset->name), image_int("frame", f->number), image_double("time_s", f->time_s),
        image_string("host", f->host), image_double("interval_s", s->plan.interval_s),
        image_int("positions", s->plan.positions),
        image_double("beam_deg", s->beam_rad / rad_per_deg), image_double("noise_w", s->noise_w),
        image_double("sharp_noise_w", s->sharp_noise_w), image_double("reference_m", r->reference_m),
        image_double("metre_per_row", r->map.metre_per_column),
        image_double("first_azimuth_deg", first_rad / rad_per_deg),
        image_double("azimuth_step_deg", step_rad / rad_per_deg)};
    frame_date(date, f->unix_s);
    if (snprintf(path, sizeof path, "%s%s.exr", stem, ending) >= (int)sizeof path) return STATUS_BAD_VALUE;
    return image_write_exr_as(path, "zip:1", plane, planes, date, attribute,
                              sizeof attribute / sizeof *attribute - (polar ? 0 : 4));
}

static Status write_real_beam(const char *stem, const Frame *f, bool png)
{
    const RadarScan *s = f->radar->scan;
    const int        width = s->plan.positions, height = s->columns;
    float           *power = as_image(s->power_w, width, height);
    if (!power) return STATUS_NO_MEMORY;
    const Plane plane = {"Y", PLANE_F32, width, height, power};
    const double step_rad = fmax(s->plan.step_rad, 1e-9);
    Status       status = write_exr(stem, "_scan", f, &plane, 1, -(width / 2) * step_rad, step_rad);
    if (status == STATUS_OK && png)
        status = write_grey(stem, "_scan", power, width, height, repeats(width), s->noise_w);
    free(power);
    return status;
}

static Status write_sharpened(const char *stem, const Frame *f, bool png)
{
    const RadarScan *s = f->radar->scan;
    const int        width = s->azimuths, height = s->columns;
    const size_t     cells = (size_t)width * (size_t)height;
    float           *power = as_image(s->sharp_w, width, height), *resolution = malloc(2 * cells * sizeof *resolution);
    Status           status = power && resolution ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                const size_t to = (size_t)y * (size_t)width + (size_t)x;
                const size_t from = (size_t)x * (size_t)height + (size_t)(height - 1 - y);
                resolution[to] = s->resolution_m[from];
                resolution[cells + to] = s->sharpened[from];
            }
        const Plane plane[] = {{"Y", PLANE_F32, width, height, power},
                               {"resolution_m", PLANE_F32, width, height, resolution},
                               {"sharpened", PLANE_F32, width, height, resolution + cells}};
        status = write_exr(stem, "_dbs", f, plane, 3, -(s->plan.positions / 2) * s->plan.step_rad,
                           fmax(s->azimuth_step_rad, 1e-9));
    }
    if (status == STATUS_OK && png)
        status = write_grey(stem, "_dbs", power, width, height, repeats(width), s->sharp_noise_w);
    free(power);
    free(resolution);
    return status;
}

static Status write_pixels(const char *stem, const Frame *f, bool png)
{
    const RadarScan *s = f->radar->scan;
    if (s->width == 0) return STATUS_OK;
    const Plane plane[] = {{"scan", PLANE_F32, s->width, s->height, s->view_w},
                           {"dbs", PLANE_F32, s->width, s->height, s->view_sharp_w}};
    Status status = write_exr(stem, "_view", f, plane, 2, 0, 0);
    if (status == STATUS_OK && png)
        status = write_grey(stem, "_view_scan", s->view_w, s->width, s->height, 1, s->noise_w);
    if (status == STATUS_OK && png)
        status = write_grey(stem, "_view_dbs", s->view_sharp_w, s->width, s->height, 1, s->sharp_noise_w);
    return status;
}

/* Resolution over azimuth, at the reference range. */
static void put_azimuths(FILE *file, const void *user)
{
    const RadarFrame *r = user;
    const RadarScan  *s = r->scan;
    fprintf(file, "# %s; time_s from the frame's; resolution_m across, at half power, at %.1f m; sharpened 0: the real "
                  "beam's\naz_deg,time_s,resolution_m,sharpened\n", r->preset->name, r->reference_m);
    for (int a = 0; a < s->azimuths; a++) {
        const double azimuth = a * s->azimuth_step_rad - (s->plan.positions / 2) * s->plan.step_rad;
        const double position = s->plan.step_rad > 0 ? floor(azimuth / s->plan.step_rad + 0.5) : 0;
        const size_t at = (size_t)a * (size_t)s->columns + (size_t)(s->columns / 2);
        fprintf(file, "%.5f,%.6f,%.4f,%d\n", azimuth / rad_per_deg, position * s->plan.interval_s, s->resolution_m[at],
                s->sharpened[at]);
    }
}

Status radar_scan_files(const char *stem, const Frame *f, bool png)
{
    char   path[frame_path_size];
    Status status = write_real_beam(stem, f, png);
    if (status == STATUS_OK) status = write_sharpened(stem, f, png);
    if (status == STATUS_OK) status = write_pixels(stem, f, png);
    if (status != STATUS_OK) return status;
    if (snprintf(path, sizeof path, "%s_dbs.csv", stem) >= (int)sizeof path) return STATUS_BAD_VALUE;
    return text_write_file("radar", path, put_azimuths, f->radar);
}
