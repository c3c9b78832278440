/* A surface model taken apart, on sites whose ground, roofs and trees are known because the test made them. */
#include "tests/check.h"

#include "terrain/bare_earth/take_apart.h"

#include <stdlib.h>

typedef struct Site {
    int          nx, ny;
    double       cell_m;
    float       *surface_m, *truth_m;
    uint8_t     *kind;
    SurfaceParts parts;
} Site;

typedef float GroundShape(double x_m, double y_m);

static Site site_make(int nx, int ny, double cell_m, GroundShape *ground)
{
    const size_t n = (size_t)nx * (size_t)ny;
    Site         s = {.nx = nx,
                      .ny = ny,
                      .cell_m = cell_m,
                      .surface_m = malloc(n * 4),
                      .truth_m = malloc(n * 4),
                      .kind = calloc(n, 1),
                      .parts = {.bare_m = malloc(n * 4), .roof_m = malloc(n * 4), .kind = malloc(n)}};
    for (size_t c = 0; c < n; c++) {
        const double x = ((double)(c % (size_t)nx) + 0.5) * cell_m, y = ((double)(c / (size_t)nx) + 0.5) * cell_m;
        s.truth_m[c] = ground(x, y);
        s.surface_m[c] = s.truth_m[c] + 0.03F * (float)random_uniform(3, 1, 0, c);
    }
    return s;
}

static void site_free(Site *s)
{
    free(s->surface_m), free(s->truth_m), free(s->kind);
    free(s->parts.bare_m), free(s->parts.roof_m), free(s->parts.kind), free(s->parts.crown);
}

static void site_run(Site *s)
{
    const SurfaceModel model = {.nx = s->nx, .ny = s->ny, .cell_m = s->cell_m, .surface_m = s->surface_m};
    CHECK(take_apart_surface(&s->parts, &model) == STATUS_OK);
}

/* A round crown with leaves of rough height. */
static void add_tree(Site *s, double x_m, double y_m, double height_m, double radius_m)
{
    const int r = (int)(radius_m / s->cell_m) + 1, i0 = (int)(x_m / s->cell_m), j0 = (int)(y_m / s->cell_m);
    for (int j = j0 - r; j <= j0 + r; j++)
        for (int i = i0 - r; i <= i0 + r; i++) {
            if (i < 0 || j < 0 || i >= s->nx || j >= s->ny) continue;
            const size_t c = (size_t)j * (size_t)s->nx + (size_t)i;
            const double d = hypot((i + 0.5) * s->cell_m - x_m, (j + 0.5) * s->cell_m - y_m) / radius_m;
            if (d >= 1) continue;
            const double h = height_m * (0.5 + 0.5 * sqrt(1 - d * d)) - 1.5 * random_uniform(5, 1, 0, c);
            if (s->truth_m[c] + (float)h > s->surface_m[c]) s->surface_m[c] = s->truth_m[c] + (float)h;
            s->kind[c] = CELL_TREE;
        }
}

/* A roof above the ground at its middle; pitch 0: flat. The ridge runs east. */
static void add_house(Site *s, double x_m, double y_m, double long_m, double wide_m, double eaves_m, double pitch)
{
    const int   cx = (int)(x_m / s->cell_m), cy = (int)(y_m / s->cell_m);
    const float base = s->truth_m[(size_t)cy * (size_t)s->nx + (size_t)cx];
    for (int j = 0; j < s->ny; j++)
        for (int i = 0; i < s->nx; i++) {
            const double u = fabs((i + 0.5) * s->cell_m - x_m), v = fabs((j + 0.5) * s->cell_m - y_m);
            if (u > long_m / 2 || v > wide_m / 2) continue;
            const size_t c = (size_t)j * (size_t)s->nx + (size_t)i;
            s->surface_m[c] = base + (float)(eaves_m + pitch * (wide_m / 2 - v) + 0.05 * random_uniform(6, 1, 0, c));
            s->kind[c] = CELL_BUILDING;
        }
}

/* Rms error of the ground inside a margin. */
static double ground_rms(const Site *s, int margin)
{
    double sum = 0, count = 0;
    for (int j = margin; j < s->ny - margin; j++)
        for (int i = margin; i < s->nx - margin; i++) {
            const size_t c = (size_t)j * (size_t)s->nx + (size_t)i;
            const double e = s->parts.bare_m[c] - s->truth_m[c];
            sum += e * e, count++;
        }
    return sqrt(sum / count);
}

