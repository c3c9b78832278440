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

/* ---- grids with a known surface ------------------------------------------------------------------- */

/* A grid's header as .gtx has it, and its posts, row by row from the south. */
typedef struct Grid {
    double south_deg, west_deg, step_lat_deg, step_lon_deg;
    int    rows, columns;
} Grid;

static void put_big(FILE *file, const void *value, size_t octets)
{
    for (size_t k = octets; k-- > 0;)
        CHECK(fputc(((const uint8_t *)value)[k], file) != EOF); /* this machine is little */
}

/* The product of a place's direction with (55, -30, 40) m: on the sphere a linear function, so smooth over both poles
 * and over the seam, and different half way round. */
static double plane_m(double lat_rad, double lon_rad)
{
    return cos(lat_rad) * (55 * cos(lon_rad) - 30 * sin(lon_rad)) + 40 * sin(lat_rad);
}

/* odd_row, odd_column: a post that has the value odd_m. */
static void write_grid(char path[text_file_size], const Grid *g, int odd_row, int odd_column, float odd_m)
{
    text_file(path, "");
    FILE *file = fopen(path, "wb");
    CHECK(file != NULL);
    put_big(file, &g->south_deg, 8), put_big(file, &g->west_deg, 8);
    put_big(file, &g->step_lat_deg, 8), put_big(file, &g->step_lon_deg, 8);
    put_big(file, &g->rows, 4), put_big(file, &g->columns, 4);
    for (int row = 0; row < g->rows; row++)
        for (int column = 0; column < g->columns; column++) {
            const float n_m = row == odd_row && column == odd_column
                                  ? odd_m
                                  : (float)plane_m((g->south_deg + row * g->step_lat_deg) * rad_per_deg,
                                                   (g->west_deg + column * g->step_lon_deg) * rad_per_deg);
            put_big(file, &n_m, 4);
        }
    CHECK(fclose(file) == 0);
}

static double look(const Geoid *geoid, double lat_deg, double lon_deg)
{
    return geoid_height_m(geoid, lat_deg * rad_per_deg, lon_deg * rad_per_deg);
}

/* Cubic interpolation of a sine of amplitude A by steps of h misses at most 0.0234 h^4 A (9/16 of h^4 / 4!): of 75 m by
 * 6 and 7.5 degrees 0.2 and 0.5 mm, the second at most 1.25 times over the other axis; 1 mm, and no post is rounded by
 * more than 4 um. A row over a pole that is not turned half round misses by 0.4 m and more, a column off the seam by
 * as much. Steps of both axes differ, so they cannot be exchanged, and the seam is at four places. */
static void a_known_surface_is_met_over_poles_and_seam(void **state)
{
    (void)state;
    static const double west_deg[] = {-180, 0, -7.5, 180};
    for (int k = 0; k < 4; k++) {
        const Grid grid = {-90, west_deg[k], 6, 7.5, 31, 48};
        char       path[text_file_size];
        Geoid      geoid;
        write_grid(path, &grid, -1, -1, 0);
        assert_int_equal(geoid_open(&geoid, path), STATUS_OK);
        for (double lat_deg = -90; lat_deg <= 90; lat_deg += 1.25)
            for (double lon_deg = -361; lon_deg < 362; lon_deg += 2.3)
                CHECK_NEAR(look(&geoid, lat_deg, lon_deg), plane_m(lat_deg * rad_per_deg, lon_deg * rad_per_deg), 1e-3);
        for (int side = -1; side <= 1; side += 2) /* within a cell of the seam and of both poles */
            for (double off_deg = 1e-9; off_deg < 7; off_deg *= 3)
                for (double lon_deg = -180; lon_deg <= 180; lon_deg += 90) {
                    const double lat_deg = side * (90 - off_deg), seam_deg = lon_deg + side * off_deg;
                    CHECK_NEAR(look(&geoid, lat_deg, seam_deg), plane_m(lat_deg * rad_per_deg, seam_deg * rad_per_deg),
                               1e-3);
                    CHECK_NEAR(look(&geoid, 33, seam_deg), plane_m(33 * rad_per_deg, seam_deg * rad_per_deg), 1e-3);
                }
        CHECK(isnan(look(&geoid, 90.001, 0)) && isnan(look(&geoid, -90.001, 0)));
        geoid_close(&geoid);
        remove(path);
    }
}

/* A grid of a region: its outermost cells lack a neighbour and have no height; the others have, at all four sides. The
 * grid is 40 .. 52 N by 1.5 degrees, 10 .. 26 E by 2 degrees. Nor have cells that touch a gap's cubic: three to each
 * side of it in its row and column, and no more. Outside there is none. */
