/* sensor/commands/model_show.c: `pitviper model show`: a model from eight sides, optical, with a scale, in one
 * image. */
#include "sensor/commands/model.h"

#include "entities/import/model_import.h"
#include "render/frame/render.h"
#include "render/scene/upright.h"
#include "sensor/commands/letters.h"
#include "sensor/detector/colour.h"
#include "sensor/detector/level.h"
#include "sensor/detector/quantise.h"
#include "sensor/publish/image_file.h"

#include <stdlib.h>
#include <unistd.h>

enum { columns = 4, rows = 2, tile_width = 360, tile_height = 270, width = columns * tile_width,
       height = rows * tile_height };
static const double view_hfov_deg = 20, view_down_deg = 14;

/* ---- letters --------------------------------------------------------------------------------- */

static void dot(uint8_t *rgb, int x, int y, uint8_t value)
{
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    memset(rgb + 3 * ((size_t)y * width + (size_t)x), value, 3);
}

static void write_text(uint8_t *rgb, int x, int y, const char *text)
{
    letters_write(rgb, width, height, x, y, text);
}

/* The largest of 1, 2 or 5 times a power of ten that is not above this. */
static double round_length(double most)
{
    const double power = pow(10, floor(log10(most)));
    return power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
}

/* A scale bar of a round length, at the distance of the model. */
static void draw_scale(uint8_t *rgb, double px_per_m)
{
    const double length_m = round_length(0.3 * tile_width / px_per_m);
    const int    px = (int)(length_m * px_per_m + 0.5), y = height - 14;
    char         text[32];
    for (int x = -1; x <= px + 1; x++)
        for (int v = -1; v <= 4; v++) dot(rgb, 12 + x, y + v, x < 0 || x > px || v < 0 || v > 3 ? 0 : 255);
    snprintf(text, sizeof text, "%g m", length_m);
    write_text(rgb, 12, y - 20, text);
}

/* ---- the scene ------------------------------------------------------------------------------- */

typedef struct Stage {
    Landscape landscape;
    Catalog  *catalog;
    World     world;
    Pool     *pool;
    Arena    *arena, *air_arena; /* of one side; of all sides */
    Air       air;
    int       model;
    double    unix_s, place_m[2]; /* east and north of the origin */
} Stage;

/* A catalog with this model for all entity types. */
static Status open_catalog(Stage *stage, const char *name, double sag_m)
{
    char   path[temp_path_size];
    char  *real = model_is_path(name) ? realpath(name, NULL) : NULL;
    Status status = STATUS_IO;
    if (!temp_file(path, ".csv")) {
        free(real);
        return STATUS_IO;
    }
    FILE *file = fopen(path, "w");
    if (file) {
        fputs("type,model,origin\n*,\"", file);
        for (const char *c = real ? real : name; *c; c++) fputs(*c == '"' ? "\"\"" : (const char[]){*c, 0}, file);
        fputs("\",base\n", file);
        if (fclose(file) == 0) status = catalog_open(&stage->catalog, path, sag_m);
    } else {
        log_error("model: cannot write %s", path);
    }
    unlink(path);
    free(real);
    if (status == STATUS_OK) stage->model = catalog_find(stage->catalog, (DisEntityType){.kind = 1}, NULL, NULL);
    return status;
}

/* The position nearest to the origin around which the surface class is uniform; the origin if there is none. */
static void find_place(Stage *stage, double about_m)
{
    for (int k = 0; k < 4000; k++) {
        const double turn = 2.4 * k, away = 2 * sqrt(k) * 5, x = away * cos(turn), y = away * sin(turn);
        const SurfaceClass here = landscape_surface(&stage->landscape, x, y);
        bool               same = here != SURFACE_NONE;
        for (int i = 0; i < 48 && same; i++) {
            const double r = about_m * (1 + i / 16) / 3, a = i * pi_rad / 8;
            same = landscape_surface(&stage->landscape, x + r * cos(a), y + r * sin(a)) == here;
        }
        if (!same) continue;
        stage->place_m[0] = x, stage->place_m[1] = y;
        return;
    }
}

/* Ground as warm as on a clear day. */
static Status warm(Stage *stage)
{
    HeatConfig heat = heat_default_config();
    heat.unix_s = stage->unix_s;
    return world_warm_clear(&stage->world, &heat, 0, stage->pool);
}

