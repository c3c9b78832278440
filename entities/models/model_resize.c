/* entities/models/model_resize.c: scales a model to a given length, width and height, with its moving parts.
 *
 * The rest pose is scaled along the body axes. A node keeps its rest attitude R, so in its own axes its points go
 * through R^T S R; parts that roll or spin must stay round, and take one factor across their axis instead (wheels that
 * of the height, so that they stay on the ground; rotors that of the length). Joint axes are scaled like the body. */
#include "entities/models/model.h"

#include <stdlib.h>

static double height_of(const Model *m) { return fmax(m->box_high[2], 0) - m->box_low[2]; }

/* The scaling along body axes, expressed in a node's axes: symmetric and positive. */
static void scale_in_node(double out[9], const double r_body_from_node[9], const double s[3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double sum = 0;
            for (int k = 0; k < 3; k++) sum += r_body_from_node[3 * k + i] * s[k] * r_body_from_node[3 * k + j];
            out[3 * i + j] = sum;
        }
}

/* A scaling that keeps things round about `axis`: `across` in its plane, `along` along it. */
static void make_round(double m[9], const double axis[3], double across)
{
    double moved[3];
    m3_mul_v3(moved, m, axis);
    const double along = v3_dot(moved, axis);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) m[3 * i + j] = (i == j ? across : 0) + (along - across) * axis[i] * axis[j];
}

static void cofactors(double out[9], const double m[9])
{
    double row[3][3];
    v3_cross(row[0], m + 3, m + 6);
    v3_cross(row[1], m + 6, m);
    v3_cross(row[2], m, m + 3);
    memcpy(out, row, sizeof row);
}

static void scale_joint(ModelNode *node, const double scale[9], const double parent_scale[9], double wheel)
{
    double p[3], axis[3];
    if (node->parent >= 0) {
        m3_mul_v3(p, parent_scale, node->p_parent);
        memcpy(node->p_parent, p, sizeof p);
    }
    if (node->joint == JOINT_FIXED) return;
    m3_mul_v3(axis, scale, node->axis);
    const double longer = v3_length(axis);
    v3_scale(node->axis, 1 / longer, axis);
    if (node->joint == JOINT_TRANSLATION) {
        node->low *= longer, node->high *= longer;
        node->dis_scale *= longer, node->value_slow *= longer;
    }
    node->roll_radius_m *= wheel;
}

/* Scales a model along the body axes, once. */
static Status scale_model(Model *m, const double s[3])
{
    NodePose *pose = calloc((size_t)m->node_count, sizeof *pose);
    double(*scale)[9] = calloc((size_t)m->node_count, sizeof *scale);
    bool  *round = calloc((size_t)m->node_count, sizeof *round), *done = calloc((size_t)m->vertex_count, sizeof *done);
    Status status = STATUS_NO_MEMORY;
    if (!pose || !scale || !round || !done) goto done;
    model_pose(pose, m, NULL);
    for (int n = 0; n < m->node_count; n++) {
        const ModelNode *node = m->node + n;
        const bool       spins = node->roll_radius_m > 0 || node->spin_rps_moving != 0;
        if (node->parent >= 0 &&
            round[node->parent]) { /* what a round part carries is scaled like that part, in its own axes */
            double r[9], half[9];
            m3_tmul(r, pose[node->parent].r_body_from_node, pose[n].r_body_from_node);
            m3_mul(half, scale[node->parent], r);
            m3_tmul(scale[n], r, half);
            round[n] = true;
            continue;
        }
        scale_in_node(scale[n], pose[n].r_body_from_node, s);
        if (!spins) continue;
        double axis_body[3];
        m3_mul_v3(axis_body, pose[n].r_body_from_node, node->axis);
        const bool upright = fabs(axis_body[2]) > 0.7;
        make_round(scale[n], node->axis, upright ? s[0] : s[2]);
        round[n] = true;
    }
    for (int p = 0; p < m->part_count; p++) {
        double normal[9];
        cofactors(normal, scale[m->part[p].node]);
        for (int t = m->part[p].first_triangle; t < m->part[p].first_triangle + m->part[p].triangle_count; t++)
            for (int c = 0; c < 3; c++) {
                const uint32_t v = m->triangle[t][c];
                double         q[3], n[3] = {m->normal[v][0], m->normal[v][1], m->normal[v][2]}, turned[3];
                if (done[v]) continue;
                done[v] = true;
                m3_mul_v3(q, scale[m->part[p].node], m->vertex[v]);
                memcpy(m->vertex[v], q, sizeof q);
                m3_mul_v3(turned, normal, n);
                v3_normalize(turned, turned);
                for (int k = 0; k < 3; k++) m->normal[v][k] = (float)turned[k];
            }
    }
    for (int n = 0; n < m->node_count; n++) {
        ModelNode *node = m->node + n;
        scale_joint(node, scale[n], node->parent >= 0 ? scale[node->parent] : NULL, s[2]);
    }
    status = model_measure(m);

done:
    free(pose);
    free(scale);
    free(round);
    free(done);
    return status;
}

bool model_scale_to(double s[3], const Model *m, const ModelSize *size)
{
    const double now[3] = {m->length_m, m->width_m, height_of(m)},
                 want[3] = {size->length_m, size->width_m, size->height_m};
    double product = 1;
    int    given = 0;
    for (int i = 0; i < 3; i++) {
        if (!(want[i] > 0)) continue;
        s[i] = want[i] / now[i];
        product *= s[i];
        given++;
    }
    for (int i = 0; i < 3; i++)
        if (!(want[i] > 0)) s[i] = given ? pow(product, 1.0 / given) : 1;
    for (int i = 0; i < 3; i++)
        if (!(s[i] >= 0.02 && s[i] <= 50)) return false;
    return true;
}

Status model_resize(Model *m, const ModelSize *size)
{
    /* wheels and rotors make the second step necessary: they do not follow all three figures */
    for (int step = 0; step < 4; step++) {
        double s[3];
        if (!model_scale_to(s, m, size)) return STATUS_BAD_VALUE;
        if (fabs(s[0] - 1) < 1e-4 && fabs(s[1] - 1) < 1e-4 && fabs(s[2] - 1) < 1e-4) break;
        /* a length that was left open is settled by the first step */
        for (int i = 0; i < 3 && step > 0; i++)
            if (!((const double[3]){size->length_m, size->width_m, size->height_m}[i] > 0)) s[i] = 1;
        const Status status = scale_model(m, s);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}
