/* tests/bench/render/precision_trace.c: errors of the hits of rays on the ground and on parts. */
#include "tests/bench/suites.h"

#include "render/trace/ground/ground.h"
#include "render/trace/parts/parts.h"
#include "terrain/ground/landscape.h"
#include "tests/bench/bench.h"

#include <embree3/rtcore.h>
#include <stdlib.h>

/* ---- ground -------------------------------------------------------------------------------------- */

enum { ground_rays = 256, east_posts = 1200, north_posts = 3000 };

typedef struct GroundRays {
    const Elevation *elevation;
    Ground           ground;
    double           o[3][ground_rays], d[3][ground_rays], far_m[ground_rays];
} GroundRays;

typedef struct GroundSet {
    const GroundRays *rays;
    double step_posts; /* steps of a march; 0: the tracer, one at a time; -1: together; -2: line by line in float */
    double range_m[ground_rays];
} GroundSet;

static double clearance(const Elevation *e, const double o[3], const double d[3], double t)
{
    return o[2] + t * d[2] - elevation_height(e, o[0] + t * d[0], o[1] + t * d[1], NULL);
}

static double march_ground(const Elevation *e, const double o[3], const double d[3], double step_m)
{
    for (double t = 0;; t += step_m) {
        const double above = clearance(e, o, d, t + step_m);
        if (isnan(above)) return INFINITY;
        if (above > 0) continue;
        double low = t, high = t + step_m;
        for (int k = 0; k < 40; k++) {
            const double middle = 0.5 * (low + high);
            if (clearance(e, o, d, middle) > 0) low = middle;
            else high = middle;
        }
        return high;
    }
}

static float height_over_float(const ElevationLevel *g, const float u[2], float z)
{
    if (!(u[0] >= 0 && u[1] >= 0 && u[0] < g->nx - 1 && u[1] < g->ny - 1)) return NAN;
    const int   i = (int)u[0], j = (int)u[1];
    const float a = u[0] - (float)i, b = u[1] - (float)j;
    int32_t     post[4];
    elevation_cell(post, g, i, j);
    const float sw = (float)post[0], se = (float)post[1], nw = (float)post[2], ne = (float)post[3];
    return z - ((float)g->z0_m +
                (float)g->step_m * (a >= b ? sw + a * (se - sw) + b * (ne - se) : sw + a * (ne - nw) + b * (nw - sw)));
}

/* Does what walk_ground does, in float only: the accuracy of a float triangle tracer on this ground. */
static double walk_ground_float(const ElevationLevel *g, const GroundRays *r, int i)
{
    const float s = (float)g->spacing_m, d2 = (float)r->d[2][i], o2 = (float)r->o[2][i];
    float       u[3] = {(float)(r->o[0][i] - g->x0_m) / s, (float)(r->o[1][i] - g->y0_m) / s, 0};
    float       du[3] = {(float)r->d[0][i] / s, (float)r->d[1][i] / s, 0}, t = 0, above = 1, line[3];
    u[2] = u[0] - u[1], du[2] = du[0] - du[1];
    for (int k = 0; k < 3; k++) line[k] = du[k] > 0 ? floorf(u[k]) + 1 : ceilf(u[k]) - 1;
    for (;;) {
        int   next = 0;
        float at = INFINITY;
        for (int k = 0; k < 3; k++) {
            const float when = (line[k] - u[k]) / du[k];
            if (du[k] != 0 && when < at) at = when, next = k;
        }
        line[next] += du[next] > 0 ? 1 : -1;
        const float place[2] = {u[0] + at * du[0], u[1] + at * du[1]}, here = height_over_float(g, place, o2 + at * d2);
        if (isnan(here)) return INFINITY;
        if (here <= 0) return (double)(t + (at - t) * (above / (above - here)));
        t = at, above = here;
    }
}

static void trace_ground(void *user)
{
    GroundSet          *s = user;
    const GroundRays   *r = s->rays;
    const double *const o[3] = {r->o[0], r->o[1], r->o[2]}, *const d[3] = {r->d[0], r->d[1], r->d[2]};
    if (s->step_posts == -1) ground_first_hits_together(s->range_m, NULL, &r->ground, ground_rays, o, d, r->far_m);
    for (int i = 0; s->step_posts == -2 && i < ground_rays; i++)
        s->range_m[i] = walk_ground_float(&r->elevation->level[0], r, i);
    for (int i = 0; s->step_posts >= 0 && i < ground_rays; i++) {
        const double at[3] = {o[0][i], o[1][i], o[2][i]}, way[3] = {d[0][i], d[1][i], d[2][i]};
        s->range_m[i] = s->step_posts > 0 ? march_ground(r->elevation, at, way, s->step_posts)
                                          : ground_first_hit(NULL, &r->ground, at, way, INFINITY);
    }
    bench_keep(s->range_m);
}

