/* A whole sensor: what a row of the table promises, measured on the counts it puts out. */
#include "tests/check.h"

#include "render/materials/planck.h"
#include "sensor/detector/chain.h"
#include "sensor/detector/level.h"

enum { width = 160, height = 120, pixels = width * height, frames = 60 };
static float        plane[pixels];
static const double still[2] = {0, 0};

static SensorPreset preset_of(const char *name)
{
    char         path[512];
    SensorPreset p;
    CHECK(etc_path(path, sizeof path, "sensors.csv"));
    assert_int_equal(preset_read(&p, path, name), STATUS_OK);
    return p;
}

static void fill(Band band, double temp_k)
{
    double low_m, high_m;
    preset_band(&low_m, &high_m, band, OPTICAL_PAN, -1);
    for (int i = 0; i < pixels; i++) plane[i] = (float)planck_band(low_m, high_m, temp_k, NULL);
}

static Chain *chain_of(const SensorPreset *p)
{
    Chain *chain;
    assert_int_equal(chain_create(&chain, p, width, height, 1, 7), STATUS_OK);
    return chain;
}

/* Mean counts of a frame. */
static double mean_counts(Chain *chain, int frame)
{
    const float *in[1] = {plane};
    double       sum = 0;
    chain_expose(chain, in);
    chain_run(chain, in, NULL, frame, still);
    for (int i = 0; i < pixels; i++) sum += chain_counts(chain, 0)[i];
    return sum / pixels;
}

/* The laboratory's measurement: two black bodies give counts a kelvin; a pixel's deviation over frames, divided by
 * it, is the NEdT. Against first principles by hand: sqrt(n + dark + read^2 + step^2 / 12) / (dn/dT), which
 * test_photons holds against another program. Variance of 60 x 19200 samples: 0.14 %; five of them are 0.4 % in
 * sigma; slope 0.1 %. */
static void netd_is_what_electrons_make_it(void **state)
{
    (void)state;
    static const char *const name[2] = {"staring_lwir", "staring_mwir"};
    static double            sum[pixels], sum2[pixels];
    for (int k = 0; k < 2; k++) {
        SensorPreset p = preset_of(name[k]);
        for (int a = NOISE_TV; a < noise_axes; a++) p.ratio.sigma[a] = 0;
        p.prnu = p.bad_share = 0;
        Chain       *chain = chain_of(&p);
        const float *in[1] = {plane};
        double       warm = 0, cool = 0;
        fill(p.band, 301);
        for (int f = 0; f < 8; f++) warm += mean_counts(chain, f) / 8;
        fill(p.band, 299);
        for (int f = 0; f < 8; f++) cool += mean_counts(chain, f) / 8;
        fill(p.band, 300);
        memset(sum, 0, sizeof sum);
        memset(sum2, 0, sizeof sum2);
        for (int f = 0; f < frames; f++) {
            chain_run(chain, in, NULL, f, still);
            for (int i = 0; i < pixels; i++) {
                const double x = chain_counts(chain, 0)[i];
                sum[i] += x;
                sum2[i] += x * x;
            }
        }
        double variance = 0;
        for (int i = 0; i < pixels; i++) variance += (sum2[i] - sum[i] * sum[i] / frames) / (frames - 1) / pixels;
        const double want = photon_netd_k(&p.photons, 300, p.photons.well_e / (exp2(p.bits) - 1), 0);
        CHECK_NEAR(sqrt(variance) / (0.5 * (warm - cool)) / want, 1, 0.006);
        CHECK_NEAR(chain_netd_k(chain, 300) / want, 1, 2e-3); /* its slope is a difference over 0.1 % of radiance */
        chain_destroy(chain);
    }
}

/* All noise of a preset together, by the estimator: shares of the temporal noise as the table says; half a percent of
 * room for quantisation and the mean of few frames, then the bounds of test_noise3d. */
