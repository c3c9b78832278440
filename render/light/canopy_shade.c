/* render/light/canopy_shade.c: how much of slanted light the plants of woods hide, from the shadows of their prototypes
 * (PlantShade): clumping against leaves at random, and how it is shared out over the height of crowns. */
#include "render/light/canopy_private.h"

enum { overhead = plant_shade_ways - 1 };

/* Level shadow of a plant 1 m high, m2, of what lies above (below) a share of its height. Where no shadow was found:
 * that of leaves at random, G = 1/2, evenly spread over the crown. */
static double shadow_of(const Plants *plants, int kind, int way, double at, bool below)
{
    const PlantShape *shape = &plants->shape[kind][plant_whole];
    const PlantShade *s = &plants->shade[kind];
    if (s->above[overhead][0] > 0) {
        const float *of = below ? s->below[way] : s->above[way];
        const double x = clamp(at, 0, 1) * (plant_shade_heights - 1);
        const int    i = (int)fmin(x, plant_shade_heights - 2);
        return (double)of[i] + (x - i) * ((double)of[i + 1] - (double)of[i]);
    }
    const double low = (double)shape->crown_low, under = low < 1 ? clamp((at - low) / (1 - low), 0, 1) : at < 1 ? 0 : 1;
    return 0.5 * (double)shape->leaf_area / plant_shade_up[way] * (below ? under : 1 - under);
}

static const double mean_m2 = 300; /* of which a place of the grid is a mean */

/* A shadow of an affine image of the plant, w times as wide: w squared times that of light 1 / w times as slanted. The
 * leaf area at random that would hide as much is 2 sine times it, while others' shadows fall anywhere. */
PlantArea canopy_plant_area(const Plants *plants, int kind, double height_m, double wide)
{
    const PlantShape *shape = &plants->shape[kind][plant_whole];
    const double      random = (double)shape->leaf_area * height_m * height_m * wide;
    double            slant[2], shadow[2];
    if (!(plants->shade[kind].above[overhead][0] > 0)) return (PlantArea){random, INFINITY, 0};
    for (int k = 0; k < 2; k++) {
        const double up = plant_shade_up[overhead - k];
        slant[k] = sqrt(1 - up * up) / up;
        shadow[k] = shadow_of(plants, kind, overhead - k, (double)shape->crown_low, false);
    }
    const double at = (slant[0] / wide - slant[0]) / (slant[1] - slant[0]);
    const double m2 = height_m * height_m * wide * wide * fmax(shadow[0] + at * (shadow[1] - shadow[0]), 0);
    const double r = (double)shape->crown_radius * height_m * wide, high = (1 - (double)shape->crown_low) * height_m;
    return (PlantArea){2 * plant_shade_up[overhead] * m2, pi_rad * r * r + 2 * r * high * slant[0], m2};
}

/* Plants do not stand anywhere. They are counted by the grid, whose places are means over 300 m2 (cells of 8 m,
 * straight between them, of crowns 10 m wide): each of n plants there hides K / 300 of it, and (1 - K / 300)^n is lit.
 * And of the cells of 16 m2 that bear one each at most (terrain/woods/woods_square.c) a share p does, whose shadow
 * hides a share q of the area S over which it is spread: (1 - p q)^(S / 16). Both are exp(-n K / 300) for little
 * shadow, and less than that else (Nilson, Agric. Meteorol. 8, 1971: positive binomial); together as one of the sum of
 * the shares. hides: of shadows anywhere, an index. */
double canopy_apart(double hides, double spread_m2, double shadow_m2)
{
    static const double cell_m2 = 16, most = 0.9;
    const double        depth = hides / (2 * plant_shade_up[overhead]);
    const double        share = fmin(cell_m2 * depth / spread_m2 + shadow_m2 / mean_m2, most);
    return share > 0 ? hides * -log1p(-share) / share : hides;
}

double canopy_clumping(const Canopy *c, double up)
{
    int k = 0;
    while (k < plant_shade_ways - 2 && up > plant_shade_up[k + 1]) k++;
    const double share = clamp((up - plant_shade_up[k]) / (plant_shade_up[k + 1] - plant_shade_up[k]), 0, 1);
    return c->clumping[k] + share * (c->clumping[k + 1] - c->clumping[k]);
}

/* 2 int_0^1 mu exp(-x clumping(mu) / mu) d mu, as canopy_gap; and for a wall, whose light goes by the cosine of the
 * elevation in place of its sine. */
