/* render/trace/plants/plants_grow.c: seven trees: a trunk, branches, twigs on them and leaves on those, by the habit
 * of the species.
 *
 * Radii follow the pipe model (Shinozaki et al., Jpn. J. Ecol. 14, 1964): cross-sections are in proportion to the twigs
 * that they feed. Branches follow one another about the trunk by the golden angle, as buds do (phyllotaxis); in pines
 * in whorls, one a year. Numbers of pieces and leaves are those of Muuss & Lorenzo (1995), figure 3: 1695 .. 3634 and
 * 852 .. 1749; a card is therefore a spray of leaves: its size gives the tree a leaf area of some three times the
 * ground under its crown (temperate forests: 3 .. 6, Asner et al., Global Ecol. Biogeogr. 12, 191, 2003). Habits are
 * descriptions of field guides put into numbers: estimates. */

#include "render/trace/plants/plants_private.h"

typedef struct Habit {
    double bole;              /* share of the height without branches */
    double spread;            /* crown's radius over the height */
    double widest;            /* height in the crown of its widest place, 0 .. 1 */
    double top;               /* radius at the crown's top over that at its widest place */
    double round;             /* of the crown above that: 0.5 an ellipsoid, 1 a paraboloid, 1.5 nearly a cone */
    double low_rad, high_rad; /* of branches from the vertical, at the foot of the crown and at its top */
    double rise;              /* of branches along their way: > 0 they turn up, < 0 they droop */
    double crooked;           /* of branches and trunk */
    double radius;            /* of the trunk's foot over the height */
    double leader;            /* height at which the trunk ends */
    int    whorl;             /* branches at one height; 1: each at its own */
    int    branches, subs, twigs, more; /* a tree; a branch; a sub-branch; leaves a sub-branch beside one a twig */
    double leaf_aspect;                 /* width over length of a card */
} Habit;

static const Habit habits[PLANT_TREES] = {
    [PLANT_PINE] = {0.42, 0.18, 0.20, 0.04, 1.0, 1.60, 0.80, 0.25, 0.03, 0.016, 0.99, 5, 60, 5, 3, 2, 1.0},
    [PLANT_ALDER] = {0.22, 0.20, 0.22, 0.04, 1.2, 1.25, 0.70, 0.10, 0.05, 0.014, 0.98, 1, 64, 6, 3, 1, 0.9},
    [PLANT_BIRCH] = {0.25, 0.21, 0.35, 0.08, 0.8, 0.90, 0.45, -0.75, 0.06, 0.011, 0.97, 1, 80, 7, 3, 0, 0.9},
    [PLANT_ENGLISH_OAK] = {0.20, 0.42, 0.40, 0.22, 0.6, 1.45, 0.45, 0.20, 0.16, 0.028, 0.72, 1, 40, 10, 4, 0, 0.8},
    [PLANT_SESSILE_OAK] = {0.30, 0.33, 0.45, 0.20, 0.6, 1.15, 0.40, 0.25, 0.10, 0.024, 0.82, 1, 42, 10, 4, 0, 0.8},
    [PLANT_RED_OAK] = {0.27, 0.34, 0.50, 0.22, 0.6, 1.10, 0.40, 0.30, 0.08, 0.024, 0.80, 1, 43, 10, 4, 0, 0.85},
    [PLANT_WHITE_OAK] = {0.18, 0.45, 0.42, 0.25, 0.6, 1.50, 0.50, 0.10, 0.13, 0.030, 0.74, 1, 41, 10, 4, 0, 0.8},
};

enum { trunk_pieces = 12, branch_pieces = 4, sub_pieces = 2 };
static const double golden_rad = 2.39996322972865332;
static const double twigs_too = 1.85; /* radius of a sub-branch at plant_simple, which stands for its twigs as well:
                                       * bare silhouettes then agree (tests/render/test_plants.c) */
static const double leaf_layers = 4, outline_share = 0.5; /* of a card; about */

/* Radius of the crown at a height in it, 0 .. 1, over its largest. */
static double crown_at(const Habit *h, double up)
{
    if (up < h->widest) return 0.45 + 0.55 * sqrt(fmax(up / h->widest, 0));
    const double above = (up - h->widest) / (1 - h->widest);
    return h->top + (1 - h->top) * pow(fmax(1 - above * above, 0), h->round);
}

