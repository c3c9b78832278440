/* The quick form of surfaces' light against the plain one of render/light/optical.c and thermal.c, on random hits of
 * every class, slope, sun and view; and that a hit's bits do not hang on its company. labels: physics */
#include "tests/render/hand_world.h"

#include "render/light/surface_light.h"
#include "render/light/optical.h"

enum { hits_count = 1016, suns = 4 };

static Hits     hits;
static Rays     rays;
static AirPaths veils[AIR_BAND_COUNT];
static uint16_t material[hits_capacity];
static float    arrives[hits_capacity];
static float    texture[hits_capacity], warmth_k[hits_capacity], temp_k[hits_capacity], around[hits_capacity],
    open[hits_capacity], below[hits_capacity];

static int open_world(void **state)
{
    (void)state;
    return hand_open(true);
}

static void direction(double d[3], double up_low, double up_high)
{
    const double up = hand_uniform(up_low, up_high), turn = hand_uniform(0, 2 * pi_rad), flat = sqrt(1 - up * up);
    d[0] = flat * cos(turn), d[1] = flat * sin(turn), d[2] = up;
}

/* Surfaces before an eye at 300 m, of the ground's classes or of any material; every third looks near the mirror of the
 * sun, where water and paint flash. */
static void random_hits(const double sun_enu[3], bool ground)
{
    hits.count = rays.count = hits_count;
    for (int i = 0; i < hits_count; i++) {
        double n[3], d[3];
        direction(n, i % 4 == 0 ? 0.2 : 0.98, 1);
        if (i % 50 == 0) n[0] = n[1] = 0, n[2] = 1;
        if (i % 3 == 0) {
            double lean[3];
            direction(lean, -1, 1);
            const double c = v3_dot(n, sun_enu);
            for (int k = 0; k < 3; k++) d[k] = sun_enu[k] - 2 * c * n[k] + 0.1 * lean[k];
            v3_normalize(d, d);
        }
        if (i % 3 != 0 || v3_dot(n, d) > -0.01 || d[2] > -0.01) do
                direction(d, -1, -0.02);
            while (v3_dot(n, d) > -0.01);
        hits.range_m[i] = fmin(300 / -d[2], 20000);
        for (int k = 0; k < 3; k++) {
            rays.o_enu[k][i] = k == 2 ? 300 : 0;
            rays.d_enu[k][i] = d[k];
            hits.p_enu[k][i] = rays.o_enu[k][i] + hits.range_m[i] * d[k];
            hits.n_enu[k][i] = hits.n_geo[k][i] = (float)n[k];
        }
        /* runs of one class and mixtures */
        hits.surface[i] = (uint8_t)(1 + (i < 500 ? i / 8 : (int)hand_uniform(0, 1e4)) % (SURFACE_COUNT - 1));
        material[i] = (uint16_t)(ground ? hand.world.materials.surface[hits.surface[i]]
                                        : (i < 500 ? i / 8 : (int)hand_uniform(0, 1e4)) % hand.world.materials.count);
        arrives[i] = (float)fmax(0, fmin(1, hand_uniform(-0.5, 2))); /* none, some or all of the sun */
        texture[i] = (float)hand_uniform(0.6, 1.4);
        around[i] = (float)hand_uniform(1, 100);
        open[i] = (float)hand_uniform(0, 1.5), below[i] = (float)hand_uniform(0, 2);
    }
}

/* Error of the quick form over the plain one, of the worst hit rougher than `least_rad`. */
static double worst(AirBand band, const float *quick, const float *plain, double least_rad, double limit)
{
    double most = 0;
    for (int i = 0; i < hits_count; i++) {
        if (!((double)hand.world.materials.material[material[i]].roughness >= least_rad) || material[i] == 0) continue;
        const double error = fabs((double)quick[i] - (double)plain[i]) / (double)plain[i];
        if (!(error <= most)) most = error;
        if (!(error < limit))
            print_message("band %d, %s: %g for %g\n", (int)band, hand.world.materials.material[material[i]].name,
                          (double)quick[i], (double)plain[i]);
    }
    return most;
}

/* Light of a hit from all around, in the open by its factor or as gathered, and the factor on the sky in its mirror:
 * what the ground below leaves of it, over that of the open sky; of planes that see less than a sixteenth of the sky,
 * over that. */
static void light_by_hand(float *all_w_m2, float *mirror_sky, AirBand b, int i, bool contact)
{
    const Daylight *light = &hand.air.light;
    const double    n[3] = {hits.n_enu[0][i], hits.n_enu[1][i], hits.n_enu[2][i]};
    const double    level_w_m2 = b >= AIR_MWIR ? pi_rad * light->ground_w_m2_sr[b]
                                               : optical_ground_w_m2((int)b, &hand.air, &hand.world.materials);
    const double    sky = daylight_on_plane(light, b, n), ground = 0.5 * (1 - n[2]) * level_w_m2;
    const double    all = contact ? (double)open[i] * (sky + ground) : (double)around[i];
    const double    least = light->sky_w_m2[b] / 16, left = all - (double)below[i] * ground;
    *all_w_m2 = (float)all;
    *mirror_sky = (float)(sky > least ? left / sky : 1 + (left - sky) / least);
    if (!(*mirror_sky > 0)) *mirror_sky = 0;
    if (*mirror_sky > 100) *mirror_sky = 100;
}

