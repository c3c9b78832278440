/* A missile's flight against closed forms: orbit, rocket equation, drag, lag; limits, refusals, the same bits, half a
 * step. labels: physics */
#include "tests/entities/flight_fixture.h"

#include "terrain/earth/gravity.h"
#include "terrain/weather/standard_atmosphere.h"

static const char *const rows[] = {"at_loft", "ir_ag", "laser_ag", "sam_ir", "wire_at", "bomb_laser"};
enum { row_count = sizeof rows / sizeof *rows };

/* An engagement that suits each row: over ground, and a crossing target in the air. */
static Engagement suitable(Missile *m, const LocalFrame *frame, int row)
{
    static const double target[row_count][3] = {{0, 2000, 0},      {0, 10000, -3000}, {0, 5000, -100},
                                                {500, 3000, 2000}, {0, 2500, 0},      {0, 6500, -4500}};
    static const double v[row_count][3] = {{10, 0, 0}, {10, 0, 0}, {10, 5, 0}, {100, -200, 0}, {8, 0, 0}, {0}};
    static const double a[row_count][3] = {{0}, {0.5, 0, 0}, {0}, {0, 30, 10}, {0}, {0}};
    static const double elevation_deg[row_count] = {18, 0, 20, 40, 2, 0};
    row_of_etc(m, rows[row]);
    return engagement_of(frame, m, 0, elevation_deg[row], target[row], v[row], a[row]);
}

/* ---- closed forms -------------------------------------------------------------------------------------- */

/* In vacuum over the equator gravitation points to the centre: a circle, at the rate sqrt(g / r), seen from axes that
 * turn. */
static void a_satellite_circles(void **state)
{
    (void)state;
    Missile      m = ideal_missile();
    FlightWorld  world = flight_world();
    FlightState  s;
    const double r = 7e6, p[3] = {r, 0, 0};
    double       g[3];
    world.air = 0;
    m.gravity_share = 0;
    earth_gravitation(g, p);
    const double rate = sqrt(-g[0] / r), v[3] = {0, (rate - earth_turn_rps) * r, 0};
    flight_launch(&s, &m, &world, 5000, p, v);
    for (int i = 0; i < 60000; i++) {
        FlightCommand c;
        flight_command(&c, &m, &world, &s, NULL);
        CHECK(flight_step(&s, &m, &world, &c));
    }
    const double angle = 60 * (rate - earth_turn_rps);
    CHECK_NEAR(flight_time_s(&s, &world), 65, 1e-9);
    CHECK_NEAR(s.p_ecef[0], r * cos(angle), 1e-6);
    CHECK_NEAR(s.p_ecef[1], r * sin(angle), 1e-6);
    CHECK_NEAR(s.p_ecef[2], 0, 1e-9);
}

/* A vacuum arc is the same flight whether the axes turn or stand: inertial velocity v + w x r, and back. */
static void an_arc_is_one_in_turning_and_in_standing_axes(void **state)
{
    (void)state;
    const Missile    m = ideal_missile();
    const LocalFrame frame = place_at(50, 8, 300);
    FlightWorld      turning = flight_world(), standing = flight_world();
    FlightState      a, b;
    const double     ahead[3] = {300, 400, 600};
    double           v[3], inertial[3];
    turning.air = standing.air = 0;
    standing.turning = 0;
    m3_mul_v3(v, frame.r_ecef_from_enu, ahead);
    const double *p = frame.origin_ecef, w = earth_turn_rps;
    for (int k = 0; k < 3; k++) inertial[k] = v[k] + (k == 0 ? -w * p[1] : k == 1 ? w * p[0] : 0);
    flight_launch(&a, &m, &turning, 0, p, v);
    flight_launch(&b, &m, &standing, 0, p, inertial);
    for (int i = 0; i < 60000; i++) {
        const FlightCommand none = {.verdict = FLIGHT_NO_SIGHT};
        CHECK(flight_step(&a, &m, &turning, &none) && flight_step(&b, &m, &standing, &none));
    }
    const double angle = w * 60, c = cos(angle), sine = sin(angle);
    CHECK_NEAR(a.p_ecef[0], c * b.p_ecef[0] + sine * b.p_ecef[1], 1e-5);
    CHECK_NEAR(a.p_ecef[1], c * b.p_ecef[1] - sine * b.p_ecef[0], 1e-5);
    CHECK_NEAR(a.p_ecef[2], b.p_ecef[2], 1e-5);
    double moved[3];
    v3_sub(moved, a.p_ecef, p);
    CHECK(v3_length(moved) > 20000);
}

