/* Ray tubes without and with edge diffraction against the Austin RCS suite, in all windows of angle: the figures of
 * etc/reference/radar.md. labels: deep */
#include "tests/render/austin.h"

static void thin_plate(void **state)
{
    (void)state;
    judge_plate(1);
}

static void almond(void **state)
{
    (void)state;
    RadarStage s = {0};
    Window     window[3] = {
            {.low_deg = 60, .high_deg = 120}, {.low_deg = 0, .high_deg = 60}, {.low_deg = 120, .high_deg = 180}};
    Window rays[3];
    memcpy(rays, window, sizeof rays);
    build_almond(&s.model);
    stage_target(&s, 7e9);
    run(&s, "IIIA_almond_L9.936in_fx3_ref.csv", 90, rays, 3, 2, false);
    run(&s, "IIIA_almond_L9.936in_fx3_ref.csv", 90, window, 3, 2, true);
    CHECK(window[0].off_db[0] <= 2.5 && window[0].off_db[1] <= 2.5);
    stage_close(&s);
}

static void prime(void **state)
{
    (void)state;
    judge_prime(2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(thin_plate), cmocka_unit_test(almond), cmocka_unit_test(prime)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
