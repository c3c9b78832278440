/* tests/bench/sensor/woods_frames.c: `bench woods`: 12 x 16 km of ground with three million trees and twenty vehicles,
 * seen in four views with every plant in full detail, and with far plants in a representation that is judged by it. The
 * other files woods_*.c have the rows of a view, of vehicles and of a flight. */
#include "tests/bench/sensor/woods_private.h"

#include "tests/scenes/woods_stand.h"
#include "sensor/settings/config.h"
#include "terrain/ground/landscape.h"

#include <time.h>

const WoodsPose woods_pose[woods_views] = {{"100 m up, 5 degrees down", 100, 5, 40},
                                           {"300 m up, 10 degrees down", 300, 10, 40},
                                           {"300 m up, 8 down, 6 wide", 300, 8, 6},
                                           {"1000 m up, 20 degrees down", 1000, 20, 40}};

/* ---- what is judged ------------------------------------------------------------------------------ */

const char *const woods_detail[woods_details] = {"full detail", "tables"};

/* The one place that says how the judged forest differs from full detail. Times are beside what terrain.woods_tables:
 * off shows; errors, and all of a quick run, beside plants whose leaves are the finest at any height in the picture. */
static ForestConfig config_of(const WoodsBench *w, int detail, bool timed)
{
    return (ForestConfig){.leaves = true,
                          .fine = true,
                          .all_fine = detail == 0 && !(timed && !bench_quick(w->bench)),
                          .tables = detail == 1};
}

/* ---- rows ----------------------------------------------------------------------------------------- */

const char *const woods_plane[picture_plane_count] = {"red", "green", "blue", "3-5 um", "8-12 um", "radar"};

void woods_judge(WoodsBench *w, const char *what, Estimate figure, WoodsLimit limit, const char *text)
{
    char       words[256];
    const bool judged = !isnan(limit.limit) && !bench_quick(w->bench);
    BenchRow   row = bench_row(what);
    if (isnan(figure.se)) snprintf(words, sizeof words, "%s; %+.3g %s", text, figure.value, limit.unit);
    else snprintf(words, sizeof words, "%s; %+.3g +- %.2g %s", text, figure.value, figure.se, limit.unit);
    if (judged) {
        const size_t at = strlen(words);
        snprintf(words + at, sizeof words - at, "; asked: %g", limit.limit);
        row.error_limit =
            limit.limit + (figure.se >= 0 ? fmin(fmax(2 * figure.se, 0.005 * limit.limit), 0.5 * limit.limit) : 0);
    }
    row.error = limit.below ? figure.value : fabs(figure.value);
    row.error_unit = limit.unit;
    row.against = words;
    bench_add(w->bench, &row);
}

void woods_say(WoodsBench *w, const char *what, double value, const char *unit)
{
    BenchRow row = bench_row(what);
    row.median = value;
    row.unit = unit;
    bench_add(w->bench, &row);
}

void woods_say_memory(WoodsBench *w, const char *what, double limit_mb)
{
    BenchRow row = bench_row(what);
    row.error = bench_memory_mb("VmRSS:");
    row.error_limit = limit_mb;
    row.error_unit = "MB";
    row.against = "resident, mapped pages included";
    bench_add(w->bench, &row);
}

/* ---- the world ---------------------------------------------------------------------------------- */

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
    woods_say(w, "ground: posts", 1e-6 * level->nx * level->ny, "M");
    woods_say_memory(w, "memory: with the ground", NAN);
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
    return trial_scene_open(&w->scene, &w->landscape, catalog, types, sizeof types / sizeof *types, woods_vehicles);
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
    woods_say(w, "woods: placing of plants by classes", stand.placing_s, "s");
    woods_say(w, "woods: trees by classes", stand.by_classes, "");
    woods_say(w, "woods: trees, most of them evenly everywhere", woods_stand_trees(&w->woods), "");
    woods_say(w, "woods: bushes and hedges", w->woods.count - woods_stand_trees(&w->woods), "");
    woods_say_memory(w, "memory: with the plants' places", NAN);
    return STATUS_OK;
}

