/* Woods whose plants were left out, beside the same woods planted and traced: means over a wide box, at every height of
 * eye and sun. labels: physics slow */
#include "tests/check.h"

#include "render/frame/world.h"
#include "tests/render/shade_list.h"
#include "terrain/store/store.h"

#include <unistd.h>

enum { posts = 129, cells = 64, rays = 3000, shown_bands = AIR_BAND_COUNT };

static const double   half_ground_m = 1024, half_woods_m = 900, half_box_m = 600;
static const Geodetic origin = {50 * rad_per_deg, 8 * rad_per_deg, 0};

typedef struct Place {
    Landscape    landscape;
    Catalog     *catalog;
    Woods        woods, bare;
    World        planted, left_out;
    SurfaceClass surface;
    FarWoods     far; /* of the bare woods */
    Pool        *pool;
    Arena       *arena, *frame_arena;
} Place;
static Place place;

/* Level ground of one class of forest. */
static bool write_ground(const char *path, SurfaceClass surface)
{
    static float   z[posts * posts];
    static uint8_t classes[cells * cells];
    const double   posting_m = 2 * half_ground_m / (posts - 1), cell_m = 2 * half_ground_m / cells;
    StorePlan      plan = {.origin = origin,
                           .level_count = 1,
                           .posting_m = posting_m,
                           .seed = 3,
                           .options = "",
                           .crs = "",
                           .vertical_datum = "",
                           .provenance = "made by a test"};
    StoreWriter   *writer;
    StoreReport    report;
    plan.level[0] = (StoreLevel){posts, posts, -half_ground_m, -half_ground_m, posting_m, 0, 0, -1};
    plan.surface[0] = (StoreGrid){cells, cells, -half_ground_m, -half_ground_m, cell_m};
    memset(classes, (int)surface, sizeof classes);
    return store_writer_create(&writer, path, &plan, NULL) == STATUS_OK &&
           store_write_posts(writer, 0, posts, z) == STATUS_OK &&
           store_write_surface(writer, 0, cells, classes) == STATUS_OK &&
           store_writer_finish(writer, 0, &report) == STATUS_OK;
}

static Status plant(bool leaves)
{
    WoodsConfig        config = {.seed = 5, .half_width_m = half_woods_m, .most_trees = woods_most_trees};
    const ForestConfig forest = {.leaves = leaves, .level1_px = 24};
    Status             status = woods_create(&place.woods, &place.landscape, &config, place.pool);
    config.most_trees = 0;
    if (status == STATUS_OK) status = woods_create(&place.bare, &place.landscape, &config, place.pool);
    return status == STATUS_OK ? world_plant(&place.planted, &place.woods, &forest, "avx2", place.pool) : status;
}

static Status warm(double unix_s)
{
    HeatConfig heat = heat_default_config();
    heat.unix_s = unix_s, heat.step_s = 900, heat.facets = 5;
    return world_warm_clear(&place.planted, &heat, 16, place.pool);
}

/* The one in which nothing stands shares all else: its ground's heat still knows the trees, which nothing of it shows.
 */
static void open_place(SurfaceClass surface, bool leaves)
{
    char   path[64], catalog[512];
    double unix_s;
    place = (Place){.surface = surface};
    snprintf(path, sizeof path, "/tmp/test_far_woods_%ld.store", (long)getpid());
    assert_true(write_ground(path, surface));
    assert_int_equal(store_open_landscape(&place.landscape, path, 3), STATUS_OK);
    unlink(path);
    assert_true(etc_path(catalog, sizeof catalog, "catalog.csv") && text_to_unix_s(&unix_s, "2026-06-21T00:00:00Z"));
    assert_int_equal(catalog_open(&place.catalog, catalog, 0.05), STATUS_OK);
    assert_true((place.arena = arena_create()) && (place.frame_arena = arena_create()));
    assert_int_equal(pool_create(&place.pool, 2), STATUS_OK);
    assert_int_equal(world_open(&place.planted, place.catalog, &place.landscape, &place.landscape.frame, "avx2"),
                     STATUS_OK);
    assert_int_equal(atmosphere_open(&place.planted.atmosphere, "us1976"), STATUS_OK);
    assert_int_equal(plant(leaves), STATUS_OK);
    assert_int_equal(warm(unix_s), STATUS_OK);
    place.left_out = place.planted;
    place.far = *place.planted.far_woods;
    place.far.woods = &place.bare;
    place.left_out.forest = NULL, place.left_out.canopy = NULL, place.left_out.far_woods = &place.far;
}

static void close_place(void)
{
    world_close(&place.planted);
    woods_destroy(&place.woods), woods_destroy(&place.bare);
    landscape_destroy(&place.landscape);
    catalog_close(place.catalog);
    pool_destroy(place.pool);
    arena_destroy(place.arena), arena_destroy(place.frame_arena);
}

/* ---- means ------------------------------------------------------------------------------------ */

