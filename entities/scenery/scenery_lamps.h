/* entities/scenery/scenery_lamps.h: what of scenery lights by night: panes of heated dwellings, lamp posts, headlamps
 * of what drives; where they are, and when they are lit, by seed.
 *
 * When: a function of where the sun stands and of the draws of a lamp, so that a place has the same lights in every
 * run, at any rate of frames. Hours are those of the sun (12: it is in the south), which a clock leaves by up to two.
 * Shares and hours are estimates about published means of going to bed and getting up (22.7 and 6.7 h: Eurostat,
 * Harmonised European Time Use Surveys, typed from knowledge). */
#ifndef ENTITIES_SCENERY_SCENERY_LAMPS_H
#define ENTITIES_SCENERY_SCENERY_LAMPS_H

#include "entities/scenery/scenery.h"

enum { scenery_most_lamps = 1 << 20 }; /* more are left out, which is logged */

/* Sines of the sun's elevation: rooms and headlamps light below the first, street lamps below the second, at which
 * level ground has some 35 lx, where photocells switch (BS 5972). */
static const double lamps_home_sun_up = 0, lamps_street_sun_up = -0.0698;

/* Appends the lamps of all buildings, works and movers, in order of object and facet: seed: of the draws. Once, after
 * the rest. STATUS_NO_MEMORY: the scenery is as it was. */
Status scenery_add_lamps(Scenery *scenery, uint64_t seed);

/* Whether it is lit. sun_up: sine of the sun's elevation. hour: solar time, 0 .. 24. */
bool scenery_lamp_lit(const SceneryLamp *lamp, double sun_up, double hour);
/* Solar time from the direction of the sun and the latitude, 0 .. 24 h; to 3 minutes, by refraction. */
double scenery_solar_hour(const double sun_d_enu[3], double lat_rad);

/* The lamp to which a facet of an object belongs; -1: none. O(log lamps). */
int scenery_lamp_of(const Scenery *scenery, int object, int facet);

#endif
