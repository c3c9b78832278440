/* entities/scenery/scenery_buildings.c: a culture's records sorted into cells, each made a mesh and an object. */
#include "entities/scenery/scenery_buildings_private.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    parts_enough = 16384, /* a cell with more is several models */
    triangles_enough = 4000000,
    triangles_most = 1 << 27, /* of all cells: some 9 GB */
    items_most = 1 << 25,     /* buildings, points and pieces of lines */
    run_most = 256,           /* pieces of a line made at once */
};

typedef enum ItemKind { ITEM_BUILDING, ITEM_PIECE, ITEM_POINT } ItemKind;

/* A record, or a piece of a line, and the cell that it stands in. */
typedef struct Item {
    int32_t i, j;
    int32_t kind, number, piece;
} Item;

static const double place_most_m = 2e6, wide_most_m = 5000, high_most_m = 1000, base_most_m = 2e4;

typedef struct Items {
    int   count, room, left_out;
    Item *item;
} Items;

static int item_order(const void *a, const void *b)
{
    const int32_t *p = (const int32_t *)a, *q = (const int32_t *)b; /* by cell, then by record */
    for (int k = 0; k < 5; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

static Status add_item(Items *items, double x_m, double y_m, int kind, int number, int piece)
{
    if (items->count == items_most) {
        log_error("scenery: more than %d buildings, points and pieces of lines; take a smaller area", items_most);
        return STATUS_BAD_VALUE;
    }
    if (items->count == items->room) {
        const int wanted = items->room ? 2 * items->room : 256;
        Item     *larger = realloc(items->item, (size_t)wanted * sizeof *larger);
        if (!larger) return STATUS_NO_MEMORY;
        items->item = larger, items->room = wanted;
    }
    const double i = floor(x_m / scenery_cell_m), j = floor(y_m / scenery_cell_m);
    items->item[items->count++] =
        (Item){(int32_t)clamp(i, -2e9, 2e9), (int32_t)clamp(j, -2e9, 2e9), kind, number, piece};
    return STATUS_OK;
}

/* Whether a mesh of metres can be made of a record: not of one that is larger than anything built, or lies off any
 * landscape. */
static bool is_of_this_world(const double low[2], const double high[2], double base_m, double high_m)
{
    for (int a = 0; a < 2; a++)
        if (!(fabs(low[a]) < place_most_m && fabs(high[a]) < place_most_m)) return false;
    return fabs(base_m) < base_most_m && high_m < high_most_m;
}

static void box_of(double low[2], double high[2], const Culture *c, int first, int corners)
{
    for (int a = 0; a < 2; a++) low[a] = INFINITY, high[a] = -INFINITY;
    for (int k = first; k < first + corners; k++)
        for (int a = 0; a < 2; a++)
            low[a] = fmin(low[a], c->corner_m[k][a]), high[a] = fmax(high[a], c->corner_m[k][a]);
}

/* Buildings whose damage changes. */
typedef struct Harmed {
    const BuildingHarm *harm;
    int                 harms;
} Harmed;

static bool is_harmed(const Harmed *of, uint64_t building)
{
    for (int k = 0; k < of->harms; k++)
        if (of->harm[k].building == building) return true;
    return false;
}

static Status list_buildings(Items *items, const Culture *c, const Harmed *harmed)
{
    Status status = STATUS_OK;
    for (int n = 0; n < c->buildings && status == STATUS_OK; n++) {
        const Building *b = &c->building[n];
        double          low[2], high[2];
        box_of(low, high, c, b->first_corner, b->corners);
        const bool fits = high[0] - low[0] < wide_most_m && high[1] - low[1] < wide_most_m;
        if (!fits || !is_of_this_world(low, high, (double)b->base_m, (double)b->ridge_m)) items->left_out++;
        else if (!is_harmed(harmed, b->id))
            status = add_item(items, 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), ITEM_BUILDING, n, 0);
    }
    return status;
}

static Status list_points(Items *items, const Culture *c)
{
    Status status = STATUS_OK;
    for (int n = 0; n < c->points && status == STATUS_OK; n++) {
        const CulturePoint *p = &c->point[n];
        const double        at[2] = {p->x_m, p->y_m};
        const float         most = fmaxf(p->size_m[0], fmaxf(p->size_m[1], p->size_m[2]));
        const float         least = fminf(p->size_m[0], fminf(p->size_m[1], p->size_m[2]));
        if (!is_of_this_world(at, at, (double)p->base_m, (double)most) || least < 0.01F) items->left_out++;
        else status = add_item(items, p->x_m, p->y_m, ITEM_POINT, n, 0);
    }
    return status;
}

static Status list_pieces(Items *items, const Culture *c)
{
    Status status = STATUS_OK;
    for (int n = 0; n < c->lines && status == STATUS_OK; n++) {
        const CultureLine *line = &c->line[n];
        const int          pieces = line_pieces(c, line);
        LineCursor         at = {0};
        double             low[2], high[2];
        box_of(low, high, c, line->first_corner, line->corners);
        if (pieces > 0 && !is_of_this_world(low, high, 0, (double)fmaxf(line->width_m, line->height_m))) {
            items->left_out++;
            continue;
        }
        for (int k = 0; k < pieces && status == STATUS_OK; k++) {
            double xy_m[2];
            line_piece_middle(xy_m, &at, c, line, k);
            status = add_item(items, xy_m[0], xy_m[1], ITEM_PIECE, n, k);
        }
    }
    return status;
}

static Status list_items(Items *items, const Culture *c, const Harmed *harmed)
{
    Status status = list_buildings(items, c, harmed);
    if (status == STATUS_OK) status = list_points(items, c);
    if (status == STATUS_OK) status = list_pieces(items, c);
    if (items->left_out > 0)
        log_warn("scenery: records left out: %d; they are wider than %g m, higher than %g m, thinner than 1 cm or "
                 "farther than %g m away",
                 items->left_out, wide_most_m, high_most_m, place_most_m);
    if (status != STATUS_OK) return status;
    if (items->count > 1) qsort(items->item, (size_t)items->count, sizeof *items->item, item_order);
    return status;
}

/* ---- a cell --------------------------------------------------------------------------------------- */

typedef struct CellsMade {
    Model         *model;
    SceneryObject *object;
    uint64_t     **id;
    int            count, room;
    long long      triangles;
} CellsMade;

static void free_made(CellsMade *made)
{
    for (int k = 0; k < made->count; k++) model_destroy(&made->model[k]), free(made->id[k]);
    free(made->model), free(made->object), free(made->id);
}

static Status put_model(CellsMade *made, CellMesh *cell, const Item *at, const double origin[3], int number)
{
    if (cell->status == STATUS_OK && cell->model.part_count == 0) {
        cell_mesh_free(cell);
        return STATUS_OK;
    }
    made->triangles += cell->model.triangle_count;
    if (cell->status == STATUS_OK && made->triangles > triangles_most) {
        log_error("scenery: more than %d triangles of buildings and works; take a smaller area", triangles_most);
        cell->status = STATUS_BAD_VALUE;
    }
    if (made->count == made->room) {
        const int    wanted = made->room ? 2 * made->room : 16;
        const size_t size = (size_t)wanted;
        Model       *model = realloc(made->model, size * sizeof *model);
        if (model) made->model = model;
        SceneryObject *object = realloc(made->object, size * sizeof *object);
        if (object) made->object = object;
        uint64_t **id = realloc(made->id, size * sizeof *id);
        if (id) made->id = id;
        if (!model || !object || !id) cell->status = STATUS_NO_MEMORY;
        else made->room = wanted;
    }
    char name[model_name_size];
    snprintf(name, sizeof name, "buildings_%d_%d", at->i, at->j);
    if (cell->status != STATUS_OK) {
        const Status status = cell->status;
        cell_mesh_free(cell);
        return status;
    }
    const Status status = cell_take(&made->model[made->count], &made->id[made->count], cell, name);
    if (status != STATUS_OK) return status;
    /* body x north, y east, z down */
    made->object[made->count] = (SceneryObject){
        .id = (uint64_t)(uint32_t)at->i << 32 ^ (uint64_t)(uint32_t)at->j ^ (uint64_t)number << 60,
        .kind = SCENERY_BUILDINGS,
        .state = -1,
        .p_enu = {origin[0], origin[1], origin[2]},
        .r_enu_from_body = {0, 1, 0, 1, 0, 0, 0, 0, -1},
    };
    made->count++;
    return STATUS_OK;
}

/* The height of a cell's origin: the lowest base in it, else the ground in its middle. */
static double height_of_cell(const Culture *c, const Item *item, int count, const double xy_m[2],
                             SceneryGround *ground_m, void *user)
{
    double z_m = INFINITY;
    for (int k = 0; k < count; k++) {
        if (item[k].kind == ITEM_BUILDING) z_m = fmin(z_m, (double)c->building[item[k].number].base_m);
        if (item[k].kind == ITEM_POINT) z_m = fmin(z_m, (double)c->point[item[k].number].base_m);
    }
    if (!isfinite(z_m) && ground_m) z_m = ground_m(user, xy_m[0], xy_m[1]);
    return isfinite(z_m) ? z_m : 0;
}

/* Items first .. first + count - 1 are of one cell. */
static Status make_cell(CellsMade *made, const Culture *c, const Item *item, int count, SceneryGround *ground_m,
                        void *user)
{
    double origin[3] = {(item->i + 0.5) * scenery_cell_m, (item->j + 0.5) * scenery_cell_m, 0};
    origin[2] = height_of_cell(c, item, count, origin, ground_m, user);
    const WorksGround ground = {ground_m, user, {origin[0], origin[1], origin[2]}};
    CellMesh          cell = {0};
    Status            status = STATUS_OK;
    int               number = 0;
    for (int k = 0, next; k < count && status == STATUS_OK; k = next) {
        next = k + 1;
        if (item[k].kind == ITEM_BUILDING)
            building_make(&cell, c, &c->building[item[k].number], origin, ground_m, user);
        if (item[k].kind == ITEM_POINT) point_make(&cell, &c->point[item[k].number], origin);
        if (item[k].kind == ITEM_PIECE) {
            while (next < count && next - k < run_most && item[next].kind == ITEM_PIECE &&
                   item[next].number == item[k].number && item[next].piece == item[k].piece + next - k)
                next++;
            line_make(&cell, c, &c->line[item[k].number], item[k].piece, next - k, &ground);
        }
        if (cell.model.part_count > parts_enough || cell.model.triangle_count > triangles_enough || next == count ||
            cell.status != STATUS_OK)
            status = put_model(made, &cell, item, origin, number++);
    }
    cell_mesh_free(&cell);
    return status;
}

/* ---- into the scenery ----------------------------------------------------------------------------- */

static int parts_known(const Scenery *s)
{
    int parts = 0;
    for (int k = 0; k < s->models; k++)
        if (s->part_first && s->part_first[k] >= 0) {
            const int end = s->part_first[k] + s->model[k].part_count;
            parts = end > parts ? end : parts;
        }
    return parts;
}

static bool widen(void *array, size_t count, size_t size)
{
    void **const data = array;
    void        *larger = realloc(*data, (count ? count : 1) * size);
    if (larger) *data = larger;
    return larger;
}

static Status append(Scenery *s, CellsMade *made)
{
    const int parts = parts_known(s);
    size_t    all = (size_t)parts;
    for (int k = 0; k < made->count; k++) all += (size_t)made->model[k].part_count;
    const bool had_first = s->part_first;
    if (all > INT32_MAX || !widen(&s->model, (size_t)(s->models + made->count), sizeof *s->model) ||
        !widen(&s->object, (size_t)(s->objects + made->count), sizeof *s->object) ||
        !widen(&s->part_of, all, sizeof *s->part_of) ||
        !widen(&s->part_first, (size_t)(s->models + made->count), sizeof *s->part_first))
        return STATUS_NO_MEMORY;
    for (int k = 0; k < s->models && !had_first; k++) s->part_first[k] = -1;
    int at = parts;
    for (int k = 0; k < made->count; k++) {
        const int count = made->model[k].part_count;
        s->part_first[s->models] = at;
        memcpy(s->part_of + at, made->id[k], (size_t)count * sizeof *s->part_of);
        at += count;
        s->object[s->objects] = made->object[k];
        s->object[s->objects++].model = s->models;
        s->model[s->models++] = made->model[k];
        made->model[k] = (Model){0};
    }
    return STATUS_OK;
}

/* A building in all states of damage, in the place of its cell. */
static Status make_harmed(CellsMade *made, const Culture *c, int number, SceneryGround *ground_m, void *user)
{
    Building b = c->building[number];
    double   low[2], high[2];
    CellMesh cell = {0};
    box_of(low, high, c, b.first_corner, b.corners);
    const double middle[2] = {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])};
    const Item   at = {(int32_t)floor(middle[0] / scenery_cell_m), (int32_t)floor(middle[1] / scenery_cell_m),
                       ITEM_BUILDING, number, 0};
    const double origin[3] = {middle[0], middle[1], (double)b.base_m};
    if (high[0] - low[0] >= wide_most_m || high[1] - low[1] >= wide_most_m ||
        !is_of_this_world(low, high, (double)b.base_m, (double)b.ridge_m))
        return STATUS_OK;
    const int least = b.damage < model_damage_states ? b.damage : model_damage_states - 1;
    for (int state = least; state < model_damage_states; state++) {
        const int first = cell.model.part_count;
        b.damage = (uint8_t)state;
        building_make(&cell, c, &b, origin, ground_m, user);
        for (int p = first; p < cell.model.part_count; p++)
            cell.model.part[p].damage_hidden = (uint8_t)(((1 << model_damage_states) - 1) & ~(1 << state));
    }
    const int    before = made->count;
    const Status status = put_model(made, &cell, &at, origin, 0);
    if (made->count > before) made->object[before].id = b.id, made->object[before].damage = (uint8_t)least;
    cell_mesh_free(&cell);
    return status;
}

