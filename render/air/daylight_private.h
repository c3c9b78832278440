/* render/air/daylight_private.h: daylight in passes of tasks, so that a pool runs them beside those of an eye: first
 * all evaluations, then all interpolations, then all planes, each in any order and by any thread; then the end. */
#ifndef RENDER_AIR_DAYLIGHT_PRIVATE_H
#define RENDER_AIR_DAYLIGHT_PRIVATE_H

#include "render/air/atmosphere_day.h"
#include "render/air/daylight.h"

/* Temperatures of emitters for which transmittance is stored; between them its depth is linear in the temperature's
 * logarithm, as in the tables, outside the nearest is used. The AirDay has these and, behind them, the air's own. */
enum { air_temps = 5 };
static const double emitter_temp_k[air_temps] = {260, 300, 400, 600, 1000};

typedef struct DaylightJob DaylightJob;

/* The totals of these bands and of pan. diffuse_w_m2: the tables' own. */
void daylight_sums(Daylight *out, const AirSource *source, const Weather *weather, const Sun *sun, unsigned bands,
                   double diffuse_w_m2[AIR_BAND_COUNT]);
/* other: [AIR_BAND_COUNT], filled in with the sky from another height; NULL: not requested. */
Status daylight_begin(DaylightJob **out, Daylight *light, const AirSource *source, const Weather *weather,
                      const Sun *sun, unsigned bands, AirSky *other, double other_m, Arena *arena);
int  daylight_asks(const DaylightJob *job);
void daylight_ask(DaylightJob *job, int ask);
int  daylight_draws(const DaylightJob *job);
void daylight_draw(DaylightJob *job, int draw);
int  daylight_planes(const DaylightJob *job);
void daylight_plane(DaylightJob *job, int plane);
void daylight_end(DaylightJob *job);

/* The pool's tasks, or in order where there is none. */
void air_run(Pool *pool, int count, PoolTask *task, void *user);

/* Cubic through four equidistant points, at t of the middle step. */
static inline double cubic_between(double a, double b, double c, double d, double t)
{
    return b + t * (c - b) + t * (t - 1) / 6 * ((2 - t) * (a - 2 * b + c) + (1 + t) * (b - 2 * c + d));
}

/* The arc cosine, within 7e-5 rad: Abramowitz & Stegun 4.4.45. Steps of the tables are 0.26 rad. */
double acos_quick(double c);
/* Cosine of the angle between two directions' azimuths, by their level parts; 1 where one has none. */
double cos_azimuth(const double a_enu[3], const double b_enu[3]);

#endif