/* A way in equal steps that bends by `rise` upwards in all and wanders. Returns its last direction in d. */
static void bend(double (*p)[3], double d[3], Growth *g, int steps, double length, double rise, double crooked)
{
    for (int k = 0; k < steps; k++) {
        v3_add_scaled(p[k + 1], p[k], length / steps, d);
        d[2] += rise / steps;
        for (int x = 0; x < 3; x++) d[x] += grow_draw(g, -crooked, crooked);
        v3_normalize(d, d);
    }
}

/* Pieces along a way, from radius a to radius b; at plant_simple every `skip` steps are one. */
static void pieces_along(Growth *g, double (*p)[3], int steps, double a, double b, int sides, int skip)
{
    for (int k = 0; k < steps; k += skip) {
        const int    end = k + skip < steps ? k + skip : steps;
        const double from = a + (b - a) * k / steps, to = a + (b - a) * end / steps;
        grow_piece(g, p[k], p[end], from, to, sides);
    }
}

/* A direction at `angle` from d, turned by `turn` about it. */
static void aside(double out[3], const double d[3], double angle, double turn)
{
    const double up[3] = {0, 0, 1}, east[3] = {1, 0, 0};
    double       u[3], v[3];
    v3_cross(u, fabs(d[2]) < 0.95 ? up : east, d);
    v3_normalize(u, u);
    v3_cross(v, d, u);
    for (int x = 0; x < 3; x++) out[x] = cos(angle) * d[x] + sin(angle) * (cos(turn) * u[x] + sin(turn) * v[x]);
}

/* Leaves face the sky more than the ground, each in its own way. At plant_simple one card stands for four. */
static void leaf_at(Growth *g, const Habit *h, const double p[3], const double d[3], double length)
{
    double along[3], n[3];
    for (int x = 0; x < 3; x++) {
        along[x] = d[x] + grow_draw(g, -0.7, 0.7);
        n[x] = grow_draw(g, -1, 1) + (x == 2 ? 0.7 : 0);
    }
    const double size = length * grow_draw(g, 0.75, 1.25);
    if (g->level == plant_simple && g->offered++ % 4) {
        grow_draw(g, 0, 1); /* as the outline takes */
        return;
    }
    const double larger = g->level != plant_simple ? 1 : 2;
    grow_leaf(g, p, along, n, larger * size, larger * size * h->leaf_aspect);
}

/* A sub-branch with its twigs. */
static void grow_sub(Growth *g, const Habit *h, const double at[3], const double toward[3], double length,
                     double radius, double leaf_m)
{
    double p[sub_pieces + 1][3], d[3];
    memcpy(p[0], at, sizeof p[0]);
    memcpy(d, toward, sizeof d);
    bend(p, d, g, sub_pieces, length, 0.4 * h->rise, h->crooked);
    if (g->level != plant_simple) pieces_along(g, p, sub_pieces, radius, 0.5 * radius, 6, 1);
    else pieces_along(g, p, sub_pieces, twigs_too * radius, 0.7 * twigs_too * radius, 3, sub_pieces);
    for (int t = 0; t < h->twigs; t++) {
        const double share = (t + grow_draw(g, 0.4, 1)) / h->twigs;
        const int    k = share * sub_pieces >= 1 ? 1 : 0;
        double       from[3], way[3], tip[3];
        for (int x = 0; x < 3; x++) from[x] = p[k][x] + (share * sub_pieces - k) * (p[k + 1][x] - p[k][x]);
        aside(way, d, grow_draw(g, 0.4, 1.0), t * pi_rad + grow_draw(g, -0.8, 0.8));
        v3_add_scaled(tip, from, length * grow_draw(g, 0.25, 0.45), way);
        if (g->level != plant_simple) grow_piece(g, from, tip, 0.45 * radius, 0.3 * radius, 6);
        leaf_at(g, h, tip, way, leaf_m);
    }
    for (int k = 0; k < h->more; k++) {
        double       from[3];
        const double share = grow_draw(g, 0.3, 1);
        for (int x = 0; x < 3; x++) from[x] = p[0][x] + share * (p[sub_pieces][x] - p[0][x]);
        leaf_at(g, h, from, d, leaf_m);
    }
}

