/* Patches of every built-in model against the model itself, and of shapes with known areas, borders and values.
 *
 * A coarse build (sag 0.1 m) and a fine one (0.002 m) have the same bodies; the same count of patches but for a few
 * models, where a cell is near the share below which it joins another. Links may differ where cells of curved parts
 * hardly touch, or several patches are as near. labels: physics */
#include "tests/entities/model_fixture.h"

#include "entities/models/patches.h"

#include <stdio.h>
#include <stdlib.h>

static Patches cut(const Model *m)
{
    Patches p = {0};
    CHECK(patches_create(&p, m) == STATUS_OK);
    return p;
}

static double triangle_m2(double n[3], const double p[3][3])
{
    double one[3], other[3];
    v3_sub(one, p[1], p[0]);
    v3_sub(other, p[2], p[0]);
    v3_cross(n, one, other);
    const double twice = v3_length(n);
    v3_normalize(n, n);
    return 0.5 * twice;
}

static void corners_of(double p[3][3], const Model *m, int triangle)
{
    for (int k = 0; k < 3; k++) memcpy(p[k], m->vertex[m->triangle[triangle][k]], sizeof p[k]);
}

/* Whether a point is inside one triangle of the body, with that normal. */
static bool is_on(const Model *m, const Patches *s, int body, const double at[3], const double n_at[3])
{
    for (int t = 0; t < m->triangle_count; t++) {
        double p[3][3], n[3], d[3];
        if (s->body_of_part[m->triangle_part[t]] != body) continue;
        corners_of(p, m, t);
        triangle_m2(n, (const double(*)[3])p);
        v3_sub(d, at, p[0]);
        if (!(v3_dot(n, n_at) > 1 - 1e-9) || fabs(v3_dot(d, n)) > 1e-7) continue;
        bool inside = true;
        for (int k = 0; k < 3; k++) {
            double edge[3], to[3], side[3];
            v3_sub(edge, p[(k + 1) % 3], p[k]);
            v3_sub(to, at, p[k]);
            v3_cross(side, edge, to);
            inside &= v3_dot(side, n) > -1e-9;
        }
        if (inside) return true;
    }
    return false;
}

static void check_patches(const Model *m, const Patches *s)
{
    CHECK(s->count >= 1 && s->count <= patches_most && s->parts == m->part_count);
    CHECK(s->first_of_body[0] == 0 && s->first_of_body[s->bodies] == s->count);
    double area = 0, truth = 0;
    for (int t = 0; t < m->triangle_count; t++) {
        double p[3][3], n[3];
        corners_of(p, m, t);
        truth += triangle_m2(n, (const double(*)[3])p);
    }
    for (int i = 0; i < s->count; i++) {
        const Patch *p = &s->patch[i];
        area += p->area_m2;
        CHECK(p->area_m2 > 0 && p->reach_m > 0 && p->facing >= 0 && p->facing <= 1);
        CHECK_NEAR(v3_length(p->n_node), 1, 1e-9);
        CHECK(p->role == m->part[p->part].role);
        for (int k = 0; k < patch_points; k++) CHECK_NEAR(v3_length(p->point_n_node[k]), 1, 1e-9);
    }
    CHECK_NEAR(area / truth, 1, 1e-9);
    for (int b = 0; b < s->bodies; b++) CHECK(s->first_of_body[b] < s->first_of_body[b + 1]);
    for (int i = 0; i < m->part_count; i++) {
        CHECK(s->body_of_part[i] >= 0 && s->body_of_part[i] < s->bodies);
        CHECK(s->patch[s->first_of_body[s->body_of_part[i]]].role == m->part[i].role);
    }
    int group[patches_most], groups = s->count;
    for (int i = 0; i < s->count; i++) group[i] = i;
    for (int i = 0; i < s->links; i++) {
        const PatchLink *l = &s->link[i];
        CHECK(l->a >= 0 && l->a < l->b && l->b < s->count && l->length_m > 0 && l->distance_m >= 0.02);
        CHECK(i == 0 || l[-1].a < l->a || (l[-1].a == l->a && l[-1].b < l->b));
        const int from = group[l->b], to = group[l->a];
        groups -= from != to;
        for (int k = 0; k < s->count; k++)
            if (group[k] == from) group[k] = to;
    }
    /* one piece, but for bodies that touch nothing */
    int alone = 0;
    for (int b = 0; b < s->bodies; b++) {
        bool own = true;
        for (int k = 0; k < s->count; k++)
            own &=
                (group[k] == group[s->first_of_body[b]]) == (k >= s->first_of_body[b] && k < s->first_of_body[b + 1]);
        alone += own;
    }
    CHECK(groups == 1 || groups <= alone + 1);
}

