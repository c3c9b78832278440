/* render/air/atmosphere_day.c: the formulas of render/air/atmosphere.c for one day, in loops over bands and steps;
 * only what does not change in a loop is taken out of it. */
#include "render/air/atmosphere.h"

#include "render/air/atmosphere_private.h"

#include <assert.h>

enum { path_steps = 8, sky_steps = 12, steps_room = 16, shapes_max = 8, azimuths_room = path_max_suns };

/* ---- vectorised exponentials -------------------------------------------------------------------- */

/* Within 3e-16 of exp for -700 .. 700, clamped beyond: 2^k e^r, |r| <= ln(2) / 2, by Taylor's thirteen terms; no
 * branch and no call, so that a loop over it vectorises eight wide. */
static inline double exp_here(double x)
{
    static const double round_to_whole = 0x1.8p52, ln2_high = 0x1.62e42fefa3800p-1, ln2_low = 0x1.ef35793c76730p-45;
    x = x < -700 ? -700 : x > 700 ? 700 : x;
    const double shifted = x * 1.4426950408889634 + round_to_whole, k = shifted - round_to_whole;
    const double r = (x - k * ln2_high) - k * ln2_low;
    double       p = 1.0 / 479001600;
    p = p * r + 1.0 / 39916800;
    p = p * r + 1.0 / 3628800;
    p = p * r + 1.0 / 362880;
    p = p * r + 1.0 / 40320;
    p = p * r + 1.0 / 5040;
    p = p * r + 1.0 / 720;
    p = p * r + 1.0 / 120;
    p = p * r + 1.0 / 24;
    p = p * r + 1.0 / 6;
    p = p * r + 0.5;
    p = p * r + 1;
    p = p * r + 1;
    uint64_t bits;
    double   scale;
    memcpy(&bits, &shifted, sizeof bits);
    bits = (bits + 1023) << 52; /* the integer is in the lowest bits */
    memcpy(&scale, &bits, sizeof scale);
    return p * scale;
}

/* ---- air by height ------------------------------------------------------------------------------ */

typedef struct Place {
    int    i;
    double t, part_m; /* share of the upper node, and its amount for a metre count */
} Place;

static inline Place place_at(const DayColumn *c, double height_m)
{
    const double h_m = clamp(height_m, 0, c->top_m);
    int          i = c->start[(int)(h_m * c->per_bucket_m)];
    while (i + 2 < c->nodes && c->height_m[i + 1] <= h_m) i++;
    const double step_m = c->height_m[i + 1] - c->height_m[i], t = fmax((h_m - c->height_m[i]) / step_m, 0);
    return (Place){i, fmin(t, 1), fmin(t, 1) * step_m};
}

static inline double value_at(const double *value, const Place *p)
{
    return value[p->i] + p->t * (value[p->i + 1] - value[p->i]);
}
static inline double sum_at(const double *value, const double *sum, const Place *p)
{
    return sum[p->i] + p->part_m * (value[p->i] + 0.5 * p->t * (value[p->i + 1] - value[p->i]));
}

/* Two heights and the air between them. */
typedef struct Span {
    Place  a, b, middle;
    double rise_m;
} Span;

static Span span_of(const DayColumn *c, double a_m, double b_m)
{
    const double low_m = clamp(a_m, 0, c->top_m), high_m = clamp(b_m, 0, c->top_m);
    return (Span){place_at(c, low_m), place_at(c, high_m), place_at(c, 0.5 * (low_m + high_m)), high_m - low_m};
}

static double mean_of(const double *value, const double *sum, const Span *s)
{
    if (fabs(s->rise_m) < 1) return value_at(value, &s->middle);
    return (sum_at(value, sum, &s->b) - sum_at(value, sum, &s->a)) / s->rise_m;
}

static double clear_mean(const AirDay *day, AirBand band, const Span *s)
{
    return mean_of(day->column.clear[band], day->column.clear_sum[band], s);
}

/* As blend_haze of atmosphere.c has it. */
static double haze_of(const AirDay *day, double low, double high)
{
    return day->hazes ? day->blend.haze_low * low + day->blend.haze_high * high : day->blend.haze_low * low;
}

