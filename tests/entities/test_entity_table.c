/* tests/entities/test_entity_table.c: who is there, since when, until when, and where. */
#include "tests/entities/entity_fixture.h"
#include "dis/pdu/decode.h"
#include "dis/capture/log.h"
#include "entities/table/entity_index.h"

static const EntityCounters *counted(const Fixture *f) { return entity_table_counters(f->table); }

/* ---- the index against a plain list ------------------------------------------------------- */

static void index_agrees_with_a_list(void **state)
{
    (void)state;
    enum { keys = 300 };
    EntityIndex index;
    int         there[keys];
    CHECK(entity_index_create(&index, 100) == STATUS_OK);
    for (int k = 0; k < keys; k++) there[k] = -1;
    int held = 0;
    for (int n = 0; n < 60000; n++) {
        const int      k = (int)(random_uniform(3, 1, 0, (uint64_t)n) * keys);
        const uint64_t key = k % 3 ? (uint64_t)k : (uint64_t)k << 32 | 0xFFFF;
        CHECK(entity_index_find(&index, key) == there[k]);
        if (there[k] >= 0) {
            entity_index_remove(&index, key);
            there[k] = -1;
            held--;
        } else if (held < 100) {
            entity_index_insert(&index, key, n);
            there[k] = n;
            held++;
        }
        if (n == 30000) CHECK(entity_index_grow(&index) == STATUS_OK);
    }
    entity_index_destroy(&index);
}

/* ---- lives -------------------------------------------------------------------------------- */

static void handles_are_caught_when_stale(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(7, tank_type);
    CHECK(!entity_table_alive(f.table, (EntityHandle){0}));
    CHECK(!entity_table_alive(f.table, entity_table_find(f.table, entity_id(7))));
    hear(&f, &pdu, 0);
    const EntityHandle first = entity_table_find(f.table, entity_id(7));
    CHECK(entity_table_alive(f.table, first) && entity_table_count(f.table) == 1);
    pdu.appearance = deactivated_bit;
    hear(&f, &pdu, 1);
    CHECK(!entity_table_alive(f.table, first) && entity_table_count(f.table) == 0);
    pdu.appearance = 0;
    hear(&f, &pdu, 2);
    const EntityHandle second = entity_table_find(f.table, entity_id(7));
    CHECK(second.slot == first.slot && entity_table_alive(f.table, second) && !entity_table_alive(f.table, first));
    CHECK(!entity_table_alive(f.table, (EntityHandle){1 << 30, 1}));
    CHECK(counted(&f)->created == 2 && counted(&f)->deactivated == 1);
    fixture_close(&f);
}

static void silence_ends_it(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState tank5 = report(5, tank_type), tank7 = report(7, tank_type), flyer7 = report(8, helicopter_type);
    tank7.header.version = flyer7.header.version = 7;
    tank7.velocity_mps[0] = flyer7.velocity_mps[0] = 3;
    DisEntityState parked7 = report(9, helicopter_type);
    parked7.header.version = 7;
    hear(&f, &tank5, 0);
    hear(&f, &tank7, 0);
    hear(&f, &flyer7, 0);
    hear(&f, &parked7, 0);

    /* whether or not somebody calls expire */
    CHECK(seen_at(&f, 5, 12) && seen_at(&f, 8, 12));
    CHECK(!seen_at(&f, 5, 12.001) && !seen_at(&f, 8, 12.001) && seen_at(&f, 7, 12.001) && seen_at(&f, 9, 12.001));
    entity_table_expire(f.table, 12);
    CHECK(entity_table_count(f.table) == 4);
    entity_table_expire(f.table, 12.001);
    CHECK(entity_table_count(f.table) == 2 && counted(&f)->timed_out == 2);
    CHECK(seen_at(&f, 7, 132) && !seen_at(&f, 7, 132.001));

    /* a report after the silence is another life, expire or not */
    const EntityHandle before = entity_table_find(f.table, entity_id(7));
    hear(&f, &tank7, 200);
    CHECK(!entity_table_alive(f.table, before) &&
          entity_table_alive(f.table, entity_table_find(f.table, entity_id(7))));
    CHECK(counted(&f)->timed_out == 3 && counted(&f)->created == 5);
    fixture_close(&f);
}

