/* render/light/sky_horizon_private.h: horizons on a grid, made by sky_horizon_make.c, asked by sky_horizon.c. */
#ifndef RENDER_LIGHT_SKY_HORIZON_PRIVATE_H
#define RENDER_LIGHT_SKY_HORIZON_PRIVATE_H

#include "render/light/sky_horizon.h"

enum { horizon_tile_side = 32, horizon_tile_cells = horizon_tile_side * horizon_tile_side };
static const double horizon_height_step_m = 0.25, horizon_away_step_m = 0.05, horizon_wall_step_m = 0.1;

/* The horizon about a place on the ground, in two parts: the nearest wall, where one is near, as the upright rectangle
 * that it is, since close to it all changes within less than a cell; and in each sector what else there is.
 * slope: sin h of 255, the root of the mean square of the sector's directions, since level ground loses sin^2 of the
 * light that comes from there; height of what makes the horizon, with the wall, in steps of horizon_height_step_m. */
typedef struct HorizonCell {
    uint8_t slope[sky_horizon_sectors], height[sky_horizon_sectors];
    float   ground_m;
    uint8_t covered;
    uint8_t wall_facing;           /* azimuth of its normal, 256 of a turn */
    uint8_t wall_away;             /* of its plane, horizon_away_step_m */
    uint8_t wall_rise;             /* above ground_m, horizon_wall_step_m; 0: no wall is near */
    uint8_t wall_left, wall_right; /* how far it goes, as seen from here, horizon_wall_step_m; 255: on */
    uint8_t spare[2];              /* eight octets from `covered` on */
} HorizonCell;

struct SkyHorizons {
    double       x0_m, y0_m, cell_m;
    int          tiles_x, tiles_y, tiles;
    int         *tile_of; /* [tiles_x tiles_y]: -1: none */
    HorizonCell *cell;    /* [tiles][horizon_tile_cells] */
    double       wall_rho[optical_channel_count];
    float        facing_enu[256][2]; /* by HorizonCell.wall_facing */
};

#endif
