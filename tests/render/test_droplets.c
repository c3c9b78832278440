/* Rain, snow and fog: extinction by rate and visibility, two streams of closed form, thick fog as a black body, and a
 * frame's tables against paths one by one. */
#include "tests/render/air_stage.h"

#include "render/air/droplets_private.h"

static const double km_m = 1000;

static Weather weather_of(double rain_mm_h, double visibility_m, double temp_k, WeatherFog fog)
{
    Weather w = weather_default();
    w.rain_mm_h = rain_mm_h, w.visibility_m = visibility_m, w.air_temp_k = temp_k, w.fog = fog;
    return w;
}

/* Transmittance of a level path of an eye at 2 m. */
static void level_path(double tau[AIR_BAND_COUNT], const Weather *weather, double range_m)
{
    static AirPaths path[AIR_BAND_COUNT];
    const Air       air = air_of(weather, 40, 2, all_bands, NULL);
    clear();
    add(0.3, 0, range_m);
    air_paths_of(path, &air, all_bands, &hits, &rays, NULL);
    for (int b = 0; b < AIR_BAND_COUNT; b++) tau[b] = (double)path[b].transmittance[0];
}

/* dB that the drops of a weather add to a kilometre. */
static void added_db(double db[AIR_BAND_COUNT], const Weather *weather)
{
    double  with[AIR_BAND_COUNT], without[AIR_BAND_COUNT];
    Weather dry = *weather;
    dry.rain_mm_h = 0;
    level_path(with, weather, km_m);
    level_path(without, &dry, km_m);
    for (int b = 0; b < AIR_BAND_COUNT; b++) db[b] = -10 * log10(with[b] / without[b]);
}

/* P.1814: 1.076 x 20^0.67 = 1.076 x 7.4420 = 8.008 dB/km; at 2 mm/h 1.076 x 1.5911 = 1.712. */
static void rain_takes_eight_decibels(void **state)
{
    (void)state;
    const Weather heavy = weather_of(20, 23000, 288.15, WEATHER_FOG_AUTO),
                  light = weather_of(2, 23000, 288.15, WEATHER_FOG_AUTO);
    double db[2][AIR_BAND_COUNT];
    added_db(db[0], &heavy), added_db(db[1], &light);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        CHECK_NEAR(db[0][b], 8.008, 0.004);
        CHECK_NEAR(db[1][b], 1.712, 0.001);
    }
}

/* P.1814 at 2 mm/h: 2^1.38 = 2.60268, 2^0.72 = 1.64718. Dry at 10 um: (0.542 + 5.4958776) 2.60268 = 15.7147; at 0.55
 * um: (0.02981 + 5.4958776) 2.60268 = 14.3816. Wet at 10 um: (1.023 + 3.7855466) 1.64718 = 7.9205; at 0.55 um:
 * (0.056265 + 3.7855466) 1.64718 = 6.3282. */
static void snow_by_wavelength(void **state)
{
    (void)state;
    const Weather dry = weather_of(2, 23000, 263.15, WEATHER_FOG_AUTO),
                  wet = weather_of(2, 23000, 272.65, WEATHER_FOG_AUTO);
    double db[AIR_BAND_COUNT];
    added_db(db, &dry);
    CHECK_NEAR(db[AIR_LWIR], 15.7147, 0.004);
    CHECK_NEAR(db[AIR_G], 14.3816, 0.004);
    added_db(db, &wet);
    CHECK_NEAR(db[AIR_LWIR], 7.9205, 0.004);
    CHECK_NEAR(db[AIR_G], 6.3282, 0.004);
}

/* Mie's series at twenty wavelengths a band by miepython 3.3.0, index of Hale & Querry interpolated, size distributions
 * of droplets_table.c: extinction over that at 0.55 um, scattered share. A table of 38 wavelengths is within 5 % of it.
 */
