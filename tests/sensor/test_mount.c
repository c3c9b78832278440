/* Where the sensor sits on its host and which way it looks: sensor.mount*, by hand. labels: physics */
#include "tests/sensor/eye_lab.h"

#include "sensor/node/session/seeker_private.h"

static const DisEntityType tank = {1, 1, 225, 1, 1, 1, 0}, plane = {1, 2, 225, 1, 1, 1, 0};

static void words_and_numbers_name_classes(void **state)
{
    (void)state;
    static const struct {
        const char *word;
        uint32_t    want;
    } say[] = {/* SISO-REF-010 */
               {"primary turret", 4096},
               {"primary turret 2", 4128},
               {"primary turret 10", 4384},
               {"primary gun", 4416},
               {"primary gun 1", 4416},
               {"primary launcher 3", 4800},
               {"primary radar", 5376},
               {"secondary turret", 5696},
               {"secondary gun 2", 6048},
               {"secondary radar 10", 7264},
               {"4096", 4096},
               {"4416", 4416},
               {"primary turret 0", 0},
               {"primary turret 11", 0},
               {"primary turrets", 0},
               {"primary", 0},
               {"turret", 0},
               {"4097", 0},
               {"32", 0},
               {"99999999999", 0},
               {"-4096", 0},
               {"primary turret ", 0},
               {"", 0}};
    for (size_t i = 0; i < sizeof say / sizeof *say; i++)
        if (seeker_mount_class(say[i].word) != say[i].want)
            fail_msg("%s: %u", say[i].word, seeker_mount_class(say[i].word));
}

static void names_find_nodes(void **state)
{
    (void)state;
    Config       config = config_default();
    const Model *model = catalog_model(lab.catalog, catalog_find(lab.catalog, tank, &(Origin){0}, NULL));
    static const struct {
        const char *name;
        uint32_t    dis_class;
    } say[] = {{"turret", 4096}, {"primary turret", 4096}, {"4096", 4096}, {"gun", 4416}, {"primary gun", 4416}};
    for (size_t i = 0; i < sizeof say / sizeof *say; i++) {
        strcpy(config.sensor.mount, say[i].name);
        const Mount mount = seeker_mount(&config);
        const int   node = seeker_mount_node(&mount, model);
        CHECK(node >= 0 && model->node[node].dis_class == say[i].dis_class);
    }
    strcpy(config.sensor.mount, "auto");
    Mount mount = seeker_mount(&config);
    CHECK(seeker_mount_node(&mount, model) == mount_body);
    strcpy(config.sensor.mount, "primary radar 3");
    mount = seeker_mount(&config);
    CHECK(seeker_mount_node(&mount, model) == mount_missing);
}

static void report(const LabReport *like)
{
    lab_forget();
    for (int k = 0; k <= 3; k++) {
        LabReport r = *like;
        r.t_s = 100 + k;
        lab_say(&r);
    }
}

/* Rotation about z (down) by yaw to the right, then about y (right) by pitch up, of a vector. */
static void turned(double out[3], const double v[3], double yaw_rad, double pitch_rad)
{
    const double x = v[0] * cos(pitch_rad) + v[2] * sin(pitch_rad), z = v[2] * cos(pitch_rad) - v[0] * sin(pitch_rad);
    out[0] = x * cos(yaw_rad) - v[1] * sin(yaw_rad);
    out[1] = x * sin(yaw_rad) + v[1] * cos(yaw_rad);
    out[2] = z;
}

/* The eye and the boresight in body axes. */
static void seen(double eye_body[3], double d_body[3], const LabReport *r)
{
    const LabFrame *shot = &lab.shot[0];
    double          away[3], d_enu[3];
    for (int i = 0; i < 3; i++) {
        away[i] = shot->p_enu[i] - r->p_enu[i];
        d_enu[i] = shot->r_enu_from_cam[3 * i + 2];
    }
    m3_tmul_v3(eye_body, r->r_enu_from_body, away);
    m3_tmul_v3(d_body, r->r_enu_from_body, d_enu);
}

/* A turret at 30 degrees and a gun at 8, on a tank on a slope: a sight 1 m before, 0.5 m right of and 0.8 m above the
 * turret's pivot, and one in the gun's line, 2 m out. */
