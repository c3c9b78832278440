/* What rays meet of scenery, against looking at every triangle of 2,000 objects in double (Moller and Trumbore, 1997):
 * first hits, shadows, what drives, rays that bend, an eye within a house; and the same bits whatever is skipped and
 * with any number of threads. */
#include "tests/render/hand_models.h"

#include "render/trace/scenery/scenery_tracer.h"

enum { kinds = 5, objects = 2000, drivers = 60, most_triangles = 60000 };

static const double wide_m = 180, high_m = 20;

typedef struct Triangle {
    double corner[3][3]; /* ENU */
    int    object;
    int    of_model;
} Triangle;

typedef struct Stage {
    Model          model[kinds];
    SceneryObject  object[objects];
    SceneryMover   mover[drivers];
    double         path[3 * drivers][3];
    Scenery        scenery;
    SceneryTracer *tracer;
    Tracer        *none;
    Snapshot       snapshot;
    LocalFrame     frame;
    Arena         *arena;
    Triangle      *triangle;
    int            triangles;
} Stage;

static Stage              stage;
static Rays               rays;
static Hits               hits, again;
static VisibilityCounters counters;

/* A box on a box, turned a little: two nodes and two parts. */
static void hand_turret(Model *m)
{
    hand_model(m, 2, 16, 24);
    hand_box_into(m, 0, (const double[3]){-3, -1.5, -1.2}, (const double[3]){3, 1.5, 0});
    hand_box_into(m, 1, (const double[3]){-1, -1, -1}, (const double[3]){1.5, 1, 0});
    m->node[1].parent = 0;
    m->node[1].p_parent[2] = -1.2;
    const double c = cos(0.4), s = sin(0.4), r[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
    memcpy(m->node[1].r_parent_from_node, r, sizeof r);
    m->part[1].damage_hidden = 1 << 3; /* destroyed: the upper box is gone */
}

static int open_stage(void **state)
{
    (void)state;
    const Geodetic origin = {0.6, -1.9, 700};
    hand_box(&stage.model[0], (const double[3]){-5, -4, -6}, (const double[3]){5, 4, 0});
    hand_plate(&stage.model[1], 6, 3);
    hand_sphere(&stage.model[2], 3, 5);
    hand_turret(&stage.model[3]);
    hand_box(&stage.model[4], (const double[3]){-0.05, -0.05, -9}, (const double[3]){0.05, 0.05, 0});
    stage.scenery = (Scenery){.models = kinds,
                              .objects = objects,
                              .movers = drivers,
                              .paths = 3 * drivers,
                              .model = stage.model,
                              .object = stage.object,
                              .mover = stage.mover,
                              .path_enu = stage.path};
    hand_draw = 4711;
    for (int k = 0; k < objects; k++) {
        SceneryObject *o = &stage.object[k];
        *o = (SceneryObject){.model = k % kinds, .damage = k % 20 == 3 ? 3 : 0, .state = -1};
        for (int c = 0; c < 2; c++) o->p_enu[c] = hand_uniform(-wide_m, wide_m);
        o->p_enu[2] = hand_uniform(0, high_m);
        hand_rotation(o->r_enu_from_body);
        if (k % 100 == 7) memcpy(o, o - 5, sizeof *o); /* in the place of another */
    }
    for (int k = 0; k < drivers; k++) {
        stage.mover[k] =
            (SceneryMover){.object = 11 + 31 * k, .first = 3 * k, .count = 3, .speed_mps = 8, .phase_m = k};
        for (int n = 0; n < 3; n++) {
            for (int c = 0; c < 2; c++) stage.path[3 * k + n][c] = hand_uniform(-wide_m, wide_m);
            stage.path[3 * k + n][2] = hand_uniform(0, high_m);
        }
    }
    stage.arena = arena_create();
    stage.triangle = malloc(most_triangles * sizeof *stage.triangle);
    return stage.arena && stage.triangle && local_frame_at(&stage.frame, &origin) == STATUS_OK &&
                   tracer_create_models(&stage.none, NULL, 0, "avx2") == STATUS_OK &&
                   scenery_tracer_create(&stage.tracer, &stage.scenery, "avx2") == STATUS_OK
               ? 0
               : -1;
}

static int close_stage(void **state)
{
    (void)state;
    scenery_tracer_destroy(stage.tracer);
    tracer_destroy(stage.none);
    arena_destroy(stage.arena);
    free(stage.triangle);
    for (int m = 0; m < kinds; m++) hand_free(&stage.model[m]);
    return 0;
}

/* The frame of an exercise time; *frame may be NULL. */
static const Visibility *see(const SceneryFrame **frame, double t_s, unsigned skips_off, const double eye_enu[3],
                             double bend_per_m)
{
    Visibility            *v;
    SceneryFrame          *f;
    const VisibilityConfig config = {.tracer = stage.none,
                                     .frame = &stage.frame,
                                     .snapshot = &stage.snapshot,
                                     .skips_off = skips_off,
                                     .eye_enu = {eye_enu[0], eye_enu[1], eye_enu[2]},
                                     .bend_per_m = bend_per_m};
    const SceneryFrameOf   of = {t_s, skips_off, {eye_enu[0], eye_enu[1], eye_enu[2]}, bend_per_m};
    assert_int_equal(visibility_create_seen(&v, &config, stage.arena), STATUS_OK);
    assert_int_equal(scenery_frame_create(&f, stage.tracer, &of, stage.arena), STATUS_OK);
    assert_int_equal(scenery_frame_join(v, f), STATUS_OK);
    CHECK(scenery_frame_in(v) == f);
    if (frame) *frame = f;
    return v;
}

/* ---- every triangle ------------------------------------------------------------------------------- */

/* Of all objects, posed here, at exercise time t_s. */
static void list_triangles(double t_s)
{
    stage.triangles = 0;
    for (int k = 0; k < objects; k++) {
        const SceneryObject *o = &stage.object[k];
        const Model         *m = &stage.model[o->model];
        double               p_enu[3], r[9];
        NodePose             node[2];
        memcpy(p_enu, o->p_enu, sizeof p_enu), memcpy(r, o->r_enu_from_body, sizeof r);
        for (int n = 0; n < drivers; n++)
            if (stage.mover[n].object == k) scenery_pose(p_enu, r, &stage.scenery, &stage.mover[n], t_s);
        model_pose(node, m, NULL);
        for (int t = 0; t < m->triangle_count; t++) {
            const ModelPart *part = &m->part[m->triangle_part[t]];
            Triangle        *to = &stage.triangle[stage.triangles];
            if (part->damage_hidden >> o->damage & 1) continue;
            *to = (Triangle){.object = k, .of_model = t};
            for (int c = 0; c < 3; c++) {
                double p_body[3];
                m3_mul_v3(p_body, node[part->node].r_body_from_node, m->vertex[m->triangle[t][c]]);
                v3_add(p_body, p_body, node[part->node].p_body);
                m3_mul_v3(to->corner[c], r, p_body);
                v3_add(to->corner[c], to->corner[c], p_enu);
            }
            CHECK(++stage.triangles < most_triangles);
        }
    }
}

/* inside: how far within its edges, as a share of it; negative: outside. */
static double meet(double *inside, const Triangle *t, const double o[3], const double d[3])
{
    double ab[3], ac[3], p[3], q[3], s[3];
    v3_sub(ab, t->corner[1], t->corner[0]);
    v3_sub(ac, t->corner[2], t->corner[0]);
    v3_cross(p, d, ac);
    const double det = v3_dot(ab, p);
    *inside = -1;
    if (det == 0) return INFINITY;
    v3_sub(s, o, t->corner[0]);
    const double u = v3_dot(s, p) / det;
    v3_cross(q, s, ab);
    const double v = v3_dot(d, q) / det, range_m = v3_dot(ac, q) / det;
    *inside = fmin(fmin(u, v), 1 - u - v);
    return range_m > 0 ? range_m : INFINITY;
}

typedef struct First {
    double range_m;
    int    object, triangle; /* -1: none */
    bool   doubtful;         /* within 1e-7 of an edge, or of another object's triangle: rounding decides */
} First;

static First look(const double o[3], const double d[3], double lift_per_object[objects])
{
    First first = {INFINITY, -1, -1, false};
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < stage.triangles; k++) {
            const Triangle *t = &stage.triangle[k];
            const double    from[3] = {o[0], o[1], o[2] - (lift_per_object ? lift_per_object[t->object] : 0)};
            double          inside;
            const double    range_m = meet(&inside, t, from, d);
            if (pass == 1) {
                first.doubtful |= fabs(inside) < 1e-7 && range_m < first.range_m + 1e-6;
                first.doubtful |= inside > -1e-7 && fabs(range_m - first.range_m) < 2e-4 &&
                                  (t->object != first.object || t->of_model != first.triangle);
            } else if (inside >= 0 && range_m < first.range_m) {
                first = (First){range_m, t->object, t->of_model, false};
            }
        }
    return first;
}

