/* What a patch without parts about it sees, by the directions of its rays: sky, ground, the ground beneath it; the sun
 * on its points. labels: physics */
#include "tests/check.h"

#include "render/heat/vehicle_load_private.h"

static Patch       patch[2];
static int         body_of[1] = {0}, first_of[2] = {0, 1};
static Patches     cut = {.count = 1, .patch = patch, .bodies = 1, .body_of_part = body_of, .first_of_body = first_of};
static NodePose    node = {.r_body_from_node = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
static Model       model = {.node_count = 1};
static PosedEntity posed = {.box_low = {-2, -1, -1}, .box_high = {3, 1, 1}};

/* Facing east: body x east, y south, z down. All points at one place of the body. */
static PatchPose pose_at(const double p_body[3], double above_m)
{
    for (int p = 0; p < patch_points; p++) memcpy(patch[0].point_node[p], p_body, sizeof patch[0].point_node[p]);
    patch[0].open_share = 1;
    return (PatchPose){.patches = &cut,
                       .model = &model,
                       .posed = &posed,
                       .node = &node,
                       .r_enu_from_body = {1, 0, 0, 0, -1, 0, 0, 0, -1},
                       .above_m = above_m};
}

/* Ray k of 12 of a point: its squared sine is the middle of a twelfth, a quarter before or after it by turns from point
 * to point; about the normal by golden angles from ray to ray, from the cross product of the normal with the axis that
 * it has least of, half of one and a radian more from point to point. The ground beneath is what is met within the box
 * of the body and 0.2 m about it, by one whose base is less than 1.5 m above the ground. */
static void rays_see_sky_and_ground(void **state)
{
    (void)state;
    const double golden_rad = pi_rad * (3 - sqrt(5));
    int          beneath = 0;
    for (int i = 0; i < 1000; i++) {
        const double z = 2 * random_uniform(5, 0, 0, (uint64_t)i) - 1,
                     turned = 7 * random_uniform(5, 1, 0, (uint64_t)i);
        const double n_body[3] = {sqrt(1 - z * z) * cos(turned), sqrt(1 - z * z) * sin(turned), z};
        const double at_body[3] = {4 * random_uniform(5, 2, 0, (uint64_t)i) - 2, 0.5, -0.3};
        const double above_m = 1.6 * random_uniform(5, 3, 0, (uint64_t)i), n[3] = {n_body[0], -n_body[1], -n_body[2]};
        PatchPose    pose = pose_at(at_body, above_m);
        PatchView    view;
        int          sky = 0, under = 0, ground = 0, least = 0;
        double       u[3], v[3];
        for (int p = 0; p < patch_points; p++) memcpy(patch[0].point_n_node[p], n_body, sizeof n_body);
        for (int k = 1; k < 3; k++)
            if (fabs(n[k]) < fabs(n[least])) least = k;
        const int next = (least + 1) % 3, last = (least + 2) % 3; /* n x e: e x e' = e'' */
        u[least] = 0, u[next] = n[last] / hypot(n[next], n[last]), u[last] = -n[next] / hypot(n[next], n[last]);
        for (int k = 0; k < 3; k++) v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
        for (int p = 0; p < patch_points; p++)
            for (int k = 0; k < 12; k++) {
                const double sine2 = (k + 0.5 + (p % 2 ? 0.25 : -0.25)) / 12, a = golden_rad * (k + 0.5 * p) + p;
                double       d[3];
                for (int x = 0; x < 3; x++)
                    d[x] = sqrt(1 - sine2) * n[x] + sqrt(sine2) * (cos(a) * u[x] + sin(a) * v[x]);
                if (d[2] >= 0) {
                    sky++;
                    continue;
                }
                /* 2 mm off the skin, down to the ground; never up to it */
                const double way_m = fmax(0.3 + 0.002 * n[2] + above_m, 0) / -d[2];
                const double x_m = at_body[0] + 0.002 * n[0] + way_m * d[0],
                             y_m = -(-0.5 + 0.002 * n[1] + way_m * d[1]);
                if (above_m < 1.5 && x_m > -2.2 && x_m < 3.2 && y_m > -1.2 && y_m < 1.2) under++;
                else ground++;
            }
        vehicle_view_look(&view, &pose, 0);
        CHECK_NEAR((double)view.sky, sky / 48.0, 1e-5);
        CHECK_NEAR((double)view.under, under / 48.0, 1e-5);
        CHECK_NEAR((double)view.ground, ground / 48.0, 1e-5);
        CHECK(view.partners == 0);
        beneath += under;
    }
    CHECK(beneath > 2000 && beneath < 24000);
}

/* Mean cosine of four points, of which two face away; nothing beyond the last patch is written. */
static void sun_on_points(void **state)
{
    (void)state;
    static const double n_z[patch_points] = {-1, 1, -0.8, 1};
    const double        sun[3] = {0, 0, 1}, below[3] = {0, 0.8, -0.6}, level[3] = {0, 1, 0};
    float               lit[3] = {9, 9, 9};
    PatchPose           pose = pose_at((const double[3]){0, 0, 0}, 0);
    for (int p = 0; p < patch_points; p++)
        patch[0].point_n_node[p][0] = 0, patch[0].point_n_node[p][1] = sqrt(1 - n_z[p] * n_z[p]),
        patch[0].point_n_node[p][2] = n_z[p];
    vehicle_view_sun(lit, &pose, sun, NULL, 0);
    CHECK_NEAR((double)lit[0], (1 + 0.8) / 4, 1e-6);
    vehicle_view_sun(lit, &pose, below, NULL, 0);
    CHECK(lit[0] == 0);
    patch[0].point_n_node[2][1] = -0.6; /* north */
    vehicle_view_sun(lit, &pose, level, NULL, 0);
    CHECK(lit[0] == 0); /* a sun at the horizon gives nothing */
    patch[0].open_share = 0;
    vehicle_view_sun(lit, &pose, sun, NULL, 0);
    CHECK(lit[0] == 0 && lit[1] == 9 && lit[2] == 9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(rays_see_sky_and_ground), cmocka_unit_test(sun_on_points)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
