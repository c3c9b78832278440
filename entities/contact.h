/* entities/contact.h: land vehicles set onto the ground, along the local vertical (which leans 1.3 mrad at 8 km).
 *
 * Senders' terrain is not ours: over real elevation their vehicles float or sink by metres. */
#ifndef ENTITIES_CONTACT_H
#define ENTITIES_CONTACT_H

#include "entities/snapshot.h"
#include "terrain/elevation.h"
#include "terrain/local_frame.h"

typedef struct ContactGround {
    const LocalFrame *frame;
    const Elevation  *elevation; /* NULL: everybody stays where the sender put him */
} ContactGround;

/* Land platforms and life forms on land; everybody else stays. */
bool contact_applies(DisEntityType type);

/* Height of a place above the ground along its local vertical, m; negative below it; NaN beyond the elevation. */
double contact_above_m(const ContactGround *ground, const double p_ecef[3]);

/* Moves an entity (origin at its base) onto the plane that fits the ground best under its footprint: 5 x 3 places within
 * the model's box about its origin, without what overhangs to one side (a gun). Heading is kept; pitch and roll follow
 * the plane, at most 45 degrees each; velocity keeps its horizontal part and follows the slope. Who lies on his back or
 * stands on his nose keeps his attitude. Nothing happens beyond the elevation. */
void contact_set(SnapshotEntity *e, const ContactGround *ground, const Model *model);

#endif
