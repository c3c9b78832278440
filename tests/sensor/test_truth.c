/* Truth per target, against geometry worked out another way and radiance made to order. */
#include "tests/check.h"

#include "sensor/truth/truth.h"

enum { width = 60, height = 40 };

typedef struct Fixture {
    Catalog       *catalog;
    World          world;
    Snapshot       snapshot;
    SnapshotEntity entity[2];
    RenderRequest  request;
    EyeState       eye;
    Picture        picture;
    TargetPixels   pixels[2];
    uint32_t       id[width * height];
    float          lwir[width * height];
} Fixture;

static Fixture f;

static int open_fixture(void **state)
{
    (void)state;
    char path[text_file_size];
    text_file(path, "type,model,origin\n*.*.*.*.*.*.*,marker,base\n");
    const Status status = catalog_open(&f.catalog, path, 0.01);
    remove(path);
    f.world.catalog = f.catalog;
    return status == STATUS_OK && planck_table_create(&f.world.planck_lwir, 8e-6, 12e-6) == STATUS_OK &&
                   planck_table_create(&f.world.planck_mwir, 3.4e-6, 4.8e-6) == STATUS_OK
               ? 0
               : -1;
}

static int close_fixture(void **state)
{
    (void)state;
    planck_table_destroy(f.world.planck_lwir);
    planck_table_destroy(f.world.planck_mwir);
    catalog_close(f.catalog);
    return 0;
}

/* A place on the Earth with its axes: forward north, right east, down. */
static void pose(SnapshotEntity *e, double lat_deg, double lon_deg, double h_m)
{
    const Geodetic place = {lat_deg * rad_per_deg, lon_deg * rad_per_deg, h_m};
    double         r[9];
    CHECK(ecef_from_geodetic(e->p_ecef, r, &place) == STATUS_OK);
    for (int i = 0; i < 3; i++) {
        e->r_ecef_from_body[3 * i] = r[3 * i + 1];
        e->r_ecef_from_body[3 * i + 1] = r[3 * i];
        e->r_ecef_from_body[3 * i + 2] = -r[3 * i + 2];
    }
}

/* Eye at entity 0 looking at entity 1; both moving. */
static void scene(void)
{
    memset(f.entity, 0, sizeof f.entity);
    f.entity[1].model = catalog_find(f.catalog, f.entity[1].type, &(Origin){ORIGIN_BASE}, NULL);
    pose(&f.entity[0], 36, -123, 500);
    pose(&f.entity[1], 36.01, -122.99, 20);
    static const double v0[3] = {120, -200, 80}, v1[3] = {-5, 7, 3};
    memcpy(f.entity[0].v_ecef_mps, v0, sizeof v0);
    memcpy(f.entity[1].v_ecef_mps, v1, sizeof v1);
    f.snapshot = (Snapshot){.count = 2, .entity = f.entity};
    memcpy(f.eye.p_ecef, f.entity[0].p_ecef, sizeof f.eye.p_ecef);
    memcpy(f.eye.v_ecef_mps, v0, sizeof v0);
    f.eye.host_index = 0;

    /* camera: ahead towards a point somewhat beside the target, upright by the local down */
    double ahead[3], right[3], down[3], down_0[3];
    for (int k = 0; k < 3; k++) {
        ahead[k] = f.entity[1].p_ecef[k] + (k == 0 ? 30 : k == 1 ? -10 : 5) - f.eye.p_ecef[k];
        down_0[k] = f.entity[0].r_ecef_from_body[3 * k + 2];
    }
    v3_normalize(ahead, ahead);
    v3_cross(right, down_0, ahead);
    v3_normalize(right, right);
    v3_cross(down, ahead, right);
    for (int k = 0; k < 3; k++) {
        f.eye.r_ecef_from_cam[3 * k] = right[k];
        f.eye.r_ecef_from_cam[3 * k + 1] = down[k];
        f.eye.r_ecef_from_cam[3 * k + 2] = ahead[k];
    }
    f.request = (RenderRequest){.view = {.width = width, .height = height, .focal_px = 500}, .bands = 1 << BAND_LWIR};
    f.picture = (Picture){.width = width, .height = height, .entity = f.id, .lwir = f.lwir, .target = f.pixels};
    memset(f.pixels, 0, sizeof f.pixels);
    memset(f.id, 0, sizeof f.id);
}

/* Camera components (right, up) of the line of sight's direction at t, both carried on in an inertial frame
 * in which the Earth turns; the camera is held where it was at 0. */
static void sight_at(double right_up[2], double *range_m, double t_s)
{
    static const double earth_rate_rps = 7.292115e-5;
    double              at[2][3], u[3], cam[3];
    for (int i = 0; i < 2; i++) {
        double p[3], centre[3] = {0, 0, i == 1 ? -0.75 : 0}, lever[3];
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

static const TruthNoise noise = {0.01, 0.03, 0.05};

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
        CHECK(t[0].los_el_rad < -0.3 && t[0].los_el_rad > -0.6);
        CHECK_NEAR(t[0].depression_rad, -t[0].los_el_rad, 0);
    }
}

