/* tests/bench/plot.c: settings of a tunable as a plot: SVG, run time against error, both logarithmic.
 *
 * Labels are placed one after the other where they cover least: other labels, points, lines, the edge. */
#include "tests/bench/bench_private.h"

#include <stdlib.h>

enum {
    width_px = 640,
    height_px = 418,
    left_px = 76,
    right_px = 20,
    top_px = 52,
    bottom_px = 74,
    zero_px = 34,
    points_max = 64,
    ticks_max = 16
};

static const double letter_px = 6.7, line_px = 14, dot_px = 4.5;

static const char style[] =
    "<style>.pvp text{font:12px system-ui,'DejaVu Sans',sans-serif;fill:#222}.pvp .h{font-weight:600;font-size:14px}"
    ".pvp .d{fill:#666}.pvp .bg{fill:#fff}.pvp .g{stroke:#e3e3e3}.pvp .ax{stroke:#777;fill:none}"
    ".pvp .fr{stroke:#1f6fb2;stroke-width:2;fill:none}.pvp .p{fill:#888}.pvp .f{fill:#1f6fb2}"
    ".pvp .df{stroke:#c2570c;stroke-width:2.5;fill:none}.pvp .st{stroke:#c0392b;stroke-dasharray:6 4;fill:none}"
    ".pvp text.s{fill:#c0392b}.pvp text.ok{fill:#217a3c}.pvp .ld{stroke:#999;stroke-width:.8}"
    "@media (prefers-color-scheme:dark){.pvp text{fill:#ddd}.pvp .d{fill:#999}.pvp .bg{fill:#1b1b1d}.pvp "
    ".g{stroke:#333}"
    ".pvp .fr{stroke:#6db3f2}.pvp .f{fill:#6db3f2}.pvp .df{stroke:#f59e4b}.pvp .st{stroke:#ff7b6b}.pvp "
    "text.s{fill:#ff7b6b}"
    ".pvp text.ok{fill:#6fcf8a}}"
    "</style>";

typedef struct Axis {
    double low, high; /* log10 */
    double from_px, to_px;
    int    ticks;
    double tick[ticks_max];
} Axis;

typedef struct Box {
    double x0, y0, x1, y1;
} Box;

typedef struct Plot {
    Axis   time, error;
    double zero_y_px;                 /* where an error of 0 is plotted; NaN: there is none */
    int    points, index[points_max]; /* those that can be plotted */
    double x_px[points_max], y_px[points_max];
    bool   front[points_max];
    double stated_y_px; /* NaN: not plotted */
    int    boxes;
    Box    box[points_max + 4];     /* labels so far */
    int    line[points_max], lines; /* the front's points by time, each better than the previous one */
} Plot;

/* ---- axes ------------------------------------------------------------------------------------- */

static double at_px(const Axis *a, double value)
{
    return a->from_px + (a->to_px - a->from_px) * (log10(value) - a->low) / (a->high - a->low);
}

static void add_tick(Axis *a, double value)
{
    const double l = log10(value);
    if (l >= a->low - 1e-9 && l <= a->high + 1e-9 && a->ticks < ticks_max) a->tick[a->ticks++] = value;
}

/* Whole decades where there are enough of them, else 1-3, 1-2-5, else uniform steps. */
static void choose_ticks(Axis *a)
{
    static const struct {
        int    count;
        double m[3];
    } steps[] = {{1, {1}}, {2, {1, 3}}, {3, {1, 2, 5}}};
    const int decades = (int)ceil(a->high - a->low), every = decades > 8 ? (decades + 7) / 8 : 1;
    for (int s = 0; s < 3; s++) {
        a->ticks = 0;
        for (int d = (int)floor(a->low); d <= (int)ceil(a->high); d++)
            for (int k = 0; k < steps[s].count && d % every == 0; k++) add_tick(a, steps[s].m[k] * pow(10, d));
        if (a->ticks >= 3) return;
    }
    const double low = pow(10, a->low), high = pow(10, a->high), raw = (high - low) / 5,
                 unit = pow(10, floor(log10(raw)));
    const double step = unit * (raw < 1.5 * unit ? 1 : raw < 3.5 * unit ? 2 : raw < 7.5 * unit ? 5 : 10);
    a->ticks = 0;
    for (double v = ceil(low / step) * step; v <= high && a->ticks < ticks_max; v += step) add_tick(a, v);
}

