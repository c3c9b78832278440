/* tests/entities/test_articulation.c: joints by class and metric, in any order, with any rubbish between. */
#include "tests/entities/entity_fixture.h"
#include "entities/motion/articulation.h"

enum { azimuth = 11, azimuth_rate = 12, elevation = 13, elevation_rate = 14, turret = 4096, gun = 4416 };
static const double hold_s = 12;

static double value_of(const Articulation *a, uint32_t dis_class, uint32_t metric, double t_s)
{
    double value = NAN;
    CHECK(articulation_value(&value, a, dis_class, metric, t_s, hold_s));
    return value;
}

/* All orders of the four records of a real tank give one answer. */
static void order_does_not_matter(void **state)
{
    (void)state;
    const DisVariableParameter record[4] = {
        articulated(turret + azimuth, 0.5f), articulated(turret + azimuth_rate, 0.25f),
        articulated(gun + elevation, 0.125f), articulated(gun + elevation_rate, -0.0625f)};
    int orders = 0;
    for (int code = 0; code < 256; code++) {
        const int at[4] = {code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6};
        if ((1 << at[0] | 1 << at[1] | 1 << at[2] | 1 << at[3]) != 15) continue;
        const DisVariableParameter shuffled[4] = {record[at[0]], record[at[1]], record[at[2]], record[at[3]]};
        Articulation               a = {0};
        CHECK(articulation_report(&a, shuffled, 4, 100, hold_s) == 0);
        CHECK_NEAR(value_of(&a, turret, azimuth, 100), 0.5, 0);
        CHECK_NEAR(value_of(&a, turret, azimuth, 102), 1, 0);
        CHECK_NEAR(value_of(&a, gun, elevation, 101), 0.0625, 0);
        orders++;
    }
    CHECK(orders == 24);
}

static void foreign_records_are_ignored_and_counted(void **state)
{
    (void)state;
    DisVariableParameter       attached = {.record_type = dis_variable_attached, .parameter = turret + azimuth};
    DisVariableParameter       detached = {.record_type = dis_variable_attached, .change = 1};
    DisVariableParameter       separation = {.record_type = 2, .parameter = turret + azimuth, .value = 3};
    const DisVariableParameter record[] = {
        articulated(turret + azimuth, 1),
        articulated(turret + azimuth, NAN),
        articulated(turret + azimuth_rate, INFINITY),
        articulated(131083, 2) /* 4107 with its class shifted twice */,
        articulated(11, 2) /* no class */,
        articulated(turret, 2) /* no metric */,
        articulated(turret + 17, 2) /* no such metric */,
        attached,
        detached,
        separation,
    };
    Articulation a = {0};
    CHECK(articulation_report(&a, record, 10, 0, hold_s) == 4);
    CHECK_NEAR(value_of(&a, turret, azimuth, 5), 1, 0);
    CHECK(a.attached_count == 1);
    CHECK(!articulation_value(&(double){0}, &a, turret, elevation, 0, hold_s));
    CHECK(!articulation_value(&(double){0}, &a, gun, azimuth, 0, hold_s));
}

/* A rate is followed for hold_s and no longer; without a rate the joint stays; what a later report leaves out stops. */
static void rates_are_bounded(void **state)
{
    (void)state;
    const DisVariableParameter with_rate[] = {articulated(turret + azimuth, 0),
                                              articulated(turret + azimuth_rate, 0.125f)};
    const DisVariableParameter other[] = {articulated(gun + elevation, 0.1f)};
    const DisVariableParameter mad[] = {articulated(turret + azimuth, 0.5f), articulated(turret + azimuth_rate, 1e30f)};
    Articulation               a = {0};

    articulation_report(&a, with_rate, 2, 10, hold_s);
    CHECK_NEAR(value_of(&a, turret, azimuth, 22), 1.5, 0);
    CHECK_NEAR(value_of(&a, turret, azimuth, 1000), 1.5, 0);
    articulation_report(&a, other, 1, 14, hold_s);
    CHECK_NEAR(value_of(&a, turret, azimuth, 14), 0.5, 0);
    CHECK_NEAR(value_of(&a, turret, azimuth, 20), 0.5, 0);
    articulation_report(&a, mad, 2, 15, hold_s);
    CHECK_NEAR(value_of(&a, turret, azimuth, 16), 0.5, 0);
}

