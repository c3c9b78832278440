/* render/air_table.c: the paths of a frame, collapsed from the tables of an atmosphere. air_veils.c asks them.
 *
 * The eye's height, the sun and the visibility are a frame's own, so of a path only its far end's height, its length
 * and its azimuth from the sun are left. Each answer of the atmosphere is a search in its tables, and of scattered
 * light an integral along the path: ranges are asked for at each octave, scattered light at every second node, and
 * drawn between them by cubics. How scattered light turns with azimuth is much the same along a path and from one
 * slope to the next, so that away from the middle azimuth only a sixteenth of those nodes is asked, for their ratio.
 * tests/render/test_air.c holds the sum of it against atmosphere_path(). */
#include "render/air_private.h"

enum {
    coarse_slopes = air_slopes / 2,
    coarse_shares = air_shares / 2,
    coarse_turns = air_turns / 2,
    side_stride = 4,
    side_slopes = coarse_slopes / side_stride,
    side_shares = coarse_shares / side_stride,
    coarse_row = coarse_shares + 1,
    side_row = side_shares + 1,
    coarse_nodes = (coarse_slopes + 1) * coarse_row,
    side_nodes = (side_slopes + 1) * side_row
};

typedef double Coarse[coarse_nodes]; /* by slope, share */
typedef double Side[side_nodes];
typedef double Octaves[air_octaves + 1];

typedef struct TableJob {
    Air *air;
    TableInput in;
    int turns, middle; /* steps of azimuth asked for, and the one asked for in full */
    Coarse log2_source[AIR_BAND_COUNT];            /* of scattered light at the middle azimuth */
    Side   side[AIR_BAND_COUNT][coarse_turns + 1]; /* the same elsewhere */
} TableJob;

/* log2(1 / tau) a metre. */
static double extinction(double transmittance, double range_m)
{
    return -log2(clamp(transmittance, 1e-30, 1)) / range_m;
}

/* Radiance over what the path takes away; a clear path has no source. */
static double mean_source(double radiance_w_m2_sr, double transmittance)
{
    return transmittance < 1 - 1e-12 ? radiance_w_m2_sr / (1 - transmittance) : 0;
}

static double log2_source(const TableJob *job, const PathAir *air)
{
    return log2(fmax(mean_source(air->scattered_w_m2_sr * job->in.scattered_scale, air->sun_transmittance), 1e-30));
}

/* A band whose scattered light is asked for: sunlight is below a thousandth of what 8-12 um emits. */
static bool scatters(const TableJob *job, int band)
{
    return job->in.bands >> band & 1 && band != AIR_LWIR && job->air->table->scattered;
}

static double azimuth_rad(double turn) { return acos(clamp(1 - turn * turn, -1, 1)); }
static double turn_of(double azimuth) { return sqrt(fmax(1 - cos(azimuth), 0)); }

static void ask(PathAir *out, const TableJob *job, int band, const AirPath *path, double temp_k)
{
    atmosphere_path(out, job->in.atmosphere, job->air->weather.visibility_m, (AirBand)band, path, temp_k);
}

/* ---- what paths take away -------------------------------------------------------------------------- */

/* Cubic in the octaves' logarithm, cut evenly. */
static void cut_octaves(float *out, int stride, const Octaves in, bool times_range)
{
    static const double log2_cut[air_range_cuts] = {0,
                                                    0.16992500144231237,
                                                    0.32192809488736235,
                                                    0.45943161863729726,
                                                    0.58496250072115618,
                                                    0.70043971814109216,
                                                    0.80735492205760410,
                                                    0.90689059560851848};
    for (int r = 0; r <= air_ranges; r++) {
        const int i = r < air_ranges ? r / air_range_cuts : air_octaves - 1;
        const double b = in[i], c = in[i + 1];
        const double a = i > 0 ? in[i - 1] : 3 * (b - c) + in[2];
        const double d = i + 2 <= air_octaves ? in[i + 2] : 3 * (c - b) + in[i - 1];
        const double value = r < air_ranges ? cubic_between(a, b, c, d, log2_cut[r % air_range_cuts]) : c;
        const double range_m = times_range ? air_near_m * (double)air_step_up(1, r, air_range_shift) : 1;
        out[r * stride] = (float)(fmax(value, 0) * range_m);
    }
}

