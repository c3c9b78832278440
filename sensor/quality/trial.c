/* sensor/quality/trial.c: the scene of a measurement, and one frame of it with the time of each stage. */
#include "sensor/quality/trial_private.h"

#include "entities/motion/dead_reckoning.h"
#include "render/scene/view.h"
#include "sensor/frame/frame.h"
#include "sensor/settings/config.h"

/* ---- entities ----------------------------------------------------------------------------- */

enum { a_row = 5 };

Status trial_scene_place(const TrialScene *scene, const TrialPlace *place)
{
    const LocalFrame *frame = &scene->landscape->frame;
    const double      turn = place->turn_rad;
    const double      r_enu_from_body[9] = {sin(turn), cos(turn), 0, cos(turn), -sin(turn), 0, 0, 0, -1};
    const double      p_enu[3] = {place->east_m, place->north_m,
                                  elevation_height(&scene->landscape->elevation, place->east_m, place->north_m, NULL) +
                                      place->above_m};
    double            r_ecef_from_body[9], euler[3];
    DisEntityState    pdu = {.header = {.version = 7, .type = dis_pdu_entity_state},
                             .force = 1,
                             .type = place->type,
                             .id = {1, 1, (uint16_t)place->number},
                             .appearance = place->appearance,
                             .dead_reckoning = 2};
    ecef_from_enu(pdu.p_ecef, frame, p_enu);
    m3_mul(r_ecef_from_body, frame->r_ecef_from_enu, r_enu_from_body);
    euler_from_r_ecef_from_body(&euler[0], &euler[1], &euler[2], r_ecef_from_body);
    pdu.psi_rad = (float)euler[0];
    pdu.theta_rad = (float)euler[1];
    pdu.phi_rad = (float)euler[2];
    /* the azimuth of primary turret 1, and the elevation of primary gun 1 */
    pdu.variable[0] = (DisVariableParameter){.parameter = 4096 + 11, .value = (float)(turn - 3)};
    pdu.variable[1] = (DisVariableParameter){.parameter = 4416 + 13, .value = 0.1f};
    pdu.variable_count = 2;
    return entity_table_entity_state(scene->table, &pdu, scene->sun_now_s);
}

static TrialPlace vehicle_place(DisEntityType type, int index, int vehicles)
{
    const int rows = (vehicles + a_row - 1) / a_row;
    return (TrialPlace){.type = type,
                        .number = index + 1,
                        .appearance = 1u << 22,
                        .east_m = 40.0 * (index % a_row) - 20.0 * (vehicles < a_row ? vehicles - 1 : a_row - 1),
                        .north_m = 40.0 * (index / a_row) - 20.0 * (rows - 1),
                        .turn_rad = vehicles == 1 ? 0.6 : 2 * pi_rad * random_uniform(1, 1, 0, (uint64_t)index)};
}

Status trial_scene_warm(TrialScene *scene, const HeatConfig *config)
{
    HeatConfig heat = *config;
    heat.unix_s = scene->unix_s;
    world_vehicles_destroy(scene->vehicles);
    scene->vehicles = NULL;
    return world_warm_clear(&scene->world, &heat, 16, NULL);
}

Status trial_scene_open(TrialScene *out, const Landscape *landscape, const char *catalog_path,
                        const DisEntityType *types, int type_count, int vehicles)
{
    TrialScene        scene = {.landscape = landscape, .sun_now_s = 60};
    EntityTableConfig config = entity_table_default_config();
    config.ground = (ContactGround){.frame = &landscape->frame, .elevation = &landscape->elevation};
    Status status = text_to_unix_s(&scene.unix_s, "2026-06-21T11:15:00Z") ? STATUS_OK : STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = catalog_open(&scene.catalog, catalog_path, 0.01);
    if (status == STATUS_OK) status = entity_table_create(&scene.table, &config, scene.catalog);
    if (status == STATUS_OK) status = world_open(&scene.world, scene.catalog, landscape, &landscape->frame, "avx2");
    if (status == STATUS_OK) status = atmosphere_open(&scene.world.atmosphere, "us1976");
    const HeatConfig usual = heat_default_config();
    if (status == STATUS_OK) status = trial_scene_warm(&scene, &usual);
    for (int k = 0; k < vehicles && status == STATUS_OK; k++) {
        const TrialPlace place = vehicle_place(types[k % type_count], k, vehicles);
        status = trial_scene_place(&scene, &place);
    }
    if (status == STATUS_OK) *out = scene;
    else trial_scene_close(&scene);
    return status;
}

