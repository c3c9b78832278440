/* render/radar/fresnel.c: complex reflection of metal, half spaces, slabs and coatings. */
#include "render/radar/fresnel.h"

/* Component of the wave vector across the surface, inside, over k: decays inwards. */
static double complex inward(double complex eps, double cosine)
{
    const double complex q = csqrt(eps - (1 - cosine * cosine));
    return cimag(q) > 0 ? -q : q;
}

void fresnel_half_space(double complex *te, double complex *tm, double complex eps, double cosine)
{
    const double complex q = inward(eps, cosine);
    *te = (cosine - q) / (cosine + q);
    *tm = (eps * cosine - q) / (eps * cosine + q);
}

void fresnel_slab(double complex *te, double complex *tm, double complex *tte, double complex *ttm, double complex eps,
                  double thick_m, double k, double cosine)
{
    const double complex p = cexp(-I * k * thick_m * inward(eps, cosine));
    double complex       g[2], *out[2] = {te, tm}, *through[2] = {tte, ttm};
    fresnel_half_space(&g[0], &g[1], eps, cosine);
    for (int i = 0; i < 2; i++) {
        const double complex under = 1 - g[i] * g[i] * p * p;
        *out[i] = g[i] * (1 - p * p) / under;
        if (through[i]) *through[i] = (1 - g[i] * g[i]) * p / under;
    }
}

/* The wall behind returns -1 (TE) and +1 (TM). */
void fresnel_coated(double complex *te, double complex *tm, double complex eps, double thick_m, double k, double cosine)
{
    const double complex p = cexp(-2 * I * k * thick_m * inward(eps, cosine));
    double complex       g[2];
    fresnel_half_space(&g[0], &g[1], eps, cosine);
    *te = (g[0] - p) / (1 - g[0] * p);
    *tm = (g[1] + p) / (1 + g[1] * p);
}

double fresnel_rough(double rough_m, double k, double cosine)
{
    const double phase = k * rough_m * cosine;
    return exp(-2 * phase * phase);
}

void fresnel_surface(double complex *te, double complex *tm, const RadarSurface *surface, double k, double cosine)
{
    switch (surface->kind) {
    case RADAR_HALF_SPACE: fresnel_half_space(te, tm, surface->eps, cosine); break;
    case RADAR_SLAB: fresnel_slab(te, tm, NULL, NULL, surface->eps, surface->thick_m, k, cosine); break;
    case RADAR_COATED: fresnel_coated(te, tm, surface->eps, surface->thick_m, k, cosine); break;
    default: *te = -1, *tm = 1; break;
    }
    const double rough = fresnel_rough(surface->rough_m, k, cosine);
    *te *= rough, *tm *= rough;
}
