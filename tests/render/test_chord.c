/* How far the facets of curved surfaces are off them: of a sphere as its own vertices say, of flat faces none.
 * labels: physics */
#include "tests/check.h"

#include "render/scattering/field/radar_model.h"
#include "render/scattering/field/radar_target_private.h"

static void a_sphere_says_its_chord(void **state)
{
    (void)state;
    static const double sag_m[3] = {1e-4, 1e-3, 5e-3};
    for (int i = 0; i < 3; i++) {
        Model        model;
        RadarTarget *target;
        double       farthest_m = 0;
        CHECK(radar_shape_build(&model, "sphere:0.5", sag_m[i]) == STATUS_OK);
        CHECK(radar_target_create(&target, &model, NULL, NULL) == STATUS_OK);
        for (int t = 0; t < model.triangle_count; t++)
            for (int c = 0; c < 3; c++) {
                double middle[3];
                v3_add(middle, model.vertex[model.triangle[t][c]], model.vertex[model.triangle[t][(c + 1) % 3]]);
                farthest_m = fmax(farthest_m, 0.5 - 0.5 * v3_length(middle));
            }
        printf("facets of a sphere, asked for within %g mm: sides up to %.4f mm off, by normals %.4f, %.4f rms\n",
               1e3 * sag_m[i], 1e3 * farthest_m, 1e3 * target->chord_m, 1e3 * target->chord_rms_m);
        CHECK_NEAR(target->chord_m / farthest_m, 1, 0.01);
        CHECK(target->chord_rms_m > 0.3 * farthest_m && target->chord_rms_m < farthest_m);
        radar_target_destroy(target);
        model_destroy(&model);
    }
}

static void flat_faces_have_none(void **state)
{
    (void)state;
    Model        model;
    RadarTarget *target;
    CHECK(radar_shape_build(&model, "trihedral:0.4", 1e-3) == STATUS_OK);
    CHECK(radar_target_create(&target, &model, NULL, NULL) == STATUS_OK);
    CHECK(target->chord_m == 0 && target->chord_rms_m == 0);
    radar_target_destroy(target);
    model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_sphere_says_its_chord),
                                       cmocka_unit_test(flat_faces_have_none)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
