/* Hot gas in the thermal bands against the narrow-band model it is fitted to, the band intensity of the literature,
 * and what must hold whatever the figures. labels: physics */
#include "tests/check.h"

#include "render/smoke/smoke.h"
#include "render/materials/planck.h"

/* Narrow-band model with the line-by-line parameters of Soufiani & Taine (1997), evaluated outside this program:
 * between the tabulated temperatures parameters are linear, as there. Temperature, atm m of CO2 and H2O, emissivity
 * 3.4 .. 4.8 um and 8 .. 12 um. */
static void slabs_match_line_by_line_bands(void **state)
{
    (void)state;
    static const double want[][5] = {
        {500, 0.001, 0.001, 0.08172, 0.0002243}, {500, 0.02, 0.02, 0.1916, 0.004381},
        {500, 0.1, 0.1, 0.2391, 0.02031},        {500, 0.02, 0, 0.1901, 0.001595},
        {500, 0, 0.1, 0.007385, 0.01254},        {700, 0.001, 0.001, 0.07359, 0.0005524},
        {700, 0.02, 0.02, 0.1992, 0.01042},      {700, 0.1, 0.1, 0.2481, 0.04485},
        {700, 0.02, 0, 0.1972, 0.003085},        {700, 0, 0.1, 0.01079, 0.03007},
        {900, 0.001, 0.001, 0.06735, 0.0009263}, {900, 0.02, 0.02, 0.2122, 0.01708},
        {900, 0.1, 0.1, 0.27, 0.06988},          {900, 0.02, 0, 0.2101, 0.003437},
        {900, 0, 0.1, 0.01279, 0.05359},         {1100, 0.001, 0.001, 0.05728, 0.001304},
        {1100, 0.02, 0.02, 0.2156, 0.02358},     {1100, 0.1, 0.1, 0.2727, 0.09286},
        {1100, 0.02, 0, 0.2133, 0.003787},       {1100, 0, 0.1, 0.0151, 0.07515},
        {1500, 0.001, 0.001, 0.04464, 0.002048}, {1500, 0.02, 0.02, 0.2296, 0.03661},
        {1500, 0.1, 0.1, 0.2974, 0.1389},        {1500, 0.02, 0, 0.227, 0.003049},
        {1500, 0, 0.1, 0.01851, 0.1254},         {1900, 0.001, 0.001, 0.03791, 0.002896},
        {1900, 0.02, 0.02, 0.2389, 0.05174},     {1900, 0.1, 0.1, 0.3156, 0.1939},
        {1900, 0.02, 0, 0.2358, 0.002393},       {1900, 0, 0.1, 0.02159, 0.1843},
        {2300, 0.001, 0.001, 0.0308, 0.003722},  {2300, 0.02, 0.02, 0.2381, 0.0656},
        {2300, 0.1, 0.1, 0.3181, 0.2391},        {2300, 0.02, 0, 0.2346, 0.001751},
        {2300, 0, 0.1, 0.02462, 0.2328},
    };
    double worst[2] = {0, 0};
    for (size_t i = 0; i < sizeof want / sizeof *want; i++)
        for (int band = 0; band < 2; band++) {
            const HotGasColumn column = {want[i][1], want[i][2]};
            const double error = smoke_gas_emissivity((HotGasBand)band, column, want[i][0]) / want[i][3 + band] - 1;
            worst[band] = fmax(worst[band], fabs(error));
        }
    CHECK_NEAR(worst[0], 0, 0.04);
    CHECK_NEAR(worst[1], 0, 0.04);
    /* LWIR over MWIR radiance of exhaust of 0.02 atm m each: the ratio of the two columns above times Planck's */
    for (size_t i = 1; i < sizeof want / sizeof *want; i += 5) {
        const HotGasColumn column = {want[i][1], want[i][2]};
        const double t = want[i][0], black = planck_band(8e-6, 12e-6, t, NULL) / planck_band(3.4e-6, 4.8e-6, t, NULL);
        const double lwir = smoke_gas_emissivity(HOT_GAS_LWIR, column, t);
        const double got = lwir / smoke_gas_emissivity(HOT_GAS_MWIR, column, t) * black;
        CHECK_NEAR(got / (want[i][4] / want[i][3] * black), 1, 0.06);
        CHECK(got < 0.25); /* exhaust is a source of the middle infrared */
    }
}

/* Edwards's exponential wide-band model (1976; Modest, Radiative Heat Transfer, table 11.3) of the 4.3 um band of
 * CO2 at 1 atm, from measured spectra: nothing of it is in the narrow-band model above. Band width A, cm-1. */
