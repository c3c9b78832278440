/* Shots of a scenario that fly: what was kept of a flight is the flight, it ends where its Detonation is, and what is
 * asked of the file is checked. That receivers follow it: test_exercise.c. */
#include "tests/entities/flight_fixture.h"

#include "dis/pdu/decode.h"
#include "entities/exercise/cast_private.h"

static const char scene[] =
    "duration_s: 40\n"
    "vehicles:\n"
    "  - {name: Tank, type: tank, id: 1, speed_mps: 9, unsteady_m: 2, route_m: [[0, 0], [300, 60], [900, 90]]}\n"
    "  - {name: Plane, type: 1.2.225.1.1.0.0, id: 11, speed_mps: 180, height_m: 1500,\n"
    "     route_m: [[300, 5000], [200, 2000], [100, -3000]]}\n"
    "  - {name: Heli, type: helicopter, id: 21, route_m: [[500, -1900]], height_m: 70, heading_deg: 10}\n"
    "  - {name: Truck, type: truck, id: 31, route_m: [[20, -30]]}\n"
    "shots:\n"
    "  - {name: Loft, id: 51, from: Heli 21, at: Tank 1, time_s: 2.00037, flies: at_loft, damage: moderate}\n"
    "  - {name: Wire, id: 52, from: Heli 21, at: Tank 1, time_s: 4, flies: wire_at}\n"
    "  - {name: Sam, id: 53, from: Truck 31, at: Plane 11, time_s: 3, flies: sam_ir, hit_m: 0}\n"
    "  - {name: Place, id: 54, from: Heli 21, at_m: [100, 500], time_s: 6, flies: laser_ag, hit_m: 0}\n"
    "  - {name: Line, id: 55, from: Heli 21, at: Tank 1, time_s: 20}\n";

static Status open_scene(Cast **cast, Scenario *scenario, const char *key, const char *value)
{
    char path[text_file_size];
    text_file(path, scene);
    CHECK(scenario_read(scenario, path) == STATUS_OK);
    remove(path);
    if (key) {
        const Status status = scenario_set_any(scenario, key, value, "test");
        if (status != STATUS_OK) return status;
    }
    const Status status = scenario_check(scenario);
    return status == STATUS_OK ? cast_create(cast, scenario) : status;
}

static void each_ends_where_it_should(void **state)
{
    (void)state;
    Scenario scenario;
    Cast    *cast = NULL;
    CHECK(open_scene(&cast, &scenario, NULL, NULL) == STATUS_OK);
    assert_int_equal(cast->flight_count, 4);
    for (int i = 0; i < cast->round_count; i++) {
        const CastRound *round = &cast->round[i];
        CastPose         at, target;
        double           off[3];
        CHECK((round->flight >= 0) == (i < 4));
        if (i == 4) continue;
        const CastFlight *f = &cast->flight[round->flight];
        assert_int_equal(f->round, i);
        CHECK_NEAR(f->flight_s, round->impact_s - round->fire_s, 1e-12);
        CHECK_NEAR(remainder(round->fire_s, 0.001), 0, 1e-9); /* on the grid */
        cast_pose(&at, cast, round->munition, round->fire_s);
        v3_sub(off, at.p_enu, round->launch_enu);
        CHECK_NEAR(v3_length(off), 0, 1e-6);
        cast_pose(&at, cast, round->munition, round->impact_s);
        v3_sub(off, at.p_enu, round->impact_enu);
        CHECK_NEAR(v3_length(off), 0, 0.02); /* of the last sample, 10 ms before, straight on */
        if (i == 3) {                        /* 1.2 m above the place is aimed at, and the ground is met */
            assert_int_equal(round->result, dis_result_ground_impact);
            assert_int_equal(round->target, -1);
            CHECK_NEAR(round->impact_enu[2],
                       exercise_ground_at(NULL, &cast->ground, round->impact_enu[0], round->impact_enu[1]), 1e-3);
            print_message("ground %g m from the place, passing it by %g m\n",
                          hypot(round->impact_enu[0] - 100, round->impact_enu[1] - 500), f->miss_m);
            CHECK(hypot(round->impact_enu[0] - 100, round->impact_enu[1] - 500) < 1);
            continue;
        }
        assert_int_equal(round->result, dis_result_entity_impact);
        if (!(f->hit && f->miss_m < (i == 1 ? 1 : 0.3))) /* the helicopter, whose sight commands, sways by 0.4 m */
            fail_msg("round %d: miss %g m, end %d", i, f->miss_m, f->end);
        cast_pose(&target, cast, round->target, round->impact_s);
        for (int k = 0; k < 3; k++) off[k] = target.p_enu[k] - 1.2 * target.r_enu_from_body[3 * k + 2];
        v3_sub(off, off, round->impact_enu);
        CHECK_NEAR(v3_length(off), i == 2 ? 0.5 : 2, 1e-3); /* the row's fuze_m, or hit_m: the larger */
    }
    CHECK_NEAR(cast->entity[0].hit_s, cast->round[0].impact_s, 0);
    assert_int_equal(cast->entity[0].damage, 2);
    cast_destroy(cast);
    scenario_destroy(&scenario);
}

