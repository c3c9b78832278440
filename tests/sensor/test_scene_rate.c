/* The scene's motion against where a point at rest is projected a moment before and after. labels: physics */
#include "tests/check.h"

#include "render/scene/view.h"
#include "sensor/node/session/seeker_private.h"

/* Rotation by an angle about a unit axis, Rodrigues. */
static void rotation(double r[9], const double axis[3], double angle_rad)
{
    const double c = cos(angle_rad), s = sin(angle_rad);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int k = 3 - i - j; /* the third axis, where i and j differ */
            r[3 * i + j] = (i == j ? c : ((j - i + 3) % 3 == 1 ? -1 : 1) * s * axis[k]) + (1 - c) * axis[i] * axis[j];
        }
}

static void a_point_at_rest_moves_as_projected(void **state)
{
    (void)state;
    static const double cases[][7] = {/* turn, velocity in world axes, range */
                                      {0.2, 0, 0, 0, 0, 0, 1000},
                                      {0, 0.3, 0, 0, 0, 0, 1000},
                                      {0, 0, 1, 0, 0, 0, 1000},
                                      {0, 0, 0, 40, 0, 0, 500},
                                      {0, 0, 0, 0, -30, 0, 500},
                                      {0, 0, 0, 0, 0, 300, 2000},
                                      {0.1, -0.2, 0.4, 250, -60, 90, 800},
                                      {0.1, -0.2, 0.4, 250, -60, 90, INFINITY}};
    static const double lean[3] = {0.6, -0.64, 0.48};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const double *w = cases[k], *v = cases[k] + 3, focal_px = 3000;
        const double  range_m = isfinite(cases[k][6]) ? cases[k][6] : 1e13;
        const double  speed = v3_length(w), h_s = 1e-4;
        double        middle[9], at[2][2], attitude[2][9], axis[3] = {1, 0, 0}, p[3], v_cam[3], got[2], rate[3];
        if (speed > 0) v3_scale(axis, 1 / speed, w);
        rotation(middle, lean, 0.7);
        for (int i = 0; i < 3; i++) p[i] = range_m * middle[3 * i + 2]; /* on the boresight at the middle */
        for (int side = 0; side < 2; side++) {
            const double t_s = side ? h_s : -h_s;
            double       turned[9], away[3], cam[3];
            rotation(turned, axis, speed * t_s); /* in camera axes: world_from_cam = middle x turned */
            m3_mul(attitude[side], middle, turned);
            for (int i = 0; i < 3; i++) away[i] = p[i] - v[i] * t_s;
            m3_tmul_v3(cam, attitude[side], away);
            at[side][0] = focal_px * cam[0] / cam[2];
            at[side][1] = focal_px * cam[1] / cam[2];
        }
        seeker_turn_rate(rate, attitude[0], attitude[1], 2 * h_s);
        for (int i = 0; i < 3; i++) CHECK_NEAR(rate[i], w[i], 1e-8); /* w^3 (2 h)^2 / 6 */
        m3_tmul_v3(v_cam, middle, v);
        seeker_scene_rate(got, rate, v_cam, focal_px, cases[k][6]);
        /* second-order difference: third derivatives x h^2, and 1e-16 x focal / h */
        for (int i = 0; i < 2; i++) CHECK_NEAR(got[i], (at[1][i] - at[0][i]) / (2 * h_s), 1e-4);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_point_at_rest_moves_as_projected)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
