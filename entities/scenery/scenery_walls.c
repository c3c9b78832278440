/* entities/scenery/scenery_walls.c: upright walls of buildings with rows of windows, and doors.
 *
 * A wall with openings is a grid: lines at the sides of all columns and at sills and heads of all storeys, whose cells
 * are wall or opening, in a rim of triangles to its corners; so no edge has a corner of another triangle in it. An
 * opening goes in through a splayed frame to a pane or leaf. */
#include "entities/scenery/scenery_buildings_private.h"

enum {
    windows_most = 20000,
    columns_most = 48,
    storeys_most = 100,
    lines_most = 2 * columns_most,
    rows_most = 2 * storeys_most + 1
};

static const double pane_m = 0.1, broken_m = 0.25, frame_m = 0.07, corner_m = 0.5;

typedef struct Column {
    double u0, u1; /* along the wall */
    bool   door;   /* from the floor to the lowest head */
} Column;

typedef struct Facade {
    const double *a, *b;
    double        along[2], length_m;
    int           number, columns, lines, rows, storeys;
    Column        column[columns_most];
    bool          has_door;
    double        sill_m[storeys_most], head_m[storeys_most];
    double        u[lines_most], v[rows_most];
    uint32_t      vertex[lines_most * rows_most];
} Facade;

/* Sizes of openings of a use. */
typedef struct Openings {
    double width_m, pitch_m; /* of windows; pitch: least distance of their middles; 0: none */
    double door_m;           /* width of its doors; 0: none */
    double door_high_m, door_pitch_m;
} Openings;

static const Openings openings[BUILDING_USES] = {
    [BUILDING_HOUSE] = {1.1, 3.5, 1.0, 2.1, 0}, [BUILDING_FLATS] = {1.5, 3.2, 1.4, 2.2, 0},
    [BUILDING_BARN] = {0, 0, 3.4, 3.6, 0},      [BUILDING_SHED] = {0, 0, 2.3, 2.0, 0},
    [BUILDING_HALL] = {0, 0, 4.0, 4.2, 9},      [BUILDING_CHURCH] = {1.1, 3.6, 1.8, 2.8, 0},
};

static void at_wall(double p[3], const BuildingWork *w, const Facade *f, double u, double v, double in_m)
{
    p[0] = f->a[0] + u * f->along[0] - in_m * f->along[1];
    p[1] = f->a[1] + u * f->along[1] + in_m * f->along[0];
    p[2] = w->base_m + v;
}

/* Ground at a place of the wall, over the floor. */
static double ground_over_floor(const BuildingWork *w, const Facade *f, double u)
{
    if (!w->ground_m) return 0;
    const double x_m = f->a[0] + u * f->along[0] + w->origin[0], y_m = f->a[1] + u * f->along[1] + w->origin[1];
    const double z_m = w->ground_m(w->user, x_m, y_m) - w->origin[2] - w->base_m;
    return isfinite(z_m) ? z_m : 0;
}

/* ---- where openings are --------------------------------------------------------------------------- */

static void set_storeys(Facade *f, const BuildingWork *w)
{
    static const double least_m = 2.1;
    const int           most = (int)fmin(floor(w->top_m / least_m), storeys_most);
    const int           levels = w->b->levels > most ? most : w->b->levels;
    f->storeys = levels < 1 ? 1 : levels;
    const double high_m = w->top_m / f->storeys;
    for (int k = 0; k < f->storeys; k++) {
        const bool church = w->b->use == BUILDING_CHURCH;
        f->head_m[k] = k * high_m + (church ? 0.85 * w->top_m : fmin(0.78 * high_m, 2.25));
        f->sill_m[k] = f->head_m[k] - (church ? fmin(0.5 * w->top_m, 4.5) : fmin(0.5 * high_m, 1.35));
    }
    if (w->b->use == BUILDING_CHURCH) f->storeys = 1;
}

static void add_column(Facade *f, double middle, double width_m, bool door)
{
    f->column[f->columns++] = (Column){middle - 0.5 * width_m, middle + 0.5 * width_m, door};
    f->has_door = f->has_door || door;
}