static void fogs_by_miepython(void **state)
{
    (void)state;
    static const struct {
        DropletKind kind;
        AirBand     band;
        double      extinction, albedo;
    } row[] = {
        {droplet_radiation, AIR_B, 0.984, 1.0},        {droplet_radiation, AIR_G, 0.9968, 1.0},
        {droplet_radiation, AIR_R, 1.0085, 1.0},       {droplet_radiation, AIR_NIR, 1.036, 0.9999},
        {droplet_radiation, AIR_MWIR, 1.3238, 0.9463}, {droplet_radiation, AIR_LWIR, 0.3003, 0.4775},
        {droplet_advection, AIR_B, 0.9968, 1.0},       {droplet_advection, AIR_G, 1.0002, 1.0},
        {droplet_advection, AIR_R, 1.0037, 1.0},       {droplet_advection, AIR_NIR, 1.0113, 0.9996},
        {droplet_advection, AIR_MWIR, 1.0846, 0.7312}, {droplet_advection, AIR_LWIR, 1.1428, 0.5731},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        const DropletRow got = droplet_optics(row[i].kind, row[i].band);
        CHECK_NEAR(got.extinction, row[i].extinction, 0.05 * row[i].extinction);
        CHECK_NEAR(got.albedo, row[i].albedo, 0.05 * row[i].albedo);
    }
    /* of rain some half of what is lost is absorbed where water is opaque; nothing is in the visible */
    CHECK_NEAR(droplet_optics(droplet_rain, AIR_LWIR).albedo, 0.53, 0.02);
    CHECK_NEAR(droplet_optics(droplet_rain, AIR_G).albedo, 1, 1e-3);
}

/* 0.2 km of visibility: 3.912 / 200 m at 0.55 um, of which haze of 5 km keeps 1 / 25. In LWIR a radiation fog has some
 * 0.28 of that: exp(-0.28 x 18.8) = 0.005 over a kilometre; where it is haze, a sixth is left. */
static void fog_takes_the_place_of_haze(void **state)
{
    (void)state;
    const Weather fog = weather_of(0, 200, 288.15, WEATHER_FOG_RADIATION),
                  haze = weather_of(0, 200, 288.15, WEATHER_FOG_NONE),
                  advection = weather_of(0, 200, 288.15, WEATHER_FOG_ADVECTION);
    double tau[AIR_BAND_COUNT];
    level_path(tau, &fog, 100);
    CHECK_NEAR(-log(tau[AIR_G]), 1.956, 0.03);
    level_path(tau, &fog, km_m);
    CHECK(tau[AIR_LWIR] < 0.01 && tau[AIR_LWIR] > 1e-4);
    level_path(tau, &haze, km_m);
    CHECK_NEAR(tau[AIR_LWIR], 0.17, 0.01);
    level_path(tau, &advection, km_m);
    CHECK(tau[AIR_LWIR] < 1e-8);
    CHECK(droplets_haze_m(200, WEATHER_FOG_AUTO) == 5000 && droplets_haze_m(1000, WEATHER_FOG_AUTO) == 5000);
    CHECK(droplets_haze_m(200, WEATHER_FOG_NONE) == 200 && droplets_haze_m(2000, WEATHER_FOG_AUTO) == 2000);
    CHECK_NEAR(droplets_haze_m(1999.9, WEATHER_FOG_AUTO), 2000, 0.5);
    CHECK_NEAR(droplets_haze_m(1500, WEATHER_FOG_AUTO), 2 / (1 / 2000.0 + 1 / 5000.0), 1e-6);
    Weather  calm = fog; /* which fog it is by the wind */
    Droplets by_wind, by_name;
    calm.fog = WEATHER_FOG_AUTO;
    for (int k = 0; k < 2; k++) {
        calm.wind_mps = k ? 3 : 2.9;
        droplets_of(&by_wind, atmosphere, &calm, 1);
        droplets_of(&by_name, atmosphere, k ? &advection : &fog, 1);
        CHECK(memcmp(&by_wind, &by_name, sizeof by_wind) == 0);
    }
}

