/* Flat faces of bodies: which are summed in closed form, and which are left to ray tubes as something hides them.
 * labels: physics */
#include "tests/render/polygon_stage.h"

/* A box about the origin; sides: 6, or 5 for one that is open at the top. */
static void build_box(Model *m, const double half[3], int sides)
{
    hand_model(m, 1, 24, 12);
    m->node[0].parent = -1;
    for (int f = 0; f < sides; f++) {
        const int axis = f / 2, u = (axis + 1) % 3, v = (axis + 2) % 3, sign = f % 2 ? -1 : 1;
        double    p[4][3];
        for (int k = 0; k < 4; k++) {
            p[k][axis] = sign * half[axis];
            p[k][u] = (k == 1 || k == 2 ? 1 : -1) * sign * half[u];
            p[k][v] = (k >= 2 ? 1 : -1) * half[v];
        }
        put_quad(m, 0, p);
    }
}

/* ---- bodies -------------------------------------------------------------------------------------------- */

/* A box is seen on up to three sides, and no tube is shot; an open one and a pair of plates need tubes. */
static void a_box_needs_no_tubes(void **state)
{
    (void)state;
    static const double half[3] = {0.25, 0.15, 0.2};
    RadarStage          s = {0};
    double              off[2] = {0}, whole = 0;
    build_box(&s.model, half, 6);
    open_model(&s, x_hz);
    CHECK(s.target->faces.count == 6 && s.target->faces.convex);
    for (int i = 0; i < 6; i++) {
        const ScatterAntenna a = antenna_at(60 * i + 3, 6 * (i % 5) - 12, i % 2 ? 40 : INFINITY);
        const ScatterMatrix  on = look(&s, &a, &a, polygon_faces_few);
        CHECK(field.polygons.all && field.hits.rays == 0);
        const TubeConfig    used = s.config;
        const ScatterMatrix tubes = look(&s, &a, &a, 0);
        s.config.splits = 5;
        s.config.cuts_per_radius = 1e5;
        s.config.rays_per_radius *= 2;
        const ScatterMatrix fine = look(&s, &a, &a, 0);
        s.config = used;
        off[0] += power_apart(&tubes, &fine);
        off[1] += power_apart(&on, &fine);
        whole += scatter_power(fine.hh) + scatter_power(fine.vv);
    }
    printf("box: tubes %.1f dB of the power from a fine grid, closed form %.1f dB\n", decibels(off[0] / whole),
           decibels(off[1] / whole));
    CHECK(off[1] <= 1e-4 * whole && off[1] < 0.2 * off[0]);
    close_stage(&s);

    s = (RadarStage){0};
    build_box(&s.model, half, 5);
    open_model(&s, x_hz);
    const ScatterAntenna a = antenna_at(20, 10, INFINITY);
    CHECK(s.target->faces.count == 5 && !s.target->faces.convex);
    look(&s, &a, &a, polygon_faces_few);
    CHECK(!field.polygons.all && field.hits.rays > 0 && field.polygons.count == 4); /* two sides, no lid */
    close_stage(&s);
}

/* Behind a smaller plate a plate is left to tubes, whole; the smaller one is not. */
static void a_hidden_face_is_left_to_tubes(void **state)
{
    (void)state;
    RadarStage s = {0};
    double     off[2] = {0}, whole = 0;
    hand_model(&s.model, 2, 8, 4);
    s.model.node[0].parent = -1;
    put_plate(&s.model, 0, 0, 0, 0.4, 0.3);
    put_plate(&s.model, 1, 0.3, 0.05, 0.12, 0.1);
    open_model(&s, x_hz);
    CHECK(s.target->faces.count == 2 && !s.target->faces.convex);
    for (int i = 0; i < 8; i++) {
        const ScatterAntenna tx = antenna_at(2 * i - 7, 1.5 * i - 6, 60), rx = antenna_at(2 * i + 3, 1.5 * i, 60);
        const ScatterMatrix  on = look(&s, &tx, i % 2 ? &rx : &tx, polygon_faces_few);
        CHECK(field.polygons.count > 0 && field.polygons.whole[2] && field.polygons.whole[3]);
        CHECK(!field.polygons.whole[0] && !field.polygons.whole[1] && field.hits.count > 0);
        const ScatterMatrix tubes = look(&s, &tx, i % 2 ? &rx : &tx, 0);
        const TubeConfig    used = s.config;
        s.config.splits = 5;
        s.config.cuts_per_radius = 1e5;
        const ScatterMatrix fine = look(&s, &tx, i % 2 ? &rx : &tx, 0);
        s.config = used;
        off[0] += power_apart(&tubes, &fine);
        off[1] += power_apart(&on, &fine);
        whole += scatter_power(fine.hh) + scatter_power(fine.vv);
    }
    printf("plate behind a plate: tubes %.1f dB of the power from a fine grid, one in closed form %.1f dB\n",
           decibels(off[0] / whole), decibels(off[1] / whole));
    CHECK(off[1] <= 1e-6 * whole);

    /* the hole that the ray test cannot miss: a strip thinner than its spacing, across the plate */
    const ScatterAntenna ahead = antenna_at(0, 0, INFINITY);
    look(&s, &ahead, &ahead, polygon_faces_few);
    CHECK(!field.polygons.whole[0]);
    close_stage(&s);
    s = (RadarStage){0};
    hand_model(&s.model, 2, 8, 4);
    s.model.node[0].parent = -1;
    put_plate(&s.model, 0, 0, 0, 0.4, 0.3);
    put_plate(&s.model, 1, 0.2, 0.013, 8e-4, 0.5);
    open_model(&s, x_hz);
    look(&s, &ahead, &ahead, polygon_faces_few);
    CHECK(!field.polygons.whole[0]);
    close_stage(&s);
}

/* Two sheets that coincide radiate once. */
static void sheets_that_coincide_count_once(void **state)
{
    (void)state;
    RadarStage s = {0};
    hand_model(&s.model, 2, 8, 4);
    s.model.node[0].parent = -1;
    put_plate(&s.model, 0, 0, 0, 0.4, 0.3);
    put_plate(&s.model, 1, 0, 0.1, 0.4, 0.2);
    open_model(&s, x_hz);
    const ScatterAntenna a = antenna_at(0, 0, INFINITY);
    const ScatterMatrix  on = look(&s, &a, &a, polygon_faces_few), off = look(&s, &a, &a, 0);
    CHECK(power_apart(&on, &off) <= 1e-5 * scatter_power(off.hh));
    close_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_needs_no_tubes),
        cmocka_unit_test(a_hidden_face_is_left_to_tubes),
        cmocka_unit_test(sheets_that_coincide_count_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
