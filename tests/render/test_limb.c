/* Rays from any height: below the horizontal to space, along a path that passes its lowest point, from above the
 * tables' top; against LOWTRAN7's own rays, sums over shells, and each other at the seams. labels: physics */
#include "tests/render/air_stage.h"

#include "pitviper_table.h"
#include "render/air/atmosphere_private.h"

static const double earth_m = 6371e3;

static double to_tangent(double eye_m, double tangent_m) { return -acos((earth_m + tangent_m) / (earth_m + eye_m)); }

static double kelvin(AirBand band, double w_m2_sr)
{
    double low_k = 50, high_k = 400;
    for (int i = 0; i < 60; i++) {
        const double k = 0.5 * (low_k + high_k);
        if (planck_table_radiance(band == AIR_LWIR ? lwir : mwir, k) < w_m2_sr) low_k = k;
        else high_k = k;
    }
    return low_k;
}

/* ---- legs -------------------------------------------------------------------------------------------- */

static void lowest_points(void **state)
{
    (void)state;
    /* 100 km to either side of a point the line is 100^2 / (2 * 6381) km higher */
    CHECK_NEAR(air_tangent_m(10000, -100e3 / (earth_m + 10000)), 10000 - 783.6, 0.5);
    CHECK_NEAR(air_tangent_m(10000, 0.3), 10000, 0);
    CHECK_NEAR(air_tangent_m(10000, -0.3), 0, 0); /* it meets the ground */
    const AirPath chord = {10000, 10000, 400e3, 0, 0}, level = {10000, 10000, 100e3, 0, 0},
                  down = {10000, 9000, 20e3, 0, 0};
    AirLegs legs = air_legs(&chord, 20000);
    CHECK(legs.count == 2 && legs.cut == 1); /* 3.1 km below its ends */
    CHECK_NEAR(legs.leg[0].target_m, 10000 - 200e3 * 200e3 / (2 * (earth_m + 10000)), 1);
    CHECK_NEAR(legs.leg[0].range_m, 200e3, 1e-3);
    CHECK_NEAR(legs.leg[1].range_m, 200e3, 1e-3);
    CHECK(legs.leg[1].observer_m == legs.leg[0].target_m && legs.leg[1].target_m == 10000);
    CHECK(air_legs(&level, 20000).count == 1 && air_legs(&down, 20000).count == 1); /* 196 m below; none */
    legs = air_legs(&down, 20000);
    CHECK(memcmp(&legs.leg[0], &down, sizeof down) == 0);
}

static void cut_at_the_top(void **state)
{
    (void)state;
    /* straight down from 99 km: the last 20; up from 10 km: the first 10; between 30 and 25 km: none */
    const AirPath down = {99e3, 0, 99e3, 0, 0}, up = {10e3, 99e3, 89e3, 0, 0}, above = {30e3, 25e3, 100e3, 0, 0};
    AirLegs       legs = air_legs(&down, 20e3);
    CHECK(legs.count == 1 && legs.leg[0].observer_m == 20e3 && legs.leg[0].target_m == 0);
    CHECK_NEAR(legs.leg[0].range_m, 20e3, 1e-3);
    legs = air_legs(&up, 20e3);
    CHECK(legs.count == 1 && legs.leg[0].observer_m == 10e3 && legs.leg[0].target_m == 20e3);
    CHECK_NEAR(legs.leg[0].range_m, 10e3, 1e-3);
    CHECK(air_legs(&above, 20e3).count == 0);
    /* through the air from 30 to 30 km, lowest at 18 km: twice the root of (R + 20)^2 - (R + 18)^2 */
    const double  half_m = sqrt((earth_m + 30e3) * (earth_m + 30e3) - (earth_m + 18e3) * (earth_m + 18e3));
    const AirPath through = {30e3, 30e3, 2 * half_m, 0, 0};
    legs = air_legs(&through, 20e3);
    CHECK(legs.count == 2);
    CHECK_NEAR(legs.leg[0].range_m + legs.leg[1].range_m,
               2 * sqrt((earth_m + 20e3) * (earth_m + 20e3) - (earth_m + 18e3) * (earth_m + 18e3)), 1);
    CHECK_NEAR(legs.leg[0].target_m, 18e3, 0.1);
    PathAir high, low;
    for (int b = 0; b < AIR_BAND_COUNT; b++) { /* the 79 km above take and scatter nothing */
        const AirPath whole = {99e3, 0, 99e3, 0.5, 1}, part = {20e3, 0, 20e3, 0.5, 1};
        atmosphere_path(&high, atmosphere, 23000, (AirBand)b, &whole, 300);
        atmosphere_path(&low, atmosphere, 23000, (AirBand)b, &part, 300);
        CHECK_NEAR(high.transmittance, low.transmittance, 1e-12);
        CHECK_NEAR(high.scattered_w_m2_sr, low.scattered_w_m2_sr, 1e-9);
    }
}

