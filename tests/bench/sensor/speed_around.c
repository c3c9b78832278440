/* tests/bench/sensor/speed_around.c: what is done around frames. Before the first: the set-up of a world by its parts,
 * as a node with the default settings makes it over synthetic terrain; and variants of a sweep, the first of
 * which does all of it. After one: its files, and the memory of the process. */
#include "pitviper_output.h"
#include "tests/bench/sensor/node_process.h"
#include "tests/bench/sensor/speed_private.h"
#include "sensor/settings/config.h"
#include "sensor/frame/frame_world.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"
#include "terrain/ground/landscape.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- the set-up ------------------------------------------------------------------------------- */

enum { vehicles = 20 };

typedef struct Start {
    Speed     *speed;
    Landscape  landscape;
    Woods      woods;
    TrialScene scene;
    double     begun_s, sum_s;
} Start;

/* Prints the time since the last line. */
static void say(Start *s, const char *part)
{
    char         what[what_size];
    const double now_s = wall_clock_s();
    snprintf(what, sizeof what, "set-up: %s, %s", part, all_threads);
    BenchRow row = bench_row(what);
    row.median = row.best = now_s - s->begun_s;
    row.unit = "s";
    bench_add(s->speed->bench, &row);
    s->sum_s += row.median;
    s->begun_s = wall_clock_s();
}

/* Places plants in a square as wide as a node's about one vehicle (sensor/node/choices/woods_choice.c). */
static Status stand(Start *s, const Config *config)
{
    const double      half_m = config->terrain.woods_half_m >= 50 ? config->terrain.woods_half_m : 4000;
    const WoodsConfig woods = {
        .seed = (uint64_t)config->seed, .most_trees = config->terrain.woods_trees, .half_width_m = half_m};
    return woods_create(&s->woods, &s->landscape, &woods, s->speed->many);
}

/* Vehicles in rows, whose temperatures the first frame needs. */
static Status warm_vehicles(Start *s)
{
    static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0};
    EntityTableConfig          config = entity_table_default_config();
    Snapshot                   snapshot;
    config.ground = (ContactGround){.frame = &s->landscape.frame, .elevation = &s->landscape.elevation};
    Status status = entity_table_create(&s->scene.table, &config, s->scene.catalog);
    for (int k = 0; k < vehicles && status == STATUS_OK; k++) {
        const TrialPlace place = {.type = tank,
                                  .number = k + 1,
                                  .east_m = 40.0 * (k % 5),
                                  .north_m = 40.0 * (k / 5),
                                  .turn_rad = k,
                                  .appearance = 1u << 22};
        status = trial_scene_place(&s->scene, &place);
    }
    arena_reset(s->speed->arena[2]);
    if (status == STATUS_OK)
        status = entity_table_snapshot(&snapshot, s->scene.table, s->scene.sun_now_s + 0.5, s->speed->arena[2]);
    return status == STATUS_OK ? trial_warm(&s->scene, &snapshot, s->speed->arena[2]) : status;
}

static Status time_setup(Start *s)
{
    const Config    config = config_default();
    LandscapeConfig land = landscape_default_config();
    char            catalog[512];
    World          *world = &s->scene.world;
    bench_progress(s->speed->bench, "set-up of a world");
    s->scene = (TrialScene){.landscape = &s->landscape, .unix_s = s->speed->scene.unix_s, .sun_now_s = 60};
    land.relief_m = config.terrain.relief_m;
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;

    s->begun_s = wall_clock_s();
    Status status = landscape_create(&s->landscape, &land, &s->speed->frame, NULL, 0, NULL, 0);
    if (status != STATUS_OK) return status;
    say(s, "ground");
    if ((status = catalog_open(&s->scene.catalog, catalog, config.models.sag_m)) != STATUS_OK) return status;
    status = frame_world(world, &config, s->scene.catalog, &s->landscape, &s->landscape.frame, NULL);
    if (status != STATUS_OK) return status;
    say(s, "catalog, materials, air");
    if ((status = stand(s, &config)) != STATUS_OK) return status;
    say(s, "places of plants");
    if ((status = frame_world_plant(world, &s->woods, &config, NULL, s->speed->many)) != STATUS_OK) return status;
    say(s, "plants grown");
    if ((status = frame_world_warm(world, &config, s->scene.unix_s, s->speed->many)) != STATUS_OK) return status;
    say(s, "ground warmed up");
    if ((status = warm_vehicles(s)) != STATUS_OK) return status;
    say(s, "twenty tanks warmed up");
    BenchRow row = bench_row("set-up: all of these, all threads");
    row.median = row.best = s->sum_s;
    row.unit = "s";
    bench_add(s->speed->bench, &row);
    return STATUS_OK;
}

/* ---- a sweep ------------------------------------------------------------------------------------ */