/* From the least to the greatest with a margin, at least a factor of two. */
static Axis axis_of(double least, double most, double from_px, double to_px)
{
    Axis         a = {.low = log10(least), .high = log10(most), .from_px = from_px, .to_px = to_px};
    const double room = fmax(0.08 * (a.high - a.low), 0.5 * (0.3 - (a.high - a.low)));
    a.low -= room;
    a.high += room;
    choose_ticks(&a);
    return a;
}

static void number_text(char out[24], double value)
{
    const double size = fabs(value);
    if (size >= 1e-3 && size < 1e5) {
        snprintf(out, 24, "%.4g", value);
        return;
    }
    const int    exponent = (int)floor(log10(size) + 1e-9);
    const double m = value / pow(10, exponent);
    snprintf(out, 24, fabs(m - round(m)) < 1e-6 ? "%.0fe%d" : "%.2ge%d", m, exponent);
}

/* ---- labels ----------------------------------------------------------------------------------- */

static double letters(const char *text)
{
    double n = 0;
    for (; *text; text++) n += (*text & 0xC0) != 0x80; /* of UTF-8 */
    return n;
}

static double shared(const Box *a, const Box *b)
{
    const double x = fmin(a->x1, b->x1) - fmax(a->x0, b->x0), y = fmin(a->y1, b->y1) - fmax(a->y0, b->y0);
    return x > 0 && y > 0 ? x * y : 0;
}

/* Length of a segment inside the box, px. */
static double crossed(const Box *b, double x0, double y0, double x1, double y1)
{
    int       inside = 0;
    const int steps = 64;
    for (int k = 0; k <= steps; k++) {
        const double s = (double)k / steps, x = x0 + s * (x1 - x0), y = y0 + s * (y1 - y0);
        inside += x > b->x0 && x < b->x1 && y > b->y0 && y < b->y1;
    }
    return hypot(x1 - x0, y1 - y0) * inside / (steps + 1);
}

static double cost_of(const Plot *p, const Box *b)
{
    double       cost = 0;
    const Box    page = {left_px + 2, top_px, width_px - 2, height_px - bottom_px - 2};
    const double area = (b->x1 - b->x0) * (b->y1 - b->y0);
    cost += 20 * (area - shared(b, &page));
    for (int k = 0; k < p->boxes; k++) cost += 10 * shared(b, &p->box[k]);
    for (int k = 0; k < p->points; k++) {
        const double r = dot_px + 3;
        const Box    dot = {p->x_px[k] - r, p->y_px[k] - r, p->x_px[k] + r, p->y_px[k] + r};
        cost += 10 * shared(b, &dot);
    }
    for (int k = 0; k + 1 < p->lines; k++)
        cost +=
            8 * crossed(b, p->x_px[p->line[k]], p->y_px[p->line[k]], p->x_px[p->line[k + 1]], p->y_px[p->line[k + 1]]);
    if (!isnan(p->stated_y_px)) cost += 3 * crossed(b, left_px, p->stated_y_px, width_px - right_px, p->stated_y_px);
    return cost;
}

