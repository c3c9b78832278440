/* How the scene moves over the picture, for every sensor of etc/sensors.csv on every kind of host, against closed forms
 * and against what the cameras of neighbouring frames show of a point at rest. labels: physics slow */
#include "tests/sensor/eye_lab.h"

static const DisEntityType tank = {1, 1, 225, 1, 1, 1, 0}, plane = {1, 2, 225, 1, 1, 1, 0},
                           missile = {2, 2, 225, 1, 1, 1, 0};

/* name, columns, degrees, integration time: the columns of etc/sensors.csv, read by hand of this test. */
typedef struct SensorRow {
    char   name[32];
    double width_px, hfov_deg, integration_s;
} SensorRow;

static int read_sensors(SensorRow row[32])
{
    char path[512], line[2048];
    int  rows = 0, width = -1, hfov = -1, integration = -1;
    CHECK(etc_path(path, sizeof path, "sensors.csv"));
    FILE *file = fopen(path, "r");
    CHECK(file);
    while (fgets(line, sizeof line, file) && rows < 32) {
        if (*line == '#') continue;
        const bool head = width < 0;
        int        column = 0;
        for (char *word = line, *next; word; word = next, column++) {
            next = strchr(word, ',');
            if (next) *next++ = 0;
            if (head) {
                if (strcmp(word, "width_px") == 0) width = column;
                if (strcmp(word, "hfov_deg") == 0) hfov = column;
                if (strcmp(word, "integration_ms") == 0) integration = column;
                continue;
            }
            if (column == 0) snprintf(row[rows].name, sizeof row[rows].name, "%.31s", word);
            if (column == width) row[rows].width_px = atof(word);
            if (column == hfov) row[rows].hfov_deg = atof(word);
            if (column == integration) row[rows].integration_s = 1e-3 * atof(word);
        }
        rows += !head;
    }
    fclose(file);
    CHECK(rows >= 4 && width > 0 && hfov > 0 && integration > 0);
    return rows;
}

static double focal_px(double width_px, double hfov_deg) { return 0.5 * width_px / tan(0.5 * hfov_deg * rad_per_deg); }

/* The rate that the sensor has: the lab's picture is smaller, by its focal length. */
static void rate_of(double rate_px_s[2], const LabFrame *shot, const SensorRow *row)
{
    const double scale = focal_px(row->width_px, row->hfov_deg) / shot->focal_px;
    for (int i = 0; i < 2; i++) rate_px_s[i] = scale * shot->rate_px_s[i];
}

static Config lab_config(const SensorRow *row)
{
    Config config = config_default();
    config.sensor.hfov_deg = row->hfov_deg;
    return config;
}

static void still(uint16_t entity, DisEntityType type, const double p_enu[3], double heading_rad)
{
    for (int k = 0; k <= 4; k++) {
        LabReport r = {.t_s = 100 + k, .entity = entity, .type = type, .p_enu = {p_enu[0], p_enu[1], p_enu[2]}};
        test_attitude(r.r_enu_from_body, heading_rad, 0, 0);
        lab_say(&r);
    }
}

/* px/s, of a point at rest that is in the middle of frame k, range_m away, by the cameras before and after it. */
static void rate_seen(double rate_px_s[2], int k, double range_m)
{
    const LabFrame *now = &lab.shot[k];
    double          at[2][2];
    for (int side = 0; side < 2; side++) {
        const LabFrame *other = &lab.shot[side ? k + 1 : k - 1];
        double          away[3], cam[3];
        for (int i = 0; i < 3; i++)
            away[i] = now->p_enu[i] + range_m * now->r_enu_from_cam[3 * i + 2] - other->p_enu[i];
        m3_tmul_v3(cam, other->r_enu_from_cam, away);
        for (int i = 0; i < 2; i++) at[side][i] = now->focal_px * cam[i] / cam[2];
    }
    for (int i = 0; i < 2; i++) rate_px_s[i] = (at[1][i] - at[0][i]) / (lab.shot[k + 1].t_s - lab.shot[k - 1].t_s);
}