static long double height_over(const ElevationLevel *g, const long double p[3])
{
    const long double u = (p[0] - (long double)g->x0_m) / (long double)g->spacing_m,
                      v = (p[1] - (long double)g->y0_m) / (long double)g->spacing_m;
    if (!(u >= 0 && v >= 0 && u < g->nx - 1 && v < g->ny - 1)) return NAN;
    const int         i = (int)u, j = (int)v;
    const long double a = u - i, b = v - j;
    int32_t           post[4];
    elevation_cell(post, g, i, j);
    const long double sw = post[0], se = post[1], nw = post[2], ne = post[3];
    const long double posts = a >= b ? sw + a * (se - sw) + b * (ne - se) : sw + a * (ne - nw) + b * (nw - sw);
    return p[2] - ((long double)g->z0_m + (long double)g->step_m * posts);
}

/* Walks from one line of posts or diagonal to the next, in long double; between them the height above the ground is
 * linear. */
static long double walk_ground(const ElevationLevel *g, const GroundRays *r, int i)
{
    const long double s = (long double)g->spacing_m;
    long double       u[3] = {((long double)r->o[0][i] - (long double)g->x0_m) / s,
                              ((long double)r->o[1][i] - (long double)g->y0_m) / s, 0};
    long double       du[3] = {(long double)r->d[0][i] / s, (long double)r->d[1][i] / s, 0}, t = 0, above = 1;
    long long         line[3];
    u[2] = u[0] - u[1], du[2] = du[0] - du[1];
    for (int k = 0; k < 3; k++) line[k] = (long long)(du[k] > 0 ? floorl(u[k]) + 1 : ceill(u[k]) - 1);
    for (;;) {
        int         next = 0;
        long double at = INFINITY;
        for (int k = 0; k < 3; k++) {
            const long double when = ((long double)line[k] - u[k]) / du[k];
            if (du[k] != 0 && when < at) at = when, next = k;
        }
        line[next] += du[next] > 0 ? 1 : -1;
        const long double p[3] = {(long double)r->o[0][i] + at * (long double)r->d[0][i],
                                  (long double)r->o[1][i] + at * (long double)r->d[1][i],
                                  (long double)r->o[2][i] + at * (long double)r->d[2][i]};
        const long double here = height_over(g, p);
        if (isnan(here)) return INFINITY;
        if (here <= 0) return t + (at - t) * (above / (above - here));
        t = at, above = here;
    }
}

static Status tunable_ground(Bench *bench)
{
    enum { settings = 6 };
    static const char *const name[settings] = {"marched by 4 posts, halved",    "marched by 1 post, halved",
                                               "marched by 1 / 4 post, halved", "every line met in float",
                                               "lines met in double, one ray",  "lines met in double, a tile of rays"};
    static const double      step[settings] = {4, 1, 0.25, -2, 0, -1};
    static GroundRays        rays;
    static GroundSet         set[settings];
    static double            error[ground_rays], want[ground_rays];
    const Geodetic           origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    LocalFrame               frame;
    Landscape                landscape = {0};
    Pool                    *pool = NULL;
    double                   times_s[2];
    Status                   status = pool_create(&pool, bench_threads(bench));
    bench_progress(bench, "ground");
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = landscape_quick(&landscape, times_s, &frame, east_posts, north_posts, pool);
    pool_destroy(pool);
    if (status != STATUS_OK) return status;
    rays.elevation = &landscape.elevation;
    ground_prepare(&rays.ground, rays.elevation);
    const double eye_m = elevation_height(rays.elevation, 10, -1400, NULL) + 60;
    for (int i = 0; i < ground_rays; i++) {
        double d[3] = {0.18 * (i % 16 - 7.5) / 16, 1, -0.04 - 0.16 * (i / 16) / 16.0};
        v3_normalize(d, d);
        rays.o[0][i] = 10.37, rays.o[1][i] = -1399.41, rays.o[2][i] = eye_m;
        for (int c = 0; c < 3; c++) rays.d[c][i] = d[c];
        rays.far_m[i] = INFINITY;
        want[i] = (double)walk_ground(&landscape.elevation.level[0], &rays, i);
    }
    for (int k = 0; k < settings; k++) {
        set[k] = (GroundSet){.rays = &rays, .step_posts = step[k]};
        trace_ground(&set[k]);
        for (int i = 0; i < ground_rays; i++)
            error[i] = set[k].range_m[i] == want[i] ? 0 : fabs(set[k].range_m[i] - want[i]);
        qsort(error, ground_rays, sizeof *error, bench_by_value);
        work[k] = (BenchWork){trace_ground, &set[k], ground_rays};
        point[k] = (BenchSetting){.setting = name[k], .error = error[ground_rays - 1], .is_default = k == settings - 1};
    }
    bench_tunable(bench,
                  &(BenchTunable){"range to the ground", "render/trace/ground/ground.h", "an eye ray over posts of 1 m",
                                  "m", "largest, line by line in long double", 1e-9},
                  work, point, settings);
    landscape_destroy(&landscape);
    return STATUS_OK;
}

