/* The invented landscape: it keeps its promises to fixes, to lines, and at its own seams. */
#include "tests/check.h"

#include "terrain/ground/landscape.h"

static LocalFrame frame_at(double lat_deg, double lon_deg, double h_m)
{
    const Geodetic origin = {lat_deg * rad_per_deg, lon_deg * rad_per_deg, h_m};
    LocalFrame     frame;
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    return frame;
}

/* Small enough to build in a blink, all four levels nevertheless. */
static LandscapeConfig small_config(uint64_t seed)
{
    LandscapeConfig config = landscape_default_config();
    config.seed = seed;
    config.half_width_m = 1500;
    config.horizon_m = 100000;
    return config;
}

/* ENU place h_m above the ellipsoid at (x, y): Newton on z against GeographicLib, no formula of the landscape's. */
static void place_above(double p_enu[3], const LocalFrame *frame, double x_m, double y_m, double h_m)
{
    p_enu[0] = x_m;
    p_enu[1] = y_m;
    p_enu[2] = 0;
    for (int k = 0; k < 6; k++) {
        double   p_ecef[3];
        Geodetic g;
        ecef_from_enu(p_ecef, frame, p_enu);
        CHECK(geodetic_from_ecef(&g, p_ecef) == STATUS_OK);
        p_enu[2] += h_m - g.h_m;
    }
}

static double country_m(double x_m, double y_m)
{
    return 240 + 14 * sin(x_m / 410) * cos(y_m / 530) + 4 * sin(x_m / 97 + 1) + 0.8 * sin(y_m / 31);
}

/* Vehicles driving about: reports every 3 .. 12 m along curves. */
static int drive(GroundFix *fix, int capacity, const LocalFrame *frame, uint64_t seed, int vehicles)
{
    int count = 0;
    for (int v = 0; v < vehicles; v++) {
        double x = 2400 * (random_uniform(seed, 0, 0, v) - 0.5), y = 2400 * (random_uniform(seed, 1, 0, v) - 0.5);
        double heading = 2 * pi_rad * random_uniform(seed, 2, 0, v);
        for (int n = 0; n < 120 && count < capacity; n++) {
            place_above(fix[count++].p_enu, frame, x, y, country_m(x, y));
            const double step = 3 + 9 * random_uniform(seed, 3, (uint32_t)v, n);
            heading += 0.15 * random_normal(seed, 4, (uint32_t)v, n);
            x += step * cos(heading);
            y += step * sin(heading);
        }
    }
    return count;
}

static void same_input_same_bits(void **state)
{
    (void)state;
    enum { room = 1000 };
    static GroundFix      fix[room];
    const LocalFrame      frame = frame_at(36, -123, 0);
    const LandscapeConfig config = small_config(7);
    const int             count = drive(fix, room, &frame, 1, 5);
    const ClearLine       line = {{-1200, 0, 250}, {1200, 100, 235}};
    Landscape             a, b;
    CHECK(landscape_create(&a, &config, &frame, fix, count, &line, 1) == STATUS_OK);
    CHECK(landscape_create(&b, &config, &frame, fix, count, &line, 1) == STATUS_OK);
    CHECK(a.elevation.level_count == 4 && b.elevation.level_count == 4);
    for (int k = 0; k < 4; k++) {
        const ElevationLevel *p = &a.elevation.level[k], *q = &b.elevation.level[k];
        CHECK(p->nx == q->nx && p->ny == q->ny && p->z0_m == q->z0_m && p->step_m == q->step_m);
        CHECK(memcmp(p->stored, q->stored, elevation_level_stored(p) * sizeof *p->stored) == 0);
    }
    for (int n = 0; n < 2000; n++) {
        const double       x = 3000 * random_uniform(1, 5, 0, n), y = 3000 * random_uniform(1, 6, 0, n);
        const SurfaceClass s = landscape_surface(&a, x, y);
        CHECK(s == landscape_surface(&b, x, y));
    }
    landscape_destroy(&b);

    /* another seed is another country */
    LandscapeConfig other = config;
    other.seed = 8;
    CHECK(landscape_create(&b, &other, &frame, NULL, 0, NULL, 0) == STATUS_OK);
    int differ = 0;
    for (int n = 0; n < 1000; n++)
        differ += landscape_surface(&a, 3.0 * n, 1.7 * n) != landscape_surface(&b, 3.0 * n, 1.7 * n);
    CHECK(differ > 300);
    landscape_destroy(&a);
    landscape_destroy(&b);
}

