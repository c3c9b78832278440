/* tests/bench/sensor/woods_far_end.c: where plants of pages end (terrain.woods_far_m): what it adds to the change from
 * frame to frame that they thin out there, each at a distance of its own, and give way to ground that shows their
 * canopy.
 *
 * An eye flies level at 250 m/s, and pairs of frames are rendered 1/25 s apart, with plants that end 6 km away (T, T')
 * and with the same that do not (F, F'), both by tables. Over the pixels of what lies in the last fifth of that
 * distance, the share of the change that plants without an end do not have is 1 - <(F' - F)^2> / <(T' - T)^2>. At the
 * default of 25 km four times fewer plants change in a frame, each a quarter as high in the picture. */
#include "tests/bench/sensor/woods_private.h"

enum { pairs = 16 };
static const double reach_m = 6000, on_m = 50000 /* beyond all ground */, above_m = 300, step_m = 250 * 0.04;
static const double down_rad = 3.2 * rad_per_deg, hfov_rad = 8 * rad_per_deg;

/* Columns of a pair's sums. */
typedef enum EndSum {
    END_ON /* (F' - F)^2: pixels, blocks */,
    END_OFF = END_ON + 2,
    END_PIXELS = END_OFF + 2,
    END_SUMS
} EndSum;

typedef struct FarEnd {
    WoodsBench *w;
    Woods       woods;
    TrialScene  scene;
    Forest     *forest[2]; /* plants without an end; with it: the scene's own */
    Arena      *arena[2][2];
    TrialFrame  frame[2][2]; /* first and second of a pair, without an end and with it */
    double      sum[woods_bands][pairs][END_SUMS];
} FarEnd;

static ForestConfig config_to(double far_m)
{
    return (ForestConfig){.leaves = true, .fine = true, .tables = true, .far_m = far_m, .far_mb = 4000};
}

static Status open_end(FarEnd *e)
{
    WoodsBench       *w = e->w;
    const WoodsConfig woods = {
        .seed = 1, .half_width_m = 50, .most_trees = 1 /* the others are of pages */, .far_half_m = 0.5 * w->north_m};
    const ForestConfig on = config_to(on_m), off = config_to(reach_m);
    char               catalog[512];
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    Status status = woods_create(&e->woods, &w->landscape, &woods, w->many);
    if (status == STATUS_OK) status = trial_scene_open(&e->scene, &w->landscape, catalog, NULL, 0, 0);
    if (status == STATUS_OK) status = world_plant(&e->scene.world, &e->woods, &off, NULL, w->many);
    if (status == STATUS_OK) e->forest[1] = e->scene.world.forest;
    if (status == STATUS_OK) status = forest_create(&e->forest[0], &e->woods, e->scene.world.plants, &on, NULL);
    for (int k = 0; k < 4 && status == STATUS_OK; k++)
        if (!(e->arena[k / 2][k % 2] = arena_create())) status = STATUS_NO_MEMORY;
    return status;
}

static void close_end(FarEnd *e)
{
    if (e->forest[1]) e->scene.world.forest = e->forest[1];
    if (e->forest[0]) forest_destroy(e->forest[0]);
    trial_scene_close(&e->scene);
    woods_destroy(&e->woods);
    for (int k = 0; k < 4; k++) arena_destroy(e->arena[k / 2][k % 2]);
}

static View view_at(const FarEnd *e, double north_m)
{
    const Elevation *ground = &e->w->landscape.elevation;
    const double     d_enu[3] = {0, cos(down_rad), -sin(down_rad)}, start_m = -0.48 * e->w->north_m;
    View             view = {.p_enu = {0, start_m + north_m, elevation_height(ground, 0, start_m, NULL) + above_m},
                             .width = 360,
                             .height = 243,
                             .focal_px = view_focal_px(360, hfov_rad)};
    view_upright(view.r_enu_from_cam, d_enu);
    return view;
}

