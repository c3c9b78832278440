/* tests/bench/sensor/precision_sampling.c: steps of sampling, those that a live node takes to be in time
 * (RenderRequest.sampling) and two above the default: what each costs, and its errors by kind of pixel. */
#include "tests/bench/sensor/precision.h"

#include "sensor/settings/config.h"
#include "tests/bench/sensor/quality_woods.h"

#include <time.h>

/* Kinds of pixels, by the ray of the centre: ground beside another class of ground; sky beside what is not, and the
 * other way round; what is beside a target. */
typedef enum PixelKind {
    KIND_WOODS,
    KIND_GROUND,
    KIND_BORDER,
    KIND_SKY,
    KIND_HORIZON,
    KIND_SILHOUETTE,
    KIND_TARGET,
    KIND_ALL,
    KIND_WOODS_BLOCKS, /* means of 4 x 4 pixels that are woods */
    KINDS
} PixelKind;

static const char *const kind_name[KINDS] = {"woods",  "ground",     "border of ground",
                                             "sky",    "horizon",    "about a target",
                                             "target", "all pixels", "woods, means of 4 x 4"};

enum { steps = 6, step_default = 2, scenes = 4, views = 3, block_side = 4, timed_rounds = 7, values = picture_radar };

static const struct {
    const char *name;
    int         samples, target_samples;
    Sampling    sampling;
} step_of[steps] = {{"study: 3 x 3 rays", 3, 16, SAMPLING_ALL},
                    {"fine: 2 x 2 rays", 2, 48, SAMPLING_ALL},
                    {"default", 1, 48, SAMPLING_ALL},
                    {"targets", 1, 48, SAMPLING_TARGETS},
                    {"checkerboard", 1, 48, SAMPLING_CHECKERBOARD},
                    {"quarter", 1, 48, SAMPLING_QUARTER}};

/* A scene: what the eye looks at, north of the origin; and where it is, south of that and turned about it. */
typedef struct SceneOf {
    const char *name;
    bool        woods, level; /* level: it looks at the horizon, away from the vehicles */
    int         size_px[2];   /* of a timed frame; errors are those of its middle */
    double      hfov_rad;
    unsigned    bands;
    double      aim_m, back_m[views], above_m[views], turn_rad[views];
} SceneOf;

static const unsigned thermal = 1u << BAND_MWIR | 1u << BAND_LWIR, three = 1u << BAND_OPTICAL | thermal;

static const SceneOf scene_of[scenes] = {
    {"bare ground", false, true, {360, 243}, 0.35, three, 0, {300, 600, 900}, {8, 40, 100}, {0, 0, 0}},
    {"20 vehicles, 8-12 um",
     false,
     false,
     {256, 256},
     0.35,
     1u << BAND_LWIR,
     0,
     {300, 600, 900},
     {40, 60, 200},
     {0, 0, 0}},
    {"woods", true, false, {360, 243}, 0.35, three, 0, {300, 600, 900}, {40, 100, 60}, {0, 0, 0}},
    {"flight on a vehicle", true, false, {360, 243}, 0.35, three, -20, {250, 120, 50}, {100, 60, 30}, {0, 1.3, 2.6}},
};

/* Sums of squares of a step: of the radiance planes, each over its mean; thermal ones in K. */
typedef struct StepErrors {
    double    square[KINDS][values], count[KINDS];
    double    box[values], boxes, centroid_px, centroids; /* of targets: intensity of a box over the true one, less 1 */
    double    stated[BAND_COUNT], found[BAND_COUNT];      /* squared errors of the band over the square of its mean */
    double    apart; /* largest difference of a target's radiance from the default's */
    BenchTime time;
} StepErrors;

typedef struct Ladder {
    Bench         *bench;
    QualityMeasure lab;
    Woods          woods;
    const SceneOf *scene;
    Arena         *default_arena;
    bool           quick;
    StepErrors     step[steps];
    TrialFrame     fine, plain; /* of the view at hand: many rays; the default */
    float         *off;         /* [values][pixels], of a picture */
} Ladder;

/* ---- frames -------------------------------------------------------------------------------------- */

