/* entities/table/entity_table_private.h: the table's slots, and what the files of the table do with them. */
#ifndef ENTITIES_TABLE_ENTITY_TABLE_PRIVATE_H
#define ENTITIES_TABLE_ENTITY_TABLE_PRIVATE_H

#include "dis/pdu/pdu.h"
#include "entities/motion/articulation.h"
#include "entities/motion/dead_reckoning.h"
#include "entities/traces/effect_history.h"
#include "entities/traces/ground_marks.h"
#include "entities/table/entity_index.h"
#include "entities/table/entity_limits_private.h"
#include "entities/table/entity_table.h"
#include "entities/table/snapshot.h"

enum { entity_effect_positions = 4 }; /* flame, smoke, engine smoke, trail */

typedef struct EntitySlot {
    uint32_t      generation; /* odd while an entity has it */
    DisEntityId   id;
    DisEntityType type;
    uint8_t       force;
    char          marking[12];
    uint32_t      appearance;
    int           model;
    Origin        origin;
    uint32_t      roles; /* bits 1 << HeatRole of the model's parts */
    double        created_s, report_s;
    double        timeout_s;  /* the entity ends after a longer silence than this */
    double        hold_s;     /* longest time it is extrapolated */
    bool          known;      /* it has reported for known_after_s */
    bool          stopped;    /* Stop/Freeze stopped it, at stop_s */
    bool          marks;      /* it has begun a stand or a trail: EntityMarks */
    bool          trails;     /* its trail is on */
    bool          reports_on; /* the Stop/Freeze lets it go on reporting, so a report does not end the stop */
    double        stop_s;
    double        paused_s;       /* time spent stopped since the last report */
    uint32_t      stamp;          /* time stamp of its last report */
    double shift_s, shift_from_s; /* its time is ahead by shift_s at shift_from_s, and by less and less afterwards */
    double spin_s, spin_from_s;   /* spin_s: its running clock at spin_from_s */
    double distance_m;            /* distance travelled forward, at the report */
    SnapshotMiss missed;
    Kinematics   reported; /* the report's kinematics after entity_report.c sanitized them */
    DriveState   drives;
    Articulation articulation;
    uint64_t     effect[entity_effect_positions]; /* handles, of effect_history.h, of what it emits now */
} EntitySlot;

/* What an entity is leaving on the ground at present; kept beside its slot. */
typedef struct EntityMarks {
    bool        stands;    /* it stands at this place since from_s */
    double      p_ecef[3]; /* place of the model's origin */
    double      r_ecef_from_body[9];
    double      from_s;
    GroundBlow  blow;  /* what its exhaust did to the ground from this place */
    uint64_t    stand; /* handle of ground_marks.h; 0: not recorded yet */
    GroundTrail trail;
    double      followed_s; /* the entity's own time up to which the trail has been followed */
} EntityMarks;

/* The place that matters most: see entity_table_focus. */
typedef struct EntityFocus {
    DisEntityId host, also;
    bool        placed;  /* p_ecef is set: from the last report of a host that was in the table */
    bool        of_host; /* p_ecef is that of the present host */
    double      p_ecef[3];
    double      ranked_ecef[3],
        ranked_s; /* place and time of the focus when the distances of all entities were last computed */
} EntityFocus;

/* Where a model's exhaust gas leaves, and in which direction, body axes. */
typedef struct ModelOutlet {
    bool       known, is_there;
    ExhaustJet jet;
} ModelOutlet;

/* The part of a standing model that shades the ground: its box without guns and rotors, which are thin. */
typedef struct ModelStand {
    bool  known;
    float low_m[3], high_m[3];
} ModelStand;

struct EntityTable {
    EntityTableConfig config;
    const Catalog    *catalog;
    uint32_t         *model_roles; /* [catalog_model_count] */
    ModelOutlet      *outlet;      /* [catalog_model_count], known for models that entities have had */
    ModelStand       *stood;       /* [catalog_model_count], known for models that have stood */
    uint64_t          changes;     /* entity_table_changes */
    EntityIndex       index;
    EntityRanks      *ranks; /* ranks of all entities but the host and `also` */
    EntityFocus       focus;
    EntitySlot *slot; /* [config.capacity + 1], since a newcomer needs one too; slots below slot_end have been used */
    int        *free_slot; /* stack of the free slots below slot_end */
    int         slot_end, free_count, count, stopped_count;
    double      arrival_s; /* set by entity_table_arrival; NaN: that was not called */
    bool        by_stamp;
    Tombstones *tombstones;
    EntityRate *rate;
    EntityCounters counters;
    EffectHistory *effects;
    EntityMarks   *mark; /* [config.capacity + 1] */
    GroundHistory *ground;
};

static inline bool entity_slot_lives(const EntitySlot *slot) { return slot->generation & 1; }
static inline bool entity_slot_frozen(const EntitySlot *slot)
{
    return slot->appearance >> dis_appearance_frozen_bit & 1;
}
/* Whether an entity has been silent for too long. Stopped entities are not expected to report, and the time they were
 * stopped does not count. */
static inline bool entity_slot_silent(const EntitySlot *slot, double t_s)
{
    return !slot->stopped && t_s - slot->paused_s - slot->report_s > slot->timeout_s;
}

/* How much of a shift of an entity's time is left after dt_s. The shift falls by half a second per second, then by a
 * factor e every half second, and at last by 20 ms per second. */
