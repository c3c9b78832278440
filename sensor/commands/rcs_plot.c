/* sensor/commands/rcs_plot.c: radar cross section over azimuth as a polar plot: SVG, the nose up. */
#include "sensor/commands/rcs_sweep.h"

#include "sensor/publish/html.h"

enum { width_px = 800, height_px = 640, middle_x = 320, middle_y = 344, radius_px = 252, legend_x = width_px - 206 };

static const char style[] =
    "<style>.pvr text{font:12px system-ui,'DejaVu Sans',sans-serif}.pvr text.h{font-weight:600;font-size:14px}"
    "@media (prefers-color-scheme:dark){.pvr .t,.pvr .h{fill:#ddd}.pvr .d{fill:#999}.pvr .bg{fill:#1b1b1d}"
    ".pvr .g{stroke:#3a3a3e}}</style>";

static const char *const names[2] = {"HH", "VV"}, *const colours[2] = {"#1f77b4", "#d1495b"};

typedef struct Rings {
    double low_dbsm, high_dbsm;
} Rings;

static double complex field_of(const RcsSweep *sweep, int look, int p)
{
    const ScatterMatrix *s = &sweep->s[(size_t)look * (size_t)sweep->config.frequencies];
    return p ? s->vv : s->hh;
}

/* The highest value up to a ten, and 50 dB below it or what there is. */
static Rings rings_of(const RcsSweep *sweep)
{
    double high = -INFINITY;
    for (int look = 0; look < sweep->config.looks; look++)
        for (int p = 0; p < 2; p++)
            if (field_of(sweep, look, p) != 0) high = fmax(high, rcs_dbsm(field_of(sweep, look, p)));
    if (isinf(high)) high = 0;
    high = 10 * ceil(high / 10 + 1e-9);
    return (Rings){high - 60, high};
}

static double radius_of(const Rings *rings, double dbsm)
{
    return radius_px * clamp((dbsm - rings->low_dbsm) / (rings->high_dbsm - rings->low_dbsm), 0, 1);
}

static void draw_grid(FILE *to, const Rings *rings)
{
    for (double dbsm = rings->low_dbsm + 10; dbsm <= rings->high_dbsm; dbsm += 10) {
        const double r = radius_of(rings, dbsm);
        fprintf(to, "<circle class=\"g\" fill=\"none\" stroke=\"#ddd\" cx=\"%d\" cy=\"%d\" r=\"%.1f\"/>"
                    "<text class=\"d\" fill=\"#666\" x=\"%d\" y=\"%.1f\">%g</text>\n",
                middle_x, middle_y, r, middle_x + 3, middle_y - r + 12, dbsm);
    }
    for (int deg = 0; deg < 360; deg += 30) {
        const double x = sin(deg * rad_per_deg), y = -cos(deg * rad_per_deg);
        fprintf(to, "<line class=\"g\" stroke=\"#ddd\" x1=\"%d\" y1=\"%d\" x2=\"%.1f\" y2=\"%.1f\"/>"
                    "<text class=\"t\" fill=\"#222\" text-anchor=\"middle\" x=\"%.1f\" y=\"%.1f\">%d</text>\n",
                middle_x, middle_y, middle_x + radius_px * x, middle_y + radius_px * y, middle_x + (radius_px + 16) * x,
                middle_y + (radius_px + 16) * y + 4, deg);
    }
}

/* A curve, and its row of the legend with the mean over its looks. */
static void draw_curve(FILE *to, const RcsSweep *sweep, const Rings *rings, int p)
{
    double    mean_m2 = 0;
    const int y = 96 + 22 * p;
    fprintf(to, "<polyline fill=\"none\" stroke-width=\"1.2\" stroke-linejoin=\"round\" stroke=\"%s\" points=\"",
            colours[p]);
    for (int look = 0; look < sweep->config.looks; look++) {
        const double complex s = field_of(sweep, look, p);
        const double az = rcs_look_deg(&sweep->config, look) * rad_per_deg;
        const double r = s == 0 ? 0 : radius_of(rings, rcs_dbsm(s));
        fprintf(to, "%s%.1f,%.1f", look ? " " : "", middle_x + r * sin(az), middle_y - r * cos(az));
        mean_m2 += 4 * pi_rad * (creal(s) * creal(s) + cimag(s) * cimag(s)) / sweep->config.looks;
    }
    fprintf(to, "\"/>\n<path fill=\"none\" stroke-width=\"2\" stroke=\"%s\" d=\"M%d %dh22\"/>"
                "<text class=\"t\" fill=\"#222\" x=\"%d\" y=\"%d\">%s, mean %.1f dBsm</text>\n",
            colours[p], legend_x, y, legend_x + 28, y + 4, names[p],
            mean_m2 > 0 ? 10 * log10(mean_m2) : -INFINITY);
}

void rcs_plot(FILE *to, const RcsSweep *sweep)
{
    const RcsConfig *config = &sweep->config;
    const Rings      rings = rings_of(sweep);
    fprintf(to,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"pvr\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
                "role=\"img\">%s<title>", width_px, height_px, width_px, height_px, style);
    html_text(to, "radar cross section of %s", rcs_target_name(sweep));
    fprintf(to, "</title>\n<rect class=\"bg\" fill=\"#fff\" width=\"%d\" height=\"%d\"/>\n"
                "<text class=\"h\" fill=\"#222\" font-weight=\"600\" x=\"14\" y=\"22\">", width_px, height_px);
    html_text(to, "%.60s: radar cross section, dBsm", rcs_target_name(sweep));
    fprintf(to, "</text><text class=\"d\" fill=\"#666\" x=\"14\" y=\"40\">%g GHz, elevation %g deg, ",
            config->frequency_hz[0] * 1e-9,
            config->elevation_deg);
    if (isinf(config->range_m)) fputs("far field; ", to);
    else fprintf(to, "range %g m; ", config->range_m);
    fputs("azimuth clockwise from the nose, deg; ray tubes and edges</text>\n", to);
    draw_grid(to, &rings);
    for (int p = 0; p < 2; p++) draw_curve(to, sweep, &rings, p);
    if (!isnan(sweep->grid_db))
        fprintf(to, "<text class=\"d\" fill=\"#666\" x=\"%d\" y=\"%d\">another grid of tubes: %.0f dB</text>\n",
                legend_x, 144, sweep->grid_db);
    fputs("</svg>\n", to);
}
