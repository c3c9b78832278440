/* Ray tubes without and with edge diffraction against the Austin RCS suite: thin plate, NASA almond, PRIME aircraft.
 * The bounds are what physical optics, edges, pairs of them and mirrors are known to reach on such small targets. More
 * looks: test_radar_austin_deep.c. labels: slow */
#include "tests/render/austin.h"

static void thin_plate(void **state)
{
    (void)state;
    judge_plate(2);
}

/* Its window in which physical optics holds. */
static void almond(void **state)
{
    (void)state;
    RadarStage s = {0};
    Window     window = {.low_deg = 60, .high_deg = 120};
    build_almond(&s.model);
    stage_target(&s, 7e9);
    run(&s, "IIIA_almond_L9.936in_fx3_ref.csv", 90, &window, 1, 4, true);
    CHECK(window.count >= 20 && window.off_db[0] <= 2.5 && window.off_db[1] <= 2.5);
    stage_close(&s);
}

static void prime(void **state)
{
    (void)state;
    judge_prime(5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(thin_plate), cmocka_unit_test(almond), cmocka_unit_test(prime)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