static inline double entity_slot_shift_left(double shift_s, double dt_s)
{
    static const double fast = 0.5, fall_s = 0.5, slow = 0.02;
    const double        high_s = fast * fall_s, low_s = slow * fall_s, sign = shift_s < 0 ? -1 : 1;
    double              left_s = fabs(shift_s), rest_s = fmax(dt_s, 0);
    if (left_s > high_s) {
        const double took_s = fmin((left_s - high_s) / fast, rest_s);
        left_s -= fast * took_s;
        rest_s -= took_s;
    }
    if (left_s > low_s && rest_s > 0) {
        const double took_s = fmin(fall_s * log(left_s / low_s), rest_s);
        left_s *= exp(-took_s / fall_s);
        rest_s -= took_s;
    }
    return sign * fmax(left_s - slow * rest_s, 0);
}

/* Exercise time less the pauses since the entity's report. It does not advance while the entity is frozen or stopped.
 * Its drives run by this time. */
static inline double entity_slot_running(const EntitySlot *slot, double t_s)
{
    if (entity_slot_frozen(slot)) return slot->report_s;
    return (slot->stopped ? fmin(t_s, slot->stop_s) : t_s) - slot->paused_s;
}

/* An entity's own time, by which it moves: the same, shifted to where its sender's clock was. */
static inline double entity_slot_time(const EntitySlot *slot, double t_s)
{
    const double own_s = entity_slot_running(slot, t_s);
    if (entity_slot_frozen(slot)) return own_s;
    return slot->shift_s == 0 ? own_s : own_s + entity_slot_shift_left(slot->shift_s, t_s - slot->shift_from_s);
}

/* How far the report is extrapolated for t_s. */
static inline double entity_slot_dt(const EntitySlot *slot, double t_s)
{
    return clamp(entity_slot_time(slot, t_s) - slot->report_s, -slot->hold_s, slot->hold_s);
}

/* ---- entity_slots.c ---------------------------------------------------------------------------- */

EntitySlot *entity_slot_find(const EntityTable *table, DisEntityId id); /* NULL: no entity has this id */
/* Returns a new slot. The table has one slot more than it keeps entities: see entity_slot_admit. */
EntitySlot *entity_slot_new(EntityTable *table, DisEntityId id, double t_s);
/* Takes an entity out of the table, with its effects and marks. counter: the one of the table's counters that says why.
 * */
void entity_slot_remove(EntityTable *table, EntitySlot *slot, double t_s, uint64_t *counter);

/* The running clock at t_s by which rotors turn. */
double entity_slot_spin(const EntitySlot *slot, double t_s);
/* Distance travelled forward from the report to a pose reached by dead reckoning. */
double entity_slot_forward(const EntitySlot *slot, const double p_ecef[3], const double r_ecef_from_body[9]);
/* Ranks the entity for a report received now. */
void entity_slot_rank(EntityTable *table, EntitySlot *slot, const double p_ecef[3], double t_s);
/* Admits a new entity that has been ranked; evicts another if required. Returns false when the new one itself was
 * evicted. */
bool entity_slot_admit(EntityTable *table, EntitySlot *newcomer, double t_s);

/* ---- entity_effects.c -------------------------------------------------------------------------- */

/* Finds the outlet of a model that an entity now has. */
void entity_effects_outlet(EntityTable *table, int model);
/* Call the first after every change of a slot's motion or appearance, the second when the entity ends. */
void entity_effects_report(EntityTable *table, EntitySlot *slot, double t_s);
void entity_effects_end(EntityTable *table, EntitySlot *slot, double t_s);
/* The puffs that an entity carries along at t_s: the flame behind a motor, exhaust gas, a decoy's fire. Returns their
 * number. */
enum { entity_carried_max = 6 };
int    entity_effects_carried(EffectPuff out[entity_carried_max], const EntityTable *table, const EntitySlot *slot,
                              const SnapshotEntity *entity, double t_s);
Status entity_effects_snapshot(Snapshot *snapshot, const EntityTable *table, const EffectPuff *carried,
                               int carried_count, Arena *arena);
/* Sets the joints of a wreck. reports: how many joints the sender reports. */
void entity_effects_wreck_joints(double *joint_value, const Model *model, const SnapshotEntity *entity, int reports);

/* ---- entity_marks.c ---------------------------------------------------------------------------- */

/* Call `before` before a report changes the slot, `report` after it, `stop` and `start` at Stop/Freeze and
 * Start/Resume, and `end` when the entity ends (silent: by a timeout) or changes its type. */
void entity_marks_before(EntityTable *table, EntitySlot *slot, double t_s);
void entity_marks_report(EntityTable *table, EntitySlot *slot, bool is_first, double t_s);
void entity_marks_stop(EntityTable *table, EntitySlot *slot, double t_s);
void entity_marks_start(EntityTable *table, EntitySlot *slot, double t_s);
void entity_marks_end(EntityTable *table, EntitySlot *slot, bool silent, double t_s);
void entity_marks_detonation(EntityTable *table, const DisDetonation *pdu, double t_s);
/* trailing[count]: slots of the snapshot's entities that leave a trail, in the order of ids. */
Status entity_marks_snapshot(Snapshot *snapshot, const EntityTable *table, const int *trailing, int count,
                             Arena *arena);
#endif
