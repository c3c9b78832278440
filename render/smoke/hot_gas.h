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
/* Grey optical depth with which a column has `seen` (0 .. 1) times its emissivity: -ln(1 - seen emissivity). Gas is not
 * grey: scaled to shorter chords of the same volume it is too transparent (plumes.md). */
double hot_gas_depth(HotGasBand band, HotGasColumn column, double temp_k, double seen);

/* The air's CO2 (420 ppm) absorbs the hot CO2's own lines more than a grey body's spectrum. The ratio of the hot gas'
 * path transmittance to that of a grey body of its temperature, MWIR: 0 .. 1; 1 at no range. Wings beyond the cold
 * band (the red and blue spikes) are what remains. Computed with the same narrow-band model, two layers by Curtis and
 * Godson; interpolated to within 0.05. range_m: of air at sea-level density. LWIR: taken as 1. */
double hot_gas_passed(double co2_atm_m, double temp_k, double range_m);

/* atm m of `kg_m2` of a gas of molar mass molar_kg at temp_k, by the ideal gas law. */
double hot_gas_atm_m(double kg_m2, double molar_kg, double temp_k);
extern const double hot_gas_co2_molar_kg, hot_gas_h2o_molar_kg;

#endif