/* Without relief every post is on the ellipsoid: half a step of rounding (a whole one on the far levels, and on the
 * rim of a hole a multiple of its neighbour's) and nothing else, at every latitude. */
static void posts_follow_the_curved_earth(void **state)
{
    (void)state;
    static const double place[][3] = {{36, -123, 0}, {-33, 18, 900}, {85, 10, 50}, {0, 180, 0}};
    for (int n = 0; n < 4; n++) {
        const LocalFrame frame = frame_at(place[n][0], place[n][1], place[n][2]);
        LandscapeConfig  config = small_config(1);
        config.relief_m = 0;
        config.horizon_m = 420000;
        Landscape land;
        CHECK(landscape_create(&land, &config, &frame, NULL, 0, NULL, 0) == STATUS_OK);
        for (int k = 0; k < land.elevation.level_count; k++) {
            const ElevationLevel *level = &land.elevation.level[k];
            const double          finer_m = k ? 8 * land.elevation.level[k - 1].step_m : 0;
            const double          coarser_m = k < 3 ? fmax(8 * level->step_m, level[1].step_m) : 0;
            const double          allowed_m = fmax(level->step_m, fmax(finer_m, coarser_m)) + 2e-3;
            double                inside_m = 0;
            for (int m = 0; m < 3000; m++) {
                const int    i = (int)(random_uniform(n, 1, (uint32_t)k, m) * level->nx);
                const int    j = (int)(random_uniform(n, 2, (uint32_t)k, m) * level->ny);
                const double p_enu[3] = {level->x0_m + i * level->spacing_m, level->y0_m + j * level->spacing_m,
                                         elevation_post_m(level, i, j)};
                double       p_ecef[3];
                Geodetic     g;
                ecef_from_enu(p_ecef, &frame, p_enu);
                CHECK(geodetic_from_ecef(&g, p_ecef) == STATUS_OK);
                /* edge posts lie on the chord between posts eight times as far apart, below the arc */
                const bool   edge = i == 0 || j == 0 || i == level->nx - 1 || j == level->ny - 1;
                const double sag_m = edge ? pow(8 * level->spacing_m, 2) / 8 / 6.33e6 : 0;
                CHECK_NEAR(g.h_m, 0, allowed_m + sag_m);
                if (i > 90 && j > 90 && i < level->nx - 90 && j < level->ny - 90 && k == 0)
                    inside_m = fmax(inside_m, fabs(g.h_m));
            }
            if (k == 0) CHECK_NEAR(inside_m, 0, level->step_m / 2 + 1e-3);
        }
        landscape_destroy(&land);
    }
}

/* Every level against the one around it, along the outline: not nearly equal, equal. Twelve digits are lost to the
 * interpolation itself. */
static void no_crack_between_levels(void **state)
{
    (void)state;
    enum { room = 1000 };
    static GroundFix fix[room];
    const LocalFrame frame = frame_at(21, -158, 0);
    const int        count = drive(fix, room, &frame, 3, 6);
    const ClearLine  line[2] = {{{-1700, -1300, 225}, {1900, 1480, 225}}, {{-30000, 5000, 100}, {30000, 4000, 100}}};
    for (int kind = 0; kind < 3; kind++) {
        LandscapeConfig config = small_config(11 + kind);
        config.relief_m = kind == 2 ? 120 : 15;
        if (kind == 1) config.spacing_m = 3.7;
        Landscape land;
        CHECK(landscape_create(&land, &config, &frame, fix, kind == 2 ? 0 : count, line, 2) == STATUS_OK);
        for (int k = 0; k + 1 < land.elevation.level_count; k++) {
            const ElevationLevel *in = &land.elevation.level[k];
            Elevation             outer = {.level_count = land.elevation.level_count - k - 1};
            memcpy(outer.level, in + 1, sizeof *in * (size_t)outer.level_count);
            const double hole = in[1].spacing_m, w = (in->nx - 1) * in->spacing_m, h = (in->ny - 1) * in->spacing_m;
            CHECK_NEAR(in[1].spacing_m / in->spacing_m, 8, 0);
            CHECK_NEAR(fmod(in->x0_m - in[1].x0_m, hole), 0, 0);
            CHECK_NEAR(fmod(in->y0_m - in[1].y0_m, hole), 0, 0);
            CHECK_NEAR(fmod(w, hole), 0, 0);
            CHECK_NEAR(fmod(h, hole), 0, 0);
            for (int m = 0; m < 20000; m++) {
                const double t = random_uniform(9, (uint32_t)k, (uint32_t)kind, m);
                const double x = m % 4 < 2 ? in->x0_m + t * w : m % 4 == 2 ? in->x0_m : in->x0_m + w;
                const double y = m % 4 >= 2 ? in->y0_m + t * h : m % 4 == 0 ? in->y0_m : in->y0_m + h;
                const double inner_m = elevation_height(&land.elevation, x, y, NULL);
                const double outer_m = elevation_height(&outer, x, y, NULL);
                CHECK_NEAR(inner_m, outer_m, 1e-9 * (1 + fabs(inner_m)));
                /* and just beyond and just inside: only what a slope makes of a millimetre */
                const double beyond_m = elevation_height(&land.elevation, x * (1 + 1e-6), y * (1 + 1e-6), NULL);
                const double inside_m = elevation_height(&land.elevation, x * (1 - 1e-6), y * (1 - 1e-6), NULL);
                CHECK_NEAR(beyond_m, inside_m, 2 * hypot(x, y) * 2e-6);
            }
        }
        landscape_destroy(&land);
    }
}

