/* Bundles that are said to meet no ground: none of their rays may, as ground_first_hit finds it (test_ground.c judges
 * that); and it must be said of most that stand well over it. labels: physics */
#include "tests/check.h"

#include "render/trace/ground/ground.h"

static uint64_t draw_count;

static double uniform(double low, double high)
{
    return low + (high - low) * random_uniform(20261121, 9, 0, draw_count++);
}

typedef double Country(double x_m, double y_m);

static double downs(double x_m, double y_m) { return 60 + 8 * sin(x_m / 91) + 5 * cos(y_m / 53); }

static double walls(double x_m, double y_m)
{
    return 20 + 30 * floor(fabs(fmod(x_m, 64)) / 32) + 10 * floor(fabs(fmod(x_m - y_m, 48)) / 24) + 0.01 * y_m;
}

static double spikes(double x_m, double y_m) { return lround(x_m) % 23 == 0 && lround(y_m) % 19 == 0 ? 90 : 40; }

static void add_level(Elevation *e, int index, int nx, int ny, double x0_m, double y0_m, double spacing_m,
                      Country *country)
{
    CHECK(elevation_level_create(e, index, &(ElevationGrid){nx, ny, x0_m, y0_m, spacing_m, -20, 1.0 / 128}) ==
          STATUS_OK);
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++)
            elevation_set_post(&e->level[index], i, j,
                               (uint16_t)(128 * (country(x0_m + i * spacing_m, y0_m + j * spacing_m) + 20)));
}

static void make_country(Elevation *e, Country *country, bool nested)
{
    *e = (Elevation){0};
    add_level(e, 0, 161, 241, -80, -120, 1, country);
    if (nested) add_level(e, 1, 101, 121, -200, -240, 4, country);
    elevation_build_pyramids(e);
}

static void place_in(double p[3], const double box[2][3])
{
    for (int c = 0; c < 3; c++)
        p[c] = box[0][c] + (box[1][c] - box[0][c]) * floor(uniform(0, 5)) / 4; /* corners, too */
}

/* Of so many bundles those said to be clear; not one of their rays meets anything. A third goes on for good. */
static int clear_bundles(const Ground *ground, const Elevation *e, int bundles, double least_m, double most_m,
                         double climb)
{
    int clear = 0;
    for (int n = 0; n < bundles; n++) {
        const bool on = n % 3 == 0;
        double     box[2][3], to[2][3], way[3] = {uniform(-1, 1), uniform(-1, 1), uniform(climb, climb + 1)};
        CHECK(v3_normalize(way, way));
        for (int c = 0; c < 2; c++) {
            box[0][c] = uniform(-90, 90), box[1][c] = box[0][c] + uniform(0, 1.5);
            to[0][c] = box[0][c] + uniform(-60, 60), to[1][c] = to[0][c] + uniform(0, 0.5);
        }
        const double z_m = elevation_height(e, box[0][0], box[0][1], NULL);
        box[0][2] = (isnan(z_m) ? 40 : z_m) + uniform(least_m, most_m), box[1][2] = box[0][2] + uniform(0, 1);
        to[0][2] = box[0][2] + uniform(-3, 20), to[1][2] = to[0][2] + uniform(0, 0.5);
        if (!(on ? ground_is_clear_towards(ground, box, way) : ground_is_clear(ground, box, to))) continue;
        clear++;
        for (int k = 0; k < 40; k++) {
            double a[3], b[3], d[3], far_m = INFINITY;
            place_in(a, box);
            if (on) {
                memcpy(d, way, sizeof d);
            } else {
                place_in(b, to);
                v3_sub(d, b, a);
                far_m = v3_length(d);
                if (!v3_normalize(d, d)) continue;
            }
            CHECK(!(ground_first_hit(NULL, ground, a, d, far_m) < INFINITY));
        }
    }
    return clear;
}

static void clear_is_clear(void **state)
{
    static Country *const countries[] = {downs, walls, spikes};
    (void)state;
    for (int c = 0; c < 6; c++) {
        Elevation e;
        Ground    ground;
        make_country(&e, countries[c % 3], c >= 3);
        ground_prepare(&ground, &e);
        const int some = clear_bundles(&ground, &e, 3000, -1, 6, -0.2);
        CHECK(some > 100 && some < 2900); /* it is asked of both kinds */
        /* 1 m over slopes of a tenth, the most of downs, and up by half and more */
        if (c % 3 == 0) {
            const int high = clear_bundles(&ground, &e, 900, 1, 3, 0.7);
            print_message("downs: %d of 900 from 1 .. 3 m up are known to be clear\n", high);
            CHECK(high > 300);
        }
        elevation_destroy(&e);
    }
    Ground none;
    ground_prepare(&none, NULL);
    CHECK(ground_is_clear_towards(&none, (const double[2][3]){{0, 0, 0}, {1, 1, 1}}, (const double[3]){0, 0, -1}));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(clear_is_clear)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
