/* tests/sensor/test_cigi_scene.c: what a CIGI host says of entities and views: what is taken and what is refused, and
 * places by hand. Places all over the Earth are judged by pyproj and scipy in tests/system/test_cigi_replay.sh. */
#include "tests/check.h"
#include "sensor/node/cigi/cigi_scene.h"
#include "terrain/earth/geodesy.h"

static CigiScene scene;
static double    p[3], r[9];

static bool entity(uint16_t id, uint8_t state, double lat, double lon, double h, float yaw_deg)
{
    const CigiPacket packet = {.id = cigi_entity_control,
                               .of.entity_control = {.id = id, .state = state, .yaw_deg = yaw_deg, .p = {lat, lon, h}}};
    return cigi_scene_take(&scene, &packet);
}

static bool child(uint16_t id, uint16_t parent, double x, double y, double z)
{
    const CigiPacket packet = {
        .id = cigi_entity_control,
        .of.entity_control = {.id = id, .state = 1, .attached = true, .parent = parent, .p = {x, y, z}}};
    return cigi_scene_take(&scene, &packet);
}

static bool view(CigiViewControl v)
{
    return cigi_scene_take(&scene, &(CigiPacket){.id = cigi_view_control, .of.view_control = v});
}

static void forget(void) { memset(&scene, 0, sizeof scene); }

/* At latitude and longitude 0 north, east, down are z, y, -x of ECEF: all is known on paper. */
static void places_on_the_equator(void **state)
{
    (void)state;
    const double a_m = 6378137;
    forget();
    CHECK(!cigi_scene_entity(p, r, &scene, 0) && !cigi_scene_view(p, r, &scene, 0));
    CHECK(entity(0, 1, 0, 0, 100, 90));      /* looks east */
    CHECK(cigi_scene_view(p, r, &scene, 5)); /* a view of which nothing was said is on entity 0 */
    CHECK_NEAR(p[0], a_m + 100, 1e-8);
    CHECK_NEAR(p[1], 0, 1e-8);
    CHECK_NEAR(r[3], 1, 1e-15);  /* forward is east: y */
    CHECK_NEAR(r[7], -1, 1e-15); /* right is south */
    CHECK_NEAR(r[2], -1, 1e-15); /* down */
    CHECK(child(1, 0, 10, 2, -3));
    CHECK(cigi_scene_entity(p, r, &scene, 1));
    CHECK_NEAR(p[0], a_m + 103, 1e-8);
    CHECK_NEAR(p[1], 10, 1e-8);
    CHECK_NEAR(p[2], -2, 1e-8);
    CHECK(view((CigiViewControl){
        .view = 5, .entity = 1, .x_on = true, .pitch_on = true, .offset_m = {4, 7}, .pitch_deg = -90}));
    CHECK(cigi_scene_view(p, r, &scene, 5));
    CHECK_NEAR(p[1], 14, 1e-8); /* the offset to the right was not enabled */
    CHECK_NEAR(p[2], -2, 1e-8);
    CHECK_NEAR(r[0], -1, 1e-15); /* looks down */
    CHECK(cigi_scene_place(p, r, &scene, (const double[3]){0, 0, 5}, true, 1));
    CHECK_NEAR(p[0], a_m + 98, 1e-8);
    CHECK(cigi_scene_place(p, r, &scene, (const double[3]){0, 270, -100}, false, 0)); /* 90 degrees west */
    CHECK_NEAR(p[1], 100 - a_m, 1e-8);
}

static bool rate(CigiRateControl of)
{
    return cigi_scene_take(&scene, &(CigiPacket){.id = cigi_rate_control, .of.rate_control = of});
}

