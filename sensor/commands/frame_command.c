/* sensor/commands/frame_command.c: `pitviper frame FILE`: describes a frame file, renders it again, and reports
 * whether the planes are equal to the bit. */
#include "sensor/commands/commands.h"
#include "pitviper_output.h"

#include "sensor/settings/command_line.h"
#include "sensor/commands/overwrite.h"
#include "sensor/verify/saved_frame/saved_again.h"
#include "sensor/verify/saved_frame/saved_scene.h"
#include "sensor/publish/consumers/consumers.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/frame/records.h"
#include "sensor/truth/frame_error.h"
#include "sensor/instruments/camera.h"
#include "sensor/instruments/radar.h"

#include <errno.h>
#include <stdlib.h>
#include <time.h>

enum { path_size = 4096, most_octets = 1 << 29 };

static const char help[] =
    "usage: pitviper frame FILE [options]\n"
    "\n"
    "Re-renders one frame from FILE, written by `pitviper replay LOG --save-frame N`, and verifies that every plane\n"
    "is the same to the bit: exit code 0, else 1. Needs neither the log nor elevation files. Tables and models of\n"
    "this installation must be those of the frame; they are compared by SHA-256.\n"
    "etc/FRAME_FILE.md describes the format.\n"
    "\n"
    "  --out DIR            write its images and its line of truth.jsonl, as replay does\n"
    "  --overwrite          replace the products of an earlier run in DIR; without it that is an error\n"
    "  --threads N          number of threads (default: one per processor)\n"
    "  --no-skip            disable skipping; same output, slower\n"
    "  --force              render with other tables or models too; they are listed\n"
    "  --help               print this help\n";

typedef struct FrameOptions {
    const char *path, *out;
    int         threads;
    bool        overwrite, no_skip, forced;
} FrameOptions;

/* Returns 0 to go on; else the program exits with this code - 1. */
static int parse(FrameOptions *o, int argc, char **argv)
{
    enum { OUT = 256, OVERWRITE, THREADS, NO_SKIP, FORCE, HELP };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"threads", 1, NULL, THREADS},
                                            {"no-skip", 0, NULL, NO_SKIP},
                                            {"force", 0, NULL, FORCE},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    *o = (FrameOptions){.threads = thread_processors()};
    optind = 0; /* start anew */
    for (int option; (option = command_line_option(argc, argv, "h", options)) != -1;) {
        switch (option) {
        case OUT:
            o->out = optarg;
            break;
        case OVERWRITE:
            o->overwrite = true;
            break;
        case NO_SKIP:
            o->no_skip = true;
            break;
        case FORCE:
            o->forced = true;
            break;
        case THREADS:
            if (!command_line_threads(&o->threads, "frame", optarg)) return 1 + 2;
            break;
        case HELP:
        case 'h':
            fputs(help, stdout);
            return 1;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
    }
    if (argc == optind) return 1 + command_line_wrong("frame", "no FILE is named");
    if (argc - optind > 1)
        return 1 + command_line_wrong("frame", "one FILE at a time, not also '%s'", argv[optind + 1]);
    o->path = argv[optind];
    return 0;
}

/* ---- description --------------------------------------------------------------------------------- */

static void describe_ground(const LandscapeParts *g)
{
    char size[64 * elevation_max_levels] = "";
    if (g->invented) {
        log_print("ground: invented, from %d places, %d clear lines, %d places of sea and land\n", g->said.fix_count,
                  g->said.line_count, g->said.place_count);
        return;
    }
    if (g->store && *g->store) {
        log_print("ground: of the terrain store %s\n", g->store);
        return;
    }
    for (int n = 0, at = 0; n < g->elevation.level_count; n++) {
        const ElevationLevel *l = &g->elevation.level[n];
        at += snprintf(size + at, sizeof size - (size_t)at, "%s%d x %d at %.4g m", n ? ", " : "", l->nx, l->ny,
                       l->spacing_m);
    }
    log_print("ground: of files, %s%s%s\n", size, g->cover[0].nx ? ", cover" : "", g->photo.mips ? ", photograph" : "");
}

