/* Heat seen: the isothermal cavity, Kirchhoff, and temperatures that a thermometer could have read. labels: physics */
#include "tests/check.h"
#include "render/heat/heat.h"
#include "render/light/thermal.h"

static PlanckTable *mwir, *lwir;
static Atmosphere  *atmosphere;
static Arena       *arena;

typedef struct Scene {
    Hits      hits;
    Rays      rays;
    uint16_t  material[hits_capacity];
    float     texture[hits_capacity], warmth_k[hits_capacity], temp_k[hits_capacity], out[hits_capacity];
    float     sun[hits_capacity];
    Material  rows[64];
    Materials materials;
} Scene;
static Scene scene;

static int open_scene(void **state)
{
    (void)state;
    return planck_table_create(&mwir, 3.4e-6, 4.8e-6) != STATUS_OK ||
           planck_table_create(&lwir, 8e-6, 12e-6) != STATUS_OK ||
           atmosphere_open(&atmosphere, "us1976") != STATUS_OK || !(arena = arena_create());
}

static int close_scene(void **state)
{
    (void)state;
    planck_table_destroy(mwir);
    planck_table_destroy(lwir);
    atmosphere_close(atmosphere);
    arena_destroy(arena);
    return 0;
}

static void clear(void)
{
    memset(&scene, 0, sizeof scene);
    scene.materials = (Materials){.count = 64, .material = scene.rows};
}

static int add(const double d_enu[3], const double n_enu[3], double range_m, int material, double temp_k)
{
    const int i = scene.hits.count++;
    CHECK(scene.hits.count <= hits_capacity);
    scene.rays.count = scene.hits.count;
    double d[3] = {0}, n[3] = {0};
    CHECK(v3_normalize(d, d_enu));
    CHECK(v3_normalize(n, n_enu));
    for (int k = 0; k < 3; k++) {
        scene.rays.d_enu[k][i] = d[k];
        scene.hits.n_enu[k][i] = scene.hits.n_geo[k][i] = (float)n[k];
    }
    scene.hits.range_m[i] = range_m;
    scene.hits.surface[i] = SURFACE_GRASS;
    scene.material[i] = (uint16_t)material;
    scene.texture[i] = scene.sun[i] = 1;
    scene.temp_k[i] = (float)temp_k;
    return i;
}

static void shade(const Air *air, Band band)
{
    thermal_shade(scene.out, band, air, &scene.materials, &scene.hits, &scene.rays, scene.material, scene.temp_k,
                  scene.sun, NULL, NULL, NULL, NULL);
}

static Air air_when(const Weather *weather, double elevation_deg)
{
    const double    e = elevation_deg * rad_per_deg;
    const Sun       sun = {.elevation_rad = e, .azimuth_rad = pi_rad, .distance_au = 1, .d_enu = {0, -cos(e), sin(e)}};
    const AirSource source = {atmosphere, mwir, lwir, 0, 0};
    Air             air;
    arena_reset(arena);
    const AirEye eye = {2, 1 << AIR_MWIR | 1 << AIR_LWIR, NULL};
    CHECK(air_at(&air, &source, weather, &sun, &eye, NULL, arena) == STATUS_OK);
    return air;
}

/* Sky, ground, air and walls at one temperature, no sun: every pixel of every material, at any distance and angle,
 * glossy or not, reads Planck(T). */