/* Pieces of a long leg are 80 km and a rest, from the observer on, so that one more begins with nothing: the path goes
 * on where a range passes a multiple of it. */
static void no_step_from_piece_to_piece(void **state)
{
    (void)state;
    AirPath       piece[air_pieces_max];
    const AirPath leg = {10e3, 3e3, 250e3, 1, 0.5};
    CHECK(air_leg_pieces(piece, &leg) == 4);
    for (int i = 0; i < 4; i++) CHECK_NEAR(piece[i].range_m, i < 3 ? 80e3 : 10e3, 1e-6);
    CHECK(piece[3].target_m == 3e3);
    for (int i = 1; i < 4; i++) CHECK(piece[i].observer_m == piece[i - 1].target_m);
    for (int r = 2; r <= 5; r++)
        for (int h = 0; h < 4; h++) {
            static const double heights_m[] = {1500, 5e3, 10e3, 20e3};
            PathAir             to[2];
            for (int k = 0; k < 2; k++) {
                const AirPath path = {heights_m[h], 0.3 * heights_m[h], r * 80e3 + (k ? 0.01 : -0.01), 1, 0.5};
                atmosphere_path(&to[k], atmosphere, 23000, AIR_G, &path, 300);
            }
            /* two centimetres of some hundred kilometres */
            CHECK_NEAR(log(to[1].transmittance) / log(to[0].transmittance), 1, 2e-6);
        }
}

/* Two legs' depths: as a sum in visible light; in the infrared by what LOWTRAN7 makes of 226 to 639 km between two
 * points at one height (us1976, 23 km; transmittance for the sun in nir, for 300 K in mwir and lwir; what the air
 * itself shows: sums over shells as those of limb.csv). */
static void paths_past_their_lowest_point(void **state)
{
    (void)state;
    static const struct {
        double height_m, lowest_m, nir, mwir, mwir_w_m2_sr, lwir, lwir_w_m2_sr;
    } row[] = {{10e3, 8e3, 0.45061, 0.19861, 0.03493, 0.65550, 2.86590},
               {10e3, 5e3, 0.08195, 0.06309, 0.07290, 0.36818, 8.02331},
               {15e3, 10e3, 0.57705, 0.22436, 0.01723, 0.64906, 1.98201},
               {5e3, 4e3, 0.08479, 0.06493, 0.20692, 0.29003, 12.65951},
               {10e3, 2e3, 6e-5, 0.00178, 0.12940, 0.00304, 18.57867}};
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        const double half_m =
            sqrt((row[i].height_m - row[i].lowest_m) * (2 * earth_m + row[i].height_m + row[i].lowest_m));
        const AirPath path = {row[i].height_m, row[i].height_m, 2 * half_m, pi_rad, 0};
        const double  tau[] = {row[i].nir, row[i].mwir, row[i].lwir},
                     own[] = {0, row[i].mwir_w_m2_sr, row[i].lwir_w_m2_sr};
        for (int k = 0; k < 3; k++) {
            PathAir       got;
            const AirBand band = (AirBand)(AIR_NIR + k);
            atmosphere_path(&got, atmosphere, 23000, band, &path, 300);
            print_message("%.0f m past %.0f m, %s: tau %.4f (%.4f), own %.4f (%.4f)\n", row[i].height_m,
                          row[i].lowest_m, air_band_name(band), k ? got.transmittance : got.sun_transmittance, tau[k],
                          got.thermal_w_m2_sr, own[k]);
            /* its rays that pass level have up to 8 % too much air (etc/atmosphere/README.md) */
            CHECK_NEAR(k ? got.transmittance : got.sun_transmittance, tau[k], 0.06);
            if (!k) continue;
            /* of what is opaque in it */
            const double source = got.thermal_w_m2_sr / (1 - got.transmittance);
            CHECK_NEAR(kelvin(band, source), kelvin(band, own[k] / (1 - tau[k])), 2.5);
        }
    }
}

