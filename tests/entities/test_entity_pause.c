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

/* ---- what moves ------------------------------------------------------------------------------------- */

enum { most_nodes = 64 };

/* All of an entity that moves. */
typedef struct Posed {
    double   p_ecef[3], r_ecef_from_body[9];
    NodePose node[most_nodes];
    int      nodes;
} Posed;

static Posed posed_at(Fixture *f, int entity, double t_s)
{
    const SnapshotEntity *e = seen_at(f, entity, t_s);
    Posed                 out = {0};
    double                joint_value[most_nodes];
    CHECK(e != NULL);
    const Model *model = catalog_model(f->catalog, e->model);
    out.nodes = model->node_count;
    CHECK(out.nodes <= most_nodes);
    memcpy(out.p_ecef, e->p_ecef, sizeof out.p_ecef);
    memcpy(out.r_ecef_from_body, e->r_ecef_from_body, sizeof out.r_ecef_from_body);
    snapshot_pose(out.node, joint_value, &f->snapshot, (int)(e - f->snapshot.entity), model);
    /* the other way to a pose has the same */
    NodePose       node[most_nodes];
    SnapshotEntity alone;
    CHECK(entity_table_pose_nodes(&alone, node, joint_value, f->table, entity_table_find(f->table, entity_id(entity)),
                                  t_s));
    CHECK(memcmp(node, out.node, (size_t)out.nodes * sizeof *node) == 0);
    CHECK(memcmp(alone.p_ecef, e->p_ecef, sizeof alone.p_ecef) == 0);
    return out;
}

/* Largest difference of places, m, and of rotations. */
static double apart(const Posed *a, const Posed *b)
{
    double most = 0;
    for (int i = 0; i < 3; i++) most = fmax(most, fabs(a->p_ecef[i] - b->p_ecef[i]));
    for (int i = 0; i < 9; i++) most = fmax(most, fabs(a->r_ecef_from_body[i] - b->r_ecef_from_body[i]));
    for (int n = 0; n < a->nodes; n++) {
        for (int i = 0; i < 3; i++) most = fmax(most, fabs(a->node[n].p_body[i] - b->node[n].p_body[i]));
        for (int i = 0; i < 9; i++)
            most = fmax(most, fabs(a->node[n].r_body_from_node[i] - b->node[n].r_body_from_node[i]));
    }
    return most;
}

enum { kinds = 3, algorithms = 9, movers = kinds * algorithms }; /* entities 1 .. movers */

static DisEntityState mover(int entity)
{
    static const DisEntityType types[kinds] = {
        {1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 7, 1, 0, 0}, {1, 2, 225, 20, 1, 0, 0}};
    const int      type = (entity - 1) / algorithms, algorithm = 1 + (entity - 1) % algorithms;
    DisEntityState pdu = report(entity, types[type]);
    pdu.dead_reckoning = (uint8_t)algorithm;
    pdu.velocity_mps[algorithm >= 6 ? 0 : 2] = 9; /* forward is x of the body, and north */
    pdu.acceleration_mps2[algorithm >= 6 ? 0 : 2] = 0.5f;
    pdu.angular_rate_rps[2] = 0.1f;
    pdu.variable_count = type == 0 ? 4 : 0;
    pdu.variable[0] = articulated(4096 + 11, 0.5f), pdu.variable[1] = articulated(4096 + 12, 0.125f);
    pdu.variable[2] = articulated(4416 + 13, 0.0f), pdu.variable[3] = articulated(4416 + 14, 0.03f);
    return pdu;
}

/* Hears all of them. joints: with their joints, which only tanks report. */
static void hear_movers(Fixture *f, bool joints, uint32_t appearance, double north_m, double t_s)
{
    for (int e = 1; e <= movers; e++) {
        DisEntityState pdu = mover(e);
        if (!joints) pdu.variable_count = 0;
        pdu.appearance = appearance;
        pdu.p_ecef[2] += north_m;
        hear(f, &pdu, t_s);
    }
}

