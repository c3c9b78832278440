/* tests/bench/sensor/precision_frame.c: the number of rays of a frame: over pixels, edges, small targets, to the
 * sky, and between mirrors. */
#include "tests/bench/suites.h"
#include "tests/bench/sensor/precision.h"

/* ---- over pixels and edges -------------------------------------------------------------------- */

typedef struct RaySetting {
    const char *name;
    int         samples, edge_samples;
    bool        is_default;
} RaySetting;

static const RaySetting rays[] = {{"1 x 1", 1, 0, false},
                                  {"2 x 2", 2, 0, false},
                                  {"3 x 3", 3, 0, false},
                                  {"4 x 4", 4, 0, false},
                                  {"1 x 1, edges 2 x 2", 1, 2, false},
                                  {"1 x 1, edges 3 x 3", 1, 3, false},
                                  {"1 x 1, edges 4 x 4", 1, 4, true},
                                  {"1 x 1, edges 6 x 6", 1, 6, false},
                                  {"1 x 1, edges 8 x 8", 1, 8, false}};
enum { ray_settings = sizeof rays / sizeof *rays };

typedef struct Rendering {
    Precision        *p;
    int               width, height;
    const RaySetting *setting;
} Rendering;

static RenderRequest request_of(const Rendering *r, PrecisionShot shot)
{
    RenderRequest request = precision_request(r->p, shot, r->width, r->height);
    request.samples = r->setting->samples;
    request.edge_samples = r->setting->edge_samples;
    if (request.edge_samples <= request.samples) request.target_samples = 0; /* sensor.antialias: off */
    return request;
}

static void render_all(void *user)
{
    const Rendering *r = user;
    for (int s = 0; s < SHOT_COUNT; s++) {
        const RenderRequest request = request_of(r, (PrecisionShot)s);
        Picture             picture;
        arena_reset(r->p->arena);
        const Status status = precision_render(&picture, r->p, (PrecisionShot)s, &request, r->p->arena);
        if (status != STATUS_OK) r->p->status = status;
        bench_keep(&picture);
    }
}

/* Errors of all settings in all shots, against 16 x 16 rays in every pixel of a piece of each. */
static Status ray_errors(Precision *p, double (*rms)[ray_settings], double (*rms_k)[ray_settings])
{
    static const RaySetting finest = {"16 x 16", 16, 0, false};
    const bool              quick = bench_quick(p->bench);
    Rendering               r = {p, quick ? 32 : 96, quick ? 24 : 64, &finest};
    Status                  status = STATUS_OK;
    for (int s = 0; s < SHOT_COUNT && status == STATUS_OK; s++) {
        Picture fine;
        r.setting = &finest;
        const RenderRequest request = request_of(&r, (PrecisionShot)s);
        arena_reset(p->other);
        status = precision_render(&fine, p, (PrecisionShot)s, &request, p->other);
        for (int k = 0; k < ray_settings && status == STATUS_OK; k++) {
            Picture picture;
            r.setting = &rays[k];
            const RenderRequest coarse = request_of(&r, (PrecisionShot)s);
            arena_reset(p->arena);
            status = precision_render(&picture, p, (PrecisionShot)s, &coarse, p->arena);
            if (status != STATUS_OK) break;
            rms[s][k] = 100 * precision_rms(&picture, &fine);
            rms_k[s][k] = precision_rms_k(&picture, &fine, p->scene.world.planck_lwir);
        }
    }
    return status;
}

/* The worst shot of each setting; returns that of the default. */
static int worst_shot(BenchSetting *point, double (*error)[ray_settings])
{
    int named = 0;
    for (int k = 0; k < ray_settings; k++) {
        int worst = 0;
        for (int s = 1; s < SHOT_COUNT; s++)
            if (!(error[s][k] <= error[worst][k])) worst = s;
        point[k].error = error[worst][k];
        if (rays[k].is_default) named = worst;
    }
    return named;
}

static Status tunable_rays(Precision *p)
{
    Rendering    r[ray_settings];
    BenchWork    work[ray_settings];
    BenchSetting point[ray_settings] = {0};
    double       rms[SHOT_COUNT][ray_settings], rms_k[SHOT_COUNT][ray_settings];
    char         of[96], against[96];
    bench_progress(p->bench, "antialiasing");
    const Status status = ray_errors(p, rms, rms_k);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < ray_settings; k++) {
        r[k] = (Rendering){p, p->shot_px[0], p->shot_px[1], &rays[k]};
        work[k] = (BenchWork){render_all, &r[k], SHOT_COUNT};
        point[k] = (BenchSetting){.setting = rays[k].name, .is_default = rays[k].is_default};
    }
    snprintf(of, sizeof of, "a picture of %d x %d, three bands and truth", p->shot_px[0], p->shot_px[1]);
    worst_shot(point, rms_k);
    for (int k = 0; k < ray_settings; k++) point[k].also = point[k].error;
    point[0].also_is = "of 8-12 um, K";
    snprintf(against, sizeof against, "rms, 16 x 16 rays; worst: %s", precision_shot_name[worst_shot(point, rms)]);
    bench_tunable(p->bench, &(BenchTunable){"rays a pixel", "sensor.samples, sensor.edge_samples", of, "%", against, 6},
                  work, point, ray_settings);
    for (int k = 0; k < ray_settings; k++) point[k].also = point[k].error;
    point[0].also_is = "of radiance, %";
    snprintf(against, sizeof against, "rms, 16 x 16 rays; worst: %s", precision_shot_name[worst_shot(point, rms_k)]);
    bench_tunable_rows(
        p->bench, &(BenchTunable){"rays a pixel, 8-12 um", "sensor.samples, sensor.edge_samples", of, "K", against, 1},
        point, ray_settings);
    return p->status;
}