static void add_ray(const double o[3], const double d[3], double far_m)
{
    const int i = rays.count++;
    for (int c = 0; c < 3; c++) rays.o_enu[c][i] = o[c], rays.d_enu[c][i] = d[c];
    rays.far_m[i] = far_m;
}

static void clear_rays(int columns, bool bent) { rays.count = 0, rays.columns = columns, rays.bent = bent; }

/* A picture's block from an eye. */
static void look_from(const double eye_enu[3], const double ahead[3], int side, double width, bool bent)
{
    double x[3] = {1}, y[3], z[3] = {1};
    v3_normalize(z, ahead);
    v3_cross(x, z, (const double[3]){0, 0.1, 1});
    v3_normalize(x, x);
    v3_cross(y, z, x);
    clear_rays(side, bent);
    for (int row = 0; row < side; row++)
        for (int column = 0; column < side; column++) {
            double d[3];
            v3_add_scaled(d, z, width * ((column + 0.5) / side - 0.5), x);
            v3_add_scaled(d, d, width * ((row + 0.5) / side - 0.5), y);
            v3_normalize(d, d);
            add_ray(eye_enu, d, INFINITY);
        }
}

/* Every hit of the block is what looking at all triangles finds; returns how many met something. */
static int check_hits(const Visibility *v, double *lift_m)
{
    int met = 0, doubtful = 0;
    visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &counters);
    for (int i = 0; i < rays.count; i++) {
        const double o[3] = {rays.o_enu[0][i], rays.o_enu[1][i], rays.o_enu[2][i]};
        const double d[3] = {rays.d_enu[0][i], rays.d_enu[1][i], rays.d_enu[2][i]};
        const First  first = look(o, d, lift_m);
        if (first.doubtful) {
            doubtful++;
            continue;
        }
        if (first.object < 0 || first.range_m >= rays.far_m[i]) {
            CHECK(hits.kind[i] == hit_sky && isinf(hits.range_m[i]) && hits.instance[i] == 0);
            continue;
        }
        const Model *m = &stage.model[stage.object[first.object].model];
        met++;
        CHECK(hits.kind[i] == hit_scenery && hits.entity[i] == 0);
        CHECK_NEAR(hits.range_m[i], first.range_m, 1e-9 * (1 + first.range_m));
        assert_int_equal(hits.instance[i], first.object + 1);
        assert_int_equal(hits.facet[i], first.triangle);
        assert_int_equal(hits.model[i], stage.object[first.object].model);
        assert_int_equal(hits.part[i], m->triangle_part[first.triangle] + 1);
        const double lift = lift_m ? lift_m[first.object] : 0;
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(hits.p_enu[c][i], o[c] - (c == 2 ? lift : 0) + first.range_m * d[c], 1e-6);
        const double n[3] = {hits.n_geo[0][i], hits.n_geo[1][i], hits.n_geo[2][i]};
        CHECK(v3_dot(n, d) <= 0 && fabs(v3_length(n) - 1) < 1e-6);
    }
    CHECK(doubtful < 8 + rays.count / 10);
    return met;
}