/* Every kept fix, evaluated here and not by the landscape. */
static double worst_fix(const Landscape *land, const GroundFix *fix, int count, const bool *skip)
{
    double worst_m = 0;
    for (int n = 0; n < count; n++) {
        if (skip && skip[n]) continue;
        const double off_m =
            fabs(elevation_height(&land->elevation, fix[n].p_enu[0], fix[n].p_enu[1], NULL) - fix[n].p_enu[2]);
        if (!(off_m <= worst_m)) worst_m = off_m;
    }
    return worst_m;
}

static void passes_through_every_fix(void **state)
{
    (void)state;
    enum { room = 8000 };
    static GroundFix fix[room];
    static const int vehicles[] = {1, 3, 10, 60};
    for (int n = 0; n < 4; n++) {
        const LocalFrame      frame = frame_at(-40 + 25 * n, 30 * n, 200);
        const LandscapeConfig config = small_config(20 + n);
        const int             count = drive(fix, room, &frame, 40 + n, vehicles[n]);
        Landscape             land;
        CHECK(landscape_create(&land, &config, &frame, fix, count, NULL, 0) == STATUS_OK);
        const double worst_m = worst_fix(&land, fix, count, NULL);
        printf("%d fixes: worst %.4f m, dropped %d\n", count, worst_m, land.fixes_dropped);
        CHECK(land.fixes_dropped == 0);
        CHECK_NEAR(worst_m, 0, 0.05);
        CHECK_NEAR(land.fit_worst_m, worst_m, 0);
        landscape_destroy(&land);
    }

    /* few and far apart, most of them beyond the innermost level's width, on the level that is finest there */
    const LocalFrame frame = frame_at(50, 8, 0);
    LandscapeConfig  config = small_config(30);
    for (int n = 0; n < 12; n++) {
        const double a = n * pi_rad / 6, r = n % 2 ? 900 : 40000;
        place_above(fix[n].p_enu, &frame, r * cos(a), r * sin(a), 300 + 20 * sin(5.0 * n));
    }
    Landscape land;
    CHECK(landscape_create(&land, &config, &frame, fix, 12, NULL, 0) == STATUS_OK);
    CHECK(land.fixes_dropped == 0);
    CHECK_NEAR(worst_fix(&land, fix, 12, NULL), 0, 0.05);
    landscape_destroy(&land);
}

