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

/* The cells with leaves about a place, and their shares of it: straight between the middles of cells. */
typedef struct CellsAbout {
    int               count;
    const CanopyCell *cell[4];
    double            share[4];
} CellsAbout;

/* pages: their plants too. */
static void cells_about(CellsAbout *out, const Canopy *c, double x_m, double y_m, bool pages)
{
    const double x = (x_m - c->x0_m) / canopy_cell_m - 0.5, y = (y_m - c->y0_m) / canopy_cell_m - 0.5;
    const double i = floor(x), j = floor(y);
    out->count = 0;
    if (!pages && !(i >= 0 && j >= 0 && i < c->nx - 1 && j < c->ny - 1)) return;
    for (int k = 0; k < 4; k++) {
        const double      a = i + (k & 1), b = j + (k >> 1);
        const CanopyCell *cell = NULL;
        if (a >= 0 && b >= 0 && a < c->nx && b < c->ny) cell = &c->cell[(size_t)b * (size_t)c->nx + (size_t)a];
        if (pages && (!cell || cell->leaf_area == 0)) cell = canopy_page_cell(c, a, b);
        if (!cell || cell->leaf_area == 0) continue;
        out->share[out->count] = (k & 1 ? x - i : 1 - (x - i)) * (k & 2 ? y - j : 1 - (y - j));
        out->cell[out->count++] = cell;
    }
}

static double leaf_area_of(const CellsAbout *about, double height_m)
{
    double sum = 0;
    for (int k = 0; k < about->count; k++) sum += about->share[k] * above_cell(about->cell[k], height_m);
    return sum;
}

