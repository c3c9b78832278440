/* tests/bench/sensor/woods_frames.c: frames over 12 x 16 km of ground with three million trees and twenty vehicles, in
 * four views: every plant in full detail, and with the two levels of detail.
 *
 * Frames are of all bands and planes of truth. One ray a pixel is compared with 16 rays in every pixel in full
 * detail; level 1 is priced by the same 16 rays with and without it, band by band, so that sampling is not part of its
 * error. */
#include "tests/bench/suites.h"

#include "render/scene/view.h"
#include "tests/bench/sensor/speed_private.h"
#include "tests/scenes/woods_stand.h"
#include "sensor/settings/config.h"
#include "terrain/ground/landscape.h"

#include <time.h>

enum { views = 4, vehicles = 20, details = 2 /* full; two levels */ };

static const struct {
    const char *name;
    double      above_m, down_deg, hfov_deg;
} places[views] = {{"100 m up, 5 degrees down", 100, 5, 40},
                   {"300 m up, 10 degrees down", 300, 10, 40},
                   {"300 m up, 8 down, 6 wide", 300, 8, 6},
                   {"1000 m up, 20 degrees down", 1000, 20, 40}};
static const char *const detail_name[details] = {"full detail", "two levels"};

static const unsigned all_bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR | 1u << BAND_RADAR;

typedef struct WoodsBench {
    Bench     *bench;
    int        width, height, trees;
    double     east_m, north_m, level1_px;
    LocalFrame frame;
    Landscape  landscape;
    Woods      woods;
    TrialScene scene;
    Forest    *forest[details]; /* the scene's own is one of them */
    Pool      *one, *many;
    Arena     *arena[3];
} WoodsBench;

/* ---- the world ---------------------------------------------------------------------------------- */

static void say(WoodsBench *w, const char *what, double value, const char *unit)
{
    BenchRow row = bench_row(what);
    row.median = value;
    row.unit = unit;
    bench_add(w->bench, &row);
}

static void say_memory(WoodsBench *w, const char *what, double limit_mb)
{
    BenchRow row = bench_row(what);
    row.error = bench_memory_mb("VmRSS:");
    row.error_limit = limit_mb;
    row.error_unit = "MB";
    row.against = "resident, mapped pages included";
    bench_add(w->bench, &row);
}

static Status make_ground(WoodsBench *w)
{
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    double         times_s[2];
    bench_progress(w->bench, "ground");
    Status status = local_frame_at(&w->frame, &origin);
    if (status == STATUS_OK)
        status = landscape_quick(&w->landscape, times_s, &w->frame, w->east_m, w->north_m, w->many);
    if (status != STATUS_OK) return status;
    const ElevationLevel *level = &w->landscape.elevation.level[0];
    say(w, "ground: posts", 1e-6 * level->nx * level->ny, "M");
    say_memory(w, "memory: with the ground", NAN);
    return STATUS_OK;
}

static Status make_vehicles(WoodsBench *w)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0},
                                          {1, 1, 222, 2, 1, 0, 0},
                                          {1, 1, 222, 1, 1, 1, 0},
                                          {1, 1, 222, 28, 1, 0, 0},
                                          {1, 1, 222, 7, 1, 0, 0}};
    char                       catalog[512];
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    return trial_scene_open(&w->scene, &w->landscape, catalog, types, sizeof types / sizeof *types, vehicles);
}

/* Makes woods that stay clear of each vehicle by 6 m. */
static Status make_woods(WoodsBench *w)
{
    WoodsStand stand = {.landscape = &w->landscape, .east_m = w->east_m, .north_m = w->north_m, .trees = w->trees};
    Snapshot   snapshot;
    bench_progress(w->bench, "woods");
    arena_reset(w->arena[0]);
    Status status = entity_table_snapshot(&snapshot, w->scene.table, w->scene.sun_now_s + 0.5, w->arena[0]);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < snapshot.count && k < woods_stand_clear; k++) {
        double p_enu[3];
        enu_from_ecef(p_enu, &w->frame, snapshot.entity[k].p_ecef);
        stand.clear[stand.clears++] = (WoodsPath){{p_enu[0], p_enu[1]}, {p_enu[0], p_enu[1]}, 6, 6};
    }
    status = woods_stand_create(&w->woods, &stand, w->many);
    if (status != STATUS_OK) return status;
    say(w, "woods: placing of plants by classes", stand.placing_s, "s");
    say(w, "woods: trees by classes", stand.by_classes, "");
    say(w, "woods: trees, most of them evenly everywhere", woods_stand_trees(&w->woods), "");
    say(w, "woods: bushes and hedges", w->woods.count - woods_stand_trees(&w->woods), "");
    say_memory(w, "memory: with the plants' places", NAN);
    return STATUS_OK;
}

