/* terrain/culture/culture_invented_ground.c: where something may stand: clear of what was reported, of ways and water,
 * of slopes, and of what stands already. */
#include "terrain/culture/culture_invented_private.h"

#include <stdlib.h>

/* ---- rectangles ---------------------------------------------------------------------------------- */

Rectangle rectangle_within(const Rectangle *r, double along_m, double left_m, double half_along_m, double half_left_m)
{
    Rectangle out = *r;
    double    p[2];
    rectangle_at(p, r, along_m, left_m);
    out.x_m = p[0], out.y_m = p[1], out.half_m[0] = half_along_m, out.half_m[1] = half_left_m;
    return out;
}

Rectangle rectangle_grown(const Rectangle *r, double by_m)
{
    Rectangle out = *r;
    out.half_m[0] += by_m, out.half_m[1] += by_m;
    return out;
}

void rectangle_corners(double corner_m[4][2], const Rectangle *r)
{
    static const double sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int k = 0; k < 4; k++) rectangle_at(corner_m[k], r, sign[k][0] * r->half_m[0], sign[k][1] * r->half_m[1]);
}

/* Separating axes: the four sides' directions. */
bool rectangles_meet(const Rectangle *a, const Rectangle *b)
{
    static const double touch_m = 1e-6;
    const double        dx = b->x_m - a->x_m, dy = b->y_m - a->y_m;
    const double        c = fabs(a->along[0] * b->along[0] + a->along[1] * b->along[1]);
    const double        s = fabs(a->along[0] * b->along[1] - a->along[1] * b->along[0]);
    const Rectangle    *of[2] = {a, b};
    for (int k = 0; k < 2; k++) {
        const Rectangle *own = of[k], *other = of[1 - k];
        const double     along = fabs(dx * own->along[0] + dy * own->along[1]);
        const double     left = fabs(dy * own->along[0] - dx * own->along[1]);
        if (along > own->half_m[0] + c * other->half_m[0] + s * other->half_m[1] - touch_m) return false;
        if (left > own->half_m[1] + s * other->half_m[0] + c * other->half_m[1] - touch_m) return false;
    }
    return true;
}

/* Half sides of the box about a rectangle. */
static void box_half(double half_m[2], const Rectangle *r)
{
    half_m[0] = fabs(r->along[0]) * r->half_m[0] + fabs(r->along[1]) * r->half_m[1];
    half_m[1] = fabs(r->along[1]) * r->half_m[0] + fabs(r->along[0]) * r->half_m[1];
}

/* ---- grids --------------------------------------------------------------------------------------- */

static GroundGrid grid_of(const Inventor *v, double cell_m)
{
    const double longest_m = fmax(v->side_m[0], v->side_m[1]);
    GroundGrid   g = {.cell_m = fmax(cell_m, longest_m / 4000)};
    g.nx = (int)(v->side_m[0] / g.cell_m) + 1, g.ny = (int)(v->side_m[1] / g.cell_m) + 1;
    return g;
}

static size_t cells_of(const GroundGrid *g) { return (size_t)g->nx * (size_t)g->ny; }

typedef struct CellBox {
    int i0, i1, j0, j1;
} CellBox;

/* The cells that the box about a rectangle, grown by reach_m, meets; i1 < i0 or j1 < j0: none. */
static CellBox cells_about(const Inventor *v, const GroundGrid *g, const Rectangle *r, double reach_m)
{
    double half[2];
    box_half(half, r);
    const double x = r->x_m - v->x0_m, y = r->y_m - v->y0_m;
    return (CellBox){(int)clamp(floor((x - half[0] - reach_m) / g->cell_m), 0, g->nx),
                     (int)clamp(floor((x + half[0] + reach_m) / g->cell_m), -1, g->nx - 1),
                     (int)clamp(floor((y - half[1] - reach_m) / g->cell_m), 0, g->ny),
                     (int)clamp(floor((y + half[1] + reach_m) / g->cell_m), -1, g->ny - 1)};
}

/* The cell of a place; false: beyond the grid, or not finite. */
static bool cell_at(size_t *cell, const Inventor *v, const GroundGrid *g, double x_m, double y_m)
{
    const double i = floor((x_m - v->x0_m) / g->cell_m), j = floor((y_m - v->y0_m) / g->cell_m);
    if (!(i >= 0 && j >= 0 && i < g->nx && j < g->ny)) return false;
    *cell = (size_t)j * (size_t)g->nx + (size_t)i;
    return true;
}

