/* Which entities the ground is fitted to, one vote each, and where the sea is. Every ground here is a plane, a sphere
 * or a list of heights that no line of the landscape's computes. labels: physics */
#include "tests/check.h"

#include "terrain/ground/landscape.h"

static LocalFrame frame_at(double lat_deg, double lon_deg)
{
    const Geodetic origin = {lat_deg * rad_per_deg, lon_deg * rad_per_deg, 0};
    LocalFrame     frame;
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    return frame;
}

static LandscapeConfig small_config(void)
{
    LandscapeConfig config = landscape_default_config();
    config.half_width_m = 1500;
    config.horizon_m = 100000;
    return config;
}

static int add(GroundFix *fix, int count, int voter, double x_m, double y_m, double z_m)
{
    fix[count] = (GroundFix){.p_enu = {x_m, y_m, z_m}, .voter = voter};
    return count + 1;
}

/* Bit v - 1: voter v was outvoted; all of its fixes or none. */
static unsigned outvoted(const GroundFix *fix, int count)
{
    uint8_t  out[2000];
    unsigned voters = 0, whole = ~0u;
    assert_true(count <= 2000);
    assert_int_equal(invented_inconsistent(out, fix, count), STATUS_OK);
    for (int n = 0; n < count; n++) {
        if (fix[n].voter == 0) CHECK(!out[n]);
        else if (out[n]) voters |= 1u << (fix[n].voter - 1);
        else whole &= ~(1u << (fix[n].voter - 1));
    }
    CHECK((voters & ~whole) == 0);
    return voters;
}

/* Four stand on a plane, a fifth among, behind or beside them is so much off it. */
static void one_does_not_outvote_four(void **state)
{
    (void)state;
    static const double   four[4][2] = {{0, 0}, {45, 5}, {90, -5}, {50, 55}};
    static const double   odd[][2] = {{65, 30}, {-40, 0}, {130, -5}, {20, -30}, {45, 12}, {50, 90}};
    static const double   slope[][2] = {{0, 0}, {0.1, -0.05}, {0.3, 0.1}}, off_m[] = {-30, -20, 20, 30};
    const LandscapeConfig config = small_config();
    const LocalFrame      frame = frame_at(48, 11);
    for (int s = 0; s < 3; s++)
        for (int o = 0; o < 6; o++)
            for (int k = 0; k < 4; k++)
                for (int reports = 1; reports <= 301; reports += 300) { /* however often it says so */
                    GroundFix fix[400];
                    int       count = 0;
                    /* beyond the others a steep slope may as well have its crest */
                    if (s == 2 && fabs(off_m[k]) < 30 && o != 0 && o != 4) continue;
                    for (int n = 0; n < 4; n++)
                        count = add(fix, count, n + 1, four[n][0], four[n][1],
                                    100 + slope[s][0] * four[n][0] + slope[s][1] * four[n][1]);
                    const double plane_m = 100 + slope[s][0] * odd[o][0] + slope[s][1] * odd[o][1];
                    for (int n = 0; n < reports; n++)
                        count = add(fix, count, 5, odd[o][0] + 0.01 * n, odd[o][1], plane_m + off_m[k]);
                    if (outvoted(fix, count) != 1u << 4)
                        fail_msg("slope %d place %d off %g reports %d: outvoted %x", s, o, off_m[k], reports,
                                 outvoted(fix, count));
                    if (reports > 1 || s > 0) continue;

                    Landscape land; /* and the ground stays with the four */
                    CHECK(landscape_create(&land, &config, &frame, fix, count, NULL, 0) == STATUS_OK);
                    for (int n = 0; n < 4; n++)
                        CHECK_NEAR(elevation_height(&land.elevation, four[n][0], four[n][1], NULL), fix[n].p_enu[2],
                                   0.05);
                    CHECK_NEAR(elevation_height(&land.elevation, odd[o][0], odd[o][1], NULL), plane_m, 6);
                    CHECK(land.fixes_dropped == 1);
                    landscape_destroy(&land);
                }
}

/* What is no lie: entities that rise together, one that drives up, two groups at two heights, a hill's foot, a valley.
 */
