/* render/smoke/smoke.h: smoke, dust, flame and hot gas: what they take of the light of a ray and add to it. */
#ifndef RENDER_SMOKE_SMOKE_H
#define RENDER_SMOKE_SMOKE_H

#include "pitviper.h"
#include "render/scene/hits.h"
#include "render/scene/view.h"
#include "entities/table/snapshot.h"
#include "render/air/air.h"

/* ---- hot gas --------------------------------------------------------------------------------- */

/* Emissivity of hot carbon dioxide and water vapour in the two thermal bands.
 *
 * Band mean, weighted by Planck's law at the gas' own temperature: a sum of grey gases for each gas and band
 * (Hottel & Sarofim 1967),
 *
 *   emissivity = sum_j w_j(T) (1 - exp(-k_j column)),
 *
 * with fixed k_j and weights fitted to the statistical narrow-band model (Malkmus lines, 25 cm-1) with the
 * parameters of Soufiani & Taine, "High temperature gas radiative property parameters of statistical narrow-band
 * model for H2O, CO2 and CO", Int. J. Heat Mass Transfer 40 (1997) 987-991, which come from line-by-line spectra.
 * The two gases overlap at random. Errors and tests: etc/reference/plumes.md, tests/render/test_hot_gas.c. */

typedef enum HotGasBand { HOT_GAS_MWIR, HOT_GAS_LWIR } HotGasBand; /* 3.4 .. 4.8 um, 8 .. 12 um */

/* Partial pressure times length, atm m. */
typedef struct HotGasColumn {
    double co2_atm_m, h2o_atm_m;
} HotGasColumn;

/* Mean emissivity (= absorptivity for radiation of its own temperature), 0 .. 1; temp_k is clamped to 300 .. 2300.
 * At one atmosphere of air with 10 % of each gas. Error of the fit: below 4 % from 1e-3 to 0.1 atm m; of the model
 * itself about 10 % (narrow bands against line by line). At 0.3 atm lines are narrower and the true emissivity is
 * lower, by up to a third. */
double smoke_gas_emissivity(HotGasBand band, HotGasColumn column, double temp_k);

/* ---- along a ray through gas of several temperatures ---------------------------------------- */

enum { hot_gas_terms = 8, hot_gas_passed_nodes = 3 };

/* Weights w_j of one temperature, CO2 and H2O. */
void smoke_gas_weights(double weight[2][hot_gas_terms], HotGasBand band, double temp_k);
/* A ray in one band: of each grey gas what passes the gas so far, exp(-k column); and what CO2 and H2O have taken. */
typedef struct HotGasRay {
    double left[2][hot_gas_terms], taken[2];
} HotGasRay;

void smoke_gas_start(HotGasRay *ray);
/* The ray goes on through a column of gas with these weights. Returns the emissivity of all of it so far: what each
 * piece adds is by its own weights, of what the pieces before it left of each grey gas. At one temperature it is
 * smoke_gas_emissivity of the whole column, however it is cut. */
double smoke_gas_through(HotGasRay *ray, HotGasBand band, HotGasColumn column, const double weight[2][hot_gas_terms]);

/* ---- behind cold air ------------------------------------------------------------------------ */

/* The air's CO2 (420 ppm) absorbs the hot CO2's own lines more than a grey body's spectrum. The ratio of the hot gas'
 * path transmittance to that of a grey body of its temperature, MWIR: 0 .. 1; 1 at no range. Wings beyond the cold
 * band (the red and blue spikes) are what remains. Computed with the same narrow-band model, two layers by Curtis and
 * Godson; interpolated to within 0.05. range_m: of air at sea-level density. LWIR: taken as 1. */
double smoke_gas_passed(double co2_atm_m, double temp_k, double range_m);
/* The same in two steps, for columns that are not known yet: at its nodes of the column; between them. */
void   smoke_gas_passed_at(double at[hot_gas_passed_nodes], double temp_k, double range_m);
double smoke_gas_passed_of(const double at[hot_gas_passed_nodes], double co2_atm_m);

/* atm m of `kg_m2` of a gas of molar mass molar_kg at temp_k, by the ideal gas law. */
double              smoke_gas_atm_m(double kg_m2, double molar_kg, double temp_k);
extern const double hot_gas_co2_molar_kg, hot_gas_h2o_molar_kg;

/* ---- volumes along rays ---------------------------------------------------------------------- */

/* Smoke, dust and flame along rays: out = in * transmittance + added.
 *
 * Smoke is a set of spheroids, each a grey medium of one temperature and albedo a band. Along a ray everything in
 * front of the solid hit is composited in order of depth: the ray is split into segments where volumes begin and
 * end, and within a segment the column of each is exact (a polynomial), so the transmittance is exact whatever
 * overlaps. The source of a segment is the mean of its volumes' sources weighted by their optical depths: exact
 * where volumes are uniform inside or alone, and while there are no more than smoke_segments_max boundaries; beyond
 * that neighbouring segments are merged. tests/render/test_smoke_volume.c.
 *
 * Hot gas is not grey: in the two thermal bands its emissivity follows from the columns of CO2 and H2O that the ray has
 * crossed so far, of all volumes together, and a segment takes what its own column adds to that. So the gas
 * of a ray has the emissivity of its whole column however it is cut, and a piece behind another adds less.
 * tests/render/test_smoke_gas.c. */

