/* render/probe_heat.c: `pitviper probe heat-ground`: the ground's heat for rows of CSV, as frames have it, without a
 * scene.
 * Rows in the order of time are answered without starting
 * again. */

#include "render/probe_day_private.h"
#include "terrain/probe.h"

#include <stdlib.h>

typedef struct HeatProbe {
    ProbeDay day;
    Pool    *pool;
    Heat    *heat; /* of the day of day.drive.exercise_s; NULL: none yet */
} HeatProbe;

void heat_probe_close(void *state)
{
    HeatProbe *p = state;
    heat_destroy(p->heat);
    pool_destroy(p->pool);
    probe_day_close(&p->day);
    free(p);
}

Status heat_probe_open(void **state, int argc, char **argv)
{
    HeatProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    Status status = probe_day_open(&p->day, argc, argv);
    if (status == STATUS_OK)
        status = pool_create(&p->pool, thread_processors() < ground_kinds ? thread_processors() : ground_kinds);
    if (status == STATUS_OK) *state = p;
    else heat_probe_close(p);
    return status;
}

/* The heat of the day of a time. */
static Status warm(HeatProbe *p, double unix_s)
{
    HeatDrive   *drive = &p->day.drive;
    const double begin_s = probe_midnight_s(unix_s, drive->place.lon_rad);
    if (p->heat && drive->exercise_s == begin_s) return STATUS_OK;
    heat_destroy(p->heat);
    p->heat = NULL;
    drive->exercise_s = begin_s;
    HeatConfig config = heat_default_config();
    config.unix_s = begin_s, config.weather = world_heat_weather, config.user = drive, config.pool = p->pool;
    return heat_create(&p->heat, &p->day.ground, &config, NULL, 0);
}

static double or_zero(const ProbeValue *value) { return isnan(value->number) ? 0 : value->number; }

static const char *balance(ProbeValue *out, const GroundColumn *ground, const GroundWeather *w, const GroundExposure *e)
{
    SurfaceFlux  flux;
    const double surface_k = ground->state.temp_k[0];
    ground_flux(&flux, ground, w, e);
    out[1].number = w->air.temp_k;
    out[2].number = flux.absorbed_w_m2;
    out[3].number = w->direct_w_m2;
    out[4].number = w->diffuse_w_m2;
    out[5].number = w->longwave_w_m2;
    out[6].number = surface_film_w_m2k(&flux, surface_k);
    out[7].number = surface_latent_w_m2(&flux, surface_k);
    return NULL;
}

const char *heat_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    HeatProbe   *p = state;
    const double unix_s = in[0].number, slope_deg = or_zero(&in[2]), aspect_rad = or_zero(&in[3]) * rad_per_deg;
    const double shade = or_zero(&in[4]), depth_m = or_zero(&in[5]);
    const int    kind = ground_kind_find(in[1].text);
    if (probe_time_fault(unix_s)) return probe_time_fault(unix_s);
    if (kind < 0) return "surface is no row of etc/ground_heat.csv";
    if (!(slope_deg >= 0 && slope_deg <= 90)) return "slope_deg must be in 0 .. 90";
    if (!(fabs(aspect_rad) <= 4 * pi_rad)) return "aspect_deg must be within 720";
    if (!(shade >= 0 && shade <= 1)) return "shade must be in 0 .. 1";
    if (depth_m != 0 && (slope_deg != 0 || shade != 0))
        return "depth_m is of level ground in the open: slope_deg and shade must be 0";

    HeatNow      *now;
    GroundColumn  ground;
    GroundWeather w;
    arena_reset(p->day.arena);
    if (warm(p, unix_s) != STATUS_OK || heat_now(&now, p->heat, unix_s, p->day.arena) != STATUS_OK)
        return "out of memory";
    heat_level(&ground, p->heat, kind, now->share);
    const double bottom_m = ground.column->depth_m[ground.column->nodes - 1];
    if (!(depth_m >= 0 && depth_m <= bottom_m)) {
        snprintf(out[0].buffer, sizeof out[0].buffer, "depth_m must be in 0 .. %.4g", bottom_m);
        return out[0].buffer;
    }
    const double   slope_rad = slope_deg * rad_per_deg;
    GroundExposure e = {{sin(slope_rad) * sin(aspect_rad), sin(slope_rad) * cos(aspect_rad), cos(slope_rad)},
                        1 - shade,
                        1,
                        ground.state.temp_k[0]};
    const double   surface_k = heat_ground_k(now, kind, e.n_enu, shade, 1, 1);
    out[0].number = depth_m > 0 ? column_temp_k(&ground.state, ground.column, depth_m) : surface_k;
    ground.state.temp_k[0] = surface_k; /* its water is that of level ground */
    world_heat_weather(&w, unix_s, &p->day.drive);
    return balance(out, &ground, &w, &e);
}

