/* terrain/from_files/elevation_import_private.h: state of an import in progress, shared by its files. */
#ifndef TERRAIN_FROM_FILES_ELEVATION_IMPORT_PRIVATE_H
#define TERRAIN_FROM_FILES_ELEVATION_IMPORT_PRIVATE_H

#include "terrain/earth/geoid.h"
#include "terrain/elevation/levels.h"
#include "terrain/elevation/raster_patch.h"
#include "terrain/from_files/elevation_import.h"

enum {
    import_most_grids = 16,
    import_join_band = 24
}; /* join_band: posts over which a level is blended into the next */

/* Where the posts of a view lie in one grid: exact on a lattice, at two heights, linear between. */
typedef struct Sight {
    double *x, *y;   /* [nodes] pixels of a place at height 0 above the ellipsoid */
    double *dx, *dy; /* [nodes] change of these per metre of height */
} Sight;

typedef struct Grid {
    const Raster *raster;
    bool          ellipsoidal;
    double        short_m,
        long_m; /* widths over which it fades out beyond its edge: short_m into another grid, long_m into nothing */
    double units[2]; /* metres per pixel in x and y */
} Grid;

/* Rows of posts of a level, and what the grids hold there. The lattice's nodes are every stride-th post from the
 * level's first on, whichever rows a view has, so that any rows give the same posts. */
typedef struct View {
    Field       level;      /* the whole level's posts; v is not used */
    int         row0, rows; /* rows that the view has */
    int         stride, node_row0, nodes_x, nodes_y;
    double     *n_m; /* [nodes] height of the geoid */
    Sight       sight[import_most_grids];
    RasterPatch patch[import_most_grids];
    float      *cell_m; /* [rows][nx] gets what the nearest pixel has, above the ellipsoid; NULL: not wanted */
} View;

typedef struct Import {
    const ElevationFiles *files;
    const LocalFrame     *frame;
    Pool                 *pool;     /* NULL: one thread */
    bool                  streamed; /* level 0 is made in strips, inside a level that exists already */
    Curve                 curve;
    Geoid                 geoid;
    RasterSet             set;
    int                   grids; /* number of grids, the finest first */
    Grid                  grid[import_most_grids];
    int                   main;     /* number of the grid that level 0 shows */
    double                base_h_m; /* height beyond all data */
    double                geoid_m;  /* height of the geoid at the origin */
    int                   level_count;
    double                spacing_m[elevation_max_levels];
    WorkLevel             level[elevation_max_levels];
} Import;

/* Places of the main grid, and the surface that its file has there, in ENU. */
typedef struct Samples {
    int   count, capacity;
    bool *at_post;
    double (*p_enu)[3];
} Samples;

/* elevation_plan.c. most_side: most posts along a side of level 0 */
Status elevation_import_open(Import *m);
Status elevation_import_choose(Import *m, ElevationReport *report);
void   elevation_import_plan(Import *m, int most_side);
/* Most pixels of a grid that are read once: those within the horizon that are not known to hold nothing. */
double elevation_import_reads_px(const Import *m, int grid);

/* elevation_posts.c: the lattice of a view, the windows of pixels that it needs, and its heights above the ellipsoid
 * (STATUS_IO: a stop was requested). view_window returns false when the grid has nothing near. */
Status view_create(View *out, const Import *m, const Field *level, int row0, int rows);
bool   view_window(RasterPatchWindow *out, const View *view, const Import *m, int grid);
Status view_heights(float *h_m, const View *view, const Import *m);
void   view_free(View *view); /* accepts zeroes */
/* Converts rows of a level in place: view_bend from heights above the ellipsoid to ENU z, view_join blends them into
 * the level around. */
Status view_bend(float *rows_m, const Import *m, const Field *level, int row0, int rows);
void   view_join(float *rows_m, const Field *level, int row0, int rows, const Field *outer);

/* elevation_plan.c: computes the heights of every level, without level 0 unless with_0; reads each grid once. finest:
 * gets the view of the finest of these levels, with its patches, which the caller frees. */
Status            elevation_import_levels(Import *m, bool with_0, View *finest);
RasterPatchSource elevation_import_source(const Import *m, int grid);
/* Fills in a report except for what is measured. */
void elevation_import_describe(ElevationReport *r, const Import *m);

enum { samples_places = 100000 };
/* Draws samples first .. end - 1 at random over a patch; from number at_posts on they are posts of the file. */
Status samples_draw(Samples *samples, const Import *m, const RasterPatch *patch, int first, int end, int at_posts);
/* Compares the stored surface with all samples; fills in error_rms_m, error_p99_m, error_max_m and places of the
 * report. */
Status samples_measure(ElevationReport *report, const Samples *samples, const Elevation *elevation);
void   samples_free(Samples *samples);

#endif