/* ---- the tests ------------------------------------------------------------------------------------ */

static void a_picture_shows_the_nearest_triangles(void **state)
{
    (void)state;
    static const double eye[4][3] = {{-230, 20, 12}, {0, 0, 300}, {10, 5, 15}, {900, -2000, 40}};
    static const double ahead[4][3] = {{1, 0, 0}, {0.1, 0.2, -1}, {1, 1, 0.1}, {-0.4, 1, -0.02}};
    static const double width[4] = {0.4, 1.2, 1.2, 0.1};
    int                 met = 0;
    list_triangles(0);
    for (int k = 0; k < 4; k++) {
        arena_reset(stage.arena);
        const Visibility *v = see(NULL, 0, 0, eye[k], 0);
        look_from(eye[k], ahead[k], 20, width[k], false);
        met += check_hits(v, NULL);
    }
    print_message("%d met\n", met);
    CHECK(met > 500);
}

/* From anywhere to anywhere, some of them with a limit, and from within. */
static void strewn_rays_meet_the_nearest_triangles(void **state)
{
    (void)state;
    int met = 0;
    list_triangles(0);
    arena_reset(stage.arena);
    const Visibility *v = see(NULL, 0, 0, (const double[3]){0, 0, 0}, 0);
    clear_rays(0, false);
    hand_draw = 12;
    for (int i = 0; i < 600; i++) {
        double o[3], d[3];
        for (int c = 0; c < 2; c++) o[c] = hand_uniform(-wide_m, wide_m);
        o[2] = hand_uniform(0, high_m);
        if (i % 4 == 0) memcpy(o, stage.object[5 * i % objects].p_enu, sizeof o), o[2] += 0.01;
        hand_direction(d);
        add_ray(o, d, i % 3 == 0 ? 40 : INFINITY);
    }
    met = check_hits(v, NULL);
    CHECK(met > 200);
}

