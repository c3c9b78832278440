/* tests/entities/test_entity_report.c: what one report makes of an entity, at both ends of what is taken, and what is
 * carried on from it to the next: timeouts, limits, the way it went, by how much it was missed, its engine's load. */
#include "tests/entities/entity_fixture.h"

static const EntityCounters *counted(const Fixture *f) { return entity_table_counters(f->table); }

/* Heartbeats of IEEE 1278.1-2012 (heartbeat table): 5 s for platforms in the air and in space that move and for
 * munitions, 55 or 60 s for all others and for what stands still; timeouts are 2.4 times as long: 12 and 132 s. Before
 * version 7 all have 12 s. Along which axis a thing moves does not matter. */
static void timeouts_are_those_of_the_kind(void **state)
{
    (void)state;
    static const struct {
        uint8_t kind, domain;
        bool    moves;
        double  timeout_s; /* of version 7 */
    } c[] = {{1, 0, true, 132},  {1, 1, true, 132}, {1, 1, false, 132}, {1, 2, true, 12},   {1, 2, false, 132},
             {1, 3, true, 132},  {1, 4, true, 132}, {1, 5, true, 12},   {1, 5, false, 132}, {2, 2, true, 12},
             {2, 2, false, 12},  {2, 1, true, 12},  {3, 1, true, 132},  {3, 2, true, 132},  {4, 1, true, 132},
             {5, 1, false, 132}, {6, 1, true, 132}, {8, 2, true, 132},  {9, 1, false, 132}};
    enum { kinds = sizeof c / sizeof *c, all = 9 * kinds };
    Fixture f = fixture_open(NULL);
    double  ends_s[all];
    for (int n = 0; n < all; n++) {
        const int      i = n % kinds, version = 5 + n / kinds % 3;
        DisEntityState pdu = report(1 + n, (DisEntityType){c[i].kind, c[i].domain, 225, 1, 1, 0, 0});
        pdu.header.version = (uint8_t)version;
        pdu.velocity_mps[n / kinds / 3] = c[i].moves ? 1 : 0;
        hear(&f, &pdu, 100);
        ends_s[n] = 100 + (version < 7 ? 12 : c[i].timeout_s);
    }
    static const double at_s[] = {112, 112.001, 232, 232.001};
    for (int k = 0; k < 4; k++) {
        entity_table_expire(f.table, at_s[k]);
        for (int n = 0; n < all; n++)
            CHECK(entity_table_alive(f.table, entity_table_find(f.table, entity_id(1 + n))) == (at_s[k] <= ends_s[n]));
    }
    CHECK(counted(&f)->timed_out == all);
    fixture_close(&f);
}

/* 20 km/s, 10 km/s2 and 20 rad/s are the most that is taken, of the whole vector; a larger one counts as none. */
static void the_most_that_moves(void **state)
{
    (void)state;
    static const double most[3] = {2e4, 1e4, 20};
    Fixture             f = fixture_open(NULL);
    for (int what = 0; what < 3; what++)
        for (int over = 0; over < 2; over++) {
            const int      entity = 1 + 2 * what + over;
            DisEntityState pdu = report(entity, tank_type);
            const float    size = (float)(most[what] * (over ? 1.0001 : 0.9999));
            float         *v = what == 0 ? pdu.velocity_mps : what == 1 ? pdu.acceleration_mps2 : pdu.angular_rate_rps;
            v[1] = 0.6f * size, v[2] = 0.8f * size;
            hear(&f, &pdu, 0);
            const SnapshotEntity *e = seen_at(&f, entity, 0.01);
            CHECK(counted(&f)->motion_refused == (uint64_t)(what + over));
            const double got = what == 2 ? v3_length(e->w_body_rps) : v3_length(e->v_ecef_mps) / (what == 1 ? 0.01 : 1);
            CHECK_NEAR(got, over ? 0 : (double)size, 1e-6 * most[what]);
        }
    fixture_close(&f);
}

/* A report 0.9 s after the Detonation of its entity comes too late, one after 1.1 s is of an id that is used again; one
 * that calls the munition destroyed comes too late for 12 s. One from before an ordinary end does not bring it back. */
