/* tests/scenes/heat_day.h: weather in closed form for the ground's heat, and columns of ground run by themselves. */
#ifndef TESTS_SCENES_HEAT_DAY_H
#define TESTS_SCENES_HEAT_DAY_H

#include "render/heat/heat.h"
#include "tests/bench/bench.h"

/* The same day again and again: noon at 12 h UTC, air warmest at 15 h. */
typedef struct HeatDay {
    double latitude_rad, declination_rad;
    double air_k, range_k; /* mean; warmest less coldest */
    double wind_mps, humidity;
} HeatDay;
static const double heat_day_unix_s = 1782000000 / 86400 * 86400; /* a midnight UTC */

/* A clear day of June in the middle of Europe. */
HeatDay heat_day_default(void);
/* HeatWeather; user: a HeatDay. Beam: 0.7^(air mass^0.678) of 1361 W/m2 (Meinel); scattered: a tenth of what is level;
 * longwave: Brunt (1932). */
void heat_day(GroundWeather *out, double unix_s, const void *user);

/* etc/ground_heat.csv with the bundled materials. */
Status heat_day_kinds(GroundKinds *out);

/* One piece of ground of a kind beside level ground of the same kind, as Heat runs both: from the mean of a first day,
 * by half hours until eight hours before begun_s, then by step_s. */
typedef struct HeatPiece {
    Column            layers;
    ColumnFactors     step, half;
    GroundColumn      level, piece;
    const GroundKind *kind;
    const HeatDay    *day;
    double            n_enu[3], shaded_h[2]; /* hours of each day without its direct sun, from and to */
    double            tolerance_k, step_s, unix_s;
} HeatPiece;
Status heat_piece_begin(HeatPiece *out, const GroundKind *kind, const HeatConfig *config, const double n_enu[3],
                        const double shaded_h[2]);
/* unix_s: a time of the grid. Returns the surface's temperature, K. */
double heat_piece_at(HeatPiece *piece, double unix_s);

#endif