/* ---- over small targets ------------------------------------------------------------------------ */

static const int target_samples[] = {8, 16, 32, 48, 64, 96, 128, 256};
enum {
    target_settings = sizeof target_samples / sizeof *target_samples,
    target_sizes = 3,
    target_turns = 16,
    fine_px = 200
};
static const double target_px[target_sizes] = {25, 5, 0.5};

typedef struct TargetShot {
    Precision *p;
    int        samples;
} TargetShot;

static PrecisionShot target_shot(int size) { return size == 0 ? SHOT_NEAR : SHOT_SMALL; }

/* Requests the central truck from one side or another, so many pixels long. */
static RenderRequest target_request(const Precision *p, int size, int turn, double px, int side_px)
{
    RenderRequest request = precision_request(p, target_shot(size), side_px, side_px);
    request.view.focal_px = px * precision_go_round(&request.view, p, turn) / 7.4;
    request.sky_visibility = false; /* its grid follows the size on the image; its error has a row of its own */
    return request;
}

/* Its radiance times solid angle, per band; false: it is not visible. */
static bool target_shines(double out[picture_plane_count], Precision *p, int size, const RenderRequest *request)
{
    Picture picture;
    arena_reset(p->arena);
    const Status        status = precision_render(&picture, p, target_shot(size), request, p->arena);
    const Snapshot     *snapshot = &p->shot[target_shot(size)].snapshot;
    const int           truck = snapshot_find(snapshot, (DisEntityId){1, 1, 3});
    const TargetPixels *t = status == STATUS_OK ? &picture.target[truck] : NULL;
    if (!t) {
        p->status = status;
        return false;
    }
    for (int k = 0; k < picture_plane_count; k++)
        out[k] = t->radiance[k] / (request->view.focal_px * request->view.focal_px);
    return t->visible > 0;
}

static void render_targets(void *user)
{
    const TargetShot *t = user;
    for (int n = 0; n < target_sizes; n++) {
        RenderRequest request = target_request(t->p, n, 0, target_px[n], 32);
        double        out[picture_plane_count];
        request.target_samples = t->samples;
        target_shines(out, t->p, n, &request);
        bench_keep(out);
    }
}

/* Against the same truck through a lens of so long a focal length that it fills the image, 2 x 2 rays a pixel or
 * more: 400 across it. The worst band of each image; the root of the mean square over sides and sizes. */
static void target_errors(Precision *p, double error[target_settings])
{
    const int turns = bench_quick(p->bench) ? 2 : target_turns;
    memset(error, 0, target_settings * sizeof *error);
    for (int n = 0; n < target_sizes; n++)
        for (int turn = 0; turn < turns; turn++) {
            RenderRequest fine = target_request(p, n, turn, fine_px, fine_px + 24);
            double        want[picture_plane_count], got[picture_plane_count];
            fine.samples = bench_quick(p->bench) ? 2 : 4;
            fine.edge_samples = fine.target_samples = 0;
            bool seen = target_shines(want, p, n, &fine);
            for (int k = 0; k < (bench_quick(p->bench) ? target_settings - 3 : target_settings); k++) {
                RenderRequest request = target_request(p, n, turn, target_px[n], 32);
                double        worst = 0;
                request.target_samples = target_samples[k];
                seen = target_shines(got, p, n, &request) && seen;
                for (int b = 0; b < picture_plane_count; b++)
                    if (want[b] > 0 || !seen) bench_worst(&worst, seen ? fabs(got[b] / want[b] - 1) : NAN);
                error[k] += worst * worst / (turns * target_sizes);
            }
        }
    for (int k = 0; k < target_settings; k++) error[k] = sqrt(error[k]);
}

static Status tunable_targets(Precision *p)
{
    TargetShot   shot[target_settings];
    BenchWork    work[target_settings];
    BenchSetting point[target_settings] = {0};
    double       error[target_settings];
    char         name[target_settings][24];
    bench_progress(p->bench, "small targets");
    target_errors(p, error);
    for (int k = 0; k < target_settings; k++) {
        shot[k] = (TargetShot){.p = p, .samples = target_samples[k]};
        snprintf(name[k], sizeof name[k], "%d x %d", target_samples[k], target_samples[k]);
        work[k] = (BenchWork){render_targets, &shot[k], target_sizes};
        point[k] = (BenchSetting){.setting = name[k], .error = 100 * error[k], .is_default = target_samples[k] == 48};
    }
    bench_tunable(p->bench,
                  &(BenchTunable){"rays over a small target", "sensor.target_samples",
                                  "a picture of 32 x 32 and a truck of 25, 5, 0.5 px, three bands", "%",
                                  "W/sr of a truck, worst band, rms over sides and sizes; 400 rays across", 2},
                  work, point, bench_quick(p->bench) ? target_settings - 3 : target_settings);
    return p->status;
}

