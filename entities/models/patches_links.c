/* entities/models/patches_links.c: which patches adjoin, and along which length.
 *
 * Within a body: borders are the cuts through its triangles, and the edges of its triangles (by position) with
 * different patches at their sides. Parts are often several shells that only touch, and bodies always are: these are
 * joined where patches are nearest, with a length in proportion to the smaller one. */
#include "entities/models/patches_private.h"

#include <stdlib.h>

static const double distance_least_m = 0.02;
static const double border_least =
    0.03; /* shorter borders, as a share of the root of the smaller area, are mere corners */
static const double joint_share = 0.25; /* length of a joint, as a share of the root of the smaller area */
static const double touch_m = 0.03;     /* bodies touch when their boxes are nearer than this */
static const double nearer =
    0.9;                  /* only a pair nearer by this factor is preferred, since mirrored patches are equally near */
enum { users_most = 32 }; /* most users of an edge that are compared; a closed shell has two */

/* One side of a stretch of an edge, from its lower corner (0) to the higher (1). */
typedef struct EdgeUse {
    int   patch, next;
    float from, to;
} EdgeUse;

typedef struct Edge {
    uint32_t low, high;
    int      use; /* first use in its list; -1: none */
} Edge;

typedef struct Borders {
    uint32_t *slot;  /* vertex + 1 by position; 0: free [slots] */
    size_t    slots; /* powers of 2 */
    uint32_t *place; /* one number for all vertices at one position of one body [vertex_count] */
    Edge     *edge;  /* [edges] */
    size_t    edges;
    EdgeUse  *use;
    size_t    uses, use_capacity;
    double   *length_m; /* [count][count], a < b */
    int       count;
} Borders;

static uint64_t mixed(uint64_t x)
{
    x = (x ^ x >> 32) * 0x9e3779b97f4a7c15u;
    return x ^ x >> 29;
}

static size_t power_above(size_t least)
{
    size_t n = 64;
    while (n < least) n *= 2;
    return n;
}

static void add_border(Borders *b, int one, int other, double length_m)
{
    if (one == other || !(length_m > 0)) return;
    const int low = one < other ? one : other, high = one < other ? other : one;
    b->length_m[(size_t)low * (size_t)b->count + (size_t)high] += length_m;
}

