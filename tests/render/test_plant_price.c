/* The price of tables in a frame; a thousand frames are in test_plant_price_deep.c. labels: slow */
#include "tests/render/plant_price_stage.h"

static void thirty_frames(void **state)
{
    (void)state;
    frames_say_what_changes(30);
}

static void threads_change_no_bit(void **state)
{
    Pool *alone = NULL;
    (void)state;
    hand.world.forest = by_table;
    const PlantPrice two = price_of(7, hand.pool);
    assert_int_equal(pool_create(&alone, 1), STATUS_OK);
    const PlantPrice one = price_of(7, alone), other = price_of(8, alone);
    pool_destroy(alone);
    assert_memory_equal(&one, &two, sizeof one);
    CHECK(memcmp(&other, &one, sizeof one) != 0);
}

static void full_detail_has_no_price(void **state)
{
    (void)state;
    hand.world.forest = in_full;
    const PlantPrice price = price_of(7, hand.pool);
    CHECK(price.rays == 0 && price.met == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(thirty_frames), cmocka_unit_test(threads_change_no_bit),
                                       cmocka_unit_test(full_detail_has_no_price)};
    return cmocka_run_group_tests(tests, open_wood, close_wood);
}
