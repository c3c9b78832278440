/* Where everybody is: routes driven at their speed, velocity and attitude against differences and the ground's own
 * slope, banked turns, formations, shots that arrive; the ground of the plane against GeographicLib. */
#include "tests/check.h"

#include "entities/exercise/cast_private.h"

static Scenario scenario;

static Cast *cast_of(const char *text)
{
    char  path[text_file_size];
    Cast *cast = NULL;
    text_file(path, text);
    CHECK(scenario_read(&scenario, path) == STATUS_OK);
    remove(path);
    CHECK(cast_create(&cast, &scenario) == STATUS_OK);
    return cast;
}

static void release(Cast *cast)
{
    cast_destroy(cast);
    scenario_destroy(&scenario);
}

/* The plane's own height of the ellipsoid against the way through geodesy: 1 cm at 30 km, at any latitude. */
static void level_ground(void **state)
{
    (void)state;
    for (double lat_deg = -80; lat_deg <= 80; lat_deg += 32) {
        char text[256];
        snprintf(text, sizeof text, "place: {lat_deg: %g, lon_deg: 20, height_m: 300}\nground: {swell_m: 0}\n",
                 lat_deg);
        Cast *cast = cast_of(text);
        for (int i = 0; i < 200; i++) {
            const double x = 60000 * (random_uniform(3, 0, 0, 2 * (uint64_t)i) - 0.5);
            const double y = 60000 * (random_uniform(3, 0, 0, 2 * (uint64_t)i + 1) - 0.5);
            double       slope[2], p[3] = {x, y, exercise_ground_at(slope, &cast->ground, x, y)}, q[3], p_ecef[3];
            Geodetic     place;
            ecef_from_enu(p_ecef, &cast->ground.frame, p);
            CHECK(geodetic_from_ecef(&place, p_ecef) == STATUS_OK);
            CHECK_NEAR(place.h_m, 300, 0.01 * pow(hypot(x, y) / 30000, 3) + 1e-3);
            for (int k = 0; k < 2; k++) { /* its slope, by differences over 2 m */
                memcpy(q, p, sizeof q);
                q[k] += 1;
                const double up = exercise_ground_at(NULL, &cast->ground, q[0], q[1]);
                q[k] -= 2;
                CHECK_NEAR(slope[k], 0.5 * (up - exercise_ground_at(NULL, &cast->ground, q[0], q[1])), 1e-8);
            }
        }
        release(cast);
    }
}

/* Straight at 8 m/s on level ground at the equator: x = 8 t in the plane, within what a line on the Earth bends off
 * it. */
static void straight_at_its_speed(void **state)
{
    (void)state;
    Cast *cast = cast_of(
        "ground: {swell_m: 0}\nvehicles:\n  - {name: A, type: truck, speed_mps: 8, route_m: [[-10, 5], [2000, 5]]}\n"
        "  - {name: S, type: truck, speed_mps: 8, start_s: 10, stop_s: 20, route_m: [[-10, 5], [2000, 5]]}\n"
        "  - {name: E, type: truck, speed_mps: 8, route_m: [[0, 5], [100, 5]]}\n");
    CastPose pose;
    for (double t = 0; t < 60; t += 0.7) {
        cast_pose(&pose, cast, 0, t);
        CHECK_NEAR(pose.p_enu[0], -10 + 8 * t, 1e-6);
        CHECK_NEAR(pose.p_enu[1], 5, 1e-9);
        /* stands until 10 s, three seconds to 8 m/s, three to a stand: 8 (13 - 10) / 2 + 8 (20 - 13) + 12 m */
        cast_pose(&pose, cast, 1, t);
        if (t <= 10) CHECK_NEAR(pose.p_enu[0], -10, 1e-9);
        if (t >= 13 && t <= 20) CHECK_NEAR(pose.p_enu[0], -10 + 12 + 8 * (t - 13), 1e-6);
        if (t >= 23) CHECK_NEAR(pose.p_enu[0], -10 + 12 + 56 + 12, 1e-6);
        CHECK(cast_still(cast, 1, t) == (t < 9.98 || t > 23.02));
        cast_pose(&pose, cast, 2, t); /* comes to rest where the route ends */
        if (t > 15) CHECK_NEAR(pose.p_enu[0], 100, 1e-6);
    }
    CHECK_NEAR(cast_next_change(cast, 1, 3), 10 - 0.02, 1e-9);
    release(cast);
}

