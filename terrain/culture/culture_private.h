/* terrain/culture/culture_private.h: what the files of this folder share. */
#ifndef TERRAIN_CULTURE_CULTURE_PRIVATE_H
#define TERRAIN_CULTURE_CULTURE_PRIVATE_H

#include "terrain/culture/culture.h"

void culture_index_free(Culture *culture);
/* Signed, positive when the corners go counter-clockwise. */
double culture_area_m2(const double (*corner_m)[2], int corners);

#endif
