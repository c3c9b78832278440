/* render/frame/shade_scene.c: opens what the samples of a frame share: what rays meet, plants, smoke, lamps and the
 * sky between buildings. */
#include "render/frame/shade_private.h"

#include "entities/scenery/scenery_exhaust.h"
#include "entities/scenery/scenery_smoke.h"
#include "entities/scenery/scenery_traces.h"
#include "render/light/optical.h"

/* The plants as this frame's eye sees them. */
static Status open_plants(ShadeScene *scene, Visibility *visibility, const RenderRequest *request, Pool *pool,
                          Arena *arena)
{
    const Weather *weather = &scene->air->light.weather;
    const double   wind_mps[2] = {-weather->wind_mps * sin(weather->wind_from_rad),
                                  -weather->wind_mps * cos(weather->wind_from_rad)};
    if (!scene->world->forest) {
        scene->bare = scene->full = visibility;
        return STATUS_OK;
    }
    Status status = forest_frame_open(&scene->plants, scene->world->forest, request->view.p_enu, request->view.focal_px,
                                      request->low_plants_m, request->t_s, wind_mps, pool, arena);
    scene->plants.ray_px = 1 / fmax(request->samples, 1); /* samples x samples rays a pixel */
    if (status == STATUS_OK) status = visibility_plants(visibility, &scene->plants);
    if (status != STATUS_OK) return status;
    scene->bare = visibility_without_plants(visibility, arena);
    scene->full = visibility_with_full_plants(visibility, arena);
    return scene->bare && scene->full ? STATUS_OK : STATUS_NO_MEMORY;
}

static void open_sky_of_scenery(ShadeScene *scene)
{
    double level_w_m2[AIR_BAND_COUNT];
    if (!scene->world->horizons) return;
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        level_w_m2[b] = b >= AIR_MWIR ? scene->air->light.ground_w_m2_sr[b] * pi_rad
                                      : optical_ground_w_m2(b, scene->air, &scene->world->materials);
    sky_horizon_light(&scene->horizon_light, scene->world->horizons, scene->air, level_w_m2);
    scene->horizons = scene->world->horizons;
}

/* Smoke, dust and gas of scenery, behind the snapshot's own. */
static Status add_scenery_puffs(Snapshot *snapshot, const World *world, const View *view, Arena *arena)
{
    const Scenery *scenery = scenery_tracer_of(world->scenery);
    const double  *r = view->r_enu_from_cam;
    double         half[2];
    view_half_tangents(half, view);
    const SceneryCone seen = {.p_enu = {view->p_enu[0], view->p_enu[1], view->p_enu[2]},
                              .d_enu = {r[2], r[5], r[8]},
                              .tangent = hypot(half[0], half[1])};
    Status            status = scenery_smoke(snapshot, scenery, &world->frame, view->p_enu, arena);
    if (status == STATUS_OK) status = scenery_dust(snapshot, scenery, &world->frame, &seen, arena);
    return status == STATUS_OK ? scenery_exhaust(snapshot, scenery, &world->frame, &seen, arena) : status;
}

Status shade_scene_create(ShadeScene *scene, const RenderRequest *request, unsigned channels, Pool *pool, Arena *arena)
{
    const World    *world = scene->world;
    const Snapshot *snapshot = scene->snapshot;
    const Air      *air = scene->air;
    Visibility     *posed = NULL;
    *scene = (ShadeScene){.world = world,
                          .snapshot = snapshot,
                          .air = air,
                          .sky_samples = request->sky_samples,
                          .hidden_entity = request->hidden_entity};
    const double     bend_per_m = request->refraction ? world_bend(world, REFRACTION_OPTICAL, request->view.p_enu) : 0;
    const EffectView seen = {.bend_per_m = bend_per_m,
                             .frame = &world->frame,
                             .view = &request->view,
                             .ground_rho = world->materials.ground_rho,
                             .bands = channels,
                             .hidden = request->hidden_entity};
    Snapshot         smoking = *snapshot; /* with what burns and drives of scenery */
    Status           status = STATUS_OK;
    if (world->scenery) status = add_scenery_puffs(&smoking, world, &request->view, arena);
    if (status == STATUS_OK) status = smoke_effects_scene(&scene->effects, &smoking, &seen, air, arena);
    if (status != STATUS_OK) return status;
    int *volume = arena_alloc(arena, (size_t)scene->effects.count + 1, sizeof *volume);
    if (!volume) return STATUS_NO_MEMORY;
    for (int n = 0; n < scene->effects.count; n++) volume[n] = n;
    scene->all_volumes = volume;
    VisibilityConfig eye = {.tracer = world->tracer,
                            .ground = world->landscape,
                            .cells = world->cells,
                            .frame = &world->frame,
                            .snapshot = snapshot,
                            .skips_off = request->skips_off,
                            .bend_per_m = bend_per_m};
    memcpy(eye.eye_enu, request->view.p_enu, sizeof eye.eye_enu);
    status = visibility_create_seen(&posed, &eye, arena);
    if (status != STATUS_OK) return status;
    visibility_materials(posed, &world->materials);
    status = world_scenery_join(posed, world, request->t_s, &eye, arena);
    if (status != STATUS_OK) return status;
    scene->visibility = posed;
    status = shade_lamps_open(scene, arena);
    if (status == STATUS_OK) status = world_need_patches(world, snapshot);
    if (status != STATUS_OK) return status;
    if (request->sky_visibility && request->sky_samples == 0) open_sky_of_scenery(scene);
    status = open_plants(scene, posed, request, pool, arena);
    if (status != STATUS_OK) return status;
    status = far_woods_frame(&scene->far, world->far_woods, air, &world->materials, arena);
    if (status != STATUS_OK) return status;
    return surface_light_prepare(&scene->surface_light, air, &world->materials, arena);
}

void shade_scene_close(ShadeScene *scene) { forest_frame_close(&scene->plants); }

Status shade_samples_create(Samples *out, int capacity, Arena *arena)
{
    const size_t n = (size_t)capacity;
    bool         ok = capacity >= 1 && capacity <= hits_capacity;
    *out = (Samples){.capacity = capacity, .rays.bent = true};
    for (int b = 0; b < AIR_BAND_COUNT; b++) ok = ok && (out->radiance[b] = arena_alloc(arena, n, sizeof(float)));
    ok = ok && (out->sun = arena_alloc(arena, n, sizeof *out->sun));
    ok = ok && (out->temp_k = arena_alloc(arena, n, sizeof *out->temp_k));
    ok = ok && (out->radar_power = arena_alloc(arena, n, sizeof *out->radar_power));
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}
