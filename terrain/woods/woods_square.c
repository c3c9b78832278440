/* terrain/woods/woods_square.c: the standing plants of one square, and where none may stand.
 *
 * A square is a lattice of cells of 4 m; each has a candidate at a random place of it. A candidate becomes a plant
 * with the probability that gives its class its number per hectare, or a store's canopy layer its cover: discs of the
 * crowns' size at random cover 1 - exp(-number x area). Crowns that a store has marked stand as they are, and no other
 * tree does where they were looked for. */
#include "terrain/woods/woods_private.h"

#include <stdlib.h>

static const double way_room_m = 1;

/* ---- clearings -------------------------------------------------------------------------------- */

double woods_path_away_m(const WoodsPath *p, double x_m, double y_m)
{
    const double dx = p->b_m[0] - p->a_m[0], dy = p->b_m[1] - p->a_m[1], square = dx * dx + dy * dy;
    const double ax = x_m - p->a_m[0], ay = y_m - p->a_m[1];
    const double t = square > 0 ? clamp((ax * dx + ay * dy) / square, 0, 1) : 0;
    return hypot(ax - t * dx, ay - t * dy);
}

WoodsPath woods_footprint(const double p_m[2], const double nose[2], double front_m, double back_m, double width_m)
{
    static const double room_m = 0.5;
    const double        in_m = 0.25 * width_m, from_m = fmin(back_m + in_m, 0), to_m = fmax(front_m - in_m, 0);
    WoodsPath           path = {.half_m = 0.5 * width_m + room_m, .low_half_m = 0.5 * width_m + room_m};
    for (int k = 0; k < 2; k++) path.a_m[k] = p_m[k] + nose[k] * from_m, path.b_m[k] = p_m[k] + nose[k] * to_m;
    return path;
}

/* Calls count or put for every square that a path may reach into. */
static void walk_squares(WoodsClearings *c, uint32_t *at, bool put)
{
    static const double reach_m = 4; /* no plant is given more room than this */
    for (int n = 0; n < c->count; n++) {
        const WoodsPath *p = &c->path[n];
        int64_t          from[2], end[2];
        for (int k = 0; k < 2; k++) {
            const double  low = fmin(p->a_m[k], p->b_m[k]) - p->half_m - reach_m;
            const double  high = fmax(p->a_m[k], p->b_m[k]) + p->half_m + reach_m;
            const int64_t first = k ? c->j0 : c->i0;
            const int     squares = k ? c->ny : c->nx;
            from[k] = (int64_t)clamp(floor(low / woods_square_m) - (double)first, 0, squares);
            end[k] = (int64_t)clamp(floor(high / woods_square_m) - (double)first + 1, 0, squares);
        }
        for (int64_t j = from[1]; j < end[1]; j++)
            for (int64_t i = from[0]; i < end[0]; i++) {
                const double x_m = ((double)(c->i0 + i) + 0.5) * woods_square_m;
                const double y_m = ((double)(c->j0 + j) + 0.5) * woods_square_m;
                if (woods_path_away_m(p, x_m, y_m) > p->half_m + 0.7072 * woods_square_m + reach_m) continue;
                if (put) c->item[at[j * c->nx + i]] = (uint32_t)n;
                at[j * c->nx + i]++;
            }
    }
}

Status woods_clearings_create(WoodsClearings *out, const WoodsSource *s, const WoodsConfig *config)
{
    const size_t   squares = (size_t)s->nx * (size_t)s->ny;
    WoodsClearings c = {.i0 = s->i0, .j0 = s->j0, .nx = s->nx, .ny = s->ny};
    c.path = calloc((size_t)config->path_count + 1, sizeof *c.path);
    c.first = calloc(squares + 2, sizeof *c.first);
    if (!c.path || !c.first) goto lost;
    for (int n = 0; n < config->path_count; n++) c.path[c.count++] = config->path[n];
    /* counts at first[2 ..], then sums: while squares are filled, first[n + 1] is the next place of square n */
    walk_squares(&c, c.first + 2, false);
    for (size_t n = 1; n <= squares; n++) c.first[n + 1] += c.first[n];
    c.item = calloc((size_t)c.first[squares + 1] + 1, sizeof *c.item);
    if (!c.item) goto lost;
    walk_squares(&c, c.first + 1, true);
    *out = c;
    return STATUS_OK;
lost:
    woods_clearings_free(&c);
    return STATUS_NO_MEMORY;
}

