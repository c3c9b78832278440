/* Damage of buildings: distances against the law worked by hand, walls and heights, what an entity stands for, the
 * worst so far at each time, and a model of four states of which one is seen. */
#include "tests/check.h"

#include "sensor/frame/frame_scenery.h"
#include "sensor/node/choices/choices.h"

static const double square_m[4][2] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};

static Building house(uint64_t id)
{
    return (Building){.id = id,
                      .base_m = 100,
                      .eaves_m = 5,
                      .ridge_m = 8,
                      .use = BUILDING_HOUSE,
                      .roof = ROOF_GABLED,
                      .levels = 2,
                      .heated = true};
}

/* 1000 kg: 10 k / (1 + 10.080625)^(1/6) = 6.697 k: 37.50, 64.29, 187.5 m; 40 kg: k 3.41995 / (6301.6)^(1/6) = 0.79578
 * k. */
static void distances_are_the_laws(void **state)
{
    (void)state;
    CHECK(fabs(choice_harm_radius(1000, 3) - 37.50) < 0.01 && fabs(choice_harm_radius(1000, 2) - 64.29) < 0.02);
    CHECK(fabs(choice_harm_radius(1000, 1) - 187.51) < 0.05 && fabs(choice_harm_radius(40, 3) - 4.456) < 0.002);
    CHECK(choice_harm_radius(0, 3) == 0 && choice_harm_radius(10, 0) == 0 && choice_harm_radius(10, 4) == 0);
    Culture        c = {0};
    const Building b = house(7);
    assert_int_equal(culture_add_building(&c, &b, square_m, 4), STATUS_OK);
    for (int damage = 1; damage < 4; damage++) {
        const double r = choice_harm_radius(100, damage);
        CHECK(choice_burst_damage(&c, 0, (const double[3]){10 + 0.999 * r, 5, 101}, 100) == damage);
        CHECK(choice_burst_damage(&c, 0, (const double[3]){10 + 1.001 * r, 5, 101}, 100) == damage - 1);
        /* over the ridge, which is at 108 m */
        CHECK(choice_burst_damage(&c, 0, (const double[3]){5, 5, 108 + 0.999 * r}, 100) == damage);
        CHECK(choice_burst_damage(&c, 0, (const double[3]){5, 5, 108 + 1.001 * r}, 100) == damage - 1);
    }
    CHECK(choice_burst_damage(&c, 0, (const double[3]){5, 5, 103}, 0.05) == 3); /* inside */
    culture_free(&c);
}

static void the_worst_so_far_is_seen(void **state)
{
    (void)state;
    const BuildingHarm harm[] = {{8, 10, 1}, {8, 20, 3}, {99, 5, 3}, {8, 30, 2}};
    const Building     b[2] = {house(7), house(8)};
    const double       other_m[4][2] = {{40, 0}, {50, 0}, {50, 10}, {40, 10}};
    Culture            c = {0};
    Scenery            s = {0}, whole = {0};
    assert_int_equal(culture_add_building(&c, &b[0], square_m, 4), STATUS_OK);
    assert_int_equal(culture_add_building(&c, &b[1], other_m, 4), STATUS_OK);
    assert_int_equal(culture_index(&c), STATUS_OK);
    assert_int_equal(scenery_add_harmed_buildings(&s, &c, harm, 4, NULL, NULL), STATUS_OK);
    assert_int_equal(scenery_add_buildings(&whole, &c, NULL, NULL), STATUS_OK);
    CHECK(s.objects == 2 && s.harms == 3 && s.object[1].id == 8 && whole.objects == 1 && whole.harms == 0);
    CHECK(scenery_damage(&s, 1, 9.9) == 0 && scenery_damage(&s, 1, 10) == 1 && scenery_damage(&s, 1, 20) == 3);
    CHECK(scenery_damage(&s, 1, 40) == 3 && scenery_damage(&s, 0, 40) == 0);
    /* each part of the house is seen in one state; in state 0 it has the triangles that it has among others */
    int of_state[4] = {0}, of_whole = 0;
    for (int p = 0; p < s.model[1].part_count; p++)
        for (int k = 0; k < 4; k++) {
            const ModelPart *part = &s.model[1].part[p];
            CHECK(__builtin_popcount(part->damage_hidden) == 3);
            if (!(part->damage_hidden >> k & 1)) of_state[k] += part->triangle_count;
        }
    for (int p = 0; p < whole.model[0].part_count; p++)
        if (whole.part_of[whole.part_first[0] + p] == 8) of_whole += whole.model[0].part[p].triangle_count;
    print_message("triangles by damage: %d %d %d %d\n", of_state[0], of_state[1], of_state[2], of_state[3]);
    CHECK(of_state[0] == of_whole && of_state[0] > 0 && of_state[3] > 0 && of_state[1] > of_state[0]);
    scenery_free(&s), scenery_free(&whole);
    culture_free(&c);
}

static void a_building_stands_for_an_entity(void **state)
{
    (void)state;
    Culture             c = {0};
    const Building      b = house(7);
    const DisEntityType feature = {.kind = dis_kind_cultural_feature}, tank = {.kind = dis_kind_platform, .domain = 1};
    assert_int_equal(culture_add_building(&c, &b, square_m, 4), STATUS_OK);
    CHECK(choice_building_of(&c, NULL, feature, -1, (const double[3]){5, 5, 100}) == -1); /* not indexed */
    assert_int_equal(culture_index(&c), STATUS_OK);
    CHECK(choice_building_of(&c, NULL, feature, -1, (const double[3]){5, 5, 100}) == 0);
    CHECK(choice_building_of(&c, NULL, feature, -1, (const double[3]){11, 5, 100}) == -1);
    CHECK(choice_building_of(&c, NULL, tank, -1, (const double[3]){5, 5, 100}) == -1);
    culture_free(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(distances_are_the_laws),
                                       cmocka_unit_test(the_worst_so_far_is_seen),
                                       cmocka_unit_test(a_building_stands_for_an_entity)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
