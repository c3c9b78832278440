/* render/air/atmosphere_open.c: opens a model of the atmosphere by its name or folder: selects the visibilities to
 * read and makes those between them. */

#include "render/air/atmosphere_private.h"

#include <dirent.h>
#include <stdlib.h>
#include <unistd.h>

static bool folder_has(const char *folder, const char *name)
{
    char path[1024];
    return atmosphere_file(path, folder, name) == STATUS_OK && access(path, F_OK) == 0;
}

/* The tables that a visibility needs: the two about it of those that have data; beyond the last of these the last
 * two. At the visibility of a table, this alone. */
static void choose_tables(bool need[slices_max], const bool has[slices_max], const double *table_m, int count,
                          double visibility_m)
{
    int of[slices_max] = {0}, n = 0, i = 0;
    for (int k = 0; k < count; k++)
        if (has[k]) of[n++] = k;
    while (i + 2 < n && visibility_m > table_m[of[i + 1]]) i++;
    for (int k = i; k < n && k < i + 2; k++)
        if (n == 1 || visibility_m != table_m[of[k == i ? i + 1 : i]]) need[of[k]] = true;
}

/* The slices to make: of one visibility, or enough that any visibility is close to two of them. */
static Status make_slices(Atmosphere *atmosphere, const Slice *tabled, int count, double visibility_m)
{
    double step_m[slices_made_max] = {visibility_m};
    int    steps = 1;
    if (isnan(visibility_m)) steps = visibility_steps(step_m, tabled, count, atmosphere->low_m, atmosphere->high_m);
    atmosphere->slice = calloc((size_t)steps, sizeof *atmosphere->slice);
    if (!atmosphere->slice) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    for (int i = 0; i < steps && status == STATUS_OK; i++) {
        atmosphere->slices++;
        status = slice_between(&atmosphere->slice[i], atmosphere, tabled, count, step_m[i]);
    }
    return status;
}

/* Beyond the tables' visibilities haze is extrapolated along the same straight line in 1 / visibility, up to this
 * factor. */
static const double visibility_below = 0.4, visibility_above = 2.2;

/* list: visibilities and the other columns of visibilities.csv. A folder without paths_b.csv has no paths, one without
 * sky_scattered.csv no scattered light; the neighbours' count there. */
static Status open_slices(Atmosphere *atmosphere, const char *folder, const Grid *list, double visibility_m)
{
    const int     count = list->nodes[0];
    const double *table_m = list->axis[0];
    bool          paths[slices_max] = {false}, light[slices_max] = {false}, need[slices_max] = {false}, all[slices_max];
    bool          any_paths = false, any_light = false;
    char          slice_folder[slices_max][1024], name[32];
    for (int i = 0; i < count; i++) {
        snprintf(name, sizeof name, "%.0f", table_m[i]);
        if (atmosphere_file(slice_folder[i], folder, name) != STATUS_OK) return STATUS_BAD_VALUE;
        any_paths |= paths[i] = folder_has(slice_folder[i], "paths_b.csv");
        any_light |= light[i] = folder_has(slice_folder[i], "sky_scattered.csv");
        all[i] = true;
    }
    if (!any_paths) paths[0] = true; /* the missing file is reported later */
    if (!any_light) light[0] = true;
    atmosphere->low_m = table_m[0] * visibility_below;
    atmosphere->high_m = table_m[count - 1] * visibility_above;
    if (isnan(visibility_m)) {
        memcpy(need, all, sizeof need);
    } else {
        visibility_m = clamp(visibility_m, atmosphere->low_m, atmosphere->high_m);
        choose_tables(need, all, table_m, count, visibility_m);
        choose_tables(need, paths, table_m, count, visibility_m);
        choose_tables(need, light, table_m, count, visibility_m);
    }

    Slice *tabled = calloc((size_t)count, sizeof *tabled);
    if (!tabled) return STATUS_NO_MEMORY;
    int    read = 0;
    Status status = STATUS_OK;
    for (int i = 0; i < count && status == STATUS_OK; i++) {
        if (!need[i]) continue;
        tabled[read].visibility_m = table_m[i];
        tabled[read].longwave_down_w_m2 = list->value[i];
        tabled[read].has_paths = paths[i];
        tabled[read].has_scattered = light[i];
        status = slice_open(&tabled[read++], atmosphere, slice_folder[i]);
    }
    if (status == STATUS_OK) status = make_slices(atmosphere, tabled, read, visibility_m);
    for (int i = 0; i < read; i++) slice_close(&tabled[i]);
    free(tabled);
    return status;
}

