/* A sensor's data sheet: what is read from it against its own figures by hand, and what is refused, by file, line, key,
 * value and range. */
#include "tests/check.h"

#include "sensor/detector/preset.h"

#include <stdio.h>

/* A good sheet of each kind. */
static const char staring[] =
    "name cam-1\nsensor_type staring\nspectral_cut_on 3.4 microns\nspectral_cut_off 4.8\nf_number 4\n"
    "eff_focal_length 10 cm\navg_optical_trans 0.8\nhorz_dimension 13.5\nvert_dimension 13.5\n"
    "horz_unit_cell 15\nvert_unit_cell 15\nhorz_detectors 640\nvert_detectors 512\n"
    "integration_time 5000 microsec\nquantum_efficiency 0.8\nnetd 0.03 kelvin\n";
static const char parallel[] =
    "# by columns\nname line\nsensor_type parallel\r\nspectral_cut_on 7.8\nspectral_cut_off 10.5\nf_number 2.5\n"
    "eff_focal_length 10\navg_optical_trans 0.75\nhorz_dimension 25\nvert_dimension 25\n"
    "samples_per_hifov 1.25 # finer\nsamples_per_vifov 1.25\nvert_detectors 480\nhorz_fov 9 degrees\n"
    "frame_rate 30 Hz\nscan_efficiency 0.7\ndetectors_in_tdi 4\nintegration_time 15\nquantum_efficiency 0.7\n"
    "peak_d_star 4\nhigh_pass_3db_cuton 15\nsigma_v_tvh 0.5\nrms_motion 0.1 mrad\n";

static Status read_text(SensorPreset *out, const char *text)
{
    char path[text_file_size];
    text_file(path, text);
    log_set_sink(check_listen, NULL);
    const Status status = preset_read_sheet(out, path);
    log_set_sink(NULL, NULL);
    remove(path);
    return status;
}

/* text with `from` (once in it) replaced. */
static Status read_changed(SensorPreset *out, const char *text, const char *from, const char *to)
{
    char        changed[4096];
    const char *at = strstr(text, from);
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    return read_text(out, changed);
}

static void a_staring_sensor_has_its_sheet_s_figures(void **state)
{
    (void)state;
    SensorPreset p;
    assert_int_equal(read_text(&p, staring), STATUS_OK);
    assert_string_equal(p.name, "cam-1");
    assert_int_equal(p.band, BAND_MWIR);
    CHECK(p.width_px == 640 && p.height_px == 512 && p.tdi == 1 && p.bits == 14 && p.scan.line_s == 0);
    CHECK_NEAR(p.photons.pitch_m, 15e-6, 1e-18);
    CHECK_NEAR(p.footprint, 0.9, 1e-12);
    CHECK_NEAR(p.hfov_deg, 2 * atan(0.5 * 640 * 15e-6 / 0.1) * 180 / pi_rad, 1e-12);
    CHECK_NEAR(p.photons.qe, 0.8 * 0.81, 1e-12);
    /* it has the NETD that it says */
    const PhotonDetector d = preset_photons(&p);
    CHECK_NEAR(photon_netd_k(&d, 300, p.photons.well_e / (exp2(14) - 1), 0), 0.03, 1e-9);
}

