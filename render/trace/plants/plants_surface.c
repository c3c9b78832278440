/* render/trace/plants/plants_surface.c: the bark's and stone's own pattern, and the differences between leaves.
 *
 * Three octaves of value noise stretched along the trunk, each left out where the footprint is wider than half its
 * length. Amplitudes and lengths of the species are estimates by look: pines and oaks are furrowed, birches smooth and
 * banded across. The factor has mean 1: each octave is even about 0. */

#include "render/trace/plants/plants_private.h"

typedef struct BarkForm {
    double across_m, along_m; /* length of the coarsest octave */
    double contrast;          /* of reflectance, of the coarsest octave; each finer one 0.6 of it */
    double relief;            /* rms slope */
    double bands;             /* contrast of dark bands across: birch */
} BarkForm;

static const BarkForm bark_form[PLANT_KINDS] = {
    [PLANT_PINE] = {0.12, 0.3, 0.35, 0.5, 0},        [PLANT_ALDER] = {0.1, 0.3, 0.25, 0.3, 0},
    [PLANT_BIRCH] = {0.25, 0.12, 0.15, 0.1, 0.45},   [PLANT_ENGLISH_OAK] = {0.06, 0.4, 0.3, 0.6, 0},
    [PLANT_SESSILE_OAK] = {0.05, 0.35, 0.3, 0.5, 0}, [PLANT_RED_OAK] = {0.08, 0.6, 0.22, 0.35, 0},
    [PLANT_WHITE_OAK] = {0.07, 0.3, 0.25, 0.45, 0},  [PLANT_BUSH] = {0.05, 0.1, 0.2, 0.2, 0},
    [PLANT_HEDGE] = {0.05, 0.1, 0.2, 0.2, 0},        [PLANT_ROCK] = {0.3, 0.3, 0.3, 0.3, 0},
};

static double lattice(uint32_t plant, int octave, int64_t i, int64_t j, int64_t k)
{
    uint64_t h =
        (uint64_t)i * 0x9e3779b97f4a7c15u ^ (uint64_t)j * 0xc2b2ae3d27d4eb4fu ^ (uint64_t)k * 0x165667b19e3779f9u;
    h ^= ((uint64_t)plant << 8 | (uint64_t)octave) * 0xd6e8feb86659fd93u;
    h = (h ^ h >> 32) * 0xd6e8feb86659fd93u;
    h = (h ^ h >> 32) * 0xd6e8feb86659fd93u;
    return (double)(h >> 11) * 0x1p-52 - 1; /* -1 .. 1 */
}

/* Smooth between lattice places; and its slope along the third axis. */
static double noise(double *slope, uint32_t plant, int octave, const double p[3])
{
    int64_t at[3];
    double  t[3], s[3], end[2] = {0, 0};
    for (int c = 0; c < 3; c++) {
        const double low = floor(p[c]);
        at[c] = (int64_t)low, t[c] = p[c] - low, s[c] = t[c] * t[c] * (3 - 2 * t[c]);
    }
    for (int k = 0; k < 8; k++) {
        const double share = (k & 1 ? s[0] : 1 - s[0]) * (k & 2 ? s[1] : 1 - s[1]);
        end[k >> 2] += share * lattice(plant, octave, at[0] + (k & 1), at[1] + (k >> 1 & 1), at[2] + (k >> 2));
    }
    *slope = 6 * t[2] * (1 - t[2]) * (end[1] - end[0]);
    return end[0] + s[2] * (end[1] - end[0]);
}