/* ---- heat-node --------------------------------------------------------------------------------- */

/* Temperatures of a part of an entity that begins at a time.
 *
 * Each row is an entity of its own, on level grass in the open, as render/heat/vehicle_heat.h begins one at that
 * time: it has stood there for a day with its engine stopped, and for the last hour done what the row says. Each
 * local day (by the sun's mean time at the place) is an exercise of its own, so that a row's answer depends on no
 * other row. Rows of one model and day after one another are answered without starting again. */

typedef struct NodeProbe {
    Geodetic       place;
    WeatherCourse *course; /* NULL while the world has it */
    char           name[probe_text_size];
    Catalog       *catalog; /* of the model of that name; NULL: none */
    int            model;
    bool           opened;
    World          world;   /* where opened */
    double         begin_s; /* the day that it is warm for; NaN: none */
    Arena         *arena;
    Pool          *pool;
} NodeProbe;

/* The course outlives the worlds. */
static void keep_course(NodeProbe *p)
{
    if (!p->world.course) return;
    p->course = p->world.course;
    p->world.course = NULL;
}

static void close_world(NodeProbe *p)
{
    keep_course(p);
    if (p->opened) world_close(&p->world);
    catalog_close(p->catalog);
    p->world = (World){0};
    p->catalog = NULL, p->opened = false, p->begin_s = NAN;
    *p->name = 0;
}

void heat_node_probe_close(void *state)
{
    NodeProbe *p = state;
    close_world(p);
    weather_course_close(p->course);
    pool_destroy(p->pool);
    arena_destroy(p->arena);
    free(p);
}

Status heat_node_probe_open(void **state, int argc, char **argv)
{
    NodeProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    p->begin_s = NAN;
    Status status = probe_weather(&p->course, &p->place, argc, argv);
    if (status == STATUS_OK) status = pool_create(&p->pool, thread_processors());
    if (status == STATUS_OK && !(p->arena = arena_create())) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) *state = p;
    else heat_node_probe_close(p);
    return status;
}

static Status open_world(NodeProbe *p, const char *name)
{
    static const double sag_m = 0.005;
    LocalFrame          frame;
    if (p->catalog && strcmp(p->name, name) == 0) return STATUS_OK;
    close_world(p);
    Status status = catalog_open_one(&p->catalog, &p->model, name, sag_m);
    if (status == STATUS_OK) status = local_frame_at(&frame, &p->place);
    if (status == STATUS_OK) {
        status = world_open(&p->world, p->catalog, NULL, &frame, "avx2");
        p->opened = true; /* world_close accepts one that failed */
    }
    if (status == STATUS_OK) status = atmosphere_open(&p->world.atmosphere, "us1976");
    if (status == STATUS_OK) snprintf(p->name, sizeof p->name, "%s", name);
    else close_world(p);
    return status;
}

/* The heat of the day of a time. */
static Status warm_entity(NodeProbe *p, double unix_s)
{
    const double begin_s = probe_midnight_s(unix_s, p->place.lon_rad);
    HeatConfig   config = heat_default_config();
    if (p->begin_s == begin_s) return STATUS_OK;
    keep_course(p);
    p->begin_s = NAN;
    config.unix_s = begin_s;
    WeatherCourse *course = p->course;
    p->course = NULL;
    const Status status = world_warm(&p->world, course, &config, 0, p->pool);
    if (status == STATUS_OK) p->begin_s = begin_s;
    return status;
}

