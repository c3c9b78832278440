/* render/smoke/smoke_volume.h: smoke, dust and flame along rays: out = in * transmittance + added.
 *
 * Smoke is a set of spheroids, each a grey medium of one temperature and albedo a band. Along a ray everything in
 * front of the solid hit is composited in order of depth: the ray is split into segments where volumes begin and
 * end, and within a segment the column of each is exact (a polynomial), so the transmittance is exact whatever
 * overlaps. The source of a segment is the mean of its volumes' sources weighted by their optical depths: exact
 * where volumes are uniform inside or alone, and while there are no more than smoke_segments_max boundaries; beyond
 * that neighbouring segments are merged. tests/render/test_smoke_volume.c.
 *
 * Hot gas is not grey: in the two thermal bands its emissivity follows from the columns of CO2 and H2O that the ray has
 * crossed so far, of all volumes together (hot_gas.h), and a segment takes what its own column adds to that. So the gas
 * of a ray has the emissivity of its whole column however it is cut, and a piece behind another adds less.
 * tests/render/test_smoke_gas.c. */
#ifndef RENDER_SMOKE_SMOKE_VOLUME_H
#define RENDER_SMOKE_SMOKE_VOLUME_H

#include "render/scene/hits.h"
#include "render/scene/view.h"
#include "render/smoke/hot_gas.h"

/* Bands in the order of entities/traces/effect_puffs.h. */
enum { smoke_bands = 7, smoke_scatter_orders = 3, smoke_segments_max = 24, veil_together = 96 };

/* Hot gas of a volume, of one temperature. */
typedef struct SmokeGas {
    double co2_atm, h2o_atm;                 /* at the centre; at one atmosphere */
    double weight[2][2][hot_gas_terms];      /* [HotGasBand][gas] */
    double passed[hot_gas_passed_nodes];     /* hot_gas_passed_at, for its range */
    double source[2];                        /* as SmokeVolume.source, of the gas alone */
} SmokeGas;

typedef struct SmokeVolume {
    double p_enu[3], axis_enu[3];
    double along_m, across_m;              /* half axes */
    double range_m;                        /* of the centre, from the eye */
    bool   even;                           /* uniform density inside; else (1 - q^2)^2 from centre to surface */
    double extinction_per_m[smoke_bands];   /* at the centre, without gas */
    const SmokeGas *gas;                   /* of the same shape; NULL: none */
    /* Source radiance of an optically thick piece at the eye, W/(m2 sr), including the air between: emission plus
     * scattered light of the surroundings; half the difference from top to bottom; and sunlight, to be multiplied by
     * exp(-depth / 2^n) of the path to the sun. */
    double source[smoke_bands], from_top[smoke_bands], sun[smoke_bands][smoke_scatter_orders];
    double sun_depth[smoke_bands];          /* optical depth of other volumes towards the sun */
    double d_sun_enu[3];
    double billow, pattern[3];             /* amplitude of the noise pattern; its origin */
} SmokeVolume;

/* Transmittance and radiance of the smoke for each ray of a block. */
typedef struct SmokeRays {
    bool  any;
    float transmittance[smoke_bands][hits_capacity], added[smoke_bands][hits_capacity];
} SmokeRays;

/* Volumes that columns column0_px .. column1_px, rows row0_px .. row1_px may see, nearest first: list holds up to
 * count. volume: sorted by range_m. */
int  smoke_cull_block(int *list, const SmokeVolume *volume, int count, const View *view, double column0_px, double row0_px,
                double column1_px, double row1_px);
/* far_m: of the solid hit of each ray, INFINITY none. bands: 1 << band, those to compute. Of more than veil_together
 * volumes on a ray each further veil_together, in order of range, are composited behind the previous ones:
 * transmittances stay exact, and the added radiance is that of clouds one behind the other. */
void smoke_trace_rays(SmokeRays *out, const SmokeVolume *volume, const int *list, int count, const Rays *rays,
               const double *far_m, unsigned bands);
void smoke_apply(float *radiance, const SmokeRays *veil, int band, int count);

/* Column of a volume of unit peak density between two distances along o + s d, m; no pattern. */
double smoke_column_m(const SmokeVolume *volume, const double o_enu[3], const double d_enu[3], double from_m,
                     double to_m);

#endif
