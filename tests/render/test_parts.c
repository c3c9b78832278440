/* Rays against posed models: ranges from paper at any distance, closed solids that do not leak, and the same
 * answer from every instruction set and with or without culling. */
#include "tests/render/hand_models.h"

#include <unistd.h>

#include "entities/import/model_import.h"
#include "render/trace/parts/parts.h"
#include "render/scene/hits.h"

typedef struct Scene {
    Tracer     *tracer;
    PosedEntity entity;
    PosedNode   node[4];
} Scene;

static void scene_open(Scene *s, const Model *model, const char *isa)
{
    assert_int_equal(tracer_create_models(&s->tracer, &model, 1, isa), STATUS_OK);
    assert_int_equal(tracer_model_count(s->tracer), 1);
    assert_ptr_equal(tracer_model(s->tracer, 0), model);
    assert_true(parts_node_count(s->tracer, 0) <= 4);
    s->entity.node = s->node;
}

static void scene_pose(Scene *s, const NodePose *pose, const double p_enu[3], const double r_enu_from_body[9])
{
    parts_pose(&s->entity, s->tracer, 0, pose, p_enu, r_enu_from_body, 0);
}

static NodePose at_rest(void)
{
    NodePose pose = {{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    return pose;
}

static void to_enu(double p_enu[3], const double p_body[3], const double p[3], const double r[9])
{
    double turned[3];
    m3_mul_v3(turned, r, p_body);
    v3_add(p_enu, p, turned);
}

/* ---- from paper ------------------------------------------------------------------------------- */

static void a_plate_is_as_far_as_paper_says(void **state)
{
    (void)state;
    static const double away_m[4] = {0, 20000, 50000, 200000};
    Model               model;
    Scene               s;
    hand_plate(&model, 1.5, 1);
    scene_open(&s, &model, "avx2");
    const NodePose pose = at_rest();
    for (int n = 0; n < 20000; n++) {
        double p[3], r[9], to_body[3] = {0, hand_uniform(-1.49, 1.49), hand_uniform(-1.99, -0.01)}, to[3], o[3], d[3];
        hand_direction(p);
        v3_scale(p, away_m[n % 4], p);
        hand_rotation(r);
        scene_pose(&s, &pose, p, r);
        to_enu(to, to_body, p, r);
        hand_direction(d);
        const double normal[3] = {r[0], r[3], r[6]}, sine = fabs(v3_dot(normal, d));
        if (sine < 0.01) continue;
        const double far_m = exp(hand_uniform(log(3), log(10000)));
        v3_add_scaled(o, to, -far_m, d);
        PartHit hit;
        double  between[3], n_geo[3], n_enu[3];
        v3_sub(between, p, o);
        const double want = v3_dot(between, normal) / v3_dot(d, normal);
        const double got = parts_first_hit(&hit, &s.entity, o, d, INFINITY, false);
        CHECK_NEAR(got / want, 1, 1e-9);
        /* a few roundings at the size of the coordinates, over the sine of the angle of incidence */
        CHECK_NEAR(got, want, 16 * 2.2e-16 * (away_m[n % 4] + far_m) / sine + 1e-14);
        CHECK(parts_occluded(&s.entity, o, d, false));
        parts_normals(n_geo, n_enu, &model, &s.entity, &hit, o, d, got);
        const double side = v3_dot(normal, d) < 0 ? 1 : -1;
        for (int c = 0; c < 3; c++) {
            CHECK_NEAR(n_geo[c], side * normal[c], 1e-14);
            CHECK_NEAR(n_enu[c], side * normal[c], 1e-7); /* kept as float in the model */
        }
        CHECK(isinf(parts_first_hit(&hit, &s.entity, o, d, got * 0.999, false)));
    }
    tracer_destroy(s.tracer);
    hand_free(&model);
}

/* Where a ray enters a box, by slabs; NAN when the way through is shorter than least_m. */
static double box_entry(const double low[3], const double high[3], const double o[3], const double d[3], double least_m)
{
    double in = -INFINITY, out = INFINITY;
    for (int c = 0; c < 3; c++) {
        const double a = (low[c] - o[c]) / d[c], b = (high[c] - o[c]) / d[c];
        in = fmax(in, fmin(a, b));
        out = fmin(out, fmax(a, b));
    }
    return out - in > least_m && in > 0 ? in : NAN;
}

/* Through corners, edges and the diagonals of faces: two or more triangles could each think it the other's. */
static void a_closed_box_does_not_leak(void **state)
{
    (void)state;
    static const double low[3] = {-3.2, -1.7, -2.4}, high[3] = {3.7, 1.6, 0};
    Model               model;
    Scene               s;
    hand_box(&model, low, high);
    scene_open(&s, &model, "avx2");
    const NodePose pose = at_rest();
    int            tried = 0;
    for (int n = 0; n < 200000; n++) {
        double p[3], r[9], o_body[3], d_body[3], o[3], d[3], at[3];
        if (n % 100 == 0) {
            hand_direction(p);
            v3_scale(p, hand_uniform(0, 20000), p);
            hand_rotation(r);
            scene_pose(&s, &pose, p, r);
        }
        const uint32_t *corner = model.triangle[n % 12];
        const double    f = n % 3 ? hand_uniform(0, 1) : 0;
        for (int c = 0; c < 3; c++)
            at[c] = model.vertex[corner[n % 7 % 3]][c] * (1 - f) + model.vertex[corner[(n % 7 + 1) % 3]][c] * f;
        hand_direction(d_body);
        v3_add_scaled(o_body, at, -exp(hand_uniform(log(5), log(10000))), d_body);
        const double want = box_entry(low, high, o_body, d_body, 1e-4);
        if (isnan(want)) continue; /* comes out there, or only brushes it */
        tried++;
        m3_mul_v3(d, r, d_body);
        to_enu(o, o_body, p, r);
        PartHit      hit;
        const double got = parts_first_hit(&hit, &s.entity, o, d, INFINITY, false);
        /* an edge may be given to the wrong one of its two faces, whose plane is then met a little off it:
         * 1e-6 m of float, over the sine of the angle */
        if (!(fabs(got - want) <= 1e-4)) fail_msg("leak: ray %d: %.17g, want %.17g", n, got, want);
    }
    CHECK(tried > 50000);
    tracer_destroy(s.tracer);
    hand_free(&model);
}

static void a_sphere_has_its_radius_and_its_normals(void **state)
{
    (void)state;
    const double radius_m = 2;
    Model        model;
    Scene        s;
    const double inside_m = hand_sphere(&model, radius_m, 64);
    scene_open(&s, &model, "avx2");
    const NodePose pose = at_rest();
    const double   p[3] = {3000, -4000, 100};
    double         r[9];
    hand_rotation(r);
    scene_pose(&s, &pose, p, r);
    for (int n = 0; n < 20000; n++) {
        double out[3], d[3], o[3], n_geo[3], n_enu[3], at[3];
        hand_direction(out);
        do hand_direction(d);
        while (!(v3_dot(out, d) < -0.3));
        v3_add_scaled(at, p, radius_m, out);
        v3_add_scaled(o, at, -hand_uniform(0.01, 5000), d);
        PartHit      hit;
        const double t = parts_first_hit(&hit, &s.entity, o, d, INFINITY, false);
        for (int c = 0; c < 3; c++) at[c] = o[c] + t * d[c] - p[c];
        CHECK(v3_length(at) <= radius_m + 1e-6 && v3_length(at) >= inside_m - 1e-6);
        parts_normals(n_geo, n_enu, &model, &s.entity, &hit, o, d, t);
        CHECK_NEAR(v3_dot(n_geo, n_geo), 1, 1e-12);
        v3_normalize(at, at);
        CHECK_NEAR(v3_dot(n_enu, at), 1, 1e-5);                     /* interpolated: the sphere's own */
        CHECK_NEAR(v3_dot(n_geo, at), 1, 1 - cos(2 * pi_rad / 64)); /* the facet's: within a facet's turn */
        /* from inside the far wall shows its back */
        if (n % 4) continue;
        const double t_in = parts_first_hit(&hit, &s.entity, p, d, INFINITY, false);
        CHECK(t_in <= radius_m + 1e-6 && t_in >= inside_m - 1e-6);
        parts_normals(n_geo, n_enu, &model, &s.entity, &hit, p, d, t_in);
        CHECK(v3_dot(n_geo, d) < -0.99 && v3_dot(n_enu, d) < -0.99);
    }
    tracer_destroy(s.tracer);
    hand_free(&model);
}

/* ---- joints ------------------------------------------------------------------------------------ */

static void nodes_are_where_their_poses_put_them(void **state)
{
    (void)state;
    static const double low[3] = {-3, -1, -1}, high[3] = {3, 1, 0};
    static const double gun_low[3] = {0, -0.1, -0.1}, gun_high[3] = {4, 0.1, 0.1};
    Model               model;
    Scene               s;
    hand_model(&model, 2, 16, 24);
    hand_box_into(&model, 0, low, high);
    hand_box_into(&model, 1, gun_low, gun_high);
    scene_open(&s, &model, "avx2");
    const double p[3] = {100, 200, 300}, r[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int step = 0; step < 64; step++) {
        const double a = 2 * pi_rad * step / 64;
        NodePose     pose[2] = {at_rest(), {{0.5, 0, -1.5}, {cos(a), -sin(a), 0, sin(a), cos(a), 0, 0, 0, 1}}};
        scene_pose(&s, pose, p, r);
        /* at the muzzle, along the gun: 4 m out from its pivot */
        double muzzle[3] = {0.5 + 4 * cos(a), 4 * sin(a), -1.5}, d[3] = {-cos(a), -sin(a), 0}, o[3];
        v3_add(muzzle, muzzle, p);
        v3_add_scaled(o, muzzle, -50, d);
        PartHit hit;
        CHECK_NEAR(parts_first_hit(&hit, &s.entity, o, d, INFINITY, false), 50, 1e-12);
        assert_int_equal(hit.node, 1);
        assert_int_equal(model.triangle_part[hit.triangle], 1);
        /* the sphere holds every corner as it is posed */
        for (int v = 0; v < model.vertex_count; v++) {
            const NodePose *of = &pose[v >= 8];
            double          at[3], from[3];
            m3_mul_v3(at, of->r_body_from_node, model.vertex[v]);
            for (int c = 0; c < 3; c++) from[c] = at[c] + of->p_body[c] + p[c] - s.entity.centre_enu[c];
            CHECK(v3_length(from) < s.entity.radius_m);
        }
    }
    /* a node without a place is left out, an entity without one altogether */
    NodePose bad[2] = {at_rest(), at_rest()};
    bad[1].p_body[2] = NAN;
    scene_pose(&s, bad, p, r);
    assert_int_equal(s.entity.node_count, 1);
    bad[0].r_body_from_node[4] = INFINITY;
    scene_pose(&s, bad, p, r);
    assert_int_equal(s.entity.model, -1);
    scene_pose(&s, bad, (double[3]){NAN, 0, 0}, r);
    assert_int_equal(s.entity.model, -1);
    assert_int_equal(s.entity.node_count, 0);
    tracer_destroy(s.tracer);
    hand_free(&model);
}

/* Seen edge-on a triangle's plane says nothing of range; its corners do. */
static void edge_on_stays_between_the_corners(void **state)
{
    (void)state;
    Model model;
    Scene s;
    hand_plate(&model, 1, 1);
    scene_open(&s, &model, "avx2");
    const NodePose pose = at_rest();
    const double   p[3] = {0, 0, 0}, r[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    scene_pose(&s, &pose, p, r);
    for (int n = 0; n < 20000; n++) {
        const double lean = n % 2 ? 0 : exp(hand_uniform(-40, -8)) * (n % 4 ? 1 : -1);
        const double o[3] = {n % 8 < 4 ? 0 : hand_uniform(-1e-7, 1e-7), -100, hand_uniform(-2, 0)};
        double       d[3] = {lean, 1, 0};
        v3_normalize(d, d);
        PartHit      hit;
        const double t = parts_first_hit(&hit, &s.entity, o, d, INFINITY, false);
        CHECK(isinf(t) || (t >= 98.9 && t <= 101.1));
    }
    tracer_destroy(s.tracer);
    hand_free(&model);
}

/* ---- the same bits ------------------------------------------------------------------------------ */

static void every_set_of_instructions_agrees(void **state)
{
    (void)state;
    static const char *const isa[3] = {"avx2", "sse4.2", ""};
    Model                    model;
    Scene                    s[3];
    double                   p[3], r[9];
    hand_sphere(&model, 2, 24);
    for (int k = 0; k < 3; k++) scene_open(&s[k], &model, isa[k]);
    const NodePose pose = at_rest();
    int            hits = 0;
    for (int n = 0; n < 100000; n++) {
        double o[3], d[3], to[3];
        if (n % 1000 == 0) {
            hand_direction(p);
            v3_scale(p, hand_uniform(0, 50000), p);
            hand_rotation(r);
            for (int k = 0; k < 3; k++) scene_pose(&s[k], &pose, p, r);
        }
        hand_direction(d);
        for (int c = 0; c < 3; c++) to[c] = p[c] + hand_uniform(-2, 2);
        v3_add_scaled(o, to, -exp(hand_uniform(0, 9)), d);
        PartHit      hit[5] = {0};
        const double want = parts_first_hit(&hit[0], &s[0].entity, o, d, INFINITY, false);
        hits += want < INFINITY;
        for (int k = 0; k < 3; k++)
            for (int all = 0; all < 2; all++) {
                const double t = parts_first_hit(&hit[1], &s[k].entity, o, d, INFINITY, all);
                CHECK(t == want && hit[1].triangle == hit[0].triangle && hit[1].node == hit[0].node);
                CHECK(parts_occluded(&s[k].entity, o, d, all) == (want < INFINITY));
            }
    }
    CHECK(hits > 30000);
    for (int k = 0; k < 3; k++) tracer_destroy(s[k].tracer);
    hand_free(&model);
}

/* Two boxes with faces in one plane, of other triangles: the lower wins, whoever traces. */
static void faces_in_one_place_are_the_lowest(void **state)
{
    (void)state;
    static const char *const isa[3] = {"avx2", "sse4.2", ""};
    Model                    model;
    Scene                    s[3];
    const double             p[3] = {3000, -2000, 100};
    double                   r[9];
    hand_model(&model, 1, 16, 24);
    hand_box_into(&model, 0, (const double[3]){-1, -0.7, -0.9}, (const double[3]){1, 0.8, 1.1});
    hand_box_into(&model, 0, (const double[3]){-0.6, -0.71, -0.9}, (const double[3]){1, 0.8, 0.3});
    hand_rotation(r);
    const NodePose pose = at_rest();
    for (int k = 0; k < 3; k++) {
        scene_open(&s[k], &model, isa[k]);
        scene_pose(&s[k], &pose, p, r);
    }
    int shared = 0;
    for (int n = 0; n < 100000; n++) {
        double o[3], d[3], to[3];
        hand_direction(d);
        for (int c = 0; c < 3; c++) to[c] = p[c] + hand_uniform(-1, 1);
        v3_add_scaled(o, to, -2000, d);
        PartHit      hit[3] = {0};
        const double want = parts_first_hit(&hit[0], &s[0].entity, o, d, INFINITY, false);
        for (int k = 1; k < 3; k++) {
            const double t = parts_first_hit(&hit[k], &s[k].entity, o, d, INFINITY, false);
            CHECK(t == want && hit[k].triangle == hit[0].triangle);
        }
        if (!(want < INFINITY)) continue;
        /* on the common part of a common plane no triangle of the second box is seen */
        double at_enu[3], at[3];
        for (int c = 0; c < 3; c++) at_enu[c] = o[c] + want * d[c] - p[c];
        m3_tmul_v3(at, r, at_enu);
        const bool on_x = fabs(at[0] - 1) < 1e-6 && at[1] > -0.69 && at[1] < 0.79 && at[2] > -0.89 && at[2] < 0.29;
        const bool on_y = fabs(at[1] - 0.8) < 1e-6 && at[0] > -0.59 && at[0] < 0.99 && at[2] > -0.89 && at[2] < 0.29;
        if (!on_x && !on_y) continue;
        CHECK(hit[0].triangle < 12);
        shared++;
    }
    CHECK(shared > 5000);
    for (int k = 0; k < 3; k++) tracer_destroy(s[k].tracer);
    hand_free(&model);
}

/* Rays from all around at places on the model, many of them on edges and corners; in twos and threes from one place. */
static void aim(double o[3][hits_capacity], double d[3][hits_capacity], int count, const Model *model)
{
    for (int i = 0; i < count; i++) {
        const uint32_t *corner = model->triangle[(int)hand_uniform(0, model->triangle_count)];
        double w[3] = {hand_uniform(0, 1), i % 3 ? hand_uniform(0, 1) : 0, i % 5 ? hand_uniform(0, 1) : 0}, way[3];
        const double sum = w[0] + w[1] + w[2], away_m = exp(hand_uniform(-3, 8)), aside_m = i % 2 ? 0 : 2e-5;
        hand_direction(way);
        for (int c = 0; c < 3; c++) {
            const double at = (w[0] * model->vertex[corner[0]][c] + w[1] * model->vertex[corner[1]][c] +
                               w[2] * model->vertex[corner[2]][c]) /
                                  sum +
                              hand_uniform(-aside_m, aside_m);
            d[c][i] = i % 4 == 3 ? d[c][i - 1] : way[c];
            o[c][i] = i % 4 == 1 ? o[c][i - 1] : at - away_m * way[c];
        }
        double between[3] = {0, 0, 0};
        if (i % 4 != 1) continue;
        for (int c = 0; c < 3; c++) between[c] = model->vertex[corner[0]][c] - o[c][i];
        v3_normalize(between, between);
        for (int c = 0; c < 3; c++) d[c][i] = between[c];
    }
}

/* A ray's answer is its own: alone, or with others in any order and number, by any instructions, asked or skipped. */
static void check_company(const Model *model, int blocks)
{
    static const char *const isa[3] = {"avx2", "sse4.2", ""};
    static double            o[3][hits_capacity], d[3][hits_capacity], far_m[hits_capacity];
    PosedEntity              entity[3] = {0};
    Tracer                  *tracer[3];
    double                   attitude[9];
    int                      met_count = 0, missed_count = 0;
    NodePose                *pose = calloc((size_t)model->node_count, sizeof *pose);
    model_pose(pose, model, NULL);
    m3_identity(attitude);
    for (int k = 0; k < 3; k++) {
        assert_int_equal(tracer_create_models(&tracer[k], &model, 1, isa[k]), STATUS_OK);
        entity[k].node = calloc((size_t)parts_node_count(tracer[k], 0), sizeof *entity[k].node);
        parts_pose(&entity[k], tracer[k], 0, pose, (const double[3]){0, 0, 0}, attitude, 0);
    }
    for (int b = 0; b < blocks; b++) {
        const int           count = b % 3 ? hits_capacity : (int)hand_uniform(1, 40);
        const double *const o_enu[3] = {o[0], o[1], o[2]}, *const d_enu[3] = {d[0], d[1], d[2]};
        int list[hits_capacity];
        aim(o, d, count, model);
        for (int i = 0; i < count; i++) {
            far_m[i] = b % 4 ? INFINITY : exp(hand_uniform(-3, 8));
            const int other = (int)hand_uniform(0, i + 1);
            list[i] = i == other ? i : list[other];
            list[other] = i;
        }
        for (int k = 0; k < 3; k++) {
            double  range_m[hits_capacity];
            PartHit hit[hits_capacity] = {{0}};
            uint8_t met[hits_capacity] = {0};
            for (int i = 0; i < count; i++) range_m[i] = INFINITY;
            parts_first_hits(range_m, hit, &entity[k], o_enu, d_enu, far_m, list, count, b % 2);
            parts_any_hits(met, &entity[k], o_enu, d_enu, far_m, list, count, b % 2);
            for (int i = 0; i < count; i++) {
                const double one_o[3] = {o[0][i], o[1][i], o[2][i]}, one_d[3] = {d[0][i], d[1][i], d[2][i]};
                PartHit      alone = {0};
                const double want_m = parts_first_hit(&alone, &entity[0], one_o, one_d, far_m[i], false);
                if (!(range_m[i] == want_m && hit[i].node == alone.node && hit[i].triangle == alone.triangle))
                    fail_msg("%s: block %d ray %d: %.17g m, triangle %u; alone %.17g, %u", isa[k], b, i, range_m[i],
                             hit[i].triangle, want_m, alone.triangle);
                /* of ties the lowest is the first hit: up to 0.1 mm beyond the nearest */
                if (far_m[i] < INFINITY) CHECK(met[i] || !(want_m < INFINITY));
                else CHECK(met[i] == (want_m < INFINITY) && met[i] == parts_occluded(&entity[k], one_o, one_d, b % 2));
                *(want_m < INFINITY ? &met_count : &missed_count) += 1;
            }
        }
    }
    CHECK(met_count > 500 && missed_count > 50);
    for (int k = 0; k < 3; k++) {
        tracer_destroy(tracer[k]);
        free(entity[k].node);
    }
    free(pose);
}

static void company_does_not_show(void **state)
{
    (void)state;
    Model model;
    hand_model(&model, 1, 16, 24);
    hand_box_into(&model, 0, (const double[3]){-1, -0.7, -0.9}, (const double[3]){1, 0.8, 1.1});
    hand_box_into(&model, 0, (const double[3]){-0.6, -0.71, -0.9}, (const double[3]){1, 0.8, 0.3});
    check_company(&model, 30);
    hand_free(&model);
    hand_sphere(&model, 2, 48); /* 48 triangles meet at its poles */
    check_company(&model, 30);
    hand_free(&model);
}

static void company_does_not_show_on(const char *name, int blocks)
{
    char        path[512];
    Model       model;
    ModelImport report;
    if (!reference_path(path, name)) skip();
    assert_int_equal(model_import(&model, &report, path), STATUS_OK);
    check_company(&model, blocks);
    model_destroy(&model);
}

/* Regions with faces in one place. */
static void company_does_not_show_on_a_tank(void **state)
{
    (void)state;
    company_does_not_show_on("models/brlcad/ktank.obj", 20);
}

static void company_does_not_show_on_a_truck(void **state)
{
    (void)state;
    company_does_not_show_on("models/brlcad/truck.obj.gz", 20);
}

/* Sheets of this size one behind the other, the highest number nearest, the last dozen within 0.1 mm of it. Distance
 * and triangle that a ray through all of them meets first. */
static double first_of_sheets(uint32_t *triangle, double size_m)
{
    enum { sheets = 40 };
    Model   model;
    Tracer *tracer;
    hand_model(&model, 1, 3 * sheets, sheets);
    for (int k = 0; k < sheets; k++) {
        const double x = k < sheets - 12 ? 0.01 * (sheets - k) : -1e-6 * k;
        const int    a = hand_vertex(&model, x, -size_m, 0), b = hand_vertex(&model, x, size_m, 0),
                  c = hand_vertex(&model, x, 0, -2 * size_m);
        hand_triangle(&model, 0, a, b, c);
    }
    const Model   *models = &model;
    const NodePose pose = at_rest();
    PosedNode      node[1];
    PosedEntity    entity = {.node = node};
    PartHit        hit = {0};
    assert_int_equal(tracer_create_models(&tracer, &models, 1, ""), STATUS_OK);
    parts_pose(&entity, tracer, 0, &pose, (const double[3]){0, 0, 0}, (const double[9]){1, 0, 0, 0, 1, 0, 0, 0, 1}, 0);
    const double range_m = parts_first_hit(&hit, &entity, (const double[3]){-5 * size_m, 0, -0.5 * size_m},
                                           (const double[3]){1, 0, 0}, INFINITY, false);
    tracer_destroy(tracer);
    hand_free(&model);
    *triangle = hit.triangle;
    return range_m;
}

/* More triangles in one place than are kept: the lowest of all, found by looking at each. At any size of model some
 * triangle of them is the answer. */
static void a_crowd_is_asked_again(void **state)
{
    (void)state;
    uint32_t triangle;
    CHECK_NEAR(first_of_sheets(&triangle, 1), 5 - 1e-6 * (40 - 12), 1e-14);
    assert_int_equal(triangle, 40 - 12);
    static const double size_m[] = {1e-2, 10, 1e3, 1e5, 1e7};
    for (int k = 0; k < 5; k++) {
        CHECK_NEAR(first_of_sheets(&triangle, size_m[k]), 5 * size_m[k], 1e-4 + 1e-14 * size_m[k]);
        CHECK(triangle >= 40 - 12 && triangle < 40);
    }
}

static void a_wrong_instruction_set_is_refused(void **state)
{
    (void)state;
    Tracer *tracer = NULL;
    log_set_level(LOG_ERROR + 1);
    assert_int_equal(tracer_create_models(&tracer, NULL, 0, "avx9,verbose=3"), STATUS_BAD_VALUE);
    log_set_level(LOG_INFO);
    assert_null(tracer);
    assert_int_equal(tracer_create_models(&tracer, NULL, 0, NULL), STATUS_OK);
    tracer_destroy(tracer);
    tracer_destroy(NULL);
}

/* Farther than Embree's floats go, and from nowhere: its own assertion would end the program. */
static void rays_from_beyond_any_float_meet_nothing(void **state)
{
    (void)state;
    static const double from[4][3] = {{1e30, 0, 0}, {0, 1e300, 1e300}, {INFINITY, 0, 0}, {NAN, 0, 0}};
    const double        aside[3] = {0, 0, 1};
    Model               model;
    Scene               s;
    hand_plate(&model, 1.5, 1);
    scene_open(&s, &model, "avx2");
    const NodePose pose = at_rest();
    scene_pose(&s, &pose, (const double[3]){0, 0, 0}, (const double[9]){1, 0, 0, 0, 1, 0, 0, 0, 1});
    for (int k = 0; k < 8; k++) {
        PartHit hit;
        CHECK(isinf(parts_first_hit(&hit, &s.entity, from[k / 2], aside, INFINITY, k % 2)));
        CHECK(!parts_occluded(&s.entity, from[k / 2], aside, k % 2));
    }
    tracer_destroy(s.tracer);
    hand_free(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plate_is_as_far_as_paper_says),
        cmocka_unit_test(a_closed_box_does_not_leak),
        cmocka_unit_test(a_sphere_has_its_radius_and_its_normals),
        cmocka_unit_test(nodes_are_where_their_poses_put_them),
        cmocka_unit_test(edge_on_stays_between_the_corners),
        cmocka_unit_test(every_set_of_instructions_agrees),
        cmocka_unit_test(faces_in_one_place_are_the_lowest),
        cmocka_unit_test(company_does_not_show),
        cmocka_unit_test(company_does_not_show_on_a_tank),
        cmocka_unit_test(company_does_not_show_on_a_truck),
        cmocka_unit_test(a_crowd_is_asked_again),
        cmocka_unit_test(a_wrong_instruction_set_is_refused),
        cmocka_unit_test(rays_from_beyond_any_float_meet_nothing),
    };
    thread_flush_denormals();
    alarm(120); /* a tracer that never returns is a failure, not a wait */
    return cmocka_run_group_tests(tests, NULL, NULL);
}
