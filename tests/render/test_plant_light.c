/* Light on leaves: between even skies they vanish, lit from behind they shine, and quick and plain forms agree.
 * labels: physics */
#include "tests/render/hand_plants.h"
#include "tests/render/hand_world.h"

#include "render/light/hemisphere.h"
#include "render/light/optical.h"
#include "render/light/surface_light.h"
#include "render/light/thermal.h"

enum { leaf_count = 64 };

static Hits      hits;
static Rays      rays;
static AirPaths  veils[AIR_BAND_COUNT];
static float     texture[hits_capacity], sun[hits_capacity], temp_k[hits_capacity];
static uint64_t  key[hits_capacity];
static Material  rows[3];
static Materials materials;

static int open_world(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < hits_capacity; i++) key[i] = i;
    return hand_open(false);
}

/* A leaf of the same optics in all bands. */
static void set_leaf(float rho, float tau)
{
    Material *m = &rows[1];
    *m = (Material){.name = "leaf",
                    .rho_mwir = rho,
                    .rho_lwir = rho,
                    .tau_mwir = tau,
                    .tau_lwir = tau,
                    .solar_absorptance = 1 - rho - tau,
                    .roughness = 1,
                    .conductivity_w_mk = 0.3f,
                    .density_kg_m3 = 700,
                    .heat_capacity_j_kgk = 3500};
    for (int c = 0; c < optical_channel_count; c++) m->rho[c] = rho, m->tau[c] = tau;
    rows[2] = *m; /* bark of the same reflectance in all */
    for (int c = 0; c < optical_channel_count; c++) rows[2].rho[c] = rho + tau, rows[2].tau[c] = 0;
    rows[2].rho_mwir = rows[2].rho_lwir = rho + tau, rows[2].tau_mwir = rows[2].tau_lwir = 0;
    materials = (Materials){.count = 3, .material = rows};
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        materials.plant[kind][PLANT_LEAF] = 1, materials.plant[kind][PLANT_BARK] = 2;
}

/* Leaves of every tilt a little above z = 0, seen from their lit or unlit side. */
static void random_leaves(void)
{
    hits.count = rays.count = leaf_count;
    for (int i = 0; i < leaf_count; i++) {
        double       n[3];
        const double up = hand_uniform(-1, 1), turn = hand_uniform(0, 2 * pi_rad), flat = sqrt(1 - up * up);
        n[0] = flat * cos(turn), n[1] = flat * sin(turn), n[2] = up;
        for (int k = 0; k < 3; k++) {
            hits.n_enu[k][i] = hits.n_geo[k][i] = (float)n[k];
            rays.d_enu[k][i] = -n[k];
            hits.p_enu[k][i] = k == 2 ? 5 : 0;
            rays.o_enu[k][i] = hits.p_enu[k][i] + 10 * n[k];
        }
        hits.range_m[i] = 10;
        hits.kind[i] = hit_plant, hits.instance[i] = 1, hits.material[i] = 1;
        hits.albedo[i] = hits.open_up[i] = hits.open_down[i] = texture[i] = sun[i] = 1;
        temp_k[i] = 300;
    }
}

/* The quick form, and the largest relative difference of the plain one from it. */
static double shade(float quick[AIR_BAND_COUNT][hits_capacity], const float *const around[AIR_BAND_COUNT])
{
    static SurfaceLight light;
    static float        plain[hits_capacity];
    double              most = 0;
    float              *out[AIR_BAND_COUNT];
    assert_int_equal(surface_light_prepare(&light, &hand.air, &materials, hand.air_arena), STATUS_OK);
    air_paths_of(veils, &hand.air, (1 << AIR_BAND_COUNT) - 1, &hits, &rays, temp_k);
    SurfaceBlock block = {
        .hits = &hits, .rays = &rays, .material = hits.material, .temp_k = temp_k, .sun = sun, .veils = veils};
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        out[b] = quick[b], block.texture[b] = texture;
        if (around) block.around_w_m2[b] = around[b];
    }
    surface_light_shade(out, &light, &block);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        const float *gathered = around ? around[b] : NULL;
        if (b < optical_channel_count)
            optical_shade(plain, b, &hand.air, &materials, &hits, &rays, hits.material, texture, sun, gathered, NULL,
                          &veils[b], NULL);
        else
            thermal_shade(plain, b == AIR_MWIR ? BAND_MWIR : BAND_LWIR, &hand.air, &materials, &hits, &rays,
                          hits.material, temp_k, sun, gathered, NULL, &veils[b], NULL);
        for (int i = 0; i < leaf_count; i++)
            most = fmax(most, fabs((double)quick[b][i] - (double)plain[i]) / fmax((double)plain[i], 1e-9));
    }
    return most;
}