/* One report from far under the ground, a burst on a roof, a vehicle under a helicopter: they go, alone. */
static void contradictions_are_dropped_and_the_rest_is_met(void **state)
{
    (void)state;
    enum { room = 1000, liars = 5 };
    static GroundFix      fix[room];
    static bool           skip[room];
    const LocalFrame      frame = frame_at(48, 11, 500);
    const LandscapeConfig config = small_config(5);
    int                   count = drive(fix, room - liars, &frame, 50, 6);
    static const double   lie_m[liars] = {-700, 8, 60, 2.5, 1500};
    for (int n = 0; n < liars; n++) {
        const double *truth = fix[97 * n + 11].p_enu;
        skip[count] = true;
        fix[count++] = (GroundFix){.p_enu = {truth[0] + 0.3, truth[1], truth[2] + lie_m[n]}};
    }
    Landscape land;
    CHECK(landscape_create(&land, &config, &frame, fix, count, NULL, 0) == STATUS_OK);
    CHECK(land.fixes_dropped == liars);
    CHECK_NEAR(worst_fix(&land, fix, count, skip), 0, 0.05);
    for (int n = 0; n < count; n++)
        if (skip[n])
            CHECK(fabs(elevation_height(&land.elevation, fix[n].p_enu[0], fix[n].p_enu[1], NULL) - fix[n].p_enu[2]) >
                  1);
    landscape_destroy(&land);

    /* a parked tank reports a hundred times, a shell bursts on it, another is reported beneath it once */
    for (int n = 0; n < 100; n++) place_above(fix[n].p_enu, &frame, 30, 40, 510 + 0.003 * (n % 3));
    place_above(fix[100].p_enu, &frame, 30.2, 40, 512);
    place_above(fix[101].p_enu, &frame, 30.1, 40.1, 507);
    CHECK(landscape_create(&land, &config, &frame, fix, 102, NULL, 0) == STATUS_OK);
    CHECK(land.fixes_dropped == 2);
    CHECK_NEAR(worst_fix(&land, fix, 100, NULL), 0, 0.05);
    landscape_destroy(&land);

    /* a kerb that four-metre posts cannot follow: whoever is kept is met */
    for (int n = 0; n < 60; n++) place_above(fix[n].p_enu, &frame, 0.4 * n - 12, 0, n > 20 && n < 30 ? 500.2 : 500);
    CHECK(landscape_create(&land, &config, &frame, fix, 60, NULL, 0) == STATUS_OK);
    CHECK(land.fixes_dropped > 0 && land.fixes_dropped < 30);
    CHECK_NEAR(land.fit_worst_m, 0, 0.05);
    landscape_destroy(&land);
}

/* Other people's vehicles on other people's ground: every Entity State of the ground vehicles in recorded
 * exercises, as tshark reads them. Columns: 7 entity number, 13 .. 15 ECEF location. */
static void recorded_vehicles_stand_on_it(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int         entity[4]; /* ground vehicles; 0: everybody */
    } log[] = {{"dis/vrf-dis5-tow-vs-armor.espdu.tsv", {70, 72, 73, 74}}, {"dis/vrf-dis7-gaz69-blocks.espdu.tsv", {0}}};
    enum { room = 1000 };
    static GroundFix fix[room];
    for (int n = 0; n < 2; n++) {
        char path[512], text[4096];
        if (!reference_path(path, log[n].name)) skip();
        FILE      *file = fopen(path, "r");
        LocalFrame frame = {0};
        int        count = 0;
        CHECK(file && fgets(text, sizeof text, file));
        while (count < room && fgets(text, sizeof text, file)) {
            double p_ecef[3] = {0};
            int    entity = 0, column = 0;
            char  *rest = text, *cell;
            while ((cell = strsep(&rest, "\t"))) {
                if (column == 7) entity = atoi(cell);
                if (column >= 13 && column <= 15) p_ecef[column - 13] = atof(cell);
                column++;
            }
            bool ground = !log[n].entity[0];
            for (int k = 0; k < 4; k++) ground |= log[n].entity[k] == entity;
            if (!ground) continue;
            if (!count) {
                Geodetic origin;
                CHECK(geodetic_from_ecef(&origin, p_ecef) == STATUS_OK);
                CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
            }
            fix[count].voter = 1 + entity % 97; /* one vote each */
            enu_from_ecef(fix[count++].p_enu, &frame, p_ecef);
        }
        fclose(file);
        CHECK(count > 100);

        const LandscapeConfig config = landscape_default_config();
        Landscape             land;
        CHECK(landscape_create(&land, &config, &frame, fix, count, NULL, 0) == STATUS_OK);
        printf("%s: %d fixes, worst %.4f m, dropped %d\n", log[n].name, count, land.fit_worst_m, land.fixes_dropped);
        CHECK(land.fixes_dropped == 0);
        CHECK_NEAR(worst_fix(&land, fix, count, NULL), 0, 0.05);
        landscape_destroy(&land);
    }
}

static bool near_an_end_on_a_fix(const double p[3], const ClearLine *line, int lines, const GroundFix *fix, int fixes,
                                 double reach_m)
{
    for (int n = 0; n < lines; n++)
        for (int end = 0; end < 2; end++) {
            const double *e = end ? line[n].b_enu : line[n].a_enu;
            double        d[3];
            v3_sub(d, p, e);
            if (v3_length(d) > reach_m) continue;
            for (int m = 0; m < fixes; m++) {
                v3_sub(d, fix[m].p_enu, e);
                if (v3_length(d) <= 8) return true;
            }
        }
    return false;
}

