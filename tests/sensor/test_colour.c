/* Displayed colours against those that an eye's responses give to the same spectra; white at any height of the sun.
 * labels: physics */
#include "tests/check.h"
#include "tests/render/hand_world.h"
#include "tests/sensor/colorimetry.h"

#include "render/light/optical.h"
#include "sensor/detector/chain.h"
#include "sensor/detector/display_values.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"

/* Sharma, Wu and Dalal, Color Res. Appl. 30, 21, 2005, four pairs of the table; and four ColorChecker patches as the
 * maker publishes them in sRGB. */
static void the_judge_is_right(void **state)
{
    (void)state;
    static const double pair[4][7] = {{50, 2.6772, -79.7751, 50, 0, -82.7485, 2.0425},
                                      {50, 2.4900, -0.0010, 50, -2.4900, 0.0009, 7.1792},
                                      {50, 2.5, 0, 73, 25, -18, 27.1492},
                                      {60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644}};
    for (int k = 0; k < 4; k++) CHECK_NEAR(ciede2000(pair[k], pair[k] + 3), pair[k][6], 1e-4);
    static const struct {
        int    patch;
        double code[3];
    } known[] = {{0, {115, 82, 68}}, {3, {87, 108, 67}}, {13, {70, 148, 73}}, {21, {122, 122, 121}}};
    for (int k = 0; k < 4; k++) {
        double seen[3], lab[3], rgb[3], want[3];
        eye_sees(seen, patch[known[k].patch].reflectance);
        lab_of(lab, seen);
        for (int c = 0; c < 3; c++) rgb[c] = pow((known[k].code[c] / 255 + 0.055) / 1.055, 2.4);
        lab_of_rgb(want, rgb);
        CHECK(ciede2000(lab, want) < 2.5);
    }
}

/* ---- displayed ------------------------------------------------------------------------------------ */

/* One pixel from radiance to the screen's light: colour, level from black to white, 16 bits; back by sRGB's curve. */
static void shown_as(double rgb[3], const double w[3], const DisplayColour *colour, double white)
{
    float          in[3] = {(float)w[0], (float)w[1], (float)w[2]};
    float         *plane[3] = {in, in + 1, in + 2};
    uint16_t       code[3];
    DetectorConfig config = detector_default_config();
    config.bits = 16;
    config.display_gamma = true;
    if (colour) display_colour_apply(plane, (const float *const *)plane, 1, colour);
    detector_display_rgb(code, (const float *const *)plane, 1, &config, (DetectorLevel){0, white});
    for (int c = 0; c < 3; c++) {
        const double x = code[c] / 65535.0;
        rgb[c] = x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
    }
}

/* mean and greatest CIEDE2000; hue: of each, as shown. */
static void difference(double *mean, double *most, double *hue, const Spectrum *of, int count, bool balanced)
{
    double        white[3];
    DisplayColour colour;
    bands_see(white, daylight_spectrum);
    for (int c = 0; c < 3; c++) white[c] = sum_of(daylight_spectrum, NULL, NULL, 20 - 10 * c, 11, true);
    display_colour(&colour, white, 0, INFINITY);
    *mean = *most = 0;
    for (int i = 0; i < count; i++) {
        double w[3], rgb[3], seen[3], want[3], got[3];
        bands_see(w, of[i].reflectance);
        shown_as(rgb, w, balanced ? &colour : NULL, colour.white);
        eye_sees(seen, of[i].reflectance);
        lab_of(want, seen);
        lab_of_rgb(got, rgb);
        const double d = ciede2000(want, got);
        *mean += d / count;
        *most = fmax(*most, d);
        if (hue) hue[i] = hue_deg(got);
    }
}

