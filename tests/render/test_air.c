/* The air of a frame against the tables it was made of, and against what must hold anywhere. labels: physics */
#include "tests/render/air_stage.h"

#include <stdlib.h>

static AirPaths veils;

static float temp_k[hits_capacity];

static int open_all(void **state)
{
    for (int i = 0; i < hits_capacity; i++) temp_k[i] = 300;
    return open_tables(state);
}

static const PlanckTable *planck_of(AirBand band) { return band == AIR_MWIR ? mwir : lwir; }

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A camera that looks 10 degrees down, 40 degrees from the sun, 20 degrees wide. */
static View view_from(double eye_m, double down_rad, double from_sun_rad)
{
    const double a = sun_azimuth + from_sun_rad, c = cos(down_rad), s = sin(down_rad);
    View view = {.p_enu = {0, 0, eye_m}, .width = 720, .height = 486, .focal_px = view_focal_px(720, 20 * rad_per_deg)};
    const double ahead[3] = {sin(a) * c, cos(a) * c, -s}, right[3] = {cos(a), -sin(a), 0};
    double       down[3];
    v3_cross(down, ahead, right);
    for (int k = 0; k < 3; k++) {
        view.r_enu_from_cam[3 * k] = right[k];
        view.r_enu_from_cam[3 * k + 1] = down[k];
        view.r_enu_from_cam[3 * k + 2] = ahead[k];
    }
    return view;
}

/* Every path of a picture, ground and things above it, against the tables asked one by one. */
static void frames_follow_the_tables(void **state)
{
    (void)state;
    static const double eyes_m[] = {2, 300, 800, 3000};
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        enum { most = 4 * 400 };
        double tau_error[most], seen_error[most];
        int    n = 0;
        for (int e = 0; e < 4; e++) {
            const double  eye_m = eyes_m[e];
            const Weather weather = weather_default();
            const View    view = view_from(eye_m, eye_m < 10 ? 0 : 10 * rad_per_deg, 40 * rad_per_deg);
            const Air     air = air_of(&weather, 45, eye_m, 1u << b, &view);
            const bool    thermal = b >= AIR_MWIR;
            clear();
            for (int k = 0; k < 400; k++) {
                double d[3];
                view_ray(d, &view, (k * 37 % 720) + 0.5, (k * 211 % 486) + 0.5);
                /* to the ground, or some of the way; level and rising rays: 100 m to 20 km */
                const double to_ground_m = d[2] < -1e-4 ? eye_m / -d[2] : 2e4;
                const double range_m = fmin(to_ground_m, 2e4) * (k % 3 ? 0.9999 : 0.05 + 0.9 * (k % 17) / 17.0);
                const int    i = add(atan2(d[0], d[1]), asin(d[2]), range_m);
                rays.d_enu[0][i] = d[0], rays.d_enu[1][i] = d[1], rays.d_enu[2][i] = d[2];
            }
            air_path(&veils, &air, (AirBand)b, &hits, &rays, thermal ? temp_k : NULL);
            for (int i = 0; i < hits.count; i++) {
                const double  r = hits.range_m[i], up = rays.d_enu[2][i], level = sqrt(1 - up * up);
                AirPath       path = {.observer_m = eye_m,
                                      .range_m = r,
                                      .sun_zenith_rad = 45 * rad_per_deg,
                                      .target_m = fmax(eye_m + r * up + r * r * level * level / (2 * 6371e3), 0)};
                const double *s = air.light.sun_d_enu;
                path.rel_azimuth_rad = acos(
                    clamp((rays.d_enu[0][i] * s[0] + rays.d_enu[1][i] * s[1]) / (level * hypot(s[0], s[1])), -1, 1));
                PathAir want;
                atmosphere_path(&want, air.light.atmosphere, weather.visibility_m, (AirBand)b, &path, 300);
                const double tau = thermal ? want.transmittance : want.sun_transmittance;
                /* a target of 300 K, or of reflectance 0.1 in the open */
                const double bare = thermal ? planck_table_radiance(planck_of((AirBand)b), 300)
                                            : 0.1 / pi_rad * (air.light.sun_w_m2[b] * s[2] + air.light.sky_w_m2[b]);
                /* a frame's scattered light adds up to the sky's exact irradiance */
                const double light = want.scattered_w_m2_sr * air.light.scattered_scale[b];
                const double added = want.thermal_w_m2_sr + (b == AIR_LWIR ? 0 : light);
                tau_error[n] = fabs(veils.transmittance[i] / tau - 1);
                seen_error[n++] =
                    fabs((bare * veils.transmittance[i] + veils.added_w_m2_sr[i]) / (bare * tau + added) - 1);
            }
        }
        qsort(tau_error, (size_t)n, sizeof *tau_error, compare_doubles);
        qsort(seen_error, (size_t)n, sizeof *seen_error, compare_doubles);
        print_message("%-4s error of transmittance p50 %.5f p99 %.5f max %.5f, of radiance seen %.5f %.5f %.5f\n",
                      air_band_name((AirBand)b), tau_error[n / 2], tau_error[n * 99 / 100], tau_error[n - 1],
                      seen_error[n / 2], seen_error[n * 99 / 100], seen_error[n - 1]);
        /* the tables themselves are good to 1 %; a third of that may be lost on the way. Near infrared from the ground:
         * its scattered light turns sharply with range below a kilometre in the tables, which cubics round off */
        CHECK(tau_error[n * 99 / 100] < 0.003 && seen_error[n * 99 / 100] < (b == AIR_NIR ? 0.006 : 0.003));
        CHECK(tau_error[n - 1] < 0.03 && seen_error[n - 1] < 0.03);
    }
}

