/* render/light/canopy.c: leaf area and heights of the woods on a grid, and the light among them. */
#include "render/light/canopy.h"

#include <stdlib.h>

static const double cell_m = 8;
static const double leaf_area_step = 1.0 / 16, top_step_m = 0.25;

typedef struct CanopyCell {
    uint8_t leaf_area; /* of leaf_area_step */
    uint8_t top, base; /* of top_step_m, above the ground */
    uint8_t spare;
} CanopyCell;

enum { gap_steps = 512 };
static const double gap_most = 16; /* 2 E3 of it is 1e-8 */

struct Canopy {
    int         nx, ny;
    double      x0_m, y0_m;
    CanopyCell *cell;
    float       gap[gap_steps + 2];
    double      open_up, open_down;               /* of a leaf or branch, the mean of all */
    double      scattered[optical_channel_count]; /* w */
};

/* ---- closed form ------------------------------------------------------------------------------ */

/* 2 E3(x) = 2 int_0^1 mu exp(-x / mu) d mu, by the midpoint rule in u = mu^2. */
double canopy_gap(double x)
{
    enum { steps = 1000 };
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
    float area;      /* m2 of leaves */
    float top, base; /* weighted by it */
} Sum;

/* A plant's leaves go to the cells under its crown, evenly. */
static void add_plant(Sum *sum, const Canopy *c, const Woods *woods, const Plants *plants, const Plant *plant,
                      bool leaves)
{
    const PlantShape *shape = &plants->shape[plant->kind][plant_whole];
    const double      height_m = plant_height_m(plant), wide = plant->width / 128.0;
    const double      area = (double)shape->leaf_area * height_m * height_m * wide;
    const double      r = (double)shape->crown_radius * height_m * wide;
    const double      x = (double)plant->p_m[0] + woods->origin_enu[0] - c->x0_m;
    const double      y = (double)plant->p_m[1] + woods->origin_enu[1] - c->y0_m;
    if (!leaves && plant_is_deciduous((PlantKind)plant->kind)) return;
    const int i0 = (int)clamp(floor((x - r) / cell_m), 0, c->nx - 1),
              i1 = (int)clamp(floor((x + r) / cell_m), 0, c->nx - 1);
    const int j0 = (int)clamp(floor((y - r) / cell_m), 0, c->ny - 1),
              j1 = (int)clamp(floor((y + r) / cell_m), 0, c->ny - 1);
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

/* Areas of a prototype that light meets on its way, half of the leaves' and a quarter of the branches', each as far as
 * it is open: what lies deep in the crown neither gets nor gives much. open_up, open_down: their sums over these areas.
 */
typedef struct Crown {
    double leaf, bark, open_up, open_down;
} Crown;

static double quad_area(const PlantQuad *q)
{
    double u[3], v[3], n[3];
    for (int x = 0; x < 3; x++) {
        u[x] = (double)(q->corner[2][x] - q->corner[0][x]), v[x] = (double)(q->corner[3][x] - q->corner[1][x]);
    }
    v3_cross(n, u, v);
    return 0.5 * v3_length(n);
}

static Crown crown_of(const Plants *plants, PlantKind kind, bool leaves)
{
    const PlantShape *s = &plants->shape[kind][plant_whole];
    Crown             crown = {0};
    for (int k = 0; k < s->quads; k++) {
        const PlantQuad *q = &s->quad[k];
        const bool       leaf = q->organ == PLANT_LEAF;
        const double     part = leaf ? 0.5 * (double)plants->outline_area[kind][q->outline] : 0.25;
        const double     seen = quad_area(q) * part * 0.5 * ((double)q->open_up + (double)q->open_down);
        if (leaf && !leaves && plant_is_deciduous(kind)) continue;
        *(leaf ? &crown.leaf : &crown.bark) += seen;
        crown.open_up += seen * (double)q->open_up, crown.open_down += seen * (double)q->open_down;
    }
    return crown;
}

/* Means over the woods. */
static void average(Canopy *c, const Woods *woods, const Plants *plants, const Materials *materials, bool leaves)
{
    double seen = 0;
    for (int kind = 0; kind < PLANT_STANDING; kind++) {
        const Crown     crown = crown_of(plants, (PlantKind)kind, leaves);
        const double    count = woods->by_kind[kind];
        const Material *leaf = &materials->material[materials->plant[kind][PLANT_LEAF]];
        const Material *bark = &materials->material[materials->plant[kind][PLANT_BARK]];
        seen += count * (crown.leaf + crown.bark);
        c->open_up += count * crown.open_up, c->open_down += count * crown.open_down;
        for (int k = 0; k < optical_channel_count; k++)
            c->scattered[k] += count * (crown.leaf * ((double)leaf->rho[k] + (double)leaf->tau[k]) +
                                        crown.bark * (double)bark->rho[k]);
    }
    if (!(seen > 0)) return;
    c->open_up /= seen, c->open_down /= seen;
    for (int k = 0; k < optical_channel_count; k++) c->scattered[k] = fmin(c->scattered[k] / seen, 1);
}

/* ---- between runs ----------------------------------------------------------------------------- */

_Static_assert(sizeof(CanopyCell) == 4 && sizeof(Plant) == 20, "no padding: the octets are the numbers");

static size_t cells_of(const Canopy *c) { return (size_t)c->nx * (size_t)c->ny; }

void canopy_kept_values(Kept *kept, void *canopy)
{
    Canopy *c = canopy;
    kept_pass(kept, c->cell, cells_of(c) * sizeof *c->cell);
    kept_floats(kept, c->gap, gap_steps + 2);
    kept_doubles(kept, &c->open_up, 1);
    kept_doubles(kept, &c->open_down, 1);
    kept_doubles(kept, c->scattered, optical_channel_count);
}

void canopy_key_add_plants(CacheKey *key, const Materials *materials)
{
    cache_key_add(key, materials->plant, sizeof materials->plant);
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int organ = 0; organ < PLANT_ORGANS; organ++)
            cache_key_add(key, &materials->material[materials->plant[kind][organ]], sizeof(Material));
}

