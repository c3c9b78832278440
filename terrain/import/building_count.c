/* terrain/import/building_count.c: connected parts of building cells: labels of one row, joined where the next row
 * joins them. */
#include "terrain/import/building_count.h"

#include "terrain/landscape/take_apart.h"

#include <stdlib.h>

static int root_of(int *parent, int label)
{
    while (parent[label] != label) label = parent[label] = parent[parent[label]];
    return label;
}

Status building_count_row(BuildingCount *b, int nx, const uint8_t *kind)
{
    const size_t most = 2 * (size_t)nx + 2;
    if (!b->label) {
        b->label   = calloc((size_t)nx, sizeof *b->label);
        b->parent  = malloc(most * sizeof *b->parent);
        b->compact = malloc(most * sizeof *b->compact);
        if (!b->label || !b->parent || !b->compact) return STATUS_NO_MEMORY;
    }
    int labels = b->labels;
    for (int k = 0; k <= labels; k++) b->parent[k] = k;
    for (int i = 0; i < nx; i++) {
        const int west = i > 0 ? b->label[i - 1] : 0, south = b->label[i];
        if (kind[i] != CELL_BUILDING) b->label[i] = 0;
        else if (west && south) {
            const int a = root_of(b->parent, west), c = root_of(b->parent, south);
            b->count -= a != c;
            b->parent[a] = c;
        } else if (west || south) b->label[i] = west + south;
        else {
            b->label[i] = ++labels;
            b->parent[labels] = labels;
            b->count++;
        }
    }
    memset(b->compact, 0, ((size_t)labels + 1) * sizeof *b->compact);
    b->labels = 0;
    for (int i = 0; i < nx; i++) {
        if (!b->label[i]) continue;
        int *to = &b->compact[root_of(b->parent, b->label[i])];
        if (*to == 0) *to = ++b->labels;
        b->label[i] = *to;
    }
    return STATUS_OK;
}

void building_count_free(BuildingCount *b)
{
    free(b->label);
    free(b->parent);
    free(b->compact);
    *b = (BuildingCount){0};
}
