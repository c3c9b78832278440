/* Temperatures of leaves against the full, non-linear balance solved by bisection, and by its linear form to the digit.
 * labels: physics */
#include "tests/check.h"

#include "render/light/thermal.h"

static Material leaf_row(void)
{
    return (Material){.name = "leaf",
                      .rho_lwir = 0.03f,
                      .solar_absorptance = 0.51f,
                      .conductivity_w_mk = 0.3f,
                      .density_kg_m3 = 700,
                      .heat_capacity_j_kgk = 3500};
}

static Daylight day(double direct_w_m2, double diffuse_w_m2, double loss_w_m2, double wind_mps)
{
    Daylight light = {
        .solar_direct_w_m2 = direct_w_m2, .solar_diffuse_w_m2 = diffuse_w_m2, .longwave_loss_w_m2 = loss_w_m2};
    light.weather = weather_default();
    light.weather.wind_mps = wind_mps;
    light.sun_d_enu[2] = direct_w_m2 > 0 ? 1 : -1;
    return light;
}

/* Saturation of water vapour by the Magnus form of Alduchov & Eskridge (J. Appl. Meteor. 35, 601, 1996), Pa. */
static double magnus_pa(double temp_k)
{
    const double c = temp_k - 273.15;
    return 610.94 * exp(17.625 * c / (243.04 + c));
}

/* What a leaf at temp_k gains, W per m2 of leaf, one side counted: Campbell & Norman (1998), eq. 14.1, each term in
 * full. */
static double leaf_gain(const Daylight *light, const Material *m, double air_k, double open, double temp_k)
{
    const double wind = fmax(light->weather.wind_mps, 0.3), sigma = 5.670374419e-8,
                 emissivity = 1 - (double)m->rho_lwir;
    const double layer = 1.4 * 0.135 * sqrt(wind / (0.72 * 0.05)), wet_layer = 1.4 * 0.147 * sqrt(wind / (0.72 * 0.05));
    const double sun = open * (0.5 * light->solar_direct_w_m2 + light->solar_diffuse_w_m2);
    const double stomata = 0.2 * (0.05 + 0.95 * fmin(sun / 250, 1)), wet = stomata * wet_layer / (stomata + wet_layer);
    return (double)m->solar_absorptance * sun - emissivity * open * light->longwave_loss_w_m2 -
           2 * emissivity * sigma * (pow(temp_k, 4) - pow(air_k, 4)) - 2 * 29.3 * layer * (temp_k - air_k) -
           44000 * wet * (magnus_pa(temp_k) - 0.6 * magnus_pa(air_k)) / 101325;
}

static double leaf_by_bisection(const Daylight *light, const Material *m, double air_k, double open)
{
    double low = air_k - 60, high = air_k + 60;
    for (int k = 0; k < 60; k++) {
        const double middle = 0.5 * (low + high);
        if (leaf_gain(light, m, air_k, open, middle) > 0) low = middle;
        else high = middle;
    }
    return 0.5 * (low + high);
}

static void leaf_is_in_balance(void **state)
{
    (void)state;
    const Material m = leaf_row();
    const double   wind[] = {0.1, 1, 3, 10}, air_k[] = {268, 288, 303}, direct[] = {0, 400, 900}, open[] = {0, 0.3, 1};
    double         most = 0, coldest = 0, warmest = 0;
    for (int k = 0; k < 4 * 3 * 3 * 3; k++) {
        const double   sun = direct[k % 3], air = air_k[k / 3 % 3], share = open[k / 9 % 3];
        const Daylight light = day(sun, sun / 6, 90, wind[k / 27]);
        const double   found = thermal_leaf_k(&light, &m, air, share, share),
                     expected = leaf_by_bisection(&light, &m, air, share);
        most = fmax(most, fabs(found - expected));
        warmest = fmax(warmest, found - air), coldest = fmin(coldest, found - air);
        CHECK_NEAR(found, expected, 0.05 + 0.05 * fabs(expected - air));
    }
    print_message("worst %.2f K; leaves %.1f to %.1f K above the air\n", most, coldest, warmest);
    CHECK(warmest < 15 && coldest > -8);
    /* by day warmer in calm air than in wind, and in the open than in the shade; by night colder than the air */
    const Daylight calm = day(800, 120, 90, 0.5), windy = day(800, 120, 90, 8), night = day(0, 0, 90, 2);
    CHECK(thermal_leaf_k(&calm, &m, 295, 1, 1) > thermal_leaf_k(&windy, &m, 295, 1, 1));
    CHECK(thermal_leaf_k(&calm, &m, 295, 1, 1) > thermal_leaf_k(&calm, &m, 295, 0.1, 0.1));
    CHECK(thermal_leaf_k(&night, &m, 285, 1, 1) < 285);
}

