/* render/air/atmosphere_weather.c: a model's air under a weather: clear air mixed of the nodes of
 * etc/atmosphere/vapour.bin by temperature and water vapour at the ground; the model's haze, swollen by the humidity.
 * What the tables have in ratios to an estimate (path radiance, scattered light) keeps the model's ratios, and the
 * estimates follow the air. */
#include "render/air/atmosphere_private.h"

/* ---- the sun ------------------------------------------------------------------------------------- */

/* Depth of clear air to space, of the mix (now) and of the model's own air. */
static void clear_to_space(double *now, double *own, const Atmosphere *a, AirBand band, double height_m, double slant)
{
    const Vapour *v = a->vapour;
    const int     channel = a->vapour_channel[band], own_node = v->profile[a->vapour_profile].own;
    double        s, t, ln_now = 0, ln_own = 0;
    const int     i = interval_of(&s, v->sun_m, v->sun[0], height_m);
    const int     j = interval_of(&t, v->sun_slant, v->sun[1], slant);
    for (int corner = 0; corner < 4; corner++) {
        const double share = (corner & 1 ? s : 1 - s) * (corner & 2 ? t : 1 - t);
        if (share == 0) continue;
        const size_t at = vapour_sun_at(v, channel) + (size_t)((i + (corner & 1)) * v->sun[1] + j + (corner >> 1));
        ln_now += share * log(fmax(vapour_mixed(v, a->mix, at, v->channel[channel].self), 1e-12));
        ln_own += share * log(fmax((double)vapour_node(v, own_node)[at], 1e-12));
    }
    *now = exp(ln_now);
    *own = exp(ln_own);
}

static VapourPlace place_in(const Vapour *v, double height_m)
{
    VapourPlace at = {.height_m = height_m};
    at.cell = interval_of(&at.share, v->height_m, v->heights, height_m);
    return at;
}

static double haze_scale(const Atmosphere *a, AirBand band, int part, const VapourPlace *at)
{
    return vapour_haze_scale(a->vapour, a->mix, a->vapour_profile, a->vapour_channel[band], part, at);
}

/* Vertical depth that the weather adds to the haze above a height, in steps that serve daylight and its sums alike. */
static double haze_above(const Atmosphere *a, const Slice *slice, AirBand band, double height_m)
{
    static const double at_m[] = {0, 1000, 2000, 3000, 5000, 8000, 12000, 30000};
    const AirColumn    *haze = slice->from ? &slice->from->haze : &slice->haze;
    double              sum = 0, low = NAN;
    for (size_t i = 0; i + 1 < sizeof at_m / sizeof *at_m; i++) {
        if (at_m[i + 1] <= height_m) continue;
        const double      low_m = fmax(at_m[i], height_m), high_m = at_m[i + 1];
        const VapourPlace from = place_in(a->vapour, low_m), to = place_in(a->vapour, high_m);
        if (isnan(low)) low = haze_scale(a, band, 0, &from);
        const double high = haze_scale(a, band, 0, &to);
        sum += (high_m - low_m) * column_mean(haze, band, low_m, high_m) * (0.5 * (low + high) - 1);
        low = high;
    }
    return sum;
}

void sun_node(double out[2], const Atmosphere *atmosphere, const Slice *slice, AirBand band, int height, double slant)
{
    const Grid   *grid = &slice->sun;
    double        t;
    const int     j = interval_of(&t, grid->axis[1], grid->nodes[1], slant), k = air_tabled_index(band);
    const double *low = grid->value + (height * grid->nodes[1] + j) * grid->values + k,
                 *high = t > 0 ? low + grid->values : low;
    out[0] = low[0] + t * (high[0] - low[0]);
    out[1] = low[air_tabled_count] + t * (high[air_tabled_count] - low[air_tabled_count]);
    if (!atmosphere->mix || atmosphere->vapour_channel[band] < 0) return;
    double now, own;
    clear_to_space(&now, &own, atmosphere, band, grid->axis[0][height], slant);
    const double more = exp(slant) * haze_above(atmosphere, slice, band, grid->axis[0][height]);
    out[0] = log(clamp(exp(out[0]) + now - own + more, 1e-12, 690));
    /* light from all sides comes through as much absorbing air as that of the sun, about */
    out[1] = fmin(out[1] - clamp(now - own, -1, 5), 0);
}