/* The vertex with the lowest index at the same position, in the same body. */
static uint32_t place_of(Borders *b, const Cutter *cutter, const int *body_of_vertex, uint32_t vertex)
{
    const double *p = cutter->model->vertex[vertex];
    uint64_t      hash = (uint64_t)body_of_vertex[vertex];
    for (int i = 0; i < 3; i++) {
        const double x = p[i] + 0.0; /* turns -0 into 0 */
        uint64_t     bits;
        memcpy(&bits, &x, sizeof bits);
        hash = mixed(hash + bits);
    }
    for (size_t at = hash & (b->slots - 1);; at = (at + 1) & (b->slots - 1)) {
        if (b->slot[at] == 0) {
            b->slot[at] = vertex + 1;
            return vertex;
        }
        const uint32_t found = b->slot[at] - 1;
        const double  *q = cutter->model->vertex[found];
        if (body_of_vertex[found] == body_of_vertex[vertex] && p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
            return found;
    }
}

static Status borders_create(Borders *b, const Cutter *cutter, int count)
{
    const Model *m = cutter->model;
    memset(b, 0, sizeof *b);
    b->count = count;
    b->slots = power_above(2 * (size_t)m->vertex_count);
    b->edges = power_above(4 * (size_t)m->triangle_count);
    b->use_capacity = 4 * (size_t)m->triangle_count + 256;
    b->slot = calloc(b->slots, sizeof *b->slot);
    b->place = malloc((size_t)m->vertex_count * sizeof *b->place);
    b->edge = malloc(b->edges * sizeof *b->edge);
    b->use = malloc(b->use_capacity * sizeof *b->use);
    b->length_m = calloc((size_t)count * (size_t)count, sizeof *b->length_m);
    int *body = malloc((size_t)m->vertex_count * sizeof *body);
    if (!b->slot || !b->place || !b->edge || !b->use || !b->length_m || !body) {
        free(body);
        return STATUS_NO_MEMORY;
    }
    for (int v = 0; v < m->vertex_count; v++) body[v] = -1;
    for (int t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 3; k++) body[m->triangle[t][k]] = cutter->body_of_part[m->triangle_part[t]];
    for (int v = 0; v < m->vertex_count; v++) b->place[v] = place_of(b, cutter, body, (uint32_t)v);
    for (size_t e = 0; e < b->edges; e++) b->edge[e].use = -1;
    free(body);
    return STATUS_OK;
}

static void borders_destroy(Borders *b)
{
    free(b->slot);
    free(b->place);
    free(b->edge);
    free(b->use);
    free(b->length_m);
}

/* A stretch of edge k of a triangle, from .. to along it, has this patch at one side. */
static Status add_use(Borders *b, const uint32_t corner[3], const Facet *f, int k, double from, double to, int patch)
{
    uint32_t low = b->place[corner[k]], high = b->place[corner[(k + 1) % 3]];
    if (low == high) return STATUS_OK;
    if (low > high) {
        const uint32_t swap = low;
        low = high;
        high = swap;
        const double back = 1 - from;
        from = 1 - to;
        to = back;
    }
    size_t at = mixed((uint64_t)low << 32 | high) & (b->edges - 1);
    while (b->edge[at].use >= 0 && (b->edge[at].low != low || b->edge[at].high != high)) at = (at + 1) & (b->edges - 1);
    if (b->uses == b->use_capacity) {
        if (b->use_capacity > INT32_MAX / 2) return STATUS_NO_MEMORY;
        EdgeUse *more = realloc(b->use, 2 * b->use_capacity * sizeof *more);
        if (!more) return STATUS_NO_MEMORY;
        b->use = more;
        b->use_capacity *= 2;
    }
    double along[3];
    v3_sub(along, f->p[(k + 1) % 3], f->p[k]);
    const double length = v3_length(along);
    int          seen = 0;
    for (int u = b->edge[at].use; u >= 0 && seen < users_most; u = b->use[u].next, seen++)
        if (b->use[u].patch != patch)
            add_border(b, patch, b->use[u].patch, length * (fmin(to, b->use[u].to) - fmax(from, b->use[u].from)));
    b->use[b->uses] = (EdgeUse){patch, b->edge[at].use, (float)from, (float)to};
    b->edge[at] = (Edge){low, high, (int)b->uses++};
    return STATUS_OK;
}

/* Length that two pieces of one triangle share along their cuts. */
static double shared_m(const Facet *f, const Piece *one, const Piece *other)
{
    double sum = 0;
    for (int i = 0; i < one->corners; i++)
        for (int j = 0; j < other->corners; j++) {
            if (one->border[i] < 3 || one->border[i] != other->border[j]) continue;
            double a[3], b[3], c[3], d[3], along[3];
            facet_point(a, f, one->at[i]);
            facet_point(b, f, one->at[(i + 1) % one->corners]);
            facet_point(c, f, other->at[j]);
            facet_point(d, f, other->at[(j + 1) % other->corners]);
            v3_sub(along, b, a);
            const double length = v3_length(along);
            if (!(length > 0)) continue;
            v3_sub(c, c, a);
            v3_sub(d, d, a);
            const double s = v3_dot(c, along) / length, t = v3_dot(d, along) / length;
            sum += fmax(0, fmin(length, fmax(s, t)) - fmax(0, fmin(s, t)));
        }
    return sum;
}

static Status measure_borders(Borders *b, const Cutter *cutter)
{
    const Model *m = cutter->model;
    for (int t = 0; t < m->triangle_count; t++) {
        const Body *body = &cutter->body[cutter->body_of_part[m->triangle_part[t]]];
        Facet       f;
        Piece       piece[cells_most];
        if (body->count == 1 || !facet_read(&f, cutter, t)) continue;
        const int pieces = facet_cut(piece, &f, body);
        for (int i = 0; i < pieces; i++) {
            const int patch = body->first + body->map[piece[i].cell];
            for (int j = 0; j < i; j++) {
                const int before = body->first + body->map[piece[j].cell];
                if (before != patch) add_border(b, before, patch, shared_m(&f, &piece[j], &piece[i]));
            }
            for (int c = 0; c < piece[i].corners; c++) {
                const int k = piece[i].border[c];
                if (k > 2) continue;
                const double *from = piece[i].at[c], *to = piece[i].at[(c + 1) % piece[i].corners];
                if (add_use(b, m->triangle[t], &f, k, from[(k + 1) % 3], to[(k + 1) % 3], patch) != STATUS_OK)
                    return STATUS_NO_MEMORY;
            }
        }
    }
    return STATUS_OK;
}

/* ---- joints ----------------------------------------------------------------------------------- */

typedef struct Network {
    const Patches *patches;
    double        *length_m; /* [count][count], a < b: length of the border; negative: a joint */
    double         p_body[patches_most][3];
    int            group[patches_most]; /* the lowest patch of those that are connected */
} Network;

static double distance_m(const Network *w, int a, int b)
{
    double d[3];
    v3_sub(d, w->p_body[a], w->p_body[b]);
    return v3_length(d);
}

static void connect(Network *w, int a, int b)
{
    const int low = w->group[a] < w->group[b] ? w->group[a] : w->group[b], high = w->group[a] + w->group[b] - low;
    for (int i = 0; i < w->patches->count; i++)
        if (w->group[i] == high) w->group[i] = low;
}

static void add_joint(Network *w, int one, int other)
{
    const int     a = one < other ? one : other, b = one < other ? other : one;
    const Patch  *p = w->patches->patch;
    double *const length = &w->length_m[(size_t)a * (size_t)w->patches->count + (size_t)b];
    if (*length == 0) *length = -joint_share * sqrt(fmin(p[a].area_m2, p[b].area_m2));
    connect(w, a, b);
}

/* Finds the nearest pair of a patch among first .. end - 1 in the group (-1: in any) and one among other_first ..
 * other_end - 1 not in that group. Returns false when there is none. */
static bool nearest_pair(int pair[2], const Network *w, int group, int first, int end, int other_first, int other_end)
{
    double best = INFINITY;
    for (int a = first; a < end; a++)
        for (int b = other_first; b < other_end; b++) {
            if (group >= 0 && (w->group[a] != group || w->group[b] == group)) continue;
            const double d = distance_m(w, a, b);
            if (!(d < best * nearer)) continue;
            best = d;
            pair[0] = a;
            pair[1] = b;
        }
    return best < INFINITY;
}

static bool boxes_touch(const Body *a, const Body *b)
{
    for (int i = 0; i < 3; i++)
        if (a->box_low[i] > b->box_high[i] + touch_m || b->box_low[i] > a->box_high[i] + touch_m) return false;
    return true;
}

static void join_all(Network *w, const Cutter *cutter)
{
    int pair[2];
    /* shells of one body */
    for (int i = 0; i < cutter->bodies; i++) {
        const int first = cutter->body[i].first, end = first + cutter->body[i].count;
        while (nearest_pair(pair, w, w->group[first], first, end, first, end)) add_joint(w, pair[0], pair[1]);
    }
    for (int i = 0; i < cutter->bodies; i++)
        for (int k = i + 1; k < cutter->bodies; k++) {
            const Body *a = &cutter->body[i], *b = &cutter->body[k];
            if (boxes_touch(a, b) &&
                nearest_pair(pair, w, -1, a->first, a->first + a->count, b->first, b->first + b->count))
                add_joint(w, pair[0], pair[1]);
        }
    /* joins groups of bodies that touch each other but no others, as a rotor above its mast; a single body stays alone
     * */
    const int count = w->patches->count;
    for (int i = 0; i < cutter->bodies; i++) {
        const int first = cutter->body[i].first;
        bool      alone = true;
        for (int k = 0; k < cutter->bodies; k++) alone &= k == i || w->group[cutter->body[k].first] != w->group[first];
        while (!alone && w->group[first] != w->group[0] && nearest_pair(pair, w, w->group[first], 0, count, 0, count))
            add_joint(w, pair[0], pair[1]);
    }
}

static Status collect(Patches *out, const Network *w)
{
    const size_t n = (size_t)out->count;
    for (size_t i = 0; i < n * n; i++) out->links += w->length_m[i] != 0;
    out->link = calloc((size_t)(out->links > 0 ? out->links : 1), sizeof *out->link);
    if (!out->link) return STATUS_NO_MEMORY;
    PatchLink *link = out->link;
    for (int a = 0; a < out->count; a++)
        for (int b = a + 1; b < out->count; b++) {
            const double length = w->length_m[(size_t)a * n + (size_t)b];
            if (length == 0) continue;
            *link++ = (PatchLink){a, b, fabs(length), fmax(distance_m(w, a, b), distance_least_m), length < 0};
        }
    return STATUS_OK;
}

Status patches_link(Patches *out, const Cutter *cutter)
{
    Borders      borders;
    const size_t n = (size_t)out->count;
    Status       status = borders_create(&borders, cutter, out->count);
    if (status == STATUS_OK) status = measure_borders(&borders, cutter);
    if (status == STATUS_OK) {
        Network w = {.patches = out, .length_m = borders.length_m};
        for (int i = 0; i < out->count; i++) {
            const NodePose *pose = &cutter->pose[out->patch[i].node];
            double          p[3];
            m3_mul_v3(p, pose->r_body_from_node, out->patch[i].p_node);
            v3_add(w.p_body[i], p, pose->p_body);
            w.group[i] = i;
        }
        for (int a = 0; a < out->count; a++)
            for (int b = a + 1; b < out->count; b++) {
                double *const length = &w.length_m[(size_t)a * n + (size_t)b];
                if (*length < border_least * sqrt(fmin(out->patch[a].area_m2, out->patch[b].area_m2))) *length = 0;
                if (*length > 0) connect(&w, a, b);
            }
        join_all(&w, cutter);
        status = collect(out, &w);
    }
    borders_destroy(&borders);
    return status;
}
