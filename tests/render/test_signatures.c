/* Kept fields of targets: bins hold what they should, a field serves its bin to the error stated, and neither order
 * nor lack of room changes a bit. labels: physics */
#include "tests/check.h"

#include <time.h>

#include "render/scattering/field/total_field.h"
#include "render/scattering/signatures/signatures.h"

static const double frequency_hz = 5e9, aspect_rad = 0.3 * rad_per_deg;

static ScatterAntenna at(double az_deg, double el_deg, double range_m)
{
    const double   az = az_deg * rad_per_deg, el = el_deg * rad_per_deg;
    ScatterAntenna a = {{cos(el) * cos(az), cos(el) * sin(az), sin(el)}, range_m};
    return a;
}

/* Any direction is within half of a bin's diagonal of its middle, the middle is in its own bin, and ranges are
 * within an eighth of an octave. */
static void bins_are_about_their_middles(void **state)
{
    (void)state;
    double farthest = 0;
    for (int i = 0; i < 20000; i++) {
        const ScatterAntenna a =
            at(360 * random_uniform(1, 0, 0, (uint64_t)i) - 180, 180 * random_uniform(1, 1, 0, (uint64_t)i) - 90,
               pow(10, 1 + 4 * random_uniform(1, 2, 0, (uint64_t)i)));
        ScatterAntenna middle, again;
        double         across[3];
        signature_bin(&middle, &a, aspect_rad);
        signature_bin(&again, &middle, aspect_rad);
        v3_cross(across, middle.u, a.u);
        farthest = fmax(farthest, v3_length(across));
        CHECK(memcmp(&middle, &again, sizeof middle) == 0 ||
              fabs(middle.u[2]) > 1 - 1e-5); /* near a pole azimuths differ by rounding */
        CHECK(fabs(log2(middle.range_m / a.range_m)) <= 0.125 + 1e-12);
        CHECK_NEAR(v3_length(middle.u), 1, 1e-14);
    }
    CHECK(farthest < 0.71 * aspect_rad && farthest > 0.65 * aspect_rad);
}

static Signatures *open(Catalog **catalog, int *model, RadarMaterials *materials, size_t most_octets)
{
    static const DisEntityType truck = {1, 1, 225, 7, 1, 0, 0};
    const SignaturesConfig     config = {.frequency_hz = frequency_hz,
                                         .bandwidth_hz = 5e8,
                                         .aspect_rad = aspect_rad,
                                         .rays_per_wavelength = 1,
                                         .most_octets = most_octets,
                                         .isa = "avx2"};
    Signatures                *s;
    Origin                     origin;
    char                       path[4096];
    CHECK(etc_path(path, sizeof path, "catalog.csv") &&
          catalog_open(catalog, path, radar_sag_m(frequency_hz)) == STATUS_OK);
    *model = catalog_find(*catalog, truck, &origin, NULL);
    CHECK(radar_materials_load(materials) == STATUS_OK);
    CHECK(signatures_create(&s, &config, *catalog, materials) == STATUS_OK);
    return s;
}

static ScatterMatrix look(Signatures *s, int model, const double *joint, const ScatterAntenna *a)
{
    const Signature    *signature;
    const SignatureLook of = signature_look(a);
    Centres             centres = {0};
    ScatterMatrix       m;
    CHECK(signatures_find(&signature, s, model, joint, 0, &of, NULL) == STATUS_OK);
    CHECK(centres_make(&centres, signature, a, a, NULL) == STATUS_OK);
    centres_field(&m, &centres, frequency_hz);
    centres_free(&centres);
    return m;
}

