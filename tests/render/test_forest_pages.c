/* Rays against plants of pages: as against the same plants in a list; in any order, on any thread, with any memory; a
 * path that leaves and returns; how they end towards far_m. */
#include "tests/check.h"
#include "tests/render/hand_plants.h"

#include "terrain/ground/landscape.h"

#include <stdlib.h>
#include <string.h>

static Landscape landscape;
static Woods     all, some; /* a list of every plant of a square; a list of few of them, and pages */
static double    eye_enu[3];

static int open_all(void **state)
{
    LandscapeConfig   config = landscape_default_config();
    LocalFrame        frame;
    const WoodsConfig listed = {.seed = 5, .half_width_m = 1400, .most_trees = woods_most_trees},
                      paged = {.seed = 5, .half_width_m = 500, .most_trees = 300, .far_half_m = 1400};
    (void)state;
    config.seed = 7;
    hand_grow(false, 0.06);
    if (local_frame_at(&frame, &(Geodetic){50.1 * rad_per_deg, 8.6 * rad_per_deg, 100}) != STATUS_OK) return 1;
    if (landscape_create(&landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return 1;
    eye_enu[0] = 40, eye_enu[1] = -70;
    eye_enu[2] = elevation_height(&landscape.elevation, eye_enu[0], eye_enu[1], NULL) + 60;
    return woods_create(&all, &landscape, &listed, NULL) != STATUS_OK ||
           woods_create(&some, &landscape, &paged, NULL) != STATUS_OK;
}

static int close_all(void **state)
{
    (void)state;
    woods_destroy(&all), woods_destroy(&some);
    landscape_destroy(&landscape);
    return 0;
}

static Forest *forest_by(const char *isa, const Woods *woods, ForestConfig config)
{
    Forest *forest;
    assert_int_equal(forest_create(&forest, woods, &hand_plants, &config, isa), STATUS_OK);
    return forest;
}

static Forest *forest_of(const Woods *woods, ForestConfig config) { return forest_by("avx2", woods, config); }

static ForestFrame open_at(const Forest *forest, double east_m, double north_m, double t_s, double wind_mps)
{
    ForestFrame  frame;
    const double eye[3] = {eye_enu[0] + east_m, eye_enu[1] + north_m, eye_enu[2]}, wind[2] = {wind_mps, -wind_mps};
    assert_int_equal(forest_frame_open(&frame, forest, eye, 1000, 0, t_s, wind, NULL, NULL), STATUS_OK);
    return frame;
}

/* ---- rays ------------------------------------------------------------------------------------- */

enum { rays = 3000, block = 100 };

typedef struct Met {
    double    range_m[rays];
    ForestHit hit[rays];
    uint8_t   dark[rays], shade[rays]; /* shade: of the sun, where a plant was met */
} Met;

/* From the eye to places on the ground all about it, up to 1.3 km away, and as much past them; a tenth above the
 * horizon. */
static void ray_of(double o[3], double d[3], const ForestFrame *frame, int i)
{
    const double turn = 2 * pi_rad * i * 0.6180339887498949, away_m = 60 + 1240 * sqrt((i + 0.5) / rays);
    double       to[3] = {eye_enu[0] + away_m * cos(turn), eye_enu[1] + away_m * sin(turn), 0};
    const double z_m = elevation_height(&landscape.elevation, to[0], to[1], NULL);
    to[2] = i % 10 ? z_m + 3 : frame->eye_enu[2] + 2;
    v3_sub(d, to, frame->eye_enu);
    v3_normalize(d, d);
    for (int c = 0; c < 3; c++) o[c] = frame->eye_enu[c];
}

typedef struct Tracing {
    Met               *met;
    const ForestFrame *frame;
    bool               backwards;
} Tracing;

/* To the sun, from the plants that were met. */
static void trace_shade(Met *m, const ForestFrame *frame, int first, double *const o[3], double *const d[3])
{
    static const double sun[3] = {0.6, 0.48, 0.64};
    uint32_t            plant[block], quad[block];
    double              far_m[block];
    for (int k = 0; k < block; k++) {
        const ForestHit *hit = &m->hit[first + k];
        const double     range_m = m->range_m[first + k];
        const bool       met = range_m < (k % 7 ? INFINITY : 700);
        const double     east_m = range_m * d[0][k], north_m = range_m * d[1][k];
        plant[k] = met ? hit->plant : UINT32_MAX, quad[k] = met ? hit->quad : UINT32_MAX, far_m[k] = INFINITY;
        m->shade[first + k] = !met;
        for (int c = 0; c < 3; c++) o[c][k] += met ? range_m * d[c][k] : 0;
        if (met) o[2][k] -= frame->bend_per_m * (east_m * east_m + north_m * north_m);
    }
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < block; k++) d[c][k] = sun[c], o[c][k] += 0.02 * sun[c];
    forest_any_hits(m->shade + first, frame, block, (const double *const[3]){o[0], o[1], o[2]},
                    (const double *const[3]){d[0], d[1], d[2]}, far_m, &(ForestLeft){NULL, plant, quad});
}

static void trace_block(void *user, int worker, int task)
{
    const Tracing              *t = user;
    const int                   first = (t->backwards ? rays / block - 1 - task : task) * block;
    static _Thread_local double o[3][block], d[3][block], far_m[block];
    Met *const                  m = t->met;
    (void)worker;
    for (int k = 0; k < block; k++) {
        double from[3], along[3];
        ray_of(from, along, t->frame, first + k);
        for (int c = 0; c < 3; c++) o[c][k] = from[c], d[c][k] = along[c];
        m->range_m[first + k] = far_m[k] = k % 7 ? INFINITY : 700;
    }
    forest_first_hits(m->range_m + first, m->hit + first, t->frame, block, (const double *const[3]){o[0], o[1], o[2]},
                      (const double *const[3]){d[0], d[1], d[2]}, NULL);
    forest_any_hits(m->dark + first, t->frame, block, (const double *const[3]){o[0], o[1], o[2]},
                    (const double *const[3]){d[0], d[1], d[2]}, far_m, NULL);
    trace_shade(m, t->frame, first, (double *const[3]){o[0], o[1], o[2]}, (double *const[3]){d[0], d[1], d[2]});
}

static Met *trace(const ForestFrame *frame, bool backwards, Pool *pool)
{
    Met    *met = calloc(1, sizeof *met);
    Tracing t = {met, frame, backwards};
    assert_non_null(met);
    if (pool) pool_run(pool, rays / block, trace_block, &t);
    else
        for (int k = 0; k < rays / block; k++) trace_block(&t, 0, k);
    return met;
}

static void check_same(const Met *a, const Met *b)
{
    assert_memory_equal(a->range_m, b->range_m, sizeof a->range_m);
    assert_memory_equal(a->dark, b->dark, sizeof a->dark);
    assert_memory_equal(a->shade, b->shade, sizeof a->shade);
    for (int i = 0; i < rays; i++) {
        const ForestHit *x = &a->hit[i], *y = &b->hit[i];
        if (!(a->range_m[i] < (i % block % 7 ? INFINITY : 700))) continue;
        assert_true(x->plant == y->plant && x->place == y->place && x->quad == y->quad && x->kind == y->kind &&
                    x->level == y->level && x->organ == y->organ && x->back == y->back && x->by_table == y->by_table);
        assert_memory_equal(x->uv, y->uv, sizeof x->uv);
    }
}

static const ForestConfig every_one = {.leaves = true, .far_m = 4000, .far_mb = 1000};

static void foot_of(double p[3], const Forest *forest, uint32_t number)
{
    const WoodsPage *page;
    const int        of = woods_page_of(number);
    if (of < 0) {
        for (int c = 0; c < 3; c++) p[c] = some.origin_enu[c] + (double)some.plant[number].p_m[c];
        return;
    }
    assert_int_equal(forest_page_plants(&page, forest, of), STATUS_OK);
    const int k = (int)(number - woods_page_number(of));
    assert_true(k >= 0 && k < page->count);
    for (int c = 0; c < 3; c++) p[c] = page->origin_enu[c] + (double)page->plant[k].p_m[c];
}

/* ---- as in a list ----------------------------------------------------------------------------- */

/* Ranges are equal within the rounding of two origins' floats (a plant's place: 0.12 mm, by a grazing quad some times
 * that); in a thousandth of the rays that decides whether a quad is met. By tables it decides which texel is met, of
 * 0.1 m across, in 1 or 2 of 400 rays, and boxes of plants of pages are wider, which lets in a hit near their edge. */
static void compare(const Forest *paged, const ForestFrame *in_pages, const ForestFrame *in_list)
{
    Met       *a = trace(in_pages, false, NULL), *b = trace(in_list, false, NULL);
    const bool tables = forest_config(paged).tables;
    int        met = 0, apart = 0, of_pages = 0, shaded = 0, lit = 0, shade_apart = 0, by_table = 0;
    for (int i = 0; i < rays; i++) {
        double       p[3];
        const Plant *want = &all.plant[b->hit[i].plant];
        if (a->dark[i] != b->dark[i] || (a->range_m[i] < INFINITY) != (b->range_m[i] < INFINITY) ||
            fabs(a->range_m[i] - b->range_m[i]) > 0.005 ||
            (b->range_m[i] < INFINITY && a->hit[i].quad != b->hit[i].quad)) {
            apart++;
            continue;
        }
        if (!(b->range_m[i] < (i % block % 7 ? INFINITY : 700))) continue;
        met++, of_pages += woods_page_of(a->hit[i].plant) >= 0;
        assert_true(a->hit[i].kind == b->hit[i].kind && a->hit[i].back == b->hit[i].back &&
                    a->hit[i].level == b->hit[i].level);
        foot_of(p, paged, a->hit[i].plant);
        for (int c = 0; c < 3; c++) CHECK_NEAR(p[c], all.origin_enu[c] + (double)want->p_m[c], 5e-4);
        shaded += b->shade[i], lit += !b->shade[i], shade_apart += a->shade[i] != b->shade[i];
        by_table += a->hit[i].by_table;
    }
    assert_true(shaded > met / 20 && lit > met / 20); /* both are common */
    if (shade_apart > met / (tables ? 50 : 200)) fail_msg("shade of %d of %d is apart", shade_apart, met);
    assert_true(tables ? by_table > 0.95 * met : by_table == 0); /* a ray that rises in a leaning crown is not */
    if (!(met > rays / 50 && of_pages > met / 2)) fail_msg("%d met, %d of them of pages", met, of_pages);
    if (apart > rays / (tables ? 200 : 500)) fail_msg("%d of %d rays are apart", apart, rays);
    free(a), free(b);
}

static void as_in_a_list(void **state)
{
    (void)state;
    /* leaves; bare and swaying, in a wind across the diagonal on which the two woods' origins lie, from which its gusts
     * are counted; bent rays; two levels; by tables, all of them lower in the picture than 56 px, bent too;
     * rays from so far away that they enter pages 6 m below the lines that they began on, and steeper by 2e-3 */
    for (int k = 0; k < 7; k++) {
        ForestConfig config = every_one;
        config.leaves = k != 1, config.sway = k == 1, config.level1_px = k == 3 ? 20 : 0,
        config.tables = k == 4 || k == 5;
        config.far_m = k == 6 ? 10000 : every_one.far_m;
        const double away_m = k == 6 ? -5500 : 0;
        Forest      *paged = forest_of(&some, config), *listed = forest_of(&all, config);
        ForestFrame  in_pages = open_at(paged, away_m, 0, 12, k == 1 ? 8 : 0),
                    in_list = open_at(listed, away_m, 0, 12, k == 1 ? 8 : 0);
        in_pages.bend_per_m = in_list.bend_per_m = k == 6 ? 2e-7 : k == 2 || k == 5 ? 6e-8 : 0;
        if (config.tables) in_pages.per_rad = in_list.per_rad = 100;
        compare(paged, &in_pages, &in_list);
        forest_frame_close(&in_pages), forest_frame_close(&in_list);
        forest_destroy(paged), forest_destroy(listed);
    }
}

/* ---- the same bits ---------------------------------------------------------------------------- */

static void in_any_order(bool tables)
{
    ForestConfig config = every_one, small = every_one;
    config.tables = small.tables = tables, small.far_mb = 0;
    Pool       *pool;
    Forest     *first = forest_of(&some, config);
    ForestFrame frame = open_at(first, 0, 0, 0, 0);
    Met        *want = trace(&frame, false, NULL);
    assert_int_equal(pool_create(&pool, 4), STATUS_OK);
    for (int k = 0; k < 4; k++) {
        Forest     *forest = forest_by(k == 2 ? "sse4.2" : "avx2", &some, k % 2 ? small : config); /* one by one, too */
        ForestFrame other = open_at(forest, 0, 0, 0, 0);
        Met        *got = trace(&other, k >= 2, k == 1 || k == 2 ? pool : NULL);
        check_same(got, want);
        free(got);
        forest_frame_close(&other);
        if (small.far_mb == 0 && k % 2) assert_true(forest_pages_use(forest).octets < 1 << 16); /* no plants are left */
        forest_destroy(forest);
    }
    free(want);
    forest_frame_close(&frame);
    forest_destroy(first);
    pool_destroy(pool);
}

static void order_threads_and_memory(void **state)
{
    (void)state;
    in_any_order(false), in_any_order(true);
}

/* An eye that goes away and comes back sees the same; pages that were freed are made again; those of an open frame
 * stay, whatever other frames close. */
static void leaves_and_returns(void **state)
{
    ForestConfig small = every_one;
    (void)state;
    small.far_mb = 0, small.far_m = 900;
    Forest        *forest = forest_of(&some, small);
    ForestFrame    here = open_at(forest, 0, 0, 0, 0);
    Met           *want = trace(&here, false, NULL);
    const uint64_t made = forest_pages_use(forest).made;
    ForestFrame    there = open_at(forest, 700, 500, 0, 0);
    Met           *away = trace(&there, false, NULL);
    forest_frame_close(&there);
    const uint64_t both = forest_pages_use(forest).made;
    Met           *still = trace(&here, true, NULL); /* after another frame closed */
    check_same(still, want);
    CHECK(forest_pages_use(forest).made == both); /* its pages stayed */
    CHECK(made > 0 && forest_pages_use(forest).freed < forest_pages_use(forest).made);
    forest_frame_close(&here);
    CHECK(forest_pages_use(forest).freed == forest_pages_use(forest).made);
    there = open_at(forest, 700, 500, 0, 0);
    Met *away_again = trace(&there, true, NULL);
    check_same(away_again, away);
    forest_frame_close(&there);
    here = open_at(forest, 0, 0, 0, 0);
    Met *again = trace(&here, true, NULL);
    check_same(again, want);
    CHECK(forest_pages_use(forest).made > made);
    forest_frame_close(&here);
    forest_destroy(forest);
    free(want), free(away), free(still), free(away_again), free(again);
}

/* ---- towards far_m ---------------------------------------------------------------------------- */

/* Rays across the trunk of every plant of the pages, at a tenth of its height: of those nearer than 0.8 far_m each
 * stands; beyond far_m none; between, by (1 - r) / 0.2 of r = distance / far_m, over a ring's area int_0.8^1 5 (1 - r)
 * r dr / int_0.8^1 r dr = 0.08667 / 0.18 = 0.4815. */
static void thins_out(void **state)
{
    ForestConfig config = every_one;
    int          number[3] = {0}, stand[3] = {0};
    double       expected = 0;
    (void)state;
    config.far_m = 1200;
    Forest     *forest = forest_of(&some, config);
    ForestFrame frame = open_at(forest, 0, 0, 0, 0);
    CHECK(forest_far_share(&frame, eye_enu[0] + 950, eye_enu[1]) == 1);
    CHECK(forest_far_share(&frame, eye_enu[0] + 1201, eye_enu[1]) == 0);
    CHECK(forest_far_share(&frame, eye_enu[0] + 1e6, eye_enu[1]) == 0);
    for (int page = 0; page < some.pages_x * some.pages_y; page++) {
        const WoodsPage *of;
        assert_int_equal(forest_page_plants(&of, forest, page), STATUS_OK);
        for (int k = 0; k < of->count; k++) {
            const Plant *p = &of->plant[k];
            double       o[3], d[3] = {1, 0, 0}, axis[3][3], scale[2], range_m = INFINITY;
            ForestHit    hit;
            plant_axes(axis, scale, p, NULL);
            for (int c = 0; c < 3; c++) o[c] = of->origin_enu[c] + (double)p->p_m[c];
            const double r = hypot(o[0] - eye_enu[0], o[1] - eye_enu[1]) / config.far_m;
            for (int c = 0; c < 3; c++) o[c] += 0.1 * plant_height_m(p) * axis[2][c] - 2 * d[c];
            forest_first_hits(&range_m, &hit, &frame, 1, (const double *const[3]){&o[0], &o[1], &o[2]},
                              (const double *const[3]){&d[0], &d[1], &d[2]}, NULL);
            const int ring = r < forest_far_full ? 0 : r < 1 ? 1 : 2;
            number[ring]++;
            stand[ring] += range_m < INFINITY && hit.plant == woods_page_number(page) + (uint32_t)k;
            if (ring == 1) expected += forest_far_share(&frame, o[0], o[1]);
        }
    }
    assert_true(number[0] > 500 && number[1] > 500 && number[2] > 500);
    const double met = stand[0] / (double)number[0]; /* of the others a neighbour is met first */
    CHECK(met > 0.9);
    CHECK(stand[2] == 0);
    const double sigma = sqrt(0.25 / number[1]);
    CHECK_NEAR(stand[1] / (met * number[1]), expected / number[1], 5 * sigma);
    CHECK_NEAR(expected / number[1], 0.4815, 0.1); /* plants are not even */
    forest_frame_close(&frame);
    forest_destroy(forest);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_in_a_list),
        cmocka_unit_test(order_threads_and_memory),
        cmocka_unit_test(leaves_and_returns),
        cmocka_unit_test(thins_out),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
