/* entities/models/patches_cut.c: bodies of a model, and triangles cut into the cells of their bodies: by face and by
 * length.
 *
 * Shading normals, not those of facets, say where a surface faces, interpolated over the triangle: the border between
 * two faces of a cylinder is then where it is on the true surface, however few facets it has. All cuts are straight
 * lines in barycentric coordinates, for what is compared is linear there. */
#include "entities/models/patches_private.h"

#include <stdlib.h>

static const double length_m = 1.5;       /* approximate extent of one length of a body */
static const double length_least_m = 1.0; /* bodies shorter than this are not cut into lengths */
static const double inward_least_m = 1;   /* bodies narrower than this have no inner sides */
static const double prefer_axis =
    1.03; /* an extent counts as longer only by this factor, so x is preferred to y, and y to z */

/* ---- bodies ----------------------------------------------------------------------------------- */

static bool belongs(const Model *m, const ModelPart *part, const Body *body, Grouping grouping)
{
    if (part->role != body->role) return false;
    if (grouping == BY_ROLE) return true;
    return part->node == body->node &&
           (grouping == BY_NODE_ROLE || (strcmp(part->material, m->part[body->part].material) == 0 &&
                                         part->thickness_m == m->part[body->part].thickness_m));
}

bool patches_group(Cutter *c, Grouping grouping)
{
    const Model *m = c->model;
    c->bodies = 0;
    for (int i = 0; i < m->part_count; i++) {
        int b = 0;
        while (b < c->bodies && !belongs(m, &m->part[i], &c->body[b], grouping)) b++;
        if (b == patches_most) return false;
        if (b == c->bodies) c->body[c->bodies++] = (Body){.node = m->part[i].node, .part = i, .role = m->part[i].role};
        c->body_of_part[i] = b;
    }
    return true;
}

/* How one node's axes are seen from another's, at rest. */
static NodePose seen_from(const NodePose *to, const NodePose *from)
{
    NodePose out;
    double   d[3];
    m3_tmul(out.r_body_from_node, to->r_body_from_node, from->r_body_from_node);
    v3_sub(d, from->p_body, to->p_body);
    m3_tmul_v3(out.p_body, to->r_body_from_node, d);
    return out;
}

Status patches_choose_nodes(Cutter *c)
{
    const Model *m = c->model;
    double       largest_m2[patches_most] = {0};
    free(c->body_of_node);
    c->body_of_node = calloc((size_t)m->part_count, sizeof *c->body_of_node);
    if (!c->body_of_node) return STATUS_NO_MEMORY;
    for (int i = 0; i < m->part_count; i++) {
        const int b = c->body_of_part[i];
        double    area_m2 = 0;
        for (int t = m->part[i].first_triangle; t < m->part[i].first_triangle + m->part[i].triangle_count; t++) {
            const uint32_t *v = m->triangle[t];
            double          one[3], other[3], cross[3];
            v3_sub(one, m->vertex[v[1]], m->vertex[v[0]]);
            v3_sub(other, m->vertex[v[2]], m->vertex[v[0]]);
            v3_cross(cross, one, other);
            area_m2 += 0.5 * v3_length(cross);
        }
        if (!(area_m2 > largest_m2[b] * (1 + 1e-3))) continue;
        largest_m2[b] = area_m2;
        c->body[b].node = m->part[i].node;
    }
    for (int i = 0; i < m->part_count; i++)
        c->body_of_node[i] = seen_from(&c->pose[c->body[c->body_of_part[i]].node], &c->pose[m->part[i].node]);
    return STATUS_OK;
}

/* Whether a node turns by itself or rolls, or one of its parents does, and about which of its axes. */
static bool turns(double axis[3], const Cutter *c, int node)
{
    for (int n = node; n >= 0; n = c->model->node[n].parent) {
        const ModelNode *at = &c->model->node[n];
        if (at->joint != JOINT_ROTATION || !(at->spin_rps_moving != 0 || at->roll_radius_m > 0)) continue;
        double axis_body[3];
        m3_mul_v3(axis_body, c->pose[n].r_body_from_node, at->axis);
        m3_tmul_v3(axis, c->pose[node].r_body_from_node, axis_body);
        return true;
    }
    return false;
}

static void widen(double low[3], double high[3], const double p[3])
{
    for (int i = 0; i < 3; i++) {
        low[i] = fmin(low[i], p[i]);
        high[i] = fmax(high[i], p[i]);
    }
}

/* The top of the arc over an edge with these shading normals: exact for a circle, the edge's middle for a plane. False:
 * there is none. So the extents of a coarse build are those of a fine one. */