/* A closed box from its inside: every ray meets its inner side. */
static void an_eye_in_a_house_sees_its_walls(void **state)
{
    (void)state;
    SceneryObject      *o = &stage.object[0];
    const SceneryObject kept = *o;
    static const double up[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    SceneryTracer      *tracer = NULL, *before = stage.tracer;
    const double        eye[3] = {2000, 2000, 1};
    memcpy(o->r_enu_from_body, up, sizeof up);
    o->p_enu[0] = 2000, o->p_enu[1] = 2000, o->p_enu[2] = 0;
    assert_int_equal(scenery_tracer_create(&tracer, &stage.scenery, "avx2"), STATUS_OK);
    stage.tracer = tracer;
    arena_reset(stage.arena);
    const Visibility *v = see(NULL, 0, 0, eye, 0);
    clear_rays(0, false);
    for (int i = 0; i < 1000; i++) {
        double d[3];
        hand_direction(d);
        add_ray(eye, d, INFINITY);
    }
    visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &counters);
    for (int i = 0; i < rays.count; i++) { /* half sides 4 m east, 5 m north; 5 m to the roof, 1 m to the floor */
        const double side[3] = {4, 5, rays.d_enu[2][i] > 0 ? 5 : 1};
        double       want_m = INFINITY;
        for (int c = 0; c < 3; c++) want_m = fmin(want_m, side[c] / fabs(rays.d_enu[c][i]));
        CHECK(hits.kind[i] == hit_scenery && hits.inside[i] == 1);
        assert_int_equal(hits.instance[i], 1);
        CHECK_NEAR(hits.range_m[i], want_m, 1e-9);
    }
    stage.tracer = before;
    scenery_tracer_destroy(tracer);
    *o = kept;
}

static void what_drives_is_where_it_is_then(void **state)
{
    (void)state;
    static const double eye[3] = {-230, 20, 12};
    int                 moved = 0;
    for (int k = 0; k < 2; k++) {
        const double        t_s = k ? 1234.5 : 17;
        const SceneryFrame *frame;
        list_triangles(t_s);
        arena_reset(stage.arena);
        const Visibility *v = see(&frame, t_s, 0, eye, 0);
        look_from(eye, (const double[3]){1, 0, 0}, 20, 0.4, false);
        CHECK(check_hits(v, NULL) > 100);
        for (int n = 0; n < drivers; n++) { /* and each of them, looked at from above */
            const PosedEntity *posed = scenery_frame_posed(frame, stage.mover[n].object);
            double             p_enu[3], r[9];
            scenery_pose(p_enu, r, &stage.scenery, &stage.mover[n], t_s);
            CHECK(memcmp(p_enu, posed->p_enu, sizeof p_enu) == 0);
            clear_rays(0, false);
            for (int i = 0; i < 3; i++)
                add_ray(
                    (const double[3]){posed->centre_enu[0] + 0.01 * i, posed->centre_enu[1], posed->centre_enu[2] + 9},
                    (const double[3]){0.02, 0.01, -0.99975}, INFINITY);
            check_hits(v, NULL);
            for (int i = 0; i < 3; i++) moved += hits.instance[i] == (uint32_t)stage.mover[n].object + 1;
        }
    }
    CHECK(moved > drivers);
}

