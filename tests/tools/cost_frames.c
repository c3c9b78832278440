/* cost_frames [FRAME ...|--about]: renders small frames at the default quality, for etc/cost to count their
 * instructions.
 *
 * One thread, one processor, one small ground with its heat, woods and vehicles, set up once. Every frame is rendered
 * twice: first whole, which also fills whatever is made on first use, then `render` alone, the call that is counted.
 * Under `valgrind --tool=callgrind --instr-atstart=no` the count of each frame is dumped under its name; set-up and
 * first frames are not counted. Standard output is CSV, a frame a line, with the frame's own counters; lines with # say
 * what the count depends on, --about prints these alone. */
#include "tests/scenes/town.h"
#include "tests/scenes/woods_stand.h"
#include "sensor/quality/trial_private.h"
#include "sensor/settings/config.h"
#include "terrain/ground/landscape.h"

#include <gnu/libc-version.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef PITVIPER_CALLGRIND
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_START_INSTRUMENTATION ((void)0)
#define CALLGRIND_STOP_INSTRUMENTATION  ((void)0)
#define CALLGRIND_ZERO_STATS            ((void)0)
#define CALLGRIND_DUMP_STATS_AT(name)   ((void)(name))
#endif

enum { width = 64, height = 48, trees = 3000 };

static const double   east_m = 600, north_m = 2100;
static const unsigned all_bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR | 1u << BAND_RADAR;

typedef enum Place { BARE, WOODS, FEW, VEHICLES, CROWD, SMOKE, VILLAGE, places } Place;

/* What is seen from where: the view of the origin from back_m south of it and above_m over the ground. */
typedef struct CostFrame {
    const char *name;
    Place       place;
    double      back_m, above_m, hfov_deg;
    unsigned    bands;
    bool        truth;
    bool        whole; /* counted with snapshot, air and truth of targets, not `render` alone */
    Sampling    sampling;
} CostFrame;

static const CostFrame frames[] = {
    {"ground", BARE, 60, 30, 20, all_bands, true, false, SAMPLING_ALL},
    {"borders", BARE, 900, 300, 40, all_bands, true, false, SAMPLING_ALL},
    {"woods-near", WOODS, 80, 12, 30, all_bands, true, false, SAMPLING_ALL},
    {"woods-far", WOODS, 1000, 200, 30, all_bands, true, false, SAMPLING_ALL},
    {"vehicles", VEHICLES, 150, 40, 40, 1u << BAND_LWIR, false, false, SAMPLING_ALL},
    {"small-targets", FEW, 1000, 150, 12, all_bands, true, false, SAMPLING_ALL},
    {"crowd", CROWD, 150, 40, 34, 1u << BAND_LWIR, true, false, SAMPLING_ALL},
    {"smoke", SMOKE, 150, 20, 40, all_bands, true, false, SAMPLING_ALL},
    {"radar", FEW, 600, 100, 16, 1u << BAND_RADAR, true, false, SAMPLING_ALL},
    {"whole", BARE, 900, 300, 40, all_bands, true, true, SAMPLING_ALL},
    {"high", BARE, 1e5, 1e4, 20, all_bands, true, true, SAMPLING_ALL},
    {"quarter", WOODS, 1000, 200, 30, all_bands, true, false, SAMPLING_QUARTER},
    {"village", VILLAGE, 150, 30, 40, all_bands, true, false, SAMPLING_ALL},
    {"village-far", VILLAGE, 1000, 250, 16, all_bands, true, false, SAMPLING_ALL},
};
enum { frame_count = sizeof frames / sizeof *frames };

static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0},
                                      {1, 1, 222, 2, 1, 0, 0},
                                      {1, 1, 222, 1, 1, 1, 0},
                                      {1, 1, 222, 28, 1, 0, 0},
                                      {1, 1, 222, 7, 1, 0, 0}};
enum { type_count = sizeof types / sizeof *types };

static struct {
    LocalFrame frame;
    Landscape  landscape;
    Woods      woods;
    Catalog   *catalog;
    Scenery    village;
    World      world; /* the one that is closed: scenes have copies, most without its plants, its village or both */
    TrialScene scene[places];
    Pool      *pool;
    Arena     *arena;
} stage;

/* ---- set-up --------------------------------------------------------------------------------- */

/* A hundred houses in their streets, sixty cars, trailers and buses about them, of which four drive. */
static Status build_village(void)
{
    const TownOf of = {.buildings = 100, .clutter = 60, .movers = 4, .landscape = &stage.landscape, .seed = 8};
    const Status status = town_create(&stage.village, &of);
    return status == STATUS_OK ? world_scenery(&stage.world, &stage.village, "avx2", stage.pool) : status;
}

/* Few steps and facets, no shadows: a hit reads its temperature the same way, and the warm-up is short. */
static Status warm_world(double unix_s)
{
    HeatConfig heat = heat_default_config();
    heat.unix_s = unix_s;
    heat.step_s = 3600, heat.spin_up_s = 6 * 3600;
    heat.facets = 3;
    return world_warm_clear(&stage.world, &heat, 0, NULL);
}

