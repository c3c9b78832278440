/* render/plants/plants_low.c: bushes and hedges, and what stands near the eye: reeds, tufts, crops, stones. */
#include "render/plants/plants_private.h"

/* A stem with leaves about it: bushes and hedges have many, from one foot or along a line. */
static void grow_stems(Growth *g, int stems, double half_x, double half_y, double lean, int leaves, double leaf_m)
{
    for (int s = 0; s < stems; s++) {
        const double foot[3] = {grow_draw(g, -0.6, 0.6) * half_x, grow_draw(g, -0.6, 0.6) * half_y, 0};
        const double turn = grow_draw(g, 0, 2 * pi_rad), out = grow_draw(g, 0, lean);
        const double tip[3] = {foot[0] + out * cos(turn) * half_x, foot[1] + out * sin(turn) * half_y,
                               grow_draw(g, 0.75, 1)};
        double       middle[3];
        for (int x = 0; x < 3; x++) middle[x] = 0.5 * (foot[x] + tip[x]) + (x < 2 ? grow_draw(g, -0.05, 0.05) : 0.08);
        if (g->level == 0) grow_piece(g, foot, middle, 0.018, 0.012, 6), grow_piece(g, middle, tip, 0.012, 0.006, 6);
        else grow_piece(g, foot, tip, 0.016, 0.006, 3);
    }
    for (int l = 0; l < leaves; l++) { /* in the shell more than within */
        const double turn = grow_draw(g, 0, 2 * pi_rad), out = sqrt(grow_draw(g, 0.25, 1)), z = grow_draw(g, 0.06, 0.98);
        const double round = sqrt(fmax(1 - 0.55 * z * z, 0.2));
        const double at[3] = {out * round * cos(turn) * half_x, out * round * sin(turn) * half_y, z};
        double       along[3], n[3];
        for (int x = 0; x < 3; x++)
            along[x] = (x < 2 ? at[x] : 0.2) + grow_draw(g, -0.4, 0.4), n[x] = grow_draw(g, -1, 1) + (x == 2 ? 0.5 : 0);
        const double size = leaf_m * grow_draw(g, 0.7, 1.3);
        if (g->level && l % 4) grow_draw(g, 0, 1);
        else grow_leaf(g, at, along, n, size * (g->level ? 2 : 1), 0.7 * size * (g->level ? 2 : 1));
    }
}

/* Blades from one foot; the tips droop outwards by lean. */
static void grow_blades(Growth *g, int blades, double spread, double lean, double width)
{
    for (int b = 0; b < blades; b++) {
        const double turn = grow_draw(g, 0, 2 * pi_rad), out = grow_draw(g, 0.1, 1), face = turn + grow_draw(g, -0.9, 0.9);
        const double at[3] = {spread * out * cos(turn), spread * out * sin(turn), 0};
        const double along[3] = {lean * out * cos(turn), lean * out * sin(turn), 1};
        const double n[3] = {cos(face), sin(face), 0.1};
        const double length = grow_draw(g, 0.6, 1), wide = width * (g->level ? 2 : 1);
        if (g->level && b % 2) grow_draw(g, 0, 1);
        else grow_leaf(g, at, along, n, length, wide);
    }
}

/* A stone: a sphere of 8 x 5 places, dented, its lower half in the ground. */
static void grow_stone(Growth *g)
{
    enum { around = 8, rings = 5 };
    const int turns = g->level ? around / 2 : around, levels = g->level ? 3 : rings;
    double    p[rings + 1][around][3];
    for (int j = 0; j <= rings; j++)
        for (int k = 0; k < around; k++) {
            const double up = -0.35 + (0.5 * pi_rad + 0.35) * j / rings, turn = 2 * pi_rad * k / around;
            const double r = (j == rings ? 0 : 1) * grow_draw(g, 0.8, 1.1);
            p[j][k][0] = 0.75 * r * cos(up) * cos(turn), p[j][k][1] = 0.6 * r * cos(up) * sin(turn);
            p[j][k][2] = j == rings ? 1 : r * sin(up);
        }
    for (int j = 0; j < levels; j++)
        for (int k = 0; k < turns; k++) {
            const int    step = around / turns, j0 = j * rings / levels, j1 = (j + 1) * rings / levels;
            const int    k0 = k * step, k1 = (k + 1) % turns * step;
            double       t[3][3];
            memcpy(t[0], p[j0][k0], sizeof t[0]), memcpy(t[1], p[j0][k1], sizeof t[1]), memcpy(t[2], p[j1][k1], sizeof t[2]);
            grow_facet(g, (const double(*)[3])t);
            if (j1 == rings) continue; /* the top is one place */
            memcpy(t[1], p[j1][k1], sizeof t[1]), memcpy(t[2], p[j1][k0], sizeof t[2]);
            grow_facet(g, (const double(*)[3])t);
        }
}

void grow_low_plant(Growth *g)
{
    switch (g->kind) {
    case PLANT_BUSH: grow_stems(g, 14, 0.55, 0.55, 0.7, 260, 0.16); break;
    case PLANT_HEDGE: grow_stems(g, 12, 0.55, 0.42, 0.4, 320, 0.15); break;
    case PLANT_REED: grow_blades(g, 18, 0.12, 0.18, 0.03); break;
    case PLANT_GRASS: grow_blades(g, 26, 0.5, 0.5, 0.09); break;
    case PLANT_DRY_GRASS: grow_blades(g, 24, 0.45, 0.65, 0.07); break;
    case PLANT_CROP: grow_blades(g, 16, 0.12, 0.3, 0.07); break;
    default: grow_stone(g); break;
    }
}
