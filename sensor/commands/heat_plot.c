/* sensor/commands/heat_plot.c: a vehicle's day as a plot: SVG, temperatures of its parts, air, ground, by the hour. */
#include "sensor/commands/heat_day.h"

#include "sensor/publish/html.h"

enum { width_px = 900, height_px = 470, left_px = 58, right_px = 650, top_px = 74, bottom_px = 416, most_parts = 10 };

static const char style[] =
    "<style>.pvh text{font:12px system-ui,'DejaVu Sans',sans-serif}.pvh text.h{font-weight:600;font-size:14px}"
    "@media (prefers-color-scheme:dark){.pvh .t,.pvh .h{fill:#ddd}.pvh .d{fill:#999}.pvh .bg{fill:#1b1b1d}"
    ".pvh .g{stroke:#3a3a3e}}</style>";

typedef struct Curve {
    const char *name, *colour;
    bool        dashed;
    double      area_m2, low_k, high_k, k[heat_day_rows];
} Curve;

typedef struct Scale {
    double low_k, high_k, step_k;
} Scale;

static double x_of(double hour) { return left_px + (right_px - left_px) * hour / 24; }

static double y_of(const Scale *s, double k)
{
    return bottom_px - (bottom_px - top_px) * (k - s->low_k) / (s->high_k - s->low_k);
}

static void find_range(Curve *c)
{
    c->low_k = INFINITY, c->high_k = -INFINITY;
    for (int r = 0; r < heat_day_rows; r++) c->low_k = fmin(c->low_k, c->k[r]), c->high_k = fmax(c->high_k, c->k[r]);
}

/* Mean by area of all patches of parts of this name. */
static void part_curve(Curve *out, const HeatDay *day, const char *part)
{
    *out = (Curve){.name = part};
    for (int i = 0; i < day->patches; i++) {
        if (strcmp(day->part[i], part) != 0) continue;
        out->area_m2 += day->area_m2[i];
        for (int r = 0; r < heat_day_rows; r++)
            out->k[r] += day->area_m2[i] * (double)day->patch_k[(size_t)r * (size_t)day->patches + (size_t)i];
    }
    for (int r = 0; r < heat_day_rows; r++) out->k[r] /= out->area_m2;
    find_range(out);
}

/* Those of the largest area, largest first. */
static int part_curves(Curve out[most_parts], const HeatDay *day)
{
    int count = 0;
    for (int i = 0; i < day->patches; i++) {
        bool known = false;
        for (int k = 0; k < i; k++) known |= strcmp(day->part[k], day->part[i]) == 0;
        if (known) continue;
        Curve curve;
        part_curve(&curve, day, day->part[i]);
        int at = count;
        while (at > 0 && out[at - 1].area_m2 < curve.area_m2) at--;
        if (at == most_parts) continue;
        count += count < most_parts;
        for (int k = count - 1; k > at; k--) out[k] = out[k - 1];
        out[at] = curve;
    }
    return count;
}

static Scale scale_of(const Curve *curve, int count)
{
    static const double steps[] = {1, 2, 5, 10, 20, 50, 100, 200, 500};
    double low_k = INFINITY, high_k = -INFINITY;
    size_t s = 0;
    for (int i = 0; i < count; i++) low_k = fmin(low_k, curve[i].low_k), high_k = fmax(high_k, curve[i].high_k);
    while (s + 1 < sizeof steps / sizeof *steps && (high_k - low_k) / steps[s] > 9) s++;
    return (Scale){floor(low_k / steps[s]) * steps[s], (floor(high_k / steps[s]) + 1) * steps[s], steps[s]};
}

static void draw_axes(FILE *to, const Scale *s)
{
    const int ticks = (int)lround((s->high_k - s->low_k) / s->step_k);
    for (int i = 0; i <= ticks; i++) {
        const double k = s->low_k + i * s->step_k, y = y_of(s, k);
        fprintf(to, "<line class=\"g\" stroke=\"#ddd\" x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\"/>"
                    "<text class=\"t\" fill=\"#222\" text-anchor=\"end\" x=\"%d\" y=\"%.1f\">%g</text>\n",
                left_px, y, right_px, y, left_px - 7, y + 4, k);
    }
    for (int hour = 0; hour <= 24; hour += 3)
        fprintf(to, "<line class=\"g\" stroke=\"#ddd\" x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\"/>"
                    "<text class=\"t\" fill=\"#222\" text-anchor=\"middle\" x=\"%.1f\" y=\"%d\">%02d:00</text>\n",
                x_of(hour), top_px, x_of(hour), bottom_px, x_of(hour), bottom_px + 17, hour);
    fprintf(to, "<path fill=\"none\" stroke=\"#777\" d=\"M%d %dV%dH%d\"/>\n", left_px, top_px, bottom_px, right_px);
    fprintf(to, "<text class=\"t\" fill=\"#222\" text-anchor=\"middle\" x=\"%d\" y=\"%d\">"
                "local mean solar time, h</text>\n",
            (left_px + right_px) / 2, bottom_px + 38);
    fprintf(to, "<text class=\"t\" fill=\"#222\" text-anchor=\"middle\" transform=\"translate(16 %d) rotate(-90)\">"
                "temperature, K</text>\n", (top_px + bottom_px) / 2);
}

