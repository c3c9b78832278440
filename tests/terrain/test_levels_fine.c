/* Heights from files in steps of 1/2048 m: how far posts are from them, and seams to the bit over tiles of any shift.
 * labels: physics */
#include "tests/check.h"

#include "terrain/landscape/work_level.h"

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
            field_create(&level[k].z, 1 << (3 * k), -80, -80 - 8 * k, cells + 1, cells + 1 - 16 * (k == 1)), STATUS_OK);
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
        for (int k = 0; k < levels; k++) field_destroy(&level[k].z);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(posts_are_near_and_seams_exact)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
