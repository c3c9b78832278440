/* terrain/landscape/hedges.h: places of the hedgerows of the synthetic landscape, for the plants that grow there. They
 * are on borders of fields and beside the tracks between them, never on a road, in water or where a vehicle was
 * reported. */
#ifndef TERRAIN_LANDSCAPE_HEDGES_H
#define TERRAIN_LANDSCAPE_HEDGES_H

#include "terrain/landscape/landscape.h"

/* Of a whole hedgerow: cut, grown out to shrubs, with trees in it. */
typedef enum HedgeHeight { HEDGE_CUT, HEDGE_SHRUBS, HEDGE_TREES } HedgeHeight;

typedef struct HedgePlace {
    double      x_m, y_m;
    uint64_t    hedge; /* the same number along one hedgerow */
    HedgeHeight height;
} HedgePlace;

/* Places within a rectangle, about spacing_m apart (1 .. 50), in a list that the caller frees. Each belongs to a square
 * of a fixed grid of that spacing: rectangles side by side that are whole squares repeat none and omit none.
 * STATUS_BAD_VALUE: not finite, or more than 2^26 squares. Landscapes from files: none. */
Status landscape_hedges(HedgePlace **out, int *count, const Landscape *landscape, const double south_west_m[2],
                        const double north_east_m[2], double spacing_m);

#endif