/* Share of the cells of a kind that are found, and of those found that are of the kind. */
static void rates(double *recall, double *precision, const Site *s, int kind)
{
    double both = 0, want = 0, got = 0;
    for (size_t c = 0; c < (size_t)s->nx * (size_t)s->ny; c++) {
        both += s->kind[c] == kind && s->parts.kind[c] == kind;
        want += s->kind[c] == kind, got += s->parts.kind[c] == kind;
    }
    *recall = both / want, *precision = got > 0 ? both / got : 0;
}

static float level(double x_m, double y_m) { return 50 + 0 * (float)(x_m + y_m); }
static float gentle(double x_m, double y_m) { return (float)(100 + 0.05 * x_m + 4 * sin(y_m / 60)); }
static float hills(double x_m, double y_m) { return (float)(200 + 30 * sin(x_m / 45) * cos(y_m / 60)); } /* 34 deg */
static float slope(double x_m, double y_m) { return (float)(300 + 0.6 * x_m + 0 * y_m); }
static float terraces(double x_m, double y_m) { return (float)(20 + 6 * floor(x_m / 60) + 0.02 * y_m); }

static void bare_hills_and_terraces_stay(void **state)
{
    (void)state;
    GroundShape *const shape[] = {level, gentle, hills, slope, terraces};
    for (int k = 0; k < 5; k++) {
        Site s = site_make(300, 300, k == 2 ? 2 : 1, shape[k]);
        site_run(&s);
        const double rms = ground_rms(&s, 10);
        size_t       objects = 0;
        for (size_t c = 0; c < 90000; c++) objects += s.parts.kind[c] != CELL_BARE;
        if (rms > 0.07 || objects > 130) print_message("shape %d: rms %.3f m, %zu cells\n", k, rms, objects);
        /* Bounds of a heuristic have no paper value. These, and those of the ground below, are half as wide again to
         * twice what these shapes give; of real lidar, with low plants and walls, the ground is within 0.34 m rms. */
        CHECK(rms < 0.07);
        CHECK(objects < 130);
        site_free(&s);
    }
}

static void houses_and_trees_are_told_apart(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double cell_m = k ? 0.5 : 1;
        const int    n = (int)(240 / cell_m);
        Site         s = site_make(n, n, cell_m, gentle);
        for (int i = 0; i < 5; i++) {
            add_house(&s, 30 + 45 * i, 60, 14, 9, 4, 0.7);
            add_house(&s, 30 + 45 * i, 180, 20, 12, 6, 0);
            for (int j = 0; j < 6; j++) add_tree(&s, 20 + 42 * i, 85 + 14 * j, 9 + 2 * j, 3 + 0.3 * j);
        }
        site_run(&s);
        double recall[3], precision[3];
        for (int kind = CELL_BUILDING; kind <= CELL_TREE; kind++) rates(&recall[kind], &precision[kind], &s, kind);
        print_message("%.1f m: ground %.3f m rms, roofs %.3f found %.3f right, trees %.3f %.3f, crowns %d of 30\n",
                      cell_m, ground_rms(&s, 0), recall[1], precision[1], recall[2], precision[2], s.parts.crown_count);
        CHECK(ground_rms(&s, 0) < 0.035);
        CHECK(recall[1] > 0.9 && precision[1] > 0.9);
        CHECK(recall[2] > 0.85 && precision[2] > 0.9);
        CHECK(s.parts.crown_count >= 28 && s.parts.crown_count <= 36);
        /* heights of roofs that were found */
        double most = 0, sum = 0, count = 0;
        for (size_t c = 0; c < (size_t)n * (size_t)n; c++) {
            if (s.kind[c] != CELL_BUILDING || s.parts.kind[c] != CELL_BUILDING) continue;
            const double e = fabs((double)s.parts.roof_m[c] - s.surface_m[c]);
            most = fmax(most, e), sum += e * e, count++;
        }
        print_message("    roofs within %.2f m, %.3f m rms\n", most, sqrt(sum / count));
        CHECK(sqrt(sum / count) < 0.3);
        site_free(&s);
    }
}

static void a_wide_roof_is_no_ground(void **state)
{
    (void)state;
    Site s = site_make(320, 320, 1, gentle);
    add_house(&s, 160, 160, 100, 100, 9, 0);
    site_run(&s);
    double recall, precision;
    rates(&recall, &precision, &s, CELL_BUILDING);
    print_message("roof 100 m wide: %.3f found, %.3f right, ground %.3f m\n", recall, precision, ground_rms(&s, 0));
    CHECK(recall > 0.95 && precision > 0.95);
    CHECK(ground_rms(&s, 0) < 0.25);
    site_free(&s);
}

/* Height of an arena over level ground by the distance from its middle: seats in two tiers with a step of 1.2 m between
 * them rise from a field 45 m in radius to 22 m, a bank of earth falls outside from 21 m. */