static void lists_are_reused_and_change_no_bit(void **state)
{
    (void)state;
    Catalog         *catalog;
    RadarMaterials   materials;
    int              model;
    Signatures      *s = open(&catalog, &model, &materials, 1), *roomy; /* one list alone, or all */
    SignaturesConfig config = {.frequency_hz = frequency_hz,
                               .bandwidth_hz = 5e8,
                               .aspect_rad = aspect_rad,
                               .rays_per_wavelength = 1,
                               .most_octets = 1 << 30,
                               .isa = "avx2"};
    CHECK(signatures_create(&roomy, &config, catalog, &materials) == STATUS_OK);
    ScatterMatrix first[6], again[6], other[6];
    for (int i = 0; i < 6; i++) {
        const ScatterAntenna a = at(20 + 0.2 * i, 15, 2000);
        first[i] = look(s, model, NULL, &a);
        other[5 - i] = (ScatterMatrix){0};
    }
    for (int i = 5; i >= 0; i--) {
        const ScatterAntenna a = at(20 + 0.2 * i, 15, 2000);
        other[i] = look(roomy, model, NULL, &a);
    }
    for (int i = 0; i < 6; i++) {
        const ScatterAntenna a = at(20 + 0.2 * i, 15, 2000);
        again[i] = look(s, model, NULL, &a);
    }
    CHECK(memcmp(first, again, sizeof first) == 0 && memcmp(first, other, sizeof first) == 0);
    CHECK(signatures_counters(roomy).made < 6 && signatures_counters(roomy).made >= 3);
    CHECK(signatures_counters(roomy).dropped == 0 && signatures_counters(s).dropped > 3);

    /* wheels do not make another list, other joints do */
    const Model   *of = catalog_model(catalog, model);
    double         joint[256] = {0};
    const uint64_t made = signatures_counters(roomy).made;
    int            wheels = 0, others = -1;
    CHECK(of->node_count <= 256);
    for (int n = 0; n < of->node_count; n++) {
        if (of->node[n].roll_radius_m > 0) joint[n] = 1, wheels++;
        else if (n > 0) others = n;
    }
    const ScatterAntenna a = at(20, 15, 2000);
    const ScatterMatrix  rolled = look(roomy, model, joint, &a);
    CHECK(wheels > 0 && signatures_counters(roomy).made == made && memcmp(&rolled, &first[0], sizeof rolled) == 0);
    if (others >= 0) {
        joint[others] = 0.3;
        look(roomy, model, joint, &a);
        CHECK(signatures_counters(roomy).made == made + 1);
    }
    signatures_destroy(s);
    signatures_destroy(roomy);
    radar_materials_close(&materials);
    catalog_close(catalog);
}

/* Looks that differ by receiver, by what is an image or by the ground have lists of their own; a ground that is the
 * same within its bin has not, and none counts where nothing is an image. */
static void looks_are_told_apart(void **state)
{
    (void)state;
    Catalog             *catalog;
    RadarMaterials       materials;
    int                  model;
    Signatures          *s = open(&catalog, &model, &materials, 1 << 30);
    SignatureLook        look_of[7];
    const ScatterAntenna a = at(20, 15, 2000), below = at(20, -15, 2000);
    for (int i = 0; i < 7; i++)
        look_of[i] =
            (SignatureLook){.tx = a, .rx = i == 0 ? a : below, .image = {false, i > 1}, .plane = {{0, 0, -1}, 0.5}};
    look_of[3].plane.height_m = 0.505;
    look_of[4].plane.height_m = 0.55;
    look_of[5].plane.n[0] = sin(3 * rad_per_deg), look_of[5].plane.n[2] = -cos(3 * rad_per_deg);
    look_of[6].image[1] = false;
    static const unsigned made[7] = {1, 2, 3, 3, 4, 5, 5};
    for (int i = 0; i < 7; i++) {
        const Signature *signature;
        CHECK(signatures_find(&signature, s, model, NULL, 0, &look_of[i], NULL) == STATUS_OK);
        CHECK(signatures_counters(s).made == made[i]);
    }
    signatures_destroy(s);
    radar_materials_close(&materials);
    catalog_close(catalog);
}

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

/* A store that has everything: a signature without centres. It remembers what it was asked for. */
typedef struct Asked {
    int         count, damage;
    const char *model;
    double      joint, range_m[2];
} Asked;

static bool fetch_anything(void *user, Signature *out, const SignatureKey *key)
{
    Asked *asked = user;
    *asked = (Asked){asked->count + 1,
                     key->damage,
                     key->model->name,
                     key->joint[key->model->node_count - 1],
                     {key->look.tx.range_m, key->look.rx.range_m}};
    *out = (Signature){.tx = key->look.tx, .rx = key->look.rx, .centre = calloc(1, sizeof *out->centre)};
    return true;
}

