/* Ways of the synthetic landscape: streams descend and end in water or at the rim, roads join the villages, tracks lead
 * into the fields, none of it follows where vehicles are reported, and plots keep off the roads. */
#include "tests/check.h"

#include "terrain/detail/detail.h"
#include "terrain/ground/landscape.h"

enum { most = 20000 };
static double vertex[most][2];

static void make(Landscape *land, uint64_t seed, const GroundFix *fix, int count)
{
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    config.seed = seed;
    config.half_width_m = 3000;
    config.horizon_m = 30000;
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    CHECK(landscape_create(land, &config, &frame, fix, count, NULL, 0) == STATUS_OK);
}

static double height(const Landscape *land, const double p[2])
{
    return elevation_height(&land->elevation, p[0], p[1], NULL) + (p[0] * p[0] + p[1] * p[1]) / (2 * 6371e3);
}

static void streams_descend(void **state)
{
    (void)state;
    Landscape land;
    WayKind   kind;
    int       streams = 0, rising = 0, dry = 0;
    make(&land, 5, NULL, 0);
    for (int way = 0, count; (count = landscape_way_vertices(vertex, &kind, &land, way, most)) > 0; way++) {
        if (kind != WAY_STREAM) continue;
        streams++;
        for (int n = 1; n < count; n++) rising += height(&land, vertex[n]) > height(&land, vertex[n - 1]) + 1e-3;
        const double *end = vertex[count - 1];
        const bool    rim = fmax(fabs(end[0]), fabs(end[1])) > 2980;
        /* a stream, a pond, or a road over them */
        const SurfaceClass last = landscape_surface(&land, end[0], end[1]);
        dry += !rim && last != SURFACE_WATER && last != SURFACE_ROAD && last != SURFACE_TRACK;
    }
    print_message("%d streams, %d rises, %d end dry\n", streams, rising, dry);
    CHECK(streams > 10 && rising == 0 && dry == 0);
    landscape_destroy(&land);
}

/* Every village is on a road, and all of them on one network: walked over the roads' places. */
static void roads_join_the_villages(void **state)
{
    (void)state;
    enum { cell_m = 10, side = 600 };
    static uint8_t map[side * side]; /* 1: road, 2: reached */
    static int     queue[side * side];
    for (uint64_t seed = 1; seed <= 3; seed++) {
        Landscape land;
        WayKind   kind;
        double    place[2];
        int       villages = 0, reached = 0, end = 0, plots;
        make(&land, seed, NULL, 0);
        memset(map, 0, sizeof map);
        for (int way = 0, count; (count = landscape_way_vertices(vertex, &kind, &land, way, most)) > 0; way++)
            for (int n = 0; n < count && kind == WAY_ROAD; n++) {
                const int i = (int)clamp((vertex[n][0] + 3000) / cell_m, 0, side - 1);
                const int j = (int)clamp((vertex[n][1] + 3000) / cell_m, 0, side - 1);
                map[j * side + i] = 1;
            }
        for (int n = 0; n < side * side && !end; n++)
            if (map[n]) map[n] = 2, queue[end++] = n;
        for (int n = 0; n < end; n++)
            for (int k = 0; k < 25; k++) {
                const int i = queue[n] % side + k % 5 - 2, j = queue[n] / side + k / 5 - 2;
                if (i < 0 || j < 0 || i >= side || j >= side || map[j * side + i] != 1) continue;
                map[j * side + i] = 2;
                queue[end++] = j * side + i;
            }
        for (; landscape_village(place, &land, villages); villages++) {
            bool here = false;
            for (int n = 0; n < end && !here; n++)
                here = hypot((queue[n] % side + 0.5) * cell_m - 3000 - place[0],
                             (queue[n] / side + 0.5) * cell_m - 3000 - place[1]) < 80;
            reached += here;
        }
        const HousePlot *plot = landscape_plots(&land, &plots);
        int              on_road = 0;
        for (int n = 0; n < plots; n++) on_road += landscape_surface(&land, plot[n].x_m, plot[n].y_m) == SURFACE_ROAD;
        print_message("seed %d: %d of %d villages, %d plots\n", (int)seed, reached, villages, plots);
        CHECK(villages >= 2 && reached == villages && plots > 20 && on_road == 0);
        landscape_destroy(&land);
    }
}

