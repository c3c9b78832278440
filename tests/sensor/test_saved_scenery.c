/* tests/sensor/test_saved_scenery.c: scenery of a frame file: what is written is what is read, from it follows the same
 * scenery to the bit, and octets that no scenery has are refused by the name of the field. */
#include "tests/check.h"

#include "sensor/verify/saved_frame/saved_frame_private.h"
#include "sensor/verify/saved_frame/saved_scene.h"
#include "terrain/surface.h"

/* ---- a hamlet of records ------------------------------------------------------------------------- */

static const double square_m[4][2] = {{0, 0}, {10, 0}, {10, 8}, {0, 8}};
static const double way_m[3][2] = {{-40, -6}, {0, -5}, {60, -8}};

static Building house(double x_m, double y_m, double corner_m[4][2])
{
    for (int k = 0; k < 4; k++) corner_m[k][0] = x_m + square_m[k][0], corner_m[k][1] = y_m + square_m[k][1];
    return (Building){.id = 0x1234567890abcdefU ^ (uint64_t)(x_m * 64),
                      .base_m = 3,
                      .eaves_m = 5.5f,
                      .ridge_m = 9,
                      .use = BUILDING_HOUSE,
                      .roof = ROOF_GABLED,
                      .wall_fabric = FABRIC_BRICK,
                      .roof_fabric = FABRIC_TILE,
                      .levels = 2,
                      .heated = true,
                      .chimneys = 1};
}

static Culture hamlet(void)
{
    Culture c = {0};
    double  p[4][2];
    for (int k = 0; k < 3; k++) {
        const Building b = house(200.0 * k, -30.0 * k, p);
        assert_int_equal(culture_add_building(&c, &b, (const double(*)[2])p, 4), STATUS_OK);
    }
    const CultureLine wall = {.id = 7, .width_m = 0.5f, .height_m = 1.8f, .kind = CULTURE_WALL},
                      road = {.id = 8, .width_m = 5, .kind = CULTURE_ROAD, .surface = SURFACE_ROAD};
    assert_int_equal(culture_add_line(&c, &wall, way_m, 3), STATUS_OK);
    assert_int_equal(culture_add_line(&c, &road, way_m, 3), STATUS_OK);
    const CulturePoint tank = {.id = 9, .x_m = 30, .y_m = 40, .base_m = 3, .size_m = {4, 4, 6}, .kind = CULTURE_TANK};
    assert_int_equal(culture_add_point(&c, &tank), STATUS_OK);
    const CultureTree tree = {.id = 10, .x_m = -20, .y_m = 20, .height_m = 12, .mark = MARK_RED};
    assert_int_equal(culture_add_tree(&c, &tree), STATUS_OK);
    assert_int_equal(culture_index(&c), STATUS_OK);
    assert_int_equal(c.left_out, 0);
    return c;
}

/* A frame that has nothing but scenery: its chunk alone is written and read here. */
static SavedFrame frame_of(const Culture *c, CultureFrom from, double clutter)
{
    SavedFrame file = {.built = true};
    file.scenery.plan = (SceneryPlan){.from = from,
                                      .invented = {5, {10, -20}, 400},
                                      .clutter = clutter,
                                      .clutter_seed = 5,
                                      .south_west_m = {-400, -420},
                                      .north_east_m = {420, 380}};
    if (c) file.scenery.culture = *c;
    return file;
}

static ByteSink written(SavedFrame file)
{
    ByteSink sink = {0};
    saved_fields_scenery(&(Fields){.to = &sink, .version = chunks_version}, &file);
    return sink;
}

/* NULL: it was read whole; else why not. */
static const char *read_back(SavedFrame *out, const ByteSink *sink, Arena *arena)
{
    ByteSource from = {sink->bytes, sink->bytes + sink->count, false};
    Fields     f = {.from = &from, .version = chunks_version, .arena = arena};
    *out = (SavedFrame){0};
    saved_fields_scenery(&f, out);
    return f.fault ? f.fault : from.truncated ? "truncated" : from.at != from.end ? "long" : NULL;
}

