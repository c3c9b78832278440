/* entities/scenery/scenery_skeleton.c: the straight skeleton of an outline: the plan of a roof whose slopes rise alike
 * from all eaves. Source of the method: O. Aichholzer et al., "A novel type of skeleton for polygons" (1995): the
 * outline shrinks, and events (an edge vanishes; a corner meets an edge) are met in their order. An edge that stands
 * still makes a gable. What the events leave undone ends as a flat top. */
#include "entities/scenery/scenery_buildings_private.h"

#include <stdlib.h>

enum { nodes_most = 8 * roof_plan_corners, links_most = 8 * nodes_most, fronts_most = 4 * roof_plan_corners };

static const double snap_m = 1e-3; /* nodes nearer than this are one */

/* A corner of the outline as it shrinks: between two edges, from its node on. */
typedef struct Front {
    int    left, right, node;
    double p[2], v[2]; /* now; per unit of time */
} Front;

typedef struct Ring {
    int    first, count; /* of front */
    double time_m;
} Ring;

/* A directed side of a face: an edge's, or that of a flat top (edges + its number). */
typedef struct Link {
    int face, from, to;
} Link;

typedef struct Skeleton {
    int n, nodes, links, rings, tops;
    double (*edge)[3]; /* unit direction, and the speed at which it moves inwards */
    const double (*p)[2];
    double node[nodes_most][3];
    int    same[nodes_most]; /* the node that stands for it */
    Link   link[links_most];
    Front  front[fronts_most];
    Ring   ring[roof_plan_corners];
    bool   full; /* no room was left */
} Skeleton;

static double dot2(const double a[2], const double b[2]) { return a[0] * b[0] + a[1] * b[1]; }
static double cross2(const double a[2], const double b[2]) { return a[0] * b[1] - a[1] * b[0]; }

static int add_node(Skeleton *s, const double p[2], double time_m)
{
    if (s->nodes == nodes_most) {
        s->full = true;
        return 0;
    }
    s->node[s->nodes][0] = p[0], s->node[s->nodes][1] = p[1], s->node[s->nodes][2] = time_m;
    return s->nodes++;
}

static void add_link(Skeleton *s, int face, int from, int to)
{
    if (s->links == links_most) s->full = true;
    else s->link[s->links++] = (Link){face, from, to};
}

/* The path of a corner, from its node to where it ends: a side of both its faces. */
static void end_path(Skeleton *s, const Front *f, int node)
{
    add_link(s, f->left, f->node, node);
    add_link(s, f->right, node, f->node);
}

/* Velocity of the corner between two edges: both move inwards (to the left of their direction). */
static void set_velocity(const Skeleton *s, Front *f)
{
    const double *a = s->edge[f->left], *b = s->edge[f->right], det = cross2(a, b);
    const double  na[2] = {-a[1], a[0]}, nb[2] = {-b[1], b[0]};
    if (fabs(det) > 1e-9) {
        f->v[0] = (a[2] * nb[1] - b[2] * na[1]) / det;
        f->v[1] = (b[2] * na[0] - a[2] * nb[0]) / det;
    } else { /* in one line; of edges that meet head on nothing is left, or a flat top */
        const double speed = dot2(a, b) > 0 ? fmin(a[2], b[2]) : 0;
        f->v[0] = speed * na[0], f->v[1] = speed * na[1];
    }
}

/* ---- events --------------------------------------------------------------------------------------- */

typedef struct Event {
    double after_m; /* from the ring's time; infinite: none */
    int    at;      /* collapse: the edge after this front vanishes; split: this front meets .. */
    int    edge;    /* .. the edge after this front; -1: a collapse */
} Event;

static void offer(Event *best, double after_m, int at, int edge)
{
    const double later = fmax(after_m, 0);
    if (after_m > -1e-6 && later < best->after_m) *best = (Event){later, at, edge};
}

static void offer_split(Event *best, const Skeleton *s, const Front *f, int m, int i)
{
    for (int j = 0; j < m; j++) {
        const Front  *a = &f[j], *b = &f[(j + 1) % m];
        const double *e = s->edge[a->right], normal[2] = {-e[1], e[0]};
        if (a->right == f[i].left || a->right == f[i].right) continue;
        const double way[2] = {f[i].p[0] - a->p[0], f[i].p[1] - a->p[1]};
        const double nearing = e[2] - dot2(normal, f[i].v), distance_m = dot2(normal, way);
        if (!(nearing > 1e-9) || distance_m < -1e-6) continue;
        const double after_m = fmax(distance_m / nearing, 0);
        if (after_m >= best->after_m) continue;
        double q[2], from[2], to[2];
        for (int c = 0; c < 2; c++) {
            q[c] = f[i].p[c] + after_m * f[i].v[c];
            from[c] = q[c] - (a->p[c] + after_m * a->v[c]);
            to[c] = b->p[c] + after_m * b->v[c] - q[c];
        }
        if (dot2(from, e) > -1e-6 && dot2(to, e) > -1e-6) offer(best, after_m, i, j);
    }
}

