/* sensor/verify/saved_frame/ground_cutout_private.h: the part of terrain from files that one frame needs: tiles around
 * the points that its rays hit. Omitted tiles read as the lowest post, no cover and no photograph; the size of the
 * grids stays, so that every index does. Whether it suffices is not estimated: frame_save renders with it and compares.
 */
#ifndef SENSOR_VERIFY_SAVED_FRAME_GROUND_CUTOUT_PRIVATE_H
#define SENSOR_VERIFY_SAVED_FRAME_GROUND_CUTOUT_PRIVATE_H

#include "sensor/verify/saved_frame/chunks_private.h"
#include "terrain/ground/landscape_parts.h"

typedef struct GroundCutout {
    int count;
    const double (*p_m)[2]; /* positions, ENU */
    double reach_m;         /* posts: the tiles of the positions, and those within this distance of them, are kept;
                             * INFINITY: all */
    double looks_reach_m;   /* reach of cover and photograph */
} GroundCutout;

enum { cutout_tile = 32 }; /* values a side */

/* One grid of values, `octets` each; value (i, j) is at (x0 + i spacing, y0 + j spacing) */
typedef struct CutoutGrid {
    int    nx, ny, octets;
    double x0_m, y0_m, spacing_m;
} CutoutGrid;

/* Puts which tiles are kept, a bit each, then their values, tile by tile and row by row. Values of two octets (posts)
 * are put as differences, low octets before high ones; values of one octet (classes) and of eight (blocks of pixels) as
 * they are. */
void ground_cutout_put(ByteSink *sink, const CutoutGrid *grid, const void *values, const GroundCutout *kept);
/* values: [ny][nx]; those of omitted tiles are left as they are. */
void ground_cutout_get(ByteSource *source, const CutoutGrid *grid, void *values);

#endif
