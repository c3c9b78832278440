/* terrain/landscape/take_apart_components.c: connected components of a window's cells. */
#include "terrain/landscape/take_apart_private.h"

#include <stdlib.h>

static int32_t root_of(int32_t *parent, int32_t c)
{
    while (parent[c] != c) parent[c] = parent[parent[c]], c = parent[c];
    return c;
}

Status take_apart_components(int32_t **label, int32_t **area, int nx, int ny, JoinCells *joins, const void *user)
{
    const size_t n = (size_t)nx * (size_t)ny;
    int32_t *parent = malloc(n * sizeof *parent), *count = calloc(n, sizeof *count);
    *label = NULL, *area = NULL;
    if (!parent || !count) {
        free(parent), free(count);
        return STATUS_NO_MEMORY;
    }
    for (size_t c = 0; c < n; c++) {
        parent[c] = (int32_t)c;
        const bool west = c % (size_t)nx && joins(user, c, c - 1);
        const bool south = c >= (size_t)nx && joins(user, c, c - (size_t)nx);
        if (west) parent[c] = root_of(parent, (int32_t)c - 1);
        if (!south) continue;
        /* the least cell is the root: the labels do not depend on the order of joining */
        const int32_t a = root_of(parent, (int32_t)c), b = root_of(parent, (int32_t)(c - (size_t)nx));
        if (a < b) parent[b] = a;
        else parent[a] = b;
    }
    for (size_t c = 0; c < n; c++) {
        parent[c] = parent[parent[c]];
        count[parent[c]]++;
    }
    *label = parent, *area = count;
    return STATUS_OK;
}
