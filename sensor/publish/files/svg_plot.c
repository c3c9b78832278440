/* sensor/publish/files/svg_plot.c: plots as SVG: one style, and what linear, logarithmic and polar plots are of. */
#include "sensor/publish/files/svg_plot.h"

#include "sensor/publish/files/html_page.h"

#include <stdarg.h>

static const struct {
    const char *class, *light, *dark;
} colours[] = {{"t", SVG_INK, "#ddd"},       {"d", SVG_DIM, "#999"},    {"g", SVG_GRID, "#3a3a3e"},
               {"ax", SVG_AXIS, "#777"},     {"p", SVG_GREY, "#888"},   {"f", SVG_BLUE, "#6db3f2"},
               {"df", SVG_AMBER, "#f59e4b"}, {"s", SVG_RED, "#ff7b6b"}, {"ok", SVG_GREEN, "#6fcf8a"},
               {"pl", SVG_PLUM, "#c79be6"}};

enum { colour_count = sizeof colours / sizeof *colours };

static const SvgPen grid_pen = {SVG_GRID, 1, NULL}, axis_pen = {SVG_AXIS, 1, NULL};

static void open_element(FILE *to, const char *element, const SvgPen *pen)
{
    fprintf(to, "<%s", element);
    for (int k = 0; k < colour_count; k++)
        if (strcmp(colours[k].light, pen->colour) == 0) fprintf(to, " class=\"%s\"", colours[k].class);
    fprintf(to, pen->width_px > 0 ? " fill=\"none\" stroke=\"%s\" stroke-width=\"%g\"" : " fill=\"%s\"", pen->colour,
            pen->width_px);
    if (pen->dashes) fprintf(to, " stroke-dasharray=\"%s\"", pen->dashes);
}

static void put_text(FILE *to, const char *colour, SvgAlign align, double x, double y, const char *more,
                     const char *text)
{
    static const char *const anchors[] = {"", " text-anchor=\"middle\"", " text-anchor=\"end\""};
    open_element(to, "text", &(SvgPen){.colour = colour});
    fprintf(to, "%s x=\"%.1f\" y=\"%.1f\"%s>", anchors[align], x, y, more);
    html_text(to, "%s", text);
    fputs("</text>\n", to);
}

void svg_begin(FILE *to, int width_px, int height_px, const char *name, const char *about, const char *below)
{
    char heading[160];
    snprintf(heading, sizeof heading, "%.70s%.60s", name, about);
    fprintf(to,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"pvp\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
            "role=\"img\"><style>.pvp text{font:12px system-ui,'DejaVu Sans',sans-serif}"
            "@media (prefers-color-scheme:dark){.pvp .bg{fill:#1b1b1d}",
            width_px, height_px, width_px, height_px);
    for (int k = 0; k < colour_count; k++)
        fprintf(to, ".pvp .%s{fill:%s}.pvp .%s[stroke]{fill:none;stroke:%s}", colours[k].class, colours[k].dark,
                colours[k].class, colours[k].dark);
    fputs("}</style><title>", to);
    html_text(to, "%s", heading);
    fprintf(to, "</title>\n<rect class=\"bg\" fill=\"#fff\" width=\"%d\" height=\"%d\"/>\n", width_px, height_px);
    put_text(to, SVG_INK, SVG_LEFT, 14, 20, " style=\"font-weight:600;font-size:14px\"", heading);
    put_text(to, SVG_DIM, SVG_LEFT, 14, 38, "", below);
}

void svg_end(FILE *to) { fputs("</svg>\n", to); }

void svg_text(FILE *to, const char *colour, SvgAlign align, double x, double y, const char *format, ...)
{
    char    text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    put_text(to, colour, align, x, y, "", text);
}

void svg_line(FILE *to, const SvgPen *pen, double x0, double y0, double x1, double y1)
{
    open_element(to, "line", pen);
    fprintf(to, " x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>", x0, y0, x1, y1);
}

void svg_circle(FILE *to, const SvgPen *pen, double x, double y, double radius_px)
{
    open_element(to, "circle", pen);
    fprintf(to, " cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>", x, y, radius_px);
}

void svg_curve_begin(FILE *to, const SvgPen *pen)
{
    open_element(to, "polyline", pen);
    fputs(" stroke-linejoin=\"round\" points=\"", to);
}

void svg_area_begin(FILE *to, const char *colour, double share)
{
    open_element(to, "polygon", &(SvgPen){.colour = colour});
    fprintf(to, " fill-opacity=\"%g\" points=\"", share);
}

void svg_curve_point(FILE *to, double x, double y) { fprintf(to, " %.1f,%.1f", x, y); }
void svg_curve_end(FILE *to) { fputs("\"/>\n", to); }

void svg_legend(FILE *to, const SvgPen *pen, double x, double y, const char *text)
{
    svg_line(to, pen, x, y, x + 22, y);
    put_text(to, SVG_INK, SVG_LEFT, x + 28, y + 4, "", text);
}

/* ---- axes ------------------------------------------------------------------------------------- */

double svg_at(const SvgAxis *a, double value)
{
    return a->from_px +
           (a->to_px - a->from_px) * ((a->scale == SVG_LOG ? log10(value) : value) - a->low) / (a->high - a->low);
}