/* Tsiolkovsky: two stages in empty space; each ends on its own grid point. */
static void the_rocket_equation_holds(void **state)
{
    (void)state;
    Missile          m = ideal_missile();
    FlightWorld      world = empty_world();
    const LocalFrame frame = place_at(0, 0, 50000);
    FlightState      s;
    double           v[3];
    world.air = 0;
    m.ignite_s = 0.2;
    m.burn_kg[0] = 20, m.thrust_n[0] = 40000, m.burn_s[0] = 1;
    m.burn_kg[1] = 30, m.thrust_n[1] = 24000, m.burn_s[1] = 2.5;
    to_ecef(v, &frame, 0, 10, 0);
    flight_launch(&s, &m, &world, 0, frame.origin_ecef, v);
    const FlightCommand none = {.verdict = FLIGHT_NO_SIGHT};
    for (int i = 0; i < 5000; i++) {
        const double age = i * 0.001;
        CHECK_NEAR(s.thrust_n, age < 0.2 - 1e-9 ? 0 : age < 1.2 - 1e-9 ? 40000 : age < 3.7 - 1e-9 ? 24000 : 0, 0);
        CHECK(flight_step(&s, &m, &world, &none));
    }
    CHECK_NEAR(s.mass_kg, 50, 1e-12);
    CHECK_NEAR(missile_burnt_s(&m), 3.7, 1e-12);
    CHECK_NEAR(v3_length(s.v_ecef_mps), 10 + 2000 * log(100 / 80.0) + 2000 * log(80 / 50.0), 1e-8);
}

/* Drag of a constant coefficient in air of one density: the speed falls as v0 / (1 + k v0 t). Along a path that keeps
 * its height to 2 cm; the density is the standard's. */
static void constant_drag_slows_as_on_paper(void **state)
{
    (void)state;
    Missile          m = ideal_missile();
    FlightWorld      world = empty_world();
    const LocalFrame frame = place_at(45, 10, 3000);
    FlightState      s;
    StandardAir      air;
    double           v[3], moved[3];
    for (int i = 0; i < missile_drag_nodes; i++) m.drag[i] = 0.6;
    world.geoid_m = 60;
    to_ecef(world.wind_ecef_mps, &frame, 0, 20, 0);
    standard_atmosphere(&air, 2940);
    to_ecef(v, &frame, 0, 320, 0);
    flight_launch(&s, &m, &world, 0, frame.origin_ecef, v);
    const FlightCommand none = {.verdict = FLIGHT_NO_SIGHT};
    for (int i = 0; i < 2000; i++) CHECK(flight_step(&s, &m, &world, &none));
    const double k = 0.5 * air.density_kg_m3 * 0.6 * 0.1 / 100;
    v3_sub(moved, s.p_ecef, frame.origin_ecef);
    CHECK_NEAR(v3_length(moved), 2 * 20 + log(1 + k * 300 * 2) / k, 1e-3);
    CHECK_NEAR(v3_length(s.v_ecef_mps), 20 + 300 / (1 + k * 300 * 2), 1e-3);
    CHECK(v3_length(s.v_ecef_mps) < 280);
}

/* The table of drag: its nodes, between them, and beyond. */
static void drag_follows_its_table(void **state)
{
    (void)state;
    Missile m = {0};
    for (int i = 0; i < missile_drag_nodes; i++) m.drag[i] = 0.1 * (i + 1);
    CHECK_NEAR(missile_drag(&m, 0), 0.1, 0);
    CHECK_NEAR(missile_drag(&m, 0.4), 0.15, 1e-15);
    CHECK_NEAR(missile_drag(&m, 0.95), 0.3, 1e-15);
    CHECK_NEAR(missile_drag(&m, 1.6), 0.55, 1e-15);
    CHECK_NEAR(missile_drag(&m, 9), 0.8, 0);
}

/* The autopilot's answer to a steady demand: 1 - exp(-t / T), and that of a damped second order. Pursuit at a right
 * angle to a far target asks for gain times speed. */
