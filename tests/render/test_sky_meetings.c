/* Meetings that are kept (SkyKept, render/light/sky_visibility.h), point by point: which points a frame finds again
 * after each thing that may change about them, and that what it finds gives the bits of what is traced.
 * tests/sensor/test_sky_kept.c does it for pictures. labels: physics */
#include "tests/render/change_stage.h"

enum { points = 9, samples = 32 };

static Hits             hits;
static HemisphereChange found[hits_capacity], traced[hits_capacity];
static Arena           *frame_arena;

static const double   up_enu[3] = {0, 0, 1}, reach_m = 30;
static const unsigned bands = 1u << AIR_R | 1u << AIR_LWIR;

/* A sphere and two bricks about the points, of which every other one lies on the ground, and a sphere far off. */
enum { near_sphere, near_brick, turned_brick, far_sphere, bodies };
static double place_m[bodies][3] = {{0, 0, 3}, {4, 1, 1}, {-4, 2, 2}, {400, 0, 3}}, turn_rad[bodies] = {0, 0.3, 1, 0};

static void pose(void)
{
    clear_bodies();
    for (int k = 0; k < bodies; k++) {
        const double c = cos(turn_rad[k]), s = sin(turn_rad[k]), r[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
        add_body(k == near_brick || k == turned_brick ? model_brick : model_sphere, place_m[k], r);
    }
    pose_bodies();
}

static void set_points(void)
{
    hits.count = 0;
    hand_draw = 21;
    for (int i = 0; i < points; i++)
        put_point(&hits, (const double[3]){hand_uniform(-2, 2), hand_uniform(-2, 2), 0}, up_enu, i % 2);
}

typedef struct Asked {
    uint64_t world, series;
    int      samples;
    double   sun_enu[3];
} Asked;
static const Asked usual = {77, 3, samples, {0, 0.6, 0.8}};

/* The points that a frame finds; all of them have the bits that tracing gives. */
static int frame_of(SkyKept *kept, const Asked *of)
{
    SkyKeptFrame *frame = NULL;
    SkyNotes     *notes = NULL;
    set_air(of->sun_enu, 400, 20, 15);
    AirSky *sky = &stage.air.light.sky[AIR_R]; /* with a ring about the sun, whose rays are never kept */
    for (int i = 0; i <= air_sky_ups; i++)
        for (int a = 0; a <= air_sky_azimuths; a++) sky->scattered_w_m2_sr[i][a] = 1;
    for (int k = 0; k < 6; k++) sky->around_sun[k] = 5 * (6 - (float)k);
    assert_int_equal(sky_kept_begin(&frame, kept, stage.visibility, of->world, frame_arena), STATUS_OK);
    assert_non_null(frame);
    assert_int_equal(sky_notes_create(&notes, frame, frame_arena), STATUS_OK);
    change_of(found, &hits, bands, of->samples, reach_m, 50, of->series, notes);
    change_of(traced, &hits, bands, of->samples, reach_m, 50, of->series, NULL);
    for (int i = 0; i < hits.count; i++)
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (found[i].w_m2[b] != traced[i].w_m2[b] || found[i].blocked != traced[i].blocked ||
                found[i].sunlit != traced[i].sunlit || found[i].inside != traced[i].inside)
                fail_msg("point %d, band %d: %g, traced %g", i, b, (double)found[i].w_m2[b], (double)traced[i].w_m2[b]);
    const int count = (int)sky_kept_end(frame);
    arena_reset(frame_arena);
    return count;
}

static int open_all(void **state)
{
    frame_arena = arena_create();
    return frame_arena ? open_stage(state) : -1;
}

static int close_all(void **state)
{
    arena_destroy(frame_arena);
    return close_stage(state);
}

/* The first frame does not know what stands, the second keeps, the third finds. Not of another place, normal, key,
 * number of directions, or world; of another sun the same. What moves, turns, is damaged or trades places is asked for
 * anew, once it has stood it is kept again; what lies farther than a path can reach is not asked about. */
static void points_are_found_again(void **state)
{
    (void)state;
    SkyKept *kept = NULL;
    size_t   size[2];
    assert_int_equal(sky_kept_create(&kept, 1 << 20), STATUS_OK);
    set_rho(0.5, 0.2);
    pose(), set_points();
    CHECK(frame_of(kept, &usual) == 0);
    sky_kept_size(size, kept);
    CHECK(size[0] == 0 && size[1] == 0);
    CHECK(frame_of(kept, &usual) == 0);
    sky_kept_size(size, kept);
    CHECK(size[0] == points && size[1] > points * sizeof(SkyMet));
    CHECK(frame_of(kept, &usual) == points);

    Asked of = usual;
    of.sun_enu[1] = -0.6;
    CHECK(frame_of(kept, &of) == points);
    of = usual, of.series = 4;
    CHECK(frame_of(kept, &of) == 0);
    of = usual, of.samples = samples + 1;
    CHECK(frame_of(kept, &of) == 0);
    CHECK(frame_of(kept, &usual) == points);
    of = usual, of.world = 78; /* nothing has stood in another world, nor in this one after it */
    CHECK(frame_of(kept, &of) == 0);
    CHECK(frame_of(kept, &usual) == points);
    hits.p_enu[1][2] += 1e-9;
    CHECK(frame_of(kept, &usual) == points - 1);
    hits.n_enu[0][4] = hits.n_geo[0][4] = 1e-7f;
    CHECK(frame_of(kept, &usual) == points - 1); /* the moved one is kept by now */
    set_points();
    CHECK(frame_of(kept, &usual) == points);

    place_m[far_sphere][1] += 1;
    pose();
    CHECK(frame_of(kept, &usual) == points);
    for (int change = 0; change < 7; change++) {
        const double before[2] = {place_m[near_brick][0], turn_rad[turned_brick]};
        if (change == 0) place_m[near_brick][0] += 1e-6;
        if (change == 1) turn_rad[turned_brick] += 1e-6;
        pose();
        if (change == 2) stage.pose[near_brick].p_body[2] = 1e-6;
        if (change == 3) stage.pose[near_brick].r_body_from_node[1] = 1e-6;
        if (change == 4) stage.entity[near_sphere].model = model_brick;
        if (change == 5) stage.snapshot.count = near_sphere; /* all have gone */
        if (change == 6) {
            const SnapshotEntity first = stage.entity[near_brick];
            stage.entity[near_brick] = stage.entity[turned_brick], stage.entity[turned_brick] = first;
        }
        if (change > 1) pose_bodies();
        const int first = frame_of(kept, &usual);
        if (first != 0) fail_msg("%d found after change %d", first, change);
        frame_of(kept, &usual);
        const int third = frame_of(kept, &usual);
        if (third != points) fail_msg("%d found at last after change %d", third, change);
        place_m[near_brick][0] = before[0], turn_rad[turned_brick] = before[1];
        pose();
        frame_of(kept, &usual), frame_of(kept, &usual);
        CHECK(frame_of(kept, &usual) == points);
    }
    sky_kept_destroy(kept);
}

/* A body whose sphere is a millimetre from where paths go is asked about, one that is two millimetres away is not:
 * points see 30 m, straight up; the sphere's middle is 30 m and its radius above. */
static void near_misses_count(void **state)
{
    (void)state;
    static const double off_m[] = {-0.01, 0.0005, 0.004};
    const double        before = place_m[far_sphere][0];
    for (int k = 0; k < 3; k++) {
        SkyKept *kept = NULL;
        assert_int_equal(sky_kept_create(&kept, 1 << 20), STATUS_OK);
        set_points();
        hits.count = 1; /* one point alone, which meets nothing but the far sphere */
        for (int c = 0; c < 3; c++) hits.p_enu[c][0] = c == 0 ? 1000 : 0;
        hits.entity[0] = 1;
        place_m[far_sphere][0] = 1000 + reach_m + sphere_m + off_m[k], place_m[far_sphere][1] = 0,
        place_m[far_sphere][2] = 0;
        pose();
        frame_of(kept, &usual), frame_of(kept, &usual);
        CHECK(frame_of(kept, &usual) == 1);
        place_m[far_sphere][2] += 1e-9;
        pose();
        CHECK(frame_of(kept, &usual) == (k == 2));
        sky_kept_destroy(kept);
    }
    place_m[far_sphere][0] = before;
}

/* Two points 200 m apart, with a sphere near each: the one whose sphere moves is asked for anew, the other is found. */
static void each_place_has_its_own(void **state)
{
    (void)state;
    SkyKept     *kept = NULL;
    const double before[3] = {place_m[far_sphere][0], place_m[far_sphere][1], place_m[far_sphere][2]};
    assert_int_equal(sky_kept_create(&kept, 1 << 20), STATUS_OK);
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2) {
            set_points();
            hits.count = 2;
            for (int c = 0; c < 3; c++)
                hits.p_enu[c][1] = c == axis ? 200 * side : 0, place_m[far_sphere][c] = c == axis ? 203 * side : 1;
            pose();
            frame_of(kept, &usual), frame_of(kept, &usual);
            CHECK(frame_of(kept, &usual) == 2);
            place_m[far_sphere][axis] += 0.25;
            pose();
            CHECK(frame_of(kept, &usual) == 1);
        }
    memcpy(place_m[far_sphere], before, sizeof before);
    sky_kept_destroy(kept);
}

