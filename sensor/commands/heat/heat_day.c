/* sensor/commands/heat/heat_day.c: a vehicle's day, step by step; its table, and its images from the south-east in
 * MWIR and LWIR. */
#include "sensor/commands/heat/heat_day_private.h"

#include "render/frame/world.h"
#include "render/materials/planck.h"
#include "render/scene/view.h"
#include "sensor/detector/level.h"
#include "sensor/detector/display_values.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/publish/images/picture_text.h"

#include <stdlib.h>

/* ---- images ----------------------------------------------------------------------------------------- */

enum {
    columns = 4,
    rows = heat_day_images / columns,
    tile_width = 360,
    tile_height = 270,
    tile = tile_width * tile_height,
    foot = picture_text_high + 14,
    width = columns * tile_width,
    height = rows * tile_height + foot
};
static const double view_down_deg = 12, least_away_m = 60;

Status heat_images_open(HeatImages *images)
{
    for (int b = 0; b < 2; b++)
        if (!(images->radiance[b] = calloc((size_t)heat_day_images * tile, sizeof *images->radiance[b])))
            return STATUS_NO_MEMORY;
    return STATUS_OK;
}

void heat_images_close(HeatImages *images)
{
    for (int b = 0; b < 2; b++) free(images->radiance[b]);
    *images = (HeatImages){0};
}

/* Places the view at 60 m, or at three lengths of the model, so that the whole model fits at any heading. */
static View view_of(const ModelStage *stage)
{
    const Model *model = catalog_model(stage->catalog, stage->model);
    double       reach_m = 0.5, aim[3], down_rad = view_down_deg * rad_per_deg;
    for (int k = 0; k < 4; k++)
        reach_m = fmax(reach_m, hypot(k & 1 ? model->box_high[0] : model->box_low[0],
                                      k & 2 ? model->box_high[1] : model->box_low[1]));
    const double tall_m = fmax(-model->box_low[2], 0.01);
    const double half_m = 1.05 * fmax(reach_m, 0.75 * tall_m * tile_width / tile_height);
    const double away_m = fmax(least_away_m, 3 * 2 * half_m);
    const double towards[3] = {-cos(down_rad) * sqrt(0.5), cos(down_rad) * sqrt(0.5), -sin(down_rad)};
    View         view = {.width = tile_width,
                         .height = tile_height,
                         .focal_px = view_focal_px(tile_width, 2 * atan(half_m / (away_m - reach_m)))};
    model_stage_place(aim, stage);
    aim[2] += 0.45 * tall_m;
    v3_add_scaled(view.p_enu, aim, -away_m, towards);
    view_upright(view.r_enu_from_cam, towards);
    return view;
}

/* Draws the snapshot, with its temperatures, at that Unix time. Resets the stage's air_arena. */
static Status draw_images(HeatImages *images, ModelStage *stage, const Snapshot *snapshot, int index, double unix_s)
{
    const RenderRequest request = {.view = view_of(stage),
                                   .bands = 1u << BAND_MWIR | 1u << BAND_LWIR,
                                   .sky_visibility = true,
                                   .samples = 1,
                                   .edge_samples = 4,
                                   .target_samples = 48,
                                   .hidden_entity = -1,
                                   .t_s = snapshot->t_s};
    Picture             picture;
    arena_reset(stage->air_arena);
    Status status = model_stage_light(stage, &request, unix_s);
    if (status == STATUS_OK)
        status = render(&picture, &stage->world, snapshot, &request, &stage->air, stage->pool, stage->arena);
    if (status != STATUS_OK) return status;
    memcpy(images->radiance[0] + (size_t)index * tile, picture.mwir, tile * sizeof(float));
    memcpy(images->radiance[1] + (size_t)index * tile, picture.lwir, tile * sizeof(float));
    return STATUS_OK;
}

static void write_labels(uint8_t *rgb, const char *band, DetectorLevel level)
{
    char text[96];
    for (int i = 0; i < heat_day_images; i++) {
        snprintf(text, sizeof text, "%02d h", i * heat_day_image_s / 3600);
        picture_text_write(rgb, width, height, i % columns * tile_width + 10, i / columns * tile_height + 8, text);
    }
    snprintf(text, sizeof text, "%s apparent temperature  black %.0f K  white %.0f K", band, level.low, level.high);
    picture_text_write(rgb, width, height, 10, rows * tile_height + 7, text);
}

