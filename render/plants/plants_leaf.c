/* render/plants/plants_leaf.c: outlines of leaves: of a species' own form, each a little different.
 *
 * A card is a spray of leaves, but its outline is that of one leaf of the species, or of a tuft of needles: from near it
 * looks like the species, from afar its area counts. Forms are described by angle about the card's middle, as botany
 * keys do (lobes, their depth and tips): estimates. */
#include "render/plants/plants_private.h"

typedef struct LeafForm {
    int    lobes;      /* on the whole outline; 0: none */
    double depth;      /* of the cuts between them, 0 .. 1 */
    double sharp;      /* 0: round lobes; 1: pointed ones */
    double widest;     /* height of the widest place, 0 .. 1 */
    double slim;       /* half width over half length */
} LeafForm;

static const LeafForm forms[PLANT_KINDS] = {
    [PLANT_PINE] = {11, 0.62, 1, 0.5, 1},            [PLANT_ALDER] = {0, 0, 0, 0.6, 0.85},
    [PLANT_BIRCH] = {11, 0.12, 1, 0.38, 0.8},        [PLANT_ENGLISH_OAK] = {8, 0.42, 0.1, 0.6, 0.75},
    [PLANT_SESSILE_OAK] = {10, 0.3, 0.1, 0.52, 0.75}, [PLANT_RED_OAK] = {8, 0.5, 0.9, 0.52, 0.85},
    [PLANT_WHITE_OAK] = {8, 0.55, 0.2, 0.55, 0.8},   [PLANT_BUSH] = {0, 0, 0, 0.5, 0.7},
    [PLANT_HEDGE] = {6, 0.35, 0.3, 0.55, 0.8},
};

/* Blades: a foot half as wide as the middle, a point at the top. */
static void blade(LeafOutline *out, PlantKind kind, int which, uint64_t seed)
{
    const double bend = random_uniform(seed, 900 + (uint32_t)kind, 1, (uint64_t)which) - 0.5;
    const double at[4] = {0, 0.35, 0.7, 1}, half[4] = {0.25, 0.5, 0.36, 0};
    out->corners = 7;
    for (int k = 0; k < 4; k++) {
        const double middle = 0.5 + 0.2 * bend * at[k] * at[k], wide = fmin(half[k], 0.5 - 0.2 * fabs(bend) * at[k] * at[k]);
        out->uv[k][0] = (float)(middle + wide), out->uv[k][1] = (float)at[k];
        if (k < 3) out->uv[6 - k][0] = (float)(middle - wide), out->uv[6 - k][1] = (float)at[k];
    }
}

void plant_outline(LeafOutline *out, PlantKind kind, int which, uint64_t seed)
{
    const LeafForm *f = &forms[kind];
    if (kind >= PLANT_STANDING) {
        blade(out, kind, which, seed);
        return;
    }
    const int corners = f->lobes ? 2 * f->lobes : 14;
    out->corners = corners < plant_outline_corners_most ? corners : plant_outline_corners_most;
    for (int k = 0; k < out->corners; k++) {
        const double dice = random_uniform(seed, 900 + (uint32_t)kind, 2 + (uint32_t)which, (uint64_t)k) - 0.5;
        const double turn = 2 * pi_rad * (k + 0.3 * dice) / out->corners - 0.5 * pi_rad; /* from the stalk */
        double       r = 1 + 0.12 * dice;
        if (f->lobes) r *= k % 2 ? 1 - f->depth : 1 + 0.1 * f->sharp;
        const double v = 0.5 * r * sin(turn), away = 0.5 + v - f->widest;
        const double wide = f->slim * (1 - 0.35 * away * away);
        out->uv[k][0] = (float)clamp(0.5 + 0.5 * r * cos(turn) * wide, 0, 1);
        out->uv[k][1] = (float)clamp(0.5 + v, 0, 1);
    }
}

double plant_outline_area(const LeafOutline *o)
{
    double twice = 0;
    for (int k = 0, l = o->corners - 1; k < o->corners; l = k++)
        twice += (double)o->uv[l][0] * (double)o->uv[k][1] - (double)o->uv[k][0] * (double)o->uv[l][1];
    return 0.5 * twice;
}

/* Crossings of a line to the right are odd within. */
bool plants_within_outline(const LeafOutline *o, float u, float v)
{
    bool in = false;
    for (int k = 0, l = o->corners - 1; k < o->corners; l = k++) {
        const float ku = o->uv[k][0], kv = o->uv[k][1], lu = o->uv[l][0], lv = o->uv[l][1];
        if ((kv > v) != (lv > v) && u < (lu - ku) * (v - kv) / (lv - kv) + ku) in = !in;
    }
    return in;
}
