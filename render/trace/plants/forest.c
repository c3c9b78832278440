/* render/trace/plants/forest.c: builds what rays are traced against: a scene for each prototype and level, and a tree
 * of boxes over all standing plants. */

#include "render/trace/plants/forest_private.h"

#include <stdio.h>
#include <stdlib.h>

/* ---- errors ----------------------------------------------------------------------------------- */

void forest_latch_error(void *user, enum RTCError code, const char *text)
{
    Forest *forest = user;
    int     none = RTC_ERROR_NONE;
    if (__atomic_compare_exchange_n(&forest->error, &none, (int)code, false, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST))
        log_warn("forest: Embree: %s", text ? text : "?");
}

Status forest_status(const Forest *forest)
{
    const int code = __atomic_load_n(&forest->error, __ATOMIC_SEQ_CST);
    return code == RTC_ERROR_NONE ? STATUS_OK : code == RTC_ERROR_OUT_OF_MEMORY ? STATUS_NO_MEMORY : STATUS_UNSUPPORTED;
}

/* ---- prototypes ------------------------------------------------------------------------------- */

/* How far a shape reaches towards equally spaced azimuths. */
static void find_reach(ShapeScene *out, int quads)
{
    double cosine[shape_azimuths], sine[shape_azimuths], *most = out->reach;
    for (int a = 0; a < shape_azimuths; a++) {
        cosine[a] = out->azimuth[a][0], sine[a] = out->azimuth[a][1];
        most[a] = -INFINITY;
    }
    for (int q = 0; q < quads; q++)
        for (int k = 0; k < 4; k++) {
            const double x = (double)out->shape->quad[q].corner[k][0], y = (double)out->shape->quad[q].corner[k][1];
            for (int a = 0; a < shape_azimuths; a++) {
                const double reach = cosine[a] * x + sine[a] * y;
                most[a] = reach > most[a] ? reach : most[a];
            }
        }
    most[shape_azimuths] = most[0];
}

static Status build_shape(ShapeScene *out, const Forest *forest, int kind, int level)
{
    const PlantShape *shape = &forest->plants->shape[kind][level];
    const bool        bare = !forest->config.leaves && plant_is_deciduous((PlantKind)kind);
    const int         quads = bare ? shape->bark_quads : shape->quads;
    out->shape = shape;
    out->outline = forest->plants->outline[kind];
    out->azimuth = forest->azimuth;
    for (int c = 0; c < 3; c++) {
        out->centre[c] = 0.5 * ((double)shape->low[c] + (double)shape->high[c]);
        out->half[c] = 0.5 * ((double)shape->high[c] - (double)shape->low[c]) + 1e-4;
    }
    out->radius = sqrt(pow(fabs(out->centre[0]) + out->half[0], 2) + pow(fabs(out->centre[1]) + out->half[1], 2) +
                       pow(fabs(out->centre[2] - 0.5) + out->half[2], 2));
    if (quads == 0) return STATUS_OK;
    find_reach(out, quads);
    RTCGeometry geometry = rtcNewGeometry(forest->device, RTC_GEOMETRY_TYPE_QUAD);
    float      *vertex = geometry ? rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                            3 * sizeof(float), (size_t)quads * 4)
                                  : NULL;
    unsigned   *index = geometry ? rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                                                           4 * sizeof(unsigned), (size_t)quads)
                                 : NULL;
    if (!vertex || !index || !(out->scene = rtcNewScene(forest->device))) {
        if (geometry) rtcReleaseGeometry(geometry);
        return STATUS_NO_MEMORY;
    }
    for (int q = 0; q < quads; q++)
        for (int k = 0; k < 4; k++) {
            index[4 * q + k] = (unsigned)(4 * q + k);
            for (int c = 0; c < 3; c++)
                vertex[3 * (4 * q + k) + c] = shape->quad[q].corner[k][c] - (float)out->centre[c];
        }
    rtcSetGeometryUserData(geometry, out);
    rtcSetGeometryIntersectFilterFunction(geometry, quad_intersect);
    rtcSetGeometryOccludedFilterFunction(geometry, quad_occlude);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(out->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(out->scene);
    return forest_status(forest);
}

/* ---- lists ------------------------------------------------------------------------------------ */

Status plant_list_commit(PlantList *list, const Forest *forest, bool quick)
{
    if (list->count == 0) return STATUS_OK;
    const RTCDevice device = list->far ? forest->page_device : forest->device;
    RTCGeometry     geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    if (!geometry) return STATUS_NO_MEMORY;
    list->scene = rtcNewScene(device);
    if (!list->scene) {
        rtcReleaseGeometry(geometry);
        return STATUS_NO_MEMORY;
    }
    rtcSetGeometryUserPrimitiveCount(geometry, (unsigned)((list->count + list->per_box - 1) / list->per_box));
    rtcSetGeometryUserData(geometry, list);
    rtcSetGeometryBoundsFunction(geometry, plant_box, list);
    rtcSetGeometryIntersectFunction(geometry, plant_intersect);
    rtcSetGeometryOccludedFunction(geometry, plant_occlude);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(list->scene, geometry);
    rtcReleaseGeometry(geometry);
    if (quick) rtcSetSceneBuildQuality(list->scene, RTC_BUILD_QUALITY_LOW);
    rtcSetSceneFlags(list->scene, RTC_SCENE_FLAG_COMPACT);
    rtcCommitScene(list->scene);
    return forest_status(forest);
}

