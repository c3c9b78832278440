/* terrain/woods/woods_low.c: low plants and stones, a square of 8 m at a time.
 *
 * A lattice of 0.5 m with a candidate a cell; in fields with rows it is moved onto its row. */
#include "terrain/woods/woods_private.h"

#include "terrain/landscape/ways.h"

enum { low_side = 16, low_cells = low_side * low_side };
static const double low_cell_m = 0.5;

int woods_low_plants(Plant plant[woods_low_most], const Woods *woods, int64_t i, int64_t j)
{
    const WoodsSource *s = woods->low;
    double             x_m[low_cells], y_m[low_cells];
    uint8_t            surface[low_cells], kept_surface[low_cells], bears[low_cells];
    uint64_t           hash[low_cells], kept_hash[low_cells];
    int                count = 0, out = 0;
    /* the lattice is that of the ground: the woods' origin is a whole number of squares from the landscape's */
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
        const double      u = woods_unit(woods_hash(hash[k], 3, 0, 0));
        double            place[2] = {x_m[k], y_m[k]};
        if (class->floor == PLANT_KINDS || !(u < class->floor_per_m2 * low_cell_m * low_cell_m)) continue;
        if (class->floor == PLANT_CROP) landscape_row(place, s->landscape, (SurfaceClass)surface[k], x_m[k], y_m[k]);
        x_m[count] = place[0], y_m[count] = place[1];
        kept_surface[count] = surface[k], kept_hash[count++] = hash[k];
    }
    woods_bears(bears, s, count, x_m, y_m, -0.8, true);
    for (int k = 0; k < count; k++) {
        const WoodsClass *class = &s->table.of[kept_surface[k]];
        const double      z_m = elevation_height(&s->landscape->elevation, x_m[k], y_m[k], NULL);
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
