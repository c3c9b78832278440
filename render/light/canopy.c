/* render/light/canopy.c: leaf area and heights of the woods on a grid, and the light that they leave. */
#include "render/light/canopy.h"

#include <stdlib.h>

static const double cell_m = 8;
static const double leaf_area_step = 1.0 / 16, top_step_m = 0.25;

typedef struct CanopyCell {
    uint8_t leaf_area;   /* of leaf_area_step */
    uint8_t top, base;   /* of top_step_m, above the ground */
    uint8_t spare;
} CanopyCell;

enum { gap_steps = 512 };
static const double gap_most = 16; /* 2 E3 of it is 1e-8 */

struct Canopy {
    int         nx, ny;
    double      x0_m, y0_m;
    CanopyCell *cell;
    float       gap[gap_steps + 2];
};

/* ---- closed form ------------------------------------------------------------------------------ */

/* 2 E3(x) = 2 int_0^1 mu exp(-x / mu) d mu, by the midpoint rule in u = mu^2. */
double canopy_gap(double x)
{
    enum { steps = 400 };
    double sum = 0;
    if (!(x > 0)) return 1;
    for (int k = 0; k < steps; k++) {
        const double mu = sqrt((k + 0.5) / steps);
        sum += exp(-x / mu);
    }
    return sum / steps;
}

static double gap_at(const Canopy *c, double x)
{
    const double at = clamp(x / gap_most * gap_steps, 0, gap_steps - 1e-6);
    const int    i = (int)at;
    return (double)c->gap[i] + (at - i) * ((double)c->gap[i + 1] - (double)c->gap[i]);
}

/* ---- the grid --------------------------------------------------------------------------------- */

typedef struct Sum {
    float area;        /* m2 of leaves */
    float top, base;   /* weighted by it */
} Sum;

/* A plant's leaves go to the cells under its crown, evenly. */
static void add_plant(Sum *sum, const Canopy *c, const Woods *woods, const Plants *plants, const Plant *plant, bool leaves)
{
    const PlantShape *shape = &plants->shape[plant->kind][0];
    const double      height_m = plant_height_m(plant), wide = plant->width / 128.0;
    const double      area = (double)shape->leaf_area * height_m * height_m * wide, r = (double)shape->crown_radius * height_m * wide;
    const double      x = (double)plant->p_m[0] + woods->origin_enu[0] - c->x0_m, y = (double)plant->p_m[1] + woods->origin_enu[1] - c->y0_m;
    if (!leaves && plant_is_deciduous((PlantKind)plant->kind)) return;
    const int i0 = (int)clamp(floor((x - r) / cell_m), 0, c->nx - 1), i1 = (int)clamp(floor((x + r) / cell_m), 0, c->nx - 1);
    const int j0 = (int)clamp(floor((y - r) / cell_m), 0, c->ny - 1), j1 = (int)clamp(floor((y + r) / cell_m), 0, c->ny - 1);
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            const double across = fmin(x + r, (i + 1) * cell_m) - fmax(x - r, i * cell_m);
            const double along = fmin(y + r, (j + 1) * cell_m) - fmax(y - r, j * cell_m);
            const double share = r > 0 ? fmax(across, 0) * fmax(along, 0) / (4 * r * r) : 1;
            Sum         *to = &sum[(size_t)j * (size_t)c->nx + (size_t)i];
            to->area += (float)(share * area);
            to->top += (float)(share * area * height_m);
            to->base += (float)(share * area * height_m * (double)shape->crown_low);
        }
}