static void three_dimensional_noise_is_as_the_table_says(void **state)
{
    (void)state;
    static float cube[frames * pixels];
    SensorPreset p = preset_of("staring_mwir");
    Noise3d      got;
    p.bad_share = p.prnu = 0;
    Chain       *chain = chain_of(&p);
    const float *in[1] = {plane};
    fill(BAND_MWIR, 300);
    chain_expose(chain, in);
    for (int f = 0; f < frames; f++) {
        chain_run(chain, in, NULL, f, still);
        memcpy(cube + (size_t)f * pixels, chain_values(chain, 0), sizeof plane);
    }
    assert_int_equal(noise3d_estimate(&got, cube, frames, height, width), STATUS_OK);
    const double n = photon_electrons(&p.photons, 300, NULL) + p.photons.dark_e + p.photons.read_e * p.photons.read_e;
    const double sigma = sqrt(n) / chain_step_e(chain);
    CHECK_NEAR(got.sigma[NOISE_TVH] / sigma, sqrt(1 + 1 / (12 * sigma * sigma)), 0.01);
    CHECK_NEAR(got.sigma[NOISE_VH] / sigma, p.ratio.sigma[NOISE_VH], 0.02 * p.ratio.sigma[NOISE_VH] + 0.005);
    CHECK_NEAR(got.sigma[NOISE_V] / sigma, p.ratio.sigma[NOISE_V], 4 * p.ratio.sigma[NOISE_V] / sqrt(2.0 * height));
    CHECK_NEAR(got.sigma[NOISE_H] / sigma, p.ratio.sigma[NOISE_H], 4 * p.ratio.sigma[NOISE_H] / sqrt(2.0 * width));
    CHECK_NEAR(got.sigma[NOISE_T] / sigma, p.ratio.sigma[NOISE_T], 4 * p.ratio.sigma[NOISE_T] / sqrt(2.0 * frames));

    /* and what truth is told: the squares of all of them */
    double all = got.sigma[NOISE_TVH] * got.sigma[NOISE_TVH];
    for (int a = NOISE_TV; a < noise_axes; a++) all += p.ratio.sigma[a] * p.ratio.sigma[a] * sigma * sigma;
    double slope;
    photon_electrons(&p.photons, 300, &slope);
    CHECK_NEAR(chain_netd_k(chain, 300) / (sqrt(all) * chain_step_e(chain) / slope), 1, 0.01);
    chain_destroy(chain);
}

/* Any frame first; the same again; another seed differs; no noise at all leaves the closed form. */
static void frames_need_no_other(void **state)
{
    (void)state;
    static const char *const name[3] = {"scanning_flir", "staring_lwir", "staring_mwir"};
    static uint16_t          ninth[pixels];
    const double             moving[2] = {300, -120};
    for (int k = 0; k < 3; k++) {
        SensorPreset p = preset_of(name[k]);
        Chain       *a = chain_of(&p), *b = chain_of(&p);
        const float *in[1] = {plane};
        fill(p.band, 295);
        for (int i = 0; i < pixels; i++) plane[i] *= 1 + 0.1f * (float)((i / 7) % 3);
        chain_expose(a, in);
        chain_expose(b, in);
        chain_run(a, in, NULL, 9, moving);
        memcpy(ninth, chain_counts(a, 0), sizeof ninth);
        for (int f = 7; f <= 9; f++) chain_run(b, in, NULL, f, moving);
        assert_memory_equal(ninth, chain_counts(b, 0), sizeof ninth);
        chain_run(b, in, NULL, 10, moving);
        CHECK(memcmp(ninth, chain_counts(b, 0), sizeof ninth) != 0);
        chain_destroy(a);
        chain_destroy(b);

        p.noise_scale = p.bad_share = p.ac_per_line = 0;
        Chain *quiet = chain_of(&p);
        fill(p.band, 310);
        const double want_e = photon_electrons(&p.photons, 310, NULL) + p.photons.dark_e;
        CHECK_NEAR(mean_counts(quiet, 0), want_e / chain_step_e(quiet), 0.5);
        for (int i = 1; i < pixels; i++) CHECK(chain_counts(quiet, 0)[i] == chain_counts(quiet, 0)[0]);
        fill(p.band, 2000); /* far beyond the well: full scale, and no wrap */
        mean_counts(quiet, 0);
        for (int i = 0; i < pixels; i++) CHECK(chain_counts(quiet, 0)[i] == (1 << (int)p.bits) - 1);
        chain_destroy(quiet);
    }
}

