/* render/light/sky_visibility.h: how much of the open light reaches places near vehicles and buildings: contact shadows.
 *
 * By its tilt alone a surface sees the whole sky above it and level, sunlit ground below. Beside a vehicle, under a
 * hull and on a side whose own shadow lies before it that is wrong by factors. Here directions from a set of places
 * find what stands there instead (hemisphere_change), and a hit takes the factor interpolated between the places about it:
 *
 *   ground    places of a square lattice that is fixed to the ground, finer where they disagree and never finer than
 *             the picture shows; computed when a hit needs them, kept for the frame
 *   entities  what the eye sees of each on a grid over its box on the image, 2.75 px apart, at least 3 x 3 and at most
 *             48 x 48, computed before the tiles; a hit takes those about it that face its way. The grid moves with the
 *             entity
 *
 * A place's answer depends on nothing but the scene and the view, so it is the same whichever thread computes it. The
 * ground is treated only within reach of an entity: beyond, it hides less than 2 % of a level plane's sky. Terrain that
 * hides the sky is not seen, and mirrors see none of this.
 *
 * Error against hemisphere_light, means of 5 x 5 px (tests/sensor/test_sky_visibility.c): 2 to 4 % rms on shadowed ground,
 * 5 to 13 % where less than 40 % of the open light comes, 4 to 13 % on sides away from the sun. */
#ifndef RENDER_LIGHT_SKY_VISIBILITY_H
#define RENDER_LIGHT_SKY_VISIBILITY_H

#include "render/light/hemisphere.h"
#include "render/scene/view.h"
#include "terrain/landscape/landscape.h"

typedef struct SkyVisibility SkyVisibility; /* a frame's; threads share it */
typedef struct SkyWorker     SkyWorker;     /* a thread's own */

typedef struct SkyVisibilityScene {
    HemisphereScene      gather;
    const Landscape *landscape;   /* NULL: no ground */
    const View      *view;
    const double   (*box_px)[4];  /* [entities]: on the image, as TargetPixels.projected_box; NaN: not there */
    unsigned         air_bands;   /* 1 << AirBand: all that the frame may ask for */
    unsigned         skips_off;
    int              hidden_entity; /* whose parts the eye does not see; -1: none */
} SkyVisibilityScene;

/* The scene's parts must outlive it. STATUS_NO_MEMORY: of the arena. */
Status sky_visibility_create(SkyVisibility **out, const SkyVisibilityScene *scene, Arena *arena);
Status sky_worker_create(SkyWorker **out, const SkyVisibility *v, Arena *arena);

/* Asks the places on entities, in so many tasks for a pool, all before the first sky_visibility_open. */
int  sky_visibility_tasks(const SkyVisibility *v);
void sky_visibility_task(SkyVisibility *v, SkyWorker *worker, int task);

typedef struct SkyOpen {
    float factor[AIR_BAND_COUNT][hits_capacity]; /* of the light that the tilt alone gives; 1 where nothing is near */
} SkyOpen;

/* False: nothing near any of the hits, and nothing written; else the factors of the frame's bands. */
bool sky_visibility_open(SkyOpen *out, const SkyVisibility *v, SkyWorker *worker, const Hits *hits,
                         VisibilityCounters *counters);

#endif
