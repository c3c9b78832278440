/* render/air/air_table.c: the path tables of a frame, reduced from the tables of an atmosphere; looked up by
 * air_paths.c.
 *
 * The eye's height, the sun and the visibility are constant in a frame, so the variables of a path are its far end's
 * height, its length and its azimuth from the sun. Each evaluation of the atmosphere is a search in its tables, and
 * for scattered light an integral along the path: extinction is evaluated at each octave of range, scattered light
 * at every second node, with cubic interpolation between them. The variation of scattered light with azimuth is
 * nearly the same along a path and from one slope to the next, so that away from the middle azimuth only a sixteenth
 * of those nodes is evaluated, for their ratio. tests/render/test_air.c compares the result with atmosphere_path(). */
#include "render/air/air_private.h"

enum {
    coarse_slopes = air_slopes / 2,
    coarse_shares = air_shares / 2,
    coarse_turns = air_turns / 2,
    side_stride = 4, /* of slopes in two pieces half that */
    side_slopes_most = 2 * coarse_slopes / side_stride,
    side_shares = coarse_shares / side_stride,
    coarse_row = coarse_shares + 1,
    side_row = side_shares + 1,
    coarse_nodes = (coarse_slopes + 1) * coarse_row,
    side_nodes = (side_slopes_most + 1) * side_row
};

typedef double Coarse[coarse_nodes]; /* by slope, share */
typedef double Side[side_nodes];
typedef double Octaves[air_octaves + 1];

struct TableJob {
    Air       *air;
    TableInput in;
    int        turns, middle; /* evaluated steps of azimuth, and the one that is evaluated in full */
    int        first_slopes;  /* evaluated steps of slope up to the Earth's edge; 0: it is not among them */
    double     azimuth_rad[coarse_turns + 1];
    Coarse     log2_source[AIR_BAND_COUNT];            /* of scattered light at the middle azimuth */
    Side       side[AIR_BAND_COUNT][coarse_turns + 1]; /* the same elsewhere */
};

/* log2(1 / tau) per metre, from an optical depth. */
static double extinction(double depth, double range_m)
{
    static const double deepest = 69.07755278982137, log2_e = 1.4426950408889634; /* ln 1e30 */
    return clamp(depth, 0, deepest) * log2_e / range_m;
}

/* Radiance over 1 - transmittance; a path without extinction has no source. */
static double mean_source(double radiance_w_m2_sr, double depth)
{
    return depth > 1e-12 ? radiance_w_m2_sr / -expm1(-depth) : 0;
}

static double log2_source(const TableJob *job, int b, double scattered_w_m2_sr, double depth)
{
    return log2(fmax(mean_source(scattered_w_m2_sr * job->air->light.scattered_scale[b], depth), 1e-30));
}

/* A band whose scattered light is evaluated: sunlight is below a thousandth of what 8-12 um emits. */
static bool scatters(const TableJob *job, int band)
{
    return job->in.bands >> band & 1 && band != AIR_LWIR && job->air->table->scattered;
}

static double azimuth_rad(double turn) { return acos(clamp(1 - turn * turn, -1, 1)); }
static double turn_of(double azimuth) { return sqrt(fmax(1 - cos(azimuth), 0)); }

/* ---- extinction of paths --------------------------------------------------------------------------- */

/* A curve over all ranges, evenly divided, with cubic interpolation between the octaves. */
typedef float Curve[air_ranges + 1];

static void cut_octaves(Curve out, const Octaves in, bool times_range)
{
    static const double log2_cut[air_range_cuts] = {0,
                                                    0.16992500144231237,
                                                    0.32192809488736235,
                                                    0.45943161863729726,
                                                    0.58496250072115618,
                                                    0.70043971814109216,
                                                    0.80735492205760410,
                                                    0.90689059560851848};
    for (int i = 0; i < air_octaves; i++) {
        const double b = in[i], c = in[i + 1];
        const double a = i > 0 ? in[i - 1] : 3 * (b - c) + in[2];
        const double d = i + 2 <= air_octaves ? in[i + 2] : 3 * (c - b) + in[i - 1];
        for (int r = 0; r < air_range_cuts; r++) {
            /* the cuts of an octave are its eighths */
            const double range_m = times_range ? ldexp(air_near_m, i) * (1 + r * (1.0 / air_range_cuts)) : 1;
            const double value = cubic_between(a, b, c, d, log2_cut[r]);
            out[i * air_range_cuts + r] = (float)((value > 0 ? value : 0) * range_m);
        }
    }
    out[air_ranges] = (float)(fmax(in[air_octaves], 0) * (times_range ? ldexp(air_near_m, air_octaves) : 1));
}