/* An object is raised as a whole; its hit is where it is. */
static void bent_rays_meet_what_is_raised(void **state)
{
    (void)state;
    static const double eye[3] = {-9000, 3000, 60}, bend_per_m = 2e-7; /* ten times the air's */
    static double       lift_m[objects];
    const SceneryFrame *frame;
    list_triangles(5);
    arena_reset(stage.arena);
    const Visibility *v = see(&frame, 5, 0, eye, bend_per_m);
    for (int k = 0; k < objects; k++) {
        const double *centre = scenery_frame_posed(frame, k)->centre_enu;
        lift_m[k] =
            bend_per_m * ((centre[0] - eye[0]) * (centre[0] - eye[0]) + (centre[1] - eye[1]) * (centre[1] - eye[1]));
        CHECK_NEAR(scenery_frame_lift(frame, k), lift_m[k], 1e-9);
        CHECK(lift_m[k] > 10);
    }
    look_from(eye, (const double[3]){9000, -3000, -32}, 20, 0.006, true);
    const int met = check_hits(v, lift_m);
    print_message("%d met\n", met);
    CHECK(met > 100);
}

static void shadows_fall_where_some_triangle_is(void **state)
{
    (void)state;
    static const double sun[3][3] = {{0.3, 0.5, 0.8}, {-1, 0.2, 0.05}, {0, 0, 1}}, eye[3] = {-230, 20, 12};
    list_triangles(3);
    for (int s = 0; s < 3; s++) {
        uint8_t dark[hits_capacity];
        double  way[3] = {1};
        int     shaded = 0, lit = 0, doubtful = 0;
        v3_normalize(way, sun[s]);
        arena_reset(stage.arena);
        const Visibility *v = see(NULL, 3, 0, eye, 0);
        look_from(eye, (const double[3]){1, 0, 0}, 20, 0.4, false);
        visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &counters);
        visibility_shadow(dark, v, &hits, way, &counters);
        for (int i = 0; i < hits.count; i++) {
            const double n[3] = {hits.n_geo[0][i], hits.n_geo[1][i], hits.n_geo[2][i]};
            double       from[3];
            if (hits.kind[i] == hit_sky) continue;
            if (!(v3_dot(n, way) > 0)) {
                CHECK(dark[i] == 1);
                continue;
            }
            for (int c = 0; c < 3; c++) from[c] = hits.p_enu[c][i] + 1e-3 * n[c];
            const First first = look(from, way, NULL);
            if (first.doubtful) doubtful++;
            else CHECK(dark[i] == (first.object >= 0));
            shaded += dark[i], lit += !dark[i];
        }
        print_message("%d in shade, %d lit, %d doubtful\n", shaded, lit, doubtful);
        CHECK(shaded > 10 && lit > 5 && doubtful < 60);
    }
}

/* Hits and shadows to the bit. */
static void same(const Hits *a, const Hits *b, const uint8_t *dark_a, const uint8_t *dark_b)
{
    const size_t n = (size_t)a->count;
    CHECK(a->count == b->count && memcmp(a->range_m, b->range_m, n * sizeof *a->range_m) == 0);
    CHECK(memcmp(a->kind, b->kind, n) == 0 && memcmp(a->instance, b->instance, n * sizeof *a->instance) == 0);
    CHECK(memcmp(a->facet, b->facet, n * sizeof *a->facet) == 0 && memcmp(a->part, b->part, n * sizeof *a->part) == 0);
    CHECK(memcmp(a->inside, b->inside, n) == 0 && memcmp(dark_a, dark_b, n) == 0);
    for (int c = 0; c < 3; c++)
        CHECK(memcmp(a->n_enu[c], b->n_enu[c], n * sizeof(float)) == 0 &&
              memcmp(a->p_enu[c], b->p_enu[c], n * sizeof(double)) == 0);
}