static void true_hills_are_believed(void **state)
{
    (void)state;
    GroundFix fix[1000];
    for (double slope = -0.6; slope <= 0.65; slope += 0.2) { /* in a row, and over a hillside */
        int count = 0;
        for (int n = 0; n < 6; n++) count = add(fix, count, n + 1, 40 * n, 3 * (n & 1), 40 * n * slope);
        assert_int_equal(outvoted(fix, count), 0);
        count = 0;
        for (int n = 0; n < 9; n++) count = add(fix, count, n + 1, 40 * (n % 3), 50 * (n / 3), 50 * (n / 3) * slope);
        assert_int_equal(outvoted(fix, count), 0);
    }
    for (int way = -1; way <= 1; way += 2) { /* 30 m up, or down, at one in three, from among four that stay */
        int count = 0;
        for (int n = 0; n < 4; n++) count = add(fix, count, n + 1, 25 * n, 10 * (n & 1), 0);
        for (int n = 0; n <= 30; n++) count = add(fix, count, 5, 80 + 3.0 * n, 0, way * n);
        assert_int_equal(outvoted(fix, count), 0);
    }
    int count = 0; /* 60 m apart in height, 500 m apart on the map: both are right */
    for (int n = 0; n < 4; n++) count = add(fix, count, n + 1, 30 * n, 0, 10);
    for (int n = 0; n < 2; n++) count = add(fix, count, n + 5, 600 + 30 * n, 0, 70);
    assert_int_equal(outvoted(fix, count), 0);
    count = 0; /* three on the plain, three on the slope behind it */
    for (int n = 0; n < 6; n++) count = add(fix, count, n + 1, 40 * n, 0, n < 3 ? 0 : 20 * (n - 2));
    assert_int_equal(outvoted(fix, count), 0);
    count = 0; /* with one other there is no majority */
    count = add(fix, count, 1, 0, 0, 0);
    count = add(fix, count, 2, 30, 0, 30);
    assert_int_equal(outvoted(fix, count), 0);
    count = 0; /* places of no voter are not judged here */
    for (int n = 0; n < 5; n++) count = add(fix, count, 0, 40 * n, 0, n == 2 ? 30 : 0);
    assert_int_equal(outvoted(fix, count), 0);
    fix[0].voter = 6;
    CHECK(invented_inconsistent((uint8_t[8]){0}, fix, count) == STATUS_BAD_VALUE);
    fix[0].voter = -1;
    CHECK(invented_inconsistent((uint8_t[8]){0}, fix, count) == STATUS_BAD_VALUE);
}

/* Rolling country of slopes up to 0.3, a hundred entities about 90 m apart, ten of them 25 m off, against 15 m that
 * 90 m of free slope allow: nine lies in ten are found, and one truth in a hundred goes with them. */
static void lies_are_told_from_country(void **state)
{
    (void)state;
    int caught = 0, wronged = 0;
    for (uint64_t seed = 1; seed <= 8; seed++) {
        static GroundFix fix[2000];
        uint8_t          out[2000];
        int              count = 0;
        for (int v = 1; v <= 100; v++) {
            double x = 900 * random_uniform(seed, 0, 0, (uint64_t)v), y = 900 * random_uniform(seed, 1, 0, (uint64_t)v);
            const double lie_m = v <= 10 ? (v & 1 ? 25 : -25) : 0;
            for (int n = 0; n < 10; n++, x += 9, y += 3)
                count = add(fix, count, v, x, y, 20 * sin(x / 97) * cos(y / 140) + lie_m);
        }
        assert_int_equal(invented_inconsistent(out, fix, count), STATUS_OK);
        for (int v = 0; v < 100; v++) *(v < 10 ? &caught : &wronged) += out[10 * v];
    }
    printf("of 80 lies %d found, of 720 truths %d wronged\n", caught, wronged);
    CHECK(caught >= 68);
    CHECK(wronged <= 10);
}

static void places_are_held_against_their_neighbours_plane(void **state)
{
    (void)state;
    GroundFix fix[6];
    int       count = 0;
    double    above_m[3], nearest_m[3];
    for (int n = 0; n < 5; n++)
        count = add(fix, count, n + 1, 30 * n, 20 * (n % 3), 7 + 0.2 * 30 * n - 0.1 * 20 * (n % 3));
    const double place[3][3] = {{60, 10, 7 + 12 - 1 + 9}, {60, 40, 7 + 12 - 4}, {900, 0, 0}};
    CHECK(invented_consensus_height(above_m, nearest_m, place, 3, fix, count) == STATUS_OK);
    CHECK_NEAR(above_m[0], 9, 1e-9);
    CHECK_NEAR(nearest_m[0], 30, 1e-9);
    CHECK_NEAR(above_m[1], 0, 1e-9);
    CHECK(isnan(above_m[2]) && isnan(nearest_m[2]));
}

/* ---- the sea ------------------------------------------------------------------------------ */

static double h_of(const Landscape *land, double x_m, double y_m)
{
    double       p_ecef[3];
    const double p_enu[3] = {x_m, y_m, elevation_height(&land->elevation, x_m, y_m, NULL)};
    Geodetic     place;
    ecef_from_enu(p_ecef, &land->frame, p_enu);
    CHECK(geodetic_from_ecef(&place, p_ecef) == STATUS_OK);
    return place.h_m;
}