static void removal_with_wildcards(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(0, tank_type);
    for (int site = 1; site <= 2; site++)
        for (int application = 1; application <= 2; application++)
            for (int entity = 1; entity <= 3; entity++) {
                pdu.id = (DisEntityId){(uint16_t)site, (uint16_t)application, (uint16_t)entity};
                hear(&f, &pdu, 0);
            }
    DisRemoveEntity remove = {.receiving = {1, 1, 2}};
    entity_table_remove(f.table, &remove, 1);
    CHECK(entity_table_count(f.table) == 11);
    remove.receiving = (DisEntityId){1, 1, 0}; /* none */
    entity_table_remove(f.table, &remove, 1);
    remove.receiving = (DisEntityId){9, 0xFFFF, 0xFFFF};
    entity_table_remove(f.table, &remove, 1);
    CHECK(entity_table_count(f.table) == 11);
    remove.receiving = (DisEntityId){2, 0xFFFF, 3};
    entity_table_remove(f.table, &remove, 1);
    CHECK(entity_table_count(f.table) == 9);
    remove.receiving = (DisEntityId){1, 0xFFFF, 0xFFFF};
    entity_table_remove(f.table, &remove, 1);
    CHECK(entity_table_count(f.table) == 4);
    remove.receiving = (DisEntityId){0xFFFF, 0xFFFF, 0xFFFF};
    entity_table_remove(f.table, &remove, 1);
    CHECK(entity_table_count(f.table) == 0 && counted(&f)->removed == 12);
    fixture_close(&f);
}

static void a_full_table_refuses_and_recovers(void **state)
{
    (void)state;
    EntityTableConfig config = entity_table_default_config();
    config.capacity = 3;
    Fixture f = fixture_open(&config);
    for (int e = 1; e <= 3; e++) {
        const DisEntityState pdu = report(e, tank_type);
        hear(&f, &pdu, 0);
    }
    /* who goes: test_entity_eviction.c. Here the newcomer, being the farthest */
    DisEntityState fourth = report(4, tank_type);
    entity_table_focus(f.table, entity_id(1), entity_id(0));
    fourth.p_ecef[0] += 1e6;
    CHECK(entity_table_entity_state(f.table, &fourth, 1) == STATUS_UNSUPPORTED && entity_table_count(f.table) == 3);
    static DisPdu decoded = {.type = dis_pdu_entity_state};
    decoded.entity_state = fourth;
    entity_table_pdu(f.table, &decoded, 1, &f.counters);
    CHECK(f.counters.dropped[DIS_DROP_TABLE_FULL] == 1);
    DisEntityState gone = report(2, tank_type);
    gone.appearance = deactivated_bit;
    hear(&f, &gone, 2);
    hear(&f, &fourth, 3);
    CHECK(seen_at(&f, 4, 3) && !seen_at(&f, 2, 3));
    config.capacity = 0;
    EntityTable *none = NULL;
    log_set_level(LOG_ERROR + 1);
    CHECK(entity_table_create(&none, &config, f.catalog) == STATUS_BAD_VALUE && !none);
    log_set_level(LOG_INFO);
    fixture_close(&f);
}

/* Reports out of order lose to the newer one; the last of a dead entity's does not bring it back. */
static void late_reports_do_not_count(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, missile_type);
    pdu.marking[0] = 'a';
    hear(&f, &pdu, 5);
    pdu.marking[0] = 'b';
    hear(&f, &pdu, 4);
    CHECK(seen_at(&f, 1, 5)->marking[0] == 'a' && counted(&f)->late == 1);
    hear(&f, &pdu, 5); /* at the same time: the newer arrival */
    CHECK(seen_at(&f, 1, 5)->marking[0] == 'b');

    const DisDetonation burst = {.munition = entity_id(1), .result = dis_result_ground_impact};
    entity_table_detonation(f.table, &burst, 6);
    CHECK(entity_table_count(f.table) == 0 && counted(&f)->detonated == 1);
    hear(&f, &pdu, 5.5);
    CHECK(entity_table_count(f.table) == 0 && counted(&f)->late == 2);
    hear(&f, &pdu, 6.003);
    pdu.appearance = 0x8038; /* what VR-Forces says of a burst missile */
    hear(&f, &pdu, 9);
    CHECK(entity_table_count(f.table) == 0 && counted(&f)->late == 4);
    pdu.appearance = 0;
    hear(&f, &pdu, 7.5); /* the id again, honestly */
    CHECK(entity_table_count(f.table) == 1);
    entity_table_detonation(f.table, &burst, 6.5); /* of the one before */
    CHECK(entity_table_count(f.table) == 1);

    /* a truck named as the exploding entity stays */
    DisEntityState truck = report(2, truck_type);
    hear(&f, &truck, 8);
    entity_table_detonation(f.table, &(DisDetonation){.munition = entity_id(2)}, 9);
    CHECK(entity_table_count(f.table) == 2);
    fixture_close(&f);
}

/* ---- motion ------------------------------------------------------------------------------- */

