/* tests/render/hand_plants.h: prototypes and a stand made by hand: every kind is a trunk, some branches and leaves at
 * random, and plants stand where a test puts them. */
#ifndef TESTS_RENDER_HAND_PLANTS_H
#define TESTS_RENDER_HAND_PLANTS_H

#include "render/trace/plants/forest.h"

#include <stdlib.h>

enum { hand_branches = 12, hand_leaves = 150, hand_quads = 6 * hand_branches + hand_leaves };

static PlantQuad   hand_quad[PLANT_KINDS][plant_levels][hand_quads];
static LeafPattern hand_pattern[PLANT_STANDING][plant_outlines];
static Plants      hand_plants = {.patterned = PLANT_STANDING, .pattern = hand_pattern};

static double hand_dice(uint32_t stream, uint64_t index) { return random_uniform(77, stream, 0, index); }

/* A prism of six sides from a to b, both level hexagons, so that each side is flat. */
static void hand_prism(PlantQuad *out, const double a[3], const double b[3], double radius_a, double radius_b,
                       int piece)
{
    for (int k = 0; k < 6; k++) {
        const double *end[2] = {a, b}, radius[2] = {radius_a, radius_b};
        PlantQuad     q = {.organ = PLANT_BARK,
                           .piece = (uint16_t)piece,
                           .radius = (float)radius_a,
                           .open_up = 0.5f,
                           .open_down = 0.5f};
        for (int c = 0; c < 4; c++) {
            const double turn = (k + (c == 1 || c == 2)) * pi_rad / 3;
            const int    top = c >= 2;
            const double p[3] = {end[top][0] + radius[top] * cos(turn), end[top][1] + radius[top] * sin(turn),
                                 end[top][2]};
            for (int x = 0; x < 3; x++) q.corner[c][x] = (float)p[x];
            q.n[c][0] = (float)cos(turn), q.n[c][1] = (float)sin(turn);
        }
        out[k] = q;
    }
}

static void hand_leaf(PlantQuad *out, const double at[3], const double n[3], double size, int piece)
{
    double u[3], v[3];
    v3_cross(u, n, fabs(n[2]) < 0.9 ? (const double[3]){0, 0, 1} : (const double[3]){1, 0, 0});
    v3_normalize(u, u);
    v3_cross(v, n, u);
    *out = (PlantQuad){.organ = PLANT_LEAF,
                       .outline = (uint8_t)(piece % plant_outlines),
                       .piece = (uint16_t)piece,
                       .open_up = 0.5f,
                       .open_down = 0.5f};
    for (int c = 0; c < 4; c++)
        for (int x = 0; x < 3; x++) {
            const double s = c == 1 || c == 2 ? 0.5 : -0.5, t = c >= 2 ? 0.5 : -0.5;
            out->corner[c][x] = (float)(at[x] + size * (s * u[x] + t * v[x]));
            out->n[c][x] = (float)n[x];
        }
}

static void hand_plant_direction(double d[3], uint32_t stream, uint64_t index)
{
    const double z = 2 * hand_dice(stream, 2 * index) - 1, turn = 2 * pi_rad * hand_dice(stream, 2 * index + 1);
    d[0] = sqrt(1 - z * z) * cos(turn), d[1] = sqrt(1 - z * z) * sin(turn), d[2] = z;
}

