/* render/light/sky_horizon.h: how much of the sky scenery leaves to ground and walls about it.
 *
 * On a grid over the ground about buildings, made once: the tangent of the horizon that they make in each of eight
 * sectors of azimuth, and how high above the ground what makes it is. A hit takes of it, by its normal and its height
 * above the ground, the share of the sky's light that arrives (the sky as bright everywhere), and the share that
 * buildings fill, which shine as a mean wall of that side does under the sun and sky of the moment. Before a wall that
 * the sun does not meet the ground lies in the shadow of its building, as if it had no ends. Between four cells sin^2 of the horizon is linear, as is the light that
 * level ground loses. Cost: four cells and one horizon a hit.
 *
 * Error: sectors and cells are steps; the side of a building is known to a quarter of a metre (to half a cell where the
 * grid of heights would be larger than its memory, about 2 km square), and light is linear between cells 2 m apart, so
 * it is least certain close to a wall: ground in the shadow has 15 % too much in the first 0.7 m, 4 % at 2 m. Beside a
 * wall without end, from a third of its height to three heights away: within 0.06 of the open sky's light on level
 * ground, 0.15 on a wall that faces it, 0.19 on its upper parts (tests/render/test_sky_horizon.c); farther than 80 m
 * nothing hides. Sides of a house in the sun and in shade are within 2 % of a path tracer's, ground in its shadow
 * within 4.5 % (tests/system/test_scenery_judge.sh). A neighbour's own colour and shadow are not in it. */
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
 * in the sun's absence, what of that the sun adds by way of the ground before them, and of one that the sun meets
 * square; share of the level ground's that is the sun's. */
typedef struct SkyHorizonLight {
    float sky[8], level[8], wall[8], wall_by_sun[8], sunlit_wall[8], level_sun[8];
    float sun_enu[3];
    float shaded[sky_horizon_sectors]; /* of the ground before the wall of a building that is there, what that shades */
} SkyHorizonLight;
/* level_w_m2: exitance of open, level ground. */
void sky_horizon_light(SkyHorizonLight *out, const SkyHorizons *horizons, const Air *air,
                       const double level_w_m2[AIR_BAND_COUNT]);
/* Multiplies factors [AIR_BAND_COUNT][hits_capacity] on the light that the tilt alone gives, for hits on ground and
 * scenery, in these bands. */
void sky_horizon_open(float (*factor)[hits_capacity], const SkyHorizons *horizons, const SkyHorizonLight *light,
                      unsigned air_bands, const Hits *hits);

#endif
