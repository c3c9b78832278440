/* The nested grids: triangles, normals, outlines and pyramids by hand and by brute force. */
#include "tests/check.h"

#include "terrain/elevation/elevation.h"
#include "terrain/surface.h"

static void one_cell_is_two_triangles(void **state)
{
    (void)state;
    Elevation e = {0};
    CHECK(elevation_level_create(&e, 0, 2, 2, 100, 200, 10, 5, 0.5) == STATUS_OK);
    const uint16_t post[4] = {0, 4, 2, 20}; /* sw 5, se 7, nw 6, ne 15 m */
    memcpy(e.level[0].post, post, sizeof post);
    double n[3];

    CHECK_NEAR(elevation_height(&e, 100, 200, NULL), 5, 0);
    CHECK_NEAR(elevation_height(&e, 110, 200, NULL), 7, 0);
    CHECK_NEAR(elevation_height(&e, 100, 210, NULL), 6, 0);
    CHECK_NEAR(elevation_height(&e, 110, 210, NULL), 15, 0);
    /* on the diagonal from south-west to north-east both triangles say 10; bilinear would say 8.25 */
    CHECK_NEAR(elevation_height(&e, 105, 205, NULL), 10, 0);
    CHECK_NEAR(elevation_height(&e, 107.5, 202.5, NULL), 0.25 * 5 + 0.5 * 7 + 0.25 * 15, 1e-14);
    CHECK_NEAR(elevation_height(&e, 102.5, 207.5, n), 0.25 * 5 + 0.5 * 6 + 0.25 * 15, 1e-14);
    /* north-west triangle: 9 m in 10 eastwards, 1 in 10 northwards */
    const double length = sqrt(0.81 + 0.01 + 1);
    CHECK_NEAR(n[0], -0.9 / length, 1e-15);
    CHECK_NEAR(n[1], -0.1 / length, 1e-15);
    CHECK_NEAR(n[2], 1 / length, 1e-15);

    n[0] = 42;
    CHECK(isnan(elevation_height(&e, 110.001, 205, n)) && n[0] == 42);
    CHECK(isnan(elevation_height(&e, 105, 199.999, NULL)));
    CHECK(isnan(elevation_height(&e, NAN, 205, NULL)));
    CHECK(isnan(elevation_height(&e, INFINITY, 205, NULL)));
    elevation_destroy(&e);
}

static void the_inner_level_wins(void **state)
{
    (void)state;
    Elevation e = {0};
    CHECK(elevation_level_create(&e, 1, 5, 5, -16, -16, 8, 0, 1) == STATUS_OK);
    CHECK(elevation_level_create(&e, 0, 9, 9, -8, -8, 2, 100, 1) == STATUS_OK);
    CHECK(e.level_count == 2);
    CHECK_NEAR(elevation_height(&e, 0, 0, NULL), 100, 0);
    CHECK_NEAR(elevation_height(&e, 8, -8, NULL), 100, 0);
    CHECK_NEAR(elevation_height(&e, 8.001, -8, NULL), 0, 0);
    CHECK_NEAR(elevation_height(&e, 16, 16, NULL), 0, 0);
    elevation_destroy(&e);
    CHECK(e.level_count == 0);
}

/* The steepest of every edge of a square's cells, each way, edge by edge. */
static void check_rise(const ElevationLevel *level, int k, int i, int j)
{
    const int cells = 1 << k, nx = level->nx;
    int       east = 0, west = 0, north = 0, south = 0;
    if (k < elevation_rise_level) {
        CHECK(!level->rise[k]);
        return;
    }
    for (int b = j * cells; b <= (j + 1) * cells && b < level->ny; b++)
        for (int a = i * cells; a <= (i + 1) * cells && a < nx; a++) {
            const int z = level->post[b * nx + a];
            if (a < (i + 1) * cells && a + 1 < nx) {
                const int rise = level->post[b * nx + a + 1] - z;
                east = rise > east ? rise : east;
                west = -rise > west ? -rise : west;
            }
            if (b < (j + 1) * cells && b + 1 < level->ny) {
                const int rise = level->post[(b + 1) * nx + a] - z;
                north = rise > north ? rise : north;
                south = -rise > south ? -rise : south;
            }
        }
    const ElevationRise *got = &level->rise[k][j * level->pyramid_nx[k] + i];
    CHECK(got->east == east && got->west == west && got->north == north && got->south == south);
}

