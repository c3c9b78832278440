/* tests/bench/sensor/precision_plants.c: shortcuts of plants: their second level of detail, the reach of low plants,
 * rays a pixel, light between leaves. Each with its time and its error in small pictures of a wood. */
#include "tests/bench/sensor/precision.h"

#include "render/scene/view.h"
#include "tests/scenes/woods_stand.h"
#include "sensor/settings/config.h"
#include "terrain/ground/landscape.h"

/* The last is for low plants alone. */
typedef enum PlantShot { SHOT_ABOVE, SHOT_CLOSE, SHOT_LOW, TIMED_SHOTS = SHOT_LOW, PLANT_SHOTS } PlantShot;

enum { forests_most = 4 };

static const double level1_px[forests_most] = {0, 12, 24, 48};

typedef struct PlantPrecision {
    Bench     *bench;
    Landscape  landscape;
    Woods      woods;
    TrialScene scene;
    Forest    *forest[forests_most];
    Pool      *pool;
    Arena     *keep[PLANT_SHOTS][2], *fine, *arena;
    TrialFrame shot[PLANT_SHOTS][2]; /* poses and air, made once: of all bands, of the near infrared */
    int        size_px[2];
    Status     status; /* of the timed frames */
} PlantPrecision;

/* One setting: what differs from the default request of a shot. */
typedef struct PlantRendering {
    PlantPrecision *p;
    int             forest, samples, edge_samples, sky_samples, width, height;
    double          low_m;
    bool            nir;
    PlantShot       first, end;
} PlantRendering;

static View view_of(const PlantPrecision *p, PlantShot shot)
{
    static const double back_m[PLANT_SHOTS] = {450, 120, 60}, above_m[PLANT_SHOTS] = {80, 25, 2};
    View view = trial_view(&p->scene, back_m[shot], above_m[shot], 20 * rad_per_deg, p->size_px[0], p->size_px[1]);
    static const double low_enu[3] = {0, 0.99, -0.1};
    double              d_enu[3];
    if (shot != SHOT_LOW || !v3_normalize(d_enu, low_enu)) return view;
    view_upright(view.r_enu_from_cam, d_enu);
    return view;
}

static RenderRequest request_of(const PlantRendering *r, PlantShot shot)
{
    const Config  config = config_default();
    RenderRequest request = {.view = view_of(r->p, shot),
                             .bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR,
                             .truth = true,
                             .optical = r->nir ? OPTICAL_NIR : OPTICAL_RGB,
                             .samples = r->samples,
                             .edge_samples = r->edge_samples,
                             .sky_samples = r->sky_samples,
                             .sky_visibility = config.sensor.sky_visibility,
                             .hidden_entity = -1,
                             .low_plants_m = r->low_m};
    if (r->nir) request.bands = 1u << BAND_OPTICAL;
    if (r->width) request.view.width = r->width, request.view.height = r->height;
    return request;
}

static Status render_one(Picture *out, const PlantRendering *r, PlantShot shot, Arena *arena)
{
    PlantPrecision     *p = r->p;
    const TrialFrame   *frame = &p->shot[shot][r->nir];
    const RenderRequest request = request_of(r, shot);
    arena_reset(arena);
    p->scene.world.forest = p->forest[r->forest];
    return render(out, &p->scene.world, &frame->snapshot, &request, &frame->air, p->pool, arena);
}

static void render_timed(void *user)
{
    const PlantRendering *r = user;
    for (int s = r->first; s < (int)r->end; s++) {
        Picture      picture;
        const Status status = render_one(&picture, r, (PlantShot)s, r->p->arena);
        if (status != STATUS_OK) r->p->status = status;
        bench_keep(&picture);
    }
}

