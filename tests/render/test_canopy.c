/* Light under leaves: the closed form against its integral, the grid against the leaves it was given. */
#include "tests/check.h"

#include "render/light/canopy.h"

#include <stdlib.h>

enum { side = 40, plants_most = side * side };

static Plants *prototypes;
static Plant   plant[plants_most];
static uint32_t first[9 * 9 + 1];
static Woods   woods;
static const double height_m = 12, leaf_area = 0.3, crown_low = 0.4;

/* An orchard: a birch of 12 m every 8 m over 320 m square, 0.3 h^2 = 43.2 m2 of leaves each, from 4.8 m up. */
static int open_orchard(void **state)
{
    (void)state;
    prototypes = calloc(1, sizeof *prototypes);
    if (!prototypes) return -1;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        prototypes->shape[kind][0] = (PlantShape){.leaf_area = (float)leaf_area, .crown_low = (float)crown_low,
                                                  .crown_radius = 0.25f};
    woods = (Woods){.origin_enu = {-160, -160, 100}, .nx = 5, .ny = 5, .first = first, .plant = plant};
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++)
            plant[woods.count++] = (Plant){.p_m = {(float)(8 * i + 4), (float)(8 * j + 4), 0}, .kind = PLANT_BIRCH,
                                           .height = (uint16_t)(height_m / plant_height_step_m), .width = 128};
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
    Canopy      *c = NULL;
    const double index = leaf_area * height_m * height_m / 64; /* a tree every 64 m2: 0.675 */
    assert_int_equal(canopy_create(&c, &woods, prototypes, true, NULL), STATUS_OK);
    for (int i = 0; i < 30; i++) {
        const double x = -100 + 6.7 * i, y = 90 - 5.1 * i;
        CHECK_NEAR(canopy_leaf_area_above(c, x, y, 0), index, 1.0 / 32 + 1e-6); /* the cells' own step */
        CHECK_NEAR(canopy_leaf_area_above(c, x, y, 0.5 * height_m * (1 + crown_low)), index / 2, 0.03);
        CHECK(canopy_leaf_area_above(c, x, y, height_m + 0.2) == 0);
    }
    CHECK(canopy_leaf_area_above(c, 1000, 0, 0) == 0 && canopy_leaf_area_above(c, NAN, 0, 0) == 0);
    canopy_destroy(c);
    /* bare in winter */
    assert_int_equal(canopy_create(&c, &woods, prototypes, false, NULL), STATUS_OK);
    CHECK(canopy_leaf_area_above(c, 0, 0, 0) == 0);
    canopy_destroy(c);
    canopy_destroy(NULL);
}

/* The ground of the orchard in a band whose leaves absorb all: exp(-L / (2 mu)) over the sky; where they absorb 19 %, as
 * of sqrt(0.19) of them; in thermal bands unchanged; beside the orchard as well. */
static void ground_beneath(void **state)
{
    (void)state;
    static float factor[AIR_BAND_COUNT][hits_capacity];
    static Hits  hits;
    Material     rows[2] = {{.name = "none"}, {.name = "leaf"}};
    Materials    m = {.count = 2, .material = rows};
    Canopy      *c = NULL;
    const double index = leaf_area * height_m * height_m / 64;
    for (int kind = 0; kind < PLANT_KINDS; kind++) m.plant[kind][PLANT_LEAF] = 1;
    rows[1].rho[optical_channel_nir] = 0.46f, rows[1].tau[optical_channel_nir] = 0.35f;
    assert_int_equal(canopy_create(&c, &woods, prototypes, true, NULL), STATUS_OK);
    hits.count = 4;
    for (int i = 0; i < 4; i++) {
        hits.range_m[i] = i == 3 ? INFINITY : 100, hits.kind[i] = i == 3 ? hit_sky : i == 2 ? hit_plant : hit_ground;
        hits.p_enu[0][i] = i == 1 ? 900 : 3, hits.p_enu[1][i] = 5;
        hits.sky[i] = 0.04f;
        for (int b = 0; b < AIR_BAND_COUNT; b++) factor[b][i] = 1;
    }
    canopy_open(factor, c, NULL, &m, &hits, (1 << AIR_BAND_COUNT) - 1);
    CHECK_NEAR(factor[AIR_R][0], gap_by_simpson(0.5 * index), 0.03); /* by the step of the leaf area */
    CHECK_NEAR(factor[AIR_NIR][0], gap_by_simpson(0.5 * sqrt(0.19) * index), 0.03);
    /* a place within the crown has the less of the stand's light and its own plant's */
    CHECK_NEAR(factor[AIR_R][2], 0.04, 1e-4);
    CHECK_NEAR(factor[AIR_NIR][2], pow(0.04, sqrt(0.19)), 1e-3);
    for (int i = 0; i < 4; i++) CHECK(factor[AIR_LWIR][i] == 1 && factor[AIR_MWIR][i] == 1);
    for (int b = 0; b < AIR_BAND_COUNT; b++) CHECK(factor[b][1] == 1 && factor[b][3] == 1);
    canopy_destroy(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gap_is_the_integral),
        cmocka_unit_test(leaves_are_where_they_were_put),
        cmocka_unit_test(ground_beneath),
    };
    return cmocka_run_group_tests(tests, open_orchard, close_orchard);
}
