/* render/radar/radar_materials.h: how each material reflects radar, from etc/radar/materials.csv (with a source a
 * row).
 *
 * A material has one row, or several at rising frequencies: its permittivity is a straight line over log frequency
 * between them and constant beyond. A material of etc/materials.csv without a row takes the row `metal_default` or
 * `other_default`, by its column `metal`. */
#ifndef RENDER_RADAR_RADAR_MATERIALS_H
#define RENDER_RADAR_RADAR_MATERIALS_H

#include "render/materials/materials.h"
#include "render/radar/fresnel.h"

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
