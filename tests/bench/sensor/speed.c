/* tests/bench/sensor/speed.c: the rows of `bench speed`, from the ground up to files.
 *
 * A ratio is of interleaved runs: frame, frame of one ray per pixel and the rays alone alternate. Stages are of one
 * thread, where they add up. Every timed frame has its planes compared with those of one thread without skips. */
#include "tests/bench/suites.h"
#include "tests/bench/sensor/speed_private.h"
#include "sensor/settings/config.h"

#include <stdlib.h>

enum { views = 4, vehicles = 20, vehicles_quick = 5 };

static const struct {
    const char *name;
    double      back_m, above_m;
} places[views] = {{"40 m up", 300, 40}, {"100 m up", 600, 100}, {"300 m up", 1500, 300}, {"1000 m up", 3000, 1000}};
static const double hfov_rad = 40 * (3.14159265358979323846 / 180);

/* ---- frames ----------------------------------------------------------------------------------- */

RenderRequest speed_request(const View *view, unsigned bands, bool truth)
{
    const Config config = config_default();
    return (RenderRequest){.view = *view,
                           .bands = bands,
                           .truth = truth,
                           .optical = OPTICAL_RGB,
                           .samples = 1,
                           .edge_samples = config.sensor.edge_samples,
                           .target_samples = config.sensor.target_samples,
                           .sky_visibility = config.sensor.sky_visibility,
                           .hidden_entity = -1};
}

/* Without antialiasing: no edges, and small targets are sampled like any. */
static RenderRequest one_ray(const RenderRequest *request)
{
    RenderRequest plain = *request;
    plain.edge_samples = plain.target_samples = 0;
    return plain;
}

TrialFrame speed_frame(const Speed *s, const TrialScene *scene, const RenderRequest *request, bool many)
{
    return (TrialFrame){
        .scene = scene, .request = *request, .pool = many ? s->many : s->one, .arena = s->arena[many ? 0 : 1]};
}

/* Returns 0 when these planes are those of one thread without skips, else 1; NaN: the comparison failed. */
static double differs(const Speed *s, const TrialFrame *frame)
{
    TrialFrame plain = *frame;
    char       hash[sha256_text_size], plain_hash[sha256_text_size];
    plain.pool = s->one;
    plain.arena = s->arena[2];
    plain.request.skips_off = skips_all_off;
    trial_frame(&plain);
    if (plain.status != STATUS_OK || trial_frame_hash(hash, frame) != STATUS_OK ||
        trial_frame_hash(plain_hash, &plain) != STATUS_OK)
        return NAN;
    return strcmp(hash, plain_hash) != 0;
}

void speed_judge_bits(BenchRow *row, const Speed *s, const TrialFrame *frame)
{
    row->error = differs(s, frame);
    row->error_limit = 0;
    row->error_unit = "differ";
    row->against = "planes of one thread, nothing skipped";
}

static void judge_frame(BenchRow *row, const TrialFrame *frame)
{
    if (frame->status != STATUS_OK) row->error = NAN, row->error_limit = 0, row->against = status_name(frame->status);
}

/* ---- four views ------------------------------------------------------------------------------- */

/* Root of the mean squared difference over all radiance planes, each relative to its own mean. */
static double rms_of(const Picture *a, const Picture *b)
{
    const size_t count = (size_t)a->width * (size_t)a->height;
    double       sum = 0;
    int          planes = 0;
    for (int k = 0; k < picture_plane_count; k++) {
        const float *p = picture_plane(a, k), *q = picture_plane(b, k);
        double       square = 0, mean = 0;
        if (!p || !q) continue;
        for (size_t i = 0; i < count; i++) {
            square += ((double)p[i] - (double)q[i]) * ((double)p[i] - (double)q[i]);
            mean += q[i];
        }
        sum += square * (double)count / (mean * mean);
        planes++;
    }
    return sqrt(sum / planes);
}