static void more_drops_see_less_far(void **state)
{
    (void)state;
    static const double rate[] = {0, 0.1, 1, 5, 20, 100, 300};
    for (int cold = 0; cold < 2; cold++) {
        double last[AIR_BAND_COUNT], tau[AIR_BAND_COUNT];
        for (int i = 0; i < 7; i++) {
            const Weather w = weather_of(rate[i], 23000, cold ? 268 : 288.15, WEATHER_FOG_AUTO);
            level_path(tau, &w, 100);
            for (int b = 0; b < AIR_BAND_COUNT && i > 0; b++) CHECK(tau[b] < last[b]);
            memcpy(last, tau, sizeof last);
        }
    }
}

/* From 2 km of visibility up, without rain, the fog's kind is in no bit. */
static void without_drops_nothing_changes(void **state)
{
    (void)state;
    static AirPaths path[2][AIR_BAND_COUNT];
    Air             air[2];
    for (int k = 0; k < 2; k++) {
        const Weather w = weather_of(0, 2000, 288.15, k ? WEATHER_FOG_ADVECTION : WEATHER_FOG_NONE);
        air[k] = air_of(&w, 30, 50, all_bands, NULL);
        clear();
        for (int i = 0; i < 12; i++) add(i, 0.1 * (i - 6), i % 2 ? (double)INFINITY : 300.0 * (i + 1));
        air_paths_of(path[k], &air[k], all_bands, &hits, &rays, NULL);
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        CHECK(memcmp(path[0][b].added_w_m2_sr, path[1][b].added_w_m2_sr, 12 * sizeof(float)) == 0);
        CHECK(memcmp(path[0][b].transmittance, path[1][b].transmittance, 12 * sizeof(float)) == 0);
    }
    CHECK(memcmp(air[0].light.sky, air[1].light.sky, sizeof air[0].light.sky) == 0);
    CHECK(memcmp(air[0].light.plane_w_m2, air[1].light.plane_w_m2, sizeof air[0].light.plane_w_m2) == 0);
}

static const struct {
    double     rain_mm_h, visibility_m, eye_m;
    WeatherFog fog;
} stage[] = {{20, 23000, 2, WEATHER_FOG_AUTO},      {5, 10000, 1500, WEATHER_FOG_AUTO},
             {0, 200, 2, WEATHER_FOG_RADIATION},    {0, 600, 120, WEATHER_FOG_RADIATION},
             {0, 400, 1000, WEATHER_FOG_ADVECTION}, {10, 800, 600, WEATHER_FOG_ADVECTION},
             {2, 5000, 30000, WEATHER_FOG_AUTO},    {50, 1500, 290, WEATHER_FOG_RADIATION}};

/* Depths by tables within 1 % of those one by one; radiance too, beyond the error that the tables have without drops.
 */
static void tables_against_single_paths(void **state)
{
    (void)state;
    static AirPaths table[2][AIR_BAND_COUNT], direct[2][AIR_BAND_COUNT];
    float           temp_k[hits_capacity];
    for (size_t s = 0; s < sizeof stage / sizeof *stage; s++) {
        const Weather w = weather_of(stage[s].rain_mm_h, stage[s].visibility_m, 288.15, stage[s].fog);
        Air           air = air_of(&w, 35, stage[s].eye_m, all_bands, NULL);
        clear();
        for (int i = 0; i < 48; i++) {
            const double down = (i % 12 - 6) * 0.05, to_ground = air.eye_height_m / fmax(-sin(down), 1e-3);
            add(0.5 * i, down,
                i % 5 == 0 ? (double)INFINITY : fmin(30 * pow(1.2, i), 0.98 * to_ground + (down >= 0) * 1e5));
        }
        for (int i = 0; i < hits_capacity; i++) temp_k[i] = 300;
        for (int dry = 0; dry < 2; dry++) {
            if (dry) air.light.droplets.layers = 0;
            air_paths_of(table[dry], &air, all_bands, &hits, &rays, temp_k);
            air_paths_directly(direct[dry], &air, all_bands, &hits, &rays, temp_k, table[dry]);
        }
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            for (int i = 0; i < hits.count; i++) {
                const double want = (double)direct[0][b].added_w_m2_sr[i], got = (double)table[0][b].added_w_m2_sr[i];
                const double already = (double)(table[1][b].added_w_m2_sr[i] - direct[1][b].added_w_m2_sr[i]);
                CHECK_NEAR(table[0][b].transmittance[i], direct[0][b].transmittance[i],
                           1e-4 + fabs((double)(table[1][b].transmittance[i] - direct[1][b].transmittance[i])));
                CHECK_NEAR(got, want, 1e-4 * want + fabs(already));
            }
    }
}

