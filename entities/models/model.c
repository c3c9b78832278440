/* entities/models/model.c: creation, poses and destruction of models. */
#include "entities/models/model.h"

#include <stdio.h>
#include <stdlib.h>

static const char *const role_name[HEAT_ROLE_COUNT] = {
    "passive",  "hull",   "turret",  "engine_deck", "exhaust", "gun",      "track",    "wheel",
    "cabin",    "rotor",  "turbine", "motor",       "nose",    "airframe", "skin",     "clothing",
    "dwelling", "window", "flue",    "flare",       "fire",    "ember",    "smoulder", "wreck",
};

const char *heat_role_name(HeatRole role) { return (unsigned)role < HEAT_ROLE_COUNT ? role_name[role] : "?"; }

bool heat_role_find(HeatRole *out, const char *name)
{
    for (int r = 0; r < HEAT_ROLE_COUNT; r++)
        if (strcmp(role_name[r], name) == 0) {
            *out = (HeatRole)r;
            return true;
        }
    return false;
}

void model_destroy(Model *model)
{
    free(model->node);
    free(model->part);
    free(model->vertex);
    free(model->normal);
    free(model->triangle);
    free(model->triangle_part);
    memset(model, 0, sizeof *model);
}

/* ---- poses ------------------------------------------------------------------------------------ */

static double joint_value(const ModelNode *node, double value)
{
    if (!isfinite(value)) value = 0;
    return node->low <= node->high ? clamp(value, node->low, node->high) : value;
}

/* Rotation about an axis by Rodrigues' formula; with a unit axis the matrix is orthonormal to a few 1e-16. */
static void turn_about(double r[9], const double a[3], double angle_rad)
{
    const double c = cos(angle_rad), s = sin(angle_rad), half = sin(0.5 * angle_rad);
    const double v = 2 * half * half; /* 1 - cos, without the cancellation at small angles */
    const double m[9] = {c + v * a[0] * a[0],        v * a[0] * a[1] - s * a[2], v * a[0] * a[2] + s * a[1],
                         v * a[0] * a[1] + s * a[2], c + v * a[1] * a[1],        v * a[1] * a[2] - s * a[0],
                         v * a[0] * a[2] - s * a[1], v * a[1] * a[2] + s * a[0], c + v * a[2] * a[2]};
    memcpy(r, m, sizeof m);
}

/* Pose of a node in its parent at one (already limited) joint value. */
static void node_in_parent(double p[3], double r[9], const ModelNode *node, double value)
{
    memcpy(p, node->p_parent, 3 * sizeof *p);
    memcpy(r, node->r_parent_from_node, 9 * sizeof *r);
    if (node->joint == JOINT_ROTATION) {
        double turn[9];
        turn_about(turn, node->axis, value);
        m3_mul(r, node->r_parent_from_node, turn);
    } else if (node->joint == JOINT_TRANSLATION) {
        double d[3];
        m3_mul_v3(d, node->r_parent_from_node, node->axis);
        v3_add_scaled(p, p, value, d);
    }
}

void model_pose(NodePose *pose, const Model *model, const double *value)
{
    for (int i = 0; i < model->node_count; i++) {
        const ModelNode *node = &model->node[i];
        double           p[3], r[9];
        node_in_parent(p, r, node, joint_value(node, value ? value[i] : 0));
        if (node->parent < 0) {
            memcpy(pose[i].p_body, p, sizeof p);
            memcpy(pose[i].r_body_from_node, r, sizeof r);
            continue;
        }
        const NodePose *parent = &pose[node->parent];
        double          moved[3];
        m3_mul_v3(moved, parent->r_body_from_node, p);
        v3_add(pose[i].p_body, parent->p_body, moved);
        m3_mul(pose[i].r_body_from_node, parent->r_body_from_node, r);
    }
}

/* ---- measures --------------------------------------------------------------------------------- */

/* A bound of a set of points: all lie within `along` of the centre along an axis, and within `across` of that axis. */
typedef struct Drum {
    double centre[3], axis[3], along, across;
} Drum;

static double drum_reach(const Drum *d)
{
    double       off[3];
    const double h = v3_dot(d->centre, d->axis);
    v3_add_scaled(off, d->centre, -h, d->axis);
    return hypot(fabs(h) + d->along, v3_length(off) + d->across);
}