static void the_sensor_goes_with_the_turret(void **state)
{
    (void)state;
    const Model *model = catalog_model(lab.catalog, catalog_find(lab.catalog, tank, &(Origin){0}, NULL));
    const double turret = 30 * rad_per_deg, gun = 8 * rad_per_deg, ahead[3] = {1, 0, 0}, nothing[3] = {0, 0, 0};
    LabReport    r = {.entity = 1, .type = tank, .p_enu = {3, 4, 5}, .turret_rad = turret, .gun_rad = gun};
    int          turret_node = -1, gun_node = -1;
    test_attitude(r.r_enu_from_body, 1.1, 0.1, -0.2);
    for (int n = 0; n < model->node_count; n++) {
        if (model->node[n].dis_class == 4096) turret_node = n;
        if (model->node[n].dis_class == 4416) gun_node = n;
    }
    CHECK(turret_node > 0 && gun_node > 0 && model->node[gun_node].parent == turret_node &&
          model->node[turret_node].parent == 0);
    for (int on_gun = 0; on_gun < 2; on_gun++) {
        Config config = config_default();
        double eye[3], d[3], offset[3] = {1, 0.5, -0.8}, want[3], pivot[3], arm[3];
        strcpy(config.exercise.host, "1:1:1");
        strcpy(config.sensor.mount, on_gun ? "primary gun" : "primary turret");
        if (on_gun) offset[0] = 2, offset[1] = offset[2] = 0;
        config.sensor.mount_x_m = offset[0];
        if (!on_gun) config.sensor.mount_y_m = offset[1], config.sensor.mount_z_m = offset[2]; /* else unset: 0 */
        config.sensor.gimbal_limit_deg = 0;
        report(&r);
        lab_run(&config, 1, 10, 1);
        seen(eye, d, &r);
        turned(want, ahead, turret, on_gun ? gun : 0);
        for (int i = 0; i < 3; i++) CHECK_NEAR(d[i], want[i], 1e-6); /* float32 angles */
        turned(arm, offset, turret, on_gun ? gun : 0);
        turned(pivot, on_gun ? model->node[gun_node].p_parent : nothing, turret, 0);
        for (int i = 0; i < 3; i++) CHECK_NEAR(eye[i], model->node[turret_node].p_parent[i] + pivot[i] + arm[i], 1e-5);
    }
    /* a turret that is not reported stands straight */
    Config config = config_default();
    double eye[3], d[3];
    r.turret_rad = r.gun_rad = 0;
    strcpy(config.exercise.host, "1:1:1");
    strcpy(config.sensor.mount, "turret");
    config.sensor.gimbal_limit_deg = 0;
    report(&r);
    lab_run(&config, 1, 10, 1);
    seen(eye, d, &r);
    for (int i = 0; i < 3; i++) CHECK_NEAR(d[i], ahead[i], 1e-6);
}

/* Offset, yaw and pitch on the body; what is not given is where auto has it. */
static void the_sensor_sits_where_it_is_put(void **state)
{
    (void)state;
    const Model *model = catalog_model(lab.catalog, catalog_find(lab.catalog, plane, &(Origin){0}, NULL));
    LabReport    r = {.entity = 1, .type = plane, .p_enu = {3, 4, 500}};
    test_attitude(r.r_enu_from_body, 4, 0.3, 0.5);
    for (int given = 0; given < 2; given++) {
        Config       config = config_default();
        double       eye[3], d[3], want[3];
        const double ahead[3] = {1, 0, 0};
        strcpy(config.exercise.host, "1:1:1");
        config.sensor.gimbal_limit_deg = 0;
        config.sensor.mount_yaw_deg = 120;
        config.sensor.mount_pitch_deg = -35;
        if (given) config.sensor.mount_x_m = 4, config.sensor.mount_y_m = -1.5;
        report(&r);
        lab_run(&config, 1, 10, 1);
        seen(eye, d, &r);
        turned(want, ahead, 120 * rad_per_deg, -35 * rad_per_deg);
        for (int i = 0; i < 3; i++) CHECK_NEAR(d[i], want[i], 1e-6);
        Origin origin;
        catalog_find(lab.catalog, plane, &origin, NULL);
        const double base_m = origin == ORIGIN_CENTRE ? 0.5 * model->height_m : 0; /* the body's origin: its base */
        CHECK_NEAR(eye[0], given ? 4 : 0, 1e-4);
        CHECK_NEAR(eye[1], given ? -1.5 : 0, 1e-4);
        CHECK_NEAR(eye[2], base_m - (model->height_m + 0.3), 1e-4);
    }
}

