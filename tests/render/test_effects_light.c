/* What lights a puff of smoke, by hand: sun, sky and ground scattered, its own emission, the shade of its cloud, and
 * the air before hot gas. labels: physics */
#include "tests/check.h"

#include "render/smoke/smoke.h"

static EffectTable  effects;
static LocalFrame   frame;
static PlanckTable *mwir, *lwir;
static Arena       *arena;

static int open_all(void **state)
{
    (void)state;
    char           path[512];
    const Geodetic origin = {0.6, -2.1, 0};
    arena = arena_create();
    return arena && local_frame_at(&frame, &origin) == STATUS_OK && etc_path(path, sizeof path, "effects.csv") &&
                   effect_table_open(&effects, path) == STATUS_OK &&
                   planck_table_create(&mwir, 3.4e-6, 4.8e-6) == STATUS_OK &&
                   planck_table_create(&lwir, 8e-6, 12e-6) == STATUS_OK
               ? 0
               : -1;
}

static int close_all(void **state)
{
    (void)state;
    planck_table_destroy(mwir);
    planck_table_destroy(lwir);
    arena_destroy(arena);
    return 0;
}

/* At birth, so that neither wind nor rise has moved it; twice the radius of its row. */
static EffectPuff puff_at(EffectKind kind, double east_m, double north_m, double up_m, double mass_kg)
{
    EffectPuff   puff = {.kind = kind, .throw_s = 1, .scale = 2, .mass_kg = mass_kg};
    const double p_enu[3] = {east_m, north_m, up_m};
    ecef_from_enu(puff.p_ecef, &frame, p_enu);
    for (int i = 0; i < 3; i++) puff.up_ecef[i] = puff.axis_ecef[i] = frame.r_ecef_from_enu[3 * i + 2];
    return puff;
}

/* Towards the north from a height. */
static EffectScene scene_of(EffectPuff *puff, int count, const Air *air, double eye_up_m)
{
    static const float ground_rho[optical_channel_count] = {0.25f, 0.25f, 0.25f, 0.25f, 0.25f};
    const Snapshot     snapshot = {.puff_count = count, .puff = puff, .effect_table = &effects};
    const View         view = {.p_enu = {0, 0, eye_up_m},
                               .width = 64,
                               .height = 64,
                               .focal_px = 60,
                               .r_enu_from_cam = {1, 0, 0, 0, 0, 1, 0, -1, 0}};
    EffectScene        scene;
    arena_reset(arena);
    CHECK(smoke_effects_scene(&scene, &snapshot,
                              &(EffectView){.frame = &frame,
                                            .view = &view,
                                            .ground_rho = ground_rho,
                                            .bands = (1u << effect_band_count) - 1,
                                            .hidden = -1},
                              air, arena) == STATUS_OK);
    CHECK(scene.count == count);
    return scene;
}

/* The sun behind the eye and 37 degrees up, of 1000 W/m2; sky and ground of one radiance a band; nothing between. */
static void even(Air *air, double sky_w_m2_sr)
{
    double sky[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) sky[b] = sky_w_m2_sr;
    air_even(air, (const double[3]){0, -0.8, 0.6}, 1000, sky, 0, mwir, lwir);
}

/* Burst dust in red: albedo 0.86, asymmetry 0.6. Sky of 20 W/(m2 sr); ground of 0.25 below it: 0.25 (1000 0.6 / pi +
 * 20) = 52.746. Half of each over the albedo: 0.43 (20 + 52.746) = 31.281, and 0.43 (20 - 52.746) = -14.081 from top to
 * bottom. Henyey and Greenstein at a cosine of -0.8, (1 - g^2) / (4 pi (1 + g^2 - 2 g c)^1.5): 0.014413 at 0.6,
 * 0.036812 at 0.3, 0.054837 at 0.15; times 860, 430, 215 W/m2. */