static void find_gaps(Canopy *c)
{
    enum { steps = 1000 };
    double per[steps], flat[steps], all = 0;
    for (int k = 0; k < steps; k++) {
        const double mu = sqrt((k + 0.5) / steps);
        per[k] = canopy_clumping(c, mu) / mu;
        flat[k] = sqrt(1 - mu * mu) / mu;
        all += flat[k];
    }
    for (int i = 0; i < gap_steps + 2; i++) {
        const double x = gap_most * i / gap_steps;
        double       sum = 0, low = 0;
        for (int k = 0; k < steps && i > 0; k++) {
            const double through = exp(-x * per[k]);
            sum += through, low += flat[k] * through;
        }
        c->gap[i] = i > 0 ? (float)(sum / steps) : 1, c->low_gap[i] = i > 0 ? (float)(low / all) : 1;
    }
}

/* What of its own shadow a plant finds about it in the grid, the mean over shadows of some thousands of plants. */
static double own_of(const Woods *woods, const Plants *plants)
{
    const int step = woods->count / 4096 + 1;
    double    sum = 0, all = 0;
    for (int k = 0; k < woods->count; k += step) {
        const Plant    *plant = &woods->plant[k];
        const PlantArea a = canopy_plant_area(plants, plant->kind, plant_height_m(plant), plant->width / 128.0);
        sum += a.shadow * a.hides, all += a.shadow;
    }
    return all > 0 ? sum / all / mean_m2 : 0;
}

/* Means over the plants of all kinds; over kinds, where there are none. */
void canopy_find_shade(Canopy *c, const Woods *woods, const Plants *plants, bool leaves)
{
    enum { last = plant_shade_heights - 1 };
    double by_way[plant_shade_ways] = {0}, by_height[2][plant_shade_heights] = {{0}}, all = 0;
    for (int kind = 0; kind < PLANT_STANDING; kind++) all += woods->by_kind[kind];
    for (int kind = 0; kind < PLANT_STANDING; kind++) {
        const double count = all > 0 ? woods->by_kind[kind] : 1,
                     low = (double)plants->shape[kind][plant_whole].crown_low;
        if (!leaves && plant_is_deciduous((PlantKind)kind)) continue;
        for (int way = 0; way < plant_shade_ways; way++) {
            const double up = plant_shade_up[way];
            by_way[way] += count * up * shadow_of(plants, kind, way, low, false);
            for (int h = 0; h <= last; h++)
                for (int below = 0; below < 2; below++)
                    by_height[below][h] += count * plant_shade_weight[way] * up * up *
                                           shadow_of(plants, kind, way, low + (1 - low) * h / last, below);
        }
    }
    const double whole[2] = {by_height[0][0], by_height[1][last]};
    for (int way = 0; way < plant_shade_ways; way++)
        c->clumping[way] = by_way[overhead] > 0 ? by_way[way] / by_way[overhead] : 1;
    for (int h = 0; h <= last; h++) {
        c->above[h] = whole[0] > 0 ? by_height[0][h] / whole[0] : 1 - (double)h / last;
        c->below[h] = whole[1] > 0 ? by_height[1][h] / whole[1] : (double)h / last;
    }
    c->own = own_of(woods, plants);
    find_gaps(c);
}

/* ---- the sky past neighbours ------------------------------------------------------------------- */

enum { sky_azimuths = 8, sky_layers = 3, hides_steps = 2048 };

static double hides_of(const CanopyCell *cell)
{
    return leaf_area_step * cell->leaf_area * clumped_step * cell->clumped;
}

/* Mean heights of crowns. */
static CanopyCell mean_of(const Canopy *c)
{
    double top = 0, base = 0, all = 0;
    for (size_t k = 0; k < (size_t)c->nx * (size_t)c->ny; k++) {
        top += c->cell[k].leaf_area * c->cell[k].top, base += c->cell[k].leaf_area * c->cell[k].base;
        all += c->cell[k].leaf_area;
    }
    return (CanopyCell){.top = (uint8_t)(all > 0 ? rint(top / all) : 0),
                        .base = (uint8_t)(all > 0 ? rint(base / all) : 0)};
}

static const int layer_share = 256; /* of all that hides: a layer's, so many times */