/* World axes: y is east here. 10 m/s for 4 s, and an update moves it without touching what it does not carry. */
static void reports_and_updates_move_it(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, tank_type);
    pdu.velocity_mps[1] = 10;
    pdu.acceleration_mps2[1] = 2;
    pdu.angular_rate_rps[2] = 0.1f;
    hear(&f, &pdu, 100);
    const SnapshotEntity *e = seen_at(&f, 1, 104);
    CHECK_NEAR(e->p_ecef[0], earth_radius_m, 1e-9);
    CHECK_NEAR(e->p_ecef[1], 10 * 4 + 0.5 * 2 * 16, 1e-12);
    CHECK_NEAR(e->v_ecef_mps[1], 18, 1e-12);
    CHECK(e->w_body_rps[2] == (double)0.1f && e->age_s == 4);
    CHECK_NEAR(e->position_error_m, 0.8, 1e-12); /* 4 of 5 s */
    /* a yaw of 0.4 to the right of north is towards east */
    CHECK_NEAR(e->r_ecef_from_body[3], sin(4 * (double)0.1f), 1e-7);

    DisEntityStateUpdate update = {.header = {.version = 5},
                                   .id = entity_id(1),
                                   .p_ecef = {earth_radius_m, 1000, 0},
                                   .velocity_mps = {0, -1, 0},
                                   .theta_rad = pdu.theta_rad};
    CHECK(entity_table_entity_state_update(f.table, &update, 105) == STATUS_OK);
    e = seen_at(&f, 1, 106);
    CHECK_NEAR(e->p_ecef[1], 1000 - 1 + 0.5 * 2, 1e-12); /* the acceleration of the last Entity State */
    CHECK(e->age_s == 1 && e->w_body_rps[2] == (double)0.1f);
    update.id = entity_id(99);
    CHECK(entity_table_entity_state_update(f.table, &update, 106) == STATUS_OK);
    CHECK(counted(&f)->updates_without_entity == 1);
    fixture_close(&f);
}

static void extrapolation_is_bounded(void **state)
{
    (void)state;
    EntityTableConfig config = entity_table_default_config();
    config.timeout_s = 1000;
    config.timeout_land_v7_s = 11000;
    Fixture        f = fixture_open(&config);
    DisEntityState pdu = report(1, tank_type);
    pdu.velocity_mps[1] = 10;
    hear(&f, &pdu, 0);
    CHECK_NEAR(seen_at(&f, 1, 500)->p_ecef[1], 120, 1e-12);
    CHECK(seen_at(&f, 1, 500)->position_error_m > 4880);
    pdu.header.version = 7; /* eleven times the patience, eleven times the extrapolation */
    hear(&f, &pdu, 1000);
    CHECK_NEAR(seen_at(&f, 1, 2000)->p_ecef[1], 1320, 1e-9);

    /* 55 rad/s was reported once by a real tank */
    pdu.angular_rate_rps[2] = 55;
    hear(&f, &pdu, 3000);
    const SnapshotEntity *e = seen_at(&f, 1, 3001);
    CHECK(e->w_body_rps[2] == 0 && counted(&f)->motion_refused == 1);
    CHECK_NEAR(e->r_ecef_from_body[3], 0, 1e-7);
    fixture_close(&f);
}

/* Finite and absurd, or not finite: the field counts as zero, the entity stays where it said it was. */
static void absurd_motion_is_not_believed(void **state)
{
    (void)state;
    Fixture            f = fixture_open(NULL);
    static const float absurd[] = {NAN, INFINITY, 3e38f};
    uint64_t           refused = 0;
    for (int field = 0; field < 3; field++)
        for (int n = 0; n < 3; n++) {
            DisEntityState pdu = report(1, tank_type);
            float *const   at[3] = {pdu.velocity_mps, pdu.acceleration_mps2, pdu.angular_rate_rps};
            at[field][1] = absurd[n];
            hear(&f, &pdu, 0);
            const SnapshotEntity *e = seen_at(&f, 1, 3);
            CHECK(e->p_ecef[0] == earth_radius_m && e->p_ecef[1] == 0 && v3_length(e->v_ecef_mps) == 0);
            CHECK(counted(&f)->motion_refused == ++refused);
        }
    fixture_close(&f);
}

static void frozen_stands_still(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, tank_type);
    pdu.velocity_mps[1] = 10;
    pdu.angular_rate_rps[2] = 1;
    pdu.appearance = frozen_bit;
    pdu.variable_count = 2;
    pdu.variable[0] = articulated(4107, 0.5f);
    pdu.variable[1] = articulated(4108, 1);
    hear(&f, &pdu, 0);
    const SnapshotEntity *e = seen_at(&f, 1, 5);
    CHECK(e->p_ecef[1] == 0 && v3_length(e->v_ecef_mps) == 0 && v3_length(e->w_body_rps) == 0 &&
          e->position_error_m == 0);
    const NodePose turret = node_of(&f, e, 1);
    e = seen_at(&f, 1, 9);
    const NodePose later = node_of(&f, e, 1);
    CHECK(memcmp(&turret, &later, sizeof turret) == 0);
    pdu.appearance = 0;
    hear(&f, &pdu, 10);
    CHECK_NEAR(seen_at(&f, 1, 11)->p_ecef[1], 10, 1e-12);
    fixture_close(&f);
}