static Status make_forest(WoodsBench *w, int detail)
{
    const ForestConfig config = {.leaves = true, .fine = true, .level1_px = detail ? w->level1_px : 0};
    World             *world = &w->scene.world;
    const double       start_s = wall_clock_s();
    bench_progress(w->bench, "trees of boxes");
    Status status = detail == 0 ? world_plant(world, &w->woods, &config, NULL, w->many)
                                : forest_create(&w->forest[detail], &w->woods, world->plants, &config, NULL);
    if (detail == 0) w->forest[0] = world->forest;
    if (detail != 0 || status != STATUS_OK) return status;
    say(w, "woods: prototypes and tree of boxes", wall_clock_s() - start_s, "s");
    say_memory(w, "memory: with prototypes and tree of boxes", NAN);
    return STATUS_OK;
}

/* ---- frames -------------------------------------------------------------------------------------- */

typedef struct WoodsFrame {
    WoodsBench *w;
    int         detail;
    TrialFrame  frame;
} WoodsFrame;

static void render_frame(void *user)
{
    WoodsFrame *f = user;
    f->w->scene.world.forest = f->w->forest[f->detail];
    trial_frame(&f->frame);
}

/* Places the view south of the vehicles, so far that its middle is at their height. */
static View view_of(const WoodsBench *w, int v)
{
    const double back_m = places[v].above_m / tan(places[v].down_deg * rad_per_deg);
    const double down = places[v].down_deg * rad_per_deg, d_enu[3] = {0, cos(down), -sin(down)};
    View         view = trial_view(&w->scene, fmin(back_m, 0.45 * w->north_m), places[v].above_m,
                                   places[v].hfov_deg * rad_per_deg, w->width, w->height);
    view_upright(view.r_enu_from_cam, d_enu);
    return view;
}

static RenderRequest request_of(const WoodsBench *w, int v, int samples)
{
    const View    view = view_of(w, v);
    RenderRequest request = speed_request(&view, all_bands, true);
    const Config  config = config_default();
    request.samples = samples;
    request.edge_samples = request.target_samples = 0;
    request.low_plants_m = config.terrain.woods_low_m;
    return request;
}

static WoodsFrame frame_of(WoodsBench *w, int detail, const RenderRequest *request, Pool *pool, Arena *arena)
{
    return (WoodsFrame){w, detail, {.scene = &w->scene, .request = *request, .pool = pool, .arena = arena}};
}

static double processor_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double rays_of(const Picture *p)
{
    const VisibilityCounters *v = &p->counters.visibility;
    return (double)p->counters.rays_primary + (double)v->rays_sun_ground;
}

static double plant_share(const Picture *p)
{
    double       met = 0;
    const size_t count = (size_t)p->width * (size_t)p->height;
    for (size_t i = 0; i < count; i++) met += p->instance && p->instance[i] != 0;
    return 100 * met / (double)count;
}

/* Root of the mean squared difference of block means, % of the plane's mean. */
static double rms_of(const float *a, const float *b, int width, int height, int block)
{
    double square = 0, mean = 0, blocks = 0;
    for (int y = 0; y + block <= height; y += block)
        for (int x = 0; x + block <= width; x += block) {
            double p = 0, q = 0;
            for (int i = 0; i < block * block; i++) {
                const size_t at = (size_t)(y + i / block) * (size_t)width + (size_t)(x + i % block);
                p += (double)a[at], q += (double)b[at];
            }
            square += (p - q) * (p - q), mean += q, blocks++;
        }
    return 100 * sqrt(square * blocks) / mean;
}

static double mean_off(const float *a, const float *b, int width, int height)
{
    double       p = 0, q = 0;
    const size_t count = (size_t)width * (size_t)height;
    for (size_t i = 0; i < count; i++) p += (double)a[i], q += (double)b[i];
    return 100 * (p / q - 1);
}

