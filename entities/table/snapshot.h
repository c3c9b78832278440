/* entities/table/snapshot.h: all entities at one instant, immutable and dense. The renderer's only view of entities; it
 * uses neither PDUs nor the table. */
#ifndef ENTITIES_TABLE_SNAPSHOT_H
#define ENTITIES_TABLE_SNAPSHOT_H

#include "dis/pdu.h"
#include "entities/effects/drives.h"
#include "entities/effects/effects.h"
#include "entities/effects/exhaust_jet.h"
#include "entities/marks/ground_marks.h"
#include "entities/models/articulation.h"

typedef struct SnapshotEntity {
    DisEntityId   id;
    DisEntityType type;
    uint8_t       force;
    char          marking[12];     /* terminated, raw bytes */
    uint32_t      appearance;
    int           model;           /* of the catalog */
    double        p_ecef[3];       /* of the model's origin (base centre), independent of the sender's origin */
    double        v_ecef_mps[3];
    double        w_body_rps[3];   /* of the rendered attitude: 0 where the algorithm holds it, and when frozen */
    double        r_ecef_from_body[9];
    double        age_s;           /* since the report it was extrapolated from */
    double        position_error_m;/* estimate: snapshot_position_error_m */
    double        drift_m, drift_rad; /* expected distance and angle from the truth: snapshot_drift */
    int           first_node;      /* into Snapshot.node */
    EntityDrives  drives;          /* what heats it */
    const ExhaustJet *exhaust;     /* of its model; NULL: no outlet is known */
    int           first_patch, patches; /* into Snapshot.patch_k; -1, 0: none of its temperatures are known */
    float         dt_k;            /* mean temperature of its surface less that of open ground where it is; with patches */
} SnapshotEntity;

/* Joint state of an entity, kept for its nodes: snapshot_pose. */
typedef struct SnapshotJoints {
    double     report_s, hold_s; /* of the joints' report; longest time a rate is followed */
    double     time_s;           /* the entity's own, of the snapshot */
    JointDrive drive;
    int        first, count;     /* into Snapshot.joint_report */
} SnapshotJoints;

/* A cloud of chaff: radar alone sees it (sensor/radar/radar_chaff.c). */
typedef struct SnapshotChaff {
    DisEntityId   id;
    double        p_ecef[3], v_ecef_mps[3]; /* of its middle, as reported and extrapolated */
    double        age_s;                    /* since its first report */
} SnapshotChaff;

typedef struct Snapshot {
    double          t_s;
    int             count, node_count;
    SnapshotEntity *entity; /* sorted by id */
    NodePose       *node;   /* of entity k: entity[k].first_node .. + model's node_count - 1. NULL: snapshot_pose */
    SnapshotJoints *joints; /* [count]; NULL where node is not */
    JointReport    *joint_report;
    int             puff_count;
    EffectPuff     *puff;   /* what burns, smokes and bursts */
    int64_t         puffs_left_out; /* the oldest, beyond effect_puff_capacity */
    int             chaff_count;
    SnapshotChaff  *chaff;          /* sorted by id; none of them is an entity */
    int             left_out;       /* entities beyond the table's config.shown: the farthest */
    const EffectTable *effect_table; /* NULL where there are no puffs */
    GroundMarks     marks;  /* what was left on the ground until t_s */
    int             patch_count;
    float          *patch_k; /* temperatures of the patches (entities/models/patches.h) of entities, K; filled in by
                              * render/heat/vehicle_heat.h. NULL: parts are as warm as the air */
} Snapshot;

/* A munition or an expendable: it did nothing before it appeared. */
bool snapshot_is_short_lived(const SnapshotEntity *entity);
/* Whether a puff came out of this entity: its own trail, flames or plume. */
bool snapshot_owns_puff(const Snapshot *snapshot, int index, const EffectPuff *puff);
/* Reported damage of a platform: 0 none, 1 slight, 2 moderate, 3 destroyed; others: 0. */
int  snapshot_damage(const SnapshotEntity *entity);
/* A platform that its sender calls destroyed. */
bool snapshot_is_wreck(const SnapshotEntity *entity);

/* How far from the truth an extrapolated position may be: nothing at its report, growing evenly to the standard's
 * threshold of 1 m at the sender's heartbeat, and from there as an unreported acceleration of 1 m/s2 would carry
 * it. Beyond hold_s the entity is held while it moves on at speed_mps. An estimate for error budgets, not a bound:
 * a sender's own threshold may differ, and a missile's motor start misses by 12 m. */
double snapshot_position_error_m(double age_s, double heartbeat_s, double hold_s, double speed_mps);

/* Expected error of an extrapolation, from the error of the previous one at the next report:
 * missed_m and missed_rad after missed_s; 0: unknown, then `otherwise` for the place and nothing but the standard's 3
 * degrees a heartbeat for the attitude. The position error grows as by an unreported acceleration, that of the attitude
 * as by an unreported rate, up to the previous error: a larger one would have caused a report.
 * tests/sensor/test_frame_error.c. */
void snapshot_drift(double *drift_m, double *drift_rad, double age_s, double missed_m, double missed_rad, double missed_s,
                    double otherwise_m, double heartbeat_s);

/* Nodes of entity `index`, with this model, into pose[model->node_count]; joint_value: same size. Most entities are
 * never rendered: a snapshot keeps the joint state, and the renderer poses only what it draws. */
void snapshot_pose(NodePose *pose, double *joint_value, const Snapshot *snapshot, int index, const Model *model);

/* Index of an id, or -1. */
int snapshot_find(const Snapshot *snapshot, DisEntityId id);

#endif