static void air_then(Air *air, Sun *sun, double unix_s)
{
    const World    *w = &place.planted;
    const AirSource source = {w->atmosphere, w->planck_mwir, w->planck_lwir, 0, 0};
    const AirEye    eye = {.height_m = 100, .bands = (1 << AIR_BAND_COUNT) - 1};
    Weather         weather;
    HeatScene      *heat;
    weather_at(&weather, w->course, unix_s);
    assert_int_equal(sun_at(sun, unix_s, &origin, 1013, 15, NAN), STATUS_OK);
    assert_int_equal(world_heat_at(&heat, w, NULL, unix_s, place.frame_arena), STATUS_OK);
    assert_int_equal(air_at(air, &source, &weather, sun, &eye, NULL, place.frame_arena), STATUS_OK);
    air->heat = heat;
}

/* Mean radiance of the box, of rays that come down at this angle from this azimuth, from east to north. */
static void mean_of(double out[shown_bands], const World *world, const Air *air, double down_rad, double azimuth_rad,
                    double above_m)
{
    static Shader  shader;
    static double  o[3][rays], d[3][rays];
    static Samples block;
    const double   to_eye[3] = {cos(down_rad) * cos(azimuth_rad), cos(down_rad) * sin(azimuth_rad), sin(down_rad)};
    const double   from_m = above_m / sin(down_rad);
    Snapshot       nobody = {0};
    RenderRequest  request = {
         .view = {.width = 8, .height = 8, .focal_px = 200, .r_enu_from_cam = {1, 0, 0, 0, -1, 0, 0, 0, -1}},
         .samples = 1,
         .hidden_entity = -1};
    ShadedRays shaded;
    ShadeScene scene = {.world = world, .snapshot = &nobody, .air = air};
    for (int c = 0; c < 3; c++) request.view.p_enu[c] = 1000 * to_eye[c];
    assert_int_equal(shade_scene_create(&scene, &request, (1u << AIR_BAND_COUNT) - 1, NULL, place.arena), STATUS_OK);
    assert_int_equal(shade_samples_create(&block, hits_capacity, place.arena), STATUS_OK);
    assert_int_equal(shaded_rays_create(&shaded, rays, place.arena), STATUS_OK);
    for (int i = 0; i < rays; i++)
        for (int c = 0; c < 3; c++) {
            const double at_m = c < 2 ? half_box_m * (2 * random_uniform(8, (uint32_t)c, 0, (uint64_t)i) - 1) : 0;
            d[c][i] = -to_eye[c], o[c][i] = at_m + from_m * to_eye[c];
        }
    const RayList list = {.count = rays,
                          .o_enu = {o[0], o[1], o[2]},
                          .d_enu = {d[0], d[1], d[2]},
                          .per_rad = 200,
                          .channels = (1u << AIR_BAND_COUNT) - 1,
                          .temperature = true};
    shade_list(&shaded, &list, &shader, &scene, &block);
    for (int b = 0; b < shown_bands; b++) {
        double sum = 0;
        for (int i = 0; i < rays; i++) sum += (double)shaded.radiance[b][i];
        out[b] = sum / rays;
    }
    shade_scene_close(&scene);
    arena_reset(place.arena);
}

static double apparent_k(AirBand b, double radiance)
{
    return planck_table_temp(b == AIR_MWIR ? place.planted.planck_mwir : place.planted.planck_lwir, radiance);
}

/* Relative errors of the optical channels, kelvins of apparent temperature. */
typedef struct Errors {
    int    cases;
    double square[optical_channel_count], worst[optical_channel_count], at_hot_spot, kelvin[2];
} Errors;

static void compare(Errors *e, const World *other, const Air *air, const Sun *sun, double down_deg, double from_sun_deg)
{
    static const double above_m = 40, hot_spot_deg = 12;
    double              stands[shown_bands], shows[shown_bands];
    const double        azimuth_rad = atan2(sun->d_enu[1], sun->d_enu[0]) + from_sun_deg * rad_per_deg;
    const double        sun_deg = sun->elevation_rad / rad_per_deg;
    /* of both through as much air */
    mean_of(stands, &place.planted, air, down_deg * rad_per_deg, azimuth_rad, above_m);
    mean_of(shows, other, air, down_deg * rad_per_deg, azimuth_rad,
            above_m - far_woods_top_m(&place.far, place.surface == SURFACE_FOREST_CONIFER));
    char text[200];
    int  n = snprintf(text, sizeof text, "sun %5.1f eye %2.0f from %3.0f:", sun_deg, down_deg, from_sun_deg);
    for (int c = 0; c < optical_channel_count && sun_deg > 0; c++) {
        const double off = shows[c] / stands[c] - 1;
        double *worst = from_sun_deg == 0 && fabs(sun_deg - down_deg) < hot_spot_deg ? &e->at_hot_spot : &e->worst[c];
        *worst = fmax(*worst, fabs(off));
        e->square[c] += off * off;
        n += snprintf(text + n, sizeof text - (size_t)n, " %+5.1f %%", 100 * off);
    }
    e->cases += sun_deg > 0;
    for (int k = 0; k < 2; k++) {
        const AirBand b = (AirBand)(AIR_MWIR + k);
        const double  off_k = apparent_k(b, shows[b]) - apparent_k(b, stands[b]);
        e->kelvin[k] = fmax(e->kelvin[k], fabs(off_k));
        n += snprintf(text + n, sizeof text - (size_t)n, " %+5.2f K", off_k);
    }
    print_message("%s\n", text);
}

