/* The search for the smallest set of differences, on predicates whose smallest sets are known; how many tests it takes
 * against the bound that delta.h states. */
#include "tests/check.h"

#include "sensor/verify/bisect/delta.h"

enum { most = 4096 };

/* It happens when all items of one of the sets are in. */
typedef struct Known {
    int  count, sets, size[4], item[4][4];
    int  tests, stop_after; /* 0: never */
    bool only_near;         /* a test with holes among the first 8 cannot be run */
} Known;

static DeltaAnswer ask(void *user, const bool *in)
{
    Known *k = user;
    k->tests++;
    if (k->stop_after && k->tests > k->stop_after) return DELTA_STOP;
    if (k->only_near) {
        int some = 0;
        for (int i = 0; i < 8; i++) some += in[i];
        if (some != 0 && some != 8) return DELTA_UNKNOWN;
    }
    for (int s = 0; s < k->sets; s++) {
        bool all = true;
        for (int i = 0; i < k->size[s]; i++) all = all && in[k->item[s][i]];
        if (all) return DELTA_MOVES;
    }
    return DELTA_STILL;
}

static int log2_up(int n)
{
    int bits = 0;
    while (1 << bits < n) bits++;
    return bits;
}

static bool is_set(const DeltaSet *set, const Known *k, int s)
{
    bool all = set->size == k->size[s];
    for (int i = 0; i < k->size[s]; i++) all = all && set->in[k->item[s][i]];
    return all;
}

static void one_among_many_is_found_by_halving(void **state)
{
    (void)state;
    static bool within[most];
    memset(within, true, sizeof within);
    for (int n = 1; n <= most; n = n * 3 + 1) {
        for (int at = 0; at < n; at += 1 + n / 7) {
            Known    k = {.count = n, .sets = 1, .size = {1}, .item = {{at}}};
            DeltaSet set;
            CHECK(delta_smallest(&set, &(DeltaSearch){n, ask, &k, 6}, within) == STATUS_OK);
            CHECK(is_set(&set, &k, 0) && set.smallest);
            CHECK(k.tests <= log2_up(n) + 1);
            delta_free(&set, 1);
        }
    }
}

static void what_only_acts_together_is_found_together(void **state)
{
    (void)state;
    static bool within[most];
    memset(within, true, sizeof within);
    static const int pairs[][2] = {{0, 1}, {0, 999}, {499, 500}, {998, 999}, {123, 777}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        Known    k = {.count = 1000, .sets = 1, .size = {2}, .item = {{pairs[i][0], pairs[i][1]}}};
        DeltaSet set;
        CHECK(delta_smallest(&set, &(DeltaSearch){1000, ask, &k, 6}, within) == STATUS_OK);
        CHECK(is_set(&set, &k, 0) && set.smallest);
        CHECK(k.tests <= 2 * (log2_up(1000) + 1) + 2); /* and each left out */
        delta_free(&set, 1);
    }
    Known    three = {.count = 1000, .sets = 1, .size = {3}, .item = {{7, 400, 993}}};
    DeltaSet set;
    CHECK(delta_smallest(&set, &(DeltaSearch){1000, ask, &three, 6}, within) == STATUS_OK);
    CHECK(is_set(&set, &three, 0) && set.smallest);
    delta_free(&set, 1);
}

/* Three causes, one of them of two; the rest does nothing. */
static void each_cause_is_found_and_the_rest_tried(void **state)
{
    (void)state;
    Known       k = {.count = 64, .sets = 3, .size = {1, 2, 1}, .item = {{50}, {3, 60}, {20}}};
    DeltaSet    set[8];
    DeltaAnswer rest;
    int         count = 0;
    CHECK(delta_causes(set, &count, 8, &rest, &(DeltaSearch){64, ask, &k, 6}) == STATUS_OK);
    CHECK(count == 3 && rest == DELTA_STILL);
    for (int s = 0; s < 3; s++) {
        int found = 0;
        for (int i = 0; i < count; i++) found += is_set(&set[i], &k, s);
        CHECK(found == 1);
    }
    delta_free(set, count);
    CHECK(delta_causes(set, &count, 2, &rest, &(DeltaSearch){64, ask, &k, 6}) == STATUS_OK);
    CHECK(count == 2 && rest == DELTA_MOVES); /* there is a third */
    delta_free(set, count);
}