/* The drum that holds everything that a drum can sweep when it turns freely about `axis` through the origin. */
static Drum drum_swept(const Drum *d, const double axis[3])
{
    const double c = fmin(1, fabs(v3_dot(d->axis, axis))), s = sqrt(1 - c * c), h = v3_dot(d->centre, axis);
    double       off[3];
    v3_add_scaled(off, d->centre, -h, axis);
    Drum out = {.along = d->along * c + d->across * s, .across = v3_length(off) + d->along * s + d->across};
    memcpy(out.axis, axis, sizeof out.axis);
    v3_scale(out.centre, h, axis);
    return out;
}

static void drum_moved(Drum *d, const double p[3], const double r[9])
{
    double centre[3], axis[3];
    m3_mul_v3(centre, r, d->centre);
    m3_mul_v3(axis, r, d->axis);
    v3_add(d->centre, centre, p);
    memcpy(d->axis, axis, sizeof axis);
}

/* The farthest distance of a drum in a node's axes from the body origin, over all values of the joints above it. A free
 * joint is swept exactly; a limited one is sampled, and the drum enlarged by half a sample's motion. */
static double farthest(const Model *model, int index, Drum drum, int samples)
{
    for (; index >= 0; index = model->node[index].parent) {
        const ModelNode *node = &model->node[index];
        const bool       limited = node->low <= node->high && isfinite(node->high - node->low);
        double           p[3], r[9];
        if (node->joint == JOINT_FIXED || (node->joint == JOINT_TRANSLATION && !limited)) {
            node_in_parent(p, r, node, 0);
        } else if (node->joint == JOINT_ROTATION && !limited) {
            drum = drum_swept(&drum, node->axis);
            node_in_parent(p, r, node, 0);
        } else {
            const double step = samples > 1 ? (node->high - node->low) / (samples - 1) : 0;
            double       most = 0;
            for (int k = 0; k < samples; k++) {
                Drum         moved = drum;
                const double swell = 0.5 * step * (node->joint == JOINT_ROTATION ? drum_reach(&drum) : 1);
                moved.along += swell;
                moved.across += swell;
                node_in_parent(p, r, node, node->low + k * step);
                drum_moved(&moved, p, r);
                most = fmax(most, farthest(model, node->parent, moved, samples > 32 ? 32 : samples > 8 ? 8 : 2));
            }
            return most;
        }
        drum_moved(&drum, p, r);
    }
    return drum_reach(&drum);
}

void model_corner(double p[3], const Model *model, const ModelPart *part, int corner)
{
    double turned[3];
    memcpy(p, model->vertex[model->triangle[part->first_triangle + corner / 3][corner % 3]], 3 * sizeof *p);
    for (int node = part->node; node >= 0; node = model->node[node].parent) {
        m3_mul_v3(turned, model->node[node].r_parent_from_node, p);
        v3_add(p, turned, model->node[node].p_parent);
    }
}

void model_box_without(double low[3], double high[3], const Model *model, uint32_t without)
{
    bool any = false;
    for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
    for (int p = 0; p < model->part_count; p++) {
        const ModelPart *part = &model->part[p];
        if (without >> part->role & 1) continue;
        for (int c = 0; c < 3 * part->triangle_count; c++) {
            double at[3];
            model_corner(at, model, part, c);
            for (int k = 0; k < 3; k++) low[k] = fmin(low[k], at[k]), high[k] = fmax(high[k], at[k]);
            any = true;
        }
    }
    if (!any) memcpy(low, model->box_low, sizeof model->box_low), memcpy(high, model->box_high, sizeof model->box_high);
}

