/* tests/bench/bench_report.c: the results of a run as one page: failures, the machine, the ratios to the tracer alone,
 * and each suite's table with its plots. */
#include "tests/bench/bench_private.h"

static const char table_style[] =
    "<style>.bar{display:inline-block;height:.7em;background:#1f6fb2;opacity:.6;margin-left:.5em;vertical-align:"
    "baseline}"
    "svg.pvp{max-width:100%;height:auto}nav a{margin-right:1rem}td.w{min-width:16rem}"
    "figure{margin:.5rem 0}section{margin:2rem 0;border-top:1px solid #8884}summary{cursor:pointer}"
    ".scroll{overflow-x:auto}</style>\n";

static const struct {
    const char *name, *reads;
} usual[] = {
    {"precision",
     "Where the program does not compute exactly, it could compute faster and worse, or slower and better. For each "
     "such place: what each setting takes and how wrong it is, against a reference that does not approximate. In "
     "the plots fast is left and close is low; the blue line, the front, joins settings than which no other is "
     "better in time, error or memory without being worse in another (* in tables). The default (ringed) must be "
     "on it, beyond what noise of times explains, and below the dashed line, its stated error."},
    {"stability",
     "Each row is the worst error over inputs that are hard on arithmetic, beside the limit that it must keep."},
    {"skip", "Each row is what leaving out needless work saves; its error is what that changes in the picture, and "
             "must be nothing."},
};

static const char *reads_of(const BenchPart *part)
{
    if (part->reads) return part->reads;
    for (size_t k = 0; k < sizeof usual / sizeof *usual; k++)
        if (strcmp(usual[k].name, part->name) == 0) return usual[k].reads;
    return "Times are of one item, the median and the best of all rounds; an error marked bad is beyond its limit.";
}

static void cell(FILE *page, double value, const char *unit)
{
    char text[32];
    bench_show(text, value, unit);
    fputs("<td class=\"n\">", page);
    html_text(page, "%s", text);
    fputs("</td>", page);
}

static void show_row(FILE *page, const BenchRow *row)
{
    const bool judged = !isnan(row->error_limit), holds = bench_holds(row);
    char       error[32], limit[32];
    fputs("<tr><td class=\"w\">", page);
    html_text(page, "%s", row->what);
    if (row->mark) fputs(" <b>", page), html_text(page, "%s", row->mark), fputs("</b>", page);
    fputs("</td>", page);
    cell(page, row->median, row->unit);
    cell(page, row->best, row->unit);
    cell(page, row->rate, row->rate_unit);
    fputs("<td style=\"white-space:nowrap\">", page);
    if (!isnan(row->ratio)) {
        html_text(page, "%.3g x %s", row->ratio, row->to ? row->to : "");
        if (row->to && strcmp(row->to, "frame") == 0) /* a share of the whole */
            fprintf(page, "<span class=\"bar\" style=\"width:%.1frem\"></span>", 6 * clamp(row->ratio, 0, 1.5));
    }
    bench_show(error, row->error, row->error_unit);
    bench_show(limit, row->error_limit, row->error_unit);
    fprintf(page, "</td><td class=\"n%s\">", judged ? (holds ? " good" : " bad") : "");
    html_text(page, "%s", judged && isnan(row->error) ? "unknown" : error);
    fputs("</td><td class=\"n\">", page);
    html_text(page, "%s", limit);
    fputs("</td><td class=\"dim\">", page);
    html_text(page, "%s", row->against ? row->against : "");
    fputs("</td></tr>\n", page);
}

static void begin_table(FILE *page)
{
    fputs("<div class=\"scroll\"><table><tr><th>what</th><th class=\"n\">median</th><th class=\"n\">best</th><th "
          "class=\"n\">rate</th>"
          "<th>ratio to</th><th class=\"n\">error</th><th class=\"n\">limit</th><th>against</th></tr>\n",
          page);
}

static void end_table(FILE *page) { fputs("</table></div>\n", page); }

