/* Temperatures at places, from a table that is written down here: scales, shade of the hours before, bark between
 * radii, marks. Tables with every normal: test_heat.c. labels: physics */
#include "tests/check.h"

#include "render/heat/heat.h"

enum { kind = SURFACE_GRASS };
static HeatNow      now;
static const double up[3] = {0, 0, 1};

/* Level ground of all kinds: sunlit, shaded, unlit, without sky. */
static void level_ground(double sun_k, double shade_k, double dark_k, double hidden_k)
{
    now.table.facets = 3;
    for (int k = 1; k < ground_kinds; k++) {
        for (int i = 0; i < 9; i++) now.table.sun_k[k][i] = (float)sun_k;
        for (int i = 0; i < heat_ups; i++)
            now.table.shade_k[k][i] = (float)shade_k, now.table.dark_k[k][i] = (float)dark_k;
        now.table.hidden_k[k] = (float)hidden_k;
    }
    for (int s = 0; s < SURFACE_COUNT; s++) now.kind_of[s] = s;
}

/* What linear responses are scaled by: the kelvins between the columns over the sum of the responses, the sun's by its
 * height, where that is above 0.5 K; within 0.5 .. 2, else 1. */
static void scales(void **state)
{
    (void)state;
    static const struct {
        double first_k, second_k, apart_k, want; /* responses; what the columns are apart by */
    } c[] = {{3, 1, 6, 1.5},        {0.3, 0.22, 0.624, 1.2},
             {0.3, 0.18, 0.624, 1}, {-0.3, -0.22, -0.624, 1.2},
             {3, 1, 2.08, 0.52},    {3, 1, 1.6, 0.5},
             {3, 1, 7.9, 1.975},    {3, 1, 9, 2},
             {3, 1, -4, 0.5},       {0, 0, 5, 1}};
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        HeatPast *p = &now.past[1];
        double    sun, sky;
        memset(&now, 0, sizeof now);
        p->count = 3;
        p->sun_d_enu[0][2] = 0.5, p->sun_d_enu[1][2] = 0.25, p->sun_d_enu[2][2] = -0.5; /* the last: at night */
        p->sun_k[kind][0] = (float)(2 * c[k].first_k), p->sun_k[kind][1] = (float)(4 * c[k].second_k),
        p->sun_k[kind][2] = 100;
        level_ground(290 + c[k].apart_k, 290, 280, 290);
        heat_scales(&sun, &sky, &now, kind);
        CHECK_NEAR(sun, c[k].want, 1e-4);
        CHECK(sky == 1);
        memset(&now, 0, sizeof now);
        p->count = 2;
        p->sky_k[kind][0] = (float)c[k].first_k, p->sky_k[kind][1] = (float)c[k].second_k;
        level_ground(300, 290, 280, 290 - c[k].apart_k);
        heat_scales(&sun, &sky, &now, kind);
        CHECK_NEAR(sky, c[k].want, 1e-4);
        CHECK(sun == 1);
    }
}

/* Half hours weighed by what they left, times the cosine to the sun then: 2 K at 0.8, 3 K at 0.6, 1 K behind the slope,
 * and 4 K at 1, of which 1, 0.4 and 0.2 were shaded (255, 102, 51 of 255): 1.6 + 0.72 + 0.8 of 7.4. */