static Status write_band(const char *path, const char *band, const float *radiance, const PlanckTable *planck)
{
    const size_t   count = (size_t)heat_day_images * tile;
    DetectorConfig display = detector_default_config();
    double        *temp_k = malloc(count * sizeof *temp_k);
    float         *shown_k = malloc(count * sizeof *shown_k);
    uint8_t       *grey = malloc(count), *rgb = calloc((size_t)width * height, 3);
    Status         status = temp_k && shown_k && grey && rgb ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        planck_table_temps(temp_k, planck, radiance, (int)count);
        for (size_t i = 0; i < count; i++) shown_k[i] = (float)temp_k[i];
        const float *const plane = shown_k;
        display.percentile_low = 0.0005, display.percentile_high = 0.9995;
        const DetectorLevel level = detector_level(&display, &plane, 1, count);
        detector_display(grey, shown_k, count, &display, level);
        for (int i = 0; i < heat_day_images; i++)
            for (int y = 0; y < tile_height; y++)
                for (int x = 0; x < tile_width; x++) {
                    const int left = i % columns * tile_width, top = i / columns * tile_height;
                    memset(rgb + 3 * ((size_t)(top + y) * width + (size_t)(left + x)),
                           grey[(size_t)i * tile + (size_t)(y * tile_width + x)], 3);
                }
        for (int y = 0; y < rows * tile_height; y++)
            for (int k = 1; k < columns; k++) memset(rgb + 3 * ((size_t)y * width + (size_t)(k * tile_width)), 0, 3);
        memset(rgb + 3 * (size_t)tile_height * width, 0, 3 * (size_t)width);
        write_labels(rgb, band, level);
        status = image_write_png(path, rgb, width, height, 3, 8);
    }
    free(temp_k);
    free(shown_k);
    free(grey);
    free(rgb);
    return status;
}

Status heat_images_write(const HeatImages *images, const ModelStage *stage, const char *const path[2])
{
    const Status status = write_band(path[0], "mwir", images->radiance[0], stage->world.planck_mwir);
    return status == STATUS_OK ? write_band(path[1], "lwir", images->radiance[1], stage->world.planck_lwir) : status;
}

/* ---- names of patches ------------------------------------------------------------------------------- */

/* Names the side of the vehicle that a patch faces at rest. */
static const char *side_of(const Patch *patch, const NodePose *pose)
{
    static const char *const sides[3][2] = {{"rear", "front"}, {"left", "right"}, {"top", "bottom"}};
    double                   n_body[3];
    int                      axis = 0;
    if (patch->facing < 0.35) return "around";
    m3_mul_v3(n_body, pose[patch->node].r_body_from_node, patch->n_node);
    for (int k = 1; k < 3; k++)
        if (fabs(n_body[k]) > fabs(n_body[axis]) + 1e-6) axis = k;
    return sides[axis][n_body[axis] > 0];
}

