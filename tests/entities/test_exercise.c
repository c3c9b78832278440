/* What a simulator owes the others: whoever extrapolates its reports is never further from the truth than the
 * thresholds and a tick; heartbeats are kept; bundles fit; the same scenario gives the same octets; losses are as
 * many as asked.
 *
 * The receiver is the entity table, fed from the datagrams; the truth is the cast. */
#include "tests/entities/entity_fixture.h"

#include "entities/exercise/exercise.h"
#include "dis/pdu/decode.h"

typedef struct Heard {
    Fixture *fixture;    /* NULL: only counted */
    double   last_s[64]; /* of each entity's latest report */
    double   longest_s[64];
    int      reports[64], updates, bundles;
    uint64_t datagrams, octets, hash;
    size_t   largest;
    double   latest_s;
} Heard;

static bool receive_datagram(void *user, double t_s, const uint8_t *bytes, size_t octets)
{
    Heard         *h = user;
    DisHeader      header;
    const uint8_t *pdu, *at = bytes;
    DisCounters    counters = {0};
    int            pdus = 0;
    CHECK(t_s >= h->latest_s); /* a recording is in order */
    h->latest_s = t_s;
    h->datagrams++;
    h->octets += octets;
    h->largest = octets > h->largest ? octets : h->largest;
    for (size_t i = 0; i < octets; i++) h->hash = (h->hash ^ bytes[i]) * UINT64_C(1099511628211);
    while (dis_next_pdu(&header, &pdu, &at, bytes + octets, &counters)) {
        const bool state = header.type == dis_pdu_entity_state, update = header.type == dis_pdu_entity_state_update;
        pdus++;
        h->updates += update;
        if (state || update) {
            const int entity = dis_pdu_entity(&header, pdu);
            if (entity < 64) {
                if (h->reports[entity]++) h->longest_s[entity] = fmax(h->longest_s[entity], t_s - h->last_s[entity]);
                h->last_s[entity] = t_s;
            }
        }
        static DisPdu decoded;
        if (h->fixture && dis_decode(&decoded, pdu, header.length) == STATUS_OK)
            entity_table_pdu(h->fixture->table, &decoded, t_s, &counters);
    }
    h->bundles += pdus > 1;
    return true;
}

static Cast *cast_of(Scenario *scenario, const char *text, const char *set)
{
    char  path[text_file_size];
    Cast *cast = NULL;
    text_file(path, text);
    CHECK(scenario_read(scenario, path) == STATUS_OK);
    remove(path);
    char word[512];
    for (snprintf(word, sizeof word, "%s", set); *word;) {
        char *end = strchr(word, ' '), *equals = strchr(word, '=');
        if (end) *end = 0;
        *equals = 0;
        CHECK(scenario_set(scenario, word, equals + 1, "test") == STATUS_OK);
        memmove(word, end ? end + 1 : "", end ? strlen(end + 1) + 1 : 1);
    }
    CHECK(scenario_check(scenario) == STATUS_OK);
    CHECK(cast_create(&cast, scenario) == STATUS_OK);
    return cast;
}

static ExerciseCounts run_all(Heard *heard, const char *text, const char *set)
{
    Scenario  scenario;
    Exercise *exercise;
    Cast     *cast = cast_of(&scenario, text, set);
    CHECK(exercise_create(&exercise, cast, 1e9, receive_datagram, heard) == STATUS_OK);
    while (exercise_step(exercise)) {
    }
    const ExerciseCounts counts = *exercise_counts(exercise);
    exercise_destroy(exercise);
    cast_destroy(cast);
    scenario_destroy(&scenario);
    return counts;
}

/* ---- the promise ---------------------------------------------------------------------------------- */

/* Everybody who moves: a winding road with turrets, stops and starts, a helicopter's turns, a jet's banked racetrack,
 * a hover, a ship, a walker, a missile, a truck that is hit. */
