/* terrain/culture/culture_give_way.h: what is built makes room where vehicles of an exercise stand or drive: on ground
 * that follows from a place and a seed alone (terrain/ground/placed.h), which has not been told of them. */
#ifndef TERRAIN_CULTURE_CULTURE_GIVE_WAY_H
#define TERRAIN_CULTURE_CULTURE_GIVE_WAY_H

#include "terrain/culture/culture.h"

/* A straight piece of where a vehicle is, half_m to each side of its middle line. ENU. */
typedef struct DrivenPath {
    double a_m[2], b_m[2], half_m;
} DrivenPath;

/* Takes away buildings, things, walls and fences that a path touches, and those power lines of which a pole stands in
 * it; wires over it stay, as do roads, yards, water and trees. Indexed before and after; order stays. *taken: how many
 * records. STATUS_NO_MEMORY: culture is as it was. */
Status culture_give_way(Culture *culture, int *taken, const DrivenPath *path, int count);

#endif
