/* Buildings from a surface model: outlines, bases, heights and roof shapes of houses that the test put there. */
#include "tests/check.h"

#include "terrain/culture/culture_surface.h"
#include "terrain/culture/outline.h"

#include <stdlib.h>

typedef struct House {
    double    x_m, y_m, turn_rad, long_m, wide_m, eaves_m, rise_m;
    RoofShape roof;
} House;

enum { side = 200 };

static double ground(double x_m, double y_m) { return 40 + 0.03 * x_m + 0.01 * y_m; }

static double roof_of(const House *h, double u, double v)
{
    const double gable = h->rise_m * (1 - 2 * fabs(v) / h->wide_m);
    const double wall_m = fmin(0.5 * h->long_m - fabs(u), 0.5 * h->wide_m - fabs(v));
    switch (h->roof) {
    case ROOF_GABLED:
        return h->eaves_m + gable;
    case ROOF_SKILLION:
        return h->eaves_m + h->rise_m * (0.5 - u / h->long_m);
    case ROOF_HIPPED:
    case ROOF_PYRAMIDAL:
        return h->eaves_m + h->rise_m * wall_m / (0.5 * h->wide_m);
    case ROOF_FLAT:
    case ROOF_SHAPES:
        break;
    }
    return h->eaves_m;
}

/* Highest surface of each cell, as a surface model has it, with noise. */
static void survey(float *surface_m, const House *house, int houses, double cell_m)
{
    enum { fine = 4 };
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            double top = -INFINITY;
            for (int k = 0; k < fine * fine; k++) {
                const double x = (i + (k % fine + 0.5) / fine) * cell_m, y = (j + ((k / fine) + 0.5) / fine) * cell_m;
                double       z = ground(x, y);
                for (int n = 0; n < houses; n++) {
                    const House *h = &house[n];
                    const double c = cos(h->turn_rad), s = sin(h->turn_rad), dx = x - h->x_m, dy = y - h->y_m;
                    const double u = c * dx + s * dy, v = c * dy - s * dx;
                    if (fabs(u) < 0.5 * h->long_m && fabs(v) < 0.5 * h->wide_m)
                        z = ground(h->x_m, h->y_m) + roof_of(h, u, v);
                }
                top = fmax(top, z);
            }
            surface_m[j * side + i] = (float)(top + 0.06 * (random_uniform(3, 1, 0, (uint64_t)(j * side + i)) - 0.5));
        }
}

static Culture taken(const float *surface_m, double cell_m, const SurfacePlace *place)
{
    const SurfaceModel model = {.nx = side, .ny = side, .cell_m = cell_m, .surface_m = surface_m};
    SurfaceParts       parts = {.bare_m = malloc(side * side * sizeof(float)),
                                .roof_m = malloc(side * side * sizeof(float)),
                                .kind = malloc(side * side)};
    Culture            culture = {0};
    CHECK(take_apart_surface(&parts, &model) == STATUS_OK);
    CHECK(culture_add_surface(&culture, &parts, &model, place, NULL) == STATUS_OK);
    free(parts.bare_m), free(parts.roof_m), free(parts.kind), free(parts.crown);
    return culture;
}

/* The building about a place; NULL: none. */
static const Building *at(Culture *culture, double x_m, double y_m)
{
    CHECK(culture_index(culture) == STATUS_OK);
    const int n = culture_building_at(culture, x_m, y_m, 0);
    return n < 0 ? NULL : &culture->building[n];
}

/* The greatest distance of a true corner from the nearest corner found. */
static double corner_off_m(const Culture *culture, const Building *b, const House *h)
{
    double most = 0;
    for (int k = 0; k < 4; k++) {
        const double u = (k % 2 ? 0.5 : -0.5) * h->long_m, v = (k / 2 ? 0.5 : -0.5) * h->wide_m;
        const double x = h->x_m + cos(h->turn_rad) * u - sin(h->turn_rad) * v;
        const double y = h->y_m + sin(h->turn_rad) * u + cos(h->turn_rad) * v;
        double       least = INFINITY;
        for (int n = 0; n < b->corners; n++) {
            const double *corner = culture->corner_m[b->first_corner + n];
            least = fmin(least, hypot(corner[0] - x, corner[1] - y));
        }
        most = fmax(most, least);
    }
    return most;
}

