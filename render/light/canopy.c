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

static double between_gaps(const float gap[gap_steps + 2], double x)
{
    const double at = clamp(x / gap_most * gap_steps, 0, gap_steps - 1e-6);
    const int    i = (int)at;
    return (double)gap[i] + (at - i) * ((double)gap[i + 1] - (double)gap[i]);
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

_Static_assert(sizeof(CanopyCell) == 4 && sizeof(CanopySky) == 3 && sizeof(Plant) == 20,
               "no padding: the octets are the numbers");

static size_t cells_of(const Canopy *c) { return (size_t)c->nx * (size_t)c->ny; }

void canopy_kept_values(Kept *kept, void *canopy)
{
    Canopy *c = canopy;
    kept_pass(kept, c->cell, cells_of(c) * sizeof *c->cell);
    kept_pass(kept, c->sky, cells_of(c) * sizeof *c->sky);
    kept_pass(kept, &c->mean, sizeof c->mean);
    kept_floats(kept, c->gap, gap_steps + 2);
    kept_floats(kept, c->low_gap, gap_steps + 2);
    kept_doubles(kept, c->clumping, plant_shade_ways);
    kept_doubles(kept, c->above, plant_shade_heights);
    kept_doubles(kept, c->below, plant_shade_heights);
    kept_doubles(kept, &c->own, 1);
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
    c->sky = calloc(cells_of(c) + 1, sizeof *c->sky);
    if (!c->cell || !c->sky) {
        canopy_destroy(c);
        return STATUS_NO_MEMORY;
    }
    *out = c;
    return STATUS_OK;
}

static Status fill(Canopy *c, const Woods *woods, const Plants *plants, const Materials *materials, bool leaves)
{
    const CanopyGrid grid = {c->cell, c->nx, c->ny, c->x0_m, c->y0_m};
    canopy_find_shade(c, woods, plants, leaves);
    average(c, woods, plants, materials, leaves);
    const Status status = canopy_fill_grid(&grid, woods->origin_enu, woods->plant, woods->count, plants, leaves);
    if (status == STATUS_OK) canopy_find_sky(c, plants);
    return status;
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
    free(canopy->sky);
    free(canopy);
}

/* Height in the crowns of a cell, from their base at 0 to their top at 1. */
static inline double height_in(const CanopyCell *cell, double height_m)
{
    const double top = cell->top * top_step_m, base = cell->base * top_step_m;
    return height_m >= top ? 1 : height_m <= base ? 0 : (height_m - base) / (top - base);
}

/* Leaf area at random that hides as much of the sun as what is above a place and in all; that hides as much of the sky,
 * past plants about it too; and of the ground below it. leaves: leaf area above it. towards: as CanopySky, over a sky
 * without plants. */
typedef struct Depth {
    double sun, all, sky, all_sky, ground, leaves, towards[2];
} Depth;

static inline void add_cell(Depth *to, const Canopy *c, const CanopyCell *cell, double share, double height_m)
{
    if (cell->leaf_area == 0) return;
    const double x = height_in(cell, height_m), leaves = share * leaf_area_step * cell->leaf_area;
    const double hides = leaves * clumped_step * cell->clumped;
    to->all += hides, to->sun += hides * canopy_share_at(c->above, x),
        to->ground += hides * canopy_share_at(c->below, x);
    to->leaves += leaves * (1 - x);
}

/* own: of the woods; NULL: the cell is of a page, or there is none. */
static inline void add_sky(Depth *to, const Canopy *c, const CanopyCell *cell, const CanopySky *own, double share,
                           double height_m)
{
    const bool plants = cell && cell->leaf_area > 0;
    if (own ? !(own->area | own->towards[0] | own->towards[1]) : !plants) return;
    const double here = plants ? leaf_area_step * cell->leaf_area * clumped_step * cell->clumped : 0;
    const double area = own ? sky_area_step * own->area : here;
    const double x = canopy_share_at(c->above, plants ? height_in(cell, height_m) : height_in(&c->mean, height_m));
    to->all_sky += share * area, to->sky += share * area * x;
    for (int k = 0; k < 2 && own; k++) to->towards[k] += share * x * sky_towards_step * own->towards[k];
}

/* Straight between the middles of cells. pages: their plants too. */
static Depth depth_at(const Canopy *c, double x_m, double y_m, double height_m, bool pages)
{
    const double x = (x_m - c->x0_m) / canopy_cell_m - 0.5, y = (y_m - c->y0_m) / canopy_cell_m - 0.5;
    const double i = floor(x), j = floor(y);
    Depth        sum = {0};
    if (!pages && !(i >= 0 && j >= 0 && i < c->nx - 1 && j < c->ny - 1)) return sum;
    for (int k = 0; k < 4; k++) {
        const double      share = (k & 1 ? x - i : 1 - (x - i)) * (k & 2 ? y - j : 1 - (y - j));
        const double      a = i + (k & 1), b = j + (k >> 1);
        const CanopyCell *cell = NULL, *far = NULL;
        const CanopySky  *sky = NULL;
        if (a >= 0 && b >= 0 && a < c->nx && b < c->ny) {
            const size_t at = (size_t)b * (size_t)c->nx + (size_t)a;
            cell = &c->cell[at], sky = &c->sky[at];
        }
        if (pages && (!cell || cell->leaf_area == 0)) far = canopy_page_cell(c, a, b);
        if (far && far->leaf_area > 0) cell = far, sky = NULL;
        if (cell) add_cell(&sum, c, cell, share, height_m);
        add_sky(&sum, c, cell, sky, share, height_m);
    }
    return sum;
}

double canopy_leaf_area_above(const Canopy *c, double x_m, double y_m, double height_m)
{
    return depth_at(c, x_m, y_m, height_m, false).leaves;
}

void canopy_stand(CanopyStand *out, const Canopy *c, double x_m, double y_m)
{
    const double x = floor((x_m - c->x0_m) / canopy_cell_m), y = floor((y_m - c->y0_m) / canopy_cell_m);
    *out = (CanopyStand){.open = 1};
    if (!(x >= 0 && y >= 0 && x < c->nx && y < c->ny)) return;
    const size_t      at = (size_t)y * (size_t)c->nx + (size_t)x;
    const CanopyCell *cell = &c->cell[at];
    const double      leaf_area = leaf_area_step * cell->leaf_area;
    out->open = between_gaps(c->gap, 0.5 * sky_area_step * c->sky[at].area);
    if (cell->leaf_area == 0) return;
    out->leaf_area = leaf_area, out->hides = leaf_area * clumped_step * cell->clumped;
    out->base_m = cell->base * top_step_m, out->top_m = cell->top * top_step_m;
}

/* ---- hits ------------------------------------------------------------------------------------- */

/* As fmin and fmax for finite numbers; those compile to calls. */
static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

/* What other plants leave of the sky that a leaf sees past its own crown, which is open aside rather than upwards:
 * between what they leave of the light on level ground and on walls; of the light on walls for all leaves, most of
 * which lie deep. */
static double past_others(const Canopy *c, double x)
{
    static const double level = 0.3; /* of tests/system/test_plants_within_deep.sh */
    return level * between_gaps(c->gap, x) + (1 - level) * between_gaps(c->low_gap, x);
}

/* Of what is met on the way up first, leaves whose share x of all above a place is above them are as frequent as
 * exp(-d (1 - x)), and get exp(-s x) of the sun, d and s the depths of sky and sun over the place: the mean. That of
 * the sky: s = d. */
static void see_leaves(CanopyPlace *p, double sun_depth)
{
    const double depth = -log(fmax(p->up, 1e-12)), off = depth - sun_depth;
    p->seen_up = p->up, p->seen_sun = p->sun_here;
    if (!(depth > 1e-3)) return;
    p->seen_up = depth * p->up / (1 - p->up);
    p->seen_sun = fabs(off) < 1e-2 ? depth * sqrt(p->up * p->sun_here) / (1 - p->up)
                                   : depth * (p->sun_here - p->up) / ((1 - p->up) * off);
}

/* The members of a place that are asked for: all, those of a leaf or branch to which its own plant leaves some, or
 * those of another surface. */
typedef enum PlaceOf { PLACE_OF_ANY, PLACE_OF_PLANT, PLACE_OF_GROUND } PlaceOf;

static const CanopyPlace open_place = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, .low = 1};