/* Hedgerows: strips of scrub between other classes, none across a way. */
static void hedges_stand_on_borders(const Landscape *land)
{
    const double half[2][2] = {{-1200, -1200}, {1200, 0}}, rest[2][2] = {{-1200, 0}, {1200, 1200}};
    HedgePlace  *hedge, *more;
    int          count, others, narrow = 0, of_height[3] = {0};
    CHECK(landscape_hedges(&hedge, &count, land, half[0], half[1], 8) == STATUS_OK);
    CHECK(landscape_hedges(&more, &others, land, rest[0], rest[1], 8) == STATUS_OK);
    CHECK(count > 200 && others > 200);
    for (int n = 0; n < count; n++) {
        const HedgePlace *h = &hedge[n];
        WayPlace          way;
        int               open = 0;
        of_height[h->height]++;
        for (int k = 0; k < 16; k++) /* 7 m off, most is of other classes */
            open += landscape_surface(land, h->x_m + 7 * cos(k * pi_rad / 8), h->y_m + 7 * sin(k * pi_rad / 8)) !=
                    SURFACE_SCRUB;
        narrow += open >= 8;
        CHECK(!landscape_way(&way, land, h->x_m, h->y_m) || fabs(way.across_m) > way.half_m || way.kind > WAY_TRACK);
    }
    print_message("%d and %d places of hedges, %d on strips, %d cut, %d shrubs, %d trees\n", count, others, narrow,
                  of_height[0], of_height[1], of_height[2]);
    CHECK(narrow > count * 7 / 10 && of_height[0] && of_height[1] && of_height[2]);
    free(hedge), free(more);
}

/* Vehicles are reported on the very ground that is there without them: a hundred that stand, three that drive 1.5 km.
 * Led through them it is another by decimetres between, by which roads and streams may run elsewhere; but classes under
 * the vehicles are the same ones as often as those 8 m beside, and no track follows a drive. */
static void ground_does_not_follow_vehicles(void **state)
{
    (void)state;
    enum { fixes = 400 };
    static GroundFix fix[fixes];
    for (uint64_t seed = 1; seed <= 3; seed++) {
        Landscape wild, land;
        int       under[2] = {0}, beside[2] = {0}, in_house = 0, tracks = 0, ways = 0, of[WAY_KINDS] = {0};
        WayKind   kind;
        make(&wild, seed, NULL, 0);
        for (int n = 0; n < fixes; n++) {
            const uint64_t v = n < 100 ? (uint64_t)n : 100 + (uint64_t)(n - 100) / 100;
            const double   along_m = n < 100 ? 0 : 15.0 * ((n - 100) % 100 - 50);
            fix[n] = (GroundFix){.voter = (int)v + 1};
            fix[n].p_enu[0] = 2400 * (random_uniform(seed, 0, 0, v) - 0.5) + along_m;
            fix[n].p_enu[1] = 5000 * (random_uniform(seed, 1, 0, v) - 0.5) + 0.1 * along_m;
            fix[n].p_enu[2] = elevation_height(&wild.elevation, fix[n].p_enu[0], fix[n].p_enu[1], NULL);
        }
        make(&land, seed, fix, fixes);
        for (int n = 0; n < fixes; n++)
            for (int k = 0; k < 25; k++) {
                const double       x = fix[n].p_enu[0] + 4 * (k % 5 - 2), y = fix[n].p_enu[1] + 4 * (k / 5 - 2);
                const SurfaceClass was = landscape_surface(&wild, x, y), is = landscape_surface(&land, x, y);
                const int          far = abs(k % 5 - 2) > 1 || abs(k / 5 - 2) > 1;
                (far ? beside : under)[0]++, (far ? beside : under)[1] += is != was;
                in_house += k == 12 && is == SURFACE_BUILT;
            }
        for (int count; (count = landscape_way_vertices(vertex, &kind, &land, ways, most)) > 0; ways++) {
            of[kind]++;
            for (int n = 0; kind == WAY_TRACK && n < count; n++)
                for (int k = 100; k < fixes; k++)
                    tracks += hypot(fix[k].p_enu[0] - vertex[n][0], fix[k].p_enu[1] - vertex[n][1]) < 3;
        }
        hedges_stand_on_borders(&land);
        const double share[2] = {(double)under[1] / under[0], (double)beside[1] / beside[0]};
        print_message("seed %d: %.3f of the places under vehicles have another class, %.3f beside; %d tracks, %d of "
                      "their vertices under a vehicle; worst fix %.4f m\n",
                      (int)seed, share[0], share[1], of[WAY_TRACK], tracks, land.fit_worst_m);
        CHECK(share[0] < 0.25 && fabs(share[0] - share[1]) < 0.02 && in_house == 0);
        CHECK(of[WAY_TRACK] > 10 && tracks < 30);
        landscape_destroy(&land), landscape_destroy(&wild);
    }
}