/* The same flight by hand: launch as the pose says, true sight of the cast's target at each step. */
static void what_is_kept_is_the_flight(void **state)
{
    (void)state;
    Scenario          scenario;
    Cast             *cast = NULL;
    const FlightWorld world = flight_world();
    Missile           m;
    FlightState       s;
    CHECK(open_scene(&cast, &scenario, NULL, NULL) == STATUS_OK);
    const CastRound  *round = &cast->round[2];
    const LocalFrame *frame = &cast->ground.frame;
    double            p[3], v[3], worst_m = 0, worst_mps = 0, worst_rad = 0;
    CastPose          pose;
    row_of_etc(&m, "sam_ir");
    Kinematics target, launcher;
    ecef_from_enu(p, frame, round->launch_enu);
    cast_kinematics(&target, cast, round->target, round->fire_s);
    cast_kinematics(&launcher, cast, round->shooter, round->fire_s);
    for (int k = 0; k < 3; k++) v[k] = target.p_ecef[k] - 1.2 * target.r_ecef_from_body[3 * k + 2] - p[k];
    CHECK(v3_length(launcher.v_mps) < 1e-6);
    FlightSight sight;
    v3_scale(v, m.launch_mps / v3_length(v), v);
    flight_launch(&s, &m, &world, llround(round->fire_s * 1000), p, v);
    flight_lock(&s, &m, v);
    for (int i = 0; flight_time_s(&s, &world) < round->impact_s - 0.02; i++) {
        FlightCommand c;
        Kinematics    k;
        double        off[3], aim[3];
        const double  t_s = flight_time_s(&s, &world);
        cast_pose(&pose, cast, round->munition, t_s);
        ecef_from_enu(off, frame, pose.p_enu);
        v3_sub(off, off, s.p_ecef);
        worst_m = fmax(worst_m, v3_length(off));
        /* half way between samples velocity and attitude, too */
        if (i % 10 == 5 && i > 20) {
            cast_kinematics(&k, cast, round->munition, t_s);
            v3_sub(off, k.v_mps, s.v_ecef_mps);
            worst_mps = fmax(worst_mps, v3_length(off));
            for (int e = 0; e < 9; e++)
                worst_rad = fmax(worst_rad, fabs(k.r_ecef_from_body[e] - s.r_ecef_from_body[e]));
        }
        cast_kinematics(&target, cast, round->target, t_s);
        for (int a = 0; a < 3; a++) aim[a] = target.p_ecef[a] - 1.2 * target.r_ecef_from_body[3 * a + 2];
        CHECK(flight_sight_true(&sight, t_s, s.p_ecef, s.v_ecef_mps, aim, target.v_mps, target.a_mps2));
        flight_command(&c, &m, &world, &s, &sight);
        CHECK(flight_step(&s, &m, &world, &c));
    }
    print_message("kept: %.2g m, %.2g m/s, %.2g rad\n", worst_m, worst_mps, worst_rad);
    CHECK(worst_m < 1e-3 && worst_mps < 0.2 && worst_rad < 0.01);
    cast_destroy(cast);
    scenario_destroy(&scenario);
}

