/* entities/traces/effect_history.h: sources and times of puffs: shots and bursts of the last minute, and emissions of
 * entities. Bounded: when full, the oldest is dropped and counted.
 *
 * An entity emits a puff at every multiple of its kind's interval of exercise time, at its dead-reckoned position at
 * that time. The set of puffs at t is therefore a function of the received PDUs and of t alone. */
#ifndef ENTITIES_TRACES_EFFECT_HISTORY_H
#define ENTITIES_TRACES_EFFECT_HISTORY_H

#include "dis/pdu/decode.h"
#include "entities/motion/dead_reckoning.h"
#include "entities/traces/effect_puffs.h"

enum { effect_event_capacity = 4096, effect_source_capacity = 16384, effect_puff_capacity = 16384 };

/* One interval of emission: the entity's motion, and its sources. */
typedef struct EffectSource {
    EffectKind kind;
    uint64_t   key;          /* entity_key of the emitting entity, which owns the puffs */
    double     from_s, to_s; /* puffs are emitted in from_s <= t < to_s */
    Kinematics motion;       /* motion of the entity at motion_s */
    double     motion_s;
    double     hold_s;                     /* longest time that the motion is extrapolated */
    double     at_body[3], spread_body[3]; /* place of the source relative to the reported position, and the radius over
                                              which it spreads */
    double speed_mps;                      /* speed along the path, by which puffs are stretched to join */
    bool   grounded; /* its entity is clamped to the ground, with its base below_m under the reported position */
    double below_m;
    double scale, rate; /* scale of lengths; share of the row's mass that is emitted a second */
} EffectSource;

typedef struct EffectCounters {
    uint64_t refused;        /* Fire or Detonation PDUs with a place that is not finite or not near the Earth */
    uint64_t repeated;       /* PDUs that repeated an event */
    uint64_t events_dropped; /* events that were still visible when a newer one replaced them */
    uint64_t sources_dropped;
} EffectCounters;

/* there are no puffs after this time, as intervals are counted in 64 bits */
static const double effect_latest_s = 1e12;

typedef struct EffectHistory EffectHistory;

/* path: etc/effects.csv. */
Status                effect_history_create(EffectHistory **out, const char *path);
void                  effect_history_destroy(EffectHistory *history);
const EffectTable    *effect_history_table(const EffectHistory *history);
const EffectCounters *effect_history_counters(const EffectHistory *history);

void effect_history_fire(EffectHistory *history, const DisFire *pdu, double t_s);
void effect_history_detonation(EffectHistory *history, const DisDetonation *pdu, double t_s);
/* Opens a source, and returns a handle for closing it, never 0; to_s of the source is the latest time it can last.
 * Closing 0, or a source that was dropped, has no effect. */
uint64_t effect_history_open(EffectHistory *history, const EffectSource *source);
void     effect_history_close(EffectHistory *history, uint64_t handle, double t_s);

/* Charge that scales a shot or burst: kg of propellant (fire) or of explosive, from munition type and warhead.
 * Estimates, by class of munition only: within a factor of three. */
double effect_charge_kg(const DisDescriptor *descriptor, bool fire);
bool   effect_is_kinetic(const DisDescriptor *descriptor); /* whether it is a penetrator, without explosive */
/* Whether a Detonation's result means that nothing burst, that it burst on the ground, or on water. */
bool effect_result_is_none(int result);
bool effect_result_is_ground(int result);
bool effect_result_is_water(int result);

/* All visible puffs at t_s, newest first, up to capacity. Returns how many there are, which exceeds capacity when they
 * do not all fit. out may be NULL with capacity 0. */
size_t effect_history_puffs(EffectPuff *out, size_t capacity, const EffectHistory *history, double t_s);
/* Likewise those of one source, which is in no history. */
size_t effect_source_puffs(EffectPuff *out, size_t capacity, const EffectTable *table, const EffectSource *source,
                           double t_s);

#endif