static double haze_mean(const AirDay *day, AirBand band, const Span *s)
{
    const DayColumn *c = &day->column;
    return haze_of(day, mean_of(c->haze[0][band], c->haze_sum[0][band], s),
                   day->hazes ? mean_of(c->haze[1][band], c->haze_sum[1][band], s) : 0);
}

static double haze_scatter(const AirDay *day, AirBand band, const Place *p)
{
    return haze_of(day, value_at(day->column.haze_scatter[0][band], p), value_at(day->column.haze_scatter[1][band], p));
}

/* ---- extinction of a path ------------------------------------------------------------------------ */

/* A path in the tables; paths of equal shape share its stencil. */
typedef struct Stencils {
    int     count, shape[shapes_max];
    Stencil at[shapes_max];
} Stencils;

static const Stencil *stencil_in(Stencils *known, const PathTable *table, double observer_m, double second,
                                 double range_m)
{
    int k = 0;
    while (k < known->count && known->shape[k] != table->shape) k++;
    if (k == known->count) {
        if (known->count < shapes_max) known->count++;
        else k = shapes_max - 1;
        known->shape[k] = table->shape;
        stencil_at(&known->at[k], table, observer_m, second, range_m);
    }
    return &known->at[k];
}

/* All values of a table's row, of which there may be this many. */
enum { row_values = path_max_weights + 1 };
static void values_in(double out[row_values], const PathTable *table, const Stencil *s)
{
    for (int v = 0; v < row_values; v++) out[v] = 0;
    for (int p = 0; p < s->count; p++) {
        const double *row = table->value + (size_t)s->row[p] * (size_t)table->values, share = s->share[p];
        for (int v = 0; v < table->values; v++) out[v] += share * row[v];
    }
}

typedef struct Depths {
    Stencils stencils;
    int      pieces; /* of the path in pieces also the whole one, by its share */
    double   piece_m[air_pieces_max + 1];
    Span     span[air_pieces_max + 1]; /* lowered by the chord error of the round Earth */
    AirPath  path;
} Depths;

static void add_piece(Depths *out, const AirDay *day, const AirPath *piece, double share)
{
    const double sag_m = mean_chord_error_m(piece->range_m);
    if (!(share > 0)) return;
    out->piece_m[out->pieces] = share * piece->range_m;
    out->span[out->pieces++] = span_of(&day->column, piece->observer_m - sag_m, piece->target_m - sag_m);
}

static void begin_depths(Depths *out, const AirDay *day, const AirPath *path)
{
    AirPath      piece[air_pieces_max];
    const int    pieces = air_leg_pieces(piece, path);
    const double share = pieces > 1 ? air_pieces_share(path) : 0;
    out->stencils.count = 0;
    out->path = *path;
    out->pieces = 0;
    add_piece(out, day, path, 1 - share);
    for (int i = 0; i < pieces; i++) add_piece(out, day, &piece[i], share);
}

/* Values of the three tables of a band, and depths from the columns alone: clear, haze. */
static void depths_of(double value[3][row_values], double plain[2], Depths *d, const AirDay *day, AirBand band)
{
    const AirPath *p = &d->path;
    for (int which = 0; which < (day->hazes ? 3 : 2); which++) {
        const PathTable *table = table_of(day, band, which);
        values_in(value[which], table, stencil_in(&d->stencils, table, p->observer_m, p->target_m, p->range_m));
    }
    plain[0] = plain[1] = 0;
    for (int i = 0; i < d->pieces; i++) {
        plain[0] += d->piece_m[i] * clear_mean(day, band, &d->span[i]);
        plain[1] += d->piece_m[i] * haze_mean(day, band, &d->span[i]);
    }
}

static double depth_of(const AirDay *day, const double plain[2], double clear, double low, double high)
{
    const double haze = day->hazes ? low + day->blend.share * (high - low) : low;
    return plain[0] * exp_here(clear) + plain[1] * fmax(haze, 0);
}

static double weight_of(const double value[row_values], DayTemp temp)
{
    return temp.share > 0 ? value[temp.low] + temp.share * (value[temp.low + 1] - value[temp.low]) : value[temp.low];
}

