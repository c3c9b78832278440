/* terrain/culture/culture_invented_farms.c: farms: a house and barns about a yard beside a track or lane, away from
 * villages, where ways meet if they do near by. */
#include "terrain/culture/culture_invented_private.h"

static const double site_half_m[2] = {40, 36}, front_m = 9;
static const double top_m = 16; /* nothing of a farm is higher */

/* A farm's layout: east along the way, north away from it, from the middle of its site; mirrored where flip is -1. */
typedef struct Layout {
    Rectangle site;
    double    flip;
    int       owner;
    uint64_t  hash;
} Layout;

static double unit(const Layout *l, int k) { return invent_unit(l->hash, 100 + k); }

static bool put_building(Inventor *v, const Layout *l, double x_m, double y_m, const double half_m[2],
                         const Building *b)
{
    return invent_site_building(v, &l->site, (double[2]){l->flip * x_m, y_m}, half_m, b, l->owner);
}

static bool put_point(Inventor *v, const Layout *l, CulturePointKind kind, double x_m, double y_m, double length_m,
                      double width_m, double high_m)
{
    return invent_site_point(v, &l->site, kind, (double[2]){l->flip * x_m, y_m}, (double[3]){length_m, width_m, high_m},
                             l->owner);
}

static Building barn(const Layout *l, const double half_m[2], int k)
{
    const double u = unit(l, k);
    Rectangle    r = l->site;
    r.half_m[0] = half_m[0], r.half_m[1] = half_m[1];
    const double eaves_m = 4 + 1.5 * unit(l, k + 1);
    Building     b = invent_roofed(&r, ROOF_GABLED, eaves_m, (u < 0.5 ? 42 : 18) * rad_per_deg, half_m[0] >= half_m[1]);
    b.use = BUILDING_BARN;
    b.wall_fabric = u < 0.25 ? FABRIC_BRICK : u < 0.5 ? FABRIC_TIMBER : u < 0.85 ? FABRIC_SHEET : FABRIC_CONCRETE;
    b.roof_fabric = u < 0.5 ? FABRIC_TILE : FABRIC_SHEET;
    return b;
}

static void lay_yard(Inventor *v, const Layout *l)
{
    const double door_m = -site_half_m[1] - front_m;
    for (int k = -1; k <= 1; k += 2) /* two strips side by side, 36 m square with round corners */
        invent_ground_strip(v, &l->site, CULTURE_YARD, SURFACE_BARE_SOIL, (double[2]){9 * k, -20},
                            (double[2]){9 * k, 2}, 18.5);
    invent_ground_strip(v, &l->site, CULTURE_TRACK, SURFACE_TRACK, (double[2]){0, door_m}, (double[2]){0, -24}, 4);
}

/* A garden fence about the house, a wire fence about the rest. */
static void enclose(Inventor *v, const Layout *l)
{
    static const double gate_m = 3.5;
    const double        house_x = l->flip * -29;
    const Rectangle     garden = rectangle_within(&l->site, house_x, -19, 10, 14);
    const Rectangle     all = rectangle_grown(&l->site, -0.5);
    Enclosure           e = {.owner = l->owner, .gates = 1, .line = invent_border(CULTURE_FENCE, 1.1)};
    rectangle_at(e.gate_m[0], &garden, l->flip * 10, 0), e.gate_half_m[0] = 1.2;
    invent_enclose(&e, &garden);
    invent_enclosure(v, &e);
    if (unit(l, 40) < 0.25) return;
    e.line = invent_border(CULTURE_WIRE_FENCE, 1.3);
    rectangle_at(e.gate_m[0], &all, 0, -all.half_m[1]), e.gate_half_m[0] = gate_m;
    invent_enclose(&e, &all);
    invent_enclosure(v, &e);
}

