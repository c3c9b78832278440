/* render/atmosphere_read.c: the files of etc/atmosphere (README.md there) into memory, every cell checked, and turned
 * into what is smooth between the points: ratios to an estimate, logarithms. */
#include "render/atmosphere_private.h"

#include <stdlib.h>
#include <unistd.h>

enum { height_max_m = 100000, range_max_m = 2000000, depth_max = 1000 };

/* ---- paths ---------------------------------------------------------------------------------- */

typedef struct PathKey {
    double at[5]; /* observer, target, range, sun zenith, relative azimuth */
    int    row;
} PathKey;

static int compare_keys(const void *a, const void *b)
{
    const PathKey *x = a, *y = b;
    for (int i = 0; i < 5; i++)
        if (x->at[i] != y->at[i]) return x->at[i] < y->at[i] ? -1 : 1;
    return (x->row > y->row) - (x->row < y->row);
}

static const GridColumn path_key[5] = {{"observer_m", 0, height_max_m}, {"target_m", 0, height_max_m},
                                       {"range_m", 1, range_max_m}, {"sun_zenith_deg", 0, 90},
                                       {"rel_azimuth_deg", 0, 180}};

/* Rows in order; their keys read and the lengths possible. */
static Status read_keys(PathKey *key, const Table *table, int keys)
{
    int column[5];
    for (int k = 0; k < keys; k++) {
        column[k] = table_column(table, path_key[k].name);
        if (column[k] >= 0) continue;
        log_error("atmosphere: %s:%d: column missing: %s", table->path, table->line[0], path_key[k].name);
        return STATUS_BAD_VALUE;
    }
    for (int row = 0; row < table->rows; row++) {
        key[row] = (PathKey){.row = row};
        for (int k = 0; k < keys; k++)
            if (table_number(&key[row].at[k], table, row, column[k], path_key[k].low, path_key[k].high) != STATUS_OK)
                return STATUS_BAD_VALUE;
        const double *at = key[row].at;
        if (at[2] >= fabs(at[0] - at[1]) * (1 - 1e-6)) continue;
        log_error("atmosphere: %s:%d: range_m %g is less than the %g m between the ends' heights", table->path,
                  table->line[row + 1], at[2], fabs(at[0] - at[1]));
        return STATUS_BAD_VALUE;
    }
    qsort(key, (size_t)table->rows, sizeof *key, compare_keys);
    return STATUS_OK;
}

static int key_axis(double *axis, int capacity, const PathKey *key, int rows, int which, int second)
{
    double *scratch = calloc(2 * (size_t)rows + 1, sizeof *scratch);
    if (!scratch) return -2;
    int count = 0;
    for (int i = 0; i < rows; i++) scratch[count++] = key[i].at[which];
    for (int i = 0; second >= 0 && i < rows; i++) scratch[count++] = key[i].at[second];
    const int nodes = axis_from(axis, capacity, scratch, count);
    free(scratch);
    return nodes;
}

