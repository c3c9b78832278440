/* The ground's sample points (render/light/sky_visibility.h): which square of the lattice a hit takes, at which step,
 * and what it gets of its corners, each of which is asked for here by itself. labels: physics */
#include "tests/render/change_stage.h"

enum { hits_count = 400, finest = -4, coarsest = 4 };

static const unsigned bands = 1u << AIR_R | 1u << AIR_LWIR;

static Landscape      land;
static SkyVisibility *sky;
static SkyWorker     *worker;
static View    view = {.width = 640, .height = 480, .focal_px = 800, .r_enu_from_cam = {1, 0, 0, 0, 0, 1, 0, -1, 0}};
static double  box_px[most_bodies][4];
static Hits    hits;
static SkyOpen open;

/* A building on the ground, bodies of several heights about it and in it, one that is far from all. */
static void pose_yard(void)
{
    static const double place_m[][3] = {{0, 0, 8},     {16, 3, 0.6}, {-20, -4, 2}, {14, -12, 1},
                                        {-3, 17, 0.5}, {22, 9, 3},   {90, 0, 1},   {-14, 14, 0.9},
                                        {4, 3, 0.4},   {-5, 2, 1},   {-1, -5, 0.6}};
    static const int    model[] = {model_room,   model_brick, model_sphere, model_brick,  model_sphere, model_brick,
                                   model_sphere, model_crate, model_brick,  model_sphere, model_crate};
    clear_bodies();
    for (int k = 0; k < 11; k++) {
        const double turn = 0.7 * k, r[9] = {cos(turn), -sin(turn), 0, sin(turn), cos(turn), 0, 0, 0, 1};
        add_body(model[k], place_m[k], r);
        for (int c = 0; c < 4; c++) box_px[k][c] = NAN; /* none of them is on the image */
    }
    pose_bodies();
    set_rho(0.3, 0.2);
    set_air((const double[3]){0.48, 0.6, 0.64}, 300, 20, 15);
}

static void open_sky_of(unsigned skips_off, SkyKept *kept)
{
    const SkyVisibilityScene scene = {.gather = stage_scene(),
                                      .landscape = &land,
                                      .view = &view,
                                      .box_px = (const double(*)[4])box_px,
                                      .air_bands = bands,
                                      .skips_off = skips_off,
                                      .hidden_entity = -1,
                                      .kept = kept};
    assert_int_equal(sky_visibility_create(&sky, &scene, stage.arena), STATUS_OK);
    assert_int_equal(sky_worker_create(&worker, sky, stage.arena), STATUS_OK);
    CHECK(sky_visibility_tasks(sky) == 0);
}

static void open_sky(unsigned skips_off) { open_sky_of(skips_off, NULL); }

static int open_all(void **state)
{
    const ElevationGrid grid = {
        .nx = 2, .ny = 2, .x0_m = -2000, .y0_m = -2000, .spacing_m = 4000, .z0_m = 0, .step_m = 1};
    if (elevation_level_create(&land.elevation, 0, &grid) != STATUS_OK) return -1;
    land.elevation.level_count = 1;
    elevation_build_pyramids(&land.elevation);
    return open_stage(state);
}

static int close_all(void **state)
{
    elevation_destroy(&land.elevation);
    return close_stage(state);
}

/* ---- on paper --------------------------------------------------------------------------------- */

/* A wall of width w and height h hides w h^2 / (4 pi d^3) of a level plane's sky: 2 % of it at this distance, 40 m at
 * most. */
static double reach_on_paper(int k)
{
    static const double size[model_count][3] = {{2, 2, 2}, {20, 20, 20}, {5, 2.5, 1.5}, {3, 4, 2}};
    const double       *s = size[stage.entity[k].model];
    return fmin(cbrt(hypot(s[0], s[1]) * s[2] * s[2] / (4 * pi_rad * 0.02)), 40);
}

