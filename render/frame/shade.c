/* render/frame/shade.c: rays to hits to radiance: one set of eye rays and one set of sun rays serve all requested
 * channels. */
#include "render/frame/shade_private.h"

#include "render/light/optical.h"
#include "render/light/thermal.h"

void shade_samples_trace(Shader *shader, const ShadeScene *scene, Samples *s, const int *list, int listed)
{
    const double t0 = wall_clock_s();
    visibility_first_hit(&s->hits, scene->visibility, &s->rays,
                         (RayEntities){list, listed, scene->hidden_entity, s->known}, &shader->counters);
    s->hits.several = false;
    shader->visibility_s += wall_clock_s() - t0;
}

/* Shadows fall on crowns, not on the ground below them: raises hits in far woods, and lowers them again. */
static bool raise_far(double z_m[hits_capacity], Shader *shader, const ShadeScene *scene, Hits *hits)
{
    const FarWoods *far = scene->world->far_woods;
    if (!scene->far || !far_woods_find(&shader->far, far, &scene->plants, hits)) return false;
    memcpy(z_m, hits->p_enu[2], (size_t)hits->count * sizeof *z_m);
    for (int i = 0; i < hits->count; i++)
        if (shader->far.stand[i]) hits->p_enu[2][i] += far_woods_top_m(far, shader->far.stand[i] - 1);
    return true;
}

void shade_samples_sun(Shader *shader, const ShadeScene *scene, Samples *s)
{
    const double t0 = wall_clock_s();
    uint8_t      dark[hits_capacity] = {0};
    int          leaves = 0; /* whose temperature follows the same ray */
    const bool   light = s->channels & ~(1u << AIR_LWIR);
    const bool   heat = s->channels & (1u << AIR_MWIR | 1u << AIR_LWIR) || s->temperature;
    for (int i = 0; i < s->hits.count && heat; i++) leaves += s->hits.kind[i] == hit_plant;
    if (light) shader->counters.rays_sun_for_heat += (uint64_t)leaves;
    double     z_m[hits_capacity];
    const bool raised = (leaves > 0 || light) && raise_far(z_m, shader, scene, &s->hits);
    if (leaves > 0 || light)
        visibility_shadow(dark, scene->visibility, &s->hits, scene->air->light.sun_d_enu, &shader->counters);
    if (raised) memcpy(s->hits.p_enu[2], z_m, (size_t)s->hits.count * sizeof *z_m);
    for (int i = 0; i < s->hits.count; i++) s->sun[i] = dark[i] ? 0 : 1;
    if (leaves > 0 || light)
        smoke_shadow(s->sun, scene->effects.volume, scene->effects.count, &s->hits, scene->air->light.sun_d_enu);
    shader->shadow_s += wall_clock_s() - t0;
}

void shade_samples_smoke(const ShadeScene *scene, Samples *s)
{
    smoke_trace_rays(&s->smoke, scene->effects.volume, s->volume, s->volumes, &s->rays, s->hits.range_m, s->channels);
}

/* ---- hits ------------------------------------------------------------------------------------- */

/* What an orthophoto gives for a channel: its own colour, or the brightness of all three. */
static int albedo_of_channel(int channel)
{
    return channel == optical_channel_r   ? albedo_red
           : channel == optical_channel_g ? albedo_green
           : channel == optical_channel_b ? albedo_blue
                                          : albedo_all;
}

/* A sample's footprint on the ground, that its detail is filtered to: longer along a grazing view. */
static void find_footprints(Shader *shader, const Samples *s)
{
    static const float least_graze = 0.01f;
    const Hits        *hits = &s->hits;
    const Rays        *rays = &s->rays;
    for (int i = 0; i < hits->count; i++) {
        float graze = 0;
        for (int k = 0; k < 3; k++) graze -= hits->n_geo[k][i] * (float)rays->d_enu[k][i];
        shader->across_m[i] = (float)(hits->range_m[i] / s->per_rad);
        shader->along_m[i] = shader->across_m[i] / (graze > least_graze ? graze : least_graze);
    }
}