/* Thick fog is as bright in LWIR as a black body of its own temperature, whatever the sky is. */
static void thick_fog_is_black(void **state)
{
    (void)state;
    static AirPaths path[AIR_BAND_COUNT];
    const Weather   w = weather_of(0, 100, 280, WEATHER_FOG_ADVECTION);
    const Air       air = air_of(&w, 35, 2, all_bands, NULL);
    const double    black = planck_table_radiance(lwir, 280);
    clear();
    add(1, 0, 1500), add(1, 0, INFINITY), add(2, 0.3, INFINITY), add(3, 1.5, INFINITY), add(3, 0.01, 4000);
    air_paths_of(path, &air, all_bands, &hits, &rays, NULL);
    for (int i = 0; i < hits.count; i++) CHECK_NEAR(path[AIR_LWIR].added_w_m2_sr[i], black, 0.01 * black);
    for (int i = 0; i <= air_sky_ups; i++) CHECK_NEAR(air.light.sky[AIR_LWIR].thermal_w_m2_sr[i], black, 0.015 * black);
    CHECK(air.light.longwave_loss_w_m2 < 0.02 * 5.67e-8 * pow(280, 4));
    CHECK(air.light.sun_w_m2[AIR_G] < 1e-3 && air.light.sky_w_m2[AIR_G] > 20); /* no sun, but a bright sky */
    /* from above, the upper side is as cold as the sky makes it: colder than the fog, warmer than what it mirrors */
    const Air high = air_of(&w, 35, 2000, all_bands, NULL);
    clear();
    add(1, -1.2, 2100);
    air_paths_of(path, &high, all_bands, &hits, &rays, NULL);
    CHECK(path[AIR_LWIR].added_w_m2_sr[0] < black && path[AIR_LWIR].added_w_m2_sr[0] > 0.75 * black);
    CHECK(path[AIR_LWIR].transmittance[0] < 1e-4F);
}

/* Small drops scatter some of what a fog sends: half of the extinction forwards by 0.68 is, by similarity, 0.48 (1 -
 * 0.68) / (1 - 0.48 x 0.68) = 0.23 alike to all sides, and a deep layer of that emits H(1) sqrt(1 - 0.23) = 0.94
 * upwards (Chandrasekhar: H(1) = 1.07). So the sky's cold shows in its upper side by 0.06, of two streams 0.03 more or
 * less. */
static void the_sky_shows_in_fog_from_above(void **state)
{
    (void)state;
    static AirPaths path[AIR_BAND_COUNT];
    const Weather   w = weather_of(0, 100, 288.15, WEATHER_FOG_RADIATION);
    const Air       air = air_of(&w, 35, 310, all_bands, NULL);
    const double    black = planck_table_radiance(lwir, 288.15 - 6.5e-3 * 210); /* one depth below its top, 90 m */
    SkyAir          sky;
    clear();
    add(1, -1.5, 309);
    air_paths_of(path, &air, all_bands, &hits, &rays, NULL);
    atmosphere_sky(&sky, atmosphere, 5000, AIR_LWIR, 0, 53 * rad_per_deg, pi_rad, 0);
    CHECK_NEAR((black - (double)path[AIR_LWIR].added_w_m2_sr[0]) / (black - sky.thermal_w_m2_sr), 0.06, 0.03);
    /* level, a metre below its top, half of what is scattered comes from a sky and half from a fog that mirrors 0.06 of
     * it: 0.48 x (1 + 0.06) / 2 = 0.25 */
    const Air    top = air_of(&w, 35, 299, all_bands, NULL);
    const double here = planck_table_radiance(lwir, 288.15 - 6.5e-3 * 299);
    clear();
    add(1, 0, INFINITY);
    air_paths_of(path, &top, all_bands, &hits, &rays, NULL);
    CHECK_NEAR((here - (double)path[AIR_LWIR].added_w_m2_sr[0]) / (here - sky.thermal_w_m2_sr), 0.25, 0.03);
}