static void isothermal_cavity(void **state)
{
    (void)state;
    static const double temps_k[] = {210, 288.15, 400, 900};
    for (int t = 0; t < 4; t++) {
        const double temp_k = (float)temps_k[t];
        const double want_mwir = planck_table_radiance(mwir, temp_k), want_lwir = planck_table_radiance(lwir, temp_k);
        const double even[AIR_BAND_COUNT] = {[AIR_MWIR] = want_mwir, [AIR_LWIR] = want_lwir};
        Air          air; /* of its temperature too, or none at all */
        air_even(&air, (const double[3]){0, 0.6, -0.8}, 0, even, t % 2 ? 1e-4 : 0, mwir, lwir);
        clear();
        for (int m = 0; m < 64; m++) {
            scene.rows[m] = (Material){.rho_mwir = (float)(m % 4) / 3,
                                       .rho_lwir = (float)(m / 4 % 4) / 3,
                                       .gloss = (float)(m / 16) / 3,
                                       .roughness = 0.05f * (float)(m % 7)};
            for (int a = 0; a < 12; a++) {
                const double n_tilt = a * 0.26, view = 1.5 * sin(a * 2.1 + m);
                const double n[3] = {sin(n_tilt), 0, cos(n_tilt)};
                const double d[3] = {-sin(n_tilt + view), 0, -cos(n_tilt + view)};
                add(d, n, pow(10, a * 0.4), m, temp_k);
            }
        }
        for (int a = 0; a < 8; a++) add((double[3]){1, 0, a * 0.3 - 0.7}, (double[3]){0, 0, 1}, INFINITY, 0, NAN);
        shade(&air, BAND_MWIR);
        for (int i = 0; i < scene.hits.count; i++) CHECK_NEAR(scene.out[i] / want_mwir, 1, 1e-6);
        shade(&air, BAND_LWIR);
        for (int i = 0; i < scene.hits.count; i++) CHECK_NEAR(scene.out[i] / want_lwir, 1, 1e-6);
    }
}

/* The cavity's twin: one thing a kelvin off and it shows, by its emissivity. */
static void a_warm_wall_shows_by_its_emissivity(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const Air     air = air_when(&weather, -20);
    clear();
    for (int m = 0; m < 3; m++) scene.rows[m] = (Material){.rho_mwir = 0.5f * (float)m, .rho_lwir = 0.5f * (float)m};
    for (int m = 0; m < 3; m++)
        for (int warm = 0; warm < 2; warm++) add((double[3]){0, 1, -1}, (double[3]){0, 0, 1}, 0, m, 300 + warm);
    shade(&air, BAND_LWIR);
    const double step = planck_table_radiance(lwir, 301) - planck_table_radiance(lwir, 300);
    for (int m = 0; m < 3; m++)
        CHECK_NEAR((scene.out[2 * m + 1] - scene.out[2 * m]) / step, 1 - 0.5 * m, 1e-4); /* float out of 38 W */
    /* a black one reads its temperature, a mirror the mean sky */
    CHECK_NEAR(planck_table_temp(lwir, scene.out[0]), 300, 1e-3);
    CHECK_NEAR(pi_rad * scene.out[4] / air.light.sky_w_m2[AIR_LWIR], 1, 1e-5);
}

static void mirrors_show_cold_zenith_and_warm_ground(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const Air     air = air_when(&weather, -20);
    clear();
    scene.rows[1] = (Material){.rho_mwir = 1, .rho_lwir = 1, .gloss = 1, .roughness = 0.02f};
    const int up = add((double[3]){0, 0, -1}, (double[3]){0, 0, 1}, 0, 1, 300);
    const int side = add((double[3]){0, 0.5, -0.05}, (double[3]){0, 0, 1}, 0, 1, 300);
    const int down = add((double[3]){0, 1, -1}, (double[3]){0, -1, 0}, 0, 1, 300); /* a wall, seen from above */
    shade(&air, BAND_LWIR);
    CHECK_NEAR(scene.out[up] / daylight_sky(&air.light, AIR_LWIR, (double[3]){0, 0, 1}), 1, 1e-6);
    CHECK(scene.out[side] > 2.5 * scene.out[up]);
    CHECK_NEAR(scene.out[down] / air.light.ground_w_m2_sr[AIR_LWIR], 1, 1e-6);
}