/* ---- the sky below the horizontal ----------------------------------------------------------------------- */

static double cell(const Table *table, int row, const char *column)
{
    double value = NAN;
    CHECK(text_to_double(&value, table_text(table, row, table_column(table, column))));
    return value;
}

/* What an eye sees of air and ground along a straight line. */
static double seen_from(const Atmosphere *air, double visibility_m, AirBand band, double eye_m, double tangent_m,
                        double range_m, double ground_k)
{
    SkyAir        sky;
    PathAir       way;
    const AirPath path = {eye_m, 0, range_m, pi_rad, 0};
    if (!(range_m > 0)) {
        atmosphere_sky(&sky, air, visibility_m, band, eye_m, 0.5 * pi_rad - to_tangent(eye_m, tangent_m), pi_rad, 0);
        return sky.thermal_w_m2_sr;
    }
    atmosphere_path(&way, air, visibility_m, band, &path, ground_k);
    return way.thermal_w_m2_sr + way.transmittance * planck_table_radiance(band == AIR_LWIR ? lwir : mwir, ground_k);
}

/* Within 2 % where there is more than a twentieth of the brightest, of two models, two visibilities and eyes from 1
 * to 99.9 km. */
static void against_shells(void **state)
{
    (void)state;
    Table       table;
    Atmosphere *summer;
    double      worst[2][2] = {{0}}, sum2[2] = {0}, most[2] = {0};
    int         count = 0;
    CHECK(table_open(&table, "tests/data/limb.csv") == STATUS_OK && table.rows == 165);
    CHECK(atmosphere_open(&summer, "midlat_summer") == STATUS_OK);
    for (int i = 0; i < table.rows; i++) {
        const double eye_m = cell(&table, i, "observer_m"), range_m = cell(&table, i, "range_m");
        const bool   us = strcmp(table_text(&table, i, table_column(&table, "model")), "us1976") == 0;
        if (i % 11 == 0) /* the lowest of the eye's skies is the brightest */
            for (int k = 0; k < 2; k++) most[k] = cell(&table, i + 5, k ? "lwir" : "mwir");
        for (int k = 0; k < 2; k++) {
            const double want = cell(&table, i, k ? "lwir" : "mwir");
            const double got =
                seen_from(us ? atmosphere : summer, cell(&table, i, "visibility_m"), (AirBand)(AIR_MWIR + k), eye_m,
                          cell(&table, i, "tangent_m"), range_m, us ? 288.2 : 294.2);
            const double error = got / want - 1;
            if (want < 0.05 * most[k]) continue;
            if (fabs(error) > 0.01)
                print_message("%s: eye %.0f m, lowest %.0f m, range %.0f m: %+.4f\n", k ? "lwir" : "mwir", eye_m,
                              cell(&table, i, "tangent_m"), range_m, error);
            worst[range_m > 0][k] = fmax(worst[range_m > 0][k], fabs(error));
            sum2[k] += error * error, count += k;
        }
    }
    print_message("against sums over shells: rms %.4f and %.4f, worst sky %.4f and %.4f, ground %.4f and %.4f\n",
                  sqrt(sum2[0] / count), sqrt(sum2[1] / count), worst[0][0], worst[0][1], worst[1][0], worst[1][1]);
    for (int k = 0; k < 2; k++) CHECK(worst[0][k] < 0.02 && worst[1][k] < 0.03);
    atmosphere_close(summer);
    table_close(&table);
}