/* ---- parts --------------------------------------------------------------------------------------- */

enum { part_rays = 1024 };

typedef struct PartSet {
    /* 0: Embree's triangles from the eye; 1: those from the model's sphere; 2: boxes, then exact tests in double */
    int          way;
    PosedEntity *posed;
    RTCScene     scene;
    double       o[3][part_rays], d[3][part_rays], far_m[part_rays], range_m[part_rays];
    PartHit      hit[part_rays];
    int          list[part_rays];
} PartSet;

static void trace_parts(void *user)
{
    PartSet            *s = user;
    const double *const o[3] = {s->o[0], s->o[1], s->o[2]}, *const d[3] = {s->d[0], s->d[1], s->d[2]};
    for (int i = 0; i < part_rays; i++) s->range_m[i] = INFINITY;
    if (s->way == 2) parts_first_hits(s->range_m, s->hit, s->posed, o, d, s->far_m, s->list, part_rays, false);
    for (int first = 0; s->way < 2 && first < part_rays; first += 16) {
        struct RTCIntersectContext context;
        struct RTCRayHit16         ray;
        double                     start_m[16];
        static const int           valid[16]
            __attribute__((aligned(64))) = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
        rtcInitIntersectContext(&context);
        for (int l = 0; l < 16; l++) {
            const int    i = first + l;
            double       from[3];
            const double way[3] = {d[0][i], d[1][i], d[2][i]};
            for (int c = 0; c < 3; c++) from[c] = o[c][i] - s->posed->centre_enu[c];
            start_m[l] = s->way ? fmax(-v3_dot(from, way) - s->posed->radius_m, 0) : 0;
            v3_add_scaled(from, from, start_m[l], way);
            ray.ray.org_x[l] = (float)from[0], ray.ray.org_y[l] = (float)from[1], ray.ray.org_z[l] = (float)from[2];
            ray.ray.dir_x[l] = (float)way[0], ray.ray.dir_y[l] = (float)way[1], ray.ray.dir_z[l] = (float)way[2];
            ray.ray.tnear[l] = ray.ray.time[l] = 0, ray.ray.tfar[l] = INFINITY;
            ray.ray.mask[l] = 0xFFFFFFFFu, ray.ray.flags[l] = 0, ray.ray.id[l] = 0;
            ray.hit.geomID[l] = ray.hit.instID[0][l] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, s->scene, &context, &ray);
        for (int l = 0; l < 16; l++)
            if (ray.hit.geomID[l] != RTC_INVALID_GEOMETRY_ID)
                s->range_m[first + l] = start_m[l] + (double)ray.ray.tfar[l];
    }
    bench_keep(s->range_m);
}

/* Makes a scene of all triangles of a posed model about its centre, in float. */
static RTCScene float_scene(RTCDevice device, const Model *model, const PosedEntity *posed, const NodePose *pose)
{
    RTCScene    scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *vertex = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                            3 * (size_t)model->triangle_count);
    uint32_t *index = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(uint32_t), (size_t)model->triangle_count);
    for (int t = 0; vertex && index && t < model->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const NodePose *node = &pose[model->part[model->triangle_part[t]].node];
            double          at_body[3], at[3];
            m3_mul_v3(at_body, node->r_body_from_node, model->vertex[model->triangle[t][k]]);
            v3_add(at_body, at_body, node->p_body);
            m3_mul_v3(at, posed->r_enu_from_body, at_body);
            for (int c = 0; c < 3; c++)
                vertex[9 * t + 3 * k + c] = (float)(at[c] + posed->p_enu[c] - posed->centre_enu[c]);
            index[3 * t + k] = (uint32_t)(3 * t + k);
        }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

/* Where a ray meets the plane of a triangle, in long double. */
static double plane_range(const Model *model, const PosedNode *node, uint32_t triangle, const PartSet *s, int i)
{
    const uint32_t *index = model->triangle[triangle];
    long double     o[3] = {0}, d[3] = {0}, n[3], a[3], b[3];
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) { /* transpose(r) (o - p) */
            o[c] +=
                (long double)node->r_enu_from_node[3 * k + c] * ((long double)s->o[k][i] - (long double)node->p_enu[k]);
            d[c] += (long double)node->r_enu_from_node[3 * k + c] * (long double)s->d[k][i];
        }
    for (int c = 0; c < 3; c++) {
        a[c] = (long double)model->vertex[index[1]][c] - (long double)model->vertex[index[0]][c];
        b[c] = (long double)model->vertex[index[2]][c] - (long double)model->vertex[index[0]][c];
    }
    long double above = 0, along = 0;
    for (int c = 0; c < 3; c++) {
        n[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
        above += n[c] * ((long double)model->vertex[index[0]][c] - o[c]);
        along += n[c] * d[c];
    }
    return (double)(above / along);
}

