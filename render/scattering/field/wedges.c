/* render/scattering/field/wedges.c: finds the wedges of a triangle mesh. Corners are welded, faces sorted by edge,
 * straight pieces joined. */
#include "render/scattering/field/wedges_private.h"

#include <assert.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double same_rad = 1e-3; /* directions that count as one */

WedgeConfig wedges_default_config(void) { return (WedgeConfig){.weld_m = 1e-4, .angle_rad = 0.26}; }

/* --- Corners at the same place --- */

typedef struct Cells {
    const Model *model;
    double       weld_m;
    uint32_t     mask;
    int         *head, *next; /* [mask + 1] and [vertex_count]; -1: none */
} Cells;

static uint32_t cell_of(const Cells *c, const double p[3], const int shift[3])
{
    uint64_t hash = 0;
    for (int i = 0; i < 3; i++) {
        const int64_t at = (int64_t)fmin(fmax(floor(p[i] / c->weld_m), -1e15), 1e15) + shift[i];
        hash = (hash ^ (uint64_t)at) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return (uint32_t)hash & c->mask;
}

/* Finds the first corner of the same node within weld_m; where there is none before it, the corner itself. */
static int find_place(const Cells *c, const int *node, int vertex)
{
    const double *p = c->model->vertex[vertex];
    int           best = vertex;
    for (int n = 0; n < 27; n++) {
        const int shift[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        for (int other = c->head[cell_of(c, p, shift)]; other >= 0; other = c->next[other]) {
            double d[3];
            v3_sub(d, c->model->vertex[other], p);
            if (other < best && node[other] == node[vertex] && v3_length(d) <= c->weld_m) best = other;
        }
    }
    return best;
}

Status wedges_weld(int *place, const Model *m, double weld_m)
{
    const int n = m->vertex_count;
    Cells     cells = {.model = m, .weld_m = weld_m, .mask = 15};
    while (cells.mask < (uint32_t)n) cells.mask = cells.mask * 2 + 1;
    cells.head = malloc((cells.mask + (size_t)1) * sizeof *cells.head);
    cells.next = malloc((size_t)n * sizeof *cells.next + 1);
    int       *node = malloc((size_t)n * sizeof *node + 1);
    const bool ok = cells.head && cells.next && node;
    if (ok) {
        for (uint32_t i = 0; i <= cells.mask; i++) cells.head[i] = -1;
        for (int v = 0; v < n; v++) node[v] = -1;
        for (int t = 0; t < m->triangle_count; t++)
            for (int k = 0; k < 3; k++) node[m->triangle[t][k]] = m->part[m->triangle_part[t]].node;
        for (int v = 0; v < n; v++) {
            place[v] = find_place(&cells, node, v);
            if (place[v] != v) continue; /* only vertices that stand for others are looked for */
            int *head = &cells.head[cell_of(&cells, m->vertex[v], (const int[3]){0, 0, 0})];
            cells.next[v] = *head;
            *head = v;
        }
    }
    free(cells.head);
    free(cells.next);
    free(node);
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

/* --- Faces about an edge --- */

/* A triangle, and one of its sides. */
typedef struct Side {
    int    low, high; /* places, low < high */
    int    part, triangle;
    int    from, to;   /* the vertices at low and high */
    double x[3], n[3]; /* in the face away from the edge; its normal */
    bool   along;      /* the triangle runs from low to high: its free side is at larger angles about that direction */
} Side;

static int side_order(const void *a, const void *b)
{
    const Side *s = a, *t = b;
    if (s->low != t->low) return s->low < t->low ? -1 : 1;
    if (s->high != t->high) return s->high < t->high ? -1 : 1;
    if (s->part != t->part) return s->part < t->part ? -1 : 1;
    return (s->triangle > t->triangle) - (s->triangle < t->triangle);
}

static int find_sides(Side *out, const Model *m, const int *place)
{
    int count = 0;
    for (int t = 0; t < m->triangle_count; t++) {
        const uint32_t *v = m->triangle[t];
        double          ab[3], ac[3], n[3];
        v3_sub(ab, m->vertex[v[1]], m->vertex[v[0]]);
        v3_sub(ac, m->vertex[v[2]], m->vertex[v[0]]);
        v3_cross(n, ab, ac);
        const bool flat = place[v[0]] == place[v[1]] || place[v[1]] == place[v[2]] || place[v[2]] == place[v[0]];
        if (flat || !v3_normalize(n, n)) continue;
        for (int k = 0; k < 3; k++) {
            const int a = (int)v[k], b = (int)v[(k + 1) % 3];
            Side      s = {.part = m->triangle_part[t], .triangle = t, .along = place[a] < place[b]};
            s.from = s.along ? a : b;
            s.to = s.along ? b : a;
            s.low = place[s.from];
            s.high = place[s.to];
            double e[3];
            v3_sub(e, m->vertex[b], m->vertex[a]);
            v3_cross(s.x, n, e);
            if (!v3_normalize(s.x, s.x)) continue;
            memcpy(s.n, n, sizeof n);
            out[count++] = s;
        }
    }
    qsort(out, (size_t)count, sizeof *out, side_order);
    return count;
}

/* Whether vertex normals say that two faces are one smooth surface, at either end. flip: they look to opposite sides.
 * */
static bool smooth(const Model *m, const Side *s, const Side *t, bool flip, double angle_rad)
{
    const int end[2][2] = {{s->from, t->from}, {s->to, t->to}};
    for (int i = 0; i < 2; i++) {
        double n[2][3];
        bool   given = m->normal != NULL;
        for (int k = 0; k < 2 && given; k++) {
            for (int axis = 0; axis < 3; axis++) n[k][axis] = (double)m->normal[end[i][k]][axis];
            given = v3_normalize(n[k], n[k]);
        }
        if (given && v3_dot(n[0], n[1]) * (flip ? -1 : 1) > cos(angle_rad)) return true;
    }
    return false;
}

/* What is found, before pieces are joined. */
typedef struct Found {
    const Model *model;
    double       angle_rad;
    const bool  *open; /* parts with an open boundary */
    Wedge       *wedge;
    int (*end)[2]; /* places of the ends */
    int count, concave, junctions;
} Found;

static void add_wedge(Found *f, const Side *s, bool front, double exterior_rad)
{
    Wedge     *w = &f->wedge[f->count];
    const bool along = s->along == front;
    memset(w, 0, sizeof *w);
    w->part = s->part;
    w->node = f->model->part[s->part].node;
    w->frame.exterior_pi = fmin(exterior_rad / pi, 2);
    memcpy(w->p[0], f->model->vertex[along ? s->low : s->high], sizeof w->p[0]);
    memcpy(w->p[1], f->model->vertex[along ? s->high : s->low], sizeof w->p[1]);
    f->end[f->count][0] = along ? s->low : s->high;
    f->end[f->count++][1] = along ? s->high : s->low;

    /* x as the face has it, across the line between the welded ends */
    WedgeFrame *g = &w->frame;
    v3_sub(g->z, w->p[1], w->p[0]);
    v3_normalize(g->z, g->z);
    v3_add_scaled(g->x, s->x, -v3_dot(s->x, g->z), g->z);
    v3_normalize(g->x, g->x);
    v3_cross(g->y, g->z, g->x);
}

/* The faces that lie in one direction about an edge. */
typedef struct Fan {
    const Side *side[2]; /* the first that runs against low to high, and along it; NULL: none */
} Fan;

enum { fans_most = 8 };

static const Side *first_of(const Fan *fan) { return fan->side[0] ? fan->side[0] : fan->side[1]; }

/* An edge of three faces or more scatters as a wedge where free space between two of them spans more than pi; what the
 * others do is hidden from there. */
static void add_junction(Found *f, const Fan *fan, int fans)
{
    const Side *base = first_of(&fan[0]);
    double      angle[fans_most], widest = 0;
    int         from = 0, to = 0;
    for (int i = 0; i < fans; i++) { /* about the direction from low to high */
        const double *x = first_of(&fan[i])->x, up = v3_dot(x, base->n) * (base->along ? 1 : -1);
        angle[i] = atan2(up, v3_dot(x, base->x));
    }
    for (int i = 0; i < fans; i++) {
        double gap = 2 * pi; /* to the next one */
        int    next = i;
        for (int k = 0; k < fans; k++) {
            const double ahead = angle[k] - angle[i] + (angle[k] < angle[i] ? 2 * pi : 0);
            if (k != i && ahead < gap) gap = ahead, next = k;
        }
        if (gap > widest) widest = gap, from = i, to = next;
    }
    const Side *a = first_of(&fan[from]), *b = first_of(&fan[to]);
    const bool  free = fan[from].side[true] && fan[to].side[false];
    if (widest < pi + f->angle_rad || !(free || f->open[a->part] || f->open[b->part])) f->junctions++;
    else add_wedge(f, a, a->along, widest);
}

/* Adds an edge with the faces side[0 .. count) that meet at it. */
static void add_edge(Found *f, const Side *const *side, int count)
{
    Fan fan[fans_most] = {0};
    int fans = 0;
    for (int i = 0; i < count; i++) {
        int k = 0;
        while (k < fans && v3_dot(first_of(&fan[k])->x, side[i]->x) < cos(same_rad)) k++;
        if (k == fans_most) {
            f->junctions++;
            return;
        }
        if (k == fans) fans++;
        if (!fan[k].side[side[i]->along]) fan[k].side[side[i]->along] = side[i];
    }
    if (fans == 1) {
        add_wedge(f, first_of(&fan[0]), true, 2 * pi);
        return;
    }
    if (fans > 2) {
        add_junction(f, fan, fans);
        return;
    }
    /* Angle from the first face to the second, counted to the side that the first looks to. */
    const Side *a = first_of(&fan[0]), *b = fan[1].side[!a->along];
    const bool  two_sided = !b || (fan[0].side[0] && fan[0].side[1]) || (fan[1].side[0] && fan[1].side[1]);
    const bool  flip = !b;
    if (flip) b = first_of(&fan[1]);
    double angle = atan2(v3_dot(b->x, a->n), v3_dot(b->x, a->x));
    if (angle < 0) angle += 2 * pi;
    if (fabs(angle - pi) < f->angle_rad || smooth(f->model, a, b, flip, f->angle_rad)) return;
    if (angle > pi) add_wedge(f, a, true, angle);
    else if (two_sided || f->open[a->part]) add_wedge(f, a, false, 2 * pi - angle);
    else f->concave++;
}

static int run_of(const Side *side, int from, int count, bool by_part)
{
    int to = from + 1;
    while (to < count && side[to].low == side[from].low && side[to].high == side[from].high &&
           (!by_part || side[to].part == side[from].part))
        to++;
    return to;
}

/* open: [part_count]; pool: [count]. */
static void find_pieces(Found *f, const Side *side, int count, bool *open, const Side **pool)
{
    for (int at = 0, to; at < count; at = to) {
        to = run_of(side, at, count, true);
        if (to == at + 1) open[side[at].part] = true;
    }
    for (int edge = 0, next; edge < count; edge = next) {
        next = run_of(side, edge, count, false);
        int singles = 0;
        for (int at = edge, to; at < next; at = to) {
            to = run_of(side, at, next, true);
            if (to == at + 1) {
                pool[singles++] = &side[at];
                continue;
            }
            const Side **own = pool + (at - edge); /* behind the singles so far */
            for (int i = at; i < to; i++) own[i - at] = &side[i];
            add_edge(f, own, to - at);
        }
        if (singles) add_edge(f, pool, singles);
    }
}

/* --- Straight pieces --- */

/* Gives the same wedge with its faces exchanged. */
static void turn(Wedge *out, const Wedge *w)
{
    const double opening = w->frame.exterior_pi * pi;
    *out = *w;
    v3_scale(out->frame.x, cos(opening), w->frame.x);
    v3_add_scaled(out->frame.x, out->frame.x, sin(opening), w->frame.y);
    v3_scale(out->frame.z, -1, w->frame.z);
    v3_cross(out->frame.y, out->frame.z, out->frame.x);
    memcpy(out->p[0], w->p[1], sizeof out->p[0]);
    memcpy(out->p[1], w->p[0], sizeof out->p[1]);
}

/* Whether b (as it is, or turned: then *swap) goes on as a does. */
static bool continues(bool *swap, const Wedge *a, const Wedge *b)
{
    if (a->node != b->node || a->part != b->part || fabs(a->frame.exterior_pi - b->frame.exterior_pi) > same_rad / pi)
        return false;
    Wedge turned;
    turn(&turned, b);
    *swap = v3_dot(a->frame.z, b->frame.z) < 0;
    const WedgeFrame *g = *swap ? &turned.frame : &b->frame;
    return v3_dot(a->frame.z, g->z) > cos(same_rad) && v3_dot(a->frame.x, g->x) > cos(same_rad);
}

typedef struct End {
    int place, piece;
} End;

static int end_order(const void *a, const void *b)
{
    const End *s = a, *t = b;
    if (s->place != t->place) return s->place < t->place ? -1 : 1;
    return (s->piece > t->piece) - (s->piece < t->piece);
}

/* Joins pieces in place; end: sorted, two a piece; used: zeroes. Returns how many are left. */
static int join(Found *f, const End *end, bool *used)
{
    int kept = 0;
    for (int i = 0; i < f->count; i++) {
        if (used[i]) continue;
        used[i] = true;
        Wedge       whole = f->wedge[i];
        const Wedge first = whole; /* what others are compared with, so that no bend adds up */
        for (int tip = 0; tip < 2; tip++) {
            int place = f->end[i][tip];
            for (bool more = true; more;) {
                more = false;
                int low = 0, high = 2 * f->count;
                while (low < high) {
                    const int middle = low + (high - low) / 2;
                    if (end[middle].place < place) low = middle + 1;
                    else high = middle;
                }
                for (int k = low; k < 2 * f->count && end[k].place == place && !more; k++) {
                    const int j = end[k].piece;
                    bool      swap;
                    if (used[j] || !continues(&swap, &first, &f->wedge[j])) continue;
                    if (f->end[j][!tip != swap] != place) continue;
                    used[j] = more = true;
                    place = f->end[j][tip != swap];
                    memcpy(whole.p[tip], f->wedge[j].p[tip != swap], sizeof whole.p[tip]);
                }
            }
        }
        WedgeFrame *g = &whole.frame;
        v3_sub(g->z, whole.p[1], whole.p[0]);
        v3_normalize(g->z, g->z);
        v3_add_scaled(g->x, g->x, -v3_dot(g->x, g->z), g->z);
        v3_normalize(g->x, g->x);
        v3_cross(g->y, g->z, g->x);
        f->wedge[kept++] = whole; /* kept <= i: not read again */
    }
    return kept;
}

Status wedges_find(WedgeList *out, const Model *model, const WedgeConfig *config)
{
    assert(config->weld_m > 0);
    const size_t most = 3 * (size_t)model->triangle_count + 1;
    Status       status = STATUS_NO_MEMORY;
    Found        found = {.model = model, .angle_rad = config->angle_rad};
    int         *place = malloc((size_t)model->vertex_count * sizeof *place + 1);
    Side        *side = malloc(most * sizeof *side);
    const Side **pool = malloc(most * sizeof *pool);
    bool        *open = calloc((size_t)model->part_count + 1, sizeof *open), *used = calloc(most, sizeof *used);
    End         *end = malloc(2 * most * sizeof *end);
    found.wedge = malloc(most * sizeof *found.wedge);
    found.end = malloc(most * sizeof *found.end);
    found.open = open;
    if (!place || !side || !pool || !open || !used || !end || !found.wedge || !found.end) goto done;
    status = wedges_weld(place, model, config->weld_m);
    if (status != STATUS_OK) goto done;

    find_pieces(&found, side, find_sides(side, model, place), open, pool);
    for (int i = 0; i < found.count; i++)
        for (int k = 0; k < 2; k++) end[2 * i + k] = (End){found.end[i][k], i};
    qsort(end, 2 * (size_t)found.count, sizeof *end, end_order);
    const int count = join(&found, end, used);

    Wedge *fitting = realloc(found.wedge, ((size_t)count + 1) * sizeof *fitting);
    if (fitting) found.wedge = fitting;
    *out = (WedgeList){.count = count, .wedge = found.wedge, .concave = found.concave, .junctions = found.junctions};
    found.wedge = NULL;

done:
    free(place);
    free(side);
    free(pool);
    free(open);
    free(used);
    free(end);
    free(found.wedge);
    free(found.end);
    return status;
}

void wedges_destroy(WedgeList *list)
{
    free(list->wedge);
    memset(list, 0, sizeof *list);
}

void wedges_place(Wedge *out, const WedgeList *list, const NodePose *pose, const double origin_body[3])
{
    for (int i = 0; i < list->count; i++) {
        const Wedge    *w = &list->wedge[i];
        const NodePose *at = &pose[w->node];
        out[i] = *w;
        m3_mul_v3(out[i].frame.x, at->r_body_from_node, w->frame.x);
        m3_mul_v3(out[i].frame.y, at->r_body_from_node, w->frame.y);
        m3_mul_v3(out[i].frame.z, at->r_body_from_node, w->frame.z);
        for (int k = 0; k < 2; k++) {
            m3_mul_v3(out[i].p[k], at->r_body_from_node, w->p[k]);
            v3_add(out[i].p[k], out[i].p[k], at->p_body);
            v3_sub(out[i].p[k], out[i].p[k], origin_body);
        }
    }
}
