/* terrain/culture/culture_ground.h: roads, tracks and rivers of culture as surfaces of the ground. */
#ifndef TERRAIN_CULTURE_CULTURE_GROUND_H
#define TERRAIN_CULTURE_CULTURE_GROUND_H

#include "terrain/culture/culture.h"
#include "terrain/ground/landscape.h"

/* Lays the lines that have a surface on a landscape; the culture is indexed, and borrowed as long as the landscape is
 * asked. NULL, or one that has none: takes what lies there away. */
void culture_lay(Landscape *landscape, const Culture *culture);

#endif
