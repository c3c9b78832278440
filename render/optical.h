/* render/optical.h: reflected sun and sky at the aperture. */
#ifndef RENDER_OPTICAL_H
#define RENDER_OPTICAL_H

#include "render/air.h"
#include "render/hits.h"

/* channel: optical_channel_b .. optical_channel_nir. material: row of each hit (0 for sky). texture: reflectance of the
 * ground in this channel over its material's, 1 elsewhere. d_enu: the eye rays' directions. shadow: 1 = no direct sun.
 * around_w_m2: what sky and surroundings send to each hit (render/gather.h); NULL: sky and ground by the share of each
 * that the surface faces. veils: of this band; facing: of these hits; either NULL: asked for here. list: the hits to
 * shade, NULL: all. out: W/(m2 sr) [hits->count]. Ground has a quicker way (render/ground_light.h), for which this is
 * the measure. */
void optical_shade(float *out, int channel, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *texture, const uint8_t *shadow,
                   const float *around_w_m2, const Veils *veils, const Facing *facing, const HitList *list);

/* What level, sunlit ground of the mean land sends up, W/m2. */
double optical_ground_w_m2(int channel, const Air *air, const Materials *materials);

#endif