static void every_model_is_cut(void **state)
{
    (void)state;
    for (int i = 0; i < parametric_count(); i++) {
        Model   coarse = build(parametric_name(i), 0.1), fine = build(parametric_name(i), 0.002);
        Patches a = cut(&coarse), b = cut(&fine);
        check_patches(&coarse, &a);
        check_patches(&fine, &b);
        CHECK(a.bodies == b.bodies && b.count >= 4);
        for (int k = 0; k < a.count; k++)
            for (int j = 0; j < patch_points; j++)
                CHECK(a.body_of_node || is_on(&coarse, &a, a.body_of_part[a.patch[k].part], a.patch[k].point_node[j],
                                              a.patch[k].point_n_node[j]));
        float value[patches_most];
        for (int k = 0; k < a.count; k++) value[k] = 287.65f;
        for (int k = 0; k < a.count; k++)
            CHECK(patches_value(&a, value, a.patch[k].part, a.patch[k].p_node, a.patch[k].n_node) == (double)value[0]);
        patches_destroy(&a);
        patches_destroy(&b);
        model_destroy(&coarse);
        model_destroy(&fine);
    }
}

static MeshBuilder *begin(void)
{
    MeshBuilder *b = mesh_builder_create("shape", 0.005);
    CHECK(b != NULL);
    mesh_node(b, "hull", -1, 0, 0, 0);
    return b;
}

static Model finish(MeshBuilder *b)
{
    Model m = {0};
    CHECK(mesh_builder_finish(&m, b) == STATUS_OK);
    return m;
}

/* 6 m by 2 m by 1 m: four lengths of each side, and two ends. Borders: 2 m and 1 m across, 1.5 m along. */
static void a_long_box(void **state)
{
    (void)state;
    MeshBuilder *b = begin();
    mesh_part(b, 0, "box", "steel_worn", HEAT_HULL);
    mesh_box(b, place_at(0, 0, 0), -3, -1, -1, 3, 1, 0);
    Model   m = finish(b);
    Patches s = cut(&m);
    check_patches(&m, &s);
    assert_int_equal(s.count, 18);
    assert_int_equal(s.links, 4 * 3 + 4 * 4 + 2 * 4);
    float value[18];
    for (int i = 0; i < 18; i++) {
        const bool end = fabs(s.patch[i].n_node[0]) > 0.5, flat = fabs(s.patch[i].n_node[2]) > 0.5;
        CHECK_NEAR(s.patch[i].area_m2, end ? 2 : flat ? 3 : 1.5, 1e-9);
        CHECK_NEAR(s.patch[i].reach_m, end ? sqrt(5 / 12.0) : sqrt((2.25 + (flat ? 4 : 1)) / 12), 1e-9);
        value[i] = (float)s.patch[i].p_node[0];
    }
    for (int i = 0; i < s.links; i++) {
        const Patch *p = &s.patch[s.link[i].a], *q = &s.patch[s.link[i].b];
        const bool   side = fabs(p->n_node[1]) > 0.5 || fabs(q->n_node[1]) > 0.5;
        const bool   across = v3_dot(p->n_node, q->n_node) > 0.5 || fabs(p->n_node[0]) > 0.5;
        CHECK(!s.link[i].joint);
        CHECK_NEAR(s.link[i].length_m, across ? side ? 1 : 2 : 1.5, 1e-6);
    }
    /* between the middles of the outer patches: within a third of a length */
    double worst = 0, last = -INFINITY;
    for (double x = -2.25; x <= 2.25; x += 0.01) {
        const double got = patches_value(&s, value, 0, (double[3]){x, 0, -1}, (double[3]){0, 0, -1});
        worst = fmax(worst, fabs(got - x));
        CHECK(got > last && (x < -2.245 || got - last < 0.05));
        last = got;
    }
    CHECK(worst < 0.5);
    /* a patch's own middle: others that face elsewhere have no weight */
    for (int i = 0; i < 18; i++) {
        float one[18] = {0};
        one[i] = 1;
        CHECK(patches_value(&s, one, 0, s.patch[i].p_node, s.patch[i].n_node) > 0.75);
    }
    CHECK(patches_value(&s, value, -1, s.patch[0].p_node, s.patch[0].n_node) == (double)value[0]);
    CHECK(patches_value(&s, value, 1, s.patch[0].p_node, s.patch[0].n_node) == (double)value[0]);
    const double nowhere[3] = {NAN, 0, 0};
    CHECK(fabs(patches_value(&s, value, 0, nowhere, nowhere)) <= 3);
    patches_destroy(&s);
    patches_destroy(&s);
    model_destroy(&m);
}

