/* What hides part of a target: of two spheres behind a wall that covers one, the other keeps its own field, as a model
 * and as given scatterers. And a target by a given signature, through the whole chain. labels: physics slow */
#include "tests/sensor/radar_scene.h"

enum { TWO, ONE, WALL };
static const double sphere_m = 0.5, apart_m = 4;
static char         wall_path[128];

static int open_stage(void **state)
{
    (void)state;
    static const char *const model[] = {"two", "one", "wall"};
    scene_folder();
    FILE     *file = scene_obj("two", NULL);
    const int next = scene_sphere(file, 1, sphere_m, 0, apart_m, 0);
    scene_sphere(file, next, sphere_m, 0, -apart_m, 0);
    CHECK(fclose(file) == 0);
    file = scene_obj("one", NULL);
    scene_sphere(file, 1, sphere_m, 0, -apart_m, 0);
    CHECK(fclose(file) == 0);
    file = scene_obj("wall", NULL);
    scene_box(file, "wall", 1, (const double[3]){-0.1, -2.5, -3}, (const double[3]){0.1, 2.5, 3});
    CHECK(fclose(file) == 0);
    scene_open(model, 3);
    /* the wall itself returns nothing to speak of, so that the spheres are alone in the map */
    file = scene_file("dark.csv");
    fputs("x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,0,0,-150,-150\n", file);
    CHECK(fclose(file) == 0);
    file = scene_file("bright.csv");
    fputs("az_deg,el_deg,f_ghz,hh_dbsm,vv_dbsm,hv_dbsm\n-10,0,16.5,6,9,3\n10,0,16.5,8,11,5\n", file);
    CHECK(fclose(file) == 0);
    /* a sphere's cross section, pi a^2, at its front */
    const double dbsm = 10 * log10(pi_rad * sphere_m * sphere_m);
    file = scene_file("both.csv");
    fprintf(file, "x_m,y_m,z_m,hh_dbsm,vv_dbsm\n%g,%g,0,%.9g,%.9g\n%g,%g,0,%.9g,%.9g\n", sphere_m, apart_m, dbsm, dbsm,
            sphere_m, -apart_m, dbsm, dbsm);
    CHECK(fclose(file) == 0);
    file = scene_file("one_point.csv");
    fprintf(file, "x_m,y_m,z_m,hh_dbsm,vv_dbsm\n%g,%g,0,%.9g,%.9g\n", sphere_m, -apart_m, dbsm, dbsm);
    CHECK(fclose(file) == 0);
    file = scene_file("walls.csv");
    fputs("entity,signature\nwall,dark.csv\n1:1:5,bright.csv\n1:1:6,both.csv\n1:1:7,one_point.csv\n", file);
    CHECK(fclose(file) == 0);
    snprintf(wall_path, sizeof wall_path, "%s/walls.csv", stage.folder);
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    scene_close();
    return 0;
}

enum { BOTH, RIGHT_HIDDEN, ALONE, LEFT_HIDDEN, cases };

typedef struct Seen {
    double complex cell; /* of the map, where both peak */
    RadarTruth     truth;
    Detection      found;
} Seen;

/* given: by points in place of the model. */
static void see_cases(Seen seen[cases], SeekerRadar *radar, bool given)
{
    size_t at = 0;
    for (int part = 0; part < cases; part++) {
        stage.snapshot.count = 0;
        SnapshotEntity *e = scene_add(part == ALONE ? ONE : TWO, 0, 0, 0);
        if (given) e->id.entity = part == ALONE ? 7 : 6;
        /* the body's right is south, and covered from 50 m before it */
        if (part == RIGHT_HIDDEN) scene_add(WALL, 50, -0.95 * apart_m, 0)->id.entity = 8;
        if (part == LEFT_HIDDEN) scene_add(WALL, 50, 0.95 * apart_m, 0)->id.entity = 8;
        arena_reset(stage.arena);
        const RadarFrame *f = scene_measure(radar);
        const bool        walled = part == RIGHT_HIDDEN || part == LEFT_HIDDEN;
        CHECK(f->detections > 0 && f->targets == (walled ? 2 : 1));
        CHECK(f->target[0].given == given && (!walled || f->target[1].given));
        seen[part].found = f->detection[0];
        if (part == BOTH) at = (size_t)f->detection[0].row * (size_t)f->map.columns + (size_t)f->detection[0].column;
        seen[part].cell = f->map.cell[at];
        seen[part].truth = f->target[0];
        for (int i = 0; walled && i < f->target[0].strongest_count; i++)
            CHECK(f->target[0].strongest[i].seen ==
                  ((f->target[0].strongest[i].p_body[1] < 0) == (part == RIGHT_HIDDEN)));
    }
    CHECK(seen[BOTH].truth.visible == 1 && seen[ALONE].truth.visible == 1);
    /* as if wholly visible: that of both, whatever hides it */
    CHECK(seen[RIGHT_HIDDEN].truth.rcs_m2[1] == seen[BOTH].truth.rcs_m2[1]);
}