/* Area of the detail's slope at a hit over that of the stored ground below it. With it light per area of the ground is
 * linear in the slopes, so that its mean does not depend on how many of them a footprint resolves, and is that of the
 * class, whose reflectance was measured over such slopes. */
static float bent_area(const Shader *shader, const Hits *hits, int i)
{
    const float up = hits->n_enu[2][i];
    if (!hits->surface[i] || (shader->slope_x[i] == 0 && shader->slope_y[i] == 0)) return 1;
    const float x = hits->n_enu[0][i] - shader->slope_x[i] * up, y = hits->n_enu[1][i] - shader->slope_y[i] * up;
    return sqrtf(x * x + y * y + up * up);
}

/* The ground's detail at each hit, as far as the channels show it: its reflectance relative to that of its class, in
 * the optical channels and (of the photograph) in the one that governs solar heating (pan); temperature, backscatter,
 * slopes. */
static void resolve_detail(Shader *shader, const ShadeScene *scene, const Samples *s)
{
    const Landscape *landscape = scene->world->landscape;
    const Hits      *hits = &s->hits;
    const unsigned   channels = s->channels | 1u << optical_channel_pan;
    const bool       thermal = s->channels & (1u << AIR_MWIR | 1u << AIR_LWIR) || s->temperature;
    const bool       optical = s->channels & ((1u << optical_channel_count) - 1);
    float           *pattern = shader->texture[optical_channel_pan];
    shader->sloped = false;
    find_footprints(shader, s);
    for (int i = 0; i < hits->count; i++) pattern[i] = shader->radar[i] = 1, shader->warmth_k[i] = 0;
    if (landscape && scene->world->detail) {
        const GroundDetail out = {.albedo = optical ? pattern : NULL,
                                  .warmth_k = thermal ? shader->warmth_k : NULL,
                                  .radar = s->radar ? shader->radar : NULL,
                                  .slope_x = s->channels ? shader->slope_x : NULL,
                                  .slope_y = s->channels ? shader->slope_y : NULL};
        detail_at(&out, scene->world->detail, landscape, hits->count, hits->surface, hits->p_enu[0], hits->p_enu[1],
                  &(GroundFootprint){shader->across_m, shader->along_m});
        for (int i = 0; i < hits->count && out.slope_x; i++)
            shader->sloped |= shader->slope_x[i] != 0 || shader->slope_y[i] != 0;
        for (int i = 0; i < hits->count && shader->sloped && optical; i++) pattern[i] *= bent_area(shader, hits, i);
    }
    for (int c = 0; c < optical_channel_count; c++)
        if (channels >> c & 1 && c != optical_channel_pan)
            memcpy(shader->texture[c], pattern, (size_t)hits->count * sizeof *pattern);
    for (int i = 0; i < hits->count && scene->world->forest; i++)
        for (int c = 0; hits->kind[i] == hit_plant && c < optical_channel_count; c++)
            if (channels >> c & 1) shader->texture[c][i] = hits->albedo[i];
    for (int i = 0; i < hits->count; i++) shader->photo[i] = 1;
    if (!landscape || !landscape_has_photo(landscape)) return;
    for (int i = 0; i < hits->count; i++) {
        float albedo[albedo_channels];
        if (!hits->surface[i]) continue;
        landscape_albedo(albedo, landscape, (SurfaceClass)hits->surface[i], hits->p_enu[0][i], hits->p_enu[1][i],
                         (double)shader->along_m[i]);
        for (int c = 0; c < optical_channel_count; c++)
            if (channels >> c & 1) shader->texture[c][i] *= albedo[albedo_of_channel(c)];
        shader->photo[i] = albedo[albedo_all];
    }
}

/* Normals of the ground with the slopes of its detail, for the light alone: footprints, truth and the heat of the slope
 * are of the ground as it is stored. */
static void bend_normals(Hits *hits, const Shader *shader)
{
    for (int i = 0; i < hits->count; i++) {
        const float slope_x = shader->slope_x[i], slope_y = shader->slope_y[i], up = hits->n_enu[2][i];
        if (slope_x == 0 && slope_y == 0) continue;
        const double n_enu[3] = {hits->n_enu[0][i] - slope_x * up, hits->n_enu[1][i] - slope_y * up, up};
        double       bent[3];
        if (!v3_normalize(bent, n_enu)) continue;
        for (int k = 0; k < 3; k++) hits->n_enu[k][i] = (float)bent[k];
    }
}

