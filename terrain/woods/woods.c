/* terrain/woods/woods.c: all plants: squares of standing ones, and what of them is where; low plants and stones; and
 * where woods are that nothing stands of. */
#include "terrain/woods/woods_private.h"

#include "terrain/detail/detail.h"

#include <stdlib.h>

/* ---- low plants and stones, a square of 8 m at a time -------------------------------------------- */

/* Low plants: a lattice of 0.5 m with a candidate in each cell; in fields with rows it is moved onto its row. */
enum { low_side = 16, low_cells = low_side * low_side };
static const double low_cell_m = 0.5;

int woods_low_plants(Plant plant[woods_low_most], const Woods *woods, int64_t i, int64_t j)
{
    const WoodsSource *s = woods->low;
    double             x_m[low_cells], y_m[low_cells];
    uint8_t            surface[low_cells], kept_surface[low_cells], bears[low_cells];
    uint64_t           hash[low_cells], kept_hash[low_cells];
    int                count = 0, out = 0;
    /* the lattice belongs to the ground: the woods' origin is a whole number of squares from the landscape's */
    const int64_t per_square = (int64_t)(woods_square_m / woods_low_m);
    const int64_t a0 = (s->i0 * per_square + i) * low_side, b0 = (s->j0 * per_square + j) * low_side;
    for (int k = 0; k < low_cells; k++) {
        const int64_t a = a0 + k % low_side, b = b0 + k / low_side;
        hash[k] = woods_hash(s->seed, a, b, 80);
        x_m[k] = ((double)a + woods_unit(woods_hash(hash[k], 1, 0, 0))) * low_cell_m;
        y_m[k] = ((double)b + woods_unit(woods_hash(hash[k], 2, 0, 0))) * low_cell_m;
    }
    landscape_surfaces(surface, s->landscape, low_cells, x_m, y_m);
    for (int k = 0; k < low_cells; k++) {
        const WoodsClass *class = &s->table.of[surface[k]];
        const double u = woods_unit(woods_hash(hash[k], 3, 0, 0));
        double       place[2] = {x_m[k], y_m[k]};
        if (class->floor == PLANT_KINDS || !(u < class->floor_per_m2 * low_cell_m * low_cell_m)) continue;
        if (class->floor == PLANT_CROP) detail_row(place, s->landscape, (SurfaceClass)surface[k], x_m[k], y_m[k]);
        x_m[count] = place[0], y_m[count] = place[1];
        kept_surface[count] = surface[k], kept_hash[count++] = hash[k];
    }
    woods_bears(bears, s, count, x_m, y_m, -0.8, true);
    for (int k = 0; k < count; k++) {
        const WoodsClass *class = &s->table.of[kept_surface[k]];
        const double z_m = elevation_height(&s->landscape->elevation, x_m[k], y_m[k], NULL);
        if (!bears[k] || !isfinite(z_m)) continue;
        const double u = woods_unit(woods_hash(kept_hash[k], 4, 0, 0));
        const double height_m = class->floor_low_m + u * u * (class->floor_high_m - class->floor_low_m);
        Plant        p = woods_draw_plant(kept_hash[k], class->floor, height_m,
                                          0.8 + 0.5 * woods_unit(woods_hash(kept_hash[k], 5, 0, 0)));
        p.p_m[0] = (float)(x_m[k] - s->origin_enu[0] - (double)i * woods_low_m);
        p.p_m[1] = (float)(y_m[k] - s->origin_enu[1] - (double)j * woods_low_m);
        p.p_m[2] = (float)(z_m - s->origin_enu[2]);
        plant[out++] = p;
    }
    return out;
}

/* ---- where woods are that nothing stands of ------------------------------------------------------ */

bool woods_is_planted(const Woods *w, double x_m, double y_m)
{
    const double i = floor((x_m - w->origin_enu[0]) / woods_square_m),
                 j = floor((y_m - w->origin_enu[1]) / woods_square_m);
    if (!(i >= 0 && j >= 0 && i < w->nx && j < w->ny)) return false;
    return !w->bare || !w->bare[(size_t)j * (size_t)w->nx + (size_t)i];
}

static bool is_forest(SurfaceClass class)
{
    return class == SURFACE_FOREST_BROADLEAF || class == SURFACE_FOREST_CONIFER;
}

