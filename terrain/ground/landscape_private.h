/* terrain/ground/landscape_private.h: Cover: what a landscape has of surface classes, photographs and water. */
#ifndef TERRAIN_GROUND_LANDSCAPE_PRIVATE_H
#define TERRAIN_GROUND_LANDSCAPE_PRIVATE_H

#include "terrain/elevation/levels.h"
#include "terrain/ground/ground_image.h"
#include "terrain/ground/landscape.h"

typedef struct Cover {
    InventedGround invented; /* its seed is also that of real ground */
    bool           real;     /* elevation is from files: woods, not fields, on steep slopes */
    Curve          curve;    /* on real ground: gives heights above the sea */
    double         geoid_m, treeline_m;
    CoverGrid      grid[cover_windows];
    Photo          photo;
    LandscapeMap   store; /* the mapped store, from which grid, photo and elevation borrow */
} Cover;

/* Measures the means of the photograph over each class; call it once the classes are known. */
void cover_measure_photo(Landscape *landscape);
void cover_free(Cover *cover); /* accepts NULL */

/* landscape_surfaces in two steps: what covers the ground, and over it what lies on it. */
void cover_surfaces(uint8_t *surface, const Landscape *landscape, int count, const double *x_m, const double *y_m);
void cover_lay_over(uint8_t *surface, const Landscape *landscape, int count, const double *x_m, const double *y_m);

#endif