/* Figures of the header, and what bands shown as they are would give: green grass and olive paint in mint. */
static void colours_are_those_an_eye_sees(void **state)
{
    (void)state;
    double mean, most, hue[matter_count], raw_mean, raw_most, raw_hue[matter_count];
    difference(&mean, &most, NULL, patch, patch_count, true);
    print_message("ColorChecker: CIEDE2000 %.2f on average, %.2f at most\n", mean, most);
    CHECK(mean < 2.5 && most < 7.7);
    difference(&mean, &most, hue, matter, matter_count, true);
    difference(&raw_mean, &raw_most, raw_hue, matter, matter_count, false);
    print_message("materials: %.2f, %.2f; grass at %.0f degrees; bands as they are: %.2f, %.2f; %.0f\n", mean, most,
                  hue[0], raw_mean, raw_most, raw_hue[0]);
    CHECK(mean < 1.55 && most < 3.9);
    CHECK(hue[0] > 110 && hue[0] < 135);
    CHECK(raw_mean > 2 * mean && raw_hue[0] > hue[0]);
}

/* Each surface as the package beside the table shows it: float's rounding and five digits of the table. */
static void surfaces_are_shown_as_another_program_shows_them(void **state)
{
    (void)state;
    DisplayColour colour;
    display_colour(&colour, (double[3]){2, 2, 2}, 0, INFINITY);
    for (int k = 0; k < surface_count; k++) {
        const TestSurface *s = &surface[k];
        for (int twice = 0; twice < 2; twice++) { /* twice the light: twice the colour */
            const double light = twice ? 4 : 2;
            float        v[3] = {(float)(light * s->band[0]), (float)(light * s->band[1]), (float)(light * s->band[2])};
            float *const plane[3] = {v, v + 1, v + 2};
            double       lab[3];
            display_colour_apply(plane, (const float *const *)plane, 1, &colour);
            for (int c = 0; c < 3; c++) CHECK_NEAR(v[c] / light, s->rgb[c], 6e-6);
            lab_of_rgb(lab, (const double[3]){v[0] / light, v[1] / light, v[2] / light});
            CHECK_NEAR(ciede2000(s->lab, lab), s->apart, 0.006);
        }
    }
}

/* Noise about black has values below zero: they have no root, and are taken as they are. Grey is grey to float's
 * rounding. */
static void the_dark_and_grey_are_as_they_were(void **state)
{
    (void)state;
    DisplayColour colour;
    float         r[3] = {-0.1f, 0.37f, 1e-20f}, g[3] = {0.2f, 0.37f, 1e-20f}, b[3] = {-0.3f, 0.37f, 1e-20f};
    float *const  plane[3] = {r, g, b};
    display_colour(&colour, (double[3]){1, 1, 1}, 0, INFINITY);
    display_colour_apply(plane, (const float *const *)plane, 3, &colour);
    /* -0.1, 0.2, -0.3 alone: R -0.05116 - 0.06390 - 0.02946, G 0.00141 + 0.24842 + 0.02181, B 0.00213 - 0.00936 -
     * 0.37185; their luminance 0.13618 is kept, and B, the least, is mixed to 0: by the share 0.13618 / (0.13618 +
     * 0.37908) */
    CHECK_NEAR(b[0], 0, 1e-6);
    CHECK_NEAR(g[0], 0.13618 + 0.26430 * (0.27164 - 0.13618), 3e-5);
    CHECK_NEAR(r[0], 0.13618 + 0.26430 * (-0.14452 - 0.13618), 3e-5);
    for (int k = 1; k < 3; k++) {
        const double grey = k == 1 ? 0.37f : 1e-20f;
        CHECK_NEAR(r[k] / grey, 1, 3e-7);
        CHECK_NEAR(g[k] / grey, 1, 3e-7);
        CHECK_NEAR(b[k] / grey, 1, 3e-7);
    }
}

/* A pixel has its colour whatever stands beside it and wherever it stands, also in place: planes at once, and one by
 * one. */
