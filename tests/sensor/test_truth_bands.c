/* What each band says of a target, against radiance made to order: contrast, signal to noise, intensity. */
#include "tests/sensor/truth_stage.h"

static void contrast_is_the_temperature_difference_that_was_painted(void **state)
{
    (void)state;
    Target t[2];
    scene();
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const bool on = x >= 20 && x < 30 && y >= 10 && y < 16;
            f.id[y * width + x] = on ? 2 : 0;
            f.lwir[y * width + x] =
                (float)planck_band(8e-6, 12e-6, on ? (x < 25 ? 303 : 309) : 300 + (x + y) % 2, NULL);
        }
    f.pixels[1] = (TargetPixels){.visible = 60,
                                 .amodal = 80,
                                 .box = {20, 10, 30, 16},
                                 .amodal_box = {20, 10, 30, 18},
                                 .occluded_ground = 20,
                                 .occluder = -1};
    const double mean = 0.5 * (planck_band(8e-6, 12e-6, 303, NULL) + planck_band(8e-6, 12e-6, 309, NULL));
    f.pixels[1].radiance[picture_lwir] = 60 * mean;
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
    CHECK_NEAR(t[0].visible_fraction, 0.75, 1e-12);
    assert_string_equal(t[0].occluder, "ground");
    const TargetBand *b = &t[0].band[BAND_LWIR];
    /* float radiance: 1e-7 of 38 W/m2/sr over 0.63 W/m2/sr/K is some 1e-5 K */
    CHECK_NEAR(b->contrast_k, 306 - 300.5, 1e-3);
    CHECK_NEAR(b->dt_rss_k, sqrt(5.5 * 5.5 + 9), 1e-3);
    CHECK_NEAR(b->snr, 5.5 / sqrt(0.25 + 0.05 * 0.05), 0.01);
    /* 60 pixels of 1/500 rad at the range */
    CHECK_NEAR(b->intensity_w_sr / (60 * mean * t[0].range_m * t[0].range_m / 250000), 1, 1e-12);
    CHECK(isnan(t[0].band[BAND_MWIR].contrast_k) && isnan(t[0].band[BAND_OPTICAL].snr)); /* not computed: absent */
}

/* Each band over its own noise, on even ground, so that the noise is all that the signal is compared with: 3 K over
 * 0.03 K, 4 K over 0.05 K; a radiance 0.5 above 0.5 over 0.01 in one channel, and over 0.01 / sqrt(3) as the mean of
 * three channels, whose noise is independent. */
static void each_band_has_its_own_noise(void **state)
{
    (void)state;
    static float       mwir[width * height], rgb[3][width * height];
    static const float ground[3] = {0.4f, 0.5f, 0.6f}, painted[3] = {0.8f, 0.9f, 1.3f};
    for (int channels = 1; channels <= 3; channels += 2) {
        Target t[2];
        scene();
        f.picture.mwir = mwir;
        for (int c = 0; c < channels; c++) f.picture.optical[c] = rgb[c];
        for (int i = 0; i < width * height; i++) {
            const int  x = i % width, y = i / width;
            const bool on = x >= 20 && x < 30 && y >= 10 && y < 16;
            f.id[i] = on ? 2 : 0;
            mwir[i] = (float)planck_band(3.4e-6, 4.8e-6, on ? 303 : 300, NULL);
            f.lwir[i] = (float)planck_band(8e-6, 12e-6, on ? 304 : 300, NULL);
            for (int c = 0; c < 3; c++) rgb[c][i] = channels == 1 ? (on ? 1 : 0.5f) : on ? painted[c] : ground[c];
        }
        f.pixels[1] = (TargetPixels){
            .visible = 60, .amodal = 60, .box = {20, 10, 30, 16}, .amodal_box = {20, 10, 30, 16}, .occluder = -1};
        for (int p = 0; p < 3; p++) f.pixels[1].radiance[picture_optical + p] = 7 + 4 * p;
        f.pixels[1].radiance[picture_mwir] = 31;
        f.pixels[1].radiance[picture_lwir] = 53;
        f.request.bands = 1 << BAND_OPTICAL | 1 << BAND_MWIR | 1 << BAND_LWIR;
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        const TargetBand *b = t[0].band;
        CHECK_NEAR(b[BAND_MWIR].contrast_k, 3, 2e-3);
        CHECK_NEAR(b[BAND_LWIR].contrast_k, 4, 2e-3);
        CHECK_NEAR(b[BAND_MWIR].snr, 3 / 0.03, 0.1);
        CHECK_NEAR(b[BAND_LWIR].snr, 4 / 0.05, 0.1);
        CHECK_NEAR(b[BAND_OPTICAL].snr, 0.5 / 0.01 * sqrt(channels), 1e-3);
        CHECK_NEAR(b[BAND_OPTICAL].contrast, 1, 1e-6);
        /* intensities: each band's own sum, and of all channels together, over the square of focal length and range */
        const double per = t[0].range_m * t[0].range_m / 250000;
        CHECK_NEAR(b[BAND_OPTICAL].intensity_w_sr / per, channels == 1 ? 7 : 7 + 11 + 15, 1e-9);
        CHECK_NEAR(b[BAND_MWIR].intensity_w_sr / per, 31, 1e-9);
        CHECK_NEAR(b[BAND_LWIR].intensity_w_sr / per, 53, 1e-9);
        for (int k = 0; k < 4; k++) CHECK(t[0].box[k] == f.pixels[1].box[k]);
    }
}