/* Axes of the sorted keys, and that every pair of heights has ranges, every range every sun and azimuth. */
static Status arrange(PathTable *out, const Table *table, const PathKey *key, int keys)
{
    const int rows = table->rows;
    out->suns = out->azimuths = 1;
    out->heights = key_axis(out->height_m, path_max_heights, key, rows, 0, 1);
    if (keys == 5) {
        out->suns = key_axis(out->sun_x, path_max_suns, key, rows, 3, -1);
        out->azimuths = key_axis(out->azimuth_deg, path_max_suns, key, rows, 4, -1);
    }
    if (out->heights == -2 || out->suns == -2 || out->azimuths == -2) return STATUS_NO_MEMORY;
    if (out->heights < 0 || out->suns < 0 || out->azimuths < 0) {
        log_error("atmosphere: %s: more than %d heights, or %d sun zeniths or azimuths", table->path,
                  (int)path_max_heights, (int)path_max_suns);
        return STATUS_BAD_VALUE;
    }
    const int inner = out->suns * out->azimuths, pairs = out->heights * out->heights;
    out->first = calloc((size_t)pairs + 1, sizeof *out->first);
    out->ln_range = calloc((size_t)rows + 1, sizeof *out->ln_range);
    if (!out->first || !out->ln_range) return STATUS_NO_MEMORY;
    int row = 0;
    for (int pair = 0; pair < pairs; pair++) {
        const double observer_m = out->height_m[pair / out->heights], target_m = out->height_m[pair % out->heights];
        out->first[pair] = out->rows;
        while (row < rows && key[row].at[0] == observer_m && key[row].at[1] == target_m) {
            const double range_m = key[row].at[2];
            for (int i = 0; i < inner; i++) {
                const int line = table->line[key[row < rows ? row : rows - 1].row + 1];
                const double *at = key[row < rows ? row : rows - 1].at;
                const bool same = row < rows && at[0] == observer_m && at[1] == target_m && at[2] == range_m;
                if (same && (keys < 5 || (at[3] == out->sun_x[i / out->azimuths] &&
                                          at[4] == out->azimuth_deg[i % out->azimuths]))) {
                    row++;
                    continue;
                }
                log_error("atmosphere: %s:%d: a sun zenith and azimuth is missing or twice: observer_m=%g target_m=%g "
                          "range_m=%g", table->path, line, observer_m, target_m, range_m);
                return STATUS_BAD_VALUE;
            }
            if (out->rows > out->first[pair] && log(range_m) == out->ln_range[out->rows - 1]) {
                log_error("atmosphere: %s:%d: this path is there twice", table->path, table->line[key[row - 1].row + 1]);
                return STATUS_BAD_VALUE;
            }
            out->ln_range[out->rows++] = log(range_m);
        }
        if (out->rows > out->first[pair]) continue;
        log_error("atmosphere: %s:%d: no path: observer_m=%g target_m=%g (every pair of heights is needed)",
                  table->path, table->line[rows], observer_m, target_m);
        return STATUS_BAD_VALUE;
    }
    out->first[pairs] = out->rows;
    out->ln_range_low = INFINITY;
    for (int i = 0; i < out->rows; i++) out->ln_range_low = fmin(out->ln_range_low, out->ln_range[i]);
    return STATUS_OK;
}

static void paths_close(PathTable *table)
{
    free(table->first);
    free(table->ln_range);
    free(table->value);
    *table = (PathTable){0};
}

/* Rows of key and value columns; value by value in the order of the sorted keys. */
static Status paths_open(PathTable *out, const char *path, int keys, const GridColumn *value, int values,
                         Status (*choose)(PathTable *, const Table *, GridColumn *, int *))
{
    Table table = {0};
    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;

    PathTable paths = {0};
    GridColumn column[path_max_weights + 1];
    int at[path_max_weights + 1], count = values;
    PathKey *key = calloc((size_t)table.rows + 1, sizeof *key);
    status = STATUS_NO_MEMORY;
    if (!key) goto done;
    status = STATUS_BAD_VALUE;
    if (table.rows == 0) {
        log_error("atmosphere: %s:%d: no rows", path, table.line[0]);
        goto done;
    }
    if (choose) {
        status = choose(&paths, &table, column, &count);
        if (status != STATUS_OK) goto done;
    } else {
        memcpy(column, value, (size_t)values * sizeof *value);
    }
    status = STATUS_BAD_VALUE;
    for (int i = 0; i < count; i++) {
        at[i] = table_column(&table, column[i].name);
        if (at[i] >= 0) continue;
        log_error("atmosphere: %s:%d: column missing: %s", path, table.line[0], column[i].name);
        goto done;
    }
    status = read_keys(key, &table, keys);
    if (status == STATUS_OK) status = arrange(&paths, &table, key, keys);
    if (status != STATUS_OK) goto done;
    const int inner = paths.suns * paths.azimuths;
    paths.values = inner * count;
    paths.value = calloc((size_t)table.rows * (size_t)count, sizeof *paths.value);
    status = STATUS_NO_MEMORY;
    if (!paths.value) goto done;
    status = STATUS_BAD_VALUE;
    for (int i = 0; i < table.rows; i++)
        for (int v = 0; v < count; v++)
            if (table_number(&paths.value[(size_t)i * (size_t)count + (size_t)v], &table, key[i].row, at[v],
                             column[v].low, column[v].high) != STATUS_OK)
                goto done;
    status = STATUS_OK;
done:
    free(key);
    table_close(&table);
    if (status == STATUS_OK) *out = paths;
    else paths_close(&paths);
    return status;
}

