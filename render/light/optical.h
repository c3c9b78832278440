/* render/light/optical.h: reflected sun and sky at the aperture. */
#ifndef RENDER_LIGHT_OPTICAL_H
#define RENDER_LIGHT_OPTICAL_H

#include "render/air/air.h"
#include "render/scene/hits.h"

/* Light that a mirror shows in place of the open sky and of level ground: of each half of what a surface sees its mean.
 * A mirror near things therefore shows how bright they are, not their shape. Factors [hits->count]; NULL: 1. */
typedef struct MirrorLight {
    const float *sky, *below;
} MirrorLight;

/* Factor on the sky in a mirror: irradiance from above the horizontal over that of the open sky on the same plane, 0 ..
 * 100. level_w_m2: of the open sky on level ground; a surface that sees less than a sixteenth of the sky has hardly a
 * direction to judge it by. */
static const double  mirror_least_share = 1.0 / 16;
static inline double mirror_sky_factor(double sky_w_m2, double open_w_m2, double level_w_m2)
{
    const double least_w_m2 = fmax(mirror_least_share * level_w_m2, 1e-30);
    return clamp(1 + (sky_w_m2 - open_w_m2) / fmax(open_w_m2, least_w_m2), 0, 100);
}

/* channel: optical_channel_b .. optical_channel_nir. material: row of each hit (0 for sky). texture: reflectance of
 * the ground in this channel over its material's, 1 elsewhere. d_enu: the eye rays' directions. sun: share of the
 * direct sun that arrives, 0 .. 1; NULL: all of it. around_w_m2: irradiance of each hit from sky and surroundings
 * (render/light/hemisphere.h); NULL: sky and ground by the share of each that the surface faces. mirror: NULL: all
 * open. veils: of this band; facing: of these hits; either NULL: computed here. out: W/(m2 sr) [hits->count]. Frames
 * use the faster form of render/light/surface_light.h, which is tested against this one. */
void optical_shade(float *out, int channel, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *texture, const float *sun,
                   const float *around_w_m2, const MirrorLight *mirror, const AirPaths *veils, const Facing *facing);

/* One ray that met nothing: ground beyond the terrain's edge, or sky. ground_w_m2: optical_ground_w_m2. */
float optical_beyond(int channel, const Air *air, double ground_w_m2, const double d_enu[3], const AirPaths *veils,
                     int hit);

/* Radiant exitance of level, sunlit ground of the mean land, W/m2. */
double optical_ground_w_m2(int channel, const Air *air, const Materials *materials);

/* Radiance of white, level, diffuse ground in the open under this sun and sky, R G B, W/(m2 sr): the white balance
 * of displays. Needs an Air of these three bands. */
void optical_white(double w_m2_sr[3], const Air *air);

#endif
