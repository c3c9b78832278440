/* Shadows over the day on a grid: the length of a ridge's shadow by its height and the sun's, at any azimuth; what an
 * even stand lets through by Beer's law; the ground's own slopes; bounds. */
#include "tests/check.h"
#include "render/heat/heat.h"

enum { posts = 201 };
static const double spacing_m = 8;
static Elevation    ground;

/* Flat, but for a ridge of high_m that stands where x is within half a post of 0. */
static void ridge(double high_m)
{
    elevation_destroy(&ground);
    ground = (Elevation){0};
    CHECK(elevation_level_create(&ground, 0, &(ElevationGrid){posts, posts, -800, -800, spacing_m, -100, 1.0 / 64}) ==
          STATUS_OK);
    for (int t = 0; t < ground.level[0].tiles_x * ground.level[0].tiles_y; t++)
        ground.level[0].tile[t] = (ElevationTile){0, 0};
    ground.level[0].plain = true;
    for (int j = 0; j < posts; j++)
        for (int i = 0; i < posts; i++)
            elevation_set_post(&ground.level[0], i, j, (int32_t)(64 * (100 + (i == posts / 2 ? high_m : 0))));
    elevation_build_pyramids(&ground);
}

static void slot(float d[3][shadow_most_slots], int s, double azimuth_deg, double high_deg)
{
    const double a = azimuth_deg * rad_per_deg, h = high_deg * rad_per_deg;
    d[0][s] = (float)(sin(a) * cos(h)), d[1][s] = (float)(cos(a) * cos(h)), d[2][s] = (float)sin(h);
}

static void length_of_a_shadow(void **state)
{
    (void)state;
    static const double azimuth[] = {90, 90, 60, 120, 270, 135}, high[] = {20, 45, 20, 30, 15, 25};
    float               d[3][shadow_most_slots] = {{0}};
    ShadowMap          *map;
    Pool               *pool;
    ridge(40);
    for (int s = 0; s < 6; s++) slot(d, s, azimuth[s], high[s]);
    CHECK(pool_create(&pool, 2) == STATUS_OK);
    CHECK(heat_shadow_create(&map, &(ShadowOf){.elevation = &ground, .cell_m = 8, .slots = 6, .d_enu = d}, pool) ==
          STATUS_OK);
    for (int s = 0; s < 6; s++) {
        /* across the ridge */
        const double reach_m = 40 / tan(high[s] * rad_per_deg) * fabs(sin(azimuth[s] * rad_per_deg));
        const double away = azimuth[s] < 180 ? -1 : 1;
        uint8_t      shadow[shadow_most_slots];
        double       open, shaded_m = 0;
        for (double x = 12; x < 400; x += 2) {
            heat_shadow_at(shadow, &open, map, away * x, 0);
            shaded_m += 2 * shadow[s] / 255.0;
            CHECK(open == 1);
        }
        heat_shadow_at(shadow, &open, map, -away * 40, 0);
        CHECK(shadow[s] == 0);
        print_message("sun %g, %g degrees up: shaded to %.0f m, %.0f m by its height\n", azimuth[s], high[s],
                      12 + shaded_m, reach_m);
        CHECK_NEAR(12 + shaded_m, reach_m, 8);
    }
    uint8_t shadow[shadow_most_slots];
    double  open;
    heat_shadow_at(shadow, &open, map, 5000, 0);
    CHECK(shadow[0] == 0 && shadow[5] == 0 && open == 1);
    heat_shadow_at(shadow, &open, map, NAN, 0);
    CHECK(shadow[0] == 0 && open == 1);
    heat_shadow_destroy(map);
    pool_destroy(pool);
}

/* Rows of cells away from a ridge of 40 m, n cells of 8 m from its crest: the edge of the shadow falls from cell to
 * cell by 8 m times the way between rows over the one along their axis, times the tangent of the sun's height; a cell
 * goes from lit to shaded over 8 m times that tangent. The ridge stands across x, then across y. */
