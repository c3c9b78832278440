/* render/air/air.h: the air of a frame: the light of sun and sky, and the paths from an eye to what it sees. */
#ifndef RENDER_AIR_AIR_H
#define RENDER_AIR_AIR_H

#include "render/air/atmosphere.h"
#include "render/air/droplets.h"
#include "render/scene/hits.h"
#include "render/materials/materials.h"
#include "render/materials/planck.h"
#include "terrain/earth/sun.h"
#include "terrain/weather/weather.h"
#include "render/scene/view.h"

/* ---- daylight -------------------------------------------------------------------------------- */

/* Light of sun and sky, and air temperature, for a position, time and weather, independent of
 * the eye.
 *
 * Everything comes from the tables of render/air/atmosphere.h. Sums (the sun's light, the whole sky's on level ground,
 * the air's temperature, what ground loses to the sky) are computed directly; the sky by direction, and its irradiance
 * on a tilted plane, are tables interpolated for the requested bands. tests/render/test_air.c measures their errors.
 * Heights are above the ground at the terrain's origin, which is at the model's 0 km.
 *
 * Weather. Haze is the model's at the visibility given (weather's here is that of the haze: droplets_haze_m), beside
 * the drops of rain, snow and fog; clear air follows temperature and humidity at the ground (atmosphere_in). What the
 * air's profiles do not reach scales the thermal radiance of path and sky by the ratio of the two Planck radiances in
 * the band, and the longwave flux by that of the fourth powers. With height the air's temperature changes as the
 * profiles' does. Clouds are a mean: the direct sun is dimmed by their share, sun and sky together by 1 - 0.75
 * cloud^3.4 (Kasten & Czeplak, Solar Energy 24, 1980), in every band and towards every direction alike; they fill that
 * share of the thermal sky with air temperature, and longwave follows Unsworth & Monteith (Q. J. R. Meteorol. Soc. 101,
 * 1975). Measured radiation (Weather) takes the place of both. */

/* Sky radiance, without the sun's disc: thermal[height] + around_sun[angle from the sun] *
 * scattered[height][azimuth]. d_up = (i / air_sky_ups)^2, dense at the horizon; equal steps of azimuth from the
 * sun's, 0 .. pi; angle from the sun pi (i / air_sky_angles)^2: the bright ring about it needs its own. Light on a
 * plane: over (1 + n_up) / 2, the share of the sky that it sees, so that a uniform sky is exact; by azimuth, and by
 * tilt, dense where a plane is level: equal steps of sin(tilt / 2), and beyond a wall's tilt of cos(tilt / 2), which
 * are linear in small tilts where n_up is not. */
enum { air_sky_ups = 24, air_sky_azimuths = 12, air_sky_angles = 24, air_plane_ups = 16, air_plane_azimuths = 12 };

typedef struct AirSky {
    float thermal_w_m2_sr[air_sky_ups + 1], scattered_w_m2_sr[air_sky_ups + 1][air_sky_azimuths + 1];
    float around_sun[air_sky_angles + 2]; /* one to spare at the end */
} AirSky;

/* The same from a height between the horizontal and the Earth's edge, in two stacks of rows: of rays that are lowest
 * below 20 km, the tables' top, and above it to 64 km, beyond which there is no more to see. With a = h (2 R + h) of a
 * ray's lowest point h and the Earth's radius R, a stack has equal steps of the angle whose squared cosine is a over
 * its range from the lowest to the highest ray: linear in the rate of climb where that is, and in the angle from the
 * edge where the air is thick. Row 0 of the upper one that is not empty is the sky's lowest. */
enum { air_limb_stacks = 2, air_limb_steps = 64 };
typedef struct AirLimb {
    int   steps[air_limb_stacks]; /* rows but one, 0: none; more of them from higher up */
    float thermal_w_m2_sr[air_limb_stacks][air_limb_steps + 1];
    float scattered_w_m2_sr[air_limb_stacks][air_limb_steps + 1][air_sky_azimuths + 1];
} AirLimb;

/* Air temperature by height: 0 .. 16 km in steps of 500 m; as at 16 km above. */
enum { air_warmer_nodes = 33 };