static void a_swept_sensor_has_its_sheet_s_figures(void **state)
{
    (void)state;
    SensorPreset p;
    assert_int_equal(read_text(&p, parallel), STATUS_OK);
    assert_int_equal(p.band, BAND_LWIR);
    CHECK(p.scan.by_columns && p.tdi == 4);
    CHECK_NEAR(p.photons.pitch_m, 20e-6, 1e-18);
    CHECK_NEAR(p.footprint, 1.25, 1e-12);
    CHECK(p.width_px == 787); /* 2 tan(4.5 degrees) 0.1 m / 20 um = 787.02 */
    CHECK(p.height_px == 600);
    CHECK_NEAR(p.scan.line_s, 0.7 / 30 / 787, 1e-15);
    CHECK_NEAR(p.ac_per_line, 15 * 0.7 / 30 / 787, 1e-12);
    CHECK_NEAR(p.jitter_px, 0.1e-3 * 0.1 / 20e-6, 1e-12);
    CHECK(p.ratio.sigma[NOISE_V] == 0.5);
    /* D* of 4e10 at 10.5 um: NEP = sqrt(6.25e-6 cm2 / 30e-6 s) / 4e10 = 1.1411e-11 W; in 15 us and by 10.5 um x 0.7 /
     * hc 6331 electrons a stage, 12662 of four: the whole noise of a pixel */
    const PhotonDetector d = preset_photons(&p);
    const double         step_e = p.photons.well_e / (exp2(14) - 1), signal_e = photon_electrons(&d, 300, NULL);
    CHECK_NEAR(sqrt(signal_e + d.read_e * d.read_e + step_e * step_e / 12), 12662, 12);
}

static void what_is_wrong_is_named(void **state)
{
    (void)state;
    static const struct {
        const char *text, *from, *to, *says;
    } slip[] = {
        {staring, "f_number 4", "f_number 0.1", ":5: f_number: '0.1' is not a number in 0.5 .. 100"},
        {staring, "f_number 4", "f_number four", ":5: f_number: 'four' is not a number"},
        {staring, "f_number 4", "f_number nan", "f_number: 'nan'"},
        {staring, "f_number 4", "f_nummer 4", ":5: unknown key 'f_nummer'"},
        {staring, "f_number 4", "f_number", ":5: f_number: '' is not a key and its value"},
        {staring, "f_number 4", "f_number 4 - -", ":5: f_number: '-' is not expected"},
        {staring, "f_number 4\n", "f_number 4\nf_number 4\n", ":6: f_number is given twice, first in line 5"},
        {staring, "f_number 4\n", "", ": no f_number (0.5 .. 100"},
        {staring, "10 cm", "10 mm", ":6: eff_focal_length: 'mm' is not its unit, which is cm"},
        {staring, "staring", "scanning", "sensor_type: 'scanning' is not staring or parallel"},
        {staring, "cam-1", "c,a", "name: 'c,a' is not one word"},
        {staring, "name cam-1\n", "", ": no name"},
        {staring, "3.4 microns", "8 microns", "spectral_cut_on=8 and spectral_cut_off=4.8"},
        {staring, "vert_unit_cell 15", "vert_unit_cell 16", "are not square"},
        {staring, "horz_detectors 640", "horz_detectors 640.5", "whole numbers"},
        {staring, "horz_detectors 640", "horz_detectors 640\nframe_rate 30",
         "frame_rate does not apply to a staring sensor"},
        {staring, "netd 0.03 kelvin\n", "", "give one of netd and peak_d_star, not none"},
        {staring, "netd 0.03 kelvin\n", "netd 0.03\npeak_d_star 1\n", "not both"},
        {staring, "netd 0.03 kelvin", "netd 0.0005", "is better than photons"},
        {staring, "netd 0.03 kelvin\n", "netd 0.03\nwell_capacity 1000\n", "well_capacity=1000"},
        {parallel, "integration_time 15", "integration_time 40", "is longer than the 29.65 from column to column"},
        {parallel, "samples_per_vifov 1.25", "samples_per_vifov 1", "are not square"},
        {parallel, "detectors_in_tdi 4", "detectors_in_tdi 4.5", "must be whole numbers"},
        {parallel, "parallel", "staring", "no horz_unit_cell"},
    };
    for (size_t i = 0; i < sizeof slip / sizeof *slip; i++) {
        SensorPreset p, before;
        memset(&p, 0x5a, sizeof p);
        before = p;
        check_said[0] = 0;
        assert_int_equal(read_changed(&p, slip[i].text, slip[i].from, slip[i].to), STATUS_BAD_VALUE);
        if (!strstr(check_said, slip[i].says)) fail_msg("case %zu: said '%s', not '%s'", i, check_said, slip[i].says);
        assert_memory_equal(&p, &before, sizeof p);
    }
    SensorPreset p;
    log_set_sink(check_listen, NULL);
    assert_int_equal(preset_read_sheet(&p, "/nonexistent/sheet"), STATUS_IO);
    log_set_sink(NULL, NULL);
}

