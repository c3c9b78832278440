/* render/light/sky_horizon_private.h: horizons on a grid, made by sky_horizon_make.c, asked by sky_horizon.c. */
#ifndef RENDER_LIGHT_SKY_HORIZON_PRIVATE_H
#define RENDER_LIGHT_SKY_HORIZON_PRIVATE_H

#include "render/light/sky_horizon.h"

enum { horizon_tile_side = 32, horizon_tile_cells = horizon_tile_side * horizon_tile_side };
static const double horizon_height_step_m = 0.25;

/* sin h of 255, the root of the mean square of the sector's directions, since level ground loses sin^2 of the light
 * that comes from there; steps of horizon_height_step_m. */
typedef struct HorizonCell {
    uint8_t slope[sky_horizon_sectors], height[sky_horizon_sectors];
    float   ground_m;
} HorizonCell;

struct SkyHorizons {
    double       x0_m, y0_m, cell_m;
    int          tiles_x, tiles_y, tiles;
    int         *tile_of; /* [tiles_x tiles_y]: -1: none */
    HorizonCell *cell;    /* [tiles][horizon_tile_cells] */
    double       wall_rho[optical_channel_count];
};

#endif