/* Failures come first. */
static void show_verdict(FILE *page, const Bench *bench)
{
    int judged = 0, failed = 0;
    for (int i = 0; i < bench->kept_count; i++) judged += !isnan(bench->kept[i].row.error_limit);
    for (int p = 0; p < bench->parts; p++) failed += bench->part[p].failed;
    if (bench->broken == 0 && failed == 0) {
        fprintf(page, "<p class=\"good\">Everything holds: %d errors within their limits, of %d rows.</p>\n", judged,
                bench->rows);
        return;
    }
    fprintf(page, "<p class=\"bad\">%d of %d errors beyond their limit; %d suites did not come to their end.</p>\n",
            bench->broken, judged, failed);
    for (int p = 0; p < bench->parts; p++) {
        const BenchPart *part = &bench->part[p];
        if (!part->failed) continue;
        fputs("<p class=\"bad\">", page);
        html_text(page, "%s did not come to its end; the program said why", part->name);
        fputs("</p>\n", page);
    }
    if (bench->broken == 0) return;
    begin_table(page);
    for (int i = 0; i < bench->kept_count; i++)
        if (!bench_holds(&bench->kept[i].row)) show_row(page, &bench->kept[i].row);
    end_table(page);
}

static void fact(FILE *page, const char *name, const char *value)
{
    fprintf(page, "<tr><th>%s</th><td>", name);
    html_text(page, "%s", value);
    fputs("</td></tr>\n", page);
}

static void show_machine(FILE *page, const Bench *bench, const BenchMachine *m, double took_s)
{
    char text[256];
    fputs("<h2>Machine</h2>\n<table>\n", page);
    snprintf(text, sizeof text, "%s, %d cores, %s, %.1f GB", m->processor, m->cores, m->isa, m->memory_gb);
    fact(page, "processor", text);
    snprintf(text, sizeof text, "%s; governor %s; load before the run %.1f", m->system, m->governor, m->load);
    fact(page, "system", text);
    snprintf(text, sizeof text, "pitviper %s, for x86-64-v3 by %s", PITVIPER_VERSION, m->compiler);
    fact(page, "build", text);
    fact(page, "libraries", m->libraries);
    snprintf(text, sizeof text, "%s rounds, %d threads, %.0f s in all", bench->quick ? "quick" : "full", bench->threads,
             took_s);
    fact(page, "run", text);
    fputs("</table>\n", page);
}

/* The time of a frame relative to the least that its rays take. */
static void show_limit(FILE *page, const Bench *bench)
{
    bool begun = false;
    for (int i = 0; i < bench->kept_count; i++) {
        const BenchRow *row = &bench->kept[i].row;
        if (!row->to || strcmp(row->to, "rays alone") != 0) continue;
        if (!begun) {
            fputs("<h2>Against the tracer alone</h2>\n<p>A frame's time over that of its eye and sun rays alone, in "
                  "turn: 1 would be "
                  "the limit.</p>\n<table><tr><th>frame</th><th class=\"n\">x its rays</th><th></th></tr>\n",
                  page);
            begun = true;
        }
        fputs("<tr><td>", page);
        html_text(page, "%s", row->what);
        fprintf(page,
                "</td><td class=\"n\">%.2f</td><td><span class=\"bar\" style=\"width:%.1frem\"></span></td></tr>\n",
                row->ratio, clamp(row->ratio, 0, 20));
    }
    if (begun) fputs("</table>\n", page);
}

/* ---- tunables ----------------------------------------------------------------------------- */

static const BenchBlock *block_at(const Bench *bench, int row)
{
    for (int k = 0; k < bench->blocks; k++)
        if (bench->block[k].first == row) return &bench->block[k];
    return NULL;
}

static bool blocks_in(const Bench *bench, const BenchPart *part)
{
    for (int k = 0; k < bench->blocks; k++)
        if (bench->block[k].first >= part->first && bench->block[k].first < part->first + part->count) return true;
    return false;
}