/* Shots between vehicles, tops of dives, low passes over everything, at random: the surface stays strictly below
 * each, but for the last metres to a fix, and what fixes are kept are met. */
static void lines_stay_clear(void **state)
{
    (void)state;
    enum { room = 2000, line_room = 300 };
    static GroundFix fix[room];
    static ClearLine line[line_room];
    for (int run = 0; run < 4; run++) {
        const LocalFrame frame = frame_at(10 + 20 * run, 70, 240);
        LandscapeConfig  config = small_config(60 + run);
        config.relief_m = run == 3 ? 60 : 15;
        const int count = drive(fix, room, &frame, 70 + run, 8);
        int       lines = 0;
        for (int n = 0; n < 40; n++) { /* from a gun to a hull */
            const int a = (int)(count * random_uniform(run, 10, 0, n)),
                      b = (int)(count * random_uniform(run, 11, 0, n));
            line[lines] = (ClearLine){{fix[a].p_enu[0], fix[a].p_enu[1], fix[a].p_enu[2] + 2},
                                      {fix[b].p_enu[0], fix[b].p_enu[1], fix[b].p_enu[2] + 1}};
            lines++;
        }
        for (int n = 0; n < 40; n++) { /* a dive, in pieces, to a fix */
            const double *to = fix[(int)(count * random_uniform(run, 12, 0, n))].p_enu;
            const double  bearing = 2 * pi_rad * random_uniform(run, 13, 0, n),
                         steep = 1.5 * random_uniform(run, 14, 0, n);
            for (int piece = 0; piece < 3; piece++) {
                const double s0 = 300 * piece, s1 = 300 * (piece + 1);
                line[lines++] = (ClearLine){{to[0] + s1 * cos(steep) * cos(bearing),
                                             to[1] + s1 * cos(steep) * sin(bearing), to[2] + s1 * sin(steep)},
                                            {to[0] + s0 * cos(steep) * cos(bearing),
                                             to[1] + s0 * cos(steep) * sin(bearing), to[2] + s0 * sin(steep)}};
            }
        }
        for (int n = 0; n < 60; n++) { /* a pass, far beyond the innermost level, high or lower than the ground */
            double ends[2][3];
            for (int end = 0; end < 2; end++)
                place_above(ends[end], &frame, 60000 * (random_uniform(run, 15 + (uint32_t)end, 0, n) - 0.5),
                            60000 * (random_uniform(run, 17 + (uint32_t)end, 0, n) - 0.5),
                            n % 4 ? 230 + 80 * random_uniform(run, 19, (uint32_t)end, n) : 3000);
            memcpy(line[lines].a_enu, ends[0], sizeof ends[0]);
            memcpy(line[lines++].b_enu, ends[1], sizeof ends[1]);
        }
        CHECK(lines <= line_room);

        Landscape land;
        CHECK(landscape_create(&land, &config, &frame, fix, count, line, lines) == STATUS_OK);
        /* the posts hold whole pieces of a line, as long as they are apart: a piece may reach half of that beyond
         * the taper, and on coarser levels everything scales */
        double least_m = INFINITY;
        int    inside = 0;
        for (int n = 0; n < lines; n++) {
            double d[3];
            v3_sub(d, line[n].b_enu, line[n].a_enu);
            const int samples = 200 + (int)(v3_length(d) / 7);
            for (int m = 0; m <= samples; m++) {
                double p[3];
                v3_add_scaled(p, line[n].a_enu, (double)m / samples, d);
                const double room_m = p[2] - elevation_height(&land.elevation, p[0], p[1], NULL);
                if (room_m > 0.1) {
                    least_m = fmin(least_m, room_m);
                    continue;
                }
                inside++;
                CHECK(near_an_end_on_a_fix(p, line, lines, fix, count, invented_taper_m(&config) + 2));
            }
        }
        printf("%d fixes, %d lines: least room outside %.2f m, %d samples in tapers, dropped %d, worst fix %.4f m\n",
               count, lines, least_m, inside, land.fixes_dropped, land.fit_worst_m);
        CHECK(land.fixes_dropped < count / 2);
        CHECK_NEAR(land.fit_worst_m, 0, 0.05);
        landscape_destroy(&land);
    }
}