/* Bends the normals of the ground for the light, levels those of far woods, and gives them back. */
static void keep_normals(Shader *shader, Hits *hits)
{
    if (!shader->sloped && !shader->any_far) return;
    for (int k = 0; k < 3; k++) memcpy(shader->n_enu[k], hits->n_enu[k], (size_t)hits->count * sizeof(float));
    if (shader->sloped) bend_normals(hits, shader);
    for (int i = 0; i < hits->count && shader->any_far; i++)
        if (shader->far.stand[i]) hits->n_enu[0][i] = hits->n_enu[1][i] = 0, hits->n_enu[2][i] = 1;
}

static void restore_normals(const Shader *shader, Hits *hits)
{
    if (!shader->sloped && !shader->any_far) return;
    for (int k = 0; k < 3; k++) memcpy(hits->n_enu[k], shader->n_enu[k], (size_t)hits->count * sizeof(float));
}

/* Ground of woods that were left out takes their canopy's place in what light needs. */
static void find_far(Shader *shader, const ShadeScene *scene, const Samples *s)
{
    const size_t n = (size_t)s->hits.count;
    shader->any_far = scene->far && far_woods_find(&shader->far, scene->world->far_woods, &scene->plants, &s->hits);
    if (!shader->any_far) return;
    FarInputs in = {.places = &shader->far,
                    .sun = s->sun,
                    .material = shader->far_material,
                    .far_sun = shader->far_sun,
                    .radar = shader->radar,
                    .warmer_k = shader->far_k,
                    .of_far = shader->of_far};
    memcpy(in.material, s->hits.material, n * sizeof *in.material);
    memcpy(in.far_sun, s->sun, n * sizeof *in.far_sun);
    for (int c = 0; c < optical_channel_count; c++) in.texture[c] = s->channels >> c & 1 ? shader->texture[c] : NULL;
    far_woods_apply(&in, scene->far, &scene->world->materials, &s->hits, &s->rays);
}

/* The canopy's own temperature, and no plants about what stands for them. */
static void warm_far(Shader *shader, const ShadeScene *scene, Samples *s)
{
    for (int i = 0; i < s->hits.count && shader->any_far; i++) {
        const double p_enu[3] = {s->hits.p_enu[0][i], s->hits.p_enu[1][i], s->hits.p_enu[2][i]};
        if (!shader->far.stand[i]) continue;
        const float canopy_k =
            (float)daylight_temp_at(&scene->air->light, p_enu) + shader->far_k[i] + shader->warmth_k[i];
        s->temp_k[i] += shader->of_far[i] * (canopy_k - s->temp_k[i]);
    }
}

static void open_far(Shader *shader, const Samples *s)
{
    CanopyLight *c = &shader->canopy;
    for (int i = 0; i < s->hits.count && shader->any_far && shader->any_canopy; i++) {
        if (!shader->far.stand[i]) continue;
        c->up[i] = c->down[i] = 1;
        for (int k = 0; k < optical_channel_count; k++) c->ground[k][i] = 1, c->leaves_w_m2[k][i] = 0;
    }
}

/* ---- light ------------------------------------------------------------------------------------ */

/* Rays that met nothing. */
static void shade_beyond(const Shader *shader, const ShadeScene *scene, const Samples *s,
                         float *const out[AIR_BAND_COUNT])
{
    const Air *air = scene->air;
    double     ground_w_m2[optical_channel_count];
    for (int c = 0; c < optical_channel_count; c++)
        ground_w_m2[c] = optical_ground_w_m2(c, air, &scene->world->materials);
    for (int i = 0; i < s->hits.count; i++) {
        if (s->hits.range_m[i] < INFINITY) continue;
        const double d_enu[3] = {s->rays.d_enu[0][i], s->rays.d_enu[1][i], s->rays.d_enu[2][i]};
        for (int c = 0; c < optical_channel_count; c++)
            if (out[c]) out[c][i] = optical_beyond(c, air, ground_w_m2[c], d_enu, &shader->air[c], i);
        if (out[AIR_MWIR]) out[AIR_MWIR][i] = thermal_beyond(BAND_MWIR, air, d_enu, &shader->air[AIR_MWIR], i);
        if (out[AIR_LWIR]) out[AIR_LWIR][i] = thermal_beyond(BAND_LWIR, air, d_enu, &shader->air[AIR_LWIR], i);
    }
}

