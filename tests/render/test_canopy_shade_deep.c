/* Sun through stands of the real trees, met themselves and in tables, against closed forms of what they hide
 * (render/light/canopy.h). labels: deep physics */
#include "tests/check.h"

#include "render/light/canopy.h"

#include <stdlib.h>
#include <string.h>

enum { trees = 180, stands = 40, rays = 256, lots = 4000 };
static const double half_m = 70, tall_m = 15, middle_m = 12, within_m = 100;

static Plants  *plants;
static Plant    plant[trees];
static uint32_t first[2] = {0, trees};

static double dice(uint32_t stream, int index) { return random_uniform(40, stream, 0, (uint64_t)index); }

/* Trees of one kind and height, anywhere in a square: each hides a place far from its edges with the same chance. */
static Woods stand_of(PlantKind kind, int number)
{
    for (int i = 0; i < trees; i++) {
        const int at = number * trees + i;
        plant[i] = (Plant){.p_m = {(float)(half_m * (2 * dice(1, at) - 1)), (float)(half_m * (2 * dice(2, at) - 1)), 0},
                           .kind = (uint8_t)kind,
                           .height = (uint16_t)(tall_m / plant_height_step_m),
                           .twist = (uint16_t)(65535 * dice(3, at)),
                           .width = 128};
    }
    return (Woods){.nx = 1, .ny = 1, .first = first, .count = trees, .plant = plant};
}

/* Share of the rays from the middle of stands to the sun that nothing stops, and its standard error from stand to
 * stand. */
static double lit(double *error, PlantKind kind, bool tables, int way)
{
    const ForestConfig config = {.leaves = true, .fine = true, .tables = tables};
    const double       up = plant_shade_up[way], eye[3] = {0, 0, 2000}, calm[2] = {0, 0};
    Forest            *forest = NULL;
    double             sum = 0, square = 0;
    Woods              woods = stand_of(kind, 0);
    assert_int_equal(forest_create(&forest, &woods, plants, &config, "avx2"), STATUS_OK);
    for (int s = 0; s < stands; s++) {
        static double o[3][rays], d[3][rays], far_m[rays];
        uint8_t       dark[rays] = {0};
        Forest       *beside = NULL;
        ForestFrame   frame;
        double        open = 0;
        woods = stand_of(kind, s);
        assert_int_equal(forest_create_beside(&beside, forest, &woods), STATUS_OK);
        assert_int_equal(forest_frame_open(&frame, beside, eye, 500, 0, 0, calm, NULL, NULL), STATUS_OK);
        const double turn = 2 * pi_rad * (s + 0.5) / stands, flat = sqrt(1 - up * up);
        for (int k = 0; k < rays; k++) {
            const int at = s * rays + k;
            o[0][k] = middle_m * (2 * dice(4, at) - 1), o[1][k] = middle_m * (2 * dice(5, at) - 1), o[2][k] = 0.01;
            d[0][k] = flat * cos(turn), d[1][k] = flat * sin(turn), d[2][k] = up, far_m[k] = INFINITY;
        }
        forest_any_hits(dark, &frame, rays, (const double *const[3]){o[0], o[1], o[2]},
                        (const double *const[3]){d[0], d[1], d[2]}, far_m, NULL);
        for (int k = 0; k < rays; k++) open += (dark[k] ? 0 : 1.0) / rays;
        sum += open, square += open * open;
        forest_frame_close(&frame);
        forest_destroy(beside);
    }
    forest_destroy(forest);
    *error = sqrt(fmax(square / stands - sum * sum / stands / stands, 0) / (stands - 1));
    return sum / stands;
}

/* Shadow of a plant 1 m high on level ground, m2, were all its leaves and branches strewn at random: the sum of each
 * one's, the mean over all azimuths. Of the sides of a branch, which is closed, half. */
static double strewn_m2(PlantKind kind, int way)
{
    enum { azimuths = 64 };
    const PlantShape *s = &plants->shape[kind][plant_whole];
    const double      up = plant_shade_up[way], flat = sqrt(1 - up * up);
    double            sum = 0;
    for (int q = 0; q < s->quads; q++) {
        const PlantQuad *quad = &s->quad[q];
        double           u[3], v[3], n[3];
        for (int x = 0; x < 3; x++) {
            u[x] = (double)quad->corner[2][x] - (double)quad->corner[0][x];
            v[x] = (double)quad->corner[3][x] - (double)quad->corner[1][x];
        }
        v3_cross(n, u, v);
        const double area = 0.5 * (quad->organ == PLANT_LEAF ? (double)plants->outline_area[kind][quad->outline] : 0.5);
        for (int a = 0; a < azimuths; a++) {
            const double turn = 2 * pi_rad * a / azimuths;
            sum += area * fabs(flat * (n[0] * cos(turn) + n[1] * sin(turn)) + up * n[2]) / azimuths;
        }
    }
    return sum / up;
}

/* Of n trees whose shadows K fall anywhere on an area A, (1 - K / A)^n of a place is lit (Nilson, Agric. Meteorol. 8,
 * 1971). Were all leaves strewn at random, exp(-n S / A), S their area across the light (Monsi & Saeki 1953): less. */