/* whole: outlines are the whole card; else diamonds with a notch. size: of leaves. */
static inline void hand_grow(bool whole, double size)
{
    static const float diamond[5][2] = {{0.5f, 0}, {1, 0.5f}, {0.55f, 0.6f}, {0.5f, 1}, {0, 0.5f}};
    for (int kind = 0; kind < PLANT_KINDS; kind++) {
        for (int o = 0; o < plant_outlines; o++) {
            LeafOutline *out = &hand_plants.outline[kind][o];
            out->corners = whole ? 4 : 5;
            for (int k = 0; k < out->corners; k++)
                for (int c = 0; c < 2; c++)
                    out->uv[k][c] = whole ? (float)((c == 0 ? k == 1 || k == 2 : k >= 2)) : diamond[k][c];
            hand_plants.outline_area[kind][o] = whole ? 1 : 0.5f;
        }
        for (int o = 0; o < plant_outlines && kind < PLANT_STANDING; o++) { /* two leaves: stripes along the card */
            LeafPattern *out = &hand_plants.pattern[kind][o];
            out->leaflets = 2, out->area = 0.5f;
            for (int j = 0; j < plant_pattern_side; j++)
                for (int i = 0; i < plant_pattern_side; i++)
                    out->leaflet[j][i] = (uint8_t)(i * 4 / plant_pattern_side == o % 4         ? 1
                                                   : i * 4 / plant_pattern_side == (o + 2) % 4 ? 2
                                                                                               : 0);
            for (int l = 0; l < 2; l++) {
                out->foot[l][0] = out->tip[l][0] = 0.25f * ((float)((o + 2 * l) % 4) + 0.5f);
                out->foot[l][1] = 0, out->tip[l][1] = 1;
            }
        }
        for (int level = 0; level < plant_levels; level++) {
            PlantShape *s = &hand_plants.shape[kind][level];
            PlantQuad  *q = hand_quad[kind][level];
            const int   branches = level == plant_simple ? hand_branches / 3 : hand_branches,
                      leaves = level == plant_simple ? hand_leaves / 5 : hand_leaves;
            const uint64_t of = (uint64_t)kind * 1000;
            hand_prism(q, (const double[3]){0, 0, 0}, (const double[3]){0.01, 0, 0.7}, 0.03, 0.01, 0);
            for (int b = 1; b < branches; b++) {
                const double z = 0.3 + 0.6 * hand_dice(1, of + (uint64_t)b),
                             turn = 2 * pi_rad * hand_dice(2, of + (uint64_t)b);
                const double a[3] = {0, 0, z}, e[3] = {0.25 * cos(turn), 0.25 * sin(turn), z + 0.1};
                hand_prism(q + 6 * b, a, e, 0.012, 0.004, b);
            }
            for (int l = 0; l < leaves; l++) {
                double at[3], n[3];
                hand_plant_direction(n, 3, of + (uint64_t)l);
                hand_plant_direction(at, 4, of + (uint64_t)l);
                for (int c = 0; c < 3; c++) at[c] = 0.28 * at[c] + (c == 2 ? 0.7 : 0);
                hand_leaf(q + 6 * branches + l, at, n, level == plant_simple ? size * 2 : size, l);
            }
            *s = (PlantShape){.quads = 6 * branches + leaves,
                              .pieces = branches,
                              .leaves = leaves,
                              .quad = q,
                              .bark_quads = 6 * branches,
                              .crown_low = 0.4f,
                              .crown_radius = 0.28f,
                              .leaf_area =
                                  (float)(leaves * size * size * (level == plant_simple ? 4 : 1) * (whole ? 1 : 0.5))};
            for (int c = 0; c < 3; c++) s->low[c] = INFINITY, s->high[c] = -INFINITY;
            for (int k = 0; k < s->quads; k++)
                for (int c = 0; c < 12; c++) {
                    s->low[c % 3] = fminf(s->low[c % 3], q[k].corner[c / 3][c % 3]);
                    s->high[c % 3] = fmaxf(s->high[c % 3], q[k].corner[c / 3][c % 3]);
                }
        }
    }
}

/* count plants at random over a square of half_m, about origin. */
static inline Woods hand_stand(Plant *plant, int count, const double origin_enu[3], double half_m)
{
    static uint32_t first[2];
    first[1] = (uint32_t)count;
    for (int i = 0; i < count; i++) {
        const uint64_t n = (uint64_t)i;
        plant[i] = (Plant){.p_m = {(float)(half_m * (2 * hand_dice(10, n) - 1)),
                                   (float)(half_m * (2 * hand_dice(11, n) - 1)), (float)(2 * hand_dice(12, n))},
                           .height = (uint16_t)(600 + 1200 * hand_dice(13, n)),
                           .twist = (uint16_t)(65535 * hand_dice(14, n)),
                           .lean = {(int8_t)(250 * (hand_dice(15, n) - 0.5)), (int8_t)(250 * (hand_dice(16, n) - 0.5))},
                           .kind = (uint8_t)(hand_dice(17, n) * PLANT_STANDING),
                           .width = (uint8_t)(90 + 80 * hand_dice(18, n))};
    }
    Woods woods = {.nx = 1, .ny = 1, .first = first, .count = count, .plant = plant};
    memcpy(woods.origin_enu, origin_enu, sizeof woods.origin_enu);
    return woods;
}

#endif
