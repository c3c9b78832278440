/* render/trace/visibility/broad_phase_private.h: the tree over spheres, shared by broad_phase.c, which builds it, and
 * broad_phase_rays.c. */
#ifndef RENDER_TRACE_VISIBILITY_BROAD_PHASE_PRIVATE_H
#define RENDER_TRACE_VISIBILITY_BROAD_PHASE_PRIVATE_H

#include "render/trace/visibility/broad_phase.h"

enum { leaf_items = 4, morton_bits = 21, deepest = 32 };

typedef struct Box {
    double low[3], high[3]; /* empty: low > high */
} Box;

struct BroadPhase {
    int  count;
    int  leaves;         /* a power of two */
    Box *node;           /* [2 leaves], from 1: the root */
    int *item;           /* [count], in the order of the leaves */
    double (*sphere)[4]; /* [count], likewise: centre and radius */
    Box *ray_node, *box; /* [2 leaves], [count]: those that rays are tested with; within node and sphere */
};

static inline void grow(Box *box, const double s[4])
{
    /* a million times the rounding error, at any distance from the origin */
    const double room_m = s[3] * (1 + 1e-9) + 1e-6 + 1e-10 * (fabs(s[0]) + fabs(s[1]) + fabs(s[2]));
    for (int c = 0; c < 3; c++) {
        box->low[c] = fmin(box->low[c], s[c] - room_m);
        box->high[c] = fmax(box->high[c], s[c] + room_m);
    }
}

static const Box empty_box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static inline Box box_of_sphere(const double s[4])
{
    Box box = empty_box;
    grow(&box, s);
    return box;
}

/* A box about all that it holds, raised: by no less than where it is nearest, no more than where it is farthest. */
static inline Box raised(const Box *box, const BroadLift *lift)
{
    Box    out = *box;
    double near2 = 0, far2 = 0;
    for (int c = 0; c < 2; c++) {
        const double low = box->low[c] - lift->eye_enu[c], high = box->high[c] - lift->eye_enu[c];
        const double far = fabs(low) > fabs(high) ? low : high, near = low > 0 ? low : high < 0 ? high : 0;
        near2 += near * near, far2 += far * far;
    }
    out.low[2] += lift->bend_per_m * near2 * (1 - 1e-9), out.high[2] += lift->bend_per_m * far2 * (1 + 1e-9);
    return out;
}

#endif