static void pins(void **state)
{
    (void)state;
    /* LOWTRAN 7, US standard, 23 km, sun at zenith 40 degrees, PAN; 5 km along the ground, target at 300 K */
    const Weather weather = us1976_weather();
    const Air     air = air_of(&weather, 50, 0, all_bands, NULL);
    const double  total = air.light.sun_w_m2[AIR_PAN] * sin(50 * rad_per_deg) + air.light.sky_w_m2[AIR_PAN];
    CHECK_NEAR(air.light.sun_w_m2[AIR_PAN] / 282.10, 1, 0.01);
    CHECK_NEAR(total / 344.865, 1, 0.01);
    clear();
    add(0, -0.0001, 5000);
    air_path(&veils, &air, AIR_PAN, &hits, &rays, NULL);
    CHECK_NEAR(veils.transmittance[0] / 0.406126, 1, 0.01);
    air_path(&veils, &air, AIR_LWIR, &hits, &rays, temp_k);
    CHECK_NEAR(veils.transmittance[0] / 0.625655, 1, 0.01);
    CHECK_NEAR(veils.added_w_m2_sr[0] / 11.7559, 1, 0.01);
    /* an engine shows further than the ground it stands on (the tables: 0.3469 at 300 K, 0.4586 at 1000 K) */
    temp_k[0] = 1000;
    air_path(&veils, &air, AIR_MWIR, &hits, &rays, temp_k);
    CHECK_NEAR(veils.transmittance[0], 0.4586, 0.01);
    temp_k[0] = 300;
    air_path(&veils, &air, AIR_MWIR, &hits, &rays, temp_k);
    CHECK_NEAR(veils.transmittance[0], 0.3469, 0.01);
    CHECK_NEAR(veils.sun_transmittance[0], 0.4969, 0.01);
}

/* What lights a plane is the integral of the sky's radiance over the half of space before it: midpoints, 0.7 degrees
 * apart, against the lamps. The level plane has what the tables give. */