static void the_example_is_good(void **state)
{
    (void)state;
    char         path[512];
    SensorPreset p;
    CHECK(etc_path(path, sizeof path, "sensors/example_flir2.sheet"));
    assert_int_equal(preset_read_sheet(&p, path), STATUS_OK);
    CHECK(p.tdi == 4 && p.height_px == 480);
}

/* Every number of a sheet, as sensor/detector/preset.h and the model's units have it: what is least and most, its unit,
 * what it is when left out (NaN: something else follows from it, or it must be given), and for which kind of sensor. */
enum { of_both, of_staring, of_parallel };
static const struct {
    const char *key, *unit;
    double      low, high, otherwise;
    int         of;
} number[] = {
    {"spectral_cut_on", "microns", 3, 14, NAN, of_both},
    {"spectral_cut_off", "microns", 3, 14, NAN, of_both},
    {"f_number", "-", 0.5, 100, NAN, of_both}, /* 0.5: the least in air */
    {"obscuration", "-", 0, 0.95, 0, of_both},
    {"eff_focal_length", "cm", 0.1, 1e4, NAN, of_both},
    {"avg_optical_trans", "-", 0.001, 1, NAN, of_both},
    {"horz_dimension", "microns", 0.5, 1000, NAN, of_both},
    {"vert_dimension", "microns", 0.5, 1000, NAN, of_both},
    {"horz_unit_cell", "microns", 0.5, 1000, NAN, of_staring},
    {"vert_unit_cell", "microns", 0.5, 1000, NAN, of_staring},
    {"samples_per_hifov", "-", 0.5, 4, 1, of_parallel},
    {"samples_per_vifov", "-", 0.5, 4, 1, of_parallel},
    {"horz_detectors", "-", 8, 8192, NAN, of_staring},
    {"vert_detectors", "-", 8, 8192, NAN, of_both},
    {"horz_fov", "degrees", 0.01, 120, NAN, of_parallel},
    {"frame_rate", "Hz", 0.01, 1e4, NAN, of_parallel},
    {"scan_efficiency", "-", 0.01, 1, 1, of_parallel},
    {"detectors_in_tdi", "-", 1, 1000, 1, of_parallel},
    {"integration_time", "microsec", 1e-3, 1e6, NAN, of_both},
    {"quantum_efficiency", "-", 0.001, 1, NAN, of_both},
    {"netd", "kelvin", 1e-4, 100, NAN, of_both},
    {"peak_d_star", "1e10", 1e-4, 1e4, NAN, of_both},
    {"dark_current", "electrons/s", 0, 1e15, 0, of_both},
    {"well_capacity", "electrons", 100, 1e12, NAN, of_both},
    {"adc_bits", "-", 8, 16, 14, of_both},
    {"sigma_tv_tvh", "-", 0, 100, 0, of_both},
    {"sigma_th_tvh", "-", 0, 100, 0, of_both},
    {"sigma_vh_tvh", "-", 0, 100, 0, of_both},
    {"sigma_t_tvh", "-", 0, 100, 0, of_both},
    {"sigma_v_tvh", "-", 0, 100, 0, of_both},
    {"sigma_h_tvh", "-", 0, 100, 0, of_both},
    {"rms_motion", "mrad", 0, 100, 0, of_both},
    {"high_pass_3db_cuton", "Hz", 0, 1e6, 0, of_parallel},
};