/* What truth is told, part by part: the squares of temporal noise, of each pattern as a share of it, of gain, and of
 * the converter's step. Each part is some 0.3 of the sum, so that none can be missing. 0.2 %: chain_sigma's slope. */
static void sigma_is_the_sum_of_its_parts(void **state)
{
    (void)state;
    SensorPreset p = preset_of("scanning_flir");
    double       slope;
    p.ratio = (Noise3d){.sigma = {[NOISE_TVH] = 1, [NOISE_TV] = 0.6, [NOISE_H] = 0.8}};
    p.line_noise = 0.9;
    const double n = photon_electrons(&p.photons, 300, &slope);
    const double temporal = n + p.photons.dark_e + p.photons.read_e * p.photons.read_e;
    p.prnu = sqrt(temporal) / n;
    Chain       *chain = chain_of(&p);
    const double step = chain_step_e(chain);
    const double all = temporal * (1 + 0.36 + 0.64 + 0.81 + 1) + step * step / 12;
    CHECK_NEAR(chain_netd_k(chain, 300) / (sqrt(all) / slope), 1, 2e-3);
    chain_destroy(chain);
}

/* Without light the noise is that of the dark, 30 electrons of reading and the root of 200 of dark current, over the
 * electrons that a small radiance gives. 0.2 %: its slope is taken at 1e-6 W/(m2 sr), an electron. */
static void the_dark_has_its_noise(void **state)
{
    (void)state;
    SensorPreset p = preset_of("staring_lwir");
    p.ratio = (Noise3d){.sigma = {[NOISE_TVH] = 1}};
    p.prnu = p.line_noise = 0;
    p.bits = 16, p.photons.well_e = 1e5, p.photons.read_e = 30;
    p.dark_e_s = 200 / p.photons.integration_s;
    preset_refresh(&p);
    Chain       *chain = chain_of(&p);
    const double step = chain_step_e(chain);
    const double per_w = 1e6 * (chain_counts_at(chain, 0, 1e-6) - chain_counts_at(chain, 0, 0)) * step;
    CHECK_NEAR(chain_counts_at(chain, 0, 0) * step, 200, 1e-9);
    for (int k = 0; k < 2; k++)
        CHECK_NEAR(chain_sigma(chain, 0, k ? -5 : 0) * per_w / sqrt(900 + 200 + step * step / 12), 1, 2e-3);
    chain_destroy(chain);
}

/* A shutter that closes shortens light and dark current alike, and not the noise of reading: with 0.35 of the well
 * in both, half each. */
static void sigma_follows_the_shutter(void **state)
{
    (void)state;
    SensorPreset p = preset_of("tv");
    const double radiance = 100;
    p.ratio = (Noise3d){.sigma = {[NOISE_TVH] = 1}};
    p.prnu = p.line_noise = p.dark_e_s = 0;
    preset_refresh(&p);
    Chain       *chain = chain_of(&p);
    const double light_e = chain_counts_at(chain, 0, radiance) * chain_step_e(chain);
    chain_destroy(chain);
    p.dark_e_s = light_e / p.photons.integration_s;
    preset_refresh(&p);
    chain = chain_of(&p);
    for (int i = 0; i < pixels; i++) plane[i] = (float)radiance;
    const float *in[1] = {plane};
    chain_expose(chain, in);
    const double open = 0.35 * p.photons.well_e / (2 * light_e), step = chain_step_e(chain);
    CHECK(open < 0.5);
    const double all = 2 * open * light_e + p.photons.read_e * p.photons.read_e + step * step / 12;
    CHECK_NEAR(chain_sigma(chain, 0, radiance) / (sqrt(all) * radiance / (open * light_e)), 1, 2e-3);
    chain_destroy(chain);
}

