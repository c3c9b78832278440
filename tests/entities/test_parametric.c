/* Built-in models against their published figures, and the shapes they are made of against the surfaces that
 * they approximate. labels: physics */
#include "tests/entities/model_fixture.h"

/* ---- whole models --------------------------------------------------------------------------- */

static void all_models_are_valid_at_every_sag(void **state)
{
    (void)state;
    static const double sag_m[] = {0.1, 0.03, 0.01, 0.005, 0.001, 2e-4};
    for (int i = 0; i < model_name_count; i++) {
        int last = 0;
        for (size_t k = 0; k < sizeof sag_m / sizeof sag_m[0]; k++) {
            Model m = build(model_names[i], sag_m[k]);
            CHECK(model_validate(&m) == STATUS_OK);
            CHECK(m.triangle_count >= last);
            CHECK(m.sag_m == sag_m[k]);
            assert_string_equal(m.name, model_names[i]);
            last = m.triangle_count;
            model_destroy(&m);
        }
    }
}

static void the_finest_sag_is_built(void **state)
{
    (void)state;
    Model m = build("tank", 1e-5);
    CHECK(model_validate(&m) == STATUS_OK);
    CHECK(m.triangle_count < 3000000);
    model_destroy(&m);
}

static void the_same_call_gives_the_same_bits(void **state)
{
    (void)state;
    for (int i = 0; i < model_name_count; i++) {
        Model a = build(model_names[i], 0.004), b = build(model_names[i], 0.004);
        assert_int_equal(a.vertex_count, b.vertex_count);
        assert_int_equal(a.triangle_count, b.triangle_count);
        assert_memory_equal(a.vertex, b.vertex, (size_t)a.vertex_count * sizeof *a.vertex);
        assert_memory_equal(a.normal, b.normal, (size_t)a.vertex_count * sizeof *a.normal);
        assert_memory_equal(a.triangle, b.triangle, (size_t)a.triangle_count * sizeof *a.triangle);
        model_destroy(&a);
        model_destroy(&b);
    }
}

static void bad_requests_are_refused(void **state)
{
    (void)state;
    Model m, untouched;
    memset(&m, 0x5a, sizeof m);
    untouched = m;
    log_set_level((LogLevel)(LOG_ERROR + 1));
    const Status got[5] = {parametric_build(&m, "tank", 0.11), parametric_build(&m, "tank", 9e-6),
                           parametric_build(&m, "tank", NAN), parametric_build(&m, "zeppelin", 0.01),
                           parametric_build(&m, "", 0.01)};
    log_set_level(LOG_INFO);
    for (int i = 0; i < 5; i++) CHECK(got[i] == (i < 3 ? STATUS_BAD_VALUE : STATUS_UNSUPPORTED));
    assert_memory_equal(&m, &untouched, sizeof m);
}

