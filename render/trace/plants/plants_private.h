/* render/trace/plants/plants_private.h: a plant while it grows, shared by the files of render/plants. */
#ifndef RENDER_TRACE_PLANTS_PLANTS_PRIVATE_H
#define RENDER_TRACE_PLANTS_PLANTS_PRIVATE_H

#include "render/trace/plants/plants.h"

/* The quads of a plant while it is made; their arrays grow. */
typedef struct Growth {
    uint64_t   seed;  /* of the kind */
    uint64_t   drawn; /* random numbers so far */
    int        kind, level;
    int        offered; /* leaves, those left out included */
    PlantQuad *bark, *leaf;
    int        bark_quads, bark_room, pieces, leaves, leaf_room;
    float     *leaf_uv_area; /* [plant_outlines]: share of a card */
    bool       lost;         /* no memory */
} Growth;

/* Next random number, low .. high. */
double grow_draw(Growth *g, double low, double high);
/* A branch piece from a to b: a frustum of `sides` flat sides (3 .. 6), longer at its ends by half its radius so that
 * pieces overlap. */
void grow_piece(Growth *g, const double a[3], const double b[3], double radius_a, double radius_b, int sides);
/* A leaf's card: stalk at `at`, the card's middle line along `along`, its normal as near to n as that allows. */
void grow_leaf(Growth *g, const double at[3], const double along[3], const double n[3], double length, double width);
/* A flat stone side: three corners. */
void grow_facet(Growth *g, const double corner[3][3]);

/* The skeleton and the leaves of a kind, not to scale. */
void grow_tree(Growth *g);
void grow_low_plant(Growth *g);

/* The outlines of a kind, and their areas. */
void   plant_outline(LeafOutline *out, PlantKind kind, int which, uint64_t seed);
double plant_outline_area(const LeafOutline *outline);

#endif