static void sky_adds_up(void **state)
{
    (void)state;
    static const double elevations_deg[] = {4, 25, 50, 88};
    static const double normals[][3] = {{0, 0, 1},
                                        {0.8, 0, 0.6},
                                        {0, 1, 0},
                                        {-0.6, -0.6, 0.52915},
                                        {0.6, 0, -0.8},
                                        /* slopes of ground: 6, 14, 20 degrees */
                                        {0.1, 0, 0.99499},
                                        {0.2, 0.14, 0.96974},
                                        {-0.34, 0, 0.94043}};
    enum { planes = sizeof normals / sizeof *normals };
    for (int e = 0; e < 4; e++) {
        const Weather        weather = weather_default();
        const Air            air = air_of(&weather, elevations_deg[e], 2, all_bands, NULL);
        static const AirBand bands[] = {AIR_G, AIR_NIR, AIR_MWIR, AIR_LWIR};
        for (int b = 0; b < 4; b++) {
            double    sum[planes] = {0};
            const int heights = 128, azimuths = 512;
            for (int h = 0; h < heights; h++)
                for (int a = 0; a < azimuths; a++) {
                    const double rise = (h + 0.5) / heights * 0.5 * pi_rad, turn = (a + 0.5) * 2 * pi_rad / azimuths;
                    const double d[3] = {cos(rise) * sin(turn), cos(rise) * cos(turn), sin(rise)};
                    const double part =
                        daylight_sky(&air.light, bands[b], d) * cos(rise) * pi_rad * pi_rad / heights / azimuths;
                    for (int n = 0; n < planes; n++) sum[n] += part * fmax(v3_dot(d, normals[n]), 0);
                }
            SunAir sun;
            atmosphere_sun(&sun, air.light.atmosphere, weather.visibility_m, bands[b], 0,
                           (90 - fmax(elevations_deg[e], 5)) * rad_per_deg);
            print_message(
                "sun %2.0f deg, %s: level %.4g (tables' diffuse %.4g, scale %.3f); over the integral, planes:",
                elevations_deg[e], air_band_name(bands[b]), air.light.sky_w_m2[bands[b]], sun.diffuse_horizontal_w_m2,
                air.light.sky_scale[bands[b]]);
            for (int n = 0; n < planes; n++)
                print_message(" %.4f%s", daylight_on_plane(&air.light, bands[b], normals[n]) / sum[n],
                              n < planes - 1 ? "" : "\n");
            /* 1 %: the grid cuts the ring about a low sun at the horizon */
            for (int n = 0; n < planes; n++)
                CHECK_NEAR(daylight_on_plane(&air.light, bands[b], normals[n]), sum[n],
                           0.01 * air.light.sky_w_m2[bands[b]]);
            if (bands[b] < AIR_MWIR && elevations_deg[e] > 5)
                CHECK_NEAR(air.light.sky_w_m2[bands[b]] / sun.diffuse_horizontal_w_m2, 1, 1e-4);
        }
    }
}

/* What one band is does not depend on which others are asked for. */
static void a_band_does_not_see_its_company(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const Air     alone = air_of(&weather, 35, 100, 1 << AIR_LWIR, NULL);
    const Air     company = air_of(&weather, 35, 100, 1 << AIR_LWIR | 1 << AIR_PAN | 1 << AIR_G | 1 << AIR_MWIR, NULL);
    CHECK(alone.light.solar_direct_w_m2 == company.light.solar_direct_w_m2 &&
          alone.light.solar_diffuse_w_m2 == company.light.solar_diffuse_w_m2);
    CHECK(alone.light.longwave_loss_w_m2 == company.light.longwave_loss_w_m2);
    CHECK(alone.light.ground_w_m2_sr[AIR_LWIR] == company.light.ground_w_m2_sr[AIR_LWIR]);
    CHECK(alone.light.sky_w_m2[AIR_LWIR] == company.light.sky_w_m2[AIR_LWIR]);
}

/* What an eye sees by and what falls where nothing looks are one: the sums, and the sky by direction. */
static void daylight_needs_no_eye(void **state)
{
    (void)state;
    static Daylight sums, light;
    const Weather   weather = weather_default();
    const AirSource source = {atmosphere, mwir, lwir, 0, 0};
    const unsigned  bands = 1 << AIR_PAN | 1 << AIR_MWIR | 1 << AIR_LWIR;
    for (double elevation_deg = -20; elevation_deg <= 80; elevation_deg += 25) {
        const Sun sun = sun_at_elevation(elevation_deg);
        const Air air = air_of(&weather, elevation_deg, 900, bands, NULL);
        daylight_at(&sums, &source, &weather, &sun);
        CHECK(daylight_by_direction(&light, &source, &weather, &sun, bands, NULL, arena) == STATUS_OK);
        CHECK(sums.weather.air_temp_k == air.light.weather.air_temp_k &&
              sums.sun_w_m2[AIR_PAN] == air.light.sun_w_m2[AIR_PAN]);
        CHECK(sums.solar_direct_w_m2 == air.light.solar_direct_w_m2 &&
              sums.solar_diffuse_w_m2 == air.light.solar_diffuse_w_m2);
        CHECK(sums.longwave_loss_w_m2 == air.light.longwave_loss_w_m2 &&
              memcmp(sums.warmer_k, air.light.warmer_k, sizeof sums.warmer_k) == 0);
        CHECK(memcmp(sums.ground_w_m2_sr, air.light.ground_w_m2_sr, sizeof sums.ground_w_m2_sr) == 0);
        CHECK(memcmp(light.sky, air.light.sky, sizeof light.sky) == 0);
        CHECK(memcmp(light.plane_w_m2, air.light.plane_w_m2, sizeof light.plane_w_m2) == 0);
        CHECK(memcmp(light.sky_w_m2, air.light.sky_w_m2, sizeof light.sky_w_m2) == 0);
    }
}