SvgAxis svg_linear_axis(double low, double high, double from_px, double to_px)
{
    static const double steps[] = {1, 2, 5, 10, 20, 50, 100, 200, 500};
    size_t              s = 0;
    while (s + 1 < sizeof steps / sizeof *steps && (high - low) / steps[s] > 9) s++;
    SvgAxis a = {.low = floor(low / steps[s]) * steps[s], .from_px = from_px, .to_px = to_px};
    a.high = (floor(high / steps[s]) + 1) * steps[s];
    for (double v = a.low; v <= a.high && a.ticks < svg_ticks_max; v += steps[s]) a.tick[a.ticks++] = v;
    return a;
}

static void add_tick(SvgAxis *a, double value)
{
    const double l = log10(value);
    if (l >= a->low - 1e-9 && l <= a->high + 1e-9 && a->ticks < svg_ticks_max) a->tick[a->ticks++] = value;
}

/* Ticks: whole decades where there are enough of them, else 1-3, 1-2-5, else uniform steps. */
SvgAxis svg_log_axis(double low, double high, double from_px, double to_px)
{
    static const double steps[3][3] = {{1}, {1, 3}, {1, 2, 5}};
    SvgAxis             a = {SVG_LOG, log10(low), log10(high), from_px, to_px, 0, {0}};
    const double        room = fmax(0.08 * (a.high - a.low), 0.5 * (0.3 - (a.high - a.low)));
    a.low -= room, a.high += room;
    const int decades = (int)ceil(a.high - a.low), every = decades > 8 ? (decades + 7) / 8 : 1;
    for (int s = 0; s < 3; s++) {
        a.ticks = 0;
        for (int d = (int)floor(a.low); d <= (int)ceil(a.high); d++)
            for (int k = 0; k <= s && d % every == 0; k++) add_tick(&a, steps[s][k] * pow(10, d));
        if (a.ticks >= 3) return a;
    }
    const double least = pow(10, a.low), most = pow(10, a.high), raw = (most - least) / 5,
                 unit = pow(10, floor(log10(raw)));
    const double step = unit * (raw < 1.5 * unit ? 1 : raw < 3.5 * unit ? 2 : raw < 7.5 * unit ? 5 : 10);
    a.ticks = 0;
    for (double v = ceil(least / step) * step; v <= most && a.ticks < svg_ticks_max; v += step) add_tick(&a, v);
    return a;
}

void svg_number(char out[24], double value)
{
    const int    exponent = value == 0 ? 0 : (int)floor(log10(fabs(value)) + 1e-9);
    const double m = value / pow(10, exponent);
    if (exponent >= -3 && exponent < 5) snprintf(out, 24, "%.4g", value);
    else snprintf(out, 24, fabs(m - round(m)) < 1e-6 ? "%.0fe%d" : "%.2ge%d", m, exponent);
}

void svg_tick_y(FILE *to, const SvgBox *box, double y, const char *label)
{
    svg_line(to, &grid_pen, box->left, y, box->right, y);
    svg_text(to, SVG_INK, SVG_RIGHT, box->left - 7, y + 4, "%s", label);
}

void svg_axes(FILE *to, const SvgBox *box, const SvgAxis *x, const char *x_name, const SvgAxis *y, const char *y_name)
{
    char text[64];
    for (int k = 0; k < x->ticks; k++) {
        const double at = svg_at(x, x->tick[k]);
        if (x->scale == SVG_HOURS) snprintf(text, sizeof text, "%02.0f:00", x->tick[k]);
        else svg_number(text, x->tick[k]);
        svg_line(to, &grid_pen, at, box->top, at, box->bottom);
        svg_text(to, SVG_INK, SVG_MIDDLE, at, box->bottom + 17, "%s", text);
    }
    for (int k = 0; k < y->ticks; k++) {
        svg_number(text, y->tick[k]);
        svg_tick_y(to, box, svg_at(y, y->tick[k]), text);
    }
    open_element(to, "path", &axis_pen);
    fprintf(to, " d=\"M%d %dV%dH%d\"/>\n", box->left, box->top, box->bottom, box->right);
    svg_text(to, SVG_INK, SVG_MIDDLE, 0.5 * (box->left + box->right), box->bottom + 38, "%s", x_name);
    snprintf(text, sizeof text, " transform=\"translate(16 %.0f) rotate(-90)\"", 0.5 * (box->top + box->bottom));
    put_text(to, SVG_INK, SVG_MIDDLE, 0, 0, text, y_name);
}

void svg_polar_grid(FILE *to, double middle_x, double middle_y, const SvgAxis *radius)
{
    for (int k = 0; k < radius->ticks; k++) {
        const double r = svg_at(radius, radius->tick[k]);
        svg_circle(to, &grid_pen, middle_x, middle_y, r);
        svg_text(to, SVG_DIM, SVG_LEFT, middle_x + 3, middle_y - r + 12, "%g", radius->tick[k]);
    }
    for (int deg = 0; deg < 360; deg += 30) {
        const double x = sin(deg * rad_per_deg), y = -cos(deg * rad_per_deg), r = radius->to_px;
        svg_line(to, &grid_pen, middle_x, middle_y, middle_x + r * x, middle_y + r * y);
        svg_text(to, SVG_INK, SVG_MIDDLE, middle_x + (r + 16) * x, middle_y + (r + 16) * y + 4, "%d", deg);
    }
}
