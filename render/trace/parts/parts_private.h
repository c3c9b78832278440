/* render/trace/parts/parts_private.h: a node's triangles, built by parts.c and parts_thin.c, traced by parts_trace.c.
 */
#ifndef RENDER_TRACE_PARTS_PARTS_PRIVATE_H
#define RENDER_TRACE_PARTS_PARTS_PRIVATE_H

#include <embree3/rtcore.h>

#include "render/trace/parts/parts.h"

enum { patch_corners = 4, patch_most = 2 };

/* One or two triangles in the form of the exact test, which share one of Embree's boxes: two have a side in common.
 * Two lines of a cache. */
typedef struct Patch {
    double   corner[patch_corners][3]; /* node axes; the first triangle's, and the second's fourth */
    float    height_m[patch_most][3];  /* over the side from corner c to the next */
    uint32_t triangle;                 /* of the model: the first; the second is the next */
    uint8_t  count, second[3];         /* triangles; corners of the second */
} __attribute__((aligned(64))) Patch;

struct NodeMesh {
    const Model *model;
    int          node;
    uint8_t      damage_hidden; /* of all its parts: ModelPart */
    RTCScene     scene;         /* of its patches' boxes, with margin, about `centre` */
    int          triangle_count;
    uint32_t    *triangle; /* of the model, ascending */
    int          patch_count;
    Patch       *patch; /* in the same order */
    int          corner_count;
    double (*corner)[3];   /* every vertex of its triangles, once; the outermost first */
    double (*block)[2][3]; /* of every parts_block_corners of them: low and high, with margin */
    double   centre[3];    /* of a sphere and a box round its vertices, node axes */
    double   radius_m;     /* both with margin for the conversion to float */
    double   half[3];
    int      thin_count;
    ThinBox *thin;
};

/* Corner c of its triangle number t, in its axes. */
static inline const double *parts_corner(const NodeMesh *mesh, int t, int c)
{
    return mesh->model->vertex[mesh->model->triangle[mesh->triangle[t]][c]];
}

/* Sets patch and patch_count (parts_patches.c). */
Status parts_list_patches(NodeMesh *mesh);
/* A box about a patch, node axes; low above high: none of its facets has an area. */
void parts_bound_patch(double low[3], double high[3], const NodeMesh *mesh, uint32_t patch);

/* Sets thin and thin_count (parts_thin.c). */
Status parts_list_thin(NodeMesh *mesh);

/* Embree's callback for the boxes that rays pass through: parts_trace.c. */
void parts_intersect(const struct RTCIntersectFunctionNArguments *a);
void parts_occlude(const struct RTCOccludedFunctionNArguments *a);

#endif