static void a_wheel_has_three(void **state)
{
    (void)state;
    MeshBuilder *b = begin();
    mesh_part(b, 0, "axle", "steel_worn", HEAT_HULL);
    mesh_box(b, place_at(0, 0, 0), -0.1, -0.5, -0.1, 0.1, 0.5, 0.1);
    const int node = mesh_node(b, "wheel", 0, 0, 0.6, 0);
    mesh_joint(b, node, 0, -1, 0, 0, 0, 1, -1);
    mesh_node_get(b, node)->roll_radius_m = 0.5;
    mesh_part(b, node, "tyre", "rubber_black", HEAT_WHEEL);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 1, 0), -0.1, 0.1, 0.5);
    Model   m = finish(b);
    Patches s = cut(&m);
    check_patches(&m, &s);
    assert_int_equal(s.bodies, 2);
    assert_int_equal(s.first_of_body[2] - s.first_of_body[1], 3);
    const Patch *w = &s.patch[s.first_of_body[1]];
    CHECK_NEAR(w[0].n_node[1], -1, 1e-9);
    CHECK_NEAR(w[1].n_node[1], 1, 1e-9);
    CHECK(w[2].facing < 1e-9);
    CHECK_NEAR(w[0].area_m2, pi_rad * 0.25, 0.02);
    CHECK_NEAR(w[2].area_m2, 2 * pi_rad * 0.5 * 0.2, 0.02);
    patches_destroy(&s);
    model_destroy(&m);
}

/* A tyre of 0.5 m on the ground: what is lower than 2 cm is 0.28 m long and as wide as the tyre. */
static void a_tyre_stands_on_its_print(void **state)
{
    (void)state;
    MeshBuilder *b = begin();
    const int    node = mesh_node(b, "wheel", 0, 0, 0, -0.5);
    mesh_joint(b, node, 0, -1, 0, 0, 0, 1, -1);
    mesh_node_get(b, node)->roll_radius_m = 0.5;
    mesh_part(b, 0, "axle", "steel_worn", HEAT_HULL);
    mesh_box(b, place_at(0, 0, -0.5), -0.1, -0.5, -0.1, 0.1, 0.5, 0.1);
    mesh_part(b, node, "tyre", "rubber_black", HEAT_WHEEL);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 1, 0), 0.2, 0.5, 0.5);
    Model   m = finish(b);
    Patches s = cut(&m);
    double  ground_m2 = 0;
    for (int i = 0; i < s.count; i++) ground_m2 += s.patch[i].ground_m2;
    CHECK_NEAR(ground_m2 / (0.3 * 2 * 0.5 * acos(0.48 / 0.5)), 1, 0.15); /* facets lie within 5 mm of the round */
    patches_destroy(&s);
    model_destroy(&m);
}

