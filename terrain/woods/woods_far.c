/* terrain/woods/woods_far.c: where woods are that nothing stands of, and a stand of one class to learn from. */
#include "terrain/woods/woods_private.h"

#include <stdlib.h>

/* ---- where ------------------------------------------------------------------------------------ */

static bool is_planted(const Woods *w, double x_m, double y_m)
{
    const double i = floor((x_m - w->origin_enu[0]) / woods_square_m), j = floor((y_m - w->origin_enu[1]) / woods_square_m);
    if (!(i >= 0 && j >= 0 && i < w->nx && j < w->ny)) return false;
    return !w->bare || !w->bare[(size_t)j * (size_t)w->nx + (size_t)i];
}

static bool is_forest(SurfaceClass class) { return class == SURFACE_FOREST_BROADLEAF || class == SURFACE_FOREST_CONIFER; }

static bool can_bear(uint8_t surface)
{
    return surface != SURFACE_NONE && surface != SURFACE_WATER && surface != SURFACE_ROAD && surface != SURFACE_TRACK &&
           surface != SURFACE_SNOW;
}

void woods_not_standing(uint8_t *stand, float *cover, float *density, const Woods *woods, int count, const uint8_t *surface,
                        const double *x_m, const double *y_m)
{
    const WoodsSource *s = woods->low;
    for (int k = 0; k < count; k++) {
        double layer, height_m;
        stand[k] = SURFACE_NONE, cover[k] = -1, density[k] = 1;
        if (!can_bear(surface[k]) || (!is_forest((SurfaceClass)surface[k]) && surface[k] != SURFACE_SCRUB && !s->has_store))
            continue;
        if (is_planted(woods, x_m[k], y_m[k])) continue;
        if (woods_canopy_at(&layer, &height_m, s, x_m[k], y_m[k])) {
            if (!(layer > 0 && height_m >= 1)) continue;
            stand[k] = surface[k] == SURFACE_FOREST_CONIFER ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF;
            cover[k] = (float)layer;
        } else {
            const SurfaceClass class = woods_class_at(s, surface[k], x_m[k], y_m[k]);
            if (is_forest(class)) stand[k] = (uint8_t)class, density[k] = (float)woods_density(s, x_m[k], y_m[k]);
        }
        if (stand[k] && woods_is_cleared(&s->clearings, x_m[k], y_m[k], 0, false)) stand[k] = SURFACE_NONE;
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
    Woods        woods = {.nx = squares, .ny = squares, .origin_enu = {-half * woods_square_m, -half * woods_square_m, 0}};
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
            double         x_m, y_m, far_m[2]; /* far: where groves are others for each plant */
            Plant          plant;
            const uint64_t hash = woods_candidate(&x_m, &y_m, &s, n % squares, n / squares, k);
            if (!(woods_unit(woods_hash(hash, 7, 0, 0)) < density * class->per_m2 * woods_cell_m * woods_cell_m)) continue;
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
