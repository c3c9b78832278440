/* render/air/air.h: the air of one eye, per frame: daylight, the sky from its height, and the air paths to what it
 * sees.
 *
 * Paths come from the tables of render/air/atmosphere.h, reduced once a frame for one eye, one sun and one
 * visibility to tables small enough for a look-up per sample. tests/render/test_air.c measures the loss of accuracy. */
#ifndef RENDER_AIR_AIR_H
#define RENDER_AIR_AIR_H

#include "render/air/daylight.h"
#include "render/scene/view.h"

typedef struct AirTable AirTable; /* paths from this eye */

typedef struct Air {
    Daylight  light;
    AirSky    sky_eye[AIR_BAND_COUNT];      /* from the eye */
    double    sun_eye_w_m2[AIR_BAND_COUNT]; /* direct irradiance at the eye: gives the radiance of the sun's visible
                                             * disc */
    double    eye_height_m;
    AirTable *table;                        /* in the arena of air_at; NULL: homogeneous atmosphere, see air_even */
    const struct HeatScene *heat;           /* of the ground (render/heat/heat_scene.h); NULL: all of it as warm as the air */
    double    even_per_m;                   /* extinction of a homogeneous atmosphere, whose radiance is that of its
                                             * sky */
} Air;

/* Parameters of an eye. */
typedef struct AirEye {
    double      height_m; /* clamped to the tables */
    unsigned    bands;    /* 1 << AirBand, the requested bands; air_path gives no others */
    const View *view;     /* view, so that only its azimuths are computed; NULL: all round */
} AirEye;

/* weather->air_temp_k: NaN for the model's own; the Daylight's is then filled in. pool: may be NULL. The tables are
 * in the arena. STATUS_NO_MEMORY when that is out. 1 to 2 ms of one core for five bands, 0.4 for LWIR alone; over
 * the pool. */
Status air_at(Air *out, const AirSource *source, const Weather *weather, const Sun *sun, const AirEye *eye, Pool *pool,
              Arena *arena);

/* A world with closed-form results: sun_w_m2 from sun_d_enu, everything else, path included, of the one radiance
 * sky_w_m2_sr[band]; even_per_m 0: a vacuum. No tables, no arena. */
void air_even(Air *out, const double sun_d_enu[3], double sun_w_m2, const double sky_w_m2_sr[AIR_BAND_COUNT],
              double even_per_m, const PlanckTable *mwir, const PlanckTable *lwir);

/* Transmittance and path radiance of the air in front of a surface: seen = emitted * transmittance + sunlight
 * reflected * sun_transmittance + air's light reflected * air_transmittance + added. Outside the thermal bands the
 * three are one; at night, and always in LWIR, sun_transmittance is the air's. A ray without a hit ends on the
 * ground beyond the terrain's edge, when it goes down far enough to reach the round Earth (its range is then in
 * range_m), or in the sky: transmittance 0, and added is the sky's radiance. */
typedef struct AirPaths {
    float transmittance[hits_capacity], sun_transmittance[hits_capacity], air_transmittance[hits_capacity];
    float added_w_m2_sr[hits_capacity];
    float range_m[hits_capacity];       /* of the path; INFINITY: sky */
} AirPaths;

/* bands: 1 << AirBand, those of out to fill, of the AirEye's; several bands in one call cost less, with the same
 * bits. temp_k: of the emitters, [hits->count], NaN where nothing emits; NULL: nothing emits (transmittance: the
 * sun's). */
void air_paths_of(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const Hits *hits, const Rays *rays,
                  const float *temp_k);
/* The same, computed from the atmosphere path by path, without the frame's tables: air_direct.c. A microsecond or
 * two a ray. tables: the result of air_paths_of for these rays. Homogeneous atmosphere: the same as with tables. */
void air_paths_directly(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const Hits *hits, const Rays *rays,
                        const float *temp_k, const AirPaths tables[AIR_BAND_COUNT]);
/* One band. */
void air_path(AirPaths *out, const Air *air, AirBand band, const Hits *hits, const Rays *rays, const float *temp_k);

#endif
