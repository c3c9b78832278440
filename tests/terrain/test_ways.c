/* Ways of the synthetic landscape: streams descend and end in water or at the rim, roads join the villages, nothing of
 * them lies under a reported vehicle, and plots keep off the roads. */
#include "tests/check.h"

#include "terrain/landscape/ways.h"

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
        for (int n = 0; n < plots; n++)
            on_road += landscape_surface(&land, plot[n].x_m, plot[n].y_m) == SURFACE_ROAD;
        print_message("seed %d: %d of %d villages, %d plots\n", (int)seed, reached, villages, plots);
        CHECK(villages >= 2 && reached == villages && plots > 20 && on_road == 0);
        landscape_destroy(&land);
    }
}

static void vehicles_stand_in_the_open(void **state)
{
    (void)state;
    enum { fixes = 400 };
    static GroundFix fix[fixes];
    for (uint64_t seed = 1; seed <= 3; seed++) {
        Landscape land;
        int       tracks = 0;
        for (int n = 0; n < fixes; n++) { /* a hundred that stand, and three that drive */
            const uint64_t v = n < 100 ? (uint64_t)n : 100 + (uint64_t)(n - 100) / 100;
            const double   along_m = n < 100 ? 0 : 15.0 * ((n - 100) % 100 - 50);
            fix[n] = (GroundFix){.voter = (int)v + 1};
            fix[n].p_enu[0] = 2400 * (random_uniform(seed, 0, 0, v) - 0.5) + along_m;
            fix[n].p_enu[1] = 5000 * (random_uniform(seed, 1, 0, v) - 0.5) + 0.1 * along_m;
            fix[n].p_enu[2] = -(pow(fix[n].p_enu[0], 2) + pow(fix[n].p_enu[1], 2)) / (2 * 6371e3);
        }
        make(&land, seed, fix, fixes);
        for (int n = 0; n < fixes; n++) {
            const double       x = fix[n].p_enu[0], y = fix[n].p_enu[1];
            const SurfaceClass s = landscape_surface(&land, x, y);
            CHECK(s != SURFACE_SCRUB && s != SURFACE_WATER && s != SURFACE_ROCK && s != SURFACE_BUILT);
            CHECK(s != SURFACE_ROAD && s != SURFACE_WETLAND && s != SURFACE_NONE);
            tracks += n >= 100 && s == SURFACE_TRACK;
        }
        print_message("seed %d: %d of 300 on tracks, worst fix %.4f m\n", (int)seed, tracks, land.fit_worst_m);
        CHECK(tracks > 200);
        landscape_destroy(&land);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(streams_descend),
        cmocka_unit_test(roads_join_the_villages),
        cmocka_unit_test(vehicles_stand_in_the_open),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
