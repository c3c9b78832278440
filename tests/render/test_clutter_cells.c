/* Cells of ground clutter: how they tile the ground, their levels and slopes; what a scatterer is drawn as and
 * returns, term by term. labels: physics */
#include "tests/render/clutter_stage.h"

static void order_changes_no_bit(void **state)
{
    (void)state;
    enum { across = 60, count = across * across };
    Stage       *s = stage(count, SURFACE_CROP, 0.3, 17), *back = stage(count, SURFACE_CROP, 0.3, 17);
    const double low[2] = {-9, -9}, high[2] = {9, 9};
    CHECK(clutter_cells(s->cell, count, &s->grid, 0, low, high) == count);
    for (int i = 0; i < count; i++) back->cell[i] = s->cell[count - 1 - i];
    stage_place(s);
    stage_place(back);
    stage_draw(s, CLUTTER_KU);
    for (int i = count - 1; i >= 0; i--) /* one by one */
        clutter_draw(&back->scatterer[i], &back->grid, &table, CLUTTER_KU, 1, &back->cell[i], &back->surface[i]);
    ClutterLook look = look_from(2, 0.3, ku_hz);
    look.wind_mps = 3, look.t_s = 5;
    see(s, &look);
    see(back, &look);
    for (int i = 0; i < count; i++) {
        CHECK(memcmp(&s->scatterer[i], &back->scatterer[count - 1 - i], sizeof *s->scatterer) == 0);
        CHECK(memcmp(&s->seen[i], &back->seen[count - 1 - i], sizeof *s->seen) == 0);
    }
    stage_free(s);
    stage_free(back);
}

static double area_of(const ClutterGrid *grid, const ClutterCell *cell, size_t count)
{
    double area_m2 = 0;
    for (size_t i = 0; i < count; i++) area_m2 += pow(clutter_side(grid, cell[i].level), 2);
    return area_m2;
}

static void cells_tile_the_ground(void **state)
{
    (void)state;
    enum { most = 300000 };
    ClutterCell      *cell = need(most, sizeof *cell);
    const ClutterGrid grid = {0.25, 1};
    const double      low[2] = {-1024, -512}, high[2] = {1024, 2048}, from[2] = {100, -3000};
    /* a multiple of 64 m: cells of 64 m and less tile it exactly, whatever their levels */
    const size_t count = clutter_cells_at(cell, most, &grid, low, high, from, 0.004);
    CHECK(count > 1000 && count <= most);
    CHECK_NEAR(area_of(&grid, cell, count), 2048.0 * 2560.0, 0);
    int levels = 0;
    for (size_t i = 0; i < count; i++) {
        const double side_m = clutter_side(&grid, cell[i].level);
        double       p_m[2];
        clutter_centre(p_m, &grid, &cell[i]);
        const double east_m = fabs(p_m[0] - from[0]) - 0.5 * side_m, north_m = fabs(p_m[1] - from[1]) - 0.5 * side_m;
        const double away_m = hypot(fmax(east_m, 0), fmax(north_m, 0));
        CHECK(side_m <= 0.004 * away_m || cell[i].level == 0);
        CHECK(2 * side_m > 0.004 * (away_m - 2 * side_m)); /* and its parent's is too long */
        levels |= 1 << cell[i].level;
        clutter_place(p_m, &grid, &cell[i]);
        for (int a = 0; a < 2; a++) CHECK(floor(p_m[a] / side_m) == (a ? cell[i].y : cell[i].x));
    }
    CHECK(levels & (levels - 1)); /* more than one */
    printf("%zu cells, levels 0x%x; at level 0: %zu\n", count, levels, clutter_cells(NULL, 0, &grid, 0, low, high));
    /* rectangles that share an edge share no cell, and miss none: an edge through the middle of cells */
    const double middle[2] = {3.3, 2048}, middle_low[2] = {3.3, -512};
    const size_t west = clutter_cells_at(NULL, 0, &grid, low, middle, from, 0.004);
    const size_t east = clutter_cells_at(NULL, 0, &grid, middle_low, high, from, 0.004);
    CHECK(west > 0 && east > 0 && west + east == count);
    CHECK(clutter_cells(NULL, 0, &grid, 3, low, middle) + clutter_cells(NULL, 0, &grid, 3, middle_low, high) ==
          1024 * 1280);
    CHECK(clutter_cells(NULL, 0, &grid, 3, high, low) == 0);
    /* share 0: the finest, as the other has them */
    const double small[2] = {-1020, -508};
    CHECK(clutter_cells_at(cell, most, &grid, low, small, from, 0) == 256 && cell[255].level == 0);
    free(cell);
}

/* The same area at four levels: mean as stated at each. */
static void levels_keep_the_mean(void **state)
{
    (void)state;
    enum { across = 256 };
    const double low[2] = {0, 0}, high[2] = {512, 512};
    for (int level = 0; level < 4; level++) {
        const int count = across * across >> 2 * level;
        Stage    *s = stage(count, SURFACE_GRASS, 2, 18);
        CHECK((int)clutter_cells(s->cell, (size_t)count, &s->grid, level, low, high) == count);
        stage_place(s);
        stage_draw(s, CLUTTER_KU);
        const ClutterLook look = look_from(1, 0.4, ku_hz);
        see(s, &look);
        double sum = 0;
        for (int i = 0; i < count; i++) sum += 4 * pi_rad * power(s->seen[i].vv);
        const double mean = table.row[SURFACE_GRASS][CLUTTER_KU].gamma * sin(0.4) * 512 * 512;
        const double patches = 512 * 512 / (pi_rad * 16); /* 4 m: the grass's texture */
        printf("level %d: mean %.4f of its own\n", level, sum / mean);
        CHECK_NEAR(sum / mean, 1, 4 * sqrt((1 + 1.0 / 8) / count + (1.0 / 8) / patches));
        stage_free(s);
    }
}

static void slopes_count(void **state)
{
    (void)state;
    enum { count = 40000 };
    Stage *s = stage(count, SURFACE_SNOW, 1, 20);
    for (int i = 0; i < count; i++) s->cell[i] = (ClutterCell){9 * (i % 200), 9 * (i / 200), 0};
    stage_draw(s, CLUTTER_KU);
    ClutterLook look = look_from(0, 0.2, ku_hz); /* from the north */
    for (int k = 0; k < 3; k++) {
        const double slope = k == 0 ? 0.5 : k == 1 ? -0.1 : -0.3; /* rad, positive: faces north */
        for (int i = 0; i < count; i++) s->n[1][i] = (float)sin(slope), s->n[2][i] = (float)cos(slope);
        see(s, &look);
        double sum = 0;
        for (int i = 0; i < count; i++) sum += 4 * pi_rad * power(s->seen[i].vv);
        const double grazing = 0.2 + slope, gamma = table.row[SURFACE_SNOW][CLUTTER_KU].gamma;
        const double want = grazing > 0 ? gamma * sin(grazing) / cos(slope) : 0;
        CHECK_NEAR(sum / count, want, 4 * want * sqrt(1.3 / count));
    }
    stage_free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(order_changes_no_bit),
        cmocka_unit_test(cells_tile_the_ground),
        cmocka_unit_test(levels_keep_the_mean),
        cmocka_unit_test(slopes_count),
    };
    return cmocka_run_group_tests(tests, open_table, NULL);
}
