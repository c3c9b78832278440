/* What is built gives way to vehicles on ground that was not told of them: no building, wall or thing is left in a
 * path, by a distance of its own between polygons and lines; all that is farther away stays as it was. */
#include "tests/terrain/culture_lab.h"

#include "terrain/culture/culture_give_way.h"

enum { drives = 24, pieces = 40 };

static double point_m(const double p[2], const double a[2], const double b[2])
{
    const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    const double t = square > 0 ? clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, 0, 1) : 0;
    return hypot(a[0] + t * dx - p[0], a[1] + t * dy - p[1]);
}

static double turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double segments_m(const double a[2], const double b[2], const double c[2], const double d[2])
{
    if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) return 0;
    return fmin(fmin(point_m(a, c, d), point_m(b, c, d)), fmin(point_m(c, a, b), point_m(d, a, b)));
}

/* From a path's middle line to an outline or line; 0 inside of an outline. */
static double away_m(const DrivenPath *path, const double (*p)[2], int n, bool closed)
{
    double least = INFINITY;
    bool   in = false;
    for (int k = closed ? 0 : 1; k < n; k++) {
        const double *q = p[(k + n - 1) % n], *r = p[k];
        least = fmin(least, segments_m(path->a_m, path->b_m, q, r));
        if ((q[1] > path->a_m[1]) != (r[1] > path->a_m[1]) &&
            path->a_m[0] < q[0] + (path->a_m[1] - q[1]) * (r[0] - q[0]) / (r[1] - q[1]))
            in = !in;
    }
    return closed && in ? 0 : least;
}

static void nothing_is_left_in_a_path(void **state)
{
    static DrivenPath path[drives * pieces];
    Landscape         land;
    (void)state;
    make(&land, 5, 3000, NULL);
    Culture   c = invent(&land, 0, 0, 4000), whole = invent(&land, 0, 0, 4000);
    const int buildings = c.buildings, lines = c.lines, points = c.points;
    for (int d = 0; d < drives; d++) { /* from house to house: through the villages */
        const Building *from = &whole.building[(d * 7919) % buildings],
                       *to = &whole.building[(d * 104729 + 5) % buildings];
        const double *a = whole.corner_m[from->first_corner], *b = whole.corner_m[to->first_corner];
        for (int k = 0; k < pieces; k++) {
            DrivenPath *p = &path[d * pieces + k];
            for (int i = 0; i < 2; i++) {
                p->a_m[i] = a[i] + (b[i] - a[i]) * k / pieces;
                p->b_m[i] = a[i] + (b[i] - a[i]) * (k + 1) / pieces;
            }
            p->half_m = 1 + (d % 4);
        }
    }
    int taken, left = 0, gone = 0, kept = 0;
    assert_int_equal(culture_give_way(&c, &taken, path, drives * pieces), STATUS_OK);
    assert_int_equal(taken, buildings + lines + points - c.buildings - c.lines - c.points);
    for (int n = 0, at = 0; n < whole.buildings; n++) { /* in order: each is there as it was, or was in a path */
        const Building *b = &whole.building[n];
        double          nearest = INFINITY;
        for (int k = 0; k < drives * pieces; k++)
            nearest =
                fmin(nearest, away_m(&path[k], (const double(*)[2])whole.corner_m + b->first_corner, b->corners, true) -
                                  path[k].half_m);
        const bool there = at < c.buildings && c.building[at].id == b->id;
        if (there) {
            CHECK(nearest > 0);
            CHECK(memcmp(c.corner_m + c.building[at].first_corner, whole.corner_m + b->first_corner,
                         (size_t)b->corners * sizeof *c.corner_m) == 0);
            at++, kept++;
        } else {
            CHECK(nearest < 0.26); /* half a step of its look */
            gone++;
        }
    }
    for (int n = 0; n < c.lines; n++) {
        const CultureLine *l = &c.line[n];
        if (l->kind > CULTURE_WIRE_FENCE) continue;
        for (int k = 0; k < drives * pieces; k++)
            left +=
                away_m(&path[k], (const double(*)[2])c.corner_m + l->first_corner, l->corners, false) < path[k].half_m;
    }
    for (int n = 0; n < c.points; n++)
        for (int k = 0; k < drives * pieces; k++)
            left +=
                point_m((const double[2]){c.point[n].x_m, c.point[n].y_m}, path[k].a_m, path[k].b_m) < path[k].half_m;
    print_message("%d buildings kept, %d gone; %d records in all\n", kept, gone, taken);
    CHECK(left == 0 && gone > 30 && kept > gone);
    /* its index is that of what is left */
    for (int k = 0; k < drives * pieces; k++) CHECK(culture_building_at(&c, path[k].a_m[0], path[k].a_m[1], 0.5) < 0);
    assert_int_equal(culture_give_way(&c, &taken, path, drives * pieces), STATUS_OK);
    assert_int_equal(taken, 0);
    assert_int_equal(culture_give_way(&whole, &taken, NULL, 0), STATUS_OK);
    assert_int_equal(whole.buildings, buildings);
    culture_free(&c), culture_free(&whole);
    landscape_destroy(&land);
}

/* Paths of any numbers do no harm. */
static void absurd_paths(void **state)
{
    const double odd[] = {NAN, INFINITY, -INFINITY, 1e300, 0, -1};
    Landscape    land;
    (void)state;
    make(&land, 5, 2000, NULL);
    Culture c = invent(&land, 0, 0, 2000);
    for (int k = 0; k < 6 * 6; k++) {
        int              taken;
        const DrivenPath p = {{odd[k % 6], 0}, {1, odd[k / 6]}, k == 7 ? NAN : 1};
        assert_int_equal(culture_give_way(&c, &taken, &p, 1), STATUS_OK);
    }
    CHECK(c.buildings > 0);
    culture_free(&c);
    landscape_destroy(&land);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_is_left_in_a_path), cmocka_unit_test(absurd_paths)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
