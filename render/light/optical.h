/* render/light/optical.h: reflected sun and sky at the aperture. */
#ifndef RENDER_LIGHT_OPTICAL_H
#define RENDER_LIGHT_OPTICAL_H

#include "render/air/air.h"
#include "render/scene/hits.h"

/* channel: optical_channel_b .. optical_channel_nir. material: row of each hit (0 for sky). texture: reflectance of
 * the ground in this channel over its material's, 1 elsewhere. d_enu: the eye rays' directions. sun: share of the
 * direct sun that arrives, 0 .. 1; NULL: all of it. around_w_m2: irradiance of each hit from sky and surroundings
 * (render/light/hemisphere.h); NULL: sky and ground by the share of each that the surface faces. veils: of this
 * band; facing: of these hits; either NULL: computed here. out: W/(m2 sr) [hits->count]. Frames use the faster form
 * of render/light/surface_light.h, which is tested against this one. */
void optical_shade(float *out, int channel, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *texture, const float *sun,
                   const float *around_w_m2, const AirPaths *veils, const Facing *facing);

/* One ray that met nothing: ground beyond the terrain's edge, or sky. ground_w_m2: optical_ground_w_m2. */
float optical_beyond(int channel, const Air *air, double ground_w_m2, const double d_enu[3], const AirPaths *veils,
                     int hit);

/* Radiant exitance of level, sunlit ground of the mean land, W/m2. */
double optical_ground_w_m2(int channel, const Air *air, const Materials *materials);

/* Radiance of white, level, diffuse ground in the open under this sun and sky, R G B, W/(m2 sr): the white balance
 * of displays. Needs an Air of these three bands. */
void optical_white(double w_m2_sr[3], const Air *air);

#endif