static double through(double slant, double area) { return area > 0 ? exp(-slant * area) : 1; }

/* slant: of the sun. Inlined for each of what is asked for. */
static inline __attribute__((always_inline)) void place_of(CanopyPlace *out, const Canopy *c, const Depth *depth,
                                                           double slant, PlaceOf of)
{
    /* shares of other plants in what hides sky and sun */
    const double sky = 1 - c->own / larger(larger(depth->all_sky, c->own), 1e-9),
                 sun = 1 - c->own / larger(larger(depth->all, c->own), 1e-9);
    const double past_sky = 0.5 * sky * depth->sky, past_ground = 0.5 * sun * depth->ground;
    out->up_from_ground = between_gaps(c->gap, 0.5 * depth->all_sky);
    out->sun_on_ground = through(slant, depth->all);
    out->past_low_up = between_gaps(c->low_gap, past_sky);
    out->past_sun = through(slant * sun, depth->sun);
    if (of != PLACE_OF_GROUND) {
        out->past_up = past_others(c, past_sky), out->past_down = past_others(c, past_ground);
        out->past_low_down = between_gaps(c->low_gap, past_ground);
    }
    if (of == PLACE_OF_PLANT) return;
    out->up = between_gaps(c->gap, 0.5 * depth->sky), out->down = between_gaps(c->gap, 0.5 * depth->ground);
    out->sun_here = depth->sun == depth->all ? out->sun_on_ground : through(slant, depth->sun);
    out->low = between_gaps(c->low_gap, 0.5 * depth->sky);
    out->towards[0] = depth->towards[0], out->towards[1] = depth->towards[1];
    see_leaves(out, slant * depth->sun);
}