/* On the equator, looking east: forward, right, down are y, -z, -x; north, east, down are z, y, -x. */
static void rates_on_the_equator(void **state)
{
    (void)state;
    double v[3], w[3];
    forget();
    CHECK(rate((CigiRateControl){.v_mps = {1}}) && entity(0, 1, 0, 0, 100, 90)); /* of one that is not there: nothing */
    CHECK(!cigi_scene_rates(v, w, &scene, 0) && !cigi_scene_view_rates(v, w, &scene, 0));
    CHECK(rate((CigiRateControl){.local = true, .v_mps = {10, 2, -3}, .yaw_deg_s = 90}));
    CHECK(rate((CigiRateControl){.of_part = true, .part = 3, .v_mps = {99}})); /* changes nothing */
    CHECK(cigi_scene_rates(v, w, &scene, 0));
    CHECK_NEAR(v[0], 3, 1e-12);
    CHECK_NEAR(v[1], 10, 1e-12);
    CHECK_NEAR(v[2], -2, 1e-12);
    CHECK_NEAR(w[0], -pi_rad / 2, 1e-12);
    CHECK_NEAR(w[1], 0, 1e-12);
    CHECK_NEAR(w[2], 0, 1e-12);
    CHECK(view((CigiViewControl){.view = 2, .x_on = true, .yaw_on = true, .offset_m = {4}, .yaw_deg = 20}));
    CHECK(cigi_scene_view_rates(v, w, &scene, 2)); /* its arm of 4 m swings */
    CHECK_NEAR(v[0], 3, 1e-9);
    CHECK_NEAR(v[1], 10, 1e-9);
    CHECK_NEAR(v[2], -2 - 2 * pi_rad, 1e-8);
    CHECK(rate((CigiRateControl){.v_mps = {1, 2, 3}, .roll_deg_s = 180}));
    CHECK(cigi_scene_rates(v, w, &scene, 0));
    CHECK_NEAR(v[0], -3, 1e-12);
    CHECK_NEAR(v[1], 2, 1e-12);
    CHECK_NEAR(v[2], 1, 1e-12);
    CHECK_NEAR(w[2], pi_rad, 1e-12);
    CHECK(entity(0, 1, 0, 0, 100, 0) && cigi_scene_rates(v, w, &scene, 0)); /* they stay with the entity */
    CHECK(child(1, 0, 0, 0, 0) && rate((CigiRateControl){.entity = 1}) && !cigi_scene_rates(v, w, &scene, 1));
    CHECK(entity(0, cigi_entity_destroyed, 0, 0, 0, 0) && entity(0, 1, 0, 0, 0, 0)); /* and go with it */
    CHECK(!cigi_scene_rates(v, w, &scene, 0));
    CHECK(!rate((CigiRateControl){.v_mps = {0, 2e5f}}) && !rate((CigiRateControl){.pitch_deg_s = -2e5f}));
}

static void what_carries_a_view(void **state)
{
    (void)state;
    forget();
    CHECK(entity(3, 1, 0, 0, 0, 0) && child(4, 3, 0, 0, 0) && child(5, 4, 0, 0, 0) && child(6, 4, 0, 0, 0));
    CHECK(view((CigiViewControl){.view = 1, .entity = 5}));
    CHECK(cigi_scene_carries(&scene, 1, 5) && cigi_scene_carries(&scene, 1, 4) && cigi_scene_carries(&scene, 1, 3));
    CHECK(!cigi_scene_carries(&scene, 1, 6) && !cigi_scene_carries(&scene, 2, 5));
    CHECK(child(3, 5, 0, 0, 0) && !cigi_scene_carries(&scene, 1, 6)); /* parents in a circle */
}

static void what_is_not_enabled_stays(void **state)
{
    (void)state;
    forget();
    CHECK(entity(0, 1, 0, 0, 0, 0));
    CHECK(view((CigiViewControl){.view = 1, .y_on = true, .offset_m = {1, 2, 3}, .yaw_deg = 45}));
    CHECK(view((CigiViewControl){.view = 1, .z_on = true, .yaw_on = true, .offset_m = {9, 9, 3}, .yaw_deg = 30}));
    CHECK(scene.view[0].offset_m[0] == 0 && scene.view[0].offset_m[1] == 2 && scene.view[0].offset_m[2] == 3);
    CHECK(scene.view[0].yaw_deg == 30 && scene.view[0].pitch_deg == 0);
}