static void cells_behind_a_ridge(void **state)
{
    (void)state;
    static const struct {
        double azimuth, high;
        bool   across_x;
    } c[] = {{90, 35, true}, {270, 35, true},  {60, 25, true},  {120, 41, true},  {300, 30, true},  {240, 20, true},
             {0, 35, false}, {180, 35, false}, {30, 25, false}, {330, 30, false}, {150, 20, false}, {210, 41, false}};
    for (int across_x = 0; across_x < 2; across_x++) {
        float      d[3][shadow_most_slots] = {{0}};
        ShadowMap *map;
        ridge(across_x ? 40 : 0);
        if (!across_x) {
            for (int i = 0; i < posts; i++) elevation_set_post(&ground.level[0], i, posts / 2, 64 * 140);
            elevation_build_pyramids(&ground);
        }
        for (int s = 0; s < 12; s++) slot(d, s, c[s].azimuth, c[s].high);
        CHECK(heat_shadow_create(&map, &(ShadowOf){.elevation = &ground, .cell_m = 8, .slots = 12, .d_enu = d}, NULL) ==
              STATUS_OK);
        for (int s = 0; s < 12; s++) {
            if (c[s].across_x != across_x) continue;
            const double x = (double)d[0][s], y = (double)d[1][s], tangent = (double)d[2][s] / hypot(x, y);
            const double along = across_x ? x : y, side = across_x ? y : x, away = along > 0 ? -1 : 1;
            for (int n = 1; n < 30; n++) {
                uint8_t      shadow[shadow_most_slots];
                double       open, edge_m = 40 - n * 8 * hypot(1, side / along) * tangent;
                const double lit = clamp(0.5 - edge_m / (8 * tangent), 0, 1);
                heat_shadow_at(shadow, &open, map, across_x ? away * 8 * n : 24, across_x ? 24 : away * 8 * n);
                CHECK_NEAR(shadow[s], 255 * (1 - lit), 0.6);
                if (n > 1) continue;
                heat_shadow_at(shadow, &open, map, across_x ? -away * 8 : 24, across_x ? 24 : -away * 8);
                CHECK(shadow[s] == (c[s].high > 78 ? 1 : 0)); /* the slope that faces the sun */
            }
        }
        heat_shadow_destroy(map);
    }
}

static void even_stand(ShadowStand *out, const void *user, double x_m, double y_m)
{
    (void)user, (void)y_m;
    *out = x_m < 0 ? (ShadowStand){3, 4, 20, 0.2f} : (ShadowStand){0, 0, 0, 1};
}

static void light_below_a_stand(void **state)
{
    (void)state;
    float      d[3][shadow_most_slots] = {{0}};
    ShadowMap *map;
    ridge(0);
    slot(d, 0, 90, 50);
    slot(d, 1, 270, 30);
    slot(d, 2, 180, 90);
    CHECK(heat_shadow_create(
              &map, &(ShadowOf){.elevation = &ground, .cell_m = 8, .slots = 3, .d_enu = d, .plants = even_stand},
              NULL) == STATUS_OK);
    uint8_t shadow[shadow_most_slots];
    double  open;
    heat_shadow_at(shadow, &open, map, -300, 40);
    for (int s = 0; s < 3; s++) CHECK_NEAR(1 - shadow[s] / 255.0, exp(-0.5 * 3 / (double)d[2][s]), 0.0025);
    CHECK_NEAR(open, 0.2, 1e-6);
    heat_shadow_at(shadow, &open, map, 300, 40);
    CHECK(shadow[0] == 0 && shadow[1] == 0 && open == 1);
    /* beside it: the sun in the west shines through, and below the crowns */
    heat_shadow_at(shadow, &open, map, 16, 0);
    CHECK(shadow[1] > 100 && shadow[0] == 0);
    heat_shadow_at(shadow, &open, map, 20 / tan(30 * rad_per_deg) + 20, 0);
    CHECK(shadow[1] == 0);
    heat_shadow_destroy(map);
    /* leaves that are clumped for a low sun, more for one overhead: each slot by its own factor */
    const float clumped[3] = {0.6f, 0.9f, 0.4f};
    CHECK(heat_shadow_create(
              &map,
              &(ShadowOf){
                  .elevation = &ground, .cell_m = 8, .slots = 3, .d_enu = d, .plants = even_stand, .clumped = clumped},
              NULL) == STATUS_OK);
    heat_shadow_at(shadow, &open, map, -300, 40);
    for (int s = 0; s < 3; s++)
        CHECK_NEAR(1 - shadow[s] / 255.0, exp(-0.5 * 3 * (double)clumped[s] / (double)d[2][s]), 0.0025);
    heat_shadow_destroy(map);
}

