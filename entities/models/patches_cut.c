/* entities/models/patches_cut.c: a triangle cut into the cells of its body: by face and by length.
 *
 * Shading normals, not those of facets, say where a surface faces, interpolated over the triangle: the border between
 * two faces of a cylinder is then where it is on the true surface, however few facets it has. All cuts are straight
 * lines in barycentric coordinates, for what is compared is linear there. */
#include "entities/models/patches_private.h"

/* Planes at 45 degrees are up or down rather than sideways, and left or right rather than fore or aft: an exact tie
 * would be decided by rounding. */
static const double axis_weight[3] = {0.996, 0.998, 1.0};
static const double around_score = 0.7; /* cosine of the angle to the axis, below which a surface is around it */
static const double shading_least = 0.3; /* cosine to the facet's normal; below that the shading normal is not used */
static const double share_least = 1e-13;

void facet_point(double p[3], const Facet *facet, const double at[3])
{
    v3_scale(p, at[0], facet->p[0]);
    v3_add_scaled(p, p, at[1], facet->p[1]);
    v3_add_scaled(p, p, at[2], facet->p[2]);
}

bool facet_read(Facet *f, const Cutter *cutter, int triangle)
{
    const Model    *m = cutter->model;
    const int       part = m->triangle_part[triangle];
    const Body     *body = &cutter->body[cutter->body_of_part[part]];
    const NodePose *move = cutter->body_of_node ? &cutter->body_of_node[part] : NULL;
    double          one[3], other[3];
    for (int k = 0; k < 3; k++) {
        memcpy(f->p[k], m->vertex[m->triangle[triangle][k]], sizeof f->p[k]);
        if (move) {
            double turned[3];
            m3_mul_v3(turned, move->r_body_from_node, f->p[k]);
            v3_add(f->p[k], turned, move->p_body);
        }
        f->along_m[k] = f->p[k][body->along];
    }
    v3_sub(one, f->p[1], f->p[0]);
    v3_sub(other, f->p[2], f->p[0]);
    v3_cross(f->n, one, other);
    const double twice = v3_length(f->n);
    if (!(twice > 0)) return false;
    v3_scale(f->n, 1 / twice, f->n);
    f->area_m2 = 0.5 * twice;
    for (int k = 0; k < 3; k++) {
        const float *shading = m->normal[m->triangle[triangle][k]];
        double       n[3] = {shading[0], shading[1], shading[2]};
        if (move) {
            double turned[3];
            m3_mul_v3(turned, move->r_body_from_node, n);
            memcpy(n, turned, sizeof n);
        }
        if (!(v3_dot(n, f->n) >= shading_least)) memcpy(n, f->n, sizeof n);
        if (body->faces == 3) {
            f->score[0][k] = v3_dot(n, body->axis);
            f->score[1][k] = -f->score[0][k];
            f->score[2][k] = around_score;
        } else {
            for (int i = 0; i < 3; i++) {
                f->score[2 * i][k]     = axis_weight[i] * n[i];
                f->score[2 * i + 1][k] = -f->score[2 * i][k];
            }
        }
    }
    return true;
}

/* Keeps where a function, given at the triangle's corners, is at least 0. */
static void clip(Piece *piece, const double value[3], int border)
{
    Piece out = {.corners = 0};
    for (int i = 0; i < piece->corners; i++) {
        const int    j = i + 1 < piece->corners ? i + 1 : 0;
        const double a = v3_dot(piece->at[i], value), b = v3_dot(piece->at[j], value);
        if (a >= 0) {
            memcpy(out.at[out.corners], piece->at[i], sizeof out.at[0]);
            out.border[out.corners++] = piece->border[i];
        }
        if ((a >= 0) != (b >= 0)) {
            /* on the other side of the cut a and b have opposite signs: the same bits */
            const double t = a / (a - b);
            for (int k = 0; k < 3; k++)
                out.at[out.corners][k] = piece->at[i][k] + t * (piece->at[j][k] - piece->at[i][k]);
            out.border[out.corners++] = a >= 0 ? border : piece->border[i];
        }
        if (out.corners + 2 > piece_corners) break; /* rounding alone could get here */
    }
    *piece = out;
}

/* Area of a polygon as a share of the triangle. */
static double share_of(const Piece *piece)
{
    double twice = 0;
    for (int i = 1; i + 1 < piece->corners; i++) {
        const double *o = piece->at[0], *a = piece->at[i], *b = piece->at[i + 1];
        twice += (a[1] - o[1]) * (b[2] - o[2]) - (a[2] - o[2]) * (b[1] - o[1]);
    }
    return twice; /* the triangle itself is half a unit square */
}

static int best_face(const Facet *f, int faces, int corner)
{
    int best = 0;
    for (int o = 1; o < faces; o++)
        if (f->score[o][corner] > f->score[best][corner]) best = o;
    return best;
}

/* Of a face that looks at the middle of its body from behind it: the inner side of a skirt. */
static bool looks_inwards(const Facet *f, const Body *body, int face)
{
    const int i = face / 2;
    if (body->faces == 3 || i == body->along) return false;
    const double at = (f->p[0][i] + f->p[1][i] + f->p[2][i]) / 3 - body->middle[i];
    return (face % 2 ? -at : at) < -body->inward_m[i];
}

int facet_cut(Piece piece[cells_most], const Facet *f, const Body *body)
{
    static const Piece whole = {.corners = 3, .share = 1, .at = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .border = {0, 1, 2}};
    const double low = fmin(f->along_m[0], fmin(f->along_m[1], f->along_m[2])) - body->low_m;
    const double high = fmax(f->along_m[0], fmax(f->along_m[1], f->along_m[2])) - body->low_m;
    int first = 0, last = 0;
    if (body->lengths > 1) {
        /* a corner that stands on a plane, to rounding, does not cross it */
        first = (int)clamp(floor(low / body->step_m + 1e-9), 0, body->lengths - 1);
        last  = (int)clamp(ceil(high / body->step_m - 1e-9) - 1, first, body->lengths - 1);
    }
    /* a face is a convex cone of normals, so three corners in one face have the triangle in it */
    int face[3];
    for (int k = 0; k < 3; k++) face[k] = best_face(f, body->faces, k);
    const bool one_face = face[0] == face[1] && face[1] == face[2];
    int count = 0;
    for (int l = first; l <= last; l++) {
        Piece slab = whole;
        for (int side = 0; side < 2; side++) {
            const int plane = l + side;
            if (plane <= first || plane > last) continue;
            double value[3];
            for (int k = 0; k < 3; k++)
                value[k] = (side ? -1 : 1) * (f->along_m[k] - body->low_m - plane * body->step_m);
            clip(&slab, value, 3 + plane);
        }
        for (int o = 0; o < body->faces; o++) {
            if (one_face && o != face[0]) continue;
            Piece *p = &piece[count];
            *p = slab;
            for (int q = 0; q < body->faces && !one_face && p->corners >= 3; q++) {
                if (q == o) continue;
                double value[3];
                for (int k = 0; k < 3; k++) value[k] = f->score[o][k] - f->score[q][k];
                clip(p, value, 8 + (o < q ? o * faces_most + q : q * faces_most + o));
            }
            if (p->corners < 3) continue;
            p->share = first == last && one_face ? 1 : share_of(p);
            if (!(p->share > share_least)) continue;
            p->cell = (o + (looks_inwards(f, body, o) ? faces_most : 0)) * lengths_most + l;
            count++;
        }
    }
    return count;
}
