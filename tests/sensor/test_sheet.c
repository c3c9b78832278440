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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_staring_sensor_has_its_sheet_s_figures),
        cmocka_unit_test(a_swept_sensor_has_its_sheet_s_figures),
        cmocka_unit_test(what_is_wrong_is_named),
        cmocka_unit_test(the_example_is_good),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
