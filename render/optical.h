/* render/optical.h: reflected sun and sky at the aperture. */
#ifndef RENDER_OPTICAL_H
#define RENDER_OPTICAL_H

#include "render/air.h"
#include "render/hits.h"

/* material: row of each hit (0 for sky). texture: relative brightness of the ground, 1 elsewhere.
 * d_enu: the eye rays' directions. shadow: 1 = no direct sun. out: W/(m2 sr) [hits->count]. */
void optical_shade(float *out, int channel, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *texture, const uint8_t *shadow);

#endif
