/* render/light/canopy.c: leaf area and heights of the woods on a grid, and the light among them. */
#include "render/light/canopy_private.h"

#include <stdlib.h>

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

/* ---- the woods' own light ---------------------------------------------------------------------- */

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
    const int per_square = (int)(woods_square_m / canopy_cell_m);
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
    const CanopyGrid grid = {c->cell, c->nx, c->ny, c->x0_m, c->y0_m};
    for (int k = 0; k < gap_steps + 2; k++) c->gap[k] = (float)canopy_gap(gap_most * k / gap_steps);
    average(c, woods, plants, materials, leaves);
    return canopy_fill_grid(&grid, woods->origin_enu, woods->plant, woods->count, plants, leaves);
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
    canopy_pages_destroy(canopy->pages);
    free(canopy->cell);
    free(canopy);
}

static double above_cell(const CanopyCell *cell, double height_m)
{
    const double top = cell->top * top_step_m, base = cell->base * top_step_m;
    if (cell->leaf_area == 0 || height_m >= top) return 0;
    return leaf_area_step * cell->leaf_area * (height_m <= base ? 1 : (top - height_m) / (top - base));
}

/* Straight between the middles of cells. pages: their plants too. */
static double leaf_area_above(const Canopy *c, double x_m, double y_m, double height_m, bool pages)
{
    const double x = (x_m - c->x0_m) / canopy_cell_m - 0.5, y = (y_m - c->y0_m) / canopy_cell_m - 0.5;
    const double i = floor(x), j = floor(y);
    double       sum = 0;
    if (!pages && !(i >= 0 && j >= 0 && i < c->nx - 1 && j < c->ny - 1)) return 0;
    for (int k = 0; k < 4; k++) {
        const double      share = (k & 1 ? x - i : 1 - (x - i)) * (k & 2 ? y - j : 1 - (y - j));
        const double      a = i + (k & 1), b = j + (k >> 1);
        const CanopyCell *cell = NULL;
        if (a >= 0 && b >= 0 && a < c->nx && b < c->ny) cell = &c->cell[(size_t)b * (size_t)c->nx + (size_t)a];
        if (pages && (!cell || cell->leaf_area == 0)) cell = canopy_page_cell(c, a, b);
        if (cell) sum += share * above_cell(cell, height_m);
    }
    return sum;
}

double canopy_leaf_area_above(const Canopy *c, double x_m, double y_m, double height_m)
{
    return leaf_area_above(c, x_m, y_m, height_m, false);
}

void canopy_stand(CanopyStand *out, const Canopy *c, double x_m, double y_m)
{
    const double x = floor((x_m - c->x0_m) / canopy_cell_m), y = floor((y_m - c->y0_m) / canopy_cell_m);
    *out = (CanopyStand){.open = 1};
    if (!(x >= 0 && y >= 0 && x < c->nx && y < c->ny)) return;
    const CanopyCell *cell = &c->cell[(size_t)y * (size_t)c->nx + (size_t)x];
    if (cell->leaf_area == 0) return;
    *out = (CanopyStand){leaf_area_step * cell->leaf_area, cell->base * top_step_m, cell->top * top_step_m,
                         gap_at(c, 0.5 * leaf_area_step * cell->leaf_area)};
}

/* ---- hits ------------------------------------------------------------------------------------- */

static bool place_at(CanopyPlace *out, const Canopy *c, const double p_m[2], double height_m, double sin_sun,
                     bool pages)
{
    const double all = leaf_area_above(c, p_m[0], p_m[1], 0, pages);
    const double above = height_m > 0 ? leaf_area_above(c, p_m[0], p_m[1], height_m, pages) : all;
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

bool canopy_place(CanopyPlace *out, const Canopy *c, double x_m, double y_m, double height_m, double sin_sun)
{
    return place_at(out, c, (const double[2]){x_m, y_m}, height_m, sin_sun, false);
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
    const double sin_sun = fmax(light->sun_d_enu[2], 0), reach_m = canopy_pages_reach_m(c);
    bool         any = false;
    CanopyPlace  place[hits_capacity];
    for (int i = 0; i < hits->count; i++) {
        const double x_m = hits->p_enu[0][i], y_m = hits->p_enu[1][i];
        double       height_m = 0;
        place[i] = (CanopyPlace){1, 1, 1, 1, 1};
        if (!(hits->range_m[i] < INFINITY)) continue;
        if (hits->kind[i] != hit_ground && landscape)
            height_m = hits->p_enu[2][i] - elevation_height(&landscape->elevation, x_m, y_m, NULL);
        const bool pages = reach_m > 0 && (hits->kind[i] == hit_plant || hits->range_m[i] < reach_m);
        any |= place_at(&place[i], c, (const double[2]){x_m, y_m}, isfinite(height_m) ? height_m : 0, sin_sun, pages) |
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