static void time_parts(Bench *bench, const Model *model, PosedEntity *posed, const NodePose *pose, RTCDevice device)
{
    enum { settings = 3 };
    static const char *const name[settings] = {"triangles in float, from the eye",
                                               "triangles in float, from the model's sphere",
                                               "boxes in float, triangles in double"};
    static PartSet           set[settings];
    static double            error[part_rays];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    RTCScene                 scene = float_scene(device, model, posed, pose);
    for (int k = settings - 1; k >= 0; k--) { /* the last is the index of the triangle */
        int met = 0;
        set[k].way = k, set[k].posed = posed, set[k].scene = scene;
        for (int i = 0; i < part_rays; i++) {
            double d[3] = {3000, 6.0 * ((i % 32 + 0.5) / 32 - 0.5), 2.0 * ((i / 32 + 0.5) / 32 - 0.5) - 300};
            v3_normalize(d, d);
            for (int c = 0; c < 3; c++) {
                set[k].o[c][i] = posed->centre_enu[c] + (c == 0 ? -3000 : c == 2 ? 300 : 0);
                set[k].d[c][i] = d[c];
            }
            set[k].far_m[i] = INFINITY;
            set[k].list[i] = i;
        }
        trace_parts(&set[k]);
        for (int i = 0; i < part_rays; i++) {
            const PartHit *hit = &set[settings - 1].hit[i];
            if (!(set[settings - 1].range_m[i] < INFINITY) || !(set[k].range_m[i] < INFINITY)) continue;
            error[met++] =
                fabs(set[k].range_m[i] - plane_range(model, &posed->node[hit->node], hit->triangle, &set[k], i));
        }
        qsort(error, (size_t)met, sizeof *error, bench_by_value);
        work[k] = (BenchWork){trace_parts, &set[k], part_rays};
        point[k] =
            (BenchSetting){.setting = name[k], .error = met > 0 ? error[met * 99 / 100] : NAN, .is_default = k == 2};
    }
    bench_tunable(bench,
                  &(BenchTunable){"range to a part", "render/trace/parts/parts_trace.c", "a ray at a tank 3 km away",
                                  "m", "p99, the triangle's plane in long double", 1e-9},
                  work, point, settings);
    rtcReleaseScene(scene);
}

static Status tunable_parts(Bench *bench)
{
    static const double p_enu[3] = {123.4, 567.8, 90.1};
    const double        turn = 0.6, r[9] = {cos(turn), sin(turn), 0, sin(turn), -cos(turn), 0, 0, 0, -1};
    char                path[512];
    Catalog            *catalog = NULL;
    Tracer             *tracer = NULL;
    Arena              *arena = arena_create();
    PosedEntity         posed;
    Origin              origin;
    bench_progress(bench, "parts");
    RTCDevice device = rtcNewDevice("isa=avx2");
    Status status = arena && device && etc_path(path, sizeof path, "catalog.csv") ? catalog_open(&catalog, path, 0.01)
                                                                                  : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        const int    which = catalog_find(catalog, (DisEntityType){1, 1, 222, 1, 1, 1, 0}, &origin, NULL);
        const Model *model = catalog_model(catalog, which);
        NodePose    *pose = arena_alloc(arena, (size_t)model->node_count, sizeof *pose);
        status = tracer_create_models(&tracer, &model, 1, "avx2");
        if (status == STATUS_OK)
            posed.node = arena_alloc(arena, (size_t)parts_node_count(tracer, 0), sizeof *posed.node);
        if (status == STATUS_OK && (!pose || !posed.node)) status = STATUS_NO_MEMORY;
        if (status == STATUS_OK) {
            model_pose(pose, model, NULL);
            parts_pose(&posed, tracer, 0, pose, p_enu, r, 0);
            time_parts(bench, model, &posed, pose, device);
        }
    }
    tracer_destroy(tracer);
    catalog_close(catalog);
    if (device) rtcReleaseDevice(device);
    arena_destroy(arena);
    return status;
}

Status bench_precision_trace(Bench *bench)
{
    Status status = tunable_ground(bench);
    if (status == STATUS_OK) status = tunable_parts(bench);
    if (status != STATUS_OK) log_error("bench: precision: rays: %s", status_name(status));
    return status;
}
