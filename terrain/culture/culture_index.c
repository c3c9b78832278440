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
    double  most_half_m; /* half the width of the widest line, and of the largest point */
    size_t *first;       /* [nx * ny + 1] */
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

static Box box_of(const double (*p)[2], int count)
{
    Box box = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (int k = 0; k < count; k++)
        for (int c = 0; c < 2; c++) box.low[c] = fmin(box.low[c], p[k][c]), box.high[c] = fmax(box.high[c], p[k][c]);
    return box;
}

static int cell_along(double m, double from_m, double cell_m, int count)
{
    return (int)clamp(floor((m - from_m) / cell_m), 0, count - 1);
}

/* Counts an item in the cells of a box, or writes it there: at[] are the ends of the lists that grow. */
static void put_box(struct CultureIndex *x, size_t *at, const Box *box, const Item *item)
{
    const int i1 = cell_along(box->high[0], x->x0_m, x->cell_m, x->nx);
    const int j1 = cell_along(box->high[1], x->y0_m, x->cell_m, x->ny);
    for (int j = cell_along(box->low[1], x->y0_m, x->cell_m, x->ny); j <= j1; j++)
        for (int i = cell_along(box->low[0], x->x0_m, x->cell_m, x->nx); i <= i1; i++) {
            const size_t cell = (size_t)j * (size_t)x->nx + (size_t)i;
            if (x->item) x->item[at[cell]] = *item;
            at[cell]++;
        }
}

/* A piece of a line, cut until each part's box is small, so that a long one is listed where it passes alone. A cell may
 * list it twice. */
static void put_piece(struct CultureIndex *x, size_t *at, const double a[2], const double b[2], const Item *item)
{
    const double length_m = hypot(b[0] - a[0], b[1] - a[1]);
    const double whole = fmin(ceil(length_m / x->cell_m), most_cells);
    const int    parts = whole > 1 ? (int)whole : 1;
    for (int k = 0; k < parts; k++) {
        double end[2][2];
        for (int c = 0; c < 2; c++) {
            end[0][c] = a[c] + (b[c] - a[c]) * k / parts;
            end[1][c] = a[c] + (b[c] - a[c]) * (k + 1) / parts;
        }
        const Box box = box_of((const double(*)[2])end, 2);
        put_box(x, at, &box, item);
    }
}

static void put_all(struct CultureIndex *x, size_t *at, const Culture *c)
{
    for (int n = 0; n < c->buildings; n++) {
        const Box box = box_of((const double(*)[2])c->corner_m + c->building[n].first_corner, c->building[n].corners);
        put_box(x, at, &box, &(Item){ITEM_BUILDING, n, 0});
    }
    for (int n = 0; n < c->lines; n++)
        for (int k = 0; k + 1 < c->line[n].corners; k++) {
            const int corner = c->line[n].first_corner + k;
            put_piece(x, at, c->corner_m[corner], c->corner_m[corner + 1], &(Item){ITEM_PIECE, n, corner});
        }
    for (int n = 0; n < c->points; n++) {
        const double place[1][2] = {{c->point[n].x_m, c->point[n].y_m}};
        const Box    box = box_of(place, 1);
        put_box(x, at, &box, &(Item){ITEM_POINT, n, 0});
    }
}

static double half_of_point_m(const CulturePoint *p) { return 0.5 * hypot((double)p->size_m[0], (double)p->size_m[1]); }

