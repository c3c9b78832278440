/* sensor/commands/sweep/sweep_manifest.c: what a sweep writes about its variants: manifest.jsonl, a line each, and
 * manifest.html, the page of their thumbnails. */
#include "sensor/commands/sweep/sweep_private.h"

#include "pitviper_output.h"
#include "render/frame/render.h"
#include "sensor/publish/files/html_page.h"
#include "sensor/publish/images/image_file.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

/* ---- the page --------------------------------------------------------------------------------------- */

enum { thumbnail_px = 160, path_size = 4300 };

static double sample_of(const void *pixels, const ImageInfo *info, size_t at)
{
    return info->bits == 16 ? ((const uint16_t *)pixels)[at] / 257.0 : ((const uint8_t *)pixels)[at];
}

/* Shrinks an image by a box filter over squares into RGB, at column `left` of rows of `stride` pixels. */
static void shrink(uint8_t *out, int stride, int left, const void *pixels, const ImageInfo *info, int square)
{
    const int width = info->width / square, height = info->height / square;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 3; c++) {
                double sum = 0;
                for (int k = 0; k < square * square; k++) {
                    const int column = x * square + k % square, row = y * square + k / square;
                    sum += sample_of(pixels, info,
                                     ((size_t)row * (size_t)info->width + (size_t)column) * (size_t)info->channels +
                                         (size_t)(info->channels > 2 ? c : 0));
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

/* Writes one image of all bands side by side, which have one size. False: there is none. */
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
    uint8_t *rgb = calloc((size_t)stride * (size_t)height, 3);
    Status   status = rgb && height > 0 ? STATUS_OK : STATUS_NO_MEMORY;
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

/* Makes OUT/folder/thumbnail.png from the display images of this frame; if there are none, there is text only. text:
 * lines below it, the first in bold; bad: the reason of a failure. */
static void add_figure(SweepPage *sheet, const char *out, const char *folder, int frame, const char *text, bool bad)
{
    char below[path_size], made[path_size + 16];
    snprintf(below, sizeof below, "%s/%s", out, folder);
    snprintf(made, sizeof made, "%s/thumbnail.png", below);
    const int first = (int)strcspn(text, "\n");
    fputs("<figure>", sheet->page);
    if (!make_thumbnail(made, below, frame)) output_remove(made);
    else fprintf(sheet->page, "<img loading=\"lazy\" src=\"%s/thumbnail.png\" alt=\"%s\">", folder, folder);
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

/* ---- begin and end ---------------------------------------------------------------------------------- */

static Status begin_page(SweepRun *s)
{
    char        title[256];
    const char *log = s->options->log, *slash = strrchr(log, '/');
    SweepPage  *sheet = &s->sheet;
    snprintf(title, sizeof title, "Sweep of %s: %d variants", slash ? slash + 1 : log, s->count);
    *sheet = (SweepPage){0};
    snprintf(sheet->path, sizeof sheet->path, "%s/manifest.html", s->options->out);
    sheet->page = html_begin(sheet->path, title);
    return sheet->page ? STATUS_OK : STATUS_IO;
}

Status sweep_manifest_begin(SweepRun *s)
{
    char         path[path_size];
    const Status status = begin_page(s);
    if (status != STATUS_OK) return status;
    snprintf(path, sizeof path, "%s/manifest.jsonl", s->options->out);
    s->manifest = output_file(path, 0);
    if (s->manifest) return STATUS_OK;
    log_error("sweep: cannot write %s: %s; choose another folder with --out", path, output_reason(errno));
    return STATUS_IO;
}

Status sweep_manifest_end(SweepRun *s)
{
    Status status = s->sheet.page ? html_end(s->sheet.page, s->sheet.path) : STATUS_OK;
    if (s->manifest && fclose(s->manifest) != 0 && status == STATUS_OK) status = STATUS_IO;
    return status;
}

/* ---- a variant -------------------------------------------------------------------------------------- */

void sweep_settings_words(char out[sweep_words_size], const Sweep *sweep, int number, const char *between)
{
    char   value[sweep_value_size];
    size_t n = 0;
    *out = 0;
    for (int i = 0; i < sweep->axis_count && n < sweep_words_size; i++) {
        sweep_value(value, sweep, number, i);
        n += (size_t)snprintf(out + n, sweep_words_size - n, "%s%s=%s", i ? between : "", sweep->axis[i].key, value);
    }
}

void sweep_report_variant(SweepRun *s, const Variant *v, const Outcome *outcome, int place)
{
    char words[sweep_words_size], text[sweep_words_size + 600];
    sweep_settings_words(words, &s->sweep, v->number, "\n");
    snprintf(text, sizeof text, "%s%s%s\n%s", v->name, *outcome->why ? ": " : "", outcome->why, words);
    /* the middle frame of the run: the target is usually in view */
    add_figure(&s->sheet, s->options->out, v->name, outcome->has_run ? outcome->run.middle_frame : -1, text,
               *outcome->why);
    sweep_settings_words(words, &s->sweep, v->number, ", ");
    if (*outcome->why)
        log_error("sweep: variant %d, %s, %s: %s (%s/%s/log.txt)", v->number + 1, v->name, words, outcome->why,
                  s->options->out, v->name);
    else
        log_print("%d of %d: %s %s, %s: %d frames, %.1f s\n", place + 1, s->count, v->name, outcome->status, words,
                  outcome->run.frames, outcome->seconds);
    fflush(stdout);
}
