/* terrain/surface.h: land cover of the ground. One class per position; etc/surfaces.csv has the materials of each. */
#ifndef TERRAIN_SURFACE_H
#define TERRAIN_SURFACE_H

#include "pitviper.h"

typedef enum SurfaceClass {
    SURFACE_NONE = 0,
    SURFACE_GRASS, SURFACE_DRY_GRASS, SURFACE_CROP, SURFACE_BARE_SOIL, SURFACE_PLOUGHED, SURFACE_TRACK,
    SURFACE_ROCK, SURFACE_SCRUB, SURFACE_WATER,
    /* from cover files, and on real ground without: */
    SURFACE_FOREST_BROADLEAF, SURFACE_FOREST_CONIFER, SURFACE_BUILT, SURFACE_ROAD, SURFACE_SAND, SURFACE_SNOW,
    SURFACE_WETLAND,
    SURFACE_COUNT
} SurfaceClass;

const char *surface_name(SurfaceClass surface);
SurfaceClass surface_find(const char *name); /* SURFACE_NONE: no such class, or "none" */

#endif