/* ---- ground -------------------------------------------------------------------------------------- */

static Landscape ground_of(uint64_t seed)
{
    const Geodetic  origin = {47 * rad_per_deg, 9 * rad_per_deg, 430};
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    Landscape       landscape;
    config.seed = seed, config.half_width_m = 1000, config.spacing_m = 4;
    assert_int_equal(local_frame_at(&frame, &origin), STATUS_OK);
    assert_int_equal(landscape_create(&landscape, &config, &frame, NULL, 0, NULL, 0), STATUS_OK);
    return landscape;
}

static void records_and_what_follows_from_them(void **state)
{
    (void)state;
    Arena       *arena = arena_create();
    Culture      c = hamlet();
    Landscape    landscape = ground_of(3);
    SavedFrame   file = frame_of(&c, CULTURE_FROM_RECORDS, 2), got;
    FrameScenery made = {.culture = hamlet()}, again;
    assert_int_equal(frame_scenery_make(&made, &file.scenery.plan, &landscape), STATUS_OK);
    assert_int_equal(saved_scenery_sha256(file.scenery.sha256, &made.scenery), STATUS_OK);
    file.scenery.objects = made.scenery.objects;
    CHECK(made.scenery.objects > 3); /* of the houses' squares, and clutter */

    ByteSink sink = written(file);
    assert_null(read_back(&got, &sink, arena));
    const Culture *read = &got.scenery.culture;
    CHECK(got.built && read->buildings == 3 && read->lines == 2 && read->points == 1 && read->trees == 1);
    CHECK(memcmp(read->corner_m, c.corner_m, (size_t)c.corners * sizeof *c.corner_m) == 0);
    CHECK(memcmp(read->building, c.building, 3 * sizeof *c.building) == 0);
    CHECK(read->line[1].surface == SURFACE_ROAD && read->tree->mark == MARK_RED && read->point->size_m[2] == 6);

    assert_int_equal(saved_scenery_make(&again, &landscape, &got, false), STATUS_OK);
    CHECK(again.scenery.objects == made.scenery.objects && again.scenery.models == made.scenery.models);
    CHECK(landscape.over.of == &again.culture); /* its road lies on the ground */
    frame_scenery_free(&again);
    landscape.over = (LandscapeOver){0};

    /* other records, or another ground: it is noticed */
    got.scenery.culture.building[1].ridge_m += 0.25f;
    assert_int_equal(saved_scenery_make(&again, &landscape, &got, false), STATUS_BAD_VALUE);
    frame_scenery_free(&again);
    landscape.over = (LandscapeOver){0};
    assert_int_equal(saved_scenery_make(&again, &landscape, &got, true), STATUS_OK); /* --force */
    frame_scenery_free(&again);
    frame_scenery_free(&made);
    landscape_destroy(&landscape);
    sink_free(&sink);
    culture_free(&c);
    arena_destroy(arena);
}

/* Where they are invented, the plan alone is in the file. */
static void what_is_invented_takes_no_records(void **state)
{
    (void)state;
    Arena     *arena = arena_create();
    Culture    c = hamlet();
    SavedFrame got;
    for (int from = CULTURE_FROM_NOTHING; from < CULTURE_FROM_RECORDS; from++) {
        ByteSink sink = written(frame_of(&c, (CultureFrom)from, 1));
        CHECK(sink.count < 200);
        assert_null(read_back(&got, &sink, arena));
        CHECK(got.scenery.culture.buildings == 0 && (int)got.scenery.plan.from == from);
        CHECK(got.scenery.plan.invented.seed == 5 && got.scenery.plan.north_east_m[1] == 380);
        sink_free(&sink);
    }
    culture_free(&c);
    arena_destroy(arena);
}

/* ---- hostile octets ------------------------------------------------------------------------------ */

