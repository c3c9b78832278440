/* render/scattering/clutter/clutter_table_private.h: what the ground of each surface class sends back to a radar
 * (etc/radar/clutter.csv).
 *
 * Mean backscatter against grazing angle, texture, polarisation, internal motion in wind, and what foliage takes.
 * Figures are the file's, with a source a row; here are the forms they go into, each with its own source. */
#ifndef RENDER_SCATTERING_CLUTTER_CLUTTER_TABLE_PRIVATE_H
#define RENDER_SCATTERING_CLUTTER_CLUTTER_TABLE_PRIVATE_H

#include "terrain/surface.h"

typedef enum ClutterBand { CLUTTER_KU, CLUTTER_KA, CLUTTER_W, CLUTTER_BAND_COUNT } ClutterBand;
typedef enum ClutterModel { CLUTTER_GAMMA, CLUTTER_GIT } ClutterModel;

enum { clutter_texture_nodes = 513 };

typedef struct ClutterRow {
    ClutterModel model;
    double       gamma;         /* of CLUTTER_GAMMA, at VV; a ratio */
    double       a, b, c, d;    /* of CLUTTER_GIT; c in rad */
    double       roughness_m;   /* rms height, sigma_h of CLUTTER_GIT */
    double       nu;            /* shape of the texture; INFINITY: none */
    double       texture_m;     /* distance between its nodes */
    double       hh, hv;        /* mean power over that of VV */
    double       rho;           /* |<hh vv*>| / sqrt(<|hh|^2> <|vv|^2>), its phase 0; hv is independent of both */
    double       motion, still; /* spectral width, and ratio of still to moving power, over those of windblown trees */
    double       extent_m;      /* rms size of what one scatterer stands for, each way: a leaf, a stone */
    double       foliage_db_m;  /* one way, over the first 14 m */
    float        texture[clutter_texture_nodes]; /* ln of the texture at normal deviates -8 .. 8, in equal steps */
} ClutterRow;

typedef struct ClutterTable {
    ClutterRow row[SURFACE_COUNT][CLUTTER_BAND_COUNT]; /* [SURFACE_NONE] is as bare soil */
} ClutterTable;

/* path: etc/radar/clutter.csv. Each class must have one row a band; failures are logged with file, line, column and
 * range, and leave *out as it was. Some 120 KB of stack. */
Status clutter_table_open(ClutterTable *out, const char *path);

const char *clutter_band_name(ClutterBand band); /* Ku, Ka, W */
/* Finds the band of IEEE 521: 12-18, 27-40 or 75-110 GHz. False: the frequency is in none of them. */
bool clutter_band_of(ClutterBand *out, double frequency_hz);

/* Mean cross section of the ground at VV by its area, a ratio; times hh and hv for those. 0 at and below grazing.
 * grazing_rad: between the line of sight and the surface, 0 .. pi/2. Constant gamma: sigma0 = gamma sin(psi) (Long,
 * Radar Reflectivity of Land and Sea, 3rd ed. 2001); GIT: A (psi + C)^B exp(-D / (1 + 0.1 sigma_h / lambda))
 * (Richards, Fundamentals of Radar Signal Processing, 2nd ed., eq. 2.65). */
double clutter_sigma0(const ClutterRow *row, double grazing_rad, double wavelength_m);

/* Texture at a standard normal deviate: gamma-distributed with mean 1 and shape nu where the deviate is normal.
 * Interpolated in its logarithm: within 3e-4 of the exact quantile for nu 0.5 .. 20 and deviates in +-4
 * (test_clutter_table); beyond +-8 held. 1 without texture. */
double clutter_texture(const ClutterRow *row, double deviate);

/* Internal motion in wind: a still part of the power, and one with a two-sided exponential spectrum of velocities,
 * beta / 2 exp(-beta |v|). Source: Billingsley, MIT Lincoln Laboratory TR-1072 (1996): ratio of still to moving
 * power 489.8 w^-1.55 f^-1.21 (w in miles an hour, f in GHz), 1 / beta = 0.1048 (log10 w + 0.4147) m/s, for
 * windblown trees at VHF to X band; above X band this extrapolates. */
typedef struct ClutterMotion {
    double still;      /* share of the power, 0 .. 1 */
    double spread_mps; /* 1 / beta; rms velocity is sqrt(2) of it. 0 where still is 1 */
} ClutterMotion;
ClutterMotion clutter_motion(const ClutterRow *row, double frequency_hz, double wind_mps);
/* Correlation of the complex amplitude over a lag, which is the transform of the spectrum: still + (1 - still) / (1 +
 * (4 pi lag spread / lambda)^2). */
double clutter_correlation(const ClutterMotion *motion, double lag_s, double wavelength_m);

/* ---- foliage ------------------------------------------------------------------------------------- */

/* Loss of a path of depth_m through the foliage, dB, one way: linear for 14 m, then as depth^0.588 (Weissberger,
 * ECAC-TR-81-101, 1982; 0.23-95 GHz, up to 400 m), joined without a step. 0 where the class has none. */
double clutter_foliage_db(const ClutterRow *row, double depth_m);
double clutter_foliage_depth(double depth_m); /* the same of 1 dB/m: the depth that counts */
/* Backscatter of foliage by its volume at VV, m^2/m^3 = 1/m: 2 kappa gamma, kappa the power lost a metre, one way.
 * A canopy of depth h so returns gamma sin(psi) (1 - exp(-2 kappa h / sin psi)) by single scattering: the row's own
 * sigma0 when deep (Attema and Ulaby, Radio Science 13(2), 1978). 0 without foliage, and for rows that are not of
 * constant gamma. */
double clutter_foliage_volume(const ClutterRow *row);

#endif
