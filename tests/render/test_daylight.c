/* Sun and sky over the day and the year: the disc, twilight, clouds, the distance. labels: physics */
#include "tests/render/air_stage.h"

static AirPaths veils;

static void sun_disc_adds_up(void **state)
{
    (void)state;
    static const double sky[AIR_BAND_COUNT] = {0};
    Air                 air;
    air_even(&air, sun_at_elevation(30).d_enu, 1, sky, 0, mwir, lwir);
    /* rings about the sun */
    double u[3] = {0, 0, 1}, w[3], sum = 0;
    v3_cross(w, u, air.light.sun_d_enu);
    CHECK(v3_normalize(w, w));
    v3_cross(u, air.light.sun_d_enu, w);
    const int    n = 2000;
    const double reach_rad = 0.01;
    for (int i = 0; i < n; i++) {
        const double angle = (i + 0.5) / n * reach_rad;
        double       d_enu[3];
        v3_scale(d_enu, cos(angle), air.light.sun_d_enu);
        v3_add_scaled(d_enu, d_enu, sin(angle), u);
        sum += daylight_sun_disc(&air.light, d_enu) * 2 * pi_rad * sin(angle) * reach_rad / n;
    }
    CHECK_NEAR(sum, 1, 2e-3); /* the rim falls within one ring of 930 */
}

static void light_fades_smoothly(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    double        last[AIR_BAND_COUNT] = {0};
    for (double e = -30; e <= 90; e += 0.5) {
        const Air    air = air_of(&weather, e, 2, 1 << AIR_PAN, NULL);
        const double sun = air.light.sun_w_m2[AIR_PAN], sky = air.light.sky_w_m2[AIR_PAN];
        const double level = fmax(sun * sin(e * rad_per_deg), 0) + sky;
        CHECK(isfinite(sun) && sun >= 0 && sky > 0 && sky < 250);
        if (e < -0.27) CHECK(sun == 0);
        /* half a degree: no jump, and more light for a higher sun; the steepest, at -6.8 degrees, is 10^(0.5 * 0.499) =
         * 1.78: (12.17 + 2 * 431.69 x - 3 * 1899.83 x^2) / 90 decades a degree at x = 6.8 / 90 */
        if (e > -30) CHECK(level >= 0.999 * last[0] && level <= last[0] * 1.8 + 1e-9);
        last[0] = level;
    }
    const Air night = air_of(&weather, -40, 500, all_bands, NULL);
    CHECK(night.light.sky_w_m2[AIR_PAN] > 1e-7 && night.light.sky_w_m2[AIR_PAN] < 1e-4 &&
          night.light.sun_w_m2[AIR_MWIR] == 0);
    CHECK(daylight_sky(&night.light, AIR_MWIR, (double[3]){0, 0, 1}) > 0.01);
}

/* Light of b, g and r as illuminance: 683 lm/W times the mean of V over each (CIE 1924: 0.0745, 0.790, 0.206). */
static double illuminance_lx(const Daylight *light)
{
    static const double lm_w[3] = {683 * 0.0745, 683 * 0.790, 683 * 0.206};
    double              sum = 0;
    for (int b = 0; b < 3; b++)
        sum += lm_w[b] * (light->sky_w_m2[AIR_B + b] + fmax(light->sun_d_enu[2], 0) * light->sun_w_m2[AIR_B + b]);
    return sum;
}

/* Clear skies at 23 km against Janiczek & DeYoung (USNO Circular 171, 1987): 4480 lx with the sun 5 degrees up, 759 at
 * the horizon, 405 at -1 degree, 79.1 at -3, 29.9 at -4, 3.41 at -6, 0.348 at -8, 0.116 at -9, 0.0171 at -11, 0.00805
 * at -12, 0.00202 at -15, 0.00065 at -18 and by night, worked out from its coefficients: at -6, x = -6 / 90, 2.70
 * + 12.17 x - 431.69 x^2 - 1899.83 x^3 = 0.533. The level at the horizon is LOWTRAN7's air by adding and doubling, not
 * fitted to it. Light is blue: of equal energy b over g would be 1.02 in D65; twilight has 1.5 at the horizon and 2.0
 * at -6 degrees, where ozone has taken a quarter of g. Night is as red as airglow is: r over g 1.14 per wavelength
 * (Patat 2003: V 21.6, R 20.9), nir over g 7.2. The sun's own light comes with the share of its disc, 0.533 degrees
 * wide, that is above the horizon. */
