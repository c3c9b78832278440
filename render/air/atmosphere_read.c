/* render/air/atmosphere_read.c: reads the files of etc/atmosphere (README.md there) into memory, checks every cell,
 * and converts the values to quantities that are smooth between the points: ratios to an estimate, logarithms. */
#include "render/air/atmosphere_private.h"

#include <stdlib.h>

enum { depth_max = 1000 };

/* ---- paths ---------------------------------------------------------------------------------- */

/* Columns of paths_*.csv: depth_sun, any depth_<kelvin>k in rising order, thermal_w_m2_sr where there are such. */
static Status choose_weights(PathTable *out, const TableRows *rows, GridColumn *column, int *count)
{
    int n = 0;
    column[n++] = (GridColumn){"depth_sun", 1e-12, depth_max};
    for (int c = 0; c < rows->table.columns; c++) {
        const char  *name = rows->table.cell[c];
        char         text[32];
        const size_t length = strlen(name);
        if (strncmp(name, "depth_", 6) != 0 || strcmp(name, "depth_sun") == 0) continue;
        double     temp_k;
        const bool fits = length > 7 && length < sizeof text && name[length - 1] == 'k';
        if (fits) snprintf(text, length - 6, "%s", name + 6);
        if (!fits || !text_to_double(&temp_k, text) || !(temp_k >= 50 && temp_k <= 1e4) || n == path_max_weights ||
            (n > 1 && !(temp_k > out->weight_temp_k[n - 1])))
            return table_rows_refuse(rows, -1, NULL,
                                     "column %s: want depth_sun and depth_<kelvin>k, 50 to 10000 K rising, at most %d",
                                     name, path_max_weights - 1);
        out->weight_temp_k[n] = temp_k;
        column[n++] = (GridColumn){name, 1e-12, depth_max};
    }
    out->weights = n;
    *count = n;
    return STATUS_OK;
}

/* With haze: the radiance of the path, too. */
static Status choose_weights_and_radiance(PathTable *out, const TableRows *rows, GridColumn *column, int *count)
{
    const Status status = choose_weights(out, rows, column, count);
    if (status == STATUS_OK && *count > 1) column[(*count)++] = (GridColumn){"thermal_w_m2_sr", 1e-30, 1e4};
    return status;
}

static AirPath path_of_row(const PathTable *paths, int pair, int row)
{
    return (AirPath){.observer_m = paths->axis[0][pair / paths->nodes[1]],
                     .target_m = paths->axis[1][pair % paths->nodes[1]],
                     .range_m = exp(paths->ln_range[row])};
}

static void normalize_clear(PathTable *paths, const AirColumn *clear, AirBand band)
{
    for (int pair = 0; pair < paths->nodes[0] * paths->nodes[1]; pair++)
        for (int row = paths->first[pair]; row < paths->first[pair + 1]; row++) {
            const AirPath path = path_of_row(paths, pair, row);
            const double  plain = path.range_m * column_mean(clear, band, path.observer_m, path.target_m);
            double       *value = paths->value + (size_t)row * (size_t)paths->values;
            for (int w = 0; w < paths->weights; w++) value[w] = log(value[w] / plain);
        }
}

/* clear_depths bends a long path around the Earth; the rows are of flat layers. */
static void flat_clear_depths(double *out, const Atmosphere *atmosphere, AirBand band, const AirPath *path,
                              const double *temp_k, int temps)
{
    const AirColumn *clear = &atmosphere->clear;
    const double     sag_m = mean_chord_error_m(path->range_m);
    const double     flat = column_mean(clear, band, path->observer_m, path->target_m);
    const double     bent = column_mean(clear, band, path->observer_m - sag_m, path->target_m - sag_m);
    clear_depths(out, atmosphere, band, path, temp_k, temps);
    for (int t = 0; t < temps; t++) out[t] = out[t] * flat / bent;
}