static const char everybody[] =
    "duration_s: 40\n"
    "vehicles:\n"
    "  - {name: Tank, type: tank, id: 1, count: 4, columns: 2, behind_m: -80, turret: swing, speed_mps: 9, unsteady_m: 3,\n"
    "     route_m: [[0, 0], [60, 30], [100, 90], [90, 160], [150, 200], [240, 180], [300, 260], [400, 300], [600, 200]]}\n"
    "  - {name: Late, type: truck, id: 11, speed_mps: 20, start_s: 7.3, stop_s: 21.1,\n"
    "     route_m: [[0, 50], [100, 90], [200, 40], [320, 100], [500, 100]]}\n"
    "  - {name: Heli, type: helicopter, id: 21, speed_mps: 50, height_m: 60, loop: true,\n"
    "     route_m: [[0, 0], [600, 100], [900, 500], [600, 900], [0, 1000], [-300, 500]]}\n"
    "  - {name: Heli, type: helicopter, id: 22, route_m: [500, -900], height_m: 70, heading_deg: 10}\n"
    "  - {name: Jet, type: aircraft, id: 31, speed_mps: 220, height_m: 900, loop: true,\n"
    "     route_m: [[-1500, 0], [1500, 0], [2900, 1100], [2900, 2300], [1500, 3400], [-1500, 3400], [-2900, 2300], [-2900, 1100]]}\n"
    "  - {name: Ship, type: ship, id: 41, speed_mps: 12, turret: swing, route_m: [[2000, -3000], [2200, -2900], [2500, -3100]]}\n"
    "  - {name: Man, type: person, id: 42, speed_mps: 1.5, route_m: [[0, -20], [5, -5], [0, 10], [15, 20], [15, 40]]}\n"
    "shots:\n"
    "  - {name: Missile, id: 51, from: Heli 22, at: Tank 4, time_s: 15}\n"
    "  - {name: Flown, id: 52, from: Heli 22, at: Tank 2, time_s: 3, flies: at_loft, damage: none}\n"
    "  - {name: Flown, id: 53, from: Tank 1, at: Jet 31, time_s: 9, flies: sam_ir, damage: none}\n";