static void contrast_is_the_temperature_difference_that_was_painted(void **state)
{
    (void)state;
    Target t[2];
    scene();
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const bool on = x >= 20 && x < 30 && y >= 10 && y < 16;
            f.id[y * width + x] = on ? 2 : 0;
            f.lwir[y * width + x] =
                (float)planck_band(8e-6, 12e-6, on ? (x < 25 ? 303 : 309) : 300 + (x + y) % 2, NULL);
        }
    f.pixels[1] = (TargetPixels){.visible = 60,
                                 .amodal = 80,
                                 .box = {20, 10, 30, 16},
                                 .amodal_box = {20, 10, 30, 18},
                                 .occluded_ground = 20,
                                 .occluder = -1};
    const double mean = 0.5 * (planck_band(8e-6, 12e-6, 303, NULL) + planck_band(8e-6, 12e-6, 309, NULL));
    f.pixels[1].radiance[picture_lwir] = 60 * mean;
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
    CHECK_NEAR(t[0].visible_fraction, 0.75, 1e-12);
    assert_string_equal(t[0].occluder, "ground");
    const TargetBand *b = &t[0].band[BAND_LWIR];
    /* float radiance: 1e-7 of 38 W/m2/sr over 0.63 W/m2/sr/K is some 1e-5 K */
    CHECK_NEAR(b->contrast_k, 306 - 300.5, 1e-3);
    CHECK_NEAR(b->dt_rss_k, sqrt(5.5 * 5.5 + 9), 1e-3);
    CHECK_NEAR(b->snr, 5.5 / sqrt(0.25 + 0.05 * 0.05), 0.01);
    /* 60 pixels of 1/500 rad at the range */
    CHECK_NEAR(b->intensity_w_sr / (60 * mean * t[0].range_m * t[0].range_m / 250000), 1, 1e-12);
    CHECK(isnan(t[0].band[BAND_MWIR].contrast_k) && isnan(t[0].band[BAND_OPTICAL].snr)); /* not computed: absent */
}

/* Each band over its own noise, on even ground, so that the noise is all that the signal is compared with: 3 K over
 * 0.03 K, 4 K over 0.05 K; a radiance 0.5 above 0.5 over 0.01 in one channel, and over 0.01 / sqrt(3) as the mean of
 * three channels, whose noise is independent. */
static void each_band_has_its_own_noise(void **state)
{
    (void)state;
    static float       mwir[width * height], rgb[3][width * height];
    static const float ground[3] = {0.4f, 0.5f, 0.6f}, painted[3] = {0.8f, 0.9f, 1.3f};
    for (int channels = 1; channels <= 3; channels += 2) {
        Target t[2];
        scene();
        f.picture.mwir = mwir;
        for (int c = 0; c < channels; c++) f.picture.optical[c] = rgb[c];
        for (int i = 0; i < width * height; i++) {
            const int  x = i % width, y = i / width;
            const bool on = x >= 20 && x < 30 && y >= 10 && y < 16;
            f.id[i] = on ? 2 : 0;
            mwir[i] = (float)planck_band(3.4e-6, 4.8e-6, on ? 303 : 300, NULL);
            f.lwir[i] = (float)planck_band(8e-6, 12e-6, on ? 304 : 300, NULL);
            for (int c = 0; c < 3; c++) rgb[c][i] = channels == 1 ? (on ? 1 : 0.5f) : on ? painted[c] : ground[c];
        }
        f.pixels[1] = (TargetPixels){
            .visible = 60, .amodal = 60, .box = {20, 10, 30, 16}, .amodal_box = {20, 10, 30, 16}, .occluder = -1};
        for (int p = 0; p < 3; p++) f.pixels[1].radiance[picture_optical + p] = 7 + 4 * p;
        f.pixels[1].radiance[picture_mwir] = 31;
        f.pixels[1].radiance[picture_lwir] = 53;
        f.request.bands = 1 << BAND_OPTICAL | 1 << BAND_MWIR | 1 << BAND_LWIR;
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        const TargetBand *b = t[0].band;
        CHECK_NEAR(b[BAND_MWIR].contrast_k, 3, 2e-3);
        CHECK_NEAR(b[BAND_LWIR].contrast_k, 4, 2e-3);
        CHECK_NEAR(b[BAND_MWIR].snr, 3 / 0.03, 0.1);
        CHECK_NEAR(b[BAND_LWIR].snr, 4 / 0.05, 0.1);
        CHECK_NEAR(b[BAND_OPTICAL].snr, 0.5 / 0.01 * sqrt(channels), 1e-3);
        CHECK_NEAR(b[BAND_OPTICAL].contrast, 1, 1e-6);
        /* intensities: each band's own sum, and of all channels together, over the square of focal length and range */
        const double per = t[0].range_m * t[0].range_m / 250000;
        CHECK_NEAR(b[BAND_OPTICAL].intensity_w_sr / per, channels == 1 ? 7 : 7 + 11 + 15, 1e-9);
        CHECK_NEAR(b[BAND_MWIR].intensity_w_sr / per, 31, 1e-9);
        CHECK_NEAR(b[BAND_LWIR].intensity_w_sr / per, 53, 1e-9);
        for (int k = 0; k < 4; k++) CHECK(t[0].box[k] == f.pixels[1].box[k]);
    }
}

