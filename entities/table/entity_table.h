/* entities/table/entity_table.h: the entity table: one slot per entity, handles with a generation, the last report of
 * each, and state from its history (heat, distance travelled, smoke trails, ground marks).
 *
 * Takes PDUs in the order of exercise time; gives a Snapshot at any t at or after the last of them. */
#ifndef ENTITIES_TABLE_ENTITY_TABLE_H
#define ENTITIES_TABLE_ENTITY_TABLE_H

#include "dis/pdu/decode.h"
#include "entities/catalog/catalog.h"
#include "entities/table/contact.h"
#include "entities/traces/effect_history.h"
#include "entities/table/snapshot.h"

typedef struct EntityTable EntityTable;

/* Stale handles are caught: entity_table_alive returns false. {0} is never valid. */
typedef struct EntityHandle {
    uint32_t slot, generation;
} EntityHandle;

typedef struct EntityTableConfig {
    int    capacity;              /* most entities at once; beyond it entities are evicted by entity_limits_private.h */
    int    shown;                 /* most entities in a snapshot: those with reported positions nearest the focus */
    double timeout_s;             /* time-out of versions 5 and 6: 12 */
    double timeout_land_v7_s;     /* time-out of version 7 for entities with the long heartbeat (land, sea, life forms,
                                     standing): 132 */
    double extrapolation_limit_s; /* longest dead reckoning, after which the entity is held: 12. Entities with the long
                                     timeout get a limit longer in proportion, since their heartbeat is longer too */
    double rate_limit_rps;        /* larger angular rates are not extrapolated: 20 */
    double new_per_s;             /* entities a sender may add per second, and at once; 65536: as many as it has ids */
    double stood_s; /* time for which what stands at its first report has stood: 3600; NAN: drawn for each, of seed and
                       id, from stood_least_s to stood_most_s, as often of each order of magnitude */
    uint64_t seed;
    Pool *pool; /* pool that helps with snapshots; NULL: the caller works alone. The result has the same bits either way
                 */
    ContactGround ground; /* ground that entities are clamped to in every pose; none: they are not clamped */
} EntityTableConfig;

/* How many entities came and went, why, and what was refused. */
typedef struct EntityCounters {
    uint64_t created, timed_out, deactivated, removed, updates_without_entity, unknown_articulation;
    uint64_t detonated; /* munitions ended by their Detonation */
    uint64_t late; /* reports older than the entity's latest report or its end, or of a munition after its Detonation */
    uint64_t motion_refused; /* reports with a velocity, acceleration or angular rate that is not finite or not
                              * possible (2e4 m/s, 1e4 m/s2, rate_limit_rps): that one vector is taken as zero */
    uint64_t evicted;        /* entities evicted for others when the table was full */
    uint64_t refused;        /* new entities that a full table refused, since they would have been evicted at once */
    uint64_t over_rate; /* reports of new entities that were refused because their sender had added new_per_s already */
    uint64_t tombstones_dropped; /* tombstones dropped for lack of space while a late report was still possible */
    uint64_t marks_forgotten; /* ground marks forgotten, the oldest ones, because there were more than the capacity */
} EntityCounters;

EntityTableConfig entity_table_default_config(void);
/* The catalog must outlive the table. Reads etc/effects.csv. */
Status entity_table_create(EntityTable **out, const EntityTableConfig *config, const Catalog *catalog);
void   entity_table_destroy(EntityTable *table);

/* What a full table keeps: the host, `also` (its aim), and entities with last reports near the host's last report.
 * 0:0:0: none. Without a host, or after its end: the previous position. A snapshot of more than config.shown takes the
 * nearest to that position. Extrapolated positions are not used, so the result does not depend on snapshot times. */
void entity_table_focus(EntityTable *table, DisEntityId host, DisEntityId also);
/* Sets the sender that has most entities here; returns how many. O(senders). */
int entity_table_largest_sender(DisEntityId *sender, const EntityTable *table);

/* A report that deactivates (appearance bit 23) removes. A frozen entity (bit 21) is stationary, and so is one named by
 * Stop/Freeze (0xFFFF: any; entity 0: a whole application) until Start/Resume or its own next report.
 *
 * One decoded PDU, usable (dis_entity_is_usable) and at exercise time t_s. STATUS_NO_MEMORY or
 * STATUS_UNSUPPORTED (refused: the table is full of entities of higher rank) leave the table unchanged. */
Status entity_table_entity_state(EntityTable *table, const DisEntityState *pdu, double t_s);
Status entity_table_entity_state_update(EntityTable *table, const DisEntityStateUpdate *pdu, double t_s);
void   entity_table_fire(EntityTable *table, const DisFire *pdu, double t_s);
void   entity_table_detonation(EntityTable *table, const DisDetonation *pdu, double t_s);
void   entity_table_remove(EntityTable *table, const DisRemoveEntity *pdu, double t_s);
void   entity_table_start(EntityTable *table, const DisStartResume *pdu, double t_s);
void   entity_table_stop(EntityTable *table, const DisStopFreeze *pdu, double t_s);
/* Removes the entities that have been silent for too long at t_s. */
void entity_table_expire(EntityTable *table, double t_s);

/* For PDUs in order of arrival: the next one arrived at now_s, and t_s is by its sender's stamps. The sender's clock
 * may then have been set since an entity's last report: the pose does not jump for that, but comes round within
 * seconds, at most half as fast again or half as slow. Not called: poses are those of t_s. */
void entity_table_arrival(EntityTable *table, double now_s, bool by_stamp);
/* Any decoded PDU: checked, and passed to the function above of its type; types that the table does not need are
 * ignored, and an instant that is not finite. Every drop is counted. This is what replay and the node call. */
void entity_table_pdu(EntityTable *table, const DisPdu *pdu, double t_s, DisCounters *counters);

int                   entity_table_count(const EntityTable *table);
EntityHandle          entity_table_find(const EntityTable *table, DisEntityId id);
bool                  entity_table_alive(const EntityTable *table, EntityHandle handle);
bool                  entity_table_type(DisEntityType *out, const EntityTable *table,
                                        EntityHandle handle); /* false: the entity is not there */
const EntityCounters *entity_table_counters(const EntityTable *table);
const EffectCounters *entity_table_effect_counters(const EntityTable *table);
/* Counts what changes the heat of an entity at once: it appeared, fired or was fired, was destroyed. */
uint64_t entity_table_changes(const EntityTable *table);

/* One entity's pose and motion at t_s, the same as in a snapshot; no parts, no heat. False when it is not there. */
bool entity_table_pose(SnapshotEntity *out, const EntityTable *table, EntityHandle handle, double t_s);
/* As entity_table_pose, with the poses of its nodes. node, joint_value: arrays of the model's node_count; the second is
 * scratch. */
bool entity_table_pose_nodes(SnapshotEntity *out, NodePose *node, double *joint_value, const EntityTable *table,
                             EntityHandle handle, double t_s);
/* Ground marks over a restart: ground_marks_save, ground_marks_load; the latter before the first PDU. unix_s: Unix time
 * of exercise time 0. */
Status entity_table_marks_save(const EntityTable *table, double unix_s, const char *path);
Status entity_table_marks_load(EntityTable *table, double unix_s, const char *path);
/* All entities at t_s, sorted by id, in the arena. */
Status entity_table_snapshot(Snapshot *out, const EntityTable *table, double t_s, Arena *arena);

#endif