static void a_plane_is_shown_as_its_pixels_are(void **state)
{
    (void)state;
    enum { count = 777 };
    static float  in[3][count], at_once[3][count];
    DisplayColour colour;
    float *const own[3] = {in[0], in[1], in[2]}, *const whole[3] = {at_once[0], at_once[1], at_once[2]};
    display_colour(&colour, (double[3]){1, 1.5, 0.8}, 0.25, 1.2);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < count; i++) in[c][i] = (float)(3 * random_uniform(8, (uint32_t)c, 0, (uint64_t)i) - 0.5);
    in[0][5] = NAN, in[1][300] = INFINITY, in[2][776] = -INFINITY;
    display_colour_apply(whole, (const float *const *)own, count, &colour);
    for (int i = 0; i < count; i++) {
        float        v[3] = {in[0][i], in[1][i], in[2][i]};
        float *const one[3] = {v, v + 1, v + 2};
        display_colour_apply(one, (const float *const *)one, 1, &colour);
        for (int c = 0; c < 3; c++) assert_memory_equal(&at_once[c][i], &v[c], sizeof v[c]);
    }
    display_colour_apply(own, (const float *const *)own, count, &colour);
    assert_memory_equal(in, at_once, sizeof in);
    CHECK(isnan(in[0][5]) && isinf(in[1][300]) && isinf(in[2][776]));
}

/* ---- the day -------------------------------------------------------------------------------------- */

static int elevation_of(double sun_enu[3], double deg)
{
    sun_enu[0] = 0, sun_enu[1] = -cos(deg * rad_per_deg), sun_enu[2] = sin(deg * rad_per_deg);
    return 0;
}

/* Radiance of level, diffuse ground of these reflectances as the renderer shades it, near by. */
static void ground_sends(double w[3], const float rho[3])
{
    static const int      channel[3] = {AIR_R, AIR_G, AIR_B};
    static Hits           hits;
    static Rays           rays;
    static const uint16_t material[hits_capacity];
    static float          texture[hits_capacity], out[hits_capacity];
    Material              row = {.gloss = 0};
    const Materials       materials = {.count = 1, .material = &row};
    hits.count = rays.count = 1;
    hits.n_enu[2][0] = hits.n_geo[2][0] = 1;
    hits.range_m[0] = 1e-3;
    rays.d_enu[2][0] = -1;
    texture[0] = 1;
    for (int c = 0; c < 3; c++) {
        row.rho[channel[c]] = rho[c];
        optical_shade(out, channel[c], &hand.air, &materials, &hits, &rays, material, texture, NULL, NULL, NULL, NULL,
                      NULL);
        w[c] = out[0];
    }
}

/* A white sheet is white within a code, dawn to noon, by radiance and by a camera's counts; grass of the material
 * table is grass. */
