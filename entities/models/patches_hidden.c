/* entities/models/patches_hidden.c: how much of each triangle lies inside the model, where nothing outside meets it.
 *
 * A point just before a triangle is inside when every line through it leaves more closed surfaces ahead than it
 * enters: the winding number, counted by the signs of its crossings, both ways along three lines. One way from which
 * the count is not positive, as through the open side of a shell, and the point is outside. Before a cavity of
 * closed walls the count is 0: its faces are outside too.
 *
 * Of faces at one place that look the same way, as of boxes flush with one another, the first in the model is
 * outside.
 *
 * Parts of another node hide a face where it is inside them at each of eight values of the joint between the two: a
 * turret's floor in the hull, and what of the roof it always covers. Parts that are two joints apart hide nothing of
 * each other, nor do parts that damage takes away.
 *
 * Lines are parallel to the axes of one turned frame, so that each is a cell of a grid of the triangles as they are
 * projected along it, and no plane of a model lies along one. A line is of both ways at once. Points are spread over
 * a triangle by Roberts's R2 sequence, more over large ones; it goes on from one triangle to the next, so that
 * errors of like ones cancel. */
#include "entities/models/patches_private.h"

#include <stdlib.h>

enum { hinge_values = 8, cells_least = 4, cells_side_most = 256, points_of_triangle = 400 };
static const double leave_m =
    2e-3; /* a tested point is this far in front of its triangle, which is more than the gaps between welded faces */
static const double points_of_model =
    5000; /* tested points on the model, distributed by area, besides one on each triangle */
static const double entries_most = 64; /* most entries of cells for each triangle; with more the grid is made coarser */
static const double tests_most =
    2e8; /* most tests of lines against triangles, some 3 s; after that nothing more counts as hidden */

/* A triangle at rest, in the turned frame. */
typedef struct Solid {
    double q[3][3];
    int    group; /* group of parts; -1: the triangle hides nothing */
} Solid;

typedef struct Grid {
    int     side; /* cells along u and along v */
    double  low[2], per_m[2];
    size_t *first; /* [side * side + 1] */
    int    *triangle;
} Grid;

/* A joint between a carrying and a moved group, in the turned frame. */
typedef struct Hinge {
    int    group, carrier;
    bool   slides;
    double pivot[3], axis[3], reach_m; /* reach_m: how far the moved group extends from the pivot */
    int    values;
    double value[hinge_values];
} Hinge;

struct Hidden {
    const Model *model;
    int         *group; /* [node_count] the node that carries it without a joint in between */
    double       turn[9];
    int          hinges;
    Hinge       *hinge; /* [node_count] */
    Solid       *solid; /* [triangle_count] */
    float       *open;  /* [triangle_count] */
    Grid         grid[3];
    double       tests, points; /* tests and points so far */
};

/* As fmin and fmax for finite numbers; those compile to calls. */
static double lesser(double a, double b) { return a < b ? a : b; }
static double larger(double a, double b) { return a > b ? a : b; }

/* ---- the grids -------------------------------------------------------------------------------- */

static void find_groups(Hidden *h)
{
    for (int n = 0; n < h->model->node_count; n++) {
        const ModelNode *node = &h->model->node[n];
        h->group[n] = node->parent >= 0 && node->joint == JOINT_FIXED ? h->group[node->parent] : n;
    }
}

/* A frame whose axes are in no plane that models have. */
static void find_turn(double turn[9])
{
    static const double first[3] = {0.8391, 0.4472, -0.3097}, second[3] = {-0.5257, 0.7673, -0.2113};
    v3_normalize(turn, first);
    v3_add_scaled(turn + 3, second, -v3_dot(second, turn), turn);
    v3_normalize(turn + 3, turn + 3);
    v3_cross(turn + 6, turn, turn + 3);
}