static void put_curve(float *out, int stride, const Curve curve)
{
    for (int r = 0; r <= air_ranges; r++) out[r * stride] = curve[r];
}

/* A longer path to a height meets the ground; of eyes below high_m as far as leaves their octaves as they are, and
 * without a step. */
static double longest_path_m(const AirPath *path)
{
    static const double high_m = 1000, low_m = 100;
    if (path->observer_m < low_m) return INFINITY;
    const double more = fmax(high_m / path->observer_m, 1);
    return more * more *
           (sqrt(path->observer_m * (2 * earth_radius_m + path->observer_m)) +
            sqrt(path->target_m * (2 * earth_radius_m + path->target_m)));
}

/* Of values at octaves of range, those beyond the longest path: the first of them is that path's, and becomes what the
 * straight line to it from the last octave before it goes on to, so that paths of nearly that length lie on that line.
 */
static void go_on(Octaves value, double octaves)
{
    const int before = (int)fmin(octaves, air_octaves);
    if (before == air_octaves) return;
    value[before + 1] = value[before] + (value[before + 1] - value[before]) / fmax(octaves - before, 0.2);
    for (int r = before + 2; r <= air_octaves; r++) value[r] = 2 * value[r - 1] - value[r - 2];
}

/* One height: all ranges. */
static void ask_height(TableJob *job, int row)
{
    const Air      *air = job->air;
    const AirTable *table = air->table;
    Octaves         sun[AIR_BAND_COUNT], own[2], source[2], emitted[2][air_temps];
    Curve           curve, warm[2][air_temps + 2]; /* of emitters; own, source */
    DayPath         here;
    AirPath         path = {.observer_m = air_from_m(air),
                            .target_m = fmin((double)air_step_up(air_low_m, row, table->row_shift) - air_low_m, air_top_m)};
    const double    straight_m = fabs(path.target_m - path.observer_m) * 1.0001, longest_m = longest_path_m(&path);
    for (int r = 0; r <= air_octaves; r++) {
        /* no path is shorter than the vertical one: such nodes hold that one */
        path.range_m = fmin(fmax(ldexp(air_near_m, r), straight_m), longest_m);
        if (r == 0 || ldexp(air_near_m, r) > straight_m) air_day_path(&here, job->air->light.day, &path);
        for (int b = 0; b < AIR_BAND_COUNT; b++) sun[b][r] = extinction(here.sun[b], path.range_m);
        for (int t = 0; t < 2; t++) {
            own[t][r] = extinction(here.emitted[t][air_temps], path.range_m);
            source[t][r] =
                mean_source(here.thermal_w_m2_sr[t] * job->air->light.thermal_scale[t], here.emitted[t][air_temps]);
            for (int k = 0; k < air_temps; k++) emitted[t][k][r] = extinction(here.emitted[t][k], path.range_m);
        }
    }
    const double octaves = log2(longest_m / air_near_m);
    for (int b = 0; b < AIR_BAND_COUNT; b++) go_on(sun[b], octaves);
    for (int t = 0; t < 2; t++) {
        go_on(own[t], octaves), go_on(source[t], octaves);
        for (int k = 0; k < air_temps; k++) go_on(emitted[t][k], octaves);
    }
    const int first = row * air_range_row;
    for (int g = 0; g < table->lights; g++)
        for (int lane = 0; lane < table->light[g]->bands; lane++) {
            cut_octaves(curve, sun[table->light[g]->band[lane]], true);
            put_curve(&table->light[g]->depth[first][lane], air_lights, curve);
        }
    for (int t = 0; t < 2; t++) {
        if (!(job->in.bands >> (AIR_MWIR + t) & 1)) continue;
        for (int k = 0; k < air_temps; k++) cut_octaves(warm[t][k], emitted[t][k], true);
        cut_octaves(warm[t][air_temps], own[t], true);
        cut_octaves(warm[t][air_temps + 1], source[t], false);
        for (int k = 0; k < air_temps - 1; k++) {
            float *out = &table->heat->value[k][first][t * air_warm_values];
            for (int r = 0; r <= air_ranges; r++, out += 2 * air_warm_values) {
                out[air_warm_own] = warm[t][air_temps][r];
                out[air_warm_low] = warm[t][k][r];
                out[air_warm_high] = warm[t][k + 1][r];
                out[air_warm_source] = warm[t][air_temps + 1][r];
            }
        }
    }
}

/* ---- scattered light ------------------------------------------------------------------------------- */

static double slope_root(const TableJob *job, int step)
{
    const AirTable *table = job->air->table;
    const int       first = job->first_slopes;
    if (first == 0 || step <= first) return (double)(table->slope_low + (float)(2 * step) / table->slope_steps);
    return (double)(table->slope_edge + (float)(2 * (step - first)) / table->slope_steps_above);
}