static void sun_shows_in_mwir_only_and_not_in_shadow(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const Air     air = air_when(&weather, 50);
    clear();
    scene.rows[1] = (Material){.rho_mwir = 0.15f, .rho_lwir = 0.05f};
    scene.rows[2] = (Material){.rho_mwir = 0.15f, .rho_lwir = 0.05f, .gloss = 1, .roughness = 0.1f};
    const double e = 50 * rad_per_deg, glint[3] = {0, -cos(e), -sin(e)}, n[3] = {0, 0, 1};
    const int    lit = add((double[3]){1, 0, -1}, n, 0, 1, 300), dark = add((double[3]){1, 0, -1}, n, 0, 1, 300);
    const int    away = add(glint, n, 0, 2, 300), toward = add((double[3]){0, -cos(e), -sin(e)}, n, 0, 2, 300);
    const int    facing = add((double[3]){0, cos(e), -sin(e)}, n, 0, 2, 300);
    const int    facing_dark = add((double[3]){0, cos(e), -sin(e)}, n, 0, 2, 300);
    scene.sun[dark] = scene.sun[away] = scene.sun[facing_dark] = 0;
    shade(&air, BAND_MWIR);
    CHECK_NEAR(scene.out[lit] - scene.out[dark], 0.15 / pi_rad * air.light.sun_w_m2[AIR_MWIR] * sin(e), 1e-6);
    /* the eye looks towards -y, where the sun stands: glint; towards +y: none */
    CHECK(scene.out[toward] - scene.out[away] > 10 * (scene.out[lit] - scene.out[dark]));
    CHECK_NEAR(scene.out[facing], scene.out[facing_dark], 1e-4 * scene.out[facing_dark]);
    shade(&air, BAND_LWIR);
    CHECK(scene.out[lit] == scene.out[dark]);
}

static void the_veil_is_the_airs(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const Air     air = air_when(&weather, 30);
    clear();
    add((double[3]){0, 1, -0.1}, (double[3]){0, 0, 1}, 4000, 0, 330);
    for (Band band = BAND_MWIR; band <= BAND_LWIR; band++) {
        const bool mid = band == BAND_MWIR;
        shade(&air, band);
        AirPaths veils;
        air_path(&veils, &air, mid ? AIR_MWIR : AIR_LWIR, &scene.hits, &scene.rays, scene.temp_k);
        const double bare = planck_table_radiance(mid ? mwir : lwir, 330);
        CHECK(veils.transmittance[0] > 0.1f && veils.transmittance[0] < 0.95f);
        CHECK_NEAR(scene.out[0] / (bare * veils.transmittance[0] + veils.added_w_m2_sr[0]), 1, 1e-6);
    }
}

/* ---- temperatures ---- */

/* A catalog of the product's own, for its roles. */
static Catalog *open_catalog(void)
{
    char     path[512];
    Catalog *catalog = NULL;
    CHECK(etc_path(path, sizeof path, "catalog.csv"));
    CHECK(catalog_open(&catalog, path, 0.05) == STATUS_OK);
    return catalog;
}

static Materials open_materials(const Catalog *catalog)
{
    char      path[512], surfaces[512];
    Materials m;
    CHECK(etc_path(path, sizeof path, "materials.csv") && etc_path(surfaces, sizeof surfaces, "surfaces.csv"));
    CHECK(materials_open(&m, path, surfaces, catalog) == STATUS_OK);
    return m;
}

static int add_ground(const Materials *m, SurfaceClass surface, const double n[3], double texture)
{
    const int i = add((double[3]){0, 1, -1}, n, 500, m->surface[surface], 0);
    scene.hits.surface[i] = (uint8_t)surface;
    scene.texture[i] = (float)texture;
    return i;
}

static int add_part(const Materials *m, int model, int part, const double n[3])
{
    const int i = add((double[3]){0, 1, -1}, n, 500, m->part[model][part], 0);
    scene.hits.surface[i] = 0;
    scene.hits.entity[i] = 1;
    scene.hits.model[i] = (uint16_t)model;
    scene.hits.part[i] = (uint16_t)(part + 1);
    return i;
}

/* U.S. Standard Atmosphere 1976 on paper: 6.5 K/km to 11 km, then 216.65 K; of air at 308.2 K the tropical profile as
 * LOWTRAN7 has it, less its 299.7 K: 293.7 at 1 km, 287.7 at 2, 277.0 at 4, 270.3 at 5, 237.0 at 10, 217.0 at 13.
 * Ground and what stands or flies there. */
