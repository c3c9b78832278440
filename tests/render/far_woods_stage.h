/* tests/render/far_woods_stage.h: stands of far woods that are made by hand, under a sky that is brighter above and
 * away from the sun. Every number of a stand is another one, so that none can stand in another's place. */
#ifndef TESTS_RENDER_FAR_WOODS_STAGE_H
#define TESTS_RENDER_FAR_WOODS_STAGE_H

#include "tests/check.h"

#include "render/heat/heat.h"
#include "render/light/far_woods.h"
#include "render/light/thermal.h"

#include <string.h>

enum { row_ground = 1, row_scrub, row_leaf, row_bark, row_canopy, rows_count = row_canopy + far_stands };

static PlanckTable *mwir, *lwir;
static Arena       *arena;
static Plants      *plants;
static Material     rows[rows_count];
static Materials    materials = {.count = row_canopy, .material = rows, .more = far_stands};
static WoodStand    stand[far_stands][far_densities];
static FarWoods     far;
static Air          air;

static const double view_deg[stand_views] = {4, 10, 20, 36, 60, 90}, sun_deg[stand_suns] = {4, 10, 20, 36, 60, 90},
                    azimuth_deg[stand_azimuths] = {0, 25, 65, 115, 180};
static const double open_up = 0.55, open_down = 0.35; /* of the canopy's own leaves */

static double draw(double low, double high)
{
    static uint64_t n;
    return low + (high - low) * random_uniform(38, 2, 0, n++);
}

static Material material_of_any(double bright)
{
    Material m = {.rho_mwir = (float)draw(0.05, 0.1),
                  .rho_lwir = (float)draw(0.02, 0.06),
                  .solar_absorptance = 0.5f,
                  .radar_gamma = (float)draw(0.05, 0.2)};
    for (int c = 0; c < optical_channel_count; c++) m.rho[c] = (float)(bright * draw(0.5, 1));
    return m;
}

static CanopyPlace place_of_any(void)
{
    return (CanopyPlace){draw(0.2, 0.9), draw(0.2, 0.9), draw(0.2, 0.9), draw(0.2, 0.9), draw(0.2, 0.9), .low = 1};
}

static StandOrgan organ_of_any(double share)
{
    const double bright = share * draw(0.9, 1.1);
    StandOrgan   o = {.share = share,
                      .bright = bright,
                      .front_up = bright * draw(0.2, 0.4),
                      .front_down = bright * draw(0.05, 0.2),
                      .back_up = bright * draw(0.05, 0.2),
                      .back_down = bright * draw(0.1, 0.3),
                      .n = {draw(0.2, 0.6), draw(0.1, 0.5)},
                      .open = draw(0.2, 0.8),
                      .radius_m = 0.012};
    return o;
}

static void fill_stand(WoodStand *s)
{
    s->leaf = material_of_any(0.4), s->bark = material_of_any(0.2), s->bark_row = row_bark;
    s->leaf.tau_mwir = 0.03f, s->leaf.tau_lwir = 0.02f;
    for (int c = 0; c < optical_channel_count; c++) s->leaf.tau[c] = (float)draw(0.1, 0.3);
    s->top_m = draw(10, 20);
    for (int v = 0; v < stand_views; v++) {
        StandView   *of = &s->view[v];
        const bool   bare = s == &stand[1][1] && v == stand_views - 1; /* of which from above nearly nothing is seen */
        const double leaf = bare ? 0.03 : draw(0.5, 0.6), bark = bare ? 0.02 : draw(0.1, 0.2);
        of->leaf = organ_of_any(leaf), of->bark = organ_of_any(bark);
        of->ground = 1 - leaf - bark, of->ground_up = draw(0.2, 0.6), of->ground_open = draw(0.2, 0.6);
        for (int k = 0; k < stand_suns; k++) {
            of->ground_through[k] = draw(0.1, 0.9);
            of->among[k] = place_of_any(), of->on_ground[k] = place_of_any();
            for (int a = 0; a < stand_azimuths; a++)
                s->lit[v][k][a] = (StandLit){leaf * draw(0.2, 0.6), leaf * draw(0.1, 0.4), leaf * draw(0.1, 0.4),
                                             bark * draw(0.1, 0.4), of->ground * draw(0.2, 0.9)};
        }
    }
    /* one whose leaves face no way, and one whose bark sees more than all, as numbers of a few rays may */
    s->view[1].leaf.n[0] = s->view[1].leaf.n[1] = 0;
    s->view[3].bark.n[1] = 0.8, s->view[4].bark.n[1] = -0.7; /* and bark that leans far */
    s->view[2].bark.front_up = 1.1 * s->view[2].bark.bright;
}