static Event next_event(const Skeleton *s, const Ring *ring)
{
    const Front *f = &s->front[ring->first];
    const int    m = ring->count;
    Event        best = {INFINITY, 0, -1};
    for (int i = 0; i < m; i++) {
        const Front  *a = &f[i], *b = &f[(i + 1) % m];
        const double *e = s->edge[a->right];
        const double  length[2] = {b->p[0] - a->p[0], b->p[1] - a->p[1]};
        const double  shrinking = dot2(e, a->v) - dot2(e, b->v), length_m = dot2(e, length);
        if (shrinking > 1e-9) offer(&best, length_m / shrinking, i, -1);
        else if (shrinking > -1e-9 && length_m < 1e-7) offer(&best, 0, i, -1); /* left of no length by a split */
    }
    for (int i = 0; i < m; i++)
        if (cross2(s->edge[f[i].left], s->edge[f[i].right]) < -1e-9) offer_split(&best, s, f, m, i);
    return best;
}

static void advance(Skeleton *s, Ring *ring, double by_m)
{
    for (int k = 0; k < ring->count; k++) {
        Front *f = &s->front[ring->first + k];
        for (int c = 0; c < 2; c++) f->p[c] += by_m * f->v[c];
    }
    ring->time_m += by_m;
}

/* The edge after front i is gone: its ends are one corner. */
static void collapse(Skeleton *s, Ring *ring, int i)
{
    Front       *f = &s->front[ring->first];
    const int    k = (i + 1) % ring->count;
    const double middle[2] = {0.5 * (f[i].p[0] + f[k].p[0]), 0.5 * (f[i].p[1] + f[k].p[1])};
    const int    node = add_node(s, middle, ring->time_m);
    end_path(s, &f[i], node), end_path(s, &f[k], node);
    f[i] = (Front){f[i].left, f[k].right, node, {middle[0], middle[1]}, {0}};
    set_velocity(s, &f[i]);
    for (int c = k; c + 1 < ring->count; c++) f[c] = f[c + 1];
    ring->count--;
}

/* Front i meets the edge after front j: two rings. */
static void split(Skeleton *s, int i, int j)
{
    Ring     *ring = &s->ring[s->rings - 1];
    Front    *f = &s->front[ring->first], *spare = f + ring->count;
    const int m = ring->count, node = add_node(s, f[i].p, ring->time_m);
    if (ring->first + 2 * m + 1 > fronts_most || s->rings == roof_plan_corners) {
        s->full = true;
        return;
    }
    const Front corner = f[i];
    end_path(s, &corner, node);
    int made = 0, first_made;
    spare[made++] = (Front){f[j].right, corner.right, node, {corner.p[0], corner.p[1]}, {0}};
    for (int k = (i + 1) % m; k != (j + 1) % m; k = (k + 1) % m) spare[made++] = f[k];
    first_made = made;
    spare[made++] = (Front){corner.left, f[j].right, node, {corner.p[0], corner.p[1]}, {0}};
    for (int k = (j + 1) % m; k != i; k = (k + 1) % m) spare[made++] = f[k];
    set_velocity(s, &spare[0]), set_velocity(s, &spare[first_made]);
    memmove(f, spare, (size_t)made * sizeof *f);
    ring->count = first_made;
    s->ring[s->rings++] = (Ring){ring->first + first_made, made - first_made, ring->time_m};
}

/* ---- ends ----------------------------------------------------------------------------------------- */

static bool is_thin(const Front *f, int m)
{
    double area = 0, around = 0;
    for (int k = 0; k < m; k++) {
        const Front *a = &f[k], *b = &f[(k + 1) % m];
        const double x = a->p[0] - f[0].p[0], y = a->p[1] - f[0].p[1];
        area += 0.5 * (x * (b->p[1] - f[0].p[1]) - (b->p[0] - f[0].p[0]) * y);
        around += hypot(b->p[0] - a->p[0], b->p[1] - a->p[1]);
    }
    return !(area > 0.1 * snap_m * around);
}

/* The next node of a ring on the way from front a to b, farther than `from_m`; b when there is none. Returns how far.
 */
