/* render/heat/ground_column.h: one kind of ground under the weather: its layers, its water, its balance at the surface. */
#ifndef RENDER_HEAT_GROUND_COLUMN_H
#define RENDER_HEAT_GROUND_COLUMN_H

#include "render/heat/column.h"
#include "render/heat/surface_flux.h"

typedef enum GroundVapour { GROUND_DRY, GROUND_SOIL, GROUND_LEAVES, GROUND_WATER } GroundVapour;

/* Row of etc/ground_heat.csv, with the optics of its material. */
typedef struct GroundKind {
    char         name[32];
    ColumnLayer  layer[2];        /* above the soil: thatch, paving, snow, water */
    int          layers;
    double       porosity, quartz, saturation; /* of the soil below; porosity 0: rock, of: */
    double       rock_w_mk, rock_j_m3k;
    double       roughness_m;
    GroundVapour vapour;
    double       resistance_s_m;  /* of leaves in full sun */
    double       absorptance, emissivity;
    double       melts_k;         /* no warmer than this; INFINITY: any */
} GroundKind;

/* Weather at one instant, as ground feels it. */
typedef struct GroundWeather {
    SurfaceAir air;
    double     direct_w_m2, diffuse_w_m2, longwave_w_m2; /* facing the sun; on level ground; down on level ground */
    double     sun_d_enu[3];
    double     rain_kg_m2s;
} GroundWeather;

/* What of the sky a piece of ground sees. */
typedef struct GroundExposure {
    double n_enu[3];
    double sun;        /* share of the direct sun that arrives, 0 .. 1 */
    double sky;        /* share of the hemisphere over the surface that is sky, beyond what its tilt takes, 0 .. 1 */
    double around_k;   /* temperature of what fills the rest */
} GroundExposure;

typedef struct GroundColumn {
    const GroundKind *kind;
    const Column     *column;     /* ground_layers of that kind */
    const ColumnFactors *factors; /* of its usual step; NULL: found at each */
    ColumnState       state;
    double            saturation; /* at the top */
} GroundColumn;

/* Elements: first at the top, growing. Defaults: bench precision has rows of time against error. */
typedef struct GroundGrid {
    double first_m, growth, depth_m, tolerance_k;
} GroundGrid;
static const GroundGrid ground_grid_default = {0.003, 1.3, 3, 0.02};

/* Of one kind, shared by its columns. STATUS_BAD_VALUE: column_create's. */
Status ground_layers(Column *out, const GroundKind *kind, const GroundGrid *grid);
void   ground_column_start(GroundColumn *out, const GroundKind *kind, const Column *layers, double temp_k);
/* From before to after; both exposures the same piece of ground. */
void   ground_column_step(GroundColumn *column, double tolerance_k, const GroundWeather *before,
                          const GroundWeather *after, const GroundExposure *exposure, double dt_s);
/* What it absorbs, W/m2. */
double ground_absorbed_w_m2(const GroundColumn *column, const GroundWeather *weather, const GroundExposure *exposure);
/* Its balance there and then. */
void   ground_flux(SurfaceFlux *out, const GroundColumn *column, const GroundWeather *weather, const GroundExposure *exposure);

#endif