/* 2000 parts; on one node, or on 200, of 50 materials and several roles. */
static void many_parts_stay_within_the_limit(void **state)
{
    (void)state;
    for (int nodes = 1; nodes <= 200; nodes += 199) {
        MeshBuilder *b = begin();
        for (int i = 0; i < 2000; i++) {
            const int node = nodes == 1 || i % 10 ? i / 10 % nodes : i == 0 ? 0 : mesh_node(b, "n", 0, i, 0, 0);
            char      material[32];
            snprintf(material, sizeof material, "material_%d", i % 50);
            mesh_part(b, node, "part", material, (HeatRole)(i % 4));
            mesh_box(b, place_at(i % 40, i / 40, 0), 0, 0, -1, 1, 1, 0);
        }
        Model   m = finish(b);
        Patches s = cut(&m);
        check_patches(&m, &s);
        CHECK((s.body_of_node != NULL) == (nodes > 1));
        float value[patches_most];
        for (int i = 0; i < s.count; i++) value[i] = 1.25f;
        CHECK(patches_value(&s, value, 1999, (double[3]){0, 0, 0}, (double[3]){0, 0, 1}) == 1.25);
        patches_destroy(&s);
        model_destroy(&m);
    }
}

/* ---- what lies inside ------------------------------------------------------------------------------ */

static double open_m2(const Patches *s)
{
    double sum = 0;
    for (int i = 0; i < s->count; i++) {
        sum += patch_open_m2(&s->patch[i]);
        CHECK(s->patch[i].open_share >= 0 && s->patch[i].open_share <= 1);
    }
    return sum;
}

/* Two boxes that share a face are a longer box: its faces alone are outside, means and blends take nothing from the
 * inner ones, and no ray starts from these. */
static void glued_boxes_are_one(void **state)
{
    (void)state;
    MeshBuilder *b = begin();
    mesh_part(b, 0, "fore", "steel_worn", HEAT_HULL);
    mesh_box(b, place_at(0, 0, 0), 0, -1, -1, 3, 1, 0);
    mesh_part(b, 0, "aft", "paint_olive", HEAT_HULL);
    mesh_box(b, place_at(0, 0, 0), -2, -1, -1, 0, 1, 0);
    Model   m = finish(b);
    Patches s = cut(&m);
    check_patches(&m, &s);
    CHECK_NEAR(open_m2(&s), 2 * (5 * 2 + 5 * 1 + 2 * 1), 1e-9);
    float  value[patches_most];
    double mean = 0;
    int    inner = 0;
    for (int i = 0; i < s.count; i++) {
        const Patch *p = &s.patch[i];
        CHECK(p->open_share == 0 || p->open_share == 1);
        inner += p->open_share == 0;
        value[i] = p->open_share == 0 ? 1000 : 300; /* the inner ones hot */
        mean += patch_open_m2(p) * (double)value[i] / open_m2(&s);
        CHECK(p->open_share == 1 || (fabs(p->p_node[0]) < 1e-9 && fabs(fabs(p->n_node[0]) - 1) < 1e-9));
        for (int k = 0; k < patch_points; k++) CHECK(p->open_share == 0 || fabs(p->point_node[k][0]) > 1e-6);
        CHECK_NEAR(p->ground_m2, p->n_node[2] > 0.5 ? p->area_m2 : 0,
                   1e-9); /* the underside alone stands on the ground */
    }
    assert_int_equal(inner, 2);
    CHECK_NEAR(mean, 300, 1e-9);
    for (double x = -1.9; x < 2.9; x += 0.1)
        CHECK(patches_value(&s, value, x < 0, (double[3]){x, 0.3, -1}, (double[3]){0, 0, -1}) == 300);
    patches_destroy(&s);
    model_destroy(&m);
}