static void houses_come_back(void **state)
{
    (void)state;
    static const SurfacePlace place[2] = {{{0, 0}, {1, 0}, {0, 1}}, {{0, 0}, {0.5, 0}, {0, 0.5}}};
    for (int fine = 0; fine < 2; fine++) {
        const double cell_m = fine ? 0.5 : 1;
        float       *surface_m = malloc(side * side * sizeof *surface_m);
        double       worst_m = 0, worst_rad = 0;
        for (int turn = 0; turn < 5; turn++) {
            const double scale = fine ? 0.5 : 1, a = 0.31 * turn;
            const House  house[] = {{40 * scale, 40 * scale, a, 14, 10, 4, 3.5, ROOF_GABLED},
                                    {110 * scale, 40 * scale, a + 0.2, 16, 11, 3.5, 0, ROOF_FLAT},
                                    {40 * scale, 130 * scale, a + 0.4, 18, 12, 5, 3, ROOF_HIPPED},
                                    {110 * scale, 130 * scale, a, 14, 9, 3, 2.5, ROOF_SKILLION},
                                    {170 * scale, 90 * scale, a + 0.1, 12, 12, 6, 4, ROOF_PYRAMIDAL}};
            survey(surface_m, house, 5, cell_m);
            Culture culture = taken(surface_m, cell_m, &place[fine]);
            CHECK(culture.buildings == 5);
            for (int n = 0; n < 5; n++) {
                const House    *h = &house[n];
                const Building *b = at(&culture, h->x_m, h->y_m);
                CHECK(b);
                if (!b) continue;
                worst_m = fmax(worst_m, corner_off_m(&culture, b, h));
                const double off_m = corner_off_m(&culture, b, h);
                const double ridge_m = h->eaves_m + h->rise_m;
                if (b->corners != 4 || off_m > 1 || b->roof != h->roof)
                    print_message("turn %.2f house %d: %d corners, %.2f m off, shape %d, eaves %.2f ridge %.2f\n", a, n,
                                  b->corners, off_m, b->roof, (double)b->eaves_m, (double)b->ridge_m);
                CHECK(b->corners == 4 && off_m < 1);
                CHECK(b->roof == h->roof);
                /* the floor is the lowest ground along the outline: up to 0.25 m below that of the middle */
                const double base_m = ground(h->x_m, h->y_m) - (double)b->base_m;
                CHECK(base_m > -0.15 && base_m < 0.5);
                CHECK(fabs((double)b->ridge_m - base_m - ridge_m) < 0.5);
                CHECK(fabs((double)b->eaves_m - base_m - h->eaves_m) < 0.5);
                worst_rad = fmax(worst_rad, fabs(sin(2 * ((double)b->ridge_rad - h->turn_rad)) / 2));
                if (h->roof == ROOF_GABLED) CHECK(fabs(sin((double)b->ridge_rad - h->turn_rad)) < 0.06);
                if (h->roof == ROOF_SKILLION) CHECK(cos((double)b->ridge_rad - h->turn_rad) > 0.998);
            }
            culture_free(&culture);
        }
        print_message("%.1f m: corners within %.2f m, directions %.3f rad\n", cell_m, worst_m, worst_rad);
        free(surface_m);
    }
}

/* Two flat roofs side by side, 3 m apart in height, are two buildings; an L is one with six corners. */
static void steps_part_and_corners_stay(void **state)
{
    (void)state;
    float      *surface_m = malloc(side * side * sizeof *surface_m);
    const House house[] = {
        {60, 60, 0, 20, 12, 4, 0, ROOF_FLAT},
        {60, 72, 0, 20, 12, 7, 0, ROOF_FLAT},
        {130, 130, 0.5, 24, 10, 5, 0, ROOF_FLAT},
        {130 + 7 * cos(0.5) - 10 * sin(0.5), 130 + 7 * sin(0.5) + 10 * cos(0.5), 0.5, 10, 12, 5, 0, ROOF_FLAT}};
    survey(surface_m, house, 4, 1);
    Culture culture = taken(surface_m, 1, &(SurfacePlace){{1000, 500}, {1, 0}, {0, 1}});
    CHECK(culture.buildings == 3);
    const Building *low = at(&culture, 1060, 560), *high = at(&culture, 1060, 574), *l = at(&culture, 1130, 630);
    CHECK(low && high && l && low != high);
    if (low && high && l) {
        CHECK(fabs((double)(high->ridge_m - low->ridge_m) - 3) < 0.4);
        CHECK(low->corners == 4 && high->corners == 4);
        print_message("an L of 24 x 10 and 10 x 12 m: %d corners\n", l->corners);
        CHECK(l->corners == 6);
    }
    culture_free(&culture);
    free(surface_m);
}

/* Boundaries that touch themselves, single cells, all of the window: nothing hangs, what comes out has an area. */
static void odd_patches_are_survived(void **state)
{
    (void)state;
    enum { n = 24 };
    static Outline outline;
    int32_t        of[n * n];
    for (unsigned k = 0; k < 2000; k++) {
        for (int c = 0; c < n * n; c++) of[c] = random_uniform(5, k, 0, (uint64_t)c) < 0.1 * (k % 10);
        int stack[n * n], count = 0, first = -1;
        for (int c = 0; c < n * n && first < 0; c++)
            if (of[c] == 1) first = c;
        if (first < 0) continue;
        of[first] = 2, stack[count++] = first;
        while (count > 0) {
            const int c = stack[--count];
            const int near[4] = {c % n ? c - 1 : -1, c % n < n - 1 ? c + 1 : -1, c - n, c + n < n * n ? c + n : -1};
            for (int i = 0; i < 4; i++)
                if (near[i] >= 0 && of[near[i]] == 1) of[near[i]] = 2, stack[count++] = near[i];
        }
        if (!outline_of_cells(&outline, of, n, n, 2, (size_t)first)) continue;
        CHECK(outline.corners >= 3);
        for (int c = 0; c < outline.corners; c++)
            CHECK(isfinite(outline.corner[c][0]) && isfinite(outline.corner[c][1]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(houses_come_back),
        cmocka_unit_test(steps_part_and_corners_stay),
        cmocka_unit_test(odd_patches_are_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
