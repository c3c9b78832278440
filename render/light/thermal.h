/* render/light/thermal.h: surface temperatures, and emitted + reflected radiance at the aperture. */
#ifndef RENDER_LIGHT_THERMAL_H
#define RENDER_LIGHT_THERMAL_H

#include "render/heat/scenery_heat.h"
#include "render/heat/vehicle_heat.h"
#include "render/trace/visibility/visibility.h"
#include "entities/table/snapshot.h"
#include "render/air/air.h"
#include "render/light/optical.h"
#include "render/scene/hits.h"
#include "render/scene/view.h"
#include "render/materials/materials.h"

/* Where the temperatures of entities' surfaces come from, in one frame. */
typedef struct PartTemps {
    const Snapshot   *snapshot;
    const PatchSet   *patches;    /* all models of snapshot.patch_k have been needed */
    const Visibility *visibility; /* of the same snapshot: poses */
} PartTemps;

/* Temperature of each hit, K: parts from the patches of the snapshot (parts; NULL: as warm as the air), ground by what
 * the hours before left in it (air->heat; NULL: that of the air), noise (warmth_k) and photograph (its brightness over
 * the class's; 1: none), leaves by the sun that reaches them now (sun: share, 0 .. 1; NULL: as open as their crown),
 * all over the air of their own height; snow no warmer than 273.15 K, water no colder than 271.35 K. Sky: NaN. */
void thermal_temperature(float *temp_k, const Air *air, const Materials *materials, const PartTemps *parts,
                         const Hits *hits, const uint16_t *material, const float *sun, const float *photo,
                         const float *warmth_k);

/* Where that of a hit of scenery comes from (hits of kind hit_scenery); false: it is as warm as the air. */
bool thermal_scenery_of(SceneryHeatOf *out, const Air *air, const Visibility *visibility, const Hits *hits, int i);

/* band: BAND_MWIR or BAND_LWIR. sun: share of the direct sun that arrives, 0 .. 1, in MWIR; NULL: all. around_w_m2:
 * irradiance of each hit from sky and surroundings (render/light/hemisphere.h); NULL: sky and ground by the tilt
 * alone. mirror: NULL: all open. veils: of this band and these temperatures; facing: of these hits; either NULL:
 * computed here. out: W/(m2 sr). Frames use the faster form of render/light/surface_light.h, which is tested against
 * this one. */
void thermal_shade(float *out, Band band, const Air *air, const Materials *materials, const Hits *hits,
                   const Rays *rays, const uint16_t *material, const float *temp_k, const float *sun,
                   const float *around_w_m2, const MirrorLight *mirror, const AirPaths *veils, const Facing *facing);
/* One ray that met nothing: ground beyond the terrain's edge, or sky. */
float thermal_beyond(Band band, const Air *air, const double d_enu[3], const AirPaths *veils, int hit);

/* ---- leaves ---------------------------------------------------------------------------------- */

/* A leaf: the steady balance of what it absorbs of sun and sky with what it radiates, gives to the air and transpires;
 * leaves follow within a minute. open: share of the sky that its place in the crown receives, lit: of the direct sun, 0
 * .. 1: by the ray that the picture's light uses too. Leaves of a place have every tilt: half of the direct sun on
 * average. Its two sides together face all of the sky, whatever its tilt.
 *
 *   boundary layer  0.135 sqrt(wind / d) mol/(m2 s) each side, d = 0.72 of a leaf 5 cm wide, 1.4 in turbulent wind
 *   stomata         0.2 mol/(m2 s) in full sun, a twentieth in the dark: broad leaves well supplied with water
 * Source: Campbell & Norman, An Introduction to Environmental Biophysics (1998), chapters 7 and 14. Linear about the
 * air's temperature: within 0.1 K of the full balance, for leaves 2 K below to 5 K above the air (test_plant_heat.c).
 */
double thermal_leaf_k(const Daylight *light, const Material *m, double air_temp_k, double open, double lit);

#endif
