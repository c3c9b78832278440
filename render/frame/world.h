/* render/frame/world.h: the data that does not change between frames: models, ground, materials, the tracer. */
#ifndef RENDER_FRAME_WORLD_H
#define RENDER_FRAME_WORLD_H

#include "render/air/air.h"
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
    PlanckTable     *planck_mwir, *planck_lwir;
    Atmosphere      *atmosphere;     /* NULL after world_open; the caller may open one here; world_close closes it */
    RadarConfig      radar;
} World;

/* frame: the landscape's, or any where there is none. */
Status world_open(World *out, const Catalog *catalog, const Landscape *landscape, const LocalFrame *frame, const char *isa);
void   world_close(World *world);

#endif
