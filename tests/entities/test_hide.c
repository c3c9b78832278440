/* Entities hide where a scenario says: surroundings counted anew from all plants, nothing to be cleared, heights of the
 * ground, the same places each time; estimates where the answer is known; nets over what they cover; engines that stop.
 */
#include "tests/check.h"

#include "entities/exercise/cast_private.h"
#include "entities/exercise/hide.h"

#include "dis/pdu/pdu.h"

static Scenario scenario;

#define GROUND "place: {lat_deg: 50.1, lon_deg: 8.6, height_m: 120}\nground: {planted: true, seed: 1}\nvehicles:\n"

static Status read_text(const char *text)
{
    char path[text_file_size];
    text_file(path, text);
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = scenario_read(&scenario, path);
    remove(path);
    return status;
}

static Cast *cast_of(const char *text)
{
    Cast *cast = NULL;
    assert_int_equal(read_text(text), STATUS_OK);
    if (cast_create(&cast, &scenario) != STATUS_OK) fail_msg("%s", check_said);
    return cast;
}

static void release(Cast *cast)
{
    cast_destroy(cast);
    scenario_destroy(&scenario);
}

static void land_of(double out[3], const Cast *cast, const CastHidden *own)
{
    CastPose pose;
    double   p_ecef[3];
    cast_pose(&pose, cast, own->entity, 0);
    ecef_from_enu(p_ecef, &cast->ground.frame, pose.p_enu);
    enu_from_ecef(out, &cast->ground.stored.frame, p_ecef);
}

/* Plants about a place, by a walk over all of them. */
typedef struct Count {
    int    trees, low, in_the_way;
    double nearest_m;
} Count;

static Count count_about(const HideGround *ground, const double p[3], const WoodsPath *footprint)
{
    const Woods *w = &ground->woods;
    Count        c = {.nearest_m = INFINITY};
    for (int n = 0; n < w->count; n++) {
        const Plant *plant = &w->plant[n];
        const double x = (double)plant->p_m[0] + w->origin_enu[0], y = (double)plant->p_m[1] + w->origin_enu[1];
        const double d_m = hypot(x - p[0], y - p[1]);
        const bool   tree = plant_is_tree((PlantKind)plant->kind);
        c.trees += tree && plant_height_m(plant) >= 5 && d_m < 20;
        c.low += !tree && d_m < 9;
        c.in_the_way += woods_path_away_m(footprint, x, y) < footprint->half_m + 0.5;
        c.nearest_m = fmin(c.nearest_m, d_m);
    }
    return c;
}

#define MANY                                                                                                                \
    GROUND                                                                                                                  \
    "  - {name: Edge, type: tank, hide: tree-line, hide_m: 400, count: 3, route_m: [[-400, -300]]}\n"                       \
    "  - {name: Row, type: truck, hide: hedge, hide_m: 400, count: 3, route_m: [[400, -300]]}\n"                            \
    "  - {name: Wood, type: tank, hide: wood, hide_m: 700, count: 2, route_m: [[300, 300]]}\n"                              \
    "  - {name: Open, type: tank, hide: open, hide_m: 400, count: 2, route_m: [[-300, 300]], heading_deg: 30, net: true}\n" \
    "  - {name: Dip, type: jeep, hide: hollow, hide_m: 400, occlusion: 0, route_m: [[0, 0]]}\n"

