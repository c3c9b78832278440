/* sensor/publish/files/display_files.c: files of a band's display and raw counts, and the preview of truth. */

#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"

#include <stdlib.h>

static Status write_raw(const FrameFiles *frame, int band)
{
    const FrameDisplay *d = &frame->display[band];
    const int           w = frame->picture->width, h = frame->picture->height;
    const size_t        count = (size_t)w * (size_t)h;
    char                path[frame_path_size];
    if (!frame_path(path, frame, "raw", band_name((Band)band), "png")) return STATUS_BAD_VALUE;
    if (d->planes == 1) return image_write_png(path, d->counts[0], w, h, 1, 16);
    uint16_t *rgb = malloc(3 * count * sizeof *rgb);
    if (!rgb) return STATUS_NO_MEMORY;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < count; i++) rgb[3 * i + (size_t)c] = d->counts[c][i];
    const Status status = image_write_png(path, rgb, w, h, 3, 16);
    free(rgb);
    return status;
}

Status frame_files_write_display(const FrameFiles *frame, int band)
{
    char           path[frame_path_size];
    const Picture *p = frame->picture;
    const size_t   count = (size_t)p->width * (size_t)p->height;
    const bool     truth = band == BAND_COUNT;
    const int      bits = truth ? 8 : frame->config->detector.bits;
    const int      planes = truth ? 3 : frame->display[band].planes;
    if (!truth && frame->raw && frame->display[band].counts[0]) {
        const Status status = write_raw(frame, band);
        if (status != STATUS_OK) return status;
    }
    if (!frame->png) return STATUS_OK;
    uint8_t *shown = malloc(count * (size_t)planes * 2);
    if (!shown) return STATUS_NO_MEMORY;
    if (truth) frame_files_preview(shown, p->range_m, p->entity, p->normal[2], count, frame->snapshot);
    else frame_display_quantise(shown, &frame->display[band], count, bits);
    const Status status = frame_path(path, frame, "frames", truth ? "truth" : band_name((Band)band), "png")
                              ? image_write_png(path, shown, p->width, p->height, planes, bits)
                              : STATUS_BAD_VALUE;
    free(shown);
    return status;
}

/* ---- the preview of truth ------------------------------------------------------------------------ */

typedef struct Rgb {
    double r, g, b; /* 0 .. 1 */
} Rgb;

/* Makes a full hue from an id. The golden ratio spreads neighbouring numbers round the circle (Knuth, TAOCP 3, 6.4). */
static Rgb id_colour(DisEntityId id)
{
    const uint32_t mixed = (id.entity + 31u * id.application + 977u * id.site) * 2654435769u;
    const double   hue = mixed / 4294967296.0 * 6;
    const double   x = 1 - fabs(fmod(hue, 2) - 1);
    switch ((int)hue) {
    case 0:
        return (Rgb){1, x, 0};
    case 1:
        return (Rgb){x, 1, 0};
    case 2:
        return (Rgb){0, 1, x};
    case 3:
        return (Rgb){0, x, 1};
    case 4:
        return (Rgb){x, 0, 1};
    default:
        return (Rgb){1, 0, x};
    }
}

static uint8_t code(double x) { return (uint8_t)((x > 1 ? 1 : x > 0 ? x : 0) * 255 + 0.5); }

static void put(uint8_t *rgb, Rgb c)
{
    rgb[0] = code(c.r);
    rgb[1] = code(c.g);
    rgb[2] = code(c.b);
}

void frame_files_preview(uint8_t *rgb, const float *range_m, const uint32_t *entity, const float *normal_up,
                         size_t count, const Snapshot *snapshot)
{
    float nearest_m = INFINITY, farthest_m = 0;
    for (size_t i = 0; i < count; i++) {
        if (!(range_m[i] > 0) || !isfinite(range_m[i])) continue;
        if (range_m[i] < nearest_m) nearest_m = range_m[i];
        if (range_m[i] > farthest_m) farthest_m = range_m[i];
    }
    const double near_m = nearest_m, far_m = farthest_m;
    /* brightness 0.85 at the nearest, 0.15 at the farthest; a depth of 0 .. 1 m is not shaded */
    const double log_near = near_m < far_m ? log(near_m) : 0;
    const double per_log = near_m < far_m ? 0.7 / fmax(log(far_m) - log_near, 1e-6) : 0;

    for (size_t i = 0; i < count; i++) {
        const bool   sky = !(range_m[i] > 0) || !isfinite(range_m[i]);
        const double up = normal_up && isfinite(normal_up[i]) ? 0.7 + 0.3 * normal_up[i] : 1;
        if (entity[i] != 0) {
            const uint32_t index = entity[i] - 1;
            const bool     known = index < (uint32_t)snapshot->count;
            const Rgb      c = known ? id_colour(snapshot->entity[index].id) : (Rgb){1, 1, 1};
            const double   shade = 0.45 + 0.55 * up; /* hues stay distinguishable: range does not darken them */
            put(rgb + 3 * i, (Rgb){c.r * shade, c.g * shade, c.b * shade});
        } else if (sky) {
            put(rgb + 3 * i, (Rgb){0.05, 0.07, 0.2});
        } else {
            memset(rgb + 3 * i, code((0.85 - per_log * (log(range_m[i]) - log_near)) * up), 3);
        }
    }
}
