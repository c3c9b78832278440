/* sensor/commands/heat_images.c: a vehicle round the clock, from the south-east, in MWIR and LWIR. */
#include "sensor/commands/heat_day.h"

#include "render/materials/planck.h"
#include "render/scene/upright.h"
#include "sensor/publish/letters.h"
#include "sensor/detector/level.h"
#include "sensor/detector/quantise.h"
#include "sensor/publish/image_file.h"

#include <stdlib.h>

enum { columns = 4, rows = heat_day_images / columns, tile_width = 360, tile_height = 270,
      tile = tile_width * tile_height, foot = letters_high + 14,
      width = columns * tile_width, height = rows * tile_height + foot };
static const double view_down_deg = 12, least_away_m = 60;

Status heat_images_open(HeatImages *images)
{
    for (int b = 0; b < 2; b++)
        if (!(images->radiance[b] = calloc((size_t)heat_day_images * tile,
                                          sizeof *images->radiance[b])))
            return STATUS_NO_MEMORY;
    return STATUS_OK;
}

void heat_images_close(HeatImages *images)
{
    for (int b = 0; b < 2; b++) free(images->radiance[b]);
    *images = (HeatImages){0};
}

/* From 60 m, or three lengths; the whole model fits for any heading. */
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
    View         view = {.width = tile_width, .height = tile_height,
                         .focal_px = view_focal_px(tile_width, 2 * atan(half_m / (away_m - reach_m)))};
    model_stage_place(aim, stage);
    aim[2] += 0.45 * tall_m;
    v3_add_scaled(view.p_enu, aim, -away_m, towards);
    camera_upright(view.r_enu_from_cam, towards);
    return view;
}

Status heat_images_draw(HeatImages *images, ModelStage *stage, const Snapshot *snapshot, int index, double unix_s)
{
    const RenderRequest request = {.view = view_of(stage),
                                   .bands = 1u << BAND_MWIR | 1u << BAND_LWIR,
                                   .sky_visibility = true,
                                   .samples = 1,
                                   .edge_samples = 4,
                                   .target_samples = 48,
                                   .hidden_entity = -1,
                                   .t_s = snapshot->t_s};
    Picture picture;
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
        letters_write(rgb, width, height, i % columns * tile_width + 10, i / columns * tile_height + 8, text);
    }
    snprintf(text, sizeof text, "%s apparent temperature  black %.0f K  white %.0f K", band, level.low, level.high);
    letters_write(rgb, width, height, 10, rows * tile_height + 7, text);
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
