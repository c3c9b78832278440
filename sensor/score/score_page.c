/* sensor/score/score_page.c: the page of a report: what was scored, the few numbers, and how it was scored. */
#include "sensor/publish/files/html_page.h"
#include "sensor/score/score_page_private.h"

const char *const page_colour[score_recognisers_max] = {SVG_BLUE, SVG_AMBER, SVG_GREEN, SVG_PLUM};
const char *const page_dashes[score_recognisers_max] = {NULL, "7 3", "2 3", "9 3 2 3"};

static const char rules[] =
    "body{max-width:76rem}h1{margin-bottom:.2rem}h2{border-top:1px solid var(--line);padding-top:1rem}\n"
    "p{margin:.4rem 0}.scroll{overflow-x:auto}.dim,small{opacity:.7}\n"
    ".keys{display:flex;flex-wrap:wrap;gap:.2rem 1.4rem;margin:.4rem 0 .8rem}.key{white-space:nowrap}\n"
    ".key svg{vertical-align:middle;margin-right:.4rem}\n"
    ".big td,.big th{padding:.45rem clamp(.6rem,1.8vw,1.6rem) .45rem 0;border:0}.big th{font-weight:400;font-size:.85rem;opacity:.8}\n"
    ".big td{font-size:clamp(1.15rem,2.6vw,1.5rem);font-weight:600;line-height:1.25;border-top:1px solid var(--line)}\n"
    ".big td small{display:block;font-size:.8rem;font-weight:400;white-space:nowrap}\n"
    ".big td.who{font-size:1rem;max-width:14rem;overflow-wrap:break-word}.who .key{white-space:normal}\n"
    "table.figures td,table.figures th{padding:.2rem .6rem}table.figures th{vertical-align:bottom}\n"
    ".figures th.rec{text-align:center;border-left:1px solid var(--line)}.figures .first{border-left:1px solid var(--line)}\n"
    ".plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,26rem),1fr));gap:1rem}\n"
    ".plots figure{margin:0}.plots svg{display:block;width:100%;height:auto;border:1px solid var(--line);border-radius:6px}\n"
    ".pair{display:flex;flex-wrap:wrap;gap:1rem 3rem}\n"
    "details{margin:.3rem 0 .6rem;font-size:.9rem}summary{cursor:pointer;opacity:.7}\n"
    ".heat td{text-align:right;min-width:3.4rem}.heat td.none{opacity:.35}.heat .end{border-left:2px solid var(--line)}\n"
    ".heat th{font-weight:400}.heat thead th{text-align:right;vertical-align:bottom}.heat tbody th{text-align:left}\n"
    ".heat .right{outline:2px solid var(--line);outline-offset:-2px}.heat small{display:block;line-height:1.1}\n"
    ".crop{position:relative;display:inline-block;line-height:0}.crop img{width:88px;height:88px;object-fit:fill}\n"
    ".crop i{position:absolute;outline:1.5px solid #ff3b30}.cases td{vertical-align:middle}\n"
    "dl{display:grid;grid-template-columns:max-content 1fr;gap:.2rem 1.2rem}dd{margin:0}\n";

void page_text(FILE *page, const char *text)
{
    char shown[8192];
    text_show(shown, sizeof shown, text, false);
    html_text(page, "%s", shown);
}

void page_key(FILE *page, const ScoreReport *report, int k)
{
    fputs("<span class=\"key\"><svg class=\"pvp\" width=\"30\" height=\"10\">", page);
    svg_line(page, &(SvgPen){page_colour[k], 3, page_dashes[k]}, 0, 5, 30, 5);
    fputs("</svg>", page);
    page_text(page, report->recogniser[k].name);
    fputs("</span>", page);
}

void page_legend(FILE *page, const ScoreReport *report)
{
    if (report->recognisers < 2) return;
    fputs("<div class=\"keys\">", page);
    for (int k = 0; k < report->recognisers; k++) page_key(page, report, k);
    fputs("</div>\n", page);
}