static Status make_forest(WoodsBench *w, int detail)
{
    const ForestConfig config = config_of(w, detail, woods_wants(w, WOODS_TIMES));
    World             *world = &w->scene.world;
    const double       start_s = wall_clock_s();
    char               what[what_size];
    bench_progress(w->bench, "trees of boxes");
    Status status = detail == 0 ? world_plant(world, &w->woods, &config, NULL, w->many)
                                : forest_create(&w->forest[detail], &w->woods, world->plants, &config, NULL);
    if (detail == 0) w->forest[0] = world->forest;
    if (status != STATUS_OK) return status;
    if (detail == 0) {
        woods_say(w, "woods: prototypes and tree of boxes", wall_clock_s() - start_s, "s");
        woods_say_memory(w, "memory: with prototypes and tree of boxes", NAN);
        return STATUS_OK;
    }
    snprintf(what, sizeof what, "woods: set-up of %s, a forest of its own", woods_detail[detail]);
    woods_say(w, what, wall_clock_s() - start_s, "s");
    snprintf(what, sizeof what, "memory: with a forest of %s, too", woods_detail[detail]);
    woods_say_memory(w, what, NAN);
    return STATUS_OK;
}

Status woods_replace(WoodsBench *w, int detail, const ForestConfig *config)
{
    World *world = &w->scene.world;
    if (w->forest[detail]) forest_destroy(w->forest[detail]);
    w->forest[detail] = NULL, world->forest = w->forest[0];
    const Status status = forest_create(&w->forest[detail], &w->woods, world->plants, config, NULL);
    world->forest = w->forest[0];
    return status;
}

static const unsigned all_bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR | 1u << BAND_RADAR;

/* ---- frames -------------------------------------------------------------------------------------- */

void woods_render(void *user)
{
    WoodsFrame *f = user;
    TrialScene *scene = f->scene ? f->scene : &f->w->scene;
    scene->world.forest = f->w->forest[f->detail];
    f->frame.scene = scene;
    trial_frame(&f->frame);
}

View woods_view(const WoodsBench *w, int v)
{
    const double back_m = woods_pose[v].above_m / tan(woods_pose[v].down_deg * rad_per_deg);
    const double down = woods_pose[v].down_deg * rad_per_deg, d_enu[3] = {0, cos(down), -sin(down)};
    View         view = trial_view(&w->scene, fmin(back_m, 0.45 * w->north_m), woods_pose[v].above_m,
                                   woods_pose[v].hfov_deg * rad_per_deg, w->width, w->height);
    view_upright(view.r_enu_from_cam, d_enu);
    return view;
}

RenderRequest woods_request(const WoodsBench *w, int v, int samples)
{
    const View    view = woods_view(w, v);
    RenderRequest request = speed_request(&view, all_bands, true);
    const Config  config = config_default();
    request.samples = samples;
    request.edge_samples = request.target_samples = 0;
    request.low_plants_m = config.terrain.woods_low_m;
    return request;
}

WoodsFrame woods_frame(WoodsBench *w, int detail, const RenderRequest *request, Pool *pool, Arena *arena)
{
    return (WoodsFrame){.w = w, .detail = detail, .frame = {.request = *request, .pool = pool, .arena = arena}};
}

double woods_processor_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- the suite ----------------------------------------------------------------------------------- */

/* What may be asked for by words. */
static const char *const part_name[WOODS_PARTS] = {"times", "errors", "vehicles", "flight", "seeker"};

/* Bits of the words that are joined by +; all of them where the option is not given. */
static Status read_parts(unsigned *parts, const Bench *bench)
{
    const char *text = bench_option(bench, "parts");
    *parts = text ? 0 : (1u << WOODS_PARTS) - 1;
    for (const char *at = text; at && (at == text || *at);) {
        const size_t length = strcspn(at, "+");
        int          k = 0;
        while (k < WOODS_PARTS && (strlen(part_name[k]) != length || memcmp(part_name[k], at, length) != 0)) k++;
        if (k == WOODS_PARTS) {
            log_error("bench: --parts: '%s' is not some of times, errors, vehicles, flight and seeker, joined by +",
                      text);
            return STATUS_BAD_VALUE;
        }
        *parts |= 1u << k;
        at += length + (at[length] == '+');
    }
    return STATUS_OK;
}

/* Bits of the views whose numbers, from 1, are the digits. */
static Status read_views(unsigned *views, const Bench *bench)
{
    const char *text = bench_option(bench, "views");
    *views = text ? 0 : (1u << woods_views) - 1;
    for (const char *at = text; at && (at == text || *at); at++) {
        if (*at < '1' || *at > '0' + woods_views) {
            log_error("bench: --views: '%s' is not digits of 1 .. %d", text, woods_views);
            return STATUS_BAD_VALUE;
        }
        *views |= 1u << (*at - '1');
    }
    return STATUS_OK;
}

