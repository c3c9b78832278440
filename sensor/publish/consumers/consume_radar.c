/* sensor/publish/consumers/consume_radar.c: the consumer that writes OUT/radar: range profiles, maps of range and
 * Doppler, scans. */
#include "sensor/publish/consumers/consumers.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/instruments/radar.h"
#include "sensor/publish/files/frame_files.h"

#include <stdlib.h>

typedef struct RadarFiles {
    Consumer     consumer;
    PictureFiles of;
    RetryBackoff retry;
} RadarFiles;

static const char *const channel_name[interval_channels] = {"sum", "right", "down", "cross"};

static bool path_of(char path[frame_path_size], const RadarFiles *to, const Frame *f, const char *ending)
{
    const int size = snprintf(path, frame_path_size, "%s/radar/%06d.%s", to->of.out, f->number, ending);
    if (size >= 0 && size < frame_path_size) return true;
    log_error("out: a path of %d characters is too long; choose another place with --out", size);
    return false;
}

/* ---- range profile -------------------------------------------------------------------------------- */

static void put_profile(FILE *file, const void *user)
{
    const RadarFrame *r = user;
    const int         samples = r->preset->wave.samples;
    fprintf(
        file,
        "# %s, %s; power: mean of all pulses, W; re, im: the middle pulse, sqrt(W), of the transmitted polarisation (%s) and "
        "of the other; mti: power behind the canceller of %d\nrange_m,power_w,re,im,cross_re,cross_im,mti_w\n",
        r->preset->name, waveform_name[r->preset->wave.kind], r->preset->transmits_h ? "h" : "v", r->preset->mti_rows);
    for (int i = 0; i < samples; i++) {
        const double complex same = r->profile[i], cross = r->profile[samples + i];
        fprintf(file, "%.4f,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n",
                r->reference_m + (i - samples / 2) * r->map.metre_per_column, r->profile_w[i], creal(same), cimag(same),
                creal(cross), cimag(cross), r->mti_w[i]);
    }
}

/* ---- map ------------------------------------------------------------------------------------------- */

static Status write_map(const char *path, const Frame *f)
{
    const RadarFrame *r = radar_of(f);
    const int         rows = r->map.rows, columns = r->map.columns;
    const size_t      cells = (size_t)rows * (size_t)columns;
    float            *value = malloc(2 * interval_channels * cells * sizeof *value);
    Plane             plane[2 * interval_channels];
    char              name[2 * interval_channels][16], date[32];
    if (!value) return STATUS_NO_MEMORY;
    for (int c = 0; c < interval_channels; c++)
        for (int part = 0; part < 2; part++) {
            float *to = value + (size_t)(2 * c + part) * cells;
            for (size_t i = 0; i < cells; i++) {
                const double complex v = r->map.cell[(size_t)c * cells + i];
                to[i] = (float)(part ? cimag(v) : creal(v));
            }
            snprintf(name[2 * c + part], sizeof name[0], "%s_%s", channel_name[c], part ? "im" : "re");
            plane[2 * c + part] = (Plane){name[2 * c + part], PLANE_F32, columns, rows, to};
        }
    const ImageAttribute attribute[] = {image_string("unit", "sqrt(W)"),
                                        image_string("radar", r->preset->name),
                                        image_int("frame", f->number),
                                        image_double("time_s", f->time_s),
                                        image_string("host", f->host),
                                        image_double("reference_m", r->reference_m),
                                        image_double("reference_rate_mps", r->reference_rate_mps),
                                        image_double("metre_per_column", r->map.metre_per_column),
                                        image_double("mps_per_row", r->map.mps_per_row),
                                        image_double("noise_w", r->receiver.noise_w * r->map.noise_share)};
    frame_date(date, f->unix_s);
    const Status status = image_write_exr_as(path, "zip:1", plane, 2 * interval_channels, date, attribute,
                                             sizeof attribute / sizeof *attribute);
    free(value);
    return status;
}

enum { plot_rows = 96, map_rows = 256 };

static double power_db(double complex v) { return 10 * log10(creal(v) * creal(v) + cimag(v) * cimag(v)); }

/* Writes a picture to look at. On top is the range profile, as columns of its decibels; below it the power of the map's
 * sum channel in decibels, approaching echoes on top, each row repeated to make some 256 rows. Both go from 5 dB below
 * the noise to the greatest value, over at least 45 dB. */