static void places_are_of_their_kind(void **state)
{
    (void)state;
    static const double half_m = 1800;
    Cast               *cast = cast_of(MANY);
    HideGround          ground;
    assert_int_equal(cast->hidden_count, 11);
    assert_int_equal(
        hide_ground_open(&ground, &(HideWorld){&cast->ground.stored, 1, NULL, NULL}, (const double[2]){0, 0}, half_m),
        STATUS_OK);
    int headings = 0;
    for (int n = 0; n < cast->hidden_count; n++) {
        const CastHidden    *own = &cast->hidden[n];
        const ScenarioGroup *g = &scenario.group[cast->entity[own->entity].group];
        double               p[3];
        land_of(p, cast, own);
        const double heading = own->heading_rad;
        /* box of a T-72 with its gun, of a lorry, of a jeep: no longer than this */
        const WoodsPath footprint = woods_footprint(p, (const double[2]){sin(heading), cos(heading)}, 2.5, -2.5, 2.2);
        const Count     c = count_about(&ground, p, &footprint);
        assert_int_equal(c.in_the_way, 0);
        CHECK(hypot(own->x_m - g->route_m.number[0], own->y_m - g->route_m.number[1]) <= g->hide_m + 40 * 3 + 1);
        CHECK_NEAR(p[2], elevation_height(&cast->ground.stored.elevation, p[0], p[1], NULL), 0.3);
        if (g->hide == SCENARIO_HIDE_TREE_LINE) CHECK(c.trees >= 5);
        if (g->hide == SCENARIO_HIDE_WOOD) CHECK(c.trees >= 12);
        if (g->hide == SCENARIO_HIDE_HEDGE) CHECK(c.low >= 4 && c.trees <= 4);
        if (g->hide == SCENARIO_HIDE_OPEN) CHECK(c.nearest_m > 12 && own->planned == 0 && own->judged < 0.05);
        if (g->hide == SCENARIO_HIDE_OPEN) CHECK_NEAR(heading, 30 * rad_per_deg, 1e-12);
        else headings += fabs(sin(heading)) > 0.1 && fabs(cos(heading)) > 0.1;
        if (g->hide == SCENARIO_HIDE_HOLLOW) {
            double sum = 0;
            for (int k = 0; k < 8; k++)
                sum += elevation_height(&cast->ground.stored.elevation, p[0] + 30 * cos(k * pi_rad / 4),
                                        p[1] + 30 * sin(k * pi_rad / 4), NULL);
            CHECK(sum / 8 - p[2] > 0.3);
        } else if (g->hide != SCENARIO_HIDE_OPEN) {
            CHECK(own->planned >= 0.1 && own->planned <= 0.9);
        }
        for (int k = 0; k < n; k++)
            CHECK(hypot(own->x_m - cast->hidden[k].x_m, own->y_m - cast->hidden[k].y_m) > hide_apart_m - 0.1);
    }
    CHECK(headings >= 5); /* drawn, not all along one axis */
    hide_ground_close(&ground);

    Cast *again = NULL;
    assert_int_equal(cast_create(&again, &scenario), STATUS_OK);
    assert_memory_equal(again->hidden, cast->hidden, (size_t)cast->hidden_count * sizeof *cast->hidden);
    cast_destroy(again);
    scenario.seed = 2; /* other places on the same ground */
    assert_int_equal(cast_create(&again, &scenario), STATUS_OK);
    CHECK(again->hidden[0].x_m != cast->hidden[0].x_m);
    cast_destroy(again);
    release(cast);
}

static void nets_are_over_what_they_cover(void **state)
{
    (void)state;
    Cast *cast = cast_of(
        GROUND
        "  - {name: A, type: tank, hide: open, count: 2, route_m: [[0, 0]], net: true}\n"
        "  - {name: B, type: 1.1.222.7.1.0.0, count: 3, columns: 2, spread_m: 5, heading_deg: 70, route_m: [[300, 50]], net: true}\n");
    assert_int_equal(cast->entity_count, 10);
    for (int n = 0; n < 5; n++) {
        CastPose a, b;
        cast_pose(&a, cast, n, 0);
        cast_pose(&b, cast, 5 + n, 0);
        assert_memory_equal(&a, &b, sizeof a);
        CHECK(cast->entity[5 + n].type.kind == 5 && cast->entity[5 + n].type.category == 90);
        assert_int_equal(cast->entity[5 + n].type.subcategory, 2); /* of a tank and of a lorry */
        CHECK(!(cast_appearance(cast, 5 + n, 0) & 1u << dis_appearance_power_plant_bit));
    }
    release(cast);
}

static void engines_stop(void **state)
{
    (void)state;
    const uint32_t engine = 1u << dis_appearance_power_plant_bit;
    Cast          *cast = cast_of("vehicles:\n  - {name: A, type: tank, engine_off_s: 12, route_m: [[0, 0]]}\n");
    CHECK((cast_appearance(cast, 0, 11.9) & engine) && !(cast_appearance(cast, 0, 12) & engine));
    CHECK_NEAR(cast_next_change(cast, 0, 3), 12, 0); /* it is reported then */
    release(cast);
}