/* A circle of 300 m at 20 m/s: acceleration v^2 / r to the middle, yaw rate v / r to the left, nothing else. */
static void circle(void **state)
{
    (void)state;
    char text[2048] =
        "ground: {swell_m: 0}\nvehicles:\n  - {name: A, type: truck, speed_mps: 20, loop: true, route_m: [";
    for (int i = 0; i < 24; i++)
        snprintf(text + strlen(text), 64, "%s[%.6f, %.6f]", i ? ", " : "", 300 * cos(2 * pi_rad * i / 24),
                 300 * sin(2 * pi_rad * i / 24));
    strcat(text, "]}\n  - {name: J, type: aircraft, height_m: 500, speed_mps: 60, loop: true, route_m: [");
    for (int i = 0; i < 24; i++)
        snprintf(text + strlen(text), 64, "%s[%.6f, %.6f]", i ? ", " : "", 300 * cos(2 * pi_rad * i / 24),
                 300 * sin(2 * pi_rad * i / 24));
    strcat(text, "]}\n");
    Cast      *cast = cast_of(text);
    Kinematics k;
    CastPose   pose;
    for (double t = 0; t < 100; t += 1.3) {
        double v_body[3], a_body[3];
        cast_kinematics(&k, cast, 0, t);
        m3_tmul_v3(v_body, k.r_ecef_from_body, k.v_mps);
        m3_tmul_v3(a_body, k.r_ecef_from_body, k.a_mps2);
        /* the route is a circle within 1 % of its curvature: tests/entities/test_route.c */
        CHECK_NEAR(v_body[0], 20, 0.01);
        CHECK_NEAR(hypot(v_body[1], v_body[2]), 0, 0.01);
        CHECK_NEAR(a_body[1], -20.0 * 20 / 300, 0.015);
        CHECK_NEAR(k.w_body_rps[2], -20.0 / 300, 1e-3);
        CHECK_NEAR(hypot(k.w_body_rps[0], k.w_body_rps[1]), 0, 1e-4);
        /* the jet leans so that what it feels is straight down: 60^2 / 300 / g, left wing low */
        cast_pose(&pose, cast, 1, t);
        CHECK_NEAR(asin(pose.r_enu_from_body[3 * 2 + 1]), atan(60.0 * 60 / 300 / 9.80665), 0.01);
        cast_kinematics(&k, cast, 1, t);
        m3_tmul_v3(a_body, k.r_ecef_from_body, k.a_mps2);
        double down_ecef[3], felt[3], down_enu[3] = {0, 0, -9.80665};
        m3_mul_v3(down_ecef, cast->ground.frame.r_ecef_from_enu, down_enu);
        v3_sub(down_ecef, down_ecef, k.a_mps2);
        m3_tmul_v3(felt, k.r_ecef_from_body, down_ecef);
        CHECK_NEAR(felt[1] / felt[2], 0, 0.01); /* no slip */
    }
    release(cast);
}

/* Over swells: velocity is the derivative, by a five-point difference of another width; the hull stands on the
 * ground's own normal, its nose along the way. */