static int number_of(const Culture *c, uint64_t building)
{
    for (int n = 0; n < c->buildings; n++)
        if (c->building[n].id == building) return n;
    return -1;
}

static Status make_all_harmed(CellsMade *made, const Culture *c, const Harmed *of, SceneryGround *ground_m, void *user)
{
    Status status = STATUS_OK;
    for (int k = 0; k < of->harms && status == STATUS_OK; k++) {
        const int number = number_of(c, of->harm[k].building);
        if (number >= 0 && !is_harmed(&(Harmed){of->harm, k}, of->harm[k].building))
            status = make_harmed(made, c, number, ground_m, user);
    }
    return status;
}

/* harm by object: those of the building's number are the last. */
static Status note_harm(Scenery *s, const Harmed *of)
{
    SceneryHarm *harm = calloc((size_t)of->harms + 1, sizeof *harm);
    if (!harm) return STATUS_NO_MEMORY;
    free(s->harm);
    s->harm = harm, s->harms = 0;
    for (int k = 0; k < of->harms; k++)
        for (int n = 0; n < s->objects; n++)
            if (s->object[n].kind == SCENERY_BUILDINGS && s->object[n].id == of->harm[k].building)
                s->harm[s->harms++] = (SceneryHarm){n, of->harm[k].t_s, of->harm[k].damage}, n = s->objects;
    return STATUS_OK;
}

Status scenery_add_harmed_buildings(Scenery *scenery, const Culture *culture, const BuildingHarm *harm, int harms,
                                    SceneryGround *ground_m, void *user)
{
    const Harmed harmed = {harm, harms};
    Items        items = {0};
    CellsMade    made = {0};
    Status       status = list_items(&items, culture, &harmed);
    for (int k = 0, next; k < items.count && status == STATUS_OK; k = next) {
        for (next = k + 1; next < items.count; next++)
            if (items.item[next].i != items.item[k].i || items.item[next].j != items.item[k].j) break;
        status = make_cell(&made, culture, items.item + k, next - k, ground_m, user);
    }
    if (status == STATUS_OK) status = make_all_harmed(&made, culture, &harmed, ground_m, user);
    if (status == STATUS_OK && made.count > 0) status = append(scenery, &made);
    if (status == STATUS_OK && harms > 0) status = note_harm(scenery, &harmed);
    free_made(&made);
    free(items.item);
    return status;
}

Status scenery_add_buildings(Scenery *scenery, const Culture *culture, SceneryGround *ground_m, void *user)
{
    return scenery_add_harmed_buildings(scenery, culture, NULL, 0, ground_m, user);
}
