/* tests/scenes/woods_stand.c: trees evenly over the ground, between the plants of its surface classes. */
#include "tests/scenes/woods_stand.h"

#include <stdlib.h>

int woods_stand_trees(const Woods *woods)
{
    int trees = 0;
    for (int k = 0; k < PLANT_TREES; k++) trees += woods->by_kind[k];
    return trees;
}

static bool bears_trees(const WoodsStand *s, double x_m, double y_m)
{
    const SurfaceClass surface = landscape_surface(s->landscape, x_m, y_m);
    for (int k = 0; k < s->clears; k++)
        if (hypot(x_m - s->clear[k].a_m[0], y_m - s->clear[k].a_m[1]) < s->clear[k].half_m) return false;
    return surface != SURFACE_NONE && surface != SURFACE_TRACK && surface != SURFACE_ROAD && surface != SURFACE_WATER;
}

typedef struct Adding {
    const WoodsStand *stand;
    Woods            *woods;
    Plant            *plant; /* [most] */
    size_t            count, most;
    double            due; /* trees by the area so far, less those that were added */
} Adding;

/* Of a square that is on the ground. */
static double share_m2(const Adding *a, const double corner_enu[2])
{
    const double size_m[2] = {a->stand->east_m, a->stand->north_m};
    double       share_m[2];
    for (int c = 0; c < 2; c++) {
        const double low_m = fmax(corner_enu[c], -0.5 * size_m[c] + 1);
        share_m[c] = fmax(0, fmin(corner_enu[c] + woods_square_m, 0.5 * size_m[c] - 1) - low_m);
    }
    return share_m[0] * share_m[1];
}

static void add_to_square(Adding *a, int square, const double corner_m[2])
{
    static const int tries = 4096;
    Woods           *w = a->woods;
    for (int k = 0; a->due >= 1 && k < tries && a->count < a->most; k++) {
        double u[8];
        for (int d = 0; d < 8; d++) u[d] = random_uniform(1, 9, (uint32_t)square, (uint64_t)(8 * k + d));
        const double at[2] = {corner_m[0] + u[0] * woods_square_m, corner_m[1] + u[1] * woods_square_m};
        const double x_m = w->origin_enu[0] + at[0], y_m = w->origin_enu[1] + at[1];
        if (!bears_trees(a->stand, x_m, y_m)) continue;
        const double z_m = elevation_height(&a->stand->landscape->elevation, x_m, y_m, NULL);
        if (!isfinite(z_m)) continue;
        Plant *plant = &a->plant[a->count++];
        *plant = (Plant){{(float)at[0], (float)at[1], (float)(z_m - w->origin_enu[2])},
                         (uint16_t)((10 + 15 * u[2]) / plant_height_step_m),
                         (uint16_t)(65535 * u[3]),
                         {(int8_t)(254 * u[4] - 127), (int8_t)(254 * u[5] - 127)},
                         (uint8_t)(PLANT_TREES * u[6]),
                         (uint8_t)(96 + 64 * u[7])};
        w->by_kind[plant->kind]++;
        a->due -= 1;
    }
}

static Status add_trees(Woods *woods, const WoodsStand *stand)
{
    const int    squares = woods->nx * woods->ny;
    const double more = fmax(0, stand->trees - stand->by_classes);
    Adding       a = {stand, woods, .most = (size_t)woods->count + (size_t)more + 1};
    if (!(a.plant = malloc(a.most * sizeof *a.plant))) return STATUS_NO_MEMORY;
    for (int q = 0; q < squares; q++) {
        const uint32_t first = woods->first[q], end = woods->first[q + 1];
        const double   corner_m[2] = {(q % woods->nx) * woods_square_m, (q / woods->nx) * woods_square_m};
        const double   corner_enu[2] = {woods->origin_enu[0] + corner_m[0], woods->origin_enu[1] + corner_m[1]};
        woods->first[q] = (uint32_t)a.count;
        for (uint32_t k = first; k < end && a.count < a.most; k++) a.plant[a.count++] = woods->plant[k];
        a.due += more * share_m2(&a, corner_enu) / (stand->east_m * stand->north_m);
        add_to_square(&a, q, corner_m);
    }
    free(woods->plant);
    woods->plant = a.plant;
    woods->first[squares] = (uint32_t)a.count;
    woods->count = (int)a.count;
    return STATUS_OK;
}

Status woods_stand_create(Woods *out, WoodsStand *stand, Pool *pool)
{
    const WoodsConfig config = {.seed = 1,
                                .half_width_m = fmax(50, 0.5 * fmax(stand->east_m, stand->north_m)),
                                .most_trees = stand->trees / 2,
                                .path_count = stand->clears,
                                .path = stand->clear};
    const double      start_s = wall_clock_s();
    Status            status = woods_create(out, stand->landscape, &config, pool);
    if (status != STATUS_OK) return status;
    stand->placing_s = wall_clock_s() - start_s;
    stand->by_classes = woods_stand_trees(out);
    status = add_trees(out, stand);
    if (status != STATUS_OK) woods_destroy(out);
    return status;
}