static void what_comes_after_the_end(void **state)
{
    (void)state;
    static const struct {
        double after_s;
        bool   destroyed, back;
    } c[] = {{0.9, false, false}, {1.1, false, true}, {11.9, true, false}, {12.1, true, true}};
    for (int i = 0; i < 4; i++) {
        Fixture        f = fixture_open(NULL);
        DisEntityState pdu = report(1, missile_type);
        hear(&f, &pdu, 0);
        entity_table_detonation(f.table, &(DisDetonation){.munition = pdu.id, .p_ecef = {earth_radius_m, 0, 0}}, 2);
        CHECK(entity_table_count(f.table) == 0);
        pdu.appearance = c[i].destroyed ? 3 << dis_appearance_damage_shift : 0;
        hear(&f, &pdu, 2 + c[i].after_s);
        CHECK(entity_table_count(f.table) == c[i].back);
        fixture_close(&f);
    }
    /* nor does one end a munition that has its id since */
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, missile_type);
    hear(&f, &pdu, 10);
    entity_table_detonation(f.table, &(DisDetonation){.munition = pdu.id, .p_ecef = {earth_radius_m, 0, 0}}, 9);
    CHECK(entity_table_count(f.table) == 1);
    fixture_close(&f);
}

/* The second report finds the entity 3 m beside where the first said and turned by 0.1 rad, after 2 s: by as much it
 * may be off 2 s later, and before by the square of the time for the place (as by an acceleration) and in proportion
 * for the attitude (as by a rate). Of a first report nothing is known: as far as its place may be off, and 3 degrees at
 * the heartbeat of 5 s. */
static void a_miss_is_expected_again(void **state)
{
    (void)state;
    static const struct {
        double age_s, share;
    } c[] = {{0, 0}, {0.5, 0.25}, {1, 0.5}, {2, 1}, {7, 1}};
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, tank_type);
    pdu.velocity_mps[1] = 10;
    hear(&f, &pdu, 100);
    const SnapshotEntity *e = seen_at(&f, 1, 102);
    CHECK_NEAR(e->drift_rad, 3 * rad_per_deg * 2 / 5, 1e-12);
    CHECK_NEAR(e->drift_m, e->position_error_m, 0);
    pdu.p_ecef[1] = 20, pdu.p_ecef[2] = 3;
    pdu.phi_rad += 0.1f;
    hear(&f, &pdu, 102);
    for (int i = 0; i < 5; i++) {
        e = seen_at(&f, 1, 102 + c[i].age_s);
        CHECK_NEAR(e->drift_m, 3 * c[i].share * c[i].share, 1e-9);
        CHECK_NEAR(e->drift_rad, 0.1 * c[i].share, 1e-7); /* the angles are floats */
    }
    fixture_close(&f);
}

/* How far a place may be off: evenly up to 1 m at the heartbeat of 5 s, then by 1 m/s2; where extrapolation ends
 * before, by the way at its speed since. */
static void places_may_be_off(void **state)
{
    (void)state;
    static const struct {
        double limit_s, age_s, want_m;
    } c[] = {{12, 0, 0},  {12, 2.5, 0.5}, {12, 5, 1},        {12, 8, 1 + 0.5 * 9}, {12, 12, 1 + 0.5 * 49},
             {4, 3, 0.6}, {4, 5, 1 + 9},  {4, 10, 1 + 9 * 6}};
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        EntityTableConfig config = entity_table_default_config();
        config.extrapolation_limit_s = c[i].limit_s;
        Fixture        f = fixture_open(&config);
        DisEntityState pdu = report(1, tank_type);
        pdu.velocity_mps[1] = 9;
        hear(&f, &pdu, 0);
        CHECK_NEAR(seen_at(&f, 1, c[i].age_s)->position_error_m, c[i].want_m, 1e-12);
        fixture_close(&f);
    }
}

/* Up is x here, forward z; body x forward, z down. 5 m/s are half the load, a climb of 0.3 m/s and a turn of 0.25 rad/s
 * about the vertical axis a quarter more each (drives.c: 1.2 m/s and 1 rad/s are all of it); full power is 1, idle 0.6,
 * and the load is the share between. Velocities are in the axes of their algorithm; turns about other axes are no load,
 * nor those of an algorithm that does not turn. */