static void light_fades_as_measured(void **state)
{
    (void)state;
    static const double of[][2] = {{5, 4480},      {0, 759},       {-1, 405},     {-3, 79.1},    {-4, 29.9},
                                   {-6, 3.41},     {-8, 0.348},    {-9, 0.116},   {-11, 0.0171}, {-12, 0.00805},
                                   {-15, 0.00202}, {-18, 0.00065}, {-40, 0.00065}};
    const Weather       weather = us1976_weather();
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const Daylight light = air_of(&weather, of[i][0], 2, 0xf | 1 << AIR_NIR, NULL).light;
        CHECK_NEAR(illuminance_lx(&light) / of[i][1], 1, of[i][0] > 0 ? 0.05 : 0.015);
        CHECK_NEAR(light.sky_w_m2[AIR_B] + light.sky_w_m2[AIR_G] + light.sky_w_m2[AIR_R], light.sky_w_m2[AIR_PAN],
                   1e-5 * light.sky_w_m2[AIR_PAN]);
        const double blue = light.sky_w_m2[AIR_B] / light.sky_w_m2[AIR_G],
                     red = light.sky_w_m2[AIR_R] / light.sky_w_m2[AIR_G];
        if (of[i][0] == 0) CHECK(blue > 1.4 && blue < 1.65 && red < 0.85);
        if (of[i][0] <= -4 && of[i][0] >= -12) CHECK(blue > 1.9 && blue < 2.2 && red < 0.9);
        if (of[i][0] <= -18) CHECK_NEAR(blue, 0.69, 0.03);
        if (of[i][0] <= -18) CHECK_NEAR(red, 1.14, 0.04);
        if (of[i][0] <= -18) CHECK_NEAR(light.sky_w_m2[AIR_NIR] / light.sky_w_m2[AIR_G], 4 * 1.79, 0.3);
    }
    const SolarAir air = {weather.visibility_m, solar_water_mm(weather_vapour_kg_m3(&weather)), 0};
    SunAir         level, solar;
    Air            there = air_of(&weather, 0, 2, 1 << AIR_PAN, NULL);
    atmosphere_solar(&solar, atmosphere, &air, 0.5 * pi_rad);
    atmosphere_sun(&level, there.light.atmosphere, weather.visibility_m, AIR_PAN, 0, 0.5 * pi_rad);
    static const double disc[][2] = {{0, 0.5}, {-0.13325, 0.25}, {-0.26649, 0.5 * (1 - 0.26649 / 0.2665)}, {-0.267, 0}};
    for (int i = 0; i < 4; i++) {
        const Daylight light = air_of(&weather, disc[i][0], 2, 1 << AIR_PAN, NULL).light;
        CHECK_NEAR(light.sun_w_m2[AIR_PAN], disc[i][1] * level.direct_normal_w_m2, 1e-6 * level.direct_normal_w_m2);
        CHECK_NEAR(light.solar_direct_w_m2, disc[i][1] * solar.direct_normal_w_m2, 1e-6 * solar.direct_normal_w_m2);
    }
    there = air_of(&weather, 0.27, 2, 1 << AIR_PAN, NULL);
    atmosphere_sun(&level, there.light.atmosphere, weather.visibility_m, AIR_PAN, 0, 89.73 * rad_per_deg);
    const double risen = air_of(&weather, 0.27, 2, 1 << AIR_PAN, NULL).light.sun_w_m2[AIR_PAN];
    CHECK_NEAR(risen / level.direct_normal_w_m2, 1, 1e-9);
}

/* Half and all of the sky in clouds, by the papers' formulas; measured radiation as it is; the thermal sky of an
 * overcast is as warm as the air. */
