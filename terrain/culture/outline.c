/* terrain/culture/outline.c: the boundary of a patch of cells, cut into walls, each a line fitted to it. */
#include "terrain/culture/outline.h"

#include <stdlib.h>

/* ---- the boundary, along the sides of cells --------------------------------------------------------- */

/* Follows it counter-clockwise, the patch on the left. Returns the number of corners of cells that it passes; 0: too
 * many. */
static int follow(int32_t (*step)[2], int most, const int32_t *of, int nx, int ny, int32_t number, size_t first)
{
    static const int go[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}}; /* east, north, west, south */
    /* the cells to the right and to the left of a step from a corner, by its direction */
    static const int right[4][2] = {{0, -1}, {0, 0}, {-1, 0}, {-1, -1}},
                     left[4][2] = {{0, 0}, {-1, 0}, {-1, -1}, {0, -1}};
    const int x0 = (int)(first % (size_t)nx), y0 = (int)(first / (size_t)nx);
    int       x = x0, y = y0, way = 0, count = 0;
    do {
        if (count == most) return 0;
        step[count][0] = x, step[count][1] = y, count++;
        x += go[way][0], y += go[way][1];
        /* left where it can, so that cells which touch at a corner alone are apart; never back */
        for (int turn = 1; turn >= -1; turn--) {
            const int  next = (way + turn + 4) % 4;
            const int  lx = x + left[next][0], ly = y + left[next][1], rx = x + right[next][0], ry = y + right[next][1];
            const bool in =
                lx >= 0 && ly >= 0 && lx < nx && ly < ny && of[(size_t)ly * (size_t)nx + (size_t)lx] == number;
            const bool out =
                rx < 0 || ry < 0 || rx >= nx || ry >= ny || of[(size_t)ry * (size_t)nx + (size_t)rx] != number;
            if (!in || !out) continue;
            way = next;
            break;
        }
    } while (x != x0 || y != y0 || way != 0);
    return count;
}

/* ---- cut into pieces (Douglas and Peucker 1973) ------------------------------------------------------- */

typedef struct Boundary {
    const int32_t (*step)[2];
    int   count;
    bool *is_corner;
} Boundary;

static void cut(Boundary *b, int from, int to, double tolerance)
{
    int stack[64][2], depth = 0;
    stack[depth][0] = from, stack[depth++][1] = to;
    while (depth > 0) {
        const int      first = stack[--depth][0], last = stack[depth][1];
        const int32_t *a = b->step[first % b->count], *c = b->step[last % b->count];
        const double   dx = c[0] - a[0], dy = c[1] - a[1], length = hypot(dx, dy);
        double         most = 0;
        int            at = -1;
        for (int k = first + 1; k < last; k++) {
            const int32_t *p = b->step[k % b->count];
            const double   px = p[0] - a[0], py = p[1] - a[1];
            const double   off = length > 0 ? fabs(px * dy - py * dx) / length : hypot(px, py);
            if (off > most) most = off, at = k;
        }
        if (at < 0 || most <= tolerance) continue;
        b->is_corner[at % b->count] = true;
        if (depth + 2 > 64) continue; /* a spiral: coarser there */
        stack[depth][0] = first, stack[depth++][1] = at;
        stack[depth][0] = at, stack[depth++][1] = last;
    }
}

/* ---- walls ---------------------------------------------------------------------------------------------- */

/* A wall: points with unit normal n at n . p = offset. Its part of the boundary goes from step first to that of the
 * next wall in the ring. */
typedef struct Wall {
    int    first;
    int    kind; /* 0 along, 1 across, 2 neither */
    double n[2], offset, length;
} Wall;

typedef struct Walls {
    const Boundary *boundary;
    double          along_rad;
    int             count;
    Wall           *wall;
} Walls;

static Wall *wall_at(const Walls *w, int k) { return &w->wall[(k + w->count) % w->count]; }

/* A surface model has the highest return of a cell, so that cells which a roof only touches are roof: half a cell
 * on each side if every place had a return, less with few of them. */
static const double touched = 0.3;

/* Fits a line to the middles of the boundary's sides of a wall; one of kind 0 or 1 has its direction already. Returns
 * the direction that it would have by itself. */
