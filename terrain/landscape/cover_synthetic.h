/* terrain/landscape/cover_synthetic.h: the synthetic land cover, eight places at once, for cover.c. */
#ifndef TERRAIN_LANDSCAPE_COVER_SYNTHETIC_H
#define TERRAIN_LANDSCAPE_COVER_SYNTHETIC_H

#include "terrain/landscape/ways_private.h"

/* What the synthetic cover follows, of wavelengths from 17 m on, at eight places. */
typedef struct SlowFields {
    F32x8 large, middle, patch; /* noise of 310, 83 and 17 m */
    F32x8 slope, wet;
    F32x8 bend_x, bend_y;       /* plot_bend_by */
} SlowFields;

/* Nodes about places of a few metres, two by four: between them the slow fields are linear. */
typedef struct SlowNodes {
    bool       known;
    bool       east;             /* four of them from west to east; else from south to north */
    double     x0_m, y0_m;       /* the south-west one */
    double     per_x_m, per_y_m; /* nodes a metre */
    SlowFields field;            /* lane: along the longer side, then across */
} SlowNodes;

/* Lanes where there is ground: the outermost level encloses the others. NaN: none. */
unsigned cover_grounded(const Elevation *elevation, const double x_m[8], const double y_m[8]);
/* Slope of the terrain about the places, without the tilt of the plane far from its origin. */
F32x8    cover_slopes(const Elevation *elevation, const double x_m[8], const double y_m[8], unsigned lanes);

void synthetic_fields(SlowFields *out, const Cover *cover, const double x_m[8], const double y_m[8], F32x8 slope);
/* Nodes about these places; not known where they lie too far apart. */
void synthetic_nodes(SlowNodes *out, const Landscape *landscape, int count, const double *x_m, const double *y_m);
/* The fields between known nodes. */
void synthetic_between(SlowFields *out, const SlowNodes *nodes, const double x_m[8], const double y_m[8]);
/* Surface classes of these lanes. */
void synthetic_surfaces(int32_t surface[8], const Cover *cover, const double x_m[8], const double y_m[8],
                        const SlowFields *slow, unsigned lanes);

#endif
