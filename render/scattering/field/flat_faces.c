/* render/scattering/field/flat_faces.c: the flat faces of a model, and which of them antennas see wholly. Triangles
 * are joined by the corners that they share. */
#include "render/scattering/field/radar_target_private.h"

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

/* Whether a triangle has an area, and vertex normals that are all its plane's. */
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

/* Joins the triangles about one corner; the lowest index stands for their face. */
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

Status radar_flat_faces_find(FlatFaces *out, const Model *model)
{
    const size_t count = (size_t)model->triangle_count;
    int         *place = malloc((size_t)model->vertex_count * sizeof *place + 1), *of = malloc(count * sizeof *of + 1);
    Corner      *corner = malloc(3 * count * sizeof *corner + 1);
    Edge        *edge = malloc(3 * count * sizeof *edge + 1);
    Status       status = STATUS_NO_MEMORY;
    FlatFaces    found = {.first = malloc((count + 1) * sizeof *found.first),
                          .triangle = malloc(count * sizeof *found.triangle + 1)};
    int          corners = 0, triangles = 0;
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
    radar_flat_faces_free(&found);
    return status;
}

void radar_flat_faces_free(FlatFaces *faces)
{
    free(faces->first);
    free(faces->triangle);
    *faces = (FlatFaces){0};
}

/* ---- which are wholly seen: rays over each, from the antennas ----------------------------------- */

enum {
    block_rays = 512, /* traced together */
    chunk_faces = 16
};
static const double per_radius = 128;      /* rays over the target's radius, as of tubes */
static const double convex_per_radius = 8; /* where nothing can hide but a sheet at the same place */
static const double inside_m = 5e-4;       /* rays along a border keep off it */
static const double thin_m = 1e-3;         /* triangles thinner than this are seen where the rest of their face is */
static const double grazing = 1e-3;        /* cosine below which an antenna does not see a face */

typedef struct Block {
    double   o[3][block_rays], d[3][block_rays], far_m[block_rays], range_m[block_rays];
    PartHit  hit[block_rays];
    uint32_t triangle[block_rays]; /* each should meet */
    int      list[block_rays], count;
} Block;

typedef struct Search {
    const RadarTarget *target;
    ScatterAntenna     antenna[2];
    int                antennas; /* 1: transmitter and receiver are one */
    double             spacing_m;
    Block             *block; /* one a worker */
    uint8_t           *seen;  /* [faces] */
    long long         *rays;  /* [chunks] */
} Search;

static bool trace_block(Block *block, const RadarTarget *target)
{
    const double *const o[3] = {block->o[0], block->o[1], block->o[2]};
    const double *const d[3] = {block->d[0], block->d[1], block->d[2]};
    bool                met = true;
    for (int i = 0; i < block->count; i++) block->list[i] = i, block->range_m[i] = INFINITY;
    parts_first_hits(block->range_m, block->hit, &target->entity, o, d, block->far_m, block->list, block->count, false);
    for (int i = 0; i < block->count; i++)
        met &= !isinf(block->range_m[i]) && block->hit[i].triangle == block->triangle[i];
    block->count = 0;
    return met;
}

/* A ray from the antenna to a point of a triangle. False: the block was full, and one of its rays met something else.
 * */
static bool ask(Block *block, const Search *s, const ScatterAntenna *antenna, uint32_t triangle, const double p[3],
                long long *rays)
{
    const int    i = block->count++;
    double       way[3];
    const double away_m = antenna->range_m + scatter_path(way, antenna, p);
    const double back_m = fmin(2.5 * s->target->entity.radius_m + 1e-3, away_m);
    for (int c = 0; c < 3; c++) {
        block->o[c][i] = p[c] + back_m * way[c];
        block->d[c][i] = -way[c];
    }
    block->far_m[i] = INFINITY;
    block->triangle[i] = triangle;
    ++*rays;
    return block->count < block_rays || trace_block(block, s->target);
}