static double fit_wall(const Walls *walls, int k)
{
    const Boundary *b = walls->boundary;
    Wall           *w = wall_at(walls, k);
    const int       steps = (wall_at(walls, k + 1)->first - w->first + b->count) % b->count;
    double          n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
    for (int i = w->first; i < w->first + steps; i++) {
        const int32_t *p = b->step[i % b->count], *q = b->step[(i + 1) % b->count];
        const double   x = 0.5 * (p[0] + q[0]), y = 0.5 * (p[1] + q[1]);
        n++, sx += x, sy += y, sxx += x * x, sxy += x * y, syy += y * y;
    }
    const int32_t *p = b->step[w->first], *q = b->step[(w->first + steps) % b->count];
    double         angle = walls->along_rad + (w->kind == 1 ? 0.5 * pi_rad : 0);
    w->length = hypot(q[0] - p[0], q[1] - p[1]);
    const double own = 0.5 * atan2(2 * (sxy - sx * sy / n), (sxx - sx * sx / n) - (syy - sy * sy / n));
    if (w->kind == 2) angle = own;
    w->n[0] = -sin(angle), w->n[1] = cos(angle);
    w->offset = n > 0 ? (w->n[0] * sx + w->n[1] * sy) / n : 0;
    w->offset += (w->n[1] * (q[0] - p[0]) - w->n[0] * (q[1] - p[1]) > 0 ? 1 : -1) * touched; /* inwards: to the left */
    return own;
}

static const double parallel = 0.17; /* sine of 10 degrees */

static double turn_between(const Wall *a, const Wall *b) { return fabs(a->n[0] * b->n[1] - a->n[1] * b->n[0]); }

static bool meet(double out[2], const Wall *a, const Wall *b)
{
    const double det = a->n[0] * b->n[1] - a->n[1] * b->n[0];
    if (fabs(det) < parallel) return false;
    out[0] = (a->offset * b->n[1] - b->offset * a->n[1]) / det;
    out[1] = (a->n[0] * b->offset - b->n[0] * a->offset) / det;
    return true;
}

static void drop_wall(Walls *walls, int k)
{
    k = (k + walls->count) % walls->count;
    memmove(walls->wall + k, walls->wall + k + 1, (size_t)(walls->count - k - 1) * sizeof *walls->wall);
    walls->count--;
}

/* Joins a wall with the next where both have one direction. */
static bool join_neighbours(Walls *walls)
{
    for (int k = 0; k < walls->count && walls->count > 3; k++) {
        Wall *a = wall_at(walls, k), *next = wall_at(walls, k + 1);
        if (turn_between(a, next) >= parallel) continue;
        const int kind = next->length > a->length ? next->kind : a->kind;
        a->kind = kind;
        drop_wall(walls, k + 1);
        fit_wall(walls, k < walls->count ? k : k - 1);
        return true;
    }
    return false;
}

/* Drops the shortest wall where it is shorter than a cell and a half: its boundary goes to the longer neighbour. */
static bool drop_shortest(Walls *walls)
{
    static const double least = 1.5;
    int                 k = 0;
    if (walls->count <= 4) return false;
    for (int i = 1; i < walls->count; i++)
        if (walls->wall[i].length < walls->wall[k].length) k = i;
    if (walls->wall[k].length >= least) return false;
    if (wall_at(walls, k - 1)->length < wall_at(walls, k + 1)->length)
        wall_at(walls, k + 1)->first = walls->wall[k].first;
    drop_wall(walls, k);
    for (int i = 0; i < walls->count; i++) fit_wall(walls, i);
    return true;
}

/* The common direction again, by lines through the walls that have it: the longest tell it best. */
static void refine_direction(Walls *walls)
{
    double c4 = 0, s4 = 0;
    for (int k = 0; k < walls->count; k++) {
        const double angle = fit_wall(walls, k), length = wall_at(walls, k)->length;
        if (wall_at(walls, k)->kind == 2) continue;
        c4 += length * length * length * cos(4 * angle), s4 += length * length * length * sin(4 * angle);
    }
    if (!(hypot(c4, s4) > 0)) return;
    const double turn = atan2(s4, c4) - 4 * walls->along_rad;
    walls->along_rad += atan2(sin(turn), cos(turn)) / 4;
    for (int k = 0; k < walls->count; k++) fit_wall(walls, k);
}

static int corners_of_walls(double (*corner)[2], const Walls *walls)
{
    for (int k = 0; k < walls->count; k++)
        if (!meet(corner[k], wall_at(walls, k), wall_at(walls, k + 1))) return 0;
    return walls->count;
}

