/* The noise that truth says of each band: of figures in the settings, and of sensors at the picture's own radiance. */
#include "tests/check.h"

#include "render/materials/planck.h"
#include "sensor/frame/frame_display.h"

enum { width = 8, height = 4, pixels = width * height };
static float mwir[pixels], lwir[pixels], red[pixels], green[pixels], blue[pixels];

static double low_m[BAND_COUNT], high_m[BAND_COUNT];

/* Black bodies of 310 K in MWIR and 285 K in LWIR; light of 6, 3 and 0 W/(m2 sr), on a half of the pixels. */
static Picture picture_of(void)
{
    for (int b = BAND_MWIR; b <= BAND_LWIR; b++) preset_band(&low_m[b], &high_m[b], (Band)b, OPTICAL_PAN, -1);
    for (int i = 0; i < pixels; i++) {
        mwir[i] = (float)planck_band(low_m[BAND_MWIR], high_m[BAND_MWIR], 310, NULL);
        lwir[i] = (float)planck_band(low_m[BAND_LWIR], high_m[BAND_LWIR], 285, NULL);
        red[i] = i % 2 ? 6 : 0, green[i] = i % 2 ? 3 : 0, blue[i] = 0;
    }
    return (Picture){.width = width, .height = height, .mwir = mwir, .lwir = lwir, .optical = {red, green, blue}};
}

/* Without sensors: the settings' figures times detector.noise; in light a share of the mean of all channels, 1.5 here,
 * and 5e-5 W/(m2 sr) at least. */
static void figures_of_the_settings(void **state)
{
    (void)state;
    Config        config = config_default();
    Camera        camera = {.chain = {NULL}};
    TruthNoise    noise;
    const Picture picture = picture_of();
    config.detector.noise = 2;
    config.detector.netd_mwir_k = 0.03, config.detector.netd_lwir_k = 0.07, config.detector.noise_optical = 0.01;
    camera_expose(&noise, &camera, &picture, &config);
    CHECK_NEAR(noise.netd_mwir_k, 0.06, 1e-15);
    CHECK_NEAR(noise.netd_lwir_k, 0.14, 1e-15);
    CHECK_NEAR(noise.optical_w_m2_sr, 2 * 0.01 * 1.5, 1e-9);
    memset(red, 0, sizeof red), memset(green, 0, sizeof green);
    camera_expose(&noise, &camera, &picture, &config);
    CHECK_NEAR(noise.optical_w_m2_sr, 5e-5, 1e-18);
}

/* Kelvins by which a band's radiance must change for that of its sensor's noise: by differences of the Planck integral,
 * which another program's integrals hold (tests/render/test_planck.c). */
static double netd_k(const Chain *chain, Band band, double temp_k)
{
    const double step_k = 0.05, at = planck_band(low_m[band], high_m[band], temp_k, NULL);
    const double slope = (planck_band(low_m[band], high_m[band], temp_k + step_k, NULL) -
                          planck_band(low_m[band], high_m[band], temp_k - step_k, NULL)) /
                         (2 * step_k);
    return chain_sigma(chain, 0, at) / slope;
}

