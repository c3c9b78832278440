/* Light under leaves: the closed form against its integral, the grid against the leaves it was given.
 * labels: physics */
#include "tests/check.h"

#include "render/light/canopy.h"

#include <stdlib.h>

enum { side = 40, plants_most = side * side };

static Plants      *prototypes;
static Plant        plant[plants_most];
static uint32_t     first[9 * 9 + 1];
static Woods        woods;
static const double height_m = 12, leaf_area = 0.3, crown_low = 0.4;

/* An orchard: a birch of 12 m every 8 m over 320 m square, 0.3 h^2 = 43.2 m2 of leaves each, from 4.8 m up. */
static int open_orchard(void **state)
{
    (void)state;
    prototypes = calloc(1, sizeof *prototypes);
    if (!prototypes) return -1;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        prototypes->shape[kind][plant_whole] =
            (PlantShape){.leaf_area = (float)leaf_area, .crown_low = (float)crown_low, .crown_radius = 0.25f};
    woods = (Woods){.by_kind = {[PLANT_BIRCH] = side * side},
                    .origin_enu = {-160, -160, 100},
                    .nx = 5,
                    .ny = 5,
                    .first = first,
                    .plant = plant};
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++)
            plant[woods.count++] = (Plant){.p_m = {(float)(8 * i + 4), (float)(8 * j + 4), 0},
                                           .kind = PLANT_BIRCH,
                                           .height = (uint16_t)(height_m / plant_height_step_m),
                                           .width = 128};
    return 0;
}

static int close_orchard(void **state)
{
    (void)state;
    free(prototypes);
    return 0;
}

/* 2 E3(x) by Simpson's rule in mu, of 20,000 steps: unlike the product's, which goes by mu squared. */
static double gap_by_simpson(double x)
{
    enum { steps = 20000 };
    double sum = exp(-x);
    for (int k = 1; k < steps; k++) {
        const double mu = (double)k / steps;
        sum += (k & 1 ? 4 : 2) * mu * exp(-x / mu);
    }
    return x > 0 ? 2 * sum / (3 * steps) : 1;
}

static void gap_is_the_integral(void **state)
{
    (void)state;
    double most = 0;
    for (int i = 0; i <= 200; i++) {
        const double x = 8.0 * i / 200;
        most = fmax(most, fabs(canopy_gap(x) - gap_by_simpson(x)));
    }
    print_message("worst: %.1e\n", most);
    CHECK(most < 1e-4);
    CHECK(canopy_gap(0) == 1);
    /* 2 E3(1) = 0.2193839 (Abramowitz & Stegun, table 5.1: E3(1) = 0.1096920) */
    CHECK_NEAR(canopy_gap(1), 0.219384, 1e-4);
}

static void leaves_are_where_they_were_put(void **state)
{
    (void)state;
    Material     row = {0};
    Materials    none = {.count = 1, .material = &row};
    Canopy      *c = NULL;
    const double index = leaf_area * height_m * height_m / 64; /* a tree every 64 m2: 0.675 */
    assert_int_equal(canopy_create(&c, &woods, prototypes, &none, true), STATUS_OK);
    for (int i = 0; i < 30; i++) {
        const double x = -100 + 6.7 * i, y = 90 - 5.1 * i;
        CHECK_NEAR(canopy_leaf_area_above(c, x, y, 0), index, 1.0 / 32 + 1e-6); /* the cells' own step */
        CHECK_NEAR(canopy_leaf_area_above(c, x, y, 0.5 * height_m * (1 + crown_low)), index / 2, 0.03);
        CHECK(canopy_leaf_area_above(c, x, y, height_m + 0.2) == 0);
    }
    CHECK(canopy_leaf_area_above(c, 1000, 0, 0) == 0 && canopy_leaf_area_above(c, NAN, 0, 0) == 0);
    canopy_destroy(c);
    /* bare in winter */
    assert_int_equal(canopy_create(&c, &woods, prototypes, &none, false), STATUS_OK);
    CHECK(canopy_leaf_area_above(c, 0, 0, 0) == 0);
    canopy_destroy(c);
    canopy_destroy(NULL);
}

/* ---- light ------------------------------------------------------------------------------------ */

static CanopyLight among;
static Hits        hits;
static const float dark_ground[optical_channel_count] = {0};

static Cache *kept_in; /* by one test */

/* The orchard's canopy, of leaves and bark that are the same in all bands; a crown is one leaf of 0.4 m2 and a branch
 * of 0.4 m2, as open as this. */
