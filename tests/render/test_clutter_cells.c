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

/* ---- one scatterer ---------------------------------------------------------------------------------------- */

/* Moments of the terms of a drawn scatterer: the power at VV is 1 over the still ones, and 1 over the moving ones; HH
 * and HV by the row, HH correlated with VV; offsets normal, of the row's extent; velocities two-sided exponential of
 * spread 1: mean square 2, mean size 1. Bounds: 5 standard errors of 30,000 draws. */
static void terms_have_their_moments(void **state)
{
    (void)state;
    enum { draws = 30000 };
    const ClutterRow *row = &table.row[SURFACE_FOREST_BROADLEAF][CLUTTER_KA];
    const double      one = 5 / sqrt(draws);
    double            vv[clutter_terms] = {0}, hh[clutter_terms] = {0}, hv[clutter_terms] = {0};
    double            offset[clutter_terms][3] = {{0}}, square[clutter_terms] = {0}, size[clutter_terms] = {0};
    double complex    both[clutter_terms] = {0}, cross[clutter_terms] = {0};
    for (uint32_t i = 0; i < draws; i++) {
        ClutterScatterer s;
        clutter_draw_leaf(&s, row, 5, i / 100, i % 100);
        for (int m = 0; m < clutter_terms; m++) {
            const double complex v = CMPLX((double)s.vv[m][0], (double)s.vv[m][1]);
            const double complex h = CMPLX((double)s.hh[m][0], (double)s.hh[m][1]);
            const double complex x = CMPLX((double)s.hv[m][0], (double)s.hv[m][1]);
            vv[m] += power(v) / draws, hh[m] += power(h) / draws, hv[m] += power(x) / draws;
            both[m] += h * conj(v) / draws, cross[m] += x * conj(v) / draws;
            for (int a = 0; a < 3; a++) offset[m][a] += pow((double)s.offset_m[m][a], 2) / draws;
            const double moves = m < clutter_still_terms ? 0 : (double)s.velocity[m - clutter_still_terms];
            square[m] += moves * moves / draws, size[m] += fabs(moves) / draws;
        }
    }
    for (int m = 0; m < clutter_terms; m++) {
        const double want = 1.0 / (m < clutter_still_terms ? clutter_still_terms : clutter_terms - clutter_still_terms);
        CHECK_NEAR(vv[m] / want, 1, one);
        CHECK_NEAR(hh[m] / (want * row->hh), 1, one);
        CHECK_NEAR(hv[m] / (want * row->hv), 1, one);
        CHECK_NEAR(creal(both[m]) / (want * sqrt(row->hh)), row->rho, one);
        CHECK_NEAR(cimag(both[m]) / (want * sqrt(row->hh)), 0, one);
        CHECK(cabs(cross[m]) / (want * sqrt(row->hv)) < 1.5 * one);
        for (int a = 0; a < 3; a++) CHECK_NEAR(offset[m][a] / pow(row->extent_m, 2), 1, sqrt(2) * one);
        if (m < clutter_still_terms) continue;
        CHECK_NEAR(square[m], 2, sqrt(20) * one);
        CHECK_NEAR(size[m], 1, one);
    }
}

/* The terms' sum by hand: amplitude exp(j 2 k (u . offset + velocity spread t)), still terms with the share of the
 * power that is still, the others with the rest; sigma0 side^2 / (4 pi n_z) for a cell on a slope, sigma / (4 pi) for a
 * leaf. */
static void terms_add_up(void **state)
{
    (void)state;
    enum { cells = 40 };
    Stage              *s = stage(cells, SURFACE_FOREST_CONIFER, 0.5, 3);
    const ClutterRow   *row = &table.row[SURFACE_FOREST_CONIFER][CLUTTER_KA];
    const ClutterLook   look = {{300, -200, 120}, ka_hz, 0.04, 7};
    const ClutterMotion motion = clutter_motion(row, ka_hz, look.wind_mps);
    CHECK(motion.still > 0.01 && motion.still < 0.99 && motion.spread_mps > 0);
    for (int i = 0; i < cells; i++) {
        double n[3] = {0.02 * (i % 5), 0.03 * (i % 7) - 0.1, 1};
        s->cell[i] = (ClutterCell){3 * i, -2 * i, i % 3};
        v3_normalize(n, n);
        for (int a = 0; a < 3; a++) s->n[a][i] = (float)n[a];
    }
    stage_place(s);
    stage_draw(s, CLUTTER_KA);
    see(s, &look);
    for (int i = 0; i <= cells; i++) {
        const ClutterScatterer *of = &s->scatterer[i % cells];
        double                  p[3], u[3], size;
        double complex          vv = 0, hh = 0, hv = 0;
        ScatterMatrix           got = s->seen[i % cells];
        for (int a = 0; a < 3; a++) p[a] = s->p[a][i % cells];
        v3_sub(u, look.antenna_enu, p);
        v3_normalize(u, u);
        if (i == cells) { /* the same scatterer as a leaf */
            size = sqrt(0.3 / (4 * pi_rad));
            clutter_see_leaf(&got, of, &motion, 0.3, p, &look);
        } else {
            const double n[3] = {(double)s->n[0][i], (double)s->n[1][i], (double)s->n[2][i]};
            const double side_m = 0.5 * (1 << i % 3), sine = v3_dot(n, u);
            size = sqrt(row->gamma * sine * side_m * side_m / (4 * pi_rad * n[2]));
        }
        for (int m = 0; m < clutter_terms; m++) {
            double       far_m = 0;
            const bool   still = m < clutter_still_terms;
            const double share = still ? motion.still : 1 - motion.still;
            for (int a = 0; a < 3; a++) far_m += u[a] * (double)of->offset_m[m][a];
            if (!still) far_m += (double)of->velocity[m - clutter_still_terms] * motion.spread_mps * look.t_s;
            const double complex turn = size * sqrt(share) * cexp(I * 4 * pi_rad * ka_hz / c_mps * far_m);
            vv += turn * CMPLX((double)of->vv[m][0], (double)of->vv[m][1]);
            hh += turn * CMPLX((double)of->hh[m][0], (double)of->hh[m][1]);
            hv += turn * CMPLX((double)of->hv[m][0], (double)of->hv[m][1]);
        }
        CHECK(cabs(got.vv - vv) < 1e-9 * size && cabs(got.hh - hh) < 1e-9 * size);
        CHECK(cabs(got.hv - hv) < 1e-9 * size && got.vh == got.hv);
    }
    stage_free(s);
}

