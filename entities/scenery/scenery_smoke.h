/* entities/scenery/scenery_smoke.h: smoke of the fires and smouldering heaps of clutter, as puffs of a snapshot.
 *
 * Each is a source that stands (entities/traces/effect_history.h: a puff every quarter of a second, fewer with age), of
 * the rows wood_smoke and smoulder_smoke of etc/effects.csv; the weather's wind carries the puffs. A pure function of
 * scenery, time and eye. */
#ifndef ENTITIES_SCENERY_SCENERY_SMOKE_H
#define ENTITIES_SCENERY_SCENERY_SMOKE_H

#include "entities/scenery/scenery.h"
#include "terrain/earth/geodesy.h"

/* Of more the nearest to the eye smoke, and none beyond the range: a plume there is thinner than a pixel's noise. */
enum { scenery_smokes_most = 64 };
static const double scenery_smokes_m = 5000;

/* Puts their puffs behind the snapshot's own, as long as there is room (effect_puff_capacity). snapshot: with its
 * effect_table; without one, or where Scenery.smokes is not set, it stays as it is. In the arena. */
Status scenery_smoke(Snapshot *snapshot, const Scenery *scenery, const LocalFrame *frame, const double eye_enu[3],
                     Arena *arena);

#endif