static double arena_m(double r_m)
{
    const double seats_m = r_m < 45 ? 0 : r_m < 84 ? 0.38 * (r_m - 45) : 16 + 0.55 * (r_m - 84);
    return fmax(0, fmin(fmin(seats_m, 22), r_m < 100 ? 22 : 21 - 0.7 * (r_m - 100)));
}

static void tiers_on_a_bank_are_no_ground(void **state)
{
    (void)state;
    Site s = site_make(400, 400, 1, level);
    for (size_t c = 0; c < 400 * 400; c++)
        s.surface_m[c] += (float)arena_m(hypot((double)(c % 400) + 0.5 - 200, (double)(c / 400) + 0.5 - 200));
    site_run(&s);
    /* what nothing tells from a bank of earth stays: the lowest 10 m of seats and bank */
    double high = 0, left = 0;
    for (size_t c = 0; c < 400 * 400; c++) {
        if (!(s.surface_m[c] - s.truth_m[c] > 12)) continue;
        high++, left += s.parts.bare_m[c] > s.surface_m[c] - 0.5F;
    }
    print_message("arena: of what is higher than 12 m %.3f is ground\n", left / high);
    CHECK(left < 0.01 * high);
    site_free(&s);
}

/* A dam of 8 m, its toe rounded, its top flat, and a knoll of 16 m and 80 m across whose top is wooded: both are
 * ground. */
static void banks_and_knolls_stay(void **state)
{
    (void)state;
    Site s = site_make(420, 300, 1, level);
    for (size_t c = 0; c < 420 * 300; c++) {
        const double x = (double)(c % 420) + 0.5, y = (double)(c / 420) + 0.5, r = hypot(x - 290, y - 150) / 40;
        const double toe_m = fmax(33 - fabs(x - 80), 0),
                     dam_m = fmin(toe_m < 6 ? toe_m * toe_m / 30 : 0.4 * (toe_m - 3), 8),
                     knoll_m = r < 1 ? 8 + 8 * cos(pi_rad * r) : 0;
        s.truth_m[c] += (float)(dam_m + knoll_m), s.surface_m[c] += (float)(dam_m + knoll_m);
    }
    for (int k = 0; k < 90; k++) {
        const double a = 2.4 * k, r = 15 * sqrt((k + 0.5) / 90);
        add_tree(&s, 290 + r * cos(a), 150 + r * sin(a), 14 + k % 5, 2.5);
    }
    site_run(&s);
    double flank[2] = {0}, kept[2] = {0};
    for (size_t c = 0; c < 420 * 300; c++) {
        const double x = (double)(c % 420) + 0.5, y = (double)(c / 420) + 0.5, r = hypot(x - 290, y - 150);
        const int    of = fabs(x - 80) > 10 && fabs(x - 80) < 33 && y > 20 && y < 280 ? 0 : r > 18 && r < 40 ? 1 : -1;
        if (of < 0 || s.kind[c] != CELL_BARE) continue;
        flank[of]++, kept[of] += fabsf(s.parts.bare_m[c] - s.truth_m[c]) < 0.3F;
    }
    print_message("flanks that are ground: of the dam %.3f, of the knoll %.3f\n", kept[0] / flank[0],
                  kept[1] / flank[1]);
    CHECK(kept[0] > 0.95 * flank[0] && kept[1] > 0.95 * flank[1]);
    site_free(&s);
}

static void a_forested_slope_keeps_its_slope(void **state)
{
    (void)state;
    Site s = site_make(240, 240, 1, slope);
    for (int i = 0; i < 2200; i++)
        add_tree(&s, 240 * random_uniform(9, 1, 0, (uint64_t)i), 240 * random_uniform(9, 2, 0, (uint64_t)i),
                 12 + 8 * random_uniform(9, 3, 0, (uint64_t)i), 2.2 + random_uniform(9, 4, 0, (uint64_t)i));
    site_run(&s);
    size_t closed = 0;
    for (size_t c = 0; c < 57600; c++) closed += s.kind[c] == CELL_TREE;
    print_message("forest %.1f %% closed: ground %.3f m rms, %.3f inside\n", (double)closed / 576, ground_rms(&s, 12),
                  ground_rms(&s, 80));
    CHECK(ground_rms(&s, 12) < 0.17);
    site_free(&s);
}

