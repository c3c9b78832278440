/* tests/scenes/paper_day.h: a clear day on paper, 45 degrees north at an equinox or summer: the sun on a circle, what
 * it gives by its height, air that follows. */
#ifndef TESTS_SCENES_PAPER_DAY_H
#define TESTS_SCENES_PAPER_DAY_H

#include "tests/check.h"
#include "render/heat/heat.h"

typedef struct PaperDay {
    double air_k, range_k, wind_mps, declination_rad, direct_w_m2, latitude_rad;
} PaperDay;
static const PaperDay paper_summer = {288, 10, 3, 0.36, 900, 0.785};

/* Noon at 12 UTC. */
static void paper_weather(GroundWeather *out, double unix_s, const void *user)
{
    const PaperDay *d = user;
    const double    hour = (unix_s - floor(unix_s / 86400) * 86400) / 3600, turn = (hour - 12) / 12 * pi_rad;
    const double    east = -cos(d->declination_rad) * sin(turn);
    const double    up =
        sin(d->latitude_rad) * sin(d->declination_rad) + cos(d->latitude_rad) * cos(d->declination_rad) * cos(turn);
    const double north =
        cos(d->latitude_rad) * sin(d->declination_rad) - sin(d->latitude_rad) * cos(d->declination_rad) * cos(turn);
    const double air_k = d->air_k + 0.5 * d->range_k * cos((hour - 15) / 12 * pi_rad);
    const double direct = up > 0 ? d->direct_w_m2 * exp(-0.15 / (up + 0.05)) / exp(-0.15 / 1.05) : 0;
    *out = (GroundWeather){.air = {air_k, 900, 101325, d->wind_mps, 2, 10},
                           .direct_w_m2 = direct,
                           .diffuse_w_m2 = up > 0 ? 100 * sqrt(up) : 0,
                           .longwave_w_m2 = 0.78 * stefan_w_m2k4 * pow(air_k, 4),
                           .sun_d_enu = {east, north, up}};
}

static inline void paper_kinds(GroundKinds *out)
{
    char      materials[512], surfaces[512], ground[512];
    Materials m;
    CHECK(etc_path(materials, sizeof materials, "materials.csv") &&
          etc_path(surfaces, sizeof surfaces, "surfaces.csv") && etc_path(ground, sizeof ground, "ground_heat.csv"));
    CHECK(materials_open(&m, materials, surfaces, NULL) == STATUS_OK);
    CHECK(ground_kinds_open(out, ground, &m) == STATUS_OK);
    materials_close(&m);
}

static const double paper_unix_s = 1719792000; /* a midnight, 1 July 2024 */

static inline Heat *paper_heat(const GroundKinds *kinds, const PaperDay *day, double from_h, Pool *pool)
{
    HeatConfig c = heat_default_config();
    Heat      *h;
    c.unix_s = paper_unix_s + 3600 * from_h;
    c.weather = paper_weather, c.user = day, c.pool = pool;
    CHECK(heat_create(&h, kinds, &c, NULL, 0) == STATUS_OK);
    return h;
}

#endif
