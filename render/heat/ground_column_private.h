/* render/heat/ground_column_private.h: one kind of ground under the weather: its layers, its water, its balance at the
 * surface. */
#ifndef RENDER_HEAT_GROUND_COLUMN_PRIVATE_H
#define RENDER_HEAT_GROUND_COLUMN_PRIVATE_H

#include "render/heat/column_private.h"
#include "render/heat/surface_flux_private.h"
#include "render/materials/materials.h"
#include "pitviper.h"

typedef enum GroundVapour { GROUND_DRY, GROUND_SOIL, GROUND_LEAVES, GROUND_WATER } GroundVapour;

/* Row of etc/ground_heat.csv, with the optics of its material. */
typedef struct GroundKind {
    char         name[32];
    ColumnLayer  layer[2]; /* above the soil: thatch, paving, snow, water */
    int          layers;
    double       porosity, quartz, saturation; /* of the soil below; porosity 0: rock, of: */
    double       rock_w_mk, rock_j_m3k;
    double       roughness_m;
    GroundVapour vapour;
    double       resistance_s_m; /* of leaves in full sun */
    double       absorptance, emissivity;
    double       melts_k; /* no warmer than this; INFINITY: any */
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
    double sun;      /* share of the direct sun that arrives, 0 .. 1 */
    double sky;      /* share of the hemisphere over the surface that is sky, beyond what its tilt takes, 0 .. 1 */
    double around_k; /* temperature of what fills the rest */
} GroundExposure;

typedef struct GroundColumn {
    const GroundKind    *kind;
    const Column        *column;  /* ground_layers of that kind */
    const ColumnFactors *factors; /* of its usual step; NULL: found at each */
    ColumnState          state;
    double               saturation; /* at the top */
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
void ground_column_step(GroundColumn *column, double tolerance_k, const GroundWeather *before,
                        const GroundWeather *after, const GroundExposure *exposure, double dt_s);
/* Its balance there and then. */
void ground_flux(SurfaceFlux *out, const GroundColumn *column, const GroundWeather *weather,
                 const GroundExposure *exposure);

/* ---- what the ground of each surface class is made of (etc/ground_heat.csv) ------------------ */

/* A SurfaceClass is its own kind; ground that only heat knows follows. */
enum { ground_forest_floor = SURFACE_COUNT, ground_burnt, ground_kinds };

typedef struct GroundKinds {
    GroundKind kind[ground_kinds]; /* [SURFACE_NONE] is as bare soil */
} GroundKinds;

/* path: etc/ground_heat.csv. Every kind must have its row; failures are logged with file, line, column and range. */
Status ground_kinds_open(GroundKinds *out, const char *path, const Materials *materials);
/* Soil and what grows on it, that tracks and wheels tear open. */
static inline bool ground_kind_loosens(int kind) { return surface_loosens(kind) || kind == ground_forest_floor; }
int                ground_kind_find(const char *name); /* -1: none */

/* ---- soil ------------------------------------------------------------------------------------ */

/* Conductivity and heat capacity of soils by their water, and what the water at the top does. */

/* porosity: 0.3 .. 0.9 of the volume; quartz: of the solids, 0 .. 1; saturation: of the pores with water, 0 .. 1.
 * Johansen (1975), as in Peters-Lidard et al., J. Atmos. Sci. 55, 1998: W/(m K), within 25 % of most soils. */
double ground_soil_conductivity_w_mk(double porosity, double quartz, double saturation);
/* Of the volume, J/(m3 K): 2.0e6 of minerals, 4.18e6 of water (de Vries 1963). */
double ground_soil_capacity_j_m3k(double porosity, double saturation);

#endif
