/* tests/bench/sensor/precision.c: the images in which errors are measured. */
#include "tests/bench/sensor/precision.h"

#include "sensor/settings/config.h"
#include "sensor/node/session/seeker_private.h"
#include "terrain/ground/landscape.h"

const char *const precision_shot_name[SHOT_COUNT] = {"ground alone", "vehicles of 70 px", "vehicles of 5 px",
                                                     "horizon"};

enum { vehicles = 5 }; /* a row; views are aimed at the third */

static const double focal_px = 989; /* 720 px across 40 degrees */

static View view_of(const Precision *p, PrecisionShot shot)
{
    static const double back_m[SHOT_COUNT] = {600, 110, 1500, 3000}, above_m[SHOT_COUNT] = {60, 30, 300, 40};
    const int           w = p->shot_px[0], h = p->shot_px[1];
    View                view = trial_view(&p->scene, back_m[shot], above_m[shot], 2 * atan(0.5 * w / focal_px), w, h);
    /* away from the vehicles, down a slope; and level, with ground below and sky above */
    static const double away_enu[3] = {0.2, -0.97, -0.12}, level_enu[3] = {0, 1, 0};
    double              d_enu[3];
    if (shot != SHOT_GROUND && shot != SHOT_HORIZON) return view;
    v3_normalize(d_enu, shot == SHOT_GROUND ? away_enu : level_enu);
    view_upright(view.r_enu_from_cam, d_enu);
    return view;
}

RenderRequest precision_request(const Precision *p, PrecisionShot shot, int width, int height)
{
    const Config  config = config_default();
    RenderRequest request = {.view = view_of(p, shot),
                             .bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR,
                             .truth = true,
                             .optical = OPTICAL_RGB,
                             .samples = config.sensor.samples,
                             .edge_samples = config.sensor.edge_samples,
                             .target_samples = config.sensor.target_samples,
                             .sky_samples = config.sensor.sky_samples,
                             .sky_visibility = config.sensor.sky_visibility,
                             .hidden_entity = -1};
    request.view.width = width;
    request.view.height = height;
    return request;
}

double precision_go_round(View *view, const Precision *p, int turn)
{
    const double aim_enu[3] = {0, 0, elevation_height(&p->landscape.elevation, 0, 0, NULL) + 1};
    const double c = cos(1.3 * turn), s = sin(1.3 * turn), x = view->p_enu[0], y = view->p_enu[1];
    double       d_enu[3];
    view->p_enu[0] = c * x - s * y, view->p_enu[1] = s * x + c * y;
    v3_sub(d_enu, aim_enu, view->p_enu);
    const double range_m = v3_length(d_enu);
    v3_scale(d_enu, 1 / range_m, d_enu);
    view_upright(view->r_enu_from_cam, d_enu);
    return range_m;
}

Status precision_render(Picture *out, Precision *p, PrecisionShot shot, const RenderRequest *request, Arena *arena)
{
    const TrialFrame *frame = &p->shot[shot];
    return render(out, &p->scene.world, &frame->snapshot, request, &frame->air, p->pool, arena);
}

double precision_rms(const Picture *got, const Picture *want)
{
    const size_t count = (size_t)got->width * (size_t)got->height;
    double       sum = 0;
    int          planes = 0;
    for (int k = 0; k < picture_plane_count; k++) {
        const float *p = picture_plane(got, k), *q = picture_plane(want, k);
        double       square = 0, mean = 0;
        if (!p || !q) continue;
        for (size_t i = 0; i < count; i++) {
            square += ((double)p[i] - (double)q[i]) * ((double)p[i] - (double)q[i]);
            mean += (double)q[i];
        }
        sum += square * (double)count / (mean * mean);
        planes++;
    }
    return sqrt(sum / planes);
}

double precision_rms_k(const Picture *got, const Picture *want, const PlanckTable *lwir)
{
    const size_t count = (size_t)got->width * (size_t)got->height;
    double       square = 0;
    for (size_t i = 0; i < count; i++) {
        const double off_k =
            planck_table_temp(lwir, (double)got->lwir[i]) - planck_table_temp(lwir, (double)want->lwir[i]);
        square += off_k * off_k;
    }
    return sqrt(square / (double)count);
}

Status precision_open(Precision *out, Bench *bench)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0},
                                          {1, 1, 222, 2, 1, 0, 0},
                                          {1, 1, 222, 7, 1, 0, 0},
                                          {1, 1, 222, 28, 1, 0, 0},
                                          {1, 1, 222, 1, 1, 1, 0}};
    const Geodetic             origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    const bool                 quick = bench_quick(bench);
    LocalFrame                 frame;
    double                     times_s[2];
    char                       catalog[512];
    *out = (Precision){.bench = bench,
                       .shot_px = {quick ? 48 : 160, quick ? 32 : 108},
                       .arena = arena_create(),
                       .other = arena_create()};
    Status status = out->arena && out->other ? pool_create(&out->pool, bench_threads(bench)) : STATUS_NO_MEMORY;
    bench_progress(bench, "ground and vehicles");
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = landscape_quick(&out->landscape, times_s, &frame, 2000, 8000, out->pool);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK)
        status = trial_scene_open(&out->scene, &out->landscape, catalog, types, sizeof types / sizeof *types, vehicles);
    for (int k = 0; k < SHOT_COUNT && status == STATUS_OK; k++) {
        if (!(out->keep[k] = arena_create())) return STATUS_NO_MEMORY;
        out->shot[k] =
            (TrialFrame){.scene = &out->scene,
                         .pool = out->pool,
                         .arena = out->keep[k],
                         .request = precision_request(out, (PrecisionShot)k, out->shot_px[0], out->shot_px[1])};
        trial_frame(&out->shot[k]);
        status = out->shot[k].status;
    }
    return status;
}

void precision_close(Precision *p)
{
    trial_scene_close(&p->scene);
    landscape_destroy(&p->landscape);
    for (int k = 0; k < SHOT_COUNT; k++) arena_destroy(p->keep[k]);
    arena_destroy(p->arena);
    arena_destroy(p->other);
    pool_destroy(p->pool);
}