/* The balance about the temperature of the air (Campbell & Norman 1998, eq. 14.6, with both sides' film):
 *     T - T_air = (a S - e loss open - l g (1 - h) p / P) / (2 c g_a + 8 e sigma T_air^3 + l g s / P)
 * S = lit x direct / 2 + open x diffuse (a leaf of any tilt, sun up), e = 1 - rho - tau in 8-12 um, c = 29.3 J/(mol K),
 * l = 44 kJ/mol, P = 101,325 Pa; g_a = 1.4 x 0.135 sqrt(u / (0.72 x 0.05 m)), u no less than 0.3 m/s; stomata of
 * 0.2 (0.05 + 0.95 min(S / 250, 1)) in series with 1.09 g_a; p = 611 exp(17.502 C / (C + 240.97)) Pa (Tetens, their eq.
 * 3.8) and s its slope. */
static double leaf_on_paper(const Daylight *light, const Material *m, double air_k, double open, double lit)
{
    const double u = fmax(light->weather.wind_mps, 0.3), film = 1.4 * 0.135 * sqrt(u / (0.72 * 0.05));
    const double sun =
        (light->sun_d_enu[2] > 0 ? lit * light->solar_direct_w_m2 / 2 : 0) + open * light->solar_diffuse_w_m2;
    const double stomata = 0.2 * (0.05 + 0.95 * fmin(sun / 250, 1)),
                 wet = stomata * 1.09 * film / (stomata + 1.09 * film);
    const double c = air_k - 273.15, p = 611 * exp(17.502 * c / (c + 240.97)),
                 slope = p * 17.502 * 240.97 / pow(c + 240.97, 2);
    const double e = 1 - (double)m->rho_lwir - (double)m->tau_lwir, per = 44000 * wet / 101325;
    return air_k + ((double)m->solar_absorptance * sun - e * light->longwave_loss_w_m2 * open -
                    per * (1 - light->weather.humidity) * p) /
                       (2 * 29.3 * film + 8 * e * 5.670374419e-8 * pow(air_k, 3) + per * slope);
}

static void leaf_is_as_on_paper(void **state)
{
    (void)state;
    static const double wind[] = {0, 0.2, 0.4, 3, 10}, air_k[] = {263, 284, 305}, open[] = {0.2, 0.9},
                        lit[] = {0, 0.7, 1}, direct[] = {0, 150, 800};
    Material m = leaf_row();
    for (int k = 0; k < 5 * 3 * 2 * 3 * 3 * 2; k++) {
        Daylight light = day(direct[k / 90 % 3], 40 + direct[k / 90 % 3] / 5, 90, wind[k % 5]);
        light.weather.humidity = k % 2 ? 0.35 : 0.8;
        m.tau_lwir = k % 2 ? 0.04f : 0;
        if (k / 270 % 2) light.sun_d_enu[2] = -0.1; /* what shines is below the horizon */
        const double air = air_k[k / 5 % 3], o = open[k / 15 % 2], l = lit[k / 30 % 3];
        CHECK_NEAR(thermal_leaf_k(&light, &m, air, o, l), leaf_on_paper(&light, &m, air, o, l), 1e-6);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(leaf_is_in_balance),
        cmocka_unit_test(leaf_is_as_on_paper),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