/* Errors of one rendering against another in the worse of its shots: in %, and in K of 8-12 um. */
static Status worst_errors(double *percent, double *kelvin, const PlantRendering *r, const PlantRendering *against)
{
    *percent = *kelvin = 0;
    for (int s = r->first; s < (int)r->end; s++) {
        Picture got, want;
        Status  status = render_one(&want, against, (PlantShot)s, r->p->fine);
        if (status == STATUS_OK) status = render_one(&got, r, (PlantShot)s, r->p->arena);
        if (status != STATUS_OK) return status;
        bench_worst(percent, 100 * precision_rms(&got, &want));
        if (got.lwir) bench_worst(kelvin, precision_rms_k(&got, &want, r->p->scene.world.planck_lwir));
    }
    return STATUS_OK;
}

static Status errors_of(BenchSetting *point, const PlantRendering *r, const PlantRendering *against)
{
    point->also_is = "of 8-12 um, K";
    return worst_errors(&point->error, &point->also, r, against);
}

/* ---- levels of detail --------------------------------------------------------------------------- */

/* Root of the mean squared difference of one band, over its mean, %. */
static double plane_rms(const float *a, const float *b, size_t count)
{
    double square = 0, mean = 0;
    for (size_t i = 0; i < count; i++) {
        square += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
        mean += (double)b[i];
    }
    return 100 * sqrt(square * (double)count) / mean;
}

/* Adds a row for each band, of the worse shot. */
static Status price_bands(PlantPrecision *p, int forest)
{
    static const char *const name[picture_plane_count] = {"red", "green", "blue", "3-5 um", "8-12 um", "radar"};
    double                   worst[picture_plane_count + 1] = {0};
    Picture                  got, want;
    for (int s = 0; s < TIMED_SHOTS; s++)
        for (int nir = 0; nir < 2; nir++) {
            const PlantRendering full = {.p = p, .samples = 4, .nir = nir};
            PlantRendering       other = full;
            other.forest = forest;
            Status status = render_one(&want, &full, (PlantShot)s, p->fine);
            if (status == STATUS_OK) status = render_one(&got, &other, (PlantShot)s, p->arena);
            if (status != STATUS_OK) return status;
            for (int k = 0; k < picture_radar; k++) {
                const float *a = picture_plane(&got, k), *b = picture_plane(&want, k);
                if (!a || !b) continue;
                bench_worst(&worst[nir ? picture_plane_count : k],
                            plane_rms(a, b, (size_t)got.width * (size_t)got.height));
            }
        }
    for (int k = 0; k <= picture_plane_count; k++) {
        char what[96];
        if (k == picture_radar) continue;
        snprintf(what, sizeof what, "plants lower than %.0f px simplified: %s", level1_px[forest],
                 k < picture_plane_count ? name[k] : "near infrared");
        BenchRow row = bench_row(what);
        row.error = worst[k];
        row.error_unit = "%";
        row.against = "rms, full detail by the same 16 rays a pixel";
        bench_add(p->bench, &row);
    }
    return STATUS_OK;
}

static Status tunable_levels(PlantPrecision *p)
{
    static const char *const name[forests_most] = {"full detail", "below 12 px", "below 24 px", "below 48 px"};
    const PlantRendering     fine = {.p = p, .samples = 4, .end = TIMED_SHOTS};
    PlantRendering           r[forests_most];
    BenchWork                work[forests_most];
    BenchSetting             point[forests_most] = {0};
    for (int k = 0; k < forests_most; k++) {
        PlantRendering same = fine;
        same.forest = k;
        point[k] = (BenchSetting){.setting = name[k], .is_default = k == 0};
        const Status status = errors_of(&point[k], &same, &fine);
        if (status != STATUS_OK) return status;
        r[k] = (PlantRendering){.p = p, .forest = k, .samples = 1, .end = TIMED_SHOTS};
        work[k] = (BenchWork){render_timed, &r[k], TIMED_SHOTS};
    }
    bench_tunable(p->bench,
                  &(BenchTunable){"plants simplified", "terrain.woods_level1_px",
                                  "a picture of a wood, one ray a pixel, three bands", "%",
                                  "rms, full detail by the same 16 rays a pixel; worse of two views", 0},
                  work, point, forests_most);
    for (int k = 1; k < forests_most && p->status == STATUS_OK; k++) {
        const Status status = price_bands(p, k);
        if (status != STATUS_OK) return status;
    }
    return p->status;
}

