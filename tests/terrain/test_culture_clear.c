/* Invented culture keeps clear of what was reported: vehicles, their paths, the sight lines of shots; and plants keep
 * clear of it. */
#include "tests/terrain/culture_lab.h"

#include "terrain/woods/woods.h"

#include <dirent.h>

/* ---- evidence ------------------------------------------------------------------------------------- */

enum { drives = 30, steps = 24, fixes = drives * steps, shots = 120 };

static double away_m(const double p[2], const double a[2], const double b[2])
{
    const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    const double t = square > 0 ? clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, 0, 1) : 0;
    return hypot(a[0] + t * dx - p[0], a[1] + t * dy - p[1]);
}

static double path_away_m(const GroundFix *fix, const double p[2])
{
    double least = INFINITY;
    for (int n = 0; n < fixes; n++) least = fmin(least, away_m(p, fix[n % steps ? n - 1 : n].p_enu, fix[n].p_enu));
    return least;
}

/* Vehicles that report every 250 m, so that what is built would be between their reports. */
static void nothing_where_vehicles_were(void **state)
{
    (void)state;
    static GroundFix fix[fixes];
    Landscape        land;
    int              plots, left_out = 0;
    double           least = INFINITY;
    for (int n = 0; n < fixes; n++) {
        const uint64_t d = (uint64_t)(n / steps);
        const double   turn_rad = 2 * pi_rad * random_uniform(1, 0, 0, d), along = 250.0 * (n % steps - steps / 2);
        fix[n].voter = (int)d + 1;
        fix[n].p_enu[0] = 4000 * (random_uniform(1, 1, 0, d) - 0.5) + along * cos(turn_rad);
        fix[n].p_enu[1] = 4000 * (random_uniform(1, 2, 0, d) - 0.5) + along * sin(turn_rad);
        fix[n].p_enu[2] = -(pow(fix[n].p_enu[0], 2) + pow(fix[n].p_enu[1], 2)) / (2 * 6371e3);
    }
    make(&land, 2, 3000, &(LandscapeEvidence){.fix_count = fixes, .fix = fix});
    Culture          c = invent(&land, 0, 0, 4000);
    const HousePlot *plot = landscape_plots(&land, &plots);
    for (int n = 0; n < plots; n++) {
        const HousePlot *p = &plot[n];
        const double     house[2] = {p->x_m + p->house[0] * p->direction[0] - p->house[1] * p->direction[1],
                                     p->y_m + p->house[0] * p->direction[1] + p->house[1] * p->direction[0]};
        left_out += path_away_m(fix, house) < 12 && !building_at(&c, house[0], house[1]);
    }
    for (int n = 0; n < c.buildings + c.lines; n++) {
        const bool outline = n < c.buildings;
        const int  first = outline ? c.building[n].first_corner : c.line[n - c.buildings].first_corner;
        const int  corners = outline ? c.building[n].corners : c.line[n - c.buildings].corners;
        for (int k = outline ? 0 : 1; k < corners; k++) /* corners, and places between them */
            for (int m = 0; m <= 12; m++) {
                const double *p = c.corner_m[first + (k + corners - 1) % corners], *q = c.corner_m[first + k];
                least = fmin(
                    least, path_away_m(fix, (double[2]){p[0] + (q[0] - p[0]) * m / 12, p[1] + (q[1] - p[1]) * m / 12}));
            }
    }
    for (int n = 0; n < c.points; n++)
        least = fmin(least, path_away_m(fix, (double[2]){c.point[n].x_m, c.point[n].y_m}));
    print_message("%d buildings, %d lines, %d points, nearest to a path %.2f m; %d of %d houses left out on paths\n",
                  c.buildings, c.lines, c.points, least, left_out, plots);
    CHECK(c.buildings > 50 && c.lines > 50 && left_out > 0 && least > 12);
    culture_free(&c);
    landscape_destroy(&land);
}

/* Whether a clear line passes over a place by less than it should. */
static bool is_in_the_way(const ClearLine *line, const double p[2], double reach_m, double top_m)
{
    for (int n = 0; n < shots; n++) {
        const double *a = line[n].a_enu, *b = line[n].b_enu, dx = b[0] - a[0], dy = b[1] - a[1];
        const double  t = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy);
        if (t >= 0 && t <= 1 && hypot(a[0] + t * dx - p[0], a[1] + t * dy - p[1]) <= reach_m &&
            a[2] + t * (b[2] - a[2]) < top_m)
            return true;
    }
    return false;
}