static Canopy *canopy_of(double rho, double tau, double bark, double up, double down)
{
    static Material  rows[3];
    static Materials materials;
    static PlantQuad quad[2];
    Canopy          *c = NULL;
    materials = (Materials){.count = 3, .material = rows};
    for (int k = 0; k < optical_channel_count; k++)
        rows[1].rho[k] = (float)rho, rows[1].tau[k] = (float)tau, rows[2].rho[k] = (float)bark;
    for (int k = 0; k < 2; k++)
        quad[k] = (PlantQuad){.corner = {{0, 0, 0}, {0.4f, 0, 0}, {0.4f, 1, 0}, {0, 1, 0}},
                              .organ = k ? PLANT_BARK : PLANT_LEAF,
                              .open_up = (float)up,
                              .open_down = (float)down};
    for (int kind = 0; kind < PLANT_KINDS; kind++) {
        materials.plant[kind][PLANT_LEAF] = 1, materials.plant[kind][PLANT_BARK] = 2;
        prototypes->shape[kind][plant_whole].quad = quad, prototypes->shape[kind][plant_whole].quads = 2;
        for (int o = 0; o < plant_outlines; o++) prototypes->outline_area[kind][o] = 1;
    }
    assert_int_equal(canopy_create(&c, &woods, prototypes, &materials, true), STATUS_OK);
    if (!kept_in) return c;
    /* the same from the cache, whose octets are compared */
    for (int k = 0; k < 2; k++) {
        Canopy *kept = NULL;
        size_t  count[2];
        assert_int_equal(canopy_create_kept(&kept, &woods, prototypes, &materials, true,
                                            &(PlantsKept){kept_in, "prototypes of this test"}),
                         STATUS_OK);
        void *a = kept_write(&count[0], canopy_kept_values, c), *b = kept_write(&count[1], canopy_kept_values, kept);
        CHECK(a && b && count[0] == count[1] && memcmp(a, b, count[0]) == 0);
        free(a), free(b);
        canopy_destroy(kept);
    }
    return c;
}

/* Light is by openness and materials, so a canopy of others is not taken for it. */
static void kept_canopies_are_the_same(void **state)
{
    (void)state;
    char folder[temp_path_size], command[temp_path_size + 16];
    CHECK(temp_folder(folder));
    kept_in = cache_open(folder, 64 << 20);
    CHECK(kept_in);
    canopy_destroy(canopy_of(0.4, 0.4, 0.2, 0.3, 0.4));
    CHECK(cache_counters(kept_in).made == 1 && cache_counters(kept_in).fetched == 1);
    canopy_destroy(canopy_of(0.4, 0.41, 0.2, 0.3, 0.4));
    CHECK(cache_counters(kept_in).made == 2 && cache_counters(kept_in).fetched == 2);
    cache_close(kept_in);
    kept_in = NULL;
    snprintf(command, sizeof command, "rm -r %s", folder);
    CHECK(system(command) == 0);
}

/* Ground beneath the orchard, beside it, a leaf in it, the sky: all at height 0, since there is no landscape. */
static void set_hits(float up, float down)
{
    static const uint8_t kind[4] = {hit_ground, hit_ground, hit_plant, hit_sky};
    hits.count = 4;
    for (int i = 0; i < 4; i++) {
        hits.kind[i] = kind[i], hits.range_m[i] = i == 3 ? INFINITY : 100;
        hits.p_enu[0][i] = i == 1 ? 900 : 3, hits.p_enu[1][i] = 5;
        hits.open_up[i] = up, hits.open_down[i] = down, hits.n_enu[2][i] = 1;
    }
}

static Daylight light_of(double sun_w_m2, double sky_w_m2, double sin_sun)
{
    Daylight light = {.sun_d_enu = {sqrt(1 - sin_sun * sin_sun), 0, sin_sun}};
    for (int c = 0; c < optical_channel_count; c++) light.sun_w_m2[c] = sun_w_m2, light.sky_w_m2[c] = sky_w_m2;
    return light;
}

static double received(int i, double up, double sky_w_m2, double ground_w_m2)
{
    const double sky = 0.5 * (1 + up) * (double)among.up[i], ground = 0.5 * (1 - up) * (double)among.down[i];
    return sky * sky_w_m2 + ground * (double)among.ground[AIR_NIR][i] * ground_w_m2 +
           (1 - sky - ground) * (double)among.leaves_w_m2[AIR_NIR][i];
}

