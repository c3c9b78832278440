/* render/air/atmosphere_slices.c: air at visibilities between the tables', made once when a model is opened.
 *
 * A layered radiative transfer program defines haze at its levels and interpolates its logarithm linearly between
 * them; at the levels it is linear in 1 / visibility. So the column of a visibility is made by these two rules, not
 * by mixing columns, and quantities that follow the column (optical depths of paths and of the sun) are interpolated
 * in the column's own depth. All others are linear in 1 / visibility. At the visibility of a table the table is
 * reproduced. */
#include "render/air/atmosphere_private.h"

#include <stdlib.h>

/* Share of the second of two visibilities, linear in 1 / visibility; beyond them below 0 or above 1. */
static double share_between(double low_m, double high_m, double visibility_m)
{
    return low_m < high_m ? (1 / visibility_m - 1 / low_m) / (1 / high_m - 1 / low_m) : 0;
}

/* The same by optical depth; where both depths are equal the other share is used. */
static double share_of_depth(double low, double high, double wanted, double otherwise)
{
    return fabs(high - low) > 1e-3 * (high + low) ? (wanted - low) / (high - low) : otherwise;
}

/* ---- the column ----------------------------------------------------------------------------------- */

static double column_value(const AirColumn *column, const double *value, double height_m)
{
    double    t;
    const int i = interval_of(&t, column->height_m, column->nodes, height_m);
    return value[i] + t * (value[i + 1] - value[i]);
}

typedef struct Pair {
    const AirColumn *low, *high;
    const double    *low_value, *high_value; /* one of the columns' values */
    double           share;
} Pair;

/* Linear value at a level; beyond the tables never less than a tenth of the clearer one's. */
static double at_level(const Pair *p, double low, double high)
{
    return fmax(low + p->share * (high - low), 0.1 * fmin(low, high));
}

/* A visibility's value at a height between two levels. */
static double between_levels(const Pair *p, double height_m, double below_m, double above_m, double t)
{
    const double low = column_value(p->low, p->low_value, height_m);
    const double high = column_value(p->high, p->high_value, height_m);
    const double a[2] = {column_value(p->low, p->low_value, below_m), column_value(p->high, p->high_value, below_m)};
    const double b[2] = {column_value(p->low, p->low_value, above_m), column_value(p->high, p->high_value, above_m)};
    if (!(low > 0 && high > 0 && a[0] > 0 && a[1] > 0 && b[0] > 0 && b[1] > 0)) return at_level(p, low, high);
    /* scale of the levels for each of the two tables, which curve alike between the levels */
    const double ln_a = log(at_level(p, a[0], a[1])), ln_b = log(at_level(p, b[0], b[1]));
    const double of_low = log(low) + (1 - t) * (ln_a - log(a[0])) + t * (ln_b - log(b[0]));
    const double of_high = log(high) + (1 - t) * (ln_a - log(a[1])) + t * (ln_b - log(b[1]));
    return exp(of_low + clamp(p->share, 0, 1) * (of_high - of_low));
}

static int merge_heights(double *out, const AirColumn *a, const AirColumn *b)
{
    int nodes = 0;
    for (int i = 0, j = 0; i < a->nodes || j < b->nodes;) {
        const double x = i < a->nodes ? a->height_m[i] : INFINITY, y = j < b->nodes ? b->height_m[j] : INFINITY;
        if (nodes == column_max) return 0;
        out[nodes++] = fmin(x, y);
        i += x <= y;
        j += y <= x;
    }
    return nodes;
}

static void column_between(AirColumn *out, const Atmosphere *atmosphere, const Slice *low, const Slice *high,
                           double share)
{
    const Grid *level = &atmosphere->temperature;
    out->nodes = merge_heights(out->height_m, &low->haze, &high->haze);
    if (out->nodes == 0) { /* more than fit: those of the first */
        out->nodes = low->haze.nodes;
        memcpy(out->height_m, low->haze.height_m, sizeof out->height_m);
    }
    for (int k = 0; k < air_tabled_count; k++)
        for (int part = 0; part < 2; part++) {
            const AirBand b = air_tabled[k];
            const Pair    pair = {&low->haze, &high->haze, part ? low->haze.scatter_per_m[b] : low->haze.per_m[b],
                               part ? high->haze.scatter_per_m[b] : high->haze.per_m[b], share};
            double       *to = part ? out->scatter_per_m[b] : out->per_m[b];
            for (int n = 0; n < out->nodes; n++) {
                double    t;
                const int i = interval_of(&t, level->axis[0], level->nodes[0], out->height_m[n]);
                const int next = i + (level->nodes[0] > 1);
                to[n] = between_levels(&pair, out->height_m[n], level->axis[0][i], level->axis[0][next], t);
            }
            if (!part) column_sum_up(out, out->per_m[b], out->sum[b]);
        }
}