/* Renders a central piece, 96 x 64 px or less, adaptively and plain, and compares both with 16 x 16 rays in every
 * pixel. */
static double antialias_error(const Speed *s, const RenderRequest *request, double *plain)
{
    TrialFrame fine = {.scene = &s->scene, .request = *request, .pool = s->many, .arena = s->arena[2]};
    fine.request.view.width = bench_quick(s->bench) ? 32 : 96;
    fine.request.view.height = bench_quick(s->bench) ? 24 : 64;
    TrialFrame adaptive = fine, single = fine;
    fine.request.samples = 16;
    fine.request.edge_samples = fine.request.target_samples = 0;
    single.request = one_ray(&single.request);
    adaptive.arena = s->arena[0];
    single.arena = s->arena[1];
    trial_frame(&fine);
    trial_frame(&adaptive);
    trial_frame(&single);
    if (fine.status != STATUS_OK || adaptive.status != STATUS_OK || single.status != STATUS_OK) return NAN;
    *plain = rms_of(&single.picture, &fine.picture);
    return rms_of(&adaptive.picture, &fine.picture);
}

static Status time_view(Speed *s, int v)
{
    enum { MANY, ONE, SIMPLE, SIMPLE_ONE, RAW, RAW_ONE, WORKS };
    const View view = trial_view(&s->scene, places[v].back_m, places[v].above_m, hfov_rad, s->width, s->height);
    const RenderRequest request = speed_request(&view, three_bands, true), simple_request = one_ray(&request);
    char                what[what_size];
    BenchTime           time[WORKS];
    RawRays            *raw = NULL, *raw_one = NULL;
    BenchRow            row;
    TrialFrame many = speed_frame(s, &s->scene, &request, true), one = speed_frame(s, &s->scene, &request, false);
    TrialFrame simple = speed_frame(s, &s->scene, &simple_request, true);
    TrialFrame simple_one = speed_frame(s, &s->scene, &simple_request, false), shown = simple;

    bench_progress(s->bench, places[v].name);
    shown.arena = s->arena[2];
    trial_frame(&shown);
    Status status = shown.status;
    if (status == STATUS_OK) status = raw_rays_create(&raw, &shown);
    if (status == STATUS_OK) status = raw_rays_create(&raw_one, &shown);
    if (status != STATUS_OK) goto done;
    const double rays = raw_rays_count(raw);
    raw_use_pool(raw_one, s->one);
    const BenchWork work[WORKS] = {{trial_frame, &many, 1},       {trial_frame, &one, 1}, {trial_frame, &simple, 1},
                                   {trial_frame, &simple_one, 1}, {raw_trace, raw, 1},    {raw_trace, raw_one, 1}};
    bench_time(time, s->bench, work, WORKS);

    /* frames share arenas, so each is rendered once more before its planes are compared */
    snprintf(what, sizeof what, "%s: frame, 3 bands and truth, %s", places[v].name, all_threads);
    row = bench_row_of(what, &time[MANY], "frames/s", 1);
    row.ratio = bench_ratio(&time[MANY], &time[RAW]);
    row.to = "rays alone";
    trial_frame(&many);
    speed_judge_bits(&row, s, &many);
    judge_frame(&row, &many);
    bench_add(s->bench, &row);

    snprintf(what, sizeof what, "%s: the same, 1 thread", places[v].name);
    row = bench_row_of(what, &time[ONE], "frames/s", 1);
    row.ratio = bench_ratio(&time[ONE], &time[MANY]);
    row.to = all_threads;
    bench_add(s->bench, &row);

    double plain_error = NAN;
    snprintf(what, sizeof what, "%s: one ray a pixel, %s", places[v].name, all_threads);
    const double adaptive_error = antialias_error(s, &request, &plain_error);
    row = bench_row_of(what, &time[SIMPLE], "frames/s", 1);
    row.ratio = bench_ratio(&time[SIMPLE], &time[RAW]);
    row.to = "rays alone";
    row.error = 100 * plain_error;
    row.error_unit = "%";
    row.against = "rms against 256 rays a pixel";
    bench_add(s->bench, &row);

    snprintf(what, sizeof what, "%s: adaptive edges and small targets", places[v].name);
    row = bench_row(what);
    row.ratio = bench_ratio(&time[MANY], &time[SIMPLE]);
    row.to = "one ray a pixel";
    row.error = 100 * adaptive_error;
    row.error_limit = 100 * plain_error;
    row.error_unit = "%";
    row.against = "rms against 256 rays a pixel; limit: that of one ray";
    bench_add(s->bench, &row);

    snprintf(what, sizeof what, "%s: its rays alone, %s", places[v].name, all_threads);
    row = bench_row_of(what, &time[RAW], "M rays/s", 1e6 / rays);
    row.ratio = bench_ratio(&time[RAW_ONE], &time[RAW]);
    row.to = "1 thread / this";
    row.error = raw_worst_m(raw, bench_quick(s->bench) ? 977 : 397);
    row.error_limit =
        1e-6; /* of positions of 1e4 m in double, 1e-12 m, at grazing angles of 1e-3 and heights of 1e-9 m */
    row.error_unit = "m";
    row.against = "range, against a plain walk in double";
    bench_add(s->bench, &row);

done:
    raw_rays_destroy(raw);
    raw_rays_destroy(raw_one);
    return status;
}

