/* entities/table/entity_table_private.h: the table's slots, and what the files of the table do with them. */
#ifndef ENTITIES_TABLE_ENTITY_TABLE_PRIVATE_H
#define ENTITIES_TABLE_ENTITY_TABLE_PRIVATE_H

#include "dis/pdu/pdu.h"
#include "entities/motion/articulation.h"
#include "entities/motion/dead_reckoning.h"
#include "entities/traces/effect_history.h"
#include "entities/traces/ground_marks.h"
#include "entities/table/entity_index.h"
#include "entities/table/entity_limits.h"
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
    uint32_t      roles; /* of the model's parts: 1 << HeatRole */
    double        created_s, report_s;
    double        timeout_s;  /* silence longer than this ends it */
    double        hold_s;     /* longest extrapolation */
    bool          known;      /* known: has reported for known_after_s */
    bool          stopped;    /* by Stop/Freeze, at stop_s */
    bool          marks;      /* has begun a stand or a trail: EntityMarks */
    bool          trails;     /* its trail is on */
    bool          reports_on; /* the Stop/Freeze lets it go on reporting: a report does not end it */
    double        stop_s;
    double        paused_s;              /* spent stopped since the report */
    uint32_t      stamp;                 /* of its last report */
    double        shift_s, shift_from_s; /* ahead of its time by this at that time, and less and less since */
    double        spin_s, spin_from_s;   /* running clock at spin_from_s */
    double        distance_m;            /* distance travelled forward, at the report */
    SnapshotMiss  missed;
    Kinematics    reported; /* as sanitized: entity_report.c */
    DriveState    drives;
    Articulation  articulation;
    uint64_t      effect[entity_effect_positions]; /* what it gives off now: handles of effect_history.h */
} EntitySlot;

/* What an entity leaves on the ground at present, beside its slot. */
typedef struct EntityMarks {
    bool        stands;    /* at this place, since from_s */
    double      p_ecef[3]; /* of the model's origin */
    double      r_ecef_from_body[9];
    double      from_s;
    GroundBlow  blow;  /* of its exhaust, from this place */
    uint64_t    stand; /* handle of ground_marks.h; 0: not recorded yet */
    GroundTrail trail;
    double      followed_s; /* the entity's own time up to which the trail has been followed */
} EntityMarks;

/* Where what matters is: entity_table_focus. */
typedef struct EntityFocus {
    DisEntityId host, also;
    bool        placed;  /* p_ecef: of the last report of a host that was in the table */
    bool        of_host; /* of this one */
    double      p_ecef[3];
    double      ranked_ecef[3], ranked_s; /* from where, and when, all distances were last taken */
} EntityFocus;

/* Where a model's exhaust gas leaves, body axes, and which way. */
typedef struct ModelOutlet {
    bool       known, is_there;
    ExhaustJet jet;
} ModelOutlet;

/* What of a standing model shades the ground: its box without guns and rotors, which are thin. */
typedef struct ModelStand {
    bool  known;
    float low_m[3], high_m[3];
} ModelStand;

struct EntityTable {
    EntityTableConfig config;
    const Catalog    *catalog;
    uint32_t         *model_roles; /* [catalog_model_count] */
    ModelOutlet      *outlet;      /* [catalog_model_count], of models that entities have had */
    ModelStand       *stood;       /* [catalog_model_count], of models that have stood */
    uint64_t          changes;     /* entity_table_changes */
    EntityIndex       index;
    EntityRanks      *ranks; /* of all but the focus' own */
    EntityFocus       focus;
    EntitySlot       *slot;      /* [config.capacity + 1]: a newcomer's too; used below slot_end */
    int              *free_slot; /* stack of those below slot_end that are free */
    int               slot_end, free_count, count, stopped_count;
    double            arrival_s; /* entity_table_arrival; NaN: not called */
    bool              by_stamp;
    Tombstones       *tombstones;
    EntityRate       *rate;
    EntityCounters    counters;
    EffectHistory    *effects;
    EntityMarks      *mark; /* [config.capacity + 1] */
    GroundHistory    *ground;
};

