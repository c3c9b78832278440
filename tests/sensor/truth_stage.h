/* tests/sensor/truth_stage.h: an eye and a target, both moving, and a picture of them to paint on. */
#ifndef TESTS_SENSOR_TRUTH_STAGE_H
#define TESTS_SENSOR_TRUTH_STAGE_H

#include "tests/check.h"

#include "sensor/truth/truth.h"

enum { width = 60, height = 40 };

typedef struct Fixture {
    Catalog       *catalog;
    World          world;
    Snapshot       snapshot;
    SnapshotEntity entity[2];
    RenderRequest  request;
    EyeState       eye;
    Picture        picture;
    TargetPixels   pixels[2];
    uint32_t       id[width * height];
    float          lwir[width * height];
} Fixture;

static Fixture f;

static inline int open_fixture(void **state)
{
    (void)state;
    char path[text_file_size];
    text_file(path, "type,model,origin\n*.*.*.*.*.*.*,marker,base\n");
    const Status status = catalog_open(&f.catalog, path, 0.01);
    remove(path);
    f.world.catalog = f.catalog;
    return status == STATUS_OK && planck_table_create(&f.world.planck_lwir, 8e-6, 12e-6) == STATUS_OK &&
                   planck_table_create(&f.world.planck_mwir, 3.4e-6, 4.8e-6) == STATUS_OK
               ? 0
               : -1;
}

static inline int close_fixture(void **state)
{
    (void)state;
    planck_table_destroy(f.world.planck_lwir);
    planck_table_destroy(f.world.planck_mwir);
    catalog_close(f.catalog);
    return 0;
}

/* A place on the Earth with its axes: forward north, right east, down. */
static inline void pose(SnapshotEntity *e, double lat_deg, double lon_deg, double h_m)
{
    const Geodetic place = {lat_deg * rad_per_deg, lon_deg * rad_per_deg, h_m};
    double         r[9];
    CHECK(ecef_from_geodetic(e->p_ecef, r, &place) == STATUS_OK);
    for (int i = 0; i < 3; i++) {
        e->r_ecef_from_body[3 * i] = r[3 * i + 1];
        e->r_ecef_from_body[3 * i + 1] = r[3 * i];
        e->r_ecef_from_body[3 * i + 2] = -r[3 * i + 2];
    }
}

/* Eye at entity 0 looking at entity 1; both moving. */
static inline void scene(void)
{
    memset(f.entity, 0, sizeof f.entity);
    f.entity[1].model = catalog_find(f.catalog, f.entity[1].type, &(Origin){ORIGIN_BASE}, NULL);
    pose(&f.entity[0], 36, -123, 500);
    pose(&f.entity[1], 36.01, -122.99, 20);
    static const double v0[3] = {120, -200, 80}, v1[3] = {-5, 7, 3};
    memcpy(f.entity[0].v_ecef_mps, v0, sizeof v0);
    memcpy(f.entity[1].v_ecef_mps, v1, sizeof v1);
    static const double turn_rps[3] = {0.8, -0.5, 0.3};
    memcpy(f.entity[1].w_body_rps, turn_rps, sizeof turn_rps);
    f.snapshot = (Snapshot){.count = 2, .entity = f.entity};
    memcpy(f.eye.p_ecef, f.entity[0].p_ecef, sizeof f.eye.p_ecef);
    memcpy(f.eye.v_ecef_mps, v0, sizeof v0);
    f.eye.host_index = 0;

    /* camera: ahead towards a point somewhat beside the target, upright by the local down */
    double ahead[3], right[3], down[3], down_0[3];
    for (int k = 0; k < 3; k++) {
        ahead[k] = f.entity[1].p_ecef[k] + (k == 0 ? 30 : k == 1 ? -10 : 5) - f.eye.p_ecef[k];
        down_0[k] = f.entity[0].r_ecef_from_body[3 * k + 2];
    }
    v3_normalize(ahead, ahead);
    v3_cross(right, down_0, ahead);
    v3_normalize(right, right);
    v3_cross(down, ahead, right);
    for (int k = 0; k < 3; k++) {
        f.eye.r_ecef_from_cam[3 * k] = right[k];
        f.eye.r_ecef_from_cam[3 * k + 1] = down[k];
        f.eye.r_ecef_from_cam[3 * k + 2] = ahead[k];
    }
    f.request = (RenderRequest){.view = {.width = width, .height = height, .focal_px = 500}, .bands = 1 << BAND_LWIR};
    f.picture = (Picture){.width = width, .height = height, .entity = f.id, .lwir = f.lwir, .target = f.pixels};
    memset(f.pixels, 0, sizeof f.pixels);
    memset(f.id, 0, sizeof f.id);
}

static const TruthNoise noise = {.optical_w_m2_sr = 0.01, .netd_mwir_k = 0.03, .netd_lwir_k = 0.05};

#endif