/* ---- stages ----------------------------------------------------------------------------------- */

static const struct {
    TrialStage  stage;
    const char *name;
} stage_names[] = {{STAGE_FRAME, "frame"},
                   {STAGE_SNAPSHOT, "snapshot"},
                   {STAGE_AIR, "air"},
                   {STAGE_PREPARE, "prepare: planes, poses, boxes"},
                   {STAGE_VISIBILITY, "visibility"},
                   {STAGE_SUN, "sun rays"},
                   {STAGE_SHADE, "shading"},
                   {STAGE_RADAR, "radar"},
                   {STAGE_REST, "rest: truth planes, areas, edges found"},
                   {STAGE_TRUTH, "truth of targets"},
                   {STAGE_FOOTPRINTS, "of all this: pass over small targets"},
                   {STAGE_BASE, "of all this: pass over every pixel"},
                   {STAGE_EDGES, "of all this: pass over edges"}};

/* Times the stages of these frames, interleaved, on one thread; gives a frame's mean. */
static Status time_stages(Speed *s, const char *name, TrialFrame *frame, int count)
{
    BenchTime      time[TRIAL_STAGE_COUNT] = {0}, hash_time = {0};
    RenderCounters counters = {0};
    const int      rounds = bench_quick(s->bench) ? 3 : 9;
    char           what[what_size], hash[sha256_text_size];
    for (int r = -1; r < rounds; r++)
        for (int k = 0; k < count; k++) {
            trial_frame(&frame[k]);
            if (frame[k].status != STATUS_OK) return frame[k].status;
            if (r < 0) render_counters_add(&counters, &frame[k].picture.counters);
            const double start_s = wall_clock_s();
            const Status status = trial_frame_hash(hash, &frame[k]);
            if (status != STATUS_OK) return status;
            for (int stage = 0; r >= 0 && stage < TRIAL_STAGE_COUNT; stage++)
                time[stage].item_s[r] += frame[k].stage_s[stage] / count;
            if (r >= 0) hash_time.item_s[r] += (wall_clock_s() - start_s) / count;
        }
    for (int stage = 0; stage < TRIAL_STAGE_COUNT; stage++) {
        time[stage].rounds = rounds;
        bench_time_finish(&time[stage]);
    }
    hash_time.rounds = rounds;
    bench_time_finish(&hash_time);
    for (size_t k = 0; k < sizeof stage_names / sizeof *stage_names; k++) {
        const TrialStage stage = stage_names[k].stage;
        const double     rays = stage == STAGE_VISIBILITY ? (double)counters.rays_primary / count
                                : stage == STAGE_SUN      ? (double)counters.visibility.rays_sun_ground / count
                                                          : NAN;
        if (!(time[stage].best_s > 0)) continue;
        snprintf(what, sizeof what, "%s: %s", name, stage_names[k].name);
        BenchRow row = bench_row_of(what, &time[stage], isnan(rays) ? NULL : "M rays/s", 1e6 / rays);
        row.ratio = bench_ratio(&time[stage], &time[STAGE_FRAME]);
        row.to = "frame";
        bench_add(s->bench, &row);
    }
    snprintf(what, sizeof what, "%s: hash of the planes, behind the frame", name);
    BenchRow row = bench_row_of(what, &hash_time, NULL, 1);
    row.ratio = bench_ratio(&hash_time, &time[STAGE_FRAME]);
    row.to = "frame";
    bench_add(s->bench, &row);
    return STATUS_OK;
}

