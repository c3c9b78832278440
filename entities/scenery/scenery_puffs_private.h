/* entities/scenery/scenery_puffs_private.h: sources of scenery by range, and their puffs in a snapshot. */
#ifndef ENTITIES_SCENERY_SCENERY_PUFFS_PRIVATE_H
#define ENTITIES_SCENERY_SCENERY_PUFFS_PRIVATE_H

#include "entities/scenery/scenery.h"
#include "entities/traces/effect_history.h"

/* Something of scenery, and how far from the eye it is. */
typedef struct SceneryNear {
    double range_m;
    int    which;
} SceneryNear;

/* Sorts by range, equal ones by number, and returns how many stay: at most `most`. */
int scenery_nearest(SceneryNear *near, int count, int most);

/* Whether a ball about a place is in a cone, and how far off its middle is: at most most_m. */
bool scenery_in_cone(double *range_m, const SceneryCone *seen, const double p_enu[3], double radius_m, double most_m);

/* Room for more puffs behind the snapshot's own, up to effect_puff_capacity in all: *at, [*room], in the arena. The
 * caller counts them in. */
Status scenery_puff_room(EffectPuff **at, size_t *room, Snapshot *snapshot, size_t more, Arena *arena);

/* Puts the puffs of these sources behind the snapshot's own, as long as there is room (effect_puff_capacity). */
Status scenery_add_puffs(Snapshot *snapshot, const EffectSource *source, int count, Arena *arena);

#endif