/* ---- in a frame ---------------------------------------------------------------------------------------- */

/* Of rays the worst difference of a frame's radiance from each ray's by itself, over the latter and 2 % of the
 * brightest. */
static double worst_of(const AirPaths *table, const AirPaths *direct, double most, int first, int end)
{
    double worst = 0;
    for (int i = first; i < end; i++) {
        const double want = (double)direct->added_w_m2_sr[i], got = (double)table->added_w_m2_sr[i];
        worst = fmax(worst, fabs(got - want) / (want + 0.02 * most));
    }
    return worst;
}

/* From the horizontal down to the Earth's edge and on to the ground, by a frame's tables and path by path: towards the
 * sun, across and opposite; skies by their lowest point, dense where the air is thick. */
static void frames_follow(void **state)
{
    (void)state;
    enum { skies = 120, grounds = 60, azimuths = 6 };
    static const double eyes_m[] = {50, 1000, 5000, 10000, 14000, 20000, 50000, 60000, 99000};
    static AirPaths     table[AIR_BAND_COUNT], direct[AIR_BAND_COUNT];
    const Weather       weather = weather_default();
    for (int e = 0; e < 9; e++) {
        const double eye_m = eyes_m[e], edge_rad = to_tangent(eye_m, 0);
        const Air    air = air_of(&weather, 40, eye_m, all_bands, NULL);
        clear();
        for (int k = 0; k < skies; k++) {
            const double share = (k + 0.5) / skies;
            add(sun_azimuth + pi_rad / 5 * (k % azimuths), to_tangent(eye_m, fmin(eye_m, 38e3) * share * share),
                INFINITY);
        }
        for (int k = 0; k < grounds; k++) {
            const double share = (k + 0.01) / grounds;
            add(sun_azimuth + pi_rad / 5 * (k % azimuths), edge_rad - (0.5 * pi_rad + edge_rad) * share * share,
                INFINITY);
        }
        air_paths_of(table, &air, all_bands, &hits, &rays, NULL);
        air_paths_directly(direct, &air, all_bands, &hits, &rays, NULL, table);
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            double most = 0;
            for (int i = 0; i < hits.count; i++) {
                most = fmax(most, (double)direct[b].added_w_m2_sr[i]);
                CHECK((table[b].range_m[i] < INFINITY) == (i >= skies)); /* the edge is where it belongs */
            }
            const double sky = worst_of(&table[b], &direct[b], most, 0, skies);
            const double ground = worst_of(&table[b], &direct[b], most, skies, skies + grounds);
            print_message("%5.0f m %-4s: sky within %.4f, ground within %.4f\n", eye_m, air_band_name((AirBand)b), sky,
                          ground);
            /* in mwir by day the haze's light towards the sun ends within a row, below 3 km */
            CHECK(sky < (b == AIR_LWIR ? 0.02 : b == AIR_MWIR && eye_m > 10e3 ? 0.055 : 0.03));
            CHECK(ground < (b == AIR_LWIR ? 0.03 : 0.085));
        }
    }
}

/* The sky from high up is dark above and bright at the horizontal, on the sun's side and opposite alike: within a tenth
 * all round of each ray by itself, and 2 % rms. */