/* Behind a wall of 12 m by 2 m, seen along the level, nothing of what is lower shows; from above the whole of it. */
static void a_wall_hides_what_is_behind_it(void **state)
{
    (void)state;
    Cast      *cast = cast_of(GROUND "  - {name: A, type: tank, route_m: [[0, 0]]}\n");
    Catalog   *catalog = NULL;
    int        wall, low;
    char       path[512];
    HideGround ground;
    HideBox    box = {.nose = {1, 0}};
    HideShape  shape;
    HidePoints points;
    CHECK(etc_path(path, sizeof path, "catalog.csv"));
    assert_int_equal(catalog_open(&catalog, path, 0.05), STATUS_OK);
    wall = catalog_find(catalog, (DisEntityType){5, 1, 0, 91, 0, 0, 0}, NULL, NULL);
    low = catalog_find(catalog, (DisEntityType){6, 1, 225, 1, 0, 0, 0}, NULL, NULL); /* a pallet, 1.2 m high */
    assert_int_equal(
        hide_ground_open(&ground, &(HideWorld){&cast->ground.stored, 1, NULL, NULL}, (const double[2]){0, 0}, 100),
        STATUS_OK);
    for (int n = 0; n < ground.woods.count; n++) ground.woods.plant[n].p_m[2] = -1000; /* no plant is in the way */
    assert_int_equal(hide_shape_open(&box.shape, catalog_model(catalog, wall)), STATUS_OK);
    assert_int_equal(hide_shape_open(&shape, catalog_model(catalog, low)), STATUS_OK);
    const double high_m = 600; /* over all ground */
    box.p_enu[0] = 10, box.p_enu[1] = 20, box.p_enu[2] = high_m;
    const HidePose  pose = {{10, 22, high_m}, {1, 0}};
    const HideSight level = {{0, -1, 0}, 100}, above = {{0, 0, 1}, 100}, away = {{0, 1, 0}, 100};
    static const struct {
        double d_body[3];
    } side = {{0, 1, 0}}; /* south is right of a nose to the east */
    assert_int_equal(hide_points(&points, &shape, side.d_body), STATUS_OK);
    CHECK(points.count > 40);
    CHECK_NEAR(hide_occlusion(NULL, &ground, &pose, &points, &level, &box), 1, 0);
    CHECK_NEAR(hide_occlusion(NULL, &ground, &pose, &points, &level, NULL), 0, 0);
    CHECK_NEAR(hide_occlusion(NULL, &ground, &pose, &points, &above, &box), 0, 0);
    CHECK_NEAR(hide_occlusion(NULL, &ground, &pose, &points, &away, &box), 0, 0);
    /* half of it beyond the wall's end, to a cell of the points' grid */
    const HidePose half = {{16, 22, high_m}, {1, 0}};
    CHECK_NEAR(hide_occlusion(NULL, &ground, &half, &points, &level, &box), 0.5, 0.12);
    hide_shape_close(&shape), hide_shape_close(&box.shape);
    hide_ground_close(&ground);
    catalog_close(catalog);
    release(cast);
}

static void what_is_wrong_is_said(void **state)
{
    (void)state;
    static const struct {
        const char *text, *word;
        bool        cast; /* found by the cast alone */
    } bad[] = {
        {"vehicles:\n  - {name: A, hide: wood, route_m: [[0, 0]]}\n", "hide: needs ground.planted", false},
        {GROUND "  - {name: A, hide: wood, route_m: [[0, 0], [5, 5]]}\n", "one place in route_m", false},
        {GROUND "  - {name: A, hide: woods, route_m: [[0, 0]]}\n", "hide: 'woods' is not one of none|open", false},
        {GROUND "  - {name: A, hide: beside, route_m: [[0, 0]]}\n", "need each other", false},
        {GROUND "  - {name: A, hide: wood, beside: B 1, route_m: [[0, 0]]}\n", "need each other", false},
        {GROUND "  - {name: A, beside: B 1, route_m: [[0, 0]]}\n", "beside: needs hide: beside", false},
        {GROUND "  - {name: A, hide: beside, beside: B 1, route_m: [[0, 0]]}\n", "there is no 'B 1'", false},
        {GROUND "  - {name: A, id: 1, hide: beside, beside: A 1, route_m: [[0, 0]]}\n", "moves or hides itself", false},
        {GROUND "  - {name: A, hide: wood, occlusion: 0.96, route_m: [[0, 0]]}\n", "occlusion: '0.96'", false},
        {GROUND "  - {name: A, hide: wood, occlusion: -0.1, route_m: [[0, 0]]}\n", "occlusion: '-0.1'", false},
        {GROUND "  - {name: A, hide: wood, hide_m: 1e9, route_m: [[0, 0]]}\n", "hide_m: '1e9'", false},
        {"seen: {range_m: 0}\n", "seen.range_m: '0'", false},
        {"seen: {bearing_deg: .nan}\n", "seen.bearing_deg: '.nan'", false},
        {"ground: {seed: -1}\n", "ground.seed: '-1'", false},
        {"ground: {relief_m: 201}\n", "ground.relief_m: '201'", false},
        {"ground: {spacing_m: 0.5}\n", "ground.spacing_m: '0.5'", false},
        {"ground: {planted: true, store: x.pvterrain}\n", "exclude each other", true},
        {GROUND "  - {name: A, type: helicopter, hide: wood, route_m: [[0, 0]]}\n", "what hides is a vehicle on land",
         true},
        {GROUND "  - {name: A, type: tank, hide: wood, hide_m: 5, count: 30, route_m: [[0, 0]]}\n", "there is no room",
         true},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        Cast        *cast = NULL;
        const Status status = read_text(bad[i].text);
        assert_int_equal(status, bad[i].cast ? STATUS_OK : STATUS_BAD_VALUE);
        if (bad[i].cast) assert_int_equal(cast_create(&cast, &scenario), STATUS_BAD_VALUE);
        if (!strstr(check_said, bad[i].word)) fail_msg("'%s' is not in: %s", bad[i].word, check_said);
        CHECK(cast == NULL);
        scenario_destroy(&scenario);
    }
}