/* The one row stays where it was read. */
static Status keep_row(void *user, const void *read, const TableRows *rows, int number)
{
    (void)user, (void)read;
    return number == 0 ? STATUS_OK : table_rows_refuse(rows, number, NULL, "one row is enough");
}

/* ground.csv, which a model need not have. */
static Status open_ground(Atmosphere *atmosphere, const char *folder)
{
    static const TableColumn vapour = {"vapour_g_m3", TABLE_DOUBLE, .size = sizeof(double), .low = 0, .high = 200};
    static const TableFormat format = {"atmosphere", &vapour, 1,
                                       .next = "etc/atmosphere/README.md explains the columns"};
    char                     path[1024];
    double                   g_m3 = NAN;
    atmosphere->ground_kg_m3 = NAN;
    if (!folder_has(folder, "ground.csv")) return STATUS_OK;
    Status status = atmosphere_file(path, folder, "ground.csv");
    if (status == STATUS_OK) status = table_each(&format, path, &g_m3, sizeof g_m3, keep_row, NULL);
    atmosphere->ground_kg_m3 = 1e-3 * g_m3;
    return status;
}

static Status open_model(Atmosphere *atmosphere, const char *folder, double visibility_m)
{
    static const GridColumn visibility = {"visibility_m", 100, 500000}, longwave = {"longwave_down_w_m2", 1, 1000};
    char                    path[1024];
    Status                  status = atmosphere_file(path, folder, "visibilities.csv");
    Grid                    list = {0};
    if (status == STATUS_OK) status = grid_open(&list, path, &visibility, 1, &longwave, 1);
    if (status != STATUS_OK) return status;
    if (list.nodes[0] > slices_max) {
        log_error("atmosphere: %s: more than %d visibilities", path, (int)slices_max);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) status = clear_open(atmosphere, folder);
    if (status == STATUS_OK && folder_has(folder, "limb.csv")) status = limb_open(atmosphere, folder);
    if (status == STATUS_OK) status = open_ground(atmosphere, folder);
    if (status == STATUS_OK) status = open_slices(atmosphere, folder, &list, visibility_m);
    grid_close(&list);
    return status;
}

/* ---- tables of one shape ------------------------------------------------------------------------ */

/* The first of equal shape shares its number with the others. */
static void number_shapes(Atmosphere *atmosphere)
{
    PathTable *table[(slices_made_max + 1) * AIR_BAND_COUNT + slices_made_max];
    int        count = 0;
    for (int k = 0; k < air_tabled_count; k++) table[count++] = &atmosphere->clear_path[air_tabled[k]];
    for (int s = 0; s < atmosphere->slices; s++) {
        for (int k = 0; k < air_tabled_count; k++) table[count++] = &atmosphere->slice[s].path[air_tabled[k]];
        table[count++] = &atmosphere->slice[s].scattered;
    }
    for (int i = 0; i < count; i++) {
        int first = 0;
        while (first < i && !paths_same_shape(table[first], table[i])) first++;
        table[i]->shape = first;
    }
}

Status atmosphere_open(Atmosphere **out, const char *model) { return atmosphere_open_at(out, model, NAN); }

/* Logs the available models, by their folders. */
static Status no_model(const char *model)
{
    char            folder[1024], path[1400], list[512] = "";
    struct dirent **entry;
    const int count = etc_path(folder, sizeof folder, "atmosphere") ? scandir(folder, &entry, NULL, alphasort) : -1;
    for (int i = 0; i < count; i++) {
        const size_t length = strlen(list);
        snprintf(path, sizeof path, "%s/%s/visibilities.csv", folder, entry[i]->d_name);
        if (access(path, F_OK) == 0)
            snprintf(list + length, sizeof list - length, "%s%s", length ? ", " : "", entry[i]->d_name);
        free(entry[i]);
    }
    if (count >= 0) free(entry);
    log_error("atmosphere: no model %s; there are: %s (weather.atmosphere); etc/atmosphere/README.md is the format",
              model, list);
    return STATUS_BAD_VALUE;
}

/* ---- a set of models by weather ------------------------------------------------------------------ */

typedef struct SetRow {
    char   folder[128];
    double temp_k, vapour_kg_m3;
} SetRow;

typedef struct Nearest {
    double temp_k, vapour_kg_m3, least; /* wanted; the least distance so far */
    char   folder[128];
} Nearest;