/* Angles come back in -pi .. pi, lengths as they are. */
static void angles_wrap_and_lengths_do_not(void **state)
{
    (void)state;
    const DisVariableParameter record[] = {articulated(turret + azimuth, 6), articulated(2048 + 1, 6)};
    Articulation               a = {0};
    articulation_report(&a, record, 2, 0, hold_s);
    CHECK_NEAR(value_of(&a, turret, azimuth, 0), 6 - 2 * pi_rad, 1e-15);
    CHECK_NEAR(value_of(&a, 2048, 1, 0), 6, 0);
}

/* Up to 1e8 rad turns are subtracted; 2 pi is known to 2.4e-16, so that is 4e-9 rad off at 1e8. Above, the remainder is
 * exact in the double's 2 pi. */
static void large_angles_are_exact(void **state)
{
    (void)state;
    static const float value[] = {1.04e8f, -1.07e8f, 1.09e8f, 2e8f};
    for (size_t v = 0; v < sizeof value / sizeof *value; v++) {
        Articulation               a = {0};
        const DisVariableParameter record = articulated(turret + azimuth, value[v]);
        articulation_report(&a, &record, 1, 0, hold_s);
        CHECK_NEAR(value_of(&a, turret, azimuth, 0), remainder((double)value[v], 2 * pi_rad), 0);
    }
}

/* What a larger report left behind the counted joints is no joint. */
static void joints_beyond_the_count_are_none(void **state)
{
    (void)state;
    Articulation               a = {.joint[0] = {.parameter = turret + azimuth, .value = 5}};
    const DisVariableParameter rate = articulated(turret + azimuth_rate, 0.5f);
    CHECK(articulation_report(&a, &rate, 1, 0, hold_s) == 0 && a.count == 1);
    CHECK_NEAR(value_of(&a, turret, azimuth, 2), 1, 0);
}

/* Classes are 1024 .. 8191, metrics 1 .. 16; a rate of 100 is followed, and 101 is not. */
static void limits_of_records(void **state)
{
    (void)state;
    const DisVariableParameter inside[] = {articulated(1024 + 1, 1), articulated(8160 + 15, 2),
                                           articulated(turret + 15, 0), articulated(turret + 16, 100)};
    const DisVariableParameter outside[] = {articulated(992 + 1, 1), articulated(8192 + 1, 1),
                                            articulated(4096 + 17, 1), articulated(gun + 15, 0),
                                            articulated(gun + 16, 101)};
    Articulation               a = {0};
    CHECK(articulation_report(&a, inside, 4, 0, 1) == 0 && a.count == 3);
    CHECK_NEAR(value_of(&a, 1024, 1, 0), 1, 0);
    CHECK_NEAR(value_of(&a, 8160, 15, 0), 2, 0);
    CHECK_NEAR(value_of(&a, turret, 15, 0.015625), 1.5625, 0);
    CHECK(articulation_report(&a, outside, 5, 0, 1) == 3 && a.count == 4);
    CHECK_NEAR(value_of(&a, gun, 15, 0.25), 0, 0);
}

/* A double of 3.4e38 steps by 3.8e22: nothing is left of the angle, but it is still one. */
static void no_float_leaves_the_circle(void **state)
{
    (void)state;
    static const float value[] = {1e9f, -1e15f, 1e30f, 3.4028235e38f, -3.4028235e38f};
    for (size_t v = 0; v < sizeof value / sizeof *value; v++) {
        Articulation               a = {0};
        double                     got;
        const DisVariableParameter record = articulated(4096 + 11, value[v]);
        articulation_report(&a, &record, 1, 10, 12);
        CHECK(articulation_value(&got, &a, 4096, 11, 12, 12) && fabs(got) <= pi_rad);
        CHECK_NEAR(got, remainder((double)value[v], 2 * pi_rad), 1e-6);
    }
}