/* Of the faulty pixels those that the table patches are patched: all of them, or none, which show as 0 or full scale:
 * three in four and half of the blinking ones, of 2 % of 19200. Five deviations, in clumps of one. */
static void what_is_not_patched_shows(void **state)
{
    (void)state;
    SensorPreset p = preset_of("staring_lwir");
    p.noise_scale = p.ac_per_line = p.bad_clustered = 0;
    p.bad_share = 0.02;
    fill(BAND_LWIR, 300);
    for (int patched = 0; patched < 2; patched++) {
        int seen = 0;
        p.bad_patched = patched;
        Chain *chain = chain_of(&p);
        mean_counts(chain, 0);
        for (int i = 0; i < pixels; i++)
            seen += chain_counts(chain, 0)[i] == 0 || chain_counts(chain, 0)[i] == (1 << (int)p.bits) - 1;
        const double want = patched ? 0 : 0.02 * 0.875 * pixels;
        CHECK_NEAR(seen, want, 5 * sqrt(want));
        chain_destroy(chain);
    }
}

/* The cut-off of etc/sensors.csv is per line: of the time of a whole line, of which the columns take the active share;
 * swept by columns it is per column. What is left of a step after n pixels is exp(-2 pi ac active n / width), and
 * exp(-2 pi ac n). The tails of diffraction, 0.1 % of the step 20 pixels after it, are 1 % of what is left; a cut-off
 * 10 % off is 19 %. */
static void the_cut_off_is_of_a_line(void **state)
{
    (void)state;
    static const double cut_off[2] = {1, 0.005};
    for (int columns = 0; columns < 2; columns++) {
        SensorPreset p = preset_of(columns ? "scanning_flir2" : "scanning_flir");
        p.noise_scale = p.bad_share = p.ac_per_line = 0;
        p.bits = 16;
        p.scan.active = columns ? 0 : 0.8;
        double left[2] = {0, 0}, mean = 0;
        fill(BAND_LWIR, 290);
        for (int i = 0; i < pixels; i++)
            if (i % width >= 20) plane[i] *= 1.5f;
        for (int on = 0; on < 2; on++) {
            p.ac_per_line = on ? cut_off[columns] : 0;
            Chain       *chain = chain_of(&p);
            const double all = mean_counts(chain, 0);
            if (!on) mean = all;
            for (int r = 0; on && r < height; r += 2) /* odd rows of scanning_flir return */
                for (int k = 0; k < 2; k++) left[k] += (chain_counts(chain, 0)[r * width + 40 + 60 * k] - mean) / 60;
            chain_destroy(chain);
        }
        const double per_px = 2 * pi_rad * cut_off[columns] * (columns ? 1 : 0.8 / width);
        CHECK(left[0] > 500);
        CHECK_NEAR(left[1] / left[0], exp(-60 * per_px), 0.03 * exp(-60 * per_px));
    }
}

/* Lines of the scanning sensor: the noise frame of the pool comes back after ten, not before; its rows are correlated
 * over the length of the table, and not from row to row. */
