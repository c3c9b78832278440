/* render/ground/ground_clear.c: proves that a bundle of rays is clear of the ground: in pieces along it, each twice
 * as long as the last, the lowest point of the piece is compared with the highest posts under it. */
#include "render/ground/ground_private.h"

/* Margin above the posts: rounding of coordinates of 1e6 m is 1e-9 of it, on the steepest ground. */
static const double clear_m = 1e-3;
static const double beside_cells = 1e-3;

enum { pieces = 40 };

/* Whether no post of a level within x0 .. x1, y0 .. y1 is as high as low_m. */
static bool level_is_below(const GroundLevel *g, double low_m, const double low[2], const double high[2])
{
    const double most[2] = {g->cells_x - 1, g->cells_y - 1}, corner[2] = {g->x0_m, g->y0_m};
    double       from[2], to[2];
    for (int c = 0; c < 2; c++) {
        from[c] = floor((low[c] - corner[c]) * g->cells_per_m - beside_cells);
        to[c]   = floor((high[c] - corner[c]) * g->cells_per_m + beside_cells);
        if (to[c] < 0 || from[c] > most[c] + 1) return true; /* beside it */
        from[c] = clamp(from[c], 0, most[c]);
        to[c]   = clamp(to[c], 0, most[c]);
    }
    const double span = fmax(to[0] - from[0], to[1] - from[1]), post = (low_m - clear_m - g->z0_m) * g->posts_per_m;
    int          k = span > 2 ? elevation_pyramid_first : 0;
    while (k > 0 && k < g->top && (2 << k) < span) k++;
    for (int j = (int)from[1] >> k; j <= (int)to[1] >> k; j++)
        for (int i = (int)from[0] >> k; i <= (int)to[0] >> k; i++)
            if (!((k > 0 ? ground_highest(g, k, i, j) : ground_cell_highest(g, i, j)) < post)) return false;
    return true;
}

bool ground_is_clear(const Ground *ground, const double from[2][3], const double to[2][3])
{
    if (ground->level_count == 0) return true;
    const GroundLevel *all = &ground->level[ground->level_count - 1];
    const double       cells[2] = {all->cells_x, all->cells_y}, corner[2] = {all->x0_m, all->y0_m};
    double             length_m = 0, size_m = 0;
    for (int c = 0; c < 2; c++) {
        if (!((from[0][c] - corner[c]) * all->cells_per_m > 0 && (from[1][c] - corner[c]) * all->cells_per_m < cells[c]))
            return false; /* it could enter from the side */
        length_m = fmax(length_m, fmax(fabs(to[0][c] - from[0][c]), fabs(to[1][c] - from[1][c])));
        size_m   = fmax(size_m, from[1][c] - from[0][c]);
    }
    const double first_m = fmax(0.5 * size_m, 1 / ground->level[0].cells_per_m);
    double       share = 0, step = first_m < length_m ? first_m / length_m : 1;
    for (int n = 0; n < pieces; n++, step *= 2) {
        const double end = share + step < 1 ? share + step : 1;
        double       low[3], high[3];
        for (int c = 0; c < 3; c++) {
            low[c]  = from[0][c] + fmin(share * (to[0][c] - from[0][c]), end * (to[0][c] - from[0][c]));
            high[c] = from[1][c] + fmax(share * (to[1][c] - from[1][c]), end * (to[1][c] - from[1][c]));
        }
        for (int k = 0; k < ground->level_count; k++)
            if (!level_is_below(&ground->level[k], low[2], low, high)) return false;
        if (end >= 1) return true;
        share = end;
    }
    return false;
}

bool ground_is_clear_towards(const Ground *ground, const double from[2][3], const double d_enu[3])
{
    double top_m = -INFINITY, to[2][3];
    if (!(d_enu[2] > 1e-3)) return ground->level_count == 0;
    for (int k = 0; k < ground->level_count; k++) {
        const GroundLevel *g = &ground->level[k];
        top_m = fmax(top_m, g->z0_m + g->highest / g->posts_per_m);
    }
    const double far_m = fmax(top_m + 2 * clear_m - from[0][2], 0) / d_enu[2];
    for (int side = 0; side < 2; side++) v3_add_scaled(to[side], from[side], far_m, d_enu);
    return ground_is_clear(ground, from, to);
}