/* ---- tables --------------------------------------------------------------------------------------- */

/* A table of the same axes, with its values allocated only. */
static Status paths_like(PathTable *out, const PathTable *table)
{
    const size_t pairs = (size_t)table->nodes[0] * (size_t)table->nodes[1], rows = (size_t)table->rows;
    *out = *table;
    out->first = malloc((pairs + 1) * sizeof *out->first);
    out->ln_range = malloc((rows + 1) * sizeof *out->ln_range);
    out->value = malloc((rows * (size_t)table->values + 1) * sizeof *out->value);
    if (!out->first || !out->ln_range || !out->value) return STATUS_NO_MEMORY;
    memcpy(out->first, table->first, (pairs + 1) * sizeof *out->first);
    memcpy(out->ln_range, table->ln_range, rows * sizeof *out->ln_range);
    memcpy(out->value, table->value, rows * (size_t)table->values * sizeof *out->value);
    return STATUS_OK;
}

static Status grid_like(Grid *out, const Grid *grid)
{
    size_t nodes = 1;
    *out = (Grid){.axes = grid->axes, .values = grid->values};
    for (int i = 0; i < grid->axes; i++) {
        out->nodes[i] = grid->nodes[i];
        nodes *= (size_t)grid->nodes[i];
        out->axis[i] = malloc((size_t)grid->nodes[i] * sizeof *out->axis[i]);
        if (!out->axis[i]) return STATUS_NO_MEMORY;
        memcpy(out->axis[i], grid->axis[i], (size_t)grid->nodes[i] * sizeof *out->axis[i]);
    }
    out->value = malloc(nodes * (size_t)grid->values * sizeof *out->value);
    if (!out->value) return STATUS_NO_MEMORY;
    memcpy(out->value, grid->value, nodes * (size_t)grid->values * sizeof *out->value);
    return STATUS_OK;
}

/* A depth's ratio to its column's, by the column's depth. A band's mean thins out as its opaque parts go: beyond the
 * thicker table the line goes over into a ratio that falls as 1 / depth at most, so that depth never does. */
static double ratio_between(double first, double second, double share)
{
    const double change = share * (second - first);
    if (share >= 0 || !(first > 0)) return clamp(first + change, -1, 3);
    return change < 0 ? first / (1 - change / first) : first + fmin(change, 0.05 * first);
}

/* Depths by the haze's own at each of the two tables' visibilities and at the requested one. */
static Status path_between(PathTable *out, const Slice *slice, const Slice *low, const Slice *high, AirBand band,
                           double share)
{
    const PathTable *from = &low->path[band], *other = &high->path[band];
    const Status     status = paths_like(out, from);
    if (status != STATUS_OK || low == high) return status;
    const bool alike = paths_alike(from, other);
    for (int pair = 0; pair < from->nodes[0] * from->nodes[1]; pair++) {
        const double a_m = from->axis[0][pair / from->nodes[1]], b_m = from->axis[1][pair % from->nodes[1]];
        const double here = column_mean(&slice->haze, band, a_m, b_m);
        const double thick = column_mean(&low->haze, band, a_m, b_m), thin = column_mean(&high->haze, band, a_m, b_m);
        const double of_depth = share_of_depth(thick, thin, here, clamp(share, 0, 1));
        for (int row = from->first[pair]; row < from->first[pair + 1]; row++) {
            double       *value = out->value + (size_t)row * (size_t)out->values;
            const double *beside = other->value + (size_t)row * (size_t)other->values;
            Stencil       at;
            if (!alike) stencil_at(&at, other, a_m, b_m, exp(from->ln_range[row]));
            for (int w = 0; w < from->weights; w++) {
                const double temp_k = w > 0 ? from->weight_temp_k[w] : NAN;
                const double second = alike ? beside[w] : path_weight_value(other, &at, temp_k);
                value[w] = ratio_between(value[w], second, of_depth);
            }
            if (from->weights < 2) continue;
            const double second = alike ? beside[other->weights] : stencil_value(&at, other, other->weights);
            value[from->weights] += clamp(share, 0, 1) * (second - value[from->weights]);
        }
    }
    return STATUS_OK;
}