/* Further is dimmer, nothing is between at no distance, and no number is not one: from the ground, the air and space,
 * by day, dusk and night, in haze and out of it, up, level and down. */
static void veils_are_sound_everywhere(void **state)
{
    (void)state;
    static const double visibility[] = {100, 5000, 3e5}, temp[] = {220, NAN, 330}, eyes_m[] = {-50, 0, 1500, 60000};
    for (int v = 0; v < 3; v++)
        for (int e = 0; e < 4; e++) {
            const double sun_deg[] = {-50, -2, 0, 60};
            Weather      weather = weather_default();
            weather.visibility_m = visibility[v];
            weather.air_temp_k = temp[v];
            const Air air =
                air_of(&weather, sun_deg[(v + e) % 4], eyes_m[e], 1 << AIR_G | 1 << AIR_MWIR | 1 << AIR_LWIR, NULL);
            clear();
            static const double rise[] = {-1.5, -0.3, -0.01, 0, 0.02, 0.8};
            for (int d = 0; d < 6; d++) {
                for (int k = 0; k < 12; k++) add(0.4 * d, rise[d], pow(3.4, k));
                add(0.4 * d, rise[d], INFINITY);
            }
            hits.range_m[0] = 0;
            static const AirBand bands[] = {AIR_G, AIR_MWIR, AIR_LWIR};
            for (int b = 0; b < 3; b++) {
                air_path(&veils, &air, bands[b], &hits, &rays, b ? temp_k : NULL);
                CHECK(veils.transmittance[0] == 1 && veils.added_w_m2_sr[0] == 0);
                for (int i = 0; i < hits.count; i++) {
                    const float tau[3] = {veils.transmittance[i], veils.sun_transmittance[i],
                                          veils.air_transmittance[i]};
                    for (int t = 0; t < 3; t++) CHECK(tau[t] >= 0 && tau[t] <= 1);
                    CHECK(veils.added_w_m2_sr[i] >= 0 && veils.added_w_m2_sr[i] < 2000);
                    /* from one range to the next, along the ground and down to it, to 60 km; a rising path leaves the
                     * dense air, where the tables' own mean over a band may turn by a few percent */
                    if (i / 13 < 3 && i % 13 > 0 && i % 13 < 10 && eyes_m[e] < 2000)
                        CHECK(tau[0] <= fmaxf(veils.transmittance[i - 1] * 1.0001f, 2e-30f)); /* where depths end */
                }
            }
            CHECK(air.light.longwave_loss_w_m2 >= 0 && air.light.longwave_loss_w_m2 < 400);
        }
}

static void sky_is_cold_above_and_warm_at_the_horizon(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const Air     air = air_of(&weather, 40, 2, 1 << AIR_LWIR, NULL),
              high = air_of(&weather, 40, 3000, 1 << AIR_LWIR, NULL);
    double last = INFINITY;
    for (double up = 0; up <= 1; up += 0.001) {
        const double sky = daylight_sky(&air.light, AIR_LWIR, (double[3]){sqrt(1 - up * up), 0, up});
        CHECK(sky < last * 1.003); /* cubics between the tables' zenith angles */
        last = sky;
    }
    const double zenith_k = planck_table_temp(lwir, daylight_sky(&air.light, AIR_LWIR, (double[3]){0, 0, 1}));
    const double horizon_k = planck_table_temp(lwir, daylight_sky(&air.light, AIR_LWIR, (double[3]){1, 0, 0}));
    print_message("LWIR sky: zenith %.1f K, horizon %.1f K\n", zenith_k, horizon_k);
    CHECK(zenith_k > 205 && zenith_k < 240);
    CHECK(horizon_k > 280 && horizon_k < 288.15);
    CHECK(daylight_sky(&air.light, AIR_LWIR, (double[3]){0.6, 0, -0.8}) ==
          daylight_sky(&air.light, AIR_LWIR, (double[3]){0.6, 0.8, 0}));
    /* an eye above half of the water sees less of it over itself */
    clear();
    add(0, 0.5 * pi_rad, INFINITY);
    air_path(&veils, &high, AIR_LWIR, &hits, &rays, NULL);
    CHECK(veils.added_w_m2_sr[0] < 0.7 * daylight_sky(&air.light, AIR_LWIR, (double[3]){0, 0, 1}));
}

