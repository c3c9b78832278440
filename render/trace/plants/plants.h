/* render/trace/plants/plants.h: one prototype of every kind of plant, grown from a seed: branches of six-sided prisms,
 * leaves as flat cards, at three levels of detail.
 *
 * plant_whole and plant_simple: a card is a spray, with the outline of one leaf of the species. plant_fine: the same
 * branches, each spray dissolved into smaller cards about its place, each with a pattern of several leaves of their
 * natural size; the leaf area is that of plant_whole. Low plants and stones are the same at plant_fine and plant_whole.
 *
 * Axes: x, y, z up along the trunk; the foot is at the origin and the plant 1 m high. */
#ifndef RENDER_TRACE_PLANTS_PLANTS_H
#define RENDER_TRACE_PLANTS_PLANTS_H

#include "terrain/woods/plant.h"

enum { plant_fine, plant_whole, plant_simple, plant_levels };
enum { plant_outlines = 8, plant_outline_corners_most = 24, plant_pattern_side = 128, plant_leaflets_most = 16 };

/* A leaf's outline in its card's own coordinates, 0 .. 1 both ways, counter-clockwise; v = 0 is the stalk. Simple, not
 * necessarily convex. A cluster of leaves at plant_simple has an outline of the same kind. */
typedef struct LeafOutline {
    int   corners;
    float uv[plant_outline_corners_most][2];
} LeafOutline;

/* What is there of a card of plant_fine: several leaves on a twig, or needles, drawn once into square cells. */
typedef struct LeafPattern {
    uint8_t leaflet[plant_pattern_side][plant_pattern_side]; /* [v][u]: 0 nothing; else number of a leaf, from 1 */
    int     leaflets;                                        /* of needles: groups */
    float   area;                                            /* share of the card */
    float   middle;                                          /* mean place of cells along their leaves, 0 .. 1 */
    float   foot[plant_leaflets_most][2], tip[plant_leaflets_most][2]; /* in the card's coordinates */
} LeafPattern;

/* A quad: corners in order; of bark, a side of a prism; of leaves, a flat parallelogram a, a + u, a + u + v, a + v,
 * of which only what is within the outline, or the pattern, is there. Quads of bark are flat as well: made so by two
 * parallel edges. */
typedef struct PlantQuad {
    float    corner[4][3];
    uint8_t  organ;           /* PlantOrgan */
    uint8_t  outline;         /* or pattern, of leaves; 0 .. plant_outlines - 1 */
    uint16_t piece;           /* branch or spray, numbered within its organ */
    float    n[4][3];         /* unit shading normals at the corners, outwards; of leaves: of the card */
    float    radius;          /* of the branch, over the plant's height; leaves 0 */
    float open_up, open_down; /* shares of even light from above, and from below, that reach the quad's front (leaves:
                               * both sides) past its own plant, weighted by the cosine, 0 .. 1; 1 until
                               * forest_openness has found them; of patterned shapes -1 until a ray asks for them */
} PlantQuad;

typedef struct PlantShape {
    int        quads, pieces, leaves; /* pieces: branch pieces, each a prism */
    PlantQuad *quad;                  /* bark first, then leaves */
    int        bark_quads;
    float      low[3], high[3]; /* box */
    float      leaf_area;       /* one side of all leaves, for a plant 1 m high, m2 */
    float      crown_low;       /* height at which leaves begin */
    float      crown_radius;    /* that holds nine tenths of the leaf area */
} PlantShape;

/* What a plant 1 m high, as wide as its prototype, hides on its own of level light from plant_shade_up (sines of
 * elevation; places of Gauss' rule for 0 .. 1, of plant_shade_weight), the mean over all azimuths: area of the shadow,
 * m2 of level ground, of what lies above, and below, shares of its height. 0: not found. */
enum { plant_shade_ways = 4, plant_shade_heights = 9 };
static const float  plant_shade_most = 100;
static const double plant_shade_up[plant_shade_ways] = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281,
                                                        0.9305681557970262};
static const double plant_shade_weight[plant_shade_ways] = {0.17392742256872692, 0.3260725774312731, 0.3260725774312731,
                                                            0.17392742256872692};
typedef struct PlantShade {
    float above[plant_shade_ways][plant_shade_heights]; /* above share k / (plant_shade_heights - 1) of the height */
    float below[plant_shade_ways][plant_shade_heights];
} PlantShade;

typedef struct Plants {
    PlantShape  shape[PLANT_KINDS][plant_levels];
    LeafOutline outline[PLANT_KINDS][plant_outlines];
    float       outline_area[PLANT_KINDS][plant_outlines]; /* share of the card */
    int patterned; /* kinds, from the first, whose cards of plant_fine have patterns; those of others have outlines */
    LeafPattern (*pattern)[plant_outlines]; /* [patterned] */
    PlantShade shade[PLANT_STANDING];       /* by forest_shade */
} Plants;

/* Grows all kinds: a pure function of the seed, plants_seed in every world. 0.3 s of one processor. */
static const uint64_t plants_seed = 1995;
Status                plants_create(Plants **out, uint64_t seed, Pool *pool);
void                  plants_destroy(Plants *plants);

/* Whether a point of a card is within its outline; boundary counts as within. */
bool plants_within_outline(const LeafOutline *outline, float u, float v);
/* The leaf at a place of a card, from 1; 0: none, or beside the card. */
static inline int plants_leaflet(const LeafPattern *pattern, float u, float v)
{
    if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) return 0;
    return pattern->leaflet[(int)(v * plant_pattern_side)][(int)(u * plant_pattern_side)];
}

/* Reflectance of a place of bark or stone over the mean of its kind (mean 1 over the surface), and the bend of its
 * normal: slopes along and about the axis. p_plant: on the prototype, in metres of the standing plant (so that relief
 * does not grow with the tree); footprint_m: finer relief is left out. */
void plants_bark(float *albedo, float slope[2], PlantKind kind, uint32_t plant, const float p_m[3], float footprint_m);
/* Reflectance of one leaf over the mean of its kind. */
float plants_leaf_albedo(PlantKind kind, uint32_t plant, uint32_t leaf);

/* A place on a card of plant_fine: its reflectance over the mean of its kind (mean 1 over the leaves), and the slope of
 * its own leaf's half against the card, along the card's sides u and v. */
typedef struct LeafPlace {
    float albedo, slope[2];
} LeafPlace;
LeafPlace plants_leaf_place(const Plants *plants, PlantKind kind, uint32_t plant, const PlantQuad *quad,
                            uint32_t number, const float uv[2]);

#endif