typedef struct Damage {
    void (*harm)(SavedFrame *file);
    const char *fault;
} Damage;

static void far_corner(SavedFrame *f) { f->scenery.culture.corner_m[2][0] = 1.5e6; }
static void nan_corner(SavedFrame *f) { f->scenery.culture.corner_m[2][1] = NAN; }
static void clockwise(SavedFrame *f)
{
    double(*p)[2] = f->scenery.culture.corner_m;
    for (int k = 0; k < 2; k++) {
        const double swap = p[1][k];
        p[1][k] = p[3][k], p[3][k] = swap;
    }
}
static void crossed(SavedFrame *f) { f->scenery.culture.corner_m[2][0] = -30; }
static void beyond_corners(SavedFrame *f)
{
    f->scenery.culture.building[0].first_corner = f->scenery.culture.corners - 3;
}
static void many_corners(SavedFrame *f) { f->scenery.culture.building[0].corners = culture_outline_most + 1; }
static void line_beyond(SavedFrame *f) { f->scenery.culture.line[1].first_corner = f->scenery.culture.corners - 1; }
static void low_ridge(SavedFrame *f) { f->scenery.culture.building[2].ridge_m = 2; }
static void nan_eaves(SavedFrame *f) { f->scenery.culture.building[2].eaves_m = NAN; }
static void odd_use(SavedFrame *f) { f->scenery.culture.building[0].use = BUILDING_USES; }
static void odd_fabric(SavedFrame *f) { f->scenery.culture.building[0].wall_fabric = FABRICS; }
static void odd_levels(SavedFrame *f) { f->scenery.culture.building[0].levels = 101; }
static void odd_surface(SavedFrame *f) { f->scenery.culture.line[0].surface = SURFACE_COUNT; }
static void flat_point(SavedFrame *f) { f->scenery.culture.point[0].size_m[2] = 0; }
static void tall_tree(SavedFrame *f) { f->scenery.culture.tree[0].height_m = 201; }
static void dense(SavedFrame *f) { f->scenery.plan.clutter = 20.5; }
static void wide(SavedFrame *f) { f->scenery.plan.invented.half_width_m = 1e7; }
static void nowhere(SavedFrame *f) { f->scenery.plan.south_west_m[0] = -INFINITY; }
static void odd_origin(SavedFrame *f) { f->scenery.plan.from = CULTURE_FROMS; }

static void what_no_scenery_has_is_refused(void **state)
{
    (void)state;
    static const Damage damage[] = {{far_corner, "corner of culture"},
                                    {nan_corner, "corner of culture"},
                                    {clockwise, "outline of a building"},
                                    {crossed, "outline of a building"},
                                    {beyond_corners, "a building"},
                                    {many_corners, "corners of a building"},
                                    {line_beyond, "a line"},
                                    {low_ridge, "a building"},
                                    {nan_eaves, "height of a building"},
                                    {odd_use, "use of a building"},
                                    {odd_fabric, "walls of a building"},
                                    {odd_levels, "levels of a building"},
                                    {odd_surface, "surface of a line"},
                                    {flat_point, "a point of culture"},
                                    {tall_tree, "height of a tree"},
                                    {dense, "clutter"},
                                    {wide, "width of culture"},
                                    {nowhere, "place of clutter"},
                                    {odd_origin, "culture"}};
    Arena              *arena = arena_create();
    for (size_t k = 0; k < sizeof damage / sizeof *damage; k++) {
        Culture    c = hamlet();
        SavedFrame file = frame_of(&c, CULTURE_FROM_RECORDS, 1), got;
        damage[k].harm(&file);
        ByteSink    sink = written(file);
        const char *why = read_back(&got, &sink, arena);
        if (!why || strcmp(why, damage[k].fault) != 0)
            fail_msg("damage %d: %s, not %s", (int)k, why ? why : "accepted", damage[k].fault);
        sink_free(&sink);
        culture_free(&c);
    }
    /* each beginning of it is refused, and none takes memory for what it lacks */
    Culture  c = hamlet();
    ByteSink sink = written(frame_of(&c, CULTURE_FROM_RECORDS, 1));
    for (size_t less = 1; less < sink.count; less++) {
        SavedFrame got;
        ByteSink   part = {.bytes = sink.bytes, .count = sink.count - less};
        CHECK(read_back(&got, &part, arena) != NULL);
    }
    sink_free(&sink);
    culture_free(&c);
    arena_destroy(arena);
}