static double box_distance_on_paper(int k, const double p_enu[3])
{
    static const double half[model_count][3] = {{1, 1, 1}, {10, 10, 10}, {2.5, 1.25, 0.75}, {1.5, 2, 1}},
                        middle[model_count][3] = {{0}, {0}, {0.5, 0.25, 0.25}, {0}};
    const int model = stage.entity[k].model;
    double    from[3], square = 0;
    v3_sub(from, p_enu, visibility_posed(stage.visibility, k)->p_enu);
    for (int c = 0; c < 3; c++) { /* body axes are the columns of the rotation */
        const double *r = visibility_posed(stage.visibility, k)->r_enu_from_body;
        const double  at = r[c] * from[0] + r[3 + c] * from[1] + r[6 + c] * from[2],
                     out = fmax(fabs(at - middle[model][c]) - half[model][c], 0);
        square += out * out;
    }
    return sqrt(square);
}

/* A point of the lattice of 1/16 m: its light over that of open level ground. */
typedef struct Corner {
    double factor[AIR_BAND_COUNT], blocked, sunlit;
    bool   inside;
} Corner;

static Corner corner_at(int64_t i, int64_t j)
{
    static Hits        point;
    HemisphereChange   change;
    int                list[most_bodies];
    double             reach_m[most_bodies];
    VisibilityCounters counters = {0};
    const uint64_t     key = (uint64_t)1 << 62 | ((uint64_t)i & 0x7fffffff) << 31 | ((uint64_t)j & 0x7fffffff);
    point.count = 0;
    put_point(&point, (const double[3]){(double)i / 16, (double)j / 16, 0}, (const double[3]){0, 0, 1}, 0);
    for (int k = 0; k < stage.snapshot.count; k++) list[k] = k, reach_m[k] = reach_on_paper(k);
    const HemisphereNear  near = {.bands = bands,
                                  .samples = 32,
                                  .reach_m = 50,
                                  .listed = stage.snapshot.count,
                                  .list = list,
                                  .list_reach_m = reach_m};
    const HemisphereScene scene = stage_scene();
    hemisphere_change(&change, &scene, &point, &near, &key, NULL, &counters);
    Corner out = {.blocked = (double)change.blocked, .sunlit = (double)change.sunlit, .inside = change.inside > 0.5f};
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        out.factor[b] = fmin(fmax(1 + (double)change.w_m2[b] / (20 * pi_rad), 0), 100);
    return out;
}

static double spread(double a, double b, double c, double d)
{
    return fmax(fmax(a, b), fmax(c, d)) - fmin(fmin(a, b), fmin(c, d));
}

typedef struct OnPaper {
    double factor[AIR_BAND_COUNT], weight;
    int    step, first, last;
    bool   inside; /* some corners are within a body */
} OnPaper;

/* Cells of 2^step m: first of the largest that is no more than 0.45 of the least reach about; halved once beside a body
 * (nearer than a cell), and while corners differ by more than 0.15 of their directions, or some lie within a body;
 * three times at most, and not below 3.5 px of the picture, rounded to a power of two. Corners within a body count for
 * nothing, unless all are. */
static OnPaper ground_on_paper(const double p_enu[3], double range_m)
{
    OnPaper out = {.step = coarsest};
    double  body_m = INFINITY;
    for (int k = 0; k < stage.snapshot.count; k++) {
        const double reach = reach_on_paper(k), away = box_distance_on_paper(k, p_enu),
                     weight = fmin((1 - away / reach) / 0.3, 1);
        const PosedEntity *e = visibility_posed(stage.visibility, k); /* within reach of its sphere, too */
        double             off[3];
        v3_sub(off, p_enu, e->centre_enu);
        if (!(weight > 0 && v3_length(off) < reach + e->radius_m)) continue;
        out.weight = fmax(out.weight, weight);
        out.step = (int)fmin(out.step, floor(log2(0.45 * reach)));
        body_m = fmin(body_m, away);
    }
    out.first = out.step;
    out.last = (int)fmin(fmax(fmax(rint(log2(3.5 * range_m / 800)), out.step - 3), finest), coarsest);
    bool force = body_m < ldexp(1, out.step);
    if (out.last > out.step) out.step = out.last;
    for (;; out.step--) {
        const double cell = ldexp(1, out.step), x = p_enu[0] / cell, y = p_enu[1] / cell, u = x - floor(x),
                     v = y - floor(y);
        const double share[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
        Corner       c[4];
        int          inside = 0;
        double       kept = 0;
        for (int k = 0; k < 4; k++) {
            c[k] = corner_at((int64_t)((floor(x) + k % 2) * 16 * cell), (int64_t)((floor(y) + k / 2) * 16 * cell));
            inside += c[k].inside;
            if (!c[k].inside) kept += share[k];
        }
        const bool differ = spread(c[0].blocked, c[1].blocked, c[2].blocked, c[3].blocked) > 0.15 ||
                            spread(c[0].sunlit, c[1].sunlit, c[2].sunlit, c[3].sunlit) > 0.15 ||
                            (inside > 0 && inside < 4);
        if (out.step > out.last && (differ || force)) {
            force = false;
            continue;
        }
        out.inside = inside > 0;
        const bool some = inside > 0 && kept > 1e-3;
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            double mean = 0;
            for (int k = 0; k < 4; k++)
                if (!some || !c[k].inside) mean += share[k] / (some ? kept : 1) * c[k].factor[b];
            out.factor[b] = 1 + out.weight * (mean - 1);
        }
        return out;
    }
}

