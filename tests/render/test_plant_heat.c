/* Temperatures of leaves against the full, non-linear balance solved by bisection. labels: physics */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(leaf_is_in_balance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
