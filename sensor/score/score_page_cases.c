/* sensor/score/score_page_cases.c: the worst misses and false alarms, with what the frame's PNG has there. */
#include "sensor/publish/files/html_page.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/score/score_page_private.h"

#include <stdlib.h>
#include <unistd.h>

enum { least_crop_px = 32, path_size = 4096 + worst_sequence_size + 64, picture_most = 64 << 20 };

static bool has_box(const WorstCase *c)
{
    for (int k = 0; k < 4; k++)
        if (!(fabs(c->box_px[k]) < 1e6)) return false;
    return c->box_px[2] >= 0 && c->box_px[3] >= 0;
}

/* Of the frame's PNG, below the folder of products. */
static void frame_path(char out[path_size], const WorstCase *c)
{
    snprintf(out, path_size, "%s%sframes/%s/%06d.png", c->sequence, c->sequence[0] ? "/" : "", band_name(c->band),
             c->frame);
}

/* The octets of a path that a link may have; others as %XX. */
static void put_link(FILE *page, const char *path)
{
    fputs("<a href=\"", page);
    for (const unsigned char *p = (const unsigned char *)path; *p; p++) {
        const bool plain =
            (*p >= 'a' && *p <= 'z') || (*p >= 'A' && *p <= 'Z') || (*p >= '0' && *p <= '9') || strchr("/._-", *p);
        if (plain) fputc(*p, page);
        else fprintf(page, "%%%02X", *p);
    }
    fputs("\">", page);
}

/* ---- the crop ------------------------------------------------------------------------------------- */

typedef struct Crop {
    int left, top, size; /* a square, px, that has the box in its middle third */
} Crop;

static Crop crop_about(const double box_px[4], int width, int height)
{
    const double wanted = fmax(least_crop_px, 3 * fmax(box_px[2], box_px[3]));
    const int    most = width < height ? width : height, size = wanted < most ? (int)ceil(wanted) : most;
    const double left = floor(box_px[0] + 0.5 * box_px[2] - 0.5 * size),
                 top = floor(box_px[1] + 0.5 * box_px[3] - 0.5 * size);
    return (Crop){(int)fmax(0, fmin(left, width - size)), (int)fmax(0, fmin(top, height - size)), size};
}

static void put_box(FILE *page, const double box_px[4], const Crop *crop)
{
    const double left = fmax(0, box_px[0] - crop->left), top = fmax(0, box_px[1] - crop->top),
                 right = fmin(crop->size, box_px[0] + box_px[2] - crop->left),
                 bottom = fmin(crop->size, box_px[1] + box_px[3] - crop->top), to_percent = 100.0 / crop->size;
    if (right < left || bottom < top) return;
    fprintf(page, "<i style=\"left:%.2f%%;top:%.2f%%;width:%.2f%%;height:%.2f%%\"></i>", left * to_percent,
            top * to_percent, (right - left) * to_percent, (bottom - top) * to_percent);
}

/* False: there is no such picture. scratch: empty from when none can be read. */
static bool put_crop(FILE *page, const ScoreReport *report, const WorstCase *c, char *scratch)
{
    char      path[2 * path_size], below[path_size];
    ImageInfo info;
    frame_path(below, c);
    snprintf(path, sizeof path, "%s/%s", report->out, below);
    if (access(path, R_OK) != 0) return false;
    if (image_read_prepare() != STATUS_OK || image_file_prepare() != STATUS_OK) { /* said once */
        unlink(scratch);
        scratch[0] = 0;
        return false;
    }
    if (image_info(&info, path) != STATUS_OK) return false;
    const size_t octets = (size_t)info.channels * (size_t)(info.bits / 8), row = (size_t)info.width * octets;
    if ((info.channels != 1 && info.channels != 3) || (info.bits != 8 && info.bits != 16) ||
        row * (size_t)info.height > picture_most)
        return false;
    uint8_t   *all = malloc(row * (size_t)info.height);
    const Crop crop = crop_about(c->box_px, info.width, info.height);
    bool       ok = all && image_read_png(all, path) == STATUS_OK;
    if (ok) {
        const size_t wide = (size_t)crop.size * octets;
        for (int y = 0; y < crop.size; y++) /* to the front, row by row */
            memmove(all + (size_t)y * wide, all + (size_t)(crop.top + y) * row + (size_t)crop.left * octets, wide);
        put_link(page, below);
        fputs("<span class=\"crop\">", page);
        ok = html_png(page, all, crop.size, crop.size, info.channels, info.bits, scratch, "the frame there");
        if (ok) put_box(page, c->box_px, &crop);
        fputs("</span></a>", page);
    }
    free(all);
    return ok;
}