static void place_solids(Hidden *h, const NodePose *pose)
{
    const Model *m = h->model;
    for (int t = 0; t < m->triangle_count; t++) {
        const ModelPart *part = &m->part[m->triangle_part[t]];
        for (int k = 0; k < 3; k++) {
            double p_body[3];
            m3_mul_v3(p_body, pose[part->node].r_body_from_node, m->vertex[m->triangle[t][k]]);
            v3_add(p_body, p_body, pose[part->node].p_body);
            m3_mul_v3(h->solid[t].q[k], h->turn, p_body);
        }
        h->solid[t].group = part->damage_hidden ? -1 : h->group[part->node];
    }
}

static int cell_of(const Grid *g, int k, double at)
{
    const double cell = (at - g->low[k]) * g->per_m[k];
    return cell > 0 ? cell < g->side ? (int)cell : g->side - 1 : 0;
}

/* Finds the joints, and the poses in which a point must be inside to count as hidden: every 45 degrees of a free joint,
 * else over its range. */
static void find_hinges(Hidden *h, const NodePose *pose)
{
    const Model *m = h->model;
    for (int n = 0; n < m->node_count; n++) {
        const ModelNode *node = &m->node[n];
        Hinge           *hinge = &h->hinge[h->hinges];
        double           axis_body[3];
        if (h->group[n] != n || node->parent < 0) continue;
        const bool ranges = node->low <= node->high && node->high - node->low < 2 * pi_rad;
        *hinge = (Hinge){.group = n,
                         .carrier = h->group[node->parent],
                         .slides = node->joint == JOINT_TRANSLATION,
                         .values = hinge_values};
        if (hinge->slides && !(node->low <= node->high)) continue; /* anywhere */
        for (int k = 0; k < hinge_values; k++)
            hinge->value[k] = ranges || hinge->slides ? node->low + (node->high - node->low) * k / (hinge_values - 1)
                                                      : 2 * pi_rad * k / hinge_values;
        m3_mul_v3(hinge->pivot, h->turn, pose[n].p_body);
        m3_mul_v3(axis_body, pose[n].r_body_from_node, node->axis);
        m3_mul_v3(hinge->axis, h->turn, axis_body);
        for (int t = 0; t < m->triangle_count; t++)
            for (int k = 0; k < 3 && h->solid[t].group == n; k++) {
                double d[3];
                v3_sub(d, h->solid[t].q[k], hinge->pivot);
                hinge->reach_m = larger(hinge->reach_m, v3_length(d));
            }
        if (hinge->slides) hinge->reach_m += larger(fabs(node->low), fabs(node->high));
        h->hinges++;
    }
}

/* The first and the last row of cells that a triangle meets, seen along an axis. */
static void rows_of(int row[2], const Grid *g, const Solid *s, int axis)
{
    const int j = (axis + 2) % 3;
    row[0] = cell_of(g, 1, lesser(s->q[0][j], lesser(s->q[1][j], s->q[2][j])));
    row[1] = cell_of(g, 1, larger(s->q[0][j], larger(s->q[1][j], s->q[2][j])));
}

/* The first and the last cell of a row that a triangle meets: from its edges within the row, slightly widened. */
static void cells_of(int cell[2], const Grid *g, const Solid *s, int axis, int row)
{
    const int    i = (axis + 1) % 3, j = (axis + 2) % 3;
    const double tall = g->per_m[1] > 0 ? 1 / g->per_m[1] : INFINITY,
                 wide = g->per_m[0] > 0 ? 1 / g->per_m[0] : INFINITY;
    const double low = row > 0 ? g->low[1] + (row - 1e-6) * tall : -INFINITY,
                 high = row + 1 < g->side ? g->low[1] + (row + 1 + 1e-6) * tall : INFINITY;
    double from = INFINITY, to = -INFINITY;
    for (int k = 0; k < 3; k++) {
        const double *a = s->q[k], *b = s->q[(k + 1) % 3];
        if (larger(a[j], b[j]) < low || lesser(a[j], b[j]) > high) continue;
        for (int end = 0; end < 2; end++) {
            const double *here = end ? b : a, *other = end ? a : b;
            double        u = here[i];
            if (here[j] < low) u += (low - here[j]) / (other[j] - here[j]) * (other[i] - u);
            else if (here[j] > high) u += (high - here[j]) / (other[j] - here[j]) * (other[i] - u);
            from = lesser(from, u), to = larger(to, u);
        }
    }
    cell[0] = cell_of(g, 0, isfinite(wide) ? from - 1e-6 * wide : from);
    cell[1] = cell_of(g, 0, isfinite(wide) ? to + 1e-6 * wide : to);
}