/* A block on a larger one: its base, and of the larger one's top as much, are inside; points of the top avoid it. On
 * a joint, what is so in every pose. */
static void a_block_covers_what_it_stands_on(void **state)
{
    (void)state;
    for (int moves = 0; moves < 3; moves++) { /* the same node; a node that is fixed; one that turns */
        MeshBuilder *b = begin();
        mesh_part(b, 0, "base", "steel_worn", HEAT_HULL);
        mesh_box(b, place_at(0, 0, 0), -2, -2, -1, 2, 2, 0);
        const int node = moves ? mesh_node(b, "upper", 0, 0, 0, 0) : 0;
        if (moves == 2) mesh_joint(b, node, 0, 0, -1, 0, 0, 1, -1);
        mesh_part(b, node, "block", "steel_worn", HEAT_TURRET);
        mesh_box(b, place_at(0, 0, 0), -1, -1.5, -2, 1, 1.5, -1);
        Model   m = finish(b);
        Patches s = cut(&m);
        check_patches(&m, &s);
        const double all = 2 * 16 + 16 + 2 * 6 + 10, octagon = 8 * tan(pi_rad / 8);
        /* that turns: its own base always, and of the top what rectangles at every 45 degrees have in common */
        CHECK_NEAR(open_m2(&s) / (all - 6 - (moves == 2 ? octagon : 6)), 1, 0.005);
        for (int i = 0; i < s.count; i++)
            for (int k = 0; k < patch_points; k++) {
                const double *p = s.patch[i].point_node[k];
                CHECK(moves == 2 || s.patch[i].open_share == 0 || fabs(p[2] + 1) > 1e-9 || fabs(p[0]) > 1 ||
                      fabs(p[1]) > 1.5);
            }
        patches_destroy(&s);
        model_destroy(&m);
    }
}

/* A box without its lid, and a sheet within: every face is before or behind an opening. */
static void open_shells_hide_nothing(void **state)
{
    (void)state;
    double(*vertex)[3] = calloc(12, sizeof *vertex);
    float(*normal)[3] = calloc(12, sizeof *normal);
    static const uint32_t sides[][3] = {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7},  {2, 7, 6},
                                        {3, 0, 4}, {3, 4, 7}, {4, 5, 6}, {4, 6, 7}, {8, 9, 10}, {8, 10, 11}};
    static const int      triangles = sizeof sides / sizeof *sides;
    for (int v = 0; v < 12; v++) { /* the first four above, the next four the floor, then a sheet at half height */
        const double size = v < 8 ? 1 : 0.5;
        vertex[v][0] = size * ((v + 1) / 2 % 2 ? 1 : -1), vertex[v][1] = size * (v / 2 % 2 ? 1 : -1);
        vertex[v][2] = v < 4 ? -1 : v < 8 ? 0 : -0.5;
        normal[v][2] = -1;
    }
    Model m = {.name = "shell",
               .node_count = 1,
               .part_count = 1,
               .vertex_count = 12,
               .triangle_count = triangles,
               .vertex = vertex,
               .normal = normal};
    m.node = calloc(1, sizeof *m.node), m.part = calloc(1, sizeof *m.part);
    m.triangle = calloc((size_t)triangles, sizeof *m.triangle),
    m.triangle_part = calloc((size_t)triangles, sizeof *m.triangle_part);
    strcpy(m.node[0].name, "hull"), m.node[0].parent = -1, m3_identity(m.node[0].r_parent_from_node);
    strcpy(m.part[0].name, "shell"), strcpy(m.part[0].material, "steel_worn"), m.part[0].triangle_count = triangles;
    for (int way = 0; way < 2; way++) { /* as it is, and inside out */
        for (int t = 0; t < triangles; t++)
            for (int k = 0; k < 3; k++) m.triangle[t][k] = sides[t][way ? 2 - k : k];
        Patches s = cut(&m);
        for (int i = 0; i < s.count; i++) CHECK(s.patch[i].open_share == 1);
        patches_destroy(&s);
    }
    model_destroy(&m);
}

