/* Clutter that drives off the ways: over soil alone, clear of the exercise, ways and what stands, the same for any
 * square that holds it; and ruts of what came over soil and stands. */
#include "tests/entities/clutter_fixture.h"

static const char lorries[] = "lorry,lorry,,field,40,1,1,0,0,0,drives,0,0\n"
                              "van,van,,pasture,40,1,1,0,0,0,drives,0,0\n"
                              "crates,crates,,field,3000,1,1,0,0,0,cold,0,0\n"
                              "crates,crates,,pasture,3000,1,1,0,0,0,cold,0,0";

static double nearest_fix_m(const double p[2])
{
    double least_m = INFINITY;
    for (int k = 0; k < 64; k++) least_m = fmin(least_m, hypot(p[0] - fix[k].p_enu[0], p[1] - fix[k].p_enu[1]));
    return least_m;
}

static void over_soil_and_clear_of_all(void **state)
{
    (void)state;
    ClutterConfig c = about(&land, 900);
    Scenery       s = add_rows(&c, lorries);
    double        nearest_m = INFINITY, stands_m = INFINITY;
    print_message("%d drive among %d things\n", s.movers, s.objects);
    CHECK(s.movers > 40 && s.objects > 2000);
    for (int m = 0; m < s.movers; m++) {
        const SceneryMover *mover = &s.mover[m];
        const SceneryState *of = &s.state[s.object[mover->object].state];
        CHECK_NEAR(mover->speed_mps, 20 / 3.6, 0.21 * 20 / 3.6);
        CHECK(of->drives.engine > 0.75f && of->drives.speed_mps > 0);
        for (int k = 0; k < mover->count; k++) {
            const double *a = s.path_enu[mover->first + k], *b = s.path_enu[mover->first + (k + 1) % mover->count];
            CHECK_NEAR(a[2], elevation_height(&land.elevation, a[0], a[1], NULL), 1e-9);
            for (int part = 0; part < 4; part++) {
                const double p[2] = {a[0] + 0.25 * part * (b[0] - a[0]), a[1] + 0.25 * part * (b[1] - a[1])};
                WayPlace     way;
                CHECK(surface_loosens(landscape_surface(&land, p[0], p[1])));
                if (landscape_way(&way, &land, p[0], p[1])) CHECK(fabs(way.across_m) > way.half_m);
                nearest_m = fmin(nearest_m, nearest_fix_m(p));
                for (int o = 0; o < s.objects; o++)
                    if (s.object[o].class == CLUTTER_CRATES)
                        stands_m = fmin(stands_m, hypot(s.object[o].p_enu[0] - p[0], s.object[o].p_enu[1] - p[1]));
            }
            CHECK(s.path_loose[mover->first + k] == 1);
        }
    }
    print_message("%.1f m from reported vehicles, %.1f m from the middle of crates\n", nearest_m, stands_m);
    CHECK(nearest_m > clutter_clear_m && stands_m > 1.5);
    scenery_free(&s);
}

/* Both what drives and what gave way to it: those of a quarter are those of all that are in it. */
static void the_same_in_any_square(void **state)
{
    (void)state;
    ClutterConfig c = about(&plain, 900);
    Scenery       all = add_rows(&c, lorries);
    int           in = 0;
    c.south_west_m[0] = c.south_west_m[1] = 0;
    Scenery some = add_rows(&c, lorries);
    for (int k = 0; k < all.objects; k++) {
        const SceneryObject *o = &all.object[k];
        bool                 found = false;
        if (o->p_enu[0] < 0 || o->p_enu[1] < 0) continue;
        in++;
        for (int n = 0; n < some.objects; n++) found |= some.object[n].id == o->id;
        CHECK(found);
    }
    print_message("%d of %d in the quarter, %d drive there\n", in, all.objects, some.movers);
    CHECK(in == some.objects && some.movers > 2);
    scenery_free(&all), scenery_free(&some);
}

static void ruts_lie_behind_what_came(void **state)
{
    (void)state;
    ClutterConfig c = about(&plain, 1200);
    Scenery       s = add_rows(&c, "lorry,lorry,,field,100,1,1,0,0,0,engine,0.2,0.5\n"
                                         "crates,crates,,field,100,1,1,0,0,0,cold,0,0\n"
                                         "car,car,,road,8,1,1,0,0,0,engine,0.2,0.5");
    int           with = 0, stands = 0;
    CHECK(s.ruts > 100);
    for (int k = 0; k < s.objects; k++) stands += s.object[k].class == CLUTTER_LORRY;
    for (int k = 0, of = -1, pieces = 0; k < s.ruts; k++) {
        const SceneryRut    *r = &s.rut[k];
        const SceneryObject *o = &s.object[r->object];
        const double         way[2] = {r->b_enu[0] - r->a_enu[0], r->b_enu[1] - r->a_enu[1]};
        const double         stood_s = (double)s.state[o->state].stood_s;
        CHECK(o->class == CLUTTER_LORRY && r->came_s > 0);
        if (stood_s > 0) CHECK_NEAR(r->came_s / stood_s, 1, 1e-3);
        CHECK_NEAR(hypot(way[0], way[1]), 15, 1e-9);
        CHECK(surface_loosens(landscape_surface(&plain, r->a_enu[0], r->a_enu[1])));
        CHECK_NEAR(r->a_enu[2], elevation_height(&plain.elevation, r->a_enu[0], r->a_enu[1], NULL), 1e-9);
        if (r->object != of) { /* the last piece ends below it, along its heading but for a bend */
            of = r->object, pieces = 0, with++;
            CHECK_NEAR(r->b_enu[0], o->p_enu[0], 1e-9);
            CHECK_NEAR(r->b_enu[1], o->p_enu[1], 1e-9);
            const double forward = (way[0] * o->r_enu_from_body[0] + way[1] * o->r_enu_from_body[3]) / 15;
            CHECK(forward > 0.9);
        } else CHECK(memcmp(r->b_enu, s.rut[k - 1].a_enu, sizeof r->b_enu) == 0);
        CHECK(++pieces <= 8);
    }
    print_message("%d of %d lorries have ruts, of %d pieces\n", with, stands, s.ruts);
    CHECK(with > 0.9 * stands);
    scenery_free(&s);
}

static void not_through_woods(void **state)
{
    (void)state;
    ClutterConfig c = about(&plain, 100);
    char          path[text_file_size];
    Scenery       s = {0};
    text_file(path, HEADER "lorry,lorry,,forest,40,1,1,0,0,0,drives,0,0\n");
    c.table = path;
    assert_int_equal(scenery_add_clutter(&s, &c), STATUS_BAD_VALUE);
    text_file(path, HEADER "lorry,lorry,,field,40,2,3,0,0,0,drives,0,0\n");
    assert_int_equal(scenery_add_clutter(&s, &c), STATUS_BAD_VALUE);
    remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(over_soil_and_clear_of_all), cmocka_unit_test(the_same_in_any_square),
        cmocka_unit_test(ruts_lie_behind_what_came), cmocka_unit_test(not_through_woods)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