static bool can_bear(uint8_t surface)
{
    return surface != SURFACE_NONE && surface != SURFACE_WATER && surface != SURFACE_ROAD && surface != SURFACE_TRACK &&
           surface != SURFACE_SNOW;
}

void woods_not_standing(uint8_t *stand, float *cover, float *density, const Woods *woods, int count,
                        const uint8_t *surface, const double *x_m, const double *y_m)
{
    const WoodsSource *s = woods->low;
    for (int k = 0; k < count; k++) {
        double layer, height_m;
        stand[k] = SURFACE_NONE, cover[k] = -1, density[k] = 1;
        if (!can_bear(surface[k]) ||
            (!is_forest((SurfaceClass)surface[k]) && surface[k] != SURFACE_SCRUB && !s->has_store))
            continue;
        if (woods_is_planted(woods, x_m[k], y_m[k])) continue;
        if (woods_canopy_at(&layer, &height_m, s, x_m[k], y_m[k])) {
            if (!(layer > 0 && height_m >= 1)) continue;
            stand[k] = surface[k] == SURFACE_FOREST_CONIFER ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF;
            cover[k] = (float)layer;
        } else {
            const SurfaceClass class = woods_class_at(s, surface[k], x_m[k], y_m[k]);
            if (is_forest(class)) stand[k] = (uint8_t) class, density[k] = (float)woods_density(s, x_m[k], y_m[k]);
        }
        if (stand[k] &&
            (woods_is_cleared(&s->clearings, x_m[k], y_m[k], 0, false) || woods_is_built_on(s, x_m[k], y_m[k], false)))
            stand[k] = SURFACE_NONE;
    }
}

/* ---- a stand of one class --------------------------------------------------------------------- */

Status woods_of_class(Woods *out, SurfaceClass surface, double density, uint64_t seed, int squares)
{
    enum { cells = woods_side_cells * woods_side_cells };
    char         path[512];
    SquarePlants all = {0};
    const int    half = squares / 2;
    WoodsSource  s = {.seed = seed, .i0 = -half, .j0 = -half};
    Woods woods = {.nx = squares, .ny = squares, .origin_enu = {-half * woods_square_m, -half * woods_square_m, 0}};
    if (!etc_path(path, sizeof path, "woods.csv")) return STATUS_BAD_VALUE;
    const Status status = woods_table_read(&s.table, path);
    if (status != STATUS_OK) return status;
    const WoodsClass *class = &s.table.of[surface];
    memcpy(s.origin_enu, woods.origin_enu, sizeof s.origin_enu);
    woods.first = calloc((size_t)squares * (size_t)squares + 1, sizeof *woods.first);
    if (!woods.first) return STATUS_NO_MEMORY;
    for (int n = 0; n < squares * squares; n++) {
        woods.first[n] = (uint32_t)all.count;
        for (int k = 0; k < cells; k++) {
            double         x_m, y_m, far_m[2]; /* far_m: another random place for each plant, whose groves it takes */
            Plant          plant;
            const uint64_t hash = woods_candidate(&x_m, &y_m, &s, n % squares, n / squares, k);
            if (!(woods_unit(woods_hash(hash, 7, 0, 0)) < density * class->per_m2 * woods_cell_m * woods_cell_m))
                continue;
            for (int c = 0; c < 2; c++) far_m[c] = 1e6 * woods_unit(woods_hash(hash, c, 0, 90));
            woods_draw_of_class(&plant, &s, class, far_m[0], far_m[1], hash);
            woods_add_plant(&all, &s, plant, x_m, y_m);
        }
    }
    woods.first[squares * squares] = (uint32_t)all.count;
    woods.plant = all.plant, woods.count = all.count;
    for (int k = 0; k < all.count; k++) woods.by_kind[all.plant[k].kind]++;
    if (all.lost || !all.plant) {
        woods_destroy(&woods);
        return STATUS_NO_MEMORY;
    }
    *out = woods;
    return STATUS_OK;
}

/* ---- sources ---------------------------------------------------------------------------------- */

void woods_source_free(WoodsSource *s)
{
    if (!s) return;
    woods_clearings_free(&s->clearings);
    free(s->crowns.first), free(s->crowns.item), free(s->trees.first), free(s->trees.item);
    if (s->has_store) store_close(&s->store);
    free(s);
}