static void stand_still(Fixture *f, double from_s, double to_s)
{
    for (int n = 1; n <= movers; n++) {
        const Posed before = posed_at(f, n, from_s);
        for (double t_s = from_s; t_s < to_s; t_s += 1.7) {
            const Posed           now = posed_at(f, n, t_s);
            const SnapshotEntity *e = seen_at(f, n, t_s);
            CHECK_NEAR(apart(&before, &now), 0, 1e-9);
            CHECK(v3_length(e->v_ecef_mps) == 0 && v3_length(e->w_body_rps) == 0);
            CHECK(e->position_error_m == 0 && e->drift_m == 0 && e->drift_rad == 0);
        }
    }
}

/* Each is where its twin is ten seconds earlier, and as uncertain. Tolerance: times differ by roundings of 1e-15 s of
 * 17 s, at 100 rad/s of a rotor. */
static void same_as_twins(Fixture *f, Fixture *twins, double from_s, double to_s)
{
    for (int n = 1; n <= movers; n++)
        for (double t_s = from_s; t_s < to_s; t_s += 0.37) {
            const Posed now = posed_at(f, n, t_s), other = posed_at(twins, n, t_s - 10);
            CHECK_NEAR(apart(&other, &now), 0, 1e-8);
            const SnapshotEntity *e = seen_at(f, n, t_s), *twin = seen_at(twins, n, t_s - 10);
            CHECK_NEAR(e->position_error_m, twin->position_error_m, 1e-9);
            CHECK_NEAR(v3_length(e->v_ecef_mps), v3_length(twin->v_ecef_mps), 1e-9);
        }
}

/* Tanks with joints that turn, lorries with wheels and helicopters with rotors, of each algorithm, stopped from 2 to 12
 * s: nothing of them moves, and they have no velocity, rate or growing error. After the resume each is where its twin
 * that was never stopped is 10 s earlier, and so it is after its next report, which leaves the joints out: they stop
 * where they were. */