/* The path of a coarse node. */
static AirPath path_at(const TableJob *job, int slope_step, int share_step)
{
    const double eye_m = air_from_m(job->air);
    const double s = slope_root(job, slope_step);
    const double slope = clamp(s * fabs(s), -1, 1);
    const double whole_m = slope < 0 ? fmax(eye_m, air_least_fall_m) : air_top_m - eye_m;
    const double end_m = clamp(whole_m / fmax(fabs(slope), 1e-9), air_shortest_way_m, air_longest_m(job->air));
    const double share = fmax((double)share_step / coarse_shares, 0.01); /* not quite nothing */
    const double range_m = share * share * end_m;
    return (AirPath){.observer_m = eye_m, .range_m = range_m, .target_m = clamp(eye_m + slope * range_m, 0, air_top_m)};
}

static int slope_stride(const TableJob *job) { return job->first_slopes > 0 ? side_stride / 2 : side_stride; }

/* One slope: at the middle azimuth, and on a subset of the paths at all azimuths. */
static void ask_slope(TableJob *job, int i)
{
    const int     stride = slope_stride(job);
    double        seen[coarse_turns + 1][AIR_BAND_COUNT], sun[AIR_BAND_COUNT];
    const double *azimuth = job->azimuth_rad;
    for (int c = 0; c <= coarse_shares; c++) {
        const AirPath path = path_at(job, i, c);
        const bool    all = i % stride == 0 && c % side_stride == 0;
        if (all) air_day_scattered(seen, sun, job->air->light.day, &path, azimuth, job->turns + 1);
        else air_day_scattered(seen + job->middle, sun, job->air->light.day, &path, azimuth + job->middle, 1);
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            if (!scatters(job, b)) continue;
            job->log2_source[b][i * coarse_row + c] = log2_source(job, b, seen[job->middle][b], sun[b]);
            for (int a = 0; a <= job->turns && all; a++)
                job->side[b][a][i / stride * side_row + c / side_stride] = log2_source(job, b, seen[a][b], sun[b]);
        }
    }
}

/* Doubles the steps: cubic interpolation between four, at the ends between three. in: steps + 1, out: 2 steps + 1
 * values. */
static void halve_steps(double *out, int out_stride, const double *in, int in_stride, int steps)
{
    for (int i = 0; i < steps; i++) {
        const double *p = in + i * in_stride;
        const double  b = p[0], c = p[in_stride];
        const double  a = i > 0 ? p[-in_stride] : 3 * (b - c) + p[2 * in_stride];
        const double  d = i + 2 <= steps ? p[2 * in_stride] : 3 * (c - b) + p[-in_stride];
        out[2 * i * out_stride] = b;
        out[(2 * i + 1) * out_stride] = (9 * (b + c) - (a + d)) * (1.0 / 16);
    }
    out[2 * steps * out_stride] = in[steps * in_stride];
}

/* Along the paths. fine: [slopes + 1][2 shares + 1]. */
static void halve_shares(double *fine, const double *coarse, int slopes, int shares)
{
    for (int i = 0; i <= slopes; i++) halve_steps(fine + i * (2 * shares + 1), 1, coarse + i * (shares + 1), 1, shares);
}

/* Along both axes. fine: [2 slopes + 1][2 shares + 1]. first: steps of slope before the Earth's edge, over which
 * nothing is interpolated; 0: none. */
static void halve_both(double *fine, const double *coarse, int slopes, int shares, int first)
{
    const int row = shares + 1;
    double    wide[(2 * coarse_slopes + 1) * (coarse_shares + 1)];
    for (int c = 0; c <= shares; c++) {
        if (first > 0) halve_steps(wide + c, row, coarse + c, row, first);
        halve_steps(wide + 2 * first * row + c, row, coarse + first * row + c, row, slopes - first);
    }
    halve_shares(fine, wide, 2 * slopes, shares);
}