static void one_column(ShadowStand *out, const void *user, double x_m, double y_m)
{
    const bool here = *(const bool *)user ? fabs(x_m) < 4 : fabs(y_m) < 4;
    *out = here ? (ShadowStand){3, 0, 16, 1} : (ShadowStand){0, 0, 0, 1};
}

/* One column of cells of 8 m with plants of 16 m, leaf area 3 evenly from the ground up; the sun 40 degrees up behind
 * it, on the slant. The ray to the sun is asked at the middles of lengths of a cell's width, by the nearest cell: what
 * lies in such a length, which rises by 8 m times the tangent, is 3 rise / 16 of leaf area, times 0.5 / sin. */
static void light_through_one_column(void **state)
{
    (void)state;
    static const double azimuth[2][2] = {{70, 250}, {20, 200}};
    for (int c = 0; c < 4; c++) {
        float      d[3][shadow_most_slots] = {{0}};
        ShadowMap *map;
        const bool in_x = c < 2;
        int        shaded = 0;
        ridge(0);
        slot(d, 0, azimuth[!in_x][c % 2], 40);
        CHECK(heat_shadow_create(
                  &map,
                  &(ShadowOf){
                      .elevation = &ground, .cell_m = 8, .slots = 1, .d_enu = d, .plants = one_column, .user = &in_x},
                  NULL) == STATUS_OK);
        const double up = (double)d[2][0], level = hypot((double)d[0][0], (double)d[1][0]),
                     step = (double)d[in_x ? 0 : 1][0] / level, rise_m = 8 * up / level;
        for (int cell = -5; cell <= 5; cell++) {
            uint8_t shadow[shadow_most_slots];
            double  open, depth = 0;
            for (int k = 0; k * rise_m < 16; k++)
                if (fabs(cell + (k + 0.5) * step) < 0.5) depth += 0.5 * 3 / 16 * fmin(rise_m, 16 - k * rise_m) / up;
            heat_shadow_at(shadow, &open, map, in_x ? 8 * cell : 24, in_x ? 24 : 8 * cell);
            CHECK_NEAR(shadow[0], 255 * (1 - exp(-depth)), 0.6);
            shaded += shadow[0] > 0;
        }
        CHECK(shaded == 2 || shaded == 3);
        heat_shadow_destroy(map);
    }
}

static void large_terrain_has_larger_cells(void **state)
{
    (void)state;
    float      d[3][shadow_most_slots] = {{0}};
    ShadowMap *map;
    ridge(5);
    slot(d, 0, 90, 50);
    CHECK(heat_shadow_create(&map, &(ShadowOf){.elevation = &ground, .cell_m = 0.5, .slots = 1, .d_enu = d}, NULL) ==
          STATUS_OK);
    CHECK(heat_shadow_cell_m(map) == 1 && heat_shadow_bytes(map) < 9 * (size_t)shadow_most_cells);
    heat_shadow_destroy(map);
    CHECK(heat_shadow_create(&map, &(ShadowOf){.elevation = &ground, .cell_m = 0, .slots = 1, .d_enu = d}, NULL) ==
          STATUS_BAD_VALUE);
    CHECK(heat_shadow_create(&map, &(ShadowOf){.elevation = &(Elevation){0}, .cell_m = 8, .slots = 1, .d_enu = d},
                             NULL) == STATUS_BAD_VALUE);
    elevation_destroy(&ground);
}