static void the_autopilot_lags_as_on_paper(void **state)
{
    (void)state;
    const LocalFrame  frame = place_at(10, 10, 5000);
    const FlightWorld world = empty_world();
    for (int order = 1; order <= 2; order++) {
        Missile     m = ideal_missile();
        FlightState s;
        FlightSight sight = {.los_rate_ecef_rps = {NAN, NAN, NAN}, .range_m = NAN, .closing_mps = NAN};
        double      v[3];
        m.guidance = MISSILE_PURSUIT;
        m.gain = 1e-4; /* so that the velocity hardly turns meanwhile */
        m.lag_s = 0.1;
        m.damping = order == 2 ? 0.5 : 0;
        m.memory_s = 60;
        to_ecef(v, &frame, 0, 300, 0);
        to_ecef(sight.los_ecef, &frame, 1, 0, 0);
        flight_launch(&s, &m, &world, 0, frame.origin_ecef, v);
        for (int i = 1; i <= 500; i++) {
            FlightCommand c;
            flight_command(&c, &m, &world, &s, &sight);
            assert_int_equal(c.verdict, FLIGHT_GUIDED);
            CHECK(flight_step(&s, &m, &world, &c));
            const double x = i * 0.001 / m.lag_s, root = sqrt(0.75);
            const double want =
                order == 1 ? 1 - exp(-x) : 1 - exp(-0.5 * x) * (cos(root * x) + 0.5 / root * sin(root * x));
            CHECK_NEAR(s.lateral_mps2 / (m.gain * 300), want, 1e-6);
        }
    }
}

/* ---- limits -------------------------------------------------------------------------------------------- */

static double between(const double a[3], const double b[3])
{
    double cross[3];
    v3_cross(cross, a, b);
    return atan2(v3_length(cross), v3_dot(a, b));
}

/* At every grid point of every row's flight; that each is reached is asked for, too. */
static void limits_hold(void **state)
{
    (void)state;
    const LocalFrame  frame = place_at(47, 13, 1500);
    const FlightWorld world = flight_world();
    int               met_lateral = 0, met_attack = 0, met_gimbal = 0, met_rate = 0;
    for (int row = 0; row < row_count; row++) {
        Missile     m;
        Engagement  e = suitable(&m, &frame, row);
        FlightState s;
        FlightSight sight;
        flight_launch(&s, &m, &world, 0, e.p_ecef, e.v_ecef_mps);
        m.most_lateral_mps2 *= row % 2 ? 0.3 : 1; /* some are limited by the airframe, some by the angle of attack */
        for (int i = 0; i < 6000; i++) {
            const FlightState before = s;
            FlightCommand     c;
            double            target[3], forward[3];
            /* a target that jumps aside */
            v3_add_scaled(target, e.target_ecef, i > 2500 ? 6000 : 0, frame.r_ecef_from_enu);
            if (!flight_sight_true(&sight, flight_time_s(&s, &world),
                                   m.guidance == MISSILE_COMMAND ? e.p_ecef : s.p_ecef,
                                   m.guidance == MISSILE_COMMAND ? e.target_v_ecef_mps : s.v_ecef_mps, target,
                                   e.target_v_ecef_mps, e.target_a_ecef_mps2))
                break;
            m.field_rad = 6.3;
            flight_command(&c, &m, &world, &s, &sight);
            if (!flight_step(&s, &m, &world, &c)) break;
            CHECK(s.lateral_mps2 <= m.most_lateral_mps2 * (1 + 1e-12));
            CHECK(s.lateral_mps2 <= s.most_lateral_mps2 * (1 + 1e-12));
            CHECK(s.attack_rad <= m.most_attack_rad * (1 + 1e-12));
            met_lateral += s.lateral_mps2 > 0.999 * m.most_lateral_mps2;
            met_attack += s.attack_rad > 0.999 * m.most_attack_rad;
            for (int k = 0; k < 3; k++) forward[k] = s.r_ecef_from_body[3 * k];
            const double off = between(forward, s.gaze_ecef),
                         body = between(forward, (double[3]){before.r_ecef_from_body[0], before.r_ecef_from_body[3],
                                                             before.r_ecef_from_body[6]});
            const double turned = between(before.gaze_ecef, s.gaze_ecef), most = m.gimbal_rate_rps * world.step_s;
            CHECK(off <= m.gimbal_rad + 1e-9);
            CHECK(turned <= fmax(most, body) + 1e-9); /* or carried along by the body, at its stop */
            met_gimbal += off > m.gimbal_rad - 1e-6 && m.gimbal_rad > 0;
            met_rate += turned > 0.999 * most && most > 0;
            double eye[9];
            m3_tmul(eye, s.r_ecef_from_body, s.r_ecef_from_body);
            for (int k = 0; k < 9; k++) CHECK_NEAR(eye[k], k % 4 == 0, 1e-12);
        }
    }
    print_message("grid points at the limit: lateral %d, attack %d, gimbal %d, gimbal's rate %d\n", met_lateral,
                  met_attack, met_gimbal, met_rate);
    CHECK(met_lateral > 100 && met_attack > 100 && met_gimbal > 100 && met_rate > 100);
}