static double slant_of(const Canopy *c, double sin_sun)
{
    return 0.5 * canopy_clumping(c, sin_sun) / fmax(sin_sun, 0.05);
}

static bool is_among(const Depth *depth) { return depth->all_sky > 0 || depth->all > 0; }

bool canopy_place(CanopyPlace *out, const Canopy *c, double x_m, double y_m, double height_m, double sin_sun)
{
    const Depth depth = depth_at(c, x_m, y_m, height_m > 0 ? height_m : 0, false);
    *out = open_place;
    if (!is_among(&depth)) return false;
    place_of(out, c, &depth, slant_of(c, sin_sun), PLACE_OF_ANY);
    return true;
}

void canopy_place_past_plant(double *up, double *down, const CanopyPlace *p, const Canopy *c, double open_up,
                             double open_down)
{
    *up = c->own > 0 ? open_up * p->past_up : fmin(p->up, open_up);
    *down = c->own > 0 ? open_down * p->past_down : fmin(p->down, open_down);
}

/* A leaf gets what its own plant leaves it of what others do. Where nothing is known of single shadows, the less of its
 * own plant's and of all. */
void canopy_place_of_plant(CanopyPlace *p, const Canopy *c)
{
    const bool known = c->own > 0;
    p->up = known ? c->open_up * p->past_low_up : fmin(c->open_up, p->up);
    p->down = known ? c->open_down * p->past_low_down : fmin(c->open_down, p->down);
    p->sun_here = known ? c->open_up * p->past_sun : fmin(c->open_up, p->sun_here);
}

void canopy_place_of_ground(CanopyPlace *p, const Canopy *c)
{
    const double up = c->own > 0 ? p->past_low_up / fmax(p->up, 1e-9) : 1,
                 sun = c->own > 0 ? p->past_sun / fmax(p->sun_here, 1e-9) : 1;
    const double open = c->own > 0 ? c->open_up : 1;
    p->up = open * fmin(p->seen_up * up, 1), p->sun_here = open * fmin(p->seen_sun * sun, 1);
}

/* Light of a channel over a canopy; half: of what a surface of it scatters. */
typedef struct Overhead {
    double half, sun_w_m2, sky_w_m2, sin_sun, ground_rho;
} Overhead;

/* Of a place, what exitance needs: of the mean leaf or branch. sun_here 0 where the sun is down. */
typedef struct LeafPlaces {
    double up[hits_capacity], down[hits_capacity], up_from_ground[hits_capacity];
    double sun_here[hits_capacity], sun_on_ground[hits_capacity];
} LeafPlaces;

static inline void put_place(LeafPlaces *to, int i, const CanopyPlace *p, const Canopy *c, double sin_sun)
{
    to->up[i] = smaller(c->open_up, p->up), to->down[i] = smaller(c->open_down, p->down);
    to->up_from_ground[i] = p->up_from_ground;
    to->sun_here[i] = sin_sun > 0 ? smaller(c->open_up, p->sun_here) : 0, to->sun_on_ground[i] = p->sun_on_ground;
}