static const char *const plane_name[picture_plane_count] = {"red", "green", "blue", "3-5 um", "8-12 um", "radar"};

/* Rows of the planes but radar's, which are of few pixels. */
static void say_planes(WoodsBench *w, int v, const char *of, const Picture *got, const Picture *want,
                       const char *against)
{
    for (int k = 0; k < picture_radar; k++) {
        const float *a = picture_plane(got, k), *b = picture_plane(want, k);
        char         what[what_size], text[160];
        if (!a || !b) continue;
        snprintf(what, sizeof what, "%s: %s, %s", places[v].name, of, plane_name[k]);
        snprintf(text, sizeof text, "rms, %s; blocks of 8 px: %.2g %%; mean: %+.2g %%", against,
                 rms_of(a, b, got->width, got->height, 8), mean_off(a, b, got->width, got->height));
        BenchRow row = bench_row(what);
        row.error = rms_of(a, b, got->width, got->height, 1);
        row.error_unit = "%";
        row.against = text;
        bench_add(w->bench, &row);
    }
}

/* Returns 1 if one thread, with nothing skipped, gives other planes. */
static double differs(WoodsBench *w, const WoodsFrame *many)
{
    WoodsFrame one = *many;
    char       hash[2][sha256_text_size];
    one.frame.pool = w->one;
    one.frame.arena = w->arena[1];
    one.frame.request.skips_off = skips_all_off;
    render_frame(&one);
    if (one.frame.status != STATUS_OK || trial_frame_hash(hash[0], &one.frame) != STATUS_OK ||
        trial_frame_hash(hash[1], &many->frame) != STATUS_OK)
        return NAN;
    return strcmp(hash[0], hash[1]) != 0;
}

static Status time_view(WoodsBench *w, int v)
{
    const RenderRequest request = request_of(w, v, 1);
    const int           rounds = bench_quick(w->bench) ? 3 : 7;
    WoodsFrame          frame[details];
    BenchTime           time[details] = {{.rounds = rounds}, {.rounds = rounds}}, cores[details];
    char                what[what_size];
    bench_progress(w->bench, places[v].name);
    for (int k = 0; k < details; k++) frame[k] = frame_of(w, k, &request, w->many, w->arena[0]);
    memcpy(cores, time, sizeof cores);
    for (int r = -1; r < rounds; r++) /* in turn; the first is to warm up */
        for (int k = 0; k < details; k++) {
            const double start_s = wall_clock_s(), busy_s = processor_s();
            render_frame(&frame[k]);
            if (r < 0) continue;
            time[k].item_s[r] = wall_clock_s() - start_s;
            cores[k].item_s[r] = (processor_s() - busy_s) / pool_threads(w->many);
        }
    for (int k = 0; k < details; k++) bench_time_finish(&time[k]), bench_time_finish(&cores[k]);
    for (int k = 0; k < details; k++) {
        render_frame(&frame[k]);
        if (frame[k].frame.status != STATUS_OK) return frame[k].frame.status;
        const Picture *p = &frame[k].frame.picture;
        snprintf(what, sizeof what, "%s: one ray a pixel, %s", places[v].name, detail_name[k]);
        BenchRow row = bench_row_of(what, &time[k], "M rays/s", 1e6 / rays_of(p));
        row.ratio = k ? bench_ratio(&time[1], &time[0]) : NAN;
        row.to = k ? detail_name[0] : NULL;
        row.error = differs(w, &frame[k]);
        row.error_limit = 0;
        row.error_unit = "differ";
        row.against = "planes of one thread, nothing skipped";
        bench_add(w->bench, &row);
        snprintf(what, sizeof what, "%s: time of processors over threads, %s", places[v].name, detail_name[k]);
        row = bench_row_of(what, &cores[k], NULL, 1);
        bench_add(w->bench, &row);
        if (k > 0) continue;
        snprintf(what, sizeof what, "%s: plants' boxes that a ray enters", places[v].name);
        say(w, what, (double)p->counters.visibility.rays_plants / (double)p->counters.rays_primary, "");
        snprintf(what, sizeof what, "%s: pixels of plants", places[v].name);
        say(w, what, plant_share(p), "%");
    }
    return STATUS_OK;
}