static void sun_sky_and_ground_are_scattered(void **state)
{
    (void)state;
    static Air air;
    EffectPuff puff = puff_at(EFFECT_BURST_DUST, 0, 500, 0, 0.01);
    even(&air, 20);
    const EffectScene  scene = scene_of(&puff, 1, &air, 0);
    const SmokeVolume *v = &scene.volume[0];
    CHECK_NEAR(v->source[effect_band_r], 31.281, 2e-3);
    CHECK_NEAR(v->from_top[effect_band_r], -14.081, 2e-3);
    static const double want[3] = {12.395, 15.829, 11.790};
    CHECK(smoke_scatter_orders == 3);
    for (int order = 0; order < 3; order++) CHECK_NEAR(v->sun[effect_band_r][order], want[order], 2e-3);
    /* towards the sun it is 9 times brighter: 0.64 / (4 pi (1.36 - 0.96)^1.5) = 0.20132 at +0.8 */
    even(&air, 20);
    for (int k = 0; k < 2; k++) air.light.sun_d_enu[k] *= -1;
    CHECK_NEAR(scene_of(&puff, 1, &air, 0).volume[0].sun[effect_band_r][0], 860 * 0.20132, 0.02);
    /* every band has its own albedo: 0.72, 0.80, 0.86, their mean, 0.88 (etc/effects.csv) */
    static const double albedo[5] = {0.72, 0.80, 0.86, 2.38 / 3, 0.88};
    static const int    band[5] = {effect_band_b, effect_band_g, effect_band_r, effect_band_pan, effect_band_nir};
    even(&air, 20);
    const EffectScene again = scene_of(&puff, 1, &air, 0);
    for (int b = 0; b < 5; b++) CHECK_NEAR(again.volume[0].sun[band[b]][0] / 12.395, albedo[b] / 0.86, 2e-4);
}

/* In 8 .. 12 um: albedo 0.44 of which 0.62^2 goes on forward: 0.44 0.6156 / (1 - 0.44 0.3844) = 0.32600; in 3.4 .. 4.8
 * um 0.85: 0.77720. The thicker the volume, the less it scatters of what falls onto it. 15 K over the air's 288.15 K;
 * sky of 25, ground of 30 W/(m2 sr): half of each over the albedo, the rest of Planck's radiance. The sun is scattered
 * evenly there: a grain's albedo 1000 / (4 pi). */
static void it_emits_and_scatters_what_is_about_it(void **state)
{
    (void)state;
    static Air air;
    EffectPuff puff = puff_at(EFFECT_BURST_DUST, 0, 500, 0, 0.01);
    even(&air, 25);
    air.light.ground_w_m2_sr[AIR_LWIR] = air.light.ground_w_m2_sr[AIR_MWIR] = 30;
    const double        temp_k = weather_default().air_temp_k + 15;
    const EffectScene   scene = scene_of(&puff, 1, &air, 0);
    const SmokeVolume  *v = &scene.volume[0];
    static const double grain[2] = {0.77720, 0.32600};
    double              albedo[2];
    for (int k = 0; k < 2; k++) {
        const int    band = k ? effect_band_lwir : effect_band_mwir;
        const double thick = smoke_thick_albedo(grain[k]), depth = v->extinction_per_m[band] * 16 / 15 * v->across_m;
        CHECK(depth > 0.01 && depth < 3);
        albedo[k] = thick + (grain[k] - thick) * exp(-depth);
    }
    CHECK_NEAR(v->source[effect_band_lwir],
               0.5 * albedo[1] * 55 + (1 - albedo[1]) * planck_band(8e-6, 12e-6, temp_k, NULL), 1e-3);
    CHECK_NEAR(v->from_top[effect_band_lwir], 0.5 * albedo[1] * -5, 1e-4);
    CHECK_NEAR(v->source[effect_band_mwir],
               0.5 * albedo[0] * 55 + (1 - albedo[0]) * planck_band(3.4e-6, 4.8e-6, temp_k, NULL), 1e-3);
    CHECK_NEAR(v->from_top[effect_band_mwir], 0.5 * albedo[0] * -5, 1e-4);
    CHECK_NEAR(v->sun[effect_band_mwir][0], 1000 * grain[0] / (4 * pi_rad), 1e-2);
    CHECK_NEAR(v->sun[effect_band_lwir][1], 500 * grain[1] / (4 * pi_rad), 1e-2);
    /* raised from ground 30 K over the air, at birth by three tenths of that; with no ground known, by nothing */
    air.light.ground_k = weather_default().air_temp_k + 30;
    const EffectScene warm = scene_of(&puff, 1, &air, 0);
    CHECK_NEAR(warm.volume[0].source[effect_band_lwir],
               0.5 * albedo[1] * 55 + (1 - albedo[1]) * planck_band(8e-6, 12e-6, temp_k + 9, NULL), 1e-3);
    /* which fades as its own excess does: with 2 s */
    const Weather weather = weather_default();
    EffectVolume  volume;
    for (puff.age_s = 0; puff.age_s < 8; puff.age_s += 0.5) {
        CHECK(effect_volume(&volume, &effects, &puff, &weather, &frame));
        CHECK_NEAR(volume.ground_share, 0.3 * exp(-puff.age_s / 2), 1e-12);
    }
}