/* A munition's sender means the centre of its volume; the model's origin is half its height below. */
static void origin_is_the_base(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState missile = report(1, missile_type), tank = report(2, tank_type);
    hear(&f, &missile, 0);
    hear(&f, &tank, 0);
    const SnapshotEntity *e = seen_at(&f, 1, 0);
    const double          height_m = catalog_model(f.catalog, e->model)->height_m;
    CHECK(height_m > 0.05);
    CHECK_NEAR(e->p_ecef[0], earth_radius_m - height_m / 2, 1e-8);
    CHECK(seen_at(&f, 2, 0)->p_ecef[0] == earth_radius_m);
    fixture_close(&f);
}

/* ---- snapshots ---------------------------------------------------------------------------- */

/* 700 entities of every algorithm, in an order that is none: sorted, each where dead_reckon alone puts it, to the
 * bit, and the same twice. pool: who helps; *poses: the caller's to free. */
static size_t check_sorted_and_exact(NodePose **poses, Pool *pool)
{
    enum { many = 700 };
    static Kinematics want[many];
    EntityTableConfig config = entity_table_default_config();
    config.pool = pool;
    Fixture f = fixture_open(&config);
    for (int n = 0; n < many; n++) {
        const int      i = (n * 271) % many; /* 271 and 700 share no factor */
        DisEntityState pdu = report(0, (DisEntityType){9, 0, 0, 0, 0, 0, 0});
        pdu.id = (DisEntityId){(uint16_t)(1 + i % 3), (uint16_t)(1 + i / 3 % 5 * 300), (uint16_t)(1 + i)};
        pdu.dead_reckoning = (uint8_t)(i % 11);
        for (int a = 0; a < 3; a++) {
            pdu.velocity_mps[a] = (float)random_normal(1, 1, 0, (uint64_t)(9 * i + a)) * 10;
            pdu.acceleration_mps2[a] = (float)random_normal(1, 1, 0, (uint64_t)(9 * i + 3 + a));
            pdu.angular_rate_rps[a] = (float)random_normal(1, 1, 0, (uint64_t)(9 * i + 6 + a)) * 0.3f;
        }
        hear(&f, &pdu, 0.001 * i);
        Kinematics *k = want + i;
        k->algorithm = pdu.dead_reckoning;
        for (int a = 0; a < 3; a++) {
            k->p_ecef[a] = pdu.p_ecef[a], k->v_mps[a] = pdu.velocity_mps[a];
            k->a_mps2[a] = pdu.acceleration_mps2[a], k->w_body_rps[a] = pdu.angular_rate_rps[a];
        }
        r_ecef_from_body_euler(k->r_ecef_from_body, pdu.psi_rad, pdu.theta_rad, pdu.phi_rad);
    }
    arena_reset(f.arena);
    CHECK(entity_table_snapshot(&f.snapshot, f.table, 3, f.arena) == STATUS_OK);
    CHECK(f.snapshot.count == many);
    int nodes = 0;
    for (int e = 0; e < many; e++) {
        const SnapshotEntity *entity = f.snapshot.entity + e;
        const int             i = entity->id.entity - 1;
        Motion                m;
        if (e > 0) CHECK(dis_entity_id_compare(entity[-1].id, entity->id) < 0);
        CHECK(snapshot_find(&f.snapshot, entity->id) == e);
        dead_reckon(&m, want + i, 3 - 0.001 * i);
        CHECK(memcmp(m.p_ecef, entity->p_ecef, sizeof m.p_ecef) == 0);
        CHECK(memcmp(m.v_ecef_mps, entity->v_ecef_mps, sizeof m.v_ecef_mps) == 0);
        CHECK(memcmp(m.r_ecef_from_body, entity->r_ecef_from_body, sizeof m.r_ecef_from_body) == 0);
        CHECK(entity->first_node == nodes);
        nodes += catalog_model(f.catalog, entity->model)->node_count;
    }
    CHECK(nodes == f.snapshot.node_count);
    Arena   *other_arena = arena_create();
    Snapshot again;
    CHECK(entity_table_snapshot(&again, f.table, 3, other_arena) == STATUS_OK);
    CHECK(memcmp(again.entity, f.snapshot.entity, sizeof *again.entity * many) == 0);
    CHECK(entity_table_snapshot(&again, f.table, NAN, other_arena) == STATUS_BAD_VALUE && again.count == many);
    *poses = malloc((size_t)nodes * sizeof **poses);
    CHECK(*poses);
    for (int e = 0; e < many; e++) {
        const SnapshotEntity *one = again.entity + e;
        const Model          *model = catalog_model(f.catalog, one->model);
        NodePose             *pose = *poses + one->first_node;
        double                joint_value[64];
        snapshot_pose(pose, joint_value, &again, e, model);
        for (int n = 0; e % 16 == 0 && n < model->node_count; n++) {
            const NodePose same = node_of(&f, f.snapshot.entity + e, n);
            CHECK(memcmp(&same, pose + n, sizeof same) == 0);
        }
    }
    arena_destroy(other_arena);
    fixture_close(&f);
    return (size_t)nodes;
}

