/* Hot gas along rays: chords of a uniform volume against the narrow-band model, volumes that share a ray against one
 * that holds all their gas, two temperatures against the transport of every grey gas, and gas that cannot be seen.
 * labels: physics */
#include "tests/check.h"

#include "render/smoke/smoke.h"

static Rays      rays;
static double    far_m[hits_capacity];
static SmokeRays out;
enum { mwir = smoke_bands - 2, lwir = smoke_bands - 1, most_volumes = 120 };
static const unsigned thermal = 1u << mwir | 1u << lwir;

static SmokeVolume volume[most_volumes];
static SmokeGas    gas[most_volumes];

/* A uniform ball above the origin. */
static void put(int i, double z_m, double radius_m, double co2_atm, double h2o_atm, double temp_k, double source)
{
    gas[i] = (SmokeGas){.co2_atm = co2_atm, .h2o_atm = h2o_atm, .passed = {1, 1, 1}, .source = {source, source}};
    for (int band = 0; band < 2; band++) smoke_gas_weights(gas[i].weight[band], (HotGasBand)band, temp_k);
    volume[i] = (SmokeVolume){.p_enu = {0, 0, z_m},
                              .axis_enu = {1, 0, 0},
                              .along_m = radius_m,
                              .across_m = radius_m,
                              .range_m = z_m,
                              .even = true,
                              .d_sun_enu = {0, 0.6, 0.8},
                              .gas = &gas[i]};
}

/* Upwards, x beside the axis. */
static void look(int count, double x_m)
{
    int list[most_volumes];
    for (int i = 0; i < count; i++) list[i] = i;
    rays.count = 1;
    rays.o_enu[0][0] = x_m;
    rays.d_enu[2][0] = 1;
    far_m[0] = INFINITY;
    smoke_trace_rays(&out, volume, list, count, &rays, far_m, thermal);
}

static double seen(int band) { return 1 - (double)out.transmittance[band][0]; }

/* A quarter to four times 0.02 atm m of CO2, by the chord: the narrow-band model (25 cm-1, Malkmus lines, parameters of
 * Soufiani & Taine 1997 at their own temperatures, 10 % of each gas in air), evaluated outside this program. What a
 * grey volume makes of it that is right at 0.02 atm m is beside it. */
static void every_chord_has_its_emissivity(void **state)
{
    (void)state;
    static const double times[5] = {0.25, 0.5, 1, 2, 4}, temp_k[3] = {700, 1100, 1500};
    static const double want[3][5] = {{0.1464, 0.1738, 0.1984, 0.2221, 0.2453},
                                      {0.1505, 0.1890, 0.2208, 0.2483, 0.2732},
                                      {0.1440, 0.1951, 0.2365, 0.2687, 0.2962}};
    double              worst = 0, worst_grey = 0;
    for (int t = 0; t < 3; t++) {
        put(0, 100, 1, 0.04, 0, temp_k[t], 1); /* 0.08 atm m through its middle */
        const double grey = -log1p(-want[t][2]);
        for (int k = 0; k < 5; k++) {
            look(1, sqrt(1 - times[k] * times[k] / 16));
            worst = fmax(worst, fabs(seen(mwir) / want[t][k] - 1));
            worst_grey = fmax(worst_grey, fabs(-expm1(-grey * times[k]) / want[t][k] - 1));
            CHECK_NEAR((double)out.added[mwir][0], seen(mwir), 1e-6);
        }
    }
    print_message("a quarter to four times the column, CO2: %.1f %%; grey: %.0f %%\n", 100 * worst, 100 * worst_grey);
    CHECK_NEAR(worst, 0, 0.1);
    CHECK(worst_grey > 0.6);
    /* both gases in 8 .. 12 um: the same model, from tests/render/test_hot_gas.c; 0.001, 0.02 and 0.1 atm m of each */
    static const double long_k[4] = {500, 700, 1100, 1500}, chord_m[3] = {0.02, 0.4, 2};
    static const double long_want[4][3] = {{0.0002243, 0.004381, 0.02031},
                                           {0.0005524, 0.01042, 0.04485},
                                           {0.001304, 0.02358, 0.09286},
                                           {0.002048, 0.03661, 0.1389}};
    static const double short_want[4][3] = {
        {0.08172, 0.1916, 0.2391}, {0.07359, 0.1992, 0.2481}, {0.05728, 0.2156, 0.2727}, {0.04464, 0.2296, 0.2974}};
    double worst_long = 0;
    for (int t = 0; t < 4; t++) {
        put(0, 100, 1, 0.05, 0.05, long_k[t], 1);
        for (int k = 0; k < 3; k++) {
            look(1, sqrt(1 - 0.25 * chord_m[k] * chord_m[k]));
            worst_long = fmax(worst_long, fabs(seen(lwir) / long_want[t][k] - 1));
            worst_long = fmax(worst_long, fabs(seen(mwir) / short_want[t][k] - 1));
        }
    }
    print_message("0.001 to 0.1 atm m, both: %.1f %%\n", 100 * worst_long);
    CHECK_NEAR(worst_long, 0, 0.04);
}