static Status open_world(double *unix_s)
{
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    double         times_s[2];
    char           catalog[512];
    if (!etc_path(catalog, sizeof catalog, "catalog.csv") || !text_to_unix_s(unix_s, "2026-06-21T11:15:00Z"))
        return STATUS_BAD_VALUE;
    if (!(stage.arena = arena_create())) return STATUS_NO_MEMORY;
    Status status = pool_create(&stage.pool, 1);
    if (status == STATUS_OK) status = local_frame_at(&stage.frame, &origin);
    if (status == STATUS_OK)
        status = landscape_quick(&stage.landscape, times_s, &stage.frame, east_m, north_m, stage.pool);
    if (status == STATUS_OK) status = catalog_open(&stage.catalog, catalog, 0.01);
    if (status == STATUS_OK) status = world_open(&stage.world, stage.catalog, &stage.landscape, &stage.frame, "avx2");
    return status == STATUS_OK ? atmosphere_open(&stage.world.atmosphere, "us1976") : status;
}

/* Trees over all of the ground but for the vehicles' places. As world_plant does, without forest_openness: the light
 * between leaves costs the same whatever its value. */
static Status plant_world(void)
{
    const Config       config = config_default();
    const ForestConfig forest = {.leaves = true,
                                 .level1_px = config.terrain.woods_level1_px,
                                 .fine = true,
                                 .sway = config.terrain.woods_sway,
                                 .tables = config.terrain.woods_tables};
    WoodsStand         stand = {.landscape = &stage.landscape, .east_m = east_m, .north_m = north_m, .trees = trees};
    for (int k = 0; k < type_count; k++)
        stand.clear[stand.clears++] = (WoodsPath){{40.0 * k - 80, 0}, {40.0 * k - 80, 0}, 6, 6};
    World *world = &stage.world;
    char   optics[512], ground[512];
    if (!etc_path(optics, sizeof optics, "plant_optics.csv") || !etc_path(ground, sizeof ground, "woods.csv"))
        return STATUS_BAD_VALUE;
    Status status = woods_stand_create(&stage.woods, &stand, stage.pool);
    if (status == STATUS_OK) status = materials_add_plants(&world->materials, optics, ground);
    if (status == STATUS_OK) status = plants_create(&world->plants, 1995, stage.pool);
    if (status == STATUS_OK) status = forest_create(&world->forest, &stage.woods, world->plants, &forest, "avx2");
    if (status != STATUS_OK) return status;
    return canopy_create(&world->canopy, &stage.woods, world->plants, &world->materials, forest.leaves);
}

static double dice(uint32_t stream, int k) { return random_uniform(1995, stream, 0, (uint64_t)k); }

static Status place_vehicle(const TrialScene *scene, int k, double at_east_m, double at_north_m, uint32_t appearance)
{
    const TrialPlace place = {.type = types[k % type_count],
                              .number = k + 1,
                              .east_m = at_east_m,
                              .north_m = at_north_m,
                              .turn_rad = 2 * pi_rad * dice(1, k),
                              .appearance = appearance};
    return trial_scene_place(scene, &place);
}

/* Appearance of a land platform: bit 22, its engine runs; bits 5 and 6, it smokes. */
static Status populate(TrialScene *scene, Place place)
{
    const uint32_t running = 1u << 22, smoking = 3u << 5;
    const int      vehicles = place == BARE || place == VILLAGE ? 0 : place == VEHICLES ? 20 : place == CROWD ? 250 : 5;
    Status         status = STATUS_OK;
    for (int later = 0; later < (place == SMOKE ? 3 : 1) && status == STATUS_OK; later++) {
        for (int k = 0; k < vehicles && status == STATUS_OK; k++) {
            const bool   crowd = place == CROWD;
            const double at_east_m = crowd ? 60 * (dice(2, k) - 0.5) : 40.0 * (k % type_count) - 80;
            const double at_north_m = crowd ? 60 * (dice(3, k) - 0.5) : 40.0 * (k / type_count);
            status = place_vehicle(scene, k, at_east_m, at_north_m, running | (place == SMOKE ? smoking : 0));
        }
        if (place == SMOKE && later < 2) scene->sun_now_s += 4;
    }
    return status;
}

static Status open_scene(Place place, double unix_s)
{
    TrialScene       *scene = &stage.scene[place];
    EntityTableConfig config = entity_table_default_config();
    *scene = (TrialScene){.landscape = &stage.landscape,
                          .catalog = stage.catalog,
                          .world = stage.world,
                          .unix_s = unix_s,
                          .sun_now_s = 60};
    if (place != WOODS) scene->world.plants = NULL, scene->world.forest = NULL, scene->world.canopy = NULL;
    if (place != VILLAGE) scene->world.scenery = NULL, scene->world.horizons = NULL;
    if (place == CROWD)
        scene->world.heat = NULL; /* hundreds of vehicles would warm up for longer than all frames take */
    config.ground = (ContactGround){.frame = &stage.frame, .elevation = &stage.landscape.elevation};
    const Status status = entity_table_create(&scene->table, &config, stage.catalog);
    return status == STATUS_OK ? populate(scene, place) : status;
}

