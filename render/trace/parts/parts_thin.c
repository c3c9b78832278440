/* render/trace/parts/parts_thin.c: what of a mesh may be narrower than a pixel while all of it is large: antennas,
 * wires, barrels, rotor blades and, seen edge-on, plates. */
#include "render/trace/parts/parts_private.h"

#include <stdlib.h>

static const double thin_share = 1.0 / 12; /* of a box's longest side: its shortest one */

/* ---- pieces: triangles that share a place ----------------------------------------------------- */

/* A triangle's corner by its place. */
typedef struct Corner {
    const double *p;
    int           triangle;
} Corner;

/* A triangle of a piece. */
typedef struct Member {
    int piece, triangle; /* piece: its first triangle */
} Member;

static int piece_of(Member *m, int t)
{
    while (m[t].piece != t) t = m[t].piece = m[m[t].piece].piece;
    return t;
}

static void join(Member *m, int a, int b)
{
    const int p = piece_of(m, a), q = piece_of(m, b);
    m[p > q ? p : q].piece = p < q ? p : q;
}

static int by_place(const void *a, const void *b)
{
    const Corner *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->p[k] != q->p[k]) return p->p[k] < q->p[k] ? -1 : 1;
    return p->triangle - q->triangle;
}

static int by_piece(const void *a, const void *b)
{
    const Member *p = a, *q = b;
    return p->piece != q->piece ? p->piece - q->piece : p->triangle - q->triangle;
}

/* member: those of a piece one after another. */
static void find_pieces(Member *member, Corner *corner, const NodeMesh *mesh)
{
    const int triangles = mesh->triangle_count, corners = 3 * triangles;
    for (int t = 0; t < triangles; t++) {
        member[t] = (Member){t, t};
        for (int c = 0; c < 3; c++) corner[3 * t + c] = (Corner){parts_corner(mesh, t, c), t};
    }
    qsort(corner, (size_t)corners, sizeof *corner, by_place);
    for (int k = 1; k < corners; k++)
        if (memcmp(corner[k].p, corner[k - 1].p, 3 * sizeof *corner[k].p) == 0)
            join(member, corner[k].triangle, corner[k - 1].triangle);
    for (int t = 0; t < triangles; t++) member[t].piece = piece_of(member, t);
    qsort(member, (size_t)triangles, sizeof *member, by_piece);
}

/* ---- boxes ------------------------------------------------------------------------------------ */

/* The vector from a place to the piece's farthest corner, without what of it is along the first `axes` of the box. */
static double farthest(double out[3], const double from[3], const NodeMesh *mesh, const Member *piece, int count,
                       const ThinBox *box, int axes)
{
    double most = -1;
    for (int k = 0; k < 3 * count; k++) {
        double d[3];
        v3_sub(d, parts_corner(mesh, piece[k / 3].triangle, k % 3), from);
        for (int a = 0; a < axes; a++) v3_add_scaled(d, d, -v3_dot(d, box->axis[a]), box->axis[a]);
        if (v3_dot(d, d) <= most) continue;
        most = v3_dot(d, d);
        memcpy(out, d, sizeof d);
    }
    return sqrt(most);
}

/* A box about a piece, its axes along the longest diagonals found: along a rod, and across a plate. False: it is not
 * thin. */
static bool bound_piece(ThinBox *box, const NodeMesh *mesh, const Member *piece, int count)
{
    double at[3], d[3], low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    memcpy(at, parts_corner(mesh, piece->triangle, 0), sizeof at);
    for (int axis = 0; axis < 2; axis++) { /* to one end, and from it to the other */
        farthest(d, at, mesh, piece, count, box, axis);
        v3_add(at, at, d);
        if (!(farthest(d, at, mesh, piece, count, box, axis) > 0)) return false;
        v3_normalize(box->axis[axis], d);
    }
    v3_cross(box->axis[2], box->axis[0], box->axis[1]);
    for (int k = 0; k < 3 * count; k++)
        for (int a = 0; a < 3; a++) {
            const double x = v3_dot(parts_corner(mesh, piece[k / 3].triangle, k % 3), box->axis[a]);
            low[a] = x < low[a] ? x : low[a];
            high[a] = x > high[a] ? x : high[a];
        }
    v3_scale(box->centre, 0, box->axis[0]);
    for (int a = 0; a < 3; a++) {
        box->half[a] = 0.5 * (high[a] - low[a]);
        v3_add_scaled(box->centre, box->centre, 0.5 * (low[a] + high[a]), box->axis[a]);
    }
    return fmin(box->half[1], box->half[2]) <= thin_share * box->half[0];
}

/* The thin pieces into out, or counted alone where it is NULL. */
static int take_thin(ThinBox *out, const NodeMesh *mesh, const Member *member)
{
    int thin = 0;
    for (int first = 0, end; first < mesh->triangle_count; first = end) {
        ThinBox box;
        for (end = first + 1; end < mesh->triangle_count && member[end].piece == member[first].piece; end++) {
        }
        if (!bound_piece(&box, mesh, member + first, end - first)) continue;
        if (out) out[thin] = box;
        thin++;
    }
    return thin;
}

Status parts_list_thin(NodeMesh *mesh)
{
    const size_t triangles = (size_t)mesh->triangle_count;
    Member      *member = calloc(triangles, sizeof *member);
    Corner      *corner = calloc(3 * triangles, sizeof *corner);
    Status       status = member && corner ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        find_pieces(member, corner, mesh);
        mesh->thin_count = take_thin(NULL, mesh, member);
        mesh->thin = calloc((size_t)mesh->thin_count + 1, sizeof *mesh->thin);
        if (mesh->thin) take_thin(mesh->thin, mesh, member);
        else status = STATUS_NO_MEMORY;
    }
    free(member);
    free(corner);
    return status;
}

const ThinBox *parts_node_thin(const PosedNode *node, int *count)
{
    *count = node->mesh->thin_count;
    return node->mesh->thin;
}
