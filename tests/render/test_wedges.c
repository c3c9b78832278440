/* Wedges of meshes whose edges are known: boxes, sheets, steps, junctions, cylinders. labels: physics */
#include "tests/render/hand_mesh.h"

static const double pi = 3.14159265358979323846;

static double total_length(const WedgeList *list, double exterior_pi)
{
    double sum = 0, d[3];
    for (int i = 0; i < list->count; i++) {
        if (fabs(list->wedge[i].frame.exterior_pi - exterior_pi) > 1e-6) continue;
        v3_sub(d, list->wedge[i].p[1], list->wedge[i].p[0]);
        sum += v3_length(d);
    }
    return sum;
}

/* Free space begins on the side of y: outside the body about centre, at half of the exterior angle. */
static void check_outward(const WedgeList *list, const double centre[3])
{
    for (int i = 0; i < list->count; i++) {
        const Wedge *w = &list->wedge[i];
        const double half = w->frame.exterior_pi * pi / 2;
        double       out[3], from[3];
        v3_scale(out, cos(half), w->frame.x);
        v3_add_scaled(out, out, sin(half), w->frame.y);
        v3_add(from, w->p[0], w->p[1]);
        v3_add_scaled(from, from, -2, centre);
        CHECK(v3_dot(out, from) > 0);
    }
}

static void test_box(void **state)
{
    (void)state;
    for (int cells = 1; cells <= 8; cells *= 2) {
        begin();
        add_box((const double[3]){-1, 2, 0}, (const double[3]){1, 2, 3}, cells, 0);
        WedgeList list = find();
        CHECK(list.count == 12 && list.concave == 0 && list.junctions == 0);
        CHECK_NEAR(total_length(&list, 1.5), 24, 1e-9);
        check_outward(&list, (const double[3]){-0.5, 3, 1.5});
        wedges_destroy(&list);
    }
}

static void test_sheets(void **state)
{
    (void)state;
    const double o[3] = {0}, x[3] = {2, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1}, back[3] = {-2, 0, 0};
    for (int cells = 1; cells <= 4; cells += 3) {
        begin();
        add_panel(o, x, y, cells, 0); /* one side */
        WedgeList list = find();
        CHECK(list.count == 4);
        CHECK_NEAR(total_length(&list, 2), 6, 1e-9);
        check_outward(&list, (const double[3]){1, 0.5, 0});
        wedges_destroy(&list);

        add_panel(o, y, x, cells, 0); /* both */
        list = find();
        CHECK(list.count == 4);
        CHECK_NEAR(total_length(&list, 2), 6, 1e-9);
        check_outward(&list, (const double[3]){1, 0.5, 0});
        wedges_destroy(&list);

        /* folded along x, two sheets of one side each: seen from outside whichever side was modelled */
        for (int side = 0; side < 2; side++) {
            begin();
            if (side == 0) add_panel(o, x, y, cells, 0), add_panel(o, z, x, cells, 0);
            else add_panel(o, y, x, cells, 0), add_panel(o, x, z, cells, 0);
            list = find();
            CHECK(list.count == 7);
            CHECK_NEAR(total_length(&list, 1.5), 2, 1e-9);
            CHECK_NEAR(total_length(&list, 2), 8, 1e-9);
            for (int i = 0; i < list.count; i++)
                if (list.wedge[i].frame.exterior_pi < 1.9)
                    CHECK(fmax(list.wedge[i].frame.x[1], list.wedge[i].frame.x[2]) > 0.99);
            wedges_destroy(&list);
        }
        /* three sheets at one edge: a junction */
        add_panel(o, back, y, cells, 0);
        add_panel(o, x, (const double[3]){0, -1, -1}, cells, 0);
        list = find();
        CHECK(list.junctions == cells);
        wedges_destroy(&list);
    }
    /* in one plane, of two parts: no edge between them */
    begin();
    add_panel(o, x, y, 2, 0);
    add_panel((const double[3]){2, 0, 0}, x, y, 2, 1);
    WedgeList list = find();
    CHECK_NEAR(total_length(&list, 2), 10, 1e-9);
    wedges_destroy(&list);
}

/* A fin on a plate, and on a roof's ridge: the fin's foot is no wedge, for it divides the free space. Two boxes of one
 * part, side by side: where they touch, their common wall is inside, and top edges go on over it. */
