/* Faulty pixels by their statistics, shown and patched by hand. */
#include "tests/check.h"

#include "sensor/detector/array_noise.h"

enum { width = 720, height = 486, planes = 8 };
static uint8_t  map[width * height];
static uint16_t count[width * height];

/* Expected share within five deviations: faults come in clumps of up to 9, so n is less by as much; overlapping
 * clumps lose at most the share of themselves. */
static void share_and_kinds_are_as_asked(void **state)
{
    (void)state;
    static const double share[3] = {0.001, 0.005, 0.02}, clustered[3] = {0, 0.3, 1};
    for (int k = 0; k < 9; k++) {
        int kinds[4] = {0}, beside = 0;
        for (int plane = 0; plane < planes; plane++) {
            bad_pixels_make(map, width, height, share[k % 3], clustered[k / 3], 4, (uint32_t)(planes * k + plane));
            for (int i = 0; i < width * height; i++) {
                kinds[map[i]]++;
                beside += map[i] && i % width > 0 && map[i - 1];
            }
        }
        const double n = planes * width * height, bad = n - kinds[PIXEL_GOOD], want = share[k % 3] * n;
        const double mean = 1 + 4 * clustered[k / 3], deviation = sqrt(want * (mean + 6 * clustered[k / 3]));
        CHECK_NEAR(bad, want, 5 * deviation + share[k % 3] * want);
        CHECK_NEAR(kinds[PIXEL_DEAD], 0.5 * bad, 5 * deviation);
        CHECK_NEAR(kinds[PIXEL_HOT], 0.25 * bad, 5 * deviation);
        CHECK((beside > 3 * share[k % 3] * bad + 10) == (clustered[k / 3] > 0));
    }
    bad_pixels_make(map, width, height, 0, 0.5, 4, 0);
    for (int i = 0; i < width * height; i++) CHECK(map[i] == PIXEL_GOOD);
}

static void kinds_show_as_they_are(void **state)
{
    (void)state;
    int on = 0, changes = 0, was = -1;
    memset(map, PIXEL_GOOD, sizeof map);
    map[5] = PIXEL_DEAD, map[6] = PIXEL_HOT, map[7] = PIXEL_BLINKING;
    for (int frame = 0; frame < 8000; frame++) {
        for (int i = 0; i < 10; i++) count[i] = 1000;
        bad_pixels_insert(count, map, 10, 1, 16383, &(NoiseDraw){1, 0, frame});
        CHECK(count[5] == 0 && count[6] == 16383 && count[4] == 1000 && (count[7] == 1000 || count[7] == 16383));
        on += count[7] == 16383;
        if (was >= 0 && was != count[7]) {
            changes++;
            CHECK(frame % 8 == 0);
        }
        was = count[7];
    }
    CHECK_NEAR(on, 4000, 5 * 8 * sqrt(250)); /* 1000 lots of one half */
    const int many = width * height;
    memset(map, PIXEL_BLINKING, sizeof map);
    memset(count, 0, sizeof count);
    bad_pixels_insert(count, map, width, height, 16383, &(NoiseDraw){1, 0, 0});
    on = 0;
    for (int i = 0; i < many; i++) on += count[i] == 16383;
    CHECK_NEAR(on, 0.5 * many, 5 * sqrt(0.25 * many));
    CHECK_NEAR(changes, 500, 5 * sqrt(250));
}

static void patches_come_from_the_nearest_good(void **state)
{
    (void)state;
    for (int i = 0; i < 100; i++) count[i] = (uint16_t)(10 * (i % 10) + 100 * (i / 10)), map[i] = PIXEL_GOOD;
    /* one alone: the mean of its eight, which on a slope is itself */
    map[44] = PIXEL_DEAD, count[44] = 0;
    bad_pixels_replace(count, map, 10, 10);
    CHECK(count[44] == 440);
    /* a corner: three neighbours 10, 100, 110: 73.3 */
    map[0] = PIXEL_HOT, count[0] = 16383;
    bad_pixels_replace(count, map, 10, 10);
    CHECK(count[0] == 73);
    /* each side of the ring counts: 80 above, 16 below, 8 and 24 beside: (3 x 80 + 3 x 16 + 8 + 24) / 8 = 40 */
    uint16_t own[25] = {0, 0, 0, 0, 0, 0, 80, 80, 80, 0, 0, 8, 9999, 24, 0, 0, 16, 16, 16, 0};
    uint8_t  one[25] = {[12] = PIXEL_HOT};
    bad_pixels_replace(own, one, 5, 5);
    CHECK(own[12] == 40);
    /* the middle of a 3 x 3 clump: the ring two away, symmetric: itself again; never from a fault */
    for (int y = 4; y < 7; y++)
        for (int x = 4; x < 7; x++) map[y * 10 + x] = PIXEL_HOT, count[y * 10 + x] = 16383;
    bad_pixels_replace(count, map, 10, 10);
    CHECK(count[55] == 550);
    for (int i = 0; i < 100; i++) CHECK(count[i] <= 1000);
    memset(map, PIXEL_DEAD, 100); /* nothing to patch from */
    bad_pixels_replace(count, map, 10, 10);
    CHECK(count[55] == 550);
}

/* A clump takes each of the eight pixels about it by a half, of those on the plane: a pixel with n neighbours is good
 * by (1 - b) (1 - b/2)^n, where clumps begin by b. b = 0.05: of those within 22.4 % are bad, along an edge, n = 5, 16.3
 * %, along the next row in 22.4 again. 800 planes of 30 pixels a side; neighbours are bad together, in clumps of 5:
 * five deviations of as many fewer. */
static void clumps_reach_the_edges(void **state)
{
    (void)state;
    enum { side = 32, lots = 800 };
    static uint8_t at[side * side];
    const double   b = 0.05, edge = 1 - (1 - b) * pow(1 - b / 2, 5), within = 1 - (1 - b) * pow(1 - b / 2, 8);
    double         bad[8] = {0}; /* rows 0, 1, last but one, last; columns */
    for (int lot = 0; lot < lots; lot++) {
        bad_pixels_make(at, side, side, 5 * b, 1, 11, (uint32_t)lot);
        for (int i = 1; i < side - 1; i++) {
            static const int of[4] = {0, 1, side - 2, side - 1};
            for (int k = 0; k < 4; k++) bad[k] += at[of[k] * side + i] > 0, bad[4 + k] += at[i * side + of[k]] > 0;
        }
    }
    const double n = lots * (side - 2), deviation = 5 * sqrt(5 * 0.2 * 0.8 / n);
    for (int k = 0; k < 8; k++) CHECK_NEAR(bad[k] / n, k % 4 == 0 || k % 4 == 3 ? edge : within, deviation);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(share_and_kinds_are_as_asked),
        cmocka_unit_test(kinds_show_as_they_are),
        cmocka_unit_test(patches_come_from_the_nearest_good),
        cmocka_unit_test(clumps_reach_the_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