static Errors compare_hours(const World *other, int first, int last)
{
    static const double hours[] = {4.5, 8, 11.5, 23}, down_deg[] = {15, 30, 60}, from_sun_deg[] = {0, 70, 120, 180};
    Errors              e = {0};
    double              midnight_s;
    assert_true(text_to_unix_s(&midnight_s, "2026-06-21T00:00:00Z"));
    for (int h = first; h <= last; h++) {
        static Air air;
        Sun        sun;
        arena_reset(place.frame_arena);
        air_then(&air, &sun, midnight_s + 3600 * hours[h]);
        for (int v = 0; v < 3; v++)
            for (int a = 0; a < (sun.elevation_rad > 0 ? 4 : 1); a++)
                compare(&e, other, &air, &sun, down_deg[v], from_sun_deg[a]);
    }
    for (int c = 0; c < optical_channel_count; c++)
        print_message("channel %d: rms %.3f worst %.3f\n", c, sqrt(e.square[c] / e.cases), e.worst[c]);
    print_message("hot spot: %.3f; MWIR %.2f K LWIR %.2f K\n", e.at_hot_spot, e.kelvin[0], e.kelvin[1]);
    return e;
}

static Errors compare_all(const World *other) { return compare_hours(other, 0, 3); }

/* The bounds are those of far_woods.h. */
static bool looks_the_same(const Errors *e, double rms, double worst, double worst_nir, double mwir_k, double lwir_k)
{
    bool same = e->at_hot_spot <= 0.18 && e->kelvin[0] <= mwir_k && e->kelvin[1] <= lwir_k;
    for (int c = 0; c < optical_channel_count; c++)
        same = same && sqrt(e->square[c] / e->cases) <= (c == optical_channel_nir ? rms + 0.02 : rms) &&
               e->worst[c] <= (c == optical_channel_nir ? worst_nir : worst);
    return same;
}

/* Where plants stand nothing is taken for far woods; where they were left out, or cleared, as woods_not_standing says.
 */
static void check_places(void)
{
    static Hits      hits;
    static FarPlaces found;
    const double     x_m[4] = {0, 300, half_woods_m + 2 * woods_square_m, 0};
    hits.count = 4;
    for (int i = 0; i < 4; i++) {
        hits.kind[i] = i == 3 ? hit_part : hit_ground, hits.range_m[i] = 100;
        hits.surface[i] = i == 3 ? SURFACE_NONE : SURFACE_FOREST_BROADLEAF;
        hits.p_enu[0][i] = x_m[i], hits.p_enu[1][i] = 10;
    }
    CHECK(far_woods_find(&found, place.planted.far_woods, NULL, &hits)); /* beyond the square */
    CHECK(!found.stand[0] && !found.stand[1] && found.stand[2] == 1 && !found.stand[3]);
    CHECK(far_woods_find(&found, &place.far, NULL, &hits));
    CHECK(found.stand[0] == 1 && found.stand[1] == 1 && found.stand[2] == 1 && !found.stand[3]);
    hits.surface[0] = SURFACE_ROAD, hits.surface[1] = SURFACE_CROP, hits.surface[2] = SURFACE_GRASS;
    CHECK(!far_woods_find(&found, &place.far, NULL, &hits));
}

/* And its twin: the litter beneath the plants by itself. */
static void broadleaves_look_the_same(void **state)
{
    Errors e;
    (void)state;
    open_place(SURFACE_FOREST_BROADLEAF, true);
    check_places();
    e = compare_all(&place.left_out);
    CHECK(looks_the_same(&e, 0.08, 0.12, 0.18, 0.7, 0.6));
    place.left_out.far_woods = NULL;
    e = compare_hours(&place.left_out, 1, 1);
    CHECK(!looks_the_same(&e, 0.5, 1, 1, 1, 0.6) && sqrt(e.square[optical_channel_r] / e.cases) > 1 && e.kelvin[1] > 2);
    close_place();
}

static void conifers_look_the_same(void **state)
{
    Errors e;
    (void)state;
    open_place(SURFACE_FOREST_CONIFER, true);
    e = compare_all(&place.left_out);
    CHECK(looks_the_same(&e, 0.08, 0.12, 0.19, 0.7, 0.6));
    close_place();
}

static void bare_woods_look_the_same(void **state)
{
    Errors e;
    (void)state;
    open_place(SURFACE_FOREST_BROADLEAF, false);
    e = compare_all(&place.left_out);
    /* bark in and out of the sun differs in proportion to direct light, of which the sun of all wavelengths has 1.12
     * times what visible light over 0.44 had 63 degrees up */
    CHECK(looks_the_same(&e, 0.14, 0.23, 0.23, 2.2, 1.75));
    close_place();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(broadleaves_look_the_same),
        cmocka_unit_test(conifers_look_the_same),
        cmocka_unit_test(bare_woods_look_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