/* Float holds 6e-8. What is left are the sky's tables, whose places are found within some 1e-5 of a step; and where a
 * smooth surface flashes, the half angle: its tangent is good to 1e-7, of slopes of 0.06 (water) or 0.01 (window
 * glass), and counts squared, times up to 40 at the foot of the lobe. */
static void compare(bool ground, double least_rad, double limit)
{
    static float        quick[AIR_BAND_COUNT][hits_capacity], plain[hits_capacity];
    static SurfaceLight light;
    const double        sun[suns][3] = {{-0.48, 0.36, 0.8}, {0, 0, 1}, {0.99, 0.1, 0.1}, {0.6, 0.7, -0.4}};
    const Materials    *m = &hand.world.materials;
    hand_draw = 5;
    for (int run = 0; run < 4 * suns; run++) {
        const int mode = run % 4; /* open; gathered; gathered with what is below; contact shadows */
        double    sun_enu[3] = {0};
        CHECK(v3_normalize(sun_enu, sun[run / 4]));
        arena_reset(hand.air_arena);
        hand_air_on(sun_enu, 300);
        random_hits(sun_enu, ground);
        assert_int_equal(surface_light_prepare(&light, &hand.air, m, hand.air_arena), STATUS_OK);
        thermal_temperature(temp_k, &hand.air, m, NULL, &hits, material, arrives, texture, warmth_k);
        air_paths_of(veils, &hand.air, (1 << AIR_BAND_COUNT) - 1, &hits, &rays, temp_k);
        float       *out[AIR_BAND_COUNT];
        SurfaceBlock block = {
            .hits = &hits, .rays = &rays, .material = material, .temp_k = temp_k, .sun = arrives, .veils = veils};
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            out[b] = quick[b];
            block.texture[b] = texture;
            if (mode == 1 || mode == 2) block.around_w_m2[b] = around;
            if (mode == 3) block.open[b] = open;
            if (mode >= 2) block.below[b] = below;
        }
        surface_light_shade(out, &light, &block);
        double most = 0;
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            float             all[hits_capacity], sky[hits_capacity];
            const MirrorLight shown = {sky, below};
            for (int i = 0; i < hits_count; i++) light_by_hand(&all[i], &sky[i], (AirBand)b, i, mode == 3);
            const float       *lit_by = mode == 0 ? NULL : all;
            const MirrorLight *mirror = mode >= 2 ? &shown : NULL;
            if (b < optical_channel_count)
                optical_shade(plain, b, &hand.air, m, &hits, &rays, material, texture, arrives, lit_by, mirror,
                              &veils[b], NULL);
            else
                thermal_shade(plain, b == AIR_MWIR ? BAND_MWIR : BAND_LWIR, &hand.air, m, &hits, &rays, material,
                              temp_k, arrives, lit_by, mirror, &veils[b], NULL);
            const double here = worst((AirBand)b, quick[b], plain, least_rad, limit);
            if (!(here <= most)) most = here;
        }
        print_message("sun %d, light %d: %.1e\n", run / 4, mode, most);
        CHECK(most < limit);
    }
}

static void ground_agrees_with_the_plain_form(void **state)
{
    (void)state;
    compare(true, 0, 3e-5);
}

static void materials_agree_with_the_plain_form(void **state)
{
    (void)state;
    compare(false, 0.05, 3e-5);
    compare(false, 0, 1e-3);
}