static Status write_picture(const char *path, const RadarFrame *r)
{
    const int    columns = r->map.columns, again = map_rows / r->map.rows > 1 ? map_rows / r->map.rows : 1;
    const int    height = plot_rows + again * r->map.rows;
    const size_t cells = (size_t)r->map.rows * (size_t)columns;
    uint8_t     *grey = calloc((size_t)height * (size_t)columns, 1);
    if (!grey) return STATUS_NO_MEMORY;
    /* a pulse's noise is that of a cell times the pulses, but for the window over them */
    const double noise_db = 10 * log10(r->receiver.noise_w * r->map.noise_share) - 5;
    const double pulse_db = noise_db + 10 * log10(r->map.rows);
    double       most_db = noise_db + 45, most_pulse_db = pulse_db + 45;
    for (size_t i = 0; i < cells; i++) most_db = fmax(most_db, power_db(r->map.cell[i]));
    for (int x = 0; x < columns; x++) most_pulse_db = fmax(most_pulse_db, 10 * log10(r->profile_w[x]));
    for (int x = 0; x < columns; x++) {
        const double share = (10 * log10(r->profile_w[x]) - pulse_db) / (most_pulse_db - pulse_db);
        const int    top = plot_rows - (int)lround((plot_rows - 2) * clamp(share, 0, 1));
        for (int y = top; y < plot_rows - 1; y++) grey[(size_t)y * (size_t)columns + (size_t)x] = 200;
    }
    for (int y = plot_rows; y < height; y++)
        for (int x = 0; x < columns; x++) {
            const double db = power_db(r->map.cell[(size_t)((y - plot_rows) / again) * (size_t)columns + (size_t)x]);
            grey[(size_t)y * (size_t)columns + (size_t)x] =
                (uint8_t)lround(255 * clamp((db - noise_db) / (most_db - noise_db), 0, 1));
        }
    const Status status = image_write_png(path, grey, columns, height, 1, 8);
    free(grey);
    return status;
}

/* ---- files of a radar's scan: NNNNNN_scan, _dbs, _view ------------------------------------------- */

enum { picture_columns = 384 };

/* Of a column, so that a picture of few is wide enough to look at. */
static int repeats(int columns) { return columns < picture_columns ? picture_columns / columns : 1; }

/* Turns [azimuths][ranges], nearest first, into an image: a row for each range, the farthest on top, and a column for
 * each azimuth. */
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

/* Writes a map in decibels as greys, from 5 dB below the noise to the greatest value, but over at least 45 dB; NaN is
 * black. Each column is repeated. */
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
    const RadarFrame  *r = radar_of(f);
    const RadarSector *s = r->scan;
    char               path[frame_path_size], date[32];
    const bool         polar = step_rad > 0;
    /* those of range and azimuth last: pixels have neither */
    const ImageAttribute attribute[] = {image_string("radar", r->preset->name),
                                        image_int("frame", f->number),
                                        image_double("time_s", f->time_s),
                                        image_string("host", f->host),
                                        image_double("interval_s", s->plan.interval_s),
                                        image_int("positions", s->plan.positions),
                                        image_double("beam_deg", s->beam_rad / rad_per_deg),
                                        image_double("noise_w", s->noise_w),
                                        image_double("sharp_noise_w", s->sharp_noise_w),
                                        image_double("reference_m", r->reference_m),
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
    const RadarSector *s = radar_of(f)->scan;
    const int          width = s->plan.positions, height = s->columns;
    float             *power = as_image(s->power_w, width, height);
    if (!power) return STATUS_NO_MEMORY;
    const Plane  plane = {"Y", PLANE_F32, width, height, power};
    const double step_rad = fmax(s->plan.step_rad, 1e-9);
    Status       status = write_exr(stem, "_scan", f, &plane, 1, -(width / 2) * step_rad, step_rad);
    if (status == STATUS_OK && png)
        status = write_grey(stem, "_scan", power, width, height, repeats(width), s->noise_w);
    free(power);
    return status;
}

static Status write_sharpened(const char *stem, const Frame *f, bool png)
{
    const RadarSector *s = radar_of(f)->scan;
    const int          width = s->azimuths, height = s->columns;
    const size_t       cells = (size_t)width * (size_t)height;
    float *power = as_image(s->sharp_w, width, height), *resolution = malloc(2 * cells * sizeof *resolution);
    Status status = power && resolution ? STATUS_OK : STATUS_NO_MEMORY;
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
    const RadarSector *s = radar_of(f)->scan;
    if (s->width == 0) return STATUS_OK;
    const Plane plane[] = {{"scan", PLANE_F32, s->width, s->height, s->view_w},
                           {"dbs", PLANE_F32, s->width, s->height, s->view_sharp_w}};
    Status      status = write_exr(stem, "_view", f, plane, 2, 0, 0);
    if (status == STATUS_OK && png)
        status = write_grey(stem, "_view_scan", s->view_w, s->width, s->height, 1, s->noise_w);
    if (status == STATUS_OK && png)
        status = write_grey(stem, "_view_dbs", s->view_sharp_w, s->width, s->height, 1, s->sharp_noise_w);
    return status;
}