static void shade_of_half_hours(void **state)
{
    (void)state;
    static const double d[4][3] = {{0.6, 0, 0.8}, {-0.8, 0, 0.6}, {0, 0, -1}, {0, 0, 1}};
    static const float  k[4] = {2, 3, 1, 4};
    uint8_t             shadow[shadow_most_slots] = {255, 102, 255, 51};
    memset(&now, 0, sizeof now);
    for (int first = 0; first < 2; first++) { /* some among the first eight, some after */
        memset(&now, 0, sizeof now), memset(shadow, 0, sizeof shadow);
        now.slots = 16;
        for (int s = 0; s < 4; s++) {
            const int at = first ? s : 5 * s;
            for (int i = 0; i < 3; i++) now.slot_d_enu[i][at] = (float)d[s][i];
            now.table.slot_k[kind][at] = k[s];
            shadow[at] = (uint8_t[]){255, 102, 255, 51}[s];
        }
        CHECK_NEAR(heat_taken(&now, kind, up, shadow), 3.12 / 7.4, 1e-6);
        CHECK(heat_taken(&now, kind, (const double[3]){0, 0, -1}, shadow) == 1); /* the third alone */
        const double east[3] = {1, 0, 0};
        CHECK_NEAR(heat_taken(&now, kind, east, shadow), 1, 1e-6);
        for (int s = 0; s < 16; s++) now.table.slot_k[kind][s] *= 1e-3f; /* 7 mK in all */
        CHECK_NEAR(heat_taken(&now, kind, up, shadow), 3.12 / 7.4, 1e-6);
        for (int s = 0; s < 16; s++) now.table.slot_k[kind][s] *= 0.1f; /* 0.7 mK: too little to divide by */
        CHECK(heat_taken(&now, kind, up, shadow) == 0);
    }
}

/* Bark by the logarithm of its radius between those of the table, by its side, by what of sun and sky reached it. */
static void bark(void **state)
{
    (void)state;
    const double n[3] = {0.6, 0, 0.8};
    memset(&now, 0, sizeof now);
    CHECK(isnan(heat_branch_k(&now, 5, 0.1, n, 1)));
    now.branches = 2, now.branch_material[0] = 5, now.branch_material[1] = 9;
    for (int k = 0; k < 2; k++)
        for (int r = 0; r < branch_radii; r++)
            for (int shade = 0; shade < 2; shade++)
                now.table.branch[k][r][shade] = (BranchSides){(float)(280 + 20 * k + 2 * r * r + (shade ? 0 : 10)),
                                                              {(float)(shade ? 0 : 5), 3, (float)(shade ? 1 : 2)},
                                                              {(float)(shade ? 0 : 4), 7}};
    /* mean + 5 * 0.6 + 2 * 0.8 + 4 * 0.36 in the sun, 0.8 more than the mean in the shade */
    const double     sun_k = 10 + 3 + 1.6 + 1.44, shade_k = 0.8;
    static const int material[] = {5, 9, 77};
    for (int m = 0; m < 3; m++)
        for (int r = 0; r + 1 < branch_radii; r++)
            for (double share = 0; share <= 1; share += 0.25) {
                const double radius_m = branch_radius_m[r] * pow(branch_radius_m[r + 1] / branch_radius_m[r], share),
                             base_k = 280 + 20 * (m == 1) + 2 * (r * r + share * (2 * r + 1));
                CHECK_NEAR(heat_branch_k(&now, material[m], radius_m, n, 1), base_k + sun_k, 1e-4);
                CHECK_NEAR(heat_branch_k(&now, material[m], radius_m, n, 0), base_k + shade_k, 1e-4);
                CHECK_NEAR(heat_branch_k(&now, material[m], radius_m, n, 0.3),
                           base_k + shade_k + 0.3 * (sun_k - shade_k), 1e-4);
            }
    CHECK(heat_branch_k(&now, 5, 1e-4, n, 1) == heat_branch_k(&now, 5, branch_radius_m[0], n, 1));
    CHECK(heat_branch_k(&now, 5, 7, n, 1) == heat_branch_k(&now, 5, branch_radius_m[branch_radii - 1], n, 1));
}

/* Grass of 300 K in a trail, 0.3 of the way to ploughed ground of 310 K, and in burnt ground of 320 K, whatever its own
 * colour; heat on top. Sand and burnt ground are not loosened. What the sun lifted is over unlit ground of 285 K. */
