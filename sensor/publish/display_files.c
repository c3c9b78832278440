/* sensor/publish/display_files.c: files of a band's display and raw counts, and the preview of truth. */
#include "sensor/publish/frame_files.h"

#include "sensor/publish/image_file.h"
#include "sensor/publish/truth_preview.h"

#include <stdlib.h>

static Status write_raw(const FrameFiles *frame, int band)
{
    const FrameDisplay *d     = &frame->display[band];
    const int           w     = frame->picture->width, h = frame->picture->height;
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

Status display_write(const FrameFiles *frame, int band)
{
    char           path[frame_path_size];
    const Picture *p      = frame->picture;
    const size_t   count  = (size_t)p->width * (size_t)p->height;
    const bool     truth  = band == BAND_COUNT;
    const int      bits   = truth ? 8 : frame->config->detector.bits;
    const int      planes = truth ? 3 : frame->display[band].planes;
    if (!truth && frame->raw && frame->display[band].counts[0]) {
        const Status status = write_raw(frame, band);
        if (status != STATUS_OK) return status;
    }
    if (!frame->png) return STATUS_OK;
    uint8_t *shown = malloc(count * (size_t)planes * 2);
    if (!shown) return STATUS_NO_MEMORY;
    if (truth) truth_preview(shown, p->range_m, p->entity, p->normal[2], count, frame->snapshot);
    else frame_display_quantise(shown, &frame->display[band], count, bits);
    const Status status = frame_path(path, frame, "frames", truth ? "truth" : band_name((Band)band), "png")
                              ? image_write_png(path, shown, p->width, p->height, planes, bits)
                              : STATUS_BAD_VALUE;
    free(shown);
    return status;
}