static void white_is_white_at_any_height_of_the_sun(void **state)
{
    (void)state;
    static const double deg[] = {-8, -3, 0, 2, 5, 10, 20, 30, 45, 60, 75, 90};
    static const float  white_rho[3] = {0.7f, 0.7f, 0.7f};
    const int           grass = materials_find(&hand.world.materials, "grass_green");
    SensorPreset        preset;
    Chain              *chain;
    CHECK(grass >= 0);
    assert_int_equal(preset_read(&preset, "etc/sensors.csv", "tv"), STATUS_OK);
    preset.optical = OPTICAL_RGB;
    preset_refresh(&preset);
    assert_int_equal(chain_create(&chain, &preset, 32, 32, 1, 1), STATUS_OK);
    double balance_noon = 0, balance_low = 0;
    for (int k = 0; k < (int)(sizeof deg / sizeof *deg); k++) {
        double sun_enu[3], white[3], w[3], sheet[3], rgb[3], lab[3];
        elevation_of(sun_enu, deg[k]);
        arena_reset(hand.air_arena);
        hand_air_on(sun_enu, 2);
        optical_white(white, &hand.air);
        DisplayColour colour;
        display_colour(&colour, white, 0, INFINITY);
        ground_sends(sheet, white_rho);
        for (int bits = 8; bits <= 16; bits += 8) {
            float    in[3] = {(float)sheet[0], (float)sheet[1], (float)sheet[2]}, *plane[3] = {in, in + 1, in + 2};
            uint16_t wide[3];
            uint8_t  narrow[3];
            DetectorConfig config = detector_default_config();
            config.bits = bits;
            config.display_gamma = true;
            display_colour_apply(plane, (const float *const *)plane, 1, &colour);
            detector_display_rgb(bits == 16 ? (void *)wide : narrow, (const float *const *)plane, 1, &config,
                                 (DetectorLevel){0, colour.white});
            for (int c = 0; c < 3; c++) {
                const int code = bits == 16 ? wide[c] >> 8 : narrow[c];
                const int next = bits == 16 ? wide[(c + 1) % 3] >> 8 : narrow[(c + 1) % 3];
                CHECK(abs(code - next) <= 1);
                CHECK(code >= 217 && code <= 219); /* sRGB of 0.7 */
            }
        }
        /* a camera's counts of the sheet, without their noise: the same */
        const double zero = chain_counts_at(chain, 0, 0), full = chain_full(chain) - zero;
        const double scale = 0.3 * full / (chain_counts_at(chain, 0, white[0]) - zero); /* exposed so */
        double       counts[3];
        for (int c = 0; c < 3; c++) counts[c] = chain_counts_at(chain, c, white[c] * scale) - zero;
        display_colour(&colour, counts, zero, full);
        float in[3], *plane[3] = {in, in + 1, in + 2};
        for (int c = 0; c < 3; c++) in[c] = (float)chain_counts_at(chain, c, sheet[c] * scale);
        display_colour_apply(plane, (const float *const *)plane, 1, &colour);
        for (int c = 0; c < 3; c++) CHECK_NEAR((in[c] - zero) / (0.7 * colour.white), 1, 2e-3);

        display_colour(&colour, white, 0, INFINITY);
        const Material *m = &hand.world.materials.material[grass];
        ground_sends(w, (const float[3]){m->rho[AIR_R], m->rho[AIR_G], m->rho[AIR_B]});
        shown_as(rgb, w, &colour, colour.white);
        lab_of_rgb(lab, rgb);
        CHECK(hue_deg(lab) > 110 && hue_deg(lab) < 135);
        if (deg[k] == 90) balance_noon = white[2] / white[0];
        if (deg[k] == 0) balance_low = white[2] / white[0];
    }
    CHECK(balance_low > 1.5 * balance_noon); /* there was something to balance: light past ozone */
    chain_destroy(chain);
}

/* ---- edges ---------------------------------------------------------------------------------------- */

/* Too colourful for a screen, or too bright: the hue stays. Not finite: not touched. No light: as it is. */
static void hue_stays_at_the_ends(void **state)
{
    (void)state;
    DisplayColour colour;
    float         r[5] = {0, 1, 3, NAN, 0}, g[5] = {1, 0, 2, 1, 0}, b[5] = {0, 0, 1, INFINITY, 0};
    float *const  plane[3] = {r, g, b};
    display_colour(&colour, (double[3]){1, 1, 1}, 0, INFINITY);
    display_colour_apply(plane, (const float *const *)plane, 5, &colour);
    CHECK(g[0] > 0.8 && fabs(r[0]) < 1e-6 && b[0] > 0); /* a green that red would be taken from */
    CHECK(r[1] > 0.4 && g[1] > 0 && fabs(b[1]) < 1e-6);
    CHECK(isnan(r[3]) && g[3] == 1 && isinf(b[3]) && r[4] == 0);
    double              before[3], after[3];
    static const double full_green[3] = {-0.3195, 1.2421, -0.0468};
    lab_of_rgb(before, full_green);
    lab_of_rgb(after, (double[3]){r[0], g[0], b[0]});
    CHECK_NEAR(hue_deg(after), hue_deg(before), 8);

    uint8_t        code[3 * 5];
    DetectorConfig config = detector_default_config();
    detector_display_rgb(code, (const float *const *)plane, 3, &config, (DetectorLevel){0, 1});
    CHECK(code[6] == 255); /* 3 : 2 : 1 and brighter than white by far */
    CHECK_NEAR(code[7] / 255.0, g[2] / r[2], 0.003);
    CHECK_NEAR(code[8] / 255.0, b[2] / r[2], 0.003);

    /* counts: one channel full means that white is full, not that it has a colour */
    display_colour(&colour, (double[3]){1000, 1500, 1200}, 16, 4000);
    float        full[3] = {4016, 4016, 4016};
    float *const one[3] = {full, full + 1, full + 2};
    display_colour_apply(one, (const float *const *)one, 1, &colour);
    CHECK_NEAR(full[0], full[1], 0.01);
    CHECK_NEAR(full[2], full[1], 0.01);
    CHECK_NEAR(full[1], 16 + 4000 * (3700.0 / 3) / 1500, 0.01);

    const double dark[2][3] = {{0, 1, 1}, {NAN, 1, 1}};
    for (int k = 0; k < 2; k++) {
        display_colour(&colour, dark[k], 0, INFINITY);
        CHECK(colour.gain[0] == 1 && colour.gain[2] == 1 && colour.white == 0);
    }
}

