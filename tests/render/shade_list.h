/* tests/render/shade_list.h: radiance along a list of rays of any length: for queries that are not pictures.
 *
 * A ray's result has the same bits in any list (tests/render/test_shade_list.c). */
#ifndef TESTS_RENDER_SHADE_LIST_H
#define TESTS_RENDER_SHADE_LIST_H

#include "render/frame/shade_private.h"

#include <assert.h>

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
static Status shaded_rays_create(ShadedRays *out, int capacity, Arena *arena)
{
    const size_t n = (size_t)capacity;
    *out = (ShadedRays){.capacity = capacity};
    bool ok = (out->range_m = arena_alloc(arena, n, sizeof *out->range_m)) != NULL;
    ok = ok && (out->kind = arena_alloc(arena, n, 1)) && (out->surface = arena_alloc(arena, n, 1));
    ok = ok && (out->material = arena_alloc(arena, n, sizeof *out->material));
    ok = ok && (out->part = arena_alloc(arena, n, sizeof *out->part));
    ok = ok && (out->entity = arena_alloc(arena, n, sizeof *out->entity));
    ok = ok && (out->facet = arena_alloc(arena, n, sizeof *out->facet));
    for (int k = 0; k < 3; k++) ok = ok && (out->n_enu[k] = arena_alloc(arena, n, sizeof(float)));
    ok =
        ok && (out->sun = arena_alloc(arena, n, sizeof(float))) && (out->temp_k = arena_alloc(arena, n, sizeof(float)));
    ok = ok && (out->radar_power = arena_alloc(arena, n, sizeof(float)));
    for (int b = 0; b < AIR_BAND_COUNT; b++) ok = ok && (out->radiance[b] = arena_alloc(arena, n, sizeof(float)));
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

static void take_block(ShadedRays *out, int first, const Samples *s)
{
    const size_t n = (size_t)s->hits.count;
    const Hits  *hits = &s->hits;
    memcpy(out->range_m + first, hits->range_m, n * sizeof *hits->range_m);
    memcpy(out->kind + first, hits->kind, n * sizeof *hits->kind);
    memcpy(out->surface + first, hits->surface, n * sizeof *hits->surface);
    memcpy(out->material + first, hits->material, n * sizeof *hits->material);
    memcpy(out->part + first, hits->part, n * sizeof *hits->part);
    memcpy(out->entity + first, hits->entity, n * sizeof *hits->entity);
    memcpy(out->facet + first, hits->facet, n * sizeof *hits->facet);
    for (int k = 0; k < 3; k++) memcpy(out->n_enu[k] + first, hits->n_enu[k], n * sizeof(float));
    memcpy(out->sun + first, s->sun, n * sizeof(float));
    memcpy(out->temp_k + first, s->temp_k, n * sizeof(float));
    if (s->radar) memcpy(out->radar_power + first, s->radar_power, n * sizeof(float));
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (s->channels >> b & 1) memcpy(out->radiance[b] + first, s->radiance[b], n * sizeof(float));
}

/* The list, at most out->capacity rays, block by block. block, shader: working memory of the calling thread. */
static void shade_list(ShadedRays *out, const RayList *list, Shader *shader, const ShadeScene *scene, Samples *block)
{
    assert(list->count <= out->capacity);
    block->channels = list->channels;
    block->radar = list->radar;
    block->temperature = list->temperature;
    block->per_rad = list->per_rad;
    block->volume = scene->all_volumes;
    block->volumes = scene->effects.count;
    for (int first = 0; first < list->count; first += block->capacity) {
        const int    count = list->count - first < block->capacity ? list->count - first : block->capacity;
        const size_t octets = (size_t)count * sizeof(double);
        for (int k = 0; k < 3; k++) {
            memcpy(block->rays.o_enu[k], list->o_enu[k] + first, octets);
            memcpy(block->rays.d_enu[k], list->d_enu[k] + first, octets);
        }
        for (int i = 0; i < count; i++) block->rays.far_m[i] = INFINITY;
        block->rays.count = count;
        block->rays.columns = 0;
        block->key = list->key ? list->key + first : NULL;
        shade_samples_shade(shader, scene, block, NULL, -1);
        take_block(out, first, block);
    }
}

#endif
