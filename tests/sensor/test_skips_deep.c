/* test_skips.c over twenty scenes. labels: deep */
#include "tests/sensor/skip_scenes.h"

static void each_skip_keeps_the_bits(void **state)
{
    (void)state;
    for (int n = 0; n < 20; n++) keeps_the_bits(n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_skip_keeps_the_bits),
                                       cmocka_unit_test(each_skip_was_taken)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
