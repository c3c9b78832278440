/* sensor/verify/regress/regress_report.c: the HTML report: a table of all cases, then each failed channel with its
 * images. */
#include "sensor/verify/regress/run_case.h"

#include "sensor/publish/files/html_page.h"

#include <stdlib.h>

enum { path_size = case_path_size + 64, shown_width = 288, thumbnail_width = 192, plot_width = 760, plot_height = 220 };

static void out_folder(char out[path_size], const CaseResult *r) { snprintf(out, path_size, "%.4080s/out", r->work); }
static void scratch_file(char out[path_size], const CaseResult *r)
{
    snprintf(out, path_size, "%.4080s/report.png", r->work);
}

static bool both_frames(RecordFrame *expected, RecordFrame *got, const CaseResult *r, int number)
{
    char path[path_size];
    out_folder(path, r);
    if (record_frame_from_run(got, path, number) != STATUS_OK) return false;
    if (record_frame_from_record(expected, r->record, got) == STATUS_OK) {
        if (record_frame_rename_materials(got, expected) == STATUS_OK) return true;
        record_frame_free(expected);
    }
    record_frame_free(got);
    return false;
}

/* ---- a channel that failed -------------------------------------------------------------------- */

/* Writes the tolerance of a channel as text. */
static void tolerance_text(char out[96], int channel, const ChannelResult *found)
{
    const char *unit = found->unit ? found->unit : "", *space = *unit ? " " : "";
    if (found->picture && record_plane_is_id(found->plane)) snprintf(out, 96, "equal");
    else if (channel == CHANNEL_OPTICAL)
        snprintf(out, 96, "%.3g %% and %.3g %s", 100 * found->relative, found->limit, unit);
    else if (found->relative > 0) snprintf(out, 96, "%.3g relative", found->relative);
    else snprintf(out, 96, "%.3g%s%s", found->limit, space, unit);
}

/* One of the two values is at the floor of apparent temperature: the true difference is larger than the one shown. */
static bool at_floor(int channel, const ChannelResult *found)
{
    const PlaneVerdict *v = &found->verdict;
    return (channel == CHANNEL_MWIR || channel == CHANNEL_LWIR) && v->max > 0 &&
           (v->expected <= apparent_floor_k || v->got <= apparent_floor_k);
}

/* Writes how many pixels differ, by how much and where. */
static void put_facts(FILE *page, const ChannelResult *found, int channel)
{
    const PlaneVerdict *v = &found->verdict;
    const bool          ids = found->picture && record_plane_is_id(found->plane);
    char                tolerance[96], unit[24] = "", was[64], is[64];
    tolerance_text(tolerance, channel, found);
    if (found->unit && *found->unit) snprintf(unit, sizeof unit, " %s", found->unit);
    html_text(page, "Frame %d, %s: %zu of %zu %s (%.3g %%) ", found->frame,
              found->picture ? record_plane_name(found->plane) : "range profile", v->beyond, v->compared,
              found->picture ? "pixels" : "bins", 100 * v->share);
    if (ids) html_text(page, "have a different id; ");
    else html_text(page, "differ by more than the tolerance of %s; ", tolerance);
    if (found->allowed > 0) html_text(page, "allowed: %.3g %%.", 100 * found->allowed);
    else html_text(page, "allowed: none.");
    if (v->column < 0) return;
    if (ids) html_text(page, " The first");
    else if (v->unmatched == 0)
        html_text(page, " Rms %.3g%s, largest difference %s%.3g%s", v->rms, unit,
                  at_floor(channel, found) ? "more than " : "", v->max, unit);
    else
        html_text(page,
                  " Rms %.3g%s; in %zu pixels only one of the two is finite, the "
                  "first",
                  v->rms, unit, v->unmatched);
    if (found->picture) html_text(page, " at column %d, row %d", v->column, v->row);
    else html_text(page, " in bin %d of bounce %d", v->column, found->bounce + 1);
    if (ids) snprintf(was, sizeof was, "%.0f", v->expected), snprintf(is, sizeof is, "%.0f", v->got);
    else
        verdict_channel_value(was, (Channel)channel, v->expected, 6),
            verdict_channel_value(is, (Channel)channel, v->got, 6);
    html_text(page, ": expected %s, actual %s.", was, is);
}