/* A canopy whose leaves scatter w = (0.5 (0.5 + 0.3) + 0.25 0.2) / 0.75 = 0.6: a leaf and a branch of equal area. */
static const double scattered = 0.6;
static Status       canopy_by_hand(Canopy **out)
{
    static PlantQuad quad[2];
    static uint32_t  first[2];
    const Woods      woods = {.nx = 1, .ny = 1, .first = first, .by_kind = {[PLANT_BIRCH] = 1}};
    for (int k = 0; k < 2; k++)
        quad[k] = (PlantQuad){.corner = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                              .organ = k ? PLANT_LEAF : PLANT_BARK,
                              .open_up = (float)open_up,
                              .open_down = (float)open_down};
    for (int c = 0; c < optical_channel_count; c++)
        rows[row_leaf].rho[c] = 0.5f, rows[row_leaf].tau[c] = 0.3f, rows[row_bark].rho[c] = 0.2f;
    for (int kind = 0; kind < PLANT_KINDS; kind++) {
        materials.plant[kind][PLANT_LEAF] = row_leaf, materials.plant[kind][PLANT_BARK] = row_bark;
        plants->shape[kind][plant_whole] = (PlantShape){.quads = 2, .quad = quad, .bark_quads = 1};
        for (int o = 0; o < plant_outlines; o++) plants->outline_area[kind][o] = 1;
    }
    return canopy_create(out, &woods, plants, &materials, true);
}

static int open_stands(void **state)
{
    (void)state;
    if (planck_table_create(&mwir, 3.4e-6, 4.8e-6) != STATUS_OK ||
        planck_table_create(&lwir, 8e-6, 12e-6) != STATUS_OK || !(arena = arena_create()) ||
        !(plants = calloc(1, sizeof *plants)))
        return -1;
    rows[row_ground] = material_of_any(0.2), rows[row_scrub] = material_of_any(0.3);
    for (int c = 0; c < optical_channel_count; c++) materials.ground_rho[c] = (float)draw(0.1, 0.3);
    materials.surface[SURFACE_FOREST_BROADLEAF] = materials.surface[SURFACE_FOREST_CONIFER] = row_ground;
    materials.surface[SURFACE_SCRUB] = row_scrub;
    for (int k = 0; k < far_stands; k++) {
        rows[row_canopy + k] = material_of_any(0.3), far.row[k] = row_canopy + k;
        for (int p = 0; p < far_densities; p++) {
            fill_stand(&stand[k][p]), far.stand[k][p] = &stand[k][p];
            if (canopy_by_hand(&stand[k][p].canopy) != STATUS_OK) return -1;
        }
    }
    return 0;
}

static int close_stands(void **state)
{
    (void)state;
    for (int k = 0; k < far_stands * far_densities; k++)
        canopy_destroy(stand[k / far_densities][k % far_densities].canopy);
    planck_table_destroy(mwir), planck_table_destroy(lwir);
    arena_destroy(arena);
    free(plants);
    return 0;
}

/* A sky that is brighter above, and away from the sun. */
static void set_air(double sun_elevation_deg, double sun_azimuth_deg, bool thermal)
{
    const double e = sun_elevation_deg * rad_per_deg, a = sun_azimuth_deg * rad_per_deg,
                 sun[3] = {cos(e) * cos(a), cos(e) * sin(a), sin(e)};
    double sky[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        sky[b] = b < AIR_MWIR ? 20 + 3 * b : thermal ? 0.5 + 20 * (b - AIR_MWIR) : 0;
    air_even(&air, sun, 500, sky, 0, mwir, lwir);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        air.light.sun_w_m2[b] = b == AIR_LWIR || !(sun_elevation_deg > 0) ? 0 : 500 + 20 * b;
        for (int i = 0; i <= air_plane_ups; i++)
            for (int k = 0; k <= air_plane_azimuths; k++)
                air.light.plane_w_m2[b][i][k] *=
                    0.6f + 0.4f * (float)i / air_plane_ups + 0.3f * (float)k / air_plane_azimuths;
    }
    air.light.ground_w_m2_sr[AIR_LWIR] = 33;
    air.light.longwave_loss_w_m2 = 80;
}

#endif