void day_leg_path(DayPath *out, const AirDay *day, unsigned bands, const AirPath *leg)
{
    const AirPath p = *leg;
    double        value[3][row_values], plain[2];
    Depths        d;
    *out = (DayPath){0};
    if (!(p.range_m > 0)) return;
    begin_depths(&d, day, &p);
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        if (!wants(day->parts & bands, b)) continue;
        depths_of(value, plain, &d, day, b);
        out->sun[b] = depth_of(day, plain, value[0][0], value[1][0], value[2][0]);
        if (!air_band_is_thermal(b)) continue;
        const int        k = b - AIR_MWIR, emits = path_emission_weight(table_of(day, b, 1));
        const PathTable *low = table_of(day, b, 1), *high = table_of(day, b, 2);
        const double     emit_k = low->weight_temp_k[emits];
        DayTemp          at[3];
        for (int which = 0; which < 3; which++) at[which] = temp_in(table_of(day, b, which), emit_k);
        for (int t = 0; t < day->temps; t++)
            out->emitted[k][t] =
                depth_of(day, plain, weight_of(value[0], day->temp[k][0][t]), weight_of(value[1], day->temp[k][1][t]),
                         day->hazes ? weight_of(value[2], day->temp[k][2][t]) : 0);
        const double own = depth_of(day, plain, weight_of(value[0], at[0]), weight_of(value[1], at[1]),
                                    day->hazes ? weight_of(value[2], at[2]) : 0);
        double       ln_opaque = value[1][low->weights];
        if (day->hazes) ln_opaque += day->blend.share * (value[2][high->weights] - ln_opaque);
        out->own[k] = own;
        out->thermal_w_m2_sr[k] =
            exp_here(ln_opaque) * mean_black(day->atmosphere, b, p.observer_m, p.target_m) * -expm1(-own);
    }
}

/* ---- scattered light of a path ------------------------------------------------------------------ */

/* Steps of a path, for every band. */
typedef struct Steps {
    int    count;
    double step_m[steps_room];
    Span   span[steps_room];
    int    sun_i[2][steps_room], phase_i[steps_room];
    double sun_t[2][steps_room], phase_t[steps_room];
} Steps;

static void add_step(Steps *s, const AirDay *day, double a_m, double b_m, double step_m)
{
    const int    k = s->count++;
    const double middle_m = (a_m + b_m) / 2;
    s->step_m[k] = step_m;
    s->span[k] =
        (Span){k > 0 ? s->span[k - 1].b : place_at(&day->column, a_m), place_at(&day->column, b_m),
               place_at(&day->column, middle_m), clamp(b_m, 0, day->column.top_m) - clamp(a_m, 0, day->column.top_m)};
    s->sun_i[0][k] = interval_of(&s->sun_t[0][k], day->sun[0].height_m, day->sun[0].nodes, middle_m);
    if (day->hazes && day->suns_alike) {
        s->sun_i[1][k] = s->sun_i[0][k];
        s->sun_t[1][k] = s->sun_t[0][k];
    } else if (day->hazes) {
        s->sun_i[1][k] = interval_of(&s->sun_t[1][k], day->sun[1].height_m, day->sun[1].nodes, middle_m);
    }
    const Grid *phase = &day->atmosphere->phase;
    s->phase_i[k] = interval_of(&s->phase_t[k], phase->axis[0], phase->nodes[0], middle_m);
}

static double between(const double *value, int i, double t)
{
    return t > 0 ? value[i] + t * (value[i + 1] - value[i]) : value[i];
}

/* Exponentials are computed in eights; the arrays behind the steps are padded for that. */
static int lanes_of(const Steps *s) { return (s->count + 7) & ~7; }

