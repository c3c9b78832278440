/* Frames of a town: what its pixels say of it, targets that it hides, its shadows on the ground and on a target, the
 * same bits with any number of threads, and no bit of it where there is none. labels: two */
#include "tests/check.h"

#include "sensor/quality/trial_private.h"
#include "tests/scenes/town.h"

static struct {
    LocalFrame frame;
    Landscape  landscape;
    TrialScene bare, town;
    Scenery    scenery;
    Pool      *one, *two;
    Arena     *arena[3];
} stage;

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0};

/* One house, 60 m north of the origin, that hides a tank behind it from the south. */
static Status build_house(void)
{
    const TownOf of = {
        .buildings = 25, .clutter = 12, .movers = 4, .middle_enu = {0, 100}, .landscape = &stage.landscape, .seed = 3};
    return town_create(&stage.scenery, &of);
}

static int open_stage(void **state)
{
    (void)state;
    const Geodetic origin = {0.8, 0.2, 500};
    double         times_s[2];
    char           catalog[512];
    for (int k = 0; k < 3; k++) stage.arena[k] = arena_create();
    if (!etc_path(catalog, sizeof catalog, "catalog.csv") || pool_create(&stage.one, 1) != STATUS_OK ||
        pool_create(&stage.two, 2) != STATUS_OK || local_frame_at(&stage.frame, &origin) != STATUS_OK ||
        landscape_quick(&stage.landscape, times_s, &stage.frame, 1500, 1500, stage.two) != STATUS_OK)
        return -1;
    for (int k = 0; k < 2; k++) {
        TrialScene *scene = k ? &stage.town : &stage.bare;
        if (trial_scene_open(scene, &stage.landscape, catalog, &tank, 1, 0) != STATUS_OK) return -1;
        for (int n = 0; n < 24; n++) {
            const TrialPlace place = {
                .type = tank, .number = n + 1, .east_m = 10.0 * n - 120, .north_m = n % 2 ? 176 : 40};
            if (trial_scene_place(scene, &place) != STATUS_OK) return -1;
        }
    }
    return build_house() == STATUS_OK && world_scenery(&stage.town.world, &stage.scenery, NULL, stage.two) == STATUS_OK
               ? 0
               : -1;
}

static int close_stage(void **state)
{
    (void)state;
    trial_scene_close(&stage.bare);
    trial_scene_close(&stage.town);
    scenery_free(&stage.scenery);
    landscape_destroy(&stage.landscape);
    pool_destroy(stage.one);
    pool_destroy(stage.two);
    for (int k = 0; k < 3; k++) arena_destroy(stage.arena[k]);
    return 0;
}

static TrialFrame frame_of(const TrialScene *scene, Pool *pool, Arena *arena, double above_m)
{
    TrialFrame frame = {.scene = scene, .pool = pool, .arena = arena};
    frame.request = (RenderRequest){.view = trial_view(scene, 120, above_m, 0.9, 160, 108),
                                    .bands = 15,
                                    .truth = true,
                                    .optical = OPTICAL_RGB,
                                    .samples = 1,
                                    .edge_samples = 4,
                                    .target_samples = 32,
                                    .sky_visibility = true,
                                    .t_s = 40,
                                    .hidden_entity = -1};
    trial_frame(&frame);
    assert_int_equal(frame.status, STATUS_OK);
    return frame;
}

