/* terrain/landscape/nearest_fix.c: spatial index of points, a hash of square cells. Deterministic: buckets keep the
 * order of the points. */
#include "terrain/landscape/landscape_private.h"

#include <stdlib.h>

static uint32_t bucket_of(const NearGrid *grid, int64_t ci, int64_t cj)
{
    return (uint32_t)landscape_hash(0, ci, cj) & grid->mask;
}

Status near_grid_create(NearGrid *out, double cell_m, int count, const double *x_m, const double *y_m, size_t stride)
{
    NearGrid grid = {.cell_m = cell_m, .count = count, .mask = 63};
    while (grid.mask < (uint32_t)count) grid.mask = 2 * grid.mask + 1;
    grid.start = calloc((size_t)grid.mask + 2, sizeof *grid.start);
    grid.item = calloc((size_t)count + 1, sizeof *grid.item);
    uint32_t *bucket = calloc((size_t)count + 1, sizeof *bucket);
    if (!grid.start || !grid.item || !bucket) {
        free(bucket);
        near_grid_destroy(&grid);
        return STATUS_NO_MEMORY;
    }

    for (int n = 0; n < count; n++) {
        const double x = *(const double *)((const char *)x_m + (size_t)n * stride);
        const double y = *(const double *)((const char *)y_m + (size_t)n * stride);
        bucket[n] = bucket_of(&grid, near_grid_cell(&grid, x), near_grid_cell(&grid, y));
        grid.start[bucket[n] + 1]++;
    }
    for (uint32_t b = 0; b <= grid.mask; b++) grid.start[b + 1] += grid.start[b];
    for (int n = count - 1; n >= 0; n--) grid.item[--grid.start[bucket[n] + 1]] = n;
    /* counting down left each bucket's start one place to the right */
    for (uint32_t b = 0; b <= grid.mask; b++) grid.start[b] = grid.start[b + 1];
    grid.start[grid.mask + 1] = count;
    free(bucket);
    *out = grid;
    return STATUS_OK;
}

void near_grid_destroy(NearGrid *grid)
{
    free(grid->start);
    free(grid->item);
    *grid = (NearGrid){0};
}

void near_grid_bucket(const NearGrid *grid, int64_t ci, int64_t cj, int *first, int *end)
{
    *first = *end = 0;
    if (!grid->count) return;
    const uint32_t b = bucket_of(grid, ci, cj);
    *first = grid->start[b];
    *end = grid->start[b + 1];
}