static void a_region_ends_where_its_posts_end(void **state)
{
    (void)state;
    static const Grid grid = {40, 10, 1.5, 2, 9, 9};
    char              path[text_file_size];
    Geoid             geoid;
    write_grid(path, &grid, -1, -1, 0);
    assert_int_equal(geoid_open(&geoid, path), STATUS_OK);
    for (int row = -2; row < 10; row++)
        for (int column = -2; column < 10; column++) {
            const double lat_deg = 40 + 1.5 * (row + 0.5), lon_deg = 10 + 2 * (column + 0.5);
            const bool   inside = row >= 1 && row <= 6 && column >= 1 && column <= 6;
            const double n_m = look(&geoid, lat_deg, lon_deg);
            CHECK(isnan(n_m) == !inside);
            if (inside) CHECK_NEAR(n_m, plane_m(lat_deg * rad_per_deg, lon_deg * rad_per_deg), 1e-4);
        }
    geoid_close(&geoid);
    remove(path);
    write_grid(path, &grid, 4, 5, -88.8888f);
    assert_int_equal(geoid_open(&geoid, path), STATUS_OK);
    for (int row = 1; row < 7; row++)
        for (int column = 1; column < 7; column++) {
            const bool touches = row - 1 <= 4 && row + 2 >= 4 && column - 1 <= 5 && column + 2 >= 5;
            CHECK(isnan(look(&geoid, 40 + 1.5 * (row + 0.5), 10 + 2 * (column + 0.5))) == touches);
        }
    geoid_close(&geoid);
    remove(path);
}

/* 200 m on either side hold every geoid of the Earth (EGM96: -107 .. 85 m); a post beyond is a spoilt grid, and so is a
 * header whose rows pass a pole, whose columns pass a whole circle, or that has fewer than four of either. */
static void impossible_grids_are_refused(void **state)
{
    (void)state;
    static const struct {
        Grid   grid;
        float  odd_m;
        Status status;
    } c[] = {
        {{-90, 0, 10, 10, 19, 36}, 200, STATUS_OK},        {{-90, 0, 10, 10, 19, 36}, -200, STATUS_OK},
        {{-90, 0, 10, 10, 19, 36}, 201, STATUS_BAD_VALUE}, {{-90, 0, 10, 10, 19, 36}, -201, STATUS_BAD_VALUE},
        {{-90, 0, 10, 10, 19, 36}, NAN, STATUS_BAD_VALUE}, {{-90, 0, 10, 10, 20, 36}, 0, STATUS_BAD_VALUE},
        {{-90.1, 0, 10, 10, 19, 36}, 0, STATUS_BAD_VALUE}, {{-90, 0, 10, 10, 19, 37}, 0, STATUS_OK},
        {{-90, 0, 10, 10, 19, 38}, 0, STATUS_BAD_VALUE},   {{0, 0, 10, 10, 4, 4}, 0, STATUS_OK},
        {{0, 0, 10, 10, 3, 4}, 0, STATUS_BAD_VALUE},       {{0, 0, 10, 10, 4, 3}, 0, STATUS_BAD_VALUE},
        {{0, 361, 10, 10, 4, 4}, 0, STATUS_BAD_VALUE},     {{0, -361, 10, 10, 4, 4}, 0, STATUS_BAD_VALUE},
        {{0, 0, -10, 10, 4, 4}, 0, STATUS_BAD_VALUE},      {{0, 0, 10, -10, 4, 4}, 0, STATUS_BAD_VALUE},
    };
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        char  path[text_file_size];
        Geoid geoid = {0};
        write_grid(path, &c[i].grid, 2, 3, c[i].odd_m);
        assert_int_equal(geoid_open(&geoid, path), c[i].status);
        if (c[i].status == STATUS_BAD_VALUE && c[i].odd_m != 0) CHECK(strstr(check_said, "row 2, column 3"));
        geoid_close(&geoid);
        remove(path);
    }
    log_set_sink(NULL, NULL);
}

/* The header alone decides what is refused: 4 .. 65535 rows and columns, 40 Mi posts (160 MiB) at most. With a header
 * that is taken, the posts that are not there are found missing. */