static void put_figure(FILE *page, const FalseColour *picture, const char *scratch, const char *unit,
                       const char *caption)
{
    fputs("<figure>", page);
    if (!false_colour_picture(page, picture, shown_width, scratch, caption)) fputs("(image could not be made)", page);
    fputs("<figcaption><b>", page);
    html_text(page, "%s", caption);
    fputs("</b><br>", page);
    if (unit) false_colour_legend(page, picture->colours, picture->scale, unit, scratch);
    else if (picture->colours == COLOURS_IDS) fputs("a colour per id; dark: none", page);
    else fputs("bright: beyond tolerance", page);
    fputs("</figcaption></figure>\n", page);
}

/* 1 where the difference is beyond the tolerance, else 0. */
static void mark_beyond(float *plane, const ChannelPlanes *p, const ChannelResult *found)
{
    for (size_t i = 0; i < (size_t)p->width * (size_t)p->height; i++) {
        const double was = (double)p->expected[i], d = fabs((double)p->difference[i]);
        plane[i] = (float)!(d <= found->limit + (isfinite(was) ? found->relative * fabs(was) : 0));
    }
}

static void put_pictures(FILE *page, const CaseResult *r, const ChannelResult *found, const RecordFrame *expected,
                         const RecordFrame *got)
{
    ChannelPlanes p;
    char          scratch[path_size], was[64], is[64];
    snprintf(was, sizeof was, "expected: %s, frame %d", record_plane_name(found->plane), found->frame);
    snprintf(is, sizeof is, "actual: %s, frame %d", record_plane_name(found->plane), found->frame);
    scratch_file(scratch, r);
    if (!verdict_channel_planes(&p, found, expected, got, &r->c.tolerance)) return;
    const size_t  count = (size_t)p.width * (size_t)p.height;
    const bool    ids = record_plane_is_id(found->plane);
    const Colours colours = ids ? COLOURS_IDS : COLOURS_HEAT;
    const Scale   scale = false_colour_scale(p.expected, p.got, count);
    const Scale   change = false_colour_scale_of_difference(p.difference, count, found->limit);
    const char   *unit = ids ? NULL : found->unit;
    put_figure(page, &(FalseColour){{p.expected}, 1, p.width, p.height, colours, scale}, scratch, unit, was);
    put_figure(page, &(FalseColour){{p.got}, 1, p.width, p.height, colours, scale}, scratch, unit, is);
    if (!ids)
        put_figure(page, &(FalseColour){{p.difference}, 1, p.width, p.height, COLOURS_SIGNED, change}, scratch, unit,
                   "actual - expected");
    mark_beyond(p.got, &p, found);
    put_figure(page, &(FalseColour){{p.got}, 1, p.width, p.height, COLOURS_HEAT, {0, 1}}, scratch, NULL,
               "beyond tolerance");
    if (!ids) fputs("<p class=\"dim\">Values beyond the ends of a scale are clipped. Violet: not finite.</p>\n", page);
    free(p.expected);
    free(p.got);
    free(p.difference);
}

static void put_line(FILE *page, const float *db, int bins, double span_db, const char *style)
{
    fputs("<polyline fill=\"none\" points=\"", page);
    for (int i = 0; i < bins; i++)
        fprintf(page, "%.1f,%.1f ", (i + 0.5) * plot_width / bins, -(double)db[i] / span_db * plot_height);
    fprintf(page, "\" %s/>", style);
}