/* What is asked of a wing in thin air: lift at the largest angle of attack, by hand. */
static void lift_is_limited_by_the_air(void **state)
{
    (void)state;
    Missile           m = ideal_missile();
    const FlightWorld world = empty_world();
    const LocalFrame  frame = place_at(47, 13, 12000);
    StandardAir       air;
    FlightState       s;
    FlightSight       sight = {.los_rate_ecef_rps = {NAN, NAN, NAN}, .range_m = NAN, .closing_mps = NAN};
    double            v[3];
    m.guidance = MISSILE_PURSUIT;
    m.gain = 10;
    m.lift_slope = 15;
    m.most_attack_rad = 0.2;
    m.lag_s = 0.01;
    to_ecef(v, &frame, 0, 500, 0);
    to_ecef(sight.los_ecef, &frame, 1, 0, 0);
    flight_launch(&s, &m, &world, 0, frame.origin_ecef, v);
    standard_atmosphere(&air, 12000);
    for (int i = 0; i < 200; i++) {
        FlightCommand c;
        flight_command(&c, &m, &world, &s, &sight);
        CHECK(flight_step(&s, &m, &world, &c));
    }
    const double speed = v3_length(s.v_ecef_mps);
    CHECK_NEAR(s.lateral_mps2, 0.5 * air.density_kg_m3 * speed * speed * 0.1 * 15 * sin(0.2) / 100, 1e-3);
    CHECK_NEAR(s.attack_rad, 0.2, 1e-6); /* which it follows */
    /* the body points between the velocity and the side that it turns to */
    double east[3], forward[3];
    to_ecef(east, &frame, 1, 0, 0);
    for (int k = 0; k < 3; k++) forward[k] = s.r_ecef_from_body[3 * k];
    CHECK_NEAR(between(forward, s.v_ecef_mps), 0.2, 1e-6);
    CHECK(v3_dot(forward, east) > v3_dot(s.v_ecef_mps, east) / speed);
}

/* ---- measurements that do not guide -------------------------------------------------------------------- */