static void normalize_hazy(PathTable *paths, const Atmosphere *atmosphere, const AirColumn *haze, AirBand band)
{
    double temp_k[path_max_weights] = {NAN}, clear[path_max_weights];
    for (int w = 1; w < paths->weights; w++) temp_k[w] = paths->weight_temp_k[w];
    for (int pair = 0; pair < paths->nodes[0] * paths->nodes[1]; pair++)
        for (int row = paths->first[pair]; row < paths->first[pair + 1]; row++) {
            const AirPath path = path_of_row(paths, pair, row);
            const double  plain = path.range_m * column_mean(haze, band, path.observer_m, path.target_m);
            double       *value = paths->value + (size_t)row * (size_t)paths->values;
            if (paths->weights > 1) {
                const double opaque = value[paths->weights] / -expm1(-value[path_emission_weight(paths)]);
                value[paths->weights] = log(opaque / mean_black(atmosphere, band, path.observer_m, path.target_m));
            }
            flat_clear_depths(clear, atmosphere, band, &path, temp_k, paths->weights);
            for (int w = 0; w < paths->weights; w++)
                value[w] = clamp((value[w] - clear[w]) / fmax(plain, 1e-12), -1, 3);
        }
}

/* ---- tables of all channels -------------------------------------------------------------------- */

/* A column <prefix><channel> of a file that holds the standard channels as columns. */
typedef struct ChannelColumn {
    const char *prefix;
    AirBand     band;
    double      low, high;
} ChannelColumn;

static bool is_standard(AirBand band) { return channel_in(band)->standard; }

/* FILE_<channel>.csv beside FILE.csv: of a channel that replaces a standard one. */
static Status path_beside(char out[1024], const char *path, AirBand band)
{
    const int length = snprintf(out, 1024, "%.*s_%s.csv", (int)strlen(path) - 4, path, air_band_name(band));
    if (length >= 0 && length < 1024) return STATUS_OK;
    log_error("atmosphere: path too long: %s", path);
    return STATUS_BAD_VALUE;
}

/* Of a file with standard channels; a channel that is not in use is not read. */
static void name_column(GridColumn *out, char name[48], const ChannelColumn *c, bool beside)
{
    static const char *const standard[AIR_BAND_COUNT] = {"b", "g", "r", "pan", "nir", "mwir", "lwir"};
    const bool               seen = beside || is_standard(c->band);
    snprintf(name, 48, "%s%s", c->prefix, beside ? air_band_name(c->band) : standard[c->band]);
    *out = (GridColumn){name, seen ? c->low : -1e300, seen ? c->high : 1e300};
}

static bool same_axes(const Grid *a, const Grid *b)
{
    for (int k = 0; k < a->axes; k++)
        if (a->nodes[k] != b->nodes[k] || memcmp(a->axis[k], b->axis[k], (size_t)a->nodes[k] * sizeof(double)) != 0)
            return false;
    return true;
}

enum { channel_columns_most = 2 * air_tabled_count };

/* Columns of channels by index: of the file, and of the file beside it where another channel replaces the standard
 * one. */
static Status channels_open(Grid *out, const char *path, const GridColumn *axis, int axes, const ChannelColumn *column,
                            int columns)
{
    char       name[channel_columns_most][48], beside[1024];
    GridColumn of[channel_columns_most];
    for (int i = 0; i < columns; i++) name_column(&of[i], name[i], &column[i], false);
    Status status = grid_open(out, path, axis, axes, of, columns);
    if (status != STATUS_OK) return status;
    size_t nodes = 1;
    for (int k = 0; k < axes; k++) nodes *= (size_t)out->nodes[k];
    for (int i = 0; i < columns && status == STATUS_OK; i++) {
        if (is_standard(column[i].band)) continue;
        Grid one = {0};
        name_column(&of[i], name[i], &column[i], true);
        status = path_beside(beside, path, column[i].band);
        if (status == STATUS_OK) status = grid_open(&one, beside, axis, axes, &of[i], 1);
        if (status == STATUS_OK && !same_axes(out, &one)) {
            log_error("atmosphere: %s: its rows are not those of %s", beside, path);
            status = STATUS_BAD_VALUE;
        }
        for (size_t n = 0; n < nodes && status == STATUS_OK; n++)
            out->value[n * (size_t)columns + (size_t)i] = one.value[n];
        grid_close(&one);
    }
    if (status != STATUS_OK) grid_close(out);
    return status;
}

/* ---- columns of air ---------------------------------------------------------------------------- */

void column_sum_up(const AirColumn *column, const double *value, double *sum)
{
    for (int n = 1; n < column->nodes; n++)
        sum[n] = sum[n - 1] + (column->height_m[n] - column->height_m[n - 1]) / 2 * (value[n] + value[n - 1]);
}

