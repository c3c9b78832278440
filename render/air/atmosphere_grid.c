/* render/air/atmosphere_grid.c: tables that hold every combination of their axes' values (full grids). */
#include "render/air/atmosphere_private.h"

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

/* Finds the values of each axis from the rows. */
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

/* Reports the first combination that no row has; the rows present have no duplicates. */
static void report_missing(const Grid *grid, const Table *table, const GridColumn *axis, const bool *seen)
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
        if (node >= (size_t)table.rows) continue; /* more combinations than rows: one is missing, reported below */
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
        report_missing(&grid, &table, axis, seen);
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

void grid_at(double *out, const Grid *grid, const double *at) { grid_some(out, grid, at, 0, 1, grid->values); }

void grid_some(double *out, const Grid *grid, const double *at, int first, int step, int count)
{
    size_t offset[1 << grid_max_axes] = {0};
    double share[1 << grid_max_axes] = {1};
    int corners = 1;
    for (int i = 0; i < grid->axes; i++) {
        double t;
        const size_t nodes = (size_t)grid->nodes[i];
        const size_t cell = (size_t)interval_of(&t, grid->axis[i], grid->nodes[i], at[i]);
        const bool both = t > 0;
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
