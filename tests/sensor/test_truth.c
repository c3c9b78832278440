/* Truth per target, against geometry worked out another way. What bands say of it: test_truth_bands.c. */
#include "tests/sensor/truth_stage.h"

/* Camera components (right, up) of the line of sight's direction at t, both carried on in an inertial frame
 * in which the Earth turns; the camera is held where it was at 0. The target turns about its origin: its middle, 0.75 m
 * above that, moves by the angle times the lever. */
static void sight_at(double right_up[2], double *range_m, double t_s)
{
    static const double earth_rate_rps = 7.292115e-5;
    double              at[2][3], u[3], cam[3];
    for (int i = 0; i < 2; i++) {
        double p[3], centre[3] = {0, 0, i == 1 ? -0.75 : 0}, lever[3];
        if (i == 1)
            centre[0] = t_s * f.entity[1].w_body_rps[1] * -0.75, centre[1] = t_s * f.entity[1].w_body_rps[0] * 0.75;
        m3_mul_v3(lever, f.entity[i].r_ecef_from_body, centre);
        for (int k = 0; k < 3; k++) p[k] = f.entity[i].p_ecef[k] + lever[k] + f.entity[i].v_ecef_mps[k] * t_s;
        const double c = cos(earth_rate_rps * t_s), s = sin(earth_rate_rps * t_s);
        at[i][0] = c * p[0] - s * p[1];
        at[i][1] = s * p[0] + c * p[1];
        at[i][2] = p[2];
    }
    v3_sub(u, at[1], at[0]);
    *range_m = v3_length(u);
    v3_normalize(u, u);
    m3_tmul_v3(cam, f.eye.r_ecef_from_cam, u);
    right_up[0] = cam[0];
    right_up[1] = -cam[1];
}

static void line_of_sight_and_its_rate_agree_with_differences(void **state)
{
    (void)state;
    Target t[2];
    double before[2], now[2], after[2], range_before, range, range_after;
    scene();
    f.pixels[1].projected = true;
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
    assert_int_equal(t[0].index, 1);
    const double dt_s = 0.001;
    sight_at(before, &range_before, -dt_s);
    sight_at(now, &range, 0);
    sight_at(after, &range_after, dt_s);
    CHECK_NEAR(t[0].range_m, range, 1e-6);
    /* third derivative x dt^2 / 6: some 7 m/s3, 1e-6 m/s; rounding of 1e-9 m of position over dt: the same */
    CHECK_NEAR(t[0].closing_mps, (range_before - range_after) / (2 * dt_s), 1e-5);
    /* the same two, over the range: below 1e-9 rad/s */
    for (int k = 0; k < 2; k++) CHECK_NEAR(t[0].los_rate_rps[k], (after[k] - before[k]) / (2 * dt_s), 1e-8);
    for (int k = 0; k < 2; k++)
        CHECK_NEAR(tan(t[0].boresight_error_rad[k]), now[k] / sqrt(1 - now[0] * now[0] - now[1] * now[1]), 1e-12);
    CHECK(fabs(t[0].los_rate_rps[0]) > 1e-2); /* the case is not a trivial one */
    CHECK(isnan(t[0].visible_fraction));
}

static void azimuth_elevation_and_aspect_have_the_stated_senses(void **state)
{
    (void)state;
    static const struct {
        double dlat, dlon, az_deg, aspect_deg;
    } where[] = {{0.01, 0, 0, 180}, {0, 0.01, 90, 270}, {-0.01, 0, 180, 0}, {0, -0.01, 270, 90}};
    for (size_t i = 0; i < sizeof where / sizeof where[0]; i++) {
        Target t[2];
        scene();
        pose(&f.entity[1], 36 + where[i].dlat, -123 + where[i].dlon, 20); /* its nose is north */
        f.pixels[1].projected = true;
        truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise);
        CHECK_NEAR(remainder(t[0].los_az_rad / rad_per_deg - where[i].az_deg, 360), 0, 0.01);
        CHECK_NEAR(remainder(t[0].aspect_rad / rad_per_deg - where[i].aspect_deg, 360), 0, 0.02);
        CHECK(t[0].los_az_rad >= 0 && t[0].los_az_rad < 2 * pi_rad && t[0].aspect_rad >= 0 &&
              t[0].aspect_rad < 2 * pi_rad);
        CHECK(t[0].los_el_rad < -0.3 && t[0].los_el_rad > -0.6);
        CHECK_NEAR(t[0].depression_rad, -t[0].los_el_rad, 0);
    }
    /* On the meridian of 0 nothing is east or west of it, exactly: north is 0, not a whole turn, and so is nose on. */
    for (int north = 0; north < 2; north++) {
        Target t[2];
        scene();
        pose(&f.entity[0], 0, 0, 500);
        pose(&f.entity[1], north ? 0.01 : -0.01, 0, 20);
        memcpy(f.eye.p_ecef, f.entity[0].p_ecef, sizeof f.eye.p_ecef);
        f.pixels[1].projected = true;
        truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise);
        CHECK(north ? t[0].los_az_rad == 0 : t[0].aspect_rad == 0);
    }
}