static double edwards_width_per_cm(double temp_k, double co2_atm_m)
{
    static const double per_cm[3] = {1351, 667, 2396}, t0_k = 100;
    static const int    degenerate[3] = {1, 2, 1}, steps[3] = {0, 0, 1};
    double              phi[2];
    for (int which = 0; which < 2; which++) {
        double above = 1, below = 1;
        for (int mode = 0; mode < 3; mode++) {
            const double u = 1.4388 * per_cm[mode] / (which ? t0_k : temp_k);
            double       roots = 0, all = 0;
            for (int v = 0; v < 60; v++) {
                const double levels =
                    tgamma(v + degenerate[mode] + steps[mode]) / (tgamma(degenerate[mode]) * tgamma(v + 1));
                roots += sqrt(levels * exp(-u * v)), all += levels * exp(-u * v);
            }
            above *= roots, below *= all;
        }
        phi[which] = above * above / below;
    }
    const double beta = 0.247 * sqrt(t0_k / temp_k) * phi[0] / phi[1] * pow(1 + (1.3 - 1) * 0.1, 0.8);
    const double width = 11.2 * sqrt(temp_k / t0_k);
    const double g_m2 = co2_atm_m * 101325 * 44.01 / (8.314462618 * temp_k), thick = 110 * g_m2 / width;
    if (beta > 1) return width * (thick <= 1 ? thick : log(thick) + 1);
    return width * (thick <= beta       ? thick
                    : thick <= 1 / beta ? 2 * sqrt(thick * beta) - beta
                                        : log(thick * beta) + 2 - beta);
}

static void wide_bands_agree(void **state)
{
    (void)state;
    static const double temps_k[] = {500, 700, 900, 1100, 1500, 1900, 2300};
    for (int i = 0; i < 7; i++) {
        const double t = temps_k[i], width = edwards_width_per_cm(t, 0.02),
                     head = 2410 - 0.5 * width; /* the band ends at 2410 */
        const double low_m = 1e-2 / (head + 5), high_m = 1e-2 / (head - 5);
        const double want = width * planck_band(low_m, high_m, t, NULL) / 10 / planck_band(3.4e-6, 4.8e-6, t, NULL);
        const double got = smoke_gas_emissivity(HOT_GAS_MWIR, (HotGasColumn){0.02, 0}, t);
        print_message("CO2 of %.0f K: %.4f, by Edwards %.4f: %.3f\n", t, got, want, got / want);
        CHECK_NEAR(got / want, 1,
                   t <= 1100 ? 0.1 : 0.27); /* hotter: his strength is 2160 of HITRAN's 2600 cm-2 atm-1 */
    }
}

/* The 4.3 um band's intensity does not depend on temperature but by the gas law: HITRAN's is 2560 .. 2700 cm-2 atm-1
 * at 273.15 K (all isotopologues with hot bands). Thin emissivity = intensity * Planck at 2340 cm-1 over the band. */
static void thin_gas_has_the_bands_intensity(void **state)
{
    (void)state;
    static const double intensity = 2630; /* cm-2 atm-1 */
    for (double temp_k = 700; temp_k <= 2300; temp_k += 400) {
        const double u = 1e-5, low_m = 1 / 235000.0, high_m = 1 / 233000.0;
        const double per_cm = planck_band(low_m, high_m, temp_k, NULL) / 20; /* W/(m2 sr cm-1) about 2340 cm-1 */
        const double want = intensity * 273.15 / temp_k * u * 100 * per_cm / planck_band(3.4e-6, 4.8e-6, temp_k, NULL);
        const double got = smoke_gas_emissivity(HOT_GAS_MWIR, (HotGasColumn){u, 0}, temp_k);
        CHECK_NEAR(got / want, 1, temp_k < 1000 ? 0.25 : 0.15); /* hot bands lie at longer waves */
    }
}

static void limits_hold(void **state)
{
    (void)state;
    for (int band = 0; band < 2; band++)
        for (double temp_k = 250; temp_k <= 2600; temp_k += 50) {
            double before = 0;
            for (double u = 1e-6; u < 1e5; u *= 3) {
                const double e = smoke_gas_emissivity((HotGasBand)band, (HotGasColumn){u, u}, temp_k);
                CHECK((u < 1 ? e > before : e >= before - 1e-14) && e <= 1);
                before = e;
            }
            const double one = smoke_gas_emissivity((HotGasBand)band, (HotGasColumn){1e-9, 1e-9}, temp_k);
            const double two = smoke_gas_emissivity((HotGasBand)band, (HotGasColumn){2e-9, 2e-9}, temp_k);
            CHECK_NEAR(two / one, 2, 1e-4);
        }
    CHECK_NEAR(smoke_gas_emissivity(HOT_GAS_LWIR, (HotGasColumn){0, 0}, 900), 0, 0);
    /* 1 kg/m2 of CO2 at 0 C: a mole fills 22.414 l */
    CHECK_NEAR(smoke_gas_atm_m(1, hot_gas_co2_molar_kg, 273.15), 0.022414 / 0.04401, 1e-4);
}

