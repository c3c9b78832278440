/* terrain/ground/landscape_private.h: what covers a landscape. */
#ifndef TERRAIN_GROUND_LANDSCAPE_PRIVATE_H
#define TERRAIN_GROUND_LANDSCAPE_PRIVATE_H

#include "terrain/elevation/levels.h"
#include "terrain/ground/ground_image.h"
#include "terrain/ground/landscape.h"

typedef struct Cover {
    InventedGround invented; /* its seed is that of real ground, too */
    bool           real;     /* elevation from files: no fields on steep slopes, woods instead */
    Curve          curve;    /* real: heights above the sea are needed */
    double         geoid_m, treeline_m;
    CoverGrid      grid[cover_windows];
    Photo          photo;
    LandscapeMap   store; /* grid, photo and the elevation borrow from it */
} Cover;

/* Means of the photograph over each class, once the classes are known. */
void cover_measure_photo(Landscape *landscape);
void cover_free(Cover *cover); /* accepts NULL */

#endif