/* View Control of a group goes to the views that View Definition put into it. */
static void groups_of_views(void **state)
{
    (void)state;
    forget();
    for (uint16_t id = 1; id <= 3; id++)
        CHECK(cigi_scene_take(&scene, &(CigiPacket){.id = cigi_view_definition,
                                                    .of.view_definition = {.view = id, .group = id == 2 ? 4 : 7}}));
    CHECK(view((CigiViewControl){.view = 2, .group = 7, .x_on = true, .offset_m = {5}, .entity = 6}));
    for (int i = 0; i < 3; i++) {
        CHECK(scene.view[i].offset_m[0] == (scene.view[i].view == 2 ? 0 : 5));
        CHECK(scene.view[i].entity == (scene.view[i].view == 2 ? 0 : 6));
    }
}

static void what_is_out_of_range_is_refused(void **state)
{
    (void)state;
    forget();
    CHECK(entity(3, 1, 10, 20, 30, 0));
    CHECK(!entity(3, 1, 90.001, 20, 30, 0) && !entity(3, 1, 10, 361, 30, 0) && !entity(3, 1, 10, 20, 2e7, 0));
    CHECK(!entity(3, 1, 10, 20, 30, 361) && !child(4, 3, 2e6, 0, 0));
    CHECK(!view((CigiViewControl){.view = 1, .offset_m = {0, -2e6f}}) && !view((CigiViewControl){.roll_deg = -400}));
    CHECK(scene.refused == 7 && scene.entity_count == 1 && scene.view_count == 0 && scene.entity[0].p[0] == 10);
    CHECK(!cigi_scene_place(p, r, &scene, (const double[3]){91, 0, 0}, false, 0));
    CHECK(!cigi_scene_place(p, r, &scene, (const double[3]){0, 0, 0}, true, 77));
}

static void parents_in_a_circle_have_no_place(void **state)
{
    (void)state;
    forget();
    CHECK(child(1, 2, 0, 0, 0) && child(2, 3, 0, 0, 0) && child(3, 1, 0, 0, 0));
    CHECK(!cigi_scene_entity(p, r, &scene, 1));
    CHECK(child(4, 99, 0, 0, 0) && !cigi_scene_entity(p, r, &scene, 4)); /* a parent that was never reported */
    CHECK(entity(3, 1, 0, 0, 0, 0) && cigi_scene_entity(p, r, &scene, 1));
}

static void entities_and_views_are_bounded_and_go(void **state)
{
    (void)state;
    forget();
    for (int i = 0; i < cigi_entities_most + 5; i++)
        CHECK(entity((uint16_t)(i + 1), 1, 1, 2, 3, 0) == (i < cigi_entities_most));
    for (int i = 0; i < cigi_views_most + 5; i++)
        CHECK(view((CigiViewControl){.view = (uint16_t)i}) == (i < cigi_views_most));
    CHECK(scene.refused == 10);
    CHECK(entity(7, cigi_entity_destroyed, 1, 2, 3, 0) && !cigi_scene_entity(p, r, &scene, 7));
    CHECK(entity(7, cigi_entity_destroyed, 1, 2, 3, 0));        /* of one that is not there: nothing */
    CHECK(cigi_scene_entity(p, r, &scene, cigi_entities_most)); /* the last has moved into its place */
    CHECK(entity(9999, 1, 1, 2, 3, 0) && scene.entity_count == cigi_entities_most);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_on_the_equator),
        cmocka_unit_test(rates_on_the_equator),
        cmocka_unit_test(what_carries_a_view),
        cmocka_unit_test(what_is_not_enabled_stays),
        cmocka_unit_test(groups_of_views),
        cmocka_unit_test(what_is_out_of_range_is_refused),
        cmocka_unit_test(parents_in_a_circle_have_no_place),
        cmocka_unit_test(entities_and_views_are_bounded_and_go),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