/* Around a point: nearest first, right before left before above. */
static Box place_label(const Plot *p, int k, double near_px, double wide_px, double *leader)
{
    static const double turn[8][2] = {{1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {-1, -1}, {1, 1}, {-1, 1}};
    Box                 best = {0};
    double              least = INFINITY;
    for (int ring = 0; ring < 5; ring++)
        for (int t = 0; t < 8; t++) {
            const double away = near_px + 14 * ring, slant = turn[t][0] != 0 && turn[t][1] != 0 ? 0.75 : 1;
            const double x = p->x_px[k] + slant * away * turn[t][0], y = p->y_px[k] + slant * away * turn[t][1];
            const double x0 = turn[t][0] > 0 ? x : turn[t][0] < 0 ? x - wide_px : x - 0.5 * wide_px;
            const double y0 = turn[t][1] > 0 ? y : turn[t][1] < 0 ? y - line_px : y - 0.5 * line_px;
            const Box    box = {x0, y0, x0 + wide_px, y0 + line_px};
            const double cost = cost_of(p, &box) + 2 * t + 60 * ring;
            if (cost < least) least = cost, best = box, *leader = ring;
        }
    return best;
}

static void draw_label(FILE *to, Plot *p, int k, const BenchSetting *point, const char *class, bool with_bytes)
{
    char   text[96], memory[24] = "";
    double leader = 0;
    if (with_bytes && point->bytes > 1) {
        number_text(memory, round(point->bytes * 1e-4) * 1e-2);
        if (point->bytes < 1e4) snprintf(memory, sizeof memory, "%.3g", 1e-6 * point->bytes);
    }
    snprintf(text, sizeof text, "%.60s%s%.20s%s", point->setting, *memory ? " (" : "", memory, *memory ? " MB)" : "");
    const Box box = place_label(p, k, point->is_default ? 13 : 9, letter_px * letters(text), &leader);
    p->box[p->boxes++] = box;
    if (leader > 0)
        fprintf(to, "<line class=\"ld\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>", p->x_px[k], p->y_px[k],
                clamp(p->x_px[k], box.x0, box.x1), clamp(p->y_px[k], box.y0 + 3, box.y1 - 2));
    fprintf(to, "<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">", class, box.x0, box.y1 - 3);
    html_text(to, "%s", text);
    fputs("</text>\n", to);
}

/* ---- the plot ------------------------------------------------------------------------------ */

/* The default's median, and for others that times their ratio to it: where rounds are interleaved, a load on the
 * machine does not exchange points. */
static double shown_s(const BenchSetting *point, int count, int index)
{
    for (int i = 0; i < count; i++)
        if (point[i].is_default && i != index && point[i].time.rounds > 0 &&
            point[i].time.rounds == point[index].time.rounds)
            return point[i].time.median_s * bench_ratio(&point[index].time, &point[i].time);
    return point[index].time.median_s;
}

static void lay_out(Plot *p, const BenchTunable *tunable, const BenchSetting *point, int count, double unit_s)
{
    double fast = INFINITY, slow = 0, least = INFINITY, most = 0;
    bool   zero = false;
    *p = (Plot){.zero_y_px = NAN, .stated_y_px = NAN};
    for (int i = 0; i < count && p->points < points_max; i++) {
        const double t = shown_s(point, count, i), e = point[i].error;
        if (!(t > 0 && t < INFINITY && e >= 0 && e < INFINITY)) continue;
        p->index[p->points++] = i;
        fast = fmin(fast, t / unit_s), slow = fmax(slow, t / unit_s);
        zero |= e == 0;
        if (e > 0) least = fmin(least, e), most = fmax(most, e);
    }
    if (p->points == 0) fast = slow = 1;
    const bool stated = tunable->stated > 0 && tunable->stated < INFINITY;
    if (stated) least = fmin(least, tunable->stated), most = fmax(most, tunable->stated);
    if (!(most > 0)) least = most = 1;
    const double floor_px = height_px - bottom_px;
    p->time = axis_of(fast, slow, left_px, width_px - right_px);
    p->error = axis_of(least, most, zero ? floor_px - zero_px : floor_px, top_px);
    if (zero) p->zero_y_px = floor_px - 0.4 * zero_px;
    if (stated) p->stated_y_px = at_px(&p->error, tunable->stated);
    for (int k = 0; k < p->points; k++) {
        const BenchSetting *at = &point[p->index[k]];
        p->x_px[k] = at_px(&p->time, shown_s(point, count, p->index[k]) / unit_s);
        p->y_px[k] = at->error > 0 ? at_px(&p->error, at->error) : p->zero_y_px;
        p->front[k] = bench_on_front(tunable, point, count, p->index[k]);
    }
    for (double after = -1;;) { /* by time, along the front, each lower than the previous one */
        int next = -1;
        for (int k = 0; k < p->points; k++)
            if (p->front[k] && p->x_px[k] > after && (next < 0 || p->x_px[k] < p->x_px[next])) next = k;
        if (next < 0) break;
        after = p->x_px[next];
        if (p->lines == 0 || p->y_px[next] > p->y_px[p->line[p->lines - 1]]) p->line[p->lines++] = next;
    }
}

static void draw_axes(FILE *to, const Plot *p, const BenchTunable *tunable, const char *unit)
{
    const double floor_px = height_px - bottom_px;
    char         text[24];
    for (int k = 0; k < p->time.ticks; k++) {
        const double x = at_px(&p->time, p->time.tick[k]);
        number_text(text, p->time.tick[k]);
        fprintf(
            to,
            "<line class=\"g\" x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%.0f\"/><text text-anchor=\"middle\" x=\"%.1f\" "
            "y=\"%.0f\">%s</text>\n",
            x, top_px, x, floor_px, x, floor_px + 17, text);
    }
    for (int k = 0; k < p->error.ticks; k++) {
        const double y = at_px(&p->error, p->error.tick[k]);
        number_text(text, p->error.tick[k]);
        fprintf(to,
                "<line class=\"g\" x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\"/><text text-anchor=\"end\" x=\"%d\" "
                "y=\"%.1f\">%s</text>\n",
                left_px, y, width_px - right_px, y, left_px - 6, y + 4, text);
    }
    if (!isnan(p->zero_y_px))
        fprintf(to,
                "<line class=\"g\" x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\"/><text text-anchor=\"end\" x=\"%d\" "
                "y=\"%.1f\">0</text>\n",
                left_px, p->zero_y_px, width_px - right_px, p->zero_y_px, left_px - 6, p->zero_y_px + 4);
    fprintf(to, "<path class=\"ax\" d=\"M%d %dV%.0fH%d\"/>\n", left_px, top_px, floor_px, width_px - right_px);
    fprintf(to, "<text text-anchor=\"middle\" x=\"%d\" y=\"%d\">run time, %s: ", (left_px + width_px - right_px) / 2,
            height_px - 34, unit);
    html_text(to, "%.60s", tunable->of ? tunable->of : "");
    fprintf(to, "</text>\n<text text-anchor=\"middle\" transform=\"translate(16 %.0f) rotate(-90)\">error",
            0.5 * (top_px + floor_px));
    if (tunable->error_unit) html_text(to, ", %.30s", tunable->error_unit);
    fputs("</text>\n", to);
}

/* The legend, below the axis; and the verdict on the default, above the plot. */
static void draw_legend(FILE *to, const Plot *p, const BenchSetting *point)
{
    const int y = height_px - 10;
    fprintf(to,
            "<circle class=\"f\" cx=\"%d\" cy=\"%d\" r=\"%.1f\"/><circle class=\"df\" cx=\"%d\" cy=\"%d\" r=\"%.1f\"/>"
            "<text class=\"d\" x=\"%d\" y=\"%d\">default</text>",
            84, y - 4, dot_px, 84, y - 4, dot_px + 4, 98, y);
    fprintf(to,
            "<path class=\"fr\" d=\"M156 %dh28\"/><circle class=\"f\" cx=\"170\" cy=\"%d\" r=\"%.1f\"/>"
            "<text class=\"d\" x=\"190\" y=\"%d\">the front: none is better in all</text>",
            y - 4, y - 4, dot_px, y);
    fprintf(to,
            "<circle class=\"p\" cx=\"398\" cy=\"%d\" r=\"%.1f\"/><text class=\"d\" x=\"408\" y=\"%d\">another is "
            "better</text>",
            y - 4, dot_px, y);
    if (!isnan(p->stated_y_px))
        fprintf(to,
                "<line class=\"st\" x1=\"520\" y1=\"%d\" x2=\"546\" y2=\"%d\"/><text class=\"d\" x=\"552\" "
                "y=\"%d\">stated</text>",
                y - 4, y - 4, y);
    fputs("\n", to);
    for (int k = 0; k < p->points; k++) {
        if (!point[p->index[k]].is_default) continue;
        const bool keeps = isnan(p->stated_y_px) || p->y_px[k] >= p->stated_y_px;
        fprintf(to, "<text class=\"%s\" text-anchor=\"end\" x=\"%d\" y=\"20\">%s</text>\n",
                keeps && p->front[k] ? "ok" : "s", width_px - right_px,
                !keeps        ? "the default misses its stated error"
                : p->front[k] ? "the default holds"
                              : "another setting is better than the default");
    }
}

void plot_tunable(FILE *to, const BenchTunable *tunable, const BenchSetting *point, int count)
{
    static const struct {
        double      s;
        const char *name;
    } units[] = {{1, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}};
    double fast = INFINITY;
    bool   bytes_differ = false;
    int    u = 0;
    Plot   plot, *p = &plot;
    for (int i = 0; i < count; i++) {
        if (point[i].time.median_s > 0) fast = fmin(fast, point[i].time.median_s);
        bytes_differ |= point[i].bytes != point[0].bytes;
    }
    while (u < 3 && fast < units[u].s) u++;
    lay_out(p, tunable, point, count, units[u].s);

    fprintf(to,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"pvp\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
            "role=\"img\">%s<title>",
            width_px, height_px, width_px, height_px, style);
    html_text(to, "%s: run time against error", tunable->name);
    fprintf(to, "</title>\n<rect class=\"bg\" width=\"%d\" height=\"%d\"/>\n<text class=\"h\" x=\"12\" y=\"20\">",
            width_px, height_px);
    html_text(to, "%.70s", tunable->name);
    fputs("</text><text class=\"d\" x=\"12\" y=\"38\">", to);
    if (tunable->turned_by) html_text(to, "%.50s", tunable->turned_by);
    if (tunable->against) html_text(to, "%serror: %.90s", tunable->turned_by ? "; " : "", tunable->against);
    fputs("</text>\n", to);
    draw_axes(to, p, tunable, units[u].name);
    draw_legend(to, p, point);

    if (!isnan(p->stated_y_px)) {
        char text[48], number[24];
        number_text(number, tunable->stated);
        snprintf(text, sizeof text, "stated: %s %.16s", number, tunable->error_unit ? tunable->error_unit : "");
        const double wide = letter_px * letters(text), x = width_px - right_px - wide;
        fprintf(
            to,
            "<line class=\"st\" x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\"/><text class=\"s\" x=\"%.1f\" y=\"%.1f\">",
            left_px, p->stated_y_px, width_px - right_px, p->stated_y_px, x, p->stated_y_px - 4);
        html_text(to, "%s", text);
        fputs("</text>\n", to);
        p->box[p->boxes++] = (Box){x, p->stated_y_px - 15, width_px - right_px, p->stated_y_px - 1};
    }
    fputs("<path class=\"fr\" d=\"", to);
    for (int k = 0; k < p->lines; k++)
        fprintf(to, "%c%.1f %.1f", k ? 'L' : 'M', p->x_px[p->line[k]], p->y_px[p->line[k]]);
    fputs("\"/>\n", to);
    for (int k = 0; k < p->points; k++) {
        const BenchSetting *at = &point[p->index[k]];
        if (at->is_default)
            fprintf(to, "<circle class=\"df\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>", p->x_px[k], p->y_px[k],
                    dot_px + 4);
        fprintf(to, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>\n", p->front[k] ? "f" : "p", p->x_px[k],
                p->y_px[k], dot_px);
    }
    for (int k = 0; k < p->points; k++) draw_label(to, p, k, &point[p->index[k]], p->front[k] ? "" : "d", bytes_differ);
    if (p->points < count)
        fprintf(
            to,
            "<text class=\"d\" text-anchor=\"end\" x=\"%d\" y=\"48\">%d without a time or an error not shown</text>\n",
            width_px - right_px, count - p->points);
    fputs("</svg>\n", to);
}
