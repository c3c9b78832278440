/* dis/clock/delay_line.c: lower convex hull of delays, kept while points arrive; and their trend. */
#include "dis/clock/exercise_clock_private.h"

static const double dead_s = 1e-4;        /* a change of the offset smaller than this is not applied */
static const double drift_most = 2e-4;    /* a clock drifts by less than this; a larger slope is not drift */
static const double slope_least_s = 1e-3; /* a slope is applied when it amounts to this much over all points */
enum {
    slope_points = 64,
    slope_noise = 30
}; /* by chance alone, jitter J makes slopes of about J / N over all N points */

void delay_line_begin(DelayLine *line, double x_s, double y_s)
{
    *line = (DelayLine){.count = 1, .points = 1, .mean_x_s = x_s, .mean_y_s = y_s, .offset_s = y_s, .at_s = x_s};
    line->x_s[0] = x_s;
    line->y_s[0] = y_s;
}

/* Twice the area of the triangle of three vertices. It is positive where the middle one lies below the line through the
 * others. */
static double below(const DelayLine *line, int a, int b, int c)
{
    return (line->x_s[b] - line->x_s[a]) * (line->y_s[c] - line->y_s[a]) -
           (line->x_s[c] - line->x_s[a]) * (line->y_s[b] - line->y_s[a]);
}

static void drop(DelayLine *line, int i)
{
    for (; i + 1 < line->count; i++) line->x_s[i] = line->x_s[i + 1], line->y_s[i] = line->y_s[i + 1];
    line->count--;
}

static void drop_flattest(DelayLine *line)
{
    int flattest = 1;
    for (int i = 2; i + 1 < line->count; i++)
        if (below(line, i - 1, i, i + 1) < below(line, flattest - 1, flattest, flattest + 1)) flattest = i;
    drop(line, flattest);
}

/* Inserts a point into the hull. Returns false when the point lies above the hull. */
static bool insert(DelayLine *line, double x_s, double y_s)
{
    int i = line->count;
    while (i > 0 && line->x_s[i - 1] >= x_s) i--;
    if (i < line->count && line->x_s[i] == x_s) {
        if (line->y_s[i] <= y_s) return false;
        line->y_s[i] = y_s;
    } else {
        for (int k = line->count; k > i; k--) line->x_s[k] = line->x_s[k - 1], line->y_s[k] = line->y_s[k - 1];
        line->x_s[i] = x_s;
        line->y_s[i] = y_s;
        line->count++;
        if (i > 0 && i + 1 < line->count && below(line, i - 1, i, i + 1) <= 0) {
            drop(line, i);
            return false;
        }
    }
    while (i >= 2 && below(line, i - 2, i - 1, i) <= 0) drop(line, --i);
    while (i + 2 < line->count && below(line, i, i + 1, i + 2) <= 0) drop(line, i + 1);
    if (line->count > delay_line_vertices) drop_flattest(line);
    return true;
}

double delay_line_edge(double *span_s, double *middle_s, const DelayLine *line)
{
    int i = 0;
    *span_s = line->x_s[line->count - 1] - line->x_s[0];
    *middle_s = line->y_s[0];
    if (line->count < 2) return 0;
    while (i + 2 < line->count && line->x_s[i + 1] < line->mean_x_s) i++;
    const double slope = (line->y_s[i + 1] - line->y_s[i]) / (line->x_s[i + 1] - line->x_s[i]);
    *middle_s = line->y_s[i] + slope * (line->mean_x_s - line->x_s[i]);
    return slope;
}

void delay_line_add(DelayLine *line, double x_s, double y_s)
{
    line->points++;
    line->mean_x_s += (x_s - line->mean_x_s) / (double)line->points;
    line->mean_y_s += (y_s - line->mean_y_s) / (double)line->points;
    const bool lower = insert(line, x_s, y_s);
    if (!lower && line->slope == 0) return;

    DelayLine    fit = *line;
    double       span_s, middle_s;
    const double slope = delay_line_edge(&span_s, &middle_s, line);
    const double jitter_s = 2 * fmax(line->mean_y_s - middle_s, 0);
    const bool   drifts = line->points >= slope_points && fabs(slope) <= drift_most &&
                        fabs(slope) * span_s > fmax(slope_least_s, slope_noise * jitter_s / (double)line->points);
    fit.slope = drifts ? slope : 0;
    fit.at_s = line->mean_x_s;
    fit.offset_s = middle_s;
    if (!drifts)
        for (int i = 0; i < line->count; i++) fit.offset_s = i ? fmin(fit.offset_s, line->y_s[i]) : line->y_s[0];
    const double first_s = line->x_s[0], last_s = line->x_s[line->count - 1];
    if (fabs(delay_line_at(&fit, first_s) - delay_line_at(line, first_s)) <= dead_s &&
        fabs(delay_line_at(&fit, last_s) - delay_line_at(line, last_s)) <= dead_s)
        return;
    line->offset_s = fit.offset_s;
    line->slope = fit.slope;
    line->at_s = fit.at_s;
}

/* ---- trend ------------------------------------------------------------------------------------ */

void delay_trend_add(DelayTrend *t, double x_s, double y_s)
{
    if (t->points > 0 && x_s == t->latest_x_s && y_s == t->latest_y_s) return;
    t->latest_x_s = x_s;
    t->latest_y_s = y_s;
    if (t->points++ == 0) t->first_x_s = t->last_x_s = x_s;
    const double dx = x_s - t->mean_x_s, dy = y_s - t->mean_y_s, share = 1 / (double)t->points;
    t->mean_x_s += dx * share;
    t->mean_y_s += dy * share;
    t->xx += dx * (x_s - t->mean_x_s);
    t->xy += dx * (y_s - t->mean_y_s);
    t->yy += dy * (y_s - t->mean_y_s);
    t->first_x_s = fmin(t->first_x_s, x_s);
    t->last_x_s = fmax(t->last_x_s, x_s);
}

static const double tick2_s2 = 4e-12; /* squares of the resolutions of stamps and of arrivals */

/* Sum of the squared deviations of the points from the line. */
static double about_line_s2(const DelayTrend *t)
{
    return fmax(t->yy - (t->xx > tick2_s2 ? t->xy * t->xy / t->xx : 0), (double)t->points * tick2_s2);
}

bool delay_trend_slope(double *slope, double *error, const DelayTrend *t)
{
    if (t->points < 3 || !(t->xx > tick2_s2)) return false;
    *slope = t->xy / t->xx;
    *error = sqrt(about_line_s2(t) / (double)(t->points - 2) / t->xx);
    return true;
}

double delay_trend_scatter(const DelayTrend *t)
{
    return t->points < 3 ? INFINITY : sqrt(about_line_s2(t) / (double)(t->points - 2));
}

double delay_trend_critical(uint64_t points)
{
    /* Student's t for a two-sided probability of 0.01 %; the first entry is for one degree of freedom */
    static const double t[] = {6366, 100, 28.0, 15.5, 11.2, 9.08, 7.88, 7.12};
    if (points < 3) return INFINITY;
    return points - 3 < sizeof t / sizeof t[0] ? t[points - 3] : 6.6;
}
