/* terrain/ground/surface_cells.h: surface classes of a landscape, remembered: which squares of a few metres are proven
 * to be of one class. Frames ask for the classes of the same ground over and over; where a square is proven, a place in
 * it costs a look-up. Which squares are remembered changes no class (tests/terrain/test_surface_cells.c). */
#ifndef TERRAIN_GROUND_SURFACE_CELLS_H
#define TERRAIN_GROUND_SURFACE_CELLS_H

#include "terrain/ground/landscape.h"

/* Of one landscape, whose posts and ways must not change any more. 1 MB; from any thread. */
typedef struct SurfaceCells SurfaceCells;

/* NULL without memory: nothing is remembered then. */
SurfaceCells *surface_cells_create(const Landscape *landscape);
void          surface_cells_destroy(SurfaceCells *cells); /* accepts NULL */

/* landscape_surfaces, to the bit. cells may be NULL, or of another landscape. */
void surface_cells_at(uint8_t *surface, SurfaceCells *cells, const Landscape *landscape, int count, const double *x_m,
                      const double *y_m);

#endif
