/* render/air/atmosphere_paths.c: the shape of scattered sunlight between the tables' points. Its absolute errors
 * do not matter, since the tables hold the ratio of the true value to it; only its shape does. */

#include "render/air/atmosphere_private.h"

#include <stdlib.h>

static double extinction(const Atmosphere *atmosphere, const Blend *blend, AirBand band, double a_m, double b_m)
{
    return column_mean(&atmosphere->clear, band, a_m, b_m) + blend_haze_mean(blend, band, a_m, b_m);
}

/* A step of a path, at a height, between two optical depths from the observer. */
typedef struct PathStep {
    double height_m, length_m, depth, next;
} PathStep;

/* Adds a step's single-scattered sunlight, and a uniform diffuse term of twice the diffuse light on a plane with a
 * fifth of what reaches it. */
static void add_step(ScatterParts *sum, const Atmosphere *atmosphere, const Blend *blend, AirBand band,
                     const PathStep *step, double sun_zenith_rad)
{
    const double height_m = step->height_m, depth = step->depth, next = step->next;
    SunAir       sun;
    blend_sun(&sun, atmosphere, blend, band, height_m, sun_zenith_rad);
    const double d = next - depth;
    const double seen_m = step->length_m * (d > 1e-6 ? (exp(-depth) - exp(-next)) / d : exp(-depth)) / (4 * pi_rad);
    const double clear = seen_m * column_scatter(&atmosphere->clear, band, height_m);
    const double haze = seen_m * blend_haze_scatter(blend, band, height_m);
    const double glow = 2 * sun.diffuse_horizontal_w_m2 +
                        0.4 * (sun.diffuse_horizontal_w_m2 + sun.direct_normal_w_m2 * cos(sun_zenith_rad));
    double      t;
    const Grid *phase = &atmosphere->phase;
    const int   i = interval_of(&t, phase->axis[0], phase->nodes[0], height_m);
    sum->clear += clear * sun.direct_normal_w_m2;
    sum->haze[i] += (1 - t) * haze * sun.direct_normal_w_m2;
    if (t > 0) sum->haze[i + 1] += t * haze * sun.direct_normal_w_m2;
    sum->glow += (clear + haze) * glow;
}

double scatter_estimate(const ScatterParts *parts, const Atmosphere *atmosphere, AirBand band, double up,
                        double sun_zenith_rad, double rel_azimuth_rad)
{
    const Grid  *phase = &atmosphere->phase;
    const double cosine =
        up * cos(sun_zenith_rad) + sqrt(fmax(1 - up * up, 0)) * sin(sun_zenith_rad) * cos(rel_azimuth_rad);
    double        sum = 0.75 * (1 + cosine * cosine) * parts->clear + parts->glow; /* clear air: Rayleigh's */
    double        t;
    const int     a = interval_of(&t, phase->axis[1], phase->nodes[1], acos(clamp(cosine, -1, 1)));
    const double *ln_haze = phase->value + a * air_tabled_count + air_tabled_index(band);
    for (int i = 0; i < phase->nodes[0]; i++, ln_haze += phase->nodes[1] * air_tabled_count)
        if (parts->haze[i] > 0)
            sum += parts->haze[i] * exp(t > 0 ? ln_haze[0] + t * (ln_haze[air_tabled_count] - ln_haze[0]) : ln_haze[0]);
    return sum;
}

void scatter_parts(ScatterParts *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band,
                   const AirPath *path, double depth)
{
    enum { steps = 8 };
    const double rise_m = path->target_m - path->observer_m, step_m = path->range_m / steps;
    const double ratio = depth / extinction(atmosphere, blend, band, path->observer_m, path->target_m) / path->range_m;
    *out = (ScatterParts){0};
    depth = 0;
    for (int i = 0; i < steps; i++) {
        const double   a_m = path->observer_m + rise_m * i / steps, b_m = path->observer_m + rise_m * (i + 1) / steps;
        const double   next = depth + ratio * step_m * extinction(atmosphere, blend, band, a_m, b_m);
        const PathStep step = {(a_m + b_m) / 2, step_m, depth, next};
        add_step(out, atmosphere, blend, band, &step, path->sun_zenith_rad);
        depth = next;
    }
}