static Status take_set_row(void *user, const void *read, const TableRows *rows, int number)
{
    Nearest      *n = user;
    const SetRow *row = read;
    if (strchr(row->folder, '/') || row->folder[0] == '.')
        return table_rows_refuse(rows, number, "folder", "the name of a folder beside this file");
    const double dry = 1e-5; /* of so little vapour a factor changes nothing */
    const double distance = fabs(row->temp_k - n->temp_k) / 5 +
                            fabs(log(fmax(row->vapour_kg_m3, dry) / fmax(n->vapour_kg_m3, dry))) / log(1.2);
    if (distance < n->least) {
        n->least = distance;
        memcpy(n->folder, row->folder, sizeof n->folder);
    }
    return STATUS_OK;
}

Status atmosphere_nearest(char *out, size_t out_size, const char *model, double temp_k, double vapour_kg_m3)
{
    static const TableColumn columns[] = {
        {"folder", .type = TABLE_NAME, TABLE_AT(SetRow, folder)},
        {"air_temp_k", TABLE_DOUBLE, TABLE_AT(SetRow, temp_k), .low = 150, .high = 350},
        {"vapour_g_m3", TABLE_DOUBLE, TABLE_AT(SetRow, vapour_kg_m3), .low = 0, .high = 200, .unit = 1e-3}};
    static const TableFormat format = {
        "atmosphere",    columns,          3, .next = "etc/atmosphere/README.md explains the columns",
        .least_rows = 1, .most_rows = 1000};
    SetRow     row;
    char       path[1024];
    Nearest    nearest = {temp_k, vapour_kg_m3, INFINITY, ""};
    Status     status = STATUS_OK;
    const bool set = strpbrk(model, "/.") && strlen(model) < 900 && folder_has(model, "weathers.csv");
    if (set && !(isfinite(temp_k) && isfinite(vapour_kg_m3))) {
        log_error(
            "atmosphere: %s is a set of airs, of which weather.air_temp_k and weather.humidity_pct choose one: set "
            "weather.air_temp_k",
            model);
        return STATUS_BAD_VALUE;
    }
    if (set) status = atmosphere_file(path, model, "weathers.csv");
    if (set && status == STATUS_OK) status = table_each(&format, path, &row, sizeof row, take_set_row, &nearest);
    if (status != STATUS_OK) return status;
    if (snprintf(out, out_size, "%s%s%s", model, set ? "/" : "", nearest.folder) < (int)out_size) return STATUS_OK;
    log_error("atmosphere: path too long: model=%s", model);
    return STATUS_BAD_VALUE;
}

Status atmosphere_open_at(Atmosphere **out, const char *model, double visibility_m)
{
    char       name[96], folder[512];
    bool       plain = *model && strlen(model) < 64;
    const bool named = strpbrk(model, "/."); /* a folder */
    for (const char *c = model; *c; c++)
        plain = plain && ((*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9') || *c == '_');
    if (!plain && !named) {
        char shown[64];
        text_escape(shown, sizeof shown, model, strlen(model));
        log_error("atmosphere: a model's name is of a-z, 0-9 and _, not '%s'; a folder has a dot or a slash: ./NAME",
                  shown);
        return STATUS_BAD_VALUE;
    }
    if (!named) snprintf(name, sizeof name, "atmosphere/%s", model);
    if (named ? snprintf(folder, sizeof folder, "%s", model) >= (int)sizeof folder
              : !etc_path(folder, sizeof folder, name)) {
        log_error("atmosphere: path too long: model=%s", model);
        return STATUS_BAD_VALUE;
    }
    if (named && access(folder, F_OK) != 0) {
        log_error("atmosphere: there is no folder %s (weather.atmosphere); etc/atmosphere/README.md is the format",
                  model);
        return STATUS_IO;
    }
    if (access(folder, F_OK) != 0) return no_model(model);
    if (named && folder_has(folder, "weathers.csv")) {
        log_error("atmosphere: %s is a set of airs (weathers.csv); name one of its folders", model);
        return STATUS_BAD_VALUE;
    }
    Atmosphere *atmosphere = calloc(1, sizeof *atmosphere);
    if (!atmosphere) {
        log_error("atmosphere: out of memory for model %s", model);
        return STATUS_NO_MEMORY;
    }
    Status status = channels_load();
    if (status == STATUS_OK) status = sun_top_open(atmosphere->sun_top_w_m2);
    if (status == STATUS_OK) status = solar_open(&atmosphere->solar);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        const SpectralBand band = channel_band((ChannelPlace)(SPECTRAL_MWIR + k));
        status = planck_table_seen(&atmosphere->planck[k], &band);
    }
    if (status == STATUS_OK) status = open_model(atmosphere, folder, visibility_m);
    if (status == STATUS_OK && !named) status = atmosphere_vapour_open(atmosphere, model);
    if (status != STATUS_OK) {
        if (status == STATUS_NO_MEMORY) log_error("atmosphere: out of memory for model %s", model);
        else log_error("atmosphere: cannot use model %s: etc/atmosphere/README.md is the format", model);
        atmosphere_close(atmosphere);
        return status;
    }
    number_shapes(atmosphere);
    *out = atmosphere;
    return STATUS_OK;
}

void atmosphere_close(Atmosphere *atmosphere)
{
    if (!atmosphere) return;
    for (int i = 0; i < atmosphere->slices; i++) slice_close(&atmosphere->slice[i]);
    free(atmosphere->slice);
    for (int i = 0; i < AIR_BAND_COUNT; i++) paths_close(&atmosphere->clear_path[i]);
    for (int i = 0; i < 2; i++)
        if (atmosphere->planck[i]) planck_table_destroy(atmosphere->planck[i]);
    grid_close(&atmosphere->temperature);
    grid_close(&atmosphere->phase);
    grid_close(&atmosphere->limb);
    grid_close(&atmosphere->solar);
    atmosphere_vapour_close(atmosphere);
    free(atmosphere);
}

/* ---- tables that hold every combination of their axes' values (full grids) ------------------- */

int interval_of(double *share, const double *ascending, int count, double x)
{
    *share = 0;
    if (count < 2 || !(x > ascending[0])) return 0;
    int low = 0, high = count - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (ascending[middle] <= x) low = middle;
        else high = middle;
    }
    *share = fmin((x - ascending[low]) / (ascending[high] - ascending[low]), 1);
    return low;
}