/* Visits the triangles of each cell. It adds their number to first or, with `put`, stores them from the last to the
 * first below it. */
static double visit_cells(Grid *g, const Hidden *h, int axis, bool put)
{
    double entries = 0;
    for (int t = h->model->triangle_count - 1; t >= 0; t--) {
        int row[2], cell[2];
        rows_of(row, g, &h->solid[t], axis);
        for (int v = row[0]; v <= row[1]; v++) {
            cells_of(cell, g, &h->solid[t], axis, v);
            size_t *at = &g->first[(size_t)v * (size_t)g->side];
            entries += cell[1] - cell[0] + 1;
            for (int u = cell[0]; u <= cell[1] && !put; u++) at[u]++;
            for (int u = cell[0]; u <= cell[1] && put; u++) g->triangle[--at[u]] = t;
        }
    }
    return entries;
}

static Status fill_grid(Grid *g, const Hidden *h, int axis)
{
    const int triangles = h->model->triangle_count;
    double    low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, entries;
    for (int t = 0; t < triangles; t++)
        for (int c = 0; c < 6; c++) {
            const double at = h->solid[t].q[c / 2][(axis + 1 + c % 2) % 3];
            low[c % 2] = lesser(low[c % 2], at), high[c % 2] = larger(high[c % 2], at);
        }
    g->side = (int)clamp(0.6 * sqrt(triangles), cells_least, cells_side_most);
    g->first = malloc(((size_t)g->side * (size_t)g->side + 1) * sizeof *g->first);
    if (!g->first) return STATUS_NO_MEMORY;
    for (;; g->side /= 2) { /* one cell has each triangle once */
        memset(g->first, 0, ((size_t)g->side * (size_t)g->side + 1) * sizeof *g->first);
        for (int k = 0; k < 2; k++) {
            g->low[k] = low[k];
            g->per_m[k] = high[k] > low[k] ? g->side / (high[k] - low[k]) : 0;
        }
        entries = visit_cells(g, h, axis, false);
        if (entries <= entries_most * triangles) break;
    }
    g->triangle = malloc(((size_t)entries + 1) * sizeof *g->triangle);
    if (!g->triangle) return STATUS_NO_MEMORY;
    for (int c = 1; c <= g->side * g->side; c++) g->first[c] += g->first[c - 1];
    visit_cells(g, h, axis, true);
    return STATUS_OK;
}

/* ---- points ----------------------------------------------------------------------------------- */

/* Twice the signed areas that a point makes with the sides of a triangle, seen along an axis: of one sign inside,
 * positive where the normal is along the axis. */
static inline void shares_of(double *a, double *b, double *c, const Solid *s, int i, int j, const double q[3])
{
    const double u0 = s->q[0][i] - q[i], v0 = s->q[0][j] - q[j], u1 = s->q[1][i] - q[i], v1 = s->q[1][j] - q[j],
                 u2 = s->q[2][i] - q[i], v2 = s->q[2][j] - q[j];
    *a = u1 * v2 - u2 * v1, *b = u2 * v0 - u0 * v2, *c = u0 * v1 - u1 * v0;
}