static Status scattered_between(PathTable *out, const Slice *low, const Slice *high, double share)
{
    const PathTable *from = &low->scattered, *other = &high->scattered;
    const Status     status = paths_like(out, from);
    share = clamp(share, 0, 1);
    if (status != STATUS_OK || share == 0) return status;
    const bool    alike = paths_alike(from, other);
    const double *beside = other->value;
    double       *value = out->value;
    for (int pair = 0; pair < from->nodes[0] * from->nodes[1]; pair++)
        for (int row = from->first[pair]; row < from->first[pair + 1]; row++) {
            Stencil at;
            if (!alike)
                stencil_at(&at, other, from->axis[0][pair / from->nodes[1]], from->axis[1][pair % from->nodes[1]],
                           exp(from->ln_range[row]));
            for (int s = 0; s < from->suns; s++)
                for (int a = 0; a < from->azimuths; a++)
                    for (int k = 0; k < air_tabled_count; k++, value++) {
                        const double second =
                            alike ? *beside++ : scattered_value(other, &at, from->sun_x[s], from->azimuth_deg[a], k);
                        *value += share * (second - *value);
                    }
        }
    return STATUS_OK;
}

static Status grid_between(Grid *out, const Grid *from, const Grid *other, double share)
{
    const Status status = grid_like(out, from);
    share = clamp(share, 0, 1);
    if (status != STATUS_OK || share == 0) return status;
    size_t nodes = 1;
    bool   alike = true;
    for (int i = 0; i < from->axes; i++) {
        nodes *= (size_t)from->nodes[i];
        alike = alike && from->nodes[i] == other->nodes[i] &&
                memcmp(from->axis[i], other->axis[i], (size_t)from->nodes[i] * sizeof(double)) == 0;
    }
    for (size_t n = 0; n < nodes * (size_t)from->values && alike; n++)
        out->value[n] += share * (other->value[n] - out->value[n]);
    for (size_t n = 0; n < nodes && !alike; n++) {
        double at[grid_max_axes], second[grid_max_values];
        size_t rest = n;
        for (int i = from->axes - 1; i >= 0; i--) {
            at[i] = from->axis[i][rest % (size_t)from->nodes[i]];
            rest /= (size_t)from->nodes[i];
        }
        grid_at(second, other, at);
        double *value = out->value + n * (size_t)from->values;
        for (int v = 0; v < from->values; v++) value[v] += share * (second[v] - value[v]);
    }
    return STATUS_OK;
}

/* Cosine of the zenith angle from its slant_x. */
static double cosine_of_slant(double x)
{
    const double least = exp(-x);
    double       c = least;
    for (int i = 0; i < 30; i++) c = least - 0.025 * exp(-11 * c);
    return fmax(c, 0);
}

/* Sunlight of one direction at a height, over that above the air. */
typedef struct SunPart {
    double depth, diffuse;
} SunPart;

/* Depth by the haze above; so the inverse of all light on a level plane, as layers that scatter let light through (two
 * streams: 1 / (1 + a depth)); what is not direct of it is diffuse. */
static SunPart sun_part_between(SunPart low, SunPart high, double share, double cosine)
{
    const double depth = fmax(low.depth + share * (high.depth - low.depth), 0.3 * fmin(low.depth, high.depth));
    const double all[2] = {cosine * exp(-low.depth) + low.diffuse, cosine * exp(-high.depth) + high.diffuse};
    const double even = low.diffuse + share * (high.diffuse - low.diffuse);
    const double inverse = 1 / all[0] + share * (1 / all[1] - 1 / all[0]);
    const double least = 0.3 * fmin(low.diffuse, high.diffuse), most = 2 * fmax(low.diffuse, high.diffuse);
    const double diffuse = inverse > 0 && isfinite(inverse) ? 1 / inverse - cosine * exp(-depth) : even;
    return (SunPart){depth, fmin(clamp(diffuse, least, most), 1)};
}

