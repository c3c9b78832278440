/* sensor/truth/pixel_error.c: the spread of errors over pixels, and what a displaced target does to those near it. */
#include "sensor/truth/pixel_error.h"

#include "render/heat/vehicle_heat.h"

static const double least_k = 1e-4;
enum { most_px = 1024, way_most_px = 256 };

void error_spread_add(ErrorSpread *s, double square_k2, double px)
{
    const double decades = square_k2 > least_k * least_k ? 0.5 * log10(square_k2) - log10(least_k) : 0;
    s->px[(int)clamp(decades * error_bins_a_decade, 0, error_bins - 1)] += px;
    s->all_px += px;
    s->beyond_px += square_k2 > 0 ? px * erfc(1 / sqrt(2 * square_k2)) : 0;
    s->squares_px_k2 += px * square_k2;
}

void error_spread_join(ErrorSpread *s, const ErrorSpread *more)
{
    for (int i = 0; i < error_bins; i++) s->px[i] += more->px[i];
    s->all_px += more->all_px;
    s->beyond_px += more->beyond_px;
    s->squares_px_k2 += more->squares_px_k2;
}

double error_spread_median_k(const ErrorSpread *s)
{
    double below = 0;
    int    bin = 0;
    if (!(s->all_px > 0)) return NAN;
    while (bin < error_bins - 1 && below + s->px[bin] < 0.5 * s->all_px) below += s->px[bin++];
    const double within = s->px[bin] > 0 ? clamp((0.5 * s->all_px - below) / s->px[bin], 0, 1) : 0.5;
    return bin == 0 ? 0 : least_k * pow(10, (bin + within) / error_bins_a_decade);
}

double error_spread_rms_k(const ErrorSpread *s) { return s->all_px > 0 ? sqrt(s->squares_px_k2 / s->all_px) : NAN; }
double error_spread_beyond(const ErrorSpread *s) { return s->all_px > 0 ? s->beyond_px / s->all_px : NAN; }

static double heat_k2(const DisplacedTarget *of, size_t at)
{
    const double temp_k = of->picture->temp_k ? (double)of->picture->temp_k[at] : NAN;
    if (!isfinite(temp_k) || !isfinite(of->air_k)) return 0;
    const double k = vehicle_heat_error_k(temp_k, of->air_k);
    return k * k;
}

void error_of_displaced(ErrorSpread *touched, ErrorSpread *own, const DisplacedTarget *of)
{
    static const int way[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const Picture   *p = of->picture;
    const uint32_t   id = (uint32_t)of->index + 1;
    const int        d = (int)clamp(rint(of->way_px), 1, way_most_px);
    const double     shorter = fmin(of->way_px, 1) * fmin(of->way_px, 1); /* below a pixel as its square */
    const int       *b = of->px->box;
    const int        x0 = b[0] > d ? b[0] - d : 0, x1 = b[2] + d < p->width ? b[2] + d : p->width;
    const int        y0 = b[1] > d ? b[1] - d : 0, y1 = b[3] + d < p->height ? b[3] + d : p->height;
    const double     area = (double)(x1 - x0) * (y1 - y0);
    const int        step = area > most_px ? (int)ceil(sqrt(area / most_px)) : 1;
    for (int y = y0 + step / 2; y < y1; y += step)
        for (int x = x0 + step / 2; x < x1; x += step) {
            const size_t at = (size_t)y * (size_t)p->width + (size_t)x;
            const double here = pixel_share_of(p, of->px, id, at);
            double       here_k = NAN, sum = 0;
            int          count = 0;
            bool         any = here > 0;
            for (int k = 0; k < 4; k++) {
                const int to_x = x + d * way[k][0], to_y = y + d * way[k][1];
                if (to_x < 0 || to_x >= p->width || to_y < 0 || to_y >= p->height) continue;
                const size_t to = (size_t)to_y * (size_t)p->width + (size_t)to_x;
                count++;
                if (!(here > 0) && !(pixel_share_of(p, of->px, id, to) > 0)) continue; /* ground, which stays */
                if (isnan(here_k)) here_k = planck_table_temp(of->planck, (double)of->value[at]);
                const double apart_k = planck_table_temp(of->planck, (double)of->value[to]) - here_k;
                any = true;
                sum += apart_k * apart_k;
            }
            if (!any) continue;
            const double square = of->further_k2 + (count > 0 ? shorter * sum / count : 0) + (here > 0 ? here * here * heat_k2(of, at) : 0);
            error_spread_add(touched, square, (double)step * step);
            if (here > 0) error_spread_add(own, square, here * step * step);
        }
}
