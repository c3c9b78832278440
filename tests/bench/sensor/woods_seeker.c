/* tests/bench/sensor/woods_seeker.c: the frame of a seeker with two cameras and a radar among trees: optical, 8-12 um,
 * and seeker_35 with its phases, ground and foliage, whose signatures are at hand; twenty vehicles, their turrets and
 * guns turned. Far plants are in tables, the default. */
#include "tests/bench/sensor/radar_update.h"
#include "tests/bench/sensor/woods_private.h"

enum { pose = 0, rounds_full = 7, rounds_quick = 2 };

static const char *const preset = "seeker_35";
static const unsigned    two_cameras = 1u << BAND_OPTICAL | 1u << BAND_LWIR;

/* What a row is of. */
typedef enum Kind {
    KIND_WHOLE,        /* both cameras with truth and the estimate of the error, as a node asks for them; the radar */
    KIND_WHOLE_ONE,    /* the same on one thread */
    KIND_BARE,         /* without truth */
    KIND_PICTURE,      /* both cameras with truth; one thread, and those that follow too */
    KIND_PICTURE_BARE, /* both cameras alone */
    KIND_OPTICAL,
    KIND_LWIR,
    KIND_RADAR,
    KINDS
} Kind;

static const struct {
    const char *name;
    unsigned    bands; /* of cameras; 0: none */
    bool        truth, radar, many;
} kinds[KINDS] = {
    {"optical, 8-12 um, radar, with truth", two_cameras, true, true, true},
    {"the same, 1 thread", two_cameras, true, true, false},
    {"optical, 8-12 um, radar, without truth", two_cameras, false, true, true},
    {"optical, 8-12 um, with truth, 1 thread", two_cameras, true, false, false},
    {"optical, 8-12 um, 1 thread", two_cameras, false, false, false},
    {"optical, 1 thread", 1u << BAND_OPTICAL, false, false, false},
    {"8-12 um, 1 thread", 1u << BAND_LWIR, false, false, false},
    {"radar, 1 thread", 0, false, true, false},
};

typedef struct SeekerFrame {
    WoodsFrame  picture;
    RadarUpdate radar;
    Kind        kind;
} SeekerFrame;

static RenderRequest request_of(const WoodsBench *w, Kind kind, double aim_m)
{
    const View    view = woods_view(w, pose);
    RenderRequest request = trial_default_request(&w->scene, &view, aim_m);
    request.bands = kinds[kind].bands;
    request.truth = kinds[kind].truth;
    request.budget &= kinds[kind].truth;
    request.profile_bins = 0;
    return request;
}

static void make_frame(SeekerFrame *f)
{
    f->picture.w->scene.world.forest = f->picture.w->forest[1];
    if (kinds[f->kind].bands) woods_render(&f->picture);
    if (kinds[f->kind].radar) radar_update(&f->radar);
}

static Status status_of(const SeekerFrame *f)
{
    return kinds[f->kind].bands && f->picture.frame.status != STATUS_OK ? f->picture.frame.status : f->radar.status;
}

/* ---- its own errors ------------------------------------------------------------------------------- */

/* 1: planes or map differ from those of one thread with nothing skipped. */
static double differs(const SeekerFrame *many, Arena *arena)
{
    SeekerFrame  one = *many;
    WoodsBench  *w = many->picture.w;
    char         hash[2][sha256_text_size];
    const size_t cells =
        (size_t)interval_channels * (size_t)many->radar.frame->map.rows * (size_t)many->radar.frame->map.columns;
    one.picture.frame.pool = one.radar.pool = w->one;
    one.picture.frame.arena = w->arena[1];
    one.radar.arena = arena;
    one.picture.frame.request.skips_off = skips_all_off;
    make_frame(&one);
    if (status_of(&one) != STATUS_OK || trial_frame_hash(hash[0], &one.picture.frame) != STATUS_OK ||
        trial_frame_hash(hash[1], &many->picture.frame) != STATUS_OK)
        return NAN;
    return strcmp(hash[0], hash[1]) != 0 || memcmp(one.radar.frame->map.cell, many->radar.frame->map.cell,
                                                   cells * sizeof *one.radar.frame->map.cell) != 0;
}

