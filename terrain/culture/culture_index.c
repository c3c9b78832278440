/* terrain/culture/culture_index.c: which records are near a place: a grid of cells, each with its list. */
#include "terrain/culture/culture_private.h"

#include <stdlib.h>

/* What a cell lists: a building, a piece of a line between two corners, a point. */
typedef enum ItemKind { ITEM_BUILDING, ITEM_PIECE, ITEM_POINT } ItemKind;

typedef struct Item {
    int32_t kind, number; /* number: building, line or point */
    int32_t corner;       /* of a piece: its first */
} Item;

struct CultureIndex {
    double  x0_m, y0_m, cell_m;
    int     nx, ny;
    size_t *first; /* [nx * ny + 1] */
    Item   *item;
};

enum { most_cells = 1 << 22 };
static const double least_cell_m = 32;

void culture_index_free(Culture *culture)
{
    if (!culture->index) return;
    free(culture->index->first), free(culture->index->item), free(culture->index);
    culture->index = NULL;
}

/* ---- filling ------------------------------------------------------------------------------------ */

typedef struct Box {
    double low[2], high[2];
} Box;

static Box box_of(const double (*p)[2], int count, double more_m)
{
    Box box = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (int k = 0; k < count; k++)
        for (int c = 0; c < 2; c++) {
            box.low[c] = fmin(box.low[c], p[k][c] - more_m);
            box.high[c] = fmax(box.high[c], p[k][c] + more_m);
        }
    return box;
}

static int cell_along(double m, double from_m, double cell_m, int count)
{
    return (int)clamp(floor((m - from_m) / cell_m), 0, count - 1);
}

/* Items of all cells: counted at first, then written. */
typedef struct Filling {
    struct CultureIndex *index;
    size_t              *at;   /* [cells] how many there are so far; the ends of the lists that grow */
    size_t               left; /* how many more there may be */
    bool                 full;
} Filling;

/* Adds an item to the cells that a box reaches into. */
static void put_box(Filling *f, const Box *box, const Item *item)
{
    struct CultureIndex *x = f->index;
    const int            i1 = cell_along(box->high[0], x->x0_m, x->cell_m, x->nx);
    const int            j1 = cell_along(box->high[1], x->y0_m, x->cell_m, x->ny);
    for (int j = cell_along(box->low[1], x->y0_m, x->cell_m, x->ny); j <= j1 && !f->full; j++)
        for (int i = cell_along(box->low[0], x->x0_m, x->cell_m, x->nx); i <= i1 && !f->full; i++) {
            const size_t cell = (size_t)j * (size_t)x->nx + (size_t)i;
            if (x->item) x->item[f->at[cell]] = *item;
            f->at[cell]++;
            f->full = f->left-- == 0;
        }
}

/* Adds a piece of a line, cut until each part's box is small, so that a long one is listed where it passes alone. A
 * cell may list it twice. */
static void put_piece(Filling *f, const double a[2], const double b[2], double half_m, const Item *item)
{
    const double length_m = hypot(b[0] - a[0], b[1] - a[1]);
    const int    parts = (int)fmax(ceil(length_m / f->index->cell_m), 1);
    for (int k = 0; k < parts && !f->full; k++) {
        double end[2][2];
        for (int c = 0; c < 2; c++) {
            end[0][c] = a[c] + (b[c] - a[c]) * k / parts;
            end[1][c] = a[c] + (b[c] - a[c]) * (k + 1) / parts;
        }
        const Box box = box_of((const double(*)[2])end, 2, half_m);
        put_box(f, &box, item);
    }
}

/* What a record reaches over its middle line or place, and a micrometre for the rounding of the look-ups. */
static double half_of_line_m(const CultureLine *line) { return 0.5 * (double)line->width_m; }
static double half_of_point_m(const CulturePoint *p) { return 0.5 * hypot((double)p->size_m[0], (double)p->size_m[1]); }
static const double rounding_m = 1e-6;

static Box building_box(const Culture *c, int n)
{
    return box_of((const double(*)[2])c->corner_m + c->building[n].first_corner, c->building[n].corners, rounding_m);
}

static Box point_box(const Culture *c, int n)
{
    const double place[1][2] = {{c->point[n].x_m, c->point[n].y_m}};
    return box_of(place, 1, half_of_point_m(&c->point[n]) + rounding_m);
}

static void put_all(Filling *f, const Culture *c)
{
    for (int n = 0; n < c->buildings && !f->full; n++) {
        const Box box = building_box(c, n);
        put_box(f, &box, &(Item){ITEM_BUILDING, n, 0});
    }
    for (int n = 0; n < c->lines; n++)
        for (int k = 0; k + 1 < c->line[n].corners && !f->full; k++) {
            const int corner = c->line[n].first_corner + k;
            put_piece(f, c->corner_m[corner], c->corner_m[corner + 1], half_of_line_m(&c->line[n]) + rounding_m,
                      &(Item){ITEM_PIECE, n, corner});
        }
    for (int n = 0; n < c->points && !f->full; n++) {
        const Box box = point_box(c, n);
        put_box(f, &box, &(Item){ITEM_POINT, n, 0});
    }
}