/* A tenth of a pixel at 320 K, beside another's pixel: mean and variance are its own, the ratio is that of its pixel.
 */
static void a_small_target_is_judged_by_its_samples(void **state)
{
    (void)state;
    static float covered[width * height];
    Target       t[2];
    scene();
    for (int i = 0; i < width * height; i++)
        f.lwir[i] = (float)planck_band(8e-6, 12e-6, 300 + (i % width + i / width) % 2, NULL);
    double       slope;
    const double own = planck_band(8e-6, 12e-6, 320, &slope), ground = f.lwir[10 * width + 20];
    f.lwir[10 * width + 20] = (float)(0.9 * ground + 0.1 * own);
    f.lwir[10 * width + 21] = (float)own;
    covered[10 * width + 20] = 0.1f;
    covered[10 * width + 21] = 0.7f; /* of another entity: no ring */
    f.picture.covered = covered;
    f.pixels[1] = (TargetPixels){.visible = 0.1,
                                 .amodal = 0.2,
                                 .box = {20, 10, 21, 11},
                                 .amodal_box = {20, 10, 21, 11},
                                 .occluder = -1,
                                 .small = true,
                                 .peak_area = 0.1};
    f.pixels[1].radiance[picture_lwir] = 0.1 * own;
    f.pixels[1].mean[picture_lwir] = own;
    f.pixels[1].variance[picture_lwir] = 9 * slope * slope; /* 3 K about the mean */
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
    const TargetBand *b = &t[0].band[BAND_LWIR];
    CHECK_NEAR(t[0].pixels, 0.1, 1e-12);
    /* a ring of 7 pixels about 20, 10: 3 of 300 K (the other's is one of them and left out), 4 of 301 */
    double ring = 0, square = 0;
    int    n = 0;
    for (int y = 9; y <= 11; y++)
        for (int x = 19; x <= 21; x++)
            if (!(covered[y * width + x] > 0)) {
                const double k = 300 + (x + y) % 2;
                ring += k, square += k * k, n++;
            }
    ring /= n;
    assert_int_equal(n, 7);
    CHECK_NEAR(b->contrast_k, 320 - ring, 1e-3);                          /* float radiance, as above */
    CHECK_NEAR(b->dt_rss_k, sqrt((320 - ring) * (320 - ring) + 9), 0.01); /* the slope changes by 0.1 % over its step */
    CHECK_NEAR(b->snr, 0.1 * (320 - ring) / sqrt(square / n - ring * ring + 0.05 * 0.05), 1e-3);
    CHECK_NEAR(b->intensity_w_sr / (0.1 * own * t[0].range_m * t[0].range_m / 250000), 1, 1e-12);
}

