/* terrain/ground/surface_cells.c: a table of squares of ground, by their place: unknown, of one class, or not proven to
 * be. A square is judged once it has been asked for some times, as proving costs as much as many places do. */
#include "terrain/ground/surface_cells.h"

#include "terrain/ground/landscape_private.h"
#include "terrain/invented/uniform.h"

#include <stdatomic.h>
#include <stdlib.h>

enum { columns = 512, rows = 256, asked_first = 16, together = 256 };
static const double cell_m = 4, farthest_m = 1e8;

/* An entry: from bit 8 on the cell, 28 bits of each index; below, what is known. 0: empty. */
enum { known_mixed = 0x80, known_one = 0xc0 /* and the class */, key_shift = 8, index_bits = 28 };

struct SurfaceCells {
    const Landscape *landscape;
    _Atomic uint64_t entry[rows][columns];
};

SurfaceCells *surface_cells_create(const Landscape *landscape)
{
    SurfaceCells *cells = calloc(1, sizeof *cells);
    if (cells) cells->landscape = landscape;
    return cells;
}

void surface_cells_destroy(SurfaceCells *cells) { free(cells); }

static unsigned judge(const Landscape *landscape, int64_t i, int64_t j)
{
    const Cover        *cover = landscape->cover;
    const UniformSquare square = {(double)i * cell_m, (double)j * cell_m, cell_m};
    const double        x_m = square.x_m + 0.5 * cell_m, y_m = square.y_m + 0.5 * cell_m;
    uint8_t class;
    if (!invented_uniform(&cover->invented, &landscape->elevation, &square)) return known_mixed;
    cover_surfaces(&class, landscape, 1, &x_m, &y_m);
    return known_one + class;
}

/* What is known of the cell. Threads may overtake each other here: all find the same of a cell, and a count that is
 * lost is counted again. */
static unsigned look_up(SurfaceCells *cells, int64_t i, int64_t j)
{
    const uint64_t    mask = (1u << index_bits) - 1;
    const uint64_t    key = (((uint64_t)j & mask) << index_bits | ((uint64_t)i & mask)) << key_shift;
    _Atomic uint64_t *entry = &cells->entry[j & (rows - 1)][i & (columns - 1)];
    const uint64_t    had = atomic_load_explicit(entry, memory_order_relaxed);
    unsigned          known = had >> key_shift == key >> key_shift ? (unsigned)(had & 0xff) : 0;
    if (known >= known_mixed) return known;
    if (++known >= asked_first) known = judge(cells->landscape, i, j);
    atomic_store_explicit(entry, key | known, memory_order_relaxed);
    return known;
}

void surface_cells_at(uint8_t *surface, SurfaceCells *cells, const Landscape *landscape, int count, const double *x_m,
                      const double *y_m)
{
    _Static_assert(SURFACE_COUNT <= 0x100 - known_one, "a class fits in an entry");
    if (!cells || cells->landscape != landscape || !landscape_is_synthetic(landscape)) {
        landscape_surfaces(surface, landscape, count, x_m, y_m);
        return;
    }
    for (int first = 0; first < count; first += together) {
        const int some = count - first < together ? count - first : together;
        double    x[together], y[together];
        uint8_t   found[together];
        int       place[together], left = 0;
        int64_t   i = 0, j = 0;
        unsigned  known = 0;
        for (int k = first; k < first + some; k++) {
            if (fabs(x_m[k]) < farthest_m && fabs(y_m[k]) < farthest_m) {
                const int64_t at_i = (int64_t)floor(x_m[k] * (1 / cell_m)),
                              at_j = (int64_t)floor(y_m[k] * (1 / cell_m));
                if (!known || known < known_mixed || at_i != i || at_j != j)
                    i = at_i, j = at_j, known = look_up(cells, i, j);
                if (known >= known_one) {
                    surface[k] = (uint8_t)(known - known_one);
                    continue;
                }
            }
            place[left] = k, x[left] = x_m[k], y[left++] = y_m[k];
        }
        cover_surfaces(found, landscape, left, x, y);
        for (int k = 0; k < left; k++) surface[place[k]] = found[k];
    }
    cover_lay_over(surface, landscape, count, x_m, y_m);
}
