/* render/air/atmosphere_scatter.c: the shape of scattered sunlight between the tables' points. Its absolute errors
 * do not matter, since the tables hold the ratio of the true value to it; only its shape does. */
#include "render/air/atmosphere_private.h"

static double extinction(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double a_m, double b_m)
{
    return column_mean(&atmosphere->clear, band, a_m, b_m) + blend_haze_mean(blend, band, a_m, b_m);
}

/* Adds a step of the path at a height, between two optical depths: single-scattered sunlight, and a uniform diffuse
 * term of twice the diffuse light on a plane with a fifth of what reaches it. */
static void add_step(ScatterParts *sum, const Atmosphere *atmosphere, const Blend *blend, AirBand band, double height_m,
                     double sun_zenith_rad, double step_m, double depth, double next)
{
    SunAir sun;
    blend_sun(&sun, atmosphere, blend, band, height_m, sun_zenith_rad);
    const double d = next - depth;
    const double seen_m = step_m * (d > 1e-6 ? (exp(-depth) - exp(-next)) / d : exp(-depth)) / (4 * pi_rad);
    const double clear = seen_m * column_scatter(&atmosphere->clear, band, height_m);
    const double haze = seen_m * blend_haze_scatter(blend, band, height_m);
    const double glow = 2 * sun.diffuse_horizontal_w_m2 +
                        0.4 * (sun.diffuse_horizontal_w_m2 + sun.direct_normal_w_m2 * cos(sun_zenith_rad));
    double t;
    const Grid *phase = &atmosphere->phase;
    const int i = interval_of(&t, phase->axis[0], phase->nodes[0], height_m);
    sum->clear += clear * sun.direct_normal_w_m2;
    sum->haze[i] += (1 - t) * haze * sun.direct_normal_w_m2;
    if (t > 0) sum->haze[i + 1] += t * haze * sun.direct_normal_w_m2;
    sum->glow += (clear + haze) * glow;
}

double scatter_estimate(const ScatterParts *parts, const Atmosphere *atmosphere, AirBand band, double up,
                        double sun_zenith_rad, double rel_azimuth_rad)
{
    const Grid *phase = &atmosphere->phase;
    const double cosine = up * cos(sun_zenith_rad) +
                          sqrt(fmax(1 - up * up, 0)) * sin(sun_zenith_rad) * cos(rel_azimuth_rad);
    double sum = 0.75 * (1 + cosine * cosine) * parts->clear + parts->glow; /* clear air: Rayleigh's */
    double t;
    const int a = interval_of(&t, phase->axis[1], phase->nodes[1], acos(clamp(cosine, -1, 1)));
    const double *ln_haze = phase->value + a * air_tabled_count + air_tabled_index(band);
    for (int i = 0; i < phase->nodes[0]; i++, ln_haze += phase->nodes[1] * air_tabled_count)
        if (parts->haze[i] > 0)
            sum += parts->haze[i] * exp(t > 0 ? ln_haze[0] + t * (ln_haze[air_tabled_count] - ln_haze[0]) : ln_haze[0]);
    return sum;
}

void scatter_parts(ScatterParts *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band,
                   const AirPath *path, double depth)
{
    enum { steps = 8 };
    const double rise_m = path->target_m - path->observer_m, step_m = path->range_m / steps;
    const double ratio = depth / extinction(atmosphere, blend, band, path->observer_m, path->target_m) / path->range_m;
    *out = (ScatterParts){0};
    depth = 0;
    for (int i = 0; i < steps; i++) {
        const double a_m = path->observer_m + rise_m * i / steps, b_m = path->observer_m + rise_m * (i + 1) / steps;
        const double next = depth + ratio * step_m * extinction(atmosphere, blend, band, a_m, b_m);
        add_step(out, atmosphere, blend, band, (a_m + b_m) / 2, path->sun_zenith_rad, step_m, depth, next);
        depth = next;
    }
}

void scatter_parts_sky(ScatterParts *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band,
                       double observer_m, double zenith_rad, double sun_zenith_rad)
{
    /* heights in steps that grow upwards */
    enum { steps = 12 };
    const AirColumn *clear = &atmosphere->clear;
    const double rise_m = fmin(clear->height_m[clear->nodes - 1], 40000) - observer_m;
    const double slant = air_mass(zenith_rad);
    double depth = 0;
    *out = (ScatterParts){0};
    if (!(rise_m > 0)) return;
    for (int i = 0; i < steps; i++) {
        const double s = (double)i / steps, t = (double)(i + 1) / steps;
        const double a_m = observer_m + rise_m * s * s, b_m = observer_m + rise_m * t * t, step_m = slant * (b_m - a_m);
        const double next = depth + step_m * extinction(atmosphere, blend, band, a_m, b_m);
        add_step(out, atmosphere, blend, band, (a_m + b_m) / 2, sun_zenith_rad, step_m, depth, next);
        depth = next;
    }
}
