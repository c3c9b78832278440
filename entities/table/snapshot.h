/* entities/table/snapshot.h: all entities at one instant, immutable and dense. The renderer's only view of entities; it
 * uses neither PDUs nor the table. */
#ifndef ENTITIES_TABLE_SNAPSHOT_H
#define ENTITIES_TABLE_SNAPSHOT_H

#include "dis/pdu/pdu.h"
#include "entities/traces/effect_puffs.h"
#include "entities/traces/ground_marks.h"
#include "entities/motion/articulation.h"

/* ---- drives: drives.c ------------------------------------------------------------------------- */

/* What an entity does that heats it: its engine, its motion, its shots, flames.
 *
 * Evidence is the appearance word *and* the observed motion: VR-Forces flies helicopters and drives tanks without
 * ever setting the power-plant bit. Engine smoke says that the engine runs, as of a vehicle that makes its own
 * screen. A plume of smoke from one that is damaged says that it smoulders; from one that is not, a screen, it warms
 * nothing. Flames need no smoke. Between reports every drive is constant or ends at a known time, so drives at a
 * time are a function of the reports and of that time. What they do to temperatures: render/heat/vehicle_heat.h. */

/* What heats an entity at one instant. */
typedef struct EntityDrives {
    double since_s;  /* exercise time of its first report */
    float  engine;   /* share of full power: 0.6 idling; 1 at 10 m/s on level ground, or at a lower speed uphill and in
                        turns; always 1 of air platforms; 0 stopped */
    float speed_mps; /* speed as reported; 0 when frozen */
    float flying;    /* 1: an air platform that is not destroyed */
    float alive;     /* 1: a life form that is alive, or a building that is not destroyed */
    float burning;   /* 1: it is in flames, or was destroyed during the exercise in the last ten minutes; 0.1: it is
                        damaged and smokes */
    float  motor;    /* 1: a munition's motor burns, in its first two seconds */
    float  flare;    /* 1: an expendable's grain burns, in its first four seconds */
    double fired_kg[2]; /* propellant of all its shots: of small guns (less than drives_large_kg a shot), and of large
                           ones */
} EntityDrives;

static const double drives_idle = 0.6;   /* share of full power of an idling engine; estimate */
static const double drives_large_kg = 1; /* propellant a shot; guns with more are large */

typedef struct DriveUntil {
    double value, until_s; /* it has this value until until_s, then 0 */
} DriveUntil;

typedef struct DriveState {
    double     since_s, speed_mps;
    DriveUntil engine, motor, flare, wreck;
    double     moved_s; /* last time it was known to move; -INFINITY: never */
    bool       moving, flying, alive, flaming, smoulders, destroyed;
    double     fired_kg[2];
} DriveState;

/* The state of one report. */
typedef struct DriveEvidence {
    DisEntityType type;
    uint32_t      appearance;
    double        speed_mps; /* speed as reported; 0 when frozen */
    double        climb_mps; /* upwards */
    double        turn_rps;  /* angular rate about its own vertical axis */
} DriveEvidence;

/* Begins with the first report. A wreck without flames does not burn. Munitions and expendables start with their motor
 * or grain burning. */
void drives_begin(DriveState *state, const DriveEvidence *evidence, double t_s);
void drives_report(DriveState *state, const DriveEvidence *evidence, double t_s);
/* Records that the entity fired a charge (effect_charge_kg) `rounds` times, or that it is the munition that was fired.
 * */
void drives_fire(DriveState *state, double charge_kg, int rounds);
void drives_launch(DriveState *state, double t_s);
/* The entity stood still for this long, by a Freeze or its frozen bit: what ends at a known time ends later. */
void drives_pause(DriveState *state, double paused_s);
void drives_at(EntityDrives *out, const DriveState *state, double t_s);

/* Until when engine and rotors turn without a further report: power-plant bit, moving or moved lately, or an air
 * platform; never a destroyed one. -INFINITY: they do not turn; INFINITY: until the next report. */
double drives_run_until(const DriveState *state);
/* The engine's share of full power at t_s, 0 .. 1. */
double drives_engine(const DriveState *state, double t_s);

/* ---- the snapshot ----------------------------------------------------------------------------- */