/* ---- the mix ------------------------------------------------------------------------------------- */

/* What needs no memory beyond a few hundred numbers; the rest of the air is the model's. */
static void begin(Atmosphere *out, VapourMix *mix, double *level_k, const Atmosphere *model, const AirState *state)
{
    const Vapour *v = model->vapour;
    vapour_mix(mix, v, state->temp_k, state->vapour_kg_m3);
    for (int i = 0; i < v->levels; i++) {
        level_k[i] = 0;
        for (int k = 0; k < mix->profiles; k++)
            level_k[i] += mix->profile_share[k] * (double)v->profile[mix->profile[k]].level_k[i];
    }
    out->slices = model->slices, out->slice = model->slice;
    out->low_m = model->low_m, out->high_m = model->high_m;
    memcpy(out->sun_top_w_m2, model->sun_top_w_m2, sizeof out->sun_top_w_m2);
    memcpy(out->planck, model->planck, sizeof out->planck);
    out->temperature = model->temperature, out->temperature.value = level_k;
    out->phase = model->phase, out->limb = model->limb, out->solar = model->solar;
    out->vapour = model->vapour, out->vapour_profile = model->vapour_profile, out->vapour_row = model->vapour_row;
    memcpy(out->vapour_channel, model->vapour_channel, sizeof out->vapour_channel);
    out->mix = mix;
}

static bool follows(const Atmosphere *model, const AirState *state)
{
    return model->vapour && !model->mix && isfinite(state->temp_k) && isfinite(state->vapour_kg_m3);
}

const Atmosphere *atmosphere_sums_in(AirSums *room, const Atmosphere *model, const AirState *state)
{
    if (!follows(model, state)) return model;
    begin(&room->air, &room->mix, room->level_k, model, state);
    return &room->air;
}

/* ---- clear air and its paths --------------------------------------------------------------------- */

/* Natural logarithm of a normal number above 0, within 1e-14: the exponent, and 2 atanh((m - 1) / (m + 1)) of the
 * mantissa m, sqrt(1/2) .. sqrt(2), by the series; no branch and no call, so that a loop over it vectorises. */
static inline double log_here(double x)
{
    static const double ln2 = 0.69314718055994530942;
    uint64_t            bits, mantissa_bits;
    double              mantissa, exponent;
    memcpy(&bits, &x, sizeof bits);
    const uint64_t from_root = bits - 0x3fe6a09e667f3bcdull; /* sqrt(1/2) */
    mantissa_bits = (from_root & 0x000fffffffffffffull) + 0x3fe6a09e667f3bcdull;
    memcpy(&mantissa, &mantissa_bits, sizeof mantissa);
    /* the exponent's bits as a number: those of 2^52 plus it, less 2^52 and the sign's 2^11 / 2 */
    const uint64_t steps = ((from_root >> 52) ^ 0x800ull) | 0x4330000000000000ull;
    memcpy(&exponent, &steps, sizeof exponent);
    exponent -= 0x1p52 + 2048;
    const double z = (mantissa - 1) / (mantissa + 1), y = z * z;
    double       p = 1.0 / 21;
    p = p * y + 1.0 / 19;
    p = p * y + 1.0 / 17;
    p = p * y + 1.0 / 15;
    p = p * y + 1.0 / 13;
    p = p * y + 1.0 / 11;
    p = p * y + 1.0 / 9;
    p = p * y + 1.0 / 7;
    p = p * y + 1.0 / 5;
    p = p * y + 1.0 / 3;
    return exponent * ln2 + 2 * (z + z * y * p);
}

static void mix_floats(double *out, const Vapour *v, const VapourMix *mix, size_t at, int count, bool self)
{
    for (int i = 0; i < count; i++) out[i] = 0;
    for (int k = 0; k < mix->nodes; k++) {
        const float *from = vapour_node(v, mix->node[k]) + at;
        const double share = mix->share[self][k];
        for (int i = 0; i < count; i++) out[i] += share * (double)from[i];
    }
}