/* ---- evidence ------------------------------------------------------------------------------------ */

/* Marks the squares of reports, and of the straight path between successive ones of the same source entity. */
static void mark_driven(Inventor *v)
{
    static const double longest_m = 400; /* a longer step says nothing of the way between */
    const GroundFix    *fix = v->landscape->fitted_to.fix;
    const double        step_m = 0.5 * v->driven_grid.cell_m;
    size_t              cell;
    for (int n = 0; n < v->landscape->fitted_to.fix_count; n++) {
        const double *b = fix[n].p_enu, *a = n > 0 ? fix[n - 1].p_enu : b;
        const double  length_m = hypot(b[0] - a[0], b[1] - a[1]);
        const bool    path = n > 0 && fix[n].voter > 0 && fix[n].voter == fix[n - 1].voter && length_m <= longest_m;
        const int     parts = path ? (int)ceil(length_m / step_m) : 0;
        for (int k = 0; k <= parts; k++) {
            const double t = parts ? (double)k / parts : 1;
            if (cell_at(&cell, v, &v->driven_grid, a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])))
                v->driven[cell] = 1;
        }
    }
}

/* Lowers the ceiling of the squares below each clear line. */
static void mark_lines(Inventor *v)
{
    const ClearLine *line = v->landscape->fitted_to.line;
    const double     step_m = 0.5 * v->line_grid.cell_m;
    for (int n = 0; n < v->landscape->fitted_to.line_count; n++) {
        const double *a = line[n].a_enu, *b = line[n].b_enu;
        double        t0 = 0, t1 = 1;
        if (!v3_is_finite(a) || !v3_is_finite(b)) continue;
        for (int k = 0; k < 2; k++) { /* the part over the grid */
            const double low = k ? v->y0_m : v->x0_m, high = low + v->side_m[k], d = b[k] - a[k];
            if (d == 0 && (a[k] < low || a[k] > high)) t1 = -1;
            if (d == 0) continue;
            t0 = fmax(t0, fmin((low - a[k]) / d, (high - a[k]) / d));
            t1 = fmin(t1, fmax((low - a[k]) / d, (high - a[k]) / d));
        }
        if (t0 > t1) continue;
        const double length_m = hypot(b[0] - a[0], b[1] - a[1]) * (t1 - t0);
        const int    parts = (int)fmin(ceil(length_m / step_m), 1 << 20) + 1;
        const double drop_m = fabs(b[2] - a[2]) * (t1 - t0) / parts; /* within one part */
        for (int k = 0; k <= parts; k++) {
            const double t = t0 + (t1 - t0) * k / parts;
            const float  low_m = (float)(a[2] + t * (b[2] - a[2]) - drop_m);
            size_t       cell;
            if (cell_at(&cell, v, &v->line_grid, a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])) &&
                low_m < v->ceiling_m[cell])
                v->ceiling_m[cell] = low_m;
        }
    }
}

static double beyond_m(const Rectangle *r, double x_m, double y_m)
{
    const double dx = x_m - r->x_m, dy = y_m - r->y_m;
    const double along = fabs(dx * r->along[0] + dy * r->along[1]) - r->half_m[0];
    const double left = fabs(dy * r->along[0] - dx * r->along[1]) - r->half_m[1];
    return hypot(fmax(along, 0), fmax(left, 0));
}

