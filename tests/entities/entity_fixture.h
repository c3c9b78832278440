/* tests/entities/entity_fixture.h: a catalog and a table out of etc/, and PDUs to feed them. */
#ifndef TESTS_ENTITIES_ENTITY_FIXTURE_H
#define TESTS_ENTITIES_ENTITY_FIXTURE_H

#include "tests/check.h"
#include "entities/motion/dead_reckoning.h"
#include "entities/table/entity_table.h"

typedef struct Fixture {
    Catalog     *catalog;
    EntityTable *table;
    Arena       *arena;
    DisCounters  counters;
    Snapshot     snapshot;
} Fixture;

static const DisEntityType tank_type = {1, 1, 222, 1, 1, 1, 0}, truck_type = {1, 1, 222, 7, 1, 0, 0};
static const DisEntityType helicopter_type = {1, 2, 225, 20, 1, 0, 0}, missile_type = {2, 2, 225, 1, 1, 3, 0};
static const uint32_t      frozen_bit = UINT32_C(1) << 21, power_plant_bit = UINT32_C(1) << 22;
static const uint32_t      destroyed_bits = UINT32_C(3) << 3;
static const uint32_t      deactivated_bit = UINT32_C(1) << 23;

/* On the equator at Greenwich, level, heading north: x forward = +Z, y right = +Y (east), z down = -X. */
static const double earth_radius_m = 6378137;

static inline Fixture fixture_open(const EntityTableConfig *config)
{
    Fixture                 f = {0};
    const EntityTableConfig defaults = entity_table_default_config();
    char                    path[512];

    CHECK(etc_path(path, sizeof path, "catalog.csv"));
    CHECK(catalog_open(&f.catalog, path, 0.01) == STATUS_OK);
    CHECK(entity_table_create(&f.table, config ? config : &defaults, f.catalog) == STATUS_OK);
    f.arena = arena_create();
    CHECK(f.arena != NULL);
    return f;
}

static inline void fixture_close(Fixture *f)
{
    entity_table_destroy(f->table);
    catalog_close(f->catalog);
    arena_destroy(f->arena);
}

static inline DisEntityId entity_id(int entity) { return (DisEntityId){1, 3001, (uint16_t)entity}; }

static inline DisEntityState report(int entity, DisEntityType type)
{
    return (DisEntityState){.header = {.version = 5, .exercise = 1, .type = dis_pdu_entity_state, .family = 1},
                            .id = entity_id(entity),
                            .type = type,
                            .dead_reckoning = 4,
                            .p_ecef = {earth_radius_m, 0, 0},
                            .psi_rad = 0,
                            .theta_rad = -(float)(3.14159265358979323846 / 2)};
}

static inline const SnapshotEntity *seen_at(Fixture *f, int entity, double t_s)
{
    arena_reset(f->arena);
    CHECK(entity_table_snapshot(&f->snapshot, f->table, t_s, f->arena) == STATUS_OK);
    CHECK(f->snapshot.t_s == t_s);
    const int at = snapshot_find(&f->snapshot, entity_id(entity));
    return at < 0 ? NULL : f->snapshot.entity + at;
}

/* One node of an entity of the snapshot. */
static inline NodePose node_of(const Fixture *f, const SnapshotEntity *e, int node)
{
    enum { most_nodes = 64 };
    const Model *model = catalog_model(f->catalog, e->model);
    NodePose     pose[most_nodes];
    double       joint_value[most_nodes];
    CHECK(node < model->node_count && model->node_count <= most_nodes);
    snapshot_pose(pose, joint_value, &f->snapshot, (int)(e - f->snapshot.entity), model);
    return pose[node];
}

static inline void hear(Fixture *f, const DisEntityState *pdu, double t_s)
{
    CHECK(entity_table_entity_state(f->table, pdu, t_s) == STATUS_OK);
}

static inline DisVariableParameter articulated(uint32_t parameter, float value)
{
    return (DisVariableParameter){.record_type = dis_variable_articulated, .parameter = parameter, .value = value};
}

/* The frame of the equator at Greenwich: east is ECEF y, north z, up x. */
static inline LocalFrame frame_here(void)
{
    LocalFrame     frame;
    const Geodetic origin = {0, 0, 0};
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    return frame;
}

#endif