static View view_of(const Ladder *l, int view, const int size_px[2])
{
    const SceneOf   *s = l->scene;
    const Elevation *e = &l->lab.ground.elevation;
    const double     aim_enu[3] = {0, s->aim_m, elevation_height(e, 0, s->aim_m, NULL) + 1};
    const double x = s->back_m[view] * sin(s->turn_rad[view]), y = s->aim_m - s->back_m[view] * cos(s->turn_rad[view]);
    View         v = {.width = size_px[0],
                      .height = size_px[1],
                      .focal_px = view_focal_px(s->size_px[0], s->hfov_rad),
                      .p_enu = {x, y, fmax(aim_enu[2], elevation_height(e, x, y, NULL)) + s->above_m[view]}};
    double       d_enu[3];
    v3_sub(d_enu, aim_enu, v.p_enu);
    if (s->level) d_enu[0] = 0.2, d_enu[1] = -0.97, d_enu[2] = -0.04;
    v3_scale(d_enu, 1 / v3_length(d_enu), d_enu);
    view_upright(v.r_enu_from_cam, d_enu);
    return v;
}

static RenderRequest request_of(const Ladder *l, int view, int step, const int size_px[2])
{
    const View    v = view_of(l, view, size_px);
    RenderRequest request = trial_default_request(&l->lab.scene, &v, 0);
    request.bands = l->scene->bands;
    request.optical = OPTICAL_RGB;
    request.profile_bins = 0;
    request.samples = step_of[step].samples;
    request.target_samples = step_of[step].target_samples;
    request.sampling = step_of[step].sampling;
    return request;
}

static TrialFrame frame_of(const Ladder *l, int view, int step, const int size_px[2], Arena *arena)
{
    return (TrialFrame){
        .scene = &l->lab.scene, .pool = l->lab.many, .arena = arena, .request = request_of(l, view, step, size_px)};
}

/* ---- kinds of pixels ----------------------------------------------------------------------------- */

static bool is_sky(const Picture *p, size_t px) { return !(p->range_m[px] < INFINITY); }

static PixelKind kind_of(const Picture *p, int x, int y)
{
    static const int beside[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    const size_t     px = picture_index(p, x, y);
    const bool       sky = is_sky(p, px), plant = picture_shows_plant(p, px);
    bool             target = false, horizon = false, border = false;
    if (p->entity[px]) return KIND_TARGET;
    for (int k = 0; k < 4; k++) {
        const int xb = x + beside[k][0], yb = y + beside[k][1];
        if (xb < 0 || yb < 0 || xb >= p->width || yb >= p->height) continue;
        const size_t b = picture_index(p, xb, yb);
        target |= p->entity[b] != 0;
        horizon |= is_sky(p, b) != sky;
        border |= !p->entity[b] && p->material[b] != p->material[px] && !picture_shows_plant(p, b);
    }
    if (target || (p->covered && p->covered[px] > 0)) return KIND_SILHOUETTE;
    if (horizon) return KIND_HORIZON;
    return sky ? KIND_SKY : plant ? KIND_WOODS : border ? KIND_BORDER : KIND_GROUND;
}

/* ---- errors -------------------------------------------------------------------------------------- */

static double plane_mean(const float *value, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += (double)value[i];
    return sum / (double)count;
}

static const PlanckTable *planck_of(const Ladder *l, int plane)
{
    const World *world = &l->lab.scene.world;
    return plane == picture_mwir ? world->planck_mwir : plane == picture_lwir ? world->planck_lwir : NULL;
}

/* Differences of a plane from the true one: of its mean, or K. */
static void find_differences(float *off, const Ladder *l, int plane, const Picture *got)
{
    const Picture     *want = &l->fine.picture;
    const PlanckTable *planck = planck_of(l, plane);
    const size_t       count = (size_t)want->width * (size_t)want->height;
    const float       *a = picture_plane(got, plane), *b = picture_plane(want, plane);
    const double       mean = plane_mean(b, count);
    for (size_t i = 0; i < count; i++)
        off[i] = (float)(planck ? planck_table_temp(planck, (double)a[i]) - planck_table_temp(planck, (double)b[i])
                                : ((double)a[i] - (double)b[i]) / mean);
}

static void add_pixels(StepErrors *e, const float *const off[values], const Picture *p)
{
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            const PixelKind kind = kind_of(p, x, y);
            e->count[kind]++, e->count[KIND_ALL]++;
            for (int k = 0; k < values; k++) {
                if (!off[k]) continue;
                const double square = (double)off[k][picture_index(p, x, y)] * (double)off[k][picture_index(p, x, y)];
                e->square[kind][k] += square, e->square[KIND_ALL][k] += square;
            }
        }
}