/* Everything that the canopy follows from. */
static CacheKey key_of(const Canopy *c, const Woods *woods, const Materials *materials, bool leaves,
                       const PlantsKept *kept)
{
    const int32_t whole[] = {c->nx, c->ny, woods->count, leaves};
    CacheKey      key = cache_key("canopy");
    cache_key_add(&key, kept->name, strlen(kept->name));
    cache_key_add(&key, whole, sizeof whole);
    cache_key_add(&key, woods->origin_enu, sizeof woods->origin_enu);
    cache_key_add(&key, woods->by_kind, sizeof woods->by_kind);
    cache_key_add(&key, woods->plant, (size_t)woods->count * sizeof *woods->plant);
    canopy_key_add_plants(&key, materials);
    return key;
}

/* ---- all of it -------------------------------------------------------------------------------- */

Status canopy_create_bare(Canopy **out, const Woods *woods)
{
    Canopy *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    const int per_square = (int)(woods_square_m / cell_m);
    c->nx = woods->nx * per_square, c->ny = woods->ny * per_square;
    c->x0_m = woods->origin_enu[0], c->y0_m = woods->origin_enu[1];
    c->cell = calloc(cells_of(c) + 1, sizeof *c->cell);
    if (!c->cell) {
        free(c);
        return STATUS_NO_MEMORY;
    }
    *out = c;
    return STATUS_OK;
}

