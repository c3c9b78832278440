/* tests/scenes/town.c: streets of gabled houses, and cars and trailers in them. */
#include "tests/scenes/town.h"

#include "entities/shapes/mesh_builder.h"
#include "entities/shapes/parametric.h"
#include "pitviper.h"

#include <stdio.h>
#include <stdlib.h>

enum { a_square = town_lots * town_lots, shapes = 3, corners = 4 };
static const char *const shape_name[shapes] = {"car", "trailer", "bus"};

typedef struct Making {
    const TownOf *of;
    uint64_t      drawn;
} Making;

static double between(Making *m, double low, double high)
{
    return low + (high - low) * random_uniform(m->of->seed, 61, 0, m->drawn++);
}

static int squares_of(int buildings) { return (buildings + a_square - 1) / a_square; }
static int side_of(int buildings) { return (int)ceil(sqrt(squares_of(buildings))); }

double town_wide_m(int buildings) { return (double)side_of(buildings) * town_square_m; }

static double ground_at(const Making *m, double x, double y)
{
    return m->of->landscape ? elevation_height(&m->of->landscape->elevation, x, y, NULL) : 0;
}

/* Heading 0: forward is north, right is east. */
static void level(double r_enu_from_body[9], double heading_rad)
{
    const double c = cos(heading_rad), s = sin(heading_rad);
    const double r[9] = {s, c, 0, c, -s, 0, 0, 0, -1};
    memcpy(r_enu_from_body, r, sizeof r);
}

typedef struct House {
    double x, y, low, half_x, half_y, eaves, ridge; /* body axes of the square; heights above the origin */
} House;

static void windows(MeshBuilder *b, const House *h, int side)
{
    static const double proud_m = 0.03;
    for (int k = 0; k < 3; k++) {
        const double at = h->x + (k - 1) * 0.6 * h->half_x, y = h->y + side * h->half_y, low = h->low + 1;
        const double y0 = side > 0 ? y : y - proud_m;
        mesh_box(b, place_at(0, 0, 0), at - 0.5, y0, -(low + 1.3), at + 0.5, y0 + proud_m, -low);
    }
}

static void build_house(MeshBuilder *b, const House *h, bool brick)
{
    const double x0 = h->x - h->half_x, x1 = h->x + h->half_x, over = 0.4, thick = 0.25;
    const double gable[5][2] = {{h->y - h->half_y, -h->low},
                                {h->y + h->half_y, -h->low},
                                {h->y + h->half_y, -h->eaves},
                                {h->y, -h->ridge},
                                {h->y - h->half_y, -h->eaves}};
    const double slope = (h->ridge - h->eaves) / h->half_y, foot = h->eaves - over * slope;
    /* the builder's prisms run along y of the shape: here along x of the square */
    const Place along = {{0, 0, 0}, {0, 1, 0, 1, 0, 0, 0, 0, 1}};
    mesh_part(b, 0, "wall", brick ? "brick_red" : "concrete", HEAT_DWELLING);
    mesh_prism(b, along, 5, gable, x0, x1);
    mesh_part(b, 0, "roof", "roof_tile_clay", HEAT_DWELLING);
    for (int s = -1; s <= 1; s += 2) {
        const double edge = h->y + s * (h->half_y + over);
        const double slab[4][2] = {
            {h->y, -h->ridge - 0.02}, {edge, -foot - 0.02}, {edge, -foot - thick}, {h->y, -h->ridge - thick}};
        mesh_prism(b, along, 4, slab, x0 - over, x1 + over);
    }
    mesh_part(b, 0, "window", "glass_window", HEAT_WINDOW);
    windows(b, h, -1);
    windows(b, h, 1);
}

static Status build_square(Model *out, Making *m, int houses, const double p_enu[3])
{
    static const double lot_m = (double)town_square_m / town_lots;
    MeshBuilder        *b = mesh_builder_create("square", 0.01);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "ground", -1, 0, 0, 0);
    for (int k = 0; k < houses; k++) {
        House  h = {.x = (k / town_lots + 0.5) * lot_m - 0.5 * town_square_m + between(m, -3, 3),
                    .y = (k % town_lots + 0.5) * lot_m - 0.5 * town_square_m + between(m, -3, 3),
                    .half_x = between(m, 4, 7),
                    .half_y = between(m, 3.5, 5)};
        double low = INFINITY; /* of the ground: body x is north, y east */
        for (int c = 0; c < 4; c++)
            low = fmin(low, ground_at(m, p_enu[0] + h.y + (c & 1 ? 1 : -1) * h.half_y,
                                      p_enu[1] + h.x + (c & 2 ? 1 : -1) * h.half_x));
        h.low = low - p_enu[2] - 0.3;
        h.eaves = h.low + between(m, 3, 7);
        h.ridge = h.eaves + between(m, 2, 4);
        build_house(b, &h, k % 3 != 0);
    }
    return mesh_builder_finish(out, b);
}

