/* ECEF <-> ENU against the same map in long double, and how fast the Earth falls away. labels: physics */
#include "tests/check.h"

#include "terrain/earth/geodesy.h"

/* The frame evaluated wholly in long double from the angles of its origin. */
typedef struct FrameL {
    long double origin[3], r[9];
} FrameL;

static FrameL frame_l(const Geodetic *g)
{
    const long double f = 1 / 298.257223563L, e2 = f * (2 - f);
    const long double sp = sinl(g->lat_rad), cp = cosl(g->lat_rad), sl = sinl(g->lon_rad), cl = cosl(g->lon_rad);
    const long double n = 6378137.0L / sqrtl(1 - e2 * sp * sp);
    return (FrameL){{(n + g->h_m) * cp * cl, (n + g->h_m) * cp * sl, (n * (1 - e2) + g->h_m) * sp},
                    {-sl, -sp * cl, cp * cl, cl, -sp * sl, cp * sl, 0, cp, sp}};
}

static const double origin_deg[][2] = {{36, -123}, {21.3, -157.9}, {-33.9, 18.4}, {0, 0},
                                       {85, 10},   {12, 180},      {-89.9, -45}};
enum { origins = sizeof origin_deg / sizeof origin_deg[0] };

/* 2 nm: one step of a double of ECEF size in the origin, one in the sum. */
static void agrees_with_long_double_within_2_nm(void **state)
{
    (void)state;
    for (int o = 0; o < origins; o++) {
        const Geodetic g = {origin_deg[o][0] * rad_per_deg, origin_deg[o][1] * rad_per_deg, 123.25};
        const FrameL   want = frame_l(&g);
        LocalFrame     frame;
        CHECK(local_frame_at(&frame, &g) == STATUS_OK);
        for (int n = 0; n < 3000; n++) {
            double p_enu[3], p_ecef[3], back[3];
            for (int k = 0; k < 3; k++) p_enu[k] = 1e5 * (2 * random_uniform(1, (uint32_t)k, (uint32_t)o, n) - 1);
            ecef_from_enu(p_ecef, &frame, p_enu);
            enu_from_ecef(back, &frame, p_ecef);
            for (int k = 0; k < 3; k++) {
                long double ecef = want.origin[k], enu = 0;
                for (int c = 0; c < 3; c++) ecef += want.r[3 * k + c] * p_enu[c];
                for (int c = 0; c < 3; c++) enu += want.r[3 * c + k] * (p_ecef[c] - want.origin[c]);
                CHECK_NEAR((double)(p_ecef[k] - ecef), 0, 2e-9);
                CHECK_NEAR((double)(back[k] - enu), 0, 2e-9);
                CHECK_NEAR(back[k], p_enu[k], 2e-9);
            }
        }
    }
}

static void axes_are_orthonormal_and_right_handed(void **state)
{
    (void)state;
    for (int o = 0; o < origins; o++) {
        const Geodetic g = {origin_deg[o][0] * rad_per_deg, origin_deg[o][1] * rad_per_deg, 0};
        LocalFrame     frame;
        CHECK(local_frame_at(&frame, &g) == STATUS_OK);
        double rtr[9];
        m3_tmul(rtr, frame.r_ecef_from_enu, frame.r_ecef_from_enu);
        for (int k = 0; k < 9; k++) CHECK_NEAR(rtr[k], k % 4 == 0, 4e-16);
        double east[3], north[3], up[3], cross[3];
        for (int k = 0; k < 3; k++) {
            east[k] = frame.r_ecef_from_enu[3 * k];
            north[k] = frame.r_ecef_from_enu[3 * k + 1];
            up[k] = frame.r_ecef_from_enu[3 * k + 2];
        }
        v3_cross(cross, east, north);
        for (int k = 0; k < 3; k++) CHECK_NEAR(cross[k], up[k], 4e-16);
        CHECK_NEAR(v3_dot(up, frame.origin_ecef) > 6e6, 1, 0); /* up is up */
    }
}

/* distance^2 / 2R. The figures are for one R and rounded; the radii of curvature at 36 N are 6357 km northwards and
 * 6386 km eastwards: 0.8 % between them all. */
static void the_ground_falls_below_the_tangent_plane(void **state)
{
    (void)state;
    static const double fall_m[][2] = {{6e3, 2.83}, {8e3, 5.03}, {16e3, 20.1}, {50e3, 197}, {100e3, 786}};
    const Geodetic      origin = {36 * rad_per_deg, -123 * rad_per_deg, 0};
    LocalFrame          frame;
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    for (int n = 0; n < 5; n++)
        for (int along = 0; along < 2; along++) {
            /* walk out on the ellipsoid until the plane distance is right: secant on the angle */
            double angle = fall_m[n][0] / 6371e3, p_enu[3];
            for (int k = 0; k < 20; k++) {
                const Geodetic g = {origin.lat_rad + (along ? angle : 0), origin.lon_rad + (along ? 0 : angle), 0};
                double         p_ecef[3];
                CHECK(ecef_from_geodetic(p_ecef, NULL, &g) == STATUS_OK);
                enu_from_ecef(p_enu, &frame, p_ecef);
                angle *= fall_m[n][0] / hypot(p_enu[0], p_enu[1]);
            }
            CHECK_NEAR(hypot(p_enu[0], p_enu[1]), fall_m[n][0], 1e-3);
            CHECK_NEAR(p_enu[2] / -fall_m[n][1], 1, 0.008);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_long_double_within_2_nm),
        cmocka_unit_test(axes_are_orthonormal_and_right_handed),
        cmocka_unit_test(the_ground_falls_below_the_tangent_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