Status model_measure(Model *model)
{
    NodePose *pose = calloc((size_t)(model->node_count ? model->node_count : 1), sizeof *pose);
    double(*box)[2][3] = calloc((size_t)(model->node_count ? model->node_count : 1), sizeof *box);
    const bool enough = pose && box;
    if (enough) {
        for (int i = 0; i < 3; i++) {
            model->box_low[i] = INFINITY;
            model->box_high[i] = -INFINITY;
        }
        model->radius_m = 0;
        model_pose(pose, model, NULL);
        for (int n = 0; n < model->node_count; n++)
            for (int i = 0; i < 3; i++) {
                box[n][0][i] = INFINITY;
                box[n][1][i] = -INFINITY;
            }
        for (int part = 0; part < model->part_count; part++) {
            const ModelPart *mp = &model->part[part];
            for (int t = 3 * mp->first_triangle; t < 3 * (mp->first_triangle + mp->triangle_count); t++) {
                const double *v = model->vertex[model->triangle[t / 3][t % 3]];
                double        p[3];
                m3_mul_v3(p, pose[mp->node].r_body_from_node, v);
                v3_add(p, p, pose[mp->node].p_body);
                for (int i = 0; i < 3; i++) {
                    model->box_low[i] = fmin(model->box_low[i], p[i]);
                    model->box_high[i] = fmax(model->box_high[i], p[i]);
                    box[mp->node][0][i] = fmin(box[mp->node][0][i], v[i]);
                    box[mp->node][1][i] = fmax(box[mp->node][1][i], v[i]);
                }
                /* only parts on fixed nodes, so their vertices themselves are measured */
                bool fixed = true;
                for (int n = mp->node; n >= 0 && fixed; n = model->node[n].parent)
                    fixed = model->node[n].joint == JOINT_FIXED;
                if (fixed) model->radius_m = fmax(model->radius_m, v3_length(p));
            }
        }
        for (int n = 0; n < model->node_count; n++) {
            bool fixed = true;
            for (int k = n; k >= 0 && fixed; k = model->node[k].parent) fixed = model->node[k].joint == JOINT_FIXED;
            if (fixed || !(box[n][0][0] <= box[n][1][0])) continue;
            /* the farthest point of a convex set is a corner, and the box holds every vertex of the node */
            for (int c = 0; c < 8; c++) {
                const Drum corner = {.centre = {box[n][c & 1][0], box[n][c >> 1 & 1][1], box[n][c >> 2][2]},
                                     .axis = {1, 0, 0}};
                model->radius_m = fmax(model->radius_m, farthest(model, n, corner, 64));
            }
        }
        model->radius_m *= 1 + 1e-12; /* rounding of the sums above */
        model->length_m = model->box_high[0] - model->box_low[0];
        model->width_m = model->box_high[1] - model->box_low[1];
        model->height_m = model->box_high[2] - model->box_low[2];
    }
    free(pose);
    free(box);
    return enough ? STATUS_OK : STATUS_NO_MEMORY;
}

/* ---- validation ------------------------------------------------------------------------------- */

/* Logs the model and the error; returns STATUS_BAD_VALUE. */
static Status refuse(const Model *model, const char *what, const char *where, long long index)
{
    log_error("model: not valid: model=%.95s problem=\"%s\" where=%.95s index=%lld", model->name, what, where, index);
    return STATUS_BAD_VALUE;
}

static bool is_name(const char *text, size_t size) { return text[0] && memchr(text, 0, size); }

static bool is_rotation(const double r[9])
{
    double product[9];
    m3_tmul(product, r, r);
    for (int i = 0; i < 9; i++)
        if (!(fabs(product[i] - (i % 4 == 0)) <= 1e-9)) return false;
    double cross[3];
    v3_cross(cross, r, r + 3);
    return v3_dot(cross, r + 6) > 0;
}

static Status check_nodes(const Model *m)
{
    if (m->node_count < 1 || !m->node) return refuse(m, "no nodes", "-", 0);
    for (int i = 0; i < m->node_count; i++) {
        const ModelNode *n = &m->node[i];
        if (!is_name(n->name, sizeof n->name)) return refuse(m, "node without a name", "-", i);
        if (i == 0 ? n->parent != -1 : n->parent < 0 || n->parent >= i)
            return refuse(m, "parent is not an earlier node", n->name, i);
        if (!v3_is_finite(n->p_parent) || !is_rotation(n->r_parent_from_node))
            return refuse(m, "rest pose is not a rotation and a place", n->name, i);
        if (n->joint != JOINT_FIXED && !(fabs(v3_length(n->axis) - 1) <= 1e-9))
            return refuse(m, "joint axis is not unit", n->name, i);
        if (n->joint == JOINT_TRANSLATION && !(n->low <= n->high && isfinite(n->high - n->low)))
            return refuse(m, "sliding joint without limits", n->name, i);
        if (!isfinite(n->spin_rps_moving) || !(n->roll_radius_m >= 0 && isfinite(n->roll_radius_m)))
            return refuse(m, "spin or roll radius out of range", n->name, i);
        if (!isfinite(n->dis_scale) || !isfinite(n->value_slow))
            return refuse(m, "scale or slow value is not finite", n->name, i);
    }
    return STATUS_OK;
}