static void fill_clear(Atmosphere *out, const Atmosphere *model, unsigned bands)
{
    const Vapour *v = model->vapour;
    out->clear = model->clear;
    AirColumn *clear = &out->clear;
    for (int k = 0; k < air_tabled_count; k++) {
        const AirBand b = air_tabled[k];
        const int     c = model->vapour_channel[b];
        if (c < 0 || !(bands >> b & 1)) continue;
        const bool self = v->channel[c].self;
        mix_floats(clear->per_m[b], v, out->mix, vapour_air_at(v, c), v->heights, self);
        mix_floats(clear->scatter_per_m[b], v, out->mix, vapour_scatter_at(v, c), v->heights, self);
        for (int i = 0; i < v->heights; i++) {
            clear->per_m[b][i] = 1e-3 * fmax(clear->per_m[b][i], 1e-12);
            clear->scatter_per_m[b][i] = 1e-3 * fmax(clear->scatter_per_m[b][i], 0);
        }
        column_sum_up(clear, clear->per_m[b], clear->sum[b]);
    }
    column_black(clear, out);
}

/* The depths of the file's rows, mixed, become ln of their ratio to the column's in the rows of the table. */
static Status fill_paths(Atmosphere *out, const Atmosphere *model, AirBand band, Arena *arena)
{
    const Vapour        *v = model->vapour;
    const int            c = model->vapour_channel[band];
    const PathTable     *from = &model->clear_path[band];
    const VapourChannel *channel = &v->channel[c];
    const int            count = v->rows * channel->weights;
    double              *depth = arena_alloc_raw(arena, (size_t)count, sizeof *depth);
    double              *value = arena_alloc_raw(arena, (size_t)from->rows * (size_t)from->values, sizeof *value);
    if (!depth || !value) return STATUS_NO_MEMORY;
    mix_floats(depth, v, out->mix, vapour_path_at(v, c), count, channel->self);
    for (int i = 0, row = 0, pair = 0; i < v->ends; i++)
        for (int j = i; j < v->ends; j++, pair++) {
            const double mean = column_mean(&out->clear, band, v->end_m[i], v->end_m[j]);
            for (int k = 0; k < (int)v->ranges[pair]; k++, row++) {
                double      *at = depth + row * channel->weights;
                const double plain = v->range_m[row] * mean;
                for (int w = 0; w < channel->weights; w++) at[w] = (at[w] > 1e-12 ? at[w] : 1e-12) / plain;
            }
        }
    for (int i = 0; i < count; i++) depth[i] = log_here(depth[i]);
    for (int row = 0; row < from->rows; row++)
        memcpy(value + row * from->values, depth + model->vapour_row[row] * channel->weights,
               (size_t)channel->weights * sizeof *value);
    out->clear_path[band].value = value;
    return STATUS_OK;
}

/* ---- haze and the sky ---------------------------------------------------------------------------- */

static void scale_haze(AirColumn *haze, const Atmosphere *a, unsigned bands)
{
    VapourPlace at[column_max];
    for (int n = 0; n < haze->nodes; n++) at[n] = place_in(a->vapour, haze->height_m[n]);
    for (int k = 0; k < air_tabled_count; k++) {
        const AirBand b = air_tabled[k];
        if (a->vapour_channel[b] < 0 || !(bands >> b & 1)) continue;
        for (int n = 0; n < haze->nodes; n++) {
            haze->per_m[b][n] *= haze_scale(a, b, 0, &at[n]);
            haze->scatter_per_m[b][n] *= haze_scale(a, b, 1, &at[n]);
        }
        column_sum_up(haze, haze->per_m[b], haze->sum[b]);
    }
}

/* What the weather adds to the sky's ratio to black air: linear in 1 / visibility between those of the file, and of
 * denser haze as what the model's own leaves of the sky behind it. */
typedef struct SkyChange {
    double *own[2], *more[2]; /* by the file's visibilities: [2 bands][height][zenith angle] */
} SkyChange;