static void snapshot_is_sorted_and_exact(void **state)
{
    (void)state;
    NodePose *alone, *helped;
    Pool     *pool;
    CHECK(pool_create(&pool, 3) == STATUS_OK);
    const size_t nodes = check_sorted_and_exact(&alone, NULL);
    CHECK(check_sorted_and_exact(&helped, pool) == nodes);
    CHECK(memcmp(alone, helped, nodes * sizeof *alone) == 0);
    free(alone);
    free(helped);
    pool_destroy(pool);
}

static void an_empty_table_gives_an_empty_snapshot(void **state)
{
    (void)state;
    Fixture f = fixture_open(NULL);
    CHECK(!seen_at(&f, 1, 0) && f.snapshot.count == 0 && f.snapshot.node_count == 0);
    CHECK(snapshot_find(&f.snapshot, entity_id(1)) == -1);
    fixture_close(&f);
}

static int node_with(const Model *model, bool rolls)
{
    for (int n = 0; n < model->node_count; n++)
        if (rolls ? model->node[n].roll_radius_m > 0 : model->node[n].spin_rps_moving != 0) return n;
    return -1;
}

/* Angle of the turn from one pose to another. */
static double turned_rad(const NodePose *a, const NodePose *b)
{
    double r[9];
    m3_tmul(r, a->r_body_from_node, b->r_body_from_node);
    const double s[3] = {r[7] - r[5], r[2] - r[6], r[3] - r[1]};
    return atan2(v3_length(s), r[0] + r[4] + r[8] - 1);
}

static NodePose node_at(Fixture *f, int entity, bool rolls, double t_s)
{
    const SnapshotEntity *e = seen_at(f, entity, t_s);
    CHECK(e != NULL);
    return node_of(f, e, node_with(catalog_model(f->catalog, e->model), rolls));
}

/* Wheels turn by way over radius, backwards too, and a report that corrects the place by a metre jerks nothing. */
static void wheels_roll_with_the_way(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, truck_type);
    pdu.velocity_mps[2] = 4; /* forward: north */
    hear(&f, &pdu, 0);
    const SnapshotEntity *e = seen_at(&f, 1, 0);
    const Model          *truck = catalog_model(f.catalog, e->model);
    const double          radius_m = truck->node[node_with(truck, true)].roll_radius_m;
    const NodePose        start = node_at(&f, 1, true, 0), soon = node_at(&f, 1, true, 0.1);
    CHECK_NEAR(turned_rad(&start, &soon), 0.4 / radius_m, 1e-6);

    const NodePose before = node_at(&f, 1, true, 5);
    pdu.p_ecef[2] = 21; /* the truth is a metre ahead */
    pdu.velocity_mps[2] = -4;
    hear(&f, &pdu, 5);
    const NodePose after = node_at(&f, 1, true, 5), back = node_at(&f, 1, true, 10);
    CHECK_NEAR(turned_rad(&before, &after), 0, 1e-7);
    CHECK_NEAR(turned_rad(&start, &back), 0, 1e-6); /* 20 m there, 20 m back */
    fixture_close(&f);
}

/* Rotors turn at their own rate from report to report, and stand while frozen. */
static void rotors_spin_and_freeze(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, helicopter_type);
    hear(&f, &pdu, 0);
    const SnapshotEntity *e = seen_at(&f, 1, 0);
    const Model          *model = catalog_model(f.catalog, e->model);
    const double          rate_rps = model->node[node_with(model, false)].spin_rps_moving;
    const NodePose        start = node_at(&f, 1, false, 0), soon = node_at(&f, 1, false, 0.01);
    CHECK_NEAR(turned_rad(&start, &soon), fabs(rate_rps) * 0.01, 1e-9);

    const NodePose before = node_at(&f, 1, false, 3);
    pdu.appearance = frozen_bit;
    hear(&f, &pdu, 3);
    const NodePose frozen = node_at(&f, 1, false, 7);
    CHECK_NEAR(turned_rad(&before, &frozen), 0, 1e-9);
    pdu.appearance = 0;
    hear(&f, &pdu, 8);
    const NodePose again = node_at(&f, 1, false, 8.01);
    CHECK_NEAR(turned_rad(&frozen, &again), fabs(rate_rps) * 0.01, 1e-9);
    fixture_close(&f);
}