void trial_scene_close(TrialScene *scene)
{
    world_vehicles_destroy(scene->vehicles);
    entity_table_destroy(scene->table);
    world_close(&scene->world);
    catalog_close(scene->catalog);
    *scene = (TrialScene){0};
}

View trial_view(const TrialScene *scene, double back_m, double above_m, double hfov_rad, int width, int height)
{
    const Elevation *e = &scene->landscape->elevation;
    const double     aim[3] = {0, 0, elevation_height(e, 0, 0, NULL) + 1};
    View             view = {.p_enu = {0, -back_m, fmax(aim[2], elevation_height(e, 0, -back_m, NULL)) + above_m},
                             .width = width,
                             .height = height,
                             .focal_px = view_focal_px(width, hfov_rad)};
    double           d_enu[3];
    v3_sub(d_enu, aim, view.p_enu);
    v3_scale(d_enu, 1 / v3_length(d_enu), d_enu);
    view_upright(view.r_enu_from_cam, d_enu);
    return view;
}

RenderRequest trial_default_request(const TrialScene *scene, const View *view, double range_m)
{
    const Config   c = config_default();
    const unsigned all = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR | 1u << BAND_RADAR;
    return (RenderRequest){.view = *view,
                           .bands = all,
                           .truth = true,
                           .optical = config_optical(&c),
                           .sky_samples = c.sensor.sky_samples,
                           .sky_visibility = c.sensor.sky_visibility,
                           .refraction = c.sensor.refraction,
                           .samples = c.sensor.samples,
                           .edge_samples = c.sensor.edge_samples,
                           .target_samples = c.sensor.target_samples,
                           .budget = c.quality.budget,
                           .low_plants_m = scene->world.forest ? c.terrain.woods_low_m : 0,
                           .hidden_entity = -1,
                           .profile_bins = c.radar.bins,
                           .profile_bin_m = c.radar.bin_m,
                           .profile_near_m = fmax(0, range_m - 0.5 * c.radar.bins * c.radar.bin_m)};
}

/* ---- one frame -------------------------------------------------------------------------------- */

static Status light(TrialFrame *f)
{
    const TrialScene *scene = f->scene;
    const World      *world = &scene->world;
    Weather           weather;
    HeatScene        *heat = NULL;
    weather_at(&weather, world->course, scene->unix_s);
    Status status =
        sun_at(&f->sun, scene->unix_s, &world->frame.origin, weather.pressure_mbar, weather.air_temp_k - 273.15, NAN);
    if (status == STATUS_OK) status = world_heat_at(&heat, world, NULL, scene->unix_s, f->arena);
    if (status != STATUS_OK) return status;
    const double    ground_m = elevation_height(&scene->landscape->elevation, 0, 0, NULL);
    const AirSource source = world_air_source(world, 0);
    const AirEye    eye = {f->request.view.p_enu[2] - ground_m, render_air_bands(f->request.bands, f->request.optical),
                           &f->request.view};
    status = air_at(&f->air, &source, &weather, &f->sun, &eye, f->pool, f->arena);
    f->air.heat = heat;
    return status;
}