/* ---- rays a pixel ------------------------------------------------------------------------------- */

static Status tunable_rays(PlantPrecision *p)
{
    enum { settings = 5 };
    static const struct {
        const char *name;
        int         samples, edges;
    } of[settings] = {{"1 x 1", 1, 0}, {"2 x 2", 2, 0}, {"3 x 3", 3, 0}, {"4 x 4", 4, 0}, {"1 x 1, edges 4 x 4", 1, 4}};
    const PlantRendering finest = {.p = p, .samples = bench_quick(p->bench) ? 6 : 12, .end = TIMED_SHOTS};
    PlantRendering       r[settings];
    BenchWork            work[settings];
    BenchSetting         point[settings] = {0};
    for (int k = 0; k < settings; k++) {
        r[k] = (PlantRendering){.p = p, .samples = of[k].samples, .edge_samples = of[k].edges, .end = TIMED_SHOTS};
        point[k] = (BenchSetting){.setting = of[k].name, .is_default = k == settings - 1};
        work[k] = (BenchWork){render_timed, &r[k], TIMED_SHOTS};
        const Status status = errors_of(&point[k], &r[k], &finest);
        if (status != STATUS_OK) return status;
    }
    bench_tunable(p->bench,
                  &(BenchTunable){"rays a pixel among plants", "sensor.samples, sensor.edge_samples",
                                  "a picture of a wood, three bands", "%",
                                  "rms of single pixels, 144 rays in each; worse of two views", 50},
                  work, point, settings);
    return p->status;
}

/* ---- low plants --------------------------------------------------------------------------------- */

static Status tunable_low(PlantPrecision *p)
{
    enum { settings = 5 };
    static const double      reach_m[settings] = {0, 15, 30, 60, 120}, farthest_m = 240;
    static const char *const name[settings] = {"none", "15 m", "30 m", "60 m", "120 m"};
    const PlantRendering     fine = {.p = p, .samples = 4, .low_m = farthest_m, .first = SHOT_LOW, .end = PLANT_SHOTS};
    PlantRendering           r[settings];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    for (int k = 0; k < settings; k++) {
        PlantRendering same = fine;
        same.low_m = reach_m[k];
        r[k] = (PlantRendering){.p = p, .samples = 1, .low_m = reach_m[k], .first = SHOT_LOW, .end = PLANT_SHOTS};
        point[k] = (BenchSetting){.setting = name[k], .is_default = k == 3};
        work[k] = (BenchWork){render_timed, &r[k], 1};
        const Status status = errors_of(&point[k], &same, &fine);
        if (status != STATUS_OK) return status;
    }
    bench_tunable(p->bench,
                  &(BenchTunable){"reach of low plants", "terrain.woods_low_m",
                                  "a picture from 2 m above the ground, one ray a pixel, three bands", "%",
                                  "rms, those within 240 m by the same 16 rays a pixel", 30},
                  work, point, settings);
    return p->status;
}

/* ---- light between leaves ----------------------------------------------------------------------- */

static Status tunable_light(PlantPrecision *p)
{
    enum { settings = 5 };
    static const int         directions[settings] = {0, 4, 16, 64, 256};
    static const char *const name[settings] = {"quick form", "4 directions", "16 directions", "64 directions",
                                               "256 directions"};
    const bool               quick = bench_quick(p->bench);
    const int                width = quick ? 12 : 24, height = quick ? 8 : 16, count = quick ? settings - 1 : settings;
    const PlantRendering     fine = {
            .p = p, .samples = 1, .sky_samples = quick ? 256 : 1024, .width = width, .height = height, .end = TIMED_SHOTS};
    PlantRendering r[settings];
    BenchWork      work[settings];
    BenchSetting   point[settings] = {0};
    for (int k = 0; k < count; k++) {
        r[k] = fine;
        r[k].sky_samples = directions[k];
        point[k] = (BenchSetting){.setting = name[k], .is_default = k == 0};
        work[k] = (BenchWork){render_timed, &r[k], TIMED_SHOTS};
        const Status status = errors_of(&point[k], &r[k], &fine);
        if (status != STATUS_OK) return status;
    }
    bench_tunable(p->bench,
                  &(BenchTunable){"light between leaves", "sensor.sky_samples",
                                  "a picture of a wood, one ray a pixel, three bands", "%",
                                  "rms, many directions and two bounces; worse of two views", 40},
                  work, point, count);
    return p->status;
}

