/* sensor/commands/fly_plot.c: paths of flights as SVG: height and deviation over the way. */
#include "sensor/commands/fly_plot_private.h"

#include "pitviper_output.h"
#include "sensor/publish/files/svg_plot.h"

#include <errno.h>

enum { width_px = 900, height_px = 620 };

static const SvgBox side = {.left = 70, .right = 870, .top = 74, .bottom = 330},
                    plan = {.left = 70, .right = 870, .top = 380, .bottom = 570};

void fly_paths_take(FlyPaths *paths, const Cast *cast, const CastFlight *flight)
{
    if (paths->count == fly_paths_most) return;
    const CastRound *round = &cast->round[flight->round];
    FlyPath         *path = &paths->path[paths->count++];
    double           ahead[3], up[3] = {0, 0, 1}, right[3];
    CastPose         pose;
    m3_tmul_v3(ahead, cast->ground.frame.r_ecef_from_enu, flight->v_ecef_mps);
    ahead[2] = 0;
    if (!v3_normalize(ahead, ahead)) ahead[1] = 1;
    v3_cross(right, ahead, up);
    *path = (FlyPath){.points = fly_path_points, .hit = flight->hit};
    for (int i = 0; i < fly_path_points; i++) {
        double off[3];
        cast_flight_pose(&pose, cast, round, round->fire_s + flight->flight_s * i / (fly_path_points - 1));
        v3_sub(off, pose.p_enu, round->launch_enu);
        path->along_m[i] = (float)v3_dot(off, ahead);
        path->right_m[i] = (float)v3_dot(off, right);
        path->above_m[i] = (float)off[2];
    }
}

static void stretch(double range[2], const float *value, int count)
{
    for (int i = 0; i < count; i++) range[0] = fmin(range[0], value[i]), range[1] = fmax(range[1], value[i]);
}

static void draw(FILE *to, const FlyPath *p, const SvgAxis *x, const SvgAxis *y, const float *value)
{
    const SvgPen pen = {p->hit ? SVG_BLUE : SVG_RED, 1.2, NULL}, dot = {pen.colour, 0, NULL};
    const int    last = p->points - 1;
    svg_curve_begin(to, &pen);
    for (int i = 0; i < p->points; i++) svg_curve_point(to, svg_at(x, p->along_m[i]), svg_at(y, value[i]));
    svg_curve_end(to);
    svg_circle(to, &dot, svg_at(x, p->along_m[last]), svg_at(y, value[last]), 3);
}

static void plot(FILE *to, const FlyPaths *paths, const char *scenario)
{
    static const SvgPen hit = {SVG_BLUE, 2, NULL}, missed = {SVG_RED, 2, NULL};
    double              along[2] = {0, 1}, right[2] = {-1, 1}, above[2] = {-1, 1};
    char                about[80];
    int                 hits = 0;
    for (int i = 0; i < paths->count; i++) {
        const FlyPath *p = &paths->path[i];
        stretch(along, p->along_m, p->points);
        stretch(right, p->right_m, p->points);
        stretch(above, p->above_m, p->points);
        hits += p->hit;
    }
    if (along[0] > -1) along[0] = 0; /* rounding */
    const SvgAxis x = svg_linear_axis(along[0], along[1], side.left, side.right),
                  high = svg_linear_axis(above[0], above[1], side.bottom, side.top),
                  wide = svg_linear_axis(right[0], right[1], plan.top, plan.bottom);
    snprintf(about, sizeof about, ": paths of %d flights, %d hits", paths->count, hits);
    svg_begin(to, width_px, height_px, scenario, about,
              "from the side, and from above; height, deviation and way have scales of their own");
    svg_axes(to, &side, &x, "", &high, "height above the launch, m");
    svg_axes(to, &plan, &x, "way along the direction of launch, m", &wide, "to its right, m");
    for (int i = 0; i < paths->count; i++) {
        draw(to, &paths->path[i], &x, &high, paths->path[i].above_m);
        draw(to, &paths->path[i], &x, &wide, paths->path[i].right_m);
    }
    svg_legend(to, &hit, 700, side.top - 12, "hit");
    svg_legend(to, &missed, 780, side.top - 12, "missed");
    svg_end(to);
}

Status fly_paths_write(const FlyPaths *paths, const char *path, const char *scenario)
{
    FILE *file = output_begin(path, OUTPUT_STREAM);
    if (file) plot(file, paths, scenario);
    if (file && output_end(file, path)) return STATUS_OK;
    log_error("fly: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}