/* The sky that lights the ground, by its tables, and the same sky as an eye on the ground sees it, path by path. */
static void two_skies_are_one(void **state)
{
    (void)state;
    static AirPaths path[AIR_BAND_COUNT];
    for (int s = 0; s < 3; s++) {
        const Weather w = weather_of(s == 2 ? 10 : 0, s == 2 ? 23000 : s ? 800 : 150, 288.15, WEATHER_FOG_RADIATION);
        const Air     air = air_of(&w, 35, 2, all_bands, NULL);
        clear();
        for (int i = 0; i < 24; i++) add(0.5 * i, 0.02 + 0.06 * i, INFINITY);
        for (int i = 0; i < 3; i++) add(sun_azimuth, (35 + 8 * i) * rad_per_deg, INFINITY);
        air_paths_of(path, &air, all_bands, &hits, &rays, NULL);
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            for (int i = 0; i < hits.count; i++) {
                const double d_enu[3] = {rays.d_enu[0][i], rays.d_enu[1][i], rays.d_enu[2][i]};
                const double seen = (double)path[b].added_w_m2_sr[i];
                CHECK_NEAR(daylight_sky(&air.light, (AirBand)b, d_enu), seen, 0.03 * seen);
            }
    }
}

/* Drops that absorb nothing, of diffuse light (Eddington): T = 1 / (1 + 0.75 (1 - g) depth), R = 1 - T, and over a
 * ground of 0.2 T / (1 - 0.2 R) arrives. Of the sun alone: T = ((2/3 + u) + (2/3 - u) exp(-d / u)) / (4/3 + (1 - g')
 * d), where d = (1 - g^2) depth and g' = g / (1 + g). */
static void light_below_a_layer(void **state)
{
    (void)state;
    static const double g[] = {0.85, 0.85, 0.6}, depth[] = {0.5, 10, 3}, up[] = {0.8, 0.4, 0.3};
    for (int i = 0; i < 3; i++) {
        Droplets d = {.layers = 1, .sun_up = up[i], .layer = {{.top_m = 100}}};
        d.layer[0].per_m[AIR_G] = depth[i] / 100, d.layer[0].albedo[AIR_G] = 1, d.layer[0].asymmetry[AIR_G] = g[i];
        const double passed = 1 / (1 + 0.75 * (1 - g[i]) * depth[i]), again = 1 / (1 - 0.2 * (1 - passed));
        DropletSun   got = droplets_sun(&d, AIR_G, (DropletSun){0, 100});
        CHECK_NEAR(got.diffuse_w_m2, 100 * passed * again, 0.05);
        CHECK(got.direct_w_m2 == 0);
        const double thin = (1 - g[i] * g[i]) * depth[i], scaled = g[i] / (1 + g[i]);
        const double sun =
            ((2 / 3.0 + up[i]) + (2 / 3.0 - up[i]) * exp(-thin / up[i])) / (4 / 3.0 + (1 - scaled) * thin);
        got = droplets_sun(&d, AIR_G, (DropletSun){1000, 0});
        CHECK_NEAR(got.direct_w_m2, 1000 * exp(-depth[i] / up[i]), 1e-6);
        CHECK_NEAR(got.diffuse_w_m2 + got.direct_w_m2 * up[i], 1000 * up[i] * sun * again, 0.5);
        CHECK_NEAR(droplets_sun_passed(&d, AIR_G, 50), exp(-0.5 * depth[i] / up[i]), 1e-12);
    }
}