void scatter_parts_sky(ScatterParts *out, const Atmosphere *atmosphere, const Blend *blend, AirBand band,
                       double observer_m, double zenith_rad, double sun_zenith_rad)
{
    /* heights in steps that grow upwards */
    enum { steps = 12 };
    const AirColumn *clear = &atmosphere->clear;
    const double     rise_m = fmin(clear->height_m[clear->nodes - 1], 40000) - observer_m;
    const double     slant = air_mass(zenith_rad);
    double           depth = 0;
    *out = (ScatterParts){0};
    if (!(rise_m > 0)) return;
    for (int i = 0; i < steps; i++) {
        const double s = (double)i / steps, t = (double)(i + 1) / steps;
        const double a_m = observer_m + rise_m * s * s, b_m = observer_m + rise_m * t * t, step_m = slant * (b_m - a_m);
        const double next = depth + step_m * extinction(atmosphere, blend, band, a_m, b_m);
        const PathStep step = {(a_m + b_m) / 2, step_m, depth, next};
        add_step(out, atmosphere, blend, band, &step, sun_zenith_rad);
        depth = next;
    }
}

/* ---- tables of paths, which are ragged ------------------------------------------------------- */

/* Tables of paths, which are ragged: a path is no shorter than the height difference
 * of its ends, and some end on the ground. */

enum { range_max_m = 2000000 };

/* ---- reading ---------------------------------------------------------------------------------- */

typedef struct PathKey {
    double at[5]; /* observer, target or direction, range, sun zenith, relative azimuth */
    int    row;
} PathKey;

static int compare_keys(const void *a, const void *b)
{
    const PathKey *x = a, *y = b;
    for (int i = 0; i < 5; i++)
        if (x->at[i] != y->at[i]) return x->at[i] < y->at[i] ? -1 : 1;
    return (x->row > y->row) - (x->row < y->row);
}

/* Of paths_*.csv the first three, of scattered.csv all, with a direction instead of a target. */
static const GridColumn path_key[5] = {{"observer_m", 0, height_max_m},
                                       {"target_m", 0, height_max_m},
                                       {"range_m", 1, range_max_m},
                                       {"sun_zenith_deg", 0, 90},
                                       {"rel_azimuth_deg", 0, 180}},
                        direction_key[5] = {{"observer_m", 0, height_max_m},
                                            {"zenith_deg", 0, 180},
                                            {"range_m", 1, range_max_m},
                                            {"sun_zenith_deg", 0, 90},
                                            {"rel_azimuth_deg", 0, 180}};

/* Rows in order; their keys are the first of their numbers, and the lengths are valid. */
static Status take_keys(PathKey *key, const TableRows *rows, const double *number, int keys)
{
    const int count = rows->table.rows;
    for (int row = 0; row < count; row++) {
        const double *at = number + (size_t)row * (size_t)rows->format->count;
        key[row] = (PathKey){.row = row};
        memcpy(key[row].at, at, (size_t)keys * sizeof *at);
        if (keys == 3 && !(at[2] >= fabs(at[0] - at[1]) * (1 - 1e-6)))
            return table_rows_refuse(rows, row, NULL, "range_m %g is less than the %g m between the ends' heights",
                                     at[2], fabs(at[0] - at[1]));
    }
    bool sorted = true;
    for (int row = 1; row < count && sorted; row++) sorted = compare_keys(&key[row - 1], &key[row]) < 0;
    if (!sorted) qsort(key, (size_t)count, sizeof *key, compare_keys);
    return STATUS_OK;
}

static int key_axis(double *axis, int capacity, const PathKey *key, int rows, int which)
{
    double *scratch = calloc((size_t)rows + 1, sizeof *scratch);
    if (!scratch) return -2;
    for (int i = 0; i < rows; i++) scratch[i] = key[i].at[which];
    const int nodes = axis_from(axis, capacity, scratch, rows);
    free(scratch);
    return nodes;
}

static Status find_path_axes(PathTable *out, const TableRows *rows, const PathKey *key, int keys)
{
    out->suns = out->azimuths = 1;
    for (int i = 0; i < 2; i++) out->nodes[i] = key_axis(out->axis[i], path_max_nodes, key, rows->table.rows, i);
    if (keys == 5) {
        out->suns = key_axis(out->sun_x, path_max_suns, key, rows->table.rows, 3);
        out->azimuths = key_axis(out->azimuth_deg, path_max_suns, key, rows->table.rows, 4);
    }
    const int least = (int)fmin(fmin(out->nodes[0], out->nodes[1]), fmin(out->suns, out->azimuths));
    if (least == -2) return STATUS_NO_MEMORY;
    if (least > 0) return STATUS_OK;
    return table_rows_lack(rows, "more than %d heights or directions, or %d sun zeniths or azimuths",
                           (int)path_max_nodes, (int)path_max_suns);
}