/* Columns of paths_*.csv: depth_sun, any depth_<kelvin>k in rising order, thermal_w_m2_sr where there are such. */
static Status choose_weights(PathTable *out, const Table *table, GridColumn *column, int *count)
{
    int n = 0;
    column[n++] = (GridColumn){"depth_sun", 1e-12, depth_max};
    for (int c = 0; c < table->columns; c++) {
        const char *name = table->cell[c];
        char text[32];
        const size_t length = strlen(name);
        if (strncmp(name, "depth_", 6) != 0 || strcmp(name, "depth_sun") == 0) continue;
        double temp_k;
        const bool fits = length > 7 && length < sizeof text && name[length - 1] == 'k';
        if (fits) snprintf(text, length - 6, "%s", name + 6);
        if (!fits || !text_to_double(&temp_k, text) || !(temp_k >= 50 && temp_k <= 1e4) || n == path_max_weights ||
            (n > 1 && !(temp_k > out->weight_temp_k[n - 1]))) {
            log_error("atmosphere: %s:%d: column %s: want depth_sun and depth_<kelvin>k, 50 to 10000 K rising, at most "
                      "%d", table->path, table->line[0], name, path_max_weights - 1);
            return STATUS_BAD_VALUE;
        }
        out->weight_temp_k[n] = temp_k;
        column[n++] = (GridColumn){name, 1e-12, depth_max};
    }
    out->weights = n;
    if (n > 1) column[n++] = (GridColumn){"thermal_w_m2_sr", 1e-30, 1e4};
    *count = n;
    return STATUS_OK;
}

/* Depths become ln of their ratio to the profile's, radiances ln of what an opaque path would have. */
static void normalize_paths(PathTable *paths, const Blend *blend, AirBand band)
{
    for (int pair = 0; pair < paths->heights * paths->heights; pair++) {
        const double a_m = paths->height_m[pair / paths->heights], b_m = paths->height_m[pair % paths->heights];
        const double per_m = blend_mean_extinction(blend, band, a_m, b_m);
        for (int row = paths->first[pair]; row < paths->first[pair + 1]; row++) {
            double *value = paths->value + (size_t)row * (size_t)paths->values;
            if (paths->weights > 1) {
                const double depth = value[path_emission_weight(paths)];
                value[paths->weights] = log(value[paths->weights] / -expm1(-depth));
            }
            for (int w = 0; w < paths->weights; w++) value[w] = log(value[w] / (per_m * exp(paths->ln_range[row])));
        }
    }
}

/* ---- what a visibility has ------------------------------------------------------------------- */

