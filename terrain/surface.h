/* terrain/surface.h: land cover of the ground. One class per position; etc/surfaces.csv has the materials of each. */
#ifndef TERRAIN_SURFACE_H
#define TERRAIN_SURFACE_H

#include "pitviper_table.h"

typedef enum SurfaceClass {
    SURFACE_NONE = 0,
    SURFACE_GRASS,
    SURFACE_DRY_GRASS,
    SURFACE_CROP,
    SURFACE_BARE_SOIL,
    SURFACE_PLOUGHED,
    SURFACE_TRACK,
    SURFACE_ROCK,
    SURFACE_SCRUB,
    SURFACE_WATER,
    /* from cover files, and on real ground without: */
    SURFACE_FOREST_BROADLEAF,
    SURFACE_FOREST_CONIFER,
    SURFACE_BUILT,
    SURFACE_ROAD,
    SURFACE_SAND,
    SURFACE_SNOW,
    SURFACE_WETLAND,
    SURFACE_COUNT
} SurfaceClass;

const char *surface_name(SurfaceClass surface);
/* Soil and what grows on it, that wheels tear open and raise dust from. */
static inline bool surface_loosens(int surface)
{
    return (surface >= SURFACE_GRASS && surface <= SURFACE_TRACK) || surface == SURFACE_SCRUB ||
           surface == SURFACE_WETLAND;
}
SurfaceClass surface_find(const char *name); /* SURFACE_NONE: no such class, or "none" */
/* Of the column `surface` of tables: TABLE_NAMED of a SurfaceClass; with "none", or without. */
const char *surface_named(int surface);
#define SURFACE_NAMED   .low = SURFACE_NONE + 1, .high = SURFACE_COUNT - 1, .named = surface_named
#define SURFACE_OR_NONE .high = SURFACE_COUNT - 1, .named = surface_named

/* ---- from the codes of land cover files ---------------------------------------------------------- */

enum { surface_codes_most = 1024 };

/* A table of codes. In most files 0 is not a class; where a table lists it (Dynamic World's water) it is one. */
typedef struct SurfaceTable {
    bool    known[surface_codes_most];
    uint8_t surface[surface_codes_most];
} SurfaceTable;

/* asked: as in cover_grid_read. When it is empty the table is chosen that has most of the pixels' codes, without 0; of
 * equal ones the first. name: that of the table chosen, in static storage or the caller's. */
Status surface_table_choose(SurfaceTable *out, const char **name, const char *asked,
                            const long histogram[surface_codes_most]);
/* Whether a table of codes (terrain.cover_table) can be read; logs what is wrong with it. */
Status surface_table_check(const char *path);

#endif
