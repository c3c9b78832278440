/* terrain/surface.c: the names that etc/surfaces.csv and the products use. */
#include "terrain/surface.h"

const char *surface_name(SurfaceClass surface)
{
    static const char *const name[SURFACE_COUNT] = {
        [SURFACE_NONE] = "none",           [SURFACE_GRASS] = "grass",       [SURFACE_DRY_GRASS] = "dry_grass",
        [SURFACE_CROP] = "crop",           [SURFACE_BARE_SOIL] = "bare_soil", [SURFACE_PLOUGHED] = "ploughed",
        [SURFACE_TRACK] = "track",         [SURFACE_ROCK] = "rock",         [SURFACE_SCRUB] = "scrub",
        [SURFACE_WATER] = "water",         [SURFACE_BUILT] = "built",       [SURFACE_ROAD] = "road",
        [SURFACE_SAND] = "sand",           [SURFACE_SNOW] = "snow",         [SURFACE_WETLAND] = "wetland",
        [SURFACE_FOREST_BROADLEAF] = "forest_broadleaf", [SURFACE_FOREST_CONIFER] = "forest_conifer",
    };
    return surface >= 0 && surface < SURFACE_COUNT ? name[surface] : "none";
}

SurfaceClass surface_find(const char *name)
{
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT; s++)
        if (strcmp(surface_name((SurfaceClass)s), name) == 0) return (SurfaceClass)s;
    return SURFACE_NONE;
}