static void put_profile(FILE *page, const CaseResult *r, const ChannelResult *found, const RecordFrame *expected,
                        const RecordFrame *got)
{
    const int    bins = got->bins, b = found->bounce;
    const double span_db = r->c.tolerance.radar_span_db;
    float       *db = bins > 0 && expected->bins == bins ? malloc(2 * (size_t)bins * sizeof *db) : NULL;
    double       full = 0;
    if (!db) return;
    for (int k = 0; k < frame_bounces; k++)
        for (int i = 0; i < bins; i++)
            full = fmax(full, isfinite(expected->profile[k][i]) ? (double)expected->profile[k][i] : 0);
    verdict_plane_to_db(db, expected->profile[b], (size_t)bins, full, span_db);
    verdict_plane_to_db(db + bins, got->profile[b], (size_t)bins, full, span_db);
    for (int i = 0; i < 2 * bins; i++)
        if (!isfinite(db[i])) db[i] = (float)-span_db;
    fprintf(page,
            "<figure><svg width=\"%d\" height=\"%d\" viewBox=\"0 -5 %d %d\" role=\"img\"><title>range profile</title>"
            "<rect x=\"0\" y=\"0\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"gray\"/>",
            plot_width, plot_height + 10, plot_width, plot_height + 10, plot_width, plot_height);
    put_line(page, db, bins, span_db, "stroke=\"#2a7d3f\" stroke-width=\"3\"");
    put_line(page, db + bins, bins, span_db, "stroke=\"#c0392b\" stroke-width=\"1\"");
    fputs("</svg><figcaption>", page);
    html_text(page,
              "bounce %d: expected thick green, actual thin red; %.1f .. %.1f m from left to right, 0 dB at the "
              "top, -%.0f dB at the bottom",
              b + 1, got->near_m, got->near_m + (bins - 1) * got->bin_m, span_db);
    fputs("</figcaption></figure>\n", page);
    free(db);
}

/* open: the channel is shown expanded from the start. */
static void put_channel(FILE *page, const CaseResult *r, int channel, bool open)
{
    const ChannelResult *found = &r->verdict.channel[channel];
    const bool           plane = found->picture || channel == CHANNEL_PROFILE;
    RecordFrame          expected = {0}, got = {0};
    fprintf(page, "<details%s><summary><b>", open ? " open" : "");
    html_text(page, "%s%s", verdict_channel_name((Channel)channel),
              channel == r->verdict.first ? ": the probable cause" : "");
    fputs("</b> <span class=\"dim\">", page);
    html_text(page, "%s", verdict_channel_about((Channel)channel));
    fputs("</span></summary>\n<p>", page);
    if (plane && found->verdict.compared > 0) put_facts(page, found, channel);
    else html_text(page, "%s", found->line);
    fputs("</p>\n", page);
    if (plane && both_frames(&expected, &got, r, found->frame)) {
        if (found->picture) put_pictures(page, r, found, &expected, &got);
        else put_profile(page, r, found, &expected, &got);
        record_frame_free(&expected);
        record_frame_free(&got);
    }
    fputs("</details>\n", page);
}

/* ---- a case ----------------------------------------------------------------------------------- */