static void derivatives_and_attitudes(void **state)
{
    (void)state;
    Cast *cast =
        cast_of("ground: {swell_m: 4}\nvehicles:\n"
                "  - {name: A, type: tank, count: 6, columns: 2, speed_mps: 11, unsteady_m: 3, behind_m: -150,\n"
                "     route_m: [[0, 0], [100, 40], [160, 150], [260, 190], [300, 320], [420, 380]]}\n"
                "  - {name: M, type: person, speed_mps: 2, route_m: [[0, 0], [30, 40], [80, 60]]}\n");
    for (int i = 0; i < cast->entity_count; i++)
        for (double t = 0.5; t < 20; t += 0.9) {
            static const double h = 0.04;
            CastPose            at, p[4];
            Kinematics          k;
            double              v_enu[3], v_ecef[3], slope[2], unit[9], v_body[3];
            cast_pose(&at, cast, i, t);
            for (int j = 0; j < 4; j++) cast_pose(&p[j], cast, i, t + (j < 2 ? j - 2 : j - 1) * h);
            for (int c = 0; c < 3; c++)
                v_enu[c] = (p[0].p_enu[c] - 8 * p[1].p_enu[c] + 8 * p[2].p_enu[c] - p[3].p_enu[c]) / (12 * h);
            m3_mul_v3(v_ecef, cast->ground.frame.r_ecef_from_enu, v_enu);
            cast_kinematics(&k, cast, i, t);
            /* the spline's third derivative jumps where pieces meet, by some 5 m/s3: both differences feel it, the
             * wide one by h^2 / 12 of it */
            for (int c = 0; c < 3; c++) CHECK_NEAR(k.v_mps[c], v_ecef[c], 7e-4);
            m3_tmul_v3(v_body, at.r_enu_from_body, v_enu);
            CHECK_NEAR(atan2(hypot(v_body[1], v_body[2]), v_body[0]), 0, i < 6 ? 1e-3 : 0.2); /* a man stays upright */

            const double z = exercise_ground_at(slope, &cast->ground, at.p_enu[0], at.p_enu[1]);
            const double normal[3] = {-slope[0], -slope[1], 1};
            const double up[3] = {-at.r_enu_from_body[2], -at.r_enu_from_body[5], -at.r_enu_from_body[8]};
            CHECK_NEAR(at.p_enu[2], z, 1e-9);
            CHECK_NEAR(v3_dot(up, i < 6 ? normal : (const double[3]){0, 0, 1}) / (i < 6 ? v3_length(normal) : 1), 1,
                       1e-8);
            m3_tmul(unit, at.r_enu_from_body, at.r_enu_from_body);
            for (int c = 0; c < 9; c++) CHECK_NEAR(unit[c], c % 4 == 0, 1e-12);
        }
    release(cast);
}

static void formations(void **state)
{
    (void)state;
    Cast *cast = cast_of(
        "scale: 2\nvehicles:\n"
        "  - {name: A, type: tank, id: 10, count: 3, columns: 3, column_m: 20, spacing_m: 50, speed_mps: 8, route_m: [[0, 0], [0, 900]]}\n"
        "  - {name: B, type: truck, route_m: [5, 5]}\n");
    CastPose pose;
    CHECK(cast->entity_count == 7); /* one alone stays alone */
    for (int i = 0; i < 6; i++) {   /* northward: the left is west */
        cast_pose(&pose, cast, i, 0);
        CHECK_NEAR(pose.p_enu[0], -20 * (i % 3 - 1), 1e-6);
        CHECK_NEAR(pose.p_enu[1], -50 * (i / 3), 1e-6);
        CHECK(cast->entity[i].number == 10 + i);
    }
    CHECK(cast->entity[6].number == 1);
    release(cast);
}

/* A missile gets to where its target is by then, with the length of its way flown out; the target burns and stops, a
 * helicopter comes down. */
