/* tests/render/signature_cases.h: the estimate of a cross section's error against what a finer grid, at the very look,
 * makes of it. */
#ifndef TESTS_RENDER_SIGNATURE_CASES_H
#define TESTS_RENDER_SIGNATURE_CASES_H

#include "tests/check.h"

#include "render/scattering/field/total_field.h"
#include "render/scattering/field/radar_model.h"
#include "render/scattering/signatures/centres.h"
#include "render/scattering/signatures/signatures.h"

enum { looks = 10 };

typedef struct Case {
    const char *model;
    double      ghz;
    bool        fitted; /* the constant is from here */
} Case;

static RadarMaterials materials;
static Pool          *pool;

/* rms of the errors over their estimates, co-polarised; of all errors, of all estimates, dB; cross: as the result, HV.
 */
static inline double normalised_error(const Case *c, double *rms_db, double *said_db, double *cross)
{
    const double hz = 1e9 * c->ghz;
    RadarModel   model;
    TotalField   used = {0}, finer = {0};
    Signature    signature = {0};
    Centres      centres = {0};
    double       sum = 0, actual = 0, said = 0, cross_sum = 0;
    CHECK(radar_model_open(&model, c->model, &materials, radar_sag_m(hz)) == STATUS_OK);
    radar_target_pose(model.target, NULL, 0);
    for (int i = 0; i < looks; i++) {
        ScatterAntenna antenna, middle;
        ScatterMatrix  got, want;
        SignatureError error;
        TubeConfig     config = tubes_default_config(hz);
        radar_look(&antenna, (11 + 25.3 * i) * rad_per_deg, (5 + i) * rad_per_deg, 2000);
        signature_bin(&middle, &antenna, 0.3 * rad_per_deg);
        config.rays_per_wavelength = 0.5;
        config.splits = 0; /* as signatures are made */
        CHECK(total_field_trace(&used, model.target, &middle, &middle, &config, true, pool) == STATUS_OK);
        CHECK(total_field_sweep(&got, &(FrequencySweep){.count = 1, .first_hz = hz, .tx = &antenna, .rx = &antenna},
                                &used, pool) == STATUS_OK);
        const SignatureCells cells = signature_default_cells(hz, 1, 0.3 * rad_per_deg, 0);
        CHECK(signature_make(&signature, &used, NULL, &cells) == STATUS_OK);
        CHECK(centres_make(&centres, &signature, &antenna, &antenna, NULL) == STATUS_OK);
        signature_error(&error, &centres);
        config.rays_per_radius *= 4;
        config.rays_per_wavelength *= 4;
        CHECK(total_field_trace(&finer, model.target, &antenna, &antenna, &config, true, pool) == STATUS_OK);
        CHECK(total_field_sweep(&want, &(FrequencySweep){.count = 1, .first_hz = hz}, &finer, pool) == STATUS_OK);
        const double complex of[2][2] = {{got.hh, want.hh}, {got.vv, want.vv}};
        for (int p = 0; p < 2; p++) {
            const double off_db = rcs_dbsm(of[p][0]) - rcs_dbsm(of[p][1]),
                         sigma_db = signature_error_db(of[p][0], error.same_m2);
            sum += pow(off_db / sigma_db, 2) / (2 * looks);
            actual += off_db * off_db / (2 * looks);
            said += sigma_db * sigma_db / (2 * looks);
        }
        cross_sum +=
            pow((rcs_dbsm(got.hv) - rcs_dbsm(want.hv)) / signature_error_db(got.hv, error.cross_m2), 2) / looks;
    }
    *rms_db = sqrt(actual);
    *said_db = sqrt(said);
    *cross = sqrt(cross_sum);
    signature_free(&signature);
    centres_free(&centres);
    total_field_free(&used);
    total_field_free(&finer);
    radar_model_close(&model);
    return sqrt(sum);
}

/* Errors over their estimates are about 1 in each case, co- and cross-polarised. */
static inline void judge_estimates(const Case *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        double       rms_db, said_db, cross;
        const double ratio = normalised_error(&cases[i], &rms_db, &said_db, &cross);
        print_message(
            "%s at %g GHz%s: error %.2f dB rms, estimate %.2f; error over estimate %.2f, cross-polarised %.2f\n",
            cases[i].model, cases[i].ghz, cases[i].fitted ? " (fitted)" : "", rms_db, said_db, ratio, cross);
        CHECK(ratio > 0.5 && ratio < 2);
        CHECK(cross > 0.5 && cross < 2);
    }
}

static inline int begin(void **state)
{
    (void)state;
    return radar_materials_load(&materials) == STATUS_OK && pool_create(&pool, 2) == STATUS_OK ? 0 : -1;
}

static inline int end(void **state)
{
    (void)state;
    pool_destroy(pool);
    radar_materials_close(&materials);
    return 0;
}

#endif