static const uint16_t *material_of(const Shader *shader, const Samples *s)
{
    return shader->any_far ? shader->far_material : s->hits.material;
}
static const float *sun_of(const Shader *shader, const Samples *s)
{
    return shader->any_far ? shader->far_sun : s->sun;
}

/* hemisphere_below of each hit; NULL: 1. */
static const float *below_of(const Shader *shader, const ShadeScene *scene, AirBand b)
{
    if (scene->sky_samples > 0) return shader->gathered.below[b];
    return shader->any_open && shader->open.any_below ? shader->open.below[b] : NULL;
}

/* What mirrors show, as surface_light_shade has it; false: nothing but open sky and level ground. around_w_m2: as
 * sampled. */
static bool light_in_mirrors(MirrorLight *out, float sky[hits_capacity], const Shader *shader, const ShadeScene *scene,
                             const Samples *s, AirBand b)
{
    const Daylight  *light = &scene->air->light;
    const Materials *materials = &scene->world->materials;
    const bool       sampled = scene->sky_samples > 0;
    const double     level_w_m2 =
        b >= AIR_MWIR ? light->ground_w_m2_sr[b] * pi_rad : optical_ground_w_m2((int)b, scene->air, materials);
    if (!sampled && !shader->any_open) return false;
    *out = (MirrorLight){sky, below_of(shader, scene, b)};
    for (int i = 0; i < s->hits.count; i++) {
        const double n_enu[3] = {s->hits.n_enu[0][i], s->hits.n_enu[1][i], s->hits.n_enu[2][i]};
        const double sky_w_m2 = daylight_on_plane(light, b, n_enu), ground_w_m2 = level_w_m2 * 0.5 * (1 - n_enu[2]);
        const double all_w_m2 = sampled ? (double)shader->gathered.w_m2[b][i]
                                        : (double)shader->open.factor[b][i] * (sky_w_m2 + ground_w_m2);
        const double from_below_w_m2 = ground_w_m2 * (out->below ? (double)out->below[i] : 1);
        sky[i] = (float)mirror_sky_factor(all_w_m2 - from_below_w_m2, sky_w_m2, light->sky_w_m2[b]);
        /* that of leaves is of both sides */
        if (sampled && material_through(&materials->material[material_of(shader, s)[i]], (int)b) > 0) sky[i] = 1;
    }
    return true;
}

static void light_channels(Shader *shader, const ShadeScene *scene, Samples *s)
{
    const World    *world = scene->world;
    const PartTemps parts = {scene->snapshot, world->patches, scene->visibility};
    if (s->channels & (1u << AIR_MWIR | 1u << AIR_LWIR) || s->temperature)
        thermal_temperature(s->temp_k, scene->air, &world->materials, &parts, &s->hits, s->hits.material, s->sun,
                            shader->photo, shader->warmth_k);
    if (shader->terms) shade_terms_heat(shader->terms, scene, s, &parts, shader->photo, shader->warmth_k);
    if (s->channels & (1u << AIR_MWIR | 1u << AIR_LWIR) || s->temperature) warm_far(shader, scene, s);
    if (!s->channels) return;
    air_paths_of(shader->air, scene->air, s->channels, &s->hits, &s->rays, s->temp_k);

    SurfaceBlock block = {.hits = &s->hits,
                          .rays = &s->rays,
                          .material = material_of(shader, s),
                          .temp_k = s->temp_k,
                          .sun = sun_of(shader, s),
                          .veils = shader->air,
                          .canopy = shader->any_canopy ? &shader->canopy : NULL};
    float       *out[AIR_BAND_COUNT] = {NULL};
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(s->channels >> b & 1)) continue;
        out[b] = s->radiance[b];
        if (b < optical_channel_count) block.texture[b] = shader->texture[b];
        if (scene->sky_samples > 0) block.around_w_m2[b] = shader->gathered.w_m2[b];
        else if (shader->any_open) block.open[b] = shader->open.factor[b];
        block.below[b] = below_of(shader, scene, (AirBand)b);
    }
    keep_normals(shader, &s->hits);
    for (int b = 0; b < AIR_BAND_COUNT && shader->terms; b++) block.mirror_sky_found[b] = shader->terms->mirror_sky[b];
    surface_light_shade(out, &scene->surface_light, &block);
    for (int b = 0; b < AIR_BAND_COUNT && shader->terms; b++) {
        block.mirror_sky_found[b] = NULL;
        if (out[b]) block.mirror_sky[b] = shader->terms->mirror_sky[b];
    }
    if (shader->terms) shade_terms_light(shader->terms, scene, s, &block);
    restore_normals(shader, &s->hits);
    shade_lamps_add(out, scene, s, block.material, (const float(*)[hits_capacity])shader->texture, shader->air,
                    shader->terms ? shader->terms->lamps : NULL);
    shade_beyond(shader, scene, s, out);
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (out[b]) smoke_apply(out[b], &s->smoke, b, s->hits.count);
}