/* Doors in even places, or one among the windows. */
static void set_columns(Facade *f, const BuildingWork *w, bool front)
{
    const Openings *o = &openings[w->b->use];
    const double    free_m = f->length_m - 2 * corner_m;
    const double    door_m = fmin(o->door_m, 0.7 * free_m);
    f->columns = 0, f->has_door = false;
    const bool no_room = w->top_m < 1.9 || free_m < 0.9;
    if (no_room) return;
    const double pitch_m = w->b->use == BUILDING_HOUSE && !front ? 1.25 * o->pitch_m : o->pitch_m;
    if (o->pitch_m > 0 && free_m > o->width_m + 0.2) {
        const double fit = fmin(floor(f->length_m / pitch_m + 0.25), columns_most);
        const int    count = fit < 1 ? 1 : (int)fit;
        const int    door = (int)(record_random(w->b->id, 4) * count);
        for (int k = 0; k < count; k++)
            add_column(f, (k + 0.5) * f->length_m / count, front && k == door ? door_m : o->width_m,
                       front && k == door);
    } else if (front) {
        const int count = o->door_pitch_m > 0 ? (int)fmin(fmax(1, floor(free_m / o->door_pitch_m)), 12) : 1;
        for (int k = 0; k < count; k++) add_column(f, (k + 0.5) * f->length_m / count, door_m, true);
    }
}

static void set_lines(Facade *f, const BuildingWork *w)
{
    const Openings *o = &openings[w->b->use];
    f->lines = f->rows = 0;
    for (int k = 0; k < f->columns; k++) f->u[f->lines++] = f->column[k].u0, f->u[f->lines++] = f->column[k].u1;
    if (f->has_door) f->v[f->rows++] = 0;
    if (!(o->pitch_m > 0)) {
        f->v[f->rows++] = fmin(o->door_high_m, 0.85 * w->top_m);
        return;
    }
    for (int k = 0; k < f->storeys; k++) f->v[f->rows++] = f->sill_m[k], f->v[f->rows++] = f->head_m[k];
}

/* ---- an opening ----------------------------------------------------------------------------------- */

typedef struct Opening {
    int i, j0, j1; /* between lines i and i + 1, rows j0 and j1 */
} Opening;

static void frame_side(const BuildingWork *w, const Facade *f, int slot, const int (*outer)[2], int count,
                       const double in0[3], const double in1[3])
{
    double p[rows_most + 2][3], u[3], v[3], n[3];
    for (int k = 0; k < count; k++) at_wall(p[k], w, f, f->u[outer[k][0]], f->v[outer[k][1]], 0);
    v3_sub(u, p[count - 1], p[0]), v3_sub(v, in0, p[0]);
    v3_cross(n, u, v);
    const uint32_t a = cell_vertex(w->cell, in0, n), b = cell_vertex(w->cell, in1, n);
    uint32_t       last = cell_vertex(w->cell, p[0], n);
    for (int k = 1; k < count; k++) {
        const uint32_t next = cell_vertex(w->cell, p[k], n);
        cell_triangle(w->cell, slot, last, next, a);
        last = next;
    }
    cell_triangle(w->cell, slot, last, b, a);
}

static void make_opening(const BuildingWork *w, const Facade *f, const Opening *o, int frame, int pane,
                         double set_back_m)
{
    const double u0 = f->u[o->i], u1 = f->u[o->i + 1], v0 = f->v[o->j0], v1 = f->v[o->j1];
    const double rim_m = fmin(frame_m, 0.2 * fmin(u1 - u0, v1 - v0));
    double       in[4][3];
    at_wall(in[0], w, f, u0 + rim_m, v0 + 0.5 * rim_m, set_back_m);
    at_wall(in[1], w, f, u1 - rim_m, v0 + 0.5 * rim_m, set_back_m);
    at_wall(in[2], w, f, u1 - rim_m, v1 - rim_m, set_back_m);
    at_wall(in[3], w, f, u0 + rim_m, v1 - rim_m, set_back_m);
    int       side[rows_most + 2][2];
    const int rows = o->j1 - o->j0 + 1;
    const int low[2][2] = {{o->i, o->j0}, {o->i + 1, o->j0}}, high[2][2] = {{o->i + 1, o->j1}, {o->i, o->j1}};
    frame_side(w, f, frame, low, 2, in[0], in[1]);
    for (int k = 0; k < rows; k++) side[k][0] = o->i + 1, side[k][1] = o->j0 + k;
    frame_side(w, f, frame, (const int(*)[2])side, rows, in[1], in[2]);
    frame_side(w, f, frame, high, 2, in[2], in[3]);
    for (int k = 0; k < rows; k++) side[k][0] = o->i, side[k][1] = o->j1 - k;
    frame_side(w, f, frame, (const int(*)[2])side, rows, in[3], in[0]);
    cell_face(w->cell, pane, (const double(*)[3])in, 4);
}

