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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pixels_say_what_they_are)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
