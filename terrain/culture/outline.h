/* terrain/culture/outline.h: the straight outline of a patch of cells, as a roof has one in a surface model. */
#ifndef TERRAIN_CULTURE_OUTLINE_H
#define TERRAIN_CULTURE_OUTLINE_H

#include "terrain/culture/culture.h"

typedef struct Outline {
    int    corners;
    double corner[culture_outline_most][2]; /* counter-clockwise, in cells from the south-west corner of the window */
    double along_rad;                       /* direction of most walls, counter-clockwise from east, 0 .. pi / 2 */
    double straight;                        /* share of the boundary along or across that direction, 0 .. 1 */
} Outline;

/* The outer boundary of the cells of `of` [ny][nx] that hold `number`, which are connected by their sides and of which
 * `first` (j * nx + i) is the south-westmost of the southernmost row. Walls are fitted to the boundary, and where most
 * of it has two directions at right angles they have exactly those. They lie 0.3 cells within the boundary, as the
 * roof's edge does where cells that it only touches belong to the patch. A corner is within about a cell of the true
 * one, a wall within half. Holes are not kept. Returns false when nothing with an area is left, or the boundary is too
 * long (outline_most_steps). */
enum { outline_most_steps = 1 << 18 };
bool outline_of_cells(Outline *out, const int32_t *of, int nx, int ny, int32_t number, size_t first);

#endif
