/* render/scattering/paths/radar_path.h: what a straight path through the air of a run takes from a radio wave
 * (gases, rain, fog, cloud), and the radar equation.
 *
 * The air is that of the weather at its ground (air temperature, pressure, humidity, rain) and of the atmosphere's
 * model above it. Not here: bending and delay by refraction, which shift elevation and range of a target (300 ppm of
 * the range at the ground) and hardly its loss; scintillation; scatter by rain back to the radar (volume_scatter.h);
 * snow, hail and the melting layer's excess. */
#ifndef RENDER_SCATTERING_PATHS_RADAR_PATH_H
#define RENDER_SCATTERING_PATHS_RADAR_PATH_H

#include "render/air/atmosphere.h"
#include "render/scattering/paths/attenuation.h"
#include "terrain/weather/weather.h"

#include <complex.h>

enum { radar_air_levels = 201, radar_air_liquids = 2 };

static const double radar_frozen_k = 233.15; /* the last droplets freeze */

/* A layer of droplets: fog, cloud. Where it is colder than radar_frozen_k it is ice, and takes nothing. */
typedef struct RadarLiquid {
    double low_m, high_m; /* above the ground; empty unless low < high; high_m INFINITY: no top */
    double g_m3;          /* 0 .. 10 */
} RadarLiquid;

typedef struct RadarAir {
    double      temp_k[radar_air_levels], ln_hpa[radar_air_levels]; /* each 100 m, from the model's ground to 20 km */
    double      vapour_g_m3;                                        /* at the ground */
    double      rain_mm_h, rain_top_m;                              /* rain falls below rain_top_m; 0: none */
    RadarLiquid liquid[radar_air_liquids];
} RadarAir;

/* Temperature: the model's, displaced by the difference at the ground (air_temp_k NaN: none), which fades with height
 * as exp(-h / 2 km). Pressure: hydrostatic, of moist air, from the weather's. Vapour: density falls as exp(-h / 2 km)
 * (ITU-R P.835, reference atmosphere; the model's tables have no vapour), at most saturated. Rain: the weather's, below
 * the highest level of 0 C and 360 m more (P.839-4); where no level is as warm it is snow, and takes nothing. No fog,
 * no cloud: the weather says neither their height nor their water; give them in liquid[]. STATUS_BAD_VALUE for air
 * beyond the ranges of GasState, or rain beyond 300 mm/h. */
Status radar_air_of(RadarAir *out, const Atmosphere *model, const Weather *weather);

/* At a height, clamped to 0 .. 20 km. Pressure is straight in its logarithm between levels, 4e-6 relative. */
void radar_air_at(GasState *out, const RadarAir *air, double height_m);

typedef struct RadarPath {
    double a_m, b_m; /* heights of the ends above the model's ground, 0 .. 20 000 */
    double range_m;  /* 0 .. 1 000 000; raised to |a - b|; straight, over a round Earth of 6371 km */
    double f_ghz;    /* 1 .. 1000; where it passes fog or cloud, 1 .. 200 */
    double tilt_rad; /* polarisation, as in attenuation.h */
} RadarPath;

/* The loss over one way. Everything is NaN for a path outside the ranges; only liquid_db is where just the frequency is
 * out of P.840's. */
typedef struct RadarLoss {
    double dry_db, wet_db, rain_db, liquid_db;
    double
        dispersion_rad; /* phase by the gases' dispersion, beyond that of refractivity at 0 Hz: k integral N' 1e-6 ds */
} RadarLoss;

/* Gauss-Legendre, three points to at most 250 m of height and 10 km of length; against ten times as many each loss is
 * within 1e-5 of itself, 2e-4 where air is saturated on the way, the phase within that and 1e-4, 1e-3 rad
 * (tests/render/test_radar_propagation.c). Rain and layers begin and end exactly. Level, 10 km: 12 us; 20 km straight
 * up: 0.7 ms. */
void radar_path_loss(RadarLoss *out, const RadarPath *path, const GasLines *lines, const RadarAir *air);
/* Does the same with `fine` times as many panels, for tests and benchmarks. */
void radar_path_loss_fine(RadarLoss *out, const RadarPath *path, const GasLines *lines, const RadarAir *air, int fine);

/* Factor of a voltage over the path and back, exp(+j w t); the square of its modulus is the factor of a power. */
double complex       radar_path_factor(const RadarLoss *loss);
static inline double radar_loss_db(const RadarLoss *loss) /* one way, all together */
{
    return loss->dry_db + loss->wet_db + loss->rain_db + loss->liquid_db;
}

/* ---- the radar equation ------------------------------------------------------------------------- */

/* The radar equation: power and voltage of an echo, noise of the receiver.
 *
 * Ratios are plain numbers, not decibels: gains, losses and noise figure. Source: any book on radar, as Skolnik,
 * Introduction to Radar Systems (2001), chapters 1 and 2. */

typedef struct RadarLink {
    double transmitted_w;               /* > 0, during the pulse */
    double transmit_gain, receive_gain; /* > 0, towards the target */
    double wavelength_m;                /* > 0 */
    double range_m;                     /* > 0 */
    double loss; /* >= 1, of power, both ways, of the system; and of the air where `path` is not used */
} RadarLink;

/* Received power, W: Pt Gt Gr lambda^2 sigma / ((4 pi)^3 R^4 L). NaN outside the ranges, and for a cross section below
 * 0. */
double radar_received_w(const RadarLink *link, double rcs_m2);

/* Received wave of a target of scattering amplitude S (render/scattering/scatter.h: sigma = 4 pi |S|^2), sqrt(W),
 * so that the square of its modulus is radar_received_w; phase of 2 R in a vacuum against the transmitter's. path:
 * of radar_path_factor; 1: none. */
double complex radar_voltage(const RadarLink *link, double complex scattering_m, double complex path);

/* Thermal noise at the input, W: k 290 K B F. bandwidth_hz > 0, noise_factor >= 1; NaN outside. */
double radar_noise_w(double bandwidth_hz, double noise_factor);

#endif
