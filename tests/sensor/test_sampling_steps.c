/* Steps of sampling (RenderRequest.sampling) of frames with a horizon and smoke, in small and odd sizes, through a lens
 * that distorts, with several samples a pixel: which pixels have rays, and what the others show. What a frame says of
 * its own error at each step: test_sampling_stated.c. */
#include "tests/sensor/error_scenes.h"

static const ErrorScene scenes[] = {
    {"a vehicle and its smoke at 60 m, the horizon", 60, 12, 40, 6, true, 8, false},
    {"vehicles at 600 m", 600, 60, 12, 10, false, 0, false},
};
enum { steps = SAMPLING_QUARTER + 1, sizes = 6 };

typedef struct Shape {
    int  width, height, samples;
    bool lens;
} Shape;

static const Shape shape[sizes] = {{63, 47, 1, false}, {63, 47, 1, true}, {40, 31, 2, false},
                                   {1, 33, 1, false},  {33, 1, 1, false}, {2, 2, 1, false}};

static RenderRequest request_in(const TrialScene *scene, const ErrorScene *of, const Shape *s)
{
    static const double k[3] = {-0.2, 0.05, 0}, p[2] = {0.001, -0.001};
    RenderRequest       request = request_of(scene, of);
    View               *view = &request.view;
    view->focal_px *= (double)s->width / view->width;
    view->width = s->width, view->height = s->height;
    if (s->width < 40) view->focal_px = 60;
    request.samples = s->samples;
    request.budget = false;
    if (s->lens) {
        const double half[2] = {0.5 * s->width / view->focal_px, 0.5 * s->height / view->focal_px};
        assert_int_equal(view_lens_make(&view->lens, k, p, half), STATUS_OK);
    }
    return request;
}

/* The same frame again, with or without its smoke. */
static Picture shoot(const TrialFrame *frame, Sampling step, bool smoke, Pool *pool)
{
    RenderRequest request = frame->request;
    Snapshot      snapshot = frame->snapshot;
    Picture       picture;
    request.sampling = step;
    if (!smoke) snapshot.puff_count = 0;
    assert_int_equal(render(&picture, &frame->scene->world, &snapshot, &request, &frame->air, pool, lab.arena[1]),
                     STATUS_OK);
    return picture;
}

static bool equal_at(const Picture *a, const Picture *b, size_t px)
{
    bool equal = true;
    for (int k = 0; k < picture_radar; k++) equal = equal && picture_plane(a, k)[px] == picture_plane(b, k)[px];
    return equal;
}

static bool is_sky(const Picture *p, size_t px) { return !(p->range_m[px] < INFINITY); }

/* Pixels with rays whatever they show, by the pattern of the step. */
static bool by_pattern(Sampling step, int x, int y)
{
    return step == SAMPLING_CHECKERBOARD ? (x + y) % 2 == 0 : x % 2 == 0 && y % 2 == 0;
}

static int donors_of(size_t donor[4], const Picture *p, Sampling step, int x, int y)
{
    static const int beside[2][4][2] = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}, {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
    const bool       corners = step == SAMPLING_QUARTER && x % 2 && y % 2;
    int              count = 0;
    for (int k = 0; k < 4; k++) {
        const int xd = x + beside[corners][k][0], yd = y + beside[corners][k][1];
        if (xd >= 0 && yd >= 0 && xd < p->width && yd < p->height && by_pattern(step, xd, yd))
            donor[count++] = picture_index(p, xd, yd);
    }
    return count;
}

/* Whether a pixel's planes are no more and no less than those of the pixels about it that have rays: all that are as in
 * `full`, which are more than it was filled from. */
static bool between(const Picture *p, const Picture *full, int x, int y)
{
    const size_t px = picture_index(p, x, y);
    bool         within = true;
    for (int k = 0; k < picture_radar; k++) {
        const float *plane = picture_plane(p, k);
        float        low = INFINITY, high = -INFINITY;
        for (int yd = y - 1; yd <= y + 1; yd++)
            for (int xd = x - 1; xd <= x + 1; xd++) {
                if (xd < 0 || yd < 0 || xd >= p->width || yd >= p->height) continue;
                const size_t at = picture_index(p, xd, yd);
                if (at != px && equal_at(p, full, at)) low = fminf(low, plane[at]), high = fmaxf(high, plane[at]);
            }
        within = within && plane[px] >= low * 0.999999F && plane[px] <= high * 1.000001F;
    }
    return within;
}

typedef struct Tally4 {
    int traced, entity, smoke, horizon, filled;
} Tally4;

/* Compares a step with the one that has all rays but refines targets alone. clear: that one without smoke. */
static void judge_step(Tally4 *t, const Picture *full, const Picture *clear, const Picture *p, Sampling step)
{
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            const size_t px = picture_index(p, x, y);
            size_t       donor[4];
            const int    donors = donors_of(donor, p, step, x, y);
            bool         horizon = false;
            for (int n = 1; n < donors; n++) horizon |= is_sky(full, donor[n]) != is_sky(full, donor[0]);
            /* smoke before it, not its shadow on the ground, which is filled as other shadows are: in LWIR there is no
             * sun */
            const bool pattern = by_pattern(step, x, y), smoke = full->lwir[px] != clear->lwir[px];
            const bool entity = full->entity[px] || (full->covered && full->covered[px] > 0);
            for (int k = 0; k < picture_radar; k++) CHECK(isfinite(picture_plane(p, k)[px]));
            if (pattern || entity || smoke || horizon) {
                CHECK(equal_at(full, p, px) && p->range_m[px] == full->range_m[px] &&
                      p->entity[px] == full->entity[px]);
                t->traced += pattern;
                t->entity += entity && !pattern;
                t->smoke += smoke && !pattern && !entity;
                t->horizon += horizon && !pattern && !entity && !smoke;
            } else if (!equal_at(full, p, px)) { /* nor is it whole for what is about it */
                CHECK(donors > 0 && between(p, full, x, y));
                CHECK(is_sky(p, px) == is_sky(p, donor[0]));
                t->filled++;
            }
        }
}