double canopy_leaf_area_above(const Canopy *c, double x_m, double y_m, double height_m)
{
    CellsAbout about;
    cells_about(&about, c, x_m, y_m, false);
    return leaf_area_of(&about, height_m);
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

/* As fmin and fmax for finite numbers; those compile to calls. */
static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

static const CanopyPlace open_place = {1, 1, 1, 1, 1};

/* What a leaf area lets through of a sun of this slant; exp(0) is 1, as above most crowns. */
static double sun_through(double slant, double leaf_area) { return leaf_area > 0 ? exp(-slant * leaf_area) : 1; }

/* The place of a leaf area of `all`, with so much of it above. */
static void place_of(CanopyPlace *out, const Canopy *c, double all, double above, double sin_sun)
{
    const double slant = 0.5 / larger(sin_sun, 0.05);
    out->up_from_ground = gap_at(c, 0.5 * all);
    out->up = above == all ? out->up_from_ground : gap_at(c, 0.5 * above);
    out->down = gap_at(c, 0.5 * larger(all - above, 0));
    out->sun_on_ground = sun_through(slant, all);
    out->sun_here = above == all ? out->sun_on_ground : sun_through(slant, above);
}

bool canopy_place(CanopyPlace *out, const Canopy *c, double x_m, double y_m, double height_m, double sin_sun)
{
    CellsAbout about;
    cells_about(&about, c, x_m, y_m, false);
    const double all = leaf_area_of(&about, 0);
    *out = open_place;
    if (!(all > 0)) return false;
    place_of(out, c, all, height_m > 0 ? leaf_area_of(&about, height_m) : all, sin_sun);
    return true;
}

void canopy_place_of_plant(CanopyPlace *p, const Canopy *c)
{
    p->up = smaller(c->open_up, p->up), p->down = smaller(c->open_down, p->down);
    p->sun_here = smaller(c->open_up, p->sun_here);
}

/* Light of a channel over a canopy; half: of what a surface of it scatters. */
typedef struct Overhead {
    double half, sun_w_m2, sky_w_m2, sin_sun, ground_rho;
} Overhead;

/* M of canopy.h. p: of a leaf or branch (canopy_place_of_plant); sun_here 0 where the sun is down. */
static inline double exitance(double *on_ground_w_m2, const CanopyPlace *p, const Overhead *o)
{
    const double from_above = o->sun_w_m2 * o->sin_sun * p->sun_on_ground + o->sky_w_m2 * p->up_from_ground;
    const double on_leaf = 0.5 * o->sun_w_m2 * p->sun_here;
    const double from_below = p->down * o->ground_rho, shaded = 1 - p->up_from_ground;
    const double lost = 1 - o->half * (2 - p->up - p->down + from_below * shaded);
    const double leaves = o->half * (on_leaf + p->up * o->sky_w_m2 + from_below * from_above) / larger(lost, 1e-6);
    *on_ground_w_m2 = from_above + shaded * leaves;
    return leaves;
}

double canopy_exitance(double *on_ground_w_m2, const Canopy *c, const CanopyPlace *place, int channel, double sun_w_m2,
                       double sky_w_m2, double sin_sun, double ground_rho)
{
    const Overhead o = {0.5 * c->scattered[channel], sun_w_m2, sky_w_m2, sin_sun, ground_rho};
    CanopyPlace    p = *place;
    canopy_place_of_plant(&p, c);
    if (!(sin_sun > 0)) p.sun_here = 0;
    return exitance(on_ground_w_m2, &p, &o);
}

/* Places of a block's hits, as of plants, in arrays. */
typedef struct Places {
    double up[hits_capacity], down[hits_capacity], up_from_ground[hits_capacity];
    double sun_here[hits_capacity], sun_on_ground[hits_capacity];
} Places;

static void put_place(Places *to, int i, const CanopyPlace *place, const Canopy *c, double sin_sun)
{
    CanopyPlace p = *place;
    canopy_place_of_plant(&p, c);
    to->up[i] = p.up, to->down[i] = p.down, to->up_from_ground[i] = p.up_from_ground;
    to->sun_here[i] = sin_sun > 0 ? p.sun_here : 0, to->sun_on_ground[i] = p.sun_on_ground;
}

static void light_of(float *restrict leaves_w_m2, float *restrict ground, const Places *places, int count,
                     const Overhead *over)
{
    const Overhead o = *over;
    const double   open_w_m2 = o.sun_w_m2 * o.sin_sun + o.sky_w_m2;
    for (int i = 0; i < count; i++) {
        const CanopyPlace p = {places->up[i], places->down[i], places->up_from_ground[i], places->sun_here[i],
                               places->sun_on_ground[i]};
        double            on_ground_w_m2;
        leaves_w_m2[i] = (float)exitance(&on_ground_w_m2, &p, &o);
        ground[i] = (float)(on_ground_w_m2 / open_w_m2);
    }
    for (int i = 0; i < count && !(open_w_m2 > 0); i++) ground[i] = 1;
}

/* Asks for the posts about a place, of the finest level that has it: they lie far apart in memory. */
static void ask_for_height(const Elevation *elevation, double x_m, double y_m)
{
    const ElevationLevel *level = &elevation->level[0];
    const double          i = (x_m - level->x0_m) / level->spacing_m, j = (y_m - level->y0_m) / level->spacing_m;
    if (elevation->level_count == 0 || !(i >= 0 && j >= 0 && i < level->nx - 1 && j < level->ny - 1)) return;
    const uint16_t *post = level->stored + elevation_stored_index(level, (int)i, (int)j);
    __builtin_prefetch(post), __builtin_prefetch(post + elevation_tile_side);
}

bool canopy_light(CanopyLight *out, const Canopy *c, const Landscape *landscape, const Daylight *light,
                  const float ground_rho[optical_channel_count], const Hits *hits, unsigned channels)
{
    const double sin_sun = fmax(light->sun_d_enu[2], 0), reach_m = canopy_pages_reach_m(c);
    bool         any = false;
    Places       places;
    for (int i = 0; i < hits->count; i++) {
        const int next = i + 8;
        if (landscape && next < hits->count && hits->kind[next] == hit_plant)
            ask_for_height(&landscape->elevation, hits->p_enu[0][next], hits->p_enu[1][next]);
        const double x_m = hits->p_enu[0][i], y_m = hits->p_enu[1][i];
        const bool   plant = hits->kind[i] == hit_plant;
        CanopyPlace  place = open_place;
        CellsAbout   about = {.count = 0};
        if (hits->range_m[i] < INFINITY)
            cells_about(&about, c, x_m, y_m, reach_m > 0 && (plant || hits->range_m[i] < reach_m));
        const double all = leaf_area_of(&about, 0);
        if (all > 0) {
            double height_m = 0;
            if (hits->kind[i] != hit_ground && landscape)
                height_m = hits->p_enu[2][i] - elevation_height(&landscape->elevation, x_m, y_m, NULL);
            const bool aloft = isfinite(height_m) && height_m > 0;
            place_of(&place, c, all, aloft ? leaf_area_of(&about, height_m) : all, sin_sun);
        }
        any |= all > 0 || (plant && hits->range_m[i] < INFINITY);
        out->up[i] = (float)(plant ? smaller(place.up, (double)hits->open_up[i]) : place.up);
        out->down[i] = (float)(plant ? smaller(place.down, (double)hits->open_down[i]) : place.down);
        put_place(&places, i, &place, c, sin_sun);
    }
    if (!any) return false;
    for (int k = 0; k < optical_channel_count; k++) {
        const Overhead o = {0.5 * c->scattered[k], light->sun_w_m2[k], light->sky_w_m2[k], sin_sun,
                            (double)ground_rho[k]};
        if (channels >> k & 1) light_of(out->leaves_w_m2[k], out->ground[k], &places, hits->count, &o);
    }
    return true;
}