/* ---- single images -------------------------------------------------------------------------- */

static Status time_picture(Speed *s, const char *name, const TrialScene *scene, const RenderRequest *request)
{
    TrialFrame many = speed_frame(s, scene, request, true), one = speed_frame(s, scene, request, false);
    char       what[what_size];
    BenchTime  time[2];
    bench_progress(s->bench, name);
    const BenchWork work[2] = {{trial_frame, &many, 1}, {trial_frame, &one, 1}};
    bench_time(time, s->bench, work, 2);
    snprintf(what, sizeof what, "%s, %s", name, all_threads);
    BenchRow row = bench_row_of(what, &time[0], "frames/s", 1);
    row.ratio = bench_ratio(&time[1], &time[0]);
    row.to = "1 thread / this";
    speed_judge_bits(&row, s, &many);
    judge_frame(&row, &many);
    bench_add(s->bench, &row);
    return many.status;
}

/* Times a frame with one ray a pixel, and with the antialiasing of the default. */
static Status time_pair(Speed *s, const char *name, const TrialScene *scene, const RenderRequest *request)
{
    const RenderRequest plain = one_ray(request);
    char                what[what_size];
    snprintf(what, sizeof what, "%.100s: one ray a pixel", name);
    const Status status = time_picture(s, what, scene, &plain);
    return status == STATUS_OK ? time_picture(s, name, scene, request) : status;
}

/* Times a close frame with one ray a pixel, with the edges of the default, and optical alone. */
static Status time_close(Speed *s)
{
    Status status = speed_open_close(s);
    if (status != STATUS_OK) return status;
    char          name[what_size];
    TrialFrame    first = {.scene = &s->close, .pool = s->many, .arena = s->arena[2]};
    RenderRequest request;
    View          view = trial_view(&s->close, 30, 6, 20 * rad_per_deg, s->width, s->height);
    request = speed_request(&view, three_bands, true);
    first.request = request;
    trial_frame(&first);
    if (first.status != STATUS_OK) return first.status;
    /* its own area relative to the image, except for corners that it leaves */
    request.view.focal_px *= sqrt(1.5 * s->width * s->height / first.picture.target[0].visible);
    first.request = request;
    trial_frame(&first);
    if (first.status != STATUS_OK) return first.status;
    const RenderRequest plain = one_ray(&request);
    RenderRequest       optical = plain;
    optical.bands = 1u << BAND_OPTICAL;
    optical.truth = false;
    BenchRow share = bench_row("close target: pixels that it covers");
    share.median = 100 * first.picture.target[0].visible / ((double)s->width * s->height);
    share.unit = "%";
    share.against = s->target;
    bench_add(s->bench, &share);
    snprintf(name, sizeof name, "close target");
    status = time_pair(s, name, &s->close, &request);
    snprintf(name, sizeof name, "close target: optical alone, one ray a pixel");
    if (status == STATUS_OK) status = time_picture(s, name, &s->close, &optical);
    TrialFrame simple = speed_frame(s, &s->close, &plain, false), one = speed_frame(s, &s->close, &request, false);
    if (status == STATUS_OK) status = time_stages(s, "close target, one ray a pixel, 1 thread", &simple, 1);
    if (status == STATUS_OK) status = time_stages(s, "close target, 1 thread", &one, 1);
    return status == STATUS_OK ? speed_gloss(s, &request) : status;
}