static void describe(const SavedFrame *file)
{
    const RenderRequest *r = &file->request;
    const time_t         whole = (time_t)floor(file->unix_s + file->time_s);
    struct tm            date;
    char                 utc[32] = "?", bands[64] = "", host[128], version[128];
    if (!gmtime_r(&whole, &date) || strftime(utc, sizeof utc, "%Y-%m-%dT%H:%M:%SZ", &date) == 0) strcpy(utc, "?");
    for (int b = 0, at = 0; b < BAND_COUNT; b++)
        if (r->bands >> b & 1)
            at += snprintf(bands + at, sizeof bands - (size_t)at, "%s%s", at ? "," : "", band_name((Band)b));
    text_escape(host, sizeof host, file->host, strlen(file->host));
    text_escape(version, sizeof version, file->version, strlen(file->version));
    log_print("frame %d of host %s at %.3f s, %s; made by pitviper %s%s\n", file->frame, host, file->time_s, utc,
              version, strcmp(file->version, PITVIPER_VERSION) == 0 ? "" : ", this is " PITVIPER_VERSION);
    log_print("picture: %d x %d, %s; %d entities of %d models, %d puffs of smoke and dust\n", r->view.width,
              r->view.height, bands, file->snapshot.count, file->model_count, file->snapshot.puff_count);
    describe_ground(&file->ground);
    log_print("tables: %d of etc/ and models, by SHA-256\n", file->tables.count);
    for (int i = 0; i < file->tables.count; i++)
        log_detail("frame: %s %.64s", file->tables.table[i].name, file->tables.table[i].sha256);
}

/* ---- its products ------------------------------------------------------------------------------- */

/* Makes the line of truth.jsonl from the image, as the frame loop does. */
static Status write_truth(const char *out, const SavedFrame *file, const SavedScene *s, const SavedAgain *again,
                          const TruthNoise *noise, const RadarFrame *radar, Arena *arena)
{
    char       path[path_size];
    Target    *target = arena_alloc(arena, (size_t)s->snapshot.count + 1, sizeof *target);
    FrameError error;
    RadarError of_radar;
    const int  host = file->eye.host_index;
    if (!target) return STATUS_NO_MEMORY;
    FrameRecord record = {.frame = file->frame,
                          .time_s = file->time_s,
                          .snapshot = &s->snapshot,
                          .catalog = s->catalog,
                          .host = host >= 0 ? &s->snapshot.entity[host] : NULL,
                          .request = &file->request,
                          .hfov_rad = s->config.sensor.hfov_deg * rad_per_deg,
                          .gimbal_at_limit = file->at_limit,
                          .scene_rate_px_s = {file->rate_px_s[0], file->rate_px_s[1]},
                          .ground_km2 = file->ground_km2,
                          .sun = &again->sun,
                          .frame_sha256 = again->made.sha256,
                          .radar = radar};
    memcpy(record.p_eye_ecef, file->eye.p_ecef, sizeof record.p_eye_ecef);
    memcpy(record.v_eye_mps, file->eye.v_ecef_mps, sizeof record.v_eye_mps);
    memcpy(record.r_ecef_from_body, file->r_ecef_from_body, sizeof record.r_ecef_from_body);
    memcpy(record.r_ecef_from_cam, file->eye.r_ecef_from_cam, sizeof record.r_ecef_from_cam);
    record.target_count =
        truth_targets(target, &again->picture, &s->world, &s->snapshot, &file->request, &file->eye, noise);
    if (frame_error(&error,
                    &(FrameErrorOf){&again->picture, &s->world, &s->snapshot, &file->request, s->config.models.sag_m,
                                    file->all_on_ground, world_air_k(&s->world, file->unix_s + file->time_s)},
                    target, record.target_count))
        record.error = &error;
    record.target = target_records(target, record.target_count, &s->snapshot, s->catalog, arena);
    if (!record.target) return STATUS_NO_MEMORY;
    if (file->request.budget && radar) {
        radar_error(&of_radar, radar, &s->snapshot);
        record.radar_error = &of_radar;
    }
    if (snprintf(path, sizeof path, "%s/truth.jsonl", out) >= (int)sizeof path) return STATUS_BAD_VALUE;
    FILE  *to = output_file(path, 0);
    Status status = to ? record_write_frame(to, &record) : STATUS_IO;
    if (to && fclose(to) != 0 && status == STATUS_OK) status = STATUS_IO;
    if (status == STATUS_IO) log_error("frame: cannot write %s: %s", path, output_reason(errno));
    return status;
}