void plant_list_close(PlantList *list)
{
    if (list->scene) rtcReleaseScene(list->scene);
    list->scene = NULL;
}

/* ---- the forest ------------------------------------------------------------------------------- */

Status forest_create(Forest **out, const Woods *woods, const Plants *plants, const ForestConfig *config,
                     const char *isa)
{
    char    settings[64] = "";
    Forest *forest = calloc(1, sizeof *forest);
    Status  status = STATUS_OK;
    if (!forest || !(forest->squares = low_squares_create())) {
        free(forest);
        return STATUS_NO_MEMORY;
    }
    forest->woods = woods, forest->plants = plants, forest->config = *config;
    if (isa && *isa) snprintf(settings, sizeof settings, "isa=%s", isa);
    forest->device = rtcNewDevice(settings);
    if (!forest->device) {
        log_error("forest: Embree does not start: isa=%s", isa && *isa ? isa : "auto");
        low_squares_destroy(forest->squares);
        free(forest);
        return STATUS_UNSUPPORTED;
    }
    rtcSetDeviceErrorFunction(forest->device, forest_latch_error, forest);
    for (int a = 0; a <= shape_azimuths; a++) {
        forest->azimuth[a][0] = cos(2 * pi_rad * (a % shape_azimuths) / shape_azimuths);
        forest->azimuth[a][1] = sin(2 * pi_rad * (a % shape_azimuths) / shape_azimuths);
    }
    for (int kind = 0; kind < PLANT_KINDS && status == STATUS_OK; kind++)
        for (int level = 0; level < plant_levels && status == STATUS_OK; level++)
            status = build_shape(&forest->shape[kind][level], forest, kind, level);
    forest->standing = (PlantList){.forest = forest, .plant = woods->plant, .count = woods->count, .per_box = 1};
    memcpy(forest->standing.origin_enu, woods->origin_enu, sizeof woods->origin_enu);
    if (status == STATUS_OK) status = plant_list_commit(&forest->standing, forest, false);
    if (status == STATUS_OK) status = forest_pages_create(forest, isa);
    if (status != STATUS_OK) {
        forest_destroy(forest);
        return status;
    }
    *out = forest;
    return STATUS_OK;
}

Status forest_create_beside(Forest **out, const Forest *of, const Woods *woods)
{
    Forest *forest = malloc(sizeof *forest);
    if (!forest) return STATUS_NO_MEMORY;
    *forest = *of;
    rtcRetainDevice(forest->device); /* errors of either are latched by `of` */
    forest->borrows = true, forest->woods = woods, forest->error = RTC_ERROR_NONE, forest->pages = NULL;
    forest->standing = (PlantList){.forest = forest, .plant = woods->plant, .count = woods->count, .per_box = 1};
    memcpy(forest->standing.origin_enu, woods->origin_enu, sizeof woods->origin_enu);
    forest->squares = low_squares_create();
    Status status = forest->squares ? plant_list_commit(&forest->standing, forest, true) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = forest_status(of);
    if (status == STATUS_OK) *out = forest;
    else forest_destroy(forest);
    return status;
}

void forest_destroy(Forest *forest)
{
    if (!forest) return;
    plant_list_close(&forest->standing);
    forest_pages_destroy(forest);
    for (int kind = 0; kind < PLANT_KINDS && !forest->borrows; kind++)
        for (int level = 0; level < plant_levels; level++)
            if (forest->shape[kind][level].scene) rtcReleaseScene(forest->shape[kind][level].scene);
    rtcReleaseDevice(forest->device);
    low_squares_destroy(forest->squares);
    free(forest);
}

const Woods  *forest_woods(const Forest *forest) { return forest->woods; }
const Plants *forest_plants(const Forest *forest) { return forest->plants; }
ForestConfig  forest_config(const Forest *forest) { return forest->config; }
bool          forest_simplifies(const Forest *forest) { return forest->config.level1_px > 0; }

/* ---- a frame ---------------------------------------------------------------------------------- */

Status forest_frame_open(ForestFrame *out, const Forest *forest, const double eye_enu[3], double per_rad,
                         double low_reach_m, double t_s, const double wind_mps[2], Pool *pool, Arena *arena)
{
    *out = (ForestFrame){.forest = forest, .per_rad = per_rad, .low_reach_m = low_reach_m, .t_s = t_s};
    memcpy(out->eye_enu, eye_enu, sizeof out->eye_enu);
    memcpy(out->wind_mps, wind_mps, sizeof out->wind_mps);
    const Status status = far_pages_open(out, pool);
    if (status != STATUS_OK || !(low_reach_m > 0)) return status;
    return low_plants_open(out, low_reach_m, pool, arena);
}

void forest_frame_close(ForestFrame *frame)
{
    low_plants_close(frame);
    far_pages_close(frame);
}

