/* terrain/culture/culture_surface.h: buildings as records, from a surface model that was taken apart. */
#ifndef TERRAIN_CULTURE_CULTURE_SURFACE_H
#define TERRAIN_CULTURE_CULTURE_SURFACE_H

#include "terrain/bare_earth/take_apart.h"
#include "terrain/culture/culture.h"

/* Where the whole model (SurfaceModel.column, row) lies in the frame of the records: the south-west corner of its cell
 * (0, 0), and the sides of a cell east- and northwards. */
typedef struct SurfacePlace {
    double origin_m[2], east_m[2], north_m[2];
} SurfacePlace;

/* Cells i0 .. i1 - 1, j0 .. j1 - 1 of a window: buildings the mean of whose corners lies there are the window's. */
typedef struct SurfaceCore {
    int i0, j0, i1, j1;
} SurfaceCore;

/* A patch of roof that is wider is cut along lines that the whole model has, half as far apart, so that windows whose
 * cells are right this far beyond their cores, with cores that meet, have each building of all of them once and the
 * same to the last bit. */
static const double surface_building_most_m = 256;

/* Adds a building for each patch of roof of at least 12 m2: patches that a step in height parts are buildings of their
 * own. Outline by outline.h; base_m the lowest bare ground below it, in the model's heights; roof flat, skillion,
 * gabled or hipped, as fits its cells best; id by the place of its first cell in the whole model, row << 32 | column.
 * Heights and outlines: tests/terrain/test_culture_surface.c. Cells of 0.1 .. 2 m. core NULL: all of the window.
 * STATUS_NO_MEMORY, or those of culture_add_building. */
Status culture_add_surface(Culture *culture, const SurfaceParts *parts, const SurfaceModel *model,
                           const SurfacePlace *place, const SurfaceCore *core);

#endif