/* ---- tables --------------------------------------------------------------------------------------- */

static bool any_sequence(const WorstCases *cases)
{
    bool any = false;
    for (int i = 0; i < cases->count; i++) any = any || cases->one[i].sequence[0];
    return any;
}

static void put_case(FILE *page, const ScoreReport *report, const WorstCase *c, bool miss, bool sequences,
                     char *scratch)
{
    fputs("<tr><td>", page);
    if (!scratch[0] || !has_box(c) || !put_crop(page, report, c, scratch))
        fputs("<span class=\"dim\">&ndash;</span>", page);
    fputs("</td>", page);
    if (sequences) {
        fputs("<td>", page);
        page_text(page, c->sequence);
        fputs("</td>", page);
    }
    page_cell(page, "%.0f", c->frame);
    page_cell(page, "%.2f", c->t_s);
    fprintf(page, "<td>%s</td><td>", band_name(c->band));
    page_text(page, c->name);
    if (c->id[0]) {
        fputs(" <span class=\"dim\">", page);
        page_text(page, c->id);
        fputs("</span>", page);
    } else if (c->track) html_text(page, ", track %u", c->track);
    fputs("</td><td class=\"n\">", page);
    if (has_box(c))
        html_text(page, "%.0f, %.0f; %.0f \xc3\x97 %.0f", c->box_px[0], c->box_px[1], c->box_px[2], c->box_px[3]);
    fputs("</td>", page);
    if (miss) {
        page_cell(page, "%.0f", c->weight);
        page_cell(page, "%.0f", c->range_m);
        page_cell(page, "%.2f", c->visible_fraction);
        page_cell(page, "%.1f", c->snr);
    } else page_cell(page, "%.3f", c->weight);
    fputs("</tr>\n", page);
}

static void put_cases(FILE *page, const ScoreReport *report, bool misses, char *scratch)
{
    const int each = report->recognisers > 1 ? worst_most / 2 : worst_most;
    for (int k = 0; k < report->recognisers; k++) {
        const ScoreRecogniser *r = &report->recogniser[k];
        const WorstCases      *cases = misses ? &r->missed : &r->false_alarms;
        if (report->recognisers > 1) {
            fputs("<p>", page);
            page_key(page, report, k);
            fputs("</p>\n", page);
        }
        if (cases->count == 0) {
            fputs("<p class=\"dim\">None.</p>\n", page);
            continue;
        }
        const bool sequences = any_sequence(cases);
        fputs("<div class=\"scroll\"><table class=\"figures cases\"><thead><tr><th></th>", page);
        if (sequences) fputs("<th>sequence</th>", page);
        fputs("<th class=\"n\">frame</th><th class=\"n\">time, s</th><th>band</th>", page);
        fputs(misses ? "<th>target</th>" : "<th>answered as</th>", page);
        fputs("<th class=\"n\">box, px</th>", page);
        fputs(misses ? "<th class=\"n\">pixels</th><th class=\"n\">range, m</th><th class=\"n\">visible</th><th "
                       "class=\"n\">SNR</th>"
                     : "<th class=\"n\">score</th>",
              page);
        fputs("</tr></thead><tbody>\n", page);
        for (int i = 0; i < cases->count && i < each; i++)
            put_case(page, report, &cases->one[i], misses, sequences, scratch);
        fputs("</tbody></table></div>\n", page);
    }
}

void page_cases(FILE *page, const ScoreReport *report)
{
    char scratch[temp_path_size] = "";
    if (!temp_file(scratch, ".png")) scratch[0] = 0;
    fputs("<h2>Worst misses</h2>\n<p class=\"dim\">Of each target the frame of its most visible pixels in which it was "
          "missed; the largest first. Box: left, top; width &times; height.</p>\n",
          page);
    put_cases(page, report, true, scratch);
    fputs("<h2>Worst false alarms</h2>\n<p class=\"dim\">Of answers alike the one of the highest score.</p>\n", page);
    put_cases(page, report, false, scratch);
    if (scratch[0]) unlink(scratch);
}
