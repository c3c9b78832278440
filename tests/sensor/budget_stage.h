/* tests/sensor/budget_stage.h: a frame made by hand, whose error budget is judged: planes, targets and the renderer's
 * estimates are what a test writes into it. */
#ifndef TESTS_SENSOR_BUDGET_STAGE_H
#define TESTS_SENSOR_BUDGET_STAGE_H

#include "tests/check.h"

#include "sensor/truth/frame_error.h"

enum { width = 40, height = 30, pixels = width * height, planes = picture_plane_count, entities = 2 };

static struct {
    Catalog       *catalog;
    World          world;
    Landscape      landscape;
    SnapshotEntity entity[entities];
    Snapshot       snapshot;
    RenderRequest  request;
    ErrorBudget    budget;
    Picture        picture;
    TargetPixels   px[entities];
    Target         target[entities];
    double         radius_m; /* of both entities' model */
    double         air_k, sag_m;
    bool           clamped;
    float          plane[planes][pixels], temp_k[pixels], covered[pixels];
    uint32_t       id[pixels];
} lab;

static inline int lab_open(void **state)
{
    (void)state;
    char           path[text_file_size];
    const Geodetic origin = {36 * rad_per_deg, -120 * rad_per_deg, 50};
    text_file(path, "type,model,origin\n*.*.*.*.*.*.*,marker,base\n");
    const Status status = catalog_open(&lab.catalog, path, 0.01);
    remove(path);
    lab.world.catalog = lab.catalog;
    return status == STATUS_OK && local_frame_at(&lab.world.frame, &origin) == STATUS_OK &&
                   planck_table_create(&lab.world.planck_mwir, 3.4e-6, 4.8e-6) == STATUS_OK &&
                   planck_table_create(&lab.world.planck_lwir, 8e-6, 12e-6) == STATUS_OK
               ? 0
               : -1;
}

static inline int lab_close(void **state)
{
    (void)state;
    planck_table_destroy(lab.world.planck_mwir);
    planck_table_destroy(lab.world.planck_lwir);
    catalog_close(lab.catalog);
    return 0;
}

static const double focal_px = 500, range_m = 250; /* half a metre a pixel */

/* A frame without planes, targets and errors. */
static inline void fresh(void)
{
    memset(lab.entity, 0, sizeof lab.entity);
    memset(&lab.budget, 0, sizeof lab.budget);
    memset(lab.px, 0, sizeof lab.px);
    memset(lab.id, 0, sizeof lab.id);
    memset(lab.covered, 0, sizeof lab.covered);
    lab.world.landscape = NULL;
    lab.snapshot = (Snapshot){.count = entities, .entity = lab.entity};
    lab.request = (RenderRequest){.view = {.width = width, .height = height, .focal_px = focal_px}};
    lab.picture =
        (Picture){.width = width, .height = height, .entity = lab.id, .target = lab.px, .budget = &lab.budget};
    lab.sag_m = 0, lab.air_k = NAN, lab.clamped = false;
    for (int i = 0; i < entities; i++) {
        lab.entity[i].model = catalog_find(lab.catalog, lab.entity[i].type, &(Origin){ORIGIN_BASE}, NULL);
        lab.entity[i].first_patch = -1;
        lab.target[i] = (Target){.index = i, .range_m = range_m, .error_px = NAN};
        for (int b = 0; b < BAND_COUNT; b++)
            lab.target[i].band[b].error_rms_k = lab.target[i].band[b].error_median_k = NAN;
    }
    lab.radius_m = catalog_model(lab.catalog, lab.entity[0].model)->radius_m;
}

static inline FrameError judged(int targets)
{
    struct {
        FrameError error;
        double     behind[BAND_COUNT]; /* not the frame's */
    } out = {.behind = {1, 2, 3, 4}};
    const FrameErrorOf of = {&lab.picture, &lab.world, &lab.snapshot, &lab.request, lab.sag_m, lab.clamped, lab.air_k};
    CHECK(frame_error(&out.error, &of, lab.target, targets));
    for (int b = 0; b < BAND_COUNT; b++) CHECK(out.behind[b] == b + 1);
    return out.error;
}

/* W/(m2 sr) of a kelvin about a temperature, in LWIR. */
static inline double lwir_slope(double temp_k)
{
    double slope;
    planck_band(8e-6, 12e-6, temp_k, &slope);
    return slope;
}

static inline double lwir_at(double temp_k) { return planck_band(8e-6, 12e-6, temp_k, NULL); }

#endif