/* daylight_at fills in the members before the tables. */
typedef struct Daylight {
    Weather weather;
    double  sun_d_enu[3];                   /* towards the sun; below the horizon: no direct light */
    double  sun_w_m2[AIR_BAND_COUNT];       /* direct, on a plane facing the sun, at the ground */
    double  sky_w_m2[AIR_BAND_COUNT];       /* of the sky on a level plane; with tables: the integral of its radiance */
    double  ground_w_m2_sr[AIR_BAND_COUNT]; /* thermal bands: of ground seen from below, and of ground beyond the
                                             * terrain's edge. Others: 0, since it depends on the materials */
    double ground_k;                        /* of level ground there; 0: not known */
    /* all wavelengths, for temperatures: direct facing the sun, diffuse, net thermal loss of a horizontal plane */
    double solar_direct_w_m2, solar_diffuse_w_m2, longwave_loss_w_m2;
    double zero_z_m;                   /* ENU z of the model's 0 km; heights bend with the Earth: daylight_height */
    float  warmer_k[air_warmer_nodes]; /* of the air every 500 m up from there, against weather.air_temp_k */
    const PlanckTable *planck_mwir, *planck_lwir;
    double             day_zenith_rad;   /* of the sun, at which the tables are evaluated */
    double             sun_above;        /* share of its disc above the horizon, over the square of its distance */
    double             thermal_scale[2]; /* air of another temperature than the model's */
    double             scattered_scale[AIR_BAND_COUNT]; /* twilight, the sun's distance, sky_scale */
    Droplets           droplets;                        /* rain, snow, fog; the totals have them */
    double cloud_sky, cloud_thermal; /* clouds: factor on the sky's scattered light; share of the thermal sky that
                                      * is cloud of air temperature */

    /* by direction; only of the requested bands */
    AirSky sky[AIR_BAND_COUNT]; /* from the ground: what lights the scene, and is mirrored in it */
    /* Irradiance and radiance of the scattered light in the tables come from two computations: one of discrete
     * ordinates, and LOWTRAN's two streams, which are too dark under a low sun. All that is scattered, sky and paths
     * from any eye, is the radiance times this factor, with which the sky's integral is its irradiance; 1 until the sky
     * is summed. */
    double sky_scale[AIR_BAND_COUNT];
    float  plane_w_m2[AIR_BAND_COUNT][air_plane_ups + 1][air_plane_azimuths + 1]; /* tilted plane, over its share */
    const struct AirDay *day;        /* what the tables were made from; in the arena. NULL: none */
    const Atmosphere    *atmosphere; /* that of the weather, in the arena as well */
} Daylight;

/* Data that does not change between frames. */
typedef struct AirSource {
    const Atmosphere  *atmosphere;
    const PlanckTable *planck_mwir, *planck_lwir;
    double             ground_k; /* of level ground seen from below; 0: of the air */
    double             ground_m; /* of the ground above the sea, for the sunlight of all wavelengths */
} AirSource;

/* Totals alone, of pan and all wavelengths, and the air's temperature: microseconds, no arena (bench speed: daylight).
 * weather->air_temp_k: NaN for the model's own; the Daylight's is then filled in. */
void daylight_at(Daylight *out, const AirSource *source, const Weather *weather, const Sun *sun);
/* The atmosphere under a weather, as daylight and paths have it: atmosphere_in of render/air/atmosphere.h. */
Status daylight_air(const Atmosphere **out, const Atmosphere *model, const Weather *weather, unsigned bands,
                    Arena *arena);
/* And the tables by direction of these bands (1 << AirBand). pool: may be NULL. STATUS_NO_MEMORY: of the arena, in
 * which the AirDay lives. */
Status daylight_by_direction(Daylight *out, const AirSource *source, const Weather *weather, const Sun *sun,
                             unsigned bands, Pool *pool, Arena *arena);

/* low: steps below zero onto which the first one is extended */
static const double air_warmer_step_m = 500, air_warmer_low = -4;

