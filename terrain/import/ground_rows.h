/* terrain/import/ground_rows.h: what rasters show in rows of square cells of ENU: codes of land cover, colours of a
 * photograph, numbers. Each call reads the part of the files that its rows need. */
#ifndef TERRAIN_IMPORT_GROUND_ROWS_H
#define TERRAIN_IMPORT_GROUND_ROWS_H

#include "terrain/elevation/raster.h"

/* Rows of cells; x0_m, y0_m: south-west corner of the first. */
typedef struct CellRows {
    int    nx, rows;
    double x0_m, y0_m, cell_m;
} CellRows;

/* ENU z of the ground at a place: pixels are looked up where the ground is, not where the plane is. */
typedef double GroundZ(void *user, double x_m, double y_m);

typedef struct GroundView {
    const LocalFrame *frame;
    GroundZ          *z;
    void             *z_user;
    Pool             *pool;
    const char       *key;   /* for messages */
} GroundView;

/* Where a cell has no value yet (coverage 0, NaN) it gets that of the first raster of the set that has one. code: 0: none;
 * else one more than the file's, of which a 0 gives way to others'; codes from cover_codes_most on are none. band 0: the sheets' own, else the first. */
Status ground_rows_codes(uint16_t *code, const RasterSet *set, int band, const CellRows *cells, const GroundView *view);
/* [rows][nx][4]: sRGB and coverage, bilinear in linear light; averaged where pixels are finer than cells. */
Status ground_rows_colours(uint8_t *rgba, const RasterSet *set, const CellRows *cells, const GroundView *view);
Status ground_rows_numbers(float *value, const RasterSet *set, int band, const CellRows *cells, const GroundView *view);

#endif
