/* entities/models/patches.h: a model's surface cut into patches, the nodes of its thermal network.
 *
 * A body is a group of parts of one node, role and material, usually one part. It is cut by the direction in which
 * its surface faces (shading normals; the six half axes of its node) and along its longest extent into 1 .. 4 equal
 * lengths of about 1.5 m. What spins or rolls is cut by its axis only: towards it, against it, and around it, for a
 * turning tyre shares its heat. What looks at the middle of a body from behind it (the inner side of one of two
 * skirts) is apart from what looks away. Cells of less than 2 % of their body, or of 0.01 m2 beside larger ones,
 * join the nearest. Cuts go through triangles, so areas are those of the triangles, to 1e-9.
 *
 * Large models are cut less finely until some patches_wanted patches are to be expected: small bodies become one patch,
 * then lengths are joined, then all sides but the underside, then each body is one patch (up to patches_most of them),
 * then bodies are groups of one node and role, at last of one role.
 *
 * Faces that lie inside closed parts are no outer surface (patches_hidden.c): those by which parts join, and the
 * inner faces of a hull made of slices. They still decide how a model is cut. Where a joint is between, they must be
 * inside at every value of it. Faces about a cavity and before open shells are outside. A patch with less than 1 %
 * of it outside is inside as a whole. Error: some 1.6 % of the outer area (tests/entities/test_patches.c).
 *
 * Geometry alone, from the model at rest, and immutable: any number of threads may read it. The model may go.
 * Built-in models of 12 k triangles take about 35 ms, a ship of 39 k 300 ms, a file of 97 k dense ones 0.9 s, most
 * of it to find what is inside. A coarse and a fine build of a model may differ by some patches. */
#ifndef ENTITIES_MODELS_PATCHES_H
#define ENTITIES_MODELS_PATCHES_H

#include "entities/models/model.h"

#include "pitviper_kept.h"

enum { patches_most = 160, patches_wanted = 110, patch_points = 4 };

typedef struct Patch {
    int      node, part; /* the node in whose axes it is; the first part of its body */
    HeatRole role;       /* role of its parts */
    double   area_m2;    /* area of all its triangles */
    double   open_share; /* share of that area that is not inside other parts; 0: all of it is inside. The figures below
                            are of this share; where it is 0, of the whole patch */
    double ground_m2;    /* area that lies on level ground at the base: within 2 cm of it, facing down */
    double p_node[3];    /* centroid by area */
    double n_node[3];    /* unit mean normal; up where the mean is zero */
    double facing;       /* length of the mean normal: 1 for a plane, 0 for a surface that faces all ways */
    double reach_m;      /* standard distance of its surface from the centroid */
    /* Points on its triangles, spread over its area and directions, with those triangles' unit normals: where rays
     * start. Each stands for about a quarter of the area. */
    double point_node[patch_points][3], point_n_node[patch_points][3];
} Patch;

static inline double patch_open_m2(const Patch *patch) { return patch->area_m2 * patch->open_share; }
/* The area by which a patch counts in the network: its outer surface, or all of it when it is inside. */
static inline double patch_skin_m2(const Patch *patch)
{
    return patch->open_share > 0 ? patch->area_m2 * patch->open_share : patch->area_m2;
}

/* Two patches that adjoin: conductance = conductivity thickness length / distance. */
typedef struct PatchLink {
    int    a, b;
    double length_m;   /* length of the common border */
    double distance_m; /* distance between the centroids, at least 0.02 m */
    bool   joint;      /* without a common border: between bodies, or between shells of one body that only touch */
} PatchLink;

typedef struct Patches {
    int        count, links, bodies, parts;
    Patch     *patch;         /* [count] patches; those of a body are contiguous */
    PatchLink *link;          /* a < b, each pair once, ascending [links] */
    int       *body_of_part;  /* [parts] */
    int       *first_of_body; /* [bodies + 1] */
    NodePose  *body_of_node;  /* from a part's node to its body's axes, at rest [parts]; NULL: bodies are of one node */
} Patches;

/* model: one that passes model_check. STATUS_NO_MEMORY is the only failure; then *out is zeroes. */
Status patches_create(Patches *out, const Model *model);
/* As patches_create, with another number of patches wanted; there may be up to patches_most. */
Status patches_create_of(Patches *out, const Model *model, int wanted);
void   patches_destroy(Patches *patches); /* frees and zeroes; accepts zeroes */
/* As patches_create, from the cache, or into it. cache may be NULL. */
Status patches_create_kept(Patches *out, const Model *model, Cache *cache);
/* KeptValues of the patches of a model: of zeroes while they are read. After what is wrong patches_destroy. */
typedef struct PatchesKept {
    Patches     *patches;
    const Model *model;
} PatchesKept;
KeptValues patches_kept_values;

/* Temperature (or any value) at a point of a part's surface and its unit normal there, in the axes of the part's node,
 * from value[count]: those of its body's patches, blended by distance and by how much they face the same way. Never
 * outside their range, and a constant exactly; continuous over a surface without sharp edges. Where no patch faces
 * that way, the nearest. A part out of range: value[0]; NaN in p or n: one of the body's values. About 5 ns a patch of
 * the body. */
double patches_value(const Patches *patches, const float *value, int part, const double p_node[3],
                     const double n_node[3]);

#endif
