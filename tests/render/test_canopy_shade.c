/* What plants hide of slanted light (render/light/canopy.h): shadows of prototypes that are known on paper, and the sky
 * and the sun below and beside stands of them. labels: physics */
#include "tests/check.h"

#include "render/light/canopy.h"

#include <stdlib.h>

enum { side = 24, last = plant_shade_heights - 1, ways = plant_shade_ways };

static double slant_of(int way) { return sqrt(1 - plant_shade_up[way] * plant_shade_up[way]) / plant_shade_up[way]; }

/* ---- prototypes ------------------------------------------------------------------------------- */

static PlantQuad card[2];

/* A card from corner a along u and v, which is there all over. */
static PlantQuad card_of(const double a[3], const double u[3], const double v[3])
{
    PlantQuad q = {.organ = PLANT_BARK};
    double    n[3];
    v3_cross(n, u, v);
    v3_normalize(n, n);
    for (int c = 0; c < 4; c++)
        for (int x = 0; x < 3; x++) {
            q.corner[c][x] = (float)(a[x] + (c == 1 || c == 2 ? u[x] : 0) + (c >= 2 ? v[x] : 0));
            q.n[c][x] = (float)n[x];
        }
    return q;
}

/* Shadows of prototypes of these cards. */
static Plants *shadows_of(int cards)
{
    static Plant    plant = {.kind = PLANT_BIRCH, .height = 1000, .width = 128};
    static uint32_t first[2] = {0, 1};
    const Woods     woods = {.nx = 1, .ny = 1, .first = first, .count = 1, .plant = &plant};
    Plants         *plants = calloc(1, sizeof *plants);
    Forest         *forest = NULL;
    assert_non_null(plants);
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++) {
            PlantShape *s = &plants->shape[kind][level];
            *s = (PlantShape){.quads = cards, .pieces = 1, .quad = card, .bark_quads = cards};
            for (int x = 0; x < 3; x++) s->low[x] = INFINITY, s->high[x] = -INFINITY;
            for (int k = 0; k < 12 * cards; k++) {
                const float at = card[k / 12].corner[k / 3 % 4][k % 3];
                s->low[k % 3] = fminf(s->low[k % 3], at), s->high[k % 3] = fmaxf(s->high[k % 3], at);
            }
        }
    assert_int_equal(forest_create(&forest, &woods, plants, &(ForestConfig){.leaves = true}, "avx2"), STATUS_OK);
    forest_shade(plants, forest, NULL);
    forest_destroy(forest);
    return plants;
}

/* A level card of 0.8 m by 0.6 m, 0.7 m up: a shadow of 0.48 m2 from everywhere, of what lies above 0.625 m and less,
 * and below 0.75 m and more. */
static void level_card(void **state)
{
    (void)state;
    card[0] = card_of((const double[3]){-0.4, -0.3, 0.7}, (const double[3]){0.8, 0, 0}, (const double[3]){0, 0.6, 0});
    Plants *plants = shadows_of(1);
    for (int way = 0; way < ways; way++)
        for (int h = 0; h <= last; h++) {
            const PlantShade *s = &plants->shade[PLANT_BIRCH];
            CHECK_NEAR(s->above[way][h], h <= 5 ? 0.48 : 0, 0.015);
            CHECK_NEAR(s->below[way][h], h <= 5 ? 0 : 0.48, 0.015);
        }
    free(plants);
}

/* An upright card 0.5 m wide and 1 m high: from a slant t the shadow is 0.5 t |sin| long, over all azimuths 0.5 t 2 /
 * pi; of what is above a height z, (1 - z) of it, and of what is below it, z. */
static void upright_card(void **state)
{
    (void)state;
    card[0] = card_of((const double[3]){-0.25, 0, 0}, (const double[3]){0.5, 0, 0}, (const double[3]){0, 0, 1});
    Plants *plants = shadows_of(1);
    for (int way = 0; way < ways; way++)
        for (int h = 0; h <= last; h++) {
            const PlantShade *s = &plants->shade[PLANT_PINE];
            const double      all = 0.5 * slant_of(way) * 2 / pi_rad, z = (double)h / last;
            CHECK_NEAR(s->above[way][h], all * (1 - z), 0.05 * all);
            CHECK_NEAR(s->below[way][h], all * z, 0.05 * all);
        }
    free(plants);
}