static void skipping_changes_no_bit(void **state)
{
    (void)state;
    static const Skip   skip[] = {SKIP_SCENERY, SKIP_PART, SKIP_SUN_STOPPED};
    static const double eye[2][3] = {{-230, 20, 12}, {-3000, 900, 40}}, sun[3] = {0.36, 0.48, 0.8};
    uint8_t             dark[hits_capacity], dark_again[hits_capacity];
    for (int k = 0; k < 2; k++)
        for (int s = 0; s < 4; s++) {
            const unsigned off = s < 3 ? 1u << skip[s] : skips_all_off;
            arena_reset(stage.arena);
            look_from(eye[k], (const double[3]){-eye[k][0], -eye[k][1], -15}, 16, k ? 0.2 : 0.7, k == 1);
            const Visibility *v = see(NULL, 3, 0, eye[k], k ? 1e-7 : 0), *w = see(NULL, 3, off, eye[k], k ? 1e-7 : 0);
            memset(&counters, 0, sizeof counters);
            visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &counters);
            visibility_shadow(dark, v, &hits, sun, &counters);
            CHECK(counters.skipped[SKIP_SCENERY] > 100000 && counters.rays_scenery > 0);
            memset(&counters, 0, sizeof counters);
            visibility_first_hit(&again, w, &rays, visibility_all_but(-1), &counters);
            visibility_shadow(dark_again, w, &again, sun, &counters);
            if (off >> SKIP_SCENERY & 1) CHECK(counters.skipped[SKIP_SCENERY] == 0);
            same(&hits, &again, dark, dark_again);
        }
}

/* Places in, above and far outside of what stands, by a sun of many heights (one below the horizon) and azimuths, with
 * what drives and what is damaged in the course: shadows to the bit as when every object is asked, and rays that begin
 * above everything that stands are not asked at all. */
static void rays_to_the_sun_are_left_out_only_above_all(void **state)
{
    (void)state;
    static const double height_deg[] = {-4, 0, 0.3, 2, 7, 20, 45, 80, 89.9999999, 90};
    enum { heights = sizeof height_deg / sizeof *height_deg, azimuths = 5, places = 160, damages = 40 };
    static SceneryHarm harm[damages];
    const double       eye[3] = {0, 0, 50};
    Scenery            scenery = stage.scenery;
    SceneryTracer     *harmed = NULL, *before = stage.tracer;
    int                shaded = 0;
    uint8_t            dark[hits_capacity], dark_again[hits_capacity];
    hand_draw = 77;
    for (int k = 0; k < damages; k++) harm[k] = (SceneryHarm){.object = 50 * k + 3, .t_s = k % 2 ? 0 : 10, .damage = 3};
    scenery.harms = damages, scenery.harm = harm;
    assert_int_equal(scenery_tracer_create(&harmed, &scenery, "avx2"), STATUS_OK);
    stage.tracer = harmed;
    for (int e = 0; e < heights; e++)
        for (int a = 0; a < azimuths; a++) {
            const double up = e == heights - 1 ? 1 : sin(height_deg[e] * rad_per_deg);
            const double level = sqrt(1 - up * up), azimuth = 2 * pi_rad * hand_uniform(0, 1);
            const double way[3] = {level * sin(azimuth), level * cos(azimuth), up};
            arena_reset(stage.arena);
            const Visibility *v = see(NULL, 4, 0, eye, 0), *w = see(NULL, 4, skips_all_off, eye, 0);
            memset(&hits, 0, sizeof hits);
            hits.count = places;
            for (int i = 0; i < places; i++) {
                const double wide = i % 4 == 3 ? 12 * wide_m : 1.2 * wide_m;
                hits.kind[i] = hit_ground, hits.range_m[i] = 1;
                for (int c = 0; c < 2; c++) hits.p_enu[c][i] = hand_uniform(-wide, wide);
                hits.p_enu[2][i] = hand_uniform(-10, high_m + 12);
                for (int c = 0; c < 3; c++) hits.n_geo[c][i] = hits.n_enu[c][i] = (float)way[c];
            }
            visibility_shadow(dark, v, &hits, way, &counters);
            visibility_shadow(dark_again, w, &hits, way, &counters);
            CHECK(memcmp(dark, dark_again, places) == 0);
            for (int i = 0; i < places; i++) shaded += dark[i];
            if (!(way[2] > 0)) continue;
            for (int i = 0; i < places; i++) hits.p_enu[2][i] += 2 * high_m;
            memset(&counters, 0, sizeof counters);
            visibility_shadow(dark, v, &hits, way, &counters);
            CHECK(counters.rays_sun_scenery == 0);
        }
    print_message("%d of %d in shade\n", shaded, heights * azimuths * places);
    CHECK(shaded > 500 && shaded < heights * azimuths * places / 2);
    stage.tracer = before;
    scenery_tracer_destroy(harmed);
}

