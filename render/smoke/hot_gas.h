/* render/smoke/hot_gas.h: emissivity of hot carbon dioxide and water vapour in the two thermal bands.
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
#ifndef RENDER_SMOKE_HOT_GAS_H
#define RENDER_SMOKE_HOT_GAS_H

#include "pitviper.h"

typedef enum HotGasBand { HOT_GAS_MWIR, HOT_GAS_LWIR } HotGasBand; /* 3.4 .. 4.8 um, 8 .. 12 um */

/* Partial pressure times length, atm m. */
typedef struct HotGasColumn {
    double co2_atm_m, h2o_atm_m;
} HotGasColumn;

/* Mean emissivity (= absorptivity for radiation of its own temperature), 0 .. 1; temp_k is clamped to 300 .. 2300.
 * At one atmosphere of air with 10 % of each gas. Error of the fit: below 4 % from 1e-3 to 0.1 atm m; of the model
 * itself about 10 % (narrow bands against line by line). At 0.3 atm lines are narrower and the true emissivity is
 * lower, by up to a third. */
double hot_gas_emissivity(HotGasBand band, HotGasColumn column, double temp_k);

/* ---- along a ray through gas of several temperatures ---------------------------------------- */

enum { hot_gas_terms = 8, hot_gas_passed_nodes = 3 };

/* Weights w_j of one temperature, CO2 and H2O. */
void hot_gas_weights(double weight[2][hot_gas_terms], HotGasBand band, double temp_k);
/* A ray in one band: of each grey gas what passes the gas so far, exp(-k column); and what CO2 and H2O have taken. */
typedef struct HotGasRay {
    double left[2][hot_gas_terms], taken[2];
} HotGasRay;

void hot_gas_start(HotGasRay *ray);
/* The ray goes on through a column of gas with these weights. Returns the emissivity of all of it so far: what each
 * piece adds is by its own weights, of what the pieces before it left of each grey gas. At one temperature it is
 * hot_gas_emissivity of the whole column, however it is cut. */
double hot_gas_through(HotGasRay *ray, HotGasBand band, HotGasColumn column, const double weight[2][hot_gas_terms]);

/* ---- behind cold air ------------------------------------------------------------------------ */

/* The air's CO2 (420 ppm) absorbs the hot CO2's own lines more than a grey body's spectrum. The ratio of the hot gas'
 * path transmittance to that of a grey body of its temperature, MWIR: 0 .. 1; 1 at no range. Wings beyond the cold
 * band (the red and blue spikes) are what remains. Computed with the same narrow-band model, two layers by Curtis and
 * Godson; interpolated to within 0.05. range_m: of air at sea-level density. LWIR: taken as 1. */
double hot_gas_passed(double co2_atm_m, double temp_k, double range_m);
/* The same in two steps, for columns that are not known yet: at its nodes of the column; between them. */
void   hot_gas_passed_at(double at[hot_gas_passed_nodes], double temp_k, double range_m);
double hot_gas_passed_of(const double at[hot_gas_passed_nodes], double co2_atm_m);

/* atm m of `kg_m2` of a gas of molar mass molar_kg at temp_k, by the ideal gas law. */
double hot_gas_atm_m(double kg_m2, double molar_kg, double temp_k);
extern const double hot_gas_co2_molar_kg, hot_gas_h2o_molar_kg;

#endif