static Status check_parts(const Model *m)
{
    if (m->part_count < 1 || m->part_count > UINT16_MAX || !m->part) return refuse(m, "no parts, or too many", "-", 0);
    int next = 0;
    for (int i = 0; i < m->part_count; i++) {
        const ModelPart *p = &m->part[i];
        if (!is_name(p->name, sizeof p->name)) return refuse(m, "part without a name", "-", i);
        if (!is_name(p->material, sizeof p->material)) return refuse(m, "part without a material", p->name, i);
        if (p->node < 0 || p->node >= m->node_count) return refuse(m, "part of no node", p->name, i);
        if ((unsigned)p->role >= HEAT_ROLE_COUNT) return refuse(m, "unknown heat role", p->name, i);
        if (p->triangle_count < 1 || p->first_triangle != next || p->triangle_count > m->triangle_count - next)
            return refuse(m, "triangles are not contiguous", p->name, i);
        next += p->triangle_count;
        for (int k = 0; k + 1 < i; k++)
            if (m->part[k].node == p->node && p[-1].node != p->node)
                return refuse(m, "parts of a node are not contiguous", p->name, i);
        for (int t = p->first_triangle; t < next; t++)
            if (m->triangle_part[t] != i) return refuse(m, "triangle of another part", p->name, t);
    }
    return next == m->triangle_count ? STATUS_OK : refuse(m, "triangles of no part", "-", next);
}

