/* sensor/commands/model/model_stage.c: one model on level ground under a clear sky: where it stands, and its light. */
#include "sensor/commands/model/model_stage.h"

/* The position nearest to the origin around which the surface class is uniform, and the wanted one; the origin if
 * there is none. */
static void find_place(ModelStage *stage, SurfaceClass wanted, double about_m)
{
    for (int k = 0; k < 4000; k++) {
        const double       turn = 2.4 * k, away = 2 * sqrt(k) * 5, x = away * cos(turn), y = away * sin(turn);
        const SurfaceClass here = landscape_surface(&stage->landscape, x, y);
        bool               same = here != SURFACE_NONE && (wanted == SURFACE_NONE || here == wanted);
        for (int i = 0; i < 48 && same; i++) {
            const double r = about_m * (1 + i / 16) / 3, a = i * pi_rad / 8;
            same = landscape_surface(&stage->landscape, x + r * cos(a), y + r * sin(a)) == here;
        }
        if (!same) continue;
        stage->place_m[0] = x, stage->place_m[1] = y;
        return;
    }
    if (wanted != SURFACE_NONE)
        log_warn("model: no %s wide enough for it near the origin; it stands on what there is", surface_name(wanted));
}

Status model_stage_open(ModelStage *stage, const ModelStageConfig *c)
{
    LandscapeConfig config = landscape_default_config();
    HeatConfig      heat = heat_default_config();
    LocalFrame      frame;
    config.relief_m = 0;
    config.half_width_m = 800, config.horizon_m = 4000;
    stage->begin_s = heat.unix_s = c->begin_s;
    Status status = catalog_open_one(&stage->catalog, &stage->model, c->name, c->sag_m);
    if (status == STATUS_OK) status = local_frame_at(&frame, &c->origin);
    if (status == STATUS_OK) status = landscape_create(&stage->landscape, &config, &frame, NULL, 0, NULL, 0);
    if (status == STATUS_OK) status = world_open(&stage->world, stage->catalog, &stage->landscape, &frame, "avx2");
    if (status == STATUS_OK) status = atmosphere_open(&stage->world.atmosphere, "us1976");
    if (status == STATUS_OK) status = pool_create(&stage->pool, thread_processors());
    if (status == STATUS_OK && (!(stage->arena = arena_create()) || !(stage->air_arena = arena_create())))
        status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) return status;
    find_place(stage, c->surface, fmin(6 * catalog_model(stage->catalog, stage->model)->radius_m, 120));
    return world_warm_clear(&stage->world, &heat, 0, stage->pool);
}

void model_stage_close(ModelStage *stage)
{
    arena_destroy(stage->arena);
    arena_destroy(stage->air_arena);
    pool_destroy(stage->pool);
    world_close(&stage->world);
    landscape_destroy(&stage->landscape);
    catalog_close(stage->catalog);
}

void model_stage_place(double p_enu[3], const ModelStage *stage)
{
    const double *at = stage->place_m;
    p_enu[0] = at[0], p_enu[1] = at[1];
    p_enu[2] = elevation_height(&stage->landscape.elevation, at[0], at[1], NULL);
}

Status model_stage_put(Snapshot *out, SnapshotEntity *entity, const ModelStage *stage, double turn_rad)
{
    const Model      *model = catalog_model(stage->catalog, stage->model);
    const LocalFrame *frame = &stage->world.frame;
    const double      c = cos(turn_rad), s = sin(turn_rad), r_enu_from_body[9] = {c, s, 0, s, -c, 0, 0, 0, -1};
    double            p_enu[3];
    model_stage_place(p_enu, stage);
    *entity = (SnapshotEntity){.id = {1, 1, 1}, .type = {.kind = 1, .domain = 1}, .model = stage->model};
    ecef_from_enu(entity->p_ecef, frame, p_enu);
    m3_mul(entity->r_ecef_from_body, frame->r_ecef_from_enu, r_enu_from_body);
    NodePose *pose = arena_alloc(stage->arena, (size_t)model->node_count, sizeof *pose);
    if (!pose) return STATUS_NO_MEMORY;
    model_pose(pose, model, NULL);
    *out = (Snapshot){.count = 1, .node_count = model->node_count, .entity = entity, .node = pose};
    return STATUS_OK;
}

Status model_stage_light(ModelStage *stage, const RenderRequest *request, double unix_s)
{
    const World *world = &stage->world;
    Weather      weather;
    HeatScene   *heat = NULL;
    Sun          sun;
    weather_at(&weather, world->course, unix_s);
    Status status = sun_at(&sun, unix_s, &world->frame.origin, weather.pressure_mbar, weather.air_temp_k - 273.15, NAN);
    if (status == STATUS_OK) status = world_heat_at(&heat, world, NULL, unix_s, stage->air_arena);
    if (status != STATUS_OK) return status;
    const AirSource source = world_air_source(world, 0);
    const AirEye    eye = {request->view.p_enu[2], render_air_bands(request->bands, request->optical), &request->view};
    status = air_at(&stage->air, &source, &weather, &sun, &eye, stage->pool, stage->air_arena);
    stage->air.heat = heat;
    return status;
}
