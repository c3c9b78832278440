/* sensor/score/score_page_tables.c: tables of classes, confusion, tracks, errors and ages. */
#include "sensor/frame/target_record.h"
#include "sensor/score/score_page_private.h"

/* ---- average precision ---------------------------------------------------------------------------- */

static const ScorePrecision *precision_of(const ScoreRecogniser *r, const char *name)
{
    for (int i = 0; i < r->classes && i < score_classes_max; i++)
        if (r->of_class[i].name && strcmp(r->of_class[i].name, name) == 0) return &r->of_class[i].all;
    return NULL;
}

/* In the order of their numbers. */
static void put_precisions(FILE *page, const ScoreReport *report)
{
    fputs("<div class=\"scroll\"><table class=\"figures\"><thead>", page);
    if (report->recognisers > 1) {
        fputs("<tr><th></th><th></th>", page);
        for (int k = 0; k < report->recognisers; k++) {
            fputs("<th class=\"rec\" colspan=\"4\">", page);
            page_key(page, report, k);
            fputs("</th>", page);
        }
        fputs("</tr>", page);
    }
    fputs("<tr><th>class</th><th class=\"n\">targets</th>", page);
    for (int k = 0; k < report->recognisers; k++)
        fprintf(page,
                "<th class=\"n%s\">answers</th><th class=\"n\">AP</th><th class=\"n\">AP50</th><th "
                "class=\"n\">by centres</th>",
                report->recognisers > 1 ? " first" : "");
    fputs("</tr></thead><tbody>\n", page);
    for (int c = 1; c <= target_class_count(); c++) {
        const char           *name = target_class_name(c);
        const ScorePrecision *any = NULL;
        for (int k = 0; k < report->recognisers && !any; k++) any = precision_of(&report->recogniser[k], name);
        if (!any) continue;
        fputs("<tr><td>", page);
        page_text(page, name);
        fputs("</td>", page);
        page_cell(page, "%.0f", (double)any->targets);
        for (int k = 0; k < report->recognisers; k++) {
            const ScorePrecision *p = precision_of(&report->recogniser[k], name);
            page_cell(page, "%.0f", p ? (double)p->answers : (double)NAN);
            page_cell(page, "%.3f", p ? p->ap : (double)NAN);
            page_cell(page, "%.3f", p ? p->ap50 : (double)NAN);
            page_cell(page, "%.3f", p ? p->ap_centre : (double)NAN);
        }
        fputs("</tr>\n", page);
    }
    fputs("</tbody></table></div>\n", page);
}

/* ---- confusion ------------------------------------------------------------------------------------ */

static bool any_in(const ScoreConfusion *c, int row, int column, int classes)
{
    for (int i = 0; i <= classes; i++)
        for (int j = 0; j < classes + 2; j++)
            if ((row < 0 || row == i) && (column < 0 || column == j) && c->count[i][j]) return true;
    return false;
}

static const char *column_name(int column, int classes)
{
    return column < classes ? target_class_name(column + 1) : column == classes ? "unknown" : "missed";
}

static void put_confusion_cell(FILE *page, long long count, long long of, bool right, bool end)
{
    const double share = of > 0 ? (double)count / (double)of : 0;
    fprintf(page, "<td class=\"%s%s%s\"", count ? "" : "none", right ? " right" : "", end ? " end" : "");
    if (count)
        fprintf(page, " style=\"background:rgba(%s,%.2f)\"", right ? "33,122,60" : "194,87,12", 0.04 + 0.5 * share);
    if (count) fprintf(page, ">%lld<small>%.0f %%</small></td>", count, 100 * share);
    else fputs(">0</td>", page);
}