/* An aircraft that says nothing of its landing gear has it down on the apron and up at speed. */
static void landing_gear_needs_no_report(void **state)
{
    (void)state;
    Fixture f = fixture_open(NULL);
    for (int fast = 0; fast < 2; fast++) {
        DisEntityState pdu = report(1, (DisEntityType){1, 2, 225, 1, 1, 0, 0});
        pdu.velocity_mps[2] = fast ? 200 : 0;
        hear(&f, &pdu, fast);
        const SnapshotEntity *e = seen_at(&f, 1, fast);
        const Model          *model = catalog_model(f.catalog, e->model);
        assert_string_equal(model->name, "aircraft");
        int wheels = 0;
        for (int n = 0; n < model->node_count; n++) {
            if (!(model->node[n].roll_radius_m > 0)) continue;
            const double hub_m = -node_of(&f, e, n).p_body[2];
            CHECK(fast ? hub_m > 1.2 : fabs(hub_m - model->node[n].roll_radius_m) < 1e-9);
            wheels++;
        }
        assert_int_equal(wheels, 3);
    }
    fixture_close(&f);
}

static void articulation_and_drives_reach_the_snapshot(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = report(1, tank_type);
    pdu.velocity_mps[2] = 12;
    pdu.variable_count = 3;
    pdu.variable[0] = articulated(4108, 0.1f);
    pdu.variable[1] = articulated(4107, 0.2f);
    pdu.variable[2] = articulated(131083, 1);
    hear(&f, &pdu, 0);
    const SnapshotEntity *e = seen_at(&f, 1, 2);
    CHECK(counted(&f)->unknown_articulation == 1);
    CHECK(e->drives.engine == 1 && e->drives.speed_mps == 12 && e->drives.fired_kg[1] == 0 && e->drives.since_s == 0);
    CHECK(e->first_patch == -1 && f.snapshot.patch_k == NULL); /* render/heat/vehicle_heat.h gives them */
    const uint64_t changes = entity_table_changes(f.table);
    const Model   *tank = catalog_model(f.catalog, e->model);
    for (int n = 0; n < tank->node_count; n++)
        if (tank->node[n].dis_class == 4096)
            CHECK_NEAR(atan2(node_of(&f, e, n).r_body_from_node[3], node_of(&f, e, n).r_body_from_node[0]), 0.4, 1e-7);
    entity_table_fire(f.table, &(DisFire){.firing = entity_id(1), .munition = entity_id(50)}, 3);
    CHECK(seen_at(&f, 1, 5)->drives.fired_kg[1] == 1 && entity_table_changes(f.table) == changes + 1);
    /* another type under the same id: another model, its joints at rest */
    pdu.type = truck_type;
    pdu.variable_count = 0;
    hear(&f, &pdu, 6);
    CHECK(strcmp(catalog_model(f.catalog, seen_at(&f, 1, 6)->model)->name, "truck") == 0);
    fixture_close(&f);
}

/* A radio, a cloud and chaff are heard and counted, but a scene does not have them; under another type the same id
 * comes back. */
static void what_has_no_shape_is_not_in_the_scene(void **state)
{
    (void)state;
    static const DisEntityType unseen[3] = {{7, 1, 225, 1, 1, 0, 0}, {4, 1, 0, 1, 0, 0, 0}, {8, 2, 225, 1, 1, 0, 0}};
    Fixture                    f = fixture_open(NULL);
    for (int i = 0; i < 3; i++) {
        const DisEntityState pdu = report(10 + i, unseen[i]);
        hear(&f, &pdu, 1);
    }
    DisEntityState tank = report(1, tank_type);
    hear(&f, &tank, 1);
    CHECK(seen_at(&f, 1, 1.5) && f.snapshot.count == 1);
    for (int i = 0; i < 3; i++) CHECK(!seen_at(&f, 10 + i, 1.5));
    CHECK(entity_table_count(f.table) == 4);
    DisEntityState changed = report(10, tank_type);
    hear(&f, &changed, 2);
    CHECK(seen_at(&f, 10, 2.5) && f.snapshot.count == 2);
    fixture_close(&f);
}

/* Clouds of chaff are beside the scene: of chaff alone, and of a cartridge that is a flare too. */
static void chaff_is_beside_the_scene(void **state)
{
    (void)state;
    static const DisEntityType chaff = {8, 2, 225, 1, 1, 0, 0}, both = {8, 2, 225, 3, 1, 0, 0},
                               flare = {8, 2, 225, 2, 1, 0, 0};
    Fixture        f = fixture_open(NULL);
    DisEntityState cloud = report(12, chaff);
    hear(&f, &cloud, 1);
    cloud = report(11, both);
    hear(&f, &cloud, 1.5);
    cloud = report(10, flare);
    hear(&f, &cloud, 1.5);
    CHECK(seen_at(&f, 11, 3) && seen_at(&f, 10, 3) && !seen_at(&f, 12, 3));
    CHECK(f.snapshot.count == 2 && f.snapshot.chaff_count == 2);
    CHECK(f.snapshot.chaff[0].id.entity == 11 && f.snapshot.chaff[1].id.entity == 12);
    CHECK_NEAR(f.snapshot.chaff[0].age_s, 1.5, 1e-12);
    CHECK_NEAR(f.snapshot.chaff[1].age_s, 2, 1e-12);
    for (int k = 0; k < 3; k++) CHECK_NEAR(f.snapshot.chaff[0].p_ecef[k], cloud.p_ecef[k], 1e-6);
    fixture_close(&f);
}