/* A sheet of a kind with one key's line put in place of its own, or left out (NULL). */
static Status read_line_of(SensorPreset *out, const char *sheet, const char *key, const char *line)
{
    char        changed[4096] = "";
    size_t      put = 0;
    const char *at = sheet;
    while (*at) {
        const size_t length = strcspn(at, "\n") + 1;
        if (strncmp(at, key, strlen(key)) != 0 || at[strlen(key)] != ' ')
            put += (size_t)snprintf(changed + put, sizeof changed - put, "%.*s", (int)length, at);
        at += length;
    }
    snprintf(changed + put, sizeof changed - put, "%s", line ? line : "");
    check_said[0] = 0;
    return read_text(out, changed);
}

/* What is least and most is taken as a number, whatever else then does not fit; a ten-thousandth beyond it is refused
 * with its range. A number left out, or given as what it then is, makes the same sensor. */
static void every_number_has_its_range(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof number / sizeof *number; i++)
        for (int kind = 0; kind < 2; kind++) {
            const char  *sheet = kind ? parallel : staring, *unit = number[i].unit;
            char         line[200], says[200];
            SensorPreset p, absent;
            if (number[i].of == (kind ? of_staring : of_parallel)) {
                snprintf(line, sizeof line, "%s %g %s\n", number[i].key, number[i].high, unit);
                CHECK(read_line_of(&p, sheet, number[i].key, line) == STATUS_BAD_VALUE);
                CHECK(strstr(check_said, "does not apply to a"));
                continue;
            }
            snprintf(says, sizeof says, "is not a number in %g .. %g%s%s", number[i].low, number[i].high,
                     *unit == '-' ? "" : " ", *unit == '-' ? "" : unit);
            for (int end = 0; end < 2; end++) {
                const double limit = end ? number[i].high : number[i].low, step = limit > 0 ? 1e-4 * limit : 1e-9;
                snprintf(line, sizeof line, "%s %.17g %s\n", number[i].key, limit, unit);
                read_line_of(&p, sheet, number[i].key, line);
                CHECK(!strstr(check_said, "is not a number") && !strstr(check_said, "its unit"));
                snprintf(line, sizeof line, "%s %.17g %s\n", number[i].key, limit + (end ? step : -step), unit);
                CHECK(read_line_of(&p, sheet, number[i].key, line) == STATUS_BAD_VALUE);
                if (!strstr(check_said, says)) fail_msg("%s: said '%s', not '%s'", number[i].key, check_said, says);
            }
            if (isnan(number[i].otherwise)) continue;
            /* the whole sheet is only one sensor when what is left out fits the rest: rows and columns of square pixels
             */
            const bool fits = strncmp(number[i].key, "samples_per_", 12) != 0;
            memset(&p, 0, sizeof p), memset(&absent, 0, sizeof absent);
            CHECK((read_line_of(&absent, sheet, number[i].key, NULL) == STATUS_OK) == fits);
            snprintf(line, sizeof line, "%s %.17g\n", number[i].key, number[i].otherwise);
            CHECK((read_line_of(&p, sheet, number[i].key, line) == STATUS_OK) == fits);
            if (fits) assert_memory_equal(&p, &absent, sizeof p);
        }
}

/* What has to fit together, at either side of its limit: bands of 3 .. 5.5 and 7 .. 14 microns, in order; pixels square
 * to 1 %; detectors of at most four pixels; 8 to 8192 columns and rows; at most a column's time; a well that 300 K
 * fills to less than 1/1.2; and a NETD that photons, dark current and quantisation allow. */
