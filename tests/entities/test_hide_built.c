/* Vehicles that hide behind what is built: never in it, near a wall on the side that the observer does not see, hidden
 * by their own triangles as the search says; what is built makes room along routes. */
#include "tests/check.h"

#include "entities/exercise/cast_private.h"
#include "entities/exercise/hide.h"

static Scenario scenario;

#define GROUND                                                                                                         \
    "place: {lat_deg: 50.1, lon_deg: 8.6, height_m: 120}\n"                                                            \
    "ground: {planted: true, buildings: true, seed: 1, spacing_m: 30}\nduration_s: 60\nvehicles:\n"

static Cast *cast_of(const char *text)
{
    char  path[text_file_size];
    Cast *cast = NULL;
    text_file(path, text);
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    if (scenario_read(&scenario, path) != STATUS_OK || cast_create(&cast, &scenario) != STATUS_OK)
        fail_msg("%s", check_said);
    log_set_sink(NULL, NULL);
    remove(path);
    return cast;
}

static void release(Cast *cast)
{
    cast_destroy(cast);
    scenario_destroy(&scenario);
}

static void land_of(double out[3], double nose[2], const Cast *cast, int entity, double t_s)
{
    CastPose pose;
    double   p_ecef[3];
    cast_pose(&pose, cast, entity, t_s);
    ecef_from_enu(p_ecef, &cast->ground.frame, pose.p_enu);
    enu_from_ecef(out, &cast->ground.stored.frame, p_ecef);
    nose[0] = pose.r_enu_from_body[0], nose[1] = pose.r_enu_from_body[3];
}

static bool is_in(const double (*p)[2], int n, double x, double y)
{
    bool in = false;
    for (int k = 0, l = n - 1; k < n; l = k++)
        if ((p[l][1] > y) != (p[k][1] > y) && x < p[l][0] + (y - p[l][1]) * (p[k][0] - p[l][0]) / (p[k][1] - p[l][1]))
            in = !in;
    return in;
}

/* Places of a box of 7 x 3.4 m about a pose that are in a building. */
static int places_in_buildings(const Culture *c, const double p[3], const double nose[2])
{
    int in = 0;
    for (int k = 0; k < 15; k++) {
        const double along = 3.5 * (k % 5 - 2) / 2, right = 1.7 * (k / 5 - 1);
        for (int n = 0; n < c->buildings; n++)
            in += is_in((const double(*)[2])c->corner_m + c->building[n].first_corner, c->building[n].corners,
                        p[0] + along * nose[0] + right * nose[1], p[1] + along * nose[1] - right * nose[0]);
    }
    return in;
}

/* The nearest point of an outline, and how far it is. */
static double outline_m(double at[2], const double (*p)[2], int n, const double q[3])
{
    double least = INFINITY;
    for (int k = 0; k < n; k++) {
        const double *a = p[k], *b = p[(k + 1) % n], dx = b[0] - a[0], dy = b[1] - a[1];
        const double  t = clamp(((q[0] - a[0]) * dx + (q[1] - a[1]) * dy) / (dx * dx + dy * dy), 0, 1);
        const double  m = hypot(a[0] + t * dx - q[0], a[1] + t * dy - q[1]);
        if (m < least) least = m, at[0] = a[0] + t * dx, at[1] = a[1] + t * dy;
    }
    return least;
}

static void behind_buildings(void **state)
{
    (void)state;
    Cast *cast =
        cast_of(GROUND "  - {name: A, type: tank, hide: building, hide_m: 900, count: 5, route_m: [[0, 0]]}\n"
                       "  - {name: B, type: jeep, hide: building, hide_m: 900, count: 5, route_m: [[0, 0]]}\n");
    const Culture *c = &cast->ground.culture;
    int            near = 0;
    assert_int_equal(cast->hidden_count, 10);
    for (int n = 0; n < cast->hidden_count; n++) {
        double p[3], nose[2], nearest = INFINITY;
        land_of(p, nose, cast, cast->hidden[n].entity, 0);
        assert_int_equal(places_in_buildings(c, p, nose), 0);
        for (int b = 0; b < c->buildings; b++) {
            double       at[2] = {0, 0};
            const double m =
                outline_m(at, (const double(*)[2])c->corner_m + c->building[b].first_corner, c->building[b].corners, p);
            /* north of it: the observer is in the south */
            if (m < nearest && p[1] > at[1] - 2) nearest = m;
        }
        near += nearest < 13;
        CHECK(fabs(cast->hidden[n].planned - cast->hidden[n].judged) < 0.1);
    }
    assert_int_equal(near, 10);
    release(cast);
}

/* One wall of 4 x 40 m to the south, an observer 600 m to the south and 250 m up: of a plate 3 m high at 3 m behind it
 * none is seen, at 9 m what is over its shadow: 4 - 9 * 250 / 600 = 0.25 m. */