static Status fill(Canopy *c, const Woods *woods, const Plants *plants, const Materials *materials, bool leaves)
{
    const size_t cells = cells_of(c);
    Sum         *sum = calloc(cells + 1, sizeof *sum);
    if (!sum) return STATUS_NO_MEMORY;
    for (int k = 0; k < gap_steps + 2; k++) c->gap[k] = (float)canopy_gap(gap_most * k / gap_steps);
    for (int k = 0; k < woods->count && cells > 0; k++) add_plant(sum, c, woods, plants, &woods->plant[k], leaves);
    average(c, woods, plants, materials, leaves);
    for (size_t n = 0; n < cells; n++) {
        if (!(sum[n].area > 0)) continue;
        c->cell[n].leaf_area = (uint8_t)fmin(rint((double)sum[n].area / (cell_m * cell_m) / leaf_area_step), 255);
        c->cell[n].top = (uint8_t)fmin(rint((double)(sum[n].top / sum[n].area) / top_step_m), 255);
        c->cell[n].base = (uint8_t)fmin(rint((double)(sum[n].base / sum[n].area) / top_step_m), 255);
    }
    free(sum);
    return STATUS_OK;
}

Status canopy_create(Canopy **out, const Woods *woods, const Plants *plants, const Materials *materials, bool leaves)
{
    return canopy_create_kept(out, woods, plants, materials, leaves, &(PlantsKept){NULL, ""});
}

Status canopy_create_kept(Canopy **out, const Woods *woods, const Plants *plants, const Materials *materials,
                          bool leaves, const PlantsKept *kept)
{
    Canopy  *c = NULL;
    CacheKey key = {.digest = NULL};
    Status   status = canopy_create_bare(&c, woods);
    if (status != STATUS_OK) return status;
    if (kept->cache) key = key_of(c, woods, materials, leaves, kept);
    if (!kept->cache || !kept_fetch(canopy_kept_values, c, kept->cache, &key)) {
        memset(c->cell, 0, cells_of(c) * sizeof *c->cell);
        c->open_up = c->open_down = 0;
        memset(c->scattered, 0, sizeof c->scattered);
        status = fill(c, woods, plants, materials, leaves);
        if (status == STATUS_OK) kept_keep(canopy_kept_values, c, kept->cache, &key);
    }
    if (status == STATUS_OK) *out = c;
    else canopy_destroy(c);
    return status;
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
        const size_t cell = ((size_t)j + (size_t)(k >> 1)) * (size_t)c->nx + (size_t)i + (size_t)(k & 1);
        sum += share * above_cell(&c->cell[cell], height_m);
    }
    return sum;
}

void canopy_stand(CanopyStand *out, const Canopy *c, double x_m, double y_m)
{
    const double x = floor((x_m - c->x0_m) / cell_m), y = floor((y_m - c->y0_m) / cell_m);
    *out = (CanopyStand){.open = 1};
    if (!(x >= 0 && y >= 0 && x < c->nx && y < c->ny)) return;
    const CanopyCell *cell = &c->cell[(size_t)y * (size_t)c->nx + (size_t)x];
    if (cell->leaf_area == 0) return;
    *out = (CanopyStand){leaf_area_step * cell->leaf_area, cell->base * top_step_m, cell->top * top_step_m,
                         gap_at(c, 0.5 * leaf_area_step * cell->leaf_area)};
}

/* ---- hits ------------------------------------------------------------------------------------- */

bool canopy_place(CanopyPlace *out, const Canopy *c, double x_m, double y_m, double height_m, double sin_sun)
{
    const double all = canopy_leaf_area_above(c, x_m, y_m, 0);
    const double above = height_m > 0 ? canopy_leaf_area_above(c, x_m, y_m, height_m) : all;
    const double slant = 0.5 / fmax(sin_sun, 0.05);
    if (!(all > 0)) {
        *out = (CanopyPlace){1, 1, 1, 1, 1};
        return false;
    }
    *out = (CanopyPlace){.up = gap_at(c, 0.5 * above),
                         .down = gap_at(c, 0.5 * fmax(all - above, 0)),
                         .up_from_ground = gap_at(c, 0.5 * all),
                         .sun_here = exp(-slant * above),
                         .sun_on_ground = exp(-slant * all)};
    return true;
}