/* Scenery has a part, an instance and a material, and is no entity; its radiances are finite, and its temperatures. */
static void pixels_say_what_they_show(void **state)
{
    (void)state;
    const TrialFrame frame = frame_of(&stage.town, stage.two, stage.arena[0], 25);
    const Picture   *p = &frame.picture;
    const Materials *m = &stage.town.world.materials;
    const int        brick = materials_find(m, "brick_red"), tile = materials_find(m, "roof_tile_clay");
    int              shown = 0, bricks = 0, tiles = 0;
    CHECK(p->instance != NULL);
    for (int i = 0; i < p->width * p->height; i++) {
        if (p->part[i] == 0) CHECK(p->instance[i] == 0 && p->entity[i] == 0);
        if (p->part[i] == 0 || p->entity[i]) continue;
        const uint32_t object = p->instance[i] - 1;
        shown++;
        CHECK(object < (uint32_t)stage.scenery.objects);
        const Model *model = &stage.scenery.model[stage.scenery.object[object].model];
        CHECK(p->part[i] <= (uint32_t)model->part_count);
        CHECK(strcmp(m->material[p->material[i]].name, model->part[p->part[i] - 1].material) == 0);
        CHECK(p->cover[i] == 0 && p->range_m[i] < 1000 && p->temp_k[i] > 250 && p->temp_k[i] < 350);
        CHECK(isfinite(p->optical[0][i]) && p->lwir[i] > 0 && p->mwir[i] > 0 && isfinite(p->radar[i]));
        bricks += p->material[i] == (uint32_t)brick, tiles += p->material[i] == (uint32_t)tile;
    }
    print_message("%d pixels of scenery, %d brick, %d tile\n", shown, bricks, tiles);
    CHECK(shown > 600 && bricks > 200 && tiles > 150);
}

/* Areas of each target add up, and of those behind houses some are hidden by scenery, which truth names. */
static void truth_names_what_hides(void **state)
{
    (void)state;
    const TrialFrame frame = frame_of(&stage.town, stage.two, stage.arena[0], 6),
                     bare = frame_of(&stage.bare, stage.two, stage.arena[1], 6);
    TruthNoise    noise = {0};
    EyeState      eye = {.host_index = -1};
    static Target target[64];
    int           named = 0;
    (void)bare;
    for (int k = 0; k < frame.snapshot.count; k++) {
        const TargetPixels *t = &frame.picture.target[k], *b = &bare.picture.target[k];
        CHECK_NEAR(t->visible + t->occluded_ground + t->occluded_entity + t->occluded_plants + t->occluded_scenery,
                   t->amodal, 0.02 * t->amodal + 0.1);
        CHECK(b->occluded_scenery == 0 && t->visible <= b->visible * 1.02 + 0.2);
        CHECK_NEAR(t->amodal, b->amodal, 0.03 * b->amodal + 0.3);
    }
    ecef_from_enu(eye.p_ecef, &stage.town.world.frame, frame.request.view.p_enu);
    m3_mul(eye.r_ecef_from_cam, stage.town.world.frame.r_ecef_from_enu, frame.request.view.r_enu_from_cam);
    const int count =
        truth_targets(target, &frame.picture, &stage.town.world, &frame.snapshot, &frame.request, &eye, &noise);
    for (int k = 0; k < count; k++) {
        const TargetPixels *t = &frame.picture.target[target[k].index];
        if (!(t->occluded_scenery > 0.5 * t->amodal)) continue;
        assert_string_equal(target[k].occluder, "scenery");
        CHECK(target[k].visible_fraction < 0.5 && target[k].occluder_index < 0);
        named++;
    }
    print_message("%d of %d targets are hidden by scenery\n", named, count);
    CHECK(named >= 3);
}

/* Where the ground or a target shows in both and is darker with houses, the sun is behind one; much of it is. */
static void shadows_fall_on_ground_and_targets(void **state)
{
    (void)state;
    TrialScene *scene[2] = {&stage.bare, &stage.town};
    TrialFrame  frame[2];
    int         ground = 0, shaded = 0, same = 0;
    for (int k = 0; k < 2; k++) {
        scene[k]->unix_s += 5.5 * 3600; /* a lower sun */
        frame[k] = frame_of(scene[k], stage.two, stage.arena[k], 40);
        scene[k]->unix_s -= 5.5 * 3600;
    }
    const Picture *bare = &frame[0].picture, *town = &frame[1].picture;
    for (int i = 0; i < bare->width * bare->height; i++) {
        if (town->part[i] || bare->part[i] || !(town->range_m[i] < INFINITY)) continue;
        CHECK(town->range_m[i] == bare->range_m[i]);
        ground++;
        shaded += town->optical[0][i] < 0.6f * bare->optical[0][i];
        same += town->optical[0][i] > 0.85f * bare->optical[0][i];
    }
    print_message("%d of %d pixels of ground in the shadow of houses, %d in the light\n", shaded, ground, same);
    CHECK(shaded > ground / 60 && same > ground / 4);
}

