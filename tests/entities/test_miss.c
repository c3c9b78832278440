/* Closest approach, fuze and plane against lines and parabolas whose answers are known.
 * labels: physics */
#include "tests/check.h"

#include "entities/flight/miss.h"

/* Position and velocity of constant acceleration. */
typedef struct Path {
    double p[3], v[3], a[3];
} Path;

static void leg_of(MissLeg *leg, const Path *path, double t0, double t1)
{
    for (int k = 0; k < 3; k++) {
        leg->p0_ecef[k] = path->p[k] + t0 * (path->v[k] + 0.5 * t0 * path->a[k]);
        leg->p1_ecef[k] = path->p[k] + t1 * (path->v[k] + 0.5 * t1 * path->a[k]);
        leg->v0_ecef_mps[k] = path->v[k] + t0 * path->a[k];
        leg->v1_ecef_mps[k] = path->v[k] + t1 * path->a[k];
    }
}

static Miss follow(const Path *missile, const Path *target, double end_s, double step_s, double fuze_m)
{
    Miss miss = miss_begin();
    for (int i = 0; i * step_s < end_s; i++) {
        MissLeg a, b;
        leg_of(&a, missile, i * step_s, (i + 1) * step_s);
        leg_of(&b, target, i * step_s, (i + 1) * step_s);
        miss_step(&miss, i * step_s, step_s, &a, &b, fuze_m);
    }
    return miss;
}

static const double at_ecef[3] = {4e6, 3e6, 4e6}; /* a double steps by a nanometre there */

/* Two straight lines: |d x v| / |v|, at -d v / v^2; coarse steps and fine ones. */
static void straight_lines(void **state)
{
    (void)state;
    for (int i = 0; i < 300; i++) {
        Path   a = {0}, b = {0};
        double d[3], w[3], cross[3];
        for (int k = 0; k < 3; k++) {
            a.p[k] = at_ecef[k] + 3 * random_normal(1, 0, (uint32_t)i, (uint64_t)k);
            b.p[k] = at_ecef[k] + 300 * random_normal(1, 1, (uint32_t)i, (uint64_t)k);
            a.v[k] = 500 * random_normal(1, 2, (uint32_t)i, (uint64_t)k);
            b.v[k] = 100 * random_normal(1, 3, (uint32_t)i, (uint64_t)k);
        }
        v3_sub(d, a.p, b.p);
        v3_sub(w, a.v, b.v);
        const double t = -v3_dot(d, w) / v3_dot(w, w);
        if (t < 0.01 || t > 1.9) continue;
        v3_cross(cross, d, w);
        const double want = v3_length(cross) / v3_length(w);
        const double step[3] = {0.001, 0.0373, 2};
        const double fine_s =
            1e-5 / v3_length(w); /* 10 um of the way: ends that are rounded to 1 nm turn a step of 1 ms */
        for (int s = 0; s < 3; s++) {
            const Miss miss = follow(&a, &b, 2, step[s], 0);
            CHECK_NEAR(miss.least_m, want, 1e-8);
            CHECK_NEAR(miss.t_s, t, fine_s);
            CHECK_NEAR(v3_length(miss.away_ecef), want, 1e-8);
            /* the fuze: at the earlier root of |d + w t| = r */
            const double r = want + 20, early = t - sqrt((r * r - want * want) / v3_dot(w, w));
            if (early < 0.001) continue;
            const Miss fuzed = follow(&a, &b, 2, step[s], r);
            CHECK(fuzed.fuzed);
            CHECK_NEAR(fuzed.fuze_t_s, early, fine_s);
            CHECK_NEAR(v3_length(fuzed.fuze_away_ecef), r, 1e-7);
            CHECK(!follow(&a, &b, 2, step[s], 0.999 * want).fuzed);
        }
    }
}

/* A stone thrown at 45 degrees, and a point on the axis of its parabola y = h - x^2 / (2 l), l = v^2 cos^2 / g: from a
 * point at depth d > l below the top the nearest points lie aside, at sqrt(2 l d - l^2). */
static void a_parabola(void **state)
{
    (void)state;
    const double g = 10, up = 40, level = 20, l = level * level / g, top_s = up / g, deep = 70;
    Path stone = {.v = {level, 0, up}, .a = {0, 0, -g}}, point = {.p = {level * top_s, 0, 0.5 * up * up / g - deep}};
    for (int k = 0; k < 3; k++) stone.p[k] += at_ecef[k], point.p[k] += at_ecef[k];
    const double aside = sqrt(2 * (deep - l) * l), want = sqrt(2 * l * deep - l * l);
    const Miss   miss = follow(&stone, &point, 9, 0.1, 0);
    CHECK_NEAR(miss.least_m, want, 1e-8);
    CHECK_NEAR(miss.t_s, top_s - aside / level, 1e-7); /* the first of two that are alike */
    const double normal[3] = {0, 0, 1};
    MissLeg      leg;
    double       after, at[3];
    leg_of(&leg, &stone, 7, 9);
    CHECK(plane_crossing(&after, at, 2, &leg, at_ecef, normal));
    CHECK_NEAR(7 + after, 2 * up / g, 1e-9);
    CHECK_NEAR(at[0] - at_ecef[0], level * 2 * up / g, 1e-7);
    leg_of(&leg, &stone, 5, 7);
    CHECK(!plane_crossing(&after, at, 2, &leg, at_ecef, normal));
    leg_of(&leg, &stone, 9, 10);
    CHECK(plane_crossing(&after, at, 1, &leg, at_ecef, normal) && after == 0);
}

/* One that only goes away was nearest at first, one that only comes is nearest at last. */
static void ends_count(void **state)
{
    (void)state;
    Path a = {.v = {100, 0, 0}}, b = {.p = {-7, 0, 0}};
    CHECK_NEAR(follow(&a, &b, 1, 0.01, 0).least_m, 7, 0);
    CHECK_NEAR(follow(&a, &b, 1, 0.01, 0).t_s, 0, 0);
    CHECK(follow(&a, &b, 1, 0.01, 8).fuze_t_s == 0);
    b.p[0] = 500;
    CHECK_NEAR(follow(&a, &b, 1, 0.25, 0).least_m, 400, 1e-9);
    CHECK_NEAR(follow(&a, &b, 1, 0.25, 0).t_s, 1, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_lines),
        cmocka_unit_test(a_parabola),
        cmocka_unit_test(ends_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