static void shots(void **state)
{
    (void)state;
    Cast *cast = cast_of(
        "duration_s: 60\nvehicles:\n"
        "  - {name: T, type: tank, id: 1, speed_mps: 15, route_m: [[0, 0], [900, 0]], turret: swing}\n"
        "  - {name: H, type: helicopter, id: 2, speed_mps: 40, height_m: 120, route_m: [[2500, -500], [2500, 2500]]}\n"
        "shots:\n"
        "  - {from: H 2, at: T 1, time_s: 5, id: 7}\n"
        "  - {from: T 1, at: H 2, time_s: 6, id: 8, launch_mps: 400, boost_mps: 0, drag_mps2: 0}\n"
        "  - {from: T 1, at_m: [300, 900], time_s: 8, entity: false, rounds: 3, every_s: 2, type: 2.2.225.2.1.1.0, hit: ground,\n"
        "     launch_mps: 900, boost_mps: 0, drag_mps2: 0}\n");
    CHECK(cast->round_count == 5 && cast->entity_count == 4);
    CastPose pose, after;
    double   off[3];
    for (int i = 0; i < 2; i++) {
        const CastRound *round = &cast->round[i];
        cast_pose(&pose, cast, round->target, round->impact_s);
        v3_sub(off, round->impact_enu, pose.p_enu);
        CHECK_NEAR(v3_length(off), 1.2, 1e-6); /* aimed so far above its base */
        cast_munition_pose(&pose, cast, round, round->fire_s);
        v3_sub(off, pose.p_enu, round->launch_enu);
        CHECK_NEAR(v3_length(off), 0, 1e-6);
        cast_munition_pose(&pose, cast, round, round->impact_s);
        v3_sub(off, pose.p_enu, round->impact_enu);
        CHECK_NEAR(v3_length(off), 0, 1e-6);
        CHECK(cast_appearance(cast, round->target, round->impact_s + 0.01) & 1u << 15);
        CHECK(!(cast_appearance(cast, round->target, round->impact_s - 0.01) & 1u << 15));
        CHECK(cast_present(cast, round->munition, round->fire_s) &&
              !cast_present(cast, round->munition, round->impact_s));
    }
    v3_sub(off, cast->round[1].impact_enu, cast->round[1].launch_enu);
    CHECK_NEAR(cast->round[1].impact_s - 6, v3_length(off) / 400, 1e-6); /* at 400 m/s without motor and drag */
    /* the tank has rolled 15 m in its two seconds and stands */
    const double hit_s = cast->round[0].impact_s;
    cast_pose(&pose, cast, 0, hit_s);
    cast_pose(&after, cast, 0, hit_s + 2);
    v3_sub(off, after.p_enu, pose.p_enu);
    CHECK_NEAR(v3_length(off), 15, 0.05);
    cast_pose(&pose, cast, 0, 59);
    v3_sub(off, after.p_enu, pose.p_enu);
    CHECK_NEAR(v3_length(off), 0, 1e-9);
    /* the helicopter falls 120 m and lies */
    const CastEntity *heli = &cast->entity[1];
    CHECK_NEAR(heli->rest_s - heli->hit_s, sqrt(2 * 120 / 9.80665), 0.3); /* swells of 1.5 m at its end and beginning */
    cast_pose(&pose, cast, 1, 59);
    CHECK_NEAR(pose.p_enu[2], exercise_ground_at(NULL, &cast->ground, pose.p_enu[0], pose.p_enu[1]),
               2.5); /* 50 ms of 49 m/s */
    for (int i = 2; i < 5; i++) {
        CHECK_NEAR(cast->round[i].fire_s, 8 + 2 * (i - 2), 1e-12);
        CHECK_NEAR(cast->round[i].impact_enu[0], 300, 1e-9);
        CHECK(cast->round[i].munition == -1 && cast->round[i].target == -1 && cast->round[i].result == 3);
    }
    release(cast);
}

