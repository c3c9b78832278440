/* tests/entities/test_entity_limits.c: ends that are remembered, against a list of all; how many entities a sender may
 * add; and shots found among many. */
#include "tests/entities/entity_fixture.h"
#include "entities/survey/survey.h"
#include "entities/table/entity_limits_private.h"

#include <stdlib.h>

/* ---- tombstones --------------------------------------------------------------------------- */

static int dice(uint64_t n, uint32_t what, int sides) { return (int)(random_uniform(12, 3, what, n) * sides); }

/* By the words of tombstones.h: any end of the entity that a report comes too early after. */
static void ends_agree_with_a_list_of_all(void **state)
{
    (void)state;
    enum { ends = 300, ids = 40 }; /* less than the room: none goes */
    struct {
        int    id;
        double end_s;
        bool   detonated;
    } list[ends];
    Tombstones *t = NULL;
    int         yes = 0;
    CHECK(tombstones_create(&t, 1, 100) == STATUS_OK);
    for (int n = 0; n < ends; n++) {
        list[n].id = 1 + dice((uint64_t)n, 0, ids);
        list[n].end_s = 0.5 * dice((uint64_t)n, 1, 40); /* in no order */
        list[n].detonated = dice((uint64_t)n, 2, 3) == 0;
        tombstones_put(t, entity_id(list[n].id), list[n].end_s, list[n].detonated);
        for (int k = 0; k < 20; k++) {
            const uint64_t turn = (uint64_t)(20 * n + k);
            const int      id = 1 + dice(turn, 3, ids + 1);
            const double   t_s = 0.25 * dice(turn, 4, 100), after_s = dice(turn, 5, 2) ? 12 : 1;
            bool           ended = false;
            for (int i = 0; i <= n; i++)
                ended |= list[i].id == id && t_s < list[i].end_s + (list[i].detonated ? after_s : 0);
            CHECK(tombstones_ended(t, entity_id(id), t_s, after_s) == ended);
            yes += ended;
        }
    }
    CHECK(yes > 1000 && yes < 5000 && tombstones_dropped(t) == 0);
    tombstones_destroy(t);
}

/* Of a full room the oldest goes; it is counted while a report could still be that late. */
static void a_full_room_counts_what_goes(void **state)
{
    (void)state;
    enum { room = 10 + tombstones_beyond_capacity };
    Tombstones *t = NULL;
    CHECK(tombstones_create(&t, 10, 100) == STATUS_OK);
    for (int n = 1; n <= room; n++) tombstones_put(t, entity_id(n), 50, false);
    CHECK(tombstones_dropped(t) == 0 && tombstones_ended(t, entity_id(1), 49, 0));
    tombstones_put(t, entity_id(room + 1), 60, false);
    CHECK(tombstones_dropped(t) == 1 && !tombstones_ended(t, entity_id(1), 49, 0));
    CHECK(tombstones_ended(t, entity_id(2), 49, 0) && tombstones_ended(t, entity_id(room + 1), 59, 0));
    tombstones_put(t, entity_id(room + 2), 1000, false); /* the oldest is 950 s old */
    CHECK(tombstones_dropped(t) == 1 && !tombstones_ended(t, entity_id(2), 49, 0));
    tombstones_destroy(t);
}