/* A small target in all bands, with a budget: means and sampling errors of its own samples. Ground of 300 K and of 0.5;
 * 303 K in MWIR, 308 K in LWIR; 0.3, 0.9 and 1.5 in R, G and B, 0.9 in the mean; 4 of radar on 0.5. Its fullest pixel
 * has a quarter of it. */
static void a_small_target_in_every_band(void **state)
{
    (void)state;
    static float covered[width * height], rgb[3][width * height], mwir[width * height], radar[width * height];
    ErrorBudget  budget = {.probes = 0};
    for (int channels = 1; channels <= 3; channels += 2) {
        Target t[2];
        scene();
        f.picture.covered = covered;
        f.picture.mwir = mwir, f.picture.radar = radar;
        f.picture.budget = &budget;
        for (int c = 0; c < channels; c++) f.picture.optical[c] = rgb[c];
        for (int i = 0; i < width * height; i++) {
            mwir[i] = (float)planck_band(3.4e-6, 4.8e-6, 300, NULL);
            f.lwir[i] = (float)planck_band(8e-6, 12e-6, 300, NULL);
            for (int c = 0; c < 3; c++) rgb[c][i] = 0.5f;
            radar[i] = 0.5f;
        }
        TargetPixels *px = &f.pixels[1];
        *px = (TargetPixels){
            .visible = 0.4, .amodal = 0.4, .box = {20, 10, 21, 11}, .occluder = -1, .small = true, .peak_area = 0.25};
        for (int c = 0; c < 3; c++) {
            px->mean[picture_optical + c] = 0.3 + 0.6 * c;
            px->radiance[picture_optical + c] = 0.4 * (0.3 + 0.6 * c);
            px->radiance_error[picture_optical + c] = 0.01 * (1 + c);
        }
        px->mean[picture_mwir] = planck_band(3.4e-6, 4.8e-6, 303, NULL);
        px->mean[picture_lwir] = planck_band(8e-6, 12e-6, 308, NULL);
        px->mean[picture_radar] = 4;
        px->radiance_error[picture_mwir] = 0.05, px->radiance_error[picture_lwir] = 0.07;
        px->radiance_error[picture_radar] = 0.5;
        px->veiled[BAND_OPTICAL] = 0.25, px->veiled[BAND_MWIR] = 0.5, px->veiled[BAND_LWIR] = 0.125;
        f.request.bands = 1 << BAND_OPTICAL | 1 << BAND_LWIR;
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        const TargetBand *b = t[0].band;
        const double      per = t[0].range_m * t[0].range_m / 250000, mean = channels == 1 ? 0.3 : 0.9;
        CHECK_NEAR(b[BAND_OPTICAL].contrast, (mean - 0.5) / 0.5, 1e-6);
        CHECK_NEAR(b[BAND_OPTICAL].snr, 0.25 * (mean - 0.5) / (0.01 / sqrt(channels)), 1e-4);
        CHECK_NEAR(b[BAND_MWIR].contrast_k, 3, 2e-3);
        CHECK_NEAR(b[BAND_MWIR].snr, 0.25 * 3 / 0.03, 0.05);
        CHECK_NEAR(b[BAND_LWIR].contrast_k, 8, 2e-3);
        CHECK_NEAR(b[BAND_LWIR].dt_rss_k, 8, 2e-3); /* all of one temperature */
        CHECK_NEAR(b[BAND_RADAR].contrast, 7, 1e-6);
        CHECK(isnan(b[BAND_RADAR].snr)); /* even ground, and no noise: not known */
        /* channels are sampled together: their errors add up; those of radar are not */
        CHECK_NEAR(b[BAND_OPTICAL].intensity_error_w_sr / per, channels == 1 ? 0.01 : 0.01 + 0.02 + 0.03, 1e-12);
        CHECK_NEAR(b[BAND_MWIR].intensity_error_w_sr / per, 0.05, 1e-12);
        CHECK_NEAR(b[BAND_LWIR].intensity_error_w_sr / per, 0.07, 1e-12);
        CHECK(isnan(b[BAND_RADAR].intensity_error_w_sr));
        CHECK(b[BAND_OPTICAL].veil_transmittance == 0.75 && b[BAND_LWIR].veil_transmittance == 0.875);
        CHECK(isnan(b[BAND_MWIR].veil_transmittance)); /* not asked for */

        f.picture.mwir = NULL; /* a band that is not there has no error either */
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        CHECK(isnan(b[BAND_MWIR].intensity_error_w_sr) && b[BAND_LWIR].intensity_error_w_sr > 0);
        f.picture.budget = NULL;
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        CHECK(isnan(b[BAND_LWIR].intensity_error_w_sr));
        f.picture.budget = &budget, px->small = false; /* nor has one whose pixels are all of it */
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        CHECK(isnan(b[BAND_LWIR].intensity_error_w_sr));
    }
}

