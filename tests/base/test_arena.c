/* Memory of frames: aligned and zero, kept over resets, and no more of it when requests grow a little from frame to
 * frame. */
#include "tests/check.h"

static bool is_zero(const unsigned char *p, size_t octets)
{
    for (size_t i = 0; i < octets; i++)
        if (p[i]) return false;
    return true;
}

static void memory_is_aligned_and_zero(void **state)
{
    (void)state;
    static const size_t octets[] = {0, 1, 63, 64, 65, 1000, (1 << 20) - 1, 1 << 20, (1 << 20) + 1, 5 << 20};
    Arena              *arena = arena_create();
    for (int frame = 0; frame < 3; frame++) {
        unsigned char *last = NULL;
        for (size_t i = 0; i < sizeof octets / sizeof *octets; i++) {
            unsigned char *p = arena_alloc(arena, octets[i], 1);
            CHECK(p && (uintptr_t)p % 64 == 0 && p != last && is_zero(p, octets[i]));
            memset(p, 0xa5, octets[i]);
            last = p;
        }
        arena_reset(arena);
    }
    CHECK(!arena_alloc(arena, SIZE_MAX, 2) && !arena_alloc(arena, SIZE_MAX - 3, 1));
    arena_destroy(arena);
    arena_destroy(NULL);
}

/* Three thousand frames, each with a list that is a little longer than that of the frame before, between small ones. */
static void growing_requests_reuse_memory(void **state)
{
    (void)state;
    Arena *arena = arena_create();
    size_t most = 0;
    for (size_t frame = 0; frame < 3000; frame++) {
        const size_t list = ((size_t)3 << 20) / 2 + 300 * frame;
        for (int k = 0; k < 20; k++) CHECK(arena_alloc(arena, 100000, 1));
        CHECK(arena_alloc(arena, list, 1));
        for (int k = 0; k < 20; k++) CHECK(arena_alloc(arena, 100000, 1));
        CHECK(arena_alloc(arena, list / 2 + ((size_t)1 << 20), 1));
        if (arena_bytes(arena) > most) most = arena_bytes(arena);
        arena_reset(arena);
    }
    /* 4 MB of small ones, two lists of up to 2.4 MB, and as much again while they change their step */
    CHECK(most < (size_t)16 << 20);
    CHECK(arena_bytes(arena) < (size_t)12 << 20);
    arena_reset(arena);
    CHECK(arena_bytes(arena) < (size_t)6 << 20); /* large ones that the last frame did not need are gone */
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(memory_is_aligned_and_zero),
                                       cmocka_unit_test(growing_requests_reuse_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
