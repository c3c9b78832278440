/* render/light/surface_light.h: radiance of ground and parts at the eye in all bands, eight hits at a time.
 *
 * The same terms as in render/light/optical.c and thermal.c, in float, from tables that hold all bands of a node
 * side by side: what depends on the hit alone is computed once for all bands. Within 3e-5 of those for surfaces as
 * rough as ground and flat paint, 1e-3 in the glint of a mirror (tests/render/test_surface_light.c). */
#ifndef RENDER_LIGHT_SURFACE_LIGHT_H
#define RENDER_LIGHT_SURFACE_LIGHT_H

#include "render/air/air.h"
#include "render/light/canopy.h"
#include "render/scene/hits.h"

enum { surface_light_bands = 8 }; /* AIR_BAND_COUNT and one to spare */

/* One Air's, for a frame. */
typedef struct SurfaceLight {
    const Air *air;
    float      plane[air_plane_ups + 1][air_plane_azimuths + 1][surface_light_bands]; /* as Air.plane_w_m2 */
    float      scattered[air_sky_ups + 1][air_sky_azimuths + 1][surface_light_bands]; /* sky in a mirror, as AirSky */
    float      thermal[air_sky_ups + 1][surface_light_bands], around_sun[air_sky_angles + 2][surface_light_bands];
    float      level_w_m2_sr[surface_light_bands], sun_w_m2[surface_light_bands]; /* level ground's radiance; the sun */
    float (*rho)[surface_light_bands], (*gloss)[surface_light_bands];             /* [materials]; GlossValue */
    float (*tau)[surface_light_bands]; /* [materials]; NULL: nothing lets light through */
} SurfaceLight;

/* STATUS_NO_MEMORY: of the arena, which owns the tables by material. */
Status surface_light_prepare(SurfaceLight *out, const Air *air, const Materials *materials, Arena *arena);

/* A block's hits and their inputs. */
typedef struct SurfaceBlock {
    const Hits     *hits;
    const Rays     *rays;
    const uint16_t *material;                 /* row of each hit; 0 for sky */
    const float    *texture[AIR_BAND_COUNT];  /* of the optical bands: brightness over the material's */
    const float    *temp_k;                   /* thermal bands */
    const float    *sun;                      /* share of the direct sun that arrives, 0 .. 1 */
    const float *around_w_m2[AIR_BAND_COUNT]; /* from hemisphere sampling; NULL: sky and ground by the slope alone. Of
                                               * leaves: of both sides, as HemisphereLight */
    const float *open[AIR_BAND_COUNT]; /* factor of the latter (render/light/sky_visibility.h); NULL: 1. Of leaves: of
                                        * both sides */
    /* factors in a mirror on level ground's radiance (hemisphere_below; NULL: 1) and on the sky's (mirror_sky_factor;
     * NULL: what around_w_m2 with below, or open, leaves for it). Without open and below: 1 */
    const float       *below[AIR_BAND_COUNT], *mirror_sky[AIR_BAND_COUNT];
    float             *mirror_sky_found[AIR_BAND_COUNT]; /* where the latter is left, of glossy hits; NULL: nowhere */
    const CanopyLight *canopy; /* of the optical bands, without around_w_m2; NULL: no plants near */
    const AirPaths    *veils;  /* [AIR_BAND_COUNT] */
} SurfaceBlock;

/* out: of the requested bands, else NULL; [hits_capacity] each, W/(m2 sr). Rows of rays that met nothing are undefined:
 * optical_beyond and thermal_beyond give those. */
void surface_light_shade(float *const out[AIR_BAND_COUNT], const SurfaceLight *light, const SurfaceBlock *block);

#endif
