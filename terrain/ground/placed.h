/* terrain/ground/placed.h: invented ground that follows from a place and a seed alone, and from no exercise. The
 * same figures make the same ground to the bit, so that an exercise can be placed on it beforehand (scenario key
 * ground.planted) and a node finds its vehicles where they were placed (setting terrain.place). */
#ifndef TERRAIN_GROUND_PLACED_H
#define TERRAIN_GROUND_PLACED_H

#include "terrain/ground/landscape.h"

/* "50.1,8.6,120": latitude and longitude, degrees, and height of the ground there above the ellipsoid, m, -500 .. 9000;
 * out in radians. False: it is not such a text. */
bool landscape_place_parse(Geodetic *out, const char *text);
/* The frame of the ground: about the place, on the ellipsoid. */
Status landscape_place_frame(LocalFrame *out, const Geodetic *place);
/* Its one fix is the place: hills about it have their rms height, landscape_create_from says the rest. cache may be
 * NULL. */
Status landscape_placed(Landscape *out, const LandscapeConfig *config, const Geodetic *place, Cache *cache);

#endif