/* Times a frame as a node asks for it: with edges, small targets and the estimate of its error. Its bits are compared
 * elsewhere, with one ray a pixel and by the tests. */
static Status time_default(WoodsBench *w, int v)
{
    const View    view = view_of(w, v);
    RenderRequest request[2] = {
        trial_default_request(&w->scene, &view, places[v].above_m / sin(places[v].down_deg * rad_per_deg)),
        request_of(w, v, 1)};
    const int rounds = bench_quick(w->bench) ? 1 : 3;
    BenchTime time[2] = {{.rounds = rounds}, {.rounds = rounds}};
    char      what[what_size];
    double    refined = 0;
    for (int r = 0; r < rounds; r++)
        for (int k = 0; k < 2; k++) {
            WoodsFrame   f = frame_of(w, 0, &request[k], w->many, w->arena[0]);
            const double start_s = wall_clock_s();
            render_frame(&f);
            if (f.frame.status != STATUS_OK) return f.frame.status;
            time[k].item_s[r] = wall_clock_s() - start_s;
            if (k == 0) refined = (double)f.frame.picture.counters.pixels_refined;
        }
    for (int k = 0; k < 2; k++) bench_time_finish(&time[k]);
    snprintf(what, sizeof what, "%s: default quality, %s", places[v].name, detail_name[0]);
    BenchRow row = bench_row_of(what, &time[0], "frames/s", 1);
    row.ratio = bench_ratio(&time[0], &time[1]);
    row.to = "one ray a pixel";
    bench_add(w->bench, &row);
    snprintf(what, sizeof what, "%s: default quality: pixels sampled again", places[v].name);
    say(w, what, 100 * refined / ((double)w->width * w->height), "%");
    return STATUS_OK;
}

/* Times a piece about the middle, a third of the picture's sides, with one ray and with 16. */
static Status price_view(WoodsBench *w, int v)
{
    RenderRequest request[2] = {request_of(w, v, 1), request_of(w, v, 4)};
    WoodsFrame    one, fine[details];
    for (int k = 0; k < 2; k++) request[k].view.width /= 3, request[k].view.height /= 3;
    for (int k = 0; k < details; k++) {
        fine[k] = frame_of(w, k, &request[1], w->many, w->arena[1 + k]);
        render_frame(&fine[k]);
        if (fine[k].frame.status != STATUS_OK) return fine[k].frame.status;
    }
    for (int k = 0; k < details; k++) {
        char of[64];
        one = frame_of(w, k, &request[0], w->many, w->arena[0]);
        render_frame(&one);
        if (one.frame.status != STATUS_OK) return one.frame.status;
        snprintf(of, sizeof of, "one ray, %s", detail_name[k]);
        say_planes(w, v, of, &one.frame.picture, &fine[0].frame.picture, "16 rays a pixel in full detail");
    }
    say_planes(w, v, "two levels", &fine[1].frame.picture, &fine[0].frame.picture, "the same 16 rays, both");
    return STATUS_OK;
}

/* Times the stages on one thread, where they add up. */
static Status time_stages(WoodsBench *w, int v)
{
    static const struct {
        TrialStage  stage;
        const char *name;
    } stages[] = {{STAGE_PREPARE, "prepare, low plants"},
                  {STAGE_VISIBILITY, "first hits"},
                  {STAGE_SUN, "sun rays"},
                  {STAGE_SHADE, "shading"},
                  {STAGE_RADAR, "radar"},
                  {STAGE_REST, "rest"},
                  {STAGE_TRUTH, "truth of targets"}};
    enum { rounds = 3 };
    const RenderRequest request = request_of(w, v, 1);
    WoodsFrame          f = frame_of(w, 0, &request, w->one, w->arena[1]);
    BenchTime           time[TRIAL_STAGE_COUNT] = {0};
    for (int r = 0; r < rounds; r++) {
        render_frame(&f);
        if (f.frame.status != STATUS_OK) return f.frame.status;
        for (int s = 0; s < TRIAL_STAGE_COUNT; s++) time[s].item_s[r] = f.frame.stage_s[s], time[s].rounds = rounds;
    }
    for (int s = 0; s < TRIAL_STAGE_COUNT; s++) bench_time_finish(&time[s]);
    for (size_t k = 0; k < sizeof stages / sizeof *stages; k++) {
        char what[what_size];
        snprintf(what, sizeof what, "%s: 1 thread: %s", places[v].name, stages[k].name);
        if (!(time[stages[k].stage].best_s > 0)) continue;
        BenchRow row = bench_row_of(what, &time[stages[k].stage], NULL, 1);
        row.ratio = bench_ratio(&time[stages[k].stage], &time[STAGE_FRAME]);
        row.to = "frame";
        bench_add(w->bench, &row);
    }
    return STATUS_OK;
}