/* The sky just above the horizon, and the far ground just below it: no other step than without drops. */
static void no_step_at_the_horizon(void **state)
{
    (void)state;
    static AirPaths path[2][AIR_BAND_COUNT];
    for (int s = 0; s < 2; s++) {
        const Weather w = weather_of(s ? 2 : 0, s ? 23000 : 700, 288.15, WEATHER_FOG_RADIATION);
        const double  eye_m = 200, edge = -acos(6371e3 / (6371e3 + eye_m));
        Air           air = air_of(&w, 35, eye_m, all_bands, NULL);
        clear();
        add(1, edge + 2e-5, INFINITY), add(1, edge - 2e-5, INFINITY);
        for (int dry = 0; dry < 2; dry++) {
            if (dry) air.light.droplets.layers = 0;
            air_paths_of(path[dry], &air, all_bands, &hits, &rays, NULL);
        }
        CHECK(path[0][AIR_LWIR].range_m[0] == INFINITY && path[0][AIR_LWIR].range_m[1] < 1e5F);
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            const float *wet = path[0][b].added_w_m2_sr, *dry = path[1][b].added_w_m2_sr;
            CHECK_NEAR(wet[0], wet[1], 0.002 * (double)wet[0] + fabs((double)(dry[0] - dry[1])));
        }
    }
}

/* 360 m above 0 C: US 1976 falls by 6.5 K/km, so 15 C is at 0 C at 2308 m; snow has its own height. */
static void height_of_rain(void **state)
{
    (void)state;
    const Weather mild = weather_of(1, 23000, 288.15, WEATHER_FOG_AUTO),
                  cold = weather_of(1, 23000, 270, WEATHER_FOG_AUTO);
    CHECK_NEAR(droplets_fall_top_m(atmosphere, &mild), 2308 + 360, 30);
    CHECK(droplets_fall_top_m(atmosphere, &cold) == 2000);
}

/* For temperatures daylight's totals are computed without tables of paths: the same as those of a frame. */
static void totals_need_no_paths(void **state)
{
    (void)state;
    static Daylight sums;
    const Sun       sun = sun_at_elevation(40);
    const AirSource source = {atmosphere, mwir, lwir, 0, 0};
    Weather         weather[3] = {weather_default(), weather_default(), weather_default()};
    weather[0].rain_mm_h = 20, weather[1].visibility_m = 400, weather[2].rain_mm_h = 2, weather[2].air_temp_k = 268;
    for (int i = 0; i < 3; i++) {
        const Air air = air_of(&weather[i], 40, 900, 1 << AIR_PAN | 1 << AIR_LWIR, NULL);
        daylight_at(&sums, &source, &weather[i], &sun);
        CHECK(sums.solar_direct_w_m2 == air.light.solar_direct_w_m2 &&
              sums.solar_diffuse_w_m2 == air.light.solar_diffuse_w_m2);
        CHECK(sums.longwave_loss_w_m2 == air.light.longwave_loss_w_m2);
        CHECK(sums.solar_direct_w_m2 < 500); /* some 700 without drops */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(totals_need_no_paths),
        cmocka_unit_test(rain_takes_eight_decibels),
        cmocka_unit_test(snow_by_wavelength),
        cmocka_unit_test(fogs_by_miepython),
        cmocka_unit_test(fog_takes_the_place_of_haze),
        cmocka_unit_test(more_drops_see_less_far),
        cmocka_unit_test(without_drops_nothing_changes),
        cmocka_unit_test(tables_against_single_paths),
        cmocka_unit_test(thick_fog_is_black),
        cmocka_unit_test(light_below_a_layer),
        cmocka_unit_test(no_step_at_the_horizon),
        cmocka_unit_test(height_of_rain),
        cmocka_unit_test(the_sky_shows_in_fog_from_above),
        cmocka_unit_test(two_skies_are_one),
    };
    return cmocka_run_group_tests(tests, open_tables, close_tables);
}
