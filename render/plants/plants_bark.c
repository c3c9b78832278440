/* render/plants/plants_bark.c: the bark's and stone's own pattern, and the differences between leaves.
 *
 * Three octaves of value noise stretched along the trunk, each left out where the footprint is wider than half its
 * length. Amplitudes and lengths of the species are estimates by look: pines and oaks are furrowed, birches smooth and
 * banded across. The factor has mean 1: each octave is even about 0. */
#include "render/plants/plants_private.h"

typedef struct BarkForm {
    double across_m, along_m; /* length of the coarsest octave */
    double contrast;          /* of reflectance, of the coarsest octave; each finer one 0.6 of it */
    double relief;            /* rms slope */
    double bands;             /* contrast of dark bands across: birch */
} BarkForm;

static const BarkForm forms[PLANT_KINDS] = {
    [PLANT_PINE] = {0.12, 0.3, 0.35, 0.5, 0},        [PLANT_ALDER] = {0.1, 0.3, 0.25, 0.3, 0},
    [PLANT_BIRCH] = {0.25, 0.12, 0.15, 0.1, 0.45},   [PLANT_ENGLISH_OAK] = {0.06, 0.4, 0.3, 0.6, 0},
    [PLANT_SESSILE_OAK] = {0.05, 0.35, 0.3, 0.5, 0}, [PLANT_RED_OAK] = {0.08, 0.6, 0.22, 0.35, 0},
    [PLANT_WHITE_OAK] = {0.07, 0.3, 0.25, 0.45, 0},  [PLANT_BUSH] = {0.05, 0.1, 0.2, 0.2, 0},
    [PLANT_HEDGE] = {0.05, 0.1, 0.2, 0.2, 0},        [PLANT_ROCK] = {0.3, 0.3, 0.3, 0.3, 0},
};

static double lattice(uint32_t plant, int octave, int64_t i, int64_t j, int64_t k)
{
    uint64_t h = (uint64_t)i * 0x9e3779b97f4a7c15u ^ (uint64_t)j * 0xc2b2ae3d27d4eb4fu ^ (uint64_t)k * 0x165667b19e3779f9u;
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
    const BarkForm *f = &forms[kind];
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
        bands = kept * f->bands * noise(&unused, plant, 9, p);
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