static void any_number_of_threads(void **state)
{
    (void)state;
    char             hash[2][sha256_text_size];
    const TrialFrame frame[2] = {frame_of(&stage.town, stage.two, stage.arena[0], 25),
                                 frame_of(&stage.town, stage.one, stage.arena[1], 25)};
    for (int k = 0; k < 2; k++) assert_int_equal(trial_frame_hash(hash[k], &frame[k]), STATUS_OK);
    assert_string_equal(hash[0], hash[1]);
}

/* A scenery without objects is none. */
static void nothing_is_nothing(void **state)
{
    (void)state;
    const Scenery    none = {0};
    char             hash[2][sha256_text_size];
    const TrialFrame before = frame_of(&stage.bare, stage.two, stage.arena[0], 25);
    assert_int_equal(trial_frame_hash(hash[0], &before), STATUS_OK);
    assert_int_equal(world_scenery(&stage.bare.world, &none, NULL, stage.two), STATUS_OK);
    CHECK(stage.bare.world.scenery == NULL && stage.bare.world.horizons == NULL);
    const TrialFrame after = frame_of(&stage.bare, stage.two, stage.arena[1], 25);
    assert_int_equal(trial_frame_hash(hash[1], &after), STATUS_OK);
    assert_string_equal(hash[0], hash[1]);
    CHECK(after.picture.instance == NULL && after.picture.counters.visibility.rays_scenery == 0);
}

/* Red and 8-12 um: root mean squared error of one picture beside another, % of the mean. */
static double error_percent(const Picture *got, const Picture *want, int plane)
{
    const float *a = picture_plane(got, plane), *b = picture_plane(want, plane);
    const int    count = got->width * got->height;
    double       square = 0, mean = 0;
    for (int i = 0; i < count; i++) {
        square += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]) / count;
        mean += (double)b[i] / count;
    }
    return 100 * sqrt(square) / mean;
}

/* Pixels of 0.65 m: houses are a texture, and are sampled again near targets alone. Against 36 rays in every pixel. */
static void far_houses_are_a_texture(void **state)
{
    (void)state;
    TrialFrame    all = frame_of(&stage.town, stage.two, stage.arena[0], 40);
    TrialFrame    texture = frame_of(&stage.town, stage.two, stage.arena[1], 40);
    RenderRequest request = all.request;
    Picture       whole, fine;
    request.scenery_px_m = 100;
    assert_int_equal(render(&whole, &stage.town.world, &all.snapshot, &request, &all.air, stage.two, stage.arena[0]),
                     STATUS_OK);
    request.samples = 6, request.edge_samples = 0;
    assert_int_equal(render(&fine, &stage.town.world, &all.snapshot, &request, &all.air, stage.two, stage.arena[0]),
                     STATUS_OK);
    const Picture *few = &texture.picture;
    const uint64_t edges = few->counters.rays_edges, edges_all = whole.counters.rays_edges;
    const double   red[2] = {error_percent(few, &fine, 0), error_percent(&whole, &fine, 0)};
    const double   lwir[2] = {error_percent(few, &fine, picture_lwir), error_percent(&whole, &fine, picture_lwir)};
    int            targets = 0;
    for (int i = 0; i < few->width * few->height; i++) {
        if (!few->entity[i]) continue;
        targets++;
        CHECK(few->lwir[i] == whole.lwir[i] && few->optical[0][i] == whole.optical[0][i]);
    }
    print_message("%llu rays at edges of %llu; red %.1f %% off (%.1f), 8-12 um %.2f %% (%.2f); %d pixels of targets\n",
                  (unsigned long long)edges, (unsigned long long)edges_all, red[0], red[1], lwir[0], lwir[1], targets);
    CHECK(targets > 30 && (double)edges < 0.8 * (double)edges_all);
    CHECK(red[1] < red[0] && red[0] < 25 && lwir[0] < 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixels_say_what_they_show),
        cmocka_unit_test(truth_names_what_hides),
        cmocka_unit_test(shadows_fall_on_ground_and_targets),
        cmocka_unit_test(any_number_of_threads),
        cmocka_unit_test(nothing_is_nothing),
        cmocka_unit_test(far_houses_are_a_texture),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