static void shots_stay_clear(void **state)
{
    (void)state;
    static ClearLine line[shots];
    Landscape        land;
    int              blocked = 0, over = 0, would = 0, plots;
    GroundFix        corner[4]; /* without a fix the ground would lie low enough for all lines */
    for (int n = 0; n < 4; n++) {
        corner[n] = (GroundFix){.p_enu = {n % 2 ? 2700 : -2700, n / 2 ? 2700 : -2700, 0}, .voter = n + 1};
        corner[n].p_enu[2] = -(2 * 2700.0 * 2700.0) / (2 * 6371e3);
    }
    make(&land, 6, 3000, &(LandscapeEvidence){.fix_count = 4, .fix = corner});
    const HousePlot *plot = landscape_plots(&land, &plots);
    CHECK(plots > shots);
    for (int n = 0; n < shots; n++) { /* across villages, low: the ground is fitted to them */
        const HousePlot *p = &plot[n * plots / shots];
        const double     turn_rad = 2 * pi_rad * random_uniform(4, 0, 0, (uint64_t)n);
        for (int k = 0; k < 2; k++) {
            double *at = k ? line[n].b_enu : line[n].a_enu, away = k ? 200 : -200;
            at[0] = p->x_m + away * cos(turn_rad), at[1] = p->y_m + away * sin(turn_rad);
            at[2] =
                elevation_height(&land.elevation, at[0], at[1], NULL) + 3 + 9 * random_uniform(4, 1, 0, (uint64_t)n);
        }
    }
    landscape_destroy(&land);
    make(&land, 6, 3000, &(LandscapeEvidence){.fix_count = 4, .fix = corner, .line_count = shots, .line = line});
    Culture c = invent(&land, 0, 0, 4000);
    for (int n = 0; n < shots; n++) { /* along each line: what it passes over */
        const double *a = line[n].a_enu, *b = line[n].b_enu;
        const int     parts = (int)ceil(hypot(b[0] - a[0], b[1] - a[1]) / 0.25);
        for (int k = 0; k <= parts; k++) {
            const double t = (double)k / parts, x = a[0] + t * (b[0] - a[0]), y = a[1] + t * (b[1] - a[1]);
            const int    at = culture_building_at(&c, x, y, 0);
            if (at < 0) continue;
            over++;
            blocked += (double)c.building[at].base_m + (double)c.building[at].ridge_m > a[2] + t * (b[2] - a[2]);
        }
    }
    for (int n = 0; n < c.points; n++) {
        const CulturePoint *p = &c.point[n];
        blocked += is_in_the_way(line, (double[2]){p->x_m, p->y_m}, 0.5 * (double)p->size_m[0],
                                 (double)(p->base_m + p->size_m[2]));
    }
    for (int n = 0; n < c.lines; n++)
        for (int k = 1; k < c.line[n].corners; k++) {
            const double *p = c.corner_m[c.line[n].first_corner + k - 1], *q = c.corner_m[c.line[n].first_corner + k];
            const int     parts = c.line[n].height_m > 0 ? (int)ceil(hypot(q[0] - p[0], q[1] - p[1]) / 0.25) : 0;
            for (int m = 0; m < parts; m++) {
                const double r[2] = {p[0] + (q[0] - p[0]) * m / parts, p[1] + (q[1] - p[1]) * m / parts};
                blocked += is_in_the_way(
                    line, r, 0.3, elevation_height(&land.elevation, r[0], r[1], NULL) + (double)c.line[n].height_m);
            }
        }
    plot = landscape_plots(&land, &plots);
    for (int n = 0; n < plots; n++) {
        const double house[2] = {
            plot[n].x_m + plot[n].house[0] * plot[n].direction[0] - plot[n].house[1] * plot[n].direction[1],
            plot[n].y_m + plot[n].house[0] * plot[n].direction[1] + plot[n].house[1] * plot[n].direction[0]};
        would += is_in_the_way(line, house, 4, elevation_height(&land.elevation, house[0], house[1], NULL) + 11) &&
                 !building_at(&c, house[0], house[1]);
    }
    print_message("%d buildings; %d places under lines, %d in the way; %d houses left out for them\n", c.buildings,
                  over, blocked, would);
    CHECK(c.buildings > 50 && would > 0 && over > 0 && blocked == 0);
    culture_free(&c);
    landscape_destroy(&land);
}

/* ---- woods ------------------------------------------------------------------------------------------- */

