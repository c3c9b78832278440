/* tests/sensor/test_scenery_choice.c: terrain.buildings, terrain.trees and terrain.clutter as a world of them: off,
 * invented, of a file, of a file that cannot be used; lines of choices; the same plan again. */
#include "tests/check.h"

#include "sensor/node/choices/choices.h"

static WoodsSquare square = {.centre_m = {20, -10}, .half_width_m = 300};
static Landscape   land;

static int open_land(void **state)
{
    const Geodetic  origin = {47.3 * rad_per_deg, 9.1 * rad_per_deg, 430};
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    (void)state;
    config.seed = 6, config.half_width_m = 2000;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    return landscape_create(&land, &config, &frame, NULL, 0, NULL, 0) == STATUS_OK ? 0 : -1;
}

static int close_land(void **state)
{
    (void)state;
    landscape_destroy(&land);
    return 0;
}

static Config config_of(const char *buildings, double clutter)
{
    Config config = config_default();
    config.seed = 6;
    assert_int_equal(config_set(&config, "terrain.buildings", buildings, "test"), STATUS_OK);
    config.terrain.clutter = clutter;
    return config;
}

static Status choose(FrameScenery *out, Choices *said, const Config *config)
{
    const ChoiceBasis basis = {.config = config};
    *said = (Choices){0};
    return choice_scenery(out, said, &basis, &square, &land);
}

static bool says(const Choices *choices, const char *text)
{
    for (int i = 0; i < choices->count; i++)
        if (strstr(choices->line[i], text)) return true;
    return false;
}

static void off_is_nothing_and_silent(void **state)
{
    (void)state;
    FrameScenery s;
    Choices      said;
    const Config config = config_of("off", 0);
    assert_int_equal(choose(&s, &said, &config), STATUS_OK);
    CHECK(s.plan.from == CULTURE_FROM_NOTHING && s.scenery.objects == 0 && s.scenery.models == 0 && !s.culture.index);
    CHECK(said.count == 0);
    frame_scenery_free(&s);
}

static void clutter_alone_is_counted_by_class(void **state)
{
    (void)state;
    FrameScenery  s;
    SceneryCounts n;
    Choices       said;
    char          line[120];
    Config        config = config_of("off", 3);
    assert_int_equal(choose(&s, &said, &config), STATUS_OK);
    frame_scenery_count(&n, &s);
    int sum = 0;
    for (int k = 1; k < CLUTTER_CLASSES; k++) sum += n.of_class[k];
    CHECK(n.clutter > 0 && n.clutter == n.objects && sum == n.clutter && n.cells == 0 && n.of_class[CLUTTER_NONE] == 0);
    snprintf(line, sizeof line, "clutter: %d things, %d of them driving, within 0.3 km", n.clutter, n.driving);
    CHECK(said.count == 1 + (n.lamps[LAMP_VEHICLE] > 0) && says(&said, line)); /* what drives has lamps */
    /* all within the square, which is about its middle */
    for (int k = 0; k < s.scenery.objects; k++)
        for (int axis = 0; axis < 2; axis++)
            CHECK(fabs(s.scenery.object[k].p_enu[axis] - square.centre_m[axis]) <= square.half_width_m);
    const int few = n.clutter;
    frame_scenery_free(&s);
    config.terrain.clutter = 12; /* four times as dense: about four times as many */
    assert_int_equal(choose(&s, &said, &config), STATUS_OK);
    frame_scenery_count(&n, &s);
    CHECK(n.clutter > 2 * few && n.clutter < 8 * few);
    frame_scenery_free(&s);
    config.terrain.clutter = 20.5; /* no setting can be: config_rows.h; the placer's own bound */
    assert_int_equal(choose(&s, &said, &config), STATUS_BAD_VALUE);
    frame_scenery_free(&s);
}

