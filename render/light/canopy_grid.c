/* render/light/canopy_grid.c: leaf area and heights of plants on a grid: of the woods, and of pages when they are asked
 * for. */
#include "render/light/canopy_private.h"

#include <pthread.h>
#include <stdlib.h>

/* ---- a grid ----------------------------------------------------------------------------------- */

typedef struct Sum {
    float area;      /* m2 of leaves */
    float hides;     /* canopy_plant_area of them */
    float spread;    /* weighted by it, inversely */
    float shadow;    /* weighted by it */
    float top, base; /* weighted by area */
} Sum;

/* A plant's leaves go to the cells under its crown, evenly. */
static void add_plant(Sum *sum, const CanopyGrid *c, const double origin_enu[3], const Plants *plants,
                      const Plant *plant, bool leaves)
{
    const PlantShape *shape = &plants->shape[plant->kind][plant_whole];
    const double      height_m = plant_height_m(plant), wide = plant->width / 128.0;
    const double      area = (double)shape->leaf_area * height_m * height_m * wide;
    const double      r = (double)shape->crown_radius * height_m * wide;
    const PlantArea   shade = canopy_plant_area(plants, plant->kind, height_m, wide);
    const double      x = (double)plant->p_m[0] + origin_enu[0] - c->x0_m;
    const double      y = (double)plant->p_m[1] + origin_enu[1] - c->y0_m;
    if (!leaves && plant_is_deciduous((PlantKind)plant->kind)) return;
    const int i0 = (int)clamp(floor((x - r) / canopy_cell_m), 0, c->nx - 1),
              i1 = (int)clamp(floor((x + r) / canopy_cell_m), 0, c->nx - 1);
    const int j0 = (int)clamp(floor((y - r) / canopy_cell_m), 0, c->ny - 1),
              j1 = (int)clamp(floor((y + r) / canopy_cell_m), 0, c->ny - 1);
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            const double across = fmin(x + r, (i + 1) * canopy_cell_m) - fmax(x - r, i * canopy_cell_m);
            const double along = fmin(y + r, (j + 1) * canopy_cell_m) - fmax(y - r, j * canopy_cell_m);
            const double share = r > 0 ? fmax(across, 0) * fmax(along, 0) / (4 * r * r) : 1;
            Sum         *to = &sum[(size_t)j * (size_t)c->nx + (size_t)i];
            to->area += (float)(share * area);
            to->hides += (float)(share * shade.hides);
            to->spread += (float)(share * shade.hides / shade.spread);
            to->shadow += (float)(share * shade.hides * shade.shadow);
            to->top += (float)(share * area * height_m);
            to->base += (float)(share * area * height_m * (double)shape->crown_low);
        }
}

Status canopy_fill_grid(const CanopyGrid *grid, const double origin_enu[3], const Plant *plant, int count,
                        const Plants *plants, bool leaves)
{
    const size_t cells = (size_t)grid->nx * (size_t)grid->ny;
    Sum         *sum = calloc(cells + 1, sizeof *sum);
    if (!sum) return STATUS_NO_MEMORY;
    for (int k = 0; k < count && cells > 0; k++) add_plant(sum, grid, origin_enu, plants, &plant[k], leaves);
    for (size_t n = 0; n < cells; n++) {
        CanopyCell *cell = &grid->cell[n];
        if (!(sum[n].area > 0)) continue;
        const double index = (double)sum[n].hides / (canopy_cell_m * canopy_cell_m);
        const double clumped = canopy_apart(index, (double)sum[n].hides / (double)sum[n].spread,
                                            (double)sum[n].shadow / (double)sum[n].hides) *
                               (canopy_cell_m * canopy_cell_m) / (double)sum[n].area;
        cell->leaf_area =
            (uint8_t)fmin(rint((double)sum[n].area / (canopy_cell_m * canopy_cell_m) / leaf_area_step), 255);
        cell->clumped = (uint8_t)clamp(rint(clumped / clumped_step), 1, 255);
        cell->top = (uint8_t)fmin(rint((double)(sum[n].top / sum[n].area) / top_step_m), 255);
        cell->base = (uint8_t)fmin(rint((double)(sum[n].base / sum[n].area) / top_step_m), 255);
    }
    free(sum);
    return STATUS_OK;
}

