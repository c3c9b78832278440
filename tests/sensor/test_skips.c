/* Every skip by itself, and all of them, over four random scenes in which each is taken; test_skips_deep.c has more.
 * Scene 6 has all bands. labels: slow */
#include "tests/sensor/skip_scenes.h"

static void each_skip_keeps_the_bits(void **state)
{
    (void)state;
    static const int scenes[] = {1, 5, 6, 8};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) keeps_the_bits(scenes[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_skip_keeps_the_bits),
                                       cmocka_unit_test(each_skip_was_taken)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
