/* render/scene/hits.h: rays and what they found, as arrays. One block of a tile; every band reads the same hits. */
#ifndef RENDER_SCENE_HITS_H
#define RENDER_SCENE_HITS_H

#include "pitviper.h"

enum { hits_capacity = 1024 }; /* samples in one block; arrays are padded to a multiple of 8 */

typedef struct Rays {
    int    count;
    int    columns;                 /* of a picture, in rows one after another; 0: in no such order. For speed alone */
    double o_enu[3][hits_capacity]; /* origins */
    double d_enu[3][hits_capacity]; /* unit directions */
    double far_m[hits_capacity];    /* nothing beyond; INFINITY: to the sky */
} Rays;

/* A ray that met nothing: range_m INFINITY, everything else 0.
 *
 * Row i is what the ray in row i of its Rays met. A ray as it was shot may have several returns (kinds of ground within
 * its square; leaves and haze would be others): they follow one another, each a row of its own in Hits and Rays, and
 * `several` is set: ray[] then says which ray they were, and weight[] how much of its light each return is. */
typedef struct Hits {
    int      count, columns;            /* as Rays */
    bool     several;                   /* ray[] and weight[] hold; else one return a ray, of weight 1 */
    uint16_t ray[hits_capacity];        /* as it was shot; ascending */
    float    weight[hits_capacity];     /* 0 .. 1; 1 over the returns of a ray */
    double   range_m[hits_capacity];
    double   p_enu[3][hits_capacity];
    float    n_geo[3][hits_capacity];   /* unit geometric normal, ENU, on the ray's side */
    float    n_enu[3][hits_capacity];   /* unit shading normal, on the ray's side */
    uint32_t entity[hits_capacity];     /* snapshot index + 1; 0: ground or sky */
    uint16_t part[hits_capacity];       /* part index of the model + 1; 0: ground or sky */
    uint16_t model[hits_capacity];      /* of the catalog, where entity > 0 */
    uint8_t  inside[hits_capacity];     /* 1: a part was met from the inner side of its surface */
    uint8_t  surface[hits_capacity];    /* SurfaceClass where the ground was met, else 0 */
} Hits;

/* The ray, as it was shot, that a hit is a return of; and its share of that ray's light. */
static inline int   hit_ray(const Hits *hits, int i) { return hits->several ? hits->ray[i] : i; }
static inline float hit_weight(const Hits *hits, int i) { return hits->several ? hits->weight[i] : 1; }

#endif