typedef struct SnapshotEntity {
    DisEntityId   id;
    DisEntityType type;
    uint8_t       force;
    char          marking[12]; /* terminated; bytes as received */
    uint32_t      appearance;
    int           model;     /* number of its model in the catalog */
    double        p_ecef[3]; /* place of the model's origin (base centre), whatever the sender's origin is */
    double        v_ecef_mps[3];
    double w_body_rps[3]; /* angular rate of the attitude shown: 0 where the algorithm holds the attitude, and when
                             frozen */
    double            r_ecef_from_body[9];
    double            age_s;                /* time since the report that it was extrapolated from */
    double            position_error_m;     /* how far p_ecef may be from the truth; estimate */
    double            drift_m, drift_rad;   /* expected distance and angle from the truth: snapshot_drift */
    int               first_node;           /* index of its first node in Snapshot.node */
    EntityDrives      drives;               /* what heats it */
    const ExhaustJet *exhaust;              /* outlet of its model; NULL: none is known */
    int               first_patch, patches; /* its temperatures in Snapshot.patch_k; -1, 0: they are not known */
    float             dt_k; /* with patches: mean temperature of its surface less that of open ground there */
} SnapshotEntity;

/* Joint state of an entity, kept for its nodes: snapshot_pose. */
typedef struct SnapshotJoints {
    double     report_s, hold_s; /* time of the joints' report; longest time that a reported rate is followed */
    double     time_s;           /* the entity's own time at the snapshot */
    JointDrive drive;
    int        first, count; /* its reports in Snapshot.joint_report */
} SnapshotJoints;

/* A cloud of chaff: radar alone sees it (sensor/radar/shot_volume.c). */
typedef struct SnapshotChaff {
    DisEntityId id;
    double      p_ecef[3], v_ecef_mps[3]; /* place and velocity of its middle, extrapolated from the report */
    double      age_s;                    /* time since its first report */
} SnapshotChaff;

typedef struct Snapshot {
    double          t_s;
    int             count, node_count;
    SnapshotEntity *entity; /* sorted by id */
    NodePose
        *node; /* nodes of entity k: entity[k].first_node and on, as many as the model has. NULL: see snapshot_pose */
    SnapshotJoints    *joints; /* [count]; NULL where node is not NULL */
    JointReport       *joint_report;
    int                puff_count;
    EffectPuff        *puff;           /* what burns, smokes and bursts */
    int64_t            puffs_left_out; /* puffs left out, the oldest, beyond effect_puff_capacity */
    int                chaff_count;
    SnapshotChaff     *chaff;        /* sorted by id; none of these is among the entities */
    int                left_out;     /* entities left out, the farthest, beyond the table's config.shown */
    const EffectTable *effect_table; /* NULL where there are no puffs */
    GroundMarks        marks;        /* marks left on the ground until t_s */
    int                patch_count;
    float             *patch_k; /* temperatures of the patches (entities/models/patches.h) of entities, K; filled in by
                                 * render/heat/vehicle_heat.h. NULL: parts are as warm as the air */
} Snapshot;

/* Whether an entity is a munition or an expendable, which did nothing before it appeared. */
bool snapshot_is_short_lived(const SnapshotEntity *entity);
/* Whether a puff came out of this entity: its own trail, flames or plume. */
bool snapshot_owns_puff(const Snapshot *snapshot, int index, const EffectPuff *puff);
/* Reported damage of a platform: 0 none, 1 slight, 2 moderate, 3 destroyed; others: 0. */
int snapshot_damage(const SnapshotEntity *entity);
/* A platform that its sender calls destroyed. */
bool snapshot_is_wreck(const SnapshotEntity *entity);

/* By how much the last report corrected the previous extrapolation, and after what time. */
typedef struct SnapshotMiss {
    double m, rad, s; /* s 0: there was no previous report */
} SnapshotMiss;

/* Expected error of an extrapolation, from the error of the previous one at the next report; where that is unknown,
 * `otherwise` for the place and nothing but the standard's 3 degrees a heartbeat for the attitude. The position error
 * grows as by an unreported acceleration, that of the attitude as by an unreported rate, up to the previous error: a
 * larger one would have caused a report. tests/sensor/test_frame_error.c. */
void snapshot_drift(double *drift_m, double *drift_rad, double age_s, const SnapshotMiss *missed, double otherwise_m,
                    double heartbeat_s);

/* Nodes of entity `index`, with this model, into pose[model->node_count]; joint_value: same size. Most entities are
 * never rendered: a snapshot keeps the joint state, and the renderer poses only what it draws. */
void snapshot_pose(NodePose *pose, double *joint_value, const Snapshot *snapshot, int index, const Model *model);

/* Index of an id, or -1. */
int snapshot_find(const Snapshot *snapshot, DisEntityId id);

#endif
