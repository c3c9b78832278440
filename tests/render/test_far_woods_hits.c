/* Hits in far woods: what they get of the nodes about them and of the ground between crowns (render/light/far_woods.h),
 * of stands that are made by hand. labels: physics */
#include "tests/render/far_woods_stage.h"

/* ---- nodes ------------------------------------------------------------------------------------ */

typedef int PlaceAt(double *share, double rad);

/* Each node is its own place, with none of the next one's share but at the end; halfway between two is half of each. */
static void between_nodes(PlaceAt *place, const double *deg, int count)
{
    double share;
    for (int k = 0; k < count; k++) {
        const int at = place(&share, deg[k] * rad_per_deg);
        CHECK_NEAR(at + share, k, 1e-9);
        CHECK(at >= 0 && at <= count - 2);
        if (k == count - 1) continue;
        CHECK(place(&share, (0.75 * deg[k] + 0.25 * deg[k + 1]) * rad_per_deg) == k);
        CHECK_NEAR(share, 0.25, 1e-9);
    }
    CHECK(place(&share, (deg[0] - 1) * rad_per_deg) == 0 && share == 0);
    CHECK(place(&share, (deg[count - 1] + 1) * rad_per_deg) == count - 2 && share == 1);
}

static void places_among_nodes(void **state)
{
    (void)state;
    between_nodes(far_stand_at_view, view_deg, stand_views);
    between_nodes(far_stand_at_sun, sun_deg, stand_suns);
    between_nodes(far_stand_at_azimuth, azimuth_deg, stand_azimuths);
    for (int k = 0; k < stand_azimuths; k++) CHECK_NEAR(far_stand_azimuth(k), azimuth_deg[k] * pi_rad / 180, 1e-12);
}

/* ---- hits ------------------------------------------------------------------------------------- */

enum { hits_count = 400 };

static Hits      hits;
static Rays      rays;
static FarPlaces places;
static float     sun[hits_capacity], texture[optical_channel_count][hits_capacity], far_sun[hits_capacity],
    radar[hits_capacity], warmer_k[hits_capacity], of_far[hits_capacity];
static uint16_t material[hits_capacity];

/* Eyes at every height and azimuth about ground that is nearly level. */
static void random_hits(void)
{
    hits.count = rays.count = hits_count;
    for (int i = 0; i < hits_count; i++) {
        const double e = draw(2, 90) * rad_per_deg, a = draw(-180, 180) * rad_per_deg, lean = draw(0, 0.1),
                     turn = draw(0, 6);
        const double n[3] = {sin(lean) * cos(turn), sin(lean) * sin(turn), cos(lean)},
                     d[3] = {-cos(e) * cos(a), -cos(e) * sin(a), -sin(e)};
        for (int c = 0; c < 3; c++) hits.n_geo[c][i] = hits.n_enu[c][i] = (float)n[c], rays.d_enu[c][i] = d[c];
        places.stand[i] = (uint8_t)(i % 3);
        places.cover[i] = i % 5 == 0 ? (float)draw(0, 1) : -1, places.density[i] = (float)draw(0, 1.6);
        hits.surface[i] = i % 7 == 0 ? SURFACE_SCRUB : i % 3 == 2 ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF;
        hits.material[i] = i % 7 == 0 ? row_scrub : row_ground;
        material[i] = hits.material[i];
        sun[i] = i % 4 == 0 ? 0 : i % 4 == 1 ? 1 : (float)draw(0, 1), far_sun[i] = sun[i];
        for (int c = 0; c < optical_channel_count; c++) texture[c][i] = (float)draw(0.8, 1.2);
        radar[i] = (float)draw(0.8, 1.2), warmer_k[i] = -99;
    }
}

static int node_below(double *share, const double *deg, int count, double at)
{
    int k = count - 2;
    at = fmin(fmax(at, deg[0]), deg[count - 1]);
    while (at < deg[k]) k--;
    *share = (at - deg[k]) / (deg[k + 1] - deg[k]);
    return k;
}