void canopy_place_of_plant(CanopyPlace *p, const Canopy *c)
{
    p->up = fmin(c->open_up, p->up), p->down = fmin(c->open_down, p->down), p->sun_here = fmin(c->open_up, p->sun_here);
}

/* half: of what a surface scatters. */
static inline double exitance(double *on_ground_w_m2, const Canopy *c, const CanopyPlace *p, double half,
                              double sun_w_m2, double sky_w_m2, double sin_sun, double ground_rho)
{
    const double up = fmin(c->open_up, p->up), down = fmin(c->open_down, p->down);
    const double from_above = sun_w_m2 * sin_sun * p->sun_on_ground + sky_w_m2 * p->up_from_ground;
    const double on_leaf = 0.5 * sun_w_m2 * (sin_sun > 0 ? fmin(c->open_up, p->sun_here) : 0);
    const double from_below = down * ground_rho, shaded = 1 - p->up_from_ground;
    const double leaves = half * (on_leaf + up * sky_w_m2 + from_below * from_above) /
                          fmax(1 - half * (2 - up - down + from_below * shaded), 1e-6);
    *on_ground_w_m2 = from_above + shaded * leaves;
    return leaves;
}

double canopy_exitance(double *on_ground_w_m2, const Canopy *c, const CanopyPlace *place, int channel, double sun_w_m2,
                       double sky_w_m2, double sin_sun, double ground_rho)
{
    return exitance(on_ground_w_m2, c, place, 0.5 * c->scattered[channel], sun_w_m2, sky_w_m2, sin_sun, ground_rho);
}

bool canopy_light(CanopyLight *out, const Canopy *c, const Landscape *landscape, const Daylight *light,
                  const float ground_rho[optical_channel_count], const Hits *hits, unsigned channels)
{
    const double sin_sun = fmax(light->sun_d_enu[2], 0);
    bool         any = false;
    CanopyPlace  place[hits_capacity];
    for (int i = 0; i < hits->count; i++) {
        const double x_m = hits->p_enu[0][i], y_m = hits->p_enu[1][i];
        double       height_m = 0;
        place[i] = (CanopyPlace){1, 1, 1, 1, 1};
        if (!(hits->range_m[i] < INFINITY)) continue;
        if (hits->kind[i] != hit_ground && landscape)
            height_m = hits->p_enu[2][i] - elevation_height(&landscape->elevation, x_m, y_m, NULL);
        any |= canopy_place(&place[i], c, x_m, y_m, isfinite(height_m) ? height_m : 0, sin_sun) |
               (hits->kind[i] == hit_plant);
    }
    if (!any) return false;
    for (int i = 0; i < hits->count; i++) {
        const bool plant = hits->kind[i] == hit_plant;
        out->up[i] = (float)(plant ? fmin(place[i].up, (double)hits->open_up[i]) : place[i].up);
        out->down[i] = (float)(plant ? fmin(place[i].down, (double)hits->open_down[i]) : place[i].down);
    }
    for (int k = 0; k < optical_channel_count; k++) {
        if (!(channels >> k & 1)) continue;
        const double sun_w_m2 = light->sun_w_m2[k], sky_w_m2 = light->sky_w_m2[k], half = 0.5 * c->scattered[k];
        const double open_w_m2 = sun_w_m2 * sin_sun + sky_w_m2;
        for (int i = 0; i < hits->count; i++) {
            double       from_above_and_leaves;
            const double leaves = exitance(&from_above_and_leaves, c, &place[i], half, sun_w_m2, sky_w_m2, sin_sun,
                                           (double)ground_rho[k]);
            out->leaves_w_m2[k][i] = (float)leaves;
            out->ground[k][i] = (float)(open_w_m2 > 0 ? from_above_and_leaves / open_w_m2 : 1);
        }
    }
    return true;
}