static double next_on_way(int *next, const Front *f, int m, int a, int b, double from_m)
{
    const double d[2] = {f[b].p[0] - f[a].p[0], f[b].p[1] - f[a].p[1]}, length_m = hypot(d[0], d[1]);
    double       nearest_m = length_m;
    *next = b;
    for (int o = 0; o < m && length_m > 2 * snap_m; o++) {
        const double q[2] = {f[o].p[0] - f[a].p[0], f[o].p[1] - f[a].p[1]}, along_m = dot2(d, q) / length_m;
        if (fabs(cross2(d, q)) / length_m < snap_m && along_m > from_m + snap_m && along_m < nearest_m - snap_m)
            nearest_m = along_m, *next = o;
    }
    return nearest_m;
}

/* What is left of a ring: ridges, where it has no width (a side goes through all nodes on its way then, so that the two
 * sides of a ridge are the same pieces), or a flat top. */
static void finish(Skeleton *s, const Ring *ring)
{
    Front     *f = &s->front[ring->first];
    const int  m = ring->count;
    const bool thin = m < 3 || is_thin(f, m);
    const int  top = thin ? -1 : s->n + s->tops++;
    for (int k = 0; k < m; k++) {
        const int node = add_node(s, f[k].p, ring->time_m);
        end_path(s, &f[k], node);
        f[k].node = node;
    }
    for (int k = 0; k < m; k++) {
        const int b = (k + 1) % m;
        double    along_m = 0;
        for (int at = k, next; at != b; at = next) {
            next = b;
            if (thin) along_m = next_on_way(&next, f, m, k, b, along_m);
            add_link(s, f[k].right, f[next].node, f[at].node);
            if (!thin) add_link(s, top, f[at].node, f[next].node);
        }
    }
}

static void shrink(Skeleton *s)
{
    for (int steps = 0; s->rings > 0 && !s->full; steps++) {
        Ring       *ring = &s->ring[s->rings - 1];
        const Event event = next_event(s, ring);
        if (ring->count < 3 || is_thin(&s->front[ring->first], ring->count) || !isfinite(event.after_m) ||
            steps > 8 * s->n) {
            finish(s, ring);
            s->rings--;
            continue;
        }
        advance(s, ring, event.after_m);
        if (event.edge < 0) collapse(s, ring, event.at);
        else split(s, event.at, event.edge);
    }
}

/* ---- faces ---------------------------------------------------------------------------------------- */

static void snap(Skeleton *s)
{
    for (int k = 0; k < s->nodes; k++) {
        s->same[k] = k;
        for (int o = 0; k >= s->n && o < k && s->same[k] == k; o++)
            if (s->same[o] == o && fabs(s->node[o][0] - s->node[k][0]) < snap_m &&
                fabs(s->node[o][1] - s->node[k][1]) < snap_m)
                s->same[k] = o;
    }
}

static int link_order(const void *a, const void *b)
{
    const Link *p = a, *q = b;
    if (p->face != q->face) return p->face < q->face ? -1 : 1;
    if (p->from != q->from) return p->from < q->from ? -1 : 1;
    return p->to < q->to ? -1 : p->to > q->to;
}

/* Snaps, and drops sides of no length and those that a face goes along both ways. */
static void tidy(Skeleton *s)
{
    int kept = 0;
    for (int k = 0; k < s->links; k++) {
        const Link l = {s->link[k].face, s->same[s->link[k].from], s->same[s->link[k].to]};
        if (l.from == l.to) continue;
        int back = 0;
        while (back < kept &&
               (s->link[back].face != l.face || s->link[back].from != l.to || s->link[back].to != l.from))
            back++;
        if (back < kept) s->link[back] = s->link[--kept];
        else s->link[kept++] = l;
    }
    s->links = kept;
    qsort(s->link, (size_t)kept, sizeof *s->link, link_order);
}

/* The side of the same face that goes on at a node; of several that which turns left most. */
static int follow(const Skeleton *s, const bool *used, int at)
{
    const Link   *l = &s->link[at];
    const double *a = s->node[l->from], *b = s->node[l->to];
    int           best = -1;
    double        best_turn = -INFINITY;
    for (int k = 0; k < s->links; k++) {
        const Link *o = &s->link[k];
        if (o->face != l->face || o->from != l->to || used[k]) continue;
        const double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {s->node[o->to][0] - b[0], s->node[o->to][1] - b[1]};
        const double turn = atan2(cross2(u, v), dot2(u, v));
        if (turn > best_turn) best = k, best_turn = turn;
    }
    return best;
}