/* Of the four nodes about it, of both densities. */
#define LOOK(member)                                                                                                   \
    ((1 - dense) * ((1 - u) * ((1 - w) * at[0][v][a].member + w * at[0][v][a + 1].member) +                            \
                    u * ((1 - w) * at[0][v + 1][a].member + w * at[0][v + 1][a + 1].member)) +                         \
     dense * ((1 - u) * ((1 - w) * at[1][v][a].member + w * at[1][v][a + 1].member) +                                  \
              u * ((1 - w) * at[1][v + 1][a].member + w * at[1][v + 1][a + 1].member)))

static void hit_is_as_on_paper(int i, const FarWoodsFrame *f, const float before[optical_channel_count],
                               double radar_before)
{
    const int k = places.stand[i] - 1, g = hits.surface[i] == SURFACE_SCRUB;
    double    u, w, to_eye = 0, share, dense;
    for (int c = 0; c < 3; c++) to_eye -= (double)hits.n_geo[c][i] * rays.d_enu[c][i];
    const double from_sun_deg =
        acos(fmin(fmax(-(rays.d_enu[0][i] * air.light.sun_d_enu[0] + rays.d_enu[1][i] * air.light.sun_d_enu[1]) /
                           hypot(rays.d_enu[0][i], rays.d_enu[1][i]) /
                           hypot(air.light.sun_d_enu[0], air.light.sun_d_enu[1]),
                       -1),
                  1)) /
        rad_per_deg;
    const int v = node_below(&u, view_deg, stand_views, asin(fmin(fmax(to_eye, 0), 1)) / rad_per_deg),
              a = node_below(&w, azimuth_deg, stand_azimuths, from_sun_deg);
    /* Gaps of woods of this density over the mean: exp(-2.5 density / sine), of eyes no lower than a sine of 0.2; the
     * stands are of 0.4 and 1.2. A canopy layer says the share itself, of which a stand that is seen from above hides
     * 1 - ground, taken for no less than a tenth. */
    const double per = 2.5 / fmax(to_eye, 0.2), density = (double)places.density[i], cover = (double)places.cover[i];
    const double sparse = 1 - exp(-0.4 * per), thick = 1 - exp(-1.2 * per), here = 1 - exp(-density * per);
    share = cover >= 0 ? cover / (fmax(1 - stand[k][1].view[stand_views - 1].ground, 0.1)) : here / sparse;
    dense = cover >= 0 ? 1 : (here - sparse) / (thick - sparse);
    share = fmin(fmax(share, 0), 1), dense = fmin(fmax(dense, 0), 1);
    const FarNode(*at[2])[stand_azimuths] = {f->node[k][0][g], f->node[k][1][g]};
    const Material *row = &rows[row_canopy + k], *own = &rows[g ? row_scrub : row_ground];
    const double    lit = (double)sun[i], seen_sun = LOOK(sun);
    CHECK(material[i] == row_canopy + k);
    CHECK_NEAR(of_far[i], share, 1e-5);
    CHECK_NEAR(far_sun[i], lit * seen_sun, 1e-4);
    CHECK_NEAR(warmer_k[i], (1 - lit) * LOOK(warmer_k[0]) + lit * LOOK(warmer_k[1]), 2e-4);
    CHECK_NEAR(radar[i], radar_before * (share * LOOK(radar) / (double)own->radar_gamma + 1 - share), 1e-4);
    for (int c = 0; c < optical_channel_count; c++) {
        /* what canopy and open ground between return, over what the row would of sky and its share of sun */
        const double canopy = (1 - lit) * LOOK(reflects[0][c]) + lit * LOOK(reflects[1][c]), sky = f->sky_w_m2[c],
                     direct = f->sun_w_m2[c] * lit;
        const double open = (double)own->rho[c] / (double)row->rho[c] * (sky + direct) / (sky + direct * seen_sun);
        CHECK_NEAR(texture[c][i], (double)before[c] * (share * canopy + (1 - share) * open), 2e-4);
    }
}