static void air_is_colder_above(void **state)
{
    (void)state;
    static const double heights_m[] = {0, 137, 500, 2000, 4807, 10000, 13000, -430};
    static const double tropical_k[] = {0, -0.822, -3, -12, 0.193 * 277 + 0.807 * 270.3 - 299.7, -62.7, -82.7, 2.58};
    Catalog            *catalog = open_catalog();
    Materials           m = open_materials(catalog);
    const double        up[3] = {0, 0, 1};
    Weather             weather = weather_default();
    for (int warm = 0; warm < 2; warm++) {
        weather.air_temp_k = 288.2 + 20 * warm; /* as LOWTRAN7 rounds US 1976's ground */
        Air air = air_when(&weather, -30);
        air.light.zero_z_m = 300 * warm;
        for (int k = 0; k < 8; k++) {
            clear();
            add_ground(&m, SURFACE_GRASS, up, 1);
            add_ground(&m, SURFACE_GRASS, up, 1);
            add_part(&m, 0, 0, up);
            add_part(&m, 0, 0, up);
            for (int i = 0; i < 4; i++)
                scene.hits.p_enu[2][i] = i % 2 ? heights_m[k] + air.light.zero_z_m : air.light.zero_z_m;
            scene.hits.p_enu[0][1] = 100e3; /* and there the tangent plane is 785 m up */
            scene.hits.p_enu[2][1] -= 100e3 * 100e3 / (2 * 6371e3);
            thermal_temperature(scene.temp_k, &air, &m, NULL, &scene.hits, scene.material, NULL, scene.texture,
                                scene.warmth_k);
            const double want_k = warm                   ? tropical_k[k]
                                  : heights_m[k] < 11000 ? -0.0065 * heights_m[k]
                                                         : 216.65 - 288.15;
            /* the profile is in tenths of a kelvin, and of geometric heights: 0.1 K at 10 km */
            CHECK_NEAR(scene.temp_k[1] - scene.temp_k[0], want_k, 0.16);
            CHECK_NEAR(scene.temp_k[3] - scene.temp_k[2], want_k, 0.16 - 0.03 * want_k); /* emits less, so loses less */
            const double p_enu[3] = {0, 0, heights_m[k] + air.light.zero_z_m};
            CHECK_NEAR(daylight_temp_at(&air.light, p_enu), weather.air_temp_k + want_k, 0.15);
        }
    }
    materials_close(&m);
    catalog_close(catalog);
}

/* ---- what is at a hit ---- */

/* Air that is warmer by another amount at each node of 500 m, ground of each class at its own temperature, colder in
 * the dark; wood of its own. */
static HeatNow   now;
static HeatScene heat = {.now = &now};
static float     warmer_k[air_warmer_nodes];

static Air air_of_heat(bool ground)
{
    const double none[AIR_BAND_COUNT] = {0};
    Air          air;
    air_even(&air, (const double[3]){0, 0.6, 0.8}, 700, none, 0, mwir, lwir);
    air.light.zero_z_m = 40, air.light.solar_diffuse_w_m2 = 90, air.light.longwave_loss_w_m2 = 80;
    for (int k = 0; k < air_warmer_nodes; k++) air.light.warmer_k[k] = warmer_k[k] = (float)(-3 * k + (k * 7 % 5));
    memset(&now, 0, sizeof now);
    now.table.facets = 3;
    for (int kind = 0; kind < ground_kinds; kind++) {
        for (int n = 0; n < heat_most_facets * heat_most_facets; n++) now.table.sun_k[kind][n] = 290 + (float)kind;
        for (int n = 0; n < heat_ups; n++)
            now.table.shade_k[kind][n] = 280 + (float)kind, now.table.dark_k[kind][n] = 270 + (float)kind;
    }
    for (int k = 0; k < SURFACE_COUNT; k++) now.kind_of[k] = k;
    now.branches = 1, now.branch_material[0] = 5;
    for (int r = 0; r < branch_radii; r++)
        for (int shade = 0; shade < 2; shade++)
            now.table.branch[0][r][shade] = (BranchSides){.mean_k = shade ? 280 : 300, .side_k = {0, 0, 4}};
    if (ground) air.heat = &heat;
    return air;
}