static void put_confusion(FILE *page, const ScoreReport *report, int k)
{
    const ScoreConfusion *c = &report->recogniser[k].confusion;
    const int             classes = target_class_count();
    bool                  column[score_classes_max + 2] = {0};
    for (int j = 0; j < classes + 2; j++)
        column[j] = any_in(c, -1, j, classes) || (j < classes && any_in(c, j, -1, classes));
    if (!any_in(c, -1, -1, classes)) return;
    fputs("<div>", page);
    if (report->recognisers > 1) {
        fputs("<p>", page);
        page_key(page, report, k);
        fputs("</p>", page);
    }
    fputs("<div class=\"scroll\"><table class=\"heat\"><thead><tr><th>target \\ answer</th>", page);
    for (int j = 0; j < classes + 2; j++)
        if (column[j]) {
            fprintf(page, "<th%s>", j >= classes ? " class=\"end\"" : "");
            page_text(page, column_name(j, classes));
            fputs("</th>", page);
        }
    fputs("</tr></thead><tbody>\n", page);
    for (int i = 0; i <= classes; i++) {
        if (!any_in(c, i, -1, classes)) continue;
        long long of = 0;
        for (int j = 0; j < classes + 2; j++) of += c->count[i][j];
        fputs("<tr><th>", page);
        page_text(page, i < classes ? target_class_name(i + 1) : "nothing (false)");
        fputs("</th>", page);
        for (int j = 0; j < classes + 2; j++)
            if (column[j] && !(i == classes && j == classes + 1))
                put_confusion_cell(page, c->count[i][j], of, i == j && i < classes, j >= classes);
            else if (column[j]) fputs("<td class=\"end\"></td>", page);
        fputs("</tr>\n", page);
    }
    fputs("</tbody></table></div></div>\n", page);
}

void page_classes(FILE *page, const ScoreReport *report)
{
    fputs("<h2>Classes</h2>\n<p class=\"dim\">Average precision as COCO has it, mean of IoU 0.50 to 0.95, and at 0.50; "
          "by centres: with the rule of the rates.</p>\n",
          page);
    put_precisions(page, report);
    fputs("<h3>What targets were answered as</h3>\n<p class=\"dim\">Counts, and shares of their row. Green: the right "
          "class.</p>\n<div class=\"pair\">\n",
          page);
    for (int k = 0; k < report->recognisers; k++) put_confusion(page, report, k);
    fputs("</div>\n", page);
}

/* ---- a row a figure, a column a recogniser -------------------------------------------------------- */

typedef struct FigureRow {
    const char *name, *format; /* format NULL: a heading */
    double (*of)(const ScoreRecogniser *r);
} FigureRow;

static void put_figures(FILE *page, const ScoreReport *report, const FigureRow *row, int rows)
{
    fputs("<div class=\"scroll\"><table class=\"figures\"><thead><tr><th></th>", page);
    for (int k = 0; k < report->recognisers; k++) {
        fputs("<th class=\"n\">", page);
        page_key(page, report, k);
        fputs("</th>", page);
    }
    fputs("</tr></thead><tbody>\n", page);
    for (int i = 0; i < rows; i++) {
        bool known = !row[i].format;
        for (int k = 0; k < report->recognisers && !known; k++) known = isfinite(row[i].of(&report->recogniser[k]));
        if (!known) continue;
        if (!row[i].format) {
            fprintf(page, "<tr><th colspan=\"%d\">%s</th></tr>\n", 1 + report->recognisers, row[i].name);
            continue;
        }
        fprintf(page, "<tr><td>%s</td>", row[i].name);
        for (int k = 0; k < report->recognisers; k++) page_cell(page, row[i].format, row[i].of(&report->recogniser[k]));
        fputs("</tr>\n", page);
    }
    fputs("</tbody></table></div>\n", page);
}

#define COUNT(name, member)                                                                                            \
    static double name(const ScoreRecogniser *r)                                                                       \
    {                                                                                                                  \
        return r->tracks.sequences ? (double)r->tracks.member : (double)NAN;                                           \
    }
#define RATIO(name, call)                                                                                              \
    static double name(const ScoreRecogniser *r) { return call(&r->tracks); }
#define SHARE(name, member, of)                                                                                        \
    static double name(const ScoreRecogniser *r) { return (double)r->tracks.member / (double)r->tracks.of; }

RATIO(idf1, tracks_idf1)
RATIO(idp, tracks_idp)
RATIO(idr, tracks_idr)
RATIO(mota, tracks_mota)
RATIO(purity, tracks_purity)
RATIO(track_length, tracks_length)
RATIO(delay_s, tracks_delay_s)
COUNT(switches, switches)
COUNT(fragmentations, fragmentations)
COUNT(track_count, tracks)
COUNT(tracks_false, tracks_false)
COUNT(length_most, length_most)
COUNT(targets, truths)
COUNT(targets_found, truths_found)
COUNT(mostly_tracked, mostly_tracked)
COUNT(mostly_lost, mostly_lost)
COUNT(delay_most_s, delay_s_most)
COUNT(hidings, hidings)
COUNT(coasts, coasts)
COUNT(resumed, resumed)
COUNT(returns, returns)
COUNT(coast_most, coast_most)
SHARE(coast_length, coast_frames, coasts)
SHARE(coast_held, coast_held, coast_frames)
SHARE(coast_similarity, coast_similarity, coast_frames)