static bool is_fixed(const Model *m, int node)
{
    while (node > 0 && m->node[node].joint == JOINT_FIXED) node = m->node[node].parent;
    return node == 0;
}

/* Surface of the union of a model's parts of node 0 (and what is fixed to it) by the formula of Crofton: over all
 * lines of a sphere, twice its great circle's area times the mean number of times that a line goes in or out of the
 * union. */
static double union_m2(const Model *m, int lines)
{
    double    sum = 0, centre[3], radius = 0;
    NodePose *pose = calloc((size_t)m->node_count, sizeof *pose);
    double(*corner)[3][3] = calloc((size_t)m->triangle_count, sizeof *corner),
    *reach = calloc((size_t)m->triangle_count, sizeof *reach);
    int count = 0;
    model_pose(pose, m, NULL);
    for (int t = 0; t < m->triangle_count; t++) {
        const int node = m->part[m->triangle_part[t]].node;
        if (!is_fixed(m, node)) continue;
        corners_of(corner[count], m, t);
        for (int k = 0; k < 3; k++) {
            double p[3];
            m3_mul_v3(p, pose[node].r_body_from_node, corner[count][k]);
            v3_add(corner[count][k], p, pose[node].p_body);
            v3_sub(p, corner[count][k], corner[count][0]);
            reach[count] = fmax(reach[count], v3_dot(p, p));
        }
        count++;
    }
    for (int i = 0; i < 3; i++)
        centre[i] = 0.5 * (m->box_low[i] + m->box_high[i]), radius += pow(0.5 * (m->box_high[i] - m->box_low[i]), 2);
    radius = sqrt(radius);
    for (int line = 0; line < lines; line++) {
        /* directions by a spiral of equal areas, places on the disc by another */
        const double z = 1 - (line + 0.5) / lines, turn = 2.399963229728653 * line, flat = sqrt(1 - z * z);
        const double d[3] = {flat * cos(turn), flat * sin(turn), z}, pole[3] = {fabs(d[0]) < 0.5, fabs(d[0]) >= 0.5, 0};
        const double r = radius * sqrt(fmod(0.5 + line * 0.7548776662466927, 1)),
                     at = 2 * pi_rad * fmod(0.5 + line * 0.5698402909980532, 1);
        double u[3], v[3], o[3], far[256];
        int    way[256], hits = 0;
        v3_cross(u, d, pole), v3_normalize(u, u), v3_cross(v, d, u);
        v3_add_scaled(o, centre, r * cos(at), u), v3_add_scaled(o, o, r * sin(at), v);
        for (int t = 0; t < count && hits < 256; t++) { /* Moeller and Trumbore */
            double e1[3], e2[3], h[3], s[3], q[3];
            v3_sub(s, o, corner[t][0]);
            const double along = v3_dot(s, d);
            if (v3_dot(s, s) - along * along > reach[t] * (1 + 1e-9)) continue;
            v3_sub(e1, corner[t][1], corner[t][0]), v3_sub(e2, corner[t][2], corner[t][0]);
            v3_cross(h, d, e2);
            const double det = v3_dot(e1, h);
            if (det == 0) continue;
            const double a = v3_dot(s, h) / det;
            v3_cross(q, s, e1);
            const double b = v3_dot(d, q) / det;
            if (a < 0 || b < 0 || a + b > 1) continue;
            int          k = hits++;
            const double here = v3_dot(e2, q) / det;
            for (; k > 0 && far[k - 1] > here; k--) far[k] = far[k - 1], way[k] = way[k - 1];
            far[k] = here, way[k] = det > 0 ? 1 : -1; /* into it */
        }
        /* crossings nearer than what parts are welded by are one */
        for (int k = 0, depth = 0; k < hits;) {
            const int before = depth;
            for (const double here = far[k]; k < hits && far[k] - here < 1e-3; k++) depth += way[k];
            sum += (before > 0) != (depth > 0);
        }
    }
    free(pose), free(corner), free(reach);
    return 2 * pi_rad * radius * radius * sum / lines;
}