static void measurements_are_refused_by_reason(void **state)
{
    (void)state;
    Missile           m = ideal_missile();
    const FlightWorld world = empty_world();
    const LocalFrame  frame = place_at(47, 13, 5000);
    FlightState       s;
    FlightCommand     c;
    FlightSight       good, sight;
    double            v[3], target[3], still[3] = {0}, falls[3] = {0};
    const double      away[3] = {300, 4000, 0};
    to_ecef(v, &frame, 0, 300, 0);
    ecef_from_enu(target, &frame, away);
    m.memory_s = 0.25;
    m.gimbal_rad = 0.5, m.field_rad = 0.4;
    flight_launch(&s, &m, &world, 1000, frame.origin_ecef, v);
    CHECK(flight_sight_true(&good, 1, s.p_ecef, s.v_ecef_mps, target, still, still));
#define VERDICT(wanted)                                                                                                \
    do {                                                                                                               \
        flight_command(&c, &m, &world, &s, &sight);                                                                    \
        assert_string_equal(flight_verdict_name(c.verdict), flight_verdict_name(wanted));                              \
        CHECK((c.verdict == FLIGHT_GUIDED) == (v3_length(c.lateral_ecef_mps2) > 0));                                   \
    } while (0)
    sight = good;
    VERDICT(FLIGHT_GUIDED);
    sight.t_s = 1 - 0.25;
    VERDICT(FLIGHT_GUIDED);
    sight.t_s = 1 - 0.2501;
    VERDICT(FLIGHT_OLD);
    sight.t_s = 1.001;
    VERDICT(FLIGHT_AHEAD);
    sight.t_s = NAN;
    VERDICT(FLIGHT_AHEAD);
    sight = good, sight.los_ecef[1] = NAN;
    VERDICT(FLIGHT_BAD_SIGHT);
    sight = good, sight.los_ecef[0] *= 1.1;
    VERDICT(FLIGHT_BAD_SIGHT);
    sight = good, sight.los_rate_ecef_rps[0] = NAN;
    VERDICT(FLIGHT_BAD_SIGHT);
    sight = good, sight.range_m = -5;
    VERDICT(FLIGHT_BAD_SIGHT);
    sight = good, sight.range_m = 0;
    VERDICT(FLIGHT_BAD_SIGHT);
    sight = good, sight.range_m = sight.closing_mps = NAN; /* angles alone guide */
    VERDICT(FLIGHT_GUIDED);
    sight = good;
    m.guide_after_s = 0.5;
    VERDICT(FLIGHT_NOT_YET);
    m.guide_after_s = 0;
    m.field_rad = 0.1; /* the target is 0.075 rad aside, half the field 0.05 */
    VERDICT(FLIGHT_OUT_OF_VIEW);
    flight_lock(&s, &m, good.los_ecef);
    VERDICT(FLIGHT_GUIDED);
    m.gimbal_rad = 0.07;
    VERDICT(FLIGHT_BEYOND_GIMBAL);
    m.gimbal_rad = 3.1, m.field_rad = 6.3;
    v3_scale(s.v_ecef_mps, -1, s.v_ecef_mps);
    CHECK(flight_sight_true(&sight, 1, s.p_ecef, s.v_ecef_mps, target, still, still));
    flight_command(&c, &m, &world, &s, &sight);
    assert_int_equal(c.verdict, FLIGHT_PASSED);
    flight_command(&c, &m, &world, &s, NULL);
    assert_int_equal(c.verdict, FLIGHT_NO_SIGHT);
    CHECK_NEAR(v3_length(c.lateral_ecef_mps2), v3_length(falls), 0);
#undef VERDICT
}

/* Without a sight it coasts: the autopilot holds up what gravity_share says, no more. */
static void without_sight_it_coasts(void **state)
{
    (void)state;
    const FlightWorld world = flight_world();
    const LocalFrame  frame = place_at(47, 13, 5000);
    for (int share = 0; share < 2; share++) {
        Missile     m = ideal_missile();
        FlightState s;
        double      v[3], enu[3];
        m.gravity_share = share;
        m.lag_s = 0.01;
        to_ecef(v, &frame, 0, 300, 0);
        flight_launch(&s, &m, &world, 0, frame.origin_ecef, v);
        for (int i = 0; i < 2000; i++) {
            FlightCommand c;
            flight_command(&c, &m, &world, &s, NULL);
            CHECK(flight_step(&s, &m, &world, &c));
        }
        enu_from_ecef(enu, &frame, s.p_ecef);
        CHECK_NEAR(enu[2], share ? 0 : -0.5 * 9.792 * 4, share ? 0.3 : 0.05); /* g at 47 N, 5 km: 9.807 - 0.0154 */
    }
}

/* A measurement late by memory_s still finds its target: it is carried on by the target's own motion. */
static void late_and_rare_measurements_are_carried_on(void **state)
{
    (void)state;
    const LocalFrame  frame = place_at(47, 13, 1500);
    const FlightWorld world = flight_world();
    Missile           m;
    EngagementResult  now, late;
    Engagement        e = suitable(&m, &frame, 1);
    engagement_fly(&now, &e, &m, &world);
    e.sight_every_s = 0.1;
    e.sight_late_s = 0.2;
    engagement_fly(&late, &e, &m, &world);
    CHECK(late.coasted == 500 + 0); /* guide_after_s of the row, no more: the first is there before */
    CHECK_NEAR(late.miss.least_m, now.miss.least_m, 0.02);
    e.sight_late_s = 0.6; /* older than the row's memory: none is taken */
    engagement_fly(&late, &e, &m, &world);
    CHECK(late.guided == 0 && late.verdict == FLIGHT_OLD);
}

/* ---- the whole ----------------------------------------------------------------------------------------- */

static void every_row_hits_what_suits_it(void **state)
{
    (void)state;
    const LocalFrame  frame = place_at(47, 13, 1500);
    const FlightWorld world = flight_world();
    for (int row = 0; row < row_count; row++) {
        Missile          m;
        EngagementResult r;
        const Engagement e = suitable(&m, &frame, row);
        engagement_fly(&r, &e, &m, &world);
        CHECK(r.miss.least_m < m.fuze_m + 0.5);
    }
}

