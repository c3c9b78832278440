/* tests/sensor/skip_scenes.h: random scenes, each rendered with every skip and without each, and all of them: the same
 * planes and the same sums of targets, to the bit. */
#ifndef TESTS_SENSOR_SKIP_SCENES_H
#define TESTS_SENSOR_SKIP_SCENES_H

#include "tests/check.h"

#include "sensor/quality/trial_private.h"
#include "terrain/ground/landscape.h"
#include "tests/scenes/town.h"

enum { most_entities = 24 };

static struct {
    LocalFrame frame;
    Landscape  landscape;
    TrialScene scene;
    Scenery    town; /* of even scenes */
    Pool      *pool;
    Arena     *arena;
    uint64_t   skipped[SKIP_COUNT];
} stage;

static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0},  {1, 1, 222, 7, 1, 0, 0}, {1, 2, 225, 20, 1, 0, 0},
                                      {1, 1, 222, 28, 1, 0, 0}, {1, 3, 225, 1, 1, 0, 0}, {2, 2, 225, 1, 1, 0, 0}};

static double dice(int scene, int what, double low, double high)
{
    return low + (high - low) * random_uniform(11, (uint32_t)scene, 0, (uint64_t)what);
}

static inline int open_stage(void **state)
{
    (void)state;
    const Geodetic origin = {0.8, 0.2, 500};
    double         times_s[2];
    stage.arena = arena_create();
    return stage.arena && pool_create(&stage.pool, 2) == STATUS_OK &&
                   local_frame_at(&stage.frame, &origin) == STATUS_OK &&
                   landscape_quick(&stage.landscape, times_s, &stage.frame, 2000, 2000, stage.pool) == STATUS_OK
               ? 0
               : -1;
}

static inline int close_stage(void **state)
{
    (void)state;
    landscape_destroy(&stage.landscape);
    arena_destroy(stage.arena);
    pool_destroy(stage.pool);
    return 0;
}

/* Vehicles in the open and inside each other, aircraft, some that smoke or burn; from noon to after sunset. */
static void place_all(int n)
{
    const int entities = 1 + (int)dice(n, 1, 0, most_entities);
    char      catalog[512];
    CHECK(etc_path(catalog, sizeof catalog, "catalog.csv"));
    assert_int_equal(trial_scene_open(&stage.scene, &stage.landscape, catalog, types, 1, 0), STATUS_OK);
    stage.scene.unix_s += 3600 * dice(n, 2, 0, 9);
    if (n % 2 == 0) {
        const TownOf of = {.buildings = 40,
                           .clutter = 60,
                           .movers = 6,
                           .middle_enu = {20, 30},
                           .landscape = &stage.landscape,
                           .seed = (uint64_t)n};
        assert_int_equal(town_create(&stage.town, &of), STATUS_OK);
        assert_int_equal(world_scenery(&stage.scene.world, &stage.town, NULL, stage.pool), STATUS_OK);
    }
    for (int later = 0; later < 2; later++) {
        for (int k = 0; k < entities; k++) {
            const int        d = 100 + 10 * k;
            const double     spread_m = dice(n, 3, 5, 150);
            const TrialPlace place = {.type = types[(int)dice(n, d, 0, sizeof types / sizeof *types)],
                                      .number = k + 1,
                                      .east_m = dice(n, d + 1, -spread_m, spread_m),
                                      .north_m = dice(n, d + 2, -spread_m, spread_m),
                                      .above_m = dice(n, d + 3, 0, 1) < 0.3 ? dice(n, d + 4, 0, 40) : 0,
                                      .turn_rad = dice(n, d + 5, 0, 6),
                                      .appearance = (uint32_t)dice(n, d + 6, 0, 4) << 5};
            assert_int_equal(trial_scene_place(&stage.scene, &place), STATUS_OK);
        }
        if (!later) stage.scene.sun_now_s += 8; /* for the smoke to rise */
    }
}

