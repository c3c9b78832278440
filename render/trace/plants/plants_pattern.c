/* render/trace/plants/plants_pattern.c: several leaves on a twig, drawn into the cells of a card, and what a place on
 * one of them looks like.
 *
 * A leaf has the outline of its species (plants_surface.c) and 0.45 of the card's length; leaves stand in turn on both
 * sides of a twig that ends in one. Pines have needles on both sides. A cell is 1.2 to 1.9 mm wide at the kinds' usual
 * heights. */
#include "render/trace/plants/plants_private.h"

enum { leaves_on_twig = 7, needles = 44, needles_a_group = 4 };
static const double leaf_length = 0.45, twig_half = 0.011, needle_half = 0.011; /* of the card's length */

_Static_assert(leaves_on_twig + 1 <= plant_leaflets_most && needles / needles_a_group < plant_leaflets_most,
               "numbers of leaves are octets of a short list");

static double dice(PlantKind kind, int which, uint64_t seed, int n, double low, double high)
{
    return low + (high - low) * random_uniform(seed, 950 + (uint32_t)kind, (uint32_t)which, (uint64_t)n);
}

/* Cells, first and last + 1 of an axis, that a place within reach of a or b may lie in. */
static void span_of(int span[2], double a, double b, double reach)
{
    span[0] = (int)clamp(floor((fmin(a, b) - reach) * plant_pattern_side), 0, plant_pattern_side);
    span[1] = (int)clamp(ceil((fmax(a, b) + reach) * plant_pattern_side), 0, plant_pattern_side);
}

/* Cells within half of the line from a to b. */
static void draw_line(LeafPattern *out, int leaf, const double a[2], const double b[2], double half)
{
    const double way[2] = {b[0] - a[0], b[1] - a[1]}, square = way[0] * way[0] + way[1] * way[1];
    int          x[2], y[2];
    span_of(x, a[0], b[0], half), span_of(y, a[1], b[1], half);
    for (int j = y[0]; j < y[1]; j++)
        for (int i = x[0]; i < x[1]; i++) {
            const double p[2] = {(i + 0.5) / plant_pattern_side - a[0], (j + 0.5) / plant_pattern_side - a[1]};
            const double t = clamp((p[0] * way[0] + p[1] * way[1]) / square, 0, 1);
            const double across[2] = {p[0] - t * way[0], p[1] - t * way[1]};
            if (across[0] * across[0] + across[1] * across[1] < half * half) out->leaflet[j][i] = (uint8_t)leaf;
        }
}

/* Cells of a leaf with an outline, its stalk at foot, towards tip. */
static void draw_leaf(LeafPattern *out, int leaf, const LeafOutline *outline)
{
    const float *foot = out->foot[leaf - 1], *tip = out->tip[leaf - 1];
    const double way[2] = {(double)(tip[0] - foot[0]), (double)(tip[1] - foot[1])};
    const double square = way[0] * way[0] + way[1] * way[1];
    int          x[2], y[2];
    span_of(x, (double)foot[0], (double)tip[0], 0.5 * sqrt(square));
    span_of(y, (double)foot[1], (double)tip[1], 0.5 * sqrt(square));
    for (int j = y[0]; j < y[1]; j++)
        for (int i = x[0]; i < x[1]; i++) {
            const double p[2] = {(i + 0.5) / plant_pattern_side - (double)foot[0],
                                 (j + 0.5) / plant_pattern_side - (double)foot[1]};
            const double v = (p[0] * way[0] + p[1] * way[1]) / square,
                         u = 0.5 + (p[0] * way[1] - p[1] * way[0]) / square;
            if (plants_within_outline(outline, (float)u, (float)v)) out->leaflet[j][i] = (uint8_t)leaf;
        }
}

static void place_leaf(LeafPattern *out, int leaf, const double foot[2], double angle, double length)
{
    const double tip[2] = {foot[0] + length * sin(angle), foot[1] + length * cos(angle)};
    for (int c = 0; c < 2; c++) out->foot[leaf - 1][c] = (float)foot[c], out->tip[leaf - 1][c] = (float)tip[c];
}

static void needles_of(LeafPattern *out, int which, uint64_t seed)
{
    out->leaflets = needles / needles_a_group;
    draw_line(out, 1, (const double[2]){0.5, 0}, (const double[2]){0.5, 0.8}, 1.5 * needle_half);
    for (int k = 0; k < needles; k++) {
        const int    leaf = 1 + k / needles_a_group, n = 3 * k;
        const double foot[2] = {0.5, 0.02 + 0.74 * k / needles};
        const double angle = (k % 2 ? 1 : -1) * dice(PLANT_PINE, which, seed, n, 0.35, 1.1) * (1 - 0.5 * k / needles);
        const double length = leaf_length * dice(PLANT_PINE, which, seed, n + 1, 0.8, 1.15);
        const double tip[2] = {foot[0] + length * sin(angle), foot[1] + length * cos(angle)};
        if (k % needles_a_group == 0) place_leaf(out, leaf, foot, angle, length);
        draw_line(out, leaf, foot, tip, needle_half);
    }
}