static void what_must_fit_has_its_limits(void **state)
{
    (void)state;
    static const struct {
        const char *text, *from, *to;
        bool        fits;
    } limit[] = {
        {staring, "3.4 microns\nspectral_cut_off 4.8", "3\nspectral_cut_off 5.5", true},
        {staring, "3.4 microns\nspectral_cut_off 4.8", "3\nspectral_cut_off 5.501", false},
        {staring, "3.4 microns\nspectral_cut_off 4.8", "4.8\nspectral_cut_off 4.8", false},
        {staring, "3.4 microns\nspectral_cut_off 4.8", "4.8\nspectral_cut_off 3.4", false},
        {staring, "3.4 microns\nspectral_cut_off 4.8", "4\nspectral_cut_off 9", false},
        {parallel, "7.8\nspectral_cut_off 10.5", "7\nspectral_cut_off 14", true},
        {parallel, "7.8\nspectral_cut_off 10.5", "6.999\nspectral_cut_off 14", false},
        {parallel, "7.8\nspectral_cut_off 10.5", "9\nspectral_cut_off 9", false},
        {staring, "vert_unit_cell 15", "vert_unit_cell 14.853", true}, /* 1.00990 */
        {staring, "vert_unit_cell 15", "vert_unit_cell 14.849", false},
        {staring, "vert_unit_cell 15", "vert_unit_cell 15.150", true}, /* 0.99010 */
        {staring, "vert_unit_cell 15", "vert_unit_cell 15.153", false},
        {staring, "horz_dimension 13.5\nvert_dimension 13.5", "horz_dimension 60\nvert_dimension 60", true},
        {staring, "horz_dimension 13.5\nvert_dimension 13.5", "horz_dimension 60\nvert_dimension 60.1", false},
        {staring, "horz_detectors 640", "horz_detectors 8", true},
        {staring, "horz_detectors 640", "horz_detectors 8192", true},
        {staring, "vert_detectors 512", "vert_detectors 8", true},
        {staring, "vert_detectors 512", "vert_detectors 8192", true},
        {staring, "vert_detectors 512", "vert_detectors 511.5", false},
        {parallel, "horz_fov 9 degrees", "horz_fov 0.0888", true},  /* 2 tan(0.0444 degrees) 0.1 m / 20 um = 7.75 */
        {parallel, "horz_fov 9 degrees", "horz_fov 0.0853", false}, /* 7.44 */
        {parallel, "horz_fov 9 degrees", "horz_fov 80", false},     /* 8391 */
        {parallel, "480", "6553.6", false},
        {parallel, "480", "6554", false}, /* 1.25 of it: 8192.5, rounded up */
        {parallel, "480", "6553", true},
        {parallel, "480", "8", true},
        {parallel, "integration_time 15", "integration_time 29.647", true}, /* 0.7 / 30 / 787 = 29.6485 us */
        {parallel, "integration_time 15", "integration_time 29.650", false},
        {staring, "netd 0.03", "adc_bits 12.5\nnetd 0.03", false},
    };
    for (size_t i = 0; i < sizeof limit / sizeof *limit; i++) {
        SensorPreset p;
        const Status status = read_changed(&p, limit[i].text, limit[i].from, limit[i].to);
        if ((status == STATUS_OK) != limit[i].fits) fail_msg("case %zu: '%s': %s", i, limit[i].to, check_said);
    }
    for (int over = 0; over < 2; over++) { /* a column's time, to a part in a billion */
        SensorPreset p;
        char         to[100];
        snprintf(to, sizeof to, "integration_time %.17g", 1e6 * 0.7 / 30 / 787 * (over ? 1 + 1e-7 : 1));
        CHECK((read_changed(&p, parallel, "integration_time 15", to) == STATUS_OK) == !over);
    }
    /* the well: 1.2 times what photons and dark current of 300 K give; left out, 2.5 times that */
    static const char *const with[2] = {"netd 0.03", "dark_current 2e8\nnetd 0.1"};
    for (int dark = 0; dark < 2; dark++) {
        SensorPreset p, full;
        assert_int_equal(read_changed(&p, staring, "netd 0.03", with[dark]), STATUS_OK);
        const PhotonDetector d = preset_photons(&p);
        const double         given_e = photon_electrons(&d, 300, NULL) + (dark ? 2e8 * 5e-3 : 0);
        CHECK_NEAR(p.photons.well_e / given_e, 2.5, 1e-12);
        for (int over = 0; over < 2; over++) {
            char to[100];
            snprintf(to, sizeof to, "well_capacity %.17g\n%s", (1.2 + (over ? 1e-6 : -1e-6)) * given_e, with[dark]);
            CHECK((read_changed(&full, staring, "netd 0.03", to) == STATUS_OK) == over);
        }
        /* the NETD: sqrt(electrons + step^2 / 12) over the electrons a kelvin; it leaves no reading noise at the limit
         */
        double per_k;
        photon_electrons(&d, 300, &per_k);
        const double step_e = 2.5 * given_e / (exp2(14) - 1), least_k = sqrt(given_e + step_e * step_e / 12) / per_k;
        for (int over = 0; over < 2; over++) {
            char to[100];
            snprintf(to, sizeof to, "%snetd %.17g", dark ? "dark_current 2e8\n" : "",
                     (1 + (over ? 1e-6 : -1e-6)) * least_k);
            CHECK((read_changed(&full, staring, "netd 0.03", to) == STATUS_OK) == over);
            if (over) CHECK_NEAR(full.photons.read_e / (sqrt(2e-6) * least_k * per_k), 1, 1e-3);
        }
    }
}

