/* tests/bench/sensor/precision_model.c: facets for curved surfaces, and mirrors of the pseudo-radar. */
#include "tests/bench/sensor/precision.h"

#include "entities/shapes/parametric.h"
#include "render/trace/parts/parts.h"

#include <stdlib.h>

/* ---- facets ------------------------------------------------------------------------------------ */

static const double sag_m[] = {0.0005, 0.001, 0.002, 0.005, 0.01, 0.02};
enum { sag_settings = sizeof sag_m / sizeof *sag_m, sides = 3, most_side_px = 256 };

/* A tank alone in the world, and level rays at it from three sides, side by side over its whole box. */
typedef struct Faceted {
    Model         model;
    Tracer       *tracer;
    PosedEntity   posed;
    PosedNode    *node;
    int           side_px;
    const double *o[3], *d[3], *far_m; /* [sides][side_px^2] */
    double       *range_m;
    PartHit      *hit;
} Faceted;

static Status faceted_open(Faceted *f, double sag)
{
    static const double here[3] = {0}, level[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    const size_t        rays = (size_t)sides * (size_t)f->side_px * (size_t)f->side_px;
    Status              status = parametric_build(&f->model, "tank", sag);
    const Model        *models[1] = {&f->model};
    if (status == STATUS_OK) status = tracer_create_models(&f->tracer, models, 1, "avx2");
    if (status != STATUS_OK) return status;
    NodePose *pose = calloc((size_t)f->model.node_count, sizeof *pose);
    f->node = calloc((size_t)parts_node_count(f->tracer, 0), sizeof *f->node);
    f->range_m = malloc(rays * sizeof *f->range_m);
    f->hit = malloc(rays * sizeof *f->hit);
    if (pose && f->node && f->range_m && f->hit) {
        model_pose(pose, &f->model, NULL);
        f->posed.node = f->node;
        parts_pose(&f->posed, f->tracer, 0, pose, here, level, 0);
    } else status = STATUS_NO_MEMORY;
    free(pose);
    return status;
}

static void faceted_close(Faceted *f)
{
    tracer_destroy(f->tracer);
    model_destroy(&f->model);
    free(f->node);
    free(f->range_m);
    free(f->hit);
}

static void trace_facets(void *user)
{
    Faceted  *f = user;
    const int rays = sides * f->side_px * f->side_px;
    int       list[1024];
    for (int first = 0; first < rays; first += 1024) {
        const double *const o[3] = {f->o[0] + first, f->o[1] + first, f->o[2] + first};
        const double *const d[3] = {f->d[0] + first, f->d[1] + first, f->d[2] + first};
        const int           count = rays - first < 1024 ? rays - first : 1024;
        for (int k = 0; k < count; k++) {
            list[k] = k;
            f->range_m[first + k] = INFINITY;
        }
        parts_first_hits(f->range_m + first, f->hit + first, &f->posed, o, d, f->far_m, list, count, false);
    }
    bench_keep(f->range_m);
}

/* Makes rays from ahead, from the right and from above, over 6 m and from 40 m away. */
static void facet_rays(double *o[3], double *d[3], int side_px)
{
    static const double towards[sides][3] = {{-1, 0, 0}, {0.3, 0.9, -0.2}, {-0.5, 0.3, -0.8}};
    for (int s = 0, i = 0; s < sides; s++) {
        double way[3] = {0}, right[3] = {0}, up[3];
        v3_normalize(way, towards[s]);
        v3_cross(right, way, (const double[3]){0.1, 0, 1});
        v3_normalize(right, right);
        v3_cross(up, right, way);
        for (int k = 0; k < side_px * side_px; k++, i++) {
            const double x = 8 * ((k % side_px + 0.5) / side_px - 0.5), y = 8 * ((k / side_px + 0.5) / side_px - 0.5);
            for (int c = 0; c < 3; c++) {
                o[c][i] = (c == 2 ? 1.2 : 0) - 40 * way[c] + x * right[c] + y * up[c];
                d[c][i] = way[c];
            }
        }
    }
}

/* Computes two errors: the difference in range that one in a hundred exceeds, m, of rays that meet the same part twice;
 * and the share by which the silhouettes differ, %. */
static void facet_errors(double *range_m, double *area, const Faceted *got, const Faceted *want)
{
    const int rays = sides * got->side_px * got->side_px;
    double   *off_m = malloc((size_t)rays * sizeof *off_m);
    int       count = 0, met = 0, other = 0;
    *range_m = *area = NAN;
    if (!off_m) return;
    for (int i = 0; i < rays; i++) {
        const bool a = got->range_m[i] < INFINITY, b = want->range_m[i] < INFINITY;
        met += b;
        other += a != b;
        if (!a || !b) continue;
        if (got->model.triangle_part[got->hit[i].triangle] == want->model.triangle_part[want->hit[i].triangle])
            off_m[count++] = fabs(got->range_m[i] - want->range_m[i]);
    }
    qsort(off_m, (size_t)count, sizeof *off_m, bench_by_value);
    if (count > 0) *range_m = off_m[count * 99 / 100];
    if (met > 0) *area = 100.0 * other / met;
    free(off_m);
}

static double bytes_of(const Model *model)
{
    const size_t vertex = sizeof *model->vertex + sizeof *model->normal,
                 triangle = sizeof *model->triangle + sizeof *model->triangle_part;
    return (double)((size_t)model->vertex_count * vertex + (size_t)model->triangle_count * triangle);
}

static Status tunable_facets(Bench *bench)
{
    const int    side_px = bench_quick(bench) ? 64 : most_side_px;
    const size_t rays = (size_t)sides * (size_t)side_px * (size_t)side_px;
    const double finest_m = bench_quick(bench) ? 0.0002 : 0.0001;
    Faceted      set[sag_settings] = {{.side_px = side_px}}, fine = {.side_px = side_px};
    BenchWork    work[sag_settings];
    BenchSetting by_range[sag_settings] = {0}, by_area[sag_settings] = {0};
    double      *o[3], *d[3], *far_m = malloc(1024 * sizeof *far_m);
    char         name[sag_settings][48], against[64];
    Status       status = far_m ? STATUS_OK : STATUS_NO_MEMORY;
    bench_progress(bench, "facets");
    for (int c = 0; c < 3; c++) {
        o[c] = malloc(rays * sizeof *o[c]);
        d[c] = malloc(rays * sizeof *d[c]);
        if (!o[c] || !d[c]) status = STATUS_NO_MEMORY;
    }
    for (int k = 0; k < sag_settings; k++) set[k].side_px = side_px;
    if (status == STATUS_OK) {
        facet_rays(o, d, side_px);
        for (int k = 0; k < 1024; k++) far_m[k] = INFINITY;
        for (int k = -1; k < sag_settings && status == STATUS_OK; k++) {
            Faceted *f = k < 0 ? &fine : &set[k];
            for (int c = 0; c < 3; c++) f->o[c] = o[c], f->d[c] = d[c];
            f->far_m = far_m;
            status = faceted_open(f, k < 0 ? finest_m : sag_m[k]);
            if (status == STATUS_OK) trace_facets(f);
        }
    }
    for (int k = 0; k < sag_settings && status == STATUS_OK; k++) {
        snprintf(name[k], sizeof name[k], "%g mm, %d triangles", 1e3 * sag_m[k], set[k].model.triangle_count);
        by_range[k] =
            (BenchSetting){.setting = name[k], .bytes = bytes_of(&set[k].model), .is_default = sag_m[k] == 0.002};
        by_area[k] = by_range[k];
        facet_errors(&by_range[k].error, &by_area[k].error, &set[k], &fine);
        work[k] = (BenchWork){trace_facets, &set[k], (double)rays};
    }
    if (status == STATUS_OK) {
        snprintf(against, sizeof against, "p99 of range, a tank of %g mm", 1e3 * finest_m);
        for (int k = 0; k < sag_settings; k++) by_range[k].also = by_area[k].error, by_area[k].also = by_range[k].error;
        by_range[0].also_is = "of silhouettes, %", by_area[0].also_is = "of range, m";
        bench_tunable(bench, &(BenchTunable){"facets", "models.sag_m", "a ray at a tank", "m", against, 0.006}, work,
                      by_range, sag_settings);
        for (int k = 0; k < sag_settings; k++) by_area[k].time = by_range[k].time;
        snprintf(against, sizeof against, "share of its silhouettes, a tank of %g mm", 1e3 * finest_m);
        bench_tunable_rows(bench,
                           &(BenchTunable){"facets, silhouette", "models.sag_m", "a ray at a tank", "%", against, 0.5},
                           by_area, sag_settings);
    }
    for (int k = 0; k < sag_settings; k++) faceted_close(&set[k]);
    faceted_close(&fine);
    for (int c = 0; c < 3; c++) {
        free(o[c]);
        free(d[c]);
    }
    free(far_m);
    return status;
}

/* ---- mirrors of the pseudo-radar ---------------------------------------------------------------- */

enum { most_more = 6, radar_eyes = 8 };

/* The power of an image comes from a few glints, so its error is known only over several images. */
typedef struct Mirrors {
    Precision *p;
    int        more, samples, eyes;
    bool       plain;             /* no more rays at edges */
    double     total[radar_eyes]; /* of each image */
} Mirrors;

static void render_mirrors(void *user)
{
    Mirrors *m = user;
    for (int eye = 0; eye < m->eyes; eye++) {
        RenderRequest request = precision_request(m->p, SHOT_NEAR, 96, 64);
        Picture       picture;
        precision_go_round(&request.view, m->p, eye);
        request.bands = 1u << BAND_RADAR;
        request.samples = m->samples;
        if (m->samples > 1 || m->plain) request.edge_samples = request.target_samples = 0;
        m->p->scene.world.radar.more_bounces = m->more;
        arena_reset(m->p->arena);
        const Status status = precision_render(&picture, m->p, SHOT_NEAR, &request, m->p->arena);
        m->p->scene.world.radar.more_bounces = 0;
        m->total[eye] = 0;
        if (status != STATUS_OK) {
            m->p->status = status;
            return;
        }
        for (size_t i = 0; i < (size_t)picture.width * (size_t)picture.height; i++)
            m->total[eye] += (double)picture.radar[i];
    }
    bench_keep(m);
}

/* Root of the mean square over the sensor positions, %. */
static double mirrors_error(const Mirrors *got, const Mirrors *want)
{
    double sum = 0;
    for (int eye = 0; eye < want->eyes; eye++) sum += pow(got->total[eye] / want->total[eye] - 1, 2);
    return 100 * sqrt(sum / want->eyes);
}

static Status tunable_bounces(Precision *p)
{
    enum { settings = 6 };
    static const char *const name[settings] = {"1", "2", "3", "4", "5", "6"};
    static const int         more[settings] = {-5, -4, -3, -2, -1, 0};
    const int                eyes = bench_quick(p->bench) ? 2 : radar_eyes;
    Mirrors                  set[settings], fine = {.p = p, .more = most_more, .samples = 2, .eyes = eyes};
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    bench_progress(p->bench, "radar");
    render_mirrors(&fine);
    for (int k = 0; k < settings; k++) {
        set[k] = (Mirrors){.p = p, .more = more[k], .samples = 2, .eyes = eyes};
        work[k] = (BenchWork){render_mirrors, &set[k], eyes};
        render_mirrors(&set[k]);
        point[k] =
            (BenchSetting){.setting = name[k], .error = mirrors_error(&set[k], &fine), .is_default = more[k] == 0};
    }
    bench_tunable(p->bench,
                  &(BenchTunable){"mirrors of a radar path", "render/scattering/radar_image.h",
                                  "a radar picture of 96 x 64, 2 x 2 rays", "%", "power of pictures, rms; 12 mirrors",
                                  0.1},
                  work, point, settings);
    return p->status;
}

/* The keys are those of all bands and planes, so the timed work is that of `rays a pixel`, with the radar. */
static void render_shots(void *user)
{
    const Mirrors *m = user;
    for (int shot = 0; shot < SHOT_COUNT; shot++) {
        RenderRequest request = precision_request(m->p, (PrecisionShot)shot, m->p->shot_px[0], m->p->shot_px[1]);
        Picture       picture;
        request.bands |= 1u << BAND_RADAR;
        request.samples = m->samples;
        if (m->samples > 1 || m->plain) request.edge_samples = request.target_samples = 0;
        arena_reset(m->p->arena);
        const Status status = precision_render(&picture, m->p, (PrecisionShot)shot, &request, m->p->arena);
        if (status != STATUS_OK) m->p->status = status;
        bench_keep(&picture);
    }
}

static Status tunable_radar_rays(Precision *p)
{
    enum { settings = 6 };
    static const char *const name[settings] = {"1 x 1", "1 x 1, edges 4 x 4", "2 x 2", "3 x 3", "4 x 4", "6 x 6"};
    static const int         samples[settings] = {1, 1, 2, 3, 4, 6};
    const int                eyes = bench_quick(p->bench) ? 2 : radar_eyes;
    Mirrors                  set[settings], fine = {.p = p, .samples = bench_quick(p->bench) ? 12 : 16, .eyes = eyes};
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    render_mirrors(&fine);
    for (int k = 0; k < settings; k++) {
        set[k] = (Mirrors){.p = p, .samples = samples[k], .plain = k == 0, .eyes = eyes};
        work[k] = (BenchWork){render_shots, &set[k], SHOT_COUNT};
        render_mirrors(&set[k]);
        point[k] = (BenchSetting){.setting = name[k], .error = mirrors_error(&set[k], &fine), .is_default = k == 1};
    }
    bench_tunable(p->bench,
                  &(BenchTunable){"rays a pixel, radar", "sensor.samples, sensor.edge_samples",
                                  "a picture of four bands and truth", "%",
                                  "power of radar pictures, rms; 12 x 12 rays or more", 20},
                  work, point, bench_quick(p->bench) ? settings - 1 : settings);
    return p->status;
}

Status precision_models(Precision *p)
{
    Status status = tunable_bounces(p);
    if (status == STATUS_OK) status = tunable_radar_rays(p);
    if (status == STATUS_OK) status = tunable_facets(p->bench);
    return status;
}
