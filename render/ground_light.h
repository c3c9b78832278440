/* render/ground_light.h: what the ground sends to the eye in all bands, eight hits at a time.
 *
 * The same light as render/optical.c and thermal.c give (without loss: no term is left out), in float, from tables that
 * hold all bands of a place side by side: what depends on the hit alone is found once for all bands. Within 3e-5 of
 * those of the brightest term (tests/render/test_ground_light.c). */
#ifndef RENDER_GROUND_LIGHT_H
#define RENDER_GROUND_LIGHT_H

#include "render/air.h"
#include "render/hits.h"

enum { ground_light_bands = 8 }; /* AIR_BAND_COUNT and one to spare */

/* One Air's, for a frame. */
typedef struct GroundLight {
    const Air *air;
    float plane[air_plane_ups + 1][air_plane_azimuths + 1][ground_light_bands];    /* irradiance of the sky, W/m2 */
    float scattered[air_sky_ups + 1][air_sky_azimuths + 1][ground_light_bands];    /* sky in a mirror, as AirSky */
    float thermal[air_sky_ups + 1][ground_light_bands], around_sun[air_sky_angles + 2][ground_light_bands];
    float level_w_m2_sr[ground_light_bands], sun_w_m2[ground_light_bands];         /* level ground's radiance; the sun */
    float rho[SURFACE_COUNT][ground_light_bands];
    float gloss[SURFACE_COUNT][ground_light_bands];                                /* GlossValue */
    bool  any_sun, any_gloss[SURFACE_COUNT];
} GroundLight;

void ground_light_prepare(GroundLight *out, const Air *air, const Materials *materials);

/* A block's hits and what is known of them; those that are not of ground are left alone, or spoilt within the block. */
typedef struct GroundBlock {
    const Hits    *hits;
    const Rays    *rays;
    const float   *texture[AIR_BAND_COUNT];     /* of the optical bands: brightness over the class's */
    const float   *temp_k;                      /* thermal bands */
    const uint8_t *shadow;
    const float   *around_w_m2[AIR_BAND_COUNT]; /* gathered; NULL: sky and ground by what the slope sees of them */
    const Veils   *veils;                       /* [AIR_BAND_COUNT] */
} GroundBlock;

/* out: of the bands wanted, else NULL; [hits_capacity] each, W/(m2 sr). Fills all that is ground, and spoils the rest:
 * whoever shades that comes after. */
void ground_light_shade(float *const out[AIR_BAND_COUNT], const GroundLight *light, const GroundBlock *block);

#endif
