/* sensor/commands/model_show.c: `pitviper model show`: a model from eight sides, optical, with a scale, in one
 * image. */
#include "sensor/commands/model.h"

#include "render/frame/render.h"
#include "render/scene/upright.h"
#include "sensor/publish/letters.h"
#include "sensor/commands/model_stage.h"
#include "sensor/detector/colour.h"
#include "sensor/detector/level.h"
#include "sensor/detector/quantise.h"
#include "sensor/publish/image_file.h"

#include <stdlib.h>

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

/* ---- the view -------------------------------------------------------------------------------- */

/* View from the south, slightly above, with the whole model in the image; px_per_m: scale at the model. */
static View view_of(double *px_per_m, const ModelStage *stage)
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

/* Renders one side into its tile of the three planes. */
static Status draw_side(float *const plane[3], double white[3], double *px_per_m, ModelStage *stage, int side)
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
    Status status = model_stage_put(&snapshot, &entity, stage, -0.5 * pi_rad - side * 0.25 * pi_rad);
    /* sun, atmosphere and view are the same for all sides: only the model turns */
    if (status == STATUS_OK && side == 0) status = model_stage_light(stage, &request, stage->begin_s);
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

/* A morning in June. */
static Status open_stage(ModelStage *stage, const char *name, double sag_m)
{
    const Geodetic   origin = {.lat_rad = 48 * rad_per_deg, .lon_rad = 11 * rad_per_deg};
    ModelStageConfig config = {.name = name, .sag_m = sag_m, .origin = origin, .surface = SURFACE_NONE};
    if (!text_to_unix_s(&config.begin_s, "2026-06-21T09:00:00Z")) return STATUS_BAD_VALUE;
    return model_stage_open(stage, &config);
}

Status model_show(const char *name, double sag_m, const char *out)
{
    const size_t count = (size_t)width * height;
    ModelStage   stage = {0};
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
    model_stage_close(&stage);
    free(values);
    free(rgb);
    return status;
}
