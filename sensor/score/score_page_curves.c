/* sensor/score/score_page_curves.c: precision and recall, false alarms, and errors of centroids as plots. */
#include "sensor/score/score_page_private.h"

enum { width_px = 560, height_px = 330 };

static const SvgBox box = {.left = 62, .right = 538, .top = 52, .bottom = 272};

static SvgAxis share_axis(double from_px, double to_px)
{
    return (SvgAxis){
        .low = 0, .high = 1, .from_px = from_px, .to_px = to_px, .ticks = 6, .tick = {0, 0.2, 0.4, 0.6, 0.8, 1}};
}

static SvgPen pen_of(int k) { return (SvgPen){page_colour[k], 2, page_dashes[k]}; }

/* Where the rates of the report are on a curve. */
static void put_mark(FILE *page, int k, double x_px, double y_px)
{
    if (isfinite(x_px) && isfinite(y_px)) svg_circle(page, &(SvgPen){.colour = page_colour[k]}, x_px, y_px, 5);
}

static void put_precision(FILE *page, const ScoreReport *report)
{
    const SvgAxis x = share_axis(box.left, box.right), y = share_axis(box.bottom, box.top);
    fputs("<figure>", page);
    svg_begin(page, width_px, height_px, "Precision and recall", "", "");
    svg_axes(page, &box, &x, "recall: share of targets found", &y, "precision: share of answers right");
    for (int k = 0; k < report->recognisers; k++) {
        const ScoreRecogniser *r = &report->recogniser[k];
        const SvgPen           pen = pen_of(k);
        svg_curve_begin(page, &pen);
        for (int i = 0; i < r->points; i++)
            svg_curve_point(page, svg_at(&x, r->curve[i].recall), svg_at(&y, r->curve[i].precision));
        svg_curve_end(page);
        const double answers = (double)(r->total.found + r->total.false_alarms);
        put_mark(page, k, svg_at(&x, r->total.detection.value), svg_at(&y, (double)r->total.found / answers));
    }
    svg_end(page);
    fputs("</figure>\n", page);
}

static void put_false_alarms(FILE *page, const ScoreReport *report)
{
    double least = INFINITY, most = 0;
    for (int k = 0; k < report->recognisers; k++)
        for (int i = 0; i < report->recogniser[k].points; i++) {
            const double rate = report->recogniser[k].curve[i].false_per_frame;
            if (rate > 0) least = fmin(least, rate), most = fmax(most, rate);
        }
    if (!(most > 0)) return;
    const SvgAxis x = svg_log_axis(least, most, box.left, box.right), y = share_axis(box.bottom, box.top);
    fputs("<figure>", page);
    svg_begin(page, width_px, height_px, "Found at a rate of false alarms", "", "");
    svg_axes(page, &box, &x, "false alarms a frame", &y, "share of targets found");
    for (int k = 0; k < report->recognisers; k++) {
        const ScoreRecogniser *r = &report->recogniser[k];
        const SvgPen           pen = pen_of(k);
        svg_curve_begin(page, &pen);
        for (int i = 0; i < r->points; i++) {
            const double rate = r->curve[i].false_per_frame;
            svg_curve_point(page, rate > 0 ? svg_at(&x, rate) : box.left, svg_at(&y, r->curve[i].recall));
        }
        svg_curve_end(page);
        const double rate = r->total.per_frame.value;
        put_mark(page, k, rate > 0 ? svg_at(&x, rate) : box.left, svg_at(&y, r->total.detection.value));
    }
    svg_end(page);
    fputs("</figure>\n", page);
}

/* Steps of 1, 2 or 5 times a power of ten, two to five on either side of 0. */
static SvgAxis even_axis(double most, double middle_px, double half_px)
{
    const double unit = pow(10, floor(log10(most / 2))), of = most / 2 / unit,
                 step = unit * (of >= 5   ? 5
                                : of >= 2 ? 2
                                          : 1);
    SvgAxis a = {.low = -most, .high = most, .from_px = middle_px - half_px, .to_px = middle_px + half_px};
    for (int k = -(int)floor(most / step); k <= (int)floor(most / step) && a.ticks < svg_ticks_max; k++)
        a.tick[a.ticks++] = k * step;
    return a;
}

/* The mean as a point, the rms difference as a circle about the target's centre. */
static void put_centroids(FILE *page, const ScoreReport *report)
{
    const int    half = (box.bottom - box.top) / 2, middle = box.top + half;
    const SvgBox square = {box.left, box.left + 2 * half, box.top, box.bottom};
    double       most = 0;
    for (int k = 0; k < report->recognisers; k++) {
        const ScoreErrors *e = &report->recogniser[k].errors;
        if (e->count > 0) most = fmax(most, fmax(e->rms_px, fmax(fabs(e->mean_px[0]), fabs(e->mean_px[1]))));
    }
    if (!(most > 0) || !isfinite(most)) return;
    const SvgAxis x = even_axis(1.15 * most, square.left + half, half), y = even_axis(1.15 * most, middle, half);
    fputs("<figure>", page);
    svg_begin(page, width_px, height_px, "Errors of centroids", "", "");
    svg_axes(page, &square, &x, "column, px", &y, "row, px (down)");
    for (int k = 0; k < report->recognisers; k++) {
        const ScoreErrors *e = &report->recogniser[k].errors;
        if (e->count == 0) continue;
        const SvgPen pen = {page_colour[k], 1.6, page_dashes[k]};
        const int    line = square.top + 12 + 40 * k;
        svg_circle(page, &pen, svg_at(&x, 0), svg_at(&y, 0), svg_at(&x, e->rms_px) - svg_at(&x, 0));
        put_mark(page, k, svg_at(&x, e->mean_px[0]), svg_at(&y, e->mean_px[1]));
        svg_line(page, &pen, square.right + 24, line, square.right + 46, line);
        svg_text(page, SVG_INK, SVG_LEFT, square.right + 54, line + 4, "mean %+.2f, %+.2f px", e->mean_px[0],
                 e->mean_px[1]);
        svg_text(page, SVG_INK, SVG_LEFT, square.right + 54, line + 20, "rms %.2f px of %lld", e->rms_px, e->count);
    }
    svg_text(page, SVG_DIM, SVG_LEFT, square.right + 24, square.bottom, "point: mean; circle: rms");
    svg_end(page);
    fputs("</figure>\n", page);
}

void page_curves(FILE *page, const ScoreReport *report)
{
    fputs("<h2>Precision, false alarms, centroids</h2>\n<p class=\"dim\">Answers from the highest score down, whatever "
          "their class; point: at the score of the rates above.</p>\n",
          page);
    page_legend(page, report);
    fputs("<div class=\"plots\">\n", page);
    put_precision(page, report);
    put_false_alarms(page, report);
    put_centroids(page, report);
    fputs("</div>\n", page);
}
