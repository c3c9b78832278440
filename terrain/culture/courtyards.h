/* terrain/culture/courtyards.h: an outline with courtyards as one outline: from each a slit goes straight through the
 * building to its outside, or to another that has one, where the building is narrowest. */
#ifndef TERRAIN_CULTURE_COURTYARDS_H
#define TERRAIN_CULTURE_COURTYARDS_H

#include "terrain/culture/culture.h"

static const double courtyard_slit_m = 0.02; /* wide: no ray from a distance goes through */
static const double courtyard_least_m2 = 9;  /* smaller ones are shafts, and are built over */
enum { courtyards_most = 32 };               /* of a building: of more the largest */

/* Joins rings, which are inside of an outline of `corners` and apart, to it: p has room for culture_outline_most. first
 * [rings + 1]: of each ring's corners. Turns outline and rings as they have to be. Returns the corners of the whole;
 * *joined: how many rings there are in it; those that are too small, or from which no slit is found, are not. */
int courtyards_join(double (*p)[2], int corners, const double (*ring_m)[2], const int *first, int rings, int *joined);

/* Which edges of an outline are sides of slits: the edge from corner k on of [n]. Returns how many. */
int courtyards_slits(bool *slit, const double (*p)[2], int n);

#endif