Status culture_index(Culture *c)
{
    culture_index_free(c);
    Box all = box_of((const double(*)[2])c->corner_m, c->corners);
    for (int n = 0; n < c->points; n++) {
        const double p[2] = {c->point[n].x_m, c->point[n].y_m};
        for (int k = 0; k < 2; k++) all.low[k] = fmin(all.low[k], p[k]), all.high[k] = fmax(all.high[k], p[k]);
    }
    if (!(all.low[0] <= all.high[0])) return STATUS_OK; /* nothing that has a place on the ground */
    struct CultureIndex *x = calloc(1, sizeof *x);
    if (!x) return STATUS_NO_MEMORY;
    c->index = x;
    const double wide_m = all.high[0] - all.low[0], high_m = all.high[1] - all.low[1];
    x->x0_m = all.low[0], x->y0_m = all.low[1];
    x->cell_m = fmax(least_cell_m, fmax(fmax(wide_m, high_m) / 65536, 1.001 * sqrt(wide_m * high_m / most_cells)));
    x->nx = (int)(wide_m / x->cell_m) + 1, x->ny = (int)(high_m / x->cell_m) + 1;
    for (int n = 0; n < c->lines; n++) x->most_half_m = fmax(x->most_half_m, 0.5 * (double)c->line[n].width_m);
    for (int n = 0; n < c->points; n++) x->most_half_m = fmax(x->most_half_m, half_of_point_m(&c->point[n]));
    const size_t cells = (size_t)x->nx * (size_t)x->ny;
    size_t      *at = calloc(cells + 1, sizeof *at);
    x->first = calloc(cells + 1, sizeof *x->first);
    if (at && x->first) {
        put_all(x, at, c); /* counts */
        for (size_t k = 0; k < cells; k++) x->first[k + 1] = x->first[k] + at[k];
        memcpy(at, x->first, cells * sizeof *at);
        x->item = malloc((x->first[cells] + 1) * sizeof *x->item);
        if (x->item) put_all(x, at, c);
    }
    free(at);
    if (x->item) return STATUS_OK;
    culture_index_free(c);
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
           0.5 * (double)c->line[item->number].width_m + more_m;
}

typedef bool Takes(void *user, const Culture *c, const Item *item, const double p[2], double more_m);

/* Offers every item of the cells within reach_m, until one is taken for good. */
static void look_about(const Culture *c, double x_m, double y_m, double more_m, double reach_m, Takes *takes,
                       void *user)
{
    const struct CultureIndex *x = c->index;
    const double               p[2] = {x_m, y_m};
    if (!x || !isfinite(x_m) || !isfinite(y_m) || !(more_m >= 0)) return;
    if (x_m + reach_m < x->x0_m || y_m + reach_m < x->y0_m || x_m - reach_m > x->x0_m + x->cell_m * x->nx ||
        y_m - reach_m > x->y0_m + x->cell_m * x->ny)
        return;
    const int i0 = cell_along(x_m - reach_m, x->x0_m, x->cell_m, x->nx);
    const int i1 = cell_along(x_m + reach_m, x->x0_m, x->cell_m, x->nx);
    const int j1 = cell_along(y_m + reach_m, x->y0_m, x->cell_m, x->ny);
    for (int j = cell_along(y_m - reach_m, x->y0_m, x->cell_m, x->ny); j <= j1; j++)
        for (int i = i0; i <= i1; i++) {
            const size_t cell = (size_t)j * (size_t)x->nx + (size_t)i;
            for (size_t n = x->first[cell]; n < x->first[cell + 1]; n++)
                if (takes(user, c, &x->item[n], p, more_m)) return;
        }
}

static bool take_first_building(void *user, const Culture *c, const Item *item, const double p[2], double more_m)
{
    int *found = user;
    if (item->kind == ITEM_BUILDING && (*found < 0 || item->number < *found) && item_is_near(c, item, p, more_m))
        *found = item->number;
    return false;
}

int culture_building_at(const Culture *c, double x_m, double y_m, double more_m)
{
    int found = -1;
    look_about(c, x_m, y_m, more_m, more_m, take_first_building, &found);
    return found;
}

static bool take_any(void *user, const Culture *c, const Item *item, const double p[2], double more_m)
{
    bool *found = user;
    return *found = item_is_near(c, item, p, more_m);
}

bool culture_is_near(const Culture *c, double x_m, double y_m, double more_m)
{
    bool found = false;
    look_about(c, x_m, y_m, more_m, more_m + (c->index ? c->index->most_half_m : 0), take_any, &found);
    return found;
}

static bool take_last_surface(void *user, const Culture *c, const Item *item, const double p[2], double more_m)
{
    int *found = user;
    if (item->kind == ITEM_PIECE && c->line[item->number].surface && item->number > *found &&
        item_is_near(c, item, p, more_m))
        *found = item->number;
    return false;
}

int culture_surface_at(const Culture *c, double x_m, double y_m)
{
    int found = -1;
    look_about(c, x_m, y_m, 0, c->index ? c->index->most_half_m : 0, take_last_surface, &found);
    return found < 0 ? 0 : c->line[found].surface;
}