/* Whether a face seen from above (of a gable: along its edge, from outside) is cut into positive triangles. */
static bool is_positive(const Skeleton *s, Status *status, const int *index, int count, int face)
{
    double(*flat)[2] = malloc((size_t)count * sizeof *flat);
    int(*triangle)[3] = malloc((size_t)count * sizeof *triangle);
    bool ok = flat && triangle;
    if (!ok) *status = STATUS_NO_MEMORY;
    for (int k = 0; k < count && ok; k++) {
        const double *p = s->node[index[k]];
        const bool    gable = face < s->n && s->edge[face][2] == 0;
        flat[k][0] = gable ? dot2(s->edge[face], p) : p[0], flat[k][1] = gable ? p[2] : p[1];
        /* a gable stands over its edge alone */
        const double *a = s->node[face % s->n], *b = s->node[(face + 1) % s->n];
        if (gable) ok = flat[k][0] > dot2(s->edge[face], a) - snap_m && flat[k][0] < dot2(s->edge[face], b) + snap_m;
    }
    ok = ok && outline_triangulate(triangle, status, (const double(*)[2])flat, count);
    for (int t = 0; t < count - 2 && ok; t++) {
        const double *a = flat[triangle[t][0]], *b = flat[triangle[t][1]], *c = flat[triangle[t][2]];
        ok = cross2((double[2]){b[0] - a[0], b[1] - a[1]}, (double[2]){c[0] - a[0], c[1] - a[1]}) > 1e-9;
    }
    free(flat), free(triangle);
    return ok;
}

static bool collect(RoofPlan *out, Status *status, const Skeleton *s, bool *used)
{
    int at = 0;
    for (int start = 0; start < s->links; start++) {
        if (used[start]) continue;
        const int first = at;
        int       k = start;
        for (; k >= 0 && !used[k]; k = follow(s, used, k)) {
            used[k] = true;
            out->index[at++] = s->link[k].from;
            if (s->link[k].to == s->link[start].from) break;
        }
        const int face = s->link[start].face;
        if (k < 0 || at - first < 3 || !is_positive(s, status, out->index + first, at - first, face)) return false;
        out->edge[out->faces] = face < s->n ? face : -1;
        out->first[out->faces++] = first;
        out->first[out->faces] = at;
    }
    return out->faces > 0;
}

static void begin(Skeleton *s, const double (*p)[2], int n, const bool *gable)
{
    s->n = n, s->p = p;
    for (int k = 0; k < n; k++) {
        const double d[2] = {p[(k + 1) % n][0] - p[k][0], p[(k + 1) % n][1] - p[k][1]}, length = hypot(d[0], d[1]);
        s->edge[k][0] = d[0] / length, s->edge[k][1] = d[1] / length, s->edge[k][2] = gable && gable[k] ? 0 : 1;
        add_node(s, p[k], 0);
        add_link(s, k, k, (k + 1) % n);
    }
    for (int k = 0; k < n; k++) {
        s->front[k] = (Front){(k + n - 1) % n, k, k, {p[k][0], p[k][1]}, {0}};
        set_velocity(s, &s->front[k]);
    }
    s->ring[s->rings++] = (Ring){0, n, 0};
}

bool roof_plan_make(RoofPlan *out, Status *status, const double (*p)[2], int n, const bool *gable)
{
    *out = (RoofPlan){0};
    if (n > roof_plan_corners) return false;
    Skeleton *s = calloc(1, sizeof *s);
    bool     *used = calloc(links_most, sizeof *used);
    bool      made = false;
    if (s) s->edge = calloc((size_t)n, sizeof *s->edge);
    if (!s || !s->edge || !used) {
        *status = STATUS_NO_MEMORY;
    } else {
        begin(s, p, n, gable);
        shrink(s);
        snap(s);
        tidy(s);
        out->node = malloc((size_t)s->nodes * sizeof *out->node);
        out->index = malloc((size_t)s->links * sizeof *out->index);
        out->edge = malloc((size_t)s->links * sizeof *out->edge);
        out->first = calloc((size_t)s->links + 1, sizeof *out->first);
        if (!out->node || !out->index || !out->edge || !out->first) *status = STATUS_NO_MEMORY;
        else made = !s->full && collect(out, status, s, used);
        if (made) {
            memcpy(out->node, s->node, (size_t)s->nodes * sizeof *out->node);
            out->nodes = s->nodes, out->corners = n;
            for (int k = 0; k < out->first[out->faces]; k++)
                out->most_time_m = fmax(out->most_time_m, out->node[out->index[k]][2]);
        }
    }
    if (s) free(s->edge);
    free(s), free(used);
    if (!made) roof_plan_free(out);
    return made;
}

void roof_plan_free(RoofPlan *plan)
{
    free(plan->node), free(plan->first), free(plan->index), free(plan->edge);
    *plan = (RoofPlan){0};
}
