/* Plants among ground and entities: the nearer of both, by either alone; full detail for every ray near an entity; the
 * sun's shadows. */
#include "tests/check.h"
#include "tests/render/hand_models.h"
#include "tests/render/hand_plants.h"

#include "render/trace/parts/parts.h"
#include "render/trace/visibility/visibility.h"

enum { trees = 300, side = 32 };

static const double calm[2] = {0, 0};

static struct {
    Landscape      landscape;
    Model          box;
    Tracer        *tracer;
    Arena         *arena;
    Plant          plant[trees];
    Woods          woods;
    Forest        *forest[2]; /* in full detail; simplified beyond any range */
    ForestFrame    plants[2];
    SnapshotEntity entity;
    NodePose       pose;
    Snapshot       snapshot;
    Visibility    *v[2];
    double         centre_enu[3], eye_enu[3];
} stage;

static double ground_at(double x, double y) { return elevation_height(&stage.landscape.elevation, x, y, NULL); }

/* A stand on the ground about a box of 6 x 3 x 2 m, seen from 60 m up. */
static int open_stage(void **state)
{
    LandscapeConfig config = landscape_default_config();
    const Geodetic  origin = {0.6, -1.9, 700};
    LocalFrame      frame;
    const double    zero[3] = {0, 0, 0}, r[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    (void)state;
    config.half_width_m = 500, config.horizon_m = 20000;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    if (landscape_create(&stage.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    hand_box(&stage.box, (const double[3]){-3, -1.5, -2}, (const double[3]){3, 1.5, 0});
    const Model *models[1] = {&stage.box};
    if (tracer_create_models(&stage.tracer, models, 1, "avx2") != STATUS_OK) return -1;
    if (!(stage.arena = arena_create())) return -1;
    hand_grow(false, 0.06);
    stage.woods = hand_stand(stage.plant, trees, zero, 50);
    for (int i = 0; i < trees; i++)
        stage.plant[i].p_m[2] = (float)ground_at((double)stage.plant[i].p_m[0], (double)stage.plant[i].p_m[1]);
    stage.centre_enu[2] = ground_at(0, 0) + 0.5;
    memcpy(stage.eye_enu, (const double[3]){10, -120, stage.centre_enu[2] + 60}, sizeof stage.eye_enu);
    stage.snapshot = (Snapshot){.entity = &stage.entity, .node = &stage.pose, .count = 1};
    stage.entity = (SnapshotEntity){.model = 0};
    ecef_from_enu(stage.entity.p_ecef, &frame, stage.centre_enu);
    m3_mul(stage.entity.r_ecef_from_body, frame.r_ecef_from_enu, r);
    stage.pose = (NodePose){{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (int k = 0; k < 2; k++) {
        const ForestConfig of = {.leaves = true, .level1_px = k ? 1000 : 0};
        if (forest_create(&stage.forest[k], &stage.woods, &hand_plants, &of, "avx2") != STATUS_OK) return -1;
        if (forest_frame_open(&stage.plants[k], stage.forest[k], stage.eye_enu, 300, 0, 0, calm, NULL, stage.arena) !=
            STATUS_OK)
            return -1;
        if (visibility_create(&stage.v[k], stage.tracer, &stage.landscape, &stage.landscape.frame, &stage.snapshot, 0,
                              stage.arena) != STATUS_OK)
            return -1;
        visibility_plants(stage.v[k], &stage.plants[k]);
    }
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        forest_frame_close(&stage.plants[k]);
        forest_destroy(stage.forest[k]);
    }
    landscape_destroy(&stage.landscape);
    tracer_destroy(stage.tracer);
    arena_destroy(stage.arena);
    hand_free(&stage.box);
    return 0;
}

static Rays rays;
static Hits hits, bare, other;

/* Rays from the eye over a square of the ground about the box, half_m to each side. */
static void look(double half_m)
{
    rays.count = side * side, rays.columns = side;
    for (int i = 0; i < rays.count; i++) {
        const double x = half_m * (2.0 * (i % side + 0.5) / side - 1), y = half_m * (2.0 * (i / side + 0.5) / side - 1);
        double       d[3] = {x - stage.eye_enu[0], y - stage.eye_enu[1], stage.centre_enu[2] - stage.eye_enu[2]};
        v3_normalize(d, d);
        for (int c = 0; c < 3; c++) rays.o_enu[c][i] = stage.eye_enu[c], rays.d_enu[c][i] = d[c];
        rays.far_m[i] = INFINITY;
    }
}

static void see(Hits *out, const Visibility *v)
{
    VisibilityCounters counters = {0};
    visibility_first_hit(out, v, &rays, visibility_all_but(-1), &counters);
}

/* Ranges of the plants alone, asked of the forest. */
static void alone(double range_m[hits_capacity], ForestHit hit[hits_capacity], int forest, const uint8_t *real)
{
    const double *const o[3] = {rays.o_enu[0], rays.o_enu[1], rays.o_enu[2]};
    const double *const d[3] = {rays.d_enu[0], rays.d_enu[1], rays.d_enu[2]};
    for (int i = 0; i < rays.count; i++) range_m[i] = INFINITY;
    forest_first_hits(range_m, hit, &stage.plants[forest], rays.count, o, d, real);
}

/* ---- first hits ------------------------------------------------------------------------------ */

static void the_nearer_of_both(void **state)
{
    static double    range_m[hits_capacity];
    static ForestHit hit[hits_capacity];
    int              of[4] = {0};
    (void)state;
    look(15);
    see(&hits, stage.v[0]);
    see(&bare, visibility_without_plants(stage.v[0], stage.arena));
    alone(range_m, hit, 0, NULL);
    for (int i = 0; i < rays.count; i++) {
        of[hits.kind[i]]++;
        CHECK(hits.range_m[i] == fmin(range_m[i], bare.range_m[i]));
        assert_int_equal(hits.kind[i] == hit_plant, range_m[i] < bare.range_m[i]);
        assert_int_equal(hits.instance[i], range_m[i] < bare.range_m[i] ? hit[i].plant + 1 : 0);
        if (hits.kind[i] != hit_plant)
            assert_true(hits.entity[i] == bare.entity[i] && hits.surface[i] == bare.surface[i]);
        else assert_true(hits.entity[i] == 0 && hits.part[i] == 0);
    }
    CHECK(of[hit_plant] > 100 && of[hit_ground] > 100 && of[hit_part] > 5);
}

static void nothing_behind_the_search_limit(void **state)
{
    (void)state;
    look(30);
    see(&hits, stage.v[0]);
    for (int i = 0; i < rays.count; i++) rays.far_m[i] = hits.range_m[i] * 0.999;
    see(&other, stage.v[0]);
    for (int i = 0; i < rays.count; i++) assert_int_equal(other.kind[i], hit_sky);
}

/* A ray that passes the box's sphere, before or behind whatever it meets, meets the trees of full detail; others, the
 * simplified ones. Both occur, and differ. */
static void near_an_entity_trees_are_real(void **state)
{
    static double      full_m[hits_capacity], simple_m[hits_capacity];
    static ForestHit   hit[hits_capacity];
    const PosedEntity *box = visibility_posed(stage.v[1], 0);
    int                near = 0, differ[2] = {0};
    (void)state;
    assert_true(box->radius_m >= hypot(3, hypot(1.5, 1)) && box->radius_m < 6);
    look(20);
    see(&hits, stage.v[1]);
    see(&bare, visibility_without_plants(stage.v[1], stage.arena));
    alone(full_m, hit, 0, NULL);
    alone(simple_m, hit, 1, NULL);
    for (int i = 0; i < rays.count; i++) {
        double to[3], off[3];
        for (int c = 0; c < 3; c++) to[c] = box->centre_enu[c] - rays.o_enu[c][i];
        v3_cross(off, to, (const double[3]){rays.d_enu[0][i], rays.d_enu[1][i], rays.d_enu[2][i]});
        const double miss_m = v3_length(off) - box->radius_m;
        if (fabs(miss_m) < 1e-3) continue; /* on its edge: a float decides */
        near += miss_m < 0;
        differ[miss_m < 0] += fmin(full_m[i], bare.range_m[i]) != fmin(simple_m[i], bare.range_m[i]);
        CHECK(hits.range_m[i] == fmin(miss_m < 0 ? full_m[i] : simple_m[i], bare.range_m[i]));
    }
    CHECK(near > 20 && differ[0] > 20 && differ[1] > 2);
}

static void full_plants_on_demand(void **state)
{
    (void)state;
    look(30);
    see(&hits, visibility_with_full_plants(stage.v[1], stage.arena));
    see(&other, stage.v[0]);
    for (int i = 0; i < rays.count; i++)
        assert_true(hits.range_m[i] == other.range_m[i] && hits.instance[i] == other.instance[i]);
    assert_ptr_equal(visibility_with_full_plants(stage.v[0], stage.arena), stage.v[0]);
}

/* ---- shadows --------------------------------------------------------------------------------- */

/* Dark is what is dark without plants, faces away, or has a plant between it and the sun: in full detail on the box,
 * simplified on the ground. */
static void shadows(void **state)
{
    static const double offset_m = 1e-3;
    static double       o[3][hits_capacity], d[3][hits_capacity], far_m[hits_capacity];
    static uint8_t      with[hits_capacity], without[hits_capacity], by_plant[hits_capacity], real[hits_capacity];
    const double *const from[3] = {o[0], o[1], o[2]}, *const way[3] = {d[0], d[1], d[2]};
    double             sun_enu[3] = {0.5, 0.2, 0.6};
    VisibilityCounters counters = {0};
    int                dark[2] = {0}, lit = 0;
    (void)state;
    v3_normalize(sun_enu, sun_enu);
    look(12);
    see(&bare, visibility_without_plants(stage.v[1], stage.arena));
    visibility_shadow(with, stage.v[1], &bare, sun_enu, &counters);
    visibility_shadow(without, visibility_without_plants(stage.v[1], stage.arena), &bare, sun_enu, &counters);
    for (int i = 0; i < rays.count; i++) {
        by_plant[i] = 0, far_m[i] = INFINITY, real[i] = bare.entity[i] != 0;
        for (int c = 0; c < 3; c++) {
            o[c][i] = bare.p_enu[c][i] + offset_m * (double)bare.n_geo[c][i];
            d[c][i] = sun_enu[c];
        }
    }
    forest_any_hits(by_plant, &stage.plants[1], rays.count, from, way, far_m, &(ForestLeft){.real = real});
    for (int i = 0; i < rays.count; i++) {
        assert_int_equal(with[i], without[i] || by_plant[i]);
        dark[bare.entity[i] != 0] += with[i] && !without[i];
        lit += !with[i];
    }
    CHECK(dark[0] > 50 && dark[1] > 0 && lit > 50);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearer_of_both),
        cmocka_unit_test(nothing_behind_the_search_limit),
        cmocka_unit_test(near_an_entity_trees_are_real),
        cmocka_unit_test(full_plants_on_demand),
        cmocka_unit_test(shadows),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
