/* render/light/sky_visibility.h: share of the open-sky light that reaches points near vehicles and buildings: contact
 * shadows.
 *
 * By its tilt alone a surface would receive the whole sky above it and level, sunlit ground below. Beside a vehicle,
 * under a hull and on a side that faces the vehicle's own shadow that is wrong by factors. Here hemisphere sampling at
 * a set of sample points finds the obstructions (hemisphere_change), and a hit takes the factor interpolated between
 * the points about it:
 *
 *   ground    points of a square lattice that is fixed to the ground, finer where their values differ and never finer
 *             than the picture's resolution; computed when a hit needs them, cached for the frame
 *   entities  the surface of each on a grid over its box, some 2.75 px apart, at least 3 x 3 and at most 48 x 48,
 *             computed when a hit first needs one of them, by all threads that do; a hit takes those about it that face
 *             its way. The grid stands on the body, across the middle of a bin of aspects (5 to 10 degrees) and at the
 *             nearest of spacings a half octave apart, so that it is the same while the eye stays within these. On
 *             entities too large for that (132 px) it lies over the box on the image
 *
 * The value of a point depends on the scene and the view only, so it is the same whichever thread computes it. What its
 * paths meet is kept from frame to frame while nothing near moves (render/light/sky_kept.h); its light never. The
 * ground is treated only within reach of an entity: beyond, it hides less than 2 % of a level plane's sky. Sky hidden
 * by terrain is not included, and mirror reflections are unaffected.
 *
 * Error against hemisphere_light, means of 5 x 5 px (tests/sensor/test_sky_visibility.c): 2 to 4 % rms on shadowed
 * ground, 5 to 13 % where less than 40 % of the open light comes, 4 to 13 % on sides away from the sun. */
#ifndef RENDER_LIGHT_SKY_VISIBILITY_H
#define RENDER_LIGHT_SKY_VISIBILITY_H

#include "render/light/hemisphere.h"
#include "render/light/sky_kept.h"
#include "render/scene/view.h"
#include "terrain/ground/landscape.h"

typedef struct SkyVisibility SkyVisibility; /* of a frame; shared by its threads */
typedef struct SkyWorker     SkyWorker;     /* of a thread */

typedef struct SkyVisibilityScene {
    HemisphereScene      gather;
    const Landscape *landscape;   /* NULL: no ground */
    const View      *view;
    const double   (*box_px)[4];  /* [entities]: on the image, as TargetPixels.projected_box; NaN: not on the image */
    unsigned         air_bands;   /* 1 << AirBand: all that the frame may need */
    unsigned         skips_off;
    int              hidden_entity; /* index of the entity whose parts the eye does not see; -1: none */
    SkyKept         *kept;        /* of earlier frames, over the same ground and materials; NULL: none */
} SkyVisibilityScene;

/* The scene's parts must outlive it. STATUS_NO_MEMORY: of the arena. */
Status sky_visibility_create(SkyVisibility **out, const SkyVisibilityScene *scene, Arena *arena);
Status sky_worker_create(SkyWorker **out, const SkyVisibility *v, Arena *arena);
/* When its threads are done: what they found is kept. Accepts NULL. */
void   sky_visibility_close(SkyVisibility *v, VisibilityCounters *counters);

/* Evaluates the points on every entity beforehand, in so many tasks for a pool; hits ask for those of entities that they
 * show otherwise. The same bits. */
int  sky_visibility_tasks(const SkyVisibility *v);
void sky_visibility_task(const SkyVisibility *v, SkyWorker *worker, int task);

typedef struct SkyOpen {
    float factor[AIR_BAND_COUNT][hits_capacity]; /* factor on the light that the tilt alone gives; 1 where nothing
                                                  * is near */
} SkyOpen;

/* False: nothing near any of the hits, and nothing written; else the factors of the frame's bands. */
bool sky_visibility_open(SkyOpen *out, const SkyVisibility *v, SkyWorker *worker, const Hits *hits,
                         VisibilityCounters *counters);

#endif
