/* Something else that rays can meet, through render/trace/visibility/trace_entry.h: a sphere, whose hits are known on
 * paper. This file is all that it takes, with its lines visibility_add: etc/ADDING.md, "Something that rays meet",
 * shows it. */
#include "tests/adding_snippet.h"
#include "tests/check.h"
#include "tests/render/hand_models.h"

#include "render/trace/visibility/trace_entry.h"
#include "render/trace/visibility/visibility.h"

/* ---- the entry -------------------------------------------------------------------------------- */

enum { hit_ball = hit_plant + 1 }; /* a kind of its own */

typedef struct Ball {
    double   centre_enu[3], radius_m;
    uint32_t number;
    uint16_t material;
} Ball;

/* From outside; INFINITY: missed, or behind. */
static double ball_range(const Ball *ball, const double o[3], const double d[3])
{
    double m[3];
    v3_sub(m, ball->centre_enu, o);
    const double along = v3_dot(m, d), left = ball->radius_m * ball->radius_m - (v3_dot(m, m) - along * along);
    const double range_m = along - sqrt(left > 0 ? left : 0);
    return left > 0 && range_m > 0 ? range_m : INFINITY;
}

static void take_ray(double o[3], double d[3], const double *const o_enu[3], const double *const d_enu[3], int i)
{
    for (int c = 0; c < 3; c++) o[c] = o_enu[c][i], d[c] = d_enu[c][i];
}

static void ball_first(double *range_m, void *found, const TraceBlock *block, const void *self)
{
    (void)found;
    for (int i = 0; i < block->rays->count; i++) {
        double o[3], d[3];
        take_ray(o, d, block->o_enu, block->d_enu, i);
        range_m[i] = ball_range(self, o, d);
        if (!(range_m[i] < block->limit_m[i])) range_m[i] = INFINITY;
    }
}

static void ball_finish(Hits *hits, const int *list, int count, const void *found, const TraceBlock *block,
                        const void *self)
{
    const Ball *ball = self;
    (void)found;
    for (int k = 0; k < count; k++) {
        const int i = list[k];
        double    o[3], d[3], n[3];
        take_ray(o, d, block->o_enu, block->d_enu, i);
        for (int c = 0; c < 3; c++) n[c] = (hits->p_enu[c][i] - ball->centre_enu[c]) / ball->radius_m;
        visibility_store_normals(hits, i, n, n, d);
        hits->kind[i] = hit_ball;
        hits->instance[i] = ball->number + 1;
        hits->material[i] = ball->material;
    }
}

static void ball_any(const TraceShadow *shadow, const void *self)
{
    for (int i = 0; i < shadow->count; i++) {
        double o[3], d[3];
        take_ray(o, d, shadow->o_enu, shadow->d_enu, i);
        shadow->dark[i] |= ball_range(self, o, d) < INFINITY;
    }
}

/* The same, asked before all others and after them. */
static const TraceEntry soon = {.turn = -1, .first_hits = ball_first, .finish = ball_finish, .any_hits = ball_any};
static const TraceEntry late = {.turn = 9, .first_hits = ball_first, .finish = ball_finish, .any_hits = ball_any};

/* ---- the stage -------------------------------------------------------------------------------- */

enum { side = 32 };

static struct {
    Landscape      landscape;
    Model          box;
    Tracer        *tracer;
    Arena         *arena;
    SnapshotEntity entity;
    NodePose       pose;
    Snapshot       snapshot;
    double         box_enu[3], eye_enu[3];
} stage;

