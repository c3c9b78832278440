/* The nested grids: triangles, normals, outlines and pyramids by hand and by brute force. */
#include "tests/check.h"

#include "terrain/elevation/elevation.h"
#include "terrain/surface.h"

#include <stdlib.h>

static void one_cell_is_two_triangles(void **state)
{
    (void)state;
    Elevation e = {0};
    CHECK(elevation_level_create(&e, 0, &(ElevationGrid){2, 2, 100, 200, 10, 5, 0.5}) == STATUS_OK);
    static const int32_t post[4] = {0, 4, 2, 20}; /* sw 5, se 7, nw 6, ne 15 m */
    CHECK(elevation_fill(&e.level[0], post) == STATUS_OK);
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
    CHECK(elevation_level_create(&e, 1, &(ElevationGrid){5, 5, -16, -16, 8, 0, 1}) == STATUS_OK);
    CHECK(elevation_level_create(&e, 0, &(ElevationGrid){9, 9, -8, -8, 2, 100, 1}) == STATUS_OK);
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
            const int z = elevation_post(level, a, b);
            if (a < (i + 1) * cells && a + 1 < nx) {
                const int rise = elevation_post(level, a + 1, b) - z;
                east = rise > east ? rise : east;
                west = -rise > west ? -rise : west;
            }
            if (b < (j + 1) * cells && b + 1 < level->ny) {
                const int rise = elevation_post(level, a, b + 1) - z;
                north = rise > north ? rise : north;
                south = -rise > south ? -rise : south;
            }
        }
    const ElevationRise *got = &level->rise[k][j * level->pyramid_nx[k] + i];
    const int            unit = 1 << level->rise_shift, up = unit - 1;
    CHECK(got->east == (east + up) / unit && got->west == (west + up) / unit);
    CHECK(got->north == (north + up) / unit && got->south == (south + up) / unit);
}

/* Posts of one kind: one range of 65536; tiles of any base and shift; cliffs from end to end of what may be stored. */
enum { plain_posts, rough_posts, cliff_posts, post_kinds };

static int32_t some_post(int kind, uint64_t n, int i, int j)
{
    const double at = random_uniform(n, 0, (uint32_t)j, (uint64_t)i);
    if (kind == plain_posts) return (int32_t)(65536 * at);
    if (kind == cliff_posts) return (i / 3 + j / 5) % 2 ? elevation_lowest_post : elevation_highest_post;
    const int tile_i = i / elevation_tile_cells, tile_j = j / elevation_tile_cells;
    return (int32_t)((at - 0.5) * (1 << (8 + (5 * tile_i + 3 * tile_j) % 14))) + 100000 * (tile_i - tile_j);
}

static int32_t *some_posts(int kind, uint64_t n, int nx, int ny)
{
    int32_t *post = malloc((size_t)nx * (size_t)ny * sizeof *post);
    CHECK(post);
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) post[j * nx + i] = some_post(kind, n, i, j);
    return post;
}

static void check_pyramid(const ElevationLevel *level)
{
    CHECK(level->pyramid_nx[0] == level->nx - 1 && level->pyramid_ny[0] == level->ny - 1);
    for (int k = 0; k < level->pyramid_count; k++) {
        const int cells = 1 << k, unit = 1 << level->pyramid_shift;
        if (k) CHECK(level->pyramid_nx[k] == (level->pyramid_nx[k - 1] + 1) / 2);
        CHECK(!level->pyramid[k] == (k < elevation_pyramid_first));
        for (int j = 0; j < level->pyramid_ny[k] && level->pyramid[k]; j++)
            for (int i = 0; i < level->pyramid_nx[k]; i++) {
                int32_t most = INT32_MIN;
                for (int b = j * cells; b <= (j + 1) * cells && b < level->ny; b++)
                    for (int a = i * cells; a <= (i + 1) * cells && a < level->nx; a++)
                        if (elevation_post(level, a, b) > most) most = elevation_post(level, a, b);
                const int32_t over = elevation_highest(level, k, i, j) - most;
                CHECK(over >= 0 && over < unit);
                check_rise(level, k, i, j);
            }
    }
    CHECK(level->pyramid_nx[level->pyramid_count - 1] == 1 && level->pyramid_ny[level->pyramid_count - 1] == 1);
}