/* Between four cells the shares of each slot, by sixteenths of a cell, rounded to the nearest of 255. */
static void places_between_cells(void **state)
{
    (void)state;
    enum { slots = 11 };
    float      d[3][shadow_most_slots] = {{0}};
    ShadowMap *map;
    double     open;
    int        mixed = 0;
    ridge(40);
    for (int s = 0; s < slots; s++) slot(d, s, 60 + 20 * s, 9 + 4 * s);
    CHECK(heat_shadow_create(&map, &(ShadowOf){.elevation = &ground, .cell_m = 8, .slots = slots, .d_enu = d}, NULL) ==
          STATUS_OK);
    for (int i = -30; i < 30; i++) {
        uint8_t corner[4][shadow_most_slots], found[shadow_most_slots];
        for (int k = 0; k < 4; k++) heat_shadow_at(corner[k], &open, map, 8 * (i + (k & 1)), 8 * (k >> 1));
        for (unsigned u = 0; u < 16; u += 3)
            for (unsigned v = 0; v < 16; v += 5) {
                const unsigned w[4] = {(16 - u) * (16 - v), u * (16 - v), (16 - u) * v, u * v};
                heat_shadow_at(found, &open, map, 8 * i + 0.5 * u, 0.5 * v);
                for (int s = 0; s < slots; s++) {
                    const double sum =
                        w[0] * corner[0][s] + w[1] * corner[1][s] + w[2] * corner[2][s] + w[3] * corner[3][s];
                    CHECK(found[s] == (unsigned)floor(sum / 256 + 0.5));
                    mixed += found[s] > 0 && found[s] < 255;
                }
            }
    }
    CHECK(mixed > 100);
    heat_shadow_destroy(map);
    elevation_destroy(&ground);
    ground = (Elevation){0};
}

/* What four places side by side lost of the past sun, beside one place after another: the same bits. */
static void places_side_by_side(void **state)
{
    (void)state;
    enum { slots = 16, kind = SURFACE_GRASS };
    static HeatNow now;
    float          d[3][shadow_most_slots] = {{0}};
    ShadowMap     *map;
    int            shaded = 0;
    ridge(40);
    memset(&now, 0, sizeof now);
    now.slots = slots, now.table.facets = 3;
    for (int s = 0; s < slots; s++) {
        slot(d, s, 70 + 14 * s, 8 + 3 * (s < 8 ? s : 15 - s));
        for (int c = 0; c < 3; c++) now.slot_d_enu[c][s] = d[c][s];
        now.table.slot_k[kind][s] = 0.3f + 0.17f * (float)s;
    }
    for (int k = 0; k < SURFACE_COUNT; k++) now.kind_of[k] = k;
    for (int k = 0; k < 9; k++) now.table.sun_k[kind][k] = 307;
    for (int k = 0; k < heat_ups; k++) now.table.shade_k[kind][k] = 291, now.table.dark_k[kind][k] = 284;
    CHECK(heat_shadow_create(&map, &(ShadowOf){.elevation = &ground, .cell_m = 8, .slots = slots, .d_enu = d}, NULL) ==
          STATUS_OK);
    const HeatScene scene = {.now = &now, .shadow = map};
    for (int first = 0; first < 60; first += heat_lanes) {
        GroundPlaces at = {.surface = {kind, kind, kind, kind}};
        HeatPlaces   one_by_one;
        double       temp_k[heat_lanes], lifted_k[heat_lanes], want_k[heat_lanes];
        for (int k = 0; k < heat_lanes; k++) {
            const double lean = 0.01 * (first + 3 * k), n_enu[3] = {sin(lean), 0, cos(lean)};
            const double x_m = 5.3 * (first + k) - 150;
            uint8_t      shadow[shadow_most_slots];
            at.p_enu[0][k] = x_m, at.p_enu[1][k] = 7 * k, at.dark[k] = one_by_one.dark[k] = 1;
            heat_shadow_at(shadow, &one_by_one.open[k], map, x_m, 7 * k);
            one_by_one.kind[k] = kind, one_by_one.taken[k] = heat_taken(&now, kind, n_enu, shadow);
            shaded += one_by_one.taken[k] > 0.05 && one_by_one.taken[k] < 0.95;
            for (int c = 0; c < 3; c++) at.n_enu[c][k] = one_by_one.n_enu[c][k] = n_enu[c];
        }
        heat_scene_grounds_k(temp_k, lifted_k, &scene, &at);
        heat_grounds_k(want_k, &now, &one_by_one);
        for (int k = 0; k < heat_lanes; k++) CHECK(temp_k[k] == want_k[k]);
    }
    CHECK(shaded > 20);
    heat_shadow_destroy(map);
    elevation_destroy(&ground);
    ground = (Elevation){0};
}

