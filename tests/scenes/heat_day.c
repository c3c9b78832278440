/* tests/scenes/heat_day.c: the weather of the day, and columns under it. */
#include "tests/scenes/heat_day.h"

static const double day_s = 86400, half_hour_s = 1800;

HeatDay heat_day_default(void)
{
    return (HeatDay){.latitude_rad = 50 * rad_per_deg,
                     .declination_rad = 23 * rad_per_deg,
                     .air_k = 291,
                     .range_k = 10,
                     .wind_mps = 2,
                     .humidity = 0.6};
}

void heat_day(GroundWeather *out, double unix_s, const void *user)
{
    const HeatDay *d = user;
    const double   turn = 2 * pi_rad * (unix_s / day_s - floor(unix_s / day_s)), hour = turn - pi_rad;
    const double   air_k = d->air_k + 0.5 * d->range_k * cos(turn - 2 * pi_rad * 15 / 24);
    const double   vapour_pa = d->humidity * saturation_pa(d->air_k - 0.5 * d->range_k);
    *out = (GroundWeather){.air = {air_k, vapour_pa, 101325, d->wind_mps, 2, 10}};
    out->sun_d_enu[0] = -cos(d->declination_rad) * sin(hour);
    out->sun_d_enu[1] =
        cos(d->latitude_rad) * sin(d->declination_rad) - sin(d->latitude_rad) * cos(d->declination_rad) * cos(hour);
    out->sun_d_enu[2] =
        sin(d->latitude_rad) * sin(d->declination_rad) + cos(d->latitude_rad) * cos(d->declination_rad) * cos(hour);
    const double up = out->sun_d_enu[2];
    if (up > 0) {
        out->direct_w_m2 = 1361 * pow(0.7, pow(1 / fmax(up, 0.02), 0.678));
        out->diffuse_w_m2 = 0.1 * 1361 * up;
    }
    out->longwave_w_m2 = fmin(0.52 + 0.065 * sqrt(0.01 * vapour_pa), 1) * stefan_w_m2k4 * pow(air_k, 4);
}

Status heat_day_kinds(GroundKinds *out)
{
    char      path[512], surfaces[512];
    Materials materials = {0};
    if (!etc_path(path, sizeof path, "materials.csv") || !etc_path(surfaces, sizeof surfaces, "surfaces.csv"))
        return STATUS_BAD_VALUE;
    Status status = materials_open(&materials, path, surfaces, NULL);
    if (status == STATUS_OK && !etc_path(path, sizeof path, "ground_heat.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = ground_kinds_open(out, path, &materials);
    materials_close(&materials);
    return status;
}

/* ---- one piece of ground ------------------------------------------------------------------------ */

static bool in_shade(const HeatPiece *p, double unix_s)
{
    const double hour = 24 * (unix_s / day_s - floor(unix_s / day_s));
    return hour > p->shaded_h[0] && hour < p->shaded_h[1];
}

static void step_piece(HeatPiece *p, double dt_s)
{
    GroundWeather before, after;
    heat_day(&before, p->unix_s, p->day);
    heat_day(&after, p->unix_s + dt_s, p->day);
    const GroundExposure level = {{0, 0, 1}, 1, 1, p->level.state.temp_k[0]};
    GroundExposure       piece = level;
    memcpy(piece.n_enu, p->n_enu, sizeof piece.n_enu);
    piece.sun = in_shade(p, p->unix_s + 0.5 * dt_s) ? 0 : 1;
    p->level.factors = p->piece.factors = dt_s > p->step_s ? &p->half : &p->step;
    ground_column_step(&p->level, p->tolerance_k, &before, &after, &level, dt_s);
    ground_column_step(&p->piece, p->tolerance_k, &before, &after, &piece, dt_s);
    p->unix_s += dt_s;
}

/* Mean of a day of level ground's surface. */
static double start_k(const HeatPiece *p, double first_s, double stride_s)
{
    const int     count = (int)lround(day_s / stride_s);
    double        air_k = 0, sum = 0;
    GroundWeather w[2];
    GroundColumn  column;
    for (int i = 0; i < count; i++) {
        heat_day(&w[0], first_s + i * stride_s, p->day);
        air_k += w[0].air.temp_k / count;
    }
    ground_column_start(&column, p->kind, &p->layers, air_k);
    const GroundExposure level = {{0, 0, 1}, 1, 1, 0};
    for (int i = 0; i < count; i++) {
        heat_day(&w[0], first_s + i * stride_s, p->day);
        heat_day(&w[1], first_s + (i + 1) * stride_s, p->day);
        ground_column_step(&column, p->tolerance_k, &w[0], &w[1], &level, stride_s);
        sum += column.state.temp_k[0] / count;
    }
    return sum;
}

Status heat_piece_begin(HeatPiece *out, const GroundKind *kind, const HeatConfig *config, const double n_enu[3],
                        const double shaded_h[2])
{
    const double begun_s = floor(config->unix_s / config->step_s) * config->step_s,
                 first_s = begun_s - config->spin_up_s;
    const double wide_s = fmax(1, round(half_hour_s / config->step_s)) * config->step_s, fine_s = 8 * 3600;
    *out = (HeatPiece){.kind = kind,
                       .day = config->user,
                       .tolerance_k = config->grid.tolerance_k,
                       .step_s = config->step_s,
                       .unix_s = first_s,
                       .n_enu = {n_enu[0], n_enu[1], n_enu[2]},
                       .shaded_h = {shaded_h[0], shaded_h[1]}};
    const Status status = ground_layers(&out->layers, kind, &config->grid);
    if (status != STATUS_OK) return status;
    column_factors(&out->step, &out->layers, config->step_s);
    column_factors(&out->half, &out->layers, wide_s);
    const double temp_k = start_k(out, first_s, wide_s);
    ground_column_start(&out->level, kind, &out->layers, temp_k);
    ground_column_start(&out->piece, kind, &out->layers, temp_k);
    while (begun_s - out->unix_s > fine_s && begun_s - out->unix_s > wide_s) step_piece(out, wide_s);
    while (out->unix_s < begun_s) step_piece(out, config->step_s);
    return STATUS_OK;
}

double heat_piece_at(HeatPiece *p, double unix_s)
{
    while (p->unix_s < unix_s - 1e-3) step_piece(p, p->step_s);
    return p->piece.state.temp_k[0];
}
