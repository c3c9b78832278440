/* terrain/landscape/elevation_import_private.h: state of an import in progress, shared by its files. */
#ifndef TERRAIN_LANDSCAPE_ELEVATION_IMPORT_PRIVATE_H
#define TERRAIN_LANDSCAPE_ELEVATION_IMPORT_PRIVATE_H

#include "terrain/earth/geoid.h"
#include "terrain/elevation/patch.h"
#include "terrain/landscape/elevation_import.h"
#include "terrain/landscape/landscape_private.h"

enum { import_most_grids = 16, import_join_band = 24 }; /* join_band: posts over which a level goes into the next */

/* Where the posts of a level lie in one grid: exact on a lattice, at two heights, linear between. */
typedef struct Sight {
    double *x, *y;   /* [lattice] pixels at the ellipsoid */
    double *dx, *dy; /* [lattice] more, per metre of height */
} Sight;

typedef struct Grid {
    const Raster *raster;
    bool          ellipsoidal;
    double        short_m, long_m; /* beyond its edge it fades out over this: into another grid, into nothing */
    double        units[2];      /* metres a pixel, x and y */
    Patch         patch;
    Sight         sight;
} Grid;

typedef struct Import {
    const ElevationFiles *files;
    const LocalFrame     *frame;
    Curve      curve;
    Geoid      geoid;
    RasterSet  set;
    int        grids;            /* finest first */
    Grid       grid[import_most_grids];
    int        main;             /* grid of level 0 */
    double     base_h_m;         /* beyond all data */
    int        level_count;
    double     spacing_m[elevation_max_levels];
    WorkLevel  level[elevation_max_levels];
    /* lattice of the level in work */
    int        stride, lattice_nx, lattice_ny;
    double    *n_m;              /* [lattice] geoid */
} Import;

/* A smooth field through the differences between fixes and levels, pulled in from wide waves to those of some posts,
 * and added to every level. */
Status elevation_import_correct(Import *m, const GroundFix *fix, int fix_count, double *largest_m);
/* The stored surface held against the files: error_rms_m, error_p99_m, error_max_m and places of the report. */
Status elevation_import_measure(ElevationReport *report, const Import *m, const Elevation *elevation,
                                const Patch *patch);

#endif
