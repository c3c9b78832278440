/* Clutter: as dense as its table says where it can stand, on the ground, the same for any square that holds a place,
 * told apart by seeds; where it does not stand, and what drives: test_clutter_places.c. */
#include "tests/entities/clutter_fixture.h"

enum { most_vertices = 20000 };
static double vertex[most_vertices][2];

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

/* ---- the table of etc/ ------------------------------------------------------------------------------ */

static bool is_material(const Table *t, const char *name)
{
    for (int row = 0; row < t->rows; row++)
        if (strcmp(table_text(t, row, 0), name) == 0) return true;
    return false;
}

/* Every part of every thing of a table has a material, and every class that is wanted a row. */
static void table_is_whole(const char *name, const bool want[CLUTTER_CLASSES])
{
    static ClutterTable table;
    Table               materials;
    char                path[4096];
    bool                has[CLUTTER_CLASSES] = {false};
    CHECK(clutter_table_path(path, sizeof path, name));
    assert_int_equal(clutter_table_read(&table, path), STATUS_OK);
    CHECK(etc_path(path, sizeof path, "materials.csv"));
    assert_int_equal(table_open(&materials, path), STATUS_OK);
    for (int r = 0; r < table.rows; r++) {
        const ClutterRow *row = &table.row[r];
        has[row->class] = true;
        for (int n = 0; n < clutter_most_variants; n++) {
            ClutterVariant v = {.row = row, .length_m = row->length_high_m};
            Model          model = {0};
            const char    *at = row->paint;
            for (int k = 0; k < n; k++) at += strcspn(at, " "), at += strspn(at, " ");
            if (n > 0 && !*at) break;
            snprintf(v.paint, sizeof v.paint, "%.*s", (int)strcspn(at, " "), at);
            assert_int_equal(clutter_build_variant(&model, &v, 0.1), STATUS_OK);
            bool painted = !*v.paint;
            for (int p = 0; p < model.part_count; p++) {
                if (!is_material(&materials, model.part[p].material))
                    fail_msg("%s: %s is no material", row->shape, model.part[p].material);
                painted |= strcmp(model.part[p].material, v.paint) == 0;
            }
            CHECK(painted);
            model_destroy(&model);
        }
    }
    table_close(&materials);
    for (int class = 1; class < CLUTTER_CLASSES; class ++) CHECK(has[class] || !want[class]);
}

static void the_tables_that_are_shipped(void **state)
{
    static const bool rear[CLUTTER_CLASSES] = {
        [CLUTTER_CAR] = true,     [CLUTTER_VAN] = true,     [CLUTTER_LORRY] = true, [CLUTTER_GENERATOR] = true,
        [CLUTTER_MACHINE] = true, [CLUTTER_TRAILER] = true, [CLUTTER_FIRE] = true,  [CLUTTER_HEAP] = true,
        [CLUTTER_WRECK] = true,   [CLUTTER_CRATES] = true,  [CLUTTER_TENT] = true};
    bool all[CLUTTER_CLASSES];
    (void)state;
    for (int class = 0; class < CLUTTER_CLASSES; class ++) all[class] = true;
    table_is_whole("countryside", all);
    table_is_whole("rear_area", rear);
}

/* Names are those of tables of etc, what has a dot or stroke is a path, and no other word is either. */
static void tables_by_name(void **state)
{
    char path[4096], etc[4096];
    (void)state;
    CHECK(clutter_table_path(path, sizeof path, "countryside") && etc_path(etc, sizeof etc, "clutter.csv"));
    assert_string_equal(path, etc);
    CHECK(clutter_table_path(path, sizeof path, "rear_area") && etc_path(etc, sizeof etc, "clutter_rear_area.csv"));
    assert_string_equal(path, etc);
    CHECK(clutter_table_path(path, sizeof path, "./mine.csv"));
    assert_string_equal(path, "./mine.csv");
    log_suppress(true);
    CHECK(!clutter_table_path(path, sizeof path, "seaside") && !clutter_table_path(path, 4, "./mine.csv"));
    log_suppress(false);
}

/* The rear area has many times as many things that may be hot as the countryside, on the same ground; what runs there
 * with an exhaust that is seen (those of vans and cars are below them) or burns openly is of four kinds or more, none
 * of them nearly half, and hardly any of it is a fire. */
static void rear_area_is_warm(void **state)
{
    int hot[2] = {0}, kind[CLUTTER_CLASSES] = {0}, all = 0, kinds = 0;
    (void)state;
    for (int k = 0; k < 2; k++) {
        ClutterConfig c = about(&plain, 2000);
        c.table = k ? "rear_area" : "countryside";
        Scenery s = add(&c);
        for (int n = 0; n < s.objects; n++) {
            const SceneryState *of = &s.state[s.object[n].state];
            hot[k] += (of->drives.engine > 0 && !(of->stood_s > 0)) || of->drives.burning > 0;
            const int class = s.object[n].class;
            if (k == 0 || class == CLUTTER_HEAP || class == CLUTTER_VAN || class == CLUTTER_CAR) continue;
            if (of->drives.speed_mps > 0) continue;
            kind[class] += (of->drives.engine > 0 && !(of->stood_s > 0)) || of->drives.burning > 0;
        }
        scenery_free(&s);
    }
    print_message("engines that run and fires on 16 km2: countryside %d, rear area %d\n", hot[0], hot[1]);
    CHECK(hot[0] > 0 && hot[1] > 4 * hot[0]);
    for (int class = 0; class < CLUTTER_CLASSES; class ++) all += kind[class];
    for (int class = 0; class < CLUTTER_CLASSES; class ++) {
        if (kind[class] > 0)
            print_message("of %d: %s %d\n", all, scenery_class_name((SceneryClass) class), kind[class]);
        CHECK(kind[class] < 0.45 * all);
        kinds += kind[class] > 0.05 * all;
    }
    CHECK(kinds >= 4 && kind[CLUTTER_FIRE] > 0 && kind[CLUTTER_FIRE] < 0.05 * all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_dense_as_the_table),       cmocka_unit_test(as_many_by_ways_and_plots),
        cmocka_unit_test(states_are_shared_out),       cmocka_unit_test(stands_on_the_ground),
        cmocka_unit_test(squares_fit_together),        cmocka_unit_test(limits_hold),
        cmocka_unit_test(the_tables_that_are_shipped), cmocka_unit_test(tables_by_name),
        cmocka_unit_test(rear_area_is_warm),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