static void keeps_its_promise(const char *set)
{
    Scenario  scenario;
    Exercise *exercise;
    Fixture   f = fixture_open(NULL);
    Heard     heard = {.fixture = &f};
    Cast     *cast = cast_of(&scenario, everybody, set);
    double    worst_m = 0, worst_rad = 0, worst_joint_rad = 0;
    double    spin_rps[64] = {0},
           bend_mps2[64] = {0}; /* of flown munitions so far: a motor and guidance begin and end at once */
    long     looks = 0;
    uint32_t draw = 0;
    CHECK(exercise_create(&exercise, cast, 1e9, receive_datagram, &heard) == STATUS_OK);
    const double tick_s = 1 / scenario.dis.rate_hz, threshold_rad = scenario.dis.threshold_deg * rad_per_deg;
    for (bool more = true; more;) {
        const double t_s = exercise_time(exercise);
        more = exercise_step(exercise);
        if (!more) break;
        /* somewhere between this tick and the next: nobody may speak in between */
        const double now_s = t_s + tick_s * random_uniform(77, 1, 0, draw++);
        for (int i = 0; i < cast->entity_count; i++) {
            SnapshotEntity    seen;
            Kinematics        truth;
            double            off[3], turn[9];
            const CastEntity *e = &cast->entity[i];
            if (!cast_present(cast, i, t_s) || !cast_present(cast, i, now_s)) continue;
            const EntityHandle handle = entity_table_find(f.table, entity_id(e->number));
            CHECK(entity_table_alive(f.table, handle) && entity_table_pose(&seen, f.table, handle, now_s));
            cast_kinematics(&truth, cast, i, now_s);
            v3_sub(off, seen.p_ecef, truth.p_ecef);
            if (e->group <
                0) { /* a missile's report means its centre; the table shows its base, half its height below */
                const double below_m = 0.5 * catalog_model(f.catalog, seen.model)->height_m;
                for (int k = 0; k < 3; k++) off[k] -= below_m * seen.r_ecef_from_body[3 * k + 2];
            }
            m3_tmul(turn, seen.r_ecef_from_body, truth.r_ecef_from_body);
            const double skew[3] = {turn[7] - turn[5], turn[2] - turn[6], turn[3] - turn[1]};
            const double angle_rad = atan2(0.5 * v3_length(skew), 0.5 * (turn[0] + turn[4] + turn[8] - 1));
            /* What an error grows by in a tick once it has come to the threshold T: an acceleration a that nobody
             * knew of has by then made sqrt(2 a T). It is the truth's own (2 |a|: the sender may validate the
             * opposite), and 2 m/s2 for what begins, and w x v where the path turns with the body; of the attitude
             * 0.5 rad/s2, and the whole rate where the algorithm holds it. */
            const bool   flown = cast_is_flown(cast, i);
            const double limit_m = scenario.dis.threshold_m;
            CHECK(i < 64);
            spin_rps[i] = fmax(flown ? spin_rps[i] : 0, v3_length(truth.w_body_rps));
            bend_mps2[i] = fmax(flown ? bend_mps2[i] : 0, v3_length(truth.a_mps2));
            const double bent_mps2 =
                dead_reckoning_in_body_axes(e->algorithm) ? spin_rps[i] * v3_length(truth.v_mps) : 0;
            const double unknown_mps2 = 2 * bend_mps2[i] + bent_mps2 + 2;
            const double turn_rps = flown                                ? 2 * spin_rps[i]
                                    : dead_reckoning_turns(e->algorithm) ? sqrt(2 * 0.5 * threshold_rad)
                                                                         : spin_rps[i] + 0.05;
            /* an update keeps the rates of the last Entity State while they differ by less than this */
            const double stale_rps = scenario.dis.updates ? 0.1 : 0;
            if (!(v3_length(off) <= limit_m + sqrt(2 * unknown_mps2 * limit_m) * tick_s))
                fail_msg("%s: entity %u at %g s: %g m off", set, e->number, now_s, v3_length(off));
            if (!(angle_rad <= threshold_rad + (turn_rps + stale_rps) * tick_s))
                fail_msg("%s: entity %u at %g s: %g deg off", set, e->number, now_s, angle_rad / rad_per_deg);
            worst_m = fmax(worst_m, v3_length(off));
            worst_rad = fmax(worst_rad, angle_rad);
            looks++;
        }
        /* joints as a receiver's articulation has them */
        if (draw % 7) continue;
        CHECK(entity_table_snapshot(&f.snapshot, f.table, now_s, f.arena) == STATUS_OK);
        for (int i = 0; i < cast->entity_count; i++) {
            JointReport joint[cast_max_joints];
            const int   joints = cast_joints(joint, cast, i, now_s);
            const int   at = snapshot_find(&f.snapshot, entity_id(cast->entity[i].number));
            if (joints == 0 || at < 0) continue;
            const SnapshotEntity *seen = &f.snapshot.entity[at];
            const Model          *model = catalog_model(f.catalog, seen->model);
            NodePose             *want = calloc((size_t)model->node_count, sizeof *want);
            double               *value = calloc((size_t)model->node_count, sizeof *value);
            for (int n = 0; n < model->node_count; n++)
                for (int j = 0; j < joints; j++)
                    if (model->node[n].dis_class + model->node[n].dis_metric == joint[j].parameter)
                        value[n] = joint[j].value;
            model_pose(want, model, value);
            for (int n = 0; n < model->node_count; n++) {
                double turn[9];
                if (model->node[n].dis_class != 4096 && model->node[n].dis_class != 4416) continue;
                const NodePose seen_node = node_of(&f, seen, n);
                m3_tmul(turn, seen_node.r_body_from_node, want[n].r_body_from_node);
                const double angle_rad = acos(clamp(0.5 * (turn[0] + turn[4] + turn[8] - 1), -1, 1));
                worst_joint_rad = fmax(worst_joint_rad, angle_rad);
                /* 0.6 rad/s2 in a tick, as above; a gun turns with its turret and has both errors */
                const double one_rad = threshold_rad + sqrt(2 * 0.6 * threshold_rad) * tick_s;
                if (!(angle_rad <= (model->node[n].dis_class == 4416 ? 2 : 1) * one_rad))
                    fail_msg("%s: joint %s of %u at %g s: %g deg off", set, model->node[n].name, cast->entity[i].number,
                             now_s, angle_rad / rad_per_deg);
            }
            free(want);
            free(value);
        }
        arena_reset(f.arena);
    }
    CHECK(looks > 8 * scenario.duration_s * scenario.dis.rate_hz);
    /* and it is no better than it has to be: thresholds are used, not ticks */
    CHECK(worst_m > 0.8 * scenario.dis.threshold_m && worst_rad > 0.6 * threshold_rad &&
          worst_joint_rad > 0.5 * threshold_rad);
    for (int i = 0; i < cast->entity_count; i++) {
        const int number = cast->entity[i].number;
        CHECK(heard.reports[number] >= 3);
        CHECK(heard.longest_s[number] <= scenario.dis.heartbeat_s + tick_s);
    }
    printf("%-60s %llu datagrams, worst %.3f m, %.2f deg, joints %.2f deg\n", set, (unsigned long long)heard.datagrams,
           worst_m, worst_rad / rad_per_deg, worst_joint_rad / rad_per_deg);
    exercise_destroy(exercise);
    cast_destroy(cast);
    scenario_destroy(&scenario);
    fixture_close(&f);
}