/* One card above the other: what hides a place twice counts once, and from below the lower one comes first. */
static void card_over_card(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++)
        card[k] = card_of((const double[3]){-0.5, -0.5, 0.3 + 0.002 * k}, (const double[3]){1, 0, 0},
                          (const double[3]){0, 1, 0});
    Plants           *plants = shadows_of(2);
    const PlantShade *s = &plants->shade[PLANT_HEDGE];
    for (int way = 1; way < ways; way++) {
        CHECK_NEAR(s->above[way][2], 1, 0.03); /* at most 0.006 m2 of the lower one is not below the upper */
        CHECK(s->above[way][3] == 0 && s->below[way][2] == 0);
        CHECK_NEAR(s->below[way][3], 1, 0.03);
    }
    free(plants);
}

/* ---- stands ----------------------------------------------------------------------------------- */

static Plants  *flat;
static Plant    plant[side * side];
static uint32_t first[3 * 3 + 1];
static Woods    woods;

/* Birches of 20 m, one in the middle of each cell of 8 m of a square of 192 m, east of its column `from`: each hides
 * m2 of level ground from everywhere, all of it by what is at half its height. */
static Canopy *stand_of(double m2, int from)
{
    static Materials none = {.count = 1};
    static Material  row;
    Canopy          *c = NULL;
    none.material = &row;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        flat->shape[kind][plant_whole] = (PlantShape){.leaf_area = 1.28f, .crown_radius = 0.2f};
    for (int way = 0; way < ways; way++)
        for (int h = 0; h <= last; h++) {
            flat->shade[PLANT_BIRCH].above[way][h] = h < 4 ? (float)(m2 / 400) : 0;
            flat->shade[PLANT_BIRCH].below[way][h] = h > 4 ? (float)(m2 / 400) : 0;
        }
    woods = (Woods){.nx = 3, .ny = 3, .first = first, .plant = plant, .origin_enu = {-96, -96, 0}};
    for (int j = 0; j < side; j++)
        for (int i = from; i < side; i++)
            plant[woods.count++] = (Plant){
                .p_m = {(float)(8 * i + 4), (float)(8 * j + 4), 0}, .kind = PLANT_BIRCH, .height = 2000, .width = 128};
    woods.by_kind[PLANT_BIRCH] = woods.count;
    assert_int_equal(canopy_create(&c, &woods, flat, &none, true), STATUS_OK);
    return c;
}

/* 16 m2 of shadow a tree, one every 64 m2, spread over pi 4^2 + 2 x 4 x 20 x 0.3935 = 113.2 m2 (0.3935: the slant of
 * the highest way of light). Each of cells of 16 m2, of which a quarter bear one, hides 16 / 113.2 / 4 = 0.0353 of a
 * place; each tree of the 300 m2 that a place is a mean over, 16 / 300 = 0.0533: (1 - 0.0887)^(0.25 / 0.0887) = 0.7697
 * of it is lit by sky and sun alike, which leaves at random would not: those hide more of low light. As much of the
 * light on a wall, and on any slope. */
static void stand_of_plates(void **state)
{
    (void)state;
    const double share = 4 / (16 * pi_rad + 160 * slant_of(ways - 1)) + 16.0 / 300, want = pow(1 - share, 0.25 / share);
    Canopy      *c = stand_of(16, 0);
    CanopyStand  there;
    CanopyPlace  p;
    for (double sin_sun = 0.07; sin_sun < 0.95; sin_sun += 0.1) {
        CHECK(canopy_place(&p, c, 3, 5, 0, sin_sun));
        CHECK_NEAR(p.up, want, 0.01); /* by the cells' steps */
        CHECK_NEAR(p.sun_here, want, 0.01);
        CHECK_NEAR(p.sun_on_ground, want, 0.01);
        CHECK_NEAR(p.low, want, 0.02); /* of light from below 4 degrees less: as of what is as high as wide */
        CHECK(fabs(p.towards[0]) < 0.02 && fabs(p.towards[1]) < 0.02 && p.down == 1);
    }
    canopy_stand(&there, c, 3, 5);
    CHECK_NEAR(there.leaf_area, 8, 1e-9); /* 1.28 x 400 / 64 */
    CHECK_NEAR(exp(-0.5 * canopy_clumping(c, 0.4) * there.hides / 0.4), want, 0.01);
    /* above the plates, half way up, nothing hides the sky, and they the ground */
    CHECK(canopy_place(&p, c, 3, 5, 13, 0.5));
    CHECK(p.up == 1 && p.sun_here == 1);
    CHECK_NEAR(p.down, want, 0.01);
    CHECK_NEAR(p.sun_on_ground, want, 0.01);
    /* leaves that a place on the ground sees are half way, on the mean, between those that all hide and those that
     * nothing does: d exp(-d) / (1 - exp(-d)), d = -log 0.7697 */
    CHECK(canopy_place(&p, c, 3, 5, 0, 0.5));
    CHECK_NEAR(p.seen_up, -log(want) * want / (1 - want), 0.01);
    CHECK_NEAR(p.seen_sun, p.seen_up, 0.01);
    canopy_destroy(c);
}

