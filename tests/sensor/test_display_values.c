/* Codes of displays and of the converter, to the code: rounding, and pixels without a colour. */
#include "tests/check.h"

#include "sensor/detector/display_values.h"

/* Every display and the converter round to the nearest code: what lies 0.47 above a code is that code, 0.53 above it
 * the next. By radar's decibels, 60 over the scale; by sRGB's curve from code 100 on, where the table's error is below
 * 0.01 of a code. */
static void codes_are_the_nearest(void **state)
{
    (void)state;
    enum { most = 65535 };
    static float    in[most + 1], db[most + 1], linear[most + 1];
    static uint16_t wide[3 * most + 1];
    static uint8_t  code[3 * most + 1];
    DetectorCurve   curve;
    for (int k = 0; k <= curve_steps; k++) curve.value[k] = (double)k / curve_steps;
    for (int bits = 8; bits <= 16; bits += 8)
        for (int above = 0; above < 2; above++) {
            const int      full = bits == 8 ? 255 : most;
            DetectorConfig config = detector_default_config();
            config.bits = bits;
            for (int k = 0; k < full; k++) {
                const double at = k + (above ? 0.53 : 0.47), x = at / full;
                in[k] = (float)x;
                db[k] = (float)pow(10, -0.1 * 60 * (1 - x));
                linear[k] = (float)(x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4));
            }
            const float *const rgb[3] = {in, in, in};
#define CODE(k) (bits == 8 ? code[k] : wide[k])
            void *out = bits == 8 ? (void *)code : (void *)wide;
            detector_display(out, in, (size_t)full, &config, (DetectorLevel){0, 1});
            for (int k = 0; k < full; k++) CHECK(CODE(k) == k + above);
            detector_display_rgb(out, rgb, (size_t)full, &config, (DetectorLevel){0, 1});
            for (int k = 0; k < 3 * full; k++) CHECK(CODE(k) == k / 3 + above);
            detector_display_curve(out, in, (size_t)full, &config, &curve);
            for (int k = 0; k < full; k++) CHECK(CODE(k) == k + above);
            db[full] = 1; /* the brightest */
            detector_display_db(out, db, (size_t)full + 1, 60, bits);
            for (int k = 0; k < full; k++) CHECK(CODE(k) == k + above);
            CHECK(CODE(full) == full);
            config.display_gamma = true;
            detector_display(out, linear, (size_t)full, &config, (DetectorLevel){0, 1});
            for (int k = 100; k < full && bits == 8; k++) CHECK(CODE(k) == k + above);
            for (int k = 0; k < full; k++) in[k] = (float)(2.5 * (k + (above ? 0.53 : 0.47)));
            detector_counts(wide, in, (size_t)full, 2.5, (uint16_t)full);
            for (int k = 0; k < full; k++) CHECK(wide[k] == k + above);
#undef CODE
        }
}

/* A pixel without light has no colour of its own and is as grey as its values say, and one that is not finite shows
 * each value: what is infinite is full, 1 of -1 .. 3 is half of the scale, NaN is 0. Light twice as bright as white
 * keeps its colour: red, the brightest, is full, and the others are their share of it. */
static void pixels_without_a_colour_show_their_values(void **state)
{
    (void)state;
    static const float in[3][6] = {{0, -0.5f, INFINITY, NAN, 12, 1.5f}, {0, 0.5f, 1, 1, 6, 1.5f}, {0, 0, 1, 1, 3, 0}};
    static const int   want[6][3] = {{64, 64, 64},  {32, 96, 64},   {255, 128, 128},
                                     {0, 128, 128}, {255, 128, 64}, {191, 191, 0}};
    const float *const planes[3] = {in[0], in[1], in[2]};
    DetectorConfig     config = detector_default_config();
    uint8_t            code[18];
    detector_display_rgb(code, planes, 6, &config, (DetectorLevel){-1, 3});
    for (int i = 0; i < 6; i++)
        for (int c = 0; c < 3; c++)
            if (code[3 * i + c] != want[i][c]) fail_msg("pixel %d, %d: %d, want %d", i, c, code[3 * i + c], want[i][c]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(codes_are_the_nearest),
        cmocka_unit_test(pixels_without_a_colour_show_their_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