/* ---- detail ------------------------------------------------------------------------------------ */

enum { across = 512 };
static double  place_x[across], place_y[across];
static uint8_t of_class[across];
static float   albedo[across], warmth_k[across], radar[across], slope_x[across], slope_y[across], footprint[across];

/* Over a section of 4 m about a place, from right to left. */
static void ask_section(const Landscape *land, const double middle[2], const double left[2], double footprint_m)
{
    for (int n = 0; n < across; n++) {
        const double d = 4.0 * (n + 0.5) / across - 2;
        place_x[n] = middle[0] + d * left[0], place_y[n] = middle[1] + d * left[1];
        of_class[n] = SURFACE_TRACK, footprint[n] = (float)footprint_m;
        albedo[n] = radar[n] = 1, warmth_k[n] = slope_x[n] = slope_y[n] = 0;
    }
    detail_ways(&(GroundDetail){albedo, warmth_k, radar, slope_x, slope_y}, land, across, of_class, place_x, place_y,
                footprint);
}

/* A track has two ruts and a grassy middle; a footprint sees means over itself; one as wide as the track, nothing. */
static void tracks_have_ruts(void **state)
{
    (void)state;
    static double sharp[2][across];
    Landscape     land;
    WayKind       kind = WAY_NONE;
    int           way = 0, count = 0, apart = 0;
    make(&land, 5, NULL, 0);
    for (; kind != WAY_TRACK && (count = landscape_way_vertices(vertex, &kind, &land, way, most)) > 0; way++) {
    }
    CHECK(kind == WAY_TRACK && count > 4);
    const double *a = vertex[count / 2], *b = vertex[count / 2 + 1], length = hypot(b[0] - a[0], b[1] - a[1]);
    const double  middle[2] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])};
    const double  left[2] = {-(b[1] - a[1]) / length, (b[0] - a[0]) / length};
    ask_section(&land, middle, left, 0);
    double worst_m = 0, height_m = 0;
    for (int n = 0; n < across; n++) { /* the slopes are those of two ruts 4.5 cm deep and a crest of twice 1 cm */
        const double d = 4.0 * (n + 1.0) / across - 2, low = (d - 0.8) / 0.2, high = (d + 0.8) / 0.2, crest = d / 0.3;
        if (fabs(d) > 1.7) continue; /* half its width */
        const double here = -0.045 * (exp(-low * low / 2) + exp(-high * high / 2)) + 0.020 * exp(-crest * crest / 2);
        if (height_m == 0) height_m = here;
        else height_m += (double)slope_x[n] * left[0] * 4 / across + (double)slope_y[n] * left[1] * 4 / across;
        worst_m = fmax(worst_m, fabs(height_m - here));
        sharp[0][n] = (double)albedo[n], sharp[1][n] = (double)warmth_k[n];
    }
    print_message("worst height %.1e m, ruts %.3f, middle %.3f\n", worst_m, (double)albedo[across * 7 / 10],
                  (double)albedo[across / 2]);
    CHECK(worst_m < 1e-5); /* floats of slopes, summed over 3 m; ruts are 45 mm deep */
    CHECK(albedo[across * 7 / 10] > albedo[across / 2] + 0.2f && warmth_k[across * 7 / 10] > warmth_k[across / 2]);
    /* means over 0.5 m of it */
    ask_section(&land, middle, left, 0.5);
    for (int n = 0; n < across; n++) {
        double    mean[2] = {0, 0};
        const int reach = across / 16; /* 0.25 m */
        if (fabs(4.0 * (n + 0.5) / across - 2) > 1.4) continue;
        for (int m = n - reach; m < n + reach; m++)
            for (int k = 0; k < 2; k++) mean[k] += sharp[k][m] / (2 * reach);
        apart += fabs(mean[0] - (double)albedo[n]) > 0.02 || fabs(mean[1] - (double)warmth_k[n]) > 0.04;
    }
    CHECK(apart == 0);
    ask_section(&land, middle, left, 1.7);
    for (int n = 0; n < across; n++)
        CHECK(albedo[n] == 1 && warmth_k[n] == 0 && radar[n] == 1 && slope_x[n] == 0 && slope_y[n] == 0);
    landscape_destroy(&land);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(streams_descend),
        cmocka_unit_test(roads_join_the_villages),
        cmocka_unit_test(ground_does_not_follow_vehicles),
        cmocka_unit_test(tracks_have_ruts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