/* The rows from one on that share its first three keys: every sun and azimuth once, in order. Returns their number;
 * 0: not so. */
static int block_length(const PathTable *paths, const TableRows *rows, const PathKey *key, int row, int keys)
{
    const int inner = paths->suns * paths->azimuths;
    for (int i = 0; i < inner; i++) {
        const PathKey *k = &key[row + i];
        const bool     same = row + i < rows->table.rows && memcmp(k->at, key[row].at, 3 * sizeof *k->at) == 0;
        if (same && (keys < 5 || (k->at[3] == paths->sun_x[i / paths->azimuths] &&
                                  k->at[4] == paths->azimuth_deg[i % paths->azimuths])))
            continue;
        table_rows_refuse(rows, key[row].row, NULL, "a sun zenith and azimuth of this path is missing or there twice");
        return 0;
    }
    return inner;
}

/* Axes of the sorted keys; checks that every pair of nodes has ranges, and every range every sun and azimuth. */
static Status arrange(PathTable *out, const TableRows *rows, const PathKey *key, int keys)
{
    const int    count = rows->table.rows;
    const Status status = find_path_axes(out, rows, key, keys);
    if (status != STATUS_OK) return status;
    const int pairs = out->nodes[0] * out->nodes[1];
    out->first = calloc((size_t)pairs + 1, sizeof *out->first);
    out->ln_range = calloc((size_t)count + 1, sizeof *out->ln_range);
    if (!out->first || !out->ln_range) return STATUS_NO_MEMORY;
    int row = 0;
    out->ln_range_low = INFINITY;
    for (int pair = 0; pair < pairs; pair++) {
        const double a = out->axis[0][pair / out->nodes[1]], b = out->axis[1][pair % out->nodes[1]];
        out->first[pair] = out->rows;
        while (row < count && key[row].at[0] == a && key[row].at[1] == b) {
            const double x = log(key[row].at[2]);
            if (out->rows > out->first[pair] && x == out->ln_range[out->rows - 1])
                return table_rows_refuse(rows, key[row].row, NULL, "this path is there twice");
            const int length = block_length(out, rows, key, row, keys);
            if (length == 0) return STATUS_BAD_VALUE;
            row += length;
            out->ln_range[out->rows++] = x;
            out->ln_range_low = fmin(out->ln_range_low, x);
        }
        if (out->rows > out->first[pair]) continue;
        return table_rows_refuse(rows, count - 1, NULL, "no path: %s=%g %s=%g (every pair of these is needed)",
                                 rows->format->column[0].name, a, rows->format->column[1].name, b);
    }
    out->first[pairs] = out->rows;
    return STATUS_OK;
}

void paths_close(PathTable *table)
{
    free(table->first);
    free(table->ln_range);
    free(table->value);
    *table = (PathTable){0};
}

/* Keys and values of a file whose columns are found. */
static Status read_paths(PathTable *out, const TableRows *rows, int keys)
{
    const size_t count = (size_t)rows->table.rows, numbers = (size_t)rows->format->count,
                 values = numbers - (size_t)keys;
    PathKey *key = calloc(count + 1, sizeof *key);
    double  *number = NULL;
    Status   status = key ? table_rows_numbers(&number, rows) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = take_keys(key, rows, number, keys);
    if (status == STATUS_OK) status = arrange(out, rows, key, keys);
    if (status == STATUS_OK) {
        out->values = out->suns * out->azimuths * (int)values;
        out->value = calloc(count * values, sizeof *out->value);
        if (!out->value) status = STATUS_NO_MEMORY;
    }
    for (size_t i = 0; i < count && status == STATUS_OK; i++)
        memcpy(out->value + i * values, number + (size_t)key[i].row * numbers + keys, values * sizeof *number);
    free(number);
    free(key);
    return status;
}

Status paths_open(PathTable *out, const char *path, int keys, const GridColumn *value, int values, PathColumns *choose)
{
    const GridColumn *key = keys == 5 ? direction_key : path_key;
    GridColumn        chosen[path_max_weights + 1];
    TableColumn       column[5 + grid_max_values];
    TableFormat       format = atmosphere_format(column, key, keys, value, choose ? 0 : values);
    PathTable         paths = {0};
    TableRows         rows;
    Status            status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    if (rows.table.rows == 0) status = table_rows_lack(&rows, "no rows");
    if (status == STATUS_OK && choose) {
        status = choose(&paths, &rows, chosen, &values);
        if (status == STATUS_OK) format = atmosphere_format(column, key, keys, chosen, values);
        if (status == STATUS_OK) status = table_rows_use(&rows, &format);
    }
    if (status == STATUS_OK) status = read_paths(&paths, &rows, keys);
    table_rows_close(&rows);
    if (status == STATUS_OK) *out = paths;
    else paths_close(&paths);
    return status;
}

