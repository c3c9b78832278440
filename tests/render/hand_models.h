/* tests/render/hand_models.h: models small enough to have answers on paper: a box, a plate, a sphere. */
#ifndef TESTS_RENDER_HAND_MODELS_H
#define TESTS_RENDER_HAND_MODELS_H

#include "tests/check.h"

#include "entities/models/model.h"

static uint64_t hand_draw;

static inline double hand_uniform(double low, double high)
{
    return low + (high - low) * random_uniform(1995, 3, 0, hand_draw++);
}

static inline void hand_direction(double d[3])
{
    do
        for (int c = 0; c < 3; c++) d[c] = hand_uniform(-1, 1);
    while (!(v3_length(d) < 1 && v3_normalize(d, d)));
}

/* A rotation as likely as any other is not needed; any will do. */
static inline void hand_rotation(double r[9])
{
    double x[3], y[3], z[3];
    hand_direction(x);
    do hand_direction(y);
    while (!(fabs(v3_dot(x, y)) < 0.9));
    v3_cross(z, x, y);
    v3_normalize(z, z);
    v3_cross(y, z, x);
    for (int c = 0; c < 3; c++) r[3 * c] = x[c], r[3 * c + 1] = y[c], r[3 * c + 2] = z[c];
}

static inline void hand_model(Model *m, int nodes, int vertices, int triangles)
{
    *m = (Model){.name = "hand", .node_count = nodes, .part_count = nodes, .vertex_count = 0, .triangle_count = 0};
    m->node = calloc((size_t)nodes, sizeof *m->node);
    m->part = calloc((size_t)nodes, sizeof *m->part);
    m->vertex = calloc((size_t)vertices, sizeof *m->vertex);
    m->normal = calloc((size_t)vertices, sizeof *m->normal);
    m->triangle = calloc((size_t)triangles, sizeof *m->triangle);
    m->triangle_part = calloc((size_t)triangles, sizeof *m->triangle_part);
    for (int n = 0; n < nodes; n++) {
        m->node[n].parent = n - 1;
        m3_identity(m->node[n].r_parent_from_node);
        m->part[n].node = n;
    }
}

static inline int hand_vertex(Model *m, double x, double y, double z)
{
    const int n = m->vertex_count++;
    double    u[3] = {x, y, z};
    m->vertex[n][0] = x, m->vertex[n][1] = y, m->vertex[n][2] = z;
    if (!v3_normalize(u, u)) u[0] = 1;
    for (int c = 0; c < 3; c++) m->normal[n][c] = (float)u[c];
    return n;
}

static inline void hand_triangle(Model *m, int part, int a, int b, int c)
{
    const int n = m->triangle_count++;
    m->triangle[n][0] = (uint32_t)a, m->triangle[n][1] = (uint32_t)b, m->triangle[n][2] = (uint32_t)c;
    m->triangle_part[n] = (uint16_t)part;
    m->part[part].triangle_count++;
}

/* Eight corners, twelve triangles, outward. */
static inline void hand_box_into(Model *m, int part, const double low[3], const double high[3])
{
    static const int face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    const int        first = m->vertex_count;
    for (int v = 0; v < 8; v++)
        hand_vertex(m, v & 1 ? high[0] : low[0], v & 2 ? high[1] : low[1], v & 4 ? high[2] : low[2]);
    m->part[part].first_triangle = m->triangle_count;
    for (int f = 0; f < 6; f++) {
        hand_triangle(m, part, first + face[f][0], first + face[f][1], first + face[f][2]);
        hand_triangle(m, part, first + face[f][0], first + face[f][2], first + face[f][3]);
    }
}

static inline void hand_box(Model *m, const double low[3], const double high[3])
{
    hand_model(m, 1, 8, 12);
    hand_box_into(m, 0, low, high);
}

/* In the plane x = 0: y from -half_y to half_y, z from -2 half_z to 0; faces forward. */
static inline void hand_plate(Model *m, double half_y, double half_z)
{
    hand_model(m, 1, 4, 2);
    const int a = hand_vertex(m, 0, -half_y, 0), b = hand_vertex(m, 0, half_y, 0);
    const int c = hand_vertex(m, 0, half_y, -2 * half_z), d = hand_vertex(m, 0, -half_y, -2 * half_z);
    for (int n = 0; n < 4; n++) m->normal[n][0] = 1, m->normal[n][1] = m->normal[n][2] = 0;
    hand_triangle(m, 0, a, c, d);
    hand_triangle(m, 0, a, b, c);
    for (int t = 0; t < 2; t++) { /* counter-clockwise seen from ahead */
        const uint32_t swap = m->triangle[t][1];
        double         ab[3], ac[3], n[3];
        v3_sub(ab, m->vertex[m->triangle[t][1]], m->vertex[m->triangle[t][0]]);
        v3_sub(ac, m->vertex[m->triangle[t][2]], m->vertex[m->triangle[t][0]]);
        v3_cross(n, ab, ac);
        if (n[0] > 0) continue;
        m->triangle[t][1] = m->triangle[t][2];
        m->triangle[t][2] = swap;
    }
}

/* Vertices on a sphere about the origin; returns the radius of the largest sphere inside all facets. */
static inline double hand_sphere(Model *m, double radius_m, int bands)
{
    const int around = 2 * bands;
    hand_model(m, 1, (bands - 1) * around + 2, 2 * (bands - 1) * around);
    const int top = hand_vertex(m, 0, 0, -radius_m), bottom = hand_vertex(m, 0, 0, radius_m);
    for (int b = 1; b < bands; b++)
        for (int a = 0; a < around; a++) {
            const double polar = pi_rad * b / bands, azimuth = 2 * pi_rad * a / around;
            const double across_m = radius_m * sin(polar);
            hand_vertex(m, across_m * cos(azimuth), across_m * sin(azimuth), -radius_m * cos(polar));
        }
    for (int a = 0; a < around; a++) {
        const int next = (a + 1) % around, last = 2 + (bands - 2) * around;
        hand_triangle(m, 0, top, 2 + next, 2 + a);
        hand_triangle(m, 0, bottom, last + a, last + next);
        for (int b = 0; b + 2 < bands; b++) {
            const int p = 2 + b * around;
            hand_triangle(m, 0, p + a, p + next, p + around + next);
            hand_triangle(m, 0, p + a, p + around + next, p + around + a);
        }
    }
    double inside_m = radius_m;
    for (int t = 0; t < m->triangle_count; t++) {
        double ab[3], ac[3], n[3];
        v3_sub(ab, m->vertex[m->triangle[t][1]], m->vertex[m->triangle[t][0]]);
        v3_sub(ac, m->vertex[m->triangle[t][2]], m->vertex[m->triangle[t][0]]);
        v3_cross(n, ab, ac);
        inside_m = fmin(inside_m, fabs(v3_dot(n, m->vertex[m->triangle[t][0]])) / v3_length(n));
    }
    return inside_m;
}

static inline void hand_free(Model *m)
{
    free(m->node);
    free(m->part);
    free(m->vertex);
    free(m->normal);
    free(m->triangle);
    free(m->triangle_part);
}

#endif
