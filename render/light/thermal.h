/* render/light/thermal.h: surface temperatures, and emitted + reflected radiance at the aperture. */
#ifndef RENDER_LIGHT_THERMAL_H
#define RENDER_LIGHT_THERMAL_H

#include "entities/table/snapshot.h"
#include "render/air/air.h"
#include "render/light/part_temps.h"
#include "render/scene/hits.h"
#include "render/scene/view.h"

/* Temperature of each hit, K: parts from the patches of the snapshot (parts; NULL: as warm as the air), ground by what the hours
 * before left in it (air->heat; NULL: that of the air), noise (warmth_k) and photograph (its brightness over the class's;
 * 1: none), leaves by the sun that reaches them now (sun: share, 0 .. 1; NULL: as open as their crown), all over the air of
 * their own height; snow no warmer than 273.15 K, water no colder than 271.35 K. Sky: NaN. */
void thermal_temperature(float *temp_k, const Air *air, const Materials *materials, const PartTemps *parts,
                         const Hits *hits, const uint16_t *material, const float *sun, const float *photo,
                         const float *warmth_k);

/* band: BAND_MWIR or BAND_LWIR. sun: share of the direct sun that arrives, 0 .. 1, in MWIR; NULL: all. around_w_m2:
 * irradiance of each hit from sky and surroundings (render/light/hemisphere.h); NULL: sky and ground by the tilt
 * alone. veils: of this band and these temperatures; facing: of these hits; either NULL: computed here. out: W/(m2
 * sr). Frames use the faster form of render/light/surface_light.h, which is tested against this one. */
void thermal_shade(float *out, Band band, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *temp_k, const float *sun,
                   const float *around_w_m2, const AirPaths *veils, const Facing *facing);
/* One ray that met nothing: ground beyond the terrain's edge, or sky. */
float thermal_beyond(Band band, const Air *air, const double d_enu[3], const AirPaths *veils, int hit);

#endif