static void put_numbers(FILE *page, const CaseResult *r)
{
    fputs("<table><tr><th>channel</th><th>verdict</th><th class=\"n\">beyond tolerance</th><th class=\"n\">allowed</th>"
          "<th>tolerance</th><th class=\"n\">largest difference</th><th>where: frame (column, row)</th></tr>\n",
          page);
    for (int k = 0; k < CHANNEL_COUNT; k++) {
        const ChannelResult *c = &r->verdict.channel[k];
        const PlaneVerdict  *v = &c->verdict;
        char                 tolerance[96];
        if (!c->there) continue;
        fputs("<tr><td title=\"", page);
        html_text(page, "%s", verdict_channel_about((Channel)k));
        fprintf(page, "\">%s</td><td class=\"%s\">%s</td>", verdict_channel_name((Channel)k),
                c->failed ? "bad" : "good", c->failed ? "failed" : "ok");
        if ((c->picture || k == CHANNEL_PROFILE) && v->compared > 0) {
            tolerance_text(tolerance, k, c);
            fprintf(page, "<td class=\"n\">%zu of %zu</td><td class=\"n\">%.0f</td><td>", v->beyond, v->compared,
                    floor(c->allowed * (double)v->compared));
            html_text(page, "%s", tolerance);
            if (c->picture && record_plane_is_id(c->plane)) fputs("</td><td></td>", page);
            else if (v->unmatched > 0) fputs("</td><td class=\"n\">only one is finite</td>", page);
            else
                fprintf(page, "</td><td class=\"n\">%s%.3g %s</td>", at_floor(k, c) ? "more than " : "", v->max,
                        c->unit ? c->unit : "");
            if (v->column < 0) fputs("<td></td>", page);
            else if (c->picture) fprintf(page, "<td>%d (%d, %d)</td>", c->frame, v->column, v->row);
            else fprintf(page, "<td>%d, bin %d</td>", c->frame, v->column);
        } else {
            fprintf(page, "<td class=\"n\">%d field%s</td><td class=\"n\">0</td><td colspan=\"3\">", c->diffs,
                    c->diffs == 1 ? "" : "s");
            html_text(page, "%s", c->line);
            fputs("</td>", page);
        }
        fputs("</tr>\n", page);
    }
    fputs("</table>\n", page);
}

static void put_block(FILE *page, const char *head, const char *text)
{
    if (!*text) return;
    fprintf(page, "<h3>%s</h3>\n<pre style=\"white-space:pre-wrap\"><code>", head);
    html_text(page, "%s", text);
    fputs("</code></pre>\n", page);
}

void regress_report_failed(FILE *page, const CaseResult *r, int number)
{
    fprintf(page, "<h2 id=\"case%d\">", number);
    html_text(page, "%s", r->c.name);
    fputs("</h2>\n<p class=\"dim\">", page);
    html_text(page, "%s", r->c.purpose);
    fputs("</p>\n<p class=\"bad\">", page);
    html_text(page, "%s", r->line);
    fputs("</p>\n", page);
    put_block(page, "Inputs that differ from those of the baseline", r->compared ? r->verdict.remarks : "");
    if (r->compared) put_numbers(page, r);
    /* expanded at first are the probable cause and the first channel with an image */
    if (r->compared) fputs("<h3>Failed channels, in the order of the data path</h3>\n", page);
    bool pictured = false;
    for (int k = 0; k < CHANNEL_COUNT && r->compared; k++) {
        const ChannelResult *c = &r->verdict.channel[k];
        if (!c->failed) continue;
        put_channel(page, r, k, k == r->verdict.first || (c->picture && !pictured));
        pictured |= c->picture;
    }
    put_block(page, "Last lines of the run", r->said);
    put_block(page, "To reproduce", r->command);
}

/* Puts one image of the first frame for each band. */
static void put_thumbnails(FILE *page, const CaseResult *r)
{
    static const char *const plane_name[] = {"optical.R", "optical.Y", "mwir.Y", "lwir.Y", "radar.Y"};
    static const char *const name[] = {"optical", "optical", "mwir, W/(m2 sr)", "lwir, W/(m2 sr)", "radar, dB"};
    char                     out[path_size], scratch[path_size];
    RecordFrame              f = {0};
    out_folder(out, r);
    scratch_file(scratch, r);
    if (record_frame_from_run(&f, out, (int)r->c.frames.number[0]) != STATUS_OK) return;
    const size_t count = (size_t)f.width * (size_t)f.height;
    float       *db = malloc(count * sizeof *db);
    for (int i = 0; i < 5 && db; i++) {
        const float *plane[3] = {f.number_plane[record_plane(plane_name[i])], f.number_plane[record_plane("optical.G")],
                                 f.number_plane[record_plane("optical.B")]};
        const bool   rgb = i == 0 && plane[1] && plane[2];
        if (!plane[0]) continue;
        if (i == 4) {
            double full = 0;
            for (size_t k = 0; k < count; k++) full = isfinite(plane[0][k]) ? fmax(full, (double)plane[0][k]) : full;
            verdict_plane_to_db(db, plane[0], count, full, r->c.tolerance.radar_span_db);
            plane[0] = db;
        }
        Scale scale = false_colour_scale(plane[0], NULL, count);
        if (rgb) scale.low = 0;
        fputs("<figure>", page);
        false_colour_picture(
            page, &(FalseColour){{plane[0], plane[1], plane[2]}, rgb ? 3 : 1, f.width, f.height, COLOURS_HEAT, scale},
            thumbnail_width, scratch, name[i]);
        fputs("<figcaption>", page);
        if (rgb || i == 1) html_text(page, "%s", name[i]);
        else html_text(page, "%s: %.4g .. %.4g", name[i], scale.low, scale.high);
        fputs("</figcaption></figure>\n", page);
    }
    free(db);
    record_frame_free(&f);
}

