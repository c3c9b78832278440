/* terrain/surface.c: the names that etc/surfaces.csv and the products use. */
#include "terrain/surface.h"

const char *surface_name(SurfaceClass surface)
{
    static const char *const name[SURFACE_COUNT] = {
        [SURFACE_NONE] = "none",           [SURFACE_GRASS] = "grass",       [SURFACE_DRY_GRASS] = "dry_grass",
        [SURFACE_CROP] = "crop",           [SURFACE_BARE_SOIL] = "bare_soil", [SURFACE_PLOUGHED] = "ploughed",
        [SURFACE_TRACK] = "track",         [SURFACE_ROCK] = "rock",         [SURFACE_SCRUB] = "scrub",
        [SURFACE_WATER] = "water",
    };
    return surface >= 0 && surface < SURFACE_COUNT ? name[surface] : "none";
}