/* Deviations of the texture at levels, over those of its finest: by the share of the variance that means over cells
 * keep, V = 2 times the integral of (1 - t) exp(-a^2 t^2) over 0 .. 1 for sides of a lengths, by Simpson's rule: the
 * scale is sqrt(f / (f + 1 - V^2)), f = pi / a^2. */
static double scale_of(double a)
{
    enum { steps = 2000 };
    double v = 0;
    for (int i = 0; i <= steps; i++) {
        const double t = (double)i / steps;
        v += (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2) * 2 * (1 - t) * exp(-a * a * t * t) / (3 * steps);
    }
    return sqrt(pi_rad / (a * a) / (pi_rad / (a * a) + 1 - v * v));
}

static void levels_scale_the_texture(void **state)
{
    (void)state;
    const ClutterRow *row = &table.row[SURFACE_ROCK][CLUTTER_KA];
    const ClutterGrid grid = {row->texture_m / 512, 9};
    CHECK_NEAR(scale_of(1), 0.96, 0.005); /* as clutter.c states them */
    CHECK_NEAR(scale_of(2), 0.75, 0.005);
    CHECK_NEAR(scale_of(4), 0.43, 0.005);
    for (int i = 0; i < 20; i++) {
        const double p[2] = {7.3 * i, -3.1 * i}, finest = clutter_texture_at(&grid, row, 0, p) - 1;
        CHECK(fabs(finest) > 1e-3);
        for (int level = 1; level <= 12; level++)
            CHECK_NEAR((clutter_texture_at(&grid, row, level, p) - 1) / finest,
                       scale_of((double)(1 << level) / 512) / scale_of(1.0 / 512), 1e-8);
    }
}

/* What a cache holds, and what it gave up for other cells, levels and surfaces, are the scatterers as they are drawn.
 */
static void a_cache_changes_no_bit(void **state)
{
    (void)state;
    enum { cells = 4000 };
    Stage                  *s = stage(cells, SURFACE_GRASS, 0.5, 3);
    const ClutterKind       kind = {&s->grid, &table, CLUTTER_W};
    ClutterCache           *cache;
    static ClutterScatterer got[cells];
    CHECK(clutter_cache_create(&cache) == STATUS_OK);
    for (int i = 0; i < cells; i++) { /* of x, 8 and more share a set in turn */
        s->cell[i] = (ClutterCell){i % 40 * 256 - 700, i / 40 * 128 - 900, i % 3};
        s->surface[i] = i % 2 ? SURFACE_GRASS : SURFACE_SAND;
    }
    for (int again = 0; again < 3; again++) {
        if (again == 2)
            for (int i = 0; i < cells; i++) s->surface[i] = SURFACE_ROCK;
        stage_draw(s, CLUTTER_W);
        clutter_cache_draw(got, cache, &kind, cells, s->cell, s->surface);
        CHECK(memcmp(got, s->scatterer, sizeof got) == 0);
    }
    clutter_cache_destroy(cache);
    stage_free(s);
}

/* Places are within their cells, in both directions, and nothing else is written. */
static void places_are_in_their_cells(void **state)
{
    (void)state;
    const ClutterGrid grid = {0.3, 4};
    for (int i = 0; i < 500; i++) {
        const ClutterCell cell = {7 * i - 900, 400 - 3 * i, i % 5};
        const double      side_m = 0.3 * (1 << i % 5);
        double            p[3] = {0, 0, 7}, centre[3] = {0, 0, 7};
        clutter_place(p, &grid, &cell);
        clutter_centre(centre, &grid, &cell);
        CHECK(p[2] == 7 && centre[2] == 7);
        for (int a = 0; a < 2; a++) CHECK(fabs(p[a] - centre[a]) <= 0.5 * side_m * (1 + 1e-12));
        CHECK_NEAR(centre[0], (cell.x + 0.5) * side_m, 1e-9);
        CHECK_NEAR(centre[1], (cell.y + 0.5) * side_m, 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_in_their_cells),
        cmocka_unit_test(terms_have_their_moments),
        cmocka_unit_test(terms_add_up),
        cmocka_unit_test(levels_scale_the_texture),
        cmocka_unit_test(a_cache_changes_no_bit),
        cmocka_unit_test(order_changes_no_bit),
        cmocka_unit_test(cells_tile_the_ground),
        cmocka_unit_test(levels_keep_the_mean),
        cmocka_unit_test(slopes_count),
    };
    return cmocka_run_group_tests(tests, open_table, NULL);
}