static void frames_follow_above(void **state)
{
    (void)state;
    static const double eyes_m[] = {3000, 10000, 20000, 30000};
    static AirPaths     table[AIR_BAND_COUNT], direct[AIR_BAND_COUNT];
    const Weather       weather = weather_default();
    for (int e = 0; e < 8; e++) {
        const Air air = air_of(&weather, e % 2 ? 15 : 40, eyes_m[e / 2], all_bands, NULL);
        clear();
        for (int k = 0; k < 200; k++) {
            const double share = (k / 10 + 0.3) / 20;
            add(sun_azimuth + 0.05 + 0.32 * (k % 10), asin(share * share), INFINITY);
        }
        air_paths_of(table, &air, all_bands, &hits, &rays, NULL);
        air_paths_directly(direct, &air, all_bands, &hits, &rays, NULL, table);
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            double sum2 = 0;
            for (int i = 0; i < hits.count; i++) {
                const double error = (double)(table[b].added_w_m2_sr[i] / direct[b].added_w_m2_sr[i]) - 1;
                CHECK_NEAR(error, 0, 0.1);
                sum2 += error * error;
            }
            CHECK(sqrt(sum2 / hits.count) < 0.02);
        }
    }
}

/* No step at the horizontal, nor at the edge but what the ground itself sends through the air, in a frame's tables and
 * path by path: by the definition of what is seen. In kelvin in the thermal bands, by day and by night. */
static void continuous(void **state)
{
    (void)state;
    static const double eyes_m[] = {10, 300, 1000, 5000, 10000, 20000, 30000, 60000, 99000};
    static AirPaths     out[2][AIR_BAND_COUNT];
    const Weather       weather = weather_default();
    double              worst_k[2] = {0}, worst[2] = {0};
    for (int e = 0; e < 18; e++) {
        const double eye_m = eyes_m[e / 2], edge_rad = to_tangent(eye_m, 0);
        const Air    air = air_of(&weather, e % 2 ? -30 : 40, eye_m, all_bands, NULL);
        clear();
        for (int k = 0; k < 4; k++) {
            const double azimuth = 2.0 + 0.9 * k;
            add(azimuth, 1e-9, INFINITY), add(azimuth, -1e-9, INFINITY);
            add(azimuth, edge_rad * (1 - 1e-7), INFINITY), add(azimuth, edge_rad * (1 + 1e-7), INFINITY);
        }
        air_paths_of(out[0], &air, all_bands, &hits, &rays, NULL);
        air_paths_directly(out[1], &air, all_bands, &hits, &rays, NULL, out[0]);
        for (int way = 0; way < 2; way++)
            for (int b = 0; b < AIR_BAND_COUNT; b++)
                for (int i = 0; i < hits.count; i += 4) {
                    const float *seen = out[way][b].added_w_m2_sr + i, *passed = out[way][b].air_transmittance + i;
                    CHECK(fabsf(seen[1] - seen[0]) <= 1e-3f * seen[0]); /* from 60 km it is nothing in visible light */
                    CHECK(out[way][b].range_m[i + 2] == INFINITY && out[way][b].range_m[i + 3] < INFINITY);
                    /* below, the air; above, the level sky through the same air: none of it from 5 km up */
                    const double heat = (double)air.light.sky[b].thermal_w_m2_sr[0];
                    const double level_enu[3] = {rays.d_enu[0][i], rays.d_enu[1][i], 0};
                    const double sky =
                        (double)passed[3] * heat + (double)out[way][b].sun_transmittance[i + 3] *
                                                       (daylight_sky(&air.light, (AirBand)b, level_enu) - heat);
                    if (b < AIR_MWIR) {
                        if (eye_m >= 5000 && e % 2 == 0)
                            worst[way] = fmax(worst[way], (double)fabsf(seen[3] / seen[2] - 1));
                    } else {
                        worst_k[way] = fmax(worst_k[way], fabs(kelvin((AirBand)b, (double)seen[3] + sky) -
                                                               kelvin((AirBand)b, (double)seen[2])));
                    }
                }
    }
    print_message("step at the edge: tables %.3f K and %.4f, single rays %.3f K and %.4f\n", worst_k[0], worst[0],
                  worst_k[1], worst[1]);
    CHECK(worst_k[0] < 0.3 && worst_k[1] < 0.3 && worst[0] < 0.03 && worst[1] < 0.001);
}

