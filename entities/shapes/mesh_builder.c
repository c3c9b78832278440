/* entities/shapes/mesh_builder.c: the mesh builder: nodes, parts, vertices and the model they end as. */
#include "entities/shapes/mesh_builder_private.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- places --------------------------------------------------------------------------------- */

Place place_at(double x, double y, double z)
{
    Place place = {{x, y, z}, {0}};
    m3_identity(place.m);
    return place;
}

Place place_axis(double x, double y, double z, double dx, double dy, double dz)
{
    Place      place = place_at(x, y, z);
    double     d[3] = {dx, dy, dz}, side[3], third[3];
    const bool ok = v3_normalize(d, d);
    assert(ok);
    (void)ok;
    /* shape y is the body axis least along d, made perpendicular: a right angle stays exactly one */
    const double ax = fabs(d[0]), ay = fabs(d[1]), az = fabs(d[2]);
    double       other[3] = {0, 0, 0};
    other[ay <= ax && ay <= az ? 1 : az <= ax ? 2 : 0] = 1;
    v3_add_scaled(side, other, -v3_dot(other, d), d);
    v3_normalize(side, side);
    v3_cross(third, d, side);
    for (int i = 0; i < 3; i++) {
        place.m[3 * i] = d[i];
        place.m[3 * i + 1] = side[i];
        place.m[3 * i + 2] = third[i];
    }
    return place;
}

Place place_scaled(Place place, double sx, double sy, double sz)
{
    const double s[3] = {sx, sy, sz};
    for (int i = 0; i < 9; i++) place.m[i] *= s[i % 3];
    return place;
}

static void rotation_about(double r[9], const double axis[3], double angle_rad)
{
    const double c = cos(angle_rad), s = sin(angle_rad), v = 1 - c;
    const double x = axis[0], y = axis[1], z = axis[2];
    const double m[9] = {c + v * x * x,     v * x * y - s * z, v * x * z + s * y, v * x * y + s * z, c + v * y * y,
                         v * y * z - s * x, v * x * z - s * y, v * y * z + s * x, c + v * z * z};
    memcpy(r, m, sizeof m);
}

Place place_turned(Place place, const double axis[3], double angle_rad)
{
    double r[9], m[9];
    rotation_about(r, axis, angle_rad);
    m3_mul(m, r, place.m);
    memcpy(place.m, m, sizeof m);
    return place;
}

Place place_mirror_y(Place place)
{
    place.p[1] = -place.p[1];
    for (int i = 3; i < 6; i++) place.m[i] = -place.m[i];
    return place;
}

Warp mesh_warp(const Place *place)
{
    Warp   warp = {0};
    double column[3][3], cross[3];
    for (int j = 0; j < 3; j++) {
        for (int i = 0; i < 3; i++) column[j][i] = place->m[3 * i + j];
        const double length = v3_length(column[j]);
        assert(length > 0);
        warp.largest = fmax(warp.largest, length);
        /* orthogonal columns: the inverse transpose divides each by its squared length */
        for (int i = 0; i < 3; i++) warp.normal_m[3 * i + j] = column[j][i] / (length * length);
    }
    v3_cross(cross, column[0], column[1]);
    warp.flips = v3_dot(cross, column[2]) < 0;
    return warp;
}

/* ---- storage -------------------------------------------------------------------------------- */

bool mesh_grow(MeshBuilder *b, void *array, int *capacity, int needed, size_t size)
{
    if (b->status != STATUS_OK) return false;
    if (needed <= *capacity) return true;
    int wanted = *capacity ? *capacity : 64;
    while (wanted < needed) wanted += wanted / 2;
    void **pointer = array;
    void  *moved = realloc(*pointer, (size_t)wanted * size);
    if (!moved) {
        b->status = STATUS_NO_MEMORY;
        return false;
    }
    *pointer = moved;
    *capacity = wanted;
    return true;
}

MeshBuilder *mesh_builder_create(const char *model_name, double sag_m)
{
    assert(sag_m > 0);
    MeshBuilder *b = calloc(1, sizeof *b);
    if (!b) return NULL;
    snprintf(b->model.name, sizeof b->model.name, "%s", model_name);
    b->model.sag_m = sag_m;
    return b;
}

Status mesh_builder_finish(Model *out, MeshBuilder *b)
{
    Model *m = &b->model;
    if (b->status == STATUS_OK) {
        /* two arrays grow together with the triangles and vertices; this one only now */
        m->triangle_part = malloc((size_t)(m->triangle_count ? m->triangle_count : 1) * sizeof *m->triangle_part);
        if (!m->triangle_part) b->status = STATUS_NO_MEMORY;
    }
    Status status = b->status;
    if (status == STATUS_OK) {
        for (int part = 0; part < m->part_count; part++) {
            const ModelPart *p = &m->part[part];
            for (int t = 0; t < p->triangle_count; t++) m->triangle_part[p->first_triangle + t] = (uint16_t)part;
        }
        status = model_measure(m);
    }
    if (status == STATUS_OK) *out = *m;
    else model_destroy(m);
    free(b);
    return status;
}

int mesh_node(MeshBuilder *b, const char *name, int parent, double x, double y, double z)
{
    Model *m = &b->model;
    if (!mesh_grow(b, &m->node, &b->node_capacity, m->node_count + 1, sizeof *m->node)) return 0;
    assert(parent < m->node_count && (parent >= 0) == (m->node_count > 0));
    ModelNode *node = &m->node[m->node_count];
    *node = (ModelNode){.parent = parent, .p_parent = {x, y, z}, .axis = {1, 0, 0}, .low = 1, .high = -1};
    m3_identity(node->r_parent_from_node);
    assert(strlen(name) < sizeof node->name);
    snprintf(node->name, sizeof node->name, "%s", name);
    return m->node_count++;
}