static void each_pixel_has_rays_or_lies_between_those_that_have(void **state)
{
    (void)state;
    TrialScene scene;
    Pool      *one;
    Tally4     all = {0};
    open_scene(&scene, &lab.ground, &scenes[0]);
    assert_int_equal(pool_create(&one, 1), STATUS_OK);
    for (int s = 0; s < sizes; s++) {
        const RenderRequest request = request_in(&scene, &scenes[0], &shape[s]);
        const TrialFrame    frame = frame_of(&scene, &request, 0);
        arena_reset(lab.arena[1]);
        const Picture full = shoot(&frame, SAMPLING_TARGETS, true, lab.pool),
                      clear = shoot(&frame, SAMPLING_TARGETS, false, lab.pool);
        for (int k = SAMPLING_CHECKERBOARD; k < steps; k++) {
            const Sampling step = (Sampling)k;
            const Picture  p = shoot(&frame, step, true, lab.pool);
            const size_t   pixels = (size_t)p.width * (size_t)p.height;
            Tally4         t = {0};
            judge_step(&t, &full, &clear, &p, step);
            if (s == 1) {
                const Picture single = shoot(&frame, step, true, one);
                for (int plane = 0; plane < picture_radar; plane++)
                    assert_memory_equal(picture_plane(&p, plane), picture_plane(&single, plane),
                                        pixels * sizeof(float));
                assert_memory_equal(p.range_m, single.range_m, pixels * sizeof(float));
            }
            print_message("%d x %d%s, %d samples, step %d: %d by pattern, %d more of targets, %d of smoke, %d at the "
                          "horizon, %d filled\n",
                          p.width, p.height, shape[s].lens ? ", lens" : "", shape[s].samples, k, t.traced, t.entity,
                          t.smoke, t.horizon, t.filled);
            /* twins: there is something to be wrong */
            if (s < 3) CHECK(t.entity > 10 && t.smoke > 10 && t.horizon > 10 && t.filled > (int)pixels / 10);
            all.filled += t.filled;
        }
    }
    CHECK(all.filled > 0);
    pool_destroy(one);
    trial_scene_close(&scene);
}

/* Rows of ground, seen at a flat angle, are filled along the rows: nearer to rays of their own than the mean of four
 * is. */
static void a_checkerboard_is_filled_along_the_rows(void **state)
{
    (void)state;
    TrialScene scene;
    double     is = 0, plain = 0;
    open_scene(&scene, &lab.ground, &scenes[1]);
    RenderRequest request = request_of(&scene, &scenes[1]);
    request.budget = false;
    const TrialFrame frame = frame_of(&scene, &request, 0);
    arena_reset(lab.arena[1]);
    const Picture full = shoot(&frame, SAMPLING_TARGETS, true, lab.pool),
                  p = shoot(&frame, SAMPLING_CHECKERBOARD, true, lab.pool);
    for (int y = 2; y < p.height - 2; y++)
        for (int x = 2 + (y + 1) % 2; x < p.width - 2; x += 2) {
            size_t       donor[4];
            const size_t px = picture_index(&p, x, y);
            double       sum = 0;
            if (equal_at(&full, &p, px)) continue;
            CHECK(donors_of(donor, &p, SAMPLING_CHECKERBOARD, x, y) == 4);
            for (int n = 0; n < 4; n++) sum += (double)full.lwir[donor[n]] / 4;
            plain += (sum - (double)full.lwir[px]) * (sum - (double)full.lwir[px]);
            is += (double)(p.lwir[px] - full.lwir[px]) * (double)(p.lwir[px] - full.lwir[px]);
        }
    print_message("along the rows %.2f of the plain mean's error\n", sqrt(is / plain));
    CHECK(is > 0 && sqrt(is / plain) < 0.8);
    trial_scene_close(&scene);
}

/* A picture without truth, and one without any edges looked for, fill the same. */
static void truth_changes_no_step(void **state)
{
    (void)state;
    TrialScene scene;
    open_scene(&scene, &lab.ground, &scenes[0]);
    for (int edges = 0; edges <= 4; edges += 4) {
        RenderRequest request = request_in(&scene, &scenes[0], &shape[0]);
        request.sampling = SAMPLING_QUARTER, request.edge_samples = edges, request.target_samples = 0;
        const TrialFrame with = frame_of(&scene, &request, 0);
        request.truth = false;
        const TrialFrame without = frame_of(&scene, &request, 2);
        CHECK(with.picture.range_m && !without.picture.range_m && !without.picture.target);
        for (int k = 0; k < picture_radar; k++)
            assert_memory_equal(picture_plane(&with.picture, k), picture_plane(&without.picture, k),
                                (size_t)request.view.width * (size_t)request.view.height * sizeof(float));
    }
    trial_scene_close(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_pixel_has_rays_or_lies_between_those_that_have),
        cmocka_unit_test(a_checkerboard_is_filled_along_the_rows),
        cmocka_unit_test(truth_changes_no_step),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