static RenderRequest request_of(int n)
{
    const double  back_m = exp(dice(n, 4, log(15), log(900)));
    View          view = trial_view(&stage.scene, back_m, dice(n, 5, 1, 0.5 * back_m), dice(n, 6, 3, 60) * rad_per_deg,
                                    33 + (int)dice(n, 7, 0, 40), 33 + (int)dice(n, 8, 0, 30));
    RenderRequest request = {.view = view,
                             .bands = 1 + (unsigned)dice(n, 9, 0, 15),
                             .truth = true,
                             .optical = OPTICAL_RGB,
                             .samples = dice(n, 10, 0, 1) < 0.25 ? 2 : 1,
                             .edge_samples = dice(n, 11, 0, 1) < 0.7 ? 4 : 0,
                             .target_samples = dice(n, 12, 0, 1) < 0.7 ? 32 : 0,
                             .t_s = 10,
                             .hidden_entity = dice(n, 13, 0, 1) < 0.3 ? 0 : -1,
                             .sky_visibility = n % 3 != 2};
    if (request.bands >> BAND_RADAR & 1)
        request.profile_bins = 16, request.profile_bin_m = 4, request.profile_near_m = back_m - 30;
    return request;
}

static void check_targets(const TargetPixels *a, const TargetPixels *b, int count, const char *what)
{
    for (int k = 0; k < count; k++) {
        bool same = a[k].visible == b[k].visible && a[k].amodal == b[k].amodal && a[k].small == b[k].small &&
                    a[k].occluded_ground == b[k].occluded_ground && a[k].occluded_scenery == b[k].occluded_scenery &&
                    a[k].occluded_entity == b[k].occluded_entity && a[k].occluder == b[k].occluder &&
                    memcmp(a[k].box, b[k].box, sizeof a[k].box) == 0 &&
                    memcmp(a[k].amodal_box, b[k].amodal_box, sizeof a[k].amodal_box) == 0 &&
                    memcmp(a[k].veiled, b[k].veiled, sizeof a[k].veiled) == 0;
        for (int p = 0; p < picture_plane_count; p++) same &= a[k].radiance[p] == b[k].radiance[p];
        if (!same) fail_msg("target %d: %s", k, what);
    }
}

/* A scene with every skip and without each: to the bit. */
static inline void keeps_the_bits(int n)
{
    static TargetPixels target[most_entities];
    char                hash[sha256_text_size], other[sha256_text_size], what[64];
    place_all(n);
    TrialFrame frame = {.scene = &stage.scene, .request = request_of(n), .pool = stage.pool, .arena = stage.arena};
    for (int k = 0; k < 3; k++) trial_frame(&frame); /* what stood in the second is kept in the third */
    assert_int_equal(frame.status, STATUS_OK);
    assert_int_equal(trial_frame_hash(hash, &frame), STATUS_OK);
    memcpy(target, frame.picture.target, (size_t)frame.snapshot.count * sizeof *target);
    for (int k = 0; k < SKIP_COUNT; k++) stage.skipped[k] += frame.picture.counters.visibility.skipped[k];
    for (int k = 0; k <= SKIP_COUNT; k++) {
        frame.request.skips_off = k < SKIP_COUNT ? 1u << k : skips_all_off;
        snprintf(what, sizeof what, "scene %d without skip %s", n,
                 k < SKIP_COUNT ? visibility_skip_name((Skip)k) : "all");
        trial_frame(&frame);
        assert_int_equal(frame.status, STATUS_OK);
        assert_int_equal(trial_frame_hash(other, &frame), STATUS_OK);
        if (strcmp(hash, other) != 0) fail_msg("%s: other planes", what);
        check_targets(target, frame.picture.target, frame.snapshot.count, what);
        for (int j = 0; j < SKIP_COUNT; j++)
            if (!skips(frame.request.skips_off, (Skip)j) && frame.picture.counters.visibility.skipped[j] != 0)
                fail_msg("%s: still skips %s", what, visibility_skip_name((Skip)j));
    }
    trial_scene_close(&stage.scene);
    scenery_free(&stage.town);
}

/* Else scenes were compared with themselves. */
static inline void each_skip_was_taken(void **state)
{
    (void)state;
    for (int k = 0; k < SKIP_COUNT; k++)
        if (stage.skipped[k] == 0) fail_msg("%s was never taken: choose other scenes", visibility_skip_name((Skip)k));
}

#endif