static Status write_radar(const char *out, const SavedFrame *file, const SavedScene *s, const RadarFrame *radar)
{
    Consumer *consumer;
    Frame     frame = {.number = file->frame,
                       .time_s = file->time_s,
                       .unix_s = file->unix_s + file->time_s,
                       .output = {{.kind = &radar_kind, .record = radar}},
                       .outputs = 1};
    snprintf(frame.host, sizeof frame.host, "%s", file->host);
    Status status = consume_radar(&consumer, &(PictureFiles){.out = out, .config = &s->config});
    if (status != STATUS_OK) return status;
    status = consumer->begin(consumer);
    if (status == STATUS_OK) status = consumer->put(consumer, &frame);
    const Status closed = consumer->close(consumer);
    return status == STATUS_OK ? closed : status;
}

/* The camera starts with this frame: what it carries from earlier ones is not in the file. */
static Status write_products(const FrameOptions *o, const SavedFrame *file, SavedScene *s, const SavedAgain *again,
                             const RadarFrame *radar, Pool *pool, Arena *arena)
{
    Camera      *camera = arena_alloc(arena, 1, sizeof *camera);
    FrameDisplay display[BAND_COUNT];
    TruthNoise   noise;
    char         hash[sha256_text_size];
    unsigned     raw = 0;
    Status       status = camera ? camera_open(camera, &s->sensors, &s->config, true) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = camera_observe(camera, &s->sensors, &s->config);
    for (int b = 0; b < BAND_COUNT; b++)
        if (status == STATUS_OK && camera->chain[b] && s->config.detector.raw) raw |= 1u << b;
    const unsigned kept = file->request.bands | (frame_files_truth(&s->config) ? frame_truth : 0);
    if (status == STATUS_OK) status = frame_files_prepare(o->out, kept, raw);
    if (status == STATUS_OK) {
        const DisplaysOf of = {.config = &s->config,
                               .picture = &again->picture,
                               .camera = camera,
                               .frame = file->frame,
                               .time_s = file->time_s,
                               .rate_px_s = {file->rate_px_s[0], file->rate_px_s[1]},
                               .counts = raw != 0};
        status = frame_displays_make(display, &of, file->request.bands, pool, arena);
    }
    if (status == STATUS_OK) {
        const FrameFiles files = {.out = o->out,
                                  .config = &s->config,
                                  .world = &s->world,
                                  .picture = &again->picture,
                                  .snapshot = &s->snapshot,
                                  .request = &file->request,
                                  .host = file->host,
                                  .config_sha256 = file->config_sha256,
                                  .frame = file->frame,
                                  .time_s = file->time_s,
                                  .unix_s = file->unix_s + file->time_s,
                                  .png = s->config.publish.png,
                                  .raw = raw != 0,
                                  .display = display};
        camera_expose(&noise, camera, &again->picture, &s->config);
        status = frame_files_write(hash, &files, pool);
    }
    if (status == STATUS_OK && again->picture.target)
        status = write_truth(o->out, file, s, again, &noise, radar, arena);
    if (status == STATUS_OK && radar) status = write_radar(o->out, file, s, radar);
    if (status == STATUS_OK) log_print("its pictures are in %s/frames\n", o->out);
    if (status == STATUS_OK)
        log_detail("frame: its %s starts with this frame, without what it carries (%s)", camera_kind.name,
                   camera_kind.carries);
    if (camera) camera_close(camera);
    return status;
}

/* ---- rendered again ----------------------------------------------------------------------------- */