/* The plants of woods with culture are those without, in order, less the ones within 1.5 m of what is built. */
static void woods_keep_off(void **state)
{
    (void)state;
    Landscape land;
    Woods     wild, kept;
    double    village[2];
    int       gone = 0, at = 0, inside = 0, grass = 0;
    make(&land, 5, 3000, NULL);
    CHECK(landscape_village(village, &land, 0));
    Culture     c = invent(&land, village[0], village[1], 700);
    WoodsConfig config = {
        .seed = 2, .centre_m = {village[0], village[1]}, .half_width_m = 400, .most_trees = woods_most_trees};
    CHECK(woods_create(&wild, &land, &config, NULL) == STATUS_OK);
    config.culture = &c;
    CHECK(woods_create(&kept, &land, &config, NULL) == STATUS_OK);
    for (int k = 0; k < wild.count; k++) {
        const double p[2] = {wild.origin_enu[0] + (double)wild.plant[k].p_m[0],
                             wild.origin_enu[1] + (double)wild.plant[k].p_m[1]};
        double       least = INFINITY;
        for (int n = 0; n < c.buildings; n++)
            for (int m = 0; m < 4; m++)
                least = fmin(least, away_m(p, c.corner_m[c.building[n].first_corner + m],
                                           c.corner_m[c.building[n].first_corner + (m + 1) % 4]));
        for (int n = 0; n < c.lines; n++)
            for (int m = 1; m < c.line[n].corners; m++)
                least = fmin(least, away_m(p, c.corner_m[c.line[n].first_corner + m - 1],
                                           c.corner_m[c.line[n].first_corner + m]) -
                                        0.5 * (double)c.line[n].width_m);
        for (int n = 0; n < c.points; n++)
            least = fmin(least, hypot(c.point[n].x_m - p[0], c.point[n].y_m - p[1]) -
                                    0.5 * hypot((double)c.point[n].size_m[0], (double)c.point[n].size_m[1]));
        const bool near = least < 1.5 || culture_building_at(&c, p[0], p[1], 0) >= 0;
        if (fabs(least - 1.5) < 1e-3 && at < kept.count && memcmp(&kept.plant[at], &wild.plant[k], sizeof(Plant)) == 0)
            at++;
        else if (near) gone++;
        else CHECK(at < kept.count && memcmp(&kept.plant[at++], &wild.plant[k], sizeof(Plant)) == 0);
    }
    CHECK(at == kept.count && gone > 20);
    const double lattice_m = woods_low_m;
    for (int n = 0; n < c.buildings; n++) { /* low plants */
        static Plant  plant[woods_low_most];
        const double *p = c.corner_m[c.building[n].first_corner];
        if (hypot(p[0] - village[0], p[1] - village[1]) > 150) continue;
        const int64_t i = (int64_t)floor((p[0] - kept.origin_enu[0]) / lattice_m),
                      j = (int64_t)floor((p[1] - kept.origin_enu[1]) / lattice_m);
        const int count = woods_low_plants(plant, &kept, i, j);
        for (int k = 0; k < count; k++, grass++)
            inside += culture_building_at(&c, kept.origin_enu[0] + (double)i * lattice_m + (double)plant[k].p_m[0],
                                          kept.origin_enu[1] + (double)j * lattice_m + (double)plant[k].p_m[1], 0) >= 0;
    }
    print_message("%d of %d plants are gone; %d low ones beside buildings, %d in them\n", gone, wild.count, grass,
                  inside);
    CHECK(grass > 100 && inside == 0);
    woods_destroy(&wild), woods_destroy(&kept);
    culture_free(&c);
    landscape_destroy(&land);
}

static void remove_folder(const char *folder)
{
    DIR *dir = opendir(folder);
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        char path[512];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        remove(path);
    }
    if (dir) closedir(dir);
    remove(folder);
}

/* What is kept between runs is kept for its culture: none, one, or one with a building more. */
static void kept_woods_know_their_culture(void **state)
{
    (void)state;
    char      folder[64];
    Landscape land;
    double    village[2];
    int       plants[6];
    make(&land, 5, 3000, NULL);
    CHECK(landscape_village(village, &land, 0));
    Culture      c = invent(&land, village[0], village[1], 300), more = invent(&land, village[0], village[1], 300);
    const double wood[4][2] = {{village[0] - 90, village[1] - 90},
                               {village[0] + 90, village[1] - 90},
                               {village[0] + 90, village[1] + 90},
                               {village[0] - 90, village[1] + 90}};
    CHECK(culture_add_building(&more, &(Building){.id = 1, .eaves_m = 3, .ridge_m = 4}, wood, 4) == STATUS_OK);
    CHECK(culture_index(&more) == STATUS_OK);
    snprintf(folder, sizeof folder, "/tmp/test_culture_clear_%ld", (long)getpid());
    Cache *cache = cache_open(folder, (size_t)1 << 28);
    CHECK(cache != NULL);
    for (int k = 0; k < 6; k++) {
        Woods             w;
        const Culture    *of[3] = {NULL, &c, &more};
        const WoodsConfig config = {.seed = 2,
                                    .centre_m = {village[0], village[1]},
                                    .half_width_m = 200,
                                    .most_trees = woods_most_trees,
                                    .culture = of[k % 3],
                                    .cache = cache,
                                    .follows = "a test"};
        CHECK(woods_create(&w, &land, &config, NULL) == STATUS_OK);
        plants[k] = w.count;
        woods_destroy(&w);
    }
    CHECK(cache_counters(cache).fetched == 3);
    for (int k = 0; k < 3; k++) CHECK(plants[k] == plants[k + 3]);
    CHECK(plants[0] > plants[1] && plants[1] > plants[2]);
    cache_close(cache);
    remove_folder(folder);
    culture_free(&c), culture_free(&more);
    landscape_destroy(&land);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_where_vehicles_were),
        cmocka_unit_test(shots_stay_clear),
        cmocka_unit_test(woods_keep_off),
        cmocka_unit_test(kept_woods_know_their_culture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