/* Lists `count` places by squares. */
static Status sort_places(WoodsCrowns *c, const WoodsSource *s, size_t count,
                          void (*place)(double p_m[2], const void *of, size_t k), const void *of)
{
    const size_t squares = (size_t)s->nx * (size_t)s->ny;
    c->first = calloc(squares + 2, sizeof *c->first);
    c->item = calloc(count, sizeof *c->item);
    if (!c->first || !c->item) return STATUS_NO_MEMORY;
    for (int k = 0; k < 2; k++) c->low[k] = INFINITY, c->high[k] = -INFINITY;
    for (int put = 0; put < 2; put++) { /* counts at first[2 ..], then sums, then places */
        for (size_t q = 1; put && q <= squares; q++) c->first[q + 1] += c->first[q];
        for (size_t k = 0; k < count; k++) {
            double p[2];
            place(p, of, k);
            const double i = floor(p[0] / woods_square_m) - (double)s->i0;
            const double j = floor(p[1] / woods_square_m) - (double)s->j0;
            for (int a = 0; a < 2; a++) c->low[a] = fmin(c->low[a], p[a]), c->high[a] = fmax(c->high[a], p[a]);
            if (!(i >= 0 && j >= 0 && i < s->nx && j < s->ny)) continue;
            const size_t n = (size_t)j * (size_t)s->nx + (size_t)i;
            if (put) c->item[c->first[n + 1]++] = (uint32_t)k;
            else c->first[n + 2]++;
        }
    }
    return STATUS_OK;
}

static void crown_place(double p_m[2], const void *of, size_t k)
{
    const Crown *crown = of;
    p_m[0] = (double)crown[k].x_m, p_m[1] = (double)crown[k].y_m;
}

static void tree_place(double p_m[2], const void *of, size_t k)
{
    const CultureTree *tree = of;
    p_m[0] = tree[k].x_m, p_m[1] = tree[k].y_m;
}

static Status sort_trees(WoodsSource *s)
{
    Status status = STATUS_OK;
    if (s->has_store && s->store.crown_count > 0)
        status = sort_places(&s->crowns, s, s->store.crown_count, crown_place, s->store.crown);
    if (status == STATUS_OK && s->culture && s->culture->trees > 0)
        status = sort_places(&s->trees, s, (size_t)s->culture->trees, tree_place, s->culture->tree);
    return status;
}