/* Mean by area, and range, over the patches of parts of that name; empty: of all parts. False: it has no such part. */
static bool part_k(ProbeValue *out, const NodeProbe *p, const Snapshot *snapshot, const char *part)
{
    const Model   *model = catalog_model(p->catalog, p->model);
    const Patches *patches = &p->world.patches->of[p->model];
    double         sum_k = 0, area_m2 = 0, low_k = INFINITY, high_k = -INFINITY;
    for (int b = 0; b < patches->bodies; b++) {
        bool wanted = !*part;
        for (int k = 0; k < patches->parts && !wanted; k++)
            wanted = patches->body_of_part[k] == b && strcmp(model->part[k].name, part) == 0;
        for (int i = patches->first_of_body[b]; i < patches->first_of_body[b + 1] && wanted; i++) {
            const double k = (double)snapshot->patch_k[snapshot->entity[0].first_patch + i];
            sum_k += patch_open_m2(&patches->patch[i]) * k;
            area_m2 += patch_open_m2(&patches->patch[i]);
            low_k = fmin(low_k, k), high_k = fmax(high_k, k);
        }
    }
    if (!(area_m2 > 0)) return false;
    out[0].number = sum_k / area_m2, out[1].number = low_k, out[2].number = high_k;
    return true;
}

/* The entity of a row at the origin, with its temperatures. */
static Status begin(Snapshot *snapshot, SnapshotEntity *entity, NodeProbe *p, double unix_s, const double drive[3])
{
    static const double origin_enu[3] = {0, 0, 0};
    const Model        *model = catalog_model(p->catalog, p->model);
    const double        s = sin(drive[0]), c = cos(drive[0]), r_enu_from_body[9] = {s, c, 0, c, -s, 0, 0, 0, -1};
    NodePose           *pose = arena_alloc(p->arena, (size_t)model->node_count, sizeof *pose);
    if (!pose) return STATUS_NO_MEMORY;
    model_pose(pose, model, NULL);
    const double t_s = unix_s - p->begin_s;
    *entity = (SnapshotEntity){.id = {1, 1, 1}, .type = {.kind = 1, .domain = 1}, .model = p->model, .first_patch = -1};
    entity->drives =
        (EntityDrives){.since_s = t_s, .engine = (float)drive[1], .speed_mps = (float)drive[2], .alive = 1};
    ecef_from_enu(entity->p_ecef, &p->world.frame, origin_enu);
    m3_mul(entity->r_ecef_from_body, p->world.frame.r_ecef_from_enu, r_enu_from_body);
    for (int k = 0; k < 3; k++) entity->v_ecef_mps[k] = drive[2] * entity->r_ecef_from_body[3 * k];
    *snapshot = (Snapshot){.t_s = t_s, .count = 1, .node_count = model->node_count, .entity = entity, .node = pose};
    return world_warm_snapshot(snapshot, &p->world, p->arena);
}

const char *heat_node_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    static const double up[3] = {0, 0, 1}, origin_enu[3] = {0, 0, 0};
    NodeProbe          *p = state;
    const double        unix_s = in[0].number, heading_deg = isnan(in[3].number) ? 270 : in[3].number;
    const double        drive[3] = {heading_deg * rad_per_deg, isnan(in[4].number) ? 0 : in[4].number,
                             isnan(in[5].number) ? 0 : in[5].number};
    Snapshot            snapshot;
    SnapshotEntity      entity;
    HeatScene          *scene;
    double              lifted_k;
    if (probe_time_fault(unix_s)) return probe_time_fault(unix_s);
    if (!(fabs(heading_deg) <= 720)) return "heading_deg must be within 720";
    if (!(drive[1] >= 0 && drive[1] <= 1)) return "engine must be in 0 .. 1";
    if (!(drive[2] >= 0 && drive[2] <= 100)) return "speed_mps must be in 0 .. 100";
    arena_reset(p->arena);
    const Status opened = open_world(p, in[1].text);
    if (opened == STATUS_NO_MEMORY) return "out of memory";
    if (opened != STATUS_OK) return "no such model, or its file is invalid (see the log)";
    if (warm_entity(p, unix_s) != STATUS_OK || begin(&snapshot, &entity, p, unix_s, drive) != STATUS_OK ||
        world_heat_at(&scene, &p->world, NULL, unix_s, p->arena) != STATUS_OK)
        return "out of memory";
    if (entity.first_patch < 0) return "this model has no temperatures";
    if (!part_k(out, p, &snapshot, in[2].text))
        return "the model has no part of this name; `pitviper model info` lists them";
    out[3].number = world_air_k(&p->world, unix_s);
    out[4].number = heat_scene_ground_k(&lifted_k, scene, SURFACE_GRASS, origin_enu, up, 1);
    return NULL;
}
