/* tests/scenes/woods_stand.h: woods for measurements: so many trees on a quick landscape. */
#ifndef TESTS_SCENES_WOODS_STAND_H
#define TESTS_SCENES_WOODS_STAND_H

#include "terrain/woods/woods.h"

enum { woods_stand_clear = 20 };

typedef struct WoodsStand {
    const Landscape *landscape;
    double           east_m, north_m; /* of the ground, about the origin */
    int              trees;
    int              clears;
    WoodsPath        clear[woods_stand_clear]; /* points, each with a radius */
    int              by_classes;               /* out: trees that woods_create places */
    double           placing_s;                /* out: its time */
} WoodsStand;

/* The plants of the surface classes, and trees of 10 to 25 m evenly over the ground, up to the number of trees; none of
 * those on tracks, roads or water. woods_destroy after it. */
Status woods_stand_create(Woods *out, WoodsStand *stand, Pool *pool);
int    woods_stand_trees(const Woods *woods);

#endif
