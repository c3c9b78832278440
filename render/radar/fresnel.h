/* render/radar/fresnel.h: complex reflection of a plane wave by metal, a half space, a slab in air and a coating on
 * metal.
 *
 * exp(+j w t); eps = e' - j e'' relative, e' >= 1, e'' >= 0; k: wave number in air, rad/m; cosine: of the angle of
 * incidence, 0 .. 1. The phase is at the surface. TE: E across the plane of incidence; TM: E in it, along e_par = d x
 * e_perp before and d' x e_perp after, e_perp = d x n: metal has TE = -1, TM = +1 at every angle.
 *
 * Within 1e-11 of tables made elsewhere (tests/render/test_radar_fresnel.c). Source: Born & Wolf, Principles of
 * Optics, 1.5 and 1.6 (their sign of TM is that of the magnetic field). */
#ifndef RENDER_RADAR_FRESNEL_H
#define RENDER_RADAR_FRESNEL_H

#include "pitviper.h"

#include <complex.h>

typedef enum RadarSurfaceKind {
    RADAR_METAL,      /* a perfect conductor */
    RADAR_HALF_SPACE, /* so lossy or thick that nothing comes back from within */
    RADAR_SLAB,       /* thick_m of it, air behind */
    RADAR_COATED,     /* thick_m of it on metal */
    RADAR_SURFACE_KINDS
} RadarSurfaceKind;

/* At one frequency. */
typedef struct RadarSurface {
    RadarSurfaceKind kind;
    double complex   eps;
    double           thick_m;
    double           rough_m; /* rms height */
} RadarSurface;

void fresnel_half_space(double complex *te, double complex *tm, double complex eps, double cosine);
/* tte, ttm: amplitude transmitted, at the far face; may be NULL. */
void fresnel_slab(double complex *te, double complex *tm, double complex *tte, double complex *ttm, double complex eps,
                  double thick_m, double k, double cosine);
void fresnel_coated(double complex *te, double complex *tm, double complex eps, double thick_m, double k,
                    double cosine);

/* Share of the amplitude that a rough surface returns in the mirror direction: exp(-2 (k h cos)^2). Heights normal
 * with rms h, slopes small. Source: Ament, Proc. IRE 41, 142, 1953. */
double fresnel_rough(double rough_m, double k, double cosine);

/* Of any surface, its roughness included. */
void fresnel_surface(double complex *te, double complex *tm, const RadarSurface *surface, double k, double cosine);

#endif