static void add_blocks(StepErrors *e, const float *const off[values], const Picture *p)
{
    for (int y0 = 0; y0 + block_side <= p->height; y0 += block_side)
        for (int x0 = 0; x0 + block_side <= p->width; x0 += block_side) {
            double sum[values] = {0};
            int    woods = 0;
            for (int y = y0; y < y0 + block_side; y++)
                for (int x = x0; x < x0 + block_side; x++) {
                    if (kind_of(p, x, y) != KIND_WOODS) continue;
                    woods++;
                    for (int k = 0; k < values; k++)
                        if (off[k]) sum[k] += (double)off[k][picture_index(p, x, y)];
                }
            if (woods < block_side * block_side) continue;
            e->count[KIND_WOODS_BLOCKS]++;
            for (int k = 0; k < values; k++) e->square[KIND_WOODS_BLOCKS][k] += sum[k] * sum[k] / (woods * woods);
        }
}

/* Sum over a box, and the centre of what is more or less than the mean of its rim. */
typedef struct BoxSum {
    double sum, centre_px[2];
    bool   stands_out;
} BoxSum;

static BoxSum sum_box(const Picture *p, const float *value, const int box[4])
{
    const int x0 = box[0] > 0 ? box[0] - 1 : 0, x1 = box[2] < p->width ? box[2] + 1 : p->width;
    const int y0 = box[1] > 0 ? box[1] - 1 : 0, y1 = box[3] < p->height ? box[3] + 1 : p->height;
    BoxSum    s = {0};
    double    rim = 0, on_rim = 0, over = 0, all = 0;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            const double v = (double)value[picture_index(p, x, y)];
            s.sum += v;
            if (x == x0 || y == y0 || x == x1 - 1 || y == y1 - 1) rim += v, on_rim++;
        }
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            const double v = (double)value[picture_index(p, x, y)] - rim / on_rim;
            over += v, all += fabs(v);
            s.centre_px[0] += v * (x + 0.5), s.centre_px[1] += v * (y + 0.5);
        }
    s.stands_out = fabs(over) > 0.5 * all;
    for (int k = 0; k < 2; k++) s.centre_px[k] /= over;
    return s;
}

static void add_targets(StepErrors *e, const Ladder *l, const Picture *got)
{
    enum { least_px = 4 };
    const Picture *want = &l->fine.picture, *plain = &l->plain.picture;
    for (int i = 0; i < l->fine.snapshot.count; i++) {
        const TargetPixels *t = &want->target[i];
        if (!(t->visible >= least_px)) continue;
        e->boxes++;
        for (int k = 0; k < values; k++) {
            if (!picture_plane(got, k)) continue;
            const BoxSum a = sum_box(got, picture_plane(got, k), t->box),
                         b = sum_box(want, picture_plane(want, k), t->box);
            e->box[k] += (a.sum / b.sum - 1) * (a.sum / b.sum - 1);
            const double was = plain->target[i].radiance[k];
            if (was > 0) bench_worst(&e->apart, fabs(got->target[i].radiance[k] / was - 1));
            if (k != picture_lwir || !a.stands_out || !b.stands_out) continue;
            const double dx = a.centre_px[0] - b.centre_px[0], dy = a.centre_px[1] - b.centre_px[1];
            e->centroid_px += dx * dx + dy * dy, e->centroids++;
        }
    }
}

/* The sampling error that the frame states, and the one that it has. */
static void add_stated(StepErrors *e, const Ladder *l, const Picture *got)
{
    const Picture *want = &l->fine.picture;
    const size_t   count = (size_t)want->width * (size_t)want->height;
    for (int k = 0; k < values; k++) {
        const float *a = picture_plane(got, k), *b = picture_plane(want, k);
        double       square = 0;
        if (!a) continue;
        for (size_t i = 0; i < count; i++) square += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
        const double mean = plane_mean(b, count), stated = got->budget->sampling[k];
        e->found[picture_band(k)] += square / (double)count / (mean * mean);
        e->stated[picture_band(k)] += stated * stated / (mean * mean);
    }
}

