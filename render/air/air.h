/* render/air/air.h: the air before an eye, per frame: daylight, the sky from where it is, and the path to what it sees.
 *
 * Paths come from the tables of render/air/atmosphere.h, collapsed once a frame for one eye, one sun and one visibility
 * into tables small enough to ask for every sample. tests/render/test_air.c measures what that costs in accuracy. */
#ifndef RENDER_AIR_AIR_H
#define RENDER_AIR_AIR_H

#include "render/air/daylight.h"
#include "render/scene/view.h"

typedef struct AirTable AirTable; /* paths from this eye */

typedef struct Air {
    Daylight  light;
    AirSky    sky_eye[AIR_BAND_COUNT];      /* from the eye */
    double    sun_eye_w_m2[AIR_BAND_COUNT]; /* direct sunlight at the eye: what its disc is seen by */
    double    eye_height_m;
    AirTable *table;                        /* in the arena of air_at; NULL: even air, see air_even */
    double    even_per_m;                   /* extinction of even air, whose radiance is that of its sky */
} Air;

/* What an eye asks for. */
typedef struct AirEye {
    double      height_m; /* clamped to the tables */
    unsigned    bands;    /* 1 << AirBand, those that are asked for; air_path answers no others */
    const View *view;     /* where to, so that only its azimuths are filled in; NULL: all round */
} AirEye;

/* weather->air_temp_k: NaN for the model's own; the Daylight's is then filled in. pool: may be NULL. The tables live in
 * the arena. STATUS_NO_MEMORY when that is out. 1 to 2 ms of one core for five bands, 0.4 for LWIR alone; over the pool. */
Status air_at(Air *out, const AirSource *source, const Weather *weather, const Sun *sun, const AirEye *eye, Pool *pool,
              Arena *arena);

/* A world with answers on paper: sun_w_m2 from sun_d_enu, everything else, path included, of the one radiance
 * sky_w_m2_sr[band]; even_per_m 0: nothing in between. No tables, no arena. */
void air_even(Air *out, const double sun_d_enu[3], double sun_w_m2, const double sky_w_m2_sr[AIR_BAND_COUNT],
              double even_per_m, const PlanckTable *mwir, const PlanckTable *lwir);

/* What the path does to what is behind it: seen = emitted * transmittance + sunlight reflected * sun_transmittance +
 * air's light reflected * air_transmittance + added. Outside the thermal bands the three are one; at night, and always
 * in LWIR, sun_transmittance is the air's.
 * A ray that met nothing ends on the ground beyond the terrain's edge, when it goes down far enough to reach the round
 * Earth (its range is then in range_m), or in the sky: transmittance 0, and added is the sky's radiance. */
typedef struct AirPaths {
    float transmittance[hits_capacity], sun_transmittance[hits_capacity], air_transmittance[hits_capacity];
    float added_w_m2_sr[hits_capacity];
    float range_m[hits_capacity];       /* of the path; INFINITY: sky */
} AirPaths;

/* bands: 1 << AirBand, those of out to fill, of the AirEye's; asking for several at once costs less, and gives the same
 * bits. temp_k: of what emits, [hits->count], NaN where nothing does; NULL: nothing does (transmittance: the sun's). */
void air_paths_of(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const Hits *hits, const Rays *rays,
                  const float *temp_k);
/* The same answers asked of the atmosphere path by path, no table between: air_direct.c. A microsecond or two a ray.
 * tables: what air_paths_of said of these rays. Even air: the tables' own. */
void air_paths_directly(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const Hits *hits, const Rays *rays,
                        const float *temp_k, const AirPaths tables[AIR_BAND_COUNT]);
/* One band. */
void air_path(AirPaths *out, const Air *air, AirBand band, const Hits *hits, const Rays *rays, const float *temp_k);

#endif