static void build_farm(Inventor *v, const Layout *l)
{
    const double    house_half[2] = {4.5 + unit(l, 0), 6 + 1.5 * unit(l, 1)};
    const Rectangle house = rectangle_within(&l->site, l->flip * -29, -19, house_half[0], house_half[1]);
    Building        b = invent_house(v, &house, -1, invented_hash(l->hash, 7, 0));
    b.heated = true, b.chimneys = (uint8_t)(1 + (unit(l, 2) < 0.4));
    invent_take(v, &l->site, TAKEN_SITE, l->owner);
    put_building(v, l, -29, -19, house_half, &b);
    const double back_half[2] = {12 + 6 * unit(l, 3), 5.5 + 2 * unit(l, 4)};
    b = barn(l, back_half, 5);
    put_building(v, l, -2, 14, back_half, &b);
    const double side_half[2] = {5 + 1.5 * unit(l, 7), 10 + 4 * unit(l, 8)};
    b = barn(l, side_half, 9);
    if (unit(l, 11) < 0.75) put_building(v, l, 27, -9, side_half, &b);
    if (unit(l, 12) < 0.6) { /* an open shed for machines */
        const double    half[2] = {6 + 2 * unit(l, 13), 3.2};
        const Rectangle r = rectangle_within(&l->site, 0, 0, half[0], half[1]);
        Building        shed = invent_roofed(&r, ROOF_SKILLION, 3.2, 8 * rad_per_deg, false);
        shed.use = BUILDING_SHED, shed.wall_fabric = FABRIC_TIMBER, shed.roof_fabric = FABRIC_SHEET;
        put_building(v, l, -30, 11, half, &shed);
    }
    const double silo_m = 3.6 + 1.4 * unit(l, 14), silo_top_m = 9 + 5 * unit(l, 15);
    const int    silos = unit(l, 16) < 0.75 ? 1 + (unit(l, 16) < 0.3) : 0;
    for (int k = 0; k < silos; k++) put_point(v, l, CULTURE_SILO, 24 + 6.5 * k, 14, silo_m, silo_m, silo_top_m);
    if (unit(l, 17) < 0.8) put_point(v, l, CULTURE_HEAP, 32, 24, 7 + 3 * unit(l, 18), 6, 1.4 + unit(l, 19));
    if (unit(l, 20) < 0.8) put_point(v, l, CULTURE_STACK, -8 + 8 * unit(l, 21), 29, 7 + 6 * unit(l, 22), 3.6, 3.6);
    if (unit(l, 23) < 0.5) put_point(v, l, CULTURE_STACK, 14, 29, 6, 2.4, 2.4);
    if (unit(l, 24) < 0.6) put_point(v, l, CULTURE_TANK, 16, -27, 2, 2, 2.6);
    if (unit(l, 25) < 0.3) put_point(v, l, CULTURE_TANK, -28, 26, 7, 7, 4);
    put_point(v, l, CULTURE_LAMP, -15, 4, 0.16, 0.16, 5);
    put_point(v, l, CULTURE_POLE, -20, -33, 0.26, 0.26, 8); /* of the wire to the farm */
    lay_yard(v, l);
    enclose(v, l);
}

/* Looks for the best place of a cell. */
static bool find_site(Layout *out, const Inventor *v, int cell)
{
    enum { looks = 36 };
    static const double away_m = 170, steepest = 0.09, wildest = 0.3, crossing_m = 45;
    double              least = INFINITY;
    for (int k = 0; k < looks; k++) {
        const uint64_t hash = invented_hash(invented_hash(v->seed, 16, cell), k, 0);
        Rectangle      way;
        if (!invent_beside_way(&way, v, cell, hash, k % 3 == 0)) continue;
        const Rectangle site = invent_site_beside(&way, invent_unit(hash, 5) < 0.5, front_m, site_half_m);
        if (invent_is_built_up(v, site.x_m, site.y_m, away_m) || invent_slope(v, &site) > steepest ||
            invent_is_taken(v, &site, TAKEN_ALL, -1))
            continue;
        const double    wild = invent_wild_share(v, &site);
        const double    score = (invent_ways_about(v, way.x_m, way.y_m, crossing_m) >= 3 ? 0 : 1) + 2 * wild;
        const Rectangle all = invent_site_and_front(&site, front_m);
        if (wild > wildest || score >= least || !invent_is_dry(v, &site, 0) || !invent_is_clear(v, &all, top_m))
            continue;
        least = score;
        *out = (Layout){site, invent_unit(hash, 6) < 0.5 ? 1 : -1, invent_owner_farm + cell, hash};
    }
    return least < INFINITY;
}

void invent_farms(Inventor *v)
{
    static const double share = 0.85; /* of cells that have one if they can */
    const int           cells = v->way_cells.nx * v->way_cells.ny;
    for (int cell = 0; cell < cells && v->status == STATUS_OK; cell++) {
        Layout layout;
        if (invented_unit(invented_hash(v->seed, 17, cell)) < share && find_site(&layout, v, cell))
            build_farm(v, &layout);
    }
}