/* A ring of at least as many pixels as the target has, by the mean of what is in it. The ground is 1 in a column of 300
 * to the left, and 4 elsewhere, so that the ring's mean says how far it goes; the picture is wider than what is looked
 * at at once (256 px). */
static void the_ring_grows_until_it_is_as_large(void **state)
{
    (void)state;
    enum { wide = 600, high = 40 };
    static float    optical[wide * high];
    static uint32_t id[wide * high];
    Target          t[2];
    static const struct {
        int    box[4];
        double ring; /* what its ring shows */
    } of[] = {
        /* 2 x 2, grown by one: 16 - 4 pixels, of which 4 are of column 299 */
        {{300, 3, 302, 5}, (4 * 1 + 8 * 4) / 12.0},
        /* 4 x 1 grown by one is 6 x 3 = 18 - 4, 3 of column 299 */
        {{300, 3, 304, 4}, (3 * 1 + 11 * 4) / 14.0},
        /* 1 x 1 in a corner, grown by one: 2 x 2 */
        {{0, 0, 1, 1}, 1},
        {{wide - 1, high - 1, wide, high}, 4},
        /* 20 x 10, grown by three to 26 x 16: 416 pixels are twice its 200; 3 x 16 of the others to the left */
        {{300, 20, 320, 30}, (48 * 1 + 168 * 4) / 216.0},
        /* 40 rows of 290 at the left: grown by ten to column 300, all of 1 but no more than 400 pixels, and so on to
         * 580: 280 columns are the rest of 300, all else is 4 */
        {{0, 0, 290, high}, (10 * 1 + 280 * 4) / 290.0},
        /* all but a column: the whole picture, which holds fewer pixels than the target has */
        {{1, 0, wide, high}, 1},
    };
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        const int *box = of[k].box;
        scene();
        for (int i = 0; i < wide * high; i++) {
            const int x = i % wide, y = i / wide;
            id[i] = x >= box[0] && x < box[2] && y >= box[1] && y < box[3] ? 2 : 0;
            optical[i] = id[i] ? 8 : x < 300 ? 1 : 4;
        }
        f.picture = (Picture){.width = wide, .height = high, .entity = id, .target = f.pixels, .optical = {optical}};
        const double pixels = (box[2] - box[0]) * (box[3] - box[1]);
        f.pixels[1] = (TargetPixels){.visible = pixels, .amodal = pixels, .occluder = -1};
        memcpy(f.pixels[1].box, box, sizeof f.pixels[1].box);
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        CHECK_NEAR(t[0].band[BAND_OPTICAL].contrast, 8 / of[k].ring - 1, 1e-9);
    }
}

/* Optical: what nothing surrounds is told from darkness by its mean; no contrast is 0, one without noise is not known.
 */
