/* tests/scenes/town.h: scenery for tests and measurements: streets of gabled houses, and cars and trailers in them. */
#ifndef TESTS_SCENES_TOWN_H
#define TESTS_SCENES_TOWN_H

#include "entities/scenery/scenery.h"
#include "terrain/ground/landscape.h"

enum { town_lots = 5, town_square_m = 128 }; /* lots a side of a square, which is one mesh */

typedef struct TownOf {
    int              buildings, clutter, movers; /* movers: of the clutter, the first ones */
    double           middle_enu[2];
    const Landscape *landscape; /* NULL: level ground at height 0 */
    uint64_t         seed;
} TownOf;

/* Squares side by side about the middle, as many as the buildings need. scenery_free after it. */
Status town_create(Scenery *out, const TownOf *of);
/* Its side, m. */
double town_wide_m(int buildings);

#endif