void plants_bark(float *albedo, float slope[2], PlantKind kind, uint32_t plant, const float p_m[3], float footprint_m)
{
    const BarkForm *f = &bark_form[kind];
    double          sum = 0, along = 0, about = 0, across_m = f->across_m, along_m = f->along_m, share = 1;
    for (int octave = 0; octave < 3 && across_m > 0; octave++, across_m *= 0.45, along_m *= 0.45, share *= 0.6) {
        const double kept = share * clamp(2 - 4 * (double)footprint_m / across_m, 0, 1);
        double       up, aside;
        if (!(kept > 0)) break;
        const double p[3] = {(double)p_m[0] / across_m, (double)p_m[1] / across_m, (double)p_m[2] / along_m};
        const double turned[3] = {p[2], p[1], p[0]};
        sum += kept * noise(&up, plant, octave, p);
        along += kept * up * across_m / along_m;
        noise(&aside, plant + 1, octave, turned);
        about += kept * aside;
    }
    double bands = 0;
    if (f->bands > 0) {
        const double kept = clamp(2 - 4 * (double)footprint_m / f->along_m, 0, 1);
        const double p[3] = {(double)p_m[0], (double)p_m[1], (double)p_m[2] / f->along_m};
        double       unused;
        if (kept > 0) bands = kept * f->bands * noise(&unused, plant, 9, p);
    }
    *albedo = (float)fmax(1 + f->contrast * sum + bands, 0.05);
    slope[0] = (float)(0.5 * f->relief * along);
    slope[1] = (float)(0.5 * f->relief * about);
}

float plants_leaf_albedo(PlantKind kind, uint32_t plant, uint32_t leaf)
{
    /* even about 1, 0.1 rms */
    return (float)(1 + 0.1 * sqrt(3.0) * lattice(plant, 20 + (int)kind, leaf, 0, 0));
}

/* ---- outlines of leaves ---------------------------------------------------------------------- */

/* Outlines of leaves: of a species' own form, each a little different.
 *
 * A card is a spray of leaves, but its outline is that of one leaf of the species, or of a tuft of needles: from near
 * it looks like the species, from afar its area counts. Forms are described by angle about the card's middle, as botany
 * keys do (lobes, their depth and tips): estimates. */

typedef struct LeafForm {
    int    lobes;  /* on the whole outline; 0: none */
    double depth;  /* of the cuts between them, 0 .. 1 */
    double sharp;  /* 0: round lobes; 1: pointed ones */
    double widest; /* height of the widest place, 0 .. 1 */
    double slim;   /* half width over half length */
} LeafForm;

static const LeafForm leaf_form[PLANT_KINDS] = {
    [PLANT_PINE] = {11, 0.62, 1, 0.5, 1},
    [PLANT_ALDER] = {0, 0, 0, 0.6, 0.85},
    [PLANT_BIRCH] = {11, 0.12, 1, 0.38, 0.8},
    [PLANT_ENGLISH_OAK] = {8, 0.42, 0.1, 0.6, 0.75},
    [PLANT_SESSILE_OAK] = {10, 0.3, 0.1, 0.52, 0.75},
    [PLANT_RED_OAK] = {8, 0.5, 0.9, 0.52, 0.85},
    [PLANT_WHITE_OAK] = {8, 0.55, 0.2, 0.55, 0.8},
    [PLANT_BUSH] = {0, 0, 0, 0.5, 0.7},
    [PLANT_HEDGE] = {6, 0.35, 0.3, 0.55, 0.8},
};

/* Blades: a foot half as wide as the middle, a point at the top. */
static void blade(LeafOutline *out, PlantKind kind, int which, uint64_t seed)
{
    const double bend = random_uniform(seed, 900 + (uint32_t)kind, 1, (uint64_t)which) - 0.5;
    const double at[4] = {0, 0.35, 0.7, 1}, half[4] = {0.25, 0.5, 0.36, 0};
    out->corners = 7;
    for (int k = 0; k < 4; k++) {
        const double middle = 0.5 + 0.2 * bend * at[k] * at[k],
                     wide = fmin(half[k], 0.5 - 0.2 * fabs(bend) * at[k] * at[k]);
        out->uv[k][0] = (float)(middle + wide), out->uv[k][1] = (float)at[k];
        if (k < 3) out->uv[6 - k][0] = (float)(middle - wide), out->uv[6 - k][1] = (float)at[k];
    }
}

void plant_outline(LeafOutline *out, PlantKind kind, int which, uint64_t seed)
{
    const LeafForm *f = &leaf_form[kind];
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
