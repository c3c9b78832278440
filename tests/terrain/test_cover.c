/* Ground cover of eight places at once: against a plain reading of its definition, one place at a time in double,
 * written here; and independent of the other places. */
#include "tests/check.h"

#include "terrain/ground/landscape_parts.h"
#include "terrain/ground/landscape.h"

/* ---- the plain reading ------------------------------------------------------------------------ */

static uint64_t mixed(uint64_t seed, int64_t a, int64_t b)
{
    uint64_t h = seed + (uint64_t)a * 0x9e3779b97f4a7c15u + (uint64_t)b * 0xd1b54a32d192ed03u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

static double unit(uint64_t h) { return (double)(h >> 11) * 0x1p-53; }

static double corner(uint32_t key, int64_t i, int64_t j)
{
    uint32_t h = key + (uint32_t)i * 0x9e3779b1u + (uint32_t)j * 0x85ebca77u;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    return (double)(int32_t)h * 0x1p-31;
}

static double noise(uint64_t seed, double wavelength_m, double x_m, double y_m)
{
    const uint32_t key = (uint32_t)(mixed(seed, 0, 0) >> 32);
    const double   fx = x_m / wavelength_m, fy = y_m / wavelength_m, i = floor(fx), j = floor(fy);
    double         sum = 0;
    for (int n = 0; n < 4; n++) {
        const double u = n & 1 ? fx - i : 1 - (fx - i), v = n & 2 ? fy - j : 1 - (fy - j);
        sum += corner(key, (int64_t)i + (n & 1), (int64_t)j + (n >> 1)) * u * u * (3 - 2 * u) * v * v * (3 - 2 * v);
    }
    return sum;
}

static uint64_t field_of(uint64_t seed, int64_t i, int64_t j)
{
    const double four = unit(mixed(seed + 1, i >> 1, j >> 1));
    return four < 0.25   ? mixed(seed + 2, i >> 1, j >> 1)
           : four < 0.45 ? mixed(seed + 3, i >> 1, j)
           : four < 0.60 ? mixed(seed + 4, i, j >> 1)
                         : mixed(seed + 5, i, j);
}

static SurfaceClass crop(uint64_t seed, uint64_t id, int64_t i, int64_t j)
{
    static const double       arable[] = {0.38, 0.58, 0.70, 0.88, 1, 1}, pasture[] = {0.10, 0.15, 0.20, 0.62, 0.90, 1};
    static const SurfaceClass surface[] = {SURFACE_CROP,  SURFACE_PLOUGHED,  SURFACE_BARE_SOIL,
                                           SURFACE_GRASS, SURFACE_DRY_GRASS, SURFACE_SCRUB};
    const double             *share =
        noise(seed + 13, 1900, (double)(i >> 1) * 320, (double)(j >> 1) * 320) > -0.15 ? arable : pasture;
    const double u = unit(mixed(id, 7, 0));
    int          n = 0;
    while (u >= share[n]) n++;
    return surface[n];
}

/* Two noises of one lattice: the second by another mixing. */
static double second_corner(uint32_t key, int64_t i, int64_t j)
{
    uint32_t h = key + (uint32_t)i * 0x9e3779b1u + (uint32_t)j * 0x85ebca77u;
    h = (h ^ (h >> 15)) * 0xd168aaadu;
    h = (h ^ (h >> 16)) * 0xaf723597u;
    return (double)(int32_t)h * 0x1p-31;
}

static double second_noise(uint64_t seed, double wavelength_m, double x_m, double y_m)
{
    const uint32_t key = (uint32_t)(mixed(seed, 0, 0) >> 32);
    const double   fx = x_m / wavelength_m, fy = y_m / wavelength_m, i = floor(fx), j = floor(fy);
    double         sum = 0;
    for (int n = 0; n < 4; n++) {
        const double u = n & 1 ? fx - i : 1 - (fx - i), v = n & 2 ? fy - j : 1 - (fy - j);
        sum +=
            second_corner(key, (int64_t)i + (n & 1), (int64_t)j + (n >> 1)) * u * u * (3 - 2 * u) * v * v * (3 - 2 * v);
    }
    return sum;
}

static double wander_at(uint64_t seed, double x_m, double y_m)
{
    static const double wave_m[] = {2.7, 1.2, 0.53, 0.24, 0.11}, share[] = {0.42, 0.26, 0.16, 0.10, 0.06};
    double              sum = 0;
    for (int n = 0; n < 5; n++) sum += share[n] * noise(seed + 30 + (uint64_t)n, wave_m[n], x_m, y_m);
    return sum;
}

/* Where no way touches the cell of the index. */
static SurfaceClass plain_surface(const Landscape *land, uint64_t seed, double x_m, double y_m)
{
    static const double arm_m = 10, cell_m = 160, bend_wave_m[] = {2300, 330}, bend_m[] = {260, 28};
    const Elevation    *e = &land->elevation;
    if (!isfinite(elevation_height(e, x_m, y_m, NULL))) return SURFACE_NONE;
    const double dx = elevation_height(e, x_m + arm_m, y_m, NULL) - elevation_height(e, x_m - arm_m, y_m, NULL);
    const double dy = elevation_height(e, x_m, y_m + arm_m, NULL) - elevation_height(e, x_m, y_m - arm_m, NULL);
    const double steep = sqrt(dx * dx + dy * dy) / (2 * arm_m);
    const double slope = fmax((isfinite(steep) ? steep : 0) - sqrt(x_m * x_m + y_m * y_m) / 6371e3, 0);
    const double middle = noise(seed + 11, 83, x_m, y_m), wander = wander_at(seed, x_m, y_m);
    const double patch = noise(seed + 12, 17, x_m, y_m);
    const double wild = noise(seed + 10, 310, x_m, y_m) + 0.5 * middle + 0.14 * patch + 4 * slope;
    const double wet = landscape_wetness(land, x_m, y_m);
    const double grown = wild + 0.2 * fmax(wet, 0) - 0.88 + 0.02 * wander;
    const double stony = wild - 0.3 * wet - 1.24 + 0.12 * fmin(slope / 0.2, 1) + 0.02 * wander;
    if (stony > 0) return SURFACE_ROCK;

    static const double turn[8][2] = {{3, 4}, {5, 12}, {8, 15}, {20, 21}, {12, 35}, {9, 40}, {28, 45}, {33, 56}};
    const uint64_t      h_turn = mixed(seed + 25, 0, 0);
    const double        angle = atan2(turn[h_turn >> 61][1], turn[h_turn >> 61][0]);
    const double        c = h_turn >> 60 & 1 ? sin(angle) : cos(angle), t = h_turn >> 60 & 1 ? cos(angle) : sin(angle);
    double              bent_x = c * x_m - t * y_m, bent_y = t * x_m + c * y_m;
    for (size_t n = 0; n < sizeof bend_m / sizeof *bend_m; n++) {
        bent_x += bend_m[n] * noise(seed + 26 + n, bend_wave_m[n], x_m, y_m);
        bent_y += bend_m[n] * second_noise(seed + 26 + n, bend_wave_m[n], x_m, y_m);
    }
    double        site[9][3]; /* place, square of the distance */
    uint64_t      id[9], block[9];
    const int64_t ci = (int64_t)floor(bent_x / cell_m), cj = (int64_t)floor(bent_y / cell_m);
    int           best = 0;
    for (int n = 0; n < 9; n++) {
        const int64_t  i = ci + n % 3 - 1, j = cj + n / 3 - 1;
        const uint64_t h = mixed(seed, i, j);
        site[n][0] = ((double)i + 0.5 + 0.5 * ((double)(h & 0xffffffffu) * 0x1p-32 - 0.5)) * cell_m;
        site[n][1] = ((double)j + 0.5 + 0.5 * ((double)(h >> 32) * 0x1p-32 - 0.5)) * cell_m;
        site[n][2] = pow(site[n][0] - bent_x, 2) + pow(site[n][1] - bent_y, 2);
        id[n] = field_of(seed, i, j);
        block[n] = mixed(seed + 8, i >> 2, j >> 2);
        if (site[n][2] < site[best][2]) best = n;
    }
    double border_m = INFINITY;
    int    other = best;
    for (int n = 0; n < 9; n++) {
        if (id[n] == id[best]) continue;
        const double apart_m = hypot(site[n][0] - site[best][0], site[n][1] - site[best][1]);
        const double here_m = 0.5 * (site[n][2] - site[best][2]) / apart_m;
        if (here_m < border_m) border_m = here_m, other = n;
    }
    const double across = unit(mixed(seed + 6, (int64_t)(id[other] ^ id[best]), 0));
    const bool   blocks = block[other] != block[best], hedge = across > 0.66;
    const bool   track = blocks ? unit(mixed(seed + 9, (int64_t)(block[other] ^ block[best]), 0)) < 0.7 : across < 0.05;
    const double off_m = 0.6 * wander, here_m = border_m + (id[best] < id[other] ? off_m : -off_m);
    const double away_m = fabs(here_m), edge_m = away_m + 0.5 * off_m;
    if (track && edge_m < 2) return SURFACE_TRACK;
    if (hedge && (track ? away_m > 2 && edge_m < 3.6 : edge_m < 1.5)) return SURFACE_SCRUB;
    if (track && edge_m < 2.7) return SURFACE_GRASS;
    if (wet < -0.2 && stony > -0.16) return SURFACE_BARE_SOIL;
    if (grown > 0) return SURFACE_SCRUB;
    if (wet + 0.35 * middle + 0.22 * patch - 0.92 + 0.02 * wander > 0) return SURFACE_WETLAND;
    if (grown > -0.1) return SURFACE_DRY_GRASS;
    const int own = here_m < 0 ? other : best;
    return crop(seed, id[own], ci + own % 3 - 1, cj + own / 3 - 1);
}

/* ---- the ground that is asked ------------------------------------------------------------------ */

enum { places = 120000 };
static double    x_m[places], y_m[places];
static uint8_t   surface[places];
static Landscape land;
static uint64_t  cover_seed;

static int make_land(void **state)
{
    (void)state;
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    config.seed = 3;
    config.half_width_m = 1500;
    config.horizon_m = 30000;
    cover_seed = mixed(config.seed, 2, 0);
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    return landscape_create(&land, &config, &frame, NULL, 0, NULL, 0) == STATUS_OK ? 0 : -1;
}

static int drop_land(void **state)
{
    (void)state;
    landscape_destroy(&land);
    return 0;
}

/* All levels and their seams, runs of neighbours and places by themselves, and some where there is no ground. */
static void choose_places(void)
{
    for (int n = 0; n < places; n++) {
        const uint64_t k = (uint64_t)(n % 3 == 0 ? n : n / 24 * 24);
        const double   half_m = k % 2 ? 31000 : 2600;
        x_m[n] = half_m * (2 * random_uniform(11, 0, 0, k) - 1) + (n % 3 == 0 ? 0 : n % 24);
        y_m[n] = half_m * (2 * random_uniform(11, 1, 0, k) - 1);
    }
    x_m[7] = NAN, y_m[9] = INFINITY, x_m[12] = 1e300;
}

static void cover_is_what_it_is_defined_to_be(void **state)
{
    (void)state;
    int differ = 0, inside = 0, of_class[SURFACE_COUNT] = {0};
    choose_places();
    landscape_surfaces(surface, &land, places, x_m, y_m);
    for (int n = 0; n < places; n++) {
        if (landscape_ways_near(&land, x_m[n], y_m[n])) continue;
        inside += fabs(x_m[n]) < 1500 && fabs(y_m[n]) < 1500;
        const SurfaceClass plain = plain_surface(&land, cover_seed, x_m[n], y_m[n]);
        of_class[plain]++;
        differ += plain != surface[n];
        CHECK((plain == SURFACE_NONE) == (surface[n] == SURFACE_NONE));
    }
    print_message("%d of %d places differ, %d within the finest level\n", differ, (int)places, inside);
    /* float moves borders by 1e-4 m, of wild patches (which change by some 0.01 a metre) by 1e-3 m, and there is a
     * border every 10 m or so; a fine wander has some three borders for one */
    CHECK(differ < places * 1e-4);
    CHECK(inside > 5000);
    CHECK(of_class[SURFACE_NONE] > 100 && of_class[SURFACE_TRACK] > 300 && of_class[SURFACE_ROCK] > 100 &&
          of_class[SURFACE_SCRUB] > 1000);
}

static void company_changes_nothing(void **state)
{
    (void)state;
    enum { some = 20000 };
    static uint8_t again[some];
    choose_places();
    landscape_surfaces(surface, &land, places, x_m, y_m);
    for (int n = 0; n < some; n++) CHECK(landscape_surface(&land, x_m[n], y_m[n]) == surface[n]);
    /* in another order, from another place in the eight */
    static double back_x_m[some], back_y_m[some];
    for (int n = 0; n < some - 3; n++) {
        const int from = some - 1 - n;
        back_x_m[n] = x_m[from], back_y_m[n] = y_m[from];
    }
    landscape_surfaces(again, &land, some - 3, back_x_m, back_y_m);
    for (int n = 0; n < some - 3; n++) CHECK(again[n] == surface[some - 1 - n]);
}

/* Squares of a pixel's size: where all of one class, it is that; on borders as much of each class, within a few places.
 */
static void squares_are_their_places(void **state)
{
    enum { squares = 4000, a_side = 8, all = a_side * a_side };
    static const double sides_m[][2] = {{0.2, 0.2}, {0.3, 2}, {1, 1}, {0.4, 9}, {3, 11}, {5, 5}};
    (void)state;
    for (size_t size = 0; size < sizeof sides_m / sizeof *sides_m; size++) {
        int    bordered = 0, same = 0;
        double off = 0;
        for (int n = 0; n < squares; n++) {
            double       x[all], y[all];
            uint8_t      got[all], want[all];
            int          count[2][SURFACE_COUNT] = {{0}}, differ = 0;
            const double east_m = 2600 * (2 * random_uniform(12, 0, 0, (uint64_t)n) - 1);
            const double north_m = 2600 * (2 * random_uniform(12, 1, 0, (uint64_t)n) - 1);
            for (int k = 0; k < all; k++) {
                x[k] = east_m + sides_m[size][0] * (k % a_side + 0.5) / a_side;
                y[k] = north_m + sides_m[size][1] * (k / a_side + 0.5) / a_side + 0.2 * (x[k] - east_m);
            }
            landscape_surfaces_square(got, &land, a_side, x, y);
            landscape_surfaces(want, &land, all, x, y);
            for (int k = 0; k < all; k++) count[0][got[k]]++, count[1][want[k]]++;
            for (int c = 0; c < SURFACE_COUNT; c++) differ += abs(count[0][c] - count[1][c]);
            bordered += count[1][want[0]] < all;
            same += memcmp(got, want, sizeof got) == 0;
            off += 0.5 * differ / all;
        }
        print_message("squares of %.1f x %.1f m: %d of %d on borders, %d the same, %.2f %% of their area off\n",
                      sides_m[size][0], sides_m[size][1], bordered, (int)squares, same, 100 * off / bordered);
        CHECK(bordered > 20 && same > 0.85 * squares);
        CHECK(off / bordered < 0.03);
    }
}

/* Where the class changes from south to north near a line, by halves. */
static double border_y(const Landscape *of, double x, double low, double high)
{
    for (int n = 0; n < 40; n++) {
        const double middle = 0.5 * (low + high);
        if (landscape_surface(of, x, middle) == SURFACE_CROP) low = middle;
        else high = middle;
    }
    return low;
}

/* A border that runs slantwise through cells of a cover file: no steps of a cell are left, its place is kept within
 * a cell, and it is rough over a quarter of a metre. */
static void borders_of_files_have_no_steps(void **state)
{
    (void)state;
    enum { side = 64, samples = 512 };
    static const double cell[] = {1, 10, 30};
    static uint8_t      classes[side * side];
    for (int k = 0; k < 3; k++) {
        const double c = cell[k];
        /* its ground, with cover of its own */
        LandscapeParts parts = {
            .frame = land.frame,
            .config = land.config,
            .elevation = land.elevation,
            .cover_seed = 5,
            .cover = {{.nx = side, .ny = side, .x0_m = -32 * c, .y0_m = -32 * c, .cell_m = c, .surface = classes}}};
        Landscape   of;
        const char *why;
        for (int n = 0; n < side * side; n++)
            classes[n] = n / side - 31.5 < 0.4 * (n % side - 31.5) ? SURFACE_CROP : SURFACE_SCRUB;
        CHECK(landscape_from_parts(&of, &why, &parts) == STATUS_OK);
        double prior = NAN, off = 0, rough = 0;
        int    flat = 0;
        for (int n = 0; n < samples; n++) {
            const double x = 20 * c * ((double)n / samples - 0.5), line = 0.4 * x;
            const double y = border_y(&of, x, line - 2 * c, line + 2 * c);
            flat += fabs(y - prior) < 0.002 * c;
            off += (y - line) * (y - line) / samples;
            const double near = border_y(&of, x + 0.25, line - 2 * c, line + 2 * c);
            rough += pow(near - y, 2) / samples;
            prior = y;
        }
        print_message("cells of %.0f m: %d of %d flat, %.2f cells off, rough by %.3f m\n", c, flat, (int)samples,
                      sqrt(off) / c, sqrt(rough));
        landscape_destroy(&of);
        CHECK(flat < samples / 5 && sqrt(off) < 0.6 * c && sqrt(rough) > 0.05);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cover_is_what_it_is_defined_to_be),
        cmocka_unit_test(company_changes_nothing),
        cmocka_unit_test(squares_are_their_places),
        cmocka_unit_test(borders_of_files_have_no_steps),
    };
    return cmocka_run_group_tests(tests, make_land, drop_land);
}