/* What buildings leave of the sky, beside what entities do. */
static void open_horizons(Shader *shader, const ShadeScene *scene, const Samples *s)
{
    SkyOpen *open = &shader->open;
    if (!scene->horizons || !s->channels) return;
    for (int b = 0; b < AIR_BAND_COUNT && !shader->any_open; b++)
        if (s->channels >> b & 1)
            for (int i = 0; i < s->hits.count; i++) open->factor[b][i] = 1;
    if (!shader->any_open) open->any_below = false;
    for (int b = 0; b < AIR_BAND_COUNT && !open->any_below; b++)
        if (s->channels >> b & 1)
            for (int i = 0; i < s->hits.count; i++) open->below[b][i] = 1;
    shader->any_open = true;
    open->any_below |=
        sky_horizon_open(open->factor, open->below, scene->horizons, &scene->horizon_light, s->channels, &s->hits);
}

static void light_radar(Shader *shader, const ShadeScene *scene, Samples *s)
{
    radar_shade(&s->returns, &scene->world->radar,
                &(RadarRays){.visibility = scene->visibility,
                             .materials = &scene->world->materials,
                             .hits = &s->hits,
                             .rays = &s->rays,
                             .hidden = scene->hidden_entity},
                &shader->counters);
    for (int i = 0; i < s->hits.count; i++) s->returns.power[0][i] *= shader->radar[i];
    for (int i = 0; i < s->hits.count; i++) {
        double sum = 0;
        for (int b = 0; b < radar_bounces; b++) sum += s->returns.power[b][i];
        s->radar_power[i] = (float)sum;
    }
}

void shade_samples_light(Shader *shader, const ShadeScene *scene, Samples *s)
{
    const double          t0 = wall_clock_s();
    const HemisphereScene around = {scene->visibility, scene->air, &scene->world->materials, scene->world->patches,
                                    scene->snapshot};
    resolve_detail(shader, scene, s);
    find_far(shader, scene, s);
    shade_samples_smoke(scene, s);
    if (scene->sky_samples > 0)
        hemisphere_light(&shader->gathered, &around, &s->hits, s->channels, scene->sky_samples, s->key,
                         &shader->counters);
    shader->any_open = scene->sky && s->channels &&
                       sky_visibility_open(&shader->open, scene->sky, shader->sky, &s->hits, &shader->counters);
    open_horizons(shader, scene, s);
    shader->any_canopy = scene->world->canopy && scene->sky_samples == 0 && s->channels &&
                         canopy_light(&shader->canopy, scene->world->canopy, scene->world->landscape,
                                      &scene->air->light, scene->world->materials.ground_rho, &s->hits, s->channels);
    open_far(shader, s);
    light_channels(shader, scene, s);
    const double t1 = wall_clock_s();
    if (s->radar) light_radar(shader, scene, s);
    shader->shade_s += t1 - t0;
    shader->radar_s += wall_clock_s() - t1;
}

