/* Contact shadows: the light on shadowed ground, under hulls and on unlit sides, by sensor.sky_visibility, against
 * directions asked at every pixel (render/light/hemisphere.h, which two other renderers confirm), means of 5 x 5 px;
 * over models, suns and all bands. And the same bits whichever bands are asked for, on however many threads. labels:
 * physics slow */
#include "tests/check.h"

#include "sensor/quality/trial_private.h"
#include "terrain/ground/landscape.h"

enum { width = 160, height = 108, block_px = 5, reference_samples = 64 };

static const double most_percent[] = {5, 25, 25}; /* of each region, in every band; dark ones of little light */

static struct {
    LocalFrame frame;
    Landscape  landscape;
    Pool      *pool;
    Arena     *arena[3];
} stage;

static int open_stage(void **state)
{
    (void)state;
    const Geodetic origin = {0.8, 0.2, 500};
    double         times_s[2];
    for (int k = 0; k < 3; k++)
        if (!(stage.arena[k] = arena_create())) return -1;
    return pool_create(&stage.pool, 2) == STATUS_OK && local_frame_at(&stage.frame, &origin) == STATUS_OK &&
                   landscape_quick(&stage.landscape, times_s, &stage.frame, 2000, 2000, stage.pool) == STATUS_OK
               ? 0
               : -1;
}

static int close_stage(void **state)
{
    (void)state;
    landscape_destroy(&stage.landscape);
    for (int k = 0; k < 3; k++) arena_destroy(stage.arena[k]);
    pool_destroy(stage.pool);
    return 0;
}

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, truck = {1, 1, 222, 7, 1, 0, 0},
                           helicopter = {1, 2, 225, 20, 1, 0, 0}, building = {5, 1, 225, 1, 0, 0, 0};

typedef struct Case {
    const char          *name;
    const DisEntityType *type;
    double               hours, turn_rad, back_m, above_m, hfov_deg, k1; /* k1: of a lens */
} Case;

static const Case cases[] = {
    {"tank, 4 h later", &tank, 4, 2.0, 60, 15, 14, 0},
    {"truck, 5 h later, low eye", &truck, 5, -0.7, 60, 4, 12, 0},
    {"helicopter, 2 h later", &helicopter, 2, 0.8, 70, 20, 16, 0},
    {"building, 3 h later", &building, 3, 0.5, 90, 25, 16, 0},
    {"truck through a lens, 5 h later", &truck, 5, -0.7, 40, 3, 14, -6},
};

/* Shadowed ground; where less than 40 % of its open light comes; sides that face away from the sun. */
enum { REGION_SHADOW, REGION_DARK, REGION_SIDE, REGION_COUNT };
static const char *const region_name[REGION_COUNT] = {"shadowed ground", "under bodies", "unlit sides"};

typedef struct Found {
    double square[2], bias[2]; /* off, on */
    int    blocks;
} Found;

static void compare(Found found[REGION_COUNT], const Picture *exact, const float *value, const float *const of[2],
                    const float *lit, const double sun[3])
{
    for (int y0 = 0; y0 + block_px <= height; y0 += block_px)
        for (int x0 = 0; x0 + block_px <= width; x0 += block_px) {
            double sum[REGION_COUNT][3] = {{0}};
            int    count[REGION_COUNT] = {0};
            for (int y = y0; y < y0 + block_px; y++)
                for (int x = x0; x < x0 + block_px; x++) {
                    const size_t i = (size_t)(y * width + x);
                    if (!(exact->range_m[i] < INFINITY)) continue;
                    const double n[3] = {exact->normal[0][i], exact->normal[1][i], exact->normal[2][i]};
                    int          region;
                    if (exact->entity[i]) {
                        if (v3_dot(n, sun) > -0.05) continue;
                        region = REGION_SIDE;
                    } else {
                        if (lit[i] > 0.45f) continue; /* by the sun */
                        region = value[i] < 0.4f * of[0][i] ? REGION_DARK : REGION_SHADOW;
                    }
                    count[region]++;
                    sum[region][0] += (double)value[i];
                    sum[region][1] += (double)of[0][i];
                    sum[region][2] += (double)of[1][i];
                }
            for (int r = 0; r < REGION_COUNT; r++) {
                if (count[r] < (r == REGION_DARK ? 2 : 10)) continue; /* little is so dark on this ground */
                found[r].blocks++;
                for (int k = 0; k < 2; k++) {
                    const double e = sum[r][k + 1] / sum[r][0] - 1;
                    found[r].square[k] += e * e;
                    found[r].bias[k] += e;
                }
            }
        }
}