/* Height of a position above the model's 0 km: the tangent plane leaves the Earth. */
static inline double daylight_height(const Daylight *light, const double p_enu[3])
{
    return p_enu[2] + (p_enu[0] * p_enu[0] + p_enu[1] * p_enu[1]) / (2 * earth_radius_m) - light->zero_z_m;
}
/* Air temperature there, K. */
static inline double daylight_temp_at(const Daylight *light, const double p_enu[3])
{
    const double at = clamp(daylight_height(light, p_enu) / air_warmer_step_m, air_warmer_low, air_warmer_nodes - 1);
    const int    i = at < 0 ? 0 : at < air_warmer_nodes - 2 ? (int)at : air_warmer_nodes - 2;
    const double low_k = (double)light->warmer_k[i], high_k = (double)light->warmer_k[i + 1];
    return light->weather.air_temp_k + low_k + (at - i) * (high_k - low_k);
}

/* Position of a direction in the tables of the sky, and of a plane's normal in those of its irradiance: the same for
 * every band, so that it is computed once for several. */
typedef struct SkyPlace {
    int   up, azimuth, angle; /* lower nodes; shares of the upper ones */
    float up_share, azimuth_share, angle_share;
} SkyPlace;
typedef struct PlanePlace {
    int   up, azimuth;
    float up_share, azimuth_share, open; /* open: factor on its unobstructed sky */
} PlanePlace;
void daylight_sky_place(SkyPlace *out, const Daylight *light, const double d_enu[3]);
void daylight_plane_place(PlanePlace *out, const Daylight *light, const double n_enu[3]);

/* Both for each hit of a block: of its normal, and of its mirror direction, where it has any gloss. */
typedef struct Facing {
    PlanePlace plane[hits_capacity];
    SkyPlace   mirror[hits_capacity];
} Facing;
void daylight_facing(Facing *out, const Daylight *light, const Materials *materials, const Hits *hits, const Rays *rays,
                     const uint16_t *material);

static inline double daylight_sky_there(const AirSky *sky, const SkyPlace *p)
{
    const float *low = &sky->scattered_w_m2_sr[p->up][p->azimuth], *high = low + air_sky_azimuths + 1;
    const float *around = &sky->around_sun[p->angle], *thermal = &sky->thermal_w_m2_sr[p->up];
    const float  l = low[0] + p->azimuth_share * (low[1] - low[0]);
    const float  h = high[0] + p->azimuth_share * (high[1] - high[0]);
    return (double)(thermal[0] + p->up_share * (thermal[1] - thermal[0]) +
                    (l + p->up_share * (h - l)) * (around[0] + p->angle_share * (around[1] - around[0])));
}

static inline double daylight_plane_there(const Daylight *light, AirBand band, const PlanePlace *p)
{
    const float *low = &light->plane_w_m2[band][p->up][p->azimuth], *high = low + air_plane_azimuths + 1;
    const float  l = low[0] + p->azimuth_share * (low[1] - low[0]);
    const float  h = high[0] + p->azimuth_share * (high[1] - high[0]);
    return (double)(p->open * (l + p->up_share * (h - l)));
}

/* Sky radiance towards a unit direction, W/(m2 sr), as the ground sees it; below the horizon: the horizon's. Its
 * integral is daylight_on_plane. */
double daylight_sky(const Daylight *light, AirBand band, const double d_enu[3]);
/* Irradiance of the sky on a plane of this unit normal, W/m2; half of it, and more, may be below the horizon. */
double daylight_on_plane(const Daylight *light, AirBand band, const double n_enu[3]);

/* Diffuse light on the far side of a leaf, sky and ground of that irradiance below, W/m2. */
static inline double daylight_far_side(const Daylight *light, AirBand band, const double n_enu[3], double ground_w_m2)
{
    const double back_enu[3] = {-n_enu[0], -n_enu[1], -n_enu[2]};
    return daylight_on_plane(light, band, back_enu) + ground_w_m2 * 0.5 * (1 + n_enu[2]);
}
/* Share of the direct sun's irradiance from a direction, 1/sr: its disc has uniform radiance. */
double daylight_sun_disc(const Daylight *light, const double d_enu[3]);

/* ---- paths from an eye ----------------------------------------------------------------------- */

/* The air of one eye, per frame: daylight, the sky from its height, and the air paths to what it sees.
 *
 * Paths come from the tables of render/air/atmosphere.h, reduced once a frame for one eye, one sun and one
 * visibility to tables small enough for a look-up per sample. tests/render/test_air.c measures the loss of accuracy. */

