/* sensor/detector/sheet.c: parses a sensor's data sheet, and derives a preset from its entries. */
#include "sensor/detector/preset.h"

#include <stdlib.h>

enum { sheet_most_octets = 1 << 16, staring_only = 1, parallel_only = 2, required = 4 };

typedef struct Sheet {
    char   name[32], sensor_type[16];
    double cut_on_um, cut_off_um, f_number, obscuration, focal_cm, transmission, horz_um, vert_um, cell_h_um, cell_v_um;
    double per_h, per_v, columns, rows, fov_deg, frame_hz, efficiency, tdi, integration_us, qe, netd_k, d_star_1e10;
    double dark_e_s, well_e, bits, noise[6], motion_mrad, cuton_hz;
} Sheet;

typedef struct Entry {
    const char *key, *unit;
    size_t      offset;
    double      low, high, otherwise; /* NaN: must be given, if required */
    unsigned    flags;
} Entry;

#define AT(member) offsetof(Sheet, member)

static const Entry entries[] = {
    {"spectral_cut_on", "microns", AT(cut_on_um), 3, 14, NAN, required},
    {"spectral_cut_off", "microns", AT(cut_off_um), 3, 14, NAN, required},
    {"f_number", "-", AT(f_number), 0.5, 100, NAN, required},
    {"obscuration", "-", AT(obscuration), 0, 0.95, 0, 0},
    {"eff_focal_length", "cm", AT(focal_cm), 0.1, 1e4, NAN, required},
    {"avg_optical_trans", "-", AT(transmission), 0.001, 1, NAN, required},
    {"horz_dimension", "microns", AT(horz_um), 0.5, 1000, NAN, required},
    {"vert_dimension", "microns", AT(vert_um), 0.5, 1000, NAN, required},
    {"horz_unit_cell", "microns", AT(cell_h_um), 0.5, 1000, NAN, required | staring_only},
    {"vert_unit_cell", "microns", AT(cell_v_um), 0.5, 1000, NAN, required | staring_only},
    {"samples_per_hifov", "-", AT(per_h), 0.5, 4, 1, parallel_only},
    {"samples_per_vifov", "-", AT(per_v), 0.5, 4, 1, parallel_only},
    {"horz_detectors", "-", AT(columns), 8, 8192, NAN, required | staring_only},
    {"vert_detectors", "-", AT(rows), 8, 8192, NAN, required},
    {"horz_fov", "degrees", AT(fov_deg), 0.01, 120, NAN, required | parallel_only},
    {"frame_rate", "Hz", AT(frame_hz), 0.01, 1e4, NAN, required | parallel_only},
    {"scan_efficiency", "-", AT(efficiency), 0.01, 1, 1, parallel_only},
    {"detectors_in_tdi", "-", AT(tdi), 1, 1000, 1, parallel_only},
    {"integration_time", "microsec", AT(integration_us), 1e-3, 1e6, NAN, 0},
    {"quantum_efficiency", "-", AT(qe), 0.001, 1, NAN, required},
    {"netd", "kelvin", AT(netd_k), 1e-4, 100, NAN, 0},
    {"peak_d_star", "1e10", AT(d_star_1e10), 1e-4, 1e4, NAN, 0},
    {"dark_current", "electrons/s", AT(dark_e_s), 0, 1e15, 0, 0},
    {"well_capacity", "electrons", AT(well_e), 100, 1e12, NAN, 0},
    {"adc_bits", "-", AT(bits), 8, 16, 14, 0},
    {"sigma_tv_tvh", "-", AT(noise[0]), 0, 100, 0, 0},
    {"sigma_th_tvh", "-", AT(noise[1]), 0, 100, 0, 0},
    {"sigma_vh_tvh", "-", AT(noise[2]), 0, 100, 0, 0},
    {"sigma_t_tvh", "-", AT(noise[3]), 0, 100, 0, 0},
    {"sigma_v_tvh", "-", AT(noise[4]), 0, 100, 0, 0},
    {"sigma_h_tvh", "-", AT(noise[5]), 0, 100, 0, 0},
    {"rms_motion", "mrad", AT(motion_mrad), 0, 100, 0, 0},
    {"high_pass_3db_cuton", "Hz", AT(cuton_hz), 0, 1e6, 0, parallel_only},
};
enum { entry_count = sizeof entries / sizeof *entries, name_entry = entry_count, type_entry, all_entries };

typedef struct Lines {
    const char *path;
    int         of[all_entries]; /* 0: not given */
} Lines;