/* ---- hits ------------------------------------------------------------------------------------- */

static void put_hits(void)
{
    hits.count = 0;
    hand_draw = 77;
    for (int i = 0; i < hits_count; i++) {
        /* some about the building, some within, some about the sphere in there, beside which a point sees as much of
         * its outside as of the building's inside */
        const bool   beside = i % 4 == 1;
        const double half_m = beside ? 1.6 : i % 4 ? 45 : 8, x_m = beside ? -5 : 0, y_m = beside ? 2 : 0;
        put_point(&hits, (const double[3]){x_m + hand_uniform(-half_m, half_m), y_m + hand_uniform(-half_m, half_m), 0},
                  (const double[3]){0, 0, 1}, 0);
        hits.range_m[i] = exp(hand_uniform(log(10), log(beside ? 60 : 600)));
    }
}

static void hits_take_their_corners(void **state)
{
    (void)state;
    int                treated = 0, steps[9] = {0}, within = 0, faded = 0;
    VisibilityCounters counters = {0};
    pose_yard();
    open_sky(0);
    put_hits();
    for (int i = 0; i < 4; i++) hits.kind[i] = hit_plant; /* neither ground nor body */
    hits.range_m[4] = INFINITY;
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        for (int i = 0; i < hits_count; i++) open.factor[b][i] = -1;
    CHECK(sky_visibility_open(&open, sky, worker, &hits, &counters));
    for (int i = 0; i < hits_count; i++) {
        const double  p_enu[3] = {hits.p_enu[0][i], hits.p_enu[1][i], 0};
        const OnPaper want = ground_on_paper(p_enu, i == 4 ? 10 : hits.range_m[i]);
        CHECK(open.factor[AIR_G][i] == -1 && open.factor[AIR_MWIR][i] == -1);
        if (i < 5 || !(want.weight > 0)) {
            CHECK(open.factor[AIR_R][i] == 1 && open.factor[AIR_LWIR][i] == 1);
            continue;
        }
        for (int b = AIR_R; b <= AIR_LWIR; b += AIR_LWIR - AIR_R)
            if (!(fabs((double)open.factor[b][i] - want.factor[b]) <= 2e-5))
                fail_msg("hit %d at %.2f %.2f m, step %d of %d to %d: %.5f, want %.5f", i, p_enu[0], p_enu[1],
                         want.step, want.first, want.last, (double)open.factor[b][i], want.factor[b]);
        treated++, steps[want.step - finest]++, within += want.inside, faded += want.weight < 1;
    }
    CHECK(counters.skipped[SKIP_LIGHT] == (uint64_t)treated);
    print_message("%d treated, %d beside points within bodies, %d at the reach's end; steps", treated, within, faded);
    for (int k = 0; k < 9; k++) print_message(" %d", steps[k]);
    print_message("\n");
    CHECK(treated > 100 && within > 5 && faded > 5);
}