/* Measures with the radar again; differ grows by one where the map is another. */
static Status measure(const RadarFrame **out, int *differ, const SavedFrame *file, SavedScene *s,
                      const Picture *picture, Pool *pool, Arena *arena)
{
    bool         same;
    SeekerRadar *radar;
    Status       status = radar_open(&radar, &s->config, "avx2", false, s->cache);
    if (status != STATUS_OK) return status;
    status =
        saved_radar_again(out, radar, &(SavedStage){file, &s->snapshot, &s->world, &s->config, pool, arena}, picture);
    if (status == STATUS_OK) status = saved_radar_same(&same, file, *out);
    /* the preset is the radar's own */
    RadarPreset *preset = status == STATUS_OK ? arena_alloc(arena, 1, sizeof *preset) : NULL;
    RadarFrame  *kept = preset ? arena_alloc(arena, 1, sizeof *kept) : NULL;
    if (status == STATUS_OK && !kept) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        *preset = *(*out)->preset;
        *kept = **out;
        kept->preset = preset;
        *out = kept;
        if (same)
            log_print("the same: the radar's map%s, to the bit; %d detections\n", kept->scan ? " and scan" : "",
                      kept->detections_in_all);
        else
            log_error("frame: the radar's map%s differs; %d detections, were %d", kept->scan ? " or scan" : "",
                      kept->detections_in_all, file->radar.detections);
        *differ += !same;
    }
    seeker_radar_destroy(radar);
    return status;
}

static Status show(int *differ, const FrameOptions *o, const SavedFrame *file, SavedScene *s, Pool *pool, Arena *arena)
{
    SavedAgain *again = arena_alloc(arena, 1, sizeof *again);
    if (!again) return STATUS_NO_MEMORY;
    const double begun_s = wall_clock_s();
    Status       status =
        saved_again(again, &(SavedStage){file, &s->snapshot, &s->world, &s->config, pool, arena}, o->no_skip);
    if (status != STATUS_OK) return status;
    log_detail("frame: rendered in %.0f ms", 1e3 * (wall_clock_s() - begun_s));
    *differ = saved_differences(file, &again->made, true);
    if (*differ == 0)
        log_print("the same: all %d planes, to the bit; frame %.64s\n", file->plane_count, again->made.sha256);
    else
        log_error("frame: %d of %d planes differ; frame %.64s, was %.64s%s", *differ, file->plane_count,
                  again->made.sha256, file->frame_sha256,
                  strcmp(file->version, PITVIPER_VERSION) == 0 ? "" : "; another version of pitviper made it");
    const RadarFrame *radar = NULL;
    if (file->measured) status = measure(&radar, differ, file, s, &again->picture, pool, arena);
    return status == STATUS_OK && o->out ? write_products(o, file, s, again, radar, pool, arena) : status;
}

int frame_command(int argc, char **argv)
{
    FrameOptions o;
    char        *bytes = NULL;
    size_t       count;
    int          differ = 0;
    SavedScene  *scene = NULL;
    SavedFrame  *file = NULL;
    Pool        *pool = NULL;
    const int    stop = parse(&o, argc, argv);
    if (stop) return stop - 1;
    thread_flush_denormals();
    Arena *arena = arena_create();
    scene = arena ? arena_alloc(arena, 1, sizeof *scene) : NULL;
    file = arena ? arena_alloc(arena, 1, sizeof *file) : NULL;
    Status status = scene && file ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = text_read_file(&bytes, &count, "frame", o.path, most_octets);
    if (status == STATUS_OK) status = saved_frame_parse(file, (const uint8_t *)bytes, count, o.path, arena);
    if (status == STATUS_OK) describe(file);
    if (status == STATUS_OK && o.out) status = overwrite_folder("frame", o.out, o.overwrite);
    if (status == STATUS_OK && o.out) status = image_file_prepare();
    if (status == STATUS_OK) status = pool_create(&pool, o.threads);
    if (status == STATUS_OK) status = saved_scene_open(scene, file, o.forced, "avx2", pool);
    if (status == STATUS_OK) status = show(&differ, &o, file, scene, pool, arena);
    if (status == STATUS_NO_MEMORY) log_error("frame: out of memory");
    if (scene) saved_scene_close(scene);
    pool_destroy(pool);
    free(bytes);
    arena_destroy(arena);
    return status != STATUS_OK || differ > 0 ? 1 : 0;
}