/* ---- the suite ----------------------------------------------------------------------------------- */

static Status read_options(double *number, double *level1_px, const Bench *bench)
{
    const char *trees = bench_option(bench, "trees"), *px = bench_option(bench, "level1-px");
    *number = bench_quick(bench) ? 30000 : 3000000;
    *level1_px = 24;
    if (trees && !(text_to_double(number, trees) && *number >= 0 && *number <= woods_most_trees)) {
        log_error("bench: --trees: '%s' is not 0 .. %d", trees, woods_most_trees);
        return STATUS_BAD_VALUE;
    }
    if (px && !(text_to_double(level1_px, px) && *level1_px > 0 && *level1_px <= 1000)) {
        log_error("bench: --level1-px: '%s' is not above 0 and up to 1000", px);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

Status bench_woods_check(const Bench *bench)
{
    double number, level1_px;
    return read_options(&number, &level1_px, bench);
}

static Status open_bench(WoodsBench *w)
{
    const bool quick = bench_quick(w->bench);
    double     number;
    w->width = quick ? 160 : 720, w->height = quick ? 108 : 486;
    w->east_m = quick ? 1000 : 12000, w->north_m = quick ? 2000 : 16000;
    Status status = read_options(&number, &w->level1_px, w->bench);
    if (status != STATUS_OK) return status;
    w->trees = (int)number;
    status = pool_create(&w->one, 1);
    if (status == STATUS_OK) status = pool_create(&w->many, bench_threads(w->bench));
    for (int k = 0; k < 3 && status == STATUS_OK; k++)
        if (!(w->arena[k] = arena_create())) status = STATUS_NO_MEMORY;
    return status;
}

/* Prints the memory of a node that shows one view after another, in full detail. */
static Status say_memories(WoodsBench *w)
{
    static const double most_mb = 2000;
    for (int v = 0; v < views; v++) {
        const RenderRequest request = request_of(w, v, 1);
        WoodsFrame          f = frame_of(w, 0, &request, w->many, w->arena[0]);
        render_frame(&f);
        if (f.frame.status != STATUS_OK) return f.frame.status;
    }
    say_memory(w, "memory: with frames of all views, full detail", most_mb);
    say(w, "memory: at most until then", bench_memory_mb("VmHWM:"), "MB");
    return STATUS_OK;
}

static Status time_all(WoodsBench *w)
{
    Status status = open_bench(w);
    if (status == STATUS_OK) status = make_ground(w);
    if (status == STATUS_OK) status = make_vehicles(w);
    if (status == STATUS_OK) status = make_woods(w);
    if (status == STATUS_OK) status = make_forest(w, 0);
    if (status == STATUS_OK) status = say_memories(w);
    if (status == STATUS_OK) status = make_forest(w, 1);
    for (int v = 0; v < views && status == STATUS_OK; v++) {
        status = time_view(w, v);
        if (status == STATUS_OK) status = time_default(w, v);
        if (status == STATUS_OK) status = price_view(w, v);
    }
    for (int v = 0; v < views && status == STATUS_OK; v++) status = time_stages(w, v);
    return status;
}

Status bench_woods(Bench *bench)
{
    WoodsBench   w = {.bench = bench};
    const Status status = time_all(&w);
    if (status != STATUS_OK) log_error("bench: woods: %s", status_name(status));
    w.scene.world.forest = w.forest[0];
    trial_scene_close(&w.scene);
    if (w.forest[1]) forest_destroy(w.forest[1]);
    woods_destroy(&w.woods);
    landscape_destroy(&w.landscape);
    for (int k = 0; k < 3; k++) arena_destroy(w.arena[k]);
    pool_destroy(w.many);
    pool_destroy(w.one);
    return status;
}
