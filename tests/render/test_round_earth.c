/* The Earth beyond the terrain's outline, 420 km from its origin: no seam in a sea's light there, hits on the
 * ellipsoid, the dip, and what is behind it or before it. labels: physics */
#include "tests/render/hand_world.h"

static const double earth_m = 6371e3, outline_m = 420e3;

/* hand_open's models on an open sea, out to 420 km; air of 36 degrees of sun. */
static int open_ocean(void **state)
{
    (void)state;
    char              path[text_file_size];
    LocalFrame        frame;
    LandscapeConfig   config = landscape_default_config();
    const CoastPlace  ship = {0, 0, true};
    LandscapeEvidence evidence = {.place_count = 1, .place = &ship};
    Model             model;
    text_file(path, "type,model,origin\n1,tank,base\n");
    if (catalog_open(&hand.catalog, path, 0.01) != STATUS_OK) return -1;
    remove(path);
    hand_box(&model, (const double[3]){-500, -500, -500}, (const double[3]){500, 500, 500});
    hand.model[0] = hand_replace(1, &model);
    config.half_width_m = 500;
    if (local_frame_at(&frame, &(Geodetic){0.6, -1.9, 0}) != STATUS_OK) return -1;
    if (landscape_create_from(&hand.landscape, &config, &frame, &evidence) != STATUS_OK) return -1;
    if (world_open(&hand.world, hand.catalog, &hand.landscape, &frame, "avx2") != STATUS_OK) return -1;
    hand.arena = arena_create(), hand.air_arena = arena_create();
    return atmosphere_open(&hand.world.atmosphere, "us1976") == STATUS_OK && pool_create(&hand.pool, 2) == STATUS_OK
               ? 0
               : -1;
}

static const Visibility *see(double eye_m, bool bent) { return hand_see(eye_m, bent, 0); }

/* Traces one ray to the north-east of east_rad from north, dip_rad below the horizontal. */
static const Hits *look(const Visibility *v, double eye_m, double east_rad, double dip_rad, bool bent)
{
    const double d_enu[3] = {cos(dip_rad) * sin(east_rad), cos(dip_rad) * cos(east_rad), -sin(dip_rad)};
    return hand_look(v, eye_m, d_enu, bent);
}

/* The dip of a sphere is acos(R / (R + h)): 10.05 degrees from 99 km, as the Earth's radius is 6357 to 6385 km there
 * 0.01 more or less. A ray that bends by b d^2 is straight over an Earth of the curvature 1 / R - 2 b. */
static void the_dip_is_that_of_the_earth(void **state)
{
    (void)state;
    const double high_m[] = {20e3, 50e3, 99e3};
    for (int n = 0; n < 6; n++) {
        const double eye_m = high_m[n / 2],
                     bend = world_bend(&hand.world, REFRACTION_OPTICAL, (const double[3]){0, 0, eye_m});
        const bool        bent = n & 1;
        const double      radius_m = bent ? 1 / (1 / earth_m - 2 * bend) : earth_m;
        const Visibility *v = see(eye_m, bent);
        double            low = 0, high = 0.3;
        for (int k = 0; k < 40; k++) {
            const double middle = 0.5 * (low + high);
            if (look(v, eye_m, 1, middle, bent)->kind[0] == hit_ground) high = middle;
            else low = middle;
        }
        CHECK_NEAR(low, acos(radius_m / (radius_m + eye_m)), 0.003 * low);
    }
}

/* Hits beyond the outline are the sea's: of water, at height 0, with the ellipsoid's normal. */
static void the_sea_goes_on(void **state)
{
    (void)state;
    const double eye_m = 99e3;
    int          beyond = 0;
    for (int bent = 0; bent < 2; bent++) {
        const Visibility *v = see(eye_m, bent);
        for (int n = 0; n < 200; n++) {
            const Hits  *hits = look(v, eye_m, 0.03 * n, (10.3 + 0.03 * n) * rad_per_deg, bent);
            const double p_enu[3] = {hits->p_enu[0][0], hits->p_enu[1][0], hits->p_enu[2][0]};
            double       p_ecef[3], r[9], up[3];
            Geodetic     at;
            CHECK(hits->kind[0] == hit_ground && hits->surface[0] == SURFACE_WATER);
            CHECK(hits->material[0] == look(v, eye_m, 0, 1, bent)->material[0]);
            hits = look(v, eye_m, 0.03 * n, (10.3 + 0.03 * n) * rad_per_deg, bent);
            if (fmax(fabs(p_enu[0]), fabs(p_enu[1])) < outline_m + 10e3) continue;
            beyond++;
            ecef_from_enu(p_ecef, &hand.world.frame, p_enu);
            assert_int_equal(geodetic_from_ecef(&at, p_ecef), STATUS_OK);
            CHECK_NEAR(at.h_m, 0, 30); /* the outline's chords of some km lie lower */
            assert_int_equal(ecef_from_geodetic(p_ecef, r, &at), STATUS_OK);
            m3_tmul_v3(up, hand.world.frame.r_ecef_from_enu, (const double[3]){r[2], r[5], r[8]});
            for (int k = 0; k < 3; k++) CHECK_NEAR(hits->n_geo[k][0], up[k], 1e-5);
        }
    }
    CHECK(beyond > 100);
}

/* Without a sea the land goes on: with the classes within the outline, in like shares, and no water where it has none.
 */