/* However the same gas is cut into volumes, in one place, overlapping or far behind one another: its whole column's
 * emissivity, also beyond the number that is composited together. 3e-7: floats. */
static void columns_add(void **state)
{
    (void)state;
    for (int band = 0; band < 2; band++) {
        const double want = smoke_gas_emissivity((HotGasBand)band, (HotGasColumn){0.03, 0.02}, 900);
        put(0, 100, 1, 0.015, 0.01, 900, 7);
        look(1, 0);
        CHECK_NEAR(seen(mwir + band), want, 3e-7);
        for (int i = 0; i < 3; i++) put(i, 100, 1, 0.005, 0.01 / 3, 900, 7); /* in one place */
        look(3, 0);
        CHECK_NEAR(seen(mwir + band), want, 3e-7);
        for (int i = 0; i < 5; i++) put(i, 100 + 0.7 * i, 1, 0.003, 0.002, 900, 7); /* a plume's puffs, overlapping */
        look(5, 0);
        CHECK_NEAR(seen(mwir + band), want, 3e-7);
        CHECK_NEAR((double)out.added[mwir + band][0], 7 * want, 7 * 3e-7);
        for (int i = 0; i < most_volumes; i++)
            put(i, 100 + 50 * i, 1, 0.015 / most_volumes, 0.01 / most_volumes, 900, 7);
        look(most_volumes, 0);
        CHECK_NEAR(seen(mwir + band), want, 1e-6);
    }
}

/* Gas as warm as what is behind it, with soot and without, of any columns, whatever the air takes: not to be seen. */
static void isothermal_gas_is_invisible(void **state)
{
    (void)state;
    for (uint32_t trial = 0; trial < 300; trial++) {
        for (int i = 0; i < 6; i++) {
            double u[6];
            for (int k = 0; k < 6; k++) u[k] = random_uniform(5, 1, trial, (uint64_t)(6 * i + k));
            put(i, 100 + 3 * u[0], 0.5 + u[1], pow(10, 3 * u[2] - 4), pow(10, 3 * u[3] - 4), 900, 5);
            for (int k = 0; k < hot_gas_passed_nodes; k++) gas[i].passed[k] = 0.1 + 0.2 * k;
            volume[i].even = u[4] < 0.5;
            for (int b = 0; b < smoke_bands; b++)
                volume[i].extinction_per_m[b] = i % 2 ? 0.3 * u[5] : 0, volume[i].source[b] = 5;
        }
        look(6, 0.3);
        for (int b = mwir; b <= lwir; b++) {
            CHECK(seen(b) > 0 && seen(b) < 1);
            CHECK_NEAR(5 * (double)out.transmittance[b][0] + (double)out.added[b][0], 5, 5e-6);
        }
    }
}