/* Half the step moves the end by less than a millimetre. */
static void half_a_step_gives_the_same_end(void **state)
{
    (void)state;
    const LocalFrame frame = place_at(47, 13, 1500);
    FlightWorld      world = flight_world(), fine = flight_world();
    fine.step_s = 0.0005;
    for (int row = 0; row < row_count; row++) {
        Missile          m;
        EngagementResult a, b;
        Engagement       e = suitable(&m, &frame, row);
        engagement_fly(&a, &e, &m, &world);
        e.until_s = floor(10 * (a.miss.t_s - 0.2)) / 10; /* before the seeker's last turn, which its limits decide */
        engagement_fly(&a, &e, &m, &world);
        engagement_fly(&b, &e, &m, &fine);
        double moved[3];
        v3_sub(moved, a.p_ecef, b.p_ecef);
        print_message("%s: half a step moves the end by %.2g m\n", m.name, v3_length(moved));
        CHECK(v3_length(moved) < 1e-3);
        CHECK(a.state.tick * 2 == b.state.tick);
    }
}

/* Twice the same, and with another flight in between: every octet. */
static void a_replay_has_the_same_bits(void **state)
{
    (void)state;
    const LocalFrame  frame = place_at(47, 13, 1500);
    const FlightWorld world = flight_world();
    for (int row = 0; row < row_count; row += 3) {
        Missile             m, other;
        FlightState         a, b, c;
        FlightSight         sight;
        const Engagement    e = suitable(&m, &frame, row), o = suitable(&other, &frame, 1);
        const FlightCommand none = {.verdict = FLIGHT_NO_SIGHT};
        flight_launch(&a, &m, &world, 7, e.p_ecef, e.v_ecef_mps);
        flight_launch(&b, &m, &world, 7, e.p_ecef, e.v_ecef_mps);
        flight_launch(&c, &other, &world, 0, o.p_ecef, o.v_ecef_mps);
        for (int i = 0; i < 2000; i++) {
            FlightCommand command;
            CHECK(flight_sight_true(&sight, flight_time_s(&a, &world), a.p_ecef, a.v_ecef_mps, e.target_ecef,
                                    e.target_v_ecef_mps, e.target_a_ecef_mps2));
            flight_command(&command, &m, &world, &a, &sight);
            CHECK(flight_step(&a, &m, &world, &command));
            CHECK(flight_step(&c, &other, &world, &none));
            flight_command(&command, &m, &world, &b, &sight);
            CHECK(flight_step(&b, &m, &world, &command));
            CHECK(memcmp(&a, &b, sizeof a) == 0);
        }
    }
}

/* A step that would leave the Earth, or numbers, is not made. */
static void what_cannot_be_flown_is_not(void **state)
{
    (void)state;
    Missile             m = ideal_missile();
    const FlightWorld   world = flight_world();
    const LocalFrame    frame = place_at(0, 0, 0);
    const FlightCommand none = {.verdict = FLIGHT_NO_SIGHT};
    FlightState         s, before;
    double              v[3];
    to_ecef(v, &frame, 0, 0, -5e8);
    flight_launch(&s, &m, &world, 0, frame.origin_ecef, v);
    before = s;
    CHECK(!flight_step(&s, &m, &world, &none));
    CHECK(memcmp(&s, &before, sizeof s) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_satellite_circles),
        cmocka_unit_test(an_arc_is_one_in_turning_and_in_standing_axes),
        cmocka_unit_test(the_rocket_equation_holds),
        cmocka_unit_test(constant_drag_slows_as_on_paper),
        cmocka_unit_test(drag_follows_its_table),
        cmocka_unit_test(the_autopilot_lags_as_on_paper),
        cmocka_unit_test(limits_hold),
        cmocka_unit_test(lift_is_limited_by_the_air),
        cmocka_unit_test(measurements_are_refused_by_reason),
        cmocka_unit_test(without_sight_it_coasts),
        cmocka_unit_test(late_and_rare_measurements_are_carried_on),
        cmocka_unit_test(every_row_hits_what_suits_it),
        cmocka_unit_test(half_a_step_gives_the_same_end),
        cmocka_unit_test(a_replay_has_the_same_bits),
        cmocka_unit_test(what_cannot_be_flown_is_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