/* Air of one radiance from everywhere, the ground included. */
static void even_air(double w_m2_sr, double sun_w_m2, const double sun_enu[3])
{
    double sky[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) sky[b] = w_m2_sr;
    air_even(&hand.air, sun_enu, sun_w_m2, sky, 0, hand.world.planck_mwir, hand.world.planck_lwir);
    for (int c = 0; c < optical_channel_count; c++) materials.ground_rho[c] = 1;
}

/* A leaf that absorbs nothing, between surroundings of radiance 3: nothing else can be seen, whatever its tilt. */
static void white_leaf_vanishes(void **state)
{
    (void)state;
    static float           quick[AIR_BAND_COUNT][hits_capacity];
    static HemisphereLight gathered;
    const double           down[3] = {0, 0, -1};
    VisibilityCounters     counters = {0};
    Visibility            *visibility = NULL;
    hand_draw = 3;
    arena_reset(hand.arena), arena_reset(hand.air_arena);
    hand_clear();
    set_leaf(0.55f, 0.45f);
    even_air(3, 0, down);
    random_leaves();
    CHECK(shade(quick, NULL) < 3e-5);
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        for (int i = 0; i < leaf_count; i++) CHECK_NEAR(quick[b][i], 3, 3e-4);

    assert_int_equal(
        visibility_create(&visibility, hand.world.tracer, NULL, &hand.world.frame, &hand.snapshot, false, hand.arena),
        STATUS_OK);
    visibility_materials(visibility, &materials);
    const HemisphereScene scene = {visibility, &hand.air, &materials, NULL, &hand.snapshot};
    const float          *around[AIR_BAND_COUNT];
    hemisphere_light(&gathered, &scene, &hits, (1 << AIR_BAND_COUNT) - 1, 16, key, &counters);
    for (int b = 0; b < AIR_BAND_COUNT; b++) around[b] = gathered.w_m2[b];
    CHECK(shade(quick, around) < 3e-5);
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        for (int i = 0; i < leaf_count; i++) CHECK_NEAR(quick[b][i], 3, 3e-4);
}

/* The same of a stand, by hemisphere sampling, which is the reference mode: between leaves and branches that absorb
 * nothing, whatever lies in between. */