static void the_pool_of_ten_rolls(void **state)
{
    (void)state;
    SensorPreset p = preset_of("scanning_flir");
    for (int a = NOISE_TV; a < noise_axes; a++) p.ratio.sigma[a] = 0;
    p.photons.read_e = 100, p.line_noise = 5, p.ac_per_line = 0;
    const int    length = (int)p.line_noise_px;
    static float first[pixels], other[pixels];
    Chain       *chain = chain_of(&p);
    fill(BAND_LWIR, 300);
    const double mean = mean_counts(chain, 3);
    double       along = 0, down = 0, square = 0;
    memcpy(first, chain_values(chain, 0), sizeof first);
    for (int f = 4; f <= 13; f++) {
        double together = 0, a = 0, b = 0;
        mean_counts(chain, f);
        memcpy(other, chain_values(chain, 0), sizeof other);
        for (int i = 0; i < pixels; i++) {
            together += (first[i] - mean) * (other[i] - mean);
            a += (first[i] - mean) * (first[i] - mean);
            b += (other[i] - mean) * (other[i] - mean);
            if (i % width + length < width) along += (other[i] - mean) * (other[i + length] - mean);
            if (i / width + 2 < height) down += (other[i] - mean) * (other[i + 2 * width] - mean);
        }
        square += b;
        /* line noise is 25 of 26 parts of the variance, and the converter's step is in it; of 19200 pixels in runs of
         * 2 x 30, 320 are independent */
        const double step = chain_step_e(chain), n = photon_electrons(&p.photons, 300, NULL) + 100 * 100;
        const double want = 25 / (26 + step * step / (12 * n));
        CHECK_NEAR(together / sqrt(a * b), f == 13 ? want : 0, f == 13 ? 0.01 : 5 / sqrt(320));
    }
    /* ten frames: 3200 independent, 1.8 % each; half the length would give 0.13 for 0.35 */
    CHECK(length == 30);
    CHECK_NEAR(along / square * width / (width - length), 25.0 / 26 * exp(-1), 4 / sqrt(3200));
    CHECK_NEAR(down / square, 0, 4 / sqrt(3200));
    chain_destroy(chain);
}

/* Television shuts its shutter in the sun: the mean stays at 0.35 of the well, however bright; in the dark it
 * stays open. */
static void the_shutter_follows_the_light(void **state)
{
    (void)state;
    SensorPreset        p = preset_of("tv");
    Chain              *chain = chain_of(&p);
    static const double bright[] = {1, 10, 100, 1000};
    const double        full = exp2(p.bits) - 1;
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < pixels; i++) plane[i] = (float)bright[k];
        CHECK_NEAR(mean_counts(chain, 0) / full, 0.35, 0.35 * 0.02); /* t noise of that frame, prnu, hot pixels */
    }
    for (int i = 0; i < pixels; i++) plane[i] = 1e-4f;
    const double dark = mean_counts(chain, 0);
    CHECK(dark < 0.02 * full);
    chain_destroy(chain);
}

/* A picture that moves by n pixels while the shutter is open turns an edge into a ramp of n pixels, along and down
 * alike. The shutter is open for the share of the integration time that fills 0.35 of the well: it counts in both. In
 * the middle of a ramp of 8 pixels optics and footprint leave its slope as it is. */
static void what_moves_is_smeared_for_as_long_as_the_shutter_is_open(void **state)
{
    (void)state;
    enum { side = 96, edge = side / 2, moved_px = 8 };
    SensorPreset p = preset_of("tv");
    p.noise_scale = p.bad_share = p.prnu = 0;
    p.smear = true, p.scan.line_s = 0;
    preset_refresh(&p);
    Chain *chain;
    assert_int_equal(chain_create(&chain, &p, side, side, 1, 7), STATUS_OK);
    const double open = 0.35 * p.photons.well_e / (chain_counts_at(chain, 0, 100) * chain_step_e(chain));
    CHECK(open < 0.5);
    for (int down = 0; down < 2; down++) {
        for (int i = 0; i < side * side; i++) plane[i] = (down ? i / side : i % side) < edge ? 50 : 150;
        const float *in[1] = {plane};
        const double rate = moved_px / (open * p.photons.integration_s),
                     rate_px_s[2] = {down ? 0 : rate, down ? rate : 0};
        chain_expose(chain, in);
        chain_run(chain, in, NULL, 0, rate_px_s);
        const int       to = down ? side : 1, at = edge * side + edge;
        const uint16_t *count = chain_counts(chain, 0);
        const double    dark = count[edge * (down ? 1 : side) + 5 * to],
                     light = count[edge * (down ? 1 : side) + (side - 6) * to];
        CHECK(light > 2.9 * dark && light < 3.1 * dark);
        CHECK_NEAR((count[at + 2 * to] - count[at - 2 * to]) / 4.0 * moved_px / (light - dark), 1, 0.02);
    }
    chain_destroy(chain);
}