static void load_by_climb_and_turn(void **state)
{
    (void)state;
    static const struct {
        uint8_t algorithm;
        float   v_mps[3], w_rps[3];
        double  load;
    } c[] = {
        {2, {0.3f, 0, 4.99f}, {0}, 0.75},    {4, {-0.3f, 0, 4.99f}, {0}, 0.25},   {6, {4.99f, 0, -0.3f}, {0}, 0.75},
        {8, {4.99f, 0, 0.3f}, {0}, 0.25},    {4, {0, 0, 5}, {0, 0, 0.25f}, 0.75}, {4, {0, 0, 5}, {0, 0, -0.25f}, 0.75},
        {4, {0, 0, 5}, {0.25f, 0, 0}, 0.5},  {4, {0, 0, 5}, {0, 0.25f, 0}, 0.5},  {5, {0, 0, 5}, {0, 0, 0.25f}, 0.5},
        {3, {0, 0, 5}, {0, 0, 0.25f}, 0.75}, {7, {5, 0, 0}, {0, 0, 0.25f}, 0.75}, {9, {5, 0, 0}, {0, 0, 0.25f}, 0.5}};
    Fixture f = fixture_open(NULL);
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        DisEntityState pdu = report(1 + (int)i, tank_type);
        pdu.dead_reckoning = c[i].algorithm;
        memcpy(pdu.velocity_mps, c[i].v_mps, sizeof pdu.velocity_mps);
        memcpy(pdu.angular_rate_rps, c[i].w_rps, sizeof pdu.angular_rate_rps);
        hear(&f, &pdu, 0);
        CHECK_NEAR((double)seen_at(&f, 1 + (int)i, 1)->drives.engine, 0.6 + 0.4 * c[i].load, 1e-3);
    }
    fixture_close(&f);
}

static double wheel_turn_rad(Fixture *f, double from_s, double to_s)
{
    int          wheel = 0;
    NodePose     pose[2];
    double       r[9];
    const Model *model = catalog_model(f->catalog, seen_at(f, 1, from_s)->model);
    while (!(model->node[wheel].roll_radius_m > 0)) wheel++;
    pose[0] = node_of(f, seen_at(f, 1, from_s), wheel);
    pose[1] = node_of(f, seen_at(f, 1, to_s), wheel);
    m3_tmul(r, pose[0].r_body_from_node, pose[1].r_body_from_node);
    return acos(clamp(0.5 * (r[0] + r[4] + r[8] - 1), -1, 1)) * model->node[wheel].roll_radius_m;
}

/* Wheels of a sender whose algorithm is static roll by the way from report to report; of one that moves by the way that
 * it was shown to go, not by what its next report corrects. */
static void wheels_roll_by_what_was_shown(void **state)
{
    (void)state;
    for (int algorithm = 1; algorithm <= 2; algorithm++) {
        Fixture        f = fixture_open(NULL);
        DisEntityState pdu = report(1, truck_type);
        pdu.dead_reckoning = (uint8_t)algorithm;
        pdu.velocity_mps[2] = 0.1f;
        hear(&f, &pdu, 0);
        const double shown_m = wheel_turn_rad(&f, 0, 4.999999);
        CHECK_NEAR(shown_m, algorithm == 1 ? 0 : 0.5, 1e-5);
        const SnapshotEntity *e = seen_at(&f, 1, 4.999999);
        int                   wheel = 0;
        const Model          *model = catalog_model(f.catalog, e->model);
        while (!(model->node[wheel].roll_radius_m > 0)) wheel++;
        const NodePose before = node_of(&f, e, wheel);
        pdu.p_ecef[2] = 0.7;
        hear(&f, &pdu, 5);
        const NodePose after = node_of(&f, seen_at(&f, 1, 5), wheel);
        double         r[9];
        m3_tmul(r, before.r_body_from_node, after.r_body_from_node);
        CHECK_NEAR(acos(clamp(0.5 * (r[0] + r[4] + r[8] - 1), -1, 1)) * model->node[wheel].roll_radius_m,
                   algorithm == 1 ? 0.7 : 0, 1e-5);
        fixture_close(&f);
    }
}

/* An entity that becomes another type has nothing of the joints of the old one. */
static void another_type_has_its_own_joints(void **state)
{
    (void)state;
    static const uint8_t category[] = {1, 4}; /* a tank, then a self-propelled howitzer; and no change */
    for (int changes = 0; changes < 2; changes++) {
        Fixture        f = fixture_open(NULL);
        DisEntityState pdu = report(1, tank_type);
        pdu.variable_count = 1;
        pdu.variable[0] = articulated(4096 + 11, 1);
        hear(&f, &pdu, 0);
        pdu.type.category = category[changes];
        pdu.variable_count = 0;
        hear(&f, &pdu, 1);
        const SnapshotEntity *e = seen_at(&f, 1, 1);
        const Model          *model = catalog_model(f.catalog, e->model);
        int                   turret = 0;
        while (model->node[turret].dis_class != 4096) turret++;
        CHECK_NEAR(atan2(node_of(&f, e, turret).r_body_from_node[3], node_of(&f, e, turret).r_body_from_node[0]),
                   changes ? 0 : 1, 1e-6);
        fixture_close(&f);
    }
}

/* A place nearer than 100 km to the centre of the Earth, or farther than 100 000 km, comes from a report that is
 * invalid: the entity stays where it reported. With 10 km/s2 straight down from the surface it would be at the centre
 * after 35.716 s, and straight up from 50 000 km at 100 000 km after 100 s. */
