/* The truth picture: sky, ground and entities tell apart, and an entity keeps its colour. */
#include "tests/check.h"

#include "sensor/publish/files/frame_files.h"

static void pixels_say_what_they_are(void **state)
{
    (void)state;
    SnapshotEntity entity[2] = {{.id = {1, 3001, 72}}, {.id = {1, 3001, 82}}};
    Snapshot       snapshot = {.count = 2, .entity = entity};
    const float    range_m[] = {INFINITY, 100, 1000, 10000, 100, 10000, 100, NAN, 0};
    const uint32_t index[] = {0, 0, 0, 0, 1, 1, 2, 0, 99};
    uint8_t        rgb[9][3];
    frame_files_preview(&rgb[0][0], range_m, index, NULL, 9, &snapshot);

    CHECK(rgb[0][2] > rgb[0][0] + 20);      /* sky is blue */
    assert_memory_equal(rgb[7], rgb[0], 3); /* and so is no range at all */
    for (int i = 1; i <= 3; i++) CHECK(rgb[i][0] == rgb[i][1] && rgb[i][1] == rgb[i][2]); /* ground is grey */
    CHECK(rgb[1][0] > rgb[2][0] && rgb[2][0] > rgb[3][0]);                                /* darker farther */
    CHECK(abs(rgb[1][0] - 2 * rgb[2][0] + rgb[3][0]) <= 2);                               /* by the logarithm */
    assert_memory_equal(rgb[4], rgb[5], 3);                                               /* an entity at any range */
    CHECK(memcmp(rgb[4], rgb[6], 3) != 0);                                                /* two entities */
    CHECK(rgb[4][0] != rgb[4][1] || rgb[4][1] != rgb[4][2]);
    CHECK(rgb[8][0] == 255 && rgb[8][1] == 255 && rgb[8][2] == 255); /* not in the snapshot */

    /* another snapshot, where 82 has another index: the same colour */
    Snapshot       later = {.count = 1, .entity = entity + 1};
    const uint32_t one = 1;
    const float    near_m = 100;
    uint8_t        again[3];
    frame_files_preview(again, &near_m, &one, NULL, 1, &later);
    assert_memory_equal(again, rgb[6], 3);
}

/* An octet of a share of full brightness, to the nearest. */
static int octet(double share) { return (int)floor(255 * share + 0.5); }

/* Ground: 85 % at the nearest and 15 % at the farthest, by the logarithm between; less where it is not level: 70 % of
 * it where it is upright, 40 % where it faces down. Sky: 5, 7 and 20 %. */
static void ground_by_range_and_slope(void **state)
{
    (void)state;
    const Snapshot none = {.count = 0};
    const float    range_m[] = {1, 10, 100, 1000, 10000, 1, 1, 1, 1, INFINITY};
    const float    up[] = {1, 1, 1, 1, 1, 0, -1, NAN, 0.749635f, 1};
    const uint32_t entity[10] = {0};
    uint8_t        rgb[10][3];
    frame_files_preview(&rgb[0][0], range_m, entity, up, 10, &none);
    /* 0.749635: 216.75 times 0.9248905, which is 200.47 */
    const int want[9] = {octet(0.85),  octet(0.675), octet(0.5 - 1e-9), octet(0.325), octet(0.15),
                         octet(0.595), octet(0.34),  octet(0.85),       200};
    for (int i = 0; i < 9; i++) {
        CHECK(rgb[i][1] == rgb[i][0] && rgb[i][2] == rgb[i][0]);
        if (i == 2) CHECK(rgb[i][0] == 127 || rgb[i][0] == 128); /* 127.5 */
        else assert_int_equal(rgb[i][0], want[i]);
    }
    CHECK(rgb[9][0] == octet(0.05) && rgb[9][1] == octet(0.07) && rgb[9][2] == octet(0.2));
    /* all at one range: not shaded by it; no ground at all: sky */
    const float one_m[2] = {50, 50}, no_m[2] = {-1, NAN};
    frame_files_preview(&rgb[0][0], one_m, entity, NULL, 2, &none);
    CHECK(rgb[0][0] == octet(0.85) && rgb[1][0] == octet(0.85));
    frame_files_preview(&rgb[0][0], no_m, entity, NULL, 2, &none);
    CHECK(rgb[0][0] == octet(0.05) && rgb[1][2] == octet(0.2));
}

/* The hue of an entity: n = entity + 31 application + 977 site turns of the golden section (multiplicative hashing by
 * 2654435769 = 2^32 (sqrt(5) - 1) / 2, Knuth), full colours by sextants from red over green and blue. Its brightness is
 * 45 % and 55 % of how level it lies. */
static void an_entity_has_the_hue_of_its_id(void **state)
{
    (void)state;
    const double golden = 0.5 * (sqrt(5) - 1);
    int          sextants = 0;
    for (int k = 0; k < 24; k++) {
        SnapshotEntity entity = {.id = {(uint16_t)(k % 3), (uint16_t)(k % 5), (uint16_t)(1 + k)}};
        const Snapshot snapshot = {.count = 1, .entity = &entity};
        const double   n = 1 + k + 31 * (k % 5) + 977 * (k % 3), hue = 6 * (n * golden - floor(n * golden));
        const int      sextant = (int)hue;
        const double   part = hue - sextant, x = sextant % 2 ? 1 - part : part;
        /* of red, green and blue one is full, one is x and one is 0 */
        static const int full[6] = {0, 1, 1, 2, 2, 0}, some[6] = {1, 0, 2, 1, 0, 2};
        const float      range_m[3] = {100, 100, 100}, up[3] = {1, 0, -1};
        const uint32_t   index[3] = {1, 1, 1};
        uint8_t          rgb[3][3];
        sextants |= 1 << sextant;
        frame_files_preview(&rgb[0][0], range_m, index, up, 3, &snapshot);
        for (int i = 0; i < 3; i++) {
            const double shade = 0.45 + 0.55 * (0.7 + 0.3 * (double)up[i]);
            for (int c = 0; c < 3; c++)
                CHECK_NEAR(rgb[i][c], 255 * shade * (c == full[sextant] ? 1 : c == some[sextant] ? x : 0), 0.51);
        }
    }
    CHECK(sextants == 0x3F);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pixels_say_what_they_are),
                                       cmocka_unit_test(ground_by_range_and_slope),
                                       cmocka_unit_test(an_entity_has_the_hue_of_its_id)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