static void clouds_dim_the_sun_and_warm_the_sky(void **state)
{
    (void)state;
    Weather             weather = weather_default();
    const unsigned      bands = 1 << AIR_PAN | 1 << AIR_LWIR;
    const Air           clear_air = air_of(&weather, 45, 2, bands, NULL);
    const Daylight      clear = clear_air.light;
    const double        high = clear.sun_d_enu[2], global = clear.solar_direct_w_m2 * high + clear.solar_diffuse_w_m2;
    static const double cloud[] = {0.5, 1};
    for (int k = 0; k < 2; k++) {
        weather.cloud = cloud[k];
        const Air       air = air_of(&weather, 45, 2, bands, NULL);
        const Daylight *l = &air.light;
        CHECK_NEAR(l->solar_direct_w_m2, clear.solar_direct_w_m2 * (1 - cloud[k]), 1e-9);
        CHECK_NEAR(l->solar_direct_w_m2 * high + l->solar_diffuse_w_m2, global * (1 - 0.75 * pow(cloud[k], 3.4)), 1e-6);
        CHECK_NEAR(l->longwave_loss_w_m2, clear.longwave_loss_w_m2 * (1 - 0.84 * cloud[k]), 1e-9);
        CHECK_NEAR(l->sun_w_m2[AIR_PAN], clear.sun_w_m2[AIR_PAN] * (1 - cloud[k]), 1e-9);
        CHECK_NEAR(daylight_on_plane(l, AIR_PAN, (const double[3]){0, 0, 1}) /
                       daylight_on_plane(&clear, AIR_PAN, (const double[3]){0, 0, 1}),
                   l->solar_diffuse_w_m2 / clear.solar_diffuse_w_m2, 1e-4);
        const double zenith[3] = {0, 0, 1}, black = planck_table_radiance(lwir, weather.air_temp_k);
        const double was = daylight_sky(&clear, AIR_LWIR, zenith), is_now = daylight_sky(l, AIR_LWIR, zenith);
        CHECK(was < 0.7 * black);
        CHECK_NEAR(is_now, was + cloud[k] * (black - was), 2e-3 * black);
    }
    weather = weather_default();
    weather.direct_w_m2 = 123, weather.diffuse_w_m2 = 234, weather.longwave_w_m2 = 345;
    const Air measured = air_of(&weather, 45, 2, bands, NULL);
    CHECK(measured.light.solar_direct_w_m2 == 123 && measured.light.solar_diffuse_w_m2 == 234);
    CHECK_NEAR(measured.light.longwave_loss_w_m2, 5.670374419184429e-8 * pow(weather.air_temp_k, 4) - 345, 1e-9);
    CHECK_NEAR(measured.light.sun_w_m2[AIR_PAN] / clear.sun_w_m2[AIR_PAN], 123 / clear.solar_direct_w_m2, 1e-9);
}

/* Sunlight goes by the inverse square of the distance: at 0.98329 au (perihelion, 3 January 2026) 1.0342767 and at
 * 1.01671 au (aphelion, 6 July) 0.9673994 of that at 1 au; pvlib's get_extra_radiation(method='nrel') has 1.03425 and
 * 0.96752 on these days. So do the sun, the sky's scattered light, the air's on a path, and the heat of both; what is
 * thermal does not. */
static void sunlight_goes_by_the_square_of_the_distance(void **state)
{
    (void)state;
    static const double at_au[2] = {0.98329, 1.01671}, factor[2] = {1.0342767, 0.9673994};
    const AirSource     source = {atmosphere, mwir, lwir, 0, 0};
    const AirEye        eye = {300, all_bands, NULL};
    const Weather       weather = weather_default();
    const double        away[3] = {0.8, 0, 0.6}, slope[3] = {0.6, 0, 0.8};
    static Air          unit, air;
    static AirPaths     near;
    Sun                 sun = sun_at_elevation(35);
    arena_reset(arena);
    CHECK(air_at(&unit, &source, &weather, &sun, &eye, NULL, arena) == STATUS_OK);
    clear();
    add(1, -0.05, 4000);
    for (int k = 0; k < 2; k++) {
        sun.distance_au = at_au[k];
        CHECK(air_at(&air, &source, &weather, &sun, &eye, NULL, arena) == STATUS_OK);
        CHECK_NEAR(air.light.solar_direct_w_m2 / unit.light.solar_direct_w_m2, factor[k], 1e-6);
        CHECK_NEAR(air.light.solar_diffuse_w_m2 / unit.light.solar_diffuse_w_m2, factor[k], 1e-6);
        CHECK(air.light.longwave_loss_w_m2 == unit.light.longwave_loss_w_m2);
        for (int b = 0; b < AIR_LWIR; b++) {
            CHECK_NEAR(air.light.sun_w_m2[b] / unit.light.sun_w_m2[b], factor[k], 1e-6);
            if (b == AIR_MWIR) continue; /* whose sky is thermal for the most part */
            CHECK_NEAR(air.light.sky_w_m2[b] / unit.light.sky_w_m2[b], factor[k], 1e-5); /* sums of floats */
            CHECK_NEAR(daylight_sky(&air.light, (AirBand)b, away) / daylight_sky(&unit.light, (AirBand)b, away),
                       factor[k], 1e-5);
            CHECK_NEAR(daylight_on_plane(&air.light, (AirBand)b, slope) /
                           daylight_on_plane(&unit.light, (AirBand)b, slope),
                       factor[k], 1e-5);
            air_path(&veils, &air, (AirBand)b, &hits, &rays, NULL);
            air_path(&near, &unit, (AirBand)b, &hits, &rays, NULL);
            CHECK_NEAR(veils.added_w_m2_sr[0] / near.added_w_m2_sr[0], factor[k], 1e-4);
            CHECK(veils.transmittance[0] == near.transmittance[0]);
        }
        CHECK(daylight_sky(&air.light, AIR_LWIR, away) == daylight_sky(&unit.light, AIR_LWIR, away));
    }
}