ModelNode *mesh_node_get(MeshBuilder *b, int node)
{
    /* after a failed allocation there may be no node at all: what is written then goes nowhere */
    static _Thread_local ModelNode nowhere;
    return b->status == STATUS_OK ? &b->model.node[node] : &nowhere;
}

void mesh_joint(MeshBuilder *b, int node, double ax, double ay, double az, uint32_t dis_class, uint32_t dis_metric,
                double low_rad, double high_rad)
{
    ModelNode *n = mesh_node_get(b, node);
    n->joint = JOINT_ROTATION;
    n->axis[0] = ax;
    n->axis[1] = ay;
    n->axis[2] = az;
    n->dis_class = dis_class;
    n->dis_metric = dis_metric;
    n->low = low_rad;
    n->high = high_rad;
}

void mesh_part(MeshBuilder *b, int node, const char *name, const char *material, HeatRole role)
{
    Model *m = &b->model;
    if (!mesh_grow(b, &m->part, &b->part_capacity, m->part_count + 1, sizeof *m->part)) return;
    ModelPart *part = &m->part[m->part_count];
    assert(node < m->node_count && (m->part_count == 0 || node >= part[-1].node) && m->part_count < UINT16_MAX);
    *part = (ModelPart){.node = node, .role = role, .first_triangle = m->triangle_count};
    assert(strlen(name) < sizeof part->name && strlen(material) < sizeof part->material);
    snprintf(part->name, sizeof part->name, "%s", name);
    snprintf(part->material, sizeof part->material, "%s", material);
    m->part_count++;
}

bool mesh_reserve(MeshBuilder *b, long long vertices, long long triangles)
{
    Model *m = &b->model;
    assert(b->status != STATUS_OK || m->part_count > 0);
    if (m->vertex_count + vertices > INT32_MAX / 4 || m->triangle_count + triangles > INT32_MAX / 4) {
        b->status = STATUS_NO_MEMORY;
        return false;
    }
    const int vertex_need = m->vertex_count + (int)vertices, triangle_need = m->triangle_count + (int)triangles;
    int       normal_capacity = b->vertex_capacity; /* grows in step with the vertices */
    return mesh_grow(b, &m->vertex, &normal_capacity, vertex_need, sizeof *m->vertex) &&
           mesh_grow(b, &m->normal, &b->vertex_capacity, vertex_need, sizeof *m->normal) &&
           mesh_grow(b, &m->triangle, &b->triangle_capacity, triangle_need, sizeof *m->triangle);
}

void mesh_place_point(double out[3], const Place *place, const double p_shape[3])
{
    /* + 0.0 turns -0 into 0: equal places get equal bits */
    m3_mul_v3(out, place->m, p_shape);
    for (int i = 0; i < 3; i++) out[i] = out[i] + place->p[i] + 0.0;
}

uint32_t mesh_add_vertex(MeshBuilder *b, const Place *place, const Warp *warp, const double p_shape[3],
                         const double n_shape[3])
{
    Model *m = &b->model;
    double n[3];
    mesh_place_point(m->vertex[m->vertex_count], place, p_shape);
    m3_mul_v3(n, warp->normal_m, n_shape);
    const bool ok = v3_normalize(n, n);
    assert(ok);
    (void)ok;
    for (int i = 0; i < 3; i++) m->normal[m->vertex_count][i] = (float)n[i];
    return (uint32_t)m->vertex_count++;
}

void mesh_add_triangle(MeshBuilder *b, const Warp *warp, uint32_t i, uint32_t j, uint32_t k)
{
    Model       *m = &b->model;
    const size_t size = sizeof m->vertex[0];
    if (!memcmp(m->vertex[i], m->vertex[j], size) || !memcmp(m->vertex[j], m->vertex[k], size) ||
        !memcmp(m->vertex[k], m->vertex[i], size))
        return;
    uint32_t *t = m->triangle[m->triangle_count++];
    t[0] = i;
    t[1] = warp->flips ? k : j;
    t[2] = warp->flips ? j : k;
    m->part[m->part_count - 1].triangle_count++;
}

void mesh_add_band(MeshBuilder *b, const Warp *warp, uint32_t ring0, uint32_t ring1, int sides)
{
    for (int j = 0; j < sides; j++) {
        const uint32_t k = (uint32_t)(j + 1 < sides ? j + 1 : 0);
        mesh_add_triangle(b, warp, ring0 + (uint32_t)j, ring0 + k, ring1 + k);
        mesh_add_triangle(b, warp, ring0 + (uint32_t)j, ring1 + k, ring1 + (uint32_t)j);
    }
}

enum { sides_least = 8, sides_most = 4096 };

/* ---- chord error --------------------------------------------------------------------------------- */

double mesh_chord_angle(double radius_m, double sag_m)
{
    const double widest = 2 * pi_rad / sides_least;
    if (!(sag_m < radius_m)) return widest;
    /* 2 acos(1 - e) by way of the half angle: 1 - cos a = 2 sin^2(a / 2) keeps its digits for small e */
    return fmin(widest, 4 * asin(sqrt(0.5 * sag_m / radius_m)));
}

int mesh_circle_sides(double radius_m, double sag_m)
{
    const double sides = ceil(2 * pi_rad / mesh_chord_angle(radius_m, sag_m) - 1e-9);
    return (int)clamp(sides, sides_least, sides_most);
}