static Status open_stage(Stage *stage, const char *name, double sag_m)
{
    const Geodetic  origin = {.lat_rad = 48 * rad_per_deg, .lon_rad = 11 * rad_per_deg};
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    config.relief_m = 0;
    config.half_width_m = 800, config.horizon_m = 4000;
    Status status = open_catalog(stage, name, sag_m);
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = landscape_create(&stage->landscape, &config, &frame, NULL, 0, NULL, 0);
    if (status == STATUS_OK) status = world_open(&stage->world, stage->catalog, &stage->landscape, &frame, "avx2");
    if (status == STATUS_OK) status = atmosphere_open(&stage->world.atmosphere, "us1976");
    if (status == STATUS_OK) status = pool_create(&stage->pool, thread_processors());
    if (status == STATUS_OK && (!(stage->arena = arena_create()) || !(stage->air_arena = arena_create())))
        status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) find_place(stage, fmin(6 * catalog_model(stage->catalog, stage->model)->radius_m, 120));
    if (status == STATUS_OK && !text_to_unix_s(&stage->unix_s, "2026-06-21T09:00:00Z")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = warm(stage);
    return status;
}

static void close_stage(Stage *stage)
{
    arena_destroy(stage->arena);
    arena_destroy(stage->air_arena);
    pool_destroy(stage->pool);
    world_close(&stage->world);
    landscape_destroy(&stage->landscape);
    catalog_close(stage->catalog);
}

/* The model on the ground, its nose turned by turn_rad from east towards north. */
static Status put_model(Snapshot *out, SnapshotEntity *entity, const Stage *stage, double turn_rad)
{
    const Model      *model = catalog_model(stage->catalog, stage->model);
    const LocalFrame *frame = &stage->world.frame;
    const double      c = cos(turn_rad), s = sin(turn_rad), r_enu_from_body[9] = {c, s, 0, s, -c, 0, 0, 0, -1};
    const double     *at = stage->place_m;
    const double      p_enu[3] = {at[0], at[1], elevation_height(&stage->landscape.elevation, at[0], at[1], NULL)};
    *entity = (SnapshotEntity){.id = {1, 1, 1}, .type = {.kind = 1, .domain = 1}, .model = stage->model};
    ecef_from_enu(entity->p_ecef, frame, p_enu);
    m3_mul(entity->r_ecef_from_body, frame->r_ecef_from_enu, r_enu_from_body);
    NodePose *pose = arena_alloc(stage->arena, (size_t)model->node_count, sizeof *pose);
    if (!pose) return STATUS_NO_MEMORY;
    model_pose(pose, model, NULL);
    *out = (Snapshot){.count = 1, .node_count = model->node_count, .entity = entity, .node = pose};
    return STATUS_OK;
}

/* View from the south, slightly above, with the whole model in the image; px_per_m: scale at the model. */
static View view_of(double *px_per_m, const Stage *stage)
{
    const Model *model = catalog_model(stage->catalog, stage->model);
    double       reach_m = 0;
    for (int k = 0; k < 4; k++) /* largest horizontal distance of a corner from the centre, for any rotation */
        reach_m = fmax(reach_m, hypot(k & 1 ? model->box_high[0] : model->box_low[0],
                                      k & 2 ? model->box_high[1] : model->box_low[1]));
    const double tall_m = fmax(-model->box_low[2], 0.01), low_m = fmax(model->box_high[2], 0);
    const double half_m = fmax(1.1 * reach_m, 0.75 * (tall_m + low_m) * tile_width / tile_height);
    const double away_m = half_m / tan(0.5 * view_hfov_deg * rad_per_deg) + 0.3 * reach_m;
    const double down_rad = view_down_deg * rad_per_deg;
    View         view = {.width = tile_width, .height = tile_height,
                         .focal_px = view_focal_px(tile_width, view_hfov_deg * rad_per_deg)};
    const double *at = stage->place_m, ground_m = elevation_height(&stage->landscape.elevation, at[0], at[1], NULL);
    const double towards[3] = {0, cos(down_rad), -sin(down_rad)};
    const double aim[3] = {at[0], at[1], ground_m + 0.5 * (tall_m - low_m)};
    v3_add_scaled(view.p_enu, aim, -away_m, towards);
    camera_upright(view.r_enu_from_cam, towards);
    *px_per_m = view.focal_px / away_m;
    return view;
}

/* ---- the image ----------------------------------------------------------------------------- */

/* Sun, atmosphere and view are the same for all sides: only the model turns. */
static Status light(Stage *stage, const RenderRequest *request)
{
    const World *world = &stage->world;
    Weather      weather;
    HeatScene   *heat = NULL;
    Sun          sun;
    weather_at(&weather, world->course, stage->unix_s);
    Status status = sun_at(&sun, stage->unix_s, &world->frame.origin, weather.pressure_mbar,
                                 weather.air_temp_k - 273.15, NAN);
    if (status == STATUS_OK) status = world_heat_at(&heat, world, NULL, stage->unix_s, stage->air_arena);
    if (status != STATUS_OK) return status;
    const AirSource source = {world->atmosphere, world->planck_mwir, world->planck_lwir, 0};
    const AirEye    eye = {request->view.p_enu[2], render_air_bands(request->bands, request->optical), &request->view};
    status = air_at(&stage->air, &source, &weather, &sun, &eye, stage->pool, stage->air_arena);
    stage->air.heat = heat;
    return status;
}