/* Over real elevation: on the ground of the file within what smoothing takes off, and smooth. */
static void real_ground(void **state)
{
    (void)state;
    char path[512], text[1200];
    if (!reference_path(path, "terrain/autzen/autzen_dtm_1m.tif")) {
        skip();
        return;
    }
    snprintf(text, sizeof text,
             "place: {lat_deg: 44.0565, lon_deg: -123.0690, height_m: 106}\nground: {elevation: %s}\nvehicles:\n"
             "  - {name: A, type: truck, speed_mps: 10, route_m: [[-300, -100], [-100, 0], [100, -50], [300, 100]]}\n",
             path);
    Cast  *cast = cast_of(text);
    double worst_m = 0, worst_step = 0, last[9] = {0};
    for (double t = 0; t < 55; t += 0.05) {
        CastPose pose;
        cast_pose(&pose, cast, 0, t);
        const double z = elevation_height(&cast->ground.elevation, pose.p_enu[0], pose.p_enu[1], NULL);
        worst_m = fmax(worst_m, fabs(pose.p_enu[2] - z));
        if (t > 0)
            for (int c = 0; c < 9; c++) worst_step = fmax(worst_step, fabs(pose.r_enu_from_body[c] - last[c]));
        memcpy(last, pose.r_enu_from_body, sizeof last);
    }
    CHECK(worst_m < 0.3);     /* banks and kerbs are rounded over 4 m */
    CHECK(worst_step < 0.12); /* half a metre on: no triangle's edge is felt as a jolt */
    release(cast);
}

/* A ridge of 80 m across the way, between two points 30 m above the plain, as an ESRI grid of degrees. */
static void a_ridge_is_flown_over(void **state)
{
    (void)state;
    char folder[temp_path_size], path[temp_name_size], text[2000];
    CHECK(temp_folder(folder));
    for (int part = 0; part < 2; part++) {
        snprintf(path, sizeof path, "%s/ridge.%s", folder, part ? "asc" : "prj");
        FILE *file = fopen(path, "w");
        CHECK(file != NULL);
        if (!part)
            fputs("GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
                  "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]\n",
                  file);
        else fprintf(file, "ncols 300\nnrows 100\nxllcorner 9.985\nyllcorner 45.995\ncellsize 1e-4\n");
        for (int n = 0; part && n < 300 * 100; n++)
            fprintf(file, "%.2f%c", 200 + 80 * exp(-0.5 * pow((n % 300 - 150) / 15.0, 2)), n % 300 == 299 ? '\n' : ' ');
        CHECK(fclose(file) == 0);
    }
    for (int low = 0; low < 2; low++) {
        snprintf(
            text, sizeof text,
            "duration_s: 60\nplace: {lat_deg: 46, lon_deg: 10, height_m: 250}\nground: {elevation: %s}\nvehicles:\n"
            "  - {name: H, type: helicopter, speed_mps: 30, height_m: %d, route_m: [[-800, 10], [800, -10]]}\n",
            path, low ? 30 : 300);
        Cast  *cast = cast_of(text);
        double least_m = INFINITY, most_m = -INFINITY;
        for (double t = 0; t < 53; t += 0.1) {
            CastPose pose;
            cast_pose(&pose, cast, 0, t);
            const double above_m =
                pose.p_enu[2] - elevation_height(&cast->ground.elevation, pose.p_enu[0], pose.p_enu[1], NULL);
            least_m = fmin(least_m, above_m);
            most_m = fmax(most_m, above_m);
        }
        if (low) CHECK(least_m > 25 && most_m < 75); /* one that kept its height would be 50 m inside */
        else CHECK(least_m > 215 && most_m < 301);   /* high enough: straight on, as before */
        release(cast);
    }
    remove(path);
    snprintf(path, sizeof path, "%s/ridge.prj", folder);
    remove(path);
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(level_ground), cmocka_unit_test(straight_at_its_speed),
        cmocka_unit_test(circle),       cmocka_unit_test(derivatives_and_attitudes),
        cmocka_unit_test(formations),   cmocka_unit_test(shots),
        cmocka_unit_test(real_ground),  cmocka_unit_test(a_ridge_is_flown_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
