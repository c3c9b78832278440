/* Lengths of rays in crowns against a march through them, and each crown found once. labels: physics */
#include "tests/check.h"
#include "tests/render/hand_plants.h"

#include "render/scattering/clutter/foliage_fan.h"

enum { plants = 3000, side = 5 }; /* squares of the woods */

static Plant        plant[plants];
static Woods        woods;
static ClutterTable table;
static Foliage     *foliage;
static const double origin[3] = {100, -50, 7};

static int set_up(void **state)
{
    (void)state;
    char path[4096];
    hand_grow(true, 0.1);
    woods = hand_stand(plant, plants, origin, 0.5 * side * woods_square_m);
    for (int i = 0; i < plants; i++)
        for (int k = 0; k < 2; k++) plant[i].p_m[k] += (float)(0.5 * side * woods_square_m);
    woods.nx = woods.ny = side;
    static uint8_t bare[side * side] = {1}; /* one corner's trees were left out */
    woods.bare = bare;
    return etc_path(path, sizeof path, "radar/clutter.csv") && clutter_table_open(&table, path) == STATUS_OK &&
                   foliage_create(&foliage, &woods, &hand_plants, &table, CLUTTER_KA) == STATUS_OK
               ? 0
               : -1;
}

static int tear_down(void **state)
{
    (void)state;
    foliage_destroy(foliage);
    return 0;
}

/* The crown of a plant as foliage.h says it, from the plant itself. */
static bool within(const Plant *p, const double at_m[3])
{
    double axis[3][3], scale[2], away[3];
    plant_axes(axis, scale, p, NULL);
    for (int k = 0; k < 3; k++)
        away[k] = at_m[k] - (double)p->p_m[k] - 0.7 * scale[1] * axis[2][k]; /* crowns from 0.4 to 1 */
    const double across = hypot(away[0], away[1]) / (0.28 * scale[0]), up = away[2] / (0.3 * scale[1]);
    return across * across + up * up < 1;
}

static double march(double *db, const double o[3], const double d[3], double range_m)
{
    static const double step_m = 0.02;
    double              depth = 0, weighted = 0;
    static int          near[plants];
    int                 count = 0;
    for (int i = 0; i < plants; i++) { /* those whose trunk is within 12 m of the line */
        double to[3], off[3];
        for (int k = 0; k < 3; k++) to[k] = origin[k] + (double)plant[i].p_m[k] + (k == 2 ? 6 : 0) - o[k];
        v3_cross(off, to, d);
        if (v3_length(off) < 16) near[count++] = i; /* 6 m and more of its own height */
    }
    for (double s = 0.5 * step_m; s < range_m; s += step_m) {
        double p[3];
        for (int k = 0; k < 3; k++) p[k] = o[k] + s * d[k] - origin[k];
        if (p[2] < -1 || p[2] > 22) continue;
        for (int n = 0; n < count; n++) {
            const Plant *of = &plant[near[n]];
            if (hypot(p[0] - (double)of->p_m[0], p[1] - (double)of->p_m[1]) > 12 || !within(of, p)) continue;
            const SurfaceClass class = of->kind == PLANT_PINE   ? SURFACE_FOREST_CONIFER
                                       : of->kind < PLANT_TREES ? SURFACE_FOREST_BROADLEAF
                                                                : SURFACE_SCRUB;
            depth += step_m;
            weighted += step_m * table.row[class][CLUTTER_KA].foliage_db_m;
        }
    }
    *db = depth > 14 ? weighted * 14 / depth * pow(depth / 14, 0.588) : weighted;
    return depth;
}

static void lengths_are_those_of_a_march(void **state)
{
    (void)state;
    double worst_m = 0, worst_db = 0, sum_m = 0;
    int    deep = 0;
    enum { rays = 60 };
    for (uint64_t i = 0; i < rays; i++) {
        double o[3], d[3], to[3], got_m, want_db;
        for (uint32_t k = 0; k < 2; k++) {
            o[k] =
                origin[k] + 320 * random_uniform(9, k, 0, i) + (i % 3 ? 0 : 400 * (k ? 1 : -1)); /* some from without */
            to[k] = origin[k] + 320 * random_uniform(9, 4 + k, 0, i);
        }
        if (i % 7 == 0) o[0] = to[0]; /* along a row of squares */
        o[2] = origin[2] + (i % 2 ? 60 : 4), to[2] = origin[2] + 12 * random_uniform(9, 8, 0, i);
        v3_sub(d, to, o);
        const double range_m = v3_length(d);
        v3_scale(d, 1 / range_m, d);
        const double got_db = foliage_loss_db(&got_m, foliage, o, d, range_m), want_m = march(&want_db, o, d, range_m);
        worst_m = fmax(worst_m, fabs(got_m - want_m) / (1 + 0.02 * want_m));
        worst_db = fmax(worst_db, fabs(got_db - want_db) / (1 + 0.02 * want_m));
        sum_m += want_m;
        deep += want_m > 14;
    }
    printf("%d rays, %.0f m of foliage: lengths within %.3f m, losses %.3f dB\n", rays, sum_m, worst_m, worst_db);
    /* a march misses half a step at either end of each crown, 15 of which make 50 m */
    CHECK(worst_m < 0.06 && worst_db < 0.08 && deep > 10 && sum_m > 300);
}