Status canopy_create(Canopy **out, const Woods *woods, const Plants *plants, bool leaves, Pool *pool)
{
    Canopy *c = calloc(1, sizeof *c);
    (void)pool;
    if (!c) return STATUS_NO_MEMORY;
    const int per_square = (int)(woods_square_m / cell_m);
    c->nx = woods->nx * per_square, c->ny = woods->ny * per_square;
    c->x0_m = woods->origin_enu[0], c->y0_m = woods->origin_enu[1];
    const size_t cells = (size_t)c->nx * (size_t)c->ny;
    Sum         *sum = calloc(cells + 1, sizeof *sum);
    c->cell = calloc(cells + 1, sizeof *c->cell);
    if (!sum || !c->cell) {
        free(sum);
        canopy_destroy(c);
        return STATUS_NO_MEMORY;
    }
    for (int k = 0; k < gap_steps + 2; k++) c->gap[k] = (float)canopy_gap(gap_most * k / gap_steps);
    for (int k = 0; k < woods->count && cells > 0; k++) add_plant(sum, c, woods, plants, &woods->plant[k], leaves);
    for (size_t n = 0; n < cells; n++) {
        if (!(sum[n].area > 0)) continue;
        c->cell[n].leaf_area = (uint8_t)fmin(rint((double)sum[n].area / (cell_m * cell_m) / leaf_area_step), 255);
        c->cell[n].top = (uint8_t)fmin(rint((double)(sum[n].top / sum[n].area) / top_step_m), 255);
        c->cell[n].base = (uint8_t)fmin(rint((double)(sum[n].base / sum[n].area) / top_step_m), 255);
    }
    free(sum);
    *out = c;
    return STATUS_OK;
}

void canopy_destroy(Canopy *canopy)
{
    if (!canopy) return;
    free(canopy->cell);
    free(canopy);
}

static double above_cell(const CanopyCell *cell, double height_m)
{
    const double top = cell->top * top_step_m, base = cell->base * top_step_m;
    if (cell->leaf_area == 0 || height_m >= top) return 0;
    return leaf_area_step * cell->leaf_area * (height_m <= base ? 1 : (top - height_m) / (top - base));
}

/* Straight between the middles of cells. */
double canopy_leaf_area_above(const Canopy *c, double x_m, double y_m, double height_m)
{
    const double x = (x_m - c->x0_m) / cell_m - 0.5, y = (y_m - c->y0_m) / cell_m - 0.5, i = floor(x), j = floor(y);
    double       sum = 0;
    if (!(i >= 0 && j >= 0 && i < c->nx - 1 && j < c->ny - 1)) return 0;
    for (int k = 0; k < 4; k++) {
        const double share = (k & 1 ? x - i : 1 - (x - i)) * (k & 2 ? y - j : 1 - (y - j));
        sum += share * above_cell(&c->cell[((size_t)j + (size_t)(k >> 1)) * (size_t)c->nx + (size_t)i + (size_t)(k & 1)], height_m);
    }
    return sum;
}

/* ---- hits ------------------------------------------------------------------------------------- */

/* sqrt(1 - w) of a broad leaf, the same for all of a stand. */
static void leaf_shares(double share[optical_channel_count], const Materials *materials)
{
    const Material *leaf = &materials->material[materials->plant[PLANT_SESSILE_OAK][PLANT_LEAF]];
    for (int c = 0; c < optical_channel_count; c++)
        share[c] = sqrt(fmax(1 - (double)leaf->rho[c] - (double)leaf->tau[c], 0));
}

void canopy_open(float (*factor)[hits_capacity], const Canopy *canopy, const Landscape *landscape,
                 const Materials *materials, const Hits *hits, unsigned channels)
{
    double share[optical_channel_count];
    leaf_shares(share, materials);
    for (int i = 0; i < hits->count; i++) {
        if (!(hits->range_m[i] < INFINITY)) continue;
        const double x_m = hits->p_enu[0][i], y_m = hits->p_enu[1][i];
        const bool   plant = hits->kind[i] == hit_plant;
        double       height_m = 0;
        if (hits->kind[i] != hit_ground && landscape)
            height_m = hits->p_enu[2][i] - elevation_height(&landscape->elevation, x_m, y_m, NULL);
        const double area = canopy_leaf_area_above(canopy, x_m, y_m, isfinite(height_m) ? height_m : 0);
        if (!(area > 0) && !plant) continue;
        const double own = plant ? -log(fmax((double)hits->sky[i], 1e-3)) : 0;
        for (int c = 0; c < optical_channel_count; c++) {
            if (!(channels >> c & 1)) continue;
            const double stand = gap_at(canopy, 0.5 * share[c] * area);
            factor[c][i] *= (float)fmin(stand, exp(-share[c] * own));
        }
    }
}