static Status read_profile(Profile *out, const char *path)
{
    static const char *const kind[4] = {"clear", "haze", "clear_scatter", "haze_scatter"};
    static const GridColumn axis = {"height_m", 0, height_max_m};
    char name[4 * air_tabled_count][32];
    GridColumn column[4 * air_tabled_count];
    for (int i = 0; i < 4 * air_tabled_count; i++) {
        snprintf(name[i], sizeof name[i], "%s_%s", kind[i % 4], air_band_name(air_tabled[i / 4]));
        column[i] = (GridColumn){name[i], 0, 1e3};
    }
    Grid grid;
    Status status = grid_open(&grid, path, &axis, 1, column, 4 * air_tabled_count);
    if (status != STATUS_OK) return status;
    status = STATUS_BAD_VALUE;
    const int nodes = grid.nodes[0];
    if (nodes < 2 || nodes > profile_max || grid.axis[0][0] != 0) {
        log_error("atmosphere: %s: 2 to %d heights from 0 upwards are needed, there are %d from %g m", path,
                  (int)profile_max, nodes, grid.axis[0][0]);
        goto done;
    }
    out->nodes = nodes;
    memcpy(out->height_m, grid.axis[0], (size_t)nodes * sizeof *out->height_m);
    for (int i = 0; i < air_tabled_count; i++) {
        const AirBand band = air_tabled[i];
        for (int n = 0; n < nodes; n++) {
            const double *value = grid.value + (size_t)n * (4 * air_tabled_count) + 4 * i;
            out->clear_per_m[band][n] = value[0] * 1e-3;
            out->haze_per_m[band][n] = value[1] * 1e-3;
            out->clear_scatter[band][n] = value[2] * 1e-3;
            out->haze_scatter[band][n] = value[3] * 1e-3;
            if (value[0] + value[1] > 0) continue;
            log_error("atmosphere: %s: no extinction at all: band=%s height_m=%g", path, air_band_name(band),
                      out->height_m[n]);
            goto done;
        }
        for (int n = 1; n < nodes; n++) {
            const double half_m = (out->height_m[n] - out->height_m[n - 1]) / 2;
            out->clear_sum[band][n] = out->clear_sum[band][n - 1] +
                                      half_m * (out->clear_per_m[band][n] + out->clear_per_m[band][n - 1]);
            out->haze_sum[band][n] = out->haze_sum[band][n - 1] +
                                     half_m * (out->haze_per_m[band][n] + out->haze_per_m[band][n - 1]);
        }
    }
    status = STATUS_OK;
done:
    grid_close(&grid);
    return status;
}

static void zenith_axis(Grid *grid, int axis)
{
    for (int i = 0; i < grid->nodes[axis]; i++) grid->axis[axis][i] = slant_x(grid->axis[axis][i] * rad_per_deg);
}

static Status read_sky_thermal(Grid *out, const char *path)
{
    static const GridColumn axis[2] = {{"observer_m", 0, height_max_m}, {"zenith_deg", 0, 90}};
    static const GridColumn value[2] = {{"mwir", 1e-30, 1e4}, {"lwir", 1e-30, 1e4}};
    const Status status = grid_open(out, path, axis, 2, value, 2);
    if (status != STATUS_OK) return status;
    zenith_axis(out, 1);
    for (int i = 0; i < out->nodes[0] * out->nodes[1] * 2; i++) out->value[i] = log(out->value[i]);
    return STATUS_OK;
}

static Status read_sun(Grid *out, const char *path, const double sun_top_w_m2[AIR_BAND_COUNT])
{
    static const GridColumn axis[2] = {{"observer_m", 0, height_max_m}, {"sun_zenith_deg", 0, 90}};
    char name[2 * air_tabled_count][32];
    GridColumn column[2 * air_tabled_count];
    for (int i = 0; i < air_tabled_count; i++) {
        const double top = sun_top_w_m2[air_tabled[i]];
        snprintf(name[i], sizeof name[i], "direct_%s", air_band_name(air_tabled[i]));
        snprintf(name[i + air_tabled_count], sizeof name[i], "diffuse_%s", air_band_name(air_tabled[i]));
        column[i] = (GridColumn){name[i], 0, top};
        column[i + air_tabled_count] = (GridColumn){name[i + air_tabled_count], 0, top};
    }
    const Status status = grid_open(out, path, axis, 2, column, 2 * air_tabled_count);
    if (status != STATUS_OK) return status;
    zenith_axis(out, 1);
    for (int n = 0; n < out->nodes[0] * out->nodes[1]; n++)
        for (int i = 0; i < air_tabled_count; i++) {
            const double top = sun_top_w_m2[air_tabled[i]];
            double *direct = &out->value[n * 2 * air_tabled_count + i], *diffuse = direct + air_tabled_count;
            /* depth 0 and 700 keep the logarithms finite; neither shows in a product */
            *direct = log(clamp(-log(fmax(*direct, 1e-300) / top), 1e-12, 690));
            *diffuse = log(fmax(*diffuse / top, 1e-30));
        }
    return STATUS_OK;
}

