/* tests/bench/plot.c: settings of a tunable as a plot: SVG, run time against error, both logarithmic.
 *
 * Labels are placed one after the other where they cover least: other labels, points, lines, the edge. */
#include "tests/bench/bench_private.h"

#include "sensor/publish/files/svg_plot.h"

#include <stdlib.h>

enum { width_px = 640, height_px = 418, zero_px = 34, points_max = 64 };

static const SvgBox frame = {.left = 76, .right = width_px - 20, .top = 52, .bottom = height_px - 74};
static const SvgPen front_pen = {SVG_BLUE, 2, NULL}, default_pen = {SVG_AMBER, 2.5, NULL},
                    stated_pen = {SVG_RED, 1, "6 4"}, leader_pen = {SVG_GREY, 0.8, NULL}, on_pen = {.colour = SVG_BLUE},
                    off_pen = {.colour = SVG_GREY};
static const double letter_px = 6.7, line_px = 14, dot_px = 4.5;

typedef struct Box {
    double x0, y0, x1, y1;
} Box;

typedef struct Plot {
    SvgAxis time, error;
    double  zero_y_px;                 /* where an error of 0 is plotted; NaN: there is none */
    int     points, index[points_max]; /* those that can be plotted */
    double  x_px[points_max], y_px[points_max];
    bool    front[points_max];
    double  stated_y_px; /* NaN: not plotted */
    int     boxes;
    Box     box[points_max + 4];     /* labels so far */
    int     line[points_max], lines; /* the front's points by time, each better than the previous one */
} Plot;

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
    const Box    page = {frame.left + 2, frame.top, width_px - 2, frame.bottom - 2};
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
    if (!isnan(p->stated_y_px)) cost += 3 * crossed(b, frame.left, p->stated_y_px, frame.right, p->stated_y_px);
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

static void draw_label(FILE *to, Plot *p, int k, const BenchSetting *point, bool with_bytes)
{
    char   text[96], memory[24] = "";
    double leader = 0;
    if (with_bytes && point->bytes > 1) {
        svg_number(memory, round(point->bytes * 1e-4) * 1e-2);
        if (point->bytes < 1e4) snprintf(memory, sizeof memory, "%.3g", 1e-6 * point->bytes);
    }
    snprintf(text, sizeof text, "%.60s%s%.20s%s", point->setting, *memory ? " (" : "", memory, *memory ? " MB)" : "");
    const Box box = place_label(p, k, point->is_default ? 13 : 9, letter_px * letters(text), &leader);
    p->box[p->boxes++] = box;
    if (leader > 0)
        svg_line(to, &leader_pen, p->x_px[k], p->y_px[k], clamp(p->x_px[k], box.x0, box.x1),
                 clamp(p->y_px[k], box.y0 + 3, box.y1 - 2));
    svg_text(to, p->front[k] ? SVG_INK : SVG_DIM, SVG_LEFT, box.x0, box.y1 - 3, "%s", text);
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
    p->time = svg_log_axis(fast, slow, frame.left, frame.right);
    p->error = svg_log_axis(least, most, zero ? frame.bottom - zero_px : frame.bottom, frame.top);
    if (zero) p->zero_y_px = frame.bottom - 0.4 * zero_px;
    if (stated) p->stated_y_px = svg_at(&p->error, tunable->stated);
    for (int k = 0; k < p->points; k++) {
        const BenchSetting *at = &point[p->index[k]];
        p->x_px[k] = svg_at(&p->time, shown_s(point, count, p->index[k]) / unit_s);
        p->y_px[k] = at->error > 0 ? svg_at(&p->error, at->error) : p->zero_y_px;
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

/* The legend, below the axis; and the verdict on the default, above the plot. */
static void draw_legend(FILE *to, const Plot *p, const BenchSetting *point)
{
    const int y = height_px - 14;
    svg_circle(to, &on_pen, 84, y, dot_px);
    svg_circle(to, &default_pen, 84, y, dot_px + 4);
    svg_text(to, SVG_INK, SVG_LEFT, 98, y + 4, "default");
    svg_legend(to, &front_pen, 160, y, "the front: none is better in all");
    svg_circle(to, &on_pen, 171, y, dot_px);
    svg_circle(to, &off_pen, 398, y, dot_px);
    svg_text(to, SVG_INK, SVG_LEFT, 408, y + 4, "another is better");
    if (!isnan(p->stated_y_px)) svg_legend(to, &stated_pen, 524, y, "stated");
    for (int k = 0; k < p->points; k++) {
        if (!point[p->index[k]].is_default) continue;
        const bool keeps = isnan(p->stated_y_px) || p->y_px[k] >= p->stated_y_px;
        svg_text(to, keeps && p->front[k] ? SVG_GREEN : SVG_RED, SVG_RIGHT, frame.right, 20, "%s",
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

    char below[192], time[96], error[48];
    snprintf(below, sizeof below, "%.50s%s%s%.90s", tunable->turned_by ? tunable->turned_by : "",
             tunable->turned_by && tunable->against ? "; " : "", tunable->against ? "error: " : "",
             tunable->against ? tunable->against : "");
    snprintf(time, sizeof time, "run time, %s: %.60s", units[u].name, tunable->of ? tunable->of : "");
    snprintf(error, sizeof error, "error%s%.30s", tunable->error_unit ? ", " : "",
             tunable->error_unit ? tunable->error_unit : "");
    svg_begin(to, width_px, height_px, tunable->name, "", below);
    if (!isnan(p->zero_y_px)) svg_tick_y(to, &frame, p->zero_y_px, "0");
    svg_axes(to, &frame, &p->time, time, &p->error, error);
    draw_legend(to, p, point);

    if (!isnan(p->stated_y_px)) {
        char text[48], number[24];
        svg_number(number, tunable->stated);
        snprintf(text, sizeof text, "stated: %s %.16s", number, tunable->error_unit ? tunable->error_unit : "");
        const double y = p->stated_y_px, x = frame.right - letter_px * letters(text);
        svg_line(to, &stated_pen, frame.left, y, frame.right, y);
        svg_text(to, SVG_RED, SVG_LEFT, x, y - 4, "%s", text);
        p->box[p->boxes++] = (Box){x, y - 15, frame.right, y - 1};
    }
    svg_curve_begin(to, &front_pen);
    for (int k = 0; k < p->lines; k++) svg_curve_point(to, p->x_px[p->line[k]], p->y_px[p->line[k]]);
    svg_curve_end(to);
    for (int k = 0; k < p->points; k++) {
        if (point[p->index[k]].is_default) svg_circle(to, &default_pen, p->x_px[k], p->y_px[k], dot_px + 4);
        svg_circle(to, p->front[k] ? &on_pen : &off_pen, p->x_px[k], p->y_px[k], dot_px);
    }
    for (int k = 0; k < p->points; k++) draw_label(to, p, k, &point[p->index[k]], bytes_differ);
    if (p->points < count)
        svg_text(to, SVG_DIM, SVG_RIGHT, frame.right, 48, "%d without a time or an error not shown", count - p->points);
    svg_end(to);
}