static Status render_pair(FarEnd *e, double north_m)
{
    for (int k = 0; k < 4; k++) {
        const int     later = k / 2, end = k % 2;
        TrialFrame   *f = &e->frame[later][end];
        RenderRequest request = woods_request(e->w, 0, 1);
        request.bands &= three_bands;
        request.view = view_at(e, north_m + later * step_m);
        *f = (TrialFrame){.scene = &e->scene, .request = request, .pool = e->w->many, .arena = e->arena[later][end]};
        e->scene.world.forest = e->forest[end];
        trial_frame(f);
        if (f->status != STATUS_OK) return f->status;
    }
    return STATUS_OK;
}

/* Pixels of what lies where plants thin out. */
static void find_thinning(uint8_t *thinning, const FarEnd *e)
{
    const TrialFrame *first = &e->frame[0][0];
    const Picture    *p = &first->picture;
    for (int i = 0; i < p->width * p->height; i++) {
        double d[3];
        view_ray(d, &first->request.view, i % p->width + 0.5, i / p->width + 0.5);
        const double away_m = (double)p->range_m[i] * sqrt(d[0] * d[0] + d[1] * d[1]);
        thinning[i] = away_m > forest_far_full * reach_m && away_m < reach_m;
    }
}

static void add_pair(FarEnd *e, int n, const uint8_t *thinning)
{
    for (int b = 0; b < woods_bands; b++) {
        double        *sum = e->sum[b][n];
        const Picture *p = &e->frame[0][0].picture;
        for (int end = 0; end < 2; end++)
            woods_add_squares(
                &sum[end ? END_OFF : END_ON], picture_plane(&e->frame[0][end].picture, woods_band_plane[b]),
                picture_plane(&e->frame[1][end].picture, woods_band_plane[b]), thinning, p->width, p->height);
        for (int i = 0; i < p->width * p->height; i++) sum[END_PIXELS] += thinning[i];
    }
}

typedef struct EndChange {
    const double *of;
    int           blocks;
} EndChange;

static double change_of(const void *user, int without)
{
    const EndChange *c = user;
    double           s[END_SUMS];
    group_sums(s, c->of, pairs, END_SUMS, without);
    return 100 * (1 - s[END_ON + c->blocks] / s[END_OFF + c->blocks]);
}

static void judge_end(const FarEnd *e)
{
    static const char *const scale[2] = {"pixels", "blocks of 4 px"};
    for (int b = 0; b < woods_bands; b++)
        for (int k = 0; k < 2; k++) {
            const EndChange change = {e->sum[b][0], k};
            double          pixels = 0;
            char            what[what_size], text[160];
            for (int n = 0; n < pairs; n++) pixels += e->sum[b][n][END_PIXELS];
            snprintf(what, sizeof what, "flight: far plants' end, %s: change of representation, %s",
                     woods_plane[woods_band_plane[b]], scale[k]);
            snprintf(text, sizeof text,
                     "share of the change that plants without an end have not; %g pixels in %d pairs", pixels, pairs);
            woods_judge(e->w, what, group_estimate(change_of, &change, pairs), (WoodsLimit){50, "%", true}, text);
        }
}

Status woods_far_end(WoodsBench *w)
{
    FarEnd e = {.w = w};
    bench_progress(w->bench, "far plants' end");
    Status status = open_end(&e);
    arena_reset(w->arena[0]);
    uint8_t *thinning = status == STATUS_OK ? arena_alloc(w->arena[0], 360 * 243, sizeof *thinning) : NULL;
    if (status == STATUS_OK && !thinning) status = STATUS_NO_MEMORY;
    for (int n = 0; n < pairs && status == STATUS_OK; n++) {
        status = render_pair(&e, n * 60.0);
        if (status != STATUS_OK) break;
        find_thinning(thinning, &e);
        add_pair(&e, n, thinning);
    }
    if (status == STATUS_OK) judge_end(&e);
    close_end(&e);
    return status;
}