/* LOWTRAN's tropical air sends down 384.70 W/m2 at 299.7 K and 23 km (shared/data/atmosphere). As much vapour in warmer
 * air sends down as the fourth power: 440.39 at 310 K, where a black plane sends up 523.67. */
static void heat_of_a_clear_sky_is_as_on_paper(void **state)
{
    (void)state;
    Weather weather = us1976_weather();
    Air     air = air_of(&weather, 50, 2, 1 << AIR_PAN, NULL);
    /* 391.2 W/m2 up at 288.2 K, 283.3 down (tests/render/test_atmosphere.c) */
    CHECK_NEAR(air.light.longwave_loss_w_m2, 391.2 - 283.3, 0.2);
    /* the air cools with height as the model's, -6.5 K/km: what it is warmer by at each node of height */
    for (int i = 0; i < air_warmer_nodes && i * air_warmer_step_m < 10000; i++)
        CHECK_NEAR((double)air.light.warmer_k[i], -6.5e-3 * i * air_warmer_step_m, 0.25);
    weather.air_temp_k = 310;
    weather.humidity = 25930e-6 * 101300 / 299.7 * 310 / weather_saturation_pa(310);
    air = air_of(&weather, 50, 2, 1 << AIR_PAN, NULL);
    CHECK_NEAR(air.light.longwave_loss_w_m2, 523.67 - 440.39, 0.2);
}

/* LOWTRAN7's own direct light, US standard 1976 (14.2 mm of water, which are 6.3 g/m3 at the ground), 23 km: 824.9 W/m2
 * with the sun overhead, 0.3953 of it visible, and 149.1 W/m2, 0.1109 of it visible, 7 degrees up; the visible bands
 * beside are tables of 5 1/cm. Of what falls on level ground 0.43 to 0.46 is visible (McCree 1972). On ground 3 km up,
 * 1 g/m3 of water (2.25 mm) and 50 km, its rows between 1 and 5 mm: 1101.6 and 1058.4 W/m2. */
static void sunlight_of_all_wavelengths(void **state)
{
    (void)state;
    static const double zenith_deg[] = {0, 83}, direct[] = {824.9, 149.1}, visible[] = {0.3953, 0.1109};
    Weather             weather = weather_default();
    AirSource           source = {atmosphere, mwir, lwir, 0, 0};
    Daylight            light;
    weather.humidity = 0.014158 / 2.25 / weather_vapour_kg_m3(&(Weather){.air_temp_k = 288.15, .humidity = 1});
    for (int i = 0; i < 2; i++) {
        const Sun sun = sun_at_elevation(90 - zenith_deg[i]);
        daylight_at(&light, &source, &weather, &sun);
        CHECK_NEAR(light.solar_direct_w_m2 / direct[i], 1, 0.004);
        CHECK_NEAR(light.sun_w_m2[AIR_PAN] / light.solar_direct_w_m2, visible[i], 0.01 * visible[i]);
        const double high = sun.d_enu[2], global = light.solar_direct_w_m2 * high + light.solar_diffuse_w_m2;
        if (i == 0) CHECK_NEAR((light.sun_w_m2[AIR_PAN] * high + light.sky_w_m2[AIR_PAN]) / global, 0.445, 0.016);
    }
    const Sun sun = sun_at_elevation(90);
    source.ground_m = 3000, weather.visibility_m = 50000, weather.humidity *= 1 / 6.2924;
    daylight_at(&light, &source, &weather, &sun);
    CHECK(light.solar_direct_w_m2 > 1058.4 && light.solar_direct_w_m2 < 1101.6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sun_disc_adds_up),
        cmocka_unit_test(light_fades_smoothly),
        cmocka_unit_test(light_fades_as_measured),
        cmocka_unit_test(heat_of_a_clear_sky_is_as_on_paper),
        cmocka_unit_test(sunlight_of_all_wavelengths),
        cmocka_unit_test(clouds_dim_the_sun_and_warm_the_sky),
        cmocka_unit_test(sunlight_goes_by_the_square_of_the_distance),
    };
    return cmocka_run_group_tests(tests, open_tables, close_tables);
}
