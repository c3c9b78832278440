/* tests/bench/sensor/skip_frames.c: frames with every skip, with all but one, and with none, interleaved; over scenes
 * with different work to skip. A row is the frame with its skip in the scene in which that saves most, and the ratio is
 * its time without the skip; the planes must be the same. */
#include "tests/bench/suites.h"

#include "sensor/quality/trial_private.h"
#include "sensor/settings/config.h"
#include "terrain/ground/landscape.h"

#include <stdlib.h>

enum {
    what_size = 160,
    whole = SKIP_COUNT,
    none_left,
    variants /* each off; all on; all off */,
    scene_count = 7,
    usual = 1
};

static const unsigned three_bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR;

static const struct SkipScene {
    const char *name;
    int         vehicles, smoking;
    double      back_m, above_m, hfov_deg, sun_later_h;
} settings[scene_count] = {
    {"bare ground", 0, 0, 600, 100, 40, 0},
    {"twenty vehicles, 300 m", 20, 0, 300, 40, 40, 0},
    {"twenty vehicles, 3 km", 20, 0, 3000, 1000, 40, 0},
    {"a hundred vehicles", 100, 0, 900, 150, 40, 0},
    {"one vehicle, close", 1, 0, 14, 4, 40, 0},
    {"twenty vehicles, low sun", 20, 0, 300, 40, 40, 8},
    {"columns of smoke", 20, 4, 300, 40, 40, 0},
};

typedef struct Saving {
    double   ratio; /* time without the skip over time with it; of the rounds, the lower quartile */
    double   with_s;
    uint64_t skipped;
    int      scene;
} Saving;

typedef struct SkipBench {
    Bench     *bench;
    LocalFrame frame;
    Landscape  landscape;
    Pool      *pool;
    Arena     *arena[3];
    Saving     best[variants];
    bool       differs[variants]; /* in any scene */
} SkipBench;

static Status open_scene(TrialScene *scene, const SkipBench *s, const struct SkipScene *setting)
{
    static const DisEntityType types[] = {
        {1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 2, 1, 0, 0}, {1, 1, 222, 28, 1, 0, 0}, {1, 1, 222, 7, 1, 0, 0}};
    const uint32_t smokes = 3u << 5, burns = 1u << 15;
    char           catalog[512];
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    Status status =
        trial_scene_open(scene, &s->landscape, catalog, types, sizeof types / sizeof *types, setting->vehicles);
    if (status != STATUS_OK) return status;
    scene->unix_s += 3600 * setting->sun_later_h;
    for (int later = 0; later < 2 && setting->smoking > 0; later++) {
        for (int k = 0; k < setting->smoking && status == STATUS_OK; k++) {
            const TrialPlace place = {.type = types[k % 4],
                                      .number = 1001 + k,
                                      .east_m = 30.0 * (k - 0.5 * setting->smoking),
                                      .north_m = 60,
                                      .appearance = smokes | burns};
            status = trial_scene_place(scene, &place);
        }
        if (!later) scene->sun_now_s += 20; /* for the smoke to rise */
    }
    if (status != STATUS_OK) trial_scene_close(scene);
    return status;
}

static unsigned off_of(int variant)
{
    return variant < whole ? 1u << variant : variant == none_left ? skips_all_off : 0;
}

static RenderRequest request_of(const SkipBench *s, const TrialScene *scene, const struct SkipScene *setting,
                                unsigned off)
{
    const bool   quick = bench_quick(s->bench);
    const Config config = config_default();
    const View   view = trial_view(scene, setting->back_m, setting->above_m, setting->hfov_deg * rad_per_deg,
                                 quick ? 48 : 320, quick ? 32 : 216);
    return (RenderRequest){.view = view,
                           .bands = three_bands,
                           .truth = true,
                           .optical = OPTICAL_RGB,
                           .samples = 1,
                           .edge_samples = config.sensor.edge_samples,
                           .target_samples = config.sensor.target_samples,
                           .sky_visibility = config.sensor.sky_visibility,
                           .hidden_entity = -1,
                           .skips_off = off};
}

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* The lower quartile of the rounds' ratios: noise alone does not make a scene the best. */
static double sure_ratio(const BenchTime *a, const BenchTime *b)
{
    double ratio[bench_rounds_max];
    for (int r = 0; r < a->rounds; r++) ratio[r] = a->item_s[r] / b->item_s[r];
    qsort(ratio, (size_t)a->rounds, sizeof *ratio, by_value);
    return ratio[a->rounds / 4];
}