/* A circle about its aim at w: what it looks at stands still, though the camera turns at w and goes at w R. */
static void an_observer_does_not_smear_what_it_circles(void **state)
{
    (void)state;
    SensorRow    rows[32];
    const int    count = read_sensors(rows);
    const double here[3] = {0, 0, 0};
    for (int n = 0; n < count; n++)
        for (double rate_dps = 2; rate_dps <= 20; rate_dps += 18) {
            Config config = lab_config(&rows[n]);
            lab_forget();
            still(1, tank, here, 0.3);
            config.observer.rate_dps = rate_dps;
            lab_run(&config, 1, 100, 3);
            CHECK(lab.shots == 3);
            const double range_m = hypot(config.observer.range_m, config.observer.height_m);
            const double turning_px_s = focal_px(rows[n].width_px, rows[n].hfov_deg) * rate_dps * rad_per_deg *
                                        config.observer.range_m / range_m;
            double got[2];
            rate_of(got, &lab.shot[1], &rows[n]);
            /* a surface 4 m nearer than the middle of the hull moves by 4 m over the range of the turning; the middle
             * pixel of this coarse picture is half of one off, 1 m, and that may be another 3 m of ground behind */
            CHECK(hypot(got[0], got[1]) < turning_px_s * 7 / range_m);
            CHECK(hypot(got[0], got[1]) * rows[n].integration_s < 0.05 * rate_dps / 2); /* px of smear */
            double seen[2];
            rate_seen(seen, 1, range_m);
            CHECK(hypot(seen[0], seen[1]) < 1e-3 * turning_px_s);
        }
}

/* A sensor fixed on a vehicle that turns where it stands: the scene goes by at focal length x rate, to the left. */
static void a_turning_vehicle_smears_by_its_rate(void **state)
{
    (void)state;
    SensorRow rows[32];
    const int count = read_sensors(rows);
    for (int n = 0; n < count; n++)
        for (int right = -1; right <= 1; right += 2) {
            const double w_rps = 0.2 * right;
            Config       config = lab_config(&rows[n]);
            lab_forget();
            for (int k = 0; k <= 4; k++) {
                LabReport r = {.t_s = 100 + k, .entity = 1, .type = tank, .w_body_rps = {0, 0, w_rps}};
                test_attitude(r.r_enu_from_body, 1 + w_rps * k, 0, 0);
                lab_say(&r);
            }
            strcpy(config.exercise.host, "1:1:1");
            config.sensor.gimbal_limit_deg = 0;
            lab_run(&config, 0.96, 100, 8);
            for (int k = 0; k < lab.shots; k++) { /* a report is among them */
                double       got[2];
                const double want_px_s = -focal_px(rows[n].width_px, rows[n].hfov_deg) * w_rps;
                rate_of(got, &lab.shot[k], &rows[n]);
                CHECK_NEAR(got[0], want_px_s, 1e-4 * fabs(want_px_s)); /* w^3 (dt)^2 / 6; float32 rates and angles */
                CHECK_NEAR(got[1], 0, 1e-4 * fabs(want_px_s));
                CHECK_NEAR(got[0] * rows[n].integration_s, want_px_s * rows[n].integration_s, 0.001);
            }
            double first[2];
            lab_run(&config, 0, 100, 1);
            rate_of(first, &lab.shot[0], &rows[n]);
            CHECK_NEAR(first[0], -focal_px(rows[n].width_px, rows[n].hfov_deg) * w_rps, 0.01);
        }
}

/* A camera that looks straight down from an aircraft: the ground goes from top to bottom at focal length x speed over
 * height, and the top is where it flies to. */
static void an_aircraft_sees_the_ground_go_by(void **state)
{
    (void)state;
    SensorRow    rows[32];
    const int    count = read_sensors(rows);
    const double speed_mps = 150, height_m = 800;
    for (int n = 0; n < count; n++)
        for (double heading = 0.5; heading < 6; heading += 2.5) {
            Config       config = lab_config(&rows[n]);
            const double v[3] = {speed_mps * sin(heading), speed_mps * cos(heading), 0};
            lab_forget();
            for (int k = 0; k <= 4; k++) {
                LabReport r = {.t_s = 100 + k,
                               .entity = 1,
                               .type = plane,
                               .p_enu = {v[0] * (k - 2), v[1] * (k - 2), height_m},
                               .v_enu_mps = {v[0], v[1], 0}};
                test_attitude(r.r_enu_from_body, heading, 0, 0);
                lab_say(&r);
            }
            strcpy(config.exercise.host, "1:1:1");
            config.sensor.gimbal_limit_deg = 0;
            config.sensor.mount_pitch_deg = -90;
            config.sensor.mount_x_m = config.sensor.mount_y_m = config.sensor.mount_z_m = 0;
            lab_run(&config, 1.96, 100, 8);
            for (int k = 1; k < lab.shots - 1; k += 2) {
                double       got[2];
                const double want_px_s =
                    focal_px(rows[n].width_px, rows[n].hfov_deg) * speed_mps / lab.shot[k].p_enu[2];
                rate_of(got, &lab.shot[k], &rows[n]);
                CHECK_NEAR(lab.shot[k].r_enu_from_cam[1] * -sin(heading) +
                               lab.shot[k].r_enu_from_cam[4] * -cos(heading),
                           1, 1e-6);
                CHECK_NEAR(got[0], 0, 1e-3 * want_px_s);
                CHECK_NEAR(got[1], want_px_s,
                           2e-3 * want_px_s); /* the middle pixel's ray leans; centimetres of ground */
            }
        }
}