/* Columns extinction_<band> and scatter_<band>, 1/km; low: lower limit of extinction. */
static Status read_column(AirColumn *out, const char *path, double low)
{
    static const GridColumn axis = {"height_m", 0, height_max_m};
    ChannelColumn           column[2 * air_tabled_count];
    for (int i = 0; i < 2 * air_tabled_count; i++)
        column[i] = (ChannelColumn){i % 2 ? "scatter_" : "extinction_", air_tabled[i / 2], i % 2 ? 0 : low, 1e3};
    Grid   grid;
    Status status = channels_open(&grid, path, &axis, 1, column, 2 * air_tabled_count);
    if (status != STATUS_OK) return status;
    out->nodes = grid.nodes[0];
    if (out->nodes >= 2 && out->nodes <= column_max && grid.axis[0][0] == 0) {
        memcpy(out->height_m, grid.axis[0], (size_t)out->nodes * sizeof *out->height_m);
        for (int i = 0; i < 2 * air_tabled_count; i++) {
            double *to = i % 2 ? out->scatter_per_m[air_tabled[i / 2]] : out->per_m[air_tabled[i / 2]];
            for (int n = 0; n < out->nodes; n++) to[n] = grid.value[n * 2 * air_tabled_count + i] * 1e-3;
        }
        for (int i = 0; i < air_tabled_count; i++)
            column_sum_up(out, out->per_m[air_tabled[i]], out->sum[air_tabled[i]]);
    } else {
        log_error("atmosphere: %s: 2 to %d heights from 0 upwards are needed, there are %d from %g m", path,
                  (int)column_max, out->nodes, grid.axis[0][0]);
        status = STATUS_BAD_VALUE;
    }
    grid_close(&grid);
    return status;
}

void column_black(AirColumn *clear, const Atmosphere *atmosphere)
{
    for (int i = 0; i < 2; i++) {
        const AirBand band = i ? AIR_LWIR : AIR_MWIR;
        for (int n = 0; n < clear->nodes; n++)
            clear->black_per_m[i][n] = clear->per_m[band][n] * black_air(atmosphere, band, clear->height_m[n]);
        column_sum_up(clear, clear->black_per_m[i], clear->black_sum[i]);
    }
}

/* ---- sky and sun ------------------------------------------------------------------------------- */

static void zenith_axis(Grid *grid, int axis)
{
    for (int i = 0; i < grid->nodes[axis]; i++) grid->axis[axis][i] = slant_x(grid->axis[axis][i] * rad_per_deg);
}

static Status read_sky_thermal(Grid *out, const Atmosphere *atmosphere, const char *path)
{
    static const GridColumn    axis[2] = {{"observer_m", 0, height_max_m}, {"zenith_deg", 0, 90}};
    static const ChannelColumn value[2] = {{"", AIR_MWIR, 1e-30, 1e4}, {"", AIR_LWIR, 1e-30, 1e4}};
    const Status               status = channels_open(out, path, axis, 2, value, 2);
    if (status != STATUS_OK) return status;
    zenith_axis(out, 1);
    for (int i = 0; i < out->nodes[0] * out->nodes[1] * 2; i++) {
        const double height_m = out->axis[0][i / (2 * out->nodes[1])];
        out->value[i] = log(out->value[i] / black_air(atmosphere, i % 2 ? AIR_LWIR : AIR_MWIR, height_m));
    }
    return STATUS_OK;
}

static Status read_sun(Grid *out, const char *path, const double sun_top_w_m2[AIR_BAND_COUNT])
{
    static const GridColumn axis[2] = {{"observer_m", 0, height_max_m}, {"sun_zenith_deg", 0, 90}};
    ChannelColumn           column[2 * air_tabled_count];
    for (int i = 0; i < air_tabled_count; i++) {
        const double top = sun_top_w_m2[air_tabled[i]];
        column[i] = (ChannelColumn){"direct_", air_tabled[i], 0, top};
        column[i + air_tabled_count] = (ChannelColumn){"diffuse_", air_tabled[i], 0, top};
    }
    const Status status = channels_open(out, path, axis, 2, column, 2 * air_tabled_count);
    if (status != STATUS_OK) return status;
    zenith_axis(out, 1);
    for (int n = 0; n < out->nodes[0] * out->nodes[1]; n++)
        for (int i = 0; i < air_tabled_count; i++) {
            const double top = sun_top_w_m2[air_tabled[i]];
            double      *direct = &out->value[n * 2 * air_tabled_count + i], *diffuse = direct + air_tabled_count;
            /* depth 0 and 700 keep the logarithms finite; neither affects a product */
            *direct = log(clamp(-log(fmax(*direct, 1e-300) / top), 1e-12, 690));
            *diffuse = log(fmax(*diffuse / top, 1e-30));
        }
    return STATUS_OK;
}

