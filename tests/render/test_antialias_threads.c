/* Adaptive antialiasing by any number of threads, with and without skips: the same picture to the bit.
 * labels: slow threads */
#include "tests/render/strewn_world.h"

static void same_planes(const Picture *a, const Picture *b, unsigned bands)
{
    const size_t      n = (size_t)a->width * (size_t)a->height;
    static const Band band_of[picture_plane_count] = {BAND_OPTICAL, BAND_OPTICAL, BAND_OPTICAL,
                                                      BAND_MWIR,    BAND_LWIR,    BAND_RADAR};
    for (int plane = 0; plane < picture_plane_count; plane++)
        if (picture_plane(a, plane) && bands >> band_of[plane] & 1)
            assert_memory_equal(picture_plane(a, plane), picture_plane(b, plane), n * sizeof(float));
    assert_memory_equal(a->entity, b->entity, n * sizeof *a->entity);
    assert_memory_equal(a->range_m, b->range_m, n * sizeof *a->range_m);
    assert_memory_equal(a->material, b->material, n * sizeof *a->material);
    for (int i = 0; i < hand.snapshot.count; i++) {
        const TargetPixels *s = &a->target[i], *t = &b->target[i];
        CHECK(s->visible == t->visible && s->amodal == t->amodal && s->occluder == t->occluder && s->small == t->small);
        CHECK(s->occluded_ground == t->occluded_ground && s->occluded_entity == t->occluded_entity);
        CHECK(s->radiance[picture_lwir] == t->radiance[picture_lwir]);
        assert_memory_equal(s->box, t->box, sizeof s->box);
    }
}

static void threads_and_skips_change_no_bit(void **state)
{
    (void)state;
    const View    view = strew(40, 200, 140);
    RenderRequest request = request_of(&view);
    arena_reset(hand.arena);
    const Picture one = hand_render(&request, hand.pool);
    CHECK(one.counters.small_targets > 8 && one.counters.rays_edges > 5000);
    for (int threads = 1; threads <= 4; threads += threads) {
        Pool *pool = NULL;
        assert_int_equal(pool_create(&pool, threads), STATUS_OK);
        for (int no_skip = 0; no_skip < (threads == 1 ? 2 : 1); no_skip++) {
            request.skips_off = no_skip ? skips_all_off : 0;
            const Picture other = hand_render(&request, pool);
            same_planes(&one, &other, 15);
            assert_memory_equal(one.profile, other.profile, 600 * radar_bounces * sizeof *one.profile);
        }
        pool_destroy(pool);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_and_skips_change_no_bit),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