static const GridColumn scattered_value[air_scattered_count] = {
    {"b", 0, 1e4}, {"g", 0, 1e4}, {"r", 0, 1e4}, {"nir", 0, 1e4}, {"mwir", 0, 1e4}};

/* Ratio of the truth to the estimate. Where the estimate is nothing so is the truth. */
static double ratio_to(double truth, double estimate) { return estimate > 1e-30 ? clamp(truth / estimate, 0, 100) : 1; }

static Status read_scattered(Slice *slice, const Atmosphere *atmosphere, const Blend *blend, const char *path)
{
    PathTable table;
    const Status status = paths_open(&table, path, 5, scattered_value, air_scattered_count, NULL);
    if (status != STATUS_OK) return status;
    for (int pair = 0; pair < table.heights * table.heights; pair++)
        for (int row = table.first[pair]; row < table.first[pair + 1]; row++)
            for (int i = 0; i < table.suns * table.azimuths; i++) {
                const AirPath at = {table.height_m[pair / table.heights], table.height_m[pair % table.heights],
                                    exp(table.ln_range[row]), table.sun_x[i / table.azimuths] * rad_per_deg,
                                    table.azimuth_deg[i % table.azimuths] * rad_per_deg};
                for (int b = 0; b < air_scattered_count; b++) {
                    double *value = &table.value[((size_t)row * (size_t)(table.suns * table.azimuths) + (size_t)i) *
                                                     air_scattered_count + (size_t)b];
                    *value = ratio_to(*value, scatter_estimate(atmosphere, blend, air_tabled[b], &at));
                }
            }
    for (int i = 0; i < table.suns; i++) table.sun_x[i] = slant_x(table.sun_x[i] * rad_per_deg);
    slice->scattered = table;
    return STATUS_OK;
}

static Status read_sky_scattered(Slice *slice, const Atmosphere *atmosphere, const Blend *blend, const char *path)
{
    static const GridColumn axis[4] = {
        {"observer_m", 0, height_max_m}, {"zenith_deg", 0, 90}, {"sun_zenith_deg", 0, 90}, {"rel_azimuth_deg", 0, 180}};
    Grid grid;
    const Status status = grid_open(&grid, path, axis, 4, scattered_value, air_scattered_count);
    if (status != STATUS_OK) return status;
    double *value = grid.value;
    for (int o = 0; o < grid.nodes[0]; o++)
        for (int z = 0; z < grid.nodes[1]; z++)
            for (int s = 0; s < grid.nodes[2]; s++)
                for (int a = 0; a < grid.nodes[3]; a++)
                    for (int b = 0; b < air_scattered_count; b++, value++)
                        *value = ratio_to(*value, scatter_estimate_sky(
                                                      atmosphere, blend, air_tabled[b], grid.axis[0][o],
                                                      grid.axis[1][z] * rad_per_deg, grid.axis[2][s] * rad_per_deg,
                                                      grid.axis[3][a] * rad_per_deg));
    zenith_axis(&grid, 1);
    zenith_axis(&grid, 2);
    slice->sky_scattered = grid;
    return STATUS_OK;
}

void slice_close(Slice *slice)
{
    for (int i = 0; i < AIR_BAND_COUNT; i++) paths_close(&slice->path[i]);
    paths_close(&slice->scattered);
    grid_close(&slice->sky_thermal);
    grid_close(&slice->sky_scattered);
    grid_close(&slice->sun);
}

static Status open_in(char *path, size_t size, const char *folder, const char *name)
{
    const int length = snprintf(path, size, "%s/%s", folder, name);
    if (length >= 0 && (size_t)length < size) return STATUS_OK;
    log_error("atmosphere: path too long: folder=%s", folder);
    return STATUS_BAD_VALUE;
}