static int  limit_lines, reach_lines;
static void listen(void *user, LogLevel level, const char *line)
{
    (void)user;
    limit_lines += level == LOG_WARN && strstr(line, "beyond its gimbal");
    reach_lines += strstr(line, "within reach") != NULL;
    if (level >= LOG_WARN) snprintf(check_said, sizeof check_said, "%s", line);
}

/* A vehicle that turns once in 20 s looks at another: 45 degrees to either side it reaches it. Said when it changes. */
static void an_aim_beyond_the_gimbal_is_said(void **state)
{
    (void)state;
    Config       config = config_default();
    const double w_rps = 2 * pi_rad / 20;
    lab_forget();
    for (int k = 0; k <= 40; k++) {
        LabReport host = {.t_s = 100 + 0.5 * k, .entity = 1, .type = tank, .w_body_rps = {0, 0, w_rps}};
        LabReport aim = {.t_s = 100 + 0.5 * k, .entity = 2, .type = tank, .p_enu = {0, 200, 0}};
        test_attitude(host.r_enu_from_body, w_rps * 0.5 * k, 0, 0);
        test_attitude(aim.r_enu_from_body, 0, 0, 0);
        lab_say(&host);
        lab_say(&aim);
    }
    strcpy(config.exercise.host, "1:1:1");
    strcpy(config.exercise.aim, "1:1:2");
    limit_lines = reach_lines = 0;
    log_set_sink(listen, NULL);
    lab_run(&config, 0, 5, 100);
    log_set_sink(NULL, NULL);
    CHECK(limit_lines == 1 && reach_lines == 1);
    CHECK(strstr(check_said, "1:1:2 is beyond its gimbal at 10") && strstr(check_said, "sensor.gimbal_limit_deg"));
    int at_limit = 0;
    for (int k = 0; k < lab.shots; k++) {
        const double off_deg = fabs(remainder(18.0 * lab.shot[k].t_s - 18.0 * lab.shot[0].t_s, 360));
        if (fabs(off_deg - 45) > 1) CHECK(lab.shot[k].at_limit == (off_deg > 45));
        at_limit += lab.shot[k].at_limit;
    }
    CHECK(at_limit == lab.result.at_limit && at_limit > 70 && at_limit < 78);
}

/* A part that the model lacks: said once, and as with auto. */
static void a_part_that_is_not_there_is_said(void **state)
{
    (void)state;
    Config    config = config_default();
    LabReport r = {.entity = 1, .type = plane, .p_enu = {0, 0, 500}};
    double    eye[3], d[3], with_auto[3];
    test_attitude(r.r_enu_from_body, 4, 0, 0);
    report(&r);
    strcpy(config.exercise.host, "1:1:1");
    lab_run(&config, 1, 10, 1);
    seen(with_auto, d, &r);
    strcpy(config.sensor.mount, "primary turret");
    log_set_sink(check_listen, NULL);
    *check_said = 0;
    lab_run(&config, 1, 10, 2);
    log_set_sink(NULL, NULL);
    CHECK(strstr(check_said, "has no part 'primary turret'"));
    seen(eye, d, &r);
    for (int i = 0; i < 3; i++) CHECK_NEAR(eye[i], with_auto[i], 1e-9);
    strcpy(config.sensor.mount, "");
    CHECK(config_check(&config) == STATUS_BAD_VALUE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_and_numbers_name_classes),   cmocka_unit_test(names_find_nodes),
        cmocka_unit_test(the_sensor_goes_with_the_turret),  cmocka_unit_test(the_sensor_sits_where_it_is_put),
        cmocka_unit_test(an_aim_beyond_the_gimbal_is_said), cmocka_unit_test(a_part_that_is_not_there_is_said),
    };
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