/* A point aside is sighted: the miss is that far, sighted across the line; another seed draws another. */
static void a_sight_error_is_the_miss(void **state)
{
    (void)state;
    double last_m = 0, sum_m2 = 0;
    for (int seed = 1; seed <= 12; seed++) {
        Scenario scenario;
        Cast    *cast = NULL;
        char     text[16];
        snprintf(text, sizeof text, "%d", seed);
        char path[text_file_size];
        text_file(path, scene);
        CHECK(scenario_read(&scenario, path) == STATUS_OK);
        remove(path);
        CHECK(scenario_set(&scenario, "seed", text, "test") == STATUS_OK);
        CHECK(scenario_set_any(&scenario, "shots.Sam.sight_error_m", "3", "test") == STATUS_OK);
        CHECK(cast_create(&cast, &scenario) == STATUS_OK);
        const CastFlight *f = &cast->flight[cast->round[2].flight];
        const double      drawn_m =
            3 * hypot(random_normal((uint64_t)seed, 11, 2, 0), random_normal((uint64_t)seed, 11, 2, 1));
        CHECK_NEAR(f->miss_m, drawn_m,
                   0.05 * drawn_m + 0.01); /* the last way is 0.3 rad off the first line of sight at most */
        CHECK(f->miss_m != last_m);
        last_m = f->miss_m, sum_m2 += last_m * last_m;
        cast_destroy(cast);
        scenario_destroy(&scenario);
    }
    CHECK(sum_m2 > 12 * 2 * 9 * 0.4);
}

static void what_is_wrong_is_said(void **state)
{
    (void)state;
    Scenario scenario;
    Cast    *cast = NULL;
    log_set_sink(check_listen, NULL);
    CHECK(open_scene(&cast, &scenario, "shots.Loft.flies", "at_laft") == STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "at_laft") && strstr(check_said, "missiles.csv"));
    scenario_destroy(&scenario);
    CHECK(open_scene(&cast, &scenario, "shots.Loft.rounds", "257") == STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "260 rounds fly"));
    scenario_destroy(&scenario);
    CHECK(open_scene(&cast, &scenario, "shots.Lift.flies", "at_loft") == STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "no shots with name: 'Lift'"));
    scenario_destroy(&scenario);
    CHECK(open_scene(&cast, &scenario, "shots.Loft.sight_late_s", "7") == STATUS_BAD_VALUE);
    scenario_destroy(&scenario);
    CHECK(open_scene(&cast, &scenario, "shots.Loft.sight_noise_mrad", "1") == STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "give sight_memory too"));
    scenario_destroy(&scenario);
    CHECK(open_scene(&cast, &scenario, "shots.Loft.sight_late_s", "0.3") == STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "more than 200 measurements"));
    scenario_destroy(&scenario);
    CHECK(open_scene(&cast, &scenario, "missiles", "/nowhere/missiles.csv") != STATUS_OK);
    scenario_destroy(&scenario);
    /* a launcher that stands and gives no speed gives no direction */
    char missiles[text_file_size];
    missiles_but(missiles, "at_loft", "launch_mps", "0");
    CHECK(open_scene(&cast, &scenario, "missiles", missiles) == STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "at_loft leaves its launcher at ") && strstr(check_said, "launch_mps"));
    scenario_destroy(&scenario);
    remove(missiles);
    log_set_sink(NULL, NULL);
    SettingType type;
    CHECK(scenario_key_type(&type, "shots.X.sight_late_s") && type == SETTING_DOUBLE);
    CHECK(!scenario_key_type(&type, "shots.X.speed_mps"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_ends_where_it_should),
        cmocka_unit_test(what_is_kept_is_the_flight),
        cmocka_unit_test(a_sight_error_is_the_miss),
        cmocka_unit_test(what_is_wrong_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