/* One height: every range. */
static void ask_height(void *user, int worker, int row)
{
    (void)worker;
    const TableJob *job = user;
    const Air      *air = job->air;
    const AirTable *table = air->table;
    Octaves sun[AIR_BAND_COUNT], own[2], source[2], emitted[2][air_temps];
    AirPath path = {.observer_m = air->eye_height_m,
                    .target_m = fmin((double)air_step_up(air_low_m, row, table->row_shift) - air_low_m, air_top_m),
                    .sun_zenith_rad = pi_rad}; /* its scattered light is not asked for */
    const double straight_m = fabs(path.target_m - path.observer_m) * 1.0001;
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(job->in.bands >> b & 1)) continue;
        for (int r = 0; r <= air_octaves; r++) {
            /* shorter than straight up or down there is no path: the nodes hold that one */
            path.range_m = fmax(ldexp(air_near_m, r), straight_m);
            const bool again = r > 0 && ldexp(air_near_m, r) <= straight_m;
            PathAir here;
            if (!again) ask(&here, job, b, &path, air->weather.air_temp_k);
            sun[b][r] = again ? sun[b][r - 1] : extinction(here.sun_transmittance, path.range_m);
            if (b < AIR_MWIR) continue;
            const int t = b - AIR_MWIR;
            own[t][r] = again ? own[t][r - 1] : extinction(here.transmittance, path.range_m);
            source[t][r] = again ? source[t][r - 1]
                                 : mean_source(here.thermal_w_m2_sr * job->in.thermal_scale[t], here.transmittance);
            for (int k = 0; k < air_temps; k++) {
                if (!again) ask(&here, job, b, &path, emitter_temp_k[k]);
                emitted[t][k][r] = again ? emitted[t][k][r - 1] : extinction(here.transmittance, path.range_m);
            }
        }
    }
    const int first = row * air_range_row;
    for (int g = 0; g < table->lights; g++)
        for (int lane = 0; lane < table->light[g]->bands; lane++)
            cut_octaves(&table->light[g]->depth[first][lane], air_lights, sun[table->light[g]->band[lane]], true);
    for (int t = 0; t < 2; t++) {
        if (!(job->in.bands >> (AIR_MWIR + t) & 1)) continue;
        for (int k = 0; k < air_temps - 1; k++) {
            enum { values = 2 * air_warm_values };
            float *out = &table->heat->value[k][first][t * air_warm_values];
            cut_octaves(out + air_warm_own, values, own[t], true);
            cut_octaves(out + air_warm_low, values, emitted[t][k], true);
            cut_octaves(out + air_warm_high, values, emitted[t][k + 1], true);
            cut_octaves(out + air_warm_source, values, source[t], false);
        }
    }
}

/* ---- scattered light ------------------------------------------------------------------------------- */

/* The path of a coarse node. */
static AirPath path_at(const TableJob *job, int slope_step, int share_step, int turn)
{
    const AirTable *table = job->air->table;
    const double eye_m = job->air->eye_height_m;
    const double s = (double)(table->slope_low + (float)(2 * slope_step) / table->slope_steps);
    const double slope = clamp(s * fabs(s), -1, 1);
    const double whole_m = slope < 0 ? fmax(eye_m, air_least_fall_m) : air_top_m - eye_m;
    const double end_m = clamp(whole_m / fmax(fabs(slope), 1e-9), air_shortest_way_m, air_longest_way_m);
    const double share = fmax((double)share_step / coarse_shares, 0.01); /* not quite nothing */
    const double steps = (double)turn * table->turns / job->turns;
    AirPath path = {.observer_m = eye_m, .range_m = share * share * end_m, .sun_zenith_rad = job->in.sun_zenith_rad};
    path.rel_azimuth_rad = azimuth_rad((double)table->turn_low + steps / (double)table->turn_steps);
    path.target_m = clamp(eye_m + slope * path.range_m, 0, air_top_m);
    return path;
}

/* One slope at one azimuth. */
static void ask_slope(void *user, int worker, int task)
{
    (void)worker;
    TableJob *job = user;
    const int turn = task / (coarse_slopes + 1), i = task % (coarse_slopes + 1);
    const bool full = turn == job->middle;
    if (!full && i > side_slopes) return;
    for (int c = 0; c <= (full ? coarse_shares : side_shares); c++) {
        const AirPath path = full ? path_at(job, i, c, turn) : path_at(job, side_stride * i, side_stride * c, turn);
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            if (!scatters(job, b)) continue;
            PathAir here;
            ask(&here, job, b, &path, job->air->weather.air_temp_k);
            if (full)
                job->log2_source[b][i * coarse_row + c] = log2_source(job, &here);
            else
                job->side[b][turn][i * side_row + c] = log2_source(job, &here);
        }
    }
}

/* Twice the steps: between four by their cubic, at the ends between three. in: steps + 1, out: 2 steps + 1 values. */
static void halve_steps(double *out, int out_stride, const double *in, int in_stride, int steps)
{
    for (int i = 0; i < steps; i++) {
        const double *p = in + i * in_stride;
        const double b = p[0], c = p[in_stride];
        const double a = i > 0 ? p[-in_stride] : 3 * (b - c) + p[2 * in_stride];
        const double d = i + 2 <= steps ? p[2 * in_stride] : 3 * (c - b) + p[-in_stride];
        out[2 * i * out_stride] = b;
        out[(2 * i + 1) * out_stride] = (9 * (b + c) - (a + d)) * (1.0 / 16);
    }
    out[2 * steps * out_stride] = in[steps * in_stride];
}

/* Both ways. fine: [2 slopes + 1][2 shares + 1]. */
static void halve_both(double *fine, const double *coarse, int slopes, int shares)
{
    const int row = 2 * shares + 1;
    double wide[(2 * coarse_slopes + 1) * (coarse_shares + 1)];
    for (int c = 0; c <= shares; c++) halve_steps(wide + c, shares + 1, coarse + c, shares + 1, slopes);
    for (int i = 0; i <= 2 * slopes; i++) halve_steps(fine + i * row, 1, wide + i * (shares + 1), 1, shares);
}