Status slice_open(Slice *slice, const Atmosphere *atmosphere, const char *folder)
{
    char path[1024], name[64];
    Status status = open_in(path, sizeof path, folder, "sky_scattered.csv"); /* the longest name */
    if (status != STATUS_OK) return status;
    open_in(path, sizeof path, folder, "profile.csv");
    status = read_profile(&slice->profile, path);
    const Blend blend = {slice, slice, 0, 1, 0};
    for (int i = 0; i < air_tabled_count && status == STATUS_OK; i++) {
        const AirBand band = air_tabled[i];
        snprintf(name, sizeof name, "paths_%s.csv", air_band_name(band));
        open_in(path, sizeof path, folder, name);
        status = paths_open(&slice->path[band], path, 3, NULL, 0, choose_weights);
        if (status != STATUS_OK) break;
        if (air_band_is_thermal(band) && slice->path[band].weights < 2) {
            log_error("atmosphere: %s: a thermal band needs depth_<kelvin>k columns and thermal_w_m2_sr", path);
            return STATUS_BAD_VALUE;
        }
        normalize_paths(&slice->path[band], &blend, band);
    }
    if (status != STATUS_OK) return status;
    open_in(path, sizeof path, folder, "sky_thermal.csv");
    status = read_sky_thermal(&slice->sky_thermal, path);
    if (status != STATUS_OK) return status;
    open_in(path, sizeof path, folder, "sun.csv");
    status = read_sun(&slice->sun, path, atmosphere->sun_top_w_m2);
    if (status != STATUS_OK) return status;
    open_in(path, sizeof path, folder, "sky_scattered.csv");
    status = read_sky_scattered(slice, atmosphere, &blend, path);
    if (status != STATUS_OK) return status;
    open_in(path, sizeof path, folder, "scattered.csv");
    if (access(path, R_OK) != 0) return STATUS_OK; /* the estimate stands alone */
    return read_scattered(slice, atmosphere, &blend, path);
}

/* ---- the model ------------------------------------------------------------------------------- */

static Status read_sun_top(double sun_top_w_m2[AIR_BAND_COUNT])
{
    char path[1024];
    if (!etc_path(path, sizeof path, "atmosphere/bands.csv")) return STATUS_BAD_VALUE;
    Table table = {0};
    if (table_open(&table, path) != STATUS_OK) return STATUS_BAD_VALUE;
    Status status = STATUS_BAD_VALUE;
    const int name = table_column(&table, "band"), top = table_column(&table, "sun_top_w_m2");
    if (name < 0 || top < 0) {
        log_error("atmosphere: %s:%d: column missing: %s", path, table.line[0], name < 0 ? "band" : "sun_top_w_m2");
        goto done;
    }
    for (int row = 0; row < table.rows; row++) {
        AirBand band = AIR_B;
        while (band < AIR_BAND_COUNT && strcmp(air_band_name(band), table_text(&table, row, name)) != 0) band++;
        if (band == AIR_BAND_COUNT || air_tabled_index(band) < 0 || sun_top_w_m2[band] > 0) {
            log_error("atmosphere: %s:%d: band %s is unknown or there twice", path, table.line[row + 1],
                      table_text(&table, row, name));
            goto done;
        }
        if (table_number(&sun_top_w_m2[band], &table, row, top, 1e-3, 1361) != STATUS_OK) goto done;
    }
    for (int i = 0; i < air_tabled_count; i++) {
        if (sun_top_w_m2[air_tabled[i]] > 0) continue;
        log_error("atmosphere: %s: band missing: %s", path, air_band_name(air_tabled[i]));
        goto done;
    }
    sun_top_w_m2[AIR_PAN] = sun_top_w_m2[AIR_B] + sun_top_w_m2[AIR_G] + sun_top_w_m2[AIR_R];
    status = STATUS_OK;
done:
    table_close(&table);
    return status;
}

