/* Classes of remembered squares of ground: those of the places, whatever was asked before; and squares that bounds
 * prove to be of one class are, at a dense grid of places, and are most of the ground. */
#include "tests/check.h"

#include "terrain/ground/landscape_private.h"
#include "terrain/ground/surface_cells.h"
#include "terrain/invented/uniform.h"

enum { side = 13, dense = side * side, squares = 2500 };
static const double cell_m = 4;
static Landscape    land;

static int make_land(void **state)
{
    (void)state;
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    config.seed = 5;
    config.half_width_m = 1500;
    config.horizon_m = 30000;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    return landscape_create(&land, &config, &frame, NULL, 0, NULL, 0) == STATUS_OK ? 0 : -1;
}

static int drop_land(void **state)
{
    (void)state;
    landscape_destroy(&land);
    return 0;
}

/* South-west corner of square n: within the finest level, on its seam, or far out. */
static void corner_of(double corner_m[2], int n)
{
    const double half_m = n % 8 == 7 ? 30000 : n % 8 == 6 ? 1600 : 1480;
    for (int c = 0; c < 2; c++)
        corner_m[c] = cell_m * floor(half_m / cell_m * (2 * random_uniform(21, (uint32_t)c, 0, (uint64_t)n) - 1));
    if (n % 8 == 6) corner_m[n / 8 % 2] = (n / 16 % 2 ? 1 : -1) * (1500 - cell_m * (n / 32 % 6));
}

/* Places all over a square, and on its edges. */
static void fill_square(double x_m[dense], double y_m[dense], const double corner_m[2])
{
    const double last = 1 - 1e-12;
    for (int k = 0; k < dense; k++) {
        x_m[k] = corner_m[0] + cell_m * last * (k % side) / (side - 1);
        y_m[k] = corner_m[1] + cell_m * last * (k / side) / (side - 1);
    }
}

static void proven_squares_are_of_one_class(void **state)
{
    const Cover *cover = land.cover;
    int          proven = 0, alike = 0;
    (void)state;
    for (int n = 0; n < squares; n++) {
        double  corner_m[2], x_m[dense], y_m[dense];
        uint8_t want[dense];
        corner_of(corner_m, n);
        fill_square(x_m, y_m, corner_m);
        landscape_surfaces(want, &land, dense, x_m, y_m);
        const bool one = memcmp(want, want + 1, dense - 1) == 0;
        const bool said =
            invented_uniform(&cover->invented, &land.elevation, &(UniformSquare){corner_m[0], corner_m[1], cell_m});
        CHECK(one || !said);
        alike += one, proven += said;
    }
    print_message("%d of %d squares proven, %d alike\n", proven, (int)squares, alike);
    CHECK(proven > 0.6 * alike && alike > 0.5 * squares);
}

static void remembered_classes_are_those_of_the_places(void **state)
{
    SurfaceCells *cells = surface_cells_create(&land), *other = surface_cells_create(&land);
    Landscape     copy = land;
    (void)state;
    assert_non_null(cells);
    assert_non_null(other);
    for (int n = 0; n < squares; n++) {
        double  corner_m[2], x_m[dense], y_m[dense];
        uint8_t want[dense], got[dense];
        corner_of(corner_m, n / 2); /* each twice: before and after it is remembered */
        fill_square(x_m, y_m, corner_m);
        if (n % 16 == 3) x_m[5] = NAN, y_m[20] = INFINITY, x_m[dense - 1] = -1e300;
        landscape_surfaces(want, &land, dense, x_m, y_m);
        surface_cells_at(got, cells, &land, dense, x_m, y_m);
        assert_memory_equal(got, want, sizeof got);
        surface_cells_at(got, other, &copy, dense, x_m, y_m); /* not its landscape: nothing is remembered */
        assert_memory_equal(got, want, sizeof got);
        surface_cells_at(got, NULL, &land, 3, x_m, y_m);
        assert_memory_equal(got, want, 3);
    }
    surface_cells_destroy(other);
    surface_cells_destroy(cells);
}

/* Squares that share an entry of the table, in turns. */
static void far_squares_do_not_answer_for_each_other(void **state)
{
    SurfaceCells *cells = surface_cells_create(&land);
    (void)state;
    assert_non_null(cells);
    for (int n = 0; n < 400; n++)
        for (int turn = 0; turn < 3; turn++) {
            const double apart_m[] = {0, 512 * cell_m, -512 * cell_m};
            double       corner_m[2], x_m[dense], y_m[dense];
            uint8_t      want[dense], got[dense];
            corner_of(corner_m, n);
            corner_m[0] += apart_m[turn];
            fill_square(x_m, y_m, corner_m);
            landscape_surfaces(want, &land, dense, x_m, y_m);
            surface_cells_at(got, cells, &land, dense, x_m, y_m);
            assert_memory_equal(got, want, sizeof got);
        }
    surface_cells_destroy(cells);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(proven_squares_are_of_one_class),
        cmocka_unit_test(remembered_classes_are_those_of_the_places),
        cmocka_unit_test(far_squares_do_not_answer_for_each_other),
    };
    return cmocka_run_group_tests(tests, make_land, drop_land);
}