static void sizes_are_limited_before_memory_is_taken(void **state)
{
    (void)state;
    static const struct {
        int    rows, columns;
        Status status;
    } c[] = {{4, 4, STATUS_TRUNCATED},         {65535, 4, STATUS_TRUNCATED},     {65536, 4, STATUS_BAD_VALUE},
             {4, 65535, STATUS_TRUNCATED},     {4, 65536, STATUS_BAD_VALUE},     {640, 65535, STATUS_TRUNCATED},
             {641, 65535, STATUS_BAD_VALUE},   {65535, 65535, STATUS_BAD_VALUE}, {-1, 4, STATUS_BAD_VALUE},
             {4, INT32_MIN, STATUS_BAD_VALUE}, {0, 0, STATUS_BAD_VALUE}};
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        char  path[text_file_size];
        Geoid geoid = {0};
        write_grid(path, &(Grid){0, 0, 1e-3, 1e-3, 0, 0}, -1, -1, 0);
        FILE *file = fopen(path, "r+b");
        CHECK(file && fseek(file, 32, SEEK_SET) == 0);
        put_big(file, &c[i].rows, 4), put_big(file, &c[i].columns, 4);
        CHECK(fclose(file) == 0);
        assert_int_equal(geoid_open(&geoid, path), c[i].status);
        geoid_close(&geoid);
        remove(path);
    }
    log_set_sink(NULL, NULL);
}

/* A grid's steps and edges are compared to within 1e-6 degree (0.1 m), and so are the ends of a region in steps; a
 * place may be 1e-9 degree beyond a pole; a post within 1 mm of the mark -88.8888 is a gap. Each on both sides of its
 * limit. */
static void rounding_is_allowed_for_and_no_more(void **state)
{
    (void)state;
    log_set_sink(check_listen, NULL);
    for (int beyond = 0; beyond < 2; beyond++) {
        const double off_deg = beyond ? 1.05e-6 : 0.95e-6;
        const Grid   grid[] = {{0, 0, (90 + off_deg) / 9, 10, 10, 36},     /* its last row is beyond the pole */
                               {-90, 0, 10, (360 + off_deg) / 36, 19, 37}, /* its columns beyond the circle */
                               {-90, 0, 10, (360 + off_deg) / 36, 19, 36}, /* round the circle, or not */
                               {-90 + off_deg, 0, 10, 10, 10, 36},         /* from the pole, or not */
                               {-off_deg, 0, 10, 10, 10, 36},              /* to the pole, or not */
                               {0, 0, 10, 10, 5, 5}};
        for (int k = 0; k < 6; k++) {
            char  path[text_file_size];
            Geoid geoid = {0};
            write_grid(path, &grid[k], -1, -1, 0);
            assert_int_equal(geoid_open(&geoid, path), k < 2 && beyond ? STATUS_BAD_VALUE : STATUS_OK);
            if (k == 2) CHECK(isnan(look(&geoid, 5, 355)) == beyond);
            if (k == 3) CHECK(isnan(look(&geoid, -85, 20)) == beyond);
            if (k == 4) CHECK(isnan(look(&geoid, 85, 20)) == beyond);
            if (k == 5) { /* posts are missing beyond the inner cells; there the ends in rows are those of the file */
                CHECK(isfinite(look(&geoid, 15, 15)));
                CHECK(isnan(look(&geoid, -10 * off_deg, 15)));
            }
            geoid_close(&geoid);
            remove(path);
        }
        const Grid whole = {-90, 0, 10, 10, 19, 36};
        for (int side = -1; side <= 1; side += 2) {
            char        path[text_file_size];
            Geoid       geoid;
            const float odd_m = -88.8888f + (float)(side * (beyond ? 1.05e-3 : 0.95e-3));
            write_grid(path, &whole, 9, 3, odd_m);
            assert_int_equal(geoid_open(&geoid, path), STATUS_OK);
            CHECK(isnan(look(&geoid, 0, 30)) == !beyond);
            if (beyond) CHECK_NEAR(look(&geoid, 0, 30), odd_m, 1e-4);
            CHECK(isnan(look(&geoid, side * (90 + 1e-3 * off_deg), 77)) == beyond);
            geoid_close(&geoid);
            remove(path);
        }
    }
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nga_values_are_met),
        cmocka_unit_test(it_is_one_surface_over_seam_and_poles),
        cmocka_unit_test(a_missing_or_spoilt_grid_says_what_to_do),
        cmocka_unit_test(a_known_surface_is_met_over_poles_and_seam),
        cmocka_unit_test(a_region_ends_where_its_posts_end),
        cmocka_unit_test(impossible_grids_are_refused),
        cmocka_unit_test(rounding_is_allowed_for_and_no_more),
        cmocka_unit_test(sizes_are_limited_before_memory_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
