/* terrain/bare_earth/take_apart_private.h: the steps of take_apart_surface. */
#ifndef TERRAIN_BARE_EARTH_TAKE_APART_PRIVATE_H
#define TERRAIN_BARE_EARTH_TAKE_APART_PRIVATE_H

#include "terrain/bare_earth/take_apart.h"

/* Blocks of size x size cells, about 2 m, on which the ground is found. The first block may begin before the window:
 * blocks lie on the whole model's lattice, `left` and `below` cells of the first ones are outside. */
typedef struct Blocks {
    int    nx, ny;      /* blocks; both multiples of the coarsest level of the filling */
    int    size;        /* cells */
    int    left, below; /* cells */
    double block_m;
} Blocks;

/* Fills NAN from its surroundings: harmonic within the blocks that hold values or are near them, the nearest coarse
 * mean beyond. Returns with no NAN unless all is NAN. */
Status take_apart_fill(float *value, const Blocks *blocks);

/* Bare ground and, per cell, whether the surface is ground there. `surface_m` [ny][nx], cleaned; first_radius_m: of the
 * smallest opening. */
Status take_apart_ground(float *bare_m, uint8_t *is_ground, const SurfaceModel *model, const float *surface_m,
                         double first_radius_m);

/* Finds the kinds of cells from the height of `surface_m` (cleaned) above bare ground. */
Status take_apart_kinds(SurfaceParts *out, const SurfaceModel *model, const float *surface_m);

#endif
