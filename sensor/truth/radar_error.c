/* sensor/truth/radar_error.c: see radar_error.h. */
#include "sensor/truth/radar_error.h"

#include "render/radar/signature.h"

enum { weights = 256 }; /* of a window of any length: its shape */

double radar_gridding_error(void) { return 1.5e-4; }

/* 2 (1 - rho): rho is the response's correlation with itself, the transform of the squared weights. */
double radar_moved(const RadarPreset *preset, double cells)
{
    double w[weights], sum = 0, all = 0;
    if (!(cells > 0) || window_weights(w, weights, &preset->range_window) != STATUS_OK) return 0;
    for (int i = 0; i < weights; i++) {
        sum += w[i] * w[i] * cos(2 * pi_rad * cells * (i - 0.5 * (weights - 1)) / weights);
        all += w[i] * w[i];
    }
    return 2 * (1 - fabs(sum) / all);
}

/* Squared error over the square of the field, from a standard deviation of the cross section (signature_error_db). */
static double square_of_db(double db)
{
    const double root = pow(10, 0.1 * db) - 1;
    return 0.5 * root * root;
}

static double map_energy(const RangeDoppler *map)
{
    double sum = 0; /* of the sum channel, which is the first */
    for (size_t i = 0; i < (size_t)map->rows * (size_t)map->columns; i++)
        sum += scatter_power(map->cell[i]);
    return sum;
}

void radar_error(RadarError *out, const RadarFrame *r, const Snapshot *snapshot)
{
    const double cells_error = signature_cells_error();
    const double noise_w = r->receiver.noise_w * r->map.noise_share, all = map_energy(&r->map);
    /* a point's response has the energy of its peak times the windows' equivalent noise bandwidths, in cells */
    const double cells = r->map.noise_share * r->map.rows * r->map.columns;
    double       squares[error_sources] = {0}, own = 0, total = 0;
    for (int i = 0; i < r->targets; i++) {
        const RadarTruth *t = &r->target[i];
        const double      energy = t->snr * noise_w * cells;
        if (!(energy > 0)) continue;
        squares[ERROR_DEAD_RECKONING] +=
            energy * radar_moved(r->preset, snapshot->entity[t->entity].drift_m / sqrt(3) / r->map.metre_per_column);
        const double error_db = t->rcs_error_db[r->preset->transmits_h ? 0 : 1];
        if (isnan(error_db)) continue; /* a given signature */
        own += energy;
        squares[ERROR_SAMPLING] += energy * square_of_db(error_db);
        squares[ERROR_LEVEL_OF_DETAIL] += energy * cells_error;
    }
    squares[ERROR_TABLES] = all * radar_gridding_error() * radar_gridding_error();
    for (int s = 0; s < ERROR_TOTAL; s++) {
        squares[ERROR_TOTAL] += squares[s];
        total += s == ERROR_DEAD_RECKONING || s == ERROR_TABLES ? 0 : squares[s];
    }
    for (int s = 0; s < error_sources; s++) {
        const double of_field = s == ERROR_TABLES ? radar_gridding_error()
                              : s == ERROR_TOTAL  ? hypot(sqrt(total / own), radar_gridding_error())
                                                  : sqrt(squares[s] / own);
        out->share[s] = all > 0 ? sqrt(squares[s] / all) : NAN;
        out->db[s] = own > 0 ? 10 * log10(1 + sqrt(2) * of_field) : NAN;
    }
    out->share[ERROR_HEAT] = out->db[ERROR_HEAT] = out->db[ERROR_DEAD_RECKONING] = NAN;
}