/* Air warmer than that of all profiles, with the same water vapour (none): its light by Planck, its transmittance as
 * before. */
static void warm_air_glows_by_planck(void **state)
{
    (void)state;
    Weather weather = weather_default();
    weather.air_temp_k = NAN;
    clear();
    add(1, -0.01, 2000);
    CHECK_NEAR(air_of(&weather, -20, 20, 1 << AIR_LWIR, NULL).light.weather.air_temp_k, 288.15, 0.1); /* US standard */
    weather.air_temp_k = 303, weather.humidity = 0;
    const Air plain = air_of(&weather, -20, 20, 1 << AIR_LWIR, NULL);
    air_path(&veils, &plain, AIR_LWIR, &hits, &rays, temp_k);
    const double tau = veils.transmittance[0], added = veils.added_w_m2_sr[0];
    const double zenith = daylight_sky(&plain.light, AIR_LWIR, (double[3]){0, 0, 1}),
                 own_k = plain.light.weather.air_temp_k;
    weather.air_temp_k = own_k + 15;
    const Air warm = air_of(&weather, -20, 20, 1 << AIR_LWIR, NULL);
    air_path(&veils, &warm, AIR_LWIR, &hits, &rays, temp_k);
    const double ratio = planck_table_radiance(lwir, own_k + 15) / planck_table_radiance(lwir, own_k);
    CHECK_NEAR(veils.transmittance[0] / tau, 1, 1e-6);
    CHECK_NEAR(veils.added_w_m2_sr[0] / added, ratio, 0.01); /* the air's own weight of the spectrum shifts with it */
    CHECK_NEAR(daylight_sky(&warm.light, AIR_LWIR, (double[3]){0, 0, 1}) / zenith, ratio, 1e-5);
}

/* A view fills in less than all round, and what it fills in agrees. */
static void a_view_sees_what_all_round_sees(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const View    view = view_from(500, 0.2, -1.2);
    clear();
    for (int k = 0; k < 40; k++) {
        double d[3];
        view_ray(d, &view, k % 8 * 100, k / 8 * 120);
        add(atan2(d[0], d[1]), asin(d[2]), d[2] < -0.01 ? 500 / -d[2] : 3000);
    }
    const Air some = air_of(&weather, 40, 500, 1 << AIR_G, &view);
    air_path(&veils, &some, AIR_G, &hits, &rays, NULL);
    static AirPaths all;
    const Air       every = air_of(&weather, 40, 500, 1 << AIR_G, NULL);
    air_path(&all, &every, AIR_G, &hits, &rays, NULL);
    for (int i = 0; i < hits.count; i++) {
        /* heights in coarser steps, up to the tables' top: what a frame may lose against the tables, twice */
        CHECK_NEAR(all.transmittance[i] / veils.transmittance[i], 1, 0.006);
        /* steps of 15 degrees and of a sixth of all slopes: what all round loses */
        CHECK_NEAR(all.added_w_m2_sr[i] / veils.added_w_m2_sr[i], 1, 0.03);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_follow_the_tables),
        cmocka_unit_test(pins),
        cmocka_unit_test(sky_adds_up),
        cmocka_unit_test(a_band_does_not_see_its_company),
        cmocka_unit_test(daylight_needs_no_eye),
        cmocka_unit_test(veils_are_sound_everywhere),
        cmocka_unit_test(sky_is_cold_above_and_warm_at_the_horizon),
        cmocka_unit_test(warm_air_glows_by_planck),
        cmocka_unit_test(a_view_sees_what_all_round_sees),
    };
    return cmocka_run_group_tests(tests, open_all, close_tables);
}
