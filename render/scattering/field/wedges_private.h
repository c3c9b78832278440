/* render/scattering/field/wedges_private.h: the straight edges of a model that scatter as wedges.
 *
 * Faces that meet in an edge are those of one part whose corners coincide within weld_m; edges with one face only are
 * closed with those of the node's other parts. What an edge is follows from the directions of its faces about it:
 *
 *     one         a half plane: an open boundary, or the rim of a sheet modelled with both of its sides
 *     two         a wedge, where the angle through free space exceeds pi; seen from behind as well where the part is
 *                 open or the faces are two-sided. Faces that turn by less than angle_rad are one surface; so are
 *                 those whose vertex normals differ by less at either end (facets of a curved surface)
 *     more        a wedge, where free space between two of them spans more than pi; else left out and counted
 *
 * Concave edges are left out: rays that bounce between their faces account for most of them. Pieces that continue one
 * another in a straight line with the same faces (to 1e-3 rad) are one wedge. Order follows the model's own vertices.
 * */
#ifndef RENDER_SCATTERING_FIELD_WEDGES_PRIVATE_H
#define RENDER_SCATTERING_FIELD_WEDGES_PRIVATE_H

#include "entities/models/model.h"

/* z along the edge; x in face 1, away from the edge; y = z x x: the outward normal of face 1. Face 2 is at the angle
 * exterior_pi pi from face 1, counted from x to y through free space: 1 < exterior_pi <= 2; 2: a half plane. */
typedef struct WedgeFrame {
    double x[3], y[3], z[3];
    double exterior_pi;
} WedgeFrame;

typedef struct WedgeConfig {
    double weld_m;    /* > 0; 1e-4 */
    double angle_rad; /* least turn of the surface, 0 .. pi; 0.26 (15 degrees) */
} WedgeConfig;
WedgeConfig wedges_default_config(void);

typedef struct Wedge {
    WedgeFrame frame;
    double     p[2][3]; /* ends; z of the frame leads from the first to the second */
    int        node, part;
} Wedge;

typedef struct WedgeList {
    int    count;
    Wedge *wedge;              /* node axes */
    int    concave, junctions; /* pieces left out: of two faces, of more */
} WedgeList;

/* model: one that passes model_check. STATUS_NO_MEMORY is the only failure. */
Status wedges_find(WedgeList *out, const Model *model, const WedgeConfig *config);
void   wedges_destroy(WedgeList *list); /* frees and zeroes; accepts zeroes */

/* place[vertex_count]: for each vertex, the first of those of its node that lie within weld_m of it. */
Status wedges_weld(int *place, const Model *model, double weld_m);

/* Wedges [list->count] in body axes, moved by -origin_body (the phase centre); pose: of all nodes. */
void wedges_place(Wedge *out, const WedgeList *list, const NodePose *pose, const double origin_body[3]);

#endif