static void few_are_tried_each(void **state)
{
    (void)state;
    Known       k = {.count = 3, .sets = 1, .size = {1}, .item = {{2}}};
    DeltaSet    set[8];
    DeltaAnswer rest;
    int         count = 0;
    CHECK(delta_causes(set, &count, 8, &rest, &(DeltaSearch){3, ask, &k, 6}) == STATUS_OK);
    CHECK(count == 1 && is_set(&set[0], &k, 0) && rest == DELTA_STILL);
    CHECK(k.tests == 3 + 3 + 1); /* each; again until it moves, which costs no run; the rest */
    delta_free(set, count);
}

static void what_cannot_be_run_is_stepped_over(void **state)
{
    (void)state;
    static bool within[64];
    memset(within, true, sizeof within);
    Known    beyond = {.count = 64, .sets = 1, .size = {1}, .item = {{40}}, .only_near = true};
    DeltaSet set;
    CHECK(delta_smallest(&set, &(DeltaSearch){64, ask, &beyond, 6}, within) == STATUS_OK);
    CHECK(is_set(&set, &beyond, 0) && set.smallest);
    delta_free(&set, 1);
    /* among those that go together only: all eight are named, and not as the smallest */
    Known inside = {.count = 64, .sets = 1, .size = {1}, .item = {{5}}, .only_near = true};
    CHECK(delta_smallest(&set, &(DeltaSearch){64, ask, &inside, 6}, within) == STATUS_OK);
    CHECK(set.size == 8 && !set.smallest);
    for (int i = 0; i < 8; i++) CHECK(set.in[i]);
    delta_free(&set, 1);
}

static void a_search_that_is_stopped_has_what_moves(void **state)
{
    (void)state;
    static bool within[1000];
    memset(within, true, sizeof within);
    for (int after = 1; after < 24; after++) {
        Known    k = {.count = 1000, .sets = 1, .size = {2}, .item = {{300, 700}}, .stop_after = after};
        DeltaSet set;
        CHECK(delta_smallest(&set, &(DeltaSearch){1000, ask, &k, 6}, within) == STATUS_OK);
        CHECK(set.in[300] && set.in[700]);
        CHECK(set.smallest ? set.size == 2 : k.tests > after);
        delta_free(&set, 1);
    }
}

/* Not every superset moves: with item 9 in nothing does, unless 4 and 5 are. What is found still moves, and no part of
 * it. */
static DeltaAnswer ask_odd(void *user, const bool *in)
{
    (void)user;
    return (in[2] && !in[9]) || (in[4] && in[5] && in[9]) ? DELTA_MOVES : DELTA_STILL;
}

static void what_undoes_another_is_no_hindrance(void **state)
{
    (void)state;
    bool     within[16];
    DeltaSet set;
    memset(within, true, sizeof within);
    CHECK(delta_smallest(&set, &(DeltaSearch){16, ask_odd, NULL, 6}, within) == STATUS_OK);
    CHECK(set.smallest && ask_odd(NULL, set.in) == DELTA_MOVES);
    for (int i = 0; i < 16; i++) {
        if (!set.in[i]) continue;
        set.in[i] = false;
        CHECK(set.size == 1 || ask_odd(NULL, set.in) == DELTA_STILL);
        set.in[i] = true;
    }
    delta_free(&set, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_among_many_is_found_by_halving),
        cmocka_unit_test(what_only_acts_together_is_found_together),
        cmocka_unit_test(each_cause_is_found_and_the_rest_tried),
        cmocka_unit_test(few_are_tried_each),
        cmocka_unit_test(what_cannot_be_run_is_stepped_over),
        cmocka_unit_test(a_search_that_is_stopped_has_what_moves),
        cmocka_unit_test(what_undoes_another_is_no_hindrance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