/* ---- rows ----------------------------------------------------------------------------------------- */

static void say_frame(WoodsBench *w, Kind kind, const BenchTime time[KINDS], double differ)
{
    char what[what_size];
    snprintf(what, sizeof what, "seeker: %s%s", kinds[kind].name, kinds[kind].many ? ", all threads" : "");
    BenchRow row = bench_row_of(what, &time[kind], "frames/s", 1);
    row.ratio = kind == KIND_WHOLE ? NAN : bench_ratio(&time[kind], &time[KIND_WHOLE]);
    row.to = kind == KIND_WHOLE ? NULL : "the first";
    if (!isnan(differ)) {
        row.error = differ, row.error_limit = 0, row.error_unit = "differ";
        row.against = "planes and map of one thread, nothing skipped";
    }
    bench_add(w->bench, &row);
}

static void say_stages(WoodsBench *w, BenchTime *radar, BenchTime *picture)
{
    static const char *const of_radar[RADAR_STEPS] = {
        "aim, air, foliage by direction", "entities", "ground", "plants", "echoes summed", "receiver and processing"};
    static const struct {
        TrialStage  stage;
        const char *name;
    } of_picture[] = {{STAGE_AIR, "air"},
                      {STAGE_PREPARE, "prepare, low plants"},
                      {STAGE_VISIBILITY, "visibility"},
                      {STAGE_SUN, "sun rays"},
                      {STAGE_SHADE, "shading"},
                      {STAGE_REST, "rest: truth, edges, estimate of the error"},
                      {STAGE_TRUTH, "truth of targets"},
                      {STAGE_FOOTPRINTS, "of all this: pass over small targets"},
                      {STAGE_BASE, "of all this: pass over every pixel"},
                      {STAGE_EDGES, "of all this: pass over edges"}};
    char what[what_size];
    for (int s = 0; s < RADAR_STEPS; s++) {
        bench_time_finish(&radar[s]);
        snprintf(what, sizeof what, "seeker: radar, 1 thread: %s", of_radar[s]);
        const BenchRow row = bench_row_of(what, &radar[s], NULL, 1);
        bench_add(w->bench, &row);
    }
    for (size_t k = 0; k < sizeof of_picture / sizeof *of_picture; k++) {
        BenchTime *time = &picture[of_picture[k].stage];
        bench_time_finish(time);
        snprintf(what, sizeof what, "seeker: optical, 8-12 um, with truth, 1 thread: %s", of_picture[k].name);
        const BenchRow row = bench_row_of(what, time, NULL, 1);
        bench_add(w->bench, &row);
    }
}

/* Frames of all kinds in turn, and the stages of those that are of one thread; the first round is to warm up. */
static Status time_frames(WoodsBench *w, SeekerFrame frame[KINDS], Arena *spare)
{
    const int rounds = bench_quick(w->bench) ? rounds_quick : rounds_full;
    BenchTime time[KINDS] = {{0}}, radar[RADAR_STEPS] = {{0}}, picture[TRIAL_STAGE_COUNT] = {{0}};
    for (int k = 0; k < KINDS; k++) time[k].rounds = rounds;
    for (int s = 0; s < RADAR_STEPS; s++) radar[s].rounds = rounds;
    for (int s = 0; s < TRIAL_STAGE_COUNT; s++) picture[s].rounds = rounds;
    for (int r = -1; r < rounds; r++)
        for (int k = 0; k < KINDS; k++) {
            const double start_s = wall_clock_s();
            make_frame(&frame[k]);
            const double spent_s = wall_clock_s() - start_s;
            if (status_of(&frame[k]) != STATUS_OK) return status_of(&frame[k]);
            if (r < 0) continue;
            time[k].item_s[r] = spent_s;
            for (int s = 0; s < RADAR_STEPS && k == KIND_RADAR; s++)
                radar[s].item_s[r] = frame[k].radar.frame->step_s[s];
            for (int s = 0; s < TRIAL_STAGE_COUNT && k == KIND_PICTURE; s++)
                picture[s].item_s[r] = frame[k].picture.frame.stage_s[s];
        }
    for (int k = 0; k < KINDS; k++) bench_time_finish(&time[k]);
    make_frame(&frame[KIND_WHOLE]);
    const double differ = differs(&frame[KIND_WHOLE], spare);
    for (int k = 0; k < KINDS; k++) say_frame(w, (Kind)k, time, k == KIND_WHOLE ? differ : NAN);
    say_stages(w, radar, picture);
    return STATUS_OK;
}