/* Outer surface of a ship's hull and upper works, built of closed slices, and of others, against lines. */
static void the_outside_of_models(void **state)
{
    (void)state;
    for (int i = 0; i < parametric_count(); i++) {
        Model   m = build(parametric_name(i), 0.02);
        Patches s = cut(&m);
        double  all = 0;
        for (int k = 0; k < s.count; k++) all += s.patch[k].area_m2;
        print_message("%-22s outside %8.2f of %8.2f m2: %.3f\n", parametric_name(i), open_m2(&s), all,
                      open_m2(&s) / all);
        CHECK(open_m2(&s) > 0.15 * all && open_m2(&s) <= all * (1 + 1e-9));
        patches_destroy(&s);
        model_destroy(&m);
    }
    static const char *const held[] = {"ship", "truck", "building"};
    for (size_t i = 0; i < sizeof held / sizeof *held; i++) {
        Model        m = build(held[i], 0.1);
        Patches      s = cut(&m);
        const double want = union_m2(&m, 30000);
        double       got = 0;
        for (int k = 0; k < s.count; k++) got += is_fixed(&m, s.patch[k].node) ? patch_open_m2(&s.patch[k]) : 0;
        print_message("%s: %.1f m2 outside, by lines %.1f m2: %.3f\n", held[i], got, want, got / want);
        CHECK_NEAR(got / want, 1, 0.02); /* lines: 1 % */
        patches_destroy(&s);
        model_destroy(&m);
    }
}

/* Patches from the cache are those that were cut; another model's are not taken for them. */
static void kept_patches_are_the_same(void **state)
{
    (void)state;
    char   folder[temp_path_size], command[temp_path_size + 16];
    Model  tank = build("tank", 0.1), moved = build("tank", 0.1);
    size_t count[2] = {0};
    CHECK(temp_folder(folder));
    Cache *cache = cache_open(folder, 64 << 20);
    CHECK(cache);
    Patches fresh = cut(&tank), kept[3] = {{0}};
    for (int k = 0; k < 2; k++) CHECK(patches_create_kept(&kept[k], &tank, cache) == STATUS_OK);
    CHECK(cache_counters(cache).made == 1 && cache_counters(cache).fetched == 1);
    void *a = kept_write(&count[0], patches_kept_values, &(PatchesKept){&fresh, &tank});
    for (int k = 0; k < 2; k++) {
        void *b = kept_write(&count[1], patches_kept_values, &(PatchesKept){&kept[k], &tank});
        CHECK(a && b && fresh.count > 50 && count[0] == count[1] && memcmp(a, b, count[0]) == 0);
        free(b);
    }
    moved.vertex[0][0] += 1e-3;
    CHECK(patches_create_kept(&kept[2], &moved, cache) == STATUS_OK && cache_counters(cache).made == 2);
    for (int k = 0; k < 3; k++) patches_destroy(&kept[k]);
    free(a);
    patches_destroy(&fresh);
    model_destroy(&tank), model_destroy(&moved);
    cache_close(cache);
    snprintf(command, sizeof command, "rm -r %s", folder);
    CHECK(system(command) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_model_is_cut),
        cmocka_unit_test(a_long_box),
        cmocka_unit_test(a_wheel_has_three),
        cmocka_unit_test(a_tyre_stands_on_its_print),
        cmocka_unit_test(many_parts_stay_within_the_limit),
        cmocka_unit_test(glued_boxes_are_one),
        cmocka_unit_test(a_block_covers_what_it_stands_on),
        cmocka_unit_test(open_shells_hide_nothing),
        cmocka_unit_test(the_outside_of_models),
        cmocka_unit_test(kept_patches_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