/* The box about everything, and how many records it is of. */
static Box box_of_all(size_t *records, const Culture *c)
{
    Box all = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    *records = (size_t)c->buildings + (size_t)c->points;
    for (int n = 0; n < c->buildings + c->lines + c->points; n++) {
        const int line = n - c->buildings, point = line - c->lines;
        Box       box;
        if (line < 0) box = building_box(c, n);
        else if (point < 0) {
            const CultureLine *l = &c->line[line];
            *records += (size_t)l->corners;
            box = box_of((const double(*)[2])c->corner_m + l->first_corner, l->corners, half_of_line_m(l) + rounding_m);
        } else box = point_box(c, point);
        for (int k = 0; k < 2; k++)
            all.low[k] = fmin(all.low[k], box.low[k]), all.high[k] = fmax(all.high[k], box.high[k]);
    }
    return all;
}

Status culture_index(Culture *c)
{
    static const size_t most_items_a_record = 8, most_items_besides = 1 << 20;
    size_t              records;
    const Box           all = box_of_all(&records, c);
    culture_index_free(c);
    if (records == 0) return STATUS_OK; /* nothing that has a place on the ground */
    struct CultureIndex *x = calloc(1, sizeof *x);
    size_t              *at = calloc(most_cells + 1, sizeof *at);
    if (!x || !at) goto lost;
    const double wide_m = all.high[0] - all.low[0], high_m = all.high[1] - all.low[1];
    x->x0_m = all.low[0], x->y0_m = all.low[1];
    x->cell_m =
        fmax(least_cell_m, 1.001 * fmax(fmax(wide_m, high_m) / 65536, sqrt(wide_m * high_m / (most_cells / 2))));
    for (;; x->cell_m *= 2) { /* of one cell each record is one item */
        x->nx = (int)(wide_m / x->cell_m) + 1, x->ny = (int)(high_m / x->cell_m) + 1;
        Filling f = {.index = x, .at = at, .left = most_items_a_record * records + most_items_besides};
        put_all(&f, c);
        if (!f.full) break;
        memset(at, 0, ((size_t)x->nx * (size_t)x->ny + 1) * sizeof *at);
    }
    const size_t cells = (size_t)x->nx * (size_t)x->ny;
    x->first = calloc(cells + 1, sizeof *x->first);
    if (!x->first) goto lost;
    for (size_t k = 0; k < cells; k++) x->first[k + 1] = x->first[k] + at[k];
    memcpy(at, x->first, cells * sizeof *at);
    x->item = malloc((x->first[cells] + 1) * sizeof *x->item);
    if (!x->item) goto lost;
    put_all(&(Filling){.index = x, .at = at, .left = SIZE_MAX}, c);
    free(at);
    c->index = x;
    return STATUS_OK;
lost:
    free(at);
    if (x) free(x->first);
    free(x);
    return STATUS_NO_MEMORY;
}

/* ---- asking ------------------------------------------------------------------------------------- */

static double segment_distance_m(const double p[2], const double a[2], const double b[2])
{
    const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    const double t = square > 0 ? clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, 0, 1) : 0;
    return hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
}

static bool outline_holds(const Culture *c, const Building *b, const double p[2], double more_m)
{
    const double(*corner)[2] = (const double(*)[2])c->corner_m + b->first_corner;
    bool within = false, near = false;
    for (int k = 0, last = b->corners - 1; k < b->corners; last = k++) {
        const double *from = corner[last], *to = corner[k];
        if ((from[1] > p[1]) != (to[1] > p[1]) &&
            p[0] < from[0] + (p[1] - from[1]) * (to[0] - from[0]) / (to[1] - from[1]))
            within = !within;
        near = near || (more_m > 0 && segment_distance_m(p, from, to) <= more_m);
    }
    return within || near;
}

static bool item_is_near(const Culture *c, const Item *item, const double p[2], double more_m)
{
    if (item->kind == ITEM_BUILDING) return outline_holds(c, &c->building[item->number], p, more_m);
    if (item->kind == ITEM_POINT) {
        const CulturePoint *point = &c->point[item->number];
        return hypot(point->x_m - p[0], point->y_m - p[1]) <= half_of_point_m(point) + more_m;
    }
    return segment_distance_m(p, c->corner_m[item->corner], c->corner_m[item->corner + 1]) <=
           half_of_line_m(&c->line[item->number]) + more_m;
}

/* A look-up: what it looks for, and what it has found. */
typedef struct Look {
    const Culture  *culture;
    double          p_m[2], more_m;
    CultureLineKind kind;
    int             found; /* number; -1: none yet */
    CultureMarks   *marks;
} Look;