/* The same plan over the same ground is the same scenery; another seed is another. */
static void what_is_invented_follows_from_the_plan(void **state)
{
    (void)state;
    FrameScenery  s, again;
    SceneryCounts n, m;
    Choices       said;
    char          line[120];
    Config        config = config_of("invented", 0.2);
    square.half_width_m = 1900; /* where some village is */
    assert_int_equal(choose(&s, &said, &config), STATUS_OK);
    frame_scenery_count(&n, &s);
    CHECK(n.buildings > 10 && n.cells > 0 && n.cells + n.clutter == n.objects && s.culture.index);
    snprintf(line, sizeof line, "buildings: %d invented, %d walls, fences and lines, %d other works", n.buildings,
             n.lines, n.points);
    CHECK(said.count == 3 && says(&said, line));
    snprintf(line, sizeof line, "lamps: %d windows, %d street lamps, %d pairs of headlamps", n.lamps[LAMP_WINDOW],
             n.lamps[LAMP_STREET], n.lamps[LAMP_VEHICLE]);
    CHECK(n.lamps[LAMP_WINDOW] > 20 && n.lamps[LAMP_VEHICLE] <= n.driving && says(&said, line));
    again = (FrameScenery){0};
    assert_int_equal(frame_scenery_make(&again, &s.plan, &land), STATUS_OK);
    frame_scenery_count(&m, &again);
    CHECK(memcmp(&n, &m, sizeof n) == 0);
    for (int k = 0; k < n.objects; k++) {
        const SceneryObject *a = &s.scenery.object[k], *b = &again.scenery.object[k];
        CHECK(a->id == b->id && a->model == b->model && memcmp(a->p_enu, b->p_enu, sizeof a->p_enu) == 0);
    }
    frame_scenery_free(&again);
    config.seed = 7;
    assert_int_equal(choose(&again, &said, &config), STATUS_OK);
    frame_scenery_count(&m, &again);
    CHECK(memcmp(&n, &m, sizeof n) != 0);
    frame_scenery_free(&again);
    frame_scenery_free(&s);
    square.half_width_m = 300;
}

/* ---- of files ------------------------------------------------------------------------------------ */

static const char hamlet[] =
    "{\"type\":\"FeatureCollection\",\"features\":["
    "{\"type\":\"Feature\",\"properties\":{\"building\":\"house\"},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
    "[[[9.1003,47.3001],[9.10046,47.3001],[9.10046,47.30018],[9.1003,47.30018],[9.1003,47.3001]]]}},"
    "{\"type\":\"Feature\",\"properties\":{\"building\":\"house\"},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
    "[[[9.2003,47.3001],[9.20046,47.3001],[9.20046,47.30018],[9.2003,47.30018],[9.2003,47.3001]]]}},"
    "{\"type\":\"Feature\",\"properties\":{\"highway\":\"residential\"},\"geometry\":{\"type\":\"LineString\","
    "\"coordinates\":[[9.0990,47.2999],[9.1010,47.2999]]}}]}\n";

static void files_are_records_within_the_square(void **state)
{
    (void)state;
    char          path[text_file_size], named[text_file_size + 16];
    FrameScenery  s;
    SceneryCounts n;
    Choices       said;
    text_file(path, hamlet);
    snprintf(named, sizeof named, "%s.geojson", path);
    CHECK(rename(path, named) == 0);
    const Config config = config_of(named, 0);
    assert_int_equal(choose(&s, &said, &config), STATUS_OK);
    frame_scenery_count(&n, &s);
    CHECK(n.buildings == 1 && n.lines == 1 && n.cells >= 1 && n.clutter == 0); /* the other is 7.5 km away */
    CHECK(s.plan.from == CULTURE_FROM_RECORDS &&
          says(&said, "buildings: 1 from files, 1 lines, 0 other works, 0 trees"));
    /* ENU of the house: 0.0003 degrees east, 0.0001 north of the origin, by the radii of WGS 84 there, and 430 m */
    const double *p = s.culture.corner_m[s.culture.building[0].first_corner];
    CHECK_NEAR(p[0], 0.0003 * 75634.33, 0.01);
    CHECK_NEAR(p[1], 0.0001 * 111184.2, 0.01);
    frame_scenery_free(&s);
    remove(named);

    log_set_sink(check_listen, NULL);
    assert_int_not_equal(choose(&s, &said, &config), STATUS_OK); /* it is gone */
    frame_scenery_free(&s);
    CHECK(strstr(check_said, "terrain.buildings=off"));
    log_set_sink(NULL, NULL);
    CHECK(said.count == 0);
}

static void a_file_that_is_none_is_refused(void **state)
{
    (void)state;
    char         path[text_file_size], named[text_file_size + 16];
    FrameScenery s;
    Choices      said;
    text_file(path, "a letter to a friend\n");
    snprintf(named, sizeof named, "%s.geojson", path);
    CHECK(rename(path, named) == 0);
    const Config config = config_of(named, 1);
    log_set_sink(check_listen, NULL);
    assert_int_not_equal(choose(&s, &said, &config), STATUS_OK);
    log_set_sink(NULL, NULL);
    CHECK(s.scenery.objects == 0 && said.count == 0);
    frame_scenery_free(&s);
    remove(named);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(off_is_nothing_and_silent), cmocka_unit_test(clutter_alone_is_counted_by_class),
        cmocka_unit_test(what_is_invented_follows_from_the_plan), cmocka_unit_test(files_are_records_within_the_square),
        cmocka_unit_test(a_file_that_is_none_is_refused)};
    return cmocka_run_group_tests(tests, open_land, close_land);
}