/* Direct and diffuse sunlight over their top, at the middle of every step. */
static void sun_at_steps(double direct[steps_room], double diffuse[steps_room], const AirDay *day, AirBand band,
                         const Steps *s)
{
    const int lanes = lanes_of(s);
    double    ln_depth[2][steps_room] = {{0}}, ln_diffuse[2][steps_room] = {{0}};
    for (int which = 0; which <= day->hazes; which++)
        for (int k = 0; k < s->count; k++) {
            ln_depth[which][k] = between(day->sun[which].ln_depth[band], s->sun_i[which][k], s->sun_t[which][k]);
            ln_diffuse[which][k] = between(day->sun[which].ln_diffuse[band], s->sun_i[which][k], s->sun_t[which][k]);
        }
    if (!day->hazes) {
        for (int k = 0; k < lanes; k++) {
            direct[k] = exp_here(-exp_here(ln_depth[0][k]));
            diffuse[k] = exp_here(ln_diffuse[0][k]);
        }
        return;
    }
    const double low = day->blend.haze_low, high = day->blend.haze_high;
    for (int k = 0; k < lanes; k++) {
        const double clearest = exp_here(ln_depth[1][k]), depth = low * exp_here(ln_depth[0][k]) + high * clearest;
        direct[k] = exp_here(-(depth > 0.3 * clearest ? depth : 0.3 * clearest));
    }
    for (int k = 0; k < lanes; k++) {
        const double clearest = exp_here(ln_diffuse[1][k]), d = low * exp_here(ln_diffuse[0][k]) + high * clearest;
        const double least = 0.3 * clearest;
        diffuse[k] = d < least ? least : d > 1 ? 1 : d;
    }
}

/* Mean over each step, of which one begins where the last ended. */
static void means_of(double out[steps_room], const double *value, const double *sum, const Steps *s)
{
    double before = sum_at(value, sum, &s->span[0].a);
    for (int k = 0; k < s->count; k++) {
        const Span  *span = &s->span[k];
        const double behind = sum_at(value, sum, &span->b);
        out[k] = fabs(span->rise_m) < 1 ? value_at(value, &span->middle) : (behind - before) / span->rise_m;
        before = behind;
    }
}

/* scatter_parts of atmosphere_paths.c, for precomputed steps. ratio: depth over that of the columns. */
static void parts_of(ScatterParts *out, const AirDay *day, AirBand band, const Steps *s, double ratio)
{
    const DayColumn *c = &day->column;
    const double     top = day->atmosphere->sun_top_w_m2[band];
    const int        lanes = lanes_of(s);
    double           direct[steps_room], diffuse[steps_room], depth[steps_room + 1] = {0}, left[steps_room + 1];
    double           clear_means[steps_room], low_means[steps_room], high_means[steps_room] = {0};
    *out = (ScatterParts){0};
    sun_at_steps(direct, diffuse, day, band, s);
    means_of(clear_means, c->clear[band], c->clear_sum[band], s);
    means_of(low_means, c->haze[0][band], c->haze_sum[0][band], s);
    if (day->hazes) means_of(high_means, c->haze[1][band], c->haze_sum[1][band], s);
    for (int k = 0; k < s->count; k++)
        depth[k + 1] = depth[k] + ratio * s->step_m[k] * (clear_means[k] + haze_of(day, low_means[k], high_means[k]));
    for (int k = 0; k < lanes; k++) left[k] = exp_here(-depth[k]);
    left[s->count] = exp_here(-depth[s->count]);
    for (int k = 0; k < s->count; k++) {
        const double d = depth[k + 1] - depth[k];
        const double seen_m = s->step_m[k] * (d > 1e-6 ? (left[k] - left[k + 1]) / d : left[k]) / (4 * pi_rad);
        const double clear = seen_m * value_at(c->clear_scatter[band], &s->span[k].middle);
        const double haze = seen_m * haze_scatter(day, band, &s->span[k].middle);
        const double sun = top * direct[k], sky = top * diffuse[k];
        out->clear += clear * sun;
        out->haze[s->phase_i[k]] += (1 - s->phase_t[k]) * haze * sun;
        if (s->phase_t[k] > 0) out->haze[s->phase_i[k] + 1] += s->phase_t[k] * haze * sun;
        out->glow += (clear + haze) * (2 * sky + 0.4 * (sky + sun * day->sun_cos));
    }
}

/* A direction's scattering angle, in the phase function. */
typedef struct Angle {
    double cosine, t;
    int    i;
} Angle;

static Angle angle_of(const AirDay *day, double up, double azimuth_rad)
{
    const Grid *phase = &day->atmosphere->phase;
    Angle       a = {.cosine = up * day->sun_cos + sqrt(fmax(1 - up * up, 0)) * day->sun_sin * cos(azimuth_rad)};
    a.i = interval_of(&a.t, phase->axis[1], phase->nodes[1], acos(clamp(a.cosine, -1, 1)));
    return a;
}