/* A colour that no screen shows is mixed with the grey of its own luminance, 0.2126 R + 0.7152 G + 0.0722 B (ITU-R
 * BT.709), until its least channel is 0: it keeps its luminance. What it would be without a screen's limits: the root
 * polynomial with what etc/colour/make/correction.py prints. */
static void colours_of_no_screen_keep_their_luminance(void **state)
{
    (void)state;
    static const double lum[3] = {0.2126, 0.7152, 0.0722};
    static const double of_term[3][6] = {{0.5116, -0.3195, 0.0982, 1.2456, -0.1550, -0.3809},
                                         {-0.0141, 1.2421, -0.0727, -0.2215, 0.0402, 0.0260},
                                         {-0.0213, -0.0468, 1.2395, -0.0022, -0.2667, 0.0975}};
    DisplayColour       colour;
    int                 mixed = 0;
    display_colour(&colour, (double[3]){1, 1, 1}, 0, INFINITY);
    for (uint32_t trial = 0; trial < 200; trial++) {
        float        v[3];
        double       free[3] = {0, 0, 0}, luminance = 0, least = INFINITY, shown = 0;
        float *const plane[3] = {v, v + 1, v + 2};
        for (int band = 0; band < 3; band++) v[band] = (float)pow(random_uniform(3, 1, trial, (uint64_t)band), 3);
        const double r = v[0], g = v[1], b = v[2], term[6] = {r, g, b, sqrt(r * g), sqrt(g * b), sqrt(r * b)};
        for (int c = 0; c < 3; c++) {
            for (int k = 0; k < 6; k++) free[c] += of_term[c][k] * term[k];
            luminance += lum[c] * free[c], least = fmin(least, free[c]);
        }
        display_colour_apply(plane, (const float *const *)plane, 1, &colour);
        const double share = least < 0 ? luminance / (luminance - least) : 1;
        mixed += least < 0;
        for (int c = 0; c < 3; c++) {
            CHECK_NEAR(v[c], luminance + share * (free[c] - luminance), 3e-7);
            shown += lum[c] * v[c];
        }
        CHECK_NEAR(shown, luminance, 3e-7);
    }
    CHECK(mixed > 50 && mixed < 150);
}

/* ---- frames --------------------------------------------------------------------------------------- */