/* Bands in the order of entities/traces/effect_puffs.h. */
enum { smoke_bands = 7, smoke_scatter_orders = 3, smoke_segments_max = 24, veil_together = 96 };

/* Hot gas of a volume, of one temperature. */
typedef struct SmokeGas {
    double co2_atm, h2o_atm;             /* at the centre; at one atmosphere */
    double weight[2][2][hot_gas_terms];  /* [HotGasBand][gas] */
    double passed[hot_gas_passed_nodes]; /* smoke_gas_passed_at, for its range */
    double source[2];                    /* as SmokeVolume.source, of the gas alone */
} SmokeGas;

typedef struct SmokeVolume {
    double          p_enu[3], axis_enu[3];
    double          along_m, across_m;             /* half axes */
    double          range_m;                       /* of the centre, from the eye */
    bool            even;                          /* uniform density inside; else (1 - q^2)^2 from centre to surface */
    double          extinction_per_m[smoke_bands]; /* at the centre, without gas */
    const SmokeGas *gas;                           /* of the same shape; NULL: none */
    /* Source radiance of an optically thick piece at the eye, W/(m2 sr), including the air between: emission plus
     * scattered light of the surroundings; half the difference from top to bottom; and sunlight, to be multiplied by
     * exp(-depth / 2^n) of the path to the sun. */
    double source[smoke_bands], from_top[smoke_bands], sun[smoke_bands][smoke_scatter_orders];
    double sun_depth[smoke_bands]; /* optical depth of other volumes towards the sun */
    double d_sun_enu[3];
    double shades_per_m; /* extinction at the centre of the sunlight that falls on what lies below: smoke_shadow */
    double billow, pattern[3]; /* amplitude of the noise pattern; its origin */
} SmokeVolume;

/* Transmittance and radiance of the smoke for each ray of a block. */
typedef struct SmokeRays {
    bool  any;
    float transmittance[smoke_bands][hits_capacity], added[smoke_bands][hits_capacity];
} SmokeRays;

/* Volumes that columns column0_px .. column1_px, rows row0_px .. row1_px may see, nearest first: list holds up to
 * count. volume: sorted by range_m. */
int smoke_cull_block(int *list, const SmokeVolume *volume, int count, const View *view, double column0_px,
                     double row0_px, double column1_px, double row1_px);
/* far_m: of the solid hit of each ray, INFINITY none. bands: 1 << band, those to compute. Of more than veil_together
 * volumes on a ray each further veil_together, in order of range, are composited behind the previous ones:
 * transmittances stay exact, and the added radiance is that of clouds one behind the other. */
void smoke_trace_rays(SmokeRays *out, const SmokeVolume *volume, const int *list, int count, const Rays *rays,
                      const double *far_m, unsigned bands);
void smoke_apply(float *radiance, const SmokeRays *veil, int band, int count);

/* Column of a volume of unit peak density between two distances along o + s d, m; no pattern. */
double smoke_column_m(const SmokeVolume *volume, const double o_enu[3], const double d_enu[3], double from_m,
                      double to_m);

/* Dims the share of the sun's direct light at places by what the volumes in its way leave: exp(-depth) of visible
 * light, without the forward peak of what they scatter, which goes on as the sun does: f = asymmetry^2 of it (delta-
 * Eddington: Joseph, Wiscombe & Weinman, J. Atmos. Sci. 33, 1976). Columns are those of the mean, without pattern; of
 * more than 512 volumes in the way of a block the nearest to the eye count. sun: of each hit, 0 .. 1. */
void smoke_shadow(float *sun, const SmokeVolume *volume, int count, const Hits *hits, const double sun_d_enu[3]);

/* Share that a half space of grains of that albedo, which scatter evenly, sends back of even light: van de Hulst,
 * Multiple Light Scattering (1980), within 0.003 (tests/render/test_smoke_shadow.c). */
double smoke_thick_albedo(double albedo);

/* ---- the volumes of a frame ------------------------------------------------------------------ */

/* The snapshot's puffs as volumes that emit, scatter and absorb: prepared once a frame. */

typedef struct EffectScene {
    int          count;
    SmokeVolume *volume; /* sorted by range */
} EffectScene;

/* How the smoke of a snapshot is seen. */
typedef struct EffectView {
    const LocalFrame *frame;
    const View       *view;
    double            bend_per_m; /* of its rays (terrain/earth/refraction.h); volumes are placed as they are seen */
    const float      *ground_rho; /* of the lit ground below, by optical channel */
    unsigned          bands;      /* 1 << band of smoke.h that will be requested */
    int               hidden; /* snapshot index of the host, -1: none. Its eye does not see its own smoke, as it does
                               * not see its own parts: a missile's reported and interpolated positions differ by
                               * more than its length at launch, and its trail must not appear ahead of its nose */
} EffectView;

/* Finds the volumes inside the view frustum, and lights them. No puffs: count 0, and nothing is done. */
Status smoke_effects_scene(EffectScene *out, const Snapshot *snapshot, const EffectView *seen, const Air *air,
                           Arena *arena);

#endif