/* Diffraction is that of the band's photons, of the sun (5772 K) in light and of 300 K in heat: mean wavelengths as
 * another program sums them (tests/sensor/test_photons.c). */
static void diffraction_is_of_the_bands_photons(void **state)
{
    (void)state;
    const SensorPreset tv = preset_of("tv"), mwir = preset_of("staring_mwir"), lwir = preset_of("staring_lwir");
    CHECK_NEAR(1e6 * chain_wavelength_m(&tv, -1) / 0.559410531402, 1, 1e-9);
    CHECK_NEAR(1e6 * chain_wavelength_m(&mwir, -1) / 4.364478931296, 1, 1e-9);
    CHECK_NEAR(1e6 * chain_wavelength_m(&lwir, -1) / 10.118813834165, 1, 1e-9);
}

/* A watt of near infrared is more photons than one of visible light: by the wavelengths at the middle of the bands. In
 * three channels each has its own. */
static void light_counts_by_its_own_wavelength(void **state)
{
    (void)state;
    static const OpticalChannels seen[3] = {OPTICAL_PAN, OPTICAL_NIR, OPTICAL_RGB};
    static const double          middle_um[3] = {0.55, 0.9, 0.65};
    double                       counts[3];
    for (int k = 0; k < 3; k++) {
        SensorPreset p = preset_of("tv");
        p.dark_e_s = 0;
        p.optical = seen[k];
        preset_refresh(&p);
        Chain *chain = chain_of(&p);
        counts[k] = chain_counts_at(chain, 0, 10);
        if (seen[k] == OPTICAL_RGB) CHECK_NEAR(chain_counts_at(chain, 2, 10) / counts[k], 0.45 / 0.65, 1e-12);
        chain_destroy(chain);
    }
    for (int k = 1; k < 3; k++) CHECK_NEAR(counts[k] / counts[0], middle_um[k] / middle_um[0], 1e-12); /* rounding */
}

/* 63 % of the way in one time constant, all of it without. */
static void levels_follow_with_their_time_constant(void **state)
{
    (void)state;
    DetectorLevel       level = {0, 10};
    const DetectorLevel now = {5, 15};
    bool                quick = false;
    for (int k = 0; k < 10; k++) detector_level_follow(&level, &quick, now, 0.1, 1.0);
    CHECK_NEAR(level.low, 5 * (1 - exp(-1)), 1e-12);
    CHECK_NEAR(level.high, 10 + 5 * (1 - exp(-1)), 1e-12);
    detector_level_follow(&level, &quick, now, 0.1, 0);
    CHECK(level.low == 5 && level.high == 15);
}