/* Cold air leaves less of cool gas than of hot, less over longer ranges, never more than of a grey body. */
static void air_takes_the_cold_band(void **state)
{
    (void)state;
    CHECK_NEAR(smoke_gas_passed(0.02, 700, 0), 1, 0);
    CHECK_NEAR(smoke_gas_passed(0.02, 700, 1000), 0.080, 1e-9); /* the two-layer narrow-band model */
    CHECK_NEAR(smoke_gas_passed(0.02, 1500, 1000), 0.342, 1e-9);
    /* Nearer than 10 m absorption grows with the square root of the path, as that of strong lines does: a quarter of
     * the way takes half of what 10 m take (0.520 at 0.02 atm m of 700 K, 0.866 at 0.002 of 300 K, 0.222 at 0.2 of 2300
     * K) */
    static const double taken[][3] = {{0.02, 700, 0.520}, {0.002, 300, 0.866}, {0.2, 2300, 0.222}};
    for (int i = 0; i < 3; i++)
        for (double root = 0.05; root <= 1; root += 0.05)
            CHECK_NEAR(smoke_gas_passed(taken[i][0], taken[i][1], 10 * root * root), 1 - taken[i][2] * root, 1e-9);
    /* between the model's points: by the logarithm of the column and of the path, linear in temperature */
    CHECK_NEAR(smoke_gas_passed(sqrt(0.002 * 0.02), 700, 1000), (0.023 + 0.080) / 2, 1e-9);
    CHECK_NEAR(smoke_gas_passed(sqrt(0.02 * 0.2), 700, 1000), (0.080 + 0.250) / 2, 1e-9);
    CHECK_NEAR(smoke_gas_passed(0.02, 900, 1000), (0.080 + 0.220) / 2, 1e-9);
    CHECK_NEAR(smoke_gas_passed(0.02, 1900, 1000), (0.342 + 0.480) / 2, 1e-9);
    CHECK_NEAR(smoke_gas_passed(0.02, 700, sqrt(300 * 1000.0)), (0.139 + 0.080) / 2, 1e-9);
    CHECK_NEAR(smoke_gas_passed(0.02, 700, sqrt(10000 * 30000.0)), (0.034 + 0.020) / 2, 1e-9);
    /* beyond them as at the last one, at every end */
    CHECK_NEAR(smoke_gas_passed(0.02, 700, 1e6), 0.020, 1e-9);
    CHECK_NEAR(smoke_gas_passed(1e-5, 700, 1000), 0.023, 1e-9);
    CHECK_NEAR(smoke_gas_passed(5, 700, 1000), 0.250, 1e-9);
    CHECK_NEAR(smoke_gas_passed(0.02, 200, 1000), 0.009, 1e-9);
    CHECK_NEAR(smoke_gas_passed(0.02, 3000, 1000), 0.480, 1e-9);
    for (double temp_k = 300; temp_k <= 2300; temp_k += 100) {
        double before = 1;
        for (double range_m = 0.1; range_m < 1e5; range_m *= 1.7) {
            const double now = smoke_gas_passed(0.02, temp_k, range_m);
            CHECK(now >= 0 && now <= before);
            if (temp_k > 300) CHECK(now >= smoke_gas_passed(0.02, temp_k - 100, range_m) - 0.002);
            before = now;
        }
    }
}

/* The two-layer model's ratios (hot_gas.c) between nodes and beyond them: nearer than 10 m what is absorbed goes
 * by the square root of the path, as strong lines absorb (Goody & Yung 1989, ch. 4), from the first node's 1 - 0.480 at
 * 700 K and 1 - 0.134 at 300 K; temperatures go linearly, paths and columns by their logarithms; beyond the ends
 * nothing changes. */
static void what_passes_is_read_between_its_nodes(void **state)
{
    (void)state;
    static const struct {
        double co2_atm_m, temp_k, range_m, want;
    } at[] = {
        {0.02, 700, 10, 0.480},
        {0.02, 700, 2.5, 1 - 0.520 * 0.5},
        {0.02, 700, 0.4, 1 - 0.520 * 0.2},
        {0.002, 300, 0.1, 1 - 0.866 * 0.1},
        {0.002, 300, 10, 0.134},
        {0.2, 2300, 30000, 0.448},
        {0.5, 3000, 1e6, 0.448},
        {1e-4, 200, 10, 0.134},
        {0.002, 2300, 30000, 0.359},
        {0.2, 300, 30000, 0.006},
        {0.2, 300, 10, 0.533},
        {0.2, 1500, 10000, 0.451},
        {0.02, 600, 10, (0.408 + 0.480) / 2},
        {0.02, 2000, 10, 0.652 + 5.0 / 8 * (0.734 - 0.652)},
        {0.02, 700, 17.320508, (0.480 + 0.348) / 2},
        {0.02, 700, 17320.508, (0.034 + 0.020) / 2},
        {0.0063245553, 700, 10, (0.275 + 0.480) / 2},
        {0.063245553, 700, 10, (0.480 + 0.628) / 2},
    };
    for (size_t i = 0; i < sizeof at / sizeof *at; i++)
        CHECK_NEAR(smoke_gas_passed(at[i].co2_atm_m, at[i].temp_k, at[i].range_m), at[i].want, 1e-7);
}