static void a_signal_is_known_without_surroundings_and_without_noise(void **state)
{
    (void)state;
    static float optical[width * height];
    Target       t[2];
    scene();
    f.picture.optical[0] = optical;
    for (int i = 0; i < width * height; i++) f.id[i] = 2, optical[i] = 0.5f;
    f.pixels[1] = (TargetPixels){
        .visible = width * height, .amodal = width * height, .box = {0, 0, width, height}, .occluder = -1};
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
    CHECK_NEAR(t[0].band[BAND_OPTICAL].snr, 0.5 / 0.01, 1e-9);
    CHECK(isnan(t[0].band[BAND_OPTICAL].contrast) && isnan(t[0].band[BAND_LWIR].snr));
    const TruthNoise none = {.optical_w_m2_sr = 0};
    f.id[0] = 0; /* one pixel of the same brightness beside it */
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &none), 1);
    CHECK(t[0].band[BAND_OPTICAL].snr == 0);
    optical[0] = 0.25f;
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &none), 1);
    CHECK(isnan(t[0].band[BAND_OPTICAL].snr) && t[0].band[BAND_OPTICAL].contrast == 1);
}

/* What an observer of a sensor resolves is of its visible pixels, of the contrast that they have, and of a band with a
 * sensor. A contrast of 2 K is far above the MRTD of this one, so that its cycles are those of the pixels. */
static void an_observer_resolves_what_is_visible(void **state)
{
    (void)state;
    static Acquisition        curves;
    SensorPreset              p;
    Target                    t[2];
    const AcquisitionObserver observer = acquisition_default_observer();
    TruthNoise                with = noise;
    assert_int_equal(preset_read(&p, "etc/sensors.csv", "staring_lwir"), STATUS_OK);
    acquisition_prepare(&curves, &p, &observer);
    with.observed[BAND_LWIR] = &curves;
    mrtd_noise_emitted(&with.bars[BAND_LWIR], &p, 290);
    scene();
    for (int i = 0; i < width * height; i++) {
        const int x = i % width, y = i / width;
        f.id[i] = x >= 20 && x < 32 && y >= 10 && y < 22 ? 2 : 0;
        /* half of the target 1 K, half 3 K warmer */
        f.lwir[i] = (float)planck_band(8e-6, 12e-6, f.id[i] ? (x & 1 ? 293 : 291) : 290, NULL);
    }
    f.pixels[1] = (TargetPixels){.visible = 144, .amodal = 288, .box = {20, 10, 32, 22}, .occluder = -1};
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &with), 1);
    const TargetBand *b = &t[0].band[BAND_LWIR];
    CHECK_NEAR(b->cycles, 12 * 0.5, 1e-9);
    CHECK_NEAR(b->ttp_v, 12 * acquisition_ttp_px(&curves, &with.bars[BAND_LWIR], sqrt(5)), 1e-3 * b->ttp_v);
    for (int k = 0; k < acquisition_tasks; k++) {
        const double half[] = {2, 7.5, 13}, x = b->ttp_v / half[k], power = pow(x, 1.51 + 0.24 * x);
        CHECK_NEAR(b->p[k], power / (1 + power), 1e-9);
    }
    assert_true(b->p[TASK_DETECT] > b->p[TASK_RECOGNISE] && b->p[TASK_RECOGNISE] > b->p[TASK_IDENTIFY]);
    CHECK(isnan(t[0].band[BAND_MWIR].cycles) && isnan(t[0].band[BAND_OPTICAL].ttp_v));
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
    CHECK(isnan(t[0].band[BAND_LWIR].cycles) && isnan(t[0].band[BAND_LWIR].p[TASK_DETECT])); /* without a sensor */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contrast_is_the_temperature_difference_that_was_painted),
        cmocka_unit_test(each_band_has_its_own_noise),
        cmocka_unit_test(a_small_target_is_judged_by_its_samples),
        cmocka_unit_test(a_small_target_in_every_band),
        cmocka_unit_test(the_ring_grows_until_it_is_as_large),
        cmocka_unit_test(a_signal_is_known_without_surroundings_and_without_noise),
        cmocka_unit_test(an_observer_resolves_what_is_visible),
    };
    return cmocka_run_group_tests(tests, open_fixture, close_fixture);
}
