/* Ground by seed and place: the same figures make the same bits, its height where it is told; texts of places; the
 * footprint that plants leave to what stands. */
#include "terrain/ground/placed.h"
#include "terrain/woods/woods.h"
#include "tests/check.h"

static LandscapeConfig coarse(uint64_t seed)
{
    LandscapeConfig config = landscape_default_config();
    config.seed = seed, config.spacing_m = 30, config.half_width_m = 3000;
    return config;
}

static void ground_follows_from_seed_and_place(void **state)
{
    (void)state;
    Landscape             a, b, c;
    Geodetic              place, other;
    const LandscapeConfig one = coarse(3), two = coarse(4);
    CHECK(landscape_place_parse(&place, "50.1,8.6,120") && landscape_place_parse(&other, " 50.1, 8.6, 120"));
    assert_memory_equal(&place, &other, sizeof place);
    assert_int_equal(landscape_placed(&a, &one, &place, NULL), STATUS_OK);
    assert_int_equal(landscape_placed(&b, &one, &other, NULL), STATUS_OK);
    assert_int_equal(landscape_placed(&c, &two, &place, NULL), STATUS_OK);
    Geodetic     at;
    double       p_ecef[3], differ = 0;
    const double p_enu[3] = {0, 0, elevation_height(&a.elevation, 0, 0, NULL)};
    ecef_from_enu(p_ecef, &a.frame, p_enu);
    assert_int_equal(geodetic_from_ecef(&at, p_ecef), STATUS_OK);
    CHECK_NEAR(at.lat_rad / rad_per_deg, 50.1, 1e-9);
    CHECK_NEAR(at.lon_rad / rad_per_deg, 8.6, 1e-9);
    CHECK_NEAR(at.h_m, 120, 0.05);
    for (int n = 0; n < 400; n++) {
        const double x = 4000 * (random_uniform(1, 0, 0, 2 * (uint64_t)n) - 0.5),
                     y = 4000 * (random_uniform(1, 0, 0, 2 * (uint64_t)n + 1) - 0.5);
        assert_true(elevation_height(&a.elevation, x, y, NULL) == elevation_height(&b.elevation, x, y, NULL));
        assert_true(landscape_surface(&a, x, y) == landscape_surface(&b, x, y));
        differ =
            fmax(differ, fabs(elevation_height(&a.elevation, x, y, NULL) - elevation_height(&c.elevation, x, y, NULL)));
    }
    CHECK(differ > 1);
    landscape_destroy(&a), landscape_destroy(&b), landscape_destroy(&c);
}

static void texts_of_places(void **state)
{
    (void)state;
    static const char *const good[] = {"90,180,9000", "-90,-180,-500", "0,0,0", "1e1,2.5e0,-1"};
    static const char *const bad[] = {
        "",           "50,8",     "50,8,",
        "50,8,120,1", "90.1,0,0", "0,180.1,0",
        "0,0,9000.1", "0,0,-501", "nan,0,0",
        "0,inf,0",    ",,",       "a,b,c",
        "50;8;120",   "50 8 120", "1,2,3 m",
        "0x10,0,0",   " , , ",    "0,0,00000000000000000000000000000000000000000000000000000000001"};
    Geodetic place = {7, 7, 7};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        if (!landscape_place_parse(&place, good[i])) fail_msg("'%s'", good[i]);
    place = (Geodetic){7, 7, 7};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (landscape_place_parse(&place, bad[i])) fail_msg("'%s'", bad[i]);
    CHECK(place.lat_rad == 7 && place.h_m == 7); /* untouched */
}

/* Every place of the rectangle of a vehicle is at least 0.2 m inside of its footprint (0.5 m beside it), and nothing
 * farther than a quarter of its width and half a metre before or behind it is in it. */
static void footprint_holds_the_vehicle_and_little_more(void **state)
{
    (void)state;
    for (int n = 0; n < 300; n++) {
        const uint64_t at = 8 * (uint64_t)n;
        const double   heading = 2 * pi_rad * random_uniform(2, 0, 0, at),
                     width = 1 + 7 * random_uniform(2, 0, 0, at + 1);
        const double front = 0.5 * width + 8 * random_uniform(2, 0, 0, at + 2),
                     back = -0.5 * width - 8 * random_uniform(2, 0, 0, at + 3);
        const double    p[2] = {1000 * random_uniform(2, 0, 0, at + 4), -500}, nose[2] = {sin(heading), cos(heading)};
        const WoodsPath path = woods_footprint(p, nose, front, back, width);
        CHECK_NEAR(path.half_m, 0.5 * width + 0.5, 1e-12);
        for (int i = 0; i <= 8; i++)
            for (int j = 0; j <= 8; j++) {
                const double along = back + (front - back) * i / 8, right = width * (j / 8.0 - 0.5);
                const double x = p[0] + along * nose[0] + right * nose[1], y = p[1] + along * nose[1] - right * nose[0];
                CHECK(woods_path_away_m(&path, x, y) <= path.half_m);
            }
        const double off = 0.25 * width + 0.51;
        CHECK(woods_path_away_m(&path, p[0] + (front + off) * nose[0], p[1] + (front + off) * nose[1]) > path.half_m);
        CHECK(woods_path_away_m(&path, p[0] + (back - off) * nose[0], p[1] + (back - off) * nose[1]) > path.half_m);
        const double side = 0.5 * width + 0.51;
        CHECK(woods_path_away_m(&path, p[0] + side * nose[1], p[1] - side * nose[0]) > path.half_m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_follows_from_seed_and_place),
        cmocka_unit_test(texts_of_places),
        cmocka_unit_test(footprint_holds_the_vehicle_and_little_more),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
