/* Kept fields of targets: bins hold what they should, a field serves its bin to the error stated, and neither order
 * nor lack of room changes a bit. labels: physics */
#include "tests/render/signatures_stage.h"

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
        cmocka_unit_test(bins_are_about_their_middles),
        cmocka_unit_test(lists_are_reused_and_change_no_bit),
        cmocka_unit_test(looks_are_told_apart),
        cmocka_unit_test(each_input_has_a_signature_of_its_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
