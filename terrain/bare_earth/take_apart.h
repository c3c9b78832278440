/* terrain/bare_earth/take_apart.h: a surface model (the highest return of each cell: roofs and crowns included) taken
 * apart into bare ground, buildings and trees. */
#ifndef TERRAIN_BARE_EARTH_TAKE_APART_H
#define TERRAIN_BARE_EARTH_TAKE_APART_H

#include "pitviper.h"

/* A window of cells, row 0 southernmost. */
typedef struct SurfaceModel {
    int            nx, ny;
    double         cell_m;
    const float   *surface_m; /* [ny][nx] NAN: void */
    const float   *bare_m;    /* a terrain model of the same cells, NAN where it has none; NULL: none */
    const uint8_t *rgb;       /* [ny][nx][3] sRGB of an orthophoto, NULL: none; not used yet */
    int64_t column, row;      /* place of the south-west cell in the whole model, by which overlapping windows agree */
} SurfaceModel;

typedef enum CellKind { CELL_BARE, CELL_BUILDING, CELL_TREE } CellKind;

typedef struct Crown {
    float x_m, y_m;           /* place of its top, from the window's south-west corner */
    float height_m, radius_m; /* height above bare ground; radius of the circle of the same area */
} Crown;

/* Arrays of nx x ny that the caller provides, and crowns, which are allocated. */
typedef struct SurfaceParts {
    float   *bare_m; /* bare ground, also under roofs and crowns; no NAN unless all is void */
    float   *roof_m; /* height of the roof, its planes smoothed; NAN: no building */
    uint8_t *kind;   /* CellKind */
    int      crown_count;
    Crown   *crown; /* by place, south-west first; free() */
} SurfaceParts;

/* A cell's answer depends on cells nearer than this only: windows that overlap by twice as much agree bit for bit where
 * both are farther than this from their own edges. */
static const double take_apart_reach_m = 384;

/* Takes a surface model apart, in one thread, deterministically. cell_m: 0.1 .. 4; in coarser cells nothing can be told
 * apart: STATUS_UNSUPPORTED. Temporary memory: at most 32 bytes a cell. */
Status take_apart_surface(SurfaceParts *out, const SurfaceModel *model);

#endif
