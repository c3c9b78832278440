/* render/scattering/paths/attenuation.h: what the gases of air, the droplets of cloud and fog, and rain take from a
 * radio wave, by length. */
#ifndef RENDER_SCATTERING_PATHS_ATTENUATION_H
#define RENDER_SCATTERING_PATHS_ATTENUATION_H

#include "pitviper.h"

#include <complex.h>

/* ---- gases -------------------------------------------------------------------------------------- */

/* Absorption by Recommendation ITU-R P.676-13, Annex 1, line by line: oxygen, water vapour, and the continuum of dry
 * air. */
enum { gas_lines_max = 64 };

/* Coefficient k of line i is c[k][i]: a1 .. a6 of oxygen, b1 .. b6 of water, as P.676-13 numbers them. */
typedef struct GasLineList {
    int    count;
    double f_ghz[gas_lines_max], c[6][gas_lines_max];
} GasLineList;

typedef struct GasLines {
    GasLineList oxygen, water;
} GasLines;

/* Tables of lines; NULL: etc/radar/oxygen_lines.csv, etc/radar/water_lines.csv. Failures (a column missing, a value out
 * of range, lines that do not rise in frequency) are logged with file and line. */
Status gas_lines_read(GasLines *out, const char *oxygen_path, const char *water_path);

/* State of air: partial pressures of dry air and of water vapour, whose sum is the barometric pressure. */
typedef struct GasState {
    double dry_hpa;    /* 0 .. 1200 */
    double vapour_hpa; /* 0 .. 150 */
    double temp_k;     /* 150 .. 350 */
} GasState;

typedef struct GasAttenuation {
    double dry_db_km, wet_db_km; /* one way */
    /* Dispersive part of the refractive index, in parts per million: refractivity at this frequency less that at 0 Hz,
     * of the same lines and of the Debye term of dry air. That of pressure-induced nitrogen is left out (below 0.002
     * ppm). */
    double dry_ppm, wet_ppm;
} GasAttenuation;

/* f_ghz 1 .. 1000. All NaN outside these ranges. About 3 us.
 * Attenuation: relative difference to the validation values of ITU-R SG 3 for P.676-13 (1 to 349 GHz, 1013.25 hPa,
 * 288.15 K, 7.5 g/m3) below 1e-12; dispersion: within 0.002 ppm of what causality (Kramers and Kronig) derives from the
 * attenuation (tests/render/test_radar_propagation.c). */
void gas_attenuation(GasAttenuation *out, const GasLines *lines, double f_ghz, const GasState *air);

/* Partial pressure of water vapour, hPa, from its density, g/m3, at a temperature (P.676-13, eq. 4). */
static inline double gas_vapour_hpa(double density_g_m3, double temp_k) { return density_g_m3 * temp_k / 216.7; }

/* ---- cloud and fog ------------------------------------------------------------------------------ */

/* Recommendation ITU-R P.840-9 (08/2023): Rayleigh absorption by liquid water with its double-Debye permittivity. */

/* Relative permittivity e' - j e'' of liquid water, exp(+j w t): P.840-9, eqs. 4 to 11 (double Debye, after Liebe).
 *   f_ghz   1 .. 200
 *   temp_k  233.15 .. 323.15; NaN outside */
double complex water_permittivity(double f_ghz, double temp_k);

/* Specific attenuation coefficient K_l, dB/km one way for 1 g/m3 of liquid water.
 *   f_ghz   1 .. 200: droplets below 0.1 mm are small against the wavelength
 *   temp_k  of the droplets, 233.15 (where the last freeze) .. 323.15
 *   returns NaN outside
 * Relative difference to values of ITU-Rpy, printed to ten digits, below 1e-9 (5 to 183 GHz, -8 to 30 C;
 * tests/render/test_radar_propagation.c). */
double cloud_attenuation(double f_ghz, double temp_k);

/* Liquid water of fog, g/m3, from the visibility (2 % contrast, as weather.visibility_m): Kunkel, J. Climate Appl.
 * Meteor. 23 (1984) 34: extinction = 144.7 W^0.88 per km, of measured advection fogs. Fog is what leaves 1000 m or
 * less: 0 above, which steps from 0.017 g/m3. NaN below 10 m. Fogs of one visibility differ by a factor of two and
 * more, as their droplets do. */
double fog_liquid_g_m3(double visibility_m);

/* ---- rain --------------------------------------------------------------------------------------- */

/* Recommendation ITU-R P.838-3 (2005), k R^alpha. */

/* Coefficients for a path and a linear or circular polarisation.
 *   f_ghz          1 .. 1000
 *   elevation_rad  of the path, -pi / 2 .. pi / 2; its sign does not matter
 *   tilt_rad       of the electric field against the horizontal: 0 horizontal, pi / 2 vertical, pi / 4 circular too
 * False, and NaN, outside these ranges. k in dB/km of mm/h. Within half a unit of the last printed digit of the
 * examples of ITU-R SG 3 for P.838-3 (tests/render/test_radar_propagation.c); P.838 itself fits T-matrix results of one
 * distribution of drop sizes (Laws and Parsons): real rain scatters by tens of percent about it. */
bool rain_coefficients(double *k, double *alpha, double f_ghz, double elevation_rad, double tilt_rad);

/* Attenuation by rain, dB/km, one way. rain_mm_h 0 .. 300; NaN outside. A call takes about 1 us. */
double rain_attenuation(double f_ghz, double rain_mm_h, double elevation_rad, double tilt_rad);

#endif