/* The light of a way, from azimuth after azimuth, goes through the layers of crowns in cells so far away. */
typedef struct SkyWay {
    int    cell[sky_azimuths][sky_layers][2];
    double towards[sky_azimuths][2]; /* of that on a wall that faces it, by its azimuth */
    float  through[hides_steps + 1]; /* by what a cell hides, of 1 / 128 */
    double level;                    /* of the light on level ground */
} SkyWay;

static void way_of(SkyWay *out, const Canopy *c, int way)
{
    static const double far_m = 100; /* light that comes so low is little in either case */
    const double        up = plant_shade_up[way], flat = sqrt(1 - up * up);
    for (int a = 0; a < sky_azimuths; a++) {
        const double turn = 2 * pi_rad * a / sky_azimuths, of[2] = {cos(turn), sin(turn)};
        for (int x = 0; x < 2; x++) out->towards[a][x] = 2 * plant_shade_weight[way] * flat / sky_azimuths * of[x];
        for (int l = 0; l < sky_layers; l++) {
            const double height_m = top_step_m * (c->mean.base + (l + 0.5) / sky_layers * (c->mean.top - c->mean.base));
            for (int x = 0; x < 2; x++)
                out->cell[a][l][x] = (int)lrint(fmin(height_m * flat / up, far_m) / canopy_cell_m * of[x]);
        }
    }
    for (int k = 0; k <= hides_steps; k++) out->through[k] = (float)exp(-0.5 * c->clumping[way] * k / 128.0 / up);
    out->level = 2 * plant_shade_weight[way] * up / sky_azimuths;
}

/* The argument of the table of gaps for a share of the sky, times 2. */
static double area_of(const Canopy *c, double open)
{
    int low = 0, high = gap_steps;
    while (high - low > 1) *((double)c->gap[(low + high) / 2] > open ? &low : &high) = (low + high) / 2;
    const double step = (double)c->gap[low] - (double)c->gap[high];
    return 2 * gap_most / gap_steps * (low + (step > 0 ? clamp(((double)c->gap[low] - open) / step, 0, 1) : 0));
}

static void sky_of(CanopySky *out, const Canopy *c, const SkyWay way[plant_shade_ways], const int layer[sky_layers],
                   int i, int j)
{
    double open = 0, all = 0, aside[2] = {0};
    for (int w = 0; w < plant_shade_ways; w++)
        for (int a = 0; a < sky_azimuths; a++) {
            int hides = 0;
            for (int l = 0; l < sky_layers; l++) {
                const int x = i + way[w].cell[a][l][0], y = j + way[w].cell[a][l][1];
                if (!(x >= 0 && y >= 0 && x < c->nx && y < c->ny)) continue;
                const CanopyCell *cell = &c->cell[(size_t)y * (size_t)c->nx + (size_t)x];
                hides += layer[l] * cell->leaf_area * cell->clumped;
            }
            const int    at = hides / (16 * layer_share);
            const double through = (double)way[w].through[at < hides_steps ? at : hides_steps];
            open += way[w].level * through, all += way[w].level;
            for (int k = 0; k < 2; k++) aside[k] += way[w].towards[a][k] * through;
        }
    out->area = (uint8_t)clamp(rint(area_of(c, open / all) / sky_area_step), 0, 255);
    for (int k = 0; k < 2; k++) out->towards[k] = (int8_t)clamp(rint(aside[k] / sky_towards_step), -127, 127);
}

void canopy_find_sky(Canopy *c, const Plants *plants)
{
    SkyWay way[plant_shade_ways];
    int    layer[sky_layers];
    bool   shadows = false;
    for (int kind = 0; kind < PLANT_STANDING; kind++) shadows |= plants->shade[kind].above[overhead][0] > 0;
    c->mean = mean_of(c);
    for (int k = 0; k < plant_shade_ways; k++) way_of(&way[k], c, k);
    for (int l = 0; l < sky_layers; l++) {
        const double low = canopy_share_at(c->above, (double)l / sky_layers),
                     high = canopy_share_at(c->above, (l + 1.0) / sky_layers);
        layer[l] = (int)lrint(layer_share * (low - high));
    }
    for (int j = 0; j < c->ny; j++)
        for (int i = 0; i < c->nx; i++) {
            const size_t     k = (size_t)j * (size_t)c->nx + (size_t)i;
            const CanopyCell cell = c->cell[k];
            if (shadows) sky_of(&c->sky[k], c, way, layer, i, j);
            else c->sky[k] = (CanopySky){.area = (uint8_t)fmin(rint(hides_of(&cell) / sky_area_step), 255)};
        }
}