static double idf1_most(const ScoreRecogniser *r)
{
    return r->tracks.idtp_dropped ? tracks_idf1_most(&r->tracks) : (double)NAN;
}

void page_tracks(FILE *page, const ScoreReport *report)
{
    static const FigureRow row[] = {
        {"identity", NULL, NULL},
        {"IDF1", "%.3f", idf1},
        {"IDF1 at most (not all tracks had room)", "%.3f", idf1_most},
        {"IDP: share of answers", "%.3f", idp},
        {"IDR: share of targets", "%.3f", idr},
        {"MOTA", "%.3f", mota},
        {"switches", "%.0f", switches},
        {"fragmentations", "%.0f", fragmentations},
        {"tracks", NULL, NULL},
        {"track numbers", "%.0f", track_count},
        {"of these never on a target", "%.0f", tracks_false},
        {"purity of the others, mean", "%.3f", purity},
        {"their answers, mean", "%.1f", track_length},
        {"their answers, most", "%.0f", length_most},
        {"targets", NULL, NULL},
        {"targets to be found", "%.0f", targets},
        {"of these found", "%.0f", targets_found},
        {"in over 80 % of their frames", "%.0f", mostly_tracked},
        {"in under 20 %", "%.0f", mostly_lost},
        {"time to first detection, mean, s", "%.2f", delay_s},
        {"time to first detection, most, s", "%.2f", delay_most_s},
        {"coasting: while a tracked target is hidden", NULL, NULL},
        {"times that one is hidden", "%.0f", hidings},
        {"its track goes on answering", "%.0f", coasts},
        {"for frames, mean", "%.1f", coast_length},
        {"for frames, most", "%.0f", coast_most},
        {"share of these frames on the target", "%.3f", coast_held},
        {"overlap with the target, mean similarity", "%.3f", coast_similarity},
        {"times that the target is found again", "%.0f", returns},
        {"by the same track", "%.0f", resumed},
    };
    bool any = false;
    for (int k = 0; k < report->recognisers; k++) any = any || report->recogniser[k].tracks.sequences > 0;
    fputs("<h2>Tracks</h2>\n", page);
    if (any) put_figures(page, report, row, (int)(sizeof row / sizeof *row));
    else fputs("<p class=\"dim\">No answer has a track number.</p>\n", page);
}

/* ---- errors and ages ------------------------------------------------------------------------------ */

#define ERROR(name, member)                                                                                            \
    static double name(const ScoreRecogniser *r) { return r->errors.count ? (double)r->errors.member : (double)NAN; }
#define AGE(name, member)                                                                                              \
    static double name(const ScoreRecogniser *r) { return r->ages.count ? (double)r->ages.member : (double)NAN; }

ERROR(mean_column, mean_px[0])
ERROR(mean_row, mean_px[1])
ERROR(rms_px, rms_px)
ERROR(error_count, count)
ERROR(ranges, ranges)
ERROR(range_mean, range_mean_m)
ERROR(range_rms, range_rms_m)
AGE(age_count, count)
AGE(age_median, median_ms)
AGE(age_p95, p95_ms)
AGE(age_most, max_ms)
AGE(age_late, late)

static double rms_mdeg(const ScoreRecogniser *r) { return r->errors.count ? 1000 * r->errors.rms_deg : (double)NAN; }

void page_errors(FILE *page, const ScoreReport *report)
{
    static const FigureRow row[] = {
        {"centroid: answer less target", NULL, NULL},
        {"found targets", "%.0f", error_count},
        {"mean, column, px", "%+.2f", mean_column},
        {"mean, row, px", "%+.2f", mean_row},
        {"rms, px", "%.2f", rms_px},
        {"rms, 0.001 deg", "%.2f", rms_mdeg},
        {"range: answer less target", NULL, NULL},
        {"answers with a range", "%.0f", ranges},
        {"mean, m", "%+.1f", range_mean},
        {"rms, m", "%.1f", range_rms},
        {"age of answers", NULL, NULL},
        {"answers whose age is known", "%.0f", age_count},
        {"median, ms", "%.1f", age_median},
        {"95 % below, ms", "%.1f", age_p95},
        {"most, ms", "%.1f", age_most},
        {"after an answer to a newer frame", "%.0f", age_late},
    };
    fputs("<h2>Errors and ages</h2>\n", page);
    put_figures(page, report, row, (int)(sizeof row / sizeof *row));
}
