/* tests/bench/sensor/precision_scenery.c: up to which width of a pixel borders of scenery, and of its shadows, are
 * sampled again: time and error in small pictures of a town. */
#include "tests/bench/sensor/precision.h"
#include "tests/scenes/town.h"

#include "sensor/settings/config.h"

enum { town_views = 2, widths = 4 };

/* Pixels of 0.44 and 0.6 m. */
static const struct {
    double back_m, above_m, px_rad;
} views[town_views] = {{3000, 1000, 1.45e-4}, {600, 100, 1e-3}};

static const double      px_m[widths] = {0.1, 0.25, 0.5, 1};
static const char *const width_name[widths] = {"none from 0.1 m", "none from 0.25 m", "none from 0.5 m",
                                               "none from 1 m"};

typedef struct TownPrecision {
    int        width, height;
    LocalFrame frame;
    Landscape  landscape;
    Scenery    scenery;
    TrialScene scene;
    Pool      *pool;
    Arena     *keep[town_views], *fine, *arena;
    TrialFrame shot[town_views];
    Status     status; /* of the timed frames */
} TownPrecision;

typedef struct TownRendering {
    TownPrecision *p;
    double         px_m;
    int            samples;
} TownRendering;

static Status render_view(Picture *out, const TownRendering *r, int v, Arena *arena)
{
    TownPrecision *p = r->p;
    RenderRequest  request = p->shot[v].request;
    request.scenery_px_m = r->px_m;
    request.samples = r->samples;
    arena_reset(arena);
    return render(out, &p->scene.world, &p->shot[v].snapshot, &request, &p->shot[v].air, p->pool, arena);
}

static void render_both(void *user)
{
    const TownRendering *r = user;
    for (int v = 0; v < town_views; v++) {
        Picture      picture;
        const Status status = render_view(&picture, r, v, r->p->arena);
        if (status != STATUS_OK) r->p->status = status;
        bench_keep(&picture);
    }
}

static Status open_town(TownPrecision *p, bool quick)
{
    static const DisEntityType type = {1, 1, 222, 1, 1, 1, 0};
    const Geodetic             origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    const Config               config = config_default();
    const TownOf of = {.buildings = quick ? 100 : 900, .clutter = 60, .landscape = &p->landscape, .seed = 8};
    double       times_s[2];
    char         catalog[512];
    p->width = quick ? 48 : 180, p->height = quick ? 32 : 120;
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    if (!(p->fine = arena_create()) || !(p->arena = arena_create())) return STATUS_NO_MEMORY;
    Status status = pool_create(&p->pool, 1);
    if (status == STATUS_OK) status = local_frame_at(&p->frame, &origin);
    if (status == STATUS_OK) status = landscape_quick(&p->landscape, times_s, &p->frame, 2000, 2000, p->pool);
    if (status == STATUS_OK) status = trial_scene_open(&p->scene, &p->landscape, catalog, &type, 1, 0);
    if (status == STATUS_OK) status = town_create(&p->scenery, &of);
    if (status == STATUS_OK) status = world_scenery(&p->scene.world, &p->scenery, NULL, p->pool);
    for (int v = 0; v < town_views && status == STATUS_OK; v++) {
        if (!(p->keep[v] = arena_create())) return STATUS_NO_MEMORY;
        const double hfov_rad = 2 * atan(0.5 * p->width * views[v].px_rad);
        const View   view = trial_view(&p->scene, views[v].back_m, views[v].above_m, hfov_rad, p->width, p->height);
        p->shot[v] = (TrialFrame){.scene = &p->scene, .pool = p->pool, .arena = p->keep[v]};
        p->shot[v].request = (RenderRequest){.view = view,
                                             .bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR,
                                             .truth = true,
                                             .optical = OPTICAL_RGB,
                                             .samples = 1,
                                             .edge_samples = config.sensor.edge_samples,
                                             .sky_visibility = config.sensor.sky_visibility,
                                             .t_s = 30,
                                             .hidden_entity = -1};
        trial_frame(&p->shot[v]);
        status = p->shot[v].status;
    }
    return status;
}

static Status measure(Bench *bench, TownPrecision *p)
{
    const TownRendering finest = {p, 0, bench_quick(bench) ? 6 : 12};
    TownRendering       r[widths];
    BenchWork           work[widths];
    BenchSetting        point[widths] = {0};
    for (int k = 0; k < widths; k++) {
        r[k] = (TownRendering){p, px_m[k], 1};
        work[k] = (BenchWork){render_both, &r[k], town_views};
        point[k] = (BenchSetting){.setting = width_name[k], .is_default = k == 1, .also_is = "of 8-12 um, K"};
    }
    for (int v = 0; v < town_views; v++) {
        Picture want;
        Status  status = render_view(&want, &finest, v, p->fine);
        for (int k = 0; k < widths && status == STATUS_OK; k++) {
            Picture got;
            status = render_view(&got, &r[k], v, p->arena);
            if (status != STATUS_OK) break;
            bench_worst(&point[k].error, 100 * precision_rms(&got, &want));
            bench_worst(&point[k].also, precision_rms_k(&got, &want, p->scene.world.planck_lwir));
        }
        if (status != STATUS_OK) return status;
    }
    bench_tunable(bench,
                  &(BenchTunable){
                      "borders of scenery", "render/frame/edges.c", "a picture of a town, three bands", "%",
                      "rms of single pixels, 144 rays in each; worse of two views, of pixels 0.44 and 0.6 m wide", 20},
                  work, point, widths);
    return p->status;
}

Status precision_scenery(Bench *bench)
{
    TownPrecision p = {0};
    bench_progress(bench, "borders of scenery");
    Status status = open_town(&p, bench_quick(bench));
    if (status == STATUS_OK) status = measure(bench, &p);
    trial_scene_close(&p.scene);
    scenery_free(&p.scenery);
    landscape_destroy(&p.landscape);
    for (int v = 0; v < town_views; v++) arena_destroy(p.keep[v]);
    arena_destroy(p.fine);
    arena_destroy(p.arena);
    pool_destroy(p.pool);
    return status;
}
