/* entities/scenery/scenery_exhaust.h: the hot gas of clutter whose engines run, as puffs of a snapshot: the same as
 * that of entities (entities/traces/exhaust.h). A pure function of scenery, time and what is looked at. */
#ifndef ENTITIES_SCENERY_SCENERY_EXHAUST_H
#define ENTITIES_SCENERY_SCENERY_EXHAUST_H

#include "entities/scenery/scenery.h"
#include "terrain/earth/geodesy.h"

/* Of more the nearest to the eye, and none beyond the range or out of view: gas there fills no hundredth of a pixel's
 * light. */
enum { scenery_exhausts_most = 64 };
static const double scenery_exhausts_m = 3000;

/* Puts the puffs behind the snapshot's own, as scenery_smoke does. In the arena. */
Status scenery_exhaust(Snapshot *snapshot, const Scenery *scenery, const LocalFrame *frame, const SceneryCone *seen,
                       Arena *arena);

#endif
