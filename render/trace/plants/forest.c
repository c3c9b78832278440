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

/* What is known of a shape without its scene. */
static void open_shape(ShapeScene *out, const Forest *forest, int kind, int level)
{
    const PlantShape *shape = &forest->plants->shape[kind][level];
    const bool        bare = !forest->config.leaves && plant_is_deciduous((PlantKind)kind);
    const int         quads = bare ? shape->bark_quads : shape->quads;
    out->shape = shape;
    out->outline = forest->plants->outline[kind];
    out->pattern = level == plant_fine && kind < forest->plants->patterned ? forest->plants->pattern[kind] : NULL;
    out->azimuth = forest->azimuth;
    for (int c = 0; c < 3; c++) {
        out->centre[c] = 0.5 * ((double)shape->low[c] + (double)shape->high[c]);
        out->half[c] = 0.5 * ((double)shape->high[c] - (double)shape->low[c]) + 1e-4;
    }
    if (level == plant_fine && !forest->config.fine) return;
    out->quads = quads;
    if (quads > 0) find_reach(out, quads);
}

Status shape_scene_build(ShapeScene *out, const Forest *forest)
{
    const PlantShape *shape = out->shape;
    const int         quads = out->quads;
    if (quads == 0) return STATUS_OK;
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

/* Box and reach over the levels of a kind that are traced. */
static void unite_levels(ShapeScene *hull, const ShapeScene level[plant_levels])
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, square = 0;
    for (int a = 0; a <= shape_azimuths; a++) hull->reach[a] = -INFINITY;
    for (int l = 0; l < plant_levels; l++) {
        if (level[l].quads == 0) continue;
        hull->azimuth = level[l].azimuth;
        for (int c = 0; c < 3; c++) {
            low[c] = fmin(low[c], level[l].centre[c] - level[l].half[c]);
            high[c] = fmax(high[c], level[l].centre[c] + level[l].half[c]);
        }
        for (int a = 0; a <= shape_azimuths; a++) hull->reach[a] = fmax(hull->reach[a], level[l].reach[a]);
    }
    for (int c = 0; c < 3 && hull->azimuth; c++) {
        hull->centre[c] = 0.5 * (low[c] + high[c]), hull->half[c] = 0.5 * (high[c] - low[c]);
        hull->most = fmax(hull->most, fmax(-low[c], high[c]));
    }
    for (int c = 0; c < 3 && hull->azimuth; c++) {
        const double most = fabs(hull->centre[c] - (c == 2 ? 0.5 : 0)) + hull->half[c];
        square += most * most;
    }
    hull->radius = sqrt(square);
}

/* Where a kind has a table, its finest shape alone is traced through, but for forest_openness. */
static Status build_shapes(Forest *forest)
{
    Status status = STATUS_OK;
    for (int kind = 0; kind < PLANT_KINDS && status == STATUS_OK; kind++) {
        ShapeScene *shape = forest->shape[kind], *finest = &shape[forest_finest(forest)];
        for (int level = 0; level < plant_levels; level++) open_shape(&shape[level], forest, kind, level);
        unite_levels(&forest->hull[kind], shape);
        const bool by_table = forest->config.tables && kind < PLANT_STANDING && finest->quads > 0;
        for (int level = 0; level < plant_levels && status == STATUS_OK; level++)
            if (!by_table || &shape[level] == finest) status = shape_scene_build(&shape[level], forest);
        if (status == STATUS_OK && by_table) status = plant_table_create(&forest->table[kind], finest);
    }
    return status;
}

/* ---- lists ------------------------------------------------------------------------------------ */

RTCScene forest_boxes(RTCDevice device, int boxes, const BoxCalls *calls, void *user)
{
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    RTCScene    scene = geometry ? rtcNewScene(device) : NULL;
    if (scene) {
        rtcSetGeometryUserPrimitiveCount(geometry, (unsigned)boxes);
        rtcSetGeometryUserData(geometry, user);
        rtcSetGeometryBoundsFunction(geometry, calls->bounds, user);
        rtcSetGeometryIntersectFunction(geometry, calls->intersect);
        rtcSetGeometryOccludedFunction(geometry, calls->occlude);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
    }
    if (geometry) rtcReleaseGeometry(geometry);
    return scene;
}

