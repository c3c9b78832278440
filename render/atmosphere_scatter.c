/* render/atmosphere_scatter.c: how scattered sunlight goes about between the tables' points. Its errors are the
 * tables' business, which hold the ratio of the truth to this; only its shape counts. */
#include "render/atmosphere_private.h"

/* What one metre of air at a height scatters. */
typedef struct Scatterers {
    double clear_per_m, haze_per_m;
} Scatterers;

static double at_height(const Profile *profile, const double *per_m, double height_m)
{
    double t;
    const int i = interval_of(&t, profile->height_m, profile->nodes, height_m);
    return per_m[i] + t * (per_m[i + 1] - per_m[i]);
}

static Scatterers scatterers_at(const Blend *blend, AirBand band, double height_m)
{
    const Profile *low = &blend->low->profile, *high = &blend->high->profile;
    Scatterers s = {at_height(low, low->clear_scatter[band], height_m),
                    blend->haze_low * at_height(low, low->haze_scatter[band], height_m)};
    if (low == high) return s;
    const double haze = at_height(high, high->haze_scatter[band], height_m);
    s.haze_per_m = fmax(s.haze_per_m + blend->haze_high * haze, 0.1 * haze);
    return s;
}

/* Share of a sphere's light per unit of solid angle times 4 pi, of clear air (Rayleigh) and of haze. */
static void phases(double out[2], const Atmosphere *atmosphere, AirBand band, double cosine)
{
    double ln[air_scattered_count];
    const double angle_rad = acos(clamp(cosine, -1, 1));
    grid_at(ln, &atmosphere->phase, &angle_rad);
    out[0] = 0.75 * (1 + cosine * cosine);
    out[1] = exp(ln[air_tabled_index(band)]);
}

/* Radiance that a metre adds, W/(m3 sr): the sun's own light once, and twice the diffuse for the sphere's glow with
 * a fifth of what reaches the ground. */
static double source_at(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double height_m,
                        double sun_zenith_rad, const double phase[2])
{
    SunAir sun;
    blend_sun(&sun, atmosphere, blend, band, height_m, sun_zenith_rad);
    const Scatterers s = scatterers_at(blend, band, height_m);
    const double glow = 2 * sun.diffuse_horizontal_w_m2 +
                        0.4 * (sun.diffuse_horizontal_w_m2 + sun.direct_normal_w_m2 * cos(sun_zenith_rad));
    return ((s.clear_per_m * phase[0] + s.haze_per_m * phase[1]) * sun.direct_normal_w_m2 +
            (s.clear_per_m + s.haze_per_m) * glow) / (4 * pi_rad);
}

/* Mean of exp(-x) over a step from a to b of depth. */
static double mean_transmittance(double a, double b)
{
    return b - a > 1e-6 ? (exp(-a) - exp(-b)) / (b - a) : exp(-(a + b) / 2);
}

static double scattering_cosine(double up_view, double sun_zenith_rad, double rel_azimuth_rad)
{
    return up_view * cos(sun_zenith_rad) +
           sqrt(fmax(1 - up_view * up_view, 0)) * sin(sun_zenith_rad) * cos(rel_azimuth_rad);
}

double scatter_estimate(const Atmosphere *atmosphere, const Blend *blend, AirBand band, const AirPath *path)
{
    enum { steps = 8 };
    const double rise_m = path->target_m - path->observer_m, up = clamp(rise_m / path->range_m, -1, 1);
    double phase[2];
    phases(phase, atmosphere, band, scattering_cosine(up, path->sun_zenith_rad, path->rel_azimuth_rad));
    const double ratio = exp(blend_ln_ratio(blend, band, path, 0));
    double sum = 0, depth = 0;
    for (int i = 0; i < steps; i++) {
        const double a_m = path->observer_m + rise_m * i / steps, b_m = path->observer_m + rise_m * (i + 1) / steps;
        const double step_m = path->range_m / steps;
        const double next = depth + ratio * step_m * blend_mean_extinction(blend, band, a_m, b_m);
        sum += step_m * mean_transmittance(depth, next) *
               source_at(atmosphere, blend, band, (a_m + b_m) / 2, path->sun_zenith_rad, phase);
        depth = next;
    }
    return sum;
}

double scatter_estimate_sky(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double observer_m,
                            double zenith_rad, double sun_zenith_rad, double rel_azimuth_rad)
{
    /* heights in steps that grow upwards: two scale heights' worth of air is below the middle */
    enum { steps = 12 };
    const Profile *profile = &blend->low->profile;
    const double rise_m = fmin(profile->height_m[profile->nodes - 1], 40000) - observer_m;
    if (!(rise_m > 0)) return 0;
    double phase[2];
    phases(phase, atmosphere, band, scattering_cosine(cos(zenith_rad), sun_zenith_rad, rel_azimuth_rad));
    const double slant = air_mass(zenith_rad);
    double sum = 0, depth = 0;
    for (int i = 0; i < steps; i++) {
        const double s = (double)i / steps, t = (double)(i + 1) / steps;
        const double a_m = observer_m + rise_m * s * s, b_m = observer_m + rise_m * t * t, step_m = slant * (b_m - a_m);
        const double next = depth + step_m * blend_mean_extinction(blend, band, a_m, b_m);
        sum += step_m * mean_transmittance(depth, next) *
               source_at(atmosphere, blend, band, (a_m + b_m) / 2, sun_zenith_rad, phase);
        depth = next;
    }
    return sum;
}
