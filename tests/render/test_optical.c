/* Reflected light, where paper knows the answer. labels: physics */
#include "tests/check.h"
#include "render/light/optical.h"

static PlanckTable *mwir, *lwir;
static Atmosphere  *atmosphere;
static Arena       *arena;

/* One block of hits, by hand. */
typedef struct Scene {
    Hits      hits;
    Rays      rays;
    uint16_t  material[hits_capacity];
    float     texture[hits_capacity], out[hits_capacity];
    float     sun[hits_capacity];
    Material  rows[8];
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
    arena_reset(arena);
    memset(&scene, 0, sizeof scene);
    scene.materials = (Materials){.count = 8, .material = scene.rows};
}

static int add(const double d_enu[3], const double n_enu[3], double range_m, int material, bool shadow)
{
    const int i = scene.hits.count++;
    scene.rays.count = scene.hits.count;
    double d[3] = {0}, n[3] = {0};
    CHECK(v3_normalize(d, d_enu));
    CHECK(v3_normalize(n, n_enu));
    for (int k = 0; k < 3; k++) {
        scene.rays.d_enu[k][i] = d[k];
        scene.hits.n_enu[k][i] = scene.hits.n_geo[k][i] = (float)n[k];
    }
    scene.hits.range_m[i] = range_m;
    scene.material[i] = (uint16_t)material;
    scene.texture[i] = 1;
    scene.sun[i] = !shadow;
    return i;
}

static int add_sky(double x, double y, double z)
{
    return add((double[3]){x, y, z}, (double[3]){0, 0, 1}, INFINITY, 0, false);
}

static void shade(const Air *air, int channel)
{
    optical_shade(scene.out, channel, air, &scene.materials, &scene.hits, &scene.rays, scene.material, scene.texture,
                  scene.sun, NULL, NULL, NULL, NULL);
}

static void set_material(int row, double rho, double gloss, double roughness)
{
    Material *m = &scene.rows[row];
    for (int c = 0; c < optical_channel_count; c++) m->rho[c] = (float)rho;
    m->gloss = (float)gloss;
    m->roughness = (float)roughness;
}

/* The eye eye_m above the ground, the sun in the east. */
static Air clear_day_at(double elevation_deg, double eye_m)
{
    const double  e = elevation_deg * rad_per_deg;
    const Weather weather = weather_default();
    const Sun sun = {.elevation_rad = e, .azimuth_rad = 0.5 * pi_rad, .distance_au = 1, .d_enu = {cos(e), 0, sin(e)}};
    const AirSource source = {atmosphere, mwir, lwir, 0, 0};
    Air             air;
    const AirEye    eye = {eye_m, 0x1f, NULL};
    CHECK(air_at(&air, &source, &weather, &sun, &eye, NULL, arena) == STATUS_OK);
    return air;
}

static Air clear_day(double elevation_deg) { return clear_day_at(elevation_deg, 2); }

/* The scene that Cycles and Radiance were asked about (reference/infrared.md): sun 1000 W/m2, 40 degrees from the
 * zenith towards +x, even sky of 100 W/m2, no air in between. */
static Air oracle_air(void)
{
    const double z = 40 * rad_per_deg, sun[3] = {sin(z), 0, cos(z)};
    double       sky[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) sky[b] = 100 / pi_rad;
    Air air;
    air_even(&air, sun, 1000, sky, 0, mwir, lwir);
    return air;
}

static void open_ground_is_as_on_paper(void **state)
{
    (void)state;
    clear();
    set_material(1, 0.2, 0, 1);
    set_material(2, 0.8, 0, 1);
    const Air    air = oracle_air();
    const double down[3] = {0, 0.7, -0.7}, up[3] = {0, 0, 1};
    const int    lit = add(down, up, 50, 1, false), dark = add(down, up, 50, 1, true);
    /* the sphere's top, rho 0.8, under the open sky: no ground below to add to it */
    const int top = add(down, up, 50, 2, false);
    const int textured = add(down, up, 50, 1, false);
    scene.texture[textured] = 0.8f;
    shade(&air, optical_channel_pan);
    CHECK_NEAR(scene.out[lit], 55.1341, 1e-3); /* 0.2 / pi (1000 cos 40 + 100) */
    CHECK_NEAR(scene.out[dark], 0.2 * 100 / pi_rad, 1e-4);
    CHECK_NEAR(scene.out[top], 4 * 55.1341, 5e-3);
    CHECK_NEAR(scene.out[textured], 0.8 * 55.1341, 1e-3);
}