static void nothing_moves_in_a_pause(void **state)
{
    (void)state;
    const DisStopFreeze  stop = {.receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    const DisStartResume start = {.receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    Fixture              f = fixture_open(NULL), twins = fixture_open(NULL);
    hear_movers(&f, true, 0, 0, 0);
    hear_movers(&twins, true, 0, 0, 0);
    for (int n = 1; n <= movers; n++) { /* something of each moves, but of a static lorry */
        const Posed first = posed_at(&f, n, 0), later = posed_at(&f, n, 2);
        CHECK(apart(&first, &later) > 0.1 || n == algorithms + 1);
    }
    entity_table_stop(f.table, &stop, 2);
    stand_still(&f, 2, 12);
    entity_table_start(f.table, &start, 12);
    same_as_twins(&f, &twins, 12, 15);
    for (int n = 1; n <= movers; n++) CHECK_NEAR(seen_at(&f, n, 14)->drift_rad, seen_at(&twins, n, 4)->drift_rad, 1e-9);
    hear_movers(&f, false, 0, 31, 15);
    hear_movers(&twins, false, 0, 31, 5);
    same_as_twins(&f, &twins, 15, 17);
    fixture_close(&f);
    fixture_close(&twins);
}

/* The same by the frozen bit of their own reports, from 2 to 12 s. The twins report the same at 2 s, twice. */
static void nothing_moves_while_frozen(void **state)
{
    (void)state;
    Fixture f = fixture_open(NULL), twins = fixture_open(NULL);
    hear_movers(&f, true, 0, 0, 0);
    hear_movers(&twins, true, 0, 0, 0);
    hear_movers(&twins, true, 0, 0, 2);
    hear_movers(&f, true, frozen_bit, 0, 2);
    stand_still(&f, 2, 12);
    hear_movers(&f, false, 0, 0, 12);
    hear_movers(&twins, false, 0, 0, 2);
    same_as_twins(&f, &twins, 12, 15);
    fixture_close(&f);
    fixture_close(&twins);
}

/* ---- what runs ------------------------------------------------------------------------------------- */

/* What ends at a known time: a missile's motor 2 s after its launch, a flare 4 s, an engine that idles 120 s after the
 * tank's last motion (at 10 s, by its report that it stands), a wreck's fire 600 s after the report of its destruction
 * at 10 s (entities/table/drives.c). */
typedef struct Running {
    DisEntityType type;
    double        stop_s, ends_s;
    float         value;
} Running;

static const Running running[] = {{{2, 2, 225, 1, 1, 3, 0}, 0.5, 2, 1},
                                  {{8, 2, 225, 2, 0, 0, 0}, 1, 4, 1},
                                  {{1, 1, 222, 1, 1, 1, 0}, 20.5, 130, 0.6f},
                                  {{1, 1, 222, 1, 1, 1, 0}, 20.5, 610, 1}};

static float drive_of(Fixture *f, int k, double t_s)
{
    const SnapshotEntity *e = seen_at(f, 1, t_s);
    CHECK(e != NULL);
    return k == 0 ? e->drives.motor : k == 1 ? e->drives.flare : k == 2 ? e->drives.engine : e->drives.burning;
}

/* Whether gas is there that burns now; of the tank that idles, exhaust. */
static bool glows(Fixture *f, int k, double t_s)
{
    static const EffectKind kind[] = {EFFECT_MOTOR_PLUME, EFFECT_FLARE_FIRE, EFFECT_EXHAUST};
    bool                    is_there = false;
    seen_at(f, 1, t_s);
    for (int i = 0; i < f->snapshot.puff_count; i++) is_there |= f->snapshot.puff[i].kind == kind[k];
    return is_there;
}

/* How a pause is made: by Stop and Start, by the frozen bit of ten reports, by a Stop that a report ends, by a Stop
 * with reports within it. */
typedef enum Pause { PAUSE_START, PAUSE_FROZEN, PAUSE_REPORT, PAUSE_REPORTS_ON, pauses } Pause;

enum { pause_s = 100 };

static void pause_it(Fixture *f, DisEntityState pdu, Pause how, double from_s)
{
    const DisStopFreeze stop = {.receiving = {0xFFFF, 0xFFFF, 0xFFFF},
                                .frozen_behaviour = how == PAUSE_REPORTS_ON ? 2 : 0};
    DisEntityState      frozen = pdu;
    frozen.appearance |= frozen_bit;
    if (how != PAUSE_FROZEN) entity_table_stop(f->table, &stop, from_s);
    for (int i = 0; how == PAUSE_FROZEN && i < 10; i++) hear(f, &frozen, from_s + 10 * i);
    if (how == PAUSE_REPORTS_ON) hear(f, &pdu, from_s + 30), hear(f, &pdu, from_s + 60);
    CHECK(entity_table_count(f->table) == 1);
}

/* None of it runs on while its entity stands: after a pause of 100 s each ends 100 s later, whatever made the pause. */
static void drives_stand_in_a_pause(void **state)
{
    (void)state;
    const DisStartResume start = {.receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    for (int k = 0; k < 4; k++)
        for (Pause how = PAUSE_START; how < pauses; how++) {
            const Running *r = &running[k];
            const double   on_s = r->stop_s + pause_s, off_s = r->ends_s + pause_s;
            Fixture        f = fixture_open(NULL);
            DisEntityState pdu = report(1, r->type);
            pdu.velocity_mps[2] = k == 2 ? 10 : 0;
            hear(&f, &pdu, 0);
            pdu.velocity_mps[2] = 0;
            if (k == 3) pdu.appearance = destroyed_bits;
            for (int t_s = 10; t_s < r->stop_s; t_s += 10) hear(&f, &pdu, t_s);
            pause_it(&f, pdu, how, r->stop_s);
            CHECK(drive_of(&f, k, r->stop_s + 99) == r->value && (k == 3 || glows(&f, k, r->stop_s + 99)));
            if (how == PAUSE_FROZEN || how == PAUSE_REPORT) hear(&f, &pdu, on_s);
            else entity_table_start(f.table, &start, on_s);
            for (double t_s = on_s + 10; t_s < off_s; t_s += 10) hear(&f, &pdu, t_s);
            CHECK(drive_of(&f, k, off_s - 1e-3) == r->value && drive_of(&f, k, off_s + 1e-3) == 0);
            CHECK(k == 3 || (glows(&f, k, off_s - 1e-3) && !glows(&f, k, off_s + 1e-3)));
            fixture_close(&f);
        }
}

/* Age of the youngest smoke of motors, s. */
static double youngest_s(Fixture *f, double t_s)
{
    double age_s = INFINITY;
    seen_at(f, 1, t_s);
    for (int i = 0; i < f->snapshot.puff_count; i++)
        if (f->snapshot.puff[i].kind == EFFECT_MOTOR_SMOKE) age_s = fmin(age_s, f->snapshot.puff[i].age_s);
    return age_s;
}

/* A motor that stands smokes where it is, as all that smoked does. Its smoke ends with it: at 106 s, 4 s after its end,
 * the youngest is 4 s old, and at most the interval of two puffs (0.05 s or less) older. The Fire of a munition that
 * stands lights its motor for 2 s of its own time. */
static void a_motor_stands_with_its_munition(void **state)
{
    (void)state;
    Fixture              f = fixture_open(NULL);
    const DisEntityState pdu = report(1, running[0].type);
    hear(&f, &pdu, 0);
    pause_it(&f, pdu, PAUSE_START, 0.5);
    CHECK_NEAR(youngest_s(&f, 50), 0.05, 0.05);
    entity_table_start(f.table, &(DisStartResume){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 100.5);
    CHECK_NEAR(youngest_s(&f, 106), 4.05, 0.05);

    entity_table_stop(f.table, &(DisStopFreeze){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 107);
    entity_table_fire(f.table, &(DisFire){.munition = pdu.id}, 120);
    entity_table_start(f.table, &(DisStartResume){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 130);
    CHECK(drive_of(&f, 0, 131.99) == 1 && drive_of(&f, 0, 132.01) == 0);
    fixture_close(&f);
}

/* A ship's radar turns by its engine, which stops 120 s after the last motion: it stands in the pause, and turns on as
 * that of a twin that was never stopped, until the engine's end and after it. */
static void a_radar_turns_until_the_engine_ends(void **state)
{
    (void)state;
    static const DisEntityType ship_type = {1, 3, 225, 6, 1, 0, 0};
    Fixture                    f = fixture_open(NULL), twin = fixture_open(NULL);
    DisEntityState             pdu = report(1, ship_type);
    pdu.velocity_mps[2] = 10;
    hear(&f, &pdu, 0), hear(&twin, &pdu, 0);
    pdu.velocity_mps[2] = 0;
    for (int t_s = 10; t_s <= 120; t_s += 10) hear(&f, &pdu, t_s), hear(&twin, &pdu, t_s);
    pause_it(&f, pdu, PAUSE_START, 125);
    entity_table_start(f.table, &(DisStartResume){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 225);
    for (double t_s = 125.5; t_s < 132; t_s += 0.7) {
        const Posed now = posed_at(&f, 1, t_s + pause_s), other = posed_at(&twin, 1, t_s);
        CHECK_NEAR(apart(&now, &other), 0, 1e-9);
    }
    const Posed before = posed_at(&twin, 1, 129), end = posed_at(&twin, 1, 130), after = posed_at(&twin, 1, 131);
    CHECK(apart(&before, &end) > 0.1 && apart(&end, &after) == 0);
    fixture_close(&f);
    fixture_close(&twin);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stop_and_start),
        cmocka_unit_test(a_pause_is_no_silence),
        cmocka_unit_test(reports_within_a_pause),
        cmocka_unit_test(reliable_ones_act),
        cmocka_unit_test(nothing_moves_in_a_pause),
        cmocka_unit_test(nothing_moves_while_frozen),
        cmocka_unit_test(drives_stand_in_a_pause),
        cmocka_unit_test(a_motor_stands_with_its_munition),
        cmocka_unit_test(a_radar_turns_until_the_engine_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
