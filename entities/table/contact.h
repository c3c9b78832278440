/* entities/table/contact.h: clamps ground entities to the terrain, along the local vertical (which leans 1.3 mrad at 8
 * km).
 *
 * The terrain of senders differs: over real elevation their vehicles float or sink by metres. Synthetic terrain passes
 * through most of them; then only inconsistent ones are clamped, ships to its sea. */
#ifndef ENTITIES_TABLE_CONTACT_H
#define ENTITIES_TABLE_CONTACT_H

#include "entities/table/snapshot.h"
#include "terrain/ground/landscape.h"
#include "terrain/earth/geodesy.h"

typedef struct ContactGround {
    const LocalFrame *frame;
    const Elevation  *elevation; /* NULL: entities stay at their reported positions */
    const Landscape  *landscape; /* not NULL: the terrain is synthetic, so only inconsistent entities are clamped; it
                                    also gives the sea */
} ContactGround;

/* Whether an entity is clamped to the ground: land platforms, life forms, cultural features, supplies and sensors, on
 * land or of no domain. The last three keep their attitude. */
bool contact_applies(DisEntityType type);
/* Whether an entity is clamped to the water: surface platforms. */
bool contact_floats(DisEntityType type);

/* Share of the distance to the ground (or the water) that an inconsistent entity is moved: 0 within 0.1 m of the ground
 * (a ship: 1.5 m of heave and draught), 1 from 0.5 m (3 m) on, smooth in between. */
double contact_share(DisEntityType type, double above_m);

/* Height of a place above the ground along its local vertical, m; negative below it; NaN beyond the elevation. */
double contact_above_m(const ContactGround *ground, const double p_ecef[3]);

/* Moves an entity (origin at its base) onto the plane that fits the ground best under it: 5 x 3 points within the
 * model's box about its origin, without what overhangs to one side (a gun). Heading is kept; pitch and roll follow the
 * plane, at most 45 degrees each; aircraft are lifted out of the ground; velocity keeps its horizontal part and follows
 * the slope. An entity upside down or nose down keeps its attitude. No effect outside of the elevation data.
 *
 * With a landscape: contact_share of that, and none for carried or falling entities (platforms above 60 m/s, others
 * above 12; sinking faster than 2 m/s and half its horizontal speed) and for those above the sea (on a deck, swimming).
 * Ships are clamped to the sea's surface, or where none is known to the ground; they keep their attitude. */
void contact_set(SnapshotEntity *e, const ContactGround *ground, const Model *model);
/* Moves a place alone, such as the end of a track, as contact_set moves an entity there, by the ground at the place
 * itself. */
void contact_move(double p_ecef[3], DisEntityType type, const double v_ecef_mps[3], const ContactGround *ground);

#endif