static void white_stand_vanishes(void **state)
{
    (void)state;
    enum { trees = 40 };
    static Plant           plant[trees];
    static float           quick[AIR_BAND_COUNT][hits_capacity];
    static HemisphereLight gathered;
    const double           origin[3] = {0, 0, 0}, down[3] = {0, 0, -1}, eye[3] = {0, -60, 20}, calm[2] = {0, 0};
    VisibilityCounters     counters = {0};
    Visibility            *visibility = NULL;
    Forest                *forest = NULL;
    ForestFrame            frame;
    int                    of[2] = {0};
    arena_reset(hand.arena), arena_reset(hand.air_arena);
    hand_clear();
    set_leaf(0.5f, 0.5f); /* one side is followed at random: without noise where both weigh the same */
    even_air(3, 0, down);
    hand_grow(false, 0.08);
    const Woods woods = hand_stand(plant, trees, origin, 15);
    assert_int_equal(forest_create(&forest, &woods, &hand_plants, &(ForestConfig){.leaves = true}, "avx2"), STATUS_OK);
    assert_int_equal(forest_frame_open(&frame, forest, eye, 1000, 0, 0, calm, NULL, hand.arena), STATUS_OK);
    assert_int_equal(
        visibility_create(&visibility, hand.world.tracer, NULL, &hand.world.frame, &hand.snapshot, 0, hand.arena),
        STATUS_OK);
    visibility_materials(visibility, &materials);
    visibility_plants(visibility, &frame);
    rays.count = 0, rays.columns = 0;
    for (int i = 0; i < 4 * leaf_count && rays.count < leaf_count; i++) { /* those that meet something */
        double d[3] = {hand_uniform(-14, 14) - eye[0], hand_uniform(-14, 14) - eye[1], hand_uniform(2, 9) - eye[2]};
        v3_normalize(d, d);
        for (int k = 0; k < 3; k++) rays.o_enu[k][rays.count] = eye[k], rays.d_enu[k][rays.count] = d[k];
        rays.far_m[rays.count] = INFINITY;
        Rays one = {.count = 1};
        Hits met;
        for (int k = 0; k < 3; k++) one.o_enu[k][0] = eye[k], one.d_enu[k][0] = d[k];
        one.far_m[0] = INFINITY;
        visibility_first_hit(&met, visibility, &one, visibility_all_but(-1), &counters);
        rays.count += met.kind[0] == hit_plant;
    }
    assert_int_equal(rays.count, leaf_count);
    visibility_first_hit(&hits, visibility, &rays, visibility_all_but(-1), &counters);
    hits.several = false;
    for (int i = 0; i < leaf_count; i++) texture[i] = sun[i] = 1, temp_k[i] = 300, of[hits.radius_m[i] > 0]++;
    CHECK(of[0] > 10 && of[1] > 3);
    const HemisphereScene scene = {visibility, &hand.air, &materials, NULL, &hand.snapshot};
    const float          *around[AIR_BAND_COUNT];
    hemisphere_light(&gathered, &scene, &hits, (1 << optical_channel_count) - 1, 16, key, &counters);
    for (int b = 0; b < AIR_BAND_COUNT; b++) around[b] = gathered.w_m2[b];
    shade(quick, around);
    for (int b = 0; b < optical_channel_count; b++)
        for (int i = 0; i < leaf_count; i++) CHECK_NEAR(quick[b][i], 3, 3e-4);
    forest_frame_close(&frame);
    forest_destroy(forest);
}

/* Under a sun of 200 W/m2 alone a leaf returns rho cos / pi on the sunlit side and tau cos / pi on the other one; both,
 * over all directions, and what it absorbs are what it receives. */