static void leaves_of(LeafPattern *out, PlantKind kind, int which, uint64_t seed)
{
    const double bend = dice(kind, which, seed, 0, -0.06, 0.06);
    out->leaflets = leaves_on_twig + 1; /* the twig has a number of its own, the last */
    place_leaf(out, leaves_on_twig + 1, (const double[2]){0.5, 0}, bend, 0.6);
    draw_line(out, leaves_on_twig + 1, (const double[2]){0.5, 0}, (const double[2]){0.5 + 0.6 * bend, 0.6}, twig_half);
    for (int k = 0; k < leaves_on_twig; k++) {
        LeafOutline  outline;
        const bool   last = k == leaves_on_twig - 1;
        const double up = last ? 0.58 : 0.04 + 0.48 * k / (leaves_on_twig - 2), side = k % 2 ? 1 : -1;
        const double foot[2] = {0.5 + bend * up, up + (last ? 0 : dice(kind, which, seed, 10 + k, -0.02, 0.02))};
        const double angle = last ? dice(kind, which, seed, 20, -0.2, 0.2)
                                  : side * dice(kind, which, seed, 20 + k, 0.85, 1.35) * (1 - 0.35 * up);
        place_leaf(out, k + 1, foot, angle,
                   leaf_length * dice(kind, which, seed, 30 + k, 0.8, 1.05) * (last ? 0.95 : 1));
        plant_outline(&outline, kind, (which + k) % plant_outlines, seed);
        draw_leaf(out, k + 1, &outline);
    }
}

/* Where a place lies along its leaf, 0 at the stalk, 1 at the tip; *aside: across it, of the leaf's length. */
static double place_along(double *aside, const LeafPattern *pattern, int leaf, double u, double v)
{
    const float *foot = pattern->foot[leaf - 1], *tip = pattern->tip[leaf - 1];
    const double way[2] = {(double)(tip[0] - foot[0]), (double)(tip[1] - foot[1])};
    const double p[2] = {u - (double)foot[0], v - (double)foot[1]}, square = way[0] * way[0] + way[1] * way[1];
    *aside = (p[0] * way[1] - p[1] * way[0]) / square;
    return clamp((p[0] * way[0] + p[1] * way[1]) / square, 0, 1);
}

void plant_pattern(LeafPattern *out, PlantKind kind, int which, uint64_t seed)
{
    double along = 0, aside;
    int    cells = 0;
    memset(out, 0, sizeof *out);
    if (kind == PLANT_PINE) needles_of(out, which, seed);
    else leaves_of(out, kind, which, seed);
    for (int j = 0; j < plant_pattern_side; j++)
        for (int i = 0; i < plant_pattern_side; i++) {
            if (!out->leaflet[j][i]) continue;
            cells++;
            along += place_along(&aside, out, out->leaflet[j][i], (i + 0.5) / plant_pattern_side,
                                 (j + 0.5) / plant_pattern_side);
        }
    out->area = (float)cells / (plant_pattern_side * plant_pattern_side);
    out->middle = (float)(along / cells);
}

/* ---- what is seen of them --------------------------------------------------------------------- */

LeafPlace plants_leaf_place(const Plants *plants, PlantKind kind, uint32_t plant, const PlantQuad *quad,
                            uint32_t number, const float uv[2])
{
    static const double tone = 0.12, along = 0.16, tilt = 0.45, fold = 0.3;
    const LeafPattern  *pattern = &plants->pattern[kind][quad->outline];
    const int           leaf = plants_leaflet(pattern, uv[0], uv[1]);
    LeafPlace           out = {plants_leaf_albedo(kind, plant, quad->piece), {0, 0}};
    double              own[3], aside; /* own: -1 .. 1 */
    uint32_t            bits[4];
    if (leaf == 0) return out; /* on the border of a cell */
    const double up = place_along(&aside, pattern, leaf, (double)uv[0], (double)uv[1]);
    /* by the leaf's own number among all of the plant's: its tone, and how it is turned on its stalk */
    const uint32_t of[4] = {number, (uint32_t)leaf, 0, 970};
    random_u32x4(bits, of, (const uint32_t[2]){plant, 0});
    for (int c = 0; c < 3; c++) own[c] = bits[c] * 0x1p-31 - 1;
    out.albedo *= (float)((1 + sqrt(3.0) * tone * own[0]) * (1 + along * (up - (double)pattern->middle)));
    /* its halves are folded up along the midrib */
    const float *foot = pattern->foot[leaf - 1], *tip = pattern->tip[leaf - 1];
    const double way[2] = {(double)(tip[0] - foot[0]), (double)(tip[1] - foot[1])};
    const double folded = (aside > 0 ? fold : -fold) / sqrt(way[0] * way[0] + way[1] * way[1]);
    out.slope[0] = (float)(tilt * own[1] + folded * way[1]);
    out.slope[1] = (float)(tilt * own[2] - folded * way[0]);
    return out;
}
