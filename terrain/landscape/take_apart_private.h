/* terrain/landscape/take_apart_private.h: the steps of surface_take_apart. Private to terrain/landscape. */
#ifndef TERRAIN_LANDSCAPE_TAKE_APART_PRIVATE_H
#define TERRAIN_LANDSCAPE_TAKE_APART_PRIVATE_H

#include "terrain/landscape/take_apart.h"

/* Blocks of size x size cells, about 2 m, on which the ground is found. The first block may begin before the window:
 * blocks lie on the whole model's lattice, `left` and `below` cells of the first ones are outside. */
typedef struct Blocks {
    int    nx, ny;        /* blocks; both multiples of the coarsest level of the filling */
    int    size;          /* cells */
    int    left, below;   /* cells */
    double block_m;
} Blocks;

/* Least or greatest of the (2 radius + 1)^2 square about each value, in place; clipped at the edges. */
Status take_apart_extreme(float *value, int nx, int ny, int radius, bool greatest);

/* Fills NAN from its surroundings: harmonic within the blocks that hold values or are near them, the nearest coarse
 * mean beyond. Returns with no NAN unless all is NAN. */
Status take_apart_fill(float *value, const Blocks *blocks);

/* Bare ground and, per cell, whether the surface is ground there. `surface_m` [ny][nx], cleaned; first_radius_m: of the
 * smallest opening. */
Status take_apart_ground(float *bare_m, uint8_t *is_ground, const SurfaceModel *model, const float *surface_m,
                         double first_radius_m);

/* Connected components, edges touching: label[c] is the first cell of c's component, area[label[c]] its cells. Both are
 * allocated, [ny][nx]; NULL on failure. `joins` says whether the neighbours c and d belong together. */
typedef bool JoinCells(const void *user, size_t c, size_t d);
Status take_apart_components(int32_t **label, int32_t **area, int nx, int ny, JoinCells *joins, const void *user);

/* Kinds of the cells from the height of `surface_m` (cleaned) above bare ground. */
Status take_apart_kinds(SurfaceParts *out, const SurfaceModel *model, const float *surface_m);

/* Roofs of the cells that are CELL_BUILDING. */
Status take_apart_roofs(SurfaceParts *out, const SurfaceModel *model, const float *surface_m);

/* Crowns of the cells that are CELL_TREE. */
Status take_apart_crowns(SurfaceParts *out, const SurfaceModel *model, const float *surface_m);

#endif