/* A tenth of a pixel at 320 K, beside another's pixel: mean and variance are its own, the ratio is that of its pixel.
 */
static void a_small_target_is_judged_by_its_samples(void **state)
{
    (void)state;
    static float covered[width * height];
    Target       t[2];
    scene();
    for (int i = 0; i < width * height; i++)
        f.lwir[i] = (float)planck_band(8e-6, 12e-6, 300 + (i % width + i / width) % 2, NULL);
    double       slope;
    const double own = planck_band(8e-6, 12e-6, 320, &slope), ground = f.lwir[10 * width + 20];
    f.lwir[10 * width + 20] = (float)(0.9 * ground + 0.1 * own);
    f.lwir[10 * width + 21] = (float)own;
    covered[10 * width + 20] = 0.1f;
    covered[10 * width + 21] = 0.7f; /* somebody else's: no ring */
    f.picture.covered = covered;
    f.pixels[1] = (TargetPixels){.visible = 0.1,
                                 .amodal = 0.2,
                                 .box = {20, 10, 21, 11},
                                 .amodal_box = {20, 10, 21, 11},
                                 .occluder = -1,
                                 .small = true,
                                 .peak_area = 0.1};
    f.pixels[1].radiance[picture_lwir] = 0.1 * own;
    f.pixels[1].mean[picture_lwir] = own;
    f.pixels[1].variance[picture_lwir] = 9 * slope * slope; /* 3 K about the mean */
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
    const TargetBand *b = &t[0].band[BAND_LWIR];
    CHECK_NEAR(t[0].pixels, 0.1, 1e-12);
    /* a ring of 7 pixels about 20, 10: 3 of 300 K (the other's is one of them and left out), 4 of 301 */
    double ring = 0, square = 0;
    int    n = 0;
    for (int y = 9; y <= 11; y++)
        for (int x = 19; x <= 21; x++)
            if (!(covered[y * width + x] > 0)) {
                const double k = 300 + (x + y) % 2;
                ring += k, square += k * k, n++;
            }
    ring /= n;
    assert_int_equal(n, 7);
    CHECK_NEAR(b->contrast_k, 320 - ring, 1e-3);                          /* float radiance, as above */
    CHECK_NEAR(b->dt_rss_k, sqrt((320 - ring) * (320 - ring) + 9), 0.01); /* the slope changes by 0.1 % over its step */
    CHECK_NEAR(b->snr, 0.1 * (320 - ring) / sqrt(square / n - ring * ring + 0.05 * 0.05), 1e-3);
    CHECK_NEAR(b->intensity_w_sr / (0.1 * own * t[0].range_m * t[0].range_m / 250000), 1, 1e-12);
}

/* Optical: what nothing surrounds is told from darkness by its mean; no contrast is 0, one without noise is not known.
 */
static void a_signal_is_known_without_surroundings_and_without_noise(void **state)
{
    (void)state;
    static float optical[width * height];
    Target       t[2];
    scene();
    f.picture.optical[0] = optical;
    for (int i = 0; i < width * height; i++) f.id[i] = 2, optical[i] = 0.5f;
    f.pixels[1] = (TargetPixels){
        .visible = width * height, .amodal = width * height, .box = {0, 0, width, height}, .occluder = -1};
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
    CHECK_NEAR(t[0].band[BAND_OPTICAL].snr, 0.5 / 0.01, 1e-9);
    CHECK(isnan(t[0].band[BAND_OPTICAL].contrast) && isnan(t[0].band[BAND_LWIR].snr));
    const TruthNoise none = {0, 0, 0};
    f.id[0] = 0; /* one pixel of the same brightness beside it */
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &none), 1);
    CHECK(t[0].band[BAND_OPTICAL].snr == 0);
    optical[0] = 0.25f;
    assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &none), 1);
    CHECK(isnan(t[0].band[BAND_OPTICAL].snr) && t[0].band[BAND_OPTICAL].contrast == 1);
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
        f.picture.instance = NULL; /* a world without plants says nothing of them */
        assert_int_equal(truth_targets(t, &f.picture, &f.world, &f.snapshot, &f.request, &f.eye, &noise), 1);
        CHECK(isnan(t[0].foliage_fraction));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(line_of_sight_and_its_rate_agree_with_differences),
        cmocka_unit_test(azimuth_elevation_and_aspect_have_the_stated_senses),
        cmocka_unit_test(contrast_is_the_temperature_difference_that_was_painted),
        cmocka_unit_test(each_band_has_its_own_noise),
        cmocka_unit_test(a_small_target_is_judged_by_its_samples),
        cmocka_unit_test(a_signal_is_known_without_surroundings_and_without_noise),
        cmocka_unit_test(hidden_targets_are_listed_and_the_host_never),
        cmocka_unit_test(an_occluder_is_named_where_the_fraction_shows_it),
        cmocka_unit_test(plants_hide_a_share_of_a_target),
    };
    return cmocka_run_group_tests(tests, open_fixture, close_fixture);
}
