/* Radars of etc/radars.csv, and rows that are refused, each with the column it is refused for. */
#include "tests/check.h"

#include "sensor/radar/radar_preset.h"

static const char header[] =
    "name,waveform,centre_ghz,bandwidth_mhz,samples,pulses,repeat_khz,pulse_us,power_w,loss_db,dish_m,taper,transmit,"
    "noise_figure_db,phase_noise_deg,iq_gain_db,iq_phase_deg,bits,range_window,doppler_window,pfa,compensated,far_km,mti,source\n";

static void bundled_rows_are_read(void **state)
{
    (void)state;
    RadarPreset p;
    char        path[4096];
    CHECK(etc_path(path, sizeof path, "radars.csv") && radar_preset_check(path) == STATUS_OK);
    CHECK(radar_preset_read(&p, path, "seeker_94") == STATUS_OK);
    CHECK_NEAR(p.wave.centre_hz, 94e9, 1);
    CHECK_NEAR(p.antenna.wavelength_m, 3.18928e-3, 1e-8);
    CHECK_NEAR(p.loss, 3.1622776601683795, 1e-12);
    CHECK(p.wave.samples == 512 && p.range_window.kind == WINDOW_TAYLOR && !p.transmits_h);
    CHECK(p.wave.kind == WAVEFORM_LFM && !p.wave.uncompensated && p.mti_rows == 2 && p.far_m == 0);
    CHECK(radar_preset_read(&p, path, "stepped_35") == STATUS_OK && p.wave.kind == WAVEFORM_STEPPED);
    CHECK_NEAR(p.wave.repeat_hz, 100e3 / 256, 1e-9); /* of bursts */
    CHECK(radar_preset_read(&p, path, "pulse_doppler_ku") == STATUS_OK && p.far_m == 20e3 && p.mti_rows == 3);
    CHECK(radar_preset_read(&p, path, "fmcw_94") == STATUS_OK && p.wave.kind == WAVEFORM_FMCW);
    log_set_sink(check_listen, NULL);
    CHECK(radar_preset_read(&p, path, "none_such") == STATUS_BAD_VALUE);
    log_set_sink(NULL, NULL);
    CHECK(strstr(check_said, "seeker_94") && strstr(check_said, "search_ku"));
}