typedef struct AirTable AirTable; /* paths from this eye */

enum { air_above_steps = 16 };

typedef struct Air {
    Daylight light;
    AirSky   sky_eye[AIR_BAND_COUNT];      /* from the eye, down to the horizontal */
    AirLimb  limb[AIR_BAND_COUNT];         /* below it, of an eye of ten metres and more */
    double   sun_eye_w_m2[AIR_BAND_COUNT]; /* direct irradiance at the eye: gives the radiance of the sun's visible
                                            * disc */
    float above_w_m2_sr[2][air_above_steps + 1];     /* of mwir, lwir: what the air above the tables' top adds to a path
                                                      * from an eye there; by the way's share of that to the edge */
    float     below_w_m2_sr[2][air_above_steps + 1]; /* likewise: the radiance of that path below the top */
    double    eye_height_m;                          /* above the model's 0 km; any */
    AirTable *table;                    /* in the arena of air_at; NULL: homogeneous atmosphere, see air_even */
    const struct HeatScene *heat;       /* of the ground (render/heat/heat.h); NULL: all of it as warm as the air */
    double                  even_per_m; /* extinction of a homogeneous atmosphere, whose radiance is that of its
                                         * sky */
} Air;

/* Parameters of an eye. */
typedef struct AirEye {
    double   height_m; /* from 0 (clamped) up; above the tables' top, 20 km, its paths begin where they enter the air */
    unsigned bands;    /* 1 << AirBand, the requested bands; air_path gives no others */
    const View *view;  /* view, so that only its azimuths are computed; NULL: all round */
} AirEye;

/* weather->air_temp_k: NaN for the model's own; the Daylight's is then filled in. pool: may be NULL. The tables are
 * in the arena. STATUS_NO_MEMORY when that is out. 1 to 2 ms of one core for five bands, 0.4 for LWIR alone; over
 * the pool. */
Status air_at(Air *out, const AirSource *source, const Weather *weather, const Sun *sun, const AirEye *eye, Pool *pool,
              Arena *arena);

/* A world with closed-form results: sun_w_m2 from sun_d_enu, everything else, path included, of the one radiance
 * sky_w_m2_sr[band]; even_per_m 0: a vacuum. No tables, no arena. */
void air_even(Air *out, const double sun_d_enu[3], double sun_w_m2, const double sky_w_m2_sr[AIR_BAND_COUNT],
              double even_per_m, const PlanckTable *mwir, const PlanckTable *lwir);

/* Transmittance and path radiance of the air in front of a surface: seen = emitted * transmittance + sunlight
 * reflected * sun_transmittance + air's light reflected * air_transmittance + added. Outside the thermal bands the
 * three are one; at night, and always in LWIR, sun_transmittance is the air's. A ray without a hit ends on the
 * ground beyond the terrain's edge, when it goes down far enough to reach the round Earth (its range is then in
 * range_m), or in the sky: transmittance 0, and added is the sky's radiance. */
typedef struct AirPaths {
    float transmittance[hits_capacity], sun_transmittance[hits_capacity], air_transmittance[hits_capacity];
    float added_w_m2_sr[hits_capacity];
    float range_m[hits_capacity]; /* of the path; INFINITY: sky */
} AirPaths;

/* bands: 1 << AirBand, those of out to fill, of the AirEye's; several bands in one call cost less, with the same
 * bits. temp_k: of the emitters, [hits->count], NaN where nothing emits; NULL: nothing emits (transmittance: the
 * sun's). */
void air_paths_of(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const Hits *hits, const Rays *rays,
                  const float *temp_k);
/* The same, computed from the atmosphere path by path, without the frame's tables: air.c. A microsecond or
 * two a ray. tables: the result of air_paths_of for these rays. Homogeneous atmosphere: the same as with tables. */
void air_paths_directly(AirPaths out[AIR_BAND_COUNT], const Air *air, unsigned bands, const Hits *hits,
                        const Rays *rays, const float *temp_k, const AirPaths tables[AIR_BAND_COUNT]);
/* One band. */
void air_path(AirPaths *out, const Air *air, AirBand band, const Hits *hits, const Rays *rays, const float *temp_k);

#endif