static void sun_on_either_side(void **state)
{
    (void)state;
    static float quick[AIR_BAND_COUNT][hits_capacity];
    const double sun_w_m2 = 200, rho = 0.3, tau = 0.2;
    double       sun_enu[3];
    CHECK(v3_normalize(sun_enu, (const double[3]){0.3, -0.5, 0.6}));
    hand_draw = 4;
    arena_reset(hand.air_arena);
    set_leaf((float)rho, (float)tau);
    even_air(0, sun_w_m2, sun_enu);
    for (int c = 0; c < optical_channel_count; c++) materials.ground_rho[c] = 0;
    random_leaves();
    CHECK(shade(quick, NULL) < 3e-5);
    for (int i = 0; i < leaf_count; i++) {
        const double n[3] = {hits.n_enu[0][i], hits.n_enu[1][i], hits.n_enu[2][i]}, along = v3_dot(n, sun_enu);
        const double expected = (along > 0 ? rho * along : -tau * along) * hand.air.light.sun_w_m2[AIR_NIR] / pi_rad;
        CHECK_NEAR(quick[AIR_NIR][i], expected, 1e-4 * fmax(expected, 0.1));
    }
    /* the other side of the same leaves */
    static float other[AIR_BAND_COUNT][hits_capacity];
    for (int i = 0; i < leaf_count; i++)
        for (int k = 0; k < 3; k++) {
            hits.n_enu[k][i] = -hits.n_enu[k][i], hits.n_geo[k][i] = -hits.n_geo[k][i];
            rays.d_enu[k][i] = -rays.d_enu[k][i];
            rays.o_enu[k][i] = hits.p_enu[k][i] - 10 * rays.d_enu[k][i];
        }
    CHECK(shade(other, NULL) < 3e-5);
    for (int i = 0; i < leaf_count; i++) {
        const double n[3] = {hits.n_enu[0][i], hits.n_enu[1][i], hits.n_enu[2][i]};
        const double incident = fabs(v3_dot(n, sun_enu)) * hand.air.light.sun_w_m2[AIR_R];
        const double left = pi_rad * ((double)quick[AIR_R][i] + (double)other[AIR_R][i]);
        CHECK_NEAR(left + (1 - rho - tau) * incident, incident, 1e-4 * fmax(incident, 0.1));
    }
    /* in the shade: nothing; and a leaf twice as bright as its kind returns all, not more */
    for (int i = 0; i < leaf_count; i++) sun[i] = 0;
    CHECK(shade(quick, NULL) < 3e-5);
    for (int i = 0; i < leaf_count; i++) CHECK(quick[AIR_NIR][i] == 0);
    set_leaf(0.5f, 0.4f);
    even_air(3, 0, (const double[3]){0, 0, -1});
    for (int i = 0; i < leaf_count; i++) texture[i] = 2;
    CHECK(shade(quick, NULL) < 3e-5);
    for (int i = 0; i < leaf_count; i++) CHECK_NEAR(quick[AIR_NIR][i], 3, 3e-4);
}

/* Under the atmosphere's own sun and sky, of every tilt and brightness. */
static void quick_and_plain_forms_agree(void **state)
{
    (void)state;
    static float quick[AIR_BAND_COUNT][hits_capacity];
    const double suns[2][3] = {{-0.48, 0.36, 0.8}, {0.6, 0.7, -0.4}};
    for (int run = 0; run < 2; run++) {
        double sun_enu[3];
        CHECK(v3_normalize(sun_enu, suns[run]));
        arena_reset(hand.air_arena);
        hand_air_on(sun_enu, 300);
        set_leaf(0.4f, 0.3f);
        for (int c = 0; c < optical_channel_count; c++) materials.ground_rho[c] = 0.2f;
        random_leaves();
        for (int i = 0; i < leaf_count; i++)
            texture[i] = (float)hand_uniform(0.6, 1.6), sun[i] = (float)hand_uniform(0, 1);
        const double most = shade(quick, NULL);
        print_message("sun %d: %.1e\n", run, most);
        CHECK(most < 3e-5);
    }
}

/* Among plants a side of normal n gets (render/light/canopy.h) up E_sky + down g E_ground + (1 - up (1 + n_z) / 2 -
 * down (1 - n_z) / 2) M, its far side the same of -n, both by the factor of what stands near; and of the sun what
 * arrives. Leaves return rho and let tau through, bark returns rho; a bright leaf no more than it gets. In 3-5 and 8-12
 * um nothing of the canopy counts, and what neither returns nor lets through is emitted. */