static void promise_by_algorithm(void **state)
{
    (void)state;
    for (int algorithm = 1; algorithm <= 9; algorithm++) {
        char set[64];
        snprintf(set, sizeof set, "dis.dead_reckoning=%d", algorithm);
        if (algorithm != 1) keeps_its_promise(set); /* 1 stands: a tick of a jet is 4 m */
    }
}

/* Algorithm 8 knows of turns what 4 knows, in other axes: it takes as many reports. A wrong acceleration in body axes
 * (that of the world, with w x v in it) keeps the promise and takes half as many again. */
static void body_axes_are_as_good(void **state)
{
    (void)state;
    Heard world = {0}, body = {0};
    run_all(&world, everybody, "dis.dead_reckoning=4");
    run_all(&body, everybody, "dis.dead_reckoning=8");
    CHECK_NEAR((double)body.datagrams / (double)world.datagrams, 1, 0.1);
}

static void promise_by_settings(void **state)
{
    (void)state;
    keeps_its_promise("dis.threshold_m=0.2 dis.threshold_deg=1 dis.rate_hz=100");
    keeps_its_promise("dis.threshold_m=5 dis.heartbeat_s=9 dis.rate_hz=20 dis.threshold_deg=6");
    keeps_its_promise("dis.updates=true dis.bundle=true dis.version=6");
    keeps_its_promise("dis.updates=true dis.dead_reckoning=8");
    /* where longitudes jump: east and west of the antimeridian, about the poles and on top of one */
    keeps_its_promise("place.lat_deg=-16.8 place.lon_deg=180");
    keeps_its_promise("place.lat_deg=89.99 place.lon_deg=35 dis.dead_reckoning=8");
    keeps_its_promise("place.lat_deg=-90 place.lon_deg=-180 dis.dead_reckoning=3");
}

/* ---- what goes on the wire -------------------------------------------------------------------------- */

static void the_same_octets(void **state)
{
    (void)state;
    Heard a = {0}, b = {0}, c = {0};
    run_all(&a, everybody, "faults.loss=0.1 faults.reorder=0.1 faults.duplicate=0.1 faults.bad_every_s=0.5");
    run_all(&b, everybody, "faults.loss=0.1 faults.reorder=0.1 faults.duplicate=0.1 faults.bad_every_s=0.5");
    run_all(&c, everybody, "faults.loss=0.1 faults.reorder=0.1 faults.duplicate=0.1 faults.bad_every_s=0.5 seed=2");
    CHECK(a.hash == b.hash && a.datagrams == b.datagrams);
    CHECK(a.hash != c.hash);
}

static void bundles_fit(void **state)
{
    (void)state;
    for (int mtu = 576; mtu < 9000; mtu = 2 * mtu + 131) {
        char  set[96];
        Heard heard = {0}, alone = {0};
        snprintf(set, sizeof set, "dis.bundle=true dis.fillers=true dis.mtu=%d", mtu);
        run_all(&heard, everybody, set);
        run_all(&alone, everybody, "dis.fillers=true");
        CHECK(heard.largest <= (size_t)mtu && heard.bundles > 100);
        CHECK(heard.octets == alone.octets && heard.datagrams < alone.datagrams && alone.bundles == 0);
        for (int i = 0; i < 64; i++) CHECK(heard.reports[i] == alone.reports[i]);
    }
}

