/* entities/models/patches_private.h: bodies, and triangles cut into their cells. */
#ifndef ENTITIES_MODELS_PATCHES_PRIVATE_H
#define ENTITIES_MODELS_PATCHES_PRIVATE_H

#include "entities/models/patches.h"

enum {
    faces_most = 6,
    lengths_most = 4,
    cells_most = 2 * faces_most * lengths_most,
    piece_corners = 16, /* a triangle, two planes across and five lines between faces: 3 + 2 + 5 at most */
};

/* Parts that are cut together; described in the axes of one node. */
typedef struct Body {
    int      node, part; /* part: the first of them */
    HeatRole role;
    int      faces; /* 6: half axes of the node; 3: along axis, against it, around it */
    double   axis[3];
    double middle[3], inward_m[3]; /* middle of its box in the node's axes; distance behind the middle from which a face
                                      looks inwards */
    int    along, lengths;         /* lengths cut along this axis of the node */
    double low_m, step_m;          /* start of the first length, and its extent */
    double box_low[3], box_high[3]; /* box at rest, in the model's body axes */
    double box_m2;                  /* surface of its box in the node's axes: hardly depends on the chord error */
    double area_m2;
    int    map[cells_most]; /* patch of each cell, from 0; cell = (face, + faces_most: inwards) lengths_most + length */
    int    first, count;    /* its patches */
} Body;

/* Finds how much of a model's surface lies inside it: patches_hidden.c. */
typedef struct Hidden Hidden;

typedef struct Cutter {
    const Model *model;
    Hidden      *hidden;
    int          bodies, wanted;
    Body         body[patches_most];
    int         *body_of_part; /* [part_count] */
    NodePose    *pose;         /* nodes at rest [node_count] */
    NodePose    *body_of_node; /* as in Patches */
} Cutter;

/* ---- patches_cut.c: bodies --------------------------------------------------------------------- */

/* Ways to group parts, from fine to coarse. */
typedef enum Grouping { BY_MATERIAL, BY_NODE_ROLE, BY_ROLE, GROUPINGS } Grouping;

/* Groups parts into bodies. Returns false when there are more than patches_most. */
bool patches_group(Cutter *cutter, Grouping grouping);
/* Chooses the node of bodies with parts of several nodes: that of the largest part. */
Status patches_choose_nodes(Cutter *cutter);
/* Measures the extents of the bodies at rest, and chooses their lengths and faces. */
void patches_measure_bodies(Cutter *cutter);
/* A point of a node, moved by its pose. */
static inline void patches_moved(double out[3], const NodePose *pose, const double p[3])
{
    double r[3];
    m3_mul_v3(r, pose->r_body_from_node, p);
    v3_add(out, r, pose->p_body);
}

/* ---- patches_cut.c: triangles ------------------------------------------------------------------ */

/* One triangle in its body's axes. */
typedef struct Facet {
    double p[3][3];
    double n[3]; /* unit normal of its plane */
    double area_m2;
    double score[faces_most][3]; /* score of each face at each corner, which belongs to the face with the highest */
    double along_m[3];
} Facet;

/* The part of a triangle in one cell: a convex polygon in barycentric coordinates. border[i] is that from corner i to
 * the next: 0 .. 2 an edge of the triangle (from its corner i), above a cut; equal cuts of a triangle are one line. */
typedef struct Piece {
    int    cell, corners;
    double share; /* share of the triangle's area */
    double at[piece_corners][3];
    int    border[piece_corners];
} Piece;

bool facet_read(Facet *out, const Cutter *cutter, int triangle);               /* false: the triangle has no area */
int  facet_cut(Piece piece[cells_most], const Facet *facet, const Body *body); /* returns the number of pieces */
void facet_point(double p[3], const Facet *facet, const double at[3]);

/* ---- patches_hidden.c -------------------------------------------------------------------------- */

/* pose: of the nodes at rest. It keeps model, not pose. STATUS_NO_MEMORY. */
Status hidden_create(Hidden **out, const Model *model, const NodePose *pose);
void   hidden_destroy(Hidden *hidden); /* accepts NULL */
/* Share of a triangle that is not inside parts in every pose, 0 .. 1. */
double hidden_open(const Hidden *hidden, int triangle);
/* Whether a point of a triangle, with its unit normal, is inside other parts. */
bool hidden_at(Hidden *hidden, int triangle, const double p_body[3], const double n_body[3]);

/* ---- patches_links.c --------------------------------------------------------------------------- */

/* Finds the links. The patches in `out` are finished except for these. Fails with STATUS_NO_MEMORY. */
Status patches_link(Patches *out, const Cutter *cutter);

#endif
