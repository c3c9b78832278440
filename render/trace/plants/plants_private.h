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
    double     outline_area; /* mean share of a card that is leaf: at plant_whole, */
    double     pattern_area; /* and at plant_fine */
    double     height;       /* of plant_whole before it is brought to 1 m */
    double     owed;         /* cards of plant_fine, not yet a whole one */
    uint64_t   drawn_fine;   /* random numbers so far of plant_fine alone: its branches are those of plant_whole */
    int        sprays;
    bool       lost; /* no memory */
} Growth;

/* Next random number, low .. high. */
double grow_draw(Growth *g, double low, double high);
double grow_draw_fine(Growth *g, double low, double high);
/* A branch piece from a to b: a frustum of `sides` flat sides (3 .. 6), longer at its ends by half its radius so that
 * pieces overlap. */
void grow_piece(Growth *g, const double a[3], const double b[3], double radius_a, double radius_b, int sides);
/* A leaf's card: stalk at `at`, the card's middle line along `along`, its normal as near to n as that allows; of plants
 * that stand, at plant_fine, the smaller cards that take its place. */
void grow_leaf(Growth *g, const double at[3], const double along[3], const double n[3], double length, double width);
/* One card; outline: or pattern. */
void grow_card(Growth *g, const double at[3], const double along[3], const double n[3], const double size[2],
               int outline);
/* plants_spray.c: the cards of plant_fine in the place of a card of plant_whole. */
void grow_spray(Growth *g, const double at[3], const double along[3], const double n[3], double length, double width);
/* A flat stone side: three corners. */
void grow_facet(Growth *g, const double corner[3][3]);

/* The skeleton and the leaves of a kind, not to scale. */
void grow_tree(Growth *g);
void grow_low_plant(Growth *g);

/* The outlines of a kind, and their areas. */
void   plant_outline(LeafOutline *out, PlantKind kind, int which, uint64_t seed);
double plant_outline_area(const LeafOutline *outline);
/* plants_pattern.c */
void plant_pattern(LeafPattern *out, PlantKind kind, int which, uint64_t seed);

#endif
