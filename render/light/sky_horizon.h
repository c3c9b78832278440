/* render/light/sky_horizon.h: how much of the sky scenery leaves to ground and walls about it.
 *
 * On a grid over the ground about buildings, made once: the nearest wall, where one is within 12 m, as an upright
 * rectangle (its plane, edge and ends), and in each of eight sectors of azimuth the tangent of the horizon that the
 * rest makes, and how high above the ground what makes it is. A hit takes of it, by its normal and its height above the
 * ground, the share of the sky's light that arrives (the sky as bright everywhere), and the share that buildings fill,
 * which shine as a mean wall of buildings that faces that way does under the sun and sky of the moment: what lights its
 * foot is the ground before it, in its shadow, as if that had no ends, and with as little of the sky as the hit.
 * Between cells sin^2 of the horizon is linear, as is the light that level ground loses: of nearest walls, and of what
 * they leave, each by the share of a sector that they fill. Cost: four cells and two horizons a hit, and a wall for
 * each cell that has one; 3.5 s of one processor to make for 10,000 buildings in 6.5 km2.
 *
 * Error: the side of a building is known to an eighth of a metre (a quarter where buildings spread over more than 1 km,
 * half a cell where they do over more than 4 km); what stands behind the nearest wall's side is taken as if it stood in
 * it. Beside a wall without end: within 0.02 of the open sky's light on level ground, within 3 % of its light in the
 * last 3 m; 0.06 on a wall that faces it from 3 m and more (tests/render/test_sky_horizon.c); farther than 80 m nothing
 * hides. Sides of a house in the sun and in shade, and ground in its shadow, are within 2 % of a path tracer's
 * (tests/system/test_scenery_judge.sh). A neighbour's own colour and shadow are not in it. */
#ifndef RENDER_LIGHT_SKY_HORIZON_H
#define RENDER_LIGHT_SKY_HORIZON_H

#include "render/air/air.h"
#include "render/trace/scenery/scenery_tracer.h"
#include "terrain/elevation/elevation.h"

enum { sky_horizon_sectors = 8, sky_horizon_most_cells = 4 << 20 };

typedef struct SkyHorizons SkyHorizons;

/* *out NULL: there are no buildings. elevation, materials: the world's. STATUS_NO_MEMORY. */
Status sky_horizons_create(SkyHorizons **out, const SceneryTracer *tracer, const Elevation *elevation,
                           const Materials *materials, Pool *pool);
void   sky_horizons_destroy(SkyHorizons *horizons); /* accepts NULL */
size_t sky_horizons_bytes(const SkyHorizons *horizons);

/* Share of the open sky's light on a plane of this normal that arrives at a place, 0 .. 1; 1 away from buildings. */
double sky_horizon_share(const SkyHorizons *horizons, const double p_enu[3], const double n_enu[3]);

/* The light of a moment, by AirBand, W/m2: of sky and level ground as a plane that faces them alone has it, of walls
 * in the sun's absence, what of that sun and sky add by way of the ground before them, and of one that the sun meets
 * square; share of the level ground's that is the sun's. */
typedef struct SkyHorizonLight {
    float sky[8], level[8], wall[8], wall_by_sun[8], wall_by_sky[8], sunlit_wall[8], level_sun[8];
    float sun_enu[3];
} SkyHorizonLight;
/* level_w_m2: exitance of open, level ground. */
void sky_horizon_light(SkyHorizonLight *out, const SkyHorizons *horizons, const Air *air,
                       const double level_w_m2[AIR_BAND_COUNT]);
/* Multiplies factors [AIR_BAND_COUNT][hits_capacity] on the light that the tilt alone gives, for hits on ground and
 * scenery, in these bands; below (hemisphere_below), by what of the ground before a wall its own shadow leaves: returns
 * whether any is less than 1. */
bool sky_horizon_open(float (*factor)[hits_capacity], float (*below)[hits_capacity], const SkyHorizons *horizons,
                      const SkyHorizonLight *light, unsigned air_bands, const Hits *hits);

#endif