/* A missile that flies straight past a vehicle with its seeker on it: the seeker turns as the line of sight does, v sin
 * / range, and the vehicle stands still but for what the gimbal lags; half way there, as reports come, and rolling. */
static void a_missile_holds_its_aim(void **state)
{
    (void)state;
    SensorRow    rows[32];
    const int    count = read_sensors(rows);
    const double speed_mps = 250, pitch = -0.2, here[3] = {0, 0, 0};
    for (int n = 0; n < count; n++)
        for (int causal = 0; causal < 2; causal++) {
            Config       config = lab_config(&rows[n]);
            const double v[3] = {0, speed_mps * cos(pitch), speed_mps * sin(pitch)};
            lab_forget();
            still(1, tank, here, 0.3);
            for (int k = 0; k <= 40; k++) { /* 300 m beside it at the end; up to 1e-3 rad of noise on the attitude */
                const double t_s = 0.1 * k, noise = causal ? 1e-3 * sin(7.0 * k) : 0;
                LabReport    r = {.t_s = 100 + t_s,
                                  .entity = 2,
                                  .type = missile,
                                  .p_enu = {300, v[1] * (t_s - 5), 60 + v[2] * (t_s - 5)},
                                  .v_enu_mps = {0, v[1], v[2]}};
                test_attitude(r.r_enu_from_body, noise, pitch, 0);
                lab_say(&r);
            }
            strcpy(config.exercise.host, causal ? "munition" : "1:1:2");
            strcpy(config.exercise.aim, "1:1:1");
            config.exercise.causal = causal;
            config.sensor.gimbal_limit_deg = 80;
            lab_run(&config, 1.5, 100, 14);
            CHECK(lab.shots == 14);
            for (int k = 1; k < lab.shots - 1; k++) {
                double got[2], away[3];
                for (int i = 0; i < 3; i++) away[i] = here[i] - lab.shot[k].p_enu[i];
                const double range_m = v3_length(away), along = v3_dot(away, v) / speed_mps;
                const double los_rps = speed_mps * sqrt(1 - along * along / range_m / range_m) / range_m;
                rate_of(got, &lab.shot[k], &rows[n]);
                const double turning_px_s = focal_px(rows[n].width_px, rows[n].hfov_deg) * los_rps;
                /* the gimbal's lag while the line of sight speeds up; causal: what a report's noise makes it mend */
                CHECK(hypot(got[0], got[1]) < (causal ? 0.5 : 0.05) * turning_px_s);
                double seen[2];
                rate_seen(seen, k, range_m);
                const double scale = focal_px(rows[n].width_px, rows[n].hfov_deg) / lab.shot[k].focal_px;
                /* the vehicle's surface is 4 m nearer; half a tick's gimbal acceleration */
                if (!causal)
                    for (int i = 0; i < 2; i++) CHECK_NEAR(got[i], scale * seen[i], 0.02 * turning_px_s);
            }
        }
}

/* A missile in straight flight at 250 m/s, stopped from 1.2 to 6.2 s between two of its reports: its eye stands where
 * it then is, and is where it would have been 5 s earlier afterwards, of a replay that knows the next report as of one
 * that does not. Stamps and floats of velocity: a millimetre. */
static void a_stopped_missile_stands(void **state)
{
    (void)state;
    SensorRow    rows[32];
    const double speed_mps = 250;
    CHECK(read_sensors(rows) > 0);
    for (int causal = 0; causal < 2; causal++) {
        Config config = lab_config(&rows[0]);
        lab_forget();
        for (int k = 0; k <= 20; k++) {
            const double own_s = 0.2 * k + 0.1, t_s = own_s < 1.2 ? own_s : own_s + 5;
            LabReport    r = {.t_s = 100 + t_s,
                              .entity = 2,
                              .type = missile,
                              .p_enu = {300, speed_mps * (own_s - 5), 100},
                              .v_enu_mps = {0, speed_mps, 0}};
            test_attitude(r.r_enu_from_body, 0, 0, 0);
            if (k == 6) lab_pause(101.2, true), lab_pause(106.2, false);
            lab_say(&r);
        }
        strcpy(config.exercise.host, causal ? "munition" : "1:1:2");
        config.exercise.causal = causal;
        config.sensor.gimbal_limit_deg = 0;
        config.sensor.mount_x_m = config.sensor.mount_y_m = config.sensor.mount_z_m = 0;
        lab_run(&config, 0.5, 20, 140);
        CHECK(lab.shots == 140);
        for (int k = 0; k < lab.shots; k++) {
            const double t_s = lab.shot[k].t_s - 100, own_s = t_s < 1.2 ? t_s : t_s < 6.2 ? 1.2 : t_s - 5;
            CHECK_NEAR(lab.shot[k].p_enu[1], speed_mps * (own_s - 5), 1e-3);
        }
    }
}