/* Points: the remaining one's cell is that of it alone, and both together are the sum. */
static void the_point_in_sight_keeps_its_field(void **state)
{
    (void)state;
    SeekerRadar *radar = scene_radar("search_ku", wall_path);
    Seen         seen[cases];
    see_cases(seen, radar, true);
    const double complex left = seen[RIGHT_HIDDEN].cell, right = seen[LEFT_HIDDEN].cell, both = seen[BOTH].cell;
    const double         ratio_db = 20 * log10(cabs(left) / cabs(seen[ALONE].cell)),
                 phase_deg = carg(left * conj(seen[ALONE].cell)) / rad_per_deg;
    const double sum_db = 20 * log10(cabs(left + right - both) / cabs(left));
    print_message(
        "one of two points hidden: the other's cell %.4f dB, %.3f deg from that of it alone, %.2f dBsm (pi a^2: %.2f); either and "
        "the other make both to %.0f dB\n",
        ratio_db, phase_deg, 10 * log10(seen[RIGHT_HIDDEN].found.rcs_m2), 10 * log10(pi_rad * sphere_m * sphere_m),
        sum_db);
    CHECK(fabs(ratio_db) < 0.01 && fabs(phase_deg) < 0.1);
    CHECK(sum_db < -40); /* noise is 50 dB below a point */
    CHECK_NEAR(10 * log10(seen[RIGHT_HIDDEN].found.rcs_m2), 10 * log10(pi_rad * sphere_m * sphere_m), 0.1);
    CHECK_NEAR(10 * log10(seen[RIGHT_HIDDEN].truth.snr / seen[ALONE].truth.snr), 0, 1e-3);
    CHECK(seen[RIGHT_HIDDEN].truth.visible == 0.5 && seen[LEFT_HIDDEN].truth.visible == 0.5);
    seeker_radar_destroy(radar);
}

/* A model's: found in the direction of the sphere that is in sight. */
static void the_sphere_in_sight_is_where_it_is(void **state)
{
    (void)state;
    SeekerRadar *radar = scene_radar("search_ku", wall_path);
    Seen         seen[cases];
    see_cases(seen, radar, false);
    const double want = apart_m / scene_range_m;
    print_message(
        "one of two spheres hidden: visible %.3f, %.3f; found %.5f and %.5f to the right, the spheres at %.5f\n",
        seen[RIGHT_HIDDEN].truth.visible, seen[LEFT_HIDDEN].truth.visible, seen[RIGHT_HIDDEN].found.cos_right,
        seen[LEFT_HIDDEN].found.cos_right, want);
    /* the camera looks to the west: its right is north, the body's left */
    CHECK_NEAR(seen[RIGHT_HIDDEN].found.cos_right, want, 0.05 * want);
    CHECK_NEAR(seen[LEFT_HIDDEN].found.cos_right, -want, 0.05 * want);
    CHECK_NEAR(seen[ALONE].found.cos_right, want, 0.05 * want);
    seeker_radar_destroy(radar);
}

static void what_is_wholly_hidden_returns_nothing(void **state)
{
    (void)state;
    SeekerRadar *radar = scene_radar("search_ku", wall_path);
    stage.snapshot.count = 0;
    scene_add(ONE, 0, 0, 0);
    scene_add(WALL, 50, 0.95 * apart_m, 0);
    arena_reset(stage.arena);
    const RadarFrame *f = scene_measure(radar);
    CHECK(f->target[0].visible == 0 && f->target[0].snr == 0 && f->target[0].rcs_m2[1] > 0.1);
    CHECK(f->detections == 0);
    seeker_radar_destroy(radar);
}

/* By its row half way between 9 and 11 dBsm at VV: 10 dBsm; search_ku transmits h: 7 dBsm, cross-polarised 4 dBsm. */
static void a_given_signature_goes_through_the_chain(void **state)
{
    (void)state;
    SeekerRadar *radar = scene_radar("search_ku", wall_path);
    stage.snapshot.count = 0;
    scene_add(ONE, 0, 0, 0)->id = (DisEntityId){1, 1, 5};
    arena_reset(stage.arena);
    const RadarFrame *f = scene_measure(radar);
    CHECK(f->targets == 1 && f->target[0].given && f->target[0].centres == 1 && f->target[0].strongest[0].part == -1);
    CHECK_NEAR(10 * log10(f->target[0].rcs_m2[0]), 7, 1e-6);
    CHECK_NEAR(10 * log10(f->target[0].rcs_m2[1]), 10, 1e-6);
    CHECK_NEAR(10 * log10(f->target[0].rcs_m2[2]), 4, 1e-6);
    CHECK(f->detections > 0);
    CHECK_NEAR(10 * log10(f->detection[0].rcs_m2), 7, 0.2);
    CHECK_NEAR(f->detection[0].range_m, scene_range_m, 0.1);
    CHECK_NEAR(f->detection[0].range_rate_mps, 0, 0.05);
    /* the cross-polarised channel: 3 dB below, in the same cell */
    const size_t at = (size_t)f->detection[0].row * (size_t)f->map.columns + (size_t)f->detection[0].column;
    const size_t plane = (size_t)f->map.rows * (size_t)f->map.columns;
    CHECK_NEAR(20 * log10(cabs(f->map.cell[CHANNEL_CROSS * plane + at]) / cabs(f->map.cell[at])), -3, 0.05);
    /* turned by 90 degrees the table ends, and its model scatters */
    static const double r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    m3_mul(stage.entity[0].r_ecef_from_body, stage.world.frame.r_ecef_from_enu, r_enu_from_body);
    arena_reset(stage.arena);
    f = scene_measure(radar);
    CHECK(!f->target[0].given && f->target[0].centres > 1);
    const double of_model_m2 = f->target[0].rcs_m2[1];
    seeker_radar_destroy(radar);
    radar = scene_radar("search_ku", NULL);
    arena_reset(stage.arena);
    CHECK(scene_measure(radar)->target[0].rcs_m2[1] == of_model_m2);
    seeker_radar_destroy(radar);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_point_in_sight_keeps_its_field),
        cmocka_unit_test(the_sphere_in_sight_is_where_it_is),
        cmocka_unit_test(what_is_wholly_hidden_returns_nothing),
        cmocka_unit_test(a_given_signature_goes_through_the_chain),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
