/* tests/bench/sensor/precision_coarse.c: coarse signatures of targets (render/scattering/signatures/coarse.h) beside
 * fine ones: the time of one, and how far the cross section's mean is off. */
#include "tests/bench/sensor/precision.h"

#include "render/scattering/signatures/coarse.h"
#include "render/scattering/signatures/signatures.h"
#include "sensor/radar/seeker_radar.h"

enum { looks = 12, near_each = 20 };
static const DisEntityType tank_type = {1, 1, 222, 1, 1, 1, 0};
static const double        frequency_hz = 16.5e9;

typedef struct Kind {
    Catalog       *catalog;
    RadarMaterials materials;
    Signatures    *signatures;
    int            model, turn;
    Status         status;
} Kind;

static ScatterAntenna antenna_of(int look, int near)
{
    const double az = 2 * pi_rad * random_uniform(3, 0, 0, (uint64_t)look) + 0.1 * rad_per_deg * near / near_each;
    const double el = (40 * random_uniform(3, 1, 0, (uint64_t)look) + 0.1 * near / near_each) * rad_per_deg;
    return (ScatterAntenna){{cos(el) * cos(az), cos(el) * sin(az), -sin(el)}, 2000}; /* from above */
}

/* Mean of VV over a tenth of a degree, m2. */
static double mean_of(Kind *kind, int look)
{
    Centres centres = {0};
    double  mean = 0;
    for (int i = 0; i < near_each && kind->status == STATUS_OK; i++) {
        const ScatterAntenna antenna = antenna_of(look, i);
        const SignatureLook  of = signature_look(&antenna);
        const Signature     *signature;
        ScatterMatrix        s = {0};
        kind->status = signatures_find(&signature, kind->signatures, kind->model, NULL, 0, &of, NULL);
        if (kind->status == STATUS_OK) kind->status = centres_make(&centres, signature, &antenna, &antenna, NULL);
        if (kind->status == STATUS_OK) centres_field(&s, &centres, frequency_hz);
        mean += 4 * pi_rad * scatter_power(s.vv) / near_each;
    }
    centres_free(&centres);
    return mean;
}

/* Makes one: the room is for one alone, and every look is of another bin. */
static void make_one(void *user)
{
    Kind                *kind = user;
    const ScatterAntenna antenna = antenna_of(kind->turn++ % looks, 0);
    const SignatureLook  of = signature_look(&antenna);
    const Signature     *signature;
    if (kind->status == STATUS_OK)
        kind->status = signatures_find(&signature, kind->signatures, kind->model, NULL, 0, &of, NULL);
}

static Status open_kind(Kind *kind, bool coarse)
{
    char             path[4096];
    Origin           origin;
    SignaturesConfig config = {.frequency_hz = frequency_hz,
                               .bandwidth_hz = 5e8,
                               .aspect_rad = 0.3 * rad_per_deg,
                               .rays_per_wavelength = 0.5,
                               .warp_m = 1e-3};
    if (coarse) config = signatures_coarse(&config);
    config.most_octets = 1;
    if (!etc_path(path, sizeof path, "catalog.csv")) return STATUS_BAD_VALUE;
    Status status = catalog_open(&kind->catalog, path, coarse ? coarse_sag_m() : radar_sag_m(frequency_hz));
    if (status == STATUS_OK) status = radar_materials_load(&kind->materials);
    if (status == STATUS_OK) status = signatures_create(&kind->signatures, &config, kind->catalog, &kind->materials);
    if (status == STATUS_OK) kind->model = catalog_find(kind->catalog, tank_type, &origin, NULL);
    return status;
}

static void close_kind(Kind *kind)
{
    signatures_destroy(kind->signatures);
    radar_materials_close(&kind->materials);
    if (kind->catalog) catalog_close(kind->catalog);
}

Status precision_coarse(Bench *bench)
{
    Kind   kind[2] = {0};
    double square = 0;
    bench_progress(bench, "coarse signatures of targets");
    Status status = open_kind(&kind[0], false);
    if (status == STATUS_OK) status = open_kind(&kind[1], true);
    for (int i = 0; i < looks && status == STATUS_OK; i++) {
        const double db = 10 * log10(mean_of(&kind[1], i) / mean_of(&kind[0], i));
        square += db * db / looks;
        status = kind[0].status == STATUS_OK ? kind[1].status : kind[0].status;
    }
    if (status == STATUS_OK) {
        const BenchTunable tunable = {"signatures of targets",
                                      "render/scattering/signatures/coarse.h",
                                      "a new bin of a tank, 16.5 GHz",
                                      "dB",
                                      "cross section's mean over 0.1 degrees, of fine ones, rms over 12 looks",
                                      coarse_error_db()};
        BenchSetting       point[2] = {{.setting = "fine, 0.3 degrees"},
                                       {.setting = "coarse, 15 degrees", .error = sqrt(square), .is_default = true}};
        const BenchWork    work[2] = {{make_one, &kind[0], 1}, {make_one, &kind[1], 1}};
        bench_tunable(bench, &tunable, work, point, 2);
        status = kind[0].status == STATUS_OK ? kind[1].status : kind[0].status;
    }
    close_kind(&kind[0]);
    close_kind(&kind[1]);
    return status;
}