static void pyramids_are_maxima(void **state)
{
    (void)state;
    static const int size[][2] = {{2, 2}, {3, 2}, {2, 9}, {17, 17}, {65, 34}, {66, 65}, {100, 3}, {430, 131}};
    for (int n = 0; n < post_kinds * (int)(sizeof size / sizeof size[0]); n++) {
        const int *side = size[n / post_kinds], kind = n % post_kinds;
        Elevation  e = {0};
        CHECK(elevation_level_create(&e, 0, &(ElevationGrid){side[0], side[1], 0, 0, 1, 0, 1}) == STATUS_OK);
        int32_t *post = some_posts(kind, (uint64_t)n, side[0], side[1]);
        CHECK(elevation_fill(&e.level[0], post) == STATUS_OK);
        CHECK(e.level[0].plain == (kind == plain_posts));
        elevation_build_pyramids(&e);
        CHECK(kind != plain_posts || (e.level[0].pyramid_shift == 0 && e.level[0].rise_shift == 0));
        check_pyramid(&e.level[0]);
        elevation_destroy(&e);
        free(post);
    }
}

/* Each post as near as its tiles' units allow, equal in all tiles that share it, repeated beyond the last; and the same
 * post by post as row by row. */
static void tiles_share_their_edges(void **state)
{
    (void)state;
    enum { nx = 263, ny = 200 };
    for (int kind = 0; kind < post_kinds; kind++) {
        Elevation e = {0};
        CHECK(elevation_level_create(&e, 0, &(ElevationGrid){nx, ny, 0, 0, 1, 0, 1}) == STATUS_OK);
        ElevationLevel *level = &e.level[0];
        int32_t        *post = some_posts(kind, 7, nx, ny);
        int             coarse = 0, mixed = 0;
        CHECK(elevation_fill(level, post) == STATUS_OK);
        for (int tj = 0; tj < level->tiles_y; tj++)
            for (int ti = 0; ti < level->tiles_x; ti++) {
                const size_t        t = (size_t)(tj * level->tiles_x + ti);
                const ElevationTile tile = level->tile[t];
                CHECK(tile.base % elevation_base_unit == 0 && tile.shift >= 0 && tile.shift <= elevation_most_shift);
                coarse += tile.shift > 0;
                mixed += t > 0 && tile.shift != level->tile[t - 1].shift;
                for (int n = 0; n < elevation_tile_posts; n++) {
                    int i = ti * elevation_tile_cells + n % elevation_tile_side;
                    int j = tj * elevation_tile_cells + n / elevation_tile_side;
                    i = i < nx ? i : nx - 1, j = j < ny ? j : ny - 1;
                    const uint16_t own = level->stored[t * elevation_tile_posts + (size_t)n];
                    const int32_t  held = tile.base + (own << tile.shift);
                    CHECK(held == elevation_post(level, i, j));
                    int unit = 1;
                    for (int k = 0; k < 9; k++) { /* the coarsest of the tiles within a post of it */
                        const int a = (i + k % 3 - 1) / elevation_tile_cells;
                        const int b = (j + k / 3 - 1) / elevation_tile_cells;
                        if (i + k % 3 < 1 || j + k / 3 < 1 || a >= level->tiles_x || b >= level->tiles_y) continue;
                        const int  near = 1 << level->tile[b * level->tiles_x + a].shift;
                        const bool shares = (i % elevation_tile_cells == 0 || a == i / elevation_tile_cells) &&
                                            (j % elevation_tile_cells == 0 || b == j / elevation_tile_cells);
                        if (shares && near > unit) unit = near;
                    }
                    CHECK(2 * abs(held - post[j * nx + i]) <= unit);
                }
            }
        CHECK((coarse > 0) == (kind != plain_posts) && (mixed > 0) == (kind == rough_posts));
        uint16_t *stored = malloc(elevation_level_stored(level) * sizeof *stored);
        CHECK(stored);
        memcpy(stored, level->stored, elevation_level_stored(level) * sizeof *stored);
        memset(level->stored, 0xff, elevation_level_stored(level) * sizeof *stored);
        for (int j = 0; j < ny; j++)
            for (int i = 0; i < nx; i++) elevation_set_post(level, i, j, post[j * nx + i]);
        elevation_fill_edges(level);
        CHECK(memcmp(stored, level->stored, elevation_level_stored(level) * sizeof *stored) == 0);
        post[5] = elevation_highest_post + 1;
        CHECK(elevation_fill(level, post) == STATUS_BAD_VALUE);
        elevation_destroy(&e);
        free(stored);
        free(post);
    }
}