static void nobody_leaves_the_earth(void **state)
{
    (void)state;
    static const struct {
        double from_m, a_mps2, t_s, want_m;
    } c[] = {{6378137, -1e4, 35.3, 6378137 - 0.5e4 * 35.3 * 35.3},
             {6378137, -1e4, 35.716, 6378137},
             {5e7, 1e4, 99.9, 5e7 + 0.5e4 * 99.9 * 99.9},
             {5e7, 1e4, 100.1, 5e7}};
    Fixture f = fixture_open(NULL);
    for (int i = 0; i < 4; i++) {
        DisEntityState pdu = report(1 + i, tank_type);
        pdu.header.version = 7;
        pdu.p_ecef[0] = c[i].from_m;
        pdu.acceleration_mps2[0] = (float)c[i].a_mps2;
        hear(&f, &pdu, 0);
        const SnapshotEntity *e = seen_at(&f, 1 + i, c[i].t_s);
        CHECK_NEAR(e->p_ecef[0], c[i].want_m, 1e-6);
        CHECK((v3_length(e->v_ecef_mps) == 0) == (c[i].want_m == c[i].from_m));
    }
    fixture_close(&f);
}

/* A report is extrapolated by its 12 s to both sides. */
static void reports_reach_both_ways(void **state)
{
    (void)state;
    static const double t_s[] = {80, 88, 97, 100, 103, 112}, want_m[] = {-120, -120, -30, 0, 30, 120};
    Fixture             f = fixture_open(NULL);
    DisEntityState      pdu = report(1, tank_type);
    pdu.velocity_mps[1] = 10;
    hear(&f, &pdu, 100);
    for (int i = 0; i < 6; i++) CHECK_NEAR(seen_at(&f, 1, t_s[i])->p_ecef[1], want_m[i], 1e-12);
    fixture_close(&f);
}

/* The clock of a sender is found to be 1 s off between two reports that its stamps say are 7.03125 s apart: the pose
 * goes on from where it was shown, 1 s ahead (or behind), and comes round by half a second per second to 0.25 s,
 * after 1.5 s; by a factor e every half second to 0.01 s, after 0.5 ln 25 s more; and by 20 ms a second, after half a
 * second more. Beyond 5 s the sender has begun anew and below 0.1 ms nothing is known: the pose is that of the report
 * at once. */
static void a_clock_that_is_set_moves_nothing_at_once(void **state)
{
    (void)state;
    const double apart_s = 3600.0 / 512, round_s = 1.5 + 0.5 * log(25);
    const double after_s[] = {0, 1, 1.5, 2, round_s, round_s + 0.25, round_s + 0.5, 9};
    const double left[] = {1, 0.5, 0.25, 0.25 * exp(-1), 0.01, 0.005, 0, 0}; /* of a second */
    const double moved_s[] = {1, -1, 4.9, -4.9, 5.1, -5.1, 1.1e-4, 0.9e-4};
    Fixture      f = fixture_open(NULL);
    for (int k = 0; k < 8; k++) {
        DisEntityState pdu = report(1 + k, tank_type);
        const double   t_s = 1000 + apart_s + moved_s[k];
        pdu.dead_reckoning = 2;
        pdu.velocity_mps[1] = 10;
        pdu.header.timestamp = UINT32_C(1) << 31;
        entity_table_arrival(f.table, 1000, true);
        hear(&f, &pdu, 1000);
        pdu.p_ecef[1] = 10 * apart_s;
        pdu.header.timestamp += UINT32_C(1) << 23; /* 2^22 of 2^31 steps of an hour */
        entity_table_arrival(f.table, t_s, true);
        hear(&f, &pdu, t_s);
        const bool taken = k < 4 || k == 6;
        CHECK_NEAR(seen_at(&f, 1 + k, t_s)->p_ecef[1], 10 * (apart_s + (taken ? moved_s[k] : 0)), 1e-6);
        for (int i = 0; k < 2 && i < 8; i++)
            CHECK_NEAR(seen_at(&f, 1 + k, t_s + after_s[i])->p_ecef[1],
                       10 * (apart_s + after_s[i] + moved_s[k] * left[i]), 1e-6);
    }
    fixture_close(&f);
}

/* Rounds of one Fire PDU: as many as it says, one where it says none, 1000 at most; 8 kg of propellant of a gun each
 * (effect_history.c). A guided munition that the PDU names begins to burn for two seconds. */