/* ---- any PDU ------------------------------------------------------------------------------ */

static void pdus_are_checked_and_counted(void **state)
{
    (void)state;
    Fixture         f = fixture_open(NULL);
    static DisPdu   pdu;
    DisEntityState *report_1 = &pdu.entity_state;
    pdu.type = dis_pdu_entity_state;
    *report_1 = report(1, tank_type);

    entity_table_pdu(f.table, &pdu, NAN, &f.counters); /* no instant: as if it had not come */
    CHECK(entity_table_count(f.table) == 0);
    entity_table_pdu(f.table, &pdu, 0, &f.counters);
    CHECK(entity_table_count(f.table) == 1);
    report_1->p_ecef[0] = NAN;
    entity_table_pdu(f.table, &pdu, 1, &f.counters);
    CHECK(f.counters.dropped[DIS_DROP_NOT_FINITE] == 1);
    report_1->p_ecef[0] = 1;
    entity_table_pdu(f.table, &pdu, 1, &f.counters);
    CHECK(f.counters.dropped[DIS_DROP_BAD_POSITION] == 1);
    report_1->id = (DisEntityId){0};
    entity_table_pdu(f.table, &pdu, 1, &f.counters);
    CHECK(f.counters.dropped[DIS_DROP_NO_IDENTITY] == 1);
    pdu.type = dis_pdu_data; /* not for the table */
    entity_table_pdu(f.table, &pdu, 1, &f.counters);
    CHECK(entity_table_count(f.table) == 1 && seen_at(&f, 1, 1)->p_ecef[0] == earth_radius_m);

    pdu.type = dis_pdu_remove_entity;
    pdu.remove = (DisRemoveEntity){.header = {.version = 5, .type = dis_pdu_remove_entity}, .receiving = entity_id(1)};
    entity_table_pdu(f.table, &pdu, 2, &f.counters);
    CHECK(entity_table_count(f.table) == 0);
    fixture_close(&f);
}

static uint32_t dice(uint64_t *index, uint32_t sides)
{
    return (uint32_t)(random_uniform(11, 5, 0, (*index)++) * sides);
}

/* Good reports with a few octets replaced by anything: whatever the table takes, a snapshot is of places near the
 * Earth, rotations, and finite numbers. */
static void mutated_octets_do_no_harm(void **state)
{
    (void)state;
    EntityTableConfig config = entity_table_default_config();
    config.capacity = 200;
    Fixture  f = fixture_open(&config);
    uint64_t index = 0;
    int      seen = 0;
    for (int n = 0; n < 20000; n++) {
        static const uint8_t nasty[] = {0, 1, 0x7f, 0x80, 0xff};
        uint8_t              octets[512] = {0};
        DisEntityState       pdu = report(1 + n % 20, n % 3 ? tank_type : helicopter_type);
        pdu.velocity_mps[1] = 10;
        pdu.angular_rate_rps[2] = 0.1f;
        pdu.dead_reckoning = (uint8_t)(n % 10);
        pdu.variable_count = 4;
        for (int v = 0; v < 4; v++) pdu.variable[v] = articulated((uint32_t)(4107 + v), 0.1f);
        const size_t length = dis_encode_entity_state(octets, sizeof octets, &pdu);
        for (uint32_t changes = dice(&index, 5); changes > 0; changes--) {
            const uint32_t at = 12 + dice(&index, (uint32_t)length - 12); /* the header is dis_next_pdu's to check */
            octets[at] = dice(&index, 2) ? nasty[dice(&index, sizeof nasty)] : (uint8_t)dice(&index, 256);
        }
        octets[0] = (uint8_t)(5 + n % 3);
        octets[2] = n % 7 ? 1 : (uint8_t)(dice(&index, 68));
        const double  t_s = 0.01 * n;
        static DisPdu decoded;
        if (dis_decode(&decoded, octets, length) == STATUS_OK) entity_table_pdu(f.table, &decoded, t_s, &f.counters);
        if (n % 50) continue;
        entity_table_expire(f.table, t_s);
        seen_at(&f, 1, t_s + dice(&index, 20));
        for (int e = 0; e < f.snapshot.count; e++) {
            const SnapshotEntity *s = f.snapshot.entity + e;
            double                product[9];
            CHECK(v3_length(s->p_ecef) >= 0.9e5 && v3_length(s->p_ecef) <= 1.1e8);
            CHECK(v3_is_finite(s->v_ecef_mps) && v3_is_finite(s->w_body_rps) && isfinite(s->position_error_m));
            m3_tmul(product, s->r_ecef_from_body, s->r_ecef_from_body);
            for (int i = 0; i < 9; i++) CHECK_NEAR(product[i], i % 4 == 0, 1e-14);
            CHECK(s->drives.engine >= 0 && s->drives.engine <= 1 && s->drives.speed_mps >= 0 &&
                  isfinite(s->drives.fired_kg[1]));
            for (int p = 0; p < catalog_model(f.catalog, s->model)->node_count; p++) {
                const NodePose pose = node_of(&f, s, p);
                CHECK(v3_is_finite(pose.p_body) && isfinite(pose.r_body_from_node[0]));
            }
            seen++;
        }
    }
    CHECK(seen > 4000);
    fixture_close(&f);
}