/* ---- to the sky -------------------------------------------------------------------------------- */

static const int sky_samples[] = {0, 0, 4, 16, 64, 256};
enum { sky_near = 1 }; /* the setting with sensor.sky_visibility */
enum { sky_settings = sizeof sky_samples / sizeof *sky_samples, sky_shots = 2 };
static const PrecisionShot sky_shot[sky_shots] = {SHOT_NEAR, SHOT_GROUND};

typedef struct SkyRendering {
    Precision *p;
    int        samples, width, height;
    bool       visibility;
} SkyRendering;

/* One ray a pixel, so that no other quantity is sampled. */
static RenderRequest sky_request(const SkyRendering *r, PrecisionShot shot)
{
    RenderRequest request = precision_request(r->p, shot, r->width, r->height);
    request.sky_samples = r->samples;
    request.sky_visibility = r->visibility;
    request.edge_samples = request.target_samples = 0;
    return request;
}

static void render_sky(void *user)
{
    const SkyRendering *r = user;
    const RenderRequest request = sky_request(r, SHOT_NEAR);
    Picture             picture;
    arena_reset(r->p->arena);
    const Status status = precision_render(&picture, r->p, SHOT_NEAR, &request, r->p->arena);
    if (status != STATUS_OK) r->p->status = status;
    bench_keep(&picture);
}

static Status tunable_sky(Precision *p)
{
    const bool   quick = bench_quick(p->bench);
    const int    finest = quick ? 1024 : 4096, width = quick ? 12 : 24, height = quick ? 8 : 16;
    SkyRendering r[sky_settings];
    BenchWork    work[sky_settings];
    BenchSetting point[sky_settings] = {0};
    char         name[sky_settings][24], of[96], against[96];
    int          worst = 0;
    Status       status = STATUS_OK;
    bench_progress(p->bench, "sky");
    for (int s = 0; s < sky_shots && status == STATUS_OK; s++) {
        SkyRendering        fine_r = {p, finest, width, height, false};
        const RenderRequest fine_request = sky_request(&fine_r, sky_shot[s]);
        Picture             fine, picture;
        arena_reset(p->other);
        status = precision_render(&fine, p, sky_shot[s], &fine_request, p->other);
        for (int k = 0; k < sky_settings && status == STATUS_OK; k++) {
            r[k] = (SkyRendering){p, sky_samples[k], width, height, k == sky_near};
            const RenderRequest request = sky_request(&r[k], sky_shot[s]);
            arena_reset(p->arena);
            status = precision_render(&picture, p, sky_shot[s], &request, p->arena);
            if (status != STATUS_OK) break;
            const double error = 100 * precision_rms(&picture, &fine);
            if (k == 0 && !(error <= point[0].error)) worst = s;
            if (!(error <= point[k].error)) point[k].error = error;
        }
    }
    if (status != STATUS_OK) return status;
    for (int k = 0; k < sky_settings; k++) {
        if (sky_samples[k] == 0)
            snprintf(name[k], sizeof name[k], k == sky_near ? "slope and what is near" : "by slope");
        else snprintf(name[k], sizeof name[k], "%d directions", sky_samples[k]);
        work[k] = (BenchWork){render_sky, &r[k], 1};
        point[k].setting = name[k];
        point[k].is_default = k == sky_near;
    }
    snprintf(of, sizeof of, "a picture of %d x %d, three bands", width, height);
    snprintf(against, sizeof against, "rms, %d directions and two bounces; worst: %s", finest,
             precision_shot_name[sky_shot[worst]]);
    bench_tunable(p->bench, &(BenchTunable){"light from all around", "sensor.sky_samples", of, "%", against, 25}, work,
                  point, sky_settings);
    return p->status;
}

/* ---- the suite --------------------------------------------------------------------------------- */

Status bench_precision(Bench *bench)
{
    Precision p;
    Status    status = precision_open(&p, bench);
    if (status == STATUS_OK) status = tunable_rays(&p);
    if (status == STATUS_OK) status = tunable_targets(&p);
    if (status == STATUS_OK) status = tunable_sky(&p);
    if (status == STATUS_OK) status = precision_models(&p);
    precision_close(&p);
    if (status == STATUS_OK) status = precision_plants(bench);
    if (status == STATUS_OK) status = precision_sampling(bench);
    if (status == STATUS_OK) status = precision_scenery(bench);
    if (status == STATUS_OK) status = precision_detectors(bench);
    if (status == STATUS_OK) status = precision_radar_seeker(bench);
    if (status == STATUS_OK) status = precision_coarse(bench);
    if (status != STATUS_OK) log_error("bench: precision: %s", status_name(status));
    return status;
}