static void rays_above_lose_nothing(void **state)
{
    (void)state;
    double depth_m;
    CHECK(foliage_loss_db(&depth_m, foliage, (const double[3]){0, 0, 100}, (const double[3]){0.8, 0.6, 0}, 500) == 0 &&
          depth_m == 0);
    CHECK(foliage_loss_db(NULL, foliage, (const double[3]){-900, 0, 10}, (const double[3]){-1, 0, 0}, 500) == 0);
    CHECK(foliage_loss_db(NULL, foliage, (const double[3]){200, 0, 100}, (const double[3]){0, 0, -1}, 30) == 0);
}

/* A direction within the cone of half, or twice as wide. */
static void direction_in(double d[3], const FoliageFanOf *of, double half, uint64_t i)
{
    const double right = half * (2 * random_uniform(3, 0, 0, i) - 1),
                 down = half * (2 * random_uniform(3, 1, 0, i) - 1);
    for (int k = 0; k < 3; k++) d[k] = of->axis[2][k] + right * of->axis[0][k] + down * of->axis[1][k];
    v3_normalize(d, d);
}

/* A fan lists crowns by direction; rays of it lose what they lose without it, to the bit: from afar, from within the
 * woods, from above, rolled, in wide cones and narrow ones, also where they leave the cone. */
static void a_fan_changes_no_bit(void **state)
{
    (void)state;
    static const struct {
        double from_m[3], azimuth, down, roll, half, far_m;
    } fans[] = {{{-700, 120, 70}, 90, 5, 0, 0.08, 1100},
                {{-700, 120, 70}, 90, 5, 0, 0.3, 1100},
                {{160, 160, 9}, 200, 2, 30, 0.5, 300}, /* among the crowns */
                {{160, 160, 120}, 10, 70, -45, 0.4, 200},
                {{330, -40, 25}, 320, 10, 0, 1, 500}};
    Arena *arena = arena_create();
    CHECK(arena);
    for (size_t n = 0; n < sizeof fans / sizeof *fans; n++) {
        const double a = fans[n].azimuth * rad_per_deg, e = fans[n].down * rad_per_deg, r = fans[n].roll * rad_per_deg;
        const double level[3] = {cos(a), -sin(a), 0}, ahead[3] = {sin(a) * cos(e), cos(a) * cos(e), -sin(e)};
        double       below[3];
        FoliageFanOf of = {.half = fans[n].half, .far_m = fans[n].far_m};
        FoliageFan  *fan;
        int          met = 0;
        v3_cross(below, ahead, level);
        for (int k = 0; k < 3; k++) {
            of.o_enu[k] = origin[k] + fans[n].from_m[k];
            of.axis[0][k] = cos(r) * level[k] + sin(r) * below[k];
            of.axis[1][k] = cos(r) * below[k] - sin(r) * level[k];
            of.axis[2][k] = ahead[k];
        }
        foliage_fan_create(&fan, foliage, &of, arena);
        CHECK(fan && foliage_fan_is_from(fan, of.o_enu) && !foliage_fan_is_from(fan, origin));
        for (uint64_t i = 0; i < 4000; i++) {
            double d[3];
            direction_in(d, &of, (i % 10 == 0 ? 2 : 1) * of.half, i);
            const double range_m = (i % 17 == 0 ? 1.1 : 1) * of.far_m * (0.5 + 0.5 * random_uniform(3, 2, 0, i));
            const double got = foliage_fan_loss_db(fan, d, range_m);
            const double want = foliage_loss_db(NULL, foliage, of.o_enu, d, range_m);
            CHECK(memcmp(&got, &want, sizeof got) == 0);
            met += want > 0;
        }
        printf("fan %zu: %d rays of 4000 meet foliage\n", n, met);
        CHECK(met > 50);
        arena_reset(arena);
    }
    arena_destroy(arena);
    CHECK(!foliage_fan_is_from(NULL, origin));
}

static void every_crown_is_found_once(void **state)
{
    (void)state;
    static int index[plants], seen[plants];
    int        all = 0;
    for (int part = 0; part < 9; part++) {
        const double third = 320.0 / 3, low[2] = {origin[0] + part % 3 * third, origin[1] + part / 3 * third};
        const double l[2] = {part % 3 ? low[0] : -INFINITY, part / 3 ? low[1] : -INFINITY};
        const double h[2] = {part % 3 < 2 ? low[0] + third : INFINITY, part / 3 < 2 ? low[1] + third : INFINITY};
        const int    count = foliage_in(index, plants, foliage, l, h);
        for (int i = 0; i < count; i++) seen[index[i]]++;
        all += count;
        CHECK(foliage_in(NULL, 0, foliage, l, h) == count);
    }
    CHECK(all == plants && foliage_count(foliage) == plants);
    for (int i = 0; i < plants; i++) CHECK(seen[i] == 1);
    CHECK(foliage_reaches(foliage, origin[0] + 160, origin[1] + 160) &&
          !foliage_reaches(foliage, origin[0] - 1, origin[1] + 160) &&
          !foliage_reaches(foliage, origin[0] + 1, origin[1] + 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_are_those_of_a_march),
        cmocka_unit_test(rays_above_lose_nothing),
        cmocka_unit_test(a_fan_changes_no_bit),
        cmocka_unit_test(every_crown_is_found_once),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