static const ChannelColumn scattered_column[air_tabled_count] = {{"", AIR_B, 0, 1e4},    {"", AIR_G, 0, 1e4},
                                                                 {"", AIR_R, 0, 1e4},    {"", AIR_NIR, 0, 1e4},
                                                                 {"", AIR_MWIR, 0, 1e4}, {"", AIR_LWIR, 0, 1e4}};

/* scattered.csv, each channel at its index, as channels_open. */
static Status open_scattered(PathTable *out, const char *path)
{
    char       name[air_tabled_count][48], beside[1024];
    GridColumn of[air_tabled_count];
    for (int i = 0; i < air_tabled_count; i++) name_column(&of[i], name[i], &scattered_column[i], false);
    Status status = paths_open(out, path, 5, of, air_tabled_count, NULL);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < air_tabled_count && status == STATUS_OK; i++) {
        if (is_standard(air_tabled[i])) continue;
        PathTable one = {0};
        name_column(&of[i], name[i], &scattered_column[i], true);
        status = path_beside(beside, path, air_tabled[i]);
        if (status == STATUS_OK) status = paths_open(&one, beside, 5, &of[i], 1, NULL);
        if (status == STATUS_OK &&
            (!paths_same_shape(out, &one) || one.suns != out->suns || one.azimuths != out->azimuths)) {
            log_error("atmosphere: %s: its rows are not those of %s", beside, path);
            status = STATUS_BAD_VALUE;
        }
        const int count = status == STATUS_OK ? out->rows * out->suns * out->azimuths : 0;
        for (int n = 0; n < count; n++) out->value[n * air_tabled_count + i] = one.value[n];
        paths_close(&one);
    }
    if (status != STATUS_OK) paths_close(out);
    return status;
}

/* Ratio of the true value to the estimate. Where the estimate is 0 so is the true value. */
static double ratio_to(double truth, double estimate) { return estimate > 1e-30 ? clamp(truth / estimate, 0, 100) : 1; }

