/* tests/bench/sensor/town.c: `bench town`: frames of ten thousand houses and five thousand cars and trailers in and
 * between their streets, beside the same frames without: set-up, memory, time, the same bits. */
#include "tests/bench/sensor/speed_private.h"
#include "tests/scenes/town.h"

#include "sensor/settings/config.h"

enum { views = 4, town_houses = 10000, town_clutter = 5000, town_movers = 100, vehicles = 10 };

static const struct {
    const char *name;
    double      back_m, above_m, hfov_deg;
} places[views] = {{"in a street", 300, 2, 40},
                   {"100 m up", 600, 100, 40},
                   {"300 m up", 1500, 300, 40},
                   {"1000 m up, 6 degrees wide", 3000, 1000, 6}};

typedef struct TownBench {
    Bench     *bench;
    int        width, height, houses, clutter;
    LocalFrame frame;
    Landscape  landscape;
    Scenery    scenery;
    TrialScene bare, town; /* the same but for scenery */
    Pool      *one, *many;
    Arena     *arena[3];
} TownBench;

static void say(const TownBench *t, const char *what, double value, const char *unit)
{
    BenchRow row = bench_row(what);
    row.median = value;
    row.unit = unit;
    bench_add(t->bench, &row);
}

static Status open_scenes(TownBench *t)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 7, 1, 0, 0}};
    const Geodetic             origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    const double               wide_m = town_wide_m(t->houses) + 2000;
    double                     times_s[2];
    char                       catalog[512];
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    Status status = local_frame_at(&t->frame, &origin);
    if (status == STATUS_OK) status = landscape_quick(&t->landscape, times_s, &t->frame, wide_m, wide_m, t->many);
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = trial_scene_open(k ? &t->town : &t->bare, &t->landscape, catalog, types, 2, vehicles);
    return status;
}

static long long triangles_of(const Scenery *s, bool of_models)
{
    long long sum = 0;
    for (int k = 0; k < s->models && of_models; k++) sum += s->model[k].triangle_count;
    for (int k = 0; k < s->objects && !of_models; k++) sum += s->model[s->object[k].model].triangle_count;
    return sum;
}

static Status build_town(TownBench *t)
{
    const TownOf of = {.buildings = t->houses,
                       .clutter = t->clutter,
                       .movers = t->clutter / (town_clutter / town_movers),
                       .landscape = &t->landscape,
                       .seed = 8};
    bench_progress(t->bench, "town");
    Status status = town_create(&t->scenery, &of);
    if (status != STATUS_OK) return status;
    const double before_mb = bench_memory_mb("VmRSS:"), start_s = wall_clock_s();
    status = world_scenery(&t->town.world, &t->scenery, NULL, t->many);
    const double set_up_s = wall_clock_s() - start_s;
    if (status != STATUS_OK) return status;
    say(t, "models", t->scenery.models, "");
    say(t, "objects", t->scenery.objects, "");
    say(t, "triangles of models", 1e-6 * (double)triangles_of(&t->scenery, true), "M");
    say(t, "triangles that stand", 1e-6 * (double)triangles_of(&t->scenery, false), "M");
    BenchRow row = bench_row("set-up: trees over models and objects");
    row.median = set_up_s;
    row.unit = "s";
    bench_add(t->bench, &row);
    say(t, "memory: trees, beside the models", bench_memory_mb("VmRSS:") - before_mb, "MB");
    say(t, "memory: poses and the tree over objects", 1e-6 * (double)scenery_tracer_bytes(t->town.world.scenery), "MB");
    return status;
}

static RenderRequest request_of(const TownBench *t, int v, bool small)
{
    const Config config = config_default();
    const View   view = trial_view(&t->bare, places[v].back_m, places[v].above_m, places[v].hfov_deg * rad_per_deg,
                                 small ? 96 : t->width, small ? 64 : t->height);
    return (RenderRequest){.view = view,
                           .bands = three_bands,
                           .truth = true,
                           .optical = OPTICAL_RGB,
                           .samples = 1,
                           .edge_samples = config.sensor.edge_samples,
                           .target_samples = config.sensor.target_samples,
                           .sky_visibility = config.sensor.sky_visibility,
                           .t_s = 30,
                           .hidden_entity = -1};
}

