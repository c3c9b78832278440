/* What paths from sample points met, kept from frame to frame (render/light/sky_visibility.h): frames of a scene that
 * lives on, after each thing that may change in it, against the same frames with every path traced, nothing skipped, on
 * one thread: to the bit. That something is kept, and that what moves is asked for again, by the counts; that stale
 * meetings would have shown, by pictures that differ although what moved is not on them. labels: slow */
#include "tests/check.h"

#include "render/light/sky_visibility.h"
#include "sensor/quality/trial_private.h"
#include "terrain/ground/landscape.h"

enum { width = 40, height = 30 };

static struct {
    LocalFrame frame;
    Landscape  landscape;
    TrialScene scene;
    Pool      *pool, *one;
    Arena     *arena, *other;
} stage;

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, truck = {1, 1, 222, 7, 1, 0, 0};
enum { seen = 1, beside, removed, turning, unseen, apart, out_of_reach };

static void place(int number, double east_m, double north_m, double turn_rad, uint32_t appearance)
{
    const TrialPlace of = {.type = number == beside ? truck : tank,
                           .number = number,
                           .east_m = east_m,
                           .north_m = north_m,
                           .turn_rad = turn_rad,
                           .appearance = appearance};
    assert_int_equal(trial_scene_place(&stage.scene, &of), STATUS_OK);
}

static int open_stage(void **state)
{
    (void)state;
    const Geodetic origin = {0.8, 0.2, 500};
    double         times_s[2];
    char           catalog[512];
    stage.arena = arena_create(), stage.other = arena_create();
    if (!stage.arena || !stage.other || !etc_path(catalog, sizeof catalog, "catalog.csv")) return -1;
    if (pool_create(&stage.pool, 2) != STATUS_OK || pool_create(&stage.one, 1) != STATUS_OK) return -1;
    if (local_frame_at(&stage.frame, &origin) != STATUS_OK ||
        landscape_quick(&stage.landscape, times_s, &stage.frame, 2000, 2000, stage.pool) != STATUS_OK ||
        trial_scene_open(&stage.scene, &stage.landscape, catalog, &tank, 1, 0) != STATUS_OK)
        return -1;
    place(seen, 0, 0, 0.6, 0);
    place(beside, 7, 3, 2.1, 0);
    place(removed, -8, 6, 4.0, 0);
    place(turning, -3, -7, 1.0, 0);
    place(unseen, 17, 0, 1.6, 0); /* beside what the eye sees */
    place(apart, 12, 190, 0.3, 0);
    place(out_of_reach, 0, 600, 0, 0);
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    trial_scene_close(&stage.scene);
    landscape_destroy(&stage.landscape);
    arena_destroy(stage.arena);
    arena_destroy(stage.other);
    pool_destroy(stage.pool);
    pool_destroy(stage.one);
    return 0;
}

typedef struct Eye {
    double   back_m, above_m;
    unsigned bands;
} Eye;

static const unsigned optical = 1u << BAND_OPTICAL, lwir = 1u << BAND_LWIR;

static TrialFrame frame_of(const Eye *eye, Pool *pool, Arena *arena, unsigned off)
{
    const View    view = trial_view(&stage.scene, eye->back_m, eye->above_m, 16 * rad_per_deg, width, height);
    RenderRequest request = trial_default_request(&stage.scene, &view, eye->back_m);
    request.bands = eye->bands, request.budget = false, request.profile_bins = 0, request.target_samples = 8;
    request.skips_off = off;
    TrialFrame frame = {.scene = &stage.scene, .request = request, .pool = pool, .arena = arena};
    trial_frame(&frame);
    assert_int_equal(frame.status, STATUS_OK);
    return frame;
}

/* A frame that may use what is kept; its points that were. Compared with one that asks for everything. */
static uint64_t look(char hash[sha256_text_size], const Eye *eye, const char *what)
{
    static int       number;
    char             plain[sha256_text_size];
    const TrialFrame frame = frame_of(eye, number++ % 2 ? stage.pool : stage.one, stage.arena, 0);
    const TrialFrame asked = frame_of(eye, stage.one, stage.other, skips_all_off);
    assert_int_equal(trial_frame_hash(hash, &frame), STATUS_OK);
    assert_int_equal(trial_frame_hash(plain, &asked), STATUS_OK);
    if (strcmp(hash, plain) != 0) fail_msg("%s: other planes than of a frame that asks for all", what);
    assert_int_equal(asked.picture.counters.visibility.skipped[SKIP_KEPT], 0);
    return frame.picture.counters.visibility.skipped[SKIP_KEPT];
}

/* Frames of a scene that stands, until what it shows is kept. */
static uint64_t settle(char hash[sha256_text_size], const Eye *eye, const char *what)
{
    for (int k = 0; k < 2; k++) frame_of(eye, stage.pool, stage.arena, 0);
    return look(hash, eye, what);
}

static const Eye usual = {60, 7, 1u << BAND_OPTICAL | 1u << BAND_LWIR};

static void remove_entity(int number)
{
    entity_table_remove(stage.scene.table, &(DisRemoveEntity){.receiving = {1, 1, (uint16_t)number}},
                        stage.scene.sun_now_s);
}

