/* Signatures over their bins and from the background thread: the same as those made at once. labels: physics slow */
#include "tests/render/signatures_stage.h"

/* In the background there is none at first, and then the one that is made on the spot, to the bit. What is asked for
 * last is made first; the same is not asked for twice. */
static void background_makes_the_same(void **state)
{
    (void)state;
    Catalog         *catalog;
    RadarMaterials   materials;
    int              model;
    Signatures      *s = open(&catalog, &model, &materials, 1 << 30), *later;
    SignaturesConfig config = {.frequency_hz = frequency_hz,
                               .bandwidth_hz = 5e8,
                               .aspect_rad = aspect_rad,
                               .rays_per_wavelength = 1,
                               .most_octets = 1 << 30,
                               .isa = "avx2",
                               .background = true};
    const Signature *want[3], *got = NULL;
    CHECK(signatures_create(&later, &config, catalog, &materials) == STATUS_OK);
    for (int round = 0; round < 2; round++)
        for (int i = 0; i < 3; i++) {
            const ScatterAntenna a = at(20 + i, 15, 2000);
            const SignatureLook  look_of = signature_look(&a);
            CHECK(signatures_find(&got, later, model, NULL, 0, &look_of, NULL) == STATUS_OK);
            CHECK(got == NULL || round == 1 || i > 0);
        }
    CHECK(signatures_waiting(later) <= 3 && signatures_counters(later).missing >= 3);
    for (int tries = 0; tries < 3000 && signatures_waiting(later) > 0; tries++)
        nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    for (int i = 0; i < 3; i++) {
        const ScatterAntenna a = at(20 + i, 15, 2000);
        const SignatureLook  look_of = signature_look(&a);
        CHECK(signatures_find(&want[i], s, model, NULL, 0, &look_of, NULL) == STATUS_OK);
        CHECK(signatures_find(&got, later, model, NULL, 0, &look_of, NULL) == STATUS_OK);
        CHECK(got && got->count > 100 && got->count == want[i]->count);
        CHECK(memcmp(got->centre, want[i]->centre, (size_t)got->count * sizeof *got->centre) == 0);
    }
    CHECK(signatures_counters(later).made == 3);
    signatures_destroy(s);
    signatures_destroy(later);
    radar_materials_close(&materials);
    catalog_close(catalog);
}

/* Against lists made for each look itself, beside what another turn of their own grid of tubes changes: rms over looks,
 * over the rms field. Reuse adds nothing that is seen beside the grid's own error. */
static void a_list_serves_its_bin(void **state)
{
    (void)state;
    Catalog       *catalog;
    RadarMaterials materials;
    int            model;
    Signatures    *s = open(&catalog, &model, &materials, 1 << 30);
    double         error = 0, grid = 0, power = 0;
    TotalField     own = {0};
    RadarTarget   *target;
    CHECK(radar_target_create(&target, catalog_model(catalog, model), &materials, "avx2") == STATUS_OK);
    for (int i = 0; i < 6; i++) {
        const ScatterAntenna a = at(60 * i + 0.28 * random_uniform(2, 0, 0, (uint64_t)i),
                                    12.05 + 0.2 * random_uniform(2, 1, 0, (uint64_t)i), 2000);
        const ScatterMatrix  got = look(s, model, NULL, &a);
        ScatterMatrix        want[2];
        for (int turned = 0; turned < 2; turned++) {
            TubeConfig tubes = tubes_default_config(frequency_hz);
            tubes.splits = 0;
            tubes.seed = (uint64_t)turned;
            CHECK(total_field_trace(&own, target, &a, &a, &tubes, true, NULL) == STATUS_OK);
            CHECK(total_field_sweep(&want[turned], &(FrequencySweep){.count = 1, .first_hz = frequency_hz}, &own,
                                    NULL) == STATUS_OK);
        }
        error += pow(cabs(got.vv - want[0].vv), 2) + pow(cabs(got.hh - want[0].hh), 2);
        grid += pow(cabs(want[1].vv - want[0].vv), 2) + pow(cabs(want[1].hh - want[0].hh), 2);
        power += pow(cabs(want[0].vv), 2) + pow(cabs(want[0].hh), 2);
    }
    printf("a truck at 5 GHz, from lists of bins of 0.3 degrees: %.1f dB; another turn of the grid: %.1f dB\n",
           10 * log10(error / power), 10 * log10(grid / power));
    CHECK(error < 1.5 * grid);
    total_field_free(&own);
    radar_target_destroy(target);
    signatures_destroy(s);
    radar_materials_close(&materials);
    catalog_close(catalog);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(background_makes_the_same),
        cmocka_unit_test(a_list_serves_its_bin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