static inline double exitance(double *on_ground_w_m2, const LeafPlaces *p, int i, const Overhead *o)
{
    const double from_above = o->sun_w_m2 * o->sin_sun * p->sun_on_ground[i] + o->sky_w_m2 * p->up_from_ground[i];
    const double on_leaf = 0.5 * o->sun_w_m2 * p->sun_here[i];
    const double from_below = p->down[i] * o->ground_rho, shaded = 1 - p->up_from_ground[i];
    const double lost = 1 - o->half * (2 - p->up[i] - p->down[i] + from_below * shaded);
    const double leaves = o->half * (on_leaf + p->up[i] * o->sky_w_m2 + from_below * from_above) / larger(lost, 1e-6);
    *on_ground_w_m2 = from_above + shaded * leaves;
    return leaves;
}

double canopy_exitance(double *on_ground_w_m2, const Canopy *c, const CanopyPlace *place, int channel, double sun_w_m2,
                       double sky_w_m2, double sin_sun, double ground_rho)
{
    const Overhead o = {0.5 * c->scattered[channel], sun_w_m2, sky_w_m2, sin_sun, ground_rho};
    LeafPlaces     one;
    put_place(&one, 0, place, c, sin_sun);
    return exitance(on_ground_w_m2, &one, 0, &o);
}

static void light_of(float *restrict leaves_w_m2, float *restrict ground, const LeafPlaces *places, int count,
                     const Overhead *over)
{
    const Overhead o = *over;
    const double   open_w_m2 = o.sun_w_m2 * o.sin_sun + o.sky_w_m2;
    for (int i = 0; i < count; i++) {
        double on_ground_w_m2;
        leaves_w_m2[i] = (float)exitance(&on_ground_w_m2, places, i, &o);
        ground[i] = (float)(on_ground_w_m2 / open_w_m2);
    }
    for (int i = 0; i < count && !(open_w_m2 > 0); i++) ground[i] = 1;
}

/* What a surface receives of an even sky, over what its tilt alone would leave it. From zenith to walls all around: the
 * light on level ground by the cosine of the tilt, that on a wall by the rest, and that from the open side, of which a
 * wall gets half and level ground none. Exact for an open sky, and for half of one. */
static double sky_on(const CanopyPlace *p, const Hits *hits, int i)
{
    const double up = (double)hits->n_enu[2][i], open = 0.5 * (1 + up);
    const double aside = (double)hits->n_enu[0][i] * p->towards[0] + (double)hits->n_enu[1][i] * p->towards[1];
    if (!(open > 1e-3)) return p->up;
    return clamp((up * p->up + 0.5 * (1 - up) * p->low + open * aside) / open, 0, 2);
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
    const double slant = slant_of(c, sin_sun);
    bool         any = false;
    LeafPlaces   places;
    for (int i = 0; i < hits->count; i++) {
        const int next = i + 8;
        if (landscape && next < hits->count && hits->kind[next] == hit_plant)
            ask_for_height(&landscape->elevation, hits->p_enu[0][next], hits->p_enu[1][next]);
        const double x_m = hits->p_enu[0][i], y_m = hits->p_enu[1][i];
        const bool   plant = hits->kind[i] == hit_plant, met = hits->range_m[i] < INFINITY;
        CanopyPlace  place = open_place;
        Depth        depth = {0};
        if (met) {
            const bool pages = reach_m > 0 && (plant || hits->range_m[i] < reach_m);
            double     height_m = 0;
            if (hits->kind[i] != hit_ground && landscape)
                height_m = hits->p_enu[2][i] - elevation_height(&landscape->elevation, x_m, y_m, NULL);
            depth = depth_at(c, x_m, y_m, height_m > 0 && isfinite(height_m) ? height_m : 0, pages);
        }
        const bool among = is_among(&depth);
        any |= among || (plant && met);
        if (!plant) {
            if (among) place_of(&place, c, &depth, slant, PLACE_OF_GROUND);
            out->up[i] = (float)sky_on(&place, hits, i), out->down[i] = (float)place.down;
            canopy_place_of_ground(&place, c);
        } else {
            const bool own = c->own > 0;
            double     up, down;
            if (among && own) place_of(&place, c, &depth, slant, PLACE_OF_PLANT);
            else if (among) place_of(&place, c, &depth, slant, PLACE_OF_ANY);
            canopy_place_past_plant(&up, &down, &place, c, (double)hits->open_up[i], (double)hits->open_down[i]);
            out->up[i] = (float)up, out->down[i] = (float)down;
            if (own) canopy_place_of_plant(&place, c);
        }
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