/* The same with the seeker fixed on a body that turns about all axes: rate by rate. */
static void a_turning_missile_smears_along_the_right_axes(void **state)
{
    (void)state;
    SensorRow    rows[32];
    const int    count = read_sensors(rows);
    const double q_rps = 0.3, heading = 0.8;
    for (int n = 0; n < count; n++) {
        Config config = lab_config(&rows[n]);
        lab_forget();
        for (int k = 0; k <= 40; k++) { /* pitches up about a fixed point; no velocity */
            const double t_s = 0.1 * k;
            LabReport    r = {
                   .t_s = 100 + t_s, .entity = 2, .type = missile, .p_enu = {0, 0, 300}, .w_body_rps = {0, q_rps, 0}};
            test_attitude(r.r_enu_from_body, heading, -0.5 + q_rps * t_s, 0);
            lab_say(&r);
        }
        strcpy(config.exercise.host, "1:1:2");
        config.sensor.gimbal_limit_deg = 0;
        config.sensor.mount_x_m = config.sensor.mount_y_m = config.sensor.mount_z_m = 0;
        lab_run(&config, 1, 100, 8);
        for (int k = 1; k < lab.shots - 1; k++) {
            double       got[2];
            const double want_px_s = focal_px(rows[n].width_px, rows[n].hfov_deg) * q_rps; /* the scene sinks */
            rate_of(got, &lab.shot[k], &rows[n]);
            CHECK_NEAR(got[0], 0, 1e-3 * want_px_s);
            CHECK_NEAR(got[1], want_px_s, 2e-3 * want_px_s); /* the track between reports is a cubic */
        }
    }
}

/* A camera far from the middle of a turning hull, looking down beside it: the ground goes by as the eye does, and
 * turns. */
static void a_sensor_far_out_moves_with_the_turn(void **state)
{
    (void)state;
    SensorRow    rows[32];
    const int    count = read_sensors(rows);
    const double w_rps = 0.1, out_m = 20, up_m = 50;
    for (int n = 0; n < count; n++) {
        Config config = lab_config(&rows[n]);
        lab_forget();
        for (int k = 0; k <= 4; k++) {
            LabReport r = {.t_s = 100 + k, .entity = 1, .type = tank, .w_body_rps = {0, 0, w_rps}};
            test_attitude(r.r_enu_from_body, 2 + w_rps * k, 0, 0);
            lab_say(&r);
        }
        strcpy(config.exercise.host, "1:1:1");
        config.sensor.gimbal_limit_deg = 0;
        config.sensor.mount_pitch_deg = -60;
        config.sensor.mount_x_m = out_m, config.sensor.mount_y_m = 0, config.sensor.mount_z_m = -up_m;
        lab_run(&config, 0.96, 100, 8);
        for (int k = 1; k < lab.shots - 1; k++) {
            double       got[2], seen[2];
            const double range_m = lab.shot[k].p_enu[2] / sin(60 * rad_per_deg),
                         focal = focal_px(rows[n].width_px, rows[n].hfov_deg);
            /* to the left by the turn about the vertical, w cos 60, and by the eye's way to the right */
            const double want_px_s = -focal * (w_rps * cos(60 * rad_per_deg) + w_rps * out_m / range_m);
            rate_of(got, &lab.shot[k], &rows[n]);
            CHECK_NEAR(got[0], want_px_s, 3e-3 * fabs(want_px_s)); /* half a pixel of the coarse picture in range */
            CHECK_NEAR(got[1], 0, 3e-3 * fabs(want_px_s));
            rate_seen(seen, k, range_m);
            for (int i = 0; i < 2; i++)
                CHECK_NEAR(got[i], focal / lab.shot[k].focal_px * seen[i], 3e-3 * fabs(want_px_s));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_observer_does_not_smear_what_it_circles),
        cmocka_unit_test(a_turning_vehicle_smears_by_its_rate),
        cmocka_unit_test(an_aircraft_sees_the_ground_go_by),
        cmocka_unit_test(a_missile_holds_its_aim),
        cmocka_unit_test(a_stopped_missile_stands),
        cmocka_unit_test(a_turning_missile_smears_along_the_right_axes),
        cmocka_unit_test(a_sensor_far_out_moves_with_the_turn),
    };
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
