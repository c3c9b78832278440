/* render/trace/plants/plants_spray.c: the finest level: a spray of plant_whole dissolved into small cards about a
 * shoot.
 *
 * A card of plant_whole stands for a shoot with some dozens of leaves. Here the leaves stand about the shoot's axis, by
 * the golden angle, on cards of a few leaves each whose size is the species' own at the kind's usual height; as many as
 * the spray has leaf area. */
#include "render/trace/plants/plants_private.h"

typedef struct SprayForm {
    double usual_m; /* height of the plant for which card_m is meant: the middle of etc/woods.csv */
    double card_m;  /* length; leaves are 0.45 of it (plants_pattern.c) */
    double aspect;  /* width over length */
    double round;   /* of the spray about its axis, over the width of the card it takes the place of */
    double open;    /* of the cards, from the shoot's axis, rad */
} SprayForm;

/* Leaves of field guides: alder 4 .. 9 cm, birch 3 .. 6, English and sessile oak 7 .. 14, red and white oak 10 .. 20;
 * needles of pine 4 .. 7. */
static const SprayForm spray_form[PLANT_STANDING] = {
    [PLANT_PINE] = {20, 0.16, 1.0, 0.45, 0.7},       [PLANT_ALDER] = {18, 0.18, 0.9, 0.7, 1.0},
    [PLANT_BIRCH] = {18, 0.15, 0.9, 0.7, 0.9},       [PLANT_ENGLISH_OAK] = {18, 0.20, 0.9, 0.7, 1.0},
    [PLANT_SESSILE_OAK] = {18, 0.20, 0.9, 0.7, 1.0}, [PLANT_RED_OAK] = {18, 0.24, 0.9, 0.7, 1.0},
    [PLANT_WHITE_OAK] = {18, 0.22, 0.9, 0.7, 1.0},   [PLANT_BUSH] = {2.2, 0.12, 0.9, 0.7, 0.9},
    [PLANT_HEDGE] = {1.6, 0.10, 0.9, 0.7, 0.9},
};

static const double golden_rad = 2.39996322972865332;

void grow_spray(Growth *g, const double at[3], const double along[3], const double n[3], double length, double width)
{
    const SprayForm *f = &spray_form[g->kind];
    const double     card = f->card_m / f->usual_m * g->height, size[2] = {card, f->aspect * card};
    double           axis[3], u[3], v[3];
    memcpy(axis, along, sizeof axis);
    if (!v3_normalize(axis, axis)) return;
    v3_cross(u, axis, n);
    if (!v3_normalize(u, u)) {
        v3_cross(u, axis, fabs(axis[2]) < 0.9 ? (const double[3]){0, 0, 1} : (const double[3]){1, 0, 0});
        v3_normalize(u, u);
    }
    v3_cross(v, u, axis);
    g->owed += length * width * g->outline_area / (size[0] * size[1] * g->pattern_area);
    const int    cards = (int)g->owed;
    const double first = grow_draw_fine(g, 0, 2 * pi_rad);
    /* leaves of the crown's mantle face the light */
    const double outwards = 0.6 / fmax(sqrt(at[0] * at[0] + at[1] * at[1]), 1e-3);
    g->owed -= cards;
    for (int k = 0; k < cards; k++) {
        const double share = (k + grow_draw_fine(g, 0, 1)) / cards, turn = first + golden_rad * k;
        const double round = f->round * width * sqrt(fmax(1 - (2 * share - 1) * (2 * share - 1), 0.1));
        const double out = round * grow_draw_fine(g, 0, 1), open = f->open * grow_draw_fine(g, 0.6, 1.3);
        const double larger = grow_draw_fine(g, 0.8, 1.2);
        double       foot[3], way[3], face[3];
        for (int x = 0; x < 3; x++) {
            const double aside = cos(turn) * u[x] + sin(turn) * v[x];
            foot[x] = at[x] + (1.15 * share - 0.55) * length * axis[x] + out * aside;
            way[x] = cos(open) * axis[x] + sin(open) * aside + grow_draw_fine(g, -0.25, 0.25);
            face[x] = 0.4 * n[x] + grow_draw_fine(g, -1, 1) + (x == 2 ? 0.3 : outwards * at[x]);
        }
        grow_card(g, foot, way, face, (const double[2]){larger * size[0], larger * size[1]},
                  (int)(grow_draw_fine(g, 0, 1) * plant_outlines));
    }
}