/* ---- equal shapes ----------------------------------------------------------------------------- */

bool paths_same_shape(const PathTable *a, const PathTable *b)
{
    if (a->rows != b->rows || a->nodes[0] != b->nodes[0] || a->nodes[1] != b->nodes[1]) return false;
    for (int i = 0; i < 2; i++)
        if (memcmp(a->axis[i], b->axis[i], (size_t)a->nodes[i] * sizeof a->axis[i][0]) != 0) return false;
    const size_t pairs = (size_t)a->nodes[0] * (size_t)a->nodes[1];
    return a->ln_range_low == b->ln_range_low && memcmp(a->first, b->first, (pairs + 1) * sizeof *a->first) == 0 &&
           memcmp(a->ln_range, b->ln_range, (size_t)a->rows * sizeof *a->ln_range) == 0;
}

bool paths_alike(const PathTable *a, const PathTable *b)
{
    return paths_same_shape(a, b) && a->values == b->values && a->weights == b->weights && a->suns == b->suns &&
           a->azimuths == b->azimuths && memcmp(a->weight_temp_k, b->weight_temp_k, sizeof a->weight_temp_k) == 0 &&
           memcmp(a->sun_x, b->sun_x, sizeof a->sun_x) == 0 &&
           memcmp(a->azimuth_deg, b->azimuth_deg, sizeof a->azimuth_deg) == 0;
}

/* ---- looking up ------------------------------------------------------------------------------- */

/* Lagrange's cubic through the four rows around x (fewer at the ends), linear below the first row. Below the
 * shortest range of all the value of the end. Beyond a pair's longest range: of depths, whose logarithm is nearly
 * straight in that of range, the line through its last two to four times that range, and the value there beyond; of
 * scattered light the value of the end. */
static int range_stencil(int *row, double *share, const PathTable *table, int pair, double x)
{
    const int     first = table->first[pair], count = table->first[pair + 1] - first;
    const double *node = table->ln_range + first;
    const double  beyond = table->weights > 0 ? 1.3862943611198906 : 0; /* ln 4 */
    x = clamp(x, table->ln_range_low, node[count - 1] + beyond);
    int low, points;
    if (count > 1 && x > node[count - 1]) {
        low = count - 2;
        points = 2;
    } else if (count == 1) {
        low = 0;
        points = 1;
    } else if (x < node[0]) {
        low = 0;
        points = 2;
    } else {
        double    t;
        const int cell = interval_of(&t, node, count, x);
        low = cell > 0 ? cell - 1 : 0;
        const int high = cell + 2 < count ? cell + 2 : count - 1;
        points = high - low + 1;
    }
    for (int i = 0; i < points; i++) {
        row[i] = first + low + i;
        share[i] = 1;
        for (int j = 0; j < points; j++)
            if (j != i) share[i] *= (x - node[low + j]) / (node[low + i] - node[low + j]);
    }
    return points;
}

void stencil_at(Stencil *out, const PathTable *table, double observer_m, double second, double range_m)
{
    double       s, t;
    const int    i = interval_of(&s, table->axis[0], table->nodes[0], observer_m);
    const int    j = interval_of(&t, table->axis[1], table->nodes[1], second);
    const double x = log(fmax(range_m, 1e-3));
    out->count = 0;
    for (int corner = 0; corner < 4; corner++) {
        const double share = (corner & 1 ? s : 1 - s) * (corner & 2 ? t : 1 - t);
        if (share == 0) continue;
        const int pair = (i + (corner & 1)) * table->nodes[1] + j + (corner >> 1);
        const int points = range_stencil(out->row + out->count, out->share + out->count, table, pair, x);
        for (int p = 0; p < points; p++) out->share[out->count + p] *= share;
        out->count += points;
    }
}

double stencil_value(const Stencil *stencil, const PathTable *table, int value)
{
    double sum = 0;
    for (int p = 0; p < stencil->count; p++)
        sum += stencil->share[p] * table->value[(size_t)stencil->row[p] * (size_t)table->values + (size_t)value];
    return sum;
}