static Status fill_sky_change(SkyChange *out, const Atmosphere *a, Arena *arena)
{
    const Vapour *v = a->vapour;
    const int     count = v->sky[0] * v->sky[1];
    const float  *own = vapour_node(v, v->profile[a->vapour_profile].own);
    for (int which = 0; which < 2; which++) {
        out->own[which] = arena_alloc_raw(arena, 2 * (size_t)count, sizeof(double));
        out->more[which] = arena_alloc_raw(arena, 2 * (size_t)count, sizeof(double));
        if (!out->own[which] || !out->more[which]) return STATUS_NO_MEMORY;
        for (int k = 0; k < 2; k++) {
            const float *from = own + vapour_sky_at(v, which, k);
            double      *more = out->more[which] + k * count, *was = out->own[which] + k * count;
            mix_floats(more, v, a->mix, vapour_sky_at(v, which, k), count, k == 1);
            for (int i = 0; i < count; i++) {
                was[i] = (double)from[i];
                more[i] -= was[i];
            }
        }
    }
    return STATUS_OK;
}

/* ln of the sky's ratio to black air, at the points of a visibility's table. */
static Status fill_sky(Grid *out, const Slice *slice, const Atmosphere *a, const SkyChange *change, Arena *arena)
{
    const Vapour *v = a->vapour;
    const Grid   *from = &slice->sky_thermal;
    const double *m = vapour_sky_visibility_m;
    const double  u = fmax((1 / slice->visibility_m - 1 / m[0]) / (1 / m[1] - 1 / m[0]), -0.2), thick = fmin(u, 1);
    const int     count = v->sky[0] * v->sky[1];
    double       *value = arena_alloc_raw(arena, (size_t)(from->nodes[0] * from->nodes[1] * 2), sizeof *value);
    int           left[grid_max_nodes];
    double        right[grid_max_nodes];
    if (!value) return STATUS_NO_MEMORY;
    for (int j = 0; j < from->nodes[1]; j++)
        left[j] = interval_of(&right[j], v->sky_slant, v->sky[1], from->axis[1][j]);
    for (int i = 0; i < from->nodes[0]; i++) {
        double    s;
        const int low = interval_of(&s, v->sky_m, v->sky[0], from->axis[0][i]);
        for (int k = 0; k < 2; k++)
            for (int j = 0; j < from->nodes[1]; j++) {
                const int    at = 2 * (i * from->nodes[1] + j) + k, n = k * count + low * v->sky[1] + left[j];
                const double t = right[j];
                double       more = 0, own = 0;
                for (int corner = 0; corner < 4; corner++) { /* mostly the first alone: the tables have equal heights */
                    const double share = (corner & 1 ? s : 1 - s) * (corner & 2 ? t : 1 - t);
                    const int    m_at = n + (corner & 1) * v->sky[1] + (corner >> 1);
                    if (corner > 0 && s == 0 && t == 0) break;
                    if (share == 0) continue;
                    more += share * (change->more[0][m_at] + thick * (change->more[1][m_at] - change->more[0][m_at]));
                    own += share * change->own[1][m_at];
                }
                const double was = exp(from->value[at]);
                if (a->vapour_channel[AIR_MWIR + k] < 0) more = 0;
                if (u > 1) more *= clamp((1 - was) / fmax(1 - own, 1e-3), 0, 1);
                value[at] = log_here(fmax(was + more, 1e-9));
            }
    }
    *out = *from;
    out->value = value;
    return STATUS_OK;
}

/* Of mwir and lwir: what the depths that haze adds are multiplied by, by row of the file; what is added to the ln of
 * the path's radiance over black air, by row of the table. NULL: nothing. */
typedef struct Change {
    double *hazy, *opaque;
} Change;