bool invent_is_clear(const Inventor *v, const Rectangle *r, double top_m)
{
    if (v->driven) {
        const GroundGrid *g = &v->driven_grid;
        const double      reach_m = culture_vehicle_m + 0.7072 * g->cell_m; /* from the middle of a square */
        const CellBox     c = cells_about(v, g, r, reach_m);
        for (int j = c.j0; j <= c.j1; j++)
            for (int i = c.i0; i <= c.i1; i++)
                if (v->driven[(size_t)j * (size_t)g->nx + (size_t)i] &&
                    beyond_m(r, v->x0_m + (i + 0.5) * g->cell_m, v->y0_m + (j + 0.5) * g->cell_m) <= reach_m)
                    return false;
    }
    if (v->ceiling_m) {
        const GroundGrid *g = &v->line_grid;
        const CellBox     c = cells_about(v, g, r, g->cell_m); /* a line may cut a corner between two of its marks */
        double            low_m, high_m, ceiling_m = INFINITY;
        for (int j = c.j0; j <= c.j1; j++)
            for (int i = c.i0; i <= c.i1; i++)
                ceiling_m = fmin(ceiling_m, (double)v->ceiling_m[(size_t)j * (size_t)g->nx + (size_t)i]);
        if (ceiling_m == INFINITY) return true;
        invent_ground_span(&low_m, &high_m, v, r);
        return high_m + top_m + culture_line_clearance_m <= ceiling_m;
    }
    return true;
}

/* ---- the ground ---------------------------------------------------------------------------------- */

double invent_height(const Inventor *v, double x_m, double y_m)
{
    return elevation_height(&v->landscape->elevation, x_m, y_m, NULL);
}

