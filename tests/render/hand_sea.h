/* tests/render/hand_sea.h: a spherical sea of hand_world.h's world, an eye at 100 m, and ships on it. */
#ifndef TESTS_RENDER_HAND_SEA_H
#define TESTS_RENDER_HAND_SEA_H

#include "tests/render/hand_world.h"

static const double earth_m = 6371e3, eye_m = 100;
static const double tall_m = 30, low_m = 5, ship_half_m = 30,
                    boat_half_m = 3; /* the low one is smaller than what it is raised by */
static const double cell_m = 200, west_m = -8000, south_m = -4000;

static inline double sea_m(double x_m, double y_m) { return -(x_m * x_m + y_m * y_m) / (2 * earth_m); }

/* The sea, 16 km wide and 64 km long; posts are rounded to 1/128 m, and cells of 200 m are 0.8 mm below the sphere. */
static inline void lay_sea(Elevation *e)
{
    enum { columns = 81, rows = 341 };
    const ElevationGrid grid = {columns, rows, west_m, south_m, cell_m, -400, 1.0 / 128};
    elevation_destroy(e);
    memset(e, 0, sizeof *e);
    assert_int_equal(elevation_level_create(e, 0, &grid), STATUS_OK);
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i++)
            elevation_set_post(&e->level[0], i, j,
                               (uint16_t)lround(128 * (sea_m(west_m + i * cell_m, south_m + j * cell_m) + 400)));
    elevation_build_pyramids(e);
}

/* hand_open's world at sea level, with ships for its models: a tall one and a small one. */
static inline int open_sea(void **state)
{
    (void)state;
    char            path[text_file_size];
    LocalFrame      frame;
    Model           model;
    LandscapeConfig config = landscape_default_config();
    text_file(path, "type,model,origin\n1,tank,base\n2,missile,base\n");
    if (catalog_open(&hand.catalog, path, 0.01) != STATUS_OK) return -1;
    remove(path);
    for (int k = 0; k < 2; k++) {
        const double high_m = k == 0 ? tall_m : low_m, half_m = k == 0 ? ship_half_m : boat_half_m;
        hand_box(&model, (const double[3]){-half_m, -half_m, -high_m}, (const double[3]){half_m, half_m, 0});
        hand.model[k] = hand_replace(1 + k, &model);
    }
    config.half_width_m = 500, config.horizon_m = 20000;
    if (local_frame_at(&frame, &(Geodetic){0.6, -1.9, 0}) != STATUS_OK) return -1;
    if (landscape_create(&hand.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    lay_sea(&hand.landscape.elevation);
    if (world_open(&hand.world, hand.catalog, &hand.landscape, &frame, "avx2") != STATUS_OK) return -1;
    hand.arena = arena_create(), hand.air_arena = arena_create();
    const bool good = atmosphere_open(&hand.world.atmosphere, "us1976") == STATUS_OK;
    hand_air_off((const double[3]){0.6, 0, 0.8});
    return good && pool_create(&hand.pool, 2) == STATUS_OK ? 0 : -1;
}

static inline void put_ship(int model, double x_m, double y_m)
{
    static const double west[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1}; /* its sides to north and east; upright */
    double              r[9];
    memcpy(r, west, sizeof r);
    hand_attitude(r, 0, 0);
    hand_add(model, (const double[3]){x_m, y_m, sea_m(x_m, y_m)}, r);
}

#endif