/* Leaves only letters, digits and a few signs in a name, which stands in CSV and SVG. */
static void plain(char *text)
{
    for (char *c = text; *c; c++)
        if (!((*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9') || *c == '.' ||
              *c == '-'))
            *c = '_';
}

/* Whether another body's first part has the same name. */
static bool is_repeated(const Patches *patches, const Model *model, int body)
{
    const char *name = model->part[patches->patch[patches->first_of_body[body]].part].name;
    for (int b = 0; b < patches->bodies; b++) {
        if (b == body || patches->first_of_body[b + 1] == patches->first_of_body[b]) continue;
        if (strcmp(name, model->part[patches->patch[patches->first_of_body[b]].part].name) == 0) return true;
    }
    return false;
}

static void number_equal_names(HeatDay *day)
{
    for (int i = 0; i < day->patches; i++) {
        int same = 1;
        for (int k = i + 1; k < day->patches; k++) {
            if (strcmp(day->name[k], day->name[i]) != 0) continue;
            const size_t end = strlen(day->name[k]);
            snprintf(day->name[k] + end, heat_day_name_size - end, "_%d", ++same);
        }
    }
}

static Status name_patches(HeatDay *day, const Patches *patches, const Model *model)
{
    NodePose *pose = calloc((size_t)model->node_count + 1, sizeof *pose);
    day->patches = patches->count;
    day->name = calloc((size_t)patches->count + 1, sizeof *day->name);
    day->part = calloc((size_t)patches->count + 1, sizeof *day->part);
    day->area_m2 = calloc((size_t)patches->count + 1, sizeof *day->area_m2);
    day->patch_k = calloc((size_t)patches->count * heat_day_rows + 1, sizeof *day->patch_k);
    if (!pose || !day->name || !day->part || !day->area_m2 || !day->patch_k) {
        free(pose);
        return STATUS_NO_MEMORY;
    }
    model_pose(pose, model, NULL);
    for (int b = 0; b < patches->bodies; b++) {
        const int  first = patches->first_of_body[b], last = patches->first_of_body[b + 1];
        const bool repeated = first < last && is_repeated(patches, model, b);
        for (int i = first; i < last; i++) {
            const Patch     *patch = &patches->patch[i];
            const ModelPart *part = &model->part[patch->part];
            snprintf(day->part[i], sizeof *day->part, "%s", part->name);
            snprintf(day->name[i], sizeof *day->name, "%s%s%s_%s", repeated ? model->node[patch->node].name : "",
                     repeated ? "_" : "", part->name, side_of(patch, pose));
            plain(day->part[i]);
            plain(day->name[i]);
            day->area_m2[i] = patch_open_m2(patch);
        }
    }
    free(pose);
    number_equal_names(day);
    return STATUS_OK;
}

/* ---- the day, step by step -------------------------------------------------------------------------- */

static const double day_s = 86400, drive_mps = 10;

typedef struct Course {
    const HeatDayConfig *config;
    ModelStage          *stage;
    WorldVehicles       *vehicles;
    Snapshot             snapshot;
    SnapshotEntity       entity;
} Course;

/* Puts the vehicle on the stage at a time, without temperatures. Where it drives, its place stays, but air flows past
 * it. */
static Status put(Course *c, double t_s)
{
    const HeatDayConfig *config = c->config;
    const bool           drives = t_s >= config->drive_from_s && t_s < config->drive_to_s;
    arena_reset(c->stage->arena);
    const Status status = model_stage_put(&c->snapshot, &c->entity, c->stage, 0.5 * pi_rad - config->heading_rad);
    if (status != STATUS_OK) return status;
    c->snapshot.t_s = t_s;
    c->entity.first_patch = -1;
    c->entity.drives = (EntityDrives){.alive = 1};
    if (!drives) return STATUS_OK;
    c->entity.drives.engine = 1, c->entity.drives.speed_mps = (float)drive_mps;
    for (int k = 0; k < 3; k++) c->entity.v_ecef_mps[k] = drive_mps * c->entity.r_ecef_from_body[3 * k];
    return STATUS_OK;
}

/* Temperature of ground of the class that the vehicle stands on, level and in the open. */
static Status ground_k_then(double *ground_k, const ModelStage *stage, double unix_s)
{
    static const double up[3] = {0, 0, 1};
    HeatScene          *scene;
    double              p_enu[3], lifted_k;
    model_stage_place(p_enu, stage);
    const SurfaceClass surface = landscape_surface(&stage->landscape, p_enu[0], p_enu[1]);
    const Status       status = world_heat_at(&scene, &stage->world, NULL, unix_s, stage->arena);
    if (status != STATUS_OK) return status;
    const int known = (int)(surface == SURFACE_NONE ? SURFACE_GRASS : surface);
    *ground_k = heat_scene_ground_k(&lifted_k, scene, known, p_enu, up, 1);
    return STATUS_OK;
}

static Status note(HeatDay *day, const Course *c, int index)
{
    HeatDayRow  *row = &day->row[index];
    const double unix_s = c->stage->begin_s + c->snapshot.t_s;
    double       sum_k = 0, area_m2 = 0;
    VehicleNodes nodes;
    row->air_k = world_air_k(&c->stage->world, unix_s);
    const Status status = ground_k_then(&row->ground_k, c->stage, unix_s);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < day->patches; i++) {
        const float k = c->snapshot.patch_k[c->entity.first_patch + i];
        day->patch_k[(size_t)index * (size_t)day->patches + (size_t)i] = k;
        sum_k += day->area_m2[i] * (double)k;
        area_m2 += day->area_m2[i];
    }
    row->dt_k = sum_k / area_m2 - row->ground_k;
    row->engine_k = row->cabin_k = NAN;
    if (!vehicle_heat_nodes(&nodes, world_vehicles_heat(c->vehicles), c->entity.id)) return STATUS_OK;
    if (nodes.shape->engine >= 0) row->engine_k = nodes.temp_k[nodes.shape->engine];
    if (nodes.shape->cabin >= 0) row->cabin_k = nodes.temp_k[nodes.shape->cabin];
    return STATUS_OK;
}

