/* sensor/commands/range/range_plot.c: probabilities over range, as a table and as a plot. */
#include "sensor/commands/range/range_private.h"

#include "sensor/publish/files/svg_plot.h"

enum { width_px = 900, height_px = 470, legend_x = 668 };

static const SvgBox box = {.left = 58, .right = 650, .top = 74, .bottom = 416};
const char *const   range_task_names[acquisition_tasks] = {"detect", "recognise", "identify"};

static const SvgPen pens[range_methods][acquisition_tasks] = {
    {{SVG_BLUE, 2, "6 4"}, {SVG_AMBER, 2, "6 4"}, {SVG_GREEN, 2, "6 4"}},
    {{SVG_BLUE, 2, NULL}, {SVG_AMBER, 2, NULL}, {SVG_GREEN, 2, NULL}}};

static void draw_curve(FILE *to, const RangeCourse *c, const SvgAxis *km, const SvgAxis *p, int method, int task)
{
    static const char *const by[range_methods] = {"Johnson", "TTP"};
    const int                row = acquisition_tasks * (1 - method) + task;
    const double y = box.top + 22 * row + 20, half_m = range_of(c, (RangeMethod)method, (AcquisitionTask)task, 0.5);
    char         name[40];
    svg_curve_begin(to, &pens[method][task]);
    for (int i = 0; i < range_rows; i++)
        svg_curve_point(to, svg_at(km, 1e-3 * c->row[i].range_m), svg_at(p, c->row[i].p[method][task]));
    svg_curve_end(to);
    snprintf(name, sizeof name, "%s, %s", range_task_names[task], by[method]);
    svg_legend(to, &pens[method][task], legend_x, y, name);
    if (half_m > 0 && half_m < INFINITY) {
        const SvgPen dot = {pens[method][task].colour, 0, NULL};
        svg_circle(to, &dot, svg_at(km, 1e-3 * half_m), svg_at(p, 0.5), 3.5);
        svg_text(to, SVG_DIM, SVG_RIGHT, width_px - 12, y + 4, "%.2f", 1e-3 * half_m);
    } else svg_text(to, SVG_DIM, SVG_RIGHT, width_px - 12, y + 4, half_m > 0 ? "beyond" : "\u2013");
}

void range_plot(FILE *to, const void *text)
{
    const RangeCourse *c = ((const RangeText *)text)->course;
    const SvgAxis      km = svg_linear_axis(0, 1e-3 * c->row[range_rows - 1].range_m, box.left, box.right);
    const SvgAxis      p = {SVG_LINEAR, 0, 1, box.bottom, box.top, 6, {0, 0.2, 0.4, 0.6, 0.8, 1}};
    svg_begin(to, width_px, height_px, c->preset.name, ": probability of an observer's tasks over range",
              ((const RangeText *)text)->about);
    svg_axes(to, &box, &km, "range, km", &p, "probability");
    for (int method = 0; method < range_methods; method++)
        for (int task = 0; task < acquisition_tasks; task++) draw_curve(to, c, &km, &p, method, task);
    svg_text(to, SVG_DIM, SVG_RIGHT, width_px - 12, box.top + 2, "half, km");
    svg_end(to);
}

void range_csv(FILE *to, const void *text)
{
    const RangeCourse *c = ((const RangeText *)text)->course;
    fputs("range_m,transmittance,contrast,cycles,johnson_detect,johnson_recognise,johnson_identify,ttp_v,ttp_detect,"
          "ttp_recognise,ttp_identify\n",
          to);
    for (int i = 0; i < range_rows; i++) {
        const RangePoint *r = &c->row[i];
        fprintf(to, "%.6g,%.6g,%.6g,%.6g", r->range_m, r->transmittance, r->contrast, r->cycles);
        for (int task = 0; task < acquisition_tasks; task++) fprintf(to, ",%.6g", r->p[BY_JOHNSON][task]);
        fprintf(to, ",%.6g", r->ttp_v);
        for (int task = 0; task < acquisition_tasks; task++) fprintf(to, ",%.6g", r->p[BY_TTP][task]);
        fputc('\n', to);
    }
}
