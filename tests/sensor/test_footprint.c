/* Boresight and corners on the ground, against triangles on paper. tests/system/test_klv.sh has them marched through an
 * elevation file by another program, and compares them with the range plane. labels: physics */
#include "tests/check.h"

#include "sensor/truth/truth.h"

enum { posts = 65 };
static const double spacing_m = 500, ground_m = 100;

static struct {
    Landscape landscape;
    World     world;
} lab;

/* A plain of 32 km at an ENU height; with a wall along x = 4 km. */
static int lab_open(void **state)
{
    (void)state;
    const Geodetic origin = {-33 * rad_per_deg, -70.5 * rad_per_deg, 500};
    if (local_frame_at(&lab.world.frame, &origin) != STATUS_OK) return -1;
    Elevation   *elevation = &lab.landscape.elevation;
    const double half_m = 0.5 * (posts - 1) * spacing_m;
    if (elevation_level_create(elevation, 0,
                               &(ElevationGrid){posts, posts, -half_m, -half_m, spacing_m, ground_m, 1}) != STATUS_OK)
        return -1;
    for (int j = 0; j < posts; j++) elevation_set_post(&elevation->level[0], 40, j, 900);
    elevation->level_count = 1;
    elevation_build_pyramids(elevation);
    lab.world.landscape = &lab.landscape;
    return 0;
}

static int lab_close(void **state)
{
    (void)state;
    elevation_destroy(&lab.landscape.elevation);
    return 0;
}

/* Looking west or east, turned down; 640 x 480, 20 degrees. */
static View view_at(double height_m, bool west, double down_deg)
{
    const double c = cos(down_deg * rad_per_deg), s = sin(down_deg * rad_per_deg), e = west ? -1 : 1;
    View         view = {.p_enu = {0, 0, height_m},
                         .r_enu_from_cam = {0, -s * e, c * e, -e, 0, 0, 0, -c, -s},
                         .width = 640,
                         .height = 480,
                         .focal_px = view_focal_px(640, 20 * rad_per_deg)};
    return view;
}

/* A point as ENU. */
static void enu_of(double p_enu[3], const GroundPoint *point)
{
    double         p_ecef[3];
    const Geodetic place = {point->lat_rad, point->lon_rad, point->height_m};
    CHECK(point->known);
    assert_int_equal(ecef_from_geodetic(p_ecef, NULL, &place), STATUS_OK);
    enu_from_ecef(p_enu, &lab.world.frame, p_ecef);
}

static void on_a_plain(void **state)
{
    (void)state;
    GroundPoint      out[FOOTPRINT_COUNT];
    const View       view = view_at(2100, true, 30);
    const double     across = tan(10 * rad_per_deg), below = 0.75 * across, c = cos(30 * rad_per_deg);
    static const int side[FOOTPRINT_COUNT][2] = {{0, 0}, {-1, -1}, {1, -1}, {1, 1}, {-1, 1}}; /* right, down */
    truth_footprint(out, &lab.world, &(RenderRequest){.view = view});
    for (int k = 0; k < FOOTPRINT_COUNT; k++) {
        /* per unit along the boresight: falls by sin 30 + y cos 30, goes on by cos 30 - y sin 30 */
        const double x = side[k][0] * across, y = side[k][1] * below;
        const double along = 2000 / (0.5 + y * c);
        double       p_enu[3];
        enu_of(p_enu, &out[k]);
        CHECK_NEAR(p_enu[0], -along * (c - 0.5 * y), 1e-6);
        CHECK_NEAR(p_enu[1], along * x, 1e-6); /* right of west is north */
        CHECK_NEAR(p_enu[2], ground_m, 1e-6);
        CHECK_NEAR(out[k].range_m, along * sqrt(1 + x * x + y * y), 1e-6);
    }
    /* the plane is above the ellipsoid by the origin's height, and by the Earth's curvature */
    const double far_m = 2000 / tan(30 * rad_per_deg);
    CHECK_NEAR(out[FOOTPRINT_CENTRE].height_m, 500 + ground_m + far_m * far_m / (2 * 6.37e6), 0.02);
}

static void the_nearer_ground_counts(void **state)
{
    (void)state;
    GroundPoint out[FOOTPRINT_COUNT];
    double      p_enu[3];
    const View  view = view_at(600, false, 1); /* towards the wall: its foot is 3.5 km away, its top at 1000 m */
    truth_footprint(out, &lab.world, &(RenderRequest){.view = view});
    enu_of(p_enu, &out[FOOTPRINT_CENTRE]);
    CHECK(p_enu[0] > 3500 && p_enu[0] < 4000 && p_enu[2] > 500);
}

static void none_above_the_horizon(void **state)
{
    (void)state;
    GroundPoint out[FOOTPRINT_COUNT];
    View        view = view_at(600, true, 0);
    truth_footprint(out, &lab.world, &(RenderRequest){.view = view});
    CHECK(!out[FOOTPRINT_UPPER_LEFT].known && !out[FOOTPRINT_UPPER_RIGHT].known && !out[FOOTPRINT_CENTRE].known);
    CHECK(out[FOOTPRINT_LOWER_LEFT].known && out[FOOTPRINT_LOWER_RIGHT].known);
    view = view_at(50, true, 30); /* below the ground */
    truth_footprint(out, &lab.world, &(RenderRequest){.view = view});
    for (int k = 0; k < FOOTPRINT_COUNT; k++) CHECK(!out[k].known);
    const World none = {.frame = lab.world.frame};
    view = view_at(2100, true, 30);
    truth_footprint(out, &none, &(RenderRequest){.view = view});
    for (int k = 0; k < FOOTPRINT_COUNT; k++) CHECK(!out[k].known);
}