static Status read_scattered(Slice *slice, const Atmosphere *atmosphere, const Blend *blend, const char *path)
{
    PathTable    table;
    const Status status = open_scattered(&table, path);
    if (status != STATUS_OK) return status;
    for (int j = 0; j < table.nodes[1]; j++) table.axis[1][j] = -cos(table.axis[1][j] * rad_per_deg);
    double *value = table.value;
    for (int pair = 0; pair < table.nodes[0] * table.nodes[1]; pair++)
        for (int row = table.first[pair]; row < table.first[pair + 1]; row++)
            for (int s = 0; s < table.suns; s++, value += table.azimuths * air_tabled_count) {
                const double  up = -table.axis[1][pair % table.nodes[1]], range_m = exp(table.ln_range[row]);
                const double  observer_m = table.axis[0][pair / table.nodes[1]];
                const AirPath at = {observer_m, fmax(observer_m + up * range_m, 0), range_m,
                                    table.sun_x[s] * rad_per_deg, 0};
                for (int b = 0; b < air_tabled_count; b++) {
                    ScatterParts parts;
                    scatter_parts(&parts, atmosphere, blend, air_tabled[b], &at,
                                  path_depth(atmosphere, blend, air_tabled[b], &at, NAN));
                    for (int a = 0; a < table.azimuths; a++)
                        value[a * air_tabled_count + b] =
                            ratio_to(value[a * air_tabled_count + b],
                                     scatter_estimate(&parts, atmosphere, air_tabled[b], up, at.sun_zenith_rad,
                                                      table.azimuth_deg[a] * rad_per_deg));
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
    Grid         grid;
    const Status status = channels_open(&grid, path, axis, 4, scattered_column, air_tabled_count);
    if (status != STATUS_OK) return status;
    const int azimuths = grid.nodes[3];
    double   *value = grid.value;
    for (int o = 0; o < grid.nodes[0]; o++)
        for (int z = 0; z < grid.nodes[1]; z++)
            for (int s = 0; s < grid.nodes[2]; s++, value += azimuths * air_tabled_count) {
                const double zenith_rad = grid.axis[1][z] * rad_per_deg, sun_rad = grid.axis[2][s] * rad_per_deg;
                for (int b = 0; b < air_tabled_count; b++) {
                    ScatterParts parts;
                    scatter_parts_sky(&parts, atmosphere, blend, air_tabled[b], grid.axis[0][o], zenith_rad, sun_rad);
                    for (int a = 0; a < azimuths; a++)
                        value[a * air_tabled_count + b] =
                            ratio_to(value[a * air_tabled_count + b],
                                     scatter_estimate(&parts, atmosphere, air_tabled[b], cos(zenith_rad), sun_rad,
                                                      grid.axis[3][a] * rad_per_deg));
                }
            }
    zenith_axis(&grid, 1);
    zenith_axis(&grid, 2);
    slice->sky_scattered = grid;
    return STATUS_OK;
}

/* ---- data of a visibility ----------------------------------------------------------------------- */

void slice_close(Slice *slice)
{
    for (int i = 0; i < AIR_BAND_COUNT; i++) paths_close(&slice->path[i]);
    paths_close(&slice->scattered);
    grid_close(&slice->sky_thermal);
    grid_close(&slice->sky_scattered);
    grid_close(&slice->sun);
}

Status atmosphere_file(char path[1024], const char *folder, const char *name)
{
    const int length = snprintf(path, 1024, "%s/%s", folder, name);
    if (length >= 0 && length < 1024) return STATUS_OK;
    log_error("atmosphere: path too long: folder=%s", folder);
    return STATUS_BAD_VALUE;
}

/* paths_<band>.csv of a folder, rows as they are. */
static Status open_paths(PathTable *out, const char *folder, AirBand band, bool hazy)
{
    char path[1024], name[64];
    snprintf(name, sizeof name, "paths_%s.csv", air_band_name(band));
    Status status = atmosphere_file(path, folder, name);
    if (status != STATUS_OK) return status;
    status = paths_open(out, path, 3, NULL, 0, hazy ? choose_weights_and_radiance : choose_weights);
    if (status != STATUS_OK || !air_band_is_thermal(band) || out->weights > 1) return status;
    log_error("atmosphere: %s:1: a thermal band needs depth_<kelvin>k columns%s", path,
              hazy ? " and thermal_w_m2_sr" : "");
    return STATUS_BAD_VALUE;
}

/* The haze itself, the sun and the sky's own light; paths and scattered light where the slice says that it has them. */
Status slice_open(Slice *slice, const Atmosphere *atmosphere, const char *folder)
{
    char        path[1024];
    const Blend blend = {slice, slice, 0, 1, 0};
    Status      status = atmosphere_file(path, folder, "haze.csv");
    if (status == STATUS_OK) status = read_column(&slice->haze, path, 0);
    if (status == STATUS_OK) status = atmosphere_file(path, folder, "sky_thermal.csv");
    if (status == STATUS_OK) status = read_sky_thermal(&slice->sky_thermal, atmosphere, path);
    if (status == STATUS_OK) status = atmosphere_file(path, folder, "sun.csv");
    if (status == STATUS_OK) status = read_sun(&slice->sun, path, atmosphere->sun_top_w_m2);
    for (int i = 0; i < air_tabled_count && slice->has_paths && status == STATUS_OK; i++) {
        const AirBand band = air_tabled[i];
        status = open_paths(&slice->path[band], folder, band, true);
        if (status == STATUS_OK) normalize_hazy(&slice->path[band], atmosphere, &slice->haze, band);
    }
    if (status != STATUS_OK || !slice->has_scattered) return status;
    status = atmosphere_file(path, folder, "sky_scattered.csv");
    if (status == STATUS_OK) status = read_sky_scattered(slice, atmosphere, &blend, path);
    if (status == STATUS_OK) status = atmosphere_file(path, folder, "scattered.csv");
    if (status == STATUS_OK) status = read_scattered(slice, atmosphere, &blend, path);
    return status;
}

/* ---- data shared by all visibilities --------------------------------------------------------------------------- */

typedef struct TopRow {
    const char *band;
    double      sun_top_w_m2;
} TopRow;

static Status take_top(void *user, const void *read, const TableRows *rows, int number)
{
    double                *sun_top_w_m2 = user;
    const TopRow          *row = read;
    const SpectralChannel *channel = channel_named(row->band, strlen(row->band));
    const AirBand          band = channel ? channel->place : AIR_BAND_COUNT;
    if (channel && channel_in(band) != channel) return STATUS_OK; /* another channel replaces it */
    if (band == AIR_BAND_COUNT || air_tabled_index(band) < 0 || sun_top_w_m2[band] > 0)
        return table_rows_refuse(rows, number, NULL, "band %s is unknown or there twice", row->band);
    sun_top_w_m2[band] = row->sun_top_w_m2;
    return STATUS_OK;
}

Status sun_top_open(double sun_top_w_m2[AIR_BAND_COUNT])
{
    static const TableColumn columns[] = {
        {"band", .type = TABLE_CELL, TABLE_AT(TopRow, band)},
        {"sun_top_w_m2", TABLE_DOUBLE, TABLE_AT(TopRow, sun_top_w_m2), .low = 1e-3, .high = 1361}};
    static const TableFormat format = {"atmosphere", columns, 2,
                                       .next = "etc/atmosphere/README.md explains the columns"};
    char                     path[1024];
    TopRow                   row;
    if (!etc_path(path, sizeof path, "atmosphere/bands.csv")) return STATUS_BAD_VALUE;
    const Status status = table_each(&format, path, &row, sizeof row, take_top, sun_top_w_m2);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < air_tabled_count; i++) {
        if (sun_top_w_m2[air_tabled[i]] > 0) continue;
        log_error("atmosphere: %s: band missing: %s", path, air_band_name(air_tabled[i]));
        return STATUS_BAD_VALUE;
    }
    sun_top_w_m2[AIR_PAN] = sun_top_w_m2[AIR_B] + sun_top_w_m2[AIR_G] + sun_top_w_m2[AIR_R];
    return STATUS_OK;
}

Status clear_open(Atmosphere *atmosphere, const char *folder)
{
    static const GridColumn height = {"height_m", 0, height_max_m}, temp = {"temp_k", 100, 400};
    static const GridColumn angle[2] = {{"height_m", 0, height_max_m}, {"angle_deg", 0, 180}};
    ChannelColumn           phase[air_tabled_count];
    for (int i = 0; i < air_tabled_count; i++) phase[i] = (ChannelColumn){"", air_tabled[i], 1e-6, 1e6};
    char   path[1024], clear[1024];
    Status status = atmosphere_file(path, folder, "temperature.csv");
    if (status == STATUS_OK) status = grid_open(&atmosphere->temperature, path, &height, 1, &temp, 1);
    if (status == STATUS_OK) status = atmosphere_file(path, folder, "phase.csv");
    if (status == STATUS_OK) status = channels_open(&atmosphere->phase, path, angle, 2, phase, air_tabled_count);
    if (status != STATUS_OK) return status;
    Grid *p = &atmosphere->phase;
    if (p->nodes[0] > phase_heights_max) {
        log_error("atmosphere: %s: more than %d heights", path, (int)phase_heights_max);
        return STATUS_BAD_VALUE;
    }
    for (int i = 0; i < p->nodes[1]; i++) p->axis[1][i] *= rad_per_deg;
    for (int i = 0; i < p->nodes[0] * p->nodes[1] * air_tabled_count; i++) p->value[i] = log(p->value[i]);

    status = atmosphere_file(clear, folder, "clear");
    if (status == STATUS_OK) status = atmosphere_file(path, clear, "air.csv");
    if (status == STATUS_OK) status = read_column(&atmosphere->clear, path, 1e-12);
    if (status == STATUS_OK) column_black(&atmosphere->clear, atmosphere);
    for (int i = 0; i < air_tabled_count && status == STATUS_OK; i++) {
        const AirBand band = air_tabled[i];
        status = open_paths(&atmosphere->clear_path[band], clear, band, false);
        if (status == STATUS_OK) normalize_clear(&atmosphere->clear_path[band], &atmosphere->clear, band);
    }
    return status;
}
