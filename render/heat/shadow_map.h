/* render/heat/shadow_map.h: where relief and standing plants shade the ground, at every half hour of a day.
 *
 * A grid over the finest level of the terrain. For each direction to the sun the height below which it is shaded is
 * carried from cell to cell away from the sun (one pass over the grid, straight between two cells of the row before);
 * among plants, the direct light that their leaves let through is added up along the ray. Shares of a cell, so that edges
 * are as soft as a cell is wide: narrower shadows, of single trunks and boulders, are not in it. */
#ifndef RENDER_HEAT_SHADOW_MAP_H
#define RENDER_HEAT_SHADOW_MAP_H

#include "terrain/elevation/elevation.h"

typedef struct ShadowMap ShadowMap;

/* Plants of a place: leaf area index between base and top over the ground, 0: none; and the share of an even sky that
 * reaches the ground. */
typedef struct ShadowStand {
    float leaf_area, base_m, top_m, open;
} ShadowStand;
typedef void ShadowPlants(ShadowStand *out, const void *user, double x_m, double y_m);

enum { shadow_most_slots = 48, shadow_most_cells = 4000000 };

/* cell_m: made larger where the grid would have more than shadow_most_cells. d_enu: towards the sun, d_enu[2] > 0. plants:
 * NULL: none. pool: NULL: one thread; the same bits either way. */
Status shadow_map_create(ShadowMap **out, const Elevation *elevation, double cell_m, int slots,
                         float d_enu[3][shadow_most_slots], ShadowPlants *plants, const void *user, Pool *pool);
void   shadow_map_destroy(ShadowMap *map); /* accepts NULL */
/* Shares in the shade at a place, of 255, shadow[slots, padded to a multiple of 8 with 0]; and the share of its sky that
 * is open past plants. Beyond the grid: open. */
void   shadow_map_at(uint8_t shadow[shadow_most_slots], double *open, const ShadowMap *map, double x_m, double y_m);
size_t shadow_map_bytes(const ShadowMap *map);
double shadow_map_cell_m(const ShadowMap *map);

#endif
