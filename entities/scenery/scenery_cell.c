/* entities/scenery/scenery_cell.c: the mesh of a cell as its records are added: parts, polygons, simple solids. */
#include "entities/scenery/scenery_buildings_private.h"

#include <stdio.h>
#include <stdlib.h>

static bool grow(CellMesh *cell, void *array, int *room, int needed, size_t size)
{
    void **const data = array;
    if (cell->status != STATUS_OK) return false;
    if (needed <= *room) return true;
    const int wanted = needed > 2 * *room ? (needed < 64 ? 64 : needed) : 2 * *room;
    void     *larger = realloc(*data, (size_t)wanted * size);
    if (!larger) {
        cell->status = STATUS_NO_MEMORY;
        return false;
    }
    *data = larger, *room = wanted;
    return true;
}

void cell_mesh_free(CellMesh *cell)
{
    model_destroy(&cell->model);
    free(cell->id), free(cell->pending);
    *cell = (CellMesh){0};
}

void cell_begin(CellMesh *cell, uint64_t id) { cell->record = id, cell->slots = 0, cell->pendings = 0; }

int cell_part(CellMesh *cell, const char *name, const char *material, HeatRole role)
{
    for (int k = 0; k < cell->slots; k++)
        if (cell->slot[k].role == role && !strcmp(cell->slot[k].name, name) &&
            !strcmp(cell->slot[k].material, material))
            return k;
    if (cell->slots == cell_slots) return cell_slots - 1;
    ModelPart *part = &cell->slot[cell->slots];
    *part = (ModelPart){.role = role};
    snprintf(part->name, sizeof part->name, "%s", name);
    snprintf(part->material, sizeof part->material, "%s", material);
    return cell->slots++;
}

void cell_end(CellMesh *cell)
{
    Model *m = &cell->model;
    if (!grow(cell, &m->triangle, &cell->triangle_room, m->triangle_count + cell->pendings, sizeof *m->triangle))
        return;
    for (int s = 0; s < cell->slots; s++) {
        ModelPart part = cell->slot[s];
        part.first_triangle = m->triangle_count;
        for (int k = 0; k < cell->pendings; k++)
            if (cell->pending[k][3] == (uint32_t)s)
                memcpy(m->triangle[m->triangle_count++], cell->pending[k], sizeof *m->triangle);
        part.triangle_count = m->triangle_count - part.first_triangle;
        if (part.triangle_count == 0) continue;
        if (!grow(cell, &m->part, &cell->part_room, m->part_count + 1, sizeof *m->part) ||
            !grow(cell, &cell->id, &cell->id_room, m->part_count + 1, sizeof *cell->id))
            return;
        cell->id[m->part_count] = cell->record;
        m->part[m->part_count++] = part;
    }
    cell->slots = cell->pendings = 0;
}

/* ---- vertices and faces --------------------------------------------------------------------------- */

uint32_t cell_vertex(CellMesh *cell, const double p[3], const double n[3])
{
    Model *m = &cell->model;
    int    room = cell->vertex_room; /* normals grow in step */
    if (!grow(cell, &m->vertex, &room, m->vertex_count + 1, sizeof *m->vertex) ||
        !grow(cell, &m->normal, &cell->vertex_room, m->vertex_count + 1, sizeof *m->normal))
        return 0;
    /* north, east, down; + 0.0 turns -0 into 0, so that equal places have equal bits */
    double      *v = m->vertex[m->vertex_count];
    const double length = sqrt(v3_dot(n, n));
    v[0] = p[1] + 0.0, v[1] = p[0] + 0.0, v[2] = 0.0 - p[2];
    float *out = m->normal[m->vertex_count];
    out[0] = (float)(n[1] / length), out[1] = (float)(n[0] / length), out[2] = (float)(-n[2] / length);
    return (uint32_t)m->vertex_count++;
}

void cell_triangle(CellMesh *cell, int slot, uint32_t a, uint32_t b, uint32_t c)
{
    /* two corners at one place: its edges cancel, so what is closed is so without it */
    const size_t size = sizeof *cell->model.vertex;
    if (cell->status != STATUS_OK || !memcmp(cell->model.vertex[a], cell->model.vertex[b], size) ||
        !memcmp(cell->model.vertex[b], cell->model.vertex[c], size) ||
        !memcmp(cell->model.vertex[c], cell->model.vertex[a], size))
        return;
    if (!grow(cell, &cell->pending, &cell->pending_room, cell->pendings + 1, sizeof *cell->pending)) return;
    uint32_t *t = cell->pending[cell->pendings++];
    t[0] = a, t[1] = b, t[2] = c, t[3] = (uint32_t)slot;
}