/* Soot on the wall over a burnt opening: a thin plate. */
static void soot_over(const BuildingWork *w, const Facade *f, const Opening *o, int soot)
{
    const double next_m = o->j1 + 1 < f->rows ? f->v[o->j1 + 1] : w->top_m, from_m = f->v[o->j1] + 0.02;
    const double to_m = fmin(from_m + 0.7 + 0.6 * record_random(w->b->id, 32 + (uint32_t)o->i), next_m - 0.05);
    const double u = 0.5 * (f->u[o->i] + f->u[o->i + 1]), half_m = 0.45 * (f->u[o->i + 1] - f->u[o->i]);
    double       p[3];
    if (to_m < from_m + 0.1) return;
    at_wall(p, w, f, u, 0, -0.005);
    cell_box(w->cell, soot, p, f->along, half_m, 0.01, w->base_m + from_m, w->base_m + to_m);
}

/* ---- a wall --------------------------------------------------------------------------------------- */

/* The rim: a fan from each corner over the lines' ends next to it. */
static void make_rim(const BuildingWork *w, const Facade *f, const uint32_t corner[4])
{
    const int       nu = f->lines, nv = f->rows;
    const uint32_t *g = f->vertex;
    CellMesh       *c = w->cell;
    const int       s = w->wall;
    cell_triangle(c, s, corner[0], corner[1], g[nu - 1]);
    for (int i = nu - 1; i > 0; i--) cell_triangle(c, s, corner[0], g[i], g[i - 1]);
    cell_triangle(c, s, corner[1], corner[2], g[nv * nu - 1]);
    for (int j = nv - 1; j > 0; j--) cell_triangle(c, s, corner[1], g[j * nu + nu - 1], g[(j - 1) * nu + nu - 1]);
    cell_triangle(c, s, corner[2], corner[3], g[(nv - 1) * nu]);
    for (int i = 0; i < nu - 1; i++) cell_triangle(c, s, corner[2], g[(nv - 1) * nu + i], g[(nv - 1) * nu + i + 1]);
    cell_triangle(c, s, corner[3], corner[0], g[0]);
    for (int j = 0; j < nv - 1; j++) cell_triangle(c, s, corner[3], g[j * nu], g[(j + 1) * nu]);
}

/* Which opening a cell of the grid belongs to: door, window of a storey, none. */
static bool is_open(Opening *o, const BuildingWork *w, const Facade *f, int i, int j)
{
    if (i % 2) return false;
    const Column *c = &f->column[i / 2];
    const bool    windows = openings[w->b->use].pitch_m > 0;
    const int     first = f->has_door ? 1 : 0; /* row of the lowest sill */
    if (c->door && j < first + (windows ? 1 : 0)) {
        *o = (Opening){i, 0, first + (windows ? 1 : 0)};
        return true;
    }
    if (!windows || j < first || (j - first) % 2) return false;
    *o = (Opening){i, j, j + 1};
    return ground_over_floor(w, f, 0.5 * (c->u0 + c->u1)) < f->v[j] - 0.15;
}

/* Doors: of halls roller doors of sheet, in another colour than the wall. */
static const char *leaf_material(const BuildingWork *w)
{
    const char *wall = fabric_material(w->b->wall_fabric, w->b->id);
    if (w->b->use != BUILDING_HALL) return door_material(w->b->id);
    return !strcmp(wall, "sheet_grey") || !strcmp(wall, "concrete_panel") ? "sheet_white" : "sheet_grey";
}

