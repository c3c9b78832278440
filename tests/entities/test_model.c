/* Poses, measures and the validator, on a cube with an arm whose answers are known on paper. */
#include "tests/check.h"

#include "entities/models/model.h"

/* A unit cube centred on the node's origin, as 12 triangles over 24 vertices (flat normals). */
static void put_cube(Model *m, int vertex, int triangle, int part)
{
    for (int face = 0; face < 6; face++) {
        const int    axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double side = face % 2 ? 0.5 : -0.5;
        const double corner[4][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
        const int    first = vertex + 4 * face;
        for (int k = 0; k < 4; k++) {
            double *p = m->vertex[first + k];
            p[axis] = side;
            p[u] = corner[k][0];
            p[v] = corner[k][1];
            memset(m->normal[first + k], 0, sizeof m->normal[0]);
            m->normal[first + k][axis] = side > 0 ? 1 : -1;
        }
        const uint32_t f = (uint32_t)first, up[2][3] = {{f, f + 1, f + 2}, {f, f + 2, f + 3}};
        for (int t = 0; t < 2; t++) {
            uint32_t *out = m->triangle[triangle + 2 * face + t];
            out[0] = up[t][0];
            out[1] = side > 0 ? up[t][1] : up[t][2];
            out[2] = side > 0 ? up[t][2] : up[t][1];
            m->triangle_part[triangle + 2 * face + t] = (uint16_t)part;
        }
    }
}

/* Base cube at the origin; a turntable 2 m above it that turns about z; an arm 3 m ahead of that which
 * elevates about y between -10 and 30 degrees and carries a cube; a slide along x on the arm, 0 .. 0.5 m. */
enum { base, table, arm, slide, nodes };

static Model make_model(void)
{
    Model m = {.node_count = nodes, .part_count = 3, .vertex_count = 72, .triangle_count = 36, .sag_m = 0.01};
    strcpy(m.name, "test");
    m.node = calloc(nodes, sizeof *m.node);
    m.part = calloc(3, sizeof *m.part);
    m.vertex = calloc(72, sizeof *m.vertex);
    m.normal = calloc(72, sizeof *m.normal);
    m.triangle = calloc(36, sizeof *m.triangle);
    m.triangle_part = calloc(36, sizeof *m.triangle_part);
    const int part_node[3] = {base, arm, slide};
    for (int i = 0; i < nodes; i++) {
        snprintf(m.node[i].name, sizeof m.node[i].name, "node%d", i);
        m.node[i].parent = i - 1;
        m.node[i].low = 1;
        m.node[i].high = -1;
        m3_identity(m.node[i].r_parent_from_node);
    }
    m.node[table].p_parent[2] = -2;
    m.node[table].joint = JOINT_ROTATION;
    m.node[table].axis[2] = 1;
    m.node[arm].p_parent[0] = 3;
    m.node[arm].joint = JOINT_ROTATION;
    m.node[arm].axis[1] = 1;
    m.node[arm].low = -10 * rad_per_deg;
    m.node[arm].high = 30 * rad_per_deg;
    m.node[slide].p_parent[0] = 4;
    m.node[slide].joint = JOINT_TRANSLATION;
    m.node[slide].axis[0] = 1;
    m.node[slide].low = 0;
    m.node[slide].high = 0.5;
    for (int i = 0; i < 3; i++) {
        snprintf(m.part[i].name, sizeof m.part[i].name, "part%d", i);
        strcpy(m.part[i].material, "steel_worn");
        m.part[i].node = part_node[i];
        m.part[i].first_triangle = 12 * i;
        m.part[i].triangle_count = 12;
        put_cube(&m, 24 * i, 12 * i, i);
    }
    model_measure(&m);
    return m;
}

static void check_point(const NodePose *pose, double x, double y, double z)
{
    CHECK_NEAR(pose->p_body[0], x, 1e-12);
    CHECK_NEAR(pose->p_body[1], y, 1e-12);
    CHECK_NEAR(pose->p_body[2], z, 1e-12);
}

static void poses_follow_the_chain(void **state)
{
    (void)state;
    Model    m = make_model();
    NodePose pose[nodes];
    double   value[nodes] = {0};
    model_pose(pose, &m, value);
    check_point(&pose[slide], 7, 0, -2);
    NodePose rest[nodes];
    model_pose(rest, &m, NULL);
    assert_memory_equal(rest, pose, sizeof pose);

    /* a quarter turn to the right: what was ahead is on +y */
    value[table] = 0.5 * pi_rad;
    model_pose(pose, &m, value);
    check_point(&pose[arm], 0, 3, -2);
    check_point(&pose[slide], 0, 7, -2);

    /* elevation lifts (z down): 4 m of arm at 30 degrees; the slide runs along the arm */
    value[table] = 0;
    value[arm] = 30 * rad_per_deg;
    value[slide] = 0.25;
    model_pose(pose, &m, value);
    check_point(&pose[slide], 3 + 4.25 * sqrt(0.75), 0, -2 - 4.25 * 0.5);

    /* limits, and what is not a number counts as nothing */
    value[arm] = 2;
    value[slide] = 7;
    model_pose(pose, &m, value);
    check_point(&pose[slide], 3 + 4.5 * sqrt(0.75), 0, -2 - 4.5 * 0.5);
    value[table] = NAN;
    value[arm] = -INFINITY;
    value[slide] = NAN;
    model_pose(pose, &m, value);
    check_point(&pose[slide], 7, 0, -2);
    model_destroy(&m);
}

/* r_parent_from_node is the rest attitude: the joint's axis is in the turned axes. */
static void rest_attitude_comes_before_the_joint(void **state)
{
    (void)state;
    Model        m = make_model();
    const double rolled[9] = {1, 0, 0, 0, 0, -1, 0, 1, 0}; /* node y is parent z */
    memcpy(m.node[table].r_parent_from_node, rolled, sizeof rolled);
    double   value[nodes] = {0, 0.5 * pi_rad, 0, 0};
    NodePose pose[nodes];
    model_pose(pose, &m, value);
    /* about node z, which is parent -y: x goes to node y, which is parent z */
    check_point(&pose[arm], 0, 0, 1);
    model_destroy(&m);
}

static void poses_stay_orthonormal(void **state)
{
    (void)state;
    Model m = make_model();
    for (int k = 0; k < 200; k++) {
        double   value[nodes], product[9];
        NodePose pose[nodes];
        for (int i = 0; i < nodes; i++) value[i] = 2000 * (random_uniform(7, 1, (uint32_t)k, (uint64_t)i) - 0.5);
        model_pose(pose, &m, value);
        for (int i = 0; i < nodes; i++) {
            m3_tmul(product, pose[i].r_body_from_node, pose[i].r_body_from_node);
            for (int e = 0; e < 9; e++) CHECK_NEAR(product[e], e % 4 == 0, 4e-15);
        }
    }
    model_destroy(&m);
}

static void measures_hold_every_pose(void **state)
{
    (void)state;
    Model m = make_model();
    CHECK_NEAR(m.box_low[0], -0.5, 0);
    CHECK_NEAR(m.box_high[0], 7.5, 1e-12);
    CHECK_NEAR(m.box_low[2], -2.5, 1e-12);
    CHECK_NEAR(m.length_m, 8, 1e-12);
    CHECK_NEAR(m.width_m, 1, 1e-12);
    CHECK_NEAR(m.height_m, 3, 1e-12);
    double most = 0;
    for (int k = 0; k < 4000; k++) {
        double   value[nodes] = {0};
        NodePose pose[nodes];
        value[table] = 7 * random_uniform(1, 2, (uint32_t)k, 0);
        value[arm] = k % 2 ? 1 : (random_uniform(1, 2, (uint32_t)k, 1) - 0.5);
        value[slide] = k % 3 ? 1 : random_uniform(1, 2, (uint32_t)k, 2);
        model_pose(pose, &m, value);
        for (int v = 0; v < m.vertex_count; v++) {
            const NodePose *at = &pose[m.part[v / 24].node];
            double          p[3];
            m3_mul_v3(p, at->r_body_from_node, m.vertex[v]);
            v3_add(p, p, at->p_body);
            most = fmax(most, v3_length(p));
        }
    }
    CHECK(most <= m.radius_m);
    CHECK(m.radius_m <= 1.06 * most);
    model_destroy(&m);
}

/* Two joints that turn freely about crossed axes, and one about a skew axis: still a bound. */
static void radius_holds_free_joints(void **state)
{
    (void)state;
    Model m = make_model();
    m.node[arm].low = 1;
    m.node[arm].high = -1;
    const double skew[3] = {0.6, 0, 0.8};
    memcpy(m.node[table].axis, skew, sizeof skew);
    model_measure(&m);
    double most = 0;
    for (int k = 0; k < 4000; k++) {
        double   value[nodes] = {0, 7 * random_uniform(3, 2, (uint32_t)k, 0), 7 * random_uniform(3, 2, (uint32_t)k, 1),
                                 0.5};
        NodePose pose[nodes];
        model_pose(pose, &m, value);
        for (int v = 48; v < 72; v++) {
            double p[3];
            m3_mul_v3(p, pose[slide].r_body_from_node, m.vertex[v]);
            v3_add(p, p, pose[slide].p_body);
            most = fmax(most, v3_length(p));
        }
    }
    CHECK(most <= m.radius_m);
    CHECK(m.radius_m <= 1.6 * most);
    model_destroy(&m);
}

/* ---- every gate can fail -------------------------------------------------------------------- */

static int  complaints;
static void count_complaint(void *user, LogLevel level, const char *line)
{
    (void)user;
    (void)line;
    complaints += level == LOG_ERROR;
}

typedef void Damage(Model *m);
static void  open_shell(Model *m) { memcpy(m->triangle[3], m->triangle[2], sizeof m->triangle[0]); }
static void  turn_triangle(Model *m)
{
    const uint32_t first = m->triangle[5][0];
    m->triangle[5][0] = m->triangle[5][1];
    m->triangle[5][1] = first;
}
static void turn_inside_out(Model *m)
{
    for (int t = 12; t < 24; t++) {
        const uint32_t first = m->triangle[t][0];
        m->triangle[t][0] = m->triangle[t][1];
        m->triangle[t][1] = first;
    }
}
static void crack(Model *m) { m->vertex[30][1] += 1e-15; }
static void pinch(Model *m) { memcpy(m->vertex[1], m->vertex[0], sizeof m->vertex[0]); }
static void nan_vertex(Model *m) { m->vertex[70][2] = NAN; }
static void long_normal(Model *m)
{
    m->normal[10][0] *= 1.0001f;
    m->normal[10][1] += 0.02f;
}
static void nan_normal(Model *m) { m->normal[10][0] = NAN; }
static void bad_index(Model *m) { m->triangle[35][2] = 72; }
static void child_first(Model *m) { m->node[arm].parent = slide; }
static void own_parent(Model *m) { m->node[arm].parent = arm; }
static void two_roots(Model *m) { m->node[arm].parent = -1; }
static void no_name(Model *m) { m->part[1].name[0] = 0; }
static void endless_name(Model *m) { memset(m->node[1].name, 'x', sizeof m->node[1].name); }
static void no_material(Model *m) { m->part[2].material[0] = 0; }
static void endless_model_name(Model *m) { memset(m->name, 'x', sizeof m->name); }
static void gap_in_triangles(Model *m)
{
    m->part[1].first_triangle++;
    m->part[1].triangle_count--;
}
static void too_few_in_parts(Model *m) { m->part_count = 2; }
static void too_many_in_part(Model *m) { m->part[2].triangle_count = 1 << 30; }
static void wrong_owner(Model *m) { m->triangle_part[20] = 2; }
static void part_of_nobody(Model *m) { m->part[0].node = nodes; }
static void scattered_parts(Model *m) { m->part[2].node = base; }
static void unknown_role(Model *m) { m->part[0].role = HEAT_ROLE_COUNT; }
static void long_axis(Model *m) { m->node[table].axis[2] = 1.001; }
static void mirrored_rest(Model *m) { m->node[table].r_parent_from_node[0] = -1; }
static void endless_slide(Model *m) { m->node[slide].high = -1; }
static void not_measured(Model *m) { m->radius_m = 0; }

static void validator_refuses_each_damage(void **state)
{
    (void)state;
    static Damage *const damage[] = {
        open_shell,
        turn_triangle,
        turn_inside_out,
        crack,
        pinch,
        nan_vertex,
        long_normal,
        nan_normal,
        bad_index,
        child_first,
        own_parent,
        two_roots,
        no_name,
        endless_name,
        no_material,
        endless_model_name,
        gap_in_triangles,
        too_few_in_parts,
        too_many_in_part,
        wrong_owner,
        part_of_nobody,
        scattered_parts,
        unknown_role,
        long_axis,
        mirrored_rest,
        endless_slide,
        not_measured,
    };
    log_set_sink(count_complaint, NULL);
    complaints = 0;
    Model        sound = make_model();
    const Status fine = model_validate(&sound);
    const int    after_sound = complaints;
    model_destroy(&sound);
    int       refused = 0, said = 0;
    const int count = (int)(sizeof damage / sizeof damage[0]);
    for (int i = 0; i < count; i++) {
        Model m = make_model();
        damage[i](&m);
        complaints = 0;
        if (model_validate(&m) == STATUS_BAD_VALUE) refused++;
        else printf("damage %d was not refused\n", i);
        said += complaints == 1;
        model_destroy(&m);
    }
    log_set_sink(NULL, NULL);
    CHECK(fine == STATUS_OK && after_sound == 0);
    assert_int_equal(refused, count);
    assert_int_equal(said, count);
}

static void destroy_zeroes(void **state)
{
    (void)state;
    const Model nothing = {0};
    Model       m = make_model();
    model_destroy(&m);
    assert_memory_equal(&m, &nothing, sizeof m);
    model_destroy(&m);
}

static void roles_have_distinct_names(void **state)
{
    (void)state;
    for (int i = 0; i < HEAT_ROLE_COUNT; i++)
        for (int k = 0; k < i; k++) assert_string_not_equal(heat_role_name((HeatRole)i), heat_role_name((HeatRole)k));
    assert_string_equal(heat_role_name(HEAT_ROLE_COUNT), "?");
    assert_string_equal(heat_role_name(HEAT_ENGINE_DECK), "engine_deck");
}

/* ---- another size ---------------------------------------------------------------------------------- */

/* From 8 x 1 x 3 m to 16 x 3 x 1.5 m: factors 2, 3 and 0.5 along the axes. Pivots and vertices scale by their axis, the
 * way of a slide by that of its own, angles and unit axes not at all. */
static void joints_scale_with_a_model(void **state)
{
    (void)state;
    Model m = make_model();
    m.node[slide].dis_scale = 0.4;
    m.node[slide].value_slow = 0.1;
    m.node[arm].dis_scale = 0.7;
    m.node[arm].value_slow = 0.2;
    CHECK(model_resize(&m, &(ModelSize){16, 3, 1.5}) == STATUS_OK);
    CHECK_NEAR(m.length_m, 16, 1e-12);
    CHECK_NEAR(m.width_m, 3, 1e-12);
    CHECK_NEAR(m.height_m, 1.5, 1e-12);
    CHECK_NEAR(m.node[table].p_parent[2], -1, 1e-12);
    CHECK_NEAR(m.node[arm].p_parent[0], 6, 1e-12);
    CHECK_NEAR(m.node[slide].p_parent[0], 8, 1e-12);
    CHECK_NEAR(m.node[slide].low, 0, 0);
    CHECK_NEAR(m.node[slide].high, 1, 1e-12);
    CHECK_NEAR(m.node[slide].dis_scale, 0.8, 1e-12);
    CHECK_NEAR(m.node[slide].value_slow, 0.2, 1e-12);
    CHECK_NEAR(m.node[arm].low, -10 * rad_per_deg, 1e-12);
    CHECK_NEAR(m.node[arm].high, 30 * rad_per_deg, 1e-12);
    CHECK(m.node[arm].dis_scale == 0.7 && m.node[arm].value_slow == 0.2 && m.node[arm].axis[1] == 1);
    for (int v = 0; v < m.vertex_count; v++) {
        CHECK_NEAR(fabs(m.vertex[v][0]), 1, 1e-12);
        CHECK_NEAR(fabs(m.vertex[v][1]), 1.5, 1e-12);
        CHECK_NEAR(fabs(m.vertex[v][2]), 0.25, 1e-12);
    }
    model_destroy(&m);

    /* what rolls and what spins: twice the size has twice the radius, and the same rate. One figure scales all axes. */
    for (int open = 0; open < 2; open++) {
        m = make_model();
        m.node[arm].roll_radius_m = 0.4;
        m.node[table].spin_rps_moving = 30;
        CHECK(model_resize(&m, &(ModelSize){open ? 0 : 16, open ? 2 : 2, open ? 0 : 6}) == STATUS_OK);
        CHECK_NEAR(m.node[arm].roll_radius_m, 0.8, 1e-12);
        CHECK_NEAR(m.node[arm].p_parent[0], 6, 1e-12);
        CHECK(m.node[table].spin_rps_moving == 30);
        for (int v = 0; v < m.vertex_count; v++)
            for (int k = 0; k < 3; k++) CHECK_NEAR(fabs(m.vertex[v][k]), 1, 1e-12);
        model_destroy(&m);
    }
    /* factors of 0.02 .. 50 */
    static const struct {
        double length_m;
        Status status;
    } c[] = {
        {8 * 49.9, STATUS_OK}, {8 * 50.1, STATUS_BAD_VALUE}, {8 * 0.0201, STATUS_OK}, {8 * 0.0199, STATUS_BAD_VALUE}};
    for (int i = 0; i < 4; i++) {
        m = make_model();
        CHECK(model_resize(&m, &(ModelSize){c[i].length_m, 0, 0}) == c[i].status);
        model_destroy(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(poses_follow_the_chain),
        cmocka_unit_test(rest_attitude_comes_before_the_joint),
        cmocka_unit_test(poses_stay_orthonormal),
        cmocka_unit_test(measures_hold_every_pose),
        cmocka_unit_test(radius_holds_free_joints),
        cmocka_unit_test(validator_refuses_each_damage),
        cmocka_unit_test(destroy_zeroes),
        cmocka_unit_test(roles_have_distinct_names),
        cmocka_unit_test(joints_scale_with_a_model),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
