/* render/trace/plants/plants.h: one prototype of every kind of plant, grown from a seed: branches of six-sided prisms,
 * leaves as flat cards that carry an outline, at two levels of detail.
 *
 * Axes: x, y, z up along the trunk; the foot is at the origin and the plant 1 m high. */
#ifndef RENDER_TRACE_PLANTS_PLANTS_H
#define RENDER_TRACE_PLANTS_PLANTS_H

#include "terrain/woods/plant.h"

enum { plant_levels = 2, plant_outlines = 8, plant_outline_corners_most = 24 };

/* A leaf's outline in its card's own coordinates, 0 .. 1 both ways, counter-clockwise; v = 0 is the stalk. Simple, not
 * necessarily convex. A cluster of leaves at level 1 has an outline of the same kind. */
typedef struct LeafOutline {
    int   corners;
    float uv[plant_outline_corners_most][2];
} LeafOutline;

/* A quad: corners in order; of bark, a side of a prism; of leaves, a flat parallelogram a, a + u, a + u + v, a + v,
 * of which only what is within the outline is there. Quads of bark are flat as well: made so by two parallel edges. */
typedef struct PlantQuad {
    float    corner[4][3];
    uint8_t  organ;           /* PlantOrgan */
    uint8_t  outline;         /* of leaves; 0 .. plant_outlines - 1 */
    uint16_t piece;           /* branch or leaf, numbered within its organ */
    float    n[4][3];         /* unit shading normals at the corners, outwards; of leaves: of the card */
    float    radius;          /* of the branch, over the plant's height; leaves 0 */
    float open_up, open_down; /* shares of even light from above, and from below, that reach the quad's front (leaves:
                               * both sides) past its own plant, weighted by the cosine, 0 .. 1; 1 until
                               * forest_openness has found them */
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

typedef struct Plants {
    PlantShape  shape[PLANT_KINDS][plant_levels];
    LeafOutline outline[PLANT_KINDS][plant_outlines];
    float       outline_area[PLANT_KINDS][plant_outlines]; /* share of the card */
} Plants;

/* Grows all kinds: a pure function of the seed. 0.5 s or less with a pool. */
Status plants_create(Plants **out, uint64_t seed, Pool *pool);
void   plants_destroy(Plants *plants);

/* Whether a point of a card is within its outline; boundary counts as within. */
bool plants_within_outline(const LeafOutline *outline, float u, float v);

/* Reflectance of a place of bark or stone over the mean of its kind (mean 1 over the surface), and the bend of its
 * normal: slopes along and about the axis. p_plant: on the prototype, in metres of the standing plant (so that relief
 * does not grow with the tree); footprint_m: finer relief is left out. */
void plants_bark(float *albedo, float slope[2], PlantKind kind, uint32_t plant, const float p_m[3], float footprint_m);
/* Reflectance of one leaf over the mean of its kind. */
float plants_leaf_albedo(PlantKind kind, uint32_t plant, uint32_t leaf);

#endif