/* With sensors: their own noise at the mean of the picture, whatever the settings' figures, each band its own. */
static void sensors_at_the_pictures_radiance(void **state)
{
    (void)state;
    static const char *const name[BAND_COUNT] = {
        [BAND_MWIR] = "staring_mwir", [BAND_LWIR] = "staring_lwir", [BAND_OPTICAL] = "tv"};
    char    path[512];
    Config  config = config_default();
    Sensors sensors = {.has = {false}};
    Camera  camera;
    CHECK(etc_path(path, sizeof path, "sensors.csv"));
    for (int b = BAND_OPTICAL; b <= BAND_LWIR; b++) {
        sensors.has[b] = true;
        CHECK(preset_read(&sensors.preset[b], path, name[b]) == STATUS_OK);
    }
    config.sensor.width_px = width, config.sensor.height_px = height;
    CHECK(camera_open(&camera, &sensors, &config, true) == STATUS_OK);
    TruthNoise    noise;
    const Picture picture = picture_of();
    camera_expose(&noise, &camera, &picture, &config);
    CHECK_NEAR(noise.netd_mwir_k / netd_k(camera.chain[BAND_MWIR], BAND_MWIR, 310), 1, 1e-5);
    CHECK_NEAR(noise.netd_lwir_k / netd_k(camera.chain[BAND_LWIR], BAND_LWIR, 285), 1, 1e-5);
    CHECK_NEAR(noise.optical_w_m2_sr / chain_sigma(camera.chain[BAND_OPTICAL], 0, 1.5), 1, 1e-6);
    /* the three differ by more than any of these tolerances */
    CHECK(fabs(noise.netd_mwir_k / noise.netd_lwir_k - 1) > 0.05);
    camera_close(&camera);
}

/* All of it together, as a share of the unit of contrast. */
static double all_noise(const MrtdNoise *n)
{
    double e2 = n->tvh_e2 + n->gain_e2 + n->row_gain_e2 + n->line_e2;
    for (int k = NOISE_TV; k < noise_axes; k++) e2 += n->kind_e2[k];
    return sqrt(e2) / n->per_unit_e;
}

/* What an observer is shown is the noise of the detector's chain, kind by kind: together it is the chain's, in K and as
 * a share of the mean; of colours it is that of green, by the root of three; and only where it is asked for. */
static void an_observer_sees_the_noise_of_the_chain(void **state)
{
    static const char *const name[BAND_COUNT] = {
        [BAND_MWIR] = "staring_mwir", [BAND_LWIR] = "scanning_flir2", [BAND_OPTICAL] = "tv"};
    (void)state;
    for (int colours = 0; colours < 2; colours++) {
        char          path[512];
        Config        config = config_default();
        Sensors       sensors = {.has = {false}};
        Camera        camera;
        TruthNoise    noise;
        const Picture picture = picture_of();
        CHECK(etc_path(path, sizeof path, "sensors.csv"));
        for (int b = BAND_OPTICAL; b <= BAND_LWIR; b++) {
            sensors.has[b] = true;
            CHECK(preset_read(&sensors.preset[b], path, name[b]) == STATUS_OK);
        }
        sensors.preset[BAND_OPTICAL].optical = colours ? OPTICAL_RGB : OPTICAL_PAN;
        config.sensor.width_px = width, config.sensor.height_px = height;
        CHECK(camera_open(&camera, &sensors, &config, true) == STATUS_OK);
        camera_expose(&noise, &camera, &picture, &config);
        CHECK(!noise.observed[BAND_LWIR] && !noise.observed[BAND_OPTICAL]);
        CHECK(camera_observe(&camera, &sensors, &config) == STATUS_OK);
        camera_expose(&noise, &camera, &picture, &config);
        for (int b = BAND_OPTICAL; b <= BAND_LWIR; b++)
            CHECK(noise.observed[b] && noise.observed[b]->preset.width_px == width);
        CHECK(!noise.observed[BAND_RADAR]);
        CHECK_NEAR(all_noise(&noise.bars[BAND_MWIR]) / noise.netd_mwir_k, 1, 1e-4);
        CHECK_NEAR(all_noise(&noise.bars[BAND_LWIR]) / noise.netd_lwir_k, 1, 1e-4);
        const double share = chain_sigma(camera.chain[BAND_OPTICAL], colours, 1.5) / 1.5;
        CHECK_NEAR(all_noise(&noise.bars[BAND_OPTICAL]) / share * (colours ? sqrt(3) : 1), 1, 1e-4);
        camera_close(&camera);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_of_the_settings),
        cmocka_unit_test(sensors_at_the_pictures_radiance),
        cmocka_unit_test(an_observer_sees_the_noise_of_the_chain),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