/* The whole crown leans with the wind's pressure, which grows with its square, and swings about that at its natural
 * frequency: 0.3 Hz at 15 m, in inverse proportion to the height (Moore & Maguire, Trees 18, 195, 2004: 0.1 to 0.5 Hz
 * for conifers of 10 to 30 m). 0.1 rad at 10 m/s, half of it steady, is an estimate. */
void forest_sway(double sway_rad[2], const ForestFrame *frame, const Plant *plant, double x_m, double y_m)
{
    const double of = frame->forest->config.sway;
    sway_rad[0] = sway_rad[1] = 0;
    if (!(of > 0)) return;
    const double wind_mps = sqrt(frame->wind_mps[0] * frame->wind_mps[0] + frame->wind_mps[1] * frame->wind_mps[1]);
    const double height_m = fmax(plant_height_m(plant), 1), frequency_hz = 0.3 * 15 / height_m;
    /* gusts move over the woods with the wind */
    const double phase = plant->twist * (2 * pi_rad / 65536) +
                         (wind_mps > 0 ? (x_m * frame->wind_mps[0] + y_m * frame->wind_mps[1]) / (20 * wind_mps) : 0);
    const double swing = 0.5 + 0.5 * sin(2 * pi_rad * fmin(frequency_hz, 2) * frame->t_s - phase);
    const double lean = fmin(of * 0.1 * wind_mps * 0.01 * (0.5 + 0.5 * swing), most_sway_rad / fmax(wind_mps, 1));
    for (int k = 0; k < 2; k++) sway_rad[k] = lean * frame->wind_mps[k];
}

bool forest_is_low_in_picture(const ForestFrame *frame, const Plant *plant, const double foot_enu[3])
{
    double to_eye[3];
    if (!(frame->forest->config.level1_px > 0)) return false;
    v3_sub(to_eye, foot_enu, frame->eye_enu);
    return plant_height_m(plant) * frame->per_rad < frame->forest->config.level1_px * v3_length(to_eye);
}

/* ---- how much even light from above and from below reaches each quad past -------------------- */

/* How much even light from above and from below reaches each quad past its own plant. */

enum { quads_a_task = 256, leaf_rays = 12 /* a side */, bark_rays = 8 };

typedef struct Opening {
    const ShapeScene *scene;
    PlantShape       *shape;
} Opening;

/* Direction k of count about n, as dense as the cosine to it; turned: about n, in turns. */
static void towards(double d[3], const double n[3], int k, int count, double turned)
{
    const double radius = sqrt((k + 0.5) / count), turn = 2 * pi_rad * (0.6180339887498949 * k + turned);
    double       u[3], v[3];
    v3_cross(u, n, fabs(n[2]) < 0.9 ? (const double[3]){0, 0, 1} : (const double[3]){1, 0, 0});
    v3_normalize(u, u);
    v3_cross(v, n, u);
    for (int c = 0; c < 3; c++)
        d[c] = radius * (cos(turn) * u[c] + sin(turn) * v[c]) + sqrt(1 - radius * radius) * n[c];
}

/* Rays from the middle of a quad, from one side of it: how many go up and down, and how many of these are free. */
static void count_rays(int all[2], int open[2], const ShapeScene *scene, const PlantQuad *q, int number, double side)
{
    static const double off = 1e-4; /* of the plant's height */
    const int           count = q->organ == PLANT_LEAF ? leaf_rays : bark_rays;
    double              n[3], o[3];
    for (int c = 0; c < 3; c++) {
        n[c] = side * (double)q->n[0][c];
        o[c] = off * n[c];
        for (int k = 0; k < 4; k++) o[c] += 0.25 * (double)q->corner[k][c];
    }
    for (int k = 0; k < count; k++) {
        double d[3];
        towards(d, n, k, count, random_uniform(1995, (uint32_t)(side > 0), 0, (uint64_t)number));
        const int down = d[2] < 0;
        all[down]++;
        open[down] += !shape_occluded(scene, o, d);
    }
}

static void open_quads(void *user, int worker, int task)
{
    const Opening *o = user;
    const int      first = task * quads_a_task, end = first + quads_a_task;
    (void)worker;
    for (int k = first; k < end && k < o->shape->quads; k++) {
        PlantQuad *q = &o->shape->quad[k];
        int        all[2] = {0}, open[2] = {0};
        count_rays(all, open, o->scene, q, k, 1);
        if (q->organ == PLANT_LEAF) count_rays(all, open, o->scene, q, k, -1);
        const float both = (float)(open[0] + open[1]) / (float)(all[0] + all[1]); /* where all go one way */
        q->open_up = all[0] ? (float)open[0] / (float)all[0] : both;
        q->open_down = all[1] ? (float)open[1] / (float)all[1] : both;
    }
}

void forest_openness(Plants *plants, const Forest *forest, Pool *pool)
{
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++) {
            Opening   o = {&forest->shape[kind][level], &plants->shape[kind][level]};
            const int tasks = (o.shape->quads + quads_a_task - 1) / quads_a_task;
            if (pool) pool_run(pool, tasks, open_quads, &o);
            else
                for (int k = 0; k < tasks; k++) open_quads(&o, 0, k);
        }
}