static double *field(const Sheet *s, int k) { return (double *)((char *)s + entries[k].offset); }

static Status bad(const char *path, int line, const char *key, const char *value, const char *wants)
{
    char safe[80];
    text_escape(safe, sizeof safe, value, strnlen(value, 40));
    log_error("sheet: %s:%d: %s: '%s' is not %s", path, line, key, safe, wants);
    return STATUS_BAD_VALUE;
}

static bool is_name(const char *text)
{
    return *text && strlen(text) < sizeof((Sheet *)0)->name &&
           strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-") == strlen(text);
}

static Status read_entry(Sheet *s, Lines *lines, int line, const char *key, const char *value, const char *unit)
{
    int  k = 0;
    char wants[120], safe[80];
    while (k < entry_count && strcmp(entries[k].key, key) != 0) k++;
    if (k == entry_count)
        k = strcmp(key, "name") == 0 ? name_entry : strcmp(key, "sensor_type") == 0 ? type_entry : all_entries;
    if (k == all_entries) {
        text_escape(safe, sizeof safe, key, strnlen(key, 40));
        log_error("sheet: %s:%d: unknown key '%s'; sensor/detector/preset.h lists them, "
                  "etc/sensors/example_flir2.sheet shows them",
                  lines->path, line, safe);
        return STATUS_BAD_VALUE;
    }
    if (lines->of[k]) {
        log_error("sheet: %s:%d: %s is given twice, first in line %d", lines->path, line, key, lines->of[k]);
        return STATUS_BAD_VALUE;
    }
    lines->of[k] = line;
    if (k == name_entry) {
        if (!is_name(value) || unit)
            return bad(lines->path, line, key, unit ? unit : value, "one word of at most 31 letters, digits, _ . -");
        strcpy(s->name, value);
        return STATUS_OK;
    }
    if (k == type_entry) {
        if ((strcmp(value, "staring") != 0 && strcmp(value, "parallel") != 0) || unit)
            return bad(lines->path, line, key, value, "staring or parallel");
        strcpy(s->sensor_type, value);
        return STATUS_OK;
    }
    double number;
    snprintf(wants, sizeof wants, "a number in %g .. %g%s%s", entries[k].low, entries[k].high,
             entries[k].unit[0] == '-' ? "" : " ", entries[k].unit[0] == '-' ? "" : entries[k].unit);
    if (!text_to_double(&number, value) || !(number >= entries[k].low && number <= entries[k].high))
        return bad(lines->path, line, key, value, wants);
    if (unit && strcmp(unit, entries[k].unit) != 0) {
        snprintf(wants, sizeof wants, "its unit, which is %s", entries[k].unit);
        return bad(lines->path, line, key, unit, wants);
    }
    *field(s, k) = number;
    return STATUS_OK;
}

/* Splits a line in place, without comment and line end. With more than three words the fourth is reported. */
static Status read_line(Sheet *s, Lines *lines, int line, char *text)
{
    char *word[4] = {NULL}, *save = NULL;
    int   words = 0;
    text[strcspn(text, "#")] = 0;
    for (char *w = strtok_r(text, " \t\r", &save); w && words < 4; w = strtok_r(NULL, " \t\r", &save))
        word[words++] = w;
    if (words == 0) return STATUS_OK;
    if (words == 1) return bad(lines->path, line, word[0], "", "a key and its value");
    if (words == 4) return bad(lines->path, line, word[0], word[3], "expected: key, value, unit");
    return read_entry(s, lines, line, word[0], word[1], word[2]);
}