/* The sphere's sunlit side: Cycles 204.268, Radiance 204.980 at the pixel (420, 190) of its picture. */
static void sphere_is_as_others_render_it(void **state)
{
    (void)state;
    clear();
    set_material(2, 0.8, 0, 1);
    for (int s = 0; s < SURFACE_COUNT; s++) scene.materials.surface[s] = 0;
    for (int c = 0; c < optical_channel_count; c++) scene.materials.ground_rho[c] = 0.2f;
    const Air air = oracle_air();
    /* the camera of that scene: (0,-12,4), pitched 10 degrees down, 30 degrees wide, 720 x 486 */
    static const struct {
        double px[2], want, tolerance;
        bool   shadow;
    } pixel[] = {
        {{420, 190}, 204.6, 0.006, false},
        {{360, 150}, 182.0, 0.006, false},
        {{290, 200}, 30.8, 0.03, true}, /* the quick form leaves out the sphere's own shadow on the ground */
    };
    const double focal_px = 360 / tan(15 * rad_per_deg), pitch = -10 * rad_per_deg;
    for (int i = 0; i < 3; i++) {
        const double x = (pixel[i].px[0] - 360) / focal_px, y = -(pixel[i].px[1] - 243) / focal_px;
        double       d[3] = {x, cos(pitch) - y * sin(pitch), sin(pitch) + y * cos(pitch)}, o[3] = {0, -12, 4 - 2};
        CHECK(v3_normalize(d, d));
        const double b = v3_dot(o, d), c = v3_dot(o, o) - 1, root = b * b - c;
        CHECK(root > 0);
        double n[3];
        v3_add_scaled(n, o, -b - sqrt(root), d);
        add(d, n, 10, 2, pixel[i].shadow);
    }
    shade(&air, optical_channel_pan);
    for (int i = 0; i < 3; i++) {
        print_message("sphere at (%g, %g): %.2f, others %.1f\n", pixel[i].px[0], pixel[i].px[1], scene.out[i],
                      pixel[i].want);
        CHECK_NEAR(scene.out[i] / pixel[i].want, 1, pixel[i].tolerance);
    }
}

/* In a world of one radiance, lit from everywhere and by no sun, what reflects all shows that radiance, glossy or not,
 * tilted or not, in front of air or not; and nothing is brighter. */
static void white_furnace(void **state)
{
    (void)state;
    clear();
    static const double gloss[] = {0, 0.1, 0.5, 1, 0, 0.3, 0.7};
    for (int g = 0; g < 7; g++) set_material(g + 1, g > 3 ? 0.9 : 1, gloss[g], 0.1);
    for (int c = 0; c < optical_channel_count; c++) scene.materials.ground_rho[c] = 1;
    static const double even[AIR_BAND_COUNT] = {1, 1, 1, 1, 1, 1, 1};
    Air                 air;
    air_even(&air, (const double[3]){0, 0, -1}, 0, even, 1e-4, mwir, lwir);
    for (int m = 1; m <= 7; m++)
        for (int tilt = 0; tilt < 8; tilt++)
            for (int view = 0; view < 8; view++) {
                const double t = tilt * 0.4, w = view * 0.19; /* the eye up to 76 degrees off the normal */
                const double n[3] = {sin(t), 0, cos(t)}, d[3] = {-sin(t + w), 0, -cos(t + w)};
                add(d, n, 3000, m, false);
            }
    for (int c = 0; c < optical_channel_count; c++) {
        shade(&air, c);
        for (int i = 0; i < scene.hits.count; i++) {
            const int    m = scene.material[i];
            const double bare = (scene.out[i] - (1 - exp(-0.3))) / exp(-0.3);
            CHECK(bare <= 1 + 1e-5);
            CHECK(bare >= scene.rows[m].rho[c] - 1e-5);    /* gloss at grazing only adds */
            if (m <= 4) CHECK_NEAR(scene.out[i], 1, 2e-6); /* single precision, of the normal too */
        }
    }
}