static void shots_are_counted(void **state)
{
    (void)state;
    static const uint16_t said[] = {0, 1, 7, 999, 1000, 1001, 65535}, counts[] = {1, 1, 7, 999, 1000, 1000, 1000};
    Fixture               f = fixture_open(NULL);
    for (int i = 0; i < 7; i++) {
        const int      tank_number = 10 + i, missile_number = 20 + i;
        DisEntityState tank = report(tank_number, tank_type), missile = report(missile_number, missile_type);
        hear(&f, &tank, 0), hear(&f, &missile, 0);
        CHECK(seen_at(&f, missile_number, 4.9)->drives.motor == 0);
        const DisFire fire = {.firing = entity_id(tank_number),
                              .munition = entity_id(missile_number),
                              .p_ecef = {earth_radius_m, 0, 0},
                              .descriptor = {{2, 2, 225, 2, 1, 1, 0}, 1000, 1000, said[i], 0}};
        entity_table_fire(f.table, &fire, 5);
        CHECK_NEAR(seen_at(&f, tank_number, 5)->drives.fired_kg[1], 8.0 * counts[i], 1e-9);
        CHECK(seen_at(&f, missile_number, 5)->drives.motor == 1 &&
              seen_at(&f, missile_number, 6.99)->drives.motor == 1);
        CHECK(seen_at(&f, missile_number, 7.01)->drives.motor == 0);
    }
    fixture_close(&f);
}

/* Which of five entities a Stop/Freeze and a Remove Entity name: 0xFFFF is any, entity 0 is a whole application for a
 * Stop and none for a Remove, and 0:0:0 is no entity. Bits: entities 1:1:1, 1:1:2, 1:2:1, 2:1:1, 0:0:3. */
static void names_of_many(void **state)
{
    (void)state;
    static const DisEntityId id[5] = {{1, 1, 1}, {1, 1, 2}, {1, 2, 1}, {2, 1, 1}, {0, 0, 3}};
    static const struct {
        DisEntityId asked;
        int         stops, removes;
    } c[] = {{{1, 1, 1}, 1, 1},      {{1, 1, 2}, 2, 2},           {{2, 1, 1}, 8, 8},
             {{1, 1, 0xFFFF}, 3, 3}, {{1, 0xFFFF, 1}, 5, 5},      {{0xFFFF, 1, 1}, 9, 9},
             {{1, 1, 0}, 3, 0},      {{1, 0xFFFF, 0xFFFF}, 7, 7}, {{0xFFFF, 2, 0xFFFF}, 4, 4},
             {{0, 0, 0}, 0, 0},      {{2, 2, 0xFFFF}, 0, 0},      {{0xFFFF, 0xFFFF, 0xFFFF}, 31, 31}};
    Fixture f = fixture_open(NULL);
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        const double from_s = 100.0 * (double)i; /* all of the case before are gone */
        int          stopped = 0, removed = 0;
        for (int k = 0; k < 5; k++) {
            DisEntityState pdu = report(1, tank_type);
            pdu.id = id[k];
            pdu.velocity_mps[1] = 1;
            hear(&f, &pdu, from_s);
        }
        entity_table_stop(f.table, &(DisStopFreeze){.receiving = c[i].asked}, from_s + 1);
        CHECK(!seen_at(&f, 1, from_s + 3));
        for (int k = 0; k < 5; k++) {
            const int at = snapshot_find(&f.snapshot, id[k]);
            CHECK(at >= 0);
            stopped |= (v3_length(f.snapshot.entity[at].v_ecef_mps) == 0) << k;
        }
        entity_table_remove(f.table, &(DisRemoveEntity){.receiving = c[i].asked}, from_s + 4);
        for (int k = 0; k < 5; k++) removed |= !entity_table_alive(f.table, entity_table_find(f.table, id[k])) << k;
        assert_int_equal(stopped, c[i].stops);
        assert_int_equal(removed, c[i].removes);
        entity_table_remove(f.table, &(DisRemoveEntity){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, from_s + 5);
    }
    fixture_close(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(timeouts_are_those_of_the_kind),
        cmocka_unit_test(the_most_that_moves),
        cmocka_unit_test(what_comes_after_the_end),
        cmocka_unit_test(a_miss_is_expected_again),
        cmocka_unit_test(places_may_be_off),
        cmocka_unit_test(load_by_climb_and_turn),
        cmocka_unit_test(wheels_roll_by_what_was_shown),
        cmocka_unit_test(another_type_has_its_own_joints),
        cmocka_unit_test(nobody_leaves_the_earth),
        cmocka_unit_test(reports_reach_both_ways),
        cmocka_unit_test(a_clock_that_is_set_moves_nothing_at_once),
        cmocka_unit_test(shots_are_counted),
        cmocka_unit_test(names_of_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
