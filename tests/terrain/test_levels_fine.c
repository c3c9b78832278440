/* Heights from files in steps of 1/2048 m: how far posts are from them, and seams to the bit over tiles of any shift.
 * labels: physics */
#include "tests/check.h"

#include "terrain/elevation/levels.h"

enum { levels = 3, cells = 160 };

/* Relief of `steep` metres from post to post in some tiles, of 2 m in the others, on a slope. */
static float height(int k, int i, int j, double steep_m)
{
    const double at = random_uniform(31, (uint32_t)k, (uint32_t)(j + 4096), (uint64_t)(i + 4096));
    const bool   rough = ((i + 8192) / 40 + (j + 8192) / 56) % 3 == 0;
    return (float)(200 + 0.01 * i + (rough ? steep_m : fmin(steep_m, 2)) * at);
}

static void make_levels(WorkLevel *level, double steep_m)
{
    for (int k = 0; k < levels; k++) {
        level[k] = (WorkLevel){.hole_i1 = -1, .outermost = k == levels - 1};
        assert_int_equal(
            levels_field_create(&level[k].z, 1 << (3 * k), -80, -80 - 8 * k, cells + 1, cells + 1 - 16 * (k == 1)),
            STATUS_OK);
        const Field *z = &level[k].z, *in = &level[k - (k > 0)].z;
        for (int j = 0; j < z->ny; j++)
            for (int i = 0; i < z->nx; i++) z->v[j * z->nx + i] = height(k, z->i0 + i, z->j0 + j, steep_m);
        if (k == 0) continue;
        level[k].hole_i0 = in->i0 / level_ratio, level[k].hole_i1 = (in->i0 + in->nx - 1) / level_ratio;
        level[k].hole_j0 = in->j0 / level_ratio, level[k].hole_j1 = (in->j0 + in->ny - 1) / level_ratio;
    }
    for (int k = levels - 2; k >= 0; k--) levels_join(&level[k], &level[k + 1], 8);
}

static void check_seams(const Elevation *ground)
{
    for (int k = 0; k + 1 < levels; k++) {
        const ElevationLevel *in = &ground->level[k];
        const Elevation       around = {.level_count = 1, .level = {ground->level[k + 1]}};
        for (int j = 0; j < in->ny; j++)
            for (int i = 0; i < in->nx; i++) {
                if (j > 0 && j < in->ny - 1 && i > 0) i = in->nx - 1;
                CHECK(elevation_post_m(in, i, j) ==
                      elevation_height(&around, in->x0_m + i * in->spacing_m, in->y0_m + j * in->spacing_m, NULL));
            }
    }
}

static void posts_are_near_and_seams_exact(void **state)
{
    (void)state;
    /* half a step of the heights and half a unit of the tile */
    static const double steep_m[] = {1, 85, 110, 400, 4000}, worst_m[] = {0.25e-3, 1.25e-3, 1.25e-3, 4.2e-3, 32e-3};
    for (int n = 0; n < 5; n++) {
        WorkLevel level[levels];
        Elevation ground;
        int       shifts = 0, plain = 0;
        double    off_m = 0;
        make_levels(level, steep_m[n]);
        assert_int_equal(levels_store_fine(&ground, level, levels), STATUS_OK);
        for (int k = 0; k < levels; k++) {
            const ElevationLevel *l = &ground.level[k];
            const Field          *z = &level[k].z;
            CHECK(l->step_m == 1.0 / 2048);
            plain += l->plain;
            for (int t = 0; t < l->tiles_x * l->tiles_y; t++) shifts |= 1 << l->tile[t].shift;
            for (int j = 1; j < l->ny - 1; j++)
                for (int i = 1; i < l->nx - 1; i++) {
                    const int at_i = z->i0 + i, at_j = z->j0 + j;
                    if (at_i >= level[k].hole_i0 && at_i <= level[k].hole_i1 && at_j >= level[k].hole_j0 &&
                        at_j <= level[k].hole_j1)
                        continue;
                    off_m = fmax(off_m, fabs(elevation_post_m(l, i, j) - (double)z->v[j * z->nx + i]));
                }
        }
        CHECK(off_m <= worst_m[n] && off_m > 0.9 * worst_m[n]);
        CHECK(plain == (n == 0 ? levels : 0));
        CHECK(((shifts & (shifts - 1)) != 0) == (n > 0)); /* more than one shift from where relief needs it */
        check_seams(&ground);
        elevation_destroy(&ground);
        for (int k = 0; k < levels; k++) levels_field_destroy(&level[k].z);
    }
}

/* A peak of 4 km in the first tile of the finest level: posts of the seam beside other tiles stay as near to their
 * heights as without it, those beside it come within the peak's unit. */
static void a_peak_moves_only_the_seam_beside_it(void **state)
{
    (void)state;
    WorkLevel level[levels];
    Elevation ground;
    double    beside_m = 0, elsewhere_m = 0;
    int       posts = 0;
    make_levels(level, 1);
    const Field *fine = &level[0].z, *z = &level[1].z;
    for (int j = 12; j < 30; j++)
        for (int i = 12; i < 30; i++) fine->v[j * fine->nx + i] += 4000;
    assert_int_equal(levels_store_fine(&ground, level, levels), STATUS_OK);
    check_seams(&ground);
    CHECK(ground.level[0].tile[0].shift == 7 && ground.level[0].tile[1].shift == 0); /* 32 m << 7 hold 4 km */
    for (int j = level[1].hole_j0; j <= level[1].hole_j1; j++)
        for (int i = level[1].hole_i0; i <= level[1].hole_i1; i++) {
            const bool rim =
                i == level[1].hole_i0 || i == level[1].hole_i1 || j == level[1].hole_j0 || j == level[1].hole_j1;
            const int    at_i = i - z->i0, at_j = j - z->j0;
            const double off_m =
                fabs(elevation_post_m(&ground.level[1], at_i, at_j) - (double)z->v[at_j * z->nx + at_i]);
            const int  in_i = level_ratio * (i - level[1].hole_i0), in_j = level_ratio * (j - level[1].hole_j0);
            const bool beside =
                in_i <= elevation_tile_cells + level_ratio && in_j <= elevation_tile_cells + level_ratio;
            if (!rim) continue;
            posts += !beside;
            if (beside) beside_m = fmax(beside_m, off_m);
            else elsewhere_m = fmax(elsewhere_m, off_m);
        }
    print_message("seam: %.4f m beside the peak, %.4f m elsewhere (%d posts)\n", beside_m, elsewhere_m, posts);
    CHECK(posts > 40 && elsewhere_m <= 8.5 / 2048);                       /* eight steps, rounded down */
    CHECK(beside_m > 0.05 && beside_m <= (8 << 7) / 2048.0 + 1.0 / 2048); /* eight units of the peak's tile */
    elevation_destroy(&ground);
    for (int k = 0; k < levels; k++) levels_field_destroy(&level[k].z);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(posts_are_near_and_seams_exact),
                                       cmocka_unit_test(a_peak_moves_only_the_seam_beside_it)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
