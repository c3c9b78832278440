/* render/trace/plants/plants_kept.c: the light of prototypes to octets, and back with every number checked. */
#include "render/trace/plants/plants_kept.h"

_Static_assert(offsetof(PlantQuad, open_down) == offsetof(PlantQuad, open_up) + sizeof(float), "they are two floats");

_Static_assert(sizeof(PlantShade) == 2 * plant_shade_ways * plant_shade_heights * sizeof(float), "floats alone");

static const size_t octets_a_quad = 2 * sizeof(float);

/* Those whose light is kept. */
static PlantShape *shape_of(Plants *plants, int k)
{
    const int kind = k / plant_levels, level = k % plant_levels;
    return level == plant_fine && kind < plants->patterned ? NULL : &plants->shape[kind][level];
}

size_t plants_light_to_octets(void *out, const Plants *plants)
{
    size_t at = sizeof plants->shade;
    if (out) memcpy(out, plants->shade, sizeof plants->shade);
    for (int k = 0; k < PLANT_KINDS * plant_levels; k++) {
        const PlantShape *shape = shape_of((Plants *)(uintptr_t)plants, k);
        for (int q = 0; shape && q < shape->quads; q++, at += octets_a_quad)
            if (out) memcpy((char *)out + at, &shape->quad[q].open_up, octets_a_quad);
    }
    return at;
}

Status plants_light_from_octets(Plants *plants, const void *octets, size_t count)
{
    if (count != plants_light_to_octets(NULL, plants)) return STATUS_BAD_VALUE;
    for (size_t at = 0; at < count; at += sizeof(float)) {
        float share;
        memcpy(&share, (const char *)octets + at, sizeof share);
        if (!(share >= 0 && share <= (at < sizeof plants->shade ? plant_shade_most : 1))) return STATUS_BAD_VALUE;
    }
    memcpy(plants->shade, octets, sizeof plants->shade);
    octets = (const char *)octets + sizeof plants->shade;
    for (int k = 0; k < PLANT_KINDS * plant_levels; k++) {
        PlantShape *shape = shape_of(plants, k);
        for (int q = 0; shape && q < shape->quads; q++, octets = (const char *)octets + octets_a_quad)
            memcpy(&shape->quad[q].open_up, octets, octets_a_quad);
    }
    return STATUS_OK;
}