static void pyramids_are_maxima(void **state)
{
    (void)state;
    static const int size[][2] = {{2, 2}, {3, 2}, {2, 9}, {17, 17}, {18, 13}, {65, 34}, {100, 3}, {1100, 21}};
    for (size_t n = 0; n < sizeof size / sizeof size[0]; n++) {
        Elevation e = {0};
        CHECK(elevation_level_create(&e, 0, size[n][0], size[n][1], 0, 0, 1, 0, 1) == STATUS_OK);
        ElevationLevel *level = &e.level[0];
        for (int k = 0; k < level->nx * level->ny; k++) level->post[k] = (uint16_t)(65536 * random_uniform(n, 0, 0, k));
        elevation_build_pyramids(&e);
        CHECK(level->pyramid_nx[0] == level->nx - 1 && level->pyramid_ny[0] == level->ny - 1);
        for (int k = 0; k < level->pyramid_count; k++) {
            const int cells = 1 << k;
            if (k) CHECK(level->pyramid_nx[k] == (level->pyramid_nx[k - 1] + 1) / 2);
            for (int j = 0; j < level->pyramid_ny[k]; j++)
                for (int i = 0; i < level->pyramid_nx[k]; i++) {
                    uint16_t most = 0;
                    for (int b = j * cells; b <= (j + 1) * cells && b < level->ny; b++)
                        for (int a = i * cells; a <= (i + 1) * cells && a < level->nx; a++)
                            if (level->post[b * level->nx + a] > most) most = level->post[b * level->nx + a];
                    CHECK(level->pyramid[k][j * level->pyramid_nx[k] + i] == most);
                    check_rise(level, k, i, j);
                }
        }
        CHECK(level->pyramid_nx[level->pyramid_count - 1] == 1 && level->pyramid_ny[level->pyramid_count - 1] == 1);
        elevation_destroy(&e);
    }
}

static void bad_sizes_are_refused(void **state)
{
    (void)state;
    Elevation e = {0};
    CHECK(elevation_level_create(&e, 0, 1, 5, 0, 0, 1, 0, 1) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, elevation_max_levels, 5, 5, 0, 0, 1, 0, 1) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, -1, 5, 5, 0, 0, 1, 0, 1) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, 0, 5, 40000, 0, 0, 1, 0, 1) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, 0, 5, 5, NAN, 0, 1, 0, 1) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, 0, 5, 5, 0, 0, 0, 0, 1) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, 0, 5, 5, 0, 0, 1, 0, -1) == STATUS_BAD_VALUE);
    CHECK(e.level_count == 0 && !e.level[0].post);
    /* the longest side still fits the pyramid */
    CHECK(elevation_level_create(&e, 0, 32768, 2, 0, 0, 1, 0, 1) == STATUS_OK);
    CHECK(e.level[0].pyramid_nx[e.level[0].pyramid_count - 1] == 1);
    elevation_destroy(&e);
    elevation_destroy(NULL);
}

/* Every class has a name of its own and a row in etc/surfaces.csv, and no row is for anything else. */
static void every_surface_is_made_of_something(void **state)
{
    (void)state;
    char  path[512];
    Table table;
    CHECK(etc_path(path, sizeof path, "surfaces.csv"));
    CHECK(table_open(&table, path) == STATUS_OK);
    const int surface = table_column(&table, "surface"), material = table_column(&table, "material");
    CHECK(surface >= 0 && material >= 0);
    CHECK(table.rows == SURFACE_COUNT - 1);
    for (int s = 1; s < SURFACE_COUNT; s++) {
        int found = 0;
        for (int r = 0; r < table.rows; r++)
            found += strcmp(table_text(&table, r, surface), surface_name((SurfaceClass)s)) == 0 &&
                     table_text(&table, r, material)[0] != 0;
        CHECK(found == 1);
    }
    CHECK(strcmp(surface_name(SURFACE_NONE), "none") == 0);
    CHECK(strcmp(surface_name((SurfaceClass)99), "none") == 0);
    table_close(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_cell_is_two_triangles), cmocka_unit_test(the_inner_level_wins),
        cmocka_unit_test(pyramids_are_maxima),       cmocka_unit_test(bad_sizes_are_refused),
        cmocka_unit_test(every_surface_is_made_of_something),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
