/* Coarse signatures that are prepared are there when they are asked for, and made once. labels: physics */
#include "tests/render/radar_stage.h"

#include "render/scattering/signatures/coarse.h"
#include "render/scattering/signatures/signatures.h"

#include <time.h>

/* What is prepared is there when it is asked for, whatever the range and the joints, and is made once. */
static void prepared_is_there(void **state)
{
    (void)state;
    static const DisEntityType truck = {1, 1, 225, 7, 1, 0, 0};
    const SignaturesConfig     fine = {.frequency_hz = 3e9,
                                       .bandwidth_hz = 2e7,
                                       .aspect_rad = 0.3 * rad_per_deg,
                                       .rays_per_wavelength = 0.5,
                                       .most_octets = 1 << 30,
                                       .isa = "avx2",
                                       .background = true};
    SignaturesConfig           config = signatures_coarse(&fine);
    Catalog                   *catalog;
    RadarMaterials             materials;
    Signatures                *s;
    Origin                     origin;
    char                       path[4096];
    static ScatterAntenna      bin[coarse_most_bins];
    const int                  bins = coarse_bins(bin);
    CHECK(etc_path(path, sizeof path, "catalog.csv") && catalog_open(&catalog, path, coarse_sag_m()) == STATUS_OK);
    const int model = catalog_find(catalog, truck, &origin, NULL);
    CHECK(radar_materials_load(&materials) == STATUS_OK);
    CHECK(signatures_create(&s, &config, catalog, &materials) == STATUS_OK);
    CHECK(signatures_prepare(s, model, 0) == STATUS_OK);
    CHECK(signatures_waiting(s) > 0);
    for (int tries = 0; tries < 3000 && signatures_waiting(s) > 0; tries++) {
        CHECK(signatures_prepare(s, model, 0) == STATUS_OK); /* takes in what was made, and plans nothing twice */
        const uint64_t made = signatures_counters(s).made;
        CHECK(made + (uint64_t)signatures_waiting(s) <= (uint64_t)bins); /* the one being made counts once */
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
    CHECK(signatures_waiting(s) == 0 && signatures_counters(s).made == (uint64_t)bins);
    double joint[256] = {0};
    for (int n = 0; n < catalog_model(catalog, model)->node_count; n++) joint[n] = 0.1;
    for (int i = 0; i < 100; i++) {
        const ScatterAntenna a = antenna_at(360 * random_uniform(3, 0, 0, (uint64_t)i),
                                            44 * random_uniform(3, 1, 0, (uint64_t)i), 100 + 90 * i);
        const SignatureLook  look = signature_look(&a);
        const Signature     *got;
        CHECK(signatures_find(&got, s, model, joint, 0, &look, NULL) == STATUS_OK);
        CHECK(got && got->count > 20 && isinf(got->tx.range_m));
    }
    CHECK(signatures_counters(s).missing == 0 && signatures_counters(s).made == (uint64_t)bins);
    signatures_destroy(s);
    radar_materials_close(&materials);
    catalog_close(catalog);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(prepared_is_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
