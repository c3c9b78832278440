/* tests/render/hand_mesh.h: one mesh of panels, boxes and triangles, and its wedges. */
#ifndef TESTS_RENDER_HAND_MESH_H
#define TESTS_RENDER_HAND_MESH_H

#include "tests/check.h"
#include "render/scattering/field/wedges_private.h"

enum { most_vertices = 20000, most_triangles = 10000 };

static double    mesh_vertex[most_vertices][3];
static float     mesh_normal[most_vertices][3];
static uint32_t  mesh_triangle[most_triangles][3];
static uint16_t  mesh_part[most_triangles];
static ModelNode mesh_node;
static ModelPart mesh_parts[2];
static Model     mesh;

static inline void begin(void)
{
    memset(mesh_parts, 0, sizeof mesh_parts);
    m3_identity(mesh_node.r_parent_from_node);
    mesh = (Model){.node_count = 1,
                   .part_count = 2,
                   .node = &mesh_node,
                   .part = mesh_parts,
                   .vertex = mesh_vertex,
                   .normal = mesh_normal,
                   .triangle = mesh_triangle,
                   .triangle_part = mesh_part};
}

static inline uint32_t add_vertex(const double p[3], const double n[3])
{
    const int v = mesh.vertex_count++;
    if (v >= most_vertices) abort();
    memcpy(mesh_vertex[v], p, sizeof mesh_vertex[v]);
    for (int i = 0; i < 3; i++) mesh_normal[v][i] = (float)n[i];
    return (uint32_t)v;
}

static inline void add_triangle(uint32_t a, uint32_t b, uint32_t c, int part)
{
    const int t = mesh.triangle_count++;
    if (t >= most_triangles) abort();
    mesh_triangle[t][0] = a, mesh_triangle[t][1] = b, mesh_triangle[t][2] = c;
    mesh_part[t] = (uint16_t)part;
}

/* The parallelogram at corner with sides a, b in cells x cells squares, looking along a x b, vertices of its own. */
static inline void add_panel(const double corner[3], const double a[3], const double b[3], int cells, int part)
{
    double n[3];
    v3_cross(n, a, b);
    v3_normalize(n, n);
    for (int i = 0; i < cells; i++)
        for (int j = 0; j < cells; j++) {
            uint32_t v[4];
            for (int k = 0; k < 4; k++) {
                double p[3];
                v3_add_scaled(p, corner, (i + (k == 1 || k == 2)) / (double)cells, a);
                v3_add_scaled(p, p, (j + (k >= 2)) / (double)cells, b);
                v[k] = add_vertex(p, n);
            }
            add_triangle(v[0], v[1], v[2], part);
            add_triangle(v[0], v[2], v[3], part);
        }
}

static inline void add_box(const double low[3], const double size[3], int cells, int part)
{
    for (int axis = 0; axis < 3; axis++) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        double    a[3] = {0}, b[3] = {0}, at[3];
        a[u] = size[u], b[v] = size[v];
        memcpy(at, low, sizeof at);
        add_panel(at, b, a, cells, part); /* looks down the axis */
        at[axis] += size[axis];
        add_panel(at, a, b, cells, part);
    }
}

static inline WedgeList find(void)
{
    WedgeList         list = {0};
    const WedgeConfig config = wedges_default_config();
    CHECK(wedges_find(&list, &mesh, &config) == STATUS_OK);
    for (int i = 0; i < list.count; i++) {
        const WedgeFrame *f = &list.wedge[i].frame;
        double            z[3], along[3];
        v3_cross(z, f->x, f->y);
        v3_sub(along, list.wedge[i].p[1], list.wedge[i].p[0]);
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR(z[k], f->z[k], 1e-12);
            CHECK_NEAR(along[k], f->z[k] * v3_length(along), 1e-9);
        }
        CHECK(f->exterior_pi > 1 && f->exterior_pi <= 2);
    }
    return list;
}

#endif
