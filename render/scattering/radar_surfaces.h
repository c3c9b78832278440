/* render/scattering/radar_surfaces.h: how surfaces reflect radar waves, and what each material is to them.
 *
 * Complex reflection of a plane wave by metal, a half space, a slab in air and a coating on metal. exp(+j w t); eps
 * = e' - j e'' relative, e' >= 1, e'' >= 0; k: wave number in air, rad/m; cosine: of the angle of incidence, 0 ..
 * 1. The phase is at the surface. TE: E across the plane of incidence; TM: E in it, along e_par = d x e_perp before
 * and d' x e_perp after, e_perp = d x n: metal has TE = -1, TM = +1 at every angle.
 *
 * Within 1e-11 of tables made elsewhere (tests/render/test_radar_fresnel.c). Source: Born & Wolf, Principles of
 * Optics, 1.5 and 1.6 (their sign of TM is that of the magnetic field). */
#ifndef RENDER_SCATTERING_RADAR_SURFACES_H
#define RENDER_SCATTERING_RADAR_SURFACES_H

#include "render/materials/materials.h"

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
/* A slab of surface->eps and thick_m in air. tte, ttm: amplitude transmitted, at the far face; may be NULL. */
void fresnel_slab(double complex *te, double complex *tm, double complex *tte, double complex *ttm,
                  const RadarSurface *surface, double k, double cosine);
void fresnel_coated(double complex *te, double complex *tm, double complex eps, double thick_m, double k,
                    double cosine);

/* Share of the amplitude that a rough surface returns in the mirror direction: exp(-2 (k h cos)^2). Heights normal
 * with rms h, slopes small. Source: Ament, Proc. IRE 41, 142, 1953. */
double fresnel_rough(double rough_m, double k, double cosine);

/* Reflection of any kind of surface, its roughness included. */
void fresnel_surface(double complex *te, double complex *tm, const RadarSurface *surface, double k, double cosine);

/* ---- materials ---------------------------------------------------------------------------------- */

/* How each material reflects radar, from etc/radar/materials.csv (with a source a row).
 *
 * A material has one row, or several at rising frequencies: its permittivity is a straight line over log frequency
 * between them and constant beyond. A material of etc/materials.csv without a row takes the row `metal_default` or
 * `other_default`, by its column `metal`. */
enum { radar_material_points = 8 };

typedef struct RadarMaterial {
    char             name[32];
    RadarSurfaceKind kind;
    double           thick_m, rough_m;
    int              points;
    double           frequency_hz[radar_material_points], e1[radar_material_points], e2[radar_material_points];
} RadarMaterial;

typedef struct RadarMaterials {
    int            count;
    RadarMaterial *material;
} RadarMaterials;

/* optical: the materials that must have a row or a default, each by its name in the result. Failures are logged. */
Status radar_materials_open(RadarMaterials *out, const char *path, const Materials *optical);
/* The tables of etc/, in use. */
Status radar_materials_load(RadarMaterials *out);
void   radar_materials_close(RadarMaterials *m);
int    radar_materials_find(const RadarMaterials *m, const char *name); /* -1: none */
void   radar_surface(RadarSurface *out, const RadarMaterial *material, double frequency_hz);

#endif