/* Straight between nodes of 500 m above the model's zero, down to 2 km below it by the first two, up to the last; the
 * plane leaves the Earth by (x^2 + y^2) / (2 x 6371 km). */
static double air_on_paper_k(const Air *air, const double p_enu[3])
{
    const double at = (p_enu[2] + (p_enu[0] * p_enu[0] + p_enu[1] * p_enu[1]) / (2 * 6371e3) - 40) / 500,
                 within = fmin(fmax(at, -4), air_warmer_nodes - 1);
    const int low = within < 0 ? 0 : within >= air_warmer_nodes - 2 ? air_warmer_nodes - 2 : (int)within;
    return air->light.weather.air_temp_k + (double)warmer_k[low] +
           (within - low) * ((double)warmer_k[low + 1] - (double)warmer_k[low]);
}

static void find_temperatures(const Air *air, const float *sun)
{
    thermal_temperature(scene.temp_k, air, &scene.materials, NULL, &scene.hits, scene.material, sun, scene.texture,
                        scene.warmth_k);
}

static void air_is_between_its_nodes(void **state)
{
    (void)state;
    static const double z_m[] = {-5000, -1990, -900, 39, 41, 290, 540, 1300, 8000, 15500, 15900, 16030, 17000};
    const Air           air = air_of_heat(false);
    clear();
    for (int k = 0; k < 13 * 3; k++) {
        const int i = add((double[3]){0, 0, -1}, (double[3]){0, 0, 1}, 5, 1, 0);
        scene.hits.p_enu[0][i] = k % 3 == 1 ? 60e3 : 0, scene.hits.p_enu[1][i] = k % 3 == 2 ? -90e3 : 0,
        scene.hits.p_enu[2][i] = z_m[k / 3];
        scene.hits.entity[i] = k % 2;
        scene.warmth_k[i] = k % 2 ? 5 : -2; /* of the ground alone */
    }
    const int sky = add((double[3]){0, 0, 1}, (double[3]){0, 0, 1}, INFINITY, 1, 0);
    find_temperatures(&air, NULL);
    for (int i = 0; i < sky; i++) {
        const double p_enu[3] = {scene.hits.p_enu[0][i], scene.hits.p_enu[1][i], scene.hits.p_enu[2][i]};
        CHECK_NEAR(scene.temp_k[i], air_on_paper_k(&air, p_enu) + (scene.hits.entity[i] ? 0 : -2), 2e-3);
    }
    CHECK(isnan(scene.temp_k[sky]));
}

/* Ground 290 K and its class in the sun, 270 in the dark: 270 + d (20) of an absorptance d = 1.5 - photo / 2, the
 * photograph within 0.6 .. 1.4; the air's difference with height; the noise, of which there is 1 + lifted / 16 where
 * the sun lifted the ground above the dark's. Snow is not above 273.15 K, water not below 271.35. */
