/* Every task once, whatever the number of threads; the arena keeps its promises. */
#include "tests/check.h"

enum { tasks = 5000 };

static void count_task(void *user, int worker, int task)
{
    int *runs = user;
    __atomic_fetch_add(&runs[task], 1 + 0 * worker, __ATOMIC_RELAXED);
}

static void every_task_runs_once(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 4; threads++) {
        Pool *pool = NULL;
        assert_int_equal(pool_create(&pool, threads), STATUS_OK);
        assert_int_equal(pool_threads(pool), threads);
        static int runs[tasks];
        memset(runs, 0, sizeof runs);
        for (int round = 1; round <= 50; round++) {
            pool_run(pool, tasks, count_task, runs);
            for (int i = 0; i < tasks; i++) CHECK(runs[i] == round);
        }
        pool_run(pool, 0, count_task, runs);
        pool_destroy(pool);
    }
}

typedef struct Round {
    int number;
    int of_task[64]; /* the round in which it ran last */
} Round;

static void note_round(void *user, int worker, int task)
{
    Round *r = user;
    (void)worker;
    for (volatile int spin = 0; spin < 300; spin++) continue;
    r->of_task[task] = r->number;
}

/* Rounds so short that workers mostly wake up when all is done: each has its own tasks, all of them done when it ends.
 */
static void rounds_follow_each_other(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 4; threads++) {
        Pool *pool;
        Round r = {0};
        assert_int_equal(pool_create(&pool, threads), STATUS_OK);
        for (r.number = 1; r.number <= 3000; r.number++) {
            const int count = 1 + r.number % 64;
            pool_run(pool, count, note_round, &r);
            for (int k = 0; k < count; k++) assert_int_equal(r.of_task[k], r.number);
        }
        pool_destroy(pool);
    }
}

static void a_pool_needs_a_thread(void **state)
{
    (void)state;
    Pool *pool = NULL;
    assert_int_equal(pool_create(&pool, 0), STATUS_BAD_VALUE);
    assert_null(pool);
    pool_destroy(NULL);
}

static void the_arena_zeroes_aligns_and_keeps_its_blocks(void **state)
{
    (void)state;
    Arena *arena = arena_create();
    size_t settled = 0;
    for (int frame = 0; frame < 20; frame++) {
        arena_reset(arena);
        for (int i = 1; i < 200; i++) {
            unsigned char *memory = arena_alloc(arena, (size_t)i, 997);
            CHECK(memory && (uintptr_t)memory % 64 == 0);
            for (int k = 0; k < i * 997; k++) CHECK(memory[k] == 0);
            memset(memory, 0xA5, (size_t)i * 997);
        }
        if (frame == 0) settled = arena_bytes(arena);
        CHECK(arena_bytes(arena) == settled); /* the second frame allocates nothing */
    }
    CHECK(arena_alloc(arena, SIZE_MAX, 2) == NULL);
    CHECK(arena_alloc(arena, SIZE_MAX, 1) == NULL);
    arena_destroy(arena);
    arena_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_task_runs_once),
        cmocka_unit_test(rounds_follow_each_other),
        cmocka_unit_test(a_pool_needs_a_thread),
        cmocka_unit_test(the_arena_zeroes_aligns_and_keeps_its_blocks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
