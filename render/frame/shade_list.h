/* render/frame/shade_list.h: radiance along a list of rays of any length: for queries that are not pictures.
 *
 * A ray's result has the same bits in any list (tests/render/test_shade_list.c). */
#ifndef RENDER_FRAME_SHADE_LIST_H
#define RENDER_FRAME_SHADE_LIST_H

#include "render/frame/shade.h"

/* Rays, in arrays of the caller's. */
typedef struct RayList {
    int             count;
    const double   *o_enu[3], *d_enu[3]; /* origins; unit directions */
    const uint64_t *key;                 /* as Samples.key; may be NULL without sky_samples */
    double          per_rad;             /* as Samples.per_rad */
    unsigned        channels;            /* 1 << AirBand */
    bool            radar, temperature;
} RayList;

/* Hits of the rays and radiance along them: arrays of `capacity`, as in Hits and Samples. */
typedef struct ShadedRays {
    int       capacity;
    double   *range_m;
    uint8_t  *kind, *surface;
    uint16_t *material, *part;
    uint32_t *entity, *facet;
    float    *n_enu[3], *sun, *temp_k, *radar_power;
    float    *radiance[AIR_BAND_COUNT];
} ShadedRays;

/* STATUS_NO_MEMORY: of the arena. */
Status shaded_rays_create(ShadedRays *out, int capacity, Arena *arena);

/* The list, at most out->capacity rays, block by block. block, shader: working memory of the calling thread. */
void shade_list(ShadedRays *out, const RayList *list, Shader *shader, const ShadeScene *scene, Samples *block);

#endif