/* What is asked for again is at hand; each input that alone is another is asked of the store, and by its own key:
 * model, damage, the last joint, either antenna's direction and range. */
static void each_input_has_a_signature_of_its_own(void **state)
{
    (void)state;
    static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0};
    Catalog                   *catalog;
    RadarMaterials             materials;
    int                        model;
    Origin                     origin;
    Asked                      asked = {0};
    Signatures                *s = open(&catalog, &model, &materials, 1 << 30), *stored;
    const SignaturesConfig     config = {.frequency_hz = frequency_hz,
                                         .bandwidth_hz = 5e8,
                                         .aspect_rad = aspect_rad,
                                         .most_octets = 1 << 30,
                                         .store = {.user = &asked, .fetch = fetch_anything},
                                         .isa = "avx2"};
    signatures_destroy(s);
    CHECK(signatures_create(&stored, &config, catalog, &materials) == STATUS_OK);
    const int other = catalog_find(catalog, tank, &origin, NULL);
    CHECK(other != model);
    static double joint[2][512];
    for (int m = 0; m < 2; m++) {
        const Model *of = catalog_model(catalog, m ? other : model);
        int          last = of->node_count - 1;
        while (last > 0 && of->node[last].roll_radius_m > 0) last--;
        CHECK(of->node_count <= 512);
        if (m == 1) CHECK(last > 0);
        joint[m][last] = 0.25;
    }
    const ScatterAntenna near = at(20, 15, 2000), far = at(20, 15, 3000), beside = at(21, 15, 2000),
                         above = at(20, 16, 2000);
    const struct {
        int                   model, damage;
        const double         *joint;
        const ScatterAntenna *tx, *rx;
    } ask[] = {{model, 0, NULL, &near, &near},    {model, 1, NULL, &near, &near},    {model, 3, NULL, &near, &near},
               {other, 0, NULL, &near, &near},    {other, 3, NULL, &near, &near},    {other, 3, joint[1], &near, &near},
               {other, 3, joint[1], &far, &near}, {other, 3, joint[1], &near, &far}, {model, 0, NULL, &beside, &near},
               {model, 0, NULL, &near, &beside},  {model, 0, NULL, &above, &near},   {model, 0, NULL, &near, &above}};
    enum { asks = sizeof ask / sizeof *ask };
    for (int round = 0; round < 2; round++)
        for (int i = 0; i < asks; i++) {
            const Signature    *got;
            const SignatureLook of = {.tx = *ask[i].tx, .rx = *ask[i].rx};
            CHECK(signatures_find(&got, stored, ask[i].model, ask[i].joint, ask[i].damage, &of, NULL) == STATUS_OK);
            CHECK(asked.count == (round == 0 ? i + 1 : asks));
            CHECK(fabs(log2(got->tx.range_m / ask[i].tx->range_m)) < 0.13 &&
                  fabs(log2(got->rx.range_m / ask[i].rx->range_m)) < 0.13);
            CHECK_NEAR(v3_dot(got->tx.u, ask[i].tx->u), 1, 2e-5); /* within half a bin's diagonal: 0.0037 rad */
            CHECK_NEAR(v3_dot(got->rx.u, ask[i].rx->u), 1, 2e-5);
            if (round > 0) continue;
            CHECK(asked.damage == ask[i].damage);
            assert_string_equal(asked.model, catalog_model(catalog, ask[i].model)->name);
        }
    CHECK(signatures_counters(stored).fetched == asks && signatures_counters(stored).reused == asks);
    CHECK(signatures_counters(stored).made == 0);
    signatures_destroy(stored);
    radar_materials_close(&materials);
    catalog_close(catalog);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bins_are_about_their_middles), cmocka_unit_test(lists_are_reused_and_change_no_bit),
        cmocka_unit_test(looks_are_told_apart),         cmocka_unit_test(background_makes_the_same),
        cmocka_unit_test(a_list_serves_its_bin),        cmocka_unit_test(each_input_has_a_signature_of_its_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