/* ---- pages ------------------------------------------------------------------------------------ */

enum { page_side = 128 };

struct CanopyPages {
    const Forest   *forest;
    bool            leaves;
    int             count;
    CanopyCell    **cell; /* [count] of page_side squared, atomic; NULL: not made */
    pthread_mutex_t lock; /* of making */
};

Status canopy_see_pages(Canopy *c, const Forest *forest, bool leaves)
{
    const Woods *woods = forest_woods(forest);
    const int    count = woods->pages_x * woods->pages_y;
    _Static_assert(page_side * 8 == 1024, "cells of a page");
    if (count == 0 || !(forest_config(forest).far_m > 0)) return STATUS_OK;
    CanopyPages *pages = calloc(1, sizeof *pages);
    CanopyCell **cell = calloc((size_t)count, sizeof *cell);
    if (!pages || !cell) {
        free(pages), free(cell);
        return STATUS_NO_MEMORY;
    }
    pages->forest = forest, pages->leaves = leaves, pages->count = count, pages->cell = cell;
    pthread_mutex_init(&pages->lock, NULL);
    c->pages = pages;
    return STATUS_OK;
}

void canopy_pages_destroy(CanopyPages *pages)
{
    if (!pages) return;
    for (int k = 0; k < pages->count; k++) free(pages->cell[k]);
    pthread_mutex_destroy(&pages->lock);
    free(pages->cell);
    free(pages);
}

static CanopyCell *make(const CanopyPages *pages, int page)
{
    const WoodsPage *of;
    CanopyCell      *cell = calloc((size_t)page_side * page_side, sizeof *cell);
    if (!cell || forest_page_plants(&of, pages->forest, page) != STATUS_OK) {
        free(cell);
        return NULL;
    }
    const CanopyGrid grid = {cell, page_side, page_side, of->origin_enu[0], of->origin_enu[1]};
    if (canopy_fill_grid(&grid, of->origin_enu, of->plant, of->count, forest_plants(pages->forest), pages->leaves) ==
        STATUS_OK)
        return cell;
    free(cell);
    return NULL;
}

static const CanopyCell *cells_of_page(CanopyPages *pages, int page)
{
    CanopyCell *cell = __atomic_load_n(&pages->cell[page], __ATOMIC_ACQUIRE);
    if (cell) return cell;
    pthread_mutex_lock(&pages->lock);
    cell = pages->cell[page];
    if (!cell && (cell = make(pages, page))) __atomic_store_n(&pages->cell[page], cell, __ATOMIC_RELEASE);
    pthread_mutex_unlock(&pages->lock);
    return cell;
}

const CanopyCell *canopy_page_cell(const Canopy *c, double i, double j)
{
    const double x_m = c->x0_m + (i + 0.5) * canopy_cell_m, y_m = c->y0_m + (j + 0.5) * canopy_cell_m;
    const Woods *woods = forest_woods(c->pages->forest);
    const int    page = woods_page_at(woods, x_m, y_m);
    if (page < 0 || woods_is_planted(woods, x_m, y_m)) return NULL;
    const CanopyCell *cell = cells_of_page(c->pages, page);
    const int         a = (int)floor((x_m - woods->pages_enu[0]) / canopy_cell_m) % page_side,
              b = (int)floor((y_m - woods->pages_enu[1]) / canopy_cell_m) % page_side;
    return cell ? &cell[b * page_side + a] : NULL;
}

double canopy_pages_reach_m(const Canopy *c) { return c->pages ? forest_config(c->pages->forest).far_m : 0; }
