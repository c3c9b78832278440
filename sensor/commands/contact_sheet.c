/* sensor/commands/contact_sheet.c: thumbnails of the variants of a sweep, and the page that shows them. */
#include "sensor/commands/contact_sheet.h"
#include "pitviper_output.h"

#include "render/frame/render.h"
#include "sensor/publish/html.h"
#include "sensor/publish/image_file.h"

#include <stdlib.h>
#include <unistd.h>

enum { thumbnail_px = 160, path_size = 4300 };

Status sheet_begin(ContactSheet *sheet, const char *out, const char *title)
{
    *sheet = (ContactSheet){0};
    snprintf(sheet->path, sizeof sheet->path, "%s/manifest.html", out);
    sheet->page = html_begin(sheet->path, title);
    return sheet->page ? STATUS_OK : STATUS_IO;
}

static double sample_of(const void *pixels, const ImageInfo *info, size_t at)
{
    return info->bits == 16 ? ((const uint16_t *)pixels)[at] / 257.0 : ((const uint8_t *)pixels)[at];
}

/* Box filter over squares into RGB, at column `left` of rows of `stride` pixels. */
static void shrink(uint8_t *out, int stride, int left, const void *pixels, const ImageInfo *info, int square)
{
    const int width = info->width / square, height = info->height / square;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 3; c++) {
                double sum = 0;
                for (int k = 0; k < square * square; k++) {
                    const int column = x * square + k % square, row = y * square + k / square;
                    sum += sample_of(pixels, info, ((size_t)row * (size_t)info->width + (size_t)column) *
                                                       (size_t)info->channels + (size_t)(info->channels > 2 ? c : 0));
                }
                out[3 * ((size_t)y * (size_t)stride + (size_t)(left + x)) + (size_t)c] =
                    (uint8_t)(sum / (square * square) + 0.5);
            }
}

static Status add_band(uint8_t *out, int stride, int left, const char *path, const ImageInfo *info, int square)
{
    void *pixels = malloc((size_t)info->width * (size_t)info->height * (size_t)info->channels * 2);
    if (!pixels) return STATUS_NO_MEMORY;
    const Status status = image_read_png(pixels, path);
    if (status == STATUS_OK) shrink(out, stride, left, pixels, info, square);
    free(pixels);
    return status;
}

/* All bands of a variant have one size. False: there is no image. */
static bool make_thumbnail(const char *made, const char *folder, int frame)
{
    char      path[BAND_COUNT][path_size + 64];
    ImageInfo info = {0};
    int       bands = 0;
    for (int b = 0; b < BAND_COUNT; b++) {
        snprintf(path[bands], sizeof path[bands], "%s/frames/%s/%06d.png", folder, band_name((Band)b), frame);
        bands += access(path[bands], R_OK) == 0;
    }
    if (bands == 0 || image_info(&info, path[0]) != STATUS_OK) return false;
    const int square = (info.width + thumbnail_px - 1) / thumbnail_px, width = info.width / square,
              height = info.height / square, stride = bands * width;
    uint8_t  *rgb = calloc((size_t)stride * (size_t)height, 3);
    Status    status = rgb && height > 0 ? STATUS_OK : STATUS_NO_MEMORY;
    for (int i = 0; i < bands && status == STATUS_OK; i++) {
        ImageInfo one;
        status = image_info(&one, path[i]);
        if (status == STATUS_OK && (one.width != info.width || one.height != info.height)) status = STATUS_BAD_VALUE;
        if (status == STATUS_OK) status = add_band(rgb, stride, i * width, path[i], &one, square);
    }
    if (status == STATUS_OK) status = image_write_png(made, rgb, stride, height, 3, 8);
    free(rgb);
    return status == STATUS_OK;
}

void sheet_add(ContactSheet *sheet, const char *out, const char *folder, int frame, const char *text, bool bad)
{
    char   below[path_size], made[path_size + 16], *bytes = NULL;
    size_t octets;
    snprintf(below, sizeof below, "%s/%s", out, folder);
    snprintf(made, sizeof made, "%s/thumbnail.png", below);
    const int first = (int)strcspn(text, "\n");
    fputs("<figure>", sheet->page);
    if (!make_thumbnail(made, below, frame)) output_remove(made);
    else if (sheet->shown++ >= sheet_inside)
        fprintf(sheet->page, "<img loading=\"lazy\" src=\"%s/thumbnail.png\" alt=\"%s\">", folder, folder);
    else if (text_read_file(&bytes, &octets, "sweep", made, 1 << 26) == STATUS_OK)
        html_image(sheet->page, "png", bytes, octets, folder);
    free(bytes);
    fprintf(sheet->page, "<figcaption><b%s>", bad ? " class=\"bad\"" : "");
    html_text(sheet->page, "%.*s", first, text);
    fputs("</b>", sheet->page);
    for (const char *at = text + first; *at;) {
        at += *at == '\n';
        const int length = (int)strcspn(at, "\n");
        fputs("<br>", sheet->page);
        html_text(sheet->page, "%.*s", length, at);
        at += length;
    }
    fputs("</figcaption></figure>\n", sheet->page);
}

Status sheet_end(ContactSheet *sheet) { return html_end(sheet->page, sheet->path); }
