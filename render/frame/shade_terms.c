/* render/frame/shade_terms.c: the terms of a block's light and temperatures, for the record of a pixel. Each is what
 * the functions that shade the block give when everything else is switched off, so that no formula is written twice. */
#include "render/frame/shade_private.h"

#include "render/light/optical.h"
#include "render/light/thermal.h"

/* ---- light --------------------------------------------------------------------------------------- */

/* Paths that pass one spectrum alone, and add nothing. */
typedef enum Spectrum { emitted_light, air_light, sun_light } Spectrum;

static void pass(ShadeTerms *t, Spectrum which)
{
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        AirPaths *path = &t->path[b];
        for (int i = 0; i < hits_capacity; i++) {
            path->transmittance[i] = which == emitted_light;
            path->air_transmittance[i] = which == air_light;
            path->sun_transmittance[i] = which == sun_light;
            path->added_w_m2_sr[i] = 0;
        }
    }
}

static void shade(float (*to)[hits_capacity], const SurfaceLight *light, const SurfaceBlock *block, unsigned channels)
{
    float *out[AIR_BAND_COUNT] = {NULL};
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (channels >> b & 1) out[b] = to[b];
    surface_light_shade(out, light, block);
}

void shade_terms_light(ShadeTerms *t, const ShadeScene *scene, const Samples *s, const SurfaceBlock *block)
{
    const Air   *air = scene->air;
    SurfaceBlock of = *block;
    of.veils = t->path;
    pass(t, emitted_light);
    shade(t->emitted, &scene->surface_light, &of, s->channels);
    pass(t, sun_light);
    shade(t->sunlit, &scene->surface_light, &of, s->channels);
    pass(t, air_light);
    shade(t->reflected, &scene->surface_light, &of, s->channels);

    /* of the sky alone, then of the ground alone, and nothing from plants or from what was sampled all round */
    memset(t->none, 0, sizeof t->none);
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (block->around_w_m2[b]) of.around_w_m2[b] = t->none;
    if (block->canopy) {
        t->canopy = *block->canopy;
        memset(t->canopy.leaves_w_m2, 0, sizeof t->canopy.leaves_w_m2);
        of.canopy = &t->canopy;
    }
    t->light = scene->surface_light;
    memset(t->light.level_w_m2_sr, 0, sizeof t->light.level_w_m2_sr);
    shade(t->sky, &t->light, &of, s->channels);
    t->light = scene->surface_light;
    memset(t->light.plane, 0, sizeof t->light.plane);
    memset(t->light.scattered, 0, sizeof t->light.scattered);
    memset(t->light.thermal, 0, sizeof t->light.thermal);
    shade(t->ground, &t->light, &of, s->channels);

    memset(t->lamps, 0, sizeof t->lamps);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        t->beyond[b] = b >= AIR_MWIR ? air->light.ground_w_m2_sr[b]
                                     : optical_ground_w_m2(b, air, &scene->world->materials) / pi_rad;
        for (int i = 0; i < s->hits.count && s->channels >> b & 1; i++) {
            const double d_enu[3] = {s->rays.d_enu[0][i], s->rays.d_enu[1][i], s->rays.d_enu[2][i]};
            const bool   sky = !(block->veils[b].range_m[i] < INFINITY) && b != AIR_LWIR;
            t->disc[b][i] = sky ? air->sun_eye_w_m2[b] * daylight_sun_disc(&air->light, d_enu) : 0;
        }
    }
}

/* ---- temperature --------------------------------------------------------------------------------- */

void shade_terms_heat(ShadeTerms *t, const ShadeScene *scene, const Samples *s, const PartTemps *parts,
                      const float *photo, const float *warmth_k)
{
    const Air       *air = scene->air;
    const Materials *materials = &scene->world->materials;
    const Hits      *hits = &s->hits;
    memset(t->none, 0, sizeof t->none);
    for (int i = 0; i < hits_capacity; i++) t->one[i] = 1;
    /* ground of no class is as warm as the air */
    t->hits = *hits;
    for (int i = 0; i < hits->count; i++)
        t->hits.kind[i] = hit_ground, t->hits.entity[i] = 0, t->hits.surface[i] = SURFACE_NONE;
    thermal_temperature(t->air_k, air, materials, parts, &t->hits, hits->material, t->none, t->one, t->none);
    thermal_temperature(t->still_k, air, materials, parts, hits, hits->material, t->none, t->one, t->none);
    thermal_temperature(t->sunlit_k, air, materials, parts, hits, hits->material, s->sun, photo, t->none);
    thermal_temperature(t->detailed_k, air, materials, parts, hits, hits->material, s->sun, photo, warmth_k);
}