/* Shows a line for each unit: its verdict, before any of its settings. */
static void show_overview(FILE *page, const Bench *bench, const BenchPart *part)
{
    bool begun = false;
    for (int k = 0; k < bench->blocks; k++) {
        const BenchBlock *b = &bench->block[k];
        if (b->first < part->first || b->first >= part->first + part->count || b->chosen < 0) continue;
        const BenchRow *row = &bench->kept[b->chosen].row;
        if (!begun)
            fputs("<div class=\"scroll\"><table><tr><th>approximation</th><th>default</th><th class=\"n\">run "
                  "time</th><th>of</th>"
                  "<th class=\"n\">error</th><th class=\"n\">stated at most</th><th>verdict</th></tr>\n",
                  page);
        begun = true;
        fprintf(page, "<tr><td class=\"w\"><a href=\"#tunable-%d\">", k);
        html_text(page, "%s", b->name);
        fputs("</a></td><td>", page);
        html_text(page, "%s", strlen(row->what) > strlen(b->name) + 2 ? row->what + strlen(b->name) + 2 : row->what);
        fputs("</td>", page);
        cell(page, row->median, row->unit);
        fputs("<td class=\"dim\">", page);
        html_text(page, "%s", b->of);
        fputs("</td>", page);
        cell(page, row->error, row->error_unit);
        cell(page, row->error_limit, row->error_unit);
        fprintf(page, "<td class=\"%s\">%s</td></tr>\n", b->broken ? "bad" : "good",
                !b->broken         ? "holds"
                : bench_holds(row) ? "another setting is better"
                                   : "misses its stated error");
    }
    if (begun) end_table(page);
}

/* Shows a plot next to its verdict as text, and its settings. */
static void show_block(FILE *page, const Bench *bench, const BenchBlock *b)
{
    const char *plot = bench->kept[b->first + b->rows - 1].plot;
    fprintf(page, "<section><h3 id=\"tunable-%d\">", (int)(b - bench->block));
    html_text(page, "%s", b->name);
    fprintf(page, "</h3>\n<p class=\"%s\">", b->broken ? "bad" : "good");
    html_text(page, "%s", b->words);
    fputs("</p>\n<p class=\"dim\">", page);
    html_text(page, "Set by %s. Timed: %s.", *b->turned_by ? b->turned_by : "nothing", b->of);
    if (*b->also) html_text(page, " The same settings have another error, %s, and are judged by both.", b->also);
    fputs("</p>\n", page);
    if (plot) fprintf(page, "<figure>%s</figure>\n", plot);
    fputs("<details><summary>its settings in figures</summary>\n", page);
    begin_table(page);
    for (int i = b->first; i < b->first + b->rows; i++) show_row(page, &bench->kept[i].row);
    end_table(page);
    fputs("</details></section>\n", page);
}

static void show_part(FILE *page, const Bench *bench, const BenchPart *part)
{
    fputs("<h2 id=\"", page);
    html_text(page, "%s", part->name);
    fputs("\">", page);
    html_text(page, "%s", part->name);
    fprintf(page, " <span class=\"dim\">%.1f s</span></h2>\n<p>", part->took_s);
    if (!blocks_in(bench, part)) html_text(page, "%s. ", part->help ? part->help : "");
    html_text(page, "%s", reads_of(part));
    fputs("</p>\n", page);
    show_overview(page, bench, part);
    bool open = false;
    for (int i = part->first; i < part->first + part->count;) {
        const BenchBlock *block = block_at(bench, i);
        if (block || !open) {
            if (open) end_table(page);
            open = !block;
            if (open) begin_table(page);
        }
        if (block) show_block(page, bench, block);
        else show_row(page, &bench->kept[i].row);
        i += block ? block->rows : 1;
    }
    if (open) end_table(page);
}

Status bench_report(const Bench *bench, const BenchMachine *machine, const char *path, double took_s)
{
    char title[128];
    snprintf(title, sizeof title, "pitviper bench %.80s", bench->all ? "all" : bench->suite);
    FILE *page = html_begin(path, title);
    if (!page) return STATUS_IO;
    fputs(table_style, page);
    show_verdict(page, bench);
    show_machine(page, bench, machine, took_s);
    if (bench->parts > 1) {
        fputs("<nav><p>", page);
        for (int p = 0; p < bench->parts; p++) {
            fputs("<a href=\"#", page);
            html_text(page, "%s", bench->part[p].name);
            fputs("\">", page);
            html_text(page, "%s", bench->part[p].name);
            fputs("</a>", page);
        }
        fputs("</p></nav>\n", page);
    }
    show_limit(page, bench);
    for (int p = 0; p < bench->parts; p++) show_part(page, bench, &bench->part[p]);
    return html_end(page, path);
}