/* Removes everything in a folder made by temp_folder. */
static void remove_tree(const char *path)
{
    char        inside[4096];
    struct stat is;
    DIR        *folder = lstat(path, &is) == 0 && S_ISDIR(is.st_mode) ? opendir(path) : NULL;
    for (struct dirent *e; folder && (e = readdir(folder));)
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0 &&
            (size_t)snprintf(inside, sizeof inside, "%s/%s", path, e->d_name) < sizeof inside)
            remove_tree(inside);
    if (folder) closedir(folder);
    remove(path);
}

/* pitviper with these arguments, to its end; what it says goes to a file. -1: it failed, and is reported. */
static double run_s(const char *const *argument, const char *said)
{
    struct rusage unused;
    const double  begun_s = wall_clock_s();
    const int     out = output_open(said, 0);
    const pid_t   child = out < 0 ? -1 : node_start(argument, out, out);
    const int     code = child > 0 ? node_finish(child, 600, &unused) : -1;
    if (out >= 0) close(out);
    if (code == 0) return wall_clock_s() - begun_s;
    log_error("bench: pitviper %s ended with %d", argument[1], code);
    return -1;
}

/* The times of the variants in a sweep's manifest, s; how many there are. */
static int variants_s(double *seconds, int most, const char *out)
{
    static const char field[] = "\"seconds\":";
    char              path[temp_name_size + 16], *text;
    size_t            octets;
    int               count = 0;
    snprintf(path, sizeof path, "%s/manifest.jsonl", out);
    if (text_read_file(&text, &octets, "bench", path, 1 << 20) != STATUS_OK) return 0;
    for (const char *at = text; count < most && (at = strstr(at, field)); at += sizeof field)
        seconds[count++] = strtod(at + sizeof field - 1, NULL);
    free(text);
    return count;
}

/* Of one sweep of variants that differ in aim, range and detector, which no set-up follows from, a frame each: the
 * first one, which makes the world, and those that take it over. */
static Status time_sweep(Speed *s)
{
    enum { most = 9 };
    const int variants = bench_quick(s->bench) ? 3 : most;
    char folder[temp_path_size], log[temp_name_size], sweep[temp_name_size], out[temp_name_size], said[temp_name_size];
    double took_s[most], sum_s = 0;
    if (!temp_folder(folder)) return STATUS_IO;
    snprintf(log, sizeof log, "%s/demo.pcap", folder);
    snprintf(sweep, sizeof sweep, "%s/sweep.yaml", folder);
    snprintf(out, sizeof out, "%s/out", folder);
    snprintf(said, sizeof said, "%s/said.txt", folder);
    const char *const exercise[] = {"pitviper", "exercise", "demo", "-o", log, NULL};
    const char *const replay[] = {"pitviper", "replay", log,     "--size", "96x64", "--only",       "14", "--no-files",
                                  "--sweep",  sweep,    "--out", out,      "--set", "cache.on=off", NULL};
    FILE             *file = output_file(sweep, 0);
    bool              ok = file && fprintf(file, "mode: zip\naxes:\n  exercise.host: observer\n") > 0;
    for (int k = 0; k < 3; k++) {
        static const char *const axis[] = {"exercise.aim", "observer.range_m", "detector.gain"};
        for (int i = 0; i < variants; i++) {
            char value[32];
            if (k == 0) snprintf(value, sizeof value, "\"1:3001:%d\"", 11 + i % 3);
            else snprintf(value, sizeof value, "%g", k == 1 ? 400.0 + 50 * i : 1 + 0.1 * i);
            ok = ok && fprintf(file, i == 0 ? "  %s: [" : "%s", i == 0 ? axis[k] : ", ") > 0 && fputs(value, file) >= 0;
        }
        ok = ok && fputs("]\n", file) >= 0;
    }
    ok = file && fclose(file) == 0 && ok;
    bench_progress(s->bench, "a sweep");
    ok = ok && run_s(exercise, said) >= 0 && run_s(replay, said) >= 0 && variants_s(took_s, most, out) == variants;
    remove_tree(folder);
    if (!ok) return STATUS_IO;
    BenchRow row = bench_row("sweep: a variant of the demonstration, one frame of 96 x 64, all threads");
    row.median = row.best = took_s[0];
    row.unit = "s";
    row.rate = 1 / took_s[0], row.rate_unit = "variants/s";
    bench_add(s->bench, &row);
    for (int i = 1; i < variants; i++) sum_s += took_s[i];
    row = bench_row("sweep: a further one, of another aim, range and detector");
    row.median = row.best = sum_s / (variants - 1);
    row.unit = "s";
    row.rate = took_s[0] / row.median, row.rate_unit = "x the first";
    bench_add(s->bench, &row);
    return STATUS_OK;
}

Status speed_start(Speed *speed)
{
    static Start s; /* its scene is pointed to */
    s = (Start){.speed = speed};
    const Status status = time_setup(&s);
    trial_scene_close(&s.scene);
    woods_destroy(&s.woods);
    landscape_destroy(&s.landscape);
    return status == STATUS_OK ? time_sweep(speed) : status;
}

