/* The price of tables over a thousand frames. labels: deep */
#include "tests/render/plant_price_stage.h"

static void thousand_frames(void **state)
{
    (void)state;
    frames_say_what_changes(1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(thousand_frames)};
    return cmocka_run_group_tests(tests, open_wood, close_wood);
}