/* The same with no point shared between hits or blocks, and of any order of hits. */
static void company_changes_nothing(void **state)
{
    (void)state;
    static SkyOpen     alone, apart;
    VisibilityCounters counters = {0};
    pose_yard();
    open_sky(0);
    put_hits();
    CHECK(sky_visibility_open(&open, sky, worker, &hits, &counters));
    CHECK(sky_visibility_open(&alone, sky, worker, &hits, &counters)); /* all of whose points are cached */
    for (int i = 0; i < hits_count; i++) CHECK(alone.factor[AIR_R][i] == open.factor[AIR_R][i]);
    open_sky(skips_all_off);
    CHECK(sky_visibility_open(&apart, sky, worker, &hits, &(VisibilityCounters){0}));
    for (int i = 0; i < hits_count; i++) CHECK(apart.factor[AIR_LWIR][i] == open.factor[AIR_LWIR][i]);
    static Hits one;
    open_sky(0);
    for (int i = hits_count - 1; i >= 0; i -= 7) {
        one.count = 0;
        put_point(&one, (const double[3]){hits.p_enu[0][i], hits.p_enu[1][i], 0}, (const double[3]){0, 0, 1}, 0);
        one.range_m[0] = hits.range_m[i];
        alone.factor[AIR_R][0] = 1;
        sky_visibility_open(&alone, sky, worker, &one, &counters);
        CHECK(alone.factor[AIR_R][0] == open.factor[AIR_R][i]);
    }
    /* nothing is near */
    for (int side = 0; side < 6; side++) {
        const double far_m = side % 2 ? 300 : -300;
        one.count = 0;
        put_point(&one,
                  (const double[3]){side / 2 == 0 ? far_m : 0, side / 2 == 1 ? far_m : 0, side / 2 == 2 ? far_m : 0},
                  (const double[3]){0, 0, 1}, 0);
        CHECK(!sky_visibility_open(&alone, sky, worker, &one, &counters));
    }
    one.count = 0;
    CHECK(!sky_visibility_open(&alone, sky, worker, &one, &counters));
}

/* What is kept of a frame is found by the third (the first does not know what stands), unless that is not to be left
 * out; the light is the same. */
static void frames_keep_what_points_met(void **state)
{
    (void)state;
    static SkyOpen first;
    SkyKept       *kept = NULL;
    assert_int_equal(sky_kept_create(&kept, sky_kept_octets), STATUS_OK);
    hits.count = 0;
    hand_draw = 5;
    for (int i = 0; i < 150; i++) {
        put_point(&hits, (const double[3]){hand_uniform(-26, 30), hand_uniform(-26, 26), 0}, (const double[3]){0, 0, 1},
                  0);
        hits.range_m[i] = 30;
    }
    for (int frame = 0; frame < 5; frame++) {
        VisibilityCounters counters = {0};
        pose_yard();
        open_sky_of(frame == 3 ? 1u << SKIP_KEPT : 0, frame == 4 ? NULL : kept);
        CHECK(sky_visibility_open(frame ? &open : &first, sky, worker, &hits, &counters));
        sky_visibility_close(sky, &counters);
        if (frame == 2) print_message("%d kept\n", (int)counters.skipped[SKIP_KEPT]);
        CHECK(frame == 2 ? counters.skipped[SKIP_KEPT] > 150 : counters.skipped[SKIP_KEPT] == 0);
        for (int i = 0; i < hits.count && frame; i++)
            CHECK(open.factor[AIR_R][i] == first.factor[AIR_R][i] &&
                  open.factor[AIR_LWIR][i] == first.factor[AIR_LWIR][i]);
    }
    for (int i = 0; i < hits.count; i += 10) {
        const OnPaper want = ground_on_paper((const double[3]){hits.p_enu[0][i], hits.p_enu[1][i], 0}, 30);
        if (want.weight > 0) CHECK_NEAR(first.factor[AIR_R][i], want.factor[AIR_R], 2e-5);
    }
    sky_visibility_close(NULL, NULL);
    sky_kept_destroy(kept);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_take_their_corners),
        cmocka_unit_test(company_changes_nothing),
        cmocka_unit_test(frames_keep_what_points_met),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