static bool arc_top(double top[3], const double p[3], const double q[3], const float np[3], const float nq[3])
{
    const double n1[3] = {np[0], np[1], np[2]}, n2[3] = {nq[0], nq[1], nq[2]};
    double       turn[3], chord[3], mean[3];
    v3_sub(turn, n2, n1);
    v3_sub(chord, q, p);
    v3_add(mean, n1, n2);
    const double change = v3_length(turn), bent = v3_dot(turn, chord), cos_half = 0.5 * v3_length(mean);
    /* at most a quarter of a circle, since what turns faster is the edge of a solid */
    if (!(bent > 0 && change > 1e-3 && cos_half > 0.7)) return false;
    const double height = 0.5 * bent / change * sqrt((1 - cos_half) / (1 + cos_half)); /* half chord tan(angle / 4) */
    v3_add_scaled(top, p, 0.5, chord);
    v3_add_scaled(top, top, 0.5 * height / cos_half, mean);
    return true;
}

void patches_measure_bodies(Cutter *c)
{
    const Model *m = c->model;
    double       low[patches_most][3], high[patches_most][3];
    for (int b = 0; b < c->bodies; b++)
        for (int i = 0; i < 3; i++) {
            low[b][i] = c->body[b].box_low[i] = INFINITY;
            high[b][i] = c->body[b].box_high[i] = -INFINITY;
        }
    for (int t = 0; t < m->triangle_count; t++) {
        const int       part = m->triangle_part[t], b = c->body_of_part[part];
        const uint32_t *v = m->triangle[t];
        Body           *body = &c->body[b];
        for (int k = 0; k < 6; k++) {
            double p[3], q[3];
            if (k < 3) memcpy(p, m->vertex[v[k]], sizeof p);
            else if (!arc_top(p, m->vertex[v[k - 3]], m->vertex[v[(k - 2) % 3]], m->normal[v[k - 3]],
                              m->normal[v[(k - 2) % 3]]))
                continue;
            patches_moved(q, &c->pose[m->part[part].node], p);
            widen(body->box_low, body->box_high, q);
            if (c->body_of_node) {
                patches_moved(q, &c->body_of_node[part], p);
                memcpy(p, q, sizeof p);
            }
            widen(low[b], high[b], p);
        }
    }
    for (int b = 0; b < c->bodies; b++) {
        Body *body = &c->body[b];
        body->faces = turns(body->axis, c, body->node) ? 3 : 6;
        body->along = 0;
        for (int i = 1; i < 3; i++)
            if (high[b][i] - low[b][i] > prefer_axis * (high[b][body->along] - low[b][body->along])) body->along = i;
        const double extent = high[b][body->along] - low[b][body->along];
        const bool   uncut = body->faces == 3 || !(extent >= length_least_m);
        body->lengths = uncut ? 1 : (int)clamp(floor(extent / length_m + 0.5), 1, lengths_most);
        body->low_m = low[b][body->along];
        body->step_m = extent / body->lengths;
        double size[3];
        v3_sub(size, high[b], low[b]);
        for (int i = 0; i < 3; i++) {
            body->middle[i] = 0.5 * (low[b][i] + high[b][i]);
            body->inward_m[i] = size[i] > inward_least_m ? 0.15 * size[i] : INFINITY;
        }
        body->box_m2 = 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
    }
}

/* ---- triangles ---------------------------------------------------------------------------------- */

/* A normal at 45 degrees counts as up or down rather than sideways, and as left or right rather than fore or aft;
 * rounding would decide an exact tie. */
static const double axis_weight[3] = {0.996, 0.998, 1.0};
static const double around_score = 0.7;  /* cosine of the angle to the axis, below which a surface is around it */
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
                f->score[2 * i][k] = axis_weight[i] * n[i];
                f->score[2 * i + 1][k] = -f->score[2 * i][k];
            }
        }
    }
    return true;
}

/* Keeps the part where a function, given at the triangle's corners, is at least 0. */
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
            /* on the other side of the cut a and b have opposite signs, so the result has the same bits */
            const double t = a / (a - b);
            for (int k = 0; k < 3; k++)
                out.at[out.corners][k] = piece->at[i][k] + t * (piece->at[j][k] - piece->at[i][k]);
            out.border[out.corners++] = a >= 0 ? border : piece->border[i];
        }
        if (out.corners + 2 > piece_corners) break; /* only rounding could lead here */
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

/* Whether a face looks at the middle of its body from behind it, as the inner side of a skirt does. */
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
    const double       low = fmin(f->along_m[0], fmin(f->along_m[1], f->along_m[2])) - body->low_m;
    const double       high = fmax(f->along_m[0], fmax(f->along_m[1], f->along_m[2])) - body->low_m;
    int                first = 0, last = 0;
    if (body->lengths > 1) {
        /* a corner that stands on a plane, to rounding, does not cross it */
        first = (int)clamp(floor(low / body->step_m + 1e-9), 0, body->lengths - 1);
        last = (int)clamp(ceil(high / body->step_m - 1e-9) - 1, first, body->lengths - 1);
    }
    /* a face is a convex cone of normals, so three corners in one face have the triangle in it */
    int face[3];
    for (int k = 0; k < 3; k++) face[k] = best_face(f, body->faces, k);
    const bool one_face = face[0] == face[1] && face[1] == face[2];
    int        count = 0;
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