/* Writes the resolution over azimuth, at the reference range. */
static void put_azimuths(FILE *file, const void *user)
{
    const RadarFrame  *r = user;
    const RadarSector *s = r->scan;
    fprintf(file,
            "# %s; time_s from the frame's; resolution_m across, at half power, at %.1f m; sharpened 0: the real "
            "beam's\naz_deg,time_s,resolution_m,sharpened\n",
            r->preset->name, r->reference_m);
    for (int a = 0; a < s->azimuths; a++) {
        const double azimuth = a * s->azimuth_step_rad - (s->plan.positions / 2) * s->plan.step_rad;
        const double position = s->plan.step_rad > 0 ? floor(azimuth / s->plan.step_rad + 0.5) : 0;
        const size_t at = (size_t)a * (size_t)s->columns + (size_t)(s->columns / 2);
        fprintf(file, "%.5f,%.6f,%.4f,%d\n", azimuth / rad_per_deg, position * s->plan.interval_s, s->resolution_m[at],
                s->sharpened[at]);
    }
}

/* Writes the files of a frame with radar_of(frame)->scan, whose names begin with stem (PATH/NNNNNN). png: pictures to
 * look at too. */
static Status write_scan(const char *stem, const Frame *f, bool png)
{
    char   path[frame_path_size];
    Status status = write_real_beam(stem, f, png);
    if (status == STATUS_OK) status = write_sharpened(stem, f, png);
    if (status == STATUS_OK) status = write_pixels(stem, f, png);
    if (status != STATUS_OK) return status;
    if (snprintf(path, sizeof path, "%s_dbs.csv", stem) >= (int)sizeof path) return STATUS_BAD_VALUE;
    return text_write_file("radar", path, put_azimuths, radar_of(f));
}

/* ---- the consumer ------------------------------------------------------------------------------------ */

static Status write_files(RadarFiles *to, const Frame *f)
{
    char   path[frame_path_size];
    Status status =
        path_of(path, to, f, "csv") ? text_write_file("radar", path, put_profile, radar_of(f)) : STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = path_of(path, to, f, "exr") ? write_map(path, f) : STATUS_BAD_VALUE;
    if (status == STATUS_OK && to->of.config->publish.png)
        status = path_of(path, to, f, "png") ? write_picture(path, radar_of(f)) : STATUS_BAD_VALUE;
    if (status == STATUS_OK && radar_of(f)->scan) {
        status = path_of(path, to, f, "") ? STATUS_OK : STATUS_BAD_VALUE;
        path[strlen(path) - 1] = 0; /* the point */
        if (status == STATUS_OK) status = write_scan(path, f, to->of.config->publish.png);
    }
    return status;
}

static Status put(Consumer *consumer, Frame *frame)
{
    RadarFiles *to = (RadarFiles *)consumer;
    if (!radar_of(frame)) return STATUS_OK;
    const bool due = !to->of.patient || retry_due(&to->retry);
    Status     status = due ? write_files(to, frame) : STATUS_IO;
    if (!to->of.patient) return status;
    retry_done(&to->retry, due, status);
    return status == STATUS_IO ? STATUS_OK : status;
}

static Status close_files(Consumer *consumer)
{
    free(consumer);
    return STATUS_OK;
}

static Status begin(Consumer *consumer)
{
    const RadarFiles *to = (const RadarFiles *)consumer;
    char              path[frame_path_size];
    return snprintf(path, sizeof path, "%s/radar", to->of.out) < (int)sizeof path ? frame_files_folder(path)
                                                                                  : STATUS_BAD_VALUE;
}

Status consume_radar(Consumer **out, const PictureFiles *made_of)
{
    RadarFiles *to = calloc(1, sizeof *to);
    if (!to) return STATUS_NO_MEMORY;
    *to = (RadarFiles){.consumer = {0, put, NULL, close_files, "radar_files", begin},
                       .of = *made_of,
                       .retry = {.what = "files of the radar"}};
    *out = &to->consumer;
    return STATUS_OK;
}
