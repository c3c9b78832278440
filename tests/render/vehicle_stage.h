/* tests/render/vehicle_stage.h: what the heat of an entity stands on, and one entity. */
#ifndef TESTS_RENDER_VEHICLE_STAGE_H
#define TESTS_RENDER_VEHICLE_STAGE_H

#include "tests/check.h"

#include "render/heat/vehicle_heat.h"
#include "render/trace/parts/parts.h"

typedef struct Stage {
    Catalog   *catalog;
    Materials  materials;
    PartTable  table;
    Tracer    *tracer;
    PatchSet   patches;
    LocalFrame frame;
    Arena     *arena;
} Stage;
static Stage stage;

static inline int open_stage(void **state)
{
    (void)state;
    char path[512], materials[512], surfaces[512], machines[512];
    CHECK(etc_path(path, sizeof path, "catalog.csv") && catalog_open(&stage.catalog, path, 0.01) == STATUS_OK);
    CHECK(etc_path(materials, sizeof materials, "materials.csv") &&
          etc_path(surfaces, sizeof surfaces, "surfaces.csv"));
    CHECK(materials_open(&stage.materials, materials, surfaces, stage.catalog) == STATUS_OK);
    CHECK(etc_path(path, sizeof path, "heat.csv") && etc_path(machines, sizeof machines, "heat_machines.csv"));
    CHECK(part_table_open(&stage.table, path, machines) == STATUS_OK);
    CHECK(tracer_create(&stage.tracer, stage.catalog, "avx2") == STATUS_OK);
    CHECK(heat_patches_create(&stage.patches, catalog_model_count(stage.catalog)) == STATUS_OK);
    CHECK(local_frame_at(&stage.frame, &(Geodetic){0.7, 0.2, 0}) == STATUS_OK);
    return (stage.arena = arena_create()) == NULL;
}

static inline int close_stage(void **state)
{
    (void)state;
    arena_destroy(stage.arena);
    heat_patches_destroy(&stage.patches);
    tracer_destroy(stage.tracer);
    materials_close(&stage.materials);
    catalog_close(stage.catalog);
    return 0;
}

/* about: first step and, where it is 0, capacity are filled in. kept: may be NULL. */
static inline VehicleHeat *stage_start(const VehicleHeatConfig *about, const KeptHeat *kept)
{
    VehicleHeat           *heat;
    VehicleHeatConfig      config = *about;
    const VehicleHeatWorld world = {stage.catalog, &stage.materials, &stage.table, &stage.frame,
                                    stage.tracer,  &stage.patches,   NULL,         kept};
    config.first_step_s = 1;
    if (config.capacity == 0) config.capacity = 8;
    CHECK(vehicle_heat_create(&heat, &config, &world) == STATUS_OK);
    return heat;
}

/* One entity: where it stands, facing north; its drives. */
typedef struct Scene {
    Snapshot       snapshot;
    SnapshotEntity entity;
    SnapshotJoints joints;
} Scene;

static inline void place(Scene *s, DisEntityType type, EntityDrives drives)
{
    const double p_enu[3] = {0, 0, 0}, r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    memset(s, 0, sizeof *s);
    s->entity = (SnapshotEntity){.id = {1, 1, 1},
                                 .type = type,
                                 .model = catalog_find(stage.catalog, type, NULL, NULL),
                                 .drives = drives,
                                 .first_patch = -1};
    ecef_from_enu(s->entity.p_ecef, &stage.frame, p_enu);
    m3_mul(s->entity.r_ecef_from_body, stage.frame.r_ecef_from_enu, r_enu_from_body);
    s->snapshot = (Snapshot){.count = 1, .entity = &s->entity, .joints = &s->joints};
}

#endif