bool woods_is_cleared(const WoodsClearings *c, double x_m, double y_m, double room_m, bool low)
{
    const double i = floor(x_m / woods_square_m) - (double)c->i0, j = floor(y_m / woods_square_m) - (double)c->j0;
    if (!(i >= 0 && j >= 0 && i < c->nx && j < c->ny)) return false;
    const size_t n = (size_t)j * (size_t)c->nx + (size_t)i;
    for (uint32_t k = c->first[n]; k < c->first[n + 1]; k++) {
        const WoodsPath *p = &c->path[c->item[k]];
        if (low && !(p->low_half_m > 0)) continue;
        if (woods_path_away_m(p, x_m, y_m) < (low ? p->low_half_m : p->half_m) + room_m) return true;
    }
    return false;
}

void woods_clearings_free(WoodsClearings *c)
{
    free(c->path), free(c->first), free(c->item);
    memset(c, 0, sizeof *c);
}

/* ---- what is built ------------------------------------------------------------------------------ */

bool woods_is_built_on(const WoodsSource *s, double x_m, double y_m, bool low)
{
    static const double wall_m = 0.1; /* grass grows up to walls */
    if (!s->culture) return false;
    if (!low) return culture_is_near(s->culture, x_m, y_m, woods_built_m);
    return culture_building_at(s->culture, x_m, y_m, wall_m) >= 0 ||
           culture_surface_at(s->culture, x_m, y_m) != SURFACE_NONE;
}

/* ---- surfaces --------------------------------------------------------------------------------- */

static bool surface_bears(uint8_t surface)
{
    return surface != SURFACE_NONE && surface != SURFACE_WATER && surface != SURFACE_ROAD && surface != SURFACE_TRACK &&
           surface != SURFACE_SNOW;
}