static void mirrors_show_the_sky_they_face(void **state)
{
    (void)state;
    clear();
    set_material(1, 0.6, 1, 0.02);
    const Air    air = clear_day(35);
    const double d[3] = {0.3, 0.8, -0.6}, n[3] = {0, 0, 1};
    const int    i = add(d, n, 1e-9, 1, true);
    const int    sky = add_sky(0.3, 0.8, 0.6);
    shade(&air, optical_channel_b);
    double unit[3] = {0};
    CHECK(v3_normalize(unit, d));
    const double fresnel = material_fresnel(scene.rows[1].rho[0], scene.rows[1].roughness, -unit[2]);
    /* the mirror lies on the ground, the eye 2 m above */
    CHECK_NEAR(scene.out[i] / (fresnel * scene.out[sky]), 1, 1e-3);
}

/* The sky is bright about the sun. A mirror shows that ring; rough grass of the same reflectance shows an even sheen.
 */
static void rough_mirrors_show_no_ring(void **state)
{
    (void)state;
    clear();
    set_material(1, 0.3, 1, 0.01);
    set_material(2, 0.3, 1, 0.5);
    const double e = 40 * rad_per_deg;
    const Air    air = clear_day(40);
    int          smooth[2], rough[2];
    for (int k = 0; k < 2; k++) { /* down the sun's mirror image, and 8 degrees beside it; in shadow: no sun itself */
        const double off = 8 * k * rad_per_deg, d_enu[3] = {cos(e) * cos(off), cos(e) * sin(off), -sin(e)};
        smooth[k] = add(d_enu, (double[3]){0, 0, 1}, 0, 1, true);
        rough[k] = add(d_enu, (double[3]){0, 0, 1}, 0, 2, true);
    }
    shade(&air, optical_channel_r);
    CHECK(scene.out[smooth[0]] > 1.5 * scene.out[smooth[1]]);
    CHECK_NEAR(scene.out[rough[0]] / scene.out[rough[1]], 1, 0.1); /* what the sky does beyond the ring */
    CHECK(scene.out[rough[0]] < scene.out[smooth[1]]);
}

static void glint_is_where_the_mirror_says(void **state)
{
    (void)state;
    clear();
    set_material(1, 0.05, 1, 0.05);
    const Air    air = clear_day(35);
    const double e = 35 * rad_per_deg;
    int          best = -1, first = scene.hits.count;
    for (int k = -20; k <= 20; k++) {
        const double a = e + k * 0.02;
        add((double[3]){-cos(a), 0, -sin(a)}, (double[3]){0, 0, 1}, 10, 1, false); /* looking from the sun's side */
    }
    const int count = scene.hits.count;
    for (int k = -20; k <= 20; k++) {
        const double a = e + k * 0.02;
        add((double[3]){cos(a), 0, -sin(a)}, (double[3]){0, 0, 1}, 10, 1, false); /* looking towards the sun */
    }
    shade(&air, optical_channel_pan);
    double peak = 0, peak_behind = 0;
    for (int i = first; i < count; i++) peak_behind = fmax(peak_behind, scene.out[i]);
    for (int i = count; i < scene.hits.count; i++)
        if (scene.out[i] > peak) peak = scene.out[i], best = i - count - 20;
    CHECK(abs(best) <= 1); /* Beckmann's peak leans towards grazing by less than a step */
    CHECK(peak > 20 * peak_behind);
}

static void sky_pixels_are_the_sky(void **state)
{
    (void)state;
    clear();
    const Air    air = clear_day(35);
    const double e = 35 * rad_per_deg;
    const int    zenith = add_sky(0, 0, 1), sun = add_sky(cos(e), 0, sin(e));
    const int    level = add_sky(0, 1, 0);
    shade(&air, optical_channel_r);
    CHECK_NEAR(scene.out[zenith] / daylight_sky(&air.light, AIR_R, (double[3]){0, 0, 1}), 1,
               1e-3); /* two metres of air less */
    /* the disc: its irradiance over pi (0.2665 degree)^2 */
    const double disc = air.light.sun_w_m2[optical_channel_r] / (pi_rad * pow(0.2665 * rad_per_deg, 2));
    CHECK_NEAR((scene.out[sun] - daylight_sky(&air.light, AIR_R, air.light.sun_d_enu)) / disc, 1, 1e-3);
    CHECK(scene.out[level] > scene.out[zenith]);
}

