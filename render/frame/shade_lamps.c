/* render/frame/shade_lamps.c: light of lamps by night, on top of what sun, sky and heat give. */
#include "render/frame/shade_private.h"

Status shade_lamps_open(ShadeScene *scene, Arena *arena)
{
    const World        *world = scene->world;
    const SceneryFrame *frame = scenery_frame_in(scene->visibility);
    if (!frame || world->lamps.count == 0) return STATUS_OK;
    return lamp_light_create(&scene->lamps, &world->lamps, frame, scene->air->light.sun_d_enu,
                             world->frame.origin.lat_rad, arena);
}

void shade_lamps_add(float *const out[AIR_BAND_COUNT], const ShadeScene *scene, const Samples *s,
                     const uint16_t *material, const float (*texture)[hits_capacity], const AirPaths *path,
                     float (*noted)[hits_capacity])
{
    const unsigned optical = s->channels & ((1u << optical_channel_count) - 1);
    const float   *of[AIR_BAND_COUNT] = {NULL};
    double         w_m2_sr[optical_channel_count];
    for (int c = 0; c < optical_channel_count; c++) of[c] = optical >> c & 1 ? texture[c] : NULL;
    if (!scene->lamps || !optical) return;
    for (int i = 0; i < s->hits.count; i++) {
        lamp_light_at(w_m2_sr, scene->lamps, &scene->world->materials, material[i], of, optical, &s->hits, &s->rays, i);
        for (int c = 0; c < optical_channel_count; c++) {
            if (!(optical >> c & 1)) continue;
            if (noted) noted[c][i] = (float)w_m2_sr[c];
            if (out[c] && w_m2_sr[c] > 0) out[c][i] = fmaf((float)w_m2_sr[c], path[c].air_transmittance[i], out[c][i]);
        }
    }
}
