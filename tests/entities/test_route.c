/* Routes: the spline passes its points, lies on a line and a circle whose answers are known, goes by arc length; and
 * its derivatives are those that differences give. */
#include "tests/check.h"

#include "entities/exercise/cast_private.h"

static void straight_line(void **state)
{
    (void)state;
    const double point[3][3] = {{10, 20, 5}, {40, 60, 5}, {130, 180, 5}}; /* 3:4:5, 50 m and 150 m */
    Route        route;
    RoutePoint   at;
    CHECK(route_create(&route, point, 3, false) == STATUS_OK);
    CHECK_NEAR(route.length_m, 200, 1e-9);
    for (double s = -30; s <= 230; s += 3.7) { /* before the beginning and behind the end it goes on */
        route_at(&at, &route, s);
        CHECK_NEAR(at.p[0], 10 + 0.6 * s, 1e-9);
        CHECK_NEAR(at.p[1], 20 + 0.8 * s, 1e-9);
        CHECK_NEAR(at.p[2], 5, 1e-12);
        CHECK_NEAR(at.d[0], 0.6, 1e-9);
        CHECK_NEAR(at.d[1], 0.8, 1e-9);
        CHECK_NEAR(v3_length(at.dd), 0, 1e-9);
    }
    route_destroy(&route);
}

/* 24 points: the cubic's own error is h^4 / 384 = 1.2e-5 of the radius, that of its curvature h^2 / 12 = 6e-3. */
static void circle(void **state)
{
    (void)state;
    enum { count = 24 };
    static const double radius_m = 300;
    double              point[count][3];
    Route               route;
    RoutePoint          at;
    for (int i = 0; i < count; i++) {
        point[i][0] = radius_m * cos(2 * pi_rad * i / count), point[i][1] = radius_m * sin(2 * pi_rad * i / count);
        point[i][2] = 40;
    }
    CHECK(route_create(&route, (const double(*)[3])point, count, true) == STATUS_OK);
    CHECK_NEAR(route.length_m, 2 * pi_rad * radius_m, 2 * pi_rad * radius_m * 3e-5);
    for (double s = -700; s < 5000; s += 13.3) {
        const double angle = s / route.length_m * 2 * pi_rad;
        route_at(&at, &route, s);
        CHECK_NEAR(at.p[0], radius_m * cos(angle), 0.01);
        CHECK_NEAR(at.p[1], radius_m * sin(angle), 0.01);
        CHECK_NEAR(at.p[2], 40, 1e-9);
        CHECK_NEAR(at.d[0], -sin(angle), 1e-3);
        CHECK_NEAR(at.d[1], cos(angle), 1e-3);
        CHECK_NEAR(v3_length(at.dd) * radius_m, 1, 0.01);
    }
    route_destroy(&route);
}

static void through_its_points_by_arc_length(void **state)
{
    (void)state;
    const double point[6][3] = {{0, 0, 0}, {100, 30, 10}, {180, 160, 0}, {90, 260, -20}, {-80, 200, 5}, {-200, 340, 0}};
    Route        route;
    CHECK(route_create(&route, point, 6, false) == STATUS_OK);
    double     nearest[6], way = 0;
    RoutePoint at, before, after;
    for (int i = 0; i < 6; i++) nearest[i] = 1e9;
    route_at(&before, &route, 0);
    for (double s = 0; s <= route.length_m; s += 0.05) {
        route_at(&at, &route, s);
        for (int i = 0; i < 6; i++) {
            double off[3];
            v3_sub(off, at.p, point[i]);
            nearest[i] = fmin(nearest[i], v3_length(off));
        }
        way += hypot(at.p[0] - before.p[0], at.p[1] - before.p[1]);
        before = at;
    }
    /* half a step of 0.05 m, and what resampling costs at 130 m from point to point */
    for (int i = 0; i < 6; i++) CHECK_NEAR(nearest[i], 0, 0.05);
    CHECK_NEAR(way, route.length_m, 1e-3 * route.length_m);

    /* derivatives against central differences over 0.2 m; the third derivative is below 1e-3 / m^2 */
    for (double s = 5; s < route.length_m - 5; s += 7.1) {
        route_at(&at, &route, s);
        route_at(&before, &route, s - 0.1);
        route_at(&after, &route, s + 0.1);
        for (int i = 0; i < 3; i++) {
            CHECK_NEAR(at.d[i], (after.p[i] - before.p[i]) / 0.2, 1e-5);
            CHECK_NEAR(at.dd[i], (after.d[i] - before.d[i]) / 0.2, 2e-4);
        }
        CHECK_NEAR(hypot(at.d[0], at.d[1]), 1, 1e-3); /* by arc length */
    }
    route_destroy(&route);
}

static void too_few_or_too_near(void **state)
{
    (void)state;
    const double point[3][3] = {{0, 0, 0}, {0, 0, 50}, {9, 0, 0}};
    Route        route;
    CHECK(route_create(&route, point, 1, false) == STATUS_BAD_VALUE);
    CHECK(route_create(&route, point, 2, true) == STATUS_BAD_VALUE);
    CHECK(route_create(&route, point, 3, false) == STATUS_BAD_VALUE); /* one above the other */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_line),
        cmocka_unit_test(circle),
        cmocka_unit_test(through_its_points_by_arc_length),
        cmocka_unit_test(too_few_or_too_near),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