/* From 30, 50 and 99 km the ground is what it is from 20 km under the angle at which the ray enters the air there, but
 * for what the air above sends and takes: at night what sums over shells make of that (us1976, 23 km, black ground of
 * 288.2 K; Air of etc/atmosphere/make/limb.py, with shells to the eye, of rays of one sine at the ground), which in
 * 3.4-4.8 um is 5.5 % at 7 degrees below the horizontal: warm carbon dioxide at 45 km. 1 % in the other bands. */
static void the_same_from_above(void **state)
{
    (void)state;
    static const double eyes_m[] = {20e3, 30e3, 50e3, 99e3}, downs_rad[] = {-1.5, -0.8, -0.3, -0.12};
    static const double more[2][4][4] = {{{0, 0, 0, 0},
                                          {-0.0050, -0.0065, -0.0125, -0.0191},
                                          {0.0077, 0.0097, 0.0196, 0.0551},
                                          {0.0069, 0.0086, 0.0171, 0.0487}},
                                         {{0, 0, 0, 0},
                                          {-0.0163, -0.0188, -0.0238, -0.0218},
                                          {-0.0171, -0.0194, -0.0222, -0.0143},
                                          {-0.0171, -0.0194, -0.0222, -0.0143}}};
    static AirPaths     out[4][AIR_BAND_COUNT], direct[AIR_BAND_COUNT];
    const Weather       weather = us1976_weather();
    for (int e = 0; e < 8; e++) {
        const bool day = e < 4;
        const int  i = e % 4;
        const Air  air = air_of(&weather, day ? 40 : -30, eyes_m[i], all_bands, NULL);
        clear();
        for (int k = 0; k < 4; k++) /* the sine rule: the level part of the direction shrinks as 1 / r */
            add(2.0, -acos(cos(downs_rad[k]) * (earth_m + 20e3) / (earth_m + eyes_m[i])), INFINITY);
        air_paths_of(out[i], &air, all_bands, &hits, &rays, NULL);
        air_paths_directly(direct, &air, all_bands, &hits, &rays, NULL, out[i]);
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            for (int k = 0; k < 4; k++) {
                CHECK_NEAR(out[i][b].transmittance[k], out[0][b].transmittance[k], 2e-3);
                const double ground = b < AIR_MWIR ? 0 : planck_table_radiance(b == AIR_LWIR ? lwir : mwir, 288.2);
                const double share =
                    ((double)out[i][b].added_w_m2_sr[k] + ground * (double)out[i][b].air_transmittance[k]) /
                    ((double)out[0][b].added_w_m2_sr[k] + ground * (double)out[0][b].air_transmittance[k]);
                if (b < AIR_MWIR && day) CHECK_NEAR(share, 1, 0.01);
                if (b < AIR_MWIR) continue;
                if (!day)
                    print_message("%.0f m, %s, %.1f rad: %+.4f (%+.4f)\n", eyes_m[i], air_band_name((AirBand)b),
                                  downs_rad[k], share - 1, more[b - AIR_MWIR][i][k]);
                if (!day) CHECK_NEAR(share - 1, more[b - AIR_MWIR][i][k], b == AIR_LWIR ? 0.015 : 0.003);
                const double single = (double)direct[b].added_w_m2_sr[k];
                CHECK_NEAR(out[i][b].added_w_m2_sr[k], single, 0.05 * single);
            }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_follow),       cmocka_unit_test(continuous),
        cmocka_unit_test(frames_follow_above), cmocka_unit_test(no_step_from_piece_to_piece),
        cmocka_unit_test(the_same_from_above), cmocka_unit_test(lowest_points),
        cmocka_unit_test(cut_at_the_top),      cmocka_unit_test(paths_past_their_lowest_point),
        cmocka_unit_test(against_shells),
    };
    return cmocka_run_group_tests(tests, open_tables, close_tables);
}
