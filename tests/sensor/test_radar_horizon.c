/* What a spherical sea hides from a radar: by the horizon of an Earth of 4/3 of its radius. labels: physics */
#include "tests/render/hand_sea.h"

#include "sensor/radar/seeker_radar_private.h"

/* Whether the sea hides a point at up_m over it. */
static bool hides(const RadarShot *shot, double y_m, double up_m)
{
    static const double no_slack_m = 0;
    const double        eye[3] = {0, 0, eye_m}, p[3] = {0, y_m, sea_m(0, y_m) + up_m};
    Sight               to = {.within = true};
    bool                hidden;
    v3_sub(to.d_enu, p, eye);
    to.range_m = v3_length(to.d_enu);
    v3_normalize(to.d_enu, to.d_enu);
    shot_hidden(&hidden, shot, eye, &to, &no_slack_m, 1, -1);
    return hidden;
}

/* Farthest place of a point that is seen. */
static double farthest_of(const RadarShot *shot, double up_m)
{
    double near_m = 30e3, far_m = 60e3;
    for (int n = 0; n < 24; n++) {
        const double middle_m = 0.5 * (near_m + far_m);
        if (hides(shot, middle_m, up_m)) far_m = middle_m;
        else near_m = middle_m;
    }
    return near_m;
}

/* 4.12 km (sqrt(100) + sqrt(up)) with air (Skolnik), 3.57 km of a vacuum: of a mast of 10 m 54.2 and 47.0 km. The
 * gradient between 0 and 100 m is 0.7 % less than at the ground, 0.1 % of these distances; posts are rounded to 8 mm.
 */
static void the_sea_hides(void **state)
{
    (void)state;
    const double     eye[3] = {0, 0, eye_m};
    const RadarScene scene = {.world = &hand.world, .hidden = -1};
    hand_clear();
    arena_reset(hand.arena);
    for (int bent = 0; bent < 2; bent++) {
        Visibility            *v;
        const VisibilityConfig config = {.tracer = hand.world.tracer,
                                         .ground = &hand.landscape,
                                         .frame = &hand.world.frame,
                                         .snapshot = &hand.snapshot,
                                         .eye_enu = {0, 0, eye_m},
                                         .bend_per_m = bent ? world_bend(&hand.world, REFRACTION_RADAR, eye) : 0};
        assert_int_equal(visibility_create_seen(&v, &config, hand.arena), STATUS_OK);
        const RadarShot shot = {.scene = &scene, .visibility = v};
        for (double up_m = 4; up_m < 20; up_m += 6) {
            const double want_m = (bent ? 4120 : 3570) * (sqrt(eye_m) + sqrt(up_m));
            CHECK_NEAR(farthest_of(&shot, up_m), want_m, 0.005 * want_m);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_sea_hides)};
    return cmocka_run_group_tests(tests, open_sea, hand_close);
}