void woods_bears(uint8_t *bears, const WoodsSource *s, int count, const double *x_m, const double *y_m, double room_m,
                 bool low)
{
    enum { some = 256 };
    static const double side[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double              x[some], y[some];
    uint8_t             surface[some];
    for (int first = 0; first < count; first += some) {
        const int n = count - first < some ? count - first : some;
        for (int k = 0; k < n; k++) {
            WayPlace way;
            bears[first + k] = !woods_is_cleared(&s->clearings, x_m[first + k], y_m[first + k], room_m, low) &&
                               !woods_is_built_on(s, x_m[first + k], y_m[first + k], low);
            if (!landscape_way(&way, s->landscape, x_m[first + k], y_m[first + k])) continue;
            bears[first + k] &= fabs(way.across_m) > way.half_m + way_room_m + room_m;
        }
        for (int q = 0; q < 4; q++) {
            for (int k = 0; k < n; k++) {
                x[k] = x_m[first + k] + side[q][0] * (room_m + way_room_m);
                y[k] = y_m[first + k] + side[q][1] * (room_m + way_room_m);
            }
            landscape_surfaces(surface, s->landscape, n, x, y);
            for (int k = 0; k < n; k++) bears[first + k] &= surface_bears(surface[k]);
        }
    }
}

/* ---- one square ---------------------------------------------------------------------------------- */

enum { square_cells = woods_side_cells * woods_side_cells };
static const double cell_m = woods_cell_m;
static const double grove_m = 140, patch_m = 70; /* wavelengths by which kinds, and density, vary */
static const double hedges_reach_m = 3000;       /* beyond it hedges have the colour of their ground */

/* Smooth noise, -1 .. 1, of waves of length_m. */
static double woods_noise(uint64_t seed, uint64_t stream, double x_m, double y_m, double length_m)
{
    const double  x = x_m / length_m, y = y_m / length_m, i = floor(x), j = floor(y);
    const double  u = x - i, v = y - j, s = u * u * (3 - 2 * u), t = v * v * (3 - 2 * v);
    const int64_t a = (int64_t)i, b = (int64_t)j;
    const double  sw = woods_unit(woods_hash(seed, a, b, stream)), se = woods_unit(woods_hash(seed, a + 1, b, stream));
    const double  nw = woods_unit(woods_hash(seed, a, b + 1, stream)),
                 ne = woods_unit(woods_hash(seed, a + 1, b + 1, stream));
    const double south = sw + s * (se - sw), north = nw + s * (ne - nw);
    return 2 * (south + t * (north - south)) - 1;
}

/* Draws lean, twist and width. Lean: 3 degrees rms each way (the sum of two uniform numbers is bell-shaped), within 15.
 * */
Plant woods_draw_plant(uint64_t hash, PlantKind kind, double height_m, double width)
{
    Plant p = {.kind = (uint8_t)kind, .twist = (uint16_t)hash};
    for (int k = 0; k < 2; k++) {
        const double u = woods_unit(woods_hash(hash, k, 1, 0)) + woods_unit(woods_hash(hash, k, 2, 0)) - 1;
        p.lean[k] = (int8_t)lrint(clamp(u * 62, -89, 89)); /* both at once stay within 15 degrees */
    }
    p.height = (uint16_t)clamp(rint(height_m / plant_height_step_m), 1, plant_most_height);
    p.width = (uint8_t)clamp(rint(128 * width), 16, 255);
    return p;
}

/* Draws a height; heights near the upper end are more frequent. */
static double height_of(uint64_t hash, double low_m, double high_m)
{
    return low_m + (high_m - low_m) * sqrt(woods_unit(woods_hash(hash, 3, 0, 0)));
}

/* Draws a kind by the class's shares; each is more frequent where its own noise is high, which makes groves. */
static PlantKind kind_at(const WoodsSource *s, const double share[PLANT_STANDING], double x_m, double y_m,
                         uint64_t hash)
{
    double weight[PLANT_STANDING], sum = 0;
    for (int k = 0; k < PLANT_STANDING; k++) {
        weight[k] = share[k] > 0 ? share[k] * exp(3 * woods_noise(s->seed, 40 + (uint64_t)k, x_m, y_m, grove_m)) : 0;
        sum += weight[k];
    }
    double left = sum * woods_unit(woods_hash(hash, 4, 0, 0));
    int    last = 0;
    for (int k = 0; k < PLANT_STANDING; k++) {
        if (!(weight[k] > 0)) continue;
        last = k;
        if (left < weight[k]) break;
        left -= weight[k];
    }
    return (PlantKind)last;
}

/* Density relative to the mean, which varies in patches. */
double woods_density(const WoodsSource *s, double x_m, double y_m)
{
    return 1 + 0.7 * woods_noise(s->seed, 30, x_m, y_m, patch_m) +
           0.3 * woods_noise(s->seed, 31, x_m, y_m, 4 * patch_m);
}

void woods_add_plant(SquarePlants *out, const WoodsSource *s, Plant plant, double x_m, double y_m)
{
    if (out->count == out->room) {
        const int room = out->room ? 2 * out->room : 64;
        Plant    *larger = realloc(out->plant, (size_t)room * sizeof *larger);
        if (!larger) {
            out->lost = true;
            return;
        }
        out->plant = larger, out->room = room;
    }
    const double z_m = s->landscape ? elevation_height(&s->landscape->elevation, x_m, y_m, NULL) : 0;
    if (!isfinite(z_m)) return;
    plant.p_m[0] = (float)(x_m - s->origin_enu[0]), plant.p_m[1] = (float)(y_m - s->origin_enu[1]);
    plant.p_m[2] = (float)(z_m - s->origin_enu[2]);
    out->plant[out->count++] = plant;
}

/* ---- layers of a store ------------------------------------------------------------------------- */

static bool layer_at(double *out, const StoreGrid *grid, const uint8_t *layer, double step, double x_m, double y_m)
{
    const double i = floor((x_m - grid->x0_m) / grid->cell_m), j = floor((y_m - grid->y0_m) / grid->cell_m);
    if (!layer || !(i >= 0 && j >= 0 && i < grid->nx && j < grid->ny)) return false;
    *out = step * layer[(size_t)j * (size_t)grid->nx + (size_t)i];
    return true;
}

static bool is_marked(const WoodsSource *s, double x_m, double y_m)
{
    const WoodsCrowns *c = &s->crowns;
    return c->first && x_m >= c->low[0] && y_m >= c->low[1] && x_m <= c->high[0] && y_m <= c->high[1];
}

/* The shares of kinds where the class has no trees, but a layer or a crown says that there are some. */
static const double *shares_of(const WoodsSource *s, uint8_t surface)
{
    const WoodsClass *class = &s->table.of[surface];
    for (int k = 0; k < PLANT_TREES; k++)
        if (class->share[k] > 0) return class->share;
    return s->table.of[SURFACE_FOREST_BROADLEAF].share;
}

static void add_crowns(SquarePlants *out, const WoodsSource *s, int i, int j)
{
    const size_t n = (size_t)j * (size_t)s->nx + (size_t)i;
    for (uint32_t k = s->crowns.first[n]; k < s->crowns.first[n + 1]; k++) {
        const Crown   *crown = &s->store.crown[s->crowns.item[k]];
        const double   x_m = (double)crown->x_m, y_m = (double)crown->y_m;
        const uint64_t hash = woods_hash(s->seed, (int64_t)s->crowns.item[k], 0, 60);
        uint8_t        surface;
        landscape_surfaces(&surface, s->landscape, 1, &x_m, &y_m);
        if (surface == SURFACE_WATER || surface == SURFACE_ROAD || !(crown->height_m > 0.5f)) continue;
        if (woods_is_cleared(&s->clearings, x_m, y_m, 0, false) || woods_is_built_on(s, x_m, y_m, false)) continue;
        const PlantKind kind = crown->height_m < 3 ? PLANT_BUSH : kind_at(s, shares_of(s, surface), x_m, y_m, hash);
        const double    width = (double)crown->radius_m / ((double)crown->height_m * plant_crown_share(kind));
        woods_add_plant(out, s, woods_draw_plant(hash, kind, (double)crown->height_m, clamp(width, 0.4, 1.99)), x_m,
                        y_m);
        out->from_crowns++;
    }
}

/* Trees of culture stand where and as its files say, whatever the ground is. */
static void add_trees(SquarePlants *out, const WoodsSource *s, int i, int j)
{
    static const double mean_m[PLANT_STANDING] = {20, 18, 17, 19, 20, 19, 19, 2, 1.5}; /* where no height is said */
    const size_t        n = (size_t)j * (size_t)s->nx + (size_t)i;
    for (uint32_t k = s->trees.first[n]; k < s->trees.first[n + 1]; k++) {
        const CultureTree *t = &s->culture->tree[s->trees.item[k]];
        const uint64_t     hash = woods_hash(s->seed, (int64_t)t->id, 0, 75);
        if (t->kind >= PLANT_STANDING || woods_is_cleared(&s->clearings, t->x_m, t->y_m, 0, false)) continue;
        const double height_m = t->height_m > 0 ? (double)t->height_m : mean_m[t->kind];
        const double width =
            t->kind == PLANT_HEDGE ? clamp(1.5 / (height_m * plant_crown_share(PLANT_HEDGE)), 0.6, 1.99) : 1;
        Plant plant = woods_draw_plant(hash, (PlantKind)t->kind, height_m, width);
        plant_paint(&plant, (PlantMark)t->mark);
        woods_add_plant(out, s, plant, t->x_m, t->y_m);
    }
}

/* ---- candidates ------------------------------------------------------------------------------- */

typedef struct Candidates {
    int      count;
    double   x_m[square_cells], y_m[square_cells];
    uint8_t  surface[square_cells];
    uint64_t hash[square_cells];
    Plant    plant[square_cells];
    uint8_t  source[square_cells];
} Candidates;

enum { source_canopy, source_class };

bool woods_canopy_at(double *cover, double *height_m, const WoodsSource *s, double x_m, double y_m)
{
    return s->has_store &&
           layer_at(cover, &s->store.canopy_cover_grid, s->store.canopy_cover, store_canopy_cover, x_m, y_m) &&
           layer_at(height_m, &s->store.canopy_height_grid, s->store.canopy_height, store_canopy_height_m, x_m, y_m);
}

/* Draws a plant from the canopy layers; returns false when there is none. found: whether the layers have a value here.
 * */
static bool from_canopy(Plant *out, bool *found, const WoodsSource *s, uint8_t surface, double x_m, double y_m,
                        uint64_t hash)
{
    double cover, height_m;
    *found = woods_canopy_at(&cover, &height_m, s, x_m, y_m);
    if (!*found || !(cover > 0 && height_m >= 1)) return false;
    const double    each_m = height_m * (0.8 + 0.3 * woods_unit(woods_hash(hash, 5, 0, 0)));
    const PlantKind kind = each_m < 2.5 ? PLANT_BUSH : kind_at(s, shares_of(s, surface), x_m, y_m, hash);
    const double    radius_m = each_m * plant_crown_share(kind), area_m2 = pi_rad * radius_m * radius_m;
    const double    per_cell = -log(1 - fmin(cover, 0.97)) * cell_m * cell_m / area_m2;
    /* where one plant a cell is not enough to reach the cover, it is made wider */
    const double width = clamp(sqrt(fmax(per_cell / 0.9, 1)), 1, 1.99);
    if (!(woods_unit(woods_hash(hash, 6, 0, 0)) < per_cell / (width * width))) return false;
    *out = woods_draw_plant(hash, kind, each_m, width);
    return true;
}

/* The class whose plants stand on a surface. The synthetic terrain has no class of woods: its wild patches are scrub,
 * and most of them are wooded. */
SurfaceClass woods_class_at(const WoodsSource *s, uint8_t surface, double x_m, double y_m)
{
    static const double wood_m = 260;
    if (surface != SURFACE_SCRUB || !s->synthetic || woods_noise(s->seed, 32, x_m, y_m, wood_m) < -0.25)
        return (SurfaceClass)surface;
    return woods_noise(s->seed, 33, x_m, y_m, 3 * wood_m) > 0.3 ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF;
}

void woods_draw_of_class(Plant *out, const WoodsSource *s, const WoodsClass *class, double x_m, double y_m,
                         uint64_t hash)
{
    const PlantKind kind = kind_at(s, class->share, x_m, y_m, hash);
    double          height_m = height_of(hash, class->low_m, class->high_m);
    if (kind == PLANT_BUSH) height_m = fmin(height_m, 1 + 2.5 * woods_unit(woods_hash(hash, 8, 0, 0)));
    *out = woods_draw_plant(hash, kind, height_m, 0.8 + 0.4 * woods_unit(woods_hash(hash, 9, 0, 0)));
}

static bool from_class(Plant *out, const WoodsSource *s, uint8_t surface, double x_m, double y_m, uint64_t hash)
{
    const WoodsClass *class = &s->table.of[woods_class_at(s, surface, x_m, y_m)];
    const double chance = class->per_m2 * cell_m * cell_m;
    const double u = woods_unit(woods_hash(hash, 7, 0, 0));
    if (!(u < 2 * chance) || !(u < chance * woods_density(s, x_m, y_m))) return false;
    woods_draw_of_class(out, s, class, x_m, y_m, hash);
    return true;
}

/* Adds what stands on the middle of a hedgerow, whose class is scrub. */
static bool add_hedge(SquarePlants *out, const WoodsSource *s, double x_m, double y_m)
{
    static const double spacing_m = 2;
    const double        low[2] = {floor(x_m / cell_m) * cell_m, floor(y_m / cell_m) * cell_m};
    const double        high[2] = {low[0] + cell_m, low[1] + cell_m};
    HedgePlace         *place = NULL;
    int                 count = 0;
    if (hypot(x_m - s->centre_m[0], y_m - s->centre_m[1]) > hedges_reach_m) return false;
    if (landscape_hedges(&place, &count, s->landscape, low, high, spacing_m) != STATUS_OK) {
        out->lost = true;
        return false;
    }
    for (int k = 0; k < count; k++) {
        const HedgePlace *h = &place[k];
        const uint64_t    hash = woods_hash(s->seed, llrint(16 * h->x_m), llrint(16 * h->y_m), 70);
        const double      u = woods_unit(woods_hash(hash, 1, 0, 0));
        const bool        tree = h->height == HEDGE_TREES && woods_unit(woods_hash(hash, 2, 0, 0)) < 0.12;
        const double      height_m = h->height == HEDGE_CUT ? 1.3 + 0.3 * u : 1.8 + 1.6 * u;
        uint8_t           bears;
        woods_bears(&bears, s, 1, &h->x_m, &h->y_m, 0, false);
        if (!bears) continue;
        if (tree) {
            static const double share[PLANT_STANDING] = {
                [PLANT_ALDER] = 0.3, [PLANT_BIRCH] = 0.2, [PLANT_ENGLISH_OAK] = 0.5};
            const PlantKind kind = kind_at(s, share, h->x_m, h->y_m, hash);
            woods_add_plant(out, s, woods_draw_plant(hash, kind, 6 + 9 * u, 1), h->x_m, h->y_m);
        } else {
            woods_add_plant(out, s,
                            woods_draw_plant(hash, h->height == HEDGE_CUT ? PLANT_HEDGE : PLANT_BUSH, height_m,
                                             clamp(1.5 / (height_m * 0.44), 0.6, 1.99)),
                            h->x_m, h->y_m);
        }
        out->from_hedges++;
    }
    free(place);
    return count > 0;
}

static void offer(Candidates *c, SquarePlants *out, const WoodsSource *s, int k)
{
    const double   x_m = c->x_m[k], y_m = c->y_m[k];
    const uint64_t hash = c->hash[k];
    const uint8_t  surface = c->surface[k];
    Plant          plant;
    bool           layers = false, stands;
    uint8_t        source = source_canopy;
    if (surface == SURFACE_SCRUB && add_hedge(out, s, x_m, y_m)) return;
    stands = from_canopy(&plant, &layers, s, surface, x_m, y_m, hash);
    if (!stands && !layers) {
        stands = from_class(&plant, s, surface, x_m, y_m, hash);
        source = source_class;
    }
    if (!stands || (plant_is_tree((PlantKind)plant.kind) && is_marked(s, x_m, y_m))) return;
    c->x_m[c->count] = x_m, c->y_m[c->count] = y_m;
    c->plant[c->count] = plant, c->source[c->count++] = source;
}

uint64_t woods_candidate(double *x_m, double *y_m, const WoodsSource *s, int i, int j, int k)
{
    const int64_t a = (s->i0 + i) * woods_side_cells + k % woods_side_cells,
                  b = (s->j0 + j) * woods_side_cells + k / woods_side_cells;
    const uint64_t hash = woods_hash(s->seed, a, b, 20);
    *x_m = ((double)a + 0.1 + 0.8 * woods_unit(woods_hash(hash, 1, 0, 0))) * cell_m;
    *y_m = ((double)b + 0.1 + 0.8 * woods_unit(woods_hash(hash, 2, 0, 0))) * cell_m;
    return hash;
}

void woods_fill_square(SquarePlants *out, const WoodsSource *s, int i, int j)
{
    Candidates c = {.count = 0};
    uint8_t    bears[square_cells];
    for (int k = 0; k < square_cells; k++) c.hash[k] = woods_candidate(&c.x_m[k], &c.y_m[k], s, i, j, k);
    landscape_surfaces(c.surface, s->landscape, square_cells, c.x_m, c.y_m);
    if (s->crowns.first) add_crowns(out, s, i, j);
    if (s->trees.first) add_trees(out, s, i, j);
    for (int k = 0; k < square_cells; k++) offer(&c, out, s, k);
    woods_bears(bears, s, c.count, c.x_m, c.y_m, 0.5, false);
    for (int k = 0; k < c.count; k++) {
        if (!bears[k]) continue;
        const int before = out->count;
        woods_add_plant(out, s, c.plant[k], c.x_m[k], c.y_m[k]);
        *(c.source[k] == source_class ? &out->from_classes : &out->from_canopy) += out->count - before;
    }
}
