/* tests/terrain/test_geoid.c: EGM96 against NGA's own six values, at the seam, at the poles, and a grid that is spoilt.
 */
#include "tests/check.h"

#include "terrain/earth/geoid.h"

static void nga_values_are_met(void **state)
{
    (void)state;
    /* NGA's test values of EGM96: the harmonic program F477, and its interpolation from the 15-minute grid */
    static const struct {
        double lat_deg, lon_deg, harmonic_m, interpolated_m;
    } nga[] = {{38.6281550, 269.7791550, -31.629, -31.628}, {-14.6212170, 305.0211140, -2.966, -2.969},
               {46.8743190, 102.4487290, -43.572, -43.575}, {-23.6174460, 133.8747120, 15.868, 15.871},
               {38.6254730, 359.9995000, 50.065, 50.066},   {-0.4667440, 0.0023000, 17.330, 17.329}};
    Geoid geoid;
    assert_int_equal(geoid_open(&geoid, NULL), STATUS_OK);
    for (size_t i = 0; i < sizeof nga / sizeof *nga; i++) {
        const double n_m = geoid_height_m(&geoid, nga[i].lat_deg * rad_per_deg, nga[i].lon_deg * rad_per_deg);
        print_message("%9.4f %9.4f: %8.3f m, off harmonic %+.1f mm, off interpolation %+.1f mm\n", nga[i].lat_deg,
                      nga[i].lon_deg, n_m, 1e3 * (n_m - nga[i].harmonic_m), 1e3 * (n_m - nga[i].interpolated_m));
        CHECK_NEAR(n_m, nga[i].harmonic_m, 0.015); /* what 15 minutes between posts leave out of degree 360 */
        CHECK_NEAR(n_m, nga[i].interpolated_m, 0.010);
        CHECK_NEAR(geoid_height_m(&geoid, nga[i].lat_deg * rad_per_deg, (nga[i].lon_deg - 360) * rad_per_deg), n_m,
                   1e-9);
        CHECK_NEAR(geoid_height_m(&geoid, nga[i].lat_deg * rad_per_deg, (nga[i].lon_deg + 720) * rad_per_deg), n_m,
                   1e-9);
    }
    geoid_close(&geoid);
}

static void it_is_one_surface_over_seam_and_poles(void **state)
{
    (void)state;
    Geoid geoid;
    assert_int_equal(geoid_open(&geoid, ""), STATUS_OK);
    /* the geoid's slope is below 1e-3: 1e-9 rad is 6 mm on the ground */
    for (double lat_deg = -89; lat_deg < 90; lat_deg += 1.37)
        for (double lon_deg = -180; lon_deg <= 180; lon_deg += 90)
            CHECK_NEAR(geoid_height_m(&geoid, lat_deg * rad_per_deg, lon_deg * rad_per_deg - 1e-9),
                       geoid_height_m(&geoid, lat_deg * rad_per_deg, lon_deg * rad_per_deg + 1e-9), 1e-4);
    for (int south = 0; south < 2; south++) {
        const double pole_m = geoid_height_m(&geoid, south ? -pi_rad / 2 : pi_rad / 2, 0);
        CHECK_NEAR(pole_m, south ? -29.534 : 13.606, 0.01); /* NGA's EGM96 grid: its last rows */
        for (double lon_deg = 0; lon_deg < 360; lon_deg += 11) {
            const double lat_rad = (south ? -1 : 1) * (pi_rad / 2 - 1e-6);
            CHECK_NEAR(geoid_height_m(&geoid, lat_rad, lon_deg * rad_per_deg), pole_m, 0.002);
        }
    }
    CHECK(isnan(geoid_height_m(&geoid, 2, 0)) && isnan(geoid_height_m(&geoid, NAN, 0)) &&
          isnan(geoid_height_m(&geoid, 0, INFINITY)));
    geoid_close(&geoid);
}

static void a_missing_or_spoilt_grid_says_what_to_do(void **state)
{
    (void)state;
    Geoid geoid = {.rows = 7};
    char  path[text_file_size];
    log_set_sink(check_listen, NULL);
    assert_int_equal(geoid_open(&geoid, "/nowhere/egm96_15.gtx"), STATUS_IO);
    CHECK(strstr(check_said, "apt-get install proj-data") && geoid.rows == 7);
    text_file(path, "forty octets and more that are no grid of the Earth at all");
    assert_int_equal(geoid_open(&geoid, path), STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "terrain.geoid"));
    remove(path);
    text_file(path, "short");
    assert_int_equal(geoid_open(&geoid, path), STATUS_TRUNCATED);
    remove(path);

    /* the true header, and then nothing */
    static const unsigned char header[48] = {0xc0, 0x56, 0x80, 0,    0, 0, 0, 0,    0xc0, 0x66, 0x80, 0,    0, 0,
                                             0,    0,    0x3f, 0xd0, 0, 0, 0, 0,    0,    0,    0x3f, 0xd0, 0, 0,
                                             0,    0,    0,    0,    0, 0, 2, 0xd1, 0,    0,    5,    0xa0};
    text_file(path, "");
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(header, sizeof header, 1, file) == 1 && fclose(file) == 0);
    assert_int_equal(geoid_open(&geoid, path), STATUS_TRUNCATED);
    CHECK(strstr(check_said, "reinstall") && geoid.rows == 7);
    remove(path);
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nga_values_are_met),
        cmocka_unit_test(it_is_one_surface_over_seam_and_poles),
        cmocka_unit_test(a_missing_or_spoilt_grid_says_what_to_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