static Status march(HeatDay *day, HeatImages *images, Course *c)
{
    const long long steps = llround(day_s / c->config->step_s);
    const long long steps_a_row = llround(heat_day_row_s / c->config->step_s);
    char            text[64];
    Status          status = STATUS_OK;
    for (long long i = 0; i <= steps && status == STATUS_OK; i++) {
        const double t_s = (double)i * c->config->step_s;
        status = put(c, t_s);
        if (status == STATUS_OK) status = world_vehicles_tick(c->vehicles, &c->snapshot);
        if (status != STATUS_OK || i % steps_a_row != 0) continue;
        const int row = (int)(i / steps_a_row), seconds = row * heat_day_row_s;
        snprintf(text, sizeof text, "%02d:%02d of 24 h", seconds / 3600, seconds / 60 % 60);
        log_status(text);
        status = world_vehicles_show(c->vehicles, &c->snapshot, c->stage->arena);
        if (status == STATUS_OK && c->entity.first_patch < 0) {
            log_error("heat: this model has no temperatures: nothing of it is rendered");
            status = STATUS_BAD_VALUE;
        }
        if (status == STATUS_OK && row == 0) {
            const Patches *patches = &c->stage->world.patches->of[c->entity.model];
            status = name_patches(day, patches, catalog_model(c->stage->catalog, c->entity.model));
        }
        if (status == STATUS_OK) status = note(day, c, row);
        if (status == STATUS_OK && seconds % heat_day_image_s == 0 && seconds < day_s)
            status = draw_images(images, c->stage, &c->snapshot, seconds / heat_day_image_s, c->stage->begin_s + t_s);
    }
    log_status(NULL);
    return status;
}

/* Finds when dt_k changes sign, by straight lines between rows; a row of exactly 0 belongs to the sign before it. */
static void find_crossings(HeatDay *day)
{
    for (int i = 0; i + 1 < heat_day_rows; i++) {
        const double a = day->row[i].dt_k, b = day->row[i + 1].dt_k;
        if ((a > 0) == (b > 0) || day->crossings == heat_day_most_crossings) continue;
        day->crossing_h[day->crossings++] = (i + a / (a - b)) * heat_day_row_s / 3600.0;
    }
}

Status heat_day_run(HeatDay *day, HeatImages *images, ModelStage *stage, const HeatDayConfig *config)
{
    Course c = {.config = config, .stage = stage};
    day->model = catalog_model(stage->catalog, stage->model)->name;
    Status status = world_vehicles_create(&c.vehicles, &stage->world,
                                          &(WorldVehiclesConfig){.step_s = config->step_s, .window_us = INFINITY});
    if (status == STATUS_OK) status = march(day, images, &c);
    if (status == STATUS_OK) {
        const uint64_t failed = vehicle_heat_counters(world_vehicles_heat(c.vehicles))->failed;
        if (failed > 0)
            log_warn("heat: the solver gave up %llu steps: temperatures stood still in them; try another --step",
                     (unsigned long long)failed);
        find_crossings(day);
    }
    world_vehicles_destroy(c.vehicles);
    return status;
}

void heat_day_free(HeatDay *day)
{
    free(day->name);
    free(day->part);
    free(day->area_m2);
    free(day->patch_k);
    *day = (HeatDay){0};
}

/* ---- the table -------------------------------------------------------------------------------------- */

static void write_number(FILE *to, double value)
{
    if (isfinite(value)) fprintf(to, ",%.3f", value);
    else fputc(',', to);
}

Status heat_day_write_csv(FILE *to, const HeatDay *day)
{
    fputs("hour,air_k,ground_k,dt_k,engine_k,cabin_k", to);
    for (int i = 0; i < day->patches; i++) fprintf(to, ",%s", day->name[i]);
    fputc('\n', to);
    for (int r = 0; r < heat_day_rows; r++) {
        const HeatDayRow *row = &day->row[r];
        fprintf(to, "%.4f", r * heat_day_row_s / 3600.0);
        write_number(to, row->air_k);
        write_number(to, row->ground_k);
        write_number(to, row->dt_k);
        write_number(to, row->engine_k);
        write_number(to, row->cabin_k);
        for (int i = 0; i < day->patches; i++)
            write_number(to, (double)day->patch_k[(size_t)r * (size_t)day->patches + (size_t)i]);
        fputc('\n', to);
    }
    return ferror(to) ? STATUS_IO : STATUS_OK;
}