static Status targets(TrialFrame *f)
{
    const World     *world = &f->scene->world;
    Target          *target = arena_alloc(f->arena, (size_t)f->snapshot.count + 1, sizeof *target);
    EyeState         eye = {.host_index = -1};
    const TruthNoise noise = {.optical_w_m2_sr = 0.1, .netd_mwir_k = 0.03, .netd_lwir_k = 0.03};
    if (!target) return STATUS_NO_MEMORY;
    ecef_from_enu(eye.p_ecef, &world->frame, f->request.view.p_enu);
    m3_mul(eye.r_ecef_from_cam, world->frame.r_ecef_from_enu, f->request.view.r_enu_from_cam);
    f->targets = truth_targets(target, &f->picture, world, &f->snapshot, &f->request, &eye, &noise);
    return STATUS_OK;
}

Status trial_warm(TrialScene *scene, Snapshot *snapshot, Arena *arena)
{
    const WorldVehiclesConfig config = {.step_s = 30, .window_us = INFINITY, .past_parts = scene->past_parts};
    Status                    status = STATUS_OK;
    if (!scene->world.heat) return STATUS_OK;
    if (!scene->vehicles) status = world_vehicles_create(&scene->vehicles, &scene->world, &config);
    if (status == STATUS_OK) status = world_vehicles_tick(scene->vehicles, snapshot);
    return status == STATUS_OK ? world_vehicles_show(scene->vehicles, snapshot, arena) : status;
}

void trial_frame(void *user)
{
    TrialFrame  *f = user;
    const double t0 = wall_clock_s();
    arena_reset(f->arena);
    f->status = entity_table_snapshot(&f->snapshot, f->scene->table, f->scene->sun_now_s + 0.5, f->arena);
    if (f->status == STATUS_OK)
        f->status = trial_warm((TrialScene *)f->scene, &f->snapshot, f->arena); /* what it keeps alone changes */
    const double t1 = wall_clock_s();
    if (f->status == STATUS_OK) f->status = light(f);
    const double t2 = wall_clock_s();
    if (f->status == STATUS_OK)
        f->status = render(&f->picture, &f->scene->world, &f->snapshot, &f->request, &f->air, f->pool, f->arena);
    const double t3 = wall_clock_s();
    if (f->status == STATUS_OK && f->request.truth) f->status = targets(f);
    const double t4 = wall_clock_s();

    const RenderTimes *r = &f->picture.times;
    const double       share_s = 1e-3 / pool_threads(f->pool);
    f->stage_s[STAGE_FRAME] = t4 - t0;
    f->stage_s[STAGE_SNAPSHOT] = t1 - t0;
    f->stage_s[STAGE_AIR] = t2 - t1;
    f->stage_s[STAGE_PREPARE] = 1e-3 * r->prepare_ms;
    f->stage_s[STAGE_VISIBILITY] = share_s * r->visibility_ms;
    f->stage_s[STAGE_SUN] = share_s * r->shadow_ms;
    f->stage_s[STAGE_SHADE] = share_s * r->shade_ms;
    f->stage_s[STAGE_RADAR] = share_s * r->radar_ms;
    f->stage_s[STAGE_TRUTH] = t4 - t3;
    f->stage_s[STAGE_REST] = t3 - t2;
    for (int s = STAGE_PREPARE; s <= STAGE_RADAR; s++) f->stage_s[STAGE_REST] -= f->stage_s[s];
    f->stage_s[STAGE_FOOTPRINTS] = 1e-3 * r->target_grids_ms;
    f->stage_s[STAGE_BASE] = 1e-3 * r->base_ms;
    f->stage_s[STAGE_EDGES] = 1e-3 * r->edges_ms;
}

Status trial_frame_hash(char out[sha256_text_size], const TrialFrame *f)
{
    FrameView view = {.plane_count = 0};
    view.plane_count = frame_planes(view.plane, &f->picture, &f->request);
    const Status status = frame_sha256(&view);
    memcpy(out, view.sha256, sha256_text_size);
    return status;
}