Status woods_source_open(WoodsSource **out, const Landscape *landscape, const WoodsConfig *config, double half_width_m)
{
    char         path[512];
    WoodsSource *s = calloc(1, sizeof *s);
    Status       status = STATUS_OK;
    if (!s) return STATUS_NO_MEMORY;
    s->seed = config->seed, s->landscape = landscape, s->culture = config->culture;
    s->synthetic = landscape_is_synthetic(landscape);
    double end[2];
    for (int k = 0; k < 2; k++) {
        s->centre_m[k] = config->centre_m[k];
        end[k] = ceil((config->centre_m[k] + half_width_m) / woods_square_m);
    }
    s->i0 = (int64_t)floor((config->centre_m[0] - half_width_m) / woods_square_m);
    s->j0 = (int64_t)floor((config->centre_m[1] - half_width_m) / woods_square_m);
    s->nx = (int)(end[0] - (double)s->i0), s->ny = (int)(end[1] - (double)s->j0);
    s->origin_enu[0] = (double)s->i0 * woods_square_m, s->origin_enu[1] = (double)s->j0 * woods_square_m;
    const double z_m = elevation_height(&landscape->elevation, config->centre_m[0], config->centre_m[1], NULL);
    s->origin_enu[2] = isfinite(z_m) ? rint(z_m) : 0;
    if (!etc_path(path, sizeof path, "woods.csv")) {
        log_error("woods: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) status = woods_table_read(&s->table, path);
    if (status == STATUS_OK && config->store && *config->store) {
        status = store_open(&s->store, config->store);
        s->has_store = status == STATUS_OK;
    }
    if (status == STATUS_OK) status = sort_trees(s);
    if (status == STATUS_OK) status = woods_clearings_create(&s->clearings, s, config);
    if (status != STATUS_OK) {
        woods_source_free(s);
        return status;
    }
    *out = s;
    return STATUS_OK;
}

/* ---- squares ---------------------------------------------------------------------------------- */

typedef struct Filling {
    const WoodsSource *source;
    SquarePlants      *square; /* [nx * ny] */
} Filling;

static void fill_row(void *user, int worker, int j)
{
    Filling *f = user;
    (void)worker;
    for (int i = 0; i < f->source->nx; i++)
        woods_fill_square(&f->square[(size_t)j * (size_t)f->source->nx + (size_t)i], f->source, i, j);
}

static Status gather(Woods *out, const WoodsSource *s, const SquarePlants *square)
{
    const size_t squares = (size_t)s->nx * (size_t)s->ny;
    size_t       all = 0;
    for (size_t n = 0; n < squares; n++) all += (size_t)square[n].count;
    out->first = malloc((squares + 1) * sizeof *out->first);
    out->plant = malloc((all + 1) * sizeof *out->plant);
    if (!out->first || !out->plant) return STATUS_NO_MEMORY;
    all = 0;
    for (size_t n = 0; n < squares; n++) {
        const SquarePlants *one = &square[n];
        out->first[n] = (uint32_t)all;
        if (one->count == 0) continue;
        memcpy(out->plant + all, one->plant, (size_t)one->count * sizeof *one->plant);
        for (int k = 0; k < one->count; k++) out->by_kind[one->plant[k].kind]++;
        all += (size_t)one->count;
        out->from_crowns += one->from_crowns, out->from_canopy += one->from_canopy;
        out->from_classes += one->from_classes, out->from_hedges += one->from_hedges;
    }
    out->first[squares] = (uint32_t)all;
    out->count = (int)all;
    return STATUS_OK;
}

static bool config_is_good(const WoodsConfig *c)
{
    bool good = c->half_width_m >= 50 && c->half_width_m <= 50000 && c->most_trees >= 0 &&
                c->most_trees <= woods_most_trees && c->path_count >= 0 && c->place_count >= 0 && c->far_half_m >= 0 &&
                c->far_half_m <= 50000;
    for (int k = 0; k < 2; k++) good = good && fabs(c->centre_m[k]) < 1e6;
    for (int n = 0; good && n < c->place_count; n++)
        good = fabs(c->place[n].p_m[0]) < 1e7 && fabs(c->place[n].p_m[1]) < 1e7;
    for (int n = 0; good && n < c->path_count; n++)
        for (int k = 0; k < 2; k++)
            good = good && fabs(c->path[n].a_m[k]) < 1e7 && fabs(c->path[n].b_m[k]) < 1e7 && c->path[n].half_m >= 0 &&
                   c->path[n].half_m < 1e4 && c->path[n].low_half_m >= 0 && c->path[n].low_half_m <= c->path[n].half_m;
    if (!good) log_error("woods: centre, half width, number of trees, a place or a path is out of range");
    return good;
}

CacheKey woods_key(const char *what, const WoodsConfig *c)
{
    CacheKey       key = cache_key(what);
    const double   number[] = {c->centre_m[0], c->centre_m[1], c->half_width_m};
    const uint64_t whole[] = {c->seed, (uint64_t)c->most_trees, (uint64_t)c->path_count, (uint64_t)c->place_count};
    cache_key_add(&key, number, sizeof number);
    cache_key_add(&key, whole, sizeof whole);
    _Static_assert(sizeof *c->path == 6 * sizeof(double) && sizeof *c->place == 2 * sizeof(double), "no padding");
    cache_key_add(&key, c->path, (size_t)c->path_count * sizeof *c->path);
    cache_key_add(&key, c->place, (size_t)c->place_count * sizeof *c->place);
    cache_key_add(&key, c->follows, strlen(c->follows));
    culture_key_add(&key, c->culture);
    return key;
}

/* Places the plants of all squares. */
static Status place(Woods *out, WoodsSource *source, const WoodsConfig *config, Pool *pool)
{
    const size_t squares = (size_t)source->nx * (size_t)source->ny;
    Filling      filling = {source, calloc(squares, sizeof *filling.square)};
    Status       status = STATUS_OK;
    if (!filling.square) return STATUS_NO_MEMORY;
    if (pool) pool_run(pool, source->ny, fill_row, &filling);
    else
        for (int j = 0; j < source->ny; j++) fill_row(&filling, 0, j);
    for (size_t n = 0; n < squares; n++)
        if (filling.square[n].lost) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = woods_keep_nearest(out, source, filling.square, config);
    if (status == STATUS_OK) status = gather(out, source, filling.square);
    for (size_t n = 0; n < squares; n++) free(filling.square[n].plant);
    free(filling.square);
    return status;
}

/* Takes the plants from the cache; else places and keeps them. */
static Status need(Woods *out, WoodsSource *source, const WoodsConfig *config, Pool *pool)
{
    if (!config->cache || !config->follows) return place(out, source, config, pool);
    CacheKey    key = woods_key("woods", config);
    void       *octets;
    size_t      count;
    const Woods empty = *out;
    if (cache_fetch(&octets, &count, config->cache, &key)) {
        const Status status = woods_from_octets(out, octets, count);
        free(octets);
        if (status != STATUS_BAD_VALUE) return status;
        free(out->first), free(out->plant), free(out->bare);
        *out = empty;
    }
    const Status status = place(out, source, config, pool);
    count = status == STATUS_OK ? woods_to_octets(NULL, out) : 0;
    octets = count > 0 ? malloc(count) : NULL;
    if (octets) {
        woods_to_octets(octets, out);
        cache_keep(config->cache, &key, octets, count);
    }
    free(octets);
    return status;
}

Status woods_create(Woods *out, const Landscape *landscape, const WoodsConfig *config, Pool *pool)
{
    WoodsSource *source = NULL;
    Woods        woods = {.landscape = landscape};
    if (!config_is_good(config)) return STATUS_BAD_VALUE;
    Status status = woods_source_open(&source, landscape, config, config->half_width_m);
    if (status != STATUS_OK) return status;
    memcpy(woods.origin_enu, source->origin_enu, sizeof woods.origin_enu);
    for (int n = 0; config->culture && n < config->culture->trees; n++)
        woods.marked += config->culture->tree[n].mark != 0;
    woods.nx = source->nx, woods.ny = source->ny;
    status = need(&woods, source, config, pool);
    woods.low = source;
    if (status == STATUS_OK) status = woods_pages_open(&woods, config);
    if (status != STATUS_OK) {
        woods_destroy(&woods);
        return status;
    }
    *out = woods;
    return STATUS_OK;
}

void woods_destroy(Woods *woods)
{
    free(woods->first), free(woods->plant), free(woods->bare);
    woods_source_free(woods->low);
    woods_pages_close(woods);
    memset(woods, 0, sizeof *woods);
}

/* ---- queries ---------------------------------------------------------------------------------- */

double woods_trunk_m(const Plant *plant)
{
    /* as a share of the height, as in the prototypes: 1 to 3 hundredths (render/trace/plants/plants_grow.c) */
    static const double share[PLANT_TREES] = {0.016, 0.014, 0.011, 0.028, 0.024, 0.024, 0.030};
    return plant_is_tree((PlantKind)plant->kind) ? share[plant->kind] * plant_height_m(plant) * plant->width / 128 : 0;
}

int woods_near(int *index, int most, const Woods *woods, double x_m, double y_m, double radius_m)
{
    static const double widest_m = 2; /* trunk */
    int                 found = 0;
    const double        x = x_m - woods->origin_enu[0], y = y_m - woods->origin_enu[1], reach_m = radius_m + widest_m;
    const double        from_i = clamp(floor((x - reach_m) / woods_square_m), 0, woods->nx);
    const double        from_j = clamp(floor((y - reach_m) / woods_square_m), 0, woods->ny);
    const double        end_i = clamp(floor((x + reach_m) / woods_square_m) + 1, 0, woods->nx);
    const double        end_j = clamp(floor((y + reach_m) / woods_square_m) + 1, 0, woods->ny);
    for (int j = (int)from_j; j < (int)end_j; j++)
        for (int i = (int)from_i; i < (int)end_i; i++) {
            const size_t n = (size_t)j * (size_t)woods->nx + (size_t)i;
            for (uint32_t k = woods->first[n]; k < woods->first[n + 1]; k++) {
                const Plant *p = &woods->plant[k];
                const double trunk_m = woods_trunk_m(p);
                if (!(trunk_m > 0) || hypot((double)p->p_m[0] - x, (double)p->p_m[1] - y) > radius_m + trunk_m)
                    continue;
                if (found < most) index[found] = (int)k;
                found++;
            }
        }
    return found;
}