static void ships_alone_have_sea_to_the_horizon(void **state)
{
    (void)state;
    static const double level_m[] = {0, 45.3, -28};
    for (int k = 0; k < 3; k++) {
        const LocalFrame      frame = frame_at(36, -5);
        const LandscapeConfig config = small_config();
        const CoastPlace      ship = {100, 200, true};
        /* a sea skimmer's way: 1 m above the water, then under it; neither digs a hole */
        const ClearLine         line[2] = {{{-800, 0, level_m[k] + 1}, {800, 0, level_m[k] + 1}},
                                           {{0, -800, level_m[k] - 5}, {0, 800, level_m[k] - 5}}};
        const LandscapeEvidence said = {
            .place = &ship, .place_count = 1, .line = line, .line_count = 2, .sea_h_m = level_m[k]};
        Landscape land;
        CHECK(landscape_create_from(&land, &config, &frame, &said) == STATUS_OK);
        const double step_m = land.elevation.level[0].step_m;
        for (int n = 0; n < 3000; n++) {
            const double x = 2800 * (random_uniform(1, 0, 0, n) - 0.5), y = 2800 * (random_uniform(1, 1, 0, n) - 0.5);
            CHECK(landscape_surface(&land, x, y) == SURFACE_WATER);
            CHECK_NEAR(h_of(&land, x, y), level_m[k], step_m + 2e-3);
        }
        for (int n = 0; n < 300; n++) { /* posts far out are farther apart: the chord of the curved Earth, and steps */
            const double x = 190000 * (random_uniform(2, 0, 0, n) - 0.5),
                         y = 190000 * (random_uniform(2, 1, 0, n) - 0.5);
            const double s = land.elevation.level[3].spacing_m;
            CHECK(landscape_surface(&land, x, y) == SURFACE_WATER);
            CHECK_NEAR(h_of(&land, x, y), level_m[k], land.elevation.level[3].step_m + 2 * s * s / 8 / 6.35e6 + 0.01);
        }
        landscape_destroy(&land);
    }
}

/* A battalion at 12 m and 60 m, ships some kilometres off at 0, a harbour where they are 40 m apart. */
static int make_coast(GroundFix *fix, CoastPlace *place, int *places, uint64_t seed)
{
    int count = 0;
    *places = 0;
    for (int n = 0; n < 40; n++) {
        const double x = -1200 + 900 * random_uniform(seed, 0, 0, n), y = 1600 * (random_uniform(seed, 1, 0, n) - 0.5);
        const double z = 12 + 48 * (n & 1) * (x < -800);
        place[(*places)++] = (CoastPlace){x, y, false};
        count = add(fix, count, n + 1, x, y, z);
    }
    for (int n = 0; n < 12; n++)
        place[(*places)++] =
            (CoastPlace){600 + 700 * random_uniform(seed, 2, 0, n), 1600 * (random_uniform(seed, 3, 0, n) - 0.5), true};
    place[(*places)++] = (CoastPlace){-60, 700, false}; /* a lorry on the quay, 2 m above the water */
    count = add(fix, count, 41, -60, 700, 2);
    place[(*places)++] = (CoastPlace){-20, 700, true};
    return count;
}

static void a_coast_keeps_everybody_on_his_side(void **state)
{
    (void)state;
    static GroundFix  fix[100];
    static CoastPlace place[100];
    for (uint64_t seed = 1; seed <= 2; seed++) {
        int                     places;
        const int               fixes = make_coast(fix, place, &places, seed);
        const LocalFrame        frame = frame_at(36, -5);
        LandscapeConfig         config = small_config();
        const LandscapeEvidence said = {.fix = fix, .fix_count = fixes, .place = place, .place_count = places};
        Landscape               land, again;
        config.seed = seed;
        CHECK(landscape_create_from(&land, &config, &frame, &said) == STATUS_OK);
        CHECK(land.fixes_dropped <= 20); /* 48 m steps between neighbours are cliffs that some do not survive */
        CHECK_NEAR(land.fit_worst_m, 0, 0.05);
        for (int n = 0; n < places; n++)
            for (int k = 0; k < 9; k++) { /* and a few metres about it */
                const double x = place[n].x_m + 3 * (k % 3 - 1), y = place[n].y_m + 3 * (k / 3 - 1);
                CHECK((landscape_surface(&land, x, y) == SURFACE_WATER) == place[n].sea);
                if (place[n].sea) CHECK_NEAR(h_of(&land, x, y), 0, land.elevation.level[0].step_m + 2e-3);
            }
        /* transects: at sea flat, on the shore at its level, nowhere a step */
        int shores = 0;
        for (int n = 0; n < 40; n++) {
            const double y = -1400 + 70 * n;
            bool         was_water = false;
            double       last_m = 0;
            for (double x = -1400; x <= 1400; x += 0.5) {
                const double h = h_of(&land, x, y);
                /* fresh water is none of the sea's: ponds lie higher, streams come down to it */
                WayPlace   way;
                const bool wet = landscape_surface(&land, x, y) == SURFACE_WATER && h < 2;
                const bool water = wet && !(landscape_way(&way, &land, x, y) && way.kind == WAY_STREAM);
                if (x > -1400) CHECK_NEAR(h, last_m, 0.5 * 1.2 + 0.01); /* 50 degrees in the cliffs, no more */
                if (x > -1400 && water != was_water) {
                    CHECK_NEAR(h, 0, 0.35);
                    shores++;
                }
                was_water = water, last_m = h;
            }
        }
        CHECK(shores >= 40);
        CHECK(landscape_create_from(&again, &config, &frame, &said) == STATUS_OK);
        for (int k = 0; k < 4; k++) {
            const ElevationLevel *p = &land.elevation.level[k], *q = &again.elevation.level[k];
            CHECK(memcmp(p->stored, q->stored, elevation_level_stored(p) * sizeof *p->stored) == 0);
        }
        landscape_destroy(&again);
        landscape_destroy(&land);
    }
}