/* A curve, and its row of the legend. */
static void draw_curve(FILE *to, const Curve *c, const Scale *s, int row)
{
    const char  *dashes = c->dashed ? " stroke-dasharray=\"6 4\"" : "";
    const double y = top_px + 22 * row + 20;
    fprintf(to, "<polyline fill=\"none\" stroke-width=\"2\" stroke-linejoin=\"round\"%s stroke=\"%s\" points=\"",
        dashes, c->colour);
    for (int r = 0; r < heat_day_rows; r++)
        fprintf(to, "%s%.1f,%.1f", r ? " " : "", x_of(r * heat_day_row_s / 3600.0), y_of(s, c->k[r]));
    fprintf(to, "\"/>\n<path fill=\"none\" stroke-width=\"2\"%s stroke=\"%s\" d=\"M%d %.0fh22\"/>", dashes, c->colour,
        right_px + 18, y);
    fprintf(to, "<text class=\"t\" fill=\"#222\" x=\"%d\" y=\"%.0f\">", right_px + 46, y + 4);
    html_text(to, "%.20s", c->name);
    fprintf(to, "</text><text class=\"d\" fill=\"#666\" text-anchor=\"end\" x=\"%d\" y=\"%.0f\">"
                "%.1f &#8211; %.1f</text>\n",
            width_px - 12, y + 4, c->low_k, c->high_k);
}

/* When the vehicle is as warm as the ground. */
static void draw_crossings(FILE *to, const HeatDay *day, int row)
{
    bool raised = false;
    for (int i = 0; i < day->crossings; i++) {
        const double x = x_of(day->crossing_h[i]);
        const int    minutes = (int)(60 * day->crossing_h[i] + 0.5);
        const bool   close = i > 0 && x - x_of(day->crossing_h[i - 1]) < 36;
        raised = close && !raised; /* so that its label stands clear of the one before */
        fprintf(to, "<line stroke=\"#c0392b\" stroke-dasharray=\"2 3\" x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\"/>"
                    "<text fill=\"#c0392b\" text-anchor=\"middle\" x=\"%.1f\" y=\"%d\">%02d:%02d</text>\n",
                x, top_px, x, bottom_px, x, top_px - (raised ? 17 : 5), minutes / 60, minutes % 60);
    }
    if (day->crossings == 0) return;
    const int y = top_px + 22 * row + 20;
    fprintf(to, "<line stroke=\"#c0392b\" stroke-dasharray=\"2 3\" x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\"/>"
                "<text class=\"t\" fill=\"#222\" x=\"%d\" y=\"%d\">contrast crossover</text>\n",
            right_px + 18, y, right_px + 40, y, right_px + 46, y + 4);
}

void heat_day_plot(FILE *to, const HeatDay *day, const char *about)
{
    static const char *const colours[most_parts] = {"#1f77b4", "#e0a100", "#2ca02c", "#d1495b", "#6a4c93",
                                                    "#17a2a2", "#a0522d", "#e377c2", "#7f7f7f", "#8bc34a"};
    static Curve curve[most_parts + 2];
    int          count = part_curves(curve, day);
    for (int i = 0; i < count; i++) curve[i].colour = colours[i];
    Curve *air = &curve[count++], *ground = &curve[count++];
    *air    = (Curve){.name = "air", .colour = "#5b8db8", .dashed = true};
    *ground = (Curve){.name = "ground", .colour = "#5a7d3a", .dashed = true};
    for (int r = 0; r < heat_day_rows; r++) air->k[r] = day->row[r].air_k, ground->k[r] = day->row[r].ground_k;
    find_range(air);
    find_range(ground);
    const Scale s = scale_of(curve, count);

    fprintf(to, "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"pvh\" width=\"%d\" height=\"%d\" "
                "viewBox=\"0 0 %d %d\" role=\"img\">%s<title>", width_px, height_px, width_px, height_px, style);
    html_text(to, "temperatures of %s over a day", day->model);
    fprintf(to, "</title>\n<rect class=\"bg\" fill=\"#fff\" width=\"%d\" height=\"%d\"/>\n"
                "<text class=\"h\" fill=\"#222\" font-weight=\"600\" x=\"14\" y=\"20\">", width_px, height_px);
    html_text(to, "%.60s: temperatures of its parts, means by area", day->model);
    fputs("</text><text class=\"d\" fill=\"#666\" x=\"14\" y=\"38\">", to);
    html_text(to, "%s", about);
    fputs("</text>\n", to);
    draw_axes(to, &s);
    for (int i = 0; i < count; i++) draw_curve(to, &curve[i], &s, i);
    draw_crossings(to, day, count);
    fprintf(to, "<text class=\"d\" fill=\"#666\" text-anchor=\"end\" x=\"%d\" y=\"%d\">"
                "coldest &#8211; warmest, K</text>\n</svg>\n",
            width_px - 12, top_px + 2);
}