/* Nothing below the ground, something on it; figures as in each file's header. */
static void dimensions_are_the_published_ones(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double      length_m, width_m, height_m, tolerance_m;
    } published[] = {
        {"truck", 7.366, 2.500, 2.870, 0.002},
        {"helicopter", 6.795 + 1.70 + 13.41 / 2, 3.15, 4.11, 0.002},  /* fin to the tip of the blade ahead */
        {"missile", 1.17, 0.46 * sqrt(0.5), 0.46 * sqrt(0.5), 0.005}, /* wings as an X: span / sqrt 2 */
        {"unknown", 4, 2, 1.6, 1e-12},
    };
    for (size_t i = 0; i < sizeof published / sizeof published[0]; i++) {
        Model m = build(published[i].name, 0.001);
        CHECK_NEAR(m.length_m, published[i].length_m, published[i].tolerance_m);
        CHECK_NEAR(m.width_m, published[i].width_m, published[i].tolerance_m);
        CHECK_NEAR(m.height_m, published[i].height_m, published[i].tolerance_m);
        model_destroy(&m);
    }
    double low[3], high[3];
    Model  tank = build("tank", 0.001);
    CHECK_NEAR(tank.length_m, 9.53, 0.002); /* gun forward */
    CHECK_NEAR(tank.width_m, 3.59, 0.002);
    part_box(low, high, &tank, "hull", NULL);
    CHECK_NEAR(high[0] - low[0], 6.95, 0.002);
    CHECK_NEAR(high[2], -0.47, 0.002); /* ground clearance */
    part_box(low, high, &tank, "turret", NULL);
    CHECK_NEAR(-low[2], 2.19, 0.10); /* roof; the gunner's sight stands a little over it */
    part_box(low, high, &tank, "track_left", NULL);
    CHECK_NEAR(high[1] - low[1], 0.58, 1e-9);
    CHECK_NEAR(0.5 * (high[1] + low[1]), -2.79 / 2, 1e-9);
    model_destroy(&tank);

    Model helicopter = build("helicopter", 0.001);
    part_box(low, high, &helicopter, "fin", NULL);
    const double rear = low[0];
    part_box(low, high, &helicopter, "fuselage", NULL);
    CHECK_NEAR(high[0] - rear, 13.59, 0.002);
    CHECK_NEAR(high[1] - low[1], 0.99, 0.002);
    part_box(low, high, &helicopter, "blades", NULL);
    CHECK_NEAR(high[0] - low[0], 13.41, 1e-9);
    /* trailing edges 0.7 of a chord behind the axis, one each side */
    CHECK_NEAR(high[1] - low[1], 2 * 0.7 * 0.686, 1e-9);
    part_box(low, high, &helicopter, "tail_blades", NULL);
    CHECK_NEAR(high[2] - low[2], 2.59, 1e-9);
    CHECK(high[0] - low[0] > 0.25 && high[1] - low[1] < 0.2); /* edge-on from ahead, wide from the side */
    model_destroy(&helicopter);

    Model missile = build("missile", 1e-4);
    part_box(low, high, &missile, "motor", NULL);
    CHECK_NEAR(high[1] - low[1], 0.152, 2e-4);
    model_destroy(&missile);

    for (int i = 0; i < model_name_count; i++) {
        for (double sag_m = 0.1; sag_m > 1e-3; sag_m *= 0.1) {
            Model m = build(model_names[i], sag_m);
            /* a ship's base is the waterline; an aircraft at rest has its gear up; a person carries to one side */
            const bool ship = !strcmp(model_names[i], "ship"), aircraft = !strcmp(model_names[i], "aircraft");
            const bool person = !strcmp(model_names[i], "person");
            CHECK(ship || m.box_high[2] <= 1e-12);
            CHECK(aircraft || m.box_high[2] >= -0.11); /* coarse facets may leave the ground by the sag */
            CHECK(person || fabs(m.box_low[1] + m.box_high[1]) <= 0.02 + 2 * sag_m);
            model_destroy(&m);
        }
    }
}

static void radius_holds_the_box_and_the_gun(void **state)
{
    (void)state;
    for (int i = 0; i < model_name_count; i++) {
        Model  m = build(model_names[i], 0.01);
        double most = 0;
        for (int k = 0; k < 40; k++) {
            NodePose pose[64];
            double   value[64];
            for (int n = 0; n < m.node_count; n++)
                value[n] = 8 * (random_uniform(5, 1, (uint32_t)k, (uint64_t)n) - 0.5);
            model_pose(pose, &m, value);
            for (int t = 0; t < m.triangle_count; t++) {
                const int node = m.part[m.triangle_part[t]].node;
                double    p[3];
                m3_mul_v3(p, pose[node].r_body_from_node, m.vertex[m.triangle[t][0]]);
                v3_add(p, p, pose[node].p_body);
                most = fmax(most, v3_length(p));
            }
        }
        CHECK(most <= m.radius_m);
        CHECK(m.radius_m <= 1.1 * most);
        model_destroy(&m);
    }
}

/* Every connected shell encloses a positive volume: none is inside out in the shadow of a bigger one. */
static int leader(int *follow, int i)
{
    while (follow[i] != i) i = follow[i] = follow[follow[i]];
    return i;
}

static int vertex_order(const void *a, const void *b, void *vertices)
{
    const double(*v)[3] = vertices, *p = v[*(const int *)a], *q = v[*(const int *)b];
    for (int i = 0; i < 3; i++)
        if (p[i] != q[i]) return p[i] < q[i] ? -1 : 1;
    return 0;
}