/* A full store keeps no more, forgets what the last frame did not use, and holds no more than it was given. */
static void stores_are_bounded(void **state)
{
    (void)state;
    SkyKept *kept = NULL;
    size_t   whole[2], size[2];
    pose(), set_points();
    assert_int_equal(sky_kept_create(&kept, 1 << 20), STATUS_OK);
    frame_of(kept, &usual), frame_of(kept, &usual);
    sky_kept_size(whole, kept);
    CHECK(whole[0] == points);
    /* a row for each direction that meets something, and one that ends them */
    double met = points;
    for (int i = 0; i < points; i++) met += (double)found[i].blocked * samples;
    CHECK((double)whole[1] >= met * sizeof(SkyMet) && (double)whole[1] < 2 * met * sizeof(SkyMet) + 300 * points);
    /* points that are kept anew take the place of what was kept of them */
    for (int there = 0; there < 2; there++) {
        place_m[near_sphere][2] += there ? -0.5 : 0.5;
        pose();
        frame_of(kept, &usual), frame_of(kept, &usual);
        sky_kept_size(size, kept);
        CHECK(size[0] == points && (there ? size[1] == whole[1] : size[1] < whole[1]));
    }
    sky_kept_destroy(kept);
    /* just enough; an octet less: all but one */
    for (int less = 0; less < 2; less++) {
        assert_int_equal(sky_kept_create(&kept, whole[1] - (size_t)less), STATUS_OK);
        frame_of(kept, &usual), frame_of(kept, &usual);
        sky_kept_size(size, kept);
        CHECK(size[0] == (size_t)(points - less) && size[1] <= whole[1] - (size_t)less);
        for (int n = 0; n < 3; n++) CHECK(frame_of(kept, &usual) == points - less);
        /* other points take the place of these once they are what is asked for */
        Asked other = usual;
        other.series = 9;
        frame_of(kept, &other);
        CHECK(frame_of(kept, &other) > points / 2);
        CHECK(frame_of(kept, &usual) == 0);
        sky_kept_size(size, kept);
        CHECK(size[1] <= whole[1] - (size_t)less);
        sky_kept_destroy(kept);
    }
    /* many points: the table grows */
    assert_int_equal(sky_kept_create(&kept, 64 << 20), STATUS_OK);
    hits.count = 0;
    for (int i = 0; i < 700; i++)
        put_point(&hits, (const double[3]){hand_uniform(-4, 4), hand_uniform(-4, 4), 0}, up_enu, 1);
    Asked few = usual;
    few.samples = 4;
    frame_of(kept, &few), frame_of(kept, &few);
    CHECK(frame_of(kept, &few) == 700);
    sky_kept_size(size, kept);
    CHECK(size[0] == 700);
    /* a frame at a time */
    SkyKeptFrame *first = NULL, *second = NULL;
    assert_int_equal(sky_kept_begin(&first, kept, stage.visibility, 1, frame_arena), STATUS_OK);
    assert_int_equal(sky_kept_begin(&second, kept, stage.visibility, 1, frame_arena), STATUS_OK);
    CHECK(first && !second);
    CHECK(sky_kept_end(first) == 0 && sky_kept_end(second) == 0);
    assert_int_equal(sky_kept_begin(&first, NULL, stage.visibility, 1, frame_arena), STATUS_OK);
    CHECK(!first);
    sky_kept_destroy(kept);
    sky_kept_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_are_found_again),
        cmocka_unit_test(near_misses_count),
        cmocka_unit_test(each_place_has_its_own),
        cmocka_unit_test(stores_are_bounded),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