static void ground_is_as_dark_as_its_photograph(void **state)
{
    (void)state;
    static const float photo[] = {0.3f, 0.6f, 1, 1.25f, 1.4f, 2};
    const Air          air = air_of_heat(true);
    clear();
    for (int k = 0; k < 6 * 5; k++) {
        const int i = add((double[3]){0, 0, -1}, (double[3]){0, 0, 1}, 5, 1, 0);
        scene.hits.surface[i] = (uint8_t)(k / 6 == 0   ? SURFACE_NONE
                                          : k / 6 == 1 ? SURFACE_SNOW
                                          : k / 6 == 2 ? SURFACE_WATER
                                                       : SURFACE_GRASS + k / 6);
        scene.hits.p_enu[2][i] = k % 6 == 5 ? 1540 : 40;
        scene.texture[i] = photo[k % 6], scene.warmth_k[i] = 0.5f * (float)(k % 4) - 1;
        if (k == 8 || k == 14) scene.warmth_k[i] = -30; /* colder than snow melts and than the sea freezes */
    }
    find_temperatures(&air, NULL);
    for (int i = 0; i < 30; i++) {
        const int class = scene.hits.surface[i];
        const double p_enu[3] = {0, 0, scene.hits.p_enu[2][i]}, here = air_on_paper_k(&air, p_enu),
                     noise = (double)scene.warmth_k[i];
        const double lifted = (1.5 - 0.5 * fmin(fmax((double)scene.texture[i], 0.6), 1.4)) * 20;
        double       want = 270 + class + lifted + (here - air.light.weather.air_temp_k) + noise * (1 + lifted / 16);
        if (class == SURFACE_NONE) want = here + noise;
        if (class == SURFACE_SNOW) want = fmin(want, 273.15);
        if (class == SURFACE_WATER) want = fmax(want, 271.35);
        CHECK_NEAR(scene.temp_k[i], want, 1e-3);
    }
}

/* A leaf is in balance with the sun that it gets, or, where no sun is given, with that of its openness; bark has the
 * heat of its branch, 280 K in the shade and 300 K in the sun by its openness and 4 K more on top; both as much warmer
 * as the air there. Where no branch is known bark is as warm as the air. */
static void plants_are_leaves_and_wood(void **state)
{
    (void)state;
    Air air = air_of_heat(true);
    clear();
    scene.rows[3] = (Material){.rho_lwir = 0.03f, .solar_absorptance = 0.5f};
    scene.rows[3].tau[optical_channel_nir] = 0.4f;
    for (int i = 0; i < 4; i++) {
        add((double[3]){0, 0, -1}, (double[3]){0.6, 0, 0.8}, 5, i < 2 ? 3 : 5, 0);
        scene.hits.kind[i] = hit_plant, scene.hits.radius_m[i] = 0.05f, scene.hits.open_up[i] = i % 2 ? 0.25f : 0.75f;
        scene.hits.p_enu[2][i] = 290 + 500 * i;
        scene.sun[i] = i % 2 ? 1 : 0.5f;
    }
    for (int told = 0; told < 2; told++) {
        find_temperatures(&air, told ? scene.sun : NULL);
        for (int i = 0; i < 4; i++) {
            const double p_enu[3] = {0, 0, scene.hits.p_enu[2][i]}, here = air_on_paper_k(&air, p_enu),
                         open = (double)scene.hits.open_up[i];
            const double want =
                i < 2 ? thermal_leaf_k(&air.light, &scene.rows[3], here, open, told ? (double)scene.sun[i] : open)
                      : 280 + open * 20 + 0.8 * 4 + here - air.light.weather.air_temp_k;
            CHECK_NEAR(scene.temp_k[i], want, 1e-3);
        }
    }
    now.branches = 0;
    find_temperatures(&air, NULL);
    const double p_enu[3] = {0, 0, scene.hits.p_enu[2][3]};
    CHECK_NEAR(scene.temp_k[3], air_on_paper_k(&air, p_enu), 1e-3);
    now.branches = 1, air.heat = NULL;
    find_temperatures(&air, NULL);
    CHECK_NEAR(scene.temp_k[3], air_on_paper_k(&air, p_enu), 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(isothermal_cavity),
        cmocka_unit_test(a_warm_wall_shows_by_its_emissivity),
        cmocka_unit_test(mirrors_show_cold_zenith_and_warm_ground),
        cmocka_unit_test(sun_shows_in_mwir_only_and_not_in_shadow),
        cmocka_unit_test(the_veil_is_the_airs),
        cmocka_unit_test(air_is_colder_above),
        cmocka_unit_test(air_is_between_its_nodes),
        cmocka_unit_test(ground_is_as_dark_as_its_photograph),
        cmocka_unit_test(plants_are_leaves_and_wood),
    };
    return cmocka_run_group_tests(tests, open_scene, close_scene);
}