static void every_shell_is_outward(void **state)
{
    (void)state;
    for (int i = 0; i < model_name_count; i++) {
        Model   m = build(model_names[i], 0.005);
        int    *order = malloc((size_t)m.vertex_count * sizeof *order);
        int    *follow = malloc((size_t)m.vertex_count * sizeof *follow);
        double *volume = calloc((size_t)m.vertex_count, sizeof *volume);
        for (int v = 0; v < m.vertex_count; v++) follow[v] = -1;
        for (int part = 0; part < m.part_count; part++) {
            const ModelPart *p = &m.part[part];
            int              count = 0;
            for (int t = p->first_triangle; t < p->first_triangle + p->triangle_count; t++)
                for (int k = 0; k < 3; k++) {
                    const int v = (int)m.triangle[t][k];
                    if (follow[v] < 0) order[count++] = v; /* parts share no vertices */
                    follow[v] = v;
                }
            qsort_r(order, (size_t)count, sizeof *order, vertex_order, m.vertex);
            for (int k = 1; k < count; k++)
                if (vertex_order(&order[k - 1], &order[k], m.vertex) == 0)
                    follow[leader(follow, order[k])] = leader(follow, order[k - 1]);
            for (int t = p->first_triangle; t < p->first_triangle + p->triangle_count; t++)
                for (int k = 1; k < 3; k++)
                    follow[leader(follow, (int)m.triangle[t][k])] = leader(follow, (int)m.triangle[t][0]);
            for (int t = p->first_triangle; t < p->first_triangle + p->triangle_count; t++) {
                const uint32_t *v = m.triangle[t];
                double          cross[3];
                v3_cross(cross, m.vertex[v[1]], m.vertex[v[2]]);
                volume[leader(follow, (int)v[0])] += v3_dot(m.vertex[v[0]], cross) / 6;
            }
            for (int k = 0; k < count; k++)
                if (follow[order[k]] == order[k] && !(volume[order[k]] > 0))
                    fail_msg("%s: part %s has a shell of %g m3", m.name, p->name, volume[order[k]]);
        }
        free(order);
        free(follow);
        free(volume);
        model_destroy(&m);
    }
}

/* A triangle's own normal and its vertices' shading normals look the same way. */
static void shading_agrees_with_facets(void **state)
{
    (void)state;
    for (int i = 0; i < model_name_count; i++) {
        Model m = build(model_names[i], 0.002);
        int   against = 0;
        for (int t = 0; t < m.triangle_count; t++) {
            const uint32_t *v = m.triangle[t];
            double          a[3], b[3], n[3];
            v3_sub(a, m.vertex[v[1]], m.vertex[v[0]]);
            v3_sub(b, m.vertex[v[2]], m.vertex[v[0]]);
            v3_cross(n, a, b);
            for (int k = 0; k < 3; k++) {
                const double s[3] = {m.normal[v[k]][0], m.normal[v[k]][1], m.normal[v[k]][2]};
                /* a facet spans at most 45 degrees: its normals lean by less, at a sphere's pole a bit more */
                if (!(v3_dot(s, n) > 0.6 * v3_length(n))) against++;
            }
        }
        if (against) fail_msg("%s: %d corners look away from their facet", m.name, against);
        model_destroy(&m);
    }
}

/* ---- what moves, and which side is which ------------------------------------------------------ */

static void the_turret_turns_right_and_the_gun_lifts(void **state)
{
    (void)state;
    static const char *const armed[2] = {"tank", "helicopter"}, *const barrel[2] = {"barrel", "chin_gun"};
    for (int i = 0; i < 2; i++) {
        Model     m = build(armed[i], 0.005);
        const int turret = find_node(&m, "turret"), gun = find_node(&m, "gun");
        assert_int_equal(m.node[turret].dis_class, 4096);
        assert_int_equal(m.node[turret].dis_metric, 11);
        assert_int_equal(m.node[gun].dis_class, 4416);
        assert_int_equal(m.node[gun].dis_metric, 13);
        assert_int_equal(m.node[gun].parent, turret);
        double low[3], high[3], raised_low[3], raised_high[3], value[64] = {0};
        value[turret] = 0.5 * pi_rad;
        part_box(low, high, &m, barrel[i], value);
        CHECK(high[1] > 1.3 && low[1] > 0); /* the muzzle is out to the right */
        value[turret] = 0;
        part_box(low, high, &m, barrel[i], value);
        value[gun] = 10 * rad_per_deg;
        part_box(raised_low, raised_high, &m, barrel[i], value);
        const double reach = high[0] - m.node[turret].p_parent[0] - m.node[gun].p_parent[0];
        CHECK_NEAR(raised_low[2] - low[2], -reach * sin(10 * rad_per_deg), 0.02 * reach); /* up: more negative */
        value[gun] = 3; /* over the limit: the highest it goes */
        part_box(raised_low, raised_high, &m, barrel[i], value);
        CHECK_NEAR(raised_low[2] - low[2], -reach * sin(m.node[gun].high), 0.02 * reach);
        model_destroy(&m);
    }
    Model     tank = build("tank", 0.005);
    const int cupola = find_node(&tank, "cupola"), mount = find_node(&tank, "machine_gun");
    assert_int_equal(tank.node[cupola].dis_class, 5696);
    assert_int_equal(tank.node[mount].dis_class, 6016);
    assert_int_equal(tank.node[mount].parent, cupola);
    CHECK_NEAR(tank.node[find_node(&tank, "gun")].high, 14 * rad_per_deg, 1e-15);
    CHECK_NEAR(tank.node[find_node(&tank, "gun")].low, -6 * rad_per_deg, 1e-15);
    model_destroy(&tank);
}