static void sides_among_plants_are_as_on_paper(void **state)
{
    (void)state;
    static SurfaceLight light;
    static CanopyLight  among;
    static float        seen[AIR_BAND_COUNT][hits_capacity], near[hits_capacity];
    static const double sun_enu[3] = {0.48, 0.36, 0.8}, sky = 20, rho = 0.4, tau = 0.3;
    float              *out[AIR_BAND_COUNT];
    hand_draw = 40;
    set_leaf((float)rho, (float)tau);
    even_air(sky, 300, sun_enu);
    for (int c = 0; c < optical_channel_count; c++) materials.ground_rho[c] = 0.2f;
    random_leaves();
    for (int i = 0; i < leaf_count; i++) {
        hits.material[i] = (uint16_t)(1 + i / 8 % 2);
        if (i > 40) hits.material[i] = (uint16_t)(1 + i % 2);
        sun[i] = i % 3 == 0 ? 0 : (float)hand_uniform(0, 1), texture[i] = (float)hand_uniform(0.5, 2),
        near[i] = (float)hand_uniform(0.5, 1.5);
        among.up[i] = (float)hand_uniform(0, 1), among.down[i] = (float)hand_uniform(0, 1);
        for (int c = 0; c < optical_channel_count; c++)
            among.ground[c][i] = (float)hand_uniform(0, 1), among.leaves_w_m2[c][i] = (float)hand_uniform(0, 50);
    }
    assert_int_equal(surface_light_prepare(&light, &hand.air, &materials, hand.air_arena), STATUS_OK);
    air_paths_of(veils, &hand.air, (1 << AIR_BAND_COUNT) - 1, &hits, &rays, temp_k);
    for (int there = 0; there < 3; there++) { /* in the open, among plants, and near a body as well */
        SurfaceBlock block = {.hits = &hits,
                              .rays = &rays,
                              .material = hits.material,
                              .temp_k = temp_k,
                              .sun = sun,
                              .veils = veils,
                              .canopy = there ? &among : NULL};
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            out[b] = seen[b], block.texture[b] = texture, block.open[b] = there == 2 ? near : NULL;
        surface_light_shade(out, &light, &block);
        for (int k = 0; k < leaf_count * AIR_BAND_COUNT; k++) {
            const int    i = k % leaf_count, b = k / leaf_count;
            const bool   leaf = hits.material[i] == 1, optical = b < optical_channel_count;
            const double n[3] = {(double)hits.n_enu[0][i], (double)hits.n_enu[1][i], (double)hits.n_enu[2][i]},
                         facing = v3_dot(n, sun_enu);
            const double level = optical ? 0.2 * (300 * 0.8 + sky * pi_rad) : sky * pi_rad;
            double       side[2], returns = leaf ? rho : rho + tau, through = leaf ? tau : 0;
            for (int far = 0; far < 2; far++) {
                const double up = far ? -n[2] : n[2], sees_sky = 0.5 * (1 + up), sees_ground = 0.5 * (1 - up);
                side[far] = sky * pi_rad * sees_sky + level * sees_ground;
                if (there && optical)
                    side[far] = (double)among.up[i] * sky * pi_rad * sees_sky +
                                (double)among.down[i] * (double)among.ground[b][i] * level * sees_ground +
                                (1 - (double)among.up[i] * sees_sky - (double)among.down[i] * sees_ground) *
                                    (double)among.leaves_w_m2[b][i];
                if (there == 2) side[far] *= (double)near[i];
            }
            if (optical && leaf)
                returns *= fmin((double)texture[i], 1 / (rho + tau)),
                    through *= fmin((double)texture[i], 1 / (rho + tau));
            if (optical && !leaf) returns = fmin(returns * (double)texture[i], 1);
            double want = (returns * side[0] + through * side[1]) / pi_rad;
            if (b != AIR_LWIR)
                want += (returns * fmax(facing, 0) + through * fmax(-facing, 0)) * 300 * (double)sun[i] / pi_rad;
            if (!optical)
                want +=
                    (1 - returns - through) *
                    planck_table_radiance(b == AIR_MWIR ? hand.world.planck_mwir : hand.world.planck_lwir, temp_k[i]);
            CHECK_NEAR(seen[b][i] / want, 1, 2e-5);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(white_leaf_vanishes),
        cmocka_unit_test(white_stand_vanishes),
        cmocka_unit_test(sun_on_either_side),
        cmocka_unit_test(quick_and_plain_forms_agree),
        cmocka_unit_test(sides_among_plants_are_as_on_paper),
    };
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
