/* Stands of far woods (render/light/far_woods.h) of plants so simple that what is seen and lit of them is known on
 * paper: bare ground under a spread canopy, upright plates, level plates that hide all. labels: physics */
#include "tests/check.h"

#include "render/light/far_woods.h"

#include <stdlib.h>
#include <string.h>

enum { row_bark = 1, row_pine_leaf, row_leaf, rows_before, rows_most = rows_before + far_stands };

static Plants   *plants;
static PlantQuad quads[2], pine_quads[2];
static Material  first_rows[rows_before];
static Materials materials;
static Plant     one = {.kind = PLANT_BIRCH, .height = 1000, .width = 128};
static uint32_t  first[2] = {0, 1};
static Woods one_plant = {.nx = 1, .ny = 1, .first = first, .count = 1, .plant = &one, .by_kind = {[PLANT_BIRCH] = 1}};

static const double open_up = 0.6, open_down = 0.3;
static const double sun_deg[stand_suns] = {4, 10, 20, 36, 60, 90}, view_deg[stand_views] = {4, 10, 20, 36, 60, 90},
                    azimuth_deg[stand_azimuths] = {0, 25, 65, 115, 180};

static int open_stage(void **state)
{
    (void)state;
    plants = calloc(1, sizeof *plants);
    return plants ? 0 : -1;
}

static int close_stage(void **state)
{
    (void)state;
    free(plants);
    return 0;
}

/* A parallelogram about a point of the axis, u and v its sides. */
static PlantQuad plate(PlantOrgan organ, const double middle[3], const double u[3], const double v[3])
{
    PlantQuad q = {.organ = (uint8_t)organ,
                   .radius = organ == PLANT_BARK ? 0.02f : 0,
                   .open_up = (float)open_up,
                   .open_down = (float)open_down};
    double    n[3];
    v3_cross(n, u, v);
    v3_normalize(n, n);
    for (int c = 0; c < 4; c++)
        for (int x = 0; x < 3; x++) {
            q.corner[c][x] = (float)(middle[x] + (c == 1 || c == 2 ? 0.5 : -0.5) * u[x] + (c >= 2 ? 0.5 : -0.5) * v[x]);
            q.n[c][x] = (float)n[x];
        }
    return q;
}

