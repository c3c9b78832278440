/* Exhausts are seen: what of them is hidden in other parts neither warms the air behind nor cools. The share of each
 * shape's exhaust whose outside is in no other solid, by winding numbers: signed crossings of a ray. */
#include "tests/check.h"

#include "entities/shapes/parametric.h"

/* Which way a ray from o along d crosses a triangle: 1 outwards, -1 inwards, 0 not. */
static int crossing(const double o[3], const double d[3], const Model *m, int t)
{
    double p[3][3], u[3], v[3], n[3], q[3];
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) p[k][c] = (double)m->vertex[m->triangle[t][k]][c];
    v3_sub(u, p[1], p[0]), v3_sub(v, p[2], p[0]);
    v3_cross(n, u, v);
    const double slope = v3_dot(n, d);
    if (slope == 0) return 0;
    v3_sub(q, p[0], o);
    const double range = v3_dot(q, n) / slope;
    if (!(range > 0)) return 0;
    for (int k = 0; k < 3; k++) {
        double edge[3], to[3], across[3], at[3];
        v3_sub(edge, p[(k + 1) % 3], p[k]);
        for (int c = 0; c < 3; c++) at[c] = o[c] + range * d[c];
        v3_sub(to, at, p[k]);
        v3_cross(across, edge, to);
        if (v3_dot(across, n) < 0) return 0;
    }
    return slope > 0 ? 1 : -1;
}

/* Share of the area of a model's exhausts that is outside of all its other parts; -1: it has none. */
static double share_outside(const Model *m)
{
    const double way[3] = {0.3183098, 0.5772157, -0.7519553};
    double       all = 0, outside = 0;
    for (int t = 0; t < m->triangle_count; t++) {
        const int part = m->triangle_part[t];
        double    p[3][3], u[3], v[3], n[3], middle[3];
        int       within = 0;
        if (m->part[part].role != HEAT_EXHAUST) continue;
        for (int k = 0; k < 3; k++)
            for (int c = 0; c < 3; c++) p[k][c] = (double)m->vertex[m->triangle[t][k]][c];
        v3_sub(u, p[1], p[0]), v3_sub(v, p[2], p[0]);
        v3_cross(n, u, v);
        const double area = 0.5 * v3_length(n);
        for (int c = 0; c < 3; c++) middle[c] = (p[0][c] + p[1][c] + p[2][c]) / 3 + 1e-3 * n[c] / (2 * area);
        for (int o = 0; o < m->triangle_count; o++)
            if (m->part[m->triangle_part[o]].role != HEAT_EXHAUST) within += crossing(middle, way, m, o);
        all += area;
        if (within <= 0) outside += area;
    }
    return all > 0 ? outside / all : -1;
}

static void exhausts_are_seen(void **state)
{
    (void)state;
    int count = 0, low = 0;
    for (int k = 0; k < parametric_count(); k++) {
        Model m = {0};
        assert_int_equal(parametric_build(&m, parametric_name(k), 0.02), STATUS_OK);
        const double share = share_outside(&m);
        model_destroy(&m);
        if (share < 0) continue;
        count++;
        print_message("%s %.2f\n", parametric_name(k), share);
        if (!(share > 0.1)) low++;
        if (!strcmp(parametric_name(k), "car")) CHECK(share > 0.95);
    }
    CHECK(count > 15 && low == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(exhausts_are_seen)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
