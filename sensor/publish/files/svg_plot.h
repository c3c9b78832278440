/* sensor/publish/files/svg_plot.h: plots as SVG, for light and dark: head, text, axes, curves, points, legend rows. */
#ifndef SENSOR_PUBLISH_FILES_SVG_PLOT_H
#define SENSOR_PUBLISH_FILES_SVG_PLOT_H

#include "pitviper.h"

/* Colours by their light value, "#rrggbb". These turn lighter or darker where the viewer's page is dark; others stay.
 * Each is an attribute, too, for viewers without style sheets. */
#define SVG_INK   "#222"
#define SVG_DIM   "#666"
#define SVG_GRID  "#ddd"
#define SVG_AXIS  "#777"
#define SVG_GREY  "#888"
#define SVG_BLUE  "#1f6fb2"
#define SVG_AMBER "#c2570c"
#define SVG_RED   "#c0392b"
#define SVG_GREEN "#217a3c"
#define SVG_PLUM  "#8e44ad"

typedef struct SvgPen {
    const char *colour;
    double      width_px; /* 0: filled */
    const char *dashes;   /* as stroke-dasharray; NULL: none */
} SvgPen;

typedef enum SvgAlign { SVG_LEFT, SVG_MIDDLE, SVG_RIGHT } SvgAlign;

enum { svg_ticks_max = 16 };

typedef struct SvgAxis {
    enum { SVG_LINEAR, SVG_LOG, SVG_HOURS } scale;
    double low, high; /* log10 of the values on SVG_LOG */
    double from_px, to_px;
    int    ticks;
    double tick[svg_ticks_max];
} SvgAxis;

typedef struct SvgBox {
    int left, right, top, bottom;
} SvgBox;

/* Whole steps of 1, 2 or 5, at most ten, that hold low .. high. */
SvgAxis svg_linear_axis(double low, double high, double from_px, double to_px);
/* From low to high with a margin, at least a factor of two. */
SvgAxis svg_log_axis(double low, double high, double from_px, double to_px);
double  svg_at(const SvgAxis *axis, double value);
void    svg_number(char out[24], double value);

/* Heading and title are name, in 70 bytes, and about. All texts are plain: they are escaped. */
void svg_begin(FILE *to, int width_px, int height_px, const char *name, const char *about, const char *below);
void svg_end(FILE *to);
__attribute__((format(printf, 6, 7))) void svg_text(FILE *to, const char *colour, SvgAlign align, double x, double y,
                                                    const char *format, ...);
void svg_line(FILE *to, const SvgPen *pen, double x0, double y0, double x1, double y1);
void svg_circle(FILE *to, const SvgPen *pen, double x, double y, double radius_px);
void svg_curve_begin(FILE *to, const SvgPen *pen);
/* A filled area, of this share of its colour; points and end as of a curve. */
void svg_area_begin(FILE *to, const char *colour, double share);
void svg_curve_point(FILE *to, double x, double y);
void svg_curve_end(FILE *to);
/* A row of the legend: a stroke from x, its middle at y, and its text. */
void svg_legend(FILE *to, const SvgPen *pen, double x, double y, const char *text);

/* A grid line with its label. */
void svg_tick_y(FILE *to, const SvgBox *box, double y, const char *label);
/* Ticks, axes and their names. */
void svg_axes(FILE *to, const SvgBox *box, const SvgAxis *x, const char *x_name, const SvgAxis *y, const char *y_name);
/* Rings at the ticks of radius, px from the middle, and a spoke each 30 deg, clockwise from above. */
void svg_polar_grid(FILE *to, double middle_x, double middle_y, const SvgAxis *radius);

#endif