static void test_near_the_exact(void **state)
{
    (void)state;
    static float lit[width * height];
    int          judged[REGION_COUNT] = {0};
    char         catalog[512];
    CHECK(etc_path(catalog, sizeof catalog, "catalog.csv"));
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const Case *of = &cases[c];
        TrialScene  scene;
        TrialFrame  frame[3];
        assert_int_equal(trial_scene_open(&scene, &stage.landscape, catalog, of->type, 1, 0), STATUS_OK);
        scene.unix_s += 3600 * of->hours;
        detail_table_close(scene.world.detail); /* light alone: the directions do not see the noise's slopes */
        scene.world.detail = NULL;
        const TrialPlace place = {.type = *of->type, .number = 1, .turn_rad = of->turn_rad};
        assert_int_equal(trial_scene_place(&scene, &place), STATUS_OK);
        View view = trial_view(&scene, of->back_m, of->above_m, of->hfov_deg * rad_per_deg, width, height);
        if (of->k1 != 0) {
            const double half[2] = {0.5 * width / view.focal_px, 0.5 * height / view.focal_px};
            const double k[3] = {of->k1}, p[2] = {0};
            assert_int_equal(view_lens_make(&view.lens, k, p, half), STATUS_OK);
        }
        const RenderRequest request = {.view = view,
                                       .bands = 1 << BAND_OPTICAL | 1 << BAND_MWIR | 1 << BAND_LWIR,
                                       .truth = true,
                                       .optical = OPTICAL_RGB,
                                       .samples = 1,
                                       .hidden_entity = -1};
        double              s[3];
        for (int k = 0; k < 3; k++) {
            frame[k] = (TrialFrame){.scene = &scene, .request = request, .pool = stage.pool, .arena = stage.arena[k]};
            frame[k].request.sky_samples = k == 0 ? reference_samples : 0;
            frame[k].request.sky_visibility = k == 2;
            trial_frame(&frame[k]);
            assert_int_equal(frame[k].status, STATUS_OK);
            s[k] = frame[k].stage_s[STAGE_FRAME];
        }
        const Picture *exact = &frame[0].picture, *quick[2] = {&frame[1].picture, &frame[2].picture};
        double         brightest = 0, sorted = 0;
        for (int i = 0; i < width * height; i++)
            if (!exact->entity[i] && exact->range_m[i] < INFINITY)
                brightest += (double)quick[0]->optical[0][i], sorted++;
        for (int i = 0; i < width * height; i++)
            lit[i] = (float)((double)quick[0]->optical[0][i] / (brightest / sorted));
        print_message("%s: sun %.0f deg, %.1f s, %.1f ms, %.1f ms\n", of->name,
                      asin(frame[0].air.light.sun_d_enu[2]) / rad_per_deg, s[0], 1e3 * s[1], 1e3 * s[2]);
        static const char *const plane_name[] = {"r", "g", "b", "mwir", "lwir"};
        for (int plane = 0; plane <= picture_lwir; plane++) {
            Found              found[REGION_COUNT] = {0};
            const float *const values[2] = {picture_plane(quick[0], plane), picture_plane(quick[1], plane)};
            compare(found, exact, picture_plane(exact, plane), values, lit, frame[0].air.light.sun_d_enu);
            for (int r = 0; r < REGION_COUNT; r++)
                if (found[r].blocks > 3) {
                    const double percent = 100 * sqrt(found[r].square[1] / found[r].blocks);
                    print_message("  %s, %s: off %.1f %% rms, bias %.1f; on %.1f %% rms, bias %.1f (%d)\n",
                                  plane_name[plane], region_name[r], 100 * sqrt(found[r].square[0] / found[r].blocks),
                                  100 * found[r].bias[0] / found[r].blocks,
                                  100 * sqrt(found[r].square[1] / found[r].blocks),
                                  100 * found[r].bias[1] / found[r].blocks, found[r].blocks);
                    if (!(percent <= most_percent[r]))
                        fail_msg("%s, %s: %.1f %%", plane_name[plane], region_name[r], percent);
                    judged[r]++;
                }
        }
        trial_scene_close(&scene);
    }
    for (int r = 0; r < REGION_COUNT; r++) assert_true(judged[r] > 0);
}

static void test_any_company(void **state)
{
    (void)state;
    char       catalog[512];
    TrialScene scene;
    Pool      *one;
    CHECK(etc_path(catalog, sizeof catalog, "catalog.csv"));
    assert_int_equal(pool_create(&one, 1), STATUS_OK);
    assert_int_equal(trial_scene_open(&scene, &stage.landscape, catalog, &tank, 1, 4), STATUS_OK);
    TrialFrame frame[3];
    for (int k = 0; k < 3; k++) {
        frame[k] = (TrialFrame){.scene = &scene, .pool = k == 1 ? one : stage.pool, .arena = stage.arena[k]};
        frame[k].request = (RenderRequest){.view = trial_view(&scene, 150, 15, 12 * rad_per_deg, width, height),
                                           .bands = k == 2 ? 1 << BAND_LWIR : 1 << BAND_OPTICAL | 1 << BAND_LWIR,
                                           .truth = true,
                                           .optical = OPTICAL_RGB,
                                           .samples = 1,
                                           .edge_samples = 4,
                                           .target_samples = 32,
                                           .hidden_entity = -1,
                                           .sky_visibility = true,
                                           .skips_off = k == 1 ? skips_all_off : 0};
        trial_frame(&frame[k]);
        assert_int_equal(frame[k].status, STATUS_OK);
    }
    const size_t bytes = sizeof(float) * width * height;
    for (int c = 0; c < 3; c++) assert_memory_equal(frame[0].picture.optical[c], frame[1].picture.optical[c], bytes);
    assert_memory_equal(frame[0].picture.lwir, frame[1].picture.lwir, bytes);
    assert_memory_equal(frame[0].picture.lwir, frame[2].picture.lwir, bytes);
    pool_destroy(one);
    trial_scene_close(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_near_the_exact), cmocka_unit_test(test_any_company)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
