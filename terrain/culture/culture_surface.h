/* terrain/culture/culture_surface.h: buildings as records, from a surface model that was taken apart. */
#ifndef TERRAIN_CULTURE_CULTURE_SURFACE_H
#define TERRAIN_CULTURE_CULTURE_SURFACE_H

#include "terrain/bare_earth/take_apart.h"
#include "terrain/culture/culture.h"

/* Where a window of cells lies in the frame of the records: origin, and the sides of a cell east- and northwards. */
typedef struct SurfacePlace {
    double origin_m[2], east_m[2], north_m[2];
} SurfacePlace;

/* Adds a building for each patch of roof of at least 12 m2: patches that a step in height parts are buildings of their
 * own. Outline by outline.h; base_m the lowest bare ground below it; roof flat, skillion, gabled or hipped, as fits its
 * cells best. Heights and outlines: tests/terrain/test_culture_surface.c. Cells of 0.1 .. 2 m. STATUS_NO_MEMORY, or
 * those of culture_add_building. */
Status culture_add_surface(Culture *culture, const SurfaceParts *parts, const SurfaceModel *model,
                           const SurfacePlace *place);

#endif