static double estimate(const ScatterParts *parts, const AirDay *day, AirBand band, const Angle *a)
{
    const Grid   *phase = &day->atmosphere->phase;
    const double *ln_haze = phase->value + a->i * air_tabled_count + air_tabled_index(band);
    double        sum = 0.75 * (1 + a->cosine * a->cosine) * parts->clear + parts->glow;
    for (int i = 0; i < phase->nodes[0]; i++, ln_haze += phase->nodes[1] * air_tabled_count)
        if (parts->haze[i] > 0)
            sum += parts->haze[i] *
                   exp_here(a->t > 0 ? ln_haze[0] + a->t * (ln_haze[air_tabled_count] - ln_haze[0]) : ln_haze[0]);
    return sum;
}

/* Between two azimuths of [azimuths][air_tabled_count] values. */
static void at_azimuth(double out[air_tabled_count], const double *value, const double *azimuth_deg, int azimuths,
                       double azimuth_rad)
{
    double        t;
    const int     j = interval_of(&t, azimuth_deg, azimuths, azimuth_rad / rad_per_deg);
    const double *low = value + j * air_tabled_count, *high = t > 0 ? low + air_tabled_count : low;
    for (int k = 0; k < air_tabled_count; k++) out[k] = low[k] + t * (high[k] - low[k]);
}

void day_leg_scattered(double (*w_m2_sr)[AIR_BAND_COUNT], double sun[AIR_BAND_COUNT], const AirDay *day,
                       const AirPath *leg, const double *azimuth_rad, int azimuths)
{
    const AirPath p = *leg;
    const double  up = path_up(&p), rise_m = p.target_m - p.observer_m;
    double        value[3][row_values], plain[2], ratio[2][azimuths_room * air_tabled_count], at[2][air_tabled_count];
    ScatterParts  parts[AIR_BAND_COUNT];
    Depths        d;
    Steps         steps = {0};
    memset(w_m2_sr, 0, (size_t)azimuths * sizeof *w_m2_sr);
    for (int b = 0; b < AIR_BAND_COUNT; b++) sun[b] = 0;
    if (!(p.range_m > 0)) return;
    begin_depths(&d, day, &p);
    const bool lit = day->sun_zenith_rad <= pi_rad / 2;
    for (int i = 0; i < path_steps && lit; i++)
        add_step(&steps, day, p.observer_m + rise_m * i / path_steps, p.observer_m + rise_m * (i + 1) / path_steps,
                 p.range_m / path_steps);
    const Span whole = span_of(&day->column, p.observer_m, p.target_m);
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        if (!wants(day->parts, b)) continue;
        depths_of(value, plain, &d, day, b);
        sun[b] = depth_of(day, plain, value[0][0], value[1][0], value[2][0]);
        if (!lit) continue;
        parts_of(&parts[b], day, b, &steps,
                 sun[b] / (clear_mean(day, b, &whole) + haze_mean(day, b, &whole)) / p.range_m);
    }
    if (!lit) return;

    d.stencils.count = 0;
    for (int which = 0; which <= day->hazes; which++) {
        const PathTable *table = &slice_of(day, which)->scattered;
        const Stencil   *s = stencil_in(&d.stencils, table, p.observer_m, -up, p.range_m);
        const int        values = table->azimuths * air_tabled_count;
        for (int v = 0; v < values; v++) ratio[which][v] = 0;
        for (int k = 0; k < s->count; k++) {
            const double *row = day->ratio[which] + (size_t)s->row[k] * (size_t)values, share = s->share[k];
            for (int v = 0; v < values; v++) ratio[which][v] += share * row[v];
        }
    }
    for (int a = 0; a < azimuths; a++) {
        const Angle angle = angle_of(day, up, azimuth_rad[a]);
        for (int which = 0; which <= day->hazes; which++) {
            const PathTable *table = &slice_of(day, which)->scattered;
            at_azimuth(at[which], ratio[which], table->azimuth_deg, table->azimuths, azimuth_rad[a]);
        }
        for (int k = 0; k < air_tabled_count; k++) {
            const AirBand b = air_tabled[k];
            if (!wants(day->parts, b)) continue;
            const double r = day->hazes ? at[0][k] + day->blend.share * (at[1][k] - at[0][k]) : at[0][k];
            w_m2_sr[a][b] = fmax(r, 0) * estimate(&parts[b], day, b, &angle);
        }
    }
}