static void each_change(void **state)
{
    (void)state;
    char           hash[sha256_text_size], before[sha256_text_size];
    const uint64_t all = settle(before, &usual, "a scene that stands");
    print_message("%d points are kept\n", (int)all);
    assert_true(all > 200);

    /* the sun and temperatures go on: what was met is kept, and the light is another (a few points of the ground are
     * others, where shadows lie otherwise) */
    stage.scene.unix_s += 1200;
    assert_true(look(hash, &usual, "a later sun") > 0.9 * (double)all);
    assert_string_not_equal(hash, before);
    const Eye thermal = {60, 7, lwir}, visible = {60, 7, optical};
    assert_true(look(hash, &thermal, "8-12 um alone") > 0.5 * (double)all);
    assert_true(look(hash, &visible, "optical alone") > 0.5 * (double)all);

    /* from near by the ground is asked for at the same places, and the bodies: in the same bins of aspects */
    const Eye      nearer = {57, 6.5, usual.bands};
    const uint64_t shared = look(hash, &nearer, "another eye");
    print_message("from another eye %d\n", (int)shared);
    assert_true(shared > 0.6 * (double)all);

    /* far off: only what is there is asked for again */
    const uint64_t now = settle(before, &usual, "a later sun");
    place(out_of_reach, 60, 620, 1, 0);
    assert_true(look(before, &usual, "what moves far off") > 0.9 * (double)now);

    /* moves, turns, burns, is destroyed, goes: the first frame asks again, and it shows; then all is kept as it is */
    static const struct {
        const char *what;
        int         number;
        double      east_m, north_m, turn_rad;
        uint32_t    appearance;
    } change[] = {{"a neighbour moved", beside, 7.5, 3, 2.1, 0},
                  {"a turned one", turning, -3, -7, 1.05, 0},
                  {"one that is not seen moved", unseen, 15.5, 1, 1.6, 0},
                  {"one that smokes and burns", beside, 7.5, 3, 2.1, 1u << 15 | 3u << 5},
                  {"a wreck", beside, 7.5, 3, 2.1, 3u << 3}};
    for (size_t k = 0; k < sizeof change / sizeof *change; k++) {
        const uint64_t kept_before = settle(before, &usual, change[k].what);
        place(change[k].number, change[k].east_m, change[k].north_m, change[k].turn_rad, change[k].appearance);
        const uint64_t first = look(hash, &usual, change[k].what);
        print_message("%s: %d of %d kept\n", change[k].what, (int)first, (int)kept_before);
        assert_string_not_equal(hash, before);
        assert_true(first > 0); /* of the one that stands apart */
        if (change[k].appearance != (1u << 15 | 3u << 5)) assert_true(first < kept_before);
        assert_true(settle(hash, &usual, change[k].what) > 200);
    }
    const uint64_t kept_before = settle(before, &usual, "one that goes");
    remove_entity(removed);
    assert_true(look(hash, &usual, "one that goes") < kept_before);
    assert_string_not_equal(hash, before);
    assert_true(settle(hash, &usual, "one that has gone") > 200);
}

/* The eye flies on, the sun too, a neighbour moves every tenth frame: every twentieth is compared. */
static void a_hundred_frames(void **state)
{
    (void)state;
    char     hash[sha256_text_size];
    uint64_t kept = 0;
    for (int n = 0; n <= 100; n++) {
        const Eye eye = {60 - 0.2 * n, 7, usual.bands};
        stage.scene.unix_s += 0.1;
        if (n % 10 == 0) place(beside, 8 + 0.02 * n, 3, 2.1, 0);
        if (n % 20 == 0) kept += look(hash, &eye, "a hundred frames");
        else kept += frame_of(&eye, stage.pool, stage.arena, 0).picture.counters.visibility.skipped[SKIP_KEPT];
    }
    print_message("%d points kept in 100 frames\n", (int)kept);
    assert_true(kept > 100 * 50);
}

/* A store that is full keeps no more, and forgets what is not used: its size never exceeds what it was given. */
static void memory_is_bounded(void **state)
{
    (void)state;
    static const size_t most[] = {0, 30000, 150000};
    char                hash[sha256_text_size];
    SkyKept *const      own = stage.scene.world.sky;
    for (size_t k = 0; k < sizeof most / sizeof *most; k++) {
        size_t size[2];
        assert_int_equal(sky_kept_create(&stage.scene.world.sky, most[k]), STATUS_OK);
        for (int n = 0; n < 9; n++) {
            const Eye eye = {60 - n / 3, 7, usual.bands};
            if (n % 3 == 2) look(hash, &eye, "a small store"); /* by what the two frames before it kept */
            else frame_of(&eye, stage.pool, stage.arena, 0);
            sky_kept_size(size, stage.scene.world.sky);
            if (size[1] > most[k]) fail_msg("%zu octets kept, of %zu", size[1], most[k]);
        }
        if (most[k] > 0) assert_true(size[0] > 0);
        sky_kept_destroy(stage.scene.world.sky);
    }
    stage.scene.world.sky = own;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_change), cmocka_unit_test(a_hundred_frames),
                                       cmocka_unit_test(memory_is_bounded)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