/* The same lines over the same country without being told of them are masked: the test above can fail. */
static void unknown_lines_are_masked(void **state)
{
    (void)state;
    const LocalFrame frame = frame_at(36, -123, 0);
    LandscapeConfig  config = small_config(60);
    GroundFix        fix[2] = {0};
    place_above(fix[0].p_enu, &frame, -1200, 300, 0);
    place_above(fix[1].p_enu, &frame, 1200, -200, 3);
    const ClearLine line = {{-1200, 300, fix[0].p_enu[2] + 1}, {1200, -200, fix[1].p_enu[2] + 1}};
    int             masked[2] = {0, 0};
    for (int told = 0; told < 2; told++)
        for (uint64_t seed = 0; seed < 6; seed++) {
            Landscape land;
            config.seed = seed;
            CHECK(landscape_create(&land, &config, &frame, fix, 2, &line, told) == STATUS_OK);
            CHECK(land.fixes_dropped == 0);
            CHECK_NEAR(land.fit_worst_m, 0, 0.05);
            for (int m = 20; m < 980; m++) {
                double d[3], p[3];
                v3_sub(d, line.b_enu, line.a_enu);
                v3_add_scaled(p, line.a_enu, m / 1000.0, d);
                masked[told] += !(elevation_height(&land.elevation, p[0], p[1], NULL) < p[2]);
            }
            landscape_destroy(&land);
        }
    CHECK(masked[0] > 500);
    CHECK(masked[1] == 0);
}

/* Nobody on the ground: sea level, or lower where somebody flies lower. */
static void an_exercise_in_the_air(void **state)
{
    (void)state;
    const LocalFrame frame = frame_at(20, 60, 0);
    LandscapeConfig  config = small_config(1);
    config.relief_m = 5;
    Landscape land;
    ClearLine high, low;
    place_above(high.a_enu, &frame, -9000, 0, 3000);
    place_above(high.b_enu, &frame, 9000, 0, 3500);
    CHECK(landscape_create(&land, &config, &frame, NULL, 0, &high, 1) == STATUS_OK);
    CHECK_NEAR(elevation_height(&land.elevation, 0, 0, NULL), 0, 15); /* three times its relief of 5 m */
    landscape_destroy(&land);

    place_above(low.a_enu, &frame, -900, 0, -45);
    place_above(low.b_enu, &frame, 900, 0, -45);
    CHECK(landscape_create(&land, &config, &frame, NULL, 0, &low, 1) == STATUS_OK);
    for (int n = -900; n <= 900; n++) CHECK(elevation_height(&land.elevation, n, 0, NULL) < low.a_enu[2] - 0.1);
    CHECK(elevation_height(&land.elevation, 0, 1300, NULL) < -20); /* the whole country, not a trench */
    landscape_destroy(&land);
}

static void reaches_the_horizon_and_no_further(void **state)
{
    (void)state;
    const LocalFrame      frame = frame_at(36, -123, 0);
    const LandscapeConfig config = landscape_default_config();
    Landscape             land;
    CHECK(landscape_create(&land, &config, &frame, NULL, 0, NULL, 0) == STATUS_OK);
    for (int n = 0; n < 20000; n++) {
        const double r = config.horizon_m * pow(random_uniform(1, 0, 0, n), 3);
        const double a = 2 * pi_rad * random_uniform(1, 1, 0, n);
        double       normal[3];
        const double z = elevation_height(&land.elevation, r * cos(a), r * sin(a), normal);
        CHECK_NEAR(z, -r * r / 2 / 6.371e6, 80 + 1e-2 * r * r / 2 / 6.371e6);
        CHECK_NEAR(v3_length(normal), 1, 1e-14);
    }
    CHECK(isfinite(elevation_height(&land.elevation, config.horizon_m, -config.horizon_m, NULL)));
    CHECK(isnan(elevation_height(&land.elevation, 1.05 * config.horizon_m, 0, NULL)));
    CHECK(landscape_surface(&land, 1.05 * config.horizon_m, 0) == SURFACE_NONE);
    CHECK(landscape_surface(&land, NAN, 0) == SURFACE_NONE);

    /* gentle country: rms slope below 10 degrees, rms relief of the order asked for */
    double slope = 0, square = 0, sum = 0;
    for (int n = 0; n < 20000; n++) {
        const double x = 11000 * (random_uniform(2, 0, 0, n) - 0.5), y = 11000 * (random_uniform(2, 1, 0, n) - 0.5);
        double       normal[3];
        const double h = elevation_height(&land.elevation, x, y, normal) + (x * x + y * y) / 2 / 6.371e6;
        slope += (1 - normal[2] * normal[2]) / (normal[2] * normal[2]) / 20000;
        sum += h / 20000;
        square += h * h / 20000;
    }
    printf("slope %.2f degree rms, height %.1f m rms\n", atan(sqrt(slope)) / rad_per_deg, sqrt(square - sum * sum));
    /* 11 km hold a few of the longest waves only, so the relief of one draw is known to a third. There is no
     * paper value of its slopes: country of 15 m of relief has some 2 to 5 degrees. */
    CHECK_NEAR(atan(sqrt(slope)) / rad_per_deg, 3.3, 1.2);
    CHECK_NEAR(sqrt(square - sum * sum) / config.relief_m, 1, 0.35);
    landscape_destroy(&land);
}