static Status sun_between(Grid *out, const Slice *slice, const Slice *low, const Slice *high, double share)
{
    const Status status = grid_like(out, &low->sun);
    if (status != STATUS_OK || low == high) return status;
    const double top_m = slice->haze.height_m[slice->haze.nodes - 1];
    for (int n = 0; n < out->nodes[0] * out->nodes[1]; n++) {
        const double at[2] = {out->axis[0][n / out->nodes[1]], out->axis[1][n % out->nodes[1]]};
        const double cosine = cosine_of_slant(at[1]);
        double       other[2 * air_tabled_count], *value = out->value + n * out->values;
        grid_at(other, &high->sun, at);
        for (int k = 0; k < air_tabled_count; k++) {
            const AirBand b = air_tabled[k];
            const double  thick = column_mean(&low->haze, b, at[0], top_m);
            const double  thin = column_mean(&high->haze, b, at[0], top_m);
            const double  of_depth =
                share_of_depth(thick, thin, column_mean(&slice->haze, b, at[0], top_m), clamp(share, 0, 1));
            const SunPart first = {exp(value[k]), exp(value[k + air_tabled_count])};
            const SunPart second = {exp(other[k]), exp(other[k + air_tabled_count])};
            const SunPart here = sun_part_between(first, second, of_depth, cosine);
            value[k] = log(here.depth);
            value[k + air_tabled_count] = log(here.diffuse);
        }
    }
    return STATUS_OK;
}

/* ---- a visibility --------------------------------------------------------------------------------- */

typedef bool SliceHas(const Slice *slice);
static bool  has_haze(const Slice *slice) { return slice->visibility_m > 0; }
static bool  has_paths(const Slice *slice) { return slice->has_paths; }
static bool  has_scattered(const Slice *slice) { return slice->has_scattered; }

/* The two slices with data between which a visibility lies, beyond them the last two; and the share of the second. */
typedef struct Sides {
    const Slice *low, *high;
    double       share;
} Sides;

static Sides sides_of(const Slice *slice, int count, SliceHas *has, double visibility_m)
{
    const Slice *of[slices_max] = {slice};
    int          n = 0, i = 0;
    for (int k = 0; k < count; k++)
        if (has(&slice[k])) of[n++] = &slice[k];
    while (i + 2 < n && visibility_m > of[i + 1]->visibility_m) i++;
    const Slice *low = of[i], *high = n > 1 ? of[i + 1] : of[i];
    return (Sides){low, high, share_between(low->visibility_m, high->visibility_m, visibility_m)};
}

Status slice_between(Slice *out, const Atmosphere *atmosphere, const Slice *tabled, int count, double visibility_m)
{
    const Sides  any = sides_of(tabled, count, has_haze, visibility_m);
    const Sides  path = sides_of(tabled, count, has_paths, visibility_m);
    const Sides  light = sides_of(tabled, count, has_scattered, visibility_m);
    const double longwave[2] = {any.low->longwave_down_w_m2, any.high->longwave_down_w_m2};
    *out = (Slice){.visibility_m = count > 1 ? visibility_m : any.low->visibility_m,
                   .has_paths = true,
                   .has_scattered = true,
                   .longwave_down_w_m2 = longwave[0] + clamp(any.share, 0, 1) * (longwave[1] - longwave[0])};
    column_between(&out->haze, atmosphere, any.low, any.high, any.share);
    Status status = sun_between(&out->sun, out, any.low, any.high, any.share);
    if (status == STATUS_OK)
        status = grid_between(&out->sky_thermal, &any.low->sky_thermal, &any.high->sky_thermal, any.share);
    for (int k = 0; k < air_tabled_count && status == STATUS_OK; k++)
        status = path_between(&out->path[air_tabled[k]], out, path.low, path.high, air_tabled[k], path.share);
    if (status == STATUS_OK) status = scattered_between(&out->scattered, light.low, light.high, light.share);
    if (status == STATUS_OK)
        status = grid_between(&out->sky_scattered, &light.low->sky_scattered, &light.high->sky_scattered, light.share);
    return status;
}

int visibility_steps(double out[slices_made_max], const Slice *tabled, int count, double low_m, double high_m)
{
    int n = 0;
    if (count == 1) {
        out[n++] = tabled[0].visibility_m;
        return n;
    }
    for (int i = -1; i < count; i++) {
        const double a_m = i < 0 ? low_m : tabled[i].visibility_m;
        const double b_m = i + 1 < count ? tabled[i + 1].visibility_m : high_m;
        for (int k = 0; k < steps_between; k++) out[n++] = k ? a_m * pow(b_m / a_m, (double)k / steps_between) : a_m;
    }
    out[n++] = high_m;
    return n;
}