/* Cells about a house with a yard beside it: places in the yard, out of its shadow, ask nothing though the house's box
 * covers them. */
static void a_yard_asks_nothing(void **state)
{
    (void)state;
    static Model   model;
    SceneryObject  object = {.state = -1, .r_enu_from_body = {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    const Scenery  scenery = {.models = 1, .objects = 1, .model = &model, .object = &object};
    const double   eye[3] = {0, 0, 50}, way[3] = {0.6, 0, 0.8};
    SceneryTracer *tracer = NULL, *before = stage.tracer;
    uint8_t        dark[hits_capacity];
    hand_model(&model, 1, 16, 24);
    hand_box_into(&model, 0, (const double[3]){-5, -40, -8}, (const double[3]){5, -30, 0}); /* in the west */
    hand_box_into(&model, 0, (const double[3]){-5, 30, -8}, (const double[3]){5, 40, 0});   /* in the east */
    assert_int_equal(scenery_tracer_create(&tracer, &scenery, "avx2"), STATUS_OK);
    stage.tracer = tracer;
    arena_reset(stage.arena);
    const Visibility *v = see(NULL, 0, 0, eye, 0);
    memset(&hits, 0, sizeof hits);
    memset(&counters, 0, sizeof counters);
    hits.count = 40;
    for (int i = 0; i < 40; i++) {
        hits.kind[i] = hit_ground, hits.range_m[i] = 1, hits.n_geo[2][i] = hits.n_enu[2][i] = 1;
        hits.p_enu[0][i] = -19.5 + i; /* the eastern house's shadow begins 6 m before it, at 24 */
    }
    visibility_shadow(dark, v, &hits, way, &counters);
    for (int i = 0; i < 40; i++) CHECK(!dark[i]);
    CHECK(counters.rays_sun_scenery == 0);
    for (int i = 0; i < 40; i++) hits.p_enu[0][i] = 24.5 + 0.1 * i;
    visibility_shadow(dark, v, &hits, way, &counters);
    for (int i = 0; i < 40; i++) CHECK(dark[i] == 1);
    stage.tracer = before;
    scenery_tracer_destroy(tracer);
    hand_free(&model);
}

/* A ray of a block is what it is alone, and in any order of its block. */
static void a_block_is_the_sum_of_its_rays(void **state)
{
    (void)state;
    static const double eye[3] = {-230, 20, 12};
    static Rays         one;
    arena_reset(stage.arena);
    const Visibility *v = see(NULL, 3, 0, eye, 0);
    look_from(eye, (const double[3]){1, 0, 0}, 16, 0.4, false);
    visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &counters);
    for (int i = 0; i < rays.count; i++) {
        one.count = 1, one.far_m[0] = INFINITY;
        for (int c = 0; c < 3; c++) one.o_enu[c][0] = rays.o_enu[c][i], one.d_enu[c][0] = rays.d_enu[c][i];
        visibility_first_hit(&again, v, &one, visibility_all_but(-1), &counters);
        CHECK(again.range_m[0] == hits.range_m[i] && again.instance[0] == hits.instance[i]);
        CHECK(again.facet[0] == hits.facet[i] && again.n_enu[0][0] == hits.n_enu[0][i]);
    }
}

/* Two objects in one place: the lower has every hit. */
static void of_equals_the_lowest_object_is_met(void **state)
{
    (void)state;
    int low = 0;
    arena_reset(stage.arena);
    const Visibility *v = see(NULL, 0, 0, (const double[3]){0, 0, 500}, 0);
    for (int k = 7; k < objects; k += 100) {
        const double *p = stage.object[k].p_enu;
        clear_rays(0, false);
        for (int i = 0; i < 8; i++)
            add_ray((const double[3]){p[0] + 0.2 * i, p[1] + 0.1 * i, p[2] + 30}, (const double[3]){0, 0, -1},
                    INFINITY);
        visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &counters);
        for (int i = 0; i < 8; i++) {
            CHECK(hits.instance[i] != (uint32_t)k + 1);
            low += hits.instance[i] == (uint32_t)k - 5 + 1;
        }
    }
    CHECK(low > 10);
}