static void many_classes_near_any_place(void **state)
{
    (void)state;
    const LocalFrame frame = frame_at(36, -123, 0);
    for (uint64_t seed = 0; seed < 12; seed++) {
        const LandscapeConfig config = small_config(seed);
        Landscape             land;
        CHECK(landscape_create(&land, &config, &frame, NULL, 0, NULL, 0) == STATUS_OK);
        static const double centre[][2] = {{0, 0}, {30000, -20000}};
        for (int c = 0; c < 2; c++) {
            int share[SURFACE_COUNT] = {0}, classes = 0;
            for (int n = 0; n < 20000; n++) {
                const double r = 2000 * sqrt(random_uniform(3, 0, 0, n)), a = 2 * pi_rad * random_uniform(3, 1, 0, n);
                share[landscape_surface(&land, centre[c][0] + r * cos(a), centre[c][1] + r * sin(a))]++;
            }
            for (int s = 1; s < SURFACE_COUNT; s++) classes += share[s] >= 100; /* half a per cent each */
            CHECK(share[SURFACE_NONE] == 0);
            CHECK(classes >= 5);
            CHECK(share[SURFACE_TRACK] > 0);
        }
        landscape_destroy(&land);
    }
}

static void bad_input_is_survived(void **state)
{
    (void)state;
    const LocalFrame frame = frame_at(36, -123, 0);
    Landscape        land = {.fixes_dropped = 42};
    LandscapeConfig  bad[8];
    for (int n = 0; n < 8; n++) bad[n] = small_config(1);
    bad[0].relief_m = NAN;
    bad[1].relief_m = 201;
    bad[2].spacing_m = 0.5;
    bad[3].spacing_m = NAN;
    bad[4].half_width_m = 1e9;
    bad[5].half_width_m = -1;
    bad[6].horizon_m = 100;
    bad[7].horizon_m = INFINITY;
    for (int n = 0; n < 8; n++) CHECK(landscape_create(&land, &bad[n], &frame, NULL, 0, NULL, 0) == STATUS_BAD_VALUE);
    CHECK(land.fixes_dropped == 42);

    const LandscapeConfig config = small_config(1);
    const GroundFix       fix[] = {{.p_enu = {NAN, 0, 0}},   {.p_enu = {0, INFINITY, 0}}, {.p_enu = {0, 0, -INFINITY}},
                                   {.p_enu = {1e300, 0, 0}}, {.p_enu = {0, 0, 50000}},    {.p_enu = {0, 0, -6371000}},
                                   {.p_enu = {3e6, 0, 0}},   {.p_enu = {10, 10, 1}}};
    const ClearLine line[] = {{{NAN, 0, 0}, {0, 0, 0}},   {{0, 0, 0}, {INFINITY, 0, 0}}, {{0, 0, 1e300}, {0, 0, 0}},
                              {{50, 50, 5}, {50, 50, 5}}, {{1e7, 0, 9}, {-1e7, 0, 9}},   {{0, 0, -1e6}, {9, 9, 1e6}}};
    CHECK(landscape_create(&land, &config, &frame, fix, 8, line, 5) == STATUS_OK);
    CHECK(land.fixes_dropped == 7);
    CHECK_NEAR(elevation_height(&land.elevation, 10, 10, NULL), 1, 0.05);
    CHECK(elevation_height(&land.elevation, 50, 50, NULL) < 4.9);
    landscape_destroy(&land);
    CHECK(land.cover == NULL);
    landscape_destroy(&land);
    landscape_destroy(NULL);

    /* a line from under the Earth is nobody's, and pulls nothing down */
    CHECK(landscape_create(&land, &config, &frame, fix, 8, line, 6) == STATUS_OK);
    CHECK_NEAR(elevation_height(&land.elevation, 10, 10, NULL), 1, 0.05);
    landscape_destroy(&land);
    CHECK(landscape_create(&land, &config, &frame, NULL, 0, line + 5, 1) == STATUS_OK);
    CHECK_NEAR(elevation_height(&land.elevation, 9, 9, NULL), 0, 80);
    landscape_destroy(&land);
}