static void shadow_of_a_wall(void **state)
{
    (void)state;
    Culture           c = {0};
    Landscape         flat = {0};
    const CultureLine wall = {.id = 3, .width_m = 0.4f, .height_m = 4, .kind = CULTURE_WALL};
    const double      line[2][2] = {{-20, 0}, {20, 0}};
    HideSolids        solids;
    int               list[hide_solids_most];
    CHECK(elevation_level_create(&flat.elevation, 0, &(ElevationGrid){9, 9, -64, -64, 16, 0, 0.1}) == STATUS_OK);
    int32_t post[81];
    for (int n = 0; n < 81; n++) post[n] = 1000;
    CHECK(elevation_fill(&flat.elevation.level[0], post) == STATUS_OK);
    elevation_build_pyramids(&flat.elevation);
    assert_int_equal(culture_add_line(&c, &wall, line, 2), STATUS_OK);
    assert_int_equal(culture_index(&c), STATUS_OK);
    assert_int_equal(hide_solids_open(&solids, &c, &flat, (const double[2]){0, 0}, 100), STATUS_OK);
    const double far = hypot(600, 250), d[3] = {0, -600 / far, 250 / far};
    const double ground = elevation_height(&flat.elevation, 0, 5, NULL);
    CHECK(solids.count > 0);
    for (int k = 0; k < 2; k++) {
        const double at_m = k ? 9 : 3;
        const double p[3] = {0, at_m, ground};
        const int    count = hide_solids_along(list, &solids, p, 4, d, 650);
        int          hidden = 0, all = 0;
        for (double z = 0.01; z < 3; z += 0.01, all++)
            hidden += hide_solids_meet(&solids, list, count, (const double[3]){1, at_m, ground + z}, d);
        /* the top's edges are 0.2 m before and behind the middle */
        const double high_m = 4 - (at_m - 0.2) * 250 / 600;
        CHECK_NEAR((double)hidden / all, fmin(fmax(high_m / 3, 0), 1), 0.07);
        CHECK(!hide_solids_meet(&solids, list, count, (const double[3]){30, at_m, ground + 1}, d)); /* beside its end */
        CHECK(!hide_solids_meet(&solids, list, count, (const double[3]){0, -2, ground + 1}, d));    /* before it */
    }
    hide_solids_close(&solids);
    culture_free(&c);
    elevation_destroy(&flat.elevation);
}

/* More plants and triangles along a line than are looked at: as many as are beyond the limits are counted. */
static void what_is_left_out_is_counted(void **state)
{
    (void)state;
    enum {
        more_plants = 100,
        more_solids = 7,
        plants = hide_plants_most + more_plants,
        solids = hide_solids_most + more_solids
    };
    HideGround       ground = {0};
    Landscape        flat = {0};
    uint32_t         first[2] = {0, plants};
    static double    corner[solids][3][3], about[solids][3];
    static Plant     plant[plants];
    const HidePose   pose = {{8, 8, 0}, {1, 0}};
    const HidePoints points = {.count = 1, .p_body = {{0, 0, -1}}};
    const HideSight  sight = {{0, 1, 0}, 100};
    int              left_out = -1;
    CHECK(elevation_level_create(&flat.elevation, 0, &(ElevationGrid){9, 9, -64, -64, 16, 0, 0.1}) == STATUS_OK);
    elevation_fill(&flat.elevation.level[0], (const int32_t[81]){0});
    elevation_build_pyramids(&flat.elevation);
    for (int n = 0; n < plants; n++) plant[n] = (Plant){.kind = PLANT_PINE, .p_m = {8, 12, -1000}};
    for (int n = 0; n < solids; n++) about[n][0] = 8, about[n][1] = 30, about[n][2] = 1;
    ground.landscape = &flat;
    ground.woods = (Woods){.nx = 1, .ny = 1, .count = plants, .plant = plant, .first = first};
    ground.solids = (HideSolids){solids, corner, about};
    (void)hide_occlusion(&left_out, &ground, &pose, &points, &sight, NULL);
    assert_int_equal(left_out, more_plants + more_solids);
    first[1] = hide_plants_most, ground.solids.count = hide_solids_most;
    (void)hide_occlusion(&left_out, &ground, &pose, &points, &sight, NULL);
    assert_int_equal(left_out, 0);
    elevation_destroy(&flat.elevation);
}

/* Through the village whose houses are above: along the route none is left, and it is said. */
static void houses_give_way_to_routes(void **state)
{
    (void)state;
    Cast     *plain = cast_of(GROUND "  - {name: A, type: tank, route_m: [[0, 0]]}\n");
    const int buildings = plain->ground.culture.buildings;
    double    middle[2] = {0, 0};
    char      text[1024];
    /* from house to house near the place */
    int at = 0;
    for (int b = 0; b < buildings; b++) {
        const double *p = plain->ground.culture.corner_m[plain->ground.culture.building[b].first_corner];
        const double *q = plain->ground.culture.corner_m[plain->ground.culture.building[at].first_corner];
        if (hypot(p[0], p[1]) < hypot(q[0], q[1])) at = b;
    }
    memcpy(middle, plain->ground.culture.corner_m[plain->ground.culture.building[at].first_corner], sizeof middle);
    release(plain);
    snprintf(text, sizeof text,
             GROUND "  - {name: A, type: tank, speed_mps: 8, route_m: [[%.1f, %.1f], [%.1f, %.1f]]}\n", middle[0] - 150,
             middle[1] - 20, middle[0] + 150, middle[1] + 20);
    Cast *cast = cast_of(text);
    int   in = 0;
    CHECK(cast->ground.culture.buildings < buildings && strstr(check_said, "make room for vehicles"));
    for (double t = 0; t < 60; t += 0.2) {
        double p[3], nose[2];
        land_of(p, nose, cast, 0, t);
        in += places_in_buildings(&cast->ground.culture, p, nose);
    }
    assert_int_equal(in, 0);
    release(cast);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(behind_buildings), cmocka_unit_test(shadow_of_a_wall),
                                       cmocka_unit_test(what_is_left_out_is_counted),
                                       cmocka_unit_test(houses_give_way_to_routes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