/* 0 where a small picture has the same bits on one thread with nothing skipped; else 1. */
static double differs(TownBench *t, int v)
{
    TrialFrame frame = {.scene = &t->town, .request = request_of(t, v, true), .pool = t->many, .arena = t->arena[0]};
    char       hash[2][sha256_text_size];
    for (int k = 0; k < 2; k++) {
        trial_frame(&frame);
        if (frame.status != STATUS_OK || trial_frame_hash(hash[k], &frame) != STATUS_OK) return NAN;
        frame.pool = t->one;
        frame.request.skips_off = skips_all_off;
    }
    return strcmp(hash[0], hash[1]) != 0;
}

static double shown_percent(const Picture *p)
{
    double       shown = 0;
    const size_t count = (size_t)p->width * (size_t)p->height;
    for (size_t i = 0; i < count; i++) shown += p->part[i] && !p->entity[i];
    return 100 * shown / (double)count;
}

static Status time_view(TownBench *t, int v)
{
    const RenderRequest request = request_of(t, v, false);
    TrialFrame          frame[2];
    BenchTime           time[2];
    char                what[what_size];
    bench_progress(t->bench, places[v].name);
    for (int k = 0; k < 2; k++)
        frame[k] = (TrialFrame){
            .scene = k ? &t->town : &t->bare, .request = request, .pool = t->many, .arena = t->arena[1 + k]};
    const BenchWork work[2] = {{trial_frame, &frame[0], 1}, {trial_frame, &frame[1], 1}};
    bench_time(time, t->bench, work, 2);
    for (int k = 0; k < 2; k++) {
        if (frame[k].status != STATUS_OK) return frame[k].status;
        snprintf(what, sizeof what, "%s: frame, 3 bands and truth, %s scenery", places[v].name, k ? "with" : "without");
        BenchRow row = bench_row_of(what, &time[k], "frames/s", 1);
        if (k) {
            row.ratio = bench_ratio(&time[1], &time[0]);
            row.to = "without";
            row.error = differs(t, v);
            row.error_limit = 0;
            row.error_unit = "differ";
            row.against = "planes of one thread, nothing skipped, of 96 x 64 px";
        }
        bench_add(t->bench, &row);
    }
    const Picture            *p = &frame[1].picture;
    const VisibilityCounters *c = &p->counters.visibility;
    snprintf(what, sizeof what, "%s: pixels that show scenery", places[v].name);
    say(t, what, shown_percent(p), "%");
    snprintf(what, sizeof what, "%s: objects asked for a ray", places[v].name);
    say(t, what, (double)c->rays_scenery / (double)p->counters.rays_primary, "");
    snprintf(what, sizeof what, "%s: pixels sampled again, beside those without scenery", places[v].name);
    say(t, what, (double)p->counters.pixels_refined / fmax((double)frame[0].picture.counters.pixels_refined, 1), "x");
    return STATUS_OK;
}

static Status run_all(TownBench *t)
{
    const bool quick = bench_quick(t->bench);
    t->width = quick ? 96 : 720, t->height = quick ? 64 : 486;
    t->houses = quick ? 100 : town_houses, t->clutter = quick ? 100 : town_clutter;
    Status status = pool_create(&t->one, 1);
    if (status == STATUS_OK) status = pool_create(&t->many, bench_threads(t->bench));
    for (int k = 0; k < 3 && status == STATUS_OK; k++)
        if (!(t->arena[k] = arena_create())) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = open_scenes(t);
    if (status == STATUS_OK) status = build_town(t);
    for (int v = 0; v < views && status == STATUS_OK; v++) status = time_view(t, v);
    return status;
}

Status bench_town(Bench *bench)
{
    TownBench    t = {.bench = bench};
    const Status status = run_all(&t);
    if (status != STATUS_OK) log_error("bench: town: %s", status_name(status));
    trial_scene_close(&t.town);
    trial_scene_close(&t.bare);
    scenery_free(&t.scenery);
    landscape_destroy(&t.landscape);
    for (int k = 0; k < 3; k++) arena_destroy(t.arena[k]);
    pool_destroy(t.many);
    pool_destroy(t.one);
    return status;
}