/* A whole recorded exercise through the table: everybody turns up, nothing is dropped, missiles end. */
static void a_recorded_exercise(void **state)
{
    (void)state;
    char   path[512];
    DisLog log;
    if (!reference_path(path, "dis/vrf-dis5-tow-vs-armor.pcap")) skip();
    CHECK(dis_log_open(&log, path, dis_port) == STATUS_OK);
    Fixture       f = fixture_open(NULL);
    int           most = 0;
    double        t_s = 0;
    static DisPdu decoded;
    for (int d = 0; d < log.count; d++) {
        const uint8_t *at = log.datagram[d].bytes, *octets;
        DisHeader      header;
        t_s = log.datagram[d].capture_s;
        while (dis_next_pdu(&header, &octets, &at, log.datagram[d].bytes + log.datagram[d].octets, &f.counters))
            if (dis_decode(&decoded, octets, header.length) == STATUS_OK)
                entity_table_pdu(f.table, &decoded, t_s, &f.counters);
        if (entity_table_count(f.table) > most) most = entity_table_count(f.table);
    }
    for (int drop = 0; drop < DIS_DROP_COUNT; drop++) CHECK(f.counters.dropped[drop] == 0);
    CHECK(f.counters.pdus[dis_pdu_entity_state] == 462);
    const EntityCounters *c = counted(&f);
    printf("created %llu, deactivated %llu, detonated %llu, timed out %llu, late %llu, refused %llu, unknown joints "
           "%llu, most %d\n",
           (unsigned long long)c->created, (unsigned long long)c->deactivated, (unsigned long long)c->detonated,
           (unsigned long long)c->timed_out, (unsigned long long)c->late, (unsigned long long)c->motion_refused,
           (unsigned long long)c->unknown_articulation, most);
    CHECK(c->created == 22 && c->late == 13);         /* each burst missile is reported destroyed once */
    CHECK(c->detonated == 13 && c->deactivated == 0); /* 15 missiles, two still in flight at the end */
    CHECK(entity_table_count(f.table) + (int)c->timed_out == 9);
    /* flown and driven without a power-plant bit: warm all the same */
    CHECK(seen_at(&f, 66, t_s)->drives.engine == 1 && seen_at(&f, 66, t_s)->drives.flying == 1);
    CHECK(seen_at(&f, 70, t_s)->drives.engine > 0);
    dis_log_close(&log);
    fixture_close(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(index_agrees_with_a_list),
        cmocka_unit_test(handles_are_caught_when_stale),
        cmocka_unit_test(silence_ends_it),
        cmocka_unit_test(removal_with_wildcards),
        cmocka_unit_test(a_full_table_refuses_and_recovers),
        cmocka_unit_test(late_reports_do_not_count),
        cmocka_unit_test(reports_and_updates_move_it),
        cmocka_unit_test(extrapolation_is_bounded),
        cmocka_unit_test(absurd_motion_is_not_believed),
        cmocka_unit_test(frozen_stands_still),
        cmocka_unit_test(origin_is_the_base),
        cmocka_unit_test(snapshot_is_sorted_and_exact),
        cmocka_unit_test(an_empty_table_gives_an_empty_snapshot),
        cmocka_unit_test(wheels_roll_with_the_way),
        cmocka_unit_test(rotors_spin_and_freeze),
        cmocka_unit_test(articulation_and_drives_reach_the_snapshot),
        cmocka_unit_test(what_has_no_shape_is_not_in_the_scene),
        cmocka_unit_test(chaff_is_beside_the_scene),
        cmocka_unit_test(landing_gear_needs_no_report),
        cmocka_unit_test(pdus_are_checked_and_counted),
        cmocka_unit_test(mutated_octets_do_no_harm),
        cmocka_unit_test(a_recorded_exercise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