/* A box of 6 x 3 x 2 m over the ground, seen from 60 m up. */
static int open_stage(void **state)
{
    LandscapeConfig config = landscape_default_config();
    const Geodetic  origin = {0.6, -1.9, 700};
    LocalFrame      frame;
    const double    r[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    (void)state;
    config.half_width_m = 500, config.horizon_m = 20000;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    if (landscape_create(&stage.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    hand_box(&stage.box, (const double[3]){-3, -1.5, -2}, (const double[3]){3, 1.5, 0});
    const Model *models[1] = {&stage.box};
    if (tracer_create_models(&stage.tracer, models, 1, "avx2") != STATUS_OK) return -1;
    if (!(stage.arena = arena_create())) return -1;
    stage.box_enu[2] = elevation_height(&stage.landscape.elevation, 0, 0, NULL) + 0.5;
    memcpy(stage.eye_enu, (const double[3]){10, -120, stage.box_enu[2] + 60}, sizeof stage.eye_enu);
    stage.snapshot = (Snapshot){.entity = &stage.entity, .node = &stage.pose, .count = 1};
    stage.entity = (SnapshotEntity){.model = 0};
    ecef_from_enu(stage.entity.p_ecef, &frame, stage.box_enu);
    m3_mul(stage.entity.r_ecef_from_body, frame.r_ecef_from_enu, r);
    stage.pose = (NodePose){{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    landscape_destroy(&stage.landscape);
    tracer_destroy(stage.tracer);
    arena_destroy(stage.arena);
    hand_free(&stage.box);
    return 0;
}

static Visibility *open_frame(unsigned skips_off)
{
    Visibility *v = NULL;
    assert_int_equal(visibility_create(&v, stage.tracer, &stage.landscape, &stage.landscape.frame, &stage.snapshot,
                                       skips_off, stage.arena),
                     STATUS_OK);
    return v;
}

static Rays rays;
static Hits hits, bare, other;

/* Rays from the eye over a square about the box, half_m to each side; some end before the ball's middle. */
static void look(double half_m, double far_m)
{
    rays.count = side * side, rays.columns = side;
    for (int i = 0; i < rays.count; i++) {
        const double x = half_m * (2.0 * (i % side + 0.5) / side - 1), y = half_m * (2.0 * (i / side + 0.5) / side - 1);
        double       d[3] = {x - stage.eye_enu[0], y - stage.eye_enu[1], stage.box_enu[2] - stage.eye_enu[2]};
        v3_normalize(d, d);
        for (int c = 0; c < 3; c++) rays.o_enu[c][i] = stage.eye_enu[c], rays.d_enu[c][i] = d[c];
        rays.far_m[i] = i % 7 ? INFINITY : far_m;
    }
}

static VisibilityCounters see(Hits *out, const Visibility *v)
{
    VisibilityCounters counters = {0};
    visibility_first_hit(out, v, &rays, visibility_all_but(-1), &counters);
    return counters;
}

#define SAME(a, b, row) (memcmp((a)->row, (b)->row, (size_t)(a)->count * sizeof *(a)->row) == 0)
static void check_same(const Hits *a, const Hits *b)
{
    assert_int_equal(a->count, b->count);
    CHECK(SAME(a, b, range_m) && SAME(a, b, kind) && SAME(a, b, material) && SAME(a, b, entity) && SAME(a, b, part));
    CHECK(SAME(a, b, facet) && SAME(a, b, model) && SAME(a, b, inside) && SAME(a, b, surface) && SAME(a, b, instance));
    CHECK(SAME(a, b, albedo) && SAME(a, b, radius_m) && SAME(a, b, open_up) && SAME(a, b, open_down));
    for (int c = 0; c < 3; c++) CHECK(SAME(a, b, p_enu[c]) && SAME(a, b, n_geo[c]) && SAME(a, b, n_enu[c]));
}

/* ---- tests ------------------------------------------------------------------------------------ */

/* A ball that hides a corner of the box and sinks into the ground: the nearer of both on every ray, whichever is asked
 * first, with and without skips. */
static void nearest_of_all(void **state)
{
    (void)state;
    const Ball ball = {{4, -4, stage.box_enu[2] + 1}, 3, 41, 7};
    look(10, 133);
    see(&bare, open_frame(0));
    for (int way = 0; way < 4; way++) {
        Visibility *v = open_frame(way & 2 ? (unsigned)skips_all_off : 0);
        int         balls = 0, parts_behind = 0, grounds = 0, parts = 0;
        assert_int_equal(visibility_add(v, way & 1 ? &soon : &late, &ball), STATUS_OK);
        see(way ? &other : &hits, v);
        if (way) check_same(&hits, &other);
        for (int i = 0; i < rays.count && !way; i++) {
            const double o[3] = {rays.o_enu[0][i], rays.o_enu[1][i], rays.o_enu[2][i]};
            const double d[3] = {rays.d_enu[0][i], rays.d_enu[1][i], rays.d_enu[2][i]};
            const double ball_m = ball_range(&ball, o, d);
            const bool   met = ball_m < bare.range_m[i] && ball_m < rays.far_m[i];
            CHECK(hits.range_m[i] == (met ? ball_m : bare.range_m[i]));
            CHECK(hits.kind[i] == (met ? hit_ball : bare.kind[i]));
            CHECK(hits.instance[i] == (met ? 42 : 0) && hits.entity[i] == (met ? 0 : bare.entity[i]));
            CHECK(hits.material[i] == (met ? 7 : bare.material[i]) && hits.surface[i] == (met ? 0 : bare.surface[i]));
            for (int c = 0; c < 3 && met; c++) {
                const double n = (o[c] + ball_m * d[c] - ball.centre_enu[c]) / ball.radius_m;
                CHECK(fabs((double)hits.n_geo[c][i] - n) < 1e-6);
            }
            balls += met, parts_behind += met && bare.kind[i] == hit_part;
            grounds += hits.kind[i] == hit_ground, parts += hits.kind[i] == hit_part;
        }
        if (!way) CHECK(balls > 50 && parts_behind > 5 && grounds > 100 && parts > 20);
    }
}

/* Two that are met at the same ranges: the earlier in the list, whichever is asked first. A part's range is not
 * taken from it, nor the ground's, by a ball that is a hair behind. */
static void equal_ranges_go_to_the_earlier(void **state)
{
    const Ball one = {{4, -4, stage.box_enu[2] + 1}, 3, 0, 1}, two = {{4, -4, stage.box_enu[2] + 1}, 3, 1, 2};
    const TraceEntry *const turns[3][2] = {{&late, &soon}, {&soon, &late}, {&soon, &soon}};
    (void)state;
    look(10, INFINITY);
    for (int k = 0; k < 3; k++) {
        Visibility *v = open_frame(0);
        int         balls = 0;
        assert_int_equal(visibility_add(v, turns[k][0], &one), STATUS_OK);
        assert_int_equal(visibility_add(v, turns[k][1], &two), STATUS_OK);
        see(&hits, v);
        for (int i = 0; i < rays.count; i++) {
            balls += hits.kind[i] == hit_ball;
            CHECK(hits.kind[i] != hit_ball || (hits.instance[i] == 1 && hits.material[i] == 1));
        }
        CHECK(balls > 50);
    }
}

/* What is asked before the ground and is as near as it leaves the ground's hit to the ground: an entry that answers
 * with the ranges of the frame without it. */
static void copy_first(double *range_m, void *found, const TraceBlock *block, const void *self)
{
    const Hits *of = self;
    (void)found;
    memcpy(range_m, of->range_m, (size_t)block->rays->count * sizeof *range_m);
}

static void equal_ranges_stay_with_ground_and_parts(void **state)
{
    const TraceEntry copies[2] = {{.turn = -1, .first_hits = copy_first, .finish = ball_finish},
                                  {.turn = 9, .first_hits = copy_first, .finish = ball_finish}};
    (void)state;
    look(10, 133);
    for (int way = 0; way < 4; way++) {
        Visibility *v = open_frame(way & 2 ? (unsigned)skips_all_off : 0);
        see(&bare, open_frame(0));
        assert_int_equal(visibility_add(v, &copies[way & 1], &bare), STATUS_OK);
        see(&hits, v);
        check_same(&hits, &bare);
    }
}

static void shadows(void **state)
{
    static uint8_t with[hits_capacity], without[hits_capacity];
    const Ball     ball = {{12, 6, stage.box_enu[2] + 9}, 4, 0, 1};
    double         sun_enu[3] = {0.5, 0.2, 0.6};
    (void)state;
    v3_normalize(sun_enu, sun_enu);
    look(15, INFINITY);
    for (int way = 0; way < 4; way++) {
        VisibilityCounters counters = {0};
        Visibility        *v = open_frame(way & 2 ? (unsigned)skips_all_off : 0);
        int                dark = 0, lit = 0;
        see(&bare, v);
        visibility_shadow(without, v, &bare, sun_enu, &counters);
        assert_int_equal(visibility_add(v, way & 1 ? &soon : &late, &ball), STATUS_OK);
        visibility_shadow(with, v, &bare, sun_enu, &counters);
        for (int i = 0; i < rays.count; i++) {
            double start[3];
            for (int c = 0; c < 3; c++) start[c] = bare.p_enu[c][i] + 1e-3 * (double)bare.n_geo[c][i];
            const bool met = ball_range(&ball, start, sun_enu) < INFINITY;
            CHECK(with[i] == (without[i] || (bare.kind[i] != hit_sky && met)));
            dark += with[i] && !without[i], lit += !with[i];
        }
        CHECK(dark > 30 && lit > 100);
    }
}

/* Out of sight, it changes no bit and no count. */
static void unseen_changes_nothing(void **state)
{
    static uint8_t with[hits_capacity], without[hits_capacity];
    const Ball     ball = {{0, -900, stage.box_enu[2] + 200}, 5, 0, 1};
    const double   up[3] = {0.6, 0, 0.8};
    (void)state;
    look(15, 133);
    for (int way = 0; way < 4; way++) {
        const unsigned off = way & 2 ? (unsigned)skips_all_off : 0;
        Visibility    *v = open_frame(off), *plain = open_frame(off);
        assert_int_equal(visibility_add(v, way & 1 ? &soon : &late, &ball), STATUS_OK);
        VisibilityCounters of[2] = {see(&hits, v), see(&bare, plain)};
        check_same(&hits, &bare);
        visibility_shadow(with, v, &hits, up, &of[0]);
        visibility_shadow(without, plain, &bare, up, &of[1]);
        CHECK(memcmp(with, without, (size_t)hits.count) == 0 && memcmp(&of[0], &of[1], sizeof of[0]) == 0);
    }
}

/* The list has an end, and says so. */
static void a_full_list(void **state)
{
    const Ball       ball = {{0, 0, 0}, 1, 0, 0};
    const TraceEntry large = {.found_octets = trace_found_octets};
    Visibility      *v = open_frame(0);
    int              more = 0;
    (void)state;
    assert_int_equal(visibility_add(v, &large, &ball), STATUS_NO_MEMORY);
    while (visibility_add(v, &late, &ball) == STATUS_OK) more++;
    assert_int_equal(more, trace_entries - 2); /* ground and parts are there */
}

static void adding_shows_the_ball(void **state)
{
    (void)state;
    check_adding_snippet("ray", "tests/render/test_trace_entry.c");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nearest_of_all),
        cmocka_unit_test(equal_ranges_go_to_the_earlier),
        cmocka_unit_test(equal_ranges_stay_with_ground_and_parts),
        cmocka_unit_test(shadows),
        cmocka_unit_test(unseen_changes_nothing),
        cmocka_unit_test(a_full_list),
        cmocka_unit_test(adding_shows_the_ball),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