/* Checks that all entries of the sensor type are given, and no others. */
static Status check_entries(Sheet *s, const Lines *lines)
{
    for (int k = name_entry; k < all_entries; k++)
        if (!lines->of[k]) {
            log_error("sheet: %s: no %s", lines->path, k == name_entry ? "name" : "sensor_type (staring or parallel)");
            return STATUS_BAD_VALUE;
        }
    const unsigned not_ours = strcmp(s->sensor_type, "staring") == 0 ? parallel_only : staring_only;
    for (int k = 0; k < entry_count; k++) {
        if (entries[k].flags & not_ours && lines->of[k]) {
            log_error("sheet: %s:%d: %s does not apply to a %s sensor", lines->path, lines->of[k], entries[k].key,
                      s->sensor_type);
            return STATUS_BAD_VALUE;
        }
        if (entries[k].flags & required && !(entries[k].flags & not_ours) && !lines->of[k]) {
            log_error("sheet: %s: no %s (%g .. %g %s)", lines->path, entries[k].key, entries[k].low, entries[k].high,
                      entries[k].unit);
            return STATUS_BAD_VALUE;
        }
        if (!lines->of[k]) *field(s, k) = entries[k].otherwise;
    }
    if (isnan(s->netd_k) == isnan(s->d_star_1e10)) {
        log_error("sheet: %s: give one of netd and peak_d_star, not %s", lines->path,
                  isnan(s->netd_k) ? "none" : "both");
        return STATUS_BAD_VALUE;
    }
    if (not_ours == parallel_only && isnan(s->integration_us)) {
        log_error("sheet: %s: no integration_time (microsec)", lines->path);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

/* ---- the preset ----------------------------------------------------------------------------- */

static Status choose_band(Band *band, const Sheet *s, const char *path)
{
    if (s->cut_on_um < s->cut_off_um && s->cut_on_um >= 7 && s->cut_off_um <= 14) *band = BAND_LWIR;
    else if (s->cut_on_um < s->cut_off_um && s->cut_on_um >= 3 && s->cut_off_um <= 5.5) *band = BAND_MWIR;
    else {
        log_error(
            "sheet: %s: spectral_cut_on=%g and spectral_cut_off=%g microns lie neither in 7 .. 14 nor in 3 .. 5.5",
            path, s->cut_on_um, s->cut_off_um);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

static Status raster(SensorPreset *p, const Sheet *s, const char *path)
{
    const bool   staring = strcmp(s->sensor_type, "staring") == 0;
    const double h_um = staring ? s->cell_h_um : s->horz_um / s->per_h,
                 v_um = staring ? s->cell_v_um : s->vert_um / s->per_v;
    if (!(fabs(h_um / v_um - 1) <= 0.01)) {
        log_error("sheet: %s: pixels of %g x %g microns are not square, which they must be to 1 %%; choose %s", path,
                  h_um, v_um,
                  staring ? "horz_unit_cell and vert_unit_cell alike"
                          : "samples_per_hifov and samples_per_vifov to make them so");
        return STATUS_BAD_VALUE;
    }
    const double pitch_m = 1e-6 * sqrt(h_um * v_um), focal_m = 1e-2 * s->focal_cm;
    p->photons.pitch_m = pitch_m;
    p->footprint = 1e-6 * sqrt(s->horz_um * s->vert_um) / pitch_m;
    p->width_px = staring ? s->columns : round(2 * focal_m * tan(0.5 * s->fov_deg * rad_per_deg) / pitch_m);
    p->height_px = staring ? s->rows : round(s->rows * s->per_v);
    if (floor(s->columns) != s->columns && staring) p->width_px = NAN;
    if (floor(s->rows) != s->rows ||
        !(p->width_px >= 8 && p->width_px <= 8192 && p->height_px >= 8 && p->height_px <= 8192) ||
        !(p->footprint <= 4)) {
        log_error(
            "sheet: %s: %g x %g pixels of %g microns, with detectors of %g: whole numbers in 8 .. 8192 are wanted, and "
            "detectors of at most 4 pixels",
            path, p->width_px, p->height_px, 1e6 * pitch_m, p->footprint);
        return STATUS_BAD_VALUE;
    }
    p->hfov_deg = 2 * atan(0.5 * p->width_px * pitch_m / focal_m) / rad_per_deg;
    p->jitter_px = 1e-3 * s->motion_mrad * focal_m / pitch_m;
    if (staring) return STATUS_OK;
    p->scan.by_columns = true;
    p->scan.line_s = s->efficiency / (s->frame_hz * p->width_px);
    p->ac_per_line = s->cuton_hz * p->scan.line_s;
    return STATUS_OK;
}

/* Noise electrons of a stage from D* at its peak, the cut-off wavelength: D* = sqrt(area / 2 t) / NEP. */
static double d_star_noise_e(const Sheet *s, double integration_s)
{
    static const double h_j_s = 6.62607015e-34, c_mps = 299792458.0;
    const double        area_cm2 = 1e-8 * s->horz_um * s->vert_um,
                 nep_w = sqrt(area_cm2 / (2 * integration_s)) / (1e10 * s->d_star_1e10);
    return s->qe * nep_w * integration_s * 1e-6 * s->cut_off_um / (h_j_s * c_mps);
}

/* Computes the read noise: the sheet's noise without that of photons, dark current and quantisation. */
static Status noise_of_reading(SensorPreset *p, const Sheet *s, const char *path)
{
    p->photons.read_e = 0;
    p->photons.well_e = 1;
    PhotonDetector d = preset_photons(p);
    double         per_k;
    const double   signal_e = photon_electrons(&d, 300, &per_k), stages = p->tdi > 1 ? p->tdi : 1;
    p->photons.well_e = isnan(s->well_e) ? fmin(fmax(2.5 * (signal_e + d.dark_e), 100), 1e12) : s->well_e;
    const double step_e = p->photons.well_e / (exp2(p->bits) - 1), open_e2 = signal_e + d.dark_e + step_e * step_e / 12;
    const double one_e = isnan(s->d_star_1e10) ? NAN : d_star_noise_e(s, p->photons.integration_s);
    const double wanted_e2 = isnan(s->netd_k) ? stages * one_e * one_e : s->netd_k * s->netd_k * per_k * per_k;
    if (!isnan(s->netd_k) && !(wanted_e2 >= open_e2)) {
        log_error("sheet: %s: netd=%g kelvin is better than photons, dark current and %g bits of %g electrons allow: "
                  "%.3g kelvin",
                  path, s->netd_k, p->bits, step_e, sqrt(open_e2) / per_k);
        return STATUS_BAD_VALUE;
    }
    /* a higher D* was measured against a colder background */
    p->photons.read_e = sqrt(fmax(wanted_e2 - open_e2, 0) / stages);
    if (p->photons.well_e > 1.2 * (signal_e + d.dark_e)) return STATUS_OK;
    log_error("sheet: %s: 300 K gives %.4g electrons, which fills well_capacity=%g; shorten integration_time", path,
              signal_e + d.dark_e, p->photons.well_e);
    return STATUS_BAD_VALUE;
}

static Status build(SensorPreset *out, const Sheet *s, const char *path)
{
    static const NoiseAxis axis[6] = {NOISE_TV, NOISE_TH, NOISE_VH, NOISE_T, NOISE_V, NOISE_H};
    SensorPreset           p = {.noise_scale = 1,
                                .smear = true,
                                .obscuration = s->obscuration,
                                .bits = s->bits,
                                .dark_e_s = s->dark_e_s,
                                .tdi = s->tdi};
    Status                 status = choose_band(&p.band, s, path);
    if (status == STATUS_OK) status = raster(&p, s, path);
    if (status != STATUS_OK) return status;
    if (floor(s->bits) != s->bits || floor(s->tdi) != s->tdi) {
        log_error("sheet: %s: adc_bits=%g and detectors_in_tdi=%g must be whole numbers", path, s->bits, s->tdi);
        return STATUS_BAD_VALUE;
    }
    strcpy(p.name, s->name);
    p.photons.f_number = s->f_number;
    p.photons.transmission = s->transmission;
    p.photons.qe = s->qe * p.footprint * p.footprint; /* relative to the photons on a whole pixel */
    p.photons.integration_s = isnan(s->integration_us) ? p.scan.line_s : 1e-6 * s->integration_us;
    for (int k = 0; k < 6; k++) p.ratio.sigma[axis[k]] = s->noise[k];
    preset_refresh(&p);
    if (p.scan.by_columns && p.photons.integration_s > p.scan.line_s * (1 + 1e-9)) {
        log_error("sheet: %s: integration_time=%g microsec is longer than the %.4g from column to column", path,
                  1e6 * p.photons.integration_s, 1e6 * p.scan.line_s);
        return STATUS_BAD_VALUE;
    }
    status = noise_of_reading(&p, s, path);
    if (status == STATUS_OK) *out = p;
    return status;
}

Status preset_read_sheet(SensorPreset *out, const char *path)
{
    char  *text = NULL, *next;
    size_t octets;
    Sheet  sheet = {.name = ""};
    Lines  lines = {.path = path};
    Status status = text_read_file(&text, &octets, "sheet", path, sheet_most_octets);
    if (status != STATUS_OK) return status;
    int line = 1;
    if (strlen(text) != octets) {
        log_error("sheet: %s: contains a NUL octet; not a text file", path);
        status = STATUS_BAD_VALUE;
    }
    for (char *at = text; status == STATUS_OK && at; at = next, line++) {
        next = strchr(at, '\n');
        if (next) *next++ = 0;
        status = read_line(&sheet, &lines, line, at);
    }
    if (status == STATUS_OK) status = check_entries(&sheet, &lines);
    if (status == STATUS_OK) status = build(out, &sheet, path);
    free(text);
    return status;
}
