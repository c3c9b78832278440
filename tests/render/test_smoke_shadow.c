/* Shadows of smoke and dust, and what a thick cloud of grains sends back: closed forms, and photons one by one. */
#include "tests/check.h"

#include "render/smoke/smoke.h"

static const double sun_d_enu[3] = {0.48, -0.36, 0.8};

static SmokeVolume ball(double x, double y, double z, double radius_m, double shades_per_m)
{
    return (SmokeVolume){.p_enu = {x, y, z},
                         .axis_enu = {0, 0, 1},
                         .along_m = radius_m,
                         .across_m = radius_m,
                         .shades_per_m = shades_per_m,
                         .d_sun_enu = {sun_d_enu[0], sun_d_enu[1], sun_d_enu[2]}};
}

/* The column of a ball through which the ray passes at q radii from its middle: density (1 - q^2)^2 there, and the
 * integral of (h^2 - u^2)^2 over a chord, h^2 = 1 - q^2, is 16 / 15 h^5. */
static double column_m(double q, double radius_m) { return q < 1 ? 16.0 / 15 * pow(1 - q * q, 2.5) * radius_m : 0; }

static void a_ball_dims_the_sun(void **state)
{
    (void)state;
    static Hits hits;
    float       sun[hits_capacity];
    double      q[hits_capacity];
    /* places about the shadow's middle, 12 m below the ball along the sun's ray; aside of it: (0.6, 0.8, 0) */
    const SmokeVolume v[2] = {ball(12 * 0.48, -12 * 0.36, 12 * 0.8, 3, 0.4),
                              ball(12 * 0.48, -12 * 0.36, 12 * 0.8, 3, 0)};
    hits.count = hits_capacity;
    for (int i = 0; i < hits.count; i++) {
        const double aside_m = -4 + 8.0 * i / (hits.count - 1);
        q[i] = fabs(aside_m) / 3;
        hits.p_enu[0][i] = 0.6 * aside_m, hits.p_enu[1][i] = 0.8 * aside_m, hits.p_enu[2][i] = 0;
        hits.range_m[i] = i % 7 == 3 ? INFINITY : 50;
        sun[i] = i % 5 == 1 ? 0 : 1;
    }
    smoke_shadow(sun, v, 2, &hits, sun_d_enu);
    for (int i = 0; i < hits.count; i++) {
        const bool there = hits.range_m[i] < INFINITY && i % 5 != 1;
        CHECK_NEAR(sun[i], i % 5 == 1 ? 0 : there ? exp(-0.4 * column_m(q[i], 3)) : 1, 1e-6);
    }
    /* one behind another: depths add up; beyond the places, away from the sun: nothing */
    const SmokeVolume two[3] = {v[0], ball(30 * 0.48, -30 * 0.36, 30 * 0.8, 2, 0.7),
                                ball(-9 * 0.48, 9 * 0.36, -9 * 0.8, 3, 5)};
    hits.count = 1, hits.range_m[0] = 50, sun[0] = 1;
    for (int k = 0; k < 3; k++) hits.p_enu[k][0] = 0;
    smoke_shadow(sun, two, 3, &hits, sun_d_enu);
    CHECK_NEAR(sun[0], exp(-0.4 * column_m(0, 3) - 0.7 * column_m(0, 2)), 1e-6);
    /* a place within the ball has the half above it */
    for (int k = 0; k < 3; k++) hits.p_enu[k][0] = v[0].p_enu[k];
    sun[0] = 1;
    smoke_shadow(sun, v, 1, &hits, sun_d_enu);
    CHECK_NEAR(sun[0], exp(-0.5 * 0.4 * column_m(0, 3)), 1e-6);
    /* thick as it may be, some is left: nothing but solid shade is dark */
    const SmokeVolume black = ball(12 * 0.48, -12 * 0.36, 12 * 0.8, 3, 1e6);
    for (int k = 0; k < 3; k++) hits.p_enu[k][0] = 0;
    sun[0] = 1;
    smoke_shadow(sun, &black, 1, &hits, sun_d_enu);
    CHECK(sun[0] > 0 && sun[0] < 2e-6f);
    /* at night none */
    sun[0] = 1;
    smoke_shadow(sun, v, 1, &hits, (const double[3]){0.6, 0, -0.8});
    CHECK(sun[0] == 1);
}

/* The same bits in one block and hit by hit: a hit's shadow is its own. */
static void blocks_change_no_bit(void **state)
{
    (void)state;
    enum { volumes = 60, many = 200 };
    static SmokeVolume v[volumes];
    static Hits        all, one;
    float              sun[hits_capacity], alone;
    for (uint64_t n = 0; n < volumes; n++)
        v[n] = ball(40 * random_uniform(1, 0, 0, n), 40 * random_uniform(1, 1, 0, n), 9 * random_uniform(1, 2, 0, n),
                    0.5 + 3 * random_uniform(1, 3, 0, n), 0.3 * random_uniform(1, 4, 0, n));
    all.count = many, one.count = 1;
    for (int i = 0; i < many; i++) {
        all.p_enu[0][i] = 40 * random_uniform(2, 0, 0, (uint64_t)i),
        all.p_enu[1][i] = 40 * random_uniform(2, 1, 0, (uint64_t)i);
        all.p_enu[2][i] = random_uniform(2, 2, 0, (uint64_t)i), all.range_m[i] = 50, sun[i] = 1;
    }
    smoke_shadow(sun, v, volumes, &all, sun_d_enu);
    int dimmed = 0;
    for (int i = 0; i < many; i++) {
        for (int k = 0; k < 3; k++) one.p_enu[k][0] = all.p_enu[k][i];
        one.range_m[0] = 50, alone = 1;
        smoke_shadow(&alone, v, volumes, &one, sun_d_enu);
        assert_memory_equal(&alone, &sun[i], sizeof alone);
        dimmed += alone < 1;
    }
    CHECK(dimmed > many / 4);
}

/* Photons of even light into a half space of isotropic scatterers: how many come back. 200,000 of them have a standard
 * error of 0.0009 at most. */
static void thick_clouds_send_back(void **state)
{
    (void)state;
    enum { photons = 200000 };
    for (int a = 0; a < 4; a++) {
        const double albedo = (const double[]){0.2, 0.34, 0.6, 0.87}[a];
        double       back = 0;
        for (uint64_t n = 0; n < photons; n++) {
            uint32_t draw = 0;
            double   depth = 0, cosine = sqrt(random_uniform(5, draw++, (uint32_t)a, n)), weight = 1;
            for (int step = 0; step < 400; step++) {
                depth -= cosine * log(1 - random_uniform(5, draw++, (uint32_t)a, n));
                if (depth < 0) {
                    back += weight / photons;
                    break;
                }
                if (random_uniform(5, draw++, (uint32_t)a, n) > albedo) break;
                cosine = 2 * random_uniform(5, draw++, (uint32_t)a, n) - 1;
            }
        }
        print_message("albedo %.2f: %.4f come back, ours %.4f\n", albedo, back, smoke_thick_albedo(albedo));
        CHECK_NEAR(smoke_thick_albedo(albedo), back, 0.003 + 0.003);
    }
    CHECK(smoke_thick_albedo(0) == 0);
    CHECK_NEAR(smoke_thick_albedo(1), 1, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_ball_dims_the_sun), cmocka_unit_test(blocks_change_no_bit),
                                       cmocka_unit_test(thick_clouds_send_back)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
