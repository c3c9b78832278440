/* terrain/import/building_count.h: buildings counted row by row: connected parts of cells, courtyards or not. */
#ifndef TERRAIN_IMPORT_BUILDING_COUNT_H
#define TERRAIN_IMPORT_BUILDING_COUNT_H

#include "pitviper.h"

typedef struct BuildingCount {
    long count;            /* of all rows so far */
    int  labels;           /* of the last row */
    int *label;            /* [nx] of the last row; 0: no building */
    int *parent, *compact; /* [2 nx + 2] */
} BuildingCount;

/* The next row: kind is CellKind. Cells that touch at a corner only are apart. out starts zeroed. */
Status building_count_row(BuildingCount *out, int nx, const uint8_t *kind);
void   building_count_free(BuildingCount *count); /* accepts zeroes */

#endif
