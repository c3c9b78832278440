/* tests/terrain/test_probe.c: the room's probes, through the CSV that a user gives, against published numbers. */
#include "tests/check.h"

#include "terrain/probe.h"

/* Number in a named column of the only row; NaN when the cell is empty. */
static double asked(const char *name, const char *csv, const char *column)
{
    char   text[4096] = "", *line[2], *head[32], *cell[32];
    FILE  *in = fmemopen((void *)(uintptr_t)csv, strlen(csv), "r"), *out = fmemopen(text, sizeof text - 1, "w");
    double value = NAN;
    CHECK(in && out);
    const Probe *probe = NULL;
    for (int i = 0; i < terrain_probe_count; i++)
        if (strcmp(terrain_probes[i].name, name) == 0) probe = &terrain_probes[i];
    char *argv[] = {(char *)(uintptr_t)name, NULL};
    CHECK(probe && probe_run(probe, 1, argv, in, out) == STATUS_OK);
    fclose(in);
    fclose(out);
    line[0] = strtok(text, "\n");
    line[1] = strtok(NULL, "\n");
    CHECK(line[0] && line[1]);
    const int columns = text_split(head, 32, line[0]);
    CHECK(text_split(cell, 32, line[1]) == columns);
    for (int c = 0; c < columns; c++)
        if (strcmp(head[c], column) == 0) return *cell[c] && text_to_double(&value, cell[c]) ? value : NAN;
    fail_msg("no column %s", column);
    return NAN;
}

static void the_sun_of_nrels_example(void **state)
{
    (void)state;
    /* NREL/TP-560-34302, table A5.1: 2003-10-17 12:30:30 at UTC-7, Golden, Colorado; delta T 67 s */
    static const char row[] = "utc,lat_deg,lon_deg,h_m,pressure_mbar,temp_c,delta_t_s\n"
                              "2003-10-17T19:30:30Z,39.742476,-105.1786,1830.14,820,11,67\n";
    CHECK_NEAR(asked("sun", row, "zenith_deg"), 50.11162, 0.0005); /* as tests/terrain/test_sun.c */
    CHECK_NEAR(asked("sun", row, "azimuth_deg"), 194.34024, 0.0005);
    CHECK_NEAR(asked("sun", row, "distance_au"), 0.9965422974, 1e-6);
    CHECK(isnan(
        asked("sun", "utc,lat_deg,lon_deg,h_m,pressure_mbar,temp_c\n2003-10-17,39,-105,0,820,11\n", "zenith_deg")));
}

/* From 100 m: dip 17.97', horizon 38.26 km, of a ship at 44 km 2.25 m hidden and 19.70 m raised (k 1.149, R 6371 km:
 * sqrt(2 k R h), (d - 38.26 km)^2 / 2kR, (1 - 1/k) d^2 / 2R); radar 15.1 % farther than a vacuum's 35.70: 41.22 km. The
 * air between 0 and 100 m bends half a per cent less than that at the ground. */
static void the_horizon_of_100_m(void **state)
{
    (void)state;
    static const char row[] = "eye_m,range_m\n100,44000\n";
    CHECK_NEAR(asked("horizon", row, "dip_deg") * 60, 17.97, 0.01);
    CHECK_NEAR(asked("horizon", row, "horizon_m"), 38263, 20);
    CHECK_NEAR(asked("horizon", row, "hidden_m"), 2.248, 0.02);
    CHECK_NEAR(asked("horizon", row, "raised_m"), 19.70, 0.1);
    CHECK_NEAR(asked("horizon", row, "radar_horizon_m"), 41218, 70);
    CHECK_NEAR(asked("horizon", row, "radar_raised_m"), 37.98, 0.3);
    CHECK(asked("horizon", "eye_m,range_m\n100,30000\n", "hidden_m") == 0);
    CHECK(isnan(asked("horizon", "eye_m,range_m\n-1,30000\n", "dip_deg")));
}

static void the_geoid_of_ngas_example(void **state)
{
    (void)state;
    CHECK_NEAR(asked("geoid", "lat_deg,lon_deg\n38.6281550,269.7791550\n", "n_m"), -31.628, 0.015);
    CHECK(isnan(asked("geoid", "lat_deg,lon_deg\n91,0\n", "n_m")));
}

static void geodesy_goes_both_ways(void **state)
{
    (void)state;
    /* the pole and the equator of WGS 84, by its definition */
    CHECK_NEAR(asked("geodesy", "lat_deg,lon_deg,h_m\n90,0,100\n", "ecef_z_m"), 6356752.314245 + 100, 1e-5);
    CHECK_NEAR(asked("geodesy", "x_m,y_m,z_m\n0,6378237,0\n", "geodetic_h_m"), 100, 1e-6);
    CHECK_NEAR(asked("geodesy", "x_m,y_m,z_m\n0,6378237,0\n", "geodetic_lon_deg"), 90, 1e-12);
    /* 100 m above the origin is 100 m up; on the equator a degree east drops below the plane by a (1 - cos 1) */
    static const char up[] = "lat_deg,lon_deg,h_m,origin_lat_deg,origin_lon_deg,origin_h_m\n44,-123,150,44,-123,50\n";
    static const char east[] = "lat_deg,lon_deg,h_m,origin_lat_deg,origin_lon_deg,origin_h_m\n0,1,0,0,0,0\n";
    CHECK_NEAR(asked("geodesy", up, "up_m"), 100, 1e-6);
    CHECK_NEAR(asked("geodesy", east, "up_m"), 6378137 * (cos(rad_per_deg) - 1), 1e-5);
    CHECK_NEAR(asked("geodesy", east, "east_m"), 6378137 * sin(rad_per_deg), 1e-5);
    CHECK(isnan(asked("geodesy", "lat_deg,lon_deg,h_m,x_m\n1,2,3,4\n", "ecef_x_m")));
    CHECK(isnan(asked("geodesy", "lat_deg,lon_deg,h_m\n44,-123,0\n", "east_m")));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_sun_of_nrels_example),
        cmocka_unit_test(the_horizon_of_100_m),
        cmocka_unit_test(the_geoid_of_ngas_example),
        cmocka_unit_test(geodesy_goes_both_ways),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