static void marks_change_ground(void **state)
{
    (void)state;
    LocalFrame  frame;
    Arena      *arena = arena_create();
    GroundTrack t = {.a_s = 0, .b_s = 0, .width_m = 0.6f, .apart_m = 2.6f};
    GroundBurn  b = {.t_s = 990, .radius_m = 5, .heat_j_m2 = 1e4f};
    double      lifted_k;
    CHECK(arena && local_frame_at(&frame, &(Geodetic){0.785, 0.2, 0}) == STATUS_OK);
    memset(&now, 0, sizeof now);
    level_ground(300, 290, 285, 288);
    for (int i = 0; i < 9; i++) now.table.sun_k[SURFACE_PLOUGHED][i] = 310, now.table.sun_k[ground_burnt][i] = 320;
    now.past[0].count = now.past[1].count = 1;
    now.past[1].unix_s[0] = 700, now.past[1].span_s[0] = 600;
    now.past[1].effusivity[SURFACE_PLOUGHED] = 1000;
    ecef_from_enu(t.a_ecef, &frame, (const double[3]){-20, 0, 0});
    ecef_from_enu(t.b_ecef, &frame, (const double[3]){20, 0, 0});
    ecef_from_enu(b.p_ecef, &frame, (const double[3]){200, 0, 0});
    const GroundMarks marks = {.tracks = 1, .track = &t, .burns = 1, .burn = &b};
    MarkHeat         *heat;
    CHECK(heat_marks_create(&heat, &marks, &frame, 0, 1000, &now, arena) == STATUS_OK);
    const HeatScene scene = {.now = &now, .marks = heat}, bare = {.now = &now};
    const double    in[3] = {0, 1.3, 0}, burnt[3] = {204, 0, 0}, beside[3] = {0, 9, 0};
    CHECK_NEAR(heat_scene_ground_k(&lifted_k, &scene, SURFACE_GRASS, in, up, 1), 303, 1e-4);
    CHECK_NEAR(lifted_k, 15, 1e-4);
    CHECK_NEAR(heat_scene_ground_k(&lifted_k, &bare, SURFACE_GRASS, in, up, 1), 300, 1e-4);
    CHECK_NEAR(heat_scene_ground_k(&lifted_k, &scene, SURFACE_GRASS, beside, up, 1), 300, 1e-4);
    CHECK_NEAR(heat_scene_ground_k(&lifted_k, &scene, SURFACE_ROCK, in, up, 1), 300, 1e-4);
    /* darker by a fifth: 285 + 1.2 * 15, and 285 + 1.2 * 25 of the ploughed */
    CHECK_NEAR(heat_scene_ground_k(&lifted_k, &scene, SURFACE_GRASS, in, up, 1.2), 303 + 0.3 * 12, 1e-4);
    CHECK_NEAR(lifted_k, 18, 1e-4);
    /* 4 m from the middle of 5: 1 - 0.8^4 = 0.5904 of the way, and as much of 10 kJ/m2 ten seconds ago */
    const double warm_k = 0.5904 * 1e4 / (1000 * sqrt(pi_rad * 10));
    CHECK_NEAR(heat_scene_ground_k(&lifted_k, &scene, SURFACE_GRASS, burnt, up, 1), 300 + 0.5904 * 20 + warm_k, 1e-3);
    CHECK_NEAR(heat_scene_ground_k(&lifted_k, &scene, SURFACE_GRASS, burnt, up, 1.2), 303 + 0.5904 * 17 + warm_k, 1e-3);
    level_ground(280, 281, 285, 288); /* colder than unlit ground: nothing is lifted */
    CHECK_NEAR(heat_scene_ground_k(&lifted_k, &bare, SURFACE_GRASS, in, up, 1), 280, 1e-4);
    CHECK(lifted_k == 0);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(scales), cmocka_unit_test(shade_of_half_hours),
                                       cmocka_unit_test(bark), cmocka_unit_test(marks_change_ground)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