void cell_face(CellMesh *cell, int slot, const double (*p)[3], int n)
{
    double normal[3] = {0};
    for (int k = 1; k + 1 < n; k++) {
        double u[3], v[3], part[3];
        v3_sub(u, p[k], p[0]), v3_sub(v, p[k + 1], p[0]);
        v3_cross(part, u, v);
        v3_add(normal, normal, part);
    }
    if (!(v3_dot(normal, normal) > 0) || cell->status != STATUS_OK) return;
    double   own[16][2];
    int      own_triangle[16][3];
    uint32_t own_vertex[16];
    double(*flat)[2] = n > 16 ? malloc((size_t)n * sizeof *flat) : own;
    int(*triangle)[3] = n > 16 ? malloc((size_t)n * sizeof *triangle) : own_triangle;
    uint32_t *vertex = n > 16 ? malloc((size_t)n * sizeof *vertex) : own_vertex;
    if (!flat || !triangle || !vertex) {
        cell->status = STATUS_NO_MEMORY;
    } else {
        /* seen along the axis that it faces most */
        const double ax = fabs(normal[0]), ay = fabs(normal[1]), az = fabs(normal[2]);
        const int    axis = az >= ax && az >= ay ? 2 : ax >= ay ? 0 : 1;
        const int    x = (axis + 1) % 3, y = (axis + 2) % 3;
        for (int k = 0; k < n; k++) {
            flat[k][0] = normal[axis] > 0 ? p[k][x] : p[k][y];
            flat[k][1] = normal[axis] > 0 ? p[k][y] : p[k][x];
            vertex[k] = cell_vertex(cell, p[k], normal);
        }
        outline_triangulate(triangle, &cell->status, (const double(*)[2])flat, n);
        for (int t = 0; t < n - 2 && cell->status == STATUS_OK; t++)
            cell_triangle(cell, slot, vertex[triangle[t][0]], vertex[triangle[t][1]], vertex[triangle[t][2]]);
    }
    if (n > 16) free(flat), free(triangle), free(vertex);
}

/* ---- solids --------------------------------------------------------------------------------------- */

void cell_prism(CellMesh *cell, int slot, const double (*p)[2], int n, double z0, double z1)
{
    double low[64][3], high[64][3];
    for (int k = 0; k < n; k++) {
        low[n - 1 - k][0] = high[k][0] = p[k][0], low[n - 1 - k][1] = high[k][1] = p[k][1];
        low[n - 1 - k][2] = z0, high[k][2] = z1;
    }
    cell_face(cell, slot, (const double(*)[3])low, n);
    cell_face(cell, slot, (const double(*)[3])high, n);
    for (int k = 0; k < n; k++) {
        const double *a = p[k], *b = p[(k + 1) % n];
        const double  side[4][3] = {{a[0], a[1], z0}, {b[0], b[1], z0}, {b[0], b[1], z1}, {a[0], a[1], z1}};
        cell_face(cell, slot, side, 4);
    }
}

void cell_box(CellMesh *cell, int slot, const double middle[2], const double along[2], double half_along,
              double half_across, double z0, double z1)
{
    static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    double              p[4][2];
    for (int k = 0; k < 4; k++) {
        const double u = corner[k][0] * half_along, v = corner[k][1] * half_across;
        p[k][0] = middle[0] + u * along[0] - v * along[1], p[k][1] = middle[1] + u * along[1] + v * along[0];
    }
    cell_prism(cell, slot, (const double(*)[2])p, 4, z0, z1);
}

/* ---- the model ------------------------------------------------------------------------------------ */

Status cell_take(Model *out, uint64_t **id, CellMesh *cell, const char *name)
{
    Model *m = &cell->model;
    if (cell->status == STATUS_OK) {
        m->node = calloc(1, sizeof *m->node);
        m->triangle_part = malloc((size_t)m->triangle_count * sizeof *m->triangle_part);
        if (!m->node || !m->triangle_part) cell->status = STATUS_NO_MEMORY;
    }
    if (cell->status == STATUS_OK) {
        snprintf(m->name, sizeof m->name, "%s", name);
        m->node_count = 1;
        m->sag_m = 0.02;
        m->node[0] = (ModelNode){.name = "cell", .parent = -1, .axis = {1, 0, 0}, .low = 1, .high = -1};
        m3_identity(m->node[0].r_parent_from_node);
        for (int k = 0; k < m->part_count; k++)
            for (int t = 0; t < m->part[k].triangle_count; t++)
                m->triangle_part[m->part[k].first_triangle + t] = (uint16_t)k;
        cell->status = model_measure(m);
    }
    const Status status = cell->status;
    if (status == STATUS_OK) {
        *out = *m, *id = cell->id;
        cell->model = (Model){0}, cell->id = NULL;
    }
    cell_mesh_free(cell);
    return status;
}