/* Random motion of 0.1 mrad at 10 cm is 10 um, 2/3 of a pixel of 15; detectors of 14 x 13 um have the area of sqrt(182)
 * um squared, and what they miss of a pixel; a sheet without a time integrates for a column's, 0.7 / 30 / 787 s; a D*
 * so high that photons of 300 K alone are noisier leaves no noise of reading. */
static void the_rest_follows(void **state)
{
    (void)state;
    SensorPreset p;
    assert_int_equal(read_changed(&p, staring, "horz_dimension 13.5\nvert_dimension 13.5",
                                  "rms_motion 0.1\nhorz_dimension 14\nvert_dimension 13"),
                     STATUS_OK);
    CHECK_NEAR(p.jitter_px, 2.0 / 3, 1e-12);
    CHECK_NEAR(p.footprint, sqrt(182.0) / 15, 1e-12);
    CHECK_NEAR(p.photons.qe, 0.8 * 182 / 225, 1e-12);
    CHECK_NEAR(p.photons.integration_s, 5e-3, 1e-15);
    assert_int_equal(read_line_of(&p, parallel, "integration_time", NULL), STATUS_OK);
    CHECK_NEAR(p.photons.integration_s, 0.7 / 30 / 787, 1e-15);
    CHECK_NEAR(p.hfov_deg, 2 * atan(0.5 * 787 * 20e-6 / 0.1) * 180 / pi_rad, 1e-12);
    assert_int_equal(read_line_of(&p, parallel, "peak_d_star", "peak_d_star 100\n"), STATUS_OK);
    CHECK(p.photons.read_e == 0);
    /* of four stages each has a quarter of the squares: 0.1 K of the sum */
    assert_int_equal(read_line_of(&p, parallel, "peak_d_star", "netd 0.1\n"), STATUS_OK);
    PhotonDetector one = p.photons, all = one;
    all.integration_s *= 4, all.read_e = 2 * one.read_e;
    CHECK_NEAR(photon_netd_k(&all, 300, p.photons.well_e / (exp2(14) - 1), 0), 0.1, 1e-9);
    CHECK(one.read_e > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_staring_sensor_has_its_sheet_s_figures),
        cmocka_unit_test(a_swept_sensor_has_its_sheet_s_figures),
        cmocka_unit_test(what_is_wrong_is_named),
        cmocka_unit_test(the_example_is_good),
        cmocka_unit_test(every_number_has_its_range),
        cmocka_unit_test(what_must_fit_has_its_limits),
        cmocka_unit_test(the_rest_follows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