int axis_from(double *axis, int capacity, const double *values, int count)
{
    int nodes = 0;
    for (int i = 0; i < count; i++) {
        if (i > 0 && values[i] == values[i - 1]) continue;
        int low = 0, high = nodes; /* index of the first that is not below */
        while (low < high) {
            const int middle = (low + high) / 2;
            if (axis[middle] < values[i]) low = middle + 1;
            else high = middle;
        }
        if (low < nodes && axis[low] == values[i]) continue;
        if (nodes == capacity) return -1;
        memmove(axis + low + 1, axis + low, (size_t)(nodes - low) * sizeof *axis);
        axis[low] = values[i];
        nodes++;
    }
    return nodes;
}

static int axis_find(const double *axis, int count, double x)
{
    double    share;
    const int i = interval_of(&share, axis, count, x);
    return count > 1 && axis[i + 1] == x ? i + 1 : i;
}

/* ---- grids ---------------------------------------------------------------------------------- */

static size_t grid_nodes(const Grid *grid)
{
    size_t nodes = 1;
    for (int i = 0; i < grid->axes; i++) nodes *= (size_t)grid->nodes[i];
    return nodes;
}

/* Finds the values of each axis from the numbers of all rows; scratch: room for one a row. */
static Status find_axes(Grid *grid, const TableRows *rows, const double *number, double *scratch)
{
    for (int i = 0; i < grid->axes; i++) {
        for (int row = 0; row < rows->table.rows; row++)
            scratch[row] = number[(size_t)row * (size_t)rows->format->count + (size_t)i];
        grid->axis[i] = calloc(grid_max_nodes, sizeof *grid->axis[i]);
        if (!grid->axis[i]) return STATUS_NO_MEMORY;
        grid->nodes[i] = axis_from(grid->axis[i], grid_max_nodes, scratch, rows->table.rows);
        if (grid->nodes[i] < 0)
            return table_rows_lack(rows, "more than %d values of %s", (int)grid_max_nodes,
                                   rows->format->column[i].name);
    }
    return STATUS_OK;
}

/* Reports the first combination that no row has; the rows present have no duplicates. */
static Status report_missing(const Grid *grid, const TableRows *rows, const bool *seen)
{
    size_t node = 0;
    while (seen[node]) node++;
    char   text[256] = "";
    double at[grid_max_axes];
    for (int i = grid->axes - 1; i >= 0; i--) {
        at[i] = grid->axis[i][node % (size_t)grid->nodes[i]];
        node /= (size_t)grid->nodes[i];
    }
    for (int i = 0; i < grid->axes; i++) {
        const size_t length = strlen(text);
        snprintf(text + length, sizeof text - length, " %s=%g", rows->format->column[i].name, at[i]);
    }
    return table_rows_refuse(rows, rows->table.rows - 1, NULL,
                             "a point is missing:%s (every combination is needed once)", text);
}

