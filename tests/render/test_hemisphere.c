/* Light from all around: the sphere over a plane that two other renderers were asked about, and even worlds where
 * nothing can be brighter or darker than what surrounds it. labels: physics */
#include "tests/render/hand_models.h"

#include "render/light/hemisphere_private.h"
#include "render/light/optical.h"
#include "render/trace/parts/parts.h"
#include "render/light/thermal.h"

enum { model_plane, model_sphere, model_wall, model_count };

static struct {
    PlanckTable   *mwir, *lwir;
    Model          model[model_count];
    Tracer        *tracer;
    Arena         *arena;
    LocalFrame     frame;
    SnapshotEntity entity[model_count];
    NodePose       pose[model_count];
    Snapshot       snapshot;
    Visibility    *visibility;
    Material       rows[4];
    Materials      materials;
    int           *part[model_count], row_of[model_count];
    Air            air;
} stage;

static const double wall_m = 2;

/* Plane rho 0.2 at z = 0, sphere rho 0.8 of radius 1 at (0, 0, 2): reference/infrared.md. */
static int open_stage(void **state)
{
    (void)state;
    const Geodetic origin = {0.6, -1.9, 700};
    if (planck_table_create(&stage.mwir, 3.4e-6, 4.8e-6) != STATUS_OK ||
        planck_table_create(&stage.lwir, 8e-6, 12e-6) != STATUS_OK ||
        local_frame_at(&stage.frame, &origin) != STATUS_OK)
        return -1;
    /* two kilometres: 2 mrad of the lowest sky is missing beyond, 4e-6 of the light */
    hand_plate(&stage.model[model_plane], 2000, 2000);
    hand_sphere(&stage.model[model_sphere], 1, 96); /* facets lie within 0.3 mm of it */
    hand_box(&stage.model[model_wall], (const double[3]){-1, -1000, 0}, (const double[3]){0, 1000, wall_m});
    const Model *models[model_count] = {&stage.model[model_plane], &stage.model[model_sphere],
                                        &stage.model[model_wall]};
    if (tracer_create_models(&stage.tracer, models, model_count, "avx2") != STATUS_OK) return -1;
    stage.arena = arena_create();
    stage.snapshot =
        (Snapshot){.count = model_wall, .node_count = model_wall, .entity = stage.entity, .node = stage.pose};
    /* the plate's forward is up, its z from -4 to 0 km lies along east */
    static const double turned[9] = {0, 0, 1, 0, 1, 0, 1, 0, 0}, straight[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1},
                        upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const double place[model_count][3] = {{2000, 0, 0}, {0, 0, 2}, {0, 0, 0}};
    for (int k = 0; k < model_count; k++) {
        stage.entity[k] = (SnapshotEntity){.model = k, .first_node = k};
        ecef_from_enu(stage.entity[k].p_ecef, &stage.frame, place[k]);
        m3_mul(stage.entity[k].r_ecef_from_body, stage.frame.r_ecef_from_enu,
               k == model_plane  ? turned
               : k == model_wall ? upright
                                 : straight);
        stage.pose[k] = (NodePose){{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        stage.row_of[k] = k + 1;
        stage.part[k] = &stage.row_of[k];
    }
    stage.materials = (Materials){.count = 4, .material = stage.rows, .part = stage.part, .model_count = model_count};
    if (visibility_create(&stage.visibility, stage.tracer, NULL, &stage.frame, &stage.snapshot, false, stage.arena) !=
        STATUS_OK)
        return -1;
    visibility_materials(stage.visibility, &stage.materials);
    return 0;
}

static int close_stage(void **state)
{
    (void)state;
    tracer_destroy(stage.tracer);
    arena_destroy(stage.arena);
    planck_table_destroy(stage.mwir);
    planck_table_destroy(stage.lwir);
    for (int m = 0; m < model_count; m++) hand_free(&stage.model[m]);
    return 0;
}

/* A key for each hit, of a series. */
static const uint64_t *keys(uint64_t series)
{
    static uint64_t key[hits_capacity];
    for (uint64_t i = 0; i < hits_capacity; i++) key[i] = series * hits_capacity + i;
    return key;
}

static void set_rho(double plane, double sphere)
{
    for (int c = 0; c < optical_channel_count; c++) {
        stage.rows[1].rho[c] = (float)plane;
        stage.rows[2].rho[c] = (float)sphere;
        stage.materials.ground_rho[c] = (float)plane;
    }
}

/* The camera of that scene: (0,-12,4), pitched 10 degrees down, 30 degrees wide, 720 x 486. */
static void look_at(Rays *rays, Hits *hits, VisibilityCounters *counters, const double (*px)[2], int count)
{
    const double focal_px = 360 / tan(15 * rad_per_deg), pitch = -10 * rad_per_deg;
    rays->count = count;
    for (int i = 0; i < count; i++) {
        /* the centre of the pixel */
        const double x = (px[i][0] + 0.5 - 360) / focal_px, y = -(px[i][1] + 0.5 - 243) / focal_px;
        double       d[3] = {x, cos(pitch) - y * sin(pitch), sin(pitch) + y * cos(pitch)};
        CHECK(v3_normalize(d, d));
        const double o[3] = {0, -12, 4};
        for (int k = 0; k < 3; k++) rays->o_enu[k][i] = o[k], rays->d_enu[k][i] = d[k];
        rays->far_m[i] = INFINITY;
    }
    visibility_first_hit(hits, stage.visibility, rays, visibility_all_but(-1), counters);
}

static void sphere_over_a_plane(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double      px[2], cycles, radiance, tolerance;
    } point[] = {
        /* lit points: 1 %, shaded ones: 2 % of the span of the two (infrared.md), which differ by that themselves */
        {"ground", {60, 470}, 55.142, 55.120, 0.01},         {"sphere top", {360, 150}, 182.206, 181.780, 0.01},
        {"sunlit side", {420, 190}, 204.268, 204.980, 0.01}, {"shaded side", {290, 200}, 31.115, 30.462, 0.02},
        {"sphere bottom", {360, 290}, 37.771, 38.056, 0.02},
    };
    enum { points = sizeof point / sizeof *point };
    static Rays            rays;
    static Hits            hits;
    static HemisphereLight gathered;
    double                 px[points][2];
    for (int i = 0; i < points; i++) memcpy(px[i], point[i].px, sizeof px[i]);
    VisibilityCounters counters = {0};
    const double       z = 40 * rad_per_deg, sun[3] = {sin(z), 0, cos(z)};
    double             sky[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) sky[b] = 100 / pi_rad;
    air_even(&stage.air, sun, 1000, sky, 0, stage.mwir, stage.lwir);
    set_rho(0.2, 0.8);
    look_at(&rays, &hits, &counters, px, points);

    const HemisphereScene scene = {stage.visibility, &stage.air, &stage.materials, NULL, &stage.snapshot};
    uint8_t               shadow[hits_capacity] = {0};
    float                 arrives[hits_capacity];
    float                 texture[hits_capacity], out[2][hits_capacity];
    uint16_t              material[hits_capacity];
    visibility_shadow(shadow, stage.visibility, &hits, sun, &counters);
    for (int i = 0; i < hits.count; i++) arrives[i] = !shadow[i];
    for (int i = 0; i < points; i++) {
        CHECK(hits.entity[i] > 0);
        material[i] = (uint16_t)hits.entity[i];
        texture[i] = 1;
    }
    static const int samples[2] = {64, 4096};
    for (int run = 0; run < 2; run++) {
        hemisphere_light(&gathered, &scene, &hits, 1 << AIR_PAN, samples[run], keys(7), &counters);
        optical_shade(out[run], optical_channel_pan, &stage.air, &stage.materials, &hits, &rays, material, texture,
                      arrives, gathered.w_m2[AIR_PAN], NULL, NULL, NULL);
    }
    for (int i = 0; i < points; i++)
        print_message("%-13s %8.3f with 64, %8.3f with 4096; Cycles %.3f, Radiance %.3f\n", point[i].name,
                      (double)out[0][i], (double)out[1][i], point[i].cycles, point[i].radiance);
    for (int i = 0; i < points; i++) {
        const double low = fmin(point[i].cycles, point[i].radiance), high = fmax(point[i].cycles, point[i].radiance);
        CHECK(out[1][i] >= low * (1 - point[i].tolerance) && out[1][i] <= high * (1 + point[i].tolerance));
        CHECK_NEAR(out[0][i] / out[1][i], 1, 0.05); /* and few samples are near enough to look at */
    }
}

/* A world of reflectance 1 under an even sky without sun is even; one of any emissivity at one temperature reads it. */
static void even_worlds_stay_even(void **state)
{
    (void)state;
    static Rays            rays;
    static Hits            hits;
    static HemisphereLight gathered;
    VisibilityCounters     counters = {0};
    static const double    px[][2] = {{60, 470}, {360, 150}, {290, 200}, {360, 290}, {360, 330}};
    double                 sky[AIR_BAND_COUNT] = {1, 1, 1, 1, 1};
    sky[AIR_MWIR] = planck_table_radiance(stage.mwir, 300), sky[AIR_LWIR] = planck_table_radiance(stage.lwir, 300);
    air_even(&stage.air, (const double[3]){0, 0.6, -0.8}, 0, sky, 0, stage.mwir, stage.lwir);
    set_rho(1, 1);
    look_at(&rays, &hits, &counters, px, 5);
    const HemisphereScene scene = {stage.visibility, &stage.air, &stage.materials, NULL, &stage.snapshot};
    hemisphere_light(&gathered, &scene, &hits, 1 << AIR_G | 1 << AIR_NIR, 200, keys(1), &counters);
    for (int i = 0; i < 5; i++) {
        /* all of it is a sum of ones, in single precision */
        CHECK_NEAR(gathered.w_m2[AIR_G][i] / pi_rad, 1, 1e-6);
        CHECK_NEAR(gathered.w_m2[AIR_NIR][i] / pi_rad, 1, 1e-6);
    }
}

/* A black wall of height H without end, the sun e up behind it, no sky. Its shadow reaches s = H / tan e; from a height
 * z of the wall the lit ground begins b = atan(z / s) below the horizontal. A strip of ground between two such angles
 * sends pi L / 2 of the difference of their sines to a wall (its view factor), so pi L sin b / 2 arrive: what the wall
 * sees below the horizontal is sin b of open ground. The change of the open ground's light by the wall's own shadow is
 * the rest. */
static void wall_in_its_own_shadow(void **state)
{
    (void)state;
    enum { points = 3 };
    static Hits             hits;
    static HemisphereLight  gathered;
    static HemisphereChange change[hits_capacity];
    VisibilityCounters      counters = {0};
    const double            e = 35 * rad_per_deg, sun[3] = {-cos(e), 0, sin(e)}, dark[AIR_BAND_COUNT] = {0};
    SnapshotEntity          standing[2] = {stage.entity[model_plane], stage.entity[model_wall]};
    Snapshot                snapshot = stage.snapshot;
    Visibility             *visibility;
    snapshot.entity = standing, snapshot.count = 2, snapshot.node_count = model_count;
    assert_int_equal(visibility_create(&visibility, stage.tracer, NULL, &stage.frame, &snapshot, false, stage.arena),
                     STATUS_OK);
    visibility_materials(visibility, &stage.materials);
    air_even(&stage.air, sun, 500, dark, 0, stage.mwir, stage.lwir);
    set_rho(0.2, 0.8);
    stage.row_of[model_wall] = 3;
    hits = (Hits){.count = points};
    for (int i = 0; i < points; i++) {
        hits.p_enu[2][i] = 0.5 * (i + 1), hits.n_enu[0][i] = hits.n_geo[0][i] = 1, hits.range_m[i] = 10;
        hits.entity[i] = 2, hits.kind[i] = hit_part, hits.material[i] = 3;
    }
    static const int      list[2] = {0, 1};
    static const double   reach_m[2] = {50, 50};
    const HemisphereScene scene = {visibility, &stage.air, &stage.materials, NULL, &snapshot};
    const HemisphereNear  near = {1u << AIR_R, 2048, 50, 2, list, reach_m};
    hemisphere_light(&gathered, &scene, &hits, 1u << AIR_R, 4096, keys(8), &counters);
    hemisphere_change(change, &scene, &hits, &near, keys(8), NULL, &counters);
    const double ground = 0.2 * 500 * sin(e) / pi_rad; /* radiance in the sun */
    for (int i = 0; i < points; i++) {
        const double share = sin(atan(hits.p_enu[2][i] / (wall_m / tan(e)))), open_w_m2 = 0.5 * pi_rad * ground;
        CHECK_NEAR(gathered.w_m2[AIR_R][i] / open_w_m2, share, 0.01);
        CHECK_NEAR(gathered.below[AIR_R][i], share, 0.01);
        CHECK_NEAR(change[i].w_m2[AIR_R] / open_w_m2, share - 1, 0.015);
        CHECK_NEAR(change[i].below_w_m2[AIR_R] / open_w_m2, share - 1, 0.015);
        CHECK_NEAR(hemisphere_below((double)change[i].below_w_m2[AIR_R], ground, 0), share, 0.015);
    }
}

/* Same block and samples, same bits; another block, other draws. */
static void same_question_same_bits(void **state)
{
    (void)state;
    static Rays            rays;
    static Hits            hits;
    static HemisphereLight a, b;
    VisibilityCounters     counters = {0};
    static const double    px[][2] = {{290, 200}, {900, -500}, {360, 290}};
    look_at(&rays, &hits, &counters, px, 3);
    CHECK(!(hits.range_m[1] < INFINITY));
    const double sky[AIR_BAND_COUNT] = {1, 2, 3, 4, 5, 6, 7};
    air_even(&stage.air, (const double[3]){0.6, 0, 0.8}, 10, sky, 0, stage.mwir, stage.lwir);
    set_rho(0.2, 0.8);
    const HemisphereScene scene = {stage.visibility, &stage.air, &stage.materials, NULL, &stage.snapshot};
    hemisphere_light(&a, &scene, &hits, 1 << AIR_R, 500, keys(3), &counters);
    hemisphere_light(&b, &scene, &hits, 1 << AIR_R | 1 << AIR_B, 500, keys(3), &counters);
    for (int i = 0; i < 3; i++) CHECK(a.w_m2[AIR_R][i] == b.w_m2[AIR_R][i]);
    CHECK(a.w_m2[AIR_R][1] == 0 && a.w_m2[AIR_R][0] > 0 && a.w_m2[AIR_R][0] != a.w_m2[AIR_R][2]);
    hemisphere_light(&b, &scene, &hits, 1 << AIR_R, 500, keys(4), &counters);
    CHECK(a.w_m2[AIR_R][0] != b.w_m2[AIR_R][0]);

    /* the last hit alone, by its own key: whoever else is asked for does not show, nor where blocks of paths end */
    static HemisphereLight together[4];
    static const int       samples[4] = {500, 600, 800, 1500};
    for (int n = 0; n < 4; n++)
        hemisphere_light(&together[n], &scene, &hits, 1 << AIR_R, samples[n], keys(3), &counters);
    for (int k = 0; k < 3; k++) {
        hits.p_enu[k][0] = hits.p_enu[k][2], hits.n_enu[k][0] = hits.n_enu[k][2], hits.n_geo[k][0] = hits.n_geo[k][2];
    }
    hits.range_m[0] = hits.range_m[2], hits.entity[0] = hits.entity[2], hits.part[0] = hits.part[2];
    hits.model[0] = hits.model[2], hits.surface[0] = hits.surface[2];
    hits.count = 1;
    for (int n = 0; n < 4; n++) {
        hemisphere_light(&b, &scene, &hits, 1 << AIR_R, samples[n], keys(3) + 2, &counters);
        CHECK(together[n].w_m2[AIR_R][2] == b.w_m2[AIR_R][0]);
    }
}

/* What a path brings from its hit: of the sun a surface of reflectance r and transmittance t returns r E cos / pi of
 * what falls on its own side and t E cos / pi of the other one's; in thermal bands it emits 1 - r - t of Planck's; at
 * the last bounce it returns sky and ground by its tilt, of both sides. What misses shows the sky, or below the horizon
 * the ground. */
static void paths_bring_what_they_met(void **state)
{
    (void)state;
    static Paths        p;
    static const double sun[3] = {0.48, 0.36, 0.8}, ground = 11;
    double              sky[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) sky[b] = 3 + b;
    air_even(&stage.air, sun, 500, sky, 0, stage.mwir, stage.lwir);
    Material *m = &stage.rows[1];
    for (int c = 0; c < optical_channel_count; c++) m->rho[c] = 0.3f + 0.05f * (float)c;
    m->rho_mwir = 0.2f, m->rho_lwir = 0.1f;
    const HemisphereScene scene = {stage.visibility, &stage.air, &stage.materials, NULL, &stage.snapshot};
    for (int leaf = 0; leaf < 2; leaf++) {
        for (int c = 0; c < optical_channel_count; c++) m->tau[c] = leaf ? 0.4f - 0.03f * (float)c : 0;
        m->tau_mwir = leaf ? 0.15f : 0, m->tau_lwir = leaf ? 0.05f : 0;
        hand_draw = 9;
        p.hits.count = 40;
        for (int i = 0; i < 40; i++) {
            double n[3], d[3];
            hand_direction(n), hand_direction(d);
            for (int c = 0; c < 3; c++) p.hits.n_enu[c][i] = (float)n[c], p.rays.d_enu[c][i] = d[c];
            p.hits.range_m[i] = i % 5 ? 4 : INFINITY, p.hits.material[i] = 1;
            p.sun[i] = i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : 0.4f, p.temp_k[i] = 280 + (float)i;
        }
        for (int k = 0; k < 40 * AIR_BAND_COUNT * 2; k++) {
            const int    i = k % 40, b = k / 40 % AIR_BAND_COUNT, last = k / 40 / AIR_BAND_COUNT;
            const double n[3] = {p.hits.n_enu[0][i], p.hits.n_enu[1][i], p.hits.n_enu[2][i]}, facing = v3_dot(n, sun);
            const double r = (double)(b == AIR_MWIR   ? m->rho_mwir
                                      : b == AIR_LWIR ? m->rho_lwir
                                                      : m->rho[b]),
                         t = (double)(b == AIR_MWIR   ? m->tau_mwir
                                      : b == AIR_LWIR ? m->tau_lwir
                                                      : m->tau[b]);
            double want = 0, rho;
            if (i % 5 == 0) want = p.rays.d_enu[2][i] < 0 ? ground : sky[b];
            else {
                if (b != AIR_LWIR) want += (facing > 0 ? r : t) * fabs(facing) * 500 / pi_rad * (double)p.sun[i];
                if (b >= AIR_MWIR)
                    want += (1 - r - t) * planck_table_radiance(b == AIR_MWIR ? stage.mwir : stage.lwir, p.temp_k[i]);
                if (last)
                    want += r * (0.5 * (1 + n[2]) * sky[b] + 0.5 * (1 - n[2]) * ground) +
                            t * (0.5 * (1 - n[2]) * sky[b] + 0.5 * (1 + n[2]) * ground);
            }
            CHECK_NEAR(hemisphere_met(&rho, &p, i, &scene, (AirBand)b, ground, last), want, 2e-5 * fmax(want, 1));
            CHECK_NEAR(rho, i % 5 ? r : 0, 1e-7);
        }
    }
    *m = (Material){0};
}

/* A leaf that returns 0.8 and lets 0.2 through, absorbing nothing, is not seen between even surroundings, although
 * paths go on to either side of it as often, with double weight: a sphere of it that hides a quarter of the sky. */
static void leaves_scatter_to_both_sides(void **state)
{
    (void)state;
    static Hits            hits;
    static HemisphereLight gathered;
    VisibilityCounters     counters = {0};
    double                 sky[AIR_BAND_COUNT], sum = 0;
    for (int b = 0; b < AIR_BAND_COUNT; b++) sky[b] = 1;
    air_even(&stage.air, (const double[3]){0, 0.6, -0.8}, 0, sky, 0, stage.mwir, stage.lwir);
    set_rho(1, 0.8);
    for (int c = 0; c < optical_channel_count; c++) stage.rows[2].tau[c] = 0.2f;
    hits.count = 8;
    for (int i = 0; i < hits.count; i++)
        hits.range_m[i] = 10, hits.n_enu[2][i] = hits.n_geo[2][i] = 1, hits.material[i] = 1;
    const HemisphereScene scene = {stage.visibility, &stage.air, &stage.materials, NULL, &stage.snapshot};
    hemisphere_light(&gathered, &scene, &hits, 1 << AIR_R, 4096, keys(5), &counters);
    for (int i = 0; i < hits.count; i++) sum += (double)gathered.w_m2[AIR_R][i] / pi_rad / hits.count;
    CHECK_NEAR(sum, 1, 0.006); /* three times the noise of its choices */
    stage.rows[2] = (Material){0};
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_over_a_plane),          cmocka_unit_test(even_worlds_stay_even),
        cmocka_unit_test(same_question_same_bits),      cmocka_unit_test(paths_bring_what_they_met),
        cmocka_unit_test(leaves_scatter_to_both_sides), cmocka_unit_test(wall_in_its_own_shadow),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
