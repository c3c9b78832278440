/* render/frame/world.h: the data that does not change between frames: models, ground, materials, the tracer. */
#ifndef RENDER_FRAME_WORLD_H
#define RENDER_FRAME_WORLD_H

#include "render/air/air.h"
#include "render/forest/forest.h"
#include "render/light/canopy.h"
#include "render/radar/radar_image.h"
#include "render/visibility/visibility.h"
#include "terrain/landscape/detail.h"

typedef struct World {
    const Catalog   *catalog;
    const Landscape *landscape;      /* NULL: no ground */
    LocalFrame       frame;          /* the ENU frame of the views */
    Tracer          *tracer;
    Materials        materials;
    DetailTable     *detail;         /* of the ground; the caller may close it and set NULL: classes of one value */
    Plants          *plants;         /* NULL after world_open, with forest: no plants */
    Forest          *forest;
    Canopy          *canopy;
    PlanckTable     *planck_mwir, *planck_lwir;
    Atmosphere      *atmosphere;     /* NULL after world_open; the caller may open one here; world_close closes it */
    RadarConfig      radar;
} World;

/* frame: the landscape's, or any where there is none. */
Status world_open(World *out, const Catalog *catalog, const Landscape *landscape, const LocalFrame *frame, const char *isa);
/* Grows the prototypes and opens the forest over woods, which must outlive the world. Once, before the first frame; on
 * failure only world_close may follow. */
Status world_plant(World *world, const Woods *woods, const ForestConfig *config, const char *isa, Pool *pool);
void   world_close(World *world);

#endif