static Status say_radar(WoodsBench *w, const RadarFrame *f)
{
    woods_say(w, "seeker: entities in beam and window", f->targets, "");
    woods_say(w, "seeker: their echoes", f->echoes, "");
    woods_say(w, "seeker: scatterers of the ground", f->ground_cells, "");
    woods_say(w, "seeker: crowns", f->crowns, "");
    if (f->targets == woods_vehicles && f->crowns > 0) return STATUS_OK;
    log_error("bench: woods: %d of %d vehicles and %d crowns are in the radar's beam", f->targets, woods_vehicles,
              f->crowns);
    return STATUS_BAD_VALUE;
}

Status woods_seeker(WoodsBench *w)
{
    SeekerFrame   frame[KINDS];
    Snapshot      snapshot;
    char          catalog[4096];
    SeekerRadar  *radar = NULL;
    Arena        *arena[2] = {arena_create(), arena_create()}; /* of the radar's frames; of its snapshot */
    Arena        *spare = arena_create();
    const View    view = woods_view(w, pose);
    const Weather weather = weather_default();
    const double  middle[3] = {0, 0, elevation_height(&w->landscape.elevation, 0, 0, NULL) + 1};
    double        to_aim[3];
    Status        status = arena[0] && arena[1] && spare ? STATUS_OK : STATUS_NO_MEMORY;
    w->scene.world.forest = w->forest[1];
    v3_sub(to_aim, middle, view.p_enu);
    const double aim_m = v3_length(to_aim);
    if (status == STATUS_OK)
        status = entity_table_snapshot(&snapshot, w->scene.table, w->scene.sun_now_s + 0.5, arena[1]);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    bench_progress(w->bench, "signatures of vehicles among trees");
    if (status == STATUS_OK)
        status = seeker_radar_create(&radar, &(SeekerRadarConfig){.preset = preset,
                                                                  .catalog = catalog,
                                                                  .ground = true,
                                                                  .ground_bounce = true,
                                                                  .warp_m = 1e-3,
                                                                  .seed = 1});
    for (int k = 0; k < KINDS && status == STATUS_OK; k++) {
        const RenderRequest request = request_of(w, (Kind)k, aim_m);
        Pool               *pool = kinds[k].many ? w->many : w->one;
        frame[k] = (SeekerFrame){.kind = (Kind)k, .picture = woods_frame(w, 1, &request, pool, w->arena[0])};
        frame[k].radar = (RadarUpdate){.radar = radar,
                                       .scene = {.world = &w->scene.world,
                                                 .snapshot = &snapshot,
                                                 .view = &view,
                                                 .hidden = -1,
                                                 .v_enu_mps = {0, 200, -17},
                                                 .reference_m = aim_m,
                                                 .t_s = 1,
                                                 .weather = &weather,
                                                 .number = 1,
                                                 .coarse = bench_quick(w->bench)}, /* signatures take seconds */
                                       .pool = pool,
                                       .arena = arena[0]};
    }
    if (status == STATUS_OK) { /* makes the signatures */
        radar_update(&frame[KIND_WHOLE].radar);
        status = frame[KIND_WHOLE].radar.status;
    }
    if (status == STATUS_OK) status = say_radar(w, frame[KIND_WHOLE].radar.frame);
    bench_progress(w->bench, "two cameras and a radar");
    if (status == STATUS_OK) status = time_frames(w, frame, spare);
    seeker_radar_destroy(radar);
    for (int k = 0; k < 2; k++) arena_destroy(arena[k]);
    arena_destroy(spare);
    return status;
}