static Status time_scene(SkipBench *s, int at)
{
    const struct SkipScene *setting = &settings[at];
    const bool              quick = bench_quick(s->bench);
    TrialScene              scene;
    TrialFrame              frame[variants];
    BenchWork               work[variants];
    BenchTime               time[variants];
    uint64_t                skipped[SKIP_COUNT] = {0};
    char                    hash[sha256_text_size], other[sha256_text_size];
    struct SkipScene        shown = *setting;
    if (quick && shown.vehicles > 10) shown.vehicles = 10;
    if (quick && shown.smoking > 1) shown.smoking = 1;
    Status status = open_scene(&scene, s, &shown);
    if (status != STATUS_OK) return status;

    bench_progress(s->bench, setting->name);
    for (int k = 0; k < variants; k++) {
        frame[k] = (TrialFrame){.scene = &scene,
                                .pool = s->pool,
                                .arena = s->arena[0],
                                .request = request_of(s, &scene, setting, off_of(k))};
        work[k] = (BenchWork){trial_frame, &frame[k], 1};
    }
    for (int n = 0; n < variants && status == STATUS_OK; n++) {
        const int k = (whole + n) % variants; /* all on first */
        trial_frame(&frame[k]);
        status = frame[k].status;
        if (status == STATUS_OK) status = trial_frame_hash(k == whole ? hash : other, &frame[k]);
        if (k == whole) memcpy(skipped, frame[k].picture.counters.visibility.skipped, sizeof skipped);
        else if (status == STATUS_OK) s->differs[k] |= strcmp(hash, other) != 0;
    }
    /* without any skip it takes too long except in the default scene */
    const int timed = at == usual ? variants : none_left;
    if (status == STATUS_OK) bench_time(time, s->bench, work, timed);
    for (int k = 0; k < timed && status == STATUS_OK; k++) {
        const double ratio = sure_ratio(&time[k], &time[whole]);
        if (k != whole && ratio > s->best[k].ratio && (k == none_left || skipped[k] > 0))
            s->best[k] = (Saving){ratio, time[whole].median_s, k < whole ? skipped[k] : 0, at};
    }
    trial_scene_close(&scene);
    return status;
}

/* Planes that are not requested are not computed, and those requested do not change. */
static Status time_asked(SkipBench *s)
{
    static const struct {
        const char *what;
        unsigned    bands;
        bool        truth;
    } asked[] = {
        {"bands nobody asked for: LWIR of three, truth", 1u << BAND_LWIR, true},
        {"planes nobody asked for: no truth, three bands", three_bands, false},
    };
    enum { requests = 1 + sizeof asked / sizeof *asked };
    TrialScene scene;
    TrialFrame frame[requests];
    BenchWork  work[requests];
    BenchTime  time[requests];
    bool       differs[requests] = {false};
    Status     status = open_scene(&scene, s, &settings[usual]);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < requests && status == STATUS_OK; k++) {
        frame[k] = (TrialFrame){.scene = &scene,
                                .pool = s->pool,
                                .arena = s->arena[k],
                                .request = request_of(s, &scene, &settings[usual], 0)};
        if (k > 0) frame[k].request.bands = asked[k - 1].bands, frame[k].request.truth = asked[k - 1].truth;
        work[k] = (BenchWork){trial_frame, &frame[k], 1};
        trial_frame(&frame[k]);
        status = frame[k].status;
        const size_t bytes = (size_t)frame[k].picture.width * (size_t)frame[k].picture.height * sizeof(float);
        for (int p = 0; p < picture_plane_count && status == STATUS_OK; p++) {
            const float *plane = picture_plane(&frame[k].picture, p), *all = picture_plane(&frame[0].picture, p);
            differs[k] |= plane && memcmp(plane, all, bytes) != 0;
        }
    }
    if (status == STATUS_OK) bench_time(time, s->bench, work, requests);
    for (int k = 1; k < requests && status == STATUS_OK; k++) {
        BenchRow row = bench_row(asked[k - 1].what);
        row.median = time[k].median_s;
        row.unit = "s";
        row.ratio = bench_ratio(&time[0], &time[k]);
        row.to = "with it, twenty vehicles, 300 m";
        row.error = differs[k];
        row.error_limit = 0;
        row.error_unit = "differ";
        row.against = "the same planes of the whole";
        bench_add(s->bench, &row);
    }
    trial_scene_close(&scene);
    return status;
}

static void say(SkipBench *s, int k)
{
    const Saving *best = &s->best[k];
    char          what[what_size], to[what_size];
    snprintf(what, sizeof what, "%s", k == none_left ? "all of them" : visibility_skip_what((Skip)k));
    BenchRow row = bench_row(what);
    snprintf(to, sizeof to, "with it, %s", settings[best->scene].name);
    row.median = best->with_s;
    row.unit = "s";
    row.rate = k == none_left ? NAN : (double)best->skipped;
    row.rate_unit = "a frame";
    row.ratio = best->ratio > 0 ? best->ratio : NAN;
    row.to = to;
    row.error = s->differs[k];
    row.error_limit = 0;
    row.error_unit = "differ";
    row.against = "planes without it, in every scene";
    bench_add(s->bench, &row);
}

Status bench_skip(Bench *bench)
{
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    SkipBench      s = {.bench = bench};
    double         times_s[2];
    const double   side_m = bench_quick(bench) ? 2000 : 8000;
    bench_progress(bench, "ground");
    Status status = pool_create(&s.pool, bench_threads(bench));
    for (int k = 0; k < 3 && status == STATUS_OK; k++)
        if (!(s.arena[k] = arena_create())) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = local_frame_at(&s.frame, &origin);
    if (status == STATUS_OK) status = landscape_quick(&s.landscape, times_s, &s.frame, side_m, side_m, s.pool);
    for (int k = 0; k < scene_count && status == STATUS_OK; k++) status = time_scene(&s, k);
    for (int k = 0; k < variants && status == STATUS_OK; k++)
        if (k != whole) say(&s, k);
    if (status == STATUS_OK) status = time_asked(&s);
    if (status != STATUS_OK) log_error("bench: skip: %s", status_name(status));
    landscape_destroy(&s.landscape);
    for (int k = 0; k < 3; k++) arena_destroy(s.arena[k]);
    pool_destroy(s.pool);
    return status;
}