/* Beyond the terrain's edge lies the round Earth: land straight below, through all of the air a little off the horizon,
 * and no seam where it meets the sky. */
static void beyond_the_edge_is_land(void **state)
{
    (void)state;
    clear();
    for (int c = 0; c < optical_channel_count; c++) scene.materials.ground_rho[c] = 0.15f;
    const Air air = clear_day_at(40, 3000);
    const int below = add_sky(0, 0.01, -1);
    const int real = add((double[3]){0, 0.01, -1}, (double[3]){0, 0, 1}, 3000, 1, false);
    set_material(1, 0.15, 0, 1);
    const int steps = 120, first = scene.hits.count;
    for (int k = 0; k <= steps; k++) add_sky(0, 1, -0.06 + 0.001 * k);
    shade(&air, optical_channel_g);
    CHECK_NEAR(scene.out[below] / scene.out[real], 1, 1e-4);
    /* the horizon dips by sqrt(2 h / R) = 0.031: steps of a milliradian across it stay small */
    for (int k = 0; k < steps; k++) {
        CHECK(isfinite(scene.out[first + k]));
        CHECK_NEAR(scene.out[first + k + 1] / scene.out[first + k], 1, 0.12);
    }
}

static void distance_hides_contrast(void **state)
{
    (void)state;
    clear();
    set_material(1, 0.02, 0, 1);
    set_material(2, 0.9, 0, 1);
    const Air    air = clear_day(40);
    const double d[3] = {0.5, 0.8, 0}, n[3] = {0, 0, 1};
    for (int k = 0; k < 4; k++) {
        const double range_m[] = {10, 5000, 23000, 1e5};
        add(d, n, range_m[k], 1, false), add(d, n, range_m[k], 2, false);
    }
    const int horizon = add_sky(0.5, 0.8, 0);
    shade(&air, optical_channel_g);
    /* Koschmieder: contrast falls to 2 % over a visibility of 23 km (at 0.55 um; the band's mean is not that) */
    const double near = scene.out[1] - scene.out[0], far = scene.out[5] - scene.out[4];
    print_message("contrast left over 23 km: %.4f; 100 km: %.2f, horizon %.2f\n", far / near, (double)scene.out[6],
                  (double)scene.out[horizon]);
    CHECK_NEAR(far / near, 0.02, 0.006);
    CHECK(scene.out[3] - scene.out[2] < 0.6 * near && scene.out[2] > scene.out[0]);
    CHECK_NEAR(scene.out[7] / scene.out[6], 1, 1e-3);
}

/* A wall that faces the sun's side of the sky gets more of it than its back. */
static void the_sky_is_brighter_about_the_sun(void **state)
{
    (void)state;
    clear();
    set_material(1, 0.5, 0, 1);
    const Air    air = clear_day(20);
    const double d[3] = {0, 1, -0.01};
    add(d, (double[3]){1, 0, 0}, 1, 1, true), add(d, (double[3]){-1, 0, 0}, 1, 1, true);
    shade(&air, optical_channel_pan);
    CHECK(scene.out[0] > 1.15 * scene.out[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(open_ground_is_as_on_paper),
        cmocka_unit_test(sphere_is_as_others_render_it),
        cmocka_unit_test(white_furnace),
        cmocka_unit_test(mirrors_show_the_sky_they_face),
        cmocka_unit_test(rough_mirrors_show_no_ring),
        cmocka_unit_test(glint_is_where_the_mirror_says),
        cmocka_unit_test(sky_pixels_are_the_sky),
        cmocka_unit_test(beyond_the_edge_is_land),
        cmocka_unit_test(distance_hides_contrast),
        cmocka_unit_test(the_sky_is_brighter_about_the_sun),
    };
    return cmocka_run_group_tests(tests, open_scene, close_scene);
}