/* The direction that most of the boundary has, up to right angles. */
static void find_direction(Outline *out, const Boundary *b, const int *corner, int corners)
{
    double c4 = 0, s4 = 0, along = 0, all = 0;
    for (int k = 0; k < corners; k++) {
        const int32_t *p = b->step[corner[k] % b->count], *q = b->step[corner[(k + 1) % corners] % b->count];
        const double   length = hypot(q[0] - p[0], q[1] - p[1]), angle = atan2(q[1] - p[1], q[0] - p[0]);
        c4 += length * length * cos(4 * angle), s4 += length * length * sin(4 * angle);
    }
    out->along_rad = atan2(s4, c4) / 4;
    for (int k = 0; k < corners; k++) {
        const int32_t *p = b->step[corner[k] % b->count], *q = b->step[corner[(k + 1) % corners] % b->count];
        const double   length = hypot(q[0] - p[0], q[1] - p[1]);
        const double   angle = atan2(q[1] - p[1], q[0] - p[0]) - out->along_rad;
        all += length;
        if (cos(4 * angle) > 0.2) along += length; /* within 20 degrees */
    }
    if (out->along_rad < 0) out->along_rad += 0.5 * pi_rad;
    out->straight = all > 0 ? along / all : 0;
}

static int kind_of(const Outline *o, const Boundary *b, int first, int last)
{
    static const double mostly = 0.75;
    const int32_t      *p = b->step[first % b->count], *q = b->step[last % b->count];
    const double angle = atan2(q[1] - p[1], q[0] - p[0]) - o->along_rad, length = hypot(q[0] - p[0], q[1] - p[1]);
    if (o->straight < mostly) return 2;
    if (length > 6 && cos(4 * angle) < -0.2) return 2; /* a long wall aslant */
    return fabs(cos(angle)) >= fabs(sin(angle)) ? 0 : 1;
}

static bool take_walls(Outline *out, const Boundary *b, const int *corner, int corners, double cells)
{
    static const double most_off = 0.2; /* of the area */
    Walls               walls = {.boundary = b, .along_rad = out->along_rad, .count = corners};
    walls.wall = calloc((size_t)corners, sizeof *walls.wall);
    if (!walls.wall) return false;
    for (int k = 0; k < corners; k++) {
        walls.wall[k].first = corner[k];
        walls.wall[k].kind = kind_of(out, b, corner[k], corner[(k + 1) % corners]);
    }
    for (int k = 0; k < corners; k++) fit_wall(&walls, k);
    while (join_neighbours(&walls) || drop_shortest(&walls)) {
    }
    refine_direction(&walls);
    out->along_rad = walls.along_rad;
    out->corners = corners_of_walls(out->corner, &walls);
    free(walls.wall);
    return out->corners >= 3 &&
           fabs(culture_area_m2((const double(*)[2])out->corner, out->corners) / cells - 1) < most_off;
}

bool outline_of_cells(Outline *out, const int32_t *of, int nx, int ny, int32_t number, size_t first)
{
    static const double tolerance = 1.2; /* cells: the steps of a slanting wall are 0.7 off it */
    int32_t(*step)[2] = malloc(outline_most_steps * sizeof *step);
    int     *corner = malloc(culture_outline_most * sizeof *corner), corners = 0, far = 0;
    bool     good = false;
    Boundary b = {.step = (const int32_t(*)[2])step};
    *out = (Outline){0};
    if (!step || !corner) goto done;
    b.count = follow(step, outline_most_steps, of, nx, ny, number, first);
    if (b.count < 4 || !(b.is_corner = calloc((size_t)b.count, sizeof *b.is_corner))) goto done;
    for (int k = 1; k < b.count; k++)
        if (hypot(step[k][0] - step[0][0], step[k][1] - step[0][1]) >
            hypot(step[far][0] - step[0][0], step[far][1] - step[0][1]))
            far = k;
    int start = 0; /* the farthest from that one: both are corners for sure */
    for (int k = 0; k < b.count; k++)
        if (hypot(step[k][0] - step[far][0], step[k][1] - step[far][1]) >
            hypot(step[start][0] - step[far][0], step[start][1] - step[far][1]))
            start = k;
    b.is_corner[start] = b.is_corner[far] = true;
    cut(&b, start < far ? start : far, start < far ? far : start, tolerance);
    cut(&b, start < far ? far : start, (start < far ? start : far) + b.count, tolerance);
    for (int k = 0; k < b.count; k++)
        if (b.is_corner[k] && corners < culture_outline_most) corner[corners++] = k;
    if (corners < 3) goto done;
    double cells = 0;
    for (int k = 0; k < b.count; k++)
        cells +=
            0.5 * (step[k][0] * (double)step[(k + 1) % b.count][1] - step[(k + 1) % b.count][0] * (double)step[k][1]);
    find_direction(out, &b, corner, corners);
    good = take_walls(out, &b, corner, corners, cells);
    if (!good) { /* the corners as they are */
        for (int k = 0; k < corners; k++)
            for (int c = 0; c < 2; c++) out->corner[k][c] = step[corner[k]][c];
        out->corners = corners;
        good = culture_area_m2((const double(*)[2])out->corner, corners) > 0.5 * cells;
    }
done:
    free(step), free(corner), free(b.is_corner);
    return good;
}
