/* Where plants stand in an exercise: invented woods are clear of every path, by distances worked out here; real ones
 * stay and what begins in a trunk is counted; what is said of them. */
#include "tests/check.h"

#include "dis/pdu/decode.h"
#include "sensor/node/choices/choices.h"
#include "tests/sensor/stood_exercise.h"

static Config woods_on(void)
{
    Config config = config_default();
    config.terrain.woods = true;
    config.terrain.woods_half_m = 400;
    config.terrain.spacing_m = 8;
    return config;
}

/* The ground, and the woods on it. */
static void plant(WoodsChoice *out, Landscape *land, Choices *choices, const Exercise *e, const Config *config)
{
    HostPlan      plan = {0};
    GroundContact contact;
    choices->count = 0;
    assert_int_equal(stood_ground(land, &contact, choices, e, config, &plan), STATUS_OK);
    assert_int_equal(stood_woods(out, choices, e, config, &plan, land), STATUS_OK);
}

static double to_segment_m(const double p[2], const double a[2], const double b[2])
{
    const double d[2] = {b[0] - a[0], b[1] - a[1]}, l2 = d[0] * d[0] + d[1] * d[1];
    const double t = l2 > 0 ? clamp(((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / l2, 0, 1) : 0;
    return hypot(p[0] - a[0] - t * d[0], p[1] - a[1] - t * d[1]);
}

/* The plant nearest a segment, from its foot. */
static double nearest_m(const Woods *woods, const double a[2], const double b[2])
{
    double nearest = INFINITY;
    for (int i = 0; i < woods->count; i++) {
        const Plant *plant = &woods->plant[i];
        const double p[2] = {woods->origin_enu[0] + (double)plant->p_m[0],
                             woods->origin_enu[1] + (double)plant->p_m[1]};
        nearest = fmin(nearest, to_segment_m(p, a, b));
    }
    return nearest;
}

static void enu(double out[3], const Landscape *land, const double p_ecef[3])
{
    enu_from_ecef(out, &land->frame, p_ecef);
}

/* Fewer trees than there would be without it are no proof: every foot is measured. */
static void invented_woods_are_clear_of_every_path(void **state)
{
    (void)state;
    WoodsChoice  woods;
    Landscape    land;
    Choices      choices;
    const Config config = woods_on();
    Exercise    *e = fresh();
    stand(e, tank, 0, 0, 500, 8, 12); /* 176 m eastwards */
    stand(e, tank, -100, 150, 500, 0, 3);
    stand(e, man, 50, -80, 500, 1.4, 8);
    stand(e, missile, -200, -200, 510, 15, 16); /* 10 m up */
    stand(e, jet, -250, 250, 3000, 15, 16);     /* far above every tree */
    e->shot[0] = (Shot){.firing = e->track[0].id, .result = dis_result_ground_impact, .fire_s = 1, .detonation_s = 2};
    const double burst_m[3] = {-120, -60, 500};
    ecef_from_enu(e->shot[0].p_burst_ecef, &frame, burst_m);
    e->survey.shot_count = 1;
    plant(&woods, &land, &choices, e, &config);
    CHECK(woods.on && woods.woods.count > 100);
    double half_m[4] = {0, 0, 0, 5}; /* half a vehicle's width, and no more; of a flight, a crown's */
    for (int t = 0; t < 3; t++)
        half_m[t] = 0.5 * catalog_model(catalog, catalog_find(catalog, e->track[t].type, NULL, NULL))->width_m;
    for (int t = 0; t < 4; t++) {
        const Track *track = &e->track[t];
        double       a[3], b[3];
        for (int n = 0; n + 1 < track->count; n++) {
            enu(a, &land, track->point[n].p_ecef);
            enu(b, &land, track->point[n + 1].p_ecef);
            CHECK(nearest_m(&woods.woods, a, b) >= half_m[t] - 0.01);
        }
    }
    double p[3];
    enu(p, &land, e->shot[0].p_burst_ecef);
    CHECK(nearest_m(&woods.woods, p, p) >= 1 - 0.01);
    for (int i = 0; i < woods.config.path_count; i++) /* grass and crops stay everywhere */
        CHECK(woods.path[i].low_half_m == 0 && woods.path[i].half_m <= 6);
    CHECK(woods.entities == 3 && woods.in_trunks == 0);
    CHECK(says(&choices, "cleared along the paths of 3 entities on the ground, where 1 shot hit it"));
    CHECK(says(&choices, "woods: ") && says(&choices, "0.4 km about the aim (terrain.woods)"));
    /* nothing of the jet: 15 reports, each 30 m further */
    double last[3];
    enu(last, &land, e->track[4].point[15].p_ecef);
    for (int i = 0; i < woods.config.path_count; i++) CHECK(fabs(woods.path[i].a_m[1] - last[1]) > 40);

    /* the twin: without paths trees stand there */
    const int cleared = woods.woods.count;
    choice_woods_free(&woods);
    WoodsConfig bare = {.seed = (uint64_t)config.seed, .half_width_m = 400, .most_trees = config.terrain.woods_trees};
    Woods       wild;
    assert_int_equal(woods_create(&wild, &land, &bare, NULL), STATUS_OK);
    CHECK(wild.count >= cleared);
    woods_destroy(&wild);
    landscape_destroy(&land);
}

static bool said(const Choices *choices, const char *text)
{
    for (int i = 0; i < choices->count; i++)
        if (strstr(choices->line[i], text)) return true;
    return false;
}

/* A man moved to where a tree stands, on the same ground: if it came from a file the tree stays, else it gives way. */
static void entities_in_trunks_are_counted_where_trees_stay(void **state)
{
    (void)state;
    WoodsChoice woods;
    Landscape   land;
    Choices     choices;
    Config      config = woods_on(), real = config;
    HostPlan    plan = {0};
    Exercise   *e = fresh();
    strcpy(real.terrain.elevation, "given.tif");
    stand(e, tank, 0, 0, 500, 0, 3);
    plant(&woods, &land, &choices, e, &config);
    choice_woods_free(&woods);
    assert_int_equal(stood_woods(&woods, &choices, e, &real, &plan, &land), STATUS_OK);
    CHECK(woods.entities == 1 && woods.config.path_count == 0);
    double tree_m[3] = {NAN, NAN, 500};
    int    trunk;
    for (int i = 0; i < woods.woods.count && isnan(tree_m[0]); i++) {
        const Plant *tree = &woods.woods.plant[i];
        double       at_m[2];
        for (int k = 0; k < 2; k++) at_m[k] = woods.woods.origin_enu[k] + (double)tree->p_m[k];
        if (woods_trunk_m(tree) > 0 && hypot(at_m[0], at_m[1]) > 50) memcpy(tree_m, at_m, sizeof at_m);
    }
    CHECK(!isnan(tree_m[0]) && woods_near(&trunk, 1, &woods.woods, tree_m[0], tree_m[1], 1) > 0);
    choice_woods_free(&woods);

    stand(e, man, tree_m[0], tree_m[1], 500, 0, 3);
    choices.count = 0;
    assert_int_equal(stood_woods(&woods, &choices, e, &real, &plan, &land), STATUS_OK);
    CHECK(woods.entities == 2 && woods.in_trunks == 1 && woods.config.path_count == 0);
    CHECK(woods_near(&trunk, 1, &woods.woods, tree_m[0], tree_m[1], 1) > 0);
    CHECK(says(&choices, "1 of 2 entities on the ground begin within a trunk; real trees stay"));
    choice_woods_free(&woods);

    choices.count = 0;
    assert_int_equal(stood_woods(&woods, &choices, e, &config, &plan, &land), STATUS_OK);
    CHECK(woods.entities == 2 && woods.in_trunks == 0);
    CHECK(woods_near(&trunk, 1, &woods.woods, tree_m[0], tree_m[1], 1) == 0);
    CHECK(!said(&choices, "begin within a trunk"));
    choice_woods_free(&woods);
    landscape_destroy(&land);
}

static void off_is_off_and_few_are_few(void **state)
{
    (void)state;
    WoodsChoice woods;
    Landscape   land;
    Choices     choices;
    Config      config = woods_on();
    Exercise   *e = fresh();
    stand(e, tank, 0, 0, 500, 8, 12);
    config.terrain.woods = false;
    plant(&woods, &land, &choices, e, &config);
    CHECK(!woods.on && woods.woods.count == 0 && !woods.path);
    CHECK(!said(&choices, "woods"));
    choice_woods_free(&woods);
    landscape_destroy(&land);

    config.terrain.woods = true;
    config.terrain.woods_leaves = false;
    config.terrain.woods_trees = 50;
    plant(&woods, &land, &choices, e, &config);
    int trees = 0;
    for (int k = 0; k < PLANT_TREES; k++) trees += woods.woods.by_kind[k];
    CHECK(trees <= 50 && woods.woods.count <= 50 && woods.woods.left_out > 0);
    CHECK(woods.config.far_half_m == 0 && woods.woods.pages_x == 0);
    CHECK(says(&choices, "more are left out") && says(&choices, "(terrain.woods_trees)"));
    CHECK(says(&choices, "deciduous trees are bare (terrain.woods_leaves)"));
    choice_woods_free(&woods);
    landscape_destroy(&land);
}

/* About a vehicle in the middle of them, as far as they go, in a step of 2^0.5 from 1 km, and 4 km more. */
static void the_square_holds_the_exercise(void **state)
{
    (void)state;
    WoodsChoice woods;
    Landscape   land;
    Choices     choices;
    Config      config = woods_on();
    Exercise   *e = fresh();
    HostPlan    plan = {0};
    double      p[3];
    config.terrain.woods_half_m = 0;
    config.terrain.woods_trees = 0; /* none: only where they would stand */
    stand(e, tank, 0, 0, 500, 0, 3);
    stand(e, tank, 1100, 300, 500, 0, 3);
    stand(e, tank, 2500, 300, 500, 0, 3);
    stand(e, tank, 40000, 0, 500, 0, 3); /* of another fight */
    plan.aim = e->track[0].id;
    plan.end_s = 104;
    GroundContact contact;
    choices.count = 0;
    assert_int_equal(stood_ground(&land, &contact, &choices, e, &config, &plan), STATUS_OK);
    assert_int_equal(stood_woods(&woods, &choices, e, &config, &plan, &land), STATUS_OK);
    enu(p, &land, e->track[1].point[0].p_ecef);
    CHECK_NEAR(woods.config.centre_m[0], p[0], 0.1);
    CHECK_NEAR(woods.config.centre_m[1], p[1], 0.1);
    CHECK_NEAR(woods.config.half_width_m, 4000 + 1000 * sqrt(2), 1);
    CHECK(woods.config.far_half_m == 50000);       /* pages, but where the aim has a square of its own */
    assert_int_equal(woods.config.place_count, 3); /* what trees are kept about */
    for (int t = 0; t < 3; t++) {
        double away_m = INFINITY;
        enu(p, &land, e->track[t].point[0].p_ecef);
        for (int n = 0; n < 3; n++)
            away_m = fmin(away_m, hypot(woods.config.place[n].p_m[0] - p[0], woods.config.place[n].p_m[1] - p[1]));
        CHECK(away_m < 0.7072 * woods_square_m);
    }
    choice_woods_free(&woods);
    landscape_destroy(&land);
}

/* A world as a plan has it. */
typedef struct Chosen {
    LocalFrame  world;
    WoodsSquare square;
} Chosen;

static Chosen chosen(const Exercise *e, int aim, int host, double range_m, double half_m)
{
    Chosen   c;
    Config   config = woods_on();
    HostPlan plan = {.end_s = 104};
    config.terrain.woods_half_m = half_m;
    config.observer.range_m = range_m;
    if (aim >= 0) plan.aim = e->track[aim].id;
    if (host >= 0) plan.host = e->track[host].id;
    assert_int_equal(choice_frame(&c.world, &e->survey, &plan), STATUS_OK);
    assert_int_equal(choice_square(&c.square, &e->survey, &config, &c.world, &plan), STATUS_OK);
    return c;
}

static bool is_same(const Chosen *a, const Chosen *b)
{
    return memcmp(a->world.origin_ecef, b->world.origin_ecef, sizeof a->world.origin_ecef) == 0 &&
           memcmp(a->square.centre_m, b->square.centre_m, sizeof a->square.centre_m) == 0 &&
           a->square.half_width_m == b->square.half_width_m;
}

/* Aims of one cell, at ranges within what the vehicles need, have one world, wherever on the Earth; any aim is within a
 * cell of its world's origin. */
static void aims_of_a_cell_share_a_world(void **state)
{
    (void)state;
    static const double place_deg[][2] = {{36, -5}, {0, 180}, {90, 0}, {-89.999, 77}, {64.5, -179.9999}};
    const LocalFrame    kept = frame;
    for (int k = 0; k < 5; k++) {
        const Geodetic at = {place_deg[k][0] * rad_per_deg, place_deg[k][1] * rad_per_deg, 0};
        assert_int_equal(local_frame_at(&frame, &at), STATUS_OK);
        Exercise *e = fresh();
        stand(e, tank, -1200, 900, 300, 3, 3);
        stand(e, tank, 0, 0, 300, 0, 3);
        stand(e, man, 300, -400, 300, 1, 3);
        stand(e, tank, 1900, 800, 300, 0, 3);
        stand(e, missile, 3000, 0, 600, -100, 3);
        stand(e, jet, 9000, 60000, 3000, 100, 3);
        stand(e, tank, 100000, 0, 300, 0, 3);
        const Chosen first = chosen(e, 0, -1, 600, 0);
        for (int aim = 1; aim < 4; aim++) {
            const Chosen other = chosen(e, aim, -1, 100 * aim, 0);
            CHECK(is_same(&first, &other));
        }
        const Chosen far = chosen(e, 6, -1, 600, 0), wide = chosen(e, 0, -1, 5000, 0), own = chosen(e, 3, -1, 600, 400);
        CHECK(memcmp(far.world.origin_ecef, first.world.origin_ecef, sizeof far.world.origin_ecef) != 0);
        CHECK(wide.square.half_width_m >= 9000 && wide.square.half_width_m < 4000 + 5000 * sqrt(2));
        CHECK(memcmp(wide.world.origin_ecef, first.world.origin_ecef, sizeof wide.world.origin_ecef) == 0);
        for (int aim = 0; aim < 7; aim++) {
            const Chosen c = chosen(e, aim, aim == 3 ? 4 : -1, 600, 0);
            double       p_enu[3];
            enu_from_ecef(p_enu, &c.world, e->track[aim].point[2].p_ecef);
            CHECK(hypot(p_enu[0], p_enu[1]) < sqrt(3) * choice_cell_m);
            CHECK(c.square.half_width_m > hypot(p_enu[0], p_enu[1]));
        }
        double p_enu[3]; /* a square of the user's own is about the aim itself */
        enu_from_ecef(p_enu, &own.world, e->track[3].point[2].p_ecef);
        CHECK_NEAR(own.square.centre_m[0], p_enu[0], 0.2);
        CHECK_NEAR(own.square.centre_m[1], p_enu[1], 0.2);
        assert_int_equal((int)own.square.half_width_m, 400);
    }
    frame = kept;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(invented_woods_are_clear_of_every_path),
        cmocka_unit_test(entities_in_trunks_are_counted_where_trees_stay),
        cmocka_unit_test(off_is_off_and_few_are_few),
        cmocka_unit_test(the_square_holds_the_exercise),
        cmocka_unit_test(aims_of_a_cell_share_a_world),
    };
    return cmocka_run_group_tests(tests, open_place, close_place);
}