/* Every kind is these quads, at both levels of detail. */
static void grow(int bark, int leaves, double leaf_area, double crown_radius)
{
    for (int kind = 0; kind < PLANT_KINDS; kind++) {
        for (int o = 0; o < plant_outlines; o++) {
            plants->outline[kind][o] = (LeafOutline){.corners = 4, .uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
            plants->outline_area[kind][o] = 1;
        }
        for (int level = 0; level < plant_levels; level++) {
            PlantShape *s = &plants->shape[kind][level];
            PlantQuad  *of = kind == PLANT_PINE && pine_quads[0].radius > 0 ? pine_quads : quads;
            *s = (PlantShape){.quads = bark + leaves,
                              .pieces = bark,
                              .leaves = leaves,
                              .quad = of,
                              .bark_quads = bark,
                              .leaf_area = (float)leaf_area,
                              .crown_radius = (float)crown_radius};
            for (int c = 0; c < 3; c++) s->low[c] = INFINITY, s->high[c] = -INFINITY;
            for (int k = 0; k < 12 * s->quads; k++) {
                const float at = of[k / 12].corner[k / 3 % 4][k % 3];
                s->low[k % 3] = fminf(s->low[k % 3], at), s->high[k % 3] = fmaxf(s->high[k % 3], at);
            }
        }
    }
}

static void open_materials(void)
{
    materials = (Materials){.count = rows_before, .material = malloc(sizeof first_rows)};
    assert_non_null(materials.material);
    for (int r = 1; r < rows_before; r++) {
        Material *m = &first_rows[r];
        *m = (Material){.rho_mwir = 0.01f * (float)r,
                        .rho_lwir = 0.02f * (float)r,
                        .tau_mwir = r == row_bark ? 0 : 0.03f * (float)r,
                        .tau_lwir = r == row_bark ? 0 : 0.04f * (float)r,
                        .solar_absorptance = 0.2f * (float)r,
                        .radar_gamma = 0.1f * (float)r};
        for (int c = 0; c < optical_channel_count; c++) {
            m->rho[c] = 0.1f * (float)r + 0.01f * (float)c;
            m->tau[c] = r == row_bark ? 0 : 0.05f * (float)r + 0.02f * (float)c;
        }
    }
    memcpy(materials.material, first_rows, sizeof first_rows);
    for (int kind = 0; kind < PLANT_KINDS; kind++) {
        materials.plant[kind][PLANT_BARK] = row_bark;
        materials.plant[kind][PLANT_LEAF] = kind == PLANT_PINE ? row_pine_leaf : row_leaf;
    }
}

static Forest *open_forest_as(const ForestConfig *config)
{
    Forest *forest = NULL;
    assert_int_equal(forest_create(&forest, &one_plant, plants, config, "avx2"), STATUS_OK);
    return forest;
}

static Forest *open_forest(void) { return open_forest_as(&(ForestConfig){.leaves = true, .level1_px = 24}); }

/* Leaf area index of a stand whose prototypes have leaves of this area at a height of 1 m, and the share of pines in
 * it. */
static double index_of(double *pines, SurfaceClass surface, double density, double area)
{
    Woods  woods;
    double sum[2] = {0};
    assert_int_equal(woods_of_class(&woods, surface, density, 1995, 8), STATUS_OK);
    for (int k = 0; k < woods.count; k++) {
        const double h = plant_height_m(&woods.plant[k]);
        sum[woods.plant[k].kind == PLANT_PINE] += area * h * h * woods.plant[k].width / 128;
    }
    woods_destroy(&woods);
    *pines = sum[1] / (sum[0] + sum[1]);
    return (sum[0] + sum[1]) / (512.0 * 512.0);
}

static WoodStand *stand_of(SurfaceClass surface, double density, int bark, int leaves, double leaf_area,
                           double crown_radius)
{
    WoodStand *stand = NULL;
    grow(bark, leaves, leaf_area, crown_radius);
    Forest *forest = open_forest();
    assert_int_equal(far_stand_create(&stand, surface, density, forest, &materials, true, NULL), STATUS_OK);
    forest_destroy(forest);
    return stand;
}

/* ---- ground ----------------------------------------------------------------------------------- */

/* Leaves so small that no ray meets them, but taken for an even layer of index L by the canopy: the ground is all that
 * is seen, the sun reaches all of it, and a share 2 E3(L / 2) of the sky, exp(-L / (2 sin h)) of the sun is let
 * through. The layer's index is kept in steps of 1/16, so within 3 % and for low suns more. */
static void ground_under_an_even_layer(void **state)
{
    (void)state;
    open_materials();
    quads[0] =
        plate(PLANT_LEAF, (const double[3]){0, 0, 0.5}, (const double[3]){1e-4, 0, 0}, (const double[3]){0, 1e-4, 0});
    double       pines;
    const double index = index_of(&pines, SURFACE_FOREST_BROADLEAF, 1, 0.08), gap = canopy_gap(0.5 * index);
    WoodStand   *stand = stand_of(SURFACE_FOREST_BROADLEAF, 1, 0, 1, 0.08, 3.5);
    print_message("leaf area index %.3f, share of the sky %.3f\n", index, gap);
    CHECK(stand->top_m == 0 && stand->bark_row == 0 && stand->leaf.rho[0] == 0);
    for (int v = 0; v < stand_views; v++) {
        const StandView *of = &stand->view[v];
        CHECK(of->ground == 1 && of->leaf.share == 0 && of->bark.share == 0 && of->sees_leaves == 0 &&
              of->leaf.open == 0);
        for (int k = 0; k < stand_suns; k++)
            for (int a = 0; a < stand_azimuths; a++)
                CHECK(stand->lit[v][k][a].ground == 1 && stand->lit[v][k][a].leaf == 0);
        if (v == 0) continue; /* from 4 degrees some rays end beyond the stand */
        CHECK_NEAR(of->ground_up, gap, 0.03 * gap);
        CHECK_NEAR(of->ground_open, gap, 0.03 * gap);
        for (int k = 0; k < stand_suns; k++) {
            const double       sine = sin(sun_deg[k] * rad_per_deg), through = exp(-0.5 * index / sine);
            const double       within = 0.03 * index / sine;
            const CanopyPlace *p = &of->on_ground[k];
            CHECK_NEAR(of->ground_through[k] / through, 1, within);
            CHECK_NEAR(p->sun_on_ground / through, 1, k == 0 ? 0.6 : within);
            /* sky and sun of the leaves that it sees: the mean of exp(-s x) weighted by exp(-d (1 - x)) */
            const double d = -log(gap), s = 0.5 * index / sine;
            CHECK_NEAR(p->sun_here / (d * (through - gap) / ((1 - gap) * (d - s))), 1, 0.05);
            CHECK_NEAR(p->up, d * gap / (1 - gap), 0.03);
            CHECK_NEAR(p->up_from_ground, gap, 0.03 * gap);
            CHECK_NEAR(p->down, 1, 1e-6);
        }
    }
    far_stand_destroy(stand);
    free(materials.material);
}

/* ---- level plates ----------------------------------------------------------------------------- */

/* Level leaves that hide the ground several times over, which plants of a few degrees of lean tilt a little: their
 * fronts face the sky, their backs the ground, to 1 - cos(4 deg) / 2. Their own plant leaves them open_up of the sky
 * and open_down of the ground, and so does the mean of the canopy. High suns reach nearly all that is seen from above.
 */
static void level_leaves(void **state)
{
    (void)state;
    open_materials();
    quads[0] =
        plate(PLANT_LEAF, (const double[3]){0, 0, 0.8}, (const double[3]){1.2, 0, 0}, (const double[3]){0, 1.2, 0});
    WoodStand *stand = stand_of(SURFACE_FOREST_BROADLEAF, 1, 0, 1, 0, 0.6);
    CHECK(stand->top_m > 0.8 * 9 && stand->top_m < 0.8 * 24 + 2);
    for (int v = 0; v < stand_views; v++) {
        const StandView  *of = &stand->view[v];
        const StandOrgan *o = &of->leaf;
        const double      tilted = v < 2 ? 0.1 : 0.006; /* a low eye sees some backs, too */
        CHECK(o->share == 1 && of->ground == 0 && of->bark.share == 0);
        CHECK_NEAR(o->bright, 1, 0.02); /* leaves differ, by 1 in the mean */
        CHECK_NEAR(o->front_up, o->bright * open_up, tilted);
        CHECK_NEAR(o->back_down, o->bright * open_down, tilted);
        CHECK(o->back_up >= 0 && o->back_up < tilted && o->front_down >= 0 && o->front_down < tilted);
        CHECK_NEAR(o->n[1], 1, tilted);
        CHECK_NEAR(o->n[0], 0, 0.03 + tilted);
        CHECK_NEAR(o->open, open_up, 1e-6);
        CHECK(fabs(o->radius_m - 1e-3) < 1e-9); /* leaves have none: the least */
        CHECK_NEAR(of->sees_leaves, stand_rays * (2 - open_up - open_down), 1e-3);
        for (int k = 0; k < stand_suns; k++) {
            const CanopyPlace *p = &of->among[k];
            CHECK_NEAR(p->up, open_up, 1e-6);
            CHECK_NEAR(p->down, open_down, 1e-6);
            CHECK_NEAR(p->sun_here, open_up, 1e-6);
            CHECK_NEAR(p->up_from_ground, 1, 1e-6);
            CHECK_NEAR(p->sun_on_ground, 1, 1e-6);
            for (int a = 0; a < stand_azimuths; a++) {
                const StandLit *lit = &stand->lit[v][k][a];
                CHECK(lit->leaf <= 1 && lit->ground == 0 && lit->bark_front == 0);
                CHECK(v < 2 || lit->leaf_back < 0.05 * lit->leaf + 0.02);
                if (k < 2 || v < 2) continue; /* what leans by a few degrees turns away from low ones */
                CHECK_NEAR(lit->leaf_front / lit->leaf, sin(sun_deg[k] * rad_per_deg) * o->bright, 0.04);
            }
        }
        for (int a = 0; a < stand_azimuths; a++) CHECK(v < 4 || stand->lit[v][v][0].leaf > 0.85);
    }
    /* the eye from straight above and the sun there */
    for (int a = 0; a < stand_azimuths; a++) CHECK(stand->lit[stand_views - 1][stand_suns - 1][a].leaf > 0.9);
    far_stand_destroy(stand);
    free(materials.material);
}

/* ---- plates in pairs, low plates -------------------------------------------------------------- */

/* Upright plates lower than a metre: of an index L they hide the ground from the sun as from the eye, of each by itself
 * where these look along different azimuths: exp(-L G / sin h). */
static void low_plates_shade_the_ground(void **state)
{
    (void)state;
    open_materials();
    quads[0] =
        plate(PLANT_LEAF, (const double[3]){0, 0, 0.018}, (const double[3]){1.5, 0, 0}, (const double[3]){0, 0, 0.036});
    double       pines;
    const double index = index_of(&pines, SURFACE_FOREST_BROADLEAF, 1, 1.5 * 0.036);
    WoodStand   *stand = stand_of(SURFACE_FOREST_BROADLEAF, 1, 0, 1, 0, 0.6);
    CHECK(stand->top_m > 0.1 && stand->top_m < 0.8);
    for (int v = 2; v < 5; v++)
        for (int k = 1; k < 3; k++) {
            const double h = sun_deg[k] * rad_per_deg, through = exp(-index * 2 / pi_rad * cos(h) / sin(h));
            for (int a = 2; a < 4; a++)
                CHECK_NEAR(stand->lit[v][k][a].ground / stand->view[v].ground, through,
                           0.17); /* gaps that the eye sees are wide */
        }
    far_stand_destroy(stand);
    free(materials.material);
}

/* Two leaves back to back, a fiftieth of the plant's height apart: little shines on the hidden side of the one that is
 * seen, from above between the two. */
static void double_leaves(void **state)
{
    (void)state;
    open_materials();
    for (int k = 0; k < 2; k++)
        quads[k] = plate(PLANT_LEAF, (const double[3]){0, k ? 0.01 : -0.01, 0.5}, (const double[3]){0.3, 0, 0},
                         (const double[3]){0, 0, 0.8});
    WoodStand *stand = stand_of(SURFACE_FOREST_BROADLEAF, 0.4, 0, 2, 0, 0.2);
    for (int v = 1; v < 5; v++)
        for (int k = 2; k < 5; k++) {
            const StandLit *behind = &stand->lit[v][k][stand_azimuths - 1], *before = &stand->lit[v][k][0];
            CHECK(behind->leaf_back < 0.35 * before->leaf_front && before->leaf_front > 0.05);
        }
    far_stand_destroy(stand);
    free(materials.material);
}

/* ---- upright plates --------------------------------------------------------------------------- */

/* Upright plates of every azimuth, of leaf on one half and bark on the other: of an index L a ray at an elevation e
 * meets none with exp(-L G / sin e), G = (2 / pi) cos e (Ross 1981, vertical leaves). Their normals are seen by the
 * cosine of their azimuth from the eye, so their mean towards it is pi / 4; and a sun at an azimuth a from it and a
 * height h lights the side that is seen by cos h ((pi - a) cos a + sin a) / 4, the other one by cos h (sin a - a cos a)
 * / 4. */
static void upright_plates(const WoodStand *s, double index, double bark_share)
{
    double lit[stand_azimuths][4] = {{0}}, suns = 0;
    for (int v = 1; v < 5; v++) {
        const StandView *of = &s->view[v];
        const double     e = view_deg[v] * rad_per_deg;
        /* dense stands are more even than chance: one plant at most in 16 m2 */
        CHECK_NEAR(of->ground, exp(-index * 2 / pi_rad * cos(e) / sin(e)), 0.08);
        CHECK_NEAR(of->ground + of->leaf.share + of->bark.share, 1, 1e-12);
        for (int k = 0; k < 2; k++) {
            const StandOrgan *o = k ? &of->bark : &of->leaf;
            CHECK_NEAR(o->share, (k ? bark_share : 1 - bark_share) * (1 - of->ground), 0.07);
            CHECK_NEAR(o->bright / o->share, 1, k ? 1e-6 : 0.04);
            CHECK_NEAR(o->front_up / o->bright, 0.5 * open_up, 0.01);
            CHECK_NEAR(o->front_down / o->bright, 0.5 * open_down, 0.01);
            CHECK_NEAR(o->back_up / o->bright, 0.5 * open_up, 0.01);
            CHECK_NEAR(o->back_down / o->bright, 0.5 * open_down, 0.01);
            CHECK_NEAR(o->n[0], pi_rad / 4, 0.06);
            CHECK_NEAR(o->n[1], 0, 0.03);
        }
        CHECK(of->bark.radius_m > 0.02 * 9 && of->bark.radius_m < 0.02 * 26);
        /* a sun overhead reaches all plates, the ground between them too */
        for (int a = 0; a < stand_azimuths; a++) {
            CHECK_NEAR(s->lit[v][stand_suns - 1][a].leaf, of->leaf.share, 0.15 * of->leaf.share);
            CHECK_NEAR(s->lit[v][stand_suns - 1][a].ground, of->ground, 0.3 * of->ground + 0.02);
        }
        for (int k = 2; k < 5; k++)
            for (int a = 0; a < stand_azimuths; a++) {
                const StandLit *l = &s->lit[v][k][a];
                const double    across = cos(sun_deg[k] * rad_per_deg);
                lit[a][0] += l->leaf, lit[a][1] += l->leaf_front / across, lit[a][2] += l->leaf_back / across;
                lit[a][3] += l->bark_front / across;
                suns += l->leaf;
            }
    }
    for (int a = 0; a < stand_azimuths; a++) {
        const double turn = azimuth_deg[a] * rad_per_deg, front = ((pi_rad - turn) * cos(turn) + sin(turn)) / 4,
                     back = (sin(turn) - turn * cos(turn)) / 4;
        CHECK_NEAR(lit[a][1] / lit[a][0], front, 0.06);
        CHECK_NEAR(lit[a][2] / lit[a][0], back, 0.06);
        if (a < 3) CHECK_NEAR(lit[a][3] / lit[a][1] / (bark_share / (1 - bark_share)), 1, 0.25);
    }
}

static const double plate_high = 0.8, plate_wide = 0.3;

/* Of each plate bark is the west's half; pines have three tenths of bark. */
static const double bark_of_pine = 0.3, bark_of_others = 0.5;

static void stand_up(void)
{
    for (int pine = 0; pine < 2; pine++)
        for (int k = 0; k < 2; k++) {
            const double bark = pine ? bark_of_pine : bark_of_others, part = k ? 1 - bark : bark,
                         middle = (k ? bark : bark - 1) / 2 * plate_wide;
            (pine ? pine_quads : quads)[k] =
                plate(k ? PLANT_LEAF : PLANT_BARK, (const double[3]){middle, 0, 0.5},
                      (const double[3]){part * plate_wide, 0, 0}, (const double[3]){0, 0, plate_high});
        }
    grow(1, 1, 0, 0.2);
}

static void rows_are_means(const FarWoods *far)
{
    for (int k = 0; k < far_stands; k++) {
        const Material *leaf = &far->stand[k][1]->leaf, *bark = &far->stand[k][1]->bark,
                       *row = &materials.material[far->row[k]];
        const Material *a = &first_rows[row_leaf], *b = &first_rows[row_pine_leaf], *wood = &first_rows[row_bark];
        const double    share = ((double)leaf->rho[0] - (double)a->rho[0]) / ((double)b->rho[0] - (double)a->rho[0]);
        /* leaves of pines count as often as they are seen */
        double pines;
        index_of(&pines, k ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF, 1.2, 1);
        CHECK_NEAR(share,
                   pines * (1 - bark_of_pine) / (pines * (1 - bark_of_pine) + (1 - pines) * (1 - bark_of_others)),
                   0.03);
        for (int c = 0; c < optical_channel_count; c++) {
            CHECK_NEAR(leaf->rho[c], a->rho[c] + share * (b->rho[c] - a->rho[c]), 1e-5);
            CHECK_NEAR(leaf->tau[c], a->tau[c] + share * (b->tau[c] - a->tau[c]), 1e-5);
            CHECK_NEAR(bark->rho[c], wood->rho[c], 1e-6);
            CHECK_NEAR(row->rho[c], 0.5 * ((double)leaf->rho[c] + (double)leaf->tau[c]), 1e-6);
            CHECK(bark->tau[c] == 0 && row->tau[c] == 0);
        }
#define MEAN(member)                                                                                                   \
    CHECK_NEAR(leaf->member, a->member + share * (b->member - a->member), 1e-6);                                       \
    CHECK_NEAR(bark->member, wood->member, 1e-6)
        MEAN(rho_mwir);
        MEAN(rho_lwir);
        MEAN(tau_mwir);
        MEAN(tau_lwir);
        MEAN(solar_absorptance);
        MEAN(radar_gamma);
        CHECK_NEAR(row->rho_mwir, 0.5 * ((double)leaf->rho_mwir + (double)leaf->tau_mwir), 1e-6);
        CHECK_NEAR(row->rho_lwir, 0.5 * ((double)leaf->rho_lwir + (double)leaf->tau_lwir), 1e-6);
        CHECK(row->tau_mwir == 0 && row->tau_lwir == 0 && row->gloss == 0 && row->roughness == 1);
        CHECK(far->row[k] == rows_before + k && far->stand[k][1]->bark_row == row_bark);
        CHECK(strcmp(row->name, k ? "canopy_of_conifers" : "canopy_of_broadleaves") == 0);
        for (int p = 0; p < far_densities; p++) CHECK(far->stand[k][p]->top_m > 6 && far->stand[k][p]->top_m < 20);
    }
    CHECK(materials.more == far_stands && materials.count == rows_before);
}

static FarWoods *create(const Forest *forest, Cache *cache, const char *name, bool leaves)
{
    FarWoods *far = NULL;
    Woods     woods = {.low = &one};
    open_materials();
    assert_int_equal(far_woods_create(&far, &woods, forest, &materials, leaves, &(PlantsKept){cache, name}, NULL),
                     STATUS_OK);
    assert_non_null(far);
    return far;
}

static void destroy(FarWoods *far)
{
    far_woods_destroy(far);
    free(materials.material);
}

static void *octets_of(size_t *count, const FarWoods *far, int k)
{
    return kept_write(count, far_stand_kept_values, &(StandKept){far->stand[k / 2][k % 2], rows_before});
}

/* The row of bark is one of the materials', else the entry is none. */
static void refuses_other_rows(const void *octets, size_t count, int row)
{
    WoodStand *bare = NULL;
    assert_int_equal(far_stand_create_bare(&bare), STATUS_OK);
    CHECK(kept_read(far_stand_kept_values, &(StandKept){bare, row + 1}, octets, count) && bare->bark_row == row);
    CHECK(!kept_read(far_stand_kept_values, &(StandKept){bare, row}, octets, count));
    bare->bark_row = -1;
    size_t wrong_count;
    void  *wrong = kept_write(&wrong_count, far_stand_kept_values, &(StandKept){bare, row + 1});
    CHECK(wrong && wrong_count == count &&
          !kept_read(far_stand_kept_values, &(StandKept){bare, row + 1}, wrong, count));
    bare->bark_row = 0;
    free(wrong);
    wrong = kept_write(&wrong_count, far_stand_kept_values, &(StandKept){bare, 1});
    CHECK(wrong && kept_read(far_stand_kept_values, &(StandKept){bare, 1}, wrong, count));
    free(wrong);
    far_stand_destroy(bare);
}

/* Of both classes, sparse and dense; kept, and taken for no others. */
static void woods_of_plates(void **state)
{
    (void)state;
    char folder[temp_path_size], command[temp_path_size + 16];
    CHECK(temp_folder(folder));
    Cache *cache = cache_open(folder, 64 << 20);
    CHECK(cache);
    stand_up();
    Forest   *forest = open_forest();
    FarWoods *far = create(forest, cache, "plates", true);
    CHECK(cache_counters(cache).made == 1 && cache_counters(cache).fetched == 0);
    for (int k = 0; k < far_stands; k++)
        for (int p = 0; p < far_densities; p++) {
            const SurfaceClass class = k ? SURFACE_FOREST_CONIFER : SURFACE_FOREST_BROADLEAF;
            double       pines;
            const double index = index_of(&pines, class, p ? 1.2 : 0.4, plate_high * plate_wide);
            upright_plates(far->stand[k][p], index, pines * bark_of_pine + (1 - pines) * bark_of_others);
        }
    rows_are_means(far);
    void  *made[4];
    size_t octets[4];
    for (int k = 0; k < 4; k++) {
        /* the canopy: 64 x 64 cells of 4 octets, and 3 of their sky; one cell more, two tables of 514 gaps, clumping
         * and shares by height of 4, 9 and 9 numbers, its own shadow, two opennesses, a number a channel; two rows
         * without their names */
        made[k] = octets_of(&octets[k], far, k);
        CHECK(octets[k] == 64 * 64 * 7 + 4 + 2 * 514 * 4 + (4 + 9 + 9) * 8 + (3 + optical_channel_count) * 8 +
                               2 * (sizeof(Material) - sizeof first_rows->name) + 4 + 8 +
                               stand_views * sizeof(StandView) + sizeof far->stand[0][0]->lit);
        refuses_other_rows(made[k], octets[k], far->stand[k / 2][k % 2]->bark_row);
    }
    destroy(far);
    far = create(forest, cache, "plates", true);
    CHECK(cache_counters(cache).made == 1 && cache_counters(cache).fetched == 1);
    rows_are_means(far);
    for (int k = 0; k < 4; k++) {
        size_t count;
        void  *kept = octets_of(&count, far, k);
        CHECK(made[k] && kept && count == octets[k] && memcmp(made[k], kept, count) == 0);
        free(made[k]), free(kept);
    }
    destroy(far);
    /* not taken for those of winter */
    destroy(create(forest, cache, "plates", false));
    CHECK(cache_counters(cache).made == 2 && cache_counters(cache).fetched == 1);
    forest_destroy(forest);
    /* nor for those whose plants are traced at another level, since they have tables */
    forest = open_forest_as(&(ForestConfig){.leaves = true, .level1_px = 24, .tables = true});
    destroy(create(forest, cache, "plates", true));
    CHECK(cache_counters(cache).made == 3 && cache_counters(cache).fetched == 1);
    forest_destroy(forest);
    cache_close(cache);
    snprintf(command, sizeof command, "rm -r %s", folder);
    CHECK(system(command) == 0);
    /* woods that have no place outside have none that are far */
    Woods by_hand = {0};
    far = (FarWoods *)&by_hand;
    CHECK(far_woods_create(&far, &by_hand, NULL, &materials, true, &(PlantsKept){NULL, ""}, NULL) == STATUS_OK && !far);
    far_woods_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_under_an_even_layer),
        cmocka_unit_test(low_plates_shade_the_ground),
        cmocka_unit_test(double_leaves),
        cmocka_unit_test(level_leaves),
        cmocka_unit_test(woods_of_plates),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