static void wheels_roll_forward(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int         wheels;
    } rolling[] = {{"tank", 16}, {"truck", 6}, {"helicopter", 0}, {"missile", 0}};
    for (size_t i = 0; i < 4; i++) {
        Model m = build(rolling[i].name, 0.005);
        int   wheels = 0;
        for (int n = 0; n < m.node_count; n++) {
            if (!(m.node[n].roll_radius_m > 0)) continue;
            wheels++;
            double   value[64] = {0};
            NodePose pose[64];
            /* one centimetre of travel takes the top of the wheel forward by as much again, over the axle */
            value[n] = 0.01 / m.node[n].roll_radius_m;
            model_pose(pose, &m, value);
            const double top_node[3] = {0, 0, -m.node[n].roll_radius_m};
            double       top[3];
            m3_mul_v3(top, pose[n].r_body_from_node, top_node);
            CHECK_NEAR(top[0], 0.01, 1e-5);
            CHECK_NEAR(top[1], 0, 1e-12);
        }
        assert_int_equal(wheels, rolling[i].wheels);
        model_destroy(&m);
    }
}

static void rotors_turn_as_the_real_ones(void **state)
{
    (void)state;
    Model            m = build("helicopter", 0.005);
    const ModelNode *rotor = &m.node[find_node(&m, "main_rotor")], *tail = &m.node[find_node(&m, "tail_rotor")];
    CHECK_NEAR(rotor->spin_rps_moving, 33.93, 0.01);
    CHECK_NEAR(tail->spin_rps_moving, 173.2, 0.1);
    double   value[64] = {0};
    NodePose pose[64];
    /* counter-clockwise seen from above: the blade ahead goes to the left */
    value[rotor - m.node] = 0.1;
    model_pose(pose, &m, value);
    double tip[3];
    m3_mul_v3(tip, pose[rotor - m.node].r_body_from_node, (double[3]){1, 0, 0});
    CHECK(tip[1] < 0);
    CHECK(tail->p_parent[1] > 0.2); /* on the right of the fin */
    /* the thick leading edge of the blade ahead is on the side that it goes to: nearer the pitch axis */
    double           low[3], high[3], ahead_low = 0, ahead_high = 0;
    const ModelPart *blades = find_part(&m, "blades");
    for (int t = blades->first_triangle; t < blades->first_triangle + blades->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const double *v = m.vertex[m.triangle[t][k]];
            if (v[0] < 0) continue;
            ahead_low = fmin(ahead_low, v[1]);
            ahead_high = fmax(ahead_high, v[1]);
        }
    CHECK_NEAR(ahead_low, -0.3 * 0.686, 1e-9);
    CHECK_NEAR(ahead_high, 0.7 * 0.686, 1e-9);
    part_box(low, high, &m, "skids", NULL);
    CHECK_NEAR(high[2], 0, 0.005); /* stands on its skids */
    CHECK_NEAR(high[1] - low[1], 2.13 + 0.1, 0.05);
    model_destroy(&m);
}