/* ---- the wood ----------------------------------------------------------------------------------- */

static Status open_forests(PlantPrecision *p)
{
    World *world = &p->scene.world;
    for (int k = 0; k < forests_most; k++) {
        const ForestConfig config = {.leaves = true, .level1_px = level1_px[k]};
        const Status       status = k == 0 ? world_plant(world, &p->woods, &config, NULL, p->pool)
                                           : forest_create(&p->forest[k], &p->woods, world->plants, &config, NULL);
        if (status != STATUS_OK) return status;
        if (k == 0) p->forest[0] = world->forest;
    }
    return STATUS_OK;
}

static Status open_wood(PlantPrecision *p)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 2, 1, 0, 0}};
    static const double        side_m = 1200;
    const Geodetic             origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    WoodsStand                 stand = {.landscape = &p->landscape,
                                        .east_m = side_m,
                                        .north_m = side_m,
                                        .trees = 25000,
                                        .clears = 1,
                                        .clear = {{{0, 0}, {0, 0}, 12, 12}}};
    LocalFrame                 frame;
    double                     times_s[2];
    char                       catalog[512];
    Status                     status = pool_create(&p->pool, bench_threads(p->bench));
    p->fine = arena_create();
    p->arena = arena_create();
    bench_progress(p->bench, "a wood");
    if (!p->fine || !p->arena) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = landscape_quick(&p->landscape, times_s, &frame, side_m, side_m, p->pool);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK)
        status = trial_scene_open(&p->scene, &p->landscape, catalog, types, sizeof types / sizeof *types, 1);
    if (status == STATUS_OK) status = woods_stand_create(&p->woods, &stand, p->pool);
    if (status == STATUS_OK) status = open_forests(p);
    for (int k = 0; k < 2 * PLANT_SHOTS && status == STATUS_OK; k++) {
        const PlantRendering plain = {.p = p, .samples = 1, .nir = k & 1};
        TrialFrame          *shot = &p->shot[k >> 1][k & 1];
        Arena               *keep = p->keep[k >> 1][k & 1] = arena_create();
        if (!keep) return STATUS_NO_MEMORY;
        *shot = (TrialFrame){
            .scene = &p->scene, .pool = p->pool, .arena = keep, .request = request_of(&plain, (PlantShot)(k >> 1))};
        trial_frame(shot);
        status = shot->status;
    }
    return status;
}

static void close_wood(PlantPrecision *p)
{
    p->scene.world.forest = p->forest[0];
    trial_scene_close(&p->scene);
    for (int k = 1; k < forests_most; k++) forest_destroy(p->forest[k]);
    woods_destroy(&p->woods);
    landscape_destroy(&p->landscape);
    for (int k = 0; k < 2 * PLANT_SHOTS; k++) arena_destroy(p->keep[k >> 1][k & 1]);
    arena_destroy(p->fine);
    arena_destroy(p->arena);
    pool_destroy(p->pool);
}

Status precision_plants(Bench *bench)
{
    const bool     quick = bench_quick(bench);
    PlantPrecision p = {.bench = bench, .size_px = {quick ? 48 : 160, quick ? 32 : 108}};
    Status         status = open_wood(&p);
    if (status == STATUS_OK) status = tunable_levels(&p);
    if (status == STATUS_OK) status = tunable_rays(&p);
    if (status == STATUS_OK) status = tunable_low(&p);
    if (status == STATUS_OK) status = tunable_light(&p);
    close_wood(&p);
    return status;
}
