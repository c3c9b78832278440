/* sensor/node/player/munitions.h: munitions that were received: who was fired at, which have burst, which one is the
 * host. Of each kind the latest are stored. */
#ifndef SENSOR_NODE_PLAYER_MUNITIONS_H
#define SENSOR_NODE_PLAYER_MUNITIONS_H

#include "dis/pdu/decode.h"
#include "entities/table/entity_table.h"

enum {
    shots_kept = 1024,
    munitions_kept = 256,
    munition_still_mps = 1 /* an unguided munition slower than this is at rest, as mines of any category are */
};

/* Of one kind, a ring. */
typedef struct MunitionRing {
    DisEntityId id[munitions_kept];
    double      heard_s[munitions_kept];         /* of the latest report in flight */
    bool        spent[munitions_kept];           /* it detonated */
    bool        by_place[munitions_kept];        /* as its place and time say, not an id */
    double      p_burst_ecef[munitions_kept][3]; /* where these burst */
    uint64_t    count;
} MunitionRing;

/* A Fire. */
typedef struct Aimed {
    DisEntityId munition, target, firing;
    DisEventId  event;
} Aimed;

typedef struct Munitions {
    Aimed        aimed[shots_kept], unnamed[shots_kept]; /* rings: that name a munition; that name none */
    uint64_t     shots, unnamed_shots;
    MunitionRing guided, unguided;
} Munitions;

void munitions_fire(Munitions *m, const DisFire *fire);
/* counts_s: time from which the report counts. */
void munitions_report(Munitions *m, const DisEntityState *state, double counts_s);
/* A Detonation ends the munition that it names. One without a munition id ends that of the latest Fire of its event
 * and firing entity; if that Fire named none, it ends no munition: it is of a round without an entity. Without such a
 * Fire it ends the munition in the table whose path, extrapolated to t_s and 0.1 s either way, leads nearest to it,
 * within 10 m, unless a Fire gives that one another firing entity; a munition that reports more than 50 m away later
 * flies on. */
void munitions_burst(Munitions *m, const DisDetonation *burst, const EntityTable *table, double t_s, double counts_s);

/* These answer as player_target, player_spent, player_munition and player_forgotten do. */
bool munitions_target(DisEntityId *target, const Munitions *m, DisEntityId munition);
bool munitions_spent(const Munitions *m, DisEntityId munition);
bool munitions_host(DisEntityId *munition, bool *guided, const Munitions *m, const EntityTable *table, double now_s);
void munitions_forgotten(uint64_t *shots, uint64_t *munitions, const Munitions *m);

#endif