static void shadows_are_those_of_trees(void **state)
{
    (void)state;
    static const PlantKind kinds[] = {PLANT_PINE, PLANT_BIRCH, PLANT_ENGLISH_OAK};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        for (int way = 1; way < plant_shade_ways; way++) {
            const double area = 4 * half_m * half_m, m2 = tall_m * tall_m;
            const double shadow = m2 * (double)plants->shade[kinds[k]].above[way][0],
                         strewn = m2 * strewn_m2(kinds[k], way);
            const double want = pow(1 - shadow / area, trees), beer = exp(-trees * strewn / area);
            for (int tables = 0; tables < 2; tables++) {
                double       error;
                const double found = lit(&error, kinds[k], tables, way);
                print_message("%s, sun %.0f degrees up%s: lit %.3f +- %.3f, by shadows %.3f, strewn at random %.3f\n",
                              plant_name(kinds[k]), asin(plant_shade_up[way]) / rad_per_deg, tables ? ", tables" : "",
                              found, error, want, beer);
                CHECK_NEAR(found, want, 3 * error + 0.01);
                CHECK(found > beer + 3 * error);
            }
        }
}

/* A place and a way to the light: cosine-weighted over the sky, or to a sun. */
static void fill(double *const o[3], double *const d[3], int k, double z_m, double sin_sun, int at)
{
    const double up = sin_sun > 0 ? sin_sun : sqrt(dice(13, at)), flat = sqrt(1 - up * up),
                 turn = 2 * pi_rad * dice(14, at);
    o[0][k] = within_m * (2 * dice(11, at) - 1), o[1][k] = within_m * (2 * dice(12, at) - 1), o[2][k] = z_m;
    d[0][k] = flat * cos(turn), d[1][k] = flat * sin(turn), d[2][k] = up;
}

/* Forests of the density of their class: the sky and the sun at places on the ground and up to their tops, by rays and
 * by the closed form; without leaves at random, which the old form of the light took them for. */
static void light_by_height(void **state)
{
    (void)state;
    static const double       height_m[] = {0.01, 4, 8, 12, 16}, sun_deg[] = {0, 20, 45, 70}; /* 0: the sky */
    static const SurfaceClass of[] = {SURFACE_FOREST_BROADLEAF, SURFACE_FOREST_CONIFER};
    static double             o[3][lots], d[3][lots], far_m[lots];
    static Material           row;
    static uint8_t            dark[lots];
    static PlantShade         shade[PLANT_STANDING];
    const Materials           none = {.count = 1, .material = &row};
    double *const from[3] = {o[0], o[1], o[2]}, *const along[3] = {d[0], d[1], d[2]};
    for (int f = 0; f < 4; f++) {
        const double density = f % 2 ? 0.4 : 1.2, eye[3] = {0, 0, 2000}, calm[2] = {0, 0};
        Woods        woods;
        Forest      *forest = NULL;
        ForestFrame  frame;
        Canopy      *canopy = NULL, *random = NULL;
        assert_int_equal(woods_of_class(&woods, of[f / 2], density, 11, 6), STATUS_OK);
        assert_int_equal(forest_create(&forest, &woods, plants, &(ForestConfig){.leaves = true, .fine = true}, "avx2"),
                         STATUS_OK);
        assert_int_equal(forest_frame_open(&frame, forest, eye, 500, 0, 0, calm, NULL, NULL), STATUS_OK);
        assert_int_equal(canopy_create(&canopy, &woods, plants, &none, true), STATUS_OK);
        memcpy(shade, plants->shade, sizeof shade);
        memset(plants->shade, 0, sizeof shade); /* leaves at random */
        assert_int_equal(canopy_create(&random, &woods, plants, &none, true), STATUS_OK);
        memcpy(plants->shade, shade, sizeof shade);
        for (size_t h = 0; h < sizeof height_m / sizeof *height_m; h++)
            for (size_t s = 0; s < sizeof sun_deg / sizeof *sun_deg; s++) {
                const double sine = sin(sun_deg[s] * rad_per_deg);
                double       lit = 0, by_form = 0, at_random = 0;
                memset(dark, 0, sizeof dark);
                for (int k = 0; k < lots; k++) {
                    CanopyPlace p;
                    fill(from, along, k, height_m[h], sine, k + lots * (int)s);
                    far_m[k] = INFINITY;
                    canopy_place(&p, canopy, o[0][k], o[1][k], height_m[h], fmax(sine, 0.1));
                    by_form += (s == 0 ? p.up : p.sun_here) / lots;
                    canopy_place(&p, random, o[0][k], o[1][k], height_m[h], fmax(sine, 0.1));
                    at_random += (s == 0 ? p.up : p.sun_here) / lots;
                }
                forest_any_hits(dark, &frame, lots, (const double *const *)from, (const double *const *)along, far_m,
                                NULL);
                for (int k = 0; k < lots; k++) lit += (dark[k] ? 0 : 1.0) / lots;
                print_message(
                    "%s, density %.1f, %.0f m, %s %2.0f: rays %.3f +- %.3f, form %.3f, leaves at random %.3f\n",
                    f / 2 ? "conifers" : "broadleaves", density, height_m[h], s ? "sun" : "sky", sun_deg[s], lit,
                    sqrt(lit * (1 - lit) / lots), by_form, at_random);
                CHECK_NEAR(by_form, lit, 0.08);
            }
        canopy_destroy(canopy);
        canopy_destroy(random);
        forest_frame_close(&frame);
        forest_destroy(forest);
        woods_destroy(&woods);
    }
}

static int grow(void **state)
{
    (void)state;
    const ForestConfig config = {.leaves = true, .fine = true};
    Forest            *forest = NULL;
    Woods              woods;
    if (plants_create(&plants, 1995, NULL) != STATUS_OK) return -1;
    woods = stand_of(PLANT_PINE, 0);
    if (forest_create(&forest, &woods, plants, &config, "avx2") != STATUS_OK) return -1;
    forest_shade(plants, forest, NULL);
    forest_destroy(forest);
    return 0;
}

static int fell(void **state)
{
    (void)state;
    plants_destroy(plants);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(shadows_are_those_of_trees), cmocka_unit_test(light_by_height)};
    return cmocka_run_group_tests(tests, grow, fell);
}
