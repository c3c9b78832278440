/* Images that a node gives and a window takes, from two threads at any pace: none is torn, their numbers rise, and each
 * is taken or comes back undone, once. labels: threads */
#include "tests/check.h"

#include "sensor/publish/projector/window_wire.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { width = 16, height = 8, images = 20000 };

typedef struct Two {
    WindowShared *shared;
    atomic_bool   ends;
    unsigned char taken[images + 1], undone[images + 1]; /* of a number: how often */
    int           torn, disordered;
} Two;

static void *window(void *user)
{
    Two     *two = user;
    uint32_t own = 0, last = 0;
    for (bool ends = false; !ends || window_is_fresh(two->shared);) {
        ends = atomic_load(&two->ends);
        if (!window_is_fresh(two->shared)) {
            sched_yield();
            continue;
        }
        own = window_take(two->shared, own);
        const uint32_t  number = two->shared->number[own];
        const uint32_t *image = window_image(two->shared, width, height, own);
        for (int round = 0; round < 2; round++) { /* while it is shown */
            for (int i = 0; i < width * height; i++) two->torn += image[i] != number;
            if (number % 7 == 0) sched_yield();
        }
        two->disordered += number <= last;
        last = number;
        if (number <= images) two->taken[number]++;
    }
    return NULL;
}

static void each_is_taken_or_comes_back(void **state)
{
    (void)state;
    Two       two = {.shared = calloc(1, window_octets(width, height))};
    pthread_t thread;
    uint32_t  own = 2;
    CHECK(two.shared);
    *two.shared = (WindowShared){.waiting = 1, .width = width, .height = height};
    CHECK(pthread_create(&thread, NULL, window, &two) == 0);
    for (uint32_t number = 1; number <= images; number++) {
        uint32_t *image = window_image(two.shared, width, height, own);
        int       undone;
        for (int i = 0; i < width * height; i++) image[i] = number;
        two.shared->number[own] = number;
        own = window_give(two.shared, own, &undone);
        if (undone) two.undone[two.shared->number[own]]++;
        if (number % 3 == 0) sched_yield();
    }
    atomic_store(&two.ends, true);
    pthread_join(thread, NULL);
    int taken = 0;
    for (int k = 1; k <= images; k++) {
        assert_int_equal(two.taken[k] + two.undone[k], 1);
        taken += two.taken[k];
    }
    CHECK(two.torn == 0 && two.disordered == 0 && taken > 0 && two.taken[images] == 1);
    free(two.shared);
}

/* Without a window all but the last come back, whatever is written into the shared word. */
static void without_a_window(void **state)
{
    (void)state;
    WindowShared shared = {.waiting = 1};
    uint32_t     own = 2;
    int          undone;
    for (uint32_t number = 1; number < 100; number++) {
        shared.number[own] = number;
        own = window_give(&shared, own, &undone);
        CHECK(own < window_images && own != 0 && undone == (number > 1));
        if (undone) assert_int_equal(shared.number[own], number - 1);
    }
    shared.waiting = 0xFFFFFFFF;
    CHECK(window_give(&shared, 0, &undone) < window_images);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_is_taken_or_comes_back),
                                       cmocka_unit_test(without_a_window)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