/* Whether a line along an axis leaves more surfaces of the group than it enters, both ways. */
static bool is_within(Hidden *h, int axis, const double q[3], int group)
{
    const Grid  *g = &h->grid[axis];
    const int    i = (axis + 1) % 3, j = (axis + 2) % 3;
    const size_t cell = (size_t)cell_of(g, 1, q[j]) * (size_t)g->side + (size_t)cell_of(g, 0, q[i]);
    int          out[2] = {0, 0};
    h->tests += (double)(g->first[cell + 1] - g->first[cell]);
    for (size_t e = g->first[cell]; e < g->first[cell + 1]; e++) {
        const Solid *s = &h->solid[g->triangle[e]];
        double       a, b, c;
        shares_of(&a, &b, &c, s, i, j, q);
        const int positive = (a > 0) + (b > 0) + (c > 0), negative = (a < 0) + (b < 0) + (c < 0);
        /* one branch for all cases that count nothing: beside the triangle, seen edge on, of another group */
        if (((positive > 0) & (negative > 0)) | (positive + negative == 0) | (s->group != group)) continue;
        const double at = (a * s->q[0][axis] + b * s->q[1][axis] + c * s->q[2][axis]) / (a + b + c);
        /* counter-clockwise: its normal is along the axis */
        if (at > q[axis]) out[0] += positive > 0 ? 1 : -1;
        else out[1] += positive > 0 ? -1 : 1;
    }
    return out[0] > 0 && out[1] > 0;
}

static bool is_inside(Hidden *h, const double q[3], int group)
{
    return is_within(h, 0, q, group) && is_within(h, 1, q, group) && is_within(h, 2, q, group);
}

/* The place of a point of the moved group at a value of its joint. */
static void moved(double out[3], const Hinge *hinge, const double q[3], double value)
{
    double d[3], side[3];
    v3_sub(d, q, hinge->pivot);
    if (hinge->slides) {
        v3_add_scaled(out, q, value, hinge->axis);
        return;
    }
    v3_cross(side, hinge->axis, d);
    v3_scale(out, cos(value), d);
    v3_add_scaled(out, out, sin(value), side);
    v3_add_scaled(out, out, (1 - cos(value)) * v3_dot(hinge->axis, d), hinge->axis);
    v3_add(out, out, hinge->pivot);
}

/* Whether a point before a face of a group is inside that group, or at every value of a joint inside what carries it
 * or what it carries. */
static bool is_covered(Hidden *h, const double q[3], int group)
{
    if (is_inside(h, q, group)) return true;
    for (int j = 0; j < h->hinges; j++) {
        const Hinge *hinge = &h->hinge[j];
        double       d[3];
        if (hinge->group != group && hinge->carrier != group) continue;
        v3_sub(d, q, hinge->pivot);
        if (hinge->carrier == group && v3_dot(d, d) > hinge->reach_m * hinge->reach_m) continue;
        int k = 0;
        for (; k < hinge->values; k++) {
            double there[3];
            moved(there, hinge, q, hinge->group == group ? hinge->value[k] : -hinge->value[k]);
            if (!is_inside(h, there, hinge->group == group ? hinge->carrier : hinge->group)) break;
        }
        if (k == hinge->values) return true;
    }
    return false;
}

bool hidden_at(Hidden *h, int triangle, const double p_body[3], const double n_body[3])
{
    const int group = h->group[h->model->part[h->model->triangle_part[triangle]].node];
    double    before[3], q[3];
    v3_add_scaled(before, p_body, leave_m, n_body);
    m3_mul_v3(q, h->turn, before);
    return is_covered(h, q, group);
}

/* Whether an earlier triangle of the model has the same place and side there: of equal ones only the first is seen. */
static bool is_double(const Hidden *h, int axis, const double q[3], int t, int group, double n_axis)
{
    static const double same_m = 1e-6;
    const Grid         *g = &h->grid[axis];
    const int           i = (axis + 1) % 3, j = (axis + 2) % 3;
    const size_t        cell = (size_t)cell_of(g, 1, q[j]) * (size_t)g->side + (size_t)cell_of(g, 0, q[i]);
    for (size_t e = g->first[cell]; e < g->first[cell + 1] && g->triangle[e] < t; e++) { /* ascending */
        const Solid *s = &h->solid[g->triangle[e]];
        double       a, b, c;
        shares_of(&a, &b, &c, s, i, j, q);
        if (s->group != group || !(n_axis > 0 ? a > 0 && b > 0 && c > 0 : a < 0 && b < 0 && c < 0)) continue;
        const double at = (a * s->q[0][axis] + b * s->q[1][axis] + c * s->q[2][axis]) / (a + b + c);
        if (fabs(at - q[axis]) < same_m) return true;
    }
    return false;
}