/* Radiance of uniform layers, front to back, by the transport of every pair of grey gases of the two sums. */
static double transported(HotGasBand band, const double temp_k[], const double co2_atm_m[], const double h2o_atm_m[],
                          const double source[], int layers)
{
    static double weight[8][2][hot_gas_terms];
    double        rate[2][hot_gas_terms], sum = 0;
    for (int l = 0; l < layers; l++) smoke_gas_weights(weight[l], band, temp_k[l]);
    for (int g = 0; g < 2; g++) /* rates, from the function itself: a thin column of one term */
        for (int j = 0; j < hot_gas_terms; j++) {
            double       one[2][hot_gas_terms] = {{0}};
            const double u = 1e-9;
            HotGasRay    ray;
            smoke_gas_start(&ray);
            one[g][j] = 1;
            const HotGasColumn thin = {g ? 0 : u, g ? u : 0};
            rate[g][j] = smoke_gas_through(&ray, band, thin, (const double(*)[hot_gas_terms])one) / u;
        }
    for (int i = 0; i <= hot_gas_terms; i++)
        for (int j = 0; j <= hot_gas_terms; j++) { /* the last of each: what is transparent */
            double through = 1;
            for (int l = 0; l < layers; l++) {
                double a = 1, b = 1;
                for (int k = 0; k < hot_gas_terms; k++) a -= weight[l][0][k], b -= weight[l][1][k];
                if (i < hot_gas_terms) a = weight[l][0][i];
                if (j < hot_gas_terms) b = weight[l][1][j];
                const double co2 = i < hot_gas_terms ? rate[0][i] * co2_atm_m[l] : 0;
                const double h2o = j < hot_gas_terms ? rate[1][j] * h2o_atm_m[l] : 0;
                sum += a * b * source[l] * through * -expm1(-co2 - h2o);
                through *= exp(-co2 - h2o);
            }
        }
    return sum;
}

/* A hot core in a cooler sheath, and the other way round; sources in the ratios of 3.4 .. 4.8 um. */
static void temperatures_mix(void **state)
{
    (void)state;
    static const double source[2] = {1, 8};
    double              worst[2] = {0, 0};
    for (int order = 0; order < 3; order++)
        for (double u = 1e-5; u < 0.2; u *= 4) {
            static const double k_of[3][3] = {{700, 1100, 700}, {1100, 700, 1100}, {700, 900, 1100}};
            const double        co2[3] = {u, u, u}, h2o[3] = {0.8 * u, 0.8 * u, 0.8 * u};
            double              from[3];
            for (int l = 0; l < 3; l++) {
                from[l] = source[0] + (k_of[order][l] - 700) / 400 * (source[1] - source[0]);
                put(l, 100 + 3 * l, 1, 0.5 * co2[l], 0.5 * h2o[l], k_of[order][l], from[l]);
            }
            look(3, 0);
            for (int band = 0; band < 2; band++) {
                const double want = transported((HotGasBand)band, k_of[order], co2, h2o, from, 3);
                const double off = (double)out.added[mwir + band][0] / want - 1;
                if (u < 2e-5) CHECK_NEAR(off, 0, band ? 1e-3 : 0.05); /* thin: exact but for the strongest gases */
                worst[band] = fmax(worst[band], fabs(off));
            }
        }
    print_message("sheath and core of 400 K between them: medium wave %.1f %%, long wave %.1f %%\n", 100 * worst[0],
                  100 * worst[1]);
    CHECK_NEAR(worst[0], 0, 0.03); /* overlap of the gases at random: of means, not of each pair */
    CHECK_NEAR(worst[1], 0, 0.05);
}

/* Gases of two temperatures whose weights sum to more than 1 are together as black as a body can be: water vapour of
 * 2300 K takes 0.97 of 8 .. 12 um in 3 atm m, and much of it of 300 K the rest. What is behind is seen by 1e-12; and
 * each shows its own source, for what it takes. */
static void gas_is_not_blacker_than_black(void **state)
{
    (void)state;
    put(0, 100, 1, 0, 1.5, 2300, 5);
    put(1, 200, 1, 0, 1e6, 300, 7);
    look(2, 0);
    const double hot = smoke_gas_emissivity(HOT_GAS_LWIR, (HotGasColumn){0, 3}, 2300);
    CHECK(hot > 0.9 && hot < 0.99);
    CHECK_NEAR((double)out.transmittance[lwir][0], 1e-12, 1e-14);
    CHECK_NEAR((double)out.added[lwir][0], 5 * hot + 7 * (1 - hot), 2e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_chord_has_its_emissivity), cmocka_unit_test(columns_add),
        cmocka_unit_test(isothermal_gas_is_invisible),    cmocka_unit_test(temperatures_mix),
        cmocka_unit_test(gas_is_not_blacker_than_black),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