__attribute__((format(printf, 2, 0))) void page_cell(FILE *page, const char *format, double value)
{
    fputs("<td class=\"n\">", page);
    if (isfinite(value)) html_text(page, format, value);
    else fputs("<span class=\"dim\">&ndash;</span>", page);
    fputs("</td>", page);
}

/* ---- the few numbers ------------------------------------------------------------------------------ */

/* About three figures, and so many behind the point that a share and its bounds have as many. */
static const char *figures(char out[32], double value)
{
    if (value != 0 && fabs(value) < 0.0095) snprintf(out, 32, "%.2g", value);
    else if (value != 0 && fabs(value) < 0.0995) snprintf(out, 32, "%.3f", value);
    else snprintf(out, 32, "%.*f", fabs(value) < 10 ? 2 : fabs(value) < 100 ? 1 : 0, value);
    return out;
}

__attribute__((format(printf, 3, 4))) static void put_big(FILE *page, double value, const char *below, ...)
{
    char    text[128], value_text[32];
    va_list arguments;
    va_start(arguments, below);
    vsnprintf(text, sizeof text, below, arguments);
    va_end(arguments);
    if (isnan(value)) {
        fputs("<td><span class=\"dim\">&ndash;</span></td>", page);
        return;
    }
    fprintf(page, "<td>%s<small>", figures(value_text, value));
    html_text(page, "%s", text);
    fputs("</small></td>", page);
}

static void put_share(FILE *page, const ScoreShare *share)
{
    char low[32], high[32];
    put_big(page, share->value, "%s \xe2\x80\x93 %s", figures(low, share->low), figures(high, share->high));
}

static void put_numbers(FILE *page, const ScoreReport *report)
{
    fputs("<div class=\"scroll\"><table class=\"big\"><thead><tr><th></th><th>found (P<sub>d</sub>)</th><th>with its "
          "class</th><th>false alarms<br>a frame</th><th>mAP</th><th>IDF1</th><th>age, ms</th></tr></thead><tbody>\n",
          page);
    for (int k = 0; k < report->recognisers; k++) {
        const ScoreRecogniser *r = &report->recogniser[k];
        fputs("<tr><td class=\"who\">", page);
        page_key(page, report, k);
        fputs("<small>", page);
        html_text(page, "%lld answers", r->answers);
        fputs("</small></td>", page);
        put_share(page, &r->total.detection);
        put_share(page, &r->total.recognition);
        put_share(page, &r->total.per_frame);
        const bool coco = isfinite(r->map);
        put_big(page, coco ? r->map : r->ap_centre, coco ? "AP50 %.2f" : "by centres", r->map50);
        put_big(page, tracks_idf1(&r->tracks), "%llu switches", (unsigned long long)r->tracks.switches);
        put_big(page, r->ages.count > 0 ? r->ages.median_ms : (double)NAN, "p95 %.0f", r->ages.p95_ms);
        fputs("</tr>\n", page);
    }
    fputs("</tbody></table></div>\n<p class=\"dim\">Small figures below rates: bounds of 95 %, with a sequence as one "
          "sample.</p>\n",
          page);
}

/* ---- what was scored, and how --------------------------------------------------------------------- */

static void put_bands(FILE *page, unsigned bands)
{
    int count = 0;
    for (int b = 0; b < BAND_COUNT; b++)
        if (bands >> b & 1) html_text(page, "%s%s", count++ ? ", " : "", band_name((Band)b));
    if (!count) fputs("no band", page);
}

static void put_head(FILE *page, const ScoreReport *report)
{
    unsigned bands = 0;
    for (int k = 0; k < report->recognisers; k++) bands |= report->recogniser[k].bands;
    fputs("<p>", page);
    page_text(page, report->out);
    html_text(page, ": %d %s%s, %lld frames, in ", report->sequences, report->sweep ? "variant" : "sequence",
              report->sequences == 1 ? "" : "s", report->frames);
    put_bands(page, bands);
    if (report->recognisers > 0) {
        const ScoreRates *first = &report->recogniser[0].total;
        html_text(page, "; %lld targets to be found in %lld frames and bands", first->chances, first->frames);
    }
    fputs("</p>\n", page);
}