/* A whole exercise is taken away at once, and what was under way comes afterwards. */
static void ten_thousand_removed_stay_removed(void **state)
{
    (void)state;
    enum { count = 10000 };
    EntityTableConfig config = entity_table_default_config();
    config.capacity = count;
    Fixture        f = fixture_open(&config);
    DisEntityState pdu = report(1, tank_type);
    for (int e = 1; e <= count; e++) {
        pdu.id = entity_id(e);
        CHECK(entity_table_entity_state(f.table, &pdu, 10) == STATUS_OK);
    }
    const DisRemoveEntity all = {.receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    entity_table_remove(f.table, &all, 20);
    CHECK(entity_table_count(f.table) == 0 && entity_table_counters(f.table)->removed == count);
    for (int e = 1; e <= count; e++) {
        pdu.id = entity_id(e);
        CHECK(entity_table_entity_state(f.table, &pdu, 19.9) == STATUS_OK);
    }
    CHECK(entity_table_count(f.table) == 0 && entity_table_counters(f.table)->late == count);
    CHECK(entity_table_counters(f.table)->tombstones_dropped == 0);
    for (int e = 1; e <= 10; e++) { /* who reports after the end is there again */
        pdu.id = entity_id(e);
        CHECK(entity_table_entity_state(f.table, &pdu, 20.1) == STATUS_OK);
    }
    CHECK(entity_table_count(f.table) == 10);
    fixture_close(&f);
}

/* ---- newcomers a second --------------------------------------------------------------------- */

static void a_sender_adds_so_many_a_second(void **state)
{
    (void)state;
    EntityRate       *rate = NULL;
    const DisEntityId one = {1, 1, 7}, other = {1, 2, 7};
    int               in = 0, in_after = 0, in_back = 0;
    CHECK(entity_rate_create(&rate, 100) == STATUS_OK);
    for (int n = 0; n < 1000; n++) in += entity_rate_take(rate, one, 5);
    CHECK(in == 100 && entity_rate_take(rate, other, 5)); /* at once; each has its own */
    for (int n = 0; n < 1000; n++)
        in_after += entity_rate_take(rate, one, 5 + 0.002 * (n + 1)); /* 500 a second for 2 s */
    CHECK(in_after >= 199 && in_after <= 201);
    for (int n = 0; n < 10; n++) in_back += entity_rate_take(rate, one, n % 2 ? 0 : 7); /* time that goes to and fro */
    CHECK(in_back <= 1);
    /* an hour of silence gives no more than a second of it */
    in = 0;
    for (int n = 0; n < 1000; n++) in += entity_rate_take(rate, one, 3600);
    CHECK(in == 100);
    entity_rate_destroy(rate);
}

/* More senders than are remembered: those heard in between keep what they have. */
static void many_senders_do_not_touch_each_other(void **state)
{
    (void)state;
    EntityRate *rate = NULL;
    uint64_t    in = 0;
    CHECK(entity_rate_create(&rate, 2) == STATUS_OK);
    for (int n = 0; n < 30000; n++) in += entity_rate_take(rate, (DisEntityId){(uint16_t)(n % 10000), 1, 1}, 0);
    CHECK(in == 30000); /* each is forgotten before it is heard again: no victim */
    for (int n = 0; n < 3; n++) in += entity_rate_take(rate, (DisEntityId){40000, 1, 1}, 0);
    CHECK(in == 30002);
    entity_rate_destroy(rate);
}

static void the_table_counts_what_is_over_the_rate(void **state)
{
    (void)state;
    EntityTableConfig config = entity_table_default_config();
    config.new_per_s = 50;
    Fixture        f = fixture_open(&config);
    DisEntityState pdu = report(1, tank_type);
    entity_table_focus(f.table, entity_id(999), entity_id(998));
    for (int e = 1; e <= 500; e++) {
        pdu.id = entity_id(e);
        CHECK(entity_table_entity_state(f.table, &pdu, 1) == STATUS_OK);
    }
    CHECK(entity_table_count(f.table) == 50 && entity_table_counters(f.table)->over_rate == 450);
    for (int e = 1; e <= 50; e++) { /* those that are there report as often as they like */
        pdu.id = entity_id(e);
        CHECK(entity_table_entity_state(f.table, &pdu, 1.001) == STATUS_OK);
    }
    for (int e = 998; e <= 999; e++) { /* the host and its aim come in at any rate */
        pdu.id = entity_id(e);
        CHECK(entity_table_entity_state(f.table, &pdu, 1.001) == STATUS_OK);
    }
    pdu.id.application = 77; /* another sender */
    CHECK(entity_table_entity_state(f.table, &pdu, 1.001) == STATUS_OK);
    CHECK(entity_table_count(f.table) == 53 && entity_table_counters(f.table)->over_rate == 450);
    fixture_close(&f);
}

/* ---- shots by munition ---------------------------------------------------------------------- */

/* The first shot of a munition, as a search from end to end finds it; in far fewer looks, which is what the order is
 * for. */
static void shots_are_found_by_munition(void **state)
{
    (void)state;
    enum { count = 3000 };
    static Shot shot[count];
    Survey      by_hand = {.shot_count = count, .shot = shot}, survey = by_hand;
    for (int i = 0; i < count; i++) shot[i].munition = entity_id(1 + dice((uint64_t)i, 6, 1500));
    CHECK(survey_order_shots(&survey.shot_by_munition, shot, count) == STATUS_OK);
    for (int e = 0; e <= 1501; e++) CHECK(survey_shot(&survey, entity_id(e)) == survey_shot(&by_hand, entity_id(e)));
    for (int i = 1; i < count; i++) {
        const int a = survey.shot_by_munition[i - 1], b = survey.shot_by_munition[i];
        const int order = dis_entity_id_compare(shot[a].munition, shot[b].munition);
        CHECK(order < 0 || (order == 0 && a < b));
    }
    free(survey.shot_by_munition);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_agree_with_a_list_of_all),
        cmocka_unit_test(a_full_room_counts_what_goes),
        cmocka_unit_test(ten_thousand_removed_stay_removed),
        cmocka_unit_test(a_sender_adds_so_many_a_second),
        cmocka_unit_test(many_senders_do_not_touch_each_other),
        cmocka_unit_test(the_table_counts_what_is_over_the_rate),
        cmocka_unit_test(shots_are_found_by_munition),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
