/* render/scene/hits.h: rays and their hits, as arrays. One block of a tile; all bands share the same hits. */
#ifndef RENDER_SCENE_HITS_H
#define RENDER_SCENE_HITS_H

#include "pitviper.h"

enum { hits_capacity = 1024 }; /* samples in one block; arrays are padded to a multiple of 8 */

typedef struct Rays {
    int count;
    int columns;                    /* of a picture, in rows one after another; 0: no such order. A hint for speed
                                     * alone */
    bool   bent;                    /* all leave the frame's eye and bend in its air (VisibilityConfig) */
    double o_enu[3][hits_capacity]; /* origins */
    double d_enu[3][hits_capacity]; /* unit directions */
    double far_m[hits_capacity];    /* search limit; INFINITY: to the sky */
} Rays;

/* Kind of a hit: sky, where nothing was met. */
typedef enum HitKind { hit_sky, hit_ground, hit_part, hit_plant, hit_scenery } HitKind;

/* A ray that met nothing: range_m INFINITY, everything else 0.
 *
 * Row i is what the ray in row i of its Rays met. A traced ray may have several returns (ground classes within its
 * square): they follow one another, each a row of its own in Hits and Rays, and `several` is set: ray[] is then the
 * index of the traced ray, and weight[] the share of its light of each return. */
typedef struct Hits {
    int      count, columns;        /* as Rays */
    bool     several;               /* ray[] and weight[] hold; else one return a ray, of weight 1 */
    uint16_t ray[hits_capacity];    /* index of the traced ray; ascending */
    float    weight[hits_capacity]; /* 0 .. 1; 1 over the returns of a ray */
    double   range_m[hits_capacity];
    double   p_enu[3][hits_capacity];
    float    n_geo[3][hits_capacity]; /* unit geometric normal, ENU, on the ray's side */
    float    n_enu[3][hits_capacity]; /* unit shading normal, on the ray's side */
    uint8_t  kind[hits_capacity];     /* HitKind */
    uint16_t material[hits_capacity]; /* row in the table of materials (visibility_materials); 0: sky */
    uint32_t facet[hits_capacity];    /* triangle of the model, of parts and scenery; of plants, ForestHit.quad */
    uint32_t entity[hits_capacity];   /* snapshot index + 1; 0: ground or sky */
    uint16_t part[hits_capacity];     /* part index of the model + 1; 0: ground, plant or sky */
    uint16_t model[hits_capacity];    /* of the catalog, where entity > 0; of scenery, of Scenery.model */
    uint8_t  inside[hits_capacity];   /* 1: a part was met from the inner side of its surface */
    uint8_t  surface[hits_capacity];  /* SurfaceClass where the ground was met, else 0 */
    uint32_t instance[hits_capacity]; /* 1 + its number in its kind (plants: ForestHit.plant; scenery: of
                                       * Scenery.object); 0: none, or entity */
    /* of plants alone: */
    float albedo[hits_capacity];                            /* reflectance over that of the material */
    float radius_m[hits_capacity];                          /* of the branch; 0: a leaf */
    float open_up[hits_capacity], open_down[hits_capacity]; /* shares of even light from above and below that
                                                             * reach it past its own plant, 0 .. 1 */
} Hits;

/* Row `from` of others is copied to row `to`, as one return of weight 1; rays as well. from and to may be the same
 * arrays. */
static inline void hits_copy(Hits *hits, Rays *rays, int to, const Hits *from_hits, const Rays *from_rays, int from)
{
    hits->range_m[to] = from_hits->range_m[from];
    hits->kind[to] = from_hits->kind[from];
    hits->material[to] = from_hits->material[from];
    hits->facet[to] = from_hits->facet[from];
    hits->entity[to] = from_hits->entity[from];
    hits->part[to] = from_hits->part[from];
    hits->model[to] = from_hits->model[from];
    hits->inside[to] = from_hits->inside[from];
    hits->surface[to] = from_hits->surface[from];
    hits->instance[to] = from_hits->instance[from];
    hits->albedo[to] = from_hits->albedo[from];
    hits->radius_m[to] = from_hits->radius_m[from];
    hits->open_up[to] = from_hits->open_up[from];
    hits->open_down[to] = from_hits->open_down[from];
    rays->far_m[to] = from_rays->far_m[from];
    for (int k = 0; k < 3; k++) {
        hits->p_enu[k][to] = from_hits->p_enu[k][from];
        hits->n_geo[k][to] = from_hits->n_geo[k][from];
        hits->n_enu[k][to] = from_hits->n_enu[k][from];
        rays->o_enu[k][to] = from_rays->o_enu[k][from];
        rays->d_enu[k][to] = from_rays->d_enu[k][from];
    }
}

/* All of them, of several returns a ray: no more rows than there are. */
static inline void hits_copy_all(Hits *hits, Rays *rays, const Hits *from_hits, const Rays *from_rays)
{
    const size_t n = (size_t)from_hits->count;
#define COPY_ROWS(to, from) memcpy(to, from, n * sizeof *(to))
    hits->count = from_hits->count, hits->columns = from_hits->columns, hits->several = from_hits->several;
    rays->count = from_rays->count, rays->columns = from_rays->columns, rays->bent = from_rays->bent;
    COPY_ROWS(hits->ray, from_hits->ray);
    COPY_ROWS(hits->weight, from_hits->weight);
    COPY_ROWS(hits->range_m, from_hits->range_m);
    COPY_ROWS(hits->kind, from_hits->kind);
    COPY_ROWS(hits->material, from_hits->material);
    COPY_ROWS(hits->facet, from_hits->facet);
    COPY_ROWS(hits->entity, from_hits->entity);
    COPY_ROWS(hits->part, from_hits->part);
    COPY_ROWS(hits->model, from_hits->model);
    COPY_ROWS(hits->inside, from_hits->inside);
    COPY_ROWS(hits->surface, from_hits->surface);
    COPY_ROWS(hits->instance, from_hits->instance);
    COPY_ROWS(hits->albedo, from_hits->albedo);
    COPY_ROWS(hits->radius_m, from_hits->radius_m);
    COPY_ROWS(hits->open_up, from_hits->open_up);
    COPY_ROWS(hits->open_down, from_hits->open_down);
    COPY_ROWS(rays->far_m, from_rays->far_m);
    for (int k = 0; k < 3; k++) {
        COPY_ROWS(hits->p_enu[k], from_hits->p_enu[k]);
        COPY_ROWS(hits->n_geo[k], from_hits->n_geo[k]);
        COPY_ROWS(hits->n_enu[k], from_hits->n_enu[k]);
        COPY_ROWS(rays->o_enu[k], from_rays->o_enu[k]);
        COPY_ROWS(rays->d_enu[k], from_rays->d_enu[k]);
    }
#undef COPY_ROWS
}

/* The traced ray of a hit; and the hit's share of that ray's light. */
static inline int   hit_ray(const Hits *hits, int i) { return hits->several ? hits->ray[i] : i; }
static inline float hit_weight(const Hits *hits, int i) { return hits->several ? hits->weight[i] : 1; }

#endif