static void bad_rows_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *row, *column;
    } bad[] = {
        {"x,lfm,0,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "centre_ghz"},
        {"x,lfm,94,60000,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "bandwidth_mhz"},
        {"x,lfm,1,600,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "bandwidth_mhz"},
        {"x,lfm,94,500,511,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "samples"},
        {"x,lfm,94,500,65536,4096,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "pulses"},
        {"x,lfm,94,500,512,64,20,51,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "pulse_us"},
        {"x,lfm,94,500,512,64,20,20,10,5,0.2,0.5,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "taper"},
        {"x,lfm,94,500,512,64,20,20,10,5,0.2,1,x,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "transmit"},
        {"x,lfm,94,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,1,hann,hann,1e-6,1,0,2,s\n", "bits"},
        {"x,lfm,94,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,bell,hann,1e-6,1,0,2,s\n", "range_window"},
        {"x,lfm,94,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,kaiser:99,1e-6,1,0,2,s\n", "doppler_window"},
        {"x,lfm,94,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,0,1,0,2,s\n", "pfa"},
        {"x,lfm,94,500,512,64,20,nan,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "pulse_us"},
        {"x,chirp,94,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "waveform"},
        {"x,stepped,94,500,512,64,20,51,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", "pulse_us"},
        {"x,stepped,94,500,512,64,20,1,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n",
         "bandwidth_mhz"}, /* 25.6 ms */
        {"x,stepped,94,200,512,64,20,1,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,9,2,s\n", "far_km"},
        {"x,fmcw,94,200,512,64,20,1,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,9,2,s\n", "far_km"},
        {"x,pulse_doppler,94,20,512,64,20,1,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,9,2,s\n", "bandwidth_mhz"},
        {"x,lfm,94,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,0.5,0,2,s\n", "compensated"},
        {"x,lfm,94,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,501,2,s\n", "far_km"},
        {"x,lfm,94,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,4,s\n", "mti"},
        {"x,lfm,94,500,512,2,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,3,s\n", "mti"},
    };
    RadarPreset p;
    char        path[text_file_size], text[1024];
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snprintf(text, sizeof text, "%s%s", header, bad[i].row);
        text_file(path, text);
        log_set_sink(check_listen, NULL);
        CHECK(radar_preset_check(path) == STATUS_BAD_VALUE);
        CHECK(radar_preset_read(&p, path, "x") == STATUS_BAD_VALUE);
        log_set_sink(NULL, NULL);
        if (!strstr(check_said, bad[i].column)) fail_msg("row %zu: said: %s", i, check_said);
        remove(path);
    }
}

/* What columns bound together, from either side: the first row of a pair is taken, the second refused. */
static void bounds_of_columns_together(void **state)
{
    (void)state;
    static const char *const pair[][2] = {
        {"x,lfm,94,500,512,2,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", /* mti up to pulses */
         "x,lfm,94,500,512,2,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,3,s\n"},
        {"x,lfm,10,5000,8,2,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", /* half of the centre */
         "x,lfm,10,5001,8,2,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n"},
        {"x,lfm,94,50,512,64,20,50,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n", /* a pulse as long as its period
                                                                                       */
         "x,lfm,94,50,512,64,20,50.01,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n"},
        {"x,stepped,94,50,8,64,20,50,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n",
         "x,stepped,94,50,8,64,20,50.01,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n"},
        {"x,lfm,94,50,65536,64,20,20,10,5,0.2,1,v,8,2,0,0,2,hann,hann,1e-6,1,0,2,s\n", /* 2^22 samples; bits from 2 */
         "x,lfm,94,50,65536,66,20,20,10,5,0.2,1,v,8,2,0,0,2,hann,hann,1e-6,1,0,2,s\n"},
        /* bandwidth by the profile's time up to 1e7: 512 steps at 20 kHz take 25.6 ms */
        {"x,stepped,94,390,512,64,20,1,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n",
         "x,stepped,94,391,512,64,20,1,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,0,2,s\n"},
        {"x,pulse_doppler,94,10.24,512,64,20,1,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,9,2,s\n",
         "x,pulse_doppler,94,10.24001,512,64,20,1,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,1,9,2,s\n"},
    };
    char path[text_file_size], text[1024];
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof pair / sizeof *pair; i++)
        for (int beyond = 0; beyond < 2; beyond++) {
            snprintf(text, sizeof text, "%s%s", header, pair[i][beyond]);
            text_file(path, text);
            const Status status = radar_preset_check(path);
            remove(path);
            if (beyond && strstr(pair[i][1], "stepped,94,391"))
                CHECK(strstr(check_said, "390.6") && strstr(check_said, "25.6 ms"));
            if (status != (beyond ? STATUS_BAD_VALUE : STATUS_OK)) fail_msg("%s: %d", pair[i][beyond], (int)status);
        }
    log_set_sink(NULL, NULL);
}

/* The columns of etc/radars.csv before waveforms were named: LFM, compensated, nothing folded, two rows. */
static void a_table_older_than_its_columns_is_read(void **state)
{
    (void)state;
    RadarPreset p;
    char        path[text_file_size];
    text_file(path,
              "name,centre_ghz,bandwidth_mhz,samples,pulses,repeat_khz,pulse_us,power_w,loss_db,dish_m,taper,transmit,"
              "noise_figure_db,phase_noise_deg,iq_gain_db,iq_phase_deg,bits,range_window,doppler_window,pfa,source\n"
              "x,94,500,512,64,20,20,10,5,0.2,1,v,8,2,0,0,12,hann,hann,1e-6,s\n");
    CHECK(radar_preset_read(&p, path, "x") == STATUS_OK);
    CHECK(p.wave.kind == WAVEFORM_LFM && !p.wave.uncompensated && p.far_m == 0 && p.mti_rows == 2 && !p.transmits_h);
    remove(path);
}

/* Every column, each of another value, in its own member and unit. */
static void columns_are_taken_by_their_names(void **state)
{
    (void)state;
    RadarPreset p;
    char        path[text_file_size], text[1024];
    snprintf(text, sizeof text, "%s%s", header,
             "x,lfm,94,500,512,64,21,19,11,5,0.25,2,h,8,2,0.5,3,12,taylor:5:40,hann,1e-6,0,7,3,s\n");
    text_file(path, text);
    CHECK(radar_preset_read(&p, path, "x") == STATUS_OK);
    remove(path);
    const Waveform *w = &p.wave;
    CHECK(w->kind == WAVEFORM_LFM && w->samples == 512 && w->pulses == 64 && w->uncompensated);
    CHECK_NEAR(w->centre_hz, 94e9, 1);
    CHECK_NEAR(w->bandwidth_hz, 500e6, 1e-3);
    CHECK_NEAR(w->repeat_hz, 21e3, 1e-9);
    CHECK_NEAR(w->pulse_s, 19e-6, 1e-18);
    CHECK_NEAR(p.power_w, 11, 1e-12);
    CHECK_NEAR(p.loss, 3.1622776601683795, 1e-12);
    CHECK_NEAR(p.antenna.diameter_m, 0.25, 1e-15);
    CHECK_NEAR(p.antenna.wavelength_m, 299792458.0 / 94e9, 1e-15);
    CHECK(p.antenna.taper == 2 && p.transmits_h && p.mti_rows == 3 && p.receiver.bits == 12);
    CHECK_NEAR(p.receiver.noise_figure, 6.309573444801933, 1e-12); /* 8 dB of power */
    CHECK_NEAR(p.receiver.phase_noise_rad, 0.03490658503988659, 1e-15);
    CHECK_NEAR(p.receiver.iq_gain, 0.05925372517728890, 1e-12); /* 0.5 dB of amplitude, beyond 1 */
    CHECK_NEAR(p.receiver.iq_phase_rad, 0.05235987755982988, 1e-15);
    CHECK(p.range_window.kind == WINDOW_TAYLOR && p.doppler_window.kind == WINDOW_HANN);
    CHECK_NEAR(p.pfa, 1e-6, 1e-18);
    CHECK_NEAR(p.far_m, 7000, 1e-9);
    CHECK(p.receiver.noise_counts == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bundled_rows_are_read),
        cmocka_unit_test(columns_are_taken_by_their_names),
        cmocka_unit_test(bad_rows_are_refused),
        cmocka_unit_test(bounds_of_columns_together),
        cmocka_unit_test(a_table_older_than_its_columns_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