static Status open_model(Atmosphere *atmosphere, const char *folder)
{
    static const GridColumn height = {"height_m", 0, height_max_m}, temp = {"temp_k", 100, 400};
    static const GridColumn angle = {"angle_deg", 0, 180};
    static const GridColumn phase[air_scattered_count] = {
        {"b", 1e-6, 1e6}, {"g", 1e-6, 1e6}, {"r", 1e-6, 1e6}, {"nir", 1e-6, 1e6}, {"mwir", 1e-6, 1e6}};
    static const GridColumn visibility = {"visibility_m", 100, 500000}, longwave = {"longwave_down_w_m2", 1, 1000};
    char path[1024], slice_folder[1024];
    Status status = open_in(path, sizeof path, folder, "visibilities.csv");
    if (status != STATUS_OK) return status;
    Grid list = {0};
    status = grid_open(&list, path, &visibility, 1, &longwave, 1);
    if (status != STATUS_OK) return status;
    if (list.nodes[0] > slices_max) {
        log_error("atmosphere: %s: more than %d visibilities", path, (int)slices_max);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) {
        open_in(path, sizeof path, folder, "temperature.csv");
        status = grid_open(&atmosphere->temperature, path, &height, 1, &temp, 1);
    }
    if (status == STATUS_OK) {
        open_in(path, sizeof path, folder, "phase.csv");
        status = grid_open(&atmosphere->phase, path, &angle, 1, phase, air_scattered_count);
    }
    if (status == STATUS_OK) {
        for (int i = 0; i < atmosphere->phase.nodes[0]; i++) atmosphere->phase.axis[0][i] *= rad_per_deg;
        for (int i = 0; i < atmosphere->phase.nodes[0] * air_scattered_count; i++)
            atmosphere->phase.value[i] = log(atmosphere->phase.value[i]);
        atmosphere->slice = calloc((size_t)list.nodes[0], sizeof *atmosphere->slice);
        if (!atmosphere->slice) status = STATUS_NO_MEMORY;
    }
    for (int i = 0; i < list.nodes[0] && status == STATUS_OK; i++) {
        Slice *slice = &atmosphere->slice[i];
        slice->visibility_m = list.axis[0][i];
        slice->longwave_down_w_m2 = list.value[i];
        atmosphere->slices++;
        snprintf(path, sizeof path, "%.0f", slice->visibility_m);
        status = open_in(slice_folder, sizeof slice_folder, folder, path);
        if (status == STATUS_OK) status = slice_open(slice, atmosphere, slice_folder);
    }
    grid_close(&list);
    return status;
}

Status atmosphere_open(Atmosphere **out, const char *model)
{
    char name[96], folder[512];
    bool plain = *model && strlen(model) < 64;
    for (const char *c = model; *c; c++)
        plain = plain && ((*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9') || *c == '_');
    if (!plain) {
        char shown[64];
        text_escape(shown, sizeof shown, model, strlen(model));
        log_error("atmosphere: a model's name is of a-z, 0-9 and _, not '%s'", shown);
        return STATUS_BAD_VALUE;
    }
    snprintf(name, sizeof name, "atmosphere/%s", model);
    if (!etc_path(folder, sizeof folder, name)) {
        log_error("atmosphere: path too long: model=%s", model);
        return STATUS_BAD_VALUE;
    }
    Atmosphere *atmosphere = calloc(1, sizeof *atmosphere);
    if (!atmosphere) return STATUS_NO_MEMORY;
    Status status = read_sun_top(atmosphere->sun_top_w_m2);
    if (status == STATUS_OK) status = open_model(atmosphere, folder);
    if (status != STATUS_OK) {
        log_error("atmosphere: cannot use model %s: etc/atmosphere/README.md is the format", model);
        atmosphere_close(atmosphere);
        return status;
    }
    *out = atmosphere;
    return STATUS_OK;
}

void atmosphere_close(Atmosphere *atmosphere)
{
    if (!atmosphere) return;
    for (int i = 0; i < atmosphere->slices; i++) slice_close(&atmosphere->slice[i]);
    free(atmosphere->slice);
    grid_close(&atmosphere->temperature);
    grid_close(&atmosphere->phase);
    free(atmosphere);
}