Status plant_list_commit(PlantList *list, const Forest *forest, bool quick)
{
    static const BoxCalls calls = {plant_box, plant_intersect, plant_occlude};
    if (list->count == 0) return STATUS_OK;
    if (!list->frame && !list->far && forest->config.tables &&
        !(list->bounds = malloc((size_t)list->count * sizeof *list->bounds)))
        return STATUS_NO_MEMORY;
    const int boxes = (list->count + list->per_box - 1) / list->per_box;
    list->scene = forest_boxes(list->far ? forest->page_device : forest->device, boxes, &calls, list);
    if (!list->scene) return STATUS_NO_MEMORY;
    if (quick) rtcSetSceneBuildQuality(list->scene, RTC_BUILD_QUALITY_LOW);
    rtcSetSceneFlags(list->scene, RTC_SCENE_FLAG_COMPACT);
    rtcCommitScene(list->scene);
    return forest_status(forest);
}

void plant_list_close(PlantList *list)
{
    if (list->scene) rtcReleaseScene(list->scene);
    free(list->bounds);
    list->scene = NULL, list->bounds = NULL;
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
    forest->packets = rtcGetDeviceProperty(forest->device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0;
    for (int a = 0; a <= shape_azimuths; a++) {
        forest->azimuth[a][0] = cos(2 * pi_rad * (a % shape_azimuths) / shape_azimuths);
        forest->azimuth[a][1] = sin(2 * pi_rad * (a % shape_azimuths) / shape_azimuths);
    }
    status = build_shapes(forest);
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
    if (!forest->borrows) forest_kept_destroy(forest);
    forest_pages_destroy(forest);
    for (int kind = 0; kind < PLANT_STANDING && !forest->borrows; kind++) plant_table_destroy(forest->table[kind]);
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

bool forest_simplifies(const Forest *forest)
{
    const ForestConfig *c = &forest->config;
    return c->level1_px > 0 || (c->fine && !c->all_fine) || c->tables;
}

/* ---- a frame ---------------------------------------------------------------------------------- */

Status forest_frame_open(ForestFrame *out, const Forest *forest, const double eye_enu[3], double per_rad,
                         double low_reach_m, double t_s, const double wind_mps[2], Pool *pool, Arena *arena)
{
    *out = (ForestFrame){.forest = forest, .per_rad = per_rad, .ray_px = 1, .low_reach_m = low_reach_m, .t_s = t_s};
    memcpy(out->eye_enu, eye_enu, sizeof out->eye_enu);
    memcpy(out->wind_mps, wind_mps, sizeof out->wind_mps);
    const Status status = far_pages_open(out, pool);
    if (status != STATUS_OK || !(low_reach_m > 0)) return status;
    const Status low = low_plants_open(out, low_reach_m, pool, arena);
    if (low != STATUS_OK) far_pages_close(out);
    return low;
}

void forest_frame_close(ForestFrame *frame)
{
    low_plants_close(frame);
    far_pages_close(frame);
    if (frame->forest) forest_kept_after_frame(frame->forest);
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

int forest_level(const ForestFrame *frame, const Plant *plant, const double foot_enu[3])
{
    const ForestConfig *c = &frame->forest->config;
    double              to_eye[3];
    if (c->all_fine || (plant->kind < PLANT_STANDING && frame->forest->table[plant->kind]))
        return forest_finest(frame->forest);
    if (!(c->level1_px > 0) && !c->fine) return plant_whole;
    v3_sub(to_eye, foot_enu, frame->eye_enu);
    const double distance_m = v3_length(to_eye), high = plant_height_m(plant) * frame->per_rad;
    if (high < c->level1_px * distance_m) return plant_simple;
    const double fine_px = forest_fine_px[0] + (forest_fine_px[1] - forest_fine_px[0]) * plant_rank(plant);
    return c->fine && high >= fine_px * distance_m ? plant_fine : plant_whole;
}