static inline bool entity_slot_lives(const EntitySlot *slot) { return slot->generation & 1; }
static inline bool entity_slot_frozen(const EntitySlot *slot)
{
    return slot->appearance >> dis_appearance_frozen_bit & 1;
}
/* Stopped entities are not expected to report, and the time that they were does not count afterwards. */
static inline bool entity_slot_silent(const EntitySlot *slot, double t_s)
{
    return !slot->stopped && t_s - slot->paused_s - slot->report_s > slot->timeout_s;
}

/* What is left of a shift of its time after dt_s: it falls at a rate of half a second per second, then by e in half a
 * second, at last of 20 ms per second. */
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

/* Its own time: exercise time less the pauses since its report, still while it is frozen or stopped. */
static inline double entity_slot_time(const EntitySlot *slot, double t_s)
{
    if (entity_slot_frozen(slot)) return slot->report_s;
    const double own_s = (slot->stopped ? fmin(t_s, slot->stop_s) : t_s) - slot->paused_s;
    return slot->shift_s == 0 ? own_s : own_s + entity_slot_shift_left(slot->shift_s, t_s - slot->shift_from_s);
}

/* How far to extrapolate the report for t_s. */
static inline double entity_slot_dt(const EntitySlot *slot, double t_s)
{
    return clamp(entity_slot_time(slot, t_s) - slot->report_s, -slot->hold_s, slot->hold_s);
}

/* ---- entity_slots.c ---------------------------------------------------------------------------- */

EntitySlot *entity_slot_find(const EntityTable *table, DisEntityId id); /* NULL: not there */
/* There is one slot more than the table keeps: entity_slot_admit. */
EntitySlot *entity_slot_new(EntityTable *table, DisEntityId id, double t_s);
/* Takes an entity out of the table, with what follows from it; counter: why, one of the table's counters. */
void entity_slot_remove(EntityTable *table, EntitySlot *slot, double t_s, uint64_t *counter);

/* The running clock of rotors at t_s. */
double entity_slot_spin(const EntitySlot *slot, double t_s);
/* Forward way from the report to a pose reached by dead reckoning. */
double entity_slot_forward(const EntitySlot *slot, const double p_ecef[3], const double r_ecef_from_body[9]);
/* Ranks it for a report received now. */
void entity_slot_rank(EntityTable *table, EntitySlot *slot, const double p_ecef[3], double t_s);
/* Admits a ranked new entity, evicting another if required. False: it is the one evicted. */
bool entity_slot_admit(EntityTable *table, EntitySlot *newcomer, double t_s);

/* ---- entity_effects.c -------------------------------------------------------------------------- */

/* Finds the outlet of a model, once an entity has it. */
void entity_effects_outlet(EntityTable *table, int model);
/* After every change of a slot's motion or appearance; and when it ends. */
void entity_effects_report(EntityTable *table, EntitySlot *slot, double t_s);
void entity_effects_end(EntityTable *table, EntitySlot *slot, double t_s);
/* What it carries along at t_s: the flame behind a motor, exhaust gas, a decoy's fire. Returns how many puffs. */
enum { entity_carried_max = 6 };
int    entity_effects_carried(EffectPuff out[entity_carried_max], const EntityTable *table, const EntitySlot *slot,
                              const SnapshotEntity *entity, double t_s);
Status entity_effects_snapshot(Snapshot *snapshot, const EntityTable *table, const EffectPuff *carried,
                               int carried_count, Arena *arena);
/* reports: of joints, by the sender. */
void entity_effects_wreck_joints(double *joint_value, const Model *model, const SnapshotEntity *entity, int reports);

/* ---- entity_marks.c ---------------------------------------------------------------------------- */

/* Before a report changes the slot; after it; at Stop/Freeze and Start/Resume; when the entity ends (silent: by a
 * timeout), or is of another type now. */
void entity_marks_before(EntityTable *table, EntitySlot *slot, double t_s);
void entity_marks_report(EntityTable *table, EntitySlot *slot, bool is_first, double t_s);
void entity_marks_stop(EntityTable *table, EntitySlot *slot, double t_s);
void entity_marks_start(EntityTable *table, EntitySlot *slot, double t_s);
void entity_marks_end(EntityTable *table, EntitySlot *slot, bool silent, double t_s);
void entity_marks_detonation(EntityTable *table, const DisDetonation *pdu, double t_s);
/* trailing[count]: slots of the snapshot that trail, by id. */
Status entity_marks_snapshot(Snapshot *snapshot, const EntityTable *table, const int *trailing, int count,
                             Arena *arena);
#endif