static double normal_of(double n[3], const Solid *s)
{
    double one[3], other[3];
    v3_sub(one, s->q[1], s->q[0]);
    v3_sub(other, s->q[2], s->q[0]);
    v3_cross(n, one, other);
    const double twice = v3_length(n);
    return v3_normalize(n, n) ? 0.5 * twice : 0;
}

static float open_share(Hidden *h, int t, double all_m2)
{
    static const double r2[2] = {0.7548776662466927, 0.5698402909980532}, shrink = 0.02;
    const Solid        *s = &h->solid[t];
    const int           group = h->group[h->model->part[h->model->triangle_part[t]].node];
    double              n[3];
    const double        area_m2 = normal_of(n, s);
    int                 hidden = 0;
    if (!(area_m2 > 0)) return 1;
    const int steep = fabs(n[0]) > fabs(n[1]) ? fabs(n[0]) > fabs(n[2]) ? 0 : 2 : fabs(n[1]) > fabs(n[2]) ? 1 : 2;
    const int points = 1 + (int)lesser(points_of_model * area_m2 / all_m2, points_of_triangle - 1);
    for (int k = 0; k < points; k++) {
        double u = fmod(0.5 + h->points * r2[0], 1), v = fmod(0.5 + h->points * r2[1], 1), q[3];
        h->points++;
        if (u + v > 1) u = 1 - u, v = 1 - v;
        u += shrink * (1.0 / 3 - u), v += shrink * (1.0 / 3 - v); /* moves the point off the triangle's edges */
        for (int i = 0; i < 3; i++) q[i] = s->q[0][i] + u * (s->q[1][i] - s->q[0][i]) + v * (s->q[2][i] - s->q[0][i]);
        const bool twice = is_double(h, steep, q, t, group, n[steep]);
        v3_add_scaled(q, q, leave_m, n);
        hidden += twice || is_covered(h, q, group);
    }
    return 1 - (float)hidden / (float)points;
}

static void find_open(Hidden *h)
{
    const int triangles = h->model->triangle_count;
    double    all_m2 = 0, n[3];
    for (int t = 0; t < triangles; t++) all_m2 += normal_of(n, &h->solid[t]);
    for (int t = 0; t < triangles; t++) {
        h->open[t] = open_share(h, t, all_m2);
        if (!(h->tests > tests_most)) continue;
        log_warn(
            "model: too many triangles behind one another to find those inside it, so that all count as its surface: "
            "model=%s triangles=%d",
            h->model->name, triangles);
        for (int k = 0; k < triangles; k++) h->open[k] = 1;
        return;
    }
}

double hidden_open(const Hidden *h, int triangle) { return (double)h->open[triangle]; }

/* ---- creation --------------------------------------------------------------------------------- */

Status hidden_create(Hidden **out, const Model *model, const NodePose *pose)
{
    Hidden *h = calloc(1, sizeof *h);
    if (!h) return STATUS_NO_MEMORY;
    const size_t triangles = (size_t)model->triangle_count + 1;
    h->model = model;
    h->group = calloc((size_t)model->node_count + 1, sizeof *h->group);
    h->solid = calloc(triangles, sizeof *h->solid);
    h->open = calloc(triangles, sizeof *h->open);
    h->hinge = calloc((size_t)model->node_count + 1, sizeof *h->hinge);
    Status status = h->group && h->hinge && h->solid && h->open ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        find_groups(h);
        find_turn(h->turn);
        place_solids(h, pose);
        find_hinges(h, pose);
    }
    for (int axis = 0; axis < 3 && status == STATUS_OK; axis++) status = fill_grid(&h->grid[axis], h, axis);
    if (status != STATUS_OK) {
        hidden_destroy(h);
        return status;
    }
    find_open(h);
    *out = h;
    return STATUS_OK;
}

void hidden_destroy(Hidden *h)
{
    if (!h) return;
    for (int axis = 0; axis < 3; axis++) {
        free(h->grid[axis].first);
        free(h->grid[axis].triangle);
    }
    free(h->group);
    free(h->hinge);
    free(h->solid);
    free(h->open);
    free(h);
}