/* Beside a stand that lets nothing through, of crowns whose middle is 10 m up, in the cell before its first: of the
 * ways of light (render/trace/plants/plants.h), the highest leaves the cell at 0.49 cells, to none; the next at 1.39,
 * the lower ones at 3.6 and 6.25, so that three azimuths of eight end in the stand. Of level light, 0.3237 + 0.6763 x 5
 * / 8 = 0.7464; and as much less from the east as (1 + 2 cos 45) / 8 of 1.4467, the sum of 2 weight cosine of the
 * three: 0.4366. A slope of 30 degrees gets cos 30 of the level light, half of 1 - cos 30 of the wall's, 0.7464 as well
 * since plates hide as much of all light, and (1 + cos 30) / 2 of 0.4366 more or less: 0.9001 or 0.4927 of the 0.9330
 * that an open sky gives it. */
static void beside_a_stand(void **state)
{
    (void)state;
    static Hits        hits;
    static CanopyLight among;
    static const float dark[optical_channel_count] = {0};
    const Daylight     light = {.sun_d_enu = {0, 0, -1}};
    Canopy            *c = stand_of(600, side / 2);
    CanopyPlace        p;
    CHECK(canopy_place(&p, c, -4, 4, 0, 0.5));
    CHECK_NEAR(p.up, 0.7464, 0.012);
    CHECK_NEAR(p.towards[0], -0.4366, 0.012);
    CHECK(fabs(p.towards[1]) < 0.005 && p.sun_on_ground == 1);
    CHECK(canopy_place(&p, c, 4, 4, 0, 0.5));
    CHECK(p.sun_on_ground < 0.01 && p.up < 0.45); /* but from the west */
    CHECK(p.towards[0] < -0.3);
    CHECK(canopy_place(&p, c, -70, 4, 0, 0.5) && p.up > 0.98 && p.up < 1);
    hits.count = 3;
    for (int i = 0; i < 3; i++) { /* level, and facing west and east */
        hits.kind[i] = hit_ground, hits.range_m[i] = 100, hits.p_enu[0][i] = -4, hits.p_enu[1][i] = 4;
        hits.n_enu[0][i] = i == 0 ? 0 : i == 1 ? -0.5f : 0.5f, hits.n_enu[2][i] = i == 0 ? 1 : (float)sqrt(0.75);
    }
    assert_true(canopy_light(&among, c, NULL, &light, dark, &hits, 1u << AIR_NIR));
    CHECK_NEAR(among.up[0], 0.7464, 0.012);
    CHECK_NEAR(among.up[1], 0.9001 / 0.9330, 0.02);
    CHECK_NEAR(among.up[2], 0.4927 / 0.9330, 0.02);
    canopy_destroy(c);
}

static int open_stands(void **state)
{
    (void)state;
    flat = calloc(1, sizeof *flat);
    return flat ? 0 : -1;
}

static int close_stands(void **state)
{
    (void)state;
    free(flat);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(level_card),      cmocka_unit_test(upright_card),   cmocka_unit_test(card_over_card),
        cmocka_unit_test(stand_of_plates), cmocka_unit_test(beside_a_stand),
    };
    return cmocka_run_group_tests(tests, open_stands, close_stands);
}