static void port_is_not_starboard(void **state)
{
    (void)state;
    double low[3], high[3];
    Model  tank = build("tank", 0.005), truck = build("truck", 0.005), unknown = build("unknown", 0.005);
    part_box(low, high, &tank, "exhaust", NULL);
    CHECK(high[1] < -1 && high[0] < 0); /* left, behind the middle */
    assert_int_equal(find_part(&tank, "exhaust")->role, HEAT_EXHAUST);
    part_box(low, high, &tank, "searchlight", NULL);
    CHECK(low[1] > 0.25 && low[0] > 0.5); /* right of the gun, ahead */
    part_box(low, high, &tank, "engine_deck", NULL);
    CHECK(high[0] < -1);
    part_box(low, high, &truck, "exhaust_stack", NULL);
    CHECK(low[1] > 0.5);
    assert_int_equal(find_part(&truck, "exhaust_stack")->role, HEAT_EXHAUST);
    part_box(low, high, &truck, "fuel_tank", NULL);
    CHECK(high[1] < -0.5);
    part_box(low, high, &truck, "bonnet", NULL);
    CHECK(low[0] > 1.5);
    assert_int_equal(find_part(&truck, "bonnet")->role, HEAT_ENGINE_DECK);
    /* the unknown one: area to the right of the middle, on top, is larger; its nose is the lower end */
    double top_front = 0, top_rear = 0;
    for (int v = 0; v < unknown.vertex_count; v++) {
        if (unknown.vertex[v][0] > 1.9) top_front = fmin(top_front, unknown.vertex[v][2]);
        if (unknown.vertex[v][0] < -1.8) top_rear = fmin(top_rear, unknown.vertex[v][2]);
    }
    CHECK_NEAR(top_front, -0.5, 1e-12);
    CHECK_NEAR(top_rear, -1.6, 1e-12);
    model_destroy(&tank);
    model_destroy(&truck);
    model_destroy(&unknown);
}

/* ---- the shapes against the surfaces they stand for -------------------------------------------- */

/* A model of one part made by one call; the caller adds shapes between. */
static MeshBuilder *begin(double sag_m)
{
    MeshBuilder *b = mesh_builder_create("shape", sag_m);
    CHECK(b != NULL);
    mesh_node(b, "hull", -1, 0, 0, 0);
    mesh_part(b, 0, "shape", "steel_worn", HEAT_PASSIVE);
    return b;
}

static Model finish(MeshBuilder *b)
{
    Model m = {0};
    CHECK(mesh_builder_finish(&m, b) == STATUS_OK);
    CHECK(model_validate(&m) == STATUS_OK);
    return m;
}

/* A regular n-gon in a circle has the area n / 2 sin(2 pi / n) r^2: exact, to rounding. */
static void volumes_are_those_of_the_polygons(void **state)
{
    (void)state;
    for (double sag_m = 0.05; sag_m > 1e-5; sag_m *= 0.2) {
        const double r = 0.7, length = 2.5;
        const int    n = mesh_circle_sides(r, sag_m);
        CHECK(r * (1 - cos(pi_rad / n)) <= sag_m * (1 + 1e-9));
        CHECK(n == 8 || r * (1 - cos(pi_rad / (n - 1))) > sag_m); /* and no more sides than needed */
        MeshBuilder *b = begin(sag_m);
        mesh_cylinder(b, place_axis(3, -2, 1, 1, 2, -0.5), -1, length - 1, r);
        Model m = finish(b);
        CHECK_NEAR(part_volume_m3(&m, &m.part[0]) / (0.5 * n * sin(2 * pi_rad / n) * r * r * length), 1, 1e-12);
        model_destroy(&m);
        /* inside the sphere, and outside the sphere that is smaller by the sag */
        b = begin(sag_m);
        mesh_sphere(b, place_at(0.3, 0, -2), r);
        m = finish(b);
        const double full = 4 * pi_rad / 3, v = part_volume_m3(&m, &m.part[0]);
        CHECK(v < full * r * r * r);
        CHECK(v > full * pow(r - sag_m, 3));
        model_destroy(&m);
    }
    MeshBuilder *b = begin(0.01);
    mesh_box(b, place_scaled(place_axis(1, 2, 3, 1, 1, 1), 2, 3, 0.5), 0, 0, 0, 1, 1, 1);
    mesh_box(b, place_mirror_y(place_at(0, 9, 0)), 0, 0, 0, 1, 2, 3);
    const double l_shape[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}; /* concave: 4 square metres */
    mesh_prism(b, place_at(20, 0, 0), 6, l_shape, -0.5, 1);
    Model m = finish(b);
    CHECK_NEAR(part_volume_m3(&m, &m.part[0]), 3 + 6 + 6, 1e-12);
    model_destroy(&m);
}

/* Largest distance of the facets' insides from a surface of which `gap` tells the distance: seven points a
 * facet (middle, edge middles, and middles of those). */
typedef double Gap(const double p[3], const void *shape);