static Status build_squares(Scenery *out, Making *m)
{
    const int side = side_of(m->of->buildings), squares = squares_of(m->of->buildings);
    for (int k = 0; k < squares; k++) {
        const int      houses = k + 1 < squares ? a_square : m->of->buildings - k * a_square;
        SceneryObject *o = &out->object[out->objects];
        *o = (SceneryObject){.id = (uint64_t)k + 1, .kind = SCENERY_BUILDINGS, .model = out->models, .state = -1};
        o->p_enu[0] = m->of->middle_enu[0] + (k % side + 0.5 - 0.5 * side) * town_square_m;
        o->p_enu[1] = m->of->middle_enu[1] + (k / side + 0.5 - 0.5 * side) * town_square_m;
        o->p_enu[2] = ground_at(m, o->p_enu[0], o->p_enu[1]);
        level(o->r_enu_from_body, 0);
        const Status status = build_square(&out->model[out->models], m, houses, o->p_enu);
        if (status != STATUS_OK) return status;
        out->models++, out->objects++;
    }
    return STATUS_OK;
}

static void drive(Scenery *out, Making *m, int object)
{
    SceneryMover *mover = &out->mover[out->movers++];
    const double *p = out->object[object].p_enu;
    *mover = (SceneryMover){.object = object, .first = out->paths, .count = corners, .speed_mps = between(m, 5, 15)};
    for (int k = 0; k < corners; k++) {
        double *to = out->path_enu[out->paths++];
        to[0] = p[0] + (k == 1 || k == 2 ? 50 : 0), to[1] = p[1] + (k >= 2 ? 50 : 0);
        to[2] = ground_at(m, to[0], to[1]);
    }
    scenery_pose(out->object[object].p_enu, out->object[object].r_enu_from_body, out, mover, 0);
}

static Status strew(Scenery *out, Making *m)
{
    static const SceneryClass class[shapes] = {CLUTTER_CAR, CLUTTER_TRAILER, CLUTTER_LORRY};
    const int    first = out->models;
    const double half_m = 0.5 * town_wide_m(m->of->buildings);
    for (int k = 0; k < shapes; k++, out->models++) {
        const Status status = parametric_build(&out->model[out->models], shape_name[k], 0.02);
        if (status != STATUS_OK) return status;
    }
    for (int k = 0; k < m->of->clutter; k++) {
        SceneryObject *o = &out->object[out->objects];
        *o = (SceneryObject){.id = (uint64_t)1 << 32 | (uint64_t)k,
                             .kind = SCENERY_CLUTTER,
                             .class = (uint8_t) class[k % shapes],
                             .model = first + k % shapes,
                             .state = -1};
        for (int c = 0; c < 2; c++) o->p_enu[c] = m->of->middle_enu[c] + between(m, -half_m, half_m);
        o->p_enu[2] = ground_at(m, o->p_enu[0], o->p_enu[1]);
        level(o->r_enu_from_body, between(m, 0, 6));
        if (k < m->of->movers) drive(out, m, out->objects);
        out->objects++;
    }
    return STATUS_OK;
}

Status town_create(Scenery *out, const TownOf *of)
{
    Making       m = {.of = of};
    const size_t squares = (size_t)squares_of(of->buildings);
    *out = (Scenery){0};
    out->model = calloc(squares + shapes, sizeof *out->model);
    out->object = calloc(squares + (size_t)of->clutter, sizeof *out->object);
    out->mover = calloc((size_t)of->movers + 1, sizeof *out->mover);
    out->path_enu = calloc(corners * (size_t)of->movers + 1, sizeof *out->path_enu);
    Status status =
        out->model && out->object && out->mover && out->path_enu ? build_squares(out, &m) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = strew(out, &m);
    if (status != STATUS_OK) scenery_free(out);
    return status;
}