/* ---- files -------------------------------------------------------------------------------------- */

typedef struct Encode {
    FrameFiles   files;
    DisplaysOf   shown;
    FrameDisplay display[BAND_COUNT];
    Pool        *pool;
    Arena       *arena;
    Status       status;
    char         hash[sha256_text_size];
} Encode;

static void encode(void *user)
{
    Encode *e = user;
    arena_reset(e->arena);
    e->status = STATUS_OK;
    if (e->files.png)
        e->status = frame_displays_make(e->display, &e->shown, e->files.request->bands, e->pool, e->arena);
    if (e->status == STATUS_OK) e->status = frame_files_write(e->hash, &e->files, e->pool);
}

/* Counts the values of the file's planes that differ from those of the picture. */
static double differing(const char *out, const Picture *p)
{
    const size_t count = (size_t)p->width * (size_t)p->height;
    char         path[temp_name_size];
    float       *read = malloc(count * sizeof *read);
    double       bad = NAN;
    snprintf(path, sizeof path, "%s/frames/lwir/000000.exr", out);
    if (read && image_read_f32(read, path, "Y") == STATUS_OK) {
        bad = 0;
        for (size_t i = 0; i < count; i++) bad += memcmp(&read[i], &p->lwir[i], sizeof *read) != 0;
    }
    free(read);
    return bad;
}

static void remove_folder(const char *out)
{
    static const char *const parts[] = {"optical", "mwir", "lwir", "truth"};
    char                     path[temp_name_size];
    for (int k = 0; k < 4; k++)
        for (int e = 0; e < 3; e++) {
            snprintf(path, sizeof path, "%s/frames/%s%s", out, parts[k],
                     e == 0   ? "/000000.exr"
                     : e == 1 ? "/000000.png"
                              : "");
            remove(path);
        }
    snprintf(path, sizeof path, "%s/frames", out);
    remove(path);
    remove(out);
}

Status speed_files(Speed *s)
{
    const Config        config = config_default();
    const View          view = trial_view(&s->scene, 600, 100, 40 * rad_per_deg, s->width, s->height);
    const RenderRequest request = speed_request(&view, three_bands, true);
    TrialFrame          frame = speed_frame(s, &s->scene, &request, true);
    Camera              camera = {.chain = {NULL}};
    char                out[temp_path_size], what[what_size];
    BenchTime           time[2];
    bench_progress(s->bench, "files");
    trial_frame(&frame);
    Status status = frame.status;
    if (status == STATUS_OK && !temp_folder(out)) status = STATUS_IO;
    if (status != STATUS_OK) return status;
    Arena *arena = arena_create();
    if (!arena) return STATUS_NO_MEMORY;
    status = frame_files_prepare(out, three_bands | frame_truth, 0);
    Encode with = {.pool = s->many,
                   .files = {.out = out,
                             .config = &config,
                             .world = &s->scene.world,
                             .picture = &frame.picture,
                             .snapshot = &frame.snapshot,
                             .request = &frame.request,
                             .host = "observer",
                             .config_sha256 = "",
                             .unix_s = s->scene.unix_s,
                             .png = true},
                   .shown = {.config = &config, .picture = &frame.picture, .camera = &camera},
                   .arena = arena};
    Encode without = with;
    with.files.display = with.display;
    without.files.png = false;
    const BenchWork work[2] = {{encode, &with, 1}, {encode, &without, 1}};
    if (status == STATUS_OK) bench_time(time, s->bench, work, 2);
    if (status == STATUS_OK) status = with.status != STATUS_OK ? with.status : without.status;
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        snprintf(what, sizeof what, "files of a frame: EXR%s and hash, %s", k ? "" : ", PNG", all_threads);
        BenchRow row = bench_row_of(what, &time[k], "frames/s", 1);
        row.error = differing(out, &frame.picture);
        row.error_limit = 0;
        row.error_unit = "values";
        row.against = "read again";
        bench_add(s->bench, &row);
    }
    remove_folder(out);
    arena_destroy(arena);
    return status;
}

/* ---- memory ----------------------------------------------------------------------------------- */

void speed_memory(Speed *s)
{
    size_t posts, pyramids;
    landscape_quick_bytes(&posts, &pyramids, &s->landscape.elevation);
    const struct {
        const char *what;
        double      mb;
    } rows[] = {{"memory: posts", 1e-6 * (double)posts},
                {"memory: their pyramid", 1e-6 * (double)pyramids},
                {"memory: arena of a frame", 1e-6 * (double)arena_bytes(s->arena[0])},
                {"memory: resident at the end", bench_memory_mb("VmRSS:")},
                {"memory: resident at most", bench_memory_mb("VmHWM:")}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        BenchRow row = bench_row(rows[k].what);
        row.median = rows[k].mb;
        row.unit = "MB";
        bench_add(s->bench, &row);
    }
}