/* Leaves that scatter nothing: exp(-L / (2 mu)) over the sky, and for the sun at its height; beside the orchard all. */
static void black_leaves_hide(void **state)
{
    (void)state;
    const double   index = leaf_area * height_m * height_m / 64, sin_sun = 0.5;
    const Daylight light = light_of(400, 100, sin_sun);
    Canopy        *c = canopy_of(0, 0, 0, 0.5, 0.4);
    set_hits(0.04f, 0.03f);
    assert_true(canopy_light(&among, c, NULL, &light, dark_ground, &hits, 1u << AIR_NIR));
    CHECK_NEAR(among.up[0], gap_by_simpson(0.5 * index), 0.03); /* by the step of the leaf area */
    CHECK(among.down[0] == 1 && among.up[1] == 1 && among.down[1] == 1 && among.leaves_w_m2[AIR_NIR][0] == 0);
    CHECK_NEAR(among.ground[AIR_NIR][0],
               (400 * sin_sun * exp(-0.5 * index / sin_sun) + 100 * gap_by_simpson(0.5 * index)) /
                   (400 * sin_sun + 100),
               0.03);
    /* a place within a crown has the less of the stand's light and its own plant's */
    CHECK_NEAR(among.up[2], 0.04, 1e-6);
    CHECK_NEAR(among.down[2], 0.03, 1e-6);
    /* nothing is near */
    hits.count = 2, hits.p_enu[0][0] = 900;
    CHECK(!canopy_light(&among, c, NULL, &light, dark_ground, &hits, 1u << AIR_NIR));
    canopy_destroy(c);
}

/* White furnace: among leaves, branches and ground that absorb nothing, under an even sky, everything gets what the sky
 * gives, wherever and whatever its tilt. */
static void white_leaves_vanish(void **state)
{
    (void)state;
    static const float white[optical_channel_count] = {1, 1, 1, 1, 1};
    const Daylight     light = light_of(0, 100, 0.5);
    Canopy            *c = canopy_of(0.55, 0.45, 1, 0.5, 0.4);
    set_hits(0.3f, 0.2f);
    assert_true(canopy_light(&among, c, NULL, &light, white, &hits, 1u << AIR_NIR));
    for (int i = 0; i < 3; i++)
        for (double up = -1; up <= 1; up += 0.25) CHECK_NEAR(received(i, up, 100, 100), 100, 0.01);
    canopy_destroy(c);
}

/* The orders of scattering one by one, until nothing is left. */
static void orders_add_up(void **state)
{
    (void)state;
    const double   rho = 0.46, tau = 0.4, bark = 0.3, up = 0.5, down = 0.4, sin_sun = 0.7, ground = 0.2;
    const double   index = 11.0 / 16; /* 0.675, stored as 11/16 */
    const float    ground_rho[optical_channel_count] = {0.2f, 0.2f, 0.2f, 0.2f, 0.2f};
    const Daylight light = light_of(400, 100, sin_sun);
    Canopy        *c = canopy_of(rho, tau, bark, up, down);
    set_hits(0.3f, 0.2f);
    for (int i = 0; i < 4; i++) hits.kind[i] = i == 3 ? hit_sky : hit_plant;
    assert_true(canopy_light(&among, c, NULL, &light, ground_rho, &hits, 1u << AIR_NIR));
    /* at the ground: hits without a landscape are at height 0 */
    const double sees_sky = fmin(up, gap_by_simpson(0.5 * index)), sees_ground = down,
                 hidden = 1 - gap_by_simpson(0.5 * index);
    const double w = (0.5 * (rho + tau) + 0.25 * bark) / 0.75; /* by the areas that light meets: half of a leaf's, a
                                                                * quarter of a branch's */
    const double below = 400 * sin_sun * exp(-0.5 * index / sin_sun) + 100 * (1 - hidden);
    double on_leaf = 0.5 * 400 * fmin(up, exp(-0.5 * index / sin_sun)) + sees_sky * 100 + sees_ground * ground * below;
    double leaves = 0;
    for (int order = 0; order < 200; order++) {
        const double out = 0.5 * w * on_leaf;
        leaves += out;
        on_leaf = (2 - sees_sky - sees_ground + sees_ground * ground * hidden) * out;
    }
    CHECK_NEAR(among.leaves_w_m2[AIR_NIR][0], leaves, 1e-3 * leaves);
    CHECK_NEAR(among.ground[AIR_NIR][0], (below + hidden * leaves) / (400 * sin_sun + 100), 1e-3);
    /* and asked for one place and channel */
    CanopyPlace place;
    double      on_ground_w_m2;
    CHECK(canopy_place(&place, c, 3, 5, 0, sin_sun));
    CHECK_NEAR(canopy_exitance(&on_ground_w_m2, c, &place, optical_channel_nir, 400, 100, sin_sun, ground), leaves,
               1e-3 * leaves);
    CHECK_NEAR(on_ground_w_m2, below + hidden * leaves, 0.5);
    canopy_destroy(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kept_canopies_are_the_same),
        cmocka_unit_test(gap_is_the_integral),
        cmocka_unit_test(leaves_are_where_they_were_put),
        cmocka_unit_test(black_leaves_hide),
        cmocka_unit_test(white_leaves_vanish),
        cmocka_unit_test(orders_add_up),
    };
    return cmocka_run_group_tests(tests, open_orchard, close_orchard);
}