static void groups_are_set_by_name(void **state)
{
    (void)state;
    SettingType type;
    assert_int_equal(read_text(GROUND "  - {name: A.b, type: tank, route_m: [[0, 0]], net: true}\n"
                                      "  - {name: C, type: tank, route_m: [[9, 9]]}\n"),
                     STATUS_OK);
    assert_int_equal(scenario.group_count, 3);
    assert_int_equal(scenario_set_any(&scenario, "vehicles.A.b.count", "4", "test"), STATUS_OK);
    assert_int_equal(scenario_set_any(&scenario, "vehicles.A.b.route_m", "5,6", "test"), STATUS_OK);
    assert_int_equal(scenario_set_any(&scenario, "vehicles.A.b.type", "truck", "test"), STATUS_OK);
    assert_int_equal(scenario_set_any(&scenario, "seed", "9", "test"), STATUS_OK);
    CHECK(scenario.group[0].count == 4 && scenario.group[2].count == 4); /* its nets too */
    CHECK(scenario.group[0].route_m.number[1] == 6 && scenario.group[2].route_m.number[1] == 6);
    CHECK(!strcmp(scenario.group[0].type, "truck") && !strcmp(scenario.group[2].type, "net"));
    CHECK(!strcmp(scenario.group[1].type, "tank") && scenario.group[1].count == 1 && scenario.seed == 9);
    static const char *const bad[][3] = {{"vehicles.D.count", "4", "there are no vehicles with name: 'D'"},
                                         {"vehicles.C.count", "0", "count: '0'"},
                                         {"vehicles.C.cuont", "4", "cuont"},
                                         {"vehicles.C.net", "true", "is of the file alone"},
                                         {"vehicles..count", "4", "vehicles..count"},
                                         {"vehicles.C", "4", "vehicles.C"},
                                         {"vehicles.Net.count", "4", "there are no vehicles"},
                                         {"sede", "4", "sede"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        check_said[0] = 0;
        assert_int_equal(scenario_set_any(&scenario, bad[i][0], bad[i][1], "test"), STATUS_BAD_VALUE);
        if (!strstr(check_said, bad[i][2])) fail_msg("'%s' is not in: %s", bad[i][2], check_said);
    }
    CHECK(scenario_key_type(&type, "vehicles.X.count") && type == SETTING_INT);
    CHECK(scenario_key_type(&type, "place.lat_deg") && type == SETTING_DOUBLE);
    CHECK(!scenario_key_type(&type, "vehicles.X.y") && !scenario_key_type(&type, "vehicles") &&
          !scenario_key_type(&type, ""));
    scenario_destroy(&scenario);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_of_their_kind),
        cmocka_unit_test(nets_are_over_what_they_cover),
        cmocka_unit_test(engines_stop),
        cmocka_unit_test(a_wall_hides_what_is_behind_it),
        cmocka_unit_test(what_is_wrong_is_said),
        cmocka_unit_test(groups_are_set_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