static Status read_trees(double *number, const Bench *bench)
{
    const char *trees = bench_option(bench, "trees");
    *number = bench_quick(bench) ? 30000 : 3000000;
    if (!trees || (text_to_double(number, trees) && *number >= 0 && *number <= woods_most_trees)) return STATUS_OK;
    log_error("bench: --trees: '%s' is not 0 .. %d", trees, woods_most_trees);
    return STATUS_BAD_VALUE;
}

Status bench_woods_check(const Bench *bench)
{
    double       number;
    unsigned     bits;
    const Status status = read_parts(&bits, bench), seen = read_views(&bits, bench);
    return status != STATUS_OK ? status : seen != STATUS_OK ? seen : read_trees(&number, bench);
}

static Status open_bench(WoodsBench *w)
{
    const bool quick = bench_quick(w->bench);
    double     number;
    w->width = quick ? 160 : 720, w->height = quick ? 108 : 486;
    w->east_m = quick ? 1000 : 12000, w->north_m = quick ? 2000 : 16000;
    Status status = read_trees(&number, w->bench);
    if (status == STATUS_OK) status = read_parts(&w->parts, w->bench);
    if (status == STATUS_OK) status = read_views(&w->views, w->bench);
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
    for (int v = 0; v < woods_views; v++) {
        const RenderRequest request = woods_request(w, v, 1);
        WoodsFrame          f = woods_frame(w, 0, &request, w->many, w->arena[0]);
        woods_render(&f);
        if (f.frame.status != STATUS_OK) return f.frame.status;
    }
    woods_say_memory(w, "memory: with frames of all views, full detail", most_mb);
    woods_say(w, "memory: at most until then", bench_memory_mb("VmHWM:"), "MB");
    return STATUS_OK;
}

static Status time_all(WoodsBench *w)
{
    Status status = STATUS_OK;
    for (int v = 0; v < woods_views && status == STATUS_OK; v++)
        if (w->views >> v & 1) status = woods_timings(w, v);
    for (int v = 0; v < woods_views && status == STATUS_OK; v++)
        if (w->views >> v & 1) status = woods_stages(w, v);
    return status;
}

/* Rows of what tables cost, beside full detail. */
static Status judge_all(WoodsBench *w)
{
    const ForestConfig full = config_of(w, 0, false);
    Status             status = STATUS_OK;
    if (!woods_wants(w, WOODS_ERRORS) && !woods_wants(w, WOODS_VEHICLES) && !woods_wants(w, WOODS_FLIGHT))
        return status;
    if (!forest_config(w->forest[0]).all_fine) status = woods_replace(w, 0, &full);
    for (int v = 0; v < woods_views && status == STATUS_OK; v++)
        if (woods_wants(w, WOODS_ERRORS) && w->views >> v & 1) status = woods_errors(w, v);
    if (woods_wants(w, WOODS_VEHICLES) && status == STATUS_OK) status = woods_targets(w);
    if (woods_wants(w, WOODS_FLIGHT) && status == STATUS_OK) status = woods_flight(w);
    if (woods_wants(w, WOODS_FLIGHT) && !bench_quick(w->bench) && status == STATUS_OK) status = woods_far_end(w);
    return status;
}

static Status run_all(WoodsBench *w)
{
    Status status = open_bench(w);
    if (status == STATUS_OK) status = make_ground(w);
    if (status == STATUS_OK) status = make_vehicles(w);
    if (status == STATUS_OK) status = make_woods(w);
    if (status == STATUS_OK) status = make_forest(w, 0);
    if (status == STATUS_OK && woods_wants(w, WOODS_TIMES)) status = say_memories(w);
    if (status == STATUS_OK) status = make_forest(w, 1);
    if (status == STATUS_OK && woods_wants(w, WOODS_TIMES)) status = time_all(w);
    if (status == STATUS_OK && woods_wants(w, WOODS_SEEKER)) status = woods_seeker(w);
    if (status == STATUS_OK) status = judge_all(w);
    woods_say(w, "memory: at most in the whole bench", bench_memory_mb("VmHWM:"), "MB");
    return status;
}

Status bench_woods(Bench *bench)
{
    WoodsBench   w = {.bench = bench};
    const Status status = run_all(&w);
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