static void draw_light(void *user, int worker, int task)
{
    (void)worker;
    TableJob *job = user;
    const AirTable *table = job->air->table;
    const int group = task / air_lights, lane = task % air_lights;
    if (group >= table->lights || lane >= table->light[group]->bands) return;
    AirLight *light = table->light[group];
    const AirBand band = light->band[lane];
    /* every azimuth asked for, on the coarse nodes; then as many between them */
    Coarse asked[coarse_turns + 1], turned[air_turns + 1];
    for (int a = 0; a <= job->turns; a++) {
        memcpy(asked[a], job->log2_source[band], sizeof asked[a]);
        if (a == job->middle) continue;
        Side   side;
        Coarse half, ratio;
        for (int i = 0; i <= side_slopes; i++)
            for (int c = 0; c <= side_shares; c++)
                side[i * side_row + c] =
                    job->side[band][a][i * side_row + c] - job->log2_source[band][side_stride * (i * coarse_row + c)];
        halve_both(half, side, side_slopes, side_shares);
        halve_both(ratio, half, 2 * side_slopes, 2 * side_shares);
        for (int n = 0; n < coarse_nodes; n++) asked[a][n] += ratio[n];
    }
    for (int n = 0; n < coarse_nodes; n++)
        halve_steps(&turned[0][n], coarse_nodes, &asked[0][n], coarse_nodes, job->turns);
    for (int a = 0; a <= 2 * job->turns; a++) {
        double fine[air_slope_nodes];
        halve_both(fine, turned[a], coarse_slopes, coarse_shares);
        for (int n = 0; n < air_slope_nodes; n++) light->log2_source[a][n][lane] = (float)fine[n];
    }
}

/* ---- all of it ------------------------------------------------------------------------------------- */

void air_run(Pool *pool, int count, PoolTask *task, void *user)
{
    if (pool)
        pool_run(pool, count, task, user);
    else
        for (int i = 0; i < count; i++) task(user, 0, i);
}

/* As fine as there is room for. */
static void choose_rows(AirTable *table, double high_m)
{
    const double most_m = fmin(high_m, air_top_m);
    for (table->row_shift = 20; table->row_shift <= 21; table->row_shift++) {
        table->rows = 1;
        while (table->rows < air_rows_most &&
               (double)air_step_up(air_low_m, table->rows, table->row_shift) < most_m + air_low_m)
            table->rows++;
        if ((double)air_step_up(air_low_m, table->rows, table->row_shift) >= most_m + air_low_m) return;
    }
    table->row_shift = 21; /* nine octaves hold the tables' top in 36 */
}

Status air_table_fill(Air *air, const TableInput *input, Pool *pool, Arena *arena)
{
    TableJob *job = arena_alloc(arena, 1, sizeof *job);
    AirTable *table = air->table = arena_alloc(arena, 1, sizeof *table);
    if (!job || !table) return STATUS_NO_MEMORY;
    job->air = air, job->in = *input;
    const double slope_low = copysign(sqrt(fabs(input->slope_low)), input->slope_low);
    const double slope_high = fmax(copysign(sqrt(fabs(input->slope_high)), input->slope_high), slope_low + 1e-3);
    const double turn_low = turn_of(input->azimuth_low_rad);
    const double turn_span = fmax(turn_of(input->azimuth_high_rad) - turn_low, 1e-3);
    /* asked for in a sixth of all round at most, of a quarter of the view at least */
    job->turns = (int)clamp(ceil(turn_span * coarse_turns / sqrt(2) - 1e-9), 4, coarse_turns);
    job->middle = job->turns / 2;
    *table = (AirTable){.scattered = input->scattered_scale > 0,
                        .slope_low = (float)slope_low,
                        .slope_steps = (float)(air_slopes / (slope_high - slope_low)),
                        .turn_low = (float)turn_low,
                        .turns = 2 * job->turns};
    table->turn_steps = (float)(table->turns / turn_span);
    choose_rows(table, input->height_high_m);
    for (int b = 0; b < AIR_LWIR; b++) {
        if (!(input->bands >> b & 1)) continue;
        AirLight *light = table->lights > 0 ? table->light[table->lights - 1] : NULL;
        if (!light || light->bands == air_lights) {
            light = table->light[table->lights++] = arena_alloc(arena, 1, sizeof *light);
            if (!light) return STATUS_NO_MEMORY;
        }
        light->band[light->bands++] = (AirBand)b;
    }
    if (input->bands & (1 << AIR_MWIR | 1 << AIR_LWIR)) {
        table->heat = arena_alloc(arena, 1, sizeof *table->heat);
        if (!table->heat) return STATUS_NO_MEMORY;
    }
    air_run(pool, table->rows + 1, ask_height, job);
    if (!table->scattered) return STATUS_OK;
    air_run(pool, (job->turns + 1) * (coarse_slopes + 1), ask_slope, job);
    air_run(pool, 2 * air_lights, draw_light, job);
    return STATUS_OK;
}