/* Points of a triangle in rows along its longest side; then along all sides. */
static bool ask_triangle(Block *block, const Search *s, const ScatterAntenna *antenna, uint32_t triangle,
                         long long *rays)
{
    double corner[3][3], n[3], p[3], middle[3], side_m[3];
    radar_target_corners(corner, s->target, triangle);
    const double area_m2 = radar_corners_normal(n, corner);
    int          base = 0;
    for (int k = 0; k < 3; k++) {
        double side[3];
        v3_sub(side, corner[(k + 1) % 3], corner[k]);
        side_m[k] = v3_length(side);
        if (side_m[k] > side_m[base]) base = k;
        middle[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
    }
    const double *a = corner[base], *b = corner[(base + 1) % 3], *tip = corner[(base + 2) % 3];
    const double  height_m = 2 * area_m2 / side_m[base];
    if (height_m < thin_m) return true;
    if (!ask(block, s, antenna, triangle, middle, rays)) return false;
    for (int k = 0; k < 3; k++) {
        const int    count = (int)ceil(side_m[k] / s->spacing_m);
        const double in = fmin(0.25, 3 * inside_m * side_m[k] / (2 * area_m2)); /* to the middle, a third of a height */
        for (int i = 0; i < count; i++) {
            const double along = (i + 0.5) / count;
            for (int c = 0; c < 3; c++) {
                const double on = corner[k][c] + along * (corner[(k + 1) % 3][c] - corner[k][c]);
                p[c] = on + in * (middle[c] - on);
            }
            if (!ask(block, s, antenna, triangle, p, rays)) return false;
        }
    }
    const int rows = (int)floor(height_m / s->spacing_m);
    for (int j = 0; j < rows; j++) {
        const double up = (j + 0.5) / rows;
        const int    count = (int)ceil((1 - up) * side_m[base] / s->spacing_m);
        for (int i = 0; i < count; i++) {
            const double along = (i + (j % 2 ? 0.25 : 0.75)) / count * (1 - up);
            for (int c = 0; c < 3; c++) p[c] = a[c] + along * (b[c] - a[c]) + up * (tip[c] - a[c]);
            if (!ask(block, s, antenna, triangle, p, rays)) return false;
        }
    }
    return true;
}

/* The side of a face, 1 or -1, that both antennas are on; 0: they are not, or along it. */
static int side_of(const Search *s, const double corner[3][3])
{
    double n[3], way[3];
    int    side = 0;
    radar_corners_normal(n, corner);
    for (int a = 0; a < s->antennas; a++) {
        double least = INFINITY, most = -INFINITY;
        for (int k = 0; k < 3; k++) {
            scatter_path(way, &s->antenna[a], corner[k]);
            least = fmin(least, v3_dot(n, way)), most = fmax(most, v3_dot(n, way));
        }
        const int here = least > grazing ? 1 : most < -grazing ? -1 : 0;
        if (here == 0 || (a > 0 && here != side)) return 0;
        side = here;
    }
    return side;
}

static bool face_is_seen(Block *block, const Search *s, int face, long long *rays)
{
    const FlatFaces *faces = &s->target->faces;
    const int        first = faces->first[face], end = faces->first[face + 1];
    block->count = 0;
    for (int i = first; i < end; i++) {
        double corner[3][3];
        radar_target_corners(corner, s->target, faces->triangle[i]);
        if (side_of(s, corner) == 0) return false;
    }
    for (int a = 0; a < s->antennas; a++) { /* first one ray of each, which finds most of what is hidden */
        for (int i = first; i < end && i < first + block_rays; i++) {
            double corner[3][3], middle[3];
            radar_target_corners(corner, s->target, faces->triangle[i]);
            for (int c = 0; c < 3; c++) middle[c] = 0.4 * corner[0][c] + 0.35 * corner[1][c] + 0.25 * corner[2][c];
            if (!ask(block, s, &s->antenna[a], faces->triangle[i], middle, rays)) return false;
        }
        if (!trace_block(block, s->target)) return false;
    }
    for (int a = 0; a < s->antennas; a++)
        for (int i = first; i < end; i++)
            if (!ask_triangle(block, s, &s->antenna[a], faces->triangle[i], rays)) return false;
    return trace_block(block, s->target);
}

static void look_at_faces(void *user, int worker, int task)
{
    const Search *s = user;
    const int     first = task * chunk_faces, left = s->target->faces.count - first;
    for (int f = first; f < first + (left < chunk_faces ? left : chunk_faces); f++)
        s->seen[f] = face_is_seen(&s->block[worker], s, f, &s->rays[task]);
}

long long radar_flat_faces_seen(uint8_t *seen, const RadarTarget *target, const ScatterAntenna antenna[2], int antennas,
                                Pool *pool)
{
    const int threads = pool ? pool_threads(pool) : 1, chunks = (target->faces.count + chunk_faces - 1) / chunk_faces;
    const double along = target->faces.convex ? convex_per_radius : per_radius;
    Search       s = {.target = target,
                      .antenna = {antenna[0], antenna[1]},
                      .antennas = antennas,
                      .seen = seen,
                      .spacing_m = target->entity.radius_m / along};
    long long    rays = -1;
    s.block = malloc((size_t)threads * sizeof *s.block);
    s.rays = calloc((size_t)chunks + 1, sizeof *s.rays);
    if (s.block && s.rays) {
        if (pool) pool_run(pool, chunks, look_at_faces, &s);
        else
            for (int t = 0; t < chunks; t++) look_at_faces(&s, 0, t);
        rays = 0;
        for (int t = 0; t < chunks; t++) rays += s.rays[t];
    }
    free(s.block);
    free(s.rays);
    return rays;
}