static void grow_branch(Growth *g, const Habit *h, const double at[3], double up, double turn, double reach,
                        double radius, double leaf_m)
{
    const double angle = h->low_rad + (h->high_rad - h->low_rad) * up + grow_draw(g, -0.12, 0.12);
    double       p[branch_pieces + 1][3], d[3] = {sin(angle) * cos(turn), sin(angle) * sin(turn), cos(angle)};
    const double length = reach / fmax(sin(angle), 0.6) * grow_draw(g, 0.8, 1.1);
    memcpy(p[0], at, sizeof p[0]);
    bend(p, d, g, branch_pieces, length, h->rise, h->crooked);
    if (g->level != plant_simple) pieces_along(g, p, branch_pieces, radius, 0.35 * radius, 6, 1);
    else pieces_along(g, p, branch_pieces, radius, 0.35 * radius, 4, 2);
    for (int s = 0; s < h->subs; s++) {
        const double share = 0.22 + 0.78 * (s + grow_draw(g, 0.2, 0.9)) / h->subs;
        const int    k = (int)fmin(share * branch_pieces, branch_pieces - 1);
        double       from[3], along[3], way[3];
        for (int x = 0; x < 3; x++) {
            along[x] = p[k + 1][x] - p[k][x];
            from[x] = p[k][x] + fmin(share * branch_pieces - k, 1) * along[x];
        }
        v3_normalize(along, along);
        aside(way, along, grow_draw(g, 0.5, 1.1), s * pi_rad + grow_draw(g, -1.1, 1.1));
        grow_sub(g, h, from, way, length * (0.5 - 0.28 * share) * grow_draw(g, 0.8, 1.2), radius * (0.42 - 0.2 * share),
                 leaf_m);
    }
}

void grow_tree(Growth *g)
{
    const Habit *h = &habits[g->kind];
    const int    leaves = h->branches * h->subs * (h->twigs + h->more);
    const double leaf_m =
        sqrt(leaf_layers * pi_rad * h->spread * h->spread / (leaves * outline_share * h->leaf_aspect));
    double p[trunk_pieces + 1][3] = {{0, 0, 0}}, d[3] = {0, 0, 1};
    for (int k = 0; k < trunk_pieces; k++) { /* wanders, but stands */
        v3_add_scaled(p[k + 1], p[k], h->leader / trunk_pieces, d);
        for (int x = 0; x < 2; x++) d[x] = 0.6 * d[x] + grow_draw(g, -0.5, 0.5) * h->crooked;
        v3_normalize(d, d);
    }
    pieces_along(g, p, trunk_pieces, h->radius, 0.22 * h->radius, 6, g->level != plant_simple ? 1 : 3);
    double turn = grow_draw(g, 0, 2 * pi_rad);
    for (int b = 0; b < h->branches; b++) {
        const int    group = b / h->whorl, groups = (h->branches + h->whorl - 1) / h->whorl;
        const double up = (group + (h->whorl > 1 ? 0.5 : grow_draw(g, 0.1, 0.9))) / groups; /* in the crown */
        /* where the trunk ends early, as in oaks, the topmost limbs leave it side by side */
        const double z = fmin(h->bole + (0.97 - h->bole) * up, h->leader - 0.01) / h->leader * trunk_pieces;
        const int    k = (int)fmin(z, trunk_pieces - 1);
        double       at[3];
        for (int x = 0; x < 3; x++) at[x] = p[k][x] + (z - k) * (p[k + 1][x] - p[k][x]);
        turn += h->whorl > 1 ? 2 * pi_rad / h->whorl + (b % h->whorl == 0 ? golden_rad : 0) : golden_rad;
        /* their cross-sections together are nine tenths of the foot's */
        const double radius = h->radius * (0.19 - 0.08 * up) * sqrt(40.0 / h->branches);
        grow_branch(g, h, at, up, turn + grow_draw(g, -0.25, 0.25), h->spread * crown_at(h, up), radius, leaf_m);
    }
}