/* Weights between temperatures are linear, and the ends' beyond them: 900 K is between 700 and 1100. */
static void weights_are_read_between_their_nodes(void **state)
{
    (void)state;
    double low[2][hot_gas_terms], high[2][hot_gas_terms], got[2][hot_gas_terms];
    for (int band = 0; band < 2; band++) {
        static const double of[][4] = {/* from, to, at, share of the second */
                                       {700, 1100, 900, 0.5},
                                       {300, 500, 350, 0.25},
                                       {1500, 2300, 2100, 0.75},
                                       {300, 300, 200, 0},
                                       {2300, 2300, 3000, 1}};
        for (int k = 0; k < 5; k++) {
            smoke_gas_weights(low, (HotGasBand)band, of[k][0]);
            smoke_gas_weights(high, (HotGasBand)band, of[k][1]);
            smoke_gas_weights(got, (HotGasBand)band, of[k][2]);
            for (int g = 0; g < 2; g++)
                for (int j = 0; j < hot_gas_terms; j++)
                    CHECK_NEAR(got[g][j], low[g][j] + of[k][3] * (high[g][j] - low[g][j]), 1e-12);
        }
    }
}

/* Beer's law: a slab is the same in parts, exp(-a) exp(-b) = exp(-(a + b)), to the 1e-12 of its term that absorbs by
 * 1 - exp, by whichever formula each part's depth has. A thin slab's terms are depths a part of which is 1e-3 and less.
 */
static void a_slab_is_the_same_in_parts(void **state)
{
    (void)state;
    static const double share[3] = {0.5, 0.3, 0.2};
    for (int band = 0; band < 2; band++)
        for (int gas = 0; gas < 2; gas++)
            for (double u = 1e-8; u < 10; u *= 1.5) {
                HotGasRay          whole, parts;
                double             w[2][hot_gas_terms], got = 0;
                const HotGasColumn column = {gas ? 0 : u, gas ? u : 0};
                smoke_gas_weights(w, (HotGasBand)band, 500);
                smoke_gas_start(&whole), smoke_gas_start(&parts);
                const double want =
                    smoke_gas_through(&whole, (HotGasBand)band, column, (const double(*)[hot_gas_terms])w);
                for (int k = 0; k < 3; k++) {
                    const HotGasColumn part = {share[k] * column.co2_atm_m, share[k] * column.h2o_atm_m};
                    got = smoke_gas_through(&parts, (HotGasBand)band, part, (const double(*)[hot_gas_terms])w);
                }
                CHECK_NEAR(got / want, 1, 1e-11);
            }
}

/* What hot gas keeps of its band behind cold air, at all points of the two-layer model: more air takes more; gas that
 * is hotter has more lines that air has not; a longer hot column of gas up to 1500 K, whose wings count for more, keeps
 * more. Read at the points themselves. */
static void every_point_keeps_its_order(void **state)
{
    (void)state;
    static const double column_atm_m[] = {0.002, 0.02, 0.2}, temp_k[] = {300, 500, 700, 1100, 1500, 2300};
    static const double path_m[] = {10, 30, 100, 300, 1000, 3000, 10000, 30000};
    for (int c = 0; c < 3; c++)
        for (int t = 0; t < 6; t++)
            for (int p = 0; p < 8; p++) {
                const double at = smoke_gas_passed(column_atm_m[c], temp_k[t], path_m[p]);
                if (p > 0) CHECK(at <= smoke_gas_passed(column_atm_m[c], temp_k[t], path_m[p - 1]) + 1e-9);
                if (t > 0) CHECK(at >= smoke_gas_passed(column_atm_m[c], temp_k[t - 1], path_m[p]) - 1e-9);
                if (c > 0 && t < 5) CHECK(at >= smoke_gas_passed(column_atm_m[c - 1], temp_k[t], path_m[p]) - 1e-9);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slabs_match_line_by_line_bands),
        cmocka_unit_test(wide_bands_agree),
        cmocka_unit_test(thin_gas_has_the_bands_intensity),
        cmocka_unit_test(limits_hold),
        cmocka_unit_test(air_takes_the_cold_band),
        cmocka_unit_test(what_passes_is_read_between_its_nodes),
        cmocka_unit_test(weights_are_read_between_their_nodes),
        cmocka_unit_test(a_slab_is_the_same_in_parts),
        cmocka_unit_test(every_point_keeps_its_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