/* ---- the sky ------------------------------------------------------------------------------------ */

/* The ratios of one visibility at a height and a zenith angle: [azimuth][air_tabled_count]. */
static void sky_ratio(double out[azimuths_room * air_tabled_count], const AirDay *day, int which, double observer_m,
                      double x)
{
    const Grid *grid = &slice_of(day, which)->sky_scattered;
    const int   inner = grid->nodes[3] * grid->values;
    double      s, t;
    const int   i = interval_of(&s, grid->axis[0], grid->nodes[0], observer_m);
    const int   j = interval_of(&t, grid->axis[1], grid->nodes[1], x);
    for (int v = 0; v < inner; v++) out[v] = 0;
    for (int corner = 0; corner < 4; corner++) {
        const double share = (corner & 1 ? s : 1 - s) * (corner & 2 ? t : 1 - t);
        if (share == 0) continue;
        const double *value = day->sky[which] + ((i + (corner & 1)) * grid->nodes[1] + j + (corner >> 1)) * inner;
        for (int v = 0; v < inner; v++) out[v] += share * value[v];
    }
}

void day_sky_above(double (*w_m2_sr)[AIR_BAND_COUNT], double thermal_w_m2_sr[2], const AirDay *day, double observer_m,
                   double zenith_rad, const double *azimuth_rad, int azimuths)
{
    const AirColumn *clear = &day->atmosphere->clear;
    const double     zenith = clamp(zenith_rad, 0, pi_rad / 2), eye_m = fmax(observer_m, 0), x = slant_x(zenith),
                 up = cos(zenith);
    const double at[2] = {eye_m, x}, slant = air_mass(zenith);
    const double rise_m = fmin(clear->height_m[clear->nodes - 1], 40000) - eye_m;
    double       ratio[2][azimuths_room * air_tabled_count], here[2][air_tabled_count];
    ScatterParts parts[AIR_BAND_COUNT];
    Steps        steps = {0};
    memset(w_m2_sr, 0, (size_t)azimuths * sizeof *w_m2_sr);
    for (int k = 0; k < 2; k++) {
        double low[2], high[2];
        thermal_w_m2_sr[k] = 0;
        if (!wants(day->parts, AIR_MWIR + k)) continue;
        grid_at(low, &day->blend.low->sky_thermal, at);
        grid_at(high, &day->blend.high->sky_thermal, at);
        thermal_w_m2_sr[k] = exp_here(low[k] + day->blend.share * (high[k] - low[k])) *
                             black_air(day->atmosphere, (AirBand)(AIR_MWIR + k), eye_m);
    }
    if (!(day->sun_zenith_rad <= pi_rad / 2)) return;
    for (int i = 0; i < sky_steps && rise_m > 0; i++) {
        const double s = (double)i / sky_steps, t = (double)(i + 1) / sky_steps;
        const double a_m = eye_m + rise_m * s * s, b_m = eye_m + rise_m * t * t;
        add_step(&steps, day, a_m, b_m, slant * (b_m - a_m));
    }
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++)
        if (wants(day->parts, b)) parts_of(&parts[b], day, b, &steps, 1);
    for (int which = 0; which <= day->hazes; which++) sky_ratio(ratio[which], day, which, eye_m, x);
    for (int a = 0; a < azimuths; a++) {
        const Angle angle = angle_of(day, up, azimuth_rad[a]);
        for (int which = 0; which <= day->hazes; which++) {
            const Grid *grid = &slice_of(day, which)->sky_scattered;
            at_azimuth(here[which], ratio[which], grid->axis[3], grid->nodes[3], azimuth_rad[a]);
        }
        for (int k = 0; k < air_tabled_count; k++) {
            const AirBand b = air_tabled[k];
            if (!wants(day->parts, b)) continue;
            const double r = day->hazes ? here[0][k] + day->blend.share * (here[1][k] - here[0][k]) : here[0][k];
            w_m2_sr[a][b] = fmax(r, 0) * estimate(&parts[b], day, b, &angle);
        }
    }
}