/* render() says what white is, and the picture's file shows it so; EXR planes are not touched. */
static void a_frame_is_balanced_by_its_own_day(void **state)
{
    (void)state;
    double sun_enu[3], white[3];
    elevation_of(sun_enu, 20);
    hand_air_on(sun_enu, 2);
    hand_clear();
    const View    view = hand_view((const double[3]){0, 0, 100}, (const double[3]){0, 1, -1}, 16, 16, 100);
    RenderRequest request = hand_request(&view);
    request.bands = 1 << BAND_OPTICAL;
    request.optical = OPTICAL_RGB;
    Picture picture = hand_render(&request, hand.pool);
    optical_white(white, &hand.air);
    CHECK(white[0] > 0);
    assert_memory_equal(picture.white_w_m2_sr, white, sizeof white);

    /* its planes as a white sheet, shades of it on the left */
    float kept[3];
    for (int i = 0; i < 256; i++)
        for (int c = 0; c < 3; c++) picture.optical[c][i] = (float)(white[c] * (i % 16) / 16);
    for (int c = 0; c < 3; c++) kept[c] = picture.optical[c][15];
    Config config = config_default();
    Camera camera = {.chain = {NULL}};
    config.detector.noise = 0;
    config.detector.raw = false;
    char           folder[temp_path_size], path[temp_path_size + 64];
    static uint8_t rgb[256 * 3];
    CHECK(temp_folder(folder));
    assert_int_equal(frame_files_prepare_displays(folder, request.bands, 0), STATUS_OK);
    FrameDisplay     display[BAND_COUNT];
    DisplaysOf       shown = {.config = &config, .picture = &picture, .camera = &camera};
    const FrameFiles files = {.out = folder,
                              .config = &config,
                              .world = &hand.world,
                              .picture = &picture,
                              .snapshot = &hand.snapshot,
                              .request = &request,
                              .host = "h",
                              .config_sha256 = "0",
                              .frame = 0,
                              .png = true,
                              .display = display};
    snprintf(path, sizeof path, "%s/frames/optical/000000.png", folder);

    /* by radiance; then by counts of a camera without noise, at a level by itself and at one by hand */
    SensorPreset preset;
    Chain       *colour;
    assert_int_equal(preset_read(&preset, "etc/sensors.csv", "tv"), STATUS_OK);
    preset.optical = OPTICAL_RGB;
    preset.noise_scale = preset.bad_share = 0;
    preset_refresh(&preset);
    assert_int_equal(chain_create(&colour, &preset, 16, 16, 1, 1), STATUS_OK);
    for (int pass = 0; pass < 3; pass++) {
        if (pass > 0) camera.chain[BAND_OPTICAL] = colour;
        if (pass == 2) {
            config.detector.level = DISPLAY_LEVEL_MANUAL;
            config.detector.optical_high_w_m2_sr = (white[0] + white[1] + white[2]) / 3;
        }
        camera.level[BAND_OPTICAL].known = false;
        assert_int_equal(frame_displays_make(display, &shown, request.bands, hand.pool, hand.arena), STATUS_OK);
        assert_int_equal(frame_files_write_displays(&files, hand.pool), STATUS_OK);
        assert_int_equal(image_read_png(rgb, path), STATUS_OK);
        for (int i = 0; i < 256; i++) /* a count of the camera is up to a code at the dark end */
            for (int c = 0; c < 2; c++) CHECK(abs(rgb[3 * i + c] - rgb[3 * i + c + 1]) <= (pass == 0 ? 1 : 4));
        CHECK(rgb[3 * 14] > 220 && rgb[3 * 1] < 110);
        if (pass == 2) CHECK(rgb[3 * 8] >= 186 && rgb[3 * 8] <= 190); /* sRGB of 8 / 16 */
    }
    chain_destroy(colour);
    for (int c = 0; c < 3; c++) CHECK(picture.optical[c][15] == kept[c]);
    remove(path);
}

static int open_all(void **state)
{
    (void)state;
    return hand_open(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_judge_is_right),
        cmocka_unit_test(colours_are_those_an_eye_sees),
        cmocka_unit_test(surfaces_are_shown_as_another_program_shows_them),
        cmocka_unit_test(the_dark_and_grey_are_as_they_were),
        cmocka_unit_test(a_plane_is_shown_as_its_pixels_are),
        cmocka_unit_test(white_is_white_at_any_height_of_the_sun),
        cmocka_unit_test(hue_stays_at_the_ends),
        cmocka_unit_test(colours_of_no_screen_keep_their_luminance),
        cmocka_unit_test(a_frame_is_balanced_by_its_own_day),
    };
    return cmocka_run_group_tests(tests, open_all, hand_close);
}
