/* render/radar/ground_table.h: how the ground of each surface class mirrors radar waves, from etc/radar/ground.csv
 * (with a source a row): a rough half space. */
#ifndef RENDER_RADAR_GROUND_TABLE_H
#define RENDER_RADAR_GROUND_TABLE_H

#include "render/radar/fresnel.h"
#include "terrain/surface.h"

enum { ground_points = 8 };

/* A class: permittivity on straight lines over log frequency between points, constant beyond. */
typedef struct GroundRow {
    int    points;
    double frequency_hz[ground_points], e1[ground_points], e2[ground_points];
    double rms_m;     /* of heights about the mean plane */
    bool   waves;     /* heights of a sinusoid with random amplitude and phase; else normal */
} GroundRow;

typedef struct GroundTable {
    GroundRow row[SURFACE_COUNT]; /* [SURFACE_NONE] is as bare soil */
} GroundTable;

/* Each class must have a row; failures are logged with file, line, column and range, and leave *out as it was. */
Status ground_table_open(GroundTable *out, const char *path);

/* At one frequency. */
typedef struct GroundSurface {
    double complex eps;
    double         rms_m;
    bool           waves;
} GroundSurface;
GroundSurface ground_surface(const GroundRow *row, double frequency_hz);

/* Share of the amplitude that the mean plane mirrors coherently; x = 2 (k rms sin grazing)^2. Normal heights: exp(-x)
 * (Ament, Proc. IRE 41, 142, 1953). Waves: exp(-x) I0(x) (Miller, Brown & Vegh, IEE Proc. F 131(2), 1984). Slopes
 * small, nothing in its own shadow. Within 3e-7 (tests/render/test_ground_bounce.c). */
double ground_roughness(double rms_m, bool waves, double k, double sin_grazing);

/* Reflection for E across and in the plane of incidence (fresnel.h's signs), roughness included. */
void ground_reflection(double complex *te, double complex *tm, const GroundSurface *surface, double k,
                       double sin_grazing);

#endif