static Status fill_change(Change *out, const Atmosphere *a, int k, Arena *arena)
{
    const Vapour *v = a->vapour;
    const float  *own = vapour_node(v, v->profile[a->vapour_profile].own);
    const float  *own_hazy = own + vapour_hazy_at(v, k), *own_opaque = own + vapour_opaque_at(v, k);
    double       *hazy = arena_alloc_raw(arena, (size_t)v->rows, sizeof *hazy);
    double       *opaque = arena_alloc_raw(arena, (size_t)v->both_ways, sizeof *opaque);
    if (!hazy || !opaque) return STATUS_NO_MEMORY;
    mix_floats(hazy, v, a->mix, vapour_hazy_at(v, k), v->rows, k == 1);
    mix_floats(opaque, v, a->mix, vapour_opaque_at(v, k), v->both_ways, k == 1);
    for (int i = 0; i < v->rows; i++) hazy[i] = clamp(hazy[i] / (double)own_hazy[i], 0.1, 10);
    for (int i = 0; i < v->both_ways; i++)
        opaque[i] = log_here((opaque[i] > 1e-3 ? opaque[i] : 1e-3) / (double)own_opaque[i]);
    *out = (Change){hazy, opaque};
    return STATUS_OK;
}

static Status fill_hazy(PathTable *out, const PathTable *from, const Atmosphere *a, const Change *change, Arena *arena)
{
    const int values = from->values, weights = from->weights;
    double   *value = arena_alloc_raw(arena, (size_t)from->rows * (size_t)values, sizeof *value);
    if (!value) return STATUS_NO_MEMORY;
    for (int row = 0; row < from->rows; row++) {
        const double *was = from->value + row * values, more = change->hazy[a->vapour_row[row]];
        double       *now = value + row * values;
        for (int w = 0; w < weights; w++) now[w] = was[w] * more;
        now[weights] = was[weights] + change->opaque[row];
    }
    out->value = value;
    return STATUS_OK;
}

static Status fill_slice(Slice *out, const Slice *from, const Atmosphere *a, const Change change[2],
                         const SkyChange *sky, unsigned bands, Arena *arena)
{
    Status status = STATUS_OK;
    *out = *from;
    out->from = from;
    scale_haze(&out->haze, a, bands);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        const PathTable *table = &from->path[AIR_MWIR + k];
        if (change[k].hazy && table->shape == a->clear_path[AIR_MWIR + k].shape && table->values == table->weights + 1)
            status = fill_hazy(&out->path[AIR_MWIR + k], table, a, &change[k], arena);
    }
    if (status == STATUS_OK && sky->own[0]) status = fill_sky(&out->sky_thermal, from, a, sky, arena);
    return status;
}

Status atmosphere_in(const Atmosphere **out, const Atmosphere *model, const AirState *state, unsigned bands,
                     Arena *arena)
{
    if (!follows(model, state)) {
        *out = model;
        return STATUS_OK;
    }
    AirSums *now = arena_alloc_raw(arena, 1, sizeof *now);
    Slice   *slice = arena_alloc_raw(arena, 2, sizeof *slice);
    if (!now || !slice) return STATUS_NO_MEMORY;
    Atmosphere *a = &now->air;
    begin(a, &now->mix, now->level_k, model, state);
    memcpy(a->clear_path, model->clear_path, sizeof a->clear_path);
    static const unsigned visible = 1u << AIR_B | 1u << AIR_G | 1u << AIR_R; /* daylight is asked for always */
    fill_clear(a, model, bands | visible);
    if (bands >> AIR_PAN & 1) bands |= visible;
    Status status = STATUS_OK;
    for (int k = 0; k < air_tabled_count && status == STATUS_OK; k++)
        if (bands >> air_tabled[k] & 1 && a->vapour_channel[air_tabled[k]] >= 0)
            status = fill_paths(a, model, air_tabled[k], arena);
    Blend blend;
    blend_at(&blend, model, state->visibility_m);
    const bool two = blend.low != blend.high;
    Change     change[2] = {{0}};
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        if (bands >> (AIR_MWIR + k) & 1 && a->vapour_channel[AIR_MWIR + k] >= 0)
            status = fill_change(&change[k], a, k, arena);
    SkyChange sky = {.own = {NULL}};
    if (status == STATUS_OK && bands >> AIR_MWIR & 3) status = fill_sky_change(&sky, a, arena);
    if (status == STATUS_OK) status = fill_slice(&slice[0], blend.low, a, change, &sky, bands | visible, arena);
    if (status == STATUS_OK && two) status = fill_slice(&slice[1], blend.high, a, change, &sky, bands | visible, arena);
    a->slice = slice, a->slices = 1 + two;
    if (status == STATUS_OK) *out = a;
    return status;
}