void air_table_draw(TableJob *job, int task)
{
    const AirTable *table = job->air->table;
    const int       group = task / air_lights, lane = task % air_lights;
    if (group >= table->lights || lane >= table->light[group]->bands) return;
    AirLight     *light = table->light[group];
    const AirBand band = light->band[lane];
    const double  more = log2(job->air->light.sky_scale[band]);
    /* every evaluated azimuth, on the coarse nodes; then as many between them */
    Coarse asked[coarse_turns + 1], turned[air_turns + 1];
    for (int a = 0; a <= job->turns; a++) {
        memcpy(asked[a], job->log2_source[band], sizeof asked[a]);
        if (a == job->middle) continue;
        Side      side;
        Coarse    half, ratio;
        const int stride = slope_stride(job), slopes = coarse_slopes / stride, first = job->first_slopes / 2;
        for (int i = 0; i <= slopes; i++)
            for (int c = 0; c <= side_shares; c++)
                side[i * side_row + c] = job->side[band][a][i * side_row + c] -
                                         job->log2_source[band][stride * i * coarse_row + side_stride * c];
        if (first > 0) halve_shares(half, side, slopes, side_shares);
        else halve_both(half, side, slopes, side_shares, 0);
        halve_both(ratio, half, coarse_slopes / 2, 2 * side_shares, first);
        for (int n = 0; n < coarse_nodes; n++) asked[a][n] += ratio[n];
    }
    for (int n = 0; n < coarse_nodes; n++)
        halve_steps(&turned[0][n], coarse_nodes, &asked[0][n], coarse_nodes, job->turns);
    for (int a = 0; a <= 2 * job->turns; a++) {
        double fine[air_slope_nodes];
        halve_both(fine, turned[a], coarse_slopes, coarse_shares, job->first_slopes);
        for (int n = 0; n < air_slope_nodes; n++) light->log2_source[a][n][lane] = (float)(fine[n] + more);
    }
}

/* ---- the complete table ---------------------------------------------------------------------------- */

/* As fine as memory allows. */
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

/* Equal steps to the Earth's edge and others from there, where paths begin to miss the ground. Close to the ends of
 * what is looked at, and from the ground, where hills hide the edge, one piece. */
static void choose_slopes(TableJob *job, double low, double high)
{
    AirTable    *table = job->air->table;
    const double edge = -sqrt(-air_edge_slope(job->air)), at = (edge - low) / (high - low) * coarse_slopes;
    table->slope_low = (float)low, table->slope_edge = INFINITY;
    table->slope_steps = table->slope_steps_above = (float)(air_slopes / (high - low));
    if (job->air->eye_height_m < air_ground_eye_m || !(at > 1) || !(at < coarse_slopes - 1)) return;
    job->first_slopes = 2 * (int)clamp(ceil(at / 2), 2, coarse_slopes / 2 - 2);
    table->slope_edge = (float)edge;
    table->slope_steps = (float)(2 * job->first_slopes / (edge - low));
    table->slope_steps_above = (float)(2 * (coarse_slopes - job->first_slopes) / (high - edge));
}

Status air_table_begin(TableJob **out, Air *air, const TableInput *input, Arena *arena)
{
    TableJob *job = arena_alloc(arena, 1, sizeof *job);
    AirTable *table = air->table = arena_alloc(arena, 1, sizeof *table);
    if (!job || !table) return STATUS_NO_MEMORY;
    job->air = air, job->in = *input;
    const double slope_low = copysign(sqrt(fabs(input->slope_low)), input->slope_low);
    const double slope_high = fmax(copysign(sqrt(fabs(input->slope_high)), input->slope_high), slope_low + 1e-3);
    const double turn_low = turn_of(input->azimuth_low_rad);
    const double turn_span = fmax(turn_of(input->azimuth_high_rad) - turn_low, 1e-3);
    /* evaluated over a sixth of the full circle at most, over a quarter of the view at least */
    job->turns = (int)clamp(ceil(turn_span * coarse_turns / sqrt(2) - 1e-9), 4, coarse_turns);
    job->middle = job->turns / 2;
    *table = (AirTable){
        .scattered = air->light.scattered_scale[AIR_PAN] > 0, .turn_low = (float)turn_low, .turns = 2 * job->turns};
    table->turn_steps = (float)(table->turns / turn_span);
    choose_slopes(job, slope_low, slope_high);
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
    for (int a = 0; a <= job->turns; a++) {
        const double steps = (double)a * table->turns / job->turns;
        job->azimuth_rad[a] = azimuth_rad((double)table->turn_low + steps / (double)table->turn_steps);
    }
    *out = job;
    return STATUS_OK;
}

/* Slopes first: each takes longer than a height. */
static int slope_asks(const TableJob *job)
{
    bool any = false;
    for (int b = 0; b < AIR_BAND_COUNT; b++) any |= scatters(job, b);
    return any ? coarse_slopes + 1 : 0;
}

int air_table_asks(const TableJob *job) { return slope_asks(job) + job->air->table->rows + 1; }

void air_table_ask(TableJob *job, int ask)
{
    const int slopes = slope_asks(job);
    if (ask < slopes) ask_slope(job, ask);
    else ask_height(job, ask - slopes);
}

int air_table_draws(const TableJob *job) { return slope_asks(job) > 0 ? 2 * air_lights : 0; }
