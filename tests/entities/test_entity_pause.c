/* tests/entities/test_entity_pause.c: Stop/Freeze and Start/Resume: which entities stop, what does not count as
 * silence, to whom a PDU applies. */
#include "tests/entities/entity_fixture.h"
#include "dis/pdu/decode.h"

/* Stop holds it, Start goes on from there without a jump, a report of its own overrules the stop. */
static void stop_and_start(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, tank_type), other = report(2, tank_type);
    pdu.velocity_mps[1] = 10;
    other.velocity_mps[1] = 10;
    other.id.application = 4000;
    hear(&f, &pdu, 0);
    hear(&f, &other, 0);
    entity_table_stop(f.table, &(DisStopFreeze){.receiving = {1, 3001, 0}}, 2);
    CHECK_NEAR(seen_at(&f, 1, 2)->p_ecef[1], 20, 1e-12);
    const SnapshotEntity *e = seen_at(&f, 1, 9);
    CHECK_NEAR(e->p_ecef[1], 20, 1e-12);
    CHECK(v3_length(e->v_ecef_mps) == 0);
    CHECK(snapshot_find(&f.snapshot, other.id) >= 0);
    CHECK_NEAR(f.snapshot.entity[snapshot_find(&f.snapshot, other.id)].p_ecef[1], 90, 1e-12);
    CHECK(seen_at(&f, 1, 1000)); /* not expected to speak */

    entity_table_start(f.table, &(DisStartResume){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 9);
    CHECK_NEAR(seen_at(&f, 1, 9)->p_ecef[1], 20, 1e-12);
    CHECK_NEAR(seen_at(&f, 1, 11)->p_ecef[1], 40, 1e-12);

    entity_table_stop(f.table, &(DisStopFreeze){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 11);
    pdu.p_ecef[1] = 500;
    hear(&f, &pdu, 12);
    CHECK_NEAR(seen_at(&f, 1, 13)->p_ecef[1], 510, 1e-9);
    fixture_close(&f);
}

/* Time stopped is no silence: 20 s of it, then a report due 5 s after the Resume. The silence before and after counts.
 */
static void a_pause_is_no_silence(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, tank_type);
    pdu.velocity_mps[1] = 10;
    hear(&f, &pdu, 20);
    entity_table_stop(f.table, &(DisStopFreeze){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 20.2);
    entity_table_start(f.table, &(DisStartResume){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 40);
    entity_table_expire(f.table, 44.9);
    CHECK(seen_at(&f, 1, 44.9));
    CHECK_NEAR(seen_at(&f, 1, 44.9)->p_ecef[1], 2 + 49, 1e-9);
    CHECK(entity_table_count(f.table) == 1);
    hear(&f, &pdu, 45);
    CHECK(entity_table_counters(f.table)->timed_out == 0);
    entity_table_stop(f.table, &(DisStopFreeze){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 51);
    entity_table_start(f.table, &(DisStartResume){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 61);
    entity_table_expire(f.table, 66.9); /* 6 s and 5.9 s of silence */
    CHECK(entity_table_count(f.table) == 1);
    entity_table_expire(f.table, 67.1);
    CHECK(entity_table_count(f.table) == 0);
    fixture_close(&f);
}

/* A Freeze that lets entities go on reporting (frozen behaviour, bit 1) is not ended by a report; nor is any by a
 * report from before it that came late. */
static void reports_within_a_pause(void **state)
{
    (void)state;
    for (int late = 0; late < 2; late++) {
        Fixture        f = fixture_open(NULL);
        DisEntityState pdu = report(1, tank_type);
        pdu.velocity_mps[1] = 10;
        hear(&f, &pdu, 0);
        entity_table_stop(f.table,
                          &(DisStopFreeze){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}, .frozen_behaviour = late ? 0 : 2}, 5);
        pdu.p_ecef[1] = 40;
        hear(&f, &pdu, late ? 4 : 8);
        CHECK_NEAR(seen_at(&f, 1, 10)->p_ecef[1], late ? 50 : 40, 1e-9);
        entity_table_start(f.table, &(DisStartResume){.receiving = {1, 0xFFFF, 0xFFFF}}, 20);
        CHECK_NEAR(seen_at(&f, 1, 21)->p_ecef[1], late ? 60 : 50, 1e-9);
        fixture_close(&f);
    }
}

/* With reliability: the same. */
static void reliable_ones_act(void **state)
{
    (void)state;
    static DisPdu  pdu;
    Fixture        f = fixture_open(NULL);
    DisEntityState moving = report(1, tank_type);
    moving.velocity_mps[1] = 10;
    hear(&f, &moving, 0);
    pdu.type = dis_pdu_stop_freeze_r;
    pdu.stop = (DisStopFreeze){.header = {.version = 7, .type = pdu.type}, .receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    entity_table_pdu(f.table, &pdu, 1, &f.counters);
    CHECK_NEAR(seen_at(&f, 1, 5)->p_ecef[1], 10, 1e-9);
    pdu.type = dis_pdu_start_resume_r;
    pdu.start = (DisStartResume){.header = {.version = 7, .type = pdu.type}, .receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    entity_table_pdu(f.table, &pdu, 5, &f.counters);
    CHECK_NEAR(seen_at(&f, 1, 6)->p_ecef[1], 20, 1e-9);
    pdu.type = dis_pdu_remove_entity_r;
    pdu.remove = (DisRemoveEntity){.header = {.version = 7, .type = pdu.type}, .receiving = entity_id(1)};
    entity_table_pdu(f.table, &pdu, 7, &f.counters);
    CHECK(entity_table_count(f.table) == 0);
    fixture_close(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stop_and_start),
        cmocka_unit_test(a_pause_is_no_silence),
        cmocka_unit_test(reports_within_a_pause),
        cmocka_unit_test(reliable_ones_act),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