/* Puts the values of each row at its node. */
static Status fill_grid(Grid *grid, const TableRows *rows, const double *number, bool *seen)
{
    const size_t count = (size_t)rows->table.rows, values = (size_t)grid->values;
    for (int row = 0; row < rows->table.rows; row++) {
        const double *at = number + (size_t)row * (size_t)rows->format->count;
        size_t        node = 0;
        for (int i = 0; i < grid->axes; i++)
            node = node * (size_t)grid->nodes[i] + (size_t)axis_find(grid->axis[i], grid->nodes[i], at[i]);
        if (node >= count) continue; /* more combinations than rows: one is missing, reported below */
        if (seen[node]) return table_rows_refuse(rows, row, NULL, "this point is there twice");
        seen[node] = true;
        memcpy(grid->value + node * values, at + grid->axes, values * sizeof *at);
    }
    return grid_nodes(grid) > count ? report_missing(grid, rows, seen) : STATUS_OK;
}

TableFormat atmosphere_format(TableColumn *column, const GridColumn *first, int firsts, const GridColumn *then,
                              int thens)
{
    for (int k = 0; k < firsts + thens; k++) {
        const GridColumn *of = k < firsts ? &first[k] : &then[k - firsts];
        column[k] = (TableColumn){of->name, TABLE_DOUBLE, TABLE_AT_NUMBER((size_t)k), .low = of->low, .high = of->high};
    }
    return (TableFormat){"atmosphere", column, firsts + thens, .next = "etc/atmosphere/README.md explains the columns"};
}

Status grid_open(Grid *out, const char *path, const GridColumn *axis, int axes, const GridColumn *value, int values)
{
    TableColumn       column[grid_max_axes + grid_max_values];
    const TableFormat format = atmosphere_format(column, axis, axes, value, values);
    TableRows         rows;
    Status            status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    const size_t count = (size_t)rows.table.rows;
    Grid         grid = {.axes = axes, .values = values, .value = calloc(count * (size_t)values + 1, sizeof(double))};
    double      *number = NULL, *scratch = calloc(count + 1, sizeof *scratch);
    bool        *seen = calloc(count + 1, sizeof *seen);
    if (!grid.value || !scratch || !seen) status = STATUS_NO_MEMORY;
    else if (count == 0) status = table_rows_lack(&rows, "no rows");
    if (status == STATUS_OK) status = table_rows_numbers(&number, &rows);
    if (status == STATUS_OK) status = find_axes(&grid, &rows, number, scratch);
    if (status == STATUS_OK) status = fill_grid(&grid, &rows, number, seen);
    free(number);
    free(scratch);
    free(seen);
    table_rows_close(&rows);
    if (status == STATUS_OK) *out = grid;
    else grid_close(&grid);
    return status;
}

void grid_close(Grid *grid)
{
    for (int i = 0; i < grid_max_axes; i++) free(grid->axis[i]);
    free(grid->value);
    *grid = (Grid){0};
}

void grid_at(double *out, const Grid *grid, const double *at) { grid_some(out, grid, at, 0, 1, grid->values); }

void grid_some(double *out, const Grid *grid, const double *at, int first, int step, int count)
{
    size_t offset[1 << grid_max_axes] = {0};
    double share[1 << grid_max_axes] = {1};
    int    corners = 1;
    for (int i = 0; i < grid->axes; i++) {
        double       t;
        const size_t nodes = (size_t)grid->nodes[i];
        const size_t cell = (size_t)interval_of(&t, grid->axis[i], grid->nodes[i], at[i]);
        const bool   both = t > 0;
        for (int c = 0; c < corners; c++) {
            if (both) {
                offset[c + corners] = offset[c] * nodes + cell + 1;
                share[c + corners] = share[c] * t;
            }
            offset[c] = offset[c] * nodes + cell;
            share[c] *= 1 - t;
        }
        corners <<= both;
    }
    for (int v = 0; v < count; v++) out[v] = 0;
    for (int c = 0; c < corners; c++) {
        const double *value = grid->value + offset[c] * (size_t)grid->values + first;
        for (int v = 0; v < count; v++) out[v] += share[c] * value[v * step];
    }
}