static void test_junctions(void **state)
{
    (void)state;
    const double o[3] = {0}, x[3] = {1, 0, 0}, left[3] = {0, 1, 0}, right[3] = {0, -1, 0}, up[3] = {0, 0, 1};
    for (int ridge = 0; ridge < 2; ridge++) {
        const double low[3] = {0, 1, -1}, other[3] = {0, -1, -1};
        begin();
        add_panel(o, x, ridge ? low : left, 1, 0);
        add_panel(o, ridge ? other : right, x, 1, 0);
        add_panel(o, x, up, 1, 0);
        add_panel(o, up, x, 1, 0);
        WedgeList list = find();
        CHECK(list.junctions == 1 && list.count == (ridge ? 9 : 7)); /* the flat plate's sides go on past the fin */
        wedges_destroy(&list);
    }
    /* without the plate's right half, with a brace: free space goes from the left half, below, to the fin */
    begin();
    add_panel(o, x, left, 1, 0);
    add_panel(o, x, (const double[3]){0, 1, 1}, 1, 0);
    add_panel(o, x, up, 1, 0);
    WedgeList list = find();
    CHECK(list.junctions == 0 && list.count == 10);
    CHECK_NEAR(total_length(&list, 1.5), 1, 1e-9);
    wedges_destroy(&list);

    begin();
    add_box(o, (const double[3]){1, 1, 1}, 1, 0);
    add_box(x, (const double[3]){1, 1, 1}, 1, 0);
    list = find();
    CHECK(list.junctions == 4 && list.count == 12);
    CHECK_NEAR(total_length(&list, 1.5), 4 * (2 + 1 + 1), 1e-9);
    wedges_destroy(&list);
}

/* A step, closed, 1 m high: one concave edge of it. Long sides are in two pieces each, so that corners meet corners. */
static void test_concave(void **state)
{
    (void)state;
    static const double ring[8][2] = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}};
    const double        x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
    begin();
    for (int i = 0; i < 8; i++) {
        const double *a = ring[i], *b = ring[(i + 1) % 8];
        add_panel((const double[3]){a[0], a[1], 0}, (const double[3]){b[0] - a[0], b[1] - a[1], 0}, z, 1, 0);
    }
    for (int k = 0; k < 3; k++) { /* squares of the outline, below and above */
        add_panel((const double[3]){k == 1, k == 2, 0}, y, x, 1, 0);
        add_panel((const double[3]){k == 1, k == 2, 1}, x, y, 1, 0);
    }
    WedgeList list = find();
    CHECK(list.concave == 1 && list.junctions == 0 && list.count == 5 + 12);
    CHECK_NEAR(total_length(&list, 1.5), 5 + 16, 1e-9);
    wedges_destroy(&list);
}

/* A closed cylinder: its side counts as smooth by its vertex normals, or because its facets turn little; else as
 * facets. */
static void test_cylinder(void **state)
{
    (void)state;
    const double     radius_m = 0.5, up[3] = {0, 0, 1}, down[3] = {0, 0, -1};
    static const int facets_of[] = {12, 12, 48};
    for (int which = 0; which < 3; which++) {
        const int  facets = facets_of[which];
        const bool smooth = which == 1;
        begin();
        for (int i = 0; i < facets; i++) {
            double   p[2][3], n[2][3], top[2][3];
            uint32_t v[2][2], cap[2][3];
            for (int k = 0; k < 2; k++) {
                const double angle = 2 * pi * (i + k) / facets, facing = smooth ? angle : 2 * pi * (i + 0.5) / facets;
                p[k][0] = top[k][0] = radius_m * cos(angle), p[k][1] = top[k][1] = radius_m * sin(angle);
                p[k][2] = 0, top[k][2] = 1;
                n[k][0] = cos(facing), n[k][1] = sin(facing), n[k][2] = 0;
                v[k][0] = add_vertex(p[k], n[k]);
                v[k][1] = add_vertex(top[k], n[k]);
                cap[0][k] = add_vertex(p[k], down);
                cap[1][k] = add_vertex(top[k], up);
            }
            cap[0][2] = add_vertex((const double[3]){0, 0, 0}, down);
            cap[1][2] = add_vertex((const double[3]){0, 0, 1}, up);
            add_triangle(v[0][0], v[1][0], v[1][1], 0);
            add_triangle(v[0][0], v[1][1], v[0][1], 0);
            add_triangle(cap[0][1], cap[0][0], cap[0][2], 0);
            add_triangle(cap[1][0], cap[1][1], cap[1][2], 0);
        }
        WedgeList list = find();
        CHECK(list.count == 2 * facets + (which == 0 ? facets : 0));
        CHECK_NEAR(total_length(&list, 1.5), 2 * facets * 2 * radius_m * sin(pi / facets), 1e-9);
        check_outward(&list, (const double[3]){0, 0, 0.5});
        wedges_destroy(&list);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box),       cmocka_unit_test(test_sheets),   cmocka_unit_test(test_concave),
        cmocka_unit_test(test_junctions), cmocka_unit_test(test_cylinder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
