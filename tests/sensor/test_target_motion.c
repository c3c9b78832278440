/* Radial speeds of points of a target that drives, turns, rolls and carries what spins, against v + w x r by hand.
 * labels: physics */
#include "tests/check.h"

#include "sensor/radar/seeker_radar_private.h"

/* A hull, a wheel on it whose axle is to the right, a turret turned by 90 degrees about the vertical, and a rotor on
 * the turret that spins about the turret's forward axis, with a blade that is a node of its own. Body axes: x forward,
 * y right, z down. */
enum { HULL, WHEEL, TURRET, ROTOR, BLADE, nodes };

static ModelNode node[nodes] = {[HULL] = {.parent = -1},
                                [WHEEL] = {.parent = HULL, .axis = {0, -1, 0}, .roll_radius_m = 0.5},
                                [TURRET] = {.parent = HULL, .axis = {0, 0, 1}},
                                [ROTOR] = {.parent = TURRET, .axis = {1, 0, 0}, .spin_rps_moving = 30},
                                [BLADE] = {.parent = ROTOR, .axis = {0, 0, 1}}};
static NodePose  pose[nodes] = {
     [HULL] = {{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}},
     [WHEEL] = {{2, 1, -0.5}, {1, 0, 0, 0, 1, 0, 0, 0, 1}},
     [TURRET] = {{0, 0, -2}, {0, -1, 0, 1, 0, 0, 0, 0, 1}}, /* its x is the body's y, its y the body's -x */
     [ROTOR] = {{0, 3, -2}, {0, -1, 0, 1, 0, 0, 0, 0, 1}},
     [BLADE] = {{0, 3, -2.2}, {0, -1, 0, 1, 0, 0, 0, 0, 1}}};
static const Model model = {.name = "mill", .node_count = nodes, .node = node};

/* Heads north, upright: forward is north, right is east, down is down. */
static const double r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};

static void velocity(double v_enu[3], double engine, const double w_body[3], double forward_mps, int of,
                     const double p_body[3])
{
    const SnapshotEntity entity = {.drives.engine = (float)engine,
                                   .w_body_rps = {(float)w_body[0], (float)w_body[1], (float)w_body[2]}};
    Target               t = {.entity = &entity, .of = &model, .pose = pose, .v_enu_mps = {0, forward_mps, 0}};
    memcpy(t.r_enu_from_body, r_enu_from_body, sizeof t.r_enu_from_body);
    shot_target_velocity(v_enu, &t, of, p_body);
}

static void check(const double got_enu[3], double east, double north, double up)
{
    CHECK_NEAR(got_enu[0], east, 1e-6);
    CHECK_NEAR(got_enu[1], north, 1e-6);
    CHECK_NEAR(got_enu[2], up, 1e-6);
}

/* Each axis of turning by itself, at p = (4, 3, -2): w x p is (0, 2 w, 3 w) about x (roll), (-2 w, 0, -4 w) about y
 * (pitch), (-3 w, 4 w, 0) about z (yaw); east is body y, north body x, up body -z. w is 0.5 rad/s. */
static void a_body_turns_about_each_axis(void **state)
{
    (void)state;
    const double p[3] = {4, 3, -2}, still[3] = {0, 0, 0}, roll[3] = {0.5, 0, 0}, pitch[3] = {0, 0.5, 0},
                 yaw[3] = {0, 0, 0.5};
    double v[3];
    velocity(v, 0, still, 8, HULL, p), check(v, 0, 8, 0);
    velocity(v, 0, roll, 8, HULL, p), check(v, 1, 8, -1.5);
    velocity(v, 0, pitch, 8, HULL, p), check(v, 0, 8 - 1, 2);
    velocity(v, 0, yaw, 8, HULL, p), check(v, 2, 8 - 1.5, 0);
    velocity(v, 0, yaw, 8, -1, p), check(v, 2, 8 - 1.5, 0); /* on no node */
}

/* A wheel at 8 m/s: 16 rad/s; its road contact stands still, its top has twice the speed, its front goes down.
 * Backwards it turns the other way. The rotor, 30 rad/s about the body's right: 0.4 m above its hub to the rear or the
 * front by w x r = (0, 30, 0) x (0, 0, -0.4) = (-12, 0, 0); it stands without its engine. */
static void what_rolls_and_spins_adds_its_own(void **state)
{
    (void)state;
    const double still[3] = {0, 0, 0}, contact[3] = {2, 1, 0}, top[3] = {2, 1, -1}, front[3] = {2.5, 1, -0.5},
                 blade[3] = {0, 3, -2.4}, yaw[3] = {0, 0, 0.5};
    double v[3];
    velocity(v, 0, still, 8, WHEEL, contact), check(v, 0, 0, 0);
    velocity(v, 0, still, 8, WHEEL, top), check(v, 0, 16, 0);
    velocity(v, 0, still, 8, WHEEL, front), check(v, 0, 8, -8);
    velocity(v, 0, still, -8, WHEEL, top), check(v, 0, -16, 0);
    velocity(v, 0, still, 8, HULL, top), check(v, 0, 8, 0);
    velocity(v, 1, still, 0, ROTOR, blade), check(v, 0, -12, 0);
    velocity(v, 1, still, 0, BLADE, blade), check(v, 0, -12, 0); /* as what it is on, about that one's hub */
    velocity(v, 0, still, 0, ROTOR, blade), check(v, 0, 0, 0);
    velocity(v, 1, still, 0, TURRET, blade), check(v, 0, 0, 0);
    velocity(v, 1, yaw, 8, ROTOR, blade), check(v, 0, 8 - 1.5 - 12, 0); /* all three */
}

/* Range rate: along the line of sight, less the antenna's own. From the north-east above, d = (-0.6, -0.48, -0.64). */
static void range_rate_is_along_the_line_of_sight(void **state)
{
    (void)state;
    const RadarScene scene = {.v_enu_mps = {-10, 20, -5}};
    const RadarShot  shot = {.scene = &scene};
    const Sight      sight = {.d_enu = {-0.6, -0.48, -0.64}};
    const double     v[3] = {1, 8, -1.5};
    /* of the place -0.6 - 3.84 + 0.96 = -3.48; of the antenna 6 - 9.6 + 3.2 = -0.4 */
    CHECK_NEAR(shot_range_rate(&shot, &sight, v), -3.08, 1e-12);
}

/* The main lobe of a dish ends where u = pi D / lambda sine is the first zero of J_1, J_2, J_3 (Abramowitz & Stegun,
 * table 9.5), by its taper; a small dish has no null ahead. */
static void the_main_lobe_ends_at_its_null(void **state)
{
    (void)state;
    static const double zero[] = {3.83171, 5.13562, 6.38016};
    RadarPreset         preset = {.antenna = {.diameter_m = 0.2, .wavelength_m = 0.0086}};
    const RadarShot     shot = {.preset = &preset};
    for (preset.antenna.taper = 0; preset.antenna.taper < 3; preset.antenna.taper++)
        CHECK_NEAR(shot_null(&shot) * pi_rad * 0.2 / 0.0086, zero[preset.antenna.taper], 1e-4);
    preset.antenna.taper = 2, preset.antenna.diameter_m = 0.01;
    CHECK(shot_null(&shot) == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_body_turns_about_each_axis),
        cmocka_unit_test(what_rolls_and_spins_adds_its_own),
        cmocka_unit_test(range_rate_is_along_the_line_of_sight),
        cmocka_unit_test(the_main_lobe_ends_at_its_null),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