/* 255 different joints: 32 are kept, the rest counted, and those kept are right. */
static void too_many_joints(void **state)
{
    (void)state;
    static DisVariableParameter record[255];
    Articulation                a = {0};
    for (int i = 0; i < 255; i++)
        record[i] = articulated((uint32_t)(1024 + 32 * ((i * 97) % 200) + 15), (float)i / 256);
    const int ignored = articulation_report(&a, record, 255, 0, hold_s);
    CHECK(a.count == articulation_max_joints && ignored > 0);
    for (int i = 1; i < a.count; i++) CHECK(a.joint[i - 1].parameter < a.joint[i].parameter);
}

/* On the model: azimuth turns the gun to the right (clockwise from above), elevation lifts it, and the limits of
 * the joint are met by the angle one turn away when that is where they are. */
static void signs_on_the_tank(void **state)
{
    (void)state;
    Fixture                    f = fixture_open(NULL);
    const Model               *tank = catalog_model(f.catalog, catalog_find(f.catalog, tank_type, NULL, NULL));
    const DisVariableParameter record[] = {articulated(turret + azimuth, (float)(pi_rad / 2)),
                                           articulated(gun + elevation, (float)(0.1 + 2 * pi_rad))};
    Articulation               a = {0};
    double                     value[256];
    NodePose                   pose[256];
    int                        gun_node = -1;

    CHECK(tank->node_count <= 256);
    for (int n = 0; n < tank->node_count; n++)
        if (tank->node[n].dis_class == gun) gun_node = n;
    CHECK(gun_node > 0);
    articulation_report(&a, record, 2, 0, hold_s);
    articulation_joint_values(value, tank, &a, &(JointDrive){0}, 0, hold_s);
    model_pose(pose, tank, value);
    const double forward[3] = {1, 0, 0};
    double       bore_body[3];
    m3_mul_v3(bore_body, pose[gun_node].r_body_from_node, forward);
    CHECK_NEAR(bore_body[0], 0, 1e-6);
    CHECK_NEAR(bore_body[1], cos(0.1), 1e-6);  /* to the right */
    CHECK_NEAR(bore_body[2], -sin(0.1), 1e-6); /* up */
    fixture_close(&f);
}

/* A wheel that rolls forward moves its lowest point backwards, by as much as the hull goes on: no slip. */
static void wheels_do_not_slip(void **state)
{
    (void)state;
    Fixture            f = fixture_open(NULL);
    const Model       *truck = catalog_model(f.catalog, catalog_find(f.catalog, truck_type, NULL, NULL));
    const Articulation a = {0};
    double             value[256];
    NodePose           before[256], after[256];
    int                wheels = 0;

    CHECK(truck->node_count <= 256);
    articulation_joint_values(value, truck, &a, &(JointDrive){0}, 0, hold_s);
    model_pose(before, truck, value);
    articulation_joint_values(value, truck, &a, &(JointDrive){.distance_m = 0.001}, 0, hold_s);
    model_pose(after, truck, value);
    for (int n = 0; n < truck->node_count; n++) {
        if (!(truck->node[n].roll_radius_m > 0)) continue;
        const double lowest_body[3] = {0, 0, truck->node[n].roll_radius_m};
        double       in_node[3], moved[3];
        m3_tmul_v3(in_node, before[n].r_body_from_node, lowest_body);
        m3_mul_v3(moved, after[n].r_body_from_node, in_node);
        CHECK_NEAR(moved[0] - lowest_body[0], -0.001, 1e-6);
        wheels++;
    }
    CHECK(wheels >= 4);
    fixture_close(&f);
}

/* Classes are 1024 .. 8191 in steps of 32, metrics 1 .. 16, rates up to 100 a second; what is beyond any of them counts
 * for nothing. A rate is followed for 12 s to both sides of its report. */
