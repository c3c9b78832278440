/* render/scattering/built/facade_table.h: how walls, roofs and other built surfaces scatter what they do not mirror,
 * and how far they are from planes, from etc/radar/facades.csv (with a source a row). */
#ifndef RENDER_SCATTERING_BUILT_FACADE_TABLE_H
#define RENDER_SCATTERING_BUILT_FACADE_TABLE_H

#include "render/scattering/clutter/clutter.h"
#include "render/scattering/radar_surfaces.h"

enum { facade_rows_most = 64 };

/* One kind of surface, by the beginning of its material's name. */
typedef struct FacadeRow {
    char   material[32];                  /* "other": of any; the last row */
    double scattered[CLUTTER_BAND_COUNT]; /* S: share of the amplitude of what is reflected that is scattered, 0 .. 1 */
    double hv;                            /* power of HV over that of VV, of what is scattered */
    double uneven_m, uneven_length_m;     /* rms height over a plane, and how far its bumps are apart; 0: a plane */
} FacadeRow;

typedef struct FacadeTable {
    int       count;
    FacadeRow row[facade_rows_most];
} FacadeTable;

/* Failures are logged with file, line, column and range, and leave *out as it was. */
Status facade_table_open(FacadeTable *out, const char *path);
/* The first row whose name begins that of the material; else the last. */
const FacadeRow *facade_row(const FacadeTable *table, const char *material);

/* Share of the reflected power that is scattered all round: by S, and by the roughness of the material (what
 * fresnel_rough takes of the mirrored part): 1 - (1 - S^2) rough^2. */
double facade_diffuse_share(const FacadeRow *row, ClutterBand band, const RadarSurface *surface, double k,
                            double cosine);

/* Mean cross section by area of what is scattered: 4 share Gamma^2 cos^2, Lambert's law. Gamma^2: mean over
 * polarisations of the power that a smooth surface of the material reflects. So what is mirrored and what is scattered
 * are together what Fresnel's equations return. Source: V. Degli-Esposti, F. Fuschini, E. M. Vitucci, G. Falciasecca,
 * Measurement and modelling of scattering from buildings, IEEE Trans. Antennas Propag. 55(1), 2007 (Lambertian lobe).
 */
double facade_sigma0(const FacadeRow *row, ClutterBand band, const RadarSurface *surface, double k, double cosine);

/* Height of an uneven surface over its plane at (s, t) of that plane, m: bumps of a seed, rms row->uneven_m
 * everywhere, continuous. */
double facade_height(const FacadeRow *row, uint64_t seed, double s_m, double t_m);

#endif
