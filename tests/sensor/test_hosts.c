/* exercise.host: munition, causally: who carries the sensor from frame to frame, whatever the frames are. */
#include "tests/sensor/eye_lab.h"

static const DisEntityType tank = {1, 1, 225, 1, 1, 1, 0}, mine = {2, 4, 225, 3, 1, 1, 0},
                           shell = {2, 9, 225, 2, 1, 1, 0}, missile = {2, 2, 225, 1, 1, 1, 0};

static void flies(uint16_t entity, DisEntityType type, double from_s, double to_s, bool taken_away)
{
    for (double t_s = from_s; t_s <= to_s + 1e-9; t_s += 0.25) {
        LabReport r = {.t_s = 100 + t_s,
                       .entity = entity,
                       .type = type,
                       .v_enu_mps = {0, 100, -5},
                       .p_enu = {20.0 * entity, 100 * t_s - 800, 150 - 5 * t_s}};
        if (taken_away && t_s > to_s - 0.1) r.appearance = 1u << 23;
        test_attitude(r.r_enu_from_body, 0, -0.05, 0);
        lab_say(&r);
    }
}

/* A mine from the beginning, a shell from 0.5 s, a missile 1 .. 2 s, another 1.5 .. 3 s, and the shell lands at 4 s; a
 * third missile from 4.5 s. */
static void scene(void)
{
    lab_forget();
    LabReport r = {.entity = 9, .type = tank};
    test_attitude(r.r_enu_from_body, 0, 0, 0);
    for (int k = 0; k < 6; k++) {
        r.t_s = 100 + k;
        lab_say(&r);
    }
    flies(1, mine, 0, 6, false);
    flies(2, shell, 0.5, 4, true);
    flies(3, missile, 1, 2, true);
    flies(4, missile, 1.5, 3, true);
    flies(5, missile, 4.5, 6, false);
}

static uint16_t expected(double t_s)
{
    return t_s < 0.5 ? 0 : t_s < 1 ? 2 : t_s < 2 ? 3 : t_s < 3 ? 4 : t_s < 4.5 ? 0 : 5; /* no shell after a missile */
}

static void the_sensor_goes_from_one_to_the_next(void **state)
{
    (void)state;
    Config config = config_default();
    strcpy(config.exercise.host, "munition");
    config.exercise.causal = true;
    scene();
    lab_run(&config, 0, 20, 116);
    static LabFrame all[lab_most_frames];
    for (int k = 0; k < lab.shots; k++) {
        const double t_s = lab.shot[k].t_s - lab.first_s;
        if (fabs(remainder(t_s, 0.5)) < 0.02) continue; /* reports at the very moment have a test of their own */
        CHECK(expected(t_s) != 0 && lab.shot[k].host.entity == expected(t_s));
    }
    CHECK(abs(lab.shots - 20 * (25 + 13) / 10) <= 3);                        /* 0.5 .. 3 s and 4.5 .. 5.8 s */
    static const char *const hosts[] = {"1:1:2", "1:1:3", "1:1:4", "1:1:5"}; /* in order, each once */
    CHECK(lab.result.host_count == 4);
    for (int i = 0; i < 4; i++) assert_string_equal(lab.result.host[i], hosts[i]);

    /* fewer frames, each as it was */
    const int many = lab.shots;
    memcpy(all, lab.shot, sizeof all);
    lab_run(&config, 0, 4, 24);
    int met = 0;
    for (int k = 0; k < lab.shots; k++)
        for (int i = 0; i < many; i++) {
            if (all[i].t_s != lab.shot[k].t_s) continue;
            CHECK(memcmp(all[i].p_enu, lab.shot[k].p_enu, sizeof all[i].p_enu) == 0);
            CHECK(memcmp(all[i].r_enu_from_cam, lab.shot[k].r_enu_from_cam, sizeof all[i].r_enu_from_cam) == 0);
            CHECK(memcmp(all[i].rate_px_s, lab.shot[k].rate_px_s, sizeof all[i].rate_px_s) == 0);
            CHECK(all[i].host.entity == lab.shot[k].host.entity);
            met++;
        }
    CHECK(met > 15 && met >= lab.shots - 1); /* one is later than all those were */
}

/* Not asked for by `munition`, a host stays who it is. */
static void a_named_host_stays(void **state)
{
    (void)state;
    Config config = config_default();
    strcpy(config.exercise.host, "1:1:2");
    config.exercise.causal = true;
    scene();
    lab_run(&config, 0, 4, 24);
    for (int k = 0; k < lab.shots; k++) CHECK(lab.shot[k].host.entity == 2);
    CHECK(lab.shots > 10 && lab.result.host_count == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_sensor_goes_from_one_to_the_next),
        cmocka_unit_test(a_named_host_stays),
    };
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