static double worst_gap(const Model *m, Gap *gap, const void *shape)
{
    static const double at[7][3] = {{1 / 3.0, 1 / 3.0, 1 / 3.0}, {0.5, 0.5, 0},     {0, 0.5, 0.5},    {0.5, 0, 0.5},
                                    {0.7, 0.15, 0.15},           {0.15, 0.7, 0.15}, {0.15, 0.15, 0.7}};
    double              worst = 0;
    for (int t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 7; k++) {
            double p[3] = {0, 0, 0};
            for (int c = 0; c < 3; c++) v3_add_scaled(p, p, at[k][c], m->vertex[m->triangle[t][c]]);
            worst = fmax(worst, gap(p, shape));
        }
    return worst;
}

static double sphere_gap(const double p[3], const void *radius) { return fabs(v3_length(p) - *(const double *)radius); }

static double barrel_gap(const double p[3], const void *radius)
{
    if (p[0] < 0.51 || p[0] > 2.24) return 0; /* the straight part only */
    const double r = hypot(p[1], p[2]), *wanted = radius;
    return r < 0.09 ? 0 : fabs(r - wanted[0] - (wanted[1] - wanted[0]) * (p[0] - 0.30) / 2.05);
}

typedef struct LoftShape {
    const Station *station;
    int            count;
} LoftShape;

/* Distance to the true section in the plane x = const: at least the distance to the surface. The ellipse's
 * corner is judged by the first-order distance f / |grad f|. */
static double loft_gap(const double p[3], const void *shape)
{
    const LoftShape *l = shape;
    if (p[0] < l->station[0].x + 1e-9 || p[0] > l->station[l->count - 1].x - 1e-9) return 0; /* flat ends */
    const Station s = mesh_station_at(l->station, l->count, p[0]);
    const double  h = 0.5 * (s.bottom - s.top), a = s.half_width;
    const double  u = fabs(p[1]) - a * (1 - s.round), v = fabs(p[2] - 0.5 * (s.bottom + s.top)) - h * (1 - s.round);
    if (u <= 0 || v <= 0) return u > v ? fabs(u - a * s.round) : fabs(v - h * s.round);
    const double e = u / (a * s.round), g = v / (h * s.round), f = e * e + g * g - 1;
    return fabs(f) / (2 * hypot(e / (a * s.round), g / (h * s.round)));
}

static void facets_keep_to_the_sag(void **state)
{
    (void)state;
    static const Station body[5] = {
        {-3, 0.10, -0.30, -0.10, 1.0}, {-1.5, 0.45, -0.90, 0.20, 0.7}, {0, 0.50, -1.20, 0.30, 0.5},
        {2, 0.40, -1.00, 0.20, 0.8},   {3, 0.15, -0.50, -0.10, 1.0},
    };
    const LoftShape loft = {body, 5};
    for (double sag_m = 0.03; sag_m > 2e-5; sag_m *= 0.3) {
        const double radius = 1.3;
        MeshBuilder *b = begin(sag_m);
        mesh_sphere(b, place_at(0, 0, 0), radius);
        Model        m = finish(b);
        const double sphere = worst_gap(&m, sphere_gap, &radius);
        CHECK(sphere <= sag_m);
        CHECK(sphere >= 0.2 * sag_m || sag_m > 0.02); /* nor is it much finer than asked */
        model_destroy(&m);

        b = begin(sag_m);
        mesh_loft(b, place_at(0, 0, 0), body, 5);
        m = finish(b);
        const double lofted = worst_gap(&m, loft_gap, &loft);
        CHECK(lofted <= sag_m);
        CHECK(lofted >= 0.1 * sag_m);
        model_destroy(&m);

        /* the tank's barrel between trunnion and fume extractor, in the gun's own axes */
        Model            tank = build("tank", sag_m);
        const ModelPart *part = find_part(&tank, "barrel");
        const double     taper[2] = {0.115, 0.110};
        Model            barrel = tank;
        barrel.triangle += part->first_triangle;
        barrel.triangle_count = part->triangle_count;
        CHECK(worst_gap(&barrel, barrel_gap, taper) <= sag_m);
        model_destroy(&tank);
    }
}

/* A band around two equal wheels: two half rings and two straight runs; the polygon is inside the true band
 * by no more than the sag on each side. With cleats: boxes that overlap it by a fifth of its thickness. */