static Status measure_view(Ladder *l, int view)
{
    const SceneOf *s = l->scene;
    const int      share = l->quick ? 6 : 2, size_px[2] = {s->size_px[0] / share, s->size_px[1] / share};
    float         *off[values] = {NULL};
    l->plain = frame_of(l, view, step_default, size_px, l->default_arena);
    l->fine = frame_of(l, view, step_default, size_px, l->lab.reference_arena);
    l->fine.request.samples = l->quick ? 6 : 12;
    l->fine.request.edge_samples = l->fine.request.target_samples = 0;
    l->fine.request.budget = false;
    trial_frame(&l->plain);
    trial_frame(&l->fine);
    for (int k = 0; k < steps && l->plain.status == STATUS_OK && l->fine.status == STATUS_OK; k++) {
        StepErrors *e = &l->step[k];
        TrialFrame  f = frame_of(l, view, k, size_px, l->lab.arena);
        trial_frame(&f);
        if (f.status != STATUS_OK) return f.status;
        for (int c = 0; c < values; c++) {
            off[c] = NULL;
            if (!picture_plane(&f.picture, c)) continue;
            off[c] = arena_alloc(l->lab.arena, (size_t)size_px[0] * (size_t)size_px[1], sizeof(float));
            if (!off[c]) return STATUS_NO_MEMORY;
            find_differences(off[c], l, c, &f.picture);
        }
        add_pixels(e, (const float *const *)off, &l->plain.picture);
        add_blocks(e, (const float *const *)off, &l->plain.picture);
        add_targets(e, l, &f.picture);
        add_stated(e, l, &f.picture);
    }
    return l->plain.status != STATUS_OK ? l->plain.status : l->fine.status;
}

/* ---- times --------------------------------------------------------------------------------------- */

static double thread_clock_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* On one thread, by its own clock; steps interleaved, forward and backward. */
static Status measure_times(Ladder *l)
{
    const int small_px[2] = {l->scene->size_px[0] / 4, l->scene->size_px[1] / 4};
    const int rounds = l->quick ? 2 : timed_rounds;
    for (int round = -1; round < rounds; round++) /* one to warm up */
        for (int n = 0; n < steps; n++) {
            const int  k = round & 1 ? steps - 1 - n : n;
            TrialFrame f = frame_of(l, 1, k, l->quick ? small_px : l->scene->size_px, l->lab.arena);
            f.pool = l->lab.pool;
            if (round < 0 && k != step_default) continue;
            const double start_s = thread_clock_s();
            trial_frame(&f);
            if (f.status != STATUS_OK) return f.status;
            if (round >= 0) l->step[k].time.item_s[round] = thread_clock_s() - start_s;
            l->step[k].time.rounds = round + 1;
        }
    for (int k = 0; k < steps; k++) bench_time_finish(&l->step[k].time);
    return STATUS_OK;
}

/* ---- rows ---------------------------------------------------------------------------------------- */

static double optical_percent(const StepErrors *e, int kind)
{
    double sum = 0;
    for (int k = 0; k < picture_mwir; k++) sum += e->square[kind][k] / 3;
    return 100 * sqrt(sum / e->count[kind]);
}

static double kelvin(const StepErrors *e, int kind, int plane) { return sqrt(e->square[kind][plane] / e->count[kind]); }

/* what: NULL, the row of the time. */
static void name_row(char name[128], const Ladder *l, int step, const char *what)
{
    snprintf(name, 128, "steps of sampling: %s, %s%s%s", l->scene->name, step_of[step].name, what ? ": " : "",
             what ? what : "");
}