static void losses_are_as_asked(void **state)
{
    (void)state;
    Heard heard = {0}, whole = {0};
    run_all(&whole, everybody, "dis.heartbeat_s=0.2");
    const ExerciseCounts counts =
        run_all(&heard, everybody, "dis.heartbeat_s=0.2 faults.loss=0.1 faults.duplicate=0.05 faults.reorder=0.02");
    const double n = (double)whole.datagrams;
    CHECK(n > 2000);
    /* three standard deviations of a binomial, so that half of the rarest, of some 37, fails; a datagram lost is
     * neither repeated nor late, a late one not repeated */
    const double share[] = {0.1, 0.9 * 0.98 * 0.05, 0.9 * 0.02};
    CHECK_NEAR((double)counts.lost, share[0] * n, 3 * sqrt(share[0] * (1 - share[0]) * n));
    CHECK_NEAR((double)counts.duplicated, share[1] * n, 3 * sqrt(share[1] * (1 - share[1]) * n));
    CHECK_NEAR((double)counts.overtaken, share[2] * n, 3 * sqrt(share[2] * (1 - share[2]) * n));
    CHECK(heard.datagrams == whole.datagrams - counts.lost + counts.duplicated);
    CHECK(counts.datagrams == heard.datagrams && counts.octets == heard.octets);
}

static void leaving(void **state)
{
    (void)state;
    static const char three[] = "duration_s: 9\n"
                                "vehicles:\n"
                                "  - {name: A, type: truck, id: 1, route_m: [0, 0], leaves_s: 4}\n"
                                "  - {name: B, type: truck, id: 2, route_m: [50, 0], leaves_s: 4, leaves: silent}\n"
                                "  - {name: C, type: truck, id: 3, route_m: [90, 0], leaves_s: 4, leaves: removed}\n"
                                "  - {name: D, type: truck, id: 4, route_m: [140, 0], appears_s: 6}\n";
    Fixture           f = fixture_open(NULL);
    Heard             heard = {.fixture = &f};
    run_all(&heard, three, "dis.heartbeat_s=1 dis.version=6");
    const EntityCounters *counters = entity_table_counters(f.table);
    CHECK(counters->created == 4 && counters->deactivated == 1 && counters->removed == 1 && counters->timed_out == 0);
    CHECK_NEAR(heard.last_s[1], 4, 0.02);
    CHECK_NEAR(heard.last_s[2], 3, 0.02); /* its last heartbeat */
    CHECK_NEAR(heard.last_s[3], 3, 0.02);
    CHECK(heard.reports[4] == 4); /* 6, 7, 8, 9 */
    fixture_close(&f);
}

static void updates_between_heartbeats(void **state)
{
    (void)state;
    Heard heard = {0}, plain = {0};
    run_all(&heard, everybody, "dis.updates=true");
    run_all(&plain, everybody, "");
    CHECK(heard.updates > 50 && plain.updates == 0);
    CHECK(heard.octets / heard.datagrams < plain.octets / plain.datagrams); /* they are half as long */
}

/* Ten thousand may not all be heard of at once: no tick carries more than the rate of announcement allows it. */
static void a_crowd_is_no_burst(void **state)
{
    (void)state;
    static const char crowd[] =
        "duration_s: 4\n"
        "vehicles:\n"
        "  - {name: T, type: truck, count: 10000, columns: 100, speed_mps: 8, route_m: [[0, 0], [900, 0], [900, 900]]}\n";
    Heard                heard = {0};
    const ExerciseCounts counts = run_all(&heard, crowd, "");
    CHECK(counts.pdus >= 10000 && counts.pdus < 25000);
    CHECK(heard.latest_s > 2.4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(promise_by_algorithm),
        cmocka_unit_test(promise_by_settings),
        cmocka_unit_test(body_axes_are_as_good),
        cmocka_unit_test(the_same_octets),
        cmocka_unit_test(bundles_fit),
        cmocka_unit_test(losses_are_as_asked),
        cmocka_unit_test(leaving),
        cmocka_unit_test(updates_between_heartbeats),
        cmocka_unit_test(a_crowd_is_no_burst),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