/* Renders one side into its tile of the three planes. */
static Status draw_side(float *const plane[3], double white[3], double *px_per_m, Stage *stage, int side)
{
    Snapshot       snapshot;
    SnapshotEntity entity;
    Picture        picture;
    arena_reset(stage->arena);
    const RenderRequest request = {.view = view_of(px_per_m, stage),
                                   .bands = 1u << BAND_OPTICAL,
                                   .optical = OPTICAL_RGB,
                                   .sky_visibility = true,
                                   .samples = 1,
                                   .edge_samples = 4,
                                   .target_samples = 48,
                                   .hidden_entity = -1};
    /* first nose on, then clockwise from above: right side, tail ... */
    Status status = put_model(&snapshot, &entity, stage, -0.5 * pi_rad - side * 0.25 * pi_rad);
    if (status == STATUS_OK && side == 0) status = light(stage, &request);
    if (status == STATUS_OK)
        status = render(&picture, &stage->world, &snapshot, &request, &stage->air, stage->pool, stage->arena);
    if (status != STATUS_OK) return status;
    memcpy(white, picture.white_w_m2_sr, 3 * sizeof *white);
    const size_t left = (size_t)(side % columns) * tile_width, top = (size_t)(side / columns) * tile_height;
    for (int c = 0; c < 3; c++)
        for (size_t y = 0; y < tile_height; y++)
            memcpy(plane[c] + (top + y) * width + left, picture.optical[c] + y * tile_width,
                   tile_width * sizeof(float));
    return STATUS_OK;
}

static void write_labels(uint8_t *rgb, const Model *model, double px_per_m)
{
    char text[80];
    for (int side = 0; side < columns * rows; side++) {
        snprintf(text, sizeof text, "%d deg", 45 * side);
        write_text(rgb, side % columns * tile_width + 12, side / columns * tile_height + 10, text);
    }
    for (int y = 0; y < height; y++)
        for (int k = 1; k < columns; k++) dot(rgb, k * tile_width, y, 0);
    for (int x = 0; x < width; x++) dot(rgb, x, tile_height, 0);
    draw_scale(rgb, px_per_m);
    snprintf(text, sizeof text, "%.2f x %.2f x %.2f m", model->length_m, model->width_m,
             fmax(model->box_high[2], 0) - model->box_low[2]);
    write_text(rgb, width - 12 * (int)strlen(text) - 8, height - 24, text);
}

Status model_show(const char *name, double sag_m, const char *out)
{
    const size_t count = (size_t)width * height;
    Stage        stage = {0};
    double       white[3] = {0}, px_per_m = 1;
    float       *values = calloc(3 * count, sizeof *values);
    uint8_t     *rgb = malloc(3 * count);
    Status       status = values && rgb ? open_stage(&stage, name, sag_m) : STATUS_NO_MEMORY;
    float *const plane[3] = {values, values + count, values + 2 * count};
    for (int side = 0; side < columns * rows && status == STATUS_OK; side++)
        status = draw_side(plane, white, &px_per_m, &stage, side);
    if (status == STATUS_OK) {
        const Model   *model = catalog_model(stage.catalog, stage.model);
        DetectorConfig display = detector_default_config();
        DisplayColour  colour;
        display.display_gamma = true;
        display_colour(&colour, white, 0, INFINITY);
        /* fixed exposure: a reflectance of 0.5 is white, for every model */
        display.auto_level = false;
        display.level_low  = 0;
        display.level_high = 0.5 * colour.white;
        display_colour_apply(plane, (const float *const *)plane, count, &colour);
        const float *const shown[3] = {plane[0], plane[1], plane[2]};
        detector_display_rgb(rgb, shown, count, &display, detector_level(&display, shown, 3, count));
        write_labels(rgb, model, px_per_m);
        status = image_write_png(out, rgb, width, height, 3, 8);
        if (status == STATUS_OK)
            printf("%s: %s, %.3f x %.3f x %.3f m (length, width, height), from eight sides, nose on first\n",
                   out, model->name, model->length_m, model->width_m,
                   fmax(model->box_high[2], 0) - model->box_low[2]);
    }
    if (status == STATUS_NO_MEMORY) log_error("model: out of memory: %s", name);
    close_stage(&stage);
    free(values);
    free(rgb);
    return status;
}
