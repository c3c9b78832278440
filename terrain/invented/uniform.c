/* terrain/invented/uniform.c: whether a square of the invented cover is of one class, proven by bounds. */
#include "terrain/invented/uniform.h"

#include "terrain/invented/invented_eight.h"
#include "terrain/invented/ways_private.h"

/* Beyond what floats round, in the unit of each field; bends in metres. */
static const double rounding = 1e-4, rounding_m = 0.02;

typedef struct Range {
    double low, high;
} Range;

static Range sum_of(Range a, double factor, Range b) /* factor >= 0 */
{
    return (Range){a.low + factor * b.low, a.high + factor * b.high};
}

/* ---- smooth noise ----------------------------------------------------------------------------- */

enum { most_places = 16 };

/* Places at which a field is largest and smallest over the square. Within a cell of its lattice it is bilinear in two
 * coordinates that grow with x and y, so they are corners of the pieces into which lattice lines cut the square. */
typedef struct Extremes {
    int    count;
    double x_m[most_places], y_m[most_places];
} Extremes;

static int cuts(double cut_m[3], double from_m, double side_m, double origin_m, double wave_m)
{
    const double line_m = origin_m + wave_m * floor((from_m + side_m - origin_m) / wave_m);
    cut_m[0] = from_m, cut_m[1] = from_m + side_m, cut_m[2] = line_m;
    return line_m > from_m ? 3 : 2;
}

/* wave_m: more than the side. The places are repeated to fill eights. */
static void find_extremes(Extremes *out, const UniformSquare *s, double x0_m, double y0_m, double wave_m)
{
    double    x_m[3], y_m[3];
    const int nx = cuts(x_m, s->x_m, s->side_m, x0_m, wave_m), ny = cuts(y_m, s->y_m, s->side_m, y0_m, wave_m);
    out->count = nx * ny > 8 ? 16 : 8;
    for (int k = 0; k < out->count; k++) out->x_m[k] = x_m[k % (nx * ny) % nx], out->y_m[k] = y_m[k % (nx * ny) / nx];
}

static Range range_of(const float *value, int count, double margin)
{
    Range r = {INFINITY, -INFINITY};
    for (int k = 0; k < count; k++) {
        r.low = (double)value[k] < r.low ? (double)value[k] : r.low;
        r.high = (double)value[k] > r.high ? (double)value[k] : r.high;
    }
    return (Range){r.low - margin, r.high + margin};
}

static Range noise_range(uint64_t seed, double wave_m, const UniformSquare *s)
{
    Extremes at;
    float    value[most_places];
    find_extremes(&at, s, 0, 0, wave_m);
    for (int k = 0; k < at.count; k += 8) f32x8_store(value + k, noise_eight(seed, wave_m, at.x_m + k, at.y_m + k));
    return range_of(value, at.count, rounding);
}

static void pair_range(Range out[2], uint64_t seed, double wave_m, const UniformSquare *s)
{
    Extremes at;
    float    value[2][most_places];
    find_extremes(&at, s, 0, 0, wave_m);
    for (int k = 0; k < at.count; k += 8) {
        F32x8 second;
        f32x8_store(value[0] + k, noise_pair_eight(&second, seed, wave_m, at.x_m + k, at.y_m + k));
        f32x8_store(value[1] + k, second);
    }
    for (int c = 0; c < 2; c++) out[c] = range_of(value[c], at.count, rounding);
}

static Range wet_range(const Ways *ways, const UniformSquare *s)
{
    Extremes at;
    float    value[most_places];
    if (!ways) return (Range){0, 0};
    find_extremes(&at, s, ways->x0_m, ways->y0_m, ways->coarse_m);
    for (int k = 0; k < at.count; k += 8) f32x8_store(value + k, ways_wet(ways, at.x_m + k, at.y_m + k));
    return range_of(value, at.count, rounding);
}

/* ---- slope ------------------------------------------------------------------------------------ */

/* Heights of the ground over the square, moved by this much, above a plane of this rise: between posts they are no
 * higher than the highest of these. */
static Range above_plane(const ElevationLevel *l, const UniformSquare *s, double move_x_m, double move_y_m,
                         const double rise[2])
{
    const double x = s->x_m + move_x_m - l->x0_m, y = s->y_m + move_y_m - l->y0_m, per_m = 1 / l->spacing_m;
    const int    i0 = (int)floor(x * per_m), i1 = (int)ceil((x + s->side_m) * per_m);
    const int    j0 = (int)floor(y * per_m), j1 = (int)ceil((y + s->side_m) * per_m);
    Range        r = {INFINITY, -INFINITY};
    for (int j = j0; j <= j1; j++)
        for (int i = i0, end; i <= i1; i = end) { /* posts of a row in one tile */
            const ElevationTile tile = l->tile[elevation_tile_index(l, i, j)];
            const uint16_t     *stored = l->stored + elevation_stored_index(l, i, j);
            end = i / elevation_tile_cells * elevation_tile_cells + elevation_tile_cells;
            end = end < i1 + 1 ? end : i1 + 1;
            for (int k = i; k < end; k++) {
                const double post = elevation_of_tile(tile, stored[k - i]);
                const double z_m = l->step_m * post - l->spacing_m * (rise[0] * k + rise[1] * j);
                r.low = z_m < r.low ? z_m : r.low, r.high = z_m > r.high ? z_m : r.high;
            }
        }
    return r;
}

