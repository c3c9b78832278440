/* render/radar/gas_attenuation.h: what the gases of air take from a radio wave: Recommendation ITU-R P.676-13, Annex 1,
 * line by line: oxygen, water vapour, and the continuum of dry air. */
#ifndef RENDER_RADAR_GAS_ATTENUATION_H
#define RENDER_RADAR_GAS_ATTENUATION_H

#include "pitviper.h"

enum { gas_lines_max = 64 };

/* Coefficient k of line i is c[k][i]: a1 .. a6 of oxygen, b1 .. b6 of water, as P.676-13 numbers them. */
typedef struct GasLineList {
    int count;
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

/* Water vapour: partial pressure, hPa, of a density, g/m3, at a temperature (P.676-13, eq. 4). */
static inline double gas_vapour_hpa(double density_g_m3, double temp_k) { return density_g_m3 * temp_k / 216.7; }

#endif
