/* A large target at every step of sampling (RenderRequest.sampling): where a shadow's edge falls on it, and about its
 * outline, each of its pixels and its sums are those of the first step to the bit; any number of threads and no skips
 * give the same bits. */
#include "tests/render/hand_world.h"

static const double eye_enu[3] = {0, 0, 3000}, sun_enu[3] = {-0.6, 0, 0.8};
static const double focal_px = 2000, range_m = 20; /* a plate of 200 px: too large to be refined all over */
enum { side_px = 256, pixels = side_px * side_px, steps = SAMPLING_QUARTER + 1 };

static int open_world(void **state)
{
    (void)state;
    return hand_open(false);
}

/* A plate before the eye, and a sphere that the eye does not see, between it and the sun. */
static void stand(void)
{
    double       r[9];
    const double plate_enu[3] = {eye_enu[0] + range_m, eye_enu[1], eye_enu[2] - hand_plate_z_m};
    double       sphere_enu[3];
    hand_air_off(sun_enu);
    hand_clear();
    hand_attitude(r, pi_rad, 0);
    hand_add(hand_plate_model, plate_enu, r);
    v3_add_scaled(sphere_enu, (const double[3]){range_m, 0.7, eye_enu[2] + 0.4}, 5, sun_enu);
    hand_add(hand_sphere_model, sphere_enu, r);
}

static Picture shoot(Sampling step, int edge_samples, unsigned skips_off, Pool *pool)
{
    const View    view = hand_view(eye_enu, (const double[3]){1, 0, 0}, side_px, side_px, focal_px);
    RenderRequest request = hand_request(&view);
    request.sampling = step, request.edge_samples = edge_samples, request.skips_off = skips_off;
    return hand_render(&request, pool);
}

/* Pixels of the plate that are not the same in a radiance plane, and how many it has. */
static int apart(const Picture *p, const Picture *q, int *of)
{
    int differ = 0;
    *of = 0;
    for (int k = 0; k < pixels; k++) {
        bool same = p->entity[k] == q->entity[k] && p->part[k] == q->part[k] && p->range_m[k] == q->range_m[k];
        if (p->entity[k] == 0) continue;
        ++*of;
        for (int plane = 0; plane < picture_radar; plane++)
            if (picture_plane(p, plane)) same = same && picture_plane(p, plane)[k] == picture_plane(q, plane)[k];
        differ += !same;
    }
    return differ;
}

static void a_large_target_is_whole_at_every_step(void **state)
{
    (void)state;
    int of;
    arena_reset(hand.arena);
    stand();
    const Picture full = shoot(SAMPLING_ALL, 4, 0, hand.pool), bare = shoot(SAMPLING_ALL, 0, 0, hand.pool);
    const int     edges = apart(&full, &bare, &of);
    print_message("plate of %d px: %d of them at its outline and the shadow's\n", of, edges);
    /* the twin: without more rays the shadow's edge, about 200 px long, differs; the outline has four sides of 200 */
    CHECK(of > 30000 && edges > 150);
    for (int step = SAMPLING_TARGETS; step < steps; step++) {
        const Picture p = shoot((Sampling)step, 4, 0, hand.pool);
        const int     differ = apart(&full, &p, &of);
        print_message("step %d: %d pixels of the plate differ\n", step, differ);
        CHECK(differ == 0);
        CHECK(p.target[0].visible == full.target[0].visible && p.target[0].amodal == full.target[0].amodal);
        assert_memory_equal(p.target[0].radiance, full.target[0].radiance, sizeof full.target[0].radiance);
    }
}

static void no_thread_and_no_skip_changes_a_step(void **state)
{
    (void)state;
    Pool *one;
    assert_int_equal(pool_create(&one, 1), STATUS_OK);
    for (int step = SAMPLING_TARGETS; step < steps; step++) {
        arena_reset(hand.arena);
        stand();
        const Picture p = shoot((Sampling)step, 4, 0, hand.pool);
        for (int k = 0; k < 2; k++) {
            const Picture q = k ? shoot((Sampling)step, 4, 0, one) : shoot((Sampling)step, 4, skips_all_off, hand.pool);
            for (int plane = 0; plane < picture_radar; plane++)
                if (picture_plane(&p, plane))
                    assert_memory_equal(picture_plane(&p, plane), picture_plane(&q, plane), pixels * sizeof(float));
            assert_memory_equal(p.entity, q.entity, pixels * sizeof *p.entity);
            assert_memory_equal(p.range_m, q.range_m, pixels * sizeof *p.range_m);
            assert_memory_equal(p.target[0].radiance, q.target[0].radiance, sizeof p.target[0].radiance);
        }
    }
    pool_destroy(one);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_large_target_is_whole_at_every_step),
        cmocka_unit_test(no_thread_and_no_skip_changes_a_step),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
