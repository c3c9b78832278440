/* render/radar/flat_faces.c: joins triangles to flat faces, by the corners they share. */
#include "render/radar/flat_faces.h"

#include "render/radar/wedges.h"

#include <stdlib.h>

static const double weld_m = 1e-4;   /* as edges are found */
static const double flat_m = 1e-5;   /* out of the plane: 1.2 degrees of phase at 94 GHz, there and back */
static const double same_rad = 1e-3; /* between normals */
enum { convex_faces = 256 };         /* bodies of more are not asked whether they are convex */

typedef struct Corner {
    int place, triangle;
} Corner;

static int by_place(const void *a, const void *b)
{
    const Corner *p = a, *q = b;
    if (p->place != q->place) return p->place < q->place ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static bool triangle_normal(double n[3], const Model *m, int t)
{
    const uint32_t *v = m->triangle[t];
    double          ab[3], ac[3];
    v3_sub(ab, m->vertex[v[1]], m->vertex[v[0]]);
    v3_sub(ac, m->vertex[v[2]], m->vertex[v[0]]);
    v3_cross(n, ab, ac);
    return v3_normalize(n, n);
}

/* Of an area, and of one vertex normal that is its plane's. */
static bool is_flat(const Model *m, int t)
{
    const uint32_t *v = m->triangle[t];
    const float    *a = m->normal[v[0]], *b = m->normal[v[1]], *c = m->normal[v[2]];
    const double    given[3] = {(double)a[0], (double)a[1], (double)a[2]};
    double          n[3];
    for (int x = 0; x < 3; x++)
        if (a[x] != b[x] || a[x] != c[x]) return false;
    if (!triangle_normal(n, m, t)) return false;
    return fabs(v3_dot(n, given)) > (1 - 0.5 * same_rad * same_rad) * v3_length(given);
}

/* Whether two flat triangles that share a corner lie in one plane and look to one side. */
static bool one_plane(const Model *m, int s, int t)
{
    double n[3], o[3];
    if (m->triangle_part[s] != m->triangle_part[t]) return false;
    triangle_normal(n, m, s);
    triangle_normal(o, m, t);
    if (!(v3_dot(n, o) > 1 - 0.5 * same_rad * same_rad)) return false;
    for (int c = 0; c < 3; c++) {
        double there[3], back[3];
        v3_sub(there, m->vertex[m->triangle[t][c]], m->vertex[m->triangle[s][0]]);
        v3_sub(back, m->vertex[m->triangle[s][c]], m->vertex[m->triangle[t][0]]);
        if (!(fabs(v3_dot(n, there)) <= flat_m && fabs(v3_dot(o, back)) <= flat_m)) return false;
    }
    return true;
}

static int root_of(int *of, int t)
{
    while (of[t] != t) t = of[t] = of[of[t]];
    return t;
}

/* Joins those about one corner; the lowest stands for its face. */
static void join_about(int *of, const Model *m, const Corner *corner, int count)
{
    for (int i = 1; i < count; i++)
        for (int j = i - 1; j >= 0; j--) {
            if (!one_plane(m, corner[j].triangle, corner[i].triangle)) continue;
            const int a = root_of(of, corner[j].triangle), b = root_of(of, corner[i].triangle);
            of[a > b ? a : b] = a < b ? a : b;
            break;
        }
}

/* ---- convex bodies ------------------------------------------------------------------------------------- */

typedef struct Edge {
    int from, to;
} Edge;

static int by_edge(const void *a, const void *b)
{
    const Edge *p = a, *q = b;
    if (p->from != q->from) return p->from < q->from ? -1 : 1;
    return (p->to > q->to) - (p->to < q->to);
}

/* Whether each edge of each triangle has its reverse, once. edge: room for all. */
static bool is_closed(Edge *edge, const Model *m, const int *place)
{
    size_t count = 0;
    for (int t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            edge[count++] = (Edge){place[m->triangle[t][k]], place[m->triangle[t][(k + 1) % 3]]};
    qsort(edge, count, sizeof *edge, by_edge);
    for (size_t i = 0; i < count; i++) {
        const Edge back = {edge[i].to, edge[i].from};
        if (i > 0 && by_edge(&edge[i - 1], &edge[i]) == 0) return false;
        if (!bsearch(&back, edge, count, sizeof *edge, by_edge)) return false;
    }
    return true;
}

static bool is_convex(const FlatFaces *faces, const Model *m, Edge *edge, const int *place)
{
    const int flat = faces->first[faces->count];
    if (faces->count == 0 || faces->count > convex_faces || flat != m->triangle_count) return false;
    for (int p = 0; p < m->part_count; p++)
        if (m->part[p].damage_hidden || m->part[p].node != m->part[0].node) return false;
    if (faces->count == 1) return true;
    for (int f = 0; f < faces->count; f++) {
        const uint32_t t = faces->triangle[faces->first[f]];
        double         n[3], out[3];
        triangle_normal(n, m, (int)t);
        for (int v = 0; v < m->vertex_count; v++) {
            v3_sub(out, m->vertex[v], m->vertex[m->triangle[t][0]]);
            if (!(v3_dot(n, out) <= flat_m)) return false;
        }
    }
    return is_closed(edge, m, place);
}

/* ---- all of it ----------------------------------------------------------------------------------------- */

Status flat_faces_find(FlatFaces *out, const Model *model)
{
    const size_t count = (size_t)model->triangle_count;
    int     *place = malloc((size_t)model->vertex_count * sizeof *place + 1), *of = malloc(count * sizeof *of + 1);
    Corner  *corner = malloc(3 * count * sizeof *corner + 1);
    Edge    *edge = malloc(3 * count * sizeof *edge + 1);
    Status   status = STATUS_NO_MEMORY;
    FlatFaces found = {.first = malloc((count + 1) * sizeof *found.first),
                       .triangle = malloc(count * sizeof *found.triangle + 1)};
    int corners = 0, triangles = 0;
    if (!place || !of || !corner || !edge || !found.first || !found.triangle) goto done;
    status = wedges_weld(place, model, weld_m);
    if (status != STATUS_OK) goto done;
    for (int t = 0; t < model->triangle_count; t++) {
        of[t] = is_flat(model, t) ? t : -1;
        for (int c = 0; c < 3 && of[t] >= 0; c++) corner[corners++] = (Corner){place[model->triangle[t][c]], t};
    }
    qsort(corner, (size_t)corners, sizeof *corner, by_place);
    for (int i = 0, to; i < corners; i = to) {
        for (to = i + 1; to < corners && corner[to].place == corner[i].place;) to++;
        join_about(of, model, corner + i, to - i);
    }
    for (int t = 0; t < model->triangle_count; t++) /* `corner` again: triangles by the lowest of their face */
        if (of[t] >= 0) corner[triangles++] = (Corner){root_of(of, t), t};
    qsort(corner, (size_t)triangles, sizeof *corner, by_place);
    for (int i = 0; i < triangles; i++) {
        if (i == 0 || corner[i].place != corner[i - 1].place) found.first[found.count++] = i;
        found.triangle[i] = (uint32_t)corner[i].triangle;
    }
    found.first[found.count] = triangles;
    found.convex = is_convex(&found, model, edge, place);
    *out = found;
    found = (FlatFaces){0};

done:
    free(place);
    free(of);
    free(corner);
    free(edge);
    flat_faces_free(&found);
    return status;
}

void flat_faces_free(FlatFaces *faces)
{
    free(faces->first);
    free(faces->triangle);
    *faces = (FlatFaces){0};
}