static void the_land_goes_on(void **state)
{
    (void)state;
    const double    eye_m = 99e3;
    const Landscape sea = hand.landscape;
    LandscapeConfig config = sea.config;
    int             inside[256] = {0}, beyond[256] = {0};
    assert_int_equal(landscape_create(&hand.landscape, &config, &sea.frame, NULL, 0, NULL, 0), STATUS_OK);
    const Visibility *v = see(eye_m, true);
    for (int n = 0; n < 4000; n++) {
        const double dip_deg = n % 2 ? 15.2 : 13;
        const Hits  *hits = look(v, eye_m, 0.1 * n, dip_deg * rad_per_deg, true);
        const bool   out = fmax(fabs(hits->p_enu[0][0]), fabs(hits->p_enu[1][0])) > outline_m;
        CHECK(hits->kind[0] == hit_ground);
        (out ? beyond : inside)[hits->surface[0]]++;
    }
    CHECK(beyond[SURFACE_NONE] == 0 && beyond[SURFACE_WATER] == 0 && beyond[SURFACE_CROP] > 100);
    /* shares of some 2000 draws each: within five standard deviations of 0.011 */
    double ins = 0, bey = 0;
    for (int k = 0; k < SURFACE_COUNT; k++) ins += inside[k], bey += beyond[k];
    CHECK(bey > 1000 && ins > 1000);
    for (int k = 0; k < SURFACE_COUNT; k++) CHECK_NEAR(beyond[k] / bey, inside[k] / ins, 0.055);
    landscape_destroy(&hand.landscape);
    hand.landscape = sea;
}

/* Over sea the light on both sides of the outline is the same: less than 0.5 % in 0.02 degrees. */
static void no_seam(void **state)
{
    (void)state;
    const double sun[3] = {-0.8, 0.1, 0.59}, high_m[] = {50e3, 99e3};
    const int    plane[] = {0, picture_mwir, picture_lwir};
    for (int n = 0; n < 2; n++) {
        const double eye_m = high_m[n], fall_m = eye_m + outline_m * outline_m / (2 * earth_m);
        const View   view =
            hand_view((const double[3]){0, 0, eye_m}, (const double[3]){0, outline_m, -fall_m}, 8, 64, 20000);
        RenderRequest request = hand_request(&view);
        int           seam = 0;
        hand_clear();
        hand_air_on(sun, eye_m);
        arena_reset(hand.arena);
        const Picture picture = hand_render(&request, hand.pool);
        for (int y = 1; y + 1 < view.height; y++) {
            const int at = y * view.width + 4;
            CHECK((double)picture.range_m[at] > 0 && (double)picture.range_m[at] < 1e6);
            seam += (double)picture.range_m[at] > hypot(outline_m, fall_m) &&
                    (double)picture.range_m[at + view.width] <= hypot(outline_m, fall_m);
            for (int b = 0; b < 3; b++) {
                const double above = (double)picture_plane(&picture, plane[b])[at],
                             below = (double)picture_plane(&picture, plane[b])[at + view.width];
                CHECK_NEAR(above, below, 0.005 * below);
            }
        }
        CHECK(seam == 1); /* the picture has it */
        arena_reset(hand.air_arena);
    }
}

/* From 20 km the horizon is acos(R / (R + h)) R = 504 km away (less air). A thing 1000 km away is hidden as high as
 * (1000 - 504)^2 / 2 R = 19.3 km, with air (k near 1.1) some 16: one at 2 km is not seen, one at 30 km is; 500 km away,
 * from 14 km (422 km): 0.5 km. From 99 km both are before the Earth. */
static void what_is_behind_the_earth(void **state)
{
    (void)state;
    static const double upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const struct {
        double eye_m, away_m, height_m;
        bool   seen;
    } row[] = {{20e3, 1000e3, 2e3, false}, {20e3, 1000e3, 14e3, false}, {20e3, 1000e3, 30e3, true},
               {20e3, 500e3, 2e3, true},   {99e3, 1000e3, 2e3, true},   {50e3, 1200e3, 2e3, false}};
    for (int n = 0; n < (int)(sizeof row / sizeof *row); n++) {
        const double angle = row[n].away_m / earth_m, r_m = earth_m + row[n].height_m;
        const double p[3] = {0, r_m * sin(angle), r_m * cos(angle) - earth_m};
        const double eye[3] = {0, 0, row[n].eye_m};
        double       d[3];
        hand_clear();
        hand_air_off((const double[3]){0, 0, 1});
        hand_add(0, p, upright);
        arena_reset(hand.arena);
        const Visibility *v = see(row[n].eye_m, true);
        v3_sub(d, p, eye);
        d[2] += visibility_lift(v, 0);
        const View    view = hand_view(eye, d, 40, 40, 10000);
        RenderRequest request = hand_request(&view);
        request.refraction = true;
        const Picture picture = hand_render(&request, hand.pool);
        int           pixels = 0;
        for (int k = 0; k < 40 * 40; k++) pixels += picture.entity[k] == 1;
        CHECK(picture.target[0].amodal > 10);
        CHECK(row[n].seen ? pixels > 10 : pixels == 0);
        CHECK_NEAR(picture.target[0].visible, row[n].seen ? picture.target[0].amodal : 0, 0.01);
        if (!row[n].seen) CHECK_NEAR(picture.target[0].occluded_ground, picture.target[0].amodal, 0.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_dip_is_that_of_the_earth),
        cmocka_unit_test(the_sea_goes_on),
        cmocka_unit_test(the_land_goes_on),
        cmocka_unit_test(no_seam),
        cmocka_unit_test(what_is_behind_the_earth),
    };
    return cmocka_run_group_tests(tests, open_ocean, hand_close);
}