/* Seen from above on a grid: what a ray straight down meets of what stands. */
static void tops_are_what_rays_from_above_meet(void **state)
{
    (void)state;
    enum { side = 90 };
    static float z_m[side * side];
    const double cell_m = 2 * wide_m / (side - 1);
    int          covered = 0;
    for (int k = 0; k < side * side; k++) z_m[k] = -50;
    scenery_tracer_tops(z_m, stage.tracer, side, side, -wide_m, -wide_m, cell_m);
    list_triangles(0);
    for (int k = 0; k < side * side; k += 7) {
        const double o[3] = {-wide_m + k % side * cell_m, -wide_m + k / side * cell_m, 1000}, down[3] = {0, 0, -1};
        double       top_m = -50, inside;
        bool         doubtful = false;
        for (int t = 0; t < stage.triangles; t++) {
            const double range_m = meet(&inside, &stage.triangle[t], o, down);
            if (stage.triangle[t].object % 31 == 11 && stage.triangle[t].object < 11 + 31 * drivers) continue;
            doubtful |= fabs(inside) < 1e-7;
            if (inside >= 0 && range_m < INFINITY) top_m = fmax(top_m, 1000 - range_m);
        }
        if (doubtful) continue;
        CHECK_NEAR((double)z_m[k], top_m, 1e-4);
        covered += top_m > -50;
    }
    CHECK(covered > 200);
}

static void wrong_numbers_are_refused(void **state)
{
    (void)state;
    SceneryTracer *tracer = NULL;
    stage.object[3].model = kinds;
    CHECK(scenery_tracer_create(&tracer, &stage.scenery, "avx2") == STATUS_BAD_VALUE);
    stage.object[3].model = 3;
    stage.mover[2].count = 3 * drivers;
    CHECK(scenery_tracer_create(&tracer, &stage.scenery, "avx2") == STATUS_BAD_VALUE);
    stage.mover[2].count = 3;
    const double kept = stage.object[3].p_enu[0];
    stage.object[3].p_enu[0] = NAN; /* is not there; the others are */
    assert_int_equal(scenery_tracer_create(&tracer, &stage.scenery, "avx2"), STATUS_OK);
    scenery_tracer_destroy(tracer);
    stage.object[3].p_enu[0] = kept;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picture_shows_the_nearest_triangles),
        cmocka_unit_test(strewn_rays_meet_the_nearest_triangles),
        cmocka_unit_test(an_eye_in_a_house_sees_its_walls),
        cmocka_unit_test(what_drives_is_where_it_is_then),
        cmocka_unit_test(bent_rays_meet_what_is_raised),
        cmocka_unit_test(shadows_fall_where_some_triangle_is),
        cmocka_unit_test(skipping_changes_no_bit),
        cmocka_unit_test(rays_to_the_sun_are_left_out_only_above_all),
        cmocka_unit_test(a_yard_asks_nothing),
        cmocka_unit_test(a_block_is_the_sum_of_its_rays),
        cmocka_unit_test(of_equals_the_lowest_object_is_met),
        cmocka_unit_test(tops_are_what_rays_from_above_meet),
        cmocka_unit_test(wrong_numbers_are_refused),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