static void hidden_targets_are_listed_and_the_host_never(void **state)
{
    (void)state;
    Target t[2];
    scene();
    f.pixels[0] = (TargetPixels){.visible = 10, .amodal = 10, .projected = true};
    f.pixels[1] = (TargetPixels){.amodal = 12,
                                 .projected = true,
                                 .projected_box = {1, 2, 3, 4},
                                 .occluded_entity = 12,
                                 .occluder = 0,
                                 .amodal_box = {1, 2, 3, 4}};
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
    CHECK(t[0].index == 1 && t[0].pixels == 0 && t[0].visible_fraction == 0);
    CHECK(t[0].occluder_index == 0);
    CHECK(isnan(t[0].band[BAND_LWIR].contrast_k));
    f.pixels[1] = (TargetPixels){.occluder = -1}; /* outside the picture */
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 0);
}

/* The fraction is 1 just where no occluder is named, to two decimals as well: on a sweep of hidden shares, with ground,
 * another entity or both in the way, of targets of 0.01 to 10000 px. */
static void an_occluder_is_named_where_the_fraction_shows_it(void **state)
{
    (void)state;
    for (double amodal = 0.01; amodal < 2e4; amodal *= 10)
        for (int k = 0; k <= 1000; k++)
            for (int way = 0; way < 3; way++) {
                const double hidden = amodal * k / 1000, by_ground = way == 0 ? hidden : way == 1 ? 0 : 0.3 * hidden;
                Target       t[2];
                scene();
                f.pixels[1] = (TargetPixels){.projected = true,
                                             .visible = amodal - hidden,
                                             .amodal = amodal,
                                             .occluded_ground = by_ground,
                                             .occluded_entity = hidden - by_ground,
                                             .occluder = way == 0 ? -1 : 0};
                assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
                CHECK(t[0].visible_fraction >= 0 && t[0].visible_fraction <= 1);
                CHECK((t[0].visible_fraction == 1) == (t[0].occluder == NULL));
                CHECK((rint(100 * t[0].visible_fraction) == 100) == (t[0].occluder == NULL));
                CHECK((t[0].occluder != NULL) == (k >= 10));
                if (k > 10) CHECK_NEAR(t[0].visible_fraction, 1 - k / 1000.0, 1e-9);
                if (k > 10)
                    CHECK(strcmp(t[0].occluder, way == 0 ? "ground" : "entity") == 0 &&
                          t[0].occluder_index == (way == 0 ? -1 : 0));
            }
}

/* A pixel's area of trees before the target: the share, and who is named, by whichever hides most. */
static void plants_hide_a_share_of_a_target(void **state)
{
    (void)state;
    static const struct {
        double      ground, entity, trees;
        const char *by;
    } in_the_way[] = {{0, 0, 6, "trees"},  {3, 2, 4, "trees"}, {4, 2, 3, "ground"},
                      {2, 4, 3, "entity"}, {0, 0, 0.1, NULL},  {5, 0, 0, "ground"}};
    static uint32_t instance[width * height];
    for (size_t i = 0; i < sizeof in_the_way / sizeof *in_the_way; i++) {
        const double ground = in_the_way[i].ground, entity = in_the_way[i].entity, trees = in_the_way[i].trees;
        Target       t[2];
        scene();
        f.picture.instance = instance;
        f.world.forest = (Forest *)instance; /* that there is one: foliage counts */
        f.pixels[1] = (TargetPixels){.projected = true,
                                     .visible = 12 - ground - entity - trees,
                                     .amodal = 12,
                                     .occluded_ground = ground,
                                     .occluded_entity = entity,
                                     .occluded_plants = trees,
                                     .occluder = entity > 0 ? 0 : -1};
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        CHECK_NEAR(t[0].foliage_fraction, trees / 12, 1e-12);
        CHECK_NEAR(t[0].visible_fraction, in_the_way[i].by ? 1 - (ground + entity + trees) / 12 : 1, 1e-12);
        CHECK(in_the_way[i].by ? t[0].occluder && strcmp(t[0].occluder, in_the_way[i].by) == 0 : !t[0].occluder);
        CHECK(t[0].occluder_index == (in_the_way[i].by && *in_the_way[i].by == 'e' ? 0 : -1));
        f.picture.instance = NULL, f.world.forest = NULL; /* a world without plants says nothing of them */
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        CHECK(isnan(t[0].foliage_fraction));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(line_of_sight_and_its_rate_agree_with_differences),
        cmocka_unit_test(azimuth_elevation_and_aspect_have_the_stated_senses),
        cmocka_unit_test(hidden_targets_are_listed_and_the_host_never),
        cmocka_unit_test(an_occluder_is_named_where_the_fraction_shows_it),
        cmocka_unit_test(plants_hide_a_share_of_a_target),
    };
    return cmocka_run_group_tests(tests, open_fixture, close_fixture);
}