static void make_grid(BuildingWork *w, Facade *f)
{
    const bool   heated = w->b->heated && w->b->damage < 2;
    const int    frame = cell_part(w->cell, "window", frame_material(w->b->id), HEAT_PASSIVE);
    const int    pane = cell_part(w->cell, "window", "glass_window", heated ? HEAT_WINDOW : HEAT_PASSIVE);
    const int    door = cell_part(w->cell, "door", leaf_material(w), heated ? HEAT_DWELLING : HEAT_PASSIVE);
    const int    soot = w->b->damage ? cell_part(w->cell, "wall", "masonry_sooted", HEAT_PASSIVE) : 0;
    const double normal[3] = {f->along[1], -f->along[0], 0};
    const int    nu = f->lines, nv = f->rows;
    double       p[3];
    for (int j = 0; j < nv; j++)
        for (int i = 0; i < nu; i++) {
            at_wall(p, w, f, f->u[i], f->v[j], 0);
            f->vertex[j * nu + i] = cell_vertex(w->cell, p, normal);
        }
    const double low = w->base_m - w->skirt_m, high = w->base_m + w->top_m;
    const double end[4][3] = {
        {f->a[0], f->a[1], low}, {f->b[0], f->b[1], low}, {f->b[0], f->b[1], high}, {f->a[0], f->a[1], high}};
    uint32_t corner[4];
    for (int k = 0; k < 4; k++) corner[k] = cell_vertex(w->cell, end[k], normal);
    make_rim(w, f, corner);
    for (int j = 0; j + 1 < nv; j++)
        for (int i = 0; i + 1 < nu; i++) {
            Opening o;
            if (is_open(&o, w, f, i, j)) {
                if (j != o.j0) continue;
                /* what is broken: a dark hole */
                const uint32_t stream = 256 + 64 * (uint32_t)f->number + (uint32_t)(7 * i + j);
                const bool     broken = record_random(w->b->id, stream) < 0.4 * w->b->damage;
                if (broken) make_opening(w, f, &o, soot, soot, broken_m), soot_over(w, f, &o, soot);
                else make_opening(w, f, &o, frame, f->column[i / 2].door && j == 0 ? door : pane, pane_m);
                continue;
            }
            const uint32_t *g = f->vertex + j * nu + i;
            cell_triangle(w->cell, w->wall, g[0], g[1], g[nu + 1]);
            cell_triangle(w->cell, w->wall, g[0], g[nu + 1], g[nu]);
        }
}

/* What speaks for a wall as that with the door: ground near the floor's height, a drive or yard before it, its length;
 * of churches and sheds (garages) it is a short one. */
static double worth_as_front(const BuildingWork *w, const Facade *f)
{
    const double middle = 0.5 * f->length_m, over_m = fabs(ground_over_floor(w, f, middle));
    const bool   ends = w->b->use == BUILDING_CHURCH || w->b->use == BUILDING_SHED;
    const double size = !ends ? f->length_m : f->length_m > 2.6 ? 30 / f->length_m : 0;
    double       before[3];
    at_wall(before, w, f, middle, 0, -2);
    const bool paved = culture_surface_at(w->culture, before[0] + w->origin[0], before[1] + w->origin[1]) != 0;
    return (over_m < 0.5 ? 1e6 : 0) + (paved && f->length_m > 2.6 ? 30 : 0) + size +
           1e-3 * record_random(w->b->id, 16 + (uint32_t)f->number);
}

static void set_wall(Facade *f, const BuildingWork *w, int k)
{
    f->number = k, f->a = w->p[k], f->b = w->p[(k + 1) % w->n];
    f->length_m = hypot(f->b[0] - f->a[0], f->b[1] - f->a[1]);
    f->along[0] = (f->b[0] - f->a[0]) / f->length_m, f->along[1] = (f->b[1] - f->a[1]) / f->length_m;
}

void building_walls(BuildingWork *w)
{
    static _Thread_local Facade f; /* 80 KB */
    double                      around_m = 0, most = -INFINITY;
    int                         front = 0;
    for (int k = 0; k < w->n; k++) {
        set_wall(&f, w, k);
        const double worth = w->slit && w->slit[k] ? -1 : worth_as_front(w, &f);
        around_m += f.length_m;
        if (worth > most) most = worth, front = k;
    }
    const bool bare = around_m / 3 * w->b->levels > windows_most; /* as no building is: without openings */
    for (int k = 0; k < w->n; k++) {
        set_wall(&f, w, k);
        set_storeys(&f, w);
        set_columns(&f, w, k == front);
        set_lines(&f, w);
        if (f.columns > 0 && f.rows > 1 && !bare && !(w->slit && w->slit[k])) {
            make_grid(w, &f);
            continue;
        }
        const double low = w->base_m - w->skirt_m, high = w->base_m + w->top_m;
        const double p[4][3] = {
            {f.a[0], f.a[1], low}, {f.b[0], f.b[1], low}, {f.b[0], f.b[1], high}, {f.a[0], f.a[1], high}};
        cell_face(w->cell, w->wall, p, 4);
    }
}
