/* render/air/atmosphere_day.h: an atmosphere at one visibility and one sun position, for the hundreds of evaluations of
 * a frame.
 *
 * The results of atmosphere_path and atmosphere_sky (within 1e-12 of them: tests/render/test_atmosphere_day.c), at a
 * tenth of the cost: the sun's position is looked up in every table once, a point of a path serves all bands, a path
 * all azimuths and all temperatures. */
#ifndef RENDER_AIR_ATMOSPHERE_DAY_H
#define RENDER_AIR_ATMOSPHERE_DAY_H

#include "render/air/atmosphere.h"

enum { day_temps_max = 8, day_azimuths_max = 16 };

typedef struct AirDay AirDay;

/* bands: 1 << AirBand, those to be computed; sun_zenith_rad: > pi / 2: nothing is scattered. temp_k: of emitters,
 * [temps]. Lives in the arena; a pure function of its arguments. STATUS_NO_MEMORY. 20 to 50 us. */
Status air_day_at(const AirDay **out, const Atmosphere *atmosphere, double visibility_m, double sun_zenith_rad,
                  unsigned bands, const double *temp_k, int temps, Arena *arena);

/* Of one path: ln(1 / tau). */
typedef struct DayPath {
    double sun[AIR_BAND_COUNT];                                         /* of sunlight */
    double emitted[2][day_temps_max];                                   /* of emitters; mwir, lwir */
    double thermal_w_m2_sr[2];                                          /* the air's own radiance */
} DayPath;
void air_day_path(DayPath *out, const AirDay *day, const AirPath *path);

/* Scattered sunlight of one path at several azimuths from the sun, 0 .. pi; sun: as DayPath's. */
void air_day_scattered(double (*w_m2_sr)[AIR_BAND_COUNT], double sun[AIR_BAND_COUNT], const AirDay *day,
                       const AirPath *path, const double *azimuth_rad, int azimuths);

/* The sky at one zenith angle and several azimuths; thermal: mwir, lwir. */
void air_day_sky(double (*w_m2_sr)[AIR_BAND_COUNT], double thermal_w_m2_sr[2], const AirDay *day, double observer_m,
                 double zenith_rad, const double *azimuth_rad, int azimuths);

#endif