/* ---- bushes and hedges, and what stands near the eye: reeds, tufts, crops, stones ------------ */

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
        if (g->level != plant_simple)
            grow_piece(g, foot, middle, 0.010, 0.007, 6), grow_piece(g, middle, tip, 0.007, 0.004, 6);
        else grow_piece(g, foot, tip, 0.009, 0.004, 3);
    }
    for (int l = 0; l < leaves; l++) { /* in the shell more than within */
        const double turn = grow_draw(g, 0, 2 * pi_rad), out = sqrt(grow_draw(g, 0.25, 1)),
                     z = grow_draw(g, 0.06, 0.98);
        const double round = sqrt(fmax(1 - 0.55 * z * z, 0.2));
        const double at[3] = {out * round * cos(turn) * half_x, out * round * sin(turn) * half_y, z};
        double       along[3], n[3];
        for (int x = 0; x < 3; x++)
            along[x] = (x < 2 ? at[x] : 0.2) + grow_draw(g, -0.4, 0.4), n[x] = grow_draw(g, -1, 1) + (x == 2 ? 0.5 : 0);
        const double size = leaf_m * grow_draw(g, 0.7, 1.3);
        if (g->level == plant_simple && l % 4) grow_draw(g, 0, 1);
        else
            grow_leaf(g, at, along, n, size * (g->level == plant_simple ? 2 : 1),
                      0.7 * size * (g->level == plant_simple ? 2 : 1));
    }
}

/* Blades from one foot; the tips droop outwards by lean. */
static void grow_blades(Growth *g, int blades, double spread, double lean, double width)
{
    for (int b = 0; b < blades; b++) {
        const double turn = grow_draw(g, 0, 2 * pi_rad), out = grow_draw(g, 0.1, 1),
                     face = turn + grow_draw(g, -0.9, 0.9);
        const double at[3] = {spread * out * cos(turn), spread * out * sin(turn), 0};
        const double along[3] = {lean * out * cos(turn), lean * out * sin(turn), 1};
        const double n[3] = {cos(face), sin(face), 0.1};
        const double length = grow_draw(g, 0.6, 1), wide = width * (g->level == plant_simple ? 2 : 1);
        if (g->level == plant_simple && b % 2) grow_draw(g, 0, 1);
        else grow_leaf(g, at, along, n, length, wide);
    }
}

/* A stone: a sphere of 8 x 5 places, dented, its lower half in the ground. */
static void grow_stone(Growth *g)
{
    enum { around = 8, rings = 5 };
    const int turns = g->level == plant_simple ? around / 2 : around, levels = g->level == plant_simple ? 3 : rings;
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
            const int step = around / turns, j0 = j * rings / levels, j1 = (j + 1) * rings / levels;
            const int k0 = k * step, k1 = (k + 1) % turns * step;
            double    t[3][3];
            memcpy(t[0], p[j0][k0], sizeof t[0]), memcpy(t[1], p[j0][k1], sizeof t[1]),
                memcpy(t[2], p[j1][k1], sizeof t[2]);
            grow_facet(g, (const double(*)[3])t);
            if (j1 == rings) continue; /* the top is one place */
            memcpy(t[1], p[j1][k1], sizeof t[1]), memcpy(t[2], p[j1][k0], sizeof t[2]);
            grow_facet(g, (const double(*)[3])t);
        }
}

void grow_low_plant(Growth *g)
{
    switch (g->kind) {
    case PLANT_BUSH:
        grow_stems(g, 14, 0.55, 0.55, 0.7, 260, 0.16);
        break;
    case PLANT_HEDGE:
        grow_stems(g, 12, 0.55, 0.42, 0.4, 320, 0.15);
        break;
    case PLANT_REED:
        grow_blades(g, 18, 0.12, 0.18, 0.03);
        break;
    case PLANT_GRASS:
        grow_blades(g, 26, 0.5, 0.5, 0.09);
        break;
    case PLANT_DRY_GRASS:
        grow_blades(g, 24, 0.45, 0.65, 0.07);
        break;
    case PLANT_CROP:
        grow_blades(g, 16, 0.12, 0.3, 0.07);
        break;
    default:
        grow_stone(g);
        break;
    }
}