/* Moved by some places and with neighbours of other classes, and asked for one band alone: the same bits. */
static void company_changes_no_bit(void **state)
{
    (void)state;
    static float        all[AIR_BAND_COUNT][hits_capacity], one[hits_capacity];
    static SurfaceLight light;
    static Hits         few;
    static Rays         few_rays;
    static AirPaths     few_veils[AIR_BAND_COUNT];
    float               few_texture[hits_capacity], few_temp_k[hits_capacity];
    float               few_arrives[hits_capacity];
    uint16_t            few_material[hits_capacity];
    const double        sun_enu[3] = {-0.48, 0.36, 0.8};
    float              *out[AIR_BAND_COUNT];
    arena_reset(hand.air_arena);
    hand_air_on(sun_enu, 300);
    hand_draw = 9;
    random_hits(sun_enu, true);
    assert_int_equal(surface_light_prepare(&light, &hand.air, &hand.world.materials, hand.air_arena), STATUS_OK);
    thermal_temperature(temp_k, &hand.air, &hand.world.materials, NULL, &hits, material, arrives, texture, warmth_k);
    air_paths_of(veils, &hand.air, (1 << AIR_BAND_COUNT) - 1, &hits, &rays, temp_k);
    SurfaceBlock block = {
        .hits = &hits, .rays = &rays, .material = material, .temp_k = temp_k, .sun = arrives, .veils = veils};
    for (int b = 0; b < AIR_BAND_COUNT; b++) out[b] = all[b], block.texture[b] = texture;
    surface_light_shade(out, &light, &block);

    /* every third, backwards */
    int of[hits_capacity], count = 0;
    for (int i = hits_count - 1; i >= 0; i -= 3) of[count++] = i;
    few.count = few_rays.count = count;
    for (int k = 0; k < count; k++) {
        const int i = of[k];
        few.range_m[k] = hits.range_m[i], few.surface[k] = hits.surface[i];
        for (int c = 0; c < 3; c++) {
            few_rays.o_enu[c][k] = rays.o_enu[c][i], few_rays.d_enu[c][k] = rays.d_enu[c][i];
            few.p_enu[c][k] = hits.p_enu[c][i];
            few.n_enu[c][k] = few.n_geo[c][k] = hits.n_enu[c][i];
        }
        few_texture[k] = texture[i], few_arrives[k] = arrives[i], few_material[k] = material[i];
    }
    thermal_temperature(few_temp_k, &hand.air, &hand.world.materials, NULL, &few, few_material, few_arrives,
                        few_texture, warmth_k);
    air_paths_of(few_veils, &hand.air, (1 << AIR_BAND_COUNT) - 1, &few, &few_rays, few_temp_k);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        float       *alone[AIR_BAND_COUNT] = {NULL};
        SurfaceBlock some = {.hits = &few,
                             .rays = &few_rays,
                             .material = few_material,
                             .temp_k = few_temp_k,
                             .sun = few_arrives,
                             .veils = few_veils};
        alone[b] = one;
        some.texture[b] = few_texture;
        surface_light_shade(alone, &light, &some);
        for (int k = 0; k < count; k++) CHECK(one[k] == all[b][of[k]] && few_temp_k[k] == temp_k[of[k]]);
    }
}

/* Eight at a time against the exact integral, over all that ground can be, and the plain answer beyond. */
static void planck_of_eight(void **state)
{
    (void)state;
    static const double edge_m[2][2] = {{3.4e-6, 4.8e-6}, {8e-6, 12e-6}};
    for (int band = 0; band < 2; band++) {
        PlanckTable *table = NULL;
        double       most = 0;
        assert_int_equal(planck_table_create(&table, edge_m[band][0], edge_m[band][1]), STATUS_OK);
        for (int n = 0; n < 4000; n++) {
            float at_k[8], radiance[8];
            for (int k = 0; k < 8; k++)
                at_k[k] = (float)(180 + (1500 - 180) * random_uniform(7, (uint32_t)k, 0, (uint64_t)n));
            planck_table_radiance8(radiance, table, at_k);
            for (int k = 0; k < 8; k++)
                most = fmax(most, fabs((double)radiance[k] /
                                           planck_band(edge_m[band][0], edge_m[band][1], (double)at_k[k], NULL) -
                                       1));
        }
        print_message("band %d: %.1e\n", band, most);
        CHECK(most <
              4e-6); /* 1/T by float steps of 6e-8 times c2 / (wavelength T), 22 at the coldest, and the cubic's own */
        const float beyond_k[8] = {20, 179.9f, 1500.1f, 4000, 300, NAN, 180, 1500};
        float       radiance[8];
        planck_table_radiance8(radiance, table, beyond_k);
        for (int k = 0; k < 8; k++) {
            const double exact = planck_band(edge_m[band][0], edge_m[band][1], (double)beyond_k[k], NULL);
            CHECK(k == 5 ? isnan(radiance[k])
                         : fabs((double)radiance[k] - exact) <= 4e-6 * exact + 1e-37); /* float ends there */
        }
        planck_table_destroy(table);
    }
}

/* Light from above over the open sky's on the same plane; of a plane that sees less than 1/16 of 160 W/m2, as if it saw
 * 10: half of 5 lost is a quarter. */
static void sky_in_a_mirror(void **state)
{
    (void)state;
    CHECK_NEAR(mirror_sky_factor(30, 120, 160), 0.25, 1e-15);
    CHECK_NEAR(mirror_sky_factor(2.5, 5, 160), 0.75, 1e-15);
    CHECK_NEAR(mirror_sky_factor(12.5, 10, 160), 1.25, 1e-15);
    CHECK(mirror_sky_factor(0, 0, 160) == 1 && mirror_sky_factor(0, 0, 0) == 1);
    CHECK(mirror_sky_factor(-40, 20, 160) == 0 && mirror_sky_factor(1e6, 20, 160) == 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_agrees_with_the_plain_form),
        cmocka_unit_test(materials_agree_with_the_plain_form),
        cmocka_unit_test(company_changes_no_bit),
        cmocka_unit_test(planck_of_eight),
        cmocka_unit_test(sky_in_a_mirror),
    };
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