/* Arrays of a mapped file are neither freed nor written. */
static void borrowed_arrays_are_left_alone(void **state)
{
    (void)state;
    static uint16_t      stored[elevation_tile_posts], top[1] = {41};
    static ElevationTile tile[1] = {{-1024, 1}};
    Elevation            e = {.level_count = 1};
    CHECK(elevation_level_describe(&e.level[0], &(ElevationGrid){3, 3, 0, 0, 1, 0, 1}) == STATUS_OK);
    ElevationLevel *level = &e.level[0];
    level->borrowed = true, level->plain = false;
    level->tile = tile, level->stored = stored, level->pyramid[elevation_pyramid_first] = top;
    CHECK(level->tiles_x == 1 && level->tiles_y == 1 && level->pyramid_count == elevation_pyramid_first + 1);
    stored[1] = 512;
    elevation_build_pyramids(&e);
    CHECK(top[0] == 41);
    CHECK_NEAR(elevation_height(&e, 1, 0, NULL), 0, 0);
    CHECK_NEAR(elevation_height(&e, 0, 0, NULL), -1024, 0);
    elevation_destroy(&e);
    CHECK(stored[1] == 512 && tile[0].base == -1024 && e.level_count == 0);
}

/* 12 x 16 km of posts 1 m apart: pyramid and rises of at most 100 MB, and indices of posts in 31 bits. */
static void large_levels_have_small_pyramids(void **state)
{
    (void)state;
    ElevationLevel level;
    double         octets = 0;
    CHECK(elevation_level_describe(&level, &(ElevationGrid){12001, 16001, 0, 0, 1, 0, 1}) == STATUS_OK);
    for (int k = 0; k < level.pyramid_count; k++) {
        const double nodes = (double)level.pyramid_nx[k] * level.pyramid_ny[k];
        if (k >= elevation_pyramid_first) octets += nodes * sizeof **level.pyramid;
        if (k >= elevation_rise_level) octets += nodes * sizeof **level.rise;
    }
    CHECK(octets > 0 && octets <= 100e6);
    CHECK(elevation_level_describe(&level, &(ElevationGrid){40001, 50001, 0, 0, 1, 0, 1}) == STATUS_OK);
    CHECK(elevation_level_stored(&level) <= INT32_MAX);
}

static void bad_sizes_are_refused(void **state)
{
    (void)state;
    Elevation e = {0};
    CHECK(elevation_level_create(&e, 0, &(ElevationGrid){1, 5, 0, 0, 1, 0, 1}) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, elevation_max_levels, &(ElevationGrid){5, 5, 0, 0, 1, 0, 1}) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, -1, &(ElevationGrid){5, 5, 0, 0, 1, 0, 1}) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, 0, &(ElevationGrid){5, 65537, 0, 0, 1, 0, 1}) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, 0, &(ElevationGrid){65536, 65536, 0, 0, 1, 0, 1}) ==
          STATUS_BAD_VALUE); /* more than indices reach */
    CHECK(elevation_level_create(&e, 0, &(ElevationGrid){5, 5, NAN, 0, 1, 0, 1}) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, 0, &(ElevationGrid){5, 5, 0, 0, 0, 0, 1}) == STATUS_BAD_VALUE);
    CHECK(elevation_level_create(&e, 0, &(ElevationGrid){5, 5, 0, 0, 1, 0, -1}) == STATUS_BAD_VALUE);
    CHECK(e.level_count == 0 && !e.level[0].stored);
    /* the longest side still fits the pyramid */
    CHECK(elevation_level_create(&e, 0, &(ElevationGrid){65536, 2, 0, 0, 1, 0, 1}) == STATUS_OK);
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
        cmocka_unit_test(one_cell_is_two_triangles),
        cmocka_unit_test(the_inner_level_wins),
        cmocka_unit_test(pyramids_are_maxima),
        cmocka_unit_test(tiles_share_their_edges),
        cmocka_unit_test(borrowed_arrays_are_left_alone),
        cmocka_unit_test(large_levels_have_small_pyramids),
        cmocka_unit_test(bad_sizes_are_refused),
        cmocka_unit_test(every_surface_is_made_of_something),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
