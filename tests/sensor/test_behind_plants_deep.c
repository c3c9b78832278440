/* What of vehicles is seen between trees: the default frame against 12 x 12 rays in every pixel, which know neither
 * grids nor edges; one ray a pixel is told from it. labels: deep */
#include "tests/scenes/woods_stand.h"
#include "sensor/quality/trial_private.h"
#include "sensor/settings/config.h"
#include "terrain/ground/landscape.h"
#include "tests/check.h"

enum { vehicles = 20, width_px = 160, height_px = 110, rays = 12 };

static const double east_m = 800, north_m = 3000;

/* Seen from back_m south of the vehicles and above_m over the ground: 4 to 60 px across. */
static const struct {
    double back_m, above_m, hfov_deg;
} views[] = {{60, 25, 20},   {90, 40, 22},   {250, 100, 40}, {400, 120, 27},
             {600, 300, 18}, {900, 250, 12}, {1200, 500, 9}};
enum { view_count = sizeof views / sizeof *views };

static struct {
    Landscape  ground;
    TrialScene scene;
    Woods      woods;
    Pool      *pool;
    Arena     *arena[3];
} lab;

/* Trees over all of the ground, half of the vehicles with their middles clear by 3 m alone. */
static int lab_open(void **state)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 2, 1, 0, 0}, {1, 1, 222, 28, 1, 0, 0}};
    const Geodetic             origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    const ForestConfig         forest = {.leaves = true, .level1_px = config_default().terrain.woods_level1_px};
    WoodsStand                 stand = {.landscape = &lab.ground, .east_m = east_m, .north_m = north_m, .trees = 30000};
    LocalFrame                 frame;
    Snapshot                   snapshot;
    double                     times_s[2];
    (void)state;
    for (int k = 0; k < 3; k++) lab.arena[k] = arena_create();
    assert_int_equal(pool_create(&lab.pool, thread_processors()), STATUS_OK);
    assert_int_equal(local_frame_at(&frame, &origin), STATUS_OK);
    assert_int_equal(landscape_quick(&lab.ground, times_s, &frame, east_m, north_m, lab.pool), STATUS_OK);
    char catalog[512];
    CHECK(etc_path(catalog, sizeof catalog, "catalog.csv"));
    assert_int_equal(trial_scene_open(&lab.scene, &lab.ground, catalog, types, 3, vehicles), STATUS_OK);
    assert_int_equal(entity_table_snapshot(&snapshot, lab.scene.table, lab.scene.sun_now_s + 0.5, lab.arena[0]),
                     STATUS_OK);
    for (int k = 0; k < snapshot.count; k++) {
        double p_enu[3];
        enu_from_ecef(p_enu, &frame, snapshot.entity[k].p_ecef);
        const double clear_m = k % 2 ? 6 : 3;
        stand.clear[stand.clears++] = (WoodsPath){{p_enu[0], p_enu[1]}, {p_enu[0], p_enu[1]}, clear_m, clear_m};
    }
    assert_int_equal(woods_stand_create(&lab.woods, &stand, lab.pool), STATUS_OK);
    assert_int_equal(world_plant(&lab.scene.world, &lab.woods, &forest, NULL, lab.pool), STATUS_OK);
    return 0;
}

static int lab_close(void **state)
{
    (void)state;
    trial_scene_close(&lab.scene);
    woods_destroy(&lab.woods);
    landscape_destroy(&lab.ground);
    for (int k = 0; k < 3; k++) arena_destroy(lab.arena[k]);
    pool_destroy(lab.pool);
    return 0;
}

typedef enum SampledBy { AS_USUAL, MANY, ONE } SampledBy;

static TrialFrame frame_of(int v, SampledBy kind)
{
    const View view =
        trial_view(&lab.scene, views[v].back_m, views[v].above_m, views[v].hfov_deg * rad_per_deg, width_px, height_px);
    TrialFrame f = {.scene = &lab.scene, .pool = lab.pool, .arena = lab.arena[kind]};
    f.request = trial_default_request(&lab.scene, &view, views[v].back_m);
    f.request.bands = 1u << BAND_LWIR;
    f.request.budget = false, f.request.profile_bins = 0;
    if (kind != AS_USUAL)
        f.request.samples = kind == MANY ? rays : 1, f.request.edge_samples = f.request.target_samples = 0;
    trial_frame(&f);
    assert_int_equal(f.status, STATUS_OK);
    return f;
}

static void visible_fractions_are_those_of_many_rays(void **state)
{
    (void)state;
    double square = 0, sum = 0, worst = 0, coarse_square = 0;
    int    count = 0, partly = 0, small = 0;
    for (int v = 0; v < view_count; v++) {
        const TrialFrame now = frame_of(v, AS_USUAL), true_one = frame_of(v, MANY), coarse = frame_of(v, ONE);
        double           view_square = 0;
        int              view_count_of = 0;
        for (int k = 0; k < vehicles; k++) {
            const TargetPixels *a = &now.picture.target[k], *b = &true_one.picture.target[k],
                               *c = &coarse.picture.target[k];
            if (!(b->amodal > 4)) continue; /* 600 rays: their own scatter is below 0.01 */
            const double seen = a->visible / a->amodal, want = b->visible / b->amodal, off = seen - want;
            const double coarse_off = (c->amodal > 0 ? c->visible / c->amodal : 0) - want;
            view_square += off * off, view_count_of++;
            coarse_square += coarse_off * coarse_off;
            sum += off, small += a->small;
            partly += want > 0.05 && want < 0.95;
            worst = fmax(worst, fabs(off));
        }
        print_message("%4.0f m: %d vehicles, rms %.4f\n", views[v].back_m, view_count_of,
                      sqrt(view_square / view_count_of));
        square += view_square, count += view_count_of;
    }
    print_message(
        "visible fraction of %d vehicles, %d of them in part, %d small: rms %.4f, mean %+.4f, worst %.3f; of one ray a pixel "
        "rms %.4f\n",
        count, partly, small, sqrt(square / count), sum / count, worst, sqrt(coarse_square / count));
    CHECK(count > 85 && partly > 40 && small > 60 && small < count);
    CHECK(sqrt(square / count) <= 0.02);
    CHECK(fabs(sum / count) <= 0.004);
    CHECK(sqrt(coarse_square / count) > 0.03);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(visible_fractions_are_those_of_many_rays)};
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
