/* tests/sensor/radar_scene.h: models of a test's own in an empty world without air or ground, and a radar that looks at
 * them along the level, from the east. */
#ifndef TESTS_SENSOR_RADAR_SCENE_H
#define TESTS_SENSOR_RADAR_SCENE_H

#include "tests/check.h"

#include "sensor/radar/seeker_radar.h"

#include <stdlib.h>
#include <unistd.h>

enum { scene_models = 4 };
static const double scene_range_m = 1000;

typedef struct RadarStage {
    char           folder[64], catalog_path[128];
    Catalog       *catalog;
    World          world;
    Pool          *pool;
    Arena         *arena;
    View           view;
    int            models;
    SnapshotEntity entity[8];
    SnapshotJoints joints[8];
    Snapshot       snapshot;
    RadarScene     scene;
    Weather        weather;
} RadarStage;

static RadarStage stage;

/* A file in the stage's folder. */
static inline FILE *scene_file(const char *name)
{
    char path[160];
    snprintf(path, sizeof path, "%s/%s", stage.folder, name);
    FILE *file = fopen(path, "w");
    CHECK(file);
    return file;
}

static inline void scene_folder(void)
{
    strcpy(stage.folder, "/tmp/pitviper_radar_XXXXXX");
    CHECK(mkdtemp(stage.folder));
}

/* NAME.obj, whose y is up and z right, and its sidecar. */
static inline FILE *scene_obj(const char *name, const char *sidecar)
{
    char  file_name[64];
    FILE *file;
    snprintf(file_name, sizeof file_name, "%s.yaml", name);
    file = scene_file(file_name);
    fprintf(file, "axes: +x +y\norigin: 0 0 0\nmaterials: {\"*\": metal_steel_galvanized}\n%s", sidecar ? sidecar : "");
    CHECK(fclose(file) == 0);
    snprintf(file_name, sizeof file_name, "%s.obj", name);
    return scene_file(file_name);
}

/* A sphere of radius a about (x, y, z), body axes but z up; n facets from pole to pole. first: number of the first
 * vertex. */
static inline int scene_sphere_of(FILE *file, int first, double a, double x, double y, double up, int n)
{
    const int m = 2 * n;
    fprintf(file, "o sphere%d\n", first);
    for (int i = 0; i <= n; i++)
        for (int j = 0; j < m; j++) {
            const double t = pi_rad * i / n, p = 2 * pi_rad * j / m, d[3] = {sin(t) * cos(p), sin(t) * sin(p), cos(t)};
            fprintf(file, "v %.9f %.9f %.9f\nvn %.9f %.9f %.9f\n", x + a * d[0], up + a * d[2], y + a * d[1], d[0],
                    d[2], d[1]);
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++) {
            const int a1 = first + i * m + j, b1 = first + i * m + (j + 1) % m, a2 = a1 + m, b2 = b1 + m;
            if (i > 0) fprintf(file, "f %d//%d %d//%d %d//%d\n", a1, a1, b2, b2, b1, b1);
            if (i < n - 1) fprintf(file, "f %d//%d %d//%d %d//%d\n", a1, a1, a2, a2, b2, b2);
        }
    return first + (n + 1) * m;
}

/* One whose facets are of 1.4 degrees. */
static inline int scene_sphere(FILE *file, int first, double a, double x, double y, double up)
{
    return scene_sphere_of(file, first, a, x, y, up, 128);
}

/* A box, body axes but z up. */
static inline int scene_box(FILE *file, const char *name, int first, const double low[3], const double high[3])
{
    static const int face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    fprintf(file, "o %s\n", name);
    for (int i = 0; i < 8; i++)
        fprintf(file, "v %.9f %.9f %.9f\n", i & 1 ? high[0] : low[0], i & 4 ? high[2] : low[2],
                i & 2 ? high[1] : low[1]);
    for (int f = 0; f < 6; f++)
        fprintf(file, "f %d %d %d %d\n", first + face[f][0], first + face[f][3], first + face[f][2],
                first + face[f][1]);
    return first + 8;
}

/* Of these models, in order; an entity's type is 1.1.225.83.7.K for model K, from 0. */
static inline void scene_open(const char *const *model, int models)
{
    LocalFrame     frame;
    const Geodetic origin = {0.6, -1.9, 700};
    FILE          *file = scene_file("catalog.csv");
    fputs("type,model,origin\n", file);
    for (int i = 0; i < models; i++) fprintf(file, "1.1.225.83.7.%d,%s.obj,base\n", i, model[i]);
    CHECK(fclose(file) == 0);
    stage.models = models;
    snprintf(stage.catalog_path, sizeof stage.catalog_path, "%s/catalog.csv", stage.folder);
    CHECK(catalog_open(&stage.catalog, stage.catalog_path, 0.01) == STATUS_OK);
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    CHECK(world_open(&stage.world, stage.catalog, NULL, &frame, "avx2") == STATUS_OK);
    CHECK(pool_create(&stage.pool, 2) == STATUS_OK);
    stage.arena = arena_create();
    stage.weather = weather_default();
    /* at (range, 0, 0), to the west */
    stage.view = (View){.p_enu = {scene_range_m, 0, 0},
                        .width = 64,
                        .height = 64,
                        .focal_px = 1000,
                        .r_enu_from_cam = {0, 0, -1, 1, 0, 0, 0, -1, 0}};
    stage.snapshot = (Snapshot){.entity = stage.entity, .joints = stage.joints};
    stage.scene = (RadarScene){.world = &stage.world,
                               .snapshot = &stage.snapshot,
                               .view = &stage.view,
                               .hidden = -1,
                               .reference_m = scene_range_m,
                               .weather = &stage.weather,
                               .number = 1};
}

static inline void scene_close(void)
{
    char command[128];
    pool_destroy(stage.pool);
    arena_destroy(stage.arena);
    world_close(&stage.world);
    catalog_close(stage.catalog);
    snprintf(command, sizeof command, "rm -rf '%s'", stage.folder);
    CHECK(system(command) == 0);
}

/* An entity of that model, whose nose points to the radar. */
static inline SnapshotEntity *scene_add(int model, double east_m, double north_m, double up_m)
{
    static const double r_enu_from_body[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    const int           k = stage.snapshot.count++;
    SnapshotEntity     *e = &stage.entity[k];
    const double        p_enu[3] = {east_m, north_m, up_m};
    Origin              origin;
    *e = (SnapshotEntity){
        .id = {1, 1, (uint16_t)(k + 1)},
        .type = {.kind = 1, .domain = 1, .country = 225, .category = 83, .subcategory = 7, .specific = (uint8_t)model}};
    e->model = catalog_find(stage.catalog, e->type, &origin, NULL);
    ecef_from_enu(e->p_ecef, &stage.world.frame, p_enu);
    m3_mul(e->r_ecef_from_body, stage.world.frame.r_ecef_from_enu, r_enu_from_body);
    return e;
}

static inline SeekerRadar *scene_radar(const char *preset, const char *given)
{
    SeekerRadar *radar;
    CHECK(seeker_radar_create(&radar, &(SeekerRadarConfig){.preset = preset,
                                                           .catalog = stage.catalog_path,
                                                           .isa = "avx2",
                                                           .given = given,
                                                           .seed = 1}) == STATUS_OK);
    return radar;
}

static inline const RadarFrame *scene_measure(SeekerRadar *radar)
{
    const RadarFrame *frame;
    CHECK(seeker_radar_measure(&frame, radar, &stage.scene, stage.pool, stage.arena) == STATUS_OK);
    return frame;
}

#endif