static void belts_have_their_volume(void **state)
{
    (void)state;
    const BeltWheel wheel[2] = {{-2, -0.5, 0.4}, {2, -0.5, 0.4}};
    for (double sag_m = 0.01; sag_m > 1e-5; sag_m *= 0.1) {
        MeshBuilder *b = begin(sag_m);
        mesh_belt(b, place_at(0, 1, 0), wheel, 2, &(Belt){0.05, -0.3, 0.3, 0, 0, 0});
        Model        m = finish(b);
        const double truth = 0.6 * (pi_rad * (0.45 * 0.45 - 0.4 * 0.4) + 2 * 4 * 0.05);
        const double turned = 0.6 * pi_rad * (0.45 * 0.45 - 0.4 * 0.4);
        const double v = part_volume_m3(&m, &m.part[0]);
        CHECK(v <= truth * (1 + 1e-12));
        /* an n-gon's area is short by the share 2 sag / (3/2 r), to first order, on both circles alike */
        CHECK(v >= truth - turned * (4 * sag_m / (3 * 0.45)) * 1.2 - 1e-9);
        CHECK_NEAR(m.box_low[2], -0.95, sag_m);
        CHECK_NEAR(m.box_high[2], -0.05, sag_m);
        model_destroy(&m);

        b = begin(sag_m);
        mesh_belt(b, place_at(0, 1, 0), wheel, 2, &(Belt){0.05, -0.3, 0.3, 40, 0.02, 0.06});
        m = finish(b);
        CHECK_NEAR(part_volume_m3(&m, &m.part[0]) - v, 40 * 0.6 * 0.06 * (0.02 + 0.2 * 0.05), 1e-9);
        CHECK_NEAR(m.box_high[2], -0.03, 0.002 + sag_m);
        model_destroy(&m);
    }
}

/* Every material that a model names is in the table of materials. */
static void materials_are_in_the_table(void **state)
{
    (void)state;
    char  path[512];
    Table table = {0};
    CHECK(etc_path(path, sizeof path, "materials.csv"));
    CHECK(table_open(&table, path) == STATUS_OK);
    const int name = table_column(&table, "name"), pan = table_column(&table, "rho_pan");
    CHECK(name >= 0 && pan >= 0 && table_column(&table, "source") >= 0);
    for (int i = 0; i < model_name_count; i++) {
        Model m = build(model_names[i], 0.05);
        for (int p = 0; p < m.part_count; p++) {
            bool found = false;
            for (int row = 0; row < table.rows; row++)
                found |= !strcmp(table_text(&table, row, name), m.part[p].material);
            if (!found) fail_msg("%s: part %s is of unlisted %s", m.name, m.part[p].name, m.part[p].material);
        }
        model_destroy(&m);
    }
    /* a panchromatic reflectance lies between those of the bands that make it up; every row says its source */
    for (int row = 0; row < table.rows; row++) {
        double                   rho[4];
        static const char *const column[4] = {"rho_b", "rho_g", "rho_r", "rho_pan"};
        for (int k = 0; k < 4; k++)
            CHECK(table_number(&rho[k], &table, row, table_column(&table, column[k]), 0, 1) == STATUS_OK);
        CHECK(rho[3] >= fmin(rho[0], fmin(rho[1], rho[2])) && rho[3] <= fmax(rho[0], fmax(rho[1], rho[2])));
        CHECK(strlen(table_text(&table, row, table_column(&table, "source"))) > 0);
        CHECK(strlen(table_text(&table, row, name)) < 32);
    }
    table_close(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_models_are_valid_at_every_sag),
        cmocka_unit_test(the_finest_sag_is_built),
        cmocka_unit_test(the_same_call_gives_the_same_bits),
        cmocka_unit_test(bad_requests_are_refused),
        cmocka_unit_test(dimensions_are_the_published_ones),
        cmocka_unit_test(radius_holds_the_box_and_the_gun),
        cmocka_unit_test(every_shell_is_outward),
        cmocka_unit_test(shading_agrees_with_facets),
        cmocka_unit_test(the_turret_turns_right_and_the_gun_lifts),
        cmocka_unit_test(wheels_roll_forward),
        cmocka_unit_test(rotors_turn_as_the_real_ones),
        cmocka_unit_test(port_is_not_starboard),
        cmocka_unit_test(volumes_are_those_of_the_polygons),
        cmocka_unit_test(facets_keep_to_the_sag),
        cmocka_unit_test(belts_have_their_volume),
        cmocka_unit_test(materials_are_in_the_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