/* Of two puffs of one cloud, 1 m of radius and 3 m apart towards the sun, the far one is in the shade of the other, by
 * 16 / 15 m of its density at the centre, whichever comes first; the near one is not; nor are those of two clouds. */
static void puffs_of_a_cloud_shade_each_other(void **state)
{
    (void)state;
    static Air air;
    even(&air, 20);
    for (int k = 0; k < 4; k++) {
        const int  far = k == 1;
        EffectPuff puff[2] = {puff_at(EFFECT_BURST_DUST, 0, far ? 500 - 2.4 : 500, far ? 1.8 : 0, 0.01),
                              puff_at(EFFECT_BURST_DUST, 0, far ? 500 : 500 - 2.4, far ? 0 : 1.8, 0.01)};
        puff[0].group = k == 3 ? 8 : 7, puff[1].group = k == 2 ? 8 : 7;
        const EffectScene scene = scene_of(puff, 2, &air, 0);
        CHECK(scene.volume[0].range_m < scene.volume[1].range_m); /* nearest first: that towards the sun */
        for (int b = 0; b < effect_band_count; b++) {
            const double depth = scene.volume[0].extinction_per_m[b] * 16.0 / 15;
            CHECK(scene.volume[0].sun_depth[b] == 0 && depth > 0);
            CHECK_NEAR(scene.volume[1].sun_depth[b] / depth, k >= 2 ? 0 : 1, 1e-6);
        }
    }
}

/* The air before hot gas counts at sea-level density: 500 m at 4000 m, of a scale height of 8000 m, are exp(-0.5) 500 =
 * 303.27 m; from the ground to 1000 m up and 3000 m off, a mean of 500 m, 3162.28 m are 2970.68 m. */
static void thin_air_takes_less_of_hot_gas(void **state)
{
    (void)state;
    static const double north_m[2] = {500, 3000}, up_m[2] = {4000, 1000}, eye_m[2] = {4000, 0},
                        counts_m[2] = {303.2653, 2970.6849};
    static Air air;
    even(&air, 20);
    for (int k = 0; k < 2; k++) {
        double            want[hot_gas_passed_nodes];
        EffectPuff        puff = puff_at(EFFECT_JET_EXHAUST, 0, north_m[k], up_m[k], 0.3);
        const EffectScene scene = scene_of(&puff, 1, &air, eye_m[k]);
        CHECK(scene.volume[0].gas != NULL);
        smoke_gas_passed_at(want, weather_default().air_temp_k + 480, counts_m[k]);
        for (int n = 0; n < hot_gas_passed_nodes; n++) CHECK_NEAR(scene.volume[0].gas->passed[n], want[n], 1e-6);
    }
}

/* The pattern of a puff begins anywhere in 256 radii a side, as its seed draws, and rises through its outline by a
 * quarter of a radius a second: its origin goes down. */
static void its_pattern_rises(void **state)
{
    (void)state;
    static Air air;
    double     least[3] = {1e9, 1e9, 1e9}, most[3] = {0, 0, 0}, before[3] = {-1, -1, -1};
    even(&air, 20);
    for (uint32_t seed = 1; seed <= 200; seed++) {
        EffectPuff puff = puff_at(EFFECT_BURST_DUST, 0, 500, 0, 0.01);
        double     young[3];
        puff.seed = seed;
        memcpy(young, scene_of(&puff, 1, &air, 0).volume[0].pattern, sizeof young);
        for (int k = 0; k < 3; k++) {
            least[k] = fmin(least[k], young[k]), most[k] = fmax(most[k], young[k]);
            CHECK(young[k] != before[k] && young[k] != young[(k + 1) % 3]);
            before[k] = young[k];
        }
        puff.age_s = 3;
        const EffectScene old = scene_of(&puff, 1, &air, 0);
        CHECK(old.volume[0].pattern[0] == young[0] && old.volume[0].pattern[1] == young[1]);
        CHECK_NEAR(old.volume[0].pattern[2] - young[2], -0.75, 1e-12);
    }
    for (int k = 0; k < 3; k++) CHECK(least[k] >= 0 && least[k] < 10 && most[k] > 246 && most[k] < 256);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sun_sky_and_ground_are_scattered),
        cmocka_unit_test(it_emits_and_scatters_what_is_about_it),
        cmocka_unit_test(puffs_of_a_cloud_shade_each_other),
        cmocka_unit_test(thin_air_takes_less_of_hot_gas),
        cmocka_unit_test(its_pattern_rises),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