/* A block of 24 x 24 m and 12 m high about x = 200, y = 100. */
static void raise_block(float *z_m, const ShadowGrid *g, const void *user)
{
    for (int j = 0; j < g->ny; j++)
        for (int i = 0; i < g->nx; i++) {
            const double x = g->x0_m + i * g->cell_m, y = g->y0_m + j * g->cell_m;
            if (fabs(x - 200) < 12 && fabs(y - 100) < 12) z_m[j * g->nx + i] += *(const float *)user;
        }
}

/* What stands on the ground shades it as far as its height and the sun's say, and not itself; elsewhere nothing
 * changes. */
static void what_stands_on_the_ground(void **state)
{
    (void)state;
    static const float high_m = 12;
    float              d[3][shadow_most_slots] = {{0}};
    ShadowMap         *map, *bare;
    ridge(0);
    slot(d, 0, 180, 30), slot(d, 1, 90, 45);
    ShadowOf of = {.elevation = &ground, .cell_m = 2, .slots = 2, .d_enu = d};
    CHECK(heat_shadow_create(&bare, &of, NULL) == STATUS_OK);
    of.raise = raise_block, of.raise_user = &high_m;
    CHECK(heat_shadow_create(&map, &of, NULL) == STATUS_OK);
    uint8_t shadow[shadow_most_slots];
    double  open, north_m = 0, west_m = 0;
    for (double away_m = 0.25; away_m < 60; away_m += 0.5) {
        heat_shadow_at(shadow, &open, map, 200, 112 + away_m);
        north_m += 0.5 * shadow[0] / 255.0;
        heat_shadow_at(shadow, &open, map, 188 - away_m, 100);
        west_m += 0.5 * shadow[1] / 255.0;
        heat_shadow_at(shadow, &open, map, 200, 88 - away_m); /* its lit side */
        CHECK(shadow[0] == 0);
    }
    print_message("shaded: %.1f m north, %.1f m west\n", north_m, west_m);
    CHECK_NEAR(north_m, high_m / tan(30 * rad_per_deg), 2);
    CHECK_NEAR(west_m, high_m, 2);
    heat_shadow_at(shadow, &open, map, 200, 100);
    CHECK(shadow[0] == 0 && shadow[1] == 0 && open == 1);
    heat_shadow_at(shadow, &open, bare, 200, 120);
    CHECK(shadow[0] == 0);
    heat_shadow_destroy(map);
    heat_shadow_destroy(bare);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(length_of_a_shadow),       cmocka_unit_test(what_stands_on_the_ground),
        cmocka_unit_test(cells_behind_a_ridge),     cmocka_unit_test(places_between_cells),
        cmocka_unit_test(places_side_by_side),      cmocka_unit_test(light_below_a_stand),
        cmocka_unit_test(light_through_one_column), cmocka_unit_test(large_terrain_has_larger_cells)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