/* ---- the suite -------------------------------------------------------------------------------- */

static Status time_all(Speed *s)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0},
                                          {1, 1, 222, 2, 1, 0, 0},
                                          {1, 1, 222, 1, 1, 1, 0},
                                          {1, 1, 222, 28, 1, 0, 0},
                                          {1, 1, 222, 7, 1, 0, 0}};
    char                       catalog[512];
    Status                     status = speed_open(s);
    if (status == STATUS_OK) status = speed_make_ground(s);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    const double start_s = wall_clock_s();
    if (status == STATUS_OK)
        status = trial_scene_open(&s->scene, &s->landscape, catalog, types, sizeof types / sizeof *types,
                                  bench_quick(s->bench) ? vehicles_quick : vehicles);
    if (status != STATUS_OK) return status;
    BenchRow row = bench_row("start: catalog, tracer, materials, air");
    row.median = wall_clock_s() - start_s;
    row.unit = "s";
    bench_add(s->bench, &row);

    TrialFrame frame[views];
    for (int v = 0; v < views && status == STATUS_OK; v++) {
        const View view = trial_view(&s->scene, places[v].back_m, places[v].above_m, hfov_rad, s->width, s->height);
        const RenderRequest request = speed_request(&view, three_bands, true);
        frame[v] = speed_frame(s, &s->scene, &request, false);
        status = time_view(s, v);
    }
    if (status == STATUS_OK) status = time_stages(s, "mean of the views, 1 thread", frame, views);

    const View    small = trial_view(&s->scene, places[1].back_m, places[1].above_m, 20 * rad_per_deg, 256, 256);
    RenderRequest lwir = speed_request(&small, 1u << BAND_LWIR, false);
    if (status == STATUS_OK) status = time_pair(s, "256 x 256, LWIR alone", &s->scene, &lwir);
    TrialFrame lwir_frame = speed_frame(s, &s->scene, &lwir, false);
    if (status == STATUS_OK) status = time_stages(s, "LWIR alone, 1 thread", &lwir_frame, 1);
    lwir.truth = true;
    if (status == STATUS_OK) status = time_pair(s, "256 x 256, LWIR and truth", &s->scene, &lwir);
    if (status == STATUS_OK) status = time_close(s);
    const View wide = trial_view(&s->scene, places[1].back_m, places[1].above_m, hfov_rad, s->width, s->height);
    const RenderRequest radar = speed_request(&wide, 1u << BAND_RADAR, true);
    if (status == STATUS_OK) status = time_picture(s, "100 m up: radar alone, truth", &s->scene, &radar);
    const RenderRequest usual = trial_default_request(&s->scene, &wide, places[1].back_m);
    if (status == STATUS_OK)
        status = time_picture(s, "100 m up: default quality, all bands, truth and its error", &s->scene, &usual);
    const RenderRequest wide_request = speed_request(&wide, three_bands, true);
    if (status == STATUS_OK) status = speed_twilight(s, &wide_request);
    if (status == STATUS_OK) status = speed_files(s);
    if (status == STATUS_OK) status = speed_heat(s);
    if (status == STATUS_OK) status = speed_start(s);
    if (status == STATUS_OK) speed_memory(s);
    return status;
}

bool speed_wants(const Bench *bench, const char *rows)
{
    const char *bands = bench_option(bench, "bands");
    return !bands || strcmp(bands, rows) == 0;
}

Status bench_speed(Bench *bench)
{
    if (!speed_wants(bench, "optical")) return STATUS_OK;
    Speed        s = {.bench = bench};
    const Status status = time_all(&s);
    if (status != STATUS_OK) log_error("bench: speed: %s", status_name(status));
    speed_close(&s);
    return status;
}
