/* entities/table/contact.h: what stands on the ground set onto it, along the local vertical (which leans 1.3 mrad at 8 km).
 *
 * Senders' terrain is not ours: over real elevation their vehicles float or sink by metres. An invented landscape goes
 * through most of them; then only those it does not fit are set onto it, ships onto its sea. */
#ifndef ENTITIES_TABLE_CONTACT_H
#define ENTITIES_TABLE_CONTACT_H

#include "entities/table/snapshot.h"
#include "terrain/landscape/landscape.h"
#include "terrain/earth/local_frame.h"

typedef struct ContactGround {
    const LocalFrame *frame;
    const Elevation  *elevation; /* NULL: everybody stays where the sender put him */
    const Landscape  *landscape; /* not NULL: only misfits are set onto it; it says where its sea is */
} ContactGround;

/* Land platforms; life forms, cultural features, supplies and sensors on land or of no domain, of which the last three
 * keep their attitude. */
bool contact_applies(DisEntityType type);
/* Surface platforms. */
bool contact_floats(DisEntityType type);

/* How much of the way to the ground (or the water) a misfit goes: 0 within 0.1 m of the ground (a ship: 1.5 m of heave
 * and draught), 1 from 0.5 m (3 m) on, smooth in between. */
double contact_share(DisEntityType type, double above_m);

/* Height of a place above the ground along its local vertical, m; negative below it; NaN beyond the elevation. */
double contact_above_m(const ContactGround *ground, const double p_ecef[3]);

/* Moves an entity (origin at its base) onto the plane that fits the ground best under its footprint: 5 x 3 places within
 * the model's box about its origin, without what overhangs to one side (a gun). Heading is kept; pitch and roll follow
 * the plane, at most 45 degrees each; velocity keeps its horizontal part and follows the slope. Who lies on his back or
 * stands on his nose keeps his attitude. Nothing happens beyond the elevation.
 *
 * With a landscape: contact_share of that, and none of it for what is carried or falls (platforms above 60 m/s, others
 * above 12; sinking faster than 2 m/s and half its horizontal speed) and for what is above the sea (a deck, a swimmer).
 * Ships are set onto the sea's surface, or where no sea was known onto the ground; they keep their attitude. */
void contact_set(SnapshotEntity *e, const ContactGround *ground, const Model *model);

#endif