/* A corner is where the lens shows it: its own projection is the corner. */
static void through_a_lens(void **state)
{
    (void)state;
    static const double corner_px[FOOTPRINT_COUNT][2] = {{320, 240}, {0, 0}, {640, 0}, {640, 480}, {0, 480}};
    GroundPoint         plain[FOOTPRINT_COUNT], out[FOOTPRINT_COUNT];
    View                view = view_at(2100, true, 30);
    const double        k[3] = {-0.8, 0.1, 0}, p[2] = {0.002, -0.001};
    truth_footprint(plain, &lab.world, &(RenderRequest){.view = view});
    assert_int_equal(view_lens_make(&view.lens, k, p, (double[2]){320 / view.focal_px, 240 / view.focal_px}),
                     STATUS_OK);
    truth_footprint(out, &lab.world, &(RenderRequest){.view = view});
    for (int n = 0; n < FOOTPRINT_COUNT; n++) {
        double p_enu[3], d_enu[3], p_cam[3], image_px[2];
        enu_of(p_enu, &out[n]);
        v3_sub(d_enu, p_enu, view.p_enu);
        m3_tmul_v3(p_cam, view.r_enu_from_cam, d_enu);
        view_project(image_px, &view, p_cam);
        CHECK_NEAR(image_px[0], corner_px[n][0], 1e-6);
        CHECK_NEAR(image_px[1], corner_px[n][1], 1e-6);
    }
    CHECK_NEAR(out[FOOTPRINT_CENTRE].range_m, plain[FOOTPRINT_CENTRE].range_m, 1e-6);
    CHECK(out[FOOTPRINT_UPPER_LEFT].range_m > plain[FOOTPRINT_UPPER_LEFT].range_m + 10); /* a barrel shows more */
}

/* Over a plain, on paper: the trapezoid between its corners. */
static void area_of_a_trapezoid(void **state)
{
    (void)state;
    const View   view = view_at(2100, true, 30);
    const double across = tan(10 * rad_per_deg), c = cos(30 * rad_per_deg);
    const double far = 2000 / (0.5 - 0.75 * across * c),
                 near = 2000 / (0.5 + 0.75 * across * c); /* along the boresight */
    const double far_x = far * (c + 0.5 * 0.75 * across), near_x = near * (c - 0.5 * 0.75 * across);
    const double area_m2 = (far_x - near_x) * (far + near) * across;
    CHECK_NEAR(truth_ground_area(&lab.world, &(RenderRequest){.view = view}) / area_m2, 1, 0.005);
}

/* With the horizon in it: the sector of 10 km of slant range, less what is below the image. */
static void area_of_a_sector(void **state)
{
    (void)state;
    const View   view = view_at(300, true, 0);
    const double half = 10 * rad_per_deg, height = 200, reach = sqrt(1e8 - height * height);
    double       area_m2 = 0;
    enum { slices = 4000 }; /* of azimuth: the image's lower edge is straight, at height over the sine of depression */
    for (int k = 0; k < slices; k++) {
        const double azimuth = (-1 + (k + 0.5) * 2 / slices) * half, near = height / (0.75 * tan(half)) / cos(azimuth);
        area_m2 += 0.5 * (reach * reach - near * near) * 2 * half / slices;
    }
    CHECK_NEAR(truth_ground_area(&lab.world, &(RenderRequest){.view = view}) / area_m2, 1, 0.03);
    CHECK(truth_ground_area(&lab.world, &(RenderRequest){.view = view_at(50, true, 30)}) == 0); /* below the ground */
    CHECK(truth_ground_area(&lab.world, &(RenderRequest){.view = view_at(300, true, -40)}) == 0);
    CHECK(truth_ground_area(&(World){.frame = lab.world.frame}, &(RenderRequest){.view = view}) == 0);
}

/* A wall hides what is behind it: from 600 m towards the east less is seen than towards the west. */
static void area_before_a_wall(void **state)
{
    (void)state;
    const double west_m2 = truth_ground_area(&lab.world, &(RenderRequest){.view = view_at(600, true, 4)});
    const double east_m2 = truth_ground_area(&lab.world, &(RenderRequest){.view = view_at(600, false, 4)});
    /* the wall's foot is at 3.5 km, its top at 4 km 900 m high: a sector to where rays meet it */
    const double half = tan(10 * rad_per_deg), near = 500 / tan((4 + 7.5) * rad_per_deg);
    CHECK(west_m2 > 2 * east_m2);
    CHECK(east_m2 < half * (4000.0 * 4000 - near * near * 0.8));
    CHECK(east_m2 > half * (3500.0 * 3500 - near * near * 1.2));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(on_a_plain),
        cmocka_unit_test(the_nearer_ground_counts),
        cmocka_unit_test(none_above_the_horizon),
        cmocka_unit_test(through_a_lens),
        cmocka_unit_test(area_of_a_trapezoid),
        cmocka_unit_test(area_of_a_sector),
        cmocka_unit_test(area_before_a_wall),
    };
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
