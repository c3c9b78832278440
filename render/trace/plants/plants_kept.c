/* render/trace/plants/plants_kept.c: prototypes to octets, and back with every number checked. */
#include "render/trace/plants/plants_kept.h"

#include <stddef.h>
#include <stdlib.h>

_Static_assert(sizeof(PlantQuad) == 4 * 3 * sizeof(float) + 4 + 4 * 3 * sizeof(float) + 3 * sizeof(float),
               "no padding: the octets are the numbers");

enum { most_quads = 1 << 18 };

size_t plants_to_octets(void *out, const Plants *plants)
{
    size_t       at = sizeof *plants;
    const size_t patterns = (size_t)plants->patterned * sizeof *plants->pattern;
    if (out) {
        memcpy(out, plants, sizeof *plants);
        memset((char *)out + offsetof(Plants, pattern), 0, sizeof plants->pattern);
        if (patterns > 0) memcpy((char *)out + at, plants->pattern, patterns);
    }
    at += patterns;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++) {
            const PlantShape *shape = &plants->shape[kind][level];
            const size_t      octets = (size_t)shape->quads * sizeof *shape->quad;
            if (out) memset((char *)out + ((const char *)&shape->quad - (const char *)plants), 0, sizeof shape->quad);
            if (out && octets > 0) memcpy((char *)out + at, shape->quad, octets);
            at += octets;
        }
    return at;
}

static bool all_finite(const float *value, int count)
{
    for (int i = 0; i < count; i++)
        if (!isfinite(value[i])) return false;
    return true;
}

static bool is_quad(const PlantQuad *q)
{
    return q->organ < PLANT_ORGANS && q->outline < plant_outlines && all_finite(q->corner[0], 12) &&
           all_finite(q->n[0], 12) && all_finite(&q->radius, 1) && q->open_up >= 0 && q->open_up <= 1 &&
           q->open_down >= 0 && q->open_down <= 1;
}

static bool is_shape(const PlantShape *s)
{
    return s->quads > 0 && s->quads <= most_quads && s->bark_quads >= 0 && s->bark_quads <= s->quads &&
           s->pieces >= 0 && s->pieces <= most_quads && s->leaves == s->quads - s->bark_quads &&
           all_finite(s->low, 3) && all_finite(s->high, 3) && isfinite(s->leaf_area) && isfinite(s->crown_low) &&
           isfinite(s->crown_radius);
}

static bool is_pattern(const LeafPattern *p)
{
    const uint8_t *cell = p->leaflet[0];
    if (p->leaflets < 0 || p->leaflets > plant_leaflets_most || !isfinite(p->area) || !isfinite(p->middle))
        return false;
    for (int k = 0; k < plant_pattern_side * plant_pattern_side; k++)
        if (cell[k] > p->leaflets) return false;
    return all_finite(p->foot[0], 2 * plant_leaflets_most) && all_finite(p->tip[0], 2 * plant_leaflets_most);
}

static bool is_kind(const Plants *p, int kind)
{
    for (int k = 0; k < plant_outlines; k++) {
        const LeafOutline *o = &p->outline[kind][k];
        if (o->corners < 0 || o->corners > plant_outline_corners_most || !isfinite(p->outline_area[kind][k]))
            return false;
        if (!all_finite(o->uv[0], 2 * o->corners)) return false;
    }
    for (int level = 0; level < plant_levels; level++)
        if (!is_shape(&p->shape[kind][level])) return false;
    return true;
}

/* Takes the patterns from *at on. */
static Status take_patterns(Plants *p, const char **at, const char *end)
{
    const size_t octets = (size_t)p->patterned * sizeof *p->pattern;
    if (octets == 0) return STATUS_OK;
    if ((size_t)(end - *at) < octets) return STATUS_BAD_VALUE;
    if (!(p->pattern = malloc(octets))) return STATUS_NO_MEMORY;
    memcpy(p->pattern, *at, octets);
    *at += octets;
    for (int k = 0; k < p->patterned * plant_outlines; k++)
        if (!is_pattern(&p->pattern[0][k])) return STATUS_BAD_VALUE;
    return STATUS_OK;
}

/* Takes the quads of a shape from *at on. */
static Status take_quads(PlantShape *shape, const char **at, const char *end)
{
    const size_t octets = (size_t)shape->quads * sizeof *shape->quad;
    if ((size_t)(end - *at) < octets) return STATUS_BAD_VALUE;
    shape->quad = malloc(octets);
    if (!shape->quad) return STATUS_NO_MEMORY;
    memcpy(shape->quad, *at, octets);
    *at += octets;
    for (int q = 0; q < shape->quads; q++)
        if (!is_quad(&shape->quad[q])) return STATUS_BAD_VALUE;
    return STATUS_OK;
}

Status plants_from_octets(Plants **out, const void *octets, size_t count)
{
    const char *at = octets, *end = at + count;
    Plants     *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    Status status = count >= sizeof *p ? STATUS_OK : STATUS_BAD_VALUE;
    if (status == STATUS_OK) {
        memcpy(p, at, sizeof *p);
        at += sizeof *p;
        p->pattern = NULL;
        if (p->patterned < 0 || p->patterned > PLANT_STANDING) status = STATUS_BAD_VALUE, p->patterned = 0;
    }
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++) p->shape[kind][level].quad = NULL;
    for (int kind = 0; kind < PLANT_KINDS && status == STATUS_OK; kind++)
        if (!is_kind(p, kind)) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = take_patterns(p, &at, end);
    for (int kind = 0; kind < PLANT_KINDS && status == STATUS_OK; kind++)
        for (int level = 0; level < plant_levels && status == STATUS_OK; level++)
            status = take_quads(&p->shape[kind][level], &at, end);
    if (status == STATUS_OK && at != end) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) *out = p;
    else plants_destroy(p);
    return status;
}