/* Of clutter by another table than countryside its name is kept, and the scenery follows from it; octets without an end
 * are no name. */
static void the_table_of_clutter(void **state)
{
    (void)state;
    Arena     *arena = arena_create();
    Landscape  landscape = ground_of(3);
    SavedFrame file = frame_of(NULL, CULTURE_FROM_NOTHING, 1), got;
    ByteSink   plain = written(file);
    snprintf(file.scenery.plan.clutter_table, sizeof file.scenery.plan.clutter_table, "countryside");
    ByteSink same = written(file);
    CHECK(plain.count == same.count && memcmp(plain.bytes, same.bytes, plain.count) == 0);
    snprintf(file.scenery.plan.clutter_table, sizeof file.scenery.plan.clutter_table, "rear_area");
    FrameScenery made = {0}, again;
    assert_int_equal(frame_scenery_make(&made, &file.scenery.plan, &landscape), STATUS_OK);
    assert_int_equal(saved_scenery_sha256(file.scenery.sha256, &made.scenery), STATUS_OK);
    file.scenery.objects = made.scenery.objects;
    ByteSink other = written(file);
    assert_null(read_back(&got, &other, arena));
    assert_string_equal(got.scenery.plan.clutter_table, "rear_area");
    assert_int_equal(saved_scenery_make(&again, &landscape, &got, false), STATUS_OK);
    frame_scenery_free(&again);
    *got.scenery.plan.clutter_table = 0; /* the countryside is not what was saved */
    log_suppress(true);
    assert_int_equal(saved_scenery_make(&again, &landscape, &got, false), STATUS_BAD_VALUE);
    log_suppress(false);
    frame_scenery_free(&again), frame_scenery_free(&made);
    memset(other.bytes + other.count - sizeof file.scenery.plan.clutter_table, 'a',
           sizeof file.scenery.plan.clutter_table);
    assert_string_equal(read_back(&got, &other, arena), "table of clutter");
    sink_free(&plain), sink_free(&same), sink_free(&other);
    landscape_destroy(&landscape);
    arena_destroy(arena);
}

/* Paths of vehicles are kept as they are; more of them than a thousand vehicles drive in a day are none. */
static void paths_have_a_limit(void **state)
{
    (void)state;
    enum { many = 600 };
    static DrivenPath path[many];
    Arena            *arena = arena_create();
    SavedFrame        file = frame_of(NULL, CULTURE_FROM_NOTHING, 1), got;
    for (int n = 0; n < many; n++) path[n] = (DrivenPath){{-9e5, n}, {9e5, n}, 2};
    file.scenery.driven = path, file.scenery.drivens = 500; /* 0.9e9 m */
    ByteSink few = written(file);
    assert_null(read_back(&got, &few, arena));
    CHECK(got.scenery.drivens == 500 && memcmp(&got.scenery.driven[499], &path[499], sizeof *path) == 0);
    file.scenery.drivens = many;
    ByteSink more = written(file);
    assert_string_equal(read_back(&got, &more, arena), "paths of vehicles");
    sink_free(&few), sink_free(&more);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_table_of_clutter), cmocka_unit_test(records_and_what_follows_from_them),
        cmocka_unit_test(what_is_invented_takes_no_records), cmocka_unit_test(what_no_scenery_has_is_refused),
        cmocka_unit_test(paths_have_a_limit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
