/* render/sky_visibility.h: how much of the open light reaches places near vehicles and buildings: contact shadows.
 *
 * By its tilt alone a surface sees the whole sky above it and level, sunlit ground below. Beside a vehicle, under a hull
 * and on a side whose own shadow lies before it that is wrong by factors. Here places are asked in many directions what
 * stands there instead (gather_change), and a hit takes the factor of the places about it:
 *
 *   ground    places of a square lattice that is fixed to the ground, finer where they disagree and never finer than
 *             the picture shows; asked when a hit needs them, kept for the frame
 *   entities  what the eye sees of each on a grid over its box on the image, about 5 px apart and never fewer than 3 x 3,
 *             asked before the tiles; a hit takes those about it that face its way. The grid moves with the entity
 *
 * A place's answer depends on nothing but the scene and the view, so it is the same whichever thread asks first. Only
 * within reach of an entity (beyond, it hides less than 1 % of a level plane's sky) the ground is looked at. Terrain that
 * hides the sky is not seen, and mirrors see none of this. How right: tests/sensor/test_sky_visibility.c against
 * gather_light, tests/system/test_sky_mitsuba.py against another path tracer. */
#ifndef RENDER_SKY_VISIBILITY_H
#define RENDER_SKY_VISIBILITY_H

#include "render/gather.h"
#include "render/view.h"
#include "terrain/landscape.h"

typedef struct SkyVisibility SkyVisibility; /* a frame's; threads share it */
typedef struct SkyWorker     SkyWorker;     /* a thread's own */

typedef struct SkyVisibilityScene {
    GatherScene      gather;
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
    float factor[AIR_BAND_COUNT][hits_capacity]; /* of the light that the tilt alone would give; 1 where nothing is near */
} SkyOpen;

/* False: nothing near any of the hits, and nothing written; else the factors of the frame's bands. */
bool sky_visibility_open(SkyOpen *out, const SkyVisibility *v, SkyWorker *worker, const Hits *hits,
                         VisibilityCounters *counters);

#endif