/* Along an edge the ground is straight between where it crosses the posts' rows, columns and diagonals. */
static void span_of_edge(double *low_m, double *high_m, const Inventor *v, const double a[2], const double b[2])
{
    const double spacing_m = v->landscape->elevation.level[0].spacing_m;
    const double from[3] = {a[0] - v->x0_m, a[1] - v->y0_m, a[0] - v->x0_m - a[1] + v->y0_m};
    const double end[3] = {b[0] - v->x0_m, b[1] - v->y0_m, b[0] - v->x0_m - b[1] + v->y0_m};
    for (int family = 0; family < 3; family++) {
        const double low = fmin(from[family], end[family]), high = fmax(from[family], end[family]);
        for (double m = ceil(low / spacing_m) * spacing_m; m <= high && high > low; m += spacing_m) {
            const double t = clamp((m - from[family]) / (end[family] - from[family]), 0, 1);
            const double z_m = invent_height(v, a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
            *low_m = fmin(*low_m, z_m), *high_m = fmax(*high_m, z_m);
        }
    }
    const double z_m = invent_height(v, a[0], a[1]);
    *low_m = fmin(*low_m, z_m), *high_m = fmax(*high_m, z_m);
}

void invent_ground_span(double *low_m, double *high_m, const Inventor *v, const Rectangle *r)
{
    double corner[4][2];
    rectangle_corners(corner, r);
    *low_m = INFINITY, *high_m = -INFINITY;
    for (int k = 0; k < 4; k++) span_of_edge(low_m, high_m, v, corner[k], corner[(k + 1) % 4]);
}

double invent_slope(const Inventor *v, const Rectangle *r)
{
    double corner[4][2], z[4];
    rectangle_corners(corner, r);
    for (int k = 0; k < 4; k++) z[k] = invent_height(v, corner[k][0], corner[k][1]);
    const double along = 0.25 * (z[1] + z[2] - z[0] - z[3]) / r->half_m[0];
    const double left = 0.25 * (z[2] + z[3] - z[0] - z[1]) / r->half_m[1];
    const double slope = hypot(along, left);
    return isfinite(slope) ? slope : INFINITY;
}

bool invent_is_dry(const Inventor *v, const Rectangle *r, double room_m)
{
    enum { most = 1024 };
    static const double step_m = 3, rim_m = 8;
    double              x[most] = {0}, y[most] = {0}, half[2];
    uint8_t             surface[most];
    const Rectangle     all = rectangle_grown(r, room_m);
    box_half(half, &all);
    if (all.x_m - half[0] < v->x0_m + rim_m || all.y_m - half[1] < v->y0_m + rim_m ||
        all.x_m + half[0] > v->x0_m + v->side_m[0] - rim_m || all.y_m + half[1] > v->y0_m + v->side_m[1] - rim_m)
        return false;
    const int nu = (int)clamp(ceil(2 * all.half_m[0] / step_m), 2, 31) + 1;
    const int nv = (int)clamp(ceil(2 * all.half_m[1] / step_m), 2, 31) + 1;
    /* half the diagonal between places, so that nothing narrow passes between them */
    const double gap_m = hypot(all.half_m[0] / (nu - 1), all.half_m[1] / (nv - 1));
    for (int k = 0; k < nu * nv; k++) {
        double   p[2];
        WayPlace way;
        rectangle_at(p, &all, all.half_m[0] * (2.0 * (k % nu) / (nu - 1) - 1),
                     all.half_m[1] * (2.0 * (k / nu) / (nv - 1) - 1));
        x[k] = p[0], y[k] = p[1];
        if (landscape_way(&way, v->landscape, p[0], p[1]) && fabs(way.across_m) < way.half_m + gap_m) return false;
    }
    landscape_surfaces(surface, v->landscape, nu * nv, x, y);
    for (int k = 0; k < nu * nv; k++)
        if (surface[k] == SURFACE_WATER || surface[k] == SURFACE_WETLAND || surface[k] == SURFACE_NONE) return false;
    return true;
}

/* ---- what stands --------------------------------------------------------------------------------- */

bool invent_is_taken(const Inventor *v, const Rectangle *r, int kinds, int owner)
{
    const GroundGrid *g = &v->taken_grid;
    const CellBox     c = cells_about(v, g, r, 0);
    for (int j = c.j0; j <= c.j1; j++)
        for (int i = c.i0; i <= c.i1; i++)
            for (int32_t e = v->taken_first[(size_t)j * (size_t)g->nx + (size_t)i]; e >= 0; e = v->entry[e].next) {
                const Taken *t = &v->taken[v->entry[e].taken];
                if ((t->kind & kinds) && (owner < 0 || t->owner != owner) && rectangles_meet(&t->at, r)) return true;
            }
    return false;
}

static bool make_room(void *rows, int *room, int count, size_t size)
{
    void **const data = rows;
    if (count <= *room) return true;
    const int wanted = count + count / 2 + 256;
    void     *more = realloc(*data, (size_t)wanted * size);
    if (!more) return false;
    *data = more, *room = wanted;
    return true;
}

void invent_take(Inventor *v, const Rectangle *r, TakenKind kind, int owner)
{
    const GroundGrid *g = &v->taken_grid;
    const CellBox     c = cells_about(v, g, r, 0);
    if (v->status != STATUS_OK || c.i1 < c.i0 || c.j1 < c.j0) return;
    const int cells = (c.i1 - c.i0 + 1) * (c.j1 - c.j0 + 1);
    if (!make_room(&v->taken, &v->takens_room, v->takens + 1, sizeof *v->taken) ||
        !make_room(&v->entry, &v->entries_room, v->entries + cells, sizeof *v->entry)) {
        v->status = STATUS_NO_MEMORY;
        return;
    }
    v->taken[v->takens] = (Taken){*r, owner, (uint8_t)kind};
    for (int j = c.j0; j <= c.j1; j++)
        for (int i = c.i0; i <= c.i1; i++) {
            int32_t *first = &v->taken_first[(size_t)j * (size_t)g->nx + (size_t)i];
            v->entry[v->entries] = (TakenEntry){v->takens, *first};
            *first = v->entries++;
        }
    v->takens++;
}

/* ---- opening ------------------------------------------------------------------------------------- */

Status invent_ground_open(Inventor *v)
{
    const LandscapeEvidence *known = &v->landscape->fitted_to;
    v->driven_grid = grid_of(v, 4), v->line_grid = grid_of(v, 8), v->taken_grid = grid_of(v, 32);
    v->taken_first = malloc(cells_of(&v->taken_grid) * sizeof *v->taken_first);
    if (known->fix_count) v->driven = calloc(cells_of(&v->driven_grid), 1);
    if (known->line_count) v->ceiling_m = malloc(cells_of(&v->line_grid) * sizeof *v->ceiling_m);
    if (!v->taken_first || (known->fix_count && !v->driven) || (known->line_count && !v->ceiling_m))
        return STATUS_NO_MEMORY;
    for (size_t n = 0; n < cells_of(&v->taken_grid); n++) v->taken_first[n] = -1;
    if (v->driven) mark_driven(v);
    for (size_t n = 0; v->ceiling_m && n < cells_of(&v->line_grid); n++) v->ceiling_m[n] = INFINITY;
    if (v->ceiling_m) mark_lines(v);
    return STATUS_OK;
}

void invent_ground_close(Inventor *v)
{
    free(v->driven), free(v->ceiling_m), free(v->taken_first), free(v->taken), free(v->entry);
}