static void hits_are_between_nodes(void **state)
{
    (void)state;
    FarWoodsFrame *frame = NULL;
    static float   before[hits_count][optical_channel_count], radar_before[hits_count];
    FarInputs      in = {.places = &places,
                         .sun = sun,
                         .material = material,
                         .far_sun = far_sun,
                         .radar = radar,
                         .warmer_k = warmer_k,
                         .of_far = of_far};
    set_air(33, 50, true);
    assert_int_equal(far_woods_frame(&frame, &far, &air, &materials, arena), STATUS_OK);
    random_hits();
    for (int i = 0; i < hits_count; i++) {
        radar_before[i] = radar[i];
        for (int c = 0; c < optical_channel_count; c++) before[i][c] = texture[c][i];
    }
    for (int c = 0; c < optical_channel_count; c++) in.texture[c] = texture[c];
    far_woods_apply(&in, frame, &materials, &hits, &rays);
    for (int i = 0; i < hits_count; i++) {
        if (places.stand[i] > 0) {
            hit_is_as_on_paper(i, frame, before[i], (double)radar_before[i]);
            continue;
        }
        CHECK(of_far[i] == 0 && material[i] == hits.material[i] && far_sun[i] == sun[i] && radar[i] == radar_before[i]);
        for (int c = 0; c < optical_channel_count; c++) CHECK(texture[c][i] == before[i][c]);
    }
    /* channels that are not asked for, and ground that returns no radar */
    for (int c = 0; c < optical_channel_count; c++) in.texture[c] = NULL;
    rows[row_ground].radar_gamma = 0;
    random_hits();
    for (int i = 0; i < hits_count; i++) radar_before[i] = radar[i];
    far_woods_apply(&in, frame, &materials, &hits, &rays);
    for (int i = 0; i < hits_count; i++) CHECK(hits.material[i] == row_scrub || radar[i] == radar_before[i]);
    CHECK(far_woods_top_m(&far, 0) == stand[0][1].top_m && far_woods_top_m(&far, 1) == stand[1][1].top_m);
    arena_reset(arena);
}

/* Ground of forest where nothing was planted is that of its class; parts, plants and other ground are none. Woods of
 * which trees stand nowhere, on level land of three classes. */
static void only_ground_is_found(void **state)
{
    (void)state;
    LandscapeConfig   config = landscape_default_config();
    const WoodsConfig bare = {.seed = 5, .half_width_m = 200, .most_trees = 0};
    const Geodetic    origin = {0.9, 0.2, 100};
    LocalFrame        frame;
    Landscape         land;
    Woods             woods;
    FarWoods          of_land = far;
    static FarPlaces  found;
    config.half_width_m = 400, config.horizon_m = 1000;
    assert_int_equal(local_frame_at(&frame, &origin), STATUS_OK);
    assert_int_equal(landscape_create(&land, &config, &frame, NULL, 0, NULL, 0), STATUS_OK);
    assert_int_equal(woods_create(&woods, &land, &bare, NULL), STATUS_OK);
    of_land.woods = &woods;
    memset(&hits, 0, sizeof hits);
    hits.count = 6;
    static const uint8_t kind[6] = {hit_ground, hit_ground, hit_part, hit_plant, hit_ground, hit_ground},
                         surface[6] = {SURFACE_FOREST_BROADLEAF, SURFACE_FOREST_CONIFER, SURFACE_FOREST_CONIFER,
                                       SURFACE_FOREST_BROADLEAF, SURFACE_ROAD,           SURFACE_GRASS};
    for (int i = 0; i < 6; i++) {
        hits.kind[i] = kind[i], hits.surface[i] = surface[i], hits.range_m[i] = 10;
        hits.p_enu[0][i] = 5000 + i, hits.p_enu[1][i] = 5000; /* beyond what is planted */
    }
    CHECK(far_woods_find(&found, &of_land, NULL, &hits));
    CHECK(found.stand[0] == 1 && found.stand[1] == 2 && !found.stand[2] && !found.stand[3] && !found.stand[4] &&
          !found.stand[5]);
    hits.kind[0] = hits.kind[1] = hit_part;
    CHECK(!far_woods_find(&found, &of_land, NULL, &hits) && !found.stand[0]);
    woods_destroy(&woods);
    landscape_destroy(&land);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_among_nodes),
        cmocka_unit_test(hits_are_between_nodes),
        cmocka_unit_test(only_ground_is_found),
    };
    return cmocka_run_group_tests(tests, open_stands, close_stands);
}