/* The quick answer of the grids and the slow one are the same; many at once as one by one. */
static void the_shore_is_one_line(void **state)
{
    (void)state;
    static GroundFix        fix[100];
    static CoastPlace       place[100];
    int                     places;
    const int               fixes = make_coast(fix, place, &places, 9);
    const LocalFrame        frame = frame_at(36, -5);
    LandscapeConfig         config = small_config();
    const LandscapeEvidence said = {.fix = fix, .fix_count = fixes, .place = place, .place_count = places};
    enum { many = 8000 };
    static double  x[many], y[many];
    static uint8_t surface[many];
    for (config.seed = 1; config.seed <= 6; config.seed++) {
        Landscape land;
        int       water = 0, dry = 0, fresh = 0; /* places beyond doubt on land; of them with a stream or a pond */
        CHECK(landscape_create_from(&land, &config, &frame, &said) == STATUS_OK);
        for (int n = 0; n < many; n++) {
            const double reach_m = n & 1 ? 2000 : 60000;
            x[n] = reach_m * (random_uniform(3, 0, 0, n) - 0.5), y[n] = reach_m * (random_uniform(3, 1, 0, n) - 0.5);
        }
        landscape_surfaces(surface, &land, many, x, y);
        for (int n = 0; n < many; n++) {
            CHECK(surface[n] == landscape_surface(&land, x[n], y[n]));
            water += surface[n] == SURFACE_WATER;
            double to[2] = {INFINITY, INFINITY}; /* land, sea; the shore wanders by 0.3 of the nearer, 400 m at most */
            for (int k = 0; k < places; k++)
                to[place[k].sea] = fmin(to[place[k].sea], hypot(place[k].x_m - x[n], place[k].y_m - y[n]));
            const double off_m = to[1] - to[0], room_m = fmin(0.3 * fmin(to[0], to[1]), 400) + 1e-6;
            dry += off_m > room_m;
            fresh += off_m > room_m && surface[n] == SURFACE_WATER;
            if (off_m < -room_m) CHECK(surface[n] == SURFACE_WATER);
        }
        CHECK(fresh <= dry / 50);
        CHECK(water > many / 5 && water < 4 * many / 5);
        landscape_destroy(&land);
    }
}

static void odd_evidence_is_survived(void **state)
{
    (void)state;
    const LocalFrame      frame = frame_at(36, -5);
    const LandscapeConfig config = small_config();
    const CoastPlace place[] = {{NAN, 0, true}, {0, INFINITY, false}, {1e300, 0, true}, {5, 5, true}, {5, 5, false}};
    Landscape        land;
    for (int n = 1; n <= 5; n++) {
        const LandscapeEvidence said = {.place = place, .place_count = n};
        CHECK(landscape_create_from(&land, &config, &frame, &said) == STATUS_OK);
        CHECK((landscape_surface(&land, 300, 20) == SURFACE_WATER) == (n == 4));
        landscape_destroy(&land);
    }
    CHECK(landscape_create_from(&land, &config, &frame,
                                &(LandscapeEvidence){.place = place, .place_count = 4, .sea_h_m = NAN}) ==
          STATUS_BAD_VALUE);
    CHECK(landscape_create_from(&land, &config, &frame, &(LandscapeEvidence){.place_count = -1}) == STATUS_BAD_VALUE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_does_not_outvote_four),
        cmocka_unit_test(true_hills_are_believed),
        cmocka_unit_test(lies_are_told_from_country),
        cmocka_unit_test(places_are_held_against_their_neighbours_plane),
        cmocka_unit_test(ships_alone_have_sea_to_the_horizon),
        cmocka_unit_test(a_coast_keeps_everybody_on_his_side),
        cmocka_unit_test(the_shore_is_one_line),
        cmocka_unit_test(odd_evidence_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
