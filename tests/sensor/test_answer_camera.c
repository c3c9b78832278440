/* What the camera of a frame makes of a line of sight, a point of the image or a place in an answer, held against
 * angles, tangents and lengths on paper, also through a lens. */
#include "tests/sensor/answer_lab.h"

static Answer answer_of(const AnswerDetection *d) { return (Answer){.count = 1, .detection = {*d}}; }

static const AnswerDetection empty = {
    .box_px = {NAN, NAN, NAN, NAN}, .los_rad = {NAN, NAN}, .range_m = NAN, .score = NAN, .point_px = {NAN, NAN}};

/* The camera looks north, level: a direction's tangents in the image are those of its azimuth and elevation. A lens of
 * OpenCV's model moves them by 1 + k1 r^2 + k2 r^4, and p1, p2. */
static void a_line_of_sight_falls_on_a_pixel(void **state)
{
    (void)state;
    static const double deg = 3.141592653589793 / 180, k1 = -0.2, k2 = 0.05, p1 = 0.002, p2 = -0.001;
    for (int lens = 0; lens < 2; lens++)
        for (int n = 0; n < 25; n++) {
            AnswerCamera    camera = camera_north();
            AnswerDetection d = empty;
            const double    az = (4 * (n % 5) - 8) * deg, el = (3 * (n / 5) - 6) * deg; /* NOLINT */
            const double    x = tan(az), y = -tan(el) / cos(az), r2 = x * x + y * y;
            double          image[2] = {x, y};
            if (lens) {
                const double g = 1 + r2 * (k1 + r2 * k2);
                CHECK(view_lens_make(&camera.view.lens, (double[3]){k1, k2, 0}, (double[2]){p1, p2},
                                     (double[2]){0.32, 0.24}) == STATUS_OK);
                image[0] = x * g + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
                image[1] = y * g + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
            }
            d.los_rad[0] = az < 0 ? az + 360 * deg : az, d.los_rad[1] = el;
            Answer answer = answer_of(&d);
            answer_complete(&answer, &camera);
            CHECK_NEAR(answer.detection[0].point_px[0], 32 + 100 * image[0], 1e-9);
            CHECK_NEAR(answer.detection[0].point_px[1], 24 + 100 * image[1], 1e-9);
            CHECK(!answer.detection[0].located && isnan(answer.detection[0].range_m));
            /* and the pixel back to the line of sight */
            AnswerDetection point = empty;
            memcpy(point.point_px, answer.detection[0].point_px, sizeof point.point_px);
            answer = answer_of(&point);
            answer_complete(&answer, &camera);
            CHECK_NEAR(answer.detection[0].los_rad[0], d.los_rad[0], 1e-9);
            CHECK_NEAR(answer.detection[0].los_rad[1], el, 1e-9);
        }
}

static void places_and_ranges(void **state)
{
    (void)state;
    const AnswerCamera camera = camera_north();
    AnswerDetection    d = empty;
    d.located = true, d.place = (Geodetic){0, 0, 1750}; /* straight above */
    Answer answer = answer_of(&d);
    answer_complete(&answer, &camera);
    CHECK_NEAR(answer.detection[0].range_m, 750, 1e-6);
    CHECK_NEAR(answer.detection[0].los_rad[1], 0.5 * 3.141592653589793, 1e-9);
    d = empty; /* straight below, by its line of sight; behind the image's edge */
    d.los_rad[0] = 0, d.los_rad[1] = -0.5 * 3.141592653589793, d.range_m = 400;
    answer = answer_of(&d);
    answer_complete(&answer, &camera);
    CHECK(answer.detection[0].located);
    CHECK_NEAR(answer.detection[0].place.h_m, 600, 1e-6);
    CHECK_NEAR(answer.detection[0].place.lat_rad, 0, 1e-12);
    d.los_rad[0] = 3.141592653589793, d.los_rad[1] = 0.1; /* behind the camera: no point */
    answer = answer_of(&d);
    answer_complete(&answer, &camera);
    CHECK(isnan(answer.detection[0].point_px[0]) && answer.detection[0].located);
    /* a box without more has no line of sight; with a place it has that of the place */
    d = empty;
    d.box_px[0] = d.box_px[1] = 1, d.box_px[2] = d.box_px[3] = 2;
    answer = answer_of(&d);
    answer_complete(&answer, &camera);
    CHECK(isnan(answer.detection[0].los_rad[0]) && isnan(answer.detection[0].point_px[0]));
    d.located = true, d.place = (Geodetic){0, 1e-5, 1000}; /* to the east, 63.8 m away, below the horizontal */
    answer = answer_of(&d);
    answer_complete(&answer, &camera);
    CHECK_NEAR(answer.detection[0].los_rad[0], 0.5 * 3.141592653589793, 1e-9);
    CHECK_NEAR(answer.detection[0].range_m, 1e-5 * (6378137.0 + 1000), 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_of_sight_falls_on_a_pixel),
        cmocka_unit_test(places_and_ranges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
