/* render/air.h: sun, sky and the path, per frame: the light that falls on the scene and the air before it.
 *
 * A first model, where the tables of a later version will sit: Koschmieder in the visible, two coefficients a
 * thermal band, a sky of single scattering. Sources and errors of every figure: air.c. */
#ifndef RENDER_AIR_H
#define RENDER_AIR_H

#include "render/materials.h"
#include "render/planck.h"
#include "terrain/sun.h"
#include "terrain/weather.h"

/* What one band's path does to what is behind it: out = in * transmittance + added. */
typedef struct Veil {
    double transmittance, added_w_m2_sr;
} Veil;

/* Thermal sky radiance at d_up = (i / air_sky_steps)^2, i = 0 .. air_sky_steps: dense at the horizon. */
enum { air_sky_steps = 64 };

typedef struct Air {
    Weather weather;
    double  sun_d_enu[3];                              /* towards the sun; below the horizon: no direct light */
    double  sun_w_m2[optical_channel_count];           /* direct, on a plane facing the sun, at the ground */
    double  sky_w_m2[optical_channel_count];           /* diffuse, on a horizontal plane */
    double  extinction_per_m[optical_channel_count];
    /* -ln(transmittance) = extinction * range + saturating * sqrt(range): the root is of lines that are
     * already black at their centres (MWIR: of the fourth degree, range^0.25) */
    double  extinction_mwir_per_m, extinction_lwir_per_m;
    double  saturating_mwir, saturating_lwir;
    double  sun_mwir_w_m2;                             /* direct in 3.4-4.8 um */
    const PlanckTable *planck_mwir, *planck_lwir;

    /* shape of the optical sky */
    double  sky_depth[optical_channel_count], sky_scale[optical_channel_count];
    double  horizon_w_m2_sr[optical_channel_count];    /* mean over azimuth: what a long path fades to */
    /* thermal surroundings, W/(m2 sr): air and its veil, ground seen from below, sky by height and its mean */
    double  air_mwir_w_m2_sr, air_lwir_w_m2_sr, ground_mwir_w_m2_sr, ground_lwir_w_m2_sr;
    double  sky_mwir_w_m2_sr[air_sky_steps + 1], sky_lwir_w_m2_sr[air_sky_steps + 1];
    double  sky_mean_mwir_w_m2_sr, sky_mean_lwir_w_m2_sr; /* irradiance on a horizontal plane / pi */
    /* all wavelengths, for temperatures: direct facing the sun, diffuse, net thermal loss of a horizontal plane */
    double  solar_direct_w_m2, solar_diffuse_w_m2, longwave_loss_w_m2;
} Air;

/* About 10 us; once a frame. */
void air_at(Air *out, const Weather *weather, const Sun *sun, const PlanckTable *mwir, const PlanckTable *lwir);
/* Sky radiance towards a unit direction, W/(m2 sr); below the horizon: the horizon's. */
double air_sky_optical(const Air *air, int channel, const double d_enu[3]);
double air_sky_mwir(const Air *air, double d_up);  /* d_up: the direction's z */
double air_sky_lwir(const Air *air, double d_up);
/* Share of the direct sun's irradiance that arrives from a direction, 1/sr: its disc has one brightness. */
double air_sun_disc(const Air *air, const double d_enu[3]);
Veil   air_veil_optical(const Air *air, int channel, double range_m);
Veil   air_veil_mwir(const Air *air, double range_m);
Veil   air_veil_lwir(const Air *air, double range_m);

#endif