/* Ground from the cache is the ground that was invented: heights, and what covers it by ways, coast and seed. */
static void kept_ground_is_the_same(void **state)
{
    (void)state;
    const LandscapeConfig config = small_config(5);
    const LocalFrame      frame = frame_at(48, 11, 0);
    const CoastPlace      place[] = {{900, 900, true}, {-300, -200, false}, {-800, 700, false}};
    GroundFix             fix[400] = {{{0}, 0}};
    LandscapeEvidence     said = {.fix = fix, .place = place, .place_count = 3, .sea_h_m = 200};
    Landscape             land[3];
    char                  folder[temp_path_size], command[temp_path_size + 16];
    said.fix_count = drive(fix, 400, &frame, 7, 3);
    CHECK(temp_folder(folder));
    Cache *cache = cache_open(folder, 64 << 20);
    CHECK(cache && landscape_create_from(&land[0], &config, &frame, &said) == STATUS_OK);
    CHECK(landscape_create_kept(&land[1], &config, &frame, &said, cache) == STATUS_OK);
    CHECK(landscape_create_kept(&land[2], &config, &frame, &said, cache) == STATUS_OK);
    CHECK(cache_counters(cache).made == 1 && cache_counters(cache).fetched == 1);
    int seen[SURFACE_COUNT] = {0};
    for (int k = 1; k < 3; k++) {
        CHECK(land[k].fit_worst_m == land[0].fit_worst_m && land[k].fixes_dropped == land[0].fixes_dropped);
        for (int n = 0; n < 40000; n++) {
            const double x_m = 2900 * (random_uniform(3, 0, 0, (uint64_t)n) - 0.5),
                         y_m = 2900 * (random_uniform(3, 1, 0, (uint64_t)n) - 0.5);
            double up[2][3];
            CHECK(elevation_height(&land[k].elevation, x_m, y_m, up[0]) ==
                  elevation_height(&land[0].elevation, x_m, y_m, up[1]));
            CHECK(memcmp(up[0], up[1], sizeof up[0]) == 0);
            const SurfaceClass surface = landscape_surface(&land[k], x_m, y_m);
            CHECK(surface == landscape_surface(&land[0], x_m, y_m));
            seen[surface]++;
        }
        for (int level = 0; level < land[0].elevation.level_count; level++) {
            const ElevationLevel *a = &land[0].elevation.level[level], *b = &land[k].elevation.level[level];
            CHECK(a->pyramid_count == b->pyramid_count && a->pyramid_base == b->pyramid_base);
            CHECK(a->pyramid_shift == b->pyramid_shift && a->rise_shift == b->rise_shift && a->plain == b->plain);
            for (int p = elevation_pyramid_first; p < a->pyramid_count; p++) {
                const size_t nodes = (size_t)a->pyramid_nx[p] * (size_t)a->pyramid_ny[p];
                CHECK(memcmp(a->pyramid[p], b->pyramid[p], nodes * sizeof **a->pyramid) == 0);
                if (p >= elevation_rise_level) CHECK(memcmp(a->rise[p], b->rise[p], nodes * sizeof **a->rise) == 0);
            }
        }
    }
    CHECK(seen[SURFACE_WATER] > 0 && seen[SURFACE_GRASS] > 0);
    for (int k = 0; k < 3; k++) landscape_destroy(&land[k]);
    cache_close(cache);
    snprintf(command, sizeof command, "rm -r %s", folder);
    CHECK(system(command) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_input_same_bits),
        cmocka_unit_test(posts_follow_the_curved_earth),
        cmocka_unit_test(no_crack_between_levels),
        cmocka_unit_test(passes_through_every_fix),
        cmocka_unit_test(contradictions_are_dropped_and_the_rest_is_met),
        cmocka_unit_test(recorded_vehicles_stand_on_it),
        cmocka_unit_test(lines_stay_clear),
        cmocka_unit_test(unknown_lines_are_masked),
        cmocka_unit_test(an_exercise_in_the_air),
        cmocka_unit_test(reaches_the_horizon_and_no_further),
        cmocka_unit_test(many_classes_near_any_place),
        cmocka_unit_test(bad_input_is_survived),
        cmocka_unit_test(kept_ground_is_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
