/* tests/sensor/test_munitions.c: which munition a Detonation ends: by its id, by the Fire of its event, by place and
 * time. */
#include "tests/check.h"

#include "sensor/node/player/munitions.h"
#include "tests/sensor/open_catalog.h"

#include <stdlib.h>

static const double earth_m = 6378137;

/* Reported at 100 s, 300 m/s to the north along a meridian at the equator, east_m beside it. */
static void report(Munitions *m, EntityTable *table, uint16_t entity, double east_m, double north_m, double t_s)
{
    const DisEntityState pdu = {.header = {.version = 7, .exercise = 1, .type = dis_pdu_entity_state, .family = 1},
                                .id = {1, 1, entity},
                                .type = {2, 2, 225, 1, 1, 3, 0},
                                .velocity_mps = {0, 0, 300},
                                .p_ecef = {earth_m + 2000, east_m, north_m},
                                .dead_reckoning = 2};
    assert_int_equal(entity_table_entity_state(table, &pdu, t_s), STATUS_OK);
    munitions_report(m, &pdu, t_s);
}

typedef struct Case {
    const char *what;
    uint16_t    munition, number, firing; /* of the burst; 0: none */
    double      east_m, north_m;          /* of the burst at 100.05 s: the missile is at 0, 15 */
    uint16_t    want;                     /* which is spent; 0: none */
} Case;

/* Missile 41 of firing entity 31, event 5; 42, whose Fire was not heard, 30 m beside it. Event 7 is a round without an
 * entity. */
static const Case cases[] = {
    {"named", 41, 0, 0, 900, 0, 41},
    {"named otherwise", 77, 5, 31, 0, 15, 0},
    {"by its event, anywhere", 0, 5, 31, 900, 0, 41},
    {"by its event, no firing entity", 0, 5, 0, 900, 0, 41},
    {"its event from another firing entity", 0, 5, 32, 900, 0, 0},
    {"an event unheard of: by place", 0, 6, 0, 3, 15, 41},
    {"no event: by place", 0, 0, 31, 3, 15, 41},
    {"no event: another's place", 0, 0, 0, 27, 15, 42},
    {"of two, the nearer", 0, 0, 0, 9, 15, 41},
    {"beside it", 0, 0, 0, -12, 15, 0},
    {"ahead, as late as 0.08 s", 0, 0, 0, 0, 39, 41},
    {"ahead by more", 0, 0, 0, 0, 60, 0},
    {"a round without an entity, at its place", 0, 7, 31, 3, 15, 0},
    {"at its place, of another firing entity", 0, 0, 32, 3, 15, 0},
    {"of another firing entity, at the place of an unheard Fire", 0, 0, 32, 30, 15, 42},
};

static void a_burst_ends_the_munition_that_it_is_of(void **state)
{
    (void)state;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        EntityTableConfig config = entity_table_default_config();
        EntityTable      *table = NULL;
        Munitions        *m = calloc(1, sizeof *m);
        const Case       *k = &cases[c];
        assert_int_equal(entity_table_create(&table, &config, catalog), STATUS_OK);
        const DisFire fire = {.firing = {1, 1, 31}, .target = {1, 1, 9}, .munition = {1, 1, 41}, .event = {1, 1, 5}};
        const DisFire round = {.firing = {1, 1, 31}, .target = {1, 1, 9}, .event = {1, 1, 7}};
        munitions_fire(m, &fire);
        munitions_fire(m, &round);
        report(m, table, 41, 0, 0, 100);
        report(m, table, 42, 30, 0, 100);
        const DisDetonation burst = {.firing = {k->firing != 0, k->firing != 0, k->firing},
                                     .munition = {k->munition != 0, k->munition != 0, k->munition},
                                     .event = {1, 1, k->number},
                                     .p_ecef = {earth_m + 2000, k->east_m, k->north_m}};
        munitions_burst(m, &burst, table, 100.05, 100.05);
        for (uint16_t id = 41; id <= 42; id++)
            if (munitions_spent(m, (DisEntityId){1, 1, id}) != (id == k->want)) fail_msg("%s: %d", k->what, id);

        /* a report elsewhere a fifth of a second later: what was ended by place flies on, what an id ended does not */
        report(m, table, 41, 0, 75, 100.25);
        report(m, table, 42, 30, 75, 100.25);
        const bool by_place = !k->munition && k->number != 5;
        for (uint16_t id = 41; id <= 42; id++)
            if (munitions_spent(m, (DisEntityId){1, 1, id}) != (id == k->want && (!by_place || k->north_m > 30)))
                fail_msg("%s, later: %d", k->what, id);
        free(m);
        entity_table_destroy(table);
    }
}

/* A Fire without a target does not take it from an earlier one. */
static void the_target_is_of_the_latest_fire_that_has_one(void **state)
{
    (void)state;
    Munitions    *m = calloc(1, sizeof *m);
    const DisFire fire[3] = {{.munition = {1, 1, 41}, .target = {1, 1, 8}},
                             {.munition = {1, 1, 41}, .target = {1, 1, 9}},
                             {.munition = {1, 1, 41}}};
    DisEntityId   target = {0};
    for (int k = 0; k < 3; k++) munitions_fire(m, &fire[k]);
    CHECK(munitions_target(&target, m, (DisEntityId){1, 1, 41}) && target.entity == 9);
    CHECK(!munitions_target(&target, m, (DisEntityId){1, 1, 42}));
    free(m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_burst_ends_the_munition_that_it_is_of),
        cmocka_unit_test(the_target_is_of_the_latest_fire_that_has_one),
    };
    return cmocka_run_group_tests(tests, open_catalog, close_catalog);
}
