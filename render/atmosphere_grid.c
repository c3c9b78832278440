/* render/atmosphere_grid.c: tables over a full grid, and tables of paths, which are ragged: a path is no shorter than
 * its ends are apart in height. */
#include "render/atmosphere_private.h"

#include <stdlib.h>

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

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int axis_from(double *axis, int capacity, double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare_doubles);
    int nodes = 0;
    for (int i = 0; i < count; i++) {
        if (nodes && axis[nodes - 1] == values[i]) continue;
        if (nodes == capacity) return -1;
        axis[nodes++] = values[i];
    }
    return nodes;
}

int axis_find(const double *axis, int count, double x)
{
    double share;
    const int i = interval_of(&share, axis, count, x);
    return count > 1 && axis[i + 1] == x ? i + 1 : i;
}

/* ---- grids ---------------------------------------------------------------------------------- */

static Status find_columns(int *at, const Table *table, const GridColumn *column, int count)
{
    for (int i = 0; i < count; i++) {
        at[i] = table_column(table, column[i].name);
        if (at[i] >= 0) continue;
        log_error("atmosphere: %s:%d: column missing: %s", table->path, table->line[0], column[i].name);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

static size_t grid_nodes(const Grid *grid)
{
    size_t nodes = 1;
    for (int i = 0; i < grid->axes; i++) nodes *= (size_t)grid->nodes[i];
    return nodes;
}

/* Where each axis has its values, from the rows. */
static Status find_axes(Grid *grid, const Table *table, const GridColumn *axis, const int *column, double *scratch)
{
    for (int i = 0; i < grid->axes; i++) {
        for (int row = 0; row < table->rows; row++)
            if (table_number(&scratch[row], table, row, column[i], axis[i].low, axis[i].high) != STATUS_OK)
                return STATUS_BAD_VALUE;
        grid->axis[i] = calloc(grid_max_nodes, sizeof *grid->axis[i]);
        if (!grid->axis[i]) return STATUS_NO_MEMORY;
        grid->nodes[i] = axis_from(grid->axis[i], grid_max_nodes, scratch, table->rows);
        if (grid->nodes[i] < 0) {
            log_error("atmosphere: %s: more than %d values of %s", table->path, (int)grid_max_nodes, axis[i].name);
            return STATUS_BAD_VALUE;
        }
    }
    return STATUS_OK;
}

/* The first combination that no row has, named; the rows that there are do not repeat. */
static void say_missing(const Grid *grid, const Table *table, const GridColumn *axis, const bool *seen)
{
    size_t node = 0;
    while (seen[node]) node++;
    char text[256] = "";
    double at[grid_max_axes];
    for (int i = grid->axes - 1; i >= 0; i--) {
        at[i] = grid->axis[i][node % (size_t)grid->nodes[i]];
        node /= (size_t)grid->nodes[i];
    }
    for (int i = 0; i < grid->axes; i++) {
        const size_t length = strlen(text);
        snprintf(text + length, sizeof text - length, " %s=%g", axis[i].name, at[i]);
    }
    log_error("atmosphere: %s:%d: a point is missing:%s (every combination is needed once)", table->path,
              table->line[table->rows], text);
}

Status grid_open(Grid *out, const char *path, const GridColumn *axis, int axes, const GridColumn *value, int values)
{
    Table table = {0};
    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;

    Grid grid = {.axes = axes, .values = values};
    int axis_column[grid_max_axes], value_column[grid_max_values];
    double *scratch = calloc((size_t)table.rows + 1, sizeof *scratch);
    bool *seen = calloc((size_t)table.rows + 1, sizeof *seen);
    status = STATUS_NO_MEMORY;
    if (!scratch || !seen) goto done;
    status = STATUS_BAD_VALUE;
    if (table.rows == 0) {
        log_error("atmosphere: %s:%d: no rows", path, table.line[0]);
        goto done;
    }
    if (find_columns(axis_column, &table, axis, axes) != STATUS_OK ||
        find_columns(value_column, &table, value, values) != STATUS_OK)
        goto done;
    status = find_axes(&grid, &table, axis, axis_column, scratch);
    if (status != STATUS_OK) goto done;
    status = STATUS_BAD_VALUE;
    const size_t nodes = grid_nodes(&grid);
    grid.value = calloc((size_t)table.rows * (size_t)values, sizeof *grid.value);
    if (!grid.value) {
        status = STATUS_NO_MEMORY;
        goto done;
    }
    for (int row = 0; row < table.rows; row++) {
        size_t node = 0;
        for (int i = 0; i < axes; i++) {
            double x;
            if (table_number(&x, &table, row, axis_column[i], axis[i].low, axis[i].high) != STATUS_OK) goto done;
            node = node * (size_t)grid.nodes[i] + (size_t)axis_find(grid.axis[i], grid.nodes[i], x);
        }
        if (node >= (size_t)table.rows) continue; /* more combinations than rows: one is missing, said below */
        if (seen[node]) {
            log_error("atmosphere: %s:%d: this point is there twice", path, table.line[row + 1]);
            goto done;
        }
        seen[node] = true;
        for (int i = 0; i < values; i++)
            if (table_number(&grid.value[node * (size_t)values + (size_t)i], &table, row, value_column[i], value[i].low,
                             value[i].high) != STATUS_OK)
                goto done;
    }
    if (nodes > (size_t)table.rows) {
        say_missing(&grid, &table, axis, seen);
        goto done;
    }
    status = STATUS_OK;
done:
    free(scratch);
    free(seen);
    table_close(&table);
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

void grid_at(double *out, const Grid *grid, const double *at)
{
    size_t offset[1 << grid_max_axes] = {0};
    double share[1 << grid_max_axes] = {1};
    int corners = 1;
    for (int i = 0; i < grid->axes; i++) {
        double t;
        const int cell = interval_of(&t, grid->axis[i], grid->nodes[i], at[i]);
        const int upper = cell + 1 < grid->nodes[i] ? cell + 1 : cell;
        for (int c = 0; c < corners; c++) {
            offset[c + corners] = offset[c] * (size_t)grid->nodes[i] + (size_t)upper;
            share[c + corners] = share[c] * t;
            offset[c] = offset[c] * (size_t)grid->nodes[i] + (size_t)cell;
            share[c] *= 1 - t;
        }
        corners *= 2;
    }
    for (int v = 0; v < grid->values; v++) out[v] = 0;
    for (int c = 0; c < corners; c++) {
        if (share[c] == 0) continue;
        const double *value = grid->value + offset[c] * (size_t)grid->values;
        for (int v = 0; v < grid->values; v++) out[v] += share[c] * value[v];
    }
}

/* ---- paths ---------------------------------------------------------------------------------- */

/* Lagrange's cubic through the four rows around x (fewer at the ends), straight on below the first row. Below the
 * shortest range of all and beyond a pair's longest one: the end's value. */
static int range_stencil(int *row, double *share, const PathTable *table, int pair, double x)
{
    const int first = table->first[pair], count = table->first[pair + 1] - first;
    const double *node = table->ln_range + first;
    x = clamp(x, table->ln_range_low, node[count - 1]);
    int low, points;
    if (count == 1) {
        low = 0;
        points = 1;
    } else if (x < node[0]) {
        low = 0;
        points = 2;
    } else {
        double t;
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

void stencil_at(Stencil *out, const PathTable *table, double observer_m, double target_m, double range_m)
{
    double s, t;
    const int i = interval_of(&s, table->height_m, table->heights, observer_m);
    const int j = interval_of(&t, table->height_m, table->heights, target_m);
    const double x = log(fmax(range_m, 1e-3));
    out->count = 0;
    for (int corner = 0; corner < 4; corner++) {
        const double share = (corner & 1 ? s : 1 - s) * (corner & 2 ? t : 1 - t);
        if (share == 0) continue;
        const int pair = (i + (corner & 1)) * table->heights + j + (corner >> 1);
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