/* A bad table says where. */
static void bad_rows_are_named(void **state)
{
    (void)state;
    char source[512], path[text_file_size], good[8192], text[9000];
    CHECK(etc_path(source, sizeof source, "sensors.csv"));
    FILE *file = fopen(source, "r");
    CHECK(file != NULL);
    good[fread(good, 1, sizeof good - 1, file)] = 0;
    fclose(file);
    static const struct {
        const char *from, *to, *said;
    } bad[] = {
        {"tv,optical,", "tv,ultraviolet,", "'ultraviolet' is not one of optical, mwir, lwir"},
        {"tv,optical,720,", "tv,optical,7.5e9,", "width_px"},
        {"auto,2000", "sometimes,2000", "'sometimes' is not one of fixed, auto"},
        {",f_number,", ",f_nummer,", "no column f_number"},
        {"tv,optical", "television,optical", "no sensor named 'tv'"},
        {"tv,optical,720,", "tv,optical,720.5,", "width_px: '720.5' is not a whole number in 8 .. 8192"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        SensorPreset p;
        char        *at = strstr(good, bad[i].from);
        CHECK(at != NULL);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, bad[i].to, at + strlen(bad[i].from));
        text_file(path, text);
        check_said[0] = 0;
        log_set_sink(check_listen, NULL);
        assert_int_equal(preset_read(&p, path, "tv"), STATUS_BAD_VALUE);
        log_set_sink(NULL, NULL);
        assert_int_equal(preset_check(path), strstr(bad[i].to, "television") ? STATUS_OK : STATUS_BAD_VALUE);
        if (!strstr(check_said, bad[i].said)) fail_msg("said '%s' where '%s' was wanted", check_said, bad[i].said);
        remove(path);
    }
    assert_int_equal(preset_check(source), STATUS_OK);
}

/* A table of a user's from before detectors were summed and lenses bent: the columns are dropped, the rest is read. */
static void a_table_older_than_its_columns_is_read(void **state)
{
    (void)state;
    static const char head[] =
        "name,band,width_px,height_px,hfov_deg,f_number,obscuration,pitch_um,footprint,transmission,qe,"
        "integration_ms,exposure,dark_e_s,read_e,well_e,bits,jitter_px,tv,th,vh,t,v,h,prnu,line_us,"
        "active,scan,ac_per_line,line_noise,line_noise_px,bad_share,bad_clustered,bad_patched";
    static const char row[] =
        "old,lwir,320,240,10,2,0,25,0.95,0.8,0.7,0.1,fixed,5e9,1000,3.3e7,14,0.1,0.05,0.05,0.4,0.1,0.1,"
        "0.1,0.0003,0,0,stare,0,0,0,0.005,0.3,0.9";
    char         path[text_file_size], text[2048];
    SensorPreset p;
    snprintf(text, sizeof text, "%s,source\n%s,ours\n", head, row);
    text_file(path, text);
    CHECK(preset_read(&p, path, "old") == STATUS_OK);
    CHECK(p.tdi == 1 && p.width_px == 320 && p.bad_patched == 0.9);
    for (int k = 0; k < 5; k++) CHECK(p.lens[k] == 0);
    CHECK(p.lateral[0] == 0 && p.lateral[1] == 0);
    remove(path);
    snprintf(text, sizeof text, "%s,tdi,k1,source\n%s,4,-0.5,ours\n", head, row);
    text_file(path, text);
    CHECK(preset_read(&p, path, "old") == STATUS_OK && p.tdi == 4 && p.lens[0] == -0.5 && p.lens[1] == 0);
    remove(path);
}

int main(void)
{
    thread_flush_denormals();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(netd_is_what_electrons_make_it),
        cmocka_unit_test(three_dimensional_noise_is_as_the_table_says),
        cmocka_unit_test(frames_need_no_other),
        cmocka_unit_test(sigma_is_the_sum_of_its_parts),
        cmocka_unit_test(sigma_follows_the_shutter),
        cmocka_unit_test(the_dark_has_its_noise),
        cmocka_unit_test(what_is_not_patched_shows),
        cmocka_unit_test(the_cut_off_is_of_a_line),
        cmocka_unit_test(the_pool_of_ten_rolls),
        cmocka_unit_test(the_shutter_follows_the_light),
        cmocka_unit_test(what_moves_is_smeared_for_as_long_as_the_shutter_is_open),
        cmocka_unit_test(diffraction_is_of_the_bands_photons),
        cmocka_unit_test(light_counts_by_its_own_wavelength),
        cmocka_unit_test(levels_follow_with_their_time_constant),
        cmocka_unit_test(bad_rows_are_named),
        cmocka_unit_test(a_table_older_than_its_columns_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