static void put_passed(FILE *page, const CaseResult *r, int number)
{
    fprintf(page, "<details id=\"case%d\"><summary><b>", number);
    html_text(page, "%s", r->c.name);
    fprintf(page, "</b> <span class=\"%s\">%s</span> ", r->state == CASE_OK ? "good" : "dim",
            case_state_name(r->state));
    html_text(page, "%s%s", r->c.purpose, "");
    fputs("</summary>\n", page);
    if (*r->line) {
        fputs("<p>", page);
        html_text(page, "%s", r->line);
        fputs("</p>\n", page);
    }
    if (r->compared) {
        put_thumbnails(page, r);
        put_numbers(page, r);
        put_block(page, "Inputs that differ from those of the baseline", r->verdict.remarks);
        put_block(page, "To reproduce", r->command);
    }
    fputs("</details>\n", page);
}

static bool has_failed(const CaseResult *r) { return r->state != CASE_OK && r->state != CASE_SKIPPED; }

static void put_summary(FILE *page, const CaseResult *const *result, int count)
{
    int failed = 0, skipped = 0;
    for (int i = 0; i < count; i++) {
        failed += has_failed(result[i]);
        skipped += result[i]->state == CASE_SKIPPED;
    }
    fprintf(page,
            "<p>pitviper " PITVIPER_VERSION ": %d case%s, <span class=\"%s\">%d failed</span>, %d skipped. Each case "
            "re-renders a recorded exercise and compares it with its approved baseline. The first failed channel along "
            "the data path is named: it is the probable cause of those after it.</p>\n",
            count, count == 1 ? "" : "s", failed ? "bad" : "good", failed, skipped);
    fputs("<table><tr><th>case</th><th>result</th><th>what</th><th class=\"n\">s</th></tr>\n", page);
    for (int i = 0; i < count; i++) {
        const CaseResult *r = result[i];
        fprintf(page, "<tr><td><a href=\"#case%d\">", i);
        html_text(page, "%s", r->c.name);
        fprintf(page, "</a></td><td class=\"%s\">%s</td><td>",
                has_failed(r)         ? "bad"
                : r->state == CASE_OK ? "good"
                                      : "dim",
                case_state_name(r->state));
        html_text(page, "%s", *r->line ? r->line : r->c.purpose);
        fprintf(page, "</td><td class=\"n\">%.1f</td></tr>\n", r->seconds);
    }
    fputs("</table>\n", page);
}

Status regress_report_write(const char *path, const CaseResult *const *result, int count)
{
    FILE *page = html_begin(path, "Regression");
    bool  passed = false;
    if (!page) return STATUS_IO;
    put_summary(page, result, count);
    for (int i = 0; i < count; i++) {
        if (has_failed(result[i])) regress_report_failed(page, result[i], i);
        else passed = true;
    }
    if (passed) fputs("<h2>Passed and skipped</h2>\n", page);
    for (int i = 0; i < count; i++)
        if (!has_failed(result[i])) put_passed(page, result[i], i);
    return html_end(page, path);
}