static void put_recognisers(FILE *page, const ScoreReport *report)
{
    fputs("<h2>Answers</h2>\n<div class=\"scroll\"><table class=\"figures\"><thead><tr><th>recogniser</th><th>file</th>"
          "<th>bands</th><th class=\"n\">frames<br>answered</th><th class=\"n\">answers</th><th class=\"n\">neither "
          "right<br>nor wrong</th><th class=\"n\">too old</th><th class=\"n\">of no frame</th></tr></thead><tbody>\n",
          page);
    for (int k = 0; k < report->recognisers; k++) {
        const ScoreRecogniser *r = &report->recogniser[k];
        fputs("<tr><td>", page);
        page_key(page, report, k);
        fputs("</td><td>", page);
        page_text(page, r->file[0] ? r->file : "answers.jsonl");
        fputs("</td><td>", page);
        put_bands(page, r->bands);
        fputs("</td>", page);
        page_cell(page, "%.1f %%", 100.0 * (double)r->total.frames_answered / (double)r->total.frames);
        page_cell(page, "%.0f", (double)r->answers);
        page_cell(page, "%.0f", (double)r->ignored);
        page_cell(page, "%.0f", (double)r->aged);
        page_cell(page, "%.0f", (double)r->elsewhere);
        fputs("</tr>\n", page);
    }
    fputs("</tbody></table></div>\n", page);
    for (int k = 0; k < report->recognisers; k++) {
        const ScoreRecogniser *r = &report->recogniser[k];
        if (r->words == 0) continue;
        fputs("<p>", page);
        page_key(page, report, k);
        fputs(" has words that are no class: ", page);
        for (int w = 0; w < r->words; w++) {
            if (w) fputs(", ", page);
            page_text(page, r->word[w].word);
            html_text(page, " (%lld)", r->word[w].count);
        }
        fputs("</p>\n", page);
    }
}

static void put_rules(FILE *page, const ScoreRules *r)
{
    fputs("<h2>How it was scored</h2>\n<dl>", page);
    fputs("<dt>small targets</dt><dd>", page);
    html_text(page, "below %g visible pixels: the answer's centre is in the target's box, grown by %g of its size",
              r->small_px, r->grow);
    fputs("</dd>\n<dt>larger targets</dt><dd>", page);
    html_text(page, "boxes overlap by IoU %g", r->iou);
    fputs("</dd>\n<dt>answers</dt><dd>", page);
    html_text(page, "of score %g and more", r->least_score);
    if (isfinite(r->max_age_ms)) html_text(page, "; at most %g ms old", r->max_age_ms);
    fputs("</dd>\n<dt>frames</dt><dd>", page);
    html_text(page, "%s", r->answered ? "only those answered" : "all; what is in one without an answer is missed");
    fputs("</dd>\n<dt>ignored</dt><dd>", page);
    html_text(page, "targets of less than %d pixels, visible by less than %g, of |SNR| below %g; or as coco.json says",
              r->min_pixels, r->min_visible, r->min_snr);
    fputs("</dd></dl>\n", page);
}

Status score_write_page(const ScoreReport *report, const char *path)
{
    char title[256], name[96];
    if (report->recognisers == 1) {
        text_show(name, sizeof name, report->recogniser[0].name, false);
        snprintf(title, sizeof title, "Score of %s", name);
    } else snprintf(title, sizeof title, "Scores of %d recognisers", report->recognisers);
    FILE *page = html_begin_styled(path, title, rules);
    if (!page) return STATUS_IO;
    put_head(page, report);
    put_numbers(page, report);
    page_plots(page, report);
    page_curves(page, report);
    page_classes(page, report);
    page_tracks(page, report);
    page_errors(page, report);
    page_cases(page, report);
    put_recognisers(page, report);
    put_rules(page, &report->rules);
    return html_end(page, path);
}