static Status check_vertices(const Model *m)
{
    for (int i = 0; i < m->vertex_count; i++) {
        const double n[3] = {m->normal[i][0], m->normal[i][1], m->normal[i][2]};
        if (!v3_is_finite(m->vertex[i])) return refuse(m, "vertex is not finite", "-", i);
        if (!(fabs(v3_length(n) - 1) <= 1e-5)) return refuse(m, "normal is not unit", "-", i);
    }
    for (int t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            if (m->triangle[t][k] >= (uint32_t)m->vertex_count) return refuse(m, "vertex index out of range", "-", t);
    return STATUS_OK;
}

typedef struct Corner {
    double   p[3];
    uint32_t vertex;
} Corner;

static int corner_order(const void *a, const void *b)
{
    const Corner *p = a, *q = b;
    for (int i = 0; i < 3; i++) {
        if (p->p[i] < q->p[i]) return -1;
        if (p->p[i] > q->p[i]) return 1;
    }
    return 0;
}

static int key_order(const void *a, const void *b)
{
    const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return p < q ? -1 : p > q;
}

/* Numbers the vertices of a part: place[vertex] is the same for all vertices at one position. */
static void number_places(uint32_t *place, Corner *corner, const Model *m)
{
    for (int i = 0; i < m->vertex_count; i++) {
        memcpy(corner[i].p, m->vertex[i], sizeof corner[i].p);
        corner[i].vertex = (uint32_t)i;
    }
    qsort(corner, (size_t)m->vertex_count, sizeof *corner, corner_order);
    uint32_t number = 0;
    for (int i = 0; i < m->vertex_count; i++) {
        if (i > 0 && corner_order(&corner[i - 1], &corner[i]) != 0) number++;
        place[corner[i].vertex] = number;
    }
}

/* Examines the edges of one part. volume_m3: the volume enclosed, where the part is closed. edge: room for three a
 * triangle. */
static void part_edges(ModelEdges *out, double *volume_m3, const Model *m, int part, const uint32_t *place,
                       uint64_t *edge)
{
    const ModelPart *p = &m->part[part];
    size_t           count = 0;
    *volume_m3 = 0;
    memset(out, 0, sizeof *out);
    for (int t = p->first_triangle; t < p->first_triangle + p->triangle_count; t++) {
        const uint32_t *v = m->triangle[t];
        double          cross[3];
        v3_cross(cross, m->vertex[v[1]], m->vertex[v[2]]);
        *volume_m3 += v3_dot(m->vertex[v[0]], cross) / 6;
        for (int k = 0; k < 3; k++) {
            const uint64_t a = place[v[k]], c = place[v[(k + 1) % 3]];
            if (a == c) continue;
            /* both directions of an edge sort together; the lowest bit distinguishes them */
            edge[count++] = a < c ? a << 33 | c << 1 : c << 33 | a << 1 | 1;
        }
    }
    qsort(edge, count, sizeof *edge, key_order);
    for (size_t i = 0; i < count;) {
        long long      balance = 0, users = 0;
        const uint64_t undirected = edge[i] >> 1;
        for (; i < count && edge[i] >> 1 == undirected; i++, users++) balance += edge[i] & 1 ? -1 : 1;
        out->open += balance != 0;
        out->crowded += users > 2;
    }
}

/* Calls visit for each part until it returns false. */
static Status
walk_edges(const Model *m,
           Status (*visit)(void *user, const Model *m, int part, const ModelEdges *edges, double volume_m3), void *user)
{
    Status status = STATUS_OK;
    int    most = 0;
    for (int i = 0; i < m->part_count; i++)
        if (m->part[i].triangle_count > most) most = m->part[i].triangle_count;
    uint32_t *place = malloc((size_t)m->vertex_count * sizeof *place);
    Corner   *corner = malloc((size_t)m->vertex_count * sizeof *corner);
    uint64_t *edge = malloc((size_t)most * 3 * sizeof *edge);
    if (!place || !corner || !edge) {
        status = STATUS_NO_MEMORY;
    } else {
        number_places(place, corner, m);
        for (int i = 0; i < m->part_count && status == STATUS_OK; i++) {
            ModelEdges edges;
            double     volume_m3;
            part_edges(&edges, &volume_m3, m, i, place, edge);
            status = visit(user, m, i, &edges, volume_m3);
        }
    }
    free(place);
    free(corner);
    free(edge);
    return status;
}

static Status sum_edges(void *user, const Model *m, int part, const ModelEdges *edges, double volume_m3)
{
    (void)m, (void)part;
    ModelEdges *sum = user;
    sum->open += edges->open;
    sum->crowded += edges->crowded;
    sum->open_parts += edges->open > 0;
    sum->inside_out_parts += edges->open == 0 && volume_m3 < 0;
    return STATUS_OK;
}

Status model_edges(ModelEdges *out, const Model *model)
{
    ModelEdges   sum = {0};
    const Status status = walk_edges(model, sum_edges, &sum);
    if (status == STATUS_OK) *out = sum;
    return status;
}

/* Every directed edge of the part is matched by its reverse, one for one, and the part holds a volume. */
static Status check_closed(void *user, const Model *m, int part, const ModelEdges *edges, double volume_m3)
{
    (void)user;
    const ModelPart *p = &m->part[part];
    if (edges->open > 0) return refuse(m, "not closed: an edge without its reverse", p->name, part);
    return volume_m3 > 0 ? STATUS_OK : refuse(m, "inside out: volume is not positive", p->name, part);
}

static Status check_edge_lengths(const Model *m)
{
    for (int t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const double *a = m->vertex[m->triangle[t][k]], *b = m->vertex[m->triangle[t][(k + 1) % 3]];
            if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2])
                return refuse(m, "triangle with an edge of no length", m->part[m->triangle_part[t]].name, t);
        }
    return STATUS_OK;
}

Status model_check(const Model *m)
{
    if (!is_name(m->name, sizeof m->name)) return refuse(m, "no name", "-", 0);
    if (m->vertex_count < 3 || m->triangle_count < 1 || !m->vertex || !m->normal || !m->triangle || !m->triangle_part)
        return refuse(m, "no triangles", "-", 0);
    Status status = check_nodes(m);
    if (status == STATUS_OK) status = check_parts(m);
    if (status == STATUS_OK) status = check_vertices(m);
    if (status == STATUS_OK) status = check_edge_lengths(m);
    if (status != STATUS_OK) return status;
    if (!v3_is_finite(m->box_low) || !v3_is_finite(m->box_high) || !(m->radius_m > 0) || !isfinite(m->radius_m))
        return refuse(m, "not measured", "-", 0);
    return STATUS_OK;
}

Status model_validate(const Model *m)
{
    const Status status = model_check(m);
    return status == STATUS_OK ? walk_edges(m, check_closed, NULL) : status;
}