/* Returns whether the look-up is done. */
typedef bool Takes(Look *look, const Item *item);

/* Offers every item of the cells within more_m, until the look-up is done; returns what it found. */
static int look_marking(CultureMarks *marks, const Culture *c, double x_m, double y_m, double more_m,
                        CultureLineKind kind, Takes *takes)
{
    const struct CultureIndex *x = c->index;
    Look                       look = {c, {x_m, y_m}, more_m, kind, -1, marks};
    if (!x || !(more_m >= 0) || !(x_m + more_m >= x->x0_m) || !(y_m + more_m >= x->y0_m) ||
        !(x_m - more_m <= x->x0_m + x->cell_m * x->nx) || !(y_m - more_m <= x->y0_m + x->cell_m * x->ny))
        return -1;
    const int i0 = cell_along(x_m - more_m, x->x0_m, x->cell_m, x->nx);
    const int i1 = cell_along(x_m + more_m, x->x0_m, x->cell_m, x->nx);
    const int j1 = cell_along(y_m + more_m, x->y0_m, x->cell_m, x->ny);
    for (int j = cell_along(y_m - more_m, x->y0_m, x->cell_m, x->ny); j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            const size_t cell = (size_t)j * (size_t)x->nx + (size_t)i;
            for (size_t n = x->first[cell]; n < x->first[cell + 1]; n++)
                if (takes(&look, &x->item[n])) return look.found;
        }
    return look.found;
}

static int look_about(const Culture *c, double x_m, double y_m, double more_m, CultureLineKind kind, Takes *takes)
{
    return look_marking(NULL, c, x_m, y_m, more_m, kind, takes);
}

static bool is_near(const Look *look, const Item *item)
{
    return item_is_near(look->culture, item, look->p_m, look->more_m);
}

static bool take_first_building(Look *look, const Item *item)
{
    if (item->kind == ITEM_BUILDING && (look->found < 0 || item->number < look->found) && is_near(look, item))
        look->found = item->number;
    return false;
}

int culture_building_at(const Culture *c, double x_m, double y_m, double more_m)
{
    return look_about(c, x_m, y_m, more_m, CULTURE_LINE_KINDS, take_first_building);
}

static bool take_any(Look *look, const Item *item)
{
    if (is_near(look, item)) look->found = item->number;
    return look->found >= 0;
}

bool culture_is_near(const Culture *c, double x_m, double y_m, double more_m)
{
    return look_about(c, x_m, y_m, more_m, CULTURE_LINE_KINDS, take_any) >= 0;
}

static bool take_what_is_in_way(Look *look, const Item *item)
{
    const bool yard = item->kind == ITEM_PIECE && look->culture->line[item->number].kind == CULTURE_YARD;
    if (!yard && is_near(look, item)) look->found = item->number;
    return look->found >= 0;
}

bool culture_is_in_way(const Culture *c, double x_m, double y_m, double more_m)
{
    return look_about(c, x_m, y_m, more_m, CULTURE_LINE_KINDS, take_what_is_in_way) >= 0;
}

static bool mark_one(Look *look, const Item *item)
{
    bool *const list[] = {look->marks->building, look->marks->line, look->marks->point};
    bool       *mark = &list[item->kind][item->number];
    if (!*mark) *mark = is_near(look, item);
    return false;
}

void culture_mark_near(CultureMarks *marks, const Culture *c, double x_m, double y_m, double more_m)
{
    look_marking(marks, c, x_m, y_m, more_m, CULTURE_LINE_KINDS, mark_one);
}

static bool has_surface(const Look *look, const Item *item)
{
    return item->kind == ITEM_PIECE && look->culture->line[item->number].surface;
}

static bool take_last_surface(Look *look, const Item *item)
{
    if (has_surface(look, item) && item->number > look->found && is_near(look, item)) look->found = item->number;
    return false;
}

int culture_surface_at(const Culture *c, double x_m, double y_m)
{
    const int found = look_about(c, x_m, y_m, 0, CULTURE_LINE_KINDS, take_last_surface);
    return found < 0 ? 0 : c->line[found].surface;
}

static bool take_surface(Look *look, const Item *item)
{
    if (has_surface(look, item) && is_near(look, item)) look->found = item->number;
    return look->found >= 0;
}

bool culture_surface_near(const Culture *c, double x_m, double y_m, double more_m)
{
    return look_about(c, x_m, y_m, more_m, CULTURE_LINE_KINDS, take_surface) >= 0;
}

static bool take_first_line(Look *look, const Item *item)
{
    if (item->kind == ITEM_PIECE && look->culture->line[item->number].kind == look->kind &&
        (look->found < 0 || item->number < look->found) && is_near(look, item))
        look->found = item->number;
    return false;
}

int culture_line_near(const Culture *c, CultureLineKind kind, double x_m, double y_m, double more_m)
{
    return look_about(c, x_m, y_m, more_m, kind, take_first_line);
}