static Range length_range(Range x, Range y)
{
    const double least_x = fmax(fmax(x.low, -x.high), 0), least_y = fmax(fmax(y.low, -y.high), 0);
    const double most_x = fmax(-x.low, x.high), most_y = fmax(-y.low, y.high);
    return (Range){sqrt(least_x * least_x + least_y * least_y), sqrt(most_x * most_x + most_y * most_y)};
}

static Range slope_on(const ElevationLevel *l, const UniformSquare *s)
{
    const double arm = invented_arm_m, middle_x = s->x_m + 0.5 * s->side_m, middle_y = s->y_m + 0.5 * s->side_m;
    const int    i = (int)((middle_x - l->x0_m) / l->spacing_m), j = (int)((middle_y - l->y0_m) / l->spacing_m);
    const int    far = (int)ceil(arm / l->spacing_m);
    const double per_post = l->step_m / (2 * far * l->spacing_m);
    const double rise[2] = {per_post * (elevation_post(l, i + far, j) - elevation_post(l, i - far, j)),
                            per_post * (elevation_post(l, i, j + far) - elevation_post(l, i, j - far))};
    const Range  east = above_plane(l, s, arm, 0, rise), west = above_plane(l, s, -arm, 0, rise);
    const Range  north = above_plane(l, s, 0, arm, rise), south = above_plane(l, s, 0, -arm, rise);
    const Range  dx = {2 * arm * rise[0] + east.low - west.high, 2 * arm * rise[0] + east.high - west.low};
    const Range  dy = {2 * arm * rise[1] + north.low - south.high, 2 * arm * rise[1] + north.high - south.low};
    const Range  length = length_range(dx, dy);
    const double lean = hypot(middle_x, middle_y) / 6371e3;
    return (Range){fmax(length.low / (2 * arm) - lean - rounding, 0),
                   fmax(length.high / (2 * arm) - lean, 0) + rounding};
}

/* Range of invented_slopes; false: not found, as on a seam of levels, or where posts are many. */
static bool slope_range(Range *out, const Elevation *elevation, const UniformSquare *s)
{
    enum { margin = 3, most_posts = 10 };
    const double arm = invented_arm_m;
    for (int n = 0; n < elevation->level_count; n++) {
        const ElevationLevel *l = &elevation->level[n];
        const double          per_m = 1 / l->spacing_m, reach = (s->side_m + 2 * arm) * per_m;
        const double          west = (s->x_m - arm - l->x0_m) * per_m, south = (s->y_m - arm - l->y0_m) * per_m;
        const double          east = west + reach, north = south + reach;
        /* a post more on each side than arms reach, whole posts' worth */
        if (west > margin && south > margin && east < l->nx - 1 - margin && north < l->ny - 1 - margin) {
            if (s->side_m * per_m > most_posts) return false;
            *out = slope_on(l, s);
            return true;
        }
        if (!(east < -margin || north < -margin || west > l->nx + margin || south > l->ny + margin)) return false;
    }
    return false;
}

/* ---- the square ------------------------------------------------------------------------------- */

/* Whether fields, and what runs between them, make one class of the square; what grows wild apart. */
static bool fields_uniform(uint64_t seed, const UniformSquare *s, const double middle_m[2], double radius_m)
{
    Range bend[2][2], by[2];
    for (int n = 0; n < 2; n++) pair_range(bend[n], seed + 26 + (uint64_t)n, plot_bend_wave_m[n], s);
    for (int c = 0; c < 2; c++) {
        by[c] = sum_of((Range){-rounding_m, rounding_m}, plot_bend_away_m[0], bend[0][c]);
        by[c] = sum_of(by[c], plot_bend_away_m[1], bend[1][c]);
    }
    double c, t;
    plot_turn(&c, &t, seed);
    const double bent_m[2] = {c * middle_m[0] - t * middle_m[1] + 0.5 * (by[0].low + by[0].high),
                              t * middle_m[0] + c * middle_m[1] + 0.5 * (by[1].low + by[1].high)};
    return plots_alike(seed, bent_m, radius_m + 0.5 * hypot(by[0].high - by[0].low, by[1].high - by[1].low));
}

/* The cheapest reasons against it come first. */
bool invented_uniform(const InventedGround *ground, const Elevation *elevation, const UniformSquare *square)
{
    const uint64_t      seed = ground->seed;
    const UniformSquare s = {square->x_m - rounding_m, square->y_m - rounding_m, square->side_m + 2 * rounding_m};
    const double        middle_m[2] = {s.x_m + 0.5 * s.side_m, s.y_m + 0.5 * s.side_m}, radius_m = sqrt(0.5) * s.side_m;
    Range               slope;
    if (ground->coast.sea_count || (ground->ways && !ways_clear(ground->ways, middle_m, radius_m))) return false;
    if (!fields_uniform(seed, &s, middle_m, radius_m) || !slope_range(&slope, elevation, &s)) return false;
    const Range    large = noise_range(seed + 10, 310, &s), middle = noise_range(seed + 11, 83, &s);
    const Range    patch = noise_range(seed + 12, 17, &s), wet = wet_range(ground->ways, &s);
    const WildEnds ends = {{(float)large.low, (float)large.high},
                           {(float)middle.low, (float)middle.high},
                           {(float)patch.low, (float)patch.high},
                           {(float)slope.low, (float)slope.high},
                           {(float)wet.low, (float)wet.high}};
    return invented_wild_alike(&ends);
}
