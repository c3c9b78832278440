/* terrain/invented/uniform.h: squares of one class: where a proof by bounds succeeds, every place in the square has the
 * class of its middle, to the bit of what invented_surfaces finds. */
#ifndef TERRAIN_INVENTED_UNIFORM_H
#define TERRAIN_INVENTED_UNIFORM_H

#include "terrain/elevation/elevation.h"
#include "terrain/invented/invented.h"

/* A square, axes east and north. */
typedef struct UniformSquare {
    double x_m, y_m, side_m; /* south-west corner; side at most 8 */
} UniformSquare;

/* Whether all its places are proven to be of one class; false: not proven. Some 2 us. Of 4 m squares among fields: most
 * that lie 5 m from a border, off ways and off the edges of wild patches (tests/terrain/test_surface_cells.c). */
bool invented_uniform(const InventedGround *ground, const Elevation *elevation, const UniformSquare *square);

#endif
