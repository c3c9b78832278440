/* Clutter: as dense as its table says where it can stand, nowhere that the exercise or anything built needs, on the
 * ground, the same for any square that holds a place, told apart by seeds; what drives keeps right and to its speed. */
#include "tests/check.h"

#include "entities/scenery/scenery_clutter_private.h"

enum { most_vertices = 20000 };
static double vertex[most_vertices][2];

static Landscape land, plain;
static GroundFix fix[64];
static ClearLine line[16];

/* A landscape with a column of vehicles, and flat shots over it; another without evidence. */
static int setup(void **state)
{
    (void)state;
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    config.seed = 5, config.half_width_m = 2500, config.horizon_m = 20000;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return 1;
    for (int k = 0; k < 64; k++)
        fix[k] = (GroundFix){{20.0 * k - 600, 300 + 60 * sin(0.2 * k), 2 * sin(0.1 * k)}, k / 8 + 1};
    for (int k = 0; k < 16; k++)
        line[k] = (ClearLine){{-900, -800 + 100.0 * k, 30}, {900, -850 + 105.0 * k, 3.0 + 0.2 * k}};
    return landscape_create(&land, &config, &frame, fix, 64, line, 16) != STATUS_OK ||
           landscape_create(&plain, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK;
}

static int teardown(void **state)
{
    (void)state;
    landscape_destroy(&land), landscape_destroy(&plain);
    return 0;
}

static ClutterConfig about(const Landscape *l, double half_m)
{
    ClutterConfig c = clutter_default_config();
    c.landscape = l, c.seed = 3, c.most = clutter_most_objects, c.sag_m = 0.1;
    for (int k = 0; k < 2; k++) c.south_west_m[k] = -half_m, c.north_east_m[k] = half_m;
    return c;
}

static Scenery add(const ClutterConfig *c)
{
    Scenery s = {0};
    assert_int_equal(scenery_add_clutter(&s, c), STATUS_OK);
    return s;
}

#define HEADER                                                                                                         \
    "class,shape,paint,where,density,group_low,group_high,spread_m,length_low_m,length_high_m,heat,running,recent\n"

/* A scenery by a table of these rows. */
static Scenery add_rows(ClutterConfig *c, const char *rows)
{
    char path[text_file_size], text[2048];
    snprintf(text, sizeof text, HEADER "%s\n", rows);
    text_file(path, text);
    c->table = path;
    Scenery s = add(c);
    c->table = NULL;
    remove(path);
    return s;
}

static bool is_driven(const Scenery *s, int object)
{
    for (int k = 0; k < s->movers; k++)
        if (s->mover[k].object == object) return true;
    return false;
}

/* ---- densities ---------------------------------------------------------------------------------- */

/* Ground of each class of fields, km2, away from borders or at them, by its own look at the surface. */
static void areas(double km2[2], const Landscape *l, double half_m)
{
    static const double step_m = 8;
    km2[0] = km2[1] = 0;
    for (double y = -half_m + 0.5 * step_m; y < half_m; y += step_m)
        for (double x = -half_m + 0.5 * step_m; x < half_m; x += step_m) {
            static const double off[5][2] = {{0, 0}, {12, 0}, {-12, 0}, {0, 12}, {0, -12}};
            SurfaceClass        s[5];
            for (int k = 0; k < 5; k++) s[k] = landscape_surface(l, x + off[k][0], y + off[k][1]);
            bool crop = s[0] == SURFACE_CROP || s[0] == SURFACE_PLOUGHED || s[0] == SURFACE_BARE_SOIL, border = false;
            if (!crop) continue;
            for (int k = 1; k < 5; k++)
                border |= s[k] == SURFACE_GRASS || s[k] == SURFACE_DRY_GRASS || s[k] == SURFACE_SCRUB ||
                          s[k] == SURFACE_ROCK || s[k] == SURFACE_SAND || s[k] == SURFACE_BUILT ||
                          s[k] == SURFACE_FOREST_BROADLEAF || s[k] == SURFACE_FOREST_CONIFER;
            WayPlace way;
            double   n[3];
            elevation_height(&l->elevation, x, y, n);
            if (hypot(n[0], n[1]) > 0.36 * n[2]) continue; /* too steep to stand */
            if (landscape_way(&way, l, x, y) && fabs(way.across_m) < way.half_m + 0.7) continue;
            km2[border] += step_m * step_m * 1e-6;
        }
}

/* Poisson: four standard deviations, and what neighbours, who are there first, take. */
static void as_dense_as_the_table(void **state)
{
    (void)state;
    static const double half_m = 2000;
    ClutterConfig       c = about(&plain, half_m);
    double              km2[2];
    areas(km2, &plain, half_m);
    for (int times = 1; times <= 2; times++) {
        c.density = times;
        Scenery      s = add_rows(&c, "crates,crates,,field,60,1,1,0,0,0,cold,0,0\n");
        const double want = 60 * times * km2[0];
        print_message("fields of %.2f km2: %d crates, want %.0f\n", km2[0], s.objects, want);
        CHECK_NEAR(s.objects, want, 4 * sqrt(want) + 0.01 * want);
        scenery_free(&s);
    }
    c.density = 1;
    Scenery s = add_rows(&c, "crates,crates,,edge,200,1,1,0,0,0,cold,0,0\n");
    double  more = 0;
    for (int k = 0; k < s.objects; k++) {
        const SurfaceClass on = landscape_surface(&plain, s.object[k].p_enu[0], s.object[k].p_enu[1]);
        more += on == SURFACE_GRASS || on == SURFACE_DRY_GRASS;
    }
    const double want = 200 * km2[1], got = s.objects - more; /* those in fields */
    print_message("edges of fields of %.2f km2: %.0f crates, want %.0f\n", km2[1], got, want);
    CHECK_NEAR(got, want, 4 * sqrt(want) + 0.02 * want);
    scenery_free(&s);

    /* groups: as many things; their number varies as sums of whole groups do */
    s = add_rows(&c, "animal,animal,,field,100,4,8,3,0,0,lives,0,0\n");
    const double each = (16. + 25 + 36 + 49 + 64) / 5 / 6; /* mean of squares over mean */
    /* nothing stands in another: of a group within some metres a part goes; groups are not thinned by chance beyond */
    print_message("groups: %d animals, want %.0f less what is in each other's way\n", s.objects, 100 * km2[0]);
    CHECK(s.objects < 100 * km2[0] + 4 * sqrt(each * 100 * km2[0]) && s.objects > 30 * km2[0]);
    scenery_free(&s);
}

static void as_many_by_ways_and_plots(void **state)
{
    (void)state;
    const double  half_m = 2400;
    ClutterConfig c = about(&plain, half_m);
    double        km = 0;
    WayKind       kind;
    for (int way = 0, count; (count = landscape_way_vertices(vertex, &kind, &plain, way, most_vertices)) > 0; way++)
        for (int n = 1; n < count && kind == WAY_ROAD; n++)
            km += fmax(fabs(vertex[n][0]), fabs(vertex[n][1])) < half_m
                      ? 1e-3 * hypot(vertex[n][0] - vertex[n - 1][0], vertex[n][1] - vertex[n - 1][1])
                      : 0;
    CHECK(km > 3);
    Scenery s = add_rows(&c, "crates,crates,,road,12,1,1,0,0,0,cold,0,0\n");
    print_message("%.2f km of road: %d crates, want %.0f\n", km, s.objects, 12 * km);
    CHECK_NEAR(s.objects, 12 * km, 4 * sqrt(12 * km) + 0.1 * 12 * km); /* steep verges, crossings, streams */
    scenery_free(&s);
    s = add_rows(&c, "car,car,,road,2,1,1,0,0,0,drives,0,0\n");
    print_message("%.2f km of road: %d cars, want %.0f\n", km, s.objects, 2 * km);
    CHECK_NEAR(s.objects, 2 * km, 4 * sqrt(2 * km) + 0.1 * 2 * km);
    CHECK(s.movers == s.objects);
    scenery_free(&s);

    int              plots, within = 0;
    const HousePlot *plot = landscape_plots(&plain, &plots);
    for (int n = 0; n < plots; n++) within += fmax(fabs(plot[n].x_m), fabs(plot[n].y_m)) < half_m;
    CHECK(within > 20);
    s = add_rows(&c, "crates,crates,,house,0.5,1,1,0,0,0,cold,0,0\n");
    print_message("%d plots: %d crates, want %.0f\n", within, s.objects, 0.5 * within);
    CHECK_NEAR(s.objects, 0.5 * within, 4 * sqrt(0.5 * within) + 0.05 * within);
    scenery_free(&s);
}

/* ---- states ------------------------------------------------------------------------------------- */

static void states_are_shared_out(void **state)
{
    (void)state;
    ClutterConfig c = about(&plain, 2400);
    Scenery       s = add_rows(&c, "car,car,,field,400,1,1,0,0,0,engine,0.2,0.5\n");
    int           idle = 0, cold = 0, stopped = 0, step[clutter_stops] = {0};
    CHECK(s.objects > 1000 && s.models == 1 && s.states <= 8 * clutter_headings && s.states <= 256);
    for (int k = 0; k < s.objects; k++) {
        const SceneryObject *o = &s.object[k];
        const SceneryState  *of = &s.state[o->state];
        CHECK(of->model == o->model && of->drives.speed_mps == 0);
        const double heading_rad = atan2(o->r_enu_from_body[0], o->r_enu_from_body[3]);
        CHECK_NEAR(remainder(heading_rad - (double)of->heading_rad, 2 * pi_rad), 0, pi_rad / 16 + 0.02);
        if (of->stood_s == 0 && of->drives.engine > 0) CHECK_NEAR((double)of->drives.engine, 0.6, 1e-6);
        if (of->stood_s == 0 && of->drives.engine > 0) idle++;
        else if (of->stood_s > 0) {
            CHECK(of->drives.engine > 0.6f); /* what it did before */
            CHECK(of->stood_s >= 120 && of->stood_s <= 86400);
            step[(int)(log((double)of->stood_s / 120) / log(720) * clutter_stops)]++;
            stopped++;
        } else cold++;
    }
    print_message("%d cars: %d idle, %d stopped, %d cold\n", s.objects, idle, stopped, cold);
    CHECK_NEAR(idle, 0.2 * s.objects, 4 * sqrt(0.16 * s.objects));
    CHECK_NEAR(stopped, 0.5 * s.objects, 4 * sqrt(0.25 * s.objects));
    double chi2 = 0; /* log-uniform: as many in each step; 5 degrees of freedom: 25.7 at 1e-4 */
    for (int k = 0; k < clutter_stops; k++)
        chi2 += (step[k] - stopped / 6.) * (step[k] - stopped / 6.) / (stopped / 6.);
    CHECK(chi2 < 25.7);
    const int objects = s.objects;
    scenery_free(&s);
    /* few states: told apart less, nothing left out */
    c.most_states = 12;
    Scenery few = add_rows(&c, "car,car,,field,400,1,1,0,0,0,engine,0.2,0.5\n");
    CHECK(few.states <= 12 && few.objects == objects);
    scenery_free(&few);
}

/* ---- where nothing stands ----------------------------------------------------------------------- */

static void keeps_clear_of_the_exercise(void **state)
{
    (void)state;
    ClutterConfig c = about(&land, 1500);
    c.density = 20;
    Scenery s = add(&c);
    double  nearest = INFINITY;
    int     beside = 0;
    CHECK(s.objects > 2000);
    for (int k = 0; k < s.objects; k++) {
        const SceneryObject *o = &s.object[k];
        const Model         *m = &s.model[o->model];
        const double         radius_m = 0.5 * hypot(m->length_m, m->width_m), *p = o->p_enu;
        const double         more_m = is_driven(&s, k) ? -6 : 0; /* its way keeps clear, at its vertices */
        for (int n = 0; n < 64; n++) {
            const double d = hypot(p[0] - fix[n].p_enu[0], p[1] - fix[n].p_enu[1]);
            nearest = fmin(nearest, d - radius_m - more_m);
            CHECK(d >= 12 + 0.98 * radius_m + more_m);
        }
        for (int n = 0; n < 16 && more_m == 0; n++)
            for (int step = (int)fmax(0, p[0] + 890); step <= fmin(1800, p[0] + 910); step++) { /* a metre apart */
                double q[3];
                for (int i = 0; i < 3; i++)
                    q[i] = line[n].a_enu[i] + (line[n].b_enu[i] - line[n].a_enu[i]) * step / 1800;
                if (hypot(p[0] - q[0], p[1] - q[1]) > radius_m) continue;
                beside++;
                CHECK(q[2] > p[2] + 0.98 * m->height_m);
            }
    }
    print_message("%d things, nearest %.1f m from a report, %d points of lines over them\n", s.objects, nearest,
                  beside);
    CHECK(beside > 0 && nearest < 20);
    scenery_free(&s);
}

static void keeps_off_what_is_built(void **state)
{
    (void)state;
    Culture  culture = {0};
    uint64_t id = 1;
    for (int j = -4; j <= 4; j++)
        for (int i = -4; i <= 4; i++) {
            const double   x = 130 * i, y = 140 * j, turn = 0.3 * i + j, u = cos(turn), v = sin(turn);
            double         p[4][2];
            const Building b = {.id = id++,
                                .use = (uint8_t)((i + j) & 1 ? BUILDING_HOUSE : BUILDING_BARN),
                                .eaves_m = 3,
                                .ridge_m = 5,
                                .levels = 1};
            for (int k = 0; k < 4; k++) {
                const double a = k == 1 || k == 2 ? 7 : -7, d = k >= 2 ? 5 : -5;
                p[k][0] = x + a * u - d * v, p[k][1] = y + a * v + d * u;
            }
            assert_int_equal(culture_add_building(&culture, &b, (const double(*)[2])p, 4), STATUS_OK);
        }
    const double      road[2][2] = {{-700, 60}, {700, 75}};
    const CultureLine street = {.id = id, .width_m = 6, .kind = CULTURE_ROAD, .surface = SURFACE_ROAD};
    assert_int_equal(culture_add_line(&culture, &street, road, 2), STATUS_OK);
    assert_int_equal(culture_index(&culture), STATUS_OK);
    ClutterConfig c = about(&plain, 700);
    c.culture = &culture, c.density = 10;
    Scenery s = add(&c);
    int     near = 0, beside = 0, driven = 0;
    for (int k = 0; k < s.objects; k++) {
        const SceneryObject *o = &s.object[k];
        const Model         *m = &s.model[o->model];
        const double        *r = o->r_enu_from_body;
        const double         across_m = (o->p_enu[1] - 60 - (o->p_enu[0] + 700) * 15 / 1400) * cos(atan2(15, 1400));
        near += culture_building_at(&culture, o->p_enu[0], o->p_enu[1], 8) >= 0;
        if (is_driven(&s, k)) {
            driven += fabs(across_m) < 3;
            continue;
        }
        beside += fabs(across_m) < 6;
        /* its corners, and the middles of its sides */
        for (int n = 0; n < 9; n++) {
            const double a = 0.5 * (n % 3 - 1) * m->length_m, b = 0.5 * (n / 3 - 1) * m->width_m;
            const double x = o->p_enu[0] + a * r[0] + b * r[1], y = o->p_enu[1] + a * r[3] + b * r[4];
            CHECK(culture_building_at(&culture, x, y, 0) < 0);
            WayPlace way;
            CHECK(fabs(y - 60 - (x + 700) * 15 / 1400) > 2.9);
            if (landscape_way(&way, &plain, x, y)) CHECK(fabs(way.across_m) > way.half_m - 0.3);
        }
    }
    print_message("%d things, %d about 81 buildings, %d beside the road, %d on it\n", s.objects, near, beside, driven);
    CHECK(near > 80 && beside > 3 && driven > 3);
    scenery_free(&s);
    culture_free(&culture);
}

static void nothing_stands_in_another(void **state)
{
    (void)state;
    ClutterConfig c = about(&plain, 1500);
    c.density = 10;
    Scenery s = add(&c);
    CHECK(s.objects > 2000);
    for (int a = 0; a < s.objects; a++)
        for (int b = 0; b < a; b++) {
            const Model  *ma = &s.model[s.object[a].model], *mb = &s.model[s.object[b].model];
            const double *p = s.object[a].p_enu, *q = s.object[b].p_enu;
            const double  room_m = 0.49 * (hypot(ma->length_m, ma->width_m) + hypot(mb->length_m, mb->width_m));
            if (fabs(p[0] - q[0]) > room_m || hypot(p[0] - q[0], p[1] - q[1]) > room_m) continue;
            if (!is_driven(&s, a) && !is_driven(&s, b)) fail_msg("%d and %d touch", a, b);
        }
    scenery_free(&s);
}

/* ---- poses -------------------------------------------------------------------------------------- */

static void stands_on_the_ground(void **state)
{
    (void)state;
    ClutterConfig c = about(&plain, 2000);
    Scenery s = add_rows(&c, "car,car,,field,100,1,1,0,0,0,cold,0,0\nanimal,animal,,pasture,100,1,1,0,0,0,lives,0,0\n"
                             "crates,crates,,scrub,200,1,1,0,0,0,cold,0,0\n");
    double  worst = 0, turn[4] = {0};
    for (int k = 0; k < s.objects; k++) {
        const SceneryObject *o = &s.object[k];
        const Model         *m = &s.model[o->model];
        const double        *r = o->r_enu_from_body;
        double               square[9];
        m3_tmul(square, r, r);
        for (int i = 0; i < 9; i++) CHECK_NEAR(square[i], i % 4 == 0, 1e-12);
        const double right[3] = {r[1], r[4], r[7]}, down[3] = {r[2], r[5], r[8]}, forward[3] = {r[0], r[3], r[6]};
        double       z[3];
        v3_cross(z, forward, right);
        CHECK_NEAR(v3_dot(z, down), 1, 1e-12);
        turn[(int)(atan2(forward[0], forward[1]) / (0.5 * pi_rad) + 2) & 3]++;
        if (o->class == CLUTTER_ANIMAL) {
            CHECK(down[2] < -1 + 1e-12);
            continue;
        }
        for (int n = 0; n < 4; n++) { /* wheels, nearly */
            double p[3];
            v3_add_scaled(p, o->p_enu, (n & 1 ? 0.3 : -0.3) * m->length_m, forward);
            v3_add_scaled(p, p, (n & 2 ? 0.3 : -0.3) * m->width_m, right);
            worst = fmax(worst, fabs(elevation_height(&plain.elevation, p[0], p[1], NULL) - p[2]));
        }
    }
    print_message("%d things; wheels at most %.3f m off the ground\n", s.objects, worst);
    CHECK(worst < 0.35); /* posts are 4 m apart: the ground bends below a car */
    for (int k = 0; k < 4; k++) CHECK_NEAR(turn[k], s.objects / 4., 4 * sqrt(s.objects * 3 / 16.));
    scenery_free(&s);

    /* on a plane: its rise along and across, closed form */
    double       p[3], r[9];
    Landscape    slope = {0};
    const double rise_x = 0.2, rise_y = -0.1, heading = 0.7;
    CHECK(elevation_level_create(&slope.elevation, 0, &(ElevationGrid){9, 9, -32, -32, 8, 0, 0.1}) == STATUS_OK);
    int32_t post[81];
    for (int n = 0; n < 81; n++) post[n] = (int32_t)lrint(1000 + 10 * (rise_x * 8 * (n % 9) + rise_y * 8 * (n / 9)));
    CHECK(elevation_fill(&slope.elevation.level[0], post) == STATUS_OK);
    elevation_build_pyramids(&slope.elevation);
    CHECK(clutter_pose(p, r, &slope, 3, 5, heading, (const float[3]){4, 2, 1}, false));
    CHECK_NEAR(p[2], 100 + rise_x * 35 + rise_y * 37, 1e-9);
    const double up = 1 / sqrt(1 + rise_x * rise_x + rise_y * rise_y),
                 run = rise_x * sin(heading) + rise_y * cos(heading);
    CHECK_NEAR(r[2], rise_x * up, 1e-12);
    CHECK_NEAR(r[5], rise_y * up, 1e-12);
    CHECK_NEAR(r[8], -up, 1e-12);
    CHECK_NEAR(r[6], run / sqrt(1 + run * run), 1e-12);
    CHECK_NEAR(atan2(r[0], r[3]), heading, 1e-12);
    elevation_destroy(&slope.elevation);
}

/* ---- what drives -------------------------------------------------------------------------------- */

/* A square of 100 m: where and whither it is after so many metres is known. */
static void a_mover_follows_its_path(void **state)
{
    (void)state;
    double        path[4][3] = {{0, 0, 1}, {0, 100, 1}, {100, 100, 1}, {100, 0, 1}}, p[3], r[9];
    const Scenery s = {.paths = 4, .path_enu = path};
    SceneryMover  m = {.count = 4, .speed_mps = 5, .phase_m = 30};
    static const struct {
        double t_s, x, y, east, north;
    } want[] = {{0, 0, 30, 0, 1}, {10, 0, 80, 0, 1}, {20, 30, 100, 1, 0}, {40, 100, 70, 0, -1}, {60, 70, 0, -1, 0},
                {74, 0, 0, 0, 1}, {80, 0, 30, 0, 1}, {-16, 50, 0, -1, 0}, {8e6, 0, 30, 0, 1}};
    for (size_t k = 0; k < sizeof want / sizeof *want; k++) {
        scenery_pose(p, r, &s, &m, want[k].t_s);
        CHECK_NEAR(p[0], want[k].x, 1e-6);
        CHECK_NEAR(p[1], want[k].y, 1e-6);
        CHECK_NEAR(p[2], 1, 1e-12);
        CHECK_NEAR(r[0], want[k].east, 1e-9);
        CHECK_NEAR(r[3], want[k].north, 1e-9);
        CHECK_NEAR(r[8], -1, 1e-12);
        CHECK_NEAR(r[1], want[k].north, 1e-9); /* right of north is east */
    }
}

static void drivers_keep_right(void **state)
{
    (void)state;
    ClutterConfig c = about(&land, 2400);
    c.density = 3;
    Scenery s = add_rows(&c, "car,car,,road,2,1,1,0,0,0,drives,0,0\nvan,car,,lane,3,1,1,0,0,0,drives,0,0\n"
                             "lorry,semi_trailer,,road,0.5,1,1,0,0,0,drives,0,0\n");
    int     right = 0, all = 0, roads = 0;
    CHECK(s.movers > 20 && s.movers == s.objects);
    for (int k = 0; k < s.movers; k++) {
        const SceneryMover *m = &s.mover[k];
        double              p[3], q[3], r[9];
        CHECK(m->first >= 0 && m->first + m->count <= s.paths && m->object == k);
        scenery_pose(p, r, &s, m, 0);
        for (int i = 0; i < 3; i++) CHECK(p[i] == s.object[k].p_enu[i]);
        const SceneryState *of = &s.state[s.object[k].state];
        CHECK_NEAR((double)of->drives.speed_mps, m->speed_mps, 0.251 * m->speed_mps);
        CHECK(of->drives.engine > 0.6f && of->stood_s == 0);
        for (int n = 0; n < 40; n++) {
            const double t_s = 7.3 * n;
            WayPlace     way;
            scenery_pose(p, r, &s, m, t_s);
            scenery_pose(q, r, &s, m, t_s + 0.05);
            /* a chord over a bend, or a turn at an end, is shorter */
            CHECK(hypot(q[0] - p[0], q[1] - p[1]) <= 0.05 * m->speed_mps * (1 + 1e-9));
            CHECK_NEAR(elevation_height(&land.elevation, p[0], p[1], NULL), p[2], 0.6);
            for (int f = 0; f < 64; f++) CHECK(hypot(p[0] - fix[f].p_enu[0], p[1] - fix[f].p_enu[1]) > 8);
            if (!landscape_way(&way, &land, p[0], p[1])) continue;
            const double along = r[0] * way.direction[0] + r[3] * way.direction[1];
            all += fabs(along) > 0.9;
            right += fabs(along) > 0.9 && (along > 0) == (way.across_m < 0) && fabs(way.across_m) < way.half_m;
        }
        roads += m->speed_mps > 12;
        for (int o = 0; o < k; o++) { /* of one path: as fast, and never in each other */
            if (s.mover[o].first != m->first) continue;
            CHECK(s.mover[o].speed_mps == m->speed_mps);
            for (int n = 0; n < 8; n++) {
                scenery_pose(p, r, &s, m, 20.0 * n), scenery_pose(q, r, &s, &s.mover[o], 20.0 * n);
                const double ahead = hypot(p[0] - q[0], p[1] - q[1]);
                CHECK(ahead > 1.3);
            }
        }
    }
    print_message("%d drive, %d on roads; %d of %d times on the right\n", s.movers, roads, right, all);
    CHECK(all > 20 * s.movers && right > 0.96 * all && roads > 0 && roads < s.movers);
    scenery_free(&s);
}

/* ---- the same for any square, another by another seed -------------------------------------------- */

static int find(const Scenery *s, uint64_t id)
{
    for (int k = 0; k < s->objects; k++)
        if (s->object[k].id == id) return k;
    return -1;
}

static void squares_fit_together(void **state)
{
    (void)state;
    ClutterConfig c = about(&land, 1200);
    c.density = 4, c.most_driving = clutter_most_movers;
    Scenery whole = add(&c), again = add(&c);
    CHECK(whole.objects > 800 && whole.objects == again.objects && whole.states == again.states);
    CHECK(memcmp(whole.object, again.object, (size_t)whole.objects * sizeof *whole.object) == 0);
    int parts = 0;
    for (int quarter = 3; quarter >= 0; quarter--) {
        ClutterConfig q = c;
        (quarter & 1 ? q.south_west_m : q.north_east_m)[0] = 100;
        (quarter & 2 ? q.south_west_m : q.north_east_m)[1] = -200;
        Scenery part = add(&q);
        parts += part.objects;
        for (int k = 0; k < part.objects; k++) {
            const int at = find(&whole, part.object[k].id);
            CHECK(at >= 0);
            CHECK(memcmp(part.object[k].p_enu, whole.object[at].p_enu, 3 * sizeof(double)) == 0);
            CHECK(memcmp(part.object[k].r_enu_from_body, whole.object[at].r_enu_from_body, 9 * sizeof(double)) == 0);
            CHECK(part.object[k].class == whole.object[at].class);
        }
        scenery_free(&part);
    }
    CHECK(parts == whole.objects);
    for (int k = 1; k < whole.objects; k++) CHECK(whole.object[k - 1].id < whole.object[k].id);
    c.seed++;
    Scenery other = add(&c);
    int     same = 0;
    for (int k = 0; k < other.objects; k++) same += find(&whole, other.object[k].id) >= 0;
    CHECK(same == 0 && fabs(other.objects / (double)whole.objects - 1) < 0.3);
    /* after what is there already */
    const int models = other.models, objects = other.objects, states = other.states, paths = other.paths;
    c.seed--;
    assert_int_equal(scenery_add_clutter(&other, &c), STATUS_OK);
    CHECK(other.objects == objects + whole.objects && other.models == models + whole.models);
    for (int k = objects; k < other.objects; k++) {
        CHECK(other.object[k].model >= models && other.object[k].state >= states);
        CHECK(other.state[other.object[k].state].model == other.object[k].model);
    }
    for (int k = 0; k < other.models; k++) CHECK(other.part_first[k] == -1);
    for (int k = 0; k < other.movers; k++)
        CHECK((other.mover[k].first >= paths) == (other.mover[k].object >= objects) &&
              other.mover[k].object < other.objects);
    scenery_free(&whole), scenery_free(&again), scenery_free(&other);
}

static void limits_hold(void **state)
{
    (void)state;
    ClutterConfig c = about(&plain, 2400);
    log_suppress(true);
    c.density = 0;
    Scenery s = add(&c);
    CHECK(s.objects == 0 && !s.object && !s.model);
    c.density = 20, c.most = 40, c.most_driving = 2;
    s = add(&c);
    CHECK(s.objects == 40 && s.movers <= 2);
    scenery_free(&s);
    c.most = clutter_most_objects;
    s = add(&c);
    print_message("20 times as much: %d things\n", s.objects);
    CHECK(s.objects > 5000);
    scenery_free(&s);
    c = about(&plain, 600);
    c.density = 20;
    s = add_rows(&c, "rock,rock_1,,field,10000,1,1,0,0.3,0.3,cold,0,0\n"
                     "rock,rock_1,,pasture,10000,1,1,0,0.3,0.3,cold,0,0\n");
    CHECK(s.objects == clutter_most_objects);
    scenery_free(&s);
    c.density = 21;
    CHECK(scenery_add_clutter(&s, &c) == STATUS_BAD_VALUE && s.objects == 0);
    c.density = 1, c.table = "/nowhere";
    CHECK(scenery_add_clutter(&s, &c) != STATUS_OK && s.objects == 0);
    log_suppress(false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_dense_as_the_table),
        cmocka_unit_test(as_many_by_ways_and_plots),
        cmocka_unit_test(states_are_shared_out),
        cmocka_unit_test(keeps_clear_of_the_exercise),
        cmocka_unit_test(keeps_off_what_is_built),
        cmocka_unit_test(nothing_stands_in_another),
        cmocka_unit_test(stands_on_the_ground),
        cmocka_unit_test(a_mover_follows_its_path),
        cmocka_unit_test(drivers_keep_right),
        cmocka_unit_test(squares_fit_together),
        cmocka_unit_test(limits_hold),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