static void error_row(const Ladder *l, int step, const char *what, double percent, const double also[2],
                      const char *unit)
{
    char name[128], against[128];
    name_row(name, l, step, what);
    BenchRow row = bench_row(name);
    if (l->scene->bands == three) {
        row.error = percent, row.error_unit = "%";
        snprintf(against, sizeof against, "optical; 3-5 um %.3g %s, 8-12 um %.3g %s", also[0], unit, also[1], unit);
    } else {
        row.error = also[1], row.error_unit = unit;
        snprintf(against, sizeof against, "8-12 um");
    }
    row.against = against;
    bench_add(l->bench, &row);
}

static void list_step(const Ladder *l, int step)
{
    const StepErrors *e = &l->step[step];
    char              name[128];
    name_row(name, l, step, NULL);
    BenchRow row = bench_row_of(name, &e->time, NULL, 1);
    row.rate = NAN;
    row.ratio = bench_ratio(&e->time, &l->step[step_default].time);
    row.to = "default";
    bench_add(l->bench, &row);
    for (int kind = 0; kind < KINDS; kind++)
        if (e->count[kind] > 0)
            error_row(l, step, kind_name[kind], optical_percent(e, kind),
                      (const double[2]){kelvin(e, kind, picture_mwir), kelvin(e, kind, picture_lwir)}, "K");
    if (e->boxes > 0) {
        double box[values];
        for (int k = 0; k < values; k++) box[k] = 100 * sqrt(e->box[k] / e->boxes);
        error_row(l, step, "intensity of a target's box",
                  sqrt((box[0] * box[0] + box[1] * box[1] + box[2] * box[2]) / 3),
                  (const double[2]){box[picture_mwir], box[picture_lwir]}, "%");
    }
    if (e->centroids > 0) {
        name_row(name, l, step, "centroid of a target");
        row = bench_row(name);
        row.error = sqrt(e->centroid_px / e->centroids), row.error_unit = "px", row.against = "8-12 um";
        bench_add(l->bench, &row);
    }
    if (step_of[step].sampling != SAMPLING_ALL && e->boxes > 0) {
        name_row(name, l, step, "targets whole");
        row = bench_row(name);
        row.error = e->apart, row.error_limit = 0, row.error_unit = "of it",
        row.against = "published intensity, default";
        bench_add(l->bench, &row);
    }
    static const char *const stated_of[] = {"stated error, optical", "stated error, 3-5 um", "stated error, 8-12 um"};
    for (int b = 0; b <= BAND_LWIR; b++) {
        if (!(e->found[b] > 0)) continue;
        const double ratio = sqrt(e->stated[b] / e->found[b]);
        name_row(name, l, step, stated_of[b]);
        row = bench_row(name);
        row.error = fmax(ratio, 1 / ratio), row.error_unit = "x", row.against = ratio < 1 ? "too small" : "too large";
        if (step_of[step].sampling != SAMPLING_ALL && !l->quick) row.error_limit = 1.5; /* small pictures: few probes */
        bench_add(l->bench, &row);
    }
}

static Status measure_scene(Ladder *l)
{
    Status status = STATUS_OK;
    memset(l->step, 0, sizeof l->step);
    for (int view = 0; view < views && status == STATUS_OK; view++) {
        char what[64];
        snprintf(what, sizeof what, "steps of sampling: %s, view %d of %d", l->scene->name, view + 1, views);
        bench_progress(l->bench, what);
        status = measure_view(l, view);
    }
    if (status == STATUS_OK) status = measure_times(l);
    for (int k = 0; k < steps && status == STATUS_OK; k++) list_step(l, k);
    return status;
}

Status precision_sampling(Bench *bench)
{
    Ladder l = {.bench = bench, .quick = bench_quick(bench), .default_arena = arena_create()};
    bool   planted = false;
    Status status = quality_measure_open(&l.lab, 1, false);
    if (status == STATUS_OK && !l.default_arena) status = STATUS_NO_MEMORY;
    for (int s = 0; s < scenes && status == STATUS_OK; s++) {
        l.scene = &scene_of[s];
        if (l.scene->woods && !planted) status = quality_woods_plant(&l.woods, &l.lab);
        planted |= l.scene->woods;
        if (status == STATUS_OK) status = measure_scene(&l);
    }
    quality_measure_close(&l.lab);
    woods_destroy(&l.woods);
    arena_destroy(l.default_arena);
    return status;
}