/* ---- frames --------------------------------------------------------------------------------- */

static RenderRequest request_of(const CostFrame *f)
{
    const TrialScene *scene = &stage.scene[f->place];
    const View        view = trial_view(scene, f->back_m, f->above_m, f->hfov_deg * rad_per_deg, width, height);
    RenderRequest     request = trial_default_request(scene, &view, f->back_m);
    request.bands = f->bands;
    request.truth = f->truth;
    request.sampling = f->sampling;
    if (!(f->bands >> BAND_RADAR & 1)) request.profile_bins = 0;
    return request;
}

static Status count_frame(Picture *out, const CostFrame *f)
{
    TrialFrame frame = {
        .scene = &stage.scene[f->place], .request = request_of(f), .pool = stage.pool, .arena = stage.arena};
    Picture again;
    trial_frame(&frame);
    if (frame.status != STATUS_OK) return frame.status;
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    if (f->whole) {
        trial_frame(&frame);
        again = frame.picture;
    } else {
        frame.status =
            render(&again, &frame.scene->world, &frame.snapshot, &frame.request, &frame.air, stage.pool, stage.arena);
    }
    CALLGRIND_DUMP_STATS_AT(f->name);
    CALLGRIND_STOP_INSTRUMENTATION;
    *out = again;
    return frame.status;
}

static void print_frame(const CostFrame *f, const Picture *picture)
{
    const RenderCounters *c = &picture->counters;
    const uint64_t        value[] = {
               c->rays_primary,           c->rays_edges,     c->rays_small_targets, c->visibility.rays_sun_ground,
               c->visibility.rays_plants, c->pixels_refined, c->small_targets};
    fputs(f->name, stdout);
    for (size_t k = 0; k < sizeof value / sizeof *value; k++) printf(",%llu", (unsigned long long)value[k]);
    putchar('\n');
    fflush(stdout);
}

static bool chosen(const CostFrame *f, int argc, char **argv)
{
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], f->name) == 0) return true;
    return argc == 1;
}

static Status count_all(int argc, char **argv)
{
    double unix_s;
    Status status = open_world(&unix_s);
    if (status == STATUS_OK) status = plant_world();
    if (status == STATUS_OK) status = warm_world(unix_s);
    if (status == STATUS_OK) status = build_village();
    for (Place place = 0; place < places && status == STATUS_OK; place++) status = open_scene(place, unix_s);
    for (int k = 0; k < frame_count && status == STATUS_OK; k++) {
        Picture picture;
        if (!chosen(&frames[k], argc, argv)) continue;
        status = count_frame(&picture, &frames[k]);
        if (status == STATUS_OK) print_frame(&frames[k], &picture);
    }
    return status;
}

static void close_all(void)
{
    for (Place place = 0; place < places; place++) {
        world_vehicles_destroy(stage.scene[place].vehicles);
        entity_table_destroy(stage.scene[place].table);
    }
    world_close(&stage.world);
    scenery_free(&stage.village);
    woods_destroy(&stage.woods);
    catalog_close(stage.catalog);
    landscape_destroy(&stage.landscape);
    arena_destroy(stage.arena);
    pool_destroy(stage.pool);
}

/* Embree builds its trees with as many threads as there are processors to run on. */
static void run_on_one_processor(void)
{
    cpu_set_t all, one;
    if (sched_getaffinity(0, sizeof all, &all) != 0) return;
    CPU_ZERO(&one);
    for (int k = 0; k < CPU_SETSIZE && CPU_COUNT(&one) == 0; k++)
        if (CPU_ISSET(k, &all)) CPU_SET(k, &one);
    if (sched_setaffinity(0, sizeof one, &one) != 0) log_warn("cost_frames: not on one processor alone");
}

int main(int argc, char **argv)
{
#ifdef __clang__
    printf("# compiler: clang %s\n", __clang_version__);
#else
    printf("# compiler: gcc %s\n", __VERSION__);
#endif
    printf("# build: %s\n# glibc: %s\n", PITVIPER_BUILD_TYPE, gnu_get_libc_version());
#ifdef PITVIPER_CALLGRIND
    puts("# callgrind: yes");
#endif
    if (argc == 2 && strcmp(argv[1], "--about") == 0) return 0;
    puts("frame,rays,rays_edges,rays_small_targets,rays_sun,rays_plants,pixels_refined,small_targets");
    run_on_one_processor();
    thread_flush_denormals();
    const Status status = count_all(argc, argv);
    if (status != STATUS_OK) log_error("cost_frames: %s", status_name(status));
    close_all();
    return status != STATUS_OK;
}