static void overlapping_windows_agree(void **state)
{
    (void)state;
    enum { side = 420, shift_x = 37, shift_y = 11 };
    const double cell_m = 4;
    const int    reach = (int)ceil(take_apart_reach_m / cell_m);
    Site         a = site_make(side, side, cell_m, gentle);
    for (int i = 0; i < 300; i++)
        add_tree(&a, 1680 * random_uniform(11, 1, 0, (uint64_t)i), 1680 * random_uniform(11, 2, 0, (uint64_t)i), 20,
                 12);
    for (int i = 0; i < 8; i++) add_house(&a, 100 + 190 * i, 800 + 40 * (i % 3), 60, 40, 10, 0.2);
    Site b = site_make(side - shift_x, side - shift_y, cell_m, gentle);
    for (int j = 0; j < b.ny; j++)
        memcpy(b.surface_m + (size_t)j * (size_t)b.nx, a.surface_m + (size_t)(j + shift_y) * side + shift_x,
               (size_t)b.nx * sizeof(float));
    site_run(&a);
    const SurfaceModel model = {
        .nx = b.nx, .ny = b.ny, .cell_m = cell_m, .surface_m = b.surface_m, .column = shift_x, .row = shift_y};
    CHECK(take_apart_surface(&b.parts, &model) == STATUS_OK);
    const size_t some = (size_t)(b.nx - 2 * reach);
    for (int j = reach; j < b.ny - reach; j++) {
        const size_t p = (size_t)(j + shift_y) * side + (size_t)(reach + shift_x),
                     q = (size_t)j * (size_t)b.nx + (size_t)reach;
        CHECK(memcmp(a.parts.bare_m + p, b.parts.bare_m + q, some * sizeof(float)) == 0);
        CHECK(memcmp(a.parts.roof_m + p, b.parts.roof_m + q, some * sizeof(float)) == 0);
        CHECK(memcmp(a.parts.kind + p, b.parts.kind + q, some) == 0);
    }
    site_free(&a), site_free(&b);
}

static void odd_windows_are_survived(void **state)
{
    (void)state;
    static const int    shape[][2] = {{1, 1}, {2, 3}, {1, 40}, {40, 1}, {33, 65}};
    static const double cell_m[] = {0.1, 1, 4};
    for (int w = 0; w < 5; w++)
        for (int m = 0; m < 3; m++)
            for (int fill = 0; fill < 5; fill++) {
                Site         s = site_make(shape[w][0], shape[w][1], cell_m[m], level);
                const size_t n = (size_t)s.nx * (size_t)s.ny;
                for (size_t c = 0; c < n; c++) {
                    const double u = random_uniform(13, (uint64_t)fill, 0, c);
                    s.surface_m[c] = fill == 0   ? 5
                                     : fill == 1 ? NAN
                                     : fill == 2 ? -INFINITY
                                     : fill == 3 ? (float)(1e4 * (2 * u - 1))
                                     : u < 0.3   ? NAN
                                     : u > 0.9   ? INFINITY
                                                 : (float)u;
                }
                bool any = false;
                for (size_t c = 0; c < n; c++) any |= fabsf(s.surface_m[c]) < 12000;
                site_run(&s);
                for (size_t c = 0; c < n; c++) {
                    CHECK(isfinite(s.parts.bare_m[c]) == any);
                    CHECK(s.parts.kind[c] <= CELL_TREE);
                    CHECK(isfinite(s.parts.roof_m[c]) == (s.parts.kind[c] == CELL_BUILDING));
                }
                site_free(&s);
            }
    const SurfaceModel coarse = {.nx = 1, .ny = 1, .cell_m = 4.5};
    SurfaceParts       none = {0};
    CHECK(take_apart_surface(&none, &coarse) == STATUS_UNSUPPORTED);
}

static void spikes_leave_no_mark(void **state)
{
    (void)state;
    Site s = site_make(200, 200, 1, level);
    s.surface_m[50 * 200 + 50] = 1e4F, s.surface_m[90 * 200 + 20] = -1e4F, s.surface_m[120 * 200 + 150] = INFINITY;
    for (int j = 100; j < 140; j++)
        for (int i = 60; i < 100; i++) s.surface_m[j * 200 + i] = NAN;
    site_run(&s);
    CHECK(ground_rms(&s, 0) < 0.03);
    CHECK(s.parts.crown_count == 0);
    site_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bare_hills_and_terraces_stay), cmocka_unit_test(houses_and_trees_are_told_apart),
        cmocka_unit_test(a_wide_roof_is_no_ground),     cmocka_unit_test(tiers_on_a_bank_are_no_ground),
        cmocka_unit_test(banks_and_knolls_stay),        cmocka_unit_test(a_forested_slope_keeps_its_slope),
        cmocka_unit_test(overlapping_windows_agree),    cmocka_unit_test(odd_windows_are_survived),
        cmocka_unit_test(spikes_leave_no_mark),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