static void both_ends_of_what_is_taken(void **state)
{
    (void)state;
    static const struct {
        uint32_t parameter;
        bool     taken;
    } c[] = {{992 + 11, false},  {1024 + 11, true}, {8160 + 11, true},   {8192 + 11, false},
             {turret + 1, true}, {turret, false},   {turret + 16, true}, {turret + 17, false}};
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        Articulation               a = {0};
        const DisVariableParameter record = articulated(c[i].parameter, 0.5f);
        assert_int_equal(articulation_report(&a, &record, 1, 0, hold_s), !c[i].taken);
        assert_int_equal(a.count, c[i].taken);
    }
    for (int over = 0; over < 2; over++) {
        const float                rate = over ? 100.01f : 99.99f;
        const DisVariableParameter record[] = {articulated(2048 + 1, 3),
                                               articulated(2048 + 2, over == 0 ? rate : -rate)};
        Articulation               a = {0};
        articulation_report(&a, record, 2, 100, hold_s);
        CHECK_NEAR(value_of(&a, 2048, 1, 101), over ? 3 : 3 + (double)rate, 1e-12);
        CHECK_NEAR(value_of(&a, 2048, 1, 113), over ? 3 : 3 + 12 * (double)rate, 1e-12);
        CHECK_NEAR(value_of(&a, 2048, 1, 90), over ? 3 : 3 - 10 * (double)rate, 1e-12);
        CHECK_NEAR(value_of(&a, 2048, 1, 80), over ? 3 : 3 - 12 * (double)rate, 1e-12);
    }
    /* parts that the last report attached, and none of the one before */
    Articulation               a = {0};
    const DisVariableParameter both[] = {{.record_type = dis_variable_attached},
                                         {.record_type = dis_variable_attached}};
    articulation_report(&a, both, 2, 0, hold_s);
    CHECK(a.attached_count == 2);
    articulation_report(&a, both, 1, 1, hold_s);
    CHECK(a.attached_count == 1);
}

/* What a value makes of a joint: a door that DIS counts 0 .. 1 opens by 2 m, gear without a report is down below 100
 * m/s; and an angle that is outside the limits is taken a turn further where it is inside then, on either side, and
 * left as it is where it is not. */
static void values_reach_their_joints(void **state)
{
    (void)state;
    static const struct {
        double low, high, said, want;
    } c[] = {{2.5, 4.5, -2.2, -2.2 + 2 * pi_rad},
             {-4.5, -2.5, 2.2, 2.2 - 2 * pi_rad},
             {-0.2, 0.4, 1, 1},
             {-0.2, 0.4, -1, -1},
             {1, -1, -2.2, -2.2},
             {-4, 4, 3, 3}};
    double    value;
    ModelNode node = {
        .dis_class = 2048, .dis_metric = 1, .joint = JOINT_TRANSLATION, .dis_scale = 2, .low = 1, .high = -1};
    Model m = {.node_count = 1, .node = &node};
    for (int k = 0; k < 3; k++) {
        Articulation               a = {0};
        const DisVariableParameter record = articulated(2048 + 1, 0.5f * (float)k);
        articulation_report(&a, &record, 1, 0, hold_s);
        articulation_joint_values(&value, &m, &a, &(JointDrive){0}, 0, hold_s);
        CHECK_NEAR(value, k, 1e-12);
    }
    node.value_slow = 1.5;
    for (int k = 0; k < 2; k++) {
        articulation_joint_values(&value, &m, &(Articulation){0}, &(JointDrive){.speed_mps = k ? 100.1 : 99.9}, 0,
                                  hold_s);
        CHECK_NEAR(value, k ? 0 : 1.5, 0);
    }
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        Articulation               a = {0};
        const DisVariableParameter record = articulated(turret + azimuth, (float)c[i].said);
        node = (ModelNode){
            .dis_class = turret, .dis_metric = azimuth, .joint = JOINT_ROTATION, .low = c[i].low, .high = c[i].high};
        articulation_report(&a, &record, 1, 0, hold_s);
        articulation_joint_values(&value, &m, &a, &(JointDrive){0}, 0, hold_s);
        CHECK_NEAR(value, c[i].want, 1e-6);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(order_does_not_matter),
        cmocka_unit_test(foreign_records_are_ignored_and_counted),
        cmocka_unit_test(rates_are_bounded),
        cmocka_unit_test(angles_wrap_and_lengths_do_not),
        cmocka_unit_test(no_float_leaves_the_circle),
        cmocka_unit_test(large_angles_are_exact),
        cmocka_unit_test(joints_beyond_the_count_are_none),
        cmocka_unit_test(limits_of_records),
        cmocka_unit_test(too_many_joints),
        cmocka_unit_test(both_ends_of_what_is_taken),
        cmocka_unit_test(values_reach_their_joints),
        cmocka_unit_test(signs_on_the_tank),
        cmocka_unit_test(wheels_do_not_slip),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