void shade_samples_shade(Shader *shader, const ShadeScene *scene, Samples *s, const int *list, int listed)
{
    shade_samples_trace(shader, scene, s, list, listed);
    shade_samples_sun(shader, scene, s);
    shade_samples_light(shader, scene, s);
}

/* ---- without tables --------------------------------------------------------------------------- */

/* Irradiance of a plane at hit i from sky, ground and leaves; level_w_m2: exitance of open ground. */
static double light_on_side(const Shader *shader, const ShadeScene *scene, AirBand b, int i, const double n_enu[3],
                            double level_w_m2)
{
    const CanopyLight *c = &shader->canopy;
    const double       sky_w_m2 = daylight_on_plane(&scene->air->light, b, n_enu), down = 0.5 * (1 - n_enu[2]);
    if (!shader->any_canopy || b >= AIR_MWIR) return sky_w_m2 + level_w_m2 * down;
    const double sees_sky = (double)c->up[i], sees_ground = (double)c->down[i];
    return sees_sky * sky_w_m2 + sees_ground * (double)c->ground[b][i] * level_w_m2 * down +
           (1 - sees_sky * (1 - down) - sees_ground * down) * (double)c->leaves_w_m2[b][i];
}

/* Irradiance of a channel from all around at each hit, W/m2; NULL: from the tilt alone. */
static const float *light_around(float room[hits_capacity], const Shader *shader, const ShadeScene *scene,
                                 const Samples *s, AirBand b)
{
    const Air *air = scene->air;
    if (scene->sky_samples > 0) return shader->gathered.w_m2[b];
    if (!shader->any_open && !(shader->any_canopy && b < AIR_MWIR)) return NULL;
    const double level_w_m2 = b >= AIR_MWIR ? air->light.ground_w_m2_sr[b] * pi_rad
                                            : optical_ground_w_m2((int)b, air, &scene->world->materials);
    for (int i = 0; i < s->hits.count; i++) {
        const double n_enu[3] = {s->hits.n_enu[0][i], s->hits.n_enu[1][i], s->hits.n_enu[2][i]};
        const double through = material_through(&scene->world->materials.material[material_of(shader, s)[i]], (int)b);
        double       both = light_on_side(shader, scene, b, i, n_enu, level_w_m2);
        if (through > 0)
            both += through *
                    light_on_side(shader, scene, b, i, (const double[3]){-n_enu[0], -n_enu[1], -n_enu[2]}, level_w_m2);
        room[i] = (float)((shader->any_open ? (double)shader->open.factor[b][i] : 1) * both);
    }
    return room;
}

void shade_samples_light_directly(Shader *shader, const ShadeScene *scene, Samples *s, AirPaths direct[AIR_BAND_COUNT])
{
    const Materials *materials = &scene->world->materials;
    keep_normals(shader, &s->hits);
    air_paths_directly(direct, scene->air, s->channels, &s->hits, &s->rays, s->temp_k, shader->air);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        float       room[hits_capacity], sky[hits_capacity], *out = s->radiance[b];
        MirrorLight shown, *mirror = NULL;
        if (!(s->channels >> b & 1)) continue;
        const float *around = light_around(room, shader, scene, s, (AirBand)b);
        if (light_in_mirrors(&shown, sky, shader, scene, s, (AirBand)b)) mirror = &shown;
        if (b >= AIR_MWIR)
            thermal_shade(out, b == AIR_MWIR ? BAND_MWIR : BAND_LWIR, scene->air, materials, &s->hits, &s->rays,
                          material_of(shader, s), s->temp_k, sun_of(shader, s), around, mirror, &direct[b], NULL);
        else
            optical_shade(out, b, scene->air, materials, &s->hits, &s->rays, material_of(shader, s), shader->texture[b],
                          sun_of(shader, s), around, mirror, &direct[b], NULL);
    }
    restore_normals(shader, &s->hits);
    shade_lamps_add(s->radiance, scene, s, material_of(shader, s), (const float(*)[hits_capacity])shader->texture,
                    direct, NULL);
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (s->channels >> b & 1) smoke_apply(s->radiance[b], &s->smoke, b, s->hits.count);
}
